//! Turns the facets of a surface so that neighbours agree: they run through their common edge in opposite directions.

use super::{Mesh, message};
use crate::error::{Error, Result};
use std::collections::VecDeque;

/// One side of a facet: the nodes of the edge in ascending order, the facet, and whether it runs through it upwards.
type Side = ([u32; 2], u32, bool);

/// Turns facets until each connected part agrees with its first facet, or with most of them, or with those that are `fixed`,
/// and returns the numbers of those that are turned. Fails on an edge with more than two facets, and on a surface that has one side only.
pub(super) fn align(mesh: &mut Mesh, fixed: &[bool], most: bool) -> Result<Vec<u64>> {
    let neighbours = neighbours(mesh)?;
    // None: not reached yet.
    let mut turned: Vec<Option<bool>> = fixed.iter().map(|&fixed| fixed.then_some(false)).collect();
    let mut queue: VecDeque<usize> = (0..fixed.len()).filter(|&facet| fixed[facet]).collect();
    let mut starts = 0..mesh.facets.len();
    // The first part is that of those that are fixed.
    let mut is_free = false;
    loop {
        let mut part = Vec::new();
        while let Some(facet) = queue.pop_front() {
            part.push(facet);
            let own = turned[facet] == Some(true);
            for &(other, agrees) in neighbours.of(facet) {
                let wanted = own ^ !agrees;
                match turned[other as usize].replace(wanted) {
                    None => queue.push_back(other as usize),
                    Some(was) if was == wanted => {}
                    Some(_) => return Err(one_sided(mesh, facet, other as usize)),
                }
            }
        }
        if most && is_free && 2 * part.iter().filter(|&&facet| turned[facet] == Some(true)).count() > part.len() {
            part.iter().for_each(|&facet| turned[facet] = turned[facet].map(|turned| !turned));
        }
        is_free = true;
        let Some(start) = starts.find(|&facet| turned[facet].is_none()) else { break };
        turned[start] = Some(false);
        queue.push_back(start);
    }
    let mut ids = Vec::new();
    for (facet, _) in mesh.facets.iter_mut().zip(&turned).filter(|(_, turned)| **turned == Some(true)) {
        *facet = facet.reversed();
        ids.push(facet.id);
    }
    Ok(ids)
}

/// The numbers of the facets with an edge that no other has.
pub(super) fn open(mesh: &Mesh) -> Vec<u64> {
    let sides = sides(mesh);
    let mut open: Vec<u32> =
        sides.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() == 1).map(|same| same[0].1).collect();
    open.sort_unstable();
    open.dedup();
    open.into_iter().map(|facet| mesh.facets[facet as usize].id).collect()
}

fn one_sided(mesh: &Mesh, a: usize, b: usize) -> Error {
    let [a, b] = [a, b].map(|facet| mesh.facets[facet].id);
    let what = format!("facets {a} and {b} cannot both face outward");
    let help = "the surface has one side only, or its solids lie on both sides of it";
    message::whole_file(&mesh.source, what, help)
}

/// For each facet those across its edges, and whether they agree with it.
struct Neighbours {
    starts: Vec<u32>,
    others: Vec<(u32, bool)>,
}

impl Neighbours {
    fn of(&self, facet: usize) -> &[(u32, bool)] {
        let range = [0, 1].map(|end| self.starts[facet + end] as usize);
        &self.others[range[0]..range[1]]
    }
}

/// All sides, those of one edge one after the other.
fn sides(mesh: &Mesh) -> Vec<Side> {
    let facets = &mesh.facets;
    let mut sides: Vec<Side> = Vec::with_capacity(4 * facets.len());
    for (index, facet) in facets.iter().enumerate() {
        let nodes = facet.nodes();
        for (&a, &b) in nodes.iter().zip(nodes.iter().cycle().skip(1)) {
            sides.push(([a.min(b), a.max(b)], index as u32, a < b));
        }
    }
    sides.sort_unstable();
    sides
}

fn neighbours(mesh: &Mesh) -> Result<Neighbours> {
    let (facets, sides) = (&mesh.facets, sides(mesh));
    let mut pairs = Vec::with_capacity(sides.len());
    let mut crowded = Vec::new();
    for same in sides.chunk_by(|a, b| a.0 == b.0) {
        match same {
            [_] => {}
            [(_, a, up_a), (_, b, up_b)] => pairs.extend([(*a, *b, up_a != up_b), (*b, *a, up_a != up_b)]),
            _ => crowded.push(same),
        }
    }
    if let Some(same) = crowded.first() {
        let [a, b] = same[0].0.map(|node| mesh.point_ids[node as usize]);
        let ids: Vec<u64> = same.iter().map(|side| facets[side.1 as usize].id).collect();
        let more = message::and_more(crowded.len() - 1);
        let what = format!("the edge between nodes {a} and {b} has {} facets ({ids:?}){more}", ids.len());
        return Err(message::whole_file(
            &mesh.source,
            what,
            "an edge of a surface has two facets at most; name a group without the others",
        ));
    }
    pairs.sort_unstable();
    let mut starts = vec![0; facets.len() + 1];
    pairs.iter().for_each(|pair| starts[pair.0 as usize + 1] += 1);
    (0..facets.len()).for_each(|facet| starts[facet + 1] += starts[facet]);
    Ok(Neighbours { starts, others: pairs.into_iter().map(|pair| (pair.1, pair.2)).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Facet;

    fn surface(facets: &[&[u32]]) -> Mesh {
        let facet = |(id, listed): (u64, &&[u32])| {
            let mut nodes = [0; 4];
            nodes[..listed.len()].copy_from_slice(listed);
            Facet { count: listed.len() as u8, nodes, id }
        };
        Mesh { point_ids: (100..200).collect(), facets: (1..).zip(facets).map(facet).collect(), ..Mesh::default() }
    }

    fn nodes(mesh: &Mesh) -> Vec<&[u32]> {
        mesh.facets.iter().map(Facet::nodes).collect()
    }

    #[test]
    fn each_part_agrees_with_its_first_facet_or_with_most() {
        // A strip of a quadrilateral, a triangle and a quadrilateral, and a pair of triangles apart from it.
        let mut mesh = surface(&[&[0, 1, 2, 3], &[2, 1, 4], &[2, 4, 6, 5], &[20, 21, 22], &[20, 21, 23]]);
        align(&mut mesh, &[false; 5], false).unwrap();
        assert_eq!(nodes(&mesh), [&[0, 1, 2, 3][..], &[2, 1, 4], &[2, 4, 6, 5], &[20, 21, 22], &[20, 23, 21]]);
        let first_differs = || surface(&[&[0, 1, 2, 3], &[1, 2, 4], &[2, 5, 6, 4]]);
        let mut mesh = first_differs();
        assert_eq!(align(&mut mesh, &[false; 3], false).unwrap(), [2, 3]);
        assert_eq!(nodes(&mesh), [&[0, 1, 2, 3][..], &[1, 4, 2], &[2, 4, 6, 5]]);
        let mut mesh = first_differs();
        assert_eq!(align(&mut mesh, &[false; 3], true).unwrap(), [1]);
        assert_eq!(nodes(&mesh), [&[0, 3, 2, 1][..], &[1, 2, 4], &[2, 5, 6, 4]]);
    }

    #[test]
    fn fixed_facets_decide() {
        let mut mesh = surface(&[&[0, 1, 2, 3], &[1, 2, 4], &[2, 5, 6, 4]]);
        align(&mut mesh, &[false, true, false], true).unwrap();
        assert_eq!(nodes(&mesh), [&[0, 3, 2, 1][..], &[1, 2, 4], &[2, 5, 6, 4]]);
        let text = align(&mut surface(&[&[0, 1, 2], &[0, 1, 3]]), &[true, true], false).unwrap_err().to_string();
        assert!(text.contains("facets 1 and 2 cannot both face outward"), "{text}");
    }

    #[test]
    fn surfaces_with_one_side_and_crowded_edges_are_refused() {
        // A Moebius strip of three quadrilaterals.
        let mut strip = surface(&[&[0, 1, 3, 2], &[2, 3, 5, 4], &[4, 5, 0, 1]]);
        let text = align(&mut strip, &[false; 3], false).unwrap_err().to_string();
        assert!(text.contains("the surface has one side only"), "{text}");
        let mut fan = surface(&[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4]]);
        let text = align(&mut fan, &[false; 3], false).unwrap_err().to_string();
        assert!(text.contains("the edge between nodes 100 and 101 has 3 facets ([1, 2, 3])"), "{text}");
    }
}

//! The thickness of sheets of hexahedra: which of the three directions of each element goes through the sheet.
//!
//! Directions of elements that share a face are one where they share its edges, and where they cross it. What hangs together
//! so and has one direction of every element, no more and no less, may be the thickness; that is taken along which all
//! layers together are thinnest.

use super::faces::{FaceKey, Owner, owners};
use super::{Mesh, Solid, SolidShape};
use crate::Vec3;
use crate::error::{Error, Location, Result};
use crate::scene::Located;

/// Thickness over the shorter of the other two directions, in mean, above which it is not clear which is meant.
const CLEAR: f64 = 0.7;

/// Ends of the edges along each direction.
const EDGES: [[[usize; 2]; 4]; 3] =
    [[[0, 1], [3, 2], [4, 5], [7, 6]], [[0, 3], [1, 2], [4, 7], [5, 6]], [[0, 4], [1, 5], [2, 6], [3, 7]]];

/// The direction that crosses each face.
const ACROSS: [usize; 6] = [2, 2, 1, 0, 1, 0];

/// Nodes in another order, of the same hexahedron, after which its direction 0 or 1 is the last.
const TURNED: [[usize; 8]; 3] = [[0, 3, 7, 4, 1, 2, 6, 5], [0, 4, 5, 1, 3, 7, 6, 2], [0, 1, 2, 3, 4, 5, 6, 7]];

/// Renumbers every hexahedron so that nodes 0 to 3 are on one side of the sheet and nodes 4 to 7 straight across. The
/// thickness is the direction across the faces of a group, if one is given. Other elements stay.
///
/// # Errors
/// A body, at `at`, whose thickness is not clear, or a group that does not tell, or tells what is clear to be another.
pub fn lay_flat(mesh: &mut Mesh, at: &Location, face: Option<&Located<String>>) -> Result<()> {
    if mesh.solids.iter().any(|solid| solid.shape != SolidShape::Hex8) {
        return Ok(());
    }
    let mut directions = Directions::new(&mesh.solids);
    let through = match face {
        Some(group) => {
            let through = directions.across(mesh, group)?;
            let clear = directions.shortest(mesh).unwrap_or_else(|_| through.clone());
            if let Some(e) = (0..through.len()).find(|&e| through[e] != clear[e]) {
                let (lengths, id) = (lengths(mesh, &mesh.solids[e]), mesh.solids[e].id);
                let what = format!(
                    "`{}` is an edge of the sheet and not one of its sides: element {id} is {:.3e} long across it, and {:.3e} \
                     across the sheet",
                    group.value, lengths[through[e]], lengths[clear[e]]
                );
                return Err(Error::input(&group.at, what, "name a group of faces on one side of the sheet, or none"));
            }
            through
        }
        None => directions.shortest(mesh).map_err(|what| {
            let help =
                "name a group of faces on one side of the sheet: shell = { face = \"top\" }; or take \"hex8-eas\"";
            Error::input(at, what, help)
        })?,
    };
    for (solid, direction) in mesh.solids.iter_mut().zip(through) {
        let nodes = solid.nodes;
        TURNED[direction].iter().enumerate().for_each(|(k, &from)| solid.nodes[k] = nodes[from]);
    }
    Ok(())
}

/// Directions of elements, 3 e + i, as sets of those that are one.
struct Directions {
    sets: Sets,
    /// Elements that share faces, however far off.
    pieces: Sets,
    /// A direction across each face that two elements share.
    stacked: Vec<usize>,
}

/// Sets that are joined (Tarjan, J. ACM 22, 1975): each member points to another of its set, or to itself.
struct Sets(Vec<u32>);

impl Sets {
    fn find(&mut self, member: usize) -> usize {
        let mut at = member;
        while self.0[at] as usize != at {
            self.0[at] = self.0[self.0[at] as usize];
            at = self.0[at] as usize;
        }
        at
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b) as u32;
    }
}

/// The direction of an edge of a hexahedron.
fn direction_of(solid: &Solid, edge: [u32; 2]) -> Option<usize> {
    let is = |ends: &[usize; 2]| {
        let [a, b] = ends.map(|k| solid.nodes[k]);
        [a, b] == edge || [b, a] == edge
    };
    (0..3).find(|&i| EDGES[i].iter().any(is))
}

impl Directions {
    fn new(solids: &[Solid]) -> Self {
        let count = solids.len() as u32;
        let mut directions =
            Self { sets: Sets((0..3 * count).collect()), pieces: Sets((0..count).collect()), stacked: Vec::new() };
        let mut faces: Vec<(FaceKey, usize, usize)> = Vec::with_capacity(6 * solids.len());
        for (e, solid) in solids.iter().enumerate() {
            faces.extend((0..6).map(|face| (solid.face(face).key(), e, face)));
        }
        faces.sort_unstable();
        for pair in faces.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let [(_, a, of_a), (_, b, of_b)] = [pair[0], pair[1]];
            directions.pieces.join(a, b);
            directions.stacked.push(3 * a + ACROSS[of_a]);
            directions.sets.join(3 * a + ACROSS[of_a], 3 * b + ACROSS[of_b]);
            let corners = solids[a].face(of_a).nodes;
            for edge in [[corners[0], corners[1]], [corners[1], corners[2]]] {
                if let (Some(i), Some(j)) = (direction_of(&solids[a], edge), direction_of(&solids[b], edge)) {
                    directions.sets.join(3 * a + i, 3 * b + j);
                }
            }
        }
        directions
    }

    /// Of each element the one direction that crosses faces of a group, or hangs together with such.
    fn across(&mut self, mesh: &Mesh, group: &Located<String>) -> Result<Vec<usize>> {
        let facets = mesh.groups.get(&group.value).map_or(&[][..], |found| &found.facets);
        let facets: Vec<_> = facets.iter().map(|&k| mesh.facets[k as usize]).collect();
        let wrong = |what: String| {
            Err(Error::input(&group.at, what, "name a group of faces that is one side of the sheet, whole or in part"))
        };
        if facets.is_empty() {
            return wrong(format!("the body has no group `{}` of faces", group.value));
        }
        let mut chosen = vec![false; 3 * mesh.solids.len()];
        for owner in owners(&mesh.solids, &facets) {
            if let Owner::One { solid, face } = owner {
                chosen[self.sets.find(3 * solid as usize + ACROSS[face as usize])] = true;
            }
        }
        let mut through = Vec::with_capacity(mesh.solids.len());
        for (e, solid) in mesh.solids.iter().enumerate() {
            let is: Vec<usize> = (0..3).filter(|i| chosen[self.sets.find(3 * e + i)]).collect();
            match is[..] {
                [one] => through.push(one),
                [] => return wrong(format!("element {} has no direction across `{}`", solid.id, group.value)),
                _ => {
                    let what = format!("element {} has several directions across `{}`", solid.id, group.value);
                    return wrong(what);
                }
            }
        }
        Ok(through)
    }

    /// Of each element that of the shortest set; or what is not clear.
    fn shortest(&mut self, mesh: &Mesh) -> std::result::Result<Vec<usize>, String> {
        let count = mesh.solids.len();
        let lengths: Vec<[f64; 3]> = mesh.solids.iter().map(|solid| lengths(mesh, solid)).collect();
        // Of each set its elements, the sum of its lengths, that of the shorter of the others, and whether it has two of one.
        let mut sums = vec![(0usize, 0.0, 0.0, false); 3 * count];
        let mut elements = vec![0usize; count];
        for (e, of) in lengths.iter().enumerate() {
            elements[self.pieces.find(e)] += 1;
            let sets = [0, 1, 2].map(|i| self.sets.find(3 * e + i));
            for i in 0..3 {
                let [a, b] = [(i + 1) % 3, (i + 2) % 3];
                let sum = &mut sums[sets[i]];
                *sum = (sum.0 + 1, sum.1 + of[i], sum.2 + of[a].min(of[b]), sum.3);
                sum.3 |= sets[i] == sets[a] || sets[i] == sets[b];
            }
        }
        // Of each set how often elements are stacked; what is left of their number are columns, none in a closed ring.
        let mut stacked = vec![0usize; 3 * count];
        for k in 0..self.stacked.len() {
            stacked[self.sets.find(self.stacked[k])] += 1;
        }
        let thickness = |set: usize| sums[set].1 / (sums[set].0 - stacked[set].min(sums[set].0)) as f64;
        let mut best: Vec<Option<usize>> = vec![None; count];
        for e in 0..count {
            let piece = self.pieces.find(e);
            for set in [0, 1, 2].map(|i| self.sets.find(3 * e + i)) {
                let whole = sums[set].0 == elements[piece] && !sums[set].3;
                if whole && best[piece].is_none_or(|other| thickness(set) < thickness(other)) {
                    best[piece] = Some(set);
                }
            }
        }
        let mut through = Vec::with_capacity(count);
        for (e, solid) in mesh.solids.iter().enumerate() {
            let piece = self.pieces.find(e);
            let Some(set) = best[piece] else {
                return Err(format!(
                    "no direction of element {} goes through a sheet, which must not branch",
                    solid.id
                ));
            };
            let (_, thickness, other, _) = sums[set];
            if thickness > CLEAR * other {
                return Err(format!(
                    "which direction is the thickness is not clear: around element {} that of the sheet is {:.2} of the next",
                    solid.id,
                    thickness / other
                ));
            }
            through.extend((0..3).find(|i| self.sets.find(3 * e + i) == set));
        }
        Ok(through)
    }
}

/// Mean lengths of the edges along each direction.
fn lengths(mesh: &Mesh, solid: &Solid) -> [f64; 3] {
    let place = |k: usize| Vec3::from(mesh.points[solid.nodes[k] as usize]);
    EDGES.map(|edges| edges.iter().map(|[a, b]| (place(*a) - place(*b)).norm()).sum::<f64>() / 4.0)
}

#[cfg(test)]
mod tests {
    use super::super::block::generate;
    use super::*;
    use crate::scene::{Block, BlockShape};
    use crate::solid::element::hex8::{min_jacobian, volume};

    fn block(size: [f64; 3], elements: [usize; 3]) -> Mesh {
        let shape = BlockShape::Box { origin: Vec3::zeros(), size: size.into() };
        let at = Located::given("").at;
        generate(&Located { value: Block { shape, elements, grading: [1.0; 3], faces: Vec::new() }, at }).unwrap()
    }

    fn nodes(mesh: &Mesh, solid: &Solid) -> [[f64; 3]; 8] {
        std::array::from_fn(|k| mesh.points[solid.nodes[k] as usize])
    }

    /// However an element is numbered, its thickness becomes the last direction, and it stays sound.
    #[test]
    fn the_shortest_direction_is_laid_across() {
        let at = Located::given("").at;
        for axis in 0..3 {
            let (mut size, mut elements) = ([4.0, 4.0, 4.0], [4, 4, 4]);
            (size[axis], elements[axis]) = (0.2, 1);
            let mut mesh = block(size, elements);
            // Some are numbered along other directions.
            for (e, solid) in mesh.solids.iter_mut().enumerate() {
                let from = solid.nodes;
                TURNED[e % 3].iter().enumerate().for_each(|(k, &n)| solid.nodes[k] = from[n]);
            }
            lay_flat(&mut mesh, &at, None).unwrap();
            for solid in &mesh.solids {
                let x = nodes(&mesh, solid);
                assert!((0..4).all(|k| (x[k][axis] - x[k + 4][axis]).abs() > 0.19));
                assert!(min_jacobian(&x) > 0.0 && (volume(&x) - 0.2).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn what_is_not_clear_is_refused_and_a_group_tells() {
        let at = Located::given("").at;
        let mut mesh = block([3.0, 3.0, 1.0], [3, 3, 1]);
        let error = lay_flat(&mut mesh, &at, None).unwrap_err().to_string();
        assert!(error.contains("1.00 of the next"), "{error}");
        lay_flat(&mut mesh, &at, Some(&Located::given("xmax"))).unwrap();
        let x = nodes(&mesh, &mesh.solids[4]);
        assert!((0..4).all(|k| (x[k][0] - x[k + 4][0]).abs() == 1.0));
        let error = lay_flat(&mut mesh, &at, Some(&Located::given("rim"))).unwrap_err().to_string();
        assert!(error.contains("no group `rim`"), "{error}");
        let error = lay_flat(&mut block([4.0, 4.0, 0.5], [4, 4, 1]), &at, Some(&Located::given("xmax"))).unwrap_err();
        assert!(error.to_string().contains("1.000e0 long across it, and 5.000e-1 across the sheet"), "{error}");
        // Elements shorter along a strip than it is thick.
        let error = lay_flat(&mut block([10.0, 1.2, 0.25], [60, 1, 1]), &at, None).unwrap_err().to_string();
        assert!(error.contains("1.50 of the next"), "{error}");
        // A wall on a plate: the thickness of the one is along the other.
        let mut mesh = block([3.0, 1.0, 3.0], [3, 1, 3]);
        mesh.solids.retain(|solid| [1, 4, 7, 8, 9].contains(&solid.id));
        assert!(lay_flat(&mut mesh, &at, Some(&Located::given("zmin"))).is_ok());
        mesh.groups.entry("both".into()).or_default().facets = mesh.groups["zmin"].facets.clone();
        let more = mesh.groups["xmin"].facets.clone();
        mesh.groups.entry("both".into()).or_default().facets.extend(more);
        let error = lay_flat(&mut mesh, &at, Some(&Located::given("both"))).unwrap_err().to_string();
        assert!(error.contains("several directions"), "{error}");
    }
}

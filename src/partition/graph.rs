//! Elements to parts by METIS, nodes to owners.

use crate::error::{Error, Result};
use metis::{Graph, mesh_to_dual};

/// Part of each element: METIS k-way on the dual graph, in which elements that share a face are neighbours.
///
/// `elements` are the nodes of each, `weights` its work. With fewer than two elements a part the elements are dealt out in
/// order, and parts beyond their number stay empty.
///
/// # Errors
/// METIS's own, as [`Error::System`].
pub fn element_parts<'a>(elements: impl Iterator<Item = &'a [u32]>, weights: &[i32], parts: usize) -> Result<Vec<i32>> {
    let count = weights.len();
    if parts == 1 {
        return Ok(vec![0; count]);
    }
    if count < 2 * parts {
        return Ok((0..count).map(|e| (e * parts / count) as i32).collect());
    }
    let failed = |e: &dyn std::fmt::Display| Error::System(format!("METIS cannot partition the mesh: {e}"));
    let too_many = |_| failed(&format!("its indices of 32 bits count {} nodes of elements", i32::MAX));
    let mut first = Vec::with_capacity(count + 1);
    let mut nodes = Vec::new();
    first.push(0);
    for element in elements {
        nodes.extend(element.iter().map(|&n| n as i32));
        first.push(i32::try_from(nodes.len()).map_err(too_many)?);
    }
    // Three common nodes make a common face of two elements.
    let dual = mesh_to_dual(&first, &nodes, 3).map_err(|e| failed(&e))?;
    drop((first, nodes));
    let mut part = vec![0; count];
    Graph::new(1, parts as i32, dual.xadj(), dual.adjncy())
        .map_err(|e| failed(&e))?
        .set_vwgt(weights)
        .part_kway(&mut part)
        .map_err(|e| failed(&e))?;
    Ok(part)
}

/// Owner of each node: the part of most of its elements, the lowest of equals; tied nodes have the owner of the node
/// whose equations they share.
pub fn node_owners<'a>(elements: impl Iterator<Item = &'a [u32]> + Clone, part: &[i32], ties: &[u32]) -> Vec<i32> {
    const UNSEEN: i32 = -1;
    const BETWEEN: i32 = -2;
    let mut owner = vec![UNSEEN; ties.len()];
    let incidences = || elements.clone().zip(part).flat_map(|(nodes, &p)| nodes.iter().map(move |&n| (n, p)));
    for (n, p) in incidences() {
        let owner = &mut owner[n as usize];
        *owner = if [UNSEEN, p].contains(owner) { p } else { BETWEEN };
    }
    // Few nodes are between parts.
    let mut touching: Vec<(u32, i32)> = incidences().filter(|(n, _)| owner[*n as usize] == BETWEEN).collect();
    touching.sort_unstable();
    for of_node in touching.chunk_by(|a, b| a.0 == b.0) {
        let most = of_node.chunk_by(|a, b| a.1 == b.1).rev().max_by_key(|run| run.len());
        owner[of_node[0].0 as usize] = most.map_or(0, |run| run[0].1);
    }
    ties.iter().map(|&t| owner[t as usize].max(0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of n hexahedra.
    fn row(n: u32) -> Vec<[u32; 8]> {
        (0..n).map(|e| std::array::from_fn(|k| 4 * e + k as u32)).collect()
    }

    fn parts(row: &[[u32; 8]], weights: &[i32], parts: usize) -> Vec<i32> {
        element_parts(row.iter().map(|nodes| &nodes[..]), weights, parts).unwrap()
    }

    #[test]
    fn weights_balance_the_parts() {
        let weights: Vec<i32> = (0..40).map(|e| if e < 10 { 4 } else { 1 }).collect();
        let part = parts(&row(40), &weights, 2);
        let of = |p: i32| weights.iter().zip(&part).filter(|(_, q)| **q == p).map(|(w, _)| w).sum::<i32>();
        assert!((of(0) - 35).abs() <= 4 && (of(1) - 35).abs() <= 4, "{} {}", of(0), of(1));
    }

    #[test]
    fn more_parts_than_elements_leaves_parts_empty() {
        let part = parts(&row(3), &[1; 3], 13);
        assert!(part.iter().all(|&p| (0..13).contains(&p)));
        assert_eq!(part.iter().collect::<std::collections::BTreeSet<_>>().len(), 3);
    }

    #[test]
    fn a_node_belongs_to_most_of_its_elements_and_ties_follow() {
        let row = row(2);
        let mut ties: Vec<u32> = (0..12).collect();
        ties[11] = 0;
        let owner = node_owners(row.iter().map(|nodes| &nodes[..]), &[1, 0], &ties);
        assert_eq!(owner[0], 1);
        assert_eq!(owner[4], 0, "the lowest of equals");
        assert_eq!(owner[11], 1, "the owner of the node it is tied to");
    }
}

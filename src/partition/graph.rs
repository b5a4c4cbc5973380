//! Elements to parts by METIS, nodes to owners.

use crate::error::{Error, Result};
use metis::{Graph, mesh_to_dual};

/// Part of each element: METIS k-way on the dual graph, in which elements that share a face are neighbours.
///
/// `first[e]..first[e + 1]` are the nodes of element e in `nodes`; `weights` its work. With fewer than two elements a part
/// the elements are dealt out in order, and parts beyond their number stay empty.
///
/// # Errors
/// METIS's own, as [`Error::System`].
pub fn element_parts(first: &[i32], nodes: &[i32], weights: &[i32], parts: usize) -> Result<Vec<i32>> {
    let elements = first.len() - 1;
    if parts == 1 {
        return Ok(vec![0; elements]);
    }
    if elements < 2 * parts {
        return Ok((0..elements).map(|e| (e * parts / elements) as i32).collect());
    }
    let failed = |e: &dyn std::fmt::Display| Error::System(format!("METIS cannot partition the mesh: {e}"));
    // Three common nodes make a common face of two tetrahedra or of two hexahedra.
    let dual = mesh_to_dual(first, nodes, 3).map_err(|e| failed(&e))?;
    let mut part = vec![0; elements];
    Graph::new(1, parts as i32, dual.xadj(), dual.adjncy())
        .map_err(|e| failed(&e))?
        .set_vwgt(weights)
        .part_kway(&mut part)
        .map_err(|e| failed(&e))?;
    Ok(part)
}

/// Owner of each node: the part of most of its elements, the lowest of equals; tied nodes have the owner of the node
/// whose equations they share.
pub fn node_owners(first: &[i32], nodes: &[i32], part: &[i32], ties: &[u32]) -> Vec<i32> {
    let mut touching: Vec<(u32, i32)> = Vec::with_capacity(nodes.len());
    for (e, &p) in part.iter().enumerate() {
        touching.extend(nodes[first[e] as usize..first[e + 1] as usize].iter().map(|&n| (n as u32, p)));
    }
    touching.sort_unstable();
    let mut owner = vec![0; ties.len()];
    for of_node in touching.chunk_by(|a, b| a.0 == b.0) {
        let most = of_node.chunk_by(|a, b| a.1 == b.1).rev().max_by_key(|run| run.len());
        owner[of_node[0].0 as usize] = most.map_or(0, |run| run[0].1);
    }
    ties.iter().map(|&t| owner[t as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of n hexahedra.
    fn row(n: i32) -> (Vec<i32>, Vec<i32>) {
        let first = (0..=n).map(|e| 8 * e).collect();
        let nodes = (0..n).flat_map(|e| (0..8).map(move |k| 4 * e + k)).collect();
        (first, nodes)
    }

    #[test]
    fn weights_balance_the_parts() {
        let (first, nodes) = row(40);
        let weights: Vec<i32> = (0..40).map(|e| if e < 10 { 4 } else { 1 }).collect();
        let part = element_parts(&first, &nodes, &weights, 2).unwrap();
        let of = |p: i32| weights.iter().zip(&part).filter(|(_, q)| **q == p).map(|(w, _)| w).sum::<i32>();
        assert!((of(0) - 35).abs() <= 4 && (of(1) - 35).abs() <= 4, "{} {}", of(0), of(1));
    }

    #[test]
    fn more_parts_than_elements_leaves_parts_empty() {
        let (first, nodes) = row(3);
        let part = element_parts(&first, &nodes, &[1; 3], 13).unwrap();
        assert!(part.iter().all(|&p| (0..13).contains(&p)));
        assert_eq!(part.iter().collect::<std::collections::BTreeSet<_>>().len(), 3);
    }

    #[test]
    fn a_node_belongs_to_most_of_its_elements_and_ties_follow() {
        let (first, nodes) = row(2);
        let mut ties: Vec<u32> = (0..12).collect();
        ties[11] = 0;
        let owner = node_owners(&first, &nodes, &[1, 0], &ties);
        assert_eq!(owner[0], 1);
        assert_eq!(owner[4], 0, "the lowest of equals");
        assert_eq!(owner[11], 1, "the owner of the node it is tied to");
    }
}

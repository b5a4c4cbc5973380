//! Junctions of straight and curved parts, and the normals that they take from the straight side.

use super::super::facets::{Facets, angle};
use super::super::piece::Edge;
use super::groups::Groups;
use super::weight::Weight;
use crate::Vec3;
use crate::controls::Controls;

/// Angle of two facets below which the surface does not turn between them, radians: above the rounding of mesh files.
const NO_TURN: f64 = 1e-4;

/// Makes the edges between two straight sides sharp; returns the junctions as (facet, edge) on the straight side.
pub fn classify(facets: &Facets, edges: &mut [[Edge; 4]], controls: &Controls) -> Vec<(usize, usize)> {
    let around = facets.around_nodes();
    let (mut junctions, mut creases) = (Vec::new(), Vec::new());
    for (f, k) in facets.corners() {
        let Some((g, j)) = facets.across[f][k].filter(|(g, _)| f < *g) else { continue };
        let turn = angle(&facets.normals[f], &facets.normals[g]);
        if edges[f][k] != Edge::Smooth || turn < NO_TURN {
            continue;
        }
        let none = controls.coplanar * turn;
        match (is_straight(facets, &around, f, k, none), is_straight(facets, &around, g, j, none)) {
            (true, true) => creases.extend([(f, k), (g, j)]),
            (true, false) => junctions.push((f, k)),
            (false, true) => junctions.push((g, j)),
            (false, false) => {}
        }
    }
    for (f, k) in creases {
        edges[f][k] = Edge::Sharp;
    }
    junctions
}

/// Whether facet `f` goes on in its plane behind its edge `k`, where a turn of `none` counts as none.
fn is_straight(facets: &Facets, around: &[Vec<(usize, usize)>], f: usize, k: usize, none: f64) -> bool {
    let coplanar = |g: usize| angle(&facets.normals[f], &facets.normals[g]) <= none;
    if facets.count(f) == 4 {
        return facets.across[f][(k + 2) % 4].is_some_and(|(g, _)| coplanar(g));
    }
    let normal = &facets.normals[f];
    let behind = normal.cross(&facets.edge(f, k));
    around[facets.node(f, k + 2)].iter().any(|&(g, j)| {
        let (next, last) = (facets.edge(g, j), -facets.edge(g, j + facets.count(g) - 1));
        let beyond = |a: &Vec3, b: &Vec3| a.cross(b).dot(normal) > -1e-6 * a.norm() * b.norm();
        g != f && coplanar(g) && beyond(&next, &behind) && beyond(&behind, &last)
    })
}

/// Gives the fans on junctions the normal of their straight side; returns the corners that count in their fans.
pub fn straight_sides(
    facets: &Facets,
    weight: Weight,
    (edges, junctions): (&[[Edge; 4]], &[(usize, usize)]),
    fans: &Groups,
    normals: &mut [Vec3],
    controls: &Controls,
) -> Vec<[bool; 4]> {
    let mut is_junction = vec![[false; 4]; facets.nodes.len()];
    let mut other_side = Vec::with_capacity(junctions.len());
    for &(f, k) in junctions {
        if let Some((g, j)) = facets.across[f][k] {
            (is_junction[f][k], is_junction[g][j]) = (true, true);
            other_side.push((g, j));
        }
    }
    let sectors = Groups::new(facets, |f, k| edges[f][k] == Edge::Smooth && !is_junction[f][k]);
    let (mut straight, mut curved) = (vec![false; sectors.count], vec![false; sectors.count]);
    for (sides, flags) in [(junctions, &mut straight), (&other_side, &mut curved)] {
        for &(f, k) in sides {
            flags[sectors.of(f, k)] = true;
            flags[sectors.of(f, (k + 1) % facets.count(f))] = true;
        }
    }
    let decides = |(f, k): (usize, usize)| {
        let sector = sectors.of(f, k);
        straight[sector] && !curved[sector]
    };
    let side = fans.mean(facets, weight, decides);

    // (*) for the edges from each fan into its curved sectors, with the normal of the straight side and with the mean.
    let mut misfit = vec![[0.0; 2]; fans.count];
    for (f, k) in facets.corners().filter(|(f, k)| curved[sectors.of(*f, *k)]) {
        let [next, last] = facets.beside(f, k);
        for (edge, other) in [(k, next), (last, last)] {
            let (here, there) = (fans.of(f, k), fans.of(f, other));
            if !is_junction[f][edge] && side[there] == Vec3::zeros() {
                let d = (facets.point(f, other) - facets.point(f, k)).normalize();
                misfit[here][0] += (side[here] + normals[there]).dot(&d).abs();
                misfit[here][1] += (normals[here] + normals[there]).dot(&d).abs();
            }
        }
    }
    let kept: Vec<bool> = side
        .iter()
        .zip(&misfit)
        .map(|(side, m)| *side != Vec3::zeros() && m[1] >= controls.straight_misfit * m[0])
        .collect();
    for fan in (0..fans.count).filter(|fan| kept[*fan]) {
        normals[fan] = side[fan];
    }
    let counts = |f: usize, k: usize| k < facets.count(f) && (!kept[fans.of(f, k)] || decides((f, k)));
    (0..facets.nodes.len()).map(|f| std::array::from_fn(|k| counts(f, k))).collect()
}

//! Junctions of straight and curved parts, and the normals that they take from the straight side.

use super::super::facets::{Facets, angle};
use super::super::piece::Edge;
use super::groups::Groups;
use super::weight::Weight;
use crate::Vec3;
use crate::controls::Controls;

/// Angle of two facets below which the surface does not turn between them, radians: above the rounding of mesh files.
const NO_TURN: f64 = 1e-4;

/// An edge between a straight part and a curved one.
#[derive(Clone, Copy)]
pub struct Junction {
    /// The facet on the straight side, and its edge.
    side: (usize, usize),
    /// It goes on behind the edge, and is not only deeper than the other.
    goes_on: bool,
}

/// Makes the edges between two straight sides sharp; returns the junctions.
pub fn classify(facets: &Facets, edges: &mut [[Edge; 4]], controls: &Controls) -> Vec<Junction> {
    let around = facets.around_nodes();
    let (mut junctions, mut creases) = (Vec::new(), Vec::new());
    let is_deep = |(f, k), (g, j)| depth(facets, f, k) > controls.straight_depth * depth(facets, g, j);
    for (f, k) in facets.corners() {
        let Some((g, j)) = facets.across[f][k].filter(|(g, _)| f < *g) else { continue };
        let turn = angle(&facets.normals[f], &facets.normals[g]);
        if edges[f][k] != Edge::Smooth || turn < NO_TURN {
            continue;
        }
        let none = controls.coplanar * turn;
        let [here, there] = [(f, k), (g, j)];
        match (is_straight(facets, &around, f, k, none), is_straight(facets, &around, g, j, none)) {
            (true, true) => creases.extend([here, there]),
            (true, false) => junctions.push(Junction { side: here, goes_on: true }),
            (false, true) => junctions.push(Junction { side: there, goes_on: true }),
            (false, false) if is_deep(here, there) => junctions.push(Junction { side: here, goes_on: false }),
            (false, false) if is_deep(there, here) => junctions.push(Junction { side: there, goes_on: false }),
            (false, false) => {}
        }
    }
    for (f, k) in creases {
        edges[f][k] = Edge::Sharp;
    }
    junctions
}

/// How far a facet goes from its edge `k`.
fn depth(facets: &Facets, f: usize, k: usize) -> f64 {
    let along = facets.edge(f, k).normalize();
    let count = facets.count(f);
    let away = |other: usize| {
        let from = facets.point(f, other % count) - facets.point(f, k);
        (from - along * along.dot(&from)).norm()
    };
    (2..count).map(|more| away(k + more)).sum::<f64>() / (count - 2) as f64
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
    (edges, junctions): (&[[Edge; 4]], &[Junction]),
    fans: &Groups,
    normals: &mut [Vec3],
    controls: &Controls,
) -> Vec<[bool; 4]> {
    let mut is_junction = vec![[false; 4]; facets.nodes.len()];
    let mut other_side = Vec::with_capacity(junctions.len());
    // Whether all that tells of a straight side at a fan is how deep it is.
    let mut is_guess = vec![false; fans.count];
    for &Junction { side: (f, k), goes_on } in junctions {
        for corner in [k, (k + 1) % facets.count(f)] {
            is_guess[fans.of(f, corner)] |= !goes_on;
        }
        if let Some((g, j)) = facets.across[f][k] {
            (is_junction[f][k], is_junction[g][j]) = (true, true);
            other_side.push((g, j));
        }
    }
    let sectors = Groups::new(facets, |f, k| edges[f][k] == Edge::Smooth && !is_junction[f][k]);
    let (mut straight, mut curved) = (vec![false; sectors.count], vec![false; sectors.count]);
    let own_side: Vec<(usize, usize)> = junctions.iter().map(|junction| junction.side).collect();
    for (sides, flags) in [(&own_side, &mut straight), (&other_side, &mut curved)] {
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
        .zip(is_guess)
        .map(|((side, [by_side, by_mean]), is_guess)| {
            let fits = match is_guess {
                // Between two such facets alone nothing tells a flat from an arc.
                true => *by_side < controls.straight_misfit * by_mean,
                false => *by_mean >= controls.straight_misfit * by_side,
            };
            *side != Vec3::zeros() && fits
        })
        .collect();
    for fan in (0..fans.count).filter(|fan| kept[*fan]) {
        normals[fan] = side[fan];
    }
    let counts = |f: usize, k: usize| k < facets.count(f) && (!kept[fans.of(f, k)] || decides((f, k)));
    (0..facets.nodes.len()).map(|f| std::array::from_fn(|k| counts(f, k))).collect()
}

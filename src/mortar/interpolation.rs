//! The interpolation of a slave surface from its master, (1) and (2) of the [module](super).

use super::face::Corners;
use super::overlap::{MeanPlane, Point, overlap};
use super::rule;
use crate::Vec3;
use crate::surface::piece_set::tree::{Box, Tree};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Points along a line: where they are exact for the products of four linear functions, and where nothing is, or where these are
/// multiplied by a measure.
const POINTS: [usize; 2] = [3, 8];
/// Cosine between the normals of faces that look at each other, at most.
const FACING: f64 = -0.5;
/// Share of a slave face below which what the master covers of it is left out: its dual functions would be steep.
const LEAST: f64 = 0.01;
/// Share by which a face may be covered more than once: rounding, and curvature.
const TWICE: f64 = 0.01;

/// A slave node as the mean of master nodes.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// P_ik by master node.
    pub weights: BTreeMap<u32, f64>,
    /// D_ii, and what it would be were all covered.
    pub covered: f64,
    pub whole: f64,
}

/// What two surfaces have in common.
#[derive(Clone, Debug, Default)]
pub struct Interpolation {
    /// By slave node.
    pub rows: BTreeMap<u32, Row>,
    /// Area of the slave, and how much of it is covered.
    pub area: f64,
    pub covered: f64,
    /// Largest share of D_ii of a node that is not covered.
    pub bare: f64,
    /// What is covered by faces that look the same way.
    pub same_way: f64,
    /// Largest distance between the two surfaces, and where.
    pub apart: (f64, Vec3),
    /// Where several master faces cover one place.
    pub twice: Option<Vec3>,
}

/// Interpolates the nodes of `slaves`, faces with these nodes at `place`, from those of `masters` that are not farther than
/// `reach`. Areas, dA of (1) and (2), count by the `measure` at the place, linear in it: 1, or of rings the radius.
pub fn interpolate(
    slaves: &[Corners<u32>],
    masters: &[Corners<u32>],
    place: impl Fn(u32) -> Vec3,
    reach: f64,
    measure: impl Fn(&Vec3) -> f64,
) -> Interpolation {
    let lines = POINTS.map(rule::on_line);
    let is_even = |face: &Corners<u32>| face.all().iter().all(|&n| measure(&place(n)) == 1.0);
    let lines = [&lines[usize::from(!slaves.iter().all(is_even))][..], &lines[1][..]];
    let masters: Vec<(Corners<u32>, Corners<Vec3>)> = masters.iter().map(|face| (*face, face.map(&place))).collect();
    let boxes: Vec<Box> = masters.iter().map(|(_, x)| x.around(0.0)).collect();
    let tree = (!boxes.is_empty()).then(|| Tree::new(&boxes));
    let mut found = Interpolation::default();
    for nodes in slaves {
        let corners = nodes.map(&place);
        let Some(plane) = MeanPlane::of(&corners) else { continue };
        let (low, high) = corners.around(reach);
        let near = tree.iter().flat_map(|tree| tree.meeting(&low, &high)).map(|(k, _)| &masters[k]);
        let mut covering = Vec::new();
        let points_under = |x: &Corners<Vec3>| {
            let mut points = overlap(&plane, x, lines);
            points.iter_mut().for_each(|p| p.weight *= measure(&corners.at(&p.slave)));
            points
        };
        for (own, x) in near {
            let points = points_under(x);
            let gaps = points.iter().map(|p| plane.normal.dot(&(x.at(&p.master) - corners.at(&p.slave))));
            let apart = gaps.map(f64::abs).fold(0.0, f64::max);
            if apart > reach {
                continue;
            }
            let cosine = x.area_vector().normalize().dot(&plane.normal);
            if cosine > FACING {
                let same = points.iter().map(|p| p.weight).sum::<f64>();
                found.same_way += if cosine > -FACING { same } else { 0.0 };
                continue;
            }
            if apart > found.apart.0 {
                found.apart = (apart, plane.origin);
            }
            covering.push((own, points));
        }
        found.add(nodes, &plane.origin, &points_under(&corners), &covering);
    }
    found.bare = found.rows.values().map(|row| 1.0 - row.covered / row.whole).fold(0.0, f64::max);
    found.rows.retain(|_, row| row.covered > 0.0);
    for row in found.rows.values_mut() {
        row.weights.values_mut().for_each(|weight| *weight /= row.covered);
    }
    found
}

impl Interpolation {
    /// Adds a slave face: the points of `all` of it, and those of the master faces that cover it.
    fn add(&mut self, nodes: &Corners<u32>, middle: &Vec3, all: &[Point], covering: &[(&Corners<u32>, Vec<Point>)]) {
        let n = nodes.count;
        let area: f64 = all.iter().map(|p| p.weight).sum();
        self.area += area;
        for point in all {
            for (node, shape) in nodes.all().iter().zip(point.slave) {
                self.rows.entry(*node).or_default().whole += point.weight * shape;
            }
        }
        let points = || covering.iter().flat_map(|(_, points)| points);
        let covered: f64 = points().map(|p| p.weight).sum();
        if covered > (1.0 + TWICE) * area {
            self.twice = Some(*middle);
        }
        if covered < LEAST * area {
            return;
        }
        // (2)
        let (mut mass, mut weights) = (DMatrix::<f64>::zeros(n, n), vec![0.0; n]);
        for p in points() {
            for i in 0..n {
                weights[i] += p.weight * p.slave[i];
                (0..n).for_each(|j| mass[(i, j)] += p.weight * p.slave[i] * p.slave[j]);
            }
        }
        let Some(inverse) = mass.cholesky().map(|factor| factor.inverse()) else { return };
        self.covered += covered;
        // (1)
        for i in 0..n {
            let row = self.rows.entry(nodes.x[i]).or_default();
            row.covered += weights[i];
            for (face, points) in covering {
                for p in points {
                    let dual = weights[i] * (0..n).map(|j| inverse[(i, j)] * p.slave[j]).sum::<f64>();
                    for (node, shape) in face.all().iter().zip(p.master) {
                        *row.weights.entry(*node).or_default() += p.weight * dual * shape;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat3;

    /// Quadrilaterals over the rectangle from the origin to `far`, or two triangles in each, with nodes within it askew;
    /// nodes count from `first`, and all is turned over where it is to look down.
    fn grid(n: [usize; 2], far: [f64; 2], first: u32, tris: bool, down: bool) -> (Vec<Corners<u32>>, Vec<Vec3>) {
        let at = |i: usize, j: usize| {
            let [s, t] = [i as f64 / n[0] as f64, j as f64 / n[1] as f64];
            let bump = 0.06 * (std::f64::consts::PI * s).sin() * (std::f64::consts::PI * t).sin();
            Vec3::new(far[0] * (s + bump), far[1] * (t - bump), 0.0)
        };
        let points = (0..=n[1]).flat_map(|j| (0..=n[0]).map(move |i| at(i, j))).collect();
        let node = |i: usize, j: usize| first + (i + (n[0] + 1) * j) as u32;
        let cells = (0..n[1]).flat_map(|j| (0..n[0]).map(move |i| (i, j)));
        let quads = cells.map(|(i, j)| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
        let parts =
            |q: [u32; 4]| if tris { vec![vec![q[0], q[1], q[2]], vec![q[0], q[2], q[3]]] } else { vec![q.to_vec()] };
        let turned = |mut face: Vec<u32>| {
            if down {
                face.reverse();
            }
            Corners::new(&face)
        };
        (quads.flat_map(parts).map(turned).collect(), points)
    }

    /// Means keep constants and linear fields, where the master ends, too; and what an even traction gives to the slave's nodes
    /// comes to the master's as it would be there.
    #[test]
    fn linear_fields_and_even_tractions_pass_unlike_flat_meshes() {
        let turn =
            Mat3::from_columns(&[Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.48, 0.36, 0.8), Vec3::new(0.64, -0.48, 0.6)]);
        for (tris, far, gap) in [([false; 2], 2.0, 0.0), ([false, true], 2.0, 0.1), ([true, false], 1.7, 0.0)] {
            let (slaves, mut points) = grid([3, 4], [2.0, 1.0], 0, tris[0], true);
            points.iter_mut().for_each(|x| x.z += gap);
            let first = points.len() as u32;
            let (masters, others) = grid([2, 3], [far, 1.0], first, tris[1], false);
            points.extend(others);
            let points: Vec<Vec3> = points.iter().map(|x| turn * x).collect();
            let place = |n: u32| points[n as usize];
            let found = interpolate(&slaves, &masters, place, 0.5, |_| 1.0);
            assert!((found.area - 2.0).abs() < 1e-14 && (found.covered - far).abs() < 1e-14, "{found:?}");
            assert!((found.apart.0 - gap).abs() < 1e-15 && found.twice.is_none() && found.same_way == 0.0);
            let mut on_masters = BTreeMap::new();
            for (node, row) in &found.rows {
                let sum: f64 = row.weights.values().sum();
                assert!((sum - 1.0).abs() < 1e-13, "{sum}");
                let mean: Vec3 = row.weights.iter().map(|(n, weight)| place(*n) * *weight).sum();
                assert!((mean - place(*node) + turn * Vec3::z() * gap).norm() < 1e-13, "{node}");
                for (master, weight) in &row.weights {
                    *on_masters.entry(*master).or_insert(0.0) += weight * row.covered;
                }
            }
            let whole = interpolate(&masters, &slaves, place, 0.5, |_| 1.0);
            for (master, row) in whole.rows {
                assert!(
                    (on_masters[&master] - row.whole).abs() < 1e-9,
                    "{tris:?}: {}",
                    on_masters[&master] - row.whole
                );
            }
        }
    }

    #[test]
    fn what_is_not_covered_is_told() {
        let (slaves, mut points) = grid([2, 2], [1.0, 1.0], 0, false, true);
        let first = points.len() as u32;
        let (masters, others) = grid([2, 2], [1.0, 1.0], first, false, false);
        points.extend(others.iter().map(|x| x + Vec3::x() * 0.25));
        let of = |masters: &[Corners<u32>]| interpolate(&slaves, masters, |n| points[n as usize], 0.5, |_| 1.0);
        let found = of(&masters);
        assert!((found.covered - 0.75).abs() < 1e-14 && (found.bare - 0.75).abs() < 0.1, "{found:?}");
        let over: Vec<Corners<u32>> =
            masters.iter().map(|face| Corners::new(&face.x.iter().rev().copied().collect::<Vec<_>>())).collect();
        let same = of(&over);
        assert!(same.covered == 0.0 && (same.same_way - 0.75).abs() < 1e-14 && same.rows.is_empty());
        assert!(of(&[&masters[..], &masters[..]].concat()).twice.is_some());
    }
}

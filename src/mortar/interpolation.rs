//! The interpolation of a slave surface from its master, (1) to (3) of the [module](super).

use super::face::{Corners, Face, MOST};
use super::overlap::{MeanPlane, Point, overlap};
use super::rule;
use crate::surface::piece_set::tree::{Box, Tree};
use crate::{Mat2, Vec2, Vec3};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Points along a line: where they are exact for the products of the shape functions of two linear faces or quadratic triangles, of
/// two faces of nine nodes, and where nothing is, or where these are multiplied by a measure.
const POINTS: [usize; 3] = [3, 5, 8];
/// Cosine between the normals of faces that look at each other, at most.
const FACING: f64 = -0.5;
/// Share of a slave face below which what the master covers of it is left out: its dual functions would be steep.
const LEAST: f64 = 0.01;
/// Share by which a face may be covered more than once: rounding, and curvature.
const TWICE: f64 = 0.01;
/// α of (3), between 0 and 1/2, where the integrals of all functions are above nothing: that of Popp et al. (SIAM J. Sci. Comput. 34,
/// 2012). Linear fields on flat seams do not feel it, nor does any on like meshes.
const SHIFT: f64 = 0.2;

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

/// An integration point with the shape functions of whole faces, and how far the master is before the slave there.
struct Common {
    weight: f64,
    slave: [f64; MOST],
    master: [f64; MOST],
    gap: f64,
}

/// A face and a piece of it.
type Part<'a> = (&'a Face, Corners<usize>, Corners<Vec3>);

impl Common {
    /// Of a point in the mean plane of the slave's piece. Linear faces are integrated in that plane, along its normal. Of others,
    /// whose chords only lead there, area and normal are those of the slave.
    fn of(p: &Point, plane: &MeanPlane, [slave, master]: [&Part; 2], place: impl Fn(u32) -> Vec3) -> Self {
        let [at, mut other] =
            [(slave, &p.slave), (master, &p.master)].map(|((face, piece, _), shapes)| face.local(piece, shapes));
        let [x, by_s, by_t] = slave.0.at(&at, &place);
        let (mut weight, mut normal) = (p.weight, plane.normal);
        if slave.0.is_quadratic() {
            let area = by_s.cross(&by_t);
            // A piece has a quarter of the reference face.
            weight *= 0.25 * area.norm() / slave.2.area_at(&p.slave).dot(&plane.normal);
            normal = area.normalize();
        }
        if slave.0.is_quadratic() || master.0.is_quadratic() {
            other = meeting(master.0, other, &x, [by_s, by_t], &place);
        }
        let gap = normal.dot(&(master.0.at(&other, &place)[0] - x));
        Self { weight, slave: slave.0.shapes(&at)[0], master: master.0.shapes(&other)[0], gap }
    }
}

/// Where in a master face, near a point of it, the normal to these two directions through `x` meets it.
fn meeting(face: &Face, near: Vec2, x: &Vec3, along: [Vec3; 2], place: impl Fn(u32) -> Vec3) -> Vec2 {
    const ITERATIONS: usize = 20;
    let mut at = near;
    for _ in 0..ITERATIONS {
        let [there, by_s, by_t] = face.at(&at, &place);
        let off = along.map(|along| along.dot(&(there - x)));
        let [first, second] = along.map(|along| [along.dot(&by_s), along.dot(&by_t)]);
        let Some(step) = Mat2::new(first[0], first[1], second[0], second[1]).lu().solve(&Vec2::from(off)) else {
            return near;
        };
        at -= step;
        if step.norm() <= 4.0 * f64::EPSILON {
            break;
        }
    }
    // Beyond the face its shape soon is another one.
    if (at - near).norm() < 1.0 { at } else { near }
}

/// Interpolates the nodes of `slaves`, faces with these nodes at `place`, from those of `masters` that are not farther than
/// `reach`. Nodes with the same number of `one` move as one, and are that in what comes out. Areas, dA of (1) and (2), count by
/// the `measure` at the place, linear in it: 1, or of rings the radius.
pub fn interpolate(
    slaves: &[Face],
    masters: &[Face],
    place: impl Fn(u32) -> Vec3,
    one: impl Fn(u32) -> u32,
    reach: f64,
    measure: impl Fn(&Vec3) -> f64,
) -> Interpolation {
    let lines = POINTS.map(rule::on_line);
    let is_even = slaves.iter().flat_map(|face| &face.nodes).all(|&n| measure(&place(n)) == 1.0);
    let of_nine = slaves.iter().chain(masters).any(|face| face.nodes.len() == MOST);
    let exact = if is_even { usize::from(of_nine) } else { 2 };
    let lines = [&lines[exact][..], &lines[2][..]];
    let pieces = |face: &'_ Face| -> Vec<(Corners<usize>, Corners<Vec3>)> {
        face.pieces.iter().map(|piece| (*piece, piece.map(|k| place(face.nodes[k])))).collect()
    };
    let masters: Vec<Part> =
        masters.iter().flat_map(|face| pieces(face).into_iter().map(move |(piece, x)| (face, piece, x))).collect();
    let boxes: Vec<Box> = masters.iter().map(|(_, _, x)| x.around(0.0)).collect();
    let tree = (!boxes.is_empty()).then(|| Tree::new(&boxes));
    let mut found = Interpolation::default();
    for face in slaves {
        let (mut all, mut covering) = (Vec::new(), Vec::new());
        for (piece, corners) in pieces(face) {
            let Some(plane) = MeanPlane::of(&corners) else { continue };
            let (low, high) = corners.around(reach);
            let near = tree.iter().flat_map(|tree| tree.meeting(&low, &high)).map(|(k, _)| &masters[k]);
            let own = (face, piece, corners);
            let points_under = |other: &Part| -> Vec<Common> {
                let of = |p: Point| {
                    let point = Common::of(&p, &plane, [&own, other], &place);
                    Common { weight: point.weight * measure(&corners.at(&p.slave)), ..point }
                };
                overlap(&plane, &other.2, lines).into_iter().map(of).collect()
            };
            for other in near {
                let points = points_under(other);
                let apart = points.iter().map(|p| p.gap.abs()).fold(0.0, f64::max);
                if apart > reach {
                    continue;
                }
                let cosine = other.2.area_vector().normalize().dot(&plane.normal);
                if cosine > FACING {
                    let same = points.iter().map(|p| p.weight).sum::<f64>();
                    found.same_way += if cosine > -FACING { same } else { 0.0 };
                    continue;
                }
                if apart > found.apart.0 {
                    found.apart = (apart, plane.origin);
                }
                covering.push((other.0, points));
            }
            all.extend(points_under(&own));
        }
        found.add((face, face.centre(&place)), &one, &all, &covering);
    }
    found.finish(slaves, one);
    found
}

/// Ñ of (3) for the shape functions of a face.
fn shifted(face: &Face, shapes: &[f64; MOST]) -> [f64; MOST] {
    let mut shifted = *shapes;
    for (middle, ends) in face.middles() {
        ends.iter().for_each(|&end| shifted[end] += SHIFT * shapes[middle]);
        shifted[middle] = (1.0 - 2.0 * SHIFT) * shapes[middle];
    }
    shifted
}

impl Interpolation {
    /// Adds a slave face with its centre: the points of `all` of it, and those of the master faces that cover it.
    fn add(
        &mut self,
        (face, centre): (&Face, Vec3),
        one: impl Fn(u32) -> u32,
        all: &[Common],
        covering: &[(&Face, Vec<Common>)],
    ) {
        let n = face.nodes.len();
        let area: f64 = all.iter().map(|p| p.weight).sum();
        self.area += area;
        for point in all {
            for (node, shape) in face.nodes.iter().zip(shifted(face, &point.slave)) {
                self.rows.entry(one(*node)).or_default().whole += point.weight * shape;
            }
        }
        let own = |p: &Common| (p.weight, shifted(face, &p.slave));
        let points: Vec<_> = covering.iter().flat_map(|(_, points)| points).map(own).collect();
        let covered: f64 = points.iter().map(|(weight, _)| weight).sum();
        if covered > (1.0 + TWICE) * area {
            self.twice = Some(centre);
        }
        if covered < LEAST * area {
            return;
        }
        // (2)
        let (mut mass, mut weights) = (DMatrix::<f64>::zeros(n, n), vec![0.0; n]);
        for (weight, shape) in &points {
            for i in 0..n {
                weights[i] += weight * shape[i];
                (0..n).for_each(|j| mass[(i, j)] += weight * shape[i] * shape[j]);
            }
        }
        let Some(inverse) = mass.cholesky().map(|factor| factor.inverse()) else { return };
        self.covered += covered;
        // (1)
        let of_masters = covering.iter().flat_map(|(other, points)| points.iter().map(move |p| (other, &p.master)));
        for i in 0..n {
            let row = self.rows.entry(one(face.nodes[i])).or_default();
            row.covered += weights[i];
            for ((weight, shape), (other, master)) in points.iter().zip(of_masters.clone()) {
                let dual = weights[i] * (0..n).map(|j| inverse[(i, j)] * shape[j]).sum::<f64>();
                for (node, of_master) in other.nodes.iter().zip(master) {
                    *row.weights.entry(one(*node)).or_default() += weight * dual * of_master;
                }
            }
        }
    }

    /// Divides by D_ii, and takes back the shift of middles.
    fn finish(&mut self, slaves: &[Face], one: impl Fn(u32) -> u32) {
        self.bare = self.rows.values().map(|row| 1.0 - row.covered / row.whole).fold(0.0, f64::max);
        self.rows.retain(|_, row| row.covered > 0.0);
        for row in self.rows.values_mut() {
            row.weights.values_mut().for_each(|weight| *weight /= row.covered);
        }
        // (3)
        let mut middles: BTreeMap<u32, [u32; 2]> = BTreeMap::new();
        for face in slaves {
            let number = |k: usize| one(face.nodes[k]);
            middles.extend(face.middles().map(|(middle, ends)| (number(middle), ends.map(number))));
        }
        for (middle, ends) in middles {
            let Some(mut row) = self.rows.remove(&middle) else { continue };
            row.weights.values_mut().for_each(|weight| *weight *= 1.0 - 2.0 * SHIFT);
            for (node, weight) in ends.iter().filter_map(|end| self.rows.get(end)).flat_map(|end| &end.weights) {
                *row.weights.entry(*node).or_default() += SHIFT * weight;
            }
            self.rows.insert(middle, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat3;

    /// Quadrilaterals over the rectangle from the origin to `far`, of 4 or 9 nodes, or two triangles in each, of 3 or 6, with nodes
    /// within it askew; nodes count from `first`, and all is turned over where it is to look down.
    fn grid(n: [usize; 2], far: [f64; 2], first: u32, kind: usize, down: bool) -> (Vec<Face>, Vec<Vec3>) {
        let is_quadratic = kind > 4;
        let per_cell = if is_quadratic { 2 } else { 1 };
        let nodes = n.map(|n| per_cell * n);
        let askew = |i: usize, j: usize| {
            let [s, t] = [i as f64 / n[0] as f64, j as f64 / n[1] as f64];
            let bump = 0.06 * (std::f64::consts::PI * s).sin() * (std::f64::consts::PI * t).sin();
            Vec3::new(far[0] * (s + bump), far[1] * (t - bump), 0.0)
        };
        let mean = |a: [usize; 2], b: [usize; 2]| 0.5 * (askew(a[0], a[1]) + askew(b[0], b[1]));
        let at = |i: usize, j: usize| match [i % per_cell, j % per_cell] {
            [0, 0] => askew(i / per_cell, j / per_cell),
            // Along the diagonal of the triangles.
            [1, 1] if kind == 6 => mean([i / 2, j / 2], [i / 2 + 1, j / 2 + 1]),
            [odd_i, odd_j] => {
                let ([i, j], [k, l]) = ([i / 2, j / 2], [i / 2 + odd_i, j / 2 + odd_j]);
                0.5 * (mean([i, j], [k, l]) + mean([i, l], [k, j]))
            }
        };
        let points = (0..=nodes[1]).flat_map(|j| (0..=nodes[0]).map(move |i| at(i, j))).collect();
        let node = |[i, j]: [usize; 2]| first + (i + (nodes[0] + 1) * j) as u32;
        let corners: &[&[[usize; 2]]] = match kind % 3 {
            0 if kind < 9 => &[&[[0, 0], [1, 0], [1, 1]], &[[0, 0], [1, 1], [0, 1]]],
            _ => &[&[[0, 0], [1, 0], [1, 1], [0, 1]]],
        };
        let cells = (0..n[1]).flat_map(|j| (0..n[0]).map(move |i| [i, j]));
        let faces = cells.flat_map(|cell| corners.iter().map(move |corners| (cell, corners.to_vec())));
        let face = |(cell, mut corners): ([usize; 2], Vec<[usize; 2]>)| {
            if down {
                corners.reverse();
            }
            let place = |d: usize, doubled: usize| (per_cell * (2 * cell[d]) + per_cell * doubled) / 2;
            let node_at = |doubled: [usize; 2]| node([place(0, doubled[0]), place(1, doubled[1])]);
            let ends = |k: usize| (corners[k], corners[(k + 1) % corners.len()]);
            let mut nodes: Vec<u32> = corners.iter().map(|corner| node_at(corner.map(|x| 2 * x))).collect();
            if !is_quadratic {
                return Face::linear(&nodes);
            }
            let middle = |k: usize| [0, 1].map(|d| ends(k).0[d] + ends(k).1[d]);
            nodes.extend((0..corners.len()).map(|k| node_at(middle(k))));
            let pieces: &[&[usize]] = if kind == 9 {
                nodes.push(node_at([1, 1]));
                &[&[0, 4, 8, 7], &[1, 5, 8, 4], &[2, 6, 8, 5], &[3, 7, 8, 6]]
            } else {
                &[&[0, 3, 5], &[1, 4, 3], &[2, 5, 4], &[3, 4, 5]]
            };
            Face { nodes, pieces: pieces.iter().map(|piece| Corners::new(piece)).collect() }
        };
        (faces.map(face).collect(), points)
    }

    /// Means keep constants and linear fields, where the master ends, too; and what an even traction gives to the slave's nodes
    /// comes to the master's as it would be there. Faces of all kinds.
    #[test]
    fn linear_fields_and_even_tractions_pass_unlike_flat_meshes() {
        let turn =
            Mat3::from_columns(&[Vec3::new(0.6, 0.8, 0.0), Vec3::new(-0.48, 0.36, 0.8), Vec3::new(0.64, -0.48, 0.6)]);
        let kinds = [[4, 4], [4, 3], [3, 4], [6, 6], [6, 4], [4, 6], [9, 9], [9, 6], [6, 9], [3, 9], [9, 4]];
        for ([slave, master], (far, gap)) in
            kinds.into_iter().zip([(2.0, 0.0), (2.0, 0.1), (1.7, 0.0)].into_iter().cycle())
        {
            let (slaves, mut points) = grid([3, 4], [2.0, 1.0], 0, slave, true);
            points.iter_mut().for_each(|x| x.z += gap);
            let first = points.len() as u32;
            let (masters, others) = grid([2, 3], [far, 1.0], first, master, false);
            points.extend(others);
            let points: Vec<Vec3> = points.iter().map(|x| turn * x).collect();
            let place = |n: u32| points[n as usize];
            let look = |slaves: &[Face], masters: &[Face]| interpolate(slaves, masters, place, |n| n, 0.5, |_| 1.0);
            let found = look(&slaves, &masters);
            assert!((found.area - 2.0).abs() < 1e-14 && (found.covered - far).abs() < 1e-14, "{found:?}");
            assert!((found.apart.0 - gap).abs() < 1e-15 && found.twice.is_none() && found.same_way == 0.0);
            for (node, row) in &found.rows {
                let sum: f64 = row.weights.values().sum();
                assert!((sum - 1.0).abs() < 1e-12, "{slave} on {master}: {sum}");
                let mean: Vec3 = row.weights.iter().map(|(n, weight)| place(*n) * *weight).sum();
                let off = (mean - place(*node) + turn * Vec3::z() * gap).norm();
                assert!(off < 1e-12, "{slave} on {master}: {node} by {off:e}");
            }
            if far < 2.0 {
                continue;
            }
            let [onto, own] = [even(&found, &slaves), even(&look(&masters, &slaves), &masters)];
            let mut on_masters: BTreeMap<u32, f64> = BTreeMap::new();
            for (node, force) in onto {
                for (to, weight) in &found.rows[&node].weights {
                    *on_masters.entry(*to).or_default() += weight * force;
                }
            }
            for (node, force) in own {
                let off = on_masters[&node] - force;
                assert!(off.abs() < 1e-9, "{slave} on {master}: {node} by {off:e}");
            }
        }
    }

    /// ∫ N_i dA, from those of Ñ.
    fn even(found: &Interpolation, faces: &[Face]) -> BTreeMap<u32, f64> {
        let mut sums: BTreeMap<u32, f64> = found.rows.iter().map(|(node, row)| (*node, row.whole)).collect();
        let mut ends: BTreeMap<u32, [u32; 2]> = BTreeMap::new();
        for face in faces {
            ends.extend(face.middles().map(|(middle, ends)| (face.nodes[middle], ends.map(|end| face.nodes[end]))));
        }
        for (middle, ends) in ends {
            let own = sums[&middle] / (1.0 - 2.0 * SHIFT);
            sums.insert(middle, own);
            ends.iter().for_each(|end| *sums.get_mut(end).unwrap() -= SHIFT * own);
        }
        sums
    }

    /// Where both meshes are one, means are the nodes themselves, of all kinds of faces.
    #[test]
    fn like_meshes_are_joined_node_to_node() {
        for kind in [3, 4, 6, 9] {
            let (slaves, mut points) = grid([3, 2], [2.0, 1.0], 0, kind, true);
            let first = points.len() as u32;
            let (masters, others) = grid([3, 2], [2.0, 1.0], first, kind, false);
            points.extend(others);
            let found = interpolate(&slaves, &masters, |n| points[n as usize], |n| n, 0.5, |_| 1.0);
            assert_eq!(found.rows.len(), first as usize);
            for (node, row) in found.rows {
                for (master, weight) in row.weights {
                    let expected = f64::from(master == first + node);
                    assert!((weight - expected).abs() < 1e-12, "{kind}: {node} from {master}: {weight}");
                }
            }
        }
    }

    #[test]
    fn what_is_not_covered_is_told() {
        let (slaves, mut points) = grid([2, 2], [1.0, 1.0], 0, 4, true);
        let first = points.len() as u32;
        let (masters, others) = grid([2, 2], [1.0, 1.0], first, 4, false);
        points.extend(others.iter().map(|x| x + Vec3::x() * 0.25));
        let of = |masters: &[Face]| interpolate(&slaves, masters, |n| points[n as usize], |n| n, 0.5, |_| 1.0);
        let found = of(&masters);
        assert!((found.covered - 0.75).abs() < 1e-14 && (found.bare - 0.75).abs() < 0.1, "{found:?}");
        let over: Vec<Face> =
            masters.iter().map(|face| Face::linear(&face.nodes.iter().rev().copied().collect::<Vec<_>>())).collect();
        let same = of(&over);
        assert!(same.covered == 0.0 && (same.same_way - 0.75).abs() < 1e-14 && same.rows.is_empty());
        assert!(of(&[&masters[..], &masters[..]].concat()).twice.is_some());
    }
}

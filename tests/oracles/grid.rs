//! Meshes of hexahedra from blocks that share nodes, as the text of a Gmsh 2.2 file, and places of their nodes.

use std::collections::{BTreeMap, HashMap};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

#[derive(Default)]
pub struct Grid {
    points: Vec<[f64; 3]>,
    cells: Vec<[usize; 8]>,
    faces: BTreeMap<String, Vec<[usize; 4]>>,
    marks: BTreeMap<String, Vec<usize>>,
    known: HashMap<[i64; 3], usize>,
}

impl Grid {
    /// Adds a block with these places along its axes, taken to space by `place`, which keeps its handedness. Nodes at one
    /// place, to 1e-9, are one node. The names of its sides: first and last of each axis; none for "".
    pub fn block(mut self, axes: [&[f64]; 3], sides: [&str; 6], place: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let n = axes.map(|a| a.len() - 1);
        let mut ids = HashMap::new();
        for k in 0..=n[2] {
            for j in 0..=n[1] {
                for i in 0..=n[0] {
                    let id = self.node(place([axes[0][i], axes[1][j], axes[2][k]]));
                    ids.insert([i, j, k], id);
                }
            }
        }
        for k in 0..n[2] {
            for j in 0..n[1] {
                for i in 0..n[0] {
                    let corner = |[a, b, c]: [usize; 3]| ids[&[i + a, j + b, k + c]];
                    let ring = [[0, 0], [1, 0], [1, 1], [0, 1]];
                    let [low, high] = [0, 1].map(|c| ring.map(|[a, b]| corner([a, b, c])));
                    self.cells.push([low[0], low[1], low[2], low[3], high[0], high[1], high[2], high[3]]);
                }
            }
        }
        for (s, name) in sides.into_iter().enumerate().filter(|(_, name)| !name.is_empty()) {
            let (axis, end) = (s / 2, s % 2);
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            for (i, j) in (0..n[a]).flat_map(|i| (0..n[b]).map(move |j| (i, j))) {
                let corner = |di: usize, dj: usize| {
                    let mut at = [end * n[axis]; 3];
                    (at[a], at[b]) = (i + di, j + dj);
                    ids[&at]
                };
                let mut face = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                if end == 0 {
                    face.reverse();
                }
                self.faces.entry(name.to_string()).or_default().push(face);
            }
        }
        self
    }

    /// Gives the nodes that `at` takes a name.
    pub fn mark(mut self, name: &str, at: impl Fn(&[f64; 3]) -> bool) -> Self {
        let nodes: Vec<usize> = (0..self.points.len()).filter(|&n| at(&self.points[n])).collect();
        assert!(!nodes.is_empty(), "no node at `{name}`");
        self.marks.insert(name.to_string(), nodes);
        self
    }

    fn node(&mut self, point: [f64; 3]) -> usize {
        let key = point.map(|x| (x * 1e9).round() as i64);
        *self.known.entry(key).or_insert_with(|| {
            self.points.push(point);
            self.points.len() - 1
        })
    }

    pub fn text(&self) -> String {
        let mut names = String::new();
        let mut lines = Vec::new();
        let mut group = 0;
        let mut add = |dimension: usize, name: &str, kind: usize, elements: Vec<&[usize]>| {
            group += 1;
            let _ = writeln!(names, "{dimension} {group} \"{name}\"");
            for nodes in elements {
                let nodes: Vec<String> = nodes.iter().map(|n| (n + 1).to_string()).collect();
                lines.push(format!("{kind} 2 {group} {group} {}", nodes.join(" ")));
            }
        };
        for (name, nodes) in &self.marks {
            add(0, name, 15, nodes.iter().map(std::slice::from_ref).collect());
        }
        for (name, faces) in &self.faces {
            add(2, name, 3, faces.iter().map(|f| f.as_slice()).collect());
        }
        add(3, "solid", 5, self.cells.iter().map(|c| c.as_slice()).collect());
        let mut text =
            format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{group}\n{names}$EndPhysicalNames\n");
        let _ = writeln!(text, "$Nodes\n{}", self.points.len());
        for (k, [x, y, z]) in self.points.iter().enumerate() {
            let _ = writeln!(text, "{} {x:?} {y:?} {z:?}", k + 1);
        }
        let _ = writeln!(text, "$EndNodes\n$Elements\n{}", lines.len());
        for (k, line) in lines.iter().enumerate() {
            let _ = writeln!(text, "{} {line}", k + 1);
        }
        text + "$EndElements\n"
    }
}

/// `count` even elements between two places.
pub fn even(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..=count).map(|k| from + (to - from) * k as f64 / count as f64).collect()
}

/// So many elements, times `fine`.
pub fn part(count: usize, fine: f64) -> usize {
    (count as f64 * fine).round() as usize
}

/// Goes on from the last of some places to `to` by `count` elements that grow (or shrink) from `first` by a constant
/// ratio.
pub fn on(mut places: Vec<f64>, first: f64, to: f64, count: i32) -> Vec<f64> {
    let from = *places.last().unwrap();
    let far = |ratio: f64, n: i32| (0..n).map(|k| first * ratio.powi(k)).sum::<f64>();
    let ratio = crate::common::root(0.05, 20.0, |ratio| far(ratio, count) - (to - from).abs());
    places.extend((1..=count).map(|n| if n == count { to } else { from + (to - from).signum() * far(ratio, n) }));
    places
}

/// Places in the reverse order, with their sign turned.
pub fn mirrored(places: &[f64]) -> Vec<f64> {
    places.iter().rev().map(|x| -x).collect()
}

/// Takes (radius, part of a quarter from 0 to 1, z) to space, for a quarter of a body that is even about the axis along z,
/// with so many elements around it. The radius is that of the circle whose quarter has the area of the polygon.
///
/// Of a field that is even around the axis the polygon keeps volumes, but makes gradients along the radius larger where
/// its sides are near the axis: it is stiffer by about tan(h) / h - 1 with 2 h the angle of an element, that is 0.6 % with
/// 6 elements and 2.3 % with 3.
pub fn turned(around: usize) -> impl Fn([f64; 3]) -> [f64; 3] {
    let stretch = stretch(around);
    move |[radius, part, z]| {
        let (s, c) = (part * FRAC_PI_2).sin_cos();
        let clean = |x: f64| if x.abs() < 1e-12 { 0.0 } else { x };
        [clean(stretch * radius * c), clean(stretch * radius * s), z]
    }
}

/// By how much the polygon of [`turned`] stands out of its circle at its nodes.
pub fn stretch(around: usize) -> f64 {
    let wide = FRAC_PI_2 / around as f64;
    (wide / wide.sin()).sqrt()
}

/// Takes the square from -1 to 1 to the unit disk: smooth, with the corners of the square on the circle.
pub fn disk(u: f64, v: f64) -> (f64, f64) {
    (u * (1.0 - 0.5 * v * v).sqrt(), v * (1.0 - 0.5 * u * u).sqrt())
}

//! Refuses meshes that cannot be computed with, and names what is wrong by the numbers of the file.

use super::faces::{TET_EDGES, boundary};
use super::{Facet, MOST_NODES, Mesh, Solid, SolidShape, message};
use crate::error::{Error, Result};
use crate::solid::element::{hex27, wedge18};
use crate::{Mat3, Vec3};
use std::collections::HashMap;

/// Coincident nodes are closer than this times the size of the elements around them.
const COINCIDENT: f64 = 1e-9;
/// A volume or area is zero below this times the product of the lengths that span it.
const FLAT: f64 = 1e-10;

/// Checks a whole mesh: coordinates, connectivity, shapes of elements and facets, duplicates, coincident nodes.
///
/// A hexahedron and a wedge must have a positive Jacobian determinant at their integration points and corners, a quadratic
/// tetrahedron at its four integration points and all its nodes.
pub fn check(mesh: &Mesh) -> Result<()> {
    let broken = (0..mesh.points.len()).filter(|&node| !mesh.points[node].iter().all(|x| x.is_finite()));
    refuse(mesh, "node", ids_of(mesh, broken), "not at a finite place", "give it finite coordinates")?;
    check_connectivity(mesh)?;
    check_solids(mesh)?;
    check_middles(mesh)?;
    check_fit(mesh)?;
    check_facets(mesh)?;
    check_duplicates(mesh)?;
    check_coincident(mesh)
}

fn ids_of(mesh: &Mesh, nodes: impl Iterator<Item = usize>) -> Vec<u64> {
    nodes.map(|node| mesh.point_ids.get(node).copied().unwrap_or(node as u64)).collect()
}

/// An error when `ids` holds any: "nodes 3, 4, 5 and 7 more are `what`".
fn refuse(mesh: &Mesh, kind: &str, mut ids: Vec<u64>, what: &str, help: &str) -> Result<()> {
    // Parts of an element have its number.
    ids.dedup();
    match ids.is_empty() {
        true => Ok(()),
        false => Err(fail(mesh, format!("{} {what}", message::several(kind, &ids)), help)),
    }
}

fn fail(mesh: &Mesh, what: String, help: &str) -> Error {
    message::whole_file(&mesh.source, what, help)
}

/// Nodes that elements name exist, and belong to something.
fn check_connectivity(mesh: &Mesh) -> Result<()> {
    let mut used = vec![false; mesh.points.len()];
    let elements = mesh.solids.iter().map(|solid| (solid.id, solid.nodes()));
    for (id, nodes) in elements.chain(mesh.facets.iter().map(|facet| (facet.id, facet.nodes()))) {
        for &node in nodes {
            match used.get_mut(node as usize) {
                Some(used) => *used = true,
                None => return Err(fail(mesh, format!("element {id} names node {node}, which does not exist"), "")),
            }
        }
    }
    let alone = (0..used.len()).filter(|&node| !used[node]);
    refuse(mesh, "node", ids_of(mesh, alone), ALONE, DELETE)
}

pub(super) const ALONE: &str = "not part of any element";
const DELETE: &str = "delete nodes that nothing uses";

fn check_solids(mesh: &Mesh) -> Result<()> {
    let mut bad = [const { Vec::new() }; 4];
    let points = Quadrature::new();
    for solid in &mesh.solids {
        let fault = if repeats(solid.nodes()) {
            0
        } else {
            let (low, high) = points.scaled(solid, |node| Vec3::from(mesh.points[node as usize]));
            match () {
                _ if high < -FLAT => 1,
                _ if low < -FLAT => 2,
                // Also when it is not a number.
                _ if low > FLAT => continue,
                _ => 3,
            }
        };
        bad[fault].push(solid.id);
    }
    let [repeated, mirrored, inverted, flat] = bad;
    refuse(mesh, "element", repeated, "degenerate: a node occurs twice", COLLAPSED)?;
    refuse(
        mesh,
        "element",
        mirrored,
        "inside out: the nodes are in mirrored order",
        "turn the order of the nodes over",
    )?;
    refuse(
        mesh,
        "element",
        inverted,
        "inverted: the Jacobian determinant is negative somewhere",
        "repair the mesh there",
    )?;
    refuse(mesh, "element", flat, "without volume", "repair the mesh there")
}

const COLLAPSED: &str = "hexahedra may collapse to wedges, pyramids or tetrahedra: repair the mesh there";

/// The numbers of elements that are inside out or flat with nodes at `place`.
pub fn spoiled<'a>(solids: impl Iterator<Item = &'a Solid>, place: impl Fn(u32) -> Vec3) -> Vec<u64> {
    let points = Quadrature::new();
    // Also what is not a number.
    let is_sound = |solid: &Solid| points.scaled(solid, &place).0 > FLAT;
    solids.filter(|solid| !is_sound(solid)).map(|solid| solid.id).collect()
}

/// Quadratic elements that share an edge share the node in its middle.
fn check_middles(mesh: &Mesh) -> Result<()> {
    let mut known: HashMap<[u32; 2], (u32, u64)> = HashMap::new();
    for solid in &mesh.solids {
        for (ends, middle) in solid.middles() {
            let (first, id) = *known.entry(ends).or_insert((middle, solid.id));
            if first != middle {
                let [a, b] = ends.map(|node| mesh.point_ids[node as usize]);
                let what = format!(
                    "elements {id} and {} share the edge between nodes {a} and {b}, but not the node in its middle",
                    solid.id
                );
                return Err(fail(mesh, what, "merge what belongs together, or take the parts as separate groups"));
            }
        }
    }
    Ok(())
}

/// Where elements with triangles and with quadrilaterals meet, no quadrilateral lies over triangles: these displace differently
/// between the nodes, and share forces between them differently.
fn check_fit(mesh: &Mesh) -> Result<()> {
    let (mut triangles, mut quadrilaterals) = (false, false);
    for solid in &mesh.solids {
        triangles |= !matches!(solid.shape, SolidShape::Hex8 | SolidShape::Hex27);
        quadrilaterals |= !matches!(solid.shape, SolidShape::Tet4 | SolidShape::Tet10);
    }
    if !(triangles && quadrilaterals) {
        return Ok(());
    }
    let free: Vec<Facet> =
        boundary(&mesh.solids).iter().map(|&(solid, face)| mesh.solids[solid as usize].face(face as usize)).collect();
    let mut halves = HashMap::new();
    for quadrilateral in free.iter().filter(|face| face.count == 4) {
        for left_out in 0..4 {
            let mut half = quadrilateral.nodes;
            half[left_out] = u32::MAX;
            half.sort_unstable();
            halves.insert(half, quadrilateral.id);
        }
    }
    let over = |triangle: &Facet| Some((triangle.id, *halves.get(&triangle.key())?));
    match free.iter().filter(|face| face.count == 3).find_map(over) {
        None => Ok(()),
        Some((triangle, quadrilateral)) => {
            let what = format!("a triangle of element {triangle} lies on a quadrilateral of element {quadrilateral}");
            let help = "mesh so that elements share whole faces: tetrahedra stand beside hexahedra on pyramids (C3D5 of Abaqus)";
            Err(fail(mesh, what, help))
        }
    }
}

/// Whether a node occurs twice.
pub(super) fn repeats(nodes: &[u32]) -> bool {
    nodes.iter().enumerate().any(|(at, node)| nodes[..at].contains(node))
}

/// Determinant of three vectors over the product of their lengths: 1 for right angles, 0 when flat.
fn scaled(a: Vec3, b: Vec3, c: Vec3) -> f64 {
    a.dot(&b.cross(&c)) / (a.norm() * b.norm() * c.norm())
}

/// Smallest and largest scaled determinant over the corners of a tetrahedron.
fn scaled_tet(x: &[Vec3; MOST_NODES]) -> (f64, f64) {
    let value = scaled(x[1] - x[0], x[2] - x[0], x[3] - x[0]);
    (value, value)
}

/// The same of a quadratic tetrahedron, over its integration points and nodes, by their barycentric coordinates.
fn scaled_tet10(x: &[Vec3; MOST_NODES]) -> (f64, f64) {
    const FAR: f64 = 0.138_196_601_125_010_5;
    let of = |is: &dyn Fn(usize) -> bool, one: f64, other: f64| -> [f64; 4] {
        std::array::from_fn(|k| if is(k) { one } else { other })
    };
    let corners = (0..4).flat_map(|a| [of(&|k| k == a, 1.0, 0.0), of(&|k| k == a, 1.0 - 3.0 * FAR, FAR)]);
    let middles = TET_EDGES.iter().map(|ends| of(&|k| ends.contains(&k), 0.5, 0.0));
    widen(corners.chain(middles).map(|b| {
        // x by b_k, of x = sum_k b_k (2 b_k - 1) x_k + sum_ij 4 b_i b_j x_ij
        let mut by: [Vec3; 4] = std::array::from_fn(|k| (4.0 * b[k] - 1.0) * x[k]);
        for ([i, j], middle) in TET_EDGES.iter().zip(&x[4..]) {
            by[*i] += 4.0 * b[*j] * middle;
            by[*j] += 4.0 * b[*i] * middle;
        }
        scaled(by[1] - by[0], by[2] - by[0], by[3] - by[0])
    }))
}

/// The same of a quadratic hexahedron or wedge, over its integration points and nodes.
fn scaled_frames(frames: impl Iterator<Item = Mat3>) -> (f64, f64) {
    widen(frames.map(|frame| scaled(frame.column(0).into(), frame.column(1).into(), frame.column(2).into())))
}

/// The same of a wedge, over its integration points and corners.
fn scaled_wedge(x: &[Vec3; MOST_NODES]) -> (f64, f64) {
    let points = |level: f64, near: f64| {
        let far = 0.5 * (1.0 - near);
        [[near, far, far], [far, near, far], [far, far, near]].map(|b| (level, b))
    };
    let gauss = 0.5 / 3.0_f64.sqrt();
    let all = [(0.0, 1.0), (1.0, 1.0), (0.5 - gauss, 2.0 / 3.0), (0.5 + gauss, 2.0 / 3.0)];
    widen(all.into_iter().flat_map(|(level, near)| points(level, near)).map(|(level, b)| {
        let edge = |k: usize| (x[k] - x[0]) * (1.0 - level) + (x[k + 3] - x[3]) * level;
        let up: Vec3 = (0..3).map(|k| (x[k + 3] - x[k]) * b[k]).sum();
        scaled(edge(1), edge(2), up)
    }))
}

/// The same of a pyramid, over rays from its apex to integration points and corners of its base: along one the sign is the same.
fn scaled_pyramid(x: &[Vec3; MOST_NODES]) -> (f64, f64) {
    let gauss = 1.0 / 3.0_f64.sqrt();
    widen([1.0, gauss].into_iter().flat_map(|far| CORNERS[..4].iter().map(move |at| [far * at[0], far * at[1]])).map(
        |[xi, eta]| {
            let along = |a: f64, from: usize, to: usize, other: [usize; 2]| {
                (x[to] - x[from]) * (1.0 - a) + (x[other[1]] - x[other[0]]) * (1.0 + a)
            };
            let (right, up) = (along(eta, 0, 1, [3, 2]), along(xi, 0, 3, [1, 2]));
            let base: Vec3 =
                CORNERS[..4].iter().zip(x).map(|(at, x)| *x * (0.25 * (1.0 + at[0] * xi) * (1.0 + at[1] * eta))).sum();
            scaled(right, up, x[4] - base)
        },
    ))
}

/// The smallest and the largest; not a number where one is none.
fn widen(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| match value.is_nan() || low.is_nan() {
        true => (f64::NAN, f64::NAN),
        false => (low.min(value), high.max(value)),
    })
}

/// Signs of the parent coordinates of the corners of a hexahedron.
const CORNERS: [[f64; 3]; 8] = [
    [-1., -1., -1.],
    [1., -1., -1.],
    [1., 1., -1.],
    [-1., 1., -1.],
    [-1., -1., 1.],
    [1., -1., 1.],
    [1., 1., 1.],
    [-1., 1., 1.],
];

/// Derivatives of the trilinear shape functions at the Gauss points and corners of a hexahedron.
struct Quadrature([[[f64; 3]; 8]; 16]);

impl Quadrature {
    fn new() -> Self {
        let gauss = 1.0 / 3.0_f64.sqrt();
        Self(std::array::from_fn(|point| {
            let at = CORNERS[point % 8].map(|sign| if point < 8 { sign } else { sign * gauss });
            CORNERS.map(|corner| {
                let f: [f64; 3] = std::array::from_fn(|i| 1.0 + corner[i] * at[i]);
                [corner[0] * f[1] * f[2], f[0] * corner[1] * f[2], f[0] * f[1] * corner[2]].map(|d| d / 8.0)
            })
        }))
    }

    /// Smallest and largest scaled determinant of an element.
    fn scaled(&self, solid: &Solid, place: impl Fn(u32) -> Vec3) -> (f64, f64) {
        let corners = solid.nodes.map(place);
        match solid.shape {
            SolidShape::Tet4 => scaled_tet(&corners),
            SolidShape::Hex8 => self.scaled_hex(&corners),
            SolidShape::Wedge6 => scaled_wedge(&corners),
            SolidShape::Pyramid5 => scaled_pyramid(&corners),
            SolidShape::Tet10 => scaled_tet10(&corners),
            SolidShape::Wedge18 => scaled_frames(wedge18::frames(&std::array::from_fn(|a| corners[a].into()))),
            SolidShape::Hex27 => scaled_frames(hex27::frames(&corners.map(Into::into))),
        }
    }

    /// Smallest and largest scaled determinant over the points.
    fn scaled_hex(&self, x: &[Vec3; MOST_NODES]) -> (f64, f64) {
        widen(self.0.iter().map(|derivatives| {
            let mut columns = [Vec3::zeros(); 3];
            for (derivative, x) in derivatives.iter().zip(x) {
                for (column, d) in columns.iter_mut().zip(derivative) {
                    *column += x * *d;
                }
            }
            scaled(columns[0], columns[1], columns[2])
        }))
    }
}

fn check_facets(mesh: &Mesh) -> Result<()> {
    let (mut repeated, mut flat, mut folded) = (Vec::new(), Vec::new(), Vec::new());
    for facet in &mesh.facets {
        if repeats(facet.nodes()) {
            repeated.push(facet.id);
            continue;
        }
        match squareness(mesh, facet) {
            value if value < -FLAT => folded.push(facet.id),
            value if value > FLAT => {}
            _ => flat.push(facet.id),
        }
    }
    refuse(mesh, "facet", repeated, "degenerate: a node occurs twice", "use triangles where quadrilaterals collapse")?;
    refuse(mesh, "facet", flat, "degenerate: without area, or with two edges on one line", "repair the surface there")?;
    refuse(mesh, "facet", folded, "folded or concave", "repair the surface there")
}

/// Smallest sine of the angles at the corners of a facet, negative where it folds back; not a number without area.
fn squareness(mesh: &Mesh, facet: &Facet) -> f64 {
    let x: [Vec3; 4] = facet.nodes.map(|node| Vec3::from(mesh.points[node as usize]));
    let count = facet.count as usize;
    let diagonals = if count == 4 { [x[2] - x[0], x[3] - x[1]] } else { [x[1] - x[0], x[2] - x[0]] };
    let area = diagonals[0].cross(&diagonals[1]);
    if area.norm() <= FLAT * diagonals[0].norm() * diagonals[1].norm() {
        return f64::NAN;
    }
    let normal = area.normalize();
    let sine = |corner: usize| {
        let (a, b) = (x[(corner + 1) % count] - x[corner], x[(corner + count - 1) % count] - x[corner]);
        a.cross(&b).dot(&normal) / (a.norm() * b.norm())
    };
    // A NaN must stay one, which `min` would drop.
    (0..count).map(sine).fold(1.0, |least, value| if value >= least { least } else { value })
}

fn check_duplicates(mesh: &Mesh) -> Result<()> {
    let key = |solid: &Solid| {
        let mut key = solid.nodes;
        key[solid.nodes().len()..].fill(u32::MAX);
        key.sort_unstable();
        key
    };
    let solids = mesh.solids.iter().map(|solid| (key(solid), solid.id)).collect();
    refuse_pairs(mesh, "elements", duplicates(solids))?;
    refuse_pairs(mesh, "facets", duplicates(mesh.facets.iter().map(|facet| (facet.key(), facet.id)).collect()))
}

/// Pairs of numbers with equal keys.
fn duplicates<K: Ord>(mut keyed: Vec<(K, u64)>) -> Vec<[u64; 2]> {
    keyed.sort_unstable();
    keyed.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| [pair[0].1, pair[1].1]).collect()
}

fn refuse_pairs(mesh: &Mesh, kind: &str, pairs: Vec<[u64; 2]>) -> Result<()> {
    match pairs.first() {
        None => Ok(()),
        Some([a, b]) => {
            let what = format!("{kind} {a} and {b} have the same nodes{}", more_pairs(&pairs));
            Err(fail(mesh, what, "delete one of them"))
        }
    }
}

fn more_pairs<T>(pairs: &[T]) -> String {
    if pairs.len() == 1 { String::new() } else { format!(", and {} more pairs", pairs.len() - 1) }
}

/// No two nodes are at the same place: sorted along a direction that no mesh is aligned with, close ones are near in
/// the order.
fn check_coincident(mesh: &Mesh) -> Result<()> {
    let sizes = sizes(mesh);
    let direction = Vec3::new(0.5357, 0.6214, 0.5718);
    let points = || mesh.points.iter().map(|&point| Vec3::from(point));
    let mut order: Vec<(f64, u32)> = points().zip(0..).map(|(point, at)| (point.dot(&direction), at)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    // Projections carry rounding errors of the size of the coordinates.
    let extent = points().map(|point| point.amax()).fold(0.0, f64::max);
    let window = COINCIDENT * sizes.iter().copied().fold(0.0, f64::max) + 1e-15 * extent;
    let mut pairs = Vec::new();
    for (at, &(along, a)) in order.iter().enumerate() {
        for &(_, b) in order[at + 1..].iter().take_while(|other| other.0 - along <= window) {
            let [a, b] = [a.min(b) as usize, a.max(b) as usize];
            let [x, y] = [a, b].map(|node| Vec3::from(mesh.points[node]));
            if (x - y).norm() <= COINCIDENT * sizes[a].min(sizes[b]) {
                pairs.push([a, b]);
            }
        }
    }
    pairs.sort_unstable();
    match pairs.first() {
        None => Ok(()),
        Some(&[a, b]) => {
            let [x, y, z] = mesh.points[a];
            let [id_a, id_b] = [a, b].map(|node| mesh.point_ids[node]);
            let what = format!("nodes {id_a} and {id_b} are both at ({x}, {y}, {z}){}", more_pairs(&pairs));
            Err(fail(mesh, what, "merge coincident nodes (Gmsh: Coherence Mesh), or take the parts as separate groups"))
        }
    }
}

/// For each node the size of the largest element around it: the extent of its box.
fn sizes(mesh: &Mesh) -> Vec<f64> {
    let mut sizes = vec![0.0_f64; mesh.points.len()];
    for nodes in mesh.solids.iter().map(Solid::nodes).chain(mesh.facets.iter().map(Facet::nodes)) {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &node in nodes {
            for (i, &x) in mesh.points[node as usize].iter().enumerate() {
                low[i] = low[i].min(x);
                high[i] = high[i].max(x);
            }
        }
        let size = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
        nodes.iter().for_each(|&node| sizes[node as usize] = sizes[node as usize].max(size));
    }
    sizes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tet(nodes: &[u32]) -> Solid {
        Solid::new(SolidShape::Tet4, nodes, 70)
    }

    /// A unit tetrahedron and a unit cube beside it; number of node i is 10 i.
    fn sample() -> Mesh {
        let mut points = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
        points.extend(CORNERS.map(|corner| corner.map(|sign| 3.5 + 0.5 * sign)));
        let hex = Solid::new(SolidShape::Hex8, &[4, 5, 6, 7, 8, 9, 10, 11], 71);
        Mesh {
            source: "a.msh".into(),
            point_ids: (0..points.len() as u64).map(|id| 10 * id).collect(),
            points,
            solids: vec![tet(&[0, 1, 2, 3]), hex],
            facets: vec![hex.face(1), tet(&[0, 1, 2, 3]).face(0)],
            ..Mesh::default()
        }
    }

    /// The message after a change.
    fn broken(change: impl Fn(&mut Mesh)) -> String {
        let mut mesh = sample();
        change(&mut mesh);
        let text = check(&mesh).unwrap_err().to_string();
        assert!(text.starts_with("a.msh: "), "{text}");
        text["a.msh: ".len()..].lines().next().unwrap_or_default().to_string()
    }

    #[test]
    fn a_good_mesh_passes_in_any_unit() {
        for scale in [1.0, 1e-9, 1e9] {
            let mut mesh = sample();
            mesh.points.iter_mut().flatten().for_each(|x| *x *= scale);
            check(&mesh).unwrap();
            // A body that is thin along two directions is not flat.
            mesh.points[4..].iter_mut().for_each(|point| point[1] *= 1e-6);
            mesh.points[4..].iter_mut().for_each(|point| point[2] *= 1e-6);
            check(&mesh).unwrap();
        }
        check(&Mesh::default()).unwrap();
    }

    #[test]
    fn nodes() {
        assert_eq!(broken(|mesh| mesh.points[3][1] = f64::NAN), "node 30 is not at a finite place");
        let all = broken(|mesh| mesh.points.iter_mut().for_each(|point| point[2] = f64::INFINITY));
        assert_eq!(all, "nodes 0, 10, 20 and 9 more are not at a finite place");
        assert_eq!(broken(|mesh| mesh.solids[1].nodes[7] = 99), "element 71 names node 99, which does not exist");
        let alone = |mesh: &mut Mesh| {
            mesh.points.push([9.0; 3]);
            mesh.point_ids.push(555);
        };
        assert_eq!(broken(alone), "node 555 is not part of any element");
        assert_eq!(
            broken(|mesh| mesh.points[3] = [3.0, 3.0, 3.0 + 1e-10]),
            "nodes 30 and 40 are both at (3, 3, 3.0000000001)"
        );
        let copy = |mesh: &mut Mesh| {
            let mut other = sample();
            other.solids.iter_mut().flat_map(|solid| &mut solid.nodes).for_each(|node| *node += 12);
            mesh.points.extend(other.points);
            mesh.point_ids.extend(100..112);
            mesh.solids.extend(other.solids);
        };
        assert_eq!(broken(copy), "nodes 0 and 100 are both at (0, 0, 0), and 11 more pairs");
    }

    #[test]
    fn close_nodes_that_are_apart_pass() {
        let mut mesh = sample();
        mesh.points[3] = [3.0, 3.0, 3.0 - 1e-8];
        check(&mesh).unwrap();
    }

    #[test]
    fn solids() {
        let mirrored = broken(|mesh| mesh.solids[0].nodes.swap(0, 1));
        assert_eq!(mirrored, "element 70 is inside out: the nodes are in mirrored order");
        let mirrored = broken(|mesh| {
            let n = mesh.solids[1].nodes;
            mesh.solids[1] = Solid::new(SolidShape::Hex8, &[n[4], n[5], n[6], n[7], n[0], n[1], n[2], n[3]], 71);
        });
        assert_eq!(mirrored, "element 71 is inside out: the nodes are in mirrored order");
        // A corner pushed through the opposite faces; the Jacobian of the other corners stays positive.
        let inverted = broken(|mesh| mesh.points[10] = [3.1; 3]);
        assert_eq!(inverted, "element 71 is inverted: the Jacobian determinant is negative somewhere");
        assert_eq!(broken(|mesh| mesh.points[3][2] = 0.0), "element 70 is without volume");
        assert_eq!(
            broken(|mesh| mesh.points[8..].iter_mut().for_each(|point| point[2] = 3.0)),
            "element 71 is without volume"
        );
        assert_eq!(broken(|mesh| mesh.solids[1].nodes[7] = 8), "element 71 is degenerate: a node occurs twice");
        let twice = |mesh: &mut Mesh| mesh.solids.push(Solid::new(SolidShape::Tet4, &[1, 2, 0, 3], 80));
        assert_eq!(broken(twice), "elements 70 and 80 have the same nodes");
    }

    /// A wedge on the upper face of the cube, of which it has half; and one that is folded.
    #[test]
    fn wedges() {
        let on_cube = |mesh: &mut Mesh| {
            let wedge = Solid::new(SolidShape::Wedge6, &[8, 9, 10, 12, 13, 14], 72);
            mesh.points.extend([8, 9, 10].map(|k: usize| mesh.points[k]).map(|[x, y, z]| [x, y, z + 1.0]));
            mesh.point_ids.extend([120, 130, 140]);
            mesh.solids.push(wedge);
        };
        assert_eq!(broken(on_cube), "a triangle of element 72 lies on a quadrilateral of element 71");
        let alone = |mesh: &mut Mesh| {
            on_cube(mesh);
            mesh.facets.clear();
            mesh.solids = vec![mesh.solids[2]];
            mesh.points = mesh.points[8..].to_vec();
            mesh.point_ids = mesh.point_ids[8..].to_vec();
            mesh.points.remove(3);
            mesh.point_ids.remove(3);
            mesh.solids[0] = Solid::new(SolidShape::Wedge6, &[0, 1, 2, 3, 4, 5], 72);
        };
        let mut sound = sample();
        alone(&mut sound);
        check(&sound).unwrap();
        let with = |change: &dyn Fn(&mut Mesh)| {
            broken(|mesh| {
                alone(mesh);
                change(mesh);
            })
        };
        let mirrored = with(&|mesh| mesh.solids[0].nodes[..6].rotate_left(3));
        assert_eq!(mirrored, "element 72 is inside out: the nodes are in mirrored order");
        let folded = with(&|mesh| mesh.points[4] = [2.5, 3.4, 5.0]);
        assert_eq!(folded, "element 72 is inverted: the Jacobian determinant is negative somewhere");
    }

    /// A tetrahedron with a middle on an edge, moved towards the opposite one until elements fold at a node, and at an integration
    /// point; and a neighbour that has its own middle.
    #[test]
    fn quadratic_tetrahedra() {
        let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 1., 1.]];
        let mut points = corners.to_vec();
        let mut tet = |corners: [usize; 4], own: Option<usize>| {
            let middles = TET_EDGES.map(|[i, j]| {
                let (a, b) = (corners[i].min(corners[j]), corners[i].max(corners[j]));
                let place: [f64; 3] = std::array::from_fn(|d| 0.5 * (points[a][d] + points[b][d]));
                let known = points.iter().position(|x| *x == place).filter(|_| own != Some(a + b));
                known.unwrap_or_else(|| {
                    points.push(if own == Some(a + b) { place.map(|x| x + 0.01) } else { place });
                    points.len() - 1
                })
            });
            [&corners[..], &middles].concat().iter().map(|n| *n as u32).collect::<Vec<u32>>()
        };
        let (one, same, other) = (tet([0, 1, 2, 3], None), tet([4, 2, 1, 3], None), tet([4, 2, 1, 3], Some(3)));
        let mesh = |solids: &[&Vec<u32>]| {
            let solid = |(id, nodes): (u64, &&Vec<u32>)| Solid::new(SolidShape::Tet10, nodes, id);
            let solids: Vec<Solid> = (1..).zip(solids).map(solid).collect();
            let used = |n: usize| solids.iter().any(|s| s.nodes().contains(&(n as u32)));
            let points: Vec<[f64; 3]> = points.iter().enumerate().filter(|(n, _)| used(*n)).map(|(_, x)| *x).collect();
            let renumber = |n: u32| (0..n).filter(|m| used(*m as usize)).count() as u32;
            let solid =
                |s: &Solid| Solid::new(s.shape, &s.nodes().iter().map(|n| renumber(*n)).collect::<Vec<u32>>(), s.id);
            Mesh {
                point_ids: (1..=points.len() as u64).collect(),
                solids: solids.iter().map(solid).collect(),
                points,
                ..Mesh::default()
            }
        };
        check(&mesh(&[&one, &same])).unwrap();
        let text = check(&mesh(&[&one, &other])).unwrap_err().to_string();
        assert!(text.contains("elements 1 and 2 share the edge between nodes 2 and 3, but not the node"), "{text}");
        for (by, fault) in [(0.2, None), (0.3, Some("negative somewhere"))] {
            let mut one = mesh(&[&one]);
            let middle = one.solids[0].nodes[4] as usize;
            one.points[middle][0] += by;
            let found = check(&one).err().map(|error| error.to_string());
            assert_eq!(found.is_some(), fault.is_some(), "{by}: {found:?}");
            assert!(found.is_none_or(|found| found.contains(fault.unwrap())));
        }
    }

    #[test]
    fn facets() {
        assert_eq!(broken(|mesh| mesh.facets[1].nodes[1] = 0), "facet 70 is degenerate: a node occurs twice");
        let twice = |mesh: &mut Mesh| mesh.facets.push(Facet { id: 90, ..mesh.facets[0].reversed() });
        assert_eq!(broken(twice), "facets 71 and 90 have the same nodes");
        let crossed = |mesh: &mut Mesh| {
            mesh.solids.truncate(1);
            mesh.points[10] = [3.2, 3.2, 4.0];
        };
        assert_eq!(
            broken(|mesh| {
                crossed(mesh);
                mesh.facets.push(Solid::new(SolidShape::Hex8, &[4, 5, 6, 7, 8, 9, 10, 11], 5).face(0))
            }),
            "facet 71 is folded or concave"
        );
        let flat = |mesh: &mut Mesh| {
            mesh.solids.clear();
            mesh.facets = vec![Facet { count: 3, nodes: [0, 1, 2, 0], id: 1 }];
            mesh.points = vec![[0., 0., 0.], [1., 1., 0.], [3., 3., 0.]];
            mesh.point_ids = vec![1, 2, 3];
        };
        assert_eq!(broken(flat), "facet 1 is degenerate: without area, or with two edges on one line");
    }
}

//! Structured blocks of hexahedra: boxes, and sectors of rings and cylinders.
//!
//! Along each direction the sizes of the n elements form a geometric series whose last over first is the grading g,
//! so node i of n + 1 is at (q^i - 1) / (q^n - 1) of the way with q = g^(1 / (n - 1)).

use super::{Group, Mesh, Solid, SolidShape};
use crate::Vec3;
use crate::error::{Error, Result};
use crate::scene::{Block, BlockShape, Located, did_you_mean};
use std::collections::BTreeMap;

/// Default names of the six sides of a box and of a sector, and the local face of an element that lies on each.
const BOX_SIDES: [&str; 6] = ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"];
const SECTOR_SIDES: [&str; 6] = ["rmin", "rmax", "amin", "amax", "zmin", "zmax"];
const SIDE_FACES: [usize; 6] = [5, 3, 2, 4, 0, 1];

/// Generates the mesh of a block: its facets are its whole boundary, its groups the sides under their default names
/// and under those of [`Block::faces`]. Points, elements and facets count from 1.
pub fn generate(block: &Located<Block>) -> Result<Mesh> {
    let refuse = |what: String, help: &str| Err(Error::input(&block.at, what, help));
    let Block { elements, grading, shape, .. } = &block.value;
    if elements.contains(&0) {
        return refuse(format!("a block of {elements:?} elements"), "each number of elements is 1 or more");
    }
    if !grading.iter().all(|g| g.is_finite() && *g > 0.0) {
        return refuse(format!("gradings {grading:?}"), "a grading is above 0; 1 is uniform");
    }
    let shape = match CheckedShape::new(shape) {
        Ok(shape) => shape,
        Err((what, help)) => return refuse(what, help),
    };
    if shape.closed && elements[1] < 3 {
        return refuse(format!("a closed ring of {} elements", elements[1]), "take 3 or more around");
    }
    let total = elements.iter().try_fold(1_usize, |total, n| total.checked_mul(n.checked_add(1)?));
    if total.is_none_or(|total| total >= u32::MAX as usize / 6) {
        return refuse(format!("a block of {elements:?} elements is too large"), "take fewer elements");
    }
    let mut mesh = fill(*elements, *grading, &shape);
    let names = add_sides(&mut mesh, *elements, &shape);
    add_names(&mut mesh, &block.value.faces, &names)?;
    Ok(mesh)
}

/// A shape whose sizes are checked.
struct CheckedShape<'a> {
    shape: &'a BlockShape,
    /// A ring that closes on itself.
    closed: bool,
    sides: [&'static str; 6],
}

impl<'a> CheckedShape<'a> {
    /// Fails with what is wrong and what would be right.
    fn new(shape: &'a BlockShape) -> std::result::Result<Self, (String, &'static str)> {
        match shape {
            BlockShape::Box { origin, size } => {
                if !size.iter().all(|s| *s > 0.0) || !(origin + size).iter().all(|x| x.is_finite()) {
                    let what = format!("a box of size {:?}", size.as_slice());
                    return Err((what, "all three sizes are positive"));
                }
                Ok(Self { shape, closed: false, sides: BOX_SIDES })
            }
            BlockShape::Sector { center, radii: [inner, outer], angles: [from, to], length } => {
                let span = to - from;
                let finite = [*inner, *outer, *from, *to, *length].iter().chain(center.iter()).all(|x| x.is_finite());
                let (what, help) = match () {
                    _ if *inner <= 0.0 => {
                        let help =
                            "hexahedra collapse on the axis: take an inner radius r > 0, or mesh the core in a file";
                        (format!("an inner radius of {inner}"), help)
                    }
                    _ if outer <= inner => (format!("radii {inner} and {outer}"), "the inner radius comes first"),
                    _ if span <= 0.0 => (format!("angles {from} and {to}"), "the second angle is the larger one"),
                    _ if span > 360.0 * (1.0 + 1e-12) => (format!("a span of {span} degrees"), "360 closes the ring"),
                    _ if *length <= 0.0 => (format!("a length of {length}"), "the length is positive"),
                    _ if !finite => ("a sector that is not finite".into(), "all numbers are finite"),
                    _ => return Ok(Self { shape, closed: span > 360.0 * (1.0 - 1e-12), sides: SECTOR_SIDES }),
                };
                Err((what, help))
            }
        }
    }

    /// The point at fractions t of the way along the three directions.
    fn point(&self, t: [f64; 3]) -> [f64; 3] {
        match self.shape {
            BlockShape::Box { origin, size } => (origin + size.component_mul(&Vec3::from(t))).into(),
            BlockShape::Sector { center, radii, angles, length } => {
                let radius = radii[0] + t[0] * (radii[1] - radii[0]);
                let (sine, cosine) = (angles[0] + t[1] * (angles[1] - angles[0])).to_radians().sin_cos();
                (center + Vec3::new(radius * cosine, radius * sine, t[2] * length)).into()
            }
        }
    }
}

/// Fractions of the way at which the nodes of a direction are; the last is exactly 1.
fn fractions(n: usize, grading: f64) -> Vec<f64> {
    let log = if n > 1 { grading.ln() / (n - 1) as f64 } else { 0.0 };
    let fraction = |i: usize| match log {
        0.0 => i as f64 / n as f64,
        _ => (i as f64 * log).exp_m1() / (n as f64 * log).exp_m1(),
    };
    (0..=n).map(fraction).collect()
}

/// Points and elements; the first direction runs fastest.
fn fill(elements: [usize; 3], grading: [f64; 3], shape: &CheckedShape) -> Mesh {
    let along: [Vec<f64>; 3] = std::array::from_fn(|i| fractions(elements[i], grading[i]));
    let [nx, ny, nz] = elements;
    let rows = if shape.closed { ny } else { ny + 1 };
    let mut mesh = Mesh { source: "block".into(), ..Mesh::default() };
    mesh.points.reserve_exact((nx + 1) * rows * (nz + 1));
    mesh.solids.reserve_exact(nx * ny * nz);
    for &z in &along[2] {
        for &y in &along[1][..rows] {
            mesh.points.extend(along[0].iter().map(|&x| shape.point([x, y, z])));
        }
    }
    mesh.point_ids = (1..=mesh.points.len() as u64).collect();
    let node = |i: usize, j: usize, k: usize| (i + (nx + 1) * (j % rows + rows * k)) as u32;
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let layer = |k: usize| [node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k)];
                let ([a, b, c, d], [e, f, g, h]) = (layer(k), layer(k + 1));
                let id = mesh.solids.len() as u64 + 1;
                mesh.solids.push(Solid::new(SolidShape::Hex8, &[a, b, c, d, e, f, g, h], id));
            }
        }
    }
    mesh
}

/// Facets and groups of the sides. Returns the names of those there are.
fn add_sides(mesh: &mut Mesh, elements: [usize; 3], shape: &CheckedShape) -> Vec<&'static str> {
    let [nx, ny, _] = elements;
    let strides = [1, nx, nx * ny];
    let mut names = Vec::new();
    for (side, (name, face)) in shape.sides.into_iter().zip(SIDE_FACES).enumerate() {
        let direction = side / 2;
        if shape.closed && direction == 1 {
            continue;
        }
        let layer = if side % 2 == 0 { 0 } else { elements[direction] - 1 };
        let mut group = Group::default();
        let across: Vec<usize> = (0..3).filter(|d| *d != direction).collect();
        for slow in 0..elements[across[1]] {
            for fast in 0..elements[across[0]] {
                let index = layer * strides[direction] + fast * strides[across[0]] + slow * strides[across[1]];
                group.facets.push(mesh.facets.len() as u32);
                mesh.facets.push(mesh.solids[index].face(face));
            }
        }
        mesh.groups.insert(name.into(), group);
        names.push(name);
    }
    for group in mesh.groups.values_mut() {
        group.nodes = group.facets.iter().flat_map(|&facet| mesh.facets[facet as usize].nodes()).copied().collect();
        group.nodes.sort_unstable();
        group.nodes.dedup();
    }
    names
}

/// Further names for sides and unions of them.
fn add_names(mesh: &mut Mesh, faces: &[(Located<String>, Vec<Located<String>>)], sides: &[&str]) -> Result<()> {
    let mut added: BTreeMap<String, Group> = BTreeMap::new();
    for (name, members) in faces {
        if mesh.groups.contains_key(&name.value) || added.contains_key(&name.value) {
            let what = format!("the face name '{}' is taken", name.value);
            return Err(Error::input(&name.at, what, "choose another name"));
        }
        if members.is_empty() {
            let what = format!("the face '{}' has no sides", name.value);
            return Err(Error::input(&name.at, what, format!("the sides are {}", sides.join(", "))));
        }
        let mut union = Group::default();
        for member in members {
            let Some(side) = mesh.groups.get(&member.value) else {
                let help = did_you_mean(&member.value, sides.iter().copied());
                return Err(Error::input(&member.at, format!("this block has no side '{}'", member.value), help));
            };
            union.nodes.extend(&side.nodes);
            union.facets.extend(&side.facets);
        }
        for indices in [&mut union.nodes, &mut union.facets] {
            indices.sort_unstable();
            indices.dedup();
        }
        added.insert(name.value.clone(), union);
    }
    mesh.groups.append(&mut added);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Location;
    use crate::mesh::check::check;
    use crate::mesh::faces::{self, Owner};
    use std::f64::consts::PI;

    fn located<T>(value: T) -> Located<T> {
        Located { value, at: Location { file: "scene.toml".into(), line: 3, column: 5, text: "".into() } }
    }

    fn block(shape: BlockShape, elements: [usize; 3], grading: [f64; 3]) -> Located<Block> {
        located(Block { shape, elements, grading, faces: Vec::new() })
    }

    fn a_box() -> BlockShape {
        BlockShape::Box { origin: Vec3::new(-1.0, 2.0, 0.5), size: Vec3::new(3.0, 2.0, 0.7) }
    }

    fn sector(radii: [f64; 2], angles: [f64; 2]) -> BlockShape {
        BlockShape::Sector { center: Vec3::new(1.0, -2.0, 4.0), radii, angles, length: 3.0 }
    }

    /// Volume inside the facets by the divergence theorem, one third of the sum of centroid . area.
    fn enclosed(mesh: &Mesh) -> f64 {
        let flux = |facet: &crate::mesh::Facet| {
            let x = facet.nodes.map(|node| Vec3::from(mesh.points[node as usize]));
            (x[2] - x[0]).cross(&(x[3] - x[1])).dot(&(x[0] + x[1] + x[2] + x[3])) / 8.0
        };
        mesh.facets.iter().map(flux).sum::<f64>() / 3.0
    }

    fn error_of(block: &Located<Block>) -> String {
        let text = generate(block).unwrap_err().to_string();
        assert!(text.starts_with("scene.toml:3:5: "), "{text}");
        text["scene.toml:3:5: ".len()..].to_string()
    }

    #[test]
    fn box_has_its_volume_points_and_sides() {
        let mesh = generate(&block(a_box(), [3, 4, 2], [1.0, 2.5, 0.2])).unwrap();
        check(&mesh).unwrap();
        assert_eq!((mesh.points.len(), mesh.solids.len(), mesh.facets.len()), (60, 24, 2 * (12 + 6 + 8)));
        assert!((enclosed(&mesh) / (3.0 * 2.0 * 0.7) - 1.0).abs() < 1e-14);
        assert_eq!(faces::boundary(&mesh.solids).len(), mesh.facets.len());
        let owners = faces::owners(&mesh.solids, &mesh.facets);
        for (facet, owner) in mesh.facets.iter().zip(owners) {
            let Owner::One { solid, face } = owner else { panic!("{owner:?}") };
            assert_eq!(mesh.solids[solid as usize].face(face as usize), *facet);
        }
        let [x1, y1, z1] = [2.0, 4.0, 0.5 + 0.7];
        let sides =
            [("xmin", 0, -1.0), ("xmax", 0, x1), ("ymin", 1, 2.0), ("ymax", 1, y1), ("zmin", 2, 0.5), ("zmax", 2, z1)];
        for (name, direction, value) in sides {
            let group = &mesh.groups[name];
            let on = |node: &u32| mesh.points[*node as usize][direction] == value;
            let all = (0..60).filter(|node| on(node)).collect::<Vec<u32>>();
            assert_eq!(group.nodes, all, "{name}");
            assert!(group.facets.iter().all(|&facet| mesh.facets[facet as usize].nodes().iter().all(on)));
            assert_eq!(group.facets.len(), [8, 6, 12][direction], "{name}");
        }
        assert_eq!(mesh.groups.len(), 6);
    }

    #[test]
    fn grading_is_geometric_and_the_ratio_of_last_to_first() {
        for (n, grading) in [(5, 4.0), (7, 0.01), (4, 1.0), (2, 3.0), (1, 9.0), (6, 1.0 + 1e-13)] {
            let t = fractions(n, grading);
            let sizes: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert_eq!((t[0], t[n]), (0.0, 1.0));
            if n > 1 {
                assert!((sizes[n - 1] / sizes[0] / grading - 1.0).abs() < 1e-11, "{n} {grading}");
                let q = grading.powf(1.0 / (n - 1) as f64);
                assert!(sizes.windows(2).all(|pair| (pair[1] / pair[0] / q - 1.0).abs() < 1e-11));
            }
        }
        let mesh = generate(&block(a_box(), [2, 1, 1], [3.0, 1.0, 1.0])).unwrap();
        assert!((mesh.points[1][0] - (-1.0 + 3.0 / 4.0)).abs() < 1e-15);
    }

    #[test]
    fn sectors_have_the_volume_of_their_prisms() {
        for (angles, n) in [([30.0, 120.0], 6), ([-90.0, 90.0], 5), ([10.0, 370.0], 7), ([0.0, 360.0], 3)] {
            let mesh = generate(&block(sector([1.5, 4.0], angles), [3, n, 2], [2.0, 1.0, 1.0])).unwrap();
            check(&mesh).unwrap();
            let step = (angles[1] - angles[0]).to_radians() / n as f64;
            let exact = 0.5 * (16.0 - 2.25) * step.sin() * n as f64 * 3.0;
            assert!((enclosed(&mesh) / exact - 1.0).abs() < 1e-13, "{angles:?}");
            let closed = angles[1] - angles[0] == 360.0;
            assert_eq!(mesh.groups.contains_key("amin"), !closed);
            assert_eq!(mesh.points.len(), 4 * 3 * if closed { n } else { n + 1 });
            assert_eq!(faces::boundary(&mesh.solids).len(), mesh.facets.len());
            let radius = |node: &u32| {
                let [x, y, _] = mesh.points[*node as usize];
                (x - 1.0).hypot(y + 2.0)
            };
            assert!(mesh.groups["rmin"].nodes.iter().all(|node| (radius(node) - 1.5).abs() < 1e-14));
            assert!(mesh.groups["rmax"].nodes.iter().all(|node| (radius(node) - 4.0).abs() < 1e-14));
        }
    }

    #[test]
    fn a_quarter_starts_at_x_and_turns_to_y() {
        let mesh = generate(&block(sector([1.0, 2.0], [0.0, 90.0]), [1, 2, 1], [1.0, 3.0, 1.0])).unwrap();
        assert!(mesh.groups["amin"].nodes.iter().all(|&node| mesh.points[node as usize][1] == -2.0));
        assert!(mesh.groups["amax"].nodes.iter().all(|&node| (mesh.points[node as usize][0] - 1.0).abs() < 1e-15));
        let [x, y, z] = mesh.points[2];
        assert!(((y + 2.0).atan2(x - 1.0) - PI / 8.0).abs() < 1e-15 && z == 4.0);
    }

    #[test]
    fn further_names_join_sides() {
        let mut ring = block(sector([1.0, 2.0], [0.0, 360.0]), [1, 8, 1], [1.0; 3]);
        let names = |list: &[&str]| list.iter().map(|name| located(name.to_string())).collect::<Vec<_>>();
        ring.value.faces =
            vec![(located("rims".into()), names(&["rmin", "rmax"])), (located("bore".into()), names(&["rmin"]))];
        let mesh = generate(&ring).unwrap();
        assert_eq!(mesh.groups["rims"].nodes.len(), 32);
        assert_eq!(mesh.groups["rims"].facets.len(), 16);
        assert_eq!(mesh.groups["bore"], mesh.groups["rmin"]);

        let mut with = |name: &str, members: &[&str]| {
            ring.value.faces = vec![(located(name.into()), names(members))];
            error_of(&ring)
        };
        assert_eq!(
            with("a", &["rmin", "rmx"]),
            "this block has no side 'rmx'\n  help: did you mean `rmax`? (known: rmin, rmax, zmin, zmax)"
        );
        assert!(with("a", &["amin"]).starts_with("this block has no side 'amin'"));
        assert!(with("a", &[]).starts_with("the face 'a' has no sides\n  help: the sides are rmin"));
        assert!(with("rmin", &["rmax"]).starts_with("the face name 'rmin' is taken"));
        ring.value.faces = vec![(located("a".into()), names(&["rmin"])), (located("a".into()), names(&["rmax"]))];
        assert!(error_of(&ring).starts_with("the face name 'a' is taken"));
    }

    #[test]
    fn wrong_sizes_are_refused() {
        let shape = |shape| error_of(&block(shape, [1, 2, 1], [1.0; 3]));
        let size = |x: f64| shape(BlockShape::Box { origin: Vec3::zeros(), size: Vec3::new(1.0, x, 1.0) });
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(size(bad).contains("help: all three sizes are positive"), "{bad}");
        }
        assert!(shape(sector([0.0, 1.0], [0.0, 90.0])).contains("take an inner radius r > 0"));
        assert!(shape(sector([2.0, 1.0], [0.0, 90.0])).contains("the inner radius comes first"));
        assert!(shape(sector([1.0, 2.0], [90.0, 90.0])).contains("the second angle is the larger one"));
        assert!(shape(sector([1.0, 2.0], [0.0, 361.0])).contains("360 closes the ring"));
        assert!(shape(sector([1.0, 2.0], [0.0, 360.0])).contains("take 3 or more around"));
        assert!(shape(sector([1.0, 2.0], [0.0, f64::NAN])).contains("not finite"));
        let flat = BlockShape::Sector { center: Vec3::zeros(), radii: [1.0, 2.0], angles: [0.0, 90.0], length: 0.0 };
        assert!(shape(flat).contains("the length is positive"));
        let elements = |elements| error_of(&block(a_box(), elements, [1.0; 3]));
        assert!(elements([1, 0, 1]).contains("each number of elements is 1 or more"));
        assert!(elements([2000, 2000, 2000]).contains("too large"));
        assert!(elements([usize::MAX, 2, 2]).contains("too large"));
        assert!(error_of(&block(a_box(), [1, 1, 1], [1.0, 0.0, 1.0])).contains("a grading is above 0"));
    }
}

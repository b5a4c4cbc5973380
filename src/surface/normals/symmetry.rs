//! The surface that a mesh with symmetry planes is a part of.
//!
//! Across each plane that the mesh ends in it goes on as its mirror image, which ends in the images of the planes and
//! goes on as the image of that, and so on: all images g of the mesh under products of reflections, where image g r_p
//! lies across the plane p from image g. Nodal normals depend on the facets of a few rings around a node only, so the
//! images are made that far.

use super::super::facets::Facets;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::{Mat3, Vec3};
use std::collections::{HashMap, HashSet};

/// Nodes closer to a plane than this times the size of the mesh lie in it.
const TOUCH: f64 = 1e-5;
/// Images of the mesh that are no further apart than this times its size are one.
const SAME: f64 = 1e-4;
/// Rings of facets beyond the mesh that the normals of its nodes depend on, with some to spare.
const RINGS: usize = 8;
/// More images than this come from planes at angles that do not divide half a turn.
const MANY: usize = 400;

/// A mesh with as much of its images as matters to its normals.
pub struct Whole {
    /// Those of the mesh, and after them those of its images.
    pub facets: Facets,
    /// The node of the mesh that each node is an image of.
    pub node_of: Vec<u32>,
    /// For each facet after those of the mesh the one that it is an image of, and the linear part of the map.
    pub images: Vec<(usize, Mat3)>,
    /// The normals of the planes that each node of the mesh lies in, where there are planes.
    pub across: Vec<Vec<Vec3>>,
}

impl Whole {
    /// Completes `facets` of `mesh` across `planes` (point, normal).
    ///
    /// Fails on planes that the mesh does not end in, and that do not make a kaleidoscope.
    pub fn new(mesh: &Mesh, facets: &Facets, planes: &[(Vec3, Vec3)]) -> Result<Self> {
        let node_of = (0..facets.points.len() as u32).collect();
        let mut whole = Self { facets: facets.clone(), node_of, images: Vec::new(), across: Vec::new() };
        if planes.is_empty() {
            return Ok(whole);
        }
        let fail = |what: &str, help: &str| Error::input_anywhere(format!("{}: {what}", mesh.source), help);
        let mut growth = Growth::new(facets, planes).map_err(|(what, help)| fail(what, help))?;
        growth.grow().map_err(|(what, help)| fail(what, help))?;
        growth.append(&mut whole);
        let normals = |of: &Vec<usize>| of.iter().map(|p| planes[*p].1.normalize()).collect();
        whole.across = growth.planes_of.iter().map(normals).collect();
        whole.facets.across = vec![[None; 4]; whole.facets.nodes.len()];
        whole.facets.connect().map_err(|(f, g, _)| {
            let ids = [f, g].map(|f| mesh.facets[whole.original(f)].id);
            let what = format!("facets {} and {} overlap with their mirror images", ids[0], ids[1]);
            fail(&what, "a mesh with symmetry planes lies between them, at angles that divide 180 degrees")
        })?;
        Ok(whole)
    }

    /// The facet of the mesh that `f` is or is an image of.
    pub fn original(&self, f: usize) -> usize {
        f.checked_sub(self.facets.nodes.len() - self.images.len()).map_or(f, |image| self.images[image].0)
    }

    /// Normals at the corners of all facets from those of the mesh.
    pub fn spread(&self, mut normals: Vec<[Vec3; 4]>) -> Vec<[Vec3; 4]> {
        for (f, linear) in &self.images {
            let corner = |k: usize| linear * normals[*f][image_corner(linear, k, self.facets.count(*f))];
            let image = std::array::from_fn(corner);
            normals.push(image);
        }
        normals
    }
}

/// The corner that corner `k` of an image is an image of: reflections turn facets around, about their first node.
fn image_corner(linear: &Mat3, k: usize, count: usize) -> usize {
    if linear.determinant() < 0.0 { (count - k % count) % count } else { k % count }
}

/// What is wrong, and help.
type Fault = (&'static str, &'static str);

/// x -> linear x + shift.
#[derive(Clone, Copy)]
struct Isometry {
    linear: Mat3,
    shift: Vec3,
}

impl Isometry {
    fn at(&self, x: &Vec3) -> Vec3 {
        self.linear * x + self.shift
    }

    /// First `other`, then `self`.
    fn after(&self, other: &Self) -> Self {
        Self { linear: self.linear * other.linear, shift: self.at(&other.shift) }
    }
}

struct Growth<'a> {
    facets: &'a Facets,
    /// A box of the mesh.
    middle: Vec3,
    size: f64,
    reflections: Vec<Isometry>,
    /// The planes that each node lies in, of nodes where the mesh ends.
    planes_of: Vec<Vec<usize>>,
    /// The identity first.
    images: Vec<Isometry>,
    /// Image g r_p by (g, p).
    across: HashMap<(usize, usize), usize>,
    /// Number in the whole of node v in image g, by (g, v).
    numbers: HashMap<(usize, usize), u32>,
    /// The nodes after those of the mesh as (image, node), and the facets.
    nodes: Vec<(usize, usize)>,
    grown: Vec<(usize, usize)>,
}

impl<'a> Growth<'a> {
    fn new(facets: &'a Facets, planes: &[(Vec3, Vec3)]) -> std::result::Result<Self, Fault> {
        let used = || facets.corners().map(|(f, k)| facets.point(f, k));
        let low = used().fold(Vec3::repeat(f64::INFINITY), |low, x| low.inf(x));
        let high = used().fold(Vec3::repeat(f64::NEG_INFINITY), |high, x| high.sup(x));
        let size = (high - low).norm();
        let mut ends = vec![false; facets.points.len()];
        for (f, k) in facets.corners().filter(|(f, k)| facets.across[*f][*k].is_none()) {
            (ends[facets.node(f, k)], ends[facets.node(f, k + 1)]) = (true, true);
        }
        let mut planes_of = vec![Vec::new(); facets.points.len()];
        let mut reflections = Vec::with_capacity(planes.len());
        for (p, (point, normal)) in planes.iter().enumerate() {
            let normal = normal.try_normalize(0.0).filter(|n| n.iter().chain(point).all(|x| x.is_finite()));
            let normal = normal.ok_or(("a symmetry plane has no direction", "give a point and a normal"))?;
            let height = |x: &Vec3| (x - point).dot(&normal);
            let extent = used().fold([0.0_f64; 2], |[low, high], x| [low.min(height(x)), high.max(height(x))]);
            if extent[0] < -TOUCH * size && extent[1] > TOUCH * size {
                let help = "move the plane to where the mesh ends, or mesh one side of it only";
                return Err(("the mesh lies on both sides of a symmetry plane", help));
            }
            let lies_in = |f: usize| (0..facets.count(f)).all(|k| height(facets.point(f, k)).abs() <= TOUCH * size);
            if extent[1] - extent[0] > TOUCH * size && (0..facets.nodes.len()).any(lies_in) {
                let help = "leave them out: the surface goes on across the plane";
                return Err(("some of its faces lie in a symmetry plane", help));
            }
            let touching = (0..ends.len()).filter(|&v| ends[v] && height(&facets.points[v]).abs() <= TOUCH * size);
            let touching: Vec<usize> = touching.collect();
            if touching.len() < 2 || extent[1] - extent[0] <= TOUCH * size {
                return Err(("the mesh does not end in a symmetry plane", "move the plane to where the mesh ends"));
            }
            touching.into_iter().for_each(|v| planes_of[v].push(p));
            let linear = Mat3::identity() - normal * normal.transpose() * 2.0;
            reflections.push(Isometry { linear, shift: normal * (2.0 * point.dot(&normal)) });
        }
        Ok(Self {
            facets,
            middle: (low + high) * 0.5,
            size,
            reflections,
            planes_of,
            images: vec![Isometry { linear: Mat3::identity(), shift: Vec3::zeros() }],
            across: HashMap::new(),
            numbers: HashMap::new(),
            nodes: Vec::new(),
            grown: Vec::new(),
        })
    }

    /// Makes ring after ring of facets beyond the mesh, from the nodes in the planes.
    fn grow(&mut self) -> std::result::Result<(), Fault> {
        let around = self.facets.around_nodes();
        let mut known = HashSet::new();
        let mut ring = Vec::new();
        for v in (0..self.planes_of.len()).filter(|&v| !around[v].is_empty()) {
            self.place(0, v, v as u32, &mut ring)?;
        }
        for _ in 0..RINGS {
            let mut next = Vec::new();
            for (g, v) in ring.into_iter().filter(|(g, _)| *g > 0) {
                for &(f, _) in &around[v] {
                    if !known.insert((g, f)) {
                        continue;
                    }
                    self.grown.push((g, f));
                    for k in 0..self.facets.count(f) {
                        let w = self.facets.node(f, k);
                        if !self.numbers.contains_key(&(g, w)) {
                            let number = (self.facets.points.len() + self.nodes.len()) as u32;
                            self.nodes.push((g, w));
                            self.place(g, w, number, &mut next)?;
                        }
                    }
                }
            }
            ring = next;
        }
        Ok(())
    }

    /// Numbers node `v` in image `g` and in all images that meet there, which are added to `ring`.
    fn place(
        &mut self,
        g: usize,
        v: usize,
        number: u32,
        ring: &mut Vec<(usize, usize)>,
    ) -> std::result::Result<(), Fault> {
        let mut stack = vec![g];
        while let Some(g) = stack.pop() {
            if self.numbers.insert((g, v), number).is_none() {
                ring.push((g, v));
                for at in 0..self.planes_of[v].len() {
                    stack.push(self.image_across(g, self.planes_of[v][at])?);
                }
            }
        }
        Ok(())
    }

    /// The image across plane `p` from image `g`.
    fn image_across(&mut self, g: usize, p: usize) -> std::result::Result<usize, Fault> {
        if let Some(&found) = self.across.get(&(g, p)) {
            return Ok(found);
        }
        let image = self.images[g].after(&self.reflections[p]);
        let corners: [Vec3; 4] =
            std::array::from_fn(|k| self.middle + if k < 3 { Vec3::ith(k, self.size) } else { Vec3::zeros() });
        let is_same = |other: &Isometry| {
            corners.iter().all(|corner| (other.at(corner) - image.at(corner)).norm() <= SAME * self.size)
        };
        let found = self.images.iter().position(is_same).unwrap_or(self.images.len());
        if found == self.images.len() {
            self.images.push(image);
        }
        if self.images.len() > MANY {
            return Err(("the symmetry planes do not close", "give planes at angles that divide 180 degrees"));
        }
        self.across.insert((g, p), found);
        Ok(found)
    }

    fn append(&self, whole: &mut Whole) {
        for &(g, v) in &self.nodes {
            whole.facets.points.push(self.images[g].at(&self.facets.points[v]));
            whole.node_of.push(v as u32);
        }
        for &(g, f) in &self.grown {
            let (linear, count) = (self.images[g].linear, self.facets.count(f));
            let node = |k: usize| self.numbers[&(g, self.facets.node(f, image_corner(&linear, k, count)))];
            whole.facets.nodes.push(std::array::from_fn(node));
            whole.facets.counts.push(count as u8);
            whole.facets.normals.push(linear * self.facets.normals[f]);
            whole.images.push((f, linear));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{NormalOptions, Weight};
    use super::*;
    use crate::surface::Smoothing;
    use crate::surface::patch::Patch;
    use crate::surface::patches_from_mesh;
    use crate::surface::piece::Edge;
    use crate::surface::test_meshes::{cubed_sphere, grid, indenter, indenter_normal, mesh_of};

    /// The facets of `mesh` on the positive side of the planes x_axis = at.
    fn part(mesh: &Mesh, axes: &[usize], at: [f64; 3]) -> Mesh {
        let inside = |nodes: &[u32]| {
            let sum = |axis: usize| nodes.iter().map(|v| mesh.points[*v as usize][axis] - at[axis]).sum::<f64>();
            axes.iter().all(|axis| sum(*axis) > 0.0)
        };
        let facets: Vec<&[u32]> = mesh.facets.iter().map(|f| f.nodes()).filter(|nodes| inside(nodes)).collect();
        mesh_of(mesh.points.clone(), &facets)
    }

    /// `mesh` and after it its mirror image in the plane x_axis = at.
    fn mirrored(mesh: &Mesh, axis: usize, at: [f64; 3]) -> Mesh {
        let mut points = mesh.points.clone();
        let image: Vec<u32> = mesh
            .points
            .iter()
            .zip(0..)
            .map(|(x, v)| {
                if (x[axis] - at[axis]).abs() < 1e-9 {
                    return v;
                }
                let mut y = *x;
                y[axis] = 2.0 * at[axis] - x[axis];
                points.push(y);
                points.len() as u32 - 1
            })
            .collect();
        let mut facets: Vec<Vec<u32>> = mesh.facets.iter().map(|f| f.nodes().to_vec()).collect();
        let images = facets.clone();
        facets.extend(images.iter().map(|nodes| nodes.iter().rev().map(|v| image[*v as usize]).collect()));
        mesh_of(points, &facets.iter().map(|nodes| &nodes[..]).collect::<Vec<_>>())
    }

    fn planes(axes: &[usize], at: [f64; 3]) -> Vec<(Vec3, Vec3)> {
        axes.iter().map(|axis| (Vec3::from(at), Vec3::ith(*axis, -1.0))).collect()
    }

    fn patches(mesh: &Mesh, options: &NormalOptions) -> Result<Vec<Patch>> {
        patches_from_mesh(mesh, Smoothing::Nagata, options, false)
    }

    /// The part with symmetry planes has the patches of the whole, with ends where it ends.
    fn check(mesh: &Mesh, axes: &[usize], at: [f64; 3]) {
        let part = part(mesh, axes, at);
        let whole = axes.iter().fold(part.clone(), |whole, axis| mirrored(&whole, *axis, at));
        for (_, weight) in Weight::ALL {
            let options = NormalOptions { weight, ..NormalOptions::default() };
            let of_whole = patches(&whole, &options).unwrap();
            let of_part = patches(&part, &NormalOptions { symmetry: planes(axes, at), ..options }).unwrap();
            let mut ends = 0;
            for (p, w) in of_part.iter().zip(&of_whole) {
                let size = (p.nodes[1] - p.nodes[0]).norm();
                for k in 0..p.count as usize {
                    let apart = (p.coefficients[k] - w.coefficients[k]).norm();
                    assert!(apart <= 1e-13 * size, "{apart} {weight:?} {axes:?}");
                    let in_plane = |axis: &usize| {
                        [k, k + 1].iter().all(|k| (p.nodes[k % p.count as usize][*axis] - at[*axis]).abs() < 1e-9)
                    };
                    if axes.iter().any(in_plane) {
                        assert_eq!(p.edges[k], Edge::Boundary);
                        ends += 1;
                    } else {
                        assert_eq!(p.edges[k], w.edges[k]);
                    }
                }
            }
            assert!(ends >= axes.len());
        }
    }

    /// A ball, crumpled so that all nodes are different, and a cube, whose sharp edges end in the planes.
    fn shapes(triangles: bool) -> [Mesh; 2] {
        let mut ball = cubed_sphere(6, triangles, 6);
        let mut cube = ball.clone();
        for (k, p) in ball.points.iter_mut().enumerate() {
            *p = p.map(|x| x * (1.0 + 0.05 * (17.3 * k as f64).sin()));
        }
        for p in &mut cube.points {
            let largest = p.iter().fold(0.0, |largest, x| f64::max(largest, x.abs()));
            *p = p.map(|x| x / largest);
        }
        [ball, cube]
    }

    #[test]
    fn half_a_quarter_and_an_eighth_are_parts_of_the_whole() {
        for triangles in [false, true] {
            for mesh in shapes(triangles) {
                for axes in [&[0][..], &[2], &[0, 1], &[0, 1, 2]] {
                    check(&mesh, axes, [0.0; 3]);
                }
            }
            for (axes, at) in [(&[0][..], [0.0; 3]), (&[2], [0.0, 0.0, 0.5]), (&[0, 2], [0.0, 0.0, 0.5])] {
                check(&indenter(2, triangles), axes, at);
            }
        }
    }

    /// A cap of the sphere that is cut off aslant by the plane: the whole has a crease there.
    #[test]
    fn a_crease_in_the_plane_is_that_of_the_whole() {
        for triangles in [false, true] {
            let mesh = grid(6, 6, triangles, |s, t| {
                let (a, b) = (1.2 * s, 1.2 * t - 0.6);
                [a.sin() * b.cos(), b.sin(), a.cos() * b.cos() + 0.9 * a.sin() * b.cos()]
            });
            check(&mesh, &[0], [0.0; 3]);
        }
    }

    /// One facet between two parallel planes, and slices of a ball between planes at 180/n degrees.
    #[test]
    fn thin_parts_and_slices_have_normals_in_the_planes() {
        let strip = indenter(1, true);
        let faces = [-0.5, 1.5].map(|z| (Vec3::z() * z, Vec3::z())).to_vec();
        let facets = Facets::new(&strip, false).unwrap();
        let options = NormalOptions { symmetry: faces, ..NormalOptions::default() };
        let (_, normals) = super::super::Normals::of_mesh(&strip, &facets, &options).unwrap();
        for (f, k) in facets.corners() {
            assert!((normals.corners[f][k] - indenter_normal(facets.point(f, k))).norm() < 1e-12);
        }
        for n in [1, 2, 3, 4, 6, 18] {
            let (mesh, symmetry) = slice(std::f64::consts::PI / n as f64);
            let facets = Facets::new(&mesh, false).unwrap();
            let weight = Weight::Equal;
            let options = NormalOptions { weight, symmetry, feature_angle: 180.0, ..NormalOptions::default() };
            let (_, normals) = super::super::Normals::of_mesh(&mesh, &facets, &options).unwrap();
            let mut seen = 0;
            for (f, k) in facets.corners() {
                for (point, across) in &options.symmetry {
                    if (facets.point(f, k) - point).dot(across).abs() < 1e-9 {
                        seen += 1;
                        let out = normals.corners[f][k].dot(across).abs();
                        assert!(out < 1e-14, "{n} {out} at {}", facets.point(f, k));
                    }
                }
            }
            assert!(seen >= 16);
        }
    }

    /// A crumpled cap of a ball around the z axis between the planes at the angles 0 and `angle`.
    fn slice(angle: f64) -> (Mesh, Vec<(Vec3, Vec3)>) {
        let mut points = vec![[0.0, 0.0, 1.0]];
        let mut facets = Vec::new();
        for ring in 1..=4_u32 {
            for k in 0..=3_u32 {
                let (a, b) = (angle * k as f64 / 3.0, 0.2 * ring as f64);
                let r = 1.0 + 0.03 * (7.0 * (ring * 4 + k) as f64).sin();
                points.push([r * b.sin() * a.cos(), r * b.sin() * a.sin(), r * b.cos()]);
                let here = points.len() as u32 - 1;
                match (ring, k) {
                    (_, 0) => {}
                    (1, _) => facets.push(vec![0, here - 1, here]),
                    _ => facets.push(vec![here - 5, here - 1, here, here - 4]),
                }
            }
        }
        let mesh = mesh_of(points, &facets.iter().map(|nodes| &nodes[..]).collect::<Vec<_>>());
        (mesh, vec![(Vec3::zeros(), Vec3::y()), (Vec3::zeros(), Vec3::new(-angle.sin(), angle.cos(), 0.0))])
    }

    #[test]
    fn planes_that_do_not_fit_are_refused() {
        let ball = cubed_sphere(4, false, 6);
        let half = part(&ball, &[0], [0.0; 3]);
        let text = |mesh: &Mesh, symmetry: &[(Vec3, Vec3)]| {
            let options = NormalOptions { symmetry: symmetry.to_vec(), ..NormalOptions::default() };
            patches(mesh, &options).err().map_or(String::new(), |error| error.to_string())
        };
        assert_eq!(text(&half, &planes(&[0], [0.0; 3])), "");
        assert!(text(&half, &planes(&[1], [0.0; 3])).contains("the mesh lies on both sides of a symmetry plane"));
        assert!(text(&half, &planes(&[0], [-0.1; 3])).contains("the mesh does not end in a symmetry plane"));
        assert!(text(&ball, &planes(&[0], [-1.0; 3])).contains("the mesh does not end in a symmetry plane"));
        assert!(text(&half, &[(Vec3::zeros(), Vec3::zeros())]).contains("a symmetry plane has no direction"));
        let flat = grid(2, 2, false, |s, t| [s, t, 0.0]);
        assert!(text(&flat, &planes(&[2], [0.0; 3])).contains("does not end in a symmetry plane"));
        let wedge = mesh_of(
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]],
            &[&[0, 3, 2, 1], &[0, 4, 5, 3], &[1, 2, 5, 4]],
        );
        assert!(text(&wedge, &planes(&[2], [0.0; 3])).contains("some of its faces lie in a symmetry plane"));
        for angle in [0.9, 1.234, 2.4] {
            let (mesh, symmetry) = slice(angle);
            let text = text(&mesh, &symmetry);
            assert!(text.contains("the symmetry planes do not close"), "{angle}: {text}");
        }
    }
}

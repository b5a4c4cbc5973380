//! Nodal normals of a mesh from another description of the same surface (section 5.4.2, Fig. 23 of the paper).

use super::shape::Shape;
use crate::Vec3;
use crate::error::{Error, Location, Result};
use crate::mesh::Mesh;

/// Distance of a node from the description, over the size of the mesh, from which they are not the same surface.
const APART: f64 = 0.01;

/// For each facet of `mesh` the normals at its nodes: those of the nearest points of `surface`, the whole of a description
/// called `key`, which is asked for at a place; where faces meet at an angle, those of the face that goes with the facet. Also the greatest distance of a
/// node from the surface.
///
/// # Errors
/// A node that is not on the surface.
pub fn from_surface(mesh: &Mesh, surface: &Shape, key: &str, at: &Location) -> Result<(Vec<[Vec3; 4]>, f64)> {
    let points: Vec<Vec3> = mesh.points.iter().map(|point| Vec3::from(*point)).collect();
    let corners = || mesh.facets.iter().flat_map(|facet| facet.nodes()).map(|node| &points[*node as usize]);
    let bounds = corners().fold((points[0], points[0]), |(low, high), x| (low.inf(x), high.sup(x)));
    let size = (bounds.1 - bounds.0).norm();
    let mut farthest = (0.0, 0);
    let mut normals = Vec::with_capacity(mesh.facets.len());
    for facet in &mesh.facets {
        let nodes = facet.nodes();
        let corner = |k: usize| points[nodes[k % nodes.len()] as usize];
        let mut here = [Vec3::zeros(); 4];
        for k in 0..nodes.len() {
            let facet_normal = (corner(k + 1) - corner(k)).cross(&(corner(k + nodes.len() - 1) - corner(k)));
            let (normal, distance) =
                surface.side_normal(&corner(k), &facet_normal).unwrap_or((Vec3::zeros(), f64::INFINITY));
            here[k] = normal;
            if distance > farthest.0 {
                farthest = (distance, nodes[k] as usize);
            }
        }
        normals.push(here);
    }
    let (distance, node) = farthest;
    if distance > APART * size {
        let id = mesh.point_ids[node];
        let what =
            format!("node {id} of {} is {distance:.3e} away from the {key}, which has no normal for it", mesh.source);
        let help =
            "both must describe the same surface in the same place and unit of length; a CAD file declares its unit";
        return Err(Error::input(at, what, help));
    }
    Ok((normals, distance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::analytic::{Chain, Profile, Sphere, Sweep};
    use crate::surface::test_meshes::{cubed_sphere, indenter, indenter_normal, strip};
    use crate::surface::{Analytic, Face, FaceSet, Nurbs, sew};

    fn place() -> Location {
        Location { file: "a.toml".into(), line: 3, column: 7, text: "normals = \"sphere\"".into() }
    }

    /// Section x, y with its corners, drawn out along z.
    fn extruded(points: &[[f64; 2]], fillets: &[f64]) -> Shape {
        let chain = Chain::new(points, fillets, false, false).unwrap();
        let sweep = Sweep::Extruded { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), length: None };
        Shape::Analytic(Analytic::Profile(Profile { chain, sweep }))
    }

    fn plane(corner: [f64; 3], u: [f64; 3], v: [f64; 3]) -> Face {
        let surface = Nurbs::plane(corner.into(), u.into(), v.into());
        Face { surface, loops: Vec::new(), reversed: false, name: "plane".into() }
    }

    #[test]
    fn smooth_surfaces_give_their_normals() {
        let shape = extruded(&[[-20.0, 40.0], [-20.0, 0.0], [20.0, 0.0], [20.0, 40.0]], &[0.0, 10.0, 10.0, 0.0]);
        let sphere = Shape::Analytic(Analytic::Sphere(Sphere { center: Vec3::zeros(), radius: 1.0, hollow: true }));
        for triangles in [false, true] {
            let on_indenter = (indenter(2, triangles), &shape, indenter_normal as fn(&Vec3) -> Vec3);
            let on_sphere = (cubed_sphere(4, triangles, 6), &sphere, (|x: &Vec3| -x) as fn(&Vec3) -> Vec3);
            for (mesh, shape, exact) in [on_indenter, on_sphere] {
                let (normals, distance) = from_surface(&mesh, shape, "shape", &place()).unwrap();
                assert!(distance < 1e-13);
                for (facet, normals) in mesh.facets.iter().zip(&normals) {
                    for (node, normal) in facet.nodes().iter().zip(normals) {
                        assert!((normal - exact(&mesh.points[*node as usize].into())).norm() < 1e-13);
                    }
                }
            }
        }
    }

    /// A step with a convex and a concave edge, as a profile and as CAD faces: each facet has the normals of its own plane.
    #[test]
    fn at_edges_each_facet_has_the_normal_of_its_side() {
        let section = [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, -1.0]];
        let mesh = strip(&section, 2, true);
        let faces: Vec<Face> = section
            .windows(2)
            .map(|ends| {
                plane(
                    [ends[0][0], ends[0][1], -0.5],
                    [ends[1][0] - ends[0][0], ends[1][1] - ends[0][1], 0.0],
                    [0.0, 0.0, 2.0],
                )
            })
            .collect();
        let faces = FaceSet::new(&sew(&faces, 0.7, 1e-6, false).unwrap());
        for shape in [extruded(&section, &[0.0; 4]), Shape::Faces(faces)] {
            let (normals, distance) = from_surface(&mesh, &shape, "shape", &place()).unwrap();
            assert!(distance < 1e-12);
            for (facet, normals) in mesh.facets.iter().zip(&normals) {
                let [a, b, c] = [0, 1, 2].map(|k| Vec3::from(mesh.points[facet.nodes[k] as usize]));
                let exact = (b - a).cross(&(c - a)).normalize();
                assert!(normals[..3].iter().all(|n| (n - exact).norm() < 1e-12), "{normals:?} {exact}");
            }
        }
    }

    #[test]
    fn another_unit_is_noticed() {
        let sphere = Shape::Analytic(Analytic::Sphere(Sphere { center: Vec3::zeros(), radius: 25.4, hollow: false }));
        let error = from_surface(&cubed_sphere(2, false, 6), &sphere, "sphere", &place()).unwrap_err().to_string();
        assert!(error.starts_with("a.toml:3:7: node "), "{error}");
        assert!(
            error.contains(" of test is 2.440e1 away from the sphere") && error.contains("unit of length"),
            "{error}"
        );
    }
}

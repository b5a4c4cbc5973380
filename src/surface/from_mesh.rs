//! From a mesh to its patches.
//!
//! An edge of length L whose nodal normals turn by b along it stands for an arc of radius R = L / (2 sin(b/2)). From the
//! middle of the arc a facet and a Nagata patch are
//!
//! ```text
//! R (1 - cos(b/2)),     R (1 - cos(b/2))^2 / (2 cos(b/2))
//! ```
//!
//! away: L b / 8 and L b^3 / 128, but for higher orders. A quadrilateral adds those of its two directions; a triangle of three
//! equal edges is 4/3 as far from a sphere, with its middle, as with that of an edge.

use super::facets::{Facets, angle};
use super::nagata::{crease_coefficient, edge_coefficient};
use super::normals::{NormalOptions, Normals};
use super::patch::Patch;
use super::piece::Edge;
use super::smoothing::Smoothing;
use crate::Vec3;
use crate::error::Result;
use crate::mesh::Mesh;

/// The patches of a surface mesh, one for each facet, numbered like [`Mesh::facets`].
///
/// `options` matter to [`Smoothing::Nagata`] alone. `flip` turns the surface over. Fails when the facets do not make a
/// surface, see [`Facets::new`], and on options that do not fit the mesh.
pub fn patches_from_mesh(mesh: &Mesh, smoothing: Smoothing, options: &NormalOptions, flip: bool) -> Result<Vec<Patch>> {
    smooth(mesh, smoothing, options, flip).map(|(patches, _)| patches)
}

/// [`patches_from_mesh`], and the number of edges whose normals at both ends no quadratic curve meets.
pub fn smooth(mesh: &Mesh, smoothing: Smoothing, options: &NormalOptions, flip: bool) -> Result<(Vec<Patch>, usize)> {
    let facets = Facets::new(mesh, flip)?;
    let on_boundary = boundary_nodes(&facets);
    let (whole, normals) = Normals::of_mesh(mesh, &facets, options)?;
    let deviations: Vec<f64> =
        (0..facets.nodes.len()).map(|f| deviation(&facets, f, &normals.corners[f], smoothing)).collect();
    let (edges, coefficients, inflected) = match smoothing {
        Smoothing::Facet => (facet_edges(&facets), vec![[Vec3::zeros(); 4]; facets.nodes.len()], 0),
        Smoothing::Nagata => {
            let (coefficients, inflected) = (coefficients(&whole, &normals), normals.inflected(&facets));
            (normals.edges, coefficients, inflected)
        }
    };
    let patch = |f: usize| Patch {
        id: f as u32,
        count: facets.counts[f],
        nodes: std::array::from_fn(|k| *facets.point(f, k)),
        coefficients: coefficients[f],
        middle: Vec3::zeros(),
        edges: std::array::from_fn(|k| facets.across[f][k].map_or(Edge::Boundary, |_| edges[f][k])),
        on_boundary: std::array::from_fn(|k| on_boundary[facets.node(f, k)]),
        deviation: deviations[f],
    };
    Ok(((0..facets.nodes.len()).map(patch).collect(), inflected))
}

/// How far the arcs over its edges are from a facet, or from the patch in its place, at most.
fn deviation(facets: &Facets, f: usize, normals: &[Vec3; 4], smoothing: Smoothing) -> f64 {
    let count = facets.count(f);
    let of_edge = |k: usize| {
        let d = facets.edge(f, k);
        let length = d.norm();
        // Half of the turn along the edge, not around it.
        let sine = (0.5 * (normals[(k + 1) % count] - normals[k]).dot(&d).abs() / length).min(1.0);
        let cosine = (1.0 - sine * sine).sqrt();
        if sine == 0.0 {
            return 0.0;
        }
        // 1 - cos(b/2) without its rounding.
        let sagitta = 0.5 * length * sine / (1.0 + cosine);
        match smoothing {
            Smoothing::Facet => sagitta,
            Smoothing::Nagata => sagitta * sine * sine / (2.0 * cosine.max(0.1) * (1.0 + cosine)),
        }
    };
    let edges: [f64; 4] = std::array::from_fn(|k| if k < count { of_edge(k) } else { 0.0 });
    let [along, across] = [edges[0].max(edges[2]), edges[1].max(edges[3])];
    match (count, smoothing) {
        (3, _) => 4.0 / 3.0 * along.max(across),
        (_, Smoothing::Facet) => along + across,
        // z = -(x^2 + y^2)^2 / 8 of a sphere: a blend of the edges lacks the product, too.
        (_, Smoothing::Nagata) => (along.sqrt() + across.sqrt()).powi(2),
    }
}

/// Nodes where the surface ends.
pub(super) fn boundary_nodes(facets: &Facets) -> Vec<bool> {
    let mut on_boundary = vec![false; facets.points.len()];
    for (f, k) in facets.corners().filter(|(f, k)| facets.across[*f][*k].is_none()) {
        on_boundary[facets.node(f, k)] = true;
        on_boundary[facets.node(f, k + 1)] = true;
    }
    on_boundary
}

/// Between facets an edge is smooth only when they lie in one plane there.
pub(super) fn facet_edges(facets: &Facets) -> Vec<[Edge; 4]> {
    let flat = |f: usize, k: usize, g: usize, j: usize| angle(&facets.corner(f, k).0, &facets.corner(g, j).0) < 1e-6;
    let kind = |f: usize, k: usize| match facets.across[f][k] {
        None => Edge::Boundary,
        Some((g, j)) if flat(f, k, g, j + 1) && flat(f, k + 1, g, j) => Edge::Smooth,
        Some(_) => Edge::Sharp,
    };
    (0..facets.nodes.len()).map(|f| std::array::from_fn(|k| kind(f, k))).collect()
}

/// Coefficients of all edges, the same from both sides.
fn coefficients(facets: &Facets, normals: &Normals) -> Vec<[Vec3; 4]> {
    let ends = |f: usize, k: usize| (&normals.corners[f][k], &normals.corners[f][(k + 1) % facets.count(f)]);
    let coefficient = |f: usize, k: usize| {
        let (d, (n0, n1)) = (facets.edge(f, k), ends(f, k));
        match facets.across[f][k].filter(|_| normals.edges[f][k] == Edge::Sharp) {
            None => edge_coefficient(&d, n0, n1),
            Some((g, j)) => {
                let (m1, m0) = ends(g, j);
                crease_coefficient(&d, [n0, n1], [m0, m1])
            }
        }
    };
    let of_facet =
        |f: usize| std::array::from_fn(|k| if k < facets.count(f) { coefficient(f, k) } else { Vec3::zeros() });
    (0..facets.nodes.len()).map(of_facet).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::test_meshes::{grid, indenter, sphere_patches};

    /// Largest errors of shape and normal (radians) over patches of the unit sphere, or cylinder about z when `flat`.
    fn errors(patches: &[Patch], flat: bool) -> [f64; 2] {
        let mut worst = [0.0_f64; 2];
        for patch in patches {
            for k in 0..169 {
                let (s, t) = ((k % 13) as f64 / 12.0, (k / 13) as f64 / 12.0);
                let xi = if patch.count == 3 { [s, s * t] } else { [s, t] };
                let mut x = patch.point(xi);
                x.z *= if flat { 0.0 } else { 1.0 };
                worst[0] = worst[0].max((x.norm() - 1.0).abs());
                worst[1] = worst[1].max(angle(&patch.normal(xi), &x));
            }
        }
        worst
    }

    fn orders(coarse: [f64; 2], fine: [f64; 2]) -> [f64; 2] {
        [(coarse[0] / fine[0]).log2(), (coarse[1] / fine[1]).log2()]
    }

    fn arc(n: usize, triangles: bool, smoothing: Smoothing) -> Vec<Patch> {
        let mesh = grid(n, 1, triangles, |s, t| {
            let a = std::f64::consts::FRAC_PI_2 * s;
            [a.cos(), a.sin(), t]
        });
        let options = NormalOptions { feature_angle: 60.0, ..NormalOptions::default() };
        patches_from_mesh(&mesh, smoothing, &options, false).unwrap()
    }

    #[test]
    fn arcs_have_the_exact_errors_of_their_theory() {
        for n in [2, 4, 5, 6, 10] {
            let half = std::f64::consts::FRAC_PI_4 / n as f64;
            let patch = arc(n, false, Smoothing::Nagata);
            let [shape, normal] = errors(&patch, true);
            let sagitta = 1.0 - half.cos();
            assert!((shape - sagitta * sagitta / (2.0 * half.cos())).abs() < 1e-15);
            assert!(patch.iter().all(|p| (p.deviation - shape).abs() < 1e-15));
            assert!(normal < 0.19245 * half.powi(3) * 1.1 && normal > 0.19245 * half.powi(3) * 0.9);
            let facets = arc(n, false, Smoothing::Facet);
            let [shape, normal] = errors(&facets, true);
            assert!((shape - sagitta).abs() < 1e-14 && (normal - half).abs() < 1e-14);
            assert!(facets.iter().all(|p| (p.deviation - sagitta).abs() < 1e-14));
        }
        assert!((errors(&arc(4, false, Smoothing::Nagata), true)[0] - 1.8822e-4).abs() < 1e-8);
        for triangles in [false, true] {
            let order = orders(
                errors(&arc(8, triangles, Smoothing::Nagata), true),
                errors(&arc(16, triangles, Smoothing::Nagata), true),
            );
            assert!((order[0] - 4.0).abs() < 0.1 && order[1] > 2.9, "{triangles}: {order:?}");
        }
    }

    /// Place by place, of arcs by Nagata and of the two halves of a parabola through three points of one.
    #[test]
    fn arcs_know_how_far_they_are_off() {
        let check = |patch: &Patch, is_quadratic: bool| {
            for k in 0..=20 {
                let xi = [0.5, k as f64 / 20.0];
                let x = patch.point(xi);
                let (off, known) = ((x.xy().norm() - 1.0).abs(), patch.off_arc(xi, is_quadratic));
                assert!((off - known).abs() < 0.03 * off + 1e-7, "{is_quadratic} {k}: {off} {known}");
            }
        };
        let turned = |mut patch: Patch, by: usize| {
            patch.nodes.rotate_left(by);
            patch.coefficients.rotate_left(by);
            patch
        };
        let along = |patch: Patch| turned(patch, if (patch.nodes[1] - patch.nodes[0]).z.abs() > 0.1 { 0 } else { 1 });
        arc(8, false, Smoothing::Nagata).into_iter().for_each(|patch| check(&along(patch), false));
        let [from, middle, to] = [-0.2_f64, 0.0, 0.2].map(|a| Vec3::new(a.cos(), a.sin(), 0.0));
        let bend = (from + to) * 0.5 - middle;
        for corner in [from, to] {
            // A quarter of the second difference of the face, for half of its way.
            let (nodes, up) = ([corner, middle], Vec3::z());
            let patch = Patch {
                nodes: [nodes[0], nodes[0] + up, nodes[1] + up, nodes[1]],
                coefficients: [Vec3::zeros(), bend, Vec3::zeros(), bend],
                ..arc(1, false, Smoothing::Facet)[0]
            };
            check(&patch, true);
        }
    }

    #[test]
    fn spheres_converge_with_orders_4_and_3_or_2_and_1() {
        for triangles in [false, true] {
            for (smoothing, expected) in [(Smoothing::Nagata, [4.0, 3.0]), (Smoothing::Facet, [2.0, 1.0])] {
                let at = |n| {
                    let patches = sphere_patches(n, triangles, 1, smoothing);
                    let area = |p: &Patch| 0.5 * (p.nodes[2] - p.nodes[0]).cross(&(p.nodes[3] - p.nodes[1])).norm();
                    (patches.iter().map(area).fold(0.0, f64::max).sqrt(), errors(&patches, false))
                };
                let ((h, coarse), (half, fine)) = (at(16), at(32));
                let order = orders(coarse, fine).map(|order| order / (h / half).log2());
                assert!((order[0] - expected[0]).abs() < 0.1 && (order[1] - expected[1]).abs() < 0.1, "{order:?}");
            }
        }
    }

    /// The largest deviation over the largest error.
    #[test]
    fn spheres_deviate_as_their_patches_know() {
        for (triangles, smoothing, most) in [
            (false, Smoothing::Nagata, 1.6),
            (true, Smoothing::Nagata, 1.6),
            (false, Smoothing::Facet, 1.6),
            (true, Smoothing::Facet, 1.6),
        ] {
            for n in [8, 16] {
                let patches = sphere_patches(n, triangles, 1, smoothing);
                let known = patches.iter().map(|p| p.deviation).fold(0.0, f64::max);
                let ratio = known / errors(&patches, false)[0];
                println!("{triangles} {smoothing:?} {n} {ratio}");
                assert!((0.9..most).contains(&ratio), "{triangles} {smoothing:?} {n}: {ratio}");
            }
        }
    }

    #[test]
    fn neighbours_share_their_edges() {
        for triangles in [false, true] {
            let mesh = crate::surface::test_meshes::cubed_sphere(3, triangles, 5);
            for feature in [5.0, 40.0, 180.0] {
                let facets = Facets::new(&mesh, false).unwrap();
                let options = NormalOptions { feature_angle: feature, ..NormalOptions::default() };
                let patches = patches_from_mesh(&mesh, Smoothing::Nagata, &options, false).unwrap();
                for (f, patch) in patches.iter().enumerate() {
                    for k in 0..facets.count(f) {
                        match facets.across[f][k] {
                            None => assert_eq!(patch.edges[k], Edge::Boundary),
                            Some((g, j)) => {
                                assert!((patch.coefficients[k] - patches[g].coefficients[j]).norm() < 1e-15);
                                assert_eq!(patch.edges[k], patches[g].edges[j]);
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn flat_parts_stay_facets() {
        for triangles in [false, true] {
            let options = NormalOptions::default();
            let patches = patches_from_mesh(&indenter(2, triangles), Smoothing::Nagata, &options, false).unwrap();
            let curved = patches.iter().filter(|p| p.coefficients.iter().any(|c| c.norm() > 1e-12)).count();
            assert_eq!(curved, if triangles { 32 } else { 16 });
        }
    }
}

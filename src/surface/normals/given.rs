//! Normals that are known from elsewhere, such as the geometry that was meshed.

use super::super::facets::{Facets, angle};
use super::super::piece::Edge;
use super::groups::Groups;
use super::{Normals, kinds};
use crate::Vec3;
use crate::error::{Error, Result};
use crate::mesh::Mesh;

/// Cosine between the normals at a node and of its facet below which they have nothing to do with each other.
const SIDEWAYS: f64 = 1e-3;

/// Normals `given` at the nodes of the facets of `mesh`: of length 1, on the side of the facet, by its corners.
///
/// Fails when some are missing or lie in their facet.
pub fn sorted(mesh: &Mesh, facets: &Facets, given: &[[Vec3; 4]]) -> Result<Vec<[Vec3; 4]>> {
    let fail = |what: String, help: &str| Error::input_anywhere(format!("{}: {what}", mesh.source), help);
    if given.len() != facets.nodes.len() {
        let what = format!("{} facets, but normals for {}", facets.nodes.len(), given.len());
        return Err(fail(what, "give the normals of every facet"));
    }
    let mut sorted = vec![[Vec3::zeros(); 4]; given.len()];
    for (f, k) in facets.corners() {
        let node = facets.nodes[f][k];
        let from = mesh.facets[f].nodes().iter().position(|other| *other == node).unwrap_or(k);
        let normal = given[f][from].try_normalize(0.0).filter(|n| n.dot(&facets.normals[f]).abs() > SIDEWAYS);
        let normal = normal.ok_or_else(|| {
            let id = mesh.point_ids.get(node as usize).copied().unwrap_or(node as u64);
            let what = format!("the normal given at node {id} lies in facet {}", mesh.facets[f].id);
            fail(what, "give the normals of the surface that was meshed")
        })?;
        sorted[f][k] = normal * normal.dot(&facets.normals[f]).signum();
    }
    Ok(sorted)
}

/// The unit normals `given` at the corners; edges whose two sides differ by more than `feature_angle` (radians) at an
/// end are sharp, and those that are said to be; in a fan across smooth edges the normals become one.
pub fn normals(
    facets: &Facets,
    given: &[[Vec3; 4]],
    feature_angle: f64,
    is_sharp: impl Fn(usize, usize) -> bool,
) -> Normals {
    let differ = |f: usize, k: usize, (g, j): (usize, usize)| {
        let [next, other] = [facets.beside(f, k)[0], facets.beside(g, j)[0]];
        let ends = [(&given[f][k], &given[g][other]), (&given[f][next], &given[g][j])];
        ends.iter().any(|(a, b)| angle(a, b) > feature_angle)
    };
    let edges = kinds(facets, |f, k| is_sharp(f, k) || facets.across[f][k].is_some_and(|other| differ(f, k, other)));
    let fans = Groups::new(facets, |f, k| edges[f][k] == Edge::Smooth);
    let mut sums = vec![Vec3::zeros(); fans.count];
    facets.corners().for_each(|(f, k)| sums[fans.of(f, k)] += given[f][k]);
    let normals: Vec<Vec3> = sums.iter().map(|sum| sum.try_normalize(f64::MIN_POSITIVE).unwrap_or_default()).collect();
    Normals { corners: fans.spread(facets, &normals), edges }
}

#[cfg(test)]
mod tests {
    use super::super::NormalOptions;
    use super::*;
    use crate::surface::Smoothing;
    use crate::surface::test_meshes::{cubed_sphere, sphere_patches, strip};
    use crate::surface::{Patch, Polygon, patches_from_mesh};

    /// Normals of any length and sign from those at the points.
    fn given(mesh: &Mesh, exact: impl Fn(usize, &Vec3) -> Vec3) -> Vec<[Vec3; 4]> {
        let of = |f: usize, k: usize| {
            let size = 3.0 * f64::sin((7 * f + 3 * k) as f64) + 3.1 * f64::powi(-1.0, f as i32);
            exact(f, &mesh.points[mesh.facets[f].nodes[k] as usize].into()) * size
        };
        let count = |f: usize| mesh.facets[f].count as usize;
        let corners = |f: usize| std::array::from_fn(|k| if k < count(f) { of(f, k) } else { Vec3::zeros() });
        (0..mesh.facets.len()).map(corners).collect()
    }

    fn patches(mesh: &Mesh, given: Vec<[Vec3; 4]>, feature_angle: f64, flip: bool) -> Result<Vec<Patch>> {
        let options = NormalOptions { given: Some(given), feature_angle, ..NormalOptions::default() };
        patches_from_mesh(mesh, Smoothing::Nagata, &options, flip)
    }

    #[test]
    fn exact_normals_make_the_exact_patches_also_of_open_surfaces() {
        for triangles in [false, true] {
            for faces in [1, 5, 6] {
                let mesh = cubed_sphere(4, triangles, faces);
                let exact = sphere_patches(4, triangles, faces, Smoothing::Nagata);
                let found = patches(&mesh, given(&mesh, |_, x| *x), 40.0, false).unwrap();
                for (found, exact) in found.iter().zip(&exact) {
                    assert_eq!(found.edges, exact.edges);
                    (0..4).for_each(|k| assert!((found.coefficients[k] - exact.coefficients[k]).norm() < 1e-15));
                }
                let turned = patches(&mesh, given(&mesh, |_, x| *x), 40.0, true).unwrap();
                for (turned, exact) in turned.iter().zip(&exact) {
                    let (middle, way) = (turned.center(), exact.normal(exact.center()));
                    assert!((turned.point(middle) - exact.point(middle)).norm() < 1e-15);
                    assert!((turned.normal(middle) + way).norm() < 1e-13);
                }
            }
        }
    }

    /// A half round bar that joins its flat at 90 degrees: the normals say which edges are sharp, not the facets.
    #[test]
    fn given_normals_decide_what_is_sharp() {
        let mut profile: Vec<[f64; 2]> =
            (0..=2).map(|k| std::f64::consts::FRAC_PI_2 * k as f64).map(|a| [-a.cos(), -a.sin()]).collect();
        profile.extend([[0.0, 0.0], [-1.0, 0.0]]);
        let bar = strip(&profile, 1, false);
        let round = |f: usize, x: &Vec3| if f < 2 { Vec3::new(x.x, x.y, 0.0) } else { Vec3::y() };
        let found = patches(&bar, given(&bar, round), 40.0, false).unwrap();
        let kinds: Vec<_> = found.iter().map(|patch| [patch.edges[3], patch.edges[1]]).collect();
        let (end, smooth, sharp) = (Edge::Boundary, Edge::Smooth, Edge::Sharp);
        assert_eq!(kinds, [[end, smooth], [smooth, sharp], [sharp, smooth], [smooth, end]]);
        assert!(found[2].is_facet() && found[3].is_facet() && !found[1].is_facet());
        // With a feature angle of 100 degrees all are smooth and the two sides share the mean.
        let options =
            NormalOptions { given: Some(given(&bar, round)), feature_angle: 100.0, ..NormalOptions::default() };
        let facets = Facets::new(&bar, false).unwrap();
        let (_, normals) = Normals::of_mesh(&bar, &facets, &options).unwrap();
        assert!(normals.edges.iter().flatten().all(|edge| *edge != sharp));
        let mean = Vec3::new(1.0, 1.0, 0.0).normalize();
        assert!([normals.corners[1][1], normals.corners[2][0]].iter().all(|normal| (normal - mean).norm() < 1e-15));
    }

    #[test]
    fn wrong_normals_are_refused() {
        let mesh = cubed_sphere(2, false, 1);
        let text = |given| patches(&mesh, given, 40.0, false).err().map_or(String::new(), |error| error.to_string());
        assert!(text(Vec::new()).contains("test: 4 facets, but normals for 0"));
        for bad in [Vec3::zeros(), Vec3::repeat(f64::NAN), Vec3::new(1.0, -1.0, 0.0)] {
            let mut normals = given(&mesh, |_, x| *x);
            normals[0][1] = bad;
            let text = text(normals);
            assert!(text.contains("lies in facet 101"), "{text}");
        }
    }
}

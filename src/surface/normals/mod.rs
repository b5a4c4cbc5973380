//! Nodal normals of a surface mesh, one for each corner of each facet.
//!
//! 1. Edges whose facets' normals differ by more than the feature angle are sharp, and so are those that the user says
//!    are. The facets around a node that hang together across smooth edges are a fan; a fan has one normal, the mean of
//!    its corners, (52). The default [`Weight::Sine`] is exact on spheres however irregular the mesh, and on cylinders
//!    and bodies of revolution when their facets follow the lines of curvature, however unequal. On general surfaces
//!    all weights have errors of the same order, 2 on regular meshes and 1 on irregular ones; in the mean over the surfaces
//!    of `scripts/studies/normals.py` those of the default are the least: the RMS error of the normals is 1.2 times that of
//!    the best weight for each mesh (`edge` 1.3, `angle` and `root-edge` 1.5, others 1.7 to 2.2), and the largest error
//!    of shape of the patches 1.3 times (others 2.4 to 5). A fan that is open takes the normals of whole facets, which
//!    are less one-sided than those of their corners.
//! 2. A facet is straight behind an edge when it goes on in its own plane on the side away from the edge: a
//!    quadrilateral across the opposite edge, a triangle beyond its third node in the direction normal to the edge. The
//!    neighbours of an arc across the width of its strip are coplanar too, but lie beside the edge, not behind it.
//!    - Where a straight facet meets a curved one the edge is a junction, and the fans at its ends take the normal of
//!      the straight side: only then are the flat part flat and the arc exact (Neto, Oliveira and Menezes 2017,
//!      section 5.3). On a plane that is the normal of the plane, on a cylinder that runs into a torus the mean over
//!      the cylinder. At the corner of several such parts, the part that is on the curved side of no junction decides.
//!    - Where both sides are straight the edge is a crease, and sharp.
//!    - A facet that is several times as deep as the next one across a smooth edge counts as straight, too, as the flats of
//!      CAD programs' STL files between their fillets, where its normal fits the arc by (*) far better than the mean does.
//!    - Other flats that are one facet deep cannot be told from an arc, and get mean normals.
//!    - In the middle of an S-bend of two equal arcs two facets are coplanar by chance. There the mean normals carry
//!      the curvature on much better than the facet's, see (*), and stay.
//! 3. Where a surface ends, at a boundary or sharp edge, the mean is that of one side only, off by half an edge's turn.
//!    On circles, cylinders and spheres the normals at the ends of any chord d satisfy
//!    ```text
//!        (n_v + n_u).d = 0                                                              (*)
//!    ```
//!    so the normal is chosen to satisfy (*) towards its neighbours in the fan, in the mean-square sense; what that
//!    leaves open is extrapolated linearly. Along a single edge it mirrors the neighbour's normal, n_v = n_u - 2
//!    (n_u.d) d/|d|^2. Fans along an end follow complete ones, then those at corners all others. On flat parts nothing
//!    moves.
//!
//! Normals that are known from elsewhere replace the means and rules 2 and 3. In symmetry planes the mirror image of
//! the mesh counts as there.

pub mod ends;
mod given;
pub mod groups;
mod options;
mod sharp;
mod straight;
mod symmetry;
mod weight;

use super::facets::Facets;
use super::nagata::is_inflected;
use super::piece::Edge;
use crate::Vec3;
use crate::controls::Controls;
use crate::error::Result;
use crate::mesh::Mesh;
use ends::End;
use groups::Groups;
use nalgebra::SVector;
pub use options::NormalOptions;
use sharp::SharpEdges;
pub use symmetry::Whole;
pub use weight::Weight;

/// The normals of a surface mesh.
pub struct Normals {
    /// Unit normal of each corner of each facet.
    pub corners: Vec<[Vec3; 4]>,
    pub edges: Vec<[Edge; 4]>,
}

/// Mean normals, and how they came about.
pub struct Means {
    pub normals: Normals,
    /// The corners that share a normal.
    pub fans: Groups,
    /// Whether a corner counts in the mean of its fan.
    pub counts: Vec<[bool; 4]>,
    /// How the fans at ends of the surface were extrapolated; the others have the mean.
    pub ends: Vec<Option<End>>,
}

impl Normals {
    /// The surface of `facets`, which are those of `mesh`, with nodal normals.
    ///
    /// After the facets of the mesh come images of some of them in the symmetry planes. Fails on options that do not
    /// fit the mesh.
    pub fn of_mesh(mesh: &Mesh, facets: &Facets, options: &NormalOptions) -> Result<(Facets, Self)> {
        let sharp = SharpEdges::new(mesh, facets, &options.sharp)?;
        let whole = Whole::new(mesh, facets, &options.symmetry)?;
        let is_sharp = |f: usize, k: usize| {
            let [a, b] = [k, k + 1].map(|k| whole.node_of[whole.facets.node(f, k)]);
            sharp.holds(a, b)
        };
        let feature_angle = options.feature_angle.to_radians();
        let normals = match &options.given {
            None => Means::new(&whole.facets, options.weight, feature_angle, &options.controls, is_sharp).normals,
            Some(given) => {
                let corners = whole.spread(given::sorted(mesh, facets, given)?);
                given::normals(&whole.facets, &corners, feature_angle, is_sharp)
            }
        };
        Ok((whole.facets, normals))
    }

    /// Number of edges whose normals lean the same way, so that the surface meets them in part only.
    pub fn inflected(&self, facets: &Facets) -> usize {
        let inflected = |(f, k): &(usize, usize)| {
            let (once, next) = (facets.across[*f][*k].is_none_or(|(g, _)| *f < g), facets.beside(*f, *k)[0]);
            once && is_inflected(&facets.edge(*f, *k), &self.corners[*f][*k], &self.corners[*f][next])
        };
        facets.corners().filter(inflected).count()
    }
}

impl Means {
    /// Mean normals with the rules for junctions and ends; edges that turn by more than `feature_angle` (radians) or
    /// are said to be (facet, number) are sharp.
    pub fn new(
        facets: &Facets,
        weight: Weight,
        feature_angle: f64,
        controls: &Controls,
        is_sharp: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let turns = |f: usize, k: usize| facets.turn(f, k).is_some_and(|turn| turn > feature_angle);
        let mut edges = kinds(facets, |f, k| turns(f, k) || is_sharp(f, k));
        let junctions = straight::classify(facets, &mut edges, controls);
        let fans = Groups::new(facets, |f, k| edges[f][k] == Edge::Smooth);
        let mut normals = fans.mean(facets, weight, |_| true);
        let sides = (&edges[..], &junctions[..]);
        let counts = straight::straight_sides(facets, weight, sides, &fans, &mut normals, controls);
        let ends = ends::extrapolate_ends(facets, &fans, &counts, &mut normals, feature_angle, controls);
        let normals = Normals { corners: fans.spread(facets, &normals), edges };
        Self { normals, fans, counts, ends }
    }
}

/// Kinds of all edges.
fn kinds(facets: &Facets, is_sharp: impl Fn(usize, usize) -> bool) -> Vec<[Edge; 4]> {
    let kind = |f: usize, k: usize| match facets.across[f][k] {
        None => Edge::Boundary,
        Some(_) if is_sharp(f, k) => Edge::Sharp,
        Some(_) => Edge::Smooth,
    };
    (0..facets.nodes.len()).map(|f| std::array::from_fn(|k| kind(f, k))).collect()
}

/// Two unit vectors that make a right-handed frame with the unit vector `n`.
pub fn tangents(n: &Vec3) -> [Vec3; 2] {
    let a = n.cross(&Vec3::ith(n.iamin(), 1.0)).normalize();
    [n.cross(&a), -a]
}

/// Which of two normals is the more along a direction, whichever its sign.
pub fn more_along<const D: usize>(like: &SVector<f64, D>, a: SVector<f64, D>, b: SVector<f64, D>) -> SVector<f64, D> {
    if b.dot(like).abs() > a.dot(like).abs() { b } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::surface::test_meshes::{cubed_sphere, grid, indenter, indenter_normal, strip};

    fn normals(mesh: &Mesh) -> (Facets, Normals) {
        let facets = Facets::new(mesh, false).unwrap();
        let normals =
            Means::new(&facets, Weight::default(), 40f64.to_radians(), &Controls::default(), |_, _| false).normals;
        (facets, normals)
    }

    /// Largest error of the nodal normals against `exact`.
    fn error(mesh: &Mesh, exact: impl Fn(&Vec3) -> Vec3) -> f64 {
        let (facets, normals) = normals(mesh);
        let mut worst = 0.0_f64;
        for (f, k) in facets.corners() {
            worst = worst.max((normals.corners[f][k] - exact(facets.point(f, k))).norm());
        }
        worst
    }

    /// RMS errors of all weights at the nodes inside, whose normal by `exact` is not zero.
    fn rms_errors(mesh: &Mesh, exact: impl Fn(&Vec3) -> Vec3) -> Vec<f64> {
        let facets = Facets::new(mesh, false).unwrap();
        let error = |weight: Weight| {
            let normals = Means::new(&facets, weight, 90f64.to_radians(), &Controls::default(), |_, _| false).normals;
            let errors = facets.corners().map(|(f, k)| (normals.corners[f][k], exact(facets.point(f, k))));
            let inside: Vec<f64> =
                errors.filter(|(_, n)| *n != Vec3::zeros()).map(|(m, n)| (m - n).norm_squared()).collect();
            (inside.iter().sum::<f64>() / inside.len() as f64).sqrt()
        };
        Weight::ALL.iter().map(|(_, weight)| error(*weight)).collect()
    }

    /// Only the default is exact on an irregular sphere, and it is within a quarter of the best on an irregular torus.
    #[test]
    fn the_default_weight_is_the_best() {
        let noise = |k: usize| 2.0 * (43758.5453 * (12.9898 * (k + 1) as f64).sin()).rem_euclid(1.0) - 1.0;
        let default = Weight::ALL.iter().position(|(_, weight)| *weight == Weight::default()).unwrap();
        for triangles in [false, true] {
            let mut ball = cubed_sphere(8, triangles, 6);
            for (k, p) in ball.points.iter_mut().enumerate() {
                let moved = Vec3::from(*p) + Vec3::from_fn(|axis, _| 0.025 * noise(3 * k + axis));
                *p = moved.normalize().into();
            }
            let errors = rms_errors(&ball, |x| x.normalize());
            for (k, error) in errors.iter().enumerate() {
                assert_eq!(*error < 1e-14, k == default, "{errors:?}");
            }
            let count = std::cell::Cell::new(0);
            let torus = grid(24, 12, triangles, |s, t| {
                count.set(count.get() + 2);
                let inside = |s: f64| s > 0.01 && s < 0.99;
                let amount = if inside(s) && inside(t) { 0.25 } else { 0.0 };
                let a = 4.0 * (s + amount / 24.0 * noise(count.get()));
                let b = 4.0 * (t + amount / 12.0 * noise(count.get() + 1));
                let radius = 1.0 + 0.4 * b.cos();
                [radius * a.cos(), radius * a.sin(), 0.4 * b.sin()]
            });
            let end = |x: &Vec3| {
                let ring = Vec3::new(x.x, x.y, 0.0).normalize();
                let [a, b] = [ring.y.atan2(ring.x), x.z.atan2((x - ring).dot(&ring))];
                [a, b].iter().any(|a| (a.rem_euclid(2.0 * std::f64::consts::PI) - 2.0).abs() > 1.9)
            };
            let errors = rms_errors(&torus, |x| match end(x) {
                true => Vec3::zeros(),
                false => (x - Vec3::new(x.x, x.y, 0.0).normalize()) / 0.4,
            });
            let best = errors.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(errors[default] < 1.25 * best && best > 1e-3, "{errors:?}");
        }
    }

    #[test]
    fn frames_are_orthonormal() {
        for n in [Vec3::x(), Vec3::y(), -Vec3::z(), Vec3::new(1.0, -2.0, 3.0).normalize()] {
            let [a, b] = tangents(&n);
            assert!((a.cross(&b) - n).norm() < 1e-15 && a.dot(&b).abs() < 1e-15);
        }
    }

    #[test]
    fn the_indenter_has_exact_normals_everywhere() {
        for across in [1, 2, 3] {
            for triangles in [false, true] {
                let mesh = indenter(across, triangles);
                assert!(error(&mesh, indenter_normal) < 1e-12, "{across} across, triangles: {triangles}");
                let (facets, normals) = normals(&mesh);
                assert_eq!(normals.inflected(&facets), 0);
                assert!(normals.edges.iter().flatten().all(|e| *e != Edge::Sharp));
            }
        }
    }

    /// A half circle alone: the ends are extrapolated.
    #[test]
    fn arcs_are_exact_up_to_their_open_ends() {
        for (across, triangles) in [(1, false), (2, false), (1, true), (2, true), (3, true)] {
            let mesh = grid(6, across, triangles, |s, t| {
                let a = std::f64::consts::PI * s;
                [-a.cos(), a.sin(), -2.0 * t]
            });
            let exact = |x: &Vec3| Vec3::new(x.x, x.y, 0.0);
            assert!(error(&mesh, exact) < 1e-12, "{across} across, triangles: {triangles}");
        }
    }

    #[test]
    fn balls_are_exact_and_the_ends_of_caps_nearly_so() {
        for triangles in [false, true] {
            assert!(error(&cubed_sphere(5, triangles, 6), |x| x.normalize()) < 1e-14);
            let [coarse, fine] = [6, 12].map(|n| error(&cubed_sphere(n, triangles, 1), |x| x.normalize()));
            assert!(coarse < 0.04 && fine < coarse / 3.5, "triangles: {triangles}, {coarse} {fine}");
        }
    }

    /// Facets whose sizes vary by 1 to 3.
    #[test]
    fn unequal_facets_do_not_tilt_the_normals_of_an_arc() {
        for (across, triangles) in [(1, false), (2, false), (1, true), (2, true)] {
            let mesh = grid(8, across, triangles, |s, t| {
                let a = 2.0 * (s + 0.5 * s * s);
                [-a.cos(), a.sin(), -2.0 * (t + t * t)]
            });
            assert!(error(&mesh, |x| Vec3::new(x.x, x.y, 0.0)) < 1e-12, "{across} across, triangles: {triangles}");
        }
    }

    /// Two flats and an arc of one facet only: each flat keeps its normal.
    #[test]
    fn one_facet_turns_between_two_flats() {
        let profile: Vec<[f64; 2]> = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 1.0], [3.0, 2.0], [3.0, 3.0]];
        for triangles in [false, true] {
            let facets = Facets::new(&strip(&profile, 2, triangles), false).unwrap();
            let normals =
                Means::new(&facets, Weight::default(), 50f64.to_radians(), &Controls::default(), |_, _| false).normals;
            for (f, k) in facets.corners() {
                let exact = if facets.point(f, k).x > 2.5 { Vec3::x() } else { -Vec3::y() };
                assert!((normals.corners[f][k] - exact).norm() < 1e-14);
            }
        }
    }

    /// Flats of one facet between fillets, as CAD programs write them, are flat, and the fillets round; an arc of unequal facets has no
    /// flats.
    #[test]
    fn deep_flats_are_flat() {
        for triangles in [false, true] {
            let (steps, quarter) = (6, std::f64::consts::FRAC_PI_2);
            let fillet = |k: usize| {
                let turn = quarter * k as f64 / steps as f64;
                [2.0 * turn.sin(), 2.0 - 2.0 * turn.cos()]
            };
            let mut profile = vec![[-6.0, 0.0]];
            profile.extend((0..=steps).map(fillet));
            profile.push([2.0, 9.0]);
            let (facets, normals) = normals(&strip(&profile, 1, triangles));
            for (f, k) in facets.corners() {
                let x = facets.point(f, k);
                let exact = Vec3::new(x.x.max(0.0) / 2.0, x.y.min(2.0) / 2.0 - 1.0, 0.0);
                assert!((normals.corners[f][k] - exact).norm() < 1e-12, "{triangles}: {x}");
            }
        }
        let places = [0.0, 0.05, 0.1, 0.5, 0.6, 1.0, 1.05];
        let arc: Vec<[f64; 2]> = places.iter().map(|a: &f64| [a.sin(), -a.cos()]).collect();
        let (facets, normals) = normals(&strip(&arc, 1, false));
        for (f, k) in facets.corners() {
            let x = facets.point(f, k);
            assert!((normals.corners[f][k] - Vec3::new(x.x, x.y, 0.0)).norm() < 1e-12, "{x}");
        }
    }

    /// Two equal arcs that meet without a straight part: the two coplanar facets in the middle are not flat, and only
    /// the node between them has no good mean (with triangles it spoils the ends next to it).
    #[test]
    fn an_s_bend_is_not_flat() {
        for (across, triangles) in [(1, false), (2, false), (2, true)] {
            let (steps, turn) = (6, 0.2_f64);
            let mut profile = vec![[0.0, 0.0]];
            for k in 0..2 * steps {
                let slope = if k < steps { k as f64 + 0.5 } else { (2 * steps - k) as f64 - 0.5 };
                let [x, y] = profile[profile.len() - 1];
                profile.push([x + f64::cos(turn * slope), y + f64::sin(turn * slope)]);
            }
            let (facets, normals) = normals(&strip(&profile, across, triangles));
            for (f, k) in facets.corners() {
                let node = profile.iter().position(|p| (p[0] - facets.point(f, k).x).abs() < 1e-9).unwrap();
                let slope = turn * node.min(2 * steps - node) as f64;
                let exact = Vec3::new(slope.sin(), -slope.cos(), 0.0);
                assert!(
                    node.abs_diff(steps) <= triangles as usize || (normals.corners[f][k] - exact).norm() < 1e-12,
                    "{node}: {across}, {triangles}"
                );
            }
        }
    }

    /// A cylinder that runs into the fillet of a torus, all quadrilaterals: the wall keeps radial normals.
    #[test]
    fn a_cylinder_is_the_straight_side_of_a_torus() {
        let mesh = grid(8, 8, false, |s, t| {
            let (turn, up) = (std::f64::consts::FRAC_PI_2 * s, 8.0 * t);
            let (radius, height) = if up <= 4.0 {
                (10.0, up)
            } else {
                let a = (up - 4.0) / 4.0 * std::f64::consts::FRAC_PI_2;
                (5.0 + 5.0 * a.cos(), 4.0 + 5.0 * a.sin())
            };
            [radius * turn.cos(), radius * turn.sin(), height]
        });
        let (facets, normals) = normals(&mesh);
        let mut seen = 0;
        for (f, k) in facets.corners() {
            let x = facets.point(f, k);
            if x.z < 4.0 + 1e-9 {
                let exact = Vec3::new(x.x, x.y, 0.0) / 10.0;
                assert!((normals.corners[f][k] - exact).norm() < 1e-12, "{x}");
                seen += 1;
            }
        }
        assert!(seen > 100);
    }

    /// A half round bar: the sharp edges between its flat and its arc leave both exact.
    #[test]
    fn sharp_edges_are_ends() {
        let mut profile: Vec<[f64; 2]> =
            (0..=8).map(|k| std::f64::consts::PI * k as f64 / 8.0).map(|a| [-a.cos(), -a.sin()]).collect();
        profile.extend([[0.5, 0.0], [0.0, 0.0], [-0.5, 0.0], [-1.0, 0.0]]);
        let (facets, normals) = normals(&strip(&profile, 1, false));
        assert_eq!(normals.edges.iter().flatten().filter(|e| **e == Edge::Sharp).count(), 2);
        for (f, k) in facets.corners() {
            let x = facets.point(f, k);
            let exact = if f < 8 { Vec3::new(x.x, x.y, 0.0) } else { Vec3::y() };
            assert!((normals.corners[f][k] - exact).norm() < 1e-12);
        }
    }

    #[test]
    fn two_flats_at_a_small_angle_are_a_crease() {
        let profile = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.2], [4.0, 0.4]];
        for triangles in [false, true] {
            let (_, normals) = normals(&strip(&profile, 2, triangles));
            assert_eq!(normals.edges.iter().flatten().filter(|e| **e == Edge::Sharp).count(), 4);
        }
    }
}

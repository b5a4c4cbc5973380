use super::*;
use crate::solid::testing::Random;
use crate::surface::Smoothing;
use crate::surface::normals::NormalOptions;
use crate::surface::patches_from_mesh;
use crate::surface::projection::tests::check_derivatives;
use crate::surface::test_meshes::{
    cubed_sphere, grid, indenter, indenter_normal, mesh_of, patch, sphere_patches, strip,
};
use proptest::prelude::*;

fn set(mesh: &crate::mesh::Mesh, smoothing: Smoothing) -> PatchSet {
    PatchSet::new(patches_from_mesh(mesh, smoothing, &NormalOptions::default(), false).unwrap())
}

/// The unit cube without its bottom, facets of 1/2 (or triangles); solid inside.
fn cube(triangles: bool) -> PatchSet {
    let mesh = cubed_sphere(2, triangles, 5);
    let boxed = mesh.points.iter().map(|p| p.map(|x| x / p.iter().fold(0.0, |m: f64, x| m.max(x.abs()))));
    set(&crate::mesh::Mesh { points: boxed.collect(), ..mesh.clone() }, Smoothing::Facet)
}

fn project(set: &PatchSet, x: [f64; 3]) -> Projection {
    set.closest(&Vec3::from(x), 10.0, None).unwrap()
}

#[test]
fn faces_edges_and_corners_of_a_cube() {
    for triangles in [false, true] {
        // The bottom face x 0..4 of the frames is one of the five; the missing one is -y.
        let cube = cube(triangles);
        let p = project(&cube, [0.3, 0.4, 1.5]);
        assert!((p.gap - 0.5).abs() < 1e-15 && (p.normal - Vec3::z()).norm() < 1e-15);
        let p = project(&cube, [0.3, 1.3, 1.4]);
        assert!((p.gap - 0.5).abs() < 1e-15 && (p.normal - Vec3::new(0.0, 0.6, 0.8)).norm() < 1e-14);
        let p = project(&cube, [1.2, 1.2, 1.1]);
        assert!((p.gap - 0.3).abs() < 1e-14 && (p.point - Vec3::repeat(1.0)).norm() < 1e-15);
        // Inside, the nearest face, up to the edge.
        let p = project(&cube, [0.3, 0.95, 0.9]);
        assert!((p.gap + 0.05).abs() < 1e-15 && (p.normal - Vec3::y()).norm() < 1e-15);
        let p = project(&cube, [0.3, 1.0, 1.0]);
        assert!(p.gap.abs() < 1e-15 && (p.normal.norm() - 1.0).abs() < 1e-14);
        for x in [[0.3, 1.3, 1.4], [1.2, 1.2, 1.1], [0.21, 0.32, 0.9], [0.4, 0.6, 1.4]] {
            check_derivatives(&Vec3::from(x), |x| cube.closest(x, 10.0, None));
        }
        // Beyond the open side, by less and by more than the extension of the facets.
        assert!(cube.closest(&Vec3::new(0.3, -1.02, 1.2), 10.0, None).is_some());
        assert!(cube.closest(&Vec3::new(0.3, -1.06, 1.2), 10.0, None).is_none());
        assert!(cube.closest(&Vec3::new(1.3, -1.02, 1.4), 10.0, None).is_some());
        assert!(cube.closest(&Vec3::new(1.3, -1.06, 1.4), 10.0, None).is_none());
        assert!(cube.closest(&Vec3::new(0.3, 0.4, 1.5), 0.4, None).is_none());
        assert!(cube.closest(&Vec3::new(f64::NAN, 0.4, 1.5), 0.4, None).is_none());
    }
}

/// The arcs that facets of a sphere and of a pipe stand for are as far from them as they say, within what facets of one size differ.
#[test]
fn facets_know_how_far_they_are_off_their_arcs() {
    for triangles in [false, true] {
        let ball = PatchSet::new(sphere_patches(6, triangles, 6, Smoothing::Facet));
        let points = cubed_sphere(3, false, 6).points;
        let [mut known, mut off] = [0.0; 2];
        for x in points.iter().map(|p| Vec3::from(*p) + Vec3::new(0.011, 0.023, 0.017)) {
            let at = ball.closest(&x, 1.0, None).unwrap();
            known += ball.off_chord(&at, 50.0);
            off += 1.0 - at.point.norm();
        }
        println!("triangles {triangles}: {known:.4e}, {off:.4e}");
        assert!((known / off - 1.0).abs() < 0.05);
        // Edges are none of an arc.
        let cube = cube(triangles);
        assert_eq!(cube.off_chord(&project(&cube, [0.3, 0.45, 1.5]), 50.0), 0.0);
    }
}

/// Beside an edge the side that x is farthest from counts, extended; the gap goes on continuously where the sides change.
#[test]
fn the_sides_of_an_edge_reach_beyond_it() {
    let cube = cube(false);
    let beside = |x: [f64; 3]| cube.beside_edge(&Vec3::from(x), &project(&cube, x), 0.5);
    let p = beside([0.3, 1.01, 1.02]).unwrap();
    assert!((p.gap - 0.02).abs() < 1e-15 && (p.normal - Vec3::z()).norm() < 1e-14);
    assert!((p.point - Vec3::new(0.3, 1.01, 1.0)).norm() < 1e-14);
    let p = beside([1.01, 1.03, 1.02]).unwrap();
    assert!((p.gap - 0.03).abs() < 1e-15 && (p.normal - Vec3::y()).norm() < 1e-14);
    assert!(beside([0.3, 0.9, 1.02]).is_none(), "above a side");
    assert!(beside([0.3, 0.99, 0.98]).is_none(), "inside");
    assert!(beside([0.3, 1.6, 1.6]).is_none(), "beyond the extension");
    check_derivatives(&Vec3::new(0.3, 1.01, 1.02), |x| cube.beside_edge(x, &cube.closest(x, 1.0, None).unwrap(), 0.5));
}

/// A point that is as far from several facets as from one: over and under a ridge, over a valley, and in a corner. Facets that meet
/// more sharply are one surface no longer.
#[test]
fn exactly_between_pieces() {
    let question =
        Even { turn: 0.1, outward: Vec3::zeros(), reach: 1.0, extension: Some(0.5), kept: None, planar: false };
    let even = |set: &PatchSet, x: [f64; 3]| -> Vec<(f64, f64)> {
        let x = Vec3::from(x);
        let at = set.closest(&x, 1.0, None).unwrap();
        let at = set.beside_edge(&x, &at, 0.5).unwrap_or(at);
        set.evenly(&x, &at, &question).iter().map(|(p, angle)| (p.gap, *angle)).collect()
    };
    let roof = |slope: f64| set(&grid(2, 2, false, |s, t| [s - 0.5, t, -slope * (s - 0.5).abs()]), Smoothing::Facet);
    for slope in [0.2, -0.2] {
        let roof = roof(slope);
        let steep = (1.0 + slope * slope).sqrt();
        for z in [-1e-3, 0.0, 1e-12, 1e-3] {
            let of = even(&roof, [0.0, 0.3, z]);
            assert!(of.len() == 2 && of.iter().all(|(gap, _)| (gap - z / steep).abs() < 1e-15), "{z}: {of:?}");
            assert_eq!(of[0].1, of[1].1, "{of:?}");
            // Four in the corner.
            assert_eq!(even(&roof, [0.0, 0.5, z]).len(), 4, "{z}");
            // One at most beside the ridge and elsewhere, and where the surface ends.
            let beside = even(&roof, [1e-3, 0.3, z]);
            assert!(beside.len() < 2, "{z}: {beside:?}");
            assert_eq!(even(&roof, [0.25, 0.0, z]).len(), 1);
            assert!(even(&roof, [0.25, 0.3, z]).len() < 2);
        }
    }
    for z in [-1e-3, 0.0, 1e-3] {
        assert!(even(&roof(0.3), [0.0, 0.3, z]).len() < 2, "{z}");
    }
    // Deep under the ridge its feet are far from the edge.
    assert_eq!(even(&roof(0.2), [0.0, 0.3, -0.4]).len(), 2);
    // What keeps to two pieces is between these beyond their ends, too, and not beside them.
    let (ridge, x) = (roof(0.2), Vec3::new(0.0, 0.51, -1e-3));
    let question = Even { kept: Some(&[0, 1]), ..question };
    let kept = |x: Vec3| {
        let (gap, normal) = ((x.z - 0.2 * x.x) / 1.04f64.sqrt(), ridge.get(0).unwrap().normal([1.0, 1.0]));
        let point = x - normal * gap;
        ridge.evenly(&x, &Projection { gap, point, normal, xi: [1.0, 1.0], ..Projection::default() }, &question).len()
    };
    assert_eq!((kept(x), kept(x + Vec3::x() * 1e-3)), (2, 0));
    // Six corners of triangles, by their angles.
    let flat = set(&grid(2, 2, true, |s, t| [s, t, 0.0]), Smoothing::Facet);
    let around = even(&flat, [0.5, 0.5, 1e-3]);
    assert_eq!(around.len(), 6);
    assert!((around.iter().map(|(_, angle)| angle).sum::<f64>() - 2.0 * std::f64::consts::PI).abs() < 1e-12);
    // The kinks between smooth patches count, too.
    let bulge = |s: f64, t: f64| 0.1 * (s - s * s) + 0.2 * (t - t * t) * (1.0 + s);
    let smooth = set(&grid(3, 3, false, |s, t| [s, t, bulge(s, t)]), Smoothing::Nagata);
    let edge = smooth.get(4).unwrap().point([0.5, 0.0]);
    assert_eq!(even(&smooth, edge.into()).len(), 2);
}

/// A blade of 20 degrees: the point is behind the plane of one side and yet outside.
#[test]
fn outside_an_acute_edge_is_outside() {
    let a = 10f64.to_radians();
    let profile = [[-a.cos(), a.sin()], [0.0, 0.0], [-a.cos(), -a.sin()]].map(|[x, y]| [x, -y]);
    let blade = set(&strip(&profile, 1, false), Smoothing::Facet);
    for x in [[0.1, 0.09, 0.5], [0.1, -0.09, 0.5], [0.1, 0.0, 0.5]] {
        let p = project(&blade, x);
        assert!((p.gap - Vec3::new(x[0], x[1], 0.0).norm()).abs() < 1e-14, "{p:?}");
    }
    let p = project(&blade, [-0.5, 0.01, 0.5]);
    assert!(p.gap < 0.0 && p.normal.y > 0.0);
}

#[test]
fn concave_corners_take_the_nearer_wall_and_their_edge_from_behind() {
    let corner = set(&strip(&[[1.0, 0.0], [0.0, 0.0], [0.0, 1.0]], 2, false), Smoothing::Facet);
    let p = project(&corner, [0.1, 0.3, 0.2]);
    assert!((p.gap - 0.1).abs() < 1e-15 && (p.normal - Vec3::x()).norm() < 1e-14, "{p:?}");
    let p = project(&corner, [-0.3, -0.4, 0.2]);
    assert!((p.gap + 0.5).abs() < 1e-15 && (p.normal - Vec3::new(0.6, 0.8, 0.0)).norm() < 1e-14);
    check_derivatives(&Vec3::new(-0.3, -0.4, 0.2), |x| corner.closest(x, 10.0, None));
}

#[test]
fn beyond_the_end_of_a_strip_there_is_nothing() {
    for (smoothing, triangles) in
        [(Smoothing::Facet, false), (Smoothing::Nagata, false), (Smoothing::Facet, true), (Smoothing::Nagata, true)]
    {
        let tool = set(&indenter(2, triangles), smoothing);
        for y in [-0.5, 0.2] {
            for x in [-9.0, 0.0, 3.3] {
                assert!(tool.closest(&Vec3::new(x, y, 1.52), 5.0, None).is_some());
                assert!(tool.closest(&Vec3::new(x, y, 1.7), 5.0, None).is_none(), "{smoothing:?} {triangles} {x} {y}");
                assert!(tool.closest(&Vec3::new(x, y, -0.8), 5.0, None).is_none());
            }
        }
        let fillet = Vec3::new(18.0, 1.0, 1.8);
        assert!(tool.closest(&fillet, 5.0, None).is_none());
    }
}

/// Beside a corner of a flat surface, where facets meet along a diagonal, the surface ends as elsewhere: a point counts as over it by
/// as much as facets are extended, with the normal that all have.
#[test]
fn at_the_corners_of_a_flat_surface_its_ends_are_as_elsewhere() {
    for (smoothing, triangles) in
        [(Smoothing::Facet, false), (Smoothing::Nagata, false), (Smoothing::Facet, true), (Smoothing::Nagata, true)]
    {
        for turned in [false, true] {
            let flat = |s: f64, t: f64| if turned { [3.0 * t, 3.0 - 3.0 * s, 0.0] } else { [3.0 * s, 3.0 * t, 0.0] };
            let table = set(&grid(3, 3, triangles, flat), smoothing);
            for past in [-0.02, 0.0, 0.03, 0.048, 0.053, 0.07, 0.08, 0.095, 0.11, 0.2] {
                for beside in [0.0, 1e-12, -1e-12, 0.003, 0.04, -0.02] {
                    for height in [-0.02, -1e-9, 0.0, 1e-9, 0.02] {
                        let (far, near) = ([3.0 + past, -past], [beside, 3.0 - beside]);
                        for [a, b] in far.into_iter().flat_map(|a| near.map(|b| [a, b])) {
                            for x in [[a, b, height], [b, a, height]] {
                                let found = table.closest(&Vec3::from(x), 5.0, None);
                                // The extension of an acute corner ends in a tip.
                                let counts = if past < 0.05 { Some(true) } else { (past > 0.1).then_some(false) };
                                let is_there = found.is_some();
                                assert!(
                                    counts.is_none_or(|counts| is_there == counts),
                                    "{smoothing:?} {triangles} {x:?}"
                                );
                                let is_flat = |p: Projection| (p.normal - Vec3::z()).norm() < 1e-9 && p.gap == height;
                                assert!(
                                    found.is_none_or(is_flat),
                                    "{smoothing:?} {triangles} {turned} {x:?} {found:?}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Past the near wall's end, the far wall is what is left; inside a thin tool it never is.
#[test]
fn a_farther_wall_counts_only_past_the_end_of_the_nearer() {
    let near = grid(3, 1, false, |s, t| [3.0 * s, t, 0.0]);
    let far = grid(6, 1, false, |s, t| [6.0 * s, 1.0 - t, -0.4]);
    let mut points = near.points.clone();
    points.extend(&far.points);
    let shifted = far.facets.iter().map(|f| f.nodes.map(|n| n + near.points.len() as u32));
    let all: Vec<[u32; 4]> = near.facets.iter().map(|f| f.nodes).chain(shifted).collect();
    let tool = set(&mesh_of(points, &all.iter().map(|q| &q[..]).collect::<Vec<_>>()), Smoothing::Facet);
    assert!((project(&tool, [1.5, 0.5, -0.15]).gap + 0.15).abs() < 1e-15);
    assert!((project(&tool, [1.5, 0.5, -0.25]).gap + 0.15).abs() < 1e-15);
    assert!((project(&tool, [3.5, 0.5, -0.1]).gap + 0.3).abs() < 1e-15);
}

#[test]
fn the_indenter_is_exact_to_the_error_of_its_arcs() {
    let tool = set(&indenter(1, false), Smoothing::Nagata);
    let (mut worst, mut turn) = (0.0_f64, 0.0_f64);
    for k in 0..4000 {
        let s = k as f64 / 4000.0;
        let exact = Vec3::new(-20.0, 30.0 - 60.0 * s.min(0.25), 0.5);
        let arc = std::f64::consts::FRAC_PI_2 * ((s - 0.5) * 4.0).clamp(0.0, 1.0);
        let on = if s < 0.5 {
            Vec3::new(-20.0, exact.y.max(10.0), 0.5)
        } else {
            Vec3::new(-10.0 - 10.0 * arc.cos(), 10.0 - 10.0 * arc.sin(), 0.5)
        };
        let normal = indenter_normal(&on);
        let p = tool.closest(&(on + normal * 1e-3), 5.0, None).unwrap();
        worst = worst.max((p.gap - 1e-3).abs());
        turn = turn.max((p.normal - normal).norm());
    }
    assert!((worst - 1.8822e-3).abs() < 1e-6, "{worst}");
    assert!((turn.to_degrees() - 0.08455).abs() < 1e-4, "{}", turn.to_degrees());
}

#[test]
fn derivatives_through_a_whole_surface() {
    for (triangles, smoothing) in
        [(false, Smoothing::Nagata), (true, Smoothing::Nagata), (false, Smoothing::Facet), (true, Smoothing::Facet)]
    {
        let sphere = PatchSet::new(sphere_patches(4, triangles, 6, smoothing));
        for x in [[0.31, 0.22, 1.1], [0.5, 0.61, 0.43], [-0.3, -0.9, 0.41], [0.1, 1.2, 0.83]] {
            check_derivatives(&Vec3::from(x), |x| sphere.closest(x, 10.0, None));
        }
    }
}

/// Along paths over edges and corners the gap changes no faster than the point moves.
#[test]
fn the_gap_is_continuous() {
    let sets = [
        (cube(false), 1.0, 0.0),
        (cube(true), 1.0, 0.0),
        (PatchSet::new(sphere_patches(4, false, 6, Smoothing::Nagata)), 1.02, 0.03),
        (PatchSet::new(sphere_patches(4, true, 6, Smoothing::Nagata)), 0.98, 0.06),
        (PatchSet::new(sphere_patches(4, false, 6, Smoothing::Facet)), 1.02, 0.0),
    ];
    for (set, radius, kink) in &sets {
        let at = |k: usize| {
            let a = k as f64 * 1e-4;
            Vec3::new(a.sin() * (3.0 * a).cos(), 0.7 * (2.0 * a).sin() + 0.2, a.cos()).normalize() * *radius
        };
        let (mut last, mut warm) = (project(set, at(0).into()), None);
        for k in 1..10000 {
            let x = at(k);
            let p = set.closest(&x, 10.0, warm).unwrap();
            let step = (x - at(k - 1)).norm();
            assert!((p.gap - last.gap).abs() <= step * (1.0 + 1e-9) + 2e-5, "step {k}: {} {}", p.gap, last.gap);
            if *kink > 0.0 {
                assert!((p.normal - last.normal).norm() < *kink);
            }
            (last, warm) = (p, Some((p.patch, p.xi)));
        }
    }
}

#[test]
fn nothing_depends_on_the_order_or_on_patches_out_of_reach() {
    let mut patches = sphere_patches(4, true, 6, Smoothing::Nagata);
    let set = PatchSet::new(patches.clone());
    patches.reverse();
    let reversed = PatchSet::new(patches.clone());
    for k in 0..500 {
        let a = k as f64;
        let x = Vec3::new(a.sin(), (1.7 * a).cos(), (0.3 * a).sin()) * 0.9;
        let p = set.closest(&x, 0.3, None);
        assert_eq!(p, reversed.closest(&x, 0.3, None));
        let near: Vec<Patch> =
            set.within(&x.add_scalar(-0.3), &x.add_scalar(0.3)).iter().map(|k| set.patches()[*k as usize]).collect();
        assert_eq!(p, PatchSet::new(near).closest(&x, 0.3, None));
        if let Some(p) = p {
            let again = set.closest(&x, 0.3, Some((p.patch, p.xi))).unwrap();
            assert_eq!(again.patch, p.patch);
            assert!((again.point - p.point).norm() < 1e-12);
        }
    }
    // Nodes and edges, where many patches are equally close.
    for patch in set.patches().iter().step_by(7) {
        for xi in [[0.0, 0.0], [1.0, 0.5], [0.5, 0.5]] {
            let x = patch.point(xi) * 1.05;
            assert_eq!(set.closest(&x, 0.3, None), reversed.closest(&x, 0.3, None));
        }
    }
}

/// The same surface in nanometres and in gigametres.
#[test]
fn units_do_not_matter() {
    let mesh = indenter(2, true);
    for x in
        [[1.0, -0.3, 0.2], [18.0, 1.5, 0.3], [-17.2, 2.8, 1.51], [5.0, -0.1, 1.7], [15.0, 3.0, 0.7]].map(Vec3::from)
    {
        let plain = set(&mesh, Smoothing::Nagata).closest(&x, 9.0, None);
        for unit in [1e-9, 1e9] {
            let points = mesh.points.iter().map(|p| p.map(|x| x * unit)).collect();
            let scaled = set(&crate::mesh::Mesh { points, ..mesh.clone() }, Smoothing::Nagata);
            let p = scaled.closest(&(x * unit), 9.0 * unit, None);
            assert_eq!(p.map(|p| p.patch), plain.map(|p| p.patch), "{x} {p:?} {plain:?}");
            if let (Some(p), Some(plain)) = (p, plain) {
                assert!((p.gap / unit - plain.gap).abs() < 1e-12 && (p.normal - plain.normal).norm() < 1e-12);
                assert!((p.normal_gradient * unit - plain.normal_gradient).norm() < 1e-10);
            }
        }
    }
}

/// A half round bar: the sharp edges of a smoothed surface are edges, its arcs are round.
#[test]
fn sharp_edges_of_smooth_surfaces() {
    let round = (0..=8).map(|k| std::f64::consts::PI * k as f64 / 8.0).map(|a| [-a.cos(), -a.sin()]);
    let profile: Vec<[f64; 2]> = round.chain([[0.5, 0.0], [0.0, 0.0], [-0.5, 0.0]]).collect();
    let bar = set(&strip(&profile, 1, false), Smoothing::Nagata);
    let p = project(&bar, [1.03, 0.04, 0.5]);
    assert!((p.gap - 0.05).abs() < 1e-12 && (p.normal - Vec3::new(0.6, 0.8, 0.0)).norm() < 1e-10);
    check_derivatives(&Vec3::new(1.03, 0.04, 0.5), |x| bar.closest(x, 1.0, None));
    let p = project(&bar, [0.9, -0.02, 0.5]);
    assert!((p.gap + 0.02).abs() < 1e-12 && (p.normal - Vec3::y()).norm() < 1e-12);
    assert!((project(&bar, [0.0, -1.2, 0.5]).gap - 0.2).abs() < 1e-12);
}

#[test]
fn the_last_patch_is_kept_in_a_tie() {
    let cube = cube(false);
    let x = Vec3::new(0.3, 0.9, 0.9);
    let free = cube.closest(&x, 1.0, None).unwrap();
    let other =
        cube.patches().iter().map(|p| p.id).find(|id| {
            *id != free.patch && cube.closest(&x, 1.0, Some((*id, [0.5, 0.5]))).is_some_and(|p| p.patch == *id)
        });
    let other = other.unwrap();
    let nearer = cube.closest(&(x + free.normal * 1e-8), 1.0, Some((other, [0.5, 0.5]))).unwrap();
    assert_eq!(nearer.patch, other);
    let nearer = cube.closest(&(x + free.normal * 1e-5), 1.0, Some((other, [0.5, 0.5]))).unwrap();
    assert_eq!(nearer.patch, free.patch);
}

/// The study of blind spots: the share of points over a 4 by 4 cap of the unit sphere, in a plane at z, without a foot.
#[test]
fn blind_spots_of_a_cap() {
    let [facets, nagata] = [Smoothing::Facet, Smoothing::Nagata].map(|s| PatchSet::new(sphere_patches(4, false, 1, s)));
    let study = [
        (1.02, [28.570, 0.662, f64::NAN]),
        (1.1, [34.495, 1.845, 0.0]),
        (1.3, [53.427, 1.634, f64::NAN]),
        (1.6, [75.289, 2.552, 0.0574]),
    ];
    for (z, expected) in study {
        let (mut blind, mut all) = ([0; 3], 0);
        // A quarter of a grid of 301 by 301 points.
        for k in 0..151 * 151 {
            let (i, j) = (k % 151, k / 151);
            let weight = [i, j].iter().map(|k| if *k == 0 { 1 } else { 2 }).product::<usize>();
            let x = Vec3::new(i as f64 * 0.006, j as f64 * 0.006, z);
            all += weight;
            for (case, (set, extension)) in [(&facets, 0.0), (&nagata, 0.0), (&nagata, 0.01)].iter().enumerate() {
                if expected[case].is_finite() && set.normal_projection(&x, *extension, 2.0).is_none() {
                    blind[case] += weight;
                }
            }
        }
        for (blind, expected) in blind.iter().zip(expected).filter(|(_, e)| e.is_finite()) {
            let share = 100.0 * *blind as f64 / all as f64;
            assert!((share - expected).abs() < 0.1, "z = {z}: {share} instead of {expected}");
        }
    }
}

#[test]
fn the_nearest_point_includes_ends_and_edges() {
    for triangles in [false, true] {
        let cube = cube(triangles);
        let nearest = |x: [f64; 3]| cube.nearest(&Vec3::from(x)).unwrap();
        let p = nearest([0.3, -5.0, 1.2]);
        let out = Vec3::new(0.0, -4.0, 0.2);
        assert!((p.gap - out.norm()).abs() < 1e-14 && (p.normal - out.normalize()).norm() < 1e-14, "{p:?}");
        let p = nearest([0.3, -1.5, 0.9]);
        assert!((p.gap + 0.26f64.sqrt()).abs() < 1e-14 && (p.point - Vec3::new(0.3, -1.0, 1.0)).norm() < 1e-14);
        let p = nearest([0.3, 0.4, 1e5]);
        assert!((p.gap - 99999.0).abs() < 1e-10 && (p.normal - Vec3::z()).norm() < 1e-12);
        let p = nearest([0.5, 0.5, 1.2]);
        assert!((p.gap - 0.2).abs() < 1e-15 && p.normal_gradient.norm() < 1e-14);
        assert!(cube.nearest_within(&Vec3::new(0.3, -5.0, 1.2), 4.0).is_none());
        for x in [[0.3, -5.0, 1.2], [0.3, -1.5, 0.9], [3.0, -3.0, 3.0], [0.3, 0.7, 2.0]] {
            check_derivatives(&Vec3::from(x), |x| cube.nearest(x));
        }
    }
    assert!(PatchSet::default().nearest(&Vec3::zeros()).is_none());
}

/// A patch around the corners of a square, a narrow one where it is squeezed, with normals that lean out by up to 63 degrees.
fn leaning(nodes: [[f64; 3]; 4], lean: f64, squeeze: f64, triangle: bool, unit: f64) -> Patch {
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let node = |k: usize| {
        let [a, b, c] = nodes[k];
        Vec3::new(square[k][0] + 0.4 * a, (square[k][1] + 0.4 * b) * squeeze, 0.3 * c) * unit
    };
    let normal = |k: usize| Vec3::new(square[k][0] * lean + nodes[k][1], square[k][1] * lean, 1.0).normalize();
    let count = if triangle { 3 } else { 4 };
    let nodes: Vec<Vec3> = (0..count).map(node).collect();
    let normals: Vec<Vec3> = (0..count).map(normal).collect();
    patch(&nodes, &normals)
}

fn by_how_much_a_sample_is_closer(patch: &Patch, x: &Vec3) -> f64 {
    let nearest = PatchSet::new(vec![*patch]).nearest(x).unwrap();
    assert!((nearest.point + nearest.normal * nearest.gap - x).norm() <= 1e-9 * x.norm());
    let distance = |k: usize| {
        let (s, t) = ((k % 100) as f64 / 99.0, (k / 100) as f64 / 99.0);
        (x - patch.point(if patch.count == 3 { [s, s * t] } else { [s, t] })).norm()
    };
    nearest.gap.abs() - (0..10_000).map(distance).fold(f64::INFINITY, f64::min)
}

/// Minima along two edges differ by 3e-4 of the distance; the lower one is 3 % of its edge away from a corner.
#[test]
fn of_the_minima_along_the_edges_of_a_narrow_patch_the_least_is_found() {
    let nodes = [
        [0.0, -0.8454575275375308, 0.0],
        [-0.19741531055612754, -0.9788277587858056, 0.07182926556327887],
        [0.8227203186613601, -0.923547463390104, 0.22498344986962532],
        [0.0; 3],
    ];
    let patch = leaning(nodes, 0.48039109402914393, 0.01, true, 1.0);
    let x = Vec3::new(1.173232554353389, 0.7731882298176167, -0.2016642622732275);
    assert!(by_how_much_a_sample_is_closer(&patch, &x) <= 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn no_sample_of_any_patch_is_closer(
        nodes in [[-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], [-1.0..1.0, -1.0..1.0, -1.0..1.0],
            [-1.0..1.0, -1.0..1.0, -1.0..1.0], [-1.0..1.0, -1.0..1.0, -1.0..1.0]],
        lean in 0.0..2.0_f64,
        squeeze in prop_oneof![Just(1.0), Just(1e-2)],
        unit in prop_oneof![Just(1.0), Just(1e-9), Just(1e9)],
        triangle in any::<bool>(),
        x in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0],
    ) {
        let (patch, x) = (leaning(nodes, lean, squeeze, triangle, unit), Vec3::from(x) * unit);
        let worst = by_how_much_a_sample_is_closer(&patch, &x);
        prop_assert!(worst <= 1e-6 * unit, "{worst}");
    }

    #[test]
    fn no_sample_of_a_crumpled_ball_is_closer(
        x in [-1.8..1.8_f64, -1.8..1.8, -1.8..1.8],
        seed in 0..1000u32,
        triangles in any::<bool>(),
        smooth in any::<bool>(),
    ) {
        let mut mesh = cubed_sphere(2, triangles, 6);
        for (k, p) in mesh.points.iter_mut().enumerate() {
            let size = 1.0 + 0.2 * f64::sin((seed as f64 + 1.0) * (k as f64 + 0.5));
            *p = p.map(|x| x * size);
        }
        let smoothing = if smooth { Smoothing::Nagata } else { Smoothing::Facet };
        let options = NormalOptions { feature_angle: 120.0, ..NormalOptions::default() };
        let patches = patches_from_mesh(&mesh, smoothing, &options, false).unwrap();
        let x = Vec3::from(x);
        let set = PatchSet::new(patches.clone());
        let p = set.closest(&x, 10.0, None).unwrap();
        let nearest = set.nearest(&x).unwrap();
        prop_assert!((p.point + p.normal * p.gap - x).norm() < 1e-9);
        let side = (10000.0 / patches.len() as f64).sqrt() as usize;
        for patch in &patches {
            for k in 0..side * side {
                let (s, t) = ((k % side) as f64 / (side - 1) as f64, (k / side) as f64 / (side - 1) as f64);
                let xi = if patch.count == 3 { [s, s * t] } else { [s, t] };
                let distance = (x - patch.point(xi)).norm();
                prop_assert!(p.gap.abs() <= distance + 1e-12 && nearest.gap.abs() <= distance + 1e-12);
            }
        }
    }
}

#[test]
fn pieces_that_are_not_admitted_hide_the_edges_that_they_share() {
    let cube = cube(false);
    let above = Vec3::new(0.3, 0.4, 1.1);
    let top = cube.closest(&above, 10.0, None).unwrap();
    for warm in [None, Some((top.patch, top.xi))] {
        // Neither the neighbour beyond a smooth edge nor the sides beyond sharp ones.
        assert_eq!(cube.closest_of(&above, 0.8, warm, &|p: &Patch, _: &Foot| p.id != top.patch), None);
        assert_eq!(
            cube.closest_of(&above, 1.0, warm, &|_: &Patch, foot: &Foot| foot.local.area_vector().z < 0.5),
            None
        );
        // From inside, the next of the walls.
        let inside = Vec3::new(0.3, 0.4, 0.9);
        let wall = cube
            .closest_of(&inside, 1.0, warm, &|_: &Patch, foot: &Foot| foot.local.area_vector().normalize().z < 0.5)
            .unwrap();
        assert!((wall.gap + 0.6).abs() < 1e-15 && (wall.normal - Vec3::y()).norm() < 1e-15);
    }
}

/// What looks against a direction, by more than 120 degrees; what looks otherwise is told by its extent.
struct Against(Vec3);

impl Against {
    fn faces(&self, _: &Patch, foot: &Foot) -> bool {
        foot.local.area_vector().normalize().dot(&self.0) < -0.5
    }
}

impl Admission<Patch> for Against {
    fn may_admit(&self, _: &Patch, extent: &Extent) -> bool {
        extent.may_face(&self.0, -0.5)
    }

    fn admits(&self, piece: &Patch, foot: &Foot) -> bool {
        self.faces(piece, foot)
    }
}

#[test]
fn pieces_that_are_passed_over_by_their_extent_change_nothing() {
    let mut random = Random::new(1);
    let sphere = PatchSet::new(sphere_patches(4, false, 6, Smoothing::Nagata));
    let (mut met, mut passed) = (0, 0);
    for surface in [sphere, cube(false), cube(true)] {
        for _ in 0..400 {
            let x = random.vector(1.3);
            let against = Against(random.vector(1.0).normalize());
            let plain = |patch: &Patch, foot: &Foot| against.faces(patch, foot);
            let found = surface.closest_of(&x, 1.5, None, &against);
            assert_eq!(found, surface.closest_of(&x, 1.5, None, &plain));
            assert_eq!(surface.nearest_of(&x, 1.5, &against), surface.nearest_of(&x, 1.5, &plain));
            met += usize::from(found.is_some());
            passed += (0..surface.pieces.len()).filter(|k| !surface.extent(*k).may_face(&against.0, -0.5)).count();
        }
    }
    assert!(met > 200 && passed > 5000, "{met} {passed}");
}

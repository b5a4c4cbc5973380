//! The closest point of a surface made of patches.
//!
//! The closest point is that of the signed distance: among all points of all patches, without extensions, the one
//! nearest to x. From outside a convex edge that is a point of the edge, from inside the nearer facet, in a concave
//! corner the nearer wall, in a thin tool the nearer side. What it means depends on where it is:
//!
//! - inside a patch: gap and normal are those of the patch;
//! - on a smooth edge: both patches are extended by [`EXTENSION`] and the one that needs less of it is taken. Beyond
//!   that, far from the surface, the edge counts as sharp;
//! - on a sharp edge or corner: the normal points from the edge to x. Inside or outside is told by the sum of the
//!   normals of the patches around, weighted by their angles (Baerentzen and Aanaes 2005, IEEE Trans. Vis. Comput.
//!   Graph. 11, 243-253);
//! - on the boundary of the surface: the patch is extended, and beyond that x has no projection on it; patches further
//!   away may still have one. The edge of a patch whose neighbour comes closer to x has no projection either.
//!
//! Nothing depends on the order of the patches: equal distances go to the least extension, then to the lower id. The
//! patch of the last projection is kept when it is as close within a millionth of its size.

use super::patch::{EXTENSION, Edge, Patch};
use super::projection::{Extent, Foot, Projection, angle_normal, descend, on_edge, on_surface, starts};
use crate::{Mat3, Vec3};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, PointDistance, RTree};

/// Distances that differ by less, over the size of a patch, are equal.
const EQUAL: f64 = 1e-12;
/// The same for the patch of the last projection.
const KEEP: f64 = 1e-6;
/// Distance to an edge, over the size of the patch, below which the direction to it means nothing.
const TOUCH: f64 = 1e-9;

/// Overshoots that differ by less are equal.
const ROUNDED: f64 = 1e-9;

type Leaf = GeomWithData<Rectangle<[f64; 3]>, u32>;

/// Patches with a search tree over their boxes.
pub struct PatchSet {
    /// By rising id.
    patches: Vec<Patch>,
    extents: Vec<Extent>,
    tree: RTree<Leaf>,
    largest: f64,
}

impl PatchSet {
    /// A set of patches with different ids.
    pub fn new(mut patches: Vec<Patch>) -> Self {
        patches.sort_by_key(|p| p.id);
        let extents: Vec<Extent> = patches.iter().map(Extent::new).collect();
        let leaf = |(k, patch): (usize, &Patch)| {
            let (low, high) = patch.bounds();
            Leaf::new(Rectangle::from_corners(low.into(), high.into()), k as u32)
        };
        let tree = RTree::bulk_load(patches.iter().enumerate().map(leaf).collect());
        let largest = extents.iter().map(|e| e.radius).fold(0.0, f64::max);
        Self { patches, extents, tree, largest }
    }

    /// The patches, by rising id.
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// The patch with this id.
    pub fn get(&self, id: u32) -> Option<&Patch> {
        self.index(id).map(|k| &self.patches[k])
    }

    /// Indices into [`Self::patches`], rising, of the patches whose boxes meet a box.
    pub fn within(&self, low: &Vec3, high: &Vec3) -> Vec<u32> {
        let mut found: Vec<u32> = self.boxes(low, high).map(|leaf| leaf.data).collect();
        found.sort_unstable();
        found
    }

    /// Closest point to `x` within the distance `reach`; `warm` is the patch and parameters of the last projection.
    ///
    /// Depends on the patches within reach only. `None` when there are none, or when `x` lies beyond an end of the
    /// surface.
    pub fn closest(&self, x: &Vec3, reach: f64, warm: Option<(u32, [f64; 2])>) -> Option<Projection> {
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        let kept = warm.and_then(|(id, _)| self.index(id));
        let start = warm.map(|(_, xi)| xi);
        let mut search = Search::new(self, x, reach, kept, false);
        search.run(start);
        if search.choice().is_some_and(|hit| hit.place.limits != 0 && search.lost < hit.distance) {
            // A patch without projection is closer than this edge: it may be the one across the edge.
            search = Search::new(self, x, reach, kept, true);
            search.run(start);
        }
        search.choice().map(|hit| search.projection(hit))
    }

    fn index(&self, id: u32) -> Option<usize> {
        self.patches.binary_search_by_key(&id, |p| p.id).ok()
    }

    fn boxes(&self, low: &Vec3, high: &Vec3) -> impl Iterator<Item = &Leaf> {
        self.tree.locate_in_envelope_intersecting(AABB::from_corners((*low).into(), (*high).into()))
    }
}

/// A patch with a projection of x.
#[derive(Clone, Copy, Default)]
struct Hit {
    index: usize,
    /// Least distance to the patch without extension, and where it is.
    distance: f64,
    core: Place,
    /// The same with the extension that the edges allow.
    place: Place,
    overshoot: f64,
}

/// Parameters, and the limits of the domain that they lie on.
#[derive(Clone, Copy, Default)]
struct Place {
    xi: [f64; 2],
    limits: u8,
}

impl From<Foot> for Place {
    fn from(foot: Foot) -> Self {
        Self { xi: foot.xi, limits: foot.limits }
    }
}

/// As many patches as are told apart around one point; of more, those with the lowest ids count.
const HITS: usize = 24;

struct Search<'a> {
    set: &'a PatchSet,
    x: &'a Vec3,
    kept: Option<usize>,
    /// Whether to ask the neighbours of every edge.
    wary: bool,
    /// Least distance of a patch with a projection, and of one without.
    best: f64,
    lost: f64,
    /// The first `count` are as close as the best was when they were found.
    hits: [Hit; HITS],
    count: usize,
}

impl<'a> Search<'a> {
    fn new(set: &'a PatchSet, x: &'a Vec3, reach: f64, kept: Option<usize>, wary: bool) -> Self {
        Self { set, x, kept, wary, best: reach, lost: f64::INFINITY, hits: [Hit::default(); HITS], count: 0 }
    }

    /// Considers all patches whose boxes are as close as the best patch: from the box around x when a last projection
    /// tells how large it must be, else by rising distance.
    fn run(&mut self, warm: Option<[f64; 2]>) {
        if let Some(kept) = self.kept {
            self.consider(kept, warm);
        }
        let set = self.set;
        let margin = EQUAL * set.largest + self.rounding();
        let x: [f64; 3] = (*self.x).into();
        if self.count > 0 {
            let around = Vec3::repeat(self.best + margin);
            for leaf in set.boxes(&(self.x - around), &(self.x + around)) {
                if self.kept != Some(leaf.data as usize) && leaf.geom().distance_2(&x) <= (self.best + margin).powi(2) {
                    self.consider(leaf.data as usize, None);
                }
            }
        } else {
            for (leaf, distance_2) in set.tree.nearest_neighbor_iter_with_distance_2(x) {
                if distance_2 > (self.best + margin).powi(2) {
                    break;
                }
                if self.kept != Some(leaf.data as usize) {
                    self.consider(leaf.data as usize, None);
                }
            }
        }
    }

    fn consider(&mut self, index: usize, start: Option<[f64; 2]>) {
        let core = self.core(index, self.x, start);
        if core.distance > self.best + self.slack(index) {
            return;
        }
        let Some((foot, overshoot)) = settle(&self.set.patches[index], self.x, core) else {
            self.lost = self.lost.min(core.distance);
            return;
        };
        let hit = Hit { index, distance: core.distance, core: core.into(), place: foot.into(), overshoot };
        if self.wary && foot.limits != 0 && self.a_neighbour_is_closer(&hit, &core.local.point) {
            return;
        }
        self.best = self.best.min(core.distance);
        self.push(hit);
    }

    /// The closest point of a patch without extension.
    fn core(&self, index: usize, x: &Vec3, start: Option<[f64; 2]>) -> Foot {
        let patch = &self.set.patches[index];
        let first = descend(patch, x, &[0.0; 4], start.map_or(patch.center(), |xi| patch.clamp(xi)));
        if self.set.extents[index].has_one_minimum(patch, x) {
            return first;
        }
        let closer = |a: Foot, b: Foot| if b.distance < a.distance { b } else { a };
        starts(patch).iter().map(|s| descend(patch, x, &[0.0; 4], *s)).fold(first, closer)
    }

    fn push(&mut self, hit: Hit) {
        if self.count == HITS {
            let mut count = 0;
            for k in 0..HITS {
                if self.is_close(&self.hits[k]) {
                    self.hits[count] = self.hits[k];
                    count += 1;
                }
            }
            self.count = count;
        }
        if self.count < HITS {
            self.hits[self.count] = hit;
            self.count += 1;
        } else if let Some(last) = self.hits.iter_mut().max_by_key(|h| h.index).filter(|h| h.index > hit.index) {
            *last = hit;
        }
    }

    /// Whether a patch that touches `hit` at its core point comes closer to x.
    fn a_neighbour_is_closer(&self, hit: &Hit, point: &Vec3) -> bool {
        let touch = TOUCH * self.set.extents[hit.index].radius;
        let around = Vec3::repeat(touch);
        self.set.boxes(&(point - around), &(point + around)).map(|leaf| leaf.data as usize).any(|index| {
            index != hit.index
                && self.core(index, point, None).distance < touch
                && self.core(index, self.x, None).distance < hit.distance - self.slack(index)
        })
    }

    fn rounding(&self) -> f64 {
        8.0 * f64::EPSILON * self.x.amax()
    }

    /// How much further away than the best a patch may be and count as equally close.
    fn slack(&self, index: usize) -> f64 {
        let keep = if self.kept == Some(index) { KEEP } else { EQUAL };
        keep * self.set.extents[index].radius + self.rounding()
    }

    fn is_close(&self, hit: &Hit) -> bool {
        hit.distance <= self.best + self.slack(hit.index)
    }

    /// The hit to take: the least overshoot, inside rather than on an edge, the lowest id.
    fn choice(&self) -> Option<&Hit> {
        let rank = |hit: &Hit| {
            let kept = if self.kept == Some(hit.index) { KEEP } else { 0.0 };
            // In steps well above rounding, so that equal overshoots are seen to be equal.
            (((hit.overshoot - kept) / ROUNDED).round() as i64, hit.place.limits != 0, hit.index)
        };
        self.hits[..self.count].iter().filter(|hit| self.is_close(hit)).min_by_key(|hit| rank(hit))
    }

    fn projection(&self, hit: &Hit) -> Projection {
        let patch = &self.set.patches[hit.index];
        let Place { xi, limits } = hit.place;
        let local = patch.local(xi);
        let r = self.x - local.point;
        let foot = Foot { xi, limits, local, distance: r.norm() };
        let (gap, normal, normal_gradient) = if limits == 0 {
            on_surface(self.x, &local)
        } else {
            let mean = self.mean_normal(hit);
            if foot.distance > TOUCH * self.set.extents[hit.index].radius {
                on_edge(self.x, patch, &foot, mean.dot(&r) < 0.0)
            } else {
                let normal = mean.normalize();
                (r.dot(&normal), normal, Mat3::zeros())
            }
        };
        Projection { gap, point: local.point, normal, normal_gradient, patch: patch.id, xi }
    }

    /// Sum of the normals around the core point of `chosen`, weighted by angle.
    fn mean_normal(&self, chosen: &Hit) -> Vec3 {
        let patches = &self.set.patches;
        let point = patches[chosen.index].point(chosen.core.xi);
        let touch = KEEP * self.set.extents[chosen.index].radius;
        let normal = |hit: &Hit| {
            let (patch, Place { xi, limits }) = (&patches[hit.index], hit.core);
            let foot = Foot { xi, limits, local: patch.local(xi), distance: 0.0 };
            ((foot.local.point - point).norm() <= touch).then(|| angle_normal(patch, &foot))
        };
        self.hits[..self.count].iter().filter(|hit| self.is_close(hit)).filter_map(normal).sum()
    }
}

/// From the closest point of a patch without extension to the one with the extension that its edges allow, and how much
/// of it that needs. `None` beyond an end of the surface.
fn settle(patch: &Patch, x: &Vec3, core: Foot) -> Option<(Foot, f64)> {
    let on =
        |foot: &Foot, kind: &dyn Fn(Edge) -> bool| (0..4).any(|k| foot.limits >> k & 1 == 1 && kind(patch.edges[k]));
    let extension = |kind: &dyn Fn(Edge) -> bool| patch.edges.map(|edge| if kind(edge) { EXTENSION } else { 0.0 });
    let (soft, end) = (|edge| edge != Edge::Sharp, |edge| edge == Edge::Boundary);
    let is_soft = on(&core, &soft);
    if is_soft {
        let foot = descend(patch, x, &extension(&soft), core.xi);
        if !on(&foot, &soft) {
            return Some((foot, patch.overshoot(foot.xi)));
        }
    }
    let foot = if on(&core, &end) { descend(patch, x, &extension(&end), core.xi) } else { core };
    let count = patch.count as usize;
    let at_corner = |k: usize| foot.limits >> k & 1 == 1 && foot.limits >> ((k + count - 1) % count) & 1 == 1;
    if on(&foot, &end) || (0..count).any(|k| at_corner(k) && patch.on_boundary[k]) {
        return None;
    }
    // Beyond all extension the smooth edge comes after any patch that needs less.
    Some((foot, if is_soft { 1.0 } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Smoothing;
    use crate::surface::projection::tests::check_derivatives;
    use crate::surface::test_meshes::{cubed_sphere, grid, indenter, indenter_normal, mesh_of, sphere_patches, strip};
    use crate::surface::tool::patches_from_mesh;
    use proptest::prelude::*;

    fn set(mesh: &crate::mesh::Mesh, smoothing: Smoothing) -> PatchSet {
        PatchSet::new(patches_from_mesh(mesh, smoothing, 40.0, false).unwrap())
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
                    assert!(
                        tool.closest(&Vec3::new(x, y, 1.7), 5.0, None).is_none(),
                        "{smoothing:?} {triangles} {x} {y}"
                    );
                    assert!(tool.closest(&Vec3::new(x, y, -0.8), 5.0, None).is_none());
                }
            }
            let fillet = Vec3::new(18.0, 1.0, 1.8);
            assert!(tool.closest(&fillet, 5.0, None).is_none());
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
            let near: Vec<Patch> = set
                .within(&x.add_scalar(-0.3), &x.add_scalar(0.3))
                .iter()
                .map(|k| set.patches()[*k as usize])
                .collect();
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
        let other = cube.patches().iter().map(|p| p.id).find(|id| {
            *id != free.patch && cube.closest(&x, 1.0, Some((*id, [0.5, 0.5]))).is_some_and(|p| p.patch == *id)
        });
        let other = other.unwrap();
        let nearer = cube.closest(&(x + free.normal * 1e-8), 1.0, Some((other, [0.5, 0.5]))).unwrap();
        assert_eq!(nearer.patch, other);
        let nearer = cube.closest(&(x + free.normal * 1e-5), 1.0, Some((other, [0.5, 0.5]))).unwrap();
        assert_eq!(nearer.patch, free.patch);
    }

    /// The share of points over a 4 by 4 cap that no patch has a normal through, of the study of blind spots (z/R =
    /// 1.1).
    #[test]
    fn blind_spots_of_facets_are_edges_here() {
        let facets = PatchSet::new(sphere_patches(4, false, 1, Smoothing::Facet));
        let (mut blind, mut all) = (0, 0);
        for i in 0..=100 {
            for j in 0..=100 {
                let x = Vec3::new(0.018 * i as f64 - 0.9, 0.018 * j as f64 - 0.9, 1.1);
                if x.x.abs() < 1.0 && x.y.abs() < 1.0 {
                    all += 1;
                    let on_edge = |p: Projection| p.xi.iter().any(|xi| *xi <= 0.0 || *xi >= 1.0);
                    blind += facets.closest(&x, 1.0, None).is_none_or(on_edge) as usize;
                }
            }
        }
        assert!((blind as f64 / all as f64 - 0.345).abs() < 0.06, "{}", blind as f64 / all as f64);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
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
            let patches = patches_from_mesh(&mesh, smoothing, 120.0, false).unwrap();
            let x = Vec3::from(x);
            let p = PatchSet::new(patches.clone()).closest(&x, 10.0, None).unwrap();
            prop_assert!((p.point + p.normal * p.gap - x).norm() < 1e-9);
            let side = (10000.0 / patches.len() as f64).sqrt() as usize;
            for patch in &patches {
                for k in 0..side * side {
                    let (s, t) = ((k % side) as f64 / (side - 1) as f64, (k / side) as f64 / (side - 1) as f64);
                    let xi = if patch.count == 3 { [s, s * t] } else { [s, t] };
                    prop_assert!(p.gap.abs() <= (x - patch.point(xi)).norm() + 1e-12);
                }
            }
        }
    }
}

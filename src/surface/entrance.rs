//! The side of a surface through which a point has come that is behind it.
//!
//! The closest point tells where a point leaves the inside on the shortest way. Near a sharp edge, and in anything thin, that
//! may be another side than the one it came in through: a node that presses the face of a platen deeper than it is from the
//! platen's edge would be sent out sideways, and the face would not feel it.
//!
//! The closest side stands if the point was in front of it where it began, or off it along its normal. Else another counts, if
//! both are sides of one convex part, each closest point behind the other side, and if the point has gone into it and not
//! along it: the one along whose normal the point was, or else, of those that it was not behind, the one into which it has gone
//! deepest. In a concave corner the nearer wall stays what it is.

use super::Projection;
use crate::Vec3;

/// How a point came to where it is.
pub struct Way<'a> {
    /// Where it began, as seen from a point of the surface, which may have moved since.
    pub place: &'a dyn Fn(&Projection) -> Option<Vec3>,
    /// The normal that it had then, if it had any.
    pub normal: Option<Vec3>,
    pub sides: Sides,
}

/// What counts as on one side.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    /// How far beside a side, or in front of it, a point may be: so exact are its places.
    pub aside: f64,
    /// 1 - cosine of the angle between normals.
    pub turn: f64,
}

impl Sides {
    /// Whether two sides are of one convex part: each closest point is behind the other side.
    fn are_convex(&self, a: &Projection, b: &Projection) -> bool {
        let behind = |at: &Projection, side: &Projection| (at.point - side.point).dot(&side.normal) <= self.aside;
        behind(a, b) && behind(b, a)
    }

    /// Of the sides that a point touches, whose closest point is `found`, the one that looks at it the most, if that is another;
    /// the point looks `outward`, and `feet` gives perpendiculars to all sides up to a length.
    pub fn facing(
        &self,
        found: &Projection,
        outward: &Vec3,
        feet: impl FnOnce(f64) -> Vec<Projection>,
    ) -> Option<Projection> {
        let along = |at: &Projection| at.normal.dot(outward);
        if found.gap.abs() > self.aside || along(found) <= self.turn - 1.0 {
            return None;
        }
        let sides = feet(self.aside).into_iter().filter(|at| self.are_convex(at, found));
        let best = sides.min_by(|a, b| along(a).total_cmp(&along(b)).then(a.patch.cmp(&b.patch)));
        best.filter(|at| along(at) < along(found) - self.turn)
    }
}

impl Way<'_> {
    /// How far it was in front of the plane that touches the surface at a point.
    fn ahead(&self, at: &Projection) -> f64 {
        (self.place)(at).map_or(f64::NAN, |place| (place - at.point).dot(&at.normal))
    }

    /// Whether it has gone into the side of `at`, and not along it towards the side of `found`: by less than into it, and by
    /// less than half of what was left. What slides over an edge is behind the other side from then on.
    fn goes_in(&self, x: &Vec3, at: &Projection, found: &Projection) -> bool {
        let Some(way) = (self.place)(at).map(|place| x - place) else { return false };
        let along = way.dot(&(found.normal - at.normal * found.normal.dot(&at.normal)));
        let most = f64::min(-way.dot(&at.normal), -0.5 * self.ahead(found));
        along <= most.max(self.sides.aside)
    }

    fn is_along(&self, at: &Projection) -> bool {
        self.normal.is_some_and(|normal| normal.dot(&at.normal) >= 1.0 - self.sides.turn)
    }

    /// The side that `x`, whose closest point is `found`, has come through, or is off along its normal, if it is not simply the
    /// nearest. `feet` gives perpendiculars to all sides up to a length.
    pub fn entrance(
        &self,
        x: &Vec3,
        found: &Projection,
        feet: impl FnOnce(f64) -> Vec<Projection>,
    ) -> Option<Projection> {
        let aside = self.sides.aside;
        if self.is_along(found) {
            return Some(*found);
        }
        if found.gap >= aside {
            return None;
        }
        // No deeper than the way is long.
        let most = ((self.place)(found)? - x).norm() + aside;
        let is_way_in = |at: &Projection| self.sides.are_convex(at, found) && self.goes_in(x, at, found);
        let sides = feet(most).into_iter().filter(is_way_in);
        let sides: Vec<(Projection, f64)> = sides.map(|at| (at, self.ahead(&at))).collect();
        let along = sides.iter().filter(|(at, _)| self.is_along(at));
        let nearest = along.min_by(|(a, _), (b, _)| a.gap.abs().total_cmp(&b.gap.abs()).then(a.patch.cmp(&b.patch)));
        let ahead = self.ahead(found);
        // On an edge, where the normal of the closest point is no side's, that side counts first.
        if ahead > aside && nearest.is_none_or(|(at, _)| at.gap.abs() > found.gap.abs() + aside) {
            return None;
        }
        let way_in = |at: &Projection, ahead: f64| if ahead >= -aside { ahead - at.gap } else { 0.0 };
        let deepest = || {
            let ways = sides.iter().map(|(at, ahead)| (at, way_in(at, *ahead)));
            let deepest = ways.max_by(|(a, way), (b, other)| way.total_cmp(other).then(b.patch.cmp(&a.patch)));
            deepest.filter(|(_, way)| *way > way_in(found, ahead) + aside).map(|(at, _)| at)
        };
        nearest.map(|(at, _)| at).or_else(deepest).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Smoothing;
    use crate::surface::analytic::{Chain, Profile, Sweep};
    use crate::surface::normals::NormalOptions;
    use crate::surface::test_meshes::mesh_of;
    use crate::surface::{PatchSet, patches_from_mesh};

    const SIDES: Sides = Sides { aside: 1e-3, turn: 0.1 };

    /// A plate of 4 x 1 from y = 0 up: as patches, and as a profile.
    fn plates() -> (PatchSet, Profile) {
        let corner = |k: usize| [[-2.0, 2.0][k & 1], [0.0, 1.0][k >> 1 & 1], [-3.0, 3.0][k >> 2]];
        let facets: [&[u32]; 6] =
            [&[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 4, 6, 2], &[1, 3, 7, 5], &[0, 2, 3, 1], &[4, 5, 7, 6]];
        let mesh = mesh_of((0..8).map(corner).collect(), &facets);
        let patches = patches_from_mesh(&mesh, Smoothing::Nagata, &NormalOptions::default(), false).unwrap();
        let points = [[-2.0, 0.0], [2.0, 0.0], [2.0, 1.0], [-2.0, 1.0]];
        let chain = Chain::new(&points, &[0.0; 4], true, false).unwrap();
        let sweep = Sweep::Extruded { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), length: None };
        (PatchSet::new(patches), Profile { chain, sweep })
    }

    /// The normal and the gap with which a point meets both plates that went from one place of the section to another.
    fn met(from: [f64; 2], to: [f64; 2], normal: Option<[f64; 2]>) -> ([f64; 2], f64) {
        let [from, to] = [from, to].map(|[x, y]| Vec3::new(x, y, 0.3));
        let (patches, profile) = plates();
        let normal = normal.map(|[x, y]| Vec3::new(x, y, 0.0));
        let way = Way { place: &|_| Some(from), normal, sides: SIDES };
        let meets = |found: Projection, feet: &dyn Fn(f64) -> Vec<Projection>| {
            let at = way.entrance(&to, &found, feet).unwrap_or(found);
            assert!((at.slave() - to).norm() < 1e-12);
            ([at.normal.x.round(), at.normal.y.round()], at.gap)
        };
        let found = patches.closest(&to, 5.0, None).unwrap();
        let on_patches = meets(found, &|most| patches.perpendiculars(&to, most, SIDES.aside));
        let found = profile.project(&to, None).unwrap();
        let on_profile = meets(found, &|most| profile.perpendiculars(&to, most, SIDES.aside));
        assert_eq!(on_patches.0, on_profile.0);
        assert!((on_patches.1 - on_profile.1).abs() < 1e-12);
        on_patches
    }

    /// Points come from below, y < 0, unless they come from a side.
    #[test]
    fn sides_are_those_that_points_came_through() {
        let (below, beside) = ([0.0, -1.0], [1.0, 0.0]);
        let check = |(normal, gap): ([f64; 2], f64), side: [f64; 2], right: f64| {
            assert_eq!(normal, side);
            assert!((gap - right).abs() < 1e-12, "{gap}");
        };
        // Deeper than the edge is far, from a distance and from the face, exactly at the edge, and a little beside it.
        check(met([1.98, -0.1], [1.98, 0.05], None), below, -0.05);
        check(met([1.98, 0.0], [1.98, 0.05], Some(below)), below, -0.05);
        check(met([2.0, 0.0], [2.0, 0.05], None), below, -0.05);
        check(met([2.0, 0.0], [2.0, 0.05], Some(below)), below, -0.05);
        check(met([2.0, 0.0], [2.0 + 5e-4, 0.05], Some(below)), below, -0.05);
        // Through more than half of the plate.
        check(met([0.0, -0.1], [0.0, 0.7], None), below, -0.7);
        // From the side, and where the nearest side is the one.
        check(met([2.1, 0.1], [1.9, 0.05], None), beside, -0.1);
        check(met([2.0, 0.5], [1.6, 0.3], Some(beside)), beside, -0.4);
        check(met([0.0, -0.1], [0.0, 0.2], None), below, -0.2);
        // Along the face over the edge.
        check(met([1.9, 0.0], [1.99, 0.05], Some(below)), beside, -0.01);
        check(met([1.9, 0.0], [1.99, 0.2], Some(below)), beside, -0.01);
        // From in front of both the nearer one.
        check(met([2.1, -0.1], [1.9, 0.05], None), below, -0.05);
        // In front of the plate nothing is to be said.
        check(met([2.1, -0.1], [0.0, -0.2], None), below, 0.2);
    }

    #[test]
    fn what_touches_two_sides_meets_the_one_that_it_faces() {
        let (patches, _) = plates();
        let x = Vec3::new(2.0, 0.0, 0.3);
        let found = patches.closest(&x, 1.0, None).unwrap();
        for outward in [Vec3::y(), -Vec3::x()] {
            let facing = SIDES.facing(&found, &outward, |most| patches.perpendiculars(&x, most, SIDES.aside));
            assert!((facing.unwrap_or(found).normal + outward).norm() < 1e-12);
        }
        // It looks at neither more than at the other.
        let outward = Vec3::new(-1.0, 1.0, 0.0).normalize();
        let facing = SIDES.facing(&found, &outward, |most| patches.perpendiculars(&x, most, SIDES.aside));
        assert!(facing.is_none_or(|at| at.normal.dot(&outward) < -0.7));
    }

    /// In a groove of 90 degrees the nearer wall counts, wherever a point came from.
    #[test]
    fn in_a_concave_corner_nothing_changes() {
        let points = vec![
            [-2.0, 2.0, -1.0],
            [0.0, 0.0, -1.0],
            [2.0, 2.0, -1.0],
            [-2.0, 2.0, 1.0],
            [0.0, 0.0, 1.0],
            [2.0, 2.0, 1.0],
        ];
        let mesh = mesh_of(points, &[&[0, 3, 4, 1], &[1, 4, 5, 2]]);
        let patches = patches_from_mesh(&mesh, Smoothing::Facet, &NormalOptions::default(), false).unwrap();
        let patches = PatchSet::new(patches);
        let x = Vec3::new(0.02, -0.05, 0.0);
        let found = patches.closest(&x, 1.0, None).unwrap();
        for from in [Vec3::new(-0.5, 0.5, 0.0), Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.0, 1.0, 0.0)] {
            let way = Way { place: &|_| Some(from), normal: None, sides: SIDES };
            assert_eq!(way.entrance(&x, &found, |most| patches.perpendiculars(&x, most, SIDES.aside)), None);
        }
    }
}

//! Integration points of slave faces on the master, and what a slave node meets through them.

use super::{Face, Moved, Spot, ends, mean};
use crate::Vec3;
use crate::contact::element::Portion;
use crate::contact::master::{Ground, SlipOrigin};
use crate::contact::{BodySurface, Pair, Status};
use crate::mortar::rule::on_line;
use crate::mortar::{self, Corners, MeanPlane, overlap};
use crate::surface::{Patch, Projection};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Points along a line of a triangle of an overlap: where they are exact for the products of two linear functions, and for the shape
/// functions of nine nodes, which make forces of an even pressure; and where nothing is, or where these are multiplied by a radius.
const POINTS: [[usize; 2]; 2] = [[2, 3], [3, 4]];

/// Over the size of a facet, what it may bulge by as a flat one: rules differ by as little there, and which is taken does not decide.
const FLAT: f64 = 1e-9;

/// An integration point on the master.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Where it is in its face; of a node alone at its first corner.
    pub spot: Spot,
    pub moved: Moved,
    pub place: Vec3,
    pub at: Projection,
    /// Where its slip counts from, and where that is now; with friction.
    pub origin: SlipOrigin,
    pub start: Vec3,
}

impl Point {
    /// Its spot, with where it was on the master.
    fn again(&self) -> Start {
        (self.spot, Some((self.at.patch, self.at.xi)))
    }

    /// What it is to the element, with such a share.
    pub fn portion(&self, weight: f64) -> Portion<'_> {
        let Self { moved, place, at, origin, start, .. } = self;
        let (place, origin, start) = (*place, *origin, *start);
        Portion { weight, nodes: moved.nodes(), shapes: moved.shapes(), place, at, origin, start }
    }

    /// The patches of a body that it is on, with friction that of its slip origin, too.
    pub fn patches(&self, frictional: bool) -> impl Iterator<Item = u32> {
        let from = match self.origin {
            SlipOrigin::Carried(id, _) if frictional => Some(id),
            _ => None,
        };
        std::iter::once(self.at.patch).chain(from)
    }
}

/// A point's share in what a slave node meets: its face, its place among those of the face, and w_iq.
#[derive(Clone, Copy, Debug)]
pub struct Share {
    pub face: u32,
    pub point: u32,
    pub weight: f64,
}

/// The points of the faces of a pair at an iterate, by face.
#[derive(Clone, Debug, Default)]
pub struct Segments {
    points: Vec<Vec<Point>>,
    /// How far the faces bulge.
    heights: Vec<[f64; 4]>,
}

/// A spot of a face, with where its projection may begin.
type Start = (Spot, Option<(u32, [f64; 2])>);

impl Segments {
    /// Finds the points of all faces of a pair with nodes at `now`. With friction they slip from where nodes were `then`, at the last
    /// converged increment. Faces bulge by `heights`, unless points stand `still` in them: these are found again on the master, as
    /// high above their faces as before.
    pub fn find(
        pair: &Pair,
        ground: &Ground,
        heights: impl FnOnce() -> Vec<[f64; 4]>,
        now: impl Fn(u32) -> Vec3,
        then: Option<&dyn Fn(u32) -> Vec3>,
        still: Option<&Self>,
    ) -> Self {
        let lines = POINTS.map(|points| points.map(on_line));
        let then = then.filter(|_| pair.rules.friction > 0.0);
        let heights = still.map_or_else(heights, |still| still.heights.clone());
        // Where corners of faces on a tool are, and what is closest to them, by the nodes that move them.
        let corners = RefCell::new(BTreeMap::new());
        let of_face = |(f, face): (usize, &Face)| {
            let (places, before) = (face.at(&now), then.map(|then| face.at(then)));
            let x = face.piece.map(|k| places[k]);
            let Some(outward) = x.area_vector().try_normalize(f64::MIN_POSITIVE) else { return Vec::new() };
            let looked = before.map(|before| face.piece.map(|k| before[k]).area_vector());
            let looked = looked.and_then(|area| area.try_normalize(f64::MIN_POSITIVE)).unwrap_or(outward);
            let point = |(spot, start): Start| {
                let moved = face.moved(&spot.shapes);
                let place = moved.of(&places);
                let flat = ground.project_point(pair, f, (&place, &outward), start)?;
                if still.is_none() && start.is_some_and(|start| is_hidden(pair, ground, &place, start, &flat)) {
                    return None;
                }
                let at = Projection { gap: flat.gap - face.height(heights[f], &spot.shapes), ..flat };
                let origin = match &before {
                    Some(before) => ground.origin_of(pair, f, (&moved.of(before), &looked), &at),
                    None => SlipOrigin::Fixed(at.point),
                };
                let start = ground.place_of(&origin).unwrap_or(at.point);
                Some(Point { spot, moved, place, at, origin, start })
            };
            let at = |spots: &[Spot]| spots.iter().filter_map(|spot| point((*spot, None))).collect::<Vec<_>>();
            match (ground, still) {
                (_, Some(still)) => still.points[f].iter().map(Point::again).filter_map(point).collect(),
                (Ground::Surface(surface, _), None) => {
                    let starts = covered(pair, (f, face), &heights[f], &x, surface, &lines);
                    starts.into_iter().filter_map(point).collect()
                }
                (Ground::Tool(tool), None) => {
                    let points = at(&face.spots);
                    // Farther off, what a face looks at does not press it.
                    if !points.is_empty() && points.iter().all(|point| point.at.gap > pair.facet_size) {
                        return points;
                    }
                    let sees_corner = |a: usize| {
                        let mut corners = corners.borrow_mut();
                        let project = || (x.x[a], tool.project(&x.x[a], pair.reach, (None, false)));
                        let (x, found) = corners.entry(face.nodes[a]).or_insert_with(project);
                        found.and_then(|found| ends::ahead(tool, pair, x, found, &outward)).is_some()
                    };
                    let corners: Vec<bool> = (0..x.count).map(sees_corner).collect();
                    let seen = corners.iter().filter(|sees| **sees).count() + points.len();
                    if [0, x.count + face.spots.len()].contains(&seen) {
                        return points;
                    }
                    let sees = |shapes: &[f64; 4]| {
                        ground.project_point(pair, f, (&face.moved(shapes).of(&places), &outward), None).is_some()
                    };
                    at(&face.part(&corners, &lines[0][1], sees))
                }
            }
        };
        let points = pair.faces.iter().flat_map(|faces| &faces.faces).enumerate().map(of_face).collect();
        Self { points, heights }
    }

    /// A point.
    pub fn get(&self, share: &Share) -> &Point {
        &self.points[share.face as usize][share.point as usize]
    }

    /// A point with its share, for the element.
    pub fn portion(&self, share: &Share) -> Portion<'_> {
        self.get(share).portion(share.weight)
    }

    /// The points of some faces around slave node `s`, with w_q N_i.
    fn shares(&self, pair: &Pair, s: usize, fan: &[u32]) -> Vec<Share> {
        let Some(faces) = pair.faces.as_ref() else { return Vec::new() };
        let node = pair.slaves[s].node;
        let of_face = |&f: &u32| {
            let face = &faces.faces[f as usize];
            let share = move |(k, point): (usize, &Point)| {
                let weight = point.spot.weight * face.of_node(node, &point.spot.shapes);
                Share { face: f, point: k as u32, weight }
            };
            self.points[f as usize].iter().enumerate().map(share)
        };
        fan.iter().flat_map(of_face).collect()
    }

    /// Where the weightiest point of slave node `s` is on the master.
    pub fn weightiest(&self, pair: &Pair, s: usize) -> Option<Projection> {
        let fans = &pair.faces.as_ref()?.fans[s];
        self.weightiest_of(&fans.iter().flat_map(|fan| self.shares(pair, s, fan)).collect::<Vec<_>>())
    }

    fn weightiest_of(&self, shares: &[Share]) -> Option<Projection> {
        shares.iter().max_by(|a, b| a.weight.total_cmp(&b.weight)).map(|share| self.get(share).at)
    }

    /// What slave node `s` meets, (1) of the [module](super): gap, normal, mean contact point, and the shares of its points, by the fan
    /// that is the nearest. The rest of the projection is that of its `own` closest point, or else of the weightiest.
    pub fn meet(&self, pair: &Pair, s: usize, own: Option<&Projection>) -> Option<(Projection, Vec<Share>)> {
        let gap = |shares: &[Share]| -> f64 { shares.iter().map(|share| share.weight * self.get(share).at.gap).sum() };
        let fans = pair.faces.as_ref()?.fans[s].iter().filter_map(|fan| self.shares_of_fan(pair, s, fan));
        let shares = fans.min_by(|a, b| gap(a).total_cmp(&gap(b)))?;
        let base = own.copied().or_else(|| self.weightiest_of(&shares))?;
        let weighted = shares.iter().map(|share| (&self.get(share).at, share.weight));
        Some((mean_of(weighted, &base)?, shares))
    }

    /// The w_iq of a fan around slave node `s`, unless it lies over too little of the master.
    fn shares_of_fan(&self, pair: &Pair, s: usize, fan: &[u32]) -> Option<Vec<Share>> {
        let (faces, node) = (&pair.faces.as_ref()?.faces, pair.slaves[s].node);
        let of_node = |face: &Face| face.of_node(node, &face.whole);
        let whole: f64 = fan.iter().map(|&f| of_node(&faces[f as usize])).sum();
        let mut shares = self.shares(pair, s, fan);
        let covered: f64 = shares.iter().map(|share| share.weight).sum();
        shares.iter_mut().for_each(|share| share.weight /= covered);
        // One that touches stays until half of that is left: what comes and goes with the node itself would never rest.
        let stays = if pair.slaves[s].trial.status == Status::Gap { 1.0 } else { 0.5 };
        (covered >= stays * pair.controls.segment_least * whole).then_some(shares)
    }
}

/// Whether a piece of the same body is behind the point at which a point of a slave face at `x` sees the master: neither on the piece
/// that this is on nor beside it, and farther away. What overlaps there counts where it is seen.
fn is_hidden(pair: &Pair, ground: &Ground, x: &Vec3, (id, xi): (u32, [f64; 2]), seen: &Projection) -> bool {
    /// Over the distance of what is seen: a foot of a perpendicular is no farther from what is straight ahead.
    const FARTHER: f64 = 1.5;
    let Ground::Surface(surface, _) = ground else { return false };
    if !pair.is_within_body() || id == seen.patch {
        return false;
    }
    let corners = |id: u32| surface.patch(id).map_or(&[][..], |(patch, stencil)| &stencil[..patch.count as usize]);
    let is_beside = || corners(id).iter().any(|n| corners(seen.patch).contains(n));
    let distance = surface.shapes().get(id).map_or(0.0, |patch| (patch.point(xi) - x).norm());
    distance > FARTHER * seen.gap.abs() && !is_beside()
}

/// Mean of projections with their weights, (1) of the [module](super); the rest is that of `base`.
pub fn mean_of<'a>(weighted: impl Iterator<Item = (&'a Projection, f64)>, base: &Projection) -> Option<Projection> {
    let (mut gap, mut normal, mut point) = (0.0, Vec3::zeros(), Vec3::zeros());
    for (at, weight) in weighted {
        gap += weight * at.gap;
        normal += at.normal * weight;
        point += at.point * weight;
    }
    let normal = normal.try_normalize(f64::MIN_POSITIVE)?;
    Some(Projection { gap, point, normal, ..*base })
}

/// Where the overlap of a face of `pair`, at `x`, with the faces of a surface within reach has points.
fn covered(
    pair: &Pair,
    (f, face): (usize, &Face),
    heights: &[f64; 4],
    x: &Corners<Vec3>,
    surface: &BodySurface,
    lines: &[[Vec<[f64; 2]>; 2]; 2],
) -> Vec<Start> {
    let Some(plane) = MeanPlane::of(x) else { return Vec::new() };
    // Where one side bulges, gaps are no linear functions.
    let flat = FLAT * pair.facet_size;
    let bent = heights.iter().fold(face.bent, |most, h| h.abs().max(most));
    let is_plain = face.measure == [1.0; 4] && bent <= flat;
    let [coarse, fine] = &lines[usize::from(face.all.is_quadratic() || surface.is_quadratic)];
    // In self-contact what the face avoids, and how straight what it meets looks at it.
    let own = pair.within.as_ref().and_then(|within| Some((within.of_faces.get(f)?, within.facing)));
    let facing = own.map_or(pair.controls.segment_facing, |(_, facing)| facing);
    let mut starts = Vec::new();
    let scale = face.area / plane.area;
    let (low, high) = x.around(pair.reach);
    for k in surface.shapes().within(&low, &high) {
        let patch: &Patch = &surface.shapes().pieces()[k as usize];
        let master = Corners::new(&patch.nodes[..patch.count as usize]);
        let normal = master.area_vector().normalize();
        if normal.dot(&plane.normal) > facing || own.is_some_and(|(own, _)| own.is_beside(patch.id)) {
            continue;
        }
        // The far side of its own sheet looks back at it, too.
        let is_across = |point: &mortar::Point| {
            let gap = (x.at(&point.slave) - master.at(&point.master)).dot(&normal);
            own.is_some_and(|(own, _)| gap < -own.deep())
        };
        let lines = [if is_plain && patch.bulge() <= flat { coarse } else { fine }, fine];
        let points = overlap(&plane, &master, lines.map(Vec::as_slice)).into_iter();
        for point in points.filter(|point| !is_across(point)) {
            let [_, b, c, d] = point.master;
            let xi = if patch.count == 3 { [b + c, c] } else { [b + c, c + d] };
            let weight = scale * point.weight * face.over_chord(&point.slave) * mean(&point.slave, &face.measure);
            let spot = Spot { shapes: point.slave, weight };
            starts.push((spot, Some((patch.id, xi))));
        }
    }
    starts
}

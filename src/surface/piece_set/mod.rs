//! The closest point of a surface made of pieces.
//!
//! Two questions are asked. [`PieceSet::nearest`] is plain geometry: the nearest of all points of all pieces, however
//! far away, and there always is one. [`PieceSet::closest`] is what contact asks. It starts from the nearest point, which
//! from outside a convex edge is a point of the edge, from inside the nearer facet, in a concave corner the nearer wall,
//! in a thin tool the nearer side. What it means depends on where it is:
//!
//! - inside a piece: gap and normal are those of the piece;
//! - on a smooth edge: both pieces are extended by [`EXTENSION`] and the one that needs less of it is
//!   taken. Beyond that, far from the surface, the edge counts as sharp;
//! - on a sharp edge or corner: the normal points from the edge to x. Inside or outside is told by the sum of the
//!   normals of the pieces around, weighted by their angles (Baerentzen and Aanaes 2005, IEEE Trans. Vis. Comput.
//!   Graph. 11, 243-253);
//! - on the boundary of the surface: the piece is extended, and beyond that x has no projection on it; pieces further
//!   away may still have one. The edge of a piece whose neighbour comes closer to x has no projection either.
//!
//! The edges of a mesh are those of its patches. The edges of a CAD face are the curves it is trimmed with, and what
//! meets there is found by sewing ([`super::faces`]); its extension is that of the surface beyond the trim. Faces may
//! meet at a distance, and then the closest of them gives way, beyond its smooth edge, to one that needs less extension
//! and is no further away than that.
//!
//! [`PieceSet::beside_edge`] is another view of what is outside a sharp edge: there the direction from the edge to x turns
//! the faster the closer x is, and means nothing on the edge; the sides of the edge, extended, have normals that stay. Of
//! them the one counts that x is farthest from: the gap is continuous, and contact is with one side or the other.
//!
//! Nodes that slide along a kink between smooth pieces would be sent from one side to the other for ever.
//! [`PieceSet::stays`] keeps them on the extension of the piece that they come from.
//!
//! Nothing depends on the order of the pieces: equal distances go to the least extension, then to the lower id. The
//! piece of the last projection is kept when it is as close within a millionth of its size.
//!
//! [`PieceSet::normal_projection`] has no policy: it knows feet of perpendiculars only, and so has dead zones.

mod search;
#[cfg(test)]
mod tests;
pub(crate) mod tree;

pub use search::{Admission, settle};

use super::patch::Patch;
use super::piece::{EXTENSION, Piece, Polygon};
use super::projection::{Extent, Foot, Projection, descend};
use crate::Vec3;
use crate::controls::Controls;
use search::{Question, Search};
use std::cell::OnceCell;
use tree::Tree;

/// Cosine of the angle between the normals of a piece and of its edge, above which the edge is none.
const ALIGNED: f64 = 1.0 - 1e-12;
/// Distance, over the size of a piece, below which pieces touch.
const TOUCH: f64 = 1e-9;
/// Parameters within which a point on a piece may be as close to the one beyond the edge.
const BESIDE: f64 = 0.05;
/// Over its depth, how far from the edge the foot of a point is that is as deep under both of its sides, at most: the tangent of half
/// the angle between sides at which it looks as little as it may, see [`LOOKS`].
const ASIDE: f64 = 10.0;
/// Cosines of the angles within which what looks at a face looks at it squarely, and at all: 20 and 84 degrees. Sides of an edge that are
/// no more than 40 degrees apart are of one surface by default.
const SQUARELY: f64 = 0.94;
const LOOKS: f64 = 0.1;

/// What is asked of a point that is exactly between pieces, see [`PieceSet::evenly`].
#[derive(Clone, Copy, Debug)]
pub struct Even<'a> {
    /// Pieces whose normals differ by more, 1 - cosine, count as one only where the point looks at both aslant.
    pub turn: f64,
    /// Where the point looks; nowhere, and it is zero.
    pub outward: Vec3,
    /// How far pieces may be.
    pub reach: f64,
    /// Outside a sharp edge no pieces count, or its sides by so much extension, see [`PieceSet::beside_edge`].
    pub extension: Option<f64>,
    /// The pieces to which it keeps, and to their extensions; all of them count, or none.
    pub kept: Option<&'a [u32]>,
    /// The pieces are of a layer.
    pub planar: bool,
}

impl Even<'_> {
    /// Whether pieces with these normals are one for the point: the surface is as good as smooth there, or they are the sides of an edge
    /// or a tip, of which it could slide to either.
    pub fn joins(&self, a: &Vec3, b: &Vec3) -> bool {
        a.dot(b) >= 1.0 - self.turn || [a, b].iter().all(|side| looks_aslant(&self.outward, side))
    }
}

/// Whether what looks `outward` looks at a face with this normal, but not squarely, as at the side of an edge that points at it.
pub fn looks_aslant(outward: &Vec3, normal: &Vec3) -> bool {
    (-SQUARELY..-LOOKS).contains(&outward.dot(normal))
}

/// Pieces with a search tree over their boxes.
pub struct PieceSet<P> {
    /// By rising id.
    pieces: Vec<P>,
    radii: Vec<f64>,
    /// Of those that something has come near.
    extents: Vec<OnceCell<Extent>>,
    tree: Tree,
    largest: f64,
    /// Greatest distance between neighbours where they meet.
    seam: f64,
}

/// The surface of a mesh.
///
/// ```
/// use nagata::Vec3;
/// use nagata::mesh::{Facet, Mesh};
/// use nagata::surface::{NormalOptions, PatchSet, Smoothing, patches_from_mesh};
///
/// // Four facets around a quarter of a cylinder of radius 1.
/// let corner = |k: usize, z: f64| { let (s, c) = (k as f64 * std::f64::consts::PI / 8.0).sin_cos(); [c, s, z] };
/// let points: Vec<[f64; 3]> = (0..5).flat_map(|k| [corner(k, 0.0), corner(k, 1.0)]).collect();
/// let facet = |k: u32| Facet { count: 4, nodes: [2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1], id: u64::from(k) };
/// let mesh = Mesh { point_ids: (0..10).collect(), points, facets: (0..4).map(facet).collect(), ..Mesh::default() };
/// let x = Vec3::new(1.0, 0.7, 0.5);
/// let error = |smoothing| {
///     let patches = patches_from_mesh(&mesh, smoothing, &NormalOptions::default(), false).unwrap();
///     let at = PatchSet::new(patches).closest(&x, 1.0, None).unwrap();
///     (at.gap - (x.xy().norm() - 1.0)).abs()
/// };
/// assert!(error(Smoothing::Nagata) < 1e-3 && error(Smoothing::Facet) > 1e-2);
/// ```
pub type PatchSet = PieceSet<Patch>;

impl PatchSet {
    /// A set of patches with different ids.
    pub fn new(patches: Vec<Patch>) -> Self {
        Self::of_pieces(patches)
    }

    /// The patches, by rising id.
    pub fn patches(&self) -> &[Patch] {
        &self.pieces
    }

    /// How far from a facet, at its point `at`, the arcs are that it and its neighbours stand for: where they turn by b from one facet
    /// to the next, `L b u (1 - u) / 2` at the part u of a length L across an edge. Of opposite edges the mean counts; edges at which
    /// nothing follows, or that turn by more than `feature_angle`, degrees, tell nothing.
    pub fn off_chord(&self, at: &Projection, feature_angle: f64) -> f64 {
        let Some(facet) = self.get(at.patch) else { return 0.0 };
        let turns = self.turns(facet, feature_angle.to_radians());
        let length = |line: Vec3| line.norm();
        let [e, z] = at.xi.map(|xi| xi.clamp(0.0, 1.0));
        let corner = |k: usize| facet.nodes[k % facet.count as usize];
        if facet.count == 3 {
            let shares = [1.0 - e, e - z, z];
            let of_edge = |k: usize| {
                let (side, u) = (corner(k + 1) - corner(k), shares[(k + 2) % 3]);
                let height = length(side.cross(&(corner(k + 2) - corner(k)))) / length(side);
                0.5 * height * turns[k].unwrap_or(0.0) * u * (1.0 - u)
            };
            return (0..3).map(of_edge).sum::<f64>().abs();
        }
        let across = |k: usize, u: f64| {
            let known: Vec<f64> = [turns[k], turns[k + 2]].into_iter().flatten().collect();
            let middles = [k, k + 2].map(|k| 0.5 * (corner(k) + corner(k + 1)));
            let turn = known.iter().sum::<f64>() / known.len().max(1) as f64;
            0.5 * length(middles[1] - middles[0]) * turn * u * (1.0 - u)
        };
        (across(1, e) + across(0, z)).abs()
    }

    /// By how much a facet turns to its neighbour over each of its edges, positive where it bulges.
    fn turns(&self, facet: &Patch, most: f64) -> [Option<f64>; 4] {
        let edge = |patch: &Patch, k: usize| [patch.nodes[k], patch.nodes[(k + 1) % patch.count as usize]];
        let beside: Vec<&Patch> = {
            let (low, high) = facet.bounds();
            self.within(&low, &high).into_iter().map(|k| &self.pieces[k as usize]).collect()
        };
        let normal = facet.normal(facet.center());
        let over = |k: usize| {
            let [a, b] = edge(facet, k);
            let shares = |patch: &&&Patch| (0..patch.count as usize).any(|j| edge(patch, j) == [b, a]);
            let next = beside.iter().find(shares)?;
            let turned = next.normal(next.center());
            let turn = normal.cross(&turned).norm().atan2(normal.dot(&turned));
            let bulges = (next.point(next.center()) - a).dot(&normal) < 0.0;
            (turn <= most).then_some(if bulges { turn } else { -turn })
        };
        std::array::from_fn(|k| if k < facet.count as usize { over(k) } else { None })
    }
}

/// No pieces.
impl<P: Piece> Default for PieceSet<P> {
    fn default() -> Self {
        Self::of_pieces(Vec::new())
    }
}

impl<P: Piece> PieceSet<P> {
    /// A set of pieces with different ids.
    pub fn of_pieces(mut pieces: Vec<P>) -> Self {
        pieces.sort_by_key(Piece::id);
        let boxes: Vec<_> = pieces.iter().map(P::bounds).collect();
        let (tree, radii, extents) = (Tree::new(&boxes), Vec::new(), Vec::new());
        let mut set = Self { pieces: Vec::new(), radii, extents, tree, largest: 0.0, seam: 0.0 };
        set.take(pieces, &boxes);
        set
    }

    /// Takes the pieces as they are now. Where they are the same ones as before, the search tree is only fitted to them.
    pub fn follow(&mut self, pieces: Vec<P>) {
        if !pieces.iter().map(P::id).eq(self.pieces.iter().map(P::id)) {
            return *self = Self::of_pieces(pieces);
        }
        let boxes: Vec<_> = pieces.iter().map(P::bounds).collect();
        self.tree.fit(&boxes);
        self.take(pieces, &boxes);
    }

    fn take(&mut self, pieces: Vec<P>, boxes: &[tree::Box]) {
        self.radii.clear();
        self.radii.extend(pieces.iter().zip(boxes).map(|(piece, bounds)| Extent::ball(piece, bounds).1));
        self.extents.clear();
        self.extents.resize_with(pieces.len(), OnceCell::new);
        self.largest = self.radii.iter().copied().fold(0.0, f64::max);
        self.seam = pieces.iter().map(P::seam).fold(0.0, f64::max);
        self.pieces = pieces;
    }

    /// The pieces, by rising id.
    pub fn pieces(&self) -> &[P] {
        &self.pieces
    }

    /// The piece with this id.
    pub fn get(&self, id: u32) -> Option<&P> {
        self.index(id).map(|k| &self.pieces[k])
    }

    /// Indices into [`Self::pieces`], rising, of the patches whose boxes meet a box.
    pub fn within(&self, low: &Vec3, high: &Vec3) -> Vec<u32> {
        let mut found: Vec<u32> = self.tree.meeting(low, high).map(|(k, _)| k as u32).collect();
        found.sort_unstable();
        found
    }

    /// The point of all pieces nearest to `x`; `None` for an empty set, or when `x` is not finite.
    ///
    /// The normal is that of the surface; where `x` is beside an end, an edge or a corner it points along the line
    /// between `x` and the point.
    pub fn nearest(&self, x: &Vec3) -> Option<Projection> {
        self.nearest_within(x, f64::INFINITY)
    }

    /// The same when it is not further away than `reach`.
    pub fn nearest_within(&self, x: &Vec3, reach: f64) -> Option<Projection> {
        self.nearest_of(x, reach, &|_: &P, _: &Foot| true)
    }

    /// The same of the pieces that are admitted with their point nearest to `x`.
    pub fn nearest_of(&self, x: &Vec3, reach: f64, admission: &dyn Admission<P>) -> Option<Projection> {
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        let mut search = Search::new(self, x, reach, None, Question::Nearest, admission);
        search.run(None);
        search.answer()
    }

    /// The point of contact for `x` within the distance `reach`; `warm` is the piece and parameters of the last
    /// projection.
    ///
    /// Depends on the pieces within reach only. `None` when there are none, or when `x` lies beyond an end of the
    /// surface.
    pub fn closest(&self, x: &Vec3, reach: f64, warm: Option<(u32, [f64; 2])>) -> Option<Projection> {
        self.closest_of(x, reach, warm, &|_: &P, _: &Foot| true)
    }

    /// The same of the pieces that are admitted with their point nearest to `x`. The others still take away the edges that
    /// they share with them: where one of them is closer than such an edge, `x` has no projection onto it.
    pub fn closest_of(
        &self,
        x: &Vec3,
        reach: f64,
        warm: Option<(u32, [f64; 2])>,
        admission: &dyn Admission<P>,
    ) -> Option<Projection> {
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        let kept = warm.and_then(|(id, _)| self.index(id));
        let start = warm.map(|(_, xi)| xi);
        let mut search = Search::new(self, x, reach, kept, Question::Contact, admission);
        search.run(start);
        if search.is_doubtful() {
            search = Search::new(self, x, reach, kept, Question::WaryContact, admission);
            search.run(start);
        }
        search.answer()
    }

    /// The point of contact on the piece `id` alone, with the extension that its edges allow; the search begins at the
    /// parameters `start`. `None` beyond that.
    pub fn on_piece(&self, x: &Vec3, id: u32, start: [f64; 2]) -> Option<Projection> {
        let k = self.index(id)?;
        let piece = &self.pieces[k];
        let (foot, _) = piece.settle(x, piece.core(self.extent(k), x, Some(start), f64::INFINITY))?;
        (foot.limits == 0).then(|| on_surface(piece, x, &foot))
    }

    /// The point of contact on the piece of the last projection `warm` and its extension, where `found` is across a kink: as
    /// long as the gaps differ by no more than [`Self::kink`] and the normals by no more than the controls say.
    pub fn stays(
        &self,
        x: &Vec3,
        warm: Option<(u32, [f64; 2])>,
        found: &Projection,
        (planar, controls): (bool, &Controls),
    ) -> Option<Projection> {
        let (id, xi) = warm.filter(|(id, _)| *id != found.patch)?;
        let most = self.kink(id, (planar, controls));
        let same = |p: &Projection| {
            (p.gap - found.gap).abs() <= most && p.normal.dot(&found.normal) >= 1.0 - controls.kink_turn
        };
        self.on_piece(x, id, xi).filter(same)
    }

    /// How much the gap of a node that keeps to its piece at a kink may differ from that on the other side, a length; `planar` pieces are
    /// of a layer.
    pub fn kink(&self, id: u32, (planar, controls): (bool, &Controls)) -> f64 {
        controls.kink_gap * self.get(id).map_or(0.0, |piece| shortest_edge(piece, planar))
    }

    /// Where `x`, whose point of contact is `at`, is exactly between pieces: the projections onto all of them, by rising id, with the
    /// angles that they fill there. One next to an edge where it is not, or on the edge that ends the surface; none farther from
    /// an edge, or where it is between them no more.
    pub fn evenly(&self, x: &Vec3, at: &Projection, even: &Even) -> Vec<(Projection, f64)> {
        let mut found = match even.kept {
            Some(kept) => self.kept(x, at, kept),
            None => self.nearest_evenly(x, at, even),
        };
        found.retain(|(p, _)| even.joins(&p.normal, &at.normal));
        let lacks = even.kept.is_some_and(|kept| found.len() < kept.len());
        if lacks || !found.iter().any(|(p, _)| p.patch == at.patch) {
            return Vec::new();
        }
        found.sort_by_key(|(p, _)| p.patch);
        found
    }

    /// Those of the pieces that are the nearest.
    fn nearest_evenly(&self, x: &Vec3, at: &Projection, even: &Even) -> Vec<(Projection, f64)> {
        let Some(k) = self.index(at.patch) else { return Vec::new() };
        let piece = &self.pieces[k];
        let beside = BESIDE + ASIDE * (-at.gap).max(0.0) / shortest_edge(piece, even.planar);
        if piece.sides(at.xi)[..piece.count()].iter().all(|side| *side > beside) {
            return Vec::new();
        }
        let near = search::KEEP * self.largest;
        if at.gap.abs() <= near {
            // Whether it is inside or outside is rounding.
            return self.sides_of(x, (&piece.point(piece.clamp(at.xi)), near), EXTENSION).collect();
        }
        let all = |_: &P, _: &Foot| true;
        let mut search = Search::new(self, x, even.reach, Some(k), Question::Even, &all);
        search.run(Some(at.xi));
        match (search.even(), even.extension) {
            (Ok(found), _) => found,
            (Err(_), None) => Vec::new(),
            (Err(edge), Some(extension)) => {
                let mut sides: Vec<_> = self.sides_of(x, (&edge, TOUCH * self.largest), extension).collect();
                let farthest = sides.iter().map(|(p, _)| p.gap).fold(f64::NEG_INFINITY, f64::max);
                sides.retain(|(p, _)| farthest - p.gap <= near);
                sides
            }
        }
    }

    /// The points of `x` on given pieces or their extensions, in this order, where any two of the pieces make a hollow: over their
    /// kink, of no more than `turn`, 1 - cosine, their normals lean towards each other. Otherwise none.
    pub fn hollow(&self, x: &Vec3, ids: &[u32], turn: f64) -> Vec<Projection> {
        let on = |id: &u32| {
            let piece = self.get(*id)?;
            Some((extended(piece, x, EXTENSION, piece.center())?, piece.point(piece.center())))
        };
        let found: Vec<_> = ids.iter().filter_map(on).collect();
        let leans = |[(a, from), (b, to)]: [&(Projection, Vec3); 2]| {
            (to - from).dot(&(b.normal - a.normal)) < 0.0 && a.normal.dot(&b.normal) >= 1.0 - turn
        };
        let all = (0..found.len()).all(|b| (0..b).all(|a| leans([&found[a], &found[b]])));
        if all && found.len() == ids.len() { found.into_iter().map(|(at, _)| at).collect() } else { Vec::new() }
    }

    /// Those of given pieces, or of their extensions, that are as near as `at`, which is on one of them.
    fn kept(&self, x: &Vec3, at: &Projection, kept: &[u32]) -> Vec<(Projection, f64)> {
        let near = search::KEEP * self.largest;
        let on = |id: &u32| {
            let piece = self.get(*id)?;
            if *id == at.patch {
                return Some((*at, search::angle(piece, piece.clamp(at.xi))));
            }
            let found = extended(piece, x, EXTENSION, piece.center())?;
            let is_even = (found.gap - at.gap).abs() <= near;
            is_even.then(|| (found, search::angle(piece, piece.clamp(found.xi))))
        };
        kept.iter().filter_map(on).collect()
    }

    /// For `x` outside a sharp edge or corner, on which its point of contact `at` lies: the projection onto the piece
    /// around it, extended by so much of its own parameters, whose side `x` is farthest from. `None` when `at` is on no such
    /// edge, or too far away.
    pub fn beside_edge(&self, x: &Vec3, at: &Projection, extension: f64) -> Option<Projection> {
        let own = self.get(at.patch)?;
        if at.gap <= 0.0 || own.overshoot(at.xi) > 0.0 || own.normal(at.xi).dot(&at.normal) > ALIGNED {
            return None;
        }
        let sides = self.sides_of(x, (&at.point, TOUCH * self.largest), extension).map(|(p, _)| p);
        sides.max_by(|a, b| a.gap.total_cmp(&b.gap).then(b.patch.cmp(&a.patch)))
    }

    /// The projections onto the pieces around a point of an edge or corner, within a distance of it, extended by so much, and the
    /// angles that they fill there.
    fn sides_of(
        &self,
        x: &Vec3,
        (edge, touch): (&Vec3, f64),
        extension: f64,
    ) -> impl Iterator<Item = (Projection, f64)> {
        let around = Vec3::repeat(touch);
        self.tree.meeting(&(edge - around), &(edge + around)).filter_map(move |(k, _)| {
            let (piece, extent) = (&self.pieces[k], self.extent(k));
            let core = piece.core(extent, edge, None, touch);
            let found = if core.distance <= touch { extended(piece, x, extension, core.xi) } else { None }?;
            Some((found, search::angle(piece, core.xi)))
        })
    }

    /// Whether the point of contact `at` of `x` is past an end of the surface by more than `aside`, on the extension of its piece.
    pub fn is_past_end(&self, x: &Vec3, at: &Projection, aside: f64) -> bool {
        self.index(at.patch).filter(|&k| self.pieces[k].is_beyond(at.xi)).is_some_and(|k| {
            let core = self.pieces[k].core(self.extent(k), x, Some(at.xi), f64::INFINITY);
            self.pieces[k].is_end(&core) && (core.local.point - at.point).norm() > aside
        })
    }

    /// Perpendiculars from `x` to all pieces, no longer than `most`; they may miss a piece by a distance of `aside`.
    pub fn perpendiculars(&self, x: &Vec3, most: f64, aside: f64) -> Vec<Projection> {
        let around = Vec3::repeat(most);
        let perpendicular = |k: u32| {
            let (piece, extent) = (&self.pieces[k as usize], self.extent(k as usize));
            let core = piece.core(extent, x, None, most + aside);
            let is_near = |at: &Projection| at.gap.abs() <= most && (at.point - core.local.point).norm() <= aside;
            extended(piece, x, EXTENSION, core.xi).filter(is_near)
        };
        self.within(&(x - around), &(x + around)).into_iter().filter_map(perpendicular).collect()
    }

    /// The normal projection alone: piece, parameters and gap of the foot of a perpendicular with the least |gap| up to
    /// `reach`, among the minima of the distance inside the pieces, which reach over their edges by `extension` of
    /// their parameters. `None` in a dead zone.
    pub fn normal_projection(&self, x: &Vec3, extension: f64, reach: f64) -> Option<(u32, [f64; 2], f64)> {
        if !x.iter().all(|x| x.is_finite()) {
            return None;
        }
        // The boxes of the pieces need not hold their extensions.
        let margin = 4.0 * extension * self.largest;
        let (mut best, mut least) = (None, reach);
        self.tree.approach(x, least + margin, |k| {
            if let Some((xi, gap)) = self.pieces[k].perpendicular(self.extent(k), x, extension) {
                let id = self.pieces[k].id();
                if gap.abs() < least || gap.abs() == least && best.is_none_or(|(other, _, _)| id < other) {
                    (best, least) = (Some((id, xi, gap)), gap.abs());
                }
            }
            least + margin
        });
        best
    }

    fn extent(&self, index: usize) -> &Extent {
        self.extents[index].get_or_init(|| Extent::new(&self.pieces[index]))
    }

    fn index(&self, id: u32) -> Option<usize> {
        self.pieces.binary_search_by_key(&id, Piece::id).ok()
    }
}

/// The projection of `x` onto a piece extended by so much of its parameters, from `start` on; `None` beyond that.
fn extended<P: Piece>(piece: &P, x: &Vec3, extension: f64, start: [f64; 2]) -> Option<Projection> {
    let foot = descend(piece, x, &[extension; 4], start);
    (foot.limits == 0).then(|| on_surface(piece, x, &foot))
}

/// The projection of `x` onto a piece at a foot that is on no edge.
fn on_surface<P: Piece>(piece: &P, x: &Vec3, foot: &Foot) -> Projection {
    let (gap, normal, normal_gradient) = piece.on_surface(x, foot);
    Projection { gap, point: foot.local.point, normal, normal_gradient, patch: piece.id(), xi: foot.xi }
}

/// The shortest edge, between corners.
fn shortest_edge<P: Piece>(piece: &P, planar: bool) -> f64 {
    let count = piece.count();
    let corners = piece.corners(&[0.0; 4]).map(|xi| piece.point(xi));
    shortest((0..count).map(|k| corners[(k + 1) % count] - corners[k]), planar)
}

/// The shortest of some edges. Those of no length, at poles, do not count, nor those across a layer: how wide that is says nothing.
pub fn shortest(edges: impl Iterator<Item = Vec3> + Clone, planar: bool) -> f64 {
    const NONE: f64 = 1e-6;
    let lengths = edges.map(|edge| if planar { edge.xy().norm() } else { edge.norm() });
    let longest = lengths.clone().fold(0.0, f64::max);
    lengths.filter(|length| *length > NONE * longest).fold(longest, f64::min)
}

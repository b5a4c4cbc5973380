//! Contact from segment to segment: the slave's faces are kept out of the master in the mean around each slave node.
//!
//! Each slave node i has one multiplier and the [law](super::law) of contact, as from node to surface. What it meets is not its
//! own closest point, but that of all integration points q of the faces around it, each on the master by the same projection
//! (Puso and Laursen, A mortar segment-to-segment contact method for large deformation solid mechanics, Comput. Methods Appl.
//! Mech. Engrg. 193, 2004, on smooth masters):
//!
//! ```text
//!     w_iq = w_q N_i(ξ_q) / Σ_q w_q N_i(ξ_q)
//!     g_i = Σ_q w_iq g_q      n_i = Σ_q w_iq n_q / |Σ_q w_iq n_q|      Δ_i = Σ_q w_iq (x̄_q - x̃_q)            (1)
//!     f_iq = w_iq (F_n n_q + F_t)    with F_n = F·n_i,  F_t = F - F_n n_i                                  (2)
//! ```
//!
//! with the shape functions N of the face, of which x_q = Σ_a N_a(ξ_q) x_a. The force f_iq acts on the master at x̄_q and its
//! opposite on the slave at x_q, so that forces add up to nothing; so do moments without friction, for f_iq is along x_q - x̄_q,
//! and with friction but for F_t g_q. Without friction f_iq is the derivative of λ_n g_i at weights that stand still. As a
//! pressure p makes the multipliers p ∫ N_i dA, which make p w_q in the points, unlike meshes pass an even pressure on as exactly
//! as the points integrate:
//!
//! - On a body they are those of the overlap of slave and master faces in the mean plane of the slave face ([`crate::mortar`]),
//!   exact for flat faces that are parallelograms or triangles, and more of them for others. The faces only say where the points
//!   are; they are projected onto the master's smooth surface then.
//! - On a tool they are Gauss points of the slave faces; of a face over its end, of what of that is over it: of triangles from
//!   its middle to its corners and the middles of its edges, cut where their edges pass the end.
//!
//! Weights count areas of the initial mesh, of axisymmetric bodies those of rings: so they stand still on a whole face
//! over a tool, where the tangent is exact. On a body, and over an end, points and weights are found anew at each
//! iterate, and stand still in the tangent. What they have in common is integrated whatever the overlap, so that only the
//! error of the rule is left out; yet that makes convergence linear, by a factor of some hundredths. So they are kept
//! from where little is left of the residual.
//!
//! The faces around a node at a sharp edge of the slave's initial mesh, as of the top and of a side of a block, are two fans, of
//! which the one whose mean gap is the least counts, with its points alone. A side would keep its edge off the tool that presses the
//! top by the gaps up its height, as soon as it bulges out so that it sees the tool at all. Which of both is nearer changes only
//! where both are as near.
//!
//! Slip of a point counts from where the same point of the slave was on the master at the last converged increment, as both
//! were then: no point has a history. Points that nothing of the master is opposite to do not count; a fan of which less than
//! `segment_least` of the [controls](crate::controls) of what belongs to a node is left does not either, of a node that touches less
//! than half of that, and a node without any is in the gap.
//!
//! Where the master is smooth, the slave is, too: its flat faces would stand out of a hollow round one, and be pressed back with
//! nothing to press, and lack what a bulging one has. The gap of a point is that of the Nagata patch over its face, of which
//! c_k is the coefficient of edge k and n the face's normal,
//!
//! ```text
//!     g_q = (x_q - x̄_q)·n̄_q - h(ξ_q)      h = -Σ_k c_k·n φ_k(ξ)                                          (3)
//!     φ = (ηʹζʹη, ηζζʹ, ηηʹζ, ηʹζζʹ) with ηʹ = 1 - η, ζʹ = 1 - ζ;      of a triangle (b₀b₁, b₁b₂, b₂b₀)
//! ```
//!
//! as it is in the initial mesh, or as it is deformed (`slave_curvature`), by nodal normals that follow the nodes as those of a
//! master do. Then it is found anew with the points, and kept where these are: it stands still in the tangent. No force goes to the
//! nodes that it depends on, which would be uneven at the ends of the surface. Under a master of facets it is left out.
//!
//! A face of six or nine nodes is four pieces, each a face here: on these the N_i of the multipliers are linear, with a positive
//! integral at each node; the point itself is x_q = Σ_a N_a(ξ_q) x_a with the functions of all nodes, which also share f_iq and
//! make areas, over the chord of the piece in which the overlap is cut (Puso, Laursen and Solberg, Comput. Methods Appl. Mech.
//! Engrg. 197, 2008). It has the shape of its nodes, and no height (3).
//!
//! A surface that meets itself has all of its nodes as slaves, and all of its faces on both sides. A face avoids what the nodes at
//! its corners do ([`crate::contact::self_contact`]), and what overlaps it behind the nearest sheet does not count. The means of
//! both sides make one condition about twice: they give way, by `slack_segments`. With one side as the slave alone, that which looks
//! more to one side, a strip that closes takes half the iterations with friction, and finds no increments without.
//!
//! The functions of the multipliers are the N_i themselves, which are positive, as is each w_iq. Dual functions, which are
//! not, leave the chatter of the ironing with a rigid indenter as it is, and with an elastic one the iteration goes to and fro.
//! So do more Gauss points than 3 by 3 on a tool leave it.
//!
//! - here: the faces around the slave nodes of a rank
//! - [`ends`]: where tools end
//! - [`points`]: integration points, and what a slave node meets

pub mod ends;
pub mod points;

pub use points::{Point, Segments, Share};

use super::Slave;
use super::body_surface::{gather, shape_at, stencil};
use crate::mortar::face::{MOST, bilinear};
use crate::mortar::rule::{on_line, on_triangle};
use crate::mortar::{self, Corners};
use crate::partition::{Gather, Part, PartFacet};
use crate::surface::{MovingPatch, Patch};
use crate::{Vec2, Vec3};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeSet;

/// Gauss points along a side of a face, on a tool.
const POINTS: usize = 3;

/// Where a rule has a point in a face, by the functions of its corners, and its part of the initial area.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    pub shapes: [f64; 4],
    pub weight: f64,
}

/// The nodes that move a point of a face, with their shape functions there.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    count: usize,
    nodes: [u32; MOST],
    shapes: [f64; MOST],
}

impl Moved {
    /// The place of a node.
    pub fn with(node: u32) -> Self {
        let (mut nodes, mut shapes) = ([0; MOST], [0.0; MOST]);
        (nodes[0], shapes[0]) = (node, 1.0);
        Self { count: 1, nodes, shapes }
    }

    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.count]
    }

    pub fn shapes(&self) -> &[f64] {
        &self.shapes[..self.count]
    }

    /// Where the point is with the nodes at these places.
    fn of(&self, places: &[Vec3; MOST]) -> Vec3 {
        places.iter().zip(self.shapes()).map(|(x, shape)| x * *shape).sum()
    }
}

/// A slave face, or one of the four pieces of a quadratic one, on corners and middles of its edges.
#[derive(Clone, Debug)]
pub struct Face {
    /// All of it, with local nodes.
    all: mortar::Face,
    /// Which of these are the corners.
    piece: Corners<usize>,
    /// That of its facet in the set.
    number: u64,
    /// Local nodes at its corners.
    pub corners: Corners<u32>,
    /// Those whose displacements they have.
    pub nodes: [u32; 4],
    /// Those that all nodes have.
    movers: [u32; MOST],
    /// In its mean plane, of the initial mesh.
    area: f64,
    /// Its unit normal there.
    outward: Vec3,
    /// Where all nodes are there.
    places: [Vec3; MOST],
    /// What parts of the area count by at the corners: 1, or the radius.
    measure: [f64; 4],
    spots: Vec<Spot>,
    /// The integrals of the functions of the corners.
    whole: [f64; 4],
    /// How far it bulges in the initial mesh, a length: what its edges' coefficients in (3) are along its normal.
    bulge: [f64; 4],
    /// How far a quadratic one is from being flat, with functions that are polynomials there: a length.
    bent: f64,
}

/// The faces around the owned nodes of a slave surface.
#[derive(Clone, Debug)]
pub struct Faces {
    faces: Vec<Face>,
    /// The slave nodes of the pair.
    nodes: Vec<u32>,
    /// By these those around it, between the sharp edges of the initial mesh.
    fans: Vec<Vec<Vec<u32>>>,
    /// The patches over them, where they bulge as they are deformed.
    over: Option<Over>,
}

/// The patches over the faces of a slave.
#[derive(Clone, Debug)]
struct Over {
    /// By face.
    patches: Vec<MovingPatch>,
    /// Indices of the stencil of each among the nodes.
    stencils: Vec<Vec<u32>>,
    nodes: Gather,
}

impl Over {
    fn heights(&self, comm: &SimpleCommunicator, place: impl Fn(u32) -> Vec3) -> Vec<[f64; 4]> {
        let positions = gather(comm, &self.nodes, place);
        let of_face = |(patch, stencil): (&MovingPatch, &Vec<u32>)| heights(&shape_at(patch, &positions, stencil));
        self.patches.iter().zip(&self.stencils).map(of_face).collect()
    }
}

/// How far the edges of a smooth face bulge out of its body, by their coefficients in (3) of the [module](self).
pub fn heights(shape: &Patch) -> [f64; 4] {
    let outward = Corners::new(&shape.nodes[..shape.count as usize]).area_vector().normalize();
    shape.coefficients.map(|c| -c.dot(&outward))
}

impl Face {
    /// The piece of a face with these corners, whose initial area counts by the `measure` at them.
    fn new(part: &Part, (number, all): (u64, mortar::Face), piece: Corners<usize>, is_ring: bool) -> Self {
        let corners = piece.map(|k| all.nodes[k]);
        let nodes = corners.x.map(|n| part.tie[n as usize]);
        let at = |k: usize| all.nodes.get(k).map(|&n| n as usize);
        let places: [Vec3; MOST] = std::array::from_fn(|k| at(k).map_or(Vec3::zeros(), |n| part.points[n]));
        let movers = std::array::from_fn(|k| at(k).map_or(0, |n| part.tie[n]));
        let measure = piece.x.map(|k| if is_ring { places[k].x } else { 1.0 });
        let flat = piece.map(|k| places[k]).area_vector();
        let mut face = Self {
            bent: if all.is_quadratic() { bent(&all, &places) } else { 0.0 },
            all,
            piece,
            number,
            corners,
            nodes,
            movers,
            area: flat.norm(),
            outward: flat.normalize(),
            places,
            measure,
            spots: Vec::new(),
            whole: [0.0; 4],
            bulge: [0.0; 4],
        };
        face.spots = face.rule(&places);
        face.whole = integrals(&face.spots);
        face
    }

    /// The nodes that move its corners.
    fn corner_nodes(&self) -> &[u32] {
        &self.nodes[..self.corners.count]
    }

    /// What moves the point with these functions of its corners.
    fn moved(&self, shapes: &[f64; 4]) -> Moved {
        let count = self.all.nodes.len();
        let shapes = match self.all.is_quadratic() {
            true => self.all.shapes(&self.all.local(&self.piece, shapes))[0],
            false => std::array::from_fn(|k| shapes.get(k).copied().unwrap_or(0.0)),
        };
        Moved { count, nodes: self.movers, shapes }
    }

    /// All of its nodes.
    fn at(&self, place: impl Fn(u32) -> Vec3) -> [Vec3; MOST] {
        std::array::from_fn(|k| self.all.nodes.get(k).map_or(Vec3::zeros(), |&n| place(n)))
    }

    /// A point at parameters, on quadrilaterals from 0 to 1 along two edges, on triangles the functions of the second and third
    /// corner, with what a `weight` in these is of the face with its nodes at these places.
    fn spot(&self, places: &[Vec3; MOST], xi: &Vec2, weight: f64) -> Spot {
        let shapes = match self.piece.count {
            3 => [1.0 - xi.x - xi.y, xi.x, xi.y, 0.0],
            _ => bilinear(xi)[0],
        };
        let density = self.area_at(places, &shapes).norm();
        Spot { shapes, weight: weight * density * mean(&shapes, &self.measure) }
    }

    /// The cross product of the derivatives of the place along the parameters.
    fn area_at(&self, places: &[Vec3; MOST], shapes: &[f64; 4]) -> Vec3 {
        if !self.all.is_quadratic() {
            return self.piece.map(|k| places[k]).area_at(shapes);
        }
        let [_, by_s, by_t] = self.all.shapes(&self.all.local(&self.piece, shapes));
        let sum = |by: &[f64; MOST]| places.iter().zip(by).map(|(x, by)| x * *by).sum::<Vec3>();
        // A piece has a quarter of the parameters.
        0.25 * sum(&by_s).cross(&sum(&by_t))
    }

    /// What the initial face has of area where its chord has one, as seen along its normal.
    fn over_chord(&self, shapes: &[f64; 4]) -> f64 {
        match self.all.is_quadratic() {
            true => {
                let chord = self.piece.map(|k| self.places[k]).area_at(shapes).dot(&self.outward);
                self.area_at(&self.places, shapes).norm() / chord
            }
            false => 1.0,
        }
    }

    /// Gauss points.
    fn rule(&self, places: &[Vec3; MOST]) -> Vec<Spot> {
        let line = on_line(POINTS);
        let mut spots = Vec::new();
        let mut add = |xi: Vec2, weight: f64| spots.push(self.spot(places, &xi, weight));
        if self.piece.count == 3 {
            on_triangle(&line, &[Vec2::zeros(), Vec2::x(), Vec2::y()], add);
        } else {
            line.iter().for_each(|[s, a]| line.iter().for_each(|[t, b]| add(Vec2::new(*s, *t), a * b)));
        }
        spots
    }

    /// Its unit normal where a node of its corners is, in the initial mesh; of linear faces that of the whole.
    fn normal_at(&self, node: u32) -> Vec3 {
        let corner = self.corner_nodes().iter().position(|n| *n == node);
        let of_corner = |k: usize| self.area_at(&self.places, &std::array::from_fn(|l| f64::from(l == k)));
        let area = corner.filter(|_| self.all.is_quadratic()).map(of_corner);
        area.and_then(|area| area.try_normalize(f64::MIN_POSITIVE)).unwrap_or(self.outward)
    }

    /// Whether it shares an edge at a node with another one, over which both go on as one surface within an angle whose cosine is
    /// `flat`.
    fn goes_on(&self, other: &Self, node: u32, flat: f64) -> bool {
        let ends = |face: &Self| {
            let nodes = face.corner_nodes();
            let beside = |k: usize| [nodes[(k + 1) % nodes.len()], nodes[(k + nodes.len() - 1) % nodes.len()]];
            (0..nodes.len()).filter(|&k| nodes[k] == node).flat_map(beside).collect::<Vec<u32>>()
        };
        let theirs = ends(other);
        self.normal_at(node).dot(&other.normal_at(node)) >= flat && ends(self).iter().any(|end| theirs.contains(end))
    }

    /// How far the smooth face with such coefficients bulges over the flat one, (3) of the [module](self).
    fn height(&self, [h0, h1, h2, h3]: [f64; 4], shapes: &[f64; 4]) -> f64 {
        let &[b0, b1, b2, b3] = shapes;
        if self.corners.count == 3 {
            return h0 * b0 * b1 + h1 * b1 * b2 + h2 * b2 * b0;
        }
        let (e, z) = (b1 + b2, b2 + b3);
        let (f, y) = (1.0 - e, 1.0 - z);
        (h0 * y + h2 * z) * e * f + (h3 * f + h1 * e) * z * y
    }

    /// Gauss points of the part of it that `sees` the master, by shape functions, of which `corners` do; `line` as of [`on_line`].
    fn part(&self, corners: &[bool], line: &[[f64; 2]], sees: impl Fn(&[f64; 4]) -> bool) -> Vec<Spot> {
        /// Halvings of an edge that passes the end, to rounding of places.
        const HALVINGS: usize = 32;
        let sees = |xi: &Vec2| sees(&self.spot(&self.places, xi, 0.0).shapes);
        let places = match self.corners.count {
            3 => &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]][..],
            _ => &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        };
        let corners: Vec<(Vec2, bool)> =
            places.iter().zip(corners).map(|(xi, sees)| (Vec2::from(*xi), *sees)).collect();
        let with = |xi: Vec2| (xi, sees(&xi));
        let count = corners.len();
        let middle = with(corners.iter().map(|(xi, _)| xi).sum::<Vec2>() / count as f64);
        let around = |k: usize| [corners[k], with((corners[k].0 + corners[(k + 1) % count].0) * 0.5)];
        let rim: Vec<(Vec2, bool)> = (0..count).flat_map(around).collect();
        let end = |mut seen: Vec2, mut unseen: Vec2| {
            for _ in 0..HALVINGS {
                let half = (seen + unseen) * 0.5;
                *if sees(&half) { &mut seen } else { &mut unseen } = half;
            }
            seen
        };
        let mut spots = Vec::new();
        for k in 0..rim.len() {
            let triangle = [middle, rim[k], rim[(k + 1) % rim.len()]];
            let mut part = Vec::new();
            for ((a, sees_a), (b, sees_b)) in (0..3).map(|k| (triangle[k], triangle[(k + 1) % 3])) {
                part.extend(sees_a.then_some(a));
                part.extend(match (sees_a, sees_b) {
                    (true, false) => Some(end(a, b)),
                    (false, true) => Some(end(b, a)),
                    _ => None,
                });
            }
            for [b, c] in part.array_windows().skip(1) {
                on_triangle(line, &[part[0], *b, *c], |xi, weight| {
                    spots.push(self.spot(&self.places, &xi, weight));
                });
            }
        }
        spots
    }

    /// The sum of some values at the corners that move as a node.
    fn of_node(&self, node: u32, values: &[f64; 4]) -> f64 {
        (0..self.corners.count).filter(|&a| self.nodes[a] == node).map(|a| values[a]).sum()
    }
}

impl Faces {
    /// Whether all nodes of one of them are among these.
    pub fn any_of(&self, nodes: &BTreeSet<u32>) -> bool {
        self.faces.iter().any(|face| face.nodes.iter().all(|node| nodes.contains(node)))
    }

    /// Those of the facets of a set that touch the slaves, which are in the order of their nodes; turned about the axis they are
    /// rings. Edges are sharp from `feature_angle` on, degrees.
    pub fn new(part: &Part, facets: &[PartFacet], slaves: &[Slave], (is_ring, feature_angle): (bool, f64)) -> Self {
        let (mut faces, mut around) = (Vec::new(), vec![Vec::new(); slaves.len()]);
        for facet in facets {
            let all = part.face_nodes(facet);
            for piece in part.pieces(std::slice::from_ref(facet)).iter() {
                let all = mortar::Face { nodes: all.to_vec(), pieces: Vec::new() };
                let piece = all.piece(&piece.nodes[..piece.count as usize]);
                let face = Face::new(part, (facet.number, all), piece, is_ring);
                let mut touched: Vec<usize> = face
                    .corner_nodes()
                    .iter()
                    .filter_map(|node| slaves.binary_search_by_key(node, |slave| slave.node).ok())
                    .collect();
                touched.sort_unstable();
                touched.dedup();
                touched.iter().for_each(|&s| around[s].push(faces.len() as u32));
                if !touched.is_empty() {
                    faces.push(face);
                }
            }
        }
        let flat = feature_angle.to_radians().cos();
        let fans = |(slave, all): (&Slave, Vec<u32>)| {
            fans(all, |a, b| faces[a as usize].goes_on(&faces[b as usize], slave.node, flat))
        };
        let fans = slaves.iter().zip(around).map(fans).collect();
        Self { faces, nodes: slaves.iter().map(|slave| slave.node).collect(), fans, over: None }
    }

    /// Lets them bulge as the patches over them, those of all facets of the set in their order: in the initial mesh, or as they
    /// `follow` their nodes. Collective.
    pub fn bulge_as(&mut self, comm: &SimpleCommunicator, part: &Part, patches: &[MovingPatch], follow: bool) {
        let patches: Vec<MovingPatch> = self.faces.iter().map(|face| patches[face.number as usize].clone()).collect();
        let nodes = Gather::new(comm, &part.starts, patches.iter().flat_map(|patch| patch.nodes.iter().copied()));
        let stencils = patches.iter().map(|patch| stencil(patch, &nodes)).collect();
        let over = Over { patches, stencils, nodes };
        for (face, bulge) in self.faces.iter_mut().zip(over.heights(comm, |n| part.points[n as usize])) {
            face.bulge = bulge;
        }
        self.over = follow.then_some(over);
    }

    /// Whether they bulge as they are deformed.
    pub fn follow_nodes(&self) -> bool {
        self.over.is_some()
    }

    /// How far each of them bulges in the initial mesh.
    pub fn as_meshed(&self) -> Vec<[f64; 4]> {
        self.faces.iter().map(|face| face.bulge).collect()
    }

    /// How far each of them bulges with owned nodes at `place`. Collective.
    pub fn heights(&self, comm: &SimpleCommunicator, place: impl Fn(u32) -> Vec3) -> Vec<[f64; 4]> {
        self.over.as_ref().map_or_else(|| self.as_meshed(), |over| over.heights(comm, place))
    }

    /// The nodes at the corners of each of them.
    pub fn corners(&self) -> impl Iterator<Item = &[u32]> {
        self.faces.iter().map(Face::corner_nodes)
    }

    /// The faces around a slave node.
    pub fn around(&self, slave: usize) -> impl Iterator<Item = &Face> + Clone {
        self.fans[slave].iter().flatten().map(|&f| &self.faces[f as usize])
    }

    /// Adds what of the area of all faces, with their nodes at `place`, belongs to the nodes that their corners move with, and where
    /// the face looks.
    pub fn add_areas(&self, place: impl Fn(u32) -> Vec3, mut add: impl FnMut(u32, f64, &Vec3)) {
        for face in &self.faces {
            let of_corners = face.nodes.iter().zip(integrals(&face.rule(&face.at(&place)))).take(face.piece.count);
            of_corners.for_each(|(&node, area)| add(node, area, &face.outward));
        }
    }

    /// Adds what of the force on a slave node the nodes around it have, each as the integrals with its function. At a sharp edge
    /// the fan that looks at the force has it.
    pub fn spread(&self, slave: usize, force: &Vec3, mut add: impl FnMut(u32, Vec3)) {
        let facing = |fan: &&Vec<u32>| {
            let outward: Vec3 = fan.iter().map(|&f| &self.faces[f as usize]).map(|face| face.outward * face.area).sum();
            -outward.dot(force) / outward.norm()
        };
        let fans = self.fans[slave].iter().filter(|_| *force != Vec3::zeros());
        let Some(fan) = fans.max_by(|a, b| facing(a).total_cmp(&facing(b))) else { return };
        let faces = || fan.iter().map(|&f| &self.faces[f as usize]);
        let node = self.nodes[slave];
        let whole: f64 = faces().map(|face| face.of_node(node, &face.whole)).sum();
        for face in faces() {
            for spot in &face.spots {
                let share = force * (spot.weight * face.of_node(node, &spot.shapes) / whole);
                let corners = face.nodes.iter().zip(spot.shapes).take(face.piece.count);
                corners.for_each(|(&node, shape)| add(node, share * shape));
            }
        }
    }

    /// The nodes that move a slave node's faces; some more than once.
    pub fn beside(&self, slave: usize) -> impl Iterator<Item = u32> + '_ {
        self.around(slave).flat_map(|face| face.movers[..face.all.nodes.len()].iter().copied())
    }
}

/// Some faces in groups, in which each is connected with the others.
fn fans(mut faces: Vec<u32>, connected: impl Fn(u32, u32) -> bool) -> Vec<Vec<u32>> {
    let mut fans = Vec::new();
    while !faces.is_empty() {
        let mut fan = vec![faces.remove(0)];
        let mut k = 0;
        while k < fan.len() {
            let (with, without) = faces.into_iter().partition(|&other| connected(fan[k], other));
            fan.extend::<Vec<u32>>(with);
            faces = without;
            k += 1;
        }
        fan.sort_unstable();
        fans.push(fan);
    }
    fans
}

/// What shape functions make of values at corners; none counts of corners that do not.
fn mean(shapes: &[f64; 4], values: &[f64; 4]) -> f64 {
    shapes.iter().zip(values).map(|(shape, value)| shape * value).sum()
}

/// The integrals of the functions of corners.
fn integrals(spots: &[Spot]) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for spot in spots {
        sums.iter_mut().zip(spot.shapes).for_each(|(sum, shape)| *sum += spot.weight * shape);
    }
    sums
}

/// How far the nodes of a quadratic face are from where its first three corners put them as those of a flat one, whose functions are
/// polynomials in its plane.
fn bent(all: &mortar::Face, places: &[Vec3; MOST]) -> f64 {
    let corners = all.corners().count;
    let [a, b, last] = [places[0], places[1], places[corners - 1]];
    let off = |k: usize| {
        let at = all.parameters(k);
        (places[k] - (a + (b - a) * at.x + (last - a) * at.y)).norm()
    };
    (0..all.nodes.len()).map(off).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mortar::{MeanPlane, overlap};
    use crate::surface::Edge;

    /// The height over the flat face is that of the patch, along its normal.
    #[test]
    fn a_face_bulges_as_its_patch() {
        let nodes = [[0.0, 0.0, 0.0], [2.0, 0.1, 0.0], [2.2, 1.3, 0.0], [-0.1, 1.0, 0.0]].map(Vec3::from);
        let coefficients = [[0.0, 0.1, -0.4], [0.2, 0.0, -0.1], [0.0, 0.0, 0.3], [0.1, 0.0, -0.2]].map(Vec3::from);
        for count in [3, 4] {
            let flat = Patch {
                id: 0,
                count: count as u8,
                nodes,
                coefficients: [Vec3::zeros(); 4],
                middle: Vec3::zeros(),
                edges: [Edge::Boundary; 4],
                on_boundary: [true; 4],
                deviation: 0.0,
            };
            let mut patch = flat;
            patch.coefficients[..count].copy_from_slice(&coefficients[..count]);
            let part = Part { points: nodes.to_vec(), tie: vec![0, 1, 2, 3], ..Part::default() };
            let all = mortar::Face { nodes: (0..count as u32).collect(), pieces: Vec::new() };
            let piece = Corners::new(&[0, 1, 2, 3][..count]);
            let face = Face::new(&part, (0, all), piece, false);
            for [e, z] in [[0.3, 0.2], [0.7, 0.4], [0.9, 0.9], [0.0, 0.0], [1.0, 0.5]] {
                let shapes = match count {
                    3 => [1.0 - e, e - z, z, 0.0],
                    _ => bilinear(&Vec2::new(e, z))[0],
                };
                let height = (patch.point([e, z]) - flat.point([e, z])).z;
                assert!((face.height(heights(&patch), &shapes) - height).abs() < 1e-14, "{count} {e} {z}");
            }
        }
    }

    /// Pieces of quadratic faces have the area of the whole; over their chords, cut as what the master covers, too.
    #[test]
    fn pieces_have_the_area_of_their_face() {
        let bent =
            |s: f64, t: f64| Vec3::new(s + 0.1 * s * t, t - 0.08 * s * s, 0.2 * s * s - 0.15 * s * t + 0.1 * t * t);
        let whole = [
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.5, 0.0],
            [1.0, 0.5],
            [0.5, 1.0],
            [0.0, 0.5],
            [0.5, 0.5],
        ];
        let of_six = [whole[0], whole[1], whole[3], whole[4], whole[8], whole[7]];
        let quarters = vec![vec![0, 4, 8, 7], vec![1, 5, 8, 4], vec![2, 6, 8, 5], vec![3, 7, 8, 6]];
        let fourths = vec![vec![0, 3, 5], vec![1, 4, 3], vec![2, 5, 4], vec![3, 4, 5]];
        for (places, pieces) in [(&whole[..], quarters), (&of_six[..], fourths)] {
            let points: Vec<Vec3> = places.iter().map(|[s, t]| bent(*s, *t)).collect();
            let count = points.len() as u32;
            let part = Part { points: points.clone(), tie: (0..count).collect(), ..Part::default() };
            let all = mortar::Face { nodes: (0..count).collect(), pieces: Vec::new() };
            let (mut by_rule, mut by_chords) = (0.0, 0.0);
            for piece in pieces {
                let face = Face::new(&part, (0, all.clone()), Corners::new(&piece), false);
                by_rule += face.whole.iter().sum::<f64>();
                let corners = face.corners.map(|n| points[n as usize]);
                let plane = MeanPlane::of(&corners).unwrap();
                let fine = on_line(6);
                let cut = overlap(&plane, &corners, [&fine, &fine]);
                by_chords += cut.iter().map(|p| p.weight * face.over_chord(&p.slave)).sum::<f64>();
                // At its corners the functions are those of the nodes there.
                for (k, &node) in piece.iter().enumerate() {
                    let moved = face.moved(&std::array::from_fn(|l| f64::from(l == k)));
                    let own = moved.nodes().iter().zip(moved.shapes());
                    own.for_each(|(n, shape)| assert!((shape - f64::from(*n == node as u32)).abs() < 1e-15));
                }
                assert!(face.bent > 0.05);
            }
            let line = on_line(12);
            let mut area = 0.0;
            let mut add = |xi: Vec2, weight: f64| {
                let [_, s, t] = all.at(&xi, |n| points[n as usize]);
                area += weight * s.cross(&t).norm();
            };
            match count {
                6 => on_triangle(&line, &[Vec2::zeros(), Vec2::x(), Vec2::y()], add),
                _ => line.iter().for_each(|[s, a]| line.iter().for_each(|[t, b]| add(Vec2::new(*s, *t), a * b))),
            }
            assert!((by_rule / area - 1.0).abs() < 1e-6, "{by_rule} {area}");
            assert!((by_chords / area - 1.0).abs() < 1e-6, "{by_chords} {area}");
        }
    }
}

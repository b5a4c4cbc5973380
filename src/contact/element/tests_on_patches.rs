use super::*;
use crate::contact::law::LAW;
use crate::controls::Controls;
use crate::mesh::Mesh;
use crate::scene::Smoothing;
use crate::surface::projection::{descend, on_edge, on_surface};
use crate::surface::test_meshes::{grid, strip};
use crate::surface::{Patch, Polygon};
use nalgebra::{DMatrix, DVector, Rotation3};

/// Parameters of the slip origin.
const ORIGIN: [f64; 2] = [0.55, 0.31];
const TRANSFERS: [Transfer; 3] = [Transfer::Variational, Transfer::Patch, Transfer::Bilinear];

/// A master with displaced nodes, and a slave node on one of its patches that came from another.
#[derive(Clone)]
struct Pair {
    patches: Vec<MovingPatch>,
    points: Vec<Vec3>,
    now: usize,
    before: usize,
    slave: Vec3,
    /// λ; without friction λ_n first.
    multiplier: Vec3,
    friction: f64,
    inside: bool,
    /// How λ, or σ, enters.
    kind: fn(Vec3) -> Multiplier,
    carried: Vec3,
    /// Of a node that meets a node: where slip counts from, as it was when the nodes of the master were at `then`.
    beside: Option<Vec3>,
    then: Vec<Vec3>,
}

/// Where the foot is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Foot {
    Face,
    Edge,
    Corner,
}

/// A patch with where its nodes stand.
struct Stencil<'a> {
    patch: &'a MovingPatch,
    nodes: Vec<u32>,
    positions: Vec<Vec3>,
}

impl<'a> Stencil<'a> {
    fn new(pair: &'a Pair, patch: usize) -> Self {
        let nodes = pair.patches[patch].nodes.iter().map(|&n| n as u32).collect();
        Self { patch: &pair.patches[patch], nodes, positions: pair.positions(patch) }
    }

    fn site(&self, xi: [f64; 2]) -> Site<'_> {
        Site { patch: self.patch, stencil: &self.nodes, positions: &self.positions, xi }
    }
}

fn noise(k: usize) -> f64 {
    let x = (k as f64 * 12.9898).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

impl Pair {
    fn new(mesh: &Mesh, smoothing: Smoothing, patches: [usize; 2]) -> Self {
        Self::in_planes(mesh, smoothing, patches, &[])
    }

    /// With planes of symmetry.
    fn in_planes(mesh: &Mesh, smoothing: Smoothing, [now, before]: [usize; 2], planes: &[(Vec3, Vec3)]) -> Self {
        let numbers: Vec<u64> = (0..mesh.points.len() as u64).collect();
        let patches = MovingPatch::all(mesh, &numbers, smoothing, 50.0, planes, &Controls::default()).unwrap();
        let mut points: Vec<Vec3> = mesh.points.iter().map(|p| Vec3::from(*p)).collect();
        let mut pair = Self {
            patches,
            points: points.clone(),
            now,
            before,
            slave: Vec3::zeros(),
            multiplier: Vec3::zeros(),
            friction: 0.3,
            inside: false,
            kind: Multiplier::Augmented,
            carried: Vec3::zeros(),
            beside: None,
            then: points.clone(),
        };
        let size = pair.size();
        points.iter_mut().enumerate().for_each(|(i, x)| *x += Vec3::from_fn(|d, _| 0.03 * size * noise(3 * i + d)));
        pair.points = points;
        pair
    }

    /// With triangles of the quadratic shape through nodes near the middles of their edges, and quadrilaterals that are quarters of
    /// faces of nine nodes.
    fn quadratic(mut self) -> Self {
        for k in [self.now, self.before] {
            if self.patches[k].quadratic.is_some() {
                continue;
            }
            let first = self.points.len();
            let (corners, size) = (self.patches[k].nodes.clone(), self.size());
            if let [a, ab, all, da] = corners[..] {
                let [b, c, d, bc, cd] = std::array::from_fn(|k| (first + k) as u64);
                self.patches[k].bend_as_quarter(&[a, b, c, d, ab, bc, cd, da, all]);
                let x = [a, ab, all, da].map(|n| self.points[n as usize]);
                let (along, across) = (x[1] - x[0], x[3] - x[0]);
                let rest = [x[1] + along, x[2] * 2.0 - x[0], x[3] + across, x[2] + along, x[2] + across];
                let off = |(e, x): (usize, Vec3)| x + Vec3::new(0.05, -0.02, 0.1) * (noise(first + e) * size);
                self.points.extend(rest.into_iter().enumerate().map(off));
                continue;
            }
            self.patches[k].bend_through([first, first + 1, first + 2].map(|n| n as u64));
            let (x, size) = (self.positions_of_corners(k), self.size());
            let middle =
                |e: usize| (x[e] + x[(e + 1) % 3]) * 0.5 + Vec3::new(0.05, -0.02, 0.1) * (noise(first + e) * size);
            self.points.extend((0..3).map(middle));
        }
        self
    }

    fn positions_of_corners(&self, patch: usize) -> Vec<Vec3> {
        self.patches[patch].nodes[..3].iter().map(|n| self.points[*n as usize]).collect()
    }

    fn size(&self) -> f64 {
        let nodes = &self.patches[self.now].nodes;
        (self.points[nodes[1] as usize] - self.points[nodes[0] as usize]).norm()
    }

    fn positions(&self, patch: usize) -> Vec<Vec3> {
        self.patches[patch].nodes.iter().map(|n| self.points[*n as usize]).collect()
    }

    fn shape(&self) -> Patch {
        self.patches[self.now].shape(&self.positions(self.now))
    }

    /// Puts the slave node a little off a foot on the face, an edge or a corner of the current patch.
    fn placed(mut self, foot: Foot, inside: bool) -> Self {
        let (patch, size) = (self.shape(), self.size());
        let side = if inside { -1.0 } else { 1.0 };
        let (xi, out) = match foot {
            Foot::Face => ([0.63, 0.27], Vec3::zeros()),
            Foot::Edge => {
                let local = patch.local([0.45, 0.0]);
                ([0.45, 0.0], local.tangents[0].cross(&local.area_vector()).normalize() * 1.5)
            }
            Foot::Corner => {
                let local = patch.local([1.0, 0.0]);
                let away = local.tangents[0].normalize() * 1.5;
                ([1.0, 0.0], away + local.tangents[0].cross(&local.area_vector()).normalize() * 2.0)
            }
        };
        self.slave = patch.point(xi) + (out + patch.normal(xi) * side).normalize() * (0.05 * size);
        self.inside = inside;
        self
    }

    /// Gives the multiplier that makes the node have this status.
    fn with_status(mut self, status: Status) -> Self {
        let (n, path) = (self.projection().normal, self.projection().point - self.origin());
        // Along the slip.
        let t = (path - n * n.dot(&path)).normalize();
        (self.multiplier, self.friction) = match status {
            Status::Gap => (n * 30.0, 0.3),
            Status::Stick => (n * -8.0 + t, 50.0),
            Status::Slip => (n * -8.0 + t * 4.0, 0.05),
        };
        self
    }

    /// Where a node meets a node, which has turned since it was at `self.then`.
    fn corner(&self) -> Corner {
        let patch = &self.patches[self.now];
        let at = |points: &[Vec3]| patch.nodes.iter().map(|n| points[*n as usize]).collect::<Vec<_>>();
        Corner::new(patch, 1, [&at(&self.then), &at(&self.points)]).unwrap()
    }

    fn origin(&self) -> Vec3 {
        if let Some(beside) = self.beside {
            let corner = self.corner();
            return corner.place + corner.turn * beside;
        }
        self.patches[self.before].shape(&self.positions(self.before)).point(ORIGIN)
    }

    fn projection(&self) -> Projection {
        let (patch, x) = (self.shape(), &self.slave);
        if self.beside.is_some() {
            let Corner { place, normal, .. } = self.corner();
            let gap = normal.dot(&(x - place));
            let (point, normal_gradient) = (x - normal * gap, Mat3::zeros());
            return Projection { gap, point, normal, normal_gradient, patch: patch.id, xi: [1.0, 0.0] };
        }
        let foot = descend(&patch, x, &[0.0; 4], patch.center());
        let (gap, normal, normal_gradient) =
            if foot.limits == 0 { on_surface(x, &foot.local) } else { on_edge(x, &patch, &foot, self.inside) };
        Projection { gap, point: foot.local.point, normal, normal_gradient, patch: patch.id, xi: foot.xi }
    }

    fn method(&self, transfer: Transfer, tangent: Tangent) -> Method {
        let law = Law { friction: self.friction, ..LAW };
        Method { law, transfer, tangent }
    }

    /// The element, and its residual: slave, multiplier, nodes of the current patch.
    fn element(&self, width: usize, transfer: Transfer, tangent: Tangent) -> (Status, Element, DVector<f64>) {
        let projection = self.projection();
        let [now, before] = [self.now, self.before].map(|f| Stencil::new(self, f));
        let (opposite, carried) = (Opposite::Patch(now.site(projection.xi)), Origin::Carried(before.site(ORIGIN)));
        let corner = self.beside.map(|_| self.corner());
        let origin = corner.as_ref().map_or(carried, |corner| Origin::Beside(self.origin(), corner));
        let contact = Contact { projection: &projection, opposite, origin, carried: self.carried };
        let (mut method, mut e) = (self.method(transfer, tangent), Element::default());
        method.law.friction = if width == 3 { method.law.friction } else { 0.0 };
        let residual = e.tangent(&method, &(self.kind)(self.multiplier), Some(&contact), &Guide::default());
        let numbers = residual.load.iter().chain(residual.constraint.iter().take(width));
        let numbers: Vec<f64> = numbers.chain(e.forces.iter().flatten()).copied().collect();
        (residual.status, e, DVector::from_vec(numbers))
    }

    /// The residual with an unknown of the element displaced: of the slave, the multiplier λ', or a node.
    fn displaced(&self, width: usize, transfer: Transfer, nodes: &[u32], column: usize, by: f64) -> DVector<f64> {
        let mut pair = self.clone();
        match column {
            d if d < 3 => pair.slave[d] += by,
            c if c < 3 + width => pair.multiplier[c - 3] += by * LAW.normal,
            c => pair.points[nodes[(c - 3 - width) / 3] as usize][(c - 3 - width) % 3] += by,
        }
        pair.element(width, transfer, Tangent::Exact).2
    }
}

fn matrix(e: &Element) -> DMatrix<f64> {
    DMatrix::from_row_slice(e.shape[0], e.shape[1], &e.matrix)
}

/// Surrounded patches and patches at ends, quadrilaterals and triangles, linear and quadratic, with the patch of the slip origin.
fn pairs() -> Vec<Pair> {
    let dome = |s: f64, t: f64| [3.0 * s, 3.0 * t, 0.4 * (s - s * s) + 0.5 * (t - t * t) + 0.2 * s * t];
    let bend: Vec<[f64; 2]> = (0..=6).map(|k| 0.3 * k as f64).map(|a| [-a.cos(), a.sin()]).collect();
    let mut pairs = Vec::new();
    for triangles in [false, true] {
        let one = |f: usize| if triangles { 2 * f } else { f };
        for (now, before) in [(4, 4), (4, 1), (0, 8)] {
            let mesh = grid(3, 3, triangles, dome);
            pairs.push(Pair::new(&mesh, Smoothing::Nagata, [one(now), one(before)]));
            pairs.push(Pair::new(&mesh, Smoothing::Facet, [one(now), one(before)]));
            pairs.push(Pair::new(&mesh, Smoothing::Facet, [one(now), one(before)]).quadratic());
        }
        pairs.push(Pair::new(&strip(&bend, 1, triangles), Smoothing::Nagata, [one(3), one(2)]));
        pairs.push(Pair::new(&strip(&bend, 1, triangles), Smoothing::Nagata, [one(0), one(0)]));
    }
    pairs
}

/// Largest error of the tangent over the normal penalty against sixth-order differences.
fn error(pair: &Pair, width: usize, transfer: Transfer) -> f64 {
    let (_, e, _) = pair.element(width, transfer, Tangent::Exact);
    let (tangent, mut worst) = (matrix(&e), 0.0_f64);
    for column in 0..e.shape[1] {
        let h = 3e-4 * pair.size();
        let at = |s: f64| pair.displaced(width, transfer, &e.nodes, column, s * h);
        let by = (at(1.0) - at(-1.0)) * (0.75 / h) - (at(2.0) - at(-2.0)) * (0.15 / h)
            + (at(3.0) - at(-3.0)) * (1.0 / (60.0 * h));
        worst = worst.max((by - tangent.column(column)).amax() / LAW.normal);
    }
    worst
}

#[test]
fn the_frictional_tangent_is_the_derivative_of_the_residual() {
    for (k, pair) in pairs().into_iter().enumerate() {
        for (foot, inside) in [(Foot::Face, true), (Foot::Face, false), (Foot::Edge, false), (Foot::Corner, true)] {
            for status in [Status::Gap, Status::Stick, Status::Slip] {
                let pair = pair.clone().placed(foot, inside).with_status(status);
                for transfer in TRANSFERS {
                    assert_eq!(pair.element(3, transfer, Tangent::Exact).0, status);
                    let error = error(&pair, 3, transfer);
                    assert!(error < 1e-8, "{k} {foot:?} {inside} {status:?} {transfer:?}: {error:e}");
                }
            }
        }
    }
}

/// Slave nodes over nodes inside the surface, at its ends, and in one and two planes of symmetry.
fn from_node_to_node() -> Vec<Pair> {
    let dome = |s: f64, t: f64| [3.0 * s, 3.0 * t, 0.4 * (s - 0.5 * s * s) + 0.5 * (t - 0.5 * t * t)];
    let planes = [(Vec3::new(3.0, 0.0, 0.0), Vec3::x()), (Vec3::zeros(), Vec3::y())];
    let in_planes = |triangles: bool, count: usize| {
        let mesh = grid(3, 3, triangles, dome);
        let now = if triangles { 4 } else { 2 };
        Pair::in_planes(&mesh, Smoothing::Nagata, [now, now], &planes[..count])
    };
    let of_planes =
        [(false, 1), (true, 1), (false, 2), (true, 2)].map(|(triangles, count)| in_planes(triangles, count));
    let smooth = pairs().into_iter().filter(|pair| !pair.patches[pair.now].normals.is_empty());
    let over = |pair: Pair| {
        let (size, Corner { place, turn, .. }) = (pair.size(), pair.corner());
        let slave = place + turn * Vec3::new(-0.02, 0.05, -0.01) * size;
        Pair { beside: Some(Vec3::new(0.04, -0.03, 0.01) * size), slave, ..pair }
    };
    smooth.chain(of_planes).map(over).collect()
}

#[test]
fn the_tangent_from_node_to_node_is_the_derivative_of_the_residual() {
    for (k, pair) in from_node_to_node().into_iter().enumerate() {
        for status in [Status::Gap, Status::Stick, Status::Slip] {
            let pair = pair.clone().with_status(status);
            assert_eq!(pair.element(3, Transfer::Bilinear, Tangent::Exact).0, status);
            let error = error(&pair, 3, Transfer::Bilinear);
            assert!(error < 1e-8, "{k} {status:?}: {error:e}");
        }
        let kind: fn(Vec3) -> Multiplier =
            |force| Multiplier::Held { gap: -0.15, tangential: Vec3::new(0.3, -0.2, 0.4), force };
        for friction in [0.03, 50.0] {
            let pair = Pair { kind, carried: Vec3::new(0.6, -0.4, 0.2), friction, ..pair.clone() }.settled(3);
            let error = reduced_error(&pair, 3, Transfer::Bilinear);
            assert!(error < 1e-7, "{k} {friction}: {error:e}");
        }
        let pair = Pair { multiplier: Vec3::new(-7.0, 0.0, 0.0), ..pair };
        let error = error(&pair, 1, Transfer::Bilinear);
        assert!(error < 1e-8, "{k}: {error:e}");
    }
}

/// How a node turns depends neither on the order of facets nor on where their corners begin; in the mirror it is the mirror image, and
/// of half a surface up to a plane of symmetry that of the whole.
#[test]
fn a_corner_turns_alike_however_facets_are_written() {
    let place = |p: &[f64; 3]| Vec3::new(p[0], p[1], 0.1 * (p[0] - 1.5).powi(2) + 0.05 * p[1]);
    let moved = |x: Vec3| {
        let twist = Rotation3::new(Vec3::new(0.3, -0.2, 0.5));
        twist * (x + Vec3::new(0.4 * x.y + 0.1 * x.y * x.x, 0.05 * x.x * x.x, 0.1 * x.x * x.y))
    };
    let turn_at = |mesh: &Mesh, node: usize, planes: &[(Vec3, Vec3)], moved: &dyn Fn(Vec3) -> Vec3| {
        let numbers: Vec<u64> = (0..mesh.points.len() as u64).collect();
        let patches = MovingPatch::all(mesh, &numbers, Smoothing::Nagata, 50.0, planes, &Controls::default()).unwrap();
        let of_node = |patch: &MovingPatch| {
            let corner = patch.nodes[..patch.count as usize].iter().position(|n| *n == node as u64)?;
            let then: Vec<Vec3> = patch.nodes.iter().map(|n| mesh.points[*n as usize].into()).collect();
            let now: Vec<Vec3> = then.iter().map(|x| moved(*x)).collect();
            Some(Corner::new(patch, corner, [&then, &now]).unwrap().turn)
        };
        let turns: Vec<Mat3> = patches.iter().filter_map(of_node).collect();
        assert!(turns.iter().all(|turn| (turn - turns[0]).amax() < 1e-13), "{turns:?}");
        turns[0]
    };
    for (triangles, node) in [(false, 5), (true, 5), (false, 4), (true, 4), (false, 0), (true, 0)] {
        let mut mesh = grid(3, 3, triangles, |s, t| [3.0 * s + 0.3 * t * t, 3.0 * t, 0.0]);
        mesh.points.iter_mut().for_each(|p| *p = place(p).into());
        let turn = turn_at(&mesh, node, &[], &moved);
        assert!((turn.determinant() - 1.0).abs() < 1e-13 && (turn - Mat3::identity()).amax() > 0.1);
        let mut other = mesh.clone();
        other.facets.reverse();
        other.facets.iter_mut().for_each(|facet| facet.nodes[..facet.count as usize].rotate_left(1));
        assert!((turn_at(&other, node, &[], &moved) - turn).amax() < 1e-13);

        let mirror = Mat3::from_diagonal(&Vec3::new(1.0, -1.0, 1.0));
        let mut other = mesh.clone();
        other.points.iter_mut().for_each(|p| *p = (mirror * Vec3::from(*p)).into());
        other.facets.iter_mut().for_each(|facet| facet.nodes[..facet.count as usize].reverse());
        let image = turn_at(&other, node, &[], &|x| mirror * moved(mirror * x));
        assert!((image - mirror * turn * mirror).amax() < 1e-13, "{node} {triangles}");
    }
    let even = |x: Vec3| x + Vec3::new(0.3 * x.x * x.y * x.y, 0.2 * x.y * x.x, 0.2 * x.x * x.x + 0.3 * x.y * x.y);
    let mesh = |columns: usize, from: f64| grid(columns, 3, false, |s, t| [3.0 * t, (3.0 - from) * s + from, 0.0]);
    let (half, whole) = (mesh(3, 0.0), mesh(6, -3.0));
    let at =
        |mesh: &Mesh, x: f64| mesh.points.iter().position(|p| (Vec3::from(*p) - Vec3::x() * x).norm() < 1e-9).unwrap();
    for x in [0.0, 1.0] {
        let turn = turn_at(&half, at(&half, x), &[(Vec3::zeros(), Vec3::y())], &even);
        assert!((turn_at(&whole, at(&whole, x), &[], &even) - turn).amax() < 1e-13, "{x}");
    }
}

#[test]
fn the_frictionless_tangent_is_the_derivative_of_the_residual_and_symmetric() {
    for (k, pair) in pairs().into_iter().enumerate() {
        for (foot, inside) in [(Foot::Face, true), (Foot::Face, false), (Foot::Edge, true), (Foot::Corner, false)] {
            for pressure in [30.0, -7.0] {
                let pair = Pair { multiplier: Vec3::new(pressure, 0.0, 0.0), ..pair.clone().placed(foot, inside) };
                for transfer in TRANSFERS {
                    let (status, e, _) = pair.element(1, transfer, Tangent::Exact);
                    assert_eq!(status == Status::Gap, pressure > 0.0);
                    let error = error(&pair, 1, transfer);
                    assert!(error < 1e-8, "{k} {foot:?} {inside} {pressure} {transfer:?}: {error:e}");
                    if transfer == Transfer::Variational {
                        let tangent = matrix(&e);
                        let skew = (&tangent - tangent.transpose()).amax() / tangent.amax();
                        assert!(skew < 1e-12, "{k} {foot:?} {inside}: {skew:e}");
                    }
                }
            }
        }
    }
}

/// λ as the force under an active set, whatever status it asks for.
#[test]
fn the_tangent_of_an_active_set_is_the_derivative_of_the_residual() {
    let kinds: [fn(Vec3) -> Multiplier; 2] =
        [|lambda| Multiplier::Force(lambda, Status::Stick), |lambda| Multiplier::Force(lambda, Status::Slip)];
    for pair in pairs() {
        for (status, kind) in [Status::Stick, Status::Slip].into_iter().zip(kinds) {
            for (foot, asked) in [(Foot::Face, Status::Stick), (Foot::Edge, Status::Slip)] {
                let pair = Pair { kind, ..pair.clone().placed(foot, true).with_status(asked) };
                assert_eq!(pair.element(3, Transfer::Patch, Tangent::Exact).0, status);
                let error = error(&pair, 3, Transfer::Patch);
                assert!(error < 1e-8, "{foot:?} {status:?}: {error:e}");
            }
        }
        let pair = Pair { kind: kinds[0], multiplier: Vec3::x() * 5.0, ..pair.placed(Foot::Face, false) };
        assert!(error(&pair, 1, Transfer::Variational) < 1e-8);
    }
}

/// A held multiplier, of which the tangential part goes with the patch of the slip origin: where the local unknown is
/// settled, the reduced tangent is the derivative of the reduced residual.
#[test]
fn the_tangent_of_a_held_multiplier_is_the_derivative_of_the_residual() {
    let kind: fn(Vec3) -> Multiplier =
        |force| Multiplier::Held { gap: -0.15, tangential: Vec3::new(0.3, -0.2, 0.4), force };
    let carried = Vec3::new(0.6, -0.4, 0.2);
    let mut seen = [0; 3];
    for pair in pairs() {
        for (foot, friction) in [(Foot::Face, 0.05), (Foot::Face, 50.0), (Foot::Edge, 0.05), (Foot::Corner, 50.0)] {
            let pair = Pair { kind, carried, friction, ..pair.clone().placed(foot, true) }.settled(3);
            seen[pair.element(3, Transfer::Patch, Tangent::Exact).0 as usize] += 1;
            for transfer in TRANSFERS {
                let error = reduced_error(&pair, 3, transfer);
                assert!(error < 1e-7, "{foot:?} {friction} {transfer:?}: {error:e}");
            }
        }
        let pair = Pair { kind, carried: Vec3::zeros(), ..pair.placed(Foot::Face, true) }.settled(1);
        assert!(reduced_error(&pair, 1, Transfer::Variational) < 1e-7);
        let matrix = matrix(&pair.element(1, Transfer::Variational, Tangent::Exact).1);
        let rest = matrix.remove_row(3).remove_column(3);
        assert!((&rest - rest.transpose()).amax() < 1e-11 * rest.amax());
    }
    assert!(seen[1] > 0 && seen[2] > 0);
}

impl Pair {
    /// With σ solved for.
    fn settled(mut self, width: usize) -> Self {
        for _ in 0..40 {
            let (_, e, r) = self.element(width, Transfer::Patch, Tangent::Exact);
            let block = matrix(&e).view((3, 3), (width, width)).into_owned();
            let step = block.lu().solve(&-r.rows(3, width)).unwrap() * LAW.normal;
            (0..width).for_each(|d| self.multiplier[d] += step[d]);
        }
        self
    }
}

/// As [`error`], with σ solved for at every point, and without its row and column.
fn reduced_error(pair: &Pair, width: usize, transfer: Transfer) -> f64 {
    let (_, e, _) = pair.element(width, transfer, Tangent::Exact);
    let (tangent, mut worst) = (matrix(&e), 0.0_f64);
    for column in (0..e.shape[1]).filter(|c| !(3..3 + width).contains(c)) {
        let h = 3e-4 * pair.size();
        let at = |s: f64| {
            let mut moved = pair.clone();
            match column {
                d if d < 3 => moved.slave[d] += s * h,
                c => moved.points[e.nodes[(c - 3 - width) / 3] as usize][(c - 3 - width) % 3] += s * h,
            }
            moved.settled(width).element(width, transfer, Tangent::Exact).2
        };
        let by = (at(1.0) - at(-1.0)) * (0.75 / h) - (at(2.0) - at(-2.0)) * (0.15 / h)
            + (at(3.0) - at(-3.0)) * (1.0 / (60.0 * h));
        let rows = (0..e.shape[0]).filter(|r| !(3..3 + width).contains(r));
        worst = rows.fold(worst, |w, r| w.max((by[r] - tangent[(r, column)]).abs() / LAW.penalty));
    }
    worst
}

#[test]
fn what_the_slave_gets_the_master_gets() {
    let mut defects = [0.0_f64; 3];
    for pair in pairs() {
        let pair = pair.placed(Foot::Face, true).with_status(Status::Slip);
        for (t, transfer) in TRANSFERS.into_iter().enumerate() {
            let (_, e, residual) = pair.element(3, transfer, Tangent::Exact);
            let force = Vec3::new(residual[0], residual[1], residual[2]);
            let sum: Vec3 = e.forces.iter().sum();
            assert!((sum + force).norm() < 1e-14 * force.norm());
            let arm = |n: &u32| pair.points[*n as usize] - pair.projection().point;
            let moment: Vec3 = e.nodes.iter().zip(&e.forces).map(|(n, f)| arm(n).cross(f)).sum();
            defects[t] = defects[t].max(moment.norm() / (force.norm() * pair.size()));
        }
    }
    // In lengths of an edge: exact, and by the sagitta of the patch.
    assert!(defects[0] < 1e-12 && defects[1..].iter().all(|d| *d > 1e-3 && *d < 0.1), "{defects:?}");
}

/// The moment that is lost over force times radius, for a node that slips halfway along an edge of a quarter of a cylinder
/// of `n` edges.
fn lost_moment(n: usize, transfer: Transfer) -> f64 {
    let angle = |k: usize| (k as f64 / n as f64 - 0.5) * std::f64::consts::FRAC_PI_2;
    let profile: Vec<[f64; 2]> = (0..=n).rev().map(|k| [angle(k).sin(), angle(k).cos()]).collect();
    let mut pair = Pair::new(&strip(&profile, 1, false), Smoothing::Nagata, [n / 2, n / 2]);
    let mesh = strip(&profile, 1, false);
    pair.points = mesh.points.iter().map(|p| Vec3::from(*p)).collect();
    let (middle, normal) = (pair.shape().point([0.5, 0.5]), pair.shape().normal([0.5, 0.5]));
    pair.slave = middle - normal * 1e-6;
    (pair.multiplier, pair.friction) = (normal * -8.0 + (middle - pair.origin()).normalize() * 9.0, 0.3);
    let (status, e, residual) = pair.element(3, transfer, Tangent::Exact);
    assert_eq!(status, Status::Slip);
    let arm = |n: &u32| pair.points[*n as usize] - middle;
    let moment: Vec3 = e.nodes.iter().zip(&e.forces).map(|(n, f)| arm(n).cross(f)).sum();
    moment.norm() / residual.fixed_rows::<3>(0).norm()
}

/// Only the variational transfer keeps moments. With the others friction loses the arm from the patch to its chord,
/// 1 - cos(β/2) of the radius, since both pass tangential forces on with the bilinear weights there.
#[test]
fn moments_are_lost_with_the_sagitta() {
    let lean = 0.3 / 1.09_f64.sqrt();
    for n in [3, 5, 9, 17] {
        let lost = TRANSFERS.map(|transfer| lost_moment(n, transfer));
        println!("{n} edges: variational {:.1e}, patch {:.2e}, bilinear {:.2e}", lost[0], lost[1], lost[2]);
        let half = std::f64::consts::FRAC_PI_4 / n as f64;
        assert!(lost[0] < 1e-12);
        for lost in &lost[1..] {
            assert!((lost / (lean * (1.0 - half.cos())) - 1.0).abs() < half * half, "{n} edges: {lost}");
        }
    }
}

#[test]
fn nothing_depends_on_the_frame() {
    let rotation = Rotation3::from_euler_angles(0.7, -1.2, 2.3);
    for pair in pairs() {
        for (foot, status) in [(Foot::Face, Status::Stick), (Foot::Face, Status::Slip), (Foot::Edge, Status::Slip)] {
            let here = pair.clone().placed(foot, false).with_status(status);
            let turn = |x: &Vec3| rotation * x;
            let there = Pair {
                points: here.points.iter().map(turn).collect(),
                slave: turn(&here.slave),
                multiplier: turn(&here.multiplier),
                ..here.clone()
            };
            for (transfer, tangent) in [
                (Transfer::Variational, Tangent::Exact),
                (Transfer::Bilinear, Tangent::Exact),
                (Transfer::Bilinear, Tangent::FixedFrame),
            ] {
                let [(_, a, r), (_, b, s)] = [&here, &there].map(|pair| pair.element(3, transfer, tangent));
                let blocks = |n: usize| {
                    let mut q = DMatrix::zeros(n, n);
                    (0..n / 3).for_each(|k| q.view_mut((3 * k, 3 * k), (3, 3)).copy_from(rotation.matrix()));
                    q
                };
                let [rows, columns] = a.shape.map(blocks);
                assert!((&rows * r - s).amax() < 1e-12);
                assert!((&rows * matrix(&a) - matrix(&b) * &columns).amax() < 1e-10);
            }
        }
    }
}

#[test]
fn a_master_at_rest_is_a_tool() {
    for pair in pairs() {
        for (foot, inside) in [(Foot::Face, true), (Foot::Edge, false), (Foot::Corner, false)] {
            for status in [Status::Gap, Status::Stick, Status::Slip] {
                let pair = pair.clone().placed(foot, inside).with_status(status);
                let (projection, anchor) = (pair.projection(), pair.origin());
                let law = Law { friction: pair.friction, ..LAW };
                let lambda = Multiplier::Augmented(pair.multiplier);
                let tool = tests_on_tools::element(law, &lambda, &projection, anchor, &Guide::default());
                let (_, e, residual) = pair.element(3, Transfer::Variational, Tangent::Exact);
                let e = matrix(&e);
                assert!((residual.fixed_rows::<3>(0) - tool.response.force).amax() < 1e-13);
                assert!((residual.fixed_rows::<3>(3) - tool.response.constraint).amax() < 1e-13);
                assert!((e.fixed_view::<3, 3>(0, 0) - tool.force_position).amax() < 1e-10);
                assert!((e.fixed_view::<3, 3>(3, 0) - tool.force_position).amax() < 1e-10);
                assert!((e.fixed_view::<3, 3>(0, 3) - tool.force_multiplier).amax() < 1e-12);
                assert!((e.fixed_view::<3, 3>(3, 3) - tool.constraint_multiplier).amax() < 1e-12);
            }
        }
    }
}

/// The paper's matrix (70): [eps qq M, q M; q M, M - I] with q = (1, -w).
#[test]
fn the_fixed_frame_has_the_blocks_of_the_paper() {
    let pair = pairs().remove(0).placed(Foot::Face, true).with_status(Status::Slip);
    let mut pair = Pair { friction: 0.3, ..pair };
    pair.multiplier *= 2.0;
    let (_, e, residual) = pair.element(3, Transfer::Bilinear, Tangent::FixedFrame);
    let tangent = matrix(&e);
    let m = tangent.fixed_view::<3, 3>(0, 3) / LAW.normal;
    let (n, force) = (pair.projection().normal, residual.fixed_rows::<3>(0).into_owned());
    // F = λ̂_n (n - μ t).
    let t = (n - force / force.dot(&n)) / pair.friction;
    assert!((m * n - (n - pair.friction * t)).norm() < 1e-13 && (m * t).norm() < 1e-13);
    let [x, z] = pair.projection().xi;
    let w = [(1.0 - x) * (1.0 - z), x * (1.0 - z), x * z, (1.0 - x) * z];
    let along_t = LAW.tangential / LAW.normal;
    let apart = tangent.fixed_view::<3, 3>(0, 0).into_owned();
    assert!((apart * n - m * n * LAW.normal).norm() < 1e-12);
    assert!((apart * n.cross(&t) - m * n.cross(&t) * (LAW.normal * along_t)).norm() < 1e-12);
    for i in 0..e.forces.len() {
        let q = if i < 4 { -w[i] } else { 0.0 };
        assert!((tangent.fixed_view::<3, 3>(6 + 3 * i, 0) - apart * q).amax() < 1e-12);
        assert!((tangent.fixed_view::<3, 3>(3, 6 + 3 * i) - apart * q).amax() < 1e-12);
        assert!((tangent.fixed_view::<3, 3>(6 + 3 * i, 3) - m * (LAW.normal * q)).amax() < 1e-12);
        for j in 0..4 {
            assert!((tangent.fixed_view::<3, 3>(6 + 3 * i, 6 + 3 * j) + apart * (q * w[j])).amax() < 1e-12);
        }
    }
}

#[test]
fn a_flat_master_has_a_finite_tangent() {
    let mesh = grid(3, 3, false, |s, t| [3.0 * s, 3.0 * t, 0.0]);
    let mut pair = Pair::new(&mesh, Smoothing::Nagata, [4, 4]);
    pair.points = mesh.points.iter().map(|p| Vec3::from(*p)).collect();
    for status in [Status::Stick, Status::Slip] {
        let pair = Pair { slave: Vec3::new(1.4, 1.7, 0.0), ..pair.clone() }.with_status(status);
        let (found, e, residual) = pair.element(3, Transfer::Variational, Tangent::Exact);
        assert_eq!(found, status);
        assert!(e.matrix.iter().chain(&residual).all(|x| x.is_finite()));
        assert!(error(&pair, 3, Transfer::Variational) < 1e-8);
    }
}

/// In plane strain nothing moves across: the tangent is exact for the motions that are left, and no force points there.
#[test]
fn plane_strain_holds_the_direction_across() {
    let bend: Vec<[f64; 2]> = (0..=6).map(|k| 0.3 * k as f64).map(|a| [-a.cos(), a.sin()]).collect();
    let mut pair = Pair::new(&strip(&bend, 1, false), Smoothing::Nagata, [3, 2]);
    let size = pair.size();
    // Both nodes of a line across move alike.
    let half = pair.points.len() / 2;
    for k in 0..half {
        pair.points[k].z = -0.5;
        pair.points[half + k] = Vec3::new(pair.points[k].x, pair.points[k].y, 1.5);
    }
    let guide = Guide { held: [false, false, true], ..Guide::default() };
    for status in [Status::Stick, Status::Slip] {
        let mut pair = pair.clone();
        pair.slave = pair.shape().point([0.4, 0.5]) - pair.shape().normal([0.4, 0.5]) * (0.05 * size);
        let mut pair = pair.with_status(status);
        pair.multiplier.z = 0.0;
        let run = |pair: &Pair| {
            let projection = pair.projection();
            let [now, before] = [pair.now, pair.before].map(|f| Stencil::new(pair, f));
            let (opposite, origin) =
                (Opposite::Patch(now.site(projection.xi)), Origin::Carried(before.site([0.55, 0.5])));
            let contact = Contact { projection: &projection, opposite, origin, carried: Vec3::zeros() };
            let method = pair.method(Transfer::Variational, Tangent::Exact);
            let mut e = Element::default();
            let r = e.tangent(&method, &Multiplier::Augmented(pair.multiplier), Some(&contact), &guide);
            (r, e)
        };
        let (residual, e) = run(&pair);
        assert_eq!(residual.status, status);
        assert!(residual.force.z.abs() < 1e-13 && e.forces.iter().all(|f| f.z.abs() < 1e-13));
        let tangent = matrix(&e);
        let h = 3e-4 * size;
        for node in (0..half as u32).filter(|n| e.nodes.contains(n)) {
            for d in 0..2 {
                let at = |s: f64| {
                    let mut pair = pair.clone();
                    for n in [node as usize, node as usize + half] {
                        pair.points[n][d] += s * h;
                    }
                    run(&pair).0.force
                };
                let by = (at(1.0) - at(-1.0)) * (2.0 / (3.0 * h)) - (at(2.0) - at(-2.0)) / (12.0 * h);
                let columns = e.nodes.iter().enumerate().filter(|(_, n)| **n % half as u32 == node);
                let sum: Vec3 = columns.map(|(j, _)| tangent.fixed_view::<3, 1>(0, 6 + 3 * j + d).into_owned()).sum();
                assert!((by - sum).xy().norm() < 1e-7 * LAW.normal, "{by} {sum}");
            }
        }
    }
}

#[test]
fn without_a_contact_the_multiplier_goes_to_zero() {
    let (transfer, tangent) = (Transfer::Variational, Tangent::Exact);
    let method = Method { law: LAW, transfer, tangent };
    let (mut e, lambda) = (Element::default(), Vec3::new(1.0, 2.0, 3.0));
    let residual = e.tangent(&method, &Multiplier::Augmented(lambda), None, &Guide::default());
    assert_eq!((residual.status, residual.force, residual.constraint), (Status::Gap, Vec3::zeros(), -lambda));
    assert_eq!((e.shape, e.nodes.len(), e.forces.len()), ([6, 6], 0, 0));
    let expected = DMatrix::from_diagonal(&DVector::from_vec(vec![0.0, 0.0, 0.0, -40.0, -40.0, -40.0]));
    assert_eq!(matrix(&e), expected);
    let method = Method { law: Law { friction: 0.0, ..LAW }, ..method };
    let residual = e.tangent(&method, &Multiplier::Augmented(Vec3::x() * 2.0), None, &Guide::default());
    assert_eq!((residual.constraint.x, e.shape, e.matrix[15]), (-2.0, [4, 4], -40.0));
}

/// A slave node on springs is pressed and drawn against a master whose nodes are on springs.
#[test]
fn newton_converges_quadratically_with_the_exact_tangent() {
    let mesh = grid(3, 3, false, |s, t| [3.0 * s, 3.0 * t, 1.2 * (s - s * s) + 1.5 * (t - t * t)]);
    let mut residuals: [Vec<f64>; 2] = Default::default();
    for (k, tangent) in [Tangent::Exact, Tangent::FixedFrame].into_iter().enumerate() {
        let mut pair = Pair::new(&mesh, Smoothing::Nagata, [4, 4]);
        pair.points = mesh.points.iter().map(|p| Vec3::from(*p)).collect();
        let (rest, target, stiffness) = (pair.points.clone(), Vec3::new(1.7, 1.75, 0.4), 20.0);
        pair.slave = Vec3::new(1.55, 1.5, 0.65);
        for _ in 0..40 {
            let (_, e, contact) = pair.element(3, Transfer::Variational, tangent);
            let count = 6 + 3 * rest.len();
            let (mut r, mut a) = (DVector::zeros(count), DMatrix::zeros(count, count));
            let place = |j: usize| if j < 6 { j } else { 6 + 3 * e.nodes[(j - 6) / 3] as usize + (j - 6) % 3 };
            for i in 0..e.shape[0] {
                r[place(i)] += contact[i];
                (0..e.shape[1]).for_each(|j| a[(place(i), place(j))] += e.matrix[i * e.shape[1] + j]);
            }
            let springs = std::iter::once((0, pair.slave - target));
            let springs = springs.chain((0..rest.len()).map(|n| (6 + 3 * n, pair.points[n] - rest[n])));
            for (row, stretch) in springs {
                for d in 0..3 {
                    r[row + d] += stiffness * stretch[d];
                    a[(row + d, row + d)] += stiffness;
                }
            }
            residuals[k].push(r.amax());
            if r.amax() < 1e-12 {
                break;
            }
            let step = a.lu().solve(&-r).unwrap();
            pair.slave += step.fixed_rows::<3>(0);
            pair.multiplier += step.fixed_rows::<3>(3) * LAW.normal;
            pair.points.iter_mut().enumerate().for_each(|(n, x)| *x += step.fixed_rows::<3>(6 + 3 * n));
        }
        assert!(*residuals[k].last().unwrap() < 1e-12, "{residuals:?}");
    }
    let [exact, fixed] = &residuals;
    assert!(exact.len() <= 6 && (1..4).all(|k| exact[k + 1] < 0.5 * exact[k].powi(2)), "{exact:?}");
    assert!(fixed.len() > 15 && (5..15).all(|k| fixed[k + 1] > 0.1 * fixed[k]), "{fixed:?}");
}

//! The element of a slave node in points of its faces, which stand still in them, against differences.

use super::spread::{Bed, Portion, Spread};
use super::*;
use crate::contact::law::LAW;
use crate::contact::master::SlipOrigin;
use crate::controls::Controls;
use crate::scene::Smoothing;
use crate::surface::projection::{descend, on_surface};
use crate::surface::test_meshes::grid;
use nalgebra::{DMatrix, DVector};

/// Nodes, shape functions and weights of the points of two faces around node 0, and where each is on the master: patch,
/// parameters and gap.
type Spot = (&'static [u32], &'static [f64], f64, (usize, [f64; 2], f64));
static SPOTS: [Spot; 4] = [
    (&[0, 1, 2, 3], &[0.56, 0.24, 0.06, 0.14], 0.5, (4, [0.6, 0.3], -0.06)),
    (&[0, 1, 2, 3], &[0.2, 0.3, 0.3, 0.2], 0.2, (4, [0.8, 0.5], 0.03)),
    (&[0, 3, 4, 5], &[0.4, 0.3, 0.1, 0.2], 0.2, (5, [0.3, 0.5], 0.02)),
    (&[0, 3, 4, 5], &[0.1, 0.2, 0.3, 0.4], 0.1, (5, [0.4, 0.3], -0.05)),
];
/// Faces of nine and of six nodes.
static QUADRATIC: [Spot; 3] = [
    (
        &[0, 1, 2, 3, 4, 5, 6, 7, 8],
        &[0.06, -0.02, 0.01, -0.03, 0.12, -0.04, -0.06, 0.24, 0.72],
        0.5,
        (4, [0.6, 0.3], -0.06),
    ),
    (&[0, 3, 4, 7, 6, 5], &[-0.12, -0.08, -0.12, 0.32, 0.48, 0.52], 0.3, (4, [0.8, 0.5], 0.03)),
    (&[0, 3, 4, 7, 6, 5], &[0.28, -0.08, -0.12, 0.42, 0.18, 0.32], 0.2, (5, [0.3, 0.5], 0.02)),
];
/// A node that is exactly between patches.
static PIECES: [Spot; 3] = [
    (&[0], &[1.0], 0.5, (4, [0.6, 0.3], -0.06)),
    (&[0], &[1.0], 0.3, (5, [0.0, 0.5], 0.03)),
    (&[0], &[1.0], 0.2, (1, [0.5, 1.0], 0.02)),
];
/// Patch and parameters of the slip origins.
const ORIGIN: (usize, [f64; 2]) = (1, [0.55, 0.31]);
const CENTER: [f64; 3] = [1.5, 1.6, -3.0];
const RADIUS: f64 = 4.0;

/// A master, a surface or a ball, under nine slave nodes.
#[derive(Clone)]
struct Scene {
    patches: Vec<MovingPatch>,
    stencils: Vec<Vec<u32>>,
    points: Vec<Vec3>,
    slaves: Vec<Vec3>,
    spots: &'static [Spot],
    multiplier: Vec3,
    friction: f64,
    guide: Guide,
    wedge: f64,
    /// About which a torque turns the ball, by the first component of its node 1.
    axle: Option<Axle>,
}

impl Bed for Scene {
    fn patch(&self, id: u32) -> Option<(&MovingPatch, &[u32])> {
        self.patches.get(id as usize).map(|patch| (patch, &self.stencils[id as usize][..]))
    }

    fn position(&self, node: u32) -> Vec3 {
        self.points[node as usize]
    }

    fn axle(&self) -> Option<Axle> {
        self.axle.map(|axle| Axle { point: axle.point + self.points[0] - Vec3::from(CENTER), ..axle })
    }
}

impl Scene {
    fn new(smoothing: Smoothing) -> Self {
        let mesh = grid(3, 3, false, |s, t| [3.0 * s, 3.0 * t, 0.4 * (s - s * s) + 0.5 * (t - t * t) + 0.2 * s * t]);
        let numbers: Vec<u64> = (0..mesh.points.len() as u64).collect();
        let patches = MovingPatch::all(&mesh, &numbers, smoothing, 50.0, &[], &Controls::default()).unwrap();
        let stencils = patches.iter().map(|patch| patch.nodes.iter().map(|&n| n as u32).collect()).collect();
        let points = mesh.points.iter().map(|p| Vec3::from(*p)).collect();
        let (slaves, multiplier, guide) = (Vec::new(), Vec3::zeros(), Guide::default());
        let (spots, friction, wedge, axle) = (&SPOTS[..], 0.3, 0.0, None);
        Self { patches, stencils, points, slaves, spots, multiplier, friction, guide, wedge, axle }.placed()
    }

    fn ball() -> Self {
        let points = vec![Vec3::from(CENTER)];
        Self { patches: Vec::new(), stencils: Vec::new(), points, ..Self::new(Smoothing::Facet) }.placed()
    }

    fn turned_ball() -> Self {
        let axis = Vec3::new(0.48, 0.6, 0.64);
        let axle = Axle { point: Vec3::new(1.1, 0.9, -2.0), axis, lever: 1.7 };
        Self { points: vec![Vec3::from(CENTER), Vec3::zeros()], axle: Some(axle), ..Self::ball() }
    }

    /// Where the ball has taken a place, which was so far from its center.
    fn on_ball(&self, away: &Vec3) -> Vec3 {
        let at = self.points[0] + away;
        self.axle().map_or(at, |axle| {
            let turned = axle.axis * (self.points[1].x / axle.lever);
            axle.point + nalgebra::Rotation3::new(turned) * (at - axle.point)
        })
    }

    /// Where the functions of a face put a point.
    fn place(&self, nodes: &[u32], shapes: &[f64]) -> Vec3 {
        nodes.iter().zip(shapes).map(|(n, w)| self.slaves[*n as usize] * *w).sum()
    }

    /// Puts the slave nodes where the points are about where they are said to be.
    fn placed(mut self) -> Self {
        let z = if self.patches.is_empty() { 0.95 } else { 0.2 };
        let first =
            [[1.45, 1.2, 0.0], [1.9, 1.1, 0.1], [2.0, 1.7, -0.05], [1.5, 1.75, 0.08], [1.5, 2.0, 0.0], [1.0, 1.8, 0.1]];
        let at = first.into_iter().chain([[1.75, 1.7, 0.0], [1.5, 1.5, 0.05], [1.7, 1.4, 0.02]]);
        self.slaves = at.map(|x| Vec3::new(x[0], x[1], z + 0.4 * x[2])).collect();
        self
    }

    fn projections(&self) -> Vec<Projection> {
        let of = |(nodes, shapes, _, (patch, xi, _)): &Spot| {
            let x = self.place(nodes, shapes);
            if self.patches.is_empty() {
                let center = self.on_ball(&Vec3::zeros());
                let away = x - center;
                let n = away.normalize();
                let turn = (Mat3::identity() - n * n.transpose()) / away.norm();
                let point = center + n * RADIUS;
                return Projection {
                    gap: away.norm() - RADIUS,
                    point,
                    normal: n,
                    normal_gradient: turn,
                    patch: 0,
                    xi: [0.0; 2],
                };
            }
            let positions: Vec<Vec3> = self.stencils[*patch].iter().map(|&n| self.points[n as usize]).collect();
            let shape = self.patches[*patch].shape(&positions);
            let foot = descend(&shape, &x, &[1.0; 4], *xi);
            let (gap, normal, normal_gradient) = on_surface(&x, &foot.local);
            Projection { gap, point: foot.local.point, normal, normal_gradient, patch: *patch as u32, xi: foot.xi }
        };
        self.spots.iter().map(of).collect()
    }

    /// The element, and its residual in the order of its rows, with this transfer.
    fn element(&self, width: usize, transfer: Transfer) -> (Status, Element, DVector<f64>) {
        let projections = self.projections();
        let (origin, start) = match self.patches.get(ORIGIN.0) {
            None => {
                let place = self.on_ball(&Vec3::new(0.3, -0.2, RADIUS));
                (SlipOrigin::Fixed(place), place)
            }
            Some(patch) => {
                let positions: Vec<Vec3> = self.stencils[ORIGIN.0].iter().map(|&n| self.points[n as usize]).collect();
                (SlipOrigin::Carried(ORIGIN.0 as u32, ORIGIN.1), patch.shape(&positions).point(ORIGIN.1))
            }
        };
        let portion = |((nodes, shapes, weight, _), at): (&'static Spot, _)| Portion {
            weight: *weight,
            nodes,
            shapes,
            place: self.place(nodes, shapes),
            at,
            origin,
            start,
        };
        let portions: Vec<Portion> = self.spots.iter().zip(&projections).map(portion).collect();
        let sum = |of: &dyn Fn(&Portion) -> Vec3| portions.iter().map(|p| of(p) * p.weight).sum::<Vec3>();
        let spread = Spread {
            node: 0,
            portions: &portions,
            gap: portions.iter().map(|p| p.weight * p.at.gap).sum(),
            normal: (self.guide.free() * sum(&|p| p.at.normal)).normalize(),
            free: self.guide.free(),
            carried: Vec3::zeros(),
            wedge: self.wedge,
        };
        let friction = if width == 3 { self.friction } else { 0.0 };
        let method = Method { law: Law { friction, ..LAW }, transfer, tangent: Tangent::Exact };
        let (multiplier, guide) = (Multiplier::Augmented(self.multiplier), self.guide);
        let mut e = Element::default();
        let response = e.spread_tangent(&method, &multiplier, (Some(&spread), self), &guide);
        let own = e.own.iter().chain(response.constraint.iter().take(width));
        let all: Vec<f64> = own.chain(e.beside_forces.iter().chain(&e.forces).flatten()).copied().collect();
        let forces = e.forces.iter().take(if self.axle.is_some() { 1 } else { e.forces.len() });
        let balance: Vec3 = e.own + e.beside_forces.iter().chain(forces).sum::<Vec3>();
        assert!(balance.norm() < 1e-12 * response.force.norm().max(1.0), "{balance}");
        (response.status, e, DVector::from_vec(all))
    }

    fn displaced(&self, width: usize, transfer: Transfer, e: &Element, column: usize, by: f64) -> DVector<f64> {
        let mut moved = self.clone();
        let first = 3 + width;
        match column {
            d if d < 3 => moved.slaves[0][d] += by,
            c if c < first => moved.multiplier[c - 3] += by * LAW.normal,
            c if (c - first) / 3 < e.beside.len() => {
                moved.slaves[e.beside[(c - first) / 3] as usize][(c - first) % 3] += by;
            }
            c => moved.points[e.nodes[(c - first) / 3 - e.beside.len()] as usize][(c - first) % 3] += by,
        }
        moved.element(width, transfer).2
    }

    /// Largest error of the tangent over the normal penalty, and its skew part, against sixth-order differences.
    fn errors(&self, width: usize, transfer: Transfer) -> (Status, f64, f64) {
        let (status, e, _) = self.element(width, transfer);
        let tangent = DMatrix::from_row_slice(e.shape[0], e.shape[1], &e.matrix);
        let (h, mut worst) = (3e-4, 0.0_f64);
        for column in 0..e.shape[1] {
            let at = |s: f64| self.displaced(width, transfer, &e, column, s * h);
            let by = (at(1.0) - at(-1.0)) * (0.75 / h) - (at(2.0) - at(-2.0)) * (0.15 / h)
                + (at(3.0) - at(-3.0)) * (1.0 / (60.0 * h));
            worst = worst.max((by - tangent.column(column)).amax() / LAW.normal);
        }
        (status, worst, (&tangent - tangent.transpose()).amax() / tangent.amax())
    }
}

#[test]
fn the_tangent_of_points_is_the_derivative_of_the_residual() {
    let between = |smoothing| Scene { spots: &PIECES, ..Scene::new(smoothing) };
    let scenes = [
        Scene::new(Smoothing::Nagata),
        Scene::new(Smoothing::Facet),
        Scene::ball(),
        between(Smoothing::Nagata),
        between(Smoothing::Facet),
        Scene { spots: &QUADRATIC, ..Scene::new(Smoothing::Nagata) },
        Scene { spots: &QUADRATIC, ..Scene::ball() },
        Scene::turned_ball(),
        Scene { spots: &QUADRATIC, ..Scene::turned_ball() },
    ];
    for scene in scenes {
        for transfer in [Transfer::Variational, Transfer::Patch, Transfer::Bilinear] {
            let pressed = Scene { multiplier: Vec3::new(1.0, -2.0, -12.0), ..scene.clone() };
            for (friction, expected) in [(50.0, Status::Stick), (0.05, Status::Slip)] {
                let (status, error, _) = Scene { friction, ..pressed.clone() }.errors(3, transfer);
                assert!(status == expected && error < 1e-8, "{status:?} {transfer:?}: {error:e}");
            }
            for wedge in [0.0, 90.0] {
                let smooth = Scene { multiplier: Vec3::new(-12.0, 0.0, 0.0), wedge, ..scene.clone() };
                let (status, error, skew) = smooth.errors(1, transfer);
                assert!(status == Status::Slip && error < 1e-8, "{transfer:?} {wedge}: {error:e}");
                let is_symmetric = transfer == Transfer::Variational || scene.patches.is_empty();
                assert!(!is_symmetric || skew < 1e-12, "{skew:e}");
            }
        }
    }
}

/// A node that is held, or drawn, along some direction.
#[test]
fn the_tangent_of_points_is_the_derivative_where_nodes_are_guided() {
    let axes = *nalgebra::Rotation3::from_euler_angles(0.2, -0.3, 0.4).matrix();
    let (none, one, two) = ([false; 3], [true, false, false], [true, true, false]);
    for scene in [Scene::new(Smoothing::Nagata), Scene::ball(), Scene::turned_ball()] {
        let some = Vec3::new(3.0, -1.0, 0.7);
        let still = Vec3::zeros();
        for (held, drawn, borne) in [
            (one, none, still),
            (none, one, still),
            (none, two, still),
            (one, [false, true, false], still),
            (one, none, some),
        ] {
            let kept = borne - Guide { axes, held, ..Guide::default() }.free() * borne;
            let guide = Guide { axes, held, drawn, kept };
            let multiplier = guide.free() * Vec3::new(1.0, -2.0, -12.0);
            for friction in [50.0, 3.0, 0.3, 0.05] {
                let scene = Scene { multiplier, friction, guide, ..scene.clone() };
                let (status, error, _) = scene.errors(3, Transfer::Variational);
                assert!(error < 1e-9, "{held:?} {drawn:?} {friction} {status:?}: {error:e}");
            }
        }
    }
}

/// Without friction the points bear forces along their normals, which the variational transfer balances in moments, too.
#[test]
fn moments_of_points_balance() {
    let scene = Scene { multiplier: Vec3::new(-12.0, 0.0, 0.0), wedge: 90.0, ..Scene::new(Smoothing::Nagata) };
    let (_, e, _) = scene.element(1, Transfer::Variational);
    let slaves = e.beside.iter().zip(&e.beside_forces).map(|(n, f)| scene.slaves[*n as usize].cross(f));
    let masters = e.nodes.iter().zip(&e.forces).map(|(n, f)| scene.points[*n as usize].cross(f));
    let moment: Vec3 = scene.slaves[0].cross(&e.own) + slaves.chain(masters).sum::<Vec3>();
    assert!(moment.norm() < 1e-11, "{moment}");
}

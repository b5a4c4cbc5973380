//! Sums over the points of a slave face on one patch of the master, by the functions that move them, and over all points of a
//! slave node by node.
//!
//! A point moves with the [handles](crate::surface::moving::variation) of the patch, by their functions φ and the derivatives of
//! these along the free parameters, ℓ_a, and with the nodes of the face, by N. The motion of its foot, gap and normal is linear in
//! these, so that a few parts of motion, those with P, with n·τ_a and with the slave, make all columns:
//!
//! ```text
//!     dh = φ A + ℓ_1 B_1 + ℓ_2 B_2,     N S on the slave
//! ```
//!
//! and so with the rows, the functions of the forces. What all points of a face on a patch come to is handed on from handles to
//! nodes once, with the derivatives of the handles.

use super::motion::{Motion, Part};
use super::spread::{Portion, Spread};
use crate::contact::law::Response;
use crate::contact::pose::Axle;
use crate::mortar::face::MOST;
use crate::surface::Transfer;
use crate::surface::moving::variation::{EDGES, Functions, HANDLES, Variation};
use crate::{Mat3, Vec3};

/// Those of the handles, of which a tool that only moves has one, and of the nodes of the face.
const FUNCTIONS: usize = HANDLES + MOST;

/// The points of a face on a patch.
#[derive(Clone, Debug, Default)]
pub(super) struct Run {
    /// By function dg (a row), dm and dΔ.
    gap: [Vec3; FUNCTIONS],
    normal: [Mat3; FUNCTIONS],
    path: [Mat3; FUNCTIONS],
    /// Σ w T and Σ w T (n_q - n).
    share: [f64; FUNCTIONS],
    leaning: [Vec3; FUNCTIONS],
    /// The last two terms of dR, rows by columns, with the handles' functions at rest on the patch.
    own: [[Mat3; FUNCTIONS]; FUNCTIONS],
    /// On the handles.
    pub forces: [Vec3; HANDLES],
    /// Nodes of the face.
    face: usize,
}

/// All points of a slave node, by node, the slave's before the master's.
#[derive(Clone, Debug, Default)]
pub(super) struct Sums {
    pub gap: Vec<Vec3>,
    pub normal: Vec<Mat3>,
    pub path: Vec<Mat3>,
    pub share: Vec<Mat3>,
    pub leaning: Vec<Vec3>,
    /// The last two terms of dR, rows by columns.
    pub own: Vec<Mat3>,
    pub positions: Vec<Vec3>,
    /// Where the nodes of a run are, those of the patch before those of the face.
    pub places: Vec<usize>,
    /// Those of a run by functions and nodes.
    rows: Vec<Mat3>,
}

/// The points of each face on each patch, in order.
pub(super) fn by_patch<'a, 'b>(points: &'a [Portion<'b>]) -> impl Iterator<Item = &'a [Portion<'b>]> {
    points.chunk_by(|a, b| a.at.patch == b.at.patch && a.nodes == b.nodes)
}

impl Run {
    /// A point on a tool, which the tool's translation moves as the opposite of the slave's.
    pub fn add_on_tool(&mut self, of: (&Spread, &Portion), response: &Response) {
        let of_slave = Part::on_tool(of.1.at);
        let parts = [of_slave.times(-1.0), Part::default(), Part::default(), of_slave];
        let mut functions = [[0.0; 3]; HANDLES];
        functions[0][0] = 1.0;
        self.add(of, response, &parts, &functions);
    }

    /// A point on a patch, which moves so there; `functions` are those of its handles.
    pub fn add_on_patch(
        &mut self,
        of: (&Spread, &Portion),
        response: &Response,
        motion: &Motion,
        functions: &Functions,
    ) {
        let along = |&[phi, by_e, by_z]: &[f64; 3]| {
            let [l, m] = motion.directions.map(|[e, z]| by_e * e + by_z * z);
            [phi, l, m]
        };
        let [by_point, by_first, by_second] = motion.of_handles();
        let parts = [by_point, by_first, by_second, motion.of_slave()];
        self.add(of, response, &parts, &functions.each_ref().map(along));
    }

    /// A point with A, B_1, B_2 and S; `functions` are φ and ℓ_a.
    fn add(
        &mut self,
        (spread, point): (&Spread, &Portion),
        response: &Response,
        parts: &[Part; 4],
        functions: &[[f64; 3]; HANDLES],
    ) {
        self.face = point.nodes.len();
        let w = point.weight;
        let force = spread.bears(point, &response.force);
        let apart = (point.at.normal - spread.normal) * w;
        let pressing = parts.each_ref().map(|part| spread.pressing(point, response, part));
        let sliding = [0, 1].map(|a| parts.each_ref().map(|part| force * part.parameters[a].transpose()));
        // By handles and the nodes of the face: φ, ℓ_a and N.
        let on_face = point.shapes.iter().map(|shape| [0.0, 0.0, 0.0, *shape]);
        let on_patch = functions.iter().map(|[phi, l, m]| [*phi, *l, *m, 0.0]);
        let mut moves = [[0.0; 4]; FUNCTIONS];
        moves.iter_mut().zip(on_patch.chain(on_face)).for_each(|(to, by)| *to = by);
        let combined = |of: &[Mat3; 4], by: &[f64; 4]| match by {
            [0.0, 0.0, 0.0, shape] => of[3] * *shape,
            [phi, l, m, _] => of[0] * *phi + of[1] * *l + of[2] * *m,
        };
        let [normals, paths] = [parts.each_ref().map(|part| part.normal), parts.each_ref().map(|part| part.point)];
        for (r, by) in moves.iter().enumerate().filter(|(_, by)| **by != [0.0; 4]) {
            let [phi, l, m, shape] = *by;
            // The tangents' parts have no gap.
            self.gap[r] += (parts[0].gap * phi + parts[3].gap * shape) * w;
            self.normal[r] += combined(&normals, by) * w;
            self.path[r] += combined(&paths, by) * w;
            self.share[r] += (shape - phi) * w;
            self.leaning[r] += apart * (shape - phi);
            if r < HANDLES {
                self.forces[r] += force * phi;
            }
            let row = std::array::from_fn(|k| pressing[k] * (shape - phi) - sliding[0][k] * l - sliding[1][k] * m);
            for (own, by) in self.own[r].iter_mut().zip(&moves).filter(|(_, by)| **by != [0.0; 4]) {
                *own += combined(&row, by);
            }
        }
    }
}

impl Sums {
    /// Empties them for so many nodes.
    pub fn clear(&mut self, count: usize) {
        self.gap.clear();
        self.gap.resize(count, Vec3::zeros());
        self.leaning.clear();
        self.leaning.resize(count, Vec3::zeros());
        for (matrices, length) in [
            (&mut self.normal, count),
            (&mut self.path, count),
            (&mut self.share, count),
            (&mut self.own, count * count),
        ] {
            matrices.clear();
            matrices.resize(length, Mat3::zeros());
        }
    }

    /// Adds what a torque that turns the tool makes of a point, whose run was [taken](Self::take); that rotation is the last node.
    pub fn turn(&mut self, (spread, point): (&Spread, &Portion), response: &Response, axle: &Axle) {
        let (p, w, last, count) = (point.at, point.weight, self.gap.len() - 1, self.gap.len());
        let by_turn = Part::by_turn(p, &(p.point - point.start), (axle, &point.place));
        let first_row = |v: &Vec3| Vec3::x() * v.transpose();
        let bears = -first_row(&axle.velocity(&point.place));
        self.gap[last] += by_turn.gap * w;
        self.normal[last] += by_turn.normal * w;
        self.path[last] += by_turn.point * w;
        self.share[last] += bears * w;
        self.leaning[last] += bears * (p.normal - spread.normal) * w;
        let [of_turn, of_slave] = [by_turn, Part::on_tool(p)].map(|part| spread.pressing(point, response, &part));
        let turning = first_row(&spread.bears(point, &response.force).cross(&axle.turn()));
        let of_face = self.places[1..].iter().copied().zip(point.shapes.iter().copied());
        for (k, shape) in of_face.chain([(self.places[0], -1.0)]) {
            self.own[k * count + last] += of_turn * shape;
            self.own[last * count + k] += (bears * of_slave - turning) * shape;
        }
        self.own[last * count + last] += bears * of_turn;
    }

    /// Adds a run, whose nodes are at `places`, with how the handles of its patch change and bear; a tool has none.
    pub fn take(&mut self, run: &Run, of_patch: Option<(&Variation, Transfer)>) {
        let Self { places, rows, .. } = self;
        let (width, count) = (places.len(), self.gap.len());
        let masters = width - run.face;
        let corners = of_patch.map_or(1, |(v, _)| v.corners());
        // A node of the patch moves the coefficients of its edges, and is a handle if it is a corner; one of the face is a function.
        let own = |j: usize| if j < masters { (j < corners).then_some(j) } else { Some(HANDLES + j - masters) };
        let of_patch = |j: usize| of_patch.filter(|_| j < masters);
        let turns = |j: usize| of_patch(j).into_iter().flat_map(move |(v, _)| v.turns(j)).zip(EDGES..);
        let bearing = |j: usize| of_patch(j).into_iter().flat_map(move |(v, by)| v.bearing(by, j)).zip(EDGES..);
        let at = |of: &[Mat3; FUNCTIONS], j: usize| {
            turns(j).fold(own(j).map_or(Mat3::zeros(), |f| of[f]), |sum, (turn, f)| sum + of[f] * turn)
        };
        let vector = |of: &[Vec3; FUNCTIONS], j: usize| own(j).map_or(Vec3::zeros(), |f| of[f]);
        for (j, &k) in places.iter().enumerate() {
            self.normal[k] += at(&run.normal, j);
            self.path[k] += at(&run.path, j);
            self.gap[k] += turns(j).fold(vector(&run.gap, j), |sum, (turn, f)| sum + turn.tr_mul(&run.gap[f]));
            self.leaning[k] +=
                bearing(j).fold(vector(&run.leaning, j), |sum, (turn, f)| sum + turn.tr_mul(&run.leaning[f]));
            let share = Mat3::from_diagonal_element(own(j).map_or(0.0, |f| run.share[f]));
            self.share[k] += bearing(j).fold(share, |sum, (turn, f)| sum + turn.transpose() * run.share[f]);
        }
        rows.clear();
        run.own[..HANDLES + run.face].iter().for_each(|of| rows.extend((0..width).map(|j| at(of, j))));
        for (i, r) in places.iter().enumerate() {
            for (j, c) in places.iter().enumerate() {
                let by = |f: usize| rows[f * width + j];
                let sum = bearing(i).fold(own(i).map_or(Mat3::zeros(), by), |sum, (turn, f)| sum + turn.tr_mul(&by(f)));
                let bends = of_patch(i).and(of_patch(j)).map_or(Mat3::zeros(), |(v, _)| *v.second(i, j));
                self.own[r * count + c] += sum - bends;
            }
        }
    }
}

//! The scene: what the user wrote, as plain structs, checked for form but with nothing computed.
//!
//! Names stay names here; `model` resolves them against the meshes and reports through the [`Location`] that each
//! keeps.
//! [`load`] reads a scene file, [`parse`] its text, [`load_tools`] the tools alone; `key=value` overrides (`--set`) change any entry by its dotted key.
//!
#![doc = include_str!("../../docs/scene.md")]

mod amplitude;
mod contacts;
mod descriptions;
mod gravity;
mod keep;
mod materials;
mod names;
mod overrides;
mod parse;
mod probes;
mod reader;
mod references;
mod same;
mod schema;
mod solver;
mod spin;
mod steps;
#[cfg(test)]
mod tests;
mod ties;
mod tools;
mod torque;
mod trade;
mod tree;

pub use amplitude::Amplitude;
pub use contacts::FEATURE_ANGLE;
pub use descriptions::{CadFile, Description, NormalSource, Profile, Shape, Sweep, SymmetryPlane, Tool, ToolMesh};
pub use gravity::Gravity;
pub use materials::AUXETIC;
pub use names::{did_you_mean, nearest};
pub use parse::{load, load_tools, parse};
pub use probes::{Probe, ProbePlace};
pub(crate) use references::body_of;
pub use schema::{begin, schema};
pub use spin::Spin;
pub use torque::Torque;
pub use trade::{Exact, Known, Trade, Varied, Vary};

use crate::Vec3;
pub use crate::contact::{Discretization, Enforcement, Interference, MasterSurface, Rotation, Tangent};
use crate::controls::Controls;
use crate::error::Location;
pub use crate::output::quantity::Quantity;
pub use crate::solid::element::Formulation;
pub use crate::solid::material::{Hardening, Hill, Isochoric, MaterialModel, Orthotropy};
pub use crate::surface::{Smoothing, Transfer, Weight};
use std::path::PathBuf;

/// A value with the place where the user wrote it.
#[derive(Clone, Debug)]
pub struct Located<T> {
    pub value: T,
    pub at: Location,
}

impl Located<String> {
    /// What a program gives.
    pub(crate) fn given(value: &str) -> Self {
        let at = Location { file: "the program".into(), line: 0, column: 0, text: "".into() };
        Self { value: value.to_string(), at }
    }
}

/// A whole scene file with its overrides applied.
#[derive(Clone, Debug)]
pub struct Scene {
    /// File stem of the scene file; the default output folder is `out/<name>`.
    pub name: String,
    pub title: String,
    /// The scene as run, overrides applied and files by their absolute paths, as TOML text; written to `scene.toml`.
    pub text: String,
    pub bodies: Vec<Body>,
    pub materials: Vec<Material>,
    pub tools: Vec<Tool>,
    pub contacts: Vec<Contact>,
    pub ties: Vec<Tie>,
    pub steps: Vec<Step>,
    pub output: Output,
    pub solver: Solver,
    pub controls: Controls,
    pub trade: Trade,
}

/// A deformable body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its name, located at its table header.
    pub name: Located<String>,
    pub mesh: MeshSource,
    /// Name of a material in [`Scene::materials`].
    pub material: Located<String>,
    /// Groups of its elements that are of other materials, with these.
    pub materials: Vec<(Located<String>, Located<String>)>,
    /// `None`: chosen by mesh and material.
    pub element: Option<Located<Formulation>>,
    pub shell: Shell,
    /// What makes of one layer of elements, whose two z-planes move as one with u_z = 0, a model of all of the body.
    pub reduction: Option<Located<Reduction>>,
    /// Groups, as `body.group`, that lie in planes of symmetry: the body goes on as its mirror image.
    pub symmetry: Vec<Located<String>>,
    /// How many times each element of the mesh is split by the midpoints of its edges, from 1 on.
    pub refine: Option<Located<u32>>,
}

/// How a body of one layer of elements along z stands for one in space, at the cost of a 2D model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// It goes on alike along z, and nothing moves there.
    PlaneStrain,
    /// It is turned about the y axis, of which x is the distance; nothing moves around. Its forces are those of the whole ring.
    Axisymmetric,
}

impl Reduction {
    /// What a body is.
    pub fn words(self) -> &'static str {
        match self {
            Self::PlaneStrain => "in plane strain",
            Self::Axisymmetric => "axisymmetric",
        }
    }

    /// The key of the scene that asks for it.
    pub fn key(self) -> &'static str {
        match self {
            Self::PlaneStrain => "plane_strain",
            Self::Axisymmetric => "axisymmetric",
        }
    }
}

impl Body {
    /// Whether it is one layer of elements that stands for all of it.
    pub fn is_layer(&self) -> bool {
        self.reduction.is_some()
    }

    /// Whether the layer is turned about the y axis.
    pub fn is_axisymmetric(&self) -> bool {
        self.reduction.as_ref().is_some_and(|reduction| reduction.value == Reduction::Axisymmetric)
    }
}

impl Scene {
    /// Whether the bodies are axisymmetric: all are, or the model is refused.
    pub fn is_axisymmetric(&self) -> bool {
        self.bodies.iter().any(Body::is_axisymmetric)
    }
}

/// What is asked of solid-shell elements.
#[derive(Clone, Debug, Default)]
pub struct Shell {
    /// Integration points through the thickness; `None`: by the material.
    pub points: Option<usize>,
    /// A group of faces on one side of the sheet; `None`: the thickness is the thinnest direction.
    pub face: Option<Located<String>>,
}

/// Where a mesh comes from.
#[derive(Clone, Debug)]
pub enum MeshSource {
    /// A Gmsh or Abaqus file (path made absolute or relative to the working directory), and the volume or surface
    /// group in it to take; `None` takes all.
    File { path: Located<PathBuf>, group: Option<Located<String>> },
    /// A structured block of hexahedra.
    Block(Located<Block>),
}

/// A structured block of hexahedra.
#[derive(Clone, Debug)]
pub struct Block {
    pub shape: BlockShape,
    /// Elements along the three directions (x, y, z) or (radius, angle, axis).
    pub elements: [usize; 3],
    /// Size of the last element over that of the first along each direction; 1 is uniform.
    pub grading: [f64; 3],
    /// Further group names for faces: (name, default face names). The default face names are `xmin, xmax, ymin, ymax, zmin,
    /// zmax` of a box and `rmin, rmax, amin, amax, zmin, zmax` of a sector.
    pub faces: Vec<FaceGroup>,
}

/// The name of a group of block faces, and the faces.
pub type FaceGroup = (Located<String>, Vec<Located<String>>);

/// The region that a block fills.
#[derive(Clone, Debug)]
pub enum BlockShape {
    Box {
        origin: Vec3,
        size: Vec3,
    },
    /// A sector of a ring or cylinder about an axis parallel to z through `center`; angles in degrees, from x towards y;
    /// a span of 360 closes on itself.
    Sector {
        center: Vec3,
        radii: [f64; 2],
        angles: [f64; 2],
        length: f64,
    },
}

/// A material card.
#[derive(Clone, Debug)]
pub struct Material {
    pub name: Located<String>,
    pub model: MaterialModel,
    /// Mass per reference volume.
    pub density: Option<f64>,
}

/// A contact pair.
#[derive(Clone, Debug)]
pub struct Contact {
    pub name: Located<String>,
    /// `body.group`.
    pub slave: Located<String>,
    /// A tool, or `body.group`.
    pub master: Located<String>,
    /// How the master acts when it is on a body; `None` for a tool.
    pub surface: Option<MasterSurface>,
    pub discretization: Discretization,
    /// Coulomb coefficient; 0 is frictionless.
    pub friction: f64,
    pub method: Enforcement,
    /// Force per length. `None` is "auto": the stiffness of the slave node, or of a softer master, times 0.2 with multipliers
    /// as unknowns, 1000 for Uzawa's method, 100 for the penalty method.
    pub penalty: Option<f64>,
    /// Penetration, and slip of sticking nodes, at which Uzawa's outer iterations end, a length. `None` is "auto": as much as
    /// the tolerance of the solver lets through, by the largest nodal stiffness.
    pub tolerance: Option<f64>,
    /// How far a slave node may be from the master and still be watched; `None` chooses it from the meshes.
    pub reach: Option<f64>,
    /// What becomes of the overlap with which it begins.
    pub interference: Interference,
    pub tangent: Tangent,
    /// From segment to segment the slave's smooth faces are curved as they are deformed, not as they are meshed.
    pub slave_follows: bool,
    /// Of a sheet both of whose sides are in self-contact; `None` measures it.
    pub thickness: Option<f64>,
    /// Among [`Scene::passes`] the first pass, of which this is the second.
    pub second_of: Option<usize>,
}

impl Contact {
    /// Whether a surface meets itself.
    pub fn is_self(&self) -> bool {
        self.slave.value == self.master.value
    }

    /// From which angle on, in degrees, edges of the slave are sharp: as those of a master on a body.
    pub fn slave_feature_angle(&self) -> f64 {
        self.surface.map_or(FEATURE_ANGLE, |given| given.feature_angle)
    }
}

/// Faces that are joined to others for good, with unlike meshes.
#[derive(Clone, Debug)]
pub struct Tie {
    pub name: Located<String>,
    /// `body.group`, of which the nodes follow.
    pub slave: Located<String>,
    /// `body.group`.
    pub master: Located<String>,
    /// Largest gap or overlap that is closed where the meshes begin; `None` is a share of their edges.
    pub tolerance: Option<f64>,
}

/// A step: the conditions listed act during it, and only they do. What it keeps of the one before is listed, too.
#[derive(Clone, Debug)]
pub struct Step {
    pub name: Located<String>,
    pub duration: f64,
    pub increment: Increment,
    pub fix: Vec<Fix>,
    pub moves: Vec<Move>,
    pub forces: Vec<Force>,
    pub torques: Vec<Torque>,
    pub pressures: Vec<Pressure>,
    pub body_forces: Vec<BodyForce>,
    pub spins: Vec<Spin>,
    pub springs: Vec<Spring>,
    pub dashpots: Vec<Dashpot>,
    pub gravity: Option<Located<Gravity>>,
    /// What gravity makes of the densities.
    pub weights: Vec<BodyForce>,
    /// Supports that the step keeps nothing of, for it lists their sets again.
    pub replaced: Vec<Fix>,
}

impl Step {
    /// A step of a program, not of a scene file, in which nothing acts yet: of so many even increments over a time of 1.
    ///
    /// ```
    /// use nagata::scene::Step;
    ///
    /// let draw = Step::new("draw", 20).fixing("pad.bottom").moving("roller", [10.0, 0.0, 0.0]);
    /// assert_eq!((draw.increment.max, draw.moves.len()), (0.05, 1));
    /// ```
    ///
    /// # Panics
    /// Without increments.
    pub fn new(name: &str, increments: usize) -> Self {
        assert!(increments > 0, "a step has an increment or more");
        let size = 1.0 / increments as f64;
        Self {
            name: Located::given(name),
            duration: 1.0,
            increment: Increment { initial: size, min: size / 1024.0, max: size, limits: Limits::default() },
            fix: Vec::new(),
            moves: Vec::new(),
            forces: Vec::new(),
            torques: Vec::new(),
            pressures: Vec::new(),
            body_forces: Vec::new(),
            spins: Vec::new(),
            springs: Vec::new(),
            dashpots: Vec::new(),
            gravity: None,
            weights: Vec::new(),
            replaced: Vec::new(),
        }
    }

    /// Holds the nodes of a set in all directions.
    pub fn fixing(mut self, set: &str) -> Self {
        self.fix.push(Fix { set: Located::given(set), directions: [true; 3], normal: None, around: None });
        self
    }

    /// Moves a tool, or the nodes of a set.
    pub fn moving(mut self, target: &str, by: [f64; 3]) -> Self {
        self.moves.push(Move::new(target, by.into(), None));
        self
    }

    /// Turns a tool, or the nodes of a set, by degrees about an axis through a point.
    pub fn turning(mut self, target: &str, point: [f64; 3], axis: [f64; 3], angle: f64) -> Self {
        let rotation = Rotation { point: point.into(), axis: Vec3::from(axis).normalize(), angle };
        self.moves.push(Move::new(target, Vec3::zeros(), Some(rotation)));
        self
    }

    /// Pushes a tool, which is free along the `directions`, or a set, where they do not count.
    pub fn pushing(mut self, target: &str, total: [f64; 3], directions: [bool; 3]) -> Self {
        self.forces.push(Force { target: Located::given(target), total: total.into(), directions, table: None });
        self
    }

    /// Presses on faces.
    pub fn pressing(mut self, set: &str, value: f64) -> Self {
        self.pressures.push(Pressure { set: Located::given(set), value, table: None });
        self
    }

    /// Degrees that a tool may turn by in an increment. Slip is measured along the chord of the way of a point, which is 1.1 %
    /// shorter than its arc then, and normals turn by as much at once; a full turn would be no motion at all.
    pub const TURN: f64 = 30.0;

    /// Increment sizes by which no tool turns too far at once.
    pub fn sizes(&self) -> Increment {
        let fastest = |m: &Move| m.table.as_ref().map_or(1.0, Amplitude::steepest);
        let angle = |m: &Move| m.rotate.map_or(0.0, |r| r.angle.abs() * fastest(m));
        let parts = (self.moves.iter().map(angle).fold(0.0, f64::max) / Self::TURN - 1e-9).ceil().max(1.0);
        let Increment { initial, min, max, limits } = self.increment;
        let max = max.min(self.duration / parts);
        Increment { initial: initial.min(max), min: min.min(max), max, limits }
    }

    /// Fractions of the step at which a table turns, in their order; no increment steps over one.
    pub fn corners(&self) -> Vec<f64> {
        /// Fractions that differ by less are one.
        const ONE: f64 = 1e-9;
        let tables = (self.moves.iter().filter_map(|m| m.table.as_ref()))
            .chain(self.forces.iter().filter_map(|f| f.table.as_ref()))
            .chain(self.torques.iter().filter_map(|t| t.table.as_ref()))
            .chain(self.pressures.iter().filter_map(|p| p.table.as_ref()))
            .chain(self.body_forces.iter().filter_map(|b| b.table.as_ref()))
            .chain(self.spins.iter().filter_map(|spin| spin.table.as_ref()))
            .chain(self.gravity.iter().filter_map(|gravity| gravity.value.table.as_ref()));
        let mut corners: Vec<f64> = tables.flat_map(Amplitude::corners).collect();
        corners.sort_by(f64::total_cmp);
        corners.dedup_by(|later, earlier| *later - *earlier < ONE);
        corners
    }
}

/// Increment sizes, in the time of the step.
#[derive(Clone, Copy, Debug)]
pub struct Increment {
    pub initial: f64,
    pub min: f64,
    pub max: f64,
    pub limits: Limits,
}

/// What an increment may change by its trial state; else it is shortened.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Largest principal logarithmic strain at an integration point.
    pub strain: Option<f64>,
    /// Share of the slave nodes that touch or leave.
    pub contacts: Option<f64>,
}

/// Holds nodes where they are in the given directions.
#[derive(Clone, Debug)]
pub struct Fix {
    /// `body.group` or `body`.
    pub set: Located<String>,
    /// None with `normal` or `around`.
    pub directions: [bool; 3],
    /// A unit vector along which alone nodes are held.
    pub normal: Option<Vec3>,
    /// In the directions of a cylindrical frame.
    pub around: Option<Around>,
}

/// A cylindrical frame, in which nodes keep the directions that they have there as they are meshed: away from the axis, around
/// it, along it.
#[derive(Clone, Copy, Debug)]
pub struct Around {
    pub point: Vec3,
    /// A unit vector.
    pub axis: Vec3,
    /// Directions that are prescribed.
    pub directions: [bool; 3],
    /// Displacement along them over the step.
    pub by: Vec3,
}

impl Around {
    /// The distance of a place from the axis, and r, t and z there; on the axis r and t are 0.
    pub fn frame(&self, place: &Vec3) -> (f64, [Vec3; 3]) {
        let arm = place - self.point;
        let across = arm - self.axis * self.axis.dot(&arm);
        let outward = across.try_normalize(0.0).unwrap_or_default();
        (across.norm(), [outward, self.axis.cross(&outward), self.axis])
    }
}

/// Moves a tool or the nodes of a set over the step.
#[derive(Clone, Debug)]
pub struct Move {
    /// A tool, `body.group` or `body`.
    pub target: Located<String>,
    /// Displacement over the step; none with `around`, which has its own.
    pub by: Vec3,
    /// Directions that are prescribed; for a tool always all three, none with `normal` or `around`.
    pub directions: [bool; 3],
    /// A unit vector along which alone the nodes of a set are prescribed.
    pub normal: Option<Vec3>,
    /// In the directions of a cylindrical frame.
    pub around: Option<Around>,
    /// Rotation over the step about an axis through a point; a set has the directions across it then.
    pub rotate: Option<Rotation>,
    /// The share of both that is done; `None` for a straight ramp.
    pub table: Option<Amplitude>,
}

impl Move {
    /// Along a straight ramp, in all directions.
    fn new(target: &str, by: Vec3, rotate: Option<Rotation>) -> Self {
        let target = Located::given(target);
        Self { target, by, directions: [true; 3], normal: None, around: None, rotate, table: None }
    }
}

/// A total force on a set (spread by area, or evenly over bare nodes), or on a tool, which is then free to
/// translate in `directions`. Ramps linearly from its value at the end of the last step; on a tool that was not driven by
/// force until then, from the force that held it.
#[derive(Clone, Debug)]
pub struct Force {
    pub target: Located<String>,
    pub total: Vec3,
    /// Free directions of a tool; ignored for sets.
    pub directions: [bool; 3],
    /// The share of `total` that acts; `None` for a straight ramp from what acted before.
    pub table: Option<Amplitude>,
}

/// A follower pressure on faces, positive when it pushes into the body.
#[derive(Clone, Debug)]
pub struct Pressure {
    pub set: Located<String>,
    pub value: f64,
    /// As that of a force.
    pub table: Option<Amplitude>,
}

/// A force per reference volume on a body.
#[derive(Clone, Debug)]
pub struct BodyForce {
    pub body: Located<String>,
    /// On one of [`Scene::sections`] alone.
    pub section: Option<usize>,
    pub per_volume: Vec3,
    /// As that of a force.
    pub table: Option<Amplitude>,
}

/// Springs between the nodes of a set and the ground, at rest where the nodes are meshed.
#[derive(Clone, Debug)]
pub struct Spring {
    /// `body.group` or `body`.
    pub set: Located<String>,
    /// Of all of them together along x, y and z, force per length.
    pub stiffness: Vec3,
}

/// Dashpots between the nodes of a set and the ground.
#[derive(Clone, Debug)]
pub struct Dashpot {
    /// `body.group` or `body`.
    pub set: Located<String>,
    /// Of all of them together along x, y and z, force per velocity.
    pub damping: Vec3,
}

/// What is written, and how often.
#[derive(Clone, Debug)]
pub struct Output {
    /// Every so many increments; the last of each step always is.
    pub every: usize,
    /// How often all is kept that a run goes on from.
    pub checkpoint: Option<Checkpoint>,
    /// Sets whose displacement and reaction stand in the history: `body.group`, `body`.
    pub history: Vec<Located<String>>,
    /// Fields that are written; displacements always are.
    pub fields: Vec<Quantity>,
    /// Whether they are described for VTK, too.
    pub vtkhdf: bool,
    pub probes: Vec<Probe>,
}

/// How often a checkpoint is written, besides at the end of the run; whichever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checkpoint {
    /// Every so many increments.
    pub increments: Option<usize>,
    /// After so many minutes of wall time.
    pub minutes: Option<f64>,
}

/// Controls of the nonlinear solution.
#[derive(Clone, Debug)]
pub struct Solver {
    /// What the settings that a scene does not give are those of.
    pub accuracy: Accuracy,
    /// Increments of the steps are so many times as long as these say; it has been applied to them.
    pub pace: f64,
    /// Largest residual over the largest force of the scene.
    pub tolerance: f64,
    /// Newton iterations before an increment is cut.
    pub max_iterations: usize,
    /// Force that stands for "the forces of the scene" while there is none; `None` derives it from the stiffness.
    pub force_floor: Option<Located<f64>>,
    pub linear: Linear,
}

/// Presets that trade speed for accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accuracy {
    /// Fast: the answer in large.
    Draft,
    /// As the scene says.
    #[default]
    Balanced,
    /// To measure others by.
    Reference,
}

/// How linear systems are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Linear {
    /// As their size says.
    #[default]
    Auto,
    /// By a factorization for each.
    Direct,
    /// By factorization, or by iteration with the factors of an earlier system where that is cheaper.
    Reuse,
    /// By iteration with multigrid, and by factorization where that fails.
    Iterative,
}

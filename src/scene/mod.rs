//! The scene: what the user wrote, as plain structs, checked for form but with nothing computed.
//!
//! Names stay names here; `model` resolves them against the meshes and reports through the [`Location`] that each
//! keeps.
//! [`load`] reads a scene file, [`parse`] its text, [`load_tools`] the tools alone; `key=value` overrides (`--set`) change any entry by its dotted key.
//!
#![doc = include_str!("../../docs/scene.md")]

mod contacts;
mod descriptions;
mod materials;
mod names;
mod overrides;
mod parse;
mod reader;
mod references;
mod steps;
#[cfg(test)]
mod tests;
mod tools;
mod tree;

pub use descriptions::{
    CadFile, Description, NormalSource, Profile, Shape, Smoothing, Sweep, SymmetryPlane, Tool, ToolMesh, Weight,
};
pub use names::{did_you_mean, nearest};
pub use parse::{load, load_tools, parse};
pub(crate) use references::body_of;

use crate::error::Location;
use crate::{Mat3, Vec3};
use std::path::PathBuf;

/// A value with the place where the user wrote it.
#[derive(Clone, Debug)]
pub struct Located<T> {
    pub value: T,
    pub at: Location,
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
    pub steps: Vec<Step>,
    pub output: Output,
    pub solver: Solver,
}

/// A deformable body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its name, located at its table header.
    pub name: Located<String>,
    pub mesh: MeshSource,
    /// Name of a material in [`Scene::materials`].
    pub material: Located<String>,
    /// `None`: chosen by mesh and material.
    pub element: Option<Located<Element>>,
    /// u_z = 0 in a body of one layer of elements whose two z-planes move as one, at the cost of a 2D model.
    pub plane_strain: Option<Located<bool>>,
    /// Groups, as `body.group`, that lie in planes of symmetry: the body goes on as its mirror image.
    pub symmetry: Vec<Located<String>>,
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

/// The element formulations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// 8-node hexahedron, full 2x2x2 integration.
    Hex8,
    /// 8-node hexahedron, F-bar.
    Hex8Fbar,
    /// 8-node hexahedron, selective reduced integration with the mean change of volume.
    Hex8Sri,
    /// 8-node hexahedron, enhanced assumed strain.
    Hex8Eas,
    /// 4-node tetrahedron.
    Tet4,
}

impl Element {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Hex8, Self::Hex8Fbar, Self::Hex8Sri, Self::Hex8Eas, Self::Tet4];

    /// What the user calls it.
    pub fn key(self) -> &'static str {
        match self {
            Self::Hex8 => "hex8",
            Self::Hex8Fbar => "hex8-fbar",
            Self::Hex8Sri => "hex8-sri",
            Self::Hex8Eas => "hex8-eas",
            Self::Tet4 => "tet4",
        }
    }
}

/// A material card.
#[derive(Clone, Debug)]
pub struct Material {
    pub name: Located<String>,
    pub model: MaterialModel,
}

/// The material models and their parameters, checked to be physical.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialModel {
    /// W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J.
    NeoHookean { young: f64, poisson: f64 },
    /// Kirchhoff stress linear in the logarithmic strain.
    Hooke { young: f64, poisson: f64 },
    /// Elastic-plastic in logarithmic strain, by von Mises or, when given, by Hill.
    Plastic { young: f64, poisson: f64, hill: Option<Hill>, hardening: Hardening },
}

impl MaterialModel {
    /// Young's modulus.
    pub fn young(&self) -> f64 {
        match *self {
            Self::NeoHookean { young, .. } | Self::Hooke { young, .. } | Self::Plastic { young, .. } => young,
        }
    }
}

impl MaterialModel {
    /// Why the material nearly keeps its volume, in words that follow "a material"; `None` when it does not.
    pub fn keeps_volume(&self) -> Option<&'static str> {
        /// Poisson's ratio from which elements with full integration are clearly too stiff.
        const STIFF: f64 = 0.45;
        match *self {
            Self::Plastic { .. } => Some("that flows plastically"),
            Self::NeoHookean { poisson, .. } | Self::Hooke { poisson, .. } if poisson > STIFF => {
                Some("with Poisson's ratio above 0.45")
            }
            _ => None,
        }
    }
}

/// Hill's criterion of 1948.
#[derive(Clone, Debug, PartialEq)]
pub struct Hill {
    /// F, G, H, L, M, N.
    pub coefficients: [f64; 6],
    /// Columns are the axes of the material in the reference state, orthonormal.
    pub axes: Mat3,
}

/// The yield stress by the equivalent plastic strain; it is above 0 and never falls.
#[derive(Clone, Debug, PartialEq)]
pub enum Hardening {
    /// yield_stress + modulus e; perfectly plastic when the modulus is 0.
    Linear { yield_stress: f64, modulus: f64 },
    /// k (e0 + e)^n.
    Swift { k: f64, e0: f64, n: f64 },
    /// yield_stress + modulus e + (saturation - yield_stress) (1 - exp(-rate e)).
    Voce { yield_stress: f64, saturation: f64, rate: f64, modulus: f64 },
    /// Points (e, stress) from e = 0; linear between them, constant after the last.
    Table(Vec<[f64; 2]>),
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
    pub tangent: Tangent,
    /// Of a sheet both of whose sides are in self-contact; `None` measures it.
    pub thickness: Option<f64>,
}

impl Contact {
    /// Whether a surface meets itself.
    pub fn is_self(&self) -> bool {
        self.slave.value == self.master.value
    }
}

/// Which nodes are kept out of what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Discretization {
    /// The slave's nodes out of the master's surface.
    #[default]
    OnePass,
    /// These, and the master's nodes out of the slave's surface.
    TwoPass,
    /// Each node of the slave out of the node of the master that it lies on, for small sliding on conforming meshes.
    NodeToNode,
}

/// How contact is enforced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Enforcement {
    /// Forces grow with penetration and slip; no multipliers.
    Penalty,
    /// Multipliers are the forces, under an active set that is fixed while Newton's method runs.
    Lagrange,
    /// Multipliers and penalty together in one system.
    #[default]
    AugmentedLagrangian,
    /// Multipliers are held while Newton's method runs, and take over the forces after it.
    Uzawa,
}

impl Enforcement {
    /// Every method with what the user calls it.
    pub const KEYS: [(&'static str, Self); 4] = [
        ("penalty", Self::Penalty),
        ("lagrange", Self::Lagrange),
        ("augmented-lagrangian", Self::AugmentedLagrangian),
        ("uzawa", Self::Uzawa),
    ];

    /// What the user calls it.
    pub fn key(self) -> &'static str {
        Self::KEYS.iter().find(|(_, method)| *method == self).map_or("", |(key, _)| key)
    }

    /// Whether multipliers are no unknowns.
    pub fn holds_multipliers(self) -> bool {
        matches!(self, Self::Penalty | Self::Uzawa)
    }
}

/// The faces of a body as a master.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MasterSurface {
    pub smoothing: Smoothing,
    /// Edges whose facets' normals differ by more stay sharp, degrees.
    pub feature_angle: f64,
    /// How the contact force goes to the master's nodes.
    pub transfer: Transfer,
}

/// How a force on a point of a deformable master is spread over the nodes: node j gets W_j^T F.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transfer {
    /// By the areas opposite to the patch's own nodes, eqs. (60)-(61) of the node-to-Nagata paper: W_j = w_j I.
    Bilinear,
    /// By the derivative of the patch by its own nodes at fixed nodal normals.
    #[default]
    Patch,
    /// By the derivative of the patch by all nodes: keeps force and moment, and makes frictionless tangents symmetric.
    Variational,
}

/// Which tangent contact elements have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tangent {
    /// The derivative of the residual.
    #[default]
    Exact,
    /// That of the paper, eqs. (68)-(70): as if normal, weights and slip origin stood still.
    FixedFrame,
}

/// A step: the conditions listed act during it, and only they do.
#[derive(Clone, Debug)]
pub struct Step {
    pub name: Located<String>,
    pub duration: f64,
    pub increment: Increment,
    pub fix: Vec<Fix>,
    pub moves: Vec<Move>,
    pub forces: Vec<Force>,
    pub pressures: Vec<Pressure>,
    pub body_forces: Vec<BodyForce>,
}

impl Step {
    /// Degrees that a tool may turn by in an increment. Slip is measured along the chord of the way of a point, which is 1.1 %
    /// shorter than its arc then, and normals turn by as much at once; a full turn would be no motion at all.
    pub const TURN: f64 = 30.0;

    /// Increment sizes by which no tool turns too far at once.
    pub fn sizes(&self) -> Increment {
        let angle = |m: &Move| m.rotate.map_or(0.0, |r| r.angle.abs());
        let parts = (self.moves.iter().map(angle).fold(0.0, f64::max) / Self::TURN - 1e-9).ceil().max(1.0);
        let Increment { initial, min, max, limits } = self.increment;
        let max = max.min(self.duration / parts);
        Increment { initial: initial.min(max), min: min.min(max), max, limits }
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
    pub directions: [bool; 3],
}

/// Moves a tool or the nodes of a set over the step, linearly in time.
#[derive(Clone, Debug)]
pub struct Move {
    /// A tool, `body.group` or `body`.
    pub target: Located<String>,
    /// Displacement over the step.
    pub by: Vec3,
    /// Directions that are prescribed; for a tool always all three.
    pub directions: [bool; 3],
    /// Rotation over the step about an axis through a point (tools only).
    pub rotate: Option<Rotation>,
}

/// A rotation about a fixed axis, a unit vector.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    pub point: Vec3,
    pub axis: Vec3,
    /// Degrees, right-handed.
    pub angle: f64,
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
}

/// A follower pressure on faces, positive when it pushes into the body.
#[derive(Clone, Debug)]
pub struct Pressure {
    pub set: Located<String>,
    pub value: f64,
}

/// A force per reference volume on a body.
#[derive(Clone, Debug)]
pub struct BodyForce {
    pub body: Located<String>,
    pub per_volume: Vec3,
}

/// What is written, and how often.
#[derive(Clone, Debug)]
pub struct Output {
    /// Every so many increments; the last of each step always is.
    pub every: usize,
    /// Sets whose displacement and reaction stand in the history: `body.group`, `body`.
    pub history: Vec<Located<String>>,
}

/// Controls of the nonlinear solution.
#[derive(Clone, Copy, Debug)]
pub struct Solver {
    /// Largest residual over the largest force of the scene.
    pub tolerance: f64,
    /// Newton iterations before an increment is cut.
    pub max_iterations: usize,
    /// Force that stands for "the forces of the scene" while there is none; `None` derives it from the stiffness.
    pub force_floor: Option<f64>,
}

//! Kinds of work, and what each takes on a machine.

use crate::mesh::SolidShape;
use crate::scene::{Formulation, Isochoric, MaterialModel};
use std::collections::BTreeMap;

/// How an element is evaluated, as far as it decides its cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shape {
    /// In space, as its key says.
    Solid(&'static str),
    /// In a layer, in plane strain or axisymmetric.
    Plane(&'static str),
}

/// What is counted, each by its own unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Work {
    /// Residual and tangent of an element, added to the matrix.
    Element(Shape, &'static str),
    /// A slave node with its contact element, an iterate.
    Slave,
    /// A node or an unknown in what each iterate takes besides.
    Unknown,
    /// A factorization, however small; an operation of it.
    Factorization,
    Operation,
    /// An entry of the factors that are computed.
    Entry,
    /// An entry of the factors that are applied, and an unknown.
    Application,
    Row,
    /// An entry of the matrix in an iteration with old factors.
    Product,
    /// An entry of the matrix for which multigrid is set up.
    SetUp,
    /// An entry of the matrix in an iteration with multigrid.
    Cycle,
}

const MATERIALS: [&str; 4] = ["neo-hookean", "hooke", "j2", "hill"];

impl Work {
    /// An element with a material.
    pub fn element(element: Formulation, plane: bool, material: &MaterialModel) -> Self {
        let shape = if plane { Shape::Plane(element.key()) } else { Shape::Solid(element.key()) };
        let law = match material {
            MaterialModel::NeoHookean { .. } => MATERIALS[0],
            // As long as others of invariants, or of principal stretches.
            MaterialModel::Hyperelastic { law: Isochoric::MooneyRivlin { .. } | Isochoric::Yeoh { .. }, .. } => {
                MATERIALS[0]
            }
            MaterialModel::Hooke { .. } | MaterialModel::Hyperelastic { law: Isochoric::Ogden(_), .. } => MATERIALS[1],
            // As long as plasticity that does not flow.
            MaterialModel::Plastic { hill: None, .. } | MaterialModel::Orthotropic(_) => MATERIALS[2],
            MaterialModel::Plastic { hill: Some(_), .. } => MATERIALS[3],
        };
        Self::Element(shape, law)
    }

    /// All of them.
    pub fn all() -> Vec<Self> {
        let in_space = Formulation::ALL.iter().map(|element| Shape::Solid(element.key()));
        let is_plane =
            |element: &&Formulation| element.shape() == SolidShape::Hex8 && **element != Formulation::Hex8Shell;
        let bricks = Formulation::ALL.iter().filter(is_plane);
        let shapes = in_space.chain(bricks.map(|element| Shape::Plane(element.key())));
        let elements = shapes.flat_map(|shape| MATERIALS.map(|material| Self::Element(shape, material)));
        elements.chain(Self::OTHERS).collect()
    }

    /// What is no element.
    const OTHERS: [Self; 10] = [
        Self::Slave,
        Self::Unknown,
        Self::Factorization,
        Self::Operation,
        Self::Entry,
        Self::Application,
        Self::Row,
        Self::Product,
        Self::SetUp,
        Self::Cycle,
    ];

    /// Its name in a table, and in a file.
    pub fn name(self) -> String {
        match self {
            Self::Element(Shape::Solid(element), material) => format!("{element}, {material}"),
            Self::Element(Shape::Plane(element), material) => format!("{element} in plane strain, {material}"),
            Self::Slave => "slave node".into(),
            Self::Unknown => "unknown in an iteration".into(),
            Self::Factorization => "factorization, however small".into(),
            Self::Operation => "operation of a factorization".into(),
            Self::Entry => "entry of factors".into(),
            Self::Application => "entry of factors that are applied".into(),
            Self::Row => "unknown to which factors are applied".into(),
            Self::Product => "entry of a matrix in a product".into(),
            Self::SetUp => "entry of a matrix in a set-up of multigrid".into(),
            Self::Cycle => "entry of a matrix in an iteration of multigrid".into(),
        }
    }

    /// Nanoseconds on one core of a machine of 2024.
    fn usual(self) -> f64 {
        match self {
            Self::Element(shape, material) => {
                let (k, plane) = match shape {
                    Shape::Solid(element) => (element, false),
                    Shape::Plane(element) => (element, true),
                };
                let of_shape = match (k, plane) {
                    ("tet4", _) => 600.0,
                    ("tet10" | "tet10-sri", _) => 3000.0,
                    ("wedge6" | "wedge6-sri", _) => 1800.0,
                    ("pyramid5" | "pyramid5-sri", _) => 2000.0,
                    ("hex8-fbar", false) => 5000.0,
                    ("hex8-eas" | "hex8-shell", false) => 16_000.0,
                    ("wedge18" | "wedge18-sri", _) => 20_000.0,
                    ("hex27", _) => 60_000.0,
                    (_, false) => 3300.0,
                    ("hex8-eas", true) => 4000.0,
                    (_, true) => 1000.0,
                };
                of_shape
                    * match (material, k) {
                        ("neo-hookean", _) => 1.0,
                        ("hooke", _) => 1.7,
                        (_, "hex8-eas" | "hex8-fbar") => 2.6,
                        // More points, too.
                        (_, "hex8-shell") => 6.5,
                        _ => 4.0,
                    }
            }
            Self::Slave => 5000.0,
            Self::Unknown => 400.0,
            Self::Factorization => 1.2e6,
            Self::Operation => 0.02,
            Self::Entry => 14.0,
            Self::Application => 0.8,
            Self::Row => 120.0,
            Self::Product => 1.5,
            Self::SetUp => 120.0,
            Self::Cycle => 5.0,
        }
    }
}

/// Seconds that a unit of each kind of work takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Rates(BTreeMap<Work, f64>);

impl Default for Rates {
    /// Those of a usual machine.
    fn default() -> Self {
        Self(Work::all().into_iter().map(|work| (work, 1e-9 * work.usual())).collect())
    }
}

impl Rates {
    /// Seconds of a unit.
    pub fn of(&self, work: Work) -> f64 {
        self.0.get(&work).copied().unwrap_or_default()
    }

    /// Notes what has been measured, s.
    pub fn set(&mut self, work: Work, seconds: f64) {
        self.0.insert(work, seconds);
    }

    /// All of them, with what they are of.
    pub fn iter(&self) -> impl Iterator<Item = (Work, f64)> + '_ {
        self.0.iter().map(|(work, seconds)| (*work, *seconds))
    }
}

/// Power of the number of ranks with which work that they share grows faster: measured on 1 and 2 of one machine
/// (docs/validation/scaling.md).
const OF_FACTORS: f64 = 0.45;
const OF_PRODUCTS: f64 = 0.78;

impl Rates {
    /// What was measured on so many ranks, as it may be expected on others. Elements and slave nodes are counted on the rank with
    /// most, all else over all.
    pub(super) fn on(mut self, measured: usize, wanted: usize) -> Self {
        let ratio = measured as f64 / wanted as f64;
        for (work, seconds) in &mut self.0 {
            *seconds *= match work {
                Work::Element(..) | Work::Slave | Work::Factorization => 1.0,
                Work::Operation | Work::Entry | Work::Application | Work::Row => ratio.powf(OF_FACTORS),
                Work::Unknown | Work::Product | Work::SetUp | Work::Cycle => ratio.powf(OF_PRODUCTS),
            };
        }
        self
    }
}

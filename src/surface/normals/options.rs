//! What users decide about nodal normals.

use super::weight::Weight;
use crate::Vec3;
use crate::controls::Controls;

/// How nodal normals are found.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalOptions {
    pub weight: Weight,
    /// Degrees; edges whose facets' normals differ by more are sharp.
    pub feature_angle: f64,
    /// Groups of the mesh whose edges are sharp at any angle: those of its lines, the border of its facets, or, in a
    /// group of nodes alone, the edges from one to another of them.
    pub sharp: Vec<String>,
    /// Point and unit normal of planes in which the mesh ends and its surface goes on as its mirror image.
    pub symmetry: Vec<(Vec3, Vec3)>,
    /// Normals known from elsewhere, for each facet of the mesh those at its nodes; sign and length mean nothing. They
    /// take the place of the mean and of the rules for junctions and ends.
    pub given: Option<Vec<[Vec3; 4]>>,
    pub controls: Controls,
}

impl Default for NormalOptions {
    fn default() -> Self {
        Self {
            weight: Weight::default(),
            feature_angle: 40.0,
            sharp: Vec::new(),
            symmetry: Vec::new(),
            given: None,
            controls: Controls::default(),
        }
    }
}

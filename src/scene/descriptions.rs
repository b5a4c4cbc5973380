//! A tool as the user describes it.

use super::{Located, MeshSource, Smoothing, Weight};
use crate::Vec3;
use std::path::PathBuf;

/// A rigid surface, described in one or more ways.
#[derive(Clone, Debug)]
pub struct Tool {
    pub name: Located<String>,
    pub mesh: Option<ToolMesh>,
    pub nurbs: Option<CadFile>,
    pub bezier: Option<CadFile>,
    /// Closed forms, each of another kind.
    pub shapes: Vec<Shape>,
    /// The description that acts; it is given.
    pub smoothing: Located<Description>,
    /// Edges of meshes and CAD faces whose normals differ by more stay sharp, degrees.
    pub feature_angle: f64,
    /// Turn meshes, CAD faces and profiles over.
    pub flip: bool,
}

/// The ways to describe the surface of a tool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Description {
    Mesh(Smoothing),
    Nurbs,
    Bezier,
    Plane,
    Cylinder,
    Cone,
    Sphere,
    Torus,
    Profile,
}

/// The surface mesh of a tool; its facets' outward normals point to the bodies.
#[derive(Clone, Debug)]
pub struct ToolMesh {
    pub source: MeshSource,
    pub normals: NormalSource,
    /// Groups whose edges stay sharp.
    pub sharp: Vec<Located<String>>,
    pub symmetry: Vec<SymmetryPlane>,
    /// How many times each facet is split by the midpoints of its edges, from 1 on.
    pub refine: Option<Located<u32>>,
}

/// Where the nodal normals of a mesh come from.
#[derive(Clone, Debug)]
pub enum NormalSource {
    /// The facets around the node.
    Facets(Weight),
    /// The nearest point of another description of the tool, which is given and no mesh.
    Description(Located<Description>),
}

/// A plane in which a mesh ends and its surface goes on as its mirror image; `normal` is a unit vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetryPlane {
    pub point: Vec3,
    pub normal: Vec3,
}

/// A file of a CAD model (path made absolute or relative to the working directory).
#[derive(Clone, Debug)]
pub struct CadFile {
    pub path: Located<PathBuf>,
    /// Leave out what cannot be read.
    pub incomplete: bool,
    /// Gap up to which faces are joined; `None` chooses it by the model.
    pub tolerance: Option<f64>,
}

/// A surface with a closed form, solid inside or, when `hollow`, a bore; normals and axes are unit vectors.
#[derive(Clone, Debug)]
pub enum Shape {
    /// The half space behind the plane is solid; `normal` points out of it.
    Plane {
        point: Vec3,
        normal: Vec3,
    },
    Cylinder {
        point: Vec3,
        axis: Vec3,
        radius: f64,
        hollow: bool,
    },
    /// `axis` runs from the apex into the cone; `angle` is half of its opening, degrees.
    Cone {
        apex: Vec3,
        axis: Vec3,
        angle: f64,
        hollow: bool,
    },
    Sphere {
        center: Vec3,
        radius: f64,
        hollow: bool,
    },
    /// Radii of the ring and of its tube, which is the smaller.
    Torus {
        center: Vec3,
        axis: Vec3,
        radius: f64,
        tube: f64,
        hollow: bool,
    },
    Profile(Profile),
}

/// A chain of lines with rounded corners in a plane, and what becomes of it; the solid is on the left hand of the way
/// along it.
#[derive(Clone, Debug)]
pub struct Profile {
    /// (x, y) or (radius, height); two or more, three if closed.
    pub points: Vec<Located<[f64; 2]>>,
    /// Radius at each point; 0 leaves it sharp. The ends of an open chain have none.
    pub fillets: Vec<Located<f64>>,
    /// The last point is joined to the first.
    pub closed: bool,
    pub sweep: Sweep,
}

/// What becomes of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// Drawn out along x cross y (unit vectors at a right angle), by a length from the origin or without end.
    Extrude { origin: Vec3, x: Vec3, y: Vec3, length: Option<f64> },
    /// Turned about the axis, a unit vector; heights count along it from `point`.
    Revolve { point: Vec3, axis: Vec3 },
}

impl Description {
    /// All descriptions, by what the user calls them.
    pub const ALL: [(&str, Self); 10] = [
        ("facet", Self::Mesh(Smoothing::Facet)),
        ("nagata", Self::Mesh(Smoothing::Nagata)),
        ("nurbs", Self::Nurbs),
        ("bezier", Self::Bezier),
        ("plane", Self::Plane),
        ("cylinder", Self::Cylinder),
        ("cone", Self::Cone),
        ("sphere", Self::Sphere),
        ("torus", Self::Torus),
        ("profile", Self::Profile),
    ];

    /// Whether it stands in a file beside the scene.
    pub fn has_file(self) -> bool {
        matches!(self, Self::Mesh(_)) || self.is_cad()
    }

    /// Whether it is made of the faces of a CAD file.
    pub fn is_cad(self) -> bool {
        matches!(self, Self::Nurbs | Self::Bezier)
    }

    /// What the user calls it.
    pub fn key(self) -> &'static str {
        Self::ALL.iter().find(|(_, description)| *description == self).map_or("", |(key, _)| key)
    }
}

impl Shape {
    /// Its kind.
    pub fn description(&self) -> Description {
        match self {
            Self::Plane { .. } => Description::Plane,
            Self::Cylinder { .. } => Description::Cylinder,
            Self::Cone { .. } => Description::Cone,
            Self::Sphere { .. } => Description::Sphere,
            Self::Torus { .. } => Description::Torus,
            Self::Profile(_) => Description::Profile,
        }
    }
}

impl Tool {
    /// The descriptions that are given.
    pub fn descriptions(&self) -> Vec<Description> {
        let mut given = Vec::new();
        if self.mesh.is_some() {
            given.extend([Description::Mesh(Smoothing::Facet), Description::Mesh(Smoothing::Nagata)]);
        }
        given.extend(self.nurbs.as_ref().map(|_| Description::Nurbs));
        given.extend(self.bezier.as_ref().map(|_| Description::Bezier));
        given.extend(self.shapes.iter().map(Shape::description));
        given
    }
}

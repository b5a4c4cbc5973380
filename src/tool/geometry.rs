//! One description of a tool as a whole, from its files.

use super::normals::from_surface;
use super::shape::Shape;
use crate::cad::{self, Cad};
use crate::controls::Controls;
use crate::error::{Error, Result};
use crate::mesh::{self, Group, Mesh};
use crate::refine;
use crate::scene::{self, CadFile, Description, Located, NormalSource, Smoothing, ToolMesh};
use crate::surface::analytic::{Axis, Chain, Cone, Cylinder, Misfit, Plane, Profile, Sphere, Sweep, Torus};
use crate::surface::faces::{FaceSet, SewnFace, sew, usual_tolerance};
use crate::surface::facets::Facets;
use crate::surface::{Analytic, Edge, NormalOptions, Patch, PatchSet, patches_from_mesh, smooth};

/// The whole surface of a tool.
pub enum Geometry {
    Patches(Vec<Patch>),
    Faces(Vec<SewnFace>),
    Analytic(Analytic),
}

/// The surface of a tool and what there is to say about it.
pub struct Described {
    pub geometry: Geometry,
    /// What it is made of: "26 Nagata patches".
    pub summary: String,
    /// Edges of Nagata patches whose normals at both ends no quadratic curve meets.
    pub inflected: Option<usize>,
    pub warnings: Vec<String>,
}

impl Geometry {
    /// All of it, to be projected onto.
    pub fn whole(self) -> Shape {
        match self {
            Self::Patches(patches) => Shape::Patches(PatchSet::new(patches)),
            Self::Faces(faces) => Shape::Faces(FaceSet::new(&faces)),
            Self::Analytic(shape) => Shape::Analytic(shape),
        }
    }
}

impl Described {
    /// With nothing more to say.
    fn plain(geometry: Geometry, summary: String) -> Self {
        Self { geometry, summary, inflected: None, warnings: Vec::new() }
    }
}

/// Reads one of the descriptions that a tool has.
///
/// # Errors
/// Files that cannot be read or hold no surface, fillets that do not fit.
pub fn describe(tool: &scene::Tool, description: Description, controls: &Controls) -> Result<Described> {
    let missing = || Error::input(&tool.name.at, format!("the tool has no `{}`", description.key()), "");
    match description {
        Description::Mesh(smoothing) => of_mesh(tool, tool.mesh.as_ref().ok_or_else(missing)?, smoothing, controls),
        Description::Nurbs => of_cad(tool, tool.nurbs.as_ref().ok_or_else(missing)?, "NURBS face"),
        Description::Bezier => of_cad(tool, tool.bezier.as_ref().ok_or_else(missing)?, "Bézier face"),
        _ => {
            let shape = tool.shapes.iter().find(|shape| shape.description() == description).ok_or_else(missing)?;
            Ok(Described::plain(Geometry::Analytic(analytic(tool, shape)?), format!("exact {}", description.key())))
        }
    }
}

fn of_mesh(tool: &scene::Tool, of: &ToolMesh, smoothing: Smoothing, controls: &Controls) -> Result<Described> {
    let mut mesh = mesh::load(&of.source, mesh::Purpose::Tool)?;
    let mut warnings = std::mem::take(&mut mesh.warnings);
    if smoothing == Smoothing::Facet && of.refine.is_none() {
        let patches = patches_from_mesh(&mesh, smoothing, &NormalOptions::default(), tool.flip)?;
        let summary = format!("{} flat facets", patches.len());
        return Ok(Described { warnings, ..Described::plain(Geometry::Patches(patches), summary) });
    }
    let mut options = NormalOptions {
        controls: *controls,
        feature_angle: tool.feature_angle,
        sharp: of.sharp.iter().map(|group| group.value.clone()).collect(),
        symmetry: of.symmetry.iter().map(|plane| (plane.point, plane.normal)).collect(),
        ..NormalOptions::default()
    };
    let other = match &of.normals {
        NormalSource::Facets(weight) => {
            options.weight = *weight;
            None
        }
        NormalSource::Description(other) => {
            let described = describe(tool, other.value, controls)?;
            warnings.extend(described.warnings);
            Some((described.geometry.whole(), other))
        }
    };
    // The nodes' normals, and where they come from in words.
    let give = |mesh: &Mesh, options: &mut NormalOptions| -> Result<String> {
        let Some((surface, other)) = &other else { return Ok(format!("normals weighted by {}", options.weight.key())) };
        let (given, distance) = from_surface(mesh, surface, other.value.key(), &other.at)?;
        options.given = Some(given);
        Ok(format!("normals from `{}`, at most {distance:.1e} away", other.value.key()))
    };
    let mut source = give(&mesh, &mut options)?;
    let mut parts = String::new();
    if let Some(times) = &of.refine {
        parts = format!(", {} for each facet of the mesh", 1u64 << (2 * times.value));
        mesh = refined(mesh, times, &mut options, tool.flip)?;
        source = give(&mesh, &mut options)?;
    }
    let (patches, inflected) = smooth(&mesh, smoothing, &options, tool.flip)?;
    if smoothing == Smoothing::Facet {
        let summary = format!("{} flat facets{parts}", patches.len());
        return Ok(Described { warnings, ..Described::plain(Geometry::Patches(patches), summary) });
    }
    if other.is_none() {
        check_turns(tool, &mesh, &patches)?;
    }
    let summary = format!("{} Nagata patches{parts}, {source}, {}", patches.len(), some(inflected, "inflected edge"));
    Ok(Described { inflected: Some(inflected), warnings, ..Described::plain(Geometry::Patches(patches), summary) })
}

/// Facets that turn far at an edge that counts as smooth say too little of the surface: a quarter circle needs two edges.
fn check_turns(tool: &scene::Tool, mesh: &Mesh, patches: &[Patch]) -> Result<()> {
    const MOST: f64 = 75.0;
    let facets = Facets::new(mesh, tool.flip)?;
    let is_smooth = |(f, k): &(usize, usize)| patches[*f].edges[*k] == Edge::Smooth;
    let edges = (0..patches.len()).flat_map(|f| (0..facets.count(f)).map(move |k| (f, k))).filter(is_smooth);
    let worst = edges.filter_map(|(f, k)| facets.turn(f, k)).fold(0.0, f64::max).to_degrees();
    if worst <= MOST {
        return Ok(());
    }
    let what =
        format!("the facets of tool `{}` turn by {worst:.0} degrees at an edge that counts as smooth", tool.name.value);
    let help =
        "mesh round parts with two edges or more a quarter circle, or keep the edge sharp by a smaller `feature_angle`";
    Err(Error::input(&tool.name.at, what, help))
}

/// A mesh whose facets are split on the Nagata patches of its normals; `options` become those of the parts. What was sharp stays
/// so, though the parts may meet there at less than the feature angle.
fn refined(mesh: Mesh, times: &Located<u32>, options: &mut NormalOptions, flip: bool) -> Result<Mesh> {
    let curves = refine::of_surface(&mesh, options, flip)?;
    let mut lines: Vec<[u32; 2]> = curves.sharp.iter().copied().collect();
    lines.sort_unstable();
    let mut mesh = mesh;
    if !lines.is_empty() {
        let mut name = "sharp edges".to_string();
        while mesh.groups.contains_key(&name) {
            name.push('+');
        }
        mesh.groups.insert(name.clone(), Group { lines, ..Group::default() });
        options.sharp.push(name);
    }
    options.given = None;
    refine::split(mesh, times, &curves, |_, _| false)
}

fn of_cad(tool: &scene::Tool, file: &CadFile, noun: &str) -> Result<Described> {
    let name = file.path.value.display();
    let place = |error: Error| match error {
        Error::Input { at: None, what, help } => Error::Input { at: Some(file.path.at.clone()), what, help },
        other => other,
    };
    let Cad { faces, skipped, unit } = cad::read(&file.path.value, file.incomplete).map_err(place)?;
    let tolerance = file.tolerance.unwrap_or_else(|| usual_tolerance(&faces));
    let faces = sew(&faces, tool.feature_angle.to_radians(), tolerance, tool.flip).map_err(place)?;
    let rims = |kind: Edge| faces.iter().flat_map(|face| &face.rims).filter(|rim| rim.edge == kind).count();
    // A joint has a rim on either side.
    let summary = format!(
        "{}{}, {}, {}, {}",
        some(faces.len(), noun),
        unit.map_or(String::new(), |unit| format!(" in {unit}")),
        some(rims(Edge::Smooth).div_ceil(2), "smooth joint"),
        some(rims(Edge::Sharp).div_ceil(2), "sharp edge"),
        some(rims(Edge::Boundary), "open edge"),
    );
    let warnings = skipped.iter().map(|what| format!("{name}: left out {what}")).collect();
    Ok(Described { warnings, ..Described::plain(Geometry::Faces(faces), summary) })
}

/// A count with its noun.
fn some(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// The closed form that the scene describes; a profile is turned over if the tool is.
fn analytic(tool: &scene::Tool, shape: &scene::Shape) -> Result<Analytic> {
    use scene::Shape;
    Ok(match *shape {
        Shape::Plane { point, normal } => Analytic::Plane(Plane { point, normal }),
        Shape::Cylinder { point, axis, radius, hollow } => Analytic::Cylinder(Cylinder { point, axis, radius, hollow }),
        Shape::Cone { apex, axis, angle, hollow } => {
            Analytic::Cone(Cone { apex, axis, angle: angle.to_radians(), hollow })
        }
        Shape::Sphere { center, radius, hollow } => Analytic::Sphere(Sphere { center, radius, hollow }),
        Shape::Torus { center, axis, radius, tube, hollow } => {
            Analytic::Torus(Torus { center, axis, radius, tube, hollow })
        }
        Shape::Profile(ref profile) => Analytic::Profile(of_profile(tool, profile)?),
    })
}

fn of_profile(tool: &scene::Tool, profile: &scene::Profile) -> Result<Profile> {
    let points: Vec<[f64; 2]> = profile.points.iter().map(|point| point.value).collect();
    let fillets: Vec<f64> = profile.fillets.iter().map(|fillet| fillet.value).collect();
    let about_axis = matches!(profile.sweep, scene::Sweep::Revolve { .. });
    let chain =
        Chain::new(&points, &fillets, profile.closed, about_axis).map_err(|Misfit { point, fillet, what }| {
            let (list, at) = match fillet {
                true => ("fillets", &profile.fillets[point].at),
                false => ("points", &profile.points[point].at),
            };
            let help = if fillet { "choose smaller fillets, or move the points apart" } else { "" };
            Error::input(at, format!("tool.{}.profile.{list}.{point} {what}", tool.name.value), help)
        })?;
    let sweep = match profile.sweep {
        scene::Sweep::Extrude { origin, x, y, length } => Sweep::Extruded { origin, x, y, length },
        scene::Sweep::Revolve { point, axis } => Sweep::Revolved(Axis::new(point, axis)),
    };
    Ok(Profile { chain: if tool.flip { chain.reversed() } else { chain }, sweep })
}

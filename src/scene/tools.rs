//! Reads a tool: the descriptions of its surface, and which of them acts.

use super::parse::mesh_file;
use super::reader::{Item, Table};
use super::{
    CadFile, Description, Located, NormalSource, Profile, Shape, Smoothing, Sweep, SymmetryPlane, Tool, ToolMesh,
    Weight,
};
use crate::Vec3;
use crate::error::Result;
use std::path::Path;

/// Keys of the closed forms.
const SHAPES: [&str; 6] = ["plane", "cylinder", "cone", "sphere", "torus", "profile"];
/// Keys that mean something for a mesh only, for CAD files only.
const OF_MESH: [&str; 5] = ["group", "normals", "sharp", "symmetry", "refine"];
const OF_CAD: [&str; 2] = ["incomplete", "tolerance"];

/// The cosine of two directions that count as orthogonal.
const ORTHOGONAL: f64 = 1e-6;

/// The tool `name`; files are relative to `directory`.
pub(super) fn read(name: Located<String>, item: &Item, directory: &Path) -> Result<Tool> {
    let others = ["mesh", "nurbs", "bezier", "smoothing", "feature_angle", "flip"];
    let table = item.table(&[&others[..3], &SHAPES, &others[3..], &OF_MESH, &OF_CAD].concat())?;
    let given = SHAPES.iter().filter_map(|key| table.get(key).map(|item| (*key, item)));
    let mut tool = Tool {
        name,
        mesh: table.optional("mesh", |file| mesh(&table, file, directory))?,
        nurbs: table.optional("nurbs", |file| cad_file(&table, file, directory))?,
        bezier: table.optional("bezier", |file| cad_file(&table, file, directory))?,
        shapes: given.map(|(key, item)| shape(key, &item)).collect::<Result<_>>()?,
        smoothing: Located { value: Description::Mesh(Smoothing::Nagata), at: table.at().clone() },
        feature_angle: table.optional("feature_angle", Item::feature_angle)?.unwrap_or(super::FEATURE_ANGLE),
        flip: table.optional("flip", Item::boolean)?.unwrap_or(false),
    };
    check_use(&table, &tool)?;
    tool.smoothing = smoothing(&table, &tool)?;
    if let Some(ToolMesh { normals: NormalSource::Description(asked), .. }) = &tool.mesh
        && let Some(item) = table.get("normals")
    {
        check_given(&item, &tool, asked.value)?;
    }
    Ok(tool)
}

/// The description that acts: the one asked for, that of the mesh, or the only one.
fn smoothing(table: &Table, tool: &Tool) -> Result<Located<Description>> {
    if let Some(item) = table.get("smoothing") {
        let asked = item.choice(&Description::ALL)?;
        check_given(&item, tool, asked)?;
        return Ok(item.located(asked));
    }
    let given = tool.descriptions();
    match given[..] {
        [] => Err(table.error("has no surface", format!("add one of {}", every_key()))),
        [one] => Ok(Located { value: one, at: table.at().clone() }),
        _ if tool.mesh.is_some() => Ok(tool.smoothing.clone()),
        _ => {
            let keys: Vec<&str> = given.iter().map(|description| description.key()).collect();
            let what = format!("has several descriptions, {}", keys.join(", "));
            Err(table.error(what, format!("add `smoothing = \"{}\"`, or another of them", keys[0])))
        }
    }
}

/// A description that is asked for must be given.
fn check_given(item: &Item, tool: &Tool, asked: Description) -> Result<()> {
    if tool.descriptions().contains(&asked) {
        return Ok(());
    }
    let (key, example) = match asked {
        Description::Mesh(_) => ("mesh", "\"FILE.msh\""),
        Description::Nurbs => ("nurbs", "\"FILE.igs\""),
        Description::Bezier => ("bezier", "\"FILE.bpt\""),
        closed_form => (closed_form.key(), "{ ... }"),
    };
    Err(item.error(format!("needs the key `{key}`, which is missing"), format!("add `{key} = {example}`")))
}

/// Keys that mean nothing for what is given are errors.
fn check_use(table: &Table, tool: &Tool) -> Result<()> {
    let (mesh, cad) = (tool.mesh.is_some(), tool.nurbs.is_some() || tool.bezier.is_some());
    let profile = tool.shapes.iter().any(|shape| matches!(shape, Shape::Profile(_)));
    let rules: [(&[&str], bool, &str); 4] = [
        (&OF_MESH, mesh, "needs a mesh"),
        (&OF_CAD, cad, "needs a CAD file, `nurbs` or `bezier`"),
        (&["feature_angle"], mesh || cad, "needs a mesh or a CAD file"),
        (&["flip"], mesh || cad || profile, "needs a mesh, a CAD file or a profile"),
    ];
    for (keys, holds, what) in rules {
        if let Some(item) = keys.iter().find_map(|key| table.get(key)).filter(|_| !holds) {
            let help = if keys == ["flip"] {
                "remove it; other shapes are turned over by `normal` or `hollow`"
            } else {
                "remove it"
            };
            return Err(item.error(what, help));
        }
    }
    Ok(())
}

fn every_key() -> String {
    let keys: Vec<String> = ["mesh", "nurbs", "bezier"].iter().chain(&SHAPES).map(|key| format!("`{key}`")).collect();
    keys.join(", ")
}

fn mesh(table: &Table, file: &Item, directory: &Path) -> Result<ToolMesh> {
    let plane = |item: &Item| {
        let table = item.table(&["point", "normal"])?;
        Ok(SymmetryPlane { point: point(&table, "point")?, normal: direction(&table, "normal")? })
    };
    let sources: Vec<(&str, Source)> = Weight::ALL
        .iter()
        .map(|(key, weight)| (*key, Source::Facets(*weight)))
        .chain(Description::ALL.iter().filter(|(_, d)| !is_mesh(*d)).map(|(key, d)| (*key, Source::Other(*d))))
        .collect();
    let normals = |item: &Item| {
        Ok(match item.choice(&sources)? {
            Source::Facets(weight) => NormalSource::Facets(weight),
            Source::Other(description) => NormalSource::Description(item.located(description)),
        })
    };
    Ok(ToolMesh {
        source: mesh_file(table, file, directory)?,
        normals: table.optional("normals", normals)?.unwrap_or(NormalSource::Facets(Weight::default())),
        sharp: table.each("sharp", Item::located_string)?,
        symmetry: table.each("symmetry", plane)?,
        refine: table.optional("refine", Item::splits)?.flatten(),
    })
}

/// A word under `normals`.
#[derive(Clone, Copy)]
enum Source {
    Facets(Weight),
    Other(Description),
}

fn is_mesh(description: Description) -> bool {
    matches!(description, Description::Mesh(_))
}

fn cad_file(table: &Table, file: &Item, directory: &Path) -> Result<CadFile> {
    Ok(CadFile {
        path: file.file(directory)?,
        incomplete: table.optional("incomplete", Item::boolean)?.unwrap_or(false),
        tolerance: table.optional("tolerance", Item::positive)?,
    })
}

fn point(table: &Table, key: &str) -> Result<Vec3> {
    table.require(key, "[0.0, 0.0, 0.0]")?.vector()
}

fn direction(table: &Table, key: &str) -> Result<Vec3> {
    table.require(key, "[0.0, 0.0, 1.0]")?.unit_vector()
}

fn shape(key: &str, item: &Item) -> Result<Shape> {
    let radius = |table: &Table, key: &str| table.require(key, "1.0")?.positive();
    let hollow = |table: &Table| table.optional("hollow", Item::boolean).map(|hollow| hollow.unwrap_or(false));
    match key {
        "plane" => {
            let t = item.table(&["point", "normal"])?;
            Ok(Shape::Plane { point: point(&t, "point")?, normal: direction(&t, "normal")? })
        }
        "cylinder" => {
            let t = item.table(&["point", "axis", "radius", "hollow"])?;
            let (point, axis) = (point(&t, "point")?, direction(&t, "axis")?);
            Ok(Shape::Cylinder { point, axis, radius: radius(&t, "radius")?, hollow: hollow(&t)? })
        }
        "cone" => {
            let t = item.table(&["apex", "axis", "angle", "hollow"])?;
            let (apex, axis) = (point(&t, "apex")?, direction(&t, "axis")?);
            let help = "it is half of the opening, in degrees";
            let sharp = |angle: f64| angle > 0.0 && angle < 90.0;
            let angle = t.require("angle", "45.0")?.number_that_is("above 0 and below 90", sharp, help)?;
            Ok(Shape::Cone { apex, axis, angle, hollow: hollow(&t)? })
        }
        "sphere" => {
            let t = item.table(&["center", "radius", "hollow"])?;
            Ok(Shape::Sphere { center: point(&t, "center")?, radius: radius(&t, "radius")?, hollow: hollow(&t)? })
        }
        "torus" => {
            let t = item.table(&["center", "axis", "radius", "tube", "hollow"])?;
            let (center, axis, radius) = (point(&t, "center")?, direction(&t, "axis")?, radius(&t, "radius")?);
            let fits = |tube: f64| tube > 0.0 && tube < radius;
            let expected = format!("above 0 and below the radius of the ring ({radius:?})");
            let tube = t.require("tube", "1.0")?.number_that_is(&expected, fits, "it is the radius of the tube")?;
            Ok(Shape::Torus { center, axis, radius, tube, hollow: hollow(&t)? })
        }
        _ => Ok(Shape::Profile(profile(item)?)),
    }
}

fn profile(item: &Item) -> Result<Profile> {
    let table = item.table(&["points", "fillets", "closed", "extrude", "revolve"])?;
    let example = "[[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]]";
    let list = table.require("points", example)?;
    let points = |item: &Item| Ok(item.located(item.array::<f64, 2>(Item::number, "[0.0, 1.0]")?));
    let points: Vec<Located<[f64; 2]>> = list.list()?.iter().map(points).collect::<Result<_>>()?;
    let closed = table.optional("closed", Item::boolean)?.unwrap_or(false);
    let least = if closed { 3 } else { 2 };
    if points.len() < least {
        return Err(list.error(
            format!("must have {least} points or more, not {}", points.len()),
            format!("for example `points = {example}`"),
        ));
    }
    let sweep = match (table.get("extrude"), table.get("revolve")) {
        (Some(_), Some(item)) => return Err(item.error("stands beside `extrude`", "keep one of them")),
        (None, Some(item)) => {
            let t = item.table(&["point", "axis"])?;
            Sweep::Revolve { point: point(&t, "point")?, axis: direction(&t, "axis")? }
        }
        (Some(item), None) => extrude(&item)?,
        (None, None) => Sweep::Extrude { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), length: None },
    };
    Ok(Profile { fillets: fillets(&table, points.len(), closed)?, points, closed, sweep })
}

/// One radius for all corners, or one for each point.
fn fillets(table: &Table, points: usize, closed: bool) -> Result<Vec<Located<f64>>> {
    let is_end = |k: usize| !closed && (k == 0 || k == points - 1);
    let radius =
        |item: &Item| Ok(item.located(item.number_that_is("0 or more", |value| value >= 0.0, "0 is sharp")?));
    let Some(item) = table.get("fillets") else {
        return Ok(vec![Located { value: 0.0, at: table.at().clone() }; points]);
    };
    if !item.is_list() {
        let one = radius(&item)?;
        let at_point = |k: usize| Located { value: if is_end(k) { 0.0 } else { one.value }, at: one.at.clone() };
        return Ok((0..points).map(at_point).collect());
    }
    let items = item.list()?;
    if items.len() != points {
        let what = format!("must have a radius for each of the {points} points, not {}", items.len());
        return Err(item.error(what, "0 leaves a point sharp; one number stands for all corners"));
    }
    let radii: Vec<Located<f64>> = items.iter().map(radius).collect::<Result<_>>()?;
    match radii.iter().enumerate().find(|(k, radius)| is_end(*k) && radius.value > 0.0) {
        Some((k, _)) => Err(items[k].error("rounds an end of the chain", "make it 0, or the profile `closed`")),
        None => Ok(radii),
    }
}

fn extrude(item: &Item) -> Result<Sweep> {
    let table = item.table(&["origin", "x", "y", "length"])?;
    let origin = table.optional("origin", Item::vector)?.unwrap_or_else(Vec3::zeros);
    let x = table.optional("x", Item::unit_vector)?.unwrap_or_else(Vec3::x);
    let y = table.optional("y", Item::unit_vector)?.unwrap_or_else(Vec3::y);
    if x.dot(&y).abs() > ORTHOGONAL {
        return Err(table.error(
            "has directions `x` and `y` that are not at a right angle",
            "the plane of the points is spanned by them",
        ));
    }
    let y = (y - x * x.dot(&y)).normalize();
    Ok(Sweep::Extrude { origin, x, y, length: table.optional("length", Item::positive)? })
}

//! What the command line asks about: a description of a tool, and another one to measure it against.

use super::described::Described;
use super::{Against, Subject};
use crate::controls::Controls;
use crate::error::{Error, Result};
use crate::scene::{self, Description, Located, Tool, did_you_mean};
use crate::surface::Analytic;
use crate::tool::{Shape, describe};
use std::path::Path;

/// Names on the command line.
#[derive(Clone, Copy, Debug)]
pub struct Names<'a> {
    /// The scene file.
    pub file: &'a Path,
    pub overrides: &'a [String],
    /// The tool; without it the only one.
    pub tool: Option<&'a str>,
    /// The description; without it the one that acts.
    pub description: Option<&'a str>,
    /// Another description of the tool, or another tool.
    pub against: Option<&'a str>,
    /// The length that errors are compared with, in place of that of the reference.
    pub length: Option<f64>,
}

/// The surfaces that were asked for, as a whole.
pub struct Loaded {
    name: String,
    summary: String,
    surface: Shape,
    against: Option<(String, Shape)>,
    inflected: Option<usize>,
    length: Option<f64>,
    /// What the user should know of the surfaces.
    pub warnings: Vec<String>,
}

impl Loaded {
    /// Reads the surfaces; not collective.
    ///
    /// # Errors
    /// Wrong input: names that the scene does not have, files that cannot be read, a surface without end.
    pub fn new(names: &Names) -> Result<Self> {
        let tools = scene::load_tools(names.file, names.overrides)?;
        let file = names.file.display().to_string();
        let tool = choose(&tools, names.tool, &file)?;
        let description = match names.description {
            Some(key) => described_as(tool, key).ok_or_else(|| no_description(tool, "--description", key))?,
            None => tool.smoothing.value,
        };
        let described = describe(tool, description, &Controls::default())?;
        let (surface, mut warnings) = (described.geometry.whole(), described.warnings);
        check_ends(&surface, &tool.name)?;
        let against = names.against.map(|key| reference(&tools, tool, key, &mut warnings)).transpose()?;
        Ok(Self {
            name: format!("tool `{}`, {}", tool.name.value, description.key()),
            summary: described.summary,
            surface,
            against,
            inflected: described.inflected,
            length: names.length,
            warnings,
        })
    }

    /// What is to be measured.
    pub fn subject(&self) -> Subject<'_> {
        let against = self.against.as_ref().map(|(name, shape)| Against {
            name: name.clone(),
            reference: shape,
            length: self.length.map(|length| (length, "length")).or_else(|| radius(shape).map(|r| (r, "radius"))),
        });
        Subject {
            name: self.name.clone(),
            summary: self.summary.clone(),
            surface: described(&self.surface),
            edges: matches!(self.surface, Shape::Patches(_)),
            inflected: self.inflected,
            against,
        }
    }
}

/// The tool of that name, or the only one.
fn choose<'a>(tools: &'a [Tool], name: Option<&str>, file: &str) -> Result<&'a Tool> {
    let known = || tools.iter().map(|tool| tool.name.value.as_str());
    match (name, tools) {
        (Some(name), _) => tools
            .iter()
            .find(|tool| tool.name.value == name)
            .ok_or_else(|| Error::input_anywhere(format!("{file} has no tool `{name}`"), did_you_mean(name, known()))),
        (None, [tool]) => Ok(tool),
        (None, _) => {
            let names: Vec<&str> = known().collect();
            Err(Error::input_anywhere(
                format!("{file} has {} tools: {}", tools.len(), names.join(", ")),
                "choose one with --tool NAME",
            ))
        }
    }
}

/// The description of a tool that the user calls so.
fn described_as(tool: &Tool, key: &str) -> Option<Description> {
    tool.descriptions().into_iter().find(|description| description.key() == key)
}

fn no_description(tool: &Tool, option: &str, key: &str) -> Error {
    let given = tool.descriptions();
    let what = format!("{option} {key}: tool `{}` has no such description", tool.name.value);
    Error::input_anywhere(what, did_you_mean(key, given.iter().map(|description| description.key())))
}

/// Another description of the tool, or another tool as it acts.
fn reference(tools: &[Tool], tool: &Tool, key: &str, warnings: &mut Vec<String>) -> Result<(String, Shape)> {
    let mut read = |tool: &Tool, description: Description| {
        let described = describe(tool, description, &Controls::default())?;
        warnings.extend(described.warnings);
        Ok::<_, Error>(described.geometry.whole())
    };
    if let Some(description) = described_as(tool, key) {
        return Ok((description.key().to_string(), read(tool, description)?));
    }
    let other = tools.iter().find(|other| other.name.value == key && other.name.value != tool.name.value);
    let other = other.ok_or_else(|| {
        let given = tool.descriptions();
        let others = tools.iter().map(|other| other.name.value.as_str()).filter(|name| *name != tool.name.value);
        let known = given.iter().map(|description| description.key()).chain(others);
        let what = format!("--against {key} is no description of tool `{}` and no other tool", tool.name.value);
        Error::input_anywhere(what, did_you_mean(key, known))
    })?;
    let description = other.smoothing.value;
    let name = format!("tool `{}`, {}", other.name.value, description.key());
    Ok((name, read(other, description)?))
}

/// What goes on without end cannot be sampled.
fn check_ends(surface: &Shape, tool: &Located<String>) -> Result<()> {
    let endless = match surface {
        Shape::Analytic(shape) => shape.parametric().domain().as_flattened().iter().any(|end| end.is_infinite()),
        Shape::Patches(_) | Shape::Faces(_) => false,
    };
    let help = "choose another description with --description, or measure another tool --against this one";
    let what = format!("tool `{}` goes on without end", tool.value);
    if endless { Err(Error::input(&tool.at, what, help)) } else { Ok(()) }
}

fn described(surface: &Shape) -> &dyn Described {
    match surface {
        Shape::Patches(patches) => patches,
        Shape::Faces(faces) => faces,
        Shape::Analytic(shape) => shape,
    }
}

/// The radius of a cylinder or sphere.
fn radius(surface: &Shape) -> Option<f64> {
    match surface {
        Shape::Analytic(Analytic::Cylinder(cylinder)) => Some(cylinder.radius),
        Shape::Analytic(Analytic::Sphere(sphere)) => Some(sphere.radius),
        _ => None,
    }
}

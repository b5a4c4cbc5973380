//! References from one table of the scene to another, by name: materials, tools, bodies and the groups of their meshes.
//!
//! A group is known only once the mesh is read; here `body.group` is checked up to its dot.

use super::Located;
use super::names::did_you_mean;
use super::reader::Item;
use crate::error::{Error, Result};

/// The names that the scene defines.
pub(super) struct Names {
    bodies: Vec<String>,
    materials: Vec<String>,
    tools: Vec<String>,
}

/// What a target of motion or force is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Tool,
    Set,
}

impl Names {
    /// Collects the names.
    pub fn new(
        bodies: &[(Located<String>, Item)],
        materials: &[(Located<String>, Item)],
        tools: &[(Located<String>, Item)],
    ) -> Self {
        let values = |named: &[(Located<String>, Item)]| named.iter().map(|(name, _)| name.value.clone()).collect();
        Self { bodies: values(bodies), materials: values(materials), tools: values(tools) }
    }

    /// Refuses a tool that shares its name with a body.
    pub fn check(&self, tools: &[(Located<String>, Item)]) -> Result<()> {
        match tools.iter().find(|(name, _)| self.bodies.contains(&name.value)) {
            Some((name, _)) => {
                Err(Error::input(&name.at, format!("`{}` names a tool and a body", name.value), "rename one of them"))
            }
            None => Ok(()),
        }
    }

    /// Help for a body without a material.
    pub fn help_material(&self) -> String {
        match self.materials.is_empty() {
            false => format!("add `material = \"NAME\"` (known: {})", self.materials.join(", ")),
            true => {
                "add `material = \"NAME\"`, and a table `[material.NAME]` with model, young and poisson".to_string()
            }
        }
    }

    /// A material.
    pub fn material(&self, item: &Item) -> Result<Located<String>> {
        let name = item.string()?;
        match self.materials.iter().any(|known| known == name) {
            true => item.located_string(),
            false => Err(unknown(item, "material", name, &self.materials)),
        }
    }

    /// A tool, or faces of a body.
    pub fn master(&self, item: &Item) -> Result<Located<String>> {
        let name = item.string()?;
        if self.is_tool(name) {
            return item.located_string();
        }
        if self.has_body(body_of(name)) {
            return self.faces(item);
        }
        let known = self.tools.iter().chain(&self.bodies).map(String::as_str);
        let what = format!("names the unknown tool or body `{}`", body_of(name));
        Err(item.error(what, did_you_mean(body_of(name), known)))
    }

    /// Whether a tool is called so.
    pub fn is_tool(&self, name: &str) -> bool {
        self.tools.iter().any(|known| known == name)
    }

    /// Whether a tool or a body is called so.
    pub fn is_target(&self, name: &str) -> bool {
        self.is_tool(name) || self.has_body(name)
    }

    /// `body` or `body.group`; `instead` helps those who name a tool.
    pub fn set(&self, item: &Item, instead: &str) -> Result<Located<String>> {
        let name = item.string()?;
        let body = body_of(name);
        if self.is_tool(body) {
            return Err(item.error(format!("must be `body` or `body.group`; `{body}` is a tool"), instead));
        }
        if !self.has_body(body) {
            return Err(unknown(item, "body", body, &self.bodies));
        }
        if name.ends_with('.') && name.len() == body.len() + 1 {
            return Err(item.error(format!("names no group of body `{body}`"), format!("for example `{body}.top`")));
        }
        item.located_string()
    }

    /// `body.group`: faces.
    pub fn faces(&self, item: &Item) -> Result<Located<String>> {
        let set = self.set(item, "a tool has no nodes or faces in the system: it can be the master of a contact")?;
        match set.value.contains('.') {
            true => Ok(set),
            false => Err(item.error("must be faces, `body.group`", format!("for example `{}.top`", set.value))),
        }
    }

    /// A body.
    pub fn body(&self, item: &Item) -> Result<Located<String>> {
        let name = item.string()?;
        match self.has_body(name) {
            true => item.located_string(),
            false => Err(unknown(item, "body", name, &self.bodies)),
        }
    }

    /// A tool, `body` or `body.group`.
    pub fn target(&self, item: &Item) -> Result<(Located<String>, Target)> {
        let name = item.string()?;
        if self.is_tool(name) {
            return Ok((item.located_string()?, Target::Tool));
        }
        if !self.has_body(body_of(name)) {
            let known = self.tools.iter().chain(&self.bodies).map(String::as_str);
            return Err(item.error(
                format!("names the unknown tool or body `{}`", body_of(name)),
                did_you_mean(body_of(name), known),
            ));
        }
        Ok((self.set(item, "")?, Target::Set))
    }

    fn has_body(&self, name: &str) -> bool {
        self.bodies.iter().any(|known| known == name)
    }
}

/// The body of `body` or `body.group`.
pub fn body_of(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

fn unknown(item: &Item, what: &str, name: &str, known: &[String]) -> Error {
    item.error(format!("names the unknown {what} `{name}`"), did_you_mean(name, known.iter().map(String::as_str)))
}

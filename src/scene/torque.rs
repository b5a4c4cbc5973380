//! Torques on tools.

use super::reader::Item;
use super::references::Names;
use super::{Amplitude, Located, Move, Step, amplitude};
use crate::Vec3;
use crate::error::{Error, Result};

/// A torque on a tool, which is then free to turn about an axis. Ramps linearly from its value at the end of the last step; on a
/// tool that no torque drove about that axis until then, from the moment that held it.
#[derive(Clone, Debug)]
pub struct Torque {
    pub tool: Located<String>,
    /// About the axis, right-handed.
    pub total: f64,
    /// A point of the axis at the start of the step, but for what forces have moved the tool by.
    pub point: Vec3,
    /// A unit vector.
    pub axis: Vec3,
    /// As that of a force.
    pub table: Option<Amplitude>,
}

pub(super) fn read(item: &Item, names: &Names, duration: f64) -> Result<Torque> {
    let table = item.table(&["tool", "total", "point", "axis", "table"])?;
    let tool = table.require("tool", "\"TOOL\"")?;
    if !names.is_tool(tool.string()?) {
        let help = "name a tool: nodes of a body have no rotations; turn a body by a tool that it sticks to";
        return Err(tool.error("is no tool", help));
    }
    Ok(Torque {
        tool: tool.located_string()?,
        total: table.require("total", "1.0")?.number()?,
        point: table.require("point", "[0.0, 0.0, 0.0]")?.vector()?,
        axis: table.require("axis", "[0.0, 0.0, 1.0]")?.unit_vector()?,
        table: table.optional("table", |item| amplitude::read(item, duration))?,
    })
}

impl Torque {
    /// What it is at the end of the step.
    pub fn last(&self) -> f64 {
        self.total * amplitude::end(&self.table)
    }

    /// What goes on of it after a step with these motions.
    pub(super) fn kept(&self, moves: &[Move]) -> Self {
        let own = moves.iter().filter(|motion| motion.target.value == self.tool.value);
        let moved: Vec3 = own.map(|motion| motion.by * amplitude::end(&motion.table)).sum();
        Self { total: self.last(), point: self.point + moved, table: None, ..self.clone() }
    }
}

/// Refuses what would turn a tool twice.
pub(super) fn check(step: &Step) -> Result<()> {
    for (k, torque) in step.torques.iter().enumerate() {
        let tool = &torque.tool.value;
        let refuse = |what: &str, help: &str| {
            Err(Error::input(&torque.tool.at, format!("step `{}` {what} `{tool}`", step.name.value), help))
        };
        if step.torques[..k].iter().any(|other| other.tool.value == *tool) {
            return refuse("has two torques on", "a tool is free to turn about one axis");
        }
        if step.moves.iter().any(|motion| motion.target.value == *tool && motion.rotate.is_some()) {
            return refuse("has a torque on, and rotates", super::steps::EITHER);
        }
    }
    Ok(())
}

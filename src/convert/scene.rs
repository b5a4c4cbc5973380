//! The text of steps.

use super::tables::Table;
use crate::AXIS_NAMES;
use std::fmt::Write;

/// The time of a step and its increments.
pub(super) struct Times {
    pub duration: f64,
    pub initial: f64,
    pub max: f64,
    pub min: Option<f64>,
}

/// Where a tool turns, or is free to.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    pub point: [f64; 3],
    /// 0 to 2.
    pub along: usize,
}

#[derive(Clone, Copy)]
pub(super) struct Rotation {
    pub axis: Axis,
    /// Degrees.
    pub angle: f64,
}

/// A force on a set, a tool or a body, or a pressure or torque as a vector of one number.
#[derive(Clone)]
pub(super) struct Load {
    pub on: String,
    pub value: [f64; 3],
    /// The shares of it that act; without, it goes straight to it.
    pub table: Option<Table>,
}

/// How a tool moves.
pub(super) struct ToolMove {
    pub name: String,
    pub by: [f64; 3],
    pub rotation: Option<Rotation>,
    pub table: Option<Table>,
}

/// The conditions of a step by what they act on, each once, in the order in which they came.
#[derive(Default)]
pub(super) struct Lists {
    /// Sets that are held or moved.
    pub supported: Vec<String>,
    /// For each of these the way along x, y and z; `None` where it is free.
    pub ways: Vec<[Option<f64>; 3]>,
    /// And its table.
    pub tables: Vec<Option<Table>>,
    pub tools: Vec<ToolMove>,
    /// With the directions in which the tool is free.
    pub pushed: Vec<(Load, [bool; 3])>,
    /// Torques on tools.
    pub turned: Vec<(Load, Axis)>,
    pub forces: Vec<Load>,
    pub pressures: Vec<Load>,
    pub body_forces: Vec<Load>,
    pub gravity: [f64; 3],
    /// Sets and stiffnesses.
    pub springs: Vec<(String, [f64; 3])>,
}

impl Load {
    /// At the end of the step.
    pub fn last(&self) -> [f64; 3] {
        let share = self.table.as_ref().and_then(|table| table.last()).map_or(1.0, |point| point[1]);
        self.value.map(|part| share * part)
    }
}

impl Axis {
    fn write(&self) -> String {
        let mut along = [0.0; 3];
        along[self.along] = 1.0;
        format!("point = {:?}, axis = {along:?}", self.point)
    }
}

impl Lists {
    pub fn add_support(&mut self, set: &str, axis: usize, by: f64) {
        let known = self.supported.iter().position(|other| other == set);
        let at = known.unwrap_or_else(|| {
            self.supported.push(set.to_string());
            self.ways.push([None; 3]);
            self.tables.push(None);
            self.ways.len() - 1
        });
        self.ways[at][axis] = Some(by);
    }

    pub fn move_tool(&mut self, tool: &str, by: [f64; 3], rotation: Option<Rotation>) {
        if by != [0.0; 3] || rotation.is_some() {
            self.tools.push(ToolMove { name: tool.to_string(), by, rotation, table: None });
        }
    }

    pub fn push_tool(&mut self, tool: &str, value: [f64; 3], free: [bool; 3]) {
        self.pushed.push((Load { on: tool.to_string(), value, table: None }, free));
    }

    pub fn turn_tool(&mut self, tool: &str, moment: f64, axis: Axis) {
        self.turned.push((Load { on: tool.to_string(), value: [moment, 0.0, 0.0], table: None }, axis));
    }

    fn fix(&self) -> Vec<String> {
        let held = self.supported.iter().zip(&self.ways).map(|(set, ways)| (set, ways.map(|way| way == Some(0.0))));
        let held = held.filter(|(_, held)| held.contains(&true));
        held.map(|(set, held)| format!("{{ set = {}{} }}", quoted(set), directions(held))).collect()
    }

    fn moves(&self, duration: f64) -> Vec<String> {
        let mut moves = Vec::new();
        let supports = self.supported.iter().zip(&self.ways).zip(&self.tables);
        for ((set, ways), table) in supports {
            let moved = ways.map(|way| way.is_some_and(|way| way != 0.0));
            let by = ways.map(|way| way.unwrap_or(0.0));
            if moved.contains(&true) {
                let (set, directions, table) = (quoted(set), directions(moved), in_time(table, duration));
                moves.push(format!("{{ target = {set}, by = {by:?}{directions}{table} }}"));
            }
        }
        for ToolMove { name, by, rotation, table } in &self.tools {
            let rotate = rotation.map_or(String::new(), |Rotation { axis, angle }| {
                format!(", rotate = {{ {}, angle = {angle:?} }}", axis.write())
            });
            let by = if *by == [0.0; 3] { String::new() } else { format!(", by = {by:?}") };
            moves.push(format!("{{ target = {}{by}{rotate}{} }}", quoted(name), in_time(table, duration)));
        }
        moves
    }

    fn torques(&self, duration: f64) -> Vec<String> {
        let write = |(Load { on, value, table }, axis): &(Load, Axis)| {
            let (tool, table) = (quoted(on), in_time(table, duration));
            format!("{{ tool = {tool}, total = {:?}, {}{table} }}", value[0], axis.write())
        };
        self.turned.iter().map(write).collect()
    }

    fn all_forces(&self, duration: f64) -> Vec<String> {
        let write = |Load { on, value, table }: &Load, directions: &str| {
            format!("{{ target = {}, total = {value:?}{directions}{} }}", quoted(on), in_time(table, duration))
        };
        let on_tools = self.pushed.iter().map(|(load, free)| {
            let free: String = (0..3).filter(|&axis| free[axis]).map(|axis| AXIS_NAMES[axis]).collect();
            write(load, &format!(", directions = \"{free}\""))
        });
        on_tools.chain(self.forces.iter().map(|load| write(load, ""))).collect()
    }
}

/// Adds to the load on what it acts on.
pub(super) fn add(list: &mut Vec<Load>, on: &str, value: [f64; 3]) {
    match list.iter_mut().find(|other| other.on == on) {
        Some(other) => other.value.iter_mut().zip(value).for_each(|(sum, part)| *sum += part),
        None => list.push(Load { on: on.to_string(), value, table: None }),
    }
}

/// The key for a table, in the time of the step.
fn in_time(table: &Option<Table>, duration: f64) -> String {
    let Some(table) = table else { return String::new() };
    let points: Vec<String> = table.iter().map(|[s, share]| format!("[{:?}, {share:?}]", s * duration)).collect();
    format!(", table = [{}]", points.join(", "))
}

pub(super) fn quoted(text: &str) -> toml::Value {
    toml::Value::from(text)
}

/// The key for directions; all three are the default.
fn directions(which: [bool; 3]) -> String {
    match which {
        [true, true, true] => String::new(),
        _ => format!(
            ", directions = \"{}\"",
            (0..3).filter(|&axis| which[axis]).map(|axis| AXIS_NAMES[axis]).collect::<String>()
        ),
    }
}

/// The table of a step.
pub(super) fn step(name: &str, times: &Times, lists: &Lists) -> String {
    let mut text = format!("\n[[step]]\nname = \"{name}\"\n");
    let Times { duration, initial, max, min } = times;
    if *duration != 1.0 {
        let _ = writeln!(text, "duration = {duration:?}");
    }
    let count = (duration / initial).round();
    if initial == max && min.is_none() && (count * initial / duration - 1.0).abs() < 1e-9 {
        let _ = writeln!(text, "increments = {count}");
    } else {
        let min = min.map_or(String::new(), |min| format!(", min = {min:?}"));
        let _ = writeln!(text, "increment = {{ initial = {initial:?}{min}, max = {max:?} }}");
    }
    let duration = *duration;
    let pressures = lists.pressures.iter().filter(|load| load.value[0] != 0.0).map(|Load { on, value, table }| {
        format!("{{ set = {}, value = {:?}{} }}", quoted(on), value[0], in_time(table, duration))
    });
    let body_forces = lists.body_forces.iter().map(|Load { on, value, table }| {
        format!("{{ body = {}, per_volume = {value:?}{} }}", quoted(on), in_time(table, duration))
    });
    let springs = lists.springs.iter();
    let springs = springs.map(|(set, along)| format!("{{ set = {}, stiffness = {along:?} }}", quoted(set)));
    for (key, items) in [
        ("fix", lists.fix()),
        ("move", lists.moves(duration)),
        ("force", lists.all_forces(duration)),
        ("torque", lists.torques(duration)),
        ("pressure", pressures.collect()),
        ("body_force", body_forces.collect()),
        ("spring", springs.collect()),
    ] {
        text += &list(key, &items);
    }
    if lists.gravity != [0.0; 3] {
        let _ = writeln!(text, "gravity = {:?}", lists.gravity);
    }
    text
}

/// A key with a list, one item a line if there are several.
pub(super) fn list(key: &str, items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => format!("{key} = [{one}]\n"),
        _ => format!("{key} = [\n    {},\n]\n", items.join(",\n    ")),
    }
}

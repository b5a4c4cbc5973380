//! The text of steps.

use super::frames::Frame;
use super::supported::Support;
use super::tables::Table;
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
    pub supports: Vec<Support>,
    pub tools: Vec<ToolMove>,
    /// With the directions in which the tool is free.
    pub pushed: Vec<(Load, [bool; 3])>,
    /// Torques on tools.
    pub turned: Vec<(Load, Axis)>,
    pub forces: Vec<Load>,
    pub pressures: Vec<Load>,
    pub body_forces: Vec<Load>,
    /// On all bodies, of no name: one or none.
    pub gravity: Vec<Load>,
    /// Squares of angular velocities of bodies, and a point and the direction of the axis.
    pub spins: Vec<Load>,
    pub spin_axis: Option<[[f64; 3]; 2]>,
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

impl Rotation {
    pub fn write(&self) -> String {
        format!("rotate = {{ {}, angle = {:?} }}", self.axis.write(), self.angle)
    }
}

impl Lists {
    /// A way of a set along one of the directions of its frame.
    pub fn add_support(&mut self, set: &str, frame: Option<&Frame>, axis: usize, by: f64) {
        let known = self.supports.iter().position(|other| other.set == set);
        let at = known.unwrap_or_else(|| {
            let (set, frame) = (set.to_string(), frame.cloned());
            self.supports.push(Support { set, frame, ways: [None; 3], rotation: None, table: None });
            self.supports.len() - 1
        });
        self.supports[at].ways[axis] = Some(by);
    }

    /// Turns a set that is held or moved along all axes; says whether it is.
    pub fn turn_set(&mut self, set: &str, rotation: Rotation) -> bool {
        let is_it = |other: &&mut Support| other.set == set && other.frame.is_none() && !other.ways.contains(&None);
        let found = self.supports.iter_mut().find(is_it);
        found.map(|support| support.rotation = Some(rotation)).is_some()
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

    fn moves(&self, duration: f64) -> Vec<String> {
        let mut moves: Vec<String> = self.supports.iter().filter_map(|support| support.motion(duration)).collect();
        for ToolMove { name, by, rotation, table } in &self.tools {
            let rotate = rotation.map_or(String::new(), |rotation| format!(", {}", rotation.write()));
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
            let free: String = chosen("xyz", *free);
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
pub(super) fn in_time(table: &Option<Table>, duration: f64) -> String {
    let Some(table) = table else { return String::new() };
    let points: Vec<String> = table.iter().map(|[s, share]| format!("[{:?}, {share:?}]", s * duration)).collect();
    format!(", table = [{}]", points.join(", "))
}

pub(super) fn quoted(text: &str) -> toml::Value {
    toml::Value::from(text)
}

/// The key for directions; all three are the default.
pub(super) fn letters(names: &str, which: [bool; 3]) -> String {
    match which {
        [true, true, true] => String::new(),
        _ => format!(", directions = \"{}\"", chosen(names, which)),
    }
}

fn chosen(names: &str, which: [bool; 3]) -> String {
    names.chars().zip(which).filter(|(_, is_chosen)| *is_chosen).map(|(name, _)| name).collect()
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
    let [point, axis] = lists.spin_axis.unwrap_or_default();
    let spins = lists.spins.iter().map(|Load { on, value, table }| {
        let (body, speed, table) = (quoted(on), value[0].sqrt(), in_time(table, duration));
        format!("{{ body = {body}, point = {point:?}, axis = {axis:?}, speed = {speed:?}{table} }}")
    });
    let springs = lists.springs.iter();
    let springs = springs.map(|(set, along)| format!("{{ set = {}, stiffness = {along:?} }}", quoted(set)));
    for (key, items) in [
        ("fix", lists.supports.iter().flat_map(Support::fixes).collect()),
        ("move", lists.moves(duration)),
        ("force", lists.all_forces(duration)),
        ("torque", lists.torques(duration)),
        ("pressure", pressures.collect()),
        ("body_force", body_forces.collect()),
        ("spin", spins.collect()),
        ("spring", springs.collect()),
    ] {
        text += &list(key, &items);
    }
    for Load { value, table, .. } in &lists.gravity {
        let _ = match table {
            None => writeln!(text, "gravity = {value:?}"),
            Some(_) => writeln!(text, "gravity = {{ acceleration = {value:?}{} }}", in_time(table, duration)),
        };
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

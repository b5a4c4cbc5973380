//! The text of steps.

use std::fmt::Write;

/// The time of a step and its increments.
pub(super) struct Times {
    pub duration: f64,
    pub initial: f64,
    pub max: f64,
    pub min: Option<f64>,
}

#[derive(Clone, Copy)]
pub(super) struct Rotation {
    pub point: [f64; 3],
    /// 0 to 2.
    pub axis: usize,
    /// Degrees.
    pub angle: f64,
}

/// The conditions of a step by what they act on, each once, in the order in which they came.
#[derive(Default)]
pub(super) struct Lists {
    /// Sets that are held or moved.
    pub supported: Vec<String>,
    /// For each of these the way along x, y and z; `None` where it is free.
    ways: Vec<[Option<f64>; 3]>,
    tools: Vec<(String, [f64; 3], Option<Rotation>)>,
    pushed: Vec<(String, [f64; 3], [bool; 3])>,
    forces: Vec<(String, [f64; 3])>,
    pressures: Vec<(String, f64)>,
    body_forces: Vec<(String, [f64; 3])>,
}

pub(super) fn letter(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}

impl Lists {
    pub fn add_support(&mut self, set: &str, axis: usize, by: f64) {
        let known = self.supported.iter().position(|other| other == set);
        let at = known.unwrap_or_else(|| {
            self.supported.push(set.to_string());
            self.ways.push([None; 3]);
            self.ways.len() - 1
        });
        self.ways[at][axis] = Some(by);
    }

    pub fn move_tool(&mut self, tool: &str, by: [f64; 3], rotation: Option<Rotation>) {
        if by != [0.0; 3] || rotation.is_some() {
            self.tools.push((tool.to_string(), by, rotation));
        }
    }

    pub fn push_tool(&mut self, tool: &str, total: [f64; 3], free: [bool; 3]) {
        self.pushed.push((tool.to_string(), total, free));
    }

    pub fn add_force(&mut self, set: &str, total: [f64; 3]) {
        add(&mut self.forces, set, total);
    }

    pub fn add_body_force(&mut self, body: &str, per_volume: [f64; 3]) {
        add(&mut self.body_forces, body, per_volume);
    }

    pub fn add_pressure(&mut self, set: &str, value: f64) {
        match self.pressures.iter_mut().find(|(other, _)| other == set) {
            Some((_, sum)) => *sum += value,
            None => self.pressures.push((set.to_string(), value)),
        }
    }

    fn fix(&self) -> Vec<String> {
        let held = self.supported.iter().zip(&self.ways).map(|(set, ways)| (set, ways.map(|way| way == Some(0.0))));
        let held = held.filter(|(_, held)| held.contains(&true));
        held.map(|(set, held)| format!("{{ set = {}{} }}", quoted(set), directions(held))).collect()
    }

    fn moves(&self) -> Vec<String> {
        let mut moves = Vec::new();
        for (set, ways) in self.supported.iter().zip(&self.ways) {
            let moved = ways.map(|way| way.is_some_and(|way| way != 0.0));
            let by = ways.map(|way| way.unwrap_or(0.0));
            if moved.contains(&true) {
                moves.push(format!("{{ target = {}, by = {by:?}{} }}", quoted(set), directions(moved)));
            }
        }
        for (tool, by, rotation) in &self.tools {
            let rotate = rotation.map_or(String::new(), |Rotation { point, axis, angle }| {
                let mut along = [0.0; 3];
                along[axis] = 1.0;
                format!(", rotate = {{ point = {point:?}, axis = {along:?}, angle = {angle:?} }}")
            });
            let by = if *by == [0.0; 3] { String::new() } else { format!(", by = {by:?}") };
            moves.push(format!("{{ target = {}{by}{rotate} }}", quoted(tool)));
        }
        moves
    }

    fn all_forces(&self) -> Vec<String> {
        let on_tools = self.pushed.iter().map(|(tool, total, free)| {
            let free: String = (0..3).filter(|&axis| free[axis]).map(letter).collect();
            format!("{{ target = {}, total = {total:?}, directions = \"{free}\" }}", quoted(tool))
        });
        let on_sets =
            self.forces.iter().map(|(set, total)| format!("{{ target = {}, total = {total:?} }}", quoted(set)));
        on_tools.chain(on_sets).collect()
    }
}

fn add(list: &mut Vec<(String, [f64; 3])>, name: &str, vector: [f64; 3]) {
    match list.iter_mut().find(|(other, _)| other == name) {
        Some((_, sum)) => sum.iter_mut().zip(vector).for_each(|(sum, part)| *sum += part),
        None => list.push((name.to_string(), vector)),
    }
}

pub(super) fn quoted(text: &str) -> toml::Value {
    toml::Value::from(text)
}

/// The key for directions; all three are the default.
fn directions(which: [bool; 3]) -> String {
    match which {
        [true, true, true] => String::new(),
        _ => format!(", directions = \"{}\"", (0..3).filter(|&axis| which[axis]).map(letter).collect::<String>()),
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
    let pressures = lists.pressures.iter().filter(|(_, value)| *value != 0.0);
    let pressures = pressures.map(|(set, value)| format!("{{ set = {}, value = {value:?} }}", quoted(set)));
    let body_forces = lists.body_forces.iter();
    let body_forces = body_forces.map(|(body, force)| format!("{{ body = {}, per_volume = {force:?} }}", quoted(body)));
    for (key, items) in [
        ("fix", lists.fix()),
        ("move", lists.moves()),
        ("force", lists.all_forces()),
        ("pressure", pressures.collect()),
        ("body_force", body_forces.collect()),
    ] {
        text += &list(key, &items);
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

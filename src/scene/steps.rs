//! Reads the steps of a scene: increments, and the conditions that act in each.

use super::keep::keep;
use super::reader::{Item, Table, check_name};
use super::references::{Names, Target};
use super::{
    Around, BodyForce, Dashpot, Fix, Force, Increment, Limits, Located, Move, Pressure, Rotation, Spring, Step,
};
use super::{amplitude, gravity, spin, torque};
use crate::error::{Error, Faults, Location, Result};
use crate::{AXIS_NAMES, Vec3};

const SHARE: &str = "it is a share of the slave nodes";
/// Share of a motion across a direction that counts as rounding.
const ALONG: f64 = 1e-6;
const ADD_STEP: &str = "add a table `[[step]]` with its increments and conditions";

/// The steps, one or more, with unique names.
pub(super) fn read(root: &Table, names: &Names) -> Result<Vec<Step>> {
    let item = root.get("step").ok_or_else(|| Error::input(root.at(), "the scene has no step", ADD_STEP))?;
    let items = item.filled_list().map_err(|error| match error {
        Error::Input { at, what, .. } => Error::Input { at, what, help: ADD_STEP.to_string() },
        other => other,
    })?;
    let (mut steps, mut faults): (Vec<Step>, _) = (Vec::new(), Faults::default());
    for (k, item) in items.iter().enumerate() {
        // What follows a step that is wrong is not known to keep what it keeps.
        let before = (steps.len() == k).then(|| steps.last());
        let step = step(item, k + 1, names, before);
        faults.note(&step);
        let Ok(step) = step else { continue };
        if steps.iter().any(|other| other.name.value == step.name.value) {
            let what = format!("two steps are named `{}`", step.name.value);
            faults.note::<()>(&Err(Error::input(&step.name.at, what, "rename one")));
        }
        steps.push(step);
    }
    faults.finish()?;
    Ok(steps)
}

/// The keys of a step.
const KEYS: [&str; 16] = [
    "name",
    "duration",
    "increment",
    "increments",
    "keep",
    "release",
    "fix",
    "move",
    "force",
    "torque",
    "pressure",
    "body_force",
    "spin",
    "spring",
    "dashpot",
    "gravity",
];

/// A step after the one `before`, if there is one, and if it is known.
fn step(item: &Item, number: usize, names: &Names, before: Option<Option<&Step>>) -> Result<Step> {
    let (table, known) = item.table_and_strange(&KEYS)?;
    let name = match table.optional("name", Item::located_string)? {
        Some(name) => check_name(&name.value, &name.at).map(|()| name)?,
        None => item.located(format!("step {number}")),
    };
    let duration = table.optional("duration", Item::positive)?.unwrap_or(1.0);
    let (increment, fix) = (increment(&table, duration), table.each("fix", |item| fix(item, names)));
    let moves = table.each("move", |item| movement(item, names, duration));
    let forces = table.each("force", |item| force(item, names, duration));
    let torques = table.each("torque", |item| torque::read(item, names, duration));
    let pressures = table.each("pressure", |item| pressure(item, names, duration));
    let body_forces = table.each("body_force", |item| body_force(item, names, duration));
    let spins = table.each("spin", |item| spin::read(item, names, duration));
    let springs = table.each("spring", |item| spring(item, names));
    let dashpots = table.each("dashpot", |item| dashpot(item, names));
    let gravity = table.optional("gravity", |item| Ok(item.located(gravity::read(item, duration)?)));
    let mut faults = Faults::default();
    faults.note(&known);
    faults.note(&increment);
    faults.note(&fix);
    faults.note(&moves);
    faults.note(&forces);
    faults.note(&torques);
    faults.note(&pressures);
    faults.note(&body_forces);
    faults.note(&spins);
    faults.note(&springs);
    faults.note(&dashpots);
    faults.note(&gravity);
    faults.finish()?;
    let mut step = Step {
        name,
        duration,
        increment: increment?,
        fix: fix?,
        pressures: pressures?,
        body_forces: body_forces?,
        moves: moves?,
        forces: forces?,
        torques: torques?,
        spins: spins?,
        springs: springs?,
        dashpots: dashpots?,
        gravity: gravity?,
        weights: Vec::new(),
        replaced: Vec::new(),
    };
    if let Some(before) = before {
        keep(&mut step, before, &table, |name| names.is_tool(name))?;
        amplitude::check_beginnings(&step, before)?;
    }
    if let (Some(dashpot), None) = (step.dashpots.first(), table.get("duration")) {
        let what = format!("step `{}` has dashpots, and no `duration`: their forces go by velocity", step.name.value);
        return Err(Error::input(&dashpot.set.at, what, "say how long it takes, as `duration = 1.0`"));
    }
    step.check(|name| names.is_tool(name))?;
    Ok(step)
}

impl Step {
    /// Refuses conditions that contradict each other, where `is_tool` tells tools from sets.
    ///
    /// # Errors
    /// What is moved, loaded or turned twice, or moved where it is fixed or driven by a force.
    pub fn check(&self, is_tool: impl Fn(&str) -> bool) -> Result<()> {
        check_repeats(self)?;
        check_fixed_moves(self)?;
        torque::check(self)?;
        let mut of_tools = self.forces.iter().filter(|force| is_tool(&force.target.value));
        of_tools.try_for_each(|force| check_free_directions(self, force))
    }
}

/// Increment sizes, `min <= initial <= max <= duration`; those not given follow from those that are.
fn increment(step: &Table, duration: f64) -> Result<Increment> {
    let table = match (step.get("increment"), step.get("increments")) {
        (None, None) => {
            let help = "add `increments = 20`, or `increment = { initial = 0.05, min = 1e-4, max = 0.1 }`";
            return Err(step.error("has no increments", help));
        }
        (Some(_), Some(count)) => return Err(count.error("stands beside `increment`", "keep one of the two")),
        (None, Some(count)) => {
            let size = duration / count.count()? as f64;
            return Ok(Increment { initial: size, min: size / 1024.0, max: size, limits: Limits::default() });
        }
        (Some(sizes), None) => sizes.table(&["initial", "min", "max", "strain", "contacts"])?,
    };
    let bounded = |key, low: f64, high: f64, high_name: &str| {
        let from = if low > 0.0 { format!("at least min ({low:?})") } else { "above 0".to_string() };
        let expected = format!("{from} and at most {high_name} ({high:?})");
        let holds = |value: f64| value > 0.0 && value >= low && value <= high;
        table.optional(key, |item| item.number_that_is(&expected, holds, "it is in the time of the step"))
    };
    let max = bounded("max", 0.0, duration, "the duration")?;
    let (high, high_name) = max.map_or((duration, "the duration"), |max| (max, "max"));
    let min = bounded("min", 0.0, high, high_name)?;
    let low = min.unwrap_or(0.0);
    let initial = bounded("initial", low, high, high_name)?;
    let initial = initial.unwrap_or((duration / 10.0).max(low).min(high));
    let share = |item: &Item| item.number_that_is("above 0 and at most 1", |v| v > 0.0 && v <= 1.0, SHARE);
    let limits =
        Limits { strain: table.optional("strain", Item::positive)?, contacts: table.optional("contacts", share)? };
    Ok(Increment { initial, min: min.unwrap_or(initial / 1024.0), max: max.unwrap_or(initial), limits })
}

fn fix(item: &Item, names: &Names) -> Result<Fix> {
    let table = item.table(&["set", "directions", "normal", "around"])?;
    let set = names.set(&table.require("set", "\"BODY.GROUP\"")?, "a tool stands still unless the step moves it")?;
    let Directions { along, normal, around } = directions(&table)?;
    Ok(Fix { set, directions: along, normal, around })
}

/// In which directions nodes are prescribed: along the axes that are named, all by default, along a unit vector alone, or in a
/// cylindrical frame.
struct Directions {
    along: [bool; 3],
    normal: Option<Vec3>,
    around: Option<Around>,
}

fn directions(table: &Table) -> Result<Directions> {
    let letters = table.get("directions");
    if let Some(item) = table.get("normal") {
        let other = ["directions", "around"].into_iter().find(|other| table.get(other).is_some());
        if let Some(other) = other {
            return Err(item.error(format!("stands beside `{other}`"), "keep one of the two"));
        }
        return Ok(Directions { along: [false; 3], normal: Some(item.unit_vector()?), around: None });
    }
    let Some(item) = table.get("around") else {
        let along = letters.map_or(Ok([true; 3]), |item| item.directions("xyz"))?;
        return Ok(Directions { along, normal: None, around: None });
    };
    let frame = item.table(&["point", "axis"])?;
    let around = Around {
        point: frame.require("point", "[0.0, 0.0, 0.0]")?.vector()?,
        axis: frame.require("axis", "[0.0, 0.0, 1.0]")?.unit_vector()?,
        directions: letters.map_or(Ok([true; 3]), |item| item.directions("rtz"))?,
        by: Vec3::zeros(),
    };
    Ok(Directions { along: [false; 3], normal: None, around: Some(around) })
}

fn movement(item: &Item, names: &Names, duration: f64) -> Result<Move> {
    let table = item.table(&["target", "by", "directions", "normal", "around", "rotate", "table"])?;
    let (target, kind) = names.target(&table.require("target", "\"TOOL\"")?)?;
    let (by, rotate) = (table.optional("by", Item::vector)?, table.optional("rotate", rotation)?);
    if by.is_none() && rotate.is_none() {
        return Err(table.error("does not say how to move", "add `by = [0.0, 0.0, 1.0]`"));
    }
    let mut by = without_rounding(by.unwrap_or_else(Vec3::zeros));
    let own = ["directions", "normal", "around"].into_iter().find_map(|key| table.get(key));
    if let (Target::Tool, Some(item)) = (kind, own) {
        return Err(item.error("is for sets; a tool moves in all three", "remove it"));
    }
    let Directions { along, normal, mut around } = directions(&table)?;
    let named = around.map_or(along, |around| around.directions);
    if let (Some(axis), Some(item)) =
        ((0..3).find(|&axis| by[axis] != 0.0 && !named[axis] && normal.is_none()), table.get("by"))
    {
        let name = if around.is_some() { ["r", "t", "z"][axis] } else { AXIS_NAMES[axis] };
        let what = format!("moves in {name}, which `directions` leaves free");
        return Err(item.error(what, "make it 0, or add the direction"));
    }
    if let (Some(normal), Some(item)) = (normal, table.get("by"))
        && (by - normal * normal.dot(&by)).norm() > ALONG * by.norm()
    {
        return Err(item.error("moves across `normal`, where it leaves the set free", "make it a multiple of `normal`"));
    }
    if let (Some(rotation), Some(item)) = (&rotate, table.get("rotate")) {
        check_turned(&item, rotation, (&table, &along))?;
    }
    if let Some(around) = &mut around {
        std::mem::swap(&mut around.by, &mut by);
    }
    let begins_at_rest = |item: &Item| {
        let table = amplitude::read(item, duration)?;
        let help = "make the first factor 0: a motion begins where its target is";
        if table.begin() == 0.0 { Ok(table) } else { Err(item.error("begins away from where its target is", help)) }
    };
    let table = table.optional("table", begins_at_rest)?;
    Ok(Move { target, by, directions: along, normal, around, rotate, table })
}

/// A set that turns is prescribed across the axis; along it it may be free.
fn check_turned(item: &Item, rotation: &Rotation, (table, along): (&Table, &[bool; 3])) -> Result<()> {
    if let Some(other) = ["normal", "around"].into_iter().find(|key| table.get(key).is_some()) {
        return Err(item.error(format!("stands beside `{other}`"), "keep one of the two"));
    }
    match (0..3).find(|&d| !along[d] && !rotation.is_along(d)) {
        None => Ok(()),
        Some(d) => {
            let what = format!("turns the set in {}, which `directions` leaves free", AXIS_NAMES[d]);
            Err(item.error(what, "leave free the direction of the axis alone, and that where it is x, y or z"))
        }
    }
}

fn rotation(item: &Item) -> Result<Rotation> {
    let table = item.table(&["point", "axis", "angle"])?;
    Ok(Rotation {
        point: table.require("point", "[0.0, 0.0, 0.0]")?.vector()?,
        axis: table.require("axis", "[0.0, 0.0, 1.0]")?.unit_vector()?,
        angle: table.require("angle", "90.0")?.number()?,
    })
}

fn force(item: &Item, names: &Names, duration: f64) -> Result<Force> {
    let table = item.table(&["target", "total", "directions", "table"])?;
    let (target, kind) = names.target(&table.require("target", "\"TOOL\"")?)?;
    let total_item = table.require("total", "[0.0, 0.0, -1.0]")?;
    let total = total_item.vector()?;
    let directions = match (kind, table.get("directions")) {
        (Target::Set, None) => [true; 3],
        (Target::Set, Some(item)) => return Err(item.error("is for tools; a set is free", "remove it")),
        (Target::Tool, Some(item)) => item.directions("xyz")?,
        (Target::Tool, None) => {
            let help = "add `directions = \"z\"`, those in which the force moves the tool";
            return Err(table.error(format!("has no `directions` for the tool `{}`", target.value), help));
        }
    };
    // What a program has turned into an axis is not 0 to the last digit.
    let rounding = 1e-12 * total.amax();
    if let Some(axis) = (0..3).find(|&axis| total[axis].abs() > rounding && !directions[axis]) {
        let what = format!("acts in {}, in which `directions` does not free the tool", AXIS_NAMES[axis]);
        return Err(total_item.error(what, "make it 0, or add the direction"));
    }
    let table = table.optional("table", |item| amplitude::read(item, duration))?;
    Ok(Force { target, total, directions, table })
}

fn pressure(item: &Item, names: &Names, duration: f64) -> Result<Pressure> {
    let table = item.table(&["set", "value", "table"])?;
    let set = names.faces(&table.require("set", "\"BODY.GROUP\"")?)?;
    let value = table.require("value", "1.0")?.number()?;
    Ok(Pressure { set, value, table: table.optional("table", |item| amplitude::read(item, duration))? })
}

fn body_force(item: &Item, names: &Names, duration: f64) -> Result<BodyForce> {
    let table = item.table(&["body", "per_volume", "table"])?;
    let body = names.body(&table.require("body", "\"BODY\"")?)?;
    let per_volume = table.require("per_volume", "[0.0, 0.0, -1.0]")?.vector()?;
    let table = table.optional("table", |item| amplitude::read(item, duration))?;
    Ok(BodyForce { body, section: None, per_volume, table })
}

fn spring(item: &Item, names: &Names) -> Result<Spring> {
    let table = item.table(&["set", "stiffness"])?;
    let set = names.set(&table.require("set", "\"BODY.GROUP\"")?, "a spring holds nodes of a body")?;
    Ok(Spring { set, stiffness: resisting(&table.require("stiffness", "[0.0, 0.0, 100.0]")?)? })
}

fn dashpot(item: &Item, names: &Names) -> Result<Dashpot> {
    let table = item.table(&["set", "damping"])?;
    let set = names.set(&table.require("set", "\"BODY.GROUP\"")?, "a dashpot holds nodes of a body")?;
    Ok(Dashpot { set, damping: resisting(&table.require("damping", "[0.0, 0.0, 10.0]")?)? })
}

/// Along x, y and z.
fn resisting(item: &Item) -> Result<Vec3> {
    let along = item.vector()?;
    match along.min() < 0.0 || along.max() == 0.0 {
        true => Err(item.error("must be 0 or more along x, y and z, and above 0 along one of them", "")),
        false => Ok(along),
    }
}

/// A target is moved once, and loaded once in each way, in a step.
fn check_repeats(step: &Step) -> Result<()> {
    let once = |verb: &str, targets: Vec<&Located<String>>| {
        let repeated = |&i: &usize| targets[..i].iter().any(|other| other.value == targets[i].value);
        match (1..targets.len()).find(repeated) {
            Some(i) => {
                Err(conflict(step, &targets[i].at, &format!("{verb} `{}` twice", targets[i].value), "merge the two"))
            }
            None => Ok(()),
        }
    };
    once("moves", step.moves.iter().map(|movement| &movement.target).collect())?;
    once("pushes", step.forces.iter().map(|force| &force.target).collect())?;
    once("presses on", step.pressures.iter().map(|pressure| &pressure.set).collect())?;
    once("pulls at", step.body_forces.iter().map(|force| &force.body).collect())?;
    once("spins", step.spins.iter().map(|spin| &spin.body).collect())?;
    once("has springs on", step.springs.iter().map(|spring| &spring.set).collect())?;
    once("has dashpots on", step.dashpots.iter().map(|dashpot| &dashpot.set).collect())
}

/// A vector without components that are rounding, as the sine of half a turn is.
fn without_rounding(vector: Vec3) -> Vec3 {
    const ROUNDING: f64 = 1e-12;
    vector.map(|x| if x.abs() <= ROUNDING * vector.norm() { 0.0 } else { x })
}

/// What to do about two conditions of one target, of which one may come from the step before.
pub(super) const EITHER: &str = "keep one of the two; what `keep` brings from the step before ends with `release`";

/// A set is not moved in a direction in which it is fixed.
fn check_fixed_moves(step: &Step) -> Result<()> {
    for movement in &step.moves {
        for fix in step.fix.iter().filter(|fix| fix.set.value == movement.target.value) {
            let turns = |axis| movement.rotate.is_some_and(|r| r.angle != 0.0 && !r.is_along(axis));
            if let Some(axis) = (0..3).find(|&d| (movement.by[d] != 0.0 || turns(d)) && fix.directions[d]) {
                let what = format!("moves `{}` in {}, in which it is fixed", fix.set.value, AXIS_NAMES[axis]);
                return Err(conflict(step, &movement.target.at, &what, EITHER));
            }
        }
    }
    Ok(())
}

/// A tool is not displaced in a direction in which a force drives it.
fn check_free_directions(step: &Step, force: &Force) -> Result<()> {
    for movement in step.moves.iter().filter(|movement| movement.target.value == force.target.value) {
        if let Some(axis) = (0..3).find(|&axis| movement.by[axis] != 0.0 && force.directions[axis]) {
            let what = format!("moves `{}` in {}, in which a force drives it", force.target.value, AXIS_NAMES[axis]);
            return Err(conflict(step, &movement.target.at, &what, EITHER));
        }
    }
    Ok(())
}

fn conflict(step: &Step, at: &Location, what: &str, help: &str) -> Error {
    Error::input(at, format!("step `{}` {what}", step.name.value), help)
}

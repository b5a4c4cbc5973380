//! How loads and motions follow a table over their step.

use super::reader::Item;
use super::{BodyForce, Force, Gravity, Located, Pressure, Spin, Step, Torque};
use crate::Vec3;
use crate::error::{Error, Location, Result};

/// A factor by the fraction of a step, linear between points from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Amplitude(Vec<[f64; 2]>);

impl Default for Amplitude {
    /// The straight ramp.
    fn default() -> Self {
        Self(vec![[0.0, 0.0], [1.0, 1.0]])
    }
}

impl Amplitude {
    /// The factor at a fraction of the step.
    pub fn at(&self, s: f64) -> f64 {
        let k = self.0.partition_point(|point| point[0] < s).clamp(1, self.0.len() - 1);
        let ([from, low], [to, high]) = (self.0[k - 1], self.0[k]);
        // Exact at both ends.
        let part = (s - from) / (to - from);
        low * (1.0 - part) + high * part
    }

    /// The factor at the end.
    pub fn end(&self) -> f64 {
        self.0[self.0.len() - 1][1]
    }

    /// The factor at the beginning.
    pub fn begin(&self) -> f64 {
        self.0[0][1]
    }

    /// Fractions at which it turns, without both ends.
    pub fn corners(&self) -> impl Iterator<Item = f64> {
        self.0[1..self.0.len() - 1].iter().map(|point| point[0])
    }

    /// The fastest change of the factor, over the whole step.
    pub fn steepest(&self) -> f64 {
        let slope = |pair: &[[f64; 2]]| ((pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])).abs();
        self.0.windows(2).map(slope).fold(0.0, f64::max)
    }
}

/// The factor at the end of a step.
pub(super) fn end(table: &Option<Amplitude>) -> f64 {
    table.as_ref().map_or(1.0, Amplitude::end)
}

impl Force {
    /// What it is at the end of the step.
    pub fn last(&self) -> Vec3 {
        self.total * end(&self.table)
    }
}

impl Pressure {
    /// What it is at the end of the step.
    pub fn last(&self) -> f64 {
        self.value * end(&self.table)
    }
}

impl BodyForce {
    /// What it is at the end of the step.
    pub fn last(&self) -> Vec3 {
        self.per_volume * end(&self.table)
    }
}

/// Refuses loads whose tables do not go on from what they were at the end of the step before.
///
/// # Errors
/// A load that would jump.
pub(super) fn check_beginnings(step: &Step, before: Option<&Step>) -> Result<()> {
    fn target<'a>(verb: &str, target: &'a Located<String>) -> Act<'a> {
        (format!("{verb} `{}`", target.value), &target.at)
    }
    for force in &step.forces {
        let earlier = before.and_then(|b| b.forces.iter().find(|other| other.target.value == force.target.value));
        let last = earlier.map_or(Vec3::zeros(), Force::last);
        check_beginning(
            step,
            target("pushes", &force.target),
            (force.total.as_slice(), &force.table),
            last.as_slice(),
        )?;
    }
    for torque in &step.torques {
        let same = |other: &&Torque| other.tool.value == torque.tool.value && other.axis == torque.axis;
        let last = before.and_then(|b| b.torques.iter().find(same)).map_or(0.0, Torque::last);
        check_beginning(step, target("turns", &torque.tool), (&[torque.total], &torque.table), &[last])?;
    }
    for pressure in &step.pressures {
        let same = |other: &&Pressure| other.set.value == pressure.set.value;
        let last = before.and_then(|b| b.pressures.iter().find(same)).map_or(0.0, Pressure::last);
        check_beginning(step, target("presses on", &pressure.set), (&[pressure.value], &pressure.table), &[last])?;
    }
    for force in &step.body_forces {
        let same = |other: &&BodyForce| other.body.value == force.body.value;
        let last = before.and_then(|b| b.body_forces.iter().find(same)).map_or(Vec3::zeros(), BodyForce::last);
        let pulling = target("acts on body", &force.body);
        check_beginning(step, pulling, (force.per_volume.as_slice(), &force.table), last.as_slice())?;
    }
    for spin in &step.spins {
        let same = |other: &&Spin| other.body.value == spin.body.value && other.is_about(&spin.point, &spin.axis);
        let last = before.and_then(|b| b.spins.iter().find(same)).map_or(0.0, Spin::last);
        check_beginning(step, target("spins body", &spin.body), (&[spin.square], &spin.table), &[last])?;
    }
    if let Some(gravity) = &step.gravity {
        let last = before.and_then(|b| b.gravity.as_ref()).map_or(Vec3::zeros(), |other| other.value.last());
        let Gravity { acceleration, table } = &gravity.value;
        let act = ("pulls by gravity".to_string(), &gravity.at);
        check_beginning(step, act, (acceleration.as_slice(), table), last.as_slice())?;
    }
    Ok(())
}

/// What a step does, and where it says so.
type Act<'a> = (String, &'a Location);

fn check_beginning(step: &Step, (does, at): Act, load: (&[f64], &Option<Amplitude>), last: &[f64]) -> Result<()> {
    /// Of the loads, what is no jump.
    const ROUNDING: f64 = 1e-9;
    let (whole, Some(table)) = load else { return Ok(()) };
    let begins: Vec<f64> = whole.iter().map(|load| load * table.begin()).collect();
    let largest = begins.iter().chain(last).fold(0.0f64, |largest, load| largest.max(load.abs()));
    if begins.iter().zip(last).all(|(begins, last)| (begins - last).abs() <= ROUNDING * largest) {
        return Ok(());
    }
    let told = |load: &[f64]| match load {
        [value] => format!("{value:?}"),
        vector => format!("{vector:?}"),
    };
    let what = format!(
        "step `{}` {does} with {} at the beginning of its table, but before it that was {}",
        step.name.value,
        told(&begins),
        told(last)
    );
    let help = "a load goes on from what it was: begin the table with that, or take the load there in a step before";
    Err(Error::input(at, what, help))
}

/// A table of times, from the beginning of a step to its end, and factors.
///
/// # Errors
/// Times that do not go from 0 to the duration, and increase.
pub(super) fn read(item: &Item, duration: f64) -> Result<Amplitude> {
    /// Of the duration, what is no difference in time.
    const ROUNDING: f64 = 1e-9;
    let mut points: Vec<[f64; 2]> = Vec::new();
    let rows = item.filled_list()?;
    for row in &rows {
        let [time, factor] = row.array::<f64, 2>(Item::number, "[0.0, 0.0]")?;
        match points.last() {
            None if time != 0.0 => {
                return Err(
                    row.error("must have the time 0, as the first point", "times count from the start of the step")
                );
            }
            Some(last) if time / duration - last[0] <= ROUNDING => {
                return Err(row.error("must have a later time than the last", ""));
            }
            _ => points.push([time / duration, factor]),
        }
    }
    match (points.last_mut(), rows.last()) {
        (Some(last), _) if (last[0] - 1.0).abs() <= ROUNDING => last[0] = 1.0,
        (_, Some(row)) => {
            let what = format!("must have the time {duration:?}, as the last point");
            return Err(row.error(what, "a table goes on until the end of the step, which is its `duration`"));
        }
        _ => {}
    }
    Ok(Amplitude(points))
}

#[cfg(test)]
mod tests {
    use super::super::{Scene, parse};
    use super::*;
    use std::path::Path;

    /// A scene of these steps, each with a length of 2.
    fn scene(steps: &[&str]) -> Result<Scene> {
        let head = "body.b = { mesh = \"b.msh\", material = \"m\" }\n\
                    material.m = { model = \"hooke\", young = 1, poisson = 0.3 }\n\
                    tool.t.plane = { point = [0, 0, 0], normal = [0, 0, 1] }\n";
        let steps: Vec<String> = steps.iter().map(|s| format!("[[step]]\nduration = 2\nincrements = 1\n{s}")).collect();
        parse("test.toml", &format!("{head}{}", steps.join("\n")), Path::new(""), &[])
    }

    #[track_caller]
    fn refused(steps: &[&str]) -> String {
        scene(steps).map(|_| ()).unwrap_err().to_string()
    }

    fn push(table: &str) -> String {
        format!("force = [{{ target = \"b.a\", total = [0, 0, -6], table = {table} }}]")
    }

    #[test]
    fn wrong_tables_are_refused_where_they_are_wrong() {
        let told = |table: &str| refused(&[&push(table)]);
        let key = |row: usize| format!("step.0.force.0.table.{row} must have");
        assert!(told("[[0, 0], [0, 1], [2, 1]]").contains(&(key(1) + " a later time than the last")));
        assert!(told("[[0.5, 0], [2, 1]]").contains(&(key(0) + " the time 0, as the first point")));
        assert!(told("[[0, 0], [1, 1]]").contains(&(key(1) + " the time 2.0, as the last point")));
        assert!(told("[[0, 0], [1, 1], [3, 1]]").contains(&(key(2) + " the time 2.0, as the last point")));
        assert!(told("[[0, 0], [2, nan]]").contains("table.1.1 must be finite"));
        assert!(told("[[0, 0], [2]]").contains("table.1 must be a list of 2 numbers, not of 1"));
        let moved = refused(&["move = [{ target = \"t\", by = [0, 0, 1], table = [[0, 1], [2, 0]] }]"]);
        assert!(moved.contains("test.toml:7:49: step.0.move.0.table begins away from where its target is"), "{moved}");
    }

    #[test]
    fn loads_by_tables_go_on_from_what_they_were() {
        assert!(scene(&[&push("[[0, 0], [1, 2], [2, 0.5]]"), &push("[[0, 0.5], [2, 1]]")]).is_ok());
        // Half of 6 at the end of the first step, listed there or kept.
        for between in ["", "keep = true"] {
            let later = refused(&[&push("[[0, 0], [1, 2], [2, 0.5]]"), between, &push("[[0, 1], [2, 1]]")]);
            let last = if between.is_empty() { "[0.0, 0.0, 0.0]" } else { "[0.0, 0.0, -3.0]" };
            let what = "step `step 3` pushes `b.a` with [0.0, 0.0, -6.0] at the beginning of its table, but before it that was";
            assert!(later.contains(&format!("{what} {last}")), "{later}");
        }
        let press = |value: f64| format!("pressure = [{{ set = \"b.a\", value = {value}, table = [[0, 1], [2, 0]] }}]");
        let straight = "pressure = [{ set = \"b.a\", value = 3 }]";
        assert!(scene(&[straight, &press(3.0)]).is_ok());
        assert!(refused(&[straight, &press(2.0)]).contains("presses on `b.a` with 2.0 at the beginning"));
    }

    #[test]
    fn what_cannot_be_kept_or_released_is_refused() {
        assert!(refused(&["keep = true"]).contains("keep has no step before it"));
        assert!(refused(&["", "release = [\"b\"]"]).contains("release stands without `keep`"));
        let wrong = refused(&["fix = [{ set = \"b.a\" }]", "keep = true\nrelease = [\"b\"]"]);
        assert!(wrong.contains("release.0 is `b`, on which no support or load of the step before acts"), "{wrong}");
        assert!(wrong.contains("did you mean `b.a`?") || wrong.contains("known: b.a"), "{wrong}");
        let driven = "force = [{ target = \"t\", total = [0, 0, 1], directions = \"z\" }]";
        let moved = refused(&[driven, "keep = true\nmove = [{ target = \"t\", by = [1, 0, 1] }]"]);
        assert!(moved.contains("moves `t` in z, in which a force drives it"), "{moved}");
        let weight = refused(&["gravity = [0, 0, -1]"]);
        assert!(weight.contains("gravity acts on body `b`, but its material `m` has no density"), "{weight}");
    }

    #[test]
    fn turns_by_tables_are_as_short_as_their_fastest_part() {
        let turn = "move = [{ target = \"t\", rotate = { point = [0, 0, 0], axis = [0, 0, 1], angle = 30 }, table = [[0, 0], [0.5, 1], [2, 0]] }]";
        let step = &scene(&[turn]).unwrap().steps[0];
        assert_eq!((step.sizes().max, step.corners()), (0.5, vec![0.25]));
    }
}

//! Conditions whose amplitudes bend within a step: one step with tables in time for the parts between the bends.

use super::scene::{Lists, Load, Rotation, ToolMove};
use super::supported::Support;

/// Fractions of a step, from 0 to 1, and shares of what acts or is done.
pub(super) type Table = Vec<[f64; 2]>;

/// Of the largest number, what is no difference.
const ROUNDING: f64 = 1e-12;

/// How numbers go over a step.
struct Course<const N: usize> {
    /// What the shares are of; at the end of the step where it goes straight.
    whole: [f64; N],
    table: Option<Table>,
}

/// The way from value to value at these fractions of a step, if there is one of a straight way and shares of one vector.
fn course<const N: usize>(values: &[[f64; N]], ends: &[f64]) -> Option<Course<N>> {
    let (first, last) = (*values.first()?, *values.last()?);
    let largest: [f64; N] = std::array::from_fn(|i| values.iter().map(|value| value[i].abs()).fold(0.0, f64::max));
    let alike = |a: &[f64; N], b: &[f64; N]| (0..N).all(|i| (a[i] - b[i]).abs() <= ROUNDING * largest[i]);
    let straight = |s: f64| std::array::from_fn(|i| first[i] + (last[i] - first[i]) * s);
    if values.iter().zip(ends).all(|(value, &s)| alike(value, &straight(s))) {
        return Some(Course { whole: last, table: None });
    }
    let dot = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let whole = *values.iter().max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)))?;
    let shares: Vec<f64> = values.iter().map(|value| dot(value, &whole) / dot(&whole, &whole)).collect();
    let holds = |(value, share): (&[f64; N], &f64)| alike(value, &whole.map(|part| share * part));
    if !values.iter().zip(&shares).all(holds) {
        return None;
    }
    let mut table = Table::new();
    for (k, (&s, &share)) in ends.iter().zip(&shares).enumerate() {
        // Only where it bends: others may bend elsewhere.
        let bends = || {
            let ([s0, a0], [s1, a1]) = (table[table.len() - 1], [ends[k + 1], shares[k + 1]]);
            (a0 + (a1 - a0) * (s - s0) / (s1 - s0) - share).abs() > ROUNDING
        };
        if k == 0 || k + 1 == ends.len() || bends() {
            table.push([s, share]);
        }
    }
    Some(Course { whole, table: Some(table) })
}

/// The conditions of a whole step from those of its parts between these fractions, after `before`, the conditions at the end
/// of the last step. `None` where they change their direction on the way, which no table says.
pub(super) fn joined(before: &Lists, parts: &[Lists], ends: &[f64]) -> Option<Lists> {
    let first = parts.first()?;
    let sets = |part: &Lists| part.supports.iter().map(|support| support.set.clone()).collect::<Vec<_>>();
    if parts.iter().any(|part| sets(part) != sets(first) || part.pushed.len() != first.pushed.len()) {
        return None;
    }
    let mut all = Lists { springs: first.springs.clone(), ..Lists::default() };
    for k in 0..first.supports.len() {
        all.supports.push(support(parts.iter().map(|part| &part.supports[k]).collect(), ends)?);
    }
    for name in names(parts.iter().map(|part| part.tools.iter().map(|tool| &tool.name))) {
        all.tools.push(tool(name, parts, ends)?);
    }
    all.pushed = on_tools(before, parts, ends, |lists| &lists.pushed)?;
    all.turned = on_tools(before, parts, ends, |lists| &lists.turned)?;
    all.forces = loads(before, parts, ends, |lists| &lists.forces)?;
    all.pressures = loads(before, parts, ends, |lists| &lists.pressures)?;
    all.spins = loads(before, parts, ends, |lists| &lists.spins)?;
    all.spin_axis = parts.iter().find_map(|part| part.spin_axis).or(before.spin_axis);
    all.body_forces = loads(before, parts, ends, |lists| &lists.body_forces)?;
    all.gravity = loads(before, parts, ends, |lists| &lists.gravity)?;
    Some(all)
}

/// The way of a set.
fn support(parts: Vec<&Support>, ends: &[f64]) -> Option<Support> {
    let first = parts[0];
    if parts.iter().any(|part| part.ways.map(|way| way.is_some()) != first.ways.map(|way| way.is_some())) {
        return None;
    }
    let steps: Vec<_> = parts.iter().map(|part| with_angle(part.by(), part.rotation)).collect();
    let (whole, rotation, table) = turning(&steps, parts.iter().map(|part| part.rotation), ends)?;
    let is_moved = |axis: usize| steps.iter().any(|by| by[axis] != 0.0);
    let ways = [0, 1, 2].map(|axis| first.ways[axis].map(|_| if is_moved(axis) { whole[axis] } else { 0.0 }));
    Some(Support { ways, rotation, table, ..first.clone() })
}

/// The way of a tool.
fn tool(name: &str, parts: &[Lists], ends: &[f64]) -> Option<ToolMove> {
    let found: Vec<_> = parts.iter().map(|part| part.tools.iter().find(|tool| tool.name == name)).collect();
    let of_tool = |tool: &Option<&ToolMove>| tool.map_or([0.0; 4], |tool| with_angle(tool.by, tool.rotation));
    let steps: Vec<[f64; 4]> = found.iter().map(of_tool).collect();
    let (by, rotation, table) = turning(&steps, found.iter().map(|tool| (*tool)?.rotation), ends)?;
    Some(ToolMove { name: name.to_string(), by, rotation, table })
}

fn with_angle([x, y, z]: [f64; 3], rotation: Option<Rotation>) -> [f64; 4] {
    [x, y, z, rotation.map_or(0.0, |rotation| rotation.angle)]
}

/// A way, a rotation, and the table of both.
type Turning = ([f64; 3], Option<Rotation>, Option<Table>);

/// Ways and angles of the parts of a step, with the rotations that they are of, as one.
fn turning(steps: &[[f64; 4]], rotations: impl Iterator<Item = Option<Rotation>>, ends: &[f64]) -> Option<Turning> {
    let places = sums(steps);
    let turn = rotations.zip(&places).find_map(|(rotation, place)| Some((rotation?, place)));
    let Course { whole: [x, y, z, angle], table } = course(&places, ends)?;
    let rotation = turn.map(|(mut rotation, place)| {
        // The axis goes along.
        (0..3).for_each(|axis| rotation.axis.point[axis] -= place[axis]);
        rotation.angle = angle;
        rotation
    });
    Some(([x, y, z], rotation, table))
}

/// Loads on tools, each with the way in which its tool is free; these are the same in all parts.
fn on_tools<F: Copy>(
    before: &Lists,
    parts: &[Lists],
    ends: &[f64],
    of: impl Fn(&Lists) -> &Vec<(Load, F)>,
) -> Option<Vec<(Load, F)>> {
    let course_of = |(load, free): &(Load, F)| {
        let own = |lists: &Lists| of(lists).iter().find(|(other, _)| other.on == load.on).map(|(own, _)| own.last());
        let values: Vec<_> = [before].into_iter().chain(parts).map(|lists| own(lists).unwrap_or_default()).collect();
        let Course { whole, table } = course(&values, ends)?;
        Some((Load { on: load.on.clone(), value: whole, table }, *free))
    };
    of(parts.first()?).iter().map(course_of).collect()
}

/// Loads of one kind, those of the last step, too; what falls to zero straight is not listed.
fn loads(before: &Lists, parts: &[Lists], ends: &[f64], of: impl Fn(&Lists) -> &Vec<Load>) -> Option<Vec<Load>> {
    let mut all = Vec::new();
    for name in names([before].into_iter().chain(parts).map(|lists| of(lists).iter().map(|load| &load.on))) {
        let value = |lists: &Lists| of(lists).iter().find(|load| load.on == name).map_or([0.0; 3], Load::last);
        let values: Vec<_> = [before].into_iter().chain(parts).map(value).collect();
        let Course { whole, table } = course(&values, ends)?;
        if table.is_some() || whole != [0.0; 3] {
            all.push(Load { on: name.to_string(), value: whole, table });
        }
    }
    Some(all)
}

/// Each name once, in the order in which they come.
fn names<'a>(lists: impl Iterator<Item = impl Iterator<Item = &'a String>>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for name in lists.flatten() {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// 0 and the sums of the first, the first two, and so on.
fn sums<const N: usize>(steps: &[[f64; N]]) -> Vec<[f64; N]> {
    let mut sums = vec![[0.0; N]];
    for step in steps {
        let last = sums[sums.len() - 1];
        sums.push(std::array::from_fn(|i| last[i] + step[i]));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convert::scene::add;

    type Found = (String, [f64; 3], Option<Table>);

    fn pushing(loads: &[(&str, [f64; 3])]) -> Lists {
        let mut lists = Lists::default();
        loads.iter().for_each(|(on, value)| add(&mut lists.forces, on, *value));
        lists
    }

    /// What the loads of a step of two halves become: name, whole, table.
    fn forces(before: &Lists, middle: &Lists, end: Lists) -> Option<Vec<Found>> {
        let parts = [Lists { forces: middle.forces.clone(), ..Lists::default() }, end];
        let all = joined(before, &parts, &[0.0, 0.5, 1.0])?;
        Some(all.forces.into_iter().map(|load| (load.on, load.value, load.table)).collect())
    }

    #[test]
    fn loads_go_on_from_the_last_step() {
        let (nothing, a) = (Lists::default(), pushing(&[("a", [0.0, 0.0, 4.0])]));
        let half = pushing(&[("a", [0.0, 0.0, 2.0])]);
        let table = |shares: [f64; 3]| Some([0.0, 0.5, 1.0].into_iter().zip(shares).map(|(s, a)| [s, a]).collect());
        let of_a = |table| Some(vec![("a".to_string(), [0.0, 0.0, 4.0], table)]);
        // Straight up, straight down, up and down, and away in the first half, though then nothing has its name.
        assert_eq!(forces(&nothing, &half, pushing(&[("a", [0.0, 0.0, 4.0])])), of_a(None));
        assert_eq!(forces(&a, &half, Lists::default()), Some(Vec::new()));
        assert_eq!(forces(&nothing, &a, pushing(&[("a", [0.0, 0.0, 1.0])])), of_a(table([0.0, 1.0, 0.25])));
        assert_eq!(forces(&a, &nothing, Lists::default()), of_a(table([1.0, 0.0, 0.0])));
        // One that turns has no table.
        assert_eq!(forces(&nothing, &a, pushing(&[("a", [1.0, 0.0, 4.0])])), None);
    }

    /// Another amplitude bends at a quarter: this one is straight there.
    #[test]
    fn tables_have_the_points_at_which_they_bend() {
        let ends = [0.0, 0.25, 0.5, 1.0];
        let parts = [1.0, 2.0, 0.0].map(|value| pushing(&[("a", [value, 0.0, 0.0])]));
        let all = joined(&Lists::default(), &parts, &ends).unwrap();
        assert_eq!(all.forces[0].table, Some(vec![[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]]));
    }
}

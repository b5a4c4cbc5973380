//! What a step keeps of the one before it.

use super::reader::{Item, Table};
use super::{
    Around, BodyForce, Dashpot, Fix, Force, Gravity, Located, Pressure, Spin, Spring, Step, Torque, did_you_mean,
};
use crate::Vec3;
use crate::error::Result;

/// Adds to `step` what it keeps of the step `before`: by `keep` the conditions of sets, tools and bodies that it does not list
/// again itself, nor `release`s. A set that was moved stays where it is; motions of tools end.
///
/// # Errors
/// Nothing to keep, and releases of what is not held.
pub(super) fn keep(
    step: &mut Step,
    before: Option<&Step>,
    table: &Table,
    is_tool: impl Fn(&str) -> bool,
) -> Result<()> {
    let keeps = table.optional("keep", |item| Ok(item.boolean()?.then(|| item.clone())))?.flatten();
    let released = table.each("release", |item| Ok((item.string()?.to_string(), item.clone())))?;
    let Some(keeps) = keeps else {
        let help = "add `keep = true`; without it a step holds only what it lists";
        return table.get("release").map_or(Ok(()), |item| Err(item.error("stands without `keep`", help)));
    };
    let Some(before) = before else {
        return Err(keeps.error("has no step before it, of which it could keep anything", "remove it"));
    };
    let mut kept = Kept::of(before, is_tool);
    for (name, item) in &released {
        kept.check_release(name, item)?;
    }
    kept.retain(|name| released.iter().all(|(gone, _)| gone != name));
    kept.add_to(step);
    Ok(())
}

/// The conditions that a step leaves behind.
struct Kept {
    fix: Vec<Fix>,
    forces: Vec<Force>,
    torques: Vec<Torque>,
    pressures: Vec<Pressure>,
    body_forces: Vec<BodyForce>,
    spins: Vec<Spin>,
    springs: Vec<Spring>,
    dashpots: Vec<Dashpot>,
    gravity: Option<Located<Gravity>>,
}

impl Kept {
    fn of(before: &Step, is_tool: impl Fn(&str) -> bool) -> Self {
        let moved = before.moves.iter().filter(|motion| !is_tool(&motion.target.value));
        let stays = moved.map(|motion| Fix {
            set: motion.target.clone(),
            directions: motion.directions,
            normal: motion.normal,
            around: motion.around.map(|around| Around { by: Vec3::zeros(), ..around }),
        });
        let forces = before.forces.iter().map(|f| Force { total: f.last(), table: None, ..f.clone() });
        let pressures = before.pressures.iter().map(|p| Pressure { value: p.last(), table: None, ..p.clone() });
        let body_forces =
            before.body_forces.iter().map(|b| BodyForce { per_volume: b.last(), table: None, ..b.clone() });
        let gravity = before.gravity.as_ref().map(|gravity| {
            let acceleration = gravity.value.last();
            Located { value: Gravity { acceleration, table: None }, at: gravity.at.clone() }
        });
        Self {
            fix: before.fix.iter().cloned().chain(stays).collect(),
            forces: forces.collect(),
            torques: before.torques.iter().map(|torque| torque.kept(&before.moves)).collect(),
            pressures: pressures.collect(),
            body_forces: body_forces.collect(),
            spins: before.spins.iter().map(|s| Spin { square: s.last(), table: None, ..s.clone() }).collect(),
            springs: before.springs.clone(),
            dashpots: before.dashpots.clone(),
            gravity,
        }
    }

    /// The sets, tools and bodies that something is kept of.
    fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = (self.fix.iter().map(|fix| &fix.set))
            .chain(self.forces.iter().map(|force| &force.target))
            .chain(self.torques.iter().map(|torque| &torque.tool))
            .chain(self.pressures.iter().map(|pressure| &pressure.set))
            .chain(self.body_forces.iter().map(|force| &force.body))
            .chain(self.spins.iter().map(|spin| &spin.body))
            .chain(self.springs.iter().map(|spring| &spring.set))
            .chain(self.dashpots.iter().map(|dashpot| &dashpot.set))
            .map(|name| name.value.as_str())
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    fn check_release(&self, name: &str, item: &Item) -> Result<()> {
        let names = self.names();
        if names.contains(&name) {
            return Ok(());
        }
        let what = format!("is `{name}`, on which no support or load of the step before acts");
        Err(item.error(what, did_you_mean(name, names)))
    }

    /// Keeps what is on sets, tools and bodies with such names.
    fn retain(&mut self, keeps: impl Fn(&str) -> bool) {
        self.fix.retain(|fix| keeps(&fix.set.value));
        self.forces.retain(|force| keeps(&force.target.value));
        self.torques.retain(|torque| keeps(&torque.tool.value));
        self.pressures.retain(|pressure| keeps(&pressure.set.value));
        self.body_forces.retain(|force| keeps(&force.body.value));
        self.spins.retain(|spin| keeps(&spin.body.value));
        self.springs.retain(|spring| keeps(&spring.set.value));
        self.dashpots.retain(|dashpot| keeps(&dashpot.set.value));
    }

    /// Adds what the step does not list again.
    fn add_to(mut self, step: &mut Step) {
        let lists = |set: &str| {
            step.fix.iter().any(|own| own.set.value == set) || step.moves.iter().any(|own| own.target.value == set)
        };
        let (replaced, kept) = self.fix.into_iter().partition(|fix| lists(&fix.set.value));
        (step.replaced, self.fix) = (replaced, kept);
        self.forces.retain(|force| step.forces.iter().all(|own| own.target.value != force.target.value));
        self.torques.retain(|torque| step.torques.iter().all(|own| own.tool.value != torque.tool.value));
        self.pressures.retain(|pressure| step.pressures.iter().all(|own| own.set.value != pressure.set.value));
        self.body_forces.retain(|force| step.body_forces.iter().all(|own| own.body.value != force.body.value));
        self.spins.retain(|spin| step.spins.iter().all(|own| own.body.value != spin.body.value));
        self.springs.retain(|spring| step.springs.iter().all(|own| own.set.value != spring.set.value));
        self.dashpots.retain(|dashpot| step.dashpots.iter().all(|own| own.set.value != dashpot.set.value));
        step.gravity = step.gravity.take().or(self.gravity);
        step.fix.append(&mut self.fix);
        step.forces.append(&mut self.forces);
        step.torques.append(&mut self.torques);
        step.pressures.append(&mut self.pressures);
        step.body_forces.append(&mut self.body_forces);
        step.spins.append(&mut self.spins);
        step.springs.append(&mut self.springs);
        step.dashpots.append(&mut self.dashpots);
    }
}

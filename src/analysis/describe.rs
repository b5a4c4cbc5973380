//! What a run says: what will be modelled, how it went, and why it failed.

use super::cost::work::Rates;
use super::{Increment, Remedy, Retried};
use crate::contact::{BodySurface, Tool};
use crate::failure::{Cause, Failure};
use crate::model::Model;
use crate::output::summary::Summary;
use crate::scene::{Body, Enforcement, Isochoric, MaterialModel, Reduction, Scene, Smoothing};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::fmt::Write;
use std::path::Path;

/// The first lines of a log.
pub fn heading(comm: &SimpleCommunicator, scene: &Scene, model: &Model) -> String {
    let some = |count: u64, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    format!(
        "{}\n{}, {}, {}, {} on {}",
        scene.title,
        some(model.part.whole.solids, "element"),
        some(model.part.whole.nodes, "node"),
        some(model.masters.tools.len() as u64, "tool"),
        some(model.pairs.len() as u64, "contact"),
        some(comm.size() as u64, "rank"),
    )
}

/// What a tool is made of, and what to know of it.
pub fn tool(tool: &Tool) -> String {
    let mut text = format!("tool `{}`: rigid, {}, no nodes in the system", tool.name, tool.surface.summary);
    for warning in &tool.surface.warnings {
        let _ = write!(text, "\n  warning: tool `{}`: {warning}", tool.name);
    }
    text
}

/// What a deformable master is made of.
pub fn master(surface: &BodySurface) -> String {
    let kind = match surface.given.smoothing {
        _ if surface.is_quadratic => "quadratic facets",
        Smoothing::Facet => "flat facets",
        Smoothing::Nagata => "Nagata patches",
    };
    format!("master `{}`: deformable, {} {kind}", surface.name, surface.total)
}

/// What bodies are made of, a line each.
pub fn bodies(scene: &Scene, model: &Model) -> String {
    scene.bodies.iter().enumerate().map(|(b, given)| body(scene, model, b, given)).collect()
}

/// How contacts are modelled, a line each. Collective.
pub fn contacts(comm: &SimpleCommunicator, model: &Model) -> String {
    let mut text = String::new();
    let slaves = model.slave_counts(comm);
    for (pair, count) in model.pairs.iter().zip(slaves) {
        let method = match pair.rules.method {
            Enforcement::Penalty => "penalty",
            Enforcement::Lagrange => "Lagrange",
            Enforcement::AugmentedLagrangian => "augmented Lagrangian",
            Enforcement::Uzawa => "Uzawa",
        };
        let multipliers = ["no multipliers", "1 multiplier a node", "", "at most 3 multipliers a node"][pair.width()];
        let friction = match pair.rules.friction {
            0.0 => format!("frictionless, {multipliers}, no slip history"),
            friction => format!("friction {friction}, {multipliers}"),
        };
        let by = match &pair.faces {
            _ if pair.is_by_nodes() => ", each on a node of the master",
            Some(faces) if faces.follow_nodes() => ", from segment to segment, its faces curved as they are deformed",
            Some(_) => ", from segment to segment",
            None => "",
        };
        let _ = writeln!(text, "contact `{}`: {count} slave nodes{by}, {method}, {friction}", pair.name);
    }
    text
}

/// The last lines of a log: how much was done, and where to look next.
pub fn farewell(summary: &Summary, out: &Path) -> String {
    let mean = summary.counts.iterations as f64 / summary.counts.increments.max(1) as f64;
    let mut text = format!(
        "{} increments, {} cutbacks, {} iterations ({mean:.2} an increment), {:.1} s\nforce curve: {}",
        summary.counts.increments,
        summary.counts.cutbacks,
        summary.counts.iterations,
        summary.wall_s,
        out.join("history.csv").display(),
    );
    if summary.counts.increments > 0 {
        let _ = write!(text, "\nParaView:    {}", out.join("fields.xdmf").display());
    }
    text
}

/// Why no other increment is tried after one that has failed.
#[derive(Clone, Copy, Debug)]
pub enum Last<'a> {
    /// No shorter one is allowed than that, which was tried last.
    Smallest(f64),
    /// A path of little but jumps has come to its end.
    Jumps,
    /// A shorter one has failed for its shortness, for this reason.
    Lost(&'a str),
}

/// Says where and how far from equilibrium, and what to try: with the `reason` of the failure, what makes the matrix
/// ill-conditioned, the worst equation in words, the `remedies` that contacts call for, and why it was the `last` try.
pub fn failure(
    f: &Failure,
    reason: &str,
    (conditioning, worst): (Option<&str>, Option<&str>),
    remedies: &[String],
    last: Last,
) -> String {
    let mut text = format!("step `{}`, after time {:.6}: {reason}", f.step, f.time);
    if let Some(reason) = conditioning {
        let _ = write!(text, "; the matrix is ill-conditioned: {reason}");
        return text;
    }
    match f.cause {
        Cause::Singular => text += ": something can move freely",
        Cause::Rounding => return text,
        _ => {
            let _ = match last {
                Last::Smallest(least) if least < f.size => {
                    write!(
                        text,
                        " with an increment of {:.3e}, and nothing else that was tried down to {least:.3e} helps",
                        f.size
                    )
                }
                Last::Smallest(_) => write!(text, " with the smallest increment, {:.3e}", f.size),
                Last::Jumps => write!(text, " with an increment of {:.3e}, and too many jumps", f.size),
                Last::Lost(why) => write!(text, " with an increment of {:.3e}; in a shorter one {why}", f.size),
            };
        }
    }
    if let Some(worst) = worst.filter(|_| f.cause.is_linear() || f.cause.is_of_iteration()) {
        let _ = write!(text, "\n  worst: {worst}, residual {:.1e} of the largest force", f.residual);
        if f.changes > 0 {
            let _ = write!(text, "\n  {} contact nodes still change their status", f.changes);
        }
    }
    for remedy in remedies {
        let _ = write!(text, "\n  help: {remedy}");
    }
    if let Some(help) = help(f, worst.is_some(), !remedies.is_empty()) {
        let _ = write!(text, "\n  help: {help}");
    }
    text
}

/// What to try, whatever the contacts are; less where `contacts` are to be changed first.
fn help(f: &Failure, at_equation: bool, contacts: bool) -> Option<&'static str> {
    match f.cause {
        Cause::Watch => Some(
            "see that the normals of the master look at the slave, that it has all faces to which the slave may come, and that \
             the node is free to give way; mesh the slave finer where the master goes in between its nodes; load in smaller \
             increments, or allow a smaller `increment.min`",
        ),
        Cause::Rounds => Some(
            "raise the contact's `penalty` or `tolerance` if the method is `uzawa`, take another method, or one pass where contact is \
             from segment to segment",
        ),
        Cause::Contradiction => {
            Some("take one of these nodes out of a contact, or let contacts give way by `method = \"penalty\"`")
        }
        Cause::Loose => Some(
            "`fix` it, or hold it by friction, its weight or a soft `spring`; if contacts held it until now, end the step before it \
             comes loose",
        ),
        Cause::Singular if at_equation => {
            Some("`fix` what nothing holds, or `move` it into contact before a force drives it")
        }
        Cause::Iteration | Cause::Degenerate if at_equation => Some(match (contacts, f.changes) {
            (true, _) => "load in smaller increments, or allow a smaller `increment.min`",
            (_, 0) => {
                "load in smaller increments, allow a smaller `increment.min`, or refine the mesh where it distorts; past the \
                 largest load that a body bears there is no equilibrium: `move` it instead"
            }
            _ => "load in smaller increments, allow a smaller `increment.min`, or lower the contact's `penalty`",
        }),
        _ => None,
    }
}

/// Warns of a body that nothing holds any more, or against a `motion`, if that is not any.
pub fn loose(step: &str, time: f64, who: &str, motion: Option<&str>) -> String {
    match motion {
        None => format!(
            "step `{step}`: nothing holds {who} any more from time {time:.6} on, and nothing pushes it: it stays where it is, and no \
             force depends on where that is"
        ),
        Some(motion) => format!(
            "step `{step}`: {who} can {motion} from time {time:.6} on, for nothing holds or pushes it so: it stays as it is, and no force \
             depends on that"
        ),
    }
}

/// Warns of equations that MUMPS replaced: of what is `free`, if that is why.
pub fn null_pivots(step: &str, count: usize, free: Option<&str>) -> String {
    match free {
        Some(place) => format!(
            "step `{step}`: {place} can move freely: no support, contact or stiffness holds it, and nothing drives it. No force \
             depends on where it is"
        ),
        None => format!(
            "step `{step}`: {count} conditions say what others say (null pivots): what each of them bears is left to \
             rounding, and only their sum is right"
        ),
    }
}

/// Says where factors are that memory does not suffice for.
pub fn out_of_core(step: &str) -> String {
    format!(
        "  step `{step}`: memory does not suffice for the factors, which are kept in files of the folder of the run"
    )
}

/// Warns of an equilibrium that the least push would end; there may be solid-shells that are pressed.
pub fn unstable(step: &str, time: f64, has_shells: bool) -> String {
    let more = match has_shells {
        true => {
            ". Sheets of `hex8-shell` that are pressed through their thickness come to be so by turns of their walls that alternate \
             from node to node: between unlike meshes in one pass forces may be half of what is right; take `hex8-eas` there, or \
             discretization = \"segment\""
        }
        false => "",
    };
    format!(
        "step `{step}`: the equilibrium at time {time:.6} is not stable: a body would buckle or snap from it, or slide aside \
         where weak springs alone hold it, and forces from there on may be those of a way that it does not take. Take smaller \
         increments; where the scene is symmetric, give it an imperfection; hold what would slide by friction, or by stiffer \
         springs{more}"
    )
}

/// Of elements that lie on themselves.
pub fn folded(step: &str, time: f64, element: &str) -> String {
    format!(
        "step `{step}`: {element} has folded over at a node at time {time:.6}, and lies on itself there: strains and forces \
         beside it are not those of a body. Take another mesh there, or round off what presses on it"
    )
}

/// Of systems that the iterative solver was tried on in vain.
pub fn unsolved(step: &str) -> String {
    format!(
        "step `{step}`: multigrid did not converge, and the system was factored: results are as right, but time and memory \
         are those of factors; `linear = \"direct\"` does without the attempt"
    )
}

/// Of so many iterations of multigrid a system.
pub fn impatience(step: &str, mean: usize) -> String {
    format!(
        "  {step}: multigrid takes {mean} iterations a system; factors that serve several are cheaper, and take over"
    )
}

/// What is modelled of a body, a line for each of its materials.
fn body(scene: &Scene, model: &Model, b: usize, body: &Body) -> String {
    let reduction = model.bodies[b].reduction;
    let strain = match reduction {
        Some(Reduction::PlaneStrain) => ", plane strain: no u_z, one plane of nodes",
        Some(Reduction::Axisymmetric) => {
            ", axisymmetric: turned about y, no u_z, one plane of nodes, forces of the whole ring"
        }
        None => "",
    };
    let planes: Vec<String> = body.symmetry.iter().map(|set| format!("`{}`", set.value)).collect();
    let mirrored = if planes.is_empty() { String::new() } else { format!(", mirrored across {}", planes.join(", ")) };
    let parts = match &body.refine {
        Some(times) => {
            let directions = if reduction.is_some() { 2 } else { 3 };
            format!(", {} elements for each of its mesh", 1u64 << (directions * times.value))
        }
        None => String::new(),
    };
    let split = match (model.bodies[b].has_halves, reduction) {
        (false, _) => "",
        (true, None) => ", eight for each of second order",
        (true, Some(_)) => ", four for each of second order",
    };
    let mut text = String::new();
    let sections = model.sections.iter().zip(scene.sections()).filter(|(section, _)| section.body == b);
    let groups = std::iter::once(None).chain(body.materials.iter().map(|(group, _)| Some(&group.value)));
    for ((section, (_, material)), group) in sections.zip(groups) {
        let kind = match scene.material(&material.value) {
            Some(MaterialModel::NeoHookean { .. }) => "neo-hookean; no plasticity",
            Some(MaterialModel::Hooke { .. }) => "hooke (logarithmic strain); no plasticity",
            Some(MaterialModel::Orthotropic(_)) => "orthotropic (logarithmic strain); no plasticity",
            Some(MaterialModel::Hyperelastic { law: Isochoric::MooneyRivlin { .. }, .. }) => {
                "mooney-rivlin; no plasticity"
            }
            Some(MaterialModel::Hyperelastic { law: Isochoric::Yeoh { .. }, .. }) => "yeoh; no plasticity",
            Some(MaterialModel::Hyperelastic { law: Isochoric::Ogden(_), .. }) => "ogden; no plasticity",
            Some(MaterialModel::Plastic { hill: None, .. }) => "elastic-plastic (von Mises)",
            Some(MaterialModel::Plastic { hill: Some(_), .. }) => "elastic-plastic (Hill)",
            None => "?",
        };
        let name = &body.name.value;
        let mut element = section.element.key().to_string();
        for filler in &section.fillers {
            let _ = write!(element, " and {}", section.element.beside(*filler).key());
        }
        let _ = match group {
            None => writeln!(text, "body `{name}`: {element}{strain}, {kind}{mirrored}{split}{parts}"),
            Some(group) => writeln!(text, "  its `{group}`: {element}, {kind}"),
        };
    }
    text
}

/// What `nagata calibrate` prints: what each kind of work takes, and where that is kept, if it is.
pub fn rates(rates: &Rates, kept: Option<&Path>) -> String {
    let mut text = String::from("    ns  of\n");
    for (work, seconds) in rates.iter() {
        let _ = writeln!(text, "{:>10.4}  {}", 1e9 * seconds, work.name());
    }
    if let Some(path) = kept {
        let _ = writeln!(text, "kept in {}", path.display());
    }
    text
}

/// A contact whose overlap, up to so deep, is pushed out over a step.
pub fn ramped(step: &str, contact: &str, deepest: f64) -> String {
    format!(
        "contact `{contact}`: no increment was found that pushes its overlap of up to {deepest:.3e} out at once, so that this is done \
         over the step `{step}`: until its end nodes are inside by what is left of it"
    )
}

/// What is done about an increment that failed.
pub fn retried(Retried { step, size, reason, remedy }: &Retried) -> String {
    let next = match remedy {
        Remedy::Cut => "in a shorter one",
        Remedy::Follow => "with what touches going along at first",
        Remedy::Carry => "with what is turned going along at first",
        Remedy::Creep => "with friction that grows a little with slip",
        Remedy::Linger => "with what comes loose staying in place",
        Remedy::Yield => "with constraints that give way before they are tightened",
        Remedy::Hold => "with held multipliers (\"uzawa\") of contacts whose conditions may say what others say",
        Remedy::Ease => "with lower penalties of held multipliers",
        Remedy::Soften => "with other penalties",
        Remedy::Sets => "with active sets that stand still in the iteration, or not",
        Remedy::Central => "along the central path",
        Remedy::Settle => "with contacts that stick until they settle",
        Remedy::Glide => "with friction once all is in balance without it",
        Remedy::Ramp => "with what overlaps pushed out over the step",
        Remedy::Jump => "as a jump",
    };
    format!("  {step}: {reason} with increment {size:.3e}; again {next}")
}

/// Contact in a converged increment, in a few words.
pub fn note(increment: &Increment) -> String {
    let mut note = format!("{} in contact, {} slip", increment.nodes.touching, increment.nodes.slipping);
    if increment.rounds > 0 {
        let _ = write!(note, ", {} outer", increment.rounds);
    }
    if increment.nodes.calmed > 0 {
        let _ = write!(note, ", {} calmed", increment.nodes.calmed);
    }
    note
}

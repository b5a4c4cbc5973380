//! Sizes that hint at mixed units, and coordinates too far from the origin for their rounding to be small.

use super::sight::Standing;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::parallel::max;
use crate::partition::Bounds;
use crate::partition::parcels::{bounds, hull};
use crate::scene::{Material, MaterialModel, Scene, Step};
use mpi::topology::SimpleCommunicator;

/// Ratio of sizes that is hardly meant: a unit and its thousandth.
const UNLIKE: f64 = 900.0;
/// Yield stress over Young's modulus between which materials are: soft metals yield at 1e-5 and more, polymers below 0.1.
const YIELDS: [f64; 2] = [5e-6, 0.5];
/// Gap over the size of the body, from which it is hardly meant.
const FAR: f64 = 10.0;
/// Largest coordinate over the shortest edge of a body that is farther from the origin than it is long. Coordinates are
/// rounded to 1.1e-16 of themselves, strains to that times this ratio. Measured on a sphere on a block: at 1e3 forces are
/// right to 1e-8 for strains of 1e-5; at 1e5 they are 2 % off for strains of 1e-3.
const OFFSET: f64 = 3e4;
/// The same that is worth a word.
const APART: f64 = 3e3;
/// Strain that is right to 1e-5, over the ratio.
const ROUNDED: f64 = 1e5 * f64::EPSILON;

/// Largest coordinate or length of a tool over the shortest edge of the bodies that it meets: gaps are rounded to 1.1e-16 of
/// the one. Measured on spheres, cylinders, profiles and meshes: at 1e5 forces are right to 1e-10 for gaps of a tenth of an edge;
/// from 1e6 on residuals may round to more than the tolerance, and forces be found in shorter increments or not at all.
const TOOL_OFFSET: f64 = 5e5;
/// The same that is worth a word.
const TOOL_APART: f64 = 1e5;

/// The box of each body. Collective.
fn boxes(comm: &SimpleCommunicator, model: &Model) -> Vec<Bounds> {
    let part = &model.part;
    let of = |b: usize| bounds(part.owned_of(b).map(|n| part.points[n]));
    (0..model.bodies.len()).map(|b| hull(comm, of(b)).unwrap_or_default()).collect()
}

/// Refuses bodies and tools too far from the origin, and warns of those on the way there. Collective.
pub fn offset(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model) -> Result<()> {
    let part = &model.part;
    // The shortest edges, as negative numbers.
    let mut edges = vec![f64::NEG_INFINITY; model.bodies.len()];
    for solid in &part.solids {
        let edge = &mut edges[solid.body as usize];
        *edge = edge.max(-part.span(solid).0);
    }
    max(comm, &mut edges);
    for ((body, (low, high)), edge) in scene.bodies.iter().zip(boxes(comm, model)).zip(edges.iter().copied()) {
        let far = low.amax().max(high.amax());
        let ratio = far / -edge;
        if ratio <= APART || far <= (high - low).norm() {
            continue;
        }
        let what = format!(
            "body `{}` is {far:.3e} from the origin, {ratio:.1e} times its shortest edge ({:.3e}): coordinates are rounded \
             there, and strains below {:.0e} are lost",
            body.name.value,
            -edge,
            ROUNDED * ratio
        );
        let help = "move all bodies and tools of the scene towards the origin";
        if ratio > OFFSET {
            return Err(Error::input(&body.name.at, what, help));
        }
        model.warnings.push(format!("{what}; {help}"));
    }
    tool_offset(comm, scene, model, &edges)
}

/// Refuses tools that are too far from the origin, or too large, beside the shortest edges, as negative numbers, of the bodies
/// that they meet, and warns of those on the way there. Collective.
fn tool_offset(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model, edges: &[f64]) -> Result<()> {
    for (t, tool) in scene.tools.iter().enumerate() {
        // Points are taken to the tool's frame by the way that it has come until a step.
        let come = |way: Vec3, step: &Step| {
            let moves = step.moves.iter().filter(|motion| motion.target.value == tool.name.value);
            way + moves.map(|motion| motion.by).sum::<Vec3>()
        };
        let ways = scene.steps.iter().scan(Vec3::zeros(), |way, step| {
            let next = come(*way, step);
            Some(std::mem::replace(way, next))
        });
        let far = ways.map(|way| way.amax()).fold(model.masters.tools[t].surface.far(comm), f64::max);
        let meets = model.pairs.iter().filter(|pair| pair.master.tool() == Some(t)).map(|pair| pair.side.body);
        let Some(body) = meets.max_by(|a, b| edges[*a].total_cmp(&edges[*b])) else { continue };
        let ratio = far / -edges[body];
        if ratio <= TOOL_APART {
            continue;
        }
        let what = format!(
            "tool `{}` is {far:.3e} from the origin, in size, or on its way, {ratio:.1e} times the shortest edge of body `{}` ({:.3e}): \
             coordinates are rounded there, and gaps below {:.0e} are lost",
            tool.name.value,
            model.bodies[body].name,
            -edges[body],
            ROUNDED * far
        );
        let help = "move all bodies and tools of the scene towards the origin; what is nearly flat may be a `plane`, and a \
                    mesh end where nothing meets it";
        if ratio > TOOL_OFFSET {
            return Err(Error::input(&tool.name.at, what, help));
        }
        model.warnings.push(format!("{what}; {help}"));
    }
    Ok(())
}

/// Warns of stresses and stiffnesses that hint at mixed units.
pub fn stresses(scene: &Scene, model: &mut Model) {
    for Material { name, model: material, .. } in &scene.materials {
        let MaterialModel::Plastic { young, hardening, .. } = material else { continue };
        let name = &name.value;
        let strain = hardening.stress(0.0) / young;
        if !(YIELDS[0]..=YIELDS[1]).contains(&strain) {
            model.warnings.push(format!(
                "material `{name}` yields at a strain of {strain:.1e}: are its moduli and its yield stress in one unit?"
            ));
        }
    }
}

/// Refuses a floor of forces of which the tolerance lets through more than what counts for no force (`force_floor_share`).
pub fn floor(scene: &Scene, model: &Model) -> Result<()> {
    let Some(floor) = &scene.solver.force_floor else { return Ok(()) };
    let softest = model.sections.iter().map(|section| section.stiffness).fold(f64::INFINITY, f64::min);
    let most = model.controls.force_floor_share * softest * model.size / scene.solver.tolerance;
    if floor.value <= most {
        return Ok(());
    }
    let what = format!(
        "`force_floor` = {:.1e} lets residuals of {:.1e} through while bodies bear less: their stiffness times the size of an \
         element, at which strains are of the order of 1, is {:.1e}",
        floor.value,
        floor.value * scene.solver.tolerance,
        softest * model.size
    );
    Err(Error::input(&floor.at, what, format!("leave it out, or take {most:.0e} at most")))
}

/// Warns of sizes and distances that hint at mixed units. Collective.
pub fn sizes(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model, sights: &[Vec<Standing>]) {
    let boxes = boxes(comm, model);
    let diagonals: Vec<f64> = boxes.iter().map(|(low, high)| (high - low).norm()).collect();
    let mut told = Vec::new();
    let mut compare = |a: (String, f64), b: (String, f64)| {
        if a.1 > UNLIKE * b.1 || b.1 > UNLIKE * a.1 {
            told.push(format!("{} is {:.3e} long and {} {:.3e}: are they in one unit of length?", a.0, a.1, b.0, b.1));
        }
    };
    let named = |b: usize| (format!("body `{}`", model.bodies[b].name), diagonals[b]);
    (1..diagonals.len()).for_each(|b| compare(named(0), named(b)));
    for tool in &model.masters.tools {
        let Some((low, high)) = tool.surface.bounds(comm) else { continue };
        compare(named(0), (format!("tool `{}`", tool.name), (high - low).norm()));
    }
    for (pair, sights) in model.pairs.iter().zip(sights) {
        let mut least = [sights.iter().filter_map(Standing::gap).map(|g| -g.abs()).fold(f64::NEG_INFINITY, f64::max)];
        max(comm, &mut least);
        let largest = diagonals.iter().copied().fold(0.0, f64::max);
        if (-least[0]).is_finite() && -least[0] > FAR * largest {
            told.push(format!(
                "contact `{}`: the master is {:.3e} away, {:.0} times the size of the bodies: are they in one unit of \
                 length?",
                pair.name,
                -least[0],
                -least[0] / largest
            ));
        }
    }
    for step in &scene.steps {
        for motion in step.moves.iter().filter(|m| m.by.norm() > UNLIKE * diagonals.iter().sum::<f64>()) {
            let (target, by) = (&motion.target.value, motion.by.norm());
            told.push(format!(
                "step `{}` moves `{target}` by {by:.3e}, much more than the bodies are long",
                step.name.value
            ));
        }
    }
    model.warnings.extend(told);
}

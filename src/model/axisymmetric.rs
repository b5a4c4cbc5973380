//! What a scene of axisymmetric bodies can have: only what is alike all around the y axis.
//!
//! Bodies are layers between the same two z-planes, x >= 0; tools have a section drawn out along z, which stands for the ring that
//! it is turned to, and move along y alone, as rings do that do not get wider. A surface in space that is round about the y axis
//! is not taken for its section: the layer lies beside the plane z = 0, or on both sides of it.

use super::assemble::set_of;
use super::layers::alike;
use super::{Model, SymmetryPlane};
use crate::error::{Error, Faults, Location, Result};
use crate::mesh::Mesh;
use crate::partition::{GlobalFacet, GlobalMesh};
use crate::scene::{Body, Description, Formulation, Located, MaterialModel, Scene, Shape, Step, Sweep, Tool};
use crate::{AXIS_NAMES, Mat3, Vec3};

/// Cosine and sine of directions that count as at a right angle, and as parallel.
const TILT: f64 = 1e-6;

/// Puts nodes on the axis that are not off it but by rounding.
///
/// # Errors
/// Nodes beyond it.
pub(super) fn put_on_axis(mesh: &mut Mesh, at: &Location) -> Result<()> {
    const ROUNDING: f64 = 1e-9;
    let farthest = mesh.points.iter().map(|x| x[0].abs()).fold(0.0, f64::max);
    for (x, id) in mesh.points.iter_mut().zip(&mesh.point_ids) {
        if x[0].abs() <= ROUNDING * farthest {
            x[0] = 0.0;
        }
        if x[0] < 0.0 {
            let what = format!("node {id} is beyond the axis of revolution, at x = {:?}", x[0]);
            return Err(Error::input(at, what, "x is the distance from the y axis: mesh the half with x >= 0"));
        }
    }
    Ok(())
}

/// Whether the bodies of a scene are axisymmetric, which all are or none, and fit for it.
///
/// # Errors
/// What is not alike all around the axis, as far as scene and meshes tell.
pub(super) fn check(scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> Result<()> {
    let Some(one) = scene.bodies.iter().find(|body| body.is_axisymmetric()) else { return Ok(()) };
    let mut faults = Faults::default();
    for body in &scene.bodies {
        faults.note(&of_body(scene, one, body));
    }
    scene.tools.iter().for_each(|tool| faults.note(&of_tool(tool)));
    faults.note(&between_planes(scene, global));
    faults.note(&across(scene, names, global));
    faults.finish()
}

fn of_body(scene: &Scene, one: &Body, body: &Body) -> Result<()> {
    let name = &body.name.value;
    if !body.is_axisymmetric() {
        let what = format!("body `{name}` is not axisymmetric, but body `{}` is", one.name.value);
        return Err(Error::input(&body.name.at, what, "add `axisymmetric = true`: all bodies of a scene are, or none"));
    }
    if let Some(element) = body.element.as_ref().filter(|element| element.value == Formulation::Hex8Eas) {
        let what = format!("body `{name}`: enhanced strain is not for axisymmetric bodies");
        return Err(Error::input(
            &element.at,
            what,
            "take \"hex8\", \"hex8-fbar\" or \"hex8-sri\", or leave `element` out",
        ));
    }
    for material in body.sections() {
        let axes = match scene.material(&material.value) {
            Some(MaterialModel::Orthotropic(constants)) => constants.axes,
            Some(MaterialModel::Plastic { hill: Some(hill), .. }) => hill.axes,
            _ => continue,
        };
        if !has_axis_around(&axes) {
            let what = format!(
                "body `{name}` is axisymmetric, but no axis of its material `{}` runs around, along z",
                material.value
            );
            return Err(Error::input(
                &material.at,
                what,
                "turn its `x` and `y` into the plane, or one of them along z",
            ));
        }
    }
    Ok(())
}

fn has_axis_around(axes: &Mat3) -> bool {
    axes.row(2).iter().any(|z| 1.0 - z.abs() < TILT * TILT)
}

fn of_tool(tool: &Tool) -> Result<()> {
    let name = &tool.name.value;
    let refuse = |what: &str, help: &str| {
        let what = format!("tool `{name}` {what}, but the bodies are axisymmetric");
        Err(Error::input(&tool.smoothing.at, what, help))
    };
    const SECTION: &str = "give its section, drawn out along z, which is turned about y as the bodies are: a `plane`, a \
                           `cylinder`, a `profile` with `extrude`, or a mesh of them";
    if tool.smoothing.value.is_cad() {
        return refuse("is a CAD surface", SECTION);
    }
    if is_drawn_out(tool) { Ok(()) } else { refuse("is not drawn out along z", SECTION) }
}

/// Whether a tool with a closed form is alike all along z; meshes are looked at later, and of CAD nothing is known.
pub(super) fn is_drawn_out(tool: &Tool) -> bool {
    let shape = tool.shapes.iter().find(|shape| shape.description() == tool.smoothing.value);
    let along_z = |axis: &Vec3| axis.xy().norm() < TILT;
    match shape {
        None => matches!(tool.smoothing.value, Description::Mesh(_)),
        Some(Shape::Plane { normal, .. }) => normal.z.abs() < TILT,
        Some(Shape::Cylinder { axis, .. }) => along_z(axis),
        Some(Shape::Profile(profile)) => match profile.sweep {
            Sweep::Extrude { x, y, .. } => along_z(&x.cross(&y)),
            Sweep::Revolve { .. } => false,
        },
        Some(Shape::Cone { .. } | Shape::Sphere { .. } | Shape::Torus { .. }) => false,
    }
}

/// Layers between unlike planes would not meet.
fn between_planes(scene: &Scene, global: &GlobalMesh) -> Result<()> {
    let first = global.z_range(0);
    for (b, body) in scene.bodies.iter().enumerate().skip(1) {
        let own = global.z_range(b);
        if !alike(first, own) {
            let [[low, high], [from, to]] = [first, own];
            let what = format!(
                "bodies `{}` and `{}` are axisymmetric, but lie between unlike z-planes: {low:?} and {high:?}, {from:?} and {to:?}",
                scene.bodies[0].name.value, body.name.value
            );
            return Err(Error::input(
                &body.name.at,
                what,
                "mesh all of them between the same two; the width does not count",
            ));
        }
    }
    Ok(())
}

/// Faces within the z-planes are none of the body: it goes on there.
fn across(scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> Result<()> {
    let of_contacts = scene.contacts.iter().flat_map(|contact| [&contact.slave, &contact.master]);
    let of_ties = scene.ties.iter().flat_map(|tie| [&tie.slave, &tie.master]);
    let of_steps = scene.steps.iter().flat_map(|step| step.pressures.iter().map(|pressure| &pressure.set));
    let ends = |fold: fn(f64, f64) -> f64, from: f64| global.points.iter().map(|x| x.z).fold(from, fold);
    let width = ends(f64::max, f64::NEG_INFINITY) - ends(f64::min, f64::INFINITY);
    Faults::all(of_contacts.chain(of_ties).chain(of_steps).map(|name: &Located<String>| {
        let set = set_of(names, global, &name.value);
        let is_across = |facet: &&GlobalFacet| {
            let z = facet.nodes[..facet.count as usize].iter().map(|&n| global.points[n as usize].z);
            let (low, high) = z.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
            high - low < 0.5 * width
        };
        match set.and_then(|set| set.facets.iter().find(is_across)) {
            Some(_) => {
                let what =
                    format!("`{}` has faces within a z-plane, where an axisymmetric body has no surface", name.value);
                Err(Error::input(&name.at, what, "name faces that stand upright on the plane of the section"))
            }
            None => Ok(()),
        }
    }))
    .map(|_: Vec<()>| ())
}

/// The planes of symmetry of axisymmetric bodies are orthogonal to the axis, or nothing but the axis.
pub(super) fn check_planes(scene: &Scene, planes: &[SymmetryPlane]) -> Result<()> {
    if !scene.is_axisymmetric() {
        return Ok(());
    }
    Faults::all(planes.iter().map(|plane| {
        let is_axis = plane.normal.x.abs() == 1.0 && plane.at == 0.0;
        if is_axis || plane.normal.y.abs() == 1.0 {
            return Ok(());
        }
        let what = format!("`{}` lies in no plane that an axisymmetric body can be mirrored across", plane.set.value);
        Err(Error::input(
            &plane.set.at,
            what,
            "only planes orthogonal to the y axis are such; on the axis nothing need be said",
        ))
    }))
    .map(|_: Vec<()>| ())
}

/// Steps drive tools along the axis, and load bodies alike all around it.
///
/// # Errors
/// What else a step does.
pub fn check_step(model: &Model, step: &Step) -> Result<()> {
    if !model.is_axisymmetric() {
        return Ok(());
    }
    let is_tool = |name: &str| model.tool_named(name).is_some();
    let mut faults = Faults::default();
    let mut refuse = |at: &Location, what: String, help: &str| faults.note(&Err::<(), _>(Error::input(at, what, help)));
    const TOOLS: &str =
        "a tool of axisymmetric bodies is a ring, which neither gets wider nor turns: let it move along y";
    for motion in step.moves.iter().filter(|motion| is_tool(&motion.target.value)) {
        let name = &motion.target.value;
        if let Some(d) = [0, 2].into_iter().find(|d| motion.by[*d] != 0.0) {
            refuse(&motion.target.at, format!("tool `{name}` moves along {}", AXIS_NAMES[d]), TOOLS);
        }
        if motion.rotate.is_some() {
            refuse(&motion.target.at, format!("tool `{name}` rotates"), TOOLS);
        }
    }
    for torque in &step.torques {
        refuse(&torque.tool.at, format!("a torque acts on tool `{}`", torque.tool.value), TOOLS);
    }
    for force in &step.forces {
        let name = &force.target.value;
        let free = if is_tool(name) { force.directions } else { [false; 3] };
        if let Some(d) = [0, 2].into_iter().find(|d| free[*d]) {
            refuse(&force.target.at, format!("a force moves tool `{name}` along {}", AXIS_NAMES[d]), TOOLS);
        } else if force.total.z != 0.0 {
            let what = format!("a force acts on `{name}` along z, around the axis");
            refuse(&force.target.at, what, "axisymmetric bodies do not turn: leave its third component 0");
        }
    }
    for force in step.body_forces.iter().filter(|force| force.per_volume.z != 0.0) {
        let what = format!("a force per volume acts on `{}` along z, around the axis", force.body.value);
        refuse(&force.body.at, what, "axisymmetric bodies do not turn: leave its third component 0");
    }
    let across = |a: &Vec3| a.x != 0.0 || a.z != 0.0;
    if let Some(gravity) = step.gravity.as_ref().filter(|gravity| across(&gravity.value.acceleration)) {
        let help = "the weight of axisymmetric bodies is along their axis, y";
        refuse(&gravity.at, "gravity acts across the axis of revolution".into(), help);
    }
    step.spins.iter().filter_map(|spin| spin.across(1, true)).for_each(|error| faults.note(&Err::<(), _>(error)));
    faults.finish()
}

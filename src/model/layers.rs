//! What bodies of one layer, in plane strain or axisymmetric, meet: they stand for bodies that go on alike along z or around the
//! axis, and meet others with the nodes of one of their two planes. So what they meet must be alike from one plane to the other:
//! tools drawn out along z over the whole layer, whatever they are beyond it, and layers between the same two planes.

use super::Model;
use super::assemble::set_of;
use crate::error::{Error, Faults, Result};
use crate::mortar::Corners;
use crate::parallel::max;
use crate::partition::{ALIKE, Component, GlobalMesh};
use crate::scene::{Located, Reduction, Scene, body_of};
use mpi::topology::SimpleCommunicator;

/// How far a tool may be from the same all along z, over the longest edge of the layer's side, across z or along: a tenth of what
/// the watch takes for a penetration.
const LIKE: f64 = 1e-3;
/// Whether two layers lie between the same planes z.
pub(super) fn alike([low, high]: [f64; 2], [from, to]: [f64; 2]) -> bool {
    (from - low).abs().max((to - high).abs()) <= ALIKE * (high - low)
}

/// What the body of a set stands for, if that is a layer.
pub(super) fn reduction(scene: &Scene, set: &str) -> Option<Reduction> {
    let body = scene.bodies.iter().find(|body| body.name.value == body_of(set))?;
    body.reduction.as_ref().map(|asked| asked.value)
}

fn is_layer(scene: &Scene, set: &str) -> bool {
    reduction(scene, set).is_some()
}

/// # Errors
/// Bodies in contact of which one is no layer, or that lie between other planes; parts of one that do.
pub(super) fn check(scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> Result<()> {
    check_parts(scene, global)?;
    let planes = |name: &str| {
        let z =
            set_of(names, global, name).into_iter().flat_map(|set| &set.nodes).map(|&n| global.points[n as usize].z);
        z.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)])
    };
    let bodies = scene.contacts.iter().filter(|contact| contact.surface.is_some());
    Faults::all(bodies.map(|contact| {
        let sides = [&contact.slave.value, &contact.master.value];
        let refuse = |what: String, help: &str| {
            Err(Error::input(&contact.name.at, format!("contact `{}`: {what}", contact.name.value), help))
        };
        match sides.map(|side| is_layer(scene, side)) {
            [false, false] => return Ok(()),
            [true, true] => {}
            [slave, _] => {
                let [layer, other] = if slave { sides } else { [sides[1], sides[0]] };
                let what = format!("`{layer}` is of a body in plane strain, and `{other}` is not");
                let help = "set `plane_strain` for both bodies, or leave it out in both and hold u_z in the steps";
                return refuse(what, help);
            }
        }
        let [slave, master] = sides.map(|side| planes(side));
        if !alike(slave, master) {
            let [[low, high], [from, to]] = [slave, master];
            let what = format!(
                "`{}` lies between z = {low:?} and {high:?}, `{}` between {from:?} and {to:?}, but their bodies are one layer of \
                 elements each",
                sides[0], sides[1]
            );
            return refuse(what, "mesh both bodies between the same two z-planes");
        }
        Ok(())
    }))
    .map(|_: Vec<()>| ())
}

/// # Errors
/// A body of one layer with parts that share no nodes, and of which one lies between other planes than the rest.
fn check_parts(scene: &Scene, global: &GlobalMesh) -> Result<()> {
    let layers = scene.bodies.iter().enumerate().filter(|(_, body)| body.reduction.is_some());
    Faults::all(layers.map(|(b, body)| {
        let planes = global.z_range(b);
        let of_part = |part: &Component| [part.bounds.0.z, part.bounds.1.z];
        let is_unlike = |part: &&Component| part.body as usize == b && !alike(planes, of_part(part));
        let Some(part) = global.components.iter().find(is_unlike) else { return Ok(()) };
        let ([low, high], [from, to]) = (planes, of_part(part));
        let what = format!(
            "body `{}` lies between z = {low:?} and {high:?}, but its part with node {} between {from:?} and {to:?}: they are \
             one layer of elements",
            body.name.value, part.node
        );
        Err(Error::input(&body.name.at, what, "mesh all parts between the same two z-planes, or make them bodies of their own"))
    }))
    .map(|_: Vec<()>| ())
}

/// Leaves out what tools that meet nothing but layers have beyond these, and refuses those that are not drawn out along z over
/// them. Collective.
pub(super) fn check_tools(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model) -> Result<()> {
    let mut faults = Faults::default();
    for (t, tool) in scene.tools.iter().enumerate() {
        let of_tool = || scene.contacts.iter().filter(|contact| contact.master.value == tool.name.value);
        let slaves: Vec<&str> =
            of_tool().map(|contact| contact.slave.value.as_str()).filter(|slave| is_layer(scene, slave)).collect();
        let layers: Vec<Layer> = slaves.iter().map(|slave| Layer::of(comm, model, slave)).collect();
        let ends = |[low, high]: [f64; 2], [from, to]: [f64; 2]| [low.min(from), high.max(to)];
        let planes = layers.iter().map(|layer| layer.planes).reduce(ends);
        let surface = &mut model.masters.tools[t].surface;
        if let Some(planes) = planes.filter(|_| slaves.len() == of_tool().count()) {
            surface.keep_between(planes);
        }
        for (slave, Layer { planes, facet }) in slaves.into_iter().zip(layers) {
            let [low, high] = planes;
            let slack = LIKE * facet.max(high - low);
            let Some(unlike) = surface.unlike_along_z(comm, planes, slack) else { continue };
            let what = format!(
                "tool `{}` is not drawn out along z over `{slave}`, from z = {low:?} to {high:?}: {unlike}",
                tool.name.value
            );
            let help = match reduction(scene, slave) {
                Some(Reduction::Axisymmetric) => {
                    "the tool is a section drawn out along z over all of the layer; what it is beyond does not matter"
                }
                _ => {
                    "a body in plane strain goes on alike along z: draw the tool out over all of the layer, what it is beyond \
                     does not matter; or leave out `plane_strain`, and mesh the body in space"
                }
            };
            faults.note(&Err::<(), _>(Error::input(&tool.smoothing.at, what, help)));
            break;
        }
    }
    faults.finish()
}

/// A side of a layer.
struct Layer {
    /// Between which z it lies.
    planes: [f64; 2],
    /// Its longest edge across z.
    facet: f64,
}

impl Layer {
    /// Of a set, on all ranks. Collective.
    fn of(comm: &SimpleCommunicator, model: &Model, set: &str) -> Self {
        let set = model.set(set);
        let mut ends = [f64::NEG_INFINITY, f64::NEG_INFINITY, 0.0];
        for z in set.nodes.iter().map(|&n| model.part.points[n as usize].z) {
            ends = [ends[0].max(-z), ends[1].max(z), 0.0];
        }
        for facet in &set.facets {
            let places = Corners::new(&facet.nodes[..facet.count as usize]).map(|n| model.part.points[n as usize]);
            ends[2] = places.edges().map(|edge| edge.xy().norm()).fold(ends[2], f64::max);
        }
        max(comm, &mut ends);
        Self { planes: [-ends[0], ends[1]], facet: ends[2] }
    }
}

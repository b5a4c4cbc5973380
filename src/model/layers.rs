//! What bodies of one layer, in plane strain or axisymmetric, meet: they stand for bodies that go on alike along z or around the
//! axis, and meet others with the nodes of one of their two planes. So what they meet must be alike from one plane to the other:
//! tools drawn out along z over the whole layer, whatever they are beyond it, and layers between the same two planes.

use super::Model;
use super::assemble::set_of;
use crate::error::{Error, Faults, Result};
use crate::parallel::max;
use crate::partition::GlobalMesh;
use crate::scene::{Contact, Located, Reduction, Scene, body_of};
use mpi::topology::SimpleCommunicator;

/// Planes z that are closer than this part of a thickness are one.
const ALIKE: f64 = 1e-6;

fn reduction(scene: &Scene, set: &str) -> Option<Reduction> {
    let body = scene.bodies.iter().find(|body| body.name.value == body_of(set))?;
    body.reduction.as_ref().map(|asked| asked.value)
}

fn is_layer(scene: &Scene, set: &str) -> bool {
    reduction(scene, set).is_some()
}

/// # Errors
/// Bodies in contact of which one is no layer, or that lie between other planes.
pub(super) fn check(scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> Result<()> {
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
        let [[low, high], [from, to]] = sides.map(|side| planes(side));
        if (from - low).abs().max((to - high).abs()) > ALIKE * (high - low) {
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

/// Refuses tools that are not drawn out along z over the layers that they meet. Collective.
pub(super) fn check_tools(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model) -> Result<()> {
    let mut faults = Faults::default();
    for (t, tool) in scene.tools.iter().enumerate() {
        let meets =
            |contact: &&Contact| contact.master.value == tool.name.value && is_layer(scene, &contact.slave.value);
        for contact in scene.contacts.iter().filter(meets) {
            let slave = &contact.slave.value;
            let planes = planes(comm, model, slave);
            let Some(unlike) = model.masters.tools[t].surface.unlike_along_z(comm, planes) else { continue };
            let [low, high] = planes;
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

/// Between which z the nodes of a set lie, on all ranks. Collective.
fn planes(comm: &SimpleCommunicator, model: &Model, set: &str) -> [f64; 2] {
    let mut ends = [f64::NEG_INFINITY; 2];
    for z in model.set(set).nodes.iter().map(|&n| model.part.points[n as usize].z) {
        ends = [ends[0].max(-z), ends[1].max(z)];
    }
    max(comm, &mut ends);
    [-ends[0], ends[1]]
}

//! Elements that lock: too stiff where volume is nearly kept, in nearly incompressible materials and in plastic flow.

use crate::mesh::SolidShape;
use crate::model::Model;
use crate::parallel::max;
use crate::scene::{Element, Scene};
use mpi::topology::SimpleCommunicator;

/// Warns of bodies whose elements lock. Collective.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model) {
    let mut has_tets = vec![0.0; model.bodies.len()];
    model.part.solids.iter().filter(|s| s.shape == SolidShape::Tet4).for_each(|s| has_tets[s.body as usize] = 1.0);
    max(comm, &mut has_tets);
    for (b, body) in model.bodies.iter().enumerate() {
        let card = scene.materials.iter().find(|m| m.name.value == scene.bodies[b].material.value);
        let Some(reason) = card.and_then(|card| card.model.keeps_volume()) else { continue };
        if has_tets[b] > 0.0 {
            model.warnings.push(format!(
                "body `{}`: tetrahedra are too stiff for a material {reason}, and have no cure: mesh with hexahedra",
                body.name
            ));
        }
        if body.element == Element::Hex8 {
            model.warnings.push(format!(
                "body `{}`: `hex8` is too stiff for a material {reason}: leave `element` out, or take \"hex8-fbar\", \
                 \"hex8-sri\" or \"hex8-eas\"",
                body.name
            ));
        }
    }
}

//! Elements that do not suit their material: too stiff where volume is nearly kept, in nearly incompressible materials and in
//! plastic flow; or with enhanced strain that buckles.

use crate::error::{Error, Result};
use crate::mesh::SolidShape;
use crate::model::Model;
use crate::parallel::max;
use crate::scene::{Formulation, MaterialModel, Scene};
use mpi::topology::SimpleCommunicator;

/// Poisson's ratio below which the enhanced strain of compressed elements buckles. Under a sphere that presses a block by a
/// twentieth the methods of contact find one solution to -0.9, different ones from -0.95 on.
const AUXETIC: f64 = -0.9;

/// Warns of bodies whose elements lock. Collective.
///
/// # Errors
/// A body whose elements have no stable solution.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model) -> Result<()> {
    let mut has = vec![0.0; 2 * model.sections.len()];
    model.part.solids.iter().for_each(|s| has[2 * s.section as usize + usize::from(s.shape == SolidShape::Tet4)] = 1.0);
    max(comm, &mut has);
    for ((section, (b, material)), has) in model.sections.iter().zip(scene.sections()).zip(has.chunks_exact(2)) {
        let (body, card) = (&scene.bodies[b], scene.material(&material.value));
        let elastic = card.filter(|model| !matches!(model, MaterialModel::Plastic { .. }));
        let poisson = elastic.map_or(0.0, MaterialModel::poisson);
        if let Some(asked) =
            body.element.as_ref().filter(|_| section.element == Formulation::Hex8Eas && poisson < AUXETIC)
        {
            let what = format!(
                "body `{}`: elements with enhanced strain buckle in a material with Poisson's ratio {poisson}",
                body.name.value
            );
            return Err(Error::input(&asked.at, what, "leave `element` out: such materials do not lock"));
        }
        let Some(reason) = card.and_then(MaterialModel::keeps_volume) else { continue };
        if has[1] > 0.0 {
            model.warnings.push(format!(
                "body `{}`: tetrahedra are too stiff for a material {reason}, and have no cure: mesh with hexahedra",
                body.name.value
            ));
        }
        if has[0] > 0.0 && section.element == Formulation::Hex8 {
            model.warnings.push(format!(
                "body `{}`: `hex8` is too stiff for a material {reason}: leave `element` out, or take \"hex8-fbar\", \
                 \"hex8-sri\" or \"hex8-eas\"",
                body.name.value
            ));
        }
    }
    Ok(())
}

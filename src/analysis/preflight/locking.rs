//! Elements that do not suit their material: too stiff where volume is nearly kept, in nearly incompressible materials and in
//! plastic flow; or with enhanced strain that buckles.

use crate::error::{Error, Result};
use crate::mesh::SolidShape;
use crate::model::Model;
use crate::parallel::{max, sum};
use crate::scene::{AUXETIC, Formulation, MaterialModel, Scene};
use mpi::topology::SimpleCommunicator;

/// Share of the elements of a section that may be wedges and pyramids where volume is nearly kept (docs/validation/elements.md).
const MANY: f64 = 0.3;

/// The share of these among the elements of each section. Collective.
fn shares_of_fillers(comm: &SimpleCommunicator, model: &Model) -> Vec<f64> {
    let mut counts = vec![[0.0; 2]; model.sections.len()];
    for solid in model.part.solids.iter().filter(|solid| solid.mine) {
        let [all, fillers] = &mut counts[solid.section as usize];
        *all += 1.0;
        *fillers += f64::from(matches!(solid.shape, SolidShape::Wedge6 | SolidShape::Pyramid5));
    }
    sum(comm, counts.as_flattened_mut());
    counts.iter().map(|[all, fillers]| fillers / all.max(1.0)).collect()
}

/// Warns of bodies whose elements lock. Collective.
///
/// # Errors
/// A body whose elements have no stable solution.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &mut Model) -> Result<()> {
    let mut has = vec![0.0; model.sections.len()];
    let linear = model.part.solids.iter().filter(|solid| solid.shape == SolidShape::Tet4);
    linear.for_each(|solid| has[solid.section as usize] = 1.0);
    max(comm, &mut has);
    let fillers = shares_of_fillers(comm, model);
    for (((section, (b, material)), has_tets), fillers) in
        model.sections.iter().zip(scene.sections()).zip(has).zip(fillers)
    {
        let (body, card) = (&scene.bodies[b], scene.material(&material.value));
        let elastic = card.filter(|model| !matches!(model, MaterialModel::Plastic { .. }));
        let poisson = elastic.map_or(0.0, MaterialModel::poisson);
        if let Some(asked) = body.element.as_ref().filter(|_| section.element.is_enhanced() && poisson < AUXETIC) {
            let what = format!(
                "body `{}`: elements with enhanced strain buckle in a material with Poisson's ratio {poisson}",
                body.name.value
            );
            return Err(Error::input(&asked.at, what, "leave `element` out: such materials do not lock"));
        }
        let directed = matches!(card, Some(MaterialModel::Orthotropic(_)));
        if let Some(asked) = body.element.as_ref().filter(|_| section.element == Formulation::Hex8Eas && directed) {
            let what = format!(
                "body `{}`: enhanced strain may have no solution in a material that is much stiffer along one axis",
                body.name.value
            );
            return Err(Error::input(&asked.at, what, "take \"hex8\", \"hex8-sri\" or \"hex8-fbar\""));
        }
        let Some(reason) = card.and_then(MaterialModel::keeps_volume) else { continue };
        let name = &body.name.value;
        if has_tets > 0.0 {
            model.warnings.push(format!(
                "body `{name}`: linear tetrahedra are too stiff for a material {reason}, and have no cure: mesh with \
                 hexahedra, or with tetrahedra of second order"
            ));
        }
        if fillers > MANY {
            model.warnings.push(format!(
                "body `{name}`: {:.0} % of its elements are wedges or pyramids, which are too stiff for a material {reason} where there are \
                 few hexahedra between them: recombine the surface that is swept to quadrilaterals, and leave these where it \
                 must be",
                100.0 * fillers
            ));
        }
        let cures = match section.element {
            Formulation::Hex8 => "\"hex8-fbar\", \"hex8-sri\" or \"hex8-eas\"",
            Formulation::Wedge6 => "\"wedge6-sri\"",
            Formulation::Wedge18 => "\"wedge18-sri\"",
            Formulation::Pyramid5 => "\"pyramid5-sri\"",
            Formulation::Tet10 => "\"tet10-sri\"",
            _ => continue,
        };
        model.warnings.push(format!(
            "body `{name}`: `{}` is too stiff for a material {reason}: leave `element` out, or take {cures}",
            section.element.key()
        ));
    }
    Ok(())
}

//! The last iterate of an increment that was not found: no result, but where to look for the reason.

use super::newton::Newton;
use crate::Vec3;
use crate::contact::{Pose, Trial};
use crate::model::Model;
use crate::system::dofs::NONE;

/// What is known of it on this rank.
#[derive(Clone, Debug)]
pub(super) struct LastIterate {
    /// Time at the end of the increment.
    pub time: f64,
    /// Displacements of all local nodes.
    pub u: Vec<Vec3>,
    /// Forces out of balance on owned nodes, N: along what is free.
    pub residual: Vec<Vec3>,
    pub poses: Vec<Pose>,
    /// Of the slave nodes of each pair.
    pub trials: Vec<Vec<Trial>>,
}

impl LastIterate {
    /// That of a Newton iteration which has ended; its time is not known here.
    pub fn of(newton: &Newton) -> Self {
        let (model, dofs) = (&*newton.system.model, &*newton.system.dofs);
        let residual = |n: usize| {
            let mut force = newton.found.forces[n] + newton.footing_force(n as u32);
            force = dofs.axes.inward(n, &force);
            (0..3).filter(|&d| dofs.node[n][d] == NONE).for_each(|d| force[d] = 0.0);
            dofs.axes.outward(n, &force)
        };
        let residuals: Vec<Vec3> = (0..model.part.owned).map(residual).collect();
        Self::at(model, newton.found.u.clone(), model.part.evened(&residuals, &newton.system.conditions.supported))
    }

    /// One that is in balance, but is not accepted.
    pub fn refused(model: &Model, u: Vec<Vec3>) -> Self {
        Self::at(model, u, vec![Vec3::zeros(); model.part.owned])
    }

    fn at(model: &Model, u: Vec<Vec3>, residual: Vec<Vec3>) -> Self {
        Self {
            time: 0.0,
            u,
            residual,
            poses: model.masters.tools.iter().map(|tool| tool.trial).collect(),
            trials: model.pairs.iter().map(|pair| pair.slaves.iter().map(|slave| slave.trial).collect()).collect(),
        }
    }
}

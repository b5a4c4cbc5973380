//! Two contacts of the same faces with exchanged roles. Each makes its own conditions of the same gap, and forces between
//! them are not determined; with two passes, one contact knows of both sides.

use crate::error::{Error, Result};
use crate::model::Model;
use crate::parallel::any;
use crate::scene::Scene;
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeSet;

/// Refuses contacts that are another one the other way round. Collective.
pub fn check(comm: &SimpleCommunicator, scene: &Scene, model: &Model) -> Result<()> {
    let facets = |set: &str| -> BTreeSet<Vec<u32>> {
        let sorted = |nodes: &[u32]| {
            let mut nodes = nodes.to_vec();
            nodes.sort_unstable();
            nodes
        };
        model.set(set).facets.iter().map(|f| sorted(&f.nodes[..f.count as usize])).collect()
    };
    let contacts: Vec<_> = scene.contacts.iter().filter(|c| c.surface.is_some() && !c.is_self()).collect();
    let sides: Vec<_> = contacts.iter().map(|c| [facets(&c.slave.value), facets(&c.master.value)]).collect();
    for (k, second) in contacts.iter().enumerate() {
        for (first, [slave, master]) in contacts.iter().zip(&sides[..k]) {
            if !any(comm, *slave != sides[k][1] || *master != sides[k][0]) {
                let (name, other) = (&second.name.value, &first.name.value);
                let what = format!(
                    "contact `{name}` is contact `{other}` the other way round: both keep the same faces apart, and how they \
                     share the force is not determined"
                );
                let help = "remove one, and give the other discretization = \"two-pass\"";
                return Err(Error::input(&second.slave.at, what, help));
            }
        }
    }
    Ok(())
}

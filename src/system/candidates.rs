//! Which patches of a deformable master a slave node may meet before long: what the sparsity pattern provides for.
//!
//! Candidates are the patches whose boxes come within a facet, of the finer side, of the slave node, or within the
//! reach of the search where facets are longer than that; the one it touches; and the one that has its slip origin. For
//! a node that slides they lie ahead: within half a facet of its way over the next two increments, one and a half
//! facets at least and four at most, so that their number does not grow with the fineness of the master. In
//! self-contact those around the node are none, nor those that look the same way. The matrix couples the node, its
//! multiplier and the stencil of each candidate; with friction the stencils of any two, since the node may be on one
//! and have its slip origin on the other; without, the stencils of those that it is exactly between.

use super::dofs::{DofMap, NONE};
use super::masters::equations;
use crate::Vec3;
use crate::contact::segment::Face;
use crate::contact::{Masters, Pair, Slave, Status};
use crate::partition::Bounds;
use crate::partition::parcels::{bounds, grown};
use mpi::topology::SimpleCommunicator;

/// The candidates of all slave nodes of this rank.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// For each pair and slave node the ids of its candidates, ascending.
    ids: Vec<Vec<Vec<u32>>>,
    /// For each pair those that are coupled with each other, where it is not all of them.
    between: Vec<Option<Vec<Vec<u32>>>>,
}

impl Candidates {
    /// Looks around each slave node, which `place` puts in space, on the surfaces as they are.
    pub fn new(pairs: &[Pair], masters: &Masters, place: impl Fn(u32) -> Vec3) -> Self {
        let of_pair = |pair: &Pair| match pair.master.surface() {
            None => vec![Vec::new(); pair.slaves.len()],
            Some(k) => {
                let surface = &masters.surfaces[k];
                let shapes = surface.shapes();
                let facet = pair.facet_size.min(surface.facet_size).min(pair.reach);
                let near = |(s, slave): (usize, &Slave)| {
                    if let Some(mate) = &slave.mate {
                        return vec![mate.patch];
                    }
                    let (low, high) = match &pair.faces {
                        None => {
                            let (x, (low, high)) = (place(slave.node), ahead(slave, facet));
                            (x + low, x + high)
                        }
                        Some(faces) => around(faces.around(s), facet, &place),
                    };
                    let found = shapes.within(&low, &high);
                    let found = found.iter().map(|&k| &shapes.pieces()[k as usize]);
                    let mut ids: Vec<u32> = found.filter(|patch| pair.may_meet(s, patch)).map(|p| p.id).collect();
                    let touching = slave.trial.projection.filter(|_| slave.trial.status != Status::Gap);
                    ids.extend(touching.map(|p| p.patch));
                    ids.extend(&slave.met);
                    if !ids.is_empty() && pair.rules.friction > 0.0 {
                        ids.extend(slave.committed.origins().map(|at| at.patch));
                    }
                    ids.sort_unstable();
                    ids.dedup();
                    ids
                };
                pair.slaves.iter().enumerate().map(near).collect()
            }
        };
        let all = |pair: &Pair| pair.rules.friction > 0.0 || pair.faces.is_some() || pair.master.tool().is_some();
        let between = |pair: &Pair| (!all(pair)).then(|| pair.slaves.iter().map(|slave| slave.met.clone()).collect());
        Self { ids: pairs.iter().map(of_pair).collect(), between: pairs.iter().map(between).collect() }
    }

    /// The candidates of a slave node that are coupled with each other.
    fn together(&self, pair: usize, slave: usize) -> &[u32] {
        self.between[pair].as_ref().map_or(&self.ids[pair][slave], |between| &between[slave])
    }

    /// Whether a slave node was expected on these patches at once.
    pub fn has(&self, pair: usize, slave: usize, patches: &[u32]) -> bool {
        let ids = if patches.len() < 2 { &self.ids[pair][slave] } else { self.together(pair, slave) };
        patches.iter().all(|patch| ids.binary_search(patch).is_ok())
    }

    /// Groups of equations that are coupled with each other.
    /// A force-driven tool is coupled with every slave node of its pairs that is near. Collective.
    pub fn groups(&self, comm: &SimpleCommunicator, pairs: &[Pair], masters: &Masters, dofs: &DofMap) -> Vec<Vec<i64>> {
        let mut groups = Vec::new();
        for (p, (pair, of_pair)) in pairs.iter().zip(&self.ids).enumerate() {
            let ground = masters.of(pair.master);
            let of_master = equations(comm, masters, pair.master, dofs);
            let is_tool = pair.master.tool().is_some();
            for (s, (slave, ids)) in pair.slaves.iter().zip(of_pair).enumerate().filter(|(s, _)| dofs.near[p][*s]) {
                let own = dofs.node[slave.node as usize].iter().chain(&dofs.multiplier[p][s]);
                let beside = pair.faces.iter().flat_map(|faces| faces.beside(s)).flat_map(|n| dofs.node[n as usize]);
                let mut own: Vec<i64> = own.copied().chain(beside).filter(|&e| e != NONE).collect();
                own.sort_unstable();
                own.dedup();
                let of_patch = |id: &u32| {
                    let stencil = ground.patch(*id).map_or(&[][..], |(_, stencil)| stencil);
                    stencil.iter().flat_map(|&n| of_master[n as usize]).filter(|&e| e != NONE)
                };
                let of_tool = || of_master.iter().flatten().copied().filter(|&e| e != NONE);
                if is_tool && of_tool().next().is_some() {
                    groups.push(own.iter().copied().chain(of_tool()).collect());
                }
                if pair.faces.is_some() && ids.is_empty() {
                    groups.push(own.clone());
                }
                let together = self.together(p, s);
                let alone = ids.iter().filter(|id| together.binary_search(id).is_err()).map(std::slice::from_ref);
                for ids in alone.chain((!together.is_empty()).then_some(together)) {
                    let mut group: Vec<i64> = ids.iter().flat_map(of_patch).chain(own.iter().copied()).collect();
                    group.sort_unstable();
                    group.dedup();
                    groups.push(group);
                }
            }
        }
        groups
    }
}

/// Box in which the candidates of a slave node with these faces lie.
fn around<'a>(faces: impl Iterator<Item = &'a Face>, facet: f64, place: impl Fn(u32) -> Vec3) -> Bounds {
    const BESIDE: f64 = 0.5;
    let corners = faces.flat_map(|face| face.corners.all()).map(|&n| place(n));
    let all = bounds(corners).unwrap_or((Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)));
    grown(all, BESIDE * facet)
}

/// Box, relative to the slave node, in which its candidates lie.
fn ahead(slave: &Slave, facet: f64) -> Bounds {
    const WAY: [f64; 2] = [1.5, 4.0];
    let (slip, length) = (slave.trial.slip, slave.trial.slip.norm());
    if slave.trial.status != Status::Slip || length < 1e-3 * facet {
        return grown((Vec3::zeros(), Vec3::zeros()), facet);
    }
    let way = slip * ((2.0 * length).clamp(WAY[0] * facet, WAY[1] * facet) / length);
    grown((way.inf(&Vec3::zeros()), way.sup(&Vec3::zeros())), 0.5 * facet)
}

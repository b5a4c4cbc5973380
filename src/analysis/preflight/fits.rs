//! Fits whose overlap is hardly more than what their faces lack of the arcs that they stand for.
//!
//! From segment to segment the gap of a slave node is the mean of those in the points of the faces around it. Where a shaft begins in its
//! bore with some interference, every node has that, and the mean differs from it by how far the faces between the nodes are off the
//! arc: a parabola over 45 degrees by 7e-4 of the radius. The forces of the fit differ by about as much. In one pass nodes count, and
//! the master's faces under them.

use super::sight::Standing;
use crate::contact::{Faces, Segments};
use crate::model::Model;
use crate::parallel::sum;
use crate::surface::Projection;
use mpi::topology::SimpleCommunicator;

/// Part of the overlap of the nodes by which the mean may differ without a word; a coarse ball that begins in a plane has less.
const OFF: f64 = 0.1;

/// Warns of them, of what begins deeper than `touching_gap` in the mean. Collective.
pub fn check(comm: &SimpleCommunicator, model: &mut Model, sights: &[Vec<Standing>]) {
    let mut warnings = Vec::new();
    for (pair, sights) in model.pairs.iter().zip(sights) {
        let contacts = sights.iter().enumerate().filter_map(|(s, sight)| Some((s, sight.contact?)));
        let inside: Vec<(usize, Projection)> = contacts.filter(|(_, at)| at.gap < 0.0).collect();
        let ground = model.masters.of(pair.master);
        let place = |n: u32| model.part.points[n as usize];
        let find = |faces: &Faces| Segments::find(pair, &ground, || faces.as_meshed(), place, None, None);
        let segments = pair.faces.as_ref().filter(|_| !inside.is_empty()).map(find).unwrap_or_default();
        let off = |(s, own): &(usize, Projection)| match pair.faces {
            None => Some(ground.off_arc(own)),
            Some(_) => segments.meet(pair, *s, Some(own)).map(|(mean, _)| (mean.gap - own.gap).abs()),
        };
        let mut sums = [0.0; 3];
        for (own, off) in inside.iter().filter_map(|of| Some((of.1, off(of)?))) {
            sums.iter_mut().zip([1.0, -own.gap, off]).for_each(|(sum, of_node)| *sum += of_node);
        }
        sum(comm, &mut sums);
        let [count, overlap, off] = sums;
        if overlap > pair.controls.touching_gap * pair.facet_size * count && off > OFF * overlap {
            let mean = off / count;
            let (faces, remedy) = match pair.faces {
                None => (
                    format!("which is {mean:.3e} off the arcs that its faces stand for"),
                    "refine it, or make the finer side the master",
                ),
                Some(_) => (
                    format!("and the faces between them {mean:.3e} more or less"),
                    "refine both sides, or take `discretization = \"one-pass\"`, which counts at nodes, where the master is the \
                     finer side or a tool",
                ),
            };
            warnings.push(format!(
                "contact `{}`: {count} slave nodes begin {:.3e} inside {} in the mean, {faces}: they are too coarse for so small an overlap, \
                 and the forces of the fit may be off by as much; {remedy}",
                pair.name,
                overlap / count,
                model.master_name(pair)
            ));
        }
    }
    model.warnings.extend(warnings);
}

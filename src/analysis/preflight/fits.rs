//! Fits whose overlap is hardly more than what their faces lack of the arcs that they stand for.
//!
//! From segment to segment the gap of a slave node is the mean of those in the points of the faces around it. Where a shaft begins in its
//! bore with some interference, every node has that, and the mean differs from it by how far the faces between the nodes are off the
//! arc: a parabola over 45 degrees by 7e-4 of the radius. The forces of the fit differ by about as much.

use super::sight::Standing;
use crate::contact::Segments;
use crate::model::Model;
use crate::parallel::sum;
use crate::surface::Projection;
use mpi::topology::SimpleCommunicator;

/// Part of the overlap of the nodes by which the mean may differ without a word; a coarse ball that begins in a plane has less.
const OFF: f64 = 0.1;

/// Warns of them, of what begins deeper than `touching_gap` in the mean. Collective.
pub fn check(comm: &SimpleCommunicator, model: &mut Model, sights: &[Vec<Standing>]) {
    let mut warnings = Vec::new();
    for (pair, sights) in model.pairs.iter().zip(sights).filter(|(pair, _)| pair.faces.is_some()) {
        let contacts = sights.iter().enumerate().filter_map(|(s, sight)| Some((s, sight.contact?)));
        let inside: Vec<(usize, Projection)> = contacts.filter(|(_, at)| at.gap < 0.0).collect();
        let find = || {
            let ground = model.masters.of(pair.master);
            Segments::find(pair, &ground, |n| model.part.points[n as usize], None, None)
        };
        let segments = if inside.is_empty() { Segments::default() } else { find() };
        let mut sums = [0.0; 3];
        for (own, mean) in inside.iter().filter_map(|(s, own)| Some((own, segments.meet(pair, *s, Some(own))?.0))) {
            let of_node = [1.0, -own.gap, (mean.gap - own.gap).abs()];
            sums.iter_mut().zip(of_node).for_each(|(sum, of_node)| *sum += of_node);
        }
        sum(comm, &mut sums);
        let [count, overlap, off] = sums;
        if overlap > pair.controls.touching_gap * pair.facet_size * count && off > OFF * overlap {
            warnings.push(format!(
                "contact `{}`: {count} slave nodes begin {:.3e} inside {} in the mean, and the faces between them {:.3e} more or less: \
                 they are too coarse for so small an overlap, and the forces of the fit may be off by as much; refine both \
                 sides, or take `discretization = \"one-pass\"`, which counts at nodes, where the master is the finer side or a \
                 tool",
                pair.name,
                overlap / count,
                model.master_name(pair),
                off / count
            ));
        }
    }
    model.warnings.extend(warnings);
}

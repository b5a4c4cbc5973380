//! Where tools end, as a face of the slave sees it: past an end nothing is opposite to it, and the wall below a sharp edge is beside it,
//! however near.
//!
//! A wall and the flank of a wedge look the same from a point. What tells them apart is the other side of the edge: over that of a
//! wall the tool looks at the face, and over that of a wedge it looks away. Fillets have no such edge: what is on them or below
//! counts, with the gap that it has, so that no weight comes or goes with a gap that is not zero.

use crate::Vec3;
use crate::contact::{Pair, Tool};
use crate::surface::Projection;

/// Cosine of the angle between a direction and a normal up to which they are straight on each other.
pub const STRAIGHT: f64 = 0.5;

/// Whether a point of the master is on a side that looks at a slave face.
pub fn looks_back(at: &Projection, outward: &Vec3) -> bool {
    outward.dot(&at.normal) < 0.0
}

fn is_straight(at: &Projection, outward: &Vec3) -> bool {
    -outward.dot(&at.normal) >= STRAIGHT
}

/// Where a point of a slave face at `x`, which looks along `outward`, has the tool ahead, `found` to be the closest to it: nothing
/// past an end, beside a wall, or that looks away; but a point that has come in past the wall's edge has the other side of that
/// ahead.
pub fn ahead(tool: &Tool, pair: &Pair, x: &Vec3, found: Projection, outward: &Vec3) -> Option<Projection> {
    let aside = pair.sides().aside;
    let is_past = tool.is_past_end(x, &found, aside);
    if !is_past && (is_straight(&found, outward) || !is_wall(tool, pair, &found, outward)) {
        return Some(found).filter(|found| looks_back(found, outward));
    }
    let feet = tool.perpendiculars(x, pair.reach, aside).into_iter();
    feet.filter(|at| is_straight(at, outward)).min_by(|a, b| a.gap.abs().total_cmp(&b.gap.abs()))
}

/// Whether a point of a tool, on a side that is askew to a slave face which looks along `outward`, is below a sharp edge, a facet away
/// at most, over which the tool looks at that face: as on the wall at the end of a table, and not on the flank of a wedge or of a
/// fillet.
fn is_wall(tool: &Tool, pair: &Pair, at: &Projection, outward: &Vec3) -> bool {
    /// Over a facet: so far below an edge both of its sides are looked for. A fillet with a smaller radius is none.
    const BELOW: f64 = 0.01;
    let above = at.point - outward * pair.facet_size;
    let Some(edge) = tool.project(&above, pair.reach, (None, false)) else { return false };
    let below = BELOW * pair.facet_size;
    let inside = edge.point + (outward - at.normal) * below;
    let sides = tool.perpendiculars(&inside, 2.0 * below, pair.sides().aside);
    let has = |is: &dyn Fn(&Projection) -> bool| sides.iter().any(|side| side.gap < 0.0 && is(side));
    // From above the edge the normal at the point is that of neither side.
    has(&|side| is_straight(side, outward))
        && has(&|side| !is_straight(side, outward) && side.normal.dot(&at.normal) >= STRAIGHT)
}

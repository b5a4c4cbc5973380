//! A start of the iteration that goes along with what is turned.
//!
//! Where some nodes are prescribed to turn, the first iteration moves what hangs on them along the tangent, and strains it by 1 - cos
//! of the angle. Five degrees make a metal yield, and from a tangent that has lost most of its stiffness Newton's method does not come
//! back to what is no strain at all. So each part of a body whose prescribed nodes move as one turns as they do, all of it.

use super::Newton;
use crate::parallel::sum;
use crate::{Mat3, Vec3};

/// Turns below this, radians, strain by less than 1e-6: nothing yields from that.
const TURNED: f64 = 1e-3;
/// What prescribed nodes may be off a motion as one, over their distances: rounding.
const AS_ONE: f64 = 1e-9;

/// A motion as one: x becomes `to` + `rotation` (x - `from`).
struct Carried {
    from: Vec3,
    to: Vec3,
    rotation: Mat3,
}

impl Newton<'_> {
    /// Starts from the last converged state with what turns carried along; as it is where nothing does. Collective.
    pub fn start_carried(&mut self, x: &mut [f64]) {
        self.start_behind(x);
        let motions = self.motions();
        if motions.iter().all(Option::is_none) {
            return;
        }
        let (part, dofs) = (&self.system.model.part, &*self.system.dofs);
        let mut trial = x.to_vec();
        for n in 0..part.owned {
            let Some(motion) = &motions[part.component[n] as usize] else { continue };
            let place = part.points[n] + self.system.committed[n];
            let there = motion.to + motion.rotation * (place - motion.from);
            let along = dofs.axes.inward(n, &(there - part.points[n]));
            for d in 0..3 {
                if let Some(k) = dofs.local(dofs.node[n][d]) {
                    trial[k] = along[d];
                }
            }
        }
        self.start_ahead(&trial, x);
    }

    /// Whether prescribed nodes turn a part of a body as one. Collective.
    pub fn turns(&self) -> bool {
        self.motions().iter().any(Option::is_some)
    }

    /// By component the motion of its prescribed nodes, if they turn as one. Collective.
    fn motions(&self) -> Vec<Option<Carried>> {
        let part = &self.system.model.part;
        let ahead = self.prescribed_increments();
        let is_held = |n: &usize| self.system.conditions.prescribed[3 * n..][..3].iter().all(Option::is_some);
        let held: Vec<(usize, Vec3, Vec3)> = (0..part.owned)
            .filter(is_held)
            .map(|n| {
                let place = part.points[n] + self.system.committed[n];
                (part.component[n] as usize, place, place + ahead[n])
            })
            .collect();
        // Their number and their centres, before and behind.
        let mut centres = vec![[0.0; 7]; part.components.len()];
        for (component, before, behind) in &held {
            let values = [1.0].into_iter().chain(before.iter().chain(behind).copied());
            centres[*component].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        sum(self.system.comm, centres.as_flattened_mut());
        let centres: Vec<[Vec3; 2]> = (centres.iter())
            .map(|[count, all @ ..]| [&all[..3], &all[3..]].map(|sum| Vec3::from_column_slice(sum) / count.max(1.0)))
            .collect();
        let arms = |&(component, before, behind): &(usize, Vec3, Vec3)| {
            let [from, to] = centres[component];
            (component, before - from, behind - to)
        };
        let mut products = vec![[0.0; 9]; part.components.len()];
        for (component, before, behind) in held.iter().map(arms) {
            let product = behind * before.transpose();
            products[component].iter_mut().zip(product.iter()).for_each(|(sum, value)| *sum += value);
        }
        sum(self.system.comm, products.as_flattened_mut());
        let rotations: Vec<Option<Mat3>> =
            products.iter().map(|product| rotation(&Mat3::from_column_slice(product))).collect();
        // Squares of what they are off, and of their distances.
        let mut off = vec![[0.0; 2]; part.components.len()];
        for (component, before, behind) in held.iter().map(arms) {
            if let Some(rotation) = &rotations[component] {
                off[component][0] += (rotation * before - behind).norm_squared();
                off[component][1] += before.norm_squared();
            }
        }
        sum(self.system.comm, off.as_flattened_mut());
        let motion = |((rotation, [from, to]), [off, far]): ((Option<Mat3>, [Vec3; 2]), [f64; 2])| {
            (off <= AS_ONE * AS_ONE * far).then_some(Carried { from, to, rotation: rotation? })
        };
        rotations.into_iter().zip(centres).zip(off).map(motion).collect()
    }
}

/// The rotation behind the sum of products of arms behind and before a motion (Kabsch, Acta Cryst. A32, 1976); `None` where they are all
/// on one line, and where it is hardly one.
fn rotation(products: &Mat3) -> Option<Mat3> {
    const ON_A_LINE: f64 = 1e-9;
    let svd = products.svd(true, true);
    let (left, right) = (svd.u?, svd.v_t?);
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
    if svd.singular_values[order[1]] <= ON_A_LINE * svd.singular_values[order[0]] {
        return None;
    }
    let mut signs = Vec3::repeat(1.0);
    signs[order[2]] = (left * right).determinant().signum();
    let rotation = left * Mat3::from_diagonal(&signs) * right;
    let turn = Vec3::new(
        rotation[(2, 1)] - rotation[(1, 2)],
        rotation[(0, 2)] - rotation[(2, 0)],
        rotation[(1, 0)] - rotation[(0, 1)],
    );
    // Twice the sine, or half a turn.
    (turn.norm() > 2.0 * TURNED || rotation.trace() < 0.0).then_some(rotation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_come_out_of_their_arms() {
        let arms = [[1.0, 0.2, 0.0], [-0.3, 0.8, 0.0], [-0.7, -1.0, 0.0]].map(Vec3::from);
        let sum =
            |rotation: &Mat3, arms: &[Vec3]| arms.iter().map(|arm| rotation * arm * arm.transpose()).sum::<Mat3>();
        for angle in [0.01, 0.7, 3.0, -2.0] {
            let axis = nalgebra::Unit::new_normalize(Vec3::new(0.3, -0.5, 0.8));
            let turned = *nalgebra::Rotation3::from_axis_angle(&axis, angle).matrix();
            let found = rotation(&sum(&turned, &arms)).unwrap();
            assert!((found - turned).amax() < 1e-14, "{angle}: {found}");
            let line = [arms[0], -0.5 * arms[0]];
            assert!(rotation(&sum(&turned, &line)).is_none());
        }
        assert!(rotation(&sum(&Mat3::identity(), &arms)).is_none());
        assert!(rotation(&Mat3::zeros()).is_none());
    }
}

//! Nodes whose displacements are counted along other directions than the coordinate axes, since conditions on them are inclined.
//!
//! With the directions of a node as the columns of Q, its unknowns are the components Q^T u, its residuals Q^T f, and a block
//! of the matrix between nodes a and b is Qa^T K Qb.

use crate::contact::Pair;
use crate::partition::Part;
use crate::{Mat3, Vec3};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;

/// The directions of such nodes: orthonormal columns. All others have the coordinate axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axes(BTreeMap<u32, Mat3>);

impl Axes {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Those of a node; `None` for the coordinate axes.
    pub fn of(&self, node: usize) -> Option<&Mat3> {
        if self.0.is_empty() { None } else { self.0.get(&(node as u32)) }
    }

    pub fn set(&mut self, node: usize, axes: Mat3) {
        self.0.insert(node as u32, axes);
    }

    /// A direction of a node.
    pub fn direction(&self, node: usize, d: usize) -> Vec3 {
        self.of(node).map_or(Vec3::ith(d, 1.0), |axes| axes.column(d).into())
    }

    /// The components of a vector along the directions of a node.
    pub fn inward(&self, node: usize, vector: &Vec3) -> Vec3 {
        self.of(node).map_or(*vector, |axes| axes.tr_mul(vector))
    }

    /// The vector that has these components along the directions of a node.
    pub fn outward(&self, node: usize, components: &Vec3) -> Vec3 {
        self.of(node).map_or(*components, |axes| axes * components)
    }

    /// The multipliers of the slave at a node as they are unknowns: along its directions with friction, else the normal one.
    pub fn inward_of(&self, pair: &Pair, node: u32, multiplier: &Vec3) -> Vec3 {
        if pair.rules.friction > 0.0 { self.inward(node as usize, multiplier) } else { *multiplier }
    }

    /// The same back.
    pub fn outward_of(&self, pair: &Pair, node: u32, unknowns: &Vec3) -> Vec3 {
        if pair.rules.friction > 0.0 { self.outward(node as usize, unknowns) } else { *unknowns }
    }

    /// These of owned nodes, with those of the halo. Collective.
    pub fn with_halo(&self, comm: &SimpleCommunicator, part: &Part) -> Self {
        let of_node = |n: usize| self.of(n).copied().unwrap_or_default();
        let mut flat: Vec<f64> = (0..part.points.len()).flat_map(|n| of_node(n).as_slice().to_vec()).collect();
        part.halo.update(comm, 9, &mut flat);
        let all = flat.as_chunks::<9>().0.iter().map(|axes| Mat3::from_column_slice(axes)).enumerate();
        Self(all.filter(|(_, axes)| *axes != Mat3::zeros()).map(|(n, axes)| (n as u32, axes)).collect())
    }

    /// The tangent of an element along the directions of its `nodes`; `None` where these are the coordinate axes.
    pub fn turned<const N: usize>(&self, nodes: &[u32], tangent: &[[f64; N]; N]) -> Option<[[f64; N]; N]> {
        if self.0.is_empty() || nodes.iter().all(|&n| self.of(n as usize).is_none()) {
            return None;
        }
        let mut turned = *tangent;
        for (a, &node) in nodes.iter().enumerate() {
            let Some(axes) = self.of(node as usize) else { continue };
            for row in &mut turned {
                let part = axes.tr_mul(&Vec3::from_column_slice(&row[3 * a..3 * a + 3]));
                row[3 * a..3 * a + 3].copy_from_slice(part.as_slice());
            }
            for column in 0..N {
                let part = axes.tr_mul(&Vec3::from_fn(|i, _| turned[3 * a + i][column]));
                (0..3).for_each(|i| turned[3 * a + i][column] = part[i]);
            }
        }
        Some(turned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn a_turned_tangent_has_the_energy_of_turned_displacements() {
        let mut axes = Axes::default();
        axes.set(7, *Rotation3::from_euler_angles(0.3, -1.1, 2.0).matrix());
        let tangent: [[f64; 6]; 6] = std::array::from_fn(|i| std::array::from_fn(|j| ((3 * i + 5 * j) as f64).sin()));
        let turned = axes.turned(&[3, 7], &tangent).unwrap();
        let [a, b] = [Vec3::new(0.3, -0.2, 0.7), Vec3::new(-1.3, 0.4, 0.1)];
        let energy = |k: &[[f64; 6]; 6], u: [f64; 6]| -> f64 {
            (0..6).map(|i| (0..6).map(|j| u[i] * k[i][j] * u[j]).sum::<f64>()).sum()
        };
        let flat = |a: Vec3, b: Vec3| [a.x, a.y, a.z, b.x, b.y, b.z];
        let error = energy(&turned, flat(a, axes.inward(7, &b))) - energy(&tangent, flat(a, b));
        assert!(error.abs() < 1e-14, "{error}");
        assert!((axes.outward(7, &axes.inward(7, &b)) - b).norm() < 1e-15);
        assert!(axes.turned(&[3, 4], &tangent).is_none());
    }
}

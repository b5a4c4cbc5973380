//! The strain of a solid-shell hexahedron by its parameters: what its nodes make of it, what is assumed, what is enhanced.

use super::super::hex8::{CENTRE, NODES, shape};
use super::super::{GAUSS, Gradients, add_scaled, inverse, jacobian};
use crate::solid::voigt::{Voigt, to_matrix};
use crate::{Mat3, Vec3};

/// Modes of the enhanced strain: of the membrane, of the thickness, and the last, where it is seen, the quadratic one of that.
pub(super) const MEMBRANE: usize = 4;
pub(super) const MODES: usize = MEMBRANE + 5;

/// The transverse strain that is assumed: a component at a place, from where it is interpolated.
struct Tie {
    /// In Voigt order: zz, yz or zx.
    component: usize,
    /// Of the parameters by which it is.
    pair: (usize, usize),
    /// Parameters of the place; those that are 0 are not interpolated along.
    at: [f64; 2],
}

impl Tie {
    const fn new(component: usize, pair: (usize, usize), at: [f64; 2]) -> Self {
        Self { component, pair, at }
    }

    /// Its share of the strain.
    fn share(&self, at: &[f64; 3]) -> f64 {
        (0..2).filter(|&k| self.at[k] != 0.0).map(|k| 0.5 * (1.0 + self.at[k] * at[k])).product()
    }

    fn gradients(&self) -> Gradients<8> {
        shape(self.at[0], self.at[1], 0.0).1
    }
}

pub(super) const TIES: usize = 8;
const TIED: [Tie; TIES] = [
    Tie::new(5, (0, 2), [0.0, -1.0]),
    Tie::new(5, (0, 2), [0.0, 1.0]),
    Tie::new(4, (1, 2), [-1.0, 0.0]),
    Tie::new(4, (1, 2), [1.0, 0.0]),
    Tie::new(2, (2, 2), [-1.0, -1.0]),
    Tie::new(2, (2, 2), [1.0, -1.0]),
    Tie::new(2, (2, 2), [1.0, 1.0]),
    Tie::new(2, (2, 2), [-1.0, 1.0]),
];

/// A row for each degree of freedom.
pub(super) type Row = [f64; 24];

/// An integration point in the reference state.
pub(super) struct IntegrationPoint {
    at: [f64; 3],
    gradients: Gradients<8>,
    /// J: columns are the base vectors.
    reference: Mat3,
    /// J^-1.
    inverse: Mat3,
    /// Reference volume.
    pub weight: f64,
    /// j0/j.
    ratio: f64,
    /// J0^-1 J of the membrane, times j0/j.
    to_centre: [[f64; 2]; 2],
    /// 1 - 3 zeta^2; 0 where there are two points through the thickness, at which it is none.
    quadratic: f64,
    /// Share of each tie.
    pub shares: [f64; TIES],
}

/// An element in the reference state and deformed, without enhanced strain.
pub(super) struct Shape {
    pub places: Vec<IntegrationPoint>,
    x: [[f64; 3]; 8],
    u: [[f64; 3]; 8],
    gradients: [Gradients<8>; TIES],
    /// Of the ties.
    strains: [f64; TIES],
    /// Derivatives of the position by parameters 0 and 1 in the centre.
    base: [Vec3; 2],
    pub volume: f64,
}

/// A point of the deformed element.
pub(super) struct Point {
    /// F, but for a rotation: upper triangular.
    pub f: Mat3,
    /// J^-1 F^-1.
    pub inverse: Mat3,
    pub det_f: f64,
    /// Enhanced base vectors of the membrane.
    pub base: [Vec3; 2],
    /// H: what the modes add to these, in terms of the base of the centre.
    added: [[f64; 2]; 2],
}

/// Places through the thickness with their weights, and the corners of the square of Gauss points in each.
fn points(layers: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 3], f64)> + '_ {
    let corner = |k: usize| [GAUSS * NODES[k][0], GAUSS * NODES[k][1]];
    let line = layers.iter().map(|[t, weight]| (2.0 * t - 1.0, 2.0 * weight));
    line.flat_map(move |(zeta, weight)| {
        (0..4).map(move |k| {
            let [xi, eta] = corner(k);
            ([xi, eta, zeta], weight)
        })
    })
}

impl Shape {
    /// With points of a rule from 0 to 1 through the thickness.
    pub fn new(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8], layers: &[[f64; 2]]) -> Self {
        let centre = jacobian(x0, &CENTRE);
        let (inverse0, det0) = inverse(&centre);
        let place = |(at, weight): ([f64; 3], f64)| {
            let gradients = shape(at[0], at[1], at[2]).1;
            let j = jacobian(x0, &gradients);
            let (inverse, det) = inverse(&j);
            let (ratio, map) = (det0 / det, inverse0 * j);
            let to_centre = std::array::from_fn(|l| std::array::from_fn(|i| ratio * map[(l, i)]));
            let shares = std::array::from_fn(|t| TIED[t].share(&at));
            let quadratic = if layers.len() > 2 { 1.0 - 3.0 * at[2] * at[2] } else { 0.0 };
            let (reference, weight) = (j, weight * det);
            IntegrationPoint { at, gradients, reference, inverse, weight, ratio, to_centre, quadratic, shares }
        };
        let places: Vec<IntegrationPoint> = points(layers).map(place).collect();
        let x = std::array::from_fn(|a| std::array::from_fn(|i| x0[a][i] + u[a][i]));
        let gradients: [Gradients<8>; TIES] = std::array::from_fn(|t| TIED[t].gradients());
        let strains = std::array::from_fn(|t| {
            let (before, by) = (jacobian(x0, &gradients[t]), jacobian(u, &gradients[t]));
            let (i, j) = TIED[t].pair;
            let twice = before.column(i).dot(&by.column(j))
                + by.column(i).dot(&before.column(j))
                + by.column(i).dot(&by.column(j));
            if i == j { 0.5 * twice } else { twice }
        });
        let moved = jacobian(&x, &CENTRE);
        let base = [0, 1].map(|i| moved.column(i).into());
        let volume = places.iter().map(|place| place.weight).sum();
        Self { places, x, u: *u, gradients, strains, base, volume }
    }

    /// F of the nodes at a place.
    pub fn compatible(&self, place: &IntegrationPoint) -> Mat3 {
        Mat3::identity() + jacobian(&self.u, &place.gradients) * place.inverse
    }

    /// The point with such amplitudes; `None` where it has no volume.
    pub fn point(&self, place: &IntegrationPoint, amplitudes: &[f64; MODES]) -> Option<Point> {
        let by_nodes = jacobian(&self.u, &place.gradients);
        let mut by: [Vec3; 2] = [0, 1].map(|i| by_nodes.column(i).into());
        let mut added = [[0.0; 2]; 2];
        for m in 0..MEMBRANE {
            let [k, l] = [m / 2, m % 2];
            (0..2).for_each(|i| added[k][i] += amplitudes[m] * place.at[k] * place.to_centre[l][i]);
        }
        for (k, i) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            by[i] += added[k][i] * self.base[k];
        }
        let mut strain = [0.0; 6];
        for (tie, (share, value)) in TIED.iter().zip(place.shares.iter().zip(&self.strains)) {
            strain[tie.component] += share * value;
        }
        strain[2] += (MEMBRANE..MODES).map(|m| amplitudes[m] * place.thickness(m)).sum::<f64>();
        // From displacements, not from positions, which would round small strains away.
        let before: [Vec3; 2] = [0, 1].map(|i| place.reference.column(i).into());
        let twice = |i: usize, j: usize| before[i].dot(&by[j]) + by[i].dot(&before[j]) + by[i].dot(&by[j]);
        (strain[0], strain[1], strain[3]) = (0.5 * twice(0, 0), 0.5 * twice(1, 1), twice(0, 1));
        let half = [1.0, 1.0, 1.0, 0.5, 0.5, 0.5];
        let strain = to_matrix(&std::array::from_fn(|v| half[v] * strain[v]));
        let f = upper_root(&(Mat3::identity() + 2.0 * place.inverse.transpose() * strain * place.inverse))?;
        let inverse = place.inverse * inverse(&f).0;
        let det_f = f.determinant();
        let base = [0, 1].map(|i| before[i] + by[i]);
        ((place.reference + by_nodes).determinant() > 0.0).then_some(Point { f, inverse, det_f, base, added })
    }

    /// dE/du of the point, row by row; `ties` are those of [`Self::tie_rows`].
    pub fn rows(&self, place: &IntegrationPoint, point: &Point, ties: &[Row; TIES]) -> [Row; 6] {
        let mut rows = [[0.0; 24]; 6];
        let gradients = self.membrane_gradients(place, point);
        for a in 0..8 {
            for i in 0..3 {
                let [first, second] = [0, 1].map(|k| point.base[k][i]);
                let [by_first, by_second] = [gradients[0][a], gradients[1][a]];
                rows[0][3 * a + i] = by_first * first;
                rows[1][3 * a + i] = by_second * second;
                rows[3][3 * a + i] = by_first * second + by_second * first;
            }
        }
        for (tie, (share, row)) in TIED.iter().zip(place.shares.iter().zip(ties)) {
            if *share != 0.0 {
                add_scaled(&mut rows[tie.component], *share, row);
            }
        }
        rows
    }

    /// Derivatives of the enhanced base vectors of the membrane by the positions of nodes.
    pub fn membrane_gradients(&self, place: &IntegrationPoint, point: &Point) -> [[f64; 8]; 2] {
        let mut gradients = [place.gradients[0], place.gradients[1]];
        for (k, i) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            add_scaled(&mut gradients[i], point.added[k][i], &CENTRE[k]);
        }
        gradients
    }

    /// dE/du of the ties.
    pub fn tie_rows(&self) -> [Row; TIES] {
        std::array::from_fn(|t| {
            let (gradients, (i, j)) = (&self.gradients[t], TIED[t].pair);
            let moved = jacobian(&self.x, gradients);
            let half = if i == j { 0.5 } else { 1.0 };
            std::array::from_fn(|row| {
                let (a, d) = (row / 3, row % 3);
                half * (gradients[i][a] * moved[(d, j)] + gradients[j][a] * moved[(d, i)])
            })
        })
    }

    /// d2E/du2 of the ties with stresses that they bear, for any direction.
    pub fn tie_stiffness(&self, stresses: &[f64; TIES]) -> [[f64; 8]; 8] {
        let mut sum = [[0.0; 8]; 8];
        for (t, stress) in stresses.iter().enumerate() {
            let (gradients, (i, j)) = (&self.gradients[t], TIED[t].pair);
            let half = if i == j { 0.5 } else { 1.0 };
            for a in 0..8 {
                add_scaled(&mut sum[a], half * stress * gradients[i][a], &gradients[j]);
                add_scaled(&mut sum[a], half * stress * gradients[j][a], &gradients[i]);
            }
        }
        sum
    }

    /// dE/dalpha of each mode.
    pub fn modes(&self, place: &IntegrationPoint, point: &Point) -> [Voigt; MODES] {
        std::array::from_fn(|m| {
            let mut strain = [0.0; 6];
            if m < MEMBRANE {
                let by = place.membrane(m);
                let along = point.base.map(|base| base.dot(&self.base[m / 2]));
                (strain[0], strain[1]) = (along[0] * by[0], along[1] * by[1]);
                strain[3] = along[0] * by[1] + along[1] * by[0];
            } else {
                strain[2] = place.thickness(m);
            }
            strain
        })
    }

    /// S : d2E/dalpha_m dalpha_n of modes of the membrane.
    pub fn mode_stiffness(&self, place: &IntegrationPoint, stress: &Voigt, m: usize, n: usize) -> f64 {
        let (a, b) = (place.membrane(m), place.membrane(n));
        let form = stress[0] * a[0] * b[0] + stress[1] * a[1] * b[1] + stress[3] * (a[0] * b[1] + a[1] * b[0]);
        form * self.base[m / 2].dot(&self.base[n / 2])
    }

    /// Adds S : d2E/du dalpha_m of a mode of the membrane to a row.
    pub fn add_mode_coupling(
        &self,
        place: &IntegrationPoint,
        (point, gradients): (&Point, &[[f64; 8]; 2]),
        stress: &Voigt,
        m: usize,
        row: &mut Row,
    ) {
        let (k, by) = (m / 2, place.membrane(m));
        let along = [stress[0] * by[0] + stress[3] * by[1], stress[3] * by[0] + stress[1] * by[1]];
        let pull = along[0] * point.base[0] + along[1] * point.base[1];
        for a in 0..8 {
            let of_base = along[0] * gradients[0][a] + along[1] * gradients[1][a];
            (0..3).for_each(|d| row[3 * a + d] += of_base * self.base[k][d] + CENTRE[k][a] * pull[d]);
        }
    }
}

impl IntegrationPoint {
    /// Derivatives of the two base vectors by the amplitude of a mode of the membrane, along the base vector of the centre that
    /// it has.
    fn membrane(&self, m: usize) -> [f64; 2] {
        self.to_centre[m % 2].map(|by| self.at[m / 2] * by)
    }

    /// dE_zz/dalpha of a mode of the thickness.
    fn thickness(&self, m: usize) -> f64 {
        let [xi, eta, zeta] = self.at;
        self.ratio * [zeta, zeta * xi, zeta * eta, zeta * xi * eta, self.quadratic][m - MEMBRANE]
    }
}

/// The component of each tie.
pub(super) fn component(tie: usize) -> usize {
    TIED[tie].component
}

/// The upper triangle A with A^T A the symmetric matrix of which the upper half is read; `None` unless positive definite.
fn upper_root(m: &Mat3) -> Option<Mat3> {
    let mut a = Mat3::zeros();
    for i in 0..3 {
        let square = m[(i, i)] - (0..i).map(|k| a[(k, i)] * a[(k, i)]).sum::<f64>();
        if square.is_nan() || square <= 0.0 {
            return None;
        }
        a[(i, i)] = square.sqrt();
        for j in i + 1..3 {
            a[(i, j)] = (m[(i, j)] - (0..i).map(|k| a[(k, i)] * a[(k, j)]).sum::<f64>()) / a[(i, i)];
        }
    }
    Some(a)
}

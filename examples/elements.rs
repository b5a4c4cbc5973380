//! How the elements bend, lock and stay stable, as Markdown tables.

use nagata::mesh::faces::{HEX_BETWEEN, TET_EDGES};
use nagata::scene::MaterialModel;
use nagata::solid::element::hex8_eas::{Modes, VOLUME};
use nagata::solid::element::{
    ElementMatrices, Inverted, Medium, hex8, hex8_eas, hex8_fbar, hex8_shell, hex8_sri, hex27, tet4, tet10, tet10_sri,
};
use nagata::solid::material::{Material, State};
use nagata::solid::voigt::to_matrix;
use nagata::{Mat3, Vec3};
use nalgebra::DMatrix;
use std::f64::consts::PI;

type Nodes<const N: usize> = [[f64; 3]; N];
type Hex = fn(&Nodes<8>, &Nodes<8>, Medium, bool, &mut ElementMatrices<24>) -> Result<(), Inverted>;

type Tet = fn(&Nodes<10>, &Nodes<10>, Medium, bool, &mut ElementMatrices<30>) -> Result<(), Inverted>;

/// What blocks are made of.
#[derive(Clone, Copy)]
enum Element {
    /// A hexahedron on the eight nodes of each cell, or what else stands on these.
    Eight(Hex),
    /// Six quadratic tetrahedra on the nodes of 2 x 2 x 2 cells.
    TwentySeven(Tet),
    /// One quadratic hexahedron on the same.
    Whole,
}
use Element::{Eight, TwentySeven, Whole};

impl Element {
    fn eight(self) -> Option<Hex> {
        match self {
            Eight(hex) => Some(hex),
            TwentySeven(_) | Whole => None,
        }
    }
}

const ELEMENTS: [(&str, Element); 13] = [
    ("hex8", Eight(hex8::evaluate)),
    ("hex8-fbar", Eight(hex8_fbar::evaluate)),
    ("hex8-sri", Eight(hex8_sri::evaluate)),
    ("hex8-eas", Eight(hex8_eas::evaluate)),
    ("hex8-shell", Eight(shell)),
    ("the same, thickness along z", Eight(|x, u, m, w, o| hex8_shell::evaluate((x, u), 2, m, w, o))),
    ("9 transposed modes", Eight(|x, u, m, w, o| hex8_eas::evaluate_with(&modes::<9>(true), x, u, m, w, o))),
    ("9 Wilson modes", Eight(|x, u, m, w, o| hex8_eas::evaluate_with(&modes::<9>(false), x, u, m, w, o))),
    ("12 Wilson modes", Eight(|x, u, m, w, o| hex8_eas::evaluate_with(&modes::<12>(false), x, u, m, w, o))),
    ("tet4", Eight(six_tets)),
    ("tet10", TwentySeven(tet10::evaluate)),
    ("tet10-sri", TwentySeven(tet10_sri::evaluate)),
    ("hex27", Whole),
];

/// Modes of enhanced strain: component (i, j) times xi_j, or xi_i if `transposed`; and from the tenth on, the volume times
/// products of two parameters.
fn modes<const M: usize>(transposed: bool) -> Modes<M, 8> {
    let mut modes = Modes { components: [VOLUME; M], amplitudes: [[0.0; M]; 8] };
    for m in 0..M {
        let linear = m < 9;
        if linear {
            modes.components[m] = m;
        }
        for q in 0..8 {
            let at = CUBE[q].map(|c| 2.0 * c - 1.0);
            modes.amplitudes[q][m] = match (linear, transposed) {
                (true, true) => at[m / 3],
                (true, false) => at[m % 3],
                (false, _) => at[m % 3] * at[(m + 1) % 3],
            };
        }
    }
    modes
}

/// A solid-shell whose thickness is along y.
fn shell(
    x0: &Nodes<8>,
    u: &Nodes<8>,
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<24>,
) -> Result<(), Inverted> {
    const ORDER: [usize; 8] = [0, 4, 5, 1, 3, 7, 6, 2];
    let mut own = ElementMatrices::default();
    hex8_shell::evaluate((&ORDER.map(|n| x0[n]), &ORDER.map(|n| u[n])), 2, medium, want_tangent, &mut own)?;
    let place = |k: usize| 3 * ORDER[k / 3] + k % 3;
    for r in 0..24 {
        out.residual[place(r)] = own.residual[r];
        (0..24).for_each(|c| out.tangent[place(r)][place(c)] = own.tangent[r][c]);
    }
    Ok(())
}

/// The corners of a cube, two and two, around its diagonal from 0 to 6.
const AROUND: [[usize; 2]; 6] = [[1, 2], [2, 3], [3, 7], [7, 4], [4, 5], [5, 1]];

/// A hexahedron cut into six tetrahedra around the diagonal from node 0 to node 6.
fn six_tets(
    x0: &Nodes<8>,
    u: &Nodes<8>,
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<24>,
) -> Result<(), Inverted> {
    *out = ElementMatrices::default();
    let mut tet = ElementMatrices::<12>::default();
    for [p, q] in AROUND {
        let nodes = [0, p, q, 6];
        tet4::evaluate(&nodes.map(|n| x0[n]), &nodes.map(|n| u[n]), medium, want_tangent, &mut tet)?;
        let place = |k: usize| 3 * nodes[k / 3] + k % 3;
        for r in 0..12 {
            out.residual[place(r)] += tet.residual[r];
            (0..12).for_each(|c| out.tangent[place(r)][place(c)] += tet.tangent[r][c]);
        }
    }
    Ok(())
}

/// A structured block of hexahedra; nodes along z count fastest, then y.
struct Block {
    elements: [usize; 3],
    points: Vec<[f64; 3]>,
}

impl Block {
    /// With nodes at `place` of their parameters in the unit cube.
    fn new(elements: [usize; 3], place: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let [nx, ny, nz] = elements;
        let mut points = Vec::new();
        for i in 0..=nx {
            for j in 0..=ny {
                for k in 0..=nz {
                    points.push(place([i as f64 / nx as f64, j as f64 / ny as f64, k as f64 / nz as f64]));
                }
            }
        }
        Self { elements, points }
    }

    fn node(&self, i: usize, j: usize, k: usize) -> usize {
        (i * (self.elements[1] + 1) + j) * (self.elements[2] + 1) + k
    }

    fn place(&self, node: usize) -> [usize; 3] {
        let (per_row, per_plane) = (self.elements[2] + 1, (self.elements[1] + 1) * (self.elements[2] + 1));
        [node / per_plane, node % per_plane / per_row, node % per_row]
    }

    fn hexes(&self) -> Vec<[usize; 8]> {
        let [nx, ny, nz] = self.elements;
        let corners = CUBE.map(|corner| corner.map(|c| c as usize));
        let mut list = Vec::new();
        for i in 0..nx {
            for j in 0..ny {
                for k in 0..nz {
                    list.push(corners.map(|[a, b, c]: [usize; 3]| self.node(i + a, j + b, k + c)));
                }
            }
        }
        list
    }

    /// Internal forces, and the tangent by bands.
    fn assemble(&self, element: Element, material: &Material, u: &[f64]) -> Result<(Vec<f64>, Banded), Inverted> {
        let reach = if let Eight(_) = element { 1 } else { 2 };
        let band = 3 * (self.node(reach, reach, reach) + 1) - 1;
        let mut forces = vec![0.0; u.len()];
        let mut matrix = Banded::new(u.len(), band);
        let medium = Medium::virgin(material);
        let at = |n: usize| [u[3 * n], u[3 * n + 1], u[3 * n + 2]];
        let mut add = |nodes: &[usize], residual: &[f64], tangent: &[f64]| {
            for (r, row) in tangent.chunks_exact(residual.len()).enumerate() {
                let to = 3 * nodes[r / 3] + r % 3;
                forces[to] += residual[r];
                row.iter().enumerate().for_each(|(c, k)| *matrix.at(to, 3 * nodes[c / 3] + c % 3) += k);
            }
        };
        match element {
            Eight(evaluate) => {
                let mut out = ElementMatrices::default();
                for hex in self.hexes() {
                    evaluate(&hex.map(|n| self.points[n]), &hex.map(at), medium, true, &mut out)?;
                    add(&hex, &out.residual, out.tangent.as_flattened());
                }
            }
            TwentySeven(evaluate) => {
                let mut out = ElementMatrices::default();
                for tet in self.tets() {
                    evaluate(&tet.map(|n| self.points[n]), &tet.map(at), medium, true, &mut out)?;
                    add(&tet, &out.residual, out.tangent.as_flattened());
                }
            }
            Whole => {
                let mut out = ElementMatrices::default();
                for hex in self.quadratic_hexes() {
                    hex27::evaluate(&hex.map(|n| self.points[n]), &hex.map(at), medium, true, &mut out)?;
                    add(&hex, &out.residual, out.tangent.as_flattened());
                }
            }
        }
        Ok((forces, matrix))
    }

    /// One quadratic hexahedron in each 2 x 2 x 2 cells.
    fn quadratic_hexes(&self) -> Vec<[usize; 27]> {
        let [nx, ny, nz] = self.elements.map(|n| n / 2);
        let corner = |c: usize| CUBE[c].map(|x| x as usize);
        let mut list = Vec::new();
        for [i, j, k] in (0..nx * ny * nz).map(|c| [c / (ny * nz), c / nz % ny, c % nz]) {
            let between = |[a, b]: [usize; 2]| {
                let [x, y, z] = [0, 1, 2].map(|d| corner(a)[d] + corner(b)[d]);
                self.node(2 * i + x, 2 * j + y, 2 * k + z)
            };
            list.push(HEX_BETWEEN.map(between));
        }
        list
    }

    /// Six quadratic tetrahedra in each 2 x 2 x 2 cells, around a diagonal.
    fn tets(&self) -> Vec<[usize; 10]> {
        let [nx, ny, nz] = self.elements.map(|n| n / 2);
        let mut list = Vec::new();
        for [i, j, k] in (0..nx * ny * nz).map(|c| [c / (ny * nz), c / nz % ny, c % nz]) {
            for [p, q] in AROUND {
                let corners = [0, p, q, 6].map(|c| CUBE[c].map(|x| x as usize));
                let node = |[a, b, c]: [usize; 3]| self.node(2 * i + a, 2 * j + b, 2 * k + c);
                list.push(std::array::from_fn(|n| match n {
                    0..4 => node(corners[n].map(|c| 2 * c)),
                    _ => node([0, 1, 2].map(|d| TET_EDGES[n - 4].map(|end| corners[end][d]).iter().sum())),
                }));
            }
        }
        list
    }

    /// Newton's method from `u`, where held degrees of freedom already are as prescribed. Returns internal forces, or
    /// `None` if it does not converge, and the number of iterations.
    fn equilibrium(
        &self,
        element: Element,
        material: &Material,
        held: &[bool],
        loads: &[f64],
        u: &mut [f64],
    ) -> (Option<Vec<f64>>, usize) {
        let Ok((mut forces, mut matrix)) = self.assemble(element, material, u) else { return (None, 0) };
        let largest = |list: &[f64]| list.iter().fold(0f64, |m, f| m.max(f.abs()));
        for iteration in 0..25 {
            let mut right: Vec<f64> = (0..u.len()).map(|d| if held[d] { 0.0 } else { loads[d] - forces[d] }).collect();
            if largest(&right) <= 1e-9 * largest(&forces).max(largest(loads)) {
                return (Some(forces), iteration);
            }
            matrix.hold(held);
            matrix.solve(&mut right);
            if right.iter().any(|r| !r.is_finite()) {
                return (None, iteration);
            }
            // A step that turns an element inside out is shortened.
            let start = u.to_vec();
            let moved = (0..8).find_map(|halvings| {
                (0..u.len()).for_each(|d| u[d] = start[d] + 0.5f64.powi(halvings) * right[d]);
                self.assemble(element, material, u).ok()
            });
            match moved {
                Some(moved) => (forces, matrix) = moved,
                None => return (None, iteration),
            }
        }
        (None, 25)
    }

    /// Equilibrium under dead loads, which grow in steps that are halved where Newton's method fails; with the number of
    /// iterations, those of failures too. `None` when steps are below a 64th of the first.
    fn ramp(
        &self,
        element: Element,
        material: &Material,
        held: &[bool],
        full: &[f64],
        steps: usize,
    ) -> Option<(Vec<f64>, usize)> {
        let (mut u, mut done, mut size, mut iterations) = (vec![0.0; full.len()], 0.0, 1.0 / steps as f64, 0);
        while done < 1.0 - 1e-9 {
            let to = f64::min(done + size, 1.0);
            let loads: Vec<f64> = full.iter().map(|f| f * to).collect();
            let mut trial = u.clone();
            let (converged, count) = self.equilibrium(element, material, held, &loads, &mut trial);
            iterations += count;
            match converged {
                Some(_) => (u, done) = (trial, to),
                None => size *= 0.5,
            }
            if size < 1.0 / (64 * steps) as f64 {
                return None;
            }
        }
        Some((u, iterations))
    }

    /// Linear response to loads.
    fn linear(&self, element: Element, material: &Material, held: &[bool], loads: &[f64]) -> Vec<f64> {
        let (_, mut matrix) = self.assemble(element, material, &vec![0.0; loads.len()]).expect("sound elements");
        let mut u: Vec<f64> = (0..loads.len()).map(|d| if held[d] { 0.0 } else { loads[d] }).collect();
        matrix.hold(held);
        matrix.solve(&mut u);
        u
    }

    fn held(&self, which: impl Fn([usize; 3], usize) -> bool) -> Vec<bool> {
        (0..3 * self.points.len()).map(|d| which(self.place(d / 3), d % 3)).collect()
    }
}

/// A square matrix with so many diagonals on either side of the main one.
struct Banded {
    size: usize,
    band: usize,
    values: Vec<f64>,
}

impl Banded {
    fn new(size: usize, band: usize) -> Self {
        Self { size, band, values: vec![0.0; size * (2 * band + 1)] }
    }

    fn at(&mut self, row: usize, column: usize) -> &mut f64 {
        &mut self.values[row * (2 * self.band + 1) + column + self.band - row]
    }

    /// Makes the equations of held degrees of freedom say that they do not move.
    fn hold(&mut self, held: &[bool]) {
        for row in 0..self.size {
            for column in row.saturating_sub(self.band)..=(row + self.band).min(self.size - 1) {
                if held[row] || held[column] {
                    *self.at(row, column) = if row == column { 1.0 } else { 0.0 };
                }
            }
        }
    }

    /// Gaussian elimination without exchanges; returns the number of negative pivots, which is that of negative
    /// eigenvalues if the matrix is symmetric.
    fn solve(&mut self, right: &mut [f64]) -> usize {
        let width = 2 * self.band + 1;
        for p in 0..self.size {
            let last = (p + self.band).min(self.size - 1);
            let (done, rest) = self.values.split_at_mut((p + 1) * width);
            let pivots = &done[p * width + self.band..][..=last - p];
            for row in p + 1..=last {
                let from = (row - p - 1) * width + self.band + p - row;
                let factor = rest[from] / pivots[0];
                if factor != 0.0 {
                    rest[from..][..=last - p].iter_mut().zip(pivots).for_each(|(r, p)| *r -= factor * p);
                    right[row] -= factor * right[p];
                }
            }
        }
        for p in (0..self.size).rev() {
            let last = (p + self.band).min(self.size - 1);
            let known: f64 = (p + 1..=last).map(|c| *self.at(p, c) * right[c]).sum();
            right[p] = (right[p] - known) / *self.at(p, p);
        }
        (0..self.size).filter(|&p| *self.at(p, p) < 0.0).count()
    }
}

fn neo_hookean(young: f64, poisson: f64) -> Material {
    Material::new(&MaterialModel::NeoHookean { young, poisson })
}

/// Tip rotation in pure bending over the exact one, one layer of ten elements of the given aspect ratio and width, whose
/// walls lean to and fro by `lean` thicknesses.
fn pure_bending(element: Element, aspect: f64, poisson: f64, lean: f64) -> Option<f64> {
    element.eight()?;
    let (n, young) = (10, 1000.0);
    let length = n as f64 * aspect;
    let block = Block::new([n, 1, 1], |[x, y, z]| {
        let i = (x * n as f64).round() as usize;
        let side = if i == 0 || i == n {
            0.0
        } else if i.is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
        [length * x + side * lean * (y - 0.5), y - 0.5, aspect * (z - 0.5)]
    });
    let held = block.held(|[i, j, k], d| {
        i == 0 && (d == 0 || d == 1 && j == 0 && (k == 0 || k == 1) || d == 2 && j == 0 && k == 0)
    });
    let mut loads = vec![0.0; held.len()];
    // Moment 1 about z per width.
    for k in 0..2 {
        loads[3 * block.node(n, 1, k)] = -0.5;
        loads[3 * block.node(n, 0, k)] = 0.5;
    }
    let u = block.linear(element, &neo_hookean(young, poisson), &held, &loads);
    let exact = length * length / (2.0 * young * aspect / 12.0);
    let tip = |j: usize| 0.5 * (u[3 * block.node(n, j, 0) + 1] + u[3 * block.node(n, j, 1) + 1]);
    Some(0.5 * (tip(0) + tip(1)) / exact)
}

/// Tip deflection under a transverse force over that of beam theory, one layer of ten elements, nu = 0.
fn cantilever(element: Element, aspect: f64) -> Option<f64> {
    element.eight()?;
    let (n, young) = (10, 1000.0);
    let length = n as f64 * aspect;
    let block = Block::new([n, 1, 1], |[x, y, z]| [length * x, y - 0.5, aspect * (z - 0.5)]);
    let held = block.held(|[i, ..], _| i == 0);
    let mut loads = vec![0.0; held.len()];
    (0..2).for_each(|j| (0..2).for_each(|k| loads[3 * block.node(n, j, k) + 1] = 0.25));
    let u = block.linear(element, &neo_hookean(young, 0.0), &held, &loads);
    let exact = length.powi(3) / (3.0 * young * aspect / 12.0) + 1.2 * length / (0.5 * young * aspect);
    Some(u[3 * block.node(n, 1, 0) + 1] / exact)
}

/// Shortening of the diameter of a ring, R = 20, t = 1, with n elements around a quarter, between two forces, over that of
/// beam theory; nu = 0, linear.
fn ring(element: Element, n: usize) -> Option<f64> {
    element.eight()?;
    let (radius, young) = (20.0, 1000.0);
    let block = Block::new([n, 1, 1], |[x, y, z]| {
        let (s, c) = (0.5 * PI * x).sin_cos();
        let r = radius + y - 0.5;
        [r * s, r * c, z]
    });
    let held = block.held(|[i, ..], d| i == 0 && d == 0 || i == n && d == 1 || d == 2);
    let mut loads = vec![0.0; held.len()];
    // Half of the unit force, on the middle of the wall.
    (0..2).for_each(|j| (0..2).for_each(|k| loads[3 * block.node(0, j, k) + 1] = -0.125));
    let u = block.linear(element, &neo_hookean(young, 0.0), &held, &loads);
    let sinking = -0.5 * (u[3 * block.node(0, 0, 0) + 1] + u[3 * block.node(0, 1, 0) + 1]);
    let bending = radius.powi(3) / (young / 12.0) * (PI / 4.0 - 2.0 / PI);
    let (stretch, shear) = (PI / 4.0 * radius / young, PI / 4.0 * 1.2 * radius / (0.5 * young));
    Some(2.0 * sinking / (bending + stretch + shear))
}

/// Microseconds for residual and tangent of an element strained by some percent, in the fastest of many batches.
fn cost(element: Element, material: &Material) -> Option<f64> {
    let element = element.eight()?;
    let wave = |n: usize, i: usize, phase: f64| 0.05 * (phase + 1.7 * n as f64 + 2.9 * i as f64).sin();
    let x0 = std::array::from_fn(|n| std::array::from_fn(|i| CUBE[n][i] + wave(n, i, 0.0)));
    let u = std::array::from_fn(|n| std::array::from_fn(|i| wave(n, i, 0.5)));
    let mut out = ElementMatrices::default();
    let count = 100;
    let batches = (0..200).map(|_| {
        let start = std::time::Instant::now();
        for _ in 0..count {
            element(std::hint::black_box(&x0), &u, Medium::virgin(material), true, &mut out).expect("sound element");
            std::hint::black_box(&mut out);
        }
        start.elapsed().as_secs_f64()
    });
    Some(1e6 * batches.fold(f64::INFINITY, f64::min) / count as f64)
}

/// Rise of the corner of Cook's membrane in plane strain under a force of 100, neo-Hookean, finite strain.
fn cook(element: Element, n: usize, poisson: f64) -> Option<(f64, usize)> {
    let layers = if let Eight(_) = element { 1 } else { 2 };
    let block = Block::new([n, n, layers], |[x, y, z]| [48.0 * x, 44.0 * x + y * (44.0 - 28.0 * x), z]);
    let held = block.held(|[i, ..], d| i == 0 || d == 2);
    let mut full = vec![0.0; held.len()];
    for j in 0..=n {
        let share = if j == 0 || j == n { 0.5 } else { 1.0 } / n as f64;
        for k in 0..=layers {
            let part = if k == 0 || k == layers { 0.5 } else { 1.0 } / layers as f64;
            full[3 * block.node(n, j, k) + 1] = 100.0 * share * part;
        }
    }
    let material = neo_hookean(80.194 * 2.0 * (1.0 + poisson), poisson);
    let (u, iterations) = block.ramp(element, &material, &held, &full, 5)?;
    Some((u[3 * block.node(n, n, 0) + 1], iterations))
}

/// Sinking of the middle of a quarter of a block of 50 x 50 x 50, pressed on the middle quarter of its top whose points
/// move vertically alone.
fn local_compression(element: Element, n: usize, pressure: f64) -> Option<(f64, usize)> {
    let block = Block::new([n, n, n], |x| x.map(|c| 50.0 * c));
    let top = |[i, j, k]: [usize; 3]| k == n && i <= n && j <= n;
    let held = block.held(|p, d| {
        let [i, j, k] = p;
        d == 0 && (i == 0 || top(p)) || d == 1 && (j == 0 || top(p)) || d == 2 && k == 0
    });
    let mut full = vec![0.0; held.len()];
    let area = (50.0 / n as f64).powi(2);
    for i in 0..n / 2 {
        for j in 0..n / 2 {
            for (a, b) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                full[3 * block.node(i + a, j + b, n) + 2] -= 0.25 * area * pressure;
            }
        }
    }
    let material = neo_hookean(80.194 * 2.0 * 1.4999, 0.4999);
    let (u, iterations) = block.ramp(element, &material, &held, &full, 10)?;
    Some((-u[3 * block.node(0, 0, n) + 2], iterations))
}

/// Deformation gradient of uniaxial stress along x, or of plane strain without stress along y.
fn homogeneous(material: &Material, stretch: f64, plane: bool) -> Mat3 {
    let f = |t: f64| Mat3::from_diagonal(&Vec3::new(stretch, t, if plane { 1.0 } else { t }));
    let stress = |t: f64| to_matrix(&material.kirchhoff(&f(t), &State::VIRGIN).expect("positive"))[(1, 1)];
    let (mut low, mut high) = (1e-3, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if stress(middle) > 0.0 { high = middle } else { low = middle }
    }
    f(0.5 * (low + high))
}

const CUBE: Nodes<8> = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];

/// Smallest eigenvalue, over the shear modulus, of a cube under homogeneous strain for displacements that are not affine.
fn hourglass_eigenvalue(element: Element, material: &Material, f: &Mat3) -> Option<f64> {
    let u = CUBE.map(|p| ((f - Mat3::identity()) * Vec3::from(p)).into());
    let mut out = ElementMatrices::default();
    element.eight()?(&CUBE, &u, Medium::virgin(material), true, &mut out).ok()?;
    // The products of the nodes' signs are what no affine field has.
    let sign = |a: usize| CUBE[a].map(|c| 2.0 * c - 1.0);
    let mode = |m: usize, a: usize| {
        let [x, y, z] = sign(a);
        [x * y, y * z, z * x, x * y * z][m] / 8f64.sqrt()
    };
    let reduced = DMatrix::from_fn(12, 12, |r, c| {
        let mut sum = 0.0;
        for a in 0..8 {
            for b in 0..8 {
                sum += mode(r / 3, a) * mode(c / 3, b) * out.tangent[3 * a + r % 3][3 * b + c % 3];
            }
        }
        sum
    });
    let symmetric = 0.5 * (&reduced + reduced.transpose());
    Some(symmetric.symmetric_eigenvalues().min() / material.initial_moduli().1)
}

/// Whether a block of 4 x 4 x 4 elements between smooth walls is stable at a homogeneous strain.
fn stable_between_walls(element: Element, material: &Material, f: &Mat3) -> bool {
    let n = 4;
    let block = Block::new([n; 3], |x| x);
    let held = block.held(|p, d| p[d] == 0 || p[d] == n);
    let u: Vec<f64> =
        block.points.iter().flat_map(|&p| <[f64; 3]>::from((f - Mat3::identity()) * Vec3::from(p))).collect();
    let Ok((_, mut matrix)) = block.assemble(element, material, &u) else { return false };
    matrix.hold(&held);
    matrix.solve(&mut vec![0.0; u.len()]) == 0
}

/// Last stretch on the way from 1 at which `stable` holds.
fn limit(end: f64, stable: impl Fn(f64) -> bool) -> f64 {
    let steps = 100;
    let at = |k: i32| end.powf(k as f64 / steps as f64);
    (1..=steps).find(|&k| !stable(at(k))).map_or(end, |k| at(k - 1))
}

fn stability(element: Element, poisson: f64, plane: bool, end: f64) -> (f64, f64) {
    let material = neo_hookean(1.0, poisson);
    let f = |s: f64| homogeneous(&material, s, plane);
    (
        limit(end, |s| hourglass_eigenvalue(element, &material, &f(s)).is_some_and(|e| e > -1e-12)),
        limit(end, |s| stable_between_walls(element, &material, &f(s))),
    )
}

/// A strip of thickness 1 and length 40, one layer, is rolled up to a ring: moment at its end over E I / R, and the steps
/// that it took.
fn roll_up(element: Element, n: usize) -> Option<f64> {
    element.eight()?;
    let (length, young) = (40.0, 1000.0);
    let block = Block::new([n, 1, 1], |[x, y, z]| [length * x, y - 0.5, z - 0.5]);
    let held = block.held(|[i, ..], d| i == 0 || i == n || d == 2);
    let material = Material::new(&MaterialModel::Hooke { young, poisson: 0.0 });
    let mut u = vec![0.0; held.len()];
    let loads = vec![0.0; held.len()];
    let (steps, mut moment) = (40, 0.0);
    for step in 1..=steps {
        let angle = 2.0 * PI * step as f64 / steps as f64;
        let (s, c) = angle.sin_cos();
        // All nodes start on the circle: what is under test is the equilibrium.
        for (n, p) in block.points.iter().enumerate() {
            let a = angle * p[0] / length;
            let radius = length / angle;
            let to = [(radius - p[1]) * a.sin(), radius - (radius - p[1]) * a.cos(), p[2]];
            (0..3).for_each(|d| u[3 * n + d] = to[d] - p[d]);
        }
        let forces = block.equilibrium(element, &material, &held, &loads, &mut u).0?;
        moment = (0..2)
            .flat_map(|j| (0..2).map(move |k| (j, k)))
            .map(|(j, k)| {
                let node = block.node(n, j, k);
                let arm = [-(j as f64 - 0.5) * s, (j as f64 - 0.5) * c];
                arm[0] * forces[3 * node + 1] - arm[1] * forces[3 * node]
            })
            .sum();
    }
    Some(moment / (young / 12.0 * 2.0 * PI / length))
}

fn row(cells: &[String]) {
    println!("| {} |", cells.join(" | "));
}

fn table(title: &str, head: &[&str], rows: impl Fn(Element) -> Vec<String>) {
    println!("\n## {title}\n");
    row(&std::iter::once("element").chain(head.iter().copied()).map(String::from).collect::<Vec<_>>());
    row(&vec!["---".to_string(); head.len() + 1]);
    for (name, element) in ELEMENTS {
        row(&std::iter::once(name.to_string()).chain(rows(element)).collect::<Vec<_>>());
    }
}

fn number(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| format!("{v:.3}"))
}

fn with_count(value: Option<(f64, usize)>) -> String {
    value.map_or("-".into(), |(v, count)| format!("{v:.3} ({count})"))
}

fn main() {
    let which: Vec<String> = std::env::args().skip(1).collect();
    let on = |name: &str| which.is_empty() || which.iter().any(|w| w == name);
    if on("bending") {
        table(
            "Pure bending, nu = 0.3, over exact",
            &["1", "2", "5", "10", "20", "5, lean 0.2", "5, lean 1", "5, lean 2"],
            |e| {
                let straight = [1.0, 2.0, 5.0, 10.0, 20.0].map(|a| (a, 0.0));
                straight
                    .iter()
                    .chain(&[(5.0, 0.2), (5.0, 1.0), (5.0, 2.0)])
                    .map(|&(a, lean)| number(pure_bending(e, a, 0.3, lean)))
                    .collect()
            },
        );
        table("Cantilever, over beam theory", &["1", "2", "5", "10", "20"], |e| {
            [1.0, 2.0, 5.0, 10.0, 20.0].iter().map(|&a| number(cantilever(e, a))).collect()
        });
    }
    if on("ring") {
        table("Ring", &["5", "10", "15", "30", "60"], |e| [5, 10, 15, 30, 60].map(|n| number(ring(e, n))).to_vec());
    }
    if on("cost") {
        let hooke = Material::new(&MaterialModel::Hooke { young: 210.0, poisson: 0.3 });
        table("Microseconds", &["neo-hookean", "hooke"], |e| {
            [neo_hookean(210.0, 0.3), hooke.clone()].map(|m| number(cost(e, &m))).to_vec()
        });
    }
    if on("cook") {
        table("Cook's membrane nu = 0.4999", &["4", "8", "16", "32"], |e| {
            [4, 8, 16, 32].iter().map(|&n| with_count(cook(e, n, 0.4999))).collect()
        });
    }
    if on("local") {
        table("Local compression", &["4, 100", "4, 300", "8, 100", "8, 300"], |e| {
            [(4, 100.0), (4, 300.0), (8, 100.0), (8, 300.0)]
                .iter()
                .map(|&(n, p)| with_count(local_compression(e, n, p)))
                .collect()
        });
    }
    if on("roll") {
        table("Roll-up", &["10", "20", "40"], |e| [10, 20, 40].iter().map(|&n| number(roll_up(e, n))).collect());
    }
    if on("stability") {
        for poisson in [0.3, 0.4999] {
            table(
                &format!("Stability, nu = {poisson}: one element, 4 x 4 x 4 between walls"),
                &[
                    "uniaxial compression",
                    "walls",
                    "uniaxial tension",
                    "walls",
                    "plane compression",
                    "walls",
                    "plane tension",
                    "walls",
                ],
                |e| {
                    [(false, 0.05), (false, 10.0), (true, 0.05), (true, 10.0)]
                        .iter()
                        .flat_map(|&(plane, end)| {
                            let (one, walls) = stability(e, poisson, plane, end);
                            [number(Some(one)), number(Some(walls))]
                        })
                        .collect()
                },
            );
        }
    }
}

use super::super::testing::{Random, add, affine, derivative, relative_error, rotation};
use super::super::voigt::to_matrix;
use super::*;
use crate::Vec3;
use crate::scene::{Hardening, Hill, MaterialModel};
use nalgebra::{DMatrix, DVector};

const CUBE: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];
const CORNER: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

type Nodes<const N: usize> = [[f64; 3]; N];
type Hex = fn(&Nodes<8>, &Nodes<8>, Medium, bool, &mut ElementMatrices<24>) -> Result<(), Inverted>;
const HEXES: [Hex; 2] = [hex8::evaluate, hex8_fbar::evaluate];

fn materials() -> [Material; 3] {
    [
        Material::new(&MaterialModel::NeoHookean { young: 10.0, poisson: 0.3 }),
        Material::new(&MaterialModel::Hooke { young: 10.0, poisson: 0.3 }),
        Material::new(&MaterialModel::NeoHookean { young: 10.0, poisson: 0.4999 }),
    ]
}

/// A distorted element and random displacements, none inverted.
fn hex_case(random: &mut Random) -> (Nodes<8>, Nodes<8>) {
    (add(&CUBE, &random.points(0.15)), random.points(0.15))
}

fn tet_case(random: &mut Random) -> (Nodes<4>, Nodes<4>) {
    (add(&CORNER, &random.points(0.1)), random.points(0.15))
}

fn matrices<const N: usize, const D: usize>(
    element: impl Fn(&Nodes<N>, &Nodes<N>, Medium, bool, &mut ElementMatrices<D>) -> Result<(), Inverted>,
    x0: &Nodes<N>,
    u: &Nodes<N>,
    material: &Material,
) -> ElementMatrices<D> {
    let mut out = ElementMatrices::default();
    element(x0, u, Medium::virgin(material), true, &mut out).unwrap();
    let mut forces_alone = ElementMatrices::default();
    element(x0, u, Medium::virgin(material), false, &mut forces_alone).unwrap();
    assert_eq!(out.residual, forces_alone.residual);
    out
}

/// `u` with degree of freedom `dof` moved by `t`.
fn moved<const N: usize>(u: &Nodes<N>, dof: usize, t: f64) -> Nodes<N> {
    let mut u = *u;
    u[dof / 3][dof % 3] += t;
    u
}

/// Relative error of the tangent against differences of the residual.
fn tangent_error<const N: usize, const D: usize>(
    element: impl Fn(&Nodes<N>, &Nodes<N>, Medium, bool, &mut ElementMatrices<D>) -> Result<(), Inverted>,
    x0: &Nodes<N>,
    u: &Nodes<N>,
    material: &Material,
) -> f64 {
    let residual = |u: &Nodes<N>| {
        let mut out = ElementMatrices::default();
        element(x0, u, Medium::virgin(material), false, &mut out).unwrap();
        out.residual
    };
    // Plastic flow must go on for all differences.
    let step = if material.remembers() { 5e-5 } else { 1e-3 };
    let columns: [[f64; D]; D] = std::array::from_fn(|dof| derivative(step, |t| residual(&moved(u, dof, t))));
    let differences: [[f64; D]; D] = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
    relative_error(matrices(element, x0, u, material).tangent.as_flattened(), differences.as_flattened())
}

#[test]
fn tangents_are_the_derivative_of_the_residual() {
    let mut random = Random::new(21);
    for material in &materials() {
        for _ in 0..3 {
            let (x0, u) = hex_case(&mut random);
            let error = HEXES.map(|hex| tangent_error(hex, &x0, &u, material));
            let (x0, u) = tet_case(&mut random);
            let tet = tangent_error(tet4::evaluate, &x0, &u, material);
            assert!(error[0] < 1e-11 && error[1] < 1e-11 && tet < 1e-11, "{material:?} {error:?} {tet}");
        }
        // The undeformed state has three equal stretches everywhere.
        let error = HEXES.map(|hex| tangent_error(hex, &CUBE, &[[0.0; 3]; 8], material));
        assert!(error[0] < 1e-11 && error[1] < 1e-11, "{material:?} {error:?}");
    }
}

/// Points that have flowed and flow on.
#[test]
fn tangents_in_plastic_flow_are_the_derivative_of_the_residual() {
    let mut random = Random::new(29);
    let hardening = Hardening::Swift { k: 0.1, e0: 0.001, n: 0.3 };
    let hill = Hill { coefficients: [0.283, 0.358, 0.642, 1.5, 1.5, 1.289], axes: rotation(Vec3::new(0.3, 0.8, -0.4)) };
    for hill in [None, Some(hill)] {
        let material =
            Material::new(&MaterialModel::Plastic { young: 10.0, poisson: 0.3, hill, hardening: hardening.clone() });
        for _ in 0..3 {
            let mut states = [State::VIRGIN; 8];
            let (x0, before) = hex_case(&mut random);
            advance(&hex8::samples(&x0, &before).unwrap(), &material, &mut states).unwrap();
            let u = add(&before, &random.points(0.1));
            for (k, hex) in HEXES.into_iter().enumerate() {
                let samples = if k == 0 { hex8::samples(&x0, &u) } else { hex8_fbar::samples(&x0, &u) }.unwrap();
                let mut after = states;
                advance(&samples, &material, &mut after).unwrap();
                assert!((0..8).all(|q| after[q].equivalent > states[q].equivalent + 1e-3), "{states:?} {after:?}");
                let element = |x0: &_, u: &_, medium: Medium, want, out: &mut _| {
                    hex(x0, u, Medium { states: &states, ..medium }, want, out)
                };
                let error = tangent_error(element, &x0, &u, &material);
                assert!(error < 1e-7, "{k} {error}");
            }
        }
    }
}

#[test]
fn residuals_are_the_derivative_of_the_energy() {
    let mut random = Random::new(22);
    for material in &materials() {
        let (x0, u) = hex_case(&mut random);
        let differences: [f64; 24] = std::array::from_fn(|dof| {
            derivative(1e-3, |t| {
                [stored_energy(&hex8::samples(&x0, &moved(&u, dof, t)).unwrap(), Medium::virgin(material)).unwrap()]
            })[0]
        });
        let error = relative_error(&matrices(hex8::evaluate, &x0, &u, material).residual, &differences);
        assert!(error < 1e-11, "{error}");
        let (x0, u) = tet_case(&mut random);
        let differences: [f64; 12] = std::array::from_fn(|dof| {
            derivative(1e-3, |t| {
                [stored_energy(&tet4::samples(&x0, &moved(&u, dof, t)).unwrap(), Medium::virgin(material)).unwrap()]
            })[0]
        });
        let error = relative_error(&matrices(tet4::evaluate, &x0, &u, material).residual, &differences);
        assert!(error < 1e-11, "{error}");
    }
}

#[test]
fn tangents_with_an_energy_are_symmetric() {
    let mut random = Random::new(23);
    for material in &materials() {
        let (x0, u) = hex_case(&mut random);
        let k = matrices(hex8::evaluate, &x0, &u, material).tangent;
        (0..24).for_each(|i| (0..i).for_each(|j| assert_eq!(k[i][j], k[j][i])));
        let (x0, u) = tet_case(&mut random);
        let k = matrices(tet4::evaluate, &x0, &u, material).tangent;
        (0..12).for_each(|i| (0..i).for_each(|j| assert_eq!(k[i][j], k[j][i])));
    }
}

#[test]
fn rigid_motion_gives_no_force_and_turns_the_forces() {
    let mut random = Random::new(24);
    for material in &materials() {
        for hex in HEXES {
            let (r, shift) = (rotation(random.vector(3.0)), random.vector(2.0));
            let (x0, u) = hex_case(&mut random);
            let rigid = matrices(hex, &x0, &affine(&x0, &r, shift), material);
            let stiffness = rigid.tangent.as_flattened().iter().fold(0f64, |m, k| m.max(k.abs()));
            assert!(rigid.residual.iter().all(|f| f.abs() < 1e-14 * stiffness));

            let x = add(&x0, &u);
            let after = add(&u, &affine(&x, &r, shift));
            let (a, b) = (matrices(hex, &x0, &u, material), matrices(hex, &x0, &after, material));
            for n in 0..8 {
                let turned = r * Vec3::from_column_slice(&a.residual[3 * n..3 * n + 3]);
                (0..3).for_each(|i| assert!((turned[i] - b.residual[3 * n + i]).abs() < 1e-13 * stiffness));
            }
        }
    }
}

#[test]
fn forces_and_moments_balance() {
    let mut random = Random::new(25);
    for (material, hex) in materials().iter().flat_map(|m| HEXES.map(move |hex| (m, hex))) {
        let (x0, u) = hex_case(&mut random);
        let out = matrices(hex, &x0, &u, material);
        let (mut force, mut moment, mut size) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for n in 0..8 {
            let f = Vec3::from_column_slice(&out.residual[3 * n..3 * n + 3]);
            force += f;
            moment += Vec3::from(add(&x0, &u)[n]).cross(&f);
            size += f.norm();
        }
        assert!(force.norm() < 1e-14 * size && moment.norm() < 1e-14 * size);
    }
}

/// Eight hexahedra in the unit cube whose 27 nodes, but for the corners, are moved about; affine displacement of all
/// nodes.
#[test]
fn patch_test() {
    let mut random = Random::new(26);
    let number = |i: usize, j: usize, k: usize| i + 3 * j + 9 * k;
    let mut grid = [[0.0; 3]; 27];
    for n in 0..27 {
        let at = [n % 3, n / 3 % 3, n / 9];
        grid[n] = at.map(|c| 0.5 * c as f64 + if c == 1 { random.number(0.1) } else { 0.0 });
    }
    let f = Mat3::identity() + random.matrix(0.2);
    let displaced = affine(&grid, &f, random.vector(1.0));
    for (material, hex) in materials().iter().flat_map(|m| HEXES.map(move |hex| (m, hex))) {
        let (mut inner, mut size) = (Vec3::zeros(), 0f64);
        for e in 0..8 {
            let (i, j, k) = (e % 2, e / 2 % 2, e / 4);
            let nodes = CUBE.map(|c| number(i + c[0] as usize, j + c[1] as usize, k + c[2] as usize));
            let (x0, u) = (nodes.map(|n| grid[n]), nodes.map(|n| displaced[n]));
            let residual = matrices(hex, &x0, &u, material).residual;
            let a = nodes.iter().position(|&n| n == 13).unwrap();
            inner += Vec3::from_column_slice(&residual[3 * a..3 * a + 3]);
            size = residual.iter().fold(size, |m, f| m.max(f.abs()));
        }
        assert!(inner.norm() < 1e-13 * size, "{inner} {size}");
    }
}

#[test]
fn homogeneous_deformation_gives_the_materials_stress_in_every_element() {
    let mut random = Random::new(27);
    for material in &materials() {
        let f = Mat3::identity() + random.matrix(0.2);
        let exact = to_matrix(&material.kirchhoff(&f, &State::VIRGIN).unwrap()) / f.determinant();
        let x0 = add(&CUBE, &random.points(0.15));
        let u = affine(&x0, &f, random.vector(1.0));
        let (full, fbar) =
            (matrices(hex8::evaluate, &x0, &u, material), matrices(hex8_fbar::evaluate, &x0, &u, material));
        assert!(relative_error(&fbar.residual, &full.residual) < 1e-13);
        let corners: Nodes<4> = [x0[0], x0[1], x0[3], x0[4]];
        let stresses = [
            average_stress(&hex8::samples(&x0, &u).unwrap(), Medium::virgin(material)).unwrap(),
            average_stress(&hex8_fbar::samples(&x0, &u).unwrap(), Medium::virgin(material)).unwrap(),
            average_stress(&tet4::samples(&corners, &[u[0], u[1], u[3], u[4]]).unwrap(), Medium::virgin(material))
                .unwrap(),
        ];
        for stress in stresses {
            assert!((to_matrix(&stress) - exact).norm() < 1e-12 * material.initial_moduli().0);
        }
        let current = hex8::volume(&add(&x0, &u));
        assert!((current - f.determinant() * hex8::volume(&x0)).abs() < 1e-14);
        // The mean stress is that of the nodal forces: sum_a R_a x_a^T = int sigma dv.
        let mut virial = Mat3::zeros();
        for (n, x) in add(&x0, &u).iter().enumerate() {
            virial += Vec3::from_column_slice(&full.residual[3 * n..3 * n + 3]) * Vec3::from(*x).transpose();
        }
        assert!((virial / current - exact).norm() < 1e-12 * material.initial_moduli().0);
    }
}

#[test]
fn confined_compression_of_one_element() {
    let (s, area) = (0.7, 6.0);
    let x0 = CUBE.map(|x| [2.0 * x[0], 3.0 * x[1], 4.0 * x[2]]);
    let u = affine(&x0, &Mat3::from_diagonal(&Vec3::new(1.0, 1.0, s)), Vec3::zeros());
    for (material, hex) in materials().iter().flat_map(|m| HEXES.map(move |hex| (m, hex))) {
        let (lambda, mu) = material.initial_moduli();
        let tau = match material {
            Material::NeoHookean(_) => mu * (s * s - 1.0) + lambda * s.ln(),
            Material::Hencky(_) | Material::Plastic(_) => (lambda + 2.0 * mu) * s.ln(),
        };
        let residual = matrices(hex, &x0, &u, material).residual;
        for (n, x) in x0.iter().enumerate() {
            let exact = area * tau / s / 4.0 * if x[2] > 0.0 { 1.0 } else { -1.0 };
            assert!((residual[3 * n + 2] - exact).abs() < 1e-13 * exact.abs());
        }
    }
}

#[test]
fn volumes_and_body_forces() {
    let mut random = Random::new(28);
    assert!((hex8::volume(&CUBE) - 1.0).abs() < 1e-15);
    assert!((hex8::min_jacobian(&CUBE) - 1.0).abs() < 1e-15);
    assert!((tet4::volume(&CORNER) - 1.0 / 6.0).abs() < 1e-16);
    let b = random.vector(1.0);
    let x0 = add(&CUBE, &random.points(0.15));
    let load = hex8::body_force(&x0, b);
    for i in 0..3 {
        let sum: f64 = (0..8).map(|a| load[3 * a + i]).sum();
        assert!((sum - hex8::volume(&x0) * b[i]).abs() < 1e-15);
    }
    // A prism over a trapezoid, 3 wide below and 1 wide above, 2 high: int N_a dA is 7/6 below and 5/6 above.
    let mut prism = CUBE;
    for x in &mut prism {
        let width = 3.0 - 2.0 * x[1];
        *x = [width * (x[0] - 0.5), 2.0 * x[1], 2.0 * x[2]];
    }
    let load = hex8::body_force(&prism, Vec3::new(1.0, 0.0, -2.0));
    for (a, x) in prism.iter().enumerate() {
        let share = if x[1] == 0.0 { 7.0 / 6.0 } else { 5.0 / 6.0 };
        assert!((load[3 * a] - share).abs() < 1e-14 && (load[3 * a + 2] + 2.0 * share).abs() < 1e-14);
        assert_eq!(load[3 * a + 1], 0.0);
    }
    let load = tet4::body_force(&CORNER, Vec3::new(0.0, -24.0, 0.0));
    (0..12).for_each(|k| assert!((load[k] - if k % 3 == 1 { -1.0 } else { 0.0 }).abs() < 1e-15));
}

#[test]
fn inversion_is_reported_with_the_worst_volume_ratio() {
    let material = &materials()[0];
    let mut u = affine(&CUBE, &Mat3::from_diagonal(&Vec3::new(1.0, 1.0, -0.5)), Vec3::zeros());
    for hex in HEXES {
        let error = hex(&CUBE, &u, Medium::virgin(material), true, &mut ElementMatrices::default()).unwrap_err();
        assert!((error.det_f + 0.5).abs() < 1e-15);
    }
    // One node pushed through: some points stay sound, the worst is told.
    let u_one = moved(&[[0.0; 3]; 8], 20, -2.5);
    let error = hex8::samples(&CUBE, &u_one).unwrap_err();
    assert!(error.det_f < 0.0 && error.det_f > -1.0);
    u[3][1] = f64::NAN;
    for hex in HEXES {
        let error = hex(&CUBE, &u, Medium::virgin(material), false, &mut ElementMatrices::default()).unwrap_err();
        assert!(error.det_f.is_nan());
    }
    assert!(tet4::samples(&CORNER, &affine(&CORNER, &(-Mat3::identity()), Vec3::zeros())).is_err());
}

/// Tip deflection of a slender cantilever in plane strain, 16 x 4 elements of unit size, unit tip load over the depth,
/// linear.
fn cantilever(hex: Hex, material: &Material) -> f64 {
    let (nx, ny) = (16, 4);
    let node = |i: usize, j: usize, k: usize| i + (nx + 1) * (j + (ny + 1) * k);
    // Equations of x and y of the nodes off the clamped end; both z-planes share them.
    let equation = |n: usize, d: usize| {
        let (i, j) = (n % (nx + 1), n / (nx + 1) % (ny + 1));
        (i > 0 && d < 2).then(|| 2 * (nx * j + i - 1) + d)
    };
    let size = 2 * nx * (ny + 1);
    let (mut k, mut f) = (DMatrix::zeros(size, size), DVector::zeros(size));
    let element = matrices(hex, &CUBE, &[[0.0; 3]; 8], material).tangent;
    for (i, j) in (0..nx).flat_map(|i| (0..ny).map(move |j| (i, j))) {
        let nodes = CUBE.map(|c| node(i + c[0] as usize, j + c[1] as usize, c[2] as usize));
        for (row, column) in (0..24).flat_map(|r| (0..24).map(move |c| (r, c))) {
            if let (Some(r), Some(c)) = (equation(nodes[row / 3], row % 3), equation(nodes[column / 3], column % 3)) {
                k[(r, c)] += element[row][column];
            }
        }
    }
    let tip = |j: usize| 2 * (nx * j + nx - 1) + 1;
    for j in 0..=ny {
        f[tip(j)] = if j == 0 || j == ny { 0.5 } else { 1.0 } / ny as f64;
    }
    k.lu().solve(&f).unwrap()[tip(ny / 2)]
}

#[test]
fn fbar_relieves_volumetric_locking() {
    let (young, poisson, length, height) = (1000.0, 0.4999, 16.0f64, 4.0f64);
    for model in [MaterialModel::NeoHookean { young, poisson }, MaterialModel::Hooke { young, poisson }] {
        let material = Material::new(&model);
        let (modulus, shear) = (young / (1.0 - poisson * poisson), material.initial_moduli().1);
        let beam = length.powi(3) / (3.0 * modulus * height.powi(3) / 12.0) + 1.2 * length / (shear * height);
        let [full, fbar] = HEXES.map(|hex| cantilever(hex, &material) / beam);
        assert!(full < 0.1, "{full}");
        assert!((0.95..1.0).contains(&fbar), "{fbar}");
    }
}

/// The bulk modulus acts on one mode of an F-bar element, its change of volume, and on more of one fully integrated.
#[test]
fn fbar_has_one_volume_mode() {
    let rank = |hex: Hex| {
        let tangent = |poisson: f64| {
            let material = Material::new(&MaterialModel::NeoHookean { young: 2.0, poisson });
            let (_, mu) = material.initial_moduli();
            let k = matrices(hex, &CUBE, &[[0.0; 3]; 8], &material).tangent;
            DMatrix::from_fn(24, 24, |i, j| k[i][j] / mu)
        };
        (tangent(0.4) - tangent(0.1)).singular_values().iter().filter(|&&s| s > 1e-12).count()
    };
    assert_eq!(HEXES.map(rank), [7, 1]);
}

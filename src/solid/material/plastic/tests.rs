use super::super::super::testing::{Random, derivative, relative_error, rotation};
use super::super::super::voigt::{logarithm, to_matrix, von_mises};
use super::super::{Hencky, lame};
use super::*;
use crate::Vec3;
use crate::solid::voigt::right_cauchy_green;

const YOUNG: f64 = 206_900.0;
const POISSON: f64 = 0.29;
/// F, G, H, L, M, N of a deep-drawing steel.
const SHEET: [f64; 6] = [0.283, 0.358, 0.642, 1.5, 1.5, 1.289];

fn laws() -> [Hardening; 5] {
    [
        Hardening::Linear { yield_stress: 450.0, modulus: 0.0 },
        Hardening::Linear { yield_stress: 450.0, modulus: 2000.0 },
        Hardening::Swift { k: 565.32, e0: 0.0071156, n: 0.2589 },
        Hardening::Voce { yield_stress: 450.0, saturation: 715.0, rate: 16.93, modulus: 129.24 },
        Hardening::Table(vec![[0.0, 200.0], [0.01, 300.0], [0.3, 500.0]]),
    ]
}

fn mises(law: &Hardening) -> Plastic {
    Plastic::new(lame(YOUNG, POISSON), None, law.clone())
}

fn hill(coefficients: [f64; 6], axes: Mat3, law: &Hardening) -> Plastic {
    Plastic::new(lame(YOUNG, POISSON), Some(&Hill { coefficients, axes }), law.clone())
}

/// Von Mises and Hill with every law, Hill's axes askew.
fn materials() -> Vec<Plastic> {
    let axes = rotation(Vec3::new(0.3, -0.5, 0.9));
    let of = |law: &Hardening| [mises(law), hill(SHEET, axes, law), hill([0.1, 0.9, 0.7, 3.0, 0.8, 2.0], axes, law)];
    laws().iter().flat_map(of).collect()
}

/// The tensor exponential of a symmetric tensor.
fn exp(strain: &Mat3) -> Mat3 {
    let eigen = strain.symmetric_eigen();
    eigen.eigenvectors * Mat3::from_diagonal(&eigen.eigenvalues.map(f64::exp)) * eigen.eigenvectors.transpose()
}

fn symmetric(random: &mut Random, size: f64) -> Mat3 {
    let a = random.matrix(size);
    0.5 * (a + a.transpose())
}

/// 1/2 ln Fp Fp^T by the material's axes.
fn plastic_strain(state: &State) -> Voigt {
    logarithm(&right_cauchy_green(&state.inverse_plastic)).map(|s| -0.5 * s)
}

/// Fp in space.
fn plastic_deformation(material: &Plastic, state: &State) -> Mat3 {
    material.axes * state.inverse_plastic.try_inverse().unwrap() * material.axes.transpose()
}

/// A state of a material that has flowed some percents in some direction.
fn prestrained(material: &Plastic, random: &mut Random) -> State {
    let f = rotation(random.vector(1.0)) * exp(&symmetric(random, 0.1));
    material.flow(&f, &State::VIRGIN).unwrap()
}

/// Deformation gradients: general ones, and every kind of (nearly) repeated stretches, rotated.
fn gradients() -> Vec<Mat3> {
    let mut random = Random::new(8);
    let mut list: Vec<Mat3> = (0..6).map(|_| Mat3::identity() + random.matrix(0.3)).collect();
    for gap in [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2] {
        for stretches in [
            [1.0 + gap, 1.0 - gap, 1.0 + 0.4 * gap],
            [1.2, 1.2 + gap, 0.7],
            [0.9, 0.9 + gap, 0.9 - 0.5 * gap],
            [0.5 + gap, 2.0, 0.5],
        ] {
            let stretch = Mat3::from_diagonal(&stretches.into());
            list.push(rotation(random.vector(2.0)) * stretch * rotation(random.vector(2.0)));
        }
    }
    list
}

fn turned(tensor: &Voigt, r: &Mat3) -> Mat3 {
    r * to_matrix(tensor) * r.transpose()
}

#[test]
fn it_is_hencky_below_the_yield_limit() {
    let law = Hardening::Linear { yield_stress: 1e9, modulus: 0.0 };
    let (lambda, mu) = lame(YOUNG, POISSON);
    let hencky = Hencky { lambda, mu };
    for f in gradients() {
        let exact = hencky.response(&f).unwrap();
        for material in [mises(&law), hill(SHEET, rotation(Vec3::new(0.4, 0.2, -0.7)), &law)] {
            let found = material.response(&f, &State::VIRGIN).unwrap();
            (0..6).for_each(|v| assert!((found.kirchhoff[v] - exact.kirchhoff[v]).abs() < 1e-14 * YOUNG));
            let error = relative_error(found.tangent.as_flattened(), exact.tangent.as_flattened());
            assert!(error < 4e-14, "{f} {error}");
            let (energy, exact) = (material.energy(&f, &State::VIRGIN).unwrap(), hencky.energy(&f).unwrap());
            assert!((energy - exact).abs() < 1e-14 * YOUNG);
            assert_eq!(material.flow(&f, &State::VIRGIN), Some(State::VIRGIN));
        }
    }
}

#[test]
fn tangent_is_the_lie_derivative_of_the_stress_in_flow() {
    let mut random = Random::new(41);
    let mut worst = 0f64;
    for (k, material) in materials().iter().enumerate() {
        for f in gradients() {
            let before = prestrained(material, &mut random);
            let l = random.matrix(1.0);
            let step = 1e-4;
            let equivalent = material.flow(&f, &before).unwrap().equivalent;
            assert!(equivalent > before.equivalent + 10.0 * step);
            if let Hardening::Table(points) = &material.hardening
                && points.iter().any(|point| (point[0] - equivalent).abs() < 10.0 * step)
            {
                continue;
            }
            let response = material.response(&f, &before).unwrap();
            assert_eq!(response.kirchhoff, material.kirchhoff(&f, &before).unwrap());
            let tau = to_matrix(&response.kirchhoff);
            let rate = to_matrix(&derivative(step, |t| material.kirchhoff(&(f + t * l * f), &before).unwrap()));
            let lie = rate - l * tau - tau * l.transpose();
            let d = 0.5 * (l + l.transpose());
            let engineering = [d[(0, 0)], d[(1, 1)], d[(2, 2)], 2.0 * d[(0, 1)], 2.0 * d[(1, 2)], 2.0 * d[(2, 0)]];
            let product = to_matrix(&response.tangent.map(|row| (0..6).map(|j| row[j] * engineering[j]).sum()));
            let error = relative_error(product.iter(), lie.iter());
            worst = worst.max(error);
            assert!(error < 1e-8, "{k} {f} {error}");
            for i in 0..6 {
                (0..i).for_each(|j| assert_eq!(response.tangent[i][j], response.tangent[j][i]));
            }
        }
    }
    assert!(worst < 1e-8, "{worst}");
}

/// e = s / E + ep along the axis, -nu s / E - ep / 2 across: exact for any steps, as the flow has one direction.
#[test]
fn uniaxial_tension_in_closed_form() {
    for law in &laws() {
        let material = mises(law);
        let mut state = State::VIRGIN;
        for ep in [1e-6, 1e-3, 0.0105, 0.2, 1.1] {
            let stress = law.stress(ep);
            let (axial, lateral) = (stress / YOUNG + ep, -POISSON * stress / YOUNG - 0.5 * ep);
            let f = Mat3::from_diagonal(&Vec3::new(lateral, axial, lateral).map(f64::exp));
            let found = material.kirchhoff(&f, &state).unwrap();
            let exact = [0.0, stress, 0.0, 0.0, 0.0, 0.0];
            (0..6).for_each(|v| assert!((found[v] - exact[v]).abs() < 1e-10 * stress, "{law:?} {ep} {found:?}"));
            let energy = material.energy(&f, &state).unwrap();
            assert!((energy - 0.5 * stress * stress / YOUNG).abs() < 1e-12 * stress);
            state = material.flow(&f, &state).unwrap();
            assert!((state.equivalent - ep).abs() < 1e-14 + 1e-12 * ep, "{law:?} {} {ep}", state.equivalent);
        }
    }
}

/// Stress and plastic strains in a sheet under tension at an angle to its rolling direction, from Hill's criterion in the
/// plane of the sheet.
#[test]
fn hills_yield_stresses_and_r_values() {
    let [f, g, h, _, _, n] = SHEET;
    let law = &laws()[2];
    for (degrees, r_value) in [(0.0f64, 1.793), (45.0, 1.511), (90.0, 2.269)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let [xx, yy, xy] = [cos * cos, sin * sin, sin * cos];
        let square = f * yy * yy + g * xx * xx + h * (xx - yy) * (xx - yy) + 2.0 * n * xy * xy;
        for (rotated, ep) in [(false, 1e-4), (true, 1e-4), (false, 0.3), (true, 0.3)] {
            let equivalent = law.stress(ep);
            let stress = equivalent / square.sqrt();
            let flow = |part: f64| ep * part * stress / equivalent;
            let (fx, fy) = (flow(g * xx + h * (xx - yy)), flow(f * yy - h * (xx - yy)));
            let (fz, fxy) = (-fx - fy, flow(n * xy));
            let elastic = |part: f64| ((1.0 + POISSON) * part - POISSON) * stress / YOUNG;
            let shear = (1.0 + POISSON) * xy * stress / YOUNG + fxy;
            let zz = elastic(0.0) + fz;
            let strain = Mat3::new(elastic(xx) + fx, shear, 0.0, shear, elastic(yy) + fy, 0.0, 0.0, 0.0, zz);
            // The sheet lies anywhere in space.
            let q = if rotated { rotation(Vec3::new(0.7, -0.4, 1.1)) } else { Mat3::identity() };
            let material = hill(SHEET, q, law);
            let deformation = q * exp(&strain) * q.transpose();
            let state = material.flow(&deformation, &State::VIRGIN).unwrap();
            assert!((state.equivalent - ep).abs() < 1e-13);
            let exact = [fx, fy, fz, fxy, 0.0, 0.0];
            let found = plastic_strain(&state);
            (0..6).for_each(|v| assert!((found[v] - exact[v]).abs() < 1e-3 * ep));
            let width = fx * sin * sin + fy * cos * cos - 2.0 * fxy * sin * cos;
            assert!((width / fz - r_value).abs() < 1e-3, "{degrees} {}", width / fz);
            // T itself, by the material's axes.
            let strain = material.strain(&deformation, &State::VIRGIN).unwrap().strain;
            let found = material.stress(&material.relax(&strain, &State::VIRGIN));
            let exact = [stress * xx, stress * yy, 0.0, stress * xy, 0.0, 0.0];
            (0..6).for_each(|v| assert!((found[v] - exact[v]).abs() < 1e-10 * stress, "{found:?}"));
        }
    }
}

#[test]
fn hill_with_equal_coefficients_is_von_mises() {
    let mut random = Random::new(42);
    for law in &laws() {
        let pair = [mises(law), hill([0.5, 0.5, 0.5, 1.5, 1.5, 1.5], rotation(random.vector(1.0)), law)];
        for f in gradients() {
            let [a, b] = pair.each_ref().map(|m| m.response(&f, &State::VIRGIN).unwrap());
            (0..6).for_each(|v| assert!((a.kirchhoff[v] - b.kirchhoff[v]).abs() < 1e-9));
            assert!(relative_error(a.tangent.as_flattened(), b.tangent.as_flattened()) < 1e-11);
        }
    }
}

/// The yield condition holds to rounding after increments from 1e-8 to 3, and what flows has no volume.
#[test]
fn any_increment_ends_on_the_yield_surface() {
    let mut random = Random::new(43);
    for material in &materials() {
        for _ in 0..300 {
            let before = prestrained(material, &mut random);
            let size = 10f64.powf(-3.75 + random.number(4.25));
            let stretch = exp(&(symmetric(&mut random, 1.0).normalize() * size));
            let f = rotation(random.vector(3.0)) * stretch * plastic_deformation(material, &before);
            let strain = material.strain(&f, &before).unwrap().strain;
            let flow = material.relax(&strain, &before);
            let after = material.flow(&f, &before).unwrap();
            let limit = material.hardening.stress(after.equivalent);
            let equivalent = (1.0 - flow.y) * material.unrelaxed(&flow.trial, flow.y).0;
            // The rounding of the strain, times the modulus, is what stays.
            let tolerance = 1e-14 * limit + 4e-16 * (1.0 + size) * YOUNG;
            if flow.increment > 0.0 {
                assert!((equivalent - limit).abs() < tolerance, "{size} {equivalent} {limit}");
                assert!((after.inverse_plastic.determinant() - 1.0).abs() < 1e-13);
                // Work and stress times strain are the same in the limit; the equivalent strain is what flow defines.
                let stress = material.stress(&flow);
                let elastic = material.strain(&f, &after).unwrap().strain;
                let moved: Voigt = std::array::from_fn(|v| strain[v] - elastic[v]);
                let mean = (stress[0] + stress[1] + stress[2]) / 3.0;
                let deviator = std::array::from_fn(|v| stress[v] - mean * IDENTITY[v]);
                let work = double_contraction(&deviator, &moved);
                assert!((work - equivalent * flow.increment).abs() < 1e-12 * work + tolerance);
            } else {
                assert!(equivalent <= limit * (1.0 + 1e-14) && after == before);
            }
            let response = material.response(&f, &before).unwrap();
            assert!(response.tangent.as_flattened().iter().all(|c| c.is_finite()));
        }
    }
}

#[test]
fn what_has_flowed_stays_at_its_limit() {
    let mut random = Random::new(44);
    for (k, material) in materials().iter().enumerate() {
        for f in gradients() {
            let before = prestrained(material, &mut random);
            let after = material.flow(&f, &before).unwrap();
            let stress = |state| material.stress(&material.relax(&material.strain(&f, state).unwrap().strain, state));
            let (first, again) = (stress(&before), stress(&after));
            let scale = von_mises(&first) + first[..3].iter().sum::<f64>().abs();
            (0..6).for_each(|v| assert!((first[v] - again[v]).abs() < 1e-11 * scale));
            // In space, too, where it has the axes of the strain.
            if k % 3 == 0 {
                let (first, again) = (material.kirchhoff(&f, &before).unwrap(), material.response(&f, &after).unwrap());
                (0..6).for_each(|v| assert!((first[v] - again.kirchhoff[v]).abs() < 1e-11 * scale));
            }
            let strain = material.strain(&f, &after).unwrap().strain;
            assert!(material.relax(&strain, &after).yields);
            assert!(!material.relax(&strain, &State { rests: true, ..after }).yields);
            assert!((material.flow(&f, &after).unwrap().equivalent - after.equivalent).abs() < 1e-13);
        }
    }
}

#[test]
fn turns_with_the_observer() {
    let mut random = Random::new(45);
    for material in &materials() {
        for f in gradients() {
            let before = prestrained(material, &mut random);
            let r = rotation(random.vector(3.0));
            let (a, b) = (material.kirchhoff(&f, &before).unwrap(), material.kirchhoff(&(r * f), &before).unwrap());
            let scale = von_mises(&a) + a[..3].iter().sum::<f64>().abs();
            assert!((turned(&a, &r) - to_matrix(&b)).norm() < 1e-11 * scale);
            let (a, b) = (material.flow(&f, &before).unwrap(), material.flow(&(r * f), &before).unwrap());
            assert!((a.equivalent - b.equivalent).abs() < 1e-13);
            assert!((a.inverse_plastic - b.inverse_plastic).norm() < 1e-13);
        }
    }
}

/// The state after a way through strain space in so many steps.
fn walk(material: &Plastic, steps: usize, way: impl Fn(f64) -> Mat3) -> (State, Voigt) {
    let mut state = State::VIRGIN;
    for k in 1..steps {
        state = material.flow(&way(k as f64 / steps as f64), &state).unwrap();
    }
    (state, material.kirchhoff(&way(1.0), &state).unwrap())
}

#[test]
fn steps_do_not_matter_along_a_straight_way_and_converge_along_others() {
    let mut random = Random::new(46);
    let direction = symmetric(&mut random, 0.4);
    for law in &laws() {
        let straight = |t: f64| exp(&(t * direction));
        let material = mises(law);
        let [one, many] = [1, 57].map(|steps| walk(&material, steps, straight).1);
        (0..6).for_each(|v| assert!((one[v] - many[v]).abs() < 1e-9 * von_mises(&one), "{law:?}"));
        for material in [material, hill(SHEET, rotation(random.vector(1.0)), law)] {
            let bent = |t: f64| exp(&(t * direction)) * rotation(Vec3::new(0.0, 0.0, t)) * exp(&(t * t * direction));
            let [a, b, c] = [200, 400, 800].map(|steps| walk(&material, steps, bent).1);
            let gap = |a: &Voigt, b: &Voigt| (to_matrix(a) - to_matrix(b)).norm();
            assert!(gap(&b, &c) < 1e-2 * von_mises(&c));
            let ratio = gap(&a, &b) / gap(&b, &c);
            assert!((1.8..2.2).contains(&ratio), "{law:?} {ratio}");
        }
    }
}

/// A cycle of elastic strain after much flow: the stress gives back all the work that it took, and nothing flows.
#[test]
fn elastic_cycles_keep_their_energy() {
    let mut random = Random::new(47);
    for material in &materials() {
        let f = Mat3::identity() + Mat3::new(0.0, 0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0);
        let state = walk(material, 20, |t| Mat3::identity() + t * (f - Mat3::identity())).0;
        // From the middle of the elastic range, where there is no stress.
        let rest = plastic_deformation(material, &state);
        let (a, b) = (random.matrix(2e-4), random.matrix(2e-4));
        let turn = random.vector(1.0);
        let (mut work, mut largest) = (0.0, 0f64);
        let count = 400;
        let at = |k: f64| {
            let angle = std::f64::consts::TAU * k / f64::from(count);
            let (sin, cos) = angle.sin_cos();
            rotation(turn * sin) * (Mat3::identity() + a * (cos - 1.0) + b * sin) * rest
        };
        // Midpoints of equal pieces of a period: exact beyond any power of their length.
        for k in 0..count {
            let [rate] = [derivative(1e-1, |t| at(f64::from(k) + t).data.0.as_flattened().try_into().unwrap())];
            let rate: [f64; 9] = rate;
            let middle = at(f64::from(k));
            let l = Mat3::from_column_slice(&rate) * middle.try_inverse().unwrap();
            let stress = to_matrix(&material.kirchhoff(&middle, &state).unwrap());
            assert_eq!(material.flow(&middle, &state).unwrap(), state);
            work += stress.dot(&l);
            largest = largest.max(material.energy(&middle, &state).unwrap());
        }
        assert!(largest > 1e-5 && work.abs() < 1e-9 * largest, "{work} {largest}");
    }
}

/// The work of the stress is what is stored, and the plastic work.
#[test]
fn work_is_stored_or_plastic() {
    let mut random = Random::new(48);
    for material in &materials() {
        let a = random.matrix(0.5);
        let way = |t: f64| Mat3::identity() + t * a;
        let mut errors = Vec::new();
        for steps in [200, 400] {
            let (mut state, mut work) = (State::VIRGIN, 0.0);
            let mut last = Mat3::zeros();
            for k in 1..=steps {
                let [from, to] = [k - 1, k].map(|k| way(k as f64 / steps as f64));
                let stress = to_matrix(&material.kirchhoff(&to, &state).unwrap());
                let first_piola = stress * to.try_inverse().unwrap().transpose();
                work += 0.5 * (first_piola + last).dot(&(to - from));
                last = first_piola;
                state = material.flow(&to, &state).unwrap();
            }
            let balance = material.energy(&way(1.0), &state).unwrap() + material.plastic_work(&state);
            errors.push((work / balance - 1.0).abs());
        }
        assert!(errors[1] < 2e-3 && errors[1] < 0.6 * errors[0], "{errors:?}");
    }
}

/// Simple shear to 5: without hardening it bears the yield stress over the root of 3 all the way, with hardening what Y is at
/// the shear over the root of 3, exactly in the limit of small elastic strains. Hill's axes, askew, turn with the shear.
#[test]
fn simple_shear_bears_the_yield_stress() {
    let way = |t: f64| Mat3::new(1.0, 5.0 * t, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    for (k, material) in materials().iter().enumerate() {
        let is_mises = k % 3 == 0;
        let shears = [500, 2000].map(|steps| {
            let (mut state, mut shears) = (State::VIRGIN, Vec::new());
            for k in 1..=steps {
                let f = way(k as f64 / steps as f64);
                let shear = material.kirchhoff(&f, &state).unwrap()[3];
                state = material.flow(&f, &state).unwrap();
                let exact = material.hardening.stress(state.equivalent) / 3f64.sqrt();
                // Elastic strains turn with the material.
                let elastic = (exact / material.mu).powi(2);
                let error = (shear / exact - 1.0).abs();
                assert!(!is_mises || state.equivalent < 0.05 || error < 5e-5 + 5.0 * elastic);
                if k % (steps / 50) == 0 {
                    shears.push(shear);
                }
            }
            let sheared = (5.0 - shears[shears.len() - 1] / material.mu) / 3f64.sqrt();
            assert!(!is_mises || (state.equivalent / sheared - 1.0).abs() < 1e-3);
            shears
        });
        let [coarse, fine] = shears;
        for (a, b) in coarse.iter().zip(&fine) {
            assert!(*b > 0.0 && (a - b).abs() < 3e-3 * b, "{k}: {coarse:?} {fine:?}");
        }
    }
}

#[test]
fn no_response_when_inverted() {
    for material in &materials()[..2] {
        for f in [Mat3::zeros(), Mat3::from_diagonal(&Vec3::new(1.0, 1.0, -1.0)), Mat3::identity() * f64::NAN] {
            assert!(material.response(&f, &State::VIRGIN).is_none());
            assert!(material.kirchhoff(&f, &State::VIRGIN).is_none());
            assert!(material.flow(&f, &State::VIRGIN).is_none());
            assert!(material.energy(&f, &State::VIRGIN).is_none());
        }
    }
}

//! Orthotropic elasticity, Hill's plasticity and rubber at the ends of their constants.

use crate::case::Case;
use crate::oracle::{balance, same, value};
use crate::scenes::{BAR, METHODS, SLAB, bar_force, sphere};

family!(orthotropic, like_hooke, hill, like_mises, rubber, nearly_incompressible);

/// A bar of another material, of which the stretch of the plate is 0.8.
fn bar(name: String, material: &str) -> Case {
    let (head, rest) = BAR.split_once("[material.m]").unwrap();
    let (_, rest) = rest.split_once("[tool.p]").unwrap();
    Case::text(name, format!("{head}[material.m]\n{material}\n[tool.p]{rest}")).oracle(balance(&["p", "b.zmin"], 1e-6))
}

/// Engineering constants; nu12, nu13, nu23 as shares of what is the limit of each alone.
fn constants([e1, e2, e3]: [f64; 3], shares: [f64; 3], g: f64) -> String {
    let [nu12, nu13, nu23] =
        [(e1, e2, shares[0]), (e1, e3, shares[1]), (e2, e3, shares[2])].map(|(a, b, s)| s * (a / b).sqrt());
    format!(
        "model = \"orthotropic\"\northotropic = {{ e1 = {e1:?}, e2 = {e2:?}, e3 = {e3:?}, nu12 = {nu12:?}, nu13 = {nu13:?}, \
         nu23 = {nu23:?}, g12 = {g:?}, g13 = {g:?}, g23 = {g:?} }}"
    )
}

/// Moduli up to 1e6 apart, and Poisson's ratios at the limit of definiteness: the force of a bar is that of its own modulus.
fn orthotropic() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: String, young: [f64; 3], shares: [f64; 3], g: f64, is_ordinary: bool| {
        for element in ["hex8", "hex8-sri", "hex8-fbar"] {
            let case = bar(format!("{name}, {element}"), &constants(young, shares, g))
                .set(format!("body.b.element={element}"))
                .oracle(value("p.fz", bar_force(young[2], 4.0, 0.8), 1e-6, "closed form"));
            let case = if is_ordinary { case.must_run() } else { case };
            cases.push(case.quick_if(is_ordinary && element == "hex8"));
        }
    };
    for ratio in [1e-6, 1e-3, 1e3, 1e6] {
        let is_ordinary = (1e-3..=1e3).contains(&ratio);
        add(format!("e1 = {ratio:e} e3"), [10.0 * ratio, 10.0, 10.0], [0.3; 3], 4.0, is_ordinary);
        add(format!("g = {ratio:e} e"), [10.0; 3], [0.3; 3], 10.0 * ratio, false);
    }
    // With all three alike s the determinant is (1 - 2 s) (1 + s)^2, with one of them 1 - s^2.
    for off in [1e-3, 1e-6, 1e-9, 1e-12] {
        add(format!("three ratios off their limit by {off:e}"), [1000.0, 100.0, 10.0], [0.5 - off; 3], 4.0, false);
        add(
            format!("three ratios off their lower limit by {off:e}"),
            [1000.0, 100.0, 10.0],
            [off - 1.0; 3],
            4.0,
            false,
        );
        add(format!("one ratio off its limit by {off:e}"), [1000.0, 100.0, 10.0], [1.0 - off, 0.0, 0.0], 4.0, false);
    }
    cases
}

/// With the constants of an isotropic material: the same as Hooke's law, under a sphere with friction.
fn like_hooke() -> Vec<Case> {
    let mut cases = Vec::new();
    for nu in [0.3, 0.4999, 0.499999] {
        for element in ["hex8", "hex8-sri", "hex8-fbar"] {
            let g = 100.0 / (2.0 + 2.0 * nu);
            let table = format!(
                "{{ model = \"orthotropic\", orthotropic = {{ e1 = 100.0, e2 = 100.0, e3 = 100.0, nu12 = {nu}, nu13 = {nu}, nu23 = \
                 {nu}, g12 = {g:?}, g13 = {g:?}, g23 = {g:?}, x = [1, 2, 3], y = [-3, 1, 0] }} }}"
            );
            let case = || {
                sphere(format!("nu = {nu}, {element}"), [4, 4, 2], 2, 2).set(format!("body.block.element={element}"))
            };
            let hooke = case().set("material.rubber.model=hooke").set(format!("material.rubber.poisson={nu}"));
            let case = case().set(format!("material.rubber={table}"));
            cases.push(
                case.oracle(same("cap.fx", hooke.clone(), 1e-6, "hooke"))
                    .oracle(same("cap.fz", hooke, 1e-6, "hooke"))
                    .quick_if(nu == 0.3 && element == "hex8"),
            );
        }
    }
    cases
}

/// Flow along z begins at the yield stress over the root of f + g, and stays as wide along x as along y where f = g.
fn hill() -> Vec<Case> {
    let mut cases = Vec::new();
    for power in [-6, -3, 0, 3, 6] {
        for element in ["hex8-sri", "hex8-fbar"] {
            let s = 10f64.powi(power);
            let flows = 1.0 / s.sqrt();
            let material = format!(
                "model = \"hill\"\nyoung = {:?}\npoisson = 0.3\nyield_stress = 1.0\nhill = {{ f = {:?}, g = {:?}, h = 0.5, n = 1.5 }}",
                1e5 * flows,
                0.5 * s,
                0.5 * s
            );
            let case = bar(format!("f + g = {s:e}, {element}"), &material)
                .sets(["step.press.increments=6", "step.press.move.0.by=[0, 0, -0.6]"])
                .set(format!("body.b.element={element}"))
                .oracle(value("p.fz", -4.0 / 0.7 * flows, 1e-3, "closed form"));
            cases.push(case.quick_if(element == "hex8-sri" && power.abs() == 3));
        }
    }
    cases
}

/// Von Mises' criterion in Hill's words, about any axes.
fn like_mises() -> Vec<Case> {
    let slab = |name: &str, more: &str, method: &str| {
        let model = format!("model = \"{more}\"\nyield_stress = 1.0\nhardening = {{ linear = 1.0 }}");
        Case::text(name, SLAB.replace("model = \"neo-hookean\"", &model))
            .sets(["body.b.element=hex8-sri", "step.press.increments=10", "step.draw.increments=10"])
            .set(format!("contact.c.method={method}"))
    };
    METHODS[..2]
        .iter()
        .map(|method| {
            let mises = slab("mises", "j2", method);
            slab(method, "hill", method)
                .set("material.m.hill={ f = 0.5, g = 0.5, h = 0.5, n = 1.5, x = [1, 2, 3], y = [-3, 1, 0] }")
                .oracle(same("t.fx", mises.clone(), 1e-4, "j2"))
                .oracle(same("t.fz", mises, 1e-4, "j2"))
                .slow()
        })
        .collect()
}

/// Force on a bar at a stretch `l` over the area 4 it had: Kirchhoff stresses f(λ') less their mean plus K J (J - 1), where the
/// principal stretches times J^(-1/3) are λ', and f is given them all; none across.
fn rubber_force(l: f64, bulk: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
    let stresses = |t: f64| {
        let j = l * t * t;
        let (long, wide) = (l / j.cbrt(), t / j.cbrt());
        let first = long * long + 2.0 * wide * wide;
        let difference = f(long, first) - f(wide, first);
        let mean = bulk * j * (j - 1.0);
        [mean + 2.0 / 3.0 * difference, mean - difference / 3.0]
    };
    // Between a volume that stays and one that hardly is compressed.
    let t = crate::common::root(0.5, 2.0, |t| stresses(t)[1]);
    4.0 * stresses(t)[0] / l
}

/// Constants of any size.
fn rubber() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add = |name: String, constants: String, (l, bulk): (f64, f64), right: f64, is_quick: bool| {
        for element in ["hex8-fbar", "hex8-sri", "hex8-eas"] {
            let case = bar(format!("{name}, {element}"), &format!("{constants}\nbulk = {bulk:?}"))
                .set(format!("body.b.element={element}"))
                .set("step.press.increments=4")
                .set(format!("step.press.move.0.by=[0, 0, {:?}]", 2.0 * (l - 1.0)))
                .oracle(value("p.fz", right, 1e-6, "closed form"));
            cases.push(case.quick_if(is_quick && element == "hex8-fbar"));
        }
    };
    // 2 mu / a λ^a; strains so large that λ^a is up to e^2 across.
    for power in [1e-6, 1e-3, 0.1, 2.0, 10.0, 30.0, 100.0, 1000.0, 3000.0] {
        for a in [power, -power] {
            let l = (-f64::min(0.22, 2.0 / power)).exp();
            let right = rubber_force(l, 500.0, |s, _| 2.0 / a * s.powf(a));
            add(
                format!("ogden, exponent {a:e}"),
                format!("model = \"ogden\"\nterms = [[1.0, {a:?}]]"),
                (l, 500.0),
                right,
                a == -30.0,
            );
        }
    }
    for ratio in [1e-6, 1.0, 1e6] {
        let bulk = 500.0 * (1.0 + ratio);
        let right = rubber_force(0.8, bulk, |s, first| 2.0 * (1.0 + ratio * first) * s * s - 2.0 * ratio * s.powi(4));
        let constants = format!("model = \"mooney-rivlin\"\nc10 = 1.0\nc01 = {ratio:?}");
        add(format!("mooney-rivlin, c01 = {ratio:e} c10"), constants, (0.8, bulk), right, ratio == 1e6);
        let right = rubber_force(0.8, bulk, |s, first| 2.0 * (1.0 + 3.0 * ratio * (first - 3.0).powi(2)) * s * s);
        let constants = format!("model = \"yeoh\"\nc10 = 1.0\nc30 = {ratio:?}");
        add(format!("yeoh, c30 = {ratio:e} c10"), constants, (0.8, bulk), right, false);
    }
    for modulus in [1e-9, 1e15] {
        let right = rubber_force(0.8, 500.0 * modulus, |s, _| 2.0 * modulus * s * s);
        let constants = format!("model = \"mooney-rivlin\"\nc10 = {modulus:?}\nc01 = 0.0");
        add(format!("mooney-rivlin, c10 = {modulus:e}"), constants, (0.8, 500.0 * modulus), right, false);
    }
    cases
}

/// Poisson's ratios towards 1/2 under a sphere with friction: nothing changes any more.
fn nearly_incompressible() -> Vec<Case> {
    let mut cases = Vec::new();
    for (law, constants) in [
        ("mooney-rivlin", "c10 = 15.0, c01 = 2.0"),
        ("yeoh", "c10 = 17.0, c20 = -1.0, c30 = 0.5"),
        ("ogden", "terms = [[20.0, 3.0], [-2.0, -4.0], [5.0, 12.0]]"),
    ] {
        for nu in ["0.49999", "0.4999999", "0.499999999", "0.499999999999"] {
            let case = |nu: &str, method: &str| {
                sphere(format!("{law}, nu = {nu}"), [4, 4, 2], 2, 2)
                    .set(format!("contact.top.method={method}"))
                    .set("body.block.element=hex8-fbar")
                    .set(format!("material.rubber={{ model = \"{law}\", {constants}, poisson = {nu} }}"))
            };
            cases.push(
                case(nu, METHODS[0])
                    .oracle(same("cap.fx", case("0.49999", METHODS[1]), 1e-3, "nu = 0.49999, method=lagrange"))
                    .oracle(balance(&["cap", "block.bottom"], 1e-4))
                    .slow(),
            );
        }
    }
    cases
}

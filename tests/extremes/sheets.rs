//! Sheets of solid-shell elements of any thickness.

use crate::case::Case;
use crate::oracle::{balance, scaled, value};
use crate::scenes::{STACK, stack_force};

family!(cantilevers, bent_by_a_roller, pressed_flat);

/// A strip of length 10 and width 1, of E = 1000 and nu = 0, in other units; `load` bends it by 0.01 at its end.
fn strip(name: String, thickness: f64, [length, modulus]: [f64; 2], n: usize) -> Case {
    let deflection = 0.01;
    let force = 3.0 * 1000.0 * thickness.powi(3) / 12.0 * deflection / 1000.0;
    let scene = format!(
        r#"[body.b]
material = "m"
element = "hex8-shell"
block = {{ box = {{ size = [{:?}, {:?}, {:?}] }}, elements = [{n}, 1, 1] }}
shell = {{ face = "zmax" }}
[material.m]
model = "hooke"
young = {:?}
poisson = 0.0
[[step]]
name = "bend"
increments = 1
fix = [{{ set = "b.xmin" }}]
force = [{{ target = "b.xmax", total = [0.0, 0.0, {:?}] }}]
[output]
every = 1000
history = ["b.xmin", "b.xmax"]
"#,
        10.0 * length,
        length,
        thickness * length,
        1000.0 * modulus,
        force * length * length * modulus
    );
    // With the shear of Timoshenko's beam, G = E / 2 and 5/6 of the section.
    let shear = 1.0 + 0.25 * thickness * thickness * 2.0 * 1.2 / 100.0;
    Case::text(name, scene)
        .oracle(value("b.xmax.uz", deflection * length * shear, 5e-3, "F l^3 / (3 E I)"))
        .oracle(value("b.xmin.fz", -force * length * length * modulus, 1e-6, "equilibrium"))
}

fn cantilevers() -> Vec<Case> {
    let mut cases = Vec::new();
    for thickness in [1.0, 0.1, 1e-2, 1e-3, 1e-4] {
        for n in [16, 100] {
            let case = strip(format!("t/L = {:e}, {n} elements", thickness / 10.0), thickness, [1.0; 2], n);
            // Beyond, forces are rounded in the size of what bends it.
            let case = if thickness >= 0.1 { case.must_run() } else { case };
            cases.push(case.quick_if(n == 16));
        }
    }
    for [length, modulus] in [[1e-9, 1.0], [1e9, 1.0], [1.0, 1e-9], [1.0, 1e15], [1e-9, 1e15], [1e9, 1e-9]] {
        let name = format!("lengths times {length:e}, E times {modulus:e}");
        cases.push(strip(name, 0.1, [length, modulus], 16).must_run().slow());
    }
    cases.push(strip("1000 increments".into(), 0.1, [1.0; 2], 16).set("step.bend.increments=1000").slow());
    cases.push(strip("7 ranks".into(), 1.0, [1.0; 2], 16).ranks(7).must_run().slow());
    cases
}

/// By a smooth roller at 8 of 10, by 0.01, of any penalty.
fn bent_by_a_roller() -> Vec<Case> {
    let scene = |thickness: f64, [length, modulus]: [f64; 2]| {
        format!(
            r#"[body.b]
material = "m"
element = "hex8-shell"
block = {{ box = {{ size = [{:?}, {:?}, {:?}] }}, elements = [20, 1, 1] }}
[material.m]
model = "hooke"
young = {:?}
poisson = 0.0
[tool.r]
cylinder = {{ point = [{:?}, 0.0, {:?}], axis = [0.0, 1.0, 0.0], radius = {:?} }}
[contact.c]
slave = "b.zmax"
master = "r"
[[step]]
name = "bend"
increments = 2
fix = [{{ set = "b.xmin" }}]
move = [{{ target = "r", by = [0.0, 0.0, {:?}] }}]
[output]
every = 1000
history = ["b.xmin"]
"#,
            10.0 * length,
            length,
            thickness * length,
            1000.0 * modulus,
            8.0 * length,
            (thickness + 0.5) * length,
            0.5 * length,
            -0.01 * length
        )
    };
    let beam = |thickness: f64| -3.0 * 1000.0 * (thickness.powi(3) / 12.0) * 0.01 / 512.0;
    let mut cases = Vec::new();
    for thickness in [0.5, 0.1, 1e-2, 1e-3] {
        for discretization in ["one-pass", "segment"] {
            let case =
                Case::text(format!("t/L = {:e}, {discretization}", thickness / 10.0), scene(thickness, [1.0; 2]))
                    .set(format!("contact.c.discretization={discretization}"))
                    .oracle(balance(&["r", "b.xmin"], 1e-6))
                    .oracle(value("r.fz", beam(thickness), 0.03, "3 E I d / a^3"));
            cases.push(case.quick_if(thickness == 1e-2 && discretization == "one-pass"));
        }
    }
    for power in [-6, -3, 3, 6, 9, 12, 15] {
        let case = Case::text(format!("penalty 1e{power} of 1"), scene(0.1, [1.0; 2]))
            .set(format!("contact.c.penalty={:?}", 10f64.powi(power)))
            .oracle(balance(&["r", "b.xmin"], 1e-6))
            .oracle(value("r.fz", beam(0.1), 0.03, "3 E I d / a^3"));
        cases.push(case.slow());
    }
    for [length, modulus] in [[1e-9, 1e15], [1e9, 1e-9]] {
        let one = Case::text("one", scene(0.1, [1.0; 2]));
        let name = format!("lengths times {length:e}, E times {modulus:e}");
        let case = Case::text(name, scene(0.1, [length, modulus])).must_run();
        let times = length * length * modulus;
        cases.push(case.oracle(scaled("r.fz", one, times, 1e-6, "the scene in other units")).slow());
    }
    cases
}

/// Two sheets on each other, held sideways and pressed by a tenth of their thickness: a closed form.
fn pressed_flat() -> Vec<Case> {
    let mut cases = Vec::new();
    for thickness in [1.0, 1e-2, 1e-4] {
        for ratio in [1e-6, 1.0, 1e6] {
            let scene = STACK
                .replace("size = [2.0, 2.0, 2.0]", &format!("size = [2.0, 2.0, {thickness:?}]"))
                .replace("origin = [0.0, 0.0, 2.0]", &format!("origin = [0.0, 0.0, {thickness:?}]"))
                .replace("elements = [2, 2, 2]", "elements = [2, 2, 1]")
                .replace("\"hex8\"", "\"hex8-shell\"\nshell = { face = \"zmax\" }")
                .replace("-0.2]", &format!("{:?}]", -0.1 * thickness));
            let force = stack_force(100.0, 100.0 * ratio, 0.3, 0.2);
            let case = Case::text(format!("thickness {thickness:e}, upper {ratio:e} times lower"), scene)
                .set(format!("material.b.young={:?}", 100.0 * ratio))
                .oracle(value("upper.zmax.fz", force, 1e-6, "closed form"))
                .oracle(value("lower.zmin.fz", -force, 1e-6, "closed form"));
            cases.push(case.quick_if(thickness == 1e-2 && ratio == 1.0));
        }
    }
    cases
}

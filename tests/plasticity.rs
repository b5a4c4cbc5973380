//! Elastic-plastic bodies, through the program: closed forms, a published bar that necks, energy, ranks, cutbacks.

mod common;

use common::{Bench, assert_close, assert_small, msh};
use std::f64::consts::PI;

/// A ring in plane strain under inner pressure, ideally plastic, of strains so small that the closed form holds: with k the
/// yield stress in shear, the plastic zone reaches to c at p = 2 k (ln(c/a) + (1 - c^2/b^2) / 2), and u = k c^2 / (2 G r) in an
/// incompressible material. (Hill, The Mathematical Theory of Plasticity, 1950, chapter V.)
#[test]
fn thick_walled_cylinder() {
    let (young, poisson, yield_stress) = (210e3, 0.4999, 2.1);
    let (k, shear) = (yield_stress / 3f64.sqrt(), young / (2.0 * (1.0 + poisson)));
    let pressure = |c: f64| 2.0 * k * (c.ln() + 0.5 * (1.0 - c * c / 4.0));
    let collapse = 2.0 * k * 2f64.ln();
    let solve = |steps: &str, n: usize, ranks| {
        let bench = Bench::new(&format!(
            r#"
            [body.ring]
            block = {{ sector = {{ radii = [1.0, 2.0], angles = [0.0, 90.0], length = 0.1 }}, elements = [{n}, {}, 1] }}
            material = "steel"
            element = "hex8-fbar"
            plane_strain = true
            [material.steel]
            model = "j2"
            young = {young}
            poisson = {poisson}
            yield_stress = {yield_stress}
            {steps}
            [output]
            every = 100
            history = ["ring.amin", "ring.amax"]
            "#,
            3 * n / 2
        ));
        bench.run(ranks, &[])
    };
    let step = |p: f64, increment: &str| {
        format!(
            "[[step]]\n{increment}\nfix = [{{ set = \"ring.amin\", directions = \"y\" }}, \
             {{ set = \"ring.amax\", directions = \"x\" }}]\npressure = [{{ set = \"ring.rmin\", value = {p} }}]\n"
        )
    };
    let radii = [1.2, 1.5, 1.8];
    let steps: String = radii.iter().map(|c| step(pressure(*c), "increments = 4")).collect();
    let mut errors = Vec::new();
    for n in [8, 16] {
        let run = solve(&steps, n, 2);
        assert_eq!(run.code, 0, "{}", run.stderr);
        let points = run.points("body.ring");
        let outer: Vec<usize> = (0..points.len()).filter(|&i| points[i][0].hypot(points[i][1]) > 2.0 - 1e-9).collect();
        let error = |(step, c): (usize, &f64)| {
            let u = run.vectors(step + 1, "body.ring", "displacement");
            let exact = k * c * c / (4.0 * shear);
            outer.iter().map(|&i| (u[i][0].hypot(u[i][1]) / exact - 1.0).abs()).fold(0.0, f64::max)
        };
        errors.push(radii.iter().enumerate().map(error).fold(0.0, f64::max));
    }
    assert_small("displacement of the rim", errors[1], 5e-3);
    assert!(errors[1] < 0.4 * errors[0], "{errors:?}");
    // Half a percent of the collapse pressure at a time, or half of that.
    let last = "increment = { initial = 0.125, min = 0.0625, max = 0.125 }";
    let run = solve(&(step(0.98 * collapse, "increments = 5") + &step(1.02 * collapse, last)), 16, 2);
    assert_eq!(run.code, 1);
    let reached = (0.98 + 0.04 * (run.history().last("time") - 1.0)) * collapse;
    assert_close("collapse pressure", reached, collapse, 5e-3);
}

/// An eighth of a bar with clamped ends: half of its length 53.334, the cross-section of radius 6.413.
fn bar(material: &str, steps: &str, n: [usize; 3]) -> Bench {
    let bench = Bench::new(&format!(
        r#"
        [body.bar]
        mesh = "bar.msh"
        element = "hex8-fbar"
        material = "steel"
        [material.steel]
        {material}
        {steps}
        [output]
        every = 1000
        history = ["bar.zmax"]
        "#
    ));
    // The polygon has the area of the circle.
    let angle = 0.25 * PI / n[0] as f64;
    let (radius, length) = (6.413 * (angle / angle.sin()).sqrt(), 53.334 / 2.0);
    let place = |[s, t, z]: [f64; 3]| {
        let m = s.max(t);
        let round = if m > 0.0 { m / s.hypot(t) } else { 1.0 };
        let scale = radius * ((1.0 - m) * 0.75 + m * round);
        [scale * s, scale * t, length * (0.5 * z + 0.5 * z * z)]
    };
    bench.write("bar.msh", &msh::block(n, false, place));
    bench
}

fn pull(by: f64, increment: &str) -> String {
    format!(
        "[[step]]\n{increment}\nfix = [{{ set = \"bar.xmin\", directions = \"x\" }}, {{ set = \"bar.ymin\", directions = \
         \"y\" }}, {{ set = \"bar.zmin\", directions = \"z\" }}]\nmove = [{{ target = \"bar.zmax\", by = [0.0, 0.0, {by}] }}]\n"
    )
}

/// The bar of Simo and Hughes (Computational Inelasticity, 1998) as solids4foam has it, with clamped ends and tabulated
/// hardening (Cardiff et al., Int. J. Numer. Meth. Engng 109, 2017, and its tutorial `neckingBar`, whose force after 1.288 mm is
/// between 74.3 and 74.6 kN, and whose neck begins after about 3.5 mm). The largest force is that of Considere: the bar is
/// uniform away from its ends, where the force A0 Y(e) exp(-e - Y/E) has its maximum at a point of the table.
#[test]
fn necking_bar() {
    let material = r#"
        model = "j2"
        young = 200e3
        poisson = 0.3
        hardening = { table = [[0.0, 451.0], [0.006, 476.0], [0.019, 525.0], [0.038, 583.0], [0.066, 642.0],
                               [0.147, 710.0], [0.5, 777.0], [1.0, 831.0]] }
        "#;
    let steps = pull(0.055, "increments = 1") + &pull(1.233, "increments = 10") + &pull(4.0, "increments = 40");
    let run = bar(material, &steps, [5, 5, 20]).solve(2, &[]);
    let history = run.history();
    let forces: Vec<f64> = history.column("bar.zmax.fz").iter().map(|f| 4e-3 * f).collect();
    let elongations = history.column("bar.zmax.uz");
    let at = |u: f64| elongations.iter().position(|v| (v - u).abs() < 1e-9).unwrap();
    assert_close("force after 1.288 mm, kN", forces[at(1.288)], 74.45, 2e-3);
    let peak = (0..forces.len()).fold(0, |best, k| if forces[k] > forces[best] { k } else { best });
    let considere = 1e-3 * PI * 6.413f64.powi(2) * 710.0 * (-0.147 - 710.0 / 200e3f64).exp();
    assert_close("largest force, kN", forces[peak], considere, 2e-3);
    assert_close("elongation when the neck begins", elongations[peak], 3.5, 0.05);
    // All work of the force is stored or plastic.
    let (mut work, mut last) = (0.0, (0.0, 0.0));
    for (&u, &force) in elongations.iter().zip(&forces) {
        work += 250.0 * 0.5 * (force + last.1) * (u - last.0);
        last = (u, force);
    }
    let kept = history.last("bar.elastic_energy") + history.last("bar.plastic_work");
    assert_close("energy, N mm", work, kept, 2e-3);
    let strains = run.field(&format!("increments/{:06}/body_bar/cell/equivalent_plastic_strain", run.written()));
    let largest = strains.iter().copied().fold(0.0, f64::max);
    let (x, u) = (run.points("body.bar"), run.vectors(run.written(), "body.bar", "displacement"));
    let neck: Vec<f64> = (0..x.len())
        .filter(|&i| x[i][2] < 1e-9 && x[i][0].hypot(x[i][1]) > 6.4)
        .map(|i| (x[i][0] + u[i][0]).hypot(x[i][1] + u[i][1]) / x[i][0].hypot(x[i][1]))
        .collect();
    let mean = neck.iter().sum::<f64>() / neck.len() as f64;
    // Nearly even over the neck, as Bridgman found, and without change of volume.
    assert_close("strain in the neck", largest, -2.0 * mean.ln(), 0.1);
    assert!(neck.iter().all(|r| (r / mean - 1.0).abs() < 2e-3), "{neck:?}");
}

/// Tension beyond yield, Swift's law: every element has the closed form, the energies are those of one point.
#[test]
fn tension_of_every_element() {
    let (young, k, n, e0) = (200e3, 565.32, 0.2589, 0.0071156f64);
    let scene = |element: &str, mesh: &str| {
        Bench::new(&format!(
            r#"
            [body.cube]
            {mesh}
            element = "{element}"
            material = "steel"
            [material.steel]
            model = "j2"
            young = {young}
            poisson = 0.3
            hardening = {{ swift = {{ k = {k}, n = {n}, e0 = {e0} }} }}
            [[step]]
            increments = 4
            fix = [{{ set = "cube.xmin", directions = "x" }}, {{ set = "cube.ymin", directions = "y" }},
                   {{ set = "cube.zmin", directions = "z" }}]
            move = [{{ target = "cube.zmax", by = [0.0, 0.0, 0.4], directions = "z" }}]
            [output]
            every = 4
            history = ["cube.zmax"]
            "#
        ))
    };
    let block = "block = { box = { size = [1.0, 1.0, 1.0] }, elements = [2, 1, 2] }";
    let e = common::root(0.0, 0.4, |e: f64| 1.4f64.ln() - e - k * (e0 + e).powf(n) / young);
    let stress = k * (e0 + e).powf(n);
    let area = (-0.6 * stress / young - e).exp();
    let stored = 0.5 * stress * stress / young;
    let plastic = k / (n + 1.0) * ((e0 + e).powf(n + 1.0) - e0.powf(n + 1.0));
    let (linear, quadratic) = ("mesh = \"cube.msh\"", "mesh = \"ten.msh\"");
    let elements =
        [("hex8", block), ("hex8-fbar", block), ("tet4", linear), ("tet10", quadratic), ("tet10-sri", quadratic)];
    for (element, mesh) in elements {
        let bench = scene(element, mesh);
        bench.write("ten.msh", &msh::second_order(&msh::block([1, 1, 2], true, |x| x)));
        bench.write("cube.msh", &msh::block([1, 1, 2], true, |x| x));
        let run = bench.solve(2, &[]);
        let history = run.history();
        // Kirchhoff stress times reference volume over the current length.
        assert_close(&format!("{element}: force"), history.last("cube.zmax.fz"), stress / 1.4, 1e-9);
        assert_close("area", area * 1.4, (stress / young * 0.4).exp(), 1e-12);
        assert_close("stored energy", history.last("cube.elastic_energy"), stored, 1e-9);
        assert_close("plastic work", history.last("cube.plastic_work"), plastic, 1e-9);
        let strains = run.field("increments/000001/body_cube/cell/equivalent_plastic_strain");
        assert!(strains.iter().all(|s| (s / e - 1.0).abs() < 1e-9), "{strains:?}");
        let von_mises = run.field("increments/000001/body_cube/cell/von_mises");
        assert!(von_mises.iter().all(|s| (s / (stress / (1.4 * area)) - 1.0).abs() < 1e-9), "{von_mises:?}");
    }
}

/// A sheet over rollers is bent until the force of the punch falls, which is then eased: a falling force is in equilibrium on
/// the way on, too, but what is eased springs back without flow.
#[test]
fn what_softens_springs_back() {
    let bench = Bench::new(
        r#"
        [body.sheet]
        block = { box = { size = [30.0, 1.0, 1.0] }, elements = [24, 2, 1] }
        material = "steel"
        plane_strain = true
        element = "hex8-eas"
        symmetry = ["xmin"]
        [material.steel]
        model = "j2"
        young = 70e3
        poisson = 0.3
        yield_stress = 200.0
        hardening = { linear = 600.0 }
        [tool.die]
        cylinder = { point = [15.0, -3.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 3.0 }
        [tool.punch]
        cylinder = { point = [0.0, 4.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 3.0 }
        [contact.die]
        slave = "sheet.ymin"
        master = "die"
        [contact.punch]
        slave = "sheet.ymax"
        master = "punch"
        [[step]]
        increments = 12
        move = [{ target = "punch", by = [0.0, -7.7, 0.0] }]
        [[step]]
        increments = 4
        keep = true
        force = [{ target = "punch", total = [0.0, -0.01, 0.0], directions = "y" }]
        [output]
        every = 100
        "#,
    );
    let history = bench.solve(1, &[]).history();
    let [way, force, work] = ["punch.uy", "punch.fy", "sheet.plastic_work"].map(|name| history.column(name));
    assert!(force[8] < force[11], "the force of the punch does not fall: {force:?}");
    assert_close("plastic work", history.last("sheet.plastic_work"), work[11], 1e-9);
    assert!(way[11..].is_sorted(), "{way:?}");
}

/// A roll presses a sheet with Hill's criterion, axes askew, and slides over it; two steps of so many increments.
fn dented(element: &str, by: [f64; 2], increments: usize) -> Bench {
    let [down, along] = by;
    Bench::new(&format!(
        r#"
        [body.sheet]
        block = {{ box = {{ origin = [-2.0, -1.0, 0.0], size = [4.0, 1.0, 1.0] }}, elements = [11, 3, 2] }}
        material = "steel"
        element = "{element}"
        [material.steel]
        model = "hill"
        young = 206e3
        poisson = 0.3
        yield_stress = 157.12
        hardening = {{ swift = {{ k = 565.32, n = 0.2589 }} }}
        hill = {{ f = 0.283, g = 0.358, h = 0.642, n = 1.289, x = [1.0, 0.4, 0.0], y = [0.0, 1.0, 0.0] }}
        [tool.roll]
        cylinder = {{ point = [-0.3, 1.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }}
        [contact.top]
        slave = "sheet.ymax"
        master = "roll"
        friction = 0.144
        [[step]]
        increments = {increments}
        fix = [{{ set = "sheet.ymin" }}]
        move = [{{ target = "roll", by = [0.0, {down}, 0.0] }}]
        [[step]]
        increments = {increments}
        fix = [{{ set = "sheet.ymin" }}]
        move = [{{ target = "roll", by = [{along}, 0.0, 0.0] }}]
        [output]
        every = 100
        history = ["sheet.ymin", "sheet.ymax"]
        "#
    ))
}

/// A dented block, at its yield limit and about to slip, is turned by a right angle together with the roll in it: nothing
/// happens but that.
#[test]
fn a_plastic_part_is_turned_with_its_tool() {
    let turn = |target: &str| {
        format!(
            "{{ target = \"{target}\", rotate = {{ point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], angle = 90.0 }} }}"
        )
    };
    let bench = Bench::new(&format!(
        r#"
        [body.part]
        block = {{ box = {{ size = [12.0, 10.0, 6.0] }}, elements = [6, 5, 3] }}
        material = "metal"
        [material.metal]
        model = "j2"
        young = 1000.0
        poisson = 0.3
        yield_stress = 4.0
        hardening = {{ linear = 20.0 }}
        [tool.roll]
        cylinder = {{ point = [6.0, 5.0, 9.0], axis = [0.3, 1.0, 0.0], radius = 3.0 }}
        [contact.dent]
        slave = "part.zmax"
        master = "roll"
        friction = 0.3
        [[step]]
        increments = 5
        fix = [{{ set = "part.zmin" }}]
        move = [{{ target = "roll", by = [1.0, 0.3, -1.0] }}]
        [[step]]
        increments = 9
        move = [{}, {}]
        [output]
        every = 1000
        history = ["part.zmin"]
        "#,
        turn("roll"),
        turn("part.zmin")
    ));
    let history = bench.solve(1, &[]).history();
    let dented = history.column("time").iter().position(|time| *time >= 1.0).unwrap();
    let force = |row: usize| ["fx", "fy", "fz"].map(|c| history.column(&format!("roll.{c}"))[row]);
    let [x, y, z] = force(dented);
    let turned = force(history.len() - 1);
    let errors = [turned[0] + y, turned[1] - x, turned[2] - z].map(f64::abs);
    assert_small("forces", errors.into_iter().fold(0.0, f64::max) / z.abs(), 1e-8);
    assert!(history.len() < 150, "{} increments", history.len());
}

#[test]
fn the_number_of_ranks_does_not_matter() {
    let bench = dented("hex8-fbar", [-0.06, 0.2], 6);
    let alone = bench.solve(1, &[]).history();
    assert!(alone.last("sheet.plastic_work") > 10.0 * alone.last("sheet.elastic_energy"));
    for ranks in [2, 3, 4] {
        let difference = alone.difference(&bench.solve(ranks, &[]).history());
        assert_small(&format!("{ranks} ranks"), difference, 1e-10);
    }
}

/// When the step fails as a whole, the run is the one with halves from the beginning: an attempt that failed leaves no flow.
#[test]
fn what_failed_leaves_no_flow() {
    let run = |increments| {
        let bench = dented("hex8", [-0.02, 0.0], increments);
        // The whole step takes 9 iterations, its halves 5.
        let settings = ["--set", "contact.top.friction=0", "--set", "solver.max_iterations=7"];
        bench.solve(2, &[&["--steps", "1"], settings.as_slice()].concat())
    };
    let [whole, halves, quarters] = [1, 2, 4].map(run);
    assert_eq!([&whole, &halves, &quarters].map(|r| r.summary()["cutbacks"].as_u64().unwrap()), [1, 0, 0]);
    let [cut, halves, quarters] = [whole, halves, quarters].map(|r| r.history());
    assert_eq!((cut.len(), halves.len()), (2, 2));
    let sets = ["roll", "sheet.ymin", "sheet.ymax"];
    for k in 0..2 {
        assert_small(&format!("increment {}", k + 1), cut.row_difference(k, &halves, k, &sets), 1e-9);
    }
    assert_close("plastic work", cut.last("sheet.plastic_work"), halves.last("sheet.plastic_work"), 1e-9);
    assert!(quarters.row_difference(3, &halves, 1, &sets) > 1e-4, "the way matters");
}

/// A cantilever of sheet metal, one layer of enhanced elements, bent under a roller by a third of its length: no increment is
/// cut, as it is where the enhanced strain is sought from zero. The beginning on two ranks is the same.
#[test]
fn sheet_of_one_layer_folds() {
    let scene = |increments: usize| {
        Bench::new(&format!(
            r#"
            [body.sheet]
            block = {{ box = {{ size = [30.0, 0.78, 1.0] }}, elements = [24, 1, 1] }}
            material = "steel"
            element = "hex8-eas"
            plane_strain = true
            [material.steel]
            model = "j2"
            young = 206e3
            poisson = 0.3
            hardening = {{ swift = {{ k = 565.32, n = 0.2589, e0 = 0.0071156 }} }}
            [tool.roller]
            cylinder = {{ point = [24.0, 5.78, 0.0], axis = [0.0, 0.0, 1.0], radius = 5.0 }}
            [contact.top]
            slave = "sheet.ymax"
            master = "roller"
            friction = 0.1
            [[step]]
            increments = {increments}
            fix = [{{ set = "sheet.xmin" }}]
            move = [{{ target = "roller", by = [0.0, {}, 0.0] }}]
            [output]
            every = 1000
            "#,
            -0.05 * increments as f64
        ))
    };
    let run = scene(180).solve(1, &[]);
    assert_eq!(run.summary()["cutbacks"], 0);
    let (one, two) = (run.history(), scene(10).solve(2, &[]).history());
    for (one, two) in one.column("roller.fy").iter().zip(two.column("roller.fy")) {
        assert_close("force", *two, *one, 1e-9);
    }
}

/// Simple shear of an ideally plastic block bears the yield stress over the root of 3, however large it is.
#[test]
fn large_shear_bears_the_yield_stress() {
    let bench = Bench::new(
        r#"
        body.b = { material = "m", plane_strain = true, block = { box = { size = [1.0, 1.0, 1.0] }, elements = [2, 1, 1] } }
        material.m = { model = "j2", young = 1e5, poisson = 0.3, yield_stress = 100.0 }
        [[step]]
        increments = 60
        fix = [{ set = "b.ymin" }]
        move = [{ target = "b.ymax", by = [3.0, 0.0, 0.0] }]
        [output]
        history = ["b.ymax"]
        "#,
    );
    for force in &bench.solve(2, &[]).history().column("b.ymax.fx")[2..] {
        assert_close("force", *force, 100.0 / 3f64.sqrt(), 1e-3);
    }
}

/// A flat strip pressed by 30 % with Coulomb's friction, which sticks in its middle: the force of the slab method (Hill, The
/// Mathematical Theory of Plasticity, 1950, chapter VIII, as simplified by Siebel and von Karman), with K = 2 k:
/// K (exp(2 mu x / h) - 1) h / 2 mu from the edge to where friction is k, and on with a slope of K / h.
#[test]
fn strip_between_rough_platens() {
    let bench = Bench::new(
        r#"
        [body.strip]
        material = "lead"
        plane_strain = true
        symmetry = ["xmin", "ymin"]
        block = { box = { size = [5.0, 0.5, 1.0] }, elements = [32, 4, 1] }
        [material.lead]
        model = "j2"
        young = 70e3
        poisson = 0.33
        yield_stress = 100.0
        [tool.die]
        plane = { point = [0.0, 0.5, 0.0], normal = [0.0, -1.0, 0.0] }
        [contact.top]
        slave = "strip.ymax"
        master = "die"
        friction = 0.2
        [[step]]
        increments = 30
        move = [{ target = "die", by = [0.0, -0.15, 0.0] }]
        [output]
        every = 100
        "#,
    );
    let history = bench.solve(2, &[]).history();
    let (flow, friction) = (200.0 / 3f64.sqrt(), 0.2f64);
    for (time, force) in history.column("time").iter().zip(history.column("die.fy")).filter(|(t, _)| **t > 0.3) {
        let height = 1.0 - 0.3 * time;
        let (half, slips) = (5.0 / height, height * (0.5 / friction).ln() / (2.0 * friction));
        let slipping = 0.5 * height / friction * (0.5 / friction - 1.0);
        let sticks = half - slips;
        let slab = flow * (slipping + sticks * (0.5 / friction + 0.5 * sticks / height));
        assert_close("force", -force, slab, 0.05);
    }
}

//! Several materials in one solid: groups of elements of one body's mesh, and bodies that share nodes.

mod common;

use common::{Bench, Run, assert_close, assert_small, root};
use std::fmt::Write;

/// A bar of 4 x 2 x 2 unit cubes, its elements in the groups `near` and `far` by x, `middle` between both ends, and `lower` by z;
/// ends and top.
fn deck() -> String {
    let node = |i: usize, j: usize, k: usize| 1 + i + 5 * (j + 3 * k);
    let mut deck = "*NODE\n".to_string();
    for (k, j, i) in (0..3).flat_map(|k| (0..3).flat_map(move |j| (0..5).map(move |i| (k, j, i)))) {
        let _ = writeln!(deck, "{}, {i}, {j}, {k}", node(i, j, k));
    }
    let cubes = || (0..2).flat_map(|k| (0..2).flat_map(move |j| (0..4).map(move |i| (i, j, k))));
    let number = |i: usize, j: usize, k: usize| 1 + i + 4 * (j + 2 * k);
    for (name, half) in [("near", 0), ("far", 1)] {
        let _ = writeln!(deck, "*ELEMENT, TYPE=C3D8, ELSET={name}");
        for (i, j, k) in cubes().filter(|(i, ..)| i / 2 == half) {
            let face = |k| [node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k)];
            let nodes: Vec<String> = [face(k), face(k + 1)].concat().iter().map(usize::to_string).collect();
            let _ = writeln!(deck, "{}, {}", number(i, j, k), nodes.join(", "));
        }
    }
    let group = |name: &str, is_in: &dyn Fn(&(usize, usize, usize)) -> bool| {
        let numbers: Vec<String> = cubes().filter(is_in).map(|(i, j, k)| number(i, j, k).to_string()).collect();
        format!("*ELSET, ELSET={name}\n{}\n", numbers.join(","))
    };
    deck += &(group("lower", &|(.., k)| *k == 0) + &group("middle", &|(i, ..)| (1..3).contains(i)));
    for (name, axis, at) in [("left", 0, 0), ("right", 0, 4), ("floor", 2, 0), ("top", 2, 2)] {
        let face = |(i, j, k): (usize, usize, usize)| [i, j, k][axis] == if at > 0 { at - 1 } else { 0 };
        let side = [["S6", "S4"], ["S3", "S5"], ["S1", "S2"]][axis][usize::from(at > 0)];
        let _ = writeln!(deck, "*SURFACE, NAME={name}");
        cubes().filter(|c| face(*c)).for_each(|(i, j, k)| {
            let _ = writeln!(deck, "{}, {side}", number(i, j, k));
        });
    }
    // The lower halves of both sides of the joint between `near` and `far`.
    for (name, i, side) in [("low_of_near", 1, "S4"), ("low_of_far", 2, "S6")] {
        let _ = writeln!(deck, "*SURFACE, NAME={name}\n{}, {side}\n{}, {side}", number(i, 0, 0), number(i, 1, 0));
    }
    deck
}

fn bench(body: &str, cards: &str, rest: &str) -> Bench {
    let bench = Bench::new(&format!("[body.bar]\nmesh = \"bar.inp\"\n{body}\n{cards}\n{rest}"));
    bench.write("bar.inp", &deck());
    bench
}

fn card(name: &str, model: &str, young: f64, poisson: f64) -> String {
    format!("[material.{name}]\nmodel = \"{model}\"\nyoung = {young:?}\npoisson = {poisson:?}\n")
}

const PULL: &str = "[[step]]\nincrements = 2\nfix = [{ set = \"bar.left\", directions = \"x\" }, \
                    { set = \"bar.floor\", directions = \"yz\" }]\n\
                    move = [{ target = \"bar.right\", by = [0.4, 0.0, 0.0], directions = \"x\" }]\n\
                    [output]\nhistory = [\"bar.right\"]\n";

/// P(l) = E ln l / l of a bar that does not become thinner, linear in the logarithmic strain.
fn stress(young: f64, stretch: f64) -> f64 {
    young * stretch.ln() / stretch
}

#[test]
fn halves_in_a_row_and_side_by_side() {
    let cards = card("soft", "hooke", 10.0, 0.0) + &card("hard", "hooke", 250.0, 0.0);
    let force = |group: &str, ranks: usize| {
        let body = format!("material = \"soft\"\nmaterials = {{ {group} }}");
        bench(&body, &cards, PULL).solve(ranks, &[]).history().last("bar.right.fx")
    };
    // Lengths of 2 and 2, pulled by 0.4: the stretches of equal stress.
    let hard = root(1.0, 1.2, |hard| stress(250.0, hard) - stress(10.0, 2.2 - hard));
    for ranks in [1, 2] {
        for group in ["far = \"hard\"", "near = \"hard\", far = \"soft\""] {
            assert_close(group, force(group, ranks), 4.0 * stress(250.0, hard), 1e-9);
        }
        assert_close(
            "side by side",
            force("lower = \"hard\"", ranks),
            2.0 * (stress(250.0, 1.1) + stress(10.0, 1.1)),
            1e-9,
        );
    }
}

/// A material in the middle that neither a support nor a load nor a contact touches: it bears what its neighbours pass on.
#[test]
fn what_nothing_touches_counts_by_its_neighbours() {
    let cards = card("soft", "hooke", 10.0, 0.0) + &card("hard", "hooke", 250.0, 0.0);
    let hard = root(1.0, 1.2, |hard| stress(250.0, hard) - stress(10.0, 2.2 - hard));
    for (base, middle) in [("soft", "hard"), ("hard", "soft")] {
        let body = format!("material = \"{base}\"\nmaterials = {{ middle = \"{middle}\" }}");
        for ranks in [1, 2] {
            let force = bench(&body, &cards, PULL).solve(ranks, &[]).history().last("bar.right.fx");
            assert_close(middle, force, 4.0 * stress(250.0, hard), 1e-9);
        }
    }
}

/// Each side of a joint has its own stress, up to the joint.
#[test]
fn stress_jumps_between_materials() {
    let cards = card("soft", "hooke", 10.0, 0.0) + &card("hard", "hooke", 250.0, 0.0);
    let probe = |name: &str, z: f64| {
        format!("[[output.probe]]\nname = \"{name}\"\npoint = [2.5, 0.5, {z:?}]\nfields = [\"nodal_stress\"]\n")
    };
    let scene = PULL.to_string() + &probe("hard", 0.9) + &probe("soft", 1.1);
    for ranks in [1, 2] {
        let run = bench("material = \"soft\"\nmaterials = { lower = \"hard\" }", &cards, &scene).solve(ranks, &[]);
        for (name, young) in [("hard", 250.0), ("soft", 10.0)] {
            let table = std::fs::read_to_string(run.out.join(format!("probe-{name}.csv"))).unwrap();
            let cell = |line: &str, name: &str| {
                let k = table.lines().next().unwrap().split(',').position(|column| column == name).unwrap();
                line.split(',').nth(k).unwrap().parse::<f64>().unwrap()
            };
            let last = table.lines().last().unwrap();
            assert_close(name, cell(last, "nodal_stress.xx"), stress(young, 1.1), 1e-9);
        }
    }
}

const PRESS: &str = "[tool.roller]\ncylinder = { point = [2.0, 0.0, 4.0], axis = [0, 1, 0], radius = 2.0 }\n\
                     [contact.c]\nslave = \"bar.top\"\nmaster = \"roller\"\nfriction = 0.2\n\
                     [[step]]\nincrements = 4\nfix = [{ set = \"bar.floor\" }]\n\
                     move = [{ target = \"roller\", by = [0.2, 0.0, -0.2] }]\n\
                     [output]\nhistory = [\"bar.floor\"]\n";

/// Two cards that say the same are one material, also where a tool presses and rubs.
#[test]
fn equal_materials_are_one() {
    let flow = "yield_stress = 3.0\nhardening = { linear = 20.0 }\n";
    for (model, more) in [("neo-hookean", ""), ("j2", flow)] {
        let cards = card("one", model, 100.0, 0.3) + more + &card("same", model, 100.0, 0.3) + more;
        let whole = bench("material = \"one\"", &cards, PRESS).solve(1, &[]);
        let parts = bench("material = \"one\"\nmaterials = { far = \"same\" }", &cards, PRESS);
        let run = parts.solve(1, &[]);
        for field in ["node/displacement", "cell/stress"] {
            let field = format!("increments/000004/body_bar/{field}");
            let (a, b) = (whole.field(&field), run.field(&field));
            assert!(a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-11), "{model}: {field}");
        }
        let (one, two) = (whole.history(), parts.solve(2, &[]).history());
        for name in ["roller.fx", "roller.fz"] {
            assert_close(name, two.last(name), one.last(name), 1e-10);
        }
    }
}

/// A layer as hard as steel in rubber: each material counts by its own forces, and all that acts is borne.
#[test]
fn unlike_materials_are_as_exact_as_each_alone() {
    let cards = card("rubber", "neo-hookean", 1.0, 0.49) + &card("steel", "neo-hookean", 1e5, 0.3);
    for group in ["lower", "far"] {
        let bench = bench(&format!("material = \"rubber\"\nmaterials = {{ {group} = \"steel\" }}"), &cards, PRESS);
        let (loose, tight) = (bench.solve(1, &[]), bench.solve(2, &["--set", "solver.tolerance=1e-12"]));
        let last = |run: &Run, name: &str| run.history().last(name);
        for name in ["roller.fx", "roller.fz"] {
            assert_close(name, last(&loose, name), last(&tight, name), 1e-7);
            assert_close(name, -last(&tight, &name.replace("roller", "bar.floor")), last(&tight, name), 1e-7);
        }
    }
}

/// Only what can flow does, and each material has the element that suits it.
#[test]
fn each_material_has_its_own_element_and_history() {
    let cards = card("rubber", "neo-hookean", 20.0, 0.49)
        + &card("lead", "j2", 200.0, 0.3)
        + "yield_stress = 1.0\nhardening = { linear = 20.0 }\n";
    let bench = bench("material = \"rubber\"\nmaterials = { far = \"lead\" }", &cards, PRESS);
    let check = common::nagata(&bench.path(""), 1, &["check", "scene.toml"], bench.path(""));
    let lines =
        "body `bar`: hex8-fbar, neo-hookean; no plasticity\n  its `far`: hex8-sri, elastic-plastic (von Mises)\n";
    assert!(check.stdout.contains(lines), "{}{}", check.stdout, check.stderr);
    for ranks in [1, 2] {
        let run = bench.solve(ranks, &[]);
        let strain = run.field("increments/000004/body_bar/cell/equivalent_plastic_strain");
        let flown = strain.iter().filter(|strain| **strain > 0.0).count();
        assert!(flown > 0 && flown <= 8 && strain.iter().all(|strain| strain.is_finite()), "{strain:?}");
    }
}

#[test]
fn wrong_groups_are_named() {
    let cards = card("soft", "hooke", 10.0, 0.0) + &card("hard", "hooke", 250.0, 0.0);
    for (body, what, help) in [
        (
            "materials = { fr = \"hard\" }",
            "body `bar` has no group `fr` of elements",
            "known: far, lower, middle, near",
        ),
        (
            "materials = { top = \"hard\" }",
            "body `bar` has no group `top` of elements",
            "known: far, lower, middle, near",
        ),
        ("materials = { far = \"hrd\" }", "", "hard"),
        (
            "materials = { far = \"hard\", lower = \"soft\" }",
            "in group `far` and in group `lower`",
            "share no elements",
        ),
    ] {
        let run = bench(&format!("material = \"soft\"\n{body}"), &cards, PRESS).run(2, &[]);
        assert!(run.code == 2 && run.stderr.contains(what) && run.stderr.contains(help), "{}", run.stderr);
    }
    let block = "[body.bar]\nmaterial = \"soft\"\nmaterials = { far = \"hard\" }\n\
                 block = { box = { size = [4, 2, 2] }, elements = [4, 2, 2] }\n";
    let run = Bench::new(&format!("{block}{cards}[[step]]\nincrements = 1\n")).run(1, &[]);
    assert!(run.code == 2 && run.stderr.contains("needs a mesh file"), "{}", run.stderr);
}

/// The bar as two bodies of one file, which share the nodes between them.
fn halves(cards: &str, rest: &str) -> Bench {
    let body = |name: &str, material: &str| {
        format!("[body.{name}]\nmesh = \"bar.inp\"\ngroup = \"{name}\"\nmaterial = \"{material}\"\n")
    };
    let bench = Bench::new(&format!("{}{}{cards}\n{rest}", body("near", "soft"), body("far", "hard")));
    bench.write("bar.inp", &deck());
    bench
}

/// Bodies that share nodes of their file are one solid, as materials of one body are: pulled, and pressed by a roller that rubs on
/// both or on one.
#[test]
fn bodies_that_share_nodes_are_one_solid() {
    let cards = card("soft", "neo-hookean", 50.0, 0.3)
        + &card("hard", "j2", 500.0, 0.3)
        + "yield_stress = 10.0\nhardening = { linear = 50.0 }\n";
    let whole = |rest: &str| bench("material = \"soft\"\nmaterials = { far = \"hard\" }", &cards, rest).solve(1, &[]);
    let roller = |x: f64| PRESS.replace("point = [2.0", &format!("point = [{x:?}"));
    let floor = "fix = [{ set = \"bar.floor\" }]";
    let floors = "fix = [{ set = \"near.floor\" }, { set = \"far.floor\" }]";
    let beside = roller(3.6).replace("radius = 2.0", "radius = 1.9").replace("4.0], axis", "3.9], axis");
    let contact = "[contact.c]\nslave = \"bar.top\"\nmaster = \"roller\"\nfriction = 0.2\n";
    let of = |half: &str| contact.replace("contact.c", &format!("contact.{half}")).replace("bar.", &format!("{half}."));
    for (rest, contacts) in
        [(roller(2.0), of("near") + &of("far")), (roller(2.6), of("far") + &of("near")), (beside, of("far"))]
    {
        let one = whole(&rest);
        let split = rest.replace(contact, &contacts).replace(floor, floors);
        let split = halves(&cards, &split.replace("[\"bar.floor\"]", "[\"near.floor\", \"far.floor\"]"));
        for ranks in [1, 2, 3] {
            let run = split.solve(ranks, &[]);
            assert!(
                run.log().contains("bodies `near` and `far` are one solid at 4 faces, whose nodes they share"),
                "{}",
                run.log()
            );
            for name in ["roller.fx", "roller.fz"] {
                assert_close(
                    &format!("{name}, {ranks} ranks"),
                    run.history().last(name),
                    one.history().last(name),
                    1e-8,
                );
            }
            let end = "increments/000004/body_";
            let moved = |run: &Run, body: &str| run.field(&format!("{end}{body}/node/displacement"));
            let (all, [near, far]) = (moved(&one, "bar"), ["near", "far"].map(|body| moved(&run, body)));
            let farthest = |field: &[f64]| field.iter().fold(0.0f64, |most, u| most.max(u.abs()));
            let largest = farthest(&near).max(farthest(&far));
            assert_close(&format!("displacement, {ranks} ranks"), largest, farthest(&all), 1e-8);
        }
    }
    // All that acts on one is borne by the other.
    let pull = PULL.replace("\"bar.left\"", "\"near.left\"").replace("\"bar.right\"", "\"far.right\"");
    let pull = pull.replace(
        "{ set = \"bar.floor\", directions = \"yz\" }",
        "{ set = \"near.floor\", directions = \"yz\" }, { set = \"far.floor\", directions = \"yz\" }",
    );
    let pulled = halves(&cards, &pull.replace("history = [\"far.right\"]", "history = [\"far.right\", \"near.left\"]"));
    let one = whole(PULL).history();
    for ranks in [1, 2] {
        let run = pulled.solve(ranks, &[]).history();
        assert_close("pulled", run.last("far.right.fx"), one.last("bar.right.fx"), 1e-9);
        assert_close("borne", -run.last("near.left.fx"), one.last("bar.right.fx"), 1e-9);
    }
}

/// Columns that stand beside each other, of moduli of 1 to 10, are pressed together: no stress of one is mixed with the other's, and
/// each bears its own share of what the node between them bears.
#[test]
fn stresses_of_bodies_that_share_nodes_are_their_own() {
    let cards = card("soft", "hooke", 50.0, 0.0) + &card("hard", "hooke", 500.0, 0.0);
    let all = |what: &str, rest: &str| {
        ["near", "far"].map(|body| format!("{{ {what} = \"{body}.{rest}, directions = \"z\" }}")).join(", ")
    };
    let step = format!(
        "[[step]]\nincrements = 1\nfix = [{{ set = \"near.left\", directions = \"xy\" }}, {}]\nmove = [{}]\n\
         [output]\nhistory = [\"near\", \"far\"]\nfields = [\"reaction\", \"nodal_stress\", \"stress_jump\"]\n",
        all("set", "floor\""),
        all("target", "top\", by = [0.0, 0.0, -0.02]")
    );
    for ranks in [1, 2] {
        let run = halves(&cards, &step).solve(ranks, &[]);
        let field = |body: &str, name: &str| run.field(&format!("increments/000001/body_{body}/node/{name}"));
        let stress = |body: &str| field(body, "nodal_stress").chunks_exact(6).map(|s| s[2]).collect::<Vec<_>>();
        let soft = stress("near")[0];
        assert!(soft < -0.1);
        for (body, times) in [("near", 1.0), ("far", 10.0)] {
            stress(body).iter().for_each(|s| assert_close(body, *s, times * soft, 1e-9));
            field(body, "stress_jump").iter().for_each(|jump| assert_small("jump", jump / soft, 1e-9));
            for (d, c) in ["fx", "fy", "fz"].iter().enumerate() {
                let sum: f64 = field(body, "reaction").iter().skip(d).step_by(3).sum();
                assert_small("reactions", sum - run.history().last(&format!("{body}.{c}")), 1e-9);
            }
        }
    }
}

/// A contact between a part of the faces leaves open what becomes of the rest.
#[test]
fn bodies_that_share_nodes_and_touch_are_refused_where_they_would_come_apart() {
    let cards = card("soft", "neo-hookean", 50.0, 0.3) + &card("hard", "neo-hookean", 500.0, 0.3);
    let contact = "[contact.c]\nslave = \"far.low_of_far\"\nmaster = \"near.low_of_near\"\n";
    let step = "[[step]]\nincrements = 1\nfix = [{ set = \"near.left\" }, { set = \"far.right\" }]\n";
    let run = halves(&cards, &format!("{contact}{step}")).run(2, &[]);
    let says = ["bodies `near` and `far` lie on each other with 2 faces", "share nodes of their mesh, and come apart"];
    assert!(run.code == 2 && says.iter().all(|words| run.stderr.contains(words)), "{}", run.stderr);
}

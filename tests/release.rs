//! Bodies that only tools hold, which let them go: they stay where they were, without forces, and take their shape.

mod common;

use common::{Bench, Run, assert_small};

/// A body of a block and what it is made of, with two tools and a contact for each: name, tool, slave.
fn scene(body: &str, material: &str, tools: [[&str; 3]; 2], steps: &str) -> Bench {
    let contact = |[name, tool, slave]: [&str; 3]| {
        format!("[tool.{name}]\n{tool}\n[contact.{name}]\nslave = \"b.{slave}\"\nmaster = \"{name}\"\nfriction = 0.5\n")
    };
    let tools: String = tools.map(contact).concat();
    Bench::new(&format!(
        "[body.b]\nmaterial = \"m\"\n{body}\n[material.m]\n{material}\npoisson = 0.3\n{tools}{steps}\n\
         [output]\nhistory = [\"b\"]\n"
    ))
}

const RUBBER: &str = "model = \"neo-hookean\"\nyoung = 10.0";
const FLOOR: &str = "plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }";
const BLOCK: &str = "block = { box = { size = [10.0, 10.0, 5.0] }, elements = [4, 4, 2] }";

/// All displacements of the body in the last increment.
fn displacements(run: &Run) -> Vec<[f64; 3]> {
    run.vectors(run.written(), "body.b", "displacement")
}

/// It has come to its end without more than so many cuts, and nothing bears a force there.
#[track_caller]
fn is_let_go(run: &Run, cuts: u64) {
    let (summary, history) = (run.summary(), run.history());
    assert!(summary["cutbacks"].as_u64().unwrap() <= cuts && summary["jumps"] == 0, "{}", run.log());
    for tool in ["one", "two"] {
        for component in ["fx", "fy", "fz"] {
            let forces = history.column(&format!("{tool}.{component}"));
            let most = forces.iter().fold(0.0f64, |most, force| most.max(force.abs()));
            assert!(history.last(&format!("{tool}.{component}")).abs() <= 1e-8 * most.max(1e-3), "{tool}.{component}");
        }
    }
}

/// A ring that is pressed between plates rests on a line of the lower one, on which it could roll.
#[test]
fn a_ring_springs_back_on_its_plate() {
    let body = "plane_strain = true\nelement = \"hex8-eas\"\n\
                block = { sector = { radii = [4.0, 5.0], angles = [0.0, 360.0], length = 0.5 }, elements = [2, 48, 1] }";
    let plate = |y: f64| format!("plane = {{ point = [0.0, {y:?}, 0.0], normal = [0.0, {:?}, 0.0] }}", -y.signum());
    let (lower, upper) = (plate(-5.0), plate(5.0));
    let steps = "[[step]]\nincrements = 5\nmove = [{ target = \"two\", by = [0.0, -1.0, 0.0] }]\n\
                 [[step]]\nincrements = 5\nkeep = true\nmove = [{ target = \"two\", by = [0.0, 2.0, 0.0] }]\n";
    let bench = scene(body, RUBBER, [["one", &lower, "rmax"], ["two", &upper, "rmax"]], steps);
    for ranks in [1, 2] {
        let run = bench.solve(ranks, &[]);
        is_let_go(&run, 0);
        assert!(run.log().contains("nothing holds body `b` any more"), "{}", run.log());
        for u in displacements(&run) {
            u.iter().for_each(|u| assert_small("displacement", *u, 1e-9));
        }
    }
}

/// A block that flows under a cylinder keeps its dent, and is as symmetric as that.
#[test]
fn a_dented_block_stays() {
    let material = "model = \"j2\"\nyoung = 1000.0\nyield_stress = 5.0\nhardening = { linear = 20.0 }";
    let cylinder = "cylinder = { point = [1.5, 0.0, 3.0], axis = [0.0, 1.0, 0.0], radius = 1.0 }";
    let steps = "[[step]]\nincrements = 4\nmove = [{ target = \"two\", by = [0.0, 0.0, -0.2] }]\n\
                 [[step]]\nincrements = 6\nkeep = true\nmove = [{ target = \"two\", by = [0.0, 0.0, 0.7] }]\n";
    let body = "block = { box = { size = [4.0, 1.0, 2.0] }, elements = [8, 2, 4] }";
    let run = scene(body, material, [["one", FLOOR, "zmin"], ["two", cylinder, "zmax"]], steps).solve(1, &[]);
    is_let_go(&run, 1);
    let points = run.points("body.b");
    let moved = displacements(&run);
    let mirrored = |at: &[f64; 3]| {
        let distance = |p: &[f64; 3]| (p[0] - at[0]).abs() + (p[1] + at[1] - 1.0).abs() + (p[2] - at[2]).abs();
        points.iter().position(|p| distance(p) < 1e-9).unwrap()
    };
    for (at, u) in points.iter().zip(&moved) {
        let other = moved[mirrored(at)];
        let off = [u[0] - other[0], u[1] + other[1], u[2] - other[2]];
        off.iter().for_each(|off| assert_small("symmetry", *off, 1e-7));
        assert!(at[2] > 0.0 || u[2] > -1e-9, "{u:?} below the floor");
    }
    assert!(moved.iter().any(|u| u[2] < -0.05));
}

/// Plates beside a block go away from it on both sides: nothing moves it, not even down.
#[test]
fn a_block_hovers_where_plates_leave_it() {
    let plate =
        |x: f64, normal: f64| format!("plane = {{ point = [{x:?}, 0.0, 0.0], normal = [{normal:?}, 0.0, 0.0] }}");
    let (left, right) = (plate(0.0, 1.0), plate(10.0, -1.0));
    let steps = "[[step]]\nincrements = 4\nmove = [{ target = \"two\", by = [-0.5, 0.0, 0.0] }]\n\
                 [[step]]\nincrements = 4\nkeep = true\n\
                 move = [{ target = \"one\", by = [-2.0, 0.0, 0.0] }, { target = \"two\", by = [2.0, 0.0, 0.0] }]\n";
    let run = scene(BLOCK, RUBBER, [["one", &left, "xmin"], ["two", &right, "xmax"]], steps).solve(2, &[]);
    is_let_go(&run, 0);
    let moved = displacements(&run);
    for d in [1, 2] {
        assert_small("aside", moved.iter().map(|u| u[d]).sum::<f64>() / moved.len() as f64, 1e-6);
    }
    // It has been pressed to one side, and has its shape again.
    let [first, rest @ ..] = &moved[..] else { panic!() };
    rest.iter().for_each(|u| (0..3).for_each(|d| assert_small("shape", u[d] - first[d], 1e-6)));
}

/// What is pushed along by a tool does not stay: it goes with it.
#[test]
fn what_a_tool_pushes_goes_along() {
    let plate = "plane = { point = [0.0, 0.0, 5.0], normal = [0.0, 0.0, -1.0] }";
    let steps = "[[step]]\nincrements = 4\nmove = [{ target = \"two\", by = [0.0, 0.0, -0.3] }]\n\
                 [[step]]\nincrements = 4\nkeep = true\n\
                 move = [{ target = \"one\", by = [0.0, 0.0, 0.5] }, { target = \"two\", by = [0.0, 0.0, 2.0] }]\n";
    let run = scene(BLOCK, RUBBER, [["one", FLOOR, "zmin"], ["two", plate, "zmax"]], steps).run(1, &[]);
    assert!(run.code == 0 || run.stderr.contains("holds it"), "{}", run.stderr);
    run.history().column("one.max_penetration").iter().for_each(|deep| assert_small("penetration", *deep, 1e-9));
    if run.code == 0 {
        displacements(&run).iter().for_each(|u| assert_small("along", u[2] - 0.5, 1e-6));
    }
}

/// Plates, a soft one among stiff ones, are pressed on each other and sheared, and let go by the uppermost: those between lie where
/// they were, without forces, and are named.
#[test]
fn a_stack_is_let_go() {
    let body = |name: &str, material: &str, [x, z, edge]: [f64; 3], elements: [u32; 3]| {
        format!(
            "[body.{name}]\nmaterial = \"{material}\"\n\
             block = {{ box = {{ origin = [{x:?}, {x:?}, {z:?}], size = [{edge:?}, {edge:?}, 1.0] }}, elements = {elements:?} }}\n"
        )
    };
    let bodies = [
        body("a", "stiff", [0.0, 0.0, 4.0], [4, 4, 2]),
        body("b", "soft", [0.5, 1.0, 3.0], [7, 7, 3]),
        body("c", "stiff", [0.0, 2.0, 4.0], [5, 5, 2]),
        body("d", "stiff", [1.0, 3.0, 2.0], [5, 5, 3]),
    ];
    let contact = |slave: &str, master: &str| {
        let name = [&slave[..1], &master[..1]].concat();
        format!("[contact.{name}]\nslave = \"{slave}\"\nmaster = \"{master}\"\nfriction = 0.3\n")
    };
    let contacts = [contact("b.zmin", "a.zmax"), contact("b.zmax", "c.zmin"), contact("d.zmin", "c.zmax")];
    let step = |by: [f64; 3]| {
        format!(
            "[[step]]\nincrements = 5\nfix = [{{ set = \"a.zmin\" }}]\nmove = [{{ target = \"d.zmax\", by = {by:?} }}]\n"
        )
    };
    let steps = [step([0.0, 0.0, -0.2]), step([0.05, 0.0, 0.0]), step([0.0, 0.0, 0.3]), step([0.3, 0.0, 0.3])];
    let bench = Bench::new(&format!(
        "{}[material.stiff]\nmodel = \"hooke\"\nyoung = 2e5\npoisson = 0.3\n\
         [material.soft]\nmodel = \"neo-hookean\"\nyoung = 10.0\npoisson = 0.45\n{}{}\
         [output]\nhistory = [\"a.zmin\", \"d.zmax\", \"b\", \"c\"]\n",
        bodies.concat(),
        contacts.concat(),
        steps.concat()
    ));
    let run = bench.solve(2, &[]);
    let (summary, history) = (run.summary(), run.history());
    assert!(summary["cutbacks"].as_u64().unwrap() <= 3, "{}", run.log());
    for body in ["b", "c"] {
        assert!(run.log().contains(&format!("nothing holds body `{body}` any more")), "{}", run.log());
        assert_small("aside", history.last(&format!("{body}.uy")), 1e-6);
        let column = history.column(&format!("{body}.ux"));
        let before = column[column.len() - 6];
        assert_small("moved", history.last(&format!("{body}.ux")) - before, 1e-9);
    }
    for contact in ["ba", "bc", "dc"] {
        for component in ["fx", "fy", "fz"] {
            let forces = history.column(&format!("{contact}.{component}"));
            let most =
                history.column(&format!("{contact}.fz")).iter().fold(0.0f64, |most, force| most.max(force.abs()));
            assert_small("force", forces[forces.len() - 1] / most, 1e-8);
        }
    }
}

/// The floor of what has been let go rises and goes aside, and would push it, against nothing, where the friction of forces that are
/// none takes it: that is no result.
#[test]
fn what_was_let_go_is_not_carried_through_a_step() {
    let plate = "plane = { point = [0.0, 0.0, 5.0], normal = [0.0, 0.0, -1.0] }";
    let steps = "[[step]]\nincrements = 3\nmove = [{ target = \"two\", by = [0.0, 0.0, -0.3] }]\n\
                 [[step]]\nincrements = 4\nkeep = true\nmove = [{ target = \"two\", by = [0.0, 0.0, 3.0] }]\n\
                 [[step]]\nname = \"shake\"\nincrement = { initial = 0.2, min = 0.05 }\nkeep = true\n\
                 move = [{ target = \"one\", by = [1.0, 0.0, 0.5] }]\n";
    let run = scene(BLOCK, RUBBER, [["one", FLOOR, "zmin"], ["two", plate, "zmax"]], steps).run(2, &[]);
    assert!(run.code == 1 && run.stderr.contains("step `shake`") && run.stderr.contains("holds it"), "{}", run.stderr);
    let told = |step: &str| run.log().matches(&format!("step `{step}`: nothing holds body `b` any more")).count();
    assert!(told("step 2") == 1 && told("shake") <= 1, "{}", run.log());
    // Nor is it by jumps.
    for column in ["b.ux", "b.uz"] {
        assert_small("carried", run.history().last(column), 1e-3);
    }
}

/// A sheet is bent into a die by a punch, which goes up again: it has nothing that pulls, and the sheet stays where it was let go,
/// though at last a node touches the punch.
#[test]
fn a_punch_does_not_lift_what_it_has_bent() {
    let run = Bench::new(
        r#"
[body.s]
material = "m"
plane_strain = true
symmetry = ["xmin"]
block = { box = { size = [25.0, 1.0, 1.0] }, elements = [50, 3, 1] }
[material.m]
model = "j2"
young = 2e5
poisson = 0.3
yield_stress = 250.0
hardening = { linear = 1000.0 }
[tool.punch.profile]
points = [[-20.0, 21.0], [0.0, 1.0], [20.0, 21.0]]
fillets = [0.0, 2.0, 0.0]
[tool.die.profile]
points = [[60.0, 0.0], [20.0, 0.0], [0.0, -20.0]]
fillets = [0.0, 2.0, 0.0]
[contact.p]
slave = "s.ymax"
master = "punch"
[contact.d]
slave = "s.ymin"
master = "die"
[[step]]
increment = { initial = 0.01, max = 0.01, min = 1e-6 }
move = [{ target = "punch", by = [0.0, -19.6, 0.0] }]
[[step]]
increments = 30
fix = [{ set = "s.xmin", directions = "x" }]
move = [{ target = "punch", by = [0.0, 10.0, 0.0] }]
[output]
every = 1000
history = ["s"]
"#,
    )
    .solve(1, &[]);
    let history = run.history();
    assert!(run.log().contains("nothing holds body `s` any more"), "{}", run.log());
    let heights = history.column("s.uy");
    let last = |tool: &str| history.column(&format!("{tool}.fy")).iter().rposition(|force| force.abs() > 1e-6).unwrap();
    let let_go = last("punch").max(last("die")) + 1;
    assert!(history.column("punch.uy")[let_go] < -19.0);
    assert_small("lifted", heights[heights.len() - 1] - heights[let_go], 1e-3);
}

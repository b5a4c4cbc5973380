//! Conditions that leave something free, hold too much, or are forgotten; runs that disturb each other.

use crate::case::{Case, Outcome, nagata};
use crate::oracle::{balance, near, same, value};
use crate::scenes::{BAR, METHODS, SLAB, bar_force, bar_stretch, sphere};
use std::path::Path;

family!(
    held_slave_nodes,
    nothing_holds,
    shared_nodes,
    elements_that_lock,
    soft_beside_preloaded,
    forces,
    folders,
    held_by_contact,
    cantilever,
    without_contact,
    names,
    warnings,
    memory
);

/// Slave nodes with no free direction.
fn held_slave_nodes() -> Vec<Case> {
    let fix = |set: &str| {
        SLAB.replace("fix = [{ set = \"b.zmin\" }]", &format!("fix = [{{ set = \"b.zmin\" }}, {{ set = \"{set}\" }}]"))
    };
    vec![
        Case::text("top fixed", fix("b.zmax")).must_be_refused(&[]),
        Case::text("a side fixed", fix("b.xmin")).must_be_refused(&[]),
        Case::text(
            "moved into the tool",
            SLAB.replace("target = \"t\", by = [0.0, 0.0, -0.2]", "target = \"b.zmax\", by = [0.0, 0.0, 0.3]"),
        )
        .must_be_refused(&[]),
        Case::text("the body fixed", fix("b")).must_be_refused(&[]),
        Case::text(
            "held along z only",
            SLAB.replace(
                "fix = [{ set = \"b.zmin\" }]",
                "fix = [{ set = \"b.zmin\" }, { set = \"b.zmax\", directions = \"z\" }]",
            ),
        )
        .must_be_refused(&[]),
    ]
}

/// Bodies that nothing holds in some direction.
fn nothing_holds() -> Vec<Case> {
    let forgotten = SLAB.replace("fix = [{ set = \"b.zmin\" }]\n", "");
    let (first, last) = SLAB.rsplit_once("fix = [{ set = \"b.zmin\" }]\n").unwrap();
    let later = format!("{first}{last}");
    let between = SLAB.replace("[contact.c]", "[tool.lo]\nplane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }\n[contact.lo]\nslave = \"b.zmin\"\nmaster = \"lo\"\nfriction = 0.0\n[contact.c]").replace("fix = [{ set = \"b.zmin\" }]\n", "");
    let smooth = |case: Case| case.set("contact.c.friction=0.0");
    let steps = "name = \"press\"\nincrements = 2\nmove = [{ target = \"t\", by = [0.0, 0.0, -0.2] }]\n";
    let only_press = |text: &str| {
        let (head, _) = text.split_once("[[step]]").unwrap();
        format!("{head}[[step]]\n{steps}[output]\nevery = 1000\nhistory = [\"b.zmin\", \"b.zmax\"]\n")
    };
    vec![
        Case::text("no fix, friction", forgotten.as_str()).must_be_refused(&[]),
        smooth(Case::text("no fix, smooth", forgotten.as_str())).must_be_refused(&[]),
        Case::text("no fix in the second step", later.as_str()).must_be_refused(&[]),
        smooth(Case::text("no fix in the second step, smooth", later.as_str())).must_be_refused(&[]),
        // Between two smooth planes: refused, or kept in its place.
        smooth(Case::text("between smooth planes", only_press(&between)))
            .oracle(balance(&["t", "lo"], 1e-8))
            .oracle(near("b.zmin.ux", 0.0, 4.0, 1e-6, "no drift"))
            .oracle(near("b.zmin.uy", 0.0, 4.0, 1e-6, "no drift")),
        Case::text("no step holds anything, no contact touches", only_press(SLAB))
            .set("tool.t.plane.point=[0, 0, 3]")
            .must_be_refused(&[]),
    ]
}

/// Two bodies of one mesh that share nodes are one solid.
fn shared_nodes() -> Vec<Case> {
    let deck = crate::common::deck([2, 2, 4])
        + "*ELSET, ELSET=low, GENERATE\n101, 108, 1\n*ELSET, ELSET=high, GENERATE\n109, 116, 1\n";
    let scene = |low: &str, high: &str| {
        format!(
            r#"[body.low]
mesh = "two.inp"
{low}
material = "m"
element = "hex8"
[body.high]
mesh = "two.inp"
{high}
material = "m"
element = "hex8"
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[[step]]
increments = 2
fix = [{{ set = "low.bottom" }}]
move = [{{ target = "high.top", by = [0.0, 0.0, 0.4] }}]
[output]
every = 1000
history = ["low.bottom", "high.top"]
"#
        )
    };
    let case = |name: &str, text: String| Case::text(name, text).file("two.inp", deck.as_str());
    let halves = scene("group = \"low\"", "group = \"high\"");
    let (one, _) = halves.split_once("[body.high]").unwrap();
    let (_, rest) = halves.split_once("[material.m]").unwrap();
    let one = format!("{}[material.m]{}", one.replace("group = \"low\"", ""), rest.replace("high.top", "low.top"));
    let whole = same("low.bottom.fz", case("one body", one), 1e-8, "one body");
    vec![
        case("one solid", halves).oracle(whole).oracle(balance(&["low.bottom", "high.top"], 1e-8)).must_run(),
        case("the whole mesh twice", scene("", "")).must_be_refused(&[]),
    ]
}

/// nu = 0.495 and no `element`.
fn elements_that_lock() -> Vec<Case> {
    let text = |mesh: &str| {
        format!(
            r#"[body.block]
material = "rubber"
{mesh}
[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.495
[tool.cap]
sphere = {{ center = [0.0, 0.0, 40.0], radius = 20.0 }}
[contact.top]
slave = "block.zmax"
master = "cap"
[[step]]
increments = 2
fix = [{{ set = "block.zmin" }}]
move = [{{ target = "cap", by = [0.0, 0.0, -2.0] }}]
[output]
every = 1000
history = ["block.zmin"]
"#
        )
    };
    let blocks = "block = { box = { origin = [-20.0, -20.0, 0.0], size = [40.0, 40.0, 20.0] }, elements = [8, 8, 4] }";
    let fine = Case::text("fine", text(blocks)).set("body.block.element=hex8-fbar");
    let tets = crate::common::msh::block([8, 8, 4], true, |[x, y, z]| [40.0 * x - 20.0, 40.0 * y - 20.0, 20.0 * z]);
    let locking: &[&str] = &["lock"];
    vec![
        Case::text("hexahedra", text(blocks)).oracle(same("cap.fz", fine.clone(), 0.05, "hex8-fbar")).or_warns(locking),
        Case::text("tetrahedra", text("mesh = \"block.msh\""))
            .file("block.msh", tets)
            .oracle(same("cap.fz", fine, 0.05, "hex8-fbar"))
            .or_warns(locking),
    ]
}

/// A bar of E = 1 beside one of E = 1e9 and more that is pressed by 0.4 first.
fn soft_beside_preloaded() -> Vec<Case> {
    let bar = |name: &str, x: f64| {
        format!(
            r#"[body.{name}]
material = "{name}"
element = "hex8"
symmetry = ["xmin", "ymin", "zmin"]
block = {{ box = {{ origin = [{x:?}, 0.0, 0.0], size = [2.0, 2.0, 2.0] }}, elements = [2, 2, 2] }}
[tool.p{name}]
plane = {{ point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }}
[contact.c{name}]
slave = "{name}.zmax"
master = "p{name}"
"#
        )
    };
    let material = |name: &str, model: &str, young: f64| {
        format!("[material.{name}]\nmodel = \"{model}\"\nyoung = {young:?}\npoisson = 0.3\n")
    };
    let mut cases = Vec::new();
    for ratio in [1e3, 1e6, 1e9, 1e12] {
        let text = bar("soft", 0.0)
            + &bar("stiff", 10.0)
            + &material("soft", "hooke", 1.0)
            + &material("stiff", "hooke", ratio)
            + "[[step]]\nname = \"preload\"\nincrements = 2\nmove = [{ target = \"pstiff\", by = [0.0, 0.0, -0.4] }]\n"
            + "[[step]]\nname = \"press\"\nincrements = 2\nmove = [{ target = \"psoft\", by = [0.0, 0.0, -0.4] }]\n"
            + "[output]\nevery = 1000\nhistory = [\"soft.zmin\"]\n";
        cases.push(
            Case::text(format!("1 to {ratio:e}"), text)
                .oracle(value("psoft.fz", bar_force(1.0, 4.0, 0.8), 1e-6, "closed form"))
                .oracle(value("pstiff.fz", bar_force(ratio, 4.0, 0.8), 1e-6, "closed form")),
        );
    }
    cases
}

/// Tools that a force drives.
fn forces() -> Vec<Case> {
    let bar = |total: &str| {
        BAR.replace(
            "move = [{ target = \"p\", by = [0.0, 0.0, -0.4] }]",
            &format!("force = [{{ target = \"p\", total = [0.0, 0.0, {total}], directions = \"z\" }}]"),
        )
    };
    let (head, _) = BAR.split_once("[[step]]").unwrap();
    let force = |name: &str, total: f64, n: usize| {
        format!(
            "[[step]]\nname = \"{name}\"\nincrements = {n}\nforce = [{{ target = \"p\", total = [0.0, 0.0, {total:?}], directions = \"z\" }}]\n"
        )
    };
    let eased = format!(
        "{head}{}{}[output]\nevery = 1000\nhistory = [\"b.zmin\", \"b.zmax\"]\n",
        force("press", -1e6, 10),
        force("ease", -1.0, 10)
    );
    let mut cases = vec![
        Case::text("pulls away", bar("10.0")).must_be_refused(&[]).limit(60),
        Case::text(
            "pulls away later",
            format!(
                "{head}{}{}[output]\nevery = 1000\nhistory = [\"b.zmin\"]\n",
                force("press", -2.0, 2),
                force("pull", 1.0, 2)
            ),
        )
        .must_be_refused(&[])
        .limit(60),
        Case::text("of nothing", bar("0.0")).oracle(near("p.uz", 0.0, 2.0, 1e-9, "closed form")).limit(60),
        Case::text("across a gap of 0.1", bar("-2.0")).set("tool.p.plane.point=[0, 0, 2.1]").oracle(value(
            "p.uz",
            -0.1 - 2.0 * (1.0 - bar_stretch(10.0, 4.0, -2.0)),
            1e-6,
            "closed form",
        )),
        Case::text("beyond what the bar bears", bar("-1e12")).must_be_refused(&[]).limit(60),
    ];
    for method in crate::scenes::METHODS {
        // The penalty is a share of the stiffness of a node: the plate sinks in by as much of what it presses.
        let tolerance = if method == "penalty" { 5e-2 } else { 1e-4 };
        for young in ["1e6", "1e9"] {
            cases.push(
                Case::text(format!("1e6 eased to 1, E = {young}, {method}"), eased.as_str())
                    .set(format!("material.m.young={young}"))
                    .set(format!("contact.c.method={method}"))
                    .oracle(value(
                        "p.uz@press",
                        2.0 * (bar_stretch(young.parse().unwrap(), 4.0, -1e6) - 1.0),
                        tolerance,
                        "closed form",
                    ))
                    .oracle(value(
                        "p.uz",
                        2.0 * (bar_stretch(young.parse().unwrap(), 4.0, -1.0) - 1.0),
                        tolerance,
                        "closed form",
                    )),
            );
        }
        cases.push(
            Case::text(format!("2, {method}"), bar("-2.0"))
                .set(format!("contact.c.method={method}"))
                .oracle(value("p.uz", 2.0 * (bar_stretch(10.0, 4.0, -2.0) - 1.0), tolerance, "closed form"))
                .must_run(),
        );
    }
    cases
}

/// Two runs into one folder; a saved scene into its own.
fn folders() -> Vec<Case> {
    vec![
        Case::act("two runs at once", "the first has all rows, the second another reason", |folder| {
            std::fs::write(folder.join("scene.toml"), SLAB).unwrap();
            let scene = |sub: &str| -> Vec<String> {
                let _ = std::fs::create_dir_all(folder.join(sub));
                ["run", "../scene.toml", "--out", "../out", "--set", "step.draw.increments=200"]
                    .map(String::from)
                    .into()
            };
            let first = scene("a");
            let second = scene("b");
            std::thread::scope(|scope| {
                let path = folder.join("a");
                let run = scope.spawn(move || nagata(&path, 1, &first, 120));
                let rows =
                    || std::fs::read_to_string(folder.join("out/history.csv")).map_or(0, |text| text.lines().count());
                while rows() < 4 && !run.is_finished() {
                    std::thread::sleep(std::time::Duration::from_millis(2));
                }
                let (code, _, _, said) = nagata(&folder.join("b"), 1, &second, 120);
                let (first, _, _, why) = run.join().unwrap();
                let rows = rows();
                match (first, code) {
                    (Some(0), Some(2 | 3)) if rows == 203 && !said.is_empty() => {
                        Outcome::Refused(said.trim().replace('\n', " "))
                    }
                    (Some(0), _) if rows != 203 => Outcome::Wrong(format!("exit code 0 with {rows} of 203 lines")),
                    (Some(0), Some(0)) => Outcome::Wrong("both end with exit code 0".into()),
                    _ => Outcome::Crash(format!("exit codes {first:?}, {code:?}: {why}")),
                }
            })
        }),
        Case::act("a saved scene into its own folder", "all rows, or the first results kept", |folder| {
            std::fs::write(folder.join("scene.toml"), SLAB).unwrap();
            let run = |scene: &str| {
                let arguments = ["run", scene, "--out", "out"].map(String::from);
                let (code, _, _, why) = nagata(folder, 1, &arguments, 120);
                let rows =
                    std::fs::read_to_string(folder.join("out/history.csv")).map_or(0, |text| text.lines().count());
                (code, rows, why.trim().replace('\n', " "))
            };
            let first = run("scene.toml");
            match (first.0, run("out/scene.toml")) {
                (Some(0), (Some(0), 7, _)) => Outcome::Right("all rows".into()),
                (Some(0), (Some(2), 7, why)) => Outcome::Refused(why),
                (_, (code, rows, why)) => Outcome::Wrong(format!("exit code {code:?}, {rows} of 7 lines left: {why}")),
            }
        }),
    ]
}

/// Blocks that only tools hold.
fn held_by_contact() -> Vec<Case> {
    let block = |load: &str, friction: f64, gap: f64| {
        format!(
            r#"[body.b]
material = "m"
element = "hex8"
block = {{ box = {{ size = [2.0, 2.0, 2.0] }}, elements = [2, 2, 2] }}
[material.m]
model = "hooke"
young = 10.0
poisson = 0.3
[tool.lo]
plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }}
[tool.up]
plane = {{ point = [0.0, 0.0, {:?}], normal = [0.0, 0.0, -1.0] }}
[contact.lo]
slave = "b.zmin"
master = "lo"
friction = {friction:?}
[contact.up]
slave = "b.zmax"
master = "up"
friction = {friction:?}
[[step]]
name = "press"
increments = 2
{load}
[output]
every = 1000
history = ["b"]
"#,
            2.0 + gap
        )
    };
    let press = "force = [{ target = \"up\", total = [0.0, 0.0, -2.0], directions = \"z\" }]";
    let down = "move = [{ target = \"up\", by = [0.0, 0.0, -0.2] }]";
    let mut cases = Vec::new();
    for gap in [0.0, 1e-9, 1e-6, 1e-3, 0.1] {
        for method in METHODS {
            let case = Case::text(format!("pressed by 2, gap {gap:e}, {method}"), block(press, 0.3, gap))
                .set(format!("contact.lo.method={method}"))
                .set(format!("contact.up.method={method}"))
                .oracle(value("lo.fz", 2.0, 1e-6, "the force"))
                .oracle(balance(&["lo", "up"], 1e-6));
            cases.push(if gap < 1e-4 { case.must_run() } else { case });
        }
        cases.push(
            Case::text(format!("pressed by 0.2, gap {gap:e}"), block(down, 0.3, gap))
                .oracle(value("lo.fz/up.fz", -1.0, 1e-6, "balance"))
                .oracle(
                    // Between the bar that slips at both ends and the one that is held.
                    near("up.fz", -5.0, 5.0, 0.6, "a bar of E = 10"),
                ),
        );
    }
    // Drawn up by friction alone, between two jaws.
    cases.push(
        Case::text("carried by two jaws", block(down, 0.5, 0.0) + "")
            .set("step.press.move.0.by=[0, 0, -0.4]")
            .oracle(balance(&["lo", "up"], 1e-6)),
    );
    let jaws = block(down, 0.5, 0.0).replace("[output]", "[[step]]\nname = \"lift\"\nincrements = 4\nmove = [{ target = \"lo\", by = [0.0, 3.0, 0.0] }, { target = \"up\", by = [0.0, 3.0, 0.0] }]\n[output]");
    cases.push(Case::text("carried by two jaws by 3", jaws.as_str()).oracle(value("b.uy", 3.0, 1e-4, "rigid motion")));
    cases.push(
        Case::text("carried by two jaws by 3, in one increment", jaws).set("step.lift.increments=1").oracle(value(
            "b.uy",
            3.0,
            1e-4,
            "rigid motion",
        )),
    );
    cases
}

/// A smooth roller bends a cantilever: on one rank and on two.
fn cantilever() -> Vec<Case> {
    let scene = r#"[body.b]
material = "m"
element = "hex8-eas"
plane_strain = true
block = { box = { size = [10.0, 0.5, 1.0] }, elements = [20, 1, 1] }
[material.m]
model = "hooke"
young = 1000.0
poisson = 0.3
[tool.r]
cylinder = { point = [8.0, 1.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 0.5 }
[contact.c]
slave = "b.ymax"
master = "r"
[[step]]
increments = 20
fix = [{ set = "b.xmin" }]
move = [{ target = "r", by = [0.0, -1.0, 0.0] }]
[output]
every = 1000
history = ["b.xmin", "b.xmax"]
"#;
    // The deflection of an eighth of the length is no longer small: 3 E' I d / a^3 to 5 %.
    let beam = -3.0 * (1000.0 / 0.91) * (0.125 / 12.0) / 512.0;
    let case = |name: &str| {
        Case::text(name, scene)
            .oracle(value("r.fy", beam, 0.1, "3 E I d / a^3"))
            .oracle(balance(&["r", "b.xmin"], 1e-8))
            .must_run()
    };
    vec![case("1 rank"), case("2 ranks").ranks(2), case("3 ranks").ranks(3)]
}

/// What `--quiet` must not hide.
fn warnings() -> Vec<Case> {
    vec![Case::act("--quiet", "the warnings of a run without it", |folder| {
        // The slave is the stiffer one: against the guidance.
        std::fs::write(folder.join("scene.toml"), crate::scenes::STACK).unwrap();
        let run = |quiet: bool| {
            let mut arguments =
                ["run", "scene.toml", "--out", "out", "--set", "material.a.young=1e4"].map(String::from).to_vec();
            arguments.extend(quiet.then(|| "--quiet".to_string()));
            let (_, _, said, failed) = nagata(folder, 1, &arguments, 120);
            said.lines()
                .chain(failed.lines())
                .filter_map(|line| line.split_once("warning: "))
                .map(|(_, what)| what.trim().to_string())
                .collect::<Vec<_>>()
        };
        let (loud, quiet) = (run(false), run(true));
        match () {
            () if loud.is_empty() => Outcome::Failed("no warning that could be hidden".into()),
            () if loud == quiet => Outcome::Right(format!("{} warnings", loud.len())),
            () => Outcome::Wrong(format!("{} of {} warnings", quiet.len(), loud.len())),
        }
    })]
}

/// Too little memory: an end with a reason that names it.
fn memory() -> Vec<Case> {
    fn limited(folder: &Path, megabytes: u64) -> Outcome {
        let scene = sphere("", [16, 16, 8], 2, 2);
        let _ = scene;
        let input = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/sphere-on-block.toml");
        let run = crate::common::mpirun_within(120, 2, Path::new("prlimit"))
            .args([&format!("--as={}", megabytes << 20), env!("CARGO_BIN_EXE_nagata"), "run", input.to_str().unwrap()])
            .args(["--out", "out", "--set", "body.block.block.elements=[16, 16, 8]"])
            .current_dir(folder)
            .output();
        let run = run.unwrap();
        let why = String::from_utf8_lossy(&run.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
        let why: String = why.chars().take(150).collect();
        match run.status.code() {
            Some(0) => Outcome::Right("enough".into()),
            Some(110 | 124) => Outcome::Hang("stopped after 120 s".into()),
            Some(1) => Outcome::Failed(format!("taken for non-convergence: {why}")),
            _ if why.contains("memory") => Outcome::Refused(why),
            code => Outcome::Crash(format!("exit code {code:?}: {why}")),
        }
    }
    vec![
        Case::act("350 MB a rank", "an end that names memory", |folder| limited(folder, 350)).slow(),
        Case::act("500 MB a rank", "an end that names memory", |folder| limited(folder, 500)).slow(),
    ]
}

/// Tools that never touch, and contact that has ended where it was to act.
fn without_contact() -> Vec<Case> {
    let said: &[&str] = &["touch", "no force", "zero force", "never"];
    let (head, _) = BAR.split_once("[[step]]").unwrap();
    let steps = |by: &str| {
        format!("{head}[[step]]\nincrements = 2\nmove = [{{ target = \"p\", by = {by} }}]\n[output]\nevery = 1000\n")
    };
    vec![
        Case::text("a tool that stops above the bar", steps("[0, 0, -0.4]")).set("tool.p.plane.point=[0, 0, 3]"),
        Case::text("a tool that goes up", steps("[0, 0, 0.4]")),
        Case::text("a tool that goes past", steps("[9, 0, -0.4]"))
            .set("tool.p={ sphere = { center = [20.0, 0.0, 3.0], radius = 1.0 } }"),
    ]
    .into_iter()
    .map(|case| case.must_be_refused(&[]).or_warns(said))
    .collect()
}

/// Names that libraries stumble over, and decks with more than what is taken.
fn names() -> Vec<Case> {
    let deck = crate::common::deck([2, 2, 2]) + "*ELSET, ELSET=all, GENERATE\n101, 108, 1\n";
    let (_, rest) = BAR.split_once("[material.m]").unwrap();
    let scene = format!(
        "[body.b]\nmesh = \"b.inp\"\ngroup = \"all\"\nmaterial = \"m\"\nelement = \"hex8\"\n[material.m]{rest}"
    )
    .replace(
        "increments = 2",
        "increments = 2\nfix = [{ set = \"b.bottom\", directions = \"z\" }, { set = \"b.edge\", directions = \"xy\" }]",
    )
    .replace("b.zmax\"\nmaster", "b.top\"\nmaster")
    .replace("history = [\"b.zmin\", \"b.zmax\"]", "history = [\"b.bottom\"]");
    let with = |name: &str, more: &str| {
        Case::text(name, scene.as_str())
            .file("b.inp", format!("{deck}{more}"))
            .oracle(value("p.fz/b.bottom.fz", -1.0, 1e-8, "balance"))
            .must_run()
    };
    vec![
        with("a deck", ""),
        with("a deck with a reference node", "*NODE, NSET=ref\n900, 5.0, 5.0, 5.0\n"),
        with(
            "a deck with a spring and a mass",
            "*NODE\n900, 5.0, 5.0, 5.0\n*ELEMENT, TYPE=MASS, ELSET=mass\n900, 900\n*ELEMENT, TYPE=SPRINGA, ELSET=spring\n901, 900, 1\n",
        ),
        Case::act("--out with a colon", "results, or a reason", |folder| {
            std::fs::write(folder.join("scene.toml"), BAR).unwrap();
            let arguments = ["run", "scene.toml", "--out", "a:b"].map(String::from);
            let (code, _, _, why) = nagata(folder, 1, &arguments, 120);
            match (code, folder.join("a:b/fields.h5").exists()) {
                (Some(0), true) => Outcome::Right("results".into()),
                (Some(2), _) => Outcome::Refused(why.trim().replace('\n', " ")),
                _ => Outcome::Crash(format!("exit code {code:?}: {}", why.trim().replace('\n', " "))),
            }
        }),
    ]
}

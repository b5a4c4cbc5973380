//! What a user sees of a scene: the messages in full, the defaults, and overrides.

use super::*;
use std::path::Path;

const SCENE: &str = r#"title = "Test"

[body.slab]
mesh = "slab.msh"
material = "rubber"

[material.rubber]
model = "neo-hookean"
young = 689.6
poisson = 0.32

[material.steel]
model = "hooke"
young = 210000
poisson = 0.3

[tool.indenter]
mesh = "sub/indenter.msh"

[tool.floor]
plane = { point = [0, 0, 0], normal = [0, 0, 2] }

[contact.top]
slave = "slab.top"
master = "indenter"

[[step]]
name = "press"
increments = 20
fix = [ { set = "slab.bottom" }, { set = "slab.sides", directions = "z" } ]
move = [ { target = "indenter", by = [0.0, -10.0, 0.0] } ]

[[step]]
increment = { max = 0.05 }
"#;

fn read(text: &str, overrides: &[&str]) -> crate::error::Result<Scene> {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    parse("in/test.toml", text, Path::new("in"), &overrides)
}

/// The message for the scene with one piece of its text replaced.
#[track_caller]
fn message(old: &str, new: &str) -> String {
    assert!(SCENE.contains(old), "no {old:?} in the scene");
    refusal(read(&SCENE.replacen(old, new, 1), &[]))
}

/// The message for the scene with an override.
#[track_caller]
fn message_set(set: &str) -> String {
    refusal(read(SCENE, &[set]))
}

#[track_caller]
fn refusal(result: crate::error::Result<Scene>) -> String {
    let error = result.map(|scene| scene.text).expect_err("the scene was accepted");
    assert_eq!(error.exit_code(), 2);
    error.to_string()
}

#[track_caller]
fn scene(overrides: &[&str]) -> Scene {
    read(SCENE, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The scene without its text and the places in it, its mesh files relative to the working directory.
fn content(scene: &Scene) -> String {
    let scene = Scene { text: String::new(), ..scene.clone() };
    let debug = format!("{scene:#?}").replace(&format!("{}/", std::env::current_dir().unwrap().display()), "");
    let place = |line: &&str| !["line:", "column:", "file:", "text:"].iter().any(|key| line.trim().starts_with(key));
    debug.lines().filter(place).collect::<Vec<_>>().join("\n")
}

/// The message but for its place in the file, for errors of which only the reason matters.
#[track_caller]
fn reason(old: &str, new: &str) -> String {
    message(old, new).lines().next().and_then(|line| line.splitn(4, ':').nth(3)).unwrap_or_default().trim().to_string()
}

#[test]
fn defaults_fill_what_is_not_given() {
    let scene = scene(&[]);
    assert_eq!((scene.name.as_str(), scene.title.as_str()), ("test", "Test"));
    let body = &scene.bodies[0];
    assert_eq!((body.name.at.line, body.name.at.column), (3, 7));
    assert!(body.element.is_none() && body.reduction.is_none());
    let MeshSource::File { path, group: None } = &body.mesh else { panic!("{:?}", body.mesh) };
    assert_eq!(path.value, Path::new("in/slab.msh"));
    assert_eq!(scene.materials[1].model, MaterialModel::Hooke { young: 210000.0, poisson: 0.3 });
    let [indenter, floor] = &scene.tools[..] else { panic!("{:?}", scene.tools) };
    let Some(ToolMesh { source: MeshSource::File { path, .. }, normals, sharp, symmetry, .. }) = &indenter.mesh else {
        panic!("{indenter:?}")
    };
    assert_eq!(path.value, Path::new("in/sub/indenter.msh"));
    assert_eq!((indenter.smoothing.value, indenter.feature_angle), (Description::Mesh(Smoothing::Nagata), 40.0));
    assert!(!indenter.flip && sharp.is_empty() && symmetry.is_empty());
    assert!(matches!(normals, NormalSource::Facets(Weight::Sine)));
    assert_eq!(floor.smoothing.value, Description::Plane);
    let Shape::Plane { normal, .. } = floor.shapes[0] else { panic!("{floor:?}") };
    assert_eq!(normal, Vec3::z());
    let contact = &scene.contacts[0];
    assert_eq!((contact.friction, contact.penalty, contact.reach), (0.0, None, None));
    assert_eq!((scene.output.every, scene.output.history.len()), (1, 0));
    assert_eq!((scene.solver.tolerance, scene.solver.max_iterations), (1e-10, 15));
    assert!(scene.solver.force_floor.is_none());
    let [press, second] = &scene.steps[..] else { panic!("{:?}", scene.steps) };
    assert_eq!((press.name.value.as_str(), second.name.value.as_str()), ("press", "step 2"));
    let sizes = |step: &Step| (step.duration, step.increment.initial, step.increment.min, step.increment.max);
    assert_eq!(sizes(press), (1.0, 0.05, 0.05 / 1024.0, 0.05));
    assert_eq!(sizes(second), (1.0, 0.05, 0.05 / 1024.0, 0.05));
    assert_eq!(press.fix.iter().map(|fix| fix.directions).collect::<Vec<_>>(), [[true; 3], [false, false, true]]);
    assert_eq!(press.moves[0].directions, [true; 3]);
}

#[test]
fn increment_sizes_follow_from_those_given() {
    let sizes = |given: &str| {
        let step = &read(&SCENE.replace("{ max = 0.05 }", given), &["step.1.duration=2"]).unwrap().steps[1];
        [step.increment.initial, step.increment.min, step.increment.max]
    };
    assert_eq!(sizes("{}"), [0.2, 0.2 / 1024.0, 0.2]);
    assert_eq!(sizes("{ initial = 0.1, max = 1 }"), [0.1, 0.1 / 1024.0, 1.0]);
    assert_eq!(sizes("{ min = 0.5 }"), [0.5, 0.5, 0.5]);
    assert_eq!(sizes("{ max = 0.1, min = 1e-3 }"), [0.1, 1e-3, 0.1]);
    let limits = |given: &str| read(&SCENE.replace("{ max = 0.05 }", given), &[]).unwrap().steps[1].increment.limits;
    assert_eq!(limits("{ max = 0.05 }"), Limits { strain: None, contacts: None });
    assert_eq!(limits("{ strain = 0.02, contacts = 0.1 }"), Limits { strain: Some(0.02), contacts: Some(0.1) });
}

#[test]
fn the_pace_stretches_increments() {
    let sizes = |pace: &str, given: &str| {
        let text = SCENE.replace("{ max = 0.05 }", given);
        let scene = read(&text, &[&format!("solver.pace={pace}"), "step.1.duration=2"]).unwrap();
        let of = |k: usize| [scene.steps[k].increment.initial, scene.steps[k].increment.max];
        (of(0), of(1), scene.steps[1].increment.min, scene.steps[1].increment.limits)
    };
    let given = "{ initial = 0.1, max = 0.4, strain = 0.02, contacts = 0.4 }";
    let (press, slide, min, limits) = sizes("4", given);
    assert_eq!((press, slide, min), ([0.2; 2], [0.4, 1.6], 0.1 / 1024.0));
    assert_eq!(limits, Limits { strain: Some(0.08), contacts: Some(1.0) });
    let (press, slide, min, limits) = sizes("0.5", given);
    assert_eq!((press, slide, min), ([0.025; 2], [0.05, 0.2], 0.05 / 1024.0));
    assert_eq!(limits, Limits { strain: Some(0.01), contacts: Some(0.2) });
    // Of 20 even increments 7 are left, none longer than the step.
    assert_eq!(sizes("3", given).0, [1.0 / 7.0; 2]);
    let (press, slide, ..) = sizes("100", given);
    assert_eq!((press, slide), ([1.0; 2], [2.0; 2]));
}

#[test]
fn a_preset_sets_what_the_scene_does_not() {
    let solver = |overrides: &[&str]| scene(overrides).solver;
    let values = |overrides: &[&str]| (solver(overrides).pace, solver(overrides).tolerance);
    assert_eq!(values(&[]), (1.0, 1e-10));
    assert_eq!(values(&["solver.accuracy=draft"]), (4.0, 1e-6));
    assert_eq!(values(&["solver.accuracy=draft", "solver.pace=2"]), (2.0, 1e-6));
    assert_eq!(values(&["solver.accuracy=reference", "solver.tolerance=1e-8"]), (0.25, 1e-8));
    let scene = scene(&["solver.accuracy=draft", "solver.tolerance=1e-8"]);
    assert_eq!(scene.steps[0].increment.max, 0.2);
    assert_eq!(scene.solver.describe(), "accuracy `draft`: pace 4, tolerance 1e-8");
    assert!(message_set("solver.accuracy=drft").contains("did you mean `draft`?"));
    assert!(message_set("solver.pace=0").contains("must be at least 0.001 and at most 1000, not 0"));
}

#[test]
fn what_is_traded_is_read() {
    let text = r#"
[trade]
steps = 1
set = ["output.every=9"]
reference = ["solver.pace=0.5"]
next = ["solver.pace=0.7"]
vary = [
    { key = ["a.b", "c.d"], values = ["word", "2", 2, 0.5, true, [4, 4, 1]] },
    { name = "rough", set = ["e.f=1"] },
]
exact = [{ of = "punch.fz", value = -2 }, { of = "punch.fx", curve = [[0, 0], [1, 3]] }]
"#;
    let Trade { steps, set, vary, reference, next, exact } = read(&format!("{SCENE}{text}"), &[]).unwrap().trade;
    let texts = |all: &[Located<String>]| all.iter().map(|text| text.value.clone()).collect::<Vec<_>>();
    assert_eq!((steps, texts(&set)), (Some(1), vec!["output.every=9".to_string()]));
    assert_eq!(
        (texts(&reference.unwrap()), texts(&next.unwrap())),
        (vec!["solver.pace=0.5".into()], vec!["solver.pace=0.7".into()])
    );
    let Varied::Keys { keys, values } = &vary[0].kind else { panic!("{vary:?}") };
    assert_eq!(keys, &["a.b", "c.d"]);
    // A string that would be read as something else keeps its quotes.
    assert_eq!(values, &["word", "\"2\"", "2", "0.5", "true", "[4, 4, 1]"]);
    let Varied::Together { name, set } = &vary[1].kind else { panic!("{vary:?}") };
    assert_eq!((name.as_str(), texts(set)), ("rough", vec!["e.f=1".to_string()]));
    assert_eq!(exact[0].known, Known::Value { value: -2.0, step: None });
    assert_eq!(exact[1].known, Known::Curve(vec![[0.0, 0.0], [1.0, 3.0]]));
    assert!(scene(&[]).trade.vary.is_empty());
}

#[test]
fn everything_that_can_be_said_is_read() {
    let text = r#"
[body.ring]
plane_strain = true
material = "m"
element = "hex8-fbar"
[body.ring.block]
sector = { center = [1, 2, 3], radii = [1, 2], angles = [-30, 60], length = 4 }
elements = [2, 8, 1]
grading = [2, 1, 1]
faces = { out = "rmax", ends = ["amin", "amax"] }
[body.cube]
material = "m"
block = { box = { size = [1, 2, 3] }, elements = [1, 2, 3] }
[body.part]
mesh = "/abs/part.inp"
group = "left"
material = "m"
[material.m]
model = "neo-hookean"
young = 1
poisson = -0.5
[tool.t]
mesh = "t.msh"
group = "die"
smoothing = "facet"
feature_angle = 180
flip = true
normals = "nurbs"
sharp = ["rim"]
symmetry = [ { point = [0, 0, 0], normal = [0, 2, 0] } ]
nurbs = "t.igs"
bezier = "/abs/t.bpt"
incomplete = true
tolerance = 0.02
cone = { apex = [0, 0, 1], axis = [0, 0, -2], angle = 30 }
torus = { center = [0, 0, 0], axis = [0, 0, 1], radius = 3, tube = 1, hollow = true }
[tool.c]
cylinder = { point = [0, 0, 0], axis = [0, 3, 4], radius = 2, hollow = true }
[tool.s]
sphere = { center = [0, 0, 1], radius = 1 }
[tool.e]
profile = { points = [[5, 40], [5, 0], [45, 0], [45, 40]], fillets = 10 }
[tool.l]
profile = { points = [[0, 1], [0, 0], [1, 0]], extrude = { origin = [1, 2, 3], x = [0, 2, 0], y = [0, 0, 3], length = 4 } }
[tool.r]
profile = { points = [[1, 0], [2, 0], [2, 2]], fillets = [0.1, 0, 0.2], closed = true, revolve = { point = [0, 0, 1], axis = [3, 0, 0] } }
[contact.a]
slave = "part.face.1"
master = "t"
friction = 0.2
method = "uzawa"
penalty = 1e4
tolerance = 1e-3
reach = 3
[[step]]
duration = 3
increments = 4
move = [ { target = "t", rotate = { point = [0, 0, 0], axis = [0, 0, -2], angle = 90 } }, { target = "ring.out", by = [0, 1, 0], directions = "y" } ]
force = [ { target = "c", total = [1, 0, 0], directions = "xy" }, { target = "ring", total = [0, 0, 1] } ]
pressure = [ { set = "cube.xmin", value = -2 } ]
body_force = [ { body = "cube", per_volume = [0, 0, -9.81] } ]
[output]
every = 3
history = [ "ring", "cube.xmax" ]
[solver]
tolerance = 1e-8
max_iterations = 30
force_floor = 1e-3
"#;
    let scene = parse("all.toml", text, Path::new("dir"), &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.title, "all");
    let names: Vec<_> = scene.bodies.iter().map(|body| body.name.value.as_str()).collect();
    assert_eq!(names, ["ring", "cube", "part"], "the order of the file is kept");
    let MeshSource::Block(block) = &scene.bodies[0].mesh else { panic!() };
    let BlockShape::Sector { center, radii, angles, length } = block.value.shape else { panic!() };
    assert_eq!((center, radii, angles, length), (Vec3::new(1.0, 2.0, 3.0), [1.0, 2.0], [-30.0, 60.0], 4.0));
    assert_eq!((block.value.elements, block.value.grading), ([2, 8, 1], [2.0, 1.0, 1.0]));
    let faces: Vec<Vec<_>> = block.value.faces.iter().map(|f| f.1.iter().map(|f| f.value.as_str()).collect()).collect();
    assert_eq!(faces, [vec!["rmax"], vec!["amin", "amax"]]);
    assert_eq!(scene.bodies[0].element.as_ref().map(|e| e.value), Some(Formulation::Hex8Fbar));
    let MeshSource::File { path, group: Some(group) } = &scene.bodies[2].mesh else { panic!() };
    assert_eq!((path.value.as_path(), group.value.as_str()), (Path::new("/abs/part.inp"), "left"));
    tools_are_read(&scene.tools);
    let contact = &scene.contacts[0];
    assert_eq!((contact.friction, contact.penalty, contact.reach), (0.2, Some(1e4), Some(3.0)));
    assert_eq!((contact.method, contact.tolerance), (Enforcement::Uzawa, Some(1e-3)));
    let step = &scene.steps[0];
    assert_eq!((step.increment.initial, step.increment.max), (0.75, 0.75));
    let rotate = step.moves[0].rotate.unwrap();
    assert_eq!((step.moves[0].by, rotate.axis, rotate.angle), (Vec3::zeros(), -Vec3::z(), 90.0));
    assert_eq!(step.moves[1].directions, [false, true, false]);
    assert_eq!((step.forces[0].directions, step.forces[1].directions), ([true, true, false], [true; 3]));
    assert_eq!((step.pressures[0].value, step.body_forces[0].per_volume.z), (-2.0, -9.81));
    assert_eq!((scene.output.every, scene.output.history.len()), (3, 2));
    assert_eq!((scene.solver.tolerance, scene.solver.max_iterations), (1e-8, 30));
    assert_eq!(scene.solver.force_floor.map(|floor| floor.value), Some(1e-3));
}

fn tools_are_read(tools: &[Tool]) {
    let [t, c, s, e, l, r] = tools else { panic!("{tools:?}") };
    let Some(ToolMesh { source, normals, sharp, symmetry, .. }) = &t.mesh else { panic!("{t:?}") };
    assert!(matches!(source, MeshSource::File { group: Some(group), .. } if group.value == "die"));
    assert!(matches!(normals, NormalSource::Description(other) if other.value == Description::Nurbs));
    assert_eq!((sharp[0].value.as_str(), symmetry[0].normal), ("rim", Vec3::y()));
    assert!(t.flip && t.feature_angle == 180.0);
    let files = [&t.nurbs, &t.bezier].map(|file| file.as_ref().unwrap());
    assert_eq!(files.map(|f| f.path.value.to_str().unwrap()), ["dir/t.igs", "/abs/t.bpt"]);
    assert!(files.iter().all(|f| f.incomplete && f.tolerance == Some(0.02)));
    let keys: Vec<&str> = t.descriptions().iter().map(|d| d.key()).collect();
    assert_eq!(keys, ["facet", "nagata", "nurbs", "bezier", "cone", "torus"]);
    assert_eq!(t.smoothing.value, Description::Mesh(Smoothing::Facet));
    assert!(matches!(t.shapes[0], Shape::Cone { axis, angle: 30.0, hollow: false, .. } if axis == -Vec3::z()));
    assert!(matches!(t.shapes[1], Shape::Torus { radius: 3.0, tube: 1.0, hollow: true, .. }));
    let Shape::Cylinder { axis, radius, hollow, .. } = c.shapes[0] else { panic!("{c:?}") };
    assert!((axis - Vec3::new(0.0, 0.6, 0.8)).norm() < 1e-15 && radius == 2.0 && hollow);
    assert_eq!((s.smoothing.value, e.smoothing.value), (Description::Sphere, Description::Profile));
    let profile = |tool: &Tool| match &tool.shapes[0] {
        Shape::Profile(profile) => profile.clone(),
        other => panic!("{other:?}"),
    };
    let fillets = |tool: &Tool| profile(tool).fillets.iter().map(|f| f.value).collect::<Vec<_>>();
    assert_eq!((fillets(e), fillets(l), fillets(r)), (vec![0.0, 10.0, 10.0, 0.0], vec![0.0; 3], vec![0.1, 0.0, 0.2]));
    assert_eq!((profile(e).points[2].value, profile(e).closed, profile(r).closed), ([45.0, 0.0], false, true));
    let plain = Sweep::Extrude { origin: Vec3::zeros(), x: Vec3::x(), y: Vec3::y(), length: None };
    assert_eq!(profile(e).sweep, plain);
    let origin = Vec3::new(1.0, 2.0, 3.0);
    assert_eq!(profile(l).sweep, Sweep::Extrude { origin, x: Vec3::y(), y: Vec3::z(), length: Some(4.0) });
    assert_eq!(profile(r).sweep, Sweep::Revolve { point: Vec3::z(), axis: Vec3::x() });
}

#[test]
fn text_round_trips_with_overrides() {
    let sets =
        ["step.press.duration=2", "solver.tolerance=1e-8", "title=\"a \\\"quoted\\\" # é\"", "step.1.name=slide"];
    let scene = scene(&sets);
    assert_eq!(scene.title, "a \"quoted\" # é");
    let again = read(&scene.text, &[]).unwrap_or_else(|error| panic!("{error}\n{}", scene.text));
    assert_eq!(content(&again), content(&scene));
    assert_eq!(again.text, scene.text);
    let order: Vec<_> = ["[body.slab]", "[material.rubber]", "[tool.floor]", "[[step]]", "[solver]"].into();
    let places: Vec<_> = order.iter().map(|header| scene.text.find(header)).collect();
    assert!(places.is_sorted() && places[0].is_some(), "{}", scene.text);
}

#[test]
fn the_text_keeps_all_but_relative_files() {
    let commented =
        SCENE.replace("mesh = \"slab.msh\"", "mesh = 'slab \"1\".msh' # é").replace("sub/indenter.msh", "/a/b.msh");
    let folder = std::env::current_dir().unwrap();
    let there = format!("mesh = '{}/in/slab \"1\".msh' # é", folder.display());
    let text = read(&commented, &[]).unwrap().text;
    assert_eq!(text, commented.replace("mesh = 'slab \"1\".msh' # é", &there));
    assert!(scene(&["body.slab.mesh=other.msh"]).text.contains(&format!("\"{}/in/other.msh\"", folder.display())));
    let cad = SCENE.replace("[tool.floor]", "nurbs = \"a.igs\"\nbezier = \"/b.bpt\"\n[tool.floor]");
    let there = cad.replace("\"a.igs\"", &format!("\"{}/in/a.igs\"", folder.display()));
    let there = there.replace("\"sub/", &format!("\"{}/in/sub/", folder.display()));
    let there = there.replace("\"slab.msh\"", &format!("\"{}/in/slab.msh\"", folder.display()));
    assert_eq!(read(&cad, &[]).unwrap().text, there);
}

#[test]
fn overrides_change_any_entry_and_the_last_wins() {
    let scene = scene(&[
        "tool.indenter.smoothing=facet",
        "contact.top.friction=0.1",
        "contact.top.friction = 0.2",
        "step.press.move.0.by.1=-5",
        "step.0.increments=40",
        "step.1.increment.max=0.01",
        "output.history=[\"slab.bottom\"]",
        "material.soft={ model = \"hooke\", young = 1, poisson = 0 }",
        "body.slab.material=soft",
        "title=two words",
    ]);
    assert_eq!(scene.tools[0].smoothing.value, Description::Mesh(Smoothing::Facet));
    assert_eq!(scene.contacts[0].friction, 0.2);
    assert_eq!(scene.steps[0].moves[0].by, Vec3::new(0.0, -5.0, 0.0));
    assert_eq!((scene.steps[0].increment.max, scene.steps[1].increment.max), (0.025, 0.01));
    assert_eq!(scene.output.history[0].value, "slab.bottom");
    assert_eq!((scene.bodies[0].material.value.as_str(), scene.materials.len()), ("soft", 3));
    assert_eq!(scene.title, "two words");
}

#[test]
fn overrides_that_name_nothing_are_refused() {
    assert_eq!(
        message_set("contact.top.fricton=0.1"),
        "--set contact.top.fricton=0.1: unknown key `fricton` in contact.top\n  \
         help: did you mean `friction`? (known: slave, master, discretization, slave_curvature, friction, method, penalty, \
         tolerance, reach, interference, thickness, tangent, smoothing, feature_angle, transfer)"
    );
    assert_eq!(
        message_set("body.slb.material=steel"),
        "--set body.slb.material=steel: there is no `slb` in body\n  help: did you mean `slab`? (known: slab)"
    );
    assert_eq!(
        message_set("step.pres.duration=2"),
        "--set step.pres.duration=2: there is no `pres` in step\n  help: did you mean `press`? (known: press, 1)"
    );
    assert_eq!(
        message_set("step.2.duration=2"),
        "--set step.2.duration=2: there is no `2` in step\n  help: known: press, 1"
    );
    assert_eq!(
        message_set("body.slab.mesh.file=a"),
        "--set body.slab.mesh.file=a: body.slab.mesh is a string, it has no `file`\n  help: set it as a whole"
    );
    assert_eq!(
        message_set("material.rubber.poisson=high"),
        "--set material.rubber.poisson=high: material.rubber.poisson must be a number, not a string\n  \
         help: for example `poisson = 1.0`"
    );
    let usage = "\n  help: write `--set key=value`, as in `--set contact.top.friction=0.2`";
    assert_eq!(message_set("title"), format!("--set title: the override has no `=`{usage}"));
    assert_eq!(message_set("a..b=1"), format!("--set a..b=1: the override has an empty key{usage}"));
    assert_eq!(message_set("title= "), format!("--set title= : the override has no value{usage}"));
}

#[test]
fn values_of_overrides_are_whole_toml_values() {
    assert_eq!(scene(&["title=1 2"]).title, "1 2");
    assert_eq!(scene(&["title=a\nb = 3"]).title, "a\nb = 3");
    assert_eq!(scene(&["title='x' # y"]).title, "'x' # y");
    assert_eq!(scene(&["title=a = b"]).title, "a = b");
    assert_eq!(scene(&["contact.top.penalty=1_000"]).contacts[0].penalty, Some(1000.0));
}

#[test]
fn unknown_keys_are_refused_with_the_nearest() {
    assert_eq!(
        message("material = \"rubber\"", "  materail = \"rubber\""),
        "in/test.toml:5:3: unknown key `materail` in body.slab\n  | materail = \"rubber\"\n  \
         help: did you mean `material`? (known: mesh, group, block, material, materials, element, shell, plane_strain, axisymmetric, symmetry, refine)"
    );
    assert_eq!(
        message("[material.steel]", "[materials.steel]"),
        "in/test.toml:12:2: unknown key `materials` in the scene\n  | [materials.steel]\n  \
         help: did you mean `material`? (known: title, body, material, tool, contact, tie, step, output, solver, controls, trade)"
    );
    assert_eq!(
        message("{ set = \"slab.bottom\" }", "{ group = \"slab.bottom\" }"),
        "in/test.toml:30:11: unknown key `group` in step.press.fix.0\n  \
         | fix = [ { group = \"slab.bottom\" }, { set = \"slab.sides\", directions = \"z\" } ]\n  \
         help: known: set, directions, normal, around; it is a key of body.NAME, tool.NAME"
    );
}

#[test]
fn wrong_types_say_what_was_found_and_give_an_example() {
    assert_eq!(
        message("young = 689.6", "young = \"689.6\""),
        "in/test.toml:9:9: material.rubber.young must be a number, not a string\n  | young = \"689.6\"\n  \
         help: for example `young = 1.0`"
    );
    assert_eq!(
        message("by = [0.0, -10.0, 0.0]", "by = -10.0"),
        "in/test.toml:31:38: step.press.move.0.by must be a list of 3 numbers, not a number\n  \
         | move = [ { target = \"indenter\", by = -10.0 } ]\n  help: for example `by = [0.0, 0.0, 1.0]`"
    );
    assert_eq!(
        reason("[0.0, -10.0, 0.0]", "[0.0, -10.0]"),
        "step.press.move.0.by must be a list of 3 numbers, not of 2"
    );
    assert_eq!(reason("-10.0", "true"), "step.press.move.0.by.1 must be a number, not a boolean");
    assert_eq!(reason("increments = 20", "increments = 2.5"), "step.press.increments must be an integer, not 2.5");
    assert_eq!(reason("increments = 20", "increments = 0"), "step.press.increments must be 1 or more, not 0");
    assert_eq!(reason("fix = [ {", "fix = { a = 1 } #"), "step.press.fix must be a list, not a table");
    assert_eq!(reason("\"rubber\"", "2020-01-01"), "body.slab.material must be a string, not a date");
    assert_eq!(reason("young = 689.6", "young = inf"), "material.rubber.young must be finite");
    assert_eq!(reason("young = 689.6", "young = 1e999"), "material.rubber.young must be finite");
}

#[test]
fn what_is_missing_is_named_with_its_table() {
    assert_eq!(
        message("material = \"rubber\"", ""),
        "in/test.toml:3:1: body.slab has no `material`\n  | [body.slab]\n  \
         help: add `material = \"NAME\"` (known: rubber, steel)"
    );
    assert_eq!(
        message("mesh = \"slab.msh\"", ""),
        "in/test.toml:3:1: body.slab has no `mesh`\n  | [body.slab]\n  \
         help: add `mesh = \"FILE\"`, or `block = { ... }`"
    );
    assert_eq!(
        message("increments = 20", ""),
        "in/test.toml:27:1: step.press has no increments\n  | [[step]]\n  \
         help: add `increments = 20`, or `increment = { initial = 0.05, min = 1e-4, max = 0.1 }`"
    );
    assert_eq!(
        message("set = \"slab.bottom\"", ""),
        "in/test.toml:30:9: step.press.fix.0 has no `set`\n  \
         | fix = [ {  }, { set = \"slab.sides\", directions = \"z\" } ]\n  help: add `set = \"BODY.GROUP\"`"
    );
    assert_eq!(
        refusal(read("title = \"a\"", &[])),
        "in/test.toml: the scene has no body\n  help: add a table `[body.NAME]` with a mesh and a material"
    );
    let start = &SCENE[..SCENE.find("[[step]]").unwrap()];
    let no_step = "in/test.toml: the scene has no step\n  \
                   help: add a table `[[step]]` with its increments and conditions";
    assert_eq!(refusal(read(start, &[])), no_step);
    let one = "step must be a list, not a table";
    assert!(refusal(read(&format!("{start}[step]\nincrements = 1"), &[])).contains(one));
}

#[test]
fn parameters_are_physical() {
    assert_eq!(
        message("master = \"indenter\"", "master = \"indenter\"\nfriction = -0.3"),
        "in/test.toml:26:12: contact.top.friction must be 0 or more, not -0.3\n  | friction = -0.3\n  \
         help: it is the Coulomb coefficient; 0 is frictionless"
    );
    assert_eq!(
        message("poisson = 0.32", "poisson = 0.5"),
        "in/test.toml:10:11: material.rubber.poisson must be above -1 and below 0.5, not 0.5\n  | poisson = 0.5\n  \
         help: use 0.4999 with element = \"hex8-fbar\" for an incompressible material"
    );
    assert_eq!(
        reason("poisson = 0.32", "poisson = -1"),
        "material.rubber.poisson must be above -1 and below 0.5, not -1.0"
    );
    assert_eq!(reason("young = 689.6", "young = 0"), "material.rubber.young must be above 0, not 0.0");
    assert_eq!(
        message("{ max = 0.05 }", "{ max = 2 }"),
        "in/test.toml:34:21: step.1.increment.max must be above 0 and at most the duration (1.0), not 2.0\n  \
         | increment = { max = 2 }\n  help: it is in the time of the step"
    );
    assert_eq!(
        reason("{ max = 0.05 }", "{ max = 0.1, min = 0.01, initial = 0.001 }"),
        "step.1.increment.initial must be at least min (0.01) and at most max (0.1), not 0.001"
    );
    assert_eq!(
        reason("{ max = 0.05 }", "{ max = 0.1, min = 0.2 }"),
        "step.1.increment.min must be above 0 and at most max (0.1), not 0.2"
    );
    assert_eq!(
        message("{ max = 0.05 }", "{ contacts = 20 }"),
        "in/test.toml:34:26: step.1.increment.contacts must be above 0 and at most 1, not 20.0\n  \
         | increment = { contacts = 20 }\n  help: it is a share of the slave nodes"
    );
    assert_eq!(reason("max = 0.05 }", "strain = 0 }"), "step.1.increment.strain must be above 0, not 0.0");
    assert_eq!(reason("max = 0.05 }", "max = 0.05 }\nincrements = 3"), "step.1.increments stands beside `increment`");
    assert_eq!(
        reason("normal = [0, 0, 2]", "normal = [0, 0, 0]"),
        "tool.floor.plane.normal must not be the zero vector"
    );
    assert!(message_set("solver.tolerance=0.01").contains("must be above 0 and below 0.01, not 0.01"));
}

#[test]
fn directions_are_letters_of_xyz() {
    assert_eq!(
        message("directions = \"z\"", "directions = \"zq\""),
        "in/test.toml:30:69: step.press.fix.1.directions must be some of the letters x, y and z, each once, not \"zq\"\n  \
         | fix = [ { set = \"slab.bottom\" }, { set = \"slab.sides\", directions = \"zq\" } ]\n  \
         help: for example \"x\", \"yz\" or \"xyz\""
    );
    for bad in ["\"\"", "\"zz\"", "\"X\"", "\"é\""] {
        assert!(reason("directions = \"z\"", &format!("directions = {bad}")).ends_with(bad));
    }
}

#[test]
fn what_is_not_toml_has_its_place() {
    assert_eq!(
        message("young = 689.6", "young 689.6"),
        "in/test.toml:9:7: this is not TOML: key with no value, expected `=`\n  | young 689.6"
    );
    assert_eq!(
        message("[tool.indenter]", "[tool.floor]"),
        "in/test.toml:20:7: this is not TOML: duplicate key\n  | [tool.floor]"
    );
    assert!(message("\"Test\"", "\"é").starts_with("in/test.toml:1:"));
    assert_eq!(
        message("young = 689.6", "young = 99999999999999999999"),
        "in/test.toml:9:9: the integer 99999999999999999999 is too large\n  | young = 99999999999999999999"
    );
}

#[test]
fn references_are_checked() {
    assert_eq!(
        message("material = \"rubber\"", "material = \"ruber\""),
        "in/test.toml:5:12: body.slab.material names the unknown material `ruber`\n  | material = \"ruber\"\n  \
         help: did you mean `rubber`? (known: rubber, steel)"
    );
    assert_eq!(
        message("target = \"indenter\"", "target = \"intender\""),
        "in/test.toml:31:21: step.press.move.0.target names the unknown tool or body `intender`\n  \
         | move = [ { target = \"intender\", by = [0.0, -10.0, 0.0] } ]\n  \
         help: did you mean `indenter`? (known: indenter, floor, slab)"
    );
    assert_eq!(
        reason("master = \"indenter\"", "master = \"flor\""),
        "contact.top.master names the unknown tool or body `flor`"
    );
    assert_eq!(
        reason("slave = \"slab.top\"", "slave = \"slap.top\""),
        "contact.top.slave names the unknown body `slap`"
    );
    assert_eq!(reason("slave = \"slab.top\"", "slave = \"slab\""), "contact.top.slave must be faces, `body.group`");
    assert_eq!(reason("slave = \"slab.top\"", "slave = \"slab.\""), "contact.top.slave names no group of body `slab`");
    assert_eq!(
        reason("set = \"slab.bottom\"", "set = \"floor\""),
        "step.press.fix.0.set must be `body` or `body.group`; `floor` is a tool"
    );
    assert_eq!(reason("[tool.floor]", "[tool.slab]"), "`slab` names a tool and a body");
    for name in ["slab", "indenter"] {
        let between = format!("contact.{name}={{ slave = \"slab.top\", master = \"slab.bottom\" }}");
        assert!(message_set(&between).contains(&format!("`{name}` names a contact between bodies and a tool or body")));
    }
    read(SCENE, &["contact.floor={ slave = \"slab.bottom\", master = \"floor\" }"]).unwrap();
    assert_eq!(reason("[tool.floor]", "[tool.\"a b\"]"), "\"a b\" cannot be a name");
    assert_eq!(reason("name = \"press\"", "name = \"1\""), "\"1\" cannot be a name");
    assert!(message_set("step.1.name=press").contains("two steps are named `press`"));
    assert!(message_set("contact.b={ slave = \"slab.top\", master = \"indenter\" }").contains("repeats the pair"));
    assert!(
        message_set("contact.top.method=\"mortar\"")
            .contains("cannot be \"mortar\"\n  help: known: penalty, lagrange, augmented-lagrangian, uzawa")
    );
    assert!(message_set("output.history=[\"slab\", \"slab\"]").contains("output.history.1 repeats `slab`"));
    assert!(message_set("output.history=[\"floor\"]").contains("tools always are in the history"));
}

#[test]
fn a_tool_takes_the_description_that_smoothing_asks_for() {
    assert_eq!(
        message("[tool.floor]", "[tool.floor]\nsmoothing = \"nagata\""),
        "in/test.toml:21:13: tool.floor.smoothing needs the key `mesh`, which is missing\n  | smoothing = \"nagata\"\n  \
         help: add `mesh = \"FILE.msh\"`"
    );
    let smoothing = |sets: &[&str]| read(SCENE, sets).map(|scene| scene.tools[1].smoothing.value);
    assert_eq!(smoothing(&["tool.floor.mesh=a"]).unwrap(), Description::Mesh(Smoothing::Nagata));
    assert_eq!(smoothing(&["tool.floor.nurbs=a.igs", "tool.floor.smoothing=nurbs"]).unwrap(), Description::Nurbs);
    assert_eq!(
        message("[tool.floor]", "[tool.floor]\nbezier = \"a.bpt\""),
        "in/test.toml:20:1: tool.floor has several descriptions, bezier, plane\n  | [tool.floor]\n  \
         help: add `smoothing = \"bezier\"`, or another of them"
    );
    assert_eq!(
        message("mesh = \"sub/indenter.msh\"", ""),
        "in/test.toml:17:1: tool.indenter has no surface\n  | [tool.indenter]\n  help: add one of `mesh`, `nurbs`, `bezier`, \
         `plane`, `cylinder`, `cone`, `sphere`, `torus`, `profile`"
    );
    assert!(
        message_set("tool.indenter.smoothing=nurb").contains("did you mean `nurbs`? (known: facet, nagata, nurbs,")
    );
    assert!(message_set("tool.indenter.smoothing=profile").contains("help: add `profile = { ... }`"));
    assert!(message_set("tool.indenter.normals=nurbs").contains("normals needs the key `nurbs`, which is missing"));
    assert!(message_set("tool.indenter.normals=nagata").contains("cannot be \"nagata\""));
    assert!(message_set("tool.indenter.feature_angle=181").contains("above 0 and at most 180, not 181.0"));
    assert!(
        message_set("tool.floor.flip=true").contains("flip needs a mesh, a CAD file or a profile\n  help: remove it;")
    );
    assert!(message_set("tool.floor.sharp=[\"a\"]").contains("tool.floor.sharp needs a mesh"));
    assert!(message_set("tool.indenter.incomplete=true").contains("incomplete needs a CAD file"));
    assert!(message_set("tool.indenter.nurbs=\"\"").contains("tool.indenter.nurbs names no file"));
}

#[test]
fn closed_forms_are_checked() {
    let shape = |text: &str| {
        let text = SCENE.replace("[contact.top]", &format!("[tool.other]\n{text}\n[contact.top]"));
        read(&text, &[]).err().map_or(String::new(), |error| error.to_string())
    };
    assert!(
        shape("cone = { apex = [0, 0, 0], axis = [0, 0, 1], angle = 90 }").contains("above 0 and below 90, not 90.0")
    );
    let torus = shape("torus = { center = [0, 0, 0], axis = [0, 0, 1], radius = 1, tube = 1 }");
    assert!(torus.contains("tube must be above 0 and below the radius of the ring (1.0), not 1.0"), "{torus}");
    let profile = |rest: &str| shape(&format!("profile = {{ points = [[0, 1], [0, 0], [1, 0]]{rest} }}"));
    assert_eq!(profile(", fillets = [0, 1, 0], revolve = { point = [0, 0, 0], axis = [0, 0, 1] }"), "");
    assert!(profile(", fillets = [0, 1]").contains("fillets must have a radius for each of the 3 points, not 2"));
    assert!(profile(", fillets = [0, 1, 1]").contains("profile.fillets.2 rounds an end of the chain"));
    assert!(profile(", fillets = -1").contains("fillets must be 0 or more, not -1.0"));
    assert!(profile(", extrude = {}, revolve = {}").contains("revolve stands beside `extrude`"));
    assert!(
        profile(", extrude = { x = [1, 1, 0] }").contains("extrude has directions `x` and `y` that are not at a right")
    );
    assert!(shape("profile = { points = [[0, 1]] }").contains("points must have 2 points or more, not 1"));
    assert!(
        shape("profile = { points = [[0, 1], [1, 2, 3]] }").contains("points.1 must be a list of 2 numbers, not of 3")
    );
    assert!(shape("profile = { points = [[0, 1], [1, 1]], closed = true }").contains("must have 3 points or more"));
}

#[test]
fn tools_are_read_without_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tools.toml");
    let write = |text: &str| std::fs::write(&path, text).unwrap();
    write("[tool.a]\nsphere = { center = [0, 0, 0], radius = 1 }\nmesh = \"a.msh\"");
    let tools = load_tools(&path, &["tool.a.smoothing=sphere".into()]).unwrap();
    assert_eq!((tools.len(), tools[0].smoothing.value), (1, Description::Sphere));
    let Some(ToolMesh { source: MeshSource::File { path: mesh, .. }, .. }) = &tools[0].mesh else {
        panic!("{tools:?}")
    };
    assert_eq!(mesh.value, folder.path().join("a.msh"));
    write(&SCENE.replace("young = 689.6", "young = -1"));
    assert_eq!(load_tools(&path, &[]).unwrap().len(), 2);
    write("title = \"none\"");
    assert!(load_tools(&path, &[]).unwrap_err().to_string().contains("the scene has no tool"));
    write("[tol.a]");
    assert!(load_tools(&path, &[]).unwrap_err().to_string().contains("did you mean `tool`?"));
}

#[test]
fn conditions_of_a_step_do_not_contradict_each_other() {
    let conditions = |text: &str| {
        let text = SCENE.replacen("increment = { max = 0.05 }", &format!("name = \"s\"\nincrements = 1\n{text}"), 1);
        read(&text, &[]).err().map_or(String::new(), |error| error.to_string())
    };
    let floor = "target = \"floor\"";
    let twice = conditions(&format!("move = [ {{ {floor}, by = [0, 0, 1] }}, {{ {floor}, by = [0, 1, 0] }} ]"));
    assert!(twice.contains("36:59: step `s` moves `floor` twice"), "{twice}");
    for (one, verb, target) in [
        ("pressure = [ @, @ ]".replace('@', "{ set = \"slab.top\", value = 1 }"), "presses on", "slab.top"),
        ("body_force = [ @, @ ]".replace('@', "{ body = \"slab\", per_volume = [0, 0, 1] }"), "pulls at", "slab"),
        (
            "spring = [ @, @ ]".replace('@', "{ set = \"slab.top\", stiffness = [0, 0, 1] }"),
            "has springs on",
            "slab.top",
        ),
        (
            "duration = 1\ndashpot = [ @, @ ]".replace('@', "{ set = \"slab\", damping = [0, 0, 1] }"),
            "has dashpots on",
            "slab",
        ),
    ] {
        let twice = conditions(&one);
        assert!(twice.contains(&format!("step `s` {verb} `{target}` twice")), "{twice}");
    }
    let push = format!("force = [ {{ {floor}, total = [0, 0, -5], directions = \"z\" }} ]");
    assert_eq!(conditions(&push), "");
    assert_eq!(conditions(&format!("{push}\nmove = [ {{ {floor}, by = [1, 0, 0] }} ]")), "");
    let driven = conditions(&format!("{push}\nmove = [ {{ {floor}, by = [1, 0, 1] }} ]"));
    assert!(driven.contains("step `s` moves `floor` in z, in which a force drives it"), "{driven}");
    let free = conditions(&push.replace("\"z\"", "\"xy\""));
    assert!(free.contains("step.s.force.0.total acts in z, in which `directions` does not free the tool"), "{free}");
    let unsaid = conditions(&push.replace(", directions = \"z\"", ""));
    assert!(unsaid.contains("step.s.force.0 has no `directions` for the tool `floor`"), "{unsaid}");
    let fixed = conditions(
        "fix = [ { set = \"slab.a\", directions = \"yz\" } ]\nmove = [ { target = \"slab.a\", by = [1, 1, 0] } ]",
    );
    assert!(fixed.contains("step `s` moves `slab.a` in y, in which it is fixed"), "{fixed}");
    let left = conditions("move = [ { target = \"slab.a\", by = [1, 1, 0], directions = \"x\" } ]");
    assert!(left.contains("step.s.move.0.by moves in y, which `directions` leaves free"), "{left}");
    let turn = "move = [ { target = \"slab.a\", rotate = { point = [0, 0, 0], axis = [0, 0, 1], angle = 1 } } ]";
    let turned = |held: &str| conditions(&format!("fix = [ {{ set = \"slab.a\", directions = \"{held}\" }} ]\n{turn}"));
    assert!(turned("zy").contains("step `s` moves `slab.a` in y, in which it is fixed"), "{}", turned("zy"));
    let around = |letters: &str| {
        let frame = "around = { point = [0, 0, 0], axis = [0, 0, 1] }";
        conditions(&format!("fix = [ {{ set = \"slab.a\", {frame}, directions = \"{letters}\" }} ]"))
    };
    assert!(around("xz").contains("some of the letters r, t and z"), "{}", around("xz"));
    let still = conditions(&format!("move = [ {{ {floor} }} ]"));
    assert!(still.contains("step.s.move.0 does not say how to move"), "{still}");
    assert_eq!(conditions("fix = []\nmove = []\npressure = []"), conditions(""));
    assert!(conditions("pressure = [ { set = \"slab\", value = 1 } ]").contains("must be faces"));
    assert!(
        conditions("body_force = [ { body = \"slab.top\", per_volume = [0, 0, 1] } ]")
            .contains("unknown body `slab.top`")
    );
}

#[test]
fn blocks_are_checked() {
    let block = |block: &str| {
        let text = SCENE.replacen("mesh = \"slab.msh\"", &format!("block = {block}"), 1);
        read(&text, &[]).err().map_or(String::new(), |error| error.to_string())
    };
    let size = "box = { size = [1, 1, 1] }";
    let ring = "sector = { radii = [1, 2], angles = [0, 360], length = 1 }";
    assert_eq!(block(&format!("{{ {size}, elements = [1, 1, 1], faces = {{ all = [\"xmin\", \"xmax\"] }} }}")), "");
    assert!(
        block(&format!("{{ {size}, elements = [1, 1, 0] }}")).contains("block.elements.2 must be 1 or more, not 0")
    );
    assert!(
        block(&format!("{{ {size}, elements = [9999999, 9999999, 9999999] }}")).contains("more than 2^31 elements")
    );
    assert!(
        block(&format!("{{ {size}, {ring}, elements = [1, 1, 1] }}")).contains("must have one of `box` and `sector`")
    );
    assert!(block(&format!("{{ {ring}, elements = [1, 2, 1] }}")).contains("must have 3 or more around a full circle"));
    let closed = block(&format!("{{ {ring}, elements = [1, 3, 1], faces = {{ a = \"amin\" }} }}"));
    assert!(closed.contains("block.faces.a cannot be \"amin\"\n"), "{closed}");
    assert!(closed.contains("(known: rmin, rmax, zmin, zmax)"), "{closed}");
    assert!(
        block(&format!("{{ {size}, elements = [1, 1, 1], faces = {{ xmin = \"ymin\" }} }}"))
            .contains("already is the name")
    );
    assert!(
        block("{ box = { size = [1, -1, 1] }, elements = [1, 1, 1] }").contains("size.1 must be above 0, not -1.0")
    );
    let inside_out = ring.replace("[1, 2]", "[2, 1]");
    assert!(block(&format!("{{ {inside_out}, elements = [1, 3, 1] }}")).contains("radii must increase"));
    let layers = block(&format!("{{ {size}, elements = [1, 1, 2] }}\nplane_strain = true"));
    assert!(layers.contains("body.slab is in plane strain but has 2 layers of elements along z"), "{layers}");
    let tets = block(&format!("{{ {size}, elements = [1, 1, 2] }}\nelement = \"tet4\""));
    assert!(tets.contains("body.slab is a block of hexahedra"), "{tets}");
    assert!(
        block(&format!("{{ {size}, elements = [1, 1, 2] }}\ngroup = \"a\""))
            .contains("body.slab.group needs a mesh file")
    );
}

#[test]
fn the_ironing_scene_is_read() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/ironing-rigid.toml");
    let scene = load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((scene.name.as_str(), scene.contacts[0].friction, scene.output.every), ("ironing-rigid", 0.3, 20));
    let [press, slide] = &scene.steps[..] else { panic!("{:?}", scene.steps) };
    assert_eq!((press.increment.max, slide.increment.initial, slide.increment.max), (0.05, 0.00125, 0.00125));
    assert_eq!((press.moves[0].by.y, slide.moves[0].by.x), (-10.0, 250.0));
    assert_eq!(slide.fix.iter().map(|fix| fix.directions).collect::<Vec<_>>(), [[true; 3]]);
    assert!(scene.bodies[0].is_layer());
    let changed = load(&path, &["step.slide.increments=400".to_string()]).unwrap();
    assert_eq!(changed.steps[1].increment.initial, 0.0025);
    let again = parse("ironing-rigid.toml", &changed.text, path.parent().unwrap(), &[]).unwrap();
    assert_eq!(content(&again), content(&changed));
    assert_eq!(
        load(Path::new("/nowhere/a.toml"), &[]).unwrap_err().to_string(),
        "cannot read the scene /nowhere/a.toml: No such file or directory (os error 2)\n  help: give the path of a TOML file"
    );
    // As whoever wants to go on from results may try.
    assert_eq!(
        load(Path::new("/"), &[]).unwrap_err().to_string(),
        "cannot read the scene /: Is a directory (os error 21)\n  help: give the path of a TOML file; the folder of results goes with --out"
    );
}

proptest::proptest! {
    #[test]
    fn no_text_and_no_override_is_a_panic(
        from in 0..SCENE.len(), length in 0..12usize, new in "[\\[\\]{}=\",.#a-z0-9é\\n-]{0,6}",
        key in "(step|body|title|x)(\\.(0|press|slab|a)){0,3}", value in "\\PC{0,8}",
    ) {
        let text = format!("{}{new}{}", &SCENE[..from], &SCENE[(from + length).min(SCENE.len())..]);
        let _ = read(&text, &[]);
        if let Ok(scene) = read(SCENE, &[&format!("{key}={value}")]) {
            let again = read(&scene.text, &[]).unwrap_or_else(|error| panic!("{error}\n{}", scene.text));
            proptest::prop_assert_eq!(content(&again), content(&scene));
        }
    }
}

#[test]
fn places_count_characters_and_survive_other_line_ends() {
    let text = SCENE.replace('\n', "\r\n").replace("young = 689.6", "\tyoung = 0 # é");
    let at = "in/test.toml:9:10: material.rubber.young must be above 0, not 0.0\n  | young = 0 # é";
    assert_eq!(refusal(read(&text, &[])), at);
    let wide = message("mesh = \"slab.msh\"", "block = { faces = { \"é\" = \"é\" }, el = 1 }");
    assert!(wide.starts_with("in/test.toml:4:34: unknown key `el` in body.slab.block"), "{wide}");
}

#[test]
fn a_master_may_be_on_a_body() {
    assert_eq!(read(SCENE, &[]).unwrap().contacts[0].surface, None);
    let scene = read(&SCENE.replacen("master = \"indenter\"", "master = \"slab.side\"", 1), &[]).unwrap();
    assert_eq!(scene.contacts[0].master.value, "slab.side");
    let default = MasterSurface { smoothing: Smoothing::Nagata, feature_angle: 40.0, transfer: Transfer::Patch };
    assert_eq!((scene.contacts[0].surface, scene.contacts[0].tangent), (Some(default), Tangent::Exact));
    let all = "master = \"slab.side\"\nsmoothing = \"facet\"\nfeature_angle = 20\ntransfer = \"bilinear\"\n\
               tangent = \"fixed-frame\"";
    let scene = read(&SCENE.replacen("master = \"indenter\"", all, 1), &[]).unwrap();
    let other = MasterSurface { smoothing: Smoothing::Facet, feature_angle: 20.0, transfer: Transfer::Bilinear };
    assert_eq!((scene.contacts[0].surface, scene.contacts[0].tangent), (Some(other), Tangent::FixedFrame));
}

#[test]
fn what_a_tool_has_and_a_body_lacks_is_told() {
    assert_eq!(
        message("master = \"indenter\"", "master = \"indenter\"\ntransfer = \"patch\""),
        "in/test.toml:26:12: contact.top.transfer means nothing for a tool\n  | transfer = \"patch\"\n  \
         help: it is for a master on a body; remove it"
    );
    for key in ["smoothing = \"nagata\"", "feature_angle = 30"] {
        let both = format!("master = \"indenter\"\n{key}");
        assert!(reason("master = \"indenter\"", &both).ends_with("means nothing for a tool"));
    }
    assert_eq!(reason("master = \"indenter\"", "master = \"slab\""), "contact.top.master must be faces, `body.group`");
    let thickness = "master = \"slab.side\"\nthickness = 1";
    assert!(reason("master = \"indenter\"", thickness).ends_with("thickness means nothing between two surfaces"));
    assert_eq!(
        message("master = \"indenter\"", "master = \"indenter\"\ntolerance = 1e-3"),
        "in/test.toml:26:13: contact.top.tolerance means nothing with the method \"augmented-lagrangian\"\n  \
         | tolerance = 1e-3\n  help: it ends the outer iterations of \"uzawa\"; remove it"
    );
    let own = "master = \"slab.top\"\ndiscretization = \"segment\"\nmethod = \"uzawa\"";
    assert!(reason("master = \"indenter\"", own).ends_with("does not settle with \"segment\" in self-contact"));
    let wrong = "master = \"slab.side\"\ntransfer = \"mortar\"";
    assert_eq!(reason("master = \"indenter\"", wrong), "contact.top.transfer cannot be \"mortar\"");
}

/// The scene with another card in place of `steel`.
fn with_steel(card: &str) -> crate::error::Result<Scene> {
    read(SCENE, &[&format!("material.steel={{ young = 2e5, poisson = 0.3, {card} }}")])
}

#[test]
fn plastic_materials_are_read() {
    let hardening = |card: &str| match with_steel(card).unwrap_or_else(|error| panic!("{error}")).materials[1].model {
        MaterialModel::Plastic { young: 2e5, poisson: 0.3, hill: None, ref hardening } => hardening.clone(),
        ref other => panic!("{other:?}"),
    };
    let j2 = "model = \"j2\", yield_stress = 250";
    assert_eq!(hardening(j2), Hardening::Linear { yield_stress: 250.0, modulus: 0.0 });
    let linear = hardening(&format!("{j2}, hardening = {{ linear = 500 }}"));
    assert_eq!(linear, Hardening::Linear { yield_stress: 250.0, modulus: 500.0 });
    let Hardening::Swift { k, e0, n } = hardening(&format!("{j2}, hardening = {{ swift = {{ k = 500, n = 0.25 }} }}"))
    else {
        panic!()
    };
    assert!((k, n) == (500.0, 0.25) && (e0 - 0.0625).abs() < 1e-15);
    let given = hardening("model = \"j2\", hardening = { swift = { k = 500, n = 0.25, e0 = 0.01 } }");
    assert_eq!(given, Hardening::Swift { k: 500.0, e0: 0.01, n: 0.25 });
    let voce = hardening(&format!("{j2}, hardening = {{ voce = {{ saturation = 400, rate = 16.93, linear = 129 }} }}"));
    assert_eq!(voce, Hardening::Voce { yield_stress: 250.0, saturation: 400.0, rate: 16.93, modulus: 129.0 });
    let table = hardening("model = \"j2\", hardening = { table = [[0, 250], [0.1, 300]] }");
    assert_eq!(table, Hardening::Table(vec![[0.0, 250.0], [0.1, 300.0]]));
    let hill = "hill = { f = 0.283, g = 0.358, h = 0.642, n = 1.289, x = [0, 2, 0], y = [-1, 1, 0] }";
    let sheet = with_steel(&format!("model = \"hill\", yield_stress = 157.12, {hill}")).unwrap();
    let MaterialModel::Plastic { hill: Some(hill), .. } = &sheet.materials[1].model else { panic!() };
    assert_eq!(hill.coefficients, [0.283, 0.358, 0.642, 1.5, 1.5, 1.289]);
    let axes = crate::Mat3::from_columns(&[Vec3::y(), -Vec3::x(), Vec3::z()]);
    assert!((hill.axes - axes).norm() < 1e-15);
}

#[test]
fn plastic_materials_are_physical() {
    let told = |card: &str| {
        let message = refusal(with_steel(card));
        message.split_once("material.steel").unwrap().1.split('\n').next().unwrap().to_string()
    };
    let j2 = |rest: &str| told(&format!("model = \"j2\", yield_stress = 250, hardening = {rest}"));
    let hill = |rest: &str| told(&format!("model = \"hill\", yield_stress = 250, hill = {rest}"));
    let message = |card: &str| refusal(with_steel(card));
    assert!(message("model = \"j2\"").contains("has no `yield_stress`"));
    assert!(message("model = \"hill\", yield_stress = 1").contains("has no `hill`"));
    assert!(
        message("model = \"hooke\", yield_stress = 1")
            .contains("steel.yield_stress does not belong to this model\n  help: write model = \"j2\" or \"hill\"")
    );
    assert!(message("model = \"j2\", yield_stress = 1, hill = {}").contains("hill does not belong to this model"));
    assert!(j2("{}").ends_with("hardening must have one of `linear`, `swift`, `voce` and `table`"));
    assert!(j2("{ linear = -1 }").ends_with("hardening.linear must be 0 or more, not -1.0"));
    assert!(j2("{ swift = { k = 500, n = 2 } }").ends_with("swift.n must be above 0 and at most 1, not 2.0"));
    assert!(j2("{ swift = { k = 500, n = 0.2, e0 = 0.1 } }").ends_with("swift.e0 stands beside `yield_stress`"));
    assert!(
        j2("{ swift = { k = 200, n = 0.2 } }").ends_with("swift.k must be at least yield_stress (250.0), not 200.0")
    );
    assert!(
        j2("{ voce = { saturation = 200, rate = 1 } }").ends_with("must be at least yield_stress (250.0), not 200.0")
    );
    assert!(j2("{ table = [[0, 1]] }").contains("yield_stress stands beside a table"));
    let table = |rows: &str| told(&format!("model = \"j2\", hardening = {{ table = {rows} }}"));
    assert!(table("[[0.1, 1]]").ends_with("table.0 must have the strain 0, as the first point"));
    assert!(table("[[0, 1], [0, 2]]").ends_with("table.1 must have a larger strain than the last"));
    assert!(table("[[0, 2], [1, 1]]").ends_with("table.1 must not have a smaller stress than the last"));
    assert!(table("[[0, 0]]").ends_with("table.0 must have a stress above 0"));
    assert!(hill("{ f = 1, g = -1, h = 0.2, n = 1 }").ends_with("hill is not a convex criterion"));
    assert!(hill("{ f = 1, g = 1, h = 1, n = 0 }").ends_with("hill.n must be above 0, not 0.0"));
    assert!(
        hill("{ f = 1, g = 1, h = 1, n = 1, x = [1, 1, 0], y = [-2, -2, 0] }").ends_with("has x and y along one line")
    );
}

#[test]
fn controls_are_for_experts() {
    use crate::controls::Controls;
    assert_eq!(scene(&[]).controls, Controls::default());
    let changed = scene(&["controls.jump_drag=0.2", "controls.outer_rounds=30"]).controls;
    assert_eq!(changed, Controls { jump_drag: 0.2, outer_rounds: 30, ..Controls::default() });
    let told = |table: &str| refusal(read(&format!("{SCENE}\n[controls]\n{table}\n"), &[]));
    let unknown = told("jump_drog = 0.2");
    assert!(unknown.contains(":1: unknown key `jump_drog` in controls"), "{unknown}");
    assert!(unknown.contains("did you mean `jump_drag`?"), "{unknown}");
    let below = told("jump_drag = 0.0");
    assert!(below.contains("controls.jump_drag must be a number from 1e-6 to 100.0, not 0.0"), "{below}");
    assert!(below.contains("help: it is in: largest nodal stiffness; by default 0.1"), "{below}");
    assert!(told("outer_rounds = 1.5").contains("must be an integer from 1.0 to 10000.0, not 1.5"));
    assert!(told("jump_drag = \"much\"").contains("controls.jump_drag must be a number, not"));
}

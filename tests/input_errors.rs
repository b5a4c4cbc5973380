//! Wrong input: each mistake is refused on all ranks with exit code 2, and told once, with its place and what to do;
//! several together.

mod common;

use common::{Bench, Run, deck, nagata};
use std::fs;
use std::path::Path;

const SCENE: &str = r#"[body.slab]
material = "rubber"
mesh = "slab.inp"

[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.3

[tool.plate]
plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }

[contact.top]
slave = "slab.top"
master = "plate"
friction = 0.2

[[step]]
name = "press"
increments = 1
fix = [{ set = "slab.bottom" }]
move = [{ target = "plate", by = [0.0, 0.0, -0.1] }]
"#;

/// A folder with the scene, one piece of it replaced, and its mesh of two cubes along x.
fn bench(old: &str, new: &str) -> Bench {
    assert_eq!(SCENE.matches(old).count(), 1, "{old}");
    let bench = Bench::new(&SCENE.replacen(old, new, 1));
    bench.write("slab.inp", &deck([2, 1, 1]));
    bench
}

/// The message of a refusal, without the path of the folder. It is all that is said, is said once, and leaves no results.
#[track_caller]
fn message(bench: &Bench, run: &Run) -> String {
    let folder = format!("{}/", bench.path("").display().to_string().trim_end_matches('/'));
    let text = run.stderr.replace(&folder, "");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{text}");
    assert_eq!(text.matches("error:").count(), 1, "{text}");
    assert!(!text.contains("panicked") && !run.out.exists(), "{text}");
    text
}

/// Runs on two ranks; the message must begin with `place` and hold each of `words` once.
#[track_caller]
fn refuses(bench: &Bench, arguments: &[&str], place: &str, words: &[&str]) {
    let text = message(bench, &bench.run(2, arguments));
    assert!(text.starts_with(&format!("error: {place}")), "{text}");
    for word in words {
        assert_eq!(text.matches(word).count(), 1, "{word}\n{text}");
    }
}

/// As [`refuses`], for the scene with one piece replaced.
#[track_caller]
fn refuses_scene(old: &str, new: &str, place: &str, words: &[&str]) {
    refuses(&bench(old, new), &[], place, words);
}

/// As [`refuses`], for a mesh file of that name and contents.
#[track_caller]
fn refuses_mesh(name: &str, contents: impl AsRef<[u8]>, place: &str, words: &[&str]) {
    let bench = bench("slab.inp", name);
    fs::write(bench.path(name), contents).unwrap();
    refuses(&bench, &[], place, words);
}

#[test]
fn the_scene_is_right_but_for_its_mistakes() {
    bench("0.2", "0.2").solve(2, &["--quiet"]);
}

#[test]
fn a_scene_file_that_is_missing() {
    let bench = bench("0.2", "0.2");
    fs::rename(bench.path("scene.toml"), bench.path("other.toml")).unwrap();
    refuses(&bench, &[], "cannot read the scene scene.toml: No such file", &["help: give the path of a TOML file"]);
}

#[test]
fn a_scene_that_is_not_toml() {
    refuses_scene("young = 100.0", "young = = 1", "scene.toml:7:9: this is not TOML", &["| young = = 1"]);
}

#[test]
fn a_misspelt_key() {
    let words = ["unknown key `materail` in body.slab", "| materail = \"rubber\"", "did you mean `material`?"];
    refuses_scene("material = ", "materail = ", "scene.toml:2:1: ", &words);
}

/// Gmsh writes elements without their groups where it is told to save all in format 2.2, though its header names these.
#[test]
fn groups_that_gmsh_has_left_out() {
    let nodes = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1";
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"bottom\"\n3 2 \"slab\"\n$EndPhysicalNames\n\
         $Nodes\n8\n{nodes}\n$EndNodes\n$Elements\n1\n1 5 2 0 1 1 2 3 4 5 6 7 8\n$EndElements\n"
    );
    let help = "help: it has none; Gmsh writes none in format 2.2 with Mesh.SaveAll = 1";
    for (more, place) in [
        ("\ngroup = \"slab\"", "scene.toml:4:9: 'all.msh' has no group 'slab'"),
        ("\nmaterials = { slab = \"rubber\" }", "scene.toml:4:15: body `slab` has no group `slab` of elements"),
    ] {
        let bench = bench("\"slab.inp\"", &format!("\"all.msh\"{more}"));
        bench.write("all.msh", &text);
        refuses(&bench, &[], place, &[help]);
    }
}

#[test]
fn a_value_of_the_wrong_type() {
    let words = ["must be a number, not a string", "| young = \"soft\"", "for example `young = 1.0`"];
    refuses_scene("100.0", "\"soft\"", "scene.toml:7:9: material.rubber.young ", &words);
}

#[test]
fn a_group_that_the_mesh_does_not_have() {
    let words = ["body `slab` has no group `botom`", "did you mean `bottom`? (known: bottom, edge, top)"];
    refuses_scene("slab.bottom", "slab.botom", "scene.toml:21:16: ", &words);
}

#[test]
fn groups_that_are_no_planes_of_symmetry() {
    let symmetry =
        |group: &str| bench("rubber\"\nmesh", &format!("rubber\"\nsymmetry = [\"bottom\", {group:?}]\nmesh"));
    let words = ["`slab.edge` lies in more than one plane", "name a group with all the faces"];
    refuses(&symmetry("edge"), &[], "scene.toml:3:23: ", &words);
    let bench = symmetry("middle");
    bench.write("slab.inp", &(deck([2, 1, 1]) + "\n*NSET, NSET=middle\n2, 5, 8, 11\n"));
    refuses(&bench, &[], "scene.toml:3:23: ", &["body `slab` lies on both sides of `slab.middle`", "mesh one side"]);
}

#[test]
fn a_body_without_material() {
    let words = ["body.slab has no `material`", "| [body.slab]", "add `material = \"NAME\"` (known: rubber)"];
    refuses_scene("material = \"rubber\"\n", "", "scene.toml:1:1: ", &words);
}

#[test]
fn friction_below_zero() {
    let words = ["must be 0 or more, not -0.2", "| friction = -0.2", "Coulomb"];
    refuses_scene("friction = 0.2", "friction = -0.2", "scene.toml:16:12: contact.top.friction ", &words);
}

#[test]
fn an_incompressible_material() {
    let words = ["must be above -1 and below 0.5, not 0.5", "hex8-fbar"];
    refuses_scene("poisson = 0.3", "poisson = 0.5", "scene.toml:8:11: material.rubber.poisson ", &words);
}

#[test]
fn a_step_without_increments() {
    let words = ["step.press has no increments", "add `increments = 20`"];
    refuses_scene("increments = 1\n", "", "scene.toml:18:1: ", &words);
}

#[test]
fn a_mesh_that_is_missing_or_no_mesh() {
    let words = ["cannot read the mesh 'slob.inp'", "No such file", "did you mean `slab.inp`?"];
    refuses_scene("slab.inp", "slob.inp", "scene.toml:3:8: ", &words);
    let junk: Vec<u8> = (0..3000u32).map(|k| (k * k % 251) as u8 | 0x80).collect();
    refuses_mesh("junk.msh", &junk, "junk.msh:1:1: expected a section such as $Nodes", &[]);
    refuses_mesh("junk.inp", &junk, "junk.inp:1:1: expected a keyword such as *NODE", &[]);
    let words = ["'junk.obj' is neither a Gmsh, nor an Abaqus, nor an STL file", "(.msh)", "(.inp)", "(.stl)"];
    refuses_mesh("junk.obj", &junk, "scene.toml:3:8: ", &words);
}

#[test]
fn a_mesh_that_is_cut_off() {
    let whole = deck([2, 1, 1]);
    let words = ["names node 12, which does not exist"];
    refuses_mesh("cut.inp", whole.replace("12, 2.0, 1.0, 1.0\n", ""), "cut.inp", &words);
    let msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0";
    refuses_mesh("cut.msh", msh, "cut.msh:7:", &["2 1 0"]);
}

#[test]
fn an_element_that_is_inside_out() {
    let turned = deck([2, 1, 1]).replace("102, 2, 3, 6, 5, 8, 9, 12, 11", "102, 2, 5, 6, 3, 8, 11, 12, 9");
    let words = ["element 102 is inside out", "turn the order of the nodes over"];
    refuses_mesh("turned.inp", turned, "turned.inp: ", &words);
}

#[test]
fn an_element_that_is_inverted_at_a_corner() {
    let nodes = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 0.2 0.2 1\n8 0 1 1";
    let text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n{nodes}\n$EndNodes\n\
         $Elements\n1\n17 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n"
    );
    let words = ["element 17 is inverted", "Jacobian determinant is negative"];
    refuses_mesh("bent.msh", text, "bent.msh: ", &words);
}

#[test]
fn an_output_folder_that_cannot_be_written() {
    let bench = bench("0.2", "0.2");
    bench.write("file", "");
    let scene = bench.path("scene.toml").display().to_string();
    for out in [bench.path("file/below"), "/proc/nagata".into()] {
        let arguments = ["run", &scene, "--out", out.to_str().unwrap()];
        let text = message(&bench, &nagata(&bench.path(""), 2, &arguments, out.clone()));
        assert!(text.starts_with("error: cannot write to output folder "), "{text}");
        assert!(text.contains("file/below: Not a directory") || text.contains("/proc/nagata: No such file"), "{text}");
        assert!(text.ends_with("help: choose another folder with --out DIR\n"), "{text}");
    }
}

#[test]
fn overrides_that_mean_nothing() {
    let bench = bench("0.2", "0.2");
    refuses(&bench, &["--set", "friction"], "--set friction: the override has no `=`", &["write `--set key=value`"]);
    let unknown = "contact.top.frction=0.1";
    refuses(&bench, &["--set", unknown], &format!("--set {unknown}: "), &["did you mean `friction`?"]);
    let wrong = "material.rubber.young=-1";
    refuses(&bench, &["--set", wrong], &format!("--set {wrong}: "), &["must be above 0, not -1.0"]);
}

#[test]
fn conditions_that_contradict_each_other_in_a_later_step() {
    let second = "\n[[step]]\nname = \"shear\"\nincrements = 1\nfix = [{ set = \"slab.bottom\" }]\n\
                  move = [{ target = \"slab.edge\", by = [0.1, 0.0, 0.0] }]\n";
    let scene = format!("{SCENE}{second}");
    let bench = Bench::new(&scene);
    bench.write("slab.inp", &deck([2, 1, 1]));
    let words =
        ["of `slab.edge` is already moved otherwise along x", "| move = [{ target = \"slab.edge\"", "directions"];
    refuses(&bench, &[], "scene.toml:28:20: node ", &words);
}

#[test]
fn words_after_the_dashes_that_are_no_petsc_options() {
    let bench = bench("0.2", "0.2");
    let words = ["found `snes_monitor`", "help: options after `--` go to PETSc"];
    refuses(&bench, &["--", "snes_monitor"], "PETSc option expected", &words);
    let words = ["/no/such/file", "No such file or directory"];
    refuses(&bench, &["--", "-options_file", "/no/such/file"], "PETSc option -options_file", &words);
}

#[test]
fn flags_that_do_not_exist() {
    let bench = bench("0.2", "0.2");
    refuses(&bench, &["--quit"], "unexpected argument '--quit'", &["'--quiet'", "Usage: nagata run"]);
    refuses(&bench, &["--steps", "0"], "invalid value '0' for '--steps <N>'", &[]);
    let text = message(&bench, &nagata(&bench.path(""), 2, &["solve"], bench.path("out")));
    assert!(text.contains("unrecognized subcommand 'solve'"), "{text}");
}

#[test]
fn an_element_kind_that_does_not_fit_the_mesh() {
    let words = ["the mesh of body `slab` has hexahedra", "leave `element` out"];
    refuses_scene("mesh = ", "element = \"tet4\"\nmesh = ", "scene.toml:3:11: ", &words);
}

/// In two passes, and with an element that does not know of the nodes between its own.
#[test]
fn quadratic_elements_where_they_cannot_be() {
    let nodes = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,.5,0,0\n6,.5,.5,0\n7,0,.5,0\n8,0,0,.5\n9,.5,0,.5\n10,0,.5,.5\n\
                 *ELEMENT, TYPE=C3D10, ELSET=all\n21,1,2,3,4,5,6,7,8,9,10\n";
    let surfaces = "*SURFACE, NAME=bottom\n21, S1\n*SURFACE, NAME=top\n21, S3\n";
    let mesh = |more: &str| {
        let bench = bench("slab.inp", "ten.inp");
        bench.write("ten.inp", &format!("{nodes}{more}{surfaces}"));
        bench
    };
    let words = ["`slab.top` has quadratic faces, which are not for two passes", "let two surfaces meet in one pass"];
    let both = "slave = \"slab.top\"\nmaster = \"slab.bottom\"\ndiscretization = \"two-pass\"\n";
    let passes = bench("slave = \"slab.top\"\nmaster = \"plate\"\n", both);
    passes.write("slab.inp", &format!("{nodes}{surfaces}"));
    refuses(&passes, &[], "scene.toml:14:9: ", &words);
    let mixed = mesh("*NODE\n11,1,1,1\n*ELEMENT, TYPE=C3D4, ELSET=all\n22,2,11,3,4\n");
    let words = ["body `slab` has quadratic elements, such as 21, and linear ones, such as 22", "the same order"];
    refuses(&mixed, &[], "scene.toml:1:7: ", &words);
}

#[test]
fn a_slave_group_without_faces() {
    let words = ["`slab.edge` has no faces", "name a group of faces"];
    refuses_scene("slab.top", "slab.edge", "scene.toml:14:9: ", &words);
}

#[test]
fn plane_strain_with_two_layers() {
    let strain = |source: &str| bench("mesh = \"slab.inp\"", &format!("{source}\nplane_strain = true"));
    let of_file = strain("mesh = \"slab.inp\"");
    of_file.write("slab.inp", &deck([2, 1, 2]));
    let words = ["needs one layer of hexahedra along z: node 7 has others both above and below it", "or fix u_z"];
    refuses(&of_file, &[], "scene.toml:4:16: ", &words);
    let of_block = strain("block = { box = { size = [2, 1, 2] }, elements = [2, 1, 2] }");
    refuses(
        &of_block,
        &[],
        "scene.toml:4:16: ",
        &["has 2 layers of elements along z", "make the third of `elements` 1"],
    );
}

#[test]
fn plane_strain_that_moves_along_z() {
    let target = "move = [{ target = \"plate\", by = [0.0, 0.0, -0.1] }]";
    let bench = bench(target, "move = [{ target = \"slab.top\", by = [0.0, 0.0, -0.1] }]");
    let plane = fs::read_to_string(bench.path("scene.toml")).unwrap();
    let upright = plane.replace("normal = [0.0, 0.0, -1.0]", "normal = [0.0, -1.0, 0.0]");
    bench.write("scene.toml", &upright.replacen("material", "plane_strain = true\nmaterial", 1));
    refuses(&bench, &[], "scene.toml:23:20: ", &["body `slab` is in plane strain", "take `plane_strain` out"]);
}

#[test]
fn a_slave_with_nodes_off_its_faces() {
    let bench = bench("slave = \"slab.top\"", "slave = \"slab.top\"");
    bench.write("slab.inp", &format!("{}*NSET, NSET=top\n1\n", deck([2, 1, 1])));
    refuses(
        &bench,
        &[],
        "scene.toml:14:9: ",
        &["`slab.top` has 1 nodes that are on none of its faces, and 6 that are"],
    );
}

/// Bodies that meet are both in plane strain, between the same planes: nodes of one plane meet the other for all of the layer.
#[test]
fn plane_strain_that_meets_other_layers() {
    let scene = |other: &str, slave: &str, master: &str| {
        Bench::new(&format!(
            r#"
        body.a = {{ material = "m", plane_strain = true, block = {{ box = {{ size = [2.0, 1.0, 0.5] }}, elements = [2, 1, 1] }} }}
        body.b = {{ material = "m", {other}, elements = [2, 1, 1] }} }}
        material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
        contact.c = {{ slave = "{slave}", master = "{master}" }}
        [[step]]
        increments = 1
        fix = [{{ set = "a.ymin" }}, {{ set = "b", directions = "z" }}]
        move = [{{ target = "b.ymax", by = [0.0, -0.1, 0.0], directions = "xy" }}]
        "#
        ))
    };
    let layer = |low: &str, thick: &str| {
        format!("plane_strain = true, block = {{ box = {{ origin = [0.0, 1.0, {low}], size = [2.0, 1.0, {thick}] }}")
    };
    for (low, thick, told) in
        [("0.0", "0.4", "0.0 and 0.4"), ("0.25", "0.5", "0.25 and 0.75"), ("9.0", "0.5", "9.0 and 9.5")]
    {
        let words = ["`a.ymax` lies between z = 0.0 and 0.5, `b.ymin` between ", told, "between the same two z-planes"];
        refuses(&scene(&layer(low, thick), "a.ymax", "b.ymin"), &[], "scene.toml:5:", &words);
    }
    let in_space = layer("0.0", "0.5").replace("plane_strain = true, ", "");
    for (slave, master) in [("a.ymax", "b.ymin"), ("b.ymin", "a.ymax")] {
        let words = ["`a.ymax` is of a body in plane strain, and `b.ymin` is not"];
        refuses(&scene(&in_space, slave, master), &[], "scene.toml:5:", &words);
    }
    scene(&layer("0.0", "0.5"), "a.ymax", "b.ymin").solve(2, &[]);
}

/// Two hexahedra that share no nodes, one half as thick as the other, with surfaces.
fn two_layers() -> String {
    let mut deck = String::from("*NODE\n");
    for (k, (x, thick)) in [(0.0, 0.5), (3.0, 0.25)].into_iter().enumerate() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for (n, (z, [s, t])) in [0.0, thick].into_iter().flat_map(|z| corners.map(|c| (z, c))).enumerate() {
            deck += &format!("{}, {}, {t}, {z}\n", 8 * k + n + 1, x + s);
        }
    }
    deck + "*ELEMENT, TYPE=C3D8, ELSET=all\n1, 1, 2, 3, 4, 5, 6, 7, 8\n2, 9, 10, 11, 12, 13, 14, 15, 16\n\
            *SURFACE, NAME=ymax\n1, S5\n2, S5\n*NSET, NSET=ymin\n1, 2, 5, 6, 9, 10, 13, 14\n*NSET, NSET=xmin\n1, 4, 5, 8\n"
}

/// A tool is drawn out along z over all of the layer; beyond, it may be anything.
#[test]
fn plane_strain_with_tools_that_end_or_change_along_z() {
    let scene = |tool: &str, kind: &str| {
        Bench::new(&format!(
            r#"
            body.b = {{ material = "m", {kind} = true, block = {{ box = {{ size = [2.0, 1.0, 0.5] }}, elements = [4, 2, 1] }} }}
            material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
            tool.t = {{ {tool} }}
            contact.c = {{ slave = "b.ymax", master = "t" }}
            [[step]]
            increments = 1
            fix = [{{ set = "b.ymin", directions = "y" }}, {{ set = "b.xmin", directions = "x" }}]
            move = [{{ target = "t", by = [0.0, -0.1, 0.0] }}]
            "#
        ))
    };
    let kinds = ["plane_strain", "axisymmetric"];
    let help = |kind: &str| if kind == "axisymmetric" { "the tool is a section" } else { "draw the tool out over all" };
    // An arch from side to side, by two parameters and the height of its section.
    let mesh = |kind: &str, smoothing: &str, z: &dyn Fn(f64) -> f64, rise: &dyn Fn(f64) -> f64| {
        let bench = scene(&format!("mesh = \"t.msh\", smoothing = \"{smoothing}\""), kind);
        let place = |s: f64, t: f64| [4.0 * s - 1.0, 1.0 + 0.1 * (4.0 * s - 2.0).powi(2) + rise(z(t)), z(t)];
        bench.write("t.msh", &common::msh::surface(6, place));
        bench
    };
    let along = |low: f64, high: f64| move |t: f64| low + (high - low) * t;
    let straight = |_: f64| 0.0;
    let missing = "has none of it straight above or below at z = ";
    for (kind, smoothing) in [("plane_strain", "nagata"), ("axisymmetric", "facet")] {
        for ([low, high], word) in [
            ([0.1, 0.4], missing),
            ([-1.0, 0.25], missing),
            ([0.25, 3.0], missing),
            ([-1.0, 0.0], "it has nothing there"),
            ([0.6, 3.0], "it has nothing there"),
        ] {
            let bench = mesh(kind, smoothing, &along(low, high), &straight);
            let words = ["tool `t` is not drawn out along z over `b.ymax`, from z = 0.0 to 0.5", word, help(kind)];
            refuses(&bench, &[], "scene.toml:4:", &words);
        }
        refuses(&mesh(kind, smoothing, &along(-1.0, 3.0), &|z| 0.01 * z), &[], "scene.toml:4:", &[missing]);
        refuses(&mesh(kind, smoothing, &along(-1.0, 3.0), &|z| 0.05 * z * z), &[], "scene.toml:4:", &[missing]);
    }
    // As deep as the layer, deeper, in other rows, and with another shape beyond.
    let force = |bench: Bench| bench.solve(2, &[]).history().last("t.fy");
    for kind in kinds {
        let own = force(mesh(kind, "facet", &along(0.0, 0.5), &straight));
        assert!(own < -1.0, "{own}");
        for [low, high] in [[-1.0, 3.0], [0.0, 0.6], [-0.7, 0.5]] {
            let other = force(mesh(kind, "facet", &along(low, high), &straight));
            common::assert_close("force", other, own, 1e-10);
        }
        let beyond = |z: f64| if z > 1.0 { -0.3 * (z - 1.0) } else { 0.0 };
        common::assert_close("force", force(mesh(kind, "facet", &along(-1.0, 3.0), &beyond)), own, 1e-10);
        // Closed by faces across z: in the layer's own planes, and so near to them that nodes are nearer to these than to the die.
        for beyond in [0.0, 1e-6, 1e-3] {
            let bench = scene("mesh = \"t.msh\", smoothing = \"facet\"", kind);
            let (low, high) = (-beyond, 0.5 + beyond);
            let folded = |t: f64| [low, low, low, high, high, high, high][(6.0 * t).round() as usize];
            let up = |t: f64| [2.0, 1.0, 0.0, 0.0, 0.5, 1.0, 2.0][(6.0 * t).round() as usize];
            let closed = |s: f64, t: f64| [4.0 * s - 1.0, 1.0 + 0.1 * (4.0 * s - 2.0).powi(2) + up(t), folded(t)];
            bench.write("t.msh", &common::msh::surface(6, closed));
            common::assert_close("force", force(bench), own, 1e-10);
        }
    }
    // A face across the layer.
    let bench = scene("mesh = \"t.msh\"", "plane_strain");
    let folded = |t: f64| (0.375 * t).min(0.25);
    let closed = |s: f64, t: f64| [4.0 * s - 1.0, 1.0 + (6.0 * t - 4.0).max(0.0), folded(t)];
    bench.write("t.msh", &common::msh::surface(6, closed));
    refuses(&bench, &[], "scene.toml:4:", &["it has a face across z at "]);
    // Parts of a body between unlike planes.
    let bench = scene("plane = { point = [0.0, 1.0, 0.0], normal = [0.0, -1.0, 0.0] }", "plane_strain");
    let text = fs::read_to_string(bench.path("scene.toml")).unwrap();
    let (_, rest) = text.split_once("} }").unwrap();
    bench.write("b.inp", &two_layers());
    bench.write("scene.toml", &format!("body.b = {{ material = \"m\", plane_strain = true, mesh = \"b.inp\" }}{rest}"));
    refuses(&bench, &[], "scene.toml:1:", &["but its part with node 9 between 0.0 and 0.25: they are one layer"]);
    // Profiles that end, and CAD.
    let profile = |low: f64, length: f64| {
        let extrude = format!(
            "extrude = {{ origin = [0.0, 0.0, {low}], x = [0.0, 1.0, 0.0], y = [-1.0, 0.0, 0.0], length = {length} }}"
        );
        scene(&format!("profile = {{ points = [[1.0, 1.0], [1.0, -3.0]], {extrude} }}"), "plane_strain")
    };
    for (low, length, ends) in [(0.1, 0.2, "0.1 to 0."), (-1.0, 1.2, "-1.0 to 0."), (0.2, 3.0, "0.2 to 3.2")] {
        refuses(&profile(low, length), &[], "scene.toml:4:", &[&format!("it goes from z = {ends}")]);
    }
    for (low, length) in [(0.0, 0.5), (-1.0, 3.0)] {
        assert!(force(profile(low, length)) < -1.0);
    }
    let iges = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/ironing-indenter.igs");
    for (thick, is_right) in [("0.5", true), ("9.0", false)] {
        let bench = scene(&format!("nurbs = {iges:?}"), "plane_strain");
        let text = fs::read_to_string(bench.path("scene.toml")).unwrap();
        bench.write(
            "scene.toml",
            &text
                .replace("1.0, 0.5]", &format!("1.0, {thick}]"))
                .replace("{ size", "{ origin = [20.0, -1.0, 0.0], size"),
        );
        match is_right {
            true => assert!(force(bench) < -1.0),
            false => refuses(&bench, &[], "scene.toml:4:", &[missing]),
        }
    }
}

/// A body in plane strain meets tools that are as it is.
#[test]
fn plane_strain_with_tools_in_space() {
    let scene = |tool: &str, how: &str| {
        Bench::new(&format!(
            r#"
            body.b = {{ material = "m", plane_strain = true, block = {{ box = {{ size = [2.0, 1.0, 0.5] }}, elements = [2, 1, 1] }} }}
            material.m = {{ model = "neo-hookean", young = 100.0, poisson = 0.3 }}
            tool.t.{tool}
            contact.c = {{ slave = "b.ymax", master = "t" }}
            [[step]]
            increments = 1
            fix = [{{ set = "b.ymin" }}]
            move = [{{ target = "t", {how} }}]
            "#
        ))
    };
    let down = "by = [0.0, -0.1, 0.0]";
    let ball = "sphere = { center = [1.0, 2.0, 0.25], radius = 1.0 }";
    let inclined = "plane = { point = [0.0, 1.0, 0.0], normal = [0.0, -1.0, 0.1] }";
    for tool in [ball, inclined] {
        refuses(
            &scene(tool, down),
            &[],
            "scene.toml:4:",
            &["tool `t` is not drawn out along z, but meets a body in plane strain"],
        );
    }
    let roll = "cylinder = { point = [1.0, 2.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }";
    for (how, word) in [
        ("by = [0.0, -0.1, 0.1]", "moves along z"),
        ("rotate = { point = [1.0, 2.0, 0.0], axis = [1.0, 0.0, 0.0], angle = 9.0 }", "turns out of the plane"),
    ] {
        refuses(&scene(roll, how), &[], "scene.toml:9:", &[word]);
    }
    for (driven, word) in [
        ("force = [{ target = \"t\", total = [0.0, -1.0, 0.0], directions = \"yz\" }]", "moves along z"),
        (
            "torque = [{ tool = \"t\", total = 1.0, axis = [1.0, 0.0, 0.0], point = [1.0, 2.0, 0.0] }]",
            "turns out of the plane",
        ),
    ] {
        let bench = scene(roll, down);
        let text = fs::read_to_string(bench.path("scene.toml")).unwrap();
        let moved = format!("move = [{{ target = \"t\", {down} }}]");
        assert!(text.contains(&moved));
        bench.write("scene.toml", &text.replace(&moved, driven));
        refuses(&bench, &[], "scene.toml:9:", &[word]);
    }
}

const PLATE: &str = "plane = { point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }";

#[test]
fn fillets_that_do_not_fit() {
    let profile = "profile = { points = [[0.0, 3.0], [0.0, 0.0], [4.0, 0.0]], fillets = 3.5 }";
    let words =
        ["tool.plate.profile.fillets.1 does not fit: the line from points.0 to points.1 is 3 long", "smaller fillets"];
    refuses_scene(PLATE, profile, "scene.toml:11:70: ", &words);
}

/// One side of what crosses itself looks the wrong way.
#[test]
fn a_profile_that_crosses_itself() {
    let word = ["tool.plate.profile.points.3 begins a line that crosses the one from points.0 to points.1"];
    let open = "profile = { points = [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [1.0, 3.0], [1.0, -1.0], [0.0, -1.0]] }";
    refuses_scene(PLATE, open, "scene.toml:11:59: ", &word);
    let word = ["tool.plate.profile.points.2 begins a line that crosses the one from points.0 to points.1"];
    let closed = "profile = { points = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]], closed = true }";
    refuses_scene(PLATE, closed, "scene.toml:11:47: ", &word);
}

#[test]
fn cad_files_that_cannot_be_read() {
    let broken = bench(PLATE, "bezier = \"plate.bpt\"");
    broken.write("plate.bpt", "2\n1 1\n0 0 1\n0 9 1\n9 0 1\n9 9 1\n0 1\n0 0 0\n0 0 0\n");
    refuses(&broken, &[], "plate.bpt:7:1: patch 2", &["the degree is 0", "incomplete = true leaves out"]);
    let warned = broken.solve(2, &["--set", "tool.plate.incomplete=true"]).log();
    assert!(
        warned.contains("  warning: tool `plate`: ") && warned.contains("left out patch 2: the degree is 0"),
        "{warned}"
    );
    let missing = bench(PLATE, "nurbs = \"plate.igs\"");
    refuses(&missing, &[], "scene.toml:11:9: cannot read the CAD file", &["plate.igs'"]);
}

#[test]
fn a_mesh_whose_normals_are_those_of_another_surface() {
    let tool = "mesh = \"slab.inp\"\nnormals = \"sphere\"\nsphere = { center = [9.0, 0.0, 0.0], radius = 1.0 }";
    let tool = bench(PLATE, &tool.replace("slab", "plate"));
    tool.write(
        "plate.inp",
        "*Node\n1, 0, 0, 1\n2, 9, 0, 1\n3, 9, 9, 1\n4, 0, 9, 1\n*Element, type=R3D4\n1, 1, 4, 3, 2\n",
    );
    refuses(&tool, &[], "scene.toml:12:11: node 4 of ", &["away from the sphere", "unit of length"]);
}

#[test]
fn check_refuses_what_run_refuses() {
    let bench = bench("slab.bottom", "slab.botom");
    let scene = bench.path("scene.toml").display().to_string();
    let text = message(&bench, &nagata(&bench.path(""), 2, &["check", &scene], bench.path("out")));
    assert!(text.starts_with("error: scene.toml:21:16: body `slab` has no group `botom`"), "{text}");
}

/// Mistakes in tables that know of each other by name alone are told together, in the order of the file, and no others.
#[test]
fn all_mistakes_of_a_scene_at_once() {
    let scene = SCENE
        .replace("young = 100.0\npoisson = 0.3", "young = -1.0\npoisson = 0.7\ndensty = 1")
        .replace("plane = {", "plan = {")
        .replace(
            "\"slab.top\"\nmaster = \"plate\"\nfriction = 0.2",
            "\"slob.top\"\nmaster = \"plate\"\nfriction = \"a\"",
        )
        .replace("\"slab.bottom\" }]", "\"slab.bottom\", directions = \"w\" }]")
        .replace("[0.0, 0.0, -0.1] }", "[0.0, 0.0] }")
        + "\n[[step]]\nkeep = true\n[output]\nevery = 0\nhistory = [\"slip.top\"]\n";
    let bench = Bench::new(&scene);
    let run = bench.run(2, &[]);
    let folder = format!("{}/", bench.path("").display().to_string().trim_end_matches('/'));
    let text = run.stderr.replace(&folder, "");
    assert_eq!((run.code, run.stdout.as_str(), run.out.exists()), (2, "", false), "{text}");
    let places: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("error: ")).collect();
    let expected = [
        "scene.toml:9:1: unknown key `densty` in material.rubber",
        "scene.toml:12:1: unknown key `plan` in tool.plate",
        "scene.toml:15:9: contact.top.slave names the unknown body `slob`",
        "scene.toml:17:12: contact.top.friction must be a number",
        "scene.toml:22:44: step.press.fix.0.directions must be some of the letters",
        "scene.toml:23:34: step.press.move.0.by must be a list of 3 numbers",
        "scene.toml:28:9: output.every must be 1 or more",
        "scene.toml:29:12: output.history.0 names the unknown body `slip`",
    ];
    assert_eq!(places.len(), expected.len() + 1, "{text}");
    for place in expected {
        assert!(places.iter().any(|told| told.starts_with(place)), "{place}\n{text}");
    }
    // A step has no increments; what it keeps of one that is wrong is not asked.
    assert!(text.contains("step.1 has no increments") && !text.contains("could keep"), "{text}");
    // When they are mended, what stood behind them; then groups of meshes, all at once.
    let scene = SCENE.replace("young = 100.0\npoisson = 0.3", "young = -1.0\npoisson = 0.7");
    bench.write("scene.toml", &scene);
    let told = bench.run(1, &[]).stderr;
    assert!(told.contains("young must be above 0") && told.contains("poisson must be above -1"), "{told}");
    bench.write("scene.toml", &SCENE.replace("slab.top", "slab.tip").replace("slab.bottom", "slab.button"));
    bench.write("slab.inp", &deck([2, 1, 1]));
    let run = bench.run(2, &[]);
    let told = run.stderr;
    assert!(told.contains("no group `tip`") && told.contains("no group `button`") && run.code == 2, "{told}");
}

#[test]
fn a_mark_before_utf_8_is_read_over_and_utf_16_named() {
    let wide = |text: &str| -> Vec<u8> {
        [vec![0xff, 0xfe], text.encode_utf16().flat_map(u16::to_le_bytes).collect()].concat()
    };
    let bench = bench("0.2", "0.2");
    let mark = |text: &str| [b"\xef\xbb\xbf", text.as_bytes()].concat();
    fs::write(bench.path("scene.toml"), mark(SCENE)).unwrap();
    fs::write(bench.path("slab.inp"), mark(&deck([2, 1, 1]))).unwrap();
    bench.solve(1, &["--quiet"]);
    fs::write(bench.path("slab.inp"), wide(&deck([2, 1, 1]))).unwrap();
    fs::write(bench.path("scene.toml"), SCENE).unwrap();
    let words = ["slab.inp' is in UTF-16, as some editors", "iconv -f UTF-16 -t UTF-8 'slab.inp' > NEW"];
    refuses(&bench, &[], "scene.toml:3:8: the mesh '", &words);
    fs::write(bench.path("scene.toml"), wide(SCENE)).unwrap();
    refuses(&bench, &[], "the scene scene.toml is in UTF-16", &["-t UTF-8 'scene.toml' > NEW"]);
}

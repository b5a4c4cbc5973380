//! Bodies and tools that overlap at the start, as fits and seals do: pushed out at once, or over the first step.

mod common;

use common::{Bench, Run, assert_close, sector};

/// A shaft of 1.3 in a hub of 1, 30 degrees of both, in plane strain: an overlap of three fifths of a facet.
fn fit(contact: &str) -> Bench {
    Bench::new(&format!(
        "{}{}material.m = {{ model = \"hooke\", young = 1000.0, poisson = 0.3 }}\n\
         contact.c = {{ slave = \"hub.rmin\", master = \"shaft.rmax\", reach = 0.5, {contact} }}\n\
         [[step]]\nincrements = 4\n[[step]]\nincrements = 1\n[output]\nhistory = [\"hub.amin\"]\n",
        sector("shaft", [0.5, 1.3], [5, 6]),
        sector("hub", [1.0, 2.0], [8, 9])
    ))
}

const RAMPED: &str = "interference = \"ramped\"";

/// What is pushed out little by little ends where what is pushed out at once does, and is as deep as it may be on the way.
#[test]
fn a_ramped_fit_ends_as_one_at_once() {
    for (how, tolerance) in [
        ("discretization = \"one-pass\"", 1e-9),
        ("discretization = \"two-pass\"", 1e-9),
        ("discretization = \"segment\"", 1e-5),
        ("method = \"lagrange\"", 1e-9),
        ("method = \"uzawa\"", 1e-6),
        ("method = \"penalty\"", 1e-9),
        ("friction = 0.3", 1e-2),
    ] {
        let at_once = fit(&format!("{how}, interference = \"at-once\"")).solve(1, &[]).history();
        let run = fit(&format!("{how}, {RAMPED}")).solve(2, &[]);
        let ramped = run.history();
        assert_eq!((at_once.len(), ramped.len()), (5, 5), "{how}");
        for row in [3, 4] {
            for name in ["c.max_pressure", "hub.amin.fy"] {
                assert_close(how, ramped.column(name)[row], at_once.column(name)[row], tolerance);
            }
        }
        let (pressures, depths) = (ramped.column("c.max_pressure"), ramped.column("c.max_penetration"));
        assert!(pressures[..4].is_sorted() && pressures[0] < 0.35 * pressures[3], "{how}: {pressures:?}");
        for (row, left) in [0.75, 0.5, 0.25, 0.0].into_iter().enumerate() {
            assert!((depths[row] - 0.3 * left).abs() < 3e-3, "{how}: {depths:?}");
        }
        assert!(!run.log().contains("warning: contact"), "{how}: {}", run.log());
    }
}

/// An overlap that is less than what the facets of the master lack of their arc is told, for it is off by as much; patches have next to
/// none.
#[test]
fn a_shallow_fit_on_coarse_facets_is_told() {
    for (smoothing, is_told) in [("facet", true), ("nagata", false)] {
        let run = Bench::new(&format!(
            "{}{}material.m = {{ model = \"hooke\", young = 1000.0, poisson = 0.3 }}\n\
             contact.c = {{ slave = \"shaft.rmax\", master = \"hub.rmin\", smoothing = {smoothing:?} }}\n[[step]]\nincrements = 1\n",
            sector("shaft", [0.5, 1.001], [5, 9]),
            sector("hub", [1.0, 2.0], [8, 6])
        ))
        .solve(2, &[]);
        let told =
            run.log().lines().find(|line| line.contains("off the arcs that its faces stand for")).map(String::from);
        println!("{smoothing}: {told:?}");
        assert_eq!(told.is_some(), is_told, "{smoothing}");
    }
}

/// A rubber ring between two walls that are too near, and so through it by a tenth of its thickness.
fn seat(settings: &str) -> Bench {
    let mesh = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs/face-seal.msh");
    let wall = |name: &str, point: &str, normal: &str| {
        format!(
            "tool.{name}.plane = {{ point = {point}, normal = {normal} }}\n\
             contact.{name} = {{ slave = \"ring.outside\", master = \"{name}\", friction = 0.1{settings} }}\n"
        )
    };
    Bench::new(&format!(
        "body.ring = {{ mesh = {mesh:?}, material = \"rubber\", axisymmetric = true }}\n\
         material.rubber = {{ model = \"neo-hookean\", young = 6.0, poisson = 0.499 }}\n{}{}{}\
         [[step]]\nincrements = 4\nforce = [{{ target = \"ring\", total = [0.0, -1.0, 0.0] }}]\n",
        wall("inner", "[20.135, 0.0, 0.0]", "[1.0, 0.0, 0.0]"),
        wall("outer", "[24.865, 0.0, 0.0]", "[-1.0, 0.0, 0.0]"),
        wall("floor", "[0.0, -2.665, 0.0]", "[0.0, 1.0, 0.0]"),
    ))
}

/// Where no increment pushes an overlap out at once, however short, it is ramped, and that is told.
#[test]
fn what_cannot_be_pushed_out_at_once_is_ramped() {
    let run = seat("").solve(2, &[]);
    let told =
        |run: &Run| run.log().contains("no increment was found that pushes its overlap of up to 3.000e-1 out at once");
    assert!(told(&run) && run.history().len() < 8, "{}", run.log());
    let asked = seat(&format!(", {RAMPED}")).solve(1, &[]);
    assert!(!told(&asked));
    for name in ["inner.fx", "outer.fx"] {
        assert_close(name, run.history().last(name), asked.history().last(name), 1e-8);
    }
}

#[test]
fn neither_interference_nor_two_passes_are_for_a_surface_that_meets_itself() {
    for (key, rest) in [("interference", RAMPED), ("discretization", "discretization = \"two-pass\"")] {
        let run = fit(rest).run(1, &["--set", "contact.c.master=hub.rmin"]);
        let told = format!("contact.c.{key} means nothing in self-contact");
        assert!(run.code == 2 && run.stderr.contains(&told), "{}", run.stderr);
    }
}

/// What is pushed out is not let in again where a later increment fails.
#[test]
fn what_is_pushed_out_stays_out() {
    let run = Bench::new(
        r#"
[body.b]
material = "m"
axisymmetric = true
element = "hex8-sri"
block = { box = { size = [3.0, 1.0, 0.1] }, elements = [18, 6, 1] }
[material.m]
model = "j2"
young = 1000.0
poisson = 0.3
yield_stress = 5.0
hardening = { linear = 20.0 }
[tool.floor]
plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }
[tool.ball]
cylinder = { point = [0.0, 2.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 1.0 }
[tool.bore]
plane = { point = [2.99, 0.0, 0.0], normal = [-1.0, 0.0, 0.0] }
[contact.floor]
slave = "b.ymin"
master = "floor"
friction = 0.3
[contact.ball]
slave = "b.ymax"
master = "ball"
friction = 0.3
[contact.bore]
slave = "b.xmax"
master = "bore"
friction = 0.2
[[step]]
increments = 5
move = [{ target = "ball", by = [0.0, -0.2, 0.0] }]
"#,
    )
    .solve(1, &[]);
    assert!(!run.log().contains("pushed out over the step"), "{}", run.log());
    run.history().column("bore.max_penetration").iter().for_each(|deep| assert!(*deep < 1e-9, "{deep}"));
}

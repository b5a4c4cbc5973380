//! The simulation as a program drives it: going back, stopping, steps of its own, failures with their types.

mod common;

use common::{mpirun_of, on_ranks};
use mpi::topology::SimpleCommunicator;
use nagata::Vec3;
use nagata::analysis::{Event, Observer, Simulation};
use nagata::contact::Status;
use nagata::error::{Error, Result};
use nagata::failure::Cause;
use nagata::scene::{self, Scene, Step};
use petsc::Petsc;
use std::path::{Path, PathBuf};
use std::process::Command;

fn scene(body: &str, step: &str) -> Scene {
    let text = format!(
        r#"
body.block.block = {{ box = {{ origin = [-8, -8, 0], size = [16, 16, 8] }}, elements = [4, 4, 2], faces = {{ bottom = "zmin", top = "zmax" }} }}
body.block.material = "m"
material.m = {{ {body} }}
tool.ball.sphere = {{ center = [0, 0, 18], radius = 10 }}
contact.top = {{ slave = "block.top", master = "ball", friction = 0.3 }}
step = [{{ name = "press", {step}, fix = [{{ set = "block.bottom" }}], move = [{{ target = "ball", by = [0, 0, -1] }}] }}]
"#
    );
    scene::parse("test", &text, Path::new("."), &[]).unwrap()
}

const RUBBER: &str = r#"model = "neo-hookean", young = 10.0, poisson = 0.4"#;
const STEEL: &str = r#"model = "j2", young = 200.0, poisson = 0.3, yield_stress = 5.0, hardening = { linear = 20.0 }"#;

fn slide() -> Step {
    Step::new("slide", 4).fixing("block.bottom").moving("ball", [1.0, 0.0, 0.0])
}

fn silent() -> impl FnMut(&Event) -> Result<()> {
    |_| Ok(())
}

/// Goes to the end of the step; the forces on the way.
fn finish(simulation: &mut Simulation) -> Vec<[f64; 3]> {
    let mut forces = Vec::new();
    while simulation.advance(&mut silent()).unwrap().is_some() {
        forces.push(simulation.tool("ball").unwrap().force.into());
    }
    forces
}

/// But for rounding, which of MUMPS on several ranks is another each time.
fn assert_same(found: &[[f64; 3]], expected: &[[f64; 3]]) {
    let close =
        |(f, e): (&[f64; 3], &[f64; 3])| (Vec3::from(*f) - Vec3::from(*e)).norm() < 1e-11 * Vec3::from(*e).norm();
    assert!(found.len() == expected.len() && found.iter().zip(expected).all(close), "{found:?} {expected:?}");
}

fn with_petsc(comm: &SimpleCommunicator, body: impl FnOnce(&Petsc)) {
    let petsc = Petsc::initialize(comm, &[]).unwrap();
    petsc.reserve_memory().unwrap();
    body(&petsc);
}

#[test]
fn what_is_gone_back_to_comes_again() {
    on_ranks("what_is_gone_back_to_comes_again", &[1, 2], |comm| {
        with_petsc(comm, |petsc| {
            for body in [RUBBER, STEEL] {
                let scene = scene(body, "increments = 4");
                let mut simulation = Simulation::new(comm, petsc, &scene).unwrap();
                let begin = simulation.checkpoint();
                simulation.begin(&scene.steps[0]).unwrap();
                simulation.advance(&mut silent()).unwrap();
                simulation.advance(&mut silent()).unwrap();
                let amid = simulation.checkpoint();
                let pressed = finish(&mut simulation);
                simulation.begin(&slide()).unwrap();
                simulation.advance(&mut silent()).unwrap();
                let sliding = simulation.checkpoint();
                let slid = finish(&mut simulation);
                assert!(pressed.len() == 2 && slid.len() == 3 && slid[2][0] > 0.0, "{pressed:?} {slid:?}");
                // Within a step, from another step, and from before all steps.
                simulation.go_back(&sliding).unwrap();
                assert_same(&finish(&mut simulation), &slid);
                simulation.go_back(&amid).unwrap();
                assert_eq!(simulation.state().time, 0.5);
                assert_same(&finish(&mut simulation), &pressed);
                simulation.begin(&slide()).unwrap();
                assert_same(&finish(&mut simulation)[1..], &slid);
                simulation.go_back(&begin).unwrap();
                simulation.begin(&scene.steps[0]).unwrap();
                assert_same(&finish(&mut simulation)[2..], &pressed);
            }
        });
    });
}

#[test]
fn a_step_that_is_left_keeps_the_loads_that_it_has() {
    on_ranks("a_step_that_is_left_keeps_the_loads_that_it_has", &[1, 2], |comm| {
        with_petsc(comm, |petsc| {
            let scene = scene(RUBBER, "increments = 4");
            let mut simulation = Simulation::new(comm, petsc, &scene).unwrap();
            simulation.begin(&scene.steps[0]).unwrap();
            finish(&mut simulation);
            let push = |force| {
                Step::new("push", 2).fixing("block.bottom").pushing("ball", [0.0, 0.0, force], [false, false, true])
            };
            simulation.begin(&push(-80.0)).unwrap();
            simulation.advance(&mut silent()).unwrap();
            let half = simulation.tool("ball").unwrap().force.z;
            // Left half way, and to the same force: nothing changes.
            simulation.begin(&push(half)).unwrap();
            let forces = finish(&mut simulation);
            assert!(forces.iter().all(|f| (f[2] - half).abs() < 1e-6 * half.abs()), "{half} {forces:?}");
            let reaction = simulation.set("block.bottom").unwrap().reaction.z;
            assert!((reaction + half).abs() < 1e-6 * half.abs(), "{reaction} {half}");
            let nodes: Vec<_> = simulation.contact("top").filter(|n| n.status != Status::Gap).collect();
            assert!(nodes.iter().all(|n| n.gap.is_some_and(|gap| gap.abs() < 1e-6) && n.force.z < 0.0), "{nodes:?}");
        });
    });
}

#[test]
fn failures_and_observers_end_it_and_lose_nothing() {
    on_ranks("failures_and_observers_end_it_and_lose_nothing", &[2], |comm| {
        with_petsc(comm, |petsc| {
            let scene = scene(RUBBER, "increment = { initial = 0.25, min = 0.2, max = 0.25 }");
            let mut simulation = Simulation::new(comm, petsc, &scene).unwrap();
            simulation.begin(&scene.steps[0]).unwrap();
            let mut told = 0;
            let mut stop: Box<Observer> = Box::new(|event: &Event| {
                told += usize::from(matches!(event, Event::Iteration(_)));
                match event {
                    Event::Iteration(at) if at.number == 2 => Err(Error::System("enough".into())),
                    _ => Ok(()),
                }
            });
            let error = simulation.advance(&mut *stop).unwrap_err();
            drop(stop);
            assert_eq!((error.to_string().as_str(), told, simulation.state().time), ("enough", 3, 0.0));
            // It goes on where it was.
            assert_eq!(finish(&mut simulation).len(), 4);
            let mut deep = Step::new("deep", 1).fixing("block.bottom").moving("ball", [0.0, 0.0, -12.0]);
            deep.increment.min = 1.0;
            simulation.begin(&deep).unwrap();
            let Err(Error::Diverged(failure)) = simulation.advance(&mut silent()) else { panic!("it converged") };
            assert!(
                matches!(failure.cause, Cause::Iteration | Cause::Watch)
                    && failure.time == 1.0
                    && failure.step == "deep",
                "{failure:?}"
            );
            assert!(
                failure.place.as_ref().is_none_or(|p| p.body == "block") && !failure.what.is_empty(),
                "{failure:?}"
            );
            let before = simulation.state().u.clone();
            simulation.begin(&slide()).unwrap();
            assert_eq!((simulation.state().time, &simulation.state().u), (1.0, &before));
            assert_eq!(finish(&mut simulation).len(), 4);
            let unknown = simulation.begin(&Step::new("no", 1).fixing("block.side")).unwrap_err();
            assert!(
                matches!(unknown, Error::Input { .. }) && unknown.to_string().contains("no `block.side`"),
                "{unknown}"
            );
            let twice = slide().moving("ball", [0.0, 1.0, 0.0]);
            assert!(simulation.begin(&twice).unwrap_err().to_string().contains("moves `ball` twice"));
        });
    });
}

#[test]
fn the_example_says_the_same_on_all_ranks() {
    // One file of tests alone does not build examples.
    let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
    let build = ["build", "--quiet", "--locked", "--example", "driver", "--profile", profile];
    assert!(Command::new(env!("CARGO")).args(build).status().unwrap().success());
    // Beside this test: target/release/examples.
    let example: PathBuf = std::env::current_exe().unwrap().parent().unwrap().with_file_name("examples").join("driver");
    let said = [1, 2].map(|ranks| {
        let output = mpirun_of(ranks, &example).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    });
    assert!(said[0].starts_with("the ball bears 60.0000 N") && said[0].contains("all 9 nodes slip"), "{}", said[0]);
    assert_eq!(said[0], said[1]);
}

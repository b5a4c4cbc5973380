//! Drives a simulation: a rigid ball is pressed into a block until it bears 60 N, found by going back and trying again; then
//! it is drawn along until everything that touches slips. Prints what it did; any number of ranks:
//! `cargo run --release --example driver`.

use mpi::traits::*;
use nagata::analysis::{Event, Simulation};
use nagata::contact::Status;
use nagata::error::{Error, Result};
use nagata::parallel::sum;
use nagata::scene::{self, Step};
use petsc::Petsc;
use std::path::Path;

const SCENE: &str = r#"
body.block.block = { box = { origin = [-8, -8, 0], size = [16, 16, 8] }, elements = [8, 8, 4], faces = { bottom = "zmin", top = "zmax" } }
body.block.material = "rubber"
material.rubber = { model = "neo-hookean", young = 10.0, poisson = 0.4 }
tool.ball.sphere = { center = [0, 0, 18], radius = 10 }
contact.top = { slave = "block.top", master = "ball", friction = 0.3 }
step = [{ name = "press", increments = 8, fix = [{ set = "block.bottom" }], move = [{ target = "ball", by = [0, 0, -2] }] }]
"#;

/// Force to be borne, N, and how closely.
const FORCE: f64 = 60.0;
const CLOSELY: f64 = 1e-6;

fn main() -> Result<()> {
    let universe = mpi::initialize().ok_or_else(|| Error::System("MPI cannot be initialized".into()))?;
    let world = universe.world();
    let petsc = Petsc::initialize(&world, &[])?;
    let scene = scene::parse("driver", SCENE, Path::new("."), &[])?;
    let mut simulation = Simulation::new(&world, &petsc, &scene)?;
    let say = |text: String| {
        if world.rank() == 0 {
            println!("{text}");
        }
    };
    let mut iterations = 0;
    let mut observer = |event: &Event| {
        iterations += usize::from(matches!(event, Event::Iteration(at) if at.number > 0));
        Ok(())
    };
    let force = |simulation: &Simulation| simulation.tool("ball").map_or(0.0, |ball| -ball.force.z);

    simulation.begin(&scene.steps[0])?;
    let mut before = simulation.checkpoint();
    while force(&simulation) < FORCE && simulation.advance(&mut observer)?.is_some() {
        if force(&simulation) < FORCE {
            before = simulation.checkpoint();
        }
    }
    // The last increment went too far: back, and on by the share that the secant says, until it fits.
    let (mut by, mut reached) = (-0.25, force(&simulation));
    while (reached - FORCE).abs() > CLOSELY * FORCE {
        simulation.go_back(&before)?;
        let began = force(&simulation);
        by *= (FORCE - began) / (reached - began);
        simulation.begin(&Step::new("fit", 1).fixing("block.bottom").moving("ball", [0.0, 0.0, by]))?;
        simulation.advance(&mut observer)?;
        reached = force(&simulation);
    }
    let depth = simulation.tool("ball").map_or(0.0, |ball| -ball.displacement.z);
    say(format!("the ball bears {reached:.4} N at a depth of {depth:.6}"));

    simulation.begin(&Step::new("draw", 40).fixing("block.bottom").moving("ball", [4.0, 0.0, 0.0]))?;
    while let Some(increment) = simulation.advance(&mut observer)? {
        let sticks = |status: Status| f64::from(status == Status::Stick);
        let mut sticking = [simulation.contact("top").map(|node| sticks(node.status)).sum()];
        sum(&world, &mut sticking);
        if sticking[0] == 0.0 {
            let Some(ball) = simulation.tool("ball") else { break };
            let ratio = ball.force.x / -ball.force.z;
            say(format!(
                "all {} nodes slip at a way of {:.3}: drag over load {ratio:.4}",
                increment.nodes.touching, ball.displacement.x
            ));
            break;
        }
    }
    say(format!("{iterations} iterations"));
    Ok(())
}

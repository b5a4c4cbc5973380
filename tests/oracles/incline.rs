//! ```text
//!               __--+         An elastic block under its weight on a rigid slope: held by friction alone it stays while tan(angle) <
//!            |block |         mu, and slides above. mu = 0.3, 1, 5; flat enough not to tip.
//!            |__--   g v
//!         __-- angle
//! ```
//! In the frame of the slope: gravity leans. Below the limit the run must end with the block where it was, above it must not
//! end well; and the force along the slope that moves it is mu N less what the weight adds.

use crate::bench;
use crate::common::Run;
use crate::table::Oracle;

const LENGTH: f64 = 40.0;
const WEIGHT: f64 = 2.0;

/// Gravity leans until tan(angle) is `slope` times mu; then a step that moves the upper end by `pull` down the slope, unless
/// it is zero.
fn run(mu: f64, slope: f64, pull: f64) -> Run {
    let angle = (mu * slope).atan();
    let density = WEIGHT / LENGTH;
    let weight = format!(
        "body_force = [{{ body = \"block\", per_volume = [{:?}, {:?}, 0.0] }}]",
        density * angle.sin(),
        -density * angle.cos()
    );
    let pulled = format!(
        r#"
        [[step]]
        name = "pull"
        increments = 4
        {weight}
        move = [{{ target = "block.xmax", by = [{pull:?}, 0.0, 0.0], directions = "x" }}]
        "#
    );
    let scene = format!(
        r#"
        [body.block]
        material = "soft"
        plane_strain = true
        block = {{ box = {{ size = [{LENGTH:?}, 1.0, 1.0] }}, elements = [40, 2, 1] }}
        [material.soft]
        model = "neo-hookean"
        young = 1000.0
        poisson = 0.3
        [tool.slope]
        plane = {{ point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] }}
        [contact.foot]
        slave = "block.ymin"
        master = "slope"
        friction = {mu:?}
        [[step]]
        name = "lean"
        increments = 4
        {weight}
        {}
        [output]
        every = 100
        history = ["block.xmax"]
        "#,
        if pull == 0.0 { "" } else { &pulled }
    );
    bench(&scene, &[]).run(1, &[])
}

const FRICTIONS: [f64; 3] = [0.3, 1.0, 5.0];

#[test]
fn holds_below() {
    let mut oracle = Oracle::new("block on an incline");
    for mu in FRICTIONS {
        let done = run(mu, 0.999, 0.0);
        let case = format!("mu {mu}, tan = 0.999 mu");
        oracle.within(&format!("exit code, {case}"), f64::from(done.code), 0.0, 0.0);
        if done.code == 0 {
            let history = done.history();
            let ratio = -history.last("slope.fx") / history.last("slope.fy");
            oracle.close(&format!("force ratio over mu, {case}"), ratio / mu, 0.999, 1e-6);
            // The weight strains the block by no more than its own length under it.
            let elastic = WEIGHT * LENGTH / 1000.0;
            oracle.within(&format!("moved by, {case}"), history.last("block.xmax.ux"), 0.0, elastic);
        }
    }
}

#[test]
fn slides_above() {
    let mut oracle = Oracle::new("block on an incline");
    for mu in FRICTIONS {
        let done = run(mu, 1.001, 0.0);
        println!("{}", done.stderr);
        oracle.within(&format!("exit code, mu {mu}, tan = 1.001 mu"), f64::from(done.code), 1.0, 0.0);
    }
}

#[test]
fn pulled() {
    let mut oracle = Oracle::new("block on an incline");
    for mu in FRICTIONS {
        let done = run(mu, 0.5, 1.0);
        let case = format!("mu {mu}, tan = 0.5 mu");
        oracle.within(&format!("exit code, pulled, {case}"), f64::from(done.code), 0.0, 0.0);
        if done.code == 0 {
            let history = done.history();
            let ratio = -history.last("slope.fx") / history.last("slope.fy");
            oracle.close(&format!("force ratio over mu, pulled, {case}"), ratio / mu, 1.0, 1e-6);
            let angle = (0.5 * mu).atan();
            let force = history.last("block.xmax.fx") / (WEIGHT * (mu * angle.cos() - angle.sin()));
            oracle.close(&format!("pull over closed form, {case}"), force, 1.0, 1e-6);
        }
    }
}

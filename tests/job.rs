//! The job that `scripts/job` prints for Slurm, in the hands of a shell that plays Slurm: it ends in order when its time is
//! short, asks to be queued again, goes on, and ends with the run.

mod common;

use common::Bench;
use common::jobs::{BLOCK_UNDER_PLATE, rows_in, send, wait_for};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

const INCREMENTS: usize = 1500;

fn scene() -> String {
    format!(
        r#"{BLOCK_UNDER_PLATE}
[[step]]
name = "press"
increments = {INCREMENTS}
fix = [{{ set = "block.bottom" }}]
move = [{{ target = "plate", by = [0.0, 0.0, -0.5] }}]

[output]
every = 100000
"#
    )
}

/// Starts the job as Slurm does, for the so-many-th time after the first. Its `scontrol` writes down what it is asked.
fn start(bench: &Bench, restarts: usize) -> Child {
    let path = format!("{}:{}", bench.path("bin").display(), std::env::var("PATH").unwrap());
    Command::new("bash")
        .arg("job.sbatch")
        .current_dir(bench.path(""))
        .env("PATH", path)
        .envs([("SLURM_NTASKS", "2"), ("SLURM_JOB_ID", "77"), ("SLURM_RESTART_COUNT", &restarts.to_string())])
        .envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")])
        .envs([("OMPI_MCA_rmaps_base_oversubscribe", "1"), ("OMPI_MCA_hwloc_base_binding_policy", "none")])
        .envs([("OMPI_MCA_pml", "ob1"), ("OMPI_MCA_btl", "self,vader")])
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn a_job_goes_on_in_the_next_one() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let bench = Bench::new(&scene());
    let words =
        ["scene.toml", "-n", "2", "--time", "00:20:00", "--sbatch", "--partition=long", "--out", "out", "--quiet"];
    let printed = Command::new(root.join("scripts/job")).args(words).current_dir(bench.path("")).output().unwrap();
    assert!(printed.status.success(), "{}", String::from_utf8_lossy(&printed.stderr));
    let job = String::from_utf8(printed.stdout).unwrap();
    for line in ["--ntasks=2", "--time=00:20:00", "--signal=B:USR1@600", "--partition=long"] {
        assert!(job.contains(&format!("\n#SBATCH {line}\n")), "{job}");
    }
    let program = job.split("command=(").nth(1).unwrap().split(' ').next().unwrap();
    bench.write("job.sbatch", &job.replace(program, env!("CARGO_BIN_EXE_nagata")));
    fs::create_dir(bench.path("bin")).unwrap();
    bench.write("bin/scontrol", "#!/bin/sh\necho \"$@\" >>asked\n");
    assert!(Command::new("chmod").arg("+x").arg(bench.path("bin/scontrol")).status().unwrap().success());

    let mut first = start(&bench, 0);
    let out = bench.path("out");
    wait_for(&mut first, "rows", |_| (rows_in(&out) > 20).then_some(()));
    send("USR1", first.id());
    assert_eq!(first.wait().unwrap().code(), Some(4));
    assert_eq!(fs::read_to_string(bench.path("asked")).unwrap(), "requeue 77\n");
    let before = rows_in(&out);
    assert!((20..INCREMENTS).contains(&before) && out.join("checkpoint.h5").exists(), "{before} rows");

    let mut second = start(&bench, 1);
    assert_eq!(second.wait().unwrap().code(), Some(0));
    let run = common::Run::of(out);
    assert_eq!(run.history().column("time").len(), INCREMENTS);
    assert_eq!(run.summary()["converged"], true);
    assert_eq!(run.summary()["restarted"], before);
    assert_eq!(fs::read_to_string(bench.path("asked")).unwrap(), "requeue 77\n");
}

//! A run as a process of its own, what came of it, and how it is known again.

use super::plan::Variant;
use crate::error::{Error, Result};
use crate::interrupt;
use crate::output::OutputFolder;
use crate::scene::{MeshSource, Scene};
use serde_json::{Value, json};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, UNIX_EPOCH};

/// Where runs are made, and how.
#[derive(Debug)]
pub struct Bench<'a> {
    pub folder: &'a OutputFolder,
    /// The scene file.
    pub path: &'a Path,
    /// The scene with the overrides of all runs.
    pub scene: &'a Scene,
    pub common: &'a [String],
    pub steps: Option<usize>,
    pub ranks: usize,
    /// Make finished runs anew.
    pub fresh: bool,
}

/// How a run ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ended {
    /// Exit code; `None` when a signal ended it.
    pub code: Option<i32>,
    /// Why it failed, in a line.
    pub reason: String,
    /// Seconds after which it was stopped, if it was.
    pub stopped_s: Option<f64>,
    /// What it cost, if it converged.
    pub cost: Option<Cost>,
}

/// What a run costs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Wall time, s.
    pub wall_s: f64,
    /// Processor time of all ranks, s.
    pub cpu_s: f64,
    /// Most memory of all ranks, MB of 10^6 bytes.
    pub memory_mb: f64,
    pub increments: u64,
    pub iterations: u64,
}

/// Between two looks at a run.
const LOOK: Duration = Duration::from_millis(5);

/// What a run that is asked to end gets for it.
const PATIENCE: Duration = Duration::from_secs(10);

/// Where the runs are in the folder.
pub const RUNS: &str = "runs";

impl Bench<'_> {
    /// The results of a variant.
    pub fn results(&self, variant: &Variant) -> PathBuf {
        self.folder.path().join(RUNS).join(variant.folder())
    }

    /// The file that is there when the run has ended, with its settings and how it ended.
    fn record(&self, variant: &Variant) -> String {
        format!("{RUNS}/{}.json", variant.folder())
    }

    /// What a run is known by: all that it depends on.
    fn settings(&self, variant: &Variant) -> Value {
        let files: Vec<Value> = files(self.scene)
            .iter()
            .map(|path| {
                let of_file = fs::metadata(path).ok();
                let changed =
                    of_file.as_ref().and_then(|of_file| of_file.modified().ok()?.duration_since(UNIX_EPOCH).ok());
                json!([path, of_file.map(|of_file| of_file.len()), changed.map(|changed| changed.as_millis() as u64)])
            })
            .collect();
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene": self.scene.text,
            "files": files,
            "overrides": variant.overrides,
            "steps": self.steps,
            "ranks": self.ranks,
        })
    }

    /// How the run ended when it has been made, unless it was stopped sooner than `limit`.
    pub fn known(&self, variant: &Variant, limit: Option<f64>) -> Option<Ended> {
        let text = fs::read_to_string(self.folder.file(&self.record(variant))).ok().filter(|_| !self.fresh)?;
        let record: Value = serde_json::from_str(&text).ok()?;
        let reads = self.results(variant).join("fields.h5").exists();
        let ended = Ended::of_json(&record["ended"]).filter(|_| record["settings"] == self.settings(variant))?;
        let sooner = ended.stopped_s.is_some_and(|stopped| limit.is_none_or(|limit| limit > stopped));
        (!sooner && (ended.cost.is_none() || reads)).then_some(ended)
    }

    /// Makes the run, for so many seconds at most.
    ///
    /// # Errors
    /// A signal, with which the run ends, too; a process that cannot be started, or whose results cannot be read; another
    /// process that writes to the folder of the run.
    pub fn perform(&self, variant: &Variant, limit: Option<f64>) -> Result<Ended> {
        let failed = |what: &str, error: std::io::Error| Error::System(format!("cannot {what}: {error}"));
        let record = self.folder.file(&self.record(variant));
        if let Err(error) = fs::remove_file(&record)
            && error.kind() != std::io::ErrorKind::NotFound
        {
            return Err(failed(&format!("remove {}", record.display()), error));
        }
        let said = self.folder.file(&format!("{RUNS}/{}.err", variant.folder()));
        fs::create_dir_all(self.folder.path().join(RUNS)).map_err(|e| failed("make the folder of the runs", e))?;
        let errors = File::create(&said).map_err(|e| failed(&format!("write {}", said.display()), e))?;
        let mut child = self.command(variant)?.stderr(errors).spawn().map_err(|e| failed("start a run", e))?;
        let watched = watch(&mut child, limit).map_err(|e| failed("wait for a run", e))?;
        let text = fs::read_to_string(&said).unwrap_or_default();
        let mut ended = match watched {
            Watched::Interrupted => {
                return Err(Error::Interrupted(format!("`{}` was ended by a signal", variant.label)));
            }
            Watched::Stopped(seconds) => {
                let reason = format!("stopped after {seconds:.0} s; --limit SECONDS allows another time");
                Ended { reason, stopped_s: Some(seconds), ..Ended::default() }
            }
            Watched::Ended(status) => {
                let reason = if status.success() { String::new() } else { reason(&text, &status) };
                Ended { code: status.code(), reason, ..Ended::default() }
            }
        };
        if ended.code == Some(2) && ended.reason.contains("another run writes to output folder") {
            return Err(Error::input_anywhere(ended.reason, "wait until it has ended, or end it"));
        }
        if ended.code == Some(4) {
            return Err(Error::Interrupted(format!("`{}` was ended by a signal", variant.label)));
        }
        if ended.code == Some(0) {
            ended.cost = Some(cost(&self.results(variant).join("summary.json"))?);
        }
        let record = json!({ "settings": self.settings(variant), "ended": ended.to_json() });
        self.folder.replace(&self.record(variant), &format!("{record:#}\n"))?;
        Ok(ended)
    }

    /// `nagata run` in an environment in which no MPI has been.
    fn command(&self, variant: &Variant) -> Result<Command> {
        let program = std::env::current_exe().map_err(|e| Error::System(format!("cannot find this program: {e}")))?;
        let mut command = match self.ranks {
            1 => Command::new(program),
            ranks => {
                let mut command = Command::new("mpirun");
                command.args(["--quiet", "-n", &ranks.to_string()]).arg(program);
                command
            }
        };
        command.arg("run").arg(self.path).arg("--quiet").arg("--out").arg(self.results(variant));
        for text in self.common.iter().chain(&variant.overrides) {
            command.arg("--set").arg(text);
        }
        if let Some(steps) = self.steps {
            command.args(["--steps", &steps.to_string()]);
        }
        for name in ["OPENBLAS_NUM_THREADS", "SCOTCH_PTHREAD_NUMBER"] {
            if std::env::var_os(name).is_none() {
                command.env(name, "1");
            }
        }
        command.stdin(Stdio::null()).stdout(Stdio::null());
        Ok(command)
    }
}

/// What came of waiting.
enum Watched {
    Ended(ExitStatus),
    /// After so many seconds.
    Stopped(f64),
    Interrupted,
}

/// Waits until a run has ended, or ends it.
fn watch(child: &mut Child, limit: Option<f64>) -> std::io::Result<Watched> {
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(if interrupt::wished() { Watched::Interrupted } else { Watched::Ended(status) });
        }
        let passed = begun.elapsed().as_secs_f64();
        if interrupt::wished() {
            end(child)?;
            return Ok(Watched::Interrupted);
        }
        if limit.is_some_and(|limit| passed > limit) {
            end(child)?;
            return Ok(Watched::Stopped(passed));
        }
        sleep(LOOK);
    }
}

/// Asks a run to end, as `mpirun` passes on to its ranks, and sees to it that it does.
fn end(child: &mut Child) -> std::io::Result<()> {
    let asked = Command::new("sh").args(["-c", &format!("kill -TERM {}", child.id())]).status();
    let begun = Instant::now();
    while asked.is_ok() && begun.elapsed() < PATIENCE {
        if child.try_wait()?.is_some() {
            return Ok(());
        }
        sleep(LOOK);
    }
    child.kill()?;
    child.wait().map(|_| ())
}

/// Why a run failed: its first error, in a line.
fn reason(said: &str, status: &ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt as _;
    let error = said.lines().find_map(|line| line.strip_prefix("error: "));
    let last = || said.lines().rev().find(|line| !line.trim().is_empty());
    match (error.or_else(last), status.signal()) {
        (_, Some(9)) => "ended by signal 9, which often means that memory ran out".into(),
        (_, Some(signal)) => format!("ended by signal {signal}"),
        (Some(line), None) => line.trim().to_string(),
        (None, None) => "said nothing".into(),
    }
}

/// What `summary.json` says of the costs.
fn cost(path: &Path) -> Result<Cost> {
    let text = fs::read_to_string(path).map_err(|e| Error::System(format!("cannot read {}: {e}", path.display())))?;
    let summary: Value = serde_json::from_str(&text).unwrap_or_default();
    let number =
        |key: &str| summary[key].as_f64().ok_or_else(|| Error::System(format!("{} has no `{key}`", path.display())));
    Ok(Cost {
        wall_s: number("wall_s")?,
        cpu_s: number("cpu_s")?,
        memory_mb: number("peak_memory_mb")?,
        increments: number("increments")? as u64,
        iterations: number("iterations")? as u64,
    })
}

impl Ended {
    fn to_json(&self) -> Value {
        let cost = self.cost.map(|c| json!([c.wall_s, c.cpu_s, c.memory_mb, c.increments, c.iterations]));
        json!({ "code": self.code, "reason": self.reason, "stopped_s": self.stopped_s, "cost": cost })
    }

    fn of_json(value: &Value) -> Option<Self> {
        let cost = match value["cost"].as_array() {
            None => None,
            Some(cost) => Some(Cost {
                wall_s: cost.first()?.as_f64()?,
                cpu_s: cost.get(1)?.as_f64()?,
                memory_mb: cost.get(2)?.as_f64()?,
                increments: cost.get(3)?.as_u64()?,
                iterations: cost.get(4)?.as_u64()?,
            }),
        };
        Some(Self {
            code: value["code"].as_i64().map(|code| code as i32),
            reason: value["reason"].as_str()?.to_string(),
            stopped_s: value["stopped_s"].as_f64(),
            cost,
        })
    }
}

/// The files that a scene reads.
fn files(scene: &Scene) -> Vec<PathBuf> {
    let of = |source: &MeshSource| match source {
        MeshSource::File { path, .. } => Some(path.value.clone()),
        MeshSource::Block(_) => None,
    };
    let mut files: Vec<PathBuf> = scene.bodies.iter().filter_map(|body| of(&body.mesh)).collect();
    for tool in &scene.tools {
        files.extend(tool.mesh.as_ref().and_then(|mesh| of(&mesh.source)));
        files.extend([&tool.nurbs, &tool.bezier].into_iter().flatten().map(|file| file.path.value.clone()));
    }
    files.sort();
    files.dedup();
    files
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_is_read_as_it_was_written() {
        let cost = Cost { wall_s: 1.5, cpu_s: 2.5, memory_mb: 70.25, increments: 3, iterations: 9 };
        let well = Ended { code: Some(0), cost: Some(cost), ..Ended::default() };
        let stopped = Ended { reason: "stopped".into(), stopped_s: Some(5.0), ..Ended::default() };
        for ended in [well, stopped] {
            assert_eq!(Ended::of_json(&ended.to_json()), Some(ended));
        }
        assert_eq!(Ended::of_json(&json!({})), None);
    }

    #[test]
    fn the_reason_is_the_first_error() {
        use std::os::unix::process::ExitStatusExt as _;
        let code = |code: i32| ExitStatus::from_raw(code << 8);
        assert_eq!(reason("warning: x\nerror: no\n  help: y\nerror: z\n", &code(2)), "no");
        assert_eq!(reason("a\nb\n\n", &code(3)), "b");
        assert_eq!(reason("", &code(3)), "said nothing");
        assert!(reason("error: no", &ExitStatus::from_raw(9)).starts_with("ended by signal 9"));
    }
}

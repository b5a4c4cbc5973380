//! `summary.json`: what ran, how it ended, what it cost.

use super::phases::{PHASES, Phases};
use super::{OutputFolder, replace};
use crate::error::Result;
use crate::parallel::{Sent, agree};
use mpi::traits::*;
use petsc::LinearStatistics;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// What a run carries from one increment to the next, over all ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Carried {
    /// Slave nodes of all contacts, and bytes for them.
    pub slave_nodes: u64,
    pub contact_bytes: u64,
    /// Integration points with a state, and bytes of these states and of enhanced strain.
    pub points: u64,
    pub history_bytes: u64,
    /// Times that stresses were evaluated for output.
    pub stress_fields: u64,
}

/// Increments that were accepted with residuals above the tolerance, since rounding leaves as much of them, and the worst.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rounded {
    pub increments: usize,
    /// Of the worst: its time, whose it is, as in "contact `top`", the residual over the forces that it counts against, and
    /// how large it could have been.
    pub time: f64,
    pub of: String,
    pub residual: f64,
    pub limit: f64,
    /// See [`crate::analysis::Rounded::lost`]; it is worse than what is not.
    pub lost: bool,
}

impl Rounded {
    /// As it stands in `summary.json` and in checkpoints.
    pub fn to_json(&self) -> Value {
        let Self { increments, time, of, residual, limit, lost } = self;
        json!({
            "increments": increments, "time": time, "of": of, "residual": residual, "limit": limit, "lost": lost
        })
    }

    /// What [`Self::to_json`] has written, if it has.
    pub fn from_json(value: &Value) -> Option<Self> {
        Some(Self {
            increments: value["increments"].as_u64()? as usize,
            time: value["time"].as_f64()?,
            of: value["of"].as_str()?.into(),
            residual: value["residual"].as_f64()?,
            limit: value["limit"].as_f64()?,
            lost: value["lost"].as_bool()?,
        })
    }
}

/// What the user asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// Name of the scene.
    pub scene: String,
    /// The preset of accuracy, as in "balanced".
    pub accuracy: &'static str,
    /// The controls that differ from their defaults.
    pub controls: BTreeMap<&'static str, f64>,
}

/// The largest of the systems that a run solves, over all ranks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Systems {
    /// Unknowns, multipliers and free tool directions included.
    pub dofs: u64,
    /// Multiplier unknowns at most.
    pub multipliers: u64,
    /// Entries of the largest matrix.
    pub entries: u64,
    /// Kind of the matrix, as in "symmetric indefinite".
    pub matrix: String,
    /// As in "MUMPS LDL^T, SCOTCH", or "FGMRES, multigrid".
    pub solver: String,
}

impl Systems {
    /// Takes note of the size of a system.
    pub fn count(&mut self, unknowns: u64, multipliers: u64, entries: u64) {
        self.dofs = self.dofs.max(unknowns);
        self.multipliers = self.multipliers.max(multipliers);
        self.entries = self.entries.max(entries);
    }
}

/// The outcome of a run. Counts are of the whole model, over all ranks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    pub asked: Asked,
    pub converged: bool,
    /// A signal ended the run.
    pub interrupted: bool,
    /// It went on from a checkpoint after so many increments.
    pub restarted: Option<usize>,
    pub systems: Systems,
    /// What contact and material remember.
    pub carried: Carried,
    pub elements: u64,
    pub counts: Counts,
    /// What was done for linear systems.
    pub linear: LinearStatistics,
    /// Times that patches of deformable masters were fetched.
    pub search_fetches: usize,
    /// Wall time, s.
    pub wall_s: f64,
    /// What is estimated of the errors at the ends of steps.
    pub estimates: Vec<Value>,
    /// What was let through above the tolerance.
    pub rounded: Option<Rounded>,
    /// What the user should know of the result.
    pub warnings: Vec<String>,
    /// What it was to cost, as foretold when it began.
    pub predicted: Option<Foretold>,
}

/// What is counted over all of a run, before and after a restart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// Converged increments.
    pub increments: usize,
    /// Increments that failed and were tried again in smaller ones.
    pub cutbacks: usize,
    /// Increments in which the structure jumped to another equilibrium.
    pub jumps: usize,
    /// Newton iterations, those of failed increments included.
    pub iterations: usize,
    /// Updates of held multipliers and of active sets, those of failed increments included.
    pub outer_iterations: usize,
    /// Times that the sparsity pattern was built anew for contact with deformable masters.
    pub pattern_rebuilds: usize,
    /// Times that slave nodes came to touch without having equations, and got them.
    pub growths: usize,
}

crate::words!(Counts { increments, cutbacks, jumps, iterations, outer_iterations, pattern_rebuilds, growths });

/// Wall time, s, and peak memory of all ranks, MB, as foretold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foretold {
    pub wall_s: f64,
    pub memory_mb: f64,
}

impl Foretold {
    /// With what was measured over what was foretold.
    fn against(&self, wall_s: f64, memory_mb: f64) -> Value {
        json!({
            "wall_s": milli(self.wall_s),
            "memory_mb": milli(self.memory_mb),
            "wall_ratio": milli(wall_s / self.wall_s),
            "memory_ratio": milli(memory_mb / self.memory_mb),
        })
    }
}

/// With three decimals.
fn milli(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

impl Summary {
    /// Writes `summary.json`, with the version, the number of ranks, the seconds in each phase (slowest rank), the processor
    /// time of all ranks, and the peak memory (MB of 10^6 bytes; also the sum over the ranks) and what was `sent` of each
    /// rank added. Collective.
    ///
    /// # Errors
    /// [`crate::error::Error::System`] on all ranks when the file cannot be written.
    pub fn write(&self, folder: &OutputFolder, comm: &impl Communicator, phases: &Phases, sent: Sent) -> Result<()> {
        let seconds = phases.slowest(comm);
        let own = [peak_memory_mb(), sent.messages as f64, sent.bytes as f64 * 1e-6, cpu_s()];
        let root = comm.process_at_rank(0);
        let written = if comm.rank() == 0 {
            let mut ranks = vec![[0.0; 4]; comm.size() as usize];
            root.gather_into_root(&own[..], ranks.as_flattened_mut());
            replace(&folder.file("summary.json"), &self.render(&seconds, &phases.calls(), &ranks))
        } else {
            root.gather_into(&own[..]);
            Ok(())
        };
        agree(comm, written)
    }

    /// With the slowest rank's seconds in each phase, the calls of it, and of each rank its peak memory, its messages, the MB
    /// in them, and its processor time.
    fn render(&self, seconds: &[f64], calls: &[usize], ranks: &[[f64; 4]]) -> String {
        let phases: Map<String, Value> =
            PHASES.iter().zip(seconds).map(|((_, name), &s)| (name.to_string(), json!(milli(s)))).collect();
        let calls: Map<String, Value> =
            PHASES.iter().zip(calls).map(|((_, name), &n)| (name.to_string(), json!(n))).collect();
        let Carried { slave_nodes, contact_bytes, points, history_bytes, stress_fields } = self.carried;
        let of_ranks = |k: usize| ranks.iter().map(|of| milli(of[k])).collect::<Vec<_>>();
        let memory: f64 = ranks.iter().map(|of| of[0]).sum();
        let value = json!({
            "converged": self.converged,
            "interrupted": self.interrupted,
            "restarted": self.restarted,
            "scene": self.asked.scene,
            "version": env!("CARGO_PKG_VERSION"),
            "ranks": ranks.len(),
            "dofs": self.systems.dofs,
            "multipliers": self.systems.multipliers,
            "matrix_entries": self.systems.entries,
            "carried": {
                "slave_nodes": slave_nodes,
                "contact_bytes": contact_bytes,
                "points": points,
                "history_bytes": history_bytes,
                "stress_fields": stress_fields,
            },
            "elements": self.elements,
            "increments": self.counts.increments,
            "cutbacks": self.counts.cutbacks,
            "jumps": self.counts.jumps,
            "iterations": self.counts.iterations,
            "outer_iterations": self.counts.outer_iterations,
            "pattern_rebuilds": self.counts.pattern_rebuilds,
            "growths": self.counts.growths,
            "analyses": self.linear.analyses,
            "factorizations": self.linear.factorizations,
            "linear_iterations": self.linear.krylov_iterations,
            "linear_reused": self.linear.reused,
            "linear_unsolved": self.linear.unsolved,
            "search_fetches": self.search_fetches,
            "wall_s": milli(self.wall_s),
            "cpu_s": milli(ranks.iter().map(|of| of[3]).sum()),
            "phases_s": phases,
            "phase_calls": calls,
            "peak_memory_mb": milli(memory),
            "by_rank": {
                "peak_memory_mb": of_ranks(0),
                "messages": ranks.iter().map(|of| of[1] as u64).collect::<Vec<_>>(),
                "sent_mb": of_ranks(2),
            },
            "matrix": self.systems.matrix,
            "linear_solver": self.systems.solver,
            "rounded": self.rounded.as_ref().map(Rounded::to_json),
            "estimate": self.estimates,
            "warnings": self.warnings,
            "accuracy": self.asked.accuracy,
            "controls": self.asked.controls,
            "predicted": self.predicted.map(|foretold| foretold.against(self.wall_s, memory)),
        });
        format!("{value:#}\n")
    }
}

/// The most memory this process has held, MB of 10^6 bytes; 0 where the system does not say.
pub fn peak_memory_mb() -> f64 {
    memory_mb("/proc/self/status", "VmHWM:").unwrap_or(0.0)
}

/// The memory that a file of `/proc` has behind a key, MB of 10^6 bytes, where the system says.
pub fn memory_mb(file: &str, key: &str) -> Option<f64> {
    std::fs::read_to_string(file).ok().and_then(|text| kibibytes(&text, key)).map(|kib| 1.024e-3 * kib)
}

/// The processor time that this process has taken so far, in user and kernel mode, s; 0 where the system does not say.
pub fn cpu_s() -> f64 {
    std::fs::read_to_string("/proc/self/stat").ok().and_then(|stat| ticks(&stat)).unwrap_or(0.0) / TICKS
}

/// Ticks a second in `/proc`, the same on all machines that Linux runs on today.
const TICKS: f64 = 100.0;

/// Fields 14 and 15 of proc(5); the second, the name of the program, stands in brackets and may hold anything.
fn ticks(stat: &str) -> Option<f64> {
    let (_, fields) = stat.rsplit_once(')')?;
    let mut times = fields.split_whitespace().skip(11).map(str::parse::<f64>);
    Some(times.next()?.ok()? + times.next()?.ok()?)
}

fn kibibytes(text: &str, key: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_has_exactly_the_promised_keys() {
        let summary = Summary {
            converged: true,
            asked: Asked { scene: "a \"b\"".into(), ..Asked::default() },
            systems: Systems { dofs: 12, ..Systems::default() },
            wall_s: 1.25,
            predicted: Some(Foretold { wall_s: 2.5, memory_mb: 100.0 }),
            ..Summary::default()
        };
        let ranks = [[100.0, 7.0, 0.5, 1.5], [20.4567, 8.0, 0.25, 1.25], [3.0, 9.0, 0.0, 0.01]];
        let text = summary.render(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0], &[1; 8], &ranks);
        let value: Value = serde_json::from_str(&text).unwrap();
        let keys = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
        let mut promised: Vec<_> =
            "converged interrupted restarted scene version ranks dofs multipliers matrix_entries carried elements increments cutbacks jumps iterations outer_iterations \
             pattern_rebuilds growths analyses factorizations linear_iterations linear_reused linear_unsolved search_fetches \
             wall_s cpu_s phases_s phase_calls peak_memory_mb by_rank matrix linear_solver rounded estimate warnings accuracy controls \
             predicted"
                .split_whitespace()
                .collect();
        promised.sort();
        let mut found = keys(&value);
        found.sort();
        assert_eq!(found, promised);
        assert_eq!(value["phases_s"]["read"], 1.0);
        assert_eq!(value["phases_s"]["factor"], 6.0);
        assert_eq!(value["phases_s"]["output"], 8.0);
        assert_eq!(value["phases_s"].as_object().unwrap().len(), 8);
        assert_eq!((&value["scene"], &value["ranks"], &value["dofs"]), (&json!("a \"b\""), &json!(3), &json!(12)));
        assert_eq!((&value["wall_s"], &value["peak_memory_mb"]), (&json!(1.25), &json!(123.457)));
        assert_eq!(value["cpu_s"], 2.76);
        let predicted = json!({ "wall_s": 2.5, "memory_mb": 100.0, "wall_ratio": 0.5, "memory_ratio": 1.235 });
        assert_eq!(value["predicted"], predicted);
        let by_rank =
            json!({ "peak_memory_mb": [100.0, 20.457, 3.0], "messages": [7, 8, 9], "sent_mb": [0.5, 0.25, 0.0] });
        assert_eq!(value["by_rank"], by_rank);
    }

    #[test]
    fn memory_is_the_high_water_mark() {
        assert_eq!(kibibytes("Name:\tx\nVmPeak:\t 9 kB\nVmHWM:\t    2048 kB\n", "VmHWM:"), Some(2048.0));
        assert_eq!(kibibytes("Name:\tx\n", "VmHWM:"), None);
        assert!(peak_memory_mb() > 1.0);
    }

    #[test]
    fn processor_time_is_that_of_user_and_kernel() {
        let stat = "7 (a) b) R 1 7 7 0 -1 4194304 100 0 0 0 250 31 5 5 20 0 1 0 12345";
        assert_eq!(ticks(stat), Some(281.0));
        assert_eq!(ticks("7 (nagata) R 1"), None);
        let (before, begun) = (cpu_s(), std::time::Instant::now());
        let mut sum = 0u64;
        while begun.elapsed().as_millis() < 200 {
            sum = std::hint::black_box(sum + 1);
        }
        assert!(cpu_s() > before, "{before}");
    }
}

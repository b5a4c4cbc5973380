//! What the user sees while a run goes on, on the terminal and in `log.txt`: a progress bar where there is a terminal,
//! one line an increment elsewhere and in the file.

use super::{OutputFolder, cannot_write};
use crate::error::{Error, Result};
use crate::parallel::agree;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mpi::traits::*;
use std::fs::File;
use std::io::{IsTerminal, Write};
use std::time::Duration;

/// Length of the progress bar's scale.
const FULL: u64 = 1000;

/// The log of a run. Rank 0 speaks, the others are silent.
///
/// Once open it never fails: a lost terminal or a full disk shows in the results, which are checked, and must not end a run
/// for the sake of its log.
#[derive(Debug)]
pub struct Log {
    /// On rank 0 alone.
    file: Option<File>,
    bar: Option<ProgressBar>,
    /// Rank 0 without `--quiet`.
    talks: bool,
    /// Rank 0 with `--quiet`: it shows warnings alone, on standard error.
    warns: bool,
    /// Time at the end of the analysis.
    end: f64,
}

/// A converged increment.
#[derive(Clone, Copy, Debug)]
pub struct Increment<'a> {
    pub step: &'a str,
    pub number: usize,
    /// Time at its end.
    pub time: f64,
    /// Its size in time.
    pub size: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// What else is worth a word, as in "128 active, 30 slip"; may be empty.
    pub note: &'a str,
}

impl Log {
    /// Opens `log.txt`; `quiet` shows nothing but warnings and errors on the terminal. Collective.
    ///
    /// # Errors
    /// [`Error::System`] on all ranks when the file cannot be written.
    pub fn create(folder: &OutputFolder, comm: &impl Communicator, quiet: bool) -> Result<Self> {
        let path = folder.file("log.txt");
        let file = if comm.rank() == 0 { File::create(&path).map(Some) } else { Ok(None) };
        let file = agree(comm, file.map_err(|error| cannot_write(&path, error)))?;
        Ok(Self::of(file, comm, quiet))
    }

    /// Goes on with the log of an earlier run, cut to the `length` that it had at a checkpoint; without one it begins anew.
    /// Collective.
    ///
    /// # Errors
    /// [`Error::System`] on all ranks when the file cannot be written.
    pub fn go_on(folder: &OutputFolder, comm: &impl Communicator, quiet: bool, length: u64) -> Result<Self> {
        let kept = if comm.rank() == 0 { super::go_on(&folder.file("log.txt"), length).ok() } else { None };
        let mut exists = kept.is_some();
        comm.process_at_rank(0).broadcast_into(&mut exists);
        match exists {
            true => Ok(Self::of(kept, comm, quiet)),
            false => Self::create(folder, comm, quiet),
        }
    }

    /// Bytes in the file so far; zero on other ranks than 0.
    pub fn length(&self) -> u64 {
        super::length(self.file.as_ref())
    }

    fn of(file: Option<File>, comm: &impl Communicator, quiet: bool) -> Self {
        let speaks = comm.rank() == 0;
        Self { file, bar: None, talks: speaks && !quiet, warns: speaks && quiet, end: 0.0 }
    }

    /// Shows a line, or several; of which those with a warning also when quiet.
    pub fn line(&mut self, text: &str) {
        self.record(text);
        self.show(text);
        for warning in warnings(text).filter(|_| self.warns) {
            let _ = writeln!(std::io::stderr(), "{warning}");
        }
    }

    /// Shows an error, also when quiet. The error is the same on all ranks, and rank 0 shows it.
    pub fn error(&mut self, error: &Error) {
        let text = format!("error: {error}");
        self.finish();
        if self.file.is_some() {
            let _ = writeln!(std::io::stderr(), "{text}");
        }
        self.record(&text);
    }

    /// Starts the progress of an analysis that ends at time `end`.
    pub fn start(&mut self, end: f64) {
        self.end = end;
        if self.talks && on_terminal() {
            let bar = ProgressBar::with_draw_target(Some(FULL), ProgressDrawTarget::stdout());
            if let Ok(style) = ProgressStyle::with_template("{prefix} [{bar:30}] {percent:>3}%  {msg}  ETA {eta}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.enable_steady_tick(Duration::from_millis(500));
            self.bar = Some(bar);
        }
    }

    /// Shows the Newton iteration that goes on.
    pub fn iteration(&self, step: &str, increment: usize, iteration: usize) {
        if let Some(bar) = &self.bar {
            bar.set_prefix(step.to_string());
            bar.set_message(format!("increment {increment}, iteration {iteration}"));
        }
    }

    /// Shows a converged increment.
    pub fn increment(&mut self, increment: &Increment) {
        let line = increment_line(increment, self.end);
        self.record(&line);
        match &self.bar {
            Some(bar) => bar.set_position((fraction(increment.time, self.end) * FULL as f64) as u64),
            None => self.show(&line),
        }
    }

    /// Takes the progress bar away.
    pub fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }

    /// Writes a line to the file alone.
    pub fn record(&mut self, text: &str) {
        if let Some(file) = &mut self.file {
            let _ = writeln!(file, "{text}");
        }
    }

    /// Not `println!`, which panics when the reader of a pipe is gone.
    fn show(&self, text: &str) {
        let print = || {
            let mut out = std::io::stdout().lock();
            let _ = writeln!(out, "{text}").and_then(|()| out.flush());
        };
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None if self.talks => print(),
            None => {}
        }
    }
}

impl Drop for Log {
    fn drop(&mut self) {
        self.finish();
    }
}

/// The lines that warn.
fn warnings(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim_start).filter(|line| line.starts_with("warning: ") || line.contains(": warning: "))
}

/// Whether a user looks on. Open MPI gives every rank a pseudo-terminal, so under it the launcher's own output counts.
fn on_terminal() -> bool {
    let launcher = || std::fs::read_link(format!("/proc/{}/fd/1", std::os::unix::process::parent_id()));
    let launched = std::env::var_os("OMPI_COMM_WORLD_RANK").is_some();
    std::io::stdout().is_terminal() && (!launched || launcher().is_ok_and(|output| output.starts_with("/dev/pts")))
}

fn increment_line(increment: &Increment, end: f64) -> String {
    let Increment { step, number, time, size, iterations, note } = *increment;
    let percent = (100.0 * fraction(time, end)).floor();
    let gap = if note.is_empty() { "" } else { "  " };
    format!(
        "{step}  increment {number:>4}  time {:<10}  {percent:>3}%  size {:<10}  {iterations:>2} iterations{gap}{note}",
        short(time),
        short(size)
    )
}

/// How far the analysis is, in 0 to 1. Time adds up with rounding, hence the slack.
fn fraction(time: f64, end: f64) -> f64 {
    if end > 0.0 { (time / end * (1.0 + 1e-9)).clamp(0.0, 1.0) } else { 1.0 }
}

/// Six significant digits without the zeros behind them.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_increment_is_one_line() {
        let increment =
            Increment { step: "press", number: 12, time: 0.1 + 0.2, size: 1e-7, iterations: 4, note: "128 active" };
        assert_eq!(
            increment_line(&increment, 1.2),
            "press  increment   12  time 0.3          25%  size 1e-7         4 iterations  128 active"
        );
    }

    #[test]
    fn warnings_are_told_from_the_rest() {
        let text =
            "tool `die`: rigid\n  warning: tool `die`: it leaks\n  press: warning: 2 null pivots\nno warning here";
        let found: Vec<_> = warnings(text).collect();
        assert_eq!(found, ["warning: tool `die`: it leaks", "press: warning: 2 null pivots"]);
    }

    #[test]
    fn the_last_increment_is_all_of_it() {
        let time = (0..10).map(|_| 0.1).sum::<f64>();
        assert!(time < 1.0);
        assert_eq!(fraction(time, 1.0), 1.0);
        assert_eq!(fraction(0.0, 0.0), 1.0);
        assert_eq!(fraction(0.25, 1.0), 0.25 * (1.0 + 1e-9));
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.1 + 0.2, 1.0 / 3.0, 1e-7, 12.0].map(short), ["0.3", "0.333333", "1e-7", "12.0"]);
    }
}

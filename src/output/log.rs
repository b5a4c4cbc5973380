//! What the user sees while a run goes on, on the terminal and in `log.txt`: a progress bar where there is a terminal,
//! one line an increment elsewhere and in the file, which also has each iterate as soon as it is judged.

use super::{OutputFolder, cannot_write};
use crate::error::{Error, Result};
use crate::parallel::agree;
use crate::stdout;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use mpi::traits::*;
use std::fs::File;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

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
    /// The last line of the file does not end yet: iterates are added to it.
    is_open: bool,
    bar: Option<ProgressBar>,
    /// Rank 0 without `--quiet`.
    talks: bool,
    /// Rank 0 with `--quiet`: it shows warnings alone, on standard error.
    warns: bool,
    /// Time at the end of the analysis.
    end: f64,
    /// Seconds since the beginning, and the fraction of the analysis that was done.
    begun: Instant,
    marks: Vec<(f64, f64)>,
    /// The step of the jump that goes on.
    jump: Option<usize>,
}

/// An iterate of Newton's method.
#[derive(Clone, Copy, Debug)]
pub struct Iteration<'a> {
    pub step: &'a str,
    /// Number of the increment that is sought, from 1.
    pub increment: usize,
    /// From 0, which is the start.
    pub number: usize,
    /// Largest residual over the forces that it counts against.
    pub residual: f64,
    /// Contact nodes that have changed their status, and that touch.
    pub changes: usize,
    pub touching: usize,
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

    /// Bytes in the file so far, with the line of iterates ended; zero on other ranks than 0.
    pub fn length(&mut self) -> u64 {
        if std::mem::take(&mut self.is_open) {
            self.write("\n");
        }
        super::length(self.file.as_ref())
    }

    fn of(file: Option<File>, comm: &impl Communicator, quiet: bool) -> Self {
        let speaks = comm.rank() == 0;
        let (talks, warns) = (speaks && !quiet, speaks && quiet);
        let (begun, marks) = (Instant::now(), Vec::new());
        Self { file, is_open: false, bar: None, talks, warns, end: 0.0, begun, marks, jump: None }
    }

    /// Shows a line, or several; of which those with a warning also when quiet.
    pub fn line(&mut self, text: &str) {
        self.record(text);
        self.jump = None;
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
        self.begun = Instant::now();
        if self.talks && on_terminal() {
            let bar = ProgressBar::with_draw_target(Some(FULL), ProgressDrawTarget::stdout());
            if let Ok(style) = ProgressStyle::with_template("{spinner} {prefix} [{bar:30}] {percent:>3}%\n  {wide_msg}")
            {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.enable_steady_tick(Duration::from_millis(500));
            self.bar = Some(bar);
        }
    }

    /// Shows an iterate; in the file those of an attempt stand in one line, which grows.
    pub fn iteration(&mut self, at: &Iteration) {
        let begin = if self.is_open { "" } else { "    residual/force (status changes):" };
        self.write(&format!("{begin} {}", residual(at)));
        self.is_open = true;
        if let Some(bar) = &self.bar {
            let left = left(&self.marks, self.begun.elapsed().as_secs_f64());
            bar.set_prefix(at.step.to_string());
            bar.set_message(progress(at, self.jump, left));
        }
    }

    /// Shows that a step of a jump begins, against such a drag over the stiffness.
    pub fn jump(&mut self, number: usize, drag: f64) {
        self.record(&format!("    jump, step {number}, drag over stiffness {drag:.1e}"));
        self.jump = Some(number);
    }

    /// Shows a converged increment.
    pub fn increment(&mut self, increment: &Increment) {
        let line = increment_line(increment, self.end);
        self.record(&line);
        self.jump = None;
        self.marks.push((self.begun.elapsed().as_secs_f64(), fraction(increment.time, self.end)));
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
        let before = if std::mem::take(&mut self.is_open) { "\n" } else { "" };
        self.write(&format!("{before}{text}\n"));
    }

    /// At once: the file has no buffer.
    fn write(&mut self, text: &str) {
        if let Some(file) = &mut self.file {
            let _ = file.write_all(text.as_bytes());
        }
    }

    /// What cannot be shown ends no run.
    fn show(&self, text: &str) {
        let print = || {
            let _ = stdout::print(&format!("{text}\n"));
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
        if self.is_open {
            self.write("\n");
        }
    }
}

/// Residual and status changes of an iterate, for the file.
fn residual(at: &Iteration) -> String {
    match at.changes {
        0 => format!("{:.1e}", at.residual),
        changes => format!("{:.1e} ({changes})", at.residual),
    }
}

/// What stands behind the bar.
fn progress(at: &Iteration, jump: Option<usize>, left: Option<f64>) -> String {
    let jump = jump.map_or(String::new(), |step| format!("jump, step {step}, "));
    let left =
        left.map_or(String::new(), |left| format!(", about {} left", HumanDuration(Duration::from_secs_f64(left))));
    let Iteration { increment, number, residual, touching, .. } = at;
    format!("increment {increment}, {jump}iteration {number}, residual {residual:.1e}, {touching} touching{left}")
}

/// The seconds that are left after so many; `None` as long as nothing tells: before a twentieth is done in five increments, and
/// where the second half of what is done went at less than half or more than twice the pace of the first.
fn left(marks: &[(f64, f64)], now: f64) -> Option<f64> {
    let &(second, done) = marks.last().filter(|(_, done)| marks.len() >= 5 && *done >= 0.05)?;
    let &(middle, half) = marks.iter().rev().find(|(_, before)| *before <= 0.5 * done)?;
    let (first, last) = (half / middle, (done - half) / (second - middle));
    let is_even = (0.5..=2.0).contains(&(last / first));
    is_even.then(|| ((1.0 - done) / last - (now - second)).max(0.0))
}

/// The lines that warn.
pub fn warnings(text: &str) -> impl Iterator<Item = &str> {
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
pub fn short(value: f64) -> String {
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

    /// As many seconds as the pace asks for, but not at the beginning, nor when the pace changes.
    #[test]
    fn what_is_left_is_told_when_it_is_known() {
        let even: Vec<(f64, f64)> = (1..=10).map(|k| (10.0 * f64::from(k), 0.05 * f64::from(k))).collect();
        assert!((left(&even, 100.0).unwrap() - 100.0).abs() < 1e-9);
        assert!((left(&even, 130.0).unwrap() - 70.0).abs() < 1e-9);
        assert_eq!(left(&even, 1000.0), Some(0.0));
        assert_eq!(left(&even[..4], 40.0), None);
        assert_eq!(left(&[], 1.0), None);
        let slower: Vec<(f64, f64)> = even.iter().map(|&(s, done)| (s + (s - 50.0).max(0.0) * 1.1, done)).collect();
        assert_eq!(left(&slower, 155.0), None);
        let early: Vec<(f64, f64)> = even.iter().map(|&(s, done)| (s, 0.09 * done)).collect();
        assert_eq!(left(&early, 100.0), None);
    }

    #[test]
    fn an_iterate_is_shown_as_it_is() {
        let at = Iteration { step: "press", increment: 12, number: 3, residual: 2.34e-4, changes: 0, touching: 24 };
        assert_eq!(progress(&at, None, None), "increment 12, iteration 3, residual 2.3e-4, 24 touching");
        let text = progress(&at, Some(4), Some(200.0));
        let rest = "iteration 3, residual 2.3e-4, 24 touching, about 3 minutes left";
        assert_eq!(text, format!("increment 12, jump, step 4, {rest}"));
        assert_eq!([0, 2].map(|changes| residual(&Iteration { changes, ..at })), ["2.3e-4", "2.3e-4 (2)"]);
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

//! What of a log is not in the other files.

use crate::output::log::warnings;

/// What a log says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Told {
    /// What is modelled, line by line, without the title.
    pub model: Vec<String>,
    /// Without "warning: ".
    pub warnings: Vec<String>,
    /// Increments that failed, and jumps: the last increment before, and what was done.
    pub troubles: Vec<(usize, String)>,
    /// The last converged increment: its step, and how much of the run was done, as in "25%".
    pub last: Option<(String, String)>,
    /// Why the run ended, if not well.
    pub error: Option<String>,
}

impl Told {
    /// Reads a log, which may end within a line.
    pub fn new(text: &str) -> Self {
        let mut told = Self::default();
        let mut increment = 0;
        for line in text.lines() {
            if let Some(begun) = Converged::of(line) {
                increment = begun.number;
                told.last = Some((begun.step.to_string(), begun.percent.to_string()));
            } else if is_trouble(line) {
                told.troubles.push((increment, line.trim().to_string()));
            }
        }
        told.model = text.lines().skip(1).take_while(|line| belongs_to_model(line)).map(str::to_string).collect();
        for line in warnings(text) {
            let (_, warning) = line.split_once("warning: ").unwrap_or_default();
            told.warn(warning);
        }
        told.model.retain(|line| warnings(line).next().is_none());
        told.error = text.rfind("\nerror: ").map(|at| error(&text[at + 1..]));
        told
    }

    /// Adds a warning that is not known yet.
    pub fn warn(&mut self, warning: &str) {
        if !self.warnings.iter().any(|known| known == warning) {
            self.warnings.push(warning.to_string());
        }
    }
}

/// The error that a text begins with: a line, and those below it that are indented.
fn error(text: &str) -> String {
    let mut lines = text.trim_start_matches("error: ").lines();
    let first = lines.next().unwrap_or_default();
    lines.take_while(|line| line.starts_with(' ')).fold(first.to_string(), |all, line| all + "\n" + line)
}

/// The line of a converged increment.
struct Converged<'l> {
    step: &'l str,
    number: usize,
    percent: &'l str,
}

impl<'l> Converged<'l> {
    fn of(line: &'l str) -> Option<Self> {
        let (step, rest) = line.split_once("  increment ")?;
        let mut words = rest.split_whitespace();
        let number = words.next()?.parse().ok()?;
        let percent = words.find(|word| word.ends_with('%'))?;
        Some(Self { step, number, percent })
    }
}

fn is_trouble(line: &str) -> bool {
    line.starts_with("  ") && (line.contains("; again ") || line.contains(": no equilibrium near; went on"))
}

/// Before the controls of the solution, and what is said of the first increment.
fn belongs_to_model(line: &str) -> bool {
    let ends = ["controls", "    ", "error: "].iter().any(|begin| line.starts_with(begin));
    !ends && Converged::of(line).is_none() && !is_trouble(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_is_taken_apart() {
        let told = Told::new(
            "A <title>\n8 elements, 27 nodes\ntool `die`: rigid\n  warning: tool `die`: it leaks\ncontrols:\n\
             \x20 press: it flips with increment 5.000e-1; again in a shorter one\n\
             \x20   residual/force (status changes): 1.0e0\n\
             press  increment    1  time 0.25         12%  size 0.25         4 iterations  3 in contact, 0 slip\n\
             \x20 warning: tool `die`: it leaks\n\
             \x20 press: no equilibrium near; went on to another in 7 steps\n\
             press  increment    2  time 0.5          25%  size 0.25         4 iterations  3 in contact, 0 slip\n\
             1 increments\nerror: step `press`: no\n  help: try\nreport: x.html",
        );
        assert_eq!(told.model, ["8 elements, 27 nodes", "tool `die`: rigid"]);
        assert_eq!(told.warnings, ["tool `die`: it leaks"]);
        let troubles: Vec<(usize, &str)> = told.troubles.iter().map(|(n, text)| (*n, &text[..14])).collect();
        assert_eq!(troubles, [(0, "press: it flip"), (1, "press: no equi")]);
        assert_eq!(told.last, Some(("press".into(), "25%".into())));
        assert_eq!(told.error.as_deref(), Some("step `press`: no\n  help: try"));
        assert_eq!(Told::new("A title\nhalf a li").model, ["half a li"]);
    }
}

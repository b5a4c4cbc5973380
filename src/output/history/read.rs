//! `history.csv` read back.

use crate::error::{Error, Result};
use std::path::Path;

/// Rows of increments.
#[derive(Clone, Debug, Default)]
pub struct History {
    names: Vec<String>,
    /// Of each row.
    steps: Vec<String>,
    /// By column.
    values: Vec<Vec<f64>>,
}

/// The three components of a vector, by the ends of their columns' names.
pub type Components = [&'static str; 3];

/// Force of a tool, set or contact.
pub const FORCE: Components = ["fx", "fy", "fz"];

/// Displacement of a tool or set.
pub const DISPLACEMENT: Components = ["ux", "uy", "uz"];

/// The columns that every history begins with.
const FIRST: [&str; 4] = ["step", "increment", "time", "iterations"];

impl History {
    /// Reads the file of a run that has ended.
    ///
    /// # Errors
    /// [`Error::System`] when it is not there, or not as `nagata` writes it.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path);
        let history = text.map_err(|e| e.to_string()).and_then(|text| Self::parse(&text));
        let history = history.and_then(|read| if read.steps.is_empty() { Err("is empty".into()) } else { Ok(read) });
        history.map_err(|what| Error::System(format!("cannot read {}: {what}", path.display())))
    }

    /// Reads the text of a history, which may have no rows.
    ///
    /// # Errors
    /// What is wrong, and in which line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let mut records = reader.into_records().map(|record| record.map_err(|error| error.to_string()));
        let header = records.next().unwrap_or_else(|| Err("is empty".into()))?;
        if header.iter().take(FIRST.len()).ne(FIRST) {
            return Err(format!("does not begin with the columns {}", FIRST.join(",")));
        }
        let names: Vec<String> = header.iter().skip(1).map(str::to_string).collect();
        let (mut steps, mut values) = (Vec::new(), vec![Vec::new(); names.len()]);
        for record in records {
            let record = record?;
            let line = record.position().map_or(0, csv::Position::line);
            if record.len() != header.len() {
                return Err(format!("line {line} has {} cells instead of {}", record.len(), header.len()));
            }
            let mut cells = record.iter();
            steps.extend(cells.next().map(str::to_string));
            for (column, cell) in values.iter_mut().zip(cells) {
                column.push(cell.parse().map_err(|_| format!("line {line}: `{cell}` is not a number"))?);
            }
        }
        Ok(Self { names, steps, values })
    }

    /// The columns after the first, which names the step.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// A column, a value an increment.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.names.iter().position(|known| known == name).map(|k| self.values[k].as_slice())
    }

    /// Time at the end of each increment.
    pub fn times(&self) -> &[f64] {
        self.column("time").unwrap_or_default()
    }

    /// The rows of the last increments of the steps, with the names of the steps.
    pub fn ends(&self) -> Vec<(&str, usize)> {
        let last = |k: &usize| self.steps.get(k + 1) != Some(&self.steps[*k]);
        (0..self.steps.len()).filter(last).map(|k| (self.steps[k].as_str(), k)).collect()
    }

    /// Those who have a column with this end: tools, sets, contacts, bodies.
    pub fn sources(&self, end: &str) -> Vec<&str> {
        self.names.iter().filter_map(|name| name.strip_suffix(end)?.strip_suffix('.')).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_what_stands_there() {
        let text = "step,increment,time,iterations,\"a, b.fx\",punch.fx\npress,1,0.5,3,-1e-300,2\n\
                    \"go, on\",2,1,4,NaN,4\n\"go, on\",3,1.5,4,0.1,5\n";
        let history = History::parse(text).unwrap();
        assert_eq!(history.times(), [0.5, 1.0, 1.5]);
        assert_eq!(history.ends(), [("press", 0), ("go, on", 2)]);
        assert_eq!(history.sources("fx"), ["a, b", "punch"]);
        assert_eq!(history.column("punch.fx"), Some(&[2.0, 4.0, 5.0][..]));
        let shared = history.column("a, b.fx").unwrap();
        assert!(shared[0] == -1e-300 && shared[1].is_nan() && shared[2] == 0.1);
        assert_eq!(history.column("punch.fy"), None);
        assert!(History::parse("step,increment,time,iterations\n").unwrap().times().is_empty());
    }

    #[test]
    fn what_is_broken_is_said() {
        let head = "step,increment,time,iterations";
        for (text, words) in [
            (String::new(), "is empty"),
            ("time,force\n1,2\n".into(), "does not begin with the columns step,increment,time,iterations"),
            (format!("{head}\na,1,0.5,3\na,2,1\n"), "line 3 has 3 cells instead of 4"),
            (format!("{head}\na,1,b,3\n"), "line 2: `b` is not a number"),
        ] {
            assert_eq!(History::parse(&text).unwrap_err(), words);
        }
    }
}

//! The one error type: wrong input, no convergence, a failing library or system call, or a signal.
//!
//! The command line maps them to exit codes 2, 1, 3 and 4. Every message says what is wrong, where, and what would be right.

use crate::failure::{Cause, Failure};
use std::fmt;
use std::sync::Arc;

/// A place in an input file, or an override given on the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct Location {
    /// File name as the user gave it, or `--set key=value`.
    pub file: Arc<str>,
    /// Line, from 1; 0 when the place has none.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The offending text, one line at most; may be empty.
    pub text: Arc<str>,
}

/// What can end a run.
#[derive(Clone, Debug)]
pub enum Error {
    /// The input is wrong: exit code 2.
    Input {
        /// Where it stands, when it stands somewhere.
        at: Option<Location>,
        /// What is wrong.
        what: String,
        /// What would be right; may be empty.
        help: String,
    },
    /// Several parts of the input are wrong, independently of each other: exit code 2.
    Inputs(Vec<Error>),
    /// The solution did not converge: exit code 1, results until then are kept.
    Diverged(Box<Failure>),
    /// A library or system call failed: exit code 3.
    System(String),
    /// A signal ended the run: exit code 4, results until then are kept.
    Interrupted(String),
}

/// Result with the crate's error unless another is named.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// Wrong input at a place.
    pub fn input(at: &Location, what: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Input { at: Some(at.clone()), what: what.into(), help: help.into() }
    }

    /// No convergence, in words.
    pub fn diverged(cause: Cause, what: impl Into<String>) -> Self {
        Self::Diverged(Box::new(Failure { cause, what: what.into(), ..Failure::default() }))
    }

    /// Wrong input without a place in a file.
    pub fn input_anywhere(what: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Input { at: None, what: what.into(), help: help.into() }
    }

    /// The exit code of the program for this error.
    pub fn exit_code(&self) -> i32 {
        match self {
            Self::Diverged(_) => 1,
            Self::Input { .. } | Self::Inputs(_) => 2,
            Self::System(_) => 3,
            Self::Interrupted(_) => 4,
        }
    }
}

/// Errors of parts that do not depend on each other, which are told together.
#[derive(Debug, Default)]
pub struct Faults(Vec<Error>);

impl Faults {
    /// Keeps the error of a result, if it has one.
    pub fn note<T>(&mut self, result: &Result<T>) {
        match result {
            Ok(_) => {}
            Err(Error::Inputs(errors)) => self.0.extend(errors.iter().cloned()),
            Err(error) => self.0.push(error.clone()),
        }
    }

    /// All values.
    ///
    /// # Errors
    /// Those of all results that have none.
    pub fn all<T>(results: impl IntoIterator<Item = Result<T>>) -> Result<Vec<T>> {
        let (mut faults, results) = (Self::default(), results.into_iter().collect::<Vec<_>>());
        results.iter().for_each(|result| faults.note(result));
        faults.finish()?;
        results.into_iter().collect()
    }

    /// Whether there are none.
    ///
    /// # Errors
    /// Those that there are, in the order of their places; one that is not of the input alone.
    pub fn finish(mut self) -> Result<()> {
        if let Some(k) = self.0.iter().position(|error| !matches!(error, Error::Input { .. })) {
            return Err(self.0.swap_remove(k));
        }
        let place = |error: &Error| match error {
            Error::Input { at: Some(at), .. } => (at.file.clone(), at.line, at.column),
            _ => ("".into(), 0, 0),
        };
        self.0.sort_by_key(place);
        match self.0.len() {
            0 => Ok(()),
            1 => Err(self.0.remove(0)),
            _ => Err(Error::Inputs(self.0)),
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line == 0 {
            write!(f, "{}", self.file)
        } else {
            write!(f, "{}:{}:{}", self.file, self.line, self.column)
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input { at, what, help } => {
                if let Some(at) = at {
                    write!(f, "{at}: ")?;
                }
                write!(f, "{what}")?;
                if let Some(at) = at.as_ref().filter(|at| !at.text.is_empty()) {
                    write!(f, "\n  | {}", at.text)?;
                }
                if !help.is_empty() {
                    write!(f, "\n  help: {help}")?;
                }
                Ok(())
            }
            Self::Inputs(errors) => {
                // Each as the command line begins the first.
                let told: Vec<String> = errors.iter().map(ToString::to_string).collect();
                write!(f, "{}", told.join("\nerror: "))
            }
            Self::Diverged(failure) => write!(f, "{failure}"),
            Self::System(what) | Self::Interrupted(what) => write!(f, "{what}"),
        }
    }
}

impl std::error::Error for Error {}

impl From<petsc::Error> for Error {
    fn from(error: petsc::Error) -> Self {
        Self::System(error.to_string())
    }
}

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
            Self::Input { .. } => 2,
            Self::System(_) => 3,
            Self::Interrupted(_) => 4,
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

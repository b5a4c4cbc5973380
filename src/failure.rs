//! Why an increment has no solution.

use std::fmt;

/// What kind of failure it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cause {
    /// Newton's method did not converge.
    #[default]
    Iteration,
    /// The matrix was singular from the start: a shorter increment does not help.
    Singular,
    /// It became singular on the way.
    Degenerate,
    /// Newton's method converged, but not the rounds around it.
    Rounds,
    /// Constraints that gave way cannot be tightened.
    Contradiction,
    /// Rounding leaves too much of the forces.
    Rounding,
    /// It converged to what cannot be, a node in or behind a master: shorter increments help, or, with friction, a jump.
    Watch,
    /// It converged to an equilibrium that is not stable: shorter increments follow the way to another.
    Unstable,
    /// It converged, but an element has folded over.
    Folded,
    /// It converged, but nothing holds something any more.
    Loose,
    /// A force or torque drives a tool that nothing can hold.
    Runaway,
    /// It converged, but an element cannot follow.
    Element,
}

impl Cause {
    /// Newton's method has failed, not what judges its result.
    pub fn is_of_iteration(self) -> bool {
        matches!(self, Self::Iteration | Self::Degenerate)
    }

    /// The matrix determines nothing, or nearly so.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::Singular | Self::Degenerate)
    }

    /// The failure of a remedy says less than that of Newton's method without it.
    pub fn is_of_remedy(self) -> bool {
        self.is_of_iteration() || matches!(self, Self::Contradiction | Self::Rounds)
    }
}

/// A node of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    pub body: String,
    /// Its number in the mesh file.
    pub node: u64,
    /// Where it was in the beginning.
    pub at: [f64; 3],
}

impl Place {
    /// On one line, to be sent.
    pub fn to_line(&self) -> String {
        let [x, y, z] = self.at;
        format!("{} {x:?} {y:?} {z:?} {}", self.node, self.body)
    }

    /// What [`Self::to_line`] wrote.
    pub fn from_line(line: &str) -> Option<Self> {
        let mut words = line.splitn(5, ' ');
        let node = words.next()?.parse().ok()?;
        let mut number = || words.next()?.parse().ok();
        let at = [number()?, number()?, number()?];
        Some(Self { body: words.next()?.to_string(), node, at })
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.at;
        write!(f, "{} of body `{}` at ({x:.6}, {y:.6}, {z:.6})", self.node, self.body)
    }
}

/// An increment that was not found in whatever way it was sought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Failure {
    pub cause: Cause,
    pub step: String,
    /// Time of the last converged increment.
    pub time: f64,
    /// Size of the increment that failed, in time; 0 where that does not matter.
    pub size: f64,
    /// The node with the largest residual, where there is one.
    pub place: Option<Place>,
    /// That residual, over the forces that it counts against.
    pub residual: f64,
    /// Contact nodes that still changed their status.
    pub changes: usize,
    /// All of it in words, with what to try.
    pub what: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)
    }
}

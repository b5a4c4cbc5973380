//! Newton's method: convergence, and every way a callback or a linear solve can fail on one rank or on all.

mod common;
use common::*;

use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::{
    Evaluation, Factorization, Iterate, Jacobian, LinearFailure, Petsc, Problem, Reason, Snes, Vector, Verdict,
};

const N: usize = 9;
/// The root of the cubic system.
const ROOT: f64 = 2.0;

/// What a problem does wrong, on the last rank alone, when its method is called for the second time.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Error,
    Panic,
    OutOfDomain,
}

/// F(x) = T x + x^3 - b with a tridiagonal T, b such that all x_i = ROOT.
struct Cubic<'a> {
    comm: &'a SimpleCommunicator,
    rows: std::ops::Range<usize>,
    /// The method at fault: `residual`, `jacobian`, `converged` or `limit_step`.
    fault: Option<(&'static str, Fault)>,
    calls: std::collections::HashMap<&'static str, usize>,
    /// Adds entries far from the diagonal to the pattern in every other Jacobian.
    change_pattern: bool,
    /// Makes the Jacobian singular from this call on.
    singular_from: usize,
    /// The longest step of an unknown.
    longest_step: f64,
    norms: Vec<f64>,
    /// The rows of the last Jacobian.
    stored: (Vec<i32>, Vec<i32>, Vec<f64>),
}

impl<'a> Cubic<'a> {
    fn new(petsc: &Petsc<'a>) -> Self {
        let (rows, comm) = (own_rows(petsc, N), petsc.communicator());
        Self {
            comm,
            rows,
            fault: None,
            calls: Default::default(),
            change_pattern: false,
            singular_from: usize::MAX,
            longest_step: f64::INFINITY,
            norms: vec![],
            stored: Default::default(),
        }
    }

    fn with_fault(petsc: &Petsc<'a>, method: &'static str, fault: Fault) -> Self {
        Self { fault: Some((method, fault)), ..Self::new(petsc) }
    }

    /// Counts the call; returns whether F is defined.
    fn enter(&mut self, method: &'static str) -> Result<bool, String> {
        let calls = self.calls.entry(method).or_default();
        *calls += 1;
        match self.fault {
            Some((at, fault)) if at == method && *calls == 2 && self.comm.rank() == self.comm.size() - 1 => match fault
            {
                Fault::Error => Err(format!("fault in {method} on rank {}", self.comm.rank())),
                Fault::Panic => panic!("panic in {method}"),
                Fault::OutOfDomain => Ok(false),
            },
            _ => Ok(true),
        }
    }

    /// The whole of x, by a collective within the callback. Row `i` couples to `i - 1` and `i + 1`.
    fn whole(&self, x: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; N];
        let mut mine = vec![0.0; N];
        mine[self.rows.clone()].copy_from_slice(x);
        self.comm.all_reduce_into(&mine, &mut sum, mpi::collective::SystemOperation::sum());
        sum
    }

    fn tridiagonal(i: usize, j: usize) -> f64 {
        match j as i32 - i as i32 {
            0 => 4.0,
            1 => -1.5,
            -1 => -0.5,
            _ => 0.0,
        }
    }

    fn dense_jacobian(x: &[f64], singular: bool, more: bool) -> Vec<Vec<f64>> {
        let entry = |i: usize, j: usize| {
            let cubic = if i == j { 3.0 * x[i] * x[i] } else { 0.0 };
            // Not zero, so that the pattern stands.
            let scale = if singular && i == 0 { f64::MIN_POSITIVE } else { 1.0 };
            let far = if more && i.abs_diff(j) == 4 { 1e-14 } else { 0.0 };
            scale * (Self::tridiagonal(i, j) + cubic) + far
        };
        (0..N).map(|i| (0..N).map(|j| entry(i, j)).collect()).collect()
    }
}

impl Problem for Cubic<'_> {
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<Evaluation, String> {
        let x = self.whole(x);
        let rows = self.rows.clone();
        for (r, i) in r.iter_mut().zip(rows) {
            let linear: f64 = (0..N).map(|j| Self::tridiagonal(i, j) * (x[j] - ROOT)).sum();
            *r = linear + x[i].powi(3) - ROOT.powi(3);
        }
        Ok(if self.enter("residual")? { Evaluation::Done } else { Evaluation::OutOfDomain })
    }

    fn jacobian(&mut self, x: &[f64]) -> Result<Jacobian<'_>, String> {
        let x = self.whole(x);
        self.enter("jacobian")?;
        let call = self.calls["jacobian"];
        let more = self.change_pattern && call.is_multiple_of(2);
        let dense = Self::dense_jacobian(&x, call >= self.singular_from, more);
        self.stored = compress(self.rows.clone(), &dense);
        let (row_offsets, columns, values) = &self.stored;
        Ok(if self.change_pattern {
            Jacobian::Pattern { row_offsets, columns, values }
        } else {
            Jacobian::Values(values)
        })
    }

    fn converged(&mut self, iterate: &Iterate<'_>) -> Result<Verdict, String> {
        let norm = self.whole(iterate.residual).iter().map(|r| r * r).sum::<f64>().sqrt();
        self.enter("converged")?;
        assert_eq!((iterate.x.len(), iterate.residual.len()), (self.rows.len(), self.rows.len()));
        assert_eq!(iterate.iteration, self.norms.len());
        assert_eq!(iterate.iteration == 0, iterate.step_norm == 0.0);
        assert!((norm - iterate.residual_norm).abs() <= 1e-12 * norm);
        self.norms.push(norm);
        Ok(match norm {
            norm if norm < 1e-11 => Verdict::Converged,
            _ if iterate.iteration == 50 => Verdict::Diverged,
            _ => Verdict::Iterate,
        })
    }

    fn limit_step(&mut self, _x: &[f64], step: &mut [f64]) -> Result<bool, String> {
        self.enter("limit_step")?;
        let longest = self.longest_step;
        step.iter_mut().for_each(|step| *step = step.clamp(-longest, longest));
        Ok(longest < f64::INFINITY)
    }
}

fn newton<'p>(petsc: &'p Petsc<'p>) -> Snes<'p> {
    let jacobian = matrix(petsc, &Cubic::dense_jacobian(&[1.0; N], false, false));
    Snes::new(petsc, jacobian, Factorization::Lu).unwrap()
}

fn start<'p>(petsc: &'p Petsc<'p>) -> Vector<'p> {
    vector(petsc, &[5.0; N])
}

/// Solves from the start and checks the root.
fn solve_well(petsc: &Petsc, snes: &mut Snes, problem: &mut Cubic) {
    let mut x = start(petsc);
    let outcome = snes.solve(&mut x, problem).unwrap();
    assert_eq!(outcome.reason, Reason::Converged, "{outcome:?} {:?}", problem.norms);
    assert_eq!(outcome.iterations + 1, problem.norms.len());
    assert!(x.array().unwrap().iter().all(|x| (x - ROOT).abs() < 1e-11));
}

#[test]
fn converges_quadratically() {
    with_petsc("converges_quadratically", &[1, 2, 3], "", |petsc| {
        let (mut snes, mut problem) = (newton(petsc), Cubic::new(petsc));
        solve_well(petsc, &mut snes, &mut problem);
        let norms = &problem.norms;
        assert!(norms.len() < 9, "{norms:?}");
        let last = norms.windows(2).rfind(|pair| pair[1] > 1e-9).unwrap();
        assert!(last[1] < 0.1 * last[0].powi(2), "{norms:?}");
        let statistics = snes.linear_statistics();
        assert_eq!((statistics.analyses, statistics.solves), (1, norms.len() - 1));
        assert_eq!(petsc.log_count("MatLUFactorSym").unwrap(), 1);
        assert_eq!(petsc.log_count("MatLUFactorNum").unwrap(), norms.len() - 1);
        assert_eq!(problem.calls["residual"], norms.len());
        assert!(petsc.log_seconds("SNESSolve").unwrap() > 0.0);
        // Again, without another analysis.
        solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
        assert_eq!(snes.linear_statistics().analyses, 1);
    });
}

#[test]
fn steps_can_be_limited() {
    with_petsc("steps_can_be_limited", &[1, 2, 3], "", |petsc| {
        let mut problem = Cubic { longest_step: 0.5, ..Cubic::new(petsc) };
        solve_well(petsc, &mut newton(petsc), &mut problem);
        assert!((8..13).contains(&problem.norms.len()), "{:?}", problem.norms);
    });
}

#[test]
fn an_error_on_one_rank_is_an_error_on_all() {
    fail_on_one_rank("an_error_on_one_rank_is_an_error_on_all", Fault::Error, |method, last| {
        format!("fault in {method} on rank {last}")
    });
}

#[test]
fn a_panic_on_one_rank_is_an_error_on_all() {
    fail_on_one_rank("a_panic_on_one_rank_is_an_error_on_all", Fault::Panic, |method, last| {
        format!("panic on rank {last}: panic in {method}")
    });
}

fn fail_on_one_rank(test: &str, fault: Fault, message: impl Fn(&str, i32) -> String) {
    with_petsc(test, &[1, 2, 3], "", |petsc| {
        let mut snes = newton(petsc);
        for method in ["residual", "jacobian", "converged", "limit_step"] {
            let mut x = start(petsc);
            let error = snes.solve(&mut x, &mut Cubic::with_fault(petsc, method, fault)).unwrap_err();
            assert_eq!(error.0, message(method, petsc.communicator().size() - 1));
            // The solver is as good as before, and so are the objects.
            assert!(x.norm2().unwrap() > 0.0);
            solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
        }
    });
}

#[test]
fn out_of_domain_on_one_rank_ends_the_iteration() {
    with_petsc("out_of_domain_on_one_rank_ends_the_iteration", &[1, 2, 3], "", |petsc| {
        let mut snes = newton(petsc);
        for _ in 0..2 {
            let mut problem = Cubic::with_fault(petsc, "residual", Fault::OutOfDomain);
            let outcome = snes.solve(&mut start(petsc), &mut problem).unwrap();
            assert_eq!(outcome.reason, Reason::OutOfDomain, "{outcome:?}");
            assert_eq!(problem.calls["residual"], 2);
            solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
        }
        // At the start, too.
        let mut problem = Cubic::with_fault(petsc, "residual", Fault::OutOfDomain);
        problem.calls.insert("residual", 1);
        assert_eq!(snes.solve(&mut start(petsc), &mut problem).unwrap().reason, Reason::OutOfDomain);
        solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
    });
}

#[test]
fn a_line_search_backs_into_the_domain() {
    let options = "-snes_linesearch_type bt";
    with_petsc("a_line_search_backs_into_the_domain", &[1, 2, 3], options, |petsc| {
        let mut problem = Cubic::with_fault(petsc, "residual", Fault::OutOfDomain);
        solve_well(petsc, &mut newton(petsc), &mut problem);
        assert!(problem.calls["residual"] > problem.norms.len());
        assert!(problem.calls["limit_step"] > 0);
    });
}

#[test]
fn divergence_is_an_outcome() {
    with_petsc("divergence_is_an_outcome", &[1, 2], "", |petsc| {
        let mut snes = newton(petsc);
        let mut problem = Cubic { longest_step: 1e-3, ..Cubic::new(petsc) };
        let outcome = snes.solve(&mut start(petsc), &mut problem).unwrap();
        assert_eq!((outcome.reason, outcome.iterations), (Reason::Diverged, 50));
        petsc.option("snes_max_it", "3").unwrap();
        let outcome = newton(petsc).solve(&mut start(petsc), &mut Cubic::new(petsc)).unwrap();
        assert_eq!((outcome.reason, outcome.iterations), (Reason::IterationLimit, 3));
        let mut x = start(petsc);
        x.set(f64::NAN).unwrap();
        assert_eq!(snes.solve(&mut x, &mut Cubic::new(petsc)).unwrap().reason, Reason::NotFinite);
    });
}

#[test]
fn a_singular_jacobian_is_an_outcome() {
    with_petsc("a_singular_jacobian_is_an_outcome", &[1, 2, 3], "", |petsc| {
        let mut snes = newton(petsc);
        for _ in 0..2 {
            let mut problem = Cubic { singular_from: 2, ..Cubic::new(petsc) };
            let outcome = snes.solve(&mut start(petsc), &mut problem).unwrap();
            assert!(matches!(outcome.reason, Reason::Linear(LinearFailure::Inaccurate { .. })), "{outcome:?}");
            assert_eq!(outcome.iterations, 1);
            solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
        }
    });
}

#[test]
fn the_pattern_may_change_within_a_solve() {
    with_petsc("the_pattern_may_change_within_a_solve", &[1, 2, 3], "", |petsc| {
        let mut snes = newton(petsc);
        let mut problem = Cubic { change_pattern: true, ..Cubic::new(petsc) };
        solve_well(petsc, &mut snes, &mut problem);
        assert_eq!(snes.linear_statistics().analyses, problem.norms.len() - 1);
    });
}

#[test]
fn options_choose_another_direct_solver() {
    let options = "-pc_type lu -pc_factor_mat_solver_type mumps";
    with_petsc("options_choose_another_direct_solver", &[1, 2, 3], options, |petsc| {
        let mut snes = newton(petsc);
        solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
        solve_well(petsc, &mut snes, &mut Cubic { change_pattern: true, ..Cubic::new(petsc) });
        let statistics = snes.linear_statistics();
        assert!(statistics.analyses == 0 && statistics.solves > 8 && statistics.relative_residual < 1e-12);
        let mut problem = Cubic { singular_from: 2, ..Cubic::new(petsc) };
        let outcome = snes.solve(&mut start(petsc), &mut problem).unwrap();
        assert!(matches!(outcome.reason, Reason::Linear(_)), "{outcome:?}");
    });
}

#[test]
fn options_choose_an_iterative_solver() {
    let options = "-ksp_type gmres -pc_type jacobi -ksp_rtol 1e-10";
    with_petsc("options_choose_an_iterative_solver", &[1, 2, 3], options, |petsc| {
        let mut snes = newton(petsc);
        solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
        assert_eq!(snes.linear_statistics().analyses, 0);
        // Too few iterations: PETSc's own reason.
        petsc.option("ksp_max_it", "1").unwrap();
        let outcome = newton(petsc).solve(&mut start(petsc), &mut Cubic::new(petsc)).unwrap();
        assert_eq!(outcome.reason, Reason::Linear(LinearFailure::Krylov("DIVERGED_ITS".into())));
        // A preconditioner in the place of a solver: ours.
        petsc.option("ksp_type", "preonly").unwrap();
        let outcome = newton(petsc).solve(&mut start(petsc), &mut Cubic::new(petsc)).unwrap();
        assert!(matches!(outcome.reason, Reason::Linear(LinearFailure::Inaccurate { .. })), "{outcome:?}");
    });
}

#[test]
fn our_direct_solver_can_be_a_preconditioner() {
    with_petsc("our_direct_solver_can_be_a_preconditioner", &[1, 2], "-ksp_type gmres -ksp_rtol 1e-10", |petsc| {
        let mut snes = newton(petsc);
        solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
        let outcome = snes.solve(&mut start(petsc), &mut Cubic { singular_from: 2, ..Cubic::new(petsc) }).unwrap();
        assert!(matches!(outcome.reason, Reason::Linear(LinearFailure::Inaccurate { .. })), "{outcome:?}");
        solve_well(petsc, &mut snes, &mut Cubic::new(petsc));
    });
}

#[test]
fn ranks_that_disagree_go_on() {
    struct Hasty<'a>(Cubic<'a>);
    impl Problem for Hasty<'_> {
        fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<Evaluation, String> {
            self.0.residual(x, r)
        }
        fn jacobian(&mut self, x: &[f64]) -> Result<Jacobian<'_>, String> {
            self.0.jacobian(x)
        }
        fn converged(&mut self, iterate: &Iterate<'_>) -> Result<Verdict, String> {
            let verdict = self.0.converged(iterate)?;
            Ok(if self.0.comm.rank() == 0 && iterate.iteration > 0 { Verdict::Converged } else { verdict })
        }
    }
    with_petsc("ranks_that_disagree_go_on", &[1, 2], "", |petsc| {
        let mut x = start(petsc);
        let outcome = newton(petsc).solve(&mut x, &mut Hasty(Cubic::new(petsc))).unwrap();
        assert_eq!(outcome.reason, Reason::Converged);
        assert_eq!(outcome.iterations > 1, petsc.communicator().size() > 1);
    });
}

#[test]
fn a_start_of_the_wrong_length_on_one_rank_is_an_error_on_all() {
    with_petsc("a_start_of_the_wrong_length_on_one_rank_is_an_error_on_all", &[1, 2], "", |petsc| {
        let length = own_rows(petsc, N).len() + usize::from(petsc.communicator().rank() == 0);
        let error = newton(petsc).solve(&mut Vector::zeros(petsc, length).unwrap(), &mut Cubic::new(petsc));
        assert!(error.unwrap_err().0.contains("vector of"));
    });
}

#[test]
fn a_pattern_from_one_rank_alone_is_an_error() {
    struct Lone<'a>(Cubic<'a>);
    impl Problem for Lone<'_> {
        fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<Evaluation, String> {
            self.0.residual(x, r)
        }
        fn jacobian(&mut self, x: &[f64]) -> Result<Jacobian<'_>, String> {
            self.0.change_pattern = self.0.comm.rank() == 0;
            self.0.jacobian(x)
        }
        fn converged(&mut self, iterate: &Iterate<'_>) -> Result<Verdict, String> {
            self.0.converged(iterate)
        }
    }
    with_petsc("a_pattern_from_one_rank_alone_is_an_error", &[2], "", |petsc| {
        let error = newton(petsc).solve(&mut start(petsc), &mut Lone(Cubic::new(petsc))).unwrap_err();
        assert!(error.0.contains("new pattern"), "{error}");
    });
}

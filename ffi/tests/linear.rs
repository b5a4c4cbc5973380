//! The direct solver: accuracy, reuse, and what it says of systems without a good solution.

mod common;
use common::*;

use petsc::{
    Factorization, LinearError, LinearFailure, LinearSolver, Matrix, Multipliers, Negative, Node, Petsc, Unknowns,
};

/// Solves for a known solution and returns its largest error.
fn error_of_solution(petsc: &Petsc, solver: &mut LinearSolver, a: &Matrix, dense: &[Vec<f64>]) -> f64 {
    let exact: Vec<f64> = (0..dense.len()).map(|i| (1.0 + i as f64).sin()).collect();
    let (b, mut x) = (vector(petsc, &product(dense, &exact)), vector(petsc, &vec![0.0; dense.len()]));
    solver.solve(a, &b, &mut x).unwrap();
    x.axpy(-1.0, &vector(petsc, &exact)).unwrap();
    x.norm_inf().unwrap()
}

/// Solves for b = 1 and returns the failure.
fn failure(petsc: &Petsc, solver: &mut LinearSolver, a: &Matrix, b: f64) -> LinearFailure {
    let n = a.global_rows().unwrap();
    match solver.solve(a, &vector(petsc, &vec![b; n]), &mut vector(petsc, &vec![0.0; n])) {
        Err(LinearError::Failure(failure)) => failure,
        other => panic!("{other:?}"),
    }
}

fn reuse(petsc: &Petsc, kind: Factorization, symbolic: &str, numeric: &str, mut dense: Vec<Vec<f64>>) {
    let n = dense.len();
    let mut a = matrix(petsc, &dense);
    a.set_symmetric(kind == Factorization::Ldlt).unwrap();
    let mut solver = LinearSolver::new(petsc, kind);
    let counts = || (petsc.log_count(symbolic).unwrap(), petsc.log_count(numeric).unwrap());
    let solve = |solver: &mut LinearSolver, a: &Matrix, dense: &[Vec<f64>]| {
        let error = error_of_solution(petsc, solver, a, dense);
        assert!(error < 1e-9, "{error}");
    };
    for _ in 0..2 {
        solve(&mut solver, &a, &dense);
        assert_eq!(counts(), (1, 1));
    }
    for factorizations in 2..4 {
        dense.iter_mut().flatten().for_each(|a| *a *= 1.5);
        a.update(&compress(own_rows(petsc, n), &dense).2).unwrap();
        solve(&mut solver, &a, &dense);
        assert_eq!(counts(), (1, factorizations));
    }
    (dense[0][3], dense[3][0]) = (1e4, 1e4);
    let (offsets, columns, values) = compress(own_rows(petsc, n), &dense);
    a.rebuild(&offsets, &columns, &values).unwrap();
    solve(&mut solver, &a, &dense);
    assert_eq!(counts(), (2, 4));
    // Another matrix with the same pattern is another pattern all the same.
    solve(&mut solver, &matrix(petsc, &dense), &dense);
    let statistics = solver.statistics();
    assert_eq!((statistics.analyses, statistics.factorizations, statistics.solves), (3, 5, 6));
    assert_eq!((statistics.workspace_retries, statistics.null_pivots), (0, 0));
    assert!(statistics.relative_residual < 1e-12, "{statistics:?}");
    assert!(petsc.log_seconds(numeric).unwrap() > 0.0 && petsc.log_seconds("NoSuchEvent").unwrap() == 0.0);
}

#[test]
fn ldlt_of_a_saddle_point() {
    with_petsc("ldlt_of_a_saddle_point", &[1, 2, 3], "", |petsc| {
        reuse(petsc, Factorization::Ldlt, "MatCholFctrSym", "MatCholFctrNum", saddle_point(20, 5));
    });
}

#[test]
fn lu_of_an_unsymmetric_saddle_point() {
    with_petsc("lu_of_an_unsymmetric_saddle_point", &[1, 2, 3], "", |petsc| {
        let mut dense = saddle_point(20, 5);
        for i in 0..20 {
            dense[i][20 + i % 5] += 0.3;
        }
        reuse(petsc, Factorization::Lu, "MatLUFactorSym", "MatLUFactorNum", dense);
    });
}

/// The factors of one matrix serve another that is near it, be its pattern another; they are computed anew for one that is not,
/// and where they are of a matrix with null pivots.
#[test]
fn factors_are_reused() {
    with_petsc("factors_are_reused", &[1, 2, 3], "", |petsc| {
        for kind in [Factorization::Ldlt, Factorization::Lu] {
            let (mut solver, mut dense) = (LinearSolver::new(petsc, kind), saddle_point(40, 8));
            solver.reuse_factors(0).unwrap();
            let mut a = matrix(petsc, &dense);
            a.set_symmetric(true).unwrap();
            let mut solve = |a: &Matrix, dense: &[Vec<f64>]| {
                let error = error_of_solution(petsc, &mut solver, a, dense);
                assert!(error < 1e-6, "{error}");
                let statistics = solver.statistics();
                (statistics.factorizations, statistics.reused)
            };
            assert_eq!(solve(&a, &dense), (1, 0));
            dense[3][3] *= 2.0;
            a.update(&compress(own_rows(petsc, 48), &dense).2).unwrap();
            assert_eq!(solve(&a, &dense), (1, 1));
            (dense[0][5], dense[5][0]) = (0.1, 0.1);
            let (offsets, columns, values) = compress(own_rows(petsc, 48), &dense);
            a.rebuild(&offsets, &columns, &values).unwrap();
            assert_eq!(solve(&a, &dense), (1, 2));
            (0..40).for_each(|i| dense[i][i] *= if i % 2 == 0 { 1e4 } else { 1.0 });
            a.update(&compress(own_rows(petsc, 48), &dense).2).unwrap();
            assert_eq!(solve(&a, &dense), (2, 2));
            for _ in 0..2 {
                // A constraint that is another's.
                dense[47] = dense[46].iter().map(|value| 2.0 * value).collect();
                (0..40).for_each(|i| dense[i][47] = 2.0 * dense[i][46]);
                (0..40).for_each(|i| dense[i][i] *= if i % 2 == 0 { 1e-4 } else { 1e3 });
                let b = vector(petsc, &product(&dense, &[1.0; 48]));
                let mut singular = matrix(petsc, &dense);
                singular.set_symmetric(true).unwrap();
                solver.solve(&singular, &b, &mut vector(petsc, &[0.0; 48])).unwrap();
                assert_eq!(solver.statistics().null_pivots, 1);
            }
            assert_eq!((solver.statistics().factorizations, solver.statistics().reused), (4, 2));
        }
    });
}

/// A cantilever of 1000 springs, loaded everywhere: rounding leaves more of b than is usual, which counts where it is accepted.
#[test]
fn what_rounding_leaves_counts_where_it_is_accepted() {
    with_petsc("what_rounding_leaves_counts_where_it_is_accepted", &[1, 2], "", |petsc| {
        let n = 1000;
        let mut dense = vec![vec![0.0; n]; n];
        // Second differences of node i with those before it, which are held where there are none.
        for i in 0..n {
            let terms = [(i as isize - 2, 1.0), (i as isize - 1, -2.0), (i as isize, 1.0)];
            let terms: Vec<_> = terms.into_iter().filter(|(j, _)| *j >= 0).map(|(j, a)| (j as usize, a)).collect();
            for (j, a) in &terms {
                terms.iter().for_each(|(k, b)| dense[*j][*k] += a * b);
            }
        }
        let mut solver = LinearSolver::new(petsc, Factorization::Lu);
        let a = matrix(petsc, &dense);
        match failure(petsc, &mut solver, &a, 1.0) {
            LinearFailure::Inaccurate { relative_residual, null_pivots: 0 } => {
                assert!(relative_residual > 1e-6 && relative_residual < 1e-2, "{relative_residual:e}");
            }
            other => panic!("{other}"),
        }
        solver.accept(1e-2);
        let (b, mut x) = (vector(petsc, &vec![1.0; n]), vector(petsc, &vec![0.0; n]));
        solver.solve(&a, &b, &mut x).unwrap();
        assert!(solver.statistics().relative_residual > 1e-6 && solver.statistics().refinements > 0);
        // An end that sinks by some n^4/8.
        assert!((x.norm_inf().unwrap() / (n as f64).powi(4) - 0.125).abs() < 2e-3);
    });
}

#[test]
fn an_empty_system_is_solved() {
    with_petsc("an_empty_system_is_solved", &[1, 2], "", |petsc| {
        assert_eq!(
            error_of_solution(petsc, &mut LinearSolver::new(petsc, Factorization::Lu), &matrix(petsc, &[]), &[])
                .max(0.0),
            0.0
        );
    });
}

#[test]
fn a_redundant_constraint_is_counted() {
    with_petsc("a_redundant_constraint_is_counted", &[1, 2, 3], "", |petsc| {
        let mut dense = saddle_point(10, 2);
        dense[11] = dense[10].clone();
        (0..10).for_each(|i| dense[i][11] = dense[i][10]);
        for kind in [Factorization::Ldlt, Factorization::Lu] {
            let mut solver = LinearSolver::new(petsc, kind);
            let b = vector(petsc, &product(&dense, &[1.0; 12]));
            let mut x = vector(petsc, &[0.0; 12]);
            solver.solve(&matrix(petsc, &dense), &b, &mut x).unwrap();
            assert_eq!(solver.statistics().null_pivots, 1);
            assert!(solver.statistics().relative_residual < 1e-12);
        }
    });
}

/// Two constraints that are one leave the difference of their multipliers open, and nothing else.
#[test]
fn the_null_space_is_found() {
    with_petsc("the_null_space_is_found", &[1, 2, 3], "", |petsc| {
        let regular = saddle_point(10, 2);
        let mut singular = regular.clone();
        singular[11] = singular[10].clone();
        (0..10).for_each(|i| singular[i][11] = singular[i][10]);
        let z: Vec<f64> = (0..12).map(|i| (1.0 + i as f64).sin()).collect();
        for kind in [Factorization::Ldlt, Factorization::Lu] {
            let part = |dense: &[Vec<f64>]| {
                let mut solver = LinearSolver::new(petsc, kind);
                let part = solver.null_part(&matrix(petsc, dense), &vector(petsc, &z)).unwrap().unwrap();
                let opens = vector(petsc, &[[0.0; 10].as_slice(), &[1.0, -1.0]].concat());
                (part.norm2().unwrap(), part.dot(&opens).unwrap().abs() / 2f64.sqrt())
            };
            assert!(part(&regular).0 < 1e-9);
            let (all, open) = part(&singular);
            assert!(open > 0.1 && (all - open).abs() < 1e-9, "{all} {open}");
        }
    });
}

#[test]
fn a_singular_matrix_is_a_failure() {
    with_petsc("a_singular_matrix_is_a_failure", &[1, 2, 3], "", |petsc| {
        // Two equations alike with different right-hand sides.
        let mut dense = saddle_point(10, 2);
        dense[11] = dense[10].clone();
        (0..10).for_each(|i| dense[i][11] = dense[i][10]);
        let b: Vec<f64> = (0..12).map(|i| i as f64).collect();
        for kind in [Factorization::Ldlt, Factorization::Lu] {
            let mut solver = LinearSolver::new(petsc, kind);
            let (b, mut x) = (vector(petsc, &b), vector(petsc, &[0.0; 12]));
            match solver.solve(&matrix(petsc, &dense), &b, &mut x) {
                Err(LinearError::Failure(LinearFailure::Inaccurate { relative_residual, null_pivots: 1 })) => {
                    assert!(relative_residual > 1e-3)
                }
                other => panic!("{other:?}"),
            }
            // It is as good as before.
            let sound = saddle_point(10, 2);
            assert!(error_of_solution(petsc, &mut solver, &matrix(petsc, &sound), &sound) < 1e-9);
        }
    });
}

/// Of a saddle point each multiplier makes one negative eigenvalue; LDLᵀ counts them, LU tells an odd number.
#[test]
fn negative_eigenvalues_are_told() {
    with_petsc("negative_eigenvalues_are_told", &[1, 2, 3], "", |petsc| {
        for count in [0, 1, 2] {
            let mut dense = saddle_point(10, 2);
            (0..count).for_each(|i| dense[4 * i][4 * i] -= 1e6);
            let a = matrix(petsc, &dense);
            for kind in [Factorization::Ldlt, Factorization::Lu] {
                let mut solver = LinearSolver::new(petsc, kind);
                error_of_solution(petsc, &mut solver, &a, &dense);
                let negative = solver.statistics().negative;
                let told = if kind == Factorization::Ldlt { 2 + count } else { count % 2 };
                assert!(!negative.is_not(told), "{count}: {negative:?}");
                assert!(negative.is_not(told + 1), "{count}: {negative:?}");
            }
        }
    });
}

/// (A + Aᵀ) / 2 of a matrix with a skew part is the one without it, also where the pattern is not symmetric.
#[test]
fn the_symmetric_part_is_judged() {
    with_petsc("the_symmetric_part_is_judged", &[1, 2, 3], "", |petsc| {
        for count in [0, 1, 2] {
            let mut dense = saddle_point(10, 2);
            (0..count).for_each(|i| dense[4 * i][4 * i] -= 1e6);
            for (i, j) in [(0, 9), (3, 5), (2, 11)] {
                (dense[i][j], dense[j][i]) = (dense[i][j] + dense[j][i], 0.0);
            }
            let part = matrix(petsc, &dense).symmetric_part().unwrap();
            let mut solver = LinearSolver::new(petsc, Factorization::Ldlt);
            let negative = solver.negative_eigenvalues(&part).unwrap();
            assert_eq!(negative, Some(Negative::Count(2 + count)));
        }
    });
}

#[test]
fn a_null_pivot_is_a_failure_where_it_may_not_be_replaced() {
    let options = "-mat_mumps_icntl_24 0";
    with_petsc("a_null_pivot_is_a_failure_where_it_may_not_be_replaced", &[1, 2, 3], options, |petsc| {
        let mut dense = saddle_point(10, 2);
        dense[11] = dense[10].clone();
        (0..10).for_each(|i| dense[i][11] = dense[i][10]);
        let a = matrix(petsc, &dense);
        for kind in [Factorization::Ldlt, Factorization::Lu] {
            // What rounding leaves of the pivot decides who notices.
            let failure = failure(petsc, &mut LinearSolver::new(petsc, kind), &a, 1.0);
            let noticed = match failure {
                LinearFailure::Singular(-10, _) => true,
                LinearFailure::Inaccurate { relative_residual, null_pivots: 0 } => relative_residual > 1e-2,
                _ => false,
            };
            assert!(noticed, "{failure:?}");
            assert!(failure.to_string().contains("singular"), "{failure}");
        }
    });
}

/// A pivot far below the others is needed all the same: it is found null, spoils the solution, and is taken as it is.
#[test]
fn a_small_pivot_is_not_null() {
    with_petsc("a_small_pivot_is_not_null", &[1, 2, 3], "-mat_mumps_cntl_3 1e-3 -mat_mumps_icntl_8 0", |petsc| {
        let mut dense = saddle_point(10, 2);
        // Coupled to nothing else, with a stiffness of its own.
        (0..12).for_each(|i| (dense[11][i], dense[i][11]) = (0.0, 0.0));
        dense[11][11] = 1e-5;
        for kind in [Factorization::Ldlt, Factorization::Lu] {
            let mut solver = LinearSolver::new(petsc, kind);
            let a = matrix(petsc, &dense);
            let mut load = [0.0; 12];
            load[11] = 1e-5;
            for _ in 0..2 {
                let (b, mut x) = (vector(petsc, &load), vector(petsc, &[0.0; 12]));
                solver.solve(&a, &b, &mut x).unwrap();
                assert!((x.norm_inf().unwrap() - 1.0).abs() < 1e-9);
            }
            let statistics = solver.statistics();
            assert_eq!((statistics.small_pivots, statistics.null_pivots, statistics.factorizations), (1, 0, 2));
        }
    });
}

/// MUMPS may take 1 MB.
#[test]
fn want_of_memory_is_its_own_failure() {
    with_petsc("want_of_memory_is_its_own_failure", &[1, 2], "-mat_mumps_icntl_23 1", |petsc| {
        let n = 600;
        let entry = |i: usize, j: usize| if i == j { 30.0 } else { ((i * 37 + j * 61) % 101) as f64 / 101.0 };
        let dense: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        let failure = failure(petsc, &mut LinearSolver::new(petsc, Factorization::Lu), &matrix(petsc, &dense), 1.0);
        assert!(matches!(failure, LinearFailure::Memory { code: -19, missing: 1.., estimate: 2.. }), "{failure:?}");
        assert!(failure.to_string().contains("not enough memory"), "{failure}");
    });
}

#[test]
fn a_nan_is_a_failure() {
    with_petsc("a_nan_is_a_failure", &[1, 2, 3], "", |petsc| {
        let dense = saddle_point(10, 2);
        let mut a = matrix(petsc, &dense);
        let mut solver = LinearSolver::new(petsc, Factorization::Ldlt);
        assert_eq!(failure(petsc, &mut solver, &a, f64::NAN), LinearFailure::NotFinite("right-hand side"));
        let (_, _, good) = compress(own_rows(petsc, 12), &dense);
        let mut bad = good.clone();
        // On the last rank only.
        if own_rows(petsc, 12).end == 12 && !bad.is_empty() {
            bad[0] = f64::NAN;
        }
        a.update(&bad).unwrap();
        assert_eq!(failure(petsc, &mut solver, &a, 1.0), LinearFailure::NotFinite("matrix"));
        a.update(&good).unwrap();
        assert!(error_of_solution(petsc, &mut solver, &a, &dense) < 1e-9);
        assert_eq!(solver.statistics().analyses, 1);
    });
}

#[test]
fn want_of_workspace_is_met() {
    with_petsc("want_of_workspace_is_met", &[1, 2], "-mat_mumps_icntl_14 -60", |petsc| {
        // Dense, so that the factors need what was estimated.
        let n = 200;
        let entry = |i: usize, j: usize| if i == j { 30.0 } else { ((i * 37 + j * 61) % 101) as f64 / 101.0 };
        let dense: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        let mut solver = LinearSolver::new(petsc, Factorization::Lu);
        assert!(error_of_solution(petsc, &mut solver, &matrix(petsc, &dense), &dense) < 1e-9);
        let statistics = solver.statistics();
        assert!(statistics.workspace_retries == 1 && statistics.factorizations == 2, "{statistics:?}");
    });
}

/// Elastic lattice of 3 x 4 x 5 nodes on springs, of which three are fixed in x, and nine multipliers: a third of them free, with a
/// diagonal alone, the others holding a node down. On two ranks those are on the second, and most of their nodes on the first.
fn lattice() -> (Vec<Vec<f64>>, Unknowns) {
    const NODES: usize = 60;
    const MULTIPLIERS: usize = 9;
    const FIXED: usize = 3;
    let row = |node: usize, d: usize| match node < FIXED {
        true => (d > 0).then(|| 2 * node + d - 1),
        false => Some(3 * node + d - FIXED),
    };
    let total = 3 * NODES - FIXED + MULTIPLIERS;
    let mut dense = vec![vec![0.0; total]; total];
    let mut add = |a: Option<usize>, b: Option<usize>, value: f64| {
        if let (Some(a), Some(b)) = (a, b) {
            dense[a][b] += value;
        }
    };
    let place = |node: usize| [node / 20, node / 5 % 4, node % 5];
    let cross = [[1.0, 0.1, 0.0], [0.1, 1.0, 0.1], [0.0, 0.1, 1.0]];
    for (a, b) in (0..NODES).flat_map(|a| (0..NODES).map(move |b| (a, b))) {
        let apart: usize = place(a).iter().zip(place(b)).map(|(a, b)| a.abs_diff(b)).sum();
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let held = if a == b && place(a)[2] == 0 { 1e5 } else { 0.0 };
            if apart == 1 {
                add(row(a, i), row(a, j), 1e5 * cross[i][j]);
                add(row(a, i), row(b, j), -1e5 * cross[i][j]);
            } else if i == j {
                add(row(a, i), row(b, j), held);
            }
        }
    }
    for m in 0..MULTIPLIERS {
        let (at, node) = (Some(total - MULTIPLIERS + m), 6 * m + 4);
        if m % 3 == 0 {
            add(at, at, -2e5);
        } else {
            add(at, row(node, 2), 2e5);
            add(row(node, 2), at, 2e5);
        }
    }
    let node = |n: usize| Node {
        directions: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        rows: [0, 1, 2].map(|d| row(n, d).map(|row| row as u32)),
        position: place(n).map(|x| x as f64),
    };
    let force = |m: usize| Multipliers { first: (total - MULTIPLIERS + m) as u32, count: 1, stiffness: 5e5 };
    (dense, Unknowns { nodes: (0..NODES).map(node).collect(), multipliers: (0..MULTIPLIERS).map(force).collect() })
}

/// The part of this rank, with its rows counted there.
fn own_unknowns(petsc: &Petsc, total: usize, all: &Unknowns) -> Unknowns {
    let own = own_rows(petsc, total);
    let local = |row: u32| own.contains(&(row as usize)).then(|| row - own.start as u32);
    let of_rank = |node: &Node| Node { rows: node.rows.map(|row| row.and_then(local)), ..*node };
    let nodes = all.nodes.iter().map(of_rank).filter(|node| node.rows.iter().any(Option::is_some)).collect();
    let of_rank = |m: &Multipliers| Some(Multipliers { first: local(m.first)?, ..*m });
    let multipliers = all.multipliers.iter().filter_map(of_rank).collect();
    Unknowns { nodes, multipliers }
}

#[test]
fn multigrid_solves_what_mumps_does() {
    with_petsc("multigrid_solves_what_mumps_does", &[1, 2, 3], "", |petsc| {
        let (mut dense, unknowns) = lattice();
        let mut a = matrix(petsc, &dense);
        let mut solver = LinearSolver::new(petsc, Factorization::Lu);
        solver.iterate(own_unknowns(petsc, dense.len(), &unknowns), usize::MAX).unwrap();
        // New values, of which some make another contact, then a new pattern.
        for round in 0..3 {
            let error = error_of_solution(petsc, &mut solver, &a, &dense);
            assert!(error < 1e-6, "{round}: {error}");
            let at = dense.len() - 9;
            match round {
                0 => {
                    dense.iter_mut().flatten().for_each(|a| *a *= 1.5);
                    (dense[at + 1][at + 1], dense[at + 1][9]) = (-1e5, 0.0);
                    a = matrix(petsc, &dense);
                }
                _ => {
                    (dense[0][170], dense[170][0]) = (10.0, 10.0);
                    let (offsets, columns, values) = compress(own_rows(petsc, dense.len()), &dense);
                    a.rebuild(&offsets, &columns, &values).unwrap();
                }
            }
        }
        let statistics = solver.statistics();
        assert_eq!((statistics.iterative_solves, statistics.unsolved, statistics.factorizations), (3, 0, 0));
        assert!(statistics.krylov_iterations < 100, "{statistics:?}");
        assert!(statistics.relative_residual < 1e-7, "{statistics:?}");
    });
}

/// Multigrid that takes more iterations than are worth it gives way to factors after three systems.
#[test]
fn too_many_iterations_of_multigrid() {
    with_petsc("too_many_iterations_of_multigrid", &[1, 2], "", |petsc| {
        let (dense, unknowns) = lattice();
        let a = matrix(petsc, &dense);
        let mut solver = LinearSolver::new(petsc, Factorization::Lu);
        solver.iterate(own_unknowns(petsc, dense.len(), &unknowns), 2).unwrap();
        for round in 1..6 {
            assert!(error_of_solution(petsc, &mut solver, &a, &dense) < 1e-6);
            assert_eq!(solver.impatience().is_some(), round >= 3);
        }
        let statistics = solver.statistics();
        assert_eq!((statistics.iterative_solves, statistics.unsolved, statistics.factorizations), (3, 0, 1));
    });
}

#[test]
fn what_multigrid_cannot_solve_is_factored() {
    let options = "-linear_ksp_type preonly";
    with_petsc("what_multigrid_cannot_solve_is_factored", &[1, 2], options, |petsc| {
        let (dense, unknowns) = lattice();
        let a = matrix(petsc, &dense);
        let mut solver = LinearSolver::new(petsc, Factorization::Lu);
        solver.iterate(own_unknowns(petsc, dense.len(), &unknowns), usize::MAX).unwrap();
        for round in 1..6 {
            let error = error_of_solution(petsc, &mut solver, &a, &dense);
            assert!(error < 1e-9, "{error}");
            // Not for ever.
            assert_eq!(solver.statistics().unsolved, round.min(3));
        }
        assert_eq!(solver.statistics().factorizations, 1);
    });
}

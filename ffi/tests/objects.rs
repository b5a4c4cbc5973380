//! Start, options, errors, vectors and matrices.

mod common;
use common::*;

use mpi::traits::*;
use petsc::{Factorization, Matrix, Petsc, Snes, Vector};

#[test]
fn malformed_options_are_errors() {
    on_ranks("malformed_options_are_errors", &[1, 2], |world| {
        for (bad, word) in [("snes_monitor", "`snes_monitor`"), ("-options_file /none/such", "/none/such")] {
            let options: Vec<String> = bad.split(' ').map(String::from).collect();
            let error = Petsc::initialize(world, &options).err().unwrap();
            assert!(error.0.contains(word), "{error}");
        }
        // One rank's bad option is all ranks' error.
        let options = if world.rank() == world.size() - 1 { vec!["stray".to_string()] } else { vec![] };
        assert!(Petsc::initialize(world, &options).err().unwrap().0.contains("`stray`"));

        let petsc = Petsc::initialize(world, &["-given".into(), "3".into()]).unwrap();
        assert!(Petsc::initialize(world, &[]).err().unwrap().0.contains("before"));
        assert_eq!(petsc.unused_options().unwrap(), ["given"]);
        assert!(petsc.has_option("given").unwrap() && !petsc.has_option("missing").unwrap());
        assert!(petsc.unused_options().unwrap().is_empty());
    });
}

#[test]
fn petsc_errors_are_results_with_its_words() {
    with_petsc("petsc_errors_are_results_with_its_words", &[1, 2], "-snes_max_it many", |petsc| {
        let make = || Snes::new(petsc, matrix(petsc, &saddle_point(3, 1)), Factorization::Ldlt);
        let error = make().err().unwrap().0;
        assert!(error.contains("string many has no integer value"), "{error}");
        assert!(error.contains("() at") && error.contains("SNESSetFromOptions"), "{error}");
        petsc.option("snes_max_it", "7").unwrap();
        petsc.option("snes_type", "nonsense").unwrap();
        let error = make().err().unwrap().0;
        assert!(error.contains("nonsense") && !error.contains("many"), "{error}");
        petsc.option("snes_type", "newtonls").unwrap();
        make().unwrap();
        assert!(Petsc::version().starts_with("3."), "{}", Petsc::version());
    });
}

#[test]
fn vectors() {
    with_petsc("vectors", &[1, 2, 3], "", |petsc| {
        let whole = [3.0, -4.0, 0.0, 1.0, -5.0];
        let (mut x, mut y) = (vector(petsc, &whole), vector(petsc, &[1.0; 5]));
        assert_eq!(x.local_len(), own_rows(petsc, 5).len());
        assert_eq!(x.global_len().unwrap(), 5);
        assert_eq!(x.norm2().unwrap(), 51.0_f64.sqrt());
        assert_eq!(x.norm_inf().unwrap(), 5.0);
        assert_eq!(x.dot(&y).unwrap(), -5.0);
        y.axpy(2.0, &x).unwrap();
        let expected: Vec<f64> = whole.iter().map(|x| 1.0 + 2.0 * x).collect();
        assert_eq!(*y.array().unwrap(), expected[own_rows(petsc, 5)]);
        x.array_mut().unwrap().iter_mut().for_each(|x| *x *= 2.0);
        assert_eq!(x.norm_inf().unwrap(), 10.0);
        x.copy_from(&y).unwrap();
        assert_eq!(x.norm_inf().unwrap(), 9.0);
        x.set(-1.0).unwrap();
        assert_eq!(x.dot(&x).unwrap(), 5.0);
        // A misfit on one rank is an error on all.
        let other = Vector::zeros(petsc, x.local_len() + usize::from(petsc.communicator().rank() == 0)).unwrap();
        assert!(x.copy_from(&other).is_err() && x.axpy(1.0, &other).is_err() && x.dot(&other).is_err());
        assert_eq!(Vector::zeros(petsc, 0).unwrap().norm_inf().unwrap().max(0.0), 0.0);
    });
}

#[test]
fn matrices() {
    with_petsc("matrices", &[1, 2, 3], "", |petsc| {
        let whole = [1.0, 2.0, -3.0, 4.0, 0.5, 6.0, 7.0];
        let check = |a: &Matrix, dense: &[Vec<f64>]| {
            let (x, expected) = (vector(petsc, &whole), vector(petsc, &product(dense, &whole)));
            let (mut y, mut r) = (vector(petsc, &[0.0; 7]), vector(petsc, &[0.0; 7]));
            a.multiply(&x, &mut y).unwrap();
            y.axpy(-1.0, &expected).unwrap();
            assert!(y.norm_inf().unwrap() < 1e-10);
            assert!(a.residual(&expected, &x, &mut r).unwrap() < 1e-9);
        };
        let mut dense = saddle_point(5, 2);
        let mut a = matrix(petsc, &dense);
        assert_eq!((a.local_rows(), a.global_rows().unwrap()), (own_rows(petsc, 7).len(), 7));
        check(&a, &dense);

        dense.iter_mut().flatten().enumerate().for_each(|(i, a)| *a *= 1.0 + i as f64);
        a.update(&compress(own_rows(petsc, 7), &dense).2).unwrap();
        check(&a, &dense);

        (dense[0][6], dense[6][6], dense[5][0]) = (3.0, -1.0, 2.0);
        let (offsets, columns, values) = compress(own_rows(petsc, 7), &dense);
        a.set_symmetric(true).unwrap();
        a.rebuild(&offsets, &columns, &values).unwrap();
        check(&a, &dense);
        a.update(&values.iter().map(|value| -value).collect::<Vec<_>>()).unwrap();
        dense.iter_mut().flatten().for_each(|a| *a = -*a);
        check(&a, &dense);
        assert!(a.is_symmetric());
    });
}

#[test]
fn a_bad_row_on_one_rank_is_an_error_on_all() {
    with_petsc("a_bad_row_on_one_rank_is_an_error_on_all", &[1, 2], "", |petsc| {
        let rows = own_rows(petsc, 4);
        let last = petsc.communicator().rank() == petsc.communicator().size() - 1;
        let (offsets, mut columns, values) = compress(rows.clone(), &saddle_point(3, 1));
        let mut a = Matrix::from_csr(petsc, rows.len(), &offsets, &columns, &values).unwrap();
        assert!(a.update(&values[usize::from(last)..]).unwrap_err().0.contains("values"));
        if last {
            columns[0] = 4;
        }
        let error = Matrix::from_csr(petsc, rows.len(), &offsets, &columns, &values).err().unwrap();
        assert!(error.0.contains("local row 0") && error.0.contains("0..4"), "{error}");
        assert!(a.rebuild(&offsets, &columns, &values).is_err());
        a.update(&values).unwrap();
    });
}

//! What a kill leaves of a file at each moment of a change, told by copies of it; and changes that fail.

use hdf5::File;
use journal::{Change, journal};
use std::fs;
use std::path::Path;

/// Adds a numbered group with data, as a run adds an increment.
fn add(file: &File, number: usize) -> hdf5::Result<()> {
    let group = if number == 0 { file.create_group("increments")? } else { file.group("increments")? };
    for field in ["u", "stress"] {
        let values: Vec<f64> = (0..300).map(|i| (number * 1000 + i) as f64).collect();
        group.new_dataset_builder().with_data(&values).create(format!("{number:06}/node/{field}").as_str())?;
    }
    Ok(())
}

/// How many increments there are, all of them whole.
fn whole(path: &Path) -> usize {
    let file = File::open(path).unwrap();
    let group = file.group("increments").unwrap();
    let names = group.member_names().unwrap();
    for (number, name) in names.iter().enumerate() {
        assert_eq!(*name, format!("{number:06}"));
        for field in ["u", "stress"] {
            let values = group.dataset(&format!("{name}/node/{field}")).unwrap().read_raw::<f64>().unwrap();
            assert!(values.len() == 300 && values[299] == (number * 1000 + 299) as f64);
        }
    }
    names.len()
}

fn created(folder: &Path) -> std::path::PathBuf {
    let path = folder.join("fields.h5");
    File::create(&path).unwrap().close().unwrap();
    path
}

#[test]
fn a_kill_leaves_the_increments_before() {
    let folder = tempfile::tempdir().unwrap();
    let (path, copy) = (created(folder.path()), folder.path().join("copy.h5"));
    for number in 0..40 {
        let change = Change::begin(&path).unwrap();
        add(change.file(), number).unwrap();
        change.file().flush().unwrap();
        fs::copy(&path, &copy).unwrap();
        if number > 0 {
            assert_eq!(whole(&copy), number);
        }
        change.commit().unwrap();
        assert!(!journal(&path).exists());
        // HDF5's own driver reads it, and finds that it ends where it should.
        assert_eq!(whole(&path), number + 1);
        // And goes on with what a kill has left.
        if number > 0 {
            let change = Change::begin(&copy).unwrap();
            add(change.file(), number).unwrap();
            change.commit().unwrap();
            assert_eq!(fs::read(&copy).unwrap().len(), fs::read(&path).unwrap().len());
            assert_eq!(whole(&copy), number + 1);
        }
    }
    // What is taken out again.
    let before = fs::read(&path).unwrap();
    let change = Change::begin(&path).unwrap();
    (20..40).for_each(|number| change.file().unlink(&format!("increments/{number:06}")).unwrap());
    change.file().flush().unwrap();
    assert!(fs::read(&path).unwrap()[..before.len()] == before);
    change.commit().unwrap();
    assert_eq!(whole(&path), 20);
}

#[test]
fn what_is_not_committed_has_not_happened() {
    let folder = tempfile::tempdir().unwrap();
    let path = created(folder.path());
    let change = Change::begin(&path).unwrap();
    add(change.file(), 0).unwrap();
    change.commit().unwrap();
    let before = fs::read(&path).unwrap();
    let change = Change::begin(&path).unwrap();
    add(change.file(), 1).unwrap();
    change.file().flush().unwrap();
    drop(change);
    assert!(fs::read(&path).unwrap() == before);
    // A journal that cannot be written.
    fs::create_dir(journal(&path)).unwrap();
    assert!(Change::begin(&path).is_err());
    fs::remove_dir(journal(&path)).unwrap();
    let change = Change::begin(&path).unwrap();
    add(change.file(), 1).unwrap();
    fs::create_dir(journal(&path)).unwrap();
    assert!(change.commit().is_err());
    fs::remove_dir(journal(&path)).unwrap();
    assert!(fs::read(&path).unwrap() == before);
}

#[test]
fn what_is_no_file_of_hdf5_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fields.h5");
    assert!(Change::begin(&path).is_err());
    let text = "longer than the superblock of a file of HDF5's, which has 96 bytes at the least ".repeat(2);
    fs::write(&path, &text).unwrap();
    assert!(Change::begin(&path).is_err());
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
}

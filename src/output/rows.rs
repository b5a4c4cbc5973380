//! The rows of a dataset that each rank has, and how they come to its file.

use crate::parallel::number;
use hdf5::{Dataset, File, H5Type};
use mpi::traits::*;
use std::path::Path;

/// The rows of a dataset that this rank owns: `first .. first + owned` of `total`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    pub first: u64,
    pub owned: u64,
    pub total: u64,
}

/// A dataset to write, with this rank's rows.
pub(super) struct Rows<'a, T> {
    pub path: String,
    pub width: usize,
    pub share: Share,
    pub values: &'a [T],
}

impl Share {
    pub fn of(comm: &impl Communicator, owned: usize) -> Self {
        let (first, total) = number(comm, owned as u64);
        Self { first, owned: owned as u64, total }
    }
}

impl<T: H5Type + Equivalence> Rows<'_, T> {
    /// Writes the rows of all ranks to `file`, which rank 0 has, unless something is wrong already. Collective.
    pub fn add(&self, comm: &impl Communicator, file: Option<&File>, written: &mut hdf5::Result<()>) {
        let Some(file) = file else {
            if self.share.total > 0 {
                comm.process_at_rank(0).send(self.values);
            }
            return;
        };
        let created = written.clone().and_then(|()| self.create(file));
        let mut take = |values: &[T], first: u64| {
            if let (Ok(()), Ok(Some(dataset))) = (&*written, &created) {
                *written = self.write(dataset, values, first);
            }
        };
        take(self.values, self.share.first);
        let mut first = self.share.first + self.share.owned;
        for rank in (1..comm.size()).filter(|_| self.share.total > 0) {
            let (values, _) = comm.process_at_rank(rank).receive_vec::<T>();
            take(&values, first);
            first += (values.len() / self.width) as u64;
        }
        if let (Ok(()), Err(error)) = (&*written, created) {
            *written = Err(error);
        }
    }
}

impl<T: H5Type> Rows<'_, T> {
    /// The dataset; none when it is empty on all ranks.
    pub fn create(&self, file: &File) -> hdf5::Result<Option<Dataset>> {
        let total = self.share.total as usize;
        let builder = file.new_dataset::<T>();
        match (total, self.width) {
            (0, _) => Ok(None),
            (_, 1) => builder.shape(total).create(self.path.as_str()).map(Some),
            (_, width) => builder.shape((total, width)).create(self.path.as_str()).map(Some),
        }
    }

    /// Whether the dataset stands in a file, as long and wide.
    pub fn check(&self, path: &Path) -> std::result::Result<(), String> {
        let length = self.share.total as usize;
        let expected = if self.width == 1 { vec![length] } else { vec![length, self.width] };
        let found = File::open(path).and_then(|file| file.dataset(&self.path)).map(|dataset| dataset.shape());
        match found {
            Ok(shape) if shape == expected => Ok(()),
            Err(_) if length == 0 => Ok(()),
            Ok(shape) => Err(format!("{} is {shape:?}, and should be {expected:?}", self.path)),
            Err(error) => Err(error.to_string()),
        }
    }

    /// Writes the rows from `first` on.
    fn write(&self, dataset: &Dataset, values: &[T], first: u64) -> hdf5::Result<()> {
        match self.width {
            _ if values.is_empty() => Ok(()),
            1 => dataset.write_slice(values, first as usize..first as usize + values.len()),
            3 => write_table::<T, 3>(dataset, values, first),
            4 => write_table::<T, 4>(dataset, values, first),
            5 => write_table::<T, 5>(dataset, values, first),
            6 => write_table::<T, 6>(dataset, values, first),
            8 => write_table::<T, 8>(dataset, values, first),
            10 => write_table::<T, 10>(dataset, values, first),
            18 => write_table::<T, 18>(dataset, values, first),
            _ => write_table::<T, 27>(dataset, values, first),
        }
    }
}

fn write_table<T: H5Type, const WIDTH: usize>(dataset: &Dataset, values: &[T], first: u64) -> hdf5::Result<()> {
    let (rows, first) = (values.as_chunks::<WIDTH>().0, first as usize);
    dataset.write_slice::<_, T, _, _>(rows, (first..first + rows.len(), 0..WIDTH))
}

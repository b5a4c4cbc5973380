//! `checkpoint.h5`: all that a run goes on from, whatever the number of ranks.
//!
//! Tables of numbers, a row a node, element or slave node in an [`Order`] that does not depend on the partition, and texts. Rank
//! 0 writes a new file, forces it to the disk, and renames it into place: a kill at any moment leaves the last complete one.
//! Behind what is HDF5's stand 16 bytes, a mark and a checksum of all before them, so that what is cut short, damaged or not
//! ours is told before HDF5 sees it.

use super::fields::{self, on_root};
use super::rows::{Rows, Share};
use super::{OutputFolder, cannot_go_on, cannot_write, one_line, partial};
use crate::error::{Error, Result};
use crate::parallel::{agree, first_word, serve};
use crate::partition::Order;
use hdf5::File;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Its name in the folder of the run.
pub const NAME: &str = "checkpoint.h5";

/// The mark, with the version of what the tables hold.
pub const MARK: [u8; 8] = *b"nagata26";

/// The table of the numbers that are the same on all ranks.
const WORDS: &str = "all";

/// A table with this rank's rows.
pub struct Table<'a> {
    pub name: String,
    pub order: &'a Order,
    pub width: usize,
    pub rows: Vec<f64>,
}

/// Writes a checkpoint in the place of the last one; `texts`, by name, and `words` count on rank 0. Collective.
///
/// # Errors
/// [`Error::System`] on all ranks when it cannot be written; the last one stays.
pub fn write(
    folder: &OutputFolder,
    comm: &SimpleCommunicator,
    texts: &[(&str, &str)],
    words: &[f64],
    tables: &[Table],
) -> Result<()> {
    let (path, part) = (folder.file(NAME), folder.file(&partial(NAME)));
    fields::create(&part, comm)?;
    let blocks: Vec<Vec<f64>> = tables.iter().map(|t| t.order.arrange(comm, t.width, &t.rows)).collect();
    // What rank 0 alone writes; all know how much it is.
    let all_on_root = |length: usize| {
        let owned = if comm.rank() == 0 { length as u64 } else { 0 };
        let mut total = owned;
        comm.process_at_rank(0).broadcast_into(&mut total);
        Share { first: 0, owned, total }
    };
    let table = |(table, values): (&Table, &'_ Vec<f64>)| {
        let width = table.width as u64;
        let Order { first, total, .. } = *table.order;
        let share = Share { first: first * width, owned: values.len() as u64, total: total * width };
        (table.name.clone(), share)
    };
    let shares = tables.iter().zip(&blocks).map(table);
    let mut reals: Vec<Rows<f64>> =
        shares.zip(&blocks).map(|((path, share), values)| Rows { path, width: 1, share, values }).collect();
    let share = all_on_root(words.len());
    reals.push(Rows { path: WORDS.into(), width: 1, share, values: &words[..share.owned as usize] });
    let bytes: Vec<Vec<i64>> = texts.iter().map(|(_, text)| text.bytes().map(i64::from).collect()).collect();
    let integers: Vec<Rows<i64>> = (texts.iter().zip(&bytes))
        .map(|((name, _), bytes)| {
            let share = all_on_root(bytes.len());
            Rows { path: name.to_string(), width: 1, share, values: &bytes[..share.owned as usize] }
        })
        .collect();
    fields::append(&part, comm, &reals, &integers)?;
    let finish = || seal(&part).and_then(|()| fs::rename(&part, &path)).and_then(|()| sync(folder.path()));
    on_root(comm, || finish().map_err(|error| cannot_write(&path, error)))?;
    Ok(())
}

/// Forces what has been written to a file, or the names in a folder, to the disk.
pub fn sync(path: &Path) -> io::Result<()> {
    fs::File::open(path)?.sync_all()
}

/// A checkpoint that is read; rank 0 has it open.
pub struct Stored {
    path: PathBuf,
    file: Option<File>,
}

impl Stored {
    /// Opens the checkpoint of a folder. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when there is none, or it is damaged.
    pub fn open(folder: &OutputFolder, comm: &SimpleCommunicator) -> Result<Self> {
        let path = folder.file(NAME);
        let open = || {
            check(&path)?;
            File::open(&path).map_err(|error| damaged(&path, &error.to_string()))
        };
        let file = on_root(comm, open)?;
        Ok(Self { path, file })
    }

    /// A text. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when there is none of the name.
    pub fn text(&self, comm: &SimpleCommunicator, name: &str) -> Result<String> {
        let read = |file: &File| file.dataset(name).and_then(|dataset| dataset.read_raw::<i64>());
        let text = self.file.as_ref().map(|file| {
            let bytes = read(file).map_err(|error| self.refused(&error.to_string()))?;
            Ok(bytes.into_iter().map(|byte| byte as u8).collect())
        });
        let bytes: Vec<u8> = agree(comm, text.unwrap_or(Ok(Vec::new())))?;
        let text = String::from_utf8_lossy(&bytes).into_owned();
        Ok(first_word(comm, self.file.as_ref().map(|_| text)).unwrap_or_default())
    }

    /// The numbers that are the same on all ranks. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when there are none.
    pub fn words(&self, comm: &SimpleCommunicator) -> Result<Vec<f64>> {
        let read = |file: &File| file.dataset(WORDS).and_then(|dataset| dataset.read_raw::<f64>());
        let words = self.file.as_ref().map_or(Ok(Vec::new()), read);
        let mut words = agree(comm, words.map_err(|error| self.refused(&error.to_string())))?;
        let root = comm.process_at_rank(0);
        let mut length = words.len() as u64;
        root.broadcast_into(&mut length);
        words.resize(length as usize, 0.0);
        root.broadcast_into(&mut words[..]);
        Ok(words)
    }

    /// The error of a checkpoint that is none of this run.
    pub fn refused(&self, what: &str) -> Error {
        damaged(&self.path, what)
    }

    /// This rank's rows of a table, each of so many numbers. Collective.
    ///
    /// # Errors
    /// [`Error::Input`] on all ranks when there is none of the name and size.
    pub fn table(&self, comm: &SimpleCommunicator, name: &str, order: &Order, width: usize) -> Result<Vec<f64>> {
        let length = order.total as usize * width;
        let size = comm.size() as u64;
        let start = |rank: usize| (rank as u64 * order.total / size) as usize * width;
        let open = |file: &File| match file.dataset(name) {
            Ok(dataset) if dataset.size() == length => Ok(Some(dataset)),
            Ok(dataset) => Err(format!("`{name}` has {} numbers, and should have {length}", dataset.size())),
            Err(_) if length == 0 => Ok(None),
            Err(error) => Err(error.to_string()),
        };
        let dataset = self.file.as_ref().map_or(Ok(None), open);
        let dataset = agree(comm, dataset.map_err(|what| self.refused(&what)))?;
        let mut read = Ok(());
        let block = serve(comm, |rank| {
            let (from, to) = (start(rank), start(rank + 1));
            let rows = dataset.as_ref().filter(|_| from < to).map(|d| d.read_slice_1d::<f64, _>(from..to));
            rows.unwrap_or(Ok(Vec::new().into())).map_or_else(
                |error| {
                    read = Err(self.refused(&error.to_string()));
                    vec![0.0; to - from]
                },
                |rows| rows.to_vec(),
            )
        });
        agree(comm, read)?;
        Ok(order.hand_back(comm, width, &block))
    }
}

/// Adds the mark and the checksum, and forces all to the disk.
fn seal(path: &Path) -> io::Result<()> {
    let sum = checksum(&mut fs::File::open(path)?, u64::MAX)?;
    let mut file = fs::OpenOptions::new().append(true).open(path)?;
    file.write_all(&MARK)?;
    file.write_all(&sum.to_le_bytes())?;
    file.sync_all()
}

/// Whether a file is a whole checkpoint.
fn check(path: &Path) -> Result<()> {
    let mut file = match fs::File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let help =
                "run without --restart; `[output] checkpoint = { increments = 10 }` writes one every 10 increments";
            return Err(Error::input_anywhere(format!("there is no checkpoint {}", path.display()), help));
        }
        Err(error) => return Err(damaged(path, &error.to_string())),
    };
    let ends = || -> io::Result<(u64, [u8; 8], [u8; 8])> {
        let content = file.metadata()?.len().saturating_sub(16);
        let sum = checksum(&mut file, content)?;
        let mut end = Vec::new();
        file.read_to_end(&mut end)?;
        let part = |from: usize| end.get(from..from + 8).and_then(|part| part.try_into().ok()).unwrap_or_default();
        Ok((sum, part(0), part(8)))
    };
    let (sum, mark, told) = { ends }().map_err(|error| damaged(path, &error.to_string()))?;
    match mark {
        MARK if told == sum.to_le_bytes() => Ok(()),
        MARK => Err(damaged(path, "its checksum is not that of what it holds")),
        _ => Err(damaged(path, "it does not end as checkpoints of this version of nagata do")),
    }
}

/// FNV-1a, of 64 bits, of so many bytes at most.
pub fn checksum(from: &mut impl Read, most: u64) -> io::Result<u64> {
    let mut sum = 0xcbf2_9ce4_8422_2325u64;
    let (mut buffer, mut left) = (vec![0; 1 << 16], most);
    while left > 0 {
        let part = left.min(buffer.len() as u64) as usize;
        let count = from.read(&mut buffer[..part])?;
        if count == 0 {
            break;
        }
        left -= count as u64;
        buffer[..count].iter().for_each(|byte| sum = (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3));
    }
    Ok(sum)
}

/// The error of a file that is no checkpoint to go on from.
fn damaged(path: &Path, what: &str) -> Error {
    let help = "run without --restart, which begins anew and replaces all results in the folder";
    cannot_go_on(path, one_line(what), help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_fnv_1a() {
        // The published test vectors.
        for (text, sum) in
            [("", 0xcbf2_9ce4_8422_2325u64), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)]
        {
            assert_eq!(checksum(&mut text.as_bytes(), u64::MAX).unwrap(), sum);
        }
    }

    #[test]
    fn every_byte_counts() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(NAME);
        let told = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            check(&path).map_err(|error| error.to_string())
        };
        let missing = check(&path).unwrap_err();
        assert!(missing.exit_code() == 2 && missing.to_string().contains("there is no checkpoint"), "{missing}");
        fs::write(&path, b"all that a run goes on from").unwrap();
        seal(&path).unwrap();
        let whole = fs::read(&path).unwrap();
        assert_eq!(told(&whole), Ok(()));
        for k in 0..whole.len() {
            let mut other = whole.clone();
            other[k] ^= 4;
            assert!(told(&other).is_err_and(|what| what.contains("cannot go on with")), "{k}");
            assert!(told(&whole[..k]).is_err(), "{k}");
        }
    }
}

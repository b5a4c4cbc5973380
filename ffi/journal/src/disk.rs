//! A file to which is appended, what is to be written over in it, and the journal of that.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind};
use std::os::unix::fs::FileExt;
use std::path::Path;

/// Bytes that are kept as one, if any of them is written over.
const PAGE: u64 = 4096;

/// How a journal begins.
const MARK: [u8; 8] = *b"journal1";

type Pages = BTreeMap<u64, Page>;

/// A page as it is to be.
#[derive(Clone, Debug, PartialEq)]
struct Page {
    /// Checksum of what it was.
    before: u64,
    bytes: Vec<u8>,
}

/// A file as HDF5 sees it.
#[derive(Debug)]
pub struct Disk {
    file: File,
    /// Bytes of the file before the change, as HDF5 knows it; all while it is not known.
    before: u64,
    /// Bytes of the file as HDF5 wants it.
    pub wanted: u64,
    /// Bytes of the file as it is.
    length: u64,
    /// What has been written over, by the number of the page; the last page ends where the file did before.
    pages: Pages,
    /// The first error; nothing is written any more.
    failed: Option<io::Error>,
    /// HDF5 has closed it.
    pub closed: bool,
}

impl Disk {
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        let length = file.metadata()?.len();
        let (pages, failed) = (BTreeMap::new(), None);
        Ok(Self { file, before: u64::MAX, wanted: 0, length, pages, failed, closed: false })
    }

    /// HDF5 has read how much of the file is its own.
    pub fn begin(&mut self) {
        self.before = self.wanted;
        // Of what it may have written while it opened the file.
        self.pages.retain(|number, _| number * PAGE < self.wanted);
        if let Some((number, page)) = self.pages.iter_mut().next_back() {
            page.bytes.truncate((self.before - number * PAGE) as usize);
        }
    }

    /// What could not be done.
    pub fn failure(&self) -> Option<String> {
        self.failed.as_ref().map(ToString::to_string)
    }

    /// Bytes that can be read.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Reads what was written last; zeros behind the end.
    pub fn read(&mut self, at: u64, bytes: &mut [u8]) {
        if let Err(error) = read_or_zeros(&self.file, at, bytes) {
            self.failed.get_or_insert(error);
        }
        let end = at + bytes.len() as u64;
        for (number, page) in self.pages.range(at / PAGE..end.div_ceil(PAGE)) {
            let start = number * PAGE;
            let (from, to) = (at.max(start), end.min(start + page.bytes.len() as u64));
            if from < to {
                bytes[(from - at) as usize..(to - at) as usize]
                    .copy_from_slice(&page.bytes[(from - start) as usize..(to - start) as usize]);
            }
        }
    }

    /// Writes behind the end of the file before the change, and keeps what is before it.
    pub fn write(&mut self, at: u64, bytes: &[u8]) {
        if self.failed.is_some() {
            return;
        }
        let (over, behind) = bytes.split_at(self.before.saturating_sub(at).min(bytes.len() as u64) as usize);
        let begin = at + over.len() as u64;
        let written = self.keep(at, over).and_then(|()| self.file.write_all_at(behind, begin));
        match written {
            Ok(()) => self.length = self.length.max(begin + behind.len() as u64),
            Err(error) => self.failed = Some(error),
        }
    }

    fn keep(&mut self, at: u64, bytes: &[u8]) -> io::Result<()> {
        let end = at + bytes.len() as u64;
        for number in (at / PAGE..end.div_ceil(PAGE)).filter(|_| !bytes.is_empty()) {
            let start = number * PAGE;
            if !self.pages.contains_key(&number) {
                let mut bytes = vec![0; PAGE.min(self.before - start) as usize];
                read_or_zeros(&self.file, start, &mut bytes)?;
                self.pages.insert(number, Page { before: checksum(&bytes), bytes });
            }
            let (from, to) = (at.max(start), end.min(start + PAGE));
            if let Some(page) = self.pages.get_mut(&number) {
                page.bytes[(from - start) as usize..(to - start) as usize]
                    .copy_from_slice(&bytes[(from - at) as usize..(to - at) as usize]);
            }
        }
        Ok(())
    }

    /// The change is not to be.
    pub fn give_up(&mut self) {
        if !self.closed {
            self.failed.get_or_insert_with(|| io::Error::other("given up"));
        }
    }

    /// Takes away what has been written behind the end.
    pub fn go_back(&mut self) {
        let _ = self.file.set_len(self.before.min(self.length));
    }

    /// Makes what HDF5 has written the file, as it `closed` it; what is already behind its end stays unseen until then.
    pub fn commit(&mut self, closed: io::Result<()>, journal: &Path) -> io::Result<()> {
        let closed =
            closed.and(if self.closed { Ok(()) } else { Err(io::Error::other("HDF5 has not closed the file")) });
        // That of the disk comes before what HDF5 makes of it.
        let whole = self.failed.take().map_or(closed, Err);
        let recorded = whole.and_then(|()| match self.pages.is_empty() {
            true => self.file.set_len(self.wanted),
            false => fs::write(journal, self.record()),
        });
        if recorded.is_err() {
            // Whatever came of it is no journal without its end.
            let _ = remove(journal);
            self.go_back();
        }
        recorded?;
        write_over(&self.file, &self.pages, self.wanted)?;
        remove(journal)
    }

    /// The journal: mark, length before and after, pages with their numbers and what they were, checksum.
    fn record(&self) -> Vec<u8> {
        let mut record = MARK.to_vec();
        record.extend(self.before.to_le_bytes());
        record.extend(self.wanted.to_le_bytes());
        for (number, page) in &self.pages {
            record.extend(number.to_le_bytes());
            record.extend(page.before.to_le_bytes());
            record.extend((page.bytes.len() as u64).to_le_bytes());
            record.extend(&page.bytes);
        }
        record.extend(checksum(&record).to_le_bytes());
        record
    }
}

/// Does what a journal says; one that is not complete, or of another file, says nothing.
pub fn recover(path: &Path, journal: &Path) -> io::Result<()> {
    let record = match fs::read(journal) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        record => record?,
    };
    if let Some((before, wanted, pages)) = parse(&record) {
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        let is_its = |(number, page): (&u64, &Page)| {
            let mut now = vec![0; page.bytes.len()];
            read_or_zeros(&file, number * PAGE, &mut now).map(|()| now == page.bytes || checksum(&now) == page.before)
        };
        let mut is_of_file = file.metadata()?.len() >= before;
        for page in &pages {
            is_of_file = is_of_file && is_its(page)?;
        }
        if is_of_file {
            write_over(&file, &pages, wanted)?;
        }
    }
    remove(journal)
}

type Recorded = (u64, u64, Pages);

fn parse(record: &[u8]) -> Option<Recorded> {
    let (said, sum) = record.split_last_chunk::<8>()?;
    if checksum(said) != u64::from_le_bytes(*sum) {
        return None;
    }
    let mut rest = said.strip_prefix(&MARK)?;
    let number = |rest: &mut &[u8]| {
        let (first, left) = rest.split_first_chunk::<8>()?;
        *rest = left;
        Some(u64::from_le_bytes(*first))
    };
    let (before, wanted) = (number(&mut rest)?, number(&mut rest)?);
    let mut pages = BTreeMap::new();
    while !rest.is_empty() {
        let (page, before, length) = (number(&mut rest)?, number(&mut rest)?, number(&mut rest)?);
        let (bytes, left) = rest.split_at_checked(length as usize)?;
        pages.insert(page, Page { before, bytes: bytes.to_vec() });
        rest = left;
    }
    Some((before, wanted, pages))
}

fn write_over(file: &File, pages: &Pages, length: u64) -> io::Result<()> {
    pages.iter().try_for_each(|(number, page)| file.write_all_at(&page.bytes, number * PAGE))?;
    file.set_len(length)
}

fn read_or_zeros(file: &File, at: u64, bytes: &mut [u8]) -> io::Result<()> {
    let mut read = 0;
    while read < bytes.len() {
        match file.read_at(&mut bytes[read..], at + read as u64) {
            Ok(0) => break,
            Ok(count) => read += count,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    bytes[read..].fill(0);
    Ok(())
}

fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// FNV-1a: told from zeros, and from what was cut short.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of 10,000 bytes, of which some are written over and to which is appended; where it is, and as it should be.
    fn changed(folder: &Path) -> (Disk, Vec<u8>) {
        let path = folder.join("file");
        let mut expected: Vec<u8> = (0..10_000u32).map(|i| (i % 251) as u8).collect();
        fs::write(&path, &expected).unwrap();
        let mut disk = Disk::open(&path).unwrap();
        disk.wanted = 10_000;
        disk.begin();
        expected.resize(13_000, 0);
        for (at, length, byte) in [(4090, 20, 1), (9_990, 30, 2), (12_000, 1000, 3), (4100, 2, 4), (0, 1, 5)] {
            disk.write(at, &vec![byte; length]);
            expected[at as usize..at as usize + length].fill(byte);
        }
        disk.wanted = 13_000;
        let mut read = vec![9; 13_100];
        disk.read(0, &mut read);
        assert!(read[..13_000] == expected && read[13_000..] == [0; 100]);
        (disk, expected)
    }

    #[test]
    fn a_change_happens_as_a_whole() {
        let folder = tempfile::tempdir().unwrap();
        let [path, journal] = ["file", "file.journal"].map(|name| folder.path().join(name));
        let old: Vec<u8> = (0..10_000u32).map(|i| (i % 251) as u8).collect();
        // Nothing is seen of it before.
        let (disk, expected) = changed(folder.path());
        assert_eq!(fs::read(&path).unwrap()[..10_000], old);
        let record = disk.record();
        // Killed before the journal is complete: at each of its bytes it says nothing.
        for length in 0..record.len() {
            assert!(parse(&record[..length]).is_none());
        }
        fs::write(&journal, &record[..record.len() - 1]).unwrap();
        recover(&path, &journal).unwrap();
        assert!(!journal.exists());
        assert_eq!(fs::read(&path).unwrap()[..10_000], old);
        // And amid its pages.
        for done in 0..=disk.pages.len() {
            let (disk, _) = changed(folder.path());
            fs::write(&journal, &record).unwrap();
            let first = disk.pages.iter().take(done).map(|(n, p)| (*n, p.clone())).collect();
            write_over(&disk.file, &first, 20_000).unwrap();
            recover(&path, &journal).unwrap();
            assert!(fs::read(&path).unwrap() == expected && !journal.exists());
        }
        // Unharmed.
        let (mut disk, _) = changed(folder.path());
        disk.closed = true;
        disk.commit(Ok(()), &journal).unwrap();
        assert!(fs::read(&path).unwrap() == expected && !journal.exists());
    }

    #[test]
    fn what_is_given_up_has_not_happened() {
        let folder = tempfile::tempdir().unwrap();
        let (mut disk, _) = changed(folder.path());
        disk.give_up();
        disk.write(20_000, b"more");
        disk.closed = true;
        let journal = folder.path().join("file.journal");
        assert_eq!(disk.commit(Ok(()), &journal).unwrap_err().to_string(), "given up");
        let old: Vec<u8> = (0..10_000u32).map(|i| (i % 251) as u8).collect();
        assert!(fs::read(folder.path().join("file")).unwrap() == old && !journal.exists());
    }

    /// A journal that was left beside a file that is another by now.
    #[test]
    fn a_journal_of_another_file_says_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let [path, journal] = ["file", "file.journal"].map(|name| folder.path().join(name));
        let (disk, _) = changed(folder.path());
        for other in [b"short".to_vec(), vec![7; 20_000]] {
            fs::write(&journal, disk.record()).unwrap();
            fs::write(&path, &other).unwrap();
            recover(&path, &journal).unwrap();
            assert!(fs::read(&path).unwrap() == other && !journal.exists());
        }
    }
}

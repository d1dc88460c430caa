//! Atomic commits of a file that is changed in place (a redo journal).
//!
//! HDF5 updates its metadata (object headers, B-tree nodes, superblock) in place, write by write. A process killed
//! between two of these writes leaves metadata that match neither the old state nor the new one, and all frames can
//! become unreadable, however early they were flushed. Changes of bytes that existed at the latest commit are therefore
//! kept in memory until the next commit. A commit writes them to a journal next to the file (`.OUT.h5.journal`), then
//! to their places, and removes the journal. Bytes beyond the latest commit are written immediately: nothing refers to
//! them yet.
//!
//! After a kill the file is in the state of the latest commit, or a complete journal exists next to it and [`recover`]
//! finishes the commit. The operating system keeps what a killed process has written, so that nothing is synchronized
//! with the disk; a power failure is not covered.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Result, Write as _};
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};

/// Size of the blocks in which changes are stored, bytes.
const PAGE: u64 = 4096;

/// First bytes of a journal.
const START: &[u8] = b"barwave journal 1\n";

/// Size of the checksum (CRC-32) at the end of a journal, bytes.
const CHECKSUM: usize = 4;

/// Returns the path of the journal of a file.
fn journal_of(path: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".journal");
    path.with_file_name(name)
}

/// Finishes an interrupted commit, unless another process has locked the file.
pub(super) fn recover(path: &Path) {
    // The journal of a symbolic link is next to the target of the link.
    let Ok(path) = path.canonicalize() else { return };
    let journal = journal_of(&path);
    let Ok(bytes) = std::fs::read(&journal) else { return };
    let Ok(file) = OpenOptions::new().read(true).write(true).open(&path) else { return };
    if file.try_lock().is_err() {
        return;
    }
    let inode = file.metadata().map_or(0, |metadata| metadata.ino());
    let records = records(&bytes, inode).unwrap_or_default();
    let written = records.iter().all(|(at, bytes)| file.write_all_at(bytes, *at).is_ok());
    if written {
        // A journal that cannot be removed is applied again, with the same result.
        let _ = std::fs::remove_file(journal);
    }
    // Child processes forked meanwhile would keep a lock that is released only by closing.
    let _ = file.unlock();
}

/// Removes the journal of a file that was replaced.
pub(super) fn remove(path: &Path) {
    // The journal need not exist.
    let _ = std::fs::remove_file(journal_of(path));
}

/// Returns the offsets and bytes in a journal; `None` if it is incomplete, or belongs to another file that had the same name.
fn records(journal: &[u8], inode: u64) -> Option<Vec<(u64, &[u8])>> {
    let (content, sum) = journal.split_last_chunk::<CHECKSUM>()?;
    if u32::from_le_bytes(*sum) != crc32fast::hash(content) {
        return None;
    }
    let (of, mut rest) = content.strip_prefix(START)?.split_first_chunk()?;
    if u64::from_le_bytes(*of) != inode {
        return None;
    }
    let mut records = Vec::new();
    while !rest.is_empty() {
        let (at, after) = rest.split_first_chunk()?;
        let (length, after) = after.split_first_chunk()?;
        let (bytes, after) = after.split_at_checked(u64::from_le_bytes(*length) as usize)?;
        records.push((u64::from_le_bytes(*at), bytes));
        rest = after;
    }
    Some(records)
}

fn journal(inode: u64, changes: &[(u64, &[u8])]) -> Vec<u8> {
    let mut bytes = START.to_vec();
    bytes.extend(inode.to_le_bytes());
    for (at, change) in changes {
        bytes.extend(at.to_le_bytes());
        bytes.extend((change.len() as u64).to_le_bytes());
        bytes.extend_from_slice(change);
    }
    let sum = crc32fast::hash(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

/// Open file with atomic commits.
#[derive(Debug)]
pub(super) struct Journaled {
    file: File,
    journal: PathBuf,
    inode: u64,
    /// Length at the latest commit, bytes; bytes below it change only in commits.
    committed: u64,
    /// Pages below `committed` that have changed since the latest commit, by page number.
    pages: BTreeMap<u64, Vec<u8>>,
    /// Length of the file in use, bytes.
    end: u64,
}

impl Journaled {
    /// Opens an existing file.
    pub fn open(path: &Path) -> Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        let metadata = file.metadata()?;
        let (end, inode) = (metadata.len(), metadata.ino());
        Ok(Self { file, journal: journal_of(path), inode, committed: end, pages: BTreeMap::new(), end })
    }

    pub fn file(&self) -> &File {
        &self.file
    }

    /// Returns the length of the file in use, bytes.
    pub fn end(&self) -> u64 {
        self.end
    }

    /// Reads bytes from an offset; bytes beyond the end of the file are zero.
    pub fn read(&self, at: u64, bytes: &mut [u8]) -> Result<()> {
        read_zeros_beyond(&self.file, at, bytes)?;
        let end = (at + bytes.len() as u64).min(self.committed);
        for (page, from, to) in pages(at, end) {
            if let Some(changed) = self.pages.get(&page) {
                let part = &changed[(from - page * PAGE) as usize..(to - page * PAGE) as usize];
                bytes[(from - at) as usize..(to - at) as usize].copy_from_slice(part);
            }
        }
        Ok(())
    }

    /// Writes bytes at an offset.
    pub fn write(&mut self, at: u64, bytes: &[u8]) -> Result<()> {
        let end = at + bytes.len() as u64;
        let known = end.min(self.committed);
        for (page, from, to) in pages(at, known) {
            if !self.pages.contains_key(&page) {
                let mut before = vec![0; PAGE as usize];
                read_zeros_beyond(&self.file, page * PAGE, &mut before)?;
                self.pages.insert(page, before);
            }
            if let Some(changed) = self.pages.get_mut(&page) {
                let part = &mut changed[(from - page * PAGE) as usize..(to - page * PAGE) as usize];
                part.copy_from_slice(&bytes[(from - at) as usize..(to - at) as usize]);
            }
        }
        if end > known {
            let new = at.max(known);
            self.file.write_all_at(&bytes[(new - at) as usize..], new)?;
        }
        self.end = self.end.max(end);
        Ok(())
    }

    /// Sets the length in use. The file itself is never truncated, because the latest commit may refer to the bytes beyond.
    pub fn set_end(&mut self, end: u64) -> Result<()> {
        if self.file.metadata()?.len() < end {
            self.file.set_len(end)?;
        }
        self.end = end;
        Ok(())
    }

    /// Makes all changes permanent, atomically.
    pub fn commit(&mut self) -> Result<()> {
        let committed = self.committed;
        let known = |page: u64| (committed - page * PAGE).min(PAGE) as usize;
        let changes: Vec<(u64, &[u8])> =
            self.pages.iter().map(|(&page, bytes)| (page * PAGE, &bytes[..known(page)])).collect();
        if !changes.is_empty() {
            // A full disk has no space for a journal, but the changed pages are already allocated: they are then written without a journal.
            let kept = File::create(&self.journal).and_then(|mut file| file.write_all(&journal(self.inode, &changes)));
            // Pages that refer to other pages mostly precede them. If the pages are written from the end of the file, a
            // file that is cut off in between has few frames that refer to chunks without an entry, which programs that
            // do not know the journal would read as missing values.
            for (at, bytes) in changes.into_iter().rev() {
                self.file.write_all_at(bytes, at)?;
            }
            if kept.is_ok() {
                std::fs::remove_file(&self.journal)?;
            } else {
                let _ = std::fs::remove_file(&self.journal);
            }
        }
        self.pages.clear();
        self.committed = self.end;
        Ok(())
    }
}

/// Returns the pages that a range of bytes covers: number, first byte, and end within the range.
fn pages(from: u64, to: u64) -> impl Iterator<Item = (u64, u64, u64)> {
    let numbers = if from < to { from / PAGE..to.div_ceil(PAGE) } else { 0..0 };
    numbers.map(move |page| (page, from.max(page * PAGE), to.min((page + 1) * PAGE)))
}

fn read_zeros_beyond(file: &File, mut at: u64, mut bytes: &mut [u8]) -> Result<()> {
    while !bytes.is_empty() {
        match file.read_at(bytes, at) {
            Ok(0) => {
                bytes.fill(0);
                break;
            }
            Ok(n) => {
                (at, bytes) = (at + n as u64, &mut bytes[n..]);
            }
            Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates a file of slightly more than three pages, and opens it.
    fn file() -> (tempfile::TempDir, PathBuf, Vec<u8>, Journaled) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.h5");
        let bytes: Vec<u8> = (0..3 * PAGE + 100).map(|i| (i % 251) as u8).collect();
        std::fs::write(&path, &bytes).expect("written");
        let opened = Journaled::open(&path).expect("it opens");
        (folder, path, bytes, opened)
    }

    fn read(path: &Path) -> Vec<u8> {
        std::fs::read(path).expect("a file")
    }

    #[test]
    fn changes_are_seen_at_once_and_made_by_the_commit() {
        let (folder, path, old, mut file) = file();
        let mut new = old.clone();
        // Inside a page, across two pages, across the end of the file, and beyond it.
        for (at, count) in [(10, 20), (PAGE - 5, 10), (3 * PAGE + 90, 50), (4 * PAGE + 3, 7)] {
            file.write(at, &vec![9; count]).expect("written");
            let (at, end) = (at as usize, at as usize + count);
            new.resize(new.len().max(end), 0);
            new[at..end].fill(9);
            let mut seen = vec![1; new.len()];
            file.read(0, &mut seen).expect("read");
            assert_eq!(seen, new);
            assert_eq!(read(&path)[..old.len()], old);
        }
        assert_eq!(file.end(), new.len() as u64);
        file.commit().expect("committed");
        assert_eq!(read(&path), new);
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "no journal is left");
    }

    #[test]
    fn a_commit_that_was_cut_off_anywhere_is_finished_or_never_began() {
        let (_folder, path, old, mut file) = file();
        file.write(0, b"first").expect("written");
        file.write(2 * PAGE + 7, b"second").expect("written");
        let changes: Vec<(u64, &[u8])> = file.pages.iter().map(|(page, bytes)| (page * PAGE, &bytes[..])).collect();
        let whole = journal(file.inode, &changes);
        let mut new = old.clone();
        new[..5].copy_from_slice(b"first");
        new[2 * PAGE as usize + 7..][..6].copy_from_slice(b"second");
        drop(file);
        for cut in (0..whole.len()).step_by(97) {
            std::fs::write(journal_of(&path), &whole[..cut]).expect("written");
            recover(&path);
            assert!(read(&path) == old && !journal_of(&path).exists(), "{cut} bytes");
        }
        std::fs::write(journal_of(&path), &whole).expect("written");
        // The first change is complete, and half of the second.
        std::fs::write(&path, [&new[..2 * PAGE as usize + 9], &old[2 * PAGE as usize + 9..]].concat())
            .expect("written");
        recover(&path);
        assert!(read(&path) == new && !journal_of(&path).exists());
        // The journal does not apply to another file that replaced this one.
        let other = path.with_extension("new");
        std::fs::write(&other, &old).expect("written");
        std::fs::rename(&other, &path).expect("moved");
        std::fs::write(journal_of(&path), &whole).expect("written");
        recover(&path);
        assert!(read(&path) == old && !journal_of(&path).exists());
    }

    #[test]
    fn a_file_that_is_being_written_is_left_alone() {
        let (_folder, path, old, file) = file();
        file.file().try_lock().expect("nobody else has it");
        std::fs::write(journal_of(&path), journal(file.inode, &[(0, b"other")])).expect("written");
        recover(&path);
        assert!(read(&path) == old && journal_of(&path).exists());
        drop(file);
        recover(&path);
        assert_eq!(read(&path)[..5], *b"other");
    }
}

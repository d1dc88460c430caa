//! Check of the global heaps in which an HDF5 file stores its texts. A free object of size 0, as damage can produce it,
//! puts the library into an endless loop, so that the heaps are checked first.

use std::fs::File;
use std::io::{Read as _, Result, Seek as _, SeekFrom};
use std::path::Path;

use memchr::memmem;

/// Start of a global heap: its signature, its version, and zeros.
const SIGNATURE: &[u8] = b"GCOL\x01\0\0\0";
/// Number of bytes before the first object of a heap, and before the data of an object.
const HEADER: usize = 16;
/// Alignment of objects, bytes.
const ALIGN: usize = 8;
/// Number of bytes that are searched at each end of a file: texts are written at the start and at the end of a run.
const SEARCHED: u64 = 16 << 20;

/// Returns true if every heap found in a file has an end.
///
/// # Errors
/// An error if the file cannot be read.
pub(super) fn have_ends(path: &Path) -> Result<bool> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut part = Vec::with_capacity(usize::try_from(length.min(SEARCHED)).unwrap_or_default());
    for start in [0, length.saturating_sub(SEARCHED).max(SEARCHED)] {
        part.clear();
        file.seek(SeekFrom::Start(start))?;
        (&mut file).take(SEARCHED).read_to_end(&mut part)?;
        if !memmem::find_iter(&part, SIGNATURE).all(|at| has_end(&part[at..])) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Returns true if each object of the heap at the start of these bytes has a positive size.
fn has_end(heap: &[u8]) -> bool {
    let number = |at: usize| {
        let bytes = heap.get(at..at + 8).and_then(|bytes| bytes.try_into().ok());
        bytes.and_then(|bytes| usize::try_from(u64::from_le_bytes(bytes)).ok())
    };
    let Some(end) = number(ALIGN).map(|size| size.min(heap.len())) else { return true };
    let mut at = HEADER;
    while at.saturating_add(HEADER) <= end {
        let is_free = heap[at] == 0 && heap[at + 1] == 0;
        let size = number(at + ALIGN);
        let taken = match size {
            // The size of a free object includes its header, and is not padded.
            Some(size) if is_free => Some(size),
            Some(size) => size.checked_next_multiple_of(ALIGN).and_then(|size| size.checked_add(HEADER)),
            None => None,
        };
        match taken {
            None | Some(0) => return false,
            Some(taken) => at = at.saturating_add(taken),
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A heap of 4 KiB with a text of 5 bytes, and free space.
    fn heap(free: u64) -> Vec<u8> {
        let mut heap = SIGNATURE.to_vec();
        heap.extend(4096_u64.to_le_bytes());
        heap.extend([1, 0, 1, 0, 0, 0, 0, 0]);
        heap.extend(5_u64.to_le_bytes());
        heap.extend(b"steel\0\0\0");
        heap.extend([0; 8]);
        heap.extend(free.to_le_bytes());
        heap.resize(4096, 0);
        heap
    }

    #[test]
    fn a_free_object_without_a_size_has_no_end() {
        assert!(has_end(&heap(4096 - 40)));
        assert!(!has_end(&heap(0)));
        // Objects that extend beyond the heap are detected by the library.
        assert!(has_end(&heap(u64::MAX)) && has_end(&heap(0)[..50]) && has_end(SIGNATURE));
    }
}

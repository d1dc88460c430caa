//! Arrays aligned to cache lines, so that vector loads do not cross lines and step times do not depend on the allocation.

use aligned_vec::{AVec, ConstAlign};

/// Size of a cache line and of the widest register, bytes.
const LINE: usize = 64;

/// A heap-allocated row of cells, aligned to cache lines.
pub type AlignedRow = AVec<f64, ConstAlign<LINE>>;

/// Returns a row of `cells` cells, all with the same value.
pub fn aligned_row(cells: usize, value: f64) -> AlignedRow {
    AlignedRow::from_iter(LINE, std::iter::repeat_n(value, cells))
}

/// Removes the cells from index `at` on and returns them as a row of their own.
pub fn split_off(row: &mut AlignedRow, at: usize) -> AlignedRow {
    let taken = AlignedRow::from_slice(LINE, &row[at..]);
    row.truncate(at);
    taken
}

/// A value stored in place, aligned to a cache line.
#[derive(Debug)]
#[repr(align(64))]
pub struct Aligned<T>(pub T);

#[cfg(test)]
mod tests {
    use super::*;

    fn begins_on_a_line<T>(values: &[T]) -> bool {
        (values.as_ptr() as usize).is_multiple_of(LINE)
    }

    #[test]
    fn rows_begin_on_lines_and_keep_their_values() {
        for cells in [1, 7, 64, 257] {
            let mut row = aligned_row(cells, 3.0);
            row.push(4.0);
            let rest = split_off(&mut row, cells);
            assert!(begins_on_a_line(&row) && begins_on_a_line(&rest) && begins_on_a_line(&row.clone()));
            assert_eq!((&row[..], &rest[..]), (&vec![3.0; cells][..], &[4.0][..]));
            assert!(begins_on_a_line(&Aligned([0_u8; 3]).0));
        }
    }
}

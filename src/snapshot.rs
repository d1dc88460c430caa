//! Bitwise saving and restoring of state, for checkpoints.
//!
//! An object is first rebuilt from the scene; then [`Snapshot::restore`] sets the state that changes from step to step.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Result of packing and unpacking. Unpacking bytes that [`pack`] wrote for the same type always succeeds.
pub type Result<T> = postcard::Result<T>;

/// An object with a state that changes from step to step.
pub trait Snapshot {
    /// Returns the state.
    ///
    /// # Errors
    /// None is known.
    fn save(&self) -> Result<Vec<u8>>;

    /// Restores the state of an object that was built from the same scene.
    ///
    /// # Errors
    /// The bytes were not returned by [`Self::save`].
    fn restore(&mut self, saved: &[u8]) -> Result<()>;
}

/// Serializes a value. Floating-point numbers keep their bits, including -0 and NaN payloads.
///
/// # Errors
/// None is known.
pub fn pack(value: &impl Serialize) -> Result<Vec<u8>> {
    postcard::to_stdvec(value)
}

/// Deserializes a value from all bytes.
///
/// # Errors
/// The bytes are those of another type, or some remain.
pub fn unpack<T: DeserializeOwned>(bytes: &[u8]) -> Result<T> {
    match postcard::take_from_bytes(bytes)? {
        (value, []) => Ok(value),
        _ => Err(postcard::Error::DeserializeBadEncoding),
    }
}

/// Concatenates states, each preceded by its length.
pub fn join(parts: &[Vec<u8>]) -> Vec<u8> {
    let mut all = Vec::with_capacity(parts.iter().map(|part| size_of::<u64>() + part.len()).sum());
    for part in parts {
        all.extend((part.len() as u64).to_le_bytes());
        all.extend_from_slice(part);
    }
    all
}

/// Splits the concatenation that [`join`] returned.
///
/// # Errors
/// The number of states is different.
pub fn split<const N: usize>(mut all: &[u8]) -> Result<[&[u8]; N]> {
    let mut parts = [&[][..]; N];
    for part in &mut parts {
        let (length, rest) = all.split_first_chunk().ok_or(postcard::Error::DeserializeUnexpectedEnd)?;
        let length = u64::from_le_bytes(*length) as usize;
        (*part, all) = rest.split_at_checked(length).ok_or(postcard::Error::DeserializeUnexpectedEnd)?;
    }
    if all.is_empty() { Ok(parts) } else { Err(postcard::Error::DeserializeBadEncoding) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_bits() {
        let quiet = f64::from_bits(0x7FF8_0000_0000_1234);
        let numbers = vec![0.0, -0.0, f64::NAN, -f64::NAN, quiet, f64::INFINITY, f64::MIN_POSITIVE / 8.0, 1.0 / 3.0];
        let back: Vec<f64> = unpack(&pack(&numbers).expect("packed")).expect("unpacked");
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&numbers));
        assert_eq!(unpack::<usize>(&pack(&usize::MAX).expect("packed")), Ok(usize::MAX));
    }

    #[test]
    fn joined_states_are_split_again() {
        let parts = [vec![1, 2], vec![], vec![3]];
        let all = join(&parts);
        assert_eq!(split::<3>(&all).expect("three"), [&[1, 2][..], &[], &[3]]);
        assert!(split::<2>(&all).is_err() && split::<4>(&all).is_err() && split::<3>(&all[..all.len() - 1]).is_err());
    }

    #[test]
    fn bytes_that_are_left_over_are_refused() {
        let mut bytes = pack(&(1_u32, 2.0_f64)).expect("packed");
        bytes.push(0);
        assert!(unpack::<(u32, f64)>(&bytes).is_err());
        assert!(unpack::<(u32, f64)>(&bytes[..5]).is_err());
    }
}

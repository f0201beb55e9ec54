//! Long work vectors that are kept for the next use. Up to some length an allocator keeps freed memory itself; beyond
//! it the system clears every page at each use, and that takes longer than the work on it.

use std::sync::Mutex;

use crate::watch::locked;

/// Bytes of a vector that is kept: the largest that the allocator of glibc keeps itself (`DEFAULT_MMAP_THRESHOLD_MAX`).
const LEAST_BYTES: usize = 32 << 20;

/// Long vectors that nobody uses at the moment.
#[derive(Debug, Default)]
pub struct Spare<T> {
    vectors: Mutex<Vec<Vec<T>>>,
}

impl<T: Copy + Default> Spare<T> {
    /// A vector of this length, with any values.
    pub fn take(&self, length: usize) -> Vec<T> {
        let mut vectors = locked(&self.vectors);
        match vectors.iter().position(|vector| vector.len() == length) {
            Some(place) => vectors.swap_remove(place),
            None => vec![T::default(); length],
        }
    }

    /// A vector of zeros of this length.
    pub fn zeros(&self, length: usize) -> Vec<T> {
        let mut vector = self.take(length);
        vector.fill(T::default());
        vector
    }

    /// A copy of `values`.
    pub fn copy(&self, values: &[T]) -> Vec<T> {
        let mut vector = self.take(values.len());
        vector.copy_from_slice(values);
        vector
    }

    /// Keeps a long vector for the next use of its length.
    pub fn give(&self, vector: Vec<T>) {
        if size_of_val(&vector[..]) > LEAST_BYTES {
            locked(&self.vectors).push(vector);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_vectors_come_back_and_zeros_are_zeros_again() {
        let (spare, long) = (Spare::<f64>::default(), LEAST_BYTES / 8 + 1);
        let mut vector = spare.zeros(long);
        let place = vector.as_ptr();
        vector.fill(3.0);
        spare.give(vector);
        spare.give(vec![3.0; 10]);
        assert!(spare.take(long - 1) == vec![0.0; long - 1] && spare.take(10) == [0.0; 10]);
        let again = spare.zeros(long);
        assert!(again.as_ptr() == place && again.iter().all(|&value| value == 0.0));
        assert_eq!(spare.copy(&[1.0, 2.0]), [1.0, 2.0]);
    }
}

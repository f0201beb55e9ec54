//! Work vectors that are kept for the next use: the system clears each page of new memory, and that takes longer than the work on it.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Vectors that nobody uses at the moment.
#[derive(Debug, Default)]
pub struct Spare<T> {
    vectors: Mutex<Vec<Vec<T>>>,
}

impl<T: Copy + Default> Spare<T> {
    /// A vector of this length, with the values of its last use.
    pub fn take(&self, length: usize) -> Vec<T> {
        let mut vectors = self.vectors();
        match vectors.iter().position(|vector| vector.len() == length) {
            Some(place) => vectors.swap_remove(place),
            None => vec![T::default(); length],
        }
    }

    /// A vector of zeros.
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

    /// Keeps a vector for the next use of its length.
    pub fn give(&self, vector: Vec<T>) {
        self.vectors().push(vector);
    }

    fn vectors(&self) -> MutexGuard<'_, Vec<Vec<T>>> {
        self.vectors.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

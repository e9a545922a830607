//! Buffers that a task needs for itself, kept between iterations so that none of them allocates.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// One buffer a thread.
#[derive(Debug)]
pub struct Scratch<T> {
    buffers: Vec<Mutex<Vec<T>>>,
}

impl<T: Clone + Default> Scratch<T> {
    /// Buffers of `len` elements for as many threads as there are.
    #[must_use]
    pub fn new(len: usize) -> Self {
        // One more for a caller that is not one of the pool's threads.
        let buffers = (0..=crate::parallel::threads()).map(|_| Mutex::new(vec![T::default(); len])).collect();
        Self { buffers }
    }

    /// This thread's buffer. Its contents are whatever the last user left.
    pub fn mine(&self) -> MutexGuard<'_, Vec<T>> {
        #[cfg(not(target_arch = "wasm32"))]
        let thread = rayon::current_thread_index().unwrap_or(self.buffers.len() - 1);
        #[cfg(target_arch = "wasm32")]
        let thread = 0;
        // The contents are scratch: a panic elsewhere can't have made them wrong.
        self.buffers[thread % self.buffers.len()].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.buffers.iter().map(|buffer| buffer.lock().map_or(0, |b| b.len() * size_of::<T>())).sum()
    }
}

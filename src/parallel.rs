//! Work over disjoint chunks: on all threads natively, one after the other in wasm.
//!
//! The chunks are fixed by the problem, never by the number of threads, and every sum over chunks is taken in their
//! order: that is what makes results independent of the thread count.

#[cfg(not(target_arch = "wasm32"))]
use rayon::prelude::*;

/// Calls `work(index, chunk)` for every chunk of `len` elements (the last may be shorter).
pub(crate) fn for_each_chunk<T: Send>(data: &mut [T], len: usize, work: impl Fn(usize, &mut [T]) + Sync + Send) {
    #[cfg(not(target_arch = "wasm32"))]
    data.par_chunks_mut(len).enumerate().for_each(|(index, chunk)| work(index, chunk));
    #[cfg(target_arch = "wasm32")]
    data.chunks_mut(len).enumerate().for_each(|(index, chunk)| work(index, chunk));
}

/// Calls `work(index, chunk of a, chunk of b)` for the chunks of two lists, in step.
pub(crate) fn for_each_chunk_pair<A: Send, B: Send>(
    a: &mut [A],
    a_len: usize,
    b: &mut [B],
    b_len: usize,
    work: impl Fn(usize, &mut [A], &mut [B]) + Sync + Send,
) {
    #[cfg(not(target_arch = "wasm32"))]
    a.par_chunks_mut(a_len).zip(b.par_chunks_mut(b_len)).enumerate().for_each(|(index, (a, b))| work(index, a, b));
    #[cfg(target_arch = "wasm32")]
    a.chunks_mut(a_len).zip(b.chunks_mut(b_len)).enumerate().for_each(|(index, (a, b))| work(index, a, b));
}

/// How many threads the chunks are spread over.
#[must_use]
pub(crate) fn threads() -> usize {
    #[cfg(not(target_arch = "wasm32"))]
    return rayon::current_num_threads();
    #[cfg(target_arch = "wasm32")]
    return 1;
}

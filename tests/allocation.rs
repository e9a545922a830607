//! Once a scale is under way, an iteration allocates no buffer.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use pointweave::methods::network::{NetworkRun, Parameters, Preset};
use pointweave::run::Event;
use pointweave::{Boundary, gallery};

/// Allocations of at least this many bytes are buffers; the thread pool's own bookkeeping is smaller.
const BUFFER: usize = 4096;

static BUFFERS: AtomicUsize = AtomicUsize::new(0);

struct Counting;

#[expect(unsafe_code, reason = "an allocator that counts has to pass on to the system's")]
// SAFETY: every call is passed on unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if layout.size() >= BUFFER {
            BUFFERS.fetch_add(1, Ordering::Relaxed);
        }
        // SAFETY: the caller's promise is the system allocator's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn an_iteration_allocates_no_buffer() {
    for boundary in [Boundary::Open, Boundary::Periodic] {
        let parameters = Parameters {
            boundary,
            channels: 12,
            grid_min: 40,
            grid_max: 48,
            scales: 1,
            ..Parameters::preset(Preset::Fast)
        };
        let mut run = NetworkRun::new(gallery::find("rings").unwrap().exemplar(), parameters, 4_000_000_000).unwrap();
        run.run(2).unwrap();
        let before = BUFFERS.load(Ordering::Relaxed);
        run.run(5).unwrap();
        assert_eq!(BUFFERS.load(Ordering::Relaxed), before, "{boundary:?}");
        // Negative control: beginning a scale does allocate.
        let mut other = NetworkRun::resume(run.state(), 4_000_000_000).unwrap();
        assert!(matches!(other.advance().unwrap(), Event::ScaleStarted { .. }));
        assert!(BUFFERS.load(Ordering::Relaxed) > before);
    }
}

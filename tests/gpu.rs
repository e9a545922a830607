//! The GPU engine computes what the CPU engine computes, on whatever adapter there is; no adapter is a failure.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail loudly")]

use std::sync::Arc;

use pointweave::Boundary;
use pointweave::engine::gpu::probe::{Case, Deviation, compare, probe};
use pointweave::engine::gpu::{Gpu, OpenOptions, Shader};

fn open() -> Arc<Gpu> {
    pollster::block_on(Gpu::open(OpenOptions::default())).expect("these tests need a Vulkan adapter; lavapipe will do")
}

fn deviations(gpu: &Arc<Gpu>, case: Case) -> Vec<Deviation> {
    let found = pollster::block_on(compare(gpu, case)).unwrap();
    for deviation in &found {
        println!("{case:?} {deviation:?}");
    }
    found
}

#[test]
fn every_stage_matches_its_twin() {
    let gpu = open();
    println!("{:?}", gpu.info());
    for boundary in [Boundary::Open, Boundary::Periodic] {
        for deviation in deviations(&gpu, Case::small(boundary)) {
            assert!(deviation.is_fine(), "{boundary:?}: {deviation:?}");
        }
    }
}

//! A step in the steady state asks the system for no memory: buffers are kept.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use decomp::Serial;
use flyer_mpm::input;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

/// Counts what is asked for.
struct Counting;

static ASKED: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is handed to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ASKED.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ASKED.fetch_add(1, Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Memory asked for in each of some windows of `steps` steps of a scene, one after the other.
fn asked(value: &Value, steps: usize, windows: usize) -> Vec<u64> {
    let checked = input::parse(value.to_string().as_bytes(), "test.json", &[]).unwrap();
    let mut simulation = Simulation::<1>::new(&checked, &Serial, 1).unwrap();
    let end = checked.scene.time.end;
    let mut asked = Vec::with_capacity(windows);
    for _ in 0..windows {
        let before = ASKED.load(Ordering::Relaxed);
        (0..steps).for_each(|_| simulation.advance(end).unwrap());
        asked.push(ASKED.load(Ordering::Relaxed) - before);
    }
    asked
}

#[test]
fn steps_ask_for_no_memory() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        let path = format!("{}/inputs/{name}", env!("CARGO_MANIFEST_DIR"));
        let mut value: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
        value["domain"]["patches"] = json!([7]);
        // steps alone: what the monitor looks at now and then are sums over all ranks
        value["monitor"] = json!({"interval": 1_000_000});
        // as particles crowd into a patch or first pass into another, its buffers grow, once
        let asked = asked(&value, 200, 6);
        assert!(asked[1..].contains(&0), "{name}: {asked:?}");
        assert!(asked[1..].iter().all(|&n| n < 20), "{name}: {asked:?}");
    }
}

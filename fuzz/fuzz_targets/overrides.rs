//! Whatever is overridden in a scene, the verdict is a scene or a line for each fault.
#![no_main]

use flyer_mpm::input;
use libfuzzer_sys::fuzz_target;

const SCENE: &[u8] = include_bytes!("../../inputs/flyer.json");

fuzz_target!(|set: String| {
    let sets = [set];
    if input::check_size(SCENE, "flyer.json", &sets, Some(64 << 20)).is_err() {
        return;
    }
    if let Err(error) = input::parse(SCENE, "flyer.json", &sets) {
        // one line, or a line for each of several faults
        let text = error.to_string();
        assert!(text.lines().skip(1).all(|line| line.starts_with("  ")), "{error}");
    }
});

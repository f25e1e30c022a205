//! Whatever is overridden in a scene, the verdict is a scene or one line.
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
        assert_eq!(error.to_string().lines().count(), 1, "{error}");
    }
});

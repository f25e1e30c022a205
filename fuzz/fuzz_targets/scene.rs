//! Whatever stands in a scene's file, the verdict is a scene or a line for each fault.
#![no_main]

use flyer_mpm::input;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // the particles at the borders of bodies are made as they are read
    if input::check_size(bytes, "scene.json", &[], Some(64 << 20)).is_err() {
        return;
    }
    if let Err(error) = input::parse(bytes, "scene.json", &[]) {
        // one line, or a line for each of several faults
        let text = error.to_string();
        assert!(text.lines().skip(1).all(|line| line.starts_with("  ")), "{error}");
    }
});

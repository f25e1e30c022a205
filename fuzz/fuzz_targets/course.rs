//! Whatever stands in the file of a pressure or a velocity, it is read or refused in words.
#![no_main]

use flyer_mpm::scene::Course;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match Course::read(text, "pressure") {
        Ok(points) => assert!(points.as_flattened().iter().all(|v| v.is_finite())),
        Err(reason) => assert_eq!(reason.lines().count(), 1, "{reason}"),
    }
});

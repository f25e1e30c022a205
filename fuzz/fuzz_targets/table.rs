//! Whatever stands in a table of an equation of state, it is a table or refused in words.
#![no_main]

use flyer_mpm::material::Table;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Err(reason) = Table::read(text) {
        assert_eq!(reason.lines().count(), 1, "{reason}");
    }
});

//! No text and no override makes it panic.

use flyer_mpm::input::parse;
use proptest::prelude::*;

use super::{is_clear, shipped};

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Whatever stands in the file, the verdict is a scene or a line for each fault, and no panic.
    #[test]
    fn any_change_of_a_byte_gives_a_verdict(at in 0usize..10_000, byte: u8, cut: bool) {
        let mut bytes = shipped("flyer.json");
        let at = at % bytes.len();
        if cut { bytes.truncate(at) } else { bytes[at] = byte }
        if let Err(error) = parse(&bytes, "flyer.json", &[]) {
            prop_assert!(is_clear(&error.to_string()), "{error}");
        }
    }

    #[test]
    fn any_override_gives_a_verdict(
        set in "(bodies|time|domain|[a-z]{0,3})[.\\[\\]a-z0-9=\"-]{0,20}=.{0,10}",
    ) {
        if let Err(error) = parse(&shipped("flyer.json"), "flyer.json", &[set]) {
            prop_assert!(is_clear(&error.to_string()), "{error}");
        }
    }
}

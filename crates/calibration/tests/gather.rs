//! Random impacts run side by side.

use calibration::estimates::gather;
use calibration::random_impacts::{Draw, FITTED};
use calibration::random_schemes::Schemes;

#[test]
fn threads_change_neither_order_nor_values_of_the_estimates() {
    let draw = Draw { library: &FITTED, invented: 0.5, schemes: Schemes::Default, beyond: false };
    let [one, two] = [1, 2].map(|threads| gather(7, &draw, 4, threads));
    assert_eq!((one.failed, two.failed), (0, 0));
    assert!(one.estimates.iter().all(|all| !all.is_empty()));
    let text = |all| serde_json::to_string(all).unwrap();
    assert_eq!(text(&one), text(&two));
}

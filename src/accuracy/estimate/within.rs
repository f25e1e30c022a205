//! Comparison of a number of a scene with the range of the fit.

/// A line that names `what` if `value` is outside of `range`.
pub(super) fn check(what: impl Into<String>, value: f64, range: [f64; 2]) -> Option<String> {
    let [least, greatest] = range;
    let shown = (value * 1e6).round() / 1e6;
    let text = || format!("{} = {shown}: fitted from {least} to {greatest}", what.into());
    (!within(value, range)).then(text)
}

fn within(value: f64, [least, greatest]: [f64; 2]) -> bool {
    // sizes in cells are quotients with rounding errors
    (least * (1.0 - 1e-9)..=greatest * (1.0 + 1e-9)).contains(&value)
}

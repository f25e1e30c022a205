//! Warning of a body that touches itself.

use serde::{Deserialize, Serialize};

/// First contact of a body with itself in a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SelfContactEvent {
    /// Time of the check that found it [s].
    pub time: f64,
    /// Index of the body.
    pub body: usize,
    /// Position [m]; y is 0 on a line.
    pub place: [f64; 2],
    /// Width of the gap between the surfaces [cells], negative if they overlap.
    pub gap: f64,
}

impl SelfContactEvent {
    /// Warning at the end of a run, with the name of the body.
    pub fn warning(&self, body: &str) -> String {
        let [x, y] = self.place;
        format!(
            "two surfaces of {body} approach each other over a gap of {:.2} cells at x = {x:.4e} m, \
             y = {y:.4e} m, found at {:.4e} s. A body has no contact with itself: its surfaces \
             stick together at a distance of a cell, without sliding or parting. If they meet \
             there, make them surfaces of two bodies",
            self.gap, self.time
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_warning_names_body_place_and_time() {
        let event = SelfContactEvent { time: 2e-6, body: 1, place: [0.5, -0.25], gap: 0.375 };
        let text = event.warning("ring");
        for part in ["ring", "x = 5.0000e-1 m", "y = -2.5000e-1 m", "2.0000e-6 s", "0.38 cells"] {
            assert!(text.contains(part), "{text}");
        }
    }
}

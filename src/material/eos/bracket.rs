//! Newton's method within a bracket.

/// Largest number of steps; the search then ends with its current value.
pub(super) const MOST_STEPS: usize = 80;

/// Interval that contains the root of an increasing function.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracket {
    /// Lower and upper end, in the unit of the argument; infinite if unknown.
    pub ends: [f64; 2],
}

impl Bracket {
    /// The next argument after `at`, where the function has the value `rest` and the derivative
    /// `slope`: that of Newton's method, or the middle if that one leaves the bracket.
    #[inline(always)]
    pub fn next(&mut self, at: f64, rest: f64, slope: f64) -> f64 {
        self.ends[usize::from(rest > 0.0)] = at;
        let [below, above] = self.ends;
        let step = at - rest / slope;
        if step > below && step < above {
            step
        } else if below.is_finite() && above.is_finite() {
            0.5 * (below + above)
        } else {
            // the slope has the wrong sign: move away from the current point
            at - rest
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_out_of_the_bracket_halves_it() {
        let mut bracket = Bracket { ends: [0.0, 8.0] };
        assert_eq!(bracket.next(4.0, 1.0, 0.5), 2.0);
        // Newton's step to -6 leaves the bracket from 0 to 2
        assert_eq!(bracket.next(2.0, 1.0, 0.125), 1.0);
        assert_eq!(bracket.next(1.0, -1.0, 0.125), 1.5);
        assert_eq!(bracket.ends, [1.0, 2.0]);
        // without an upper end a falling slope is not followed
        let mut open = Bracket { ends: [f64::NEG_INFINITY, f64::INFINITY] };
        assert_eq!(open.next(3.0, -2.0, 0.0), 5.0);
    }
}

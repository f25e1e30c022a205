//! Colour scales: a colour for each number between 0 and 1.

use super::color::Color;

/// A colour scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shades {
    /// From dark to bright, perceptually uniform.
    Sequential,
    /// From blue over light gray (middle) to red.
    Diverging,
}

impl Shades {
    /// The colour at a fraction from 0 to 1; values beyond are clamped.
    #[inline]
    pub fn color(self, fraction: f64) -> Color {
        let colors = match self {
            Shades::Sequential => &VIRIDIS,
            Shades::Diverging => &COOL_WARM,
        };
        let place = fraction.clamp(0.0, 1.0) * (colors.len() - 1) as f64;
        let below = (place as usize).min(colors.len() - 2);
        colors[below].mix(colors[below + 1], place - below as f64)
    }
}

/// The colour map "viridis" (van der Walt and Smith 2015, CC0), perceptually uniform: every 1/16.
const VIRIDIS: [Color; 17] = [
    Color(68, 1, 84),
    Color(72, 24, 106),
    Color(71, 45, 123),
    Color(66, 64, 134),
    Color(59, 82, 139),
    Color(51, 99, 141),
    Color(44, 114, 142),
    Color(38, 130, 142),
    Color(33, 145, 140),
    Color(31, 160, 136),
    Color(40, 174, 128),
    Color(63, 188, 115),
    Color(94, 201, 98),
    Color(132, 212, 75),
    Color(173, 220, 48),
    Color(216, 226, 25),
    Color(253, 231, 37),
];

/// The diverging colour map of Moreland (2009, Diverging color maps for scientific visualization):
/// every 1/16.
const COOL_WARM: [Color; 17] = [
    Color(59, 76, 192),
    Color(78, 104, 215),
    Color(98, 130, 234),
    Color(119, 154, 247),
    Color(141, 176, 254),
    Color(163, 194, 255),
    Color(184, 208, 249),
    Color(204, 217, 238),
    Color(221, 221, 221),
    Color(236, 211, 198),
    Color(245, 196, 173),
    Color(247, 177, 148),
    Color(244, 154, 123),
    Color(236, 127, 99),
    Color(222, 97, 76),
    Color(203, 62, 56),
    Color(180, 4, 38),
];

/// The lowest colour of the sequential scale.
pub(super) const DARKEST: Color = VIRIDIS[0];

#[cfg(test)]
mod tests {
    use super::*;

    fn light(c: Color) -> f64 {
        0.21 * f64::from(c.0) + 0.72 * f64::from(c.1) + 0.07 * f64::from(c.2)
    }

    fn lights(shades: Shades) -> Vec<f64> {
        (0..=64).map(|i| light(shades.color(f64::from(i) / 64.0))).collect()
    }

    #[test]
    fn sequential_goes_from_dark_to_bright() {
        assert!(lights(Shades::Sequential).windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn diverging_is_lightest_and_gray_in_the_middle() {
        let lights = lights(Shades::Diverging);
        assert!(lights[..=32].windows(2).all(|pair| pair[0] < pair[1]));
        assert!(lights[32..].windows(2).all(|pair| pair[0] > pair[1]));
        assert_eq!(Shades::Diverging.color(0.5), Color(221, 221, 221));
        let (cold, warm) = (Shades::Diverging.color(-1.0), Shades::Diverging.color(2.0));
        assert!(cold.2 > 180 && cold.0 < 80 && warm.0 > 170 && warm.2 < 60);
    }
}

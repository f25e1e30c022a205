//! Colours: those of Burghardt (2010) for its materials and curves, and a palette for all others.

/// An RGB colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

impl Color {
    /// Black: the shock approximation of Burghardt (2010).
    pub const BLACK: Color = Color(0x11, 0x11, 0x11);
    /// White.
    pub const WHITE: Color = Color(0xff, 0xff, 0xff);
    /// Green: the computed points of Burghardt (2010).
    pub const GREEN: Color = Color(0x35, 0xb0, 0x4c);
    /// Red: the exact solution.
    pub const RED: Color = Color(0xd8, 0x10, 0x40);
    /// Orange: copper in Burghardt (2010).
    pub const ORANGE: Color = Color(0xe0, 0x7b, 0x1e);
    /// Gray: aluminium in Burghardt (2010).
    pub const GRAY: Color = Color(0x80, 0x88, 0x90);

    /// Colours that red-green colour-blind readers can distinguish (after Okabe and Ito, darkened
    /// for thin lines).
    const PALETTE: [Color; 7] = [
        Color(0x1f, 0x6f, 0xb4),
        Color(0xd5, 0x5e, 0x00),
        Color(0x00, 0x96, 0x6c),
        Color(0x9b, 0x4f, 0x96),
        Color(0xb0, 0x86, 0x00),
        Color(0x2f, 0xa5, 0xd8),
        Color(0x6b, 0x4f, 0x3a),
    ];

    /// The colour number `index` of the palette, which repeats.
    pub fn palette(index: usize) -> Color {
        Self::PALETTE[index % Self::PALETTE.len()]
    }

    /// The colour of a material: as in Burghardt (2010) for copper (orange) and aluminium (gray),
    /// else the palette colour number `index`.
    pub fn of_material(name: &str, index: usize) -> Color {
        let name = name.to_lowercase();
        if name.starts_with("copper") || name == "cu" {
            Color::ORANGE
        } else if name.starts_with("alumin") || name == "al" {
            Color::GRAY
        } else {
            Color::palette(index)
        }
    }

    /// One colour per material, in the order of `names`; equal names have equal colours. The first
    /// copper is orange and the first aluminium gray, as in Burghardt (2010); all others take the
    /// palette in turn. Red-green colour-blind readers can distinguish the first five of these, orange
    /// and gray; the colours repeat after seven.
    pub fn of_materials(names: &[&str]) -> Vec<Color> {
        const TURN: [usize; 7] = [0, 2, 5, 6, 1, 4, 3];
        let mut taken: Vec<(&str, Color)> = Vec::new();
        let mut next = 0;
        for name in names {
            if taken.iter().any(|(known, _)| known == name) {
                continue;
            }
            let own = [Color::ORANGE, Color::GRAY].into_iter().find(|color| {
                Color::of_material(name, 0) == *color && taken.iter().all(|(_, c)| c != color)
            });
            let color = own.unwrap_or_else(|| {
                next += 1;
                Color::palette(TURN[(next - 1) % TURN.len()])
            });
            taken.push((name, color));
        }
        let color = |name: &&str| taken.iter().find(|(known, _)| known == name).map(|(_, c)| *c);
        names.iter().filter_map(color).collect()
    }

    /// A mixture of this colour and `other`; `share` (0 to 1) is the fraction of `other`.
    #[inline]
    pub fn mix(self, other: Color, share: f64) -> Color {
        let mix =
            |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
        Color(mix(self.0, other.0), mix(self.1, other.1), mix(self.2, other.2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance of two colours as red-green colour-blind readers see them: of blue against yellow, and
    /// of light against dark.
    fn distance(a: Color, b: Color) -> f64 {
        let yellow = |c: Color| 0.5 * (f64::from(c.0) + f64::from(c.1));
        let light = |c: Color| 0.3 * f64::from(c.0) + 0.6 * f64::from(c.1) + 0.1 * f64::from(c.2);
        let hue = |c: Color| f64::from(c.2) - yellow(c);
        (hue(a) - hue(b)).hypot(2.0 * (light(a) - light(b)))
    }

    #[test]
    fn materials_of_a_scene_differ_in_colour() {
        let names = ["copper", "steel", "copper", "pmma", "aluminium", "alumina", "copper_ofhc"];
        let colors = Color::of_materials(&names);
        assert_eq!((colors[0], colors[4], colors[2]), (Color::ORANGE, Color::GRAY, colors[0]));
        let others = [0, 1, 3, 4, 5, 6];
        for (k, &a) in others.iter().enumerate() {
            for &b in &others[..k] {
                let apart = distance(colors[a], colors[b]);
                assert!(apart > 45.0, "{} and {}: {apart}", names[a], names[b]);
            }
        }
        // a material keeps its colour when another one follows
        assert_eq!(Color::of_materials(&names[..3]), colors[..3]);
    }
}

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

    /// A mixture of this colour and `other`; `share` (0 to 1) is the fraction of `other`.
    pub fn mix(self, other: Color, share: f64) -> Color {
        let mix =
            |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
        Color(mix(self.0, other.0), mix(self.1, other.1), mix(self.2, other.2))
    }
}

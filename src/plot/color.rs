//! Colours: of materials as in the document, and a palette for the rest.

/// A colour: red, green, blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

impl Color {
    /// Black, of the document's shock approximation.
    pub const BLACK: Color = Color(0x11, 0x11, 0x11);
    /// White.
    pub const WHITE: Color = Color(0xff, 0xff, 0xff);
    /// Green, of the document's computed points.
    pub const GREEN: Color = Color(0x35, 0xb0, 0x4c);
    /// Red, of the true solution.
    pub const RED: Color = Color(0xd8, 0x10, 0x40);
    /// Orange, of copper in the document.
    pub const ORANGE: Color = Color(0xe0, 0x7b, 0x1e);
    /// Gray, of aluminium in the document.
    pub const GRAY: Color = Color(0x80, 0x88, 0x90);

    /// Colours told apart also by those who see red and green alike (after Okabe and Ito, darkened
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

    /// The `index`-th colour of the palette, which repeats.
    pub fn palette(index: usize) -> Color {
        Self::PALETTE[index % Self::PALETTE.len()]
    }

    /// The document's colour of a material: copper orange, aluminium gray; any other gets the
    /// palette's `index`-th.
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

    /// This colour mixed with `other`, of which `share` (0 to 1) is taken.
    pub fn mix(self, other: Color, share: f64) -> Color {
        let mix =
            |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * share).round() as u8;
        Color(mix(self.0, other.0), mix(self.1, other.1), mix(self.2, other.2))
    }
}

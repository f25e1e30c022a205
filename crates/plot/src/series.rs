//! Points of a curve, its line and its marks. All values are in SI units.

use super::color::Color;

/// Points of a curve; a value that is not finite breaks the line.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Points {
    /// Abscissae, in the unit of the x axis.
    pub x: Vec<f64>,
    /// Ordinates, in the unit of the y axis; as many as abscissae.
    pub y: Vec<f64>,
}

impl Points {
    /// Points from two columns.
    pub fn new(x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Self {
        Self { x: x.into(), y: y.into() }
    }
}

/// A named curve.
#[derive(Debug, Clone)]
pub struct Series {
    /// Name in the legend, which lists each name once; if empty, not listed.
    pub name: String,
    /// The data.
    pub points: Points,
    /// Colour, line and marks.
    pub style: Style,
}

impl Series {
    /// A series with this style.
    pub fn new(name: impl Into<String>, points: Points, style: Style) -> Self {
        Self { name: name.into(), points, style }
    }
}

/// Pattern of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// Solid.
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// Shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symbol {
    /// A disc.
    Disc,
    /// A ring.
    Ring,
    /// A diagonal cross.
    Cross,
}

/// Style of a series: a line, marks, or both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Colour of line and marks.
    pub color: Color,
    /// Pattern of the line; `None`: marks only.
    pub stroke: Option<Stroke>,
    /// Width of the line \[pixel of a page 1200 wide\].
    pub width: f64,
    /// Radius of round marks \[pixel\]; `None`: line only.
    pub mark: Option<f64>,
    /// Shape of the marks.
    pub symbol: Symbol,
    /// Whether the line has a dark border, so that it is visible on a colour map.
    pub outlined: bool,
}

impl Style {
    /// Crosses without a line.
    pub fn crosses(color: Color) -> Self {
        Self { mark: Some(5.0), symbol: Symbol::Cross, ..Self::marks(color) }
    }

    /// A solid line.
    pub fn line(color: Color) -> Self {
        let stroke = Some(Stroke::Solid);
        Self { color, stroke, width: 2.5, mark: None, symbol: Symbol::Disc, outlined: false }
    }

    /// Marks without a line.
    pub fn marks(color: Color) -> Self {
        Self { stroke: None, mark: Some(3.0), ..Self::line(color) }
    }

    /// Marks joined by a line.
    pub fn line_and_marks(color: Color) -> Self {
        Self { mark: Some(5.0), ..Self::line(color) }
    }

    /// The same style with another line pattern.
    pub fn stroke(self, stroke: Stroke) -> Self {
        Self { stroke: Some(stroke), ..self }
    }

    /// The same style with rings as marks.
    pub fn hollow(self) -> Self {
        Self { symbol: Symbol::Ring, ..self }
    }

    /// The same style with another line width.
    pub fn width(self, width: f64) -> Self {
        Self { width, ..self }
    }
}

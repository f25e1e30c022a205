//! Description of an axis. All values are in SI units.

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisScale {
    /// Linear.
    Linear,
    /// Logarithmic; values of zero and below are not drawn.
    Log,
}

/// An axis. Its data are in `unit`; the layout may show them with a prefix (mm, GPa) or a power of
/// ten.
#[derive(Debug, Clone)]
pub struct Axis {
    /// Name of the quantity: "Pressure".
    pub label: String,
    /// SI unit: "Pa"; empty for a dimensionless number.
    pub unit: String,
    /// Linear or logarithmic.
    pub scale: AxisScale,
    /// Ends, in `unit`; by default taken from the data.
    pub range: Option<(f64, f64)>,
    /// Margin beyond the data at each end, as a fraction of their range.
    pub margin: f64,
    /// Values with a number, in `unit`; if empty, round values are chosen.
    pub ticks: Vec<f64>,
}

impl Axis {
    /// A linear axis over the range of the data plus a margin.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        let (label, unit) = (label.into(), unit.into());
        let ticks = Vec::new();
        Self { label, unit, scale: AxisScale::Linear, range: None, margin: 0.05, ticks }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { scale: AxisScale::Log, ..Self::linear(label, unit) }
    }

    /// The axis from `low` to `high`, independent of the data. Ignored if the ends are not finite
    /// and ascending.
    pub fn range(self, low: f64, high: f64) -> Self {
        Self { range: Some((low, high)), ..self }
    }

    /// The axis with numbers only at these values, if they lie within its range.
    pub fn ticks(self, ticks: impl Into<Vec<f64>>) -> Self {
        Self { ticks: ticks.into(), ..self }
    }

    /// The axis without a margin beyond the data.
    pub fn tight(self) -> Self {
        Self { margin: 0.0, ..self }
    }
}

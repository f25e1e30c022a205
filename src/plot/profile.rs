//! Figure 4 of the document: pressure against position in the target at one time.

use super::color::Color;
use super::figure::{Axis, Figure, Panel, Points, Series, Style};

/// A pressure profile beside its references. Positions \[m\], pressures \[Pa\].
#[derive(Debug, Clone)]
pub struct Profile {
    /// The line at the top, to which the time is added.
    pub title: String,
    /// Time \[s\].
    pub time: f64,
    /// The document's solution, where release waves are shocks: the black line.
    pub approximation: Option<Points>,
    /// The true solution, where release waves spread.
    pub exact: Option<Points>,
    /// Computed points: the green marks.
    pub computed: Points,
    /// Lines of text, such as errors.
    pub notes: Vec<String>,
    /// Positions \[m\] between which the profile is shown once more, enlarged, if there is room: the
    /// shock front.
    pub close_up: Option<(f64, f64)>,
}

impl Profile {
    /// The figure.
    pub fn figure(&self) -> Figure {
        let mut panel = Panel::new(Axis::linear("Pressure", "Pa"));
        panel.series.push(Series::new("MPM", self.computed.clone(), Style::marks(Color::GREEN)));
        if let Some(points) = &self.approximation {
            let style = Style::line(Color::BLACK).width(2.0);
            panel.series.push(Series::new("shock approximation", points.clone(), style));
        }
        if let Some(points) = &self.exact {
            let style = Style::line(Color::RED).width(2.2);
            panel.series.push(Series::new("exact solution", points.clone(), style));
        }
        panel.notes.clone_from(&self.notes);
        panel.close_up = self.close_up;
        let title = format!("{}, t = {}", self.title, readable(self.time));
        Figure::new(title, Axis::linear("Position", "m").tight()).panel(panel)
    }
}

/// A time in microseconds, or in seconds where those would be many, without needless digits.
pub(super) fn readable(time: f64) -> String {
    let (scale, unit) = if time < 1e-2 { (1e6, "µs") } else { (1.0, "s") };
    let text = format!("{:.4}", time * scale);
    format!("{} {unit}", text.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_in_a_unit_that_suits_them() {
        assert_eq!(readable(5e-7), "0.5 µs");
        assert_eq!(readable(0.2), "0.2 s");
    }
}

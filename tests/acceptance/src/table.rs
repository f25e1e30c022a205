//! Rows of figures beside their bounds, printed as they are measured.

use std::fmt::Display;

use crate::bounds::{Bound, Unit};
use crate::section::Extent;

/// Result of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The figure has no bound.
    Unbounded,
    /// The bound is kept.
    Held,
    /// The bound is missed, or the run failed.
    Missed,
    /// This machine cannot measure the figure.
    NotMeasured,
}

/// A figure beside its bound, as text.
#[derive(Clone, Debug)]
pub struct Row {
    /// Section that measured it.
    pub section: &'static str,
    /// Name of the figure.
    pub figure: String,
    /// Measured value.
    pub measured: String,
    /// Bound, or a value to compare with.
    pub bound: String,
    /// Result.
    pub verdict: Verdict,
}

impl Row {
    /// The row in Markdown, its cells at least as wide as given.
    pub fn line(&self, [figure, measured, bound, ok]: [usize; 4]) -> String {
        let verdict = match self.verdict {
            Verdict::Unbounded => "",
            Verdict::Held => "yes",
            Verdict::Missed => "MISS",
            Verdict::NotMeasured => "-",
        };
        format!(
            "| {:figure$} | {:>measured$} | {:>bound$} | {verdict:ok$} |",
            self.figure, self.measured, self.bound
        )
    }
}

/// The figures of a group.
pub struct Table {
    /// How much of a section is measured.
    pub extent: Extent,
    /// Rows so far.
    pub rows: Vec<Row>,
    section: &'static str,
}

impl Table {
    /// An empty table.
    pub fn new(extent: Extent) -> Table {
        Table { extent, rows: Vec::new(), section: "" }
    }

    /// Prints the name of the section that measures next.
    pub fn begin(&mut self, group: &str, section: &'static str) {
        self.section = section;
        println!("\n{group}/{section}");
    }

    fn row(&mut self, figure: &str, measured: impl Display, bound: impl Display, verdict: Verdict) {
        let row = Row {
            section: self.section,
            figure: figure.to_string(),
            measured: measured.to_string(),
            bound: bound.to_string(),
            verdict,
        };
        println!("{}", row.line([54, 12, 14, 4]));
        self.rows.push(row);
    }

    /// A figure with a bound.
    pub fn check(&mut self, figure: &str, value: Option<f64>, bound: Bound) {
        self.row(figure, shown(value, bound.unit), limit(bound), verdict(bound.holds(value)));
    }

    /// Two figures, of which one must keep its bound.
    pub fn either(&mut self, figure: &str, figures: [(Option<f64>, Bound); 2]) {
        let measured = figures.map(|(value, bound)| shown(value, bound.unit)).join(", ");
        let bounds = figures.map(|(_, bound)| limit(bound)).join(" or ");
        let ok = figures.iter().any(|(value, bound)| bound.holds(*value));
        self.row(figure, measured, bounds, verdict(ok));
    }

    /// A figure without a bound, beside another one.
    pub fn beside(&mut self, figure: &str, value: Option<f64>, other: &str, unit: Unit) {
        self.row(figure, shown(value, unit), other, Verdict::Unbounded);
    }

    /// Something that holds or does not.
    pub fn holds(&mut self, figure: &str, measured: &str, expected: &str, ok: bool) {
        self.row(figure, measured, expected, verdict(ok));
    }

    /// How often something held, of as many times as the bound asks for.
    pub fn all(&mut self, figure: &str, held: u64, bound: Bound) {
        let expected = format!("all {}", bound.number());
        self.row(figure, held, expected, verdict(bound.holds(Some(held as f64))));
    }

    /// A figure that this machine cannot measure, with the reason.
    pub fn not_measured(&mut self, figure: &str, reason: &str) {
        self.row(figure, "not measured", reason, Verdict::NotMeasured);
    }

    /// The value of a run; a failed run is a row with its message below.
    pub fn take<T>(&mut self, figure: &str, result: Result<T, String>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(message) => {
                self.row(figure, "failed", "a result", Verdict::Missed);
                println!("  {message}");
                None
            }
        }
    }

    /// Number of rows with a verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        self.rows.iter().filter(|row| row.verdict == verdict).count()
    }
}

fn verdict(ok: bool) -> Verdict {
    if ok { Verdict::Held } else { Verdict::Missed }
}

fn limit(bound: Bound) -> String {
    let sign = if bound.at_most.is_some() { "<=" } else { ">=" };
    format!("{sign} {}", shown(Some(bound.number()), bound.unit))
}

fn shown(value: Option<f64>, unit: Unit) -> String {
    let Some(value) = value else { return "undefined".into() };
    match unit {
        Unit::Fraction => format!("{:.3} %", value * 100.0),
        Unit::Count | Unit::Instructions => format!("{value:.0}"),
        Unit::ParticleStepsPerSecond => format!("{:.2} M", value * 1e-6),
        Unit::Seconds => format!("{} s", plain(value)),
        Unit::Bytes if value.abs() >= 0.1 * GIB => format!("{:.3} GiB", value / GIB),
        Unit::Bytes => format!("{value:.0} B"),
        Unit::One | Unit::Cells => plain(value),
    }
}

const GIB: f64 = 1073741824.0;

/// Four decimals, or a power of ten where these would be lost.
fn plain(value: f64) -> String {
    let small = value != 0.0 && value.abs() < 1e-3;
    if small { format!("{value:.1e}") } else { format!("{value:.4}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_shown_in_their_unit() {
        for (value, unit, text) in [
            (0.0123, Unit::Fraction, "1.230 %"),
            (1.5, Unit::Cells, "1.5000"),
            (2e-13, Unit::One, "2.0e-13"),
            (0.0, Unit::One, "0.0000"),
            (1.25e7, Unit::ParticleStepsPerSecond, "12.50 M"),
            (10.0, Unit::Seconds, "10.0000 s"),
            (1048576.0, Unit::Bytes, "1048576 B"),
            (GIB, Unit::Bytes, "1.000 GiB"),
        ] {
            assert_eq!(shown(Some(value), unit), text);
        }
        assert_eq!(shown(None, Unit::One), "undefined");
    }

    #[test]
    fn rows_are_counted_by_their_verdict() {
        let mut table = Table::new(Extent::Quick);
        table.holds("a", "1 digest", "1 digest", true);
        table.holds("a again", "1 digest", "1 digest", true);
        table.holds("b", "2 digests", "1 digest", false);
        table.not_measured("c", "no valgrind");
        assert!(table.take::<()>("d", Err("it failed".into())).is_none());
        table.beside("e", Some(1.0), "", Unit::One);
        let counts = [Verdict::Held, Verdict::Missed, Verdict::NotMeasured, Verdict::Unbounded];
        assert_eq!(counts.map(|verdict| table.count(verdict)), [2, 2, 1, 1]);
    }
}

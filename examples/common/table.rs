//! The table of figures, printed as it grows.

use std::fmt::Display;

/// How a figure is shown.
#[derive(Clone, Copy)]
#[allow(dead_code)] // each check has its own figures
pub enum Show {
    /// A fraction in per cent.
    Percent,
    /// A number as it is.
    Number,
    /// A tiny number by its power of ten.
    Tiny,
    /// Millions.
    Millions,
    /// Seconds.
    Seconds,
    /// Bytes, in GiB.
    Gib,
}

/// Counts the figures and those out of bounds.
#[derive(Default)]
pub struct Table {
    /// Figures that have a bound.
    pub bounded: usize,
    /// Those that miss it.
    pub missed: usize,
}

impl Table {
    /// Prints the head of the table.
    pub fn new() -> Table {
        println!("| {:54} | {:>12} | {:>14} | ok   |", "figure", "measured", "bound");
        println!("|{:-<56}|{:->14}|{:->16}|------|", "", "", "");
        Table::default()
    }

    fn row(&mut self, figure: &str, measured: impl Display, bound: impl Display, ok: Option<bool>) {
        let verdict = match ok {
            None => "",
            Some(true) => "yes",
            Some(false) => "MISS",
        };
        self.bounded += usize::from(ok.is_some());
        self.missed += usize::from(ok == Some(false));
        println!("| {figure:54} | {measured:>12} | {bound:>14} | {verdict:4} |");
    }

    /// A figure whose size must not pass the bound; one that is undefined misses it.
    pub fn at_most(&mut self, figure: &str, value: Option<f64>, bound: f64, show: Show) {
        let ok = value.is_some_and(|v| v.abs() <= bound);
        self.row(figure, shown(value, show), format!("<= {}", shown(Some(bound), show)), Some(ok));
    }

    /// A figure that must reach the bound.
    #[allow(dead_code)] // each check has its own figures
    pub fn at_least(&mut self, figure: &str, value: Option<f64>, bound: f64, show: Show) {
        let ok = value.is_some_and(|v| v >= bound);
        self.row(figure, shown(value, show), format!(">= {}", shown(Some(bound), show)), Some(ok));
    }

    /// A figure beside another one, without a bound.
    #[allow(dead_code)] // likewise
    pub fn beside(&mut self, figure: &str, value: Option<f64>, other: &str, show: Show) {
        self.row(figure, shown(value, show), other, None);
    }

    /// Something that holds or does not.
    pub fn holds(&mut self, figure: &str, measured: &str, bound: &str, ok: bool) {
        self.row(figure, measured, bound, Some(ok));
    }

    /// A run that failed, with what it said; nothing for one that did not.
    #[allow(dead_code)] // likewise
    pub fn take<T>(&mut self, figure: &str, result: Result<T, String>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(message) => {
                self.row(figure, "failed", "a result", Some(false));
                println!("  {message}");
                None
            }
        }
    }
}

fn shown(value: Option<f64>, show: Show) -> String {
    let Some(value) = value else { return "undefined".into() };
    match show {
        Show::Percent => format!("{:.3} %", value * 100.0),
        Show::Number => format!("{value:.4}"),
        Show::Tiny => format!("{value:.1e}"),
        Show::Millions => format!("{:.2} M", value * 1e-6),
        Show::Seconds => format!("{value:.3} s"),
        Show::Gib => format!("{:.3} GiB", value / 1073741824.0),
    }
}

//! A bound as `bounds.toml` has it; `build.rs` reads it by the same type.

use serde::Deserialize;

/// Limit of a measured figure: exactly one of `at_most` and `at_least`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bound {
    /// Largest magnitude allowed.
    pub at_most: Option<f64>,
    /// Smallest value allowed.
    pub at_least: Option<f64>,
    /// Unit of the figure and of its bound.
    pub unit: Unit,
}

/// Unit of a figure.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
pub enum Unit {
    /// A number without a unit.
    #[serde(rename = "1")]
    One,
    /// A fraction, shown in per cent.
    #[serde(rename = "fraction")]
    Fraction,
    /// Edges of a cell.
    #[serde(rename = "cells")]
    Cells,
    /// How often something holds.
    #[serde(rename = "count")]
    Count,
    /// Seconds.
    #[serde(rename = "s")]
    Seconds,
    /// Bytes.
    #[serde(rename = "bytes")]
    Bytes,
    /// Particle-steps per second, shown in millions.
    #[serde(rename = "particle-steps/s")]
    ParticleStepsPerSecond,
    /// Instructions per particle and step.
    #[serde(rename = "instructions")]
    Instructions,
}

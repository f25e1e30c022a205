//! Relative L1 error of the pressure in each profile.

use super::{ErrorModel, ErrorScale};
use crate::accuracy::estimate::EstimatedErrors;
use crate::accuracy::plan::data::{SchemeAccuracy, Size};

pub(super) struct L1;

impl ErrorModel for L1 {
    fn error(m: &SchemeAccuracy, scale: &ErrorScale, h: f64) -> Option<Size> {
        Some(m.e1_cells.times(h / scale.pulse))
    }

    fn cells_for(m: &SchemeAccuracy, scale: &ErrorScale, error: f64) -> Option<f64> {
        Some(error * scale.pulse / m.e1_cells.most)
    }

    fn actual(exact_l1: &[f64], estimate: Option<&EstimatedErrors>) -> Vec<(f64, bool)> {
        let bounds = estimate.iter().flat_map(|e| &e.profiles);
        match exact_l1.is_empty() {
            true => bounds.filter_map(|p| Some((p.l1.half_width?, false))).collect(),
            false => exact_l1.iter().map(|&l1| (l1, true)).collect(),
        }
    }
}

//! Relative L1 error of the pressure in each profile.

use super::{ErrorModel, ErrorScale};
use crate::accuracy::estimate::EstimatedErrors;
use crate::accuracy::plan::data::{ErrorLaws, SchemeAccuracy};

pub(super) struct L1;

impl ErrorModel for L1 {
    fn laws(m: &SchemeAccuracy) -> &ErrorLaws {
        &m.l1
    }

    fn length(scale: &ErrorScale) -> Result<f64, String> {
        Ok(scale.pulse)
    }

    fn actual(exact_l1: &[f64], estimate: Option<&EstimatedErrors>) -> Vec<(f64, bool)> {
        let bounds = estimate.iter().flat_map(|e| &e.profiles);
        match exact_l1.is_empty() {
            true => bounds.filter_map(|p| Some((p.l1.half_width?, false))).collect(),
            false => exact_l1.iter().map(|&l1| (l1, true)).collect(),
        }
    }
}

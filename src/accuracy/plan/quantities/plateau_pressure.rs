//! Pressure on the plateau behind the shock.

use super::{ErrorModel, ErrorScale, LEAST_PLATEAU, relative};
use crate::accuracy::estimate::EstimatedErrors;
use crate::accuracy::plan::data::{SchemeAccuracy, Size};

pub(super) struct PlateauPressure;

impl ErrorModel for PlateauPressure {
    fn error(m: &SchemeAccuracy, scale: &ErrorScale, h: f64) -> Option<Size> {
        Some(m.plateau.times((h / scale.plateau?).powf(m.plateau_order)))
    }

    fn cells_for(m: &SchemeAccuracy, scale: &ErrorScale, error: f64) -> Option<f64> {
        // a plateau of fewer cells cannot be evaluated
        let plateau = scale.plateau?;
        let h = plateau * (error / m.plateau.most).powf(1.0 / m.plateau_order);
        Some(h.min(plateau / LEAST_PLATEAU))
    }

    fn actual(_: &[f64], estimate: Option<&EstimatedErrors>) -> Vec<(f64, bool)> {
        let profiles = estimate.iter().flat_map(|e| &e.profiles);
        profiles.filter_map(|p| relative(p.plateau_pressure.as_ref()?)).collect()
    }
}

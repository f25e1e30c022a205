//! Pressure on the plateau behind the shock.

use super::{ErrorModel, ErrorScale, relative};
use crate::accuracy::estimate::EstimatedErrors;
use crate::accuracy::plan::data::{ErrorLaws, SchemeAccuracy};

pub(super) struct PlateauPressure;

impl ErrorModel for PlateauPressure {
    fn laws(m: &SchemeAccuracy) -> &ErrorLaws {
        &m.plateau
    }

    fn length(scale: &ErrorScale) -> Result<f64, String> {
        scale.plateau.clone()
    }

    fn least_cells(scale: &ErrorScale) -> f64 {
        // the number of cells of the run may be rounded down
        1.05 * scale.least_plateau
    }

    fn actual(_: &[f64], estimate: Option<&EstimatedErrors>) -> Vec<(f64, bool)> {
        let profiles = estimate.iter().flat_map(|e| &e.profiles);
        profiles.filter_map(|p| relative(p.plateau_pressure.as_ref()?)).collect()
    }
}

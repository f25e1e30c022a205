//! Arrival time of the wave at a position.

use super::{ErrorModel, ErrorScale, relative};
use crate::accuracy::estimate::EstimatedErrors;
use crate::accuracy::plan::data::{ErrorLaws, SchemeAccuracy};

pub(super) struct ArrivalTime;

impl ErrorModel for ArrivalTime {
    const AT_PLACE: bool = true;

    fn laws(m: &SchemeAccuracy) -> &ErrorLaws {
        &m.arrival
    }

    fn length(scale: &ErrorScale) -> Result<f64, String> {
        scale.way.ok_or_else(|| "nothing arrives at the position within the run".into())
    }

    fn actual(_: &[f64], estimate: Option<&EstimatedErrors>) -> Vec<(f64, bool)> {
        let arrivals = estimate.iter().flat_map(|e| &e.arrivals);
        arrivals.filter_map(|a| relative(a.time.as_ref()?)).collect()
    }
}

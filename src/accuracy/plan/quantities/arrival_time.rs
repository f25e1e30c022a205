//! Arrival time of the wave at a position.

use super::{ErrorModel, ErrorScale, LEAST_PLATEAU, relative};
use crate::accuracy::estimate::EstimatedErrors;
use crate::accuracy::plan::data::{SchemeAccuracy, Size};

pub(super) struct ArrivalTime;

impl ErrorModel for ArrivalTime {
    const AT_PLACE: bool = true;

    fn error(m: &SchemeAccuracy, scale: &ErrorScale, h: f64) -> Option<Size> {
        Some(m.arrival_cells.times(h / scale.way?))
    }

    fn cells_for(m: &SchemeAccuracy, scale: &ErrorScale, error: f64) -> Option<f64> {
        let way = scale.way?;
        Some((error * way / m.arrival_cells.most).min(way / LEAST_PLATEAU))
    }

    fn actual(_: &[f64], estimate: Option<&EstimatedErrors>) -> Vec<(f64, bool)> {
        let arrivals = estimate.iter().flat_map(|e| &e.arrivals);
        arrivals.filter_map(|a| relative(a.time.as_ref()?)).collect()
    }
}

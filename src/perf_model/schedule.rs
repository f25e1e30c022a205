//! Operations of a step, counted: phases, exchanges of ghost particles and of nodal values.
//!
//! The order is that of the phases in [`crate::solver`], so that the two can be compared side by
//! side; a test compares the counts with the timeline of a real run.

use crate::scene::{EnergyUpdate, FilterHalo, FrameKind, Method, Stepping, StressUpdate};
use crate::solver::relaxation;
use crate::transfer::TransferPlan;

/// Counts per step; not whole numbers if an operation is not done in every step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepCounts {
    /// Number of exchanges of ghost particles \[-\].
    pub row_exchanges: f64,
    /// Number of exchanges of nodal values \[-\], one after each product, if halos are exchanged.
    pub node_exchanges: f64,
    /// Number of fields in these exchanges, in total \[-\].
    pub node_fields: f64,
    /// Number of phases over patches \[-\].
    pub phases: f64,
    /// Number of phases outside of an exchange of ghost particles \[-\].
    pub plain_phases: f64,
}

impl StepCounts {
    /// Average counts per step of a method.
    pub fn of(method: &Method) -> Self {
        let with = ScheduleRecorder::step(method, true);
        match method.pressure_relaxation {
            Some(r) if method.stepping == Stepping::Midpoint => {
                let share = 1.0 / f64::from(r.interval.max(1));
                with.times(share).plus(ScheduleRecorder::step(method, false).times(1.0 - share))
            }
            _ => with,
        }
    }

    /// Number of exchanges between ranks per step \[-\].
    pub fn exchanges(&self, halo: FilterHalo) -> f64 {
        match halo {
            FilterHalo::Exchange => self.row_exchanges + self.node_exchanges,
            FilterHalo::Redundant => self.row_exchanges,
        }
    }

    /// Number of forks and joins of the threads of a rank per step \[-\]: one per phase, and a
    /// second one after an exchange, for inner patches and for the others. With redundant halos,
    /// all phases after an exchange of ghost particles run as one.
    pub fn forks(&self, halo: FilterHalo) -> f64 {
        match halo {
            FilterHalo::Exchange => self.phases + self.exchanges(halo),
            FilterHalo::Redundant => self.plain_phases + 2.0 * self.row_exchanges,
        }
    }

    fn times(self, factor: f64) -> Self {
        StepCounts {
            row_exchanges: self.row_exchanges * factor,
            node_exchanges: self.node_exchanges * factor,
            node_fields: self.node_fields * factor,
            phases: self.phases * factor,
            plain_phases: self.plain_phases * factor,
        }
    }

    fn plus(self, other: Self) -> Self {
        StepCounts {
            row_exchanges: self.row_exchanges + other.row_exchanges,
            node_exchanges: self.node_exchanges + other.node_exchanges,
            node_fields: self.node_fields + other.node_fields,
            phases: self.phases + other.phases,
            plain_phases: self.plain_phases + other.plain_phases,
        }
    }
}

/// Counts phases as [`crate::solver::Nodal`] runs them: an exchange is requested, and done before
/// the next phase.
struct ScheduleRecorder {
    transfer: TransferPlan,
    masked: bool,
    /// Whether the relaxation needs the mean volume ratio.
    ratio: bool,
    counted: StepCounts,
    /// Number of fields of the requested exchange; `None`: no request.
    pending: Option<usize>,
}

impl ScheduleRecorder {
    fn step(method: &Method, relaxes: bool) -> StepCounts {
        let mut step = ScheduleRecorder {
            transfer: method.transfer.plan(),
            masked: method.edge_mask.is_some(),
            ratio: method.pressure_relaxation.is_some()
                && method.frame == FrameKind::UpdatedLagrangian,
            counted: StepCounts::default(),
            pending: None,
        };
        match method.stepping {
            Stepping::Midpoint => step.midpoint(method, relaxes),
            Stepping::Leapfrog => step.leapfrog(method.stress_update),
        }
        step.counted
    }

    fn midpoint(&mut self, method: &Method, relaxes: bool) {
        self.plain(); // start
        self.counted.row_exchanges += 1.0;
        self.each(); // scatter
        self.solve_velocity(relaxes && method.pressure_relaxation.is_some());
        if method.energy == EnergyUpdate::Compatible {
            self.solve_work();
        }
        self.each(); // gather
    }

    fn leapfrog(&mut self, stress: StressUpdate) {
        self.plain(); // start
        let passes = if stress == StressUpdate::Last { 1 } else { 2 };
        for _ in 0..passes {
            self.counted.row_exchanges += 1.0;
            self.each(); // scatter
            self.solve_velocity(false);
            self.each(); // gather, or update stress
        }
        self.plain(); // refresh
    }

    /// The series of velocity, force and, in a step with relaxation, pressure advance together.
    fn solve_velocity(&mut self, relaxes: bool) {
        let (order, force) = (self.transfer.order, self.transfer.force_order());
        let pressure = if relaxes { relaxation::ORDER } else { 0 };
        let edge = self.masked && force > 1;
        let others = 1 + usize::from(edge) + usize::from(relaxes && self.ratio);
        self.sum_series(&[order, force, pressure], others);
    }

    fn solve_work(&mut self) {
        self.sum_series(&[self.transfer.force_order()], 0);
    }

    fn sum_series(&mut self, orders: &[u32], others: usize) {
        for l in 0..orders.iter().copied().max().unwrap_or(0) {
            let going = orders.iter().filter(|&&order| order > l).count();
            self.refresh(going + if l == 0 { others } else { 0 });
            self.each();
        }
    }

    fn refresh(&mut self, fields: usize) {
        self.pending = Some(fields);
    }

    fn each(&mut self) {
        if let Some(fields) = self.pending.take() {
            self.counted.node_exchanges += 1.0;
            self.counted.node_fields += fields as f64;
        }
        self.counted.phases += 1.0;
    }

    fn plain(&mut self) {
        self.counted.phases += 1.0;
        self.counted.plain_phases += 1.0;
    }
}

/// Name of a method for tables, such as `cpdi, fmpm 4, midpoint`.
pub fn method_name(method: &Method) -> String {
    let text = |value: serde_json::Value| value.to_string().replace(['"', '{', '}'], "");
    let of = |value: &dyn erased::Json| text(value.json());
    let transfer = of(&method.transfer).replace(':', " ");
    format!("{}, {transfer}, {}", of(&method.shape), of(&method.stepping))
}

mod erased {
    pub trait Json {
        fn json(&self) -> serde_json::Value;
    }

    impl<T: serde::Serialize> Json for T {
        fn json(&self) -> serde_json::Value {
            serde_json::to_value(self).unwrap_or_default()
        }
    }
}

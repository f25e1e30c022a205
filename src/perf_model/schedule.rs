//! What a step does, counted: phases, exchanges of rows and of nodal values.
//!
//! Written in the order of [`crate::solver`]'s own phases, so that the two can be read side by side;
//! a test holds the counts against the timeline of a real run.

use crate::scene::{EnergyUpdate, FilterHalo, Method, Stepping, StressUpdate, Transfer};
use crate::solver::relaxation;
use crate::solver::transfer::Scheme;

/// Counts of one step; fractions where something is done every few steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Schedule {
    /// Exchanges of particle rows.
    pub row_exchanges: f64,
    /// Exchanges of nodal values, each after a product, if halos are exchanged; else none.
    pub node_exchanges: f64,
    /// Fields that those carry, summed over them.
    pub node_fields: f64,
    /// Phases over patches.
    pub phases: f64,
    /// Those of them that stand outside of an exchange of rows.
    pub plain_phases: f64,
}

impl Schedule {
    /// The average step of a method.
    pub fn of(method: &Method) -> Self {
        let with = Recorder::step(method, true);
        match method.pressure_relaxation {
            Some(r) if method.stepping == Stepping::Midpoint => {
                let share = 1.0 / f64::from(r.interval.max(1));
                with.times(share).plus(Recorder::step(method, false).times(1.0 - share))
            }
            _ => with,
        }
    }

    /// Exchanges of a step between ranks.
    pub fn exchanges(&self, halo: FilterHalo) -> f64 {
        match halo {
            FilterHalo::Exchange => self.row_exchanges + self.node_exchanges,
            FilterHalo::Deep => self.row_exchanges,
        }
    }

    /// How often the threads of a rank part and join in a step: once a phase, and twice where a
    /// phase follows an exchange, for inner patches and for the others; deep ghosts let all phases
    /// after an exchange of rows run as one.
    pub fn forks(&self, halo: FilterHalo) -> f64 {
        match halo {
            FilterHalo::Exchange => self.phases + self.exchanges(halo),
            FilterHalo::Deep => self.plain_phases + 2.0 * self.row_exchanges,
        }
    }

    fn times(self, factor: f64) -> Self {
        Schedule {
            row_exchanges: self.row_exchanges * factor,
            node_exchanges: self.node_exchanges * factor,
            node_fields: self.node_fields * factor,
            phases: self.phases * factor,
            plain_phases: self.plain_phases * factor,
        }
    }

    fn plus(self, other: Self) -> Self {
        Schedule {
            row_exchanges: self.row_exchanges + other.row_exchanges,
            node_exchanges: self.node_exchanges + other.node_exchanges,
            node_fields: self.node_fields + other.node_fields,
            phases: self.phases + other.phases,
            plain_phases: self.plain_phases + other.plain_phases,
        }
    }
}

/// Counts phases as [`crate::solver::Nodal`] runs them: an exchange is asked for and done before the
/// next phase.
struct Recorder {
    scheme: Scheme,
    masked: bool,
    counted: Schedule,
    /// Fields of the exchange that is asked for; `None`: none.
    pending: Option<usize>,
}

impl Recorder {
    fn step(method: &Method, relaxes: bool) -> Schedule {
        let mut step = Recorder {
            scheme: method.transfer.into(),
            masked: method.edge_mask.is_some(),
            counted: Schedule::default(),
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

    /// The series of velocity, force and, in a step that relaxes it, pressure advance together.
    fn solve_velocity(&mut self, relaxes: bool) {
        let (order, force) = match self.scheme {
            Scheme::Series { order, force } => (order, if force { order } else { 1 }),
            Scheme::Blend(_) | Scheme::Affine => (1, 1),
        };
        let pressure = if relaxes { relaxation::ORDER } else { 0 };
        let others = if self.masked { 2 } else { 1 };
        self.sum_series(&[order, force, pressure], others);
    }

    fn solve_work(&mut self) {
        let order = match self.scheme {
            Scheme::Series { order, force: true } => order,
            _ => 1,
        };
        self.sum_series(&[order], 0);
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

/// A method's name in a table, such as `cpdi, fmpm 4, midpoint`.
pub fn method_name(method: &Method) -> String {
    let text = |value: serde_json::Value| value.to_string().replace(['"', '{', '}'], "");
    let of = |value: &dyn erased::Json| text(value.json());
    let transfer = match method.transfer {
        Transfer::Flip | Transfer::Pic | Transfer::Apic => of(&method.transfer),
        _ => of(&method.transfer).replace(':', " "),
    };
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

//! Operations of a step, counted: phases, exchanges of ghost particles and of nodal values.
//!
//! The steps of the scene run on a rank without patches: they request all exchanges, but compute and
//! send nothing.

use decomp::{GhostExchange, GhostReach, IndexBox, Layout, NodeExchange, Serial, SideKind};

use crate::effects;
use crate::scene::{CheckedScene, FilterHalo, Method, Stepping};
use crate::solver::World;
use crate::solver::clock::{Clock, Operations};

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
    /// Average counts per step of a scene.
    pub fn of(scene: &CheckedScene) -> Self {
        let method = &scene.scene.method;
        // some phases belong to steps with pressure relaxation alone
        let steps = match method.pressure_relaxation {
            Some(relaxation) if method.stepping == Stepping::Midpoint => relaxation.interval.max(1),
            _ => 1,
        };
        let counted = match scene.dimension {
            1 => operations::<1>(scene, steps),
            _ => operations::<2>(scene, steps),
        };
        let per_step = |count: u64| count as f64 / f64::from(steps);
        StepCounts {
            row_exchanges: per_step(counted.particle_exchanges),
            node_exchanges: per_step(counted.node_exchanges),
            node_fields: per_step(counted.node_fields),
            phases: per_step(counted.plain_phases + counted.nodal_phases),
            plain_phases: per_step(counted.plain_phases),
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
}

/// Operations of the first `steps` steps on a rank that has no patch.
fn operations<const D: usize>(scene: &CheckedScene, steps: u32) -> Operations {
    let stepper = effects::stepper::<D>(scene);
    let layout = Layout::new(IndexBox::new([0; D], [1; D]), [[SideKind::Open; 2]; D], [1; D]);
    let without_patches = 1;
    let reach = GhostReach { depth: 1, travel: 1, notice: None };
    let mut particles = GhostExchange::new(&layout, without_patches, reach);
    let mut nodes = NodeExchange::new(&layout, without_patches, 1, 1);
    let mut clock = Clock::new();
    let mut world = World {
        comm: &Serial,
        layout: &layout,
        patches: &mut [],
        particles: &mut particles,
        nodes: &mut nodes,
        inner_particles: &[],
        inner_nodes: &[],
        filter: FilterHalo::Exchange,
        overlap: false,
        sleep: None,
        pool: None,
        clock: &mut clock,
    };
    for step in 1..=u64::from(steps) {
        let (dt, stable) = (scene.scene.time.courant, 1.0);
        let advanced = stepper.advance(&mut world, 0.0, dt, stable, step);
        advanced.expect("no particle has moved too far");
    }
    clock.operations
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

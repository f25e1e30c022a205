//! One patch with a few particles, for tests of single kernels: a small scene, columns and nodal
//! fields by name, and the parts of a step one by one.

use decomp::{GhostExchange, GhostReach, Layout, NodeExchange, Serial};
use serde_json::{Value, json};

use crate::input;
use crate::scene::{FilterHalo, Stepping};
use crate::solver::clock::Clock;
use crate::solver::effect::{Account, Phase, StepContext};
use crate::solver::patch::Patch;
use crate::solver::{Nodal, Stepper, World, particles};

/// A stepper and one patch.
pub(crate) struct Fixture<const D: usize> {
    pub(crate) stepper: Stepper<D>,
    pub(crate) patch: Patch<D>,
    /// Start of the step [s].
    pub(crate) time: f64,
    layout: Layout<D>,
    ghosts: GhostExchange<D>,
    nodes: NodeExchange<D>,
}

/// Scene that tests change: cells of 1 m, 8 along each direction, and one body of two particles in
/// the cells 3 and 4, of a fluid with density 2 kg/m3, p = 200 Pa (1/J - 1) and sound speed 10 m/s.
fn plain_scene(dimension: usize) -> Value {
    let all = |value: f64| vec![value; dimension];
    let [mut lower, mut upper] = [all(3.0), all(4.0)];
    (lower[0], upper[0]) = (3.0, 5.0);
    json!({
        "title": "kernel",
        "domain": {"lower": all(0.0), "upper": all(8.0), "cell_size": 1.0},
        "time": {"end": 1.0},
        "method": {"shape": "linear", "transfer": "flip"},
        "materials": {
            "fluid": {
                "density": 2.0,
                "eos": {"type": "tait", "bulk_modulus": 200.0, "exponent": 1.0},
            },
        },
        "bodies": [{
            "name": "body",
            "material": "fluid",
            "box": {"lower": lower, "upper": upper},
            "particles_per_cell": vec![1; dimension],
        }],
    })
}

/// Writes the keys of `changes` into `into`; null removes a key, lists are replaced.
fn merge(into: &mut Value, changes: Value) {
    match (into, changes) {
        (Value::Object(into), Value::Object(changes)) => {
            for (key, value) in changes {
                match value {
                    Value::Null => drop(into.remove(&key)),
                    value => merge(into.entry(key).or_insert(Value::Null), value),
                }
            }
        }
        (into, changes) => *into = changes,
    }
}

impl<const D: usize> Fixture<D> {
    /// The plain scene with `changes`, with pressure, sound speed and gradients of its start.
    #[track_caller]
    pub(crate) fn new(changes: Value) -> Self {
        let mut whole = plain_scene(D);
        merge(&mut whole, changes);
        Self::of(&whole)
    }

    /// The plain scene with the solid of Young's modulus 100 Pa and Poisson's ratio 1/4, a shear
    /// modulus of 40 Pa, as material, and with `changes`.
    #[track_caller]
    pub(crate) fn solid(changes: Value) -> Self {
        let mut whole = plain_scene(D);
        whole["materials"]["fluid"]["eos"] =
            json!({"type": "neo_hookean", "youngs_modulus": 100.0, "poissons_ratio": 0.25});
        merge(&mut whole, changes);
        Self::of(&whole)
    }

    /// The plain scene with axial symmetry, and with `changes`.
    #[track_caller]
    pub(crate) fn axisymmetric(changes: Value) -> Self {
        let mut whole = plain_scene(D);
        whole["domain"]["geometry"] = json!("axisymmetric");
        whole["boundary"] = json!({"x_lower": "symmetry"});
        merge(&mut whole, changes);
        Self::of(&whole)
    }

    #[track_caller]
    fn of(scene: &Value) -> Self {
        let scene = input::parse(scene.to_string().as_bytes(), "kernel", &[])
            .unwrap_or_else(|error| panic!("{error}"));
        let stepper: Stepper<D> = crate::effects::stepper(&scene);
        let cells = decomp::IndexBox::new([0; D], stepper.cells);
        let sides = scene.side_properties::<D>().map(|ends| ends.map(|side| side.ghosts));
        let layout = Layout::new(cells, sides, [1; D]);
        let grid = scene.grid_velocity::<D>();
        let mut blocks = particles::fill(&scene, &stepper, &layout, 0, grid);
        let mut patch = Patch::new(&layout, 0, blocks.remove(0));
        // room for particles that a test moves or stretches
        let reach = stepper.reach(3.0).expect("stencils are wide enough");
        let depth = reach.cells();
        let ghosts = GhostExchange::new(&layout, 0, GhostReach { depth, travel: 1, notice: None });
        let nodes =
            NodeExchange::layered(&layout, 0, reach.halo(), reach.depth(depth), stepper.layers);
        let fields = stepper.fields.count;
        patch.set_arrays(&layout, 0, reach.depth(depth), 0, fields, stepper.layers);
        patch.reach_length = stepper.longest_within(reach);
        let mut fixture = Fixture { stepper, patch, time: 0.0, layout, ghosts, nodes };
        fixture.world(|stepper, world| stepper.prime(world).expect("particles stay in place"));
        fixture.patch.block.drop_ghosts();
        let columns = &mut fixture.patch.block.columns;
        if let Some(mid) = fixture.stepper.columns.jacobian_mid {
            columns[mid] = columns[fixture.stepper.columns.jacobian].clone();
        }
        fixture
    }

    fn world<R>(&mut self, call: impl FnOnce(&Stepper<D>, &mut World<'_, D>) -> R) -> R {
        let mut world = World {
            comm: &Serial,
            layout: &self.layout,
            patches: std::slice::from_mut(&mut self.patch),
            particles: &mut self.ghosts,
            nodes: &mut self.nodes,
            inner_particles: &[true],
            inner_nodes: &[true],
            filter: FilterHalo::Exchange,
            overlap: false,
            sleep: None,
            pool: None,
            clock: &mut Clock::new(),
        };
        call(&self.stepper, &mut world)
    }

    /// Sets a column of the own particles.
    #[track_caller]
    pub(crate) fn set(&mut self, column: &str, values: &[f64]) -> &mut Self {
        let own = self.patch.block.own();
        assert_eq!(values.len(), own, "one value per particle");
        let column = self.stepper.columns.get(column);
        let column = &mut self.patch.block.columns[column];
        column.resize(column.len().max(own), 0.0);
        column[..own].copy_from_slice(values);
        self
    }

    /// Sets the cells of the own particles to those of their positions, as a step before would have
    /// left them: the particles may be anywhere.
    pub(crate) fn place(&mut self) -> &mut Self {
        let (s, block) = (&self.stepper, &mut self.patch.block);
        let first = s.columns.reference.unwrap_or(s.columns.position);
        for r in 0..block.own() {
            block.cells[r] = std::array::from_fn(|a| {
                let place = (block.columns[first + a][r] - s.lower[a]) * s.inverse_cell[a];
                (place.floor() as i64).rem_euclid(s.cells[a]) as i32
            });
        }
        self
    }

    /// A column of the own particles.
    #[track_caller]
    pub(crate) fn get(&self, column: &str) -> Vec<f64> {
        let column = self.stepper.columns.get(column);
        self.patch.block.columns[column][..self.patch.block.own()].to_vec()
    }

    /// Index of a nodal field by its name in [`Fields`](crate::solver::nodal_fields::Fields), in a
    /// plane with `_x` or `_y` after the name of a vector.
    fn field(&self, name: &str) -> usize {
        let f = &self.stepper.fields;
        let (name, axis) = match (name.strip_suffix("_x"), name.strip_suffix("_y")) {
            (Some(name), _) => (name, 0),
            (_, Some(name)) => (name, 1),
            _ => (name, 0),
        };
        axis + match name {
            "mass" => f.mass,
            "inverse" => f.inverse,
            "lumped_velocity" => f.lumped_velocity,
            "velocity" => f.velocity,
            "velocity_star" => f.velocity_star,
            "acceleration" => f.acceleration,
            "work" => f.work,
            "filter_residual" => f.filter_residual.expect("the transfer has a filter"),
            "volume" => f.volume,
            "edge" => f.edge,
            "compliance" => f.relaxation[0],
            "pressure" => f.relaxation[2],
            "pressure_residual" => f.relaxation[3],
            "heat" => f.heat.expect("the scene has friction"),
            _ => panic!("no nodal field {name}"),
        }
    }

    /// Value of a nodal field in the velocity field of `body`.
    pub(crate) fn node_of(&self, body: usize, field: &str, index: [i64; D]) -> f64 {
        let nodes = &self.patch.nodes.nodes;
        self.patch.nodes.fields[self.field(field)][body * nodes.count() + nodes.flat(index)]
    }

    /// Value of a nodal field.
    pub(crate) fn node(&self, field: &str, index: [i64; D]) -> f64 {
        self.node_of(0, field, index)
    }

    /// Value of one of the nodal fields that effects have added, counted from the last one.
    pub(crate) fn added_node(&self, from_last: usize, index: [i64; D]) -> f64 {
        let field = self.stepper.fields.count - 1 - from_last;
        self.patch.nodes.fields[field][self.patch.nodes.nodes.flat(index)]
    }

    /// Sets the value of a nodal field.
    pub(crate) fn set_node(&mut self, field: &str, index: [i64; D], value: f64) -> &mut Self {
        let (field, at) = (self.field(field), self.patch.nodes.nodes.flat(index));
        self.patch.nodes.fields[field][at] = value;
        self
    }

    /// Runs a kernel on the patch, in a step of `dt` [s] from `time`.
    pub(crate) fn run<R>(
        &mut self,
        dt: f64,
        kernel: impl FnOnce(&Stepper<D>, &StepContext<'_, D>, &mut Patch<D>) -> R,
    ) -> R {
        let step = context(&self.stepper, self.time, dt);
        kernel(&self.stepper, &step, &mut self.patch)
    }

    /// Runs the effects of a phase in a step of `dt` [s].
    pub(crate) fn act(&mut self, phase: Phase, dt: f64) -> &mut Self {
        self.run(dt, |s, step, patch| s.effects.act(phase, step, patch));
        self
    }

    /// Pressure, temperature, sound speed and stress of the particles from their state, and the
    /// report of the patch.
    pub(crate) fn refresh(&mut self) -> &mut Self {
        self.run(0.0, |s, step, patch| s.refresh(patch, step));
        self
    }

    /// Stress update of a leapfrog step of `dt` [s], by the velocity gradient in its columns.
    pub(crate) fn update_stress(&mut self, dt: f64) -> &mut Self {
        self.run(dt, |s, step, patch| s.update_stress(patch, step));
        self
    }

    /// Number of cells whose particles may change in this step.
    pub(crate) fn active_cells(&mut self) -> usize {
        self.run(0.0, |s, step, patch| s.find_active(patch, step.effects));
        self.patch.block.active.count()
    }

    /// Gathers the results of a mid-point step of `dt` [s] from the nodes.
    pub(crate) fn gather_midpoint(&mut self, dt: f64) -> &mut Self {
        self.run(dt, |s, step, patch| s.gather_midpoint(patch, step.dt));
        self
    }

    /// Finds the cells of the particles where they are, copies ghosts, and runs phases with
    /// exchanges of nodal values.
    pub(crate) fn nodal(
        &mut self,
        dt: f64,
        phases: impl Fn(&Stepper<D>, &StepContext<'_, D>, &mut Nodal<'_, D>) + Send + Sync,
    ) -> &mut Self {
        self.place();
        self.run(dt, |s, step, patch| s.find_cells(patch, 0.0, step.jacobian));
        let time = self.time;
        self.world(|s, world| {
            let step = context(s, time, dt);
            world.exchange_particles(|nodal| phases(s, &step, nodal)).expect("particles stay near");
        });
        self
    }

    /// Nodal sums of the particles where they are, with forces.
    pub(crate) fn scatter(&mut self, dt: f64) -> &mut Self {
        self.nodal(dt, |s, step, nodal| nodal.each("scatter", |patch| s.scatter(patch, true, step)))
    }

    /// Nodal sums, then the nodal velocities at the start and at the end of a step of `dt` [s].
    pub(crate) fn solve(&mut self, dt: f64) -> &mut Self {
        self.nodal(dt, |s, step, nodal| {
            nodal.each("scatter", |patch| {
                s.scatter(patch, true, step);
                if s.relaxation.is_some() {
                    s.start_pressure(patch);
                }
                s.effects.act(Phase::NodalStart, step, patch);
            });
            solve(s, step, nodal);
        })
    }

    /// Weights of the particles where they are, and nodal velocities that are linear in the
    /// position: at the start and at the end of the step `start` and `end`, a value at the origin
    /// and the gradient of each component.
    pub(crate) fn set_flow(&mut self, start: [(f64, [f64; D]); D], end: [(f64, [f64; D]); D]) {
        self.scatter(0.0);
        let (s, f) = (&self.stepper, &self.stepper.fields);
        let nodes = self.patch.nodes.nodes;
        let fields = [(f.lumped_velocity, start), (f.velocity, start), (f.velocity_star, end)];
        for (field, flow) in fields {
            for (a, (origin, slope)) in flow.into_iter().enumerate() {
                for index in nodes.iter() {
                    let place = |b: usize| s.lower[b] + index[b] as f64 * s.cell[b];
                    let along = (0..D).map(|b| slope[b] * place(b)).sum::<f64>();
                    self.patch.nodes.fields[field + a][nodes.flat(index)] = origin + along;
                }
            }
        }
    }

    /// One whole step of `dt` [s], number 1 of the run.
    pub(crate) fn advance(&mut self, dt: f64) -> &mut Self {
        let time = self.time;
        self.world(|s, world| {
            s.advance(world, time, dt, 2.5 * dt, 1).expect("particles stay near")
        });
        self
    }

    /// Sum of an account over the particles, in a scene whose grid moves at `grid_velocity` [m/s].
    pub(crate) fn account(&self, account: Account, grid_velocity: [f64; D]) -> f64 {
        let block = &self.patch.block;
        let mut sum = 0.0;
        for effect in self.stepper.effects.iter() {
            effect.totals(block, 0..block.own(), grid_velocity, &mut |of, values| {
                sum += if of == account { values.iter().sum::<f64>() } else { 0.0 };
            });
        }
        sum
    }

    /// First fault that the kernels have reported.
    pub(crate) fn fault(&self) -> Option<&str> {
        self.patch.report.fault.as_ref().map(|fault| fault.what.as_str())
    }
}

impl Fixture<1> {
    /// Values of a nodal field at consecutive nodes.
    pub(crate) fn line(&self, field: &str, nodes: std::ops::RangeInclusive<i64>) -> Vec<f64> {
        nodes.map(|i| self.node(field, [i])).collect()
    }
}

fn context<const D: usize>(stepper: &Stepper<D>, start: f64, dt: f64) -> StepContext<'_, D> {
    let time = if stepper.stepping == Stepping::Midpoint { start + 0.5 * dt } else { start };
    let jacobian = stepper.columns.jacobian_mid.unwrap_or(stepper.columns.jacobian);
    stepper.context([start, time], dt, jacobian)
}

/// From the nodal sums to the nodal velocities of a step.
pub(crate) fn solve<const D: usize>(
    s: &Stepper<D>,
    step: &StepContext<'_, D>,
    nodal: &mut Nodal<'_, D>,
) {
    s.solve_velocity(nodal, step.effects, step.dt, s.relaxation.is_some());
    s.solve_friction(nodal, step);
    if s.compatible {
        s.solve_work(nodal, step.effects);
    }
    s.effects.solve(step, nodal);
    s.solve_friction_heat(nodal, step.dt);
    // values at the nodes that only ghosts reach have been exchanged by the next phase
    nodal.each("end", |_| {});
}

/// Asserts that values are those expected, to rounding.
#[track_caller]
pub(crate) fn close(found: &[f64], exact: &[f64]) {
    assert_eq!(found.len(), exact.len(), "{found:?} and {exact:?}");
    let scale = exact.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let scale = if scale > 0.0 { scale } else { 1.0 };
    let same = found.iter().zip(exact).all(|(x, y)| (x - y).abs() <= 1e-13 * scale);
    assert!(same, "{found:?} instead of {exact:?}");
}

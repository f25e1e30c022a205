//! The columns of a particle row, declared once, and the filling of bodies.
//!
//! Which columns there are follows from what the scene names: an effect that it does not name
//! has none.

use decomp::{Block, ColumnSpec, IndexBox, Layout, Mirror};
use nalgebra::SVector;

use crate::effects::burn::Front;
use crate::scene::{BodyForce, CheckedScene, Eos, FrameKind, Side, Stepping, Transfer};
use crate::solver::shape::Extent;

/// Where each column stands in a block. Vectors take D columns that follow each other, tensors
/// D^2, row by row; their number is that of the first.
#[derive(Clone, Debug)]
pub struct Columns {
    /// The declarations, in order.
    pub specs: Vec<ColumnSpec>,
    /// Position x [m], a vector.
    pub position: usize,
    /// First place X [m], a vector, in the total-Lagrangian frame.
    pub reference: Option<usize>,
    /// Inverse of the deformation gradient that pushes gradients forward [-], a tensor, scratch, in
    /// the total-Lagrangian frame.
    pub push: Option<usize>,
    /// Velocity [m/s], a vector.
    pub velocity: usize,
    /// Mass [kg] (in 1-D per unit area, kg/m2; in a plane per unit depth, kg/m, or
    /// per radian).
    pub mass: usize,
    /// Volume at J = 1 [m3] (in 1-D per unit area, m; in a plane per unit depth, m2, or
    /// per radian).
    pub volume0: usize,
    /// Volume ratio J = V/V0 [-].
    pub jacobian: usize,
    /// Specific internal energy e [J/kg].
    pub energy: usize,
    /// Number of the body.
    pub body: usize,
    /// Divergence of the velocity D of the last step [1/s].
    pub gradient: usize,
    /// Sound speed c [m/s].
    pub sound_speed: usize,
    /// Pressure p without artificial viscosity [Pa].
    pub pressure: usize,
    /// Artificial viscosity q [Pa], with viscosity.
    pub viscosity: Option<usize>,
    /// What the limiter takes away, phi in [0, 1], with a limiter.
    pub limiter: Option<usize>,
    /// Affine part of the velocity [1/s], a tensor, with APIC.
    pub affine: Option<usize>,
    /// Half lengths of the particle along each direction at the start [m], a vector, in a plane
    /// for shape functions that look at its domain.
    pub half_lengths: Option<usize>,
    /// Deformation gradient F [-], a tensor, in a plane where the domain deforms or a body is a
    /// solid.
    pub deformation: Option<usize>,
    /// Gradient of the velocity of the last step [1/s], a tensor, where there is a deformation or
    /// in a plane a transmitting side.
    pub velocity_gradient: Option<usize>,
    /// Cauchy stress without artificial viscosity [Pa], positive in tension, where a body is a
    /// solid: xx, and in a plane yy and xy.
    pub stress: Option<usize>,
    /// Place in the cell [cells], a vector, scratch.
    pub fraction: usize,
    /// Length for the shape function, in a plane half edges of the domain [cells], scratch.
    pub domain: usize,
    /// Volume [cells], scratch, with an edge mask or contact: on a line the deformed length itself.
    pub filled: Option<usize>,
    /// Current volume [cells] that contact looks at, scratch: in the updated frame that of `filled`.
    pub room: Option<usize>,
    /// Displacement at the time of the forces [m], a vector, scratch, with contact in the
    /// total-Lagrangian frame.
    pub shift: Option<usize>,
    /// Distance from the axis at the time of the forces [m], scratch, in the total-Lagrangian frame
    /// about an axis; negative in images beyond it.
    pub radius: Option<usize>,
    /// Half edges of the deformed parallelogram [cells], two vectors, scratch, where a plane's
    /// domains deform or touch: those of the shape function, if it looks at them.
    pub half_edges: Option<usize>,
    /// (p + q) V [J], scratch. Where a body is a solid and in a plane, the tensor (q - sigma) V:
    /// xx, yy, xy, and about an axis zz.
    pub stress_volume: usize,
    /// Components of it.
    pub stress_volumes: usize,
    /// What the particle has been pressed with, up to a most [Pa s], with contact.
    pub pressed: Option<usize>,
    /// What a body force takes, with one.
    pub body_force: Option<BodyForceColumns>,
    /// Force of inertia at the middle of the step [N], a vector, scratch, where the grid accelerates.
    pub frame_force: Option<usize>,
    /// What a transmitting side looks at, with one.
    pub side: Option<SideColumns>,
    /// What a side loaded by a pressure looks at, with one.
    pub load: Option<LoadColumns>,
    /// Distension alpha = v/v_solid [-], where a body is porous.
    pub distension: Option<usize>,
    /// What an explosive takes, where one burns.
    pub burn: Option<BurnColumns>,
    /// J at the middle of the step, scratch, with mid-point stepping.
    pub jacobian_mid: Option<usize>,
    /// What strength takes, where a body has it.
    pub strength: Option<StrengthColumns>,
    /// What failure takes, where a body may fail.
    pub failure: Option<FailureColumns>,
    /// What temperature takes, where a body has one.
    pub thermal: Option<ThermalColumns>,
    /// Pressure at the middle of the step [Pa], scratch, with pressure relaxation.
    pub pressure_mid: Option<usize>,
    /// -dV/dp at the middle of the step [m3/Pa], scratch, with pressure relaxation.
    pub compliance: Option<usize>,
}

/// Where the columns of strength stand.
#[derive(Clone, Copy, Debug)]
pub struct StrengthColumns {
    /// Deviator of the Cauchy stress [Pa]: xx, and in a plane yy and xy.
    pub deviator: usize,
    /// Equivalent plastic strain [-].
    pub plastic_strain: usize,
    /// Gradient of the velocity during the step [1/s], a tensor, and about an axis its divergence,
    /// scratch.
    pub rate: usize,
    /// Specific internal energy at the middle of the step but for the work of pressure [J/kg],
    /// scratch.
    pub energy_mid: usize,
    /// Plastic strain after the step, then that of the step [-], scratch.
    pub plastic_increment: usize,
    /// Plastic work of the step per volume [J/m3], scratch.
    pub plastic_work: usize,
}

/// Where the columns of failure stand.
#[derive(Clone, Copy, Debug)]
pub struct FailureColumns {
    /// Damage [-]: from 1 on the particle bears neither tension nor shear.
    pub damage: usize,
    /// Elastic energy that failure has set free as heat [J].
    pub released: usize,
}

/// Where the columns of temperature stand.
#[derive(Clone, Copy, Debug)]
pub struct ThermalColumns {
    /// Temperature [K]; 0 in bodies that have none.
    pub temperature: usize,
    /// Plastic work that does not heat [J/kg], where there is any.
    pub stored: Option<usize>,
    /// What conduction takes, with it.
    pub conduction: Option<ConductionColumns>,
    /// Heat that conduction has brought so far [J], where a side is held at a temperature.
    pub received: Option<usize>,
}

/// Where the columns of heat conduction stand, both of them scratch.
#[derive(Clone, Copy, Debug)]
pub struct ConductionColumns {
    /// m cv [J/K].
    pub capacity: usize,
    /// k V [W m/K].
    pub conductance: usize,
}

/// Where the columns of an explosive stand.
#[derive(Clone, Copy, Debug)]
pub struct BurnColumns {
    /// When the front reaches the particle [s]; -1 for what does not burn.
    pub lighting_time: usize,
    /// Burnt fraction F [-].
    pub fraction: usize,
}

/// Where the columns of a body force stand.
#[derive(Clone, Copy, Debug)]
pub struct BodyForceColumns {
    /// m b at the middle of the step [N], a vector, scratch.
    pub force: usize,
    /// Its work so far [J].
    pub work: usize,
    /// Its impulse so far [N s], a vector.
    pub impulse: usize,
    /// First place X [m], a vector, where the force depends on it.
    pub reference: Option<usize>,
}

/// Where the columns that a transmitting side looks at stand.
#[derive(Clone, Copy, Debug)]
pub struct SideColumns {
    /// Volume at the time of the forces [m3], scratch.
    pub volume: usize,
    /// Impedance of a compression wave that leaves [Pa s/m], scratch.
    pub impedance: usize,
    /// Gradient of the velocity at the middle of the step [1/s], a tensor, scratch.
    pub gradient: usize,
    /// The same at the end of the step before the last.
    pub gradient_before: usize,
}

/// Where the columns that a side loaded by a pressure looks at stand.
#[derive(Clone, Copy, Debug)]
pub struct LoadColumns {
    /// Volume at the time of the forces [m3], scratch.
    pub volume: usize,
    /// The sides that press on a particle of the surface, a sum of powers of two; see
    /// [`load_bit`].
    pub mark: usize,
}

/// What marks a particle that the side at the lower or upper `end` of direction `axis` presses on.
pub fn load_bit(axis: usize, end: usize) -> u8 {
    1 << (2 * axis + end)
}

impl Columns {
    /// Bytes that the watch holds of a particle's last good state, in so many dimensions.
    pub fn held_bytes(&self, dimension: usize) -> usize {
        8 + 4 * dimension + 8 * self.specs.iter().filter(|s| s.state).count()
    }

    /// The columns that `scene` calls for.
    pub fn new(scene: &CheckedScene) -> Self {
        let mut specs = Vec::new();
        // the first of columns that follow each other
        let mut add_all =
            |names: &[&'static str], unit, ghost, state, mirrors: &dyn Fn(usize) -> Mirror| {
                let first = specs.len();
                specs.extend(names.iter().enumerate().map(|(k, &name)| ColumnSpec {
                    name,
                    unit,
                    ghost,
                    state,
                    mirror: mirrors(k),
                }));
                first
            };
        let method = &scene.scene.method;
        let plane = scene.dimension > 1;
        let vector =
            |names: &'static [&'static str; 3]| if plane { &names[1..] } else { &names[..1] };
        let extent = Extent::of(method.shape);
        let midpoint = method.stepping == Stepping::Midpoint;
        let viscous = scene.scene.artificial_viscosity;
        let limited = viscous.is_some_and(|v| v.limiter.is_some());
        let relaxed = method.pressure_relaxation.is_some();
        let touching = scene.velocity_fields() > 1;
        let transmits = scene.transmits();
        let total = method.frame == FrameKind::TotalLagrangian;
        let same = |_: usize| Mirror::Same;
        let of_vector = |a: usize| Mirror::Negate(a);
        let of_tensor =
            |k: usize| if k.is_multiple_of(3) { Mirror::Same } else { Mirror::NegatePair(0, 1) };
        let of_stress = |k: usize| if k == 2 { Mirror::NegatePair(0, 1) } else { Mirror::Same };
        const HALF_EDGES: [&str; 4] =
            ["cell_edge1_x", "cell_edge1_y", "cell_edge2_x", "cell_edge2_y"];
        let domains: &[&str] = match (plane, extent) {
            (false, _) => &["cell_length"],
            (true, Extent::Point) => &[],
            (true, Extent::Undeformed) => &["cell_width", "cell_height"],
            (true, Extent::Current) => &HALF_EDGES,
        };
        let affine: &[&str] = match plane {
            false => &["affine_velocity"],
            true => &["affine_xx", "affine_xy", "affine_yx", "affine_yy"],
        };
        const DEFORMATION: [&str; 4] =
            ["deformation_xx", "deformation_xy", "deformation_yx", "deformation_yy"];
        const GRADIENT: [&str; 4] = [
            "velocity_gradient_xx",
            "velocity_gradient_xy",
            "velocity_gradient_yx",
            "velocity_gradient_yy",
        ];
        const FORCE: [&str; 3] = ["body_force", "body_force_x", "body_force_y"];
        const IMPULSE: [&str; 3] =
            ["body_force_impulse", "body_force_impulse_x", "body_force_impulse_y"];
        const INERTIA: [&str; 3] = ["frame_force", "frame_force_x", "frame_force_y"];
        const REFERENCE: [&str; 3] =
            ["reference_position", "reference_position_x", "reference_position_y"];
        const FIRST: [&str; 3] =
            ["material_position", "material_position_x", "material_position_y"];
        const SHIFT: [&str; 3] = ["displacement", "displacement_x", "displacement_y"];
        const PUSH: [&str; 4] = [
            "inverse_deformation_xx",
            "inverse_deformation_xy",
            "inverse_deformation_yx",
            "inverse_deformation_yy",
        ];
        const SIDE_GRADIENT: [&str; 4] =
            ["side_gradient_xx", "side_gradient_xy", "side_gradient_yx", "side_gradient_yy"];
        const SIDE_GRADIENT_BEFORE: [&str; 4] = [
            "side_gradient_before_xx",
            "side_gradient_before_xy",
            "side_gradient_before_yx",
            "side_gradient_before_yy",
        ];
        const DEVIATOR: [&str; 3] = ["deviator_xx", "deviator_yy", "deviator_xy"];
        const RATE: [&str; 5] = ["rate_xx", "rate_xy", "rate_yx", "rate_yy", "rate_divergence"];
        const STRESS: [&str; 3] = ["stress_xx", "stress_yy", "stress_xy"];
        const STRESS_VOLUME: [&str; 4] =
            ["stress_volume_xx", "stress_volume_yy", "stress_volume_xy", "stress_volume_zz"];
        let seen = plane && extent == Extent::Current;
        // where bodies touch is where their domains do, whatever the shape function looks at
        let deforms = (seen && !total) || (plane && touching);
        let solids = scene.has_solids();
        let strained = deforms || (plane && (solids || total));
        let position = vector(&["position", "position_x", "position_y"]);
        let velocity = vector(&["velocity", "velocity_x", "velocity_y"]);
        let fraction = vector(&["cell_fraction", "cell_fraction_x", "cell_fraction_y"]);
        let complement = |a: usize| Mirror::Complement(a);
        let of_edge = |k: usize| Mirror::Negate(k % 2);
        let of_domain = |k: usize| if seen { of_edge(k) } else { Mirror::Same };
        let mut add =
            |name: &'static str, unit, ghost, state| add_all(&[name], unit, ghost, state, &same);
        let [mass, volume0, jacobian, energy, body, gradient, sound_speed, pressure] = [
            ("mass", "kg", true),
            ("volume0", "m3", false),
            ("jacobian", "", false),
            ("specific_internal_energy", "J/kg", false),
            // its ghosts stand in their body's velocity field, or show its state at rest
            ("body", "", touching || transmits),
            ("velocity_gradient", "1/s", false),
            ("sound_speed", "m/s", false),
            ("pressure", "Pa", false),
        ]
        .map(|(name, unit, ghost)| add(name, unit, ghost, true));
        let viscosity = viscous.map(|_| add("artificial_viscosity", "Pa", false, true));
        let limiter = limited.then(|| add("viscosity_limiter", "", false, true));
        let components = match (plane && solids, scene.axisymmetric()) {
            (false, _) => &["stress_volume"][..],
            (true, false) => &STRESS_VOLUME[..3],
            (true, true) => &STRESS_VOLUME,
        };
        let stress_volume = add_all(components, "J", true, false, &of_stress);
        let mut add =
            |name: &'static str, unit, ghost, state| add_all(&[name], unit, ghost, state, &same);
        let jacobian_mid = midpoint.then(|| add("jacobian_mid", "", false, false));
        let pressure_mid = relaxed.then(|| add("pressure_mid", "Pa", true, false));
        let compliance = relaxed.then(|| add("compliance", "m3/Pa", true, false));
        let filled = method.edge_mask.is_some() || (touching && !total);
        // on a line what they fill is the length that such shape functions look at
        let is_length = !plane && (extent == Extent::Current || total);
        let volume = (filled && !is_length).then(|| add("cell_volume", "", true, false));
        let moves = total && touching;
        let room = moves.then(|| add("current_volume", "", true, false));
        let shift = moves.then(|| add_all(vector(&SHIFT), "m", true, false, &of_vector));
        let radius = (total && scene.axisymmetric())
            .then(|| add_all(&["radius"], "m", true, false, &|_| Mirror::Negate(0)));
        let domain = add_all(domains, "", true, false, &of_domain);
        let reference = total.then(|| add_all(vector(&FIRST), "m", false, true, &same));
        let push = total
            .then(|| add_all(if plane { &PUSH } else { &PUSH[..1] }, "", true, false, &of_tensor));
        let body_force = scene.scene.body_force.as_ref().map(|force| BodyForceColumns {
            force: add_all(vector(&FORCE), "N", true, false, &of_vector),
            work: add_all(&["body_force_work"], "J", false, true, &same),
            impulse: add_all(vector(&IMPULSE), "N s", false, true, &of_vector),
            reference: matches!(force, BodyForce::Vortex(_)).then(|| {
                reference.unwrap_or_else(|| add_all(vector(&REFERENCE), "m", false, true, &same))
            }),
        });
        let frame_force =
            scene.accelerates().then(|| add_all(vector(&INERTIA), "N", true, false, &of_vector));
        let pressed = touching.then(|| add_all(&["contact_impulse"], "Pa s", true, true, &same));
        let side = transmits.then(|| SideColumns {
            volume: add_all(&["side_volume"], "m3", true, false, &same),
            impedance: add_all(&["side_impedance"], "Pa s/m", true, false, &same),
            gradient: add_all(
                if plane { &SIDE_GRADIENT } else { &SIDE_GRADIENT[..1] },
                "1/s",
                true,
                false,
                &of_tensor,
            ),
            gradient_before: add_all(
                if plane { &SIDE_GRADIENT_BEFORE } else { &SIDE_GRADIENT_BEFORE[..1] },
                "1/s",
                false,
                true,
                &of_tensor,
            ),
        });
        let load = scene.is_loaded().then(|| LoadColumns {
            volume: add_all(&["load_volume"], "m3", true, false, &same),
            mark: add_all(&["load_mark"], "", true, true, &same),
        });
        let materials = || (0..scene.scene.bodies.len()).map(|i| scene.material_of(i));
        let shears = materials().any(|m| m.strength.is_some());
        let strength = shears.then(|| StrengthColumns {
            deviator: add_all(
                if plane { &DEVIATOR } else { &DEVIATOR[..1] },
                "Pa",
                false,
                true,
                &of_stress,
            ),
            plastic_strain: add_all(&["plastic_strain"], "", false, true, &same),
            rate: {
                let names = if plane { &RATE[..4] } else { &RATE[..1] };
                let first = add_all(names, "1/s", false, false, &of_tensor);
                if scene.axisymmetric() {
                    add_all(&RATE[4..], "1/s", false, false, &same);
                }
                first
            },
            energy_mid: add_all(&["energy_mid"], "J/kg", false, false, &same),
            plastic_increment: add_all(&["plastic_increment"], "", false, false, &same),
            plastic_work: add_all(&["plastic_work"], "J/m3", false, false, &same),
        });
        let fails = materials().any(|m| m.failure.is_some());
        let failure = fails.then(|| FailureColumns {
            damage: add_all(&["damage"], "", false, true, &same),
            released: add_all(&["released_energy"], "J", false, true, &same),
        });
        let stores = materials().any(|m| m.stores_work());
        let (conducts, held) = (scene.conducts(), scene.holds_temperature());
        let thermal = materials().any(|m| m.thermal.is_some()).then(|| ThermalColumns {
            temperature: add_all(&["temperature"], "K", conducts, true, &same),
            stored: stores.then(|| add_all(&["stored_work"], "J/kg", false, true, &same)),
            conduction: conducts.then(|| ConductionColumns {
                capacity: add_all(&["heat_capacity"], "J/K", true, false, &same),
                conductance: add_all(&["heat_conductance"], "W m/K", true, false, &same),
            }),
            received: held.then(|| add_all(&["heat_received"], "J", false, true, &same)),
        });
        let porous = scene.has_eos(|eos| matches!(eos, Eos::PAlpha { .. }));
        let distension = porous.then(|| add_all(&["distension"], "", false, true, &same));
        let burns = scene.has_eos(|eos| eos.burn().is_some_and(|b| b.front().is_some()));
        let burn = burns.then(|| BurnColumns {
            lighting_time: add_all(&["lighting_time"], "s", false, true, &same),
            fraction: add_all(&["burn_fraction"], "", false, true, &same),
        });
        let half_edges = deforms.then(|| match seen {
            true => domain,
            false => add_all(&HALF_EDGES, "", true, false, &of_edge),
        });
        Columns {
            reference,
            push,
            strength,
            failure,
            thermal,
            distension,
            burn,
            pressed,
            body_force,
            frame_force,
            side,
            load,
            room: room.or(volume).or(filled.then_some(domain)).filter(|_| touching),
            shift,
            radius,
            filled: volume.or(filled.then_some(domain)),
            half_edges,
            domain,
            position: add_all(position, "m", false, true, &same),
            velocity: add_all(velocity, "m/s", true, true, &of_vector),
            affine: (method.transfer == Transfer::Apic)
                .then(|| add_all(affine, "1/s", true, true, &of_tensor)),
            half_lengths: (plane && (extent != Extent::Point || touching))
                .then(|| add_all(&["half_width", "half_height"], "m", false, true, &same)),
            deformation: strained.then(|| add_all(&DEFORMATION, "", false, true, &of_tensor)),
            velocity_gradient: (strained || (plane && transmits))
                .then(|| add_all(&GRADIENT, "1/s", false, true, &of_tensor)),
            stress: solids.then(|| {
                let names = if plane { &STRESS[..] } else { &STRESS[..1] };
                add_all(names, "Pa", false, true, &of_stress)
            }),
            fraction: add_all(fraction, "", true, false, &complement),
            mass,
            volume0,
            jacobian,
            energy,
            body,
            gradient,
            sound_speed,
            pressure,
            viscosity,
            limiter,
            stress_volume,
            stress_volumes: components.len(),
            jacobian_mid,
            pressure_mid,
            compliance,
            specs,
        }
    }

    /// The columns that are part of the state.
    pub fn state(&self) -> Vec<usize> {
        (0..self.specs.len()).filter(|&c| self.specs[c].state).collect()
    }
}

/// Centres of the equal boxes that `counts` of them in each direction cut a box into; the first
/// direction runs fastest.
fn lattice<const D: usize>(
    lower: SVector<f64, D>,
    upper: SVector<f64, D>,
    counts: [usize; D],
) -> impl Iterator<Item = SVector<f64, D>> {
    let size = upper - lower;
    IndexBox::new([0; D], counts.map(|n| n as i64)).iter().map(move |k| {
        let share = |a: usize| (2 * k[a] + 1) as f64 / (2 * counts[a]) as f64;
        lower + size.component_mul(&SVector::from_fn(|a, _| share(a)))
    })
}

/// Fills the bodies with particles, keeping those whose patch is on `rank`: a block a patch of
/// the rank. Ids number the particles of all bodies in order, whatever the layout. Velocities
/// are those seen from a grid that travels at `grid_velocity` [m/s]; `energy` gives the specific
/// internal energy at which a body is at a pressure [J/kg], and `pressed` what it has been pressed
/// with [Pa s].
///
/// A body's particles tile it: those of a box have equal shares of its volume and mass to rounding.
pub fn fill<const D: usize>(
    scene: &CheckedScene,
    columns: &Columns,
    layout: &Layout<D>,
    rank: usize,
    grid_velocity: [f64; D],
    energy: &dyn Fn(usize, f64) -> f64,
    pressed: &dyn Fn(usize, f64) -> f64,
) -> Vec<Block<D>> {
    let mine = layout.patches_of(rank);
    let mut blocks: Vec<Block<D>> = mine.iter().map(|_| Block::new(&columns.specs)).collect();
    let mut place = vec![None; layout.patches().len()];
    for (k, &p) in mine.iter().enumerate() {
        place[p] = Some(k);
    }
    let mut row = vec![0.0; columns.specs.len()];
    let mut id = 0u64;
    for (number, (body, checked)) in scene.scene.bodies.iter().zip(&scene.bodies).enumerate() {
        let density = scene.scene.materials[&body.material].density;
        let front = Front::of(&scene.scene.materials[&body.material].eos);
        let mut add = |centre: [f64; D], size: [f64; D], volume: f64| {
            let cell = cell_of(scene, centre);
            let patch = layout.wrap_cell(cell).map(|c| layout.patch_of(c));
            id += 1;
            let Some(block) = patch.and_then(|p| place[p]) else { return };
            let volume = if scene.axisymmetric() { volume * centre[0] } else { volume };
            row.fill(0.0);
            for a in 0..D {
                row[columns.position + a] = centre[a];
                row[columns.velocity + a] = checked.velocity[a] - grid_velocity[a];
            }
            let mut pressure = body.pressure;
            if let Some(motion) = &checked.motion {
                let place = std::array::from_fn(|a| if a < D { centre[a] } else { 0.0 });
                let velocity = motion.velocity(place);
                for a in 0..D {
                    row[columns.velocity + a] = velocity[a] - grid_velocity[a];
                }
                if let Some(affine) = columns.affine {
                    let gradient = motion.gradient(place, size[0]);
                    (0..D * D).for_each(|k| row[affine + k] = gradient[k / D][k % D]);
                }
                pressure = motion.pressure(place).unwrap_or(pressure);
            }
            let first = columns.body_force.and_then(|c| c.reference).or(columns.reference);
            if let Some(reference) = first {
                (0..D).for_each(|a| row[reference + a] = centre[a]);
            }
            row[columns.mass] = density * volume;
            row[columns.volume0] = volume;
            row[columns.jacobian] = 1.0;
            row[columns.energy] = energy(number, pressure);
            if let (Some(c), Some(thermal)) = (columns.thermal, &scene.material_of(number).thermal)
            {
                row[c.temperature] = body.temperature.unwrap_or(thermal.reference_temperature);
            }
            if let Some(distension) = columns.distension {
                row[distension] = scene.material_of(number).distension();
            }
            if let Some(burn) = columns.burn {
                row[burn.lighting_time] = front.as_ref().map_or(-1.0, |f| f.lighting_time(&centre));
            }
            if let Some(load) = columns.load {
                row[load.mark] = f64::from(load_mark(scene, centre, size));
            }
            row[columns.body] = number as f64;
            if let Some(column) = columns.pressed {
                row[column] = pressed(number, pressure);
            }
            if let Some(half_lengths) = columns.half_lengths {
                (0..D).for_each(|a| row[half_lengths + a] = 0.5 * size[a]);
            }
            if let Some(deformation) = columns.deformation {
                (0..D).for_each(|a| row[deformation + (D + 1) * a] = 1.0);
            }
            blocks[block].push(id - 1, cell.map(|c| c as i32), &row);
        };
        match &checked.tiles {
            Some(tiles) => tiles.iter().for_each(|tile| {
                let first = |v: [f64; 2]| std::array::from_fn(|a| v[a]);
                add(first(tile.centre), first(tile.size), tile.area);
            }),
            None => {
                let lower = SVector::from(std::array::from_fn::<f64, D, _>(|a| checked.lower[a]));
                let upper = SVector::from(std::array::from_fn::<f64, D, _>(|a| checked.upper[a]));
                let counts = std::array::from_fn(|a| checked.lattice[a]);
                let size = std::array::from_fn(|a| (upper - lower)[a] / counts[a] as f64);
                for centre in lattice(lower, upper, counts) {
                    add(centre.into(), size, size.iter().product());
                }
            }
        }
    }
    for block in &mut blocks {
        block.sort_own();
    }
    blocks
}

/// The mark of the sides that press on a particle.
fn load_mark<const D: usize>(scene: &CheckedScene, centre: [f64; D], size: [f64; D]) -> u8 {
    let (domain, sides) = (&scene.scene.domain, scene.sides::<D>());
    let pressing = (0..D).flat_map(|a| [(a, 0), (a, 1)]).filter(|&(a, end)| {
        let at = if end == 0 { domain.lower[a] } else { domain.upper[a] };
        // of the particles of a body up to the side those at its end
        matches!(sides[a][end], Side::Pressure(_)) && (centre[a] - at).abs() < 0.75 * size[a]
    });
    pressing.map(|(a, end)| load_bit(a, end)).sum()
}

/// Particles in each slice of cells across `axis`, counted without making them.
pub fn slices(scene: &CheckedScene, axis: usize) -> Vec<u64> {
    let (lower, size) = (scene.scene.domain.lower[axis], scene.cell_size[axis]);
    let mut counts = vec![0.0; scene.cells[axis]];
    for body in &scene.bodies {
        if let Some(tiles) = &body.tiles {
            for tile in tiles.iter() {
                let cell = ((tile.centre[axis] - lower) / size) as usize;
                counts[cell.min(scene.cells[axis] - 1)] += 1.0;
            }
            continue;
        }
        let (from, to) = (body.lower[axis], body.upper[axis]);
        let per_length = body.particles as f64 / (to - from);
        for (cell, count) in counts.iter_mut().enumerate() {
            let x = lower + cell as f64 * size;
            *count += ((to.min(x + size) - from.max(x)).max(0.0) * per_length).round();
        }
    }
    counts.into_iter().map(|count| count as u64).collect()
}

/// The cell of a place.
pub fn cell_of<const D: usize>(scene: &CheckedScene, x: [f64; D]) -> [i64; D] {
    let lower = &scene.scene.domain.lower;
    std::array::from_fn(|a| ((x[a] - lower[a]) * (1.0 / scene.cell_size[a])).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_has_the_centres_of_its_boxes() {
        let lower = SVector::from([-1.0, 0.0]);
        let places: Vec<_> = lattice(lower, SVector::from([1.0, 3.0]), [2, 3]).collect();
        assert_eq!(places.len(), 6);
        assert_eq!(places[0], SVector::from([-0.5, 0.5]));
        assert_eq!(places[1], SVector::from([0.5, 0.5]));
        assert_eq!(places[5], SVector::from([0.5, 2.5]));
    }
}

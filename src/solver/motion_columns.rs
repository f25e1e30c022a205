//! Columns of the motion itself; effects declare their own.

use decomp::Mirror;

use super::columns::{Columns, SpinColumns};
use super::declare::{Declare, Role, symmetric_mirror};
use super::effect::Registry;
use super::parts::StepPart;
use super::scheme::relaxes_ratio;
use crate::scene::{CheckedScene, FrameKind, Normals, Stepping};
use crate::shape::DomainExtent;

use Role::{GhostScratch, GhostState, Scratch, State};

/// Names of the half edges of a particle's parallelogram.
const HALF_EDGES: [&str; 4] = ["cell_edge1_x", "cell_edge1_y", "cell_edge2_x", "cell_edge2_y"];

/// Properties of a scene on which the columns of the motion depend.
struct Needs {
    plane: bool,
    extent: DomainExtent,
    /// Whether bodies have separate velocity fields.
    touching: bool,
    /// Whether particles carry the faces of their bodies.
    carries_faces: bool,
    total_lagrangian: bool,
    /// Whether the shape function depends on the parallelogram of a particle.
    parallelograms: bool,
    /// Whether parallelograms deform. They decide whether bodies touch, for any shape function.
    deforms: bool,
    solids: bool,
}

impl Needs {
    fn of(scene: &CheckedScene) -> Self {
        let method = &scene.scene.method;
        let plane = scene.dimension > 1;
        let extent = method.shape.extent();
        let touching = scene.velocity_fields() > 1;
        let total_lagrangian = method.frame == FrameKind::TotalLagrangian;
        let parallelograms = plane && extent == DomainExtent::Current;
        let condition = scene.scene.contact.and_then(|contact| contact.condition());
        let normals = condition.map(|condition| condition.normals);
        Needs {
            plane,
            extent,
            touching,
            carries_faces: plane && touching && normals.is_some_and(Normals::uses_faces),
            total_lagrangian,
            parallelograms,
            deforms: (parallelograms && !total_lagrangian) || (plane && touching),
            solids: scene.has_solids(),
        }
    }
}

impl Columns {
    /// Columns that `scene` needs, for the motion and for the effects of `R`.
    pub fn new<R: Registry>(scene: &CheckedScene) -> Self {
        let mut d = Declare::new(scene);
        R::declare(scene, &mut d);
        let needs = Needs::of(scene);
        declare_state(&mut d, &needs);
        declare_viscosity(&mut d);
        declare_relaxation(&mut d);
        declare_stress(&mut d, &needs);
        declare_contact(&mut d, &needs);
        declare_friction(&mut d, &needs);
        declare_affine(&mut d, &needs);
        declare_spin(&mut d);
        declare_domains(&mut d, &needs);
        declare_places(&mut d, &needs);
        declare_gradients(&mut d, &needs);
        d.columns
    }
}

fn declare_state(d: &mut Declare<'_>, needs: &Needs) {
    d.set_owner(None);
    d.columns.mass = d.scalar("mass", "kg", GhostState);
    d.columns.volume0 = d.scalar("volume0", "m3", State);
    d.columns.jacobian = d.scalar("jacobian", "", State);
    d.columns.energy = d.scalar("specific_internal_energy", "J/kg", State);
    // a ghost belongs to the velocity field of its body
    let of_ghosts = if needs.touching || d.ghost_bodies { GhostState } else { State };
    d.columns.body = d.scalar("body", "", of_ghosts);
    d.columns.divergence = d.scalar("velocity_gradient", "1/s", State);
    d.columns.sound_speed = d.scalar("sound_speed", "m/s", State);
    d.columns.pressure = d.scalar("pressure", "Pa", State);
    if d.scene.scene.method.stepping == Stepping::Midpoint {
        let role = if relaxes_ratio(d.scene) { GhostScratch } else { Scratch };
        d.columns.jacobian_mid = Some(d.scalar("jacobian_mid", "", role));
    }
}

fn declare_viscosity(d: &mut Declare<'_>) {
    d.set_owner(Some(StepPart::Viscosity as usize));
    let Some(viscosity) = d.scene.scene.artificial_viscosity else { return };
    d.columns.viscosity = Some(d.scalar("artificial_viscosity", "Pa", State));
    if viscosity.limiter.is_some() {
        d.columns.limiter = Some(d.scalar("viscosity_limiter", "", State));
    }
}

fn declare_relaxation(d: &mut Declare<'_>) {
    if d.scene.scene.method.pressure_relaxation.is_some() {
        d.set_owner(Some(StepPart::Relaxation as usize));
        d.columns.pressure_mid = Some(d.scalar("pressure_mid", "Pa", GhostScratch));
        d.columns.compliance = Some(d.scalar("compliance", "m3/Pa", GhostScratch));
    }
}

fn declare_stress(d: &mut Declare<'_>, needs: &Needs) {
    const NAMES: [&str; 4] =
        ["stress_volume_xx", "stress_volume_yy", "stress_volume_xy", "stress_volume_zz"];
    let count = match (needs.plane && needs.solids, d.scene.axisymmetric()) {
        (false, _) => 1,
        (true, false) => 3,
        (true, true) => 4,
    };
    d.columns.stress_volumes = count;
    d.set_owner(None);
    if count == 1 {
        d.columns.stress_volume = d.scalar("stress_volume", "J", GhostScratch);
    } else {
        // a fluid also needs the first component
        d.columns.stress_volume = d.add(&NAMES[..1], "J", GhostScratch, symmetric_mirror);
        d.set_owner(Some(StepPart::StressTensor as usize));
        d.add(&NAMES[1..count], "J", GhostScratch, |k| symmetric_mirror(k + 1));
    }
    d.set_owner(Some(StepPart::StressTensor as usize));
    if needs.solids {
        let stress = d.symmetric(["stress_xx", "stress_yy", "stress_xy"], "Pa", State);
        d.columns.stress = Some(stress);
    }
}

fn declare_contact(d: &mut Declare<'_>, needs: &Needs) {
    if !needs.touching {
        return;
    }
    d.set_owner(Some(StepPart::Contact as usize));
    d.columns.contact_impulse = Some(d.scalar("contact_impulse", "Pa s", GhostState));
    if needs.carries_faces {
        // the half edges turn in a mirror, their coordinates do not
        let names = ["face1_first", "face1_second", "face2_first", "face2_second"];
        d.columns.faces = Some(d.add(&names, "", GhostState, |_| Mirror::Same));
    }
    if needs.total_lagrangian {
        d.columns.current_volume = Some(d.scalar("current_volume", "", GhostScratch));
        let names = ["displacement", "displacement_x", "displacement_y"];
        d.columns.displacement = Some(d.vector(names, "m", GhostScratch));
    }
}

fn declare_friction(d: &mut Declare<'_>, needs: &Needs) {
    let contact = d.scene.scene.contact.and_then(|contact| contact.condition());
    let coefficient = contact.and_then(|contact| contact.coefficient);
    let between_bodies = needs.plane && needs.touching && coefficient.is_some();
    let own_part = between_bodies.then_some(StepPart::Contact as usize);
    if let Some(part) = own_part.or(d.columns.wall_friction_part) {
        d.set_owner(Some(part));
        d.columns.friction_heat = Some(d.scalar("friction_heat", "J/kg", State));
    }
}

fn declare_affine(d: &mut Declare<'_>, needs: &Needs) {
    d.set_owner(Some(StepPart::Affine as usize));
    if d.scene.scene.method.transfer.plan().is_affine() {
        let names = match needs.plane {
            false => ["affine_velocity", "", "", ""],
            true => ["affine_xx", "affine_xy", "affine_yx", "affine_yy"],
        };
        d.columns.affine = Some(d.tensor(names, "1/s", GhostState));
    }
}

fn declare_spin(d: &mut Declare<'_>) {
    if !d.scene.scene.method.spin {
        return;
    }
    d.set_owner(Some(StepPart::Spin as usize));
    let pseudoscalar = |_| Mirror::NegatePair(0, 1);
    let angular_momentum = d.add(&["spin"], "m2/s", GhostState, pseudoscalar);
    let inertia = d.scalar("spin_inertia", "m2", State);
    d.columns.spin = Some(SpinColumns { angular_momentum, inertia });
    d.zero_at_rest(angular_momentum);
    d.output("spin", "m2/s", "spin");
    d.output("spin_inertia", "m2", "spin_inertia");
}

fn declare_domains(d: &mut Declare<'_>, needs: &Needs) {
    let &Needs { plane, extent, touching, total_lagrangian, parallelograms, .. } = needs;
    d.set_owner(None);
    let filled = d.scene.scene.method.edge_mask.is_some() || (touching && !total_lagrangian);
    // on a line, the volume is the length on which such shape functions depend
    let is_length = !plane && (extent == DomainExtent::Current || total_lagrangian);
    let volume = (filled && !is_length).then(|| d.scalar("cell_volume", "", GhostScratch));
    if total_lagrangian && d.scene.axisymmetric() {
        let radius = d.add(&["radius"], "m", GhostScratch, |_| Mirror::Negate(0));
        d.columns.radius = Some(radius);
    }
    let names: &[&str] = match (plane, extent) {
        (false, _) => &["cell_length"],
        (true, DomainExtent::Point) => &[],
        (true, DomainExtent::Undeformed) => &["cell_width", "cell_height"],
        (true, DomainExtent::Current) => &HALF_EDGES,
    };
    let of_edge = |k: usize| Mirror::Negate(k % 2);
    let of_domain = |k: usize| if parallelograms { of_edge(k) } else { Mirror::Same };
    let domain = d.add(names, "", GhostScratch, of_domain);
    d.columns.domain = domain;
    if needs.deforms {
        d.columns.half_edges = Some(match parallelograms {
            true => domain,
            false => d.add(&HALF_EDGES, "", GhostScratch, of_edge),
        });
    }
    d.columns.fill_fraction = volume.or(filled.then_some(domain));
    if touching && d.columns.current_volume.is_none() {
        d.columns.current_volume = d.columns.fill_fraction;
    }
}

fn declare_places(d: &mut Declare<'_>, needs: &Needs) {
    if needs.total_lagrangian {
        let names = ["material_position", "material_position_x", "material_position_y"];
        d.columns.reference = Some(d.place(names, "m", State));
        d.columns.initial_position = d.columns.reference;
    } else if d.columns.shows_initial_position {
        let names = ["reference_position", "reference_position_x", "reference_position_y"];
        d.columns.initial_position = Some(d.place(names, "m", State));
    }
    if needs.total_lagrangian {
        let names = [
            "inverse_deformation_xx",
            "inverse_deformation_xy",
            "inverse_deformation_yx",
            "inverse_deformation_yy",
        ];
        d.columns.inverse_deformation = Some(d.tensor(names, "", GhostScratch));
    }
    let names = ["position", "position_x", "position_y"];
    d.columns.position = d.place(names, "m", State);
    let names = ["velocity", "velocity_x", "velocity_y"];
    d.columns.velocity = d.vector(names, "m/s", GhostState);
}

fn declare_gradients(d: &mut Declare<'_>, needs: &Needs) {
    let &Needs { plane, touching, total_lagrangian, deforms, solids, .. } = needs;
    if plane && (needs.extent != DomainExtent::Point || touching) {
        let half_lengths = d.add(&["half_width", "half_height"], "m", State, |_| Mirror::Same);
        d.columns.half_lengths = Some(half_lengths);
    }
    let strained = deforms || (plane && (solids || total_lagrangian));
    if strained {
        let names = ["deformation_xx", "deformation_xy", "deformation_yx", "deformation_yy"];
        d.columns.deformation = Some(d.tensor(names, "", State));
    }
    if strained || (plane && d.velocity_gradient) {
        let names = [
            "velocity_gradient_xx",
            "velocity_gradient_xy",
            "velocity_gradient_yx",
            "velocity_gradient_yy",
        ];
        d.columns.velocity_gradient = Some(d.tensor(names, "1/s", State));
    }
    let names = ["cell_fraction", "cell_fraction_x", "cell_fraction_y"];
    let names = if plane { &names[1..] } else { &names[..1] };
    d.columns.fraction = d.add(names, "", GhostScratch, Mirror::Complement);
}

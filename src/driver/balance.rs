//! Energy and momentum of a run at start and end, with what sides, forces and outflows contribute.

use crate::driver::output::summary::{Energy, Momentum, OutflowSummary};
use crate::scene::{CheckedScene, SideProperties};
use crate::simulation::{BoundaryWork, Removed, Totals};

/// Energy and momentum at start and end, with the contributions of sides and outflows.
///
/// The impulse of a wall is the change of the particles' momentum, because no other external force
/// acts on them. The work of a piston is its velocity times its impulse; if the piston changes its
/// velocity, the work follows from the frame of the grid. Contributions of transmitting sides,
/// pressures and wall friction are summed during the run.
pub(super) fn balance<const D: usize>(
    scene: &CheckedScene,
    times: [f64; 2],
    [start, end]: [&Totals<D>; 2],
    left: &Removed<D>,
    given: &BoundaryWork<D>,
    rounding: f64,
) -> (Energy, Momentum) {
    let sides = scene.side_properties::<D>();
    let rigid = |a: usize| sides[a].iter().any(SideProperties::is_rigid);
    let holds = scene.has_side(|side| side.no_slip);
    // along a radius, momentum is not a conserved sum
    let booked = |a: usize| rigid(a) || holds || (a == 0 && scene.axisymmetric());
    let walls: [f64; D] = std::array::from_fn(|a| match booked(a) {
        true => {
            let all = end.momentum[a] + left.momentum[a] - start.momentum[a];
            all - end.body_force_impulse[a]
        }
        false => given.impulse[a],
    });
    let impulse: [f64; D] = std::array::from_fn(|a| walls[a] - left.momentum[a]);
    let frame = scene.frame::<D>();
    let pistons = if frame.accelerates() {
        let ahead = |k: usize, t: &Totals<D>| frame.energy_ahead(times[k], t.mass, &t.momentum);
        ahead(1, end) - ahead(0, start)
    } else {
        let velocity = frame.velocity(0.0);
        (0..D).map(|a| velocity[a] * walls[a]).sum::<f64>()
    };
    let work = pistons + given.work + end.conducted - (left.kinetic + left.internal);
    let energy =
        Energy::new([start.kinetic, end.kinetic], [start.internal, end.internal], work, rounding);
    let momentum = Momentum::new(&start.momentum, &end.momentum, &impulse, start.absolute_momentum);
    match scene.scene.body_force {
        None => (energy, momentum),
        Some(_) => (
            energy.with_body_force(end.body_force_work, rounding),
            momentum.with_body_force(&end.body_force_impulse, start.absolute_momentum),
        ),
    }
}

/// Summary of the particles removed in one way.
pub(super) fn gone<const D: usize>(left: &Removed<D>) -> OutflowSummary {
    OutflowSummary {
        particles: left.count,
        mass: left.mass,
        momentum: left.momentum.to_vec(),
        energy: left.kinetic + left.internal,
    }
}

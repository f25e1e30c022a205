//! Forces of sides and no-slip walls.

use serde_json::json;

use super::fixture::{Fixture, close};

/// One particle of 8 kg at (3.25, 0.25) above a wall, with the velocity (4, 2) m/s and S = 6 J;
/// another one is far away.
fn above(wall: &str) -> Fixture<2> {
    let mut f = Fixture::<2>::new(json!({"boundary": {"y_lower": wall}}));
    f.set("position_x", &[3.25, 6.5]).set("position_y", &[0.25, 6.5]).set("mass", &[8.0, 1.0]);
    f.set("velocity_x", &[4.0, 0.0]).set("velocity_y", &[2.0, 0.0]);
    f.set("stress_volume", &[6.0, 0.0]).solve(0.1);
    f
}

#[test]
fn material_slips_along_a_wall() {
    let f = above("wall");
    // particle and image push along the wall: f = -6 x 3/4 twice, on 2 x 4.5 kg
    close(&[f.node("velocity_star_x", [3, 0])], &[4.0 - 0.1]);
    assert_eq!(f.node("velocity_star_y", [3, 0]), 0.0);
    // the image of the node above
    close(&[f.node("velocity_star_x", [3, -1])], &[f.node("velocity_star_x", [3, 1])]);
    close(&[f.node("velocity_star_y", [3, -1])], &[-f.node("velocity_star_y", [3, 1])]);
}

#[test]
fn material_rests_on_a_no_slip_wall_and_its_image_moves_the_other_way() {
    let f = above("no_slip");
    assert_eq!((f.node("velocity_x", [3, 0]), f.node("velocity_star_x", [3, 0])), (0.0, 0.0));
    assert_eq!((f.node("mass", [3, 0]), f.node("acceleration_x", [3, 0])), (9.0, 0.0));
    // 1.5 kg with the forces -6/4 and 6 x 3/4
    let star = [4.0 - 0.1, 2.0 + 0.3];
    close(&[f.node("velocity_star_x", [3, 1]), f.node("velocity_star_y", [3, 1])], &star);
    let image = [f.node("velocity_star_x", [3, -1]), f.node("velocity_star_y", [3, -1])];
    close(&image, &star.map(|v| -v));
    // ghosts carry the reversed velocity
    let c = &f.stepper.columns;
    let columns = &f.patch.block.columns;
    let image = (f.patch.block.own()..f.patch.block.particles())
        .find(|&r| f.patch.block.cells[r] == [3, -1])
        .expect("the image of the particle");
    assert_eq!((columns[c.velocity][image], columns[c.velocity + 1][image]), (-4.0, -2.0));
}

#[test]
fn the_work_and_impulse_of_a_side_are_counted_once() {
    let mut f = above("wall");
    for (index, share) in [([3, 0], 0.5), ([3, 1], 1.0)] {
        f.patch.side_forces.clear();
        f.patch.boundary_work.clear();
        let before = f.node("acceleration_x", index);
        f.set_node("velocity_x", index, 3.0).set_node("velocity_star_x", index, 5.0);
        f.set_node("velocity_y", index, 1.0).set_node("velocity_star_y", index, -3.0);
        f.run(0.1, |s, step, patch| {
            let at = patch.nodes.nodes.flat(index);
            s.push(patch, at, index, [10.0, 20.0], false);
            s.push(patch, at, index, [1.0, 2.0], true);
            s.accumulate_side_forces(patch, step.dt);
        });
        assert_eq!(f.node("acceleration_x", index), before + 11.0);
        // f.(v + v')/2 dt; the work of friction is heat
        let [pushed, rubbed] = f.patch.boundary_work[..] else { panic!("two forces") };
        close(&[pushed.work], &[share * 0.1 * (10.0 * 4.0 - 20.0)]);
        close(&pushed.impulse, &[share * 1.0, share * 2.0]);
        assert_eq!(rubbed.work, 0.0);
        close(&rubbed.impulse, &[share * 0.1, share * 0.2]);
    }
}

#[test]
fn with_compatible_energy_the_velocity_that_works_counts() {
    let method = json!({"stepping": "midpoint", "energy": "compatible"});
    let mut f = Fixture::<1>::new(json!({"method": method}));
    f.scatter(0.1);
    f.set_node("velocity", [3], 3.0).set_node("velocity_star", [3], 5.0).set_node("work", [3], 7.0);
    f.run(0.1, |s, step, patch| {
        let at = patch.nodes.nodes.flat([3]);
        s.push(patch, at, [3], [10.0], false);
        s.accumulate_side_forces(patch, step.dt);
    });
    close(&[f.patch.boundary_work[0].work], &[0.1 * 70.0]);
}

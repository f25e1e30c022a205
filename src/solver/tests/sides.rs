//! Forces of sides and no-slip walls.

use serde_json::json;

use super::fixture::{Fixture, close};

/// One particle of 8 kg at a distance of 0.25 m from a lower wall normal to `axis`, with the
/// velocities 4 m/s along it and 2 m/s away from it, and S = 6 J; another one is far away. Along the
/// wall it is between the nodes 3 and 4, closer to 3.
fn beside(wall: &str, axis: usize) -> Fixture<2> {
    let side = ["x_lower", "y_lower"][axis];
    let [along, away] = [["y", "x"], ["x", "y"]][axis];
    let mut f = Fixture::<2>::new(json!({"boundary": {side: wall}}));
    f.set(&format!("position_{along}"), &[3.25, 6.5]);
    f.set(&format!("position_{away}"), &[0.25, 6.5]).set("mass", &[8.0, 1.0]);
    f.set(&format!("velocity_{along}"), &[4.0, 0.0]);
    f.set(&format!("velocity_{away}"), &[2.0, 0.0]);
    f.set("stress_volume", &[6.0, 0.0]).solve(0.1);
    f
}

/// Components along and away from the wall of a vector at the node 3 along it and at a distance.
fn at(f: &Fixture<2>, axis: usize, field: &str, distance: i64) -> [f64; 2] {
    let index = [[distance, 3], [3, distance]][axis];
    let [x, y] = ["x", "y"].map(|a| f.node(&format!("{field}_{a}"), index));
    [[y, x], [x, y]][axis]
}

#[test]
fn material_slips_along_a_wall() {
    for axis in [0, 1] {
        let f = beside("wall", axis);
        // particle and image push along the wall: f = -6 x 3/4 twice, on 2 x 4.5 kg
        close(&at(&f, axis, "velocity_star", 0), &[4.0 - 0.1, 0.0]);
        // the image of the node above
        let [along, away] = at(&f, axis, "velocity_star", 1);
        close(&at(&f, axis, "velocity_star", -1), &[along, -away]);
    }
}

#[test]
fn material_rests_on_a_no_slip_wall_and_its_image_moves_the_other_way() {
    for axis in [0, 1] {
        let f = beside("no_slip", axis);
        assert_eq!(at(&f, axis, "velocity_star", 0), [0.0; 2]);
        assert_eq!(at(&f, axis, "acceleration", 0), [0.0; 2]);
        // 1.5 kg with the forces -6/4 and 6 x 3/4
        let star = [4.0 - 0.1, 2.0 + 0.3];
        close(&at(&f, axis, "velocity_star", 1), &star);
        close(&at(&f, axis, "velocity_star", -1), &star.map(|v| -v));
        // ghosts carry the reversed velocity
        let block = &f.patch.block;
        let image = (block.own()..block.particles()).find(|&r| block.cells[r][axis] == -1);
        let image = image.expect("the image of the particle");
        let velocity = [0, 1].map(|a| block.columns[f.stepper.columns.velocity + a][image]);
        assert_eq!(velocity, [[-2.0, -4.0], [-4.0, -2.0]][axis]);
    }
}

#[test]
fn the_work_and_impulse_of_a_side_are_counted_once() {
    let mut f = beside("wall", 1);
    for (index, share) in [([3, 0], 0.5), ([3, 1], 1.0)] {
        f.patch.side_forces.clear();
        f.patch.boundary_work.clear();
        let before = f.node("acceleration_x", index);
        f.set_node("velocity_x", index, 3.0).set_node("velocity_star_x", index, 5.0);
        f.set_node("velocity_y", index, 1.0).set_node("velocity_star_y", index, -3.0);
        f.run(0.1, |s, step, patch| {
            let at = patch.nodes.nodes.flat(index);
            s.push(patch, at, index, [10.0, 20.0]);
            s.record_side_force(patch, at, index, [1.0, 2.0], true);
            s.accumulate_side_forces(patch, step.dt);
        });
        assert_eq!(f.node("acceleration_x", index), before + 10.0);
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
        s.push(patch, at, [3], [10.0]);
        s.accumulate_side_forces(patch, step.dt);
    });
    close(&[f.patch.boundary_work[0].work], &[0.1 * 70.0]);
}

//! Runs in process, broken at steps and gone on with on another layout: the same bits.

use decomp::comm::local::run_ranks;
use decomp::{Comm, Serial};
use flyer_mpm::input;
use flyer_mpm::scene::CheckedScene;
use flyer_mpm::simulation::{Compiled, Saved, Simulation};
use flyer_mpm::solver::Stepper;
use serde_json::{Value, json};

use crate::scenes::{shipped, with};
use crate::small_scenes::{small, small_leapfrog};

/// Steps of each run.
const STEPS: u64 = 24;

fn checked(scene: &Value) -> CheckedScene {
    input::parse(scene.to_string().as_bytes(), "scene.json", &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// All output of a run about its state.
fn end_of<const D: usize>(run: &Simulation<'_, D>) -> String
where
    Stepper<D>: Compiled<D>,
{
    let (totals, left, given, force) = (run.totals(), run.ways(), run.given(), run.contact_force());
    let digest = run.gather().map(|(_, digest)| digest).unwrap_or_default();
    let (time, step, dt) = (run.time(), run.steps(), run.time_step());
    format!("{digest} {time:?} {step} {dt:?} {totals:?} {left:?} {given:?} {force:?}")
}

/// The end of a run that was never broken, and what it has saved after some steps.
fn whole<const D: usize>(scene: &CheckedScene, cuts: &[u64]) -> (String, Vec<Saved>)
where
    Stepper<D>: Compiled<D>,
{
    let mut run = Simulation::<D>::new(scene, &Serial, 1).unwrap();
    let mut saved = Vec::new();
    while run.steps() < STEPS {
        run.advance(scene.scene.time.end).unwrap();
        if cuts.contains(&run.steps()) {
            saved.push(run.save());
        }
    }
    (end_of(&run), saved)
}

/// The end of a run that goes on on some ranks.
fn gone_on<const D: usize>(
    scene: &CheckedScene,
    saved: &Saved,
    ranks: usize,
    threads: usize,
) -> String
where
    Stepper<D>: Compiled<D>,
{
    let ends = run_ranks(ranks, |comm| {
        let mut run = Simulation::<D>::new(scene, comm, threads).unwrap();
        run.restore(&share(comm, saved)).unwrap();
        assert_eq!((run.steps(), run.steps_made()), (saved.step, 0));
        while run.steps() < STEPS {
            run.advance(scene.scene.time.end).unwrap();
        }
        // saving again changes nothing
        let again = run.save();
        (end_of(&run), again)
    });
    let (ends, shares): (Vec<String>, Vec<Saved>) = ends.into_iter().unzip();
    // the shares of all ranks are a state from which one rank goes on
    let whole = Saved::joined(shares).unwrap();
    let mut run = Simulation::<D>::new(scene, &Serial, 1).unwrap();
    run.restore(&whole).unwrap();
    assert!(ends[0].contains(&run.digest()));
    ends.into_iter().next().unwrap()
}

/// The part of a state that a rank takes: all of it on the last rank.
fn share(comm: &dyn Comm, saved: &Saved) -> Saved {
    match comm.rank() + 1 == comm.size() {
        true => saved.clone(),
        false => saved.without_particles(),
    }
}

/// Holds runs of `scene` that were broken after `cuts` steps against one that was not.
fn same_bits<const D: usize>(scene: &Value, cuts: &[u64], patches: &[&[usize]])
where
    Stepper<D>: Compiled<D>,
{
    let cut = |patches: &[usize]| checked(&with(scene, &json!({"domain": {"patches": patches}})));
    let (end, saved) = whole::<D>(&cut(patches[0]), cuts);
    assert_eq!(saved.len(), cuts.len());
    for (k, saved) in saved.iter().enumerate() {
        let (ranks, threads) = ([1, 2, 3, 4][(k + 1) % 4], 1 + k % 2);
        let patches = patches[(k + 1) % patches.len()];
        let again = gone_on::<D>(&cut(patches), saved, ranks, threads);
        assert_eq!(again, end, "after {} steps, {ranks} ranks, {patches:?}", saved.step);
    }
}

#[test]
fn a_line_with_all_that_mid_point_steps_have() {
    // relaxed every seventh step, so that the number of the step counts
    let edit = json!({"method": {"pressure_relaxation": {"rate": 0.1, "interval": 7}}});
    let scene = with(&small("flyer.json"), &edit);
    same_bits::<1>(&scene, &[1, 6, 7, 13, 23, 24], &[&[3], &[1], &[16], &[5]]);
}

#[test]
fn the_total_lagrangian_frame() {
    let frame = json!({"method": {"frame": "total_lagrangian", "domain_limit": null}});
    let line = with(&small("flyer.json"), &frame);
    same_bits::<1>(&line, &[1, 13], &[&[3], &[1], &[5]]);
    same_bits::<1>(&with(&small("soft_flyer.json"), &frame), &[5, 18], &[&[4], &[2]]);
    let mut disk = with(&shipped("spinning_disk.json"), &frame);
    disk["output"] = json!({});
    same_bits::<2>(&disk, &[4, 17], &[&[2, 2], &[1, 3]]);
}

#[test]
fn lines_with_leapfrog_steps() {
    for (shape, transfer, update) in
        [("cpdi", json!("flip"), "last"), ("bspline_cubic", json!("apic"), "modified_last")]
    {
        let scene = small_leapfrog(shape, &transfer);
        let scene = with(&scene, &json!({"method": {"stress_update": update}}));
        same_bits::<1>(&scene, &[2, 15], &[&[4], &[7]]);
    }
}

#[test]
fn contact_sides_and_what_has_left() {
    same_bits::<1>(&small("soft_flyer.json"), &[5, 18], &[&[4], &[2]]);
    // particles that leave, waves that pass, and a piston
    let mut scene = small("flyer.json");
    scene["domain"]["upper"] = json!([0.0007]);
    scene["domain"]["lower"] = json!([-0.00012]);
    scene["bodies"][0]["velocity"] = json!([-1000]);
    scene["boundary"] = json!({"x_lower": "outflow", "x_upper": "transmitting"});
    scene["bodies"][1]["velocity"] = json!([-1000]);
    scene.as_object_mut().unwrap().remove("reference");
    let (end, _) = whole::<1>(&checked(&scene), &[]);
    assert!(!end.contains("outflow: Left { count: 0"), "{end}");
    same_bits::<1>(&scene, &[8, 20], &[&[4], &[3]]);
    // particles that erode
    let mut strong = small("flyer.json");
    strong.as_object_mut().unwrap().remove("reference");
    for metal in ["copper", "aluminium"] {
        strong["materials"][metal]["strength"] =
            json!({"type": "von_mises", "shear_modulus": 30e9, "yield_stress": 0.2e9});
        strong["materials"][metal]["erosion"] = json!({"plastic_strain": 0.01});
    }
    let (end, _) = whole::<1>(&checked(&strong), &[]);
    assert!(!end.contains("erosion: Left { count: 0"), "{end}");
    same_bits::<1>(&strong, &[8, 20], &[&[4], &[3]]);
    let mut piston = shipped("piston.json");
    piston["domain"]["cell_size"] = json!(1e-4);
    same_bits::<1>(&piston, &[11], &[&[3], &[2]]);
}

#[test]
fn planes_of_solids_gases_and_contact() {
    let mut disks = shipped("disks.json");
    disks["domain"]["cell_size"] = json!(0.05);
    // they meet at once
    disks["bodies"][1]["disk"]["centre"] = json!([0.49, 0.49]);
    same_bits::<2>(&disks, &[3, 16], &[&[2, 2], &[1, 3]]);
    let contact = json!({"contact": {"type": "friction", "coefficient": 0.2}});
    same_bits::<2>(&with(&disks, &contact), &[9], &[&[1, 1], &[3, 2]]);
    let mut noh = shipped("noh_axis.json");
    noh["domain"]["cell_size"] = json!(0.02);
    same_bits::<2>(&noh, &[4], &[&[1, 1], &[5, 1]]);
}

#[test]
fn marks_of_loads_and_what_contact_has_pressed() {
    let mut loaded = small("flyer.json");
    loaded.as_object_mut().unwrap().remove("reference");
    loaded["domain"]["lower"] = json!([-0.00012]);
    loaded["boundary"] = json!({"x_lower": {"pressure": 1e9}});
    same_bits::<1>(&loaded, &[1, 12], &[&[3], &[2]]);
    // a plate of two cells bounces off: until then what was pressed has held it
    let mut plate = small("soft_flyer.json");
    plate.as_object_mut().unwrap().remove("reference");
    plate["bodies"][0]["box"]["lower"] = json!([-0.00002]);
    same_bits::<1>(&plate, &[4, 8, 12, 16], &[&[3], &[2]]);
}

#[test]
fn planes_with_forces_walls_and_joined_sides() {
    let mut block = shipped("sliding_block.json");
    block["output"] = json!({});
    same_bits::<2>(&block, &[5, 17], &[&[3, 1], &[1, 2]]);
    let mut layer = shipped("shear_layer.json");
    layer["domain"]["cell_size"] = json!(0.125);
    same_bits::<2>(&layer, &[10], &[&[2, 2], &[4, 1]]);
    layer["method"]["shape"] = json!("cpdi_bspline_quadratic");
    layer["method"]["domain_limit"] = json!(0.7);
    same_bits::<2>(&layer, &[10], &[&[2, 2], &[4, 1]]);
    let mut vortex = shipped("vortex.json");
    vortex["domain"]["cell_size"] = json!(0.25);
    vortex["time"]["courant"] = json!(0.05);
    same_bits::<2>(&vortex, &[7], &[&[1, 2], &[3, 3]]);
}

#[test]
fn strength_failure_heat_pores_and_fire() {
    let coarse = |name: &str, cell: f64| {
        let mut scene = shipped(name);
        scene["domain"]["cell_size"] = json!(cell);
        scene["output"] = json!({});
        scene
    };
    let mut bar = coarse("taylor_bar.json", 8e-4);
    let metal = &mut bar["materials"]["42CrMo4"];
    metal["failure"] = json!({"type": "johnson_cook", "d1": 0.01});
    metal["thermal"]["conductivity"] = json!(400.0);
    bar["boundary"]["temperature"] = json!({"y_lower": 500.0});
    same_bits::<2>(&bar, &[5, 16], &[&[2, 2], &[1, 3]]);
    let mut spall = coarse("spall.json", 1e-4);
    // hardly any tension, so that it fails within the steps
    spall["materials"]["aluminium"]["failure"] = json!({"type": "tension_limit", "stress": 1e5});
    spall["materials"]["aluminium"]["thermal"] =
        json!({"specific_heat": 896.0, "reference_temperature": 293.0});
    same_bits::<1>(&spall, &[3, 14], &[&[3], &[2]]);
    same_bits::<1>(&coarse("porous_impact.json", 1e-4), &[9], &[&[3], &[2]]);
    same_bits::<1>(&coarse("detonation.json", 4e-4), &[9], &[&[4], &[2]]);
}

/// Damage that is under way at the cut, in both kinds of step.
#[test]
fn gradual_damage() {
    for failure in [
        json!({"type": "cochran_banner", "stress": 5e8, "opening": 1e-4}),
        // slow cracks, so that the damage is under way for all steps
        json!({"type": "grady_kipp", "flaw_density": 1e30, "exponent": 8.0, "crack_speed": 0.01}),
    ] {
        let mut scene = shipped("spall.json");
        scene["domain"]["cell_size"] = json!(1e-4);
        scene["output"] = json!({});
        let metal = &mut scene["materials"]["aluminium"];
        metal["failure"] = failure;
        metal["strength"] =
            json!({"type": "von_mises", "shear_modulus": 27e9, "yield_stress": 0.2e9});
        metal["thermal"] = json!({"specific_heat": 896.0, "reference_temperature": 293.0});
        // the bodies share their velocities on the grid, and pull each other
        scene["bodies"][0]["velocity"] = json!([-200.0]);
        let mut leapfrog = scene.clone();
        leapfrog["method"] = json!({"shape": "cpdi", "transfer": {"xpic": 2}});
        leapfrog["artificial_viscosity"] = json!({"linear": 0.2, "quadratic": 2.0});
        for scene in [scene, leapfrog] {
            let checked = checked(&scene);
            let mut run = Simulation::<1>::new(&checked, &Serial, 1).unwrap();
            while run.steps() < 9 {
                run.advance(checked.scene.time.end).unwrap();
            }
            let (table, _) = run.gather().unwrap();
            let damage = table.column("damage").unwrap();
            assert!(damage.iter().any(|&d| d > 0.0 && d < 1.0), "{damage:?}");
            same_bits::<1>(&scene, &[9, 15], &[&[3], &[2]]);
        }
    }
}

/// Patches that sleep at the cut are awake after it.
#[test]
fn patches_at_rest() {
    let scene = small("flyer.json");
    let saved = whole::<1>(&checked(&scene), &[12]).1;
    let quiet = |skip: bool| {
        let edit = json!({"domain": {"patches": [16]}, "decomposition": {"skip_quiescent": skip}});
        gone_on::<1>(&checked(&with(&scene, &edit)), &saved[0], 2, 1)
    };
    assert_eq!(quiet(true), quiet(false));
}

/// What is not of its scene is refused on all ranks.
#[test]
fn particles_of_another_scene() {
    let scene = checked(&small("flyer.json"));
    let mut saved = whole::<1>(&scene, &[3]).1.remove(0);
    saved.particles.columns[0][5] *= 1.5;
    let errors = run_ranks(2, |comm| {
        let mut run = Simulation::<1>::new(&scene, comm, 1).unwrap();
        run.restore(&share(comm, &saved)).unwrap_err().to_string()
    });
    assert!(
        errors.iter().all(|e| e.contains("not those that its scene starts with")),
        "{errors:?}"
    );
}

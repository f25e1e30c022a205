//! Each alarm of the monitor, set off; what it says, on any number of ranks; steps that are redone.

use decomp::Serial;
use decomp::comm::local::run_ranks;
use flyer_mpm::material::constitutive::CustomModel;
use flyer_mpm::material::{EquationOfState, LinearPressure};
use flyer_mpm::simulation::monitor::Alarm;
use flyer_mpm::simulation::{RunError, Simulation};
use serde_json::{Value, json};

use crate::cases::tools::{checked, lump, metals, run, run_on, scene_of, short};
use crate::scenes::with;

/// The error that a scene ends with on so many ranks.
fn error_on(value: &Value, ranks: usize) -> RunError {
    let scene = checked(value).unwrap_or_else(|e| panic!("{e}"));
    let ends = run_ranks(ranks, |comm| {
        let mut simulation = Simulation::<1>::new(&scene, comm, 1)?;
        while simulation.time() < scene.scene.time.end {
            simulation.advance(scene.scene.time.end)?;
        }
        Ok::<(), RunError>(())
    });
    let mut errors = ends.into_iter().map(|end| end.expect_err("it is to end"));
    let first = errors.next().expect("rank 0");
    assert!(errors.all(|e| e.is_known_to_all()));
    first
}

/// The alarm that a scene sets off, which names particle, cell, place, time and cause alike on any
/// number of ranks.
#[track_caller]
fn sets_off(value: &Value, expected: Alarm, words: &[&str]) {
    let error = error_on(value, 1);
    let RunError::Particle { alarm, .. } = &error else { panic!("{error}") };
    let text = error.to_string();
    assert_eq!(*alarm, expected, "{text}");
    for word in ["particle ", "x = ", "cell [", "time ", "step ", "likely cause: "] {
        assert!(text.contains(word), "{word}: {text}");
    }
    for word in words {
        assert!(text.contains(word), "{word}: {text}");
    }
    for ranks in 2..=4 {
        let value = with(value, &json!({"domain": {"patches": [7]}}));
        assert_eq!(error_on(&value, ranks).to_string(), text, "{ranks} ranks");
    }
}

fn monitored(monitor: Value) -> Value {
    with(&short(1e-7), &json!({"monitor": monitor}))
}

/// Two halves of a body that fly apart.
fn torn() -> Value {
    let bodies = json!([
        lump("left", "copper", [40.0, 70.0], -1500.0),
        lump("right", "copper", [70.0, 100.0], 1500.0),
    ]);
    scene_of(140, 5e-8, &metals(), &bodies)
}

#[test]
fn a_state_outside_of_its_model() {
    sets_off(&torn(), Alarm::State, &["density ", "pressure -", "tension_cutoff"]);
}

#[test]
fn a_density_past_the_limit_of_the_equation_of_state() {
    // at this S a wave of the start cannot be compressed to a half of what the plates do
    let mut value = short(1e-7);
    value["bodies"][0]["velocity"] = json!([3000.0]);
    value["artificial_viscosity"] = Value::Null;
    value["method"]["pressure_relaxation"] = Value::Null;
    value["materials"]["copper"]["eos"]["s"] = json!(40.0);
    value.as_object_mut().unwrap().remove("artificial_viscosity");
    value["method"].as_object_mut().unwrap().remove("pressure_relaxation");
    value.as_object_mut().unwrap().remove("reference");
    sets_off(&value, Alarm::State, &["compress", "no artificial_viscosity"]);
}

#[test]
fn a_particle_that_leaves_the_domain() {
    let mut value = short(1e-6);
    value["domain"]["upper"] = json!([0.00262]);
    sets_off(&value, Alarm::State, &["leaves the domain by its upper side", "a larger domain"]);
}

#[test]
fn a_particle_that_is_too_fast() {
    sets_off(&monitored(json!({"speed": 0.1})), Alarm::Speed, &["faster than any wave"]);
}

#[test]
fn a_step_that_was_too_long() {
    sets_off(&monitored(json!({"courant": 0.401})), Alarm::Courant, &["Courant number of 0.4"]);
}

#[test]
fn a_time_step_that_collapses() {
    sets_off(&monitored(json!({"min_time_step_ratio": 1.0})), Alarm::TimeStep, &["has fallen to"]);
}

#[test]
fn cells_that_are_crowded() {
    sets_off(
        &monitored(json!({"max_particles_per_cell_ratio": 1.0})),
        Alarm::Crowding,
        &["particles are in its cell"],
    );
}

#[test]
fn energy_that_grows() {
    let mut value = monitored(json!({"on_courant_exceeded": "allow", "energy_growth": 0.02}));
    value["method"] = json!({
        "shape": "bspline_quadratic", "transfer": "flip", "stepping": "leapfrog",
        "stress_update": "first",
    });
    value["time"]["courant"] = json!(0.8);
    value.as_object_mut().unwrap().remove("artificial_viscosity");
    sets_off(&value, Alarm::Energy, &["total energy has grown by"]);
}

/// A material that pushes as hard however far it has expanded and however cold it is: a spring
/// without end, as none of the scene's models is.
#[derive(Clone, Copy)]
struct Endless;

impl EquationOfState for Endless {
    fn reference_density(&self) -> f64 {
        8930.0
    }

    fn linear(&self, _jacobian: f64) -> LinearPressure {
        LinearPressure { reference_pressure: 1e9, gruneisen_rho: 1.0 }
    }

    fn sound_speed_squared(&self, _jacobian: f64, _pressure: f64) -> f64 {
        4000.0 * 4000.0
    }

    fn check_validity(&self, _jacobian: f64, _pressure: f64) -> Option<&'static str> {
        None
    }
}

/// What has given away more energy than it had is seen, though the sum of all energies is right.
#[test]
fn energy_that_falls_below_none() {
    let mut bodies =
        [lump("left", "copper", [60.0, 70.0], -50.0), lump("right", "copper", [90.0, 100.0], 50.0)];
    bodies.iter_mut().for_each(|body| body["pressure"] = json!(1e9));
    let value = scene_of(160, 2e-7, &metals(), &json!(bodies));
    let scene = checked(&value).unwrap();
    let models = |_: &str| Some(CustomModel::fluid(Endless));
    let mut simulation = Simulation::<1>::with_models(&scene, &Serial, 1, &models).unwrap();
    let error = loop {
        assert!(simulation.time() < scene.scene.time.end, "it is to end");
        if let Err(error) = simulation.advance(scene.scene.time.end) {
            break error;
        }
    };
    let RunError::Particle { alarm, .. } = &error else { panic!("{error}") };
    assert_eq!(*alarm, Alarm::Cold, "{error}");
    assert!(error.to_string().contains("internal energy has fallen below the least"), "{error}");
}

/// A step that turns out too long is made half as long, and the run goes on: the same bits on any
/// ranks.
#[test]
fn a_step_is_redone() {
    let bound = json!({"courant": 0.402, "on_alarm": "redo"});
    let value = monitored(bound);
    let scene = checked(&value).unwrap();
    let mut simulation = Simulation::<1>::new(&scene, &Serial, 1).unwrap();
    while simulation.time() < scene.scene.time.end {
        simulation.advance(scene.scene.time.end).unwrap();
    }
    assert!(simulation.tally().redone_steps > 0);
    let whole = run(&value).unwrap();
    assert!(whole.energy_drift().abs() < 1e-12);
    let plain = run(&short(1e-7)).unwrap();
    assert!(whole.digest != plain.digest && whole.steps > plain.steps);
    for ranks in 2..=4 {
        let value = with(&value, &json!({"domain": {"patches": [9]}}));
        let ends = run_ranks(ranks, |comm| run_on::<1>(&value, comm).unwrap().digest);
        assert_eq!(ends[0], whole.digest, "{ranks} ranks");
    }
}

/// Where halves do not help the run ends after all.
#[test]
fn redoing_has_an_end() {
    let value = with(&torn(), &json!({"monitor": {"on_alarm": "redo", "max_retries": 3}}));
    sets_off(&value, Alarm::State, &["tension_cutoff"]);
}

#[test]
fn a_redo_that_nothing_calls_for_changes_no_bit() {
    let plain = run(&short(1e-7)).unwrap().digest;
    assert_eq!(run(&monitored(json!({"on_alarm": "redo"}))).unwrap().digest, plain);
}

/// A Courant number above the limit is refused, reduced, or allowed, as the scene says.
#[test]
fn a_courant_number_above_the_limit() {
    let mut value = short(1e-8);
    value["method"] = json!({"shape": "gimp", "transfer": {"fmpm": 6}});
    value["time"]["courant"] = json!(1.0);
    let message = checked(&value).unwrap_err();
    for word in ["time.courant = 1", "measured to be stable", "monitor.on_courant_exceeded"] {
        assert!(message.contains(word), "{message}");
    }
    value["monitor"] = json!({"on_courant_exceeded": "reduce"});
    let reduced = checked(&value).unwrap();
    assert_eq!(reduced.scene.time.courant, reduced.courant_limit());
    assert!(reduced.scene.time.courant < 1.0);
    assert!(reduced.warnings.iter().any(|w| w.contains("reduced to")));
    value["monitor"] = json!({"on_courant_exceeded": "allow"});
    let allowed = checked(&value).unwrap();
    assert_eq!(allowed.scene.time.courant, 1.0);
    assert!(allowed.warnings.iter().any(|w| w.contains("allows it")));
}

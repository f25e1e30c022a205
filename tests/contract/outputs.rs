//! The output files of a run: locations, names, columns and types.

use serde_json::{Value, json};

use crate::home::{Home, Results, column, names};
use crate::scenes::{short, whole};

const HEADER: &str = "x,pressure,velocity,density,specific_internal_energy,\
                      artificial_viscosity,material";

#[test]
fn results_go_beside_the_callers_folder_by_the_scenes_name() {
    let home = Home::new();
    home.write("scenes/my.plate.json", &short().to_string());
    home.write("here/note.txt", "");
    let out = crate::program::Call::new(&home.at("here"), ["../scenes/my.plate.json"]).end();
    assert!(out.succeeded().contains("output/my.plate"));
    assert_eq!(names(&home.at("here/output")), ["my.plate"]);
    assert_eq!(home.results("here/output/my.plate").count("particles"), 400);
    assert_eq!(names(&home.at("scenes")), ["my.plate.json"]);
}

#[test]
fn an_output_folder_is_made_with_its_parents() {
    let home = Home::with(&short());
    home.run("a/b/c", &[]);
    home.run("a/b/../d/", &[]);
    assert_eq!(names(&home.at("a")), ["b", "d"]);
    assert_eq!(names(&home.at("a/b")), ["c"]);
    assert_eq!(names(home.path()), ["a", "scene.json"]);
}

/// Asserts that `value` has every key, with the type given by its letter: `n`umber, `c`ount,
/// `t`ext, `o`bject, `a`rray, or `?` for a number or null.
#[track_caller]
fn has(value: &Value, keys: &[(&str, char)]) {
    for (key, letter) in keys {
        let found = value.get(key).unwrap_or_else(|| panic!("no {key} in {value}"));
        let fits = match letter {
            'n' => found.is_number(),
            'c' => found.is_u64(),
            't' => found.as_str().is_some_and(|t| !t.is_empty()),
            'o' => found.is_object(),
            'a' => found.is_array(),
            _ => found.is_number() || found.is_null(),
        };
        assert!(fits, "{key} = {found} is not of type {letter}");
    }
}

#[test]
fn the_summary_has_its_fields() {
    let run = Home::with(&whole()).run("run", &["--threads", "2", "--set", "domain.patches=[3]"]);
    let summary = &run.summary;
    has(summary, &[("title", 't'), ("version", 't'), ("scene", 'o')]);
    has(summary, &["ranks", "threads", "particles", "cells", "steps"].map(|key| (key, 'c')));
    has(summary, &["wall_seconds", "loop_wall_seconds", "cpu_seconds"].map(|key| (key, 'n')));
    has(summary, &[("particle_steps_per_cpu_second", 'n'), ("phase_seconds", 'o')]);
    has(summary, &[("patches", 'a'), ("profiles", 'a'), ("energy", 'o'), ("momentum", 'o')]);
    has(summary, &[("decomposition", 'o')]);
    let sharing = &summary["decomposition"];
    has(sharing, &[("imbalance", 'n'), ("bytes_per_step", 'n'), ("messages_per_step", 'n')]);
    let counts = ["particle_steps_computed", "busiest_particle_steps", "particles_migrated"];
    has(sharing, &counts.map(|key| (key, 'c')));
    assert_eq!(sharing["ranks"][0]["particles"], 400);
    assert!(sharing["ranks"][0]["seconds"]["compute"].as_f64() > Some(0.0));
    assert_eq!(summary["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(["ranks", "threads", "particles", "cells"].map(|k| run.count(k)), [1, 2, 400, 300]);
    assert_eq!(summary["patches"], json!([3]));
    assert!(summary["wall_seconds"].as_f64() >= summary["loop_wall_seconds"].as_f64());
    for key in ["total_start", "total_end", "boundary_work"] {
        has(&summary["energy"], &[(key, 'n')]);
    }
    assert!(summary["energy"]["drift"].as_f64().unwrap().abs() < 1e-12);
    for key in ["start", "end", "boundary_impulse"] {
        assert!(summary["momentum"][key][0].is_number(), "{}", summary["momentum"]);
    }
    assert!(summary["momentum"]["drift"].as_f64().unwrap().abs() < 1e-12);
    // the scene as run, with overrides and defaults
    assert_eq!(summary["scene"]["domain"]["patches"], json!([3]));
    assert_eq!(summary["scene"]["method"]["stress_update"], "last");
}

#[test]
fn a_profile_in_the_summary_has_its_fields() {
    let run = Home::with(&whole()).run("run", &[]);
    let profiles = run.summary["profiles"].as_array().unwrap();
    let times: Vec<_> = profiles.iter().map(|p| p["time"].as_f64().unwrap()).collect();
    assert_eq!(times, [5e-8, 1e-7], "to the bit what the scene asks for");
    for profile in profiles {
        has(profile, &[("file", 't'), ("errors", 'o'), ("errors_cell_averaged", 'o')]);
        let digest = profile["state_sha256"].as_str().unwrap();
        assert!(digest.len() == 64 && digest.bytes().all(|b| b.is_ascii_hexdigit()), "{digest}");
        for errors in [&profile["errors"], &profile["errors_cell_averaged"]] {
            has(errors, &["l1", "l2", "e1_cells"].map(|key| (key, 'n')));
            has(errors, &["plateau", "noise", "second_plateau"].map(|key| (key, '?')));
            has(errors, &["shock_position_cells", "rise_cells", "overshoot"].map(|k| (k, '?')));
            has(errors, &["density_plateau", "energy_plateau"].map(|key| (key, '?')));
        }
        assert!(profile["errors"]["plateau"].is_number(), "the first plateau stands by then");
        assert!(profile["errors"]["second_plateau"].is_null(), "the second one is still to come");
    }
    assert_ne!(profiles[0]["file"], profiles[1]["file"]);
    assert_ne!(profiles[0]["state_sha256"], profiles[1]["state_sha256"]);
}

#[test]
fn without_a_reference_there_are_no_errors() {
    let mut scene = short();
    scene.as_object_mut().unwrap().remove("reference");
    let run = Home::with(&scene).run("run", &[]);
    assert_eq!(run.summary["profiles"][0]["errors"], Value::Null);
    assert_eq!(run.summary["profiles"][0]["errors_cell_averaged"], Value::Null);
}

/// Significant digits of a number in text form.
fn digits(number: &str) -> String {
    let mantissa = number.split(['e', 'E']).next().unwrap();
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    digits.trim_start_matches('0').trim_end_matches('0').to_string()
}

#[test]
fn a_profile_is_every_particle_sorted_in_shortest_numbers() {
    let run = Home::with(&whole()).run("run", &[]);
    for k in 0..2 {
        let csv = run.profile(k);
        assert_eq!(csv.lines().next(), Some(HEADER));
        assert!(csv.ends_with('\n') && !csv.contains(['#', '\r', ' ']));
        let x = column(csv, "x");
        assert_eq!(x.len() as u64, run.count("particles"));
        assert!(x.windows(2).all(|pair| pair[0] < pair[1]));
        for row in csv.lines().skip(1) {
            let fields: Vec<_> = row.split(',').collect();
            assert_eq!(fields.len(), 7, "{row}");
            assert!(["copper", "aluminium"].contains(&fields[6]), "{row}");
            for field in &fields[..6] {
                let value: f64 = field.parse().unwrap();
                // {:e} prints the shortest decimal that reads back as the same double
                assert_eq!(digits(field), digits(&format!("{value:e}")), "{field}");
            }
        }
        assert_eq!(csv.lines().filter(|row| row.ends_with(",copper")).count(), 100);
    }
}

#[test]
fn profiles_at_an_interval_and_of_blocks_of_cells() {
    let mut scene = whole();
    scene["output"]["profiles"] = json!({"every": 3e-8});
    let home = Home::with(&scene);
    let run = home.run("run", &[]);
    let times: Vec<f64> = run.summary["profiles"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["time"].as_f64().unwrap())
        .collect();
    assert_eq!(times, [0.0, 3e-8, 6e-8, 9e-8, 1e-7]);
    let start = column(run.profile(0), "velocity");
    assert!(start.iter().all(|&u| u == 0.0 || u == start[0]) && start[0] > 0.0, "{start:?}");
    let few = home.run("few", &["--set", "output.profiles.max_particles=50"]);
    let warnings = few.summary["warnings"].to_string();
    assert!(warnings.contains("blocks of 8 cells"), "{warnings}");
    let digests = |run: &Results| -> Vec<String> {
        run.states().iter().map(|(digest, _)| digest.to_string()).collect()
    };
    assert_eq!(digests(&few), digests(&run));
    let (x, all) = (column(few.profile(4), "x"), column(run.profile(4), "x"));
    assert!((20..=52).contains(&x.len()) && all.len() == 400, "{}", x.len());
    assert!(x.windows(2).all(|pair| pair[0] < pair[1]));
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    assert!((mean(&x) / mean(&all) - 1.0).abs() < 0.05);
    home.call(["scene.json", "--set", "output.profiles.times=[1e-8]"])
        .end()
        .failed(&["output.profiles.every", "one of both"]);
    let unknown = r#"output.fields={"every":1e-8,"quantities":["stress"]}"#;
    home.call(["scene.json", "--set", unknown]).end().failed(&["quantities[0]", "velocity"]);
    let twice = r#"output.fields={"every":1e-8,"quantities":["mass","mass"]}"#;
    home.call(["scene.json", "--set", twice]).end().failed(&["quantities[1]", "named twice"]);
    home.call(["scene.json", "--set", "output.fields={}"]).end().failed(&["every or times"]);
    for (diagrams, words) in [
        (r#"["density","stress"]"#, ["output.diagrams[1]", "velocity"]),
        (r#"["pressure"]"#, ["output.diagrams[0]", "cannot be chosen"]),
        (r#"["mass","mass"]"#, ["output.diagrams[1]", "named twice"]),
    ] {
        let set = format!("output.diagrams={diagrams}");
        home.call(["scene.json", "--set", &set]).end().failed(&words);
    }
}

#[test]
fn pressure_stands_without_artificial_viscosity() {
    let run = Home::with(&whole()).run("run", &["--set", "output.pictures=false"]);
    let csv = run.profile(1);
    let [pressure, density, energy, viscosity] =
        ["pressure", "density", "specific_internal_energy", "artificial_viscosity"]
            .map(|name| column(csv, name));
    assert!(viscosity.iter().any(|&q| q > 1e8), "in the shock");
    // in the target, the equation of state at the density and energy of the same row
    for (i, row) in csv.lines().skip(1).enumerate().filter(|(_, r)| r.ends_with("aluminium")) {
        let chi: f64 = 1.0 - 2785.0 / density[i];
        let squeezed = chi.max(0.0);
        let slope = 2785.0 * 5386.0_f64.powi(2) / (1.0 - 1.339 * squeezed).powi(2);
        let expected = slope * chi * (1.0 - 1.05 * squeezed) + 2.1 * 2785.0 * energy[i];
        assert!((pressure[i] - expected).abs() < 10.0, "{row}, not {expected}");
    }
    // zero if the scene has no artificial viscosity
    let mut scene = short();
    scene.as_object_mut().unwrap().remove("artificial_viscosity");
    let run = Home::with(&scene).run("run", &[]);
    assert!(column(run.profile(0), "artificial_viscosity").iter().all(|&q| q == 0.0));
}

#[test]
fn histories_follow_surfaces_and_tracers() {
    let mut scene = short();
    scene["output"]["histories"] = json!({
        "interval": 1e-9,
        "tracers": [{"name": "gauge", "body": "target", "at": [1e-5]}]
    });
    let run = Home::with(&scene).run("run", &[]);
    let header: Vec<_> = run.text("histories.csv").lines().next().unwrap().split(',').collect();
    for name in ["time", "dt", "kinetic_energy", "internal_energy", "total_energy", "momentum"] {
        assert!(header.contains(&name), "{header:?}");
    }
    for probe in ["interface", "free_surface", "gauge"] {
        for what in ["x", "velocity", "pressure"] {
            assert!(header.contains(&format!("{probe}_{what}").as_str()), "{header:?}");
        }
    }
    let time = run.history("time");
    assert!(time.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!((time[0], *time.last().unwrap()), (0.0, 1e-8));
    assert!((9..=12).contains(&time.len()), "{time:?}");
    assert!((run.history("gauge_x")[0] - 1e-5).abs() <= 2.5e-6, "the nearest particle");
    assert!(*run.history("interface_velocity").last().unwrap() > 500.0);
    assert!(run.history("free_surface_x").iter().all(|&x| (x / 1.5e-3 - 1.0).abs() < 1e-6));
    let energy = run.history("total_energy");
    assert!(energy.iter().all(|e| (e / energy[0] - 1.0).abs() < 1e-12));
}

/// The pressure of a free surface is zero, also while a shock passes its outermost particle, and
/// its velocity approaches that of the release. A face with a body or wall beyond it has the
/// pressure of its particle.
#[test]
fn free_surfaces_have_no_pressure() {
    let library = ["tantalum", "pmma", "steel_304", "titanium"];
    for (k, (flyer, target)) in [(2, 0), (0, 1), (1, 2), (2, 3)].into_iter().enumerate() {
        let mut scene = short();
        let material = |k: usize| json!({"library": library[k]});
        scene["materials"] = json!({"copper": material(flyer), "aluminium": material(target)});
        scene["bodies"][1]["box"]["upper"] = json!([0.3e-3]);
        scene["time"]["end"] = json!(0.2e-6);
        scene["output"]["profiles"]["times"] = json!([0.2e-6]);
        scene["output"]["histories"] = json!({"interval": 1e-9});
        if k == 3 {
            // the mirror image, and contact
            scene["bodies"][0]["box"] = json!({"lower": [0.3e-3], "upper": [0.8e-3]});
            scene["bodies"][0]["velocity"] = json!([-1000.0]);
            scene["domain"] = json!({"lower": [-1.5e-3], "upper": [2e-3], "cell_size": 1e-5});
        }
        let run = Home::with(&scene).run("run", &[]);
        for face in ["free_surface", "flyer_rear"] {
            let pressure = run.history(&format!("{face}_pressure"));
            assert!(pressure.iter().all(|&p| p == 0.0), "{target} {face} {pressure:?}");
        }
        let interface = run.history("interface_pressure");
        assert!(interface.iter().fold(0.0, |a: f64, &b| a.max(b)) > 1e9);
        let moved = run.history("free_surface_velocity");
        assert!(moved.iter().fold(0.0, |a: f64, &b| a.max(b.abs())) > 100.0, "{moved:?}");
    }
    // a wall behind the target presses on it
    let mut scene = short();
    scene["bodies"][1]["box"]["upper"] = json!([0.3e-3]);
    scene["domain"]["upper"] = json!([0.3e-3]);
    scene["boundary"] = json!({"x_upper": "wall"});
    scene["time"]["end"] = json!(0.1e-6);
    scene["output"]["profiles"]["times"] = json!([0.1e-6]);
    scene["output"]["histories"] = json!({"interval": 1e-9});
    let run = Home::with(&scene).run("run", &[]);
    let pressure = run.history("free_surface_pressure");
    assert!(pressure.iter().fold(0.0, |a: f64, &b| a.max(b)) > 1e10, "{pressure:?}");
}

#[test]
fn outputs_that_are_not_asked_for_are_left_out() {
    let home = Home::with(&whole());
    let extensions = |set: &str| {
        let run = home.run("run", &["--set", set]);
        let mut found: Vec<_> =
            run.names().iter().map(|n| n.rsplit('.').next().unwrap().to_string()).collect();
        found.sort();
        found.dedup();
        (found, run)
    };
    assert_eq!(extensions("output.pictures=false").0, ["csv", "hdf5", "json"]);
    assert_eq!(extensions("output.hdf5=false").0, ["csv", "json", "png", "svg"]);
    let (_, run) = extensions("output.histories=null");
    assert!(run.names().iter().all(|name| !name.starts_with("histories")));
    let run = Home::with(&short()).run("run", &[]);
    let file = run.summary["profiles"][0]["file"].as_str().unwrap();
    assert_eq!(run.names(), [file, "summary.json"]);
}

#[test]
fn hdf5_is_written() {
    let run = Home::with(&whole()).run("run", &["--set", "output.pictures=false"]);
    let bytes = run.bytes("results.hdf5");
    assert!(bytes.starts_with(b"\x89HDF\r\n\x1a\n"));
    assert!(bytes.windows(6).any(|w| w == b"VTKHDF"));
}

/// When all particles have left, none limits the next time step: the field is empty.
#[test]
fn a_run_that_all_have_left_has_no_time_step() {
    let home = Home::with(&json!({
        "title": "gone",
        "domain": {"lower": [0.0], "upper": [1e-3], "cell_size": 5e-5},
        "time": {"end": 2e-6},
        "method": {"shape": "gimp", "transfer": "flip"},
        "materials": {"gas": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}},
        "bodies": [{
            "name": "puff", "material": "gas", "box": {"lower": [6e-4], "upper": [8e-4]},
            "velocity": [1000.0], "pressure": 1e3, "particles_per_cell": [2],
        }],
        "boundary": {"x_lower": "outflow", "x_upper": "outflow"},
        "output": {"histories": {"interval": 1e-7}, "pictures": false, "hdf5": false},
    }));
    let run = home.run("run", &[]);
    assert_eq!(run.summary["outflow"]["particles"], run.summary["particles"]);
    let steps = run.history("dt");
    assert!(steps[0] > 0.0 && steps.last().unwrap().is_nan(), "{steps:?}");
    assert!(!run.text("histories.csv").contains("inf"));
}

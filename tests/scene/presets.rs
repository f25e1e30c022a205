//! Methods by name: which options each contents gets, and what explicit keys do.

use flyer_mpm::input::parse;
use flyer_mpm::scene::{CheckedScene, MethodChoice, Preset};
use serde_json::{Value, json};

use crate::{mentions_all, refused_text, shipped, with};

/// Two plates on a line, without a method.
fn plates() -> Value {
    json!({
        "title": "plates",
        "domain": {"lower": [-0.001], "upper": [0.003], "cell_size": 2e-5},
        "time": {"end": 1e-7},
        "materials": {"metal": {"library": "copper"}},
        "bodies": [
            {"name": "flyer", "material": "metal", "box": {"lower": [-0.0005], "upper": [0.0]},
             "velocity": [500.0], "particles_per_cell": [1]},
            {"name": "target", "material": "metal", "box": {"lower": [0.0], "upper": [0.002]},
             "velocity": [0.0], "particles_per_cell": [1]},
        ],
    })
}

fn edited(edits: &[(&str, Value)]) -> CheckedScene {
    let mut scene = plates();
    for (path, value) in edits {
        match path.rsplit_once('/') {
            Some(("", key)) => scene[key] = value.clone(),
            Some((parent, key)) => scene.pointer_mut(parent).unwrap()[key] = value.clone(),
            None => panic!("{path}"),
        }
    }
    parse(scene.to_string().as_bytes(), "plates.json", &[]).unwrap()
}

fn choice(scene: &CheckedScene) -> &MethodChoice {
    scene.method_choice.as_ref().expect("a preset")
}

#[track_caller]
fn transfer_is(edits: &[(&str, Value)], transfer: &Value, reason: &str) {
    let scene = edited(edits);
    assert_eq!(&json!(scene.scene.method.transfer), transfer, "{edits:?}");
    let reasons = &choice(&scene).reasons;
    assert!(reasons.iter().any(|r| r.contains(reason)), "no `{reason}` in {reasons:?}");
}

/// Edits that give both plates `count` particles per cell.
fn per_cell(count: u32) -> [(&'static str, Value); 2] {
    ["/bodies/0/particles_per_cell", "/bodies/1/particles_per_cell"]
        .map(|path| (path, json!([count])))
}

/// Linear and quadratic viscosity, and the linear one in expansion.
fn viscosity(scene: &CheckedScene) -> (f64, f64, Option<f64>) {
    let viscosity = scene.scene.artificial_viscosity.expect("a viscosity");
    (viscosity.linear, viscosity.quadratic, viscosity.expansion)
}

/// Viscosity in expansion comes with the contents and keys with which it was measured.
#[test]
fn impacts_have_viscosity_in_expansion() {
    let order = |scene: &CheckedScene| json!(scene.scene.method.transfer)["fmpm"].clone();
    let [few, usual] = [1, 2].map(|count| edited(&per_cell(count)));
    assert_eq!([order(&few), order(&usual)], [json!(8), json!(14)]);
    for (courant, least) in [(0.41, 6), (0.5, 6), (0.6, 4), (0.8, 2), (0.81, 2)] {
        let edits = [per_cell(1).to_vec(), vec![("/time/courant", json!(courant))]].concat();
        assert_eq!(order(&edited(&edits)), json!(least), "one particle per cell at {courant}");
    }
    assert_eq!(viscosity(&usual), (0.055, 0.85, Some(0.02)));
    let with_key = |path: &'static str, value: Value| {
        let scene = edited(&[per_cell(2).to_vec(), vec![(path, value)]].concat());
        (order(&scene), viscosity(&scene))
    };
    let former = (json!(8), (0.15, 0.5, None));
    assert_eq!(with_key("/time/courant", json!(0.81)), former);
    assert_eq!(with_key("/time/courant", json!(0.8)).0, 14);
    let sharpest = edited(
        &[
            per_cell(2).to_vec(),
            vec![("/method", json!("sharpest")), ("/time/courant", json!(0.61))],
        ]
        .concat(),
    );
    assert_eq!(viscosity(&sharpest), (0.035, 0.0, None));
    assert_eq!(with_key("/body_force", json!({"gravity": [-10.0]})), former);
    let flip = json!({"preset": "default", "transfer": "flip"});
    assert_eq!(with_key("/method", flip).1, former.1);
    let own = json!({"linear": 0.2, "quadratic": 1.0});
    assert_eq!(with_key("/artificial_viscosity", own), (json!(8), (0.2, 1.0, None)));
    assert_eq!(with_key("/method", json!("sharpest")).1, (0.03, 0.0, Some(0.035)));
    let cutoff = json!({"metal": {"library": "copper", "eos": {"tension_cutoff": 1e9}}});
    assert_eq!(with_key("/materials", cutoff), former);
    // in a plane
    let mut oblique: Value = serde_json::from_slice(&shipped("oblique_impact.json")).unwrap();
    for key in ["method", "artificial_viscosity", "reference"] {
        oblique.as_object_mut().unwrap().remove(key);
    }
    for key in ["contact", "body_force"] {
        oblique[key] = Value::Null;
    }
    let made = |edits: &[(&str, Value)]| {
        let mut scene = oblique.clone();
        edits.iter().for_each(|(path, value)| *scene.pointer_mut(path).unwrap() = value.clone());
        let scene = parse(scene.to_string().as_bytes(), "oblique.json", &[]).unwrap();
        let order = json!(scene.scene.method.transfer)["fmpm"].as_u64();
        (order, scene.scene.method.mass_lumping, viscosity(&scene).2)
    };
    let one = |path, value| made(&[(path, value)]);
    let plain = (Some(4), None, None);
    let matched = (Some(6), Some(0.03), Some(0.1));
    assert_eq!(made(&[]), matched);
    assert_eq!(one("/time/courant", json!(0.81)), plain);
    assert_eq!(one("/time/courant", json!(0.8)), (Some(6), Some(0.12), Some(0.1)));
    let contact = ("/contact", json!({"type": "frictionless"}));
    assert_eq!(made(std::slice::from_ref(&contact)), (Some(6), Some(0.03), Some(0.02)));
    let with = |model: &str, value: Value| {
        let mut materials = oblique["materials"].clone();
        materials["aluminium"][model] = value;
        ("/materials", materials)
    };
    let strength = with(
        "strength",
        json!({"type": "von_mises", "shear_modulus": 2.7e10, "yield_stress": 3e8}),
    );
    let larger = (Some(6), Some(0.07), Some(0.1));
    assert_eq!(made(std::slice::from_ref(&strength)), larger);
    assert_eq!(made(&[with("failure", json!({"type": "tension_limit", "stress": 1e9}))]), larger);
    assert_eq!(made(&[strength, contact]), (Some(6), Some(0.07), Some(0.02)));
    assert_eq!(one("/body_force", json!({"gravity": [0.0, -10.0]})), plain);
    let sparse = |courant: f64| {
        made(&[("/bodies/0/particles_per_cell", json!([1, 1])), ("/time/courant", json!(courant))])
    };
    assert_eq!([0.4, 0.6].map(|c| sparse(c).0), [Some(6), Some(4)]);
    assert_eq!([0.6, 0.61].map(|c| sparse(c).1), [Some(0.0675), None]);
    assert_eq!(sparse(0.61).0, Some(4));
}

#[test]
fn a_scene_without_a_method_has_that_of_the_flyer() {
    let [own, flyer] = [edited(&[]), with("flyer.json", &[]).unwrap()];
    // the plates stay in contact
    let mut method = json!(flyer.scene.method);
    method["frame"] = json!("total_lagrangian");
    method["mass_lumping"] = json!(0.03);
    assert_eq!(json!(own.scene.method), method);
    assert_eq!(viscosity(&own), (0.055, 0.85, Some(0.02)));
    assert_eq!(choice(&own).preset, Preset::Default);
    assert_eq!(flyer.method_choice, None);
    let named = edited(&[("/method", json!("default"))]);
    assert_eq!(json!(named.scene.method), json!(own.scene.method));
}

/// The share of the lumped mass follows the Courant number, and is left out with what excludes it.
#[test]
fn impacts_have_a_share_of_the_lumped_mass() {
    let lumping = |edits: &[(&str, Value)]| edited(edits).scene.method.mass_lumping;
    assert_eq!(lumping(&[]), Some(0.03));
    let shares = [(0.01, None), (0.2, Some(0.0075)), (0.6, Some(0.0675)), (0.81, None)];
    for (courant, share) in shares {
        assert_eq!(lumping(&[("/time/courant", json!(courant))]), share, "{courant}");
    }
    let strong = json!({"metal": {"library": "copper_johnson_cook"}});
    let own = json!({"preset": "default", "mass_lumping": 0.07});
    let edits = [("/materials", strong), ("/method", own)];
    let strong = edited(&[&per_cell(2)[..], &edits].concat()).scene.method;
    assert!(strong.flux_limiter.is_none() && strong.mass_lumping == Some(0.07));
    let explicit = |key: &str, value: Value| {
        let mut method = json!({"preset": "default"});
        method[key] = value;
        lumping(&[("/method", method)])
    };
    assert_eq!(explicit("mass_lumping", json!(0.1)), Some(0.1));
    assert_eq!(explicit("mass_lumping", Value::Null), None);
    assert_eq!(explicit("flux_limiter", json!({"neighbours": 1})), None);
    assert_eq!(explicit("flux_limiter", Value::Null), Some(0.03));
}

#[test]
fn contents_change_the_default() {
    transfer_is(&[], &json!({"fmpm": 8}), "FMPM(8)");
    let contact = |preset: &str| {
        let contact = ("/contact", json!({"type": "frictionless"}));
        edited(&[&per_cell(2)[..], &[contact, ("/method", json!(preset))]].concat())
    };
    let [default, robust, sharpest] = ["default", "robust", "sharpest"].map(contact);
    assert_eq!(json!(default.scene.method)["transfer"], json!({"fmpm": 14}));
    assert_eq!(default.scene.method.mass_lumping, Some(0.03));
    assert_eq!(viscosity(&default), (0.055, 0.85, Some(0.02)));
    for other in [robust, sharpest] {
        assert_eq!(json!(other.scene.method), json!(default.scene.method));
        assert_eq!(viscosity(&other), viscosity(&default));
    }
    let strong = ("/materials", json!({"metal": {"library": "copper_johnson_cook"}}));
    let strong = [&per_cell(2)[..], &[strong]].concat();
    transfer_is(&strong, &json!({"fmpm": 12}), "flux limiter");
    assert_eq!(viscosity(&edited(&strong)), (0.03, 0.4, None));
    let explosive = with("detonation.json", &["method=default"]).unwrap();
    assert_eq!(json!(explosive.scene.method.transfer), json!({"fmpm": 2}));
    assert!(choice(&explosive).reasons.join("; ").contains("burn fronts"));
    let gas = json!({"metal": {"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}}});
    let warm = json!([{"name": "gas", "material": "metal", "pressure": 1e5, "velocity": [0.0],
        "box": {"lower": [0.0], "upper": [0.002]}, "particles_per_cell": [2]}]);
    let edits = [("/materials", gas), ("/bodies", warm)];
    transfer_is(&edits, &json!({"fmpm": 6}), "domain limit");
    assert_eq!(edited(&edits).scene.method.mass_lumping, Some(0.07));
    assert!(edited(&edits).scene.method.domain_limit.is_some());
    assert!(edited(&[]).scene.method.domain_limit.is_none());
}

/// Order, share of the lumped mass and viscosity on a line. Failure and strength have a larger share,
/// unless the scene has what it was not measured with.
#[test]
fn tension_gas_and_contact_change_the_share_of_the_lumped_mass() {
    let limit = json!({"type": "tension_limit", "stress": 1e9});
    let gas = json!({"density": 1.0, "eos": {"type": "ideal_gas", "gamma": 1.4}});
    let rubber = json!({"density": 1000.0,
        "eos": {"type": "neo_hookean", "youngs_modulus": 1e9, "poissons_ratio": 0.3}});
    let metal = |metal: Value| ("/materials", json!({"metal": metal}));
    let strong = metal(json!({"library": "copper_johnson_cook"}));
    let failing = metal(json!({"library": "copper", "failure": limit}));
    let both = metal(json!({"library": "copper_johnson_cook", "failure": limit}));
    let cutoff = metal(json!({"library": "copper", "eos": {"tension_cutoff": 1e9}}));
    let [gas, rubber] = [gas, rubber].map(metal);
    let contact = ("/contact", json!({"type": "frictionless"}));
    let courant = |courant: f64| ("/time/courant", json!(courant));
    let gravity = ("/body_force", json!({"gravity": [-10.0]}));
    let method = |key: &str, value: Value| {
        let mut method = json!({"preset": "default"});
        method[key] = value;
        ("/method", method)
    };
    let made = |edits: &[&(&'static str, Value)]| {
        let edits: Vec<_> = edits.iter().map(|edit| (*edit).clone()).collect();
        let scene = edited(&[&per_cell(2)[..], &edits].concat());
        let transfer = json!(scene.scene.method.transfer)["fmpm"].clone();
        (transfer, scene.scene.method.mass_lumping, viscosity(&scene))
    };
    let shared = (json!(18), Some(0.07), (0.08, 1.0, Some(0.03)));
    let limited = (json!(12), None, (0.03, 0.4, None));
    let moderate = (json!(6), None, (0.1, 1.25, None));
    let strongest = (json!(6), None, (0.2, 2.0, None));
    let robust = ("/method", json!("robust"));
    for (edits, expected) in [
        (vec![&failing], &shared),
        (vec![&both], &shared),
        (vec![&strong, &contact], &shared),
        (vec![&failing, &robust], &shared),
        (vec![&failing, &courant(0.81)], &moderate),
        (vec![&failing, &gravity], &moderate),
        (vec![&failing, &method("mass_lumping", Value::Null)], &moderate),
        (vec![&contact, &cutoff], &moderate),
        (vec![&contact, &rubber], &moderate),
        (vec![&strong, &contact, &courant(0.81)], &strongest),
        (vec![&strong, &gravity, &courant(0.6)], &strongest),
        // the flux limiter, and what it does not suit
        (vec![&strong], &limited),
        (vec![&strong, &courant(0.3)], &limited),
        (vec![&strong, &courant(0.5)], &limited),
        (vec![&strong, &gravity], &limited),
        (vec![&strong, &method("flux_limiter", Value::Null)], &shared),
        (vec![&strong, &method("mass_lumping", json!(0.07))], &shared),
        // gas
        (vec![&gas], &(json!(6), Some(0.07), moderate.2)),
        (vec![&gas, &contact], &(json!(6), Some(0.07), moderate.2)),
        (vec![&gas, &gravity], &moderate),
    ] {
        assert_eq!(&made(&edits), expected, "{edits:?}");
    }
    for (number, share) in [(0.29, 0.0558), (0.51, 0.0888), (0.8, 0.16)] {
        assert_eq!(made(&[&strong, &courant(number)]).1, Some(share));
    }
    // one particle per cell
    let sparse = per_cell(1);
    let sparse =
        |edits: &[&(&'static str, Value)]| made(&[edits, &[&sparse[0], &sparse[1]]].concat()).0;
    for (number, order) in [(0.4, 8), (0.6, 4), (0.8, 2)] {
        for edits in [vec![&contact], vec![&strong], vec![&failing]] {
            assert_eq!(sparse(&[edits, vec![&courant(number)]].concat()), order);
        }
    }
}

/// The scenes whose plates separate have the method that their contents would get.
#[test]
fn scenes_with_contact_have_the_default() {
    for name in ["gap.json", "soft_flyer.json", "three_plates.json"] {
        let mut value: Value = serde_json::from_slice(&shipped(name)).unwrap();
        let own = parse(value.to_string().as_bytes(), name, &[]).unwrap().scene;
        for key in ["method", "artificial_viscosity"] {
            value.as_object_mut().unwrap().remove(key);
        }
        let chosen = parse(value.to_string().as_bytes(), name, &[]).unwrap().scene;
        assert_eq!(json!(own.method), json!(chosen.method), "{name}");
        assert_eq!(json!(own.artificial_viscosity), json!(chosen.artificial_viscosity), "{name}");
    }
}

#[test]
fn bodies_in_two_dimensions_get_a_domain_limit_and_elastic_ones_no_relaxation() {
    let plane = with("disks.json", &["method=default"]).unwrap();
    assert_eq!(plane.scene.method.domain_limit, Some(0.7));
    assert!(plane.scene.method.pressure_relaxation.is_none());
    let fluid = with("oblique_impact.json", &["method=default"]).unwrap();
    assert!(fluid.scene.method.pressure_relaxation.is_some());
}

#[test]
fn heat_is_spread_in_two_dimensions_where_there_is_numerical_heat_of_fluids() {
    let steps = |name: &str, mut method: Value| {
        method["preset"] = json!("default");
        let scene = with(name, &[&format!("method={method}")]).unwrap();
        scene.scene.method.heat_spreading.map(|spreading| spreading.steps)
    };
    let plane = |method: Value| steps("oblique_impact.json", method);
    assert_eq!(plane(json!({})), Some(50.0));
    assert_eq!(plane(json!({"heat_spreading": {"steps": 3}})), Some(3.0));
    assert_eq!(plane(json!({"filter_heat": false})), Some(50.0));
    for without in [
        json!({"stepping": "leapfrog"}),
        json!({"transfer": "apic"}),
        json!({"energy": "textbook", "filter_heat": false}),
        json!({"heat_spreading": null}),
    ] {
        assert_eq!(plane(without.clone()), None, "{without}");
    }
    // on a line, of elastic solids, and of gases
    for name in ["flyer.json", "disks.json", "noh_axis.json"] {
        assert_eq!(steps(name, json!({})), None, "{name}");
    }
}

#[test]
fn the_heat_of_a_gas_that_moves_at_the_start_is_mixed() {
    let scene = |name: &str, edits: &[&str]| {
        let edits: Vec<&str> = ["method=default"].iter().chain(edits).copied().collect();
        json!(with(name, &edits).unwrap().scene)
    };
    let coefficient =
        |name: &str, edits: &[&str]| scene(name, edits)["heat_mixing"]["coefficient"].as_f64();
    let moves = "bodies.left.velocity=[1]";
    assert_eq!(coefficient("sod.json", &[]), None);
    assert_eq!(coefficient("sod.json", &[moves]), Some(20.0));
    let rate = r#"heat_mixing={"coefficient": 5}"#;
    assert_eq!(coefficient("sod.json", &[moves, rate]), Some(5.0));
    assert_eq!(coefficient("sod.json", &[moves, "heat_mixing=null"]), None);
    assert_eq!(coefficient("flyer.json", &[]), None, "a solid");
    let solid = r#"materials.gas_right={"library": "copper"}"#;
    let beside = [moves, solid, "bodies.right.pressure=0", "reference=null"];
    assert_eq!(coefficient("sod.json", &beside), None, "a solid beside the gas");
    // a weak viscosity only together with it
    let viscosity = |mixing: &str| {
        let mut value: Value = serde_json::from_slice(&crate::shipped("noh_axis.json")).unwrap();
        for key in ["method", "artificial_viscosity", "heat_mixing"] {
            value.as_object_mut().unwrap().remove(key);
        }
        let sets: Vec<String> =
            Some(mixing.to_string()).filter(|s| !s.is_empty()).into_iter().collect();
        let scene = parse(value.to_string().as_bytes(), "noh.json", &sets).unwrap().scene;
        let viscosity = scene.artificial_viscosity.unwrap();
        (viscosity.linear, viscosity.quadratic)
    };
    assert_eq!(viscosity(""), (0.05, 0.2));
    assert_eq!(viscosity("heat_mixing=null"), (0.1, 0.5));
    // the scenes have the mixing and the viscosity of the preset
    for name in ["noh_planar.json", "noh_axis.json", "noh_cylindrical.json"] {
        let mut value: Value = serde_json::from_slice(&crate::shipped(name)).unwrap();
        let keys = ["artificial_viscosity", "heat_mixing"];
        let own = keys.map(|key| value[key].clone());
        for key in ["method"].iter().chain(&keys) {
            value.as_object_mut().unwrap().remove(*key);
        }
        let chosen = json!(parse(value.to_string().as_bytes(), name, &[]).unwrap().scene);
        for (key, own) in keys.iter().zip(own) {
            for (name, number) in own.as_object().unwrap() {
                assert_eq!(&chosen[key][name], number, "{key}.{name}");
            }
        }
    }
}

#[test]
fn sheared_gases_in_a_plane_have_cubic_splines() {
    let with_preset = |file: &str, edit: fn(&mut Value)| {
        let mut value: Value = serde_json::from_slice(&crate::shipped(file)).unwrap();
        for key in ["method", "artificial_viscosity"] {
            value.as_object_mut().unwrap().remove(key);
        }
        edit(&mut value);
        json!(parse(value.to_string().as_bytes(), file, &[]).unwrap().scene)
    };
    // the scene has the method and the viscosity of the preset
    let own = json!(with("gresho.json", &[]).unwrap().scene);
    let chosen = with_preset("gresho.json", |_| ());
    for key in ["method", "artificial_viscosity", "heat_mixing"] {
        assert_eq!(chosen[key], own[key], "{key}");
    }
    assert_eq!(with_preset("shear_layer.json", |_| ())["method"], own["method"]);
    // other keys of the scene exclude options, or want domains that deform
    let with_keys = |keys: Value| {
        let mut value: Value = serde_json::from_slice(&crate::shipped("gresho.json")).unwrap();
        value["method"] = keys;
        value["method"]["preset"] = json!("default");
        json!(parse(value.to_string().as_bytes(), "g", &[]).unwrap().scene)["method"].clone()
    };
    for keys in [
        json!({"transfer": "flip"}),
        json!({"transfer": "apic"}),
        json!({"stepping": "leapfrog"}),
        json!({"edge_mask": null}),
    ] {
        assert!(with_keys(keys.clone())["volume_relaxation"].is_null(), "{keys}");
    }
    let limited = with_keys(json!({"domain_limit": 0.5}));
    assert_eq!(
        [&limited["shape"], &limited["domain_limit"]],
        [&json!("cpdi_bspline_quadratic"), &json!(0.5)]
    );
    let deforming = with_keys(json!({"shape": "cpdi_bspline_quadratic"}));
    assert_eq!(deforming["domain_limit"], 0.7);
    let contact =
        with_preset("gresho.json", |value| value["contact"] = json!({"type": "frictionless"}));
    assert_eq!(contact["method"]["shape"], "cpdi_bspline_quadratic");
    let moving = with_preset("gresho.json", |value| {
        let body = value["bodies"][0].as_object_mut().unwrap();
        body.remove("velocity_field");
        body.insert("velocity".into(), json!([1, 0]));
        value["bodies"][0]["pressure"] = json!(5);
        value.as_object_mut().unwrap().remove("reference");
    });
    assert_eq!(moving["method"]["shape"], "cpdi_bspline_quadratic");
    assert_eq!(moving["heat_mixing"]["coefficient"], 20.0);
}

#[test]
fn gases_of_different_pressures_in_a_plane_relax_slowly() {
    let rate = |name: &str, edits: &[&str]| {
        let edits: Vec<&str> = ["method=default"].iter().chain(edits).copied().collect();
        with(name, &edits).unwrap().scene.method.pressure_relaxation.unwrap().rate
    };
    assert_eq!(rate("sod_2d.json", &[]), 0.02);
    assert_eq!(rate("sod_2d.json", &["bodies.right.pressure=1"]), 0.2);
    assert_eq!(rate("sod.json", &[]), 0.1, "on a line");
    assert_eq!(rate("noh_axis.json", &[]), 0.2, "a single gas");
}

#[test]
fn bodies_that_may_turn_have_spin() {
    let spin = |more: &[&str]| {
        let edits: Vec<&str> = ["method=default"].iter().chain(more).copied().collect();
        with("disks.json", &edits).unwrap().scene.method.spin
    };
    let [contact, gravity] =
        [r#"contact={"type": "frictionless"}"#, r#"body_force={"gravity": [0, -10]}"#];
    assert!(spin(&[]) && spin(&[contact]) && spin(&[contact, gravity]));
    // a body in free fall would carry stress at its edges, as it does with contact anyway
    assert!(!spin(&[gravity]));
}

#[test]
fn presets_differ() {
    let preset = |name: &str| edited(&[&per_cell(2)[..], &[("/method", json!(name))]].concat());
    let [default, robust, sharpest] = ["default", "robust", "sharpest"].map(preset);
    let of = |scene: &CheckedScene| (scene.scene.method.mass_lumping, viscosity(scene));
    assert_eq!(of(&default), (Some(0.03), (0.055, 0.85, Some(0.02))));
    assert_eq!(of(&robust), (Some(0.07), (0.12, 1.25, Some(0.05))));
    assert_eq!(of(&sharpest), (None, (0.03, 0.0, Some(0.035))));
    assert_eq!(json!(sharpest.scene.method)["frame"], "total_lagrangian");
    // plates apart never meet in that frame
    let apart = edited(&[
        ("/method", json!("sharpest")),
        ("/bodies/1/box", json!({"lower": [0.00002], "upper": [0.002]})),
    ]);
    assert_eq!(json!(apart.scene.method)["frame"], Value::Null);
    // what the frame does not suit
    for (material, transfer) in [("copper_johnson_cook", 12), ("copper", 14)] {
        let materials = json!({"metal": {"library": material}});
        let edits = [("/method", json!("sharpest")), ("/materials", materials)];
        let scene = edited(&[&per_cell(2)[..], &edits].concat());
        assert_eq!(json!(scene.scene.method.transfer), json!({"fmpm": transfer}), "{material}");
    }
    let eos = json!({"type": "neo_hookean", "youngs_modulus": 1e9, "poissons_ratio": 0.3});
    let rubber = json!({"metal": {"density": 1000.0, "eos": eos}});
    let elastic = edited(&[("/method", json!("sharpest")), ("/materials", rubber)]);
    assert!(elastic.scene.method.pressure_relaxation.is_none());
}

/// Order, share of the lumped mass and viscosity of `robust`. Scenes for which they were not measured
/// have no share, and a moderate viscosity.
#[test]
fn robust_depends_on_courant_number_and_particles_per_cell() {
    let robust = |count: u32, edits: &[(&str, Value)]| {
        let method = ("/method", json!("robust"));
        let scene = edited(&[&per_cell(count)[..], &[method], edits].concat());
        let order = json!(scene.scene.method.transfer)["fmpm"].clone();
        (order, scene.scene.method.mass_lumping, viscosity(&scene))
    };
    let courant = |number: f64| [("/time/courant", json!(number))];
    let own = (0.12, 1.25, Some(0.05));
    let moderate = (0.1, 1.25, None);
    assert_eq!(robust(2, &[]), (json!(14), Some(0.07), own));
    assert_eq!(robust(2, &courant(0.2)), (json!(14), Some(0.0475), own));
    assert_eq!(robust(3, &courant(1.0)), (json!(14), Some(0.2275), own));
    assert_eq!(robust(1, &courant(0.4)), (json!(8), Some(0.07), own));
    assert_eq!(robust(1, &courant(0.6)), (json!(4), Some(0.1075), own));
    assert_eq!(robust(1, &courant(0.8)), (json!(2), Some(0.16), own));
    assert_eq!(robust(1, &courant(0.9)), (json!(2), None, moderate));
    let eos = json!({"type": "mie_gruneisen", "c0": 3940.0, "s": 1.489, "gamma0": 1.96,
        "tension_cutoff": 1e9});
    let limited = [("/materials/metal", json!({"density": 8930.0, "eos": eos}))];
    assert_eq!(robust(2, &limited), (json!(6), None, moderate));
}

#[test]
fn plates_that_stay_in_contact_get_the_total_lagrangian_frame() {
    let frame = |edits: &[(&str, Value)]| json!(edited(edits).scene.method)["frame"].clone();
    assert_eq!(frame(&[]), "total_lagrangian");
    let apart = ("/bodies/1/box", json!({"lower": [0.00002], "upper": [0.002]}));
    assert_eq!(frame(&[apart]), Value::Null, "plates apart");
    assert_eq!(frame(&[("/contact", json!({"type": "stick"}))]), Value::Null, "contact");
    // an option that the frame excludes
    let limit = json!({"preset": "default", "domain_limit": 2.0});
    assert_eq!(frame(&[("/method", limit)]), Value::Null);
    // the release of the softer plate parts them before the end
    let soft = json!({"metal": {"library": "copper"}, "soft": {"library": "pmma"}});
    let parted = |flyer: &str, target: &str| {
        frame(&[
            ("/time/end", json!(5e-7)),
            ("/materials", soft.clone()),
            ("/bodies/0/material", json!(flyer)),
            ("/bodies/1/material", json!(target)),
        ])
    };
    assert_eq!(parted("soft", "metal"), Value::Null);
    assert_eq!(parted("metal", "soft"), "total_lagrangian");
}

#[test]
fn explicit_keys_override_a_preset() {
    let scene = edited(&[("/method", json!({"preset": "default", "edge_mask": 0.2}))]);
    assert_eq!(scene.scene.method.edge_mask, Some(0.2));
    assert!(scene.scene.method.filter_heat);
    // what they exclude is left out, and named
    let scene = edited(&[("/method", json!({"preset": "default", "transfer": "flip"}))]);
    assert!(scene.scene.method.edge_mask.is_none() && !scene.scene.method.filter_heat);
    let reasons = choice(&scene).reasons.join("; ");
    assert!(reasons.contains("exclude it: filter_heat, edge_mask"), "{reasons}");
    edited(&[("/method", json!({"preset": "default", "stepping": "leapfrog"}))]);
    edited(&[("/method", json!({"preset": "robust", "transfer": "apic"}))]);
    let none = edited(&[("/artificial_viscosity", Value::Null)]);
    assert!(none.scene.artificial_viscosity.is_none());
    let own = json!({"linear": 0.3, "quadratic": 1.0});
    let own = edited(&[("/artificial_viscosity", own)]);
    assert_eq!(own.scene.artificial_viscosity.unwrap().linear, 0.3);
}

#[test]
fn unknown_presets_are_refused() {
    let mut scene = plates();
    scene["method"] = json!("robst");
    refused_text(&scene.to_string(), &["method = \"robst\"", "did you mean robust?", "sharpest"]);
    scene["method"] = json!({"preset": "sharp", "edge_mask": 0.1});
    refused_text(&scene.to_string(), &["method.preset = \"sharp\"", "allowed: default, robust"]);
    scene["method"] = json!({"edge_mask": 0.1});
    let error = parse(scene.to_string().as_bytes(), "bad.json", &[]).unwrap_err();
    mentions_all(
        &error.to_string(),
        &["method.shape: missing key", "method.transfer: missing key"],
    );
}

/// The published schema takes every form of `method` that a scene can have, and no other.
#[test]
fn the_schema_describes_every_form() {
    let validator = jsonschema::validator_for(&flyer_mpm::input::schema()).unwrap();
    let valid = |method: Value| {
        let mut scene = plates();
        scene["method"] = method;
        validator.is_valid(&scene)
    };
    assert!(validator.is_valid(&plates()));
    assert!(valid(json!("robust")) && valid(json!({"preset": "robust", "edge_mask": 0.1})));
    assert!(valid(json!({"shape": "cpdi", "transfer": "flip"})));
    assert!(!valid(json!("robst")) && !valid(json!({"edge_mask": 0.1})));
    assert!(!valid(json!({"preset": "robust", "edge_musk": 0.1})));
}

//! Every option does something, and what is not named costs no column.

use std::collections::BTreeMap;

use decomp::Serial;
use flyer_mpm::simulation::Simulation;
use serde_json::{Value, json};

use crate::tools::{SHAPES, checked, run_scene, shipped, short, transfers, with};

/// A thin flyer, so that release waves and free surfaces take part.
fn thin(name: &str) -> Value {
    let mut value = short(name, 6e-8);
    value["domain"]["upper"] = json!([0.0013]);
    value["bodies"][1]["box"]["upper"] = json!([0.001]);
    value["bodies"][0]["box"]["lower"] = json!([-0.0001]);
    value
}

/// Runs each edit of `base`; no two may leave the same state.
#[track_caller]
fn all_differ(base: &Value, edits: &[Value]) {
    let mut known = BTreeMap::new();
    for edit in edits {
        let outcome = run_scene(&checked(&with(base, edit)), 1);
        let digest = outcome.unwrap_or_else(|e| panic!("{edit}: {e}")).digest;
        if let Some(other) = known.insert(digest, edit) {
            panic!("{edit} and {other} leave the same state");
        }
    }
}

#[test]
fn each_shape_function_is_its_own() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        let edits: Vec<Value> = SHAPES.map(|s| json!({"method": {"shape": s}})).into();
        all_differ(&thin(name), &edits);
    }
}

#[test]
fn each_transfer_and_order_of_stress_is_its_own() {
    let mut edits = Vec::new();
    for transfer in transfers() {
        for update in ["last", "first", "modified_last"] {
            edits.push(json!({"method": {"transfer": transfer, "stress_update": update}}));
        }
    }
    edits.push(json!({"method": {"transfer": {"flip_pic": 0.5}}}));
    edits.push(json!({"method": {"transfer": {"fmpm": 3}}}));
    edits.push(json!({"method": {"stepping": "midpoint"}}));
    all_differ(&thin("flyer_uintah.json"), &edits);
}

/// The two ends of the blend are its names.
#[test]
fn a_blend_of_nothing_but_one_is_that_one() {
    for name in ["flyer.json", "flyer_uintah.json"] {
        let digest = |transfer: Value| {
            let method = json!({"transfer": transfer, "edge_mask": null, "filter_heat": null});
            run_scene(&checked(&with(&thin(name), &json!({"method": method}))), 1).unwrap().digest
        };
        assert_eq!(digest(json!({"flip_pic": 1.0})), digest(json!("flip")));
        assert_eq!(digest(json!({"flip_pic": 0.0})), digest(json!("pic")));
    }
}

#[test]
fn each_option_of_the_default_changes_the_run() {
    let method = |edit: Value| json!({"method": edit});
    let viscosity = |edit: Value| json!({"artificial_viscosity": edit});
    let edits = [
        json!({}),
        method(json!({"transfer": {"fmpm": 5}})),
        method(json!({"transfer": {"xpic": 6}, "edge_mask": null})),
        method(json!({"energy": "textbook"})),
        method(json!({"filter_heat": false})),
        method(json!({"heat_spreading": {"steps": 1}})),
        method(json!({"heat_spreading": {"steps": 10}})),
        method(json!({"pressure_relaxation": null})),
        method(json!({"pressure_relaxation": {"rate": 0.2}})),
        method(json!({"pressure_relaxation": {"interval": 3}})),
        method(json!({"edge_mask": null})),
        method(json!({"edge_mask": 0.9})),
        method(json!({"mass_lumping": 0.05})),
        viscosity(Value::Null),
        viscosity(json!({"linear": 0.2})),
        viscosity(json!({"quadratic": 0.75})),
        viscosity(json!({"growth": null})),
        viscosity(json!({"growth": {"rate": 12.0}})),
        viscosity(json!({"limiter": null})),
        viscosity(json!({"limiter": "nodal"})),
        viscosity(json!({"limited": "both"})),
        viscosity(json!({"limiter": "nodal", "limited": "both"})),
        json!({"time": {"courant": 0.3}}),
        json!({"impact_smoothing": 1.0}),
        json!({"impact_smoothing": 2.0}),
        json!({"domain": {"cell_size": 2e-5}}),
    ];
    all_differ(&thin("flyer.json"), &edits);
}

#[test]
fn each_property_of_a_body_and_material_changes_the_run() {
    let base = thin("flyer.json");
    let edits: Vec<Value> = [
        ("/bodies/1/particles_per_cell/0", json!(3)),
        ("/bodies/1/velocity/0", json!(-10.0)),
        ("/materials/copper/density", json!(8900.0)),
        ("/materials/copper/eos/c0", json!(3900.0)),
        ("/materials/copper/eos/s", json!(1.5)),
        ("/materials/copper/eos/gamma0", json!(2.0)),
    ]
    .into_iter()
    .map(|(place, new)| {
        let mut value = base.clone();
        *value.pointer_mut(place).unwrap() = new;
        value
    })
    .chain([base.clone()])
    .collect();
    all_differ(&json!({}), &edits);
    let mut edits = vec![shipped("sod.json"); 3];
    edits[1]["bodies"][1]["pressure"] = json!(0.2);
    edits[2]["materials"]["gas_left"]["eos"]["gamma"] = json!(1.5);
    all_differ(&json!({}), &edits);
}

#[test]
fn each_side_changes_the_run() {
    // the slab runs away from the lower side, and its tension stays small
    let mut base = thin("flyer.json");
    base["bodies"].as_array_mut().unwrap().remove(0);
    base["materials"].as_object_mut().unwrap().remove("copper");
    base.as_object_mut().unwrap().remove("reference");
    base["domain"] = json!({"lower": [0.0], "upper": [0.001], "cell_size": 1e-5});
    base["bodies"][0]["velocity"] = json!([200.0]);
    base["bodies"][0]["box"] = json!({"lower": [0.0], "upper": [0.001]});
    let edits = [
        json!({"x_lower": "free", "x_upper": "outflow"}),
        json!({"x_lower": "wall", "x_upper": "outflow"}),
        json!({"x_lower": "free", "x_upper": "symmetry"}),
        json!({"x_lower": "symmetry", "x_upper": "symmetry"}),
        json!({"x_lower": "periodic", "x_upper": "periodic"}),
        json!({"x_lower": {"velocity": 500.0}, "x_upper": "outflow"}),
        json!({"x_lower": {"velocity": 550.0}, "x_upper": "outflow"}),
    ]
    .map(|boundary| json!({"boundary": boundary}));
    all_differ(&base, &edits);
    let digest = |lower: &str| {
        let boundary = json!({"x_lower": lower, "x_upper": "outflow"});
        run_scene(&checked(&with(&base, &json!({"boundary": boundary}))), 1).unwrap().digest
    };
    assert_eq!(digest("wall"), digest("symmetry"), "the same in one dimension");
}

#[test]
fn what_is_not_named_has_no_column() {
    let columns = |name: &str, edit: Value| {
        let scene = checked(&with(&short(name, 1e-8), &edit));
        let simulation = Simulation::<1>::new(&scene, &Serial, 1).unwrap();
        simulation.columns().clone()
    };
    let all = columns("flyer.json", json!({}));
    assert!(all.viscosity.is_some() && all.limiter.is_some() && all.jacobian_mid.is_some());
    assert!(all.pressure_mid.is_some() && all.compliance.is_some() && all.affine.is_none());
    let none = columns("flyer_uintah.json", json!({"artificial_viscosity": null}));
    assert!(none.viscosity.is_none() && none.limiter.is_none() && none.jacobian_mid.is_none());
    assert!(none.pressure_mid.is_none() && none.compliance.is_none() && none.affine.is_none());
    assert!(none.specs.len() + 5 == all.specs.len(), "an effect has columns of its own");
    let c = columns("flyer.json", json!({"method": {"pressure_relaxation": null}}));
    assert!(c.pressure_mid.is_none() && c.compliance.is_none());
    let c = columns("flyer.json", json!({"artificial_viscosity": {"limiter": null}}));
    assert!(c.viscosity.is_some() && c.limiter.is_none());
    let c = columns("flyer_uintah.json", json!({"method": {"transfer": "apic"}}));
    assert!(c.affine.is_some());
}

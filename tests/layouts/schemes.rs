//! Every shape with every transfer, over layouts in which every pair of choices occurs.

use serde_json::{Value, json};

use crate::in_process::end_of;
use crate::layouts::Layout;
use crate::scenes::{SHAPES, shipped};
use crate::small_scenes::{ending, small, small_leapfrog, small_midpoint};

/// Transfers, one of each kind.
fn transfers() -> [Value; 6] {
    let [xpic, fmpm] = [json!({"xpic": 3}), json!({"fmpm": 4})];
    [json!("flip"), json!("pic"), json!("apic"), json!({"flip_pic": 0.9}), xpic, fmpm]
}

/// Each layout of the covering leaves what one patch of one rank leaves.
#[track_caller]
fn same(scene: &Value, what: &str) {
    let whole = end_of(scene, &Layout::WHOLE);
    assert!(whole.is_ok(), "{what}: {whole:?}");
    for layout in Layout::covering() {
        assert_eq!(end_of(scene, &layout), whole, "{what}: {layout}");
    }
}

/// Each scheme meets all layouts of the covering.
fn every_scheme(scene: impl Fn(&str, &Value) -> Value) {
    for shape in SHAPES {
        for transfer in transfers() {
            let mut scene = scene(shape, &transfer);
            ending(&mut scene, 2e-8);
            same(&scene, &format!("{shape} {transfer}"));
        }
    }
}

#[test]
fn each_scheme_in_leapfrog() {
    every_scheme(small_leapfrog);
}

#[test]
fn each_scheme_at_the_midpoint() {
    every_scheme(small_midpoint);
}

/// Shares of fluxes come from nodes of other patches, a mirror swaps those of both signs.
#[test]
fn the_flux_limiter() {
    for neighbours in [1, 2] {
        for shape in ["cpdi_bspline_quadratic", "cpdi"] {
            let mut scene = small_midpoint(shape, &json!({"fmpm": 4}));
            scene["method"]["flux_limiter"] = json!({"neighbours": neighbours});
            ending(&mut scene, 3e-8);
            same(&scene, &format!("{shape}, {neighbours} neighbours"));
        }
    }
}

#[test]
fn a_partly_lumped_mass_matrix() {
    for update in [small_leapfrog, small_midpoint] {
        let mut scene = update("cpdi_bspline_quadratic", &json!({"fmpm": 4}));
        scene["method"]["mass_lumping"] = json!(0.1);
        ending(&mut scene, 3e-8);
        same(&scene, "a share of the lumped mass");
    }
}

/// A scene in the total-Lagrangian frame.
fn total(mut scene: Value) -> Value {
    scene["method"]["frame"] = json!("total_lagrangian");
    scene
}

#[test]
fn each_scheme_in_the_total_lagrangian_frame() {
    every_scheme(|shape, transfer| total(small_midpoint(shape, transfer)));
    for shape in SHAPES {
        let mut scene = total(small_leapfrog(shape, &json!("flip")));
        ending(&mut scene, 2e-8);
        same(&scene, &format!("{shape}, leapfrog"));
    }
    let mut parts = total(small("soft_flyer.json"));
    parts["bodies"][0]["box"] = json!({"lower": [-0.00006], "upper": [0.0]});
    same(&parts, "contact");
}

#[test]
fn bodies_that_meet_and_part() {
    for method in [
        json!({}),
        json!({"shape": "cpdi", "transfer": "flip"}),
        json!({"shape": "gimp", "transfer": "apic", "stress_update": "modified_last"}),
        json!({"shape": "bspline_cubic", "transfer": {"xpic": 3}, "stress_update": "first"}),
    ] {
        let mut scene = small("soft_flyer.json");
        // a gap of a cell, and a flyer so thin that it comes off again
        scene["bodies"][0]["box"] = json!({"lower": [-0.00007], "upper": [-0.00001]});
        if method != json!({}) {
            scene["method"] = method.clone();
            scene["artificial_viscosity"] = json!({"linear": 0.2, "quadratic": 2.0});
        }
        same(&scene, &format!("contact, {method}"));
    }
}

#[test]
fn bodies_that_cross_many_patches() {
    let mut scene = shipped("crossing.json");
    ending(&mut scene, 1.2e-7);
    same(&scene, "crossing");
}

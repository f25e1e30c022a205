//! Keys of strength, failure and temperature that are refused, and in what words.

use flyer_mpm::input;

use crate::tools::shipped;

#[track_caller]
fn refused(sets: &[&str], fragments: &[&str]) {
    let sets: Vec<String> = sets.iter().map(|s| format!("materials.aluminium.{s}")).collect();
    let text = shipped("piston_elastic_plastic.json").to_string();
    let error = input::parse(text.as_bytes(), "p.json", &sets).unwrap_err().to_string();
    for fragment in fragments {
        assert!(error.contains(fragment), "{error}\nhas no {fragment}");
    }
}

const COOK: &str = "strength={\"type\": \"johnson_cook\", \"shear_modulus\": 1e9, \"a\": 1e8, \
                    \"b\": 1e8, \"n\": 0.3, \"softening\": {\"m\": 1, \"reference_temperature\": \
                    300, \"melt_temperature\": 900}}";
const WARM: &str = "thermal={\"specific_heat\": 900, \"reference_temperature\": 300}";

#[test]
fn strength() {
    refused(&["strength.yield_stress=0"], &["yield_stress = 0", "above 0"]);
    refused(&["strength.shear_modulus=-1"], &["shear_modulus = -1", "above 0"]);
    refused(&["strength.hardening=-1"], &["hardening = -1"]);
    refused(&["strength.type=mises"], &["mises", "von_mises"]);
    refused(&["strength={\"type\": \"von_mises\", \"shear_modulus\": 1e9}"], &["yield_stress"]);
    refused(&["strength.yield=1e8"], &["strength.yield", "unknown"]);
    refused(
        &["eos={\"type\": \"linear_elastic\", \"youngs_modulus\": 1e9, \"poissons_ratio\": 0.3}"],
        &["materials.aluminium.strength", "supports shear by itself"],
    );
    refused(&[COOK], &["strength.softening", "materials.aluminium.thermal"]);
    refused(
        &[COOK, WARM, "strength.softening.melt_temperature=300"],
        &["melt_temperature = 300", "reference_temperature = 300"],
    );
    let armstrong = "strength={\"type\": \"zerilli_armstrong\", \"shear_modulus\": 1e9, \
                     \"c0\": 1e8, \"c3\": 1e-3, \"c4\": 1e-4}";
    refused(&[armstrong], &["strength.c3", "materials.aluminium.thermal"]);
    refused(&[armstrong, WARM, "strength.c0=0"], &["strength.c5 = 0", "no yield stress"]);
    let guinan = "strength={\"type\": \"steinberg_guinan\", \"shear_modulus\": 1e9, \
                  \"yield_stress\": 1e8, \"beta\": 1, \"n\": 0.3, \"max_yield_stress\": 1e7}";
    refused(&[guinan], &["max_yield_stress", "below yield_stress"]);
    refused(
        &[guinan, "strength.max_yield_stress=1e9", "strength.temperature_softening=1e-3"],
        &["temperature_softening", "thermal"],
    );
}

#[test]
fn failure() {
    let limit = "failure={\"type\": \"tension_limit\", \"stress\": 0}";
    refused(&[limit], &["failure.stress = 0", "above 0"]);
    refused(&["failure={\"type\": \"spall\"}"], &["spall", "tension_limit"]);
    let cook = "failure={\"type\": \"johnson_cook\", \"d1\": 0.5}";
    refused(&["strength=null", cook], &["failure.type", "needs plastic strain"]);
    refused(&[cook, "failure.d1=0"], &["failure.d1 = 0", "above 0"]);
    refused(&[cook, "failure.d5=1"], &["failure.d5 = 1", "softening"]);
    let banner = "failure={\"type\": \"cochran_banner\", \"stress\": 1e9, \"opening\": 1e-5}";
    refused(&[banner, "failure.opening=0"], &["failure.opening = 0", "above 0"]);
    refused(&[banner, "failure.exponent=2"], &["failure.exponent = 2"]);
    let kipp = "failure={\"type\": \"grady_kipp\", \"flaw_density\": 1e30, \"exponent\": 8}";
    refused(&[kipp, "failure.flaw_density=0"], &["failure.flaw_density = 0", "above 0"]);
    refused(&[kipp, "failure.exponent=0.5"], &["failure.exponent = 0.5"]);
}

#[test]
fn erosion() {
    let path = "materials.aluminium.erosion";
    refused(&["erosion={\"plastic_strain\": 0}"], &["erosion.plastic_strain = 0", "above 0"]);
    refused(&["erosion={\"volume_ratio\": 1}"], &["erosion.volume_ratio = 1", "above 1"]);
    refused(&["erosion={}"], &[path, "has no limit", "volume_ratio or both"]);
    refused(&["erosion={\"strain\": 1}"], &["erosion.strain", "plastic_strain, volume_ratio"]);
    let strain = "erosion={\"plastic_strain\": 1.5}";
    refused(&["strength=null", strain], &["erosion.plastic_strain", "needs plastic strain"]);
    let solid =
        "eos={\"type\": \"linear_elastic\", \"youngs_modulus\": 1e9, \"poissons_ratio\": 0.3}";
    let spread = "erosion={\"volume_ratio\": 2}";
    refused(&["strength=null", solid, spread], &[path, "an elastic solid does not erode"]);
    let among = |sets: &[&str], why: &str| {
        let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
        let text = shipped("heat_rod.json").to_string();
        let error = input::parse(text.as_bytes(), "h.json", &sets).unwrap_err().to_string();
        assert!(error.contains("materials.rod.erosion") && error.contains(why), "{error}");
    };
    let spread = "materials.rod.erosion={\"volume_ratio\": 2}";
    among(&[spread], "heat that sides have given");
    let pulled = "body_force={\"gravity\": [1]}";
    among(&[spread, "boundary.temperature=null", pulled], "work of a body force");
}

#[test]
fn temperature() {
    refused(
        &["thermal={\"specific_heat\": -1, \"reference_temperature\": 300}"],
        &["specific_heat = -1", "above 0"],
    );
    refused(&["thermal={\"specific_heat\": 900}"], &["reference_temperature"]);
    refused(&["strength=null", WARM, "thermal.source=plastic_work"], &["thermal.source"]);
    refused(&["strength=null", WARM, "thermal.taylor_quinney=0.9"], &["taylor_quinney = 0.9"]);
    refused(&[WARM, "thermal.taylor_quinney=1.1"], &["taylor_quinney = 1.1"]);
}

#[test]
fn exact_solutions_of_fluids() {
    let text = shipped("piston.json").to_string();
    let set = "materials.aluminium.strength={\"type\": \"von_mises\", \"shear_modulus\": 1e9, \
               \"yield_stress\": 1e8}";
    let error = input::parse(text.as_bytes(), "p.json", &[set.into()]).unwrap_err().to_string();
    assert!(
        error.contains("materials.aluminium.strength is not in this exact solution"),
        "{error}"
    );
}

#[test]
fn sides_and_bodies_without_heat() {
    let edit = |sets: &[&str], fragments: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
        let text = shipped("heat_rod.json").to_string();
        let error = input::parse(text.as_bytes(), "h.json", &sets).unwrap_err().to_string();
        for fragment in fragments {
            assert!(error.contains(fragment), "{error}\nhas no {fragment}");
        }
    };
    edit(
        &["materials.rod.thermal.conductivity=null"],
        &["boundary.temperature.x_lower = 400", "no material conducts heat"],
    );
    edit(&["boundary.x_lower=free"], &["boundary.temperature.x_lower", "needs a rigid side"]);
    edit(&["boundary.temperature.x_lower=-1"], &["x_lower = -1", "at least 0"]);
    edit(
        &["boundary.temperature=null", "materials.rod.thermal=null", "bodies.rod.temperature=9"],
        &["bodies.rod.temperature = 9", "materials.rod has no thermal"],
    );
    edit(&["bodies.rod.temperature=310", "bodies.rod.pressure=1"], &["bodies.rod", "pressure"]);
}

//! Small scenes derived from the shipped one.

use serde_json::{Value, json};

/// `inputs/flyer.json` as it is shipped.
pub const FLYER: &str = include_str!("../../inputs/flyer.json");

/// The shipped flyer with a shorter target and an earlier end, with every output.
pub fn whole() -> Value {
    let mut scene: Value = serde_json::from_str(FLYER).unwrap();
    scene["domain"]["upper"] = json!([2e-3]);
    scene["bodies"][1]["box"]["upper"] = json!([1.5e-3]);
    scene["time"]["end"] = json!(1e-7);
    scene["output"]["profiles"]["times"] = json!([5e-8, 1e-7]);
    scene
}

/// The scene of [`whole`] without pictures and HDF5, with a still earlier end.
pub fn short() -> Value {
    let mut scene = whole();
    scene["output"] = json!({"profiles": {"times": [1e-8]}, "pictures": false, "hdf5": false});
    scene["time"]["end"] = json!(1e-8);
    scene
}

/// A copper plate at rest and an aluminium plate that soon leaves the domain through its upper
/// side; with two patches each plate has its own.
pub fn stray() -> Value {
    let mut scene = short();
    scene.as_object_mut().unwrap().remove("reference");
    scene["domain"]["lower"] = json!([-2e-3]);
    scene["bodies"][0]["velocity"] = json!([0.0]);
    scene["bodies"][0]["box"] = json!({"lower": [-1.5e-3], "upper": [-1e-3]});
    scene["bodies"][1]["velocity"] = json!([2e4]);
    scene["bodies"][1]["box"] = json!({"lower": [1.4e-3], "upper": [1.9e-3]});
    scene
}

/// The mirror image of [`stray`].
pub fn mirrored_stray() -> Value {
    let mut scene = stray();
    scene["bodies"][0]["box"] = json!({"lower": [1e-3], "upper": [1.5e-3]});
    scene["bodies"][1]["velocity"] = json!([-2e4]);
    scene["bodies"][1]["box"] = json!({"lower": [-1.9e-3], "upper": [-1.4e-3]});
    scene
}

/// An unstable scheme: steps at the Courant limit, no viscosity, FMPM with leapfrog steps, at 8
/// km/s.
pub fn unstable() -> Value {
    let mut scene = short();
    scene.as_object_mut().unwrap().remove("artificial_viscosity");
    scene["time"]["courant"] = json!(1.0);
    scene["monitor"] = json!({"on_courant_exceeded": "allow"});
    scene["method"] = json!({"shape": "cpdi_bspline_quadratic", "transfer": {"fmpm": 6}});
    scene["bodies"][0]["velocity"] = json!([8000.0]);
    scene
}

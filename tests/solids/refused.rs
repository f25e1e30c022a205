//! Keys of solids, motions and forces that are refused, and in what words.

use flyer_mpm::input;
use serde_json::Value;

use crate::tools::shipped;

#[track_caller]
fn refused(name: &str, sets: &[&str], fragments: &[&str]) {
    let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    let text = shipped(name).to_string();
    let error = input::parse(text.as_bytes(), name, &sets).unwrap_err().to_string();
    for fragment in fragments {
        assert!(error.contains(fragment), "{error}\nhas no {fragment}");
    }
}

#[test]
fn solids() {
    let edit = |set: &str, fragments: &[&str]| refused("vortex.json", &[set], fragments);
    edit("materials.solid.eos.poissons_ratio=0.5", &["poissons_ratio = 0.5", "below 0.5"]);
    edit("materials.solid.eos.youngs_modulus=0", &["youngs_modulus = 0", "above 0"]);
    edit("materials.solid.eos.type=rubber", &["rubber", "neo_hookean"]);
    edit("bodies.ring.pressure=1", &["bodies.ring.pressure = 1", "without stress; allowed: 0"]);
    edit(
        "method.pressure_relaxation={\"rate\": 0.1, \"interval\": 1}",
        &["method.pressure_relaxation", "acts on fluids alone", "every body is elastic"],
    );
    edit(
        "method.volume_relaxation=0.1",
        &["method.volume_relaxation = 0.1", "needs method.edge_mask"],
    );
    refused(
        "vortex.json",
        &["method.volume_relaxation=0.1", "method.edge_mask=0.3"],
        &["method.volume_relaxation = 0.1", "every body is elastic"],
    );
    edit("materials.solid.density=1e-310", &["youngs_modulus = 1000", "no finite stiffness"]);
}

#[test]
fn motions() {
    let ring = |set: &str, fragments: &[&str]| refused("vortex.json", &[set], fragments);
    ring("bodies.ring.velocity=[0, 0]", &["bodies.ring.velocity_field", "one of the two"]);
    ring(
        "bodies.ring.velocity_field={\"rotation\": {\"about\": [0.0], \"rate\": 1}}",
        &["bodies.ring.velocity_field.rotation.about = [0.0]", "allowed: 2 numbers"],
    );
    ring("bodies.ring.velocity_field.vortex.outer=0.5", &["bodies.ring.velocity_field", "width"]);
    ring("bodies.ring.velocity_field={\"spiral\": {}}", &["velocity_field", "spiral"]);
    let gas = |set: &str, fragments: &[&str]| refused("gresho.json", &[set], fragments);
    gas("bodies.gas.pressure=5", &["bodies.gas.pressure = 5", "pressure of its own"]);
    gas(
        "materials.gas.eos={\"type\": \"neo_hookean\", \"youngs_modulus\": 1, \"poissons_ratio\": 0}",
        &["bodies.gas.velocity_field", "ideal gas"],
    );
    refused(
        "sod.json",
        &[
            "bodies.left.velocity=null",
            "bodies.left.velocity_field={\"shear_layer\": {\"profile\": \"sine\", \"speed\": 1, \"height\": 1, \"centre\": 0}}",
        ],
        &["bodies.left.velocity_field", "two dimensions"],
    );
    refused(
        "sod.json",
        &[
            "bodies.left.velocity=null",
            "bodies.left.velocity_field={\"radial\": {\"about\": [0], \"speed\": 1}}",
        ],
        &["reference.riemann.left", "a body with one velocity"],
    );
}

#[test]
fn forces() {
    let edit = |set: &str, fragments: &[&str]| refused("vortex.json", &[set], fragments);
    edit("body_force={\"gravity\": [1]}", &["body_force.gravity = [1.0]", "allowed: 2 numbers"]);
    edit("body_force.vortex.period=2", &["body_force = ", "velocity_field.vortex"]);
    edit("body_force=null", &["body_force = null", "does not hold the body on its course"]);
    edit(
        "boundary={\"x_lower\": \"outflow\"}",
        &["body_force", "\"outflow\" is not booked", "any other side"],
    );
    edit("materials.solid.eos.type=linear_elastic", &["neo-Hookean"]);
    let mut gas: Value = shipped("gresho.json");
    gas["body_force"] = shipped("vortex.json")["body_force"].clone();
    let error = input::parse(gas.to_string().as_bytes(), "g", &[]).unwrap_err().to_string();
    assert!(error.contains("body_force") && error.contains("bodies.gas is not"), "{error}");
}

#[test]
fn references() {
    let still = "bodies.ring.velocity_field=null";
    refused("vortex.json", &[still], &["reference.vortex = \"ring\"", "no velocity_field.vortex"]);
    let wrong =
        "reference={\"noh\": {\"body\": \"gas\", \"symmetry\": \"planar\", \"between\": [0, 1]}}";
    refused("gresho.json", &[wrong], &["reference.noh", "velocity_field.radial"]);
    let radial = "bodies.gas.velocity_field={\"radial\": {\"about\": [0, 0], \"speed\": -1}}";
    refused("gresho.json", &[radial, wrong], &["symmetry = \"planar\"", "\"cylindrical\""]);
    let spherical = "reference.noh.symmetry=spherical";
    refused("noh_axis.json", &[spherical], &["symmetry = \"spherical\"", "\"cylindrical\""]);
    let up = "bodies.gas.velocity=[-1, 1]";
    refused("noh_axis.json", &[up], &["reference.noh", "a velocity along x towards the axis"]);
    let between = wrong.replace("planar", "cylindrical").replace("[0, 1]", "[1, 1]");
    refused("gresho.json", &[radial, &between], &["between = [1.0,1.0]", "two numbers"]);
    refused(
        "gresho.json",
        &["reference.gresho.body=air"],
        &["reference.gresho.body", "no such body"],
    );
}

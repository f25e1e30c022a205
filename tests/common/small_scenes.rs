//! Shipped scenes reduced in size, with every scheme.

use serde_json::{Value, json};

use super::scenes::{shipped, with};

/// Sets the end of a scene [s], with a single profile at that time.
pub fn ending(value: &mut Value, end: f64) {
    value["time"]["end"] = json!(end);
    value["output"]["profiles"]["times"] = json!([end]);
}

/// A plate of 12 cells on a target of 70 cells: all waves have left within 0.05 us.
pub fn small(name: &str) -> Value {
    let mut value = shipped(name);
    value["domain"]["lower"] = json!([-0.0002]);
    value["domain"]["upper"] = json!([0.001]);
    value["bodies"][0]["box"]["lower"] = json!([-0.00012]);
    value["bodies"][1]["box"]["upper"] = json!([0.0007]);
    ending(&mut value, 5e-8);
    value
}

/// `small` with mid-point steps and all options that this transfer supports.
pub fn small_midpoint(shape: &str, transfer: &Value) -> Value {
    let mut value = small("flyer.json");
    let (fmpm, plain) = (transfer.get("fmpm").is_some(), transfer == "apic");
    value["method"]["shape"] = json!(shape);
    value["method"]["transfer"] = transfer.clone();
    value["method"]["filter_heat"] = json!(!plain && transfer != "flip");
    value["method"]["energy"] = json!(if plain { "textbook" } else { "compatible" });
    if !fmpm {
        value["method"].as_object_mut().unwrap().remove("edge_mask");
    }
    value
}

/// `small` with leapfrog steps.
pub fn small_leapfrog(shape: &str, transfer: &Value) -> Value {
    let method = json!({"shape": shape, "transfer": transfer});
    with(&small("flyer_uintah.json"), &json!({"method": method}))
}

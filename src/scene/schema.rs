//! The JSON schema of a scene, made from its structs.

/// The JSON schema of a scene (draft 2020-12); units stand in the descriptions.
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(super::Scene).to_value()
}

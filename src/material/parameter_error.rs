//! Errors of material parameters in a scene.

use serde::Serialize;
use serde_json::Value;

/// Error message for a vector of `found` numbers in a scene of `dimension` dimensions.
pub fn wrong_length(found: usize, dimension: usize) -> String {
    let plural = if dimension == 1 { "" } else { "s" };
    format!(
        "{found} numbers, but domain.lower has {dimension}, which is the dimension of the scene; \
         allowed: {dimension} number{plural}"
    )
}

/// Error of a model parameter that does not fit the other parameters of its material.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterError {
    /// Key of the parameter, relative to the key of the model.
    pub key: String,
    /// Value in the scene; `None` if the key is missing or the value is too long to print.
    pub value: Option<Value>,
    /// Description of the error, and the allowed values.
    pub reason: String,
}

impl ParameterError {
    /// Error of a key with a value; `reason` says what is wrong and what is allowed.
    pub fn new(key: impl Into<String>, value: impl Serialize, reason: impl Into<String>) -> Self {
        let value = serde_json::to_value(value).unwrap_or(Value::Null);
        ParameterError { key: key.into(), value: Some(value), reason: reason.into() }
    }

    /// Error of a key without a value.
    pub fn missing(key: impl Into<String>, reason: impl Into<String>) -> Self {
        ParameterError { key: key.into(), value: None, reason: reason.into() }
    }

    /// The same error for a model nested below the key `parent` of another model.
    pub fn below(self, parent: &str) -> Self {
        ParameterError { key: format!("{parent}.{}", self.key), ..self }
    }
}

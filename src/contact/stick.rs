//! Contact without sliding or separation.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ContactCondition;

/// Bodies with one common velocity field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stick {}

impl Stick {
    pub(super) fn condition(&self) -> Option<ContactCondition> {
        None
    }
}

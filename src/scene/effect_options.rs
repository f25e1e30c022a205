//! Keys of effects at the top of a scene. Each effect defines its own key beside its code; a scene
//! keeps the values as JSON, so that its data do not depend on the list of effects.

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::checked::CheckedScene;
use crate::material::ParameterError;

/// Options of an effect: the value of a key at the top of a scene. Without the key, or with `null`,
/// the scene does not use the effect.
pub trait EffectOptions: DeserializeOwned + JsonSchema {
    /// Name of the key.
    const KEY: &'static str;

    /// What a scene without the key has, in words.
    const ABSENT: &'static str = "none";

    /// Checks the options against the rest of the scene.
    ///
    /// # Errors
    ///
    /// The first option that does not fit.
    fn check(&self, scene: &CheckedScene) -> Result<(), ParameterError> {
        let _ = scene;
        Ok(())
    }
}

/// Key of an effect, for the reading of scenes.
#[derive(Clone, Copy)]
pub struct EffectKey {
    /// Name of the key.
    pub name: &'static str,
    /// What a scene without the key has, in words.
    pub absent: &'static str,
    /// JSON schema of its value.
    pub schema: fn(SchemaSettings) -> Value,
    /// Checks its value, if the scene has one, against the rest of the scene.
    pub check: fn(&CheckedScene) -> Result<(), ParameterError>,
}

impl EffectKey {
    /// Key of the options `T`.
    pub fn of<T: EffectOptions>() -> Self {
        EffectKey {
            name: T::KEY,
            absent: T::ABSENT,
            schema: |settings| settings.into_generator().into_root_schema_for::<T>().to_value(),
            check: |scene| scene.options::<T>().map_or(Ok(()), |options| options.check(scene)),
        }
    }
}

impl CheckedScene {
    /// Options of an effect; `None` if the scene does not use it.
    ///
    /// # Panics
    ///
    /// If the scene was not checked with the key of `T`.
    pub fn options<T: EffectOptions>(&self) -> Option<T> {
        let value = self.scene.effects.get(T::KEY).filter(|value| !value.is_null())?;
        Some(
            serde_json::from_value(value.clone())
                .expect("the value was checked against its schema"),
        )
    }
}

//! Bodies that a scene names in its reference.

use crate::scene::CheckedScene;

/// Index of the body that the reference names.
pub(super) fn body_named(scene: &CheckedScene, name: &str) -> usize {
    scene.scene.bodies.iter().position(|b| b.name == name).expect("the check has found the body")
}

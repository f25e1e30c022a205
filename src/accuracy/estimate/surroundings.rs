//! Sides, forces, contact and effects of a scene that change the waves of a plain impact.

use crate::scene::{CheckedScene, Side};

/// Keys of such sides, forces, contact and effects, one line each; empty if there are none.
pub(super) fn surroundings(scene: &CheckedScene) -> Vec<String> {
    let [[lower, upper]] = scene.sides::<1>();
    let contact = scene.scene.contact.is_some_and(|contact| {
        contact.condition().is_none_or(|condition| condition.coefficient.is_some())
    });
    let all = [
        ("boundary.x_lower", lower != Side::default()),
        ("boundary.x_upper", upper != Side::default()),
        ("boundary.temperature", scene.holds_temperature()),
        ("body_force", scene.scene.body_force.is_some()),
        ("contact", contact),
    ];
    let outside = all.into_iter().filter(|(_, is)| *is).map(|(key, _)| key);
    let effects = scene.scene.effects.iter().filter(|(_, value)| !value.is_null());
    let effects = effects.map(|(key, _)| key.as_str());
    outside.chain(effects).map(|key| format!("{key}: not in the fit")).collect()
}

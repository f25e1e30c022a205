//! Formats of scenes and summaries: former ones are rejected with the reason, and scenes are
//! migrated.

use std::fs;

use serde_json::json;

use crate::home::Home;
use crate::scenes::short;

#[test]
fn a_scene_with_former_keys_is_refused_and_migrated() {
    let mut scene = short();
    scene["monitor"] = json!({"speed": 5.0, "max_retries": 3});
    let home = Home::with(&scene);
    let present = home.run("present", &[]);
    scene.as_object_mut().unwrap().remove("monitor");
    scene.as_object_mut().unwrap().remove("format");
    scene["watch"] = json!({"speed": 5.0, "most_redos": 3});
    home.write("scene.json", &serde_json::to_string_pretty(&scene).unwrap());
    let out = home.call(["scene.json"]).end();
    assert_eq!(out.status.code(), Some(2));
    out.failed(&["watch", "is named monitor since format 2", "flyer-mpm migrate"]);
    let said = home.call(["migrate", "scene.json"]).end().succeeded();
    assert!(said.contains("watch, most_redos"), "{said}");
    let migrated = home.run("migrated", &[]);
    assert_eq!(migrated.summary["scene"], present.summary["scene"]);
    let said = home.call(["migrate", "scene.json", "--output", "copy.json"]).end().succeeded();
    assert!(said.contains("no former names"), "{said}");
    assert_eq!(fs::read(home.at("copy.json")).unwrap(), fs::read(home.at("scene.json")).unwrap());
}

#[test]
fn a_former_key_in_an_override_is_refused() {
    let home = Home::with(&short());
    let out = home.call(["scene.json", "--set", "watch.speed=5"]).end();
    assert_eq!(out.status.code(), Some(2));
    out.failed(&["watch", "is named monitor since format 2"]);
}

#[test]
fn scenes_of_another_format_are_refused() {
    for (format, word) in [(1, "older"), (99, "newer")] {
        let mut scene = short();
        scene["format"] = json!(format);
        let out = Home::with(&scene).call(["scene.json"]).end();
        assert_eq!(out.status.code(), Some(2));
        out.failed(&[&format!("format = {format}"), word]);
    }
}

#[test]
fn what_is_no_scene_is_not_migrated() {
    let home = Home::new();
    for text in ["", "[1]", "{\"title\": ", "{\"format\": 99}"] {
        home.write("scene.json", text);
        let out = home.call(["migrate", "scene.json"]).end();
        assert_eq!(out.status.code(), Some(2));
        out.failed(&["scene.json"]);
        assert_eq!(fs::read_to_string(home.at("scene.json")).unwrap(), text);
    }
    home.call(["migrate", "nowhere.json"]).end().failed(&["nowhere.json"]);
}

#[test]
fn summaries_of_another_format_are_not_compared() {
    let home = Home::with(&short());
    home.run("first", &[]);
    home.run("second", &[]);
    let file = home.at("second/summary.json");
    let text = fs::read_to_string(&file).unwrap();
    for format in ["1", "99"] {
        let other = text.replacen("\"format\": 2", &format!("\"format\": {format}"), 1);
        assert_ne!(other, text);
        fs::write(&file, other).unwrap();
        let out = home.call(["compare", "first", "second"]).end();
        assert_eq!(out.status.code(), Some(2));
        out.failed(&["second/summary.json", &format!("is of format {format}; allowed: 2")]);
    }
}

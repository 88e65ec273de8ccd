//! `scan` and `simulate --body`: from the surface of a body to the surface over an implant.
#![cfg(feature = "command-line")]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

#[path = "common/command.rs"]
mod command;

use command::{folder, lines, run};
use glam::DVec3;
use implant_preview::body::read::{Unit, read};
use implant_preview::body::torso::{Torso, builtin};
use implant_preview::body::write::write;
use implant_preview::export::Format;
use implant_preview::scene::Scene;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Writes the built-in torso with its marks in a unit.
fn body(folder: &Path, unit: Unit) {
    let Torso { surface, marks } = builtin();
    fs::write(folder.join("torso.ply"), write(&surface, unit, Format::Ply)).unwrap();
    let marks = serde_json::to_string(&marks.scaled(1.0 / unit.factor())).unwrap();
    fs::write(folder.join("marks.json"), marks).unwrap();
}

const SCAN: [&str; 8] =
    ["scan", "torso.ply", "--marks", "marks.json", "--out", "scene.json", "--side", "left"];

fn scanned(folder: &Path, more: &[&str]) -> (Value, Value) {
    let output = run(folder, &[&SCAN, more].concat(), "");
    let figures = lines(&output.stderr);
    assert!(output.status.success() && output.stdout.is_empty() && figures.len() == 1);
    let scene = fs::read_to_string(folder.join("scene.json")).unwrap();
    (serde_json::from_str(&scene).unwrap(), figures[0].clone())
}

#[test]
fn a_body_becomes_a_scene_and_the_body_over_its_implant() {
    let folder = folder();
    body(&folder, Unit::M);
    let (mut scene, figures) = scanned(&folder, &[]);
    let names =
        ["no_skin_percent", "data_percent", "radius_across_mm", "radius_along_mm", "footprint_ml"];
    assert!(names.iter().all(|name| figures[name].is_f64()), "{figures}");
    assert_eq!(figures["thickness_mm"].as_array().unwrap().len(), 3);
    let left = &figures["measures"]["left"];
    let volume = left["volume_ml"].as_f64().unwrap();
    assert!((365.0..385.0).contains(&volume), "{figures}");
    assert!(left["nipple_fold_mm"].is_f64() && figures["measures"]["asymmetry_mm"] == 0.0);
    let warnings = figures["warnings"].to_string();
    assert!(warnings.contains("read as m: notch to nipple is 20.6 cm"), "{warnings}");
    assert_eq!((&scene["side"], &scene["body"]["unit"]), (&"left".into(), &"m".into()));
    scene["solver"] = serde_json::json!({ "nodes_per_side": 33, "tolerance": 1e-3 });
    let mut measured = Vec::new();
    let moved = |insertion: f64| {
        scene["insertion"] = insertion.into();
        fs::write(folder.join("coarse.json"), scene.to_string()).unwrap();
        let arguments = ["simulate", "coarse.json", "--body", "torso.ply", "--after", "after.ply"];
        let output = run(&folder, &arguments, "");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        measured.push(lines(&output.stderr)[0]["body_measures"].clone());
        let surface =
            |name: &str| read(&fs::read(folder.join(name)).unwrap(), name).unwrap().surface;
        let (before, after) = (surface("torso.ply"), surface("after.ply"));
        assert_eq!(before.triangles, after.triangles);
        let pairs = before.positions.iter().zip(&after.positions);
        pairs.map(|(before, after)| before.distance(*after)).collect::<Vec<_>>()
    };
    let mut moved = moved;
    assert!(moved(0.0).iter().all(|by| *by == 0.0));
    let full = moved(1.0);
    let most = full.iter().copied().fold(0.0, f64::max);
    assert!((15.0..30.0).contains(&most) && full.iter().filter(|by| **by == 0.0).count() > 2000);
    // At rest nothing changes; over the implant the breast gains its volume and the void, all of it in the patch.
    assert_eq!(measured[0]["before"], measured[0]["after"]);
    let nothing = ["gained_ml", "implant_ml", "void_ml"].map(|name| measured[0][name].as_f64());
    assert_eq!(nothing, [Some(0.0); 3]);
    let number = |path: &str| measured[1].pointer(path).and_then(Value::as_f64).unwrap();
    let (gained, implant) = (number("/gained_ml"), number("/implant_ml"));
    assert!((number("/void_ml") - (gained - implant)).abs() < 0.02);
    assert!(gained > implant && gained < 1.5 * implant, "{gained} {implant}");
    let less = |name: &str| {
        number(&format!("/after/left/{name}")) - number(&format!("/before/left/{name}"))
    };
    assert!((less("volume_ml") / gained - 1.0).abs() < 0.05, "{} {gained}", less("volume_ml"));
    assert!(less("projection_mm") > 10.0 && number("/nipple_shift_mm/2") > 10.0);
    assert!(number("/after/asymmetry_mm") > 5.0);
    // The other breast stays where it was: the marks that moved with the skin do not tilt the axes.
    for name in ["notch_nipple_mm", "nipple_midline_mm", "nipple_fold_mm"] {
        let of = |when: &str| &measured[1][when]["right"][name];
        assert!(of("before").is_f64() && of("before") == of("after"), "{name}");
    }
}

#[test]
fn a_scene_keeps_its_surface_if_asked() {
    let folder = folder();
    body(&folder, Unit::Mm);
    assert_eq!(scanned(&folder, &[]).0["body"].get("surface"), None);
    let (scene, _) = scanned(&folder, &["--keep-surface"]);
    let surface = &scene["body"]["surface"];
    assert_eq!(surface["vertices"].as_str().unwrap().len(), 5722 * 8);
    assert!(surface["triangles"].as_str().unwrap().len() < 90_000);
    let text = scene.to_string();
    let kept = Scene::from_json(&text).unwrap().placement.unwrap().surface.unwrap();
    let own = builtin().surface;
    let apart = kept.surface().positions.iter().zip(&own.positions);
    let most = apart.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(most < 0.02, "{most}");
}

#[test]
fn the_unit_of_a_file_does_not_matter() {
    let folder = folder();
    let scenes = Unit::ALL.map(|unit| {
        body(&folder, unit);
        let (mut scene, _) = scanned(&folder, &["--unit", unit.name(), "--cover", "8"]);
        assert_eq!(scene["body"]["unit"], unit.name());
        scene["body"] = Value::Null;
        scene
    });
    // Files of 32 bits: heights agree to some 0.1 µm.
    let heights = |scene: &Value| -> Vec<f64> {
        let list = scene["chest"]["grid"]["heights_mm"].as_array().unwrap();
        list.iter().map(|height| height.as_f64().unwrap()).collect()
    };
    for scene in &scenes[1..] {
        for (a, b) in heights(scene).iter().zip(heights(&scenes[0])) {
            assert!((a - b).abs() < 0.02, "{a} {b}");
        }
    }
}

/// Another person, and the same one elsewhere; a thickness that was edited is no other body.
#[test]
fn a_scene_has_no_place_on_another_body() {
    let folder = folder();
    body(&folder, Unit::Mm);
    let (mut scene, _) = scanned(&folder, &[]);
    scene["solver"] = serde_json::json!({ "nodes_per_side": 17, "tolerance": 1e-2 });
    scene["insertion"] = 0.3.into();
    let fat = &mut scene["layers"][1]["thickness_mm"];
    *fat = (fat.as_f64().unwrap() + 8.0).into();
    fs::write(folder.join("scene.json"), scene.to_string()).unwrap();
    let on = |change: fn(DVec3) -> DVec3| {
        let Torso { mut surface, .. } = builtin();
        surface.positions.iter_mut().for_each(|at| *at = change(*at));
        fs::write(folder.join("on.ply"), write(&surface, Unit::Mm, Format::Ply)).unwrap();
        let output = run(
            &folder,
            &["simulate", "scene.json", "--body", "on.ply", "--after", "after.ply"],
            "",
        );
        (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let own = on(|at| at);
    assert!(own.0, "{}", own.1);
    for other in [
        |at: DVec3| at * DVec3::new(1.3, 1.1, 1.1),
        |at: DVec3| at + DVec3::new(0.0, 0.0, 10.0),
        |at: DVec3| at + DVec3::new(0.0, 20.0, 0.0),
        |at: DVec3| at * 1e-3,
    ] {
        let (is_taken, words) = on(other);
        assert!(!is_taken && words.lines().count() == 1, "{words}");
        assert!(words.starts_with("error: on.ply: --body: of the scene's marks half"), "{words}");
    }
}

#[test]
fn bad_input_is_one_line() {
    let folder = folder();
    body(&folder, Unit::Mm);
    let line = |arguments: &[&str]| {
        let output = run(&folder, arguments, "");
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), text.lines().count()), (Some(2), 1), "{text}");
        text
    };
    let scan = |more: &[&str]| line(&[&SCAN, more].concat());
    assert!(scan(&["--cover", "40"]).contains("allowed: 6 to 30"));
    assert!(scan(&["--unit", "cm"]).contains("check unit and marks"));
    let marks = fs::read_to_string(folder.join("marks.json")).unwrap();
    fs::write(folder.join("marks.json"), marks.replacen("navel", "nabel", 1)).unwrap();
    assert!(scan(&[]).starts_with("error: marks.json: nabel: unknown field `nabel`; allowed: "));
    fs::write(folder.join("marks.json"), &marks).unwrap();
    fs::write(folder.join("torso.ply"), "ply\nformat").unwrap();
    assert!(scan(&[]).starts_with("error: torso.ply: "));
    assert!(!folder.join("scene.json").exists());
    fs::write(folder.join("flat.json"), r#"{ "implant": { "base_radius_mm": 60 } }"#).unwrap();
    let without = ["simulate", "flat.json", "--body", "torso.ply", "--after", "after.ply"];
    assert!(line(&without).contains("the scene has no member body"));
    let format = ["simulate", "flat.json", "--body", "torso.ply", "--after", "after.png"];
    assert!(line(&format).contains("--after: unknown format"));
}

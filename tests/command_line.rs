//! The command line: the binary, its files, lines and exit codes.
#![cfg(all(feature = "command-line", not(target_arch = "wasm32")))]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

#[path = "common/command.rs"]
mod command;

use command::{folder, lines, run};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Output;

#[path = "command_line/curves.rs"]
mod curves;
#[path = "command_line/research.rs"]
mod research;
#[path = "command_line/simulate.rs"]
mod simulate;
#[path = "command_line/studies.rs"]
mod studies;

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("the test's folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn scene(radius: f64, springs: &str) -> String {
    format!(
        r#"{{"implant":{{"base_radius_mm":{radius}}},"springs":"{springs}","solver":{{"nodes_per_side":33}}}}"#
    )
}

/// Checks exit code 2, one line that contains all of `wanted`, and no new file.
fn assert_refused(folder: &Path, arguments: &[&str], input: &str, wanted: &[&str]) {
    let before = names_in(folder);
    let output = run(folder, arguments, input);
    let complaint = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {complaint}");
    assert_eq!(complaint.lines().count(), 1, "{arguments:?}: {complaint}");
    for part in wanted {
        assert!(complaint.contains(part), "{arguments:?}: {complaint} lacks {part}");
    }
    assert!(output.stdout.is_empty(), "{arguments:?} wrote to standard output");
    assert_eq!(names_in(folder), before, "{arguments:?} left a file");
}

/// The table's rows, split at commas.
fn table(output: &Output) -> Vec<Vec<String>> {
    let text = text(&output.stdout);
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some(
            "springs,curve,poisson_ratio,load_kpa,strain,strain_expected,transverse_strain,poisson_measured,status"
        )
    );
    lines.map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn help_and_version_exit_with_success() {
    let folder = folder();
    for (arguments, wanted) in [
        (&["--help"][..], "simulate"),
        (&["tension", "--help"], "--protocol"),
        (&["--version"], env!("CARGO_PKG_VERSION")),
    ] {
        let output = run(&folder, arguments, "");
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).contains(wanted) && output.stderr.is_empty());
    }
}

#[test]
fn the_schema_of_a_result_has_the_fields_of_results() {
    let folder = folder();
    let schema = |of: &str| -> Value {
        let output = run(&folder, &["schema", "--of", of], "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let titles =
        ["Scene", "Outcome", "MapFile", "MapOptions", "BandsReport", "BandsSettings", "TimesFile"];
    let formats = ["scene", "result", "map", "map-options", "bands", "bands-options", "times"];
    for (format, title) in formats.into_iter().zip(titles) {
        assert_eq!(schema(format)["title"], title);
    }
    let schema = schema("result");
    let [layered, sheet] = ["", r#","tissue_model":"sheet""#].map(|more| {
        let scene = format!(
            r#"{{"implant":{{"base_radius_mm":50}},"solver":{{"nodes_per_side":17}}{more}}}"#
        );
        serde_json::from_str::<Value>(&text(&run(&folder, &["simulate", "-"], &scene).stdout))
            .unwrap()
    });
    let fields = schema["properties"].as_object().unwrap();
    for result in [&layered, &sheet] {
        let known = |field: &String| fields.contains_key(field);
        assert!(result.as_object().unwrap().keys().all(known));
        for field in schema["required"].as_array().unwrap() {
            assert!(result.get(field.as_str().unwrap()).is_some(), "{field}");
        }
    }
    // Fields of layered tissue are not required.
    assert!(layered["cover_mm"].is_object() && sheet.get("cover_mm").is_none());
    let written = run(&folder, &["schema", "--out", "scene.schema.json"], "");
    assert!(written.status.success() && written.stdout.is_empty());
    assert!(fs::read_to_string(folder.join("scene.schema.json")).unwrap().ends_with("}\n"));
    assert_refused(
        &folder,
        &["schema", "--of", "moon"],
        "",
        &["\"moon\" is no format; allowed: scene, result, map"],
    );
    assert_refused(&folder, &["schema", "--out", "none/s.json"], "", &["none"]);
}

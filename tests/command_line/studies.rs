//! Maps and bands.

use super::*;

#[test]
fn a_map_is_written_as_table_json_and_chart() {
    let folder = folder();
    fs::write(
        folder.join("scene.json"),
        scene(50.0, "coupled").replacen('{', r#"{"tissue_model":"sheet","#, 1),
    )
    .unwrap();
    let map = |out: &str, more: &[&str]| {
        let mut arguments = vec!["map", "scene.json", "--out-dir", out, "--nodes", "17"];
        arguments.extend(more);
        let output = run(&folder, &arguments, "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert_eq!(names_in(&folder.join(out)), ["map.csv", "map.json", "map.svg"]);
        let read = |name: &str| fs::read_to_string(folder.join(out).join(name)).unwrap();
        let json: Value = serde_json::from_str(&read("map.json")).unwrap();
        (json, read("map.csv"), read("map.svg"), text(&output.stderr))
    };
    let axes = ["--x", "base_width_mm=90:130:4", "--y", "projection_mm=25:55:3"];
    let (json, csv, svg, notes) = map("plane", &axes);
    assert_eq!((csv.lines().count(), json["points"].as_array().unwrap().len()), (13, 12));
    assert!(
        csv.starts_with("base_width_mm,projection_mm,status,pocket_radius_mm,greatest_strain,")
    );
    assert_eq!(json["schema"], "implant-preview/map/1");
    assert_eq!(json["check"]["points"], 9);
    assert_eq!(json["axes"][0]["present"], 100.0);
    assert!(notes.contains("checked points converged at 129 nodes per side"), "{notes}");
    assert!(notes.contains("The pocket follows the implant"), "{notes}");
    for words in ["<svg", "base width (mm)", "projection (mm)", "ml", "typical size"] {
        assert!(svg.contains(words), "{words}");
    }
    let curve = ["--x", "insertion=0.2:1:5", "--show", "force_n", "--no-check"];
    let (json, csv, svg, _) = map("curve", &curve);
    assert!(
        csv.lines().count() == 6 && json["check"].is_null() && svg.contains("contact force (N)")
    );
    let forces: Vec<f64> = json["points"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["values"]["force_n"].as_f64().unwrap())
        .collect();
    assert!(forces.windows(2).all(|pair| pair[0] < pair[1]), "{forces:?}");
}

#[test]
fn a_map_with_its_border_in_full_has_the_answers_of_simulate() {
    let folder = folder();
    let scene = |projection: f64| {
        json!({
            "implant": { "base_radius_mm": 52.5, "projection_mm": projection },
            "pocket_radius_mm": 62.5,
            "patient": { "pinch_mm": 20, "skin_class": "normal" },
            "solver": { "nodes_per_side": 65 },
        })
        .to_string()
    };
    fs::write(folder.join("scene.json"), scene(50.0)).unwrap();
    let map = |out: &str, more: &[&str]| {
        let mut arguments = vec!["map", "scene.json", "--out-dir", out, "--no-check", "--x"];
        arguments.push("projection_mm=74:84:6");
        arguments.extend(more);
        let output = run(&folder, &arguments, "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let json = fs::read_to_string(folder.join(out).join("map.json")).unwrap();
        serde_json::from_str::<Value>(&json).unwrap()
    };
    let (quick, full) = (map("quick", &[]), map("full", &["--full-border"]));
    // The border lies where the quick solve of the map has no answer and the full one has.
    let is_border = |i: &usize| {
        quick["points"][i]["status"] == "no_shape" && full["points"][i]["status"] == "converged"
    };
    let border = (0..6).find(is_border).expect("a point that the full solve alone answers");
    assert!(full["notes"].to_string().contains("solved as `simulate` does"), "{}", full["notes"]);
    let projection = full["points"][border]["at"][0].as_f64().unwrap();
    fs::write(folder.join("steep.json"), scene(projection)).unwrap();
    let output = run(&folder, &["simulate", "steep.json"], "");
    let result: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    let force = |value: &Value| value.as_f64().unwrap();
    let ratio =
        force(&full["points"][border]["values"]["force_n"]) / force(&result["contact_force_n"]);
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
}

#[test]
fn bands_are_equal_for_equal_seeds() {
    let folder = folder();
    let papers = r#"{"tissue_model":"sheet","layers":[{},{"tissue":"adipose","thickness_mm":10,"curve":{"kind":"adipose"}}],"#;
    let scene = scene(50.0, "coupled").replacen('{', papers, 1);
    fs::write(folder.join("scene.json"), scene).unwrap();
    fs::write(
        folder.join("choices.json"),
        r#"{"unknowns":{"projection":null,"pocket_radius":{"normal":{"mean":0,"sd":1}}}}"#,
    )
    .unwrap();
    let bands = |more: &[&str]| -> Value {
        let mut arguments =
            vec!["bands", "scene.json", "--nodes", "17", "--samples", "32", "--importance", "16"];
        arguments.extend(more);
        let output = run(&folder, &arguments, "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains("not a prediction for a person."));
        serde_json::from_str(&text(&output.stdout)).unwrap()
    };
    let first = bands(&["--seed", "3"]);
    assert_eq!(first, bands(&["--seed", "3"]));
    assert_ne!(first["bands"], bands(&["--seed", "4"])["bands"]);
    assert_eq!(
        (&first["counts"]["converged"], first["unknowns"].as_array().unwrap().len()),
        (&json!(32), 8)
    );
    let chosen = bands(&["--settings", "choices.json", "--without", "fat_modulus"]);
    let names: Vec<&str> = chosen["unknowns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|u| u["name"].as_str().unwrap())
        .collect();
    assert!(names.len() == 6 && !names.contains(&"projection") && !names.contains(&"fat_modulus"));
}

#[test]
fn bad_maps_and_bands_are_refused_in_one_line() {
    let folder = folder();
    fs::write(folder.join("scene.json"), scene(50.0, "coupled")).unwrap();
    fs::write(folder.join("choices.json"), r#"{"unknowns":{"hair":null}}"#).unwrap();
    let map = |more: &[&'static str], wanted: &[&str]| {
        let arguments = [&["map", "scene.json", "--out-dir", "out"], more].concat();
        assert_refused(&folder, &arguments, "", wanted);
    };
    map(&["--x", "colour=1:2:3"], &["\"colour\" is not a field", "base_width_mm"]);
    map(&["--x", "projection_mm=20:20:5"], &["two different numbers"]);
    map(&["--x", "projection_mm=20:40:0"], &["count is 0", "2 to 3600"]);
    map(&["--x", "projection_mm=20:40:1000000000"], &["a map of 1000000000 points", "3600"]);
    map(&["--x", "projection_mm=20:1e308:5"], &["projection_mm"]);
    map(&["--x", "projection_mm=NaN:40:5"], &["NaN"]);
    map(&["--y", "projection_mm=20:40:5"], &["--x"]);
    map(&["--show", "beauty"], &["\"beauty\" is not a quantity", "greatest_strain"]);
    map(&["--nodes", "5"], &["'5' for '--nodes <N>'", "17 to 1025"]);
    map(&["--nodes", "33.5"], &["'33.5'", "17 to 1025"]);
    let bands = |more: &[&'static str], wanted: &[&str]| {
        let arguments = [&["bands", "scene.json"], more].concat();
        assert_refused(&folder, &arguments, "", wanted);
    };
    bands(&["--samples", "0"], &["'0' for '--samples <N>'", "16 to 16384"]);
    bands(&["--samples", "-1"], &["'-1' for '--samples <N>'", "16 to 16384"]);
    bands(&["--samples", "1e9"], &["'1e9'", "16 to 16384"]);
    bands(&["--nodes", "x"], &["'x'", "17 to 1025"]);
    bands(&["--seed", "-1"], &["0 to 4294967295"]);
    bands(&["--without", "hair"], &["\"hair\" is not an unknown", "skin_thickness"]);
    bands(&["--settings", "choices.json"], &["choices.json: unknowns: ", "hair"]);
    bands(&["--importance", "1000"], &["importance_rows is 1000"]);
    bands(&["--out", "none/b.json"], &["none"]);
    assert_refused(&folder, &["bands", "missing.json"], "", &["missing.json", "cannot be read"]);
}

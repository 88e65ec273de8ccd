//! Tables on the command line: a row of columns in for each scene, a row of columns out.
#![cfg(all(feature = "command-line", unix))]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

#[path = "common/command.rs"]
mod command;
#[path = "common/signal.rs"]
mod signal;

use command::{folder, lines};
use serde_json::{Value, json};
use signal::signal_after;
use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Output};
use std::thread;

#[path = "columns/stream.rs"]
mod stream;

fn spawn(folder: &Path, arguments: &[&str]) -> Child {
    command::spawn(folder, &[&["simulate"], arguments].concat())
}

/// Runs `simulate` with the text as standard input.
fn run(folder: &Path, arguments: &[&str], input: &str) -> Output {
    command::run(folder, &[&["simulate"], arguments].concat(), input)
}

/// The words of a run that ends with exit code 2 and writes nothing, in one line.
fn refusal(folder: &Path, arguments: &[&str], input: &str) -> String {
    let output = run(folder, arguments, input);
    let line = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {line}");
    assert!(output.stdout.is_empty() && line.lines().count() == 1, "{arguments:?}: {line}");
    line
}

/// The rows of a table, the cells by their columns.
fn rows(text: &[u8]) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_reader(text);
    reader.deserialize().map(|row| row.unwrap()).collect()
}

/// A small sheet as a template.
fn sheet() -> Value {
    json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": 30, "projection_mm": 20 },
        "pocket_radius_mm": 45,
        "layers": [
            { "tissue": "skin", "thickness_mm": 1.5, "curve": { "kind": "skin" } },
            { "tissue": "fat, deep", "thickness_mm": 8, "curve": { "kind": "adipose" } },
        ],
        "solver": { "nodes_per_side": 17 },
    })
}

/// A small sheet of its own projection.
fn numbered(k: usize) -> Value {
    let mut scene = sheet();
    scene["id"] = json!(k);
    scene["implant"]["projection_mm"] = json!(10.0 + 0.001 * k as f64);
    scene
}

const TEMPLATE: [&str; 4] = ["--template", "scene.json", "--table", "-"];

/// A folder with a template.
fn with_template() -> PathBuf {
    let folder = folder();
    fs::write(folder.join("scene.json"), sheet().to_string()).unwrap();
    folder
}

/// A line without the time of its computation.
fn untimed(mut line: Value) -> Value {
    if let Some(solver) = line.get_mut("solver") {
        solver.as_object_mut().unwrap().remove("time_ms");
    }
    line
}

#[test]
fn a_table_has_the_figures_of_the_lines_to_the_last_bit() {
    // One run, compared column by column.
    let folder = folder();
    let ids = [
        json!(7),
        json!("7"),
        json!("a, \"b\""),
        json!("two\nlines"),
        json!({"x": 0.10}),
        json!(null),
    ];
    let text: String = ids
        .iter()
        .enumerate()
        .map(|(k, id)| {
            let mut scene = numbered(100 * k);
            scene["id"] = id.clone();
            format!("{scene}\n")
        })
        .collect();
    let paths = [
        "contact_force_n",
        "strain.max_principal",
        "strain.fraction_above[0.25]",
        "layers[1].max_stress_kpa",
        "layers[2].max_stress_kpa",
        "layers.tissue",
        "profile.z_mm",
        "profile[40].z_mm",
        "contact_angle_deg",
        "solver.cycles",
        "solver.fell_back",
        "warnings",
    ];
    let fields = paths.join(",");
    let output = run(&folder, &["-", "--format", "csv", "--fields", &fields], &text);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = String::from_utf8(output.stdout.clone()).unwrap();
    let header = format!("id,scene_hash,status,{fields},error");
    // A row is a line, whatever its cells.
    assert_eq!((table.lines().next(), table.lines().count()), (Some(&*header), 7));
    let (rows, wanted) = (rows(&output.stdout), lines(&run(&folder, &["-"], &text).stdout));
    let mut figures = 0;
    for ((row, line), id) in rows.iter().zip(&wanted).zip(&ids) {
        let mut check = |column: &str, value: &Value| {
            let expected = match value {
                Value::Null => String::new(),
                Value::String(text) => text.clone(),
                value => value.to_string(),
            };
            assert_eq!(row[column], expected, "{column}");
            if let Some(figure) = value.as_f64() {
                assert_eq!(row[column].parse::<f64>().unwrap().to_bits(), figure.to_bits());
                figures += 1;
            }
        };
        check("status", &line["status"]);
        check("contact_force_n", &line["contact_force_n"]);
        check("strain.max_principal", &line["strain"]["max_principal"]);
        check("strain.fraction_above[0.25]", &line["strain"]["fraction_above"]["0.25"]);
        check("layers[1].max_stress_kpa", &line["layers"][1]["max_stress_kpa"]);
        check("layers[2].max_stress_kpa", &Value::Null);
        check("layers.tissue", &json!(["skin", "fat, deep"]));
        let heights: Vec<&Value> =
            line["profile"].as_array().unwrap().iter().map(|point| &point["z_mm"]).collect();
        check("profile.z_mm", &json!(heights));
        check("profile[40].z_mm", heights[40]);
        check("contact_angle_deg", &Value::Null);
        check("solver.cycles", &line["solver"]["cycles"]);
        check("solver.fell_back", &line["solver"]["fell_back"]);
        check("warnings", &line["warnings"]);
        check("error", &Value::Null);
        check("scene_hash", &line["scene_hash"]);
        // A text that reads as a number has the quotation marks of JSON, and so has one with a line break.
        let cell = match id {
            Value::String(text) if text != "7" && !text.contains('\n') => text.clone(),
            Value::Null => String::new(),
            id => id.to_string(),
        };
        assert_eq!(row["id"], cell);
    }
    assert_eq!(figures, 6 * 6);
    // A single scene has a table too.
    fs::write(folder.join("one.json"), numbered(1).to_string()).unwrap();
    let one = run(&folder, &["one.json", "--format", "csv", "--fields", "status"], "");
    let one = String::from_utf8(one.stdout).unwrap();
    let row: Vec<&str> = one.lines().nth(1).unwrap().split(',').collect();
    assert!(one.starts_with("id,scene_hash,status,error\n1,") && one.lines().count() == 2);
    assert_eq!((row.len(), row[1].len(), &row[2..]), (4, 32, &["converged", ""][..]));
}

/// Without the hash too: a row is known by its template and cells.
fn unhashed(line: Value) -> Value {
    let mut line = untimed(line);
    line.as_object_mut().and_then(|fields| fields.remove("scene_hash")).unwrap();
    line
}

#[test]
fn the_rows_of_a_table_are_the_scenes_written_out() {
    let folder = with_template();
    let table = "id,implant.projection_mm, layers[1].thickness_mm ,layers[1].curve.kind,solver.nodes_per_side\n\
        a,20,8.5,adipose,17\n\
        \"b\",1.25e1,6,skin,33\n\
        7,20.1, 7 ,skin,17\n\
        \"{\"\"x\"\":1}\",15,8,skin,17\n";
    let mut scenes = String::new();
    for (id, projection, thickness, curve, nodes) in [
        (json!("a"), 20.0, 8.5, "adipose", 17),
        (json!("b"), 12.5, 6.0, "skin", 33),
        (json!(7), 20.1, 7.0, "skin", 17),
        (json!({"x": 1}), 15.0, 8.0, "skin", 17),
    ] {
        let mut scene = sheet();
        scene["id"] = id;
        scene["implant"]["projection_mm"] = json!(projection);
        scene["layers"][1]["thickness_mm"] = json!(thickness);
        scene["layers"][1]["curve"]["kind"] = json!(curve);
        scene["solver"]["nodes_per_side"] = json!(nodes);
        scenes += &format!("{scene}\n");
    }
    let wanted: Vec<Value> =
        lines(&run(&folder, &["-"], &scenes).stdout).into_iter().map(unhashed).collect();
    assert!(wanted.len() == 4 && wanted.iter().all(|line| line["status"] == "converged"));
    // With the ends of lines, the mark and the blank lines of other programs; from a file too.
    let other = format!("\u{feff}{}", table.replace('\n', "\r\n\r\n"));
    fs::write(folder.join("table.csv"), table).unwrap();
    let file = ["--template", "scene.json", "--table", "table.csv", "--threads", "2"];
    for (arguments, input) in [(&TEMPLATE[..], table), (&TEMPLATE, &other), (&file, "")] {
        let output = run(&folder, arguments, input);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let found: Vec<Value> = lines(&output.stdout).into_iter().map(unhashed).collect();
        assert_eq!(found, wanted);
    }
    // Columns in and out.
    let both = [&TEMPLATE[..], &["--format", "csv", "--fields", "contact_force_n"]].concat();
    for (row, line) in rows(&run(&folder, &both, table).stdout).iter().zip(&wanted) {
        assert_eq!(row["contact_force_n"], line["contact_force_n"].to_string());
    }
    // A surgeon's number: the volume changes the projection; a wider base keeps the margin of the pocket, 15 mm.
    let text = "base_width_mm,volume_ml\n70,50\n";
    let found = lines(&run(&folder, &TEMPLATE, text).stdout);
    assert!((found[0]["implant_volume_ml"].as_f64().unwrap() - 50.0).abs() < 1e-9);
    let pocket = std::f64::consts::PI * 5.0_f64.powi(2);
    assert!((found[0]["area_before_cm2"].as_f64().unwrap() / pocket - 1.0).abs() < 1e-2);
    // A header without rows, as in an empty part of a distributed table.
    let none = run(&folder, &both, "insertion\n");
    assert!(none.status.success() && none.stderr.is_empty());
    assert_eq!(none.stdout, b"id,scene_hash,status,contact_force_n,error\n");
}

#[test]
fn a_bad_row_has_an_error_in_its_place() {
    let folder = with_template();
    let table = b"insertion,id,implant.projection_mm\n\
        1,good,20\n\
        1,limit,500\n\
        \n\
        1,empty,\n\
        one,word,20\n\
        \"1,250\",thousands,20\n\
        nan,nan,20\n\
        1,short\n\
        1,long,20,20\n\
        1,open,\"20\n\
        1,\xff,20\n\
        1,kept,\xe420\n\
        ,,\n\
        0.5,last,20\n";
    let wanted = [
        ("good", ""),
        ("limit", "line 70003: implant.projection_mm is 500"),
        ("empty", "line 70005: implant.projection_mm is \"\"; allowed: a number, as 12.5"),
        ("word", "line 70006: insertion is \"one\"; allowed: a number, as 12.5"),
        (
            "thousands",
            "line 70007: insertion is \"1,250\", with a separator of thousands; allowed: 1250",
        ),
        ("nan", "line 70008: insertion is \"nan\"; allowed: a number, as 12.5"),
        ("", "line 70009: 2 cells; allowed: 3, one for each column"),
        ("", "line 70010: 4 cells; allowed: 3, one for each column"),
        ("", "line 70011: a quotation mark is not closed; allowed: each mark within a cell twice"),
        ("", "line 70012: a letter is not UTF-8 (saved as Windows-1252?)"),
        ("kept", "line 70013: a letter is not UTF-8 (saved as Windows-1252?)"),
        ("last", ""),
    ];
    // A letter beyond the beginning is an error of its row.
    let beginning = format!("insertion,id,implant.projection_mm\n{}", "\n".repeat(70_000));
    let table = [beginning.as_bytes(), &table[beginning.find('\n').unwrap() + 1..]].concat();
    fs::write(folder.join("table.csv"), table).unwrap();
    let input = ["--template", "scene.json", "--table", "table.csv"];
    let output =
        run(&folder, &[&input[..], &["--format", "csv", "--fields", "status"]].concat(), "");
    assert_eq!(output.status.code(), Some(2));
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(
        complaint,
        "note: 70002 empty rows of the table are left out\n\
         error: 10 of 12 lines of the output are errors of invalid scenes\n"
    );
    let found = rows(&output.stdout);
    assert_eq!(found.len(), wanted.len());
    for (row, (id, error)) in found.iter().zip(wanted) {
        assert_eq!(row["id"], id);
        assert!(row["error"].starts_with(error), "{}", row["error"]);
        assert_eq!(row["error"].is_empty(), error.is_empty());
        assert_eq!(row["status"], if error.is_empty() { "converged" } else { "" });
        assert_eq!(row["scene_hash"].len(), 32);
    }
    // As JSON lines, with the line as a number.
    let found = lines(&run(&folder, &input, "").stdout);
    assert_eq!((&found[1]["id"], &found[1]["line"]), (&json!("limit"), &json!(70_003)));
    assert_eq!((&found[7]["id"], &found[7]["line"]), (&json!(null), &json!(70_010)));
    // Of several files of scenes an error names the file.
    fs::write(folder.join("a.jsonl"), format!("{}\n", numbered(1))).unwrap();
    fs::write(folder.join("b.jsonl"), format!("{}\n{{\"id\":\"x\"}}\n", numbered(2))).unwrap();
    let several = ["a.jsonl", "b.jsonl", "--format", "csv", "--fields", "status"];
    let found = rows(&run(&folder, &several, "").stdout);
    assert!(found[2]["error"].starts_with("b.jsonl, line 2: ") && found[2]["id"] == "x");
}

#[test]
fn bad_columns_are_refused_before_any_solve() {
    let folder = with_template();
    for (header, wanted) in [
        ("", "standard input: header: is missing; allowed: the names of the columns"),
        (
            "colour\n1\n",
            "standard input: header: \"colour\" is not a field; allowed: base_width_mm, ",
        ),
        (
            "insertion,insertion\n1,1\n",
            "insertion and insertion set the same field; allowed: one of",
        ),
        ("id,insertion,id\n1,1,1\n", "id is the name of two columns; allowed: one"),
        ("pinch_mm,layers[1].thickness_mm\n", "pinch_mm and layers[1].thickness_mm set the same"),
        ("layers[2].thickness_mm\n1\n", "the scene has 2 layers; allowed: layers[0] to layers[1]"),
        ("attachment.ramp_mm\n1\n", "attachment.ramp_mm: the scene is a sheet; allowed: layered"),
        ("insertion,\"volume_ml\n1,200\n", "header: a quotation mark is not closed"),
        (",insertion\n1,1\n", "\"\" is not a field; allowed: "),
    ] {
        let line = refusal(&folder, &TEMPLATE, header);
        assert!(line.contains(wanted), "{header:?}: {line}");
    }
    fs::write(folder.join("bad.json"), r#"{"implant":{"base_radius_mm":500}}"#).unwrap();
    fs::write(folder.join("table.csv"), "insertion\n1\n").unwrap();
    let table = ["--table", "table.csv"];
    for (arguments, wanted) in [
        (&["--template", "bad.json"][..], "bad.json: implant.base_radius_mm is 500"),
        (&["--template", "none.json"], "none.json: cannot be read"),
        (&["--template", "scene.json", "--out", "table.csv"], "table.csv: is an input scene"),
        (&["--template", "scene.json", "--out", "scene.json"], "scene.json: is an input scene"),
        (&["--template", "scene.json", "scene.json"], "cannot be used with"),
        (&["--template", "scene.json", "--mesh", "m.stl"], "allowed: one scene"),
        (&[], "--template"),
    ] {
        let line = refusal(&folder, &[&table[..], arguments].concat(), "");
        assert!(line.contains(wanted), "{arguments:?}: {line}");
    }
    assert!(refusal(&folder, &["--template", "scene.json"], "").contains("--table"));
    assert!(refusal(&folder, &["--template", "-", "--table", "-"], "").contains("standard input"));
    for (fields, wanted) in [
        (&[][..], "--format csv: --fields is missing; allowed: the columns, as contact_force_n"),
        (&["--fields", "force"], "--fields: \"force\" is not a field of a result; allowed: "),
        (
            &["--fields", "strain"],
            "--fields: \"strain\" has several fields; allowed in a table: strain.added, strain.fraction_above, ",
        ),
        (&["--fields", "layers[0]"], "layers[0].max_stress_kpa"),
        (&["--fields", "status[0]"], "--fields: \"status[0]\" is no path of a result; allowed: "),
        (
            &["--fields", "wrinkled,wrinkled"],
            "--fields: \"wrinkled\" is named twice; allowed: each",
        ),
        (&["--fields", "profile.z_mm", "--no-profile"], "--no-profile: --fields names a profile"),
        (&["--fields", "status", "--profile", "p.csv"], "lines or a table; allowed: one scene"),
        (&["--fields", "status", "--format", "avro"], "possible values: json, csv, parquet"),
    ] {
        let arguments = match fields {
            [.., "avro"] => fields.to_vec(),
            _ => [&["--format", "csv"][..], fields].concat(),
        };
        let line = refusal(&folder, &[&["scene.json"][..], &arguments].concat(), "");
        assert!(line.contains(wanted), "{fields:?}: {line}");
    }
    // An output of these runs would have lost the table.
    assert_eq!(fs::read_to_string(folder.join("table.csv")).unwrap(), "insertion\n1\n");
}

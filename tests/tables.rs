//! Tables and texts of any locale, program and encoding on the command line.
#![cfg(all(feature = "command-line", unix))]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

#[path = "common/command.rs"]
mod command;

use command::{folder, lines, run};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

const TEMPLATE: &str = r#"{"implant":{"base_radius_mm":30,"projection_mm":20},"pocket_radius_mm":45,
    "tissue_model":"sheet","solver":{"nodes_per_side":17,"tolerance":1e-3}}"#;

/// A folder with a template.
fn with_template() -> PathBuf {
    let folder = folder();
    fs::write(folder.join("scene.json"), TEMPLATE).unwrap();
    folder
}

/// Runs a table as a file.
fn run_table(folder: &Path, table: &[u8]) -> Output {
    fs::write(folder.join("table.csv"), table).unwrap();
    let arguments = ["simulate", "--template", "scene.json", "--table", "table.csv"];
    run(folder, &[&arguments[..], &["--fields", "contact_force_n"]].concat(), "")
}

/// Identity and contact force of each row, of a run without an error.
fn forces(output: &Output) -> Vec<(Value, f64)> {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let force = |line: &Value| line["contact_force_n"].as_f64().unwrap();
    lines(&output.stdout).iter().map(|line| (line["id"].clone(), force(line))).collect()
}

fn notes(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(bytes).collect()
}

#[test]
fn tables_of_all_locales_have_the_forces_of_the_plain_one() {
    let folder = with_template();
    let plain = "id,implant.base_radius_mm,implant.projection_mm\nü,30.5,20.25\nb,32,18\n";
    let wanted = forces(&run_table(&folder, plain.as_bytes()));
    assert_eq!((&wanted[0].0, wanted.len()), (&json!("ü"), 2));
    assert!((wanted[0].1 - wanted[1].1).abs() > 0.01);
    let semicolons = plain.replace(',', ";").replace('.', ",").replace("implant,", "implant.");
    let quoted = semicolons.replace(';', "\";\"").replace('\n', "\";\" \"\n").replace("ü", "\"ü");
    let quoted = format!("\"{}", quoted.replace("b\"", "\"b\""));
    let comma = "note: table.csv: columns by `;`, decimals by comma\n";
    let tabs = "note: table.csv: columns by tabs, decimals by comma\n";
    for (table, note) in [
        (plain.replace('\n', "\r\n").into_bytes(), ""),
        (format!("\u{feff}{plain}").into_bytes(), ""),
        (utf16(plain, u16::to_le_bytes), ""),
        (utf16(plain, u16::to_be_bytes), ""),
        (plain.replace("30.5", "\"30,5\"").replace("20.25", "\"20,25\"").into_bytes(), {
            "note: table.csv: columns by `,`, decimals by comma\n"
        }),
        (semicolons.clone().into_bytes(), comma),
        (utf16(&semicolons, u16::to_le_bytes), comma),
        (format!("sep=;\r\n{}", semicolons.replace('\n', "\r\n")).into_bytes(), comma),
        (semicolons.replace('\n', ";\n").into_bytes(), comma),
        (quoted.into_bytes(), comma),
        (semicolons.replace(';', "\t").into_bytes(), tabs),
        (
            semicolons.replace("b;", ";;\n\n;;\nb;").into_bytes(),
            &format!("{comma}note: 3 empty rows of the table are left out\n"),
        ),
        (
            plain.replace(',', ";").into_bytes(),
            "note: table.csv: columns by `;`, decimals by point\n",
        ),
    ] {
        let output = run_table(&folder, &table);
        let text = String::from_utf8_lossy(&table);
        assert_eq!(forces(&output), wanted, "{text}");
        assert_eq!(notes(&output), note, "{text}");
    }
    // From a pipe the note comes before the first solve, too.
    let arguments = ["simulate", "--template", "scene.json", "--table", "-", "--fields"];
    let output = run(&folder, &[&arguments[..], &["contact_force_n"]].concat(), &semicolons);
    assert_eq!(forces(&output), wanted);
    assert_eq!(notes(&output), comma.replace("table.csv", "standard input"));
}

#[test]
fn for_every_way_of_joining_rows_there_are_as_many_rows_out_as_in() {
    let folder = with_template();
    let ends = ["\n", "\r", "\r\n"];
    let cells = ["id,insertion", "a,1", "\"b\",1", "c,0.5"];
    for way in 0..3_usize.pow(4) {
        let end = |k: u32| ends[way / 3_usize.pow(k) % 3];
        let table: String = (0..4).map(|k| format!("{}{}", cells[k as usize], end(k))).collect();
        // Half of the tables have no end of the last row.
        let table = if way % 2 == 0 { table.trim_end() } else { &table };
        let output = run_table(&folder, table.as_bytes());
        let found: Vec<Value> = forces(&output).into_iter().map(|(id, _)| id).collect();
        assert_eq!(found, ["a", "b", "c"], "{table:?}");
        assert_eq!(notes(&output), "", "{table:?}");
    }
    // A name of a column behind a carriage return is a row.
    let output = run_table(&folder, b"id,insertion\r,pinch_mm\na,1\n");
    let found = lines(&output.stdout);
    assert_eq!((found.len(), &found[1]["id"]), (2, &json!("a")));
    let error = "insertion is \"pinch_mm\"; allowed: a number, as 12.5";
    assert_eq!((&found[0]["line"], &found[0]["error"]), (&json!(2), &json!(error)));
}

#[test]
fn a_line_break_within_a_quoted_cell_is_part_of_the_cell() {
    let folder = with_template();
    let found = forces(&run_table(&folder, b"id,insertion\n\"a\nb\",1\n\"c\r\n\"\"d\"\"\",1\n"));
    let ids: Vec<_> = found.into_iter().map(|(id, _)| id).collect();
    assert_eq!(ids, [json!("a\nb"), json!("c\r\n\"d\"")]);
    let output = run_table(&folder, b"id,insertion\n\"a\nb\",1\nc,2\n");
    assert_eq!(lines(&output.stdout)[1]["line"], 4);
    assert!(notes(&output).contains("1 of 2 lines"));
}

#[test]
fn a_number_with_a_separator_of_thousands_or_a_unit_is_an_error_of_its_row() {
    let folder = with_template();
    for (cell, error) in [
        ("1.234,5", "\"1.234,5\", with a separator of thousands; allowed: 1234.5"),
        ("1.234", "\"1.234\", with a separator of thousands; allowed: 1234"),
        ("1 234", "\"1 234\", with a separator of thousands; allowed: 1234"),
    ] {
        let table = format!("id;volume_ml;insertion\na;{cell};0,5\nb;50,5;0,5\n");
        let output = run_table(&folder, table.as_bytes());
        let found = lines(&output.stdout);
        assert_eq!((&found[0]["id"], &found[0]["line"]), (&json!("a"), &json!(2)));
        assert_eq!(found[0]["error"], format!("volume_ml is {error}"));
        assert_eq!(found[1]["status"], "converged");
    }
    let found = lines(&run_table(&folder, b"volume_ml;id\n1,234;a\n50 ml;b").stdout);
    assert_eq!(
        found[0]["error"],
        "volume_ml is \"1,234\", which is 1.234 or 1234; allowed: 1.2340 or 1234"
    );
    assert_eq!(
        found[1]["error"],
        "volume_ml has a number and \"ml\"; allowed: a number, in the unit of the column's name"
    );
}

#[test]
fn a_file_that_is_no_text_is_named_once_before_the_first_solve() {
    let folder = with_template();
    let unmarked = |text: &str| utf16(text, u16::to_le_bytes)[2..].to_vec();
    let utf32 = |text: &str| text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
    let gzip = b"\x1f\x8b\x08\0\0\0\0\0\n{\n".to_vec();
    let scene = TEMPLATE.replace('\n', " ");
    for (table, error) in [
        (
            b"id,insertion\nM\xfcller,1\nb,1\n".to_vec(),
            "the table is not UTF-8 (saved as Windows-1252?), line 2; save it as UTF-8",
        ),
        (gzip.clone(), "the table is a gzip file; unpack it"),
        (
            b"PK\x03\x04\x14\0\x06\0\x08\0\0\0[Content_Types].xml".to_vec(),
            "the table is an Excel workbook (zip); save it as CSV",
        ),
        (
            unmarked("id,insertion\n"),
            "the table is UTF-16 without a byte order mark; save it as UTF-8",
        ),
        (utf32("id,insertion\n"), "the table is UTF-32; save it as UTF-8"),
    ] {
        let output = run_table(&folder, &table);
        assert_eq!(notes(&output), format!("error: table.csv: {error}\n"));
        assert!(output.status.code() == Some(2) && output.stdout.is_empty());
    }
    for (text, error) in [
        (gzip, "is a gzip file; unpack it"),
        (utf16(&scene, u16::to_le_bytes), "is UTF-16; save it as UTF-8"),
        (unmarked(&scene), "is UTF-16 without a byte order mark; save it as UTF-8"),
        (utf32(&scene), "is UTF-32; save it as UTF-8"),
    ] {
        for name in ["scene.txt", "scenes.jsonl"] {
            fs::write(folder.join(name), &text).unwrap();
            let output = run(&folder, &["simulate", name], "");
            assert_eq!(notes(&output), format!("error: {name}: {error}\n"));
            assert!(output.status.code() == Some(2) && output.stdout.is_empty());
        }
    }
    // Lines of a pipe are read one by one; the first one ends the input.
    let output = run(&folder, &["simulate", "-", "--lines"], "i\0d\0\n\0i\0\n");
    let found = lines(&output.stdout);
    assert_eq!(found.len(), 1);
    assert!(found[0]["error"].as_str().unwrap().contains("UTF-16 without a byte order mark"));
}

#[test]
fn scenes_over_many_lines_one_behind_the_other_are_all_read() {
    let folder = with_template();
    let scene = |id: &str| {
        let mut scene: Value = serde_json::from_str(TEMPLATE).unwrap();
        scene["id"] = json!(id);
        serde_json::to_string_pretty(&scene).unwrap()
    };
    let [a, b] = ["a}{", "b"].map(scene);
    let bad = "{\n \"id\": \"c\",\n \"implant\": 7\n}";
    let text = format!("{a}\n{b}\n");
    fs::write(folder.join("two.json"), &text).unwrap();
    let fields = ["--fields", "contact_force_n"];
    for (arguments, input) in [(["simulate", "-"], &*text), (["simulate", "two.json"], "")] {
        let found = forces(&run(&folder, &[&arguments[..], &fields].concat(), input));
        assert_eq!(found.iter().map(|(id, _)| id).collect::<Vec<_>>(), ["a}{", "b"]);
    }
    // Without white space, with carriage returns, and with a bad one between.
    for (text, ids) in [
        (format!("{a}{b}"), vec!["a}{", "b"]),
        (format!("{}\r{}\r", a.replace('\n', " "), b.replace('\n', "\r")), vec!["a}{", "b"]),
        (format!("\u{feff}{a}\n\n{bad} {b}"), vec!["a}{", "c", "b"]),
    ] {
        let output = run(&folder, &["simulate", "-"], &text);
        let found = lines(&output.stdout);
        let found_ids: Vec<_> = found.iter().map(|line| &line["id"]).collect();
        assert_eq!(found_ids, ids, "{text:?}");
        let is_bad = ids.contains(&"c");
        assert_eq!(output.status.code(), Some(if is_bad { 2 } else { 0 }));
        if is_bad {
            let first_line = 2 + a.lines().count();
            assert_eq!(found[1]["line"], first_line);
            assert!(found[1]["error"].as_str().unwrap().starts_with("implant: "));
        }
    }
    // What follows a scene and is none is still an error of the file.
    let output = run(&folder, &["simulate", "-"], &format!("{a} x"));
    assert!(output.stdout.is_empty() && notes(&output).contains("trailing characters"));
    // Lines that carriage returns alone part are one error, which names the cause.
    let line = TEMPLATE.replace('\n', " ");
    let output = run(&folder, &["simulate", "-", "--lines"], &format!("{line}\r{line}\r"));
    let found = lines(&output.stdout);
    assert_eq!(found.len(), 1);
    assert_eq!(
        found[0]["error"],
        "a carriage return alone ends no line; allowed: lines that end with a line feed"
    );
}

#[test]
fn whole_numbers_may_be_written_as_real_ones() {
    let folder = with_template();
    let output = run_table(&folder, b"id,solver.nodes_per_side\na,33.0\nb,33\nc,3.3e1\nd,33.5\n");
    let found = lines(&output.stdout);
    let force = |k: usize| found[k]["contact_force_n"].as_f64().unwrap().to_bits();
    assert_eq!([force(0), force(2)], [force(1); 2]);
    let error = found[3]["error"].as_str().unwrap();
    assert!(error.starts_with("solver.nodes_per_side: ") && error.contains("a whole number"));
    let text = |nodes: &str, cells: &str| {
        format!(
            r#"{{"implant":{{"base_radius_mm":50}},"solver":{{"nodes_per_side":{nodes},"tolerance":0.01,"cells_through":{cells}}}}}"#
        )
    };
    let one = |text: &str| run(&folder, &["simulate", "-", "--fields", "contact_force_n"], text);
    let wanted = one(&text("17", "1")).stdout;
    assert!(one(&text("17", "1")).status.success());
    for [nodes, cells] in [["17.0", "1.0"], ["1.7e1", "1e0"]] {
        assert_eq!(one(&text(nodes, cells)).stdout, wanted);
    }
    for [nodes, cells] in [["17.5", "1"], ["17", "1.5"], ["-17.0", "1"], ["1e300", "1"]] {
        let output = one(&text(nodes, cells));
        assert!(output.status.code() == Some(2) && notes(&output).contains("whole number"));
    }
    // A map: axis, nodes; samples of bands in the choices.
    let map = |count: &str| {
        let axis = format!("insertion=0.5:1:{count}");
        let arguments = ["map", "scene.json", "--x", &axis, "--nodes", "17", "--no-check"];
        run(&folder, &[&arguments[..], &["--out-dir", "out"]].concat(), "")
    };
    assert!(map("3.0").status.success());
    let found = fs::read(folder.join("out/map.json")).unwrap();
    let found: Value = serde_json::from_slice(&found).unwrap();
    assert_eq!(found["points"].as_array().unwrap().len(), 3);
    assert!(notes(&map("3.5")).contains("count is 3.5; allowed: 2 to "));
}

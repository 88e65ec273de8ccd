//! Hostile input: every input is either valid or rejected with one short line, in short time and little memory.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use dhat::{HeapStats, Profiler};
use implant_preview::clinical::PracticeTable;
use implant_preview::curve::{Curve, CurveSpec, Interpolation};
use implant_preview::measure::Status;
use implant_preview::scene::pins::{PINS_SCHEMA, pins_from_json, pins_json};
use implant_preview::scene::{CheckedScene, Document, Scene, SceneError, read};
use implant_preview::simulate::simulate;
use implant_preview::study::{Axis, Bands, BandsSettings, Map, MapSettings};
use implant_preview::table::{Form, Table};
use implant_preview_lab::work_precision::Plan;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::sync::Mutex;
use std::time::{Duration, Instant};

#[path = "common/hostile.rs"]
mod hostile;
use hostile::Choices;

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

/// One test at a time: the profiler counts the allocations of the whole process.
static ALONE: Mutex<()> = Mutex::new(());

const SOON: Duration = Duration::from_secs(1);
/// Greatest memory of a reader besides the input \[bytes\].
const LITTLE: usize = 64_000_000;

/// Random bytes, mostly few.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    vec(any::<u8>(), 0..200)
}

fn check<S: Strategy>(cases: u32, inputs: &S, test: impl Fn(S::Value)) {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let result = TestRunner::new_with_rng(config, fixed()).run(inputs, |input| {
        test(input);
        Ok(())
    });
    if let Err(error) = result {
        panic!("{error}");
    }
}

/// Equal inputs on every run and every machine.
fn fixed() -> proptest::test_runner::TestRng {
    proptest::test_runner::TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha)
}

#[test]
fn curves_of_any_numbers_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    check(20_000, &bytes(), |bytes| {
        let is_accepted = hostile::check_spec(&Choices(&bytes).curve());
        accepted.set(accepted.get() + i32::from(is_accepted));
    });
    assert!(accepted.get() > 8000, "{accepted:?} are too few to say much");
}

#[test]
fn scenes_of_any_numbers_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    check(8000, &bytes(), |bytes| {
        let read = Scene::from_json(&Choices(&bytes).scene());
        hostile::check_scene(&read);
        accepted.set(accepted.get() + i32::from(read.is_ok()));
    });
    assert!(accepted.get() > 400, "{accepted:?} are too few to say much");
}

#[test]
fn layered_scenes_of_any_numbers_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new([0; 2]);
    check(8000, &bytes(), |bytes| {
        let read = Scene::from_json(&Choices(&bytes).layered_scene());
        hostile::check_scene(&read);
        if let Ok(scene) = read {
            let mut counts = accepted.get();
            counts[usize::from(scene.is_layered())] += 1;
            accepted.set(counts);
        }
    });
    let [sheets, layered] = accepted.get();
    assert!(sheets > 50 && layered > 200, "{accepted:?} are too few to say much");
}

#[test]
fn scenes_with_a_chest_of_any_radii_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new([0; 2]);
    check(8000, &bytes(), |bytes| {
        let read = Scene::from_json(&Choices(&bytes).chest_scene());
        hostile::check_scene(&read);
        if let Ok(Some(chest)) = read.map(|scene| scene.chest) {
            let mut counts = accepted.get();
            counts[usize::from(chest.radius_across_mm < 0.0)] += 1;
            accepted.set(counts);
        }
    });
    let [outwards, hollow] = accepted.get();
    assert!(outwards > 50 && hollow > 5, "{accepted:?} are too few to say much");
}

#[test]
fn scenes_with_anatomical_implants_and_scans_of_any_numbers_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new([0; 4]);
    check(8000, &bytes(), |bytes| {
        let read = Scene::from_json(&Choices(&bytes).scanned_scene());
        hostile::check_scene(&read);
        if let Ok(scene) = read {
            let heights = scene.chest_grid.iter().flat_map(|chest| &*chest.grid.heights_mm);
            let is = [
                !scene.implant.is_round(),
                scene.chest_grid.is_some(),
                scene.thickness_field.is_some(),
                heights.into_iter().any(Option::is_none),
            ];
            let counts = accepted.get();
            accepted.set([0, 1, 2, 3].map(|k| counts[k] + i32::from(is[k])));
        }
    });
    assert!(accepted.get().into_iter().all(|count| count > 5), "{accepted:?} are too few");
}

#[test]
fn pins_of_any_scenes_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    let scene = r#"{"implant":{"base_radius_mm":50}}"#;
    check(4000, &(bytes(), vec(any::<u8>(), 0..6)), |(bytes, pins)| {
        let mut choices = Choices(&bytes);
        let pin = |kind: u8| {
            let scene = match kind % 4 {
                0 => choices.scene(),
                1 => choices.layered_scene(),
                _ => scene.to_owned(),
            };
            let name = ["", "before", "\\n", "💧"][usize::from(kind / 4 % 4)];
            let letter = ["\"A\"", "\"B\"", "\"D\"", "null", "\"E\""][usize::from(kind / 16 % 5)];
            format!(r#"{{"letter":{letter},"name":"{name}","scene":{scene}}}"#)
        };
        let pins: Vec<String> = pins.into_iter().map(pin).collect();
        let list = format!(r#"{{"schema":"{PINS_SCHEMA}","pins":[{}]}}"#, pins.join(","));
        match pins_from_json(&list) {
            Ok(pins) => {
                assert_eq!(pins_from_json(&pins_json(&pins)), Ok(pins));
                accepted.set(accepted.get() + 1);
            }
            Err(error) => hostile::check_message(&error),
        }
        let file = format!(r#"{{"implant":{{"base_radius_mm":50}},"pins":[{}]}}"#, pins.join(","));
        let read = Document::from_json(&file);
        assert_eq!(read.is_ok(), pins_from_json(&list).is_ok());
        assert_eq!(read.is_ok(), Scene::from_json(&file).is_ok());
    });
    assert!(accepted.get() > 400, "{accepted:?} are too few to say much");
}

#[test]
fn broken_texts_are_valid_or_rejected() {
    let place = any::<prop::sample::Index>;
    let edits = vec((place(), place(), any::<u8>(), 0_u8..4), 1..5);
    check(12_000, &(bytes(), edits), |(bytes, edits)| {
        let mut choices = Choices(&bytes);
        let curve = serde_json::to_string(&choices.curve()).unwrap();
        let mut text = format!("{}\r\n{}", choices.scene(), choices.layered_scene()).into_bytes();
        for (at, from, byte, kind) in edits {
            let (at, from) = (at.index(text.len()), from.index(text.len()));
            match kind {
                0 => text[at] = byte,
                1 => text.insert(at, byte),
                2 => text.truncate(at.max(1)),
                _ => text = [&text[..at], &text[from..]].concat(),
            }
            if text.is_empty() {
                return;
            }
        }
        hostile::check_lines(&text);
        let cut = text.len().min(curve.len());
        hostile::check_curve_file(&[&curve.as_bytes()[..cut / 2], &text[cut / 2..]].concat());
    });
}

#[test]
fn practice_tables_of_any_text_are_valid_or_rejected() {
    const PARTS: [&str; 13] = [
        "12",
        "-30",
        "cm",
        ";",
        "\n",
        "\"",
        "pull",
        "above",
        "1e308",
        "NaN",
        "0,5",
        "\u{1f}",
        "base width;at;",
    ];
    let place = any::<prop::sample::Index>;
    let edits = vec((place(), place(), prop::sample::select(&PARTS[..]), 0_u8..3), 1..4);
    let accepted = std::cell::Cell::new(0);
    check(8000, &edits, |edits| {
        let mut text: Vec<char> = PracticeTable::default().to_csv().chars().collect();
        for (at, to, part, kind) in edits {
            let (at, to) = (at.index(text.len()), to.index(text.len()));
            let to = if kind == 0 { at } else { to.clamp(at, (at + 6).min(text.len())) };
            let part = if kind == 2 { "" } else { part };
            text.splice(at..to, part.chars());
        }
        let is_accepted = hostile::check_practice(&text.into_iter().collect::<String>());
        accepted.set(accepted.get() + i32::from(is_accepted));
    });
    assert!(accepted.get() > 800, "{accepted:?} are too few to say much");
    check(4000, &bytes(), |bytes| {
        hostile::check_practice(&String::from_utf8_lossy(&bytes));
    });
}

#[test]
fn surfaces_in_scenes_are_read_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    let shapes = (3_u8..40, 0_u8..6, vec(any::<u8>(), 0..600));
    check(300, &shapes, |(count, kind, rest)| {
        let bytes: Vec<u8> = [count, kind].into_iter().chain(rest).collect();
        accepted.set(accepted.get() + i32::from(hostile::check_kept_surface(&bytes)));
    });
    assert!(accepted.get() > 30, "{accepted:?} are too few to say much");
}

#[test]
fn tensile_tests_of_any_table_are_read_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    let head =
        "|(True )?(Strain|Stretch|ε)( \\[(%|-|mm)\\])?[,;](Stress|σ)( \\((kPa|MPa|Pa|N)\\))?\n";
    let cell = "-?[0-9]{1,4}([.,][0-9]{1,3})?(e[0-9]{1,3})?( %| kPa)?";
    let row = format!("({cell}|x?)[,;\t ]({cell})([,;]{cell})?\r?\n");
    let rows = vec(0..900_u16, 1..80).prop_map(|steps| {
        let total = |k: usize| steps[..k].iter().map(|step| f64::from(*step)).sum::<f64>();
        let row =
            |k: usize| format!("{};{}\n", total(k) / 9e4, total(k) * f64::from(steps[k]) / 1e4);
        (0..steps.len()).map(row).collect::<String>()
    });
    check(
        3000,
        &(head, prop_oneof![vec(row.as_str(), 0..30).prop_map(|rows| rows.concat()), rows]),
        |(head, rows)| {
            let text = head + &rows;
            let is_accepted = hostile::check_tensile(text.as_bytes());
            accepted.set(accepted.get() + i32::from(is_accepted));
        },
    );
    assert!(accepted.get() > 1000, "{accepted:?} are too few to say much");
}

#[test]
fn a_long_tensile_test_is_read_soon() {
    let _alone = ALONE.lock();
    let text: String = (0..100_000)
        .map(|k| {
            format!("{},{}\n", f64::from(k) / 1e6, i64::from(k) * 7919 % 100_003 + i64::from(k))
        })
        .collect();
    let start = Instant::now();
    hostile::check_tensile(text.as_bytes());
    let time = start.elapsed();
    assert!(time < 4 * SOON, "{time:?}");
}

/// Tables of sizes of cells that are often right.
fn shelf_bytes() -> impl Strategy<Value = Vec<u8>> {
    const HEADS: [&str; 4] = [
        "Ref.;Width (cm);Height;Projection;Volume",
        "Name;Ø;Höhe;cc;x",
        "Title\n;;;;\nP;W;Base;Vol. (cc);Ref.",
        "",
    ];
    const CELLS: [&str; 20] = [
        "12", "11,5", "39", "4.1", "4", "275", "300 cc", "12.0 cm", "118 mm", "1.250", "A-1",
        "A-1", "* note", "é", "", "\"", "1e308", "NaN", "-3", "0",
    ];
    let rows = vec(vec(0..CELLS.len(), 5), 0..8);
    (0..HEADS.len(), rows, prop::sample::select(&[";", "\t", ","][..])).prop_map(
        |(head, rows, separator)| {
            let row =
                |cells: &Vec<usize>| cells.iter().map(|k| CELLS[*k]).collect::<Vec<_>>().join(";");
            let text = [HEADS[head].to_owned()]
                .into_iter()
                .chain(rows.iter().map(row))
                .collect::<Vec<_>>()
                .join("\n");
            text.replace(';', separator).into_bytes()
        },
    )
}

#[test]
fn tables_of_sizes_of_any_bytes_are_read_or_rejected_with_any_choice_of_columns() {
    let accepted = std::cell::Cell::new(0);
    let choices = || vec((0..8_usize, 0..12_usize), 0..6);
    check(6000, &(shelf_bytes(), choices()), |(bytes, choices)| {
        accepted.set(accepted.get() + i32::from(hostile::check_shelf(&bytes, &choices)));
    });
    assert!(accepted.get() > 150, "{accepted:?} are too few to say much");
    // Tables of makers with a piece in place of others.
    let tables: [&[u8]; 5] = [
        include_bytes!("fixtures/shelf/en-title.csv"),
        include_bytes!("fixtures/shelf/es-comas.csv"),
        include_bytes!("fixtures/shelf/de-unicode.txt"),
        include_bytes!("fixtures/shelf/fr-anatomique.csv"),
        include_bytes!("fixtures/shelf/pt-diametro.csv"),
    ];
    accepted.set(0);
    let edit = (any::<prop::sample::Index>(), 0..8_usize, shelf_bytes());
    check(3000, &(0..5_usize, vec(edit, 0..4), choices()), |(k, edits, choices)| {
        let mut bytes = tables[k].to_vec();
        for (at, length, piece) in edits {
            let at = at.index(bytes.len());
            let to = (at + length).min(bytes.len());
            bytes.splice(at..to, piece);
        }
        accepted.set(accepted.get() + i32::from(hostile::check_shelf(&bytes, &choices)));
    });
    assert!(accepted.get() > 1500, "{accepted:?} are too few to say much");
}

#[test]
fn any_bytes_are_rejected() {
    check(10_000, &vec(any::<u8>(), 0..100), |bytes| {
        hostile::check_lines(&bytes);
        hostile::check_curve_file(&bytes);
        hostile::check_tensile(&bytes);
    });
}

/// Reads hostile input twice: the first run checks the time, the second the memory.
fn refused<T>(input: &str, wanted: &[&str], read: impl Fn() -> Result<T, SceneError>) {
    let start = Instant::now();
    let error = read().err().unwrap_or_else(|| panic!("accepted: {input:.200}"));
    let time = start.elapsed();
    let profiler = Profiler::builder().testing().build();
    assert!(read().is_err());
    let peak = HeapStats::get().max_bytes;
    drop(profiler);
    hostile::check_message(&error);
    let line = error.to_string();
    for part in wanted {
        assert!(line.contains(part), "{line} lacks {part:?} of {input:.200}");
    }
    assert!(time < SOON, "{time:?} for {line}");
    assert!(peak < LITTLE, "{peak} bytes for {line}");
}

/// A scene with one additional field, as JSON text.
fn with(field: &str) -> String {
    format!(r#"{{"implant":{{"base_radius_mm":50}},{field}}}"#)
}

fn with_curve(curve: &str) -> String {
    with(&format!(r#""layers":[{{"curve":{curve}}}]"#))
}

/// Pieces that tables consist of.
fn table_bytes() -> impl Strategy<Value = Vec<u8>> {
    let pieces = [
        ";", ",", "\t", "\"", "\"\"", "\n", "\r", "\r\n", " ", "a", "é", "1", "12,5", "1.250",
        "1.234,5", "300 cc", "sep=;\n", "\u{feff}", "\0", "\u{a0}",
    ];
    vec(0..=pieces.len(), 0..60).prop_map(move |chosen| {
        let piece = |k: usize| pieces.get(k).map_or(&b"\xff"[..], |piece| piece.as_bytes());
        // A letter that is not UTF-8 is rare, so that most tables are read.
        let is_broken = chosen.iter().all(|k| *k > 0);
        let kept = chosen.iter().filter(|k| is_broken || **k < pieces.len());
        kept.flat_map(|k| piece(*k)).copied().collect()
    })
}

#[test]
fn tables_of_any_bytes_are_read_or_rejected() {
    check(20_000, &bytes(), |bytes| hostile::check_table(&bytes));
    check(20_000, &table_bytes(), |bytes| hostile::check_table(&bytes));
    let pairs = |bytes: Vec<u8>| [b"\xff\xfe".to_vec(), bytes].concat();
    check(5000, &bytes(), |bytes| hostile::check_table(&pairs(bytes)));
}

#[test]
fn tables_by_another_writer_are_read_cell_by_cell_however_rows_are_joined() {
    let text = prop_oneof!["[a-z\"; ,\t.0-9é\r\n]{0,6}", "[a-z]{1,3}"];
    let rows = vec(vec(text, 3), 1..6);
    let ends = vec(0..3_usize, 6);
    check(5000, &(rows, ends, 0..3_usize), |(rows, ends, separator)| {
        let separator = [b';', b',', b'\t'][separator];
        let mut bytes = Vec::new();
        for (row, end) in rows.iter().zip(&ends) {
            let terminator = csv::Terminator::Any(b'\n');
            let mut writer = csv::WriterBuilder::new();
            let writer = writer.delimiter(separator).terminator(terminator);
            let mut writer = writer.from_writer(Vec::new());
            writer.write_record(row.iter().map(String::as_str).chain(["x"])).unwrap();
            bytes.extend_from_slice(writer.into_inner().unwrap().strip_suffix(b"\n").unwrap());
            bytes.extend_from_slice([&b"\n"[..], b"\r", b"\r\n"][*end]);
        }
        let form = Form { separator: Some(separator), ..Form::PLAIN };
        let table = Table::read_as(std::str::from_utf8(&bytes).unwrap(), form).unwrap();
        let found: Vec<Vec<&str>> = table.rows().map(|row| row.cells().take(3).collect()).collect();
        assert_eq!(found, rows, "{bytes:?}");
    });
}

#[test]
fn a_large_table_takes_little_time_and_memory() {
    for text in [
        ";".repeat(9_999_999),
        "a\n".repeat(1_900_000),
        "\"".repeat(9_999_999),
        "\"\"\"\n,".repeat(1_999_999),
        "1,5;".repeat(1_900_000),
    ] {
        let _alone = ALONE.lock();
        let start = Instant::now();
        let read = Table::read(&text);
        let time = start.elapsed();
        let profiler = Profiler::builder().testing().build();
        assert_eq!(Table::read(&text), read);
        let peak = HeapStats::get().max_bytes;
        drop(profiler);
        if let Err(error) = read {
            hostile::check_message(&error);
        }
        assert!(time < 5 * SOON, "{time:?} for {text:.10}");
        assert!(peak < LITTLE, "{peak} bytes for {text:.10}");
    }
}

#[test]
fn hostile_scenes_are_rejected_in_one_line_with_the_field() {
    let _alone = ALONE.lock();
    let deep = |open: &str, close: &str| open.repeat(1000) + &close.repeat(1000);
    let long = "x".repeat(1_000_000);
    let digits = "9".repeat(1_000_000);
    let cases: Vec<(String, &[&str])> = vec![
        (String::new(), &["scene: is empty", "allowed: one JSON object"]),
        (" \r\n\t".to_owned(), &["scene: is empty"]),
        ("\0\0\0".to_owned(), &["scene", "line 1 column 1"]),
        ("null".to_owned(), &["scene is null", "allowed: one JSON object"]),
        ("\u{feff}\u{feff}{}".to_owned(), &["scene", "line 1 column 1"]),
        (deep("[", "]"), &["scene", "allowed: one JSON object"]),
        (deep(r#"{"implant":"#, "}"), &["implant", "unknown field `implant`"]),
        (with(&format!(r#""layers":{}"#, deep("[", "]"))), &["layers[0]"]),
        (with(&format!(r#""x":{}"#, deep("[", "]"))), &["`x`", "insertion"]),
        (with_curve(&deep("{\"kind\":", "}")), &["layers[0].curve.kind"]),
        (with(r#""insertion":NaN"#), &["insertion is nan", "allowed: 0 to 1"]),
        (with(r#""insertion":Infinity"#), &["insertion is inf", "allowed: 0 to 1"]),
        (with(r#""insertion":null"#), &["insertion is null", "allowed: 0 to 1, or leave it out"]),
        (with(r#""insertion":1e308"#), &["insertion is 1e308", "0 to 1"]),
        (with(r#""insertion":1e999"#), &["insertion", "number out of range", "numbers as 12.5"]),
        (with(r#""insertion":-1e-300"#), &["insertion is -1e-300"]),
        (with(&format!(r#""insertion":{digits}"#)), &["insertion"]),
        (with(r#""insertion":"1""#), &["insertion", "string", "expected a number"]),
        (with(r#""insertion":[1]"#), &["insertion", "sequence"]),
        (with(r#""insertion":0.5,"insertion":0.6"#), &["duplicate field `insertion`"]),
        (with(r#""pocket_radius_mm":1e308"#), &["pocket_radius_mm is 1e308", "50", "200 mm"]),
        (with(r#""pocket_radius_mm":-0.0"#), &["pocket_radius_mm is -0"]),
        (
            with(r#""schema":"implant-preview/scene/4""#),
            &["schema: is \"implant-preview/scene/4\"", "allowed: implant-preview/scene/1"],
        ),
        (with(r#""schema":"""#), &["schema", "implant-preview/scene/1"]),
        (with(r#""schema":1"#), &["schema", "expected a string"]),
        (
            with(r#""solver":{"nodes_per_side":33.5}"#),
            &["solver.nodes_per_side", "expected a whole number"],
        ),
        (with(&format!(r#""schema":"{long}""#)), &["schema", "implant-preview/scene/1"]),
        (with(&format!(r#""{long}":1"#)), &["unknown field", "insertion"]),
        (with(r#""a\nb\u001b[2J":1"#), &["unknown field `a b [2J`"]),
        (with(&format!(r#""springs":"{long}""#)), &["springs", "coupled", "nikolaev"]),
        (with(r#""springs":"nikolaev""#), &["springs is nikolaev", "tissue_model sheet"]),
        (with(r#""patch_radius_mm":1e999"#), &["patch_radius_mm", "number out of range"]),
        (with(r#""solver":{"cells_through":1.5}"#), &["solver.cells_through", "whole number"]),
        (
            with(r#""solver":{"cells_through":18446744073709551615}"#),
            &["solver.cells_through", "1 to 8"],
        ),
        (with(r#""solver":{"nodes_per_side":1e30}"#), &["solver.nodes_per_side", "1e+30"]),
        (with(r#""solver":{"nodes_per_side":65.5}"#), &["solver.nodes_per_side", "65.5"]),
        (with(r#""solver":{"nodes_per_side":-17}"#), &["solver.nodes_per_side", "-17"]),
        (
            with(r#""solver":{"nodes_per_side":18446744073709551615}"#),
            &["solver.nodes_per_side is 18446744073709551615", "17 to 1025"],
        ),
        (with(r#""solver":{"tolerance":0}"#), &["solver.tolerance is 0", "1e-7 to 0.01"]),
        (with(r#""solver":[]"#), &["solver", "one JSON object"]),
        (r#"{"implant":[50,50,[0,0]]}"#.to_owned(), &["implant", "one JSON object"]),
        (with(r#""solver":[65,1e-4]"#), &["solver", "one JSON object"]),
        (with(r#""layers":[["skin",1.5,0.4,{"kind":"skin"}]]"#), &["layers[0]", "one JSON object"]),
        (with_curve(r#"["linear",1]"#), &["layers[0].curve", "one JSON object"]),
        (with(r#""layers":{}"#), &["layers", "list of at most 8"]),
        (with(r#""layers":[[]]"#), &["layers[0]", "one JSON object"]),
        (with(&format!(r#""layers":[{}{{}}]"#, "{},".repeat(8))), &["layers", "at most 8"]),
        (with(r#""patient":7"#), &["patient", "one JSON object"]),
        (with(&format!(r#""patient":{{"{long}":1}}"#)), &["unknown field", "pinch_mm"]),
        (with(&format!(r#""patient":{{"derived":["{long}"]}}"#)), &["patient.derived[0] is"]),
        (with(r#""patient":{"pinch_mm":1e999}"#), &["patient.pinch_mm", "number out of range"]),
        (
            with_curve(r#"{"kind":"skin","strain_scale":1e308}"#),
            &["layers[0].curve.strain_scale is 1e308", "0.05 to 20"],
        ),
        (with_curve(r#"{"kind":"skin","stress_scale":"1"}"#), &["layers[0].curve.stress_scale"]),
        (with(r#""layers":[{"thickness_mm":null}]"#), &["layers[0].thickness_mm", "null"]),
        (with(r#""layers":[{"tissue":7}]"#), &["layers[0].tissue", "string"]),
        (with(r#""layers":[{"tissue":"a\nb"}]"#), &["layers[0].tissue is a b", "control"]),
        (with(r#""layers":[{"tissue":"\u0000"}]"#), &["layers[0].tissue", "control"]),
        (with(r#""layers":[{"tissue":"\ud800"}]"#), &["layers[0].tissue", "line 1"]),
        (
            with(&format!(r#""layers":[{{"tissue":"{long}"}}]"#)),
            &["layers[0].tissue is 1000000 bytes long", "100 bytes"],
        ),
        // Layered tissue.
        (with(r#""tissue_model":"jelly""#), &["tissue_model", "layered"]),
        (with(r#""tissue_model":["layered"]"#), &["tissue_model"]),
        (with(r#""patch_radius_mm":1e308"#), &["patch_radius_mm is 1e308", "to 260 mm"]),
        (with(r#""patch_radius_mm":-0.0"#), &["patch_radius_mm is -0"]),
        (with(r#""attachment":[2,10]"#), &["attachment", "one JSON object"]),
        (with(r#""attachment":{"ramp_mm":1e-300}"#), &["ramp_mm is 1e-300", "1 to 40 mm"]),
        (with(r#""attachment":{"stiffness":2}"#), &["attachment", "unknown field"]),
        (with(r#""solver":{"cells_through":1e300}"#), &["cells_through", "1 to 8"]),
        (with(r#""solver":{"cells_through":-1}"#), &["cells_through", "1 to 8"]),
        (with(r#""springs":"nikolaev""#), &["springs is nikolaev", "coupled"]),
        // Units: metres, micrometres, pascals, percent.
        (
            r#"{"implant":{"base_radius_mm":0.055}}"#.to_owned(),
            &["implant.base_radius_mm is 0.055", "10 to 120 mm"],
        ),
        (with(r#""layers":[{"thickness_mm":1500}]"#), &["thickness_mm is 1500", "0.2 to 60 mm"]),
        (with(r#""layers":[{"poisson_ratio":45}]"#), &["poisson_ratio is 45", "0 to 0.5"]),
        (with(r#""insertion":100"#), &["insertion is 100", "0 to 1"]),
        (
            with_curve(r#"{"kind":"linear","modulus_kpa":1e9}"#),
            &["layers[0].curve: modulus_kpa is 1e9", "1e-6 to 1e7 kPa"],
        ),
        (
            with_curve(r#"{"kind":"points","points":[[0,0],[20,1],[50,5]]}"#),
            &["layers[0].curve: points[1] is [20, 1]", "strain to 10"],
        ),
        (
            r#"{"implant":{"base_radius_mm":50,"center_mm":[1,2,3]}}"#.to_owned(),
            &["implant.center_mm", "2 numbers"],
        ),
        (
            r#"{"implant":{"base_radius_mm":50,"center_mm":[1e308,1e308]}}"#.to_owned(),
            &["implant.center_mm[0] is 1e308"],
        ),
    ];
    for (json, wanted) in &cases {
        refused(json, wanted, || Scene::from_json(json));
        refused(json, &[], || Plan::from_json(json));
    }
}

#[test]
fn hostile_curves_are_rejected_in_one_line_with_the_entry() {
    let _alone = ALONE.lock();
    for (json, wanted) in [
        (r#"{}"#, "missing field `kind`"),
        (r#"[]"#, "one JSON object"),
        (r#"{"kind":"skin","kind":"skin"}"#, "duplicate field `kind`"),
        (r#"{"kind":"skin","rate":1}"#, "field `rate` does not belong to this kind"),
        (r#"{"kind":"adipose","points":[]}"#, "field `points` does not belong to this kind"),
        (r#"{"kind":"linear","modulus_kpa":1,"modulus_kpa":2}"#, "duplicate field `modulus_kpa`"),
        (r#"{"kind":"linear","modulus_kpa":-0.0}"#, "modulus_kpa is -0"),
        (r#"{"kind":"linear","modulus_kpa":1e308}"#, "modulus_kpa is 1e308"),
        (r#"{"kind":"points"}"#, "missing field `points`"),
        (r#"{"kind":"points","points":{}}"#, "points: invalid type: map"),
        (r#"{"kind":"points","points":[[0,0],[0.5,"9"]]}"#, "points[1][1]: invalid type: string"),
        (r#"{"kind":"points","points":[[0,0],0.5]}"#, "points[1]"),
        (r#"{"kind":"points","points":[[0,0],[[1],2]]}"#, "points[1][0]"),
        (r#"{"kind":"points","points":[[0,0],[0.5]]}"#, "points[1]: invalid length 1"),
        (r#"{"kind":"points","points":[[0,0],[1e308,1e308]]}"#, "points[1] is [1e308, 1e308]"),
        (r#"{"kind":"points","points":[[0,0],[-1e308,1]]}"#, "points[1] is [-1e308, 1]"),
        (r#"{"kind":"points","points":[[0,0],[1e-300,1e-300]]}"#, "strains 1e-9 apart"),
        (r#"{"kind":"points","points":[[0,0],[1,1e-300]]}"#, "slope 1e-300; allowed: 1e-9 to 1e9"),
        (
            r#"{"kind":"points","points":[[0,0],[0.5,1e5],[0.500001,1e6]]}"#,
            "points[2] is [0.500001, 1e6] after [0.5, 100000]: slope",
        ),
        (r#"{"kind":"sections","sections":[[]]}"#, "sections[0]"),
        (r#"{"kind":"sections","sections":[{"kind":"linear","from":0}]}"#, "sections[0]"),
        (
            r#"{"kind":"sections","sections":[{"kind":"linear","from":0,"to":1,"modulus_kpa":1,"rate":1}]}"#,
            "sections[0]: field `rate` does not belong to this kind",
        ),
        (
            r#"{"kind":"sections","sections":[{"kind":"linear","from":0,"to":1e308,"modulus_kpa":1}]}"#,
            "sections[0] goes from 0 to 1e308",
        ),
        (
            r#"{"kind":"sections","sections":[{"kind":"polynomial","from":0,"to":1,
               "coefficients_kpa":[1,1,1,1,1,1,1,1,1]}]}"#,
            "sections[0].coefficients_kpa",
        ),
    ] {
        refused(json, &[wanted], || read::curve(json.as_bytes()));
        refused(json, &["layers[0].curve"], || Scene::from_json(&with_curve(json)));
    }
}

#[test]
fn other_encodings_are_text_or_rejected() {
    let _alone = ALONE.lock();
    let scene = Scene::default().to_json();
    let same = |bytes: &[u8]| {
        let scenes = read::scenes(bytes, read::Format::Json).unwrap();
        assert!(scenes.iter().map(CheckedScene::scene).eq([&Scene::default()]));
    };
    same(scene.as_bytes());
    same(format!("\u{feff}{scene}").as_bytes());
    same(scene.replace('\n', "\r\n").as_bytes());
    same(format!("\n\n{scene}\n\n").as_bytes());
    assert_eq!(Scene::from_json(&format!("\u{feff}{scene}")), Ok(Scene::default()));
    // The mark is no part of the first line.
    let line = with(r#""insertion":0.5"#);
    let lines = format!("\u{feff}{line}\n{line}\n");
    for format in [read::Format::Json, read::Format::JsonLines] {
        assert_eq!(read::scenes(lines.as_bytes(), format).unwrap().len(), 2);
    }
    let utf16: Vec<u8> = scene.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let marked = [&[0xff, 0xfe][..], &utf16].concat();
    let latin = with(r#""layers":[{"tissue":"Fettgewebe"}]"#).replace('F', "\u{1}").into_bytes();
    let latin: Vec<u8> = latin.into_iter().map(|b| if b == 1 { 0xfc } else { b }).collect();
    for (bytes, wanted) in [
        (&marked[..], "UTF-8"),
        (&utf16, "UTF-16 without a byte order mark"),
        (&latin, "UTF-8"),
        (&[0x89, b'P', b'N', b'G', 0, 255], "is a picture"),
        (&[0; 1000], "line 1 column 1"),
    ] {
        refused("encoded", &[wanted], || read::scenes(bytes, read::Format::Json));
        refused("encoded", &[], || read::curve(bytes));
    }
    // Carriage returns alone separate no lines: one scene is valid, two scenes are not.
    same(scene.replace('\n', "\r").as_bytes());
    assert_eq!(
        read::scenes(format!("{line}\r\n\r\n{line}").as_bytes(), read::Format::Json).unwrap().len(),
        2
    );
    let lines = format!("{line}\n{line}\n{{}}");
    refused(&lines, &["line 3", "implant"], || read::scenes(lines.as_bytes(), read::Format::Json));
    refused("", &["empty"], || read::scenes(b"\n \n", read::Format::JsonLines));
}

#[test]
fn long_inputs_are_read_or_rejected_soon_and_in_little_memory() {
    let _alone = ALONE.lock();
    // 10 MB are accepted, one byte more is not.
    let scene = with(r#""insertion":0.5"#);
    let padded = |length: usize| format!("{}{scene}", " ".repeat(length - scene.len()));
    let (most, more) = (padded(read::MAX_SCENE_BYTES), padded(read::MAX_SCENE_BYTES + 1));
    let start = Instant::now();
    assert!(Scene::from_json(&most).is_ok());
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
    refused(&more, &["scene is 10000001 bytes long", "10 MB"], || Scene::from_json(&more));
    // 10 MB of entries in bounded lists and in unknown fields.
    let filled = |entry: &str, around: &dyn Fn(&str) -> String| {
        let count = 9_900_000 / (entry.len() + 1);
        around(&format!("[{}]", vec![entry; count].join(",")))
    };
    let points = |list: &str| with_curve(&format!(r#"{{"kind":"points","points":{list}}}"#));
    let sections = |list: &str| with_curve(&format!(r#"{{"points":{list},"kind":"sections"}}"#));
    let layers = |list: &str| with(&format!(r#""layers":{list}"#));
    let tissue = |list: &str| with(&format!(r#""layers":[{{"tissue":{list}}}]"#));
    let anywhere = |list: &str| with(&format!(r#""x":{list}"#));
    for (entry, around, wanted) in [
        ("[0,1]", &points as &dyn Fn(&str) -> String, "layers[0].curve.points"),
        ("0", &points, "layers[0].curve.points[0]"),
        ("[0,1]", &sections, "layers[0].curve.points"),
        ("{}", &layers, "layers"),
        ("0", &tissue, "layers[0].tissue"),
        ("[[[]]]", &anywhere, "`x`"),
    ] {
        let json = filled(entry, around);
        refused(&json, &[wanted], || Scene::from_json(&json));
    }
    // A million points are rejected as text and as numbers; a hundred thousand are accepted.
    let line = |n: u32| -> Vec<[f64; 2]> {
        (0..n).map(|k| [1e-6 * f64::from(k), 1e-4 * f64::from(k)]).collect()
    };
    let million = line(1_000_000);
    let text: Vec<String> = million.iter().map(|[a, b]| format!("[{a:.6},{b:.4}]")).collect();
    let text = format!(r#"{{"kind":"points","points":[{}]}}"#, text.join(","));
    refused("1e6 points", &["curve is 18", "10 MB"], || read::curve(text.as_bytes()));
    let short: Vec<String> = (0..1_000_000).map(|k| format!("[{},{k}]", k % 9)).collect();
    let short = format!(r#"{{"kind":"points","points":[{}]}}"#, short[..800_000].join(","));
    let wanted = ["points: invalid length 100001", "at most 100000"];
    refused("8e5 points", &wanted, || read::curve(short.as_bytes()));
    let spec = CurveSpec::Points { points: million, interpolation: Interpolation::Spline };
    refused("1e6 points", &["points has 1000000 entries", "2 to 100000"], || {
        Curve::new(&spec).map_err(SceneError::CurveFile)
    });
    let spec = CurveSpec::Points { points: line(100_000), interpolation: Interpolation::Spline };
    let mut scene = Scene::default();
    scene.solver.nodes_per_side = 17;
    scene.layers[0].curve = spec.into();
    let json = serde_json::to_string(&scene).unwrap();
    let start = Instant::now();
    assert_eq!(Scene::from_json(&json), Ok(scene));
    assert!(start.elapsed() < SOON, "{:?}", start.elapsed());
}

#[test]
fn files_of_too_many_scenes_are_rejected() {
    let _alone = ALONE.lock();
    let line = "{\"implant\":{\"base_radius_mm\":50}}\n";
    let many = line.repeat(read::MAX_SCENES + 1);
    refused("100001 scenes", &["line 100001", "to 100000"], || {
        read::scenes(many.as_bytes(), read::Format::JsonLines)
    });
    let long = " ".repeat(read::MAX_LINES_BYTES + 1);
    refused("100 MB", &["file is 100000001 bytes long"], || {
        read::scenes(long.as_bytes(), read::Format::JsonLines)
    });
}

/// Every accepted scene is solved or has the status of a failed solve, with finite numbers.
#[test]
fn the_solve_of_every_accepted_scene_ends() {
    let counts = std::cell::RefCell::new([0_u32; 3]);
    check(4000, &vec(any::<u8>(), 20..200), |bytes| {
        let Ok(mut scene) = Scene::from_json(&Choices(&bytes).scene()) else { return };
        if counts.borrow().iter().sum::<u32>() >= 150 {
            return;
        }
        scene.solver.nodes_per_side = 17;
        scene.solver.tolerance = scene.solver.tolerance.max(1e-5);
        let json = scene.to_json();
        let start = Instant::now();
        let outcome = simulate(&scene).unwrap();
        let time = start.elapsed();
        assert!(time < 5 * SOON, "{time:?} for {json}");
        counts.borrow_mut()[outcome.status as usize] += 1;
        if outcome.status == Status::Converged {
            assert!(outcome.area_ratio.is_some_and(|ratio| ratio > 0.999), "{json}");
            let error = outcome.solver.estimated_position_error;
            assert!(error.is_some_and(|error| error <= scene.solver.tolerance), "{json}");
            assert!(!format!("{outcome:?}").contains("inf"), "{json}");
        }
        assert!(!format!("{outcome:?}").contains("NaN"), "{json}");
    });
    println!("converged, not converged, unstable: {counts:?}");
    assert!(counts.borrow()[0] > 100, "{counts:?}");
}

/// The same of layered tissue; the solids of every solution are closed meshes.
#[test]
fn the_solve_of_every_accepted_layered_scene_ends() {
    let counts = std::cell::RefCell::new([0_u32; 3]);
    check(4000, &vec(any::<u8>(), 20..200), |bytes| {
        let Ok(mut scene) = Scene::from_json(&Choices(&bytes).layered_scene()) else { return };
        if !scene.is_layered() || counts.borrow().iter().sum::<u32>() >= 50 {
            return;
        }
        scene.solver.nodes_per_side = 17;
        scene.solver.tolerance = scene.solver.tolerance.max(1e-4);
        let json = scene.to_json();
        let start = Instant::now();
        let outcome = simulate(&scene).unwrap();
        let time = start.elapsed();
        // The second attempt of eight cells through the thickness: seconds without optimisation.
        assert!(time < 20 * SOON, "{time:?} for {json}");
        counts.borrow_mut()[outcome.status as usize] += 1;
        if outcome.status == Status::Converged {
            let error = outcome.solver.estimated_position_error;
            assert!(error.is_some_and(|error| error <= scene.solver.tolerance), "{json}");
            assert!(!format!("{outcome:?}").contains("inf"), "{json}");
        }
        assert!(!format!("{outcome:?}").contains("NaN"), "{json}");
        hostile::check_first_solve(serde_json::to_string(&scene).unwrap().as_bytes());
    });
    println!("layered, converged, not converged, unstable: {counts:?}");
    assert!(counts.borrow()[0] > 10, "{counts:?}");
}

#[test]
fn axes_and_choices_of_bands_of_any_text_are_valid_or_rejected() {
    let scene = Scene::sheet();
    let axis = "(projection_mm|volume_ml|insertion|layers\\[[0-9]\\].thickness_mm|[ -~]{0,9})=\
                [-+.0-9einfNa]{0,9}:[-+.0-9e]{0,9}:[-0-9]{0,12}";
    check(4000, &axis, |text| {
        let map = Axis::parse(&text).and_then(|axis| {
            let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
            Map::new(&scene, &[axis], settings)
        });
        if let Err(error) = map {
            let line = error.to_string();
            assert!(line.len() < 1000 && !line.contains('\n'), "{line}");
        }
    });
    let number = "-?[0-9]{1,3}(e[0-9]{1,3})?";
    let choices = (number, number, number).prop_map(|(samples, median, gsd)| {
        format!(
            r#"{{"samples":{samples},"unknowns":{{"fat_modulus":{{"log_normal":{{"median":{median},"gsd":{gsd}}}}}}}}}"#
        )
    });
    check(2000, &choices, |text| {
        let line = match BandsSettings::from_json(&text) {
            Ok(choices) => Bands::new(&scene, choices).err().map(|error| error.to_string()),
            Err(error) => Some(error.to_string()),
        };
        assert!(line.is_none_or(|line| line.len() < 400 && !line.contains('\n')));
    });
    check(2000, &vec(any::<u8>(), 0..60), |bytes| {
        let text = String::from_utf8_lossy(&bytes);
        if let Err(error) = BandsSettings::from_json(&text) {
            assert!(!error.to_string().contains('\n'));
        }
    });
}

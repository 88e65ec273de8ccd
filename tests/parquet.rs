//! Tables as Parquet files on the command line.
#![cfg(all(feature = "command-line", unix))]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

#[path = "common/command.rs"]
mod command;
#[path = "common/signal.rs"]
mod signal;

use command::{folder, lines};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::FileReader;
use parquet::file::serialized_reader::SerializedFileReader;
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::parser::parse_message_type;
use serde_json::{Value, json};
use signal::signal_after;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::Arc;

const TEMPLATE: [&str; 4] = ["--template", "scene.json", "--table", "table.parquet"];
const PARQUET: [&str; 4] = ["--format", "parquet", "--fields", "contact_force_n,layers[1].tissue"];

fn run(folder: &Path, arguments: &[&str]) -> Output {
    command::run(folder, &[&["simulate"], arguments].concat(), "")
}

/// A folder with a small sheet as a template.
fn with_template() -> PathBuf {
    let folder = folder();
    let scene = json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": 30, "projection_mm": 20 },
        "pocket_radius_mm": 45,
        "layers": [
            { "curve": { "kind": "skin" } },
            { "tissue": "adipose", "thickness_mm": 10, "curve": { "kind": "adipose" } },
        ],
        "solver": { "nodes_per_side": 17 },
    });
    fs::write(folder.join("scene.json"), scene.to_string()).unwrap();
    folder
}

/// A column of a table that is read.
enum Column<'a> {
    Double(&'a [Option<f64>]),
    Float(&'a [f32]),
    Long(&'a [i64]),
    Date(&'a [i32]),
    Text(&'a [&'a str]),
}

/// Writes a table in one group of rows.
fn write(path: &Path, schema: &str, columns: &[Column]) {
    let schema = Arc::new(parse_message_type(&format!("message table {{ {schema} }}")).unwrap());
    let properties = Arc::new(WriterProperties::builder().build());
    let mut writer =
        SerializedFileWriter::new(File::create(path).unwrap(), schema, properties).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for column in columns {
        let mut to = group.next_column().unwrap().unwrap();
        match column {
            Column::Double(all) => {
                let levels: Vec<i16> = all.iter().map(|value| i16::from(value.is_some())).collect();
                let values: Vec<f64> = all.iter().copied().flatten().collect();
                to.typed::<DoubleType>().write_batch(&values, Some(&levels), None)
            }
            Column::Float(values) => to.typed::<FloatType>().write_batch(values, None, None),
            Column::Long(values) => to.typed::<Int64Type>().write_batch(values, None, None),
            Column::Date(values) => to.typed::<Int32Type>().write_batch(values, None, None),
            Column::Text(values) => {
                let values: Vec<ByteArray> = values.iter().map(|text| (*text).into()).collect();
                to.typed::<ByteArrayType>().write_batch(&values, None, None)
            }
        }
        .unwrap();
        to.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

/// The rows of a file, and the number of its groups.
fn rows(path: &Path) -> (Vec<Vec<(String, Field)>>, usize) {
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let groups = reader.num_row_groups();
    (reader.into_iter().map(|row| row.unwrap().into_columns()).collect(), groups)
}

#[test]
fn a_parquet_table_gives_the_results_of_its_rows() {
    let folder = with_template();
    let schema = "REQUIRED INT64 id; OPTIONAL DOUBLE implant.projection_mm; REQUIRED FLOAT insertion; \
                  REQUIRED BYTE_ARRAY layers[0].curve.kind (STRING);";
    let projections = [Some(20.0), Some(0.1 + 20.2), None];
    let columns = [
        Column::Long(&[7, -1, 1 << 60]),
        Column::Double(&projections),
        Column::Float(&[1.0, 0.3, 1.0]),
        Column::Text(&["skin", "adipose", "skin"]),
    ];
    write(&folder.join("table.parquet"), schema, &columns);
    let output = run(&folder, &[&TEMPLATE[..], &PARQUET, &["--out", "out.parquet"]].concat());
    assert_eq!(output.status.code(), Some(2));
    let found = rows(&folder.join("out.parquet")).0;
    let names: Vec<&str> = found[0].iter().map(|(name, _)| name.as_str()).collect();
    let wanted = ["id", "scene_hash", "status", "contact_force_n", "layers[1].tissue", "error"];
    assert_eq!(names, wanted);
    // The same scenes, written out.
    let scene: Value =
        serde_json::from_slice(&fs::read(folder.join("scene.json")).unwrap()).unwrap();
    let ids = ["7", "-1", "1152921504606846976"];
    for (k, (row, id)) in found.iter().zip(ids).enumerate() {
        assert_eq!(row[0].1, Field::Str(id.to_owned()));
        assert!(matches!(&row[1].1, Field::Str(hash) if hash.len() == 32));
        let Some(projection) = projections[k] else {
            let Field::Str(error) = &row[5].1 else { panic!("{row:?}") };
            assert!(error.starts_with("line 4: implant.projection_mm is \"\""), "{error}");
            assert_eq!((&row[2].1, &row[3].1), (&Field::Null, &Field::Null));
            continue;
        };
        let mut scene = scene.clone();
        scene["implant"]["projection_mm"] = json!(projection);
        scene["insertion"] = json!(if k == 1 { 0.3 } else { 1.0 });
        let kind = if k == 1 { "adipose" } else { "skin" };
        scene["layers"][0]["curve"]["kind"] = json!(kind);
        let output = command::run(&folder, &["simulate", "-", "--lines"], &scene.to_string());
        let line = &lines(&output.stdout)[0];
        assert_eq!(row[3].1, Field::Double(line["contact_force_n"].as_f64().unwrap()));
        let tissue = line["layers"][1]["tissue"].as_str().unwrap();
        assert_eq!(row[4].1, Field::Str(tissue.to_owned()));
        assert_eq!((&row[2].1, &row[5].1), (&Field::Str("converged".to_owned()), &Field::Null));
    }
}

#[test]
fn a_signal_leaves_a_whole_file() {
    let folder = with_template();
    let insertions: Vec<Option<f64>> =
        (0..200_000).map(|k| Some(1.0 - 1e-7 * f64::from(k))).collect();
    let column = [Column::Double(&insertions)];
    write(&folder.join("table.parquet"), "OPTIONAL DOUBLE insertion;", &column);
    let arguments =
        [&["simulate"], &TEMPLATE[..], &PARQUET, &["--out", "out.parquet", "--threads", "1"]];
    let child = command::spawn(&folder, &arguments.concat());
    let out = folder.join("out.parquet");
    signal_after(&child, "TERM", &out, 1);
    let output = child.wait_with_output().unwrap();
    let words = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{words}");
    let whole = rows(&out).0.len();
    assert!(whole < insertions.len() && words.contains(&format!("{whole} ")), "{whole}: {words}");
}

#[test]
fn rows_stand_in_groups_of_ten_thousand() {
    let folder = with_template();
    // An error is quicker than a solve.
    let insertions = vec![Some(2.0); 20_001];
    write(
        &folder.join("table.parquet"),
        "OPTIONAL DOUBLE insertion;",
        &[Column::Double(&insertions)],
    );
    let output = run(&folder, &[&TEMPLATE[..], &PARQUET, &["--out", "out.parquet"]].concat());
    assert_eq!(output.status.code(), Some(2));
    let (found, groups) = rows(&folder.join("out.parquet"));
    assert_eq!((found.len(), groups), (20_001, 3));
    let Field::Str(error) = &found[20_000][5].1 else { panic!() };
    assert!(error.starts_with("line 20002: insertion is 2"), "{error}");
}

#[test]
fn what_is_no_table_of_numbers_is_one_line() {
    let folder = with_template();
    let path = folder.join("table.parquet");
    let refused = |arguments: &[&str]| {
        let output = run(&folder, arguments);
        let line = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), line.lines().count()), (Some(2), 1), "{line}");
        line
    };
    let no_table = refused(&TEMPLATE);
    assert!(no_table.contains("table.parquet: cannot be read as Parquet: "), "{no_table}");
    fs::write(&path, "insertion\n1\n").unwrap();
    assert!(refused(&TEMPLATE).contains("table.parquet: cannot be read as Parquet: "));
    write(&path, "REQUIRED INT32 insertion (DATE);", &[Column::Date(&[1])]);
    let date = refused(&TEMPLATE);
    let wanted =
        "column insertion has values of another kind; allowed: numbers, texts and truth values";
    assert!(date.contains(wanted), "{date}");
    let done = [&TEMPLATE[..], &PARQUET, &["--skip-done", "out.parquet"]].concat();
    assert!(
        refused(&done).contains("a Parquet file is not continued; allowed: --format csv or json")
    );
    // A damaged file.
    write(&path, "OPTIONAL DOUBLE insertion;", &[Column::Double(&[Some(1.0); 100])]);
    let whole = fs::read(&path).unwrap();
    for k in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[k] ^= 0x15;
        fs::write(&path, &bytes).unwrap();
        let output =
            run(&folder, &[&TEMPLATE[..], &["--fields", "status", "--threads", "1"]].concat());
        let words = String::from_utf8(output.stderr).unwrap();
        assert!(matches!(output.status.code(), Some(0 | 2 | 3)), "byte {k}: {words}");
        assert!(!words.contains("internal") && words.lines().count() <= 1, "byte {k}: {words}");
    }
}

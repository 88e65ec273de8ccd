//! How a run starts: closed standard streams, thread variables, lines of an earlier run of other scenes or fields.
#![cfg(all(feature = "command-line", unix))]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

#[path = "common/command.rs"]
mod command;

use command::{folder, lines, run};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Duration;

fn sheet(projection_mm: f64) -> Value {
    json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": 30, "projection_mm": projection_mm },
        "solver": { "nodes_per_side": 17 },
    })
}

/// Runs a line of a shell in which `$P` is the program.
fn shell(folder: &Path, line: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_implant-preview");
    Command::new("sh").args(["-c", line]).env("P", program).current_dir(folder).output().unwrap()
}

/// Exit code and standard error of a line of a shell.
fn ending(folder: &Path, line: &str) -> (Option<i32>, String) {
    let output = shell(folder, line);
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn a_closed_output_is_an_error_and_an_empty_one_is_not() {
    let folder = folder();
    fs::write(folder.join("t.json"), sheet(20.0).to_string()).unwrap();
    fs::write(folder.join("t.jsonl"), format!("{}\n", sheet(20.0))).unwrap();
    fs::write(folder.join("table.csv"), "insertion\n1\n").unwrap();
    let one = "error: standard output: is closed\n".to_owned();
    for arguments in [
        "simulate t.json --fields contact_force_n",
        "simulate t.json --out -",
        "simulate t.json --out /dev/stdout",
        "simulate t.json --out r.json --profile -",
        "simulate t.jsonl",
        "simulate t.json --format csv --fields contact_force_n",
        "simulate --template t.json --table table.csv",
        "bands t.json --samples 16 --nodes 17 --importance 0",
        "schema",
        "curve curve.csv",
        "--help",
        "simulate --help",
        "--version",
    ] {
        let found = ending(&folder, &format!("exec \"$P\" {arguments} >&-"));
        assert_eq!(found, (Some(1), one.clone()), "{arguments}");
        assert!(!folder.join("r.json").exists());
    }
    // An output that is thrown away, and one that is not used.
    for line in [
        "\"$P\" simulate t.json --fields contact_force_n >/dev/null",
        "\"$P\" simulate t.json --fields contact_force_n <>/dev/null >&0",
        "\"$P\" simulate t.json --out r.json >&-",
        "\"$P\" schema --out s.json >&- 2>&- <&-",
        "\"$P\" map t.json --x insertion=.5:1:2 --nodes 17 --no-check --out-dir map >&-",
    ] {
        assert_eq!(ending(&folder, line).0, Some(0), "{line}");
    }
    assert!(["r.json", "s.json", "map/map.csv"].iter().all(|name| folder.join(name).exists()));
}

#[test]
fn a_closed_input_is_an_error_and_an_empty_one_has_no_scene() {
    let folder = folder();
    fs::write(folder.join("t.json"), sheet(20.0).to_string()).unwrap();
    for arguments in [
        "simulate - --lines",
        "simulate -",
        "simulate - --format csv --fields status",
        "simulate --template t.json --table -",
        "map - --out-dir map",
        "bands -",
        "curve -",
    ] {
        let found = ending(&folder, &format!("exec \"$P\" {arguments} <&-"));
        let line = "error: standard input: cannot be read: it is closed\n";
        assert_eq!(found, (Some(2), line.to_owned()), "{arguments}");
    }
    let empty = ending(&folder, "\"$P\" simulate - --lines </dev/null");
    assert_eq!(empty, (Some(0), String::new()));
}

/// The greatest number of threads of a run, as often as it can be read, and its output.
fn threads(folder: &Path, variable: (&str, &str), arguments: &[&str]) -> (usize, Output) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_implant-preview"));
    command.args(arguments).current_dir(folder).env(variable.0, variable.1);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let tasks = format!("/proc/{}/task", child.id());
    let mut most = 0;
    while child.try_wait().unwrap().is_none() {
        most = most.max(fs::read_dir(&tasks).map_or(0, Iterator::count));
        thread::sleep(Duration::from_millis(2));
    }
    (most, child.wait_with_output().unwrap())
}

#[test]
fn thread_variables_start_no_more_threads_than_cores() {
    let folder = folder();
    let mut slow = sheet(20.0);
    slow["solver"]["nodes_per_side"] = json!(257);
    fs::write(folder.join("t.jsonl"), format!("{slow}\n").repeat(3)).unwrap();
    // Beside the solving threads: that of the program and that of its signals.
    let most = thread::available_parallelism().unwrap().get() + 2;
    let simulate = ["simulate", "t.jsonl", "--fields", "status"];
    for name in ["SLURM_CPUS_PER_TASK", "OMP_NUM_THREADS"] {
        for (value, most, notes) in
            [("1,2", 3, 0), ("1000000", most, 0), ("99999999", most, 0), ("many", most, 1)]
        {
            let (found, output) = threads(&folder, (name, value), &simulate);
            assert!(found <= most, "{name}={value}: {found} threads");
            assert_eq!((output.status.code(), lines(&output.stdout).len()), (Some(0), 3));
            let complaint = String::from_utf8(output.stderr).unwrap();
            assert_eq!(complaint.lines().count(), notes, "{complaint}");
            let words = format!("note: {name} is \"many\", which is ignored; allowed: 1 to 1024");
            assert!(notes == 0 || complaint.starts_with(&words), "{complaint}");
        }
    }
    let stability = ["stability", "--out-dir", "maps"];
    let (found, output) = threads(&folder, ("RAYON_NUM_THREADS", "5000"), &stability);
    assert!(output.status.success() && found <= most, "{found} threads");
}

/// The lines of a file by their ids.
fn projections(folder: &Path, file: &str) -> Vec<(Value, f64)> {
    let found = lines(&fs::read(folder.join(file)).unwrap());
    let of = |line: &Value| (line["id"].clone(), line["implant_volume_ml"].as_f64().unwrap());
    found.iter().map(of).collect()
}

#[test]
fn a_changed_scene_of_a_known_id_is_solved_again_and_said() {
    let folder = folder();
    let with_id = |id: u32, projection: f64| {
        let mut scene = sheet(projection);
        scene["id"] = json!(id);
        format!("{scene}\n")
    };
    fs::write(folder.join("first.jsonl"), with_id(1, 20.0) + &with_id(3, 20.0)).unwrap();
    fs::write(
        folder.join("changed.jsonl"),
        with_id(1, 10.0) + &with_id(2, 10.0) + &with_id(3, 20.0),
    )
    .unwrap();
    for (form, out) in [("json", "r.jsonl"), ("csv", "r.csv")] {
        let common = ["--fields", "implant_volume_ml", "--format", form, "--out", out];
        let first = run(&folder, &[&["simulate", "first.jsonl"], &common[..]].concat(), "");
        assert!(first.status.success());
        let arguments = [&["simulate", "changed.jsonl", "--skip-done", out], &common[..]].concat();
        let note = String::from_utf8(run(&folder, &arguments, "").stderr).unwrap();
        let said = "--skip-done: 1 scenes with a line of their id are other scenes now";
        assert!(
            note.contains(said) && note.contains("--skip-done: 1 scenes have a line"),
            "{note}"
        );
        let text = fs::read(folder.join(out)).unwrap();
        // Another run has nothing to do.
        let again = run(&folder, &arguments, "");
        let words = "note: --skip-done: 3 scenes have a line already\n";
        assert_eq!(String::from_utf8(again.stderr).unwrap(), words);
        assert_eq!(fs::read(folder.join(out)).unwrap(), text);
    }
    let found = projections(&folder, "r.jsonl");
    assert_eq!(found.iter().map(|(id, _)| id.as_u64().unwrap()).collect::<Vec<_>>(), [1, 3, 1, 2]);
    // Half-ellipsoids of the same base: the volume is proportional to the projection.
    assert!(
        (found[0].1 / found[2].1 - 2.0).abs() < 1e-12
            && found[2].1.to_bits() == found[3].1.to_bits()
    );
    let hashes: Vec<Value> = lines(&fs::read(folder.join("r.jsonl")).unwrap())
        .iter()
        .map(|line| line["scene_hash"].clone())
        .collect();
    assert!(hashes[0] == hashes[1] && hashes[2] == hashes[3] && hashes[0] != hashes[2]);
    let csv = fs::read_to_string(folder.join("r.csv")).unwrap();
    let column: Vec<&str> = csv.lines().skip(1).map(|row| row.split(',').nth(1).unwrap()).collect();
    assert_eq!(column, hashes.iter().map(|hash| hash.as_str().unwrap()).collect::<Vec<_>>());
}

#[test]
fn a_changed_template_of_rows_with_ids_is_solved_again() {
    let folder = folder();
    fs::write(folder.join("table.csv"), "id,insertion\na,1\nb,0.5\n").unwrap();
    let arguments = ["simulate", "--template", "t.json", "--table", "table.csv"];
    let arguments =
        [&arguments[..], &["--fields", "implant_volume_ml", "--out", "r.jsonl"]].concat();
    let goes_on = [&arguments[..], &["--skip-done", "r.jsonl"]].concat();
    fs::write(folder.join("t.json"), sheet(20.0).to_string()).unwrap();
    assert!(run(&folder, &arguments, "").status.success());
    let same = String::from_utf8(run(&folder, &goes_on, "").stderr).unwrap();
    assert_eq!(same, "note: --skip-done: 2 scenes have a line already\n");
    fs::write(folder.join("t.json"), sheet(10.0).to_string()).unwrap();
    let note = String::from_utf8(run(&folder, &goes_on, "").stderr).unwrap();
    assert!(note.contains("2 scenes with a line of their id are other scenes now"), "{note}");
    let found = projections(&folder, "r.jsonl");
    assert!(found.len() == 4 && (found[0].1 / found[2].1 - 2.0).abs() < 1e-12);
}

#[test]
fn lines_of_other_fields_are_not_continued() {
    let folder = folder();
    // The first line is an error, the second a result.
    let text = format!("{{broken\n{}\n", sheet(20.0));
    fs::write(folder.join("t.jsonl"), text).unwrap();
    let out = folder.join("r.jsonl");
    let choices: [&[&str]; 5] = [
        &[],
        &["--no-profile"],
        &["--fields", "contact_force_n"],
        &["--fields", "strain.max_principal"],
        &["--fields", "strain"],
    ];
    for first in choices {
        let simulate = |more: &[&str]| {
            run(&folder, &[&["simulate", "t.jsonl", "--out", "r.jsonl"], more].concat(), "")
        };
        simulate(first);
        let text = fs::read(&out).unwrap();
        for second in choices {
            let output = simulate(&[second, &["--skip-done", "r.jsonl"]].concat());
            let line = String::from_utf8(output.stderr).unwrap();
            if first == second {
                assert_eq!(line, "note: --skip-done: 2 scenes have a line already\n");
            } else {
                let words = "error: r.jsonl: --skip-done: line 2 has other fields (";
                assert!(line.starts_with(words), "{first:?} {second:?}: {line}");
                assert_eq!(output.status.code(), Some(2));
            }
            assert_eq!(fs::read(&out).unwrap(), text);
        }
    }
}

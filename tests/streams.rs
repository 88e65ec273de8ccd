//! Streams of scenes on the command line: a line in, a line out, through interruptions and in bounded memory.
#![cfg(all(feature = "command-line", unix))]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

#[path = "common/command.rs"]
mod command;
#[path = "common/signal.rs"]
mod signal;

use command::{folder, lines, run, spawn};
use serde_json::{Value, json};
use signal::{signal, signal_after};
use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

/// A small sheet of its own radius.
fn sheet(k: usize) -> Value {
    json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": 30.0 + 0.001 * k as f64 },
        "solver": { "nodes_per_side": 17 },
    })
}

fn with_id(mut scene: Value, id: Value) -> Value {
    scene["id"] = id;
    scene
}

/// `count` small sheets whose ids are their numbers, a line each.
fn numbered(count: usize) -> String {
    (0..count).map(|k| format!("{}\n", with_id(sheet(k), json!(k)))).collect()
}

#[test]
fn a_bad_line_among_six_has_an_error_in_its_place() {
    let folder = folder();
    let ids = [json!(7), json!("a\nb"), json!(null), json!({"x": [1, 2.5]}), json!(true)];
    let mut scenes: Vec<Value> = (0..5).map(|k| with_id(sheet(k), ids[k].clone())).collect();
    let mut bad = with_id(sheet(9), json!("bad"));
    bad["implant"]["base_radius_mm"] = json!(500);
    scenes.insert(3, bad);
    let text = scenes.iter().map(|scene| format!("{scene}\n")).collect::<String>();
    fs::write(folder.join("six.jsonl"), &text).unwrap();
    for arguments in [&["simulate", "-"][..], &["simulate", "six.jsonl", "--threads", "3"]] {
        let output = run(&folder, arguments, &text);
        assert_eq!(output.status.code(), Some(2));
        let complaint = String::from_utf8(output.stderr).unwrap();
        assert!(
            complaint.contains("1 of 6 lines") && complaint.lines().count() == 1,
            "{complaint}"
        );
        let found = lines(&output.stdout);
        assert_eq!(found.len(), 6);
        for (k, line) in found.iter().enumerate() {
            if k == 3 {
                assert_eq!((&line["id"], &line["line"]), (&json!("bad"), &json!(4)));
                let error = line["error"].as_str().unwrap();
                assert!(error.contains("implant.base_radius_mm is 500"), "{error}");
                continue;
            }
            let wanted = &scenes[k];
            assert_eq!(line["status"], "converged");
            assert_eq!(line.get("id").unwrap_or(&Value::Null), &wanted["id"]);
            assert_eq!(line["scene_hash"].as_str().map(str::len), Some(32));
            let radius = wanted["implant"]["base_radius_mm"].as_f64().unwrap();
            let volume = 2.0 / 3.0 * std::f64::consts::PI * radius.powi(3) / 1000.0;
            assert!((line["implant_volume_ml"].as_f64().unwrap() / volume - 1.0).abs() < 1e-9);
        }
    }
    // The first line, in standard input and in a file without a telling name.
    let broken = format!("{{broken\n\n{text}");
    fs::write(folder.join("six.txt"), &broken).unwrap();
    for file in ["-", "six.txt"] {
        let found = lines(&run(&folder, &["simulate", file, "--fields", "status"], &broken).stdout);
        assert_eq!(found.len(), 7, "{file}");
        assert!(found[0]["id"].is_null() && found[0]["line"] == 1 && found[1]["id"] == 7);
        assert_eq!(found[4]["line"], 6);
    }
    // Of several files an error names the file; a file of one scene is part of the stream.
    fs::write(folder.join("one.json"), serde_json::to_string_pretty(&sheet(1)).unwrap()).unwrap();
    let found = lines(&run(&folder, &["simulate", "one.json", "six.jsonl"], "").stdout);
    assert_eq!(
        (found.len(), &found[4]["file"], &found[4]["line"]),
        (7, &json!("six.jsonl"), &json!(4))
    );
    // A single scene keeps its id, in a result over many lines.
    fs::write(folder.join("id.json"), with_id(sheet(1), json!([1])).to_string()).unwrap();
    let single = run(&folder, &["simulate", "id.json", "--no-profile"], "");
    assert!(single.stdout.starts_with(b"{\n  \"id\": [1],\n"));
}

#[test]
fn a_result_is_written_before_the_next_scene_comes() {
    let mut child = spawn(&folder(), &["simulate", "-", "--lines", "--fields", "status"]);
    let mut stdin = child.stdin.take().unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    for k in 0..3 {
        writeln!(stdin, "{}", with_id(sheet(k), json!(k))).unwrap();
        let mut line = String::new();
        stdout.read_line(&mut line).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&line).unwrap()["id"], k);
    }
    drop(stdin);
    assert!(child.wait().unwrap().success());
    // No scene at all, as in an empty part of a distributed list.
    let none = run(&folder(), &["simulate", "-", "--lines"], "");
    assert!(none.status.success() && none.stdout.is_empty() && none.stderr.is_empty());
}

#[test]
fn results_come_in_order_or_as_they_are_ready() {
    let folder = folder();
    let mut slow = json!({ "id": 0, "implant": { "base_radius_mm": 50, "center_mm": [5, 3] } });
    slow["solver"] = json!({ "nodes_per_side": 129 });
    let text: String = std::iter::once(slow)
        .chain((1..9).map(|k| with_id(sheet(k), json!(k))))
        .map(|scene| format!("{scene}\n"))
        .collect();
    let ids = |more: &[&str]| -> Vec<u64> {
        let arguments = ["simulate", "-", "--fields", "status", "--threads", "2"];
        let output = run(&folder, &[&arguments, more].concat(), &text);
        assert!(output.status.success());
        lines(&output.stdout).iter().map(|line| line["id"].as_u64().unwrap()).collect()
    };
    assert_eq!(ids(&[]), (0..9).collect::<Vec<_>>());
    let mut unordered = ids(&["--unordered"]);
    assert_ne!(unordered[0], 0);
    unordered.sort_unstable();
    assert_eq!(unordered, (0..9).collect::<Vec<_>>());
}

/// How often each id, or each hash, has a line.
fn counts(file: &Path) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for line in lines(&fs::read(file).unwrap()) {
        let name = line.get("id").filter(|id| !id.is_null()).unwrap_or(&line["scene_hash"]);
        *counts.entry(name.to_string()).or_default() += 1;
    }
    counts
}

#[test]
fn a_run_goes_on_after_a_kill_with_nothing_lost_and_nothing_twice() {
    let folder = folder();
    let anonymous: String = (0..3000).map(|k| format!("{}\n", sheet(k % 2999))).collect();
    for (name, text, distinct) in [("id", numbered(3000), 3000), ("content", anonymous, 2999)] {
        let text = format!("{{broken\n{text}");
        fs::write(folder.join("scenes.jsonl"), text).unwrap();
        let out = folder.join(format!("{name}.jsonl"));
        let out_name = out.file_name().unwrap().to_str().unwrap();
        let arguments = ["simulate", "scenes.jsonl", "--fields", "status", "--out", out_name];
        let mut child = spawn(&folder, &[&arguments[..], &["--unordered"]].concat());
        signal_after(&child, "KILL", &out, 10_000);
        child.wait().unwrap();
        // The last line is half written.
        let mut left = fs::read(&out).unwrap();
        left.truncate(left.len() - 5);
        fs::write(&out, &left).unwrap();
        let before = left.iter().filter(|byte| **byte == b'\n').count();
        let output = run(&folder, &[&arguments[..], &["--skip-done", out_name]].concat(), "");
        let counts = counts(&out);
        assert_eq!(counts.len(), distinct + 1, "{name}");
        assert_eq!(counts.values().sum::<usize>(), 3001, "{name}");
        assert!(counts.values().filter(|count| **count > 1).count() <= 3000 - distinct, "{name}");
        assert!(
            fs::read(&out)
                .unwrap()
                .starts_with(&left[..left.iter().rposition(|b| *b == b'\n').unwrap()])
        );
        assert!(before > 50, "{name}: {before} lines before");
        // The broken line is done, too.
        let is_again = output.status.code() == Some(2);
        assert!(is_again || output.status.success());
        let again = run(&folder, &[&arguments[..4], &["--skip-done", out_name]].concat(), "");
        assert!(again.status.success() && again.stdout.is_empty(), "{name}");
    }
}

#[test]
fn a_signal_leaves_whole_lines() {
    let folder = folder();
    fs::write(folder.join("scenes.jsonl"), numbered(100_000)).unwrap();
    for name in ["TERM", "INT"] {
        let mut child = spawn(&folder, &["simulate", "scenes.jsonl", "--out", "out.jsonl"]);
        let out = folder.join("out.jsonl");
        signal_after(&child, name, &out, 1_000_000);
        let output = child.wait().unwrap();
        assert_eq!(output.code(), Some(130));
        let text = fs::read(&out).unwrap();
        let found = lines(&text);
        assert!(text.ends_with(b"\n") && found.len() > 50 && found.len() < 100_000);
        let ids: Vec<u64> = found.iter().map(|line| line["id"].as_u64().unwrap()).collect();
        assert!(ids.is_sorted());
        fs::remove_file(&out).unwrap();
    }
}

#[test]
fn a_signal_leaves_the_cases_of_stress_and_their_summary() {
    let folder = folder();
    let arguments = ["stress", "--cases", "100000", "--most-nodes", "17", "--out", "s.json"];
    let child = spawn(&folder, &[&arguments[..], &["--lines", "cases.jsonl"]].concat());
    let out = folder.join("cases.jsonl");
    signal_after(&child, "TERM", &out, 20_000);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(130));
    let found = lines(&fs::read(&out).unwrap());
    assert!(found.len() > 5 && found.is_sorted_by_key(|case| case["case"].as_u64()));
    let summary: Value = serde_json::from_slice(&fs::read(folder.join("s.json")).unwrap()).unwrap();
    let cases = |springs: &str| summary[springs]["cases"].as_u64().unwrap();
    assert_eq!(cases("coupled") + cases("nikolaev"), found.len() as u64);
}

/// Ends a run by a signal after a while, a longer one until the run has something to keep; returns what `kept` reads.
fn interrupted<T>(folder: &Path, arguments: &[&str], kept: impl Fn() -> Option<T>) -> T {
    for wait_ms in (0..8).map(|k| 250 << k) {
        let child = spawn(folder, arguments);
        thread::sleep(Duration::from_millis(wait_ms));
        signal(&child, "TERM");
        let output = child.wait_with_output().unwrap();
        // Before the handler stands, a signal ends the process.
        if output.status.code().is_none() {
            continue;
        }
        assert_eq!(output.status.code(), Some(130), "{arguments:?}");
        let warning = String::from_utf8(output.stderr).unwrap();
        assert!(warning.contains("ended by a signal; "), "{arguments:?}: {warning}");
        if let Some(kept) = kept() {
            return kept;
        }
    }
    panic!("nothing is kept: {arguments:?}");
}

#[test]
fn a_signal_leaves_the_scenes_of_a_map_of_bands_and_of_a_benchmark() {
    let folder = folder();
    fs::write(folder.join("scene.json"), r#"{ "implant": { "base_radius_mm": 50 } }"#).unwrap();
    let counts = |path: &str| -> Value {
        let text = fs::read(folder.join(path)).unwrap();
        serde_json::from_slice::<Value>(&text).unwrap()["counts"].take()
    };
    let converged = |counts: &Value| counts["converged"].as_u64().filter(|count| *count > 0);

    let arguments = ["map", "scene.json", "--nodes", "129", "--threads", "2", "--out-dir", "map"];
    let of_map = || Some(counts("map/map.json")).filter(|counts| converged(counts).is_some());
    let found = interrupted(&folder, &arguments, of_map);
    let waiting = found["waiting"].as_u64().unwrap();
    assert!(waiting > 0 && waiting + converged(&found).unwrap() <= 400, "{found}");
    let table = fs::read_to_string(folder.join("map/map.csv")).unwrap();
    assert_eq!(table.lines().count(), 401);

    let choices = ["--samples", "16384", "--importance", "0", "--nodes", "129"];
    let arguments = [&["bands", "scene.json", "--out", "bands.json"][..], &choices].concat();
    let found = interrupted(&folder, &arguments, || converged(&counts("bands.json")));
    assert!(found < 16384);

    let of_bench = || {
        let table = fs::read_to_string(folder.join("bench/work_precision.csv")).unwrap();
        Some(table.lines().count()).filter(|lines| *lines > 1)
    };
    interrupted(&folder, &["bench", "--out-dir", "bench"], of_bench);
}

#[test]
fn a_broken_pipe_ends_quietly() {
    let folder = folder();
    fs::write(folder.join("scenes.jsonl"), numbered(100_000)).unwrap();
    let mut child = spawn(&folder, &["simulate", "scenes.jsonl"]);
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut first).unwrap();
    assert!(first.starts_with(r#"{"id":0,"#));
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty());
}

#[test]
fn a_scene_ends_at_its_limit_of_time() {
    let folder = folder();
    let mut scene = json!({ "id": 1, "implant": { "base_radius_mm": 50, "center_mm": [5, 3] } });
    scene["solver"] = json!({ "nodes_per_side": 257, "cells_through": 8 });
    let text = format!("{scene}\n{}\n", with_id(sheet(1), json!(2)));
    let output = run(&folder, &["simulate", "-", "--most-ms", "500", "--threads", "1"], &text);
    assert_eq!(output.status.code(), Some(3));
    let found = lines(&output.stdout);
    assert_eq!(
        (&found[0]["status"], &found[1]["status"]),
        (&json!("not_converged"), &json!("converged"))
    );
    let reason = found[0]["warnings"][0].as_str().unwrap();
    assert_eq!(reason, "The computation ended at its limit of 500 ms.");
    assert!(found[0]["solver"]["time_ms"].as_f64().unwrap() >= 500.0);
    for bad in [&["--most-ms", "0"][..], &["--threads", "0"], &["--threads", "5000"]] {
        let output = run(&folder, &[&["simulate", "-"], bad].concat(), &text);
        assert!(output.status.code() == Some(2) && output.stdout.is_empty());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn the_memory_of_a_stream_does_not_grow_with_its_scenes() {
    const SCENES: usize = 20_000;
    let mut child = spawn(&folder(), &["simulate", "-"]);
    let mut stdin = child.stdin.take().unwrap();
    let writer = thread::spawn(move || {
        for k in 0..SCENES {
            let mut scene = with_id(sheet(k), json!(k));
            if k % 20 == 0 {
                scene["tissue_model"] = json!("layered");
                scene["insertion"] = json!(0.5);
                scene["implant"]["base_radius_mm"] = json!(50);
            }
            writeln!(stdin, "{scene}").unwrap();
        }
    });
    let most_kb = |child: &Child| -> Option<u64> {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
        let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
        line.split_whitespace().nth(1)?.parse().ok()
    };
    let (mut count, mut early, mut most) = (0, 0, 0);
    for line in BufReader::new(child.stdout.take().unwrap()).lines() {
        assert!(line.unwrap().starts_with(&format!("{{\"id\":{count},")));
        count += 1;
        if count % 500 == 0 {
            most = most_kb(&child).unwrap_or(most);
        }
        if count == 5000 {
            early = most;
        }
    }
    writer.join().unwrap();
    assert!(child.wait().unwrap().code().is_some_and(|code| code == 0 || code == 3));
    println!("{count} scenes, {early} kB after 5000, {most} kB at most");
    assert_eq!(count, SCENES);
    assert!(most > 0 && most <= 300_000 && most < early + 20_000, "{early} kB, then {most} kB");
}

#[test]
fn gnu_parallel_gives_each_scene_one_line() {
    let mut child = Command::new("parallel")
        .args(["--will-cite", "--pipe", "-N", "50", "-j", "2", "--line-buffer"])
        .arg(format!(
            "{} simulate - --lines --fields status",
            env!("CARGO_BIN_EXE_implant-preview")
        ))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let writer = thread::spawn(move || stdin.write_all(numbered(400).as_bytes()).unwrap());
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert!(output.status.success());
    let mut ids: Vec<u64> =
        lines(&output.stdout).iter().map(|line| line["id"].as_u64().unwrap()).collect();
    ids.sort_unstable();
    assert_eq!(ids, (0..400).collect::<Vec<_>>());
}

#[test]
fn an_output_destroys_neither_its_input_nor_a_foreign_file() {
    let folder = folder();
    let input = folder.join("in.jsonl");
    fs::write(&input, numbered(2)).unwrap();
    fs::hard_link(&input, folder.join("hard.jsonl")).unwrap();
    std::os::unix::fs::symlink("in.jsonl", folder.join("soft.jsonl")).unwrap();
    let refused = |command: &mut Command, words: &str| {
        let output = command.current_dir(&folder).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && error.contains(words), "{error}");
        assert_eq!(error.lines().count(), 1);
    };
    let simulate = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_implant-preview"));
        command.arg("simulate").args(arguments);
        command
    };
    for out in ["in.jsonl", "hard.jsonl", "soft.jsonl"] {
        refused(&mut simulate(&["in.jsonl", "--out", out]), "is an input scene");
        let stdin = fs::File::open(&input).unwrap();
        refused(simulate(&["-", "--lines", "--out", out]).stdin(stdin), "is an input scene");
    }
    assert_eq!(fs::read_to_string(&input).unwrap(), numbered(2));
    for (content, line) in [("my notes", 1), ("{\"id\":0,\"status\":\"converged\"}\nmy notes\n", 2)]
    {
        fs::write(folder.join("notes"), content).unwrap();
        let words = format!("line {line} is no line of a result");
        refused(&mut simulate(&["in.jsonl", "--out", "notes", "--skip-done", "notes"]), &words);
        assert_eq!(fs::read_to_string(folder.join("notes")).unwrap(), content);
    }
    // Scenes are no results.
    refused(&mut simulate(&["in.jsonl", "--skip-done", "hard.jsonl"]), "line 1 is no line");
    // A beginning of a result goes.
    let begun = "{\"id\":1,\"schema\":\"implant-preview/result/1\",\"status\":\"converged\"}\n{\"id\":0,\"sta";
    fs::write(folder.join("out"), begun).unwrap();
    let output =
        simulate(&["in.jsonl", "--out", "out", "--skip-done", "out", "--fields", "status"])
            .current_dir(&folder)
            .output()
            .unwrap();
    assert!(output.status.success());
    assert!(String::from_utf8(output.stderr).unwrap().contains("1 scenes have a line already"));
    let found = lines(&fs::read(folder.join("out")).unwrap());
    assert_eq!((found.len(), &found[0]["id"], &found[1]["id"]), (2, &json!(1), &json!(0)));
}

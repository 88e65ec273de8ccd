//! Rows as they come: a kill, waiting, memory.

use super::*;

#[test]
fn a_table_goes_on_after_a_kill_with_nothing_lost_and_nothing_twice() {
    // One run with its kill, its end and its repetition.
    const ROWS: usize = 2000;
    let folder = with_template();
    let projection = |k: usize| 10.0 + 0.001 * k as f64;
    // Ids of every kind, and rows without one; one row is bad.
    let id = |k: usize| match k % 4 {
        0 => k.to_string(),
        1 => format!("\"row {k}, \"\"a\"\"\""),
        2 => format!("\"\"\"{k}\"\"\""),
        _ => String::new(),
    };
    let mut table = "id,implant.projection_mm\n,x\n".to_owned();
    table.extend((0..ROWS).map(|k| format!("{},{}\n", id(k), projection(k))));
    fs::write(folder.join("table.csv"), table).unwrap();
    let arguments = ["--template", "scene.json", "--table", "table.csv", "--format", "csv"];
    let arguments =
        [&arguments[..], &["--fields", "implant_volume_ml", "--out", "out.csv"]].concat();
    let out = folder.join("out.csv");
    let mut child = spawn(&folder, &[&arguments[..], &["--unordered"]].concat());
    signal_after(&child, "KILL", &out, 5000);
    child.wait().unwrap();
    // The last row is half written.
    let mut left = fs::read(&out).unwrap();
    left.truncate(left.len() - 5);
    fs::write(&out, &left).unwrap();
    let whole = left.iter().rposition(|byte| *byte == b'\n').unwrap();
    let goes_on = [&arguments[..], &["--skip-done", "out.csv"]].concat();
    let output = run(&folder, &goes_on, "");
    assert!([Some(0), Some(2)].contains(&output.status.code()));
    let text = fs::read(&out).unwrap();
    assert!(text.starts_with(&left[..whole]));
    let found = rows(&text);
    assert_eq!(found.len(), ROWS + 1);
    // The volume of each row is that of its projection: each is there once.
    let mut volumes: Vec<f64> =
        found.iter().filter_map(|row| row["implant_volume_ml"].parse().ok()).collect();
    volumes.sort_by(f64::total_cmp);
    assert_eq!(volumes.len(), ROWS);
    for (k, volume) in volumes.iter().enumerate() {
        let wanted = 2.0 / 3.0 * std::f64::consts::PI * 900.0 * projection(k) / 1000.0;
        assert!((volume / wanted - 1.0).abs() < 1e-12);
    }
    // Everything is done, also for another order of the columns in.
    let note = format!("note: --skip-done: {} scenes have a line already\n", ROWS + 1);
    let turned = fs::read_to_string(folder.join("table.csv")).unwrap();
    let turned: String = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(turned.as_bytes())
        .records()
        .map(|row| {
            let row = row.unwrap();
            format!("{},\"{}\"\n", &row[1], row[0].replace('"', "\"\""))
        })
        .collect();
    fs::write(folder.join("turned.csv"), turned).unwrap();
    let mut other = goes_on.clone();
    other[3] = "turned.csv";
    for arguments in [&goes_on, &other] {
        let again = run(&folder, arguments, "");
        assert!(again.status.success());
        assert_eq!(String::from_utf8(again.stderr).unwrap(), note);
        assert_eq!(fs::read(&out).unwrap(), text);
    }
    // Another template has other scenes, those with an id too.
    fs::write(folder.join("scene.json"), numbered(5).to_string()).unwrap();
    let other = run(
        &folder,
        &[&arguments[..6], &["--fields", "implant_volume_ml", "--skip-done", "out.csv"]].concat(),
        "",
    );
    assert_eq!(rows(&other.stdout).len(), ROWS + 1);
    let note = String::from_utf8(other.stderr).unwrap();
    assert!(note.contains("scenes with a line of their id are other scenes now"), "{note}");
    // A table with other columns, and JSON lines, are refused and stay.
    let fields = ["--fields", "status", "--out", "out.csv", "--skip-done", "out.csv"];
    let line = refusal(&folder, &[&arguments[..6], &fields].concat(), "");
    assert!(
        line.contains(
            "out.csv: --skip-done: the file has other columns; allowed: id,scene_hash,status,error"
        ),
        "{line}"
    );
    assert!(
        refusal(&folder, &[&arguments[..4], &fields].concat(), "").contains("line 1 is no line")
    );
    assert_eq!(fs::read(&out).unwrap(), text);
    // A header that is half written is written again.
    fs::write(&out, "id,scene_h").unwrap();
    assert!(run(&folder, &goes_on, "").status.code().is_some_and(|code| code == 2));
    assert_eq!(rows(&fs::read(&out).unwrap()).len(), ROWS + 1);
    fs::write(&out, "a,b").unwrap();
    assert!(refusal(&folder, &goes_on, "").contains("line 1 is no line of a result"));
    // Rows of another table, without a scene, and of no table.
    let header = text.split_inclusive(|byte| *byte == b'\n').next().unwrap();
    for row in ["\"\"\n", "1,,converged\n", ",,converged,1,\n", ",x,converged,1,\n", "\"a\n"] {
        fs::write(&out, [header, row.as_bytes()].concat()).unwrap();
        let line = refusal(&folder, &goes_on, "");
        assert!(line.contains("line 2 is no line of a result"), "{row}: {line}");
    }
}

#[test]
fn a_row_is_written_before_the_next_one_comes() {
    let folder = with_template();
    let mut child =
        spawn(&folder, &[&TEMPLATE[..], &["--format", "csv", "--fields", "status"]].concat());
    let mut stdin = child.stdin.take().unwrap();
    let mut stdout = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut next = || stdout.next().unwrap().unwrap();
    writeln!(stdin, "id,insertion").unwrap();
    assert_eq!(next(), "id,scene_hash,status,error");
    for k in 0..3 {
        writeln!(stdin, "{k},0.{k}").unwrap();
        let row = next();
        assert!(row.starts_with(&format!("{k},")) && row.ends_with(",converged,"), "{row}");
    }
    drop(stdin);
    assert!(child.wait().unwrap().success());
}

#[cfg(target_os = "linux")]
#[test]
fn the_memory_of_a_table_does_not_grow_with_its_rows() {
    const ROWS: usize = 6000;
    let folder = with_template();
    // Rows of 1 kB: a program that keeps them would grow by 5 MB.
    let note = "x".repeat(1000);
    let arguments = ["--format", "csv", "--fields", "contact_force_n", "--threads", "2"];
    let mut child = spawn(&folder, &[&TEMPLATE[..], &arguments].concat());
    let mut stdin = child.stdin.take().unwrap();
    let writer = thread::spawn(move || {
        writeln!(stdin, "id,implant.projection_mm").unwrap();
        for k in 0..ROWS {
            writeln!(stdin, "{k} {note},{}", 10.0 + 0.001 * k as f64).unwrap();
        }
    });
    let most_kb = |child: &Child| -> Option<u64> {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
        let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
        line.split_whitespace().nth(1)?.parse().ok()
    };
    let (mut count, mut early, mut most) = (0, 0, 0);
    for row in BufReader::new(child.stdout.take().unwrap()).lines().skip(1) {
        assert!(row.unwrap().starts_with(&format!("{count} x")));
        count += 1;
        if count % 100 == 0 {
            most = most_kb(&child).unwrap_or(most);
        }
        if count == ROWS / 3 {
            early = most;
        }
    }
    writer.join().unwrap();
    assert!(child.wait().unwrap().success());
    println!("{count} rows, {early} kB after a third, {most} kB at most");
    assert_eq!(count, ROWS);
    assert!(most > 0 && most <= 100_000 && most < early + 3_000, "{early} kB, then {most} kB");
}

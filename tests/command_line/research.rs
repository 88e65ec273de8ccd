//! The paper's tables, stability, validation, stress and speed.

use super::*;

#[test]
fn tension_writes_the_papers_table() {
    let folder = folder();
    let arguments = [
        "tension",
        "--springs",
        "coupled",
        "--curve",
        "skin",
        "--poisson",
        "0.45",
        "--angle",
        "22.5",
    ];
    let rows = table(&run(&folder, &arguments, ""));
    assert_eq!(rows.len(), 50);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!(
            (row[0].as_str(), row[1].as_str(), row[2].as_str()),
            ("coupled", "skin", "0.45")
        );
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        let expected = 0.02 * (k + 1) as f64;
        assert!((number(5) - expected).abs() < 1e-9 && (number(4) - expected).abs() < 1e-6);
        assert!((number(6) + 0.45 * expected).abs() < 1e-6 && (number(7) - 0.45).abs() < 1e-6);
        assert_eq!(row[8], "converged");
    }
    assert!((rows[19][3].parse::<f64>().unwrap() - 40.0).abs() < 1e-9, "Ef(0.4) of skin is 40 kPa");
}

#[test]
fn tension_leaves_unstable_rows_without_measured_values() {
    let folder = folder();
    for protocol in ["paper", "equilibrium"] {
        let arguments = [
            "tension",
            "--springs",
            "nikolaev",
            "--curve",
            "adipose",
            "--poisson",
            "0.3",
            "--protocol",
            protocol,
        ];
        let output = run(&folder, &arguments, "");
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stderr).starts_with("note: stability is lost at strain 0.1"));
        for row in table(&output) {
            let unstable = row[5].parse::<f64>().unwrap() > 0.151;
            assert_eq!(row[8], if unstable { "unstable" } else { "converged" });
            for column in [4, 6, 7] {
                assert_eq!(row[column].is_empty(), unstable, "{row:?}");
            }
            assert!(!row[3].is_empty());
        }
    }
}

#[test]
fn tension_reads_a_curve_file_and_rejects_invalid_arguments() {
    let folder = folder();
    let curve = r#"{"kind":"points","interpolation":"spline","points":[[0,0],[0.3,2],[1,9]]}"#;
    fs::write(folder.join("my,curve.json"), curve).unwrap();
    fs::write(folder.join("bad.json"), r#"{"kind":"points","points":[[0,0],[0.3,2],[0.2,9]]}"#)
        .unwrap();
    fs::write(folder.join("odd.json"), r#"{"kind":"skin","modulus":3}"#).unwrap();
    let arguments = ["tension", "--curve", "my,curve.json", "--cells", "2", "--out", "t.csv"];
    let output = run(&folder, &arguments, "");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let written = fs::read_to_string(folder.join("t.csv")).unwrap();
    let last = written.lines().last().unwrap();
    assert!(last.starts_with("coupled,\"my,curve.json\",0.3,9,1,1,-0.3,0.3,converged"), "{last}");
    // The preset: 0.40 kPa · (exp(5 ε) − 1) up to strain 0.3.
    let fat = table(&run(&folder, &["tension", "--curve", "fat", "--cells", "2"], ""));
    let number = |row: &[String], k: usize| row[k].parse::<f64>().unwrap();
    let measured: Vec<_> = fat.iter().filter(|row| number(row, 5) < 0.3).collect();
    assert!(measured.len() > 2);
    for row in measured {
        let load = 0.4 * ((5.0 * number(row, 4)).exp() - 1.0);
        assert!((load / number(row, 3) - 1.0).abs() < 1e-6, "{row:?}");
    }
    // The scales of a curve are part of its file: twice the strain at three times the stress.
    let scaled = curve.replace("{\"kind\"", "{\"strain_scale\":0.5,\"stress_scale\":3,\"kind\"");
    fs::write(folder.join("scaled.json"), scaled).unwrap();
    let output = run(&folder, &["tension", "--curve", "scaled.json", "--cells", "2"], "");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    assert!(
        table.lines().any(|row| row.starts_with("coupled,scaled.json,0.3,27,0.5,0.5,-0.15,0.3,"))
    );
    fs::write(folder.join("wide.json"), r#"{"kind":"skin","strain_scale":21}"#).unwrap();
    let refused = |arguments: &[&str], wanted: &[&str]| {
        assert_refused(&folder, arguments, "", wanted);
    };
    refused(
        &["tension", "--curve", "wide.json"],
        &["wide.json", "strain_scale is 21", "0.05 to 20"],
    );
    refused(&["tension", "--curve", "bad.json"], &["bad.json", "points[2]"]);
    refused(&["tension", "--curve", "odd.json"], &["odd.json", "modulus"]);
    refused(&["tension", "--curve", "bone"], &["bone", "skin, fat, adipose"]);
    refused(&["tension", "--poisson", "0.6"], &["--poisson", "0 to 0.5"]);
    refused(&["tension", "--poisson", "NaN"], &["--poisson", "0 to 0.5"]);
    refused(&["tension", "--poisson", "-0.1"], &["--poisson", "0 to 0.5"]);
    refused(&["tension", "--cells", "0"], &["--cells", "1 to 16"]);
    refused(&["tension", "--angle", "400"], &["--angle", "-360 to 360"]);
    refused(&["tension", "--springs", "steel"], &["--springs", "coupled, nikolaev"]);
    refused(&["tension", "--out", "no/t.csv"], &["no/t.csv", "does not exist"]);
}

#[test]
fn charts_draws_four_charts_with_tables_for_both_laws() {
    let folder = folder();
    let output = run(&folder, &["charts", "--out-dir", "made/here"], "");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let made = folder.join("made/here");
    assert_eq!(
        names_in(&made),
        [
            "chart-1-skin-stress.csv",
            "chart-1-skin-stress.svg",
            "chart-2-skin-transverse.csv",
            "chart-2-skin-transverse.svg",
            "chart-3-adipose-stress.csv",
            "chart-3-adipose-stress.svg",
            "chart-4-adipose-transverse.csv",
            "chart-4-adipose-transverse.svg",
            "poisson_error.csv",
            "poisson_error.md",
        ]
    );
    for (chart, words) in [
        ("chart-1-skin-stress", &["skin Ef", "nominal stress (kPa)", "stability lost"][..]),
        ("chart-2-skin-transverse", &["transverse contraction", "0.49", "stability lost"]),
        ("chart-3-adipose-stress", &["adipose Ef", "elongation", "Coupled springs"]),
        ("chart-4-adipose-transverse", &["transverse contraction", "The paper"]),
    ] {
        let picture = fs::read_to_string(made.join(format!("{chart}.svg"))).unwrap();
        assert!(
            picture.starts_with("<svg width=\"1040\" height=\"520\"") && picture.contains("</svg>")
        );
        for word in words {
            assert!(picture.contains(word), "{chart} lacks {word}");
        }
        let rows = fs::read_to_string(made.join(format!("{chart}.csv"))).unwrap();
        assert_eq!(rows.lines().count(), 1 + 2 * 6 * 50, "{chart}");
    }
    let errors = fs::read_to_string(made.join("poisson_error.csv")).unwrap();
    assert_eq!(errors.lines().count(), 1 + 2 * 2 * 6);
    assert!(errors.lines().skip(1).all(|line| line.ends_with(",0.35")));
    fs::write(folder.join("file"), "").unwrap();
    assert_refused(&folder, &["charts", "--out-dir", "file"], "", &["file", "folder"]);
}

#[test]
fn stability_maps_every_curve_and_distinguishes_both_laws() {
    let folder = folder();
    let output = run(&folder, &["stability", "--out-dir", "made/here"], "");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let made = folder.join("made/here");
    let curves = ["adipose", "exponential", "linear", "skin"];
    let mut names = curves.map(|curve| format!("stability-{curve}.svg")).to_vec();
    names.push("stability.csv".to_owned());
    assert_eq!(names_in(&made), names);
    for curve in curves {
        let picture = fs::read_to_string(made.join(format!("stability-{curve}.svg"))).unwrap();
        assert!(picture.starts_with("<svg width=\"1040\"") && picture.contains("</svg>"));
        assert!(picture.len() < 100_000, "{curve}: {} bytes", picture.len());
        for words in [curve, "strain ε", "Poisson ratio ν", "Pulled one way", "Pulled both ways"]
        {
            assert!(picture.contains(words), "{curve} lacks {words}");
        }
        assert!(picture.contains("Coupled springs: stable at every point"), "{curve}");
    }
    let table = fs::read_to_string(made.join("stability.csv")).unwrap();
    let mut lines = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let columns = lines.next().unwrap();
    assert_eq!(
        columns.join(","),
        "springs,curve,load,poisson_ratio,strain,transverse_strain,least_eigenvalue_sheet,\
         least_eigenvalue_waves,wave_x,wave_y,wave_angle_deg,polarisation_deg,\
         least_eigenvalue_out_of_plane,status"
    );
    let rows: Vec<Vec<&str>> = lines.collect();
    assert_eq!(rows.len(), 2 * 4 * 2 * 52 * 101);
    for row in &rows {
        let least: f64 = row[7].parse().unwrap();
        let status = row[13];
        assert!(row.len() == 14 && (row[0] == "nikolaev" || status == "stable"), "{row:?}");
        match status {
            "stable" => assert!(least >= 0.0, "{row:?}"),
            "neutral" => assert!(least.abs() < 1e-9 && row[3] == "0", "{row:?}"),
            // The unstable mode is always the zigzag along the tension.
            _ => assert!(least <= 0.0 && row[8..12] == ["3.1416", "3.1416", "45", "0"], "{row:?}"),
        }
    }
    for (curve, load, nu, strain, wanted) in [
        ("adipose", "uniaxial", "0.3", "0.15", "stable"),
        ("adipose", "uniaxial", "0.3", "0.16", "unstable"),
        ("skin", "uniaxial", "0.45", "0.26", "stable"),
        ("skin", "uniaxial", "0.45", "0.3", "unstable"),
        ("skin", "uniaxial", "0.45", "0.45", "stable"),
        ("skin", "equibiaxial", "0.45", "0.3", "stable"),
        ("linear", "equibiaxial", "0.4", "0.47", "unstable"),
        ("exponential", "uniaxial", "0.5", "1", "stable"),
        ("linear", "uniaxial", "0", "0.5", "neutral"),
    ] {
        let is_here = |row: &&Vec<&str>| row[..5] == ["nikolaev", curve, load, nu, strain];
        let row = rows.iter().find(is_here).unwrap();
        assert_eq!(row[13], wanted, "{row:?}");
    }
    fs::write(folder.join("file"), "").unwrap();
    assert_refused(&folder, &["stability", "--out-dir", "file"], "", &["file", "folder"]);
    assert_refused(&folder, &["stability"], "", &["--out-dir"]);
}

#[test]
fn bench_writes_a_table_and_a_chart() {
    let folder = folder();
    let output = run(&folder, &["bench", "--out-dir", "made/here", "--quick"], "");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let made = folder.join("made/here");
    assert_eq!(names_in(&made), ["work_precision.csv", "work_precision.svg"]);
    let rows = fs::read_to_string(made.join("work_precision.csv")).unwrap();
    assert!(rows.starts_with("method,springs,scene,nodes_per_side,work_units,time_ms,"));
    assert!(rows.lines().all(|line| line.split(',').count() == 9));
    for method in ["newton", "multigrid_1", "multigrid_8"] {
        assert!(rows.contains(&format!("\n{method},coupled,default,17,")), "{method}");
    }
    let picture = fs::read_to_string(made.join("work_precision.svg")).unwrap();
    assert!(picture.starts_with("<svg width=\"1240\"") && picture.contains("</svg>"));
    for words in ["Run time against error", "65 nodes a side", "0.1 %", "full multigrid"] {
        assert!(picture.contains(words), "the picture lacks {words}");
    }
    fs::write(folder.join("file"), "").unwrap();
    assert_refused(&folder, &["bench", "--out-dir", "file"], "", &["file", "folder"]);
    let arguments = ["bench", "--out-dir", "made", "--tissue-model", "jelly"];
    assert_refused(&folder, &arguments, "", &["jelly", "sheet, layered"]);
}

#[test]
fn validate_writes_errors_verification_and_a_table_and_chart_for_every_measurement() {
    let folder = folder();
    let output = run(&folder, &["validate", "--quick", "--out-dir", "out"], "");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let out = folder.join("out");
    let measured = [
        "fat",
        "filling-pressure",
        "hole",
        "implant-in-body",
        "pig-expander",
        "plates",
        "pressure-later",
        "projection",
        "skin-pull",
        "treloar",
    ];
    let of_all =
        ["errors.csv", "errors.md", "opening-plan.md", "verification.csv", "verification.md"];
    let mut expected: Vec<String> = measured
        .iter()
        .flat_map(|name| ["csv", "svg"].map(|ending| format!("measurement-{name}.{ending}")))
        .chain(["measurements.json", "measurements.md"].map(str::to_owned))
        .chain(of_all.map(str::to_owned))
        .collect();
    expected.sort();
    assert_eq!(names_in(&out), expected);
    let read = |name: &str| fs::read_to_string(out.join(name)).unwrap();
    for name in measured {
        let table = read(&format!("measurement-{name}.csv"));
        let is_table = table.lines().all(|line| line.split(',').count() == 10);
        assert!(table.lines().count() > 3 && is_table, "{table}");
        assert!(read(&format!("measurement-{name}.svg")).starts_with("<svg"));
    }
    let all: Value = serde_json::from_str(&read("measurements.json")).unwrap();
    let all = all.as_array().unwrap();
    assert_eq!(all.len(), measured.len());
    for comparison in all {
        let rows = comparison["rows"].as_array().unwrap();
        assert!(rows.iter().any(|row| row["difference"].is_number()), "{}", comparison["name"]);
        assert!(read("measurements.md").contains(comparison["title"].as_str().unwrap()));
    }
    assert!(!read("verification.md").contains("| fail |"));
}

#[test]
fn stress_writes_a_line_for_every_case_of_layered_tissue() {
    let folder = folder();
    let arguments = ["--cases", "4", "--seed", "3", "--most-nodes", "17", "--lines", "cases.jsonl"];
    let arguments = [&["stress", "--tissue-model", "layered"][..], &arguments].concat();
    let output = run(&folder, &arguments, "");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    for population in ["realistic", "extreme"] {
        let of = &summary[population];
        assert_eq!(of["cases"], 2, "{of}");
        assert!(of["max_time_ms"].is_f64() && of["failed"] == 0, "{of}");
    }
    let lines = fs::read_to_string(folder.join("cases.jsonl")).unwrap();
    let cases: Vec<Value> = lines.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!(cases.len(), 4);
    for (k, case) in cases.iter().enumerate() {
        assert_eq!(case["case"], k);
        assert_eq!(case["population"], ["realistic", "extreme"][k % 2]);
        assert_eq!(case["scene"]["tissue_model"], "layered");
    }
}

#[test]
fn stress_counts_equal_outcomes_on_every_run() {
    let folder = folder();
    let arguments = ["stress", "--cases", "20", "--seed", "3", "--most-nodes", "25"];
    let first = run(&folder, &arguments, "");
    assert!(first.status.success(), "{}", text(&first.stderr));
    let summary: Value = serde_json::from_slice(&first.stdout).unwrap();
    let cases = |springs: &str| summary[springs]["cases"].as_u64().unwrap();
    assert_eq!(cases("coupled") + cases("nikolaev"), 20);
    assert_eq!((&summary["failures"], &summary["sessions"]), (&json!([]), &json!(2)));
    let to_file = [&arguments[..], &["--out", "summary.json"]].concat();
    assert!(run(&folder, &to_file, "").status.success());
    assert_eq!(fs::read(folder.join("summary.json")).unwrap(), first.stdout);
    assert_refused(&folder, &["stress", "--most-nodes", "9"], "", &["--most-nodes", "17 to 513"]);
    assert_refused(&folder, &["stress", "--cases", "-1"], "", &["--cases", "1 to 1000000000"]);
    assert_refused(&folder, &["stress", "--seed", "1e3"], "", &["--seed", "0 to"]);
    assert_refused(&folder, &["stress", "--chest"], "", &["--chest", "--tissue-model layered"]);
    assert_refused(&folder, &["stress", "--out", "no/where.json"], "", &["no/where.json", "no"]);
}

//! Curves of raw tensile tests.

use super::*;

/// Runs `curve` on a file of `tests/fixtures/tensile`; the curve and the notes.
fn curve_of(name: &str, more: &[&str]) -> (Value, String) {
    let file = format!("{}/tests/fixtures/tensile/{name}", env!("CARGO_MANIFEST_DIR"));
    let output = run(&folder(), &[&["curve", &file][..], more].concat(), "");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    (serde_json::from_slice(&output.stdout).unwrap(), text(&output.stderr))
}

#[test]
fn curve_writes_the_curve_of_a_raw_test_and_says_what_was_done() {
    for (name, wanted) in [
        ("noisy.csv", "Table: columns by `;`, decimals by comma."),
        ("percent-mpa-unload.csv", "Stress: “Stress [MPa]”, in MPa, by the header."),
        ("true-cycles-rupture.txt", "True strain was converted to engineering strain."),
        ("toe.json", "Slack up to 8 % strain; slope of the curve there: 0.225 kPa."),
        ("offset.json", "The test begins at 2 % strain and 1.5 kPa"),
        ("unload.json", "The loading is 4 of 7 rows"),
        ("dup.json", "Rows with a repeated strain, merged: 1."),
        ("percent.json", "in percent, guessed by the size of the numbers."),
        ("mpa.json", "in MPa, guessed by the size of the numbers."),
    ] {
        let (curve, notes) = curve_of(name, &[]);
        assert!(notes.contains(wanted) && notes.contains("root mean square"), "{name}: {notes}");
        assert!(notes.lines().all(|line| line.starts_with("note: ")), "{notes}");
        assert_eq!((&curve["kind"], &curve["interpolation"]), (&json!("points"), &json!("spline")));
        assert_eq!(curve["points"][0], json!([0.0, 0.0]));
        // A scene takes it.
        let folder = folder();
        let layer = json!([{ "tissue": "skin", "thickness_mm": 1.5, "curve": curve }]);
        let scene = json!({ "implant": { "base_radius_mm": 55 }, "tissue_model": "sheet", "layers": layer, "solver": { "nodes_per_side": 17 } });
        let output = run(&folder, &["simulate", "-", "--fields", "warnings"], &scene.to_string());
        assert!(text(&output.stderr).is_empty(), "{name}: {}", text(&output.stderr));
    }
    let (curve, notes) = curve_of("mpa.json", &["--unit", "kpa", "--strain", "fraction"]);
    assert_eq!(curve["points"], json!([[0.0, 0.0], [0.1, 0.009], [0.3, 0.055]]));
    assert!(notes.contains("in kPa, as asked."), "{notes}");
}

#[test]
fn curve_writes_a_file_and_refuses_in_one_line() {
    let folder = folder();
    fs::write(folder.join("t.csv"), "strain,stress\n0.1,9\n0.3,55\n").unwrap();
    fs::write(folder.join("flat.csv"), "strain,stress\n0.1,9\n0.3,5\n").unwrap();
    let refused =
        |arguments: &[&str], wanted: &[&str]| assert_refused(&folder, arguments, "", wanted);
    refused(&["curve", "flat.csv"], &["flat.csv: the stress does not rise with the strain"]);
    refused(&["curve", "missing.csv"], &["missing.csv", "cannot be read"]);
    refused(&["curve", "t.csv", "--unit", "psi"], &["\"psi\" is no unit; allowed: Pa, kPa, MPa"]);
    refused(&["curve", "t.csv", "--strain", "mm"], &["allowed: fraction, percent"]);
    refused(&["curve", "t.csv", "--out", "t.csv"], &["t.csv: is an input, too"]);
    let output = run(&folder, &["curve", "t.csv", "--unit", "kpa", "--out", "c.json"], "");
    assert!(output.status.success() && output.stdout.is_empty());
    let curve = fs::read_to_string(folder.join("c.json")).unwrap();
    let expected = "{\"kind\":\"points\",\"points\":[[0.0,0.0],[0.1,9.0],[0.3,55.0]],\"interpolation\":\"spline\"}\n";
    assert_eq!(curve, expected);
}

/// What a scene with points of a raw test is answered.
#[test]
fn scenes_with_raw_points_name_the_importer_or_warn() {
    let folder = folder();
    for (name, place) in [("toe", 1), ("offset", 0), ("unload", 4), ("dup", 2), ("percent", 2)] {
        let file = format!("{}/tests/fixtures/tensile/{name}.json", env!("CARGO_MANIFEST_DIR"));
        let wanted = [
            &format!("layers[0].curve: points[{place}] is")[..],
            "a raw tensile test becomes a curve by `implant-preview curve FILE`",
        ];
        assert_refused(&folder, &["simulate", &file], "", &wanted);
    }
    let file = format!("{}/tests/fixtures/tensile/mpa.json", env!("CARGO_MANIFEST_DIR"));
    let output = run(&folder, &["simulate", &file, "--fields", "warnings"], "");
    let warnings = text(&output.stdout);
    assert!(
        warnings.contains("The curve of skin has 0.027 kPa at 20 % strain, more than 30 times softer than every preset: kPa or MPa, fraction or percent?"),
        "{warnings}"
    );
}

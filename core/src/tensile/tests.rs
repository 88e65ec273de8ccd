//! Tables of tests become the curve behind them.

use super::*;
use std::fmt::Write;

fn fixture(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/fixtures/tensile/");
    std::fs::read(format!("{folder}{name}")).unwrap()
}

fn of_file(name: &str) -> Tensile {
    read(&fixture(name), Given::default()).unwrap()
}

fn of_text(text: &str) -> Tensile {
    read(text.as_bytes(), Given::default()).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn refused(text: &str) -> String {
    read(text.as_bytes(), Given::default()).unwrap_err().to_string()
}

/// Numbers of a normal distribution, the same in every run: sums of twelve even ones.
fn noise(mut state: u64) -> impl FnMut() -> f64 {
    let mut even = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    move || (0..12).map(|_| even()).sum::<f64>() - 6.0
}

/// Root mean square and maximum of a curve's error.
fn errors(found: &Tensile, truth: impl Fn(f64) -> f64, end: f64) -> [f64; 2] {
    let curve = Curve::new(&found.spec()).unwrap();
    let strains = (0..=1000).map(|k| end * f64::from(k) / 1000.0);
    let errors: Vec<f64> = strains.map(|e| (curve.stress(e) - truth(e)).abs()).collect();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    [(squares / 1001.0).sqrt(), errors.iter().copied().fold(0.0, f64::max)]
}

fn has(found: &Tensile, sentence: &str) {
    assert!(found.notes.iter().any(|note| note == sentence), "{sentence}: {:#?}", found.notes);
}

/// The curve behind the tables of `tests/fixtures/tensile`.
fn of_fixtures(strain: f64) -> f64 {
    9.0 * (6.0 * strain).exp_m1()
}

/// A curve with its name, the noise of the samples \[kPa\], their number and the greatest errors \[kPa\]: root mean square and maximum.
type Case<'a> = (&'a str, &'a dyn Fn(f64) -> f64, f64, u32, [f64; 2]);

#[test]
fn analytic_curves_are_recovered_from_noise() {
    let skin = Curve::new(&CurveSpec::Skin {}).unwrap();
    let skin = |e: f64| skin.stress(e);
    let slack = |e: f64| 300.0 * (e - 0.2).max(0.0);
    let soft = |e: f64| 0.4 * (7.5 * e).atan();
    let cases: [Case<'_>; 10] = [
        ("fung", &of_fixtures, 1.2, 30, [2.0, 4.0]),
        ("fung", &of_fixtures, 1.2, 1500, [0.3, 1.4]),
        ("fung", &of_fixtures, 0.0, 1500, [0.15, 1.0]),
        ("skin", &skin, 1.0, 100, [0.6, 2.2]),
        ("skin", &skin, 1.0, 1500, [0.15, 0.5]),
        ("skin", &skin, 5.0, 1500, [0.7, 2.0]),
        ("slack", &slack, 1.0, 1500, [0.2, 1.3]),
        ("soft", &soft, 0.01, 1500, [0.002, 0.006]),
        ("soft", &soft, 0.0, 20_000, [0.0004, 0.002]),
        ("line", &|e| 100.0 * e, 1.0, 1500, [0.08, 0.12]),
    ];
    for (name, truth, deviation, count, allowed) in cases {
        for seed in 1..=5 {
            let mut noise = noise(seed);
            let mut text = "strain;stress kPa\n".to_owned();
            for k in 0..count {
                let e = 0.6 * f64::from(k) / f64::from(count - 1);
                writeln!(text, "{e};{}", truth(e) + deviation * noise()).unwrap();
            }
            let found = of_text(&text);
            let [rms, most] = errors(&found, truth, 0.6);
            let points = found.points.len();
            assert!(points <= 40, "{name}: {points} points");
            assert!(
                rms < allowed[0] && most < allowed[1],
                "{name}, {count}, {seed}: {rms} {most}, {points} points"
            );
            // The residual is the noise.
            let rest = (found.rms_kpa / deviation.max(1e-3 * truth(0.6)) - 1.0).abs();
            assert!(count < 1000 || deviation <= 0.0 || rest < 0.07, "{name}: {}", found.rms_kpa);
        }
    }
}

#[test]
fn a_noisy_table_with_decimal_commas_is_read() {
    let found = of_file("noisy.csv");
    assert_eq!(found.form.unwrap().to_string(), "columns by `;`, decimals by comma");
    has(&found, "Strain: “Strain (mm/mm)”, in mm/mm, by the header.");
    has(&found, "Stress: “Stress (kPa)”, in kPa, by the header.");
    assert_eq!((found.notes.len(), found.guessed), (2, Given::default()));
    let [rms, most] = errors(&found, of_fixtures, 0.599);
    assert!(rms < 0.4 && most < 1.2 && found.points.len() <= 20, "{rms} {most}");
    assert!(
        (found.rms_kpa - 1.2).abs() < 0.1
            && found.summary().ends_with(" % of the greatest stress.")
    );
}

#[test]
fn percent_and_mpa_with_an_offset_and_the_unloading_are_read() {
    let found = of_file("percent-mpa-unload.csv");
    has(&found, "Strain: “Strain [%]”, in %, by the header.");
    has(&found, "Stress: “Stress [MPa]”, in MPa, by the header.");
    has(&found, "The loading is 301 of 401 rows; the other rows are unloading, cycles or rest.");
    assert!(found.notes.iter().any(|note| note.starts_with("Stress at the start, subtracted: 0.")));
    let [rms, most] = errors(&found, of_fixtures, 0.5);
    assert!(rms < 0.4 && most < 1.0, "{rms} {most}");
}

#[test]
fn true_values_with_cycles_and_a_rupture_in_utf_16_are_read() {
    let found = of_file("true-cycles-rupture.txt");
    has(&found, "Strain: “Wahre Dehnung [mm/mm]”, in mm/mm, by the header.");
    has(&found, "Stress: “Wahre Spannung [N/mm²]”, in N/mm², by the header.");
    has(&found, "True strain was converted to engineering strain.");
    has(&found, "True stress was converted to nominal stress, of incompressible tissue.");
    has(&found, "The loading is 169 of 405 rows; the other rows are unloading, cycles or rest.");
    has(&found, "The stress falls from 55 % strain on; rows left out there: 19.");
    let [rms, most] = errors(&found, of_fixtures, 0.55);
    assert!(rms < 0.3 && most < 1.0, "{rms} {most}");
}

#[test]
fn points_of_a_scene_are_read() {
    for (name, points, sentence) in [
        (
            "toe.json",
            &[[0.04, 0.009], [0.08, 0.018], [0.18, 3.0], [0.3, 24.0], [0.4, 90.0]][..],
            "Slack up to 8 % strain; slope of the curve there: 0.225 kPa.",
        ),
        (
            "offset.json",
            &[[0.02, 1.5], [0.1, 8.0], [0.3, 50.0]],
            "The test begins at 2 % strain and 1.5 kPa; the curve begins at the origin.",
        ),
        (
            "unload.json",
            &[[0.1, 9.0], [0.2, 26.0], [0.3, 55.0]],
            "The loading is 4 of 7 rows; the other rows are unloading, cycles or rest.",
        ),
        ("dup.json", &[[0.1, 9.0], [0.2, 26.0]], "Rows with a repeated strain, merged: 1."),
        (
            "percent.json",
            &[[0.1, 9.0], [0.2, 26.0], [0.4, 110.0]],
            "Strain: column 1, in percent, guessed by the size of the numbers.",
        ),
        (
            "mpa.json",
            &[[0.1, 9.0], [0.3, 55.0]],
            "Stress: column 2, in MPa, guessed by the size of the numbers.",
        ),
    ] {
        let found = of_file(name);
        has(&found, sentence);
        assert_eq!(found.points.len(), points.len() + 1, "{name}: {:?}", found.points);
        for (found, expected) in found.points[1..].iter().zip(points) {
            let is_near =
                |axis: usize| (found[axis] - expected[axis]).abs() < 1e-12 * expected[axis];
            assert!(is_near(0) && is_near(1), "{name}: {found:?} {expected:?}");
        }
    }
}

#[test]
fn what_is_asked_goes_before_header_and_guess() {
    let given = Given { strain: Some(StrainUnit::Fraction), stress: Some(StressUnit::Kpa) };
    let found = read(&fixture("mpa.json"), given).unwrap();
    assert_eq!((found.points[2], found.guessed), ([0.3, 0.055], Given::default()));
    has(&found, "Stress: column 2, in kPa, as asked.");
    let found = read(b"strain [%],stress [MPa]\n0.1,9\n0.3,55", given).unwrap();
    assert_eq!(found.points[1..], [[0.1, 9.0], [0.3, 55.0]]);
}

#[test]
fn columns_and_units_are_recognised() {
    let expected = [[0.0, 0.0], [0.1, 9.0], [0.3, 55.0]];
    for text in [
        "strain,stress_kPa\n0.1,9\n0.3,55",
        "0.1 9\n0.3   55",
        "0,1 9,0\n0,3 55,0",
        "0.1, 9\n0.3, 55\n",
        "Strain Stress (kPa)\n0.1 9\n0.3 55",
        "Esfuerzo (kPa)\tDeformación (%)\n9\t10\n55\t30",
        "Stress [Pa],Strain rate [1/s],Strain\n9000,2.1,0.1\n55000,2.2,0.3",
        "σ / MPa;ε / %\n0,009;10\n0,055;30",
        "n;[%];[MPa]\n1;10;0,009\n2;30;0,055",
        "10 %\t9000 Pa\n30%\t0.055 MPa",
        "Probe 7;12 mm\nDehnung;Spannung\n%;N/mm²\n10;0,009\n30;0,055",
        "Stretch [-],Stress (kPa)\n1,0\n1.1,9\n1.3,55",
        "True strain,Strain,True stress [kPa],Stress [kPa]\n1,0.1,1,9\n1,0.3,1,55",
        "0.3,55\n0.1,9\n0,0",
        "{\"kind\":\"points\",\"points\":[[0,0],[0.1,9],[0.3,55]]}",
        "[[0,0],[10,9000],[30,55000]]",
    ] {
        let found = of_text(text);
        assert_eq!(found.points.len(), 3, "{text}: {:?}", found.points);
        for (found, expected) in found.points.iter().zip(expected) {
            let is_near = |axis: usize| (found[axis] - expected[axis]).abs() < 1e-9;
            assert!(is_near(0) && is_near(1), "{text}: {found:?} {expected:?}");
        }
    }
    has(
        &of_text("0.1,9\n0.3,x\n0.3,55"),
        "Rows without a strain and a stress, left out: 1; the first: line 2.",
    );
}

#[test]
fn a_curve_far_from_every_preset_is_told() {
    let given = Given { stress: Some(StressUnit::Kpa), ..Given::default() };
    let found = read(b"0.1,0.001\n0.3,0.009", given).unwrap();
    has(
        &found,
        "The curve of tissue has 0.00387 kPa at 20 % strain, more than 30 times softer than every preset: kPa or MPa, fraction or percent?",
    );
    let linear = |modulus_kpa| Curve::new(&CurveSpec::Linear { modulus_kpa }).unwrap();
    let is_unlikely = |modulus, tissue| unlikely(&linear(modulus), tissue).is_some();
    // Skin has 20 kPa at 20 % strain, the softest fat 0.393 kPa.
    for (tissue, least, most) in
        [("skin", 3.33, 3000.0), ("adipose", 0.0655, 3000.0), ("", 0.0655, 3000.0)]
    {
        let found =
            [0.98 * least, 1.02 * least, 0.98 * most, 1.02 * most].map(|m| is_unlikely(m, tissue));
        assert_eq!(found, [true, false, false, true], "{tissue}");
    }
}

#[test]
fn what_is_no_test_is_refused_in_one_line() {
    for (text, start) in [
        ("", "no row has two numbers"),
        ("strain,stress\nx,y", "no row has two numbers"),
        ("0.1,9,1\n0.3,55,2", "no header names strain and stress among 3 columns"),
        ("Extension [mm],Load [N]\n1,2\n2,3", "the column \"Extension [mm]\" is in mm; allowed"),
        ("0.1,9\n0.2,5\n0.3,1", "the stress does not rise with the strain"),
        ("0.1,9\n0.2,9", "the stress does not rise with the strain"),
        ("0.1,-9\n0.3,-55", "the stress does not rise with the strain"),
        ("{\"layers\":[{\"curve\":{\"kind\":\"skin\"}}]}", "0 curves of points"),
        ("{\"points\":[[0,0],[1]]}", "invalid length 1"),
        ("\u{1f}\u{8b}", "no row"),
    ] {
        let line = refused(text);
        assert!(line.starts_with(start) && !line.contains('\n'), "{text:?}: {line}");
    }
    let flat: String =
        (0..400).map(|k| format!("{k},{}\n", if k % 3 == 0 { 2 } else { 1 })).collect();
    assert_eq!(refused(&flat), "the stress does not rise with the strain");
    assert!(
        read(b"\x1f\x8b\x08", Given::default()).unwrap_err().to_string().contains("a gzip file")
    );
}

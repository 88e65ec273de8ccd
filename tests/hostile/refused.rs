//! Hostile texts with the line that rejects each.

use super::*;

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

#[test]
fn hostile_scenes_are_rejected_in_one_line_with_the_field() {
    // A table of inputs.
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
        (with(r#""when":3"#), &["when: is not a text", "a word in quotation marks"]),
        (with(r#""pocket_lowered_mm":41"#), &["pocket_lowered_mm is 41", "0 to 40 mm"]),
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

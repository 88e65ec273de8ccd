//! The command line: the binary, its files, lines and exit codes.
#![cfg(all(feature = "command-line", not(target_arch = "wasm32")))]
#![allow(clippy::unwrap_used)] // helpers of tests are tests

#[path = "common/command.rs"]
mod command;

use command::{folder, lines, run};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Output;

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn names_in(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("the test's folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn scene(radius: f64, springs: &str) -> String {
    format!(
        r#"{{"implant":{{"base_radius_mm":{radius}}},"springs":"{springs}","solver":{{"nodes_per_side":33}}}}"#
    )
}

/// Checks exit code 2, one line that contains all of `wanted`, and no new file.
fn assert_refused(folder: &Path, arguments: &[&str], input: &str, wanted: &[&str]) {
    let before = names_in(folder);
    let output = run(folder, arguments, input);
    let complaint = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {complaint}");
    assert_eq!(complaint.lines().count(), 1, "{arguments:?}: {complaint}");
    for part in wanted {
        assert!(complaint.contains(part), "{arguments:?}: {complaint} lacks {part}");
    }
    assert!(output.stdout.is_empty(), "{arguments:?} wrote to standard output");
    assert_eq!(names_in(folder), before, "{arguments:?} left a file");
}

#[test]
fn simulate_writes_result_mesh_and_profile() {
    let folder = folder();
    fs::write(folder.join("scene.json"), scene(55.0, "coupled")).unwrap();
    for mesh in ["m.stl", "m.obj", "m.ply", "m.glb"] {
        let output = run(
            &folder,
            &["simulate", "scene.json", "--out", "r.json", "--mesh", mesh, "--profile", "p.csv"],
            "",
        );
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(output.stdout.is_empty() && output.stderr.is_empty());
    }
    let result: Value = serde_json::from_slice(&fs::read(folder.join("r.json")).unwrap()).unwrap();
    assert_eq!(result["schema"], "implant-preview/result/1");
    assert_eq!(result["status"], "converged");
    assert!(result["solver"]["time_ms"].as_f64().unwrap() > 0.0);
    let profile = fs::read_to_string(folder.join("p.csv")).unwrap();
    assert_profile(&profile, &result, &["side"]);
    assert_eq!(
        names_in(&folder),
        ["m.glb", "m.obj", "m.ply", "m.stl", "p.csv", "r.json", "scene.json"]
    );
    assert_meshes_agree(&folder);
}

/// Checks the surfaces and directions of a profile file, 41 points each, and that the result has the same numbers.
fn assert_profile(profile: &str, result: &Value, directions: &[&str]) {
    let mut rows = profile.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = ["s_mm", "r_mm", "z_mm", "stretch_meridional", "stretch_hoop"];
    assert_eq!(rows.next().unwrap()[..2], ["surface", "direction"]);
    for (surface, of_result) in [("inner_face", "profile"), ("skin_membrane", "profile_skin")] {
        for &direction in directions {
            for k in 0..41 {
                let row = rows.next().unwrap();
                assert_eq!(row[..2], [surface, direction]);
                let points = match direction {
                    "side" => &result[of_result],
                    "head" => &result[format!("{of_result}_y")],
                    _ => continue,
                };
                for (name, cell) in names.iter().zip(&row[2..]) {
                    let (cell, value): (f64, _) = (cell.parse().unwrap(), &points[k][name]);
                    assert!((cell - value.as_f64().unwrap()).abs() < 1e-7, "{row:?}: {value}");
                }
            }
        }
    }
    assert_eq!(rows.next(), None);
}

#[test]
#[allow(clippy::float_cmp, reason = "mirrored to the last bit")]
fn a_right_breast_has_the_numbers_of_a_left_one_and_its_mesh_mirrored() {
    let folder = folder();
    let shape = |side: &str| {
        let scene = format!(
            r#"{{"side":"{side}","implant":{{"base_radius_mm":55,"projection_mm":40,"center_mm":[6,-3]}},
            "solver":{{"nodes_per_side":33,"tolerance":1e-3}}}}"#
        );
        fs::write(folder.join("scene.json"), scene).unwrap();
        let read = |mesh: &str| {
            let output = run(
                &folder,
                &[
                    "simulate",
                    "scene.json",
                    "--out",
                    "r.json",
                    "--mesh",
                    mesh,
                    "--profile",
                    "p.csv",
                ],
                "",
            );
            assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
            fs::read(folder.join(mesh)).unwrap()
        };
        let (obj, glb) = (text(&read("m.obj")), read("m.glb"));
        let mut result: Value =
            serde_json::from_slice(&fs::read(folder.join("r.json")).unwrap()).unwrap();
        result["solver"]["time_ms"] = Value::Null;
        result["scene_hash"] = Value::Null;
        (obj, glb, result, fs::read(folder.join("p.csv")).unwrap())
    };
    let (left, right) = (shape("left"), shape("right"));
    assert_eq!(left.2, right.2);
    assert_eq!(left.3, right.3);
    let numbers = |obj: &str, kind: &str| -> Vec<[f64; 3]> {
        let rows = obj.lines().filter_map(|line| line.strip_prefix(kind));
        rows.map(|row| {
            let mut row = row.split(' ').map(|cell| cell.parse().unwrap());
            [(); 3].map(|()| row.next().unwrap())
        })
        .collect()
    };
    let vertices = [&left.0, &right.0].map(|obj| numbers(obj, "v "));
    assert!(vertices[0].iter().zip(&vertices[1]).all(|(a, b)| *a == [-b[0], b[1], b[2]]));
    // Six volumes of a closed body: positive where its triangles face outwards.
    let volume = |obj: &str, vertices: &[[f64; 3]]| -> f64 {
        let faces = numbers(obj, "f ");
        let of = |face: &[f64; 3]| {
            let [a, b, c] = face.map(|k| vertices[k as usize - 1]);
            let cross = [1, 2, 0].map(|i| {
                let j = (i + 1) % 3;
                b[i] * c[j] - b[j] * c[i]
            });
            a.iter().zip(cross).map(|(a, n)| a * n).sum::<f64>()
        };
        faces.iter().map(of).sum()
    };
    let volumes = [volume(&left.0, &vertices[0]), volume(&right.0, &vertices[1])];
    assert!(volumes[0] > 0.0 && volumes[0].to_bits() == volumes[1].to_bits(), "{volumes:?}");
    let points = |glb: &[u8]| -> Vec<Vec<[f32; 3]>> {
        let file = gltf::Gltf::from_slice(glb).unwrap();
        let blob = file.blob.as_deref().unwrap();
        let of = |mesh: gltf::Mesh<'_>| {
            let primitive = mesh.primitives().next().unwrap();
            let reader = primitive.reader(|_| Some(blob));
            reader.read_positions().unwrap().chain(reader.read_normals().unwrap()).collect()
        };
        file.meshes().map(of).collect()
    };
    for (a, b) in points(&left.1).concat().iter().zip(points(&right.1).concat()) {
        assert_eq!(*a, [-b[0], b[1], b[2]]);
    }
}

#[test]
fn the_profile_of_a_shape_that_is_not_round_has_both_meridians() {
    let folder = folder();
    let anatomical = r#"{"implant":{"base_radius_mm":55,"projection_mm":40,"base_height_mm":100,
        "apex_shift_mm":12},"solver":{"nodes_per_side":33,"tolerance":1e-3}}"#;
    fs::write(folder.join("scene.json"), anatomical).unwrap();
    let output =
        run(&folder, &["simulate", "scene.json", "--out", "r.json", "--profile", "p.csv"], "");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let result: Value = serde_json::from_slice(&fs::read(folder.join("r.json")).unwrap()).unwrap();
    let profile = fs::read_to_string(folder.join("p.csv")).unwrap();
    assert_profile(&profile, &result, &["side", "midline", "head", "feet"]);
    let end = |direction: &str| -> Vec<f64> {
        let start = format!("inner_face,{direction},");
        let rows = profile.lines().filter_map(|line| line.strip_prefix(&start));
        rows.map(|row| row.split(',').nth(2).unwrap().parse().unwrap()).collect()
    };
    // The apex is towards the feet: the tissue is higher there than towards the head, and as high on both sides.
    assert!(end("feet")[10] > end("head")[10] + 2.0);
    assert!((end("side")[10] - end("midline")[10]).abs() < 1e-3);
}

/// Checks that the formats of the tissue contain the same number of triangles, and the skin's height of the result; that a reader of
/// its own finds three closed bodies in the GLB file.
fn assert_meshes_agree(folder: &Path) {
    let read = |name: &str| fs::read(folder.join(name)).unwrap();
    let number = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().unwrap()) as usize;
    let stl = read("m.stl");
    let count = number(&stl[80..84]);
    assert!(count > 2000 && stl.len() == 84 + 50 * count);
    let obj = text(&read("m.obj"));
    assert_eq!(obj.lines().filter(|line| line.starts_with("f ")).count(), count);
    let ply = read("m.ply");
    let end = b"end_header\n";
    let body = ply.windows(end.len()).position(|w| w == end).unwrap() + end.len();
    let header = text(&ply[..body]);
    assert!(header.contains(&format!("element face {count}\n")));
    let vertices = obj.lines().filter(|line| line.starts_with("v ")).count();
    assert_eq!(ply.len() - body, 12 * vertices + 13 * count);
    let result: Value = serde_json::from_slice(&read("r.json")).unwrap();
    let top = result["skin_projection_mm"].as_f64().unwrap();
    let file = gltf::Gltf::from_slice(&read("m.glb")).unwrap();
    let blob = file.blob.as_deref().unwrap();
    assert_eq!(file.buffers().map(|buffer| buffer.length()).collect::<Vec<_>>(), [blob.len()]);
    let bodies: Vec<_> = file.default_scene().unwrap().nodes().collect();
    let names: Vec<_> = bodies.iter().map(|body| body.name().unwrap()).collect();
    assert_eq!(names, ["implant", "skin", "tissue"]);
    for (body, name) in bodies.iter().zip(names) {
        let primitives: Vec<_> = body.mesh().unwrap().primitives().collect();
        let [primitive] = &primitives[..] else { panic!("{name}: {} parts", primitives.len()) };
        assert_eq!(primitive.material().name(), Some(name));
        let reader = primitive.reader(|_| Some(blob));
        let points: Vec<_> = reader.read_positions().unwrap().collect();
        let normals: Vec<_> = reader.read_normals().unwrap().collect();
        assert_eq!(normals.len(), points.len());
        assert!(normals.iter().all(|n| (n.iter().map(|v| v * v).sum::<f32>() - 1.0).abs() < 1e-5));
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        let edges: BTreeSet<_> =
            indices.chunks(3).flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]).collect();
        assert_eq!(edges.len(), indices.len(), "{name}: an edge runs twice in one direction");
        assert!(edges.iter().all(|&(a, b)| edges.contains(&(b, a))), "{name} is open");
        if name == "skin" {
            let highest = 1000.0 * points.iter().map(|p| f64::from(p[1])).fold(0.0, f64::max);
            assert!((highest - top).abs() < 0.1, "mesh to {highest} mm, skin measured to {top} mm");
        }
    }
}

#[test]
fn a_scene_has_the_tissue_model_it_states_with_and_without_schema() {
    let folder = folder();
    let scene = |fields: &str| {
        format!(r#"{{{fields}"implant":{{"base_radius_mm":40}},"solver":{{"nodes_per_side":33}}}}"#)
    };
    let fields = [
        "",
        r#""schema":"implant-preview/scene/1","#,
        r#""tissue_model":"sheet","#,
        r#""schema":"implant-preview/scene/1","tissue_model":"sheet","#,
    ];
    // A byte-order mark before JSON lines, in standard input as in a file.
    let scenes = format!("\u{feff}{}\n", fields.map(scene).join("\n"));
    fs::write(folder.join("s.jsonl"), &scenes).unwrap();
    fs::write(folder.join("s.json"), &scenes).unwrap();
    for file in ["-", "s.jsonl", "s.json"] {
        let output = run(&folder, &["simulate", file], &scenes);
        assert_eq!(output.status.code(), Some(0), "{file}: {}", text(&output.stderr));
        let results = lines(&output.stdout);
        assert!(results.iter().all(|result| result["schema"] == "implant-preview/result/1"));
        let is_layered = results.iter().map(|result| result["cover_mm"].is_object());
        assert_eq!(is_layered.collect::<Vec<_>>(), [true, true, false, false], "{file}");
        for pair in results.chunks(2) {
            assert_eq!(pair[0]["contact_force_n"], pair[1]["contact_force_n"], "{file}");
        }
    }
    // Another schema is named before a field that only that schema may have.
    let other = scene(r#""schema":"implant-preview/scene/2","weight_kg":70,"#);
    let wanted = ["schema: is \"implant-preview/scene/2\"; allowed: implant-preview/scene/1"];
    assert_refused(&folder, &["simulate", "-"], &other, &wanted);
    // One scene with the mark.
    let one = format!("\u{feff}{}", scene(""));
    assert_eq!(run(&folder, &["simulate", "-"], &one).status.code(), Some(0));
    let papers = scene(r#""springs":"nikolaev","#);
    let wanted = ["standard input", "springs is nikolaev", "tissue_model sheet"];
    assert_refused(&folder, &["simulate", "-"], &papers, &wanted);
}

#[test]
fn tissue_over_a_round_chest_has_force_and_skin_of_independent_elements() {
    let folder = folder();
    let file: Value = serde_json::from_str(include_str!("reference/body.json")).unwrap();
    let cases = file["cases"].as_array().unwrap();
    let meshes: Vec<&Value> = cases.iter().filter(|case| case["name"] == "curved").collect();
    let limit = |name: &str| {
        let [coarse, fine] = [0, 1].map(|k| meshes[k]["result"][name].as_f64().unwrap());
        (4.0 * fine - coarse) / 3.0
    };
    let case = meshes[0];
    let radius = &case["wall"]["radius_mm"];
    let scene = json!({
        "implant": { "base_radius_mm": case["base_radius_mm"],
                     "projection_mm": case["projection_mm"] },
        "pocket_radius_mm": case["pocket_radius_mm"],
        "patch_radius_mm": case["patch_radius_mm"],
        "layers": case["layers"],
        "chest": { "radius_across_mm": radius, "radius_along_mm": radius },
        "solver": { "nodes_per_side": 49 },
    });
    let output = run(&folder, &["simulate", "-"], &scene.to_string());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    for (found, name, tolerance) in [
        (&result["contact_force_n"], "contact_force_n", 0.005),
        (&result["apex_stretch"], "skin_apex_stretch", 0.001),
        (&result["profile_skin"][0]["z_mm"], "apex_skin_mm", 0.001),
        (&result["area_ratio"], "skin_area_ratio_over_pocket", 0.002),
    ] {
        let error = found.as_f64().unwrap() / limit(name) - 1.0;
        assert!(error.abs() < tolerance, "{name}: {found}, {error:+.5}");
    }
    let small = scene.to_string().replace(r#""radius_across_mm":150"#, r#""radius_across_mm":50"#);
    let wanted = ["standard input", "chest.radius_across_mm is 50", "97.5 to 1000000 mm"];
    assert_refused(&folder, &["simulate", "-"], &small, &wanted);
}

#[test]
fn several_scenes_give_json_lines_in_their_order() {
    let folder = folder();
    let radii = [60.0, 30.0, 50.0, 40.0, 20.0];
    let lines: Vec<String> = radii.iter().map(|r| scene(*r, "coupled")).collect();
    fs::write(folder.join("a.json"), scene(25.0, "coupled")).unwrap();
    let output = run(&folder, &["simulate", "a.json", "-"], &lines.join("\n"));
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let volumes: Vec<f64> = text(&output.stdout)
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap())
        .map(|result| result["implant_volume_ml"].as_f64().unwrap())
        .collect();
    let wanted = [25.0, 60.0, 30.0, 50.0, 40.0, 20.0_f64]
        .map(|r| 2.0 / 3.0 * std::f64::consts::PI * r.powi(3) / 1000.0);
    assert_eq!(volumes.len(), wanted.len());
    for (found, wanted) in volumes.iter().zip(wanted) {
        assert!((found / wanted - 1.0).abs() < 1e-12);
    }
}

#[test]
fn simulate_writes_the_fields_asked_for() {
    let folder = folder();
    fs::write(folder.join("scene.json"), scene(55.0, "coupled")).unwrap();
    let result = |arguments: &[&str]| -> Value {
        let output = run(&folder, &[&["simulate", "scene.json"], arguments].concat(), "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let whole = result(&[]);
    let some = result(&["--fields", "contact_force_n,strain.max_principal,layers.max_stress_kpa"]);
    let stress =
        |layer: usize| json!({ "max_stress_kpa": whole["layers"][layer]["max_stress_kpa"] });
    assert_eq!(
        some,
        json!({
            "schema": whole["schema"],
            "status": "converged",
            "contact_force_n": whole["contact_force_n"],
            "strain": { "max_principal": whole["strain"]["max_principal"] },
            "layers": [stress(0), stress(1)],
        })
    );
    let mut short = result(&["--no-profile"]);
    let mut expected = whole.clone();
    for result in [&mut short, &mut expected] {
        result["solver"]["time_ms"] = Value::Null;
        let fields = result.as_object_mut().unwrap();
        let profiles = ["profile", "profile_skin", "profile_y", "profile_skin_y"];
        let removed = profiles.map(|name| fields.remove(name).is_some());
        assert!(removed.iter().all(|is_removed| *is_removed == removed[0]), "{removed:?}");
    }
    assert_eq!(short, expected);
    // The table of the profile does not depend on the fields of the result.
    result(&["--profile", "all.csv"]);
    result(&["--fields", "status", "--no-profile", "--profile", "some.csv"]);
    let table = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(table("some.csv"), table("all.csv"));
    let both = ["simulate", "scene.json", "--fields", "status,profile.z_mm", "--no-profile"];
    assert_refused(&folder, &both, "", &["--no-profile", "--fields", "one of the two"]);
    let unknown = ["simulate", "scene.json", "--fields", "strain.max"];
    assert_refused(&folder, &unknown, "", &["--fields", "strain.max", "max_principal"]);
}

#[test]
fn invalid_scenes_are_rejected_in_one_line_and_nothing_is_written() {
    let folder = folder();
    let put = |name: &str, content: &[u8]| fs::write(folder.join(name), content).unwrap();
    put("small.json", scene(5.0, "coupled").as_bytes());
    put("unknown.json", br#"{"implant":{"base_radius_mm":55,"colour":"blue"}}"#);
    put("broken.json", b"{\"implant\":");
    put("binary.json", &[0xff, 0xfe, 0, 1]);
    put("empty.json", b"");
    put("good.json", scene(55.0, "coupled").as_bytes());
    put("none.jsonl", b"\n");
    for (name, wanted) in [
        ("small.json", &["small.json", "implant.base_radius_mm is 5", "10 to 120 mm"][..]),
        ("unknown.json", &["unknown.json", "colour", "projection_mm"]),
        ("broken.json", &["broken.json", "line 1"]),
        ("binary.json", &["binary.json", "UTF-8"]),
        ("empty.json", &["empty.json"]),
        ("missing.json", &["missing.json"]),
        ("none.jsonl", &["none.jsonl", "is empty"]),
    ] {
        let outputs = ["simulate", name, "--out", "r.json", "--profile", "p.csv"];
        assert_refused(&folder, &outputs, "", wanted);
        // A valid scene beside an invalid scene is not solved either.
        assert_refused(&folder, &["simulate", "good.json", name, "--out", "r.json"], "", wanted);
    }
    assert_refused(&folder, &["simulate", "-"], "[1]", &["standard input"]);
}

#[test]
fn invalid_outputs_are_rejected_before_any_solve() {
    let folder = folder();
    fs::write(folder.join("s.json"), scene(55.0, "coupled")).unwrap();
    fs::write(folder.join("t.json"), scene(45.0, "coupled")).unwrap();
    let refused = |arguments: &[&str], wanted: &[&str]| {
        assert_refused(&folder, arguments, "", wanted);
    };
    refused(&["simulate", "s.json", "--mesh", "m.step"], &["m.step", ".stl"]);
    refused(&["simulate", "s.json", "--mesh", "-"], &[".stl"]);
    refused(&["simulate", "s.json", "--out", "no/r.json"], &["no/r.json", "does not exist"]);
    refused(&["simulate", "s.json", "--out", "."], &["folder"]);
    refused(&["simulate", "s.json", "--out", "s.json"], &["s.json", "another file"]);
    refused(&["simulate", "s.json", "--out", "a", "--profile", "a"], &["two outputs"]);
    refused(&["simulate", "s.json", "t.json", "--mesh", "m.stl"], &["2 scenes", "one scene"]);
    refused(&["simulate"], &["SCENE.json"]);
    refused(&["stretch"], &["stretch"]);
    assert_eq!(fs::read_to_string(folder.join("s.json")).unwrap(), scene(55.0, "coupled"));
}

#[test]
fn springs_without_a_stable_shape_give_exit_code_3_and_a_result_with_its_status() {
    let folder = folder();
    let unstable = r#"{"implant":{"base_radius_mm":55},"springs":"nikolaev","tissue_model":"sheet",
        "solver":{"nodes_per_side":33},"layers":[{"tissue":"adipose","poisson_ratio":0.49,"thickness_mm":10,"curve":{"kind":"adipose"}}]}"#;
    fs::write(folder.join("u.json"), unstable).unwrap();
    let arguments = ["simulate", "u.json", "--out", "r.json", "--mesh", "m.stl"];
    let output = run(&folder, &arguments, "");
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    let result: Value = serde_json::from_slice(&fs::read(folder.join("r.json")).unwrap()).unwrap();
    assert_eq!(result["status"], "unstable");
    assert!(text(&output.stderr).contains("m.stl: not written"));
    assert_eq!(names_in(&folder), ["r.json", "u.json"]);
}

/// The table's rows, split at commas.
fn table(output: &Output) -> Vec<Vec<String>> {
    let text = text(&output.stdout);
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some(
            "springs,curve,poisson_ratio,load_kpa,strain,strain_expected,transverse_strain,poisson_measured,status"
        )
    );
    lines.map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn simulate_derives_absent_fields_from_the_patient_and_lists_them() {
    let folder = folder();
    let scene = |patient: &str| {
        format!(
            r#"{{"implant":{{"base_radius_mm":60,"projection_mm":40}},"solver":{{"nodes_per_side":33}},"patient":{patient}}}"#
        )
    };
    let measured = scene(r#"{"base_width_mm":110,"pinch_mm":20,"skin_class":"tight"}"#);
    let output = run(&folder, &["simulate", "-"], &measured);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let result: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    let values = result["patient_values"].as_array().unwrap();
    let fields: Vec<_> =
        values.iter().map(|v| (v["field"].as_str().unwrap(), &v["value"])).collect();
    assert_eq!(
        fields,
        [
            ("layers[0].thickness_mm", &Value::from(1.5)),
            ("layers[1].thickness_mm", &Value::from(8.5)),
            ("layers[0].curve.strain_scale", &Value::from(0.25)),
        ]
    );
    assert!(values.iter().all(|value| value["set_by_hand"] == false));
    let warnings = result["warnings"].to_string();
    assert!(warnings.contains("12 cm is wider than the breast's base of 11 cm"), "{warnings}");
    let wanted = ["standard input", "patient.pinch_mm", "pinch is 200 mm", "4 to 120 mm"];
    assert_refused(&folder, &["simulate", "-"], &scene(r#"{"pinch_mm":200}"#), &wanted);
}

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

#[test]
fn help_and_version_exit_with_success() {
    let folder = folder();
    for (arguments, wanted) in [
        (&["--help"][..], "simulate"),
        (&["tension", "--help"], "--protocol"),
        (&["--version"], env!("CARGO_PKG_VERSION")),
    ] {
        let output = run(&folder, arguments, "");
        assert_eq!(output.status.code(), Some(0));
        assert!(text(&output.stdout).contains(wanted) && output.stderr.is_empty());
    }
}

#[test]
fn a_map_is_written_as_table_json_and_chart() {
    let folder = folder();
    fs::write(
        folder.join("scene.json"),
        scene(50.0, "coupled").replacen('{', r#"{"tissue_model":"sheet","#, 1),
    )
    .unwrap();
    let map = |out: &str, more: &[&str]| {
        let mut arguments = vec!["map", "scene.json", "--out-dir", out, "--nodes", "17"];
        arguments.extend(more);
        let output = run(&folder, &arguments, "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert_eq!(names_in(&folder.join(out)), ["map.csv", "map.json", "map.svg"]);
        let read = |name: &str| fs::read_to_string(folder.join(out).join(name)).unwrap();
        let json: Value = serde_json::from_str(&read("map.json")).unwrap();
        (json, read("map.csv"), read("map.svg"), text(&output.stderr))
    };
    let axes = ["--x", "base_width_mm=90:130:4", "--y", "projection_mm=25:55:3"];
    let (json, csv, svg, notes) = map("plane", &axes);
    assert_eq!((csv.lines().count(), json["points"].as_array().unwrap().len()), (13, 12));
    assert!(
        csv.starts_with("base_width_mm,projection_mm,status,pocket_radius_mm,greatest_strain,")
    );
    assert_eq!(json["schema"], "implant-preview/map/1");
    assert_eq!(json["check"]["points"], 9);
    assert_eq!(json["axes"][0]["present"], 100.0);
    assert!(notes.contains("checked points converged at 129 nodes per side"), "{notes}");
    assert!(notes.contains("The pocket follows the implant"), "{notes}");
    for words in ["<svg", "base width (mm)", "projection (mm)", "ml", "typical size"] {
        assert!(svg.contains(words), "{words}");
    }
    let curve = ["--x", "insertion=0.2:1:5", "--show", "force_n", "--no-check"];
    let (json, csv, svg, _) = map("curve", &curve);
    assert!(
        csv.lines().count() == 6 && json["check"].is_null() && svg.contains("contact force (N)")
    );
    let forces: Vec<f64> = json["points"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["values"]["force_n"].as_f64().unwrap())
        .collect();
    assert!(forces.windows(2).all(|pair| pair[0] < pair[1]), "{forces:?}");
}

#[test]
fn a_map_with_its_border_in_full_has_the_answers_of_simulate() {
    let folder = folder();
    let scene = |projection: f64| {
        json!({
            "implant": { "base_radius_mm": 52.5, "projection_mm": projection },
            "pocket_radius_mm": 62.5,
            "patient": { "pinch_mm": 20, "skin_class": "normal" },
            "solver": { "nodes_per_side": 65 },
        })
        .to_string()
    };
    fs::write(folder.join("scene.json"), scene(50.0)).unwrap();
    let map = |out: &str, more: &[&str]| {
        let mut arguments = vec!["map", "scene.json", "--out-dir", out, "--no-check", "--x"];
        arguments.push("projection_mm=74:84:6");
        arguments.extend(more);
        let output = run(&folder, &arguments, "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let json = fs::read_to_string(folder.join(out).join("map.json")).unwrap();
        serde_json::from_str::<Value>(&json).unwrap()
    };
    let (quick, full) = (map("quick", &[]), map("full", &["--full-border"]));
    // The border lies where the quick solve of the map has no answer and the full one has.
    let is_border = |i: &usize| {
        quick["points"][i]["status"] == "no_shape" && full["points"][i]["status"] == "converged"
    };
    let border = (0..6).find(is_border).expect("a point that the full solve alone answers");
    assert!(full["notes"].to_string().contains("solved as `simulate` does"), "{}", full["notes"]);
    let projection = full["points"][border]["at"][0].as_f64().unwrap();
    fs::write(folder.join("steep.json"), scene(projection)).unwrap();
    let output = run(&folder, &["simulate", "steep.json"], "");
    let result: Value = serde_json::from_str(&text(&output.stdout)).unwrap();
    let force = |value: &Value| value.as_f64().unwrap();
    let ratio =
        force(&full["points"][border]["values"]["force_n"]) / force(&result["contact_force_n"]);
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
}

#[test]
fn bands_are_equal_for_equal_seeds() {
    let folder = folder();
    let papers = r#"{"tissue_model":"sheet","layers":[{},{"tissue":"adipose","thickness_mm":10,"curve":{"kind":"adipose"}}],"#;
    let scene = scene(50.0, "coupled").replacen('{', papers, 1);
    fs::write(folder.join("scene.json"), scene).unwrap();
    fs::write(
        folder.join("choices.json"),
        r#"{"unknowns":{"projection":null,"pocket_radius":{"normal":{"mean":0,"sd":1}}}}"#,
    )
    .unwrap();
    let bands = |more: &[&str]| -> Value {
        let mut arguments =
            vec!["bands", "scene.json", "--nodes", "17", "--samples", "32", "--importance", "16"];
        arguments.extend(more);
        let output = run(&folder, &arguments, "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(text(&output.stderr).contains("not a prediction for a person."));
        serde_json::from_str(&text(&output.stdout)).unwrap()
    };
    let first = bands(&["--seed", "3"]);
    assert_eq!(first, bands(&["--seed", "3"]));
    assert_ne!(first["bands"], bands(&["--seed", "4"])["bands"]);
    assert_eq!(
        (&first["counts"]["converged"], first["unknowns"].as_array().unwrap().len()),
        (&json!(32), 8)
    );
    let chosen = bands(&["--settings", "choices.json", "--without", "fat_modulus"]);
    let names: Vec<&str> = chosen["unknowns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|u| u["name"].as_str().unwrap())
        .collect();
    assert!(names.len() == 6 && !names.contains(&"projection") && !names.contains(&"fat_modulus"));
}

#[test]
fn bad_maps_and_bands_are_refused_in_one_line() {
    let folder = folder();
    fs::write(folder.join("scene.json"), scene(50.0, "coupled")).unwrap();
    fs::write(folder.join("choices.json"), r#"{"unknowns":{"hair":null}}"#).unwrap();
    let map = |more: &[&'static str], wanted: &[&str]| {
        let arguments = [&["map", "scene.json", "--out-dir", "out"], more].concat();
        assert_refused(&folder, &arguments, "", wanted);
    };
    map(&["--x", "colour=1:2:3"], &["\"colour\" is not a field", "base_width_mm"]);
    map(&["--x", "projection_mm=20:20:5"], &["two different numbers"]);
    map(&["--x", "projection_mm=20:40:0"], &["count is 0", "2 to 3600"]);
    map(&["--x", "projection_mm=20:40:1000000000"], &["a map of 1000000000 points", "3600"]);
    map(&["--x", "projection_mm=20:1e308:5"], &["projection_mm"]);
    map(&["--x", "projection_mm=NaN:40:5"], &["NaN"]);
    map(&["--y", "projection_mm=20:40:5"], &["--x"]);
    map(&["--show", "beauty"], &["\"beauty\" is not a quantity", "greatest_strain"]);
    map(&["--nodes", "5"], &["'5' for '--nodes <N>'", "17 to 1025"]);
    map(&["--nodes", "33.5"], &["'33.5'", "17 to 1025"]);
    let bands = |more: &[&'static str], wanted: &[&str]| {
        let arguments = [&["bands", "scene.json"], more].concat();
        assert_refused(&folder, &arguments, "", wanted);
    };
    bands(&["--samples", "0"], &["'0' for '--samples <N>'", "16 to 16384"]);
    bands(&["--samples", "1e9"], &["'1e9'", "16 to 16384"]);
    bands(&["--nodes", "x"], &["'x'", "17 to 1025"]);
    bands(&["--seed", "-1"], &["0 to 4294967295"]);
    bands(&["--without", "hair"], &["\"hair\" is not an unknown", "skin_thickness"]);
    bands(&["--settings", "choices.json"], &["choices.json: unknowns: ", "hair"]);
    bands(&["--importance", "1000"], &["importance_rows is 1000"]);
    bands(&["--out", "none/b.json"], &["none"]);
    assert_refused(&folder, &["bands", "missing.json"], "", &["missing.json", "cannot be read"]);
}

#[test]
fn the_schema_of_a_result_has_the_fields_of_results() {
    let folder = folder();
    let schema = |of: &str| -> Value {
        let output = run(&folder, &["schema", "--of", of], "");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let titles =
        ["Scene", "Outcome", "MapFile", "MapOptions", "BandsReport", "BandsSettings", "TimesFile"];
    let formats = ["scene", "result", "map", "map-options", "bands", "bands-options", "times"];
    for (format, title) in formats.into_iter().zip(titles) {
        assert_eq!(schema(format)["title"], title);
    }
    let schema = schema("result");
    let [layered, sheet] = ["", r#","tissue_model":"sheet""#].map(|more| {
        let scene = format!(
            r#"{{"implant":{{"base_radius_mm":50}},"solver":{{"nodes_per_side":17}}{more}}}"#
        );
        serde_json::from_str::<Value>(&text(&run(&folder, &["simulate", "-"], &scene).stdout))
            .unwrap()
    });
    let fields = schema["properties"].as_object().unwrap();
    for result in [&layered, &sheet] {
        let known = |field: &String| fields.contains_key(field);
        assert!(result.as_object().unwrap().keys().all(known));
        for field in schema["required"].as_array().unwrap() {
            assert!(result.get(field.as_str().unwrap()).is_some(), "{field}");
        }
    }
    // Fields of layered tissue are not required.
    assert!(layered["cover_mm"].is_object() && sheet.get("cover_mm").is_none());
    let written = run(&folder, &["schema", "--out", "scene.schema.json"], "");
    assert!(written.status.success() && written.stdout.is_empty());
    assert!(fs::read_to_string(folder.join("scene.schema.json")).unwrap().ends_with("}\n"));
    assert_refused(
        &folder,
        &["schema", "--of", "moon"],
        "",
        &["\"moon\" is no format; allowed: scene, result, map"],
    );
    assert_refused(&folder, &["schema", "--out", "none/s.json"], "", &["none"]);
}

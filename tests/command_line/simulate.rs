//! Scenes in, results, meshes, profiles and fields out.

use super::*;

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
    let file: Value = serde_json::from_str(include_str!("../reference/body.json")).unwrap();
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

//! Studies of many scenes: maps and bands.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used)] // helpers of tests are tests
#![allow(clippy::float_cmp, reason = "equal to the last bit")]

#[path = "common/samples.rs"]
mod samples;

use implant_preview::clinical::Measurements;
use implant_preview::clinical::spread::Distribution;
use implant_preview::measure::Status;
use implant_preview::scene::{Field, Scene, TissueModel};
use implant_preview::simulate::simulate;
use implant_preview::study::{
    Axis, Band, Bands, BandsError, BandsSettings, Case, Cases, Job, Map, MapError, MapOptions,
    MapSettings, Parameter, PointStatus, Quantity, Study, Unknown, Values, evaluate, with_values,
};
use std::collections::BTreeMap;

#[path = "study/bands.rs"]
mod bands;

fn sheet() -> Scene {
    Scene::sheet()
}

fn axis(text: &str) -> Axis {
    Axis::parse(text).unwrap()
}

fn coarse() -> MapSettings {
    MapSettings { nodes_per_side: 17, ..MapSettings::default() }
}

fn small(seed: u32) -> BandsSettings {
    let grid = Some(coarse());
    BandsSettings { samples: 32, importance_rows: 16, seed, grid, ..BandsSettings::default() }
}

/// Runs a study to its end with a function of the jobs; returns the number of scenes in the jobs.
fn run_with(
    study: &mut dyn Study,
    store: &mut Cases,
    mut solve: impl FnMut(&Job) -> Vec<Case>,
) -> usize {
    let mut scenes = 0;
    while let Some((index, job)) = study.next_job(store) {
        scenes += job.scenes.len();
        let cases = solve(&job);
        study.receive(index, cases, store);
    }
    assert!(study.is_done());
    scenes
}

fn run(study: &mut dyn Study, store: &mut Cases) -> usize {
    run_with(study, store, evaluate)
}

#[test]
fn a_map_along_a_line_equals_single_solves() {
    for (scene, is_layered) in [(sheet(), false), (Scene::default(), true)] {
        let axes = [axis("projection_mm=25:50:6")];
        let mut map = Map::new(&scene, &axes, MapSettings::default()).unwrap();
        run(&mut map, &mut Cases::default());
        for i in 0..6 {
            let mut alone = scene.clone();
            alone.implant.projection_mm = 25.0 + 5.0 * i as f64;
            alone.solver.nodes_per_side = 33;
            alone.solver.tolerance = 1e-3;
            let outcome = simulate(&alone).unwrap();
            assert_eq!(map.status(i, 0), PointStatus::Converged);
            for quantity in Quantity::ALL {
                assert_eq!(map.value(quantity, i, 0), quantity.of(&outcome), "{quantity:?}");
            }
            assert_eq!(map.value(Quantity::LeastCoverMm, i, 0).is_some(), is_layered);
        }
    }
}

#[test]
fn the_pocket_follows_the_implant_by_its_margin() {
    let mut scene = Scene::default();
    scene.implant.center_mm = [3.0, 4.0];
    let axes = [axis("base_width_mm=90:390:11"), axis("projection_mm=30:60:3")];
    let error = Map::new(&scene, &axes, coarse()).unwrap_err().to_string();
    assert_eq!(error, "base_width_mm = 390: implant.base_radius_mm is 195; allowed: 10 to 120 mm");
    let axes = [axis("base_width_mm=90:240:16"), axis("projection_mm=30:60:3")];
    let map = Map::new(&scene, &axes, coarse()).unwrap();
    assert!(map.pocket_follows() && map.notes().join(" ").contains("The pocket follows"));
    for i in 0..16 {
        let point = map.scene(i, 1).unwrap();
        let width = 90.0 + 10.0 * i as f64;
        assert!((2.0 * point.implant.base_radius_mm - width).abs() < 1e-9);
        assert!((point.pocket_radius_mm - (0.5 * width + 5.0 + 10.0)).abs() < 1e-9);
        let patch = point.body.patch_radius_mm;
        assert!((patch - point.pocket_radius_mm - 60.0).abs() < 1e-9);
    }
    // An axis of the margin sets the margin at every point.
    let axes = [axis("base_width_mm=90:120:2"), axis("pocket_margin_mm=0:20:3")];
    let map = Map::new(&Scene::default(), &axes, coarse()).unwrap();
    assert!((map.scene(1, 2).unwrap().pocket_radius_mm - 80.0).abs() < 1e-9);
    assert!(!map.pocket_follows());
}

#[test]
fn parameters_set_what_their_names_say() {
    let scene = Scene::default();
    let at = |text: &str| {
        let map = Map::new(&scene, &[axis(text)], coarse()).unwrap();
        map.scene(map.axes()[0].count - 1, 0).unwrap()
    };
    assert!((at("volume_ml=200:300:2").implant.projection_mm - 47.348).abs() < 1e-2);
    let pinched = at("pinch_mm=20:40:2");
    assert_eq!([pinched.layers[0].thickness_mm, pinched.layers[1].thickness_mm], [1.5, 18.5]);
    assert!(at("skin_pull_mm=20:30:2").layers[0].curve.strain_scale < 1.0);
    assert_eq!(at("strain_scale=0.5:2:2").layers[0].curve.strain_scale, 2.0);
    assert_eq!(at("layers[1].curve.stress_scale=0.5:2:2").layers[1].curve.stress_scale, 2.0);
    let thick = at("thickness=10:21.5:2");
    assert!((thick.layers[1].thickness_mm - 20.0).abs() < 1e-12);
    assert!(at("poisson_ratio=0.3:0.4:2").layers.iter().all(|layer| layer.poisson_ratio == 0.4));
    assert_eq!(at("attachment.ramp_mm=5:20:2").body.attachment.ramp_mm, 20.0);
    // Projection and volume together give the width.
    let axes = [axis("projection_mm=30:50:2"), axis("volume_ml=200:300:2")];
    let both = Map::new(&scene, &axes, coarse()).unwrap().scene(1, 1).unwrap();
    let volume = Parameter::Volume.value(&both).unwrap();
    assert!((volume - 300.0).abs() < 1e-9 && both.implant.projection_mm == 50.0);
    // A sheet has all parameters of a sheet.
    let map = Map::new(&sheet(), &[axis("strain_scale=0.5:2:2")], coarse()).unwrap();
    assert_eq!(map.scene(0, 0).unwrap().body.tissue_model, TissueModel::Sheet);
    for parameter in ["base_width_mm", "layers[3].thickness_mm", "patch_radius_mm", "insertion"] {
        assert_eq!(Parameter::of_name(parameter).unwrap().name(), parameter);
    }
}

#[test]
fn equal_scenes_are_solved_once() {
    let mut store = Cases::default();
    let mut first = Map::new(&sheet(), &[axis("projection_mm=20:40:5")], coarse()).unwrap();
    assert_eq!(run(&mut first, &mut store), 5);
    // Every second value of the second map lies on the first map.
    let mut second = Map::new(&sheet(), &[axis("projection_mm=20:40:9")], coarse()).unwrap();
    assert_eq!(run(&mut second, &mut store), 4);
    assert_eq!((store.solved(), store.reused(), store.len()), (9, 5, 9));
    for i in 0..5 {
        assert_eq!(first.case(i, 0), second.case(2 * i, 0));
    }
    let mut again = Map::new(&sheet(), &[axis("projection_mm=40:20:9")], coarse()).unwrap();
    assert_eq!(run(&mut again, &mut store), 0);
    assert_eq!(again.case(8, 0), second.case(0, 0));
}

#[test]
fn points_are_solved_from_coarse_to_fine_and_displayed_between_solved_points() {
    let axes = [axis("base_width_mm=90:140:9"), axis("projection_mm=20:50:9")];
    let mut map = Map::new(&sheet(), &axes, coarse()).unwrap();
    let mut store = Cases::default();
    // A linear function of width and projection in place of a solve.
    let fake = |job: &Job| -> Vec<Case> {
        let value = |s: &Scene| 2.0 * s.implant.base_radius_mm + s.implant.projection_mm;
        let values = |s: &Scene| Values::from(BTreeMap::from([(Quantity::ForceN, value(s))]));
        let case =
            |s| Case { status: Some(Status::Converged), values: values(s), ..Case::default() };
        job.scenes.iter().map(case).collect()
    };
    let (index, job) = map.next_job(&mut store).unwrap();
    let corners: Vec<f64> =
        job.scenes[..4].iter().map(|s| 2.0 * s.implant.base_radius_mm).collect();
    assert_eq!(corners, [90.0, 90.0, 140.0, 140.0]);
    let cases = fake(&job);
    map.receive(index, cases, &mut store);
    let mut interpolated = 0;
    for j in 0..9 {
        for i in 0..9 {
            let (value, is_solved) = map.displayed(Quantity::ForceN, i, j).unwrap();
            let wanted = map.axes()[0].value(i) + map.axes()[1].value(j);
            assert!((value - wanted).abs() < 1e-9, "{i} {j}: {value} {wanted}");
            interpolated += usize::from(!is_solved);
        }
    }
    assert_eq!(interpolated, 81 - 10);
    assert!(map.contours(Quantity::ForceN, 150.0).is_empty());
    run_with(&mut map, &mut store, fake);
    let lines = map.contours(Quantity::ForceN, 150.0);
    assert!(lines.len() == 1 && lines[0].iter().all(|(x, y)| (x + y - 150.0).abs() < 1e-9));
}

#[test]
fn points_without_a_converged_shape_have_no_value_and_no_contour() {
    let axes = [axis("base_width_mm=90:140:3"), axis("projection_mm=20:50:3")];
    let mut map = Map::new(&sheet(), &axes, coarse()).unwrap();
    let endings = [Status::NotConverged, Status::Unstable, Status::Converged];
    let mut k = 0;
    run_with(&mut map, &mut Cases::default(), |job| {
        let case = |s: &Scene| {
            k += 1;
            let values = BTreeMap::from([(Quantity::ForceN, s.implant.projection_mm)]);
            let status =
                if s.implant.projection_mm == 35.0 { endings[k % 3] } else { Status::Converged };
            Case { status: Some(status), values: Values::from(values), ..Case::default() }
        };
        job.scenes.iter().map(case).collect()
    });
    let counts: BTreeMap<&str, usize> =
        map.counts().into_iter().map(|(status, count)| (status.word(), count)).collect();
    assert_eq!(counts.values().sum::<usize>(), 9);
    let missing = 9 - counts["converged"];
    assert!(missing > 0);
    let points = (0..3).flat_map(|j| (0..3).map(move |i| (i, j)));
    let without: Vec<_> =
        points.filter(|&(i, j)| map.displayed(Quantity::ForceN, i, j).is_none()).collect();
    assert_eq!(without.len(), missing);
    assert!(without.iter().all(|&(_, j)| j == 1));
    let csv = map.csv();
    assert_eq!(csv.lines().count(), 10);
    assert!(csv.contains("not_converged") || csv.contains("no_shape"));
    assert!(map.notes().join(" ").contains("Points without a value: "));
}

#[test]
fn points_out_of_the_limits_are_marked() {
    // 200 ml on a base of 60 mm are higher than 100 mm; at other corners both values fit.
    let axes = [axis("base_width_mm=60:140:3"), axis("volume_ml=200:400:3")];
    let mut map = Map::new(&sheet(), &axes, coarse()).unwrap();
    run(&mut map, &mut Cases::default());
    let error = map.case(0, 2).unwrap().error.clone().unwrap();
    assert!(error.contains("400 ml on a base of 60 mm gives a projection of"), "{error}");
    assert_eq!(map.status(0, 2), PointStatus::Invalid);
    assert_eq!(map.status(2, 0), PointStatus::Converged);
    let file = serde_json::to_value(map.file(Quantity::GreatestStrain, None)).unwrap();
    assert_eq!(file["points"][6]["status"], "invalid");
    assert!(file["points"][6]["source"].is_null());
    assert_eq!(file["points"][2]["source"], "solved");
    assert!(!file["notes"].to_string().contains("No point has"));
    let void = map.file(Quantity::VoidMl, None);
    assert_eq!(void.notes.last().unwrap(), "No point has a value of void_ml.");
    assert_eq!(file["contours"][0]["level"], 0.25);
}

#[test]
fn a_bad_map_is_one_line() {
    for (x, y, wanted) in [
        (
            "projection_mm=20:20:5",
            "",
            "projection_mm from 20 to 20; allowed: two different numbers",
        ),
        ("projection_mm=NaN:20:5", "", "projection_mm from NaN to 20; allowed"),
        ("projection_mm=20:inf:5", "", "projection_mm from 20 to inf; allowed"),
        ("projection_mm=20:1e308:5", "", "projection_mm = 1"),
        ("projection_mm=-1e308:1e308:5", "", "projection_mm = -1"),
        ("projection_mm=20:40:0", "", "projection_mm: count is 0; allowed: 2 to 3600"),
        ("projection_mm=20:40:1", "", "projection_mm: count is 1; allowed"),
        ("projection_mm=20:40:1000000000", "", "a map of 1000000000 points; allowed: up to 3600"),
        ("projection_mm=20:40:1e9", "", "a map of 1000000000 points; allowed: up to 3600"),
        ("projection_mm=20:40:61", "base_width_mm=90:140:60", "a map of 3660 points"),
        ("projection_mm=20:40:5", "implant.projection_mm=20:40:5", "set the same field"),
        ("base_width_mm=90:140:5", "implant.base_radius_mm=45:70:5", "set the same field"),
        ("layers[5].thickness_mm=1:2:5", "", "the scene has 2 layers"),
        ("attachment.ramp_mm=5:20:2", "", "the scene is a sheet"),
        ("insertion=0:2:3", "", "insertion = 2: insertion is 2; allowed: 0 to 1"),
    ] {
        let axes: Vec<Axis> = [x, y].into_iter().filter(|t| !t.is_empty()).map(axis).collect();
        let error = Map::new(&sheet(), &axes, coarse()).unwrap_err().to_string();
        assert!(error.contains(wanted) && error.len() < 400, "{x} {y}: {error}");
        assert!(!error.contains('\n'));
    }
    for (text, wanted) in [
        ("", "is no axis"),
        ("projection_mm", "is no axis"),
        ("projection_mm=1:2", "is no axis"),
        ("projection_mm=1:2:3:4", "is no axis"),
        ("projection_mm=a:2:3", "is no axis"),
        ("projection_mm=1:2:-3", "\"-3\""),
        ("projection_mm=1:2:1.5", "1.5"),
        ("projektion=1:2:3", "\"projektion\" is not a field; allowed: base_width_mm"),
        ("layers[9].thickness_mm=1:2:3", "is not a field"),
        ("layers[x].thickness_mm=1:2:3", "is not a field"),
    ] {
        let error = Axis::parse(text).unwrap_err().to_string();
        assert!(error.contains(wanted.trim_matches('"')), "{text}: {error}");
    }
    assert_eq!(Map::new(&sheet(), &[], coarse()).unwrap_err(), MapError::Axes(0));
    let settings = MapSettings { nodes_per_side: 5, ..coarse() };
    assert!(Map::new(&sheet(), &[axis("insertion=0:1:3")], settings).is_err());
    let settings = MapSettings { tolerance: f64::NAN, ..coarse() };
    assert!(Map::new(&sheet(), &[axis("insertion=0:1:3")], settings).is_err());
}

#[test]
fn the_check_of_a_map_reports_the_greatest_differences() {
    let axes = [axis("base_width_mm=100:120:4"), axis("projection_mm=30:50:4")];
    let mut map = Map::new(&sheet(), &axes, MapSettings::default()).unwrap();
    let mut store = Cases::default();
    run(&mut map, &mut store);
    let mut check = map.check().unwrap();
    run(&mut check, &mut store);
    assert_eq!(check.counts(), (9, 9));
    let differences = map.differences(&check);
    let of = |wanted| differences.iter().find(|d| d.quantity == wanted).unwrap();
    // The greatest of the checked corner and the other eight points.
    let fine = |i: usize, j: usize| {
        let mut scene = map.scene(i, j).unwrap();
        scene.solver.nodes_per_side = 129;
        scene.solver.tolerance = 1e-4;
        let values = evaluate(&Job { scenes: vec![scene], ..Job::default() })[0].values;
        (values.get(Quantity::ForceN).unwrap() - map.value(Quantity::ForceN, i, j).unwrap()).abs()
    };
    let picked = [0, 1, 3].map(|i| [0, 1, 3].map(|j| fine(i, j)));
    let greatest = picked.into_iter().flatten().fold(0.0, f64::max);
    assert_eq!(of(Quantity::ForceN).difference, greatest);
    assert!(greatest > 0.0 && of(Quantity::ImplantVolumeMl).difference < 1e-9);
    let fine = MapSettings { nodes_per_side: 129, ..MapSettings::default() };
    assert!(Map::new(&sheet(), &axes, fine).unwrap().check().is_none());
}

#[test]
fn a_scene_at_its_limits_has_a_map_and_bands() {
    let mut scene = sheet();
    scene.implant.base_radius_mm = 120.0;
    scene.implant.projection_mm = 120.0;
    scene.pocket_radius_mm = 200.0;
    scene.layers.iter_mut().for_each(|layer| layer.thickness_mm = 0.2);
    let axes = [axis("base_width_mm=20:240:3"), axis("projection_mm=2:120:3")];
    let mut map = Map::new(&scene, &axes, coarse()).unwrap();
    run(&mut map, &mut Cases::default());
    assert_eq!(map.cases().iter().flatten().count(), 9);
    let settings = BandsSettings { samples: 16, importance_rows: 0, ..small(1) };
    let mut bands = Bands::new(&scene, settings).unwrap();
    run(&mut bands, &mut Cases::default());
    let counts = bands.counts();
    assert_eq!(counts.get("invalid"), None, "{counts:?}");
}

#[test]
fn a_plan_whose_quick_solve_has_no_answer_has_that_of_the_full_solve_on_the_map() {
    let mut scene = Scene { chest: None, ..Scene::opening() };
    (scene.implant.base_radius_mm, scene.pocket_radius_mm) = (52.5, 62.5);
    let axis = Axis::parse("projection_mm=74:80:4").unwrap();
    let map = || Map::new(&scene, &[axis], MapSettings::default()).unwrap();
    let solve = |mut map: Map| {
        let mut store = Cases::default();
        while let Some((index, job)) = map.next_job(&mut store) {
            map.receive(index, evaluate(&job), &mut store);
        }
        map
    };
    let (quick, full) = (solve(map()), solve(map().with_full_border()));
    let has_answer = |map: &Map, i: usize| map.status(i, 0) == PointStatus::Converged;
    let gained: Vec<usize> =
        (0..4).filter(|i| has_answer(&full, *i) && !has_answer(&quick, *i)).collect();
    assert!(!gained.is_empty(), "{:?}", quick.counts());
    // The answer is that of the plan.
    let mut plan =
        with_values(&scene, &[(Parameter::of(Field::Projection), axis.value(gained[0]))]).unwrap();
    plan.solver.nodes_per_side = 65;
    let outcome = simulate(&plan).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    let strain = full.value(Quantity::GreatestStrain, gained[0], 0).unwrap();
    assert!((strain - Quantity::GreatestStrain.of(&outcome).unwrap()).abs() < 1e-9);
    // Every point without an answer beside a point with one was solved in full.
    for i in (1..4).filter(|i| !has_answer(&full, *i) && has_answer(&full, i - 1)) {
        assert!(full.is_in_full(i, 0));
    }
}

#[test]
fn a_choice_of_a_study_is_absent_or_a_value() {
    let error = |text: &str| BandsSettings::from_json(text).unwrap_err().to_string();
    assert!(BandsSettings::from_json("{}").is_ok());
    for field in ["grid", "unknowns", "samples"] {
        let error = error(&format!("{{\"{field}\": null}}"));
        assert!(error.starts_with(&format!("{field} is null; allowed: ")), "{error}");
    }
    let kept = BandsSettings::default();
    let text = serde_json::to_string(&kept).unwrap();
    assert_eq!(BandsSettings::from_json(&text), Ok(kept));
    let options = |rest: &str| {
        let x = r#""x": {"field": "base_width_mm", "from": 110, "to": 130, "count": 3}"#;
        serde_json::from_str::<MapOptions>(&format!("{{{x}{rest}}}"))
    };
    assert!(options("").is_ok());
    for field in ["y", "grid", "show"] {
        assert!(options(&format!(", \"{field}\": null")).is_err(), "{field}");
    }
}

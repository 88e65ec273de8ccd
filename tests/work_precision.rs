//! The study of run time against error: properties of its rows.

use implant_preview::scene::Scene;
use implant_preview_lab::axisymmetric_layers::Mound;
use implant_preview_lab::work_precision::{
    Case, Face, Method, Plan, Profile, Row, Status, Study, axisymmetric, run, table, time_to,
};
use serde_json::{Value, json};
use std::time::Instant;

fn rows(plan: &Plan) -> Vec<Row> {
    let start = Instant::now();
    let mut clock = || 1e3 * start.elapsed().as_secs_f64();
    run(plan, None, &mut clock).expect("grids that scenes allow")
}

fn coarse() -> Plan {
    Plan { nodes_per_side: vec![17, 33], repeats: 1, budget_ms: 60_000.0, ..Plan::quick() }
}

#[test]
fn every_method_converges_to_the_same_equilibrium() {
    let rows = rows(&coarse());
    for nodes in [17, 33] {
        let of = |method: Method| -> Vec<Row> {
            let wanted = |row: &&Row| row.method == method && row.nodes_per_side == nodes;
            rows.iter().filter(wanted).copied().collect()
        };
        let newton = of(Method::Newton);
        for (row, tolerance) in newton.iter().zip([1e-3, 1e-5, 1e-7]) {
            assert_eq!(row.status, Status::Finished);
            assert!(row.error_vs_own_grid <= tolerance, "{row:?}");
        }
        let error = |method| of(method)[0].error_vs_own_grid;
        assert!(error(Method::Multigrid8) < error(Method::Multigrid1));
        assert!(error(Method::Multigrid8) < 1e-4);
    }
}

/// Multigrid and Newton's method end at one equilibrium of layered tissue; the skin's error is that of the grid.
#[test]
fn every_method_for_layered_tissue_converges_to_the_same_equilibrium() {
    let plan = Plan {
        cases: vec![Case::LayeredLinear],
        nodes_per_side: vec![33],
        repeats: 1,
        budget_ms: 60_000.0,
        ..Plan::layered_quick()
    };
    let start = Instant::now();
    let mut clock = || 1e3 * start.elapsed().as_secs_f64();
    let rows = run(&plan, Some(axisymmetric), &mut clock).expect("grids that scenes allow");
    let of = |method: Method| -> Vec<Row> {
        rows.iter().filter(|row| row.method == method).copied().collect()
    };
    let automatic = of(Method::Automatic);
    for (row, tolerance) in automatic.iter().zip([1e-2, 1e-3, 1e-4]) {
        assert_eq!(row.status, Status::Finished);
        assert!(row.error_vs_own_grid <= tolerance, "{row:?}");
    }
    let error = |method| of(method)[0].error_vs_own_grid;
    assert!(error(Method::Multigrid8) < error(Method::Multigrid1));
    let newton = of(Method::Newton);
    assert_eq!(newton.len(), 3);
    for (row, tolerance) in newton.iter().zip([1e-3, 1e-5, 1e-7]) {
        assert_eq!(row.status, Status::Finished);
        assert!(row.error_vs_own_grid <= tolerance, "{row:?}");
        let error = row.error_vs_reference.expect("a reference");
        assert!((1e-4..6e-3).contains(&error), "{row:?}");
        assert!(row.inner_error_vs_reference.is_some_and(|error| error < 0.1), "{row:?}");
    }
    let csv = table(&rows);
    assert!(
        csv.starts_with("method,") && csv.contains("error_vs_reference,inner_error_vs_reference,")
    );
    let columns = |line: &str| line.split(',').count();
    assert!(csv.lines().all(|line| columns(line) == 10), "{csv}");
}

#[test]
fn the_layered_reference_returns_both_faces_of_centred_domes() {
    let mut scene = Case::LayeredDefault.scene(33, 1e-4);
    let profile = axisymmetric(&scene, None).expect("a reference");
    let ((r, z), (inner_r, inner_z)) = (profile(Face::Skin, 0.0), profile(Face::Inner, 0.0));
    assert!(r.abs() < 1e-6 && inner_r.abs() < 1e-6 && (inner_z - 55.0).abs() < 1e-3);
    // 6.1 mm of adipose over the apex.
    assert!((z - 61.1).abs() < 0.1, "{z}");
    let (r, z) = profile(Face::Skin, 130.0);
    assert!((r - 130.0).abs() < 1e-6 && (z - 10.0).abs() < 1e-6);
    scene.implant.center_mm = [5.0, 0.0];
    assert!(axisymmetric(&scene, None).is_none());
}

#[test]
fn a_run_out_of_time_is_marked_and_skips_finer_grids() {
    let plan = Plan { methods: vec![Method::Newton], budget_ms: 5.0, ..coarse() };
    // Each reading of this clock takes one millisecond.
    let mut now = 0.0;
    let mut clock = || {
        now += 1.0;
        now
    };
    let rows = run(&plan, None, &mut clock).expect("grids that scenes allow");
    let last = rows.last().expect("rows up to the end of the budget");
    assert_eq!(last.status, Status::Budget);
    assert!(rows.iter().all(|row| row.nodes_per_side == 17));
}

#[test]
fn the_clock_stops_while_errors_are_measured() {
    // The reference serves errors only; its cost is not part of the times.
    let reference = |scene: &Scene, _: Option<Mound>| -> Option<Profile> {
        let scale = scene.pocket_radius_mm;
        Some(Box::new(move |_, s| (s, scale - s)))
    };
    let plan = Plan { methods: vec![Method::Newton], nodes_per_side: vec![17], ..coarse() };
    let mut clock = || 0.0;
    let rows = run(&plan, Some(reference), &mut clock).expect("grids that scenes allow");
    assert!(rows.iter().all(|row| row.error_vs_reference.is_some_and(|error| error > 0.01)));
}

#[test]
fn the_table_has_every_column_in_every_row() {
    let plan = Plan {
        cases: Case::ALL.to_vec(),
        nodes_per_side: vec![17],
        methods: vec![Method::Multigrid2, Method::Newton],
        repeats: 1,
        budget_ms: 10_000.0,
    };
    let rows = rows(&plan);
    assert_eq!(rows.len(), 5 * 4);
    let csv = table(&rows);
    let mut lines = csv.lines();
    let header = "method,springs,scene,nodes_per_side,work_units,time_ms,error_vs_own_grid,error_vs_reference,status";
    assert_eq!(lines.next(), Some(header));
    for (line, row) in lines.zip(&rows) {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), 9, "{line}");
        assert_eq!((fields[0], fields[1]), (row.method.name(), "coupled"));
        assert_eq!((fields[2], fields[8]), (row.scene.name(), "finished"));
        for (field, value) in [(3, 17.0), (4, row.work_units), (6, row.error_vs_own_grid)] {
            let read: f64 = fields[field].parse().expect("a number");
            assert!((read - value).abs() <= 1e-3 * value + 0.005 * f64::from(field == 4));
        }
        assert!(fields[7].is_empty());
    }
}

#[test]
fn a_plan_is_read_from_json_or_rejected_in_one_line() {
    let read = |json: &str| Plan::from_json(json).map_err(|error| error.to_string());
    assert_eq!(read("{}"), Ok(Plan::full()));
    assert_eq!(read(r#"{"quick": true}"#), Ok(Plan::quick()));
    let chosen = r#"{"quick": true, "cases": ["skin-equator"], "nodes_per_side": [66, 17, 65],
        "methods": ["newton", "multigrid_1", "newton"]}"#;
    let expected = Plan {
        cases: vec![Case::SkinEquator],
        nodes_per_side: vec![17, 65],
        methods: vec![Method::Newton, Method::Multigrid1],
        ..Plan::quick()
    };
    assert_eq!(read(chosen), Ok(expected));
    for (json, expected) in [
        ("[]", "options: is a list; allowed: one JSON object"),
        (r#"{"methods": ["magic"]}"#, "methods[0]: unknown variant `magic`; allowed: "),
        (r#"{"nodes_per_side": [17, 5]}"#, "nodes_per_side[1] is 5; allowed: 17 to 1025"),
        (r#"{"cases": []}"#, "cases is an empty list; allowed: one entry or more"),
        (r#"{"speed": 1}"#, "unknown field `speed`"),
    ] {
        let error = read(json).expect_err(json);
        assert!(error.contains(expected) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn a_study_reports_its_progress_and_the_times_to_an_error() {
    let methods = vec![Method::Newton, Method::Multigrid8];
    let plan = Plan { methods, nodes_per_side: vec![17], ..coarse() };
    let mut study = Study::new(plan.clone(), None);
    // Each reading of this clock takes one millisecond.
    let mut now = 0.0;
    let mut clock = || {
        now += 1.0;
        now
    };
    let read = |json: &str| -> Value { serde_json::from_str(json).expect("JSON") };
    let next = json!({"scene": "default", "nodes_per_side": 17, "method": "newton"});
    assert_eq!(read(&study.progress_json()), json!({"done": 0, "all": 2, "next": next}));
    assert_eq!(study.times_json(1e-3), "[]");
    while study.advance(&mut clock).expect("grids that scenes allow") {}
    assert_eq!(read(&study.progress_json()), json!({"done": 2, "all": 2, "next": null}));
    assert_eq!(study.csv(), table(study.rows()));
    let times = study.times_to(1e-3);
    assert_eq!(times.iter().map(|time| time.piece.method).collect::<Vec<_>>(), plan.methods);
    for (time, json) in times.iter().zip(read(&study.times_json(1e-3)).as_array().expect("a list"))
    {
        let rows: Vec<Row> =
            study.rows().iter().filter(|row| time.piece.has(row)).copied().collect();
        assert!(time.time_ms.is_some() && time.time_ms == time_to(&rows, 1e-3), "{time:?}");
        assert_eq!(json["time_ms"].as_f64(), time.time_ms);
        let keys: Vec<&str> =
            json.as_object().expect("an object").keys().map(String::as_str).collect();
        assert_eq!(keys, ["method", "nodes_per_side", "scene", "time_ms"]);
    }
    assert!(study.times_to(1e-30).iter().all(|time| time.time_ms.is_none()));
    assert_eq!(study.case(None).ok(), Some(Case::Default));
    assert_eq!(study.case(Some("skin-equator")).ok(), Some(Case::SkinEquator));
    let error = study.case(Some("moon")).expect_err("an unknown scene").to_string();
    assert!(error.starts_with("scene is \"moon\"; allowed: default, "), "{error}");
}

#[test]
fn names_are_the_same_in_plans_and_tables() {
    for method in Method::ALL.into_iter().chain(Method::LAYERED) {
        assert_eq!(serde_json::to_value(method).ok(), Some(method.name().into()));
    }
    for case in Case::all() {
        assert_eq!(serde_json::to_value(case).ok(), Some(case.name().into()));
    }
}

#[test]
fn the_time_to_an_error_is_when_it_stays_below() {
    let row = |time_ms: f64, error: f64| Row {
        method: Method::Newton,
        springs: Default::default(),
        scene: Case::Default,
        nodes_per_side: 65,
        work_units: time_ms,
        time_ms,
        error_vs_own_grid: error,
        error_vs_reference: None,
        inner_error_vs_reference: None,
        status: Status::Finished,
    };
    let rows = [row(1.0, 0.1), row(2.0, 5e-4), row(3.0, 2e-3), row(4.0, 8e-4), row(5.0, 1e-5)];
    assert_eq!(time_to(&rows, 1e-3), Some(4.0));
    assert_eq!(time_to(&rows, 1e-6), None);
}

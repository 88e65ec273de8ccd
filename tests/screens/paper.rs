//! What is saved of a plan.

use super::*;

#[test]
fn a_result_is_saved_only_with_its_own_scene() {
    let mut harness = app(WIDE, |scene| scene.solver.nodes_per_side = 33);
    let record: serde_json::Value =
        serde_json::from_str(&harness.state().result_json().unwrap()).unwrap();
    let scene = serde_json::to_value(harness.state().session().scene()).unwrap();
    assert_eq!(record["scene"], scene);
    assert_eq!(record["program_version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(record["status"], "converged");
    let date = record["date"].as_str().unwrap();
    assert!(date.len() == 20 && date.ends_with('Z') && date.starts_with("20"), "{date}");
    // Another scene before the end of its solve has no result to save or to read.
    let mut other = harness.state().session().scene().clone();
    other.set_pocket_radius(178.0);
    harness.state_mut().open(other.to_json()).unwrap();
    let app = harness.state();
    assert!(app.session().is_working());
    assert_eq!((app.result_json(), app.outcome()), (None, None));
    assert_eq!(app.summary(), "Updating.");
    settle(&mut harness);
    let record: serde_json::Value =
        serde_json::from_str(&harness.state().result_json().unwrap()).unwrap();
    assert_eq!(record["scene"]["pocket_radius_mm"], 178.0);
    let area = record["area_before_cm2"].as_f64().unwrap();
    assert!((area - 0.01 * std::f64::consts::PI * 178.0 * 178.0).abs() < 1e-9);
}

//! A plan on the table, after a week and after six months.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview_core::clinical::When;
use implant_preview_core::scene::Scene;
use implant_preview_core::study::{AtTime, Case, Cases, Quantity, Study, Times, evaluate};
use serde_json::{Value, json};

fn plan(tension: f64) -> Scene {
    let mut scene = Scene::opening();
    scene.solver.nodes_per_side = 33;
    scene.solver.tolerance = 1e-3;
    scene.body.skin_state.natural_tension_n_per_m = tension;
    scene
}

fn solved(plan: &Scene) -> Times {
    let (mut times, mut store) = (Times::new(plan).unwrap(), Cases::default());
    while let Some((index, job)) = times.next_job(&mut store) {
        times.receive(index, evaluate(&job), &mut store);
    }
    assert_eq!(times.progress(), (7, 7));
    times
}

#[test]
fn pressure_falls_and_the_mound_stays_while_the_skin_relaxes_and_grows() {
    for tension in [0.0, 20.0] {
        let times = solved(&plan(tension));
        let of = |quantity: Quantity| When::ALL.map(|when| times.value(when, quantity).unwrap());
        let [table, week, months] = of(Quantity::MeanPressureMmhg);
        assert_eq!(table.range.map(f64::to_bits), [table.value.to_bits(); 2]);
        for later in [week, months] {
            assert!(later.range[0] < later.value && later.value < later.range[1]);
        }
        assert!(week.range[1] < table.value && months.value < 0.6 * table.value, "{tension}");
        let [before, .., after] = of(Quantity::SkinProjectionMm);
        assert!((after.value - before.value).abs() < 1.5);
        let [before, .., after] = of(Quantity::SkinAreaGain);
        assert!(after.value > before.value);
    }
}

#[test]
fn ranges_leave_out_deviations_without_an_answer() {
    let (mut times, mut store) = (Times::new(&plan(20.0)).unwrap(), Cases::default());
    while let Some((index, job)) = times.next_job(&mut store) {
        // The last one is a deviation after six months.
        let has_answer = times.progress().0 < 6;
        let cases = if has_answer { evaluate(&job) } else { vec![Case::default()] };
        times.receive(index, cases, &mut store);
    }
    assert_eq!(When::ALL.map(|when| times.left_out(when)), [0, 0, 1]);
    let AtTime { value, range: [least, most] } =
        times.value(When::SixMonths, Quantity::ForceN).unwrap();
    assert!(least <= value && value <= most && least < most);
}

#[test]
fn a_plan_that_is_at_a_time_has_the_same_times() {
    let plan = plan(20.0);
    let [own, later] = [&plan, &plan.at(When::SixMonths)].map(solved);
    assert_eq!(own.file(), later.file());
    let file = serde_json::to_value(own.file()).unwrap();
    assert_eq!(file["schema"], "implant-preview/times/1");
    assert_eq!(file["times"][2]["fold_drop_mm"], json!({ "value": 14.0, "deviation": null }));
    assert_eq!(file["times"][1]["grown"], json!({ "value": 0.3, "deviation": 0.2 }));
    assert!(file["times"][0]["values"]["force_n"]["value"].as_f64().unwrap() > 5.0);
    assert!(Times::new(&Scene::sheet()).is_err());
}

#[test]
fn a_file_may_state_the_time_in_place_of_the_numbers() {
    let plan = plan(20.0);
    let mut file: Value = serde_json::from_str(&plan.to_json()).unwrap();
    for when in When::ALL {
        file["when"] = serde_json::to_value(when).unwrap();
        let read = Scene::from_json(&file.to_string()).unwrap();
        assert_eq!(read, plan.at(when));
        assert_eq!((read.when(), plan.when()), (Some(when), Some(When::OnTheTable)));
        assert!(!read.to_json().contains("\"when\""));
    }
    assert_eq!(plan.at(When::OnTheTable), plan);
    file["skin_state"]["grown"] = json!(0.1);
    let error = Scene::from_json(&file.to_string()).unwrap_err().to_string();
    assert_eq!(
        error,
        "when: given with skin_state.relaxed or skin_state.grown; allowed: one of them"
    );
    let mut sheet: Value = serde_json::from_str(&Scene::sheet().to_json()).unwrap();
    sheet["when"] = json!("week");
    assert!(
        Scene::from_json(&sheet.to_string())
            .unwrap_err()
            .to_string()
            .starts_with("skin_state is given")
    );
}

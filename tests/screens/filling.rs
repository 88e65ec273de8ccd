//! The section "Filling" of an expander: curves over the fill, kept while the fill changes.

use super::*;
use implant_preview::scene::Field;
use implant_preview::simulate::simulate;

const WORDS: &str = "the greatest pressure goes from";

/// An expander in a sheet, with its curves and their comparison with the fine grid.
fn filled() -> Harness<'static, App> {
    let mut harness = app(WIDE, |scene| {
        *scene = flat_plan();
        scene.set_tissue_model(TissueModel::Sheet);
        scene.solver.nodes_per_side = 33;
    });
    assert!(harness.query_by_label("Filling").is_none());
    press(&mut harness, "expander");
    wait_for(&mut harness, "A finer computation differs by at most");
    harness
}

/// Runs frames until a label contains these words.
fn wait_for(harness: &mut Harness<'static, App>, words: &str) {
    wait_until(harness, words, |harness| harness.query_by_label_contains(words).map(drop));
}

fn caption(harness: &Harness<'static, App>) -> String {
    harness.get_by_label_contains(WORDS).value().unwrap()
}

#[test]
fn the_ends_of_the_curves_are_single_solves() {
    let harness = filled();
    let pressure = |ml: f64| {
        let mut scene = harness.state().session().scene().clone();
        let radius = scene.implant.base_radius_mm;
        scene.implant.projection_mm = 1500.0 * ml / (std::f64::consts::PI * radius * radius);
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (129, 1e-4);
        simulate(&scene).unwrap().contact_pressure_mmhg.unwrap().max
    };
    let text = caption(&harness);
    let numbers: Vec<f64> = text.split(' ').filter_map(|word| word.parse().ok()).collect();
    let [least, most, low, high] = numbers[..4] else { panic!("{text}") };
    // A tenth and the whole of a half sphere of 12 cm.
    assert_eq!((least, most), (70.0, 450.0));
    assert!(Field::Projection.limits.1 > 60.0);
    for (fill, shown) in [(least, low), (most, high)] {
        // Above 100 mmHg the caption has no number.
        let computed = pressure(fill).min(100.0);
        assert!((shown - computed).abs() <= 0.5 + 0.03 * computed, "{fill} ml: {shown} {computed}");
    }
}

#[test]
fn the_fill_steps_follow_fill_and_schedule_and_are_copied_as_a_table() {
    let mut harness = filled();
    let copied = |harness: &mut Harness<'static, App>| -> Vec<Vec<String>> {
        harness.get_by_role_and_label(Role::Button, "Copy fill steps").click();
        harness.step();
        let commands = harness.output().platform_output.commands.clone();
        let text = commands.into_iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text),
            _ => None,
        });
        let text = text.unwrap();
        text.lines().map(|line| line.split('\t').map(str::to_owned).collect()).collect()
    };
    let rows = copied(&mut harness);
    assert_eq!(rows[0][..4], ["Week", "Visit", "Added (ml)", "Filled (ml)"]);
    assert_eq!(rows[1][..4], ["0", "op.", "100", "100"]);
    assert_eq!(rows[5][..4], ["4", "4", "50", "300"]);
    assert_eq!(rows.len(), 6);
    type_into(&mut harness, "Per visit (ml)", "120");
    type_into(&mut harness, "Weeks between visits", "2");
    type_into(&mut harness, "Fill (ml)", "430");
    let rows = copied(&mut harness);
    let totals: Vec<&str> = rows.iter().skip(1).map(|row| &*row[3]).collect();
    assert_eq!(totals, ["100", "220", "340", "430"]);
    assert_eq!(rows[4][..3], ["6", "3", "90"]);
    // The last row is the plan itself.
    let strain = 100.0 * harness.state().outcome().unwrap().strain.unwrap().max_principal;
    let shown: f64 = rows[4][6].parse().unwrap();
    assert!((shown - strain).abs() < 0.03 * strain + 0.5, "{shown} {strain}");
    assert!(harness.query_by_label("430").is_some(), "the table on the screen");
}

#[test]
fn the_charts_have_numbers_and_the_table_is_whole_on_a_small_desktop() {
    let mut harness = filled();
    // The width of the panels is that of a screen of 1024 points.
    harness.set_size(egui::vec2(1024.0, 2600.0));
    harness.run();
    let left = harness.get_by_label("Force (N)").rect().left();
    let texts: Vec<(String, egui::Rect)> = harness
        .output()
        .shapes
        .iter()
        .filter_map(|shape| match &shape.shape {
            egui::Shape::Text(text) => {
                Some((text.galley.text().to_owned(), text.visual_bounding_rect()))
            }
            _ => None,
        })
        .collect();
    // Beside each of the three charts a number above 0, in the room of the axis.
    for pair in ["Pressure (mmHg)", "Force (N)", "Skin gained (cm²)"] {
        let top = harness.query_all_by_label(pair).next().unwrap().rect().bottom();
        let is_number = |(text, rect): &&(String, egui::Rect)| {
            text.parse::<f64>().is_ok_and(|value| value > 0.0)
                && rect.left() < left + 40.0
                && (top..top + 118.0).contains(&rect.center().y)
        };
        assert!(texts.iter().any(|text| is_number(&text)), "{pair}: no number");
    }
    // The table by week stands above the charts.
    let top = |label: &str| harness.query_all_by_label(label).next().unwrap().rect().top();
    assert!(top("Fill steps by week") < top("Pressure (mmHg)"));
    let last = texts.iter().filter(|(text, _)| text == "Skin\nkept\n(cm²)");
    let last = last.map(|(_, rect)| rect.right()).fold(0.0, f32::max);
    assert!(last > 0.0 && last < 1024.0 - 8.0, "{last}");
}

#[test]
fn the_schedule_of_the_fills_is_kept_in_the_plans_file_and_in_the_history() {
    let mut harness = filled();
    let per_visit = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::SpinButton, "Per visit (ml)").value().unwrap()
    };
    let solves = harness.state().session().counters().solves;
    type_into(&mut harness, "Per visit (ml)", "120");
    type_into(&mut harness, "Weeks between visits", "2");
    let file = harness.state().session().document_json();
    assert!(!harness.state().session().shared_document_json().contains("fill_steps"));
    press(&mut harness, "Undo");
    press(&mut harness, "Undo");
    assert_eq!(per_visit(&harness), "50");
    assert!(harness.state().session().scene().visit.is_none());
    harness.state_mut().open(file).unwrap();
    settle(&mut harness);
    assert_eq!(per_visit(&harness), "120");
    let steps = harness.state().session().scene().visit.clone().unwrap().fill_steps.unwrap();
    assert_eq!((steps.start_ml, steps.visit_ml, steps.weeks), (100.0, 120.0, 2.0));
    assert_eq!(harness.state().session().counters().solves, solves, "a solve for words");
}

#[test]
fn another_fill_keeps_the_curves_and_another_base_renews_them() {
    let mut harness = filled();
    let before = caption(&harness);
    type_into(&mut harness, "Fill (ml)", "250");
    harness.step();
    assert_eq!(caption(&harness), before);
    type_into(&mut harness, "Width (cm)", "11");
    harness.step();
    assert!(harness.query_by_label_contains(WORDS).is_none(), "the curves of another base");
    wait_for(&mut harness, "A finer computation differs by at most");
    assert_ne!(caption(&harness), before);
    press(&mut harness, "round");
    assert!(harness.query_by_label("Filling").is_none());
}

/// Numbers between the title of the first chart and a line below the charts.
fn numbers_beside_charts(harness: &Harness<'static, App>, below: &str) -> Vec<String> {
    let title = harness.get_by_label("Pressure (mmHg)").rect();
    let place = title.union(harness.get_by_label_contains(below).rect());
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) => Some((text.galley.text(), text.visual_bounding_rect())),
        _ => None,
    });
    let numbers =
        texts.filter(|(text, rect)| text.parse::<f64>().is_ok() && place.contains_rect(*rect));
    numbers.map(|(text, _)| text.to_owned()).collect()
}

#[test]
fn a_chart_without_values_has_no_numbers_beside_it() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    harness.get_by_role_and_label(Role::Button, "expander").click();
    harness.step();
    harness.step();
    assert_eq!(numbers_beside_charts(&harness, " fills computed"), [""; 0]);
    harness.get_by_label("Fill steps by week (provisional, being computed)");
    wait_for(&mut harness, WORDS);
    assert!(numbers_beside_charts(&harness, WORDS).len() > 10);
}

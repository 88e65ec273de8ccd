//! Anatomical implants: from the scene to the result.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::clinical::{Dimension, Size};
use implant_preview::measure::Outcome;
use implant_preview::scene::{Field, Repair, Scene};
use implant_preview::simulate::simulate;
use implant_preview::study::{Parameter, with_values};
use serde_json::{Value, json};

fn read(file: &Value) -> Scene {
    Scene::from_json(&file.to_string()).unwrap()
}

/// The scene of a base and an apex, on a coarse grid.
fn scene(radius: f64, height: f64, shift: f64) -> Value {
    json!({
        "implant": { "base_radius_mm": radius, "projection_mm": 40, "base_height_mm": height,
                     "apex_shift_mm": shift },
        "pocket_radius_mm": 75,
        "layers": [{}, { "tissue": "adipose", "thickness_mm": 12, "poisson_ratio": 0.49,
                         "curve": { "kind": "fat" } }],
        "solver": { "nodes_per_side": 65 },
    })
}

fn solve(file: &Value) -> Outcome {
    simulate(&read(file)).unwrap()
}

#[test]
fn only_an_anatomical_shape_is_written() {
    let tall = read(&scene(55.0, 126.0, 12.5));
    assert_eq!((tall.implant.base_height(), tall.implant.apex_shift_mm), (126.0, 12.5));
    assert_eq!(read(&serde_json::from_str(&tall.to_json()).unwrap()), tall);
    let round = read(&scene(55.0, 110.0, 0.0));
    let text = round.to_json();
    assert!(round.implant.is_round() && !text.contains("base_height") && !text.contains("apex"));
    let mut file = scene(55.0, 110.0, 0.0);
    let implant = file["implant"].as_object_mut().unwrap();
    implant.remove("base_height_mm");
    implant.remove("apex_shift_mm");
    assert_eq!(read(&file), round);
    let mut set = round.clone();
    set.implant.base_height_mm = Some(110.0);
    assert!(set.to_json() == text && set.same_physics(&round) && !set.same_physics(&tall));
    assert_eq!(set.problem().unwrap().obstacle, round.problem().unwrap().obstacle);
}

#[test]
fn invalid_shapes_are_refused_in_one_line() {
    let of = |radius, height, shift| {
        Scene::from_json(&scene(radius, height, shift).to_string()).unwrap_err().to_string()
    };
    for (found, expected) in [
        (of(55.0, 54.0, 0.0), "implant.base_height_mm is 54; allowed: 55 to 220 mm"),
        (of(70.0, 250.0, 0.0), "implant.base_height_mm is 250; allowed: 70 to 240 mm"),
        (of(55.0, 120.0, 37.0), "implant.apex_shift_mm is 37; allowed: -36 to 36 mm"),
        (
            of(60.0, 156.0, 0.0),
            "pocket_radius_mm is 75; allowed: 78 (half of the base + distance of the implant's centre) to 200 mm",
        ),
    ] {
        assert!(found.starts_with(expected), "{found}");
    }
}

#[test]
fn sizes_keep_the_proportions_and_the_pocket_holds_the_base() {
    let base = read(&scene(55.0, 132.0, 11.0));
    let volume = base.implant.size().unwrap().volume_ml();
    let dome = base.problem().unwrap().obstacle.dome;
    assert!((volume - dome.volume() / 1000.0).abs() < 1e-9);
    assert!((volume - 2e-3 / 3.0 * std::f64::consts::PI * 55.0 * 66.0 * 40.0).abs() < 1e-9);
    let wide = with_values(&base, &[(Parameter::BaseWidth, 120.0)]).unwrap();
    assert!((wide.implant.base_height() - 144.0).abs() < 1e-12);
    assert!((wide.implant.apex_shift_mm - 12.0).abs() < 1e-12);
    assert!((wide.pocket_radius_mm - 72.0 - (75.0 - 66.0)).abs() < 1e-9);
    for more in [vec![], vec![(Parameter::of(Field::Projection), 45.0)]] {
        let values: Vec<_> = more.into_iter().chain([(Parameter::Volume, 300.0)]).collect();
        let found = with_values(&base, &values).unwrap();
        assert!((found.implant.size().unwrap().volume_ml() - 300.0).abs() < 1e-9);
        let aspect = found.implant.base_height() / found.implant.base_radius_mm;
        assert!((aspect - 2.4).abs() < 1e-12);
    }
    let values = [(Parameter::of(Field::BaseHeight), 150.0), (Parameter::BaseWidth, 130.0)];
    let set = with_values(&base, &values).unwrap();
    assert!((set.implant.base_height() - 150.0).abs() < 1e-12);
    let mut tall = base;
    tall.implant.base_height_mm = Some(160.0);
    assert_eq!(tall.repair(), Some(Repair::PocketWidened { radius_mm: 80.0 }));
    tall.implant.apex_shift_mm = 60.0;
    tall.repair();
    assert!(tall.validate().is_ok() && (tall.implant.apex_shift_mm - 48.0).abs() < 1e-12);
}

#[test]
fn a_height_keeps_all_but_the_dimension_that_follows() {
    let size = Size::of_width_and_projection(120.0, 40.0).unwrap().with_aspect(0.9);
    // ⅔πabp of the half-axes 60 and 54.
    let volume = 2e-3 / 3.0 * std::f64::consts::PI * 60.0 * 54.0 * 40.0;
    assert!((size.volume_ml() - volume).abs() < 1e-9);
    for (follows, width, projection, expected) in [
        (Dimension::Volume, 120.0, 40.0, volume * 150.0 / 108.0),
        (Dimension::Projection, 120.0, 40.0 * 108.0 / 150.0, volume),
        (Dimension::BaseWidth, 120.0 * 108.0 / 150.0, 40.0, volume),
    ] {
        let tall = size.with_base_height(150.0, follows).unwrap();
        let found = [tall.base_width_mm(), tall.base_height_mm(), tall.projection_mm()];
        for (found, expected) in found.into_iter().zip([width, 150.0, projection]) {
            assert!((found - expected).abs() < 1e-9, "{follows:?}: {found} {expected}");
        }
        assert!((tall.volume_ml() - expected).abs() < 1e-9, "{follows:?}");
    }
    // 0.1 of the height: the projection would be 400 mm, the width 1200 mm.
    let errors = [Dimension::Projection, Dimension::BaseWidth]
        .map(|follows| size.with_base_height(10.8, follows).unwrap_err().to_string());
    assert!(errors.iter().all(|error| error.contains("allowed")), "{errors:?}");
}

#[test]
fn a_turned_base_turns_the_result_and_a_lower_apex_is_found() {
    let (across, along) = (solve(&scene(60.0, 104.0, 0.0)), solve(&scene(52.0, 120.0, 0.0)));
    let force = |outcome: &Outcome| outcome.contact_force_n.unwrap();
    assert!((force(&across) / force(&along) - 1.0).abs() < 1e-3);
    assert!(along.contact_angle_deg.is_none() && along.contact_material_radius_mm.is_none());
    let shifted = solve(&scene(52.0, 120.0, 18.0));
    assert!((shifted.implant_volume_ml - along.implant_volume_ml).abs() < 1e-9);
    let cover = shifted.cover_mm.unwrap();
    assert!(cover.apex > 6.0 && force(&shifted) > 1.01 * force(&along), "{cover:?}");
    // The apex stands where the implant is shifted to: the profile along x, through the centre, is lower.
    let height = |outcome: &Outcome| outcome.profile[0].z_mm;
    assert!(height(&along) > 39.9 && height(&shifted) < height(&along) - 0.5);
}

/// A scan's chest and thickness, an anatomical implant off centre: every part of the body at once.
/// The skin over the apex, between the nodes, is a place of the skin, too.
#[test]
fn the_least_cover_is_at_most_that_over_the_apex_and_independent_of_the_grid() {
    for (center, height, shift) in [([4.1, -3.3], 110.0, 0.0), ([0.0, 0.0], 126.0, 12.5)] {
        let least = [33, 65, 129].map(|nodes| {
            let mut file = scene(55.0, height, shift);
            file["implant"]["center_mm"] = json!(center);
            file["solver"]["nodes_per_side"] = json!(nodes);
            let cover = solve(&file).cover_mm.unwrap();
            assert!(cover.least <= cover.apex, "{cover:?}");
            cover.least
        });
        println!("{least:?}");
        let [coarse, middle, fine] = least.map(|cover| cover / least[2] - 1.0);
        assert!(coarse.abs() < 0.04 && middle.abs() < 0.01 && fine == 0.0, "{least:?}");
    }
}

#[test]
fn an_anatomical_implant_over_a_scan_is_solved_and_an_even_field_changes_nothing() {
    let grid = |of: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        let at = |k: u32| 4.0 * (f64::from(k) - 34.0);
        (0..69 * 69).map(|k| of(at(k % 69), at(k / 69))).collect()
    };
    let mut file = scene(52.0, 120.0, 15.0);
    file["implant"]["center_mm"] = json!([4, 0]);
    file["chest"] = json!({ "grid": { "spacing_mm": 4, "columns": 69, "rows": 69,
        "heights_mm": grid(&|x, y| -x * x / 300.0 - y * y / 1500.0 + 0.06 * x + (0.02 * y).sin()) } });
    let even = solve(&file);
    assert_eq!(serde_json::to_value(&even).unwrap()["status"], "converged");
    assert!(even.warnings.iter().any(|line| line.contains("tilted by 4°")), "{:?}", even.warnings);
    let mut field = json!({ "spacing_mm": 4, "columns": 69, "rows": 69,
                            "factors": grid(&|_, _| 1.0) });
    file["thickness_field"] = field.clone();
    let one = solve(&file);
    assert_eq!(one.contact_force_n, even.contact_force_n);
    assert_eq!((one.profile[0], one.profile_skin[7]), (even.profile[0], even.profile_skin[7]));
    field["factors"] = json!(grid(&|x, y| 1.0 + 0.9 * (-(x * x + y * y) / 2000.0).exp()));
    file["thickness_field"] = field;
    let thick = solve(&file);
    assert_eq!(serde_json::to_value(&thick).unwrap()["status"], "converged");
    let cover = |outcome: &Outcome| outcome.cover_mm.unwrap().apex;
    assert!(cover(&thick) > 1.4 * cover(&even), "{} {}", cover(&thick), cover(&even));
    for (member, value, expected) in [
        ("spacing_mm", json!(0.1), "thickness_field.spacing_mm is 0.1; allowed: 0.5 to 50 mm"),
        ("columns", json!(3), "thickness_field.columns is 3; allowed: 4 to 257"),
        ("rows", json!(68), "thickness_field.factors is a list of 4761; allowed: 4692 numbers"),
        ("factors", json!([null]), "thickness_field.factors[0] is null; allowed: a number"),
        (
            "factors",
            json!(grid(&|x, _| x)),
            "thickness_field.factors[0] is -136; allowed: 0.05 to 20",
        ),
        (
            "factors",
            json!(grid(&|x, _| if x < 0.0 { 20.0 } else { 0.05 })),
            "thickness_field.factors is as low as -",
        ),
        ("spacing_mm", json!(3), "thickness_field is 204 mm wide; allowed: 264 mm or more"),
    ] {
        let mut broken = file.clone();
        broken["thickness_field"][member] = value;
        let error = Scene::from_json(&broken.to_string()).unwrap_err().to_string();
        assert!(error.starts_with(expected) && !error.contains('\n'), "{error}");
    }
    let mut hollow = file.clone();
    hollow["chest"] = json!({ "radius_across_mm": -110 });
    hollow["thickness_field"]["factors"] = json!(grid(&|_, _| 10.0));
    let error = Scene::from_json(&hollow.to_string()).unwrap_err().to_string();
    let expected = "thickness_field.factors is as high as 10; allowed: ";
    assert!(error.starts_with(expected) && error.contains("in a hollow of 110 mm"), "{error}");
    file["tissue_model"] = json!("sheet");
    file.as_object_mut().unwrap().remove("chest");
    let error = Scene::from_json(&file.to_string()).unwrap_err().to_string();
    assert!(error.starts_with("thickness_field is given; allowed: in layered tissue"), "{error}");
}

/// A corner of the scan without data: the continued wall is nearly that of the whole scan.
#[test]
fn a_scan_with_a_corner_blanked_is_solved_as_the_whole_one_with_a_warning() {
    let at = |k: u32| 4.0 * (f64::from(k) - 34.0);
    let places: Vec<[f64; 2]> = (0..69 * 69).map(|k| [at(k % 69), at(k / 69)]).collect();
    let wall = |[x, y]: &[f64; 2]| -x * x / 300.0 - y * y / 1500.0 + 0.06 * x + (0.02 * y).sin();
    let mut file = scene(52.0, 120.0, 15.0);
    file["chest"] = json!({ "grid": { "spacing_mm": 4, "columns": 69, "rows": 69,
        "heights_mm": places.iter().map(wall).collect::<Vec<_>>() } });
    let whole = solve(&file);
    let heights = file["chest"]["grid"]["heights_mm"].as_array_mut().unwrap();
    for (height, [x, y]) in heights.iter_mut().zip(&places) {
        if x + y > 105.0 {
            *height = Value::Null;
        }
    }
    let blanked = solve(&file);
    let force = |outcome: &Outcome| outcome.contact_force_n.unwrap();
    let apart = (force(&blanked) / force(&whole) - 1.0).abs();
    assert!(apart > 0.0 && apart < 5e-3, "{apart}");
    let said = blanked.warnings.iter().find(|line| line.contains("are continued over ")).unwrap();
    assert!(!whole.warnings.contains(said), "{said}");
    let share = said.split("over ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    // A segment beyond 74.2 mm of a disc of 118 to 130 mm, over which the tissue stands: 12.8 to 15.7 % of it.
    let share: f64 = share.parse().unwrap();
    assert!((12.8..15.7).contains(&share), "{said}");
}

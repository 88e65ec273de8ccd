//! Hostile input: every input is either valid or rejected with one short line, in short time and little memory.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use dhat::{HeapStats, Profiler};
use implant_preview::clinical::PracticeTable;
use implant_preview::curve::{Curve, CurveSpec, Interpolation};
use implant_preview::measure::Status;
use implant_preview::scene::pins::{PINS_SCHEMA, pins_from_json, pins_json};
use implant_preview::scene::{CheckedScene, Document, Scene, SceneError, read};
use implant_preview::simulate::simulate;
use implant_preview::study::{Axis, Bands, BandsSettings, Map, MapSettings};
use implant_preview::table::{Form, Table};
use implant_preview_lab::work_precision::Plan;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::sync::Mutex;
use std::time::{Duration, Instant};

#[path = "common/hostile.rs"]
mod hostile;
use hostile::choices::Choices;

#[path = "hostile/refused.rs"]
mod refused;
#[path = "hostile/tables.rs"]
mod tables;

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

/// One test at a time: the profiler counts the allocations of the whole process.
static ALONE: Mutex<()> = Mutex::new(());

const SOON: Duration = Duration::from_secs(1);
/// Greatest memory of a reader besides the input \[bytes\].
const LITTLE: usize = 64_000_000;

/// Random bytes, mostly few.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    vec(any::<u8>(), 0..200)
}

fn check<S: Strategy>(cases: u32, inputs: &S, test: impl Fn(S::Value)) {
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let result = TestRunner::new_with_rng(config, fixed()).run(inputs, |input| {
        test(input);
        Ok(())
    });
    if let Err(error) = result {
        panic!("{error}");
    }
}

/// Equal inputs on every run and every machine.
fn fixed() -> proptest::test_runner::TestRng {
    proptest::test_runner::TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha)
}

#[test]
fn curves_of_any_numbers_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    check(20_000, &bytes(), |bytes| {
        let is_accepted = hostile::check_spec(&Choices(&bytes).curve());
        accepted.set(accepted.get() + i32::from(is_accepted));
    });
    assert!(accepted.get() > 8000, "{accepted:?} are too few to say much");
}

#[test]
fn scenes_of_any_numbers_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    check(8000, &bytes(), |bytes| {
        let read = Scene::from_json(&Choices(&bytes).scene());
        hostile::check_scene(&read);
        accepted.set(accepted.get() + i32::from(read.is_ok()));
    });
    assert!(accepted.get() > 400, "{accepted:?} are too few to say much");
}

#[test]
fn layered_scenes_of_any_numbers_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new([0; 2]);
    check(8000, &bytes(), |bytes| {
        let read = Scene::from_json(&Choices(&bytes).layered_scene());
        hostile::check_scene(&read);
        if let Ok(scene) = read {
            let mut counts = accepted.get();
            counts[usize::from(scene.is_layered())] += 1;
            accepted.set(counts);
        }
    });
    let [sheets, layered] = accepted.get();
    assert!(sheets > 50 && layered > 200, "{accepted:?} are too few to say much");
}

#[test]
fn scenes_with_a_chest_of_any_radii_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new([0; 2]);
    check(8000, &bytes(), |bytes| {
        let read = Scene::from_json(&Choices(&bytes).chest_scene());
        hostile::check_scene(&read);
        if let Ok(Some(chest)) = read.map(|scene| scene.chest) {
            let mut counts = accepted.get();
            counts[usize::from(chest.radius_across_mm < 0.0)] += 1;
            accepted.set(counts);
        }
    });
    let [outwards, hollow] = accepted.get();
    assert!(outwards > 50 && hollow > 5, "{accepted:?} are too few to say much");
}

#[test]
fn scenes_with_anatomical_implants_and_scans_of_any_numbers_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new([0; 4]);
    check(8000, &bytes(), |bytes| {
        let read = Scene::from_json(&Choices(&bytes).scanned_scene());
        hostile::check_scene(&read);
        if let Ok(scene) = read {
            let heights = scene.chest_grid.iter().flat_map(|chest| &*chest.grid.heights_mm);
            let is = [
                !scene.implant.is_round(),
                scene.chest_grid.is_some(),
                scene.thickness_field.is_some(),
                heights.into_iter().any(Option::is_none),
            ];
            let counts = accepted.get();
            accepted.set([0, 1, 2, 3].map(|k| counts[k] + i32::from(is[k])));
        }
    });
    assert!(accepted.get().into_iter().all(|count| count > 5), "{accepted:?} are too few");
}

#[test]
fn pins_of_any_scenes_are_valid_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    let scene = r#"{"implant":{"base_radius_mm":50}}"#;
    check(4000, &(bytes(), vec(any::<u8>(), 0..6)), |(bytes, pins)| {
        let mut choices = Choices(&bytes);
        let pin = |kind: u8| {
            let scene = match kind % 4 {
                0 => choices.scene(),
                1 => choices.layered_scene(),
                _ => scene.to_owned(),
            };
            let name = ["", "before", "\\n", "💧"][usize::from(kind / 4 % 4)];
            let letter = ["\"A\"", "\"B\"", "\"D\"", "null", "\"E\""][usize::from(kind / 16 % 5)];
            format!(r#"{{"letter":{letter},"name":"{name}","scene":{scene}}}"#)
        };
        let pins: Vec<String> = pins.into_iter().map(pin).collect();
        let list = format!(r#"{{"schema":"{PINS_SCHEMA}","pins":[{}]}}"#, pins.join(","));
        match pins_from_json(&list) {
            Ok(pins) => {
                assert_eq!(pins_from_json(&pins_json(&pins)), Ok(pins));
                accepted.set(accepted.get() + 1);
            }
            Err(error) => hostile::check_message(&error),
        }
        let file = format!(r#"{{"implant":{{"base_radius_mm":50}},"pins":[{}]}}"#, pins.join(","));
        let read = Document::from_json(&file);
        assert_eq!(read.is_ok(), pins_from_json(&list).is_ok());
        assert_eq!(read.is_ok(), Scene::from_json(&file).is_ok());
    });
    assert!(accepted.get() > 400, "{accepted:?} are too few to say much");
}

#[test]
fn broken_texts_are_valid_or_rejected() {
    let place = any::<prop::sample::Index>;
    let edits = vec((place(), place(), any::<u8>(), 0_u8..4), 1..5);
    check(12_000, &(bytes(), edits), |(bytes, edits)| {
        let mut choices = Choices(&bytes);
        let curve = serde_json::to_string(&choices.curve()).unwrap();
        let mut text = format!("{}\r\n{}", choices.scene(), choices.layered_scene()).into_bytes();
        for (at, from, byte, kind) in edits {
            let (at, from) = (at.index(text.len()), from.index(text.len()));
            match kind {
                0 => text[at] = byte,
                1 => text.insert(at, byte),
                2 => text.truncate(at.max(1)),
                _ => text = [&text[..at], &text[from..]].concat(),
            }
            if text.is_empty() {
                return;
            }
        }
        hostile::check_lines(&text);
        let cut = text.len().min(curve.len());
        hostile::check_curve_file(&[&curve.as_bytes()[..cut / 2], &text[cut / 2..]].concat());
    });
}

#[test]
fn surfaces_in_scenes_are_read_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    let shapes = (3_u8..40, 0_u8..6, vec(any::<u8>(), 0..600));
    check(300, &shapes, |(count, kind, rest)| {
        let bytes: Vec<u8> = [count, kind].into_iter().chain(rest).collect();
        accepted.set(accepted.get() + i32::from(hostile::check_kept_surface(&bytes)));
    });
    assert!(accepted.get() > 30, "{accepted:?} are too few to say much");
}

#[test]
fn any_bytes_are_rejected() {
    check(10_000, &vec(any::<u8>(), 0..100), |bytes| {
        hostile::check_lines(&bytes);
        hostile::check_curve_file(&bytes);
        hostile::check_tensile(&bytes);
    });
}

/// Every accepted scene is solved or has the status of a failed solve, with finite numbers.
#[test]
fn the_solve_of_every_accepted_scene_ends() {
    let counts = std::cell::RefCell::new([0_u32; 3]);
    check(4000, &vec(any::<u8>(), 20..200), |bytes| {
        let Ok(mut scene) = Scene::from_json(&Choices(&bytes).scene()) else { return };
        if counts.borrow().iter().sum::<u32>() >= 150 {
            return;
        }
        scene.solver.nodes_per_side = 17;
        scene.solver.tolerance = scene.solver.tolerance.max(1e-5);
        let json = scene.to_json();
        let start = Instant::now();
        let outcome = simulate(&scene).unwrap();
        let time = start.elapsed();
        assert!(time < 5 * SOON, "{time:?} for {json}");
        counts.borrow_mut()[outcome.status as usize] += 1;
        if outcome.status == Status::Converged {
            assert!(outcome.area_ratio.is_some_and(|ratio| ratio > 0.999), "{json}");
            let error = outcome.solver.estimated_position_error;
            assert!(error.is_some_and(|error| error <= scene.solver.tolerance), "{json}");
            assert!(!format!("{outcome:?}").contains("inf"), "{json}");
        }
        assert!(!format!("{outcome:?}").contains("NaN"), "{json}");
    });
    println!("converged, not converged, unstable: {counts:?}");
    assert!(counts.borrow()[0] > 100, "{counts:?}");
}

/// The same of layered tissue; the solids of every solution are closed meshes.
#[test]
fn the_solve_of_every_accepted_layered_scene_ends() {
    let counts = std::cell::RefCell::new([0_u32; 3]);
    check(4000, &vec(any::<u8>(), 20..200), |bytes| {
        let Ok(mut scene) = Scene::from_json(&Choices(&bytes).layered_scene()) else { return };
        if !scene.is_layered() || counts.borrow().iter().sum::<u32>() >= 50 {
            return;
        }
        scene.solver.nodes_per_side = 17;
        scene.solver.tolerance = scene.solver.tolerance.max(1e-4);
        let json = scene.to_json();
        let start = Instant::now();
        let outcome = simulate(&scene).unwrap();
        let time = start.elapsed();
        // The second attempt of eight cells through the thickness: seconds without optimisation.
        assert!(time < 20 * SOON, "{time:?} for {json}");
        counts.borrow_mut()[outcome.status as usize] += 1;
        if outcome.status == Status::Converged {
            let error = outcome.solver.estimated_position_error;
            assert!(error.is_some_and(|error| error <= scene.solver.tolerance), "{json}");
            assert!(!format!("{outcome:?}").contains("inf"), "{json}");
        }
        assert!(!format!("{outcome:?}").contains("NaN"), "{json}");
        hostile::check_first_solve(serde_json::to_string(&scene).unwrap().as_bytes());
    });
    println!("layered, converged, not converged, unstable: {counts:?}");
    assert!(counts.borrow()[0] > 10, "{counts:?}");
}

#[test]
fn axes_and_choices_of_bands_of_any_text_are_valid_or_rejected() {
    let scene = Scene::sheet();
    let axis = "(projection_mm|volume_ml|insertion|layers\\[[0-9]\\].thickness_mm|[ -~]{0,9})=\
                [-+.0-9einfNa]{0,9}:[-+.0-9e]{0,9}:[-0-9]{0,12}";
    check(4000, &axis, |text| {
        let map = Axis::parse(&text).and_then(|axis| {
            let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
            Map::new(&scene, &[axis], settings)
        });
        if let Err(error) = map {
            let line = error.to_string();
            assert!(line.len() < 1000 && !line.contains('\n'), "{line}");
        }
    });
    let number = "-?[0-9]{1,3}(e[0-9]{1,3})?";
    let choices = (number, number, number).prop_map(|(samples, median, gsd)| {
        format!(
            r#"{{"samples":{samples},"unknowns":{{"fat_modulus":{{"log_normal":{{"median":{median},"gsd":{gsd}}}}}}}}}"#
        )
    });
    check(2000, &choices, |text| {
        let line = match BandsSettings::from_json(&text) {
            Ok(choices) => Bands::new(&scene, choices).err().map(|error| error.to_string()),
            Err(error) => Some(error.to_string()),
        };
        assert!(line.is_none_or(|line| line.len() < 400 && !line.contains('\n')));
    });
    check(2000, &vec(any::<u8>(), 0..60), |bytes| {
        let text = String::from_utf8_lossy(&bytes);
        if let Err(error) = BandsSettings::from_json(&text) {
            assert!(!error.to_string().contains('\n'));
        }
    });
}

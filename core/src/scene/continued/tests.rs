use super::*;
use crate::scene::{ChestGrid, HeightsGrid, Scene};

const HALF: f64 = 130.0;

fn chest(at: DVec2) -> f64 {
    Chest::Curved { across_mm: 150.0, along_mm: 400.0 }.height(at)
}

/// A scene with heights 5 mm apart, within a half width \[mm\].
fn scene(half_mm: f64, height: impl Fn(DVec2) -> Option<f64>) -> Scene {
    spaced(5.0, half_mm, height)
}

fn spaced(spacing_mm: f64, half_mm: f64, height: impl Fn(DVec2) -> Option<f64>) -> Scene {
    let half = half_mm / spacing_mm;
    let side = 2 * half as usize + 1;
    let place =
        |k: usize| DVec2::new((k % side) as f64 - half, (k / side) as f64 - half) * spacing_mm;
    let heights_mm = (0..side * side).map(|k| height(place(k))).collect();
    let grid = HeightsGrid { spacing_mm, columns: side, rows: side, heights_mm, smooth_mm: 0.0 };
    Scene { chest_grid: Some(ChestGrid { grid }), ..Scene::default() }
}

fn corner(at: DVec2) -> bool {
    at.x + at.y > 100.0
}

fn wall(scene: &Scene) -> Chest {
    scene.problem().unwrap().obstacle.wall.0
}

fn line(scene: &Scene) -> String {
    let line = scene.validate().unwrap_err().to_string();
    assert!(!line.contains('\n') && line.len() < 160, "{line}");
    line
}

fn places() -> impl Iterator<Item = DVec2> {
    (0..600).map(|k| DVec2::from_angle(2.4 * f64::from(k)) * (f64::from(k) / 600.0).sqrt() * 110.0)
}

#[test]
fn a_blanked_corner_is_nearly_the_wall_that_was_there_and_data_stay() {
    let blanked = scene(HALF, |at| (!corner(at)).then(|| chest(at)));
    let (found, exact) = (wall(&blanked), wall(&scene(HALF, |at| Some(chest(at)))));
    let mut most: f64 = 0.0;
    for place in places() {
        let apart = (found.height(place) - exact.height(place)).abs();
        if corner(place + 10.0) {
            most = most.max(apart);
        } else {
            assert!(apart < 1e-2, "{place} {apart}");
        }
    }
    assert!(most < 4.0, "{most}");
    assert_eq!(Scene::from_json(&blanked.to_json()), Ok(blanked.clone()));
    let [said] = &*blanked.chest_warnings(&found) else { panic!("one line") };
    let start = "The heights of the chest are continued over ";
    assert!(said.starts_with(start), "{said}");
    assert!(said.ends_with(" % of the tissue and 0.0 % of the pocket, where the grid has none."));
    let share: f64 = said[start.len()..].split(' ').next().unwrap().parse().unwrap();
    assert!((10.0..18.0).contains(&share), "{share}");
}

#[test]
fn nothing_is_said_of_gaps_beyond_the_tissue() {
    let blanked = scene(HALF, |at| (at.length() < 145.0).then(|| chest(at)));
    assert!(blanked.patch_radius() < 140.0);
    assert_eq!(blanked.chest_warnings(&wall(&blanked)), [""; 0]);
}

/// Data that end on a slope towards the plane of the rest, and with a step.
#[test]
fn a_blend_is_as_long_as_it_must_be_to_make_no_hollow() {
    let ramp = |at: DVec2| chest(at) - 0.2 * (at.x - 60.0).max(0.0);
    for height in [&ramp as &dyn Fn(DVec2) -> f64, &|at| {
        chest(at) - 4.0 * (-(at.x - 85.0).powi(2) / 900.0).exp()
    }] {
        let blanked = scene(HALF, |at| (at.x < 82.0).then(|| height(at)));
        let found = wall(&blanked);
        let tissue = blanked.tissue_mm();
        for place in places().filter(|place| place.x > 75.0) {
            let hollow = bend(&found, place) * 2.0 * tissue;
            assert!(hollow < 1.0, "{place}: {hollow}");
        }
    }
}

/// A fold at the flank whose data end on its far side, and a roll that they cut: the spline rings beside the blend.
#[test]
fn data_that_end_on_a_rising_slope_are_continued_without_a_hollow() {
    let fold = |at: DVec2| chest(at) + 0.012 * (at.x - 50.0).max(0.0).powi(2);
    let roll = |at: DVec2| chest(at) + 12.0 * (-((at.x - 100.0) / 18.0).powi(2)).exp();
    for (spacing, half) in [(2.0, 130.0), (4.0, 132.0), (6.0, 132.0)] {
        for edge in [72.0, 76.0, 80.0, 84.0, 88.0, 92.0, 96.0] {
            for height in [&fold as &dyn Fn(DVec2) -> f64, &roll] {
                let cut = spaced(spacing, half, |at| (at.x <= edge).then(|| height(at)));
                assert_eq!(cut.validate(), Ok(()), "{spacing} {edge}");
            }
        }
    }
}

#[test]
fn a_small_grid_goes_on_and_gaps_that_are_too_large_are_one_line() {
    // 180 mm of a patch of 227 mm across.
    let small = scene(90.0, |at| Some(chest(at)));
    let found = wall(&small);
    let exact = wall(&scene(HALF, |at| Some(chest(at))));
    for place in places() {
        let apart = (found.height(place) - exact.height(place)).abs();
        assert!(
            apart < if place.abs().max_element() < 85.0 { 1e-2 } else { 4.0 },
            "{place} {apart}"
        );
    }
    assert_eq!(small.chest_warnings(&found).len(), 1);
    for (scene, expected) in [
        (
            scene(HALF, |_| None),
            "chest.grid.heights_mm is known over 0 % of the simulated tissue; allowed: 60 % or more",
        ),
        (
            scene(HALF, |at| (at.y == 0.0).then_some(0.0)),
            "chest.grid.heights_mm is known over 0 % of the simulated tissue; allowed: 60 % or more",
        ),
        (
            scene(HALF, |at| (at.x < -5.0).then(|| chest(at))),
            "chest.grid.heights_mm is known over 4",
        ),
        (
            scene(HALF, |at| (at.length() > 25.0).then(|| chest(at))),
            "chest.grid.heights_mm is known over 8",
        ),
        (scene(60.0, |at| Some(chest(at))), "chest.grid.heights_mm is known over "),
    ] {
        let found = line(&scene);
        assert!(found.starts_with(expected), "{found}");
    }
    let mut fine = scene(60.0, |at| Some(chest(at)));
    fine.chest_grid.as_mut().unwrap().grid.spacing_mm = 0.5;
    assert!(line(&fine).starts_with("chest.grid is 12 mm wide; allowed: "));
    // A gap under the pocket, small enough.
    let hole = |at: DVec2| at.distance(DVec2::new(20.0, 10.0)) < 12.0;
    let found = wall(&scene(HALF, |at| (!hole(at)).then(|| chest(at))));
    let apart = places().map(|place| (found.height(place) - exact.height(place)).abs());
    let most = apart.fold(0.0, f64::max);
    assert!(most < 0.6, "{most}");
}

#[test]
fn smoothing_a_grid_with_gaps_is_said_and_keeps_planes() {
    let tilted = |at: DVec2| 0.03 * at.x - 0.02 * at.y + 1.0;
    let mut plane = scene(HALF, |at| (!corner(at)).then(|| tilted(at)));
    plane.chest_grid.as_mut().unwrap().grid.smooth_mm = 6.0;
    let found = wall(&plane);
    assert!(places().all(|place| found.height(place).abs() < 1e-5));
    let said = plane.chest_warnings(&found);
    assert_eq!(
        said[1],
        "The heights of the chest are smoothed by 6 mm; they moved by up to 0.0 mm."
    );
}

#[test]
fn smoothing_counts_what_it_moves_within_the_tissue() {
    let spike = DVec2::splat(HALF);
    let mut spiked = scene(HALF, |at| Some(if at == spike { 20.0 } else { 0.0 }));
    spiked.chest_grid.as_mut().unwrap().grid.smooth_mm = 6.0;
    let said = spiked.chest_warnings(&wall(&spiked));
    assert!(said.iter().any(|line| line.ends_with("they moved by up to 0.0 mm.")), "{said:?}");
}

use super::*;
use crate::measure::{Fields, Selection, measure};
use crate::mesh::NodeKind;
use crate::scene::ChestShape;
use crate::solve::{Solver, Verdict};

/// A scene with a wall of these heights, 5 mm apart.
fn scene(columns: usize, height: impl Fn(DVec2) -> f64) -> Scene {
    let half = 0.5 * (columns - 1) as f64;
    let place =
        |k: usize| DVec2::new((k % columns) as f64 - half, (k / columns) as f64 - half) * 5.0;
    let heights_mm = (0..columns * columns).map(|k| Some(height(place(k)))).collect();
    let grid = HeightsGrid { spacing_mm: 5.0, columns, rows: columns, heights_mm, smooth_mm: 0.0 };
    Scene { chest_grid: Some(ChestGrid { grid }), ..Scene::default() }
}

fn sphere(radius: f64) -> impl Fn(DVec2) -> f64 {
    move |at| Chest::Curved { across_mm: radius, along_mm: radius }.height(at)
}

#[test]
fn a_grid_is_read_and_written_and_is_the_wall() {
    let round = scene(51, sphere(150.0));
    let text = round.to_json();
    assert_eq!(text.matches("\"chest\"").count(), 1);
    assert_eq!(Scene::from_json(&text), Ok(round.clone()));
    let problem = round.problem().unwrap();
    let radii = ChestShape { radius_across_mm: 150.0, radius_along_mm: Some(150.0) };
    let exact = Scene { chest: Some(radii), ..Scene::default() }.problem().unwrap();
    assert!(
        problem.mirrored() == [true; 2] && problem.obstacle.dome.chest == problem.obstacle.wall.0
    );
    // Nodes outside of the patch stand where the sphere is steep.
    let kinds = problem.sheet().kinds().iter();
    let within: Vec<bool> = kinds.map(|kind| *kind != NodeKind::Outside).collect();
    for layer in 0..problem.rest.layers() {
        let pairs = problem.rest.nodes(layer).zip(exact.rest.nodes(layer)).zip(&within);
        for ((found, exact), _) in pairs.filter(|(_, within)| **within) {
            assert!(found.distance(exact) < 2e-3, "{found} {exact}");
        }
    }
    assert!(!round.same_physics(&Scene::default()));
    assert_eq!(round.chest_warnings(&problem.obstacle.wall.0), [""; 0]);
    let tilted = scene(51, |at| sphere(150.0)(at) + 0.1 * at.x);
    let wall = tilted.problem().unwrap().obstacle.wall.0;
    let [warning] = &*tilted.chest_warnings(&wall) else { panic!("one line") };
    assert!(warning.starts_with("The grid of the chest is tilted by 6°"), "{warning}");
}

#[test]
fn a_wall_that_carries_no_tissue_is_one_line() {
    let line = |scene: &Scene| {
        let line = scene.validate().unwrap_err().to_string();
        assert!(!line.contains('\n') && line.len() < 160, "{line}");
        line
    };
    let round = scene(51, sphere(150.0));
    let with = |edit: &dyn Fn(&mut HeightsGrid)| {
        let mut scene = round.clone();
        edit(&mut scene.chest_grid.as_mut().unwrap().grid);
        line(&scene)
    };
    for (found, expected) in [
        (
            with(&|grid| grid.spacing_mm = 0.2),
            "chest.grid.spacing_mm is 0.2; allowed: 0.5 to 50 mm",
        ),
        (with(&|grid| grid.columns = 3), "chest.grid.columns is 3; allowed: 4 to 257"),
        (
            with(&|grid| grid.rows = 50),
            "chest.grid.heights_mm is a list of 2601; allowed: 2550 numbers",
        ),
        (
            with(&|grid| grid.heights_mm = [Some(f64::NAN); 2601].into()),
            "chest.grid.heights_mm[0] is NaN; allowed: -1000 to 1000 mm",
        ),
        (
            line(&scene(31, sphere(150.0))),
            "chest.grid.heights_mm is known over 56 % of the simulated tissue; allowed: 60 % or more",
        ),
        (line(&scene(51, |at| -at.x * at.x / 20.0)), "chest.grid is steep by "),
        (
            line(&scene(61, |at| 0.6 * at.x)),
            "chest.grid is tilted by 31° at the pocket's centre; allowed: up to 20° \
             (turn the scan: z along the chest's normal there)",
        ),
        // Steep only where the grid's margin goes on.
        (line(&scene(21, |at| -at.x.powi(4) / 5e5)), "chest.grid.heights_mm is known over "),
        (line(&scene(61, |at| 3.0 * (0.3 * at.x).cos())), "chest.grid is hollow with a radius of "),
        (
            line(&scene(61, |at| -40.0 * (-(at - 40.0).length_squared() / 800.0).exp())),
            "chest.grid is ",
        ),
    ] {
        assert!(found.starts_with(expected), "{found}");
    }
    let mut both = round.clone();
    both.chest = Some(ChestShape::USUAL);
    assert!(line(&both).starts_with("chest: both radii and a grid"));
    let text = round.to_json().replacen("\"grid\"", "\"radius_across_mm\": 140, \"grid\"", 1);
    let error = Scene::from_json(&text).unwrap_err().to_string();
    assert!(error.starts_with("chest: both radii and a grid"), "{error}");
}

/// A hollow is deep or not by the tissue in it.
#[test]
fn the_limit_of_a_hollow_is_that_of_the_tissue_at_its_place() {
    let dent = |at: DVec2| -9.0 * (-(at - DVec2::new(60.0, 0.0)).length_squared() / 400.0).exp();
    let with_factor = |there: f64| {
        let mut scene = scene(61, dent);
        scene.layers[1].thickness_mm = 20.0;
        let factor = |k: usize| if k % 61 > 30 { there } else { 1.0 };
        scene.thickness_field = Some(crate::scene::ThicknessGrid {
            spacing_mm: 5.0,
            columns: 61,
            rows: 61,
            factors: (0..61 * 61).map(factor).collect(),
        });
        scene
    };
    assert_eq!(with_factor(0.5).validate(), Ok(()));
    let error = with_factor(1.0).validate().unwrap_err().to_string();
    assert!(error.starts_with("chest.grid is hollow with a radius of "), "{error}");
    assert!(error.ends_with("times the tissue there; chest.grid.smooth_mm 6 would do"), "{error}");
}

#[test]
fn smoothing_keeps_planes_flattens_waves_and_is_said() {
    let thick = |height: &dyn Fn(DVec2) -> f64| {
        let mut scene = scene(61, height);
        scene.layers[1].thickness_mm = 20.0;
        scene
    };
    let smoothed = |height: &dyn Fn(DVec2) -> f64| {
        let mut scene = thick(height);
        scene.chest_grid.as_mut().unwrap().grid.smooth_mm = 6.0;
        scene
    };
    let heights = |scene: &Scene| scene.chest_grid.as_ref().unwrap().grid.whole().unwrap();
    let plane = smoothed(&|at| 0.03 * at.x - 0.02 * at.y + 1.0);
    for (after, before) in
        heights(&plane).iter().zip(&*plane.chest_grid.clone().unwrap().grid.heights_mm)
    {
        assert!((after - before.unwrap()).abs() < 1e-12);
    }
    // A Gaussian mean lowers a wave cos(kx) by exp(-k²σ²/2).
    let wave = smoothed(&|at| 1.5 * (0.2 * at.x).cos());
    let middle = heights(&wave)[30 * 61 + 30];
    assert!((middle - 1.5 * (-0.5_f64 * 1.44).exp()).abs() < 5e-3, "{middle}");
    assert!(thick(&|at| 1.5 * (0.2 * at.x).cos()).validate().is_err());
    assert_eq!(wave.validate(), Ok(()));
    assert_eq!(Scene::from_json(&wave.to_json()), Ok(wave.clone()));
    let wall = wave.problem().unwrap().obstacle.wall.0;
    let said = "The heights of the chest are smoothed by 6 mm; they moved by up to 0.8 mm.";
    assert_eq!(wave.chest_warnings(&wall), [said]);
    let mut wrong = wave;
    wrong.chest_grid.as_mut().unwrap().grid.smooth_mm = 21.0;
    let error = wrong.validate().unwrap_err().to_string();
    assert_eq!(error, "chest.grid.smooth_mm is 21; allowed: 0 to 20 mm");
}

/// Numbers of a uniform distribution from −1 to 1.
fn random(k: usize) -> f64 {
    let mut bits = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (bits ^ (bits >> 31)) as f64 / u64::MAX as f64 * 2.0 - 1.0
}

/// A scene with the usual chest as heights with this spacing, 280 mm wide; `None` leaves a height out.
fn usual(spacing_mm: f64, change: impl Fn(usize, DVec2) -> Option<f64>) -> Scene {
    let half = (140.0 / spacing_mm).floor();
    let side = 2 * half as usize + 1;
    let place =
        |k: usize| DVec2::new((k % side) as f64 - half, (k / side) as f64 - half) * spacing_mm;
    let (across_mm, along_mm) = (ChestShape::USUAL.radius_across_mm, f64::INFINITY);
    let wall = Chest::Curved { across_mm, along_mm };
    let height = |k: usize| Some(wall.height(place(k)) + change(k, place(k))?);
    let heights_mm = (0..side * side).map(height).collect();
    let grid = HeightsGrid { spacing_mm, columns: side, rows: side, heights_mm, smooth_mm: 0.0 };
    Scene { chest_grid: Some(ChestGrid { grid }), ..Scene::default() }
}

/// Noise as of a bad scan: the line has a place, numbers as of a chest, and the least smoothing of those tried that cures.
#[test]
fn the_line_of_a_noisy_scan_has_numbers_as_of_a_chest_and_the_smoothing_that_cures() {
    let mut words = std::collections::BTreeSet::new();
    for (case, (spacing, rms_mm)) in [3.0, 4.0, 5.0, 8.0]
        .into_iter()
        .flat_map(|s| [0.5, 1.0, 2.0, 3.0].map(|n| (s, n)))
        .enumerate()
    {
        let noise = |k: usize| 3_f64.sqrt() * rms_mm * random(k + 100_000 * case);
        let spike = |k: usize| if k % 997 == case { 15.0 } else { 0.0 };
        for spikes in [false, true] {
            let scene = usual(spacing, |k, _| Some(noise(k) + if spikes { spike(k) } else { 0.0 }));
            let line = scene.validate().unwrap_err().to_string();
            assert!(!line.contains('\n') && line.len() < 170, "{line}");
            let number =
                |word: &str| word.trim_matches(|c: char| !c.is_ascii_digit()).parse::<f64>().ok();
            let greatest = line.split_whitespace().filter_map(number).fold(0.0, f64::max);
            assert!(greatest < 141.0, "{line}");
            let Some((what, remedy)) = line.split_once("; chest.grid.smooth_mm ") else {
                // Spikes stay at every smoothing.
                assert!(spikes && rms_mm > 1.0 || spacing > 7.0, "{spacing} {rms_mm}: {line}");
                continue;
            };
            words.insert(what.split(' ').nth(2).unwrap().to_owned());
            let mm: f64 = remedy.strip_suffix(" would do").unwrap().parse().unwrap();
            let smooth = |smooth_mm: f64| {
                let mut scene = scene.clone();
                scene.chest_grid.as_mut().unwrap().grid.smooth_mm = smooth_mm;
                scene.validate()
            };
            assert_eq!(smooth(mm), Ok(()), "{line}");
            let less = SMOOTHER_MM.into_iter().filter(|less| *less < mm);
            assert!(less.into_iter().all(|less| smooth(less).is_err()), "{line}");
        }
    }
    assert!(words.len() > 2, "{words:?}");
}

/// A tenth of the heights is missing here and there: the others bridge them.
#[test]
fn scattered_heights_that_are_missing_are_filled_and_said() {
    for (spacing, missing) in [(2.0, 0.3), (4.0, 0.1), (8.0, 0.1)] {
        let is_open = |k: usize| random(k) < 2.0 * missing - 1.0;
        let scene = usual(spacing, |k, _| (!is_open(k)).then_some(0.0));
        let wall = scene.problem().unwrap().obstacle.wall.0;
        let exact = usual(spacing, |_, _| Some(0.0)).problem().unwrap().obstacle.wall.0;
        for k in 0..400 {
            let place = DVec2::from_angle(2.4 * f64::from(k)) * (0.25 * f64::from(k));
            let apart = (wall.height(place) - exact.height(place)).abs();
            assert!(apart < 0.1, "{spacing} {place}: {apart}");
        }
        let [said] = &*scene.chest_warnings(&wall) else { panic!("one line") };
        assert!(said.starts_with("The heights of the chest are continued over "), "{said}");
    }
    let half = usual(4.0, |k, _| (random(k) < 0.0).then_some(0.0));
    let line = half.validate().map_err(|error| error.to_string());
    assert!(line.is_ok() || line.unwrap_err().starts_with("chest.grid.heights_mm is known over "));
}

#[test]
fn a_gap_under_the_implant_is_said_with_its_place_and_width() {
    for (at, wide) in [(DVec2::ZERO, 12.0), (DVec2::ZERO, 20.0), (DVec2::new(24.0, -20.0), 32.0)] {
        let scene = usual(4.0, |_, place| (place.distance(at) >= 0.5 * wide).then_some(0.0));
        let wall = scene.problem().unwrap().obstacle.wall.0;
        let [_, said] = &*scene.chest_warnings(&wall) else { panic!("two lines") };
        let start = format!("The wall under the implant is estimated at ({}, {}) mm, ", at.x, at.y);
        let (_, width) = said.split_once("no heights over ").unwrap();
        let width: f64 = width.split_once(" mm").unwrap().0.parse().unwrap();
        assert!(said.starts_with(&start) && (wide..=wide + 8.0).contains(&width), "{said}");
    }
    // Beside the implant it is a part of what is continued.
    let scene =
        usual(4.0, |_, place| (place.distance(DVec2::new(0.0, 90.0)) > 10.0).then_some(0.0));
    let wall = scene.problem().unwrap().obstacle.wall.0;
    assert_eq!(scene.chest_warnings(&wall).len(), 1);
}

/// A hole under the implant, in a wall that no quadric fits: the heights around it continue it.
#[test]
fn a_hole_under_the_implant_is_filled_from_the_heights_around_it() {
    let bump =
        |place: DVec2| 5.0 * (-(place - DVec2::new(6.0, 3.0)).length_squared() / 900.0).exp();
    let pressure = |scene: &Scene| {
        let mut solver = Solver::new(scene.problem().unwrap());
        solver.advance(&mut || false);
        assert_eq!(solver.verdict(), Verdict::Converged);
        let fields = Fields::new(Arc::new(solver.into_solution()));
        let tissues = scene.layers.iter().map(|layer| layer.tissue.clone()).collect::<Vec<_>>();
        measure(&fields, &tissues, &Selection::all()).contact_pressure_kpa.unwrap().max
    };
    let full = usual(4.0, |_, place| Some(bump(place)));
    let (exact, whole) = (full.problem().unwrap().obstacle.wall.0, pressure(&full));
    for (wide, most_mm, most_pressure) in
        [(12.0, 0.03, 0.015), (20.0, 0.08, 0.04), (32.0, 0.3, 0.08)]
    {
        let is_open = |place: DVec2| place.length() < 0.5 * wide;
        let scene = usual(4.0, |_, place| (!is_open(place)).then(|| bump(place)));
        let wall = scene.problem().unwrap().obstacle.wall.0;
        // Heights count from the plane that touches the wall at the centre.
        let apart = (0..200).map(|k| DVec2::from_angle(2.4 * f64::from(k)) * (0.1 * f64::from(k)));
        let apart = |wall: &Chest| apart.clone().map(|at| wall.height(at)).collect::<Vec<_>>();
        let (found, given) = (apart(&wall), apart(&exact));
        let pairs = found.iter().zip(&given).map(|(a, b)| a - b);
        let mean = pairs.clone().sum::<f64>() / 200.0;
        let most = pairs.map(|apart| (apart - mean).abs()).fold(0.0, f64::max);
        let change = pressure(&scene) / whole - 1.0;
        assert!(most < most_mm && change.abs() < most_pressure, "{wide}: {most} {change}");
    }
}

//! Maps from some of their points, against the same maps solved as a whole and against closed forms.
#![allow(clippy::unwrap_used)]
#![allow(clippy::float_cmp, reason = "equal to the last bit")]

use implant_preview_core::measure::Status;
use implant_preview_core::scene::Scene;
use implant_preview_core::study::{
    Axis, Case, Cases, Job, Map, MapSettings, PointStatus, Quantity, Source, Study, evaluate,
};
use std::collections::BTreeMap;

fn map(axes: [&str; 2]) -> Map {
    let axes = axes.map(|axis| Axis::parse(axis).unwrap());
    Map::new(&Scene::opening(), &axes, MapSettings::default()).unwrap()
}

/// Runs a map with so many jobs at a time, which end in the opposite order.
fn run(mut map: Map, at_a_time: usize, solve: impl Fn(&Job) -> Vec<Case>) -> Map {
    let (mut store, mut jobs) = (Cases::default(), Vec::new());
    loop {
        while jobs.len() < at_a_time
            && let Some(job) = map.next_job(&mut store)
        {
            jobs.push(job);
        }
        let Some((index, job)) = jobs.pop() else { break };
        assert!(!map.is_done());
        map.receive(index, solve(&job), &mut store);
    }
    assert!(map.is_done());
    map
}

fn points(map: &Map) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (columns, rows) = map.shape();
    (0..rows).flat_map(move |j| (0..columns).map(move |i| (i, j)))
}

/// The greatest relative error of the interpolated values, and the share of those within their stated error.
fn errors(map: &Map, all: &Map, quantity: Quantity) -> (f64, f64) {
    let (mut greatest, mut count, mut within) = (0.0_f64, 0.0, 0.0);
    for (i, j) in points(map) {
        let Some((value, error)) = map.interpolated(quantity, i, j) else { continue };
        let Some(exact) = all.value(quantity, i, j) else { continue };
        greatest = greatest.max((value / exact - 1.0).abs());
        count += 1.0;
        within += f64::from(u8::from((value - exact).abs() <= error));
    }
    assert!(count > 0.5 * all.cases().len() as f64);
    (greatest, within / count)
}

#[test]
fn the_opening_range_is_known_from_70_points() {
    for projections in ["projection_mm=10:50:20", "projection_mm=25:60:20"] {
        let new = || map(["base_width_mm=100:140:20", projections]);
        let sampled = run(new().sampled(), 4, evaluate);
        let all = run(new(), 1, evaluate);
        assert!(sampled.scenes_solved() <= 70);
        assert_eq!(all.scenes_solved(), 400);
        use Quantity as Q;
        for (quantity, aim) in [
            (Q::GreatestStrain, 0.005),
            (Q::LeastCoverMm, 0.005),
            (Q::ForceN, 0.005),
            (Q::MeanPressureKpa, 0.01),
            (Q::GreatestPressureKpa, 0.021),
            (Q::SkinStressKpa, 0.02),
            (Q::SkinProjectionMm, 0.001),
        ] {
            let (greatest, within) = errors(&sampled, &all, quantity);
            assert!(greatest <= aim, "{quantity:?}: {greatest}");
            assert!(within > 0.92, "{quantity:?}: {within}");
        }
        for (i, j) in points(&sampled) {
            let is_solved = sampled.source(i, j) == Some(Source::Solved);
            assert_eq!(sampled.status(i, j), PointStatus::Converged);
            if is_solved {
                assert_eq!(sampled.case(i, j), all.case(i, j));
            }
            assert_eq!(is_solved, sampled.interpolated(Quantity::ForceN, i, j).is_none());
            // No area is stretched above a strain that the greatest one does not reach.
            let [area, strain] =
                [Q::AreaOver25, Q::GreatestStrain].map(|q| sampled.interpolated(q, i, j));
            if let (Some((area, error)), Some((strain, margin))) = (area, strain) {
                assert!((0.0..=1.0).contains(&error), "{error}");
                assert!(area == 0.0 || strain + margin >= 0.25, "{area} {strain}");
            }
        }
    }
}

/// At rest there is no pressure and no cover; beside it the values of a point do not contradict each other.
#[test]
fn a_map_from_rest_has_the_quantities_of_its_points() {
    let new = || map(["projection_mm=20:40:12", "insertion=0:1:16"]);
    let (sampled, all) = (run(new().sampled(), 1, evaluate), run(new(), 1, evaluate));
    use Quantity as Q;
    let mut interpolated = [0; 2];
    for (i, j) in points(&all) {
        for quantity in Q::ALL {
            let [found, wanted] = [&sampled, &all].map(|map| map.value(quantity, i, j).is_some());
            assert_eq!(found, wanted, "{quantity:?} at {i}, {j}");
        }
        let Some((volume, error)) = sampled.interpolated(Q::ImplantVolumeMl, i, j) else {
            continue;
        };
        interpolated[usize::from(j == 0)] += 1;
        let wanted = all.value(Q::ImplantVolumeMl, i, j).unwrap();
        assert!((volume / wanted - 1.0).abs() < 1e-9 && error == 0.0, "{volume} {wanted}");
        for (least, most) in [
            (Q::MeanPressureKpa, Q::GreatestPressureKpa),
            (Q::MeanPressureMmhg, Q::GreatestPressureMmhg),
            (Q::LeastCoverMm, Q::ApexCoverMm),
        ] {
            let [least, most] = [least, most].map(|quantity| sampled.value(quantity, i, j));
            assert!(least <= most, "{least:?} {most:?} at {i}, {j}");
        }
    }
    assert!(interpolated[0] > 80 && interpolated[1] > 3, "{interpolated:?}");
}

/// Thirteen of the lattice's 25 points give a first map, whose errors are stated; the points that are solved do not depend on it.
#[test]
fn half_of_the_lattice_gives_a_first_map_with_errors() {
    let mut map = map(["base_width_mm=100:140:20", "projection_mm=25:50:20"]).sampled();
    let mut store = Cases::default();
    while map.scenes_solved() < 13 {
        assert!(map.interpolated(Quantity::GreatestStrain, 1, 1).is_none());
        let (index, job) = map.next_job(&mut store).unwrap();
        map.receive(index, evaluate(&job), &mut store);
    }
    assert!(map.scenes_solved() <= 14);
    use Quantity as Q;
    let quantities = [Q::GreatestStrain, Q::LeastCoverMm, Q::ForceN, Q::MeanPressureKpa];
    let first: Vec<_> = points(&map)
        .filter(|(i, j)| map.case(*i, *j).is_none())
        .map(|(i, j)| (i, j, quantities.map(|q| map.interpolated(q, i, j).unwrap())))
        .collect();
    assert!(first.iter().all(|&(i, j, _)| map.status(i, j) == PointStatus::Waiting));
    assert!(first.iter().all(|&(i, j, _)| map.source(i, j).is_none()));
    let map = run(map, 1, evaluate);
    for (k, quantity) in quantities.into_iter().enumerate() {
        let (mut greatest, mut within) = (0.0_f64, 0);
        for (i, j, values) in &first {
            let (value, error) = values[k];
            let found = map.value(quantity, *i, *j).unwrap();
            greatest = greatest.max((value / found - 1.0).abs());
            within += usize::from((value - found).abs() <= error);
        }
        let within = within as f64 / first.len() as f64;
        assert!(greatest < 0.03 && within > 0.9, "{quantity:?}: {greatest} {within}");
    }
}

#[test]
fn the_border_of_no_answer_is_found() {
    let new = || map(["base_width_mm=78:180:20", "projection_mm=20:75:20"]);
    let (sampled, all) = (run(new().sampled(), 1, evaluate), run(new(), 1, evaluate));
    assert!(sampled.scenes_solved() <= 70);
    let has_answer = |map: &Map, (i, j)| map.status(i, j) == PointStatus::Converged;
    let missing = points(&all).filter(|at| !has_answer(&all, *at)).count();
    let other = points(&all).filter(|at| has_answer(&all, *at) != has_answer(&sampled, *at));
    let other: Vec<_> = other.collect();
    assert!(missing > 10 && other.len() <= 2);
}

/// A case with an answer below a projection that depends on the width, and a strain that bends along another line.
fn bent(scene: &Scene, border: f64, bend: f64) -> Case {
    let (x, y) = (2.0 * scene.implant.base_radius_mm, scene.implant.projection_mm);
    let has_answer = y < border + 0.5 * (x - 100.0);
    let strain = 0.1 + 1e-3 * x + bend * (y - 45.0).max(0.0);
    let values = BTreeMap::from([(Quantity::GreatestStrain, strain), (Quantity::ForceN, 0.2 * x)]);
    let status = if has_answer { Status::Converged } else { Status::Unstable };
    Case { status: Some(status), values: values.into(), evaluations: 1.0, ..Case::default() }
}

fn closed(job: &Job) -> Vec<Case> {
    job.scenes.iter().map(|scene| bent(scene, 40.0, 0.01)).collect()
}

#[test]
fn points_are_solved_where_a_quantity_bends() {
    let solve = |job: &Job, bend| job.scenes.iter().map(|of| bent(of, 100.0, bend)).collect();
    let new = || map(["base_width_mm=100:140:30", "projection_mm=20:70:51"]);
    let of = |map: Map, bend: f64| run(map, 3, |job| solve(job, bend));
    let (straight, sampled) = (of(new().sampled(), 0.0), of(new().sampled(), 0.01));
    let all = of(new(), 0.01);
    assert!(straight.scenes_solved() < 50 && sampled.scenes_solved() > 60);
    assert!(sampled.scenes_solved() <= 70);
    let height = |j: usize| sampled.axes()[1].value(j);
    let solved = |from: f64, to: f64| {
        let within = points(&sampled).filter(|(_, j)| (from..to).contains(&height(*j)));
        within.filter(|(i, j)| sampled.source(*i, *j) == Some(Source::Solved)).count()
    };
    // A quarter of the height around the bend, and as much below.
    let [at_bend, below] = [solved(39.0, 51.0), solved(21.0, 33.0)];
    assert!(at_bend > below, "{at_bend} {below}");
    // The errors are stated: large at the bend, small away from it.
    let error = |at: f64| {
        let near = points(&sampled).filter(|(_, j)| (height(*j) - at).abs() < 2.0);
        let error = |(i, j)| sampled.interpolated(Quantity::GreatestStrain, i, j).map(|of| of.1);
        near.filter_map(error).fold(0.0, f64::max)
    };
    assert!(error(45.0) > error(25.0), "{} {}", error(45.0), error(25.0));
    let (greatest, within) = errors(&sampled, &all, Quantity::GreatestStrain);
    assert!(greatest < 0.07 && within > 0.9, "{greatest} {within}");
}

#[test]
fn points_are_solved_on_both_sides_of_the_border() {
    let new = || map(["base_width_mm=100:140:30", "projection_mm=20:70:30"]);
    let (sampled, all) = (run(new().sampled(), 3, closed), run(new(), 1, closed));
    assert!(sampled.scenes_solved() <= 70);
    let state = |map: &Map, (i, j)| map.status(i, j) == PointStatus::Converged;
    let missed = points(&all).filter(|at| state(&all, *at) != state(&sampled, *at)).count();
    // The border passes 30 columns.
    assert!(missed <= 18, "{missed}");
}

#[test]
fn the_points_do_not_depend_on_the_number_of_jobs_at_a_time() {
    let new = || map(["base_width_mm=100:140:25", "projection_mm=20:70:25"]).sampled();
    let [one, three, many] = [1, 3, 50].map(|count| run(new(), count, closed));
    for other in [three, many] {
        assert_eq!(one.cases(), other.cases());
        for (i, j) in points(&one) {
            assert_eq!(one.status(i, j), other.status(i, j));
            let of = |map: &Map| map.interpolated(Quantity::GreatestStrain, i, j);
            assert_eq!(of(&one), of(&other));
        }
    }
}

#[test]
fn small_maps_and_maps_with_few_answers_are_solved_as_a_whole() {
    let small = run(map(["base_width_mm=100:140:8", "projection_mm=20:30:8"]).sampled(), 2, closed);
    assert_eq!(small.cases().iter().flatten().count(), 64);
    let steep = ["base_width_mm=100:140:20", "projection_mm=55:75:20"];
    let (sampled, all) = (run(map(steep).sampled(), 2, closed), run(map(steep), 2, closed));
    assert!(!sampled.is_sampled());
    assert_eq!(sampled.cases(), all.cases());
    // Points out of the limits of a scene are no answers of others.
    let invalid = ["base_width_mm=100:140:20", "pocket_radius_mm=50:80:20"];
    let (sampled, all) = (run(map(invalid).sampled(), 2, closed), run(map(invalid), 2, closed));
    for (i, j) in points(&all) {
        assert_eq!(sampled.status(i, j), all.status(i, j), "{i} {j}");
    }
}

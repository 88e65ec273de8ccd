//! The paper's tension test: measured curves and Poisson ratios, loss of stability.

use glam::{DMat2, DVec2};
use implant_preview::curve::{Curve, CurveSpec, Interpolation, ScaledCurve};
use implant_preview::springs::Springs;
use implant_preview_lab::sample::Sample;
use implant_preview_lab::tension::{LOADS, Protocol, Report, Status, Test, run};

#[path = "common/unstable_strains.rs"]
mod unstable_strains;
use unstable_strains::{UNSTABLE, are_close};

/// The Poisson ratios of the paper's charts.
const POISSON_RATIOS: [f64; 6] = [0.1, 0.2, 0.3, 0.4, 0.45, 0.49];
const LAWS: [Springs; 2] = [Springs::Coupled, Springs::Nikolaev];

fn curve(name: &str) -> Curve {
    let spec = match name {
        "skin" => CurveSpec::Skin {},
        "adipose" => CurveSpec::Adipose {},
        _ => CurveSpec::Linear { modulus_kpa: 10.0 },
    };
    Curve::new(&spec).expect("a good curve")
}

/// Greatest relative error of the stress \[-\]: load against Ef at the measured strain.
fn greatest_stress_error(report: &Report, curve: &Curve) -> Option<f64> {
    let errors = report
        .rows
        .iter()
        .filter_map(|row| Some((row.load_kpa / curve.stress(row.measured?.strain) - 1.0).abs()));
    errors.reduce(f64::max)
}

fn pull(springs: Springs, name: &str, nu: f64, degrees: f64, protocol: Protocol) -> Report {
    run(&Test {
        springs,
        curve: curve(name),
        poisson_ratio: nu,
        cells: 4,
        angle: degrees.to_radians(),
        protocol,
    })
}

/// The sample stretched by `strain` along x and −ν·strain across.
fn uniaxial(sample: &Sample, strain: f64, nu: f64) -> Vec<DVec2> {
    sample.rest().iter().map(|p| *p * DVec2::new(1.0 + strain, 1.0 - nu * strain)).collect()
}

/// A sheared, stretched and crumpled shape without any symmetry.
fn crumpled(sample: &Sample) -> Vec<DVec2> {
    let crumple = |k: f64| DVec2::new((1.7 * k).sin(), (2.3 * k).cos());
    (sample.rest().iter().enumerate())
        .map(|(k, p)| DVec2::new(1.25 * p.x + 0.1 * p.y, 0.95 * p.y) + 0.06 * crumple(k as f64))
        .collect()
}

#[test]
fn homogeneous_tension_is_in_equilibrium_to_rounding_under_both_laws() {
    for springs in LAWS {
        for name in ["skin", "adipose", "linear"] {
            let curve = curve(name);
            for nu in POISSON_RATIOS {
                let sample = Sample::new(4, springs, &curve, nu);
                for k in 1..=20 {
                    let strain = 0.05 * f64::from(k);
                    let stress = curve.stress(strain);
                    let loads = sample.border_loads(DMat2::from_diagonal(DVec2::new(stress, 0.0)));
                    let forces = sample.forces(&uniaxial(&sample, strain, nu));
                    for (force, load) in forces.iter().zip(loads) {
                        let error = (*force + load).length();
                        assert!(
                            error < 1e-12 * stress,
                            "{springs:?} {name} {nu} {strain}: {error}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn border_nodes_of_two_cells_carry_twice_the_load_of_corners() {
    let sample = Sample::new(4, Springs::Nikolaev, &curve("skin"), 0.3);
    let loads = sample.border_loads(DMat2::from_diagonal(DVec2::new(8.0, 0.0)));
    for (k, load) in loads.iter().enumerate() {
        let (i, j) = (k % 5, k / 5);
        let side = if i == 4 {
            1.0
        } else if i == 0 {
            -1.0
        } else {
            0.0
        };
        let cells = if j == 0 || j == 4 { 1.0 } else { 2.0 };
        // Half of 8 kPa on 1 mm² from each cell.
        assert!((*load - DVec2::new(4.0 * cells * side, 0.0)).length() < 1e-12);
    }
}

#[test]
fn coupled_springs_reproduce_the_curve_and_the_poisson_ratio_in_every_direction() {
    for name in ["skin", "adipose"] {
        for nu in POISSON_RATIOS {
            for degrees in [0.0, 22.5, 45.0, 71.0] {
                let report = pull(Springs::Coupled, name, nu, degrees, Protocol::Equilibrium);
                assert_eq!(report.stability_lost_at, None);
                assert!(report.rows.iter().all(|row| row.status == Status::Converged));
                let poisson = report.greatest_poisson_error(nu).unwrap();
                let stress = greatest_stress_error(&report, &curve(name)).unwrap();
                assert!(
                    poisson < 1e-8 && stress < 1e-8,
                    "{name} {nu} {degrees}: {poisson} {stress}"
                );
            }
        }
    }
}

/// Newton's method stalls at some kinks; the experiment had reported a loss of stability there.
#[test]
fn coupled_springs_follow_a_curve_past_kinks() {
    let points = vec![[0.0, 0.0], [0.12, 4.0], [0.14, 30.0], [0.5, 31.0], [1.0, 31.5]];
    let curve =
        Curve::new(&CurveSpec::Points { points, interpolation: Interpolation::Line }).unwrap();
    for (poisson_ratio, cells, angle) in [(0.0, 1, 0.3), (0.3, 4, 0.0), (0.49, 4, 0.7)] {
        let protocol = Protocol::Equilibrium;
        let springs = Springs::Coupled;
        let report =
            run(&Test { springs, curve: curve.clone(), poisson_ratio, cells, angle, protocol });
        assert_eq!(report.stability_lost_at, None);
        assert!(report.rows.iter().all(|row| row.status == Status::Converged));
        let error = greatest_stress_error(&report, &curve).unwrap();
        assert!(error < 1e-8, "{poisson_ratio} {cells}: {error}");
    }
}

#[test]
fn a_scaled_curve_is_the_curve_that_the_tension_test_measures() {
    for (spec, strain_scale, stress_scale) in
        [(CurveSpec::Skin {}, 0.5, 1.3), (CurveSpec::Adipose {}, 1.7, 2.5)]
    {
        let plain = Curve::new(&spec).unwrap();
        let curve = Curve::scaled(&ScaledCurve { spec, strain_scale, stress_scale }).unwrap();
        let test = Test {
            springs: Springs::Coupled,
            curve: curve.clone(),
            poisson_ratio: 0.3,
            cells: 4,
            angle: 0.4,
            protocol: Protocol::Equilibrium,
        };
        let report = run(&test);
        assert!(report.rows.iter().all(|row| row.status == Status::Converged));
        assert!(greatest_stress_error(&report, &curve).unwrap() < 1e-8);
        for row in &report.rows {
            let strain = row.measured.as_ref().unwrap().strain;
            let wanted = stress_scale * plain.stress(strain / strain_scale);
            assert!((row.load_kpa - wanted).abs() < 1e-7 * wanted, "{strain}");
        }
    }
}

#[test]
fn papers_springs_reproduce_the_curve_and_the_poisson_ratio_where_stable() {
    for name in ["skin", "adipose"] {
        for nu in POISSON_RATIOS {
            let report = pull(Springs::Nikolaev, name, nu, 0.0, Protocol::Equilibrium);
            assert!(report.greatest_poisson_error(nu).unwrap() < 1e-8);
            assert!(greatest_stress_error(&report, &curve(name)).unwrap() < 1e-8);
            for row in &report.rows {
                assert_eq!(row.measured.is_some(), row.status == Status::Converged);
                let expected = curve(name).stress(row.strain_expected);
                assert!((row.load_kpa - expected).abs() <= 1e-14 * expected);
            }
        }
    }
}

/// Unstable stretches, as first and last row of the experiment (steps of 0.02).
fn unstable_stretches(report: &Report) -> Vec<[f64; 2]> {
    let step = 1.0 / f64::from(LOADS);
    let mut found: Vec<[f64; 2]> = Vec::new();
    for row in report.rows.iter().filter(|row| row.status == Status::Unstable) {
        match found.last_mut() {
            Some(last) if row.strain_expected - last[1] < 1.5 * step => {
                last[1] = row.strain_expected;
            }
            _ => found.push([row.strain_expected; 2]),
        }
    }
    found
}

#[test]
fn papers_springs_lose_stability_where_the_hessian_of_the_homogeneous_state_says() {
    for (name, nu, wanted) in UNSTABLE {
        let report = pull(Springs::Nikolaev, name, nu, 0.0, Protocol::Equilibrium);
        let found = unstable_stretches(&report);
        assert!(are_close(&found, wanted, 1e-9), "{name} {nu}: {found:?} instead of {wanted:?}");
        let first = wanted.first().map(|stretch| stretch[0]);
        assert_eq!(report.stability_lost_at.is_some(), first.is_some());
        if let (Some(lost), Some(first)) = (report.stability_lost_at, first) {
            assert!(lost <= first && lost > first - 0.021, "{name} {nu}: lost at {lost}");
        }
    }
}

#[test]
fn papers_protocol_agrees_with_the_equilibrium_where_stable() {
    for (springs, name, nu) in [
        (Springs::Nikolaev, "skin", 0.1),
        (Springs::Nikolaev, "skin", 0.3),
        (Springs::Coupled, "skin", 0.49),
        (Springs::Coupled, "adipose", 0.45),
    ] {
        let relaxed = pull(springs, name, nu, 0.0, Protocol::Paper);
        assert!(relaxed.rows.iter().all(|row| row.status == Status::Converged));
        assert!(relaxed.greatest_poisson_error(nu).unwrap() < 1e-6);
        assert!(greatest_stress_error(&relaxed, &curve(name)).unwrap() < 1e-6);
    }
}

#[test]
fn papers_protocol_measures_a_low_poisson_ratio_where_the_homogeneous_state_is_unstable() {
    // Skin at ν = 0.4 between 0.34 and 0.40: the sample reaches an inhomogeneous, stable shape.
    let report = pull(Springs::Nikolaev, "skin", 0.4, 0.0, Protocol::Paper);
    for row in &report.rows {
        let measured = row.measured.unwrap().poisson_ratio();
        if (0.35..0.39).contains(&row.strain_expected) {
            assert!((0.36..0.395).contains(&measured), "{measured} at {}", row.strain_expected);
        } else if !(0.33..0.42).contains(&row.strain_expected) {
            assert!((measured - 0.4).abs() < 1e-6, "{measured} at {}", row.strain_expected);
        }
    }
}

#[test]
fn a_diverging_sample_is_reported_and_never_displayed() {
    for (name, nu) in [("adipose", 0.49), ("adipose", 0.1), ("linear", 0.4)] {
        let relaxed = pull(Springs::Nikolaev, name, nu, 0.0, Protocol::Paper);
        let followed = pull(Springs::Nikolaev, name, nu, 0.0, Protocol::Equilibrium);
        let (lost, limit) =
            (relaxed.stability_lost_at.unwrap(), followed.stability_lost_at.unwrap());
        assert!((lost - limit).abs() < 0.021, "{name} {nu}: ran away at {lost}, limit {limit}");
        for row in &relaxed.rows {
            assert_eq!(row.measured.is_none(), row.strain_expected > lost - 1e-9);
            assert!(row.measured.is_none_or(|m| (m.poisson_ratio() / nu - 1.0).abs() < 1e-6));
        }
    }
}

#[test]
fn forces_sum_to_zero_and_give_no_torque() {
    for springs in LAWS {
        let sample = Sample::new(4, springs, &curve("skin"), 0.4);
        let x = crumpled(&sample);
        let forces = sample.forces(&x);
        let size: f64 = forces.iter().map(|f| f.length()).sum();
        let torque: f64 = x.iter().zip(&forces).map(|(x, f)| x.perp_dot(*f)).sum();
        assert!(size > 1.0 && forces.iter().sum::<DVec2>().length() < 1e-13 * size);
        assert!(torque.abs() < 1e-12 * size);
    }
}

#[test]
fn forces_are_minus_the_gradient_of_the_energy() {
    for springs in LAWS {
        for name in ["skin", "adipose"] {
            let sample = Sample::new(3, springs, &curve(name), 0.45);
            let x = crumpled(&sample);
            let forces = sample.forces(&x);
            let size = forces.iter().map(|f| f.length()).fold(0.0, f64::max);
            for node in 0..x.len() {
                for axis in 0..2 {
                    let energy = |step: f64| {
                        let mut x = x.clone();
                        x[node][axis] += step;
                        sample.energy(&x)
                    };
                    let slope = (energy(1e-5) - energy(-1e-5)) / 2e-5;
                    assert!((forces[node][axis] + slope).abs() < 1e-6 * size, "{springs:?} {name}");
                }
            }
        }
    }
}

#[test]
fn a_rotated_sheet_has_rotated_forces() {
    for springs in LAWS {
        let sample = Sample::new(4, springs, &curve("adipose"), 0.3);
        let x = crumpled(&sample);
        let turn = DVec2::from_angle(2.1);
        let moved: Vec<DVec2> = x.iter().map(|x| turn.rotate(*x) + DVec2::new(7.0, -3.0)).collect();
        for (force, rotated) in sample.forces(&x).iter().zip(sample.forces(&moved)) {
            assert!((turn.rotate(*force) - rotated).length() < 1e-11);
        }
    }
}

#[test]
fn finer_samples_measure_equal_values() {
    for springs in LAWS {
        let report = run(&Test {
            springs,
            curve: curve("skin"),
            poisson_ratio: 0.3,
            cells: 7,
            angle: 0.0,
            protocol: Protocol::Equilibrium,
        });
        assert!(report.greatest_poisson_error(0.3).unwrap() < 1e-8);
        assert!(report.rows.iter().all(|row| row.status == Status::Converged));
    }
}

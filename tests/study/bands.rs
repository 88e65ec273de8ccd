//! Bands, importance and samples.

use super::*;

/// A linear function of projection and pocket in place of a solve.
fn linear(job: &Job) -> Vec<Case> {
    let case = |scene: &Scene| {
        let value = 2.0 * scene.implant.projection_mm + 3.0 * scene.pocket_radius_mm;
        let values = BTreeMap::from([(Quantity::ForceN, value)]);
        Case { status: Some(Status::Converged), values: Values::from(values), ..Case::default() }
    };
    job.scenes.iter().map(case).collect()
}

#[test]
fn bands_of_a_linear_function_have_the_percentiles_and_indices_of_theory() {
    let normal = |mean, sd| Some(Distribution::Normal { mean, sd });
    let mut unknowns: BTreeMap<Unknown, Option<Distribution>> =
        Unknown::ALL.into_iter().map(|unknown| (unknown, None)).collect();
    unknowns.insert(Unknown::Projection, normal(-0.035, 0.03));
    unknowns.insert(Unknown::PocketRadius, normal(0.0, 2.5));
    let settings =
        BandsSettings { samples: 1024, importance_rows: 512, unknowns, ..Default::default() };
    let mut scene = sheet();
    scene.pocket_radius_mm = 90.0;
    let mut bands = Bands::new(&scene, settings).unwrap();
    run_with(&mut bands, &mut Cases::default(), linear);
    let found = &bands.bands()[0];
    let mean = 2.0 * 55.0 * (1.0 - 0.035) + 3.0 * 90.0;
    let deviations: [f64; 2] = [2.0 * 55.0 * 0.03, 3.0 * 2.5];
    let sd = deviations[0].hypot(deviations[1]);
    for (value, quantile) in [(found.p10, -1.281_55), (found.p50, 0.0), (found.p90, 1.281_55)] {
        assert!((value - mean - quantile * sd).abs() < 0.02 * sd, "{value} {mean} {sd}");
    }
    assert!((found.scene.unwrap() - (110.0 + 270.0)).abs() < 1e-9);
    assert!((found.scenarios[1].value.unwrap() - mean).abs() < 1e-9);
    let pairs = [(Unknown::Projection, deviations[0]), (Unknown::PocketRadius, deviations[1])];
    for (unknown, deviation) in pairs {
        let (index, wanted) = (found.importance[&unknown], (deviation / sd).powi(2));
        assert!((index.first_order - wanted).abs() < 1e-9, "{unknown:?} {index:?} {wanted}");
        assert!((index.total - wanted).abs() < 1e-9, "{unknown:?} {index:?} {wanted}");
    }
    // A polynomial of the samples has these indices: no row is solved.
    assert!(found.importance_error.unwrap() < 1e-12);
    assert_eq!((bands.progress(), bands.report().remarks), ((1028, 1028), Vec::new()));
    assert_eq!(found.text, "376 N, 366–387");
}

#[test]
fn equal_seeds_give_equal_bands_and_nothing_is_solved_twice() {
    let report = |seed: u32, store: &mut Cases| {
        let mut bands = Bands::new(&sheet(), small(seed)).unwrap();
        let scenes = run(&mut bands, store);
        (scenes, bands.report())
    };
    let mut store = Cases::default();
    let (scenes, first) = report(1, &mut store);
    let all = 1 + 3 + 32 + 16 * 9;
    assert_eq!((scenes, first.scenes_planned, first.scenes_solved), (all, all, all));
    assert_eq!((store.solved(), store.reused()), (all, 0));
    let (again, second) = report(1, &mut store);
    assert_eq!((again, &second), (0, &first));
    assert_eq!((store.solved(), store.reused()), (all, all));
    let (_, fresh) = report(1, &mut Cases::default());
    assert_eq!(fresh, first);
    let (_, other) = report(2, &mut store);
    assert_ne!(other.bands, first.bands);
    assert_eq!(first.counts.values().sum::<usize>(), 32);
    assert_eq!(first.profile.len(), 41);
    let band = first.bands.iter().find(|b| b.quantity == Quantity::GreatestPressureMmhg).unwrap();
    assert!(band.p10 < band.p50 && band.p50 < band.p90, "{band:?}");
    let stresses: Vec<f64> = band.scenarios.iter().map(|s| s.value.unwrap()).collect();
    assert!(stresses[0] < stresses[1] && stresses[1] < stresses[2]);
    let json = serde_json::to_value(&first).unwrap();
    let note = "An illustration from a simplified model, not a prediction for a person.";
    assert_eq!(json["notes"][0], note);
    assert!(json["notes"][1].as_str().unwrap().contains("Correlations"));
}

#[test]
fn the_importance_of_the_opening_plan_needs_no_scene_beside_the_samples() {
    let mut bands = Bands::new(&Scene::opening(), BandsSettings::default()).unwrap();
    let (scenes, mut store) = (1 + 3 + 256, Cases::default());
    assert_eq!(run(&mut bands, &mut store), scenes);
    let report = bands.report();
    assert_eq!((report.scenes_planned, report.scenes_solved), (scenes, scenes));
    assert_eq!(report.remarks, [""; 0]);
    for band in report.bands.iter().filter(|band| band.p90 > band.p10) {
        assert!(band.importance_error.unwrap() < 0.05, "{band:?}");
        assert_eq!(band.importance.len(), report.unknowns.len());
        let alone: f64 = band.importance.values().map(|index| index.first_order).sum();
        assert!((0.5..1.0 + 1e-9).contains(&alone), "{band:?}");
    }
    // How far the skin of a person stretches is what matters most for the share of its reserve.
    let of = |quantity| &report.bands.iter().find(|b| b.quantity == quantity).unwrap().importance;
    assert!(of(Quantity::SkinReserveUsed)[&Unknown::SkinStrainScale].first_order > 0.9);
    assert!(of(Quantity::LeastCoverMm)[&Unknown::CoverThickness].first_order > 0.9);
}

#[test]
fn rows_are_solved_where_a_polynomial_misses_too_much() {
    // A step of the pocket's radius, and a plane.
    let solve = |job: &Job| {
        let case = |scene: &Scene| {
            let step = if scene.pocket_radius_mm > 91.0 { 1.0 } else { 0.0 };
            let values =
                [(Quantity::ForceN, step), (Quantity::GreatestStrain, scene.implant.projection_mm)];
            let values = Values::from(BTreeMap::from(values));
            Case { status: Some(Status::Converged), values, ..Case::default() }
        };
        job.scenes.iter().map(case).collect()
    };
    let scene = Scene { pocket_radius_mm: 90.0, ..sheet() };
    let settings = BandsSettings { samples: 256, importance_rows: 256, ..Default::default() };
    let mut bands = Bands::new(&scene, settings).unwrap();
    run_with(&mut bands, &mut Cases::default(), solve);
    let unknowns = bands.unknowns().len();
    let all = 4 + 256 + 256 * (unknowns + 1);
    assert_eq!(bands.progress(), (all, all));
    let report = bands.report();
    let of = |quantity| report.bands.iter().find(|band| band.quantity == quantity).unwrap();
    let (step, plane) = (of(Quantity::ForceN), of(Quantity::GreatestStrain));
    assert!(step.importance_error.is_none() && plane.importance_error.unwrap() < 1e-12);
    let index = step.importance[&Unknown::PocketRadius];
    assert!(index.standard_error[0] > 0.01 && index.total > 0.7, "{index:?}");
    assert_eq!(step.importance[&Unknown::Projection].total, 0.0);
    let [line] = &report.remarks[..] else { panic!("{:?}", report.remarks) };
    assert!(line.starts_with("Importance from 256 rows, because") && line.contains("force_n ("));
    assert!(!line.contains("greatest_strain"), "{line}");
}

#[test]
fn the_profile_of_layered_tissue_has_a_band() {
    let settings = BandsSettings { importance_rows: 0, samples: 16, ..small(1) };
    let mut bands = Bands::new(&Scene::default(), settings).unwrap();
    run(&mut bands, &mut Cases::default());
    let profile = bands.profile();
    assert!((profile[40].s_mm - 130.0).abs() < 1e-9);
    for point in &profile {
        assert!(point.z_mm[0] <= point.z_mm[1] && point.z_mm[1] <= point.z_mm[2], "{point:?}");
    }
    assert!(profile[0].z_mm[2] - profile[0].z_mm[0] > 2.0, "{:?}", profile[0]);
}

#[test]
fn few_samples_alone_are_the_first_of_many() {
    let settings = BandsSettings { samples: 16, ..small(1) };
    let (mut few, mut store) = (Bands::samples_only(&sheet(), settings).unwrap(), Cases::default());
    while let Some((index, job)) = few.next_job(&mut store) {
        assert_eq!(job.scenes.len(), 1);
        few.receive(index, evaluate(&job), &mut store);
    }
    assert_eq!((few.progress(), store.solved()), ((16, 16), 16));
    let mut many = Bands::new(&sheet(), small(1)).unwrap();
    run(&mut many, &mut store);
    assert_eq!((store.reused(), store.solved()), (16, many.progress().1));
    let strains = |bands: &Bands| bands.values().of(Quantity::GreatestStrain).collect::<Vec<_>>();
    assert_eq!(strains(&few), strains(&many)[..16]);
}

#[test]
fn samples_that_do_not_converge_are_counted() {
    let mut bands = Bands::new(&sheet(), small(1)).unwrap();
    let mut k = 0;
    run_with(&mut bands, &mut Cases::default(), |job| {
        let mut cases = linear(job);
        for case in &mut cases {
            k += 1;
            if k % 4 == 0 {
                case.status = Some(Status::NotConverged);
            }
        }
        cases
    });
    let counts = bands.counts();
    assert_eq!((counts["converged"], counts["not_converged"]), (24, 8));
}

#[test]
fn unknowns_that_do_not_apply_are_left_out() {
    let names = |scene: &Scene, settings: BandsSettings| -> Vec<&'static str> {
        let bands = Bands::new(scene, settings).unwrap();
        bands.unknowns().iter().map(|(unknown, _)| unknown.name()).collect()
    };
    assert_eq!(names(&sheet(), small(1)).len(), 8);
    let mut skin_only = sheet();
    skin_only.layers.truncate(1);
    let found = names(&skin_only, small(1));
    assert!(!found.contains(&"fat_modulus") && !found.contains(&"cover_thickness"));
    let mut without = small(1);
    without.unknowns.insert(Unknown::PoissonRatio, None);
    assert!(!names(&sheet(), without).contains(&"poisson_ratio"));
    // A measured pull replaces the spread of the strain scale by a factor on the measured scale.
    let mut measured = Scene::default();
    let pull =
        Measurements { base_width_mm: Some(120.0), skin_pull_mm: Some(30.0), ..Default::default() };
    measured.apply_patient(pull).unwrap();
    for (scene, wanted) in [(Scene::default(), (0.65, 1.9)), (measured, (1.0, 2.0))] {
        let spread = Unknown::SkinStrainScale.spread(&scene).unwrap();
        let Distribution::LogNormal { median, gsd } = spread.distribution else { panic!() };
        assert_eq!((median, gsd), wanted);
    }
}

#[test]
fn an_importance_from_too_few_samples_is_named() {
    let settings = BandsSettings { samples: 16, importance_rows: 16, ..small(1) };
    let mut bands = Bands::new(&sheet(), settings).unwrap();
    let (mut store, mut jobs) = (Cases::default(), 0);
    while let Some((index, job)) = bands.next_job(&mut store) {
        assert!(job.scenes.is_empty() || bands.report().remarks.is_empty());
        // The job of the first samples fails.
        bands.receive(index, if index == 0 { Vec::new() } else { evaluate(&job) }, &mut store);
        jobs += 1;
    }
    assert!(jobs > 1 && bands.is_done());
    let report = bands.report();
    assert_eq!(report.scenes_planned, 4 + 16);
    assert!(report.bands.iter().all(|band| band.importance.is_empty()));
    assert_eq!(report.remarks, ["No importance: samples with an answer: 12; an index needs 16."]);
}

#[test]
fn a_polynomial_stays_where_the_rows_tell_less() {
    let settings = BandsSettings { samples: 32, importance_rows: 16, ..small(1) };
    let mut bands = Bands::new(&sheet(), settings).unwrap();
    let mut solved = 0;
    run_with(&mut bands, &mut Cases::default(), |job| {
        solved += job.scenes.len();
        // The first of the samples fails, which is one of the rows: 15 rows give no index.
        let mut cases = evaluate(job);
        if let Some(case) = cases.get_mut(4).filter(|_| solved == 8) {
            case.status = Some(Status::NotConverged);
        }
        cases
    });
    let report = bands.report();
    let is_missed = |band: &&Band| band.importance_error.is_some_and(|error| error > 0.05);
    let missed: Vec<&Band> = report.bands.iter().filter(is_missed).collect();
    assert!(missed.iter().all(|band| band.importance.len() == report.unknowns.len()));
    let [line] = &report.remarks[..] else { panic!("{:?}", report.remarks) };
    let (why, names) = line.split_once(": ").unwrap();
    assert_eq!(
        why,
        "Importance from polynomials of the samples that miss more than 5 % of the variance, because 16 rows tell less"
    );
    let named = names.trim_end_matches('.').split(", ").map(|name| name.split(' ').next().unwrap());
    assert_eq!(
        named.collect::<Vec<_>>(),
        missed.iter().map(|b| b.quantity.name()).collect::<Vec<_>>()
    );
    assert!(!missed.is_empty());
}

#[test]
fn bad_choices_of_bands_are_one_line() {
    let error = |edit: &dyn Fn(&mut BandsSettings)| {
        let mut settings = small(1);
        edit(&mut settings);
        Bands::new(&sheet(), settings).unwrap_err().to_string()
    };
    assert_eq!(error(&|s| s.samples = 0), "samples is 0; allowed: 16 to 16384");
    assert!(error(&|s| s.samples = usize::MAX).contains("allowed: 16 to 16384"));
    assert!(
        error(&|s| s.importance_rows = 33).contains("importance_rows is 33; allowed: 0, 16 to 32")
    );
    assert!(
        error(&|s| s.grid = Some(MapSettings { nodes_per_side: 7, ..coarse() }))
            .contains("17 to 1025")
    );
    for distribution in [
        Distribution::Normal { mean: f64::NAN, sd: 1.0 },
        Distribution::Normal { mean: 1.0, sd: -1.0 },
        Distribution::Normal { mean: 1e308, sd: 1.0 },
        Distribution::LogNormal { median: 0.0, gsd: 2.0 },
        Distribution::LogNormal { median: 1.0, gsd: 0.5 },
        Distribution::Uniform { least: 2.0, most: 1.0 },
    ] {
        let line = error(&|s| _ = s.unknowns.insert(Unknown::FatModulus, Some(distribution)));
        assert!(line.starts_with("unknowns.fat_modulus is ") && !line.contains('\n'), "{line}");
    }
    let below = Distribution::Uniform { least: -5.0, most: 9.0 };
    let line = error(&|s| _ = s.unknowns.insert(Unknown::PoissonRatio, Some(below)));
    assert!(line.ends_with("allowed: uniform with 0 ≤ least ≤ most ≤ 0.5"), "{line}");
    let all_off = error(&|s| s.unknowns = Unknown::ALL.into_iter().map(|u| (u, None)).collect());
    assert_eq!(all_off, BandsError::NoUnknown.to_string());
    let mut bad = sheet();
    bad.insertion = f64::NAN;
    assert!(Bands::new(&bad, small(1)).unwrap_err().to_string().contains("insertion"));
}

#[test]
fn samples_are_equal_on_every_platform() {
    // The same bits in the browser: tests/wasm.rs.
    assert_eq!(samples::samples(), samples::SAMPLES);
}

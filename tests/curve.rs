//! The stress–strain curves: values, odd extension, smoothness, energy, rejected input.

#![allow(clippy::float_cmp)] // odd and even symmetry and stated ends hold to the last bit

use implant_preview::curve::{Curve, CurveSpec, Fat, Interpolation, SCALES, ScaledCurve, Section};

fn curve(spec: &CurveSpec) -> Curve {
    Curve::new(spec).expect("a good curve")
}

/// Builds a curve from the JSON of a scene file.
fn from_json(text: &str) -> Result<Curve, String> {
    let spec: CurveSpec = serde_json::from_str(text).map_err(|error| error.to_string())?;
    Curve::new(&spec).map_err(|error| error.to_string())
}

/// A curve of every kind, with its kinks.
fn every_kind() -> Vec<(&'static str, Curve, Vec<f64>)> {
    every_spec().into_iter().map(|(name, spec, kinks)| (name, curve(&spec), kinks)).collect()
}

/// A description of every kind, with its kinks.
fn every_spec() -> Vec<(&'static str, CurveSpec, Vec<f64>)> {
    let points = |interpolation| CurveSpec::Points {
        points: vec![[0.0, 0.0], [0.1, 1.0], [0.3, 1.5], [0.35, 9.0], [0.8, 9.5], [1.2, 30.0]],
        interpolation,
    };
    let sections = CurveSpec::Sections {
        sections: vec![
            Section::Linear { from: 0.0, to: 0.2, modulus_kpa: 5.0 },
            Section::Cubic { from: 0.2, to: 0.4, end_stress_kpa: 4.0, end_slope_kpa: 20.0 },
            Section::Polynomial { from: 0.4, to: 0.5, coefficients_kpa: vec![20.0, 3.0, 0.5, 9.0] },
            Section::Arctangent { from: 0.5, to: 0.7, scale_kpa: 2.0, rate: 10.0 },
            Section::Sine { from: 0.7, to: 0.9, scale_kpa: 3.0, rate: 6.0 },
            Section::Exponential { from: 0.9, to: 1.1, scale_kpa: 0.5, rate: 8.0 },
        ],
    };
    vec![
        ("skin", CurveSpec::Skin {}, vec![]),
        ("adipose", CurveSpec::Adipose {}, vec![]),
        ("fat", CurveSpec::Fat { variant: Fat::Mid }, vec![]),
        ("linear", CurveSpec::Linear { modulus_kpa: 7.0 }, vec![]),
        ("arctangent", CurveSpec::Arctangent { scale_kpa: 3.0, rate: 2.0 }, vec![]),
        ("exponential", CurveSpec::Exponential { scale_kpa: 2.0, rate: 4.0 }, vec![]),
        ("lines", points(Interpolation::Line), vec![0.1, 0.3, 0.35, 0.8]),
        ("spline", points(Interpolation::Spline), vec![]),
        ("sections", sections, vec![0.5, 0.7, 0.9]),
    ]
}

/// Strains within the data, beyond the data and in compression, none on a break.
fn strains() -> impl Iterator<Item = f64> {
    (-150..=150).map(|k| 0.01 * f64::from(k) + 0.0037)
}

fn assert_close(found: f64, wanted: f64, tolerance: f64, what: &str) {
    assert!(
        (found - wanted).abs() <= tolerance * wanted.abs().max(1.0),
        "{what}: {found} instead of {wanted}"
    );
}

#[test]
fn skin_preset_has_the_stated_values() {
    let skin = curve(&CurveSpec::Skin {});
    for (strain, stress, slope) in [
        (0.0, 0.0, 100.0),
        (0.2, 20.0, 100.0),
        (0.4, 40.0, 100.0),
        // The cubic Hermite piece at its middle: mean of the ends plus (difference of slopes)·0.3/8.
        (0.55, 122.5 - 900.0 * 0.3 / 8.0, 550.0),
        (0.7, 205.0, 1000.0),
        (1.0, 505.0, 1000.0),
    ] {
        assert_close(skin.stress(strain), stress, 1e-12, "stress");
        assert_close(skin.slope(strain), slope, 1e-12, "slope");
    }
}

#[test]
fn adipose_preset_has_the_stated_values() {
    let adipose = curve(&CurveSpec::Adipose {});
    assert_close(adipose.slope(0.0), 3.0, 1e-12, "initial modulus");
    for strain in [0.1, 0.6, 1.0] {
        assert_close(adipose.stress(strain), 0.4 * (7.5 * strain).atan(), 1e-14, "stress");
    }
    let rise = (adipose.stress(1.0) - adipose.stress(0.6)) / adipose.stress(1.0);
    assert!(rise < 0.1, "nearly flat beyond 0.6, yet it rises by {rise}");
}

/// Figures of the measurements: tangent 1.6 to 11.7 kPa up to 30 % (Alkhouli 2013), times 0.77 at rest.
#[test]
fn fat_preset_has_the_stated_values() {
    let fat = |variant| curve(&CurveSpec::Fat { variant });
    let mid = fat(Fat::Mid);
    let stated = [(0.1, 0.26), (0.2, 0.69), (0.3, 1.39), (0.4, 2.29), (0.6, 4.08), (1.0, 7.67)];
    for (strain, stress) in stated {
        assert!((mid.stress(strain) - stress).abs() < 0.006, "at {strain}");
    }
    for (variant, initial, end) in
        [(Fat::Low, 0.43 * 3.5, 4.3), (Fat::Mid, 2.0, 8.96), (Fat::High, 0.89 * 4.5, 15.4)]
    {
        let curve = fat(variant);
        assert_close(curve.slope(0.0), initial, 1e-12, "initial modulus");
        for strain in [0.3, 0.5, 1.0, 1.5] {
            assert!((curve.slope(strain) / end - 1.0).abs() < 0.01, "{variant:?} at {strain}");
        }
        assert_eq!((curve.measured_end(), curve.data_end()), (0.3, 1.0));
        let jump = curve.slope(0.3 - 1e-9) / curve.slope(0.3 + 1e-9) - 1.0;
        assert!(jump.abs() < 1e-7, "{variant:?}: the slope jumps by {jump:e}");
    }
    let scaled = ScaledCurve { strain_scale: 2.0, ..CurveSpec::Fat { variant: Fat::Mid }.into() };
    assert_eq!(Curve::scaled(&scaled).unwrap().measured_end(), 0.6);
}

#[test]
fn analytic_kinds_follow_their_formulas() {
    let exponential = curve(&CurveSpec::Exponential { scale_kpa: 2.0, rate: 4.0 });
    let arctangent = curve(&CurveSpec::Arctangent { scale_kpa: 3.0, rate: 2.0 });
    let linear = curve(&CurveSpec::Linear { modulus_kpa: 7.0 });
    for k in 0..=20 {
        let strain = 0.05 * f64::from(k);
        assert_close(exponential.stress(strain), 2.0 * ((4.0 * strain).exp() - 1.0), 1e-13, "exp");
        assert_close(arctangent.stress(strain), 3.0 * (2.0 * strain).atan(), 1e-14, "atan");
        assert_close(linear.stress(strain), 7.0 * strain, 1e-14, "linear");
    }
}

#[test]
fn the_knee_is_where_the_slope_has_doubled() {
    let knee = |json: &str| from_json(json).unwrap().knee();
    // Skin: slope 100 + 900 t with t = (ε − 0.4) / 0.3 beyond ε = 0.4.
    let skin = 0.4 + 0.3 / 9.0;
    assert_close(knee(r#"{ "kind": "skin" }"#).unwrap(), skin, 1e-9, "skin");
    let tight = ScaledCurve { spec: CurveSpec::Skin {}, strain_scale: 0.25, stress_scale: 3.0 };
    let tight = Curve::scaled(&tight).unwrap().knee();
    assert_close(tight.unwrap(), 0.25 * skin, 1e-9, "tight skin");
    let exponential = r#"{ "kind": "exponential", "scale_kpa": 2, "rate": 5 }"#;
    assert_close(knee(exponential).unwrap(), 2f64.ln() / 5.0, 1e-9, "exponential");
    for kind in [r#"{ "kind": "linear", "modulus_kpa": 10 }"#, r#"{ "kind": "adipose" }"#] {
        assert_eq!(knee(kind), None, "{kind}");
    }
    // A steep start is no knee: from 0.3 on the slope is 3 times that of the start, between it is less.
    let points = r#"{ "kind": "points", "points": [[0,0],[0.1,10],[0.2,15],[0.3,20],[0.4,50],[0.5,80]], "interpolation": "line" }"#;
    assert_close(knee(points).unwrap(), 0.3, 1e-9, "points");
}

#[test]
fn compression_is_the_odd_extension() {
    for (name, curve, _) in every_kind() {
        assert_eq!(curve.stress(0.0).abs(), 0.0, "{name}");
        for strain in strains() {
            assert_eq!(curve.stress(-strain), -curve.stress(strain), "{name} at {strain}");
            assert_eq!(curve.slope(-strain), curve.slope(strain), "{name} at {strain}");
            assert_eq!(curve.energy(-strain), curve.energy(strain), "{name} at {strain}");
        }
    }
}

#[test]
fn every_curve_increases_everywhere_also_beyond_its_data() {
    for (name, curve, _) in every_kind() {
        let mut before = curve.stress(-3.0);
        for k in -2999..=3000 {
            let strain = 0.001 * f64::from(k);
            let stress = curve.stress(strain);
            assert!(stress > before, "{name} falls at {strain}");
            before = stress;
        }
    }
}

#[test]
fn stress_is_continuous_and_the_slope_jumps_only_at_kinks() {
    for (name, curve, kinks) in every_kind() {
        for at in curve.breaks() {
            let step = 1e-9;
            let [below, above] = [at - step, at + step];
            let steepest = curve.slope(below).max(curve.slope(above));
            assert!(
                curve.stress(above) - curve.stress(below) <= 2.1 * step * steepest,
                "{name}: stress jumps at {at}"
            );
            let jump = (curve.slope(above) - curve.slope(below)).abs() / steepest;
            let is_kink = kinks.iter().any(|k| (k - at).abs() < 1e-12);
            assert_eq!(jump > 1e-4, is_kink, "{name}: slope jumps by {jump} at {at}");
        }
    }
}

#[test]
fn slope_is_the_derivative_of_stress() {
    for (name, curve, _) in every_kind() {
        for strain in strains() {
            let step = 1e-6;
            let difference =
                (curve.stress(strain + step) - curve.stress(strain - step)) / (2.0 * step);
            assert_close(curve.slope(strain), difference, 1e-5, name);
        }
    }
}

#[test]
fn energy_is_the_integral_of_stress() {
    for (name, curve, _) in every_kind() {
        for end in [0.05, 0.33, 0.62, 1.0, 1.3, 2.0] {
            // Midpoint rule between breaks: independent of the closed forms in the curve.
            let mut sum = 0.0;
            let mut from = 0.0;
            for to in curve.breaks().take_while(|&b| b < end).chain([end]) {
                let n = 4000;
                let width = (to - from) / f64::from(n);
                sum += (0..n)
                    .map(|k| width * curve.stress(from + (f64::from(k) + 0.5) * width))
                    .sum::<f64>();
                from = to;
            }
            assert_close(curve.energy(end), sum, 1e-5, name);
        }
    }
}

#[test]
fn secant_is_stress_over_strain_and_the_initial_slope_at_zero() {
    for (name, curve, _) in every_kind() {
        assert_close(curve.secant(0.0), curve.slope(0.0), 1e-12, name);
        assert_close(curve.secant(1e-10), curve.slope(0.0), 1e-6, name);
        assert_close(curve.secant(-0.5), curve.stress(0.5) / 0.5, 1e-12, name);
    }
}

#[test]
fn the_line_beyond_the_data_is_reported() {
    let points = from_json(r#"{"kind":"points","points":[[0,0],[0.2,1],[0.5,3]]}"#).unwrap();
    assert_eq!(points.data_end(), 0.5);
    assert!(!points.is_beyond_data(0.5) && !points.is_beyond_data(-0.5));
    assert!(points.is_beyond_data(0.51) && points.is_beyond_data(-0.51));
    assert_close(points.stress(0.8), 3.0 + 0.3 * 2.0 / 0.3, 1e-12, "line with the end slope");
}

#[test]
fn both_interpolations_pass_through_the_marked_points() {
    let marked = [[0.0, 0.0], [0.1, 1.0], [0.3, 1.5], [0.35, 9.0], [0.8, 9.5]];
    for interpolation in [Interpolation::Line, Interpolation::Spline] {
        let curve = curve(&CurveSpec::Points { points: marked.to_vec(), interpolation });
        for [strain, stress] in marked {
            assert_close(curve.stress(strain), stress, 1e-12, "marked point");
        }
    }
}

#[test]
fn spline_never_overshoots_its_points() {
    // A fixed family of rough data: steps of very different width and height.
    for seed in 0_u32..200 {
        let mut state = seed.wrapping_mul(2_654_435_761).wrapping_add(12345);
        let mut step = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            10.0_f64.powf(-2.0 * f64::from(state) / f64::from(u32::MAX))
        };
        let mut points = vec![[0.0, 0.0]];
        for _ in 0..8 {
            let [strain, stress] = points[points.len() - 1];
            points.push([strain + 0.2 * step(), stress + 50.0 * step()]);
        }
        let spline = curve(&CurveSpec::Points {
            points: points.clone(),
            interpolation: Interpolation::Spline,
        });
        for pair in points.windows(2) {
            let ([from, low], [to, high]) = (pair[0], pair[1]);
            let mut before = low;
            for k in 1..100 {
                let stress = spline.stress(from + (to - from) * f64::from(k) / 100.0);
                assert!(stress >= before - 1e-12 * high, "seed {seed}: falls after {from}");
                assert!(stress <= high * (1.0 + 1e-12), "seed {seed}: overshoots before {to}");
                before = stress;
            }
        }
    }
}

#[test]
fn stress_is_finite_for_every_finite_strain() {
    for (name, curve, _) in every_kind() {
        for strain in [-1e6, -10.0, 10.0, 1e6] {
            assert!(curve.stress(strain).is_finite(), "{name} at {strain}");
            assert!(curve.energy(strain).is_finite(), "{name} at {strain}");
        }
    }
}

#[test]
fn invalid_curves_are_rejected_with_the_point_or_field_named() {
    for (text, wanted) in [
        (r#"{"kind":"points","points":[[0,0],[0.3,2],[0.2,3]]}"#, "points[2] is [0.2, 3]"),
        (r#"{"kind":"points","points":[[0,0],[0.3,2],[0.4,2]]}"#, "points[2]"),
        (r#"{"kind":"points","points":[[0,0],[0.3,2],[0.3,3]]}"#, "points[2]"),
        (r#"{"kind":"points","points":[[0,0]]}"#, "points has 1"),
        (r#"{"kind":"points","points":[[0.1,0],[0.2,1]]}"#, "points[0]"),
        (r#"{"kind":"points","points":[[0,1],[0.2,2]]}"#, "must be [0, 0]"),
        (r#"{"kind":"points","points":[[0,0],[0.2,1,5]]}"#, "length"),
        (r#"{"kind":"points","points":[[0,0],[0.5,1e300]]}"#, "points[1]"),
        (r#"{"kind":"points","points":[[0,0],[1,1]],"interpolation":"cubic"}"#, "cubic"),
        (r#"{"kind":"linear","modulus_kpa":-1}"#, "modulus_kpa is -1"),
        (r#"{"kind":"linear"}"#, "modulus_kpa"),
        (r#"{"kind":"linear","modulus_kpa":1,"rate":2}"#, "rate"),
        (r#"{"kind":"arctangent","scale_kpa":1,"rate":0}"#, "rate is 0"),
        (r#"{"kind":"exponential","scale_kpa":1,"rate":101}"#, "rate is 101"),
        (r#"{"kind":"exponential","scale_kpa":1,"rate":100}"#, "end of the curve"),
        (r#"{"kind":"sections","sections":[]}"#, "sections has 0"),
        (
            r#"{"kind":"sections","sections":[{"kind":"linear","from":0.1,"to":1,"modulus_kpa":1}]}"#,
            "sections[0] starts at strain 0.1",
        ),
        (
            r#"{"kind":"sections","sections":[{"kind":"sine","from":0,"to":1,"scale_kpa":1,"rate":2}]}"#,
            "sections[0] does not increase",
        ),
        (
            r#"{"kind":"sections","sections":[{"kind":"linear","from":0,"to":0.5,"modulus_kpa":9},
               {"kind":"cubic","from":0.5,"to":1,"end_stress_kpa":4,"end_slope_kpa":9}]}"#,
            "sections[1] does not increase",
        ),
        (
            r#"{"kind":"sections","sections":[
               {"kind":"polynomial","from":0,"to":1,"coefficients_kpa":[1,-4,4.1]}]}"#,
            "sections[0] does not increase",
        ),
        (r#"{"kind":"steel"}"#, "steel"),
    ] {
        let message = from_json(text).expect_err(text);
        assert!(message.contains(wanted), "{text}\n gave: {message}\n wanted: {wanted}");
    }
}

#[test]
fn nan_is_rejected_although_json_cannot_contain_nan() {
    let points = vec![[0.0, 0.0], [0.1, f64::NAN]];
    let spec = CurveSpec::Points { points, interpolation: Interpolation::Spline };
    assert!(Curve::new(&spec).expect_err("NaN").to_string().contains("points[1]"));
    let spec = CurveSpec::Linear { modulus_kpa: f64::NAN };
    assert!(Curve::new(&spec).expect_err("NaN").to_string().contains("modulus_kpa"));
}

#[test]
fn a_hundred_thousand_points_are_accepted_and_one_more_is_not() {
    let line = |n: u32| CurveSpec::Points {
        points: (0..n).map(|k| [1e-5 * f64::from(k), 1e-3 * f64::from(k)]).collect(),
        interpolation: Interpolation::Spline,
    };
    let curve = curve(&line(100_000));
    assert_close(curve.stress(0.654_321), 65.4321, 1e-9, "line of slope 100");
    assert!(Curve::new(&line(100_001)).is_err());
}

#[test]
fn a_scaled_curve_is_the_analytic_scaling_of_every_kind() {
    for (name, spec, _) in every_spec() {
        let plain = curve(&spec);
        for (strain_scale, stress_scale) in [
            (1.0, 1.0),
            (0.5, 1.0),
            (1.0, 2.5),
            (1.7, 0.4),
            (0.25, 1.3),
            (20.0, 0.05),
            (0.05, 20.0),
        ] {
            let scaled =
                Curve::scaled(&ScaledCurve { spec: spec.clone(), strain_scale, stress_scale })
                    .unwrap_or_else(|error| panic!("{name}: {error}"));
            for strain in strains() {
                let at = strain * strain_scale;
                let modulus_scale = stress_scale / strain_scale;
                for (what, found, wanted) in [
                    ("stress", scaled.stress(at), stress_scale * plain.stress(strain)),
                    ("slope", scaled.slope(at), modulus_scale * plain.slope(strain)),
                    ("secant", scaled.secant(at), modulus_scale * plain.secant(strain)),
                    (
                        "energy",
                        scaled.energy(at),
                        stress_scale * strain_scale * plain.energy(strain),
                    ),
                ] {
                    let error = (found - wanted).abs();
                    assert!(
                        error <= 1e-12 * wanted.abs(),
                        "{name}, {strain_scale}, {stress_scale}: {what} at {at}: {found}, {wanted}"
                    );
                }
                assert_eq!(scaled.is_beyond_data(at), plain.is_beyond_data(strain), "{name}");
            }
            assert_close(scaled.data_end(), strain_scale * plain.data_end(), 1e-15, "data");
            assert_close(scaled.line_start(), strain_scale * plain.line_start(), 1e-15, "line");
            for (found, wanted) in scaled.breaks().zip(plain.breaks()) {
                assert_close(found, strain_scale * wanted, 1e-15, "break");
            }
            assert_eq!(scaled.breaks().count(), plain.breaks().count());
        }
    }
}

#[test]
fn scales_of_one_change_no_bit_and_are_not_written() {
    for (name, spec, _) in every_spec() {
        let scaled = ScaledCurve::from(spec.clone());
        assert_eq!(Curve::scaled(&scaled).unwrap(), curve(&spec), "{name}");
        let json = serde_json::to_string(&scaled).unwrap();
        assert_eq!(json, serde_json::to_string(&spec).unwrap(), "{name}");
        let read: ScaledCurve = serde_json::from_str(&json).unwrap();
        assert_eq!(read, scaled, "{name}");
        let scaled = ScaledCurve { strain_scale: 0.7, stress_scale: 1.3, ..scaled };
        let json = serde_json::to_string(&scaled).unwrap();
        assert!(json.ends_with(r#","strain_scale":0.7,"stress_scale":1.3}"#), "{json}");
        let read: ScaledCurve = serde_json::from_str(&json).unwrap();
        assert_eq!(read, scaled, "{name}");
    }
}

#[test]
fn invalid_scales_are_rejected_with_the_field_named() {
    let scaled = |json: &str| {
        let curve: ScaledCurve = serde_json::from_str(json).map_err(|error| error.to_string())?;
        Curve::scaled(&curve).map_err(|error| error.to_string())
    };
    let (least, most) = SCALES;
    for scale in ["strain_scale", "stress_scale"] {
        for value in [0.0, -1.0, 0.999 * least, 1.001 * most, 1e308] {
            let message = scaled(&format!(r#"{{"kind":"skin","{scale}":{value}}}"#)).unwrap_err();
            assert!(message.starts_with(&format!("{scale} is ")), "{message}");
            assert!(message.ends_with("allowed: 0.05 to 20"), "{message}");
        }
        assert!(
            scaled(&format!(r#"{{"kind":"skin","{scale}":"1"}}"#)).unwrap_err().contains("string")
        );
        let nan = ScaledCurve { strain_scale: f64::NAN, ..CurveSpec::Skin {}.into() };
        assert!(Curve::scaled(&nan).is_err());
        // A curve without a scene has no scale in its description.
        let message = from_json(&format!(r#"{{"kind":"skin","{scale}":1}}"#)).unwrap_err();
        assert!(message.contains(scale), "{message}");
    }
    for (json, wanted) in [
        (
            r#"{"kind":"linear","modulus_kpa":1e7,"stress_scale":2}"#,
            "stress at the end of the scaled curve (kPa) is 2e7; allowed: 1e-6 to 1e7 kPa",
        ),
        (
            r#"{"kind":"points","points":[[0,0],[1e-9,1e-3],[0.5,1]],"strain_scale":0.5}"#,
            "strain_scale is 0.5; allowed: scaled strains 1e-9 apart or more",
        ),
    ] {
        assert_eq!(scaled(json).unwrap_err(), wanted);
    }
}

//! What a hand measures and what it becomes: the rules with their published numbers, sizes, and the patient of a scene.

#![allow(clippy::float_cmp, reason = "stated values hold to the last bit")]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::clinical::spread::{self, Distribution};
use implant_preview::clinical::{
    ClinicalError, Dimension, Expander, Measurements, PracticeTable, ProfileClass, Size, SkinClass,
    cover, limits, pull_strain_scale, strain_scale_of_class, strain_scale_of_pull, typical_sizes,
};
use implant_preview::measure::PatientValue;
use implant_preview::scene::{self, ChestShape, Scene};
use implant_preview::simulate::simulate;
use serde_json::{Value, json};

#[path = "clinical/patient.rs"]
mod patient;

fn assert_close(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance * wanted.abs(), "{found} instead of {wanted}");
}

#[test]
fn half_the_pinch_is_the_cover_within_a_factor_of_1_3() {
    let cover = cover(20.0).unwrap();
    assert_eq!((cover.whole.value, cover.skin.value, cover.fat.value), (10.0, 1.5, 8.5));
    assert_eq!(cover.fat.measured, "pinch 20 mm");
    let (least, most) = cover.whole.range(1.0);
    assert_close(least, 10.0 / 1.3, 1e-12);
    assert_close(most, 13.0, 1e-12);
    // The cover of a pinch of 2 cm within two standard deviations: 6 to 17 mm.
    let (least, most) = cover.whole.range(2.0);
    assert_eq!((least.round(), most.round()), (6.0, 17.0));
    // The fat is what the skin leaves of the cover.
    let (least, most) = cover.fat.range(1.0);
    assert_close(least, 10.0 / 1.3 - 1.5, 1e-12);
    assert_close(most, 11.5, 1e-12);
    assert_eq!(cover.skin.range(1.0), (1.25, 1.75));
}

#[test]
fn ranges_never_fall_below_zero() {
    let cover = cover(4.0).unwrap();
    assert_eq!((cover.whole.value, cover.fat.value), (2.0, 0.5));
    assert_eq!(cover.fat.range(2.0).0, 0.0);
    assert_eq!(cover.skin.range(7.0).0, 0.0);
}

#[test]
fn classes_of_the_skin_have_their_limits_and_strain_scales() {
    for (pull, class, word, scale) in [
        (19.9, SkinClass::Tight, "tight", 0.25),
        (20.0, SkinClass::Normal, "normal", 0.5),
        (30.0, SkinClass::Normal, "normal", 0.5),
        (30.1, SkinClass::Lax, "lax", 1.0),
        (40.0, SkinClass::Lax, "lax", 1.0),
        (40.1, SkinClass::VeryLax, "very lax", 1.7),
    ] {
        assert_eq!(SkinClass::of_pull(pull), Ok(class), "{pull}");
        let derived = strain_scale_of_class(class, 0.0).unwrap();
        assert_eq!((derived.value, derived.word), (scale, Some(word)));
        assert_eq!(derived.range(1.0), (scale / 2.0, scale * 2.0));
    }
}

#[test]
fn a_pull_of_30_mm_gives_the_stated_strain_scales() {
    for (width, scale) in [(100.0, 1.15), (120.0, 0.71), (140.0, 0.47)] {
        let derived = strain_scale_of_pull(30.0, width, 0.0).unwrap();
        assert_eq!((100.0 * derived.value).round() / 100.0, scale, "base width {width}");
        assert_eq!(derived.word, Some("normal"));
        assert_close(derived.range(1.0).1, 2.0 * derived.value, 1e-12);
        assert_close(derived.range(1.0).0, 0.5 * derived.value, 1e-12);
    }
}

#[test]
fn at_a_base_width_of_120_mm_the_strain_scale_is_a_power_of_the_pull() {
    for pull in 15..=48 {
        let pull = f64::from(pull);
        assert_close(pull_strain_scale(pull, 120.0, 0.0), (pull / 35.0).powf(2.4), 0.04);
    }
}

#[test]
fn the_strain_scale_increases_with_the_pull_and_decreases_with_the_base_width() {
    for width in [60.0, 90.0, 120.0, 160.0, 240.0] {
        let scales: Vec<f64> =
            (5..=80).map(|pull| pull_strain_scale(f64::from(pull), width, 0.0)).collect();
        assert!(scales.windows(2).all(|pair| pair[0] < pair[1]), "{width}");
        assert!(
            pull_strain_scale(30.0, width, 0.0) > pull_strain_scale(30.0, width + 0.1, 0.0)
                || width >= 240.0
        );
    }
}

#[test]
fn measurements_out_of_range_are_rejected_in_one_line() {
    let error = |result: Result<_, ClinicalError>| match result {
        Err(error) => error.to_string(),
        Ok(value) => panic!("{value:?}"),
    };
    for (pinch, wanted) in [
        (3.9, "the pinch is 3.9 mm; allowed: 4 to 120 mm"),
        (500.0, "the pinch is 500 mm; allowed: 4 to 120 mm"),
        (1e308, "the pinch is 1e308 mm; allowed: 4 to 120 mm"),
        (f64::NAN, "the pinch is NaN mm; allowed: 4 to 120 mm"),
    ] {
        assert_eq!(error(cover(pinch).map(|cover| cover.whole)), wanted);
    }
    let pull = |pull, width| error(strain_scale_of_pull(pull, width, 0.0));
    assert_eq!(pull(4.0, 120.0), "the pull of the skin is 4 mm; allowed: 5 to 80 mm");
    assert_eq!(pull(f64::INFINITY, 120.0), "the pull of the skin is inf mm; allowed: 5 to 80 mm");
    assert_eq!(pull(30.0, 12.0), "the base width is 12 mm; allowed: 60 to 240 mm");
    assert_eq!(
        pull(10.0, 120.0),
        "skin pull 10 mm, base width 120 mm gives a strain scale of 0.0479; allowed: 0.05 to 20"
    );
    assert!(
        pull_strain_scale(f64::NAN, 120.0, 0.0).is_nan()
            && pull_strain_scale(30.0, 10.0, 0.0).is_nan()
    );
}

#[test]
fn spreads_between_people_are_the_stated_ones() {
    for (spread, wanted) in [
        (spread::SKIN_THICKNESS, Distribution::Normal { mean: 1.55, sd: 0.25 }),
        (spread::SKIN_STRESS_SCALE, Distribution::LogNormal { median: 1.0, gsd: 1.3 }),
        (spread::SKIN_STRAIN_SCALE, Distribution::LogNormal { median: 0.65, gsd: 1.9 }),
        (spread::SKIN_STRAIN_SCALE_MEASURED, Distribution::LogNormal { median: 1.0, gsd: 2.0 }),
        (spread::FAT_STRESS_SCALE, Distribution::LogNormal { median: 1.0, gsd: 1.6 }),
        (spread::FAT_POISSON_RATIO, Distribution::Uniform { least: 0.48, most: 0.495 }),
        (spread::FAT_MODULUS, Distribution::LogNormal { median: 4.0, gsd: 1.8 }),
        (spread::COVER_THICKNESS, Distribution::LogNormal { median: 1.0, gsd: 1.3 }),
        (spread::POCKET_RADIUS, Distribution::Normal { mean: 0.0, sd: 2.5 }),
        (spread::PROJECTION, Distribution::Normal { mean: -0.035, sd: 0.03 }),
        (spread::POISSON_RATIO, Distribution::Uniform { least: 0.45, most: 0.49 }),
    ] {
        assert_eq!(spread.distribution, wanted, "{}", spread.quantity);
        let (least, most) = wanted.range();
        assert!(least < wanted.median() && wanted.median() < most);
    }
    assert_eq!(spread::METHOD_SCALES, [0.4, 1.0, 2.5]);
}

#[test]
fn any_two_dimensions_give_the_third() {
    for width in [78.0, 100.0, 120.0, 180.0] {
        for projection in [20.0, 39.8, 75.0] {
            let size = Size::of_width_and_projection(width, projection).unwrap();
            let volume = size.volume_ml();
            let wanted =
                2.0 / 3.0 * std::f64::consts::PI * (width / 2.0).powi(2) * projection / 1e3;
            assert_close(volume, wanted, 1e-14);
            let by_volume = Size::of_width_and_volume(width, volume).unwrap();
            assert_close(by_volume.projection_mm(), projection, 1e-13);
            let flat = Size::of_width_and_volume(240.0, volume).unwrap();
            let by_projection = flat.changed(Dimension::Projection, projection, Dimension::Volume);
            assert_close(by_projection.unwrap().base_width_mm(), width, 1e-13);
        }
    }
    // 12 cm and 300 ml.
    let size = Size::of_width_and_volume(120.0, 300.0).unwrap();
    assert_eq!((10.0 * size.projection_cm()).round(), 40.0);
    assert_eq!(size.profile(), ProfileClass::Moderate);
    // 30 ml, the step of the rule for the pull, is 4 mm of projection.
    let larger = Size::of_width_and_volume(120.0, 330.0).unwrap();
    assert_close(larger.projection_mm() - size.projection_mm(), 4.0, 0.01);
}

#[test]
fn a_changed_dimension_keeps_the_locked_one() {
    use Dimension::{BaseWidth, Projection, Volume};
    let size = Size::of_width_and_volume(120.0, 300.0).unwrap();
    let value = |size: Size, dimension| match dimension {
        BaseWidth => size.base_width_mm(),
        Projection => size.projection_mm(),
        Volume => size.volume_ml(),
    };
    for changed in [BaseWidth, Projection, Volume] {
        for locked in [BaseWidth, Projection, Volume] {
            let new = 1.1 * value(size, changed);
            let after = size.changed(changed, new, locked).unwrap();
            assert_close(value(after, changed), new, 1e-13);
            if locked != changed {
                assert_close(value(after, locked), value(size, locked), 1e-13);
            }
        }
    }
}

#[test]
fn sizes_out_of_range_are_rejected_in_one_line() {
    let error = |result: Result<Size, ClinicalError>| result.map(|_| ()).unwrap_err().to_string();
    let size = Size::of_width_and_volume(120.0, 300.0).unwrap();
    for (found, wanted) in [
        (
            error(Size::of_width_and_projection(300.0, 40.0)),
            "the base width is 300 mm; allowed: 20 to 240 mm",
        ),
        (
            error(Size::of_width_and_projection(120.0, f64::NAN)),
            "the projection is NaN mm; allowed: 2 to 120 mm",
        ),
        (
            error(Size::of_width_and_volume(60.0, 400.0)),
            "400 ml on a base of 60 mm gives a projection of 212 mm; allowed: 2 to 120 mm",
        ),
        (
            error(size.changed(Dimension::Projection, 4.0, Dimension::Volume)),
            "300 ml at a projection of 4 mm gives a base width of 378 mm; allowed: 20 to 240 mm",
        ),
        (
            error(Size::of_width_and_volume(120.0, -300.0)),
            "the volume is -300 ml; allowed: 0.3 to 4350 ml",
        ),
        (
            error(Size::of_width_and_volume(120.0, 1e308)),
            "the volume is 1e308 ml; allowed: 0.3 to 4350 ml",
        ),
    ] {
        assert_eq!(found, wanted);
    }
}

#[test]
fn profile_classes_follow_projection_over_half_the_base_width() {
    for (ratio, class) in [
        (0.39, ProfileClass::Low),
        (0.499, ProfileClass::Low),
        (0.5, ProfileClass::Moderate),
        // What makers sell as moderate plus: 4.0 cm on 12 cm; and as high: 4.5 cm on 11.1 cm.
        (4.0 / 6.0, ProfileClass::Moderate),
        (0.72, ProfileClass::High),
        (4.5 / 5.55, ProfileClass::High),
        (0.95, ProfileClass::HalfSphere),
        (1.07, ProfileClass::HalfSphere),
    ] {
        assert_eq!(ProfileClass::of_ratio(ratio), class);
    }
    for class in ProfileClass::ALL {
        assert_eq!(ProfileClass::of_ratio(class.ratio()), class);
        let (least, most) = limits::TYPICAL_RATIO;
        assert!((least..=most).contains(&class.ratio()));
    }
}

#[test]
fn the_table_of_typical_sizes_covers_the_range_of_round_implants() {
    let sizes = typical_sizes();
    assert!(sizes.len() > 40, "{}", sizes.len());
    assert!(sizes.iter().all(|size| size.is_typical()));
    let range = |value: fn(Size) -> f64| {
        let values = sizes.iter().map(|size| value(*size));
        (values.clone().fold(f64::MAX, f64::min), values.fold(f64::MIN, f64::max))
    };
    assert_eq!(range(Size::base_width_mm), (78.0, 180.0));
    let (least, most) = range(Size::projection_mm);
    assert!(least <= 22.0 && most >= 70.0, "{least} {most}");
    let (least, most) = range(Size::volume_ml);
    assert!(least <= 110.0 && most >= 880.0, "{least} {most}");
    for class in ProfileClass::ALL {
        assert!(sizes.iter().any(|size| size.profile() == class), "{}", class.word());
    }
    let order = |size: &Size| (size.base_width_mm(), size.projection_mm());
    assert!(sizes.windows(2).all(|pair| order(&pair[0]) < order(&pair[1])));
    // The limits of a scene are those of a size.
    let (least, most) = scene::Field::BaseRadius.limits;
    assert_eq!(limits::BASE_WIDTH_MM, (2.0 * least, 2.0 * most));
    assert_eq!(limits::PROJECTION_MM, scene::Field::Projection.limits);
}

#[test]
fn an_expander_rises_in_proportion_to_its_fill() {
    let expander = Expander::new(120.0).unwrap();
    let domes = expander.filling(400.0, 8).unwrap();
    assert_eq!(domes.len(), 8);
    for (k, dome) in domes.iter().enumerate() {
        assert_eq!(dome.base_width_mm(), 120.0);
        assert_close(dome.volume_ml(), 50.0 * (k + 1) as f64, 1e-13);
        assert_close(dome.projection_mm(), (k + 1) as f64 * domes[0].projection_mm(), 1e-12);
    }
    let (least, most) = expander.fills_ml();
    assert_close(expander.dome(least).unwrap().projection_mm(), 2.0, 1e-12);
    assert_close(expander.dome(most).unwrap().projection_mm(), 120.0, 1e-12);
    // A fill below the least dome is left out; too large a fill is one line.
    assert_eq!(expander.filling(400.0, 40).unwrap().len(), 39);
    let error = expander.filling(2000.0, 4).unwrap_err().to_string();
    assert_eq!(
        error,
        "2000 ml on a base of 120 mm gives a projection of 265 mm; allowed: 2 to 120 mm"
    );
}

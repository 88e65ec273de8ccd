//! The shape of the implant: round, or anatomical, with a height of its own and a lower apex; sizes keep its proportions.

use super::{Choices, Hand, cm, mm, plain, row};
use crate::app::texts::tr;
use crate::app::widgets::Control;
use crate::app::widgets::quantity::{format_at_most, significant};
use crate::clinical::{Dimension, Size, limits};
use crate::scene::{self, Field, Implant, Scene};
use eframe::egui::Ui;

/// Height by width of the base of an implant that becomes anatomical \[-\]. An anatomical implant of 370 ml is 12.5 cm wide, 10.9 cm
/// high and projects by 5.3 cm (R. Baxter, *When to use form-stable anatomic implants*, drbaxter.com): 0.87, and ⅔πabp is 378 ml.
const ASPECT: f64 = 0.9;
/// Way of its apex \[height of the base\]: two fifths of the height are below the apex. A convention of this program.
const SHIFT: f64 = 0.1;

/// The shapes: words and meaning.
pub(super) const CHOICES: [(&str, &str); 2] = [
    ("round", "A round implant of fixed size"),
    (
        "anatomical",
        "An anatomical implant of fixed size: its base has a height of its own, and its apex is lower",
    ),
];

/// Is the implant anatomical? One of equal width and height is, while it is being edited.
pub(crate) fn is_anatomical(implant: &Implant) -> bool {
    implant.base_height_mm.is_some() || !implant.is_round()
}

/// The word of the implant's shape.
pub(super) fn choice(scene: &Scene) -> &'static str {
    CHOICES[usize::from(is_anatomical(&scene.implant))].0
}

/// The shape of a scene's implant in a few words.
pub(crate) fn shape_in_words(scene: &Scene) -> String {
    let implant = &scene.implant;
    if implant.is_round() {
        return tr("round").to_owned();
    }
    let words = |mm: f64| format_at_most(cm(mm), 0, 1);
    let (height, way) = (words(implant.base_height()), words(implant.apex_shift_mm.abs()));
    match implant.apex_shift_mm {
        lower if lower > 0.0 => {
            tr!("anatomical, {height} cm high, apex {way} cm lower", height, way)
        }
        higher if higher < 0.0 => {
            tr!("anatomical, {height} cm high, apex {way} cm higher", height, way)
        }
        _ => tr!("anatomical, {height} cm high", height),
    }
}

/// The way of the apex of an anatomical implant whose maker lists its height alone \[mm\].
pub(crate) fn usual_apex(height_mm: f64) -> f64 {
    (SHIFT * height_mm).round()
}

/// Sets the size of the implant. The pocket keeps its margin around the implant.
pub(super) fn set_size(scene: &mut Scene, size: Size) {
    let radius = 0.5 * size.base_width_mm();
    let before = scene.implant;
    scene.implant.projection_mm = size.projection_mm();
    if size.fullness().to_bits() != before.fullness().to_bits() {
        plain::set(scene, Field::Fullness, size.fullness());
    }
    if radius.to_bits() != before.base_radius_mm.to_bits() {
        scene.implant.set_base_radius(radius);
    }
    if size.aspect().to_bits() != before.size().map_or(1.0, Size::aspect).to_bits() {
        scene.implant.base_height_mm = Some(significant(size.base_height_mm()));
    }
    let (before, after) = (before.greatest_half_axis_mm(), scene.implant.greatest_half_axis_mm());
    if before.to_bits() != after.to_bits() {
        let pocket = significant(scene.pocket_radius_mm - before + after);
        scene.set_pocket_radius(pocket.min(scene::limits::POCKET_RADIUS_MAX_MM));
    }
}

/// Makes the implant round or anatomical. The width stays, and the volume unless that follows.
pub(super) fn set_anatomical(scene: &mut Scene, choices: &Choices, is_wanted: bool) {
    let Ok(size) = scene.implant.size() else { return };
    if is_anatomical(&scene.implant) == is_wanted {
        return;
    }
    let width = size.base_width_mm();
    let (least, most) = Field::BaseHeight.range(scene);
    let height = if is_wanted { (ASPECT * width).round().clamp(least, most) } else { width };
    let follows = match choices.follows {
        Dimension::Volume => Dimension::Volume,
        _ => Dimension::Projection,
    };
    // Without a projection of this volume the projection stays.
    let aspect = height / width;
    set_size(scene, size.with_base_height(height, follows).unwrap_or(size.with_aspect(aspect)));
    scene.implant.base_height_mm = is_wanted.then_some(height);
    scene.implant.apex_shift_mm = if is_wanted { usual_apex(height) } else { 0.0 };
}

/// Makes the implant half of an ellipsoid, as the shell of an expander is at every fill: width and volume stay, or the projection where none has
/// this volume.
pub(super) fn make_half_ellipsoid(scene: &mut Scene) {
    let Ok(size) = scene.implant.size() else { return };
    let width = size.base_width_mm();
    let half = Size::of_width_and_volume(width, size.volume_ml())
        .or_else(|_| Size::of_width_and_projection(width, size.projection_mm()));
    if let Ok(half) = half
        && scene.implant.fullness.is_some()
    {
        set_size(scene, half);
    }
}

/// Shows the height of an anatomical base.
pub(super) fn height_row(ui: &mut Ui, scene: &mut Scene, choices: &Choices, hand: Hand, room: f32) {
    let Some((control, mut value)) = height(scene, choices) else { return };
    if row(ui, hand, control, &mut value, (room, |_: &mut Ui| {})).is_changed {
        set_height(scene, choices, value);
    }
}

/// Shows the way of an anatomical implant's apex.
pub(super) fn apex_row(ui: &mut Ui, scene: &mut Scene, hand: Hand, room: f32) {
    let Some((control, mut value)) = apex(scene) else { return };
    if row(ui, hand, control, &mut value, (room, |_: &mut Ui| {})).is_changed {
        set_apex(scene, value);
    }
}

/// The control of the height, and the height \[cm\]; `None` for a round implant.
pub(super) fn height(scene: &Scene, choices: &Choices) -> Option<(Control<'static>, f64)> {
    let size = scene.implant.size().ok().filter(|_| is_anatomical(&scene.implant))?;
    let (least, most) = heights(scene, size, choices.follows);
    let value = cm(size.base_height_mm());
    // A displayed limit is itself allowed: whole millimetres.
    let (least, most) = (cm((least - 1e-6).ceil()), cm((most + 1e-6).floor()));
    let control = Control {
        range: 6.0..=20.0,
        allowed: Some(least.min(value)..=most.max(value)),
        limit_reason: tr("half to twice the width, within the limits of the value that follows")
            .to_owned(),
        reset: cm((ASPECT * size.base_width_mm()).round()),
        ..Control::of(Field::BaseHeight)
    };
    Some((control, value))
}

/// Heights of the base \[mm\] whose following dimension is in its limits.
fn heights(scene: &Scene, size: Size, follows: Dimension) -> (f64, f64) {
    let (height, width) = (size.base_height_mm(), size.base_width_mm());
    let field = Field::BaseHeight;
    let (mut least, mut most) = field.range(scene);
    match follows {
        Dimension::Volume => {}
        Dimension::Projection => {
            let (low, high) = limits::PROJECTION_MM;
            least = least.max(height * size.projection_mm() / high);
            most = most.min(height * size.projection_mm() / low);
        }
        Dimension::BaseWidth => {
            // Width times height stays, and the aspect grows with the square of the height.
            let ((low, high), (lowest, highest)) = (limits::BASE_WIDTH_MM, field.limits);
            least = (least * height).sqrt().max(width * height / high).max(lowest);
            most = (most * height).sqrt().min(width * height / low).min(highest);
        }
    }
    (least, most)
}

/// Sets the height \[cm\]; the dimension that follows changes.
pub(super) fn set_height(scene: &mut Scene, choices: &Choices, height: f64) {
    let size = scene.implant.size().and_then(|s| s.with_base_height(mm(height), choices.follows));
    if let Ok(size) = size {
        set_size(scene, size);
        Field::ApexShift.set(scene, 0, scene.implant.apex_shift_mm);
    }
}

/// The control of the way of the apex, and the way \[cm\]; `None` for a round implant.
pub(super) fn apex(scene: &Scene) -> Option<(Control<'static>, f64)> {
    let implant = Some(&scene.implant).filter(|implant| is_anatomical(implant))?;
    let (_, most) = Field::ApexShift.range(scene);
    let most = cm((10.0 * most + 1e-6).floor() / 10.0);
    let value = cm(implant.apex_shift_mm);
    let control = Control {
        range: 0.0..=4.0,
        allowed: Some((-most).min(value)..=most.max(value)),
        limit_reason: tr("the apex stays over the base").to_owned(),
        reset: cm((SHIFT * implant.base_height()).round()),
        most_decimals: 2,
        ..Control::of(Field::ApexShift)
    };
    Some((control, value))
}

/// Sets the way of the apex \[cm\].
pub(super) fn set_apex(scene: &mut Scene, way: f64) {
    Field::ApexShift.set(scene, 0, mm(way));
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "stated values hold to the last bit")]
mod tests {
    use super::*;

    fn volume(scene: &Scene) -> f64 {
        scene.implant.size().unwrap().volume_ml()
    }

    #[test]
    fn a_wider_implant_keeps_the_margin_of_its_pocket_and_an_equal_size_every_bit() {
        let mut scene = Scene::opening();
        let before = scene.clone();
        let size = scene.implant.size().unwrap();
        set_size(&mut scene, size);
        assert_eq!(scene, before);
        set_size(&mut scene, size.changed(Dimension::BaseWidth, 130.0, Dimension::Volume).unwrap());
        assert_eq!((scene.implant.base_radius_mm, scene.pocket_radius_mm), (65.0, 75.0));
        assert_eq!(scene.body.patch_radius_mm, 135.0);
    }

    #[test]
    fn an_anatomical_implant_has_a_height_and_a_lower_apex_and_a_round_one_neither() {
        let (mut scene, choices) = (Scene::opening(), Choices::default());
        let before = scene.clone();
        set_anatomical(&mut scene, &choices, true);
        assert_eq!(
            (scene.implant.base_height_mm, scene.implant.apex_shift_mm),
            (Some(108.0), 11.0)
        );
        assert_eq!(shape_in_words(&scene), "anatomical, 10.8 cm high, apex 1.1 cm lower");
        assert_eq!((choice(&scene), scene.validate()), ("anatomical", Ok(())));
        // The projection follows: width, volume and pocket stay.
        assert!((volume(&scene) - volume(&before)).abs() < 1e-9);
        assert!((scene.implant.projection_mm - before.implant.projection_mm / 0.9).abs() < 1e-9);
        assert_eq!(scene.pocket_radius_mm, before.pocket_radius_mm);
        set_anatomical(&mut scene, &choices, false);
        assert_eq!((scene.implant.base_height_mm, scene.implant.apex_shift_mm), (None, 0.0));
        assert!((scene.implant.projection_mm - before.implant.projection_mm).abs() < 1e-9);
        assert!(height(&scene, &choices).is_none() && apex(&scene).is_none());
    }

    #[test]
    fn a_height_changes_what_follows_and_keeps_the_margin_of_the_pocket() {
        let of = |follows, height| {
            let (mut scene, choices) =
                (Scene::opening(), Choices { follows, ..Choices::default() });
            set_anatomical(&mut scene, &choices, true);
            let before = scene.clone();
            set_height(&mut scene, &choices, height);
            (before, scene)
        };
        let (before, tall) = of(Dimension::Volume, 14.0);
        assert!((volume(&tall) / volume(&before) - 140.0 / 108.0).abs() < 1e-12);
        assert_eq!(tall.implant.base_height_mm, Some(140.0));
        assert_eq!(tall.pocket_radius_mm - 70.0, before.pocket_radius_mm - 60.0);
        let (before, tall) = of(Dimension::Projection, 14.0);
        assert!((volume(&tall) - volume(&before)).abs() < 1e-9);
        assert_eq!(tall.implant.base_radius_mm, 60.0);
        let (before, tall) = of(Dimension::BaseWidth, 12.0);
        assert!((volume(&tall) - volume(&before)).abs() < 1e-9);
        assert_eq!(tall.implant.projection_mm, before.implant.projection_mm);
        assert!((2.0 * tall.implant.base_radius_mm - 108.0).abs() < 1e-9);
        // A height equal to the width is still a height.
        let (_, equal) = of(Dimension::Projection, 12.0);
        assert!(is_anatomical(&Implant { apex_shift_mm: 0.0, ..equal.implant }));
    }

    #[test]
    fn every_allowed_end_is_a_valid_scene() {
        for follows in [Dimension::BaseWidth, Dimension::Volume, Dimension::Projection] {
            let (mut scene, choices) =
                (Scene::opening(), Choices { follows, ..Choices::default() });
            set_anatomical(&mut scene, &choices, true);
            let ends = |(control, _): (Control<'_>, f64)| control.allowed().clone();
            let allowed = ends(height(&scene, &choices).unwrap());
            for end in [*allowed.start(), *allowed.end()] {
                let mut scene = scene.clone();
                set_height(&mut scene, &choices, end);
                assert!((scene.implant.base_height() - mm(end)).abs() < 1e-9, "{follows:?} {end}");
                scene.repair();
                assert_eq!(scene.validate(), Ok(()), "{follows:?} {end}");
            }
            let allowed = ends(apex(&scene).unwrap());
            assert_eq!(allowed, -3.24..=3.24);
            set_apex(&mut scene, *allowed.end());
            assert_eq!((scene.implant.apex_shift_mm, scene.validate()), (32.4, Ok(())));
        }
    }
}

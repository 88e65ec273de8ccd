//! Round or anatomical implant, or expander: width, volume, projection, of which one follows the other two; profile.

use super::volume_marks::VolumeMarks;
use super::{Choices, Device, Hand, chip, chips, cm, mm, row, shape, title};
use crate::app::frame::research;
use crate::app::texts::{localized, tr};
use crate::app::widgets::theme;
use crate::app::widgets::{
    Control, Kind, kept_lines, quantity::significant, remark, set_accessible_name,
};
use crate::clinical::{Dimension, ProfileClass, Size, limits};
use crate::scene::{Field, Fill, Scene};
use eframe::egui::{self, Rect, RichText, Sense, Stroke, Ui, vec2};
use std::ops::RangeInclusive;

/// Width of the mark of the dimension that follows \[points\].
const MARK: f32 = 24.0;
/// Width from which on there is room for a title beside the devices \[points\].
const DEVICES_WIDTH: f32 = 290.0;
const VOLUME_TOOLTIP: &str = "Volume of the implant: width, projection and fullness give it. Round implants: 95–965 ml. 1 ml = 1 cc.";

/// Shows the implant, with the marks of its volumes on a slider and the largest volume that stays usual.
pub(crate) fn implant(
    ui: &mut Ui,
    scene: &mut Scene,
    choices: &mut Choices,
    marks: &VolumeMarks,
    hand: Hand,
) {
    let heading = choices.device.words(tr("Implant"));
    if ui.available_width() < DEVICES_WIDTH {
        ui.add_space(theme::SPACE_SMALL);
        chips(ui, |ui| device(ui, scene, choices, hand));
    } else {
        title(ui, &heading, |ui| device(ui, scene, choices, hand));
    }
    // The limits of a scene are those of a size.
    let Ok(size) = scene.implant.size() else { return };
    let changed = match choices.device {
        Device::Implant => implant_rows(ui, scene, size, choices, marks, hand),
        Device::Expander => expander_rows(ui, size, hand),
    };
    kept_lines(ui, 2, |ui| match choices.device {
        Device::Implant => about_sizes(ui, scene, size, choices),
        Device::Expander => about_fill(ui, size),
    });
    if let Some(size) = changed {
        shape::set_size(scene, size);
    }
}

/// The dimension that follows, or the maker's name of the size.
fn about_sizes(ui: &mut Ui, scene: &Scene, size: Size, choices: &Choices) {
    let [a, b, c] = match choices.follows {
        Dimension::BaseWidth => [tr("Width"), tr("volume"), tr("projection")],
        Dimension::Volume => [tr("Volume"), tr("width"), tr("projection")],
        Dimension::Projection => [tr("Projection"), tr("width"), tr("volume")],
    };
    let unusual = if size.is_typical() { "" } else { tr(" Outside the typical sizes.") };
    let reference = &scene.implant_reference;
    if reference.is_empty() {
        remark(ui, tr!("{a} follows {b} and {c}.{unusual}", a, b, c, unusual))
            .on_hover_text(typical());
    } else {
        let name = RichText::new(reference).strong();
        ui.add(egui::Label::new(name).truncate()).on_hover_text(tr!(
                "{reference}: a size in stock. Another width, volume or projection is no longer this implant.{unusual}",
                reference,
                unusual
            ));
    }
}

/// The height of an expander's dome.
fn about_fill(ui: &mut Ui, size: Size) {
    let words = tr!("The fill raises the dome to {height:.1} cm.", height = size.projection_cm());
    remark(ui, words).on_hover_text(tr(
        "The shell is a half-ellipsoid at every fill; an expander with a built-in shape differs.",
    ));
}

/// The switch between a round implant, an anatomical one and an expander.
fn device(ui: &mut Ui, scene: &mut Scene, choices: &mut Choices, hand: Hand) {
    let [round, anatomical] = shape::CHOICES;
    let expander = ("expander", "A tissue expander: the fill raises a base of fixed width");
    let is_anatomical = shape::is_anatomical(&scene.implant);
    let mut devices = [
        (Device::Implant, false, round),
        (Device::Implant, true, anatomical),
        (Device::Expander, false, expander),
    ];
    if ui.layout().prefer_right_to_left() {
        devices.reverse();
    }
    for (device, becomes_anatomical, (name, tooltip)) in devices {
        let is_shape = device == Device::Expander || is_anatomical == becomes_anatomical;
        if chip(ui, hand, choices.device == device && is_shape, tr(name), tr(tooltip)) {
            if choices.device != device {
                choices.follows = Dimension::Projection;
                // The shell of an expander is taut.
                scene.implant.fill = (device == Device::Implant).then_some(Fill::Cohesive);
            }
            (choices.device, choices.last) = (device, None);
            shape::set_anatomical(scene, choices, becomes_anatomical);
            if device == Device::Expander {
                shape::make_half_ellipsoid(scene);
            }
        }
    }
}

/// Shows width, volume, projection and profile, of an anatomical implant also height and apex; returns a changed size.
fn implant_rows(
    ui: &mut Ui,
    scene: &mut Scene,
    size: Size,
    choices: &mut Choices,
    marks: &VolumeMarks,
    hand: Hand,
) -> Option<Size> {
    let mut changed = None;
    let has_locks = research::is_on(ui.ctx());
    if has_locks {
        choices.last = None;
    }
    let mark_width = if has_locks { MARK } else { 0.0 };
    // The marks are those of the present width.
    let is_marked = choices.follows != Dimension::BaseWidth;
    let volume_tooltip = format!("{}{}", tr(VOLUME_TOOLTIP), marks.words());
    for dimension in [Dimension::BaseWidth, Dimension::Volume, Dimension::Projection] {
        let is_following = choices.follows == dimension;
        let before = value(size, dimension);
        let mut now = before;
        let mut mark = false;
        let mut control = control_of(size, dimension, choices);
        if dimension == Dimension::Volume && is_marked {
            control.marks = marks.ends();
            control.tooltip = &volume_tooltip;
        }
        let response = row(
            ui,
            hand,
            control,
            &mut now,
            (mark_width, |ui: &mut Ui| {
                mark = has_locks && follow_mark(ui, dimension, is_following, hand);
            }),
        );
        if mark {
            choices.follows = dimension;
        }
        if response.is_changed {
            changed = resized(size, choices, dimension, now).or(changed);
            choices.last = Some(dimension).filter(|_| !has_locks);
        }
        if dimension == Dimension::BaseWidth {
            shape::height_row(ui, scene, choices, hand, mark_width);
        }
    }
    shape::apex_row(ui, scene, hand, mark_width);
    chips(ui, |ui| {
        for class in ProfileClass::ALL {
            let tooltip = tr("Projection for this width, in the middle of the class");
            let is_chosen = size.profile() == class && !size.is_beyond_half_sphere();
            if class == ProfileClass::HalfSphere && !has_locks && !is_chosen {
                continue;
            }
            if chip(ui, hand, is_chosen, name_of(class), tooltip) {
                let radius = 0.5 * size.base_width_mm();
                // A half sphere is exact; other profiles are whole millimetres.
                let projection = match class {
                    ProfileClass::HalfSphere => radius,
                    _ => (class.ratio() * radius).round(),
                };
                let dimension = Dimension::Projection;
                changed =
                    size.changed(dimension, projection, Dimension::BaseWidth).ok().or(changed);
                (choices.follows, choices.last) = (Dimension::Volume, None);
            }
        }
    });
    changed
}

/// Shows base width and fill; returns a changed size.
fn expander_rows(ui: &mut Ui, size: Size, hand: Hand) -> Option<Size> {
    let mut changed = None;
    let none = |_: &mut Ui| {};
    let mut width = cm(size.base_width_mm());
    let control = Control {
        tooltip: tr("Width of the expander's base, which the pocket holds."),
        ..control_of(size, Dimension::BaseWidth, &Choices::default())
    };
    if row(ui, hand, control, &mut width, (MARK, none)).is_changed {
        changed = size.changed(Dimension::BaseWidth, mm(width), Dimension::Volume).ok();
    }
    let mut fill = significant(size.volume_ml());
    let control = Control {
        label: tr("Fill"),
        tooltip: tr("Volume in the expander. The fill raises the dome over the base."),
        ..control_of(size, Dimension::Volume, &Choices::default())
    };
    if row(ui, hand, control, &mut fill, (MARK, none)).is_changed {
        changed = size.changed(Dimension::Volume, fill, Dimension::BaseWidth).ok().or(changed);
    }
    changed
}

/// The mark of the dimension that follows (=), and padlocks, which are buttons, for the held ones; returns whether it
/// was pressed.
fn follow_mark(ui: &mut Ui, dimension: Dimension, is_following: bool, hand: Hand) -> bool {
    let name = label(dimension).to_lowercase();
    let height = if hand == Hand::Finger { theme::TOUCH - 4.0 } else { 24.0 };
    let (rect, response) = ui.allocate_exact_size(vec2(MARK, height), Sense::click());
    set_accessible_name(&response, egui::Role::Button, &tr!("Let the {name} follow", name));
    let visuals = ui.visuals();
    let color =
        if response.hovered() { visuals.text_color() } else { theme::palette(visuals).edge };
    let (painter, line) = (ui.painter(), Stroke::new(1.5, color));
    let centre = rect.center();
    if is_following {
        for y in [-2.5, 2.5] {
            let ends = [centre + vec2(-5.0, y), centre + vec2(5.0, y)];
            painter.line_segment(ends, Stroke::new(1.5, theme::palette(visuals).accent));
        }
    } else {
        painter.circle_stroke(centre - vec2(0.0, 2.0), 3.5, line);
        let body = Rect::from_center_size(centre + vec2(0.0, 3.0), vec2(11.0, 8.0));
        painter.rect_filled(body, 1.5, color);
    }
    let is_pressed = response.clicked() && !is_following;
    response.on_hover_text(if is_following {
        tr!("The {name} follows the other two", name)
    } else {
        tr!("The {name} is held. Press to let the {name} follow the other two", name)
    });
    is_pressed
}

fn label(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::BaseWidth => tr(Field::BaseRadius.label),
        Dimension::Volume => tr("Volume"),
        Dimension::Projection => tr(Field::Projection.label),
    }
}

fn name_of(class: ProfileClass) -> &'static str {
    match class {
        ProfileClass::Low => tr("Low"),
        ProfileClass::Moderate => tr("Moderate"),
        ProfileClass::High => tr("High"),
        ProfileClass::HalfSphere => tr("Half sphere"),
    }
}

/// A dimension in the units of the plan: cm and ml.
pub(super) fn value(size: Size, dimension: Dimension) -> f64 {
    match dimension {
        Dimension::BaseWidth => cm(size.base_width_mm()),
        Dimension::Volume => significant(size.volume_ml()),
        Dimension::Projection => cm(size.projection_mm()),
    }
}

/// The control of a dimension.
pub(super) fn control_of<'a>(size: Size, dimension: Dimension, choices: &Choices) -> Control<'a> {
    let allowed = allowed(size, dimension, held(dimension, choices));
    let is_following = dimension == choices.follows;
    let most_decimals = if is_following { 1 } else { 6 };
    match dimension {
        Dimension::BaseWidth => Control {
            range: 6.0..=20.0,
            allowed: Some(allowed),
            reset: 12.0,
            most_decimals,
            ..Control::of(Field::BaseRadius)
        },
        Dimension::Projection => Control {
            range: 1.0..=9.0,
            allowed: Some(allowed),
            reset: 4.0,
            most_decimals,
            ..Control::of(Field::Projection)
        },
        Dimension::Volume => Control {
            label: label(dimension),
            unit: "ml",
            kind: Kind::Volume,
            range: 50.0..=1000.0,
            allowed: Some(allowed),
            reset: 300.0,
            decimals: 0,
            most_decimals: if is_following { 0 } else { 2 },
            step: 5.0,
            tooltip: tr(VOLUME_TOOLTIP),
            ..Control::default()
        },
    }
}

/// The size after a change of a dimension \[cm, ml\]; the other two follow their marks.
pub(super) fn resized(
    size: Size,
    choices: &mut Choices,
    dimension: Dimension,
    value: f64,
) -> Option<Size> {
    let held = held(dimension, choices);
    let given = if dimension == Dimension::Volume { value } else { mm(value) };
    let size = size.changed(dimension, given, held).ok()?;
    choices.follows = third(dimension, held);
    Some(size)
}

/// Sets the projection \[mm\], to whole millimetres in the limits; the other dimensions follow their marks. Returns whether the
/// plan is another one.
pub(crate) fn set_projection(scene: &mut Scene, choices: &mut Choices, mm: f64) -> bool {
    let Ok(size) = scene.implant.size() else { return false };
    let dimension = Dimension::Projection;
    // A drag of the dome holds the width.
    choices.last = None;
    let allowed = allowed(size, dimension, held(dimension, choices));
    let value = cm(mm.round()).clamp(*allowed.start(), *allowed.end());
    let Some(size) = resized(size, choices, dimension, value) else { return false };
    let before = scene.implant;
    shape::set_size(scene, size);
    scene.implant != before
}

/// Projection and volume, and the limits of the projection at one of them.
pub(crate) fn projection_in_words(scene: &Scene, choices: &Choices) -> Vec<String> {
    let Ok(size) = scene.implant.size() else { return Vec::new() };
    let (cm, ml) = (size.projection_cm(), size.volume_ml());
    let allowed = allowed(size, Dimension::Projection, held(Dimension::Projection, choices));
    let is_at_end = cm <= allowed.start() + 1e-6 || cm >= allowed.end() - 1e-6;
    let limits = || {
        tr!(
            "Projection: {least:.1} to {most:.1} cm for this width",
            least = allowed.start(),
            most = allowed.end()
        )
    };
    let reached = tr!("Projection {cm:.1} cm, {ml:.0} ml", cm, ml);
    [reached].into_iter().chain(is_at_end.then(limits)).collect()
}

/// The dimension that keeps its value while another one is changed. The one that follows may be changed too: then
/// the width is held. Without locks the last two dimensions that were changed are held.
fn held(changed: Dimension, choices: &Choices) -> Dimension {
    use Dimension::{BaseWidth, Projection, Volume};
    match (changed, choices.follows, choices.last) {
        (_, follows, Some(last)) if last == changed => third(changed, follows),
        (_, _, Some(last)) => last,
        (BaseWidth, Volume, None) | (Volume, BaseWidth, None) => Projection,
        (Projection, BaseWidth, None) | (BaseWidth, _, None) => Volume,
        (Volume | Projection, _, None) => BaseWidth,
    }
}

/// The third dimension.
fn third(a: Dimension, b: Dimension) -> Dimension {
    let all = [Dimension::BaseWidth, Dimension::Volume, Dimension::Projection];
    all.into_iter().find(|d| *d != a && *d != b).unwrap_or(Dimension::Projection)
}

/// Allowed values of a dimension \[cm, ml\] with another one held, so that the third is in its limits too.
fn allowed(size: Size, dimension: Dimension, held: Dimension) -> RangeInclusive<f64> {
    use Dimension::{BaseWidth, Projection, Volume};
    let (width, projection, volume) =
        (size.base_width_mm(), size.projection_mm(), size.volume_ml());
    // Volume [ml] = factor · width² [mm²] · projection [mm].
    let factor = volume / (width * width * projection);
    let (widths, projections) = (limits::BASE_WIDTH_MM, limits::PROJECTION_MM);
    let ends = |f: &dyn Fn(f64) -> f64, (a, b): (f64, f64)| {
        let (a, b) = (f(a), f(b));
        (a.min(b), a.max(b))
    };
    let both = |(a, b): (f64, f64), (c, d): (f64, f64)| (a.max(c), b.min(d));
    let (least, most) = match (dimension, held) {
        (BaseWidth, Volume) => {
            both(widths, ends(&|p: f64| (volume / (factor * p)).sqrt(), projections))
        }
        (BaseWidth, _) => widths,
        (Projection, Volume) => {
            both(projections, ends(&|w: f64| volume / (factor * w * w), widths))
        }
        (Projection, _) => projections,
        (Volume, Projection) => ends(&|w: f64| factor * w * w * projection, widths),
        (Volume, _) => ends(&|p: f64| factor * width * width * p, projections),
    };
    // Rounded inwards, so that a displayed limit is itself allowed: 0.1 cm, 1 ml.
    let (least, most) = ((least - 1e-6).ceil(), (most + 1e-6).floor());
    if dimension == Volume { least..=most } else { cm(least)..=cm(most) }
}

fn typical() -> String {
    let cm = |(least, most): (f64, f64)| localized(format!("{}–{} cm", cm(least), cm(most)));
    let (least, most) = limits::TYPICAL_VOLUME_ML;
    tr!(
        "Typical round implants: width {width}, projection {projection}, {least}–{most} ml.",
        width = cm(limits::TYPICAL_WIDTH_MM),
        projection = cm(limits::TYPICAL_PROJECTION_MM),
        least,
        most
    )
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "stated values hold to the last bit")]
mod tests {
    use super::*;

    fn size() -> Size {
        Size::of_width_and_volume(120.0, 300.0).unwrap()
    }

    #[test]
    fn the_held_dimension_is_neither_the_changed_nor_the_following_one() {
        let all = [Dimension::BaseWidth, Dimension::Volume, Dimension::Projection];
        for changed in all {
            for follows in all {
                let choices = |last| Choices { follows, last, ..Choices::default() };
                let held = held(changed, &choices(None));
                assert_ne!(held, changed);
                assert!(held != follows || changed == follows, "{changed:?} {follows:?}");
                if changed != follows {
                    assert_eq!(third(changed, held), follows);
                    // The same one again, or the other one that is held.
                    assert_eq!(super::held(changed, &choices(Some(changed))), held);
                    assert_eq!(super::held(changed, &choices(Some(held))), held);
                } else {
                    for last in all.into_iter().filter(|last| *last != changed) {
                        assert_eq!(super::held(changed, &choices(Some(last))), last);
                    }
                }
            }
        }
    }

    #[test]
    fn every_allowed_end_is_a_valid_size() {
        let all = [Dimension::BaseWidth, Dimension::Volume, Dimension::Projection];
        for dimension in all {
            for held in all.into_iter().filter(|held| *held != dimension) {
                let allowed = allowed(size(), dimension, held);
                for end in [*allowed.start(), *allowed.end()] {
                    let given = if dimension == Dimension::Volume { end } else { mm(end) };
                    let changed = size().changed(dimension, given, held);
                    assert!(changed.is_ok(), "{dimension:?} {end}, {held:?} held: {changed:?}");
                }
            }
        }
    }
}

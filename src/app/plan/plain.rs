//! The numbers of the plan that are shown by their rows alone, [`Field::PLAIN`] and those of a torso: control, effect, words.

use super::device::Device;
use crate::app::texts::{fixed, tr};
use crate::app::widgets::Control;
use crate::app::widgets::quantity::significant;
use crate::scene::field::{Part, TORSO};
use crate::scene::{Field, Scene};

/// The control of a number and its value; `None` for a number of an implant if the plan has an expander, and for one of a body of a sheet.
pub(crate) fn control(
    scene: &Scene,
    number: Field,
    device: Device,
) -> Option<(Control<'static>, f64)> {
    if device == Device::Expander && number.path.starts_with("implant.") {
        return None;
    }
    if number.part == Part::Body && !scene.is_layered() {
        return None;
    }
    let unstated = unstated(scene, number);
    let reset = unstated.unwrap_or_else(|| number.usual());
    let control = Control { reset, ..Control::of(number) };
    Some((control, number.shown(scene).or(unstated)?))
}

/// What a number is that a scene need not state, in the unit of its control.
fn unstated(scene: &Scene, number: Field) -> Option<f64> {
    let torso = scene.torso.filter(|_| number == Field::TorsoFold)?;
    let shown = number.scale.factor * torso.own_nipple_fold_mm()?;
    Some((shown / number.scale.step).round() * number.scale.step)
}

/// Sets a number, in the unit of its control; the usual value is not stated.
pub(crate) fn set(scene: &mut Scene, number: Field, value: f64) {
    let unstated = unstated(scene, number);
    if let Some(torso) = scene.torso.as_mut().filter(|_| number == Field::TorsoFold) {
        let is_stated = unstated.is_none_or(|own| (value - own).abs() > 0.5 * number.scale.step);
        torso.nipple_fold_mm = is_stated.then_some(value / number.scale.factor);
    }
    number.set(scene, 0, significant(value / number.scale.factor));
    scene.implant = scene.implant.in_few_words();
}

/// The stated numbers, and those of a torso, in words: names and values.
pub(super) fn rows(scene: &Scene) -> impl Iterator<Item = (&'static str, String)> {
    let stated = Field::PLAIN.into_iter().filter(|number| number.is_stated(scene));
    stated.chain(TORSO).filter_map(|number| {
        let value = fixed(number.shown(scene)?, number.scale.decimals);
        let words = format!("{value} {}", tr(number.scale.unit));
        Some((tr(number.label), words.trim_end().to_owned()))
    })
}

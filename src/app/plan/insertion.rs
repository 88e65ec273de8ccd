//! How far the implant is in place.

use crate::app::texts::tr;
use crate::app::widgets::{Control, Kind};
use crate::scene::Scene;

/// The control of the insertion, and the insertion \[%\].
pub(in crate::app) fn insertion(scene: &Scene) -> (Control<'static>, f64) {
    let control = Control {
        label: tr("In place"),
        unit: "%",
        kind: Kind::Percent,
        range: 0.0..=100.0,
        reset: 100.0,
        decimals: 0,
        step: 1.0,
        tooltip: tr("Height of the implant under the tissue, from flat (0 %) to full (100 %)."),
        ..Control::default()
    };
    (control, 100.0 * scene.insertion)
}

/// Sets the insertion \[%\].
pub(in crate::app) fn set_insertion(scene: &mut Scene, percent: f64) {
    scene.insertion = (percent / 100.0).clamp(0.0, 1.0);
}

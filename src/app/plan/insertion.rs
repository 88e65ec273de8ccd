//! How far the implant is in place.

use crate::app::widgets::Control;
use crate::scene::{Field, Scene};

/// The control of the insertion, and the insertion \[%\].
pub(crate) fn insertion(scene: &Scene) -> (Control<'static>, f64) {
    let control =
        Control { reset: 100.0, decimals: 0, most_decimals: 0, ..Control::of(Field::Insertion) };
    (control, 100.0 * scene.insertion)
}

/// Sets the insertion \[%\].
pub(crate) fn set_insertion(scene: &mut Scene, percent: f64) {
    Field::Insertion.set(scene, 0, percent / 100.0);
}

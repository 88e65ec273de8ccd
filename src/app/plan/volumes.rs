//! The volumes of an implant or expander of a given width, as the axis of a study.

use crate::clinical::{Size, limits};
use crate::scene::Implant;
use crate::study::{Axis, Parameter};

/// Number of volumes.
pub(crate) const COUNT: usize = 21;
/// Projection / half base width of the least volume \[-\].
const LEAST_RATIO: f64 = 0.15;

/// The projection of the highest profile sold on an implant's base \[mm\], of the greatest projection / half width of typical sizes.
pub(crate) fn highest_sold_mm(implant: &Implant) -> f64 {
    let (_, ratio) = limits::TYPICAL_RATIO;
    ratio * implant.base_radius_mm
}

/// The volume of that profile \[ml\].
pub(crate) fn highest_sold_ml(implant: &Implant) -> f64 {
    let projection_mm = highest_sold_mm(implant);
    Implant { projection_mm, ..*implant }.size().map_or(f64::INFINITY, Size::volume_ml)
}

/// The volumes of an implant's base up to a ratio of projection to half the width, in whole 10 ml, within the limits of a
/// scene.
pub(crate) fn volumes(implant: &Implant, most_ratio: f64) -> Axis {
    let volume = |ratio: f64| {
        let (least, most) = limits::PROJECTION_MM;
        let projection_mm = (ratio * implant.base_radius_mm).clamp(least, most);
        Implant { projection_mm, ..*implant }.size().map_or(0.0, Size::volume_ml)
    };
    let (least, most) = (volume(LEAST_RATIO), volume(most_ratio));
    // A small base has a small step.
    let step = if most - least > 100.0 { 10.0 } else { 0.1 };
    let (from, to) = ((least / step).ceil() * step, (most / step).floor() * step);
    Axis { field: Parameter::Volume, from, to, count: COUNT }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_width(width: f64) -> Implant {
        Implant { base_radius_mm: 0.5 * width, ..Implant::default() }
    }

    #[test]
    fn volumes_lie_within_the_limits_and_between_the_ratios() {
        for width in [20.0, 60.0, 120.0, 240.0] {
            let axis = volumes(&of_width(width), 1.0);
            assert!(axis.from < axis.to, "{width}: {axis:?}");
            for volume in axis.values() {
                let dome = Size::of_width_and_volume(width, volume).unwrap();
                assert!((0.14..=1.001).contains(&dome.ratio()), "{width}: {volume}");
            }
        }
        let axis = volumes(&of_width(120.0), 1.0);
        assert_eq!((axis.from, axis.to), (70.0, 450.0));
    }

    #[test]
    fn volumes_of_an_anatomical_base_are_those_of_its_height() {
        let anatomical =
            Implant { base_height_mm: Some(90.0), apex_shift_mm: 10.0, ..of_width(120.0) };
        // ⅔πabp = 339.3 ml at a projection of 60 mm, 50.9 ml at 9 mm.
        let axis = volumes(&anatomical, 1.0);
        assert_eq!((axis.from, axis.to), (60.0, 330.0));
    }
}

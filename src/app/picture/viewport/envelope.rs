//! The skin of other plans as lines in the picture: envelopes of sampled patients, outlines of pins.
//!
//! Around a centred implant on a flat or spherical chest the skin is one of revolution: its lines lie on the faces of the cut,
//! without a cut on the outline as the camera sees it. Otherwise a line holds along the profile only, from the pocket's centre
//! to +x.

use crate::scene::Letter;
use crate::study::SectionBand;
use crate::view::section::{Opening, Section};
use eframe::egui::Color32;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// The outline of a pin's skin.
pub(crate) struct Outline {
    /// The pin's letter, and the colour and the gaps of its line.
    pub(crate) letter: Letter,
    pub(crate) color: Color32,
    pub(crate) dashes: (f32, f32),
    /// Distance from the pocket's centre and height of the skin's outer surface \[mm\], outwards.
    pub(crate) points: Vec<Vec2>,
    /// Is the skin one of revolution?
    pub(crate) is_round: bool,
}

impl Outline {
    /// The lines of the outline \[mm\].
    pub(super) fn lines(&self, section: Section, azimuth: f32) -> Vec<Vec<Vec3>> {
        let at = |direction: f32| {
            let point = |p: &Vec2| (Vec2::from_angle(direction) * p.x).extend(p.y);
            self.points.iter().map(point).collect()
        };
        directions(self.is_round, section, azimuth).into_iter().map(at).collect()
    }
}

/// A line of an envelope.
pub(super) struct EnvelopeLine {
    /// Points \[mm\], from the axis outwards.
    pub(super) points: Vec<Vec3>,
    /// 90th percentile of the heights (outer), or 10th (inner).
    pub(super) is_outer: bool,
}

/// The lines of a band: an inner and an outer one in each direction. `azimuth`: of the camera \[radians\].
pub(super) fn lines(
    band: &[SectionBand],
    is_round: bool,
    section: Section,
    azimuth: f32,
) -> Vec<EnvelopeLine> {
    if band.is_empty() {
        return Vec::new();
    }
    let line = |direction: f32, is_outer: bool| {
        let point = |point: &SectionBand| {
            let (r, z) = (point.r_mm as f32, point.z_mm[if is_outer { 2 } else { 0 }] as f32);
            Vec3::new(r * direction.cos(), r * direction.sin(), z)
        };
        EnvelopeLine { points: band.iter().map(point).collect(), is_outer }
    };
    let directions = directions(is_round, section, azimuth).into_iter();
    directions.flat_map(|at| [false, true].map(|is_outer| line(at, is_outer))).collect()
}

/// Directions \[radians\] in which the skin is known, and shown.
fn directions(is_round: bool, section: Section, azimuth: f32) -> Vec<f32> {
    let both = |middle: f32, apart: f32| vec![middle - apart, middle + apart];
    match section.opening {
        _ if !is_round => vec![0.0],
        Opening::Closed => both(azimuth, FRAC_PI_2),
        Opening::Wedge => both(section.angle, FRAC_PI_4),
        Opening::Half => both(section.angle, FRAC_PI_2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_lie_on_the_faces_of_the_cut_and_off_centre_along_the_profile() {
        let band = [SectionBand { r_mm: 20.0, z_mm: [10.0, 12.0, 15.0] }];
        let of = |opening, is_round| {
            let section = Section { opening, angle: 0.3, axis: Vec2::ZERO };
            let lines = lines(&band, is_round, section, 1.0);
            lines.into_iter().map(|line| (line.points[0], line.is_outer)).collect::<Vec<_>>()
        };
        let at = |angle: f32, z| Vec3::new(20.0 * angle.cos(), 20.0 * angle.sin(), z);
        for (opening, middle, apart) in [
            (Opening::Closed, 1.0, FRAC_PI_2),
            (Opening::Wedge, 0.3, FRAC_PI_4),
            (Opening::Half, 0.3, FRAC_PI_2),
        ] {
            let expected = [middle - apart, middle + apart]
                .map(|angle| [(at(angle, 10.0), false), (at(angle, 15.0), true)])
                .concat();
            assert_eq!(of(opening, true), expected);
            assert_eq!(of(opening, false), [(at(0.0, 10.0), false), (at(0.0, 15.0), true)]);
            let outline = Outline {
                letter: Letter::A,
                color: Color32::RED,
                dashes: (7.0, 4.0),
                points: vec![Vec2::new(20.0, 15.0)],
                is_round: true,
            };
            let section = Section { opening, angle: 0.3, axis: Vec2::ZERO };
            let points = outline.lines(section, 1.0).concat();
            for (point, angle) in points.iter().zip([middle - apart, middle + apart]) {
                assert!((*point - at(angle, 15.0)).length() < 1e-4);
            }
            assert_eq!(points.len(), 2);
        }
        let section = Section { opening: Opening::Half, angle: 0.0, axis: Vec2::ZERO };
        assert!(lines(&[], true, section, 0.0).is_empty());
    }
}

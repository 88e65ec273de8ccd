//! The chest wall at rest under the patch, and points above it.
//!
//! The wall is a height field over the plane that touches the wall at the pocket's centre, z outwards:
//! w = ρ₁(√(1 − x²/ρ₁² − y²/(ρ₁ρ₂)) − 1) with the radii of curvature ρ₁ across (x) and ρ₂ along the body (y), an ellipsoid's
//! patch; a cylinder for one infinite radius, a sphere for equal radii, hollow for negative radii. Or a grid of heights.
//!
//! A place on the wall is given in geodesic polar coordinates about the pocket's centre: the lengths of a tape measure.

use super::HeightGrid;
use super::geodesics::{Fan, Way};
use super::height_field::{Ground, HeightField};
use crate::number::Real;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// The wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Chest {
    /// The plane z = 0.
    #[default]
    Flat,
    /// A curved wall.
    Curved {
        /// Radius of curvature across the body, along x \[mm\].
        across_mm: f64,
        /// Radius of curvature along the body, along y \[mm\]; infinite: straight.
        along_mm: f64,
    },
    /// A wall through heights on a grid.
    Grid(HeightGrid),
}

/// Length of a step along a geodesic \[radii of curvature\]: the error of a place is below 1e-8 radii within a radius.
const STEP: f64 = 0.04;

impl Chest {
    /// The point at a height above the wall, along the normal at a place \[mm\].
    #[must_use]
    pub fn point(&self, place: DVec2, height_mm: f64) -> DVec3 {
        let (foot, normal) = self.foot_and_normal(place);
        foot + normal * height_mm
    }

    /// The point of the wall at a place \[mm\], and the unit normal outwards.
    #[must_use]
    pub fn foot_and_normal(&self, place: DVec2) -> (DVec3, DVec3) {
        let longest = match self {
            Self::Flat => return (place.extend(0.0), DVec3::Z),
            &Self::Curved { across_mm, along_mm } if along_mm.is_infinite() => {
                let [x, height, slope_x, up] = circle(place.x, across_mm);
                return (DVec3::new(x, place.y, height), DVec3::new(slope_x, 0.0, up));
            }
            &Self::Curved { across_mm, along_mm } if across_mm.is_infinite() => {
                let [y, height, slope_y, up] = circle(place.y, along_mm);
                return (DVec3::new(place.x, y, height), DVec3::new(0.0, slope_y, up));
            }
            &Self::Curved { across_mm, along_mm } if across_mm.to_bits() == along_mm.to_bits() => {
                let [far, height, sin, up] = circle(place.length(), across_mm);
                let direction = place.normalize_or_zero();
                return ((direction * far).extend(height), (direction * sin).extend(up));
            }
            &Self::Curved { across_mm, along_mm } => longest_step(across_mm, along_mm),
            Self::Grid(grid) => grid.spacing(),
        };
        self.over(self.foot(place, longest))
    }

    /// The point of the wall over a position of the plane \[mm\], and the unit normal outwards.
    fn over(&self, foot: DVec2) -> (DVec3, DVec3) {
        let Ground { height, slope } = self.heights::<f64>().at(foot.to_array());
        (foot.extend(height), DVec2::from(slope).extend(-1.0).normalize() * -1.0)
    }

    /// [`Self::foot_and_normal`] at the many places of a grid within a length \[mm\]: walls without geodesics in closed form have a fan of them,
    /// within 0.005 mm over waves of 60 mm and a mound 20 mm wide, 2e-6 mm over two radii.
    pub fn feet(&self, reach_mm: f64) -> impl Fn(DVec2) -> (DVec3, DVec3) {
        let fan = self.fan(reach_mm);
        move |place| match &fan {
            Some(fan) => self.over(fan.foot(place)),
            None => self.foot_and_normal(place),
        }
    }

    /// A fan of geodesics up to a length \[mm\]; `None` for walls whose geodesics are short work.
    fn fan(&self, reach_mm: f64) -> Option<Arc<Fan>> {
        match *self {
            Self::Grid(ref grid) => Some(grid.fan(reach_mm)),
            Self::Curved { across_mm, along_mm }
                if across_mm.is_finite()
                    && along_mm.is_finite()
                    && across_mm.to_bits() != along_mm.to_bits() =>
            {
                let longest = longest_step(across_mm, along_mm);
                Some(Arc::new(Fan::new(&self.heights(), longest, reach_mm)))
            }
            _ => None,
        }
    }

    /// Is the wall its own image mirrored along x, along y?
    #[must_use]
    pub fn mirrored(&self) -> [bool; 2] {
        match self {
            Self::Flat | Self::Curved { .. } => [true; 2],
            Self::Grid(grid) => grid.mirrored(),
        }
    }

    /// The position over the plane after a geodesic from the centre (classic Runge–Kutta steps).
    fn foot(&self, place: DVec2, longest_step: f64) -> DVec2 {
        let length = place.length();
        if length == 0.0 {
            return DVec2::ZERO;
        }
        let wall = self.heights::<f64>();
        let steps = (length / longest_step).ceil().max(1.0);
        let step = length / steps;
        let mut way = Way::new(place / length);
        for _ in 0..steps as usize {
            way = way.after(&wall, step);
        }
        way.at
    }

    /// w \[mm\] over a position of the plane.
    #[must_use]
    pub fn height(&self, at: DVec2) -> f64 {
        self.heights::<f64>().at(at.to_array()).height
    }

    /// The point with its height above the wall for z.
    #[inline]
    #[must_use]
    pub fn flattened(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Flat => point,
            chest => point.with_z(point.z - chest.height(point.truncate())),
        }
    }

    /// ∇w \[-\].
    #[must_use]
    pub fn slope(&self, at: DVec2) -> DVec2 {
        self.heights::<f64>().at(at.to_array()).slope.into()
    }

    /// ∂²w/∂x², ∂²w/∂x∂y and ∂²w/∂y² \[1/mm\].
    #[must_use]
    pub fn curvature(&self, at: DVec2) -> [f64; 3] {
        self.heights::<f64>().curvature(at.to_array())
    }

    /// The height field in numbers of one precision.
    pub(crate) fn heights<R: Real>(&self) -> HeightField<R> {
        match self {
            Self::Flat => HeightField::Flat,
            Self::Curved { across_mm, along_mm } => {
                HeightField::curved([1.0 / across_mm, 1.0 / along_mm])
            }
            Self::Grid(grid) => grid.heights(),
        }
    }

    /// The wall in another unit of length.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Flat => Self::Flat,
            Self::Curved { across_mm, along_mm } => {
                Self::Curved { across_mm: across_mm * factor, along_mm: along_mm * factor }
            }
            Self::Grid(grid) => Self::Grid(grid.scaled(factor)),
        }
    }
}

/// The longest step along a geodesic over curves of two radii \[mm\].
fn longest_step(across_mm: f64, along_mm: f64) -> f64 {
    STEP * across_mm.abs().min(along_mm.abs())
}

/// After a length along a circle of a radius, which starts level: way, height, and the unit normal's components along both.
fn circle(length: f64, radius: f64) -> [f64; 4] {
    let (sin, cos) = (length / radius).sin_cos();
    [radius * sin, radius * (cos - 1.0), sin, cos]
}

#[cfg(test)]
mod tests {
    use super::*;
    use wide::f32x4;

    /// The wall through heights 4 mm apart, 280 mm wide.
    fn grid(height: impl Fn(DVec2) -> f64) -> Chest {
        let place = |k: usize| DVec2::new((k % 71) as f64 - 35.0, (k / 71) as f64 - 35.0) * 4.0;
        let heights = (0..71 * 71).map(|k| height(place(k))).collect();
        Chest::Grid(HeightGrid::new(4.0, [71; 2], heights).unwrap())
    }

    fn places() -> impl Iterator<Item = DVec2> {
        (0..40).map(|k| DVec2::from_angle(0.7 * f64::from(k)) * (3.0 * f64::from(k)))
    }

    #[test]
    fn lengths_on_a_sphere_are_those_of_its_great_circles() {
        let radius = 150.0;
        for (sign, chest) in [1.0, -1.0]
            .map(|sign| (sign, Chest::Curved { across_mm: sign * radius, along_mm: sign * radius }))
        {
            for place in places() {
                let angle = place.length() / radius;
                let direction = place.normalize_or_zero();
                let (sin, cos) = angle.sin_cos();
                let normal = (direction * sign * sin).extend(cos);
                let expected = DVec3::new(0.0, 0.0, -sign * radius) + normal * sign * radius;
                let (foot, found) = chest.foot_and_normal(place);
                assert!(foot.distance(expected) < 1e-6, "{place}: {foot} {expected}");
                assert!(found.distance(normal) < 1e-7, "{place}: {found} {normal}");
            }
        }
    }

    #[test]
    fn a_cylinder_is_the_unrolled_plane() {
        let chest = Chest::Curved { across_mm: 140.0, along_mm: f64::INFINITY };
        for place in places() {
            let (sin, cos) = (place.x / 140.0).sin_cos();
            let expected = DVec3::new(140.0 * sin, place.y, 140.0 * (cos - 1.0));
            let point = chest.point(place, 12.0);
            let outwards = DVec3::new(sin, 0.0, cos) * 12.0;
            assert!(point.distance(expected + outwards) < 1e-6, "{place}: {point}");
        }
    }

    /// Unit speed, and the curvature vector along the normal: a geodesic of a general wall.
    #[test]
    fn geodesics_of_two_radii_have_unit_speed_and_turn_with_the_wall_only() {
        let chest = Chest::Curved { across_mm: 130.0, along_mm: 420.0 };
        let (direction, h) = (DVec2::from_angle(0.9), 0.5);
        for length in [10.0, 50.0, 90.0] {
            let at = |s: f64| chest.foot_and_normal(direction * s).0;
            let [before, middle, after] = [length - h, length, length + h].map(at);
            let normal = chest.foot_and_normal(direction * length).1;
            let speed = (after - before).length() / (2.0 * h);
            assert!((speed - 1.0).abs() < 1e-5, "{length}: {speed}");
            let turn = (after - 2.0 * middle + before) / (h * h);
            let beside = turn.cross(normal).length();
            assert!(beside < 1e-5 && turn.dot(normal) < -2e-3, "{length}: {turn} {beside:e}");
        }
    }

    #[test]
    fn a_grid_of_a_spheres_heights_is_the_sphere_in_both_precisions() {
        let sphere = Chest::Curved { across_mm: 150.0, along_mm: 150.0 };
        // Tilted and lifted: the grid's own tangent plane is subtracted.
        let chest = grid(|at| sphere.height(at) + 3.0 + at.dot(DVec2::new(0.1, -0.04)));
        let lanes = chest.scaled(0.25).heights::<f32x4>();
        for place in places() {
            let ((foot, normal), (exact, outwards)) =
                (chest.foot_and_normal(place), sphere.foot_and_normal(place));
            assert!(foot.distance(exact) < 1e-4, "{place}: {foot} {exact}");
            assert!(normal.distance(outwards) < 1e-5, "{place}: {normal} {outwards}");
            let at = foot.truncate();
            let [xx, xy, yy] = chest.heights::<f64>().curvature(at.to_array());
            let exact = sphere.heights::<f64>().curvature(at.to_array());
            for (found, exact) in [xx, xy, yy].into_iter().zip(exact) {
                assert!((found - exact).abs() < 2e-5, "{place}: {found} {exact}");
            }
            let four = lanes.at((0.25 * at).to_array().map(|x| f32x4::splat(x as f32)));
            let height = 0.25 * chest.height(at);
            let slopes = four.slope.map(|slope| f64::from(slope.to_array()[0]));
            assert!((f64::from(four.height.to_array()[0]) - height).abs() < 2e-5);
            assert!(DVec2::from(slopes).distance(chest.slope(at)) < 2e-6);
        }
        assert_eq!(chest.mirrored(), [true; 2]);
        let hollow_beside = grid(|at| 0.001 * at.x * at.x * at.x);
        assert_eq!(hollow_beside.mirrored(), [false, true]);
    }

    /// Against a geodesic to each place in short steps: a wall of two radii, with waves of 60 mm and a mound 20 mm wide, its mirror image, and a slope.
    #[test]
    fn a_fan_has_the_geodesics_of_its_places() {
        let smooth = Chest::Curved { across_mm: 130.0, along_mm: 420.0 };
        let bumpy = |at: DVec2| {
            let mound = 6.0 * (-(at - DVec2::new(50.0, -30.0)).length_squared() / 800.0).exp();
            smooth.height(at) + mound + 2.0 * (0.1 * at.x).sin() * (0.08 * at.y).cos()
        };
        let places = || (0..400).map(f64::from).map(|k| DVec2::from_angle(0.7 * k) * (0.25 * k));
        let error = |chest: &Chest| {
            let fan = chest.fan(100.0).unwrap();
            let exact = |place: DVec2| chest.foot(place, 0.1);
            places().map(|place| fan.foot(place).distance(exact(place))).fold(0.0, f64::max)
        };
        for (chest, most) in [
            (grid(bumpy), 5e-3),
            (grid(|at| smooth.height(at)), 5e-5),
            (grid(|at| 5.0 + 0.2 * at.x), 1e-9),
            (smooth.clone(), 2e-6),
            (Chest::Curved { across_mm: 150.0, along_mm: -400.0 }, 2e-6),
        ] {
            let error = error(&chest);
            assert!(error < most, "{error:e}");
        }
        let mirror = |v: DVec2| DVec2::new(-v.x, v.y);
        let image = grid(|at| bumpy(mirror(at))).fan(100.0).unwrap();
        let fan = grid(bumpy).fan(100.0).unwrap();
        for place in places() {
            assert!(fan.foot(place).distance(mirror(image.foot(mirror(place)))) < 1e-9);
        }
        let sphere = Chest::Curved { across_mm: 130.0, along_mm: 130.0 };
        assert!(sphere.fan(100.0).is_none());
    }

    #[test]
    fn a_turned_cylinder_is_the_turned_wall() {
        let across = Chest::Curved { across_mm: 140.0, along_mm: f64::INFINITY };
        let along = Chest::Curved { across_mm: f64::INFINITY, along_mm: 140.0 };
        let [grid_across, grid_along] = [&across, &along].map(|chest| grid(|at| chest.height(at)));
        let diagonal = DVec2::from_angle(std::f64::consts::FRAC_PI_4);
        let grid_diagonal = grid(|at| across.height(diagonal.rotate(at)));
        for place in places() {
            let turn = |v: DVec3| v.truncate().perp().extend(v.z);
            let (foot, normal) = across.foot_and_normal(place);
            assert_eq!(along.foot_and_normal(place.perp()), (turn(foot), turn(normal)));
            let (foot, normal) = grid_across.foot_and_normal(place);
            let found = grid_along.foot_and_normal(place.perp());
            assert!(found.0.distance(turn(foot)) < 1e-11 && found.1.distance(turn(normal)) < 1e-12);
            let found = grid_diagonal.foot_and_normal(place).0;
            let exact = across.foot_and_normal(diagonal.rotate(place)).0;
            let apart = diagonal.rotate(found.truncate()).extend(found.z).distance(exact);
            assert!(apart < 2e-3, "{place}: {apart}");
        }
    }

    #[test]
    fn a_large_radius_and_even_heights_are_the_plane() {
        let large = Chest::Curved { across_mm: 1e9, along_mm: 1e9 };
        for chest in [&large, &grid(|at| large.height(at)), &grid(|at| 5.0 + 0.2 * at.x)] {
            for place in places() {
                let (foot, normal) = chest.foot_and_normal(place);
                assert!(foot.distance(place.extend(0.0)) < 1e-5, "{place}: {foot}");
                assert!(normal.distance(DVec3::Z) < 1e-6);
            }
        }
    }
}

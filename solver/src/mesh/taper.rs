//! The edge of the innermost solid: whole above a line across the body, none of it below.
//!
//! Its cells do not end with it, for flat cells stall every method: below the edge they take a part of the solids above, as thick as half of those or as
//! the solid itself, and its law counts there with the modulus of the solid above.

use glam::DVec2;

/// How the innermost solid ends towards the feet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taper {
    /// Place along y of the middle of the step \[mm\]; −∞: the solid is whole everywhere.
    pub at_mm: f64,
    /// Width of the step \[mm\].
    pub width_mm: f64,
    /// Modulus at small strain of the solid above over that of the innermost one \[-\].
    pub modulus_above: f64,
}

/// A column of the innermost solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Column {
    /// Thickness of the solid \[mm\].
    pub(crate) there: f64,
    /// Thickness of its cells \[mm\].
    pub(crate) cells: f64,
    /// Factor of the law of its cells \[-\].
    pub(crate) law: f64,
}

impl Taper {
    /// A solid that is whole everywhere.
    pub const WHOLE: Self = Self { at_mm: f64::NEG_INFINITY, width_mm: 1.0, modulus_above: 1.0 };

    /// Is the solid whole everywhere?
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.at_mm == f64::NEG_INFINITY
    }

    /// What is there of the solid's thickness at a place on the wall \[-\]: 0 below the step, 1 above it.
    #[must_use]
    pub fn share(&self, place: DVec2) -> f64 {
        let t = ((place.y - self.at_mm) / self.width_mm + 0.5).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }

    /// The column at a place, of a solid of a thickness under solids of a thickness \[mm\].
    pub(crate) fn column(&self, place: DVec2, thickness_mm: f64, above_mm: f64) -> Column {
        let share = self.share(place);
        let there = thickness_mm * share;
        let of_above = (1.0 - share) * thickness_mm.min(0.5 * above_mm);
        let cells = there + of_above;
        Column { there, cells, law: (there + self.modulus_above * of_above) / cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solid_ends_within_the_step() {
        let taper = Taper { at_mm: -20.0, width_mm: 15.0, modulus_above: 0.4 };
        let share = |y: f64| taper.share(DVec2::new(7.0, y));
        assert!(share(-27.6) <= 0.0 && share(-12.4) >= 1.0);
        assert!((share(-20.0) - 0.5).abs() < 1e-15);
        assert!((0..100).map(|k| share(0.2 * f64::from(k) - 30.0)).is_sorted());
        assert!(Taper::WHOLE.share(DVec2::new(0.0, -260.0)) >= 1.0);
    }

    #[test]
    fn below_the_edge_the_cells_are_of_the_solids_above() {
        let taper = Taper { at_mm: 0.0, width_mm: 15.0, modulus_above: 0.4 };
        let column = |y: f64, above: f64| taper.column(DVec2::new(0.0, y), 8.0, above);
        assert_eq!(column(10.0, 9.0), Column { there: 8.0, cells: 8.0, law: 1.0 });
        assert_eq!(column(-10.0, 9.0), Column { there: 0.0, cells: 4.5, law: 0.4 });
        assert_eq!(column(-10.0, 40.0), Column { there: 0.0, cells: 8.0, law: 0.4 });
        let middle = column(0.0, 9.0);
        assert_eq!((middle.there, middle.cells), (4.0, 6.25));
        assert!((middle.law - (4.0 + 0.4 * 2.25) / 6.25).abs() < 1e-15);
    }
}

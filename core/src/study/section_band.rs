//! The band of the skin's section: heights of many sections at equal distances from the pocket's axis.

use super::Profile;
use super::percentile;
use serde::Serialize;

/// Points of a section's band, in equal steps of the distance.
const POINTS: usize = 81;

/// Percentiles (10, 50, 90) of the height of the skin's outer surface at one distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SectionBand {
    /// Distance from the pocket's axis \[mm\].
    pub r_mm: f64,
    /// Height above the wall \[mm\].
    pub z_mm: [f64; 3],
}

/// The band of sections, 81 points from the axis to the greatest distance. Empty without a section.
pub(super) fn section_band(profiles: &[&Profile]) -> Vec<SectionBand> {
    let ends = profiles.iter().filter_map(|profile| profile.r_mm.last().copied());
    let most = ends.fold(0.0, f64::max);
    let at = |point: usize| {
        let r_mm = most * point as f64 / (POINTS - 1) as f64;
        let heights = profiles.iter().filter_map(|profile| height(profile, r_mm)).collect();
        Some(SectionBand { r_mm, z_mm: percentile::band(heights)? })
    };
    (0..POINTS).filter_map(at).collect()
}

/// Height of a section at a distance \[mm\]: on a line between two points, the highest of an overhang. Beyond the last point
/// the tissue is at rest.
fn height(profile: &Profile, r_mm: f64) -> Option<f64> {
    let (r, z) = (&profile.r_mm, &profile.z_mm);
    if r_mm <= *r.first()? {
        return z.first().copied();
    }
    let crossing = |(r, z): (&[f64], &[f64])| {
        let part = (r_mm - r[0]) / (r[1] - r[0]);
        (0.0..=1.0).contains(&part).then(|| z[0] + (z[1] - z[0]) * part)
    };
    let crossings = r.windows(2).zip(z.windows(2)).filter_map(crossing);
    crossings.reduce(f64::max).or(z.last().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(r_mm: &[f64], z_mm: &[f64]) -> Profile {
        Profile { radius_mm: 10.0, r_mm: r_mm.to_vec(), z_mm: z_mm.to_vec() }
    }

    #[test]
    fn a_height_is_that_at_the_distance_and_not_at_the_material_point() {
        // The same straight flank with other material points: the band has no width.
        let coarse = profile(&[0.0, 10.0], &[20.0, 0.0]);
        let fine = profile(&[0.0, 3.0, 10.0], &[20.0, 14.0, 0.0]);
        let band = section_band(&[&coarse, &fine]);
        assert_eq!((band.len(), band[0].r_mm, band[80].r_mm), (POINTS, 0.0, 10.0));
        for point in &band {
            assert!(point.z_mm.iter().all(|z| (z - (20.0 - 2.0 * point.r_mm)).abs() < 1e-9));
        }
    }

    #[test]
    fn percentiles_lie_between_sections_and_an_overhang_counts_by_its_highest_point() {
        let flat = profile(&[0.0, 10.0], &[10.0, 10.0]);
        let overhang = profile(&[0.0, 8.0, 6.0, 8.0], &[30.0, 20.0, 10.0, 0.0]);
        let band = section_band(&[&flat, &overhang]);
        // At 7 mm of 10: 21.25 of the overhang's three heights.
        let point = &band[56];
        assert!((point.r_mm - 7.0).abs() < 1e-9);
        let expected = [0.1, 0.5, 0.9].map(|p| 10.0 + 11.25 * p);
        assert!(point.z_mm.iter().zip(expected).all(|(z, e)| (z - e).abs() < 1e-9), "{point:?}");
        // Beyond its end a section keeps its last height; without sections there is no band.
        assert!((band[80].z_mm[0] - 1.0).abs() < 1e-9);
        assert!(section_band(&[]).is_empty());
    }
}

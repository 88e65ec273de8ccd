//! Implants between two plates: height and diameter of the body that yields under a load, without tissue.
//!
//! The base lies on one plate, the other one is as high as the body's highest point. Of all numbers of its deformation the body has those of the least
//! energy E at that height, and the load is −dE/dH.
//!
//! Uses `table`. Used by `mod`.

use super::table::{Comparison, Mark, PlotAxis, Row, Series};
use implant_preview_core::contact::{Geometry, HalfBall, SoftHalfBall};
use implant_preview_core::scene::Fill;

/// Half of the diameter of the implants' planform, 108 cm², and projection \[mm\].
const BASE_RADIUS_MM: f64 = 58.5;
const PROJECTION_MM: f64 = 48.0;
/// The greatest load \[N\].
const LOAD_N: f64 = 534.0;
/// Decrease of the height \[-\] of gel implants under that load: 1.13 to 1.22 times that of a saline one, 50 %.
const LOWER: [f64; 2] = [0.565, 0.61];
/// Increase of the diameter \[-\]: 1.24 to 1.42 times that of a saline one, 35 %.
const WIDER: [f64; 2] = [0.434, 0.497];
/// Decrease of the height at which gel and saline part \[-\], and the load up to which they do not \[N\].
const PARTING: (f64, f64) = (0.25, 50.0);
/// Ranges of the taper and the shoulder of the maps \[-\].
const RANGES: [(f64, f64); 2] = [(-0.42, 1.0), (-0.15, 0.2)];
/// Greatest decrease of the height that is searched \[-\].
const MOST: f64 = 0.9;

/// Names of the quantities in the rows.
pub const HEIGHT: &str = "decrease of the height at 534 N";
/// The diameter.
pub const DIAMETER: &str = "increase of the diameter at 534 N";
/// The load.
pub const LOAD: &str = "load at a decrease of 25 % (N)";

/// An implant between plates.
#[derive(Clone, Debug)]
pub struct Pressed {
    body: SoftHalfBall,
    height_mm: f64,
}

impl Pressed {
    /// A round implant of a projection \[mm\] whose body has a modulus with the shell's part \[kPa\].
    #[must_use]
    pub fn new(base_radius_mm: f64, projection_mm: f64, modulus_kpa: f64) -> Self {
        let rest = HalfBall::round(base_radius_mm, projection_mm);
        Self { body: SoftHalfBall::at_rest(rest, modulus_kpa), height_mm: projection_mm }
    }

    /// The body of a taper and a shoulder, flattened to a height.
    fn body(&self, [taper, shoulder]: [f64; 2], decrease: f64) -> SoftHalfBall {
        let upright = self.body.clone().with_modes([0.0, taper, shoulder, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let flattening = 1.0 - self.height_mm * (1.0 - decrease) / upright.top();
        upright.with_modes([flattening, taper, shoulder, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// The body of least energy at a decrease of the height \[-\]: by steps along both numbers that halve.
    #[must_use]
    pub fn at(&self, decrease: f64) -> SoftHalfBall {
        let (mut found, mut step) = ([0.0; 2], 0.1);
        let mut least = self.body(found, decrease).energy();
        while step > 1e-6 {
            let mut is_better = false;
            for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
                let mut to = found;
                let (low, high) = RANGES[axis];
                to[axis] = (to[axis] + sign * step).clamp(low, high);
                let energy = self.body(to, decrease).energy();
                if energy < least {
                    (found, least, is_better) = (to, energy, true);
                }
            }
            if !is_better {
                step *= 0.5;
            }
        }
        self.body(found, decrease)
    }

    /// The load at a decrease of the height \[N\].
    #[must_use]
    pub fn load_n(&self, decrease: f64) -> f64 {
        const STEP: f64 = 1e-3;
        let [less, more] = [-STEP, STEP].map(|step| self.at(decrease + step).energy());
        // kPa·mm² are mN.
        1e-3 * (more - less) / (2.0 * STEP * self.height_mm)
    }

    /// The decrease of the height under a load \[N\] \[-\].
    #[must_use]
    pub fn decrease(&self, load_n: f64) -> f64 {
        let (mut less, mut more) = (0.0, MOST);
        for _ in 0..30 {
            let middle = 0.5 * (less + more);
            *(if self.load_n(middle) < load_n { &mut less } else { &mut more }) = middle;
        }
        0.5 * (less + more)
    }
}

/// The comparison.
#[must_use]
pub fn comparison() -> Comparison {
    let (mut rows, mut series) = (Vec::new(), Vec::new());
    series.push(Series::band(
        "gel, measured",
        [100.0 * LOWER[0], 100.0 * LOWER[1]],
        [514.0, 554.0],
    ));
    for (name, fill) in Fill::NAMED {
        let pressed = Pressed::new(BASE_RADIUS_MM, PROJECTION_MM, fill.modulus_kpa(BASE_RADIUS_MM));
        let decrease = pressed.decrease(LOAD_N);
        let wider = pressed.at(decrease).greatest_half_axes().x / BASE_RADIUS_MM - 1.0;
        let is_gel = fill != Fill::Saline;
        let model = name.replace('_', "-");
        let mut row = |quantity: &str, gel: [f64; 2], saline: f64, predicted: f64| {
            rows.push(Row {
                quantity: quantity.to_owned(),
                model: model.clone(),
                at: None,
                measured: (!is_gel).then_some(saline),
                range: is_gel.then_some(gel),
                predicted: Some(predicted),
            });
        };
        row(HEIGHT, LOWER, 0.5, decrease);
        row(DIAMETER, WIDER, 0.35, wider);
        let (parting, load) = PARTING;
        rows.push(Row {
            quantity: LOAD.to_owned(),
            model: model.clone(),
            at: Some(parting),
            measured: Some(load),
            range: None,
            predicted: Some(pressed.load_n(parting)),
        });
        series.push(Series {
            label: model,
            mark: Mark::Line,
            points: (0..=32)
                .map(|k| 0.02 * f64::from(k))
                .map(|d| (100.0 * d, pressed.load_n(d)))
                .collect(),
        });
    }
    Comparison {
        name: "plates",
        title: "Implants between plates: height and diameter under a load",
        source: "Brandon, Nichter, Back, Bioengineering 2019, 6, 43: round implants of 11.7 to 11.8 cm, lubricated, up to 534 N. Saline: height −50 %, \
                 diameter +35 %; gel 13 to 22 % and 24 to 42 % more. All alike up to 50 N, apart from 25 % on.",
        unit: "unit of the row",
        argument: "decrease of the height",
        rows,
        remarks: vec![
            "Gel and shell of the fills were chosen from this source, by axisymmetric elements between plates (gel of 10 to 20 kPa, shell of 500 to \
             1000 kPa·mm); E* then from elements under tissue. The few numbers of the deformation were never held against plates."
                .to_owned(),
            "The maps have no flat top: between plates the body touches the upper one in a point or a ring, where implants have an area. Tissue \
             follows the body, plates do not."
                .to_owned(),
            format!(
                "A half-ellipsoid {BASE_RADIUS_MM} mm in radius and {PROJECTION_MM} mm high (assumed; the source names the planform), without friction."
            ),
        ],
        axes: [
            PlotAxis { name: "decrease of the height (%)", range: [0.0, 65.0], decimals: 0, labels: 7 },
            PlotAxis { name: "load (N)", range: [0.0, 700.0], decimals: 0, labels: 8 },
        ],
        series,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_work_of_the_load_is_the_energy_and_the_volume_stays() {
        let pressed = Pressed::new(58.5, 48.0, 44.0);
        let to = 0.4;
        // Simpson's rule.
        let load = |k: u32| pressed.load_n(to * f64::from(k) / 8.0);
        let weight = |k: u32| f64::from(if k == 0 || k == 8 { 1 } else { 2 + 2 * (k % 2) });
        let work = (0..=8).map(|k| weight(k) * load(k)).sum::<f64>() * to * 48.0 / 24.0;
        let body = pressed.at(to);
        assert!((1e3 * work / body.energy() - 1.0).abs() < 5e-3, "{work} {}", body.energy());
        assert!((body.top() / (0.6 * 48.0) - 1.0).abs() < 1e-12);
        let load = pressed.load_n(0.3);
        assert!((pressed.decrease(load) - 0.3).abs() < 1e-6);
        // The load is proportional to the modulus.
        let stiffer = Pressed::new(58.5, 48.0, 88.0).load_n(0.3);
        assert!((stiffer / load - 2.0).abs() < 1e-4);
    }
}

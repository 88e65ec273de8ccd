//! Skin under tension: how far a hole opens, how far an excised piece shrinks.
//!
//! A round hole in a wide sheet: with r(R) of a material radius R without stress, stretches r′ and r/R and their nominal stresses S₁, S₂ the balance is
//! (R S₁)′ = S₂, S₁ = 0 at the edge and S₁ + S₂ twice the natural stress far away, where a disturbance 1/R² cancels.
//!
//! Uses `table`. Used by `mod`.

use super::table::{Comparison, Mark, PlotAxis, Row, Series};
use implant_preview_core::curve::Curve;
use implant_preview_core::scene::{CheckedScene, Scene};
use implant_preview_core::springs::Material;
use implant_preview_core::springs::tension_field::{strain_of, stress};

/// Natural tensions of skin \[N/m\]: the middle, by its spread less and more.
const TENSIONS_N_PER_M: [f64; 3] = [9.1, 20.0, 44.0];
/// Area of wounds in dogs after / before − 1, of excised skin of dogs and of pigs \[-\].
const WOUND: f64 = 0.09;
const EXCISED_DOG: f64 = -0.33;
const EXCISED_PIG: f64 = 0.83 * 0.83 - 1.0;
/// Natural stretch of pig skin \[-\]: 1.08 ± 0.06 of 4 pigs.
const PIG_STRETCH: [f64; 2] = [1.02, 1.14];
/// The material radius up to which the sheet is followed \[radii of the hole\], in equal steps of its logarithm.
const FAR: f64 = 30.0;
const STEPS: usize = 200;
const BISECTIONS: usize = 60;
/// Greatest strain of the skin \[-\].
const MOST_STRAIN: f64 = 0.9;

/// Quantity of the rows of wounds.
pub const HOLE: &str = "area of a hole after cutting / before − 1";

/// A sheet under the same tension in all directions.
#[derive(Debug)]
pub struct Sheet<'a> {
    curve: &'a Curve,
    poisson_ratio: f64,
    /// Nominal stress \[kPa\].
    stress: f64,
}

impl<'a> Sheet<'a> {
    /// A sheet of a material under a tension \[N/m\].
    #[must_use]
    pub fn new(material: &'a Material, tension_n_per_m: f64) -> Self {
        let Material { curve, poisson_ratio, thickness_mm, .. } = material;
        Self { curve, poisson_ratio: *poisson_ratio, stress: tension_n_per_m / thickness_mm }
    }

    /// The stretch under the tension \[-\]; `None` beyond a strain of 0.9.
    #[must_use]
    pub fn stretch(&self) -> Option<f64> {
        let strain = strain_of(self.curve, self.poisson_ratio, [self.stress; 2], MOST_STRAIN)?;
        Some(1.0 + strain[0])
    }

    fn nominal(&self, stretches: [f64; 2]) -> [f64; 2] {
        stress(self.curve, self.poisson_ratio, stretches.map(|stretch| stretch - 1.0))
    }

    /// The stretch along the radius at a stress there and a stretch around.
    fn radial(&self, radial_stress: f64, around: f64) -> f64 {
        // Of uniaxial tension around, and beyond the natural stretch.
        let (mut less, mut more) = (1.0 - self.poisson_ratio * (around - 1.0), 1.0 + MOST_STRAIN);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (less + more);
            let is_less = self.nominal([middle, around])[0] < radial_stress;
            *(if is_less { &mut less } else { &mut more }) = middle;
        }
        0.5 * (less + more)
    }

    /// Derivatives of r and R S₁ by ln R.
    fn slopes(&self, radius: f64, [place, pull]: [f64; 2]) -> [f64; 2] {
        let around = place / radius;
        let along = self.radial(pull / radius, around);
        [radius * along, radius * self.nominal([along, around])[1]]
    }

    /// S₁ + S₂ far from a hole whose edge is stretched by a factor \[kPa\].
    fn far_from(&self, edge: f64) -> f64 {
        let step = FAR.ln() / STEPS as f64;
        let mut state = [edge, 0.0];
        for k in 0..STEPS {
            let radius = |part: f64| (step * (k as f64 + part)).exp();
            let after =
                |slopes: [f64; 2], part: f64| [0, 1].map(|i| state[i] + part * step * slopes[i]);
            let first = self.slopes(radius(0.0), state);
            let second = self.slopes(radius(0.5), after(first, 0.5));
            let third = self.slopes(radius(0.5), after(second, 0.5));
            let last = self.slopes(radius(1.0), after(third, 1.0));
            for i in 0..2 {
                state[i] += step / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + last[i]);
            }
        }
        let (around, radial) = (state[0] / FAR, state[1] / FAR);
        radial + self.nominal([self.radial(radial, around), around])[1]
    }

    /// Area of a hole after it is cut / before − 1 \[-\].
    #[must_use]
    pub fn opening(&self) -> Option<f64> {
        let natural = self.stretch()?;
        let (mut less, mut more) = (natural, 1.0 + MOST_STRAIN);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (less + more);
            let is_less = self.far_from(middle) < 2.0 * self.stress;
            *(if is_less { &mut less } else { &mut more }) = middle;
        }
        Some((0.5 * (less + more) / natural).powi(2) - 1.0)
    }
}

/// Skins of the rows: that of the class normal is laxer under a tension, since its pull then counts under it.
const SKINS: [&str; 2] = ["skin of class normal", "skin of strain scale 0.5"];

/// The opening plan's skin under a tension, of its class or as it is without a tension; `None` of a tension that the class does not bear.
fn skin(name: &str, tension_n_per_m: f64) -> Option<Material> {
    let mut scene = Scene::opening();
    if name == SKINS[0] {
        scene.set_natural_tension(tension_n_per_m).ok()?;
    }
    CheckedScene::new(scene).ok()?.materials().first().cloned()
}

/// The comparison.
#[must_use]
pub fn comparison() -> Comparison {
    let mut rows = Vec::new();
    let all = SKINS.into_iter().flat_map(|name| TENSIONS_N_PER_M.map(|tension| (name, tension)));
    for (name, tension) in all {
        let skin = skin(name, tension);
        let sheet = skin.as_ref().map(|skin| Sheet::new(skin, tension));
        let stretch = sheet.as_ref().and_then(Sheet::stretch);
        let shrinks = stretch.map(|stretch| stretch.powi(-2) - 1.0);
        let mut row =
            |quantity: &str, measured: Option<f64>, range: Option<[f64; 2]>, predicted| {
                rows.push(Row {
                    quantity: quantity.to_owned(),
                    model: name.to_owned(),
                    at: Some(tension),
                    measured,
                    range,
                    predicted,
                });
            };
        row(HOLE, Some(WOUND), None, sheet.as_ref().and_then(Sheet::opening));
        row("area of excised skin after / before − 1 (dog)", Some(EXCISED_DOG), None, shrinks);
        row("area of excised skin after / before − 1 (pig)", Some(EXCISED_PIG), None, shrinks);
        row("natural stretch (pig)", None, Some(PIG_STRETCH), stretch);
    }
    rows.sort_by_key(|row| row.quantity != HOLE);
    let line = |name: &str| {
        let opens = |tension| Some(100.0 * Sheet::new(&skin(name, tension)?, tension).opening()?);
        let tensions = (1..=25).map(|k| 2.0 * f64::from(k));
        Series {
            label: format!("hole in {name}"),
            mark: Mark::Line,
            points: tensions.filter_map(|tension| Some((tension, opens(tension)?))).collect(),
        }
    };
    let [of_class, of_scale] = SKINS.map(line);
    Comparison {
        name: "hole",
        title: "Skin under tension: a hole opens, an excised piece shrinks",
        source: "Dogs: wounds open by 9 % in area, excised skin loses 33 % (arXiv 1609.07267, abstract). Pigs: excised skin 0.83 × 0.83 of its size \
                 (PMC4520804, abstract); 4 pigs, natural stretch 1.08 ± 0.06.",
        unit: "",
        argument: "natural tension (N/m)",
        rows,
        remarks: vec![
            "Skin of animals against the model of a woman's: what differs by is the animal's as much as the model's. The tension, 20 N/m with a \
             geometric standard deviation of 2.2, is from measurements of people's skin, none from wounds."
                .to_owned(),
            "The sheet is free of what lies below, which holds a wound's edges back.".to_owned(),
            "The stretch by which skin shrinks when it is excised is greater than the one by which a wound opens: the sources contradict each \
             other if the same tension is behind both."
                .to_owned(),
        ],
        axes: [
            PlotAxis { name: "natural tension (N/m)", range: [0.0, 50.0], decimals: 0, labels: 6 },
            PlotAxis { name: "area of a hole (%)", range: [0.0, 40.0], decimals: 0, labels: 5 },
        ],
        series: vec![
            Series {
                label: "wounds in dogs, tension not known".to_owned(),
                mark: Mark::Points,
                points: [5.0, 20.0, 45.0].map(|tension| (tension, 100.0 * WOUND)).to_vec(),
            },
            of_class,
            of_scale,
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use implant_preview_core::curve::CurveSpec;

    /// A hole in an elastic plane: the edge moves by (1 + ν)σ/E of its radius beyond the natural strain.
    #[test]
    fn a_hole_under_a_small_tension_opens_as_in_an_elastic_plane() {
        let curve = Curve::new(&CurveSpec::Linear { modulus_kpa: 100.0 }).unwrap();
        for poisson_ratio in [0.0, 0.3, 0.45] {
            let material = Material::new(curve.clone(), poisson_ratio, 1.5);
            for tension in [0.015, 0.15] {
                let strain = tension / 1.5 / 100.0;
                let found = Sheet::new(&material, tension).opening().unwrap();
                let expected = 2.0 * (1.0 + poisson_ratio) * strain;
                assert!((found / expected - 1.0).abs() < 3.0 * strain + 2e-4, "{found} {expected}");
            }
        }
    }

    #[test]
    fn the_stretch_of_a_sheet_is_that_of_its_tension() {
        let skin = skin(SKINS[0], 20.0).unwrap();
        let stretch = Sheet::new(&skin, 20.0).stretch().unwrap();
        let tension = 1.5 * stress(&skin.curve, skin.poisson_ratio, [stretch - 1.0; 2])[0];
        assert!((tension / 20.0 - 1.0).abs() < 1e-9 && stretch > 1.02);
    }
}

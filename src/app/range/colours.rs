//! The colours of the range of implants: bands with words where a quantity has limits, else an even scale; the picture of
//! all points as one texture.

use super::plane::marks;
use super::readout;
use crate::app::texts::{fixed, tr, word_of};
use crate::app::widgets::theme;
use crate::clinical::STEP_ML;
use crate::measure::bands::{Band, Limits, PracticeStretch};
use crate::study::{JudgedMap, PointStatus, Quantity};
use crate::view::color::{Rgb, in_band, sequential};
use eframe::egui::{Color32, ColorImage};

/// Pixels of the picture along each axis: fine enough for sharp borders of bands.
const PIXELS: usize = 192;
/// Opacity of values between solved points that are still being computed.
const UNSOLVED: f32 = 0.55;

/// The colours of a quantity over its values, in its displayed unit.
pub(super) struct Scale {
    /// Least and greatest displayed value; with limits the limits around the values of the map.
    pub(super) ends: (f64, f64),
    /// The displayed value from which the colours do not change any more.
    most: f64,
    /// Limits with words, and the factor from a displayed value to their unit.
    pub(super) limits: Option<(Limits, f64)>,
    pub(super) unit: &'static str,
    factor: f64,
    quantity: Quantity,
    /// Is the scale grey, without numbers and words?
    is_waiting: bool,
}

impl Scale {
    /// The scale of a quantity with its limits on a map, if it has any; `range`: its least and greatest value there.
    pub(super) fn new(
        quantity: Quantity,
        limits: Option<(Limits, f64)>,
        range: Option<(f64, f64)>,
    ) -> Self {
        let (factor, unit) = quantity.display();
        let limits = limits.map(|(limits, to_limits)| (limits, to_limits / factor));
        let ends = match (&limits, range) {
            (Some((limits, to_limits)), range) => {
                let greatest = range.map_or(f64::INFINITY, |(_, most)| factor * most);
                let mut shown =
                    limits.bands.iter().filter_map(|band| Some(band.limit? / to_limits));
                let most = shown.find(|limit| *limit >= greatest);
                let least = range.map_or(0.0, |(least, _)| factor * least);
                let below = limits.bands.iter().filter_map(|band| Some(band.limit? / to_limits));
                let from = below.filter(|limit| *limit <= least).fold(0.0, f64::max);
                (from, most.unwrap_or(end(limits) / to_limits))
            }
            (None, Some((least, most))) => {
                let (least, most) = (factor * least, factor * most);
                if most > least { (least, most) } else { (least - 0.5, least + 0.5) }
            }
            (None, None) => (0.0, 1.0),
        };
        let most = limits.as_ref().map_or(ends.1, |(limits, to_limits)| end(limits) / to_limits);
        Self { ends, most, limits, unit, factor, quantity, is_waiting: false }
    }

    /// The scale of a quantity whose limits, those of practice, are not known yet: grey, without numbers and words.
    pub(super) fn waiting(quantity: Quantity, range: Option<(f64, f64)>) -> Self {
        Self { is_waiting: true, ..Self::new(quantity, None, range) }
    }

    /// Colour of a value \[unit of the quantity\].
    pub(super) fn color(&self, value: f64) -> Color32 {
        self.displayed(self.factor * value)
    }

    /// Colour of a displayed value.
    pub(super) fn displayed(&self, value: f64) -> Color32 {
        let (least, most) = self.ends;
        theme::color32(match &self.limits {
            Some((limits, to_limits)) => {
                in_band(limits, to_limits * self.most, (to_limits * value) as f32)
            }
            None if self.is_waiting => grey(((value - least) / (most - least)) as f32),
            None => sequential(((value - least) / (most - least)) as f32),
        })
    }

    /// Is the scale that of practice?
    pub(super) fn is_practice(&self) -> bool {
        self.limits.as_ref().is_some_and(|(limits, _)| limits.is_of_practice())
    }

    /// The volume of a displayed limit of practice against practice's; `None` for another limit.
    fn step_of_practice(&self, limit: f64) -> Option<String> {
        let (limits, to_limits) = self.limits.as_ref().filter(|_| self.is_practice())?;
        let is_limit =
            |band: &Band| band.limit.is_some_and(|v| (v / to_limits - limit).abs() < 1e-9);
        let sign = limits.bands.iter().position(is_limit).and_then(|k| ["−", "+"].get(k))?;
        Some(format!("{sign}{STEP_ML:.0} ml"))
    }

    /// The number of a displayed limit, as "54" or "+30 ml".
    fn text_of_limit(&self, limit: f64) -> String {
        self.step_of_practice(limit).unwrap_or_else(|| format!("{limit:.0}"))
    }

    /// A level of the contour lines \[unit of the quantity\] with its unit, as "54 %" or "practice +30 ml".
    pub(super) fn text(&self, level: f64) -> String {
        self.step_of_practice(self.factor * level).map_or_else(
            || readout::text(self.quantity, level),
            |step| tr!("practice {step}", step),
        )
    }

    /// Marked values, and the word of the band above each where there are limits.
    pub(super) fn marks(&self) -> Vec<(f64, String)> {
        match &self.limits {
            Some((limits, to_limits)) => {
                let limits = limits.bands.iter().filter_map(|band| band.limit);
                let (from, to) = self.ends;
                let shown = limits.map(|limit| limit / to_limits);
                let shown = shown.filter(|v| *v > 0.0 && (from..=to).contains(v));
                shown.map(|v| (v, self.text_of_limit(v))).collect()
            }
            None if self.is_waiting => Vec::new(),
            None => {
                let values = marks(self.ends, 5);
                let step = values.windows(2).next().map_or(1.0, |pair| pair[1] - pair[0]);
                let decimals = (-(step.log10() + 1e-9).floor()).clamp(0.0, 4.0) as usize;
                values.into_iter().map(|value| (value, fixed(value, decimals))).collect()
            }
        }
    }

    /// The words for which the legend keeps room before they are known: those of practice.
    pub(super) fn words_to_come(&self) -> &'static [&'static str] {
        match self.quantity {
            Quantity::GreatestStrain => &PracticeStretch::WORDS,
            _ => &[],
        }
    }

    /// Words at the middle of their bands, as far as these are shown.
    pub(super) fn words(&self) -> Vec<(f64, &'static str)> {
        let Some((limits, to_limits)) = &self.limits else { return Vec::new() };
        let mut from = self.ends.0;
        let word = |band: &Band| {
            let to = band.limit.map_or(self.ends.1, |limit| limit / to_limits).min(self.ends.1);
            let middle = (to > from).then_some(0.5 * (from + to));
            from = from.max(to);
            Some((middle?, word_of(limits, band.word)))
        };
        limits.bands.iter().filter_map(word).collect()
    }
}

/// End of the bars of limits, as in the answer \[unit of the limits\].
fn end(limits: &Limits) -> f64 {
    1.25 * limits.bands.iter().filter_map(|band| band.limit).next_back().unwrap_or(1.0)
}

/// A grey from light to dark for 0 to 1.
fn grey(t: f32) -> Rgb {
    [0.85 - 0.4 * t.clamp(0.0, 1.0); 3]
}

/// The picture of a map of two axes, the first row at the top of the chart. Values between points are interpolated; cells
/// with a point that is not computed are striped, those of points solved in full without an answer are crossed, cells without
/// any value are transparent.
pub(super) fn picture(
    map: JudgedMap<'_>,
    quantity: Quantity,
    scale: &Scale,
    stripes: Color32,
) -> ColorImage {
    let (columns, rows) = map.shape();
    let points: Vec<Point> = (0..rows)
        .flat_map(|j| (0..columns).map(move |i| (i, j)))
        .map(|(i, j)| Point::new(map, quantity, i, j))
        .collect();
    let place = |pixel: usize, count: usize| {
        let position = (pixel as f64 + 0.5) / PIXELS as f64 * (count - 1) as f64;
        let low = (position as usize).min(count - 2);
        (low, position - low as f64)
    };
    let mut pixels = Vec::with_capacity(PIXELS * PIXELS);
    for row in (0..PIXELS).rev() {
        let (j, v) = place(row, rows);
        for column in 0..PIXELS {
            let (i, u) = place(column, columns);
            let corner = |a: usize, b: usize| points[(j + b) * columns + i + a];
            let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
            let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
            let is_missing = |missing| corners.iter().any(|point| point.missing == Some(missing));
            let is_on = [row + column, row + PIXELS - column].map(|diagonal| diagonal % 8 < 3);
            pixels.push(if is_missing(Missing::NotComputed) {
                if is_on[0] { stripes } else { Color32::TRANSPARENT }
            } else if is_missing(Missing::NoAnswer) {
                if is_on[0] || is_on[1] { stripes } else { Color32::TRANSPARENT }
            } else {
                let value: f64 = corners.iter().zip(weights).map(|(p, w)| p.value * w).sum();
                let opacity =
                    if corners.iter().all(|point| point.is_solved) { 1.0 } else { UNSOLVED };
                if value.is_finite() {
                    scale.color(value).gamma_multiply(opacity)
                } else {
                    Color32::TRANSPARENT
                }
            });
        }
    }
    ColorImage::new([PIXELS, PIXELS], pixels)
}

/// A point of the map for the picture.
#[derive(Clone, Copy)]
struct Point {
    /// Not a number where no value is known.
    value: f64,
    is_solved: bool,
    /// Why the point has no value at the end.
    missing: Option<Missing>,
}

/// Why a point has no value.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Missing {
    /// The quick solve has no answer.
    NotComputed,
    /// The full solve has no answer, or the plan is out of its limits.
    NoAnswer,
}

impl Point {
    fn new(map: JudgedMap<'_>, quantity: Quantity, i: usize, j: usize) -> Self {
        let displayed = map.scaled(quantity, i, j);
        Self {
            value: displayed.map_or(f64::NAN, |(value, _)| value),
            is_solved: displayed.is_some_and(|(_, is_solved)| is_solved),
            missing: match map.status(i, j) {
                _ if displayed.is_some() => None,
                // Practice says nothing here.
                PointStatus::Converged if map.value(quantity, i, j).is_some() => None,
                PointStatus::Waiting => None,
                PointStatus::Converged | PointStatus::Invalid => Some(Missing::NoAnswer),
                _ if readout::is_final(&map, i, j) => Some(Missing::NoAnswer),
                _ => Some(Missing::NotComputed),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::bands::SkinLimits;
    use crate::scene::Scene;
    use crate::study::{Axis, Cases, Map, MapSettings, Study, evaluate};

    #[test]
    fn colours_change_at_the_limits_and_the_words_stand_in_their_bands() {
        let scale_of_range = |quantity: Quantity, range| {
            Scale::new(quantity, quantity.limits(SkinLimits::Tearing), range)
        };
        let scale = scale_of_range(Quantity::GreatestStrain, None);
        assert!((scale.ends.1 - 67.5).abs() < 1e-9);
        let labels: Vec<String> = scale.marks().into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["25", "50", "54"]);
        assert_ne!(scale.color(0.2499), scale.color(0.2501));
        let words = scale.words();
        assert_eq!(words.iter().map(|(_, word)| *word).collect::<Vec<_>>()[0], "usual");
        assert!(words.windows(2).all(|pair| pair[0].0 < pair[1].0));
        let scale_of = |most| scale_of_range(Quantity::GreatestPressureMmhg, Some((1.0, most)));
        let pressure = scale_of_range(Quantity::GreatestPressureMmhg, Some((1.0, 2.0)));
        assert_eq!((pressure.ends, pressure.words()), ((0.0, 60.0), vec![(30.0, "usual")]));
        assert_eq!((pressure.marks().len(), pressure.color(59.0)), (1, scale_of(90.0).color(59.0)));
        assert_eq!((scale_of(90.0).ends, scale_of(90.0).words().len()), ((0.0, 100.0), 3));
        assert_eq!((scale_of(70.0).ends, scale_of(70.0).words().len()), ((0.0, 80.0), 2));
        // The legend begins at the last limit below the values.
        let strained = scale_of_range(Quantity::GreatestStrain, Some((0.3, 0.45)));
        assert_eq!((strained.ends, strained.words()), ((25.0, 50.0), vec![(37.5, "high")]));
        assert_eq!(strained.color(0.3), scale.color(0.3));
        let waiting = Scale::waiting(Quantity::GreatestStrain, Some((0.3, 0.45)));
        assert_eq!((waiting.marks().len(), waiting.words().len()), (0, 0));
        for strain in [0.3, 0.4, 0.45] {
            let [r, g, b, _] = waiting.color(strain).to_array();
            assert!(r == g && g == b, "{strain}");
        }
        let cover = scale_of_range(Quantity::LeastCoverMm, Some((3.0, 9.0)));
        assert_eq!((cover.ends, cover.words().len()), ((3.0, 9.0), 0));
        assert_ne!(cover.color(3.0), cover.color(9.0));
    }

    #[test]
    fn pixels_are_clear_before_faint_while_and_opaque_after_the_solve() {
        let axes = ["base_width_mm=100:120:3", "projection_mm=30:40:3"];
        let axes = axes.map(|axis| Axis::parse(axis).unwrap());
        let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
        let mut map = Map::new(&Scene::sheet(), &axes, settings).unwrap();
        let quantity = Quantity::SkinProjectionMm;
        let scale = Scale::new(quantity, None, Some((30.0, 60.0)));
        let image = |map: &Map| {
            picture(JudgedMap { map, practice: None }, quantity, &scale, Color32::RED).pixels
        };
        assert!(image(&map).iter().all(|pixel| *pixel == Color32::TRANSPARENT));
        let mut store = Cases::default();
        while let Some((index, job)) = map.next_job(&mut store) {
            map.receive(index, evaluate(&job), &mut store);
        }
        let pixels = image(&map);
        assert!(pixels.iter().all(Color32::is_opaque));
        // The last pixels of the picture are those of the first row of points.
        let value = map.value(quantity, 0, 0).unwrap();
        let near = |a: Color32, b: Color32| a.r().abs_diff(b.r()) + a.g().abs_diff(b.g()) < 4;
        assert!(near(pixels[(PIXELS - 1) * PIXELS], scale.color(value)));
    }
}

//! A map whose strains are compared with practice. Each point has a practice of its own, by its tissue and base width; one scale
//! for all of them is that of the plan's practice.

use super::contour::Path;
use super::{Map, Quantity};
use crate::measure::STRAIN_BANDS;
use crate::measure::bands::{Limits, PracticeStretch, SkinLimits};

/// What the strains of the points of a map are compared with.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPractice {
    /// Practice of the plan, which has the scale.
    plan: PracticeStretch,
    /// The axis along which practice varies: 0 or 1.
    along: usize,
    /// Practice of the points along that axis; `None` where practice says nothing.
    points: Vec<Option<PracticeStretch>>,
}

impl MapPractice {
    /// Practice of a plan, and of the points of its map along an axis (0: x, 1: y).
    #[must_use]
    pub fn new(plan: PracticeStretch, along: usize, points: Vec<Option<PracticeStretch>>) -> Self {
        Self { plan, along, points }
    }

    /// Practice of a point.
    #[must_use]
    pub fn of(&self, i: usize, j: usize) -> Option<PracticeStretch> {
        self.points.get([i, j][self.along]).copied().flatten()
    }

    /// Does practice say nothing about some of the points?
    #[must_use]
    pub fn has_gaps(&self) -> bool {
        self.points.contains(&None)
    }

    /// A strain \[-\] at a point on the scale of the plan: its practice's limits become those of the plan's, straight between them, and
    /// strains that tear stay. `None` where practice says nothing.
    fn scaled(&self, strain: f64, i: usize, j: usize) -> Option<f64> {
        let [_, high, _] = STRAIN_BANDS;
        let own = self.of(i, j)?;
        let ends = |of: PracticeStretch| [0.0, of.less.min(high), of.more.min(high), high];
        let (from, to) = (ends(own), ends(self.plan));
        let piece = (0..3).find(|k| strain <= from[k + 1]);
        Some(piece.map_or(strain, |k| {
            let part = (strain - from[k]) / (from[k + 1] - from[k]).max(1e-12);
            to[k] + part * (to[k + 1] - to[k])
        }))
    }
}

/// A map with what its strains are compared with: the skin's own limits, or practice.
#[derive(Clone, Copy, Debug)]
pub struct JudgedMap<'a> {
    /// The map.
    pub map: &'a Map,
    /// Practice, where that is known.
    pub practice: Option<&'a MapPractice>,
}

impl std::ops::Deref for JudgedMap<'_> {
    type Target = Map;

    fn deref(&self) -> &Map {
        self.map
    }
}

impl JudgedMap<'_> {
    /// Practice at values of the axes, straight between points; `None` where practice says nothing.
    #[must_use]
    pub fn practice_at(&self, x: f64, y: f64) -> Option<PracticeStretch> {
        let practice = self.practice?;
        let axis = self.map.axes().get(practice.along)?;
        let last = (axis.count - 1) as f64;
        let value = [x, y][practice.along];
        let position = ((value - axis.from) / (axis.to - axis.from) * last).clamp(0.0, last);
        let low = (position.floor() as usize).min(axis.count - 2);
        let part = position - low as f64;
        let point = |k: usize| practice.points.get(k).copied().flatten();
        // A point without weight need not have a practice.
        if part < 1e-9 {
            return point(low);
        }
        if part > 1.0 - 1e-9 {
            return point(low + 1);
        }
        let (low, high) = (point(low)?, point(low + 1)?);
        let between = |of: fn(PracticeStretch) -> f64| of(low) + part * (of(high) - of(low));
        Some(PracticeStretch {
            less: between(|it| it.less),
            same: between(|it| it.same),
            more: between(|it| it.more),
        })
    }

    /// Practice at a point.
    #[must_use]
    pub fn practice_of_point(&self, i: usize, j: usize) -> Option<PracticeStretch> {
        self.practice?.of(i, j)
    }

    /// The two lines along which the strain of a map of one axis gets that of practice's volumes a step less and a step more, as x and
    /// strain \[-\]; empty without practice.
    #[must_use]
    pub fn practice_lines(&self) -> [Vec<(f64, f64)>; 2] {
        let (Some(practice), [x]) = (self.practice, self.map.axes()) else {
            return Default::default();
        };
        let line = |of: fn(PracticeStretch) -> f64| {
            (0..x.count).filter_map(|i| Some((x.value(i), of(practice.of(i, 0)?)))).collect()
        };
        [line(|it| it.less), line(|it| it.more)]
    }
    /// Practice, if a quantity is compared with it.
    fn practice_of(&self, quantity: Quantity) -> Option<&MapPractice> {
        self.practice.filter(|_| quantity == Quantity::GreatestStrain)
    }

    /// The limits of a quantity, and the factor from a value of [`Self::scaled`] to their unit; as [`Map::limits`] without practice.
    #[must_use]
    pub fn limits(&self, quantity: Quantity) -> Option<(Limits, f64)> {
        match self.practice_of(quantity) {
            Some(practice) => Some(SkinLimits::Practice(practice.plan).limits()),
            None => self.map.limits(quantity),
        }
    }

    /// The value at a point on the scale of [`Self::limits`], and whether the value is solved; as [`Map::displayed`] without
    /// practice.
    #[must_use]
    pub fn scaled(&self, quantity: Quantity, i: usize, j: usize) -> Option<(f64, bool)> {
        let (value, is_solved) = self.map.displayed(quantity, i, j)?;
        let value = match self.practice_of(quantity) {
            Some(practice) => practice.scaled(value, i, j)?,
            None => value,
        };
        Some((value, is_solved))
    }

    /// Least and greatest solved value on the scale of [`Self::limits`].
    #[must_use]
    pub fn range(&self, quantity: Quantity) -> Option<(f64, f64)> {
        if self.practice_of(quantity).is_none() {
            return self.map.range(quantity);
        }
        let values = self.field(quantity).into_iter().filter(|value| value.is_finite());
        values.map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// The contour lines of a value on the scale of [`Self::limits`], as [`Map::contours`].
    #[must_use]
    pub fn contours(&self, quantity: Quantity, level: f64) -> Vec<Path> {
        self.map.lines(self.field(quantity), level)
    }

    /// Solved values row by row on the scale of [`Self::limits`]; not a number elsewhere.
    fn field(&self, quantity: Quantity) -> Vec<f64> {
        let (columns, rows) = self.map.shape();
        let points = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        let solved = |(i, j)| self.scaled(quantity, i, j).filter(|(_, is_solved)| *is_solved);
        points.map(|at| solved(at).map_or(f64::NAN, |(value, _)| value)).collect()
    }

    /// The levels of the contour lines on the scale of [`Self::limits`], as [`Map::levels`].
    #[must_use]
    pub fn levels(&self, quantity: Quantity) -> Vec<f64> {
        match self.practice_of(quantity).and_then(|_| self.limits(quantity)) {
            Some((limits, _)) => limits.bands.iter().filter_map(|band| band.limit).collect(),
            None => self.map.levels(quantity),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::study::{Axis, Cases, MapSettings, Study, evaluate};

    const PLAN: PracticeStretch = PracticeStretch { less: 0.2, same: 0.21, more: 0.22 };
    const WIDE: PracticeStretch = PracticeStretch { less: 0.3, same: 0.32, more: 0.34 };

    #[test]
    fn a_strain_on_the_scale_of_the_plan_has_the_word_of_its_own_practice() {
        let practice = MapPractice::new(PLAN, 0, vec![Some(PLAN), Some(WIDE), None]);
        for strain in (0..700).map(|k| 1e-3 * f64::from(k) + 5e-4) {
            for (i, own) in [PLAN, WIDE].into_iter().enumerate() {
                let scaled = practice.scaled(strain, i, 7).unwrap();
                assert_eq!(PLAN.verdict(scaled), own.verdict(strain), "{strain} {scaled}");
            }
            assert!((practice.scaled(strain, 0, 0).unwrap() - strain).abs() < 1e-12);
        }
        assert_eq!(practice.scaled(0.2, 2, 0), None);
        let along_y = MapPractice::new(PLAN, 1, vec![Some(PLAN), Some(WIDE)]);
        assert_eq!(along_y.of(7, 1), Some(WIDE));
    }

    #[test]
    fn a_map_without_practice_is_the_map_itself() {
        let axes = ["base_width_mm=110:130:3", "projection_mm=30:40:3"];
        let axes = axes.map(|axis| Axis::parse(axis).unwrap());
        let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
        let mut map = Map::new(&Scene::opening(), &axes, settings).unwrap();
        let mut store = Cases::default();
        while let Some((index, job)) = map.next_job(&mut store) {
            map.receive(index, evaluate(&job), &mut store);
        }
        let strain = Quantity::GreatestStrain;
        let plain = JudgedMap { map: &map, practice: None };
        assert_eq!(plain.scaled(strain, 1, 1), map.displayed(strain, 1, 1));
        assert_eq!(plain.range(strain), map.range(strain));
        assert_eq!(plain.levels(strain), map.levels(strain));
        let practice = MapPractice::new(PLAN, 0, vec![None, Some(PLAN), Some(WIDE)]);
        let judged = JudgedMap { map: &map, practice: Some(&practice) };
        assert_eq!(judged.scaled(strain, 0, 0), None);
        assert_eq!(judged.scaled(strain, 1, 2), map.displayed(strain, 1, 2));
        assert!(judged.scaled(strain, 2, 2).unwrap().0 < map.value(strain, 2, 2).unwrap());
        assert_eq!(judged.levels(strain), [0.2, 0.22, 0.5, 0.54]);
        assert_eq!(
            (judged.practice_at(120.0, 33.0), judged.practice_at(115.0, 33.0)),
            (Some(PLAN), None)
        );
        let between = judged.practice_at(125.0, 33.0).unwrap();
        assert!((between.more - 0.28).abs() < 1e-12, "{between:?}");
        // Another quantity is not compared with practice.
        let cover = Quantity::LeastCoverMm;
        assert_eq!(judged.scaled(cover, 0, 0), map.displayed(cover, 0, 0));
    }
}

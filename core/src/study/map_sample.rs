//! A map from some of its points: solved where the quantities bend, interpolated between.
//!
//! A lattice is solved first, every other point of it at the beginning, which give a first map with errors. A smooth function of each quantity goes through the solved points ([`Surface`]), and a less smooth one;
//! where both differ most, relative to the quantity's aim, further points are solved, round by round. Points at the border of no answer
//! are solved too, those farthest from solved ones first, which halves the way between a point with and one without an answer. A round
//! begins once all points of the one before are solved, so that the points do not depend on the number of threads.

use super::map_column::{Column, Nearest, Series, median};
use super::surface::{LESS_SMOOTH, SMOOTH, Surface};
use super::{Case, Map, Parameter, PointStatus, Quantity};
use crate::scene::Field;
use schemars::JsonSchema;
use serde::Serialize;

/// Greatest number of points of a map that is solved as a whole.
const ALL_SOLVED: usize = 70;
/// Greatest number of points to solve.
const MOST: usize = 70;
/// Numbers of values of the lattice along each of two axes, and along a single one.
const LATTICE: [usize; 2] = [5, 17];
/// Points of a round, and of these at the border of no answer.
const ROUND: usize = 6;
const ROUND_OF_BORDER: usize = 4;
/// Greatest number of points at the border of no answer.
const MOST_OF_BORDER: usize = 20;
/// Least distance between points of a round \[half the length of an axis\].
const APART: f64 = 0.26;
/// Distance from the solved points beyond which a point is solved although both functions agree: they may agree beside a bend.
const HOLE: f64 = 0.3;
/// Points to either side over which the difference of both functions counts \[of the points of an axis\].
const AROUND: f64 = 0.05;
/// Share of the aim below which no point is solved for a difference of both functions: the aim holds at every point.
const ENOUGH: f64 = 0.5;
/// The error of a value: so many times the difference of both functions, and these parts of what points left out are missed by (the median, and
/// the mean of those nearest).
const DIFFERENCES: f64 = 3.0;
const LEFT_OUT: [f64; 2] = [2.0, 0.5];
/// Error up to which a chart shows a value as known \[aim of the quantity\].
const KNOWN: f64 = 4.0;
/// The aim of quantities that choose no points: those of a few nodes, or of the geometry.
const OTHER_AIM: f64 = 0.02;

/// Where the values of a point come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// The point is solved.
    Solved,
    /// The values are those of the smooth function through solved points, the status is that of the nearest solved point.
    Interpolated,
}

impl Source {
    /// The source in words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Interpolated => "interpolated",
        }
    }
}

/// The error that the points are chosen for \[value\]; `None` of a quantity that chooses none.
fn aim(quantity: Quantity) -> Option<f64> {
    use Quantity::{
        ApexCoverMm, ForceN, GreatestPressureKpa, GreatestStrain, LeastCoverMm, MeanPressureKpa,
        SkinStressKpa,
    };
    match quantity {
        GreatestStrain | LeastCoverMm | ApexCoverMm | ForceN => Some(0.005),
        MeanPressureKpa | GreatestPressureKpa | SkinStressKpa => Some(0.02),
        _ => None,
    }
}

/// What is known between the solved points.
#[derive(Debug, Default)]
pub(super) struct Sample {
    is_wanted: bool,
    is_concluded: bool,
    /// The first points of the lattice, which give a first function of the whole map; empty once they did.
    first: Vec<usize>,
    is_lattice_solved: bool,
    /// Number of points solved at the border of no answer.
    of_border: usize,
    /// Values, errors and what these are relative to, by point and quantity; not a number where nothing is known, empty at first.
    values: Vec<f64>,
    errors: Vec<f64>,
    scales: Vec<f64>,
    /// The states of the points that are not solved, at the end.
    states: Vec<PointStatus>,
}

impl Sample {
    /// Are further points to be chosen?
    pub(super) fn is_open(&self) -> bool {
        self.is_wanted && !self.is_concluded
    }

    /// The state of a point that is not solved.
    pub(super) fn state(&self, item: usize) -> PointStatus {
        self.states.get(item).copied().unwrap_or(PointStatus::Waiting)
    }

    /// Value, error, and what the error is relative to, of a point that is not solved.
    pub(super) fn of(&self, quantity: Quantity, item: usize) -> Option<[f64; 3]> {
        let at = item * Quantity::COUNT + quantity as usize;
        let value = self.values.get(at).copied().filter(|value| !value.is_nan())?;
        Some([value, self.errors[at], self.scales[at]])
    }
}

/// A solved point near a point.
#[derive(Clone, Copy)]
struct Near {
    squared: usize,
    item: usize,
    has_answer: bool,
}

impl Map {
    /// The map from some of its points, the others interpolated; one of up to 70 points, or with fewer than 5 values of an axis, is
    /// solved as a whole.
    #[must_use]
    pub fn sampled(mut self) -> Self {
        let (columns, rows) = self.shape();
        let count = LATTICE[usize::from(self.axes().len() == 1)];
        if columns * rows <= ALL_SOLVED || self.axes().iter().any(|axis| axis.count < count) {
            return self;
        }
        // Between even steps and those of Chebyshev: extrapolation costs more than interpolation.
        let lattice = |along: Vec<f64>| -> Vec<Option<usize>> {
            let mut number = vec![(along.len() == 1).then_some(0); along.len()];
            for k in 0..count {
                let even = 2.0 * k as f64 / (count - 1) as f64 - 1.0;
                let at = 0.5 * even + 0.5 * (0.5 * std::f64::consts::PI * even).sin();
                let distance = |k: &usize| (along[*k] - at).abs();
                let nearest = (0..along.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
                nearest.into_iter().for_each(|nearest| number[nearest] = Some(k));
            }
            number
        };
        let [is, js] = [0, 1].map(|axis| lattice(self.along(axis)));
        let number = |item: &usize| Some(is[item % columns]? + js[item / columns]?);
        // Every other point first: they cover the whole map and determine the smooth function.
        let is_first = |item: &usize| number(item).is_some_and(|number| number.is_multiple_of(2));
        let mut order = self.order();
        order.retain(|item| number(item).is_some());
        order.sort_by_key(|item| !is_first(item));
        self.sample.first = order.iter().copied().filter(is_first).collect();
        self.queue = super::queue::Queue::new(order);
        self.sample.is_wanted = true;
        self
    }

    /// Are some points of the map interpolated?
    #[must_use]
    pub fn is_sampled(&self) -> bool {
        self.sample.is_wanted
    }

    /// Where the values of a point come from; `None` of a point about which nothing is known yet, and of one out of the limits.
    #[must_use]
    pub fn source(&self, i: usize, j: usize) -> Option<Source> {
        match self.case(i, j) {
            Some(case) => case.status.map(|_| Source::Solved),
            None if self.status(i, j) != PointStatus::Waiting => Some(Source::Interpolated),
            None => None,
        }
    }

    /// Is the interpolated value of a point known well enough for a chart?
    pub(super) fn is_known(&self, quantity: Quantity, i: usize, j: usize) -> bool {
        let found = self.sample.of(quantity, j * self.shape().0 + i);
        let most = KNOWN * aim(quantity).unwrap_or(OTHER_AIM);
        found.is_some_and(|[_, error, scale]| error <= most * scale)
    }

    /// Interpolates all quantities from the first points of the lattice, once all of them are solved: the whole map is known early, with
    /// errors. The points to solve do not depend on it.
    pub(super) fn preview(&mut self) {
        let is_solved = |item: &usize| self.queue.case(*item).is_some();
        if !self.sample.first.is_empty() && self.sample.first.iter().all(is_solved) {
            self.sample.first.clear();
            self.mark_invalid();
            let near = self.nearest();
            self.estimate(&near);
        }
    }

    /// Adds points to solve once all chosen ones are solved; returns whether there are any. The end: the states of the others.
    pub(super) fn refine(&mut self) -> bool {
        let (done, all) = self.queue.progress();
        if !self.sample.is_open() || done < all {
            return false;
        }
        if !self.sample.is_lattice_solved {
            self.mark_invalid();
        }
        (self.sample.is_lattice_solved, self.sample.first) = (true, Vec::new());
        let near = self.nearest();
        let Some(needs) = self.estimate(&near) else {
            // Too few answers for a function: all points are solved.
            self.sample = Sample { is_concluded: true, ..Sample::default() };
            let missing = (0..near.len()).filter(|item| self.queue.case(*item).is_none());
            let missing: Vec<usize> = missing.collect();
            self.queue.extend(missing.iter().copied());
            return !missing.is_empty();
        };
        let picks = self.picks(&near, needs, MOST.saturating_sub(all));
        self.queue.extend(picks.iter().copied());
        if picks.is_empty() {
            self.conclude_sample(&near);
        }
        !picks.is_empty()
    }

    /// Marks the points out of the limits of a scene, if a solved point of the lattice is one.
    fn mark_invalid(&mut self) {
        let columns = self.shape().0;
        let is_invalid = |case: &Case| case.status.is_none();
        if !self.queue.cases().iter().flatten().any(is_invalid) {
            return;
        }
        for item in 0..self.queue.cases().len() {
            if self.queue.case(item).is_none()
                && let Err(error) = self.scene(item % columns, item / columns)
            {
                self.queue.replace(item, Case::invalid(error));
            }
        }
    }

    /// The solved point nearest to each point; `None` for points out of the limits.
    fn nearest(&self) -> Vec<Option<Near>> {
        let columns = self.shape().0;
        let cases = self.queue.cases();
        // At rest are other quantities than beside it, and always an answer.
        let axes = self.axes().iter().enumerate();
        let mut of_insertion =
            axes.filter(|(_, axis)| axis.field == Parameter::of(Field::Insertion));
        let insertions = of_insertion.next().map(|(k, axis)| (k, axis.values()));
        let is_at_rest = |item: usize| match &insertions {
            Some((k, values)) => values[[item % columns, item / columns][*k]] == 0.0,
            None => false,
        };
        let solved: Vec<(usize, bool)> = cases
            .iter()
            .enumerate()
            .filter_map(|(item, case)| Some((item, case.as_ref()?)))
            .filter_map(|(item, case)| case.status.map(|_| (item, case.is_converged())))
            .collect();
        let of = |(own, case): (usize, &Option<Case>)| {
            if case.as_ref().is_some_and(|case| case.status.is_none()) {
                return None;
            }
            let squared = |item: usize| {
                let along = |a: usize, b: usize| a.abs_diff(b).pow(2);
                along(own % columns, item % columns) + along(own / columns, item / columns)
            };
            let alike = solved.iter().filter(|(item, _)| is_at_rest(*item) == is_at_rest(own));
            let near = alike.map(|&(item, has_answer)| {
                let squared = squared(item);
                Near { squared, item, has_answer }
            });
            near.min_by_key(|near| near.squared)
        };
        cases.iter().enumerate().map(of).collect()
    }

    /// Places of the values of an axis from −1 to 1, by the square root of a number that is not negative: forces and strains change
    /// faster where it is small.
    fn along(&self, axis: usize) -> Vec<f64> {
        let Some(axis) = self.axes().get(axis) else { return vec![0.0] };
        let is_root = axis.from >= 0.0 && axis.to >= 0.0;
        let of = |value: f64| if is_root { value.sqrt() } else { value };
        let (from, to) = (of(axis.from), of(axis.to));
        axis.values().into_iter().map(|v| 2.0 * (of(v) - from) / (to - from) - 1.0).collect()
    }

    /// Places of the points.
    fn places(&self) -> Vec<[f64; 2]> {
        let [x, y] = [0, 1].map(|axis| self.along(axis));
        y.iter().flat_map(|b| x.iter().map(move |a| [*a, *b])).collect()
    }

    /// Interpolates all quantities; returns how many times the differences of both functions are above the aims, by point. `None` if the
    /// points with an answer determine no function.
    fn estimate(&mut self, near: &[Option<Near>]) -> Option<Vec<f64>> {
        let places = self.places();
        let mut needs = vec![0.0_f64; places.len()];
        let [mut values, mut errors, mut scales] =
            [(); 3].map(|()| vec![f64::NAN; places.len() * Quantity::COUNT]);
        // Series with values at the same points share their functions.
        let mut groups: Vec<(Vec<usize>, Vec<Series>)> = Vec::new();
        for series in Series::all() {
            let items: Vec<usize> =
                (0..places.len()).filter(|k| self.solved_value(series, *k).is_some()).collect();
            match groups.iter_mut().find(|(known, _)| *known == items) {
                Some((_, together)) => together.push(series),
                None => groups.push((items, vec![series])),
            }
        }
        for (items, together) in groups {
            let own = |series: &Series| -> Vec<f64> {
                items.iter().filter_map(|item| self.solved_value(*series, *item)).collect()
            };
            let columns: Vec<Column> =
                together.iter().map(|series| Column::new(*series, own(series))).collect();
            let points: Vec<[f64; 2]> = items.iter().map(|item| places[*item]).collect();
            let known = (0..items.len()).flat_map(|k| columns.iter().map(move |of| of.fitted(k)));
            let known: Vec<f64> = known.collect();
            let is_plane = self.axes().len() > 1;
            let through = |how| Surface::through(points.clone(), &known, is_plane, how);
            let Some((smooth, other)) = through(SMOOTH).zip(through(LESS_SMOOTH)) else {
                if together.iter().any(|series| series.quantity == Quantity::GreatestStrain) {
                    return None;
                }
                continue;
            };
            let [found, compared] = [&smooth, &other].map(|of| of.at(places.iter().copied()));
            let nearest: Vec<Nearest> = places.iter().map(|at| Nearest::of(*at, &points)).collect();
            for (k, column) in columns.iter().enumerate() {
                let of = |all: &[f64]| -> Vec<f64> {
                    let of_column = all.iter().skip(k).step_by(columns.len());
                    of_column.map(|fitted| column.value(*fitted)).collect()
                };
                let (found, compared) = (of(&found), of(&compared));
                let differences = found.iter().zip(compared);
                let differences =
                    differences.map(|(a, b)| (a - b).abs() / column.scale(*a)).collect();
                let missed = column.left_out(smooth.left_out(k));
                let [of_median, of_nearest] = LEFT_OUT;
                let least = of_median * median(missed.clone());
                let beside = |item: usize| of_nearest * nearest[item].mean(&missed);
                for (item, difference) in self.spread(differences).into_iter().enumerate() {
                    // An answer is expected here, with this quantity.
                    let is_beside = near[item].is_some_and(|near| {
                        near.has_answer && self.solved_value(column.series, near.item).is_some()
                    });
                    if self.queue.case(item).is_some() || !is_beside {
                        continue;
                    }
                    let quantity = column.series.quantity;
                    let at = item * Quantity::COUNT + quantity as usize;
                    let part = DIFFERENCES * difference;
                    let (value, scale) = (found[item], column.scale(found[item]));
                    // Of two values the greater one; the other one may reach as far.
                    let (known, reach) = (values[at], values[at] + errors[at]);
                    let reach = reach.max(value + (part + least + beside(item)) * scale);
                    if known.is_nan() || known < value {
                        (values[at], scales[at]) = (value, scale);
                    }
                    errors[at] = reach - values[at];
                    if let Some(aim) = aim(quantity) {
                        needs[item] = needs[item].max(part / aim);
                    }
                }
            }
        }
        (self.sample.values, self.sample.errors, self.sample.scales) = (values, errors, scales);
        Some(needs)
    }

    /// The value of a series at a solved point with an answer.
    fn solved_value(&self, series: Series, item: usize) -> Option<f64> {
        series.value(self.queue.case(item).filter(|case| case.is_converged())?)
    }

    /// The greatest of the values around each point.
    fn spread(&self, values: Vec<f64>) -> Vec<f64> {
        let (columns, rows) = self.shape();
        let along = |values: Vec<f64>, count: usize, step: usize| -> Vec<f64> {
            let reach = (AROUND * count as f64).round() as usize;
            let greatest = |item: usize| {
                let k = item / step % count;
                let around = k.saturating_sub(reach)..(k + reach + 1).min(count);
                around.map(|other| values[item - k * step + other * step]).fold(0.0, f64::max)
            };
            (0..values.len()).map(greatest).collect()
        };
        along(along(values, columns, 1), rows, columns)
    }

    /// The points to solve next, up to a number.
    fn picks(&mut self, near: &[Option<Near>], mut needs: Vec<f64>, most: usize) -> Vec<usize> {
        let (columns, rows) = self.shape();
        let has_answer = |item: usize| near[item].map(|near| near.has_answer);
        let is_border = |item: usize| {
            let (i, j) = (item % columns, item / columns);
            let beside = [
                (i > 0).then(|| item - 1),
                (i + 1 < columns).then(|| item + 1),
                (j > 0).then(|| item - columns),
                (j + 1 < rows).then(|| item + columns),
            ];
            let mut beside = beside.into_iter().flatten().filter_map(has_answer);
            has_answer(item).is_some_and(|own| beside.any(|other| other != own))
        };
        let mut picks = Vec::new();
        let mut distances: Vec<usize> = (0..near.len())
            .map(|item| near[item].filter(|_| is_border(item)).map_or(0, |near| near.squared))
            .collect();
        let of_border = ROUND_OF_BORDER.min(MOST_OF_BORDER - self.sample.of_border).min(most);
        while picks.len() < of_border
            && let Some(item) = greatest(&distances, |distance| *distance > 0)
        {
            picks.push(item);
            for (other, distance) in distances.iter_mut().enumerate() {
                let along = |a: usize, b: usize| a.abs_diff(b).pow(2);
                let squared =
                    along(item % columns, other % columns) + along(item / columns, other / columns);
                *distance = squared.min(*distance);
            }
        }
        self.sample.of_border += picks.len();
        picks.iter().for_each(|item| needs[*item] = 0.0);
        let places = self.places();
        let distance = |a: usize, b: usize| {
            let ([ax, ay], [bx, by]) = (places[a], places[b]);
            (ax - bx).hypot(ay - by)
        };
        while picks.len() < ROUND.min(most)
            && let Some(item) = greatest(&needs, |need| *need > ENOUGH)
        {
            picks.push(item);
            for (other, need) in needs.iter_mut().enumerate() {
                *need = if distance(item, other) < APART { 0.0 } else { *need };
            }
        }
        let expects_answer = |item: &usize| has_answer(*item) == Some(true);
        let mut holes: Vec<f64> = vec![0.0; near.len()];
        for item in (0..near.len()).filter(expects_answer) {
            let solved = (0..near.len()).filter(|k| self.queue.case(*k).is_some());
            let known = solved.chain(picks.iter().copied());
            holes[item] = known.map(|other| distance(item, other)).fold(f64::MAX, f64::min);
        }
        while picks.len() < ROUND.min(most)
            && let Some(item) = greatest(&holes, |distance| *distance > HOLE)
        {
            picks.push(item);
            for (other, hole) in holes.iter_mut().enumerate() {
                *hole = hole.min(distance(item, other));
            }
        }
        picks
    }

    /// The end: points that are not solved have the state of the nearest solved one.
    fn conclude_sample(&mut self, near: &[Option<Near>]) {
        let case = |near: &Near| PointStatus::of(self.queue.case(near.item));
        let state = |near: &Option<Near>| near.as_ref().map_or(PointStatus::Invalid, case);
        self.sample.states = near.iter().map(state).collect();
        self.sample.is_concluded = true;
    }
}

/// The first of the greatest values that are accepted.
fn greatest<T: PartialOrd>(values: &[T], is_accepted: impl Fn(&T) -> bool) -> Option<usize> {
    let accepted = values.iter().enumerate().filter(|(_, value)| is_accepted(value));
    accepted.reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|(item, _)| item)
}

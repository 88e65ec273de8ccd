//! Where the words of the cards change along the slider of the volume, where the model has no answer, and the largest volume
//! that stays usual: the implant's volumes at its width, each one solved scene on a coarse grid. Computed once a pointer
//! rests over the first plan, the slider is used or the plan is edited.

use super::studies::{Driver, Studies};
use super::texts::{tr, word_of};
use super::volume_band::VolumeBand;
use super::volumes::{COUNT, volumes};
use crate::clinical::{Shelf, ShelfSize};
use crate::measure::bands::{self, Limits};
use crate::scene::Scene;
use crate::study::{
    Axis, BandsSettings, Map, MapSettings, Parameter, Quantity, volume_and_width, with_values,
};
use eframe::egui;
use web_time::{Duration, Instant};

/// Grid and tolerance of the volumes.
const SETTINGS: MapSettings = MapSettings { nodes_per_side: 33, tolerance: 1e-3 };
/// Projection / half base width of the greatest volume \[-\]: from 1.36 on a scene may have no answer.
const MOST_RATIO: f64 = 1.3;
/// Share of the greatest volume with an answer from which a plan is near the model's limit \[-\].
const NEAR_END: f64 = 0.9;
/// Greatest step to the next width of the shelf \[mm\].
const MOST_STEP_MM: f64 = 20.0;
/// Rest of the first plan before its marks are computed.
const REST: Duration = Duration::from_millis(300);
/// The quantities of the cards with limits.
const QUANTITIES: [Quantity; 2] = [Quantity::GreatestStrain, Quantity::GreatestPressureMmhg];

/// The study behind the marks.
#[derive(Default)]
pub(super) struct VolumeMarks {
    curve: Driver<Map>,
    /// The scene of the present curve.
    started: Option<Scene>,
    is_wanted: bool,
    /// Start of the rest of the first plan under a pointer.
    rests_since: Option<Instant>,
    /// The marks of a curve that is solved.
    marks: Option<Vec<Mark>>,
    /// The curve of the next width, and its marks.
    beside: Driver<Map>,
    beside_marks: Option<Vec<Mark>>,
    /// The largest usual volume over sampled patients.
    band: VolumeBand,
}

/// A volume \[ml\] above which the word of a quantity changes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mark {
    volume_ml: f64,
    /// Index of the band above the volume, 1 or more; `None`: no answer.
    band: Option<usize>,
    /// The quantity of the card; `None`: no answer.
    quantity: Option<Quantity>,
    /// The word of the band.
    word: &'static str,
}

impl VolumeMarks {
    /// The slider or the plan is in use: the marks are computed from now on.
    pub(super) fn want(&mut self) {
        self.is_wanted = true;
    }

    /// The marks are computed from a rest of the first plan on, once a pointer or a finger was on it: a page that opens has its picture
    /// first, and a page in the background computes nothing. `is_busy`: the plan is being solved or edited.
    pub(super) fn want_after_rest(&mut self, ctx: &egui::Context, is_busy: bool) {
        if self.is_wanted {
            return;
        }
        let is_used = ctx.input(|input| input.pointer.latest_pos().is_some());
        let is_at_rest = !is_busy && (is_used || self.rests_since.is_some());
        let since = is_at_rest.then(|| self.rests_since.unwrap_or_else(Instant::now));
        self.rests_since = since;
        match since.map(|since| since.elapsed()) {
            Some(rest) if rest >= REST => self.is_wanted = true,
            Some(rest) => ctx.request_repaint_after(REST - rest),
            None => {}
        }
    }

    /// Starts and continues the studies, once a frame. `bands`: the choices of the bands while they are on, and whether the bands
    /// are complete; `is_busy`: the plan is being solved or edited.
    pub(super) fn advance(
        &mut self,
        (scene, shelf): (&Scene, &Shelf),
        bands: Option<(BandsSettings, bool)>,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        if self.is_wanted && !is_busy && self.started.as_ref() != Some(scene) {
            self.restart(scene, studies);
        }
        self.curve.advance(studies);
        if !self.is_of(scene) {
            // The marks of another patient, pocket or width say nothing about this one.
            (self.marks, self.beside_marks) = (None, None);
        } else if self.marks.is_none()
            && let Some(curve) = self.curve.finished()
        {
            self.marks = Some(marks_of(curve));
        }
        self.advance_beside(shelf, studies, is_busy);
        let curve = self.curve.study().filter(|_| self.marks.is_some());
        let curve = curve.map(|curve| (curve.base(), curve.axes()[0]));
        self.band.advance(curve, bands, studies, is_busy);
    }

    /// The curve of the next width, after that of the plan's own.
    fn advance_beside(&mut self, shelf: &Shelf, studies: &mut Studies, is_busy: bool) {
        if self.marks.is_some()
            && !is_busy
            && let Some(curve) = self.curve.study()
        {
            let next = next_width(2.0 * curve.base().implant.base_radius_mm, shelf);
            let has_width =
                |beside: &Map| (2.0 * beside.base().implant.base_radius_mm - next).abs() < 1e-6;
            if !self.beside.study().is_some_and(has_width) {
                self.beside_marks = None;
                let axis = volumes(next, MOST_RATIO);
                let wider = with_values(curve.base(), &[(Parameter::BaseWidth, next)]).ok();
                match wider.and_then(|wider| Map::new(&wider, &[axis], SETTINGS).ok()) {
                    Some(beside) => self.beside.start(beside.with_full_border(), studies),
                    None => self.beside.cancel(studies),
                }
            }
        }
        self.beside.advance(studies);
        if self.marks.is_some()
            && self.beside_marks.is_none()
            && let Some(beside) = self.beside.finished()
        {
            self.beside_marks = Some(marks_of(beside));
        }
    }

    /// Is the curve that of a plan, or of the plan with another volume or less of it in place?
    fn is_of(&self, plan: &Scene) -> bool {
        let is_other_volume = |started: &Scene| {
            let mut other = full(plan);
            other.implant.projection_mm = started.implant.projection_mm;
            other.is_same_plan(&full(started))
        };
        // At rest no scene is built.
        let started = self.started.as_ref();
        started.is_some_and(|started| started == plan || is_other_volume(started))
    }

    /// Starts the curve of a scene. Another volume leaves the curve as it is.
    fn restart(&mut self, scene: &Scene, studies: &mut Studies) {
        self.started = Some(scene.clone());
        let base = full(scene);
        let axis = volumes(2.0 * scene.implant.base_radius_mm, MOST_RATIO);
        let is_equal = |curve: &mut Map| curve.axes() == [axis] && curve.move_to(&base);
        if self.curve.study_mut().is_some_and(is_equal) {
            return;
        }
        (self.marks, self.beside_marks) = (None, None);
        self.curve.cancel(studies);
        self.beside.cancel(studies);
        self.band.cancel(studies);
        if let Ok(curve) = Map::new(&base, &[axis], SETTINGS) {
            self.curve.start(curve.with_full_border(), studies);
        }
    }

    /// The volumes \[ml\] above which the worst card is high, is more than high, and above which no scene has an answer.
    pub(super) fn ends(&self) -> [Option<f64>; 3] {
        let first = |is_meant: &dyn Fn(Option<usize>) -> bool| {
            // The marks are in the order of their volumes.
            let found = self.marks.iter().flatten().find(|mark| is_meant(mark.band));
            found.map(|mark| mark.volume_ml)
        };
        [
            first(&|band| band >= Some(1)),
            first(&|band| band >= Some(2)),
            first(&|band| band.is_none()),
        ]
    }

    /// The largest volume that stays usual at the width of the plan and at the next one, in words; empty while the first is not
    /// known.
    pub(super) fn largest_usual(&self) -> String {
        let (Some(marks), Some(curve)) = (&self.marks, self.curve.study()) else {
            return String::new();
        };
        let [_, width] = volume_and_width(curve.base());
        let words = match largest(&curve.axes()[0], marks) {
            None => tr!("No volume on {width} cm stays usual", width),
            Some(volume) => tr!("Up to {volume} stays usual on {width} cm", volume, width),
        } + &self.band.words();
        let beside = self.beside_marks.as_ref().zip(self.beside.study()).map(|(marks, beside)| {
            let [_, width] = volume_and_width(beside.base());
            let volume = largest(&beside.axes()[0], marks).unwrap_or_else(|| tr("none").to_owned());
            tr!("; {volume} on {width} cm", volume, width)
        });
        format!("{words}{}.", beside.unwrap_or_default())
    }

    /// The largest volume of a plan that stays usual \[ml\]; `None` while that is not known, or without one.
    pub(super) fn largest_ml(&self, plan: &Scene) -> Option<f64> {
        let (marks, curve) = self.marks.as_ref().zip(self.curve.study())?;
        let is_of_plan = self.started.as_ref() == Some(plan);
        largest_ml(&curve.axes()[0], marks).filter(|_| is_of_plan)
    }

    /// [`Self::largest_ml`] as a plan and in words.
    pub(super) fn largest_plan(&self, plan: &Scene) -> Option<(Scene, String)> {
        let volume = self.largest_ml(plan)?;
        let base = self.curve.study()?.base();
        let scene = with_values(base, &[(Parameter::Volume, volume)]).ok()?;
        Some((scene, tr!("{volume:.0} ml, the largest that stays usual", volume)))
    }

    /// What [`Self::largest_usual`] is.
    pub(super) fn about_largest_usual(&self) -> String {
        let words = tr(
            "No word of the cards is above usual up to this volume, for this patient and this pocket. Solved on a coarse grid, \
             between two volumes on a line; in steps of 5 ml, rounded down.",
        );
        words.to_owned() + &self.band.about()
    }

    /// That the volume of a plan is above or within a tenth of the greatest one with an answer, in words; empty while that is not
    /// known.
    pub(super) fn near_end(&self, plan: &Scene) -> String {
        let words = Parameter::Volume.value(plan).map_or_else(String::new, |v| self.near_end_of(v));
        // Also during the solve of another volume. The comparison builds scenes: a volume far below the limit needs none.
        let is_of_plan =
            || self.curve.study().is_some_and(|curve| curve.has_points_of(&full(plan)));
        if words.is_empty() || is_of_plan() { words } else { String::new() }
    }

    fn near_end_of(&self, volume_ml: f64) -> String {
        match self.ends()[2] {
            Some(end) if volume_ml > end => {
                tr!(
                    "Probably no answer: the model has none above about {end:.0} ml at this width.",
                    end
                )
            }
            Some(end) if volume_ml >= NEAR_END * end => {
                tr!("Near the model's limit: no answer above about {end:.0} ml at this width.", end)
            }
            _ => String::new(),
        }
    }

    /// The marks in words; empty without any.
    pub(super) fn words(&self) -> String {
        let word = |mark: &Mark| format!("\n{:.0} ml: {}", mark.volume_ml, words_of(mark));
        let words: String = self.marks.iter().flatten().map(word).collect();
        if words.is_empty() { words } else { tr!("\nAt this width, from about{words}", words) }
    }
}

/// The words of a mark.
fn words_of(mark: &Mark) -> String {
    let name = match mark.quantity {
        Some(Quantity::GreatestPressureMmhg) => "pressure",
        Some(Quantity::LeastCoverMm) => "cover",
        Some(_) => "skin stretch",
        None => "the model has",
    };
    let limits = mark.quantity.and_then(|quantity| quantity.limits(None));
    let word = limits.map_or(tr(mark.word), |(limits, _)| word_of(limits, mark.word));
    format!("{} {word}", tr(name))
}

/// The next width \[mm\]: the next one of the shelf within [`MOST_STEP_MM`], else the next whole centimetre at least half a
/// centimetre wider.
fn next_width(width_mm: f64, shelf: &Shelf) -> f64 {
    let widths = shelf.sizes().iter().map(ShelfSize::width_mm);
    let wider = widths.filter(|other| *other > width_mm + 0.5 && *other <= width_mm + MOST_STEP_MM);
    let next = wider.fold(f64::INFINITY, f64::min);
    if next.is_finite() { next } else { 10.0 * ((width_mm + 5.0) / 10.0).ceil() }
}

/// A plan with the whole implant in place.
fn full(plan: &Scene) -> Scene {
    Scene { insertion: 1.0, ..plan.clone() }
}

/// The largest volume of an axis that stays usual \[ml\], in whole 5 ml, downwards; `None` if none does.
fn largest_ml(axis: &Axis, marks: &[Mark]) -> Option<f64> {
    let end = marks.first().map_or(axis.to, |mark| mark.volume_ml.min(axis.to));
    (end > axis.from).then_some(5.0 * (end / 5.0).floor())
}

/// The largest volume of an axis that stays usual, as "360 ml"; `None` if none does.
fn largest(axis: &Axis, marks: &[Mark]) -> Option<String> {
    let volume = largest_ml(axis, marks)?;
    let is_open = marks.first().is_none_or(|mark| mark.volume_ml >= axis.to);
    let more = if is_open { tr(" and more") } else { "" };
    Some(format!("{volume:.0} ml{more}"))
}

/// The marks of a solved curve.
fn marks_of(curve: &Map) -> Vec<Mark> {
    let value = |quantity, i| curve.value(quantity, i, 0);
    marks(&curve.axes()[0], |quantity| curve.limits(quantity), value)
}

/// The volumes at which the quantities exceed their limits and the answers end, in their order. `limits`: those of a quantity,
/// and the factor from a value to their unit; `value`: a quantity at a volume of the axis; `None` without an answer.
fn marks(
    axis: &Axis,
    limits: impl Fn(Quantity) -> Option<(&'static Limits, f64)>,
    value: impl Fn(Quantity, usize) -> Option<f64>,
) -> Vec<Mark> {
    let point = |quantity: Quantity, i: usize| Some([axis.value(i), value(quantity, i)?]);
    let mut marks = Vec::new();
    for quantity in QUANTITIES {
        let Some((limits, factor)) = limits(quantity) else { continue };
        let line: Vec<[f64; 2]> = (0..COUNT).filter_map(|i| point(quantity, i)).collect();
        for (k, limit) in limits.bands.iter().filter_map(|band| band.limit).enumerate() {
            if let Some(volume_ml) = crossing(&line, limit / factor) {
                let word = limits.bands[k + 1].word;
                marks.push(Mark { volume_ml, band: Some(k + 1), quantity: Some(quantity), word });
            }
        }
    }
    // A cover that gets thin.
    let line: Vec<[f64; 2]> = (0..COUNT)
        .filter_map(|i| point(Quantity::LeastCoverMm, i).map(|[volume, cover]| [volume, -cover]))
        .collect();
    if let Some(volume_ml) = crossing(&line, -bands::THIN_COVER_MM) {
        let quantity = Some(Quantity::LeastCoverMm);
        marks.push(Mark { volume_ml, band: Some(1), quantity, word: "thin" });
    }
    // Between the last volume with an answer and the next one.
    let last = (0..COUNT).rev().find_map(|i| Some((i, point(Quantity::GreatestStrain, i)?[0])));
    if let Some((_, volume)) = last.filter(|(i, _)| i + 1 < COUNT) {
        let volume_ml = volume + 0.5 * (axis.value(1) - axis.value(0));
        marks.push(Mark { volume_ml, band: None, quantity: None, word: "no answer" });
    }
    marks.sort_by(|a, b| a.volume_ml.total_cmp(&b.volume_ml));
    marks
}

/// The first place where a polyline exceeds a limit; its start if it begins above.
fn crossing(line: &[[f64; 2]], limit: f64) -> Option<f64> {
    let first = line.iter().position(|point| point[1] > limit)?;
    let [x, y] = line[first];
    let Some(&[before, value]) = first.checked_sub(1).map(|k| &line[k]) else { return Some(x) };
    Some(before + (x - before) * (limit - value) / (y - value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::Size;
    use crate::measure::Outcome;
    use crate::scene::TissueModel;
    use crate::simulate::simulate;

    #[test]
    fn a_line_exceeds_a_limit_between_its_points() {
        let line = [[100.0, 0.1], [200.0, 0.2], [300.0, 0.4]];
        assert_eq!(crossing(&line, 0.05), Some(100.0));
        assert!((crossing(&line, 0.25).unwrap() - 225.0).abs() < 1e-9);
        assert_eq!(crossing(&line, 0.4), None);
        assert_eq!(crossing(&[], 0.4), None);
    }

    #[test]
    fn the_marks_separate_the_words_of_single_solves() {
        let mut scene = Scene::opening();
        scene.set_tissue_model(TissueModel::Sheet);
        let width = 2.0 * scene.implant.base_radius_mm;
        let axis = volumes(width, MOST_RATIO);
        let solved = |volume: f64, nodes: usize| {
            let mut scene = scene.clone();
            scene.solver.nodes_per_side = nodes;
            let size = Size::of_width_and_volume(width, volume).unwrap();
            scene.implant.projection_mm = size.projection_mm();
            simulate(&scene).unwrap()
        };
        let curve: Vec<Outcome> =
            axis.values().iter().map(|v| solved(*v, SETTINGS.nodes_per_side)).collect();
        let limits = |quantity: Quantity| quantity.limits(scene.skin_knee());
        let marks = marks(&axis, limits, |quantity, i| quantity.of(&curve[i]));
        let of_stretch = |mark: &&Mark| mark.quantity == Some(Quantity::GreatestStrain);
        assert!(marks.iter().filter(of_stretch).count() >= 2, "{marks:?}");
        for mark in &marks {
            let Some((band, quantity)) = mark.band.zip(mark.quantity) else { continue };
            let (limits, factor) = limits(quantity).unwrap();
            for (share, expected) in [(0.97, band - 1), (1.03, band)] {
                let value = quantity.of(&solved(share * mark.volume_ml, 129)).unwrap();
                assert_eq!(limits.band(factor * value), expected, "{mark:?}: {value}");
            }
        }
    }

    #[test]
    fn the_next_width_is_that_of_the_shelf_or_a_whole_centimetre() {
        let none = Shelf::default();
        for (width, next) in [(120.0, 130.0), (121.0, 130.0), (127.0, 140.0), (125.0, 130.0)] {
            assert!((next_width(width, &none) - next).abs() < 1e-9, "{width}");
        }
        let shelf = "name;width_mm;volume_ml\na;115;200\nb;124;300\nc;150;500";
        let shelf = Shelf::from_csv(shelf).unwrap();
        for (width, next) in [(120.0, 124.0), (124.0, 130.0), (131.0, 150.0)] {
            assert!((next_width(width, &shelf) - next).abs() < 1e-9, "{width}");
        }
    }

    #[test]
    fn the_largest_volume_is_rounded_down_and_stands_beside_that_of_the_next_width() {
        let quantity = Some(Quantity::GreatestStrain);
        let mark = |volume_ml| Mark { volume_ml, band: Some(1), quantity, word: "high" };
        let axis = volumes(120.0, MOST_RATIO);
        assert_eq!(largest(&axis, &[mark(364.0)]).as_deref(), Some("360 ml"));
        assert_eq!(largest(&axis, &[mark(axis.from)]), None);
        assert!(largest(&axis, &[]).unwrap().ends_with(" ml and more"));
        let driver = |width: f64| {
            let scene = with_values(&Scene::opening(), &[(Parameter::BaseWidth, width)]).unwrap();
            let mut driver = Driver::default();
            let axis = volumes(width, MOST_RATIO);
            driver.set(Map::new(&scene, &[axis], SETTINGS).unwrap());
            driver
        };
        let mut found = VolumeMarks {
            curve: driver(120.0),
            marks: Some(vec![mark(364.0)]),
            ..VolumeMarks::default()
        };
        assert_eq!(found.largest_usual(), "Up to 360 ml stays usual on 12 cm.");
        (found.beside, found.beside_marks) = (driver(130.0), Some(vec![mark(411.0)]));
        assert_eq!(found.largest_usual(), "Up to 360 ml stays usual on 12 cm; 410 ml on 13 cm.");
    }

    #[test]
    fn the_marks_are_those_of_the_patient_with_any_volume() {
        let scene = Scene::opening();
        let marks = VolumeMarks { started: Some(scene.clone()), ..VolumeMarks::default() };
        let is_of = |edit: &dyn Fn(&mut Scene)| {
            let mut scene = scene.clone();
            edit(&mut scene);
            marks.is_of(&scene)
        };
        assert!(is_of(&|_| {}) && is_of(&|scene| scene.insertion = 0.5));
        assert!(is_of(&|scene| scene.implant.projection_mm += 4.0));
        assert!(!is_of(&|scene| scene.layers[0].curve.strain_scale *= 0.6));
        assert!(!is_of(&|scene| scene.layers[1].thickness_mm += 2.0));
        assert!(!is_of(&|scene| scene.pocket_radius_mm += 2.0));
        assert!(!VolumeMarks::default().is_of(&scene));
    }

    #[test]
    fn a_volume_within_a_tenth_of_the_last_answer_is_near_the_limit() {
        let end = Mark { volume_ml: 400.0, band: None, quantity: None, word: "no answer" };
        let marks = VolumeMarks { marks: Some(vec![end]), ..VolumeMarks::default() };
        assert_eq!(marks.near_end_of(359.0), "");
        assert!(
            marks
                .near_end_of(361.0)
                .starts_with("Near the model's limit: no answer above about 400 ml")
        );
        assert!(
            marks
                .near_end_of(401.0)
                .starts_with("Probably no answer: the model has none above about 400 ml")
        );
        assert_eq!(VolumeMarks::default().near_end_of(361.0), "");
        assert_eq!(marks.near_end(&Scene::opening()), "");
    }

    #[test]
    fn the_answers_end_between_the_last_volume_with_one_and_the_next() {
        let axis = volumes(120.0, 1.0);
        let end = |count: usize| {
            let value = |quantity| if quantity == Quantity::LeastCoverMm { 10.0 } else { 0.1 };
            marks(
                &axis,
                |quantity| quantity.limits(None),
                |quantity, i| (i < count).then_some(value(quantity)),
            )
        };
        assert_eq!(end(COUNT), []);
        let found = end(10);
        assert!(found.len() == 1 && found[0].band.is_none(), "{found:?}");
        assert!(axis.value(9) < found[0].volume_ml && found[0].volume_ml < axis.value(10));
    }
}

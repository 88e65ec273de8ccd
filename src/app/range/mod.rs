//! The range of implants at a glance: a chart over one or two numbers of the plan, each point one solved scene.
//!
//! `axes` (the numbers on offer, their words and units) | `plane` (values to points of the screen) | `colours` (scale and
//! picture) | `readout` (values of a point in words) | `areas` (their words) | `practice` (what the stretches of the points are compared with) | `pins` (the pins on the chart) | `shelf` (sizes of the clinic), `shelf_preview` (their table before it is taken), `shelf_verdicts` (what the cards would say of each) | `paint` (drawing) | `chart` (pointer
//! and keys) | `controls` | `page` (chart, captions, files) | `figure` (the chart of the report). This file contains the choices and the studies behind the chart.

mod areas;
mod axes;
mod chart;
mod colours;
mod controls;
mod figure;
mod page;
mod paint;
mod pins;
mod plane;
mod practice;
mod readout;
mod shelf;
pub(crate) mod shelf_largest;
mod shelf_preview;
mod shelf_verdicts;

pub(super) use page::within_text;
pub(super) use plane::marks;
pub(super) use shelf::{Sizes, take_size, width_in_words, with_size};

use crate::app::answer::practice::Practices;
use crate::app::frame::studies::{Driver, Studies};
use crate::app::texts::tr;
use crate::scene::{Field, Implant, Scene};
use crate::study::{Axis, JudgedMap, Map, MapCheck, MapSettings, Parameter, Quantity};
use axes::Words;
use chart::Chart;
use eframe::egui;
use pins::Pins;
use practice::ChartPractice;
use shelf_verdicts::ShelfVerdicts;
use web_time::{Duration, Instant};

/// Numbers of values of an axis: coarse, medium, fine; and of a curve.
const FINENESS: [(&str, usize); 3] = [("Coarse grid", 20), ("Medium grid", 40), ("Fine grid", 60)];
const CURVE_POINTS: usize = 41;
/// Rest after which a complete map is compared with a finer grid: an edit would wait for a fine scene that runs.
const REST: Duration = Duration::from_secs(1);

/// An axis as chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisChoice {
    field: Parameter,
    /// Typed ends; `None`: the usual ones.
    ends: Option<(f64, f64)>,
}

impl AxisChoice {
    fn of(field: Parameter) -> Self {
        Self { field, ends: None }
    }

    fn ends(&self, scene: &Scene, middle: Implant) -> (f64, f64) {
        self.ends.unwrap_or_else(|| axes::usual(self.field, scene, middle))
    }
}

/// The range of implants.
pub(super) struct Range {
    /// Does the chart take the place of the picture?
    pub(super) is_open: bool,
    across: AxisChoice,
    up: Option<AxisChoice>,
    /// The implant around which the sizes lie; `None` before the chart is opened.
    middle: Option<Implant>,
    /// Was the chart closed in the frame before?
    is_fresh: bool,
    quantity: Quantity,
    fineness: usize,
    /// On a narrow screen: are the axes shown?
    shows_more: bool,
    map: Driver<Map>,
    check: Driver<MapCheck>,
    /// Scene and axes of the present map.
    started: Option<(Scene, Vec<Axis>)>,
    /// Why the axes give no map.
    error: Option<String>,
    /// Time of the last value of a complete map.
    done: Option<Instant>,
    /// Number of changes of the map's values.
    revision: u64,
    /// Number of starts and moves of maps.
    starts: u64,
    practice: ChartPractice,
    pins: Pins,
    pub(super) sizes: Sizes,
    verdicts: ShelfVerdicts,
    chart: Chart,
}

impl Default for Range {
    fn default() -> Self {
        Self {
            is_open: false,
            across: AxisChoice::of(Parameter::BaseWidth),
            up: Some(AxisChoice::of(Parameter::of(Field::Projection))),
            middle: None,
            is_fresh: true,
            quantity: Quantity::GreatestStrain,
            fineness: FINENESS[0].1,
            shows_more: false,
            map: Driver::default(),
            check: Driver::default(),
            started: None,
            error: None,
            done: None,
            revision: 0,
            starts: 0,
            practice: ChartPractice::default(),
            pins: Pins::default(),
            sizes: Sizes::default(),
            verdicts: ShelfVerdicts::default(),
            chart: Chart::default(),
        }
    }
}

impl Range {
    /// Follows the scene and the choices, once a frame: starts a map for another scene, passes on finished jobs, compares a
    /// complete map with a finer grid.
    pub(super) fn advance(
        &mut self,
        ctx: &egui::Context,
        scene: &Scene,
        practices: &Practices,
        studies: &mut Studies,
    ) {
        if !self.is_open {
            self.is_fresh = true;
            // A closed chart costs nothing; solved cases stay stored, a complete map stays for the report.
            if self.map.is_running() {
                self.map.cancel(studies);
                self.started = None;
            }
            if self.check.is_running() {
                self.check.cancel(studies);
            }
            return;
        }
        self.follow(scene);
        let axes = self.axes(scene);
        if self.started.as_ref().is_none_or(|(s, a)| s != scene || *a != axes) {
            self.restart(scene, axes, studies);
        }
        if self.practice.follow(self.map.study(), self.starts, practices) {
            self.revision += 1;
        }
        // The words of the chart are those of practice from the first value on.
        if self.practice.is_pending() {
            return;
        }
        if self.map.advance(studies) {
            self.revision += 1;
            self.done = None;
        }
        self.check.advance(studies);
        let Some(map) = self.map.finished() else { return };
        if self.check.study().is_some() {
            return;
        }
        let rest = self.done.get_or_insert_with(Instant::now).elapsed();
        if rest < REST {
            ctx.request_repaint_after(REST - rest);
        } else if let Some(check) = map.check() {
            self.check.start(check, studies);
            self.check.advance(studies);
        }
    }

    /// Judges the sizes in stock while their list is in sight, once a frame. `is_busy`: the plan is being solved or edited.
    pub(super) fn judge_sizes(
        &mut self,
        scene: &Scene,
        practices: &Practices,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        self.verdicts.advance(scene, &self.sizes, practices, studies, is_busy);
    }

    /// Keeps the plan on the chart: sizes lie around the plan at the opening, and around another plan once that leaves the chart.
    fn follow(&mut self, scene: &Scene) {
        let present = scene.implant;
        let room = if self.is_fresh { 0.5 } else { 1.0 } * axes::AROUND_MM;
        let is_near = |middle: Implant| {
            2.0 * (middle.base_radius_mm - present.base_radius_mm).abs() <= room
                && (middle.projection_mm - present.projection_mm).abs() <= room
        };
        if !self.middle.is_some_and(is_near) {
            self.middle = Some(axes::middle(present));
        }
        self.is_fresh = false;
    }

    /// The ends of an axis.
    fn ends_of(&self, axis: &AxisChoice, scene: &Scene) -> (f64, f64) {
        axis.ends(scene, self.middle.unwrap_or(scene.implant))
    }

    /// Are the axes those around the present plan?
    fn is_around(&self, scene: &Scene) -> bool {
        let is_own = |axis: &AxisChoice| axis.ends.is_some();
        let is_middle = self.middle == Some(axes::middle(scene.implant));
        is_middle && ![Some(self.across), self.up].iter().flatten().any(is_own)
    }

    /// Are the axes those of the start: width and projection, with usual ends?
    fn has_usual_axes(&self) -> bool {
        let usual = Self::default();
        (self.across, self.up) == (usual.across, usual.up)
    }

    /// Gives up typed ends; sizes lie around the present plan.
    fn go_around(&mut self, scene: &Scene) {
        self.middle = Some(axes::middle(scene.implant));
        self.across.ends = None;
        self.up = self.up.map(|up| AxisChoice::of(up.field));
    }

    /// Moves the present map to the scene if its points stay the same, or starts a map.
    fn restart(&mut self, scene: &Scene, axes: Vec<Axis>, studies: &mut Studies) {
        let has_axes = self.started.as_ref().is_some_and(|(_, started)| *started == axes);
        let is_moved = has_axes && self.map.study_mut().is_some_and(|map| map.move_to(scene));
        self.started = Some((scene.clone(), axes.clone()));
        self.revision += 1;
        self.starts += 1;
        if is_moved {
            return;
        }
        if !has_axes {
            self.chart.forget_cursor();
        }
        self.check.cancel(studies);
        self.done = None;
        self.error = empty_axis(&axes);
        if self.error.is_none() {
            match Map::new(scene, &axes, MapSettings::default()) {
                Ok(map) => {
                    return self.map.start(map.sampled().with_full_border(), studies);
                }
                Err(error) => self.error = Some(error.to_string()),
            }
        }
        self.map.cancel(studies);
    }

    fn axes(&self, scene: &Scene) -> Vec<Axis> {
        let target = if self.up.is_some() { self.fineness } else { CURVE_POINTS };
        let axis =
            |choice: &AxisChoice| axes::axis(choice.field, self.ends_of(choice, scene), target);
        [Some(self.across), self.up].iter().flatten().map(axis).collect()
    }

    /// Chooses the number of an axis. The other axis changes if both set the same field.
    fn set_field(&mut self, is_across: bool, field: Option<Parameter>, scene: &Scene) {
        let before = self.across;
        match (is_across, field) {
            (true, Some(field)) => {
                self.across = AxisChoice::of(field);
                if self.up.is_some_and(|up| up.field.excludes(field, scene)) {
                    // The axes change places, or the first number that goes with this one stands up.
                    let free = |other: &Parameter| !other.excludes(field, scene);
                    let first = [before.field].into_iter().chain(axes::FIELDS).find(free);
                    self.up = first.map(AxisChoice::of);
                }
            }
            (_, field) => self.up = field.map(AxisChoice::of),
        }
    }

    /// The present map with what its strains are compared with.
    fn judged(&self) -> Option<JudgedMap<'_>> {
        self.map.study().map(|map| JudgedMap { map, practice: self.practice.found() })
    }

    /// The plans of the open chart and of the list of sizes whose practice is wanted.
    pub(super) fn wanted(&self) -> impl Iterator<Item = &Scene> {
        let of_chart = self.practice.wanted().iter().filter(|_| self.is_open);
        of_chart.chain(self.verdicts.wanted())
    }

    /// Forgets what belongs to a lost graphics context.
    pub(super) fn forget_texture(&mut self) {
        self.chart.forget_texture();
    }

    /// Numbers of computed and of all plans.
    pub(super) fn progress(&self) -> (usize, usize) {
        self.map.progress()
    }

    /// The chosen point in words, for screen readers; `None` without one.
    pub(super) fn summary(&self) -> Option<String> {
        let map = self.judged().filter(|_| self.is_open)?;
        let (i, j) = self.chart.cursor()?;
        Some(readout::sentence(map, i, j, self.quantity))
    }
}

/// The error of an axis whose ends are equal, in the words of the chart.
fn empty_axis(axes: &[Axis]) -> Option<String> {
    let axis = axes.iter().find(|axis| (axis.to - axis.from).abs() < f64::MIN_POSITIVE)?;
    let words = Words::of(axis.field);
    Some(tr!(
        "{name} from {from} to {to}; allowed: two different numbers.",
        name = words.name,
        from = words.text(axis.from),
        to = words.text(axis.to)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_set_the_same_field_change_places() {
        let scene = Scene::opening();
        let mut range = Range::default();
        range.set_field(true, Some(Parameter::of(Field::Projection)), &scene);
        assert_eq!(range.up.map(|up| up.field), Some(Parameter::BaseWidth));
        // Volume and projection go together with the width as the third.
        range.set_field(false, Some(Parameter::Volume), &scene);
        assert_eq!(range.axes(&scene).len(), 2);
        range.set_field(true, Some(Parameter::of(Field::Pinch)), &scene);
        assert_eq!(range.up.map(|up| up.field), Some(Parameter::Volume));
        range.set_field(false, None, &scene);
        assert_eq!(range.axes(&scene).len(), 1);
        range.set_field(true, Some(Parameter::Thickness), &scene);
        assert_eq!(range.up, None);
    }

    #[test]
    fn an_axis_without_length_is_one_line_in_the_words_of_the_chart() {
        let axis = Axis { field: Parameter::BaseWidth, from: 120.0, to: 120.0, count: 20 };
        let line = empty_axis(&[axis]).unwrap();
        assert_eq!(line, "Width from 12 cm to 12 cm; allowed: two different numbers.");
        assert_eq!(empty_axis(&[Axis { to: 130.0, ..axis }]), None);
    }

    #[test]
    fn the_chart_stays_while_the_plan_is_on_it_and_follows_a_plan_that_leaves() {
        let (mut range, mut scene) = (Range::default(), Scene::opening());
        let widths = |range: &Range, scene: &Scene| range.ends_of(&range.across, scene);
        range.follow(&scene);
        assert!(range.is_around(&scene));
        for (width, expected) in [(138.0, (100.0, 140.0)), (141.0, (120.0, 160.0))] {
            scene.implant.base_radius_mm = 0.5 * width;
            range.follow(&scene);
            assert_eq!(widths(&range, &scene), expected);
        }
        // Opened again, a plan near the middle has the same chart.
        for (width, expected) in [(132.0, (120.0, 160.0)), (128.0, (110.0, 150.0))] {
            scene.implant.base_radius_mm = 0.5 * width;
            range.is_fresh = true;
            range.follow(&scene);
            assert_eq!(widths(&range, &scene), expected);
        }
        // Typed ends stay until the button.
        range.across.ends = Some((90.0, 170.0));
        range.follow(&scene);
        assert_eq!((widths(&range, &scene), range.is_around(&scene)), ((90.0, 170.0), false));
        range.go_around(&scene);
        assert_eq!((widths(&range, &scene), range.is_around(&scene)), ((110.0, 150.0), true));
    }

    #[test]
    fn differences_are_rounded_up_to_one_digit() {
        assert_eq!(within_text(Quantity::GreatestStrain, 0.0031), "0.4 % (points)");
        assert_eq!(within_text(Quantity::LeastCoverMm, 0.02), "0.02 mm");
        assert_eq!(within_text(Quantity::GreatestPressureMmhg, 12.0), "20 mmHg");
        assert_eq!(within_text(Quantity::ForceN, 0.0), "0.001 N");
    }
}

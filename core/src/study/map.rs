//! A map: one or two numbers of a scene varied over a grid, each point one solved scene.
//!
//! The points are solved from coarse to fine, so that an unfinished map covers the whole range. A point without a shape or
//! without convergence keeps this status; no value is interpolated over such a point.

use super::map_levels::Skin;
use super::map_sample::Sample;
use super::parameter::{Parameter, with_values};
use super::queue::Queue;
use super::{Axis, Case, Cases, Job, Key, MAX_POINTS, MapError, Quantity, Study};
use crate::curve::{number, whole};
use crate::measure::Status;
use crate::measure::bands::SkinLimits;
use crate::scene::{Field, Scene, limits};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Grid and tolerance of the points of a map; those of the scene do not apply.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MapSettings {
    /// Nodes per side, 17 to 1025.
    #[serde(deserialize_with = "whole")]
    pub nodes_per_side: usize,
    /// Greatest node position error allowed \[base radius\], 1e-7 to 1e-2.
    pub tolerance: f64,
}

impl Default for MapSettings {
    fn default() -> Self {
        Self { nodes_per_side: 33, tolerance: 1e-3 }
    }
}

/// Grid and tolerance of the points that check a map.
pub const CHECK: MapSettings = MapSettings { nodes_per_side: 129, tolerance: 1e-4 };

/// The scene of a study: without side, other side and visit.
pub(super) fn base_scene(scene: &Scene) -> Scene {
    // The visit stays in the plan's file, and another visit or side is no other map.
    Scene { side: None, other_side: None, ..scene.without_visit() }
}

impl MapSettings {
    /// Sets grid and tolerance of a scene.
    pub fn apply(self, scene: &mut Scene) {
        scene.solver.nodes_per_side = self.nodes_per_side;
        scene.solver.tolerance = self.tolerance;
    }

    pub(super) fn check(self) -> Result<(), String> {
        let (least, most) = limits::NODES_PER_SIDE;
        if !(least..=most).contains(&self.nodes_per_side) {
            return Err(format!(
                "nodes_per_side is {}; allowed: {least} to {most}",
                self.nodes_per_side
            ));
        }
        let (least, most) = Field::Tolerance.limits;
        if !(least..=most).contains(&self.tolerance) {
            let tolerance = number(self.tolerance);
            return Err(format!("tolerance is {tolerance}; allowed: {least} to {most}"));
        }
        Ok(())
    }
}

/// The state of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PointStatus {
    /// Not solved yet.
    Waiting,
    /// Solved within the tolerance.
    Converged,
    /// Solved, with an error above the tolerance.
    NotConverged,
    /// The tissue has no valid shape.
    NoShape,
    /// The scene of this point is out of its limits, or its job has failed.
    Invalid,
}

impl PointStatus {
    /// The state in words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Converged => "converged",
            Self::NotConverged => "not_converged",
            Self::NoShape => "no_shape",
            Self::Invalid => "invalid",
        }
    }

    /// The state of a case.
    #[must_use]
    pub fn of(case: Option<&Case>) -> Self {
        match case.map(|case| case.status) {
            None => Self::Waiting,
            Some(None) => Self::Invalid,
            Some(Some(Status::Converged)) => Self::Converged,
            Some(Some(Status::NotConverged)) => Self::NotConverged,
            Some(Some(Status::Unstable)) => Self::NoShape,
        }
    }
}

/// The points that are solved in full: `map_border`.
#[derive(Debug, Default)]
pub(super) struct Border {
    pub(super) is_wanted: bool,
    /// Points that are or were solved in full.
    pub(super) tried: BTreeSet<usize>,
    /// Point and key of the running jobs.
    pub(super) running: BTreeMap<usize, (usize, Key)>,
    /// The point to solve next.
    pub(super) next: Option<usize>,
    pub(super) jobs: usize,
}

impl Border {
    /// Numbers of points solved in full, and of all such points that are known.
    pub(super) fn progress(&self) -> (usize, usize) {
        let tried = self.tried.len();
        (tried - self.running.len(), tried + usize::from(self.next.is_some()))
    }
}

/// A map as a state machine, a [`Study`](super::Study). Points are indexed by (i, j) along x and y; j is 0 on a map of
/// one axis.
#[derive(Debug)]
pub struct Map {
    base: Scene,
    pub(super) axes: Vec<Axis>,
    pub(super) settings: MapSettings,
    /// Points by `j · columns + i`.
    pub(super) queue: Queue,
    /// The points that are solved in full.
    pub(super) border: Border,
    pub(super) skin: Skin,
    /// What is known between the solved points.
    pub(super) sample: Sample,
}

impl Map {
    /// A map of one axis or two around a scene.
    ///
    /// # Errors
    /// One line with the axis, its value and the allowed range. Single points out of the limits are no error.
    pub fn new(scene: &Scene, axes: &[Axis], settings: MapSettings) -> Result<Self, MapError> {
        if !(1..=2).contains(&axes.len()) {
            return Err(MapError::Axes(axes.len()));
        }
        settings.check().map_err(MapError::Settings)?;
        let points = axes.iter().map(|axis| axis.count as u128).product();
        if points > MAX_POINTS as u128 {
            return Err(MapError::TooMany(points));
        }
        axes.iter().try_for_each(Axis::check)?;
        let base = base_scene(scene);
        if let [x, y] = axes
            && x.field.excludes(y.field, &base)
        {
            return Err(MapError::Same(x.field.name(), y.field.name()));
        }
        let (axes, queue, border) = (axes.to_vec(), Queue::default(), Border::default());
        let (skin, sample) = (Skin::Different, Sample::default());
        let mut map = Self { base, axes, settings, queue, border, skin, sample };
        map.check_ends()?;
        let knee = |(i, j)| map.scene(i, j).ok().and_then(|scene| scene.skin_knee());
        let [first, others @ ..] = map.corners().map(knee);
        if others.into_iter().all(|other| other == first) {
            map.skin = Skin::Same(SkinLimits::of_skin(first));
        }
        map.queue = Queue::new(map.order());
        Ok(map)
    }

    /// Rejects an end of an axis whose corners are all invalid.
    fn check_ends(&self) -> Result<(), MapError> {
        let (columns, rows) = self.shape();
        let error = |(i, j): (usize, usize)| self.scene(i, j).err();
        for (k, axis) in self.axes.iter().enumerate() {
            for end in [0, axis.count - 1] {
                let corners = match k {
                    0 => [(end, 0), (end, rows - 1)],
                    _ => [(0, end), (columns - 1, end)],
                };
                if let [Some(error), Some(_)] = corners.map(error) {
                    let (field, value) = (axis.field.name(), axis.value(end));
                    return Err(MapError::End { field, value, error });
                }
            }
        }
        Ok(())
    }

    /// Moves the map to a scene with equal points, as with another implant on a map over its size; solved points stay.
    /// Returns false, and changes nothing, if a corner of the map would be another scene.
    pub fn move_to(&mut self, scene: &Scene) -> bool {
        let is_equal = self.has_points_of(scene);
        if is_equal {
            self.base = base_scene(scene);
        }
        is_equal
    }

    /// Would a map around this scene have the same points?
    #[must_use]
    pub fn has_points_of(&self, scene: &Scene) -> bool {
        let (axes, settings) = (self.axes.clone(), self.settings);
        let (queue, border, skin) = (Queue::default(), Border::default(), self.skin);
        let (base, sample) = (base_scene(scene), Sample::default());
        let other = Self { base, axes, settings, queue, border, skin, sample };
        // The axes set the same fields at all points; names of tissues are no other points.
        self.corners().into_iter().all(|(i, j)| match (self.scene(i, j), other.scene(i, j)) {
            (Ok(own), Ok(other)) => own.same_physics(&other),
            (own, other) => own == other,
        })
    }

    fn corners(&self) -> [(usize, usize); 4] {
        let (columns, rows) = self.shape();
        [(0, 0), (columns - 1, 0), (0, rows - 1), (columns - 1, rows - 1)]
    }

    /// The points from coarse to fine: lattices of half the step of the lattice before. Within a lattice the axis whose
    /// change costs the solver more varies slowly.
    pub(super) fn order(&self) -> Vec<usize> {
        let (columns, rows) = self.shape();
        let lattice = |count: usize, step: usize| -> Vec<usize> {
            let inner = (0..count.saturating_sub(1)).step_by(step);
            inner.chain([count - 1]).collect()
        };
        let is_x_slow = match &self.axes[..] {
            [x, y] => x.field.change() >= y.field.change(),
            _ => false,
        };
        let mut is_listed = vec![false; columns * rows];
        let mut order = Vec::with_capacity(columns * rows);
        let mut step = columns.max(rows).next_power_of_two();
        while step > 0 {
            let (is, js) = (lattice(columns, step), lattice(rows, step));
            let mut list = |i: usize, j: usize| {
                if !std::mem::replace(&mut is_listed[j * columns + i], true) {
                    order.push(j * columns + i);
                }
            };
            if is_x_slow {
                is.iter().for_each(|&i| js.iter().for_each(|&j| list(i, j)));
            } else {
                js.iter().for_each(|&j| is.iter().for_each(|&i| list(i, j)));
            }
            step /= 2;
        }
        order
    }

    /// Numbers of columns and rows; one row on a map of one axis.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        let count = |k: usize| self.axes.get(k).map_or(1, |axis| axis.count);
        (count(0), count(1))
    }

    /// The axes, x first.
    #[must_use]
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Grid and tolerance of the points.
    #[must_use]
    pub fn settings(&self) -> MapSettings {
        self.settings
    }

    /// The scene around which the map varies its axes, without the map's grid.
    #[must_use]
    pub fn base(&self) -> &Scene {
        &self.base
    }

    /// The scene of a point.
    ///
    /// # Errors
    /// One line if the scene is out of its limits.
    pub fn scene(&self, i: usize, j: usize) -> Result<Scene, String> {
        self.scene_with(i, j, self.settings)
    }

    /// The values of the axes at a point.
    pub(super) fn values_at(&self, i: usize, j: usize) -> Vec<(Parameter, f64)> {
        self.axes.iter().zip([i, j]).map(|(axis, k)| (axis.field, axis.value(k))).collect()
    }

    pub(super) fn scene_with(
        &self,
        i: usize,
        j: usize,
        settings: MapSettings,
    ) -> Result<Scene, String> {
        let mut scene =
            with_values(&self.base, &self.values_at(i, j)).map_err(|error| error.to_string())?;
        scene.patient = None;
        settings.apply(&mut scene);
        scene.validate().map_err(|error| error.to_string())?;
        Ok(scene)
    }

    /// The case of a point; `None` while the point is not solved.
    #[must_use]
    pub fn case(&self, i: usize, j: usize) -> Option<&Case> {
        let (columns, rows) = self.shape();
        if i >= columns || j >= rows {
            return None;
        }
        self.queue.case(j * columns + i)
    }

    /// The state of a point.
    #[must_use]
    pub fn status(&self, i: usize, j: usize) -> PointStatus {
        match self.case(i, j) {
            None => self.sample.state(j * self.shape().0 + i),
            case => PointStatus::of(case),
        }
    }

    /// The value of a converged point, or the interpolated one.
    #[must_use]
    pub fn value(&self, quantity: Quantity, i: usize, j: usize) -> Option<f64> {
        match self.case(i, j) {
            Some(case) => case.values.get(quantity).filter(|_| case.is_converged()),
            None => self.interpolated(quantity, i, j).map(|(value, _)| value),
        }
    }

    /// Least and greatest value of the converged points.
    #[must_use]
    pub fn range(&self, quantity: Quantity) -> Option<(f64, f64)> {
        let values = self.field(quantity);
        let finite = values.iter().copied().filter(|value| value.is_finite());
        let range = finite
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
        (range.0 <= range.1).then_some(range)
    }

    /// The values of the map's scene on the axes; `None` if the scene lies outside of the map or has no such value.
    #[must_use]
    pub fn present(&self) -> Option<[f64; 2]> {
        self.place(&self.base)
    }

    /// The values of a scene on the axes; `None` if the scene lies outside of the map or has no such value.
    #[must_use]
    pub fn place(&self, scene: &Scene) -> Option<[f64; 2]> {
        let within = |axis: &Axis| axis.field.value(scene).filter(|value| axis.contains(*value));
        match &self.axes[..] {
            [x, y] => Some([within(x)?, within(y)?]),
            [x] => Some([within(x)?, 0.0]),
            _ => None,
        }
    }

    /// Does the pocket follow the implant on this map?
    #[must_use]
    pub fn pocket_follows(&self) -> bool {
        let sets = |axis: &Axis| axis.field.row().0 == Field::PocketRadius;
        self.axes.iter().any(|axis| axis.field.moves_implant()) && !self.axes.iter().any(sets)
    }

    /// Number of points of each state, without those of no point.
    #[must_use]
    pub fn counts(&self) -> Vec<(PointStatus, usize)> {
        use PointStatus::{Converged, Invalid, NoShape, NotConverged, Waiting};
        let (columns, rows) = self.shape();
        let states = (0..columns * rows).map(|k| self.status(k % columns, k / columns));
        let states: Vec<PointStatus> = states.collect();
        let count = |status| states.iter().filter(|state| **state == status).count();
        let all = [Converged, NotConverged, NoShape, Invalid, Waiting];
        all.into_iter().map(|status| (status, count(status))).filter(|(_, n)| *n > 0).collect()
    }

    /// Are all points solved that are to be, those at the border of no answer not counted?
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let (done, all) = self.queue.progress();
        done == all && !self.sample.is_open()
    }

    /// Number of solved points.
    #[must_use]
    pub fn scenes_solved(&self) -> usize {
        let solved = |case: &&Case| case.status.is_some();
        self.cases().iter().flatten().filter(solved).count() + self.border.progress().0
    }

    /// The cases of all points, by `j · columns + i`.
    #[must_use]
    pub fn cases(&self) -> &[Option<Case>] {
        self.queue.cases()
    }
}

/// Scenes in a job: few enough for a steady progress, enough to share grids and tables; of the points of a round, which ends with the last.
const SCENES_PER_JOB: usize = 10;
const SCENES_OF_ROUND: usize = 2;

impl Study for Map {
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        let (columns, is_sampled) = (self.shape().0, self.is_sampled());
        let most = if is_sampled { SCENES_OF_ROUND } else { SCENES_PER_JOB };
        loop {
            // The scenes are made from the rest of the map.
            let mut queue = std::mem::take(&mut self.queue);
            let scene = |item: usize| self.scene(item % columns, item / columns);
            let job = queue.next_job(most, false, store, scene);
            self.queue = queue;
            if job.is_some() {
                return job;
            }
            if !self.refine() {
                break;
            }
        }
        // Stored cases end the queue without a job.
        self.update_border();
        self.next_border_job(store)
    }

    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        if !self.receive_border(job, &cases, store) {
            self.queue.receive(job, cases, store);
            self.preview();
            self.update_border();
        }
    }

    fn progress(&self) -> (usize, usize) {
        let ((done, all), (solved, of_border)) = (self.queue.progress(), self.border.progress());
        // A round may follow.
        let done = if self.sample.is_open() { done.min(all.saturating_sub(1)) } else { done };
        (done + solved, all + of_border)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_moves_to_a_scene_with_equal_points_and_to_no_other() {
        let axes = ["base_width_mm=100:140:3", "projection_mm=30:50:3"];
        let axes = axes.map(|axis| Axis::parse(axis).unwrap());
        let scene = Scene::opening();
        let mut map = Map::new(&scene, &axes, MapSettings::default()).unwrap();
        // Another implant of the map, on its grid or not, with the same margin of the pocket.
        for (width, projection) in [(120.0, 40.0), (111.1, 33.3)] {
            let values =
                [(Parameter::BaseWidth, width), (Parameter::of(Field::Projection), projection)];
            let other = with_values(&scene, &values).unwrap();
            assert!(map.move_to(&other));
            assert_eq!(map.present(), Some([width, projection]));
        }
        let present = map.present();
        let edits: [fn(&mut Scene); 3] = [
            |scene| scene.pocket_radius_mm += 1.0,
            |scene| scene.layers[1].thickness_mm += 1.0,
            |scene| scene.insertion = 0.9,
        ];
        for edit in edits {
            let mut other = scene.clone();
            edit(&mut other);
            assert!(!map.move_to(&other));
            assert_eq!(map.present(), present);
        }
    }
}

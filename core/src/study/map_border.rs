//! The border of the points without an answer: solved in full, after all points of a map.
//!
//! The quick solve of a map leaves Newton's method out on layered tissue. Points without an answer beside a point with one are
//! solved again as a plan is, the nearest to the plan first, one scene per job. A point that has an answer then makes its
//! neighbours the border.

use super::map::{Map, MapSettings, PointStatus};
use super::{Case, Cases, Job};

/// Greatest number of points of a map that are solved in full.
const MAX_POINTS: usize = 100;
/// Greatest number of nodes per side of such a point: Newton's method takes seconds there.
const MAX_NODES: usize = 65;
/// Index of the first job of the border; those of the points are lower.
const FIRST_JOB: usize = 1 << 30;

impl Map {
    /// The map with the border of its points without an answer solved in full, for layered tissue.
    #[must_use]
    pub fn with_full_border(mut self) -> Self {
        // The quick solve of a sheet is the full one.
        self.border.is_wanted = self.base().is_layered();
        self
    }

    /// Was the point solved in full, as a plan is?
    #[must_use]
    pub fn is_in_full(&self, i: usize, j: usize) -> bool {
        let item = j * self.shape().0 + i;
        let is_running = self.border.running.values().any(|(running, _)| *running == item);
        self.border.tried.contains(&item) && !is_running
    }

    /// Number of points that were solved in full.
    #[must_use]
    pub fn solved_in_full(&self) -> usize {
        self.border.progress().0
    }

    /// Grid and tolerance of a point solved in full: those of the plan, as far as that takes seconds.
    fn full_settings(&self) -> MapSettings {
        let (plan, least) = (self.base().solver, self.settings().nodes_per_side);
        let nodes_per_side = plan.nodes_per_side.clamp(least, MAX_NODES.max(least));
        MapSettings { nodes_per_side, tolerance: plan.tolerance }
    }

    /// The next job of the border. Points whose case is stored enter no job.
    pub(super) fn next_border_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        while let Some(item) = self.border.next {
            self.border.tried.insert(item);
            let columns = self.shape().0;
            if let Ok(scene) = self.scene_with(item % columns, item / columns, self.full_settings())
            {
                let [quick, key] = [store.key(&scene), store.key_in_full(&scene)];
                let stored = store.reuse(&key, false).cloned();
                let quick =
                    || store.reuse(&quick, false).filter(|case| case.is_converged()).cloned();
                let Some(case) = stored.or_else(quick) else {
                    let index = FIRST_JOB + self.border.jobs;
                    self.border.jobs += 1;
                    self.border.running.insert(index, (item, key));
                    self.update_border();
                    return Some((index, Job { scenes: vec![scene], profile: false, full: true }));
                };
                self.take(item, &case);
            }
            self.update_border();
        }
        None
    }

    /// Takes the case of a job of the border; returns whether the job is one. A failed job leaves its point without an answer.
    pub(super) fn receive_border(&mut self, job: usize, cases: &[Case], store: &mut Cases) -> bool {
        let Some((item, key)) = self.border.running.remove(&job) else { return false };
        if let Some(case) = cases.first().filter(|case| case.status.is_some()) {
            store.insert(key, case.clone());
            self.take(item, case);
        }
        self.update_border();
        true
    }

    /// An answer takes the place of the missing one.
    fn take(&mut self, item: usize, case: &Case) {
        if case.is_converged() {
            self.queue.replace(item, case.clone());
        }
    }

    /// Finds the point to solve next, once all points are solved.
    pub(super) fn update_border(&mut self) {
        let (done, all) = self.queue.progress();
        let is_open = self.border.is_wanted
            && done == all
            && !self.sample.is_open()
            && self.border.tried.len() < MAX_POINTS;
        self.border.next = if is_open { self.nearest_of_border() } else { None };
    }

    /// The point of the border nearest to the plan. Without any answer on the map, the point nearest to the plan.
    fn nearest_of_border(&self) -> Option<usize> {
        let (columns, rows) = self.shape();
        let index = |k: usize, value: f64| {
            self.axes().get(k).map_or(0.0, |axis| {
                (value - axis.from) / (axis.to - axis.from) * (axis.count - 1) as f64
            })
        };
        let plan = self.present().map_or_else(
            || [0.5 * (columns - 1) as f64, 0.5 * (rows - 1) as f64],
            |[x, y]| [index(0, x), index(1, y)],
        );
        let status = |i: usize, j: usize| self.status(i, j);
        let points = || (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        let has_answers = points().any(|(i, j)| status(i, j) == PointStatus::Converged);
        let is_beside = |i: usize, j: usize| {
            let around = |k: usize, count: usize| k.saturating_sub(1)..(k + 2).min(count);
            around(j, rows)
                .any(|b| around(i, columns).any(|a| status(a, b) == PointStatus::Converged))
        };
        let distance = |(i, j): (usize, usize)| (i as f64 - plan[0]).hypot(j as f64 - plan[1]);
        let candidates = points().filter(|&(i, j)| {
            let is_missing =
                matches!(status(i, j), PointStatus::NotConverged | PointStatus::NoShape);
            let is_untried = !self.border.tried.contains(&(j * columns + i));
            let is_reached =
                if has_answers { is_beside(i, j) } else { self.border.tried.is_empty() };
            is_missing && is_untried && is_reached
        });
        let nearest = candidates.min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
        nearest.map(|(i, j)| j * columns + i)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Status;
    use crate::scene::{Field, Scene};
    use crate::study::{Axis, Parameter, Study, flat_plan};

    fn map() -> Map {
        let axis = Axis { field: Parameter::of(Field::Projection), from: 30.0, to: 60.0, count: 7 };
        Map::new(&flat_plan(), &[axis], MapSettings::default()).unwrap().with_full_border()
    }

    fn case(has_answer: bool) -> Case {
        let status = if has_answer { Status::Converged } else { Status::Unstable };
        Case { status: Some(status), ..Case::default() }
    }

    /// Runs a map with rules of the quick and of the full solve by projection \[mm\]; returns the projections solved in full.
    fn run(map: &mut Map, store: &mut Cases, quick: f64, full: f64) -> Vec<f64> {
        let mut in_full = Vec::new();
        while let Some((index, job)) = map.next_job(store) {
            let most = if job.full { full } else { quick };
            let of = |scene: &Scene| case(scene.implant.projection_mm < most);
            if job.full {
                assert_eq!(job.scenes[0].solver.nodes_per_side, MAX_NODES);
                in_full.push(job.scenes[0].implant.projection_mm);
                assert!(!map.is_done());
            }
            map.receive(index, job.scenes.iter().map(of).collect(), store);
        }
        assert!(map.is_done());
        in_full
    }

    #[test]
    fn the_border_moves_until_the_full_solve_has_no_answer() {
        let (mut map, mut store) = (map(), Cases::default());
        assert_eq!(run(&mut map, &mut store, 41.0, 52.0), [45.0, 50.0, 55.0]);
        let answers: Vec<bool> =
            (0..7).map(|i| map.status(i, 0) == PointStatus::Converged).collect();
        assert_eq!(answers, [true, true, true, true, true, false, false]);
        // The last point of all was not solved in full.
        assert_eq!([5, 6].map(|i| map.is_in_full(i, 0)), [true, false]);
        assert_eq!((map.solved_in_full(), map.progress()), (3, (10, 10)));
        // A second map takes all cases from the store.
        let mut again = self::map();
        assert!(run(&mut again, &mut store, 0.0, 0.0).is_empty());
        assert_eq!(again.cases(), map.cases());
    }

    #[test]
    fn a_map_without_any_answer_is_tried_at_the_plan() {
        let (mut map, mut store) = (map(), Cases::default());
        assert_eq!(run(&mut map, &mut store, 0.0, 0.0), [40.0]);
        let mut sheet = Map::new(&Scene::sheet(), map.axes(), MapSettings::default()).unwrap();
        sheet = sheet.with_full_border();
        assert!(run(&mut sheet, &mut Cases::default(), 0.0, 0.0).is_empty());
    }

    #[test]
    fn a_failed_job_leaves_the_point_as_it_is() {
        let (mut map, mut store) = (map(), Cases::default());
        while let Some((index, job)) = map.next_job(&mut store) {
            let of = |scene: &Scene| case(scene.implant.projection_mm < 41.0);
            let cases = if job.full { Vec::new() } else { job.scenes.iter().map(of).collect() };
            map.receive(index, cases, &mut store);
        }
        assert_eq!((map.is_done(), map.status(3, 0)), (true, PointStatus::NoShape));
    }
}

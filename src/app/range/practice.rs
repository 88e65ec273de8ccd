//! What the strains of the chart are compared with: practice of the plan and of each value of the axis along which practice varies.

use crate::app::answer::practice::{Against, Practices};
use crate::scene::Scene;
use crate::study::{Map, MapPractice, has_same_practice};

/// Practice of the present map.
#[derive(Default)]
pub(super) struct ChartPractice {
    /// Number of the map's start and of practice's changes to which the rest belongs.
    key: Option<(u64, u64)>,
    /// The axis along which practice varies: 0 or 1.
    along: usize,
    /// The plan, and the plan of each value of that axis, on the grid of the map. Empty where practice varies along both axes.
    plans: Vec<Scene>,
    is_pending: bool,
    found: Option<MapPractice>,
}

impl ChartPractice {
    /// Follows a map, once a frame; returns whether practice has changed, or is known or waited for anew. `starts` counts the starts and moves of maps.
    pub(super) fn follow(&mut self, map: Option<&Map>, starts: u64, practices: &Practices) -> bool {
        let Some(map) = map else { return false };
        let key = (starts, practices.changes());
        let before = self.key.replace(key);
        if before == Some(key) {
            return false;
        }
        if before.is_none_or(|(before, _)| before != starts) {
            let along = along(map);
            self.along = along.unwrap_or_default();
            self.plans = along.map_or_else(Vec::new, |along| plans(map, along));
        }
        let against: Vec<Against> = self.plans.iter().map(|plan| practices.against(plan)).collect();
        let was_pending =
            std::mem::replace(&mut self.is_pending, against.contains(&Against::Waiting));
        let found = match against.split_first() {
            Some((Against::Practice(plan), points)) if !self.is_pending => {
                let points = points.iter().map(|against| against.practice()).collect();
                Some(MapPractice::new(*plan, self.along, points))
            }
            _ => None,
        };
        let is_other = self.found != found || self.is_pending != was_pending;
        self.found = found;
        is_other
    }

    /// The plans whose practice is wanted: none once all of it is known.
    pub(super) fn wanted(&self) -> &[Scene] {
        if self.is_pending { &self.plans } else { &[] }
    }

    /// Is practice of a plan not known yet?
    pub(super) fn is_pending(&self) -> bool {
        self.is_pending
    }

    /// Does practice say nothing about some of the points?
    pub(super) fn has_gaps(&self) -> bool {
        self.found.as_ref().is_some_and(MapPractice::has_gaps)
    }

    /// Practice, once all of it is known.
    pub(super) fn found(&self) -> Option<&MapPractice> {
        self.found.as_ref()
    }
}

/// The plan of a point, whose patient a point of the map has not.
fn plan(map: &Map, i: usize, j: usize) -> Option<Scene> {
    let scene = map.scene(i, j).ok()?;
    Some(Scene { patient: map.base().patient.clone(), ..scene })
}

/// The axis along which practice varies; `None` if along both.
fn along(map: &Map) -> Option<usize> {
    let (columns, rows) = map.shape();
    let varies = |i, j| match (plan(map, 0, 0), plan(map, i, j)) {
        (Some(first), Some(last)) => !has_same_practice(&first, &last),
        _ => true,
    };
    match (varies(columns - 1, 0), rows > 1 && varies(0, rows - 1)) {
        (_, false) => Some(0),
        (false, true) => Some(1),
        (true, true) => None,
    }
}

/// The plan of the map on its grid, then that of each value of an axis. A point out of the limits of a scene has the plan of the map.
fn plans(map: &Map, along: usize) -> Vec<Scene> {
    let mut base = map.base().clone();
    map.settings().apply(&mut base);
    let (columns, rows) = map.shape();
    let point = |k: usize| match along {
        0 => plan(map, k, 0),
        _ => plan(map, 0, k),
    };
    let count = if along == 0 { columns } else { rows };
    let points = (0..count).map(|k| point(k).unwrap_or_else(|| base.clone()));
    std::iter::once(base.clone()).chain(points).collect()
}

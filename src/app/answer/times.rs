//! The plan on the table, after a week and after six months: a table on the screen and in the report, once its skin has a state.

use super::before_after::{self, Table};
use crate::app::frame::studies::{Driver, Studies};
use crate::app::plan::when::{has_state, name};
use crate::app::texts::{fixed, tr};
use crate::app::widgets::{group, remark};
use crate::clinical::{Expected, When};
use crate::scene::Scene;
use crate::study::{AtTime, Quantity, Times};
use eframe::egui::Ui;

/// Title of the table.
pub(crate) const TITLE: &str = "On the table and later";

/// What the table has and leaves out.
const NOTE: &str = "In brackets: within one standard deviation of relaxation and growth, which are estimates from skin of animals and from when breasts \
     stop changing. Fat, capsule and the way of the fold are not computed.";

/// Beside ranges from which deviations are missing.
const LEFT_OUT: &str =
    "Some states within the standard deviation have no answer; the range leaves them out.";

/// Quantities of the table, with their decimals.
const ROWS: [(Quantity, usize); 5] = [
    (Quantity::MeanPressureMmhg, 0),
    (Quantity::GreatestPressureMmhg, 0),
    (Quantity::GreatestStrain, 0),
    (Quantity::SkinAreaGainCm2, 0),
    (Quantity::SkinProjectionMm, 1),
];

/// The study behind the table.
#[derive(Default)]
pub(crate) struct PlanTimes {
    study: Driver<Times>,
    /// The scene of the present study.
    started: Option<Scene>,
}

impl PlanTimes {
    /// Starts, continues or cancels the study, once a frame. `is_busy`: the plan is being solved or edited.
    pub(crate) fn advance(&mut self, scene: &Scene, studies: &mut Studies, is_busy: bool) {
        if !has_state(scene) {
            if self.started.take().is_some() {
                self.study.cancel(studies);
            }
            return;
        }
        let is_started = self.started.as_ref().is_some_and(|started| started.same_physics(scene));
        if !is_busy && !is_started {
            self.started = Some(scene.clone());
            match Times::new(scene) {
                Ok(times) => self.study.start(times, studies),
                Err(_) => self.study.cancel(studies),
            }
        }
        self.study.advance(studies);
    }

    /// The table of a plan; `None` before the study of that plan has ended.
    pub(crate) fn table(&self, scene: &Scene) -> Option<Table> {
        let is_of_plan = self.started.as_ref().is_some_and(|started| started.same_physics(scene));
        let times = self.study.finished().filter(|_| is_of_plan)?;
        let row = |(quantity, decimals): (Quantity, usize)| {
            let (factor, unit) = quantity.display();
            let text = |at: AtTime| in_words(at.value, at.range, factor, decimals);
            let cells = When::ALL.map(|when| times.value(when, quantity).map_or_else(none, text));
            (format!("{}, {unit}", tr(quantity.title())), "", cells.to_vec())
        };
        let fold = When::ALL.map(|when| match when.fold_drop_mm() {
            Expected { value, deviation: None } if value <= 0.0 => none(),
            Expected { value, .. } => fixed(value, 0),
        });
        let fold = (
            tr("Fold lower, mm").to_owned(),
            tr("Of 14 women, Eder et al. 2011; no computed shape has it"),
            fold.to_vec(),
        );
        let heads = When::ALL.map(|when| name(when).to_owned()).to_vec();
        let lines = ROWS.into_iter().map(row).chain([fold]).collect();
        let left_out = When::ALL.map(|when| times.left_out(when)).iter().sum::<usize>();
        let left_out = (left_out > 0).then(|| tr(LEFT_OUT).to_owned());
        let notes = [tr(NOTE).to_owned()].into_iter().chain(left_out).collect();
        Some(Table { heads, lines, notes })
    }

    /// The section of the table; nothing for skin without a state.
    pub(crate) fn section(&self, ui: &mut Ui, scene: &Scene) {
        if !has_state(scene) {
            return;
        }
        group(ui, tr(TITLE), |ui| {
            let Some(table) = self.table(scene) else {
                // They wait for the plan itself.
                if let (done, count @ 1..) = self.study.progress() {
                    remark(ui, tr!("{done} of {count} times computed.", done, count));
                }
                return;
            };
            before_after::show(ui, table, "times");
        });
    }
}

fn none() -> String {
    "–".to_owned()
}

/// A value with its range, if that is one.
fn in_words(value: f64, [least, most]: [f64; 2], factor: f64, decimals: usize) -> String {
    let text = |value: f64| fixed(factor * value, decimals);
    if text(least) == text(most) {
        return text(value);
    }
    format!("{} ({}–{})", text(value), text(least), text(most))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::frame::studies::tests::studies;
    use eframe::egui;

    #[test]
    fn a_plan_under_tension_has_its_times_and_another_plan_has_none() {
        let (mut studies, log) = studies(&[]);
        let (mut times, mut scene) = (PlanTimes::default(), Scene::opening());
        scene.solver.nodes_per_side = 17;
        scene.solver.tolerance = 1e-2;
        times.advance(&scene, &mut studies, false);
        assert!(times.table(&scene).is_none() && log.borrow().submitted == 0);
        scene.set_natural_tension(20.0).unwrap();
        for _ in 0..1000 {
            studies.poll(&egui::Context::default(), false);
            times.advance(&scene, &mut studies, false);
        }
        let table = times.table(&scene).unwrap();
        assert_eq!((table.heads.len(), table.lines.len()), (3, 6));
        assert!(table.lines[0].2[2].contains('('), "{:?}", table.lines[0]);
        assert_eq!(table.lines[5].2, ["0", "–", "14"]);
        scene.implant.projection_mm += 1.0;
        assert!(times.table(&scene).is_none());
        assert_eq!(in_words(0.124, [0.1, 0.2], 100.0, 0), "12 (10–20)");
    }
}

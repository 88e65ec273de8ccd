//! The chart of the range for the report: that of the screen, drawn once more from the solved map.

use super::Range;
use super::chart::Chart;
use crate::app::texts::tr;
use crate::session::Session;
use eframe::egui::Ui;

/// How the report gets the chart.
const HOW: &str = "The chart of the range is not in this report. Open the page Range of implants, wait for its last plan, and save \
                   the report again.";

/// The chart of a plan.
pub(crate) struct ReportChart<'a> {
    range: &'a Range,
    /// Of its own: textures belong to the context of the picture.
    chart: Chart,
    /// The quantity of the colours, as a title.
    pub(crate) title: String,
    /// The lines below the chart.
    pub(crate) caption: String,
    /// Grid and accuracy of its points.
    pub(crate) accuracy: String,
}

impl Range {
    /// The chart of the present plan from the solved map; nothing is solved for a report.
    ///
    /// # Errors
    /// Returns how to get the chart, if the map is that of another plan, does not contain the plan, or is being solved.
    pub(crate) fn for_report(
        &mut self,
        session: &Session,
    ) -> Result<ReportChart<'_>, &'static str> {
        let is_solved = !self.map.is_running();
        let map = self.map.study_mut().filter(|_| is_solved).ok_or(tr(HOW))?;
        // The plan may have been edited since the page was open: another size on the chart keeps all points.
        if map.place(session.scene()).is_none() || !map.move_to(session.scene()) {
            return Err(tr(HOW));
        }
        if let Some((scene, _)) =
            self.started.as_mut().filter(|(scene, _)| scene != session.scene())
        {
            // The page moves the map back to another plan when it is opened.
            scene.clone_from(session.scene());
            self.revision += 1;
            self.starts += 1;
        }
        self.pins.update(map, self.starts, session);
        self.sizes.update(map, self.starts);
        let map = self.map.study().ok_or(tr(HOW))?;
        Ok(ReportChart {
            title: tr!(
                "Range of implants: {quantity}",
                quantity = tr(self.quantity.title()).to_lowercase()
            ),
            caption: self.caption_in_words(map, Some("")),
            accuracy: self.accuracy_in_words(map),
            chart: Chart::default(),
            range: self,
        })
    }
}

impl ReportChart<'_> {
    /// Shows the chart in the remaining space.
    pub(crate) fn show(&mut self, ui: &mut Ui) {
        let Range { pins, sizes, quantity, revision, practice, .. } = self.range;
        if let Some(map) = self.range.judged() {
            let map = (map, practice.is_pending());
            self.chart.show(ui, map, *quantity, *revision, (pins, sizes));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::answer::practice::Practices;
    use crate::app::frame::studies::Studies;
    use crate::app::range::AxisChoice;
    use crate::app::widgets::texts_of;
    use crate::scene::Scene;
    use crate::session::Command;
    use crate::solve::Progress;
    use crate::study::{
        Axis, Case, Cases, Finished, Job, Map, MapSettings, Parameter, Runner, Study, evaluate,
        with_values,
    };
    use eframe::egui;

    /// A solved map around a sheet, and a session with a pin beside the plan.
    fn solved() -> (Range, Session) {
        let mut scene = Scene::sheet();
        scene.solver.nodes_per_side = 17;
        let axes = ["base_width_mm=80:140:7", "projection_mm=20:80:7"];
        let axes = axes.map(|axis| Axis::parse(axis).unwrap());
        let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
        let (mut map, mut store) = (Map::new(&scene, &axes, settings).unwrap(), Cases::default());
        while let Some((index, job)) = map.next_job(&mut store) {
            map.receive(index, evaluate(&job), &mut store);
        }
        let mut range = Range::default();
        range.map.set(map);
        let mut session = Session::new(scene).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        session.apply(Command::Pin).unwrap();
        (range, session)
    }

    fn edit(session: &mut Session, parameter: Parameter, value: f64) {
        let scene = Box::new(with_values(session.scene(), &[(parameter, value)]).unwrap());
        session.apply(Command::Edit { scene, gesture: 1 }).unwrap();
    }

    /// The texts of the chart as drawn.
    fn texts(mut chart: ReportChart<'_>) -> Vec<String> {
        texts_of(egui::vec2(860.0, 400.0), |ui| chart.show(ui))
    }

    #[test]
    fn the_chart_of_the_report_has_plan_pins_and_the_words_of_the_areas() {
        let (mut range, mut session) = solved();
        // Another size on the chart keeps its points.
        edit(&mut session, Parameter::BaseWidth, 100.0);
        let chart = range.for_report(&session).ok().unwrap();
        assert_eq!(chart.title, "Range of implants: skin stretch");
        assert!(chart.caption.starts_with("49 plans computed."), "{}", chart.caption);
        // The grid stands with the technical details.
        assert!(!chart.caption.contains("computation"), "{}", chart.caption);
        assert!(chart.accuracy.starts_with("A quick, coarse computation"), "{}", chart.accuracy);
        let texts = texts(chart);
        for word in ["this plan", "A", "usual", "high", "Width (cm)", "Projection (cm)"] {
            assert!(texts.iter().any(|text| text == word), "{word} in {texts:?}");
        }
    }

    /// Finishes no job.
    struct Never(usize);

    impl Runner for Never {
        type Job = Job;
        type Done = Vec<Case>;

        fn submit(&mut self, _: Job) -> usize {
            self.0 += 1;
            self.0 - 1
        }

        fn cancel(&mut self, _: usize) {}

        fn poll(&mut self) -> Option<Finished<Vec<Case>>> {
            None
        }

        fn next(&mut self) -> Option<Finished<Vec<Case>>> {
            None
        }
    }

    #[test]
    fn a_chart_closed_during_its_check_stays_for_the_report() {
        let (mut range, session) = solved();
        let ctx = egui::Context::default();
        let mut studies = Studies::new(&ctx, |_| Box::new(Never(0)));
        let check = range.map.study().and_then(Map::check).unwrap();
        range.check.start(check, &mut studies);
        assert!(range.check.is_running());
        range.advance(&ctx, session.scene(), &Practices::default(), &mut studies);
        assert!(!range.is_open && !range.check.is_running());
        assert!(range.for_report(&session).is_ok());
    }

    #[test]
    fn a_chart_moved_for_a_report_is_moved_back_to_the_plan_of_the_page() {
        let (mut range, mut session) = solved();
        let before = session.scene().clone();
        let axes = range.map.study().map(|map| map.axes().to_vec()).unwrap();
        // The page as it was left: axes as typed, the map that of the plan.
        range.across.ends = Some((axes[0].from, axes[0].to));
        range.up = range.up.map(|up| AxisChoice { ends: Some((axes[1].from, axes[1].to)), ..up });
        range.fineness = axes[0].count;
        assert_eq!(range.axes(&before), axes);
        range.started = Some((before.clone(), axes));
        let place = |range: &Range| range.map.study().and_then(Map::present);
        let own = place(&range);
        edit(&mut session, Parameter::BaseWidth, 100.0);
        assert!(range.for_report(&session).is_ok());
        assert_ne!(place(&range), own);
        // The former plan again, on the opened page.
        range.is_open = true;
        let mut studies = Studies::new(&egui::Context::default(), |_| Box::new(Never(0)));
        range.advance(&egui::Context::default(), &before, &Practices::default(), &mut studies);
        assert_eq!(place(&range), own);
    }

    #[test]
    fn a_chart_of_another_patient_or_without_the_plan_is_none() {
        let (mut range, mut session) = solved();
        edit(&mut session, Parameter::BaseWidth, 160.0);
        assert_eq!(range.for_report(&session).err(), Some(HOW));
        edit(&mut session, Parameter::BaseWidth, 100.0);
        assert!(range.for_report(&session).is_ok());
        edit(&mut session, Parameter::PocketMargin, 25.0);
        assert_eq!(range.for_report(&session).err(), Some(HOW));
        assert_eq!(Range::default().for_report(&session).err(), Some(HOW));
    }
}

//! The section of the answer: switch, progress, what matters most, scenarios of the method of measurement; then what is varied.

use super::{Findings, Uncertainty, chart, has_answer};
use crate::app::frame::research;
use crate::app::texts::{fixed, localized, pressure, pressures, tr};
use crate::app::widgets::theme::{self, SPACE, SPACE_SMALL};
use crate::app::widgets::{rejection_label, remark, set_accessible_name};
use crate::measure::Outcome;
use crate::session::Session;
use crate::study::{Band, NOTES, PointStatus, Quantity, Scenario};
use eframe::egui::{self, RichText, Ui};

/// The sentence beside every band.
pub(super) const ILLUSTRATION: &str = NOTES[0];
const INDEPENDENT: &str = NOTES[1];
const METHODS: &str = NOTES[2];

/// The three figures of the answer.
pub(super) const ANSWER: [(Quantity, &str); 3] = [
    (Quantity::GreatestStrain, "Skin stretch"),
    (Quantity::LeastCoverMm, "Cover"),
    (Quantity::GreatestPressureMmhg, "Pressure"),
];

impl Uncertainty {
    /// Shows the section, a closed fold at first.
    pub(crate) fn show(&mut self, ui: &mut Ui, session: &Session) {
        let title = RichText::new(tr("Uncertainty")).strong();
        egui::CollapsingHeader::new(title).show_unindented(ui, |ui| {
            ui.checkbox(&mut self.is_on, tr("Show what is not known")).on_hover_text(
                tr("The tissue of a person is never known exactly. The program repeats the computation for many \
                 patients who could have these measurements, and shows how far their answers lie apart."),
            );
            if self.is_on {
                remark(ui, tr(ILLUSTRATION));
                self.state(ui, session);
                if !self.all.findings.is_empty() {
                    self.bands(ui, session);
                }
                self.varied(ui, session);
            } else {
                remark(ui, tr("The range of every number over what is not known about a patient, and which of it matters most. It takes some seconds."));
            }
            ui.add_space(SPACE_SMALL);
        });
    }

    /// The spreads and the samples, a closed fold at first.
    fn varied(&mut self, ui: &mut Ui, session: &Session) {
        ui.add_space(SPACE_SMALL);
        // Names of its own: the rows above come and go while a study runs, under a press and a release of a switch.
        let builder = egui::UiBuilder::new().scope_id(egui::Id::unique("what is varied"));
        ui.scope_builder(builder, |ui| {
            egui::CollapsingHeader::new(tr("What is varied")).show_unindented(ui, |ui| {
                self.choices.show(ui, session.scene());
                remark(ui, tr(INDEPENDENT));
            });
        });
    }

    /// Progress, and why there are no bands.
    fn state(&self, ui: &mut Ui, session: &Session) {
        let findings = &self.all.findings;
        if let Some(error) = &self.all.error {
            rejection_label(ui, error);
        } else if self.all.is_waiting() {
            let is_coming = session.is_working() || has_answer(session);
            remark(
                ui,
                if is_coming {
                    tr("Begins after the plan.")
                } else {
                    tr("This plan has no answer.")
                },
            );
        } else if self.all.driver.is_running() {
            let (done, all) = self.progress();
            let words = if findings.solved() < findings.samples {
                tr!(
                    "{done} of {all} sampled patients",
                    done = findings.solved(),
                    all = findings.samples
                )
            } else {
                let part = 100.0 * done as f64 / all.max(1) as f64;
                tr!("What matters most: {part:.0} % computed", part)
            };
            let bar = egui::ProgressBar::new(done as f32 / all.max(1) as f32)
                .desired_height(6.0)
                .fill(theme::palette(ui.visuals()).accent);
            let role = egui::Role::ProgressIndicator;
            set_accessible_name(&ui.add(bar), role, tr("Progress of the sampled patients"));
            remark(ui, words);
        } else if findings.bands.is_empty() {
            remark(
                ui,
                tr!(
                    "Too few of {samples} sampled patients have an answer.",
                    samples = findings.samples
                ),
            );
        } else {
            remark(ui, tr!("{samples} sampled patients.", samples = findings.samples));
        }
        if let Some(words) = without_answer(findings) {
            caution(ui, words);
        }
        if let Some(failure) = self.all.driver.failure() {
            caution(ui, failure);
        }
    }

    fn bands(&mut self, ui: &mut Ui, session: &Session) {
        remark(
            ui,
            tr(
                "In brackets in the cards: the range of 8 in 10 sampled patients (10th to 90th percentile).",
            ),
        );
        let [x, y] = session.scene().implant.center_mm;
        let off_centre = if x.hypot(y) > 0.0 {
            tr(
                " The dome is off centre: the lines run from the centre of the pocket to the side only.",
            )
        } else {
            ""
        };
        ui.checkbox(&mut self.is_in_picture, tr("Envelopes in the picture")).on_hover_text(tr!("Lines of the skin on the cut, or on the outline without a cut. Solid: 9 in 10 sampled patients are \
             below this line. Dashed: 1 in 10.{off_centre}", off_centre));
        if chart::quantity(ui, &mut self.explained, &self.all.findings.bands) {
            self.explain();
        }
        chart::bars(ui, &self.importance, self.all.driver.is_running());
        scenarios(ui, &self.all.findings, session.result());
    }
}

/// The samples without an answer, in words; `None` if all have one.
pub(crate) fn without_answer(findings: &Findings) -> Option<String> {
    let causes = [
        (PointStatus::NotConverged, tr("not finished")),
        (PointStatus::NoShape, tr("without a stable shape")),
        (PointStatus::Invalid, tr("beyond the limits of a plan")),
    ];
    let counts = causes.map(|(status, words)| (findings.count(status), words));
    let sum: usize = counts.iter().map(|(count, _)| count).sum();
    let list: Vec<String> = counts
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, words)| format!("{count} {words}"))
        .collect();
    (sum > 0).then(|| {
        let (of, causes) = (findings.samples, list.join(", "));
        if sum == 1 {
            tr!("1 of {of} sampled patients has no answer and is left out: {causes}.", of, causes)
        } else {
            tr!(
                "{sum} of {of} sampled patients have no answer and are left out: {causes}.",
                sum,
                of,
                causes
            )
        }
    })
}

/// The scenarios of the method of measurement, beside the bands: the figures of the plan's result, times the change of the
/// patient with all unknowns at their medians.
fn scenarios(ui: &mut Ui, findings: &Findings, result: Option<&Outcome>) {
    let factors = findings.bands.first().map_or(&[][..], |band| &band.scenarios[..]);
    if factors.is_empty() || !research::is_on(ui.ctx()) {
        return;
    }
    ui.add_space(SPACE_SMALL);
    let title = RichText::new(tr("If the measured stresses of the tissues are off")).strong();
    ui.add(egui::Label::new(title).wrap()).on_hover_text(tr(METHODS));
    egui::Grid::new("scenarios").num_columns(4).spacing([SPACE, 2.0]).show(ui, |ui| {
        ui.label(RichText::new(tr("all stresses")).small().weak());
        for Scenario { stress_factor, .. } in factors {
            ui.label(
                RichText::new(format!("× {}", localized(stress_factor.to_string()))).small().weak(),
            );
        }
        ui.end_row();
        for (quantity, name) in ANSWER {
            let Some(band) = findings.band(quantity) else { continue };
            ui.label(RichText::new(tr(name)).small());
            let own = result.and_then(|outcome| quantity.of(outcome));
            for value in changed(own, &band.scenarios) {
                ui.label(value.map_or_else(|| "–".to_owned(), |v| figure(quantity, v)));
            }
            ui.end_row();
        }
    });
    remark(
        ui,
        tr(
            "The plan's figures, times the change of the median patient. Beside the band, not in it: methods of measurement \
            differ more than people.",
        ),
    );
}

/// A value under each scenario, times its change from the scenario without a factor.
fn changed(own: Option<f64>, scenarios: &[Scenario]) -> impl Iterator<Item = Option<f64>> {
    let unchanged = scenarios.iter().find(|scenario| (scenario.stress_factor - 1.0).abs() < 1e-9);
    let unchanged = unchanged.and_then(|scenario| scenario.value).filter(|value| *value > 0.0);
    scenarios.iter().map(move |scenario| Some(own? * scenario.value? / unchanged?))
}

/// A value as in the cards.
pub(crate) fn figure(quantity: Quantity, value: f64) -> String {
    let (factor, unit) = quantity.display();
    match unit {
        "mmHg" => pressure(factor * value),
        _ => format!("{} {unit}", fixed(factor * value, usize::from(unit == "mm"))),
    }
}

/// Median and percentiles of a band, as "15 %, 11–17"; pressures as in the cards.
pub(super) fn band_in_words(quantity: Quantity, band: &Band) -> String {
    match quantity.display() {
        (factor, "mmHg") => {
            let range = pressures([band.p10, band.p90].map(|value| factor * value));
            format!("{}, {range}", pressure(factor * band.p50))
        }
        _ => localized(&*band.text),
    }
}

fn caution(ui: &mut Ui, text: String) {
    let color = theme::palette(ui.visuals()).caution;
    ui.add(egui::Label::new(RichText::new(text).small().color(color)).wrap());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_without_an_answer_are_counted_and_named() {
        let mut findings = Findings { samples: 256, ..Findings::default() };
        findings.counts.insert(PointStatus::Converged.word(), 256);
        assert_eq!(without_answer(&findings), None);
        findings.counts.insert(PointStatus::NoShape.word(), 1);
        assert_eq!(
            without_answer(&findings).as_deref(),
            Some(
                "1 of 256 sampled patients has no answer and is left out: 1 without a stable shape."
            )
        );
        findings.counts.insert(PointStatus::NoShape.word(), 2);
        findings.counts.insert(PointStatus::Invalid.word(), 1);
        assert_eq!(
            without_answer(&findings).as_deref(),
            Some(
                "3 of 256 sampled patients have no answer and are left out: 2 without a stable shape, 1 \
                 beyond the limits of a plan."
            )
        );
    }

    #[test]
    fn a_figure_has_the_digits_of_its_card() {
        assert_eq!(figure(Quantity::GreatestStrain, 0.274), "27 %");
        assert_eq!(figure(Quantity::LeastCoverMm, 7.04), "7.0 mm");
        assert_eq!(figure(Quantity::GreatestPressureMmhg, 21.6), "22 mmHg");
        assert_eq!(figure(Quantity::GreatestPressureMmhg, 100.4), "100 mmHg");
        assert_eq!(figure(Quantity::GreatestPressureMmhg, 216.0), "over 100 mmHg");
    }
}

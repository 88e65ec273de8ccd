//! A plan without an answer: what that means for the plan, and the nearest plans with an answer as buttons. The searches run
//! beside the app and end with the plan.

use crate::app::frame::studies::{Driver, Studies};
use crate::app::plan::volumes::highest_sold_ml;
use crate::app::plan::{Device, Hand};
use crate::app::texts::{self, tr};
use crate::app::widgets::quantity::format_at_most;
use crate::app::widgets::remark;
use crate::app::widgets::theme::{self, SPACE};
use crate::clinical::limits;
use crate::measure::{Status, no_shape};
use crate::scene::Scene;
use crate::session::Session;
use crate::study::{Nearest, NearestPlan, NoAnswer, Search, Study, name_in_words, size_in_words};
use eframe::egui::{self, RichText, Ui};

/// The searches of the nearest plans with an answer.
#[derive(Default)]
pub(crate) struct NearestSearch {
    /// A smaller volume or less insertion.
    driver: Driver<Nearest>,
    /// A wider base of the same volume.
    wider: Driver<Nearest>,
}

/// Has the solve of the present plan ended without a shape?
pub(crate) fn applies(session: &Session) -> bool {
    session
        .result()
        .is_some_and(|outcome| outcome.status == Status::Unstable || outcome.strain.is_none())
}

/// What the missing answer means for the plan.
pub(crate) fn words(session: &Session) -> String {
    beyond_sold(session.scene()).unwrap_or_else(|| reason(session))
}

/// That no implant of a plan's width and volume is sold, in a sentence: the solver may take long to find no answer there. `None` for a
/// size of the shelf, and for other sizes within those sold.
pub(crate) fn beyond_sold(scene: &Scene) -> Option<String> {
    let implant = &scene.implant;
    let size = implant.size().ok().filter(|_| scene.implant_reference.is_empty())?;
    let cm = |mm: f64| format_at_most(0.1 * mm, 0, 1);
    let width = 2.0 * implant.base_radius_mm;
    let (least, most) = limits::TYPICAL_WIDTH_MM;
    if !(least - 0.5..=most + 0.5).contains(&width) {
        let (least, most) = (cm(least), cm(most));
        return Some(tr!(
            "Beyond the sizes sold: these are {least} to {most} cm wide.",
            least,
            most
        ));
    }
    let volume = highest_sold_ml(implant);
    (size.volume_ml() > volume + 0.5).then(|| {
        tr!(
            "Beyond the sizes sold: the highest profile on {width} cm has {volume:.0} ml.",
            width = cm(width),
            volume
        )
    })
}

fn reason(session: &Session) -> String {
    texts::shown(&NoAnswer::of(session.scene(), session.invalid()).words(session.scene()))
}

/// Is there a shape to draw, of this plan or of the last one with an answer?
pub(crate) fn has_picture(session: &Session) -> bool {
    !session.has_no_shape() || session.last_answer().is_some()
}

/// Of which plan the picture is, without an answer to the present one; `None` without such a plan.
pub(crate) fn about_picture(session: &Session) -> Option<String> {
    let size = texts::shown(&size_in_words(&session.last_answer()?.scene));
    Some(tr!("The picture is of the last plan with an answer: {size}.", size))
}

impl NearestSearch {
    /// Starts, continues or cancels the searches, once a frame. `is_busy`: the plan is being solved or edited.
    pub(crate) fn advance(&mut self, session: &Session, studies: &mut Studies, is_busy: bool) {
        let new: [fn(&Scene) -> Nearest; 2] = [Nearest::new, Nearest::wider];
        for (driver, new) in [&mut self.driver, &mut self.wider].into_iter().zip(new) {
            let is_present = of(driver, session).is_some();
            if !is_present && driver.study().is_some() {
                driver.cancel(studies);
            }
            if !is_present && !is_busy && applies(session) {
                driver.start(new(session.scene()), studies);
            }
            driver.advance(studies);
        }
    }

    /// Have the searches ended, or has the plan an answer?
    pub(crate) fn is_at_rest(&self, session: &Session) -> bool {
        let is_done = |driver| of(driver, session).is_some_and(Study::is_done);
        !applies(session) || [&self.driver, &self.wider].into_iter().all(is_done)
    }

    /// The plans found so far.
    fn found(&self, session: &Session) -> impl Iterator<Item = &NearestPlan> {
        let searches = [&self.driver, &self.wider];
        searches.map(|driver| found(driver, session)).into_iter().flatten()
    }

    /// The card in place of those of an answer; returns the plan of its button. `largest`: see [`Self::offer`].
    pub(crate) fn card(
        &self,
        ui: &mut Ui,
        session: &Session,
        largest: Option<(Scene, String)>,
    ) -> Option<Scene> {
        let frame = egui::Frame::group(ui.style()).inner_margin(SPACE).corner_radius(8);
        let card = frame.show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.label(RichText::new(tr("No answer")).strong());
            let words = Device::of(ui.ctx()).words(&words(session));
            ui.add(egui::Label::new(words).wrap());
            let pressed = self.offer(ui, session, largest, Hand::Mouse);
            let header = egui::CollapsingHeader::new(tr("Technical details")).id_salt("no answer");
            header.show_unindented(ui, |ui| remark(ui, tr(no_shape(session.invalid()))));
            pressed
        });
        card.inner
    }

    /// The buttons of the largest plan that stays usual, of the nearest plans and of the last plan with an answer, and what is known
    /// of the searches, from a least height; returns the plan of a pressed button. `largest`: the plan and its words, if known.
    pub(crate) fn offer(
        &self,
        ui: &mut Ui,
        session: &Session,
        largest: Option<(Scene, String)>,
        hand: Hand,
    ) -> Option<Scene> {
        let height = match hand {
            Hand::Mouse => ui.spacing().interact_size.y,
            Hand::Finger => theme::TOUCH,
        };
        let searches =
            [&self.driver, &self.wider].map(|driver| of(driver, session).map(Nearest::search));
        let words = match searches {
            [None | Some(Search::Running), _] | [_, None | Some(Search::Running)] => tr(SEARCHING),
            [Some(Search::Failed), _] => {
                tr("The search for the nearest plan with an answer has failed.")
            }
            [Some(Search::Found(_)), _] | [_, Some(Search::Found(_))] => {
                tr("The nearest plans with an answer:")
            }
            _ => tr("No smaller volume, no lesser insertion and no wider base has an answer."),
        };
        // A sentence of its own: the buttons come and go below it.
        remark(ui, words);
        let line = ui.horizontal_wrapped(|ui| {
            ui.set_min_height(height);
            let palette = theme::palette(ui.visuals());
            let mut is_first = true;
            let mut is_pressed = |ui: &mut Ui, words: &str, tooltip: &str| {
                let text = RichText::new(words).strong();
                let button = if std::mem::take(&mut is_first) {
                    egui::Button::new(text.color(palette.on_accent)).fill(palette.accent)
                } else {
                    egui::Button::new(text)
                };
                let button = ui.add(button.min_size(egui::vec2(0.0, height)));
                button.on_hover_text(tooltip).clicked()
            };
            // A plan that stays usual comes before one that has an answer only just.
            let mut taken = largest
                .filter(|(_, words)| {
                    let tooltip = tr("The largest volume at this width for which no word of the cards is above usual, by a quick, coarse computation.");
                    is_pressed(ui, &tr!("Use {plan}", plan = words), tooltip)
                })
                .map(|(scene, _)| scene);
            for plan in self.found(session) {
                let tooltip = tr("The nearest plan for which a shape was found: a smaller volume in steps of 5 ml, less insertion in steps \
                     of 5 %, or a base wider in steps of 5 mm. Undo brings this plan back.");
                if is_pressed(ui, &texts::shown(&plan.words), tooltip) {
                    taken = Some(plan.scene.clone());
                }
            }
            let last = session.last_answer().map(|answer| &answer.scene);
            let back = last.filter(|scene| {
                let button = egui::Button::new(tr!("Back to {size}", size = texts::shown(&name_in_words(scene))));
                ui.add(button.min_size(egui::vec2(0.0, height)))
                    .on_hover_text(tr("The last plan with an answer"))
                    .clicked()
            });
            taken.or_else(|| back.cloned())
        });
        line.inner
    }

    /// The found plans in a sentence, for screen readers; empty without one.
    pub(crate) fn summary(&self, session: &Session) -> String {
        let words: Vec<String> =
            self.found(session).map(|plan| texts::shown(&plan.words)).collect();
        match words.as_slice() {
            [] => String::new(),
            words => {
                tr!(" Nearest plan with an answer: {plans}.", plans = words.join(tr(", or: ")))
            }
        }
    }
}

/// What is shown during the searches.
const SEARCHING: &str = "Searching for the nearest plan with an answer…";

/// The search beside the present plan; `None` for a plan with an answer.
fn of<'a>(driver: &'a Driver<Nearest>, session: &Session) -> Option<&'a Nearest> {
    let is_present = |search: &&Nearest| search.plan().is_same_plan(session.scene());
    driver.study().filter(is_present).filter(|_| applies(session))
}

/// The plan that a search has found.
fn found<'a>(driver: &'a Driver<Nearest>, session: &Session) -> Option<&'a NearestPlan> {
    match of(driver, session)?.search() {
        Search::Found(plan) => Some(plan),
        Search::Running | Search::Nothing | Search::Failed => None,
    }
}

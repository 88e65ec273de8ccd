//! A plan without an answer: what that means for the plan, and the nearest plan with an answer as a button. The search runs
//! beside the app and ends with the plan.

use super::plan::Hand;
use super::studies::{Driver, Studies};
use super::theme::SPACE;
use super::widgets::remark;
use super::{App, theme};
use crate::clinical::Dimension;
use crate::measure::{Status, no_shape};
use crate::scene::Scene;
use crate::session::{Command, Session};
use crate::study::{Nearest, NearestPlan, NoAnswer, Search, size_in_words};
use eframe::egui::{self, RichText, Ui};

/// The search of the nearest plan with an answer.
#[derive(Default)]
pub(super) struct NearestSearch {
    driver: Driver<Nearest>,
}

/// Has the solve of the present plan ended without a shape?
pub(super) fn applies(session: &Session) -> bool {
    session
        .result()
        .is_some_and(|outcome| outcome.status == Status::Unstable || outcome.strain.is_none())
}

/// What the missing answer means for the plan.
pub(super) fn words(session: &Session) -> String {
    NoAnswer::of(session.scene(), session.invalid()).words(session.scene())
}

impl NearestSearch {
    /// Starts, continues or cancels the search, once a frame. `is_busy`: the plan is being solved or edited.
    pub(super) fn advance(&mut self, session: &Session, studies: &mut Studies, is_busy: bool) {
        let is_present = self.of(session).is_some();
        if !is_present && self.driver.study().is_some() {
            self.driver.cancel(studies);
        }
        if !is_present && !is_busy && applies(session) {
            self.driver.start(Nearest::new(session.scene()), studies);
        }
        self.driver.advance(studies);
    }

    /// The search beside the present plan; `None` for a plan with an answer.
    fn of(&self, session: &Session) -> Option<&Nearest> {
        let is_present = |search: &&Nearest| search.plan() == session.scene();
        self.driver.study().filter(is_present).filter(|_| applies(session))
    }

    /// The nearest plan with an answer, if it is known.
    fn found(&self, session: &Session) -> Option<&NearestPlan> {
        match self.of(session)?.search() {
            Search::Found(plan) => Some(plan),
            Search::Running | Search::Nothing | Search::Failed => None,
        }
    }

    /// The card in place of those of an answer; returns the plan of its button.
    fn card(&self, ui: &mut Ui, session: &Session) -> Option<Scene> {
        let frame = egui::Frame::group(ui.style()).inner_margin(SPACE).corner_radius(8);
        let card = frame.show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.label(RichText::new("No answer for this plan").strong());
            ui.add(egui::Label::new(words(session)).wrap());
            let pressed = self.offer(ui, session, Hand::Mouse);
            let header = egui::CollapsingHeader::new("Technical details").id_salt("no answer");
            header.show_unindented(ui, |ui| remark(ui, no_shape(session.invalid())));
            pressed
        });
        card.inner
    }

    /// The buttons of the nearest plan and of the last plan with an answer, or what is known of the search, in a line of constant
    /// height; returns the plan of a pressed button.
    pub(super) fn offer(&self, ui: &mut Ui, session: &Session, hand: Hand) -> Option<Scene> {
        let height = match hand {
            Hand::Mouse => ui.spacing().interact_size.y,
            Hand::Finger => theme::TOUCH,
        };
        let found = self.found(session);
        let words = match self.of(session).map(Nearest::search) {
            Some(Search::Found(_)) => "the nearest plan with an answer",
            Some(Search::Nothing) => {
                "No smaller volume at this width and no lesser insertion has an answer."
            }
            Some(Search::Failed) => "The search for the nearest plan with an answer has failed.",
            Some(Search::Running) | None => "Searching for the nearest plan with an answer…",
        };
        let line = ui.horizontal_wrapped(|ui| {
            ui.set_min_height(height);
            let button = found.map(|plan| {
                let palette = theme::palette(ui.visuals());
                let text = RichText::new(&plan.words).strong().color(palette.on_accent);
                let button = egui::Button::new(text).fill(palette.accent);
                ui.add(button.min_size(egui::vec2(0.0, height))).on_hover_text(
                    "The nearest plan for which a shape was found, in steps of 5 ml at this width or of 5 % in place. \
                     Undo restores the present plan.",
                )
            });
            remark(ui, words);
            let last = session.last_answer().map(|answer| &answer.scene);
            let back = last.filter(|scene| {
                let button = egui::Button::new(format!("Back to {}", size_in_words(scene)));
                ui.add(button.min_size(egui::vec2(0.0, height)))
                    .on_hover_text("The last plan with an answer")
                    .clicked()
            });
            let nearest = found.filter(|_| button.is_some_and(|button| button.clicked()));
            nearest.map(|plan| &plan.scene).or(back)
        });
        line.inner.cloned()
    }

    /// The found plan in a sentence, for screen readers; empty without one.
    pub(super) fn summary(&self, session: &Session) -> String {
        let sentence =
            |plan: &NearestPlan| format!(" Nearest plan with an answer: {}.", plan.words);
        self.found(session).map(sentence).unwrap_or_default()
    }
}

impl App {
    /// Shows the card of a plan without an answer; false for a plan with an answer.
    pub(super) fn no_answer(&mut self, ui: &mut Ui) -> bool {
        if !applies(&self.session) {
            return false;
        }
        if let Some(scene) = self.nearest.card(ui, &self.session) {
            self.take_nearest(scene);
        }
        true
    }

    /// Takes the nearest plan with an answer. The projection follows a smaller volume.
    pub(super) fn take_nearest(&mut self, scene: Scene) {
        if scene.implant != self.session.scene().implant {
            self.plan.follows = Dimension::Projection;
        }
        self.accept(Box::new(scene));
    }

    /// Takes an offered plan, as one step of the history.
    pub(super) fn accept(&mut self, scene: Box<Scene>) {
        self.gesture += 1;
        self.is_edited = true;
        self.execute(Command::Edit { scene, gesture: self.gesture });
        self.request_frame();
    }
}

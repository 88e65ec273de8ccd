//! The answer: what happens to the tissue, as three cards, in one sentence, and in words for screen readers. The words
//! and limits of all of them are those of [`bands`].
//!
//! `figures` (of the answer, with their words) | `cards` (figures and words of the cards) | `shares` (sampled patients by word), `bar` (their bars without a toolkit), `draw` (the cards on
//! the screen) | `columns` (lines of cells) | `measured` (her body's measures, computed once a shape), `before_after` (their table) | `times` (the plan on the table and later).

mod bar;
pub(crate) mod before_after;
mod cards;
mod columns;
pub(crate) mod compare;
pub(crate) mod details;
pub(crate) mod differing;
mod draw;
mod figures;
pub(crate) mod fill_steps;
pub(crate) mod filling;
pub(crate) mod measured;
pub(crate) mod no_answer;
pub(crate) mod plots;
pub(crate) mod practice;
mod shares;
pub(crate) mod stability;
pub(crate) mod times;
pub(crate) mod uncertainty;

pub(super) use bar::Bar;
pub(super) use draw::band_color;

use crate::app::frame::action::Action;
use crate::app::frame::status::Pending;
use crate::app::plan::device::Device;
use crate::app::plan::{side_in_a_word, when};
use crate::app::texts::{self, tr, word_of};
use crate::app::widgets::theme::{self, SPACE};
use crate::app::widgets::{kept_lines, remark};
use crate::clinical::When;
use crate::measure::bands::{self, Limits, SkinLimits};
use crate::measure::{Outcome, Status};
use crate::scene::Scene;
use crate::session::Session;
use crate::springs::Springs;
use crate::study::{implant_in_words, volume_and_width};
use cards::{Card, cards};
use draw::show_card;
use eframe::egui::{self, RichText, Ui};
use figures::Answer;
use practice::Practices;
use uncertainty::Findings;

/// Results of the previous scene during a solve: shown during a short one, hidden during a long one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PreviousResults {
    Shown,
    Hidden,
}

/// The result to show. During a short solve the previous result stays visible. During a long one (`previous`) only
/// a provisional result of the present scene close to its equilibrium is shown.
pub(super) fn visible(session: &Session, previous: PreviousResults) -> Option<&Outcome> {
    let is_near = session.is_outcome_present() && session.scene().springs == Springs::Coupled;
    let outcome = session.outcome().filter(|_| is_near || previous == PreviousResults::Shown);
    outcome.filter(|_| !session.is_stopped())
}

/// The plan of the figures to show: that of the visible result.
fn visible_plan(session: &Session, previous: PreviousResults) -> &Scene {
    match visible(session, previous) {
        Some(_) => session.outcome_scene(),
        None => session.scene(),
    }
}

fn answer(session: &Session, practices: &Practices, previous: PreviousResults) -> Answer {
    let plan = visible_plan(session, previous);
    Answer::new(visible(session, previous), plan, session.problem(), practices)
}

/// The side whose values are shown; `None` where both sides have one plan.
fn side_of_answer(session: &Session) -> Option<&'static str> {
    session.other_side().map(|_| side_in_a_word(session.scene()))
}

/// A name with the side whose values are shown, as "What happens · right"; the name alone where both sides have one plan.
pub(super) fn with_side(name: &str, session: &Session) -> String {
    side_of_answer(session).map_or_else(|| name.to_owned(), |side| format!("{name} · {side}"))
}

/// Shows the heading with the state of the computation.
pub(super) fn heading(ui: &mut Ui, session: &Session) {
    ui.horizontal(|ui| {
        ui.heading(tr("What happens"));
        if let Some(side) = side_of_answer(session) {
            ui.heading(format!("· {side}"));
        }
        if session.is_working() {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(tr("Updating…")).color(ui.visuals().weak_text_color()));
            });
        }
    });
    if session.is_stopped() {
        ui.label(RichText::new(tr("Not computed.")).color(ui.visuals().weak_text_color()));
    }
    if let Some(time) = when::in_words(session.scene()) {
        remark(ui, tr!("Skin: {time}", time));
    }
}

/// Shows the three cards, with bands if there are `findings`, and warnings, that of the model's end (`near_end`) first. Further
/// sections of the answer (sources, Uncertainty, Compare) follow below.
pub(super) fn show(
    ui: &mut Ui,
    (session, practices): (&Session, &Practices),
    previous: PreviousResults,
    findings: Option<&Findings>,
    near_end: &str,
) {
    let answer = answer(session, practices, previous);
    for card in cards(&answer, findings) {
        show_card(ui, &card, findings);
    }
    if !near_end.is_empty() {
        let words = RichText::new(format!("! {near_end}")).small();
        ui.add(egui::Label::new(words.color(theme::palette(ui.visuals()).caution)).wrap());
    }
    warnings(ui, session.result());
}

/// Lines of the other side's answer on a phone.
const OTHER_SIDE: usize = 2;

/// Shows the three figures in one row, for a phone; below them the other side's answer where it has a plan of its own.
pub(super) fn show_short(
    ui: &mut Ui,
    (session, practices): (&Session, &Practices),
    previous: PreviousResults,
    findings: Option<&Findings>,
) {
    let answer = answer(session, practices, previous);
    ui.columns_const(|columns: &mut [Ui; 3]| {
        for (ui, card) in columns.iter_mut().zip(cards(&answer, findings)) {
            ui.spacing_mut().item_spacing.y = 0.0;
            let (name, figure) = card.short;
            let quiet = ui.visuals().weak_text_color();
            ui.label(RichText::new(named_range(ui, name, &card.brackets)).small().color(quiet));
            ui.label(RichText::new(figure).strong());
            let (word, color) = match card.verdict {
                Some((band, word)) => (word, band_color(ui, band)),
                None if card.value.is_some() => (card.no_verdict, quiet),
                None => ("", quiet),
            };
            ui.label(RichText::new(word).small().color(color));
        }
    });
    if let Some(words) = other_side_in_words(session, practices) {
        kept_lines(ui, OTHER_SIDE, |ui| remark(ui, words));
    }
}

/// The name of a figure with the range of the sampled patients, where both stand in one line.
fn named_range(ui: &Ui, name: &str, brackets: &str) -> String {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let whole = format!("{name} {brackets}").trim_end().to_owned();
    let width = ui.painter().layout_no_wrap(whole.clone(), font, egui::Color32::WHITE).size().x;
    if width <= ui.available_width() { whole } else { name.to_owned() }
}

/// The cards of a device in words: title, figure, word, further line.
pub(super) fn rows(
    (session, practices): (&Session, &Practices),
    device: Device,
    findings: Option<&Findings>,
) -> Vec<[String; 4]> {
    let answer = answer(session, practices, PreviousResults::Shown);
    cards(&answer, findings).iter().map(|card| row(card, device)).collect()
}

/// The cards of the other side in words with their bars; `None` where both sides have one plan, or the other one has no answer.
pub(super) fn cards_of_other_side(
    (session, practices): (&Session, &Practices),
    device: Device,
) -> Option<Vec<([String; 4], Bar)>> {
    let answer = answer_of_other_side(session, practices).filter(|of| of.strain.is_some())?;
    let cards = cards(&answer, None);
    Some(cards.iter().map(|card| (row(card, device), Bar::of(card))).collect())
}

/// A card of a device in words: title, figure, word, further line.
fn row(card: &Card, device: Device) -> [String; 4] {
    let word = card.verdict.map_or(card.no_verdict, |(_, word)| word);
    let line = device.words(&card.line);
    let line = match &card.shares {
        Some(shares) => format!("{shares}. {line}").trim_end().to_owned(),
        None => line,
    };
    [device.words(card.title), card.in_a_line(), word.to_owned(), line]
}

/// The numbers of sampled patients by the words of the cards of a device, in a sentence for each card, for screen readers.
pub(super) fn shares_in_words(
    (session, practices): (&Session, &Practices),
    device: Device,
    findings: Option<&Findings>,
) -> String {
    let sentence = |card: &Card| {
        let mut shares = card.shares.as_ref()?.chars();
        let first = shares.next()?.to_lowercase();
        Some(format!(" {}: {first}{}.", device.words(card.title), shares.as_str()))
    };
    let cards = cards(&answer(session, practices, PreviousResults::Shown), findings);
    cards.iter().filter_map(sentence).collect()
}

/// The numbers of sampled patients by the words of the pressure, as they stand in a line; `None` without patients.
pub(super) fn shares_of_pressure(
    (session, practices): (&Session, &Practices),
    findings: Option<&Findings>,
) -> Option<String> {
    let [_, _, pressure] = cards(&answer(session, practices, PreviousResults::Shown), findings);
    let shares = pressure.shares?;
    let mut signs = shares.chars();
    Some(signs.next()?.to_lowercase().chain(signs).collect())
}

/// The bars of the cards, in the order of [`rows`].
pub(super) fn bars(
    (session, practices): (&Session, &Practices),
    findings: Option<&Findings>,
) -> [Bar; 3] {
    let cards = cards(&answer(session, practices, PreviousResults::Shown), findings);
    cards.each_ref().map(Bar::of)
}

/// Shows warnings, which apply to all numbers.
fn warnings(ui: &mut Ui, outcome: Option<&Outcome>) {
    let palette = theme::palette(ui.visuals());
    let Some(outcome) = outcome else { return };
    if outcome.status == Status::NotConverged {
        let words = RichText::new(tr("! Not finished: do not use these numbers.")).strong();
        ui.add(egui::Label::new(words.color(palette.bad)).wrap());
    }
    for warning in &outcome.warnings {
        let warning = Device::of(ui.ctx()).warning(&texts::shown(warning));
        let words = RichText::new(format!("! {warning}")).small().color(palette.caution);
        ui.add(egui::Label::new(words).wrap());
    }
}

/// The limits of a quantity with their sources, one per line, and what a reader must know about them.
fn text_of(limits: &Limits) -> String {
    let sources = limits.bands.iter().map(|band| band.source).filter(|source| !source.is_empty());
    sources.chain([limits.note]).map(tr).collect::<Vec<_>>().join("\n")
}

/// The limits of a session's plan on a device with their sources, as headings with texts: those of the cards only. `rule`: practice's
/// rule in words.
pub(super) fn limits_in_words(
    session: &Session,
    practices: &Practices,
    device: Device,
    rule: fn(&Practices, &Scene) -> String,
) -> [(&'static str, String); 3] {
    let scene = session.scene();
    let skin = practices.skin(scene, session.problem().skin_knee());
    let of_skin = match skin {
        SkinLimits::Reserve(knee) => tr!(
            "For the skin of this plan: 80 % is a stretch of {usual:.0} %, 100 % one of {high:.0} %.\n",
            usual = 80.0 * knee,
            high = 100.0 * knee
        ),
        SkinLimits::Practice(_) | SkinLimits::Tearing => String::new(),
    };
    let rule = rule(practices, scene);
    let stretch = format!("{rule}{of_skin}{}", text_of(&skin.limits().0));
    let texts = [
        (tr("Skin stretch"), stretch),
        (tr("Cover over implant"), tr(bands::COVER).to_owned()),
        (tr("Pressure on the tissue"), text_of(&bands::PRESSURE)),
    ];
    texts.map(|(heading, text)| (heading, device.words(&text)))
}

/// The fold with the sources of the limits.
pub(super) fn sources(
    ui: &mut Ui,
    session: &Session,
    practices: &mut Practices,
    actions: &mut Vec<Action>,
) {
    egui::CollapsingHeader::new(tr("Where limits come from")).id_salt("sources").show_unindented(
        ui,
        |ui| {
            let device = Device::of(ui.ctx());
            for (heading, text) in limits_in_words(session, practices, device, practice::rule) {
                ui.label(RichText::new(device.words(heading)).small().strong());
                ui.label(RichText::new(text).small());
            }
            practices.table_buttons(ui, actions);
            if session.scene().when() == Some(When::OnTheTable) {
                let words = tr("Right after surgery. With tissue expanders about a third of such a gain of skin \
                     remained.");
                ui.label(RichText::new(words).small());
            }
            ui.add_space(SPACE);
        },
    );
}

/// The answer in one line with its worst word, that of the cards, as "300 ml, 12 cm: usual. Stretch 14 %, cover 7.2 mm, pressure 13 mmHg."
pub(super) fn headline(
    session: &Session,
    practices: &Practices,
    previous: PreviousResults,
) -> String {
    // Size and figures are those of one plan.
    let plan = visible_plan(session, previous);
    let answer = answer(session, practices, previous);
    let words = match answer.strain {
        None if session.is_working() => match no_answer::beyond_sold(plan) {
            Some(words) => format!("{} {words}", tr("updating…")),
            None => tr("updating…").to_owned(),
        },
        None if no_answer::applies(session) => tr("no answer.").to_owned(),
        None => tr("no result.").to_owned(),
        Some(_) => answer.in_a_sentence(),
    };
    let sentence = in_a_line(plan, &words);
    match other_side_in_words(session, practices) {
        Some(other) => format!("{}: {sentence} {other}", side_in_a_word(plan)),
        None => sentence,
    }
}

/// The size of a plan before the words of its answer.
fn in_a_line(plan: &Scene, words: &str) -> String {
    let [_, width] = volume_and_width(plan);
    let implant = implant_in_words(plan);
    let part = match plan.insertion {
        full if full >= 1.0 => String::new(),
        part => tr!(", {part:.0} % in place", part = 100.0 * part),
    };
    let time = when::in_words(plan).map_or_else(String::new, |time| format!(", {time}"));
    format!("{implant}, {} cm{part}{time}: {words}", texts::localized(width))
}

/// The answer of the other side, where each side has a plan of its own.
fn answer_of_other_side(session: &Session, practices: &Practices) -> Option<Answer> {
    let other = session.other_side()?;
    let problem = other.fields().map_or(session.problem(), |fields| fields.solution().problem());
    Some(Answer::new(other.outcome(), other.scene(), problem, practices))
}

/// The other side's plan with its answer in a sentence, where each side has a plan of its own.
pub(super) fn other_side_in_words(session: &Session, practices: &Practices) -> Option<String> {
    let (other, answer) = session.other_side().zip(answer_of_other_side(session, practices))?;
    let (scene, outcome) = (other.scene(), other.outcome());
    let words = match (outcome, answer.strain) {
        (None, _) => tr("updating…").to_owned(),
        (Some(_), None) => tr("no answer.").to_owned(),
        (Some(_), Some(_)) => answer.in_a_sentence(),
    };
    Some(format!("{}: {}", side_in_a_word(scene), in_a_line(scene, &words)))
}

/// What stands in place of the answer for screen readers from an edit on.
pub(super) fn updating() -> &'static str {
    tr("Updating.")
}

/// The answer of a device in a few sentences, for screen readers. `pending`: what is computed beside the figures.
pub(super) fn summary(
    session: &Session,
    practices: &Practices,
    device: Device,
    pending: Option<Pending>,
) -> String {
    if session.is_stopped() {
        return tr("Stopped: this plan has not been computed.").to_owned();
    }
    let Some(outcome) = session.result() else {
        let beyond = no_answer::beyond_sold(session.scene());
        let beyond = beyond.map_or_else(String::new, |words| format!(" {words}"));
        return format!("{}{beyond}", updating());
    };
    let state = match outcome.status {
        Status::Unstable => {
            return tr!("No answer. {reason}", reason = device.words(&no_answer::words(session)));
        }
        Status::NotConverged => tr("Not finished: do not use these numbers."),
        Status::Converged => pending.map_or_else(|| tr("Up to date."), Pending::sentence),
    };
    let [_, width] = volume_and_width(session.scene()).map(texts::localized);
    let answer = Answer::new(Some(outcome), session.scene(), session.problem(), practices);
    let word = answer.stretch().map_or_else(String::new, |(_, word)| format!(", {word}"));
    let strain = answer.strain.map_or_else(String::new, |strain| {
        tr!(" Skin stretch {strain:.0} percent{word}.", strain = 100.0 * strain, word)
    });
    let at_once = if answer.is_filled_at_once() { tr(" If filled at once:") } else { "" };
    let thin = answer.cover_word().map_or_else(String::new, |(_, word)| format!(", {word}"));
    let cover = answer.cover.map_or_else(String::new, |cover| {
        tr!(" Cover {cover:.1} mm{thin}, at rest {rest:.1} mm.", cover, rest = answer.rest, thin)
    });
    let pressure = answer.pressure.map_or_else(String::new, |(mean, most)| {
        let word = word_of(&bands::PRESSURE, bands::pressure_word(most));
        tr!(
            " Pressure {mean} on average, at most {most}, {word}.",
            mean = texts::pressure(mean),
            most = texts::pressure(most),
            word
        )
    });
    let warnings = outcome
        .warnings
        .iter()
        .map(|warning| format!(" {}", device.warning(&texts::shown(warning))));
    let warnings: String = warnings.collect();
    let name = device.words(tr("implant"));
    let wide = if session.scene().implant.is_round() {
        tr!("{width} cm wide", width)
    } else {
        tr!("{width} cm wide and high", width)
    };
    let wide = match when::in_words(session.scene()) {
        Some(time) => format!("{wide}, {time}"),
        None => wide,
    };
    tr!(
        "{size} {name}, {wide}.{at_once}{strain}{cover}{pressure} {state}{warnings}",
        size = implant_in_words(session.scene()),
        name,
        wide,
        at_once,
        strain,
        cover,
        pressure,
        state,
        warnings
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::TissueModel;

    #[test]
    fn the_limits_in_words_are_those_of_the_cards() {
        let mut scene = Scene::opening();
        let words = |scene: &Scene| {
            let session = Session::new(scene.clone()).unwrap();
            limits_in_words(&session, &Practices::default(), Device::Implant, practice::rule)
        };
        let [(heading, stretch), (_, cover), (_, pressure)] = words(&scene);
        let knee = 100.0 * scene.skin_knee().unwrap();
        assert_eq!(heading, "Skin stretch");
        let own = format!("80 % is a stretch of {:.0} %, 100 % one of {knee:.0} %.", 0.8 * knee);
        assert!(stretch.contains(&own) && !stretch.contains("25 %"), "{stretch}");
        assert!(cover.contains("5 mm") && pressure.contains("60–80 mmHg"), "{cover} {pressure}");
        // A sheet has no reserve.
        scene.set_tissue_model(TissueModel::Sheet);
        let [(_, stretch), ..] = words(&scene);
        assert!(stretch.contains("25 %") && !stretch.contains("reserve"), "{stretch}");
    }
}

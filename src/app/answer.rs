//! The answer: what happens to the tissue, as three cards, in one sentence, and in words for screen readers. The words
//! and limits of all of them are those of [`bands`].

use super::no_answer;
use super::theme::{self, SPACE, SPACE_SMALL};
use super::uncertainty::Findings;
use crate::clinical::Size;
use crate::measure::bands::{self, Limits};
use crate::measure::{Outcome, STRAIN_BANDS, Status};
use crate::scene::Scene;
use crate::session::Session;
use crate::springs::Springs;
use crate::study::{Band, Quantity};
use crate::view::color;
use eframe::egui::{
    self, Align2, Color32, Rect, RichText, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, pos2,
    vec2,
};

/// Strain above which the share of the skin is shown \[-\], and its key in the result.
const SHARE_ABOVE: (f64, &str) = (STRAIN_BANDS[0], "0.25");
/// Greatest values of the bars: strain \[-\], pressure \[mmHg\].
const MOST_STRAIN: f64 = 0.8;
const MOST_PRESSURE: f64 = 100.0;

/// What the strains of the model leave out, beside its limits.
const ALREADY_STRAINED: &str = "Standing, breast skin carries strain already.";

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

/// The three figures of the answer.
struct Answer {
    /// Greatest strain of the skin \[-\].
    strain: Option<f64>,
    /// Fraction of the skin above [`SHARE_ABOVE`] \[-\].
    share: f64,
    /// Least thickness over the implant \[mm\].
    cover: Option<f64>,
    /// Thickness over the implant's highest point \[mm\].
    apex: Option<f64>,
    /// Thickness at rest \[mm\].
    rest: f64,
    /// Does the tissue have a cover, or is it one sheet?
    is_layered: bool,
    /// Mean and greatest contact pressure \[mmHg\].
    pressure: Option<(f64, f64)>,
}

impl Answer {
    fn new(outcome: Option<&Outcome>, scene: &Scene) -> Self {
        let strain = outcome.and_then(|outcome| outcome.strain.as_ref());
        let share = strain.and_then(|s| s.fraction_above.get(SHARE_ABOVE.1)).copied();
        let cover = outcome.and_then(|outcome| outcome.cover_mm);
        Self {
            strain: strain.map(|strain| strain.max_principal.max(0.0)),
            share: share.unwrap_or(0.0),
            cover: cover.map(|cover| cover.least),
            apex: cover.map(|cover| cover.apex),
            is_layered: scene.is_layered(),
            rest: scene.layers.iter().map(|layer| layer.thickness_mm).sum(),
            pressure: outcome.and_then(|o| o.contact_pressure_mmhg).map(|p| (p.mean, p.max)),
        }
    }
}

/// Words and figures of a card.
struct Card {
    title: &'static str,
    /// The figure with its unit.
    figure: String,
    /// Words beside the figure.
    beside: String,
    /// Short name and figure for the phone's row.
    short: (&'static str, String),
    /// Band and word; `None` without limits or value.
    verdict: Option<(usize, &'static str)>,
    /// What stands in place of a word without limits.
    no_verdict: &'static str,
    line: String,
    value: Option<f64>,
    /// 10th and 90th percentile around the value.
    range: Option<[f64; 2]>,
    scale: BarScale,
}

impl Card {
    /// Puts the band of the card's quantity in place of the plan's own figure.
    fn with_band(mut self, band: Option<&Band>) -> Self {
        let Some(band) = band else { return self };
        let own = std::mem::replace(&mut self.figure, band.text.clone());
        // The cover of sampled patients may be thicker than the plan's.
        if let BarScale::Part { .. } = self.scale {
            self.beside = "at least".to_owned();
        }
        self.short.1.clone_from(&self.figure);
        (self.value, self.range) = (Some(band.p50), Some([band.p10, band.p90]));
        let mut line = format!("this plan itself: {own}. {}", self.line);
        if let BarScale::Bands { limits, .. } = self.scale {
            self.verdict = Some((limits.band(band.p50), limits.word(band.p50)));
            let [low, high] = [band.p10, band.p90].map(|value| limits.word(value));
            if low != high {
                line = format!("{low} to {high}; {line}");
            }
        }
        self.line = line;
        self
    }
}

/// The scale of a card's bar.
#[derive(Clone, Copy)]
enum BarScale {
    /// Bands of limits, up to a value.
    Bands { limits: &'static Limits, most: f64, in_percent: bool },
    /// A part of a whole.
    Part { whole: f64 },
}

/// The cards of an answer, with the bands of `findings` in place of single figures.
fn cards(answer: &Answer, findings: Option<&Findings>) -> [Card; 3] {
    let band_of = |quantity: Quantity| findings.and_then(|findings| findings.band(quantity));
    // A figure of a line, as "12 % (4–31)".
    let in_line = |quantity: Quantity, decimals: usize, own: f64| {
        let (factor, unit) = quantity.display();
        match band_of(quantity) {
            Some(band) => format!("{:.decimals$} {unit} ({})", factor * band.p50, band.range()),
            None => format!("{:.decimals$} {unit}", factor * own),
        }
    };
    let dash = || "–".to_owned();
    let with = |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or_else(dash, text);
    let band = |value: Option<f64>, limits: &'static Limits| {
        value.map(|value| (limits.band(value), limits.word(value)))
    };
    let percent = with(answer.strain, &|v| format!("{:.0} %", 100.0 * v));
    let cover = with(answer.cover, &|v| format!("{v:.1} mm"));
    let most = answer.pressure.map(|(_, most)| most);
    let pressure = with(most, &|v| format!("{v:.0} mmHg"));
    [
        Card {
            title: "Skin stretch",
            short: ("Stretch", percent.clone()),
            figure: percent,
            beside: "longer, at most".to_owned(),
            verdict: band(answer.strain, &bands::STRAIN),
            no_verdict: "",
            line: answer.strain.map_or_else(String::new, |_| {
                let share = in_line(Quantity::AreaOver25, 0, answer.share);
                format!(
                    "{share} of the skin is above {:.0} %. {ALREADY_STRAINED}",
                    100.0 * SHARE_ABOVE.0
                )
            }),
            value: answer.strain,
            range: None,
            scale: BarScale::Bands { limits: &bands::STRAIN, most: MOST_STRAIN, in_percent: true },
        }
        .with_band(band_of(Quantity::GreatestStrain)),
        Card {
            title: "Cover over implant",
            short: ("Cover", with(answer.cover, &|v| format!("{v:.0} mm"))),
            figure: cover,
            beside: format!("of {:.1} mm, at least", answer.rest),
            verdict: None,
            no_verdict: "no published limit",
            line: match answer.apex {
                Some(apex) => format!("{} at the top", in_line(Quantity::ApexCoverMm, 1, apex)),
                None if answer.is_layered => String::new(),
                None => "needs “Skin on solid layers” (Advanced)".to_owned(),
            },
            value: answer.cover,
            range: None,
            scale: BarScale::Part { whole: answer.rest },
        }
        .with_band(band_of(Quantity::LeastCoverMm)),
        Card {
            title: "Pressure on the tissue",
            short: ("Pressure", pressure.clone()),
            figure: pressure,
            beside: "at most".to_owned(),
            verdict: band(most, &bands::PRESSURE),
            no_verdict: "",
            line: answer.pressure.map_or_else(String::new, |(mean, _)| {
                format!("{} on average", in_line(Quantity::MeanPressureMmhg, 0, mean))
            }),
            value: most,
            range: None,
            scale: BarScale::Bands {
                limits: &bands::PRESSURE,
                most: MOST_PRESSURE,
                in_percent: false,
            },
        }
        .with_band(band_of(Quantity::GreatestPressureMmhg)),
    ]
}

/// Shows the heading with the state of the computation.
pub(super) fn heading(ui: &mut Ui, session: &Session) {
    ui.add_space(SPACE_SMALL);
    ui.horizontal(|ui| {
        ui.heading("What happens");
        if session.is_working() {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new("Updating…").color(ui.visuals().weak_text_color()));
            });
        }
    });
    if session.is_stopped() {
        ui.label(RichText::new("Not computed.").color(ui.visuals().weak_text_color()));
    }
}

/// Shows the three cards, with bands if there are `findings`, and warnings. Further sections of the answer (sources,
/// Uncertainty, Compare) follow below.
pub(super) fn show(
    ui: &mut Ui,
    session: &Session,
    previous: PreviousResults,
    findings: Option<&Findings>,
) {
    let answer = Answer::new(visible(session, previous), session.scene());
    for card in cards(&answer, findings) {
        show_card(ui, &card, findings);
    }
    warnings(ui, session.result());
}

/// Shows the three figures in one row, for a phone.
pub(super) fn show_short(
    ui: &mut Ui,
    session: &Session,
    previous: PreviousResults,
    findings: Option<&Findings>,
) {
    let answer = Answer::new(visible(session, previous), session.scene());
    ui.columns_const(|columns: &mut [Ui; 3]| {
        for (ui, card) in columns.iter_mut().zip(cards(&answer, findings)) {
            ui.spacing_mut().item_spacing.y = 0.0;
            let (name, figure) = card.short;
            let quiet = ui.visuals().weak_text_color();
            ui.label(RichText::new(name).small().color(quiet));
            ui.label(RichText::new(figure).strong());
            let (word, color) = match card.verdict {
                Some((band, word)) => (word, band_color(ui, band)),
                None if card.value.is_some() => (card.no_verdict, quiet),
                None => ("", quiet),
            };
            ui.label(RichText::new(word).small().color(color));
        }
    });
}

fn show_card(ui: &mut Ui, card: &Card, findings: Option<&Findings>) {
    let frame = egui::Frame::group(ui.style()).inner_margin(SPACE).corner_radius(8);
    let response = frame
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.horizontal(|ui| {
                ui.label(RichText::new(card.title).strong());
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    verdict(ui, card);
                });
            });
            ui.horizontal(|ui| {
                ui.label(RichText::new(&card.figure).size(theme::FIGURE));
                let beside = RichText::new(&card.beside).color(ui.visuals().weak_text_color());
                ui.add(egui::Label::new(beside).truncate());
            });
            bar(ui, card);
            let line = RichText::new(&card.line).small().color(ui.visuals().weak_text_color());
            ui.add(egui::Label::new(line).wrap());
        })
        .response;
    let mut tooltip = match card.scale {
        BarScale::Bands { limits, .. } => text_of(limits),
        BarScale::Part { .. } => NO_LIMIT.to_owned(),
    };
    if let Some(findings) = findings.filter(|_| card.range.is_some()) {
        let count = findings.answers();
        tooltip = format!(
            "Median, then 10th to 90th percentile, of {count} sampled patients. The word is the median's; the bar \
             has a line over the range.\n{tooltip}"
        );
    }
    response.on_hover_text(tooltip);
}

/// What is known about a limit of the cover.
const NO_LIMIT: &str = "Least thickness of skin and fat over the implant. No published limit was found: the number has no \
                        word.";

/// Shows the word of a band with its level, as one to four strokes: colour is not the only sign.
fn verdict(ui: &mut Ui, card: &Card) {
    let Some((band, word)) = card.verdict else {
        let words = if card.value.is_some() { card.no_verdict } else { "" };
        ui.label(RichText::new(words).small().color(ui.visuals().weak_text_color()));
        return;
    };
    let color = band_color(ui, band);
    ui.label(RichText::new(word).strong().color(color));
    let (rect, _) = ui.allocate_exact_size(vec2(18.0, 14.0), Sense::hover());
    for k in 0..4 {
        let at = rect.left() + 5.0 * k as f32;
        let height = 5.0 + 3.0 * k as f32;
        let stroke =
            Rect::from_min_max(pos2(at, rect.bottom() - height), pos2(at + 3.0, rect.bottom()));
        if k <= band {
            ui.painter().rect_filled(stroke, 1.0, color);
        } else {
            let line = Stroke::new(1.0, theme::palette(ui.visuals()).edge);
            ui.painter().rect_stroke(stroke, 1.0, line, StrokeKind::Inside);
        }
    }
}

/// Draws the bar of a card: bands in their colours with their limits, or the part of a whole, and the value's mark.
fn bar(ui: &mut Ui, card: &Card) {
    let is_banded = matches!(card.scale, BarScale::Bands { .. });
    let size = vec2(ui.available_width(), if is_banded { 28.0 } else { 17.0 });
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let bar = Rect::from_min_size(rect.min + vec2(0.0, 7.0), vec2(rect.width(), 8.0));
    let (palette, painter) = (theme::palette(ui.visuals()), ui.painter());
    let quiet = ui.visuals().weak_text_color();
    let font = TextStyle::Small.resolve(ui.style());
    let outline = Stroke::new(1.0, palette.edge);
    let most = match card.scale {
        BarScale::Bands { most, .. } => most,
        BarScale::Part { whole } => whole.max(1e-9),
    };
    let at = |value: f64| bar.left() + bar.width() * (value / most).clamp(0.0, 1.0) as f32;
    match card.scale {
        BarScale::Bands { limits, most, in_percent } => {
            let mut from = 0.0;
            let mut free = f32::NEG_INFINITY;
            for (k, band) in limits.bands.iter().enumerate() {
                let to = band.limit.unwrap_or(most);
                let part = Rect::from_x_y_ranges(at(from)..=at(to), bar.y_range());
                painter.rect_filled(part, 0.0, rgb(color::band(k)));
                from = to;
                let Some(limit) = band.limit else { continue };
                painter.vline(at(limit), bar.y_range(), Stroke::new(1.0, ui.visuals().panel_fill));
                let text = if in_percent {
                    format!("{:.0} %", 100.0 * limit)
                } else {
                    format!("{limit:.0}")
                };
                let galley = painter.layout_no_wrap(text, font.clone(), quiet);
                let left = at(limit) - 0.5 * galley.size().x;
                // The next limit may be too close for its number.
                if left > free {
                    free = left + galley.size().x + 4.0;
                    painter.galley(pos2(left, bar.bottom() + 1.0), galley, quiet);
                }
            }
            if !in_percent {
                let end = pos2(bar.right(), bar.bottom() + 1.0);
                painter.text(end, Align2::RIGHT_TOP, limits.unit, font, quiet);
            }
        }
        BarScale::Part { .. } => {
            painter.rect_filled(bar, 0.0, ui.visuals().extreme_bg_color);
            if let Some(value) = card.value {
                painter.rect_filled(bar.with_max_x(at(value)), 0.0, rgb(color::COVER));
            }
        }
    }
    painter.rect_stroke(bar, 1.0, outline, StrokeKind::Outside);
    if let Some([low, high]) = card.range {
        let line = Stroke::new(2.5, palette.text);
        painter.hline(at(low)..=at(high), bar.top() - 4.0, line);
    }
    if let Some(value) = card.value {
        let (x, top) = (at(value), bar.top());
        let mark = vec![pos2(x, top + 3.0), pos2(x - 5.0, top - 6.0), pos2(x + 5.0, top - 6.0)];
        let line = Stroke::new(1.0, ui.visuals().panel_fill);
        painter.add(Shape::convex_polygon(mark, palette.text, line));
    }
}

fn rgb(color: color::Rgb) -> Color32 {
    let [r, g, b] = color.map(|v| (255.0 * v.clamp(0.0, 1.0)).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// Colour of the words of a band, counted from the lowest.
pub(super) fn band_color(ui: &Ui, band: usize) -> Color32 {
    let palette = theme::palette(ui.visuals());
    [palette.text, palette.caution, palette.bad, palette.bad][band.min(3)]
}

/// The cards in words: title, figure, word, further line.
pub(super) fn rows(session: &Session, findings: Option<&Findings>) -> Vec<[String; 4]> {
    let outcome = visible(session, PreviousResults::Shown);
    let cards = cards(&Answer::new(outcome, session.scene()), findings);
    let row = |card: Card| {
        let word = card.verdict.map_or(card.no_verdict, |(_, word)| word);
        [
            card.title.to_owned(),
            format!("{} {}", card.figure, card.beside),
            word.to_owned(),
            card.line,
        ]
    };
    cards.into_iter().map(row).collect()
}

/// Shows warnings, which apply to all numbers.
fn warnings(ui: &mut Ui, outcome: Option<&Outcome>) {
    let palette = theme::palette(ui.visuals());
    let Some(outcome) = outcome else { return };
    if outcome.status == Status::NotConverged {
        let words = RichText::new("! Not finished: do not use these numbers.").strong();
        ui.add(egui::Label::new(words.color(palette.bad)).wrap());
    }
    for warning in &outcome.warnings {
        let words = RichText::new(format!("! {warning}")).small().color(palette.caution);
        ui.add(egui::Label::new(words).wrap());
    }
}

/// The limits of a quantity with their sources, one per line, and what a reader must know about them.
pub(super) fn text_of(limits: &Limits) -> String {
    let sources = limits.bands.iter().map(|band| band.source).filter(|source| !source.is_empty());
    sources.chain([limits.note]).collect::<Vec<_>>().join("\n")
}

/// The fold with the sources of all limits.
pub(super) fn sources(ui: &mut Ui) {
    egui::CollapsingHeader::new("Where limits come from").id_salt("sources").show_unindented(
        ui,
        |ui| {
            for limits in bands::LIMITS {
                ui.label(RichText::new(text_of(limits)).small());
            }
            ui.label(RichText::new(NO_LIMIT).small());
            ui.label(
                RichText::new(
                    "Right after surgery. With tissue expanders about a third of such a gain of skin \
                     remained.",
                )
                .small(),
            );
            ui.add_space(SPACE);
        },
    );
}

/// The implant in a few words, as "300 ml, 12 cm".
fn implant(scene: &Scene) -> (String, String) {
    let implant = &scene.implant;
    let volume = implant.size().map_or(0.0, Size::volume_ml);
    let width = format!("{:.1}", 0.2 * implant.base_radius_mm);
    let width = width.trim_end_matches(".0").to_owned();
    (format!("{volume:.0}"), width)
}

/// The answer in one sentence, as "300 ml, 12 cm: skin stretch usual, cover 7 mm."
pub(super) fn headline(session: &Session, previous: PreviousResults) -> String {
    let (volume, width) = implant(session.scene());
    let part = match session.scene().insertion {
        full if full >= 1.0 => String::new(),
        part => format!(", {:.0} % in place", 100.0 * part),
    };
    let answer = Answer::new(visible(session, previous), session.scene());
    let words = match answer.strain {
        None if session.is_working() => "updating…".to_owned(),
        None if no_answer::applies(session) => "no answer.".to_owned(),
        None => "no result.".to_owned(),
        Some(strain) => {
            let cover = answer.cover.map_or_else(String::new, |mm| format!(", cover {mm:.0} mm"));
            format!("skin stretch {}{cover}.", bands::strain_word(strain))
        }
    };
    format!("{volume} ml, {width} cm{part}: {words}")
}

/// The answer in a few sentences, for screen readers.
pub(super) fn summary(session: &Session) -> String {
    if session.is_stopped() {
        return "Stopped: this plan has not been computed.".to_owned();
    }
    let Some(outcome) = session.result() else {
        return "Updating.".to_owned();
    };
    let state = match outcome.status {
        Status::Unstable => return format!("No answer. {}", no_answer::words(session)),
        Status::NotConverged => "Not finished: do not use these numbers.",
        Status::Converged => "Up to date.",
    };
    let (volume, width) = implant(session.scene());
    let answer = Answer::new(Some(outcome), session.scene());
    let strain = answer.strain.map_or_else(String::new, |strain| {
        format!(" Skin stretch {:.0} percent, {}.", 100.0 * strain, bands::strain_word(strain))
    });
    let cover = answer
        .cover
        .map_or_else(String::new, |cover| format!(" Cover {cover:.0} of {:.0} mm.", answer.rest));
    let pressure = answer.pressure.map_or_else(String::new, |(mean, most)| {
        let word = bands::pressure_word(most);
        format!(" Pressure {mean:.0}, at most {most:.0} mmHg, {word}.")
    });
    let warnings: String = outcome.warnings.iter().map(|warning| format!(" {warning}")).collect();
    format!("{volume} ml implant, {width} cm wide.{strain}{cover}{pressure} {state}{warnings}")
}

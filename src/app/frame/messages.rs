//! Messages: notices over the picture, the progress of a long solve in the status line, the pages "Stopped" and "No answer
//! for this plan".

use crate::app::picture::viewport::{lower_edge, veil};
use crate::app::texts::tr;
use crate::app::widgets::set_accessible_name;
use crate::app::widgets::theme;
use crate::scene::{Scene, Springs};
use crate::solve::Displayed;
use eframe::egui::accesskit::Live;
use eframe::egui::{self, Rect, RichText, Ui};
use web_time::Duration;

/// Heading of a scene without a shape.
const NO_ANSWER: &str = "No answer";
/// Greatest width of a box over the picture \[points\].
const BOX_WIDTH: f32 = 560.0;
/// Time for which a notice of success stays \[s\], and the further time of a character.
const STAYS_S: f64 = 6.0;
const STAYS_S_A_CHARACTER: f64 = 0.06;
/// Time in which the notice fades \[s\].
const FADES_S: f64 = 0.5;

/// Severity of a notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Severity {
    Info,
    Caution,
    Error,
}

/// An alternative scene that a notice offers.
#[derive(Clone, Debug)]
pub(crate) struct Offer {
    pub(crate) label: String,
    pub(crate) scene: Box<Scene>,
}

/// A line of text to the user.
#[derive(Clone, Debug)]
pub(crate) struct Notice {
    pub(crate) text: String,
    pub(crate) severity: Severity,
    pub(crate) offer: Option<Offer>,
    /// Time of the first frame that showed the notice \[s\].
    pub(crate) since: Option<f64>,
}

/// The user's action on a notice.
pub(crate) enum NoticeAction {
    Close,
    Accept(Box<Scene>),
}

impl Notice {
    pub(crate) fn info(text: impl Into<String>) -> Self {
        Self { text: text.into(), severity: Severity::Info, offer: None, since: None }
    }

    pub(crate) fn caution(text: impl Into<String>) -> Self {
        Self { severity: Severity::Caution, ..Self::info(text) }
    }

    pub(crate) fn error(text: impl Into<String>) -> Self {
        Self { severity: Severity::Error, ..Self::info(text) }
    }

    /// The notice with the word of its severity: some users do not see the colour.
    pub(crate) fn words(&self) -> String {
        let word = match self.severity {
            Severity::Info => "",
            Severity::Caution => tr("Note: "),
            Severity::Error => tr("Error: "),
        };
        format!("{word}{}", self.text)
    }

    /// Time for which the notice stays \[s\]; `None`: until the user closes it.
    fn stays(&self) -> Option<f64> {
        let fades = self.severity == Severity::Info && self.offer.is_none();
        fades.then(|| STAYS_S + STAYS_S_A_CHARACTER * self.text.chars().count() as f64)
    }

    /// The opacity \[-\] at a time \[s\]: a notice of success fades, all others stay.
    fn opacity(&mut self, now: f64) -> f32 {
        let shown = now - *self.since.get_or_insert(now);
        let faded = self.stays().map_or(0.0, |stays| (shown - stays) / FADES_S);
        (1.0 - faded).clamp(0.0, 1.0) as f32
    }

    /// Shows the notice over the lower part of an area; nothing moves for it. Under the pointer it does not fade.
    pub(crate) fn show(&mut self, ui: &Ui, area: Rect) -> Option<NoticeAction> {
        let now = ui.input(|input| input.time);
        let opacity = self.opacity(now);
        if opacity <= 0.0 {
            return Some(NoticeAction::Close);
        }
        let palette = theme::palette(ui.visuals());
        let (color, live) = match self.severity {
            Severity::Info => (palette.text, Live::Polite),
            Severity::Caution => (palette.caution, Live::Polite),
            Severity::Error => (palette.bad, Live::Assertive),
        };
        let mut action = None;
        let shown = over(ui, above_edge(area), "notice", |ui| {
            ui.set_opacity(opacity);
            ui.horizontal_wrapped(|ui| {
                let close = ui.button("×");
                set_accessible_name(&close, egui::Role::Button, tr("Close message"));
                if close.clicked() {
                    action = Some(NoticeAction::Close);
                }
                let text = RichText::new(self.words()).color(color);
                let label = ui.add(egui::Label::new(text).wrap());
                ui.ctx().accesskit_node_builder(label.id, |node| node.set_live(live));
                if let Some(offer) = &self.offer
                    && ui.button(&offer.label).clicked()
                {
                    action = Some(NoticeAction::Accept(offer.scene.clone()));
                }
            });
        });
        if ui.input(|input| input.pointer.hover_pos()).is_some_and(|at| shown.contains(at)) {
            self.since = Some(now);
        } else if opacity < 1.0 {
            ui.ctx().request_repaint();
        } else if let Some(stays) = self.stays() {
            let rest = stays - (now - self.since.unwrap_or(now));
            ui.ctx().request_repaint_after_secs(rest.max(0.0) as f32);
        }
        action
    }
}

/// Shows the progress of a long solve with a button to cancel, in the status line; `end` adds its words, or others, at the end.
/// Returns whether the user cancels. `fraction`: completed \[-\], 0 to 1.
pub(crate) fn progress(
    ui: &mut Ui,
    (time, fraction): (Duration, f64),
    displayed: Displayed,
    end: impl FnOnce(&mut Ui, String),
) -> bool {
    let is_cancelled = ui.button(tr("Cancel")).clicked();
    let (seconds, words) = (time.as_secs(), words_of(displayed));
    let words = tr!("Computing for {seconds} s; {words}", seconds, words);
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        end(ui, words);
        let bar = egui::ProgressBar::new(fraction as f32)
            .desired_width(ui.available_width().clamp(40.0, 320.0))
            .fill(theme::palette(ui.visuals()).accent)
            .animate(true);
        let bar = ui.add(bar);
        set_accessible_name(&bar, egui::Role::ProgressIndicator, tr("Progress of the solve"));
    });
    is_cancelled || ui.input(|input| input.key_pressed(egui::Key::Escape))
}

/// Shows that the solve was cancelled, with a button to continue; returns whether it was clicked.
pub(crate) fn stopped_page(ui: &mut Ui) -> bool {
    let mut is_continued = false;
    message_page(ui, tr("Stopped"), |ui| {
        ui.label(tr("This plan has not been computed, so there are no results."));
        ui.add_space(theme::SPACE);
        is_continued = ui.button(tr("Continue computing")).clicked();
    });
    is_continued
}

/// The page of a scene without a shape.
pub(crate) fn no_shape_page(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    message_page(ui, tr(NO_ANSWER), add);
}

/// A box over the picture of the last answer, of a scene without a shape.
pub(crate) fn no_shape_box(ui: &Ui, area: Rect, add: impl FnOnce(&mut Ui)) {
    let _ = over(ui, area, NO_ANSWER, |ui| {
        ui.label(RichText::new(tr(NO_ANSWER)).strong());
        add(ui);
    });
}

/// Words and a veil over the picture of a solve that has not ended.
pub(crate) fn provisional(ui: &Ui, area: Rect, displayed: Displayed) {
    veil(ui, area);
    over_picture(ui, area, tr!("Computing: {words}", words = words_of(displayed)));
}

/// What is being computed, over the picture.
pub(crate) fn over_picture(ui: &Ui, area: Rect, words: impl Into<String>) {
    let _ = over(ui, above_edge(area), "computing", |ui| {
        ui.label(RichText::new(words).strong());
    });
}

/// The picture of a solve that has not ended, in words.
fn words_of(displayed: Displayed) -> &'static str {
    match displayed {
        Displayed::Previous => tr("the picture is that of the previous plan"),
        Displayed::Coarse { .. } | Displayed::Draft | Displayed::Final => {
            tr("the picture is provisional")
        }
    }
}

/// A remedy for a scene without a shape: the standard model in place of the paper's springs.
pub(crate) fn standard_model(ui: &mut Ui, scene: &mut Scene) {
    if scene.springs != Springs::Nikolaev {
        return;
    }
    ui.small(tr(
        "At these strains and this Poisson ratio the springs of Nikolaev 2013 are unstable: their \
         energy has no minimum, so no shape can be computed.",
    ));
    ui.add_space(theme::SPACE);
    if ui.button(tr("Use the standard model")).clicked() {
        scene.springs = Springs::Coupled;
    }
}

/// The part of an area above what stands at the lower edge of a picture.
fn above_edge(area: Rect) -> Rect {
    area.with_max_y((area.bottom() - lower_edge(area)).max(area.center().y))
}

/// A box at the middle of the lower edge of an area, over what is there. Returns the place of the box.
fn over(ui: &Ui, area: Rect, name: &str, add: impl FnOnce(&mut Ui)) -> Rect {
    let inner = area.shrink(2.0 * theme::SPACE);
    let id = egui::Id::unique(name);
    let before = ui.ctx().memory(|memory| memory.area_rect(id));
    let shown = egui::Area::new(id)
        .order(egui::Order::Middle)
        .pivot(egui::Align2::CENTER_BOTTOM)
        .fixed_pos(inner.center_bottom())
        .constrain_to(inner)
        .show(ui.ctx(), |ui| {
            let frame = egui::Frame::popup(ui.style()).inner_margin(theme::SPACE);
            let drawn = frame.show(ui, |ui| {
                ui.set_width((inner.width() - 2.0 * theme::SPACE).min(BOX_WIDTH));
                add(ui);
            });
            drawn.response.rect
        });
    // The place follows from the size of the previous frame.
    let size = shown.inner.size();
    if before.is_none_or(|before| (before.size() - size).abs().max_elem() > 0.5) {
        ui.ctx().request_repaint();
    }
    shown.inner
}

/// A page with a heading in place of the picture.
fn message_page(ui: &mut Ui, heading: &str, add: impl FnOnce(&mut Ui)) {
    let frame = egui::Frame::new().inner_margin(2.0 * theme::SPACE).fill(ui.visuals().panel_fill);
    egui::CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.vertical_centered(|ui| {
            ui.add_space(0.3 * ui.available_height());
            ui.heading(heading);
            add(ui);
        });
    });
}

/// Greatest width of the scale bar on the lower edge of the picture \[points\].
const SCALE_BAR: f32 = 140.0;

/// What to do first, on the lower edge of the picture.
pub(super) fn hint(ui: &mut Ui, area: Rect) {
    let layout = egui::Layout::bottom_up(egui::Align::Max);
    let inner = area.shrink(2.0 * theme::SPACE);
    // To the right of the scale bar, above the word of a direction.
    let inner = inner.with_min_x(inner.left() + SCALE_BAR);
    let inner = inner.with_max_y(inner.bottom() - ui.text_style_height(&egui::TextStyle::Body));
    let builder = egui::UiBuilder::new().id_salt("hint").max_rect(inner).layout(layout);
    let words = tr("Change width, volume or pinch · drag the picture to turn it");
    let (text, ground) = (ui.visuals().strong_text_color(), ui.visuals().window_fill);
    let mut ui = ui.new_child(builder);
    // On a ground of its own over the skin.
    let behind = ui.painter().add(egui::Shape::Noop);
    let label = egui::Label::new(RichText::new(words).color(text));
    let rect = ui.add(label.selectable(false).wrap().halign(egui::Align::Max)).rect;
    let ground = ground.gamma_multiply(0.85);
    ui.painter().set(behind, egui::Shape::rect_filled(rect.expand(4.0), 4.0, ground));
}

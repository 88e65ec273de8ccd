//! Stability display of the paper's springs: the strains at which a uniformly stretched sheet of the
//! chosen layers is unstable, known before any solve, and a button for the coupled springs.

use crate::app::texts::tr;
use crate::app::widgets::set_accessible_name;
use crate::app::widgets::theme::{self, SPACE, SPACE_SMALL};
use crate::scene::{Scene, Springs};
use crate::springs::stability::{Limits, Load};
use eframe::egui::{self, Align2, RichText, Ui, pos2, vec2};

/// Height of a strip and of its stable part \[points\].
const HEIGHT: f32 = 12.0;
const STABLE_HEIGHT: f32 = 4.0;
/// Width of the names to the left of the strips \[points\].
const NAME_WIDTH: f32 = 68.0;

/// Shows text, strips and button. `greatest_strain`: greatest strain of the displayed shape \[-\].
pub(crate) fn show(ui: &mut Ui, scene: &mut Scene, limits: &Limits, greatest_strain: Option<f64>) {
    let palette = theme::palette(ui.visuals());
    let first = Load::ALL.iter().filter_map(|&load| limits.first_loss(load)).reduce(f64::min);
    let Some(first) = first else {
        ui.small(tr(
            "With these springs, uniformly stretched tissue is stable at all strains up to 100 %.",
        ));
        return;
    };
    ui.add_space(SPACE_SMALL);
    let words =
        tr!("The 2013 model breaks down, first at {first:.0} % stretch", first = 100.0 * first);
    ui.label(RichText::new(words).strong().color(palette.caution));
    ui.small(tr(
        "With these springs, uniformly stretched tissue is unstable at the strains marked below. A \
         scene in which much of the tissue has such strains may have no result.",
    ));
    for load in Load::ALL {
        strip(ui, load, limits.of(load), greatest_strain);
    }
    axis(ui);
    ui.horizontal_wrapped(|ui| {
        for (words, color) in
            [(tr("thin: stable"), palette.accent), (tr("thick: unstable"), palette.bad)]
        {
            ui.label(RichText::new(words).small().color(color));
        }
    });
    // The row is always present, so that the controls below do not move when a result arrives.
    ui.small(greatest_strain.map_or_else(
        || tr("vertical line: greatest strain, not yet computed").to_owned(),
        |greatest_strain| {
            tr!(
                "vertical line: greatest strain in this plan, {strain:.0} %",
                strain = 100.0 * greatest_strain
            )
        },
    ));
    let button = ui.button(tr("Use the standard model"));
    if button
        .on_hover_text(tr("Coupled springs use the same curves and are stable at all strains"))
        .clicked()
    {
        scene.springs = Springs::Coupled;
    }
    ui.add_space(SPACE_SMALL);
}

/// Description of a strip in words.
fn words(load: Load, stretches: &[[f64; 2]]) -> String {
    let how = match load {
        Load::Uniaxial => tr("Uniaxial stretch"),
        Load::Equibiaxial => tr("Equibiaxial stretch"),
    };
    if stretches.is_empty() {
        return tr!("{how}: stable at all strains up to 100 %", how);
    }
    let percent = |[from, to]: &[f64; 2]| {
        if *to < 1.0 {
            tr!("at {from:.0}–{to:.0} %", from = 100.0 * from, to = 100.0 * to)
        } else {
            tr!("from {from:.0} %", from = 100.0 * from)
        }
    };
    let list: Vec<String> = stretches.iter().map(percent).collect();
    tr!("{how}: unstable {list}", how, list = list.join(tr(" and ")))
}

/// Shows a strip for strains from 0 to 100 %.
fn strip(ui: &mut Ui, load: Load, stretches: &[[f64; 2]], greatest_strain: Option<f64>) {
    let palette = theme::palette(ui.visuals());
    let (rect, response) = row(ui, HEIGHT);
    let name = match load {
        Load::Uniaxial => tr("Uniaxial"),
        Load::Equibiaxial => tr("Biaxial"),
    };
    let painter = ui.painter();
    let (font, quiet) =
        (egui::TextStyle::Small.resolve(ui.style()), ui.visuals().weak_text_color());
    let left = pos2(rect.left() - NAME_WIDTH, rect.center().y);
    painter.text(left, Align2::LEFT_CENTER, name, font, quiet);
    let thin = egui::Rect::from_center_size(rect.center(), vec2(rect.width(), STABLE_HEIGHT));
    painter.rect_filled(thin, 1.0, palette.accent);
    let at = |strain: f64| rect.left() + rect.width() * strain as f32;
    for &[from, to] in stretches {
        let thick = egui::Rect::from_x_y_ranges(at(from)..=at(to), rect.y_range());
        painter.rect_filled(thick, 1.0, palette.bad);
    }
    if let Some(greatest_strain) = greatest_strain {
        let line = egui::Stroke::new(1.5, ui.visuals().text_color());
        painter.vline(at(greatest_strain.clamp(0.0, 1.0)), rect.y_range().expand(2.0), line);
    }
    let words = words(load, stretches);
    set_accessible_name(&response, egui::Role::Label, &words);
    response.on_hover_text(words);
}

fn axis(ui: &mut Ui) {
    let (rect, _) = row(ui, HEIGHT);
    let (font, quiet) =
        (egui::TextStyle::Small.resolve(ui.style()), ui.visuals().weak_text_color());
    for (fraction, align, text) in [
        (0.0, Align2::LEFT_CENTER, "0"),
        (0.5, Align2::CENTER_CENTER, "50"),
        (1.0, Align2::RIGHT_CENTER, tr("100 % strain")),
    ] {
        let x = rect.left() + fraction * rect.width();
        ui.painter().text(pos2(x, rect.center().y), align, text, font.clone(), quiet);
    }
}

/// Allocates a row of the given height, to the right of the names.
fn row(ui: &mut Ui, height: f32) -> (egui::Rect, egui::Response) {
    let size = vec2(ui.available_width() - SPACE, height);
    let (mut rect, response) = ui.allocate_exact_size(size, egui::Sense::hover());
    rect.min.x += NAME_WIDTH;
    (rect, response)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_are_described_in_words() {
        assert_eq!(
            words(Load::Uniaxial, &[[0.224, 0.421], [0.97, 1.0]]),
            "Uniaxial stretch: unstable at 22–42 % and from 97 %"
        );
        assert_eq!(
            words(Load::Equibiaxial, &[]),
            "Equibiaxial stretch: stable at all strains up to 100 %"
        );
    }
}

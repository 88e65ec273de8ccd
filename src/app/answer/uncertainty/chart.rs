//! The chart: how much of the spread of a result each unknown explains.

use super::unknowns::{measurement, words};
use crate::app::texts::tr;
use crate::app::widgets::theme::{self, SPACE, SPACE_SMALL};
use crate::app::widgets::{choice, labelled_box, remark, set_accessible_name};
use crate::study::{Band, Index, Quantity, Unknown};
use eframe::egui::{self, Align2, Rect, Sense, Stroke, TextStyle, Ui, pos2, vec2};

/// Height of a bar's row and width of its number \[points\].
const HEIGHT: f32 = 17.0;
const NUMBER_WIDTH: f32 = 34.0;

/// Shows the choice of the explained quantity; returns whether the choice has changed.
pub(super) fn quantity(ui: &mut Ui, explained: &mut Quantity, bands: &[Band]) -> bool {
    let before = *explained;
    ui.add_space(SPACE_SMALL);
    labelled_box(ui, tr("What matters most for"), &name(before), |ui| {
        for band in bands {
            if choice(ui, band.quantity == before, name(band.quantity)).clicked() {
                *explained = band.quantity;
            }
        }
    });
    *explained != before
}

/// The quantity with its unit.
fn name(quantity: Quantity) -> String {
    format!("{} ({})", tr(quantity.label()), quantity.display().1)
}

/// Shows one bar for each unknown, greatest first.
pub(super) fn bars(ui: &mut Ui, importance: &[(Unknown, Index)], is_running: bool) {
    if importance.is_empty() {
        let words = if is_running {
            tr("Computed after the sampled patients.")
        } else {
            tr("Too few sampled patients have an answer, or no unknown changes this number.")
        };
        remark(ui, words);
        return;
    }
    let (font, text) = (TextStyle::Small.resolve(ui.style()), ui.visuals().text_color());
    let width = |unknown: Unknown| {
        let name = words(unknown).name.to_owned();
        ui.painter().layout_no_wrap(name, font.clone(), text).size().x
    };
    // As wide as the longest name.
    let names = importance.iter().map(|(unknown, _)| width(*unknown)).fold(0.0, f32::max);
    for (unknown, index) in importance {
        bar(ui, *unknown, index, names + SPACE);
    }
    let alone: f64 = importance.iter().map(|(_, index)| index.first_order.max(0.0)).sum();
    let rest = (1.0 - alone).max(0.0);
    remark(
        ui,
        tr!(
            "Share of the spread (variance) that each unknown explains alone; {rest:.0} % is the effect of several \
             together.",
            rest = 100.0 * rest
        ),
    );
    if let Some(what) = worth_measuring(importance) {
        ui.label(tr!("Worth measuring: {what}.", what));
    }
}

/// Least share of the spread that makes a measurement worth its while \[-\].
const WORTH: f64 = 0.1;

/// What to measure for a narrower band: of the unknowns that a clinic can measure the one that explains most.
fn worth_measuring(importance: &[(Unknown, Index)]) -> Option<&'static str> {
    let mut shares = importance.iter().filter(|(_, index)| index.first_order >= WORTH);
    shares.find_map(|(unknown, _)| measurement(*unknown))
}

/// Shows the bar of an unknown: name in a width \[points\], bar with the standard error, number.
fn bar(ui: &mut Ui, unknown: Unknown, index: &Index, name_width: f32) {
    let size = vec2(ui.available_width() - SPACE, HEIGHT);
    let (row, response) = ui.allocate_exact_size(size, Sense::hover());
    let palette = theme::palette(ui.visuals());
    let (font, text) = (TextStyle::Small.resolve(ui.style()), ui.visuals().text_color());
    let painter = ui.painter();
    let share = index.first_order.clamp(0.0, 1.0);
    painter.text(row.left_center(), Align2::LEFT_CENTER, words(unknown).name, font.clone(), text);
    let number = format!("{:.0} %", 100.0 * share);
    painter.text(row.right_center(), Align2::RIGHT_CENTER, number, font, text);
    let rail = Rect::from_min_max(
        pos2(row.left() + name_width, row.top() + 4.0),
        pos2(row.right() - NUMBER_WIDTH, row.bottom() - 4.0),
    );
    let at = |share: f64| rail.left() + rail.width() * share.clamp(0.0, 1.0) as f32;
    painter.rect_filled(rail, 1.0, ui.visuals().extreme_bg_color);
    painter.rect_filled(rail.with_max_x(at(share)), 1.0, palette.accent);
    let [error, _] = index.standard_error;
    let line = Stroke::new(1.0, palette.text);
    painter.hline(at(share - error)..=at(share + error), rail.center().y, line);
    let words = description(unknown, index);
    set_accessible_name(&response, egui::Role::Label, &words);
    response.on_hover_text(words);
}

/// A bar in words.
fn description(unknown: Unknown, index: &Index) -> String {
    let percent = |share: f64| 100.0 * share.clamp(0.0, 1.0);
    let [alone, total] = index.standard_error.map(|error| 100.0 * error);
    tr!(
        "{name}: {first:.0} ± {alone:.0} % of the spread alone, {whole:.0} ± {total:.0} % together with others",
        name = words(unknown).name,
        first = percent(index.first_order),
        alone,
        whole = percent(index.total),
        total
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_unknown_that_a_clinic_can_measure_is_named() {
        let of = |first_order| Index { first_order, total: first_order, standard_error: [0.0; 2] };
        let stiffness = (Unknown::SkinStressScale, of(0.5));
        let laxity = (Unknown::SkinStrainScale, of(0.3));
        let fat = (Unknown::CoverThickness, of(0.05));
        let words = worth_measuring(&[stiffness, laxity, fat]).unwrap();
        assert!(words.starts_with("the pull of the skin"), "{words}");
        assert_eq!(worth_measuring(&[stiffness, fat]), None);
    }

    #[test]
    fn a_bar_is_described_in_words() {
        let index = Index { first_order: -0.02, total: 0.314, standard_error: [0.04, 0.051] };
        assert_eq!(
            description(Unknown::PocketRadius, &index),
            "Margin of the pocket: 0 ± 4 % of the spread alone, 31 ± 5 % together with others"
        );
    }
}

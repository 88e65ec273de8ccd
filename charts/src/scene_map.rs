//! A map of scenes as a chart: bands of the shown quantity, contour lines at its limits, lines of equal volume, typical sizes
//! and the present implant.

use crate::page::{Area, Drawn, Page, at, draw_label, pen, text};
use crate::panel::{Axis, Element, Grid, Panel, Shape, draw_all, draw_panel};
use implant_preview_core::study::{Map, PointStatus, Quantity};
use plotters::prelude::*;

const SIZE: (u32, u32) = (920, 760);
const LEGEND_HEIGHT: u32 = 118;
/// Points below the first level, and above each level, light to dark.
const COLOURS: [RGBColor; 9] = [
    RGBColor(0xf1, 0xf4, 0xf8),
    RGBColor(0xdd, 0xe8, 0xf3),
    RGBColor(0xc6, 0xda, 0xec),
    RGBColor(0xa8, 0xc8, 0xe2),
    RGBColor(0x88, 0xb3, 0xd6),
    RGBColor(0x6a, 0x9d, 0xc8),
    RGBColor(0x50, 0x86, 0xb7),
    RGBColor(0x3b, 0x6f, 0xa3),
    RGBColor(0x2a, 0x58, 0x8c),
];
/// Points without a converged solve.
const MISSING: RGBColor = RGBColor(0xb0, 0x1e, 0x5a);
const LINE: RGBColor = RGBColor(0x1a, 0x1c, 0x20);
const VOLUME: RGBColor = RGBColor(0x8a, 0x93, 0x9e);
const PRESENT: RGBColor = RGBColor(0xd9, 0x5f, 0x0e);
const VOLUME_DASH: (u32, u32) = (3, 4);

/// Draws the map of a quantity as SVG text.
///
/// # Errors
/// An error of the drawing backend.
pub fn draw(map: &Map, quantity: Quantity) -> Result<String, Box<dyn std::error::Error>> {
    let (_, unit) = quantity.display();
    let title = format!("{} ({unit})", capitalised(quantity.label()));
    let remark = map.notes().swap_remove(0);
    let page = Page {
        size: SIZE,
        title: &title,
        remark: Some((&remark, 15)),
        panels: 1,
        legend_height: LEGEND_HEIGHT,
    };
    page.draw(|panels, legend| {
        for area in panels {
            draw_map(area, map, quantity)?;
        }
        draw_legend(legend, map)
    })
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}

/// A number for a label: four significant digits.
fn label(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    (rounded + 0.0).to_string()
}

fn draw_map(area: &Area, map: &Map, quantity: Quantity) -> Drawn {
    let (factor, unit) = quantity.display();
    let axes = map.axes();
    let name = |k: usize| {
        axes.get(k).map_or_else(
            || format!("{} ({unit})", quantity.label()),
            |axis| {
                let (words, unit) = axis.field.label();
                if unit.is_empty() { format!("{words} (–)") } else { format!("{words} ({unit})") }
            },
        )
    };
    let range = |k: usize| {
        axes.get(k).map_or_else(
            || {
                let (_, most) = map.range(quantity).unwrap_or((0.0, 1.0));
                0.0..(1.05 * factor * most).max(1e-9)
            },
            |axis| axis.from.min(axis.to)..axis.from.max(axis.to),
        )
    };
    let elements =
        if axes.len() == 1 { curve(map, quantity, range(1).end) } else { plane(map, quantity) };
    let (x_name, y_name) = (name(0), name(1));
    let panel = Panel {
        caption: "",
        x: Axis { range: range(0), name: &x_name, labels: 8, format: &|x| label(*x) },
        y: Axis { range: range(1), name: &y_name, labels: 8, format: &|y| label(*y) },
        grid: if axes.len() == 1 { Grid::Lines } else { Grid::None },
        right_margin: 24,
        y_label_width: 74,
        label_size: 16,
    };
    draw_panel(area, panel, &elements)
}

/// A map of one axis: the curve, its limits, the points without a value, the present scene.
fn curve(map: &Map, quantity: Quantity, top: f64) -> Vec<Element<(f64, f64)>> {
    let (factor, unit) = quantity.display();
    let axis = map.axes()[0];
    let mut elements = Vec::new();
    for level in map.limit_values(quantity).into_iter().map(|level| factor * level) {
        if level < top {
            let line = vec![(axis.from, level), (axis.to, level)];
            elements.push(Element::Dashes(line, VOLUME_DASH, pen(VOLUME, 2)));
            let left = (axis.from.min(axis.to), level);
            elements.push(Element::Text(left, format!(" {} {unit}", label(level)), text(15)));
        }
    }
    // The curve has a gap at every point without a value.
    let mut piece = Vec::new();
    for i in 0..axis.count {
        match map.value(quantity, i, 0) {
            Some(value) => piece.push((axis.value(i), factor * value)),
            None => {
                elements.push(Element::Line(std::mem::take(&mut piece), pen(LINE, 2)));
                let at = (axis.value(i), 0.0);
                elements.push(Element::Marker(at, Shape::Cross, 4, pen(MISSING, 2)));
            }
        }
    }
    let points: Vec<_> = (0..axis.count)
        .filter_map(|i| Some((axis.value(i), factor * map.value(quantity, i, 0)?)))
        .collect();
    elements.push(Element::Line(piece, pen(LINE, 2)));
    elements
        .extend(points.into_iter().map(|p| Element::Marker(p, Shape::Circle, 2, LINE.filled())));
    if let Some([x, _]) = map.present() {
        elements.push(Element::Line(vec![(x, 0.0), (x, top)], pen(PRESENT, 2)));
    }
    elements
}

/// A map of two axes: a cell around each point, contour lines, volumes, sizes, the present implant.
fn plane(map: &Map, quantity: Quantity) -> Vec<Element<(f64, f64)>> {
    let (factor, unit) = quantity.display();
    let (x, y) = (map.axes()[0], map.axes()[1]);
    let levels = map.levels(quantity);
    let mut elements = Vec::new();
    // The border of a cell is halfway to the next point.
    let border = |axis: &implant_preview_core::study::Axis, k: usize, side: f64| {
        let step = (axis.to - axis.from) / (axis.count - 1) as f64;
        let (least, most) = (axis.from.min(axis.to), axis.from.max(axis.to));
        (axis.value(k) + side * 0.5 * step).clamp(least, most)
    };
    let mut missing = Vec::new();
    for j in 0..y.count {
        for i in 0..x.count {
            let Some(value) = map.value(quantity, i, j) else {
                if map.status(i, j) != PointStatus::Waiting {
                    missing.push((x.value(i), y.value(j)));
                }
                continue;
            };
            let band = levels.iter().filter(|level| value > **level).count();
            let colour = COLOURS[band.min(COLOURS.len() - 1)];
            let [left, right] = [-1.0, 1.0].map(|side| border(&x, i, side));
            let [bottom, top] = [-1.0, 1.0].map(|side| border(&y, j, side));
            let cell = vec![(left, bottom), (right, bottom), (right, top), (left, top)];
            elements.push(Element::Region(cell, colour));
        }
    }
    for (volume, path) in map.equal_volumes() {
        if let Some(end) = path.get(path.len() / 8) {
            let words = format!("{} ml", label(volume));
            elements.push(Element::Text(*end, words, text(14).color(&VOLUME)));
        }
        elements.push(Element::Dashes(path, VOLUME_DASH, pen(VOLUME, 1)));
    }
    for level in levels {
        for path in map.contours(quantity, level) {
            if let Some(middle) = path.get(path.len() / 2) {
                let words = format!(" {} {unit}", label(factor * level));
                elements.push(Element::Text(*middle, words, text(15)));
            }
            elements.push(Element::Line(path, pen(LINE, 2)));
        }
    }
    let cross = |p| Element::Marker(p, Shape::Cross, 3, pen(MISSING, 1));
    elements.extend(missing.into_iter().map(cross));
    let dot = |p| Element::Marker(p, Shape::Circle, 2, VOLUME.filled());
    elements.extend(map.typical_sizes().into_iter().map(dot));
    if let Some([x, y]) = map.present() {
        elements.push(Element::Marker((x, y), Shape::Circle, 6, pen(PRESENT, 3)));
    }
    elements
}

fn draw_legend(area: &Area, map: &Map) -> Drawn {
    let y = 16;
    let line = |x: i32| vec![at(x, y), at(x + 36, y)];
    let is_plane = map.axes().len() == 2;
    if is_plane {
        draw_all(area, &[Element::Line(line(76), pen(LINE, 2))])?;
        draw_label(area, "limit or level", 120, y)?;
    }
    draw_all(area, &[Element::Marker(at(270, y), Shape::Circle, 6, pen(PRESENT, 3))])?;
    draw_label(area, "this scene", 286, y)?;
    draw_all(area, &[Element::Marker(at(410, y), Shape::Cross, 4, pen(MISSING, 2))])?;
    draw_label(area, "no converged shape", 424, y)?;
    if !map.equal_volumes().is_empty() {
        draw_all(area, &[Element::Dashes(line(620), VOLUME_DASH, pen(VOLUME, 1))])?;
        draw_label(area, "equal volume", 664, y)?;
        draw_all(area, &[Element::Marker(at(784, y), Shape::Circle, 2, VOLUME.filled())])?;
        draw_label(area, "typical size", 796, y)?;
    }
    for (k, note) in map.notes().iter().skip(1).enumerate() {
        area.draw_text(note, &text(15), at(76, 38 + 22 * k as i32))?;
    }
    Ok(())
}

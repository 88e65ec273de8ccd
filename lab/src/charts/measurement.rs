//! A measurement with its predictions: markers, bands and lines in one panel.

use super::tension::COLOURS;
use crate::measurements::{Comparison, Mark, PlotAxis, Series};
use implant_preview_charts::page::{Area, Drawn, Page, TEXT, at, draw_label, pen};
use implant_preview_charts::panel::{Axis, Element, Grid, Panel, Shape, draw_all, draw_panel};
use plotters::prelude::*;

const WIDTH: u32 = 860;
/// Height of the page without the legend \[px\].
const PANEL_HEIGHT: u32 = 470;
/// Height of a row of the legend, and width of its two columns \[px\].
const ROW: i32 = 24;
const COLUMN: i32 = 390;
const BAND: RGBColor = RGBColor(0xd6, 0xda, 0xe0);
/// Size of a marker \[px\].
const POINT: u32 = 5;

/// Draws the comparison as SVG text.
///
/// # Errors
/// An error of the drawing backend.
pub fn draw(comparison: &Comparison) -> Result<String, Box<dyn std::error::Error>> {
    let named = named(comparison);
    let legend_height = (ROW * named.len().div_ceil(2) as i32 + 14) as u32;
    let page = Page {
        size: (WIDTH, PANEL_HEIGHT + legend_height),
        title: comparison.title,
        remark: None,
        panels: 1,
        legend_height,
    };
    page.draw(|panels, legend| {
        for area in panels {
            draw_series(area, comparison)?;
        }
        draw_legend(legend, &named)
    })
}

/// The series with a label, with their colours.
fn named(comparison: &Comparison) -> Vec<(&Series, RGBColor)> {
    let coloured = comparison.series.iter().zip(colours(&comparison.series));
    coloured.filter(|(series, _)| !series.label.is_empty()).collect()
}

/// A colour of its own for each line; bands are grey, measured points dark, further points in the first colour.
fn colours(series: &[Series]) -> Vec<RGBColor> {
    let (mut lines, mut points) =
        (COLOURS.into_iter().cycle(), [COLOURS[3], TEXT].into_iter().rev());
    let colour = |one: &Series| match one.mark {
        Mark::Band => BAND,
        Mark::Line => lines.next().unwrap_or(TEXT),
        Mark::Points => points.next().unwrap_or(TEXT),
    };
    series.iter().map(colour).collect()
}

fn draw_series(area: &Area, comparison: &Comparison) -> Drawn {
    let [x, y] = &comparison.axes;
    let label = |axis: &PlotAxis| {
        let decimals = axis.decimals;
        move |value: &f64| format!("{value:.decimals$}")
    };
    let (of_x, of_y) = (label(x), label(y));
    let panel = Panel {
        caption: "",
        x: Axis { range: x.range[0]..x.range[1], name: x.name, labels: x.labels, format: &of_x },
        y: Axis { range: y.range[0]..y.range[1], name: y.name, labels: y.labels, format: &of_y },
        grid: Grid::Lines,
        right_margin: 24,
        y_label_width: 66,
        label_size: 16,
    };
    let mut elements = Vec::new();
    for (series, colour) in comparison.series.iter().zip(colours(&comparison.series)) {
        match series.mark {
            Mark::Band => elements.push(Element::Region(series.points.clone(), colour)),
            Mark::Line => elements.push(Element::Line(clipped(series, y), pen(colour, 2))),
            Mark::Points => elements.extend(
                series
                    .points
                    .iter()
                    .map(|p| Element::Marker(*p, Shape::Circle, POINT, colour.filled())),
            ),
        }
    }
    draw_panel(area, panel, &elements)
}

/// The line up to its first point above the panel, which moves onto the panel's edge.
fn clipped(series: &Series, y: &PlotAxis) -> Vec<(f64, f64)> {
    let top = y.range[1];
    let mut points: Vec<(f64, f64)> = Vec::new();
    for &(x, value) in &series.points {
        if value <= top {
            points.push((x, value));
            continue;
        }
        if let Some(&(x0, before)) = points.last() {
            points.push((x0 + (x - x0) * (top - before) / (value - before), top));
        }
        break;
    }
    points
}

fn draw_legend(area: &Area, named: &[(&Series, RGBColor)]) -> Drawn {
    for (k, (series, colour)) in named.iter().enumerate() {
        let (x, y) = (72 + COLUMN * (k % 2) as i32, 14 + ROW * (k / 2) as i32);
        let sample = match series.mark {
            Mark::Band => Element::Line(vec![at(x, y), at(x + 26, y)], pen(*colour, 12)),
            Mark::Line => Element::Line(vec![at(x, y), at(x + 26, y)], pen(*colour, 3)),
            Mark::Points => Element::Marker(at(x + 13, y), Shape::Circle, POINT, colour.filled()),
        };
        draw_all(area, &[sample])?;
        draw_label(area, &series.label, x + 36, y)?;
    }
    Ok(())
}

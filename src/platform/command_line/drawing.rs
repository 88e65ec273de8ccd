//! Drawing of a chart with two panels: the paper's springs and the coupled springs.

use crate::view::svg::{Area, Drawn, FINE, GRID, TEXT, at, font, page, pen};
use crate::view::svg_backend::SvgBackend;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

/// Quantity plotted against the elongation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The load \[kPa\].
    Stress,
    /// The negative transverse strain \[-\].
    Transverse,
}

impl Kind {
    pub(super) fn value(self, load_kpa: f64, transverse_strain: f64) -> f64 {
        match self {
            Self::Stress => load_kpa,
            Self::Transverse => -transverse_strain,
        }
    }
}

/// Data of one Poisson ratio in one panel, as (elongation, value).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Series {
    poisson_ratio: f64,
    /// Lines over the strains with a stable equilibrium.
    pub(super) branches: Vec<Vec<(f64, f64)>>,
    /// Values by the paper's protocol.
    pub(super) points: Vec<(f64, f64)>,
    /// Points of loss of stability.
    pub(super) lost: Vec<(f64, f64)>,
}

impl Series {
    pub(super) fn new(poisson_ratio: f64) -> Self {
        Self { poisson_ratio, branches: Vec::new(), points: Vec::new(), lost: Vec::new() }
    }
}

/// A chart of the paper for both laws.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chart {
    pub(super) title: String,
    pub(super) tissue: String,
    pub(super) kind: Kind,
    /// The curve Ef, drawn in the stress charts.
    pub(super) curve: Vec<(f64, f64)>,
    /// Title and series of each panel.
    pub(super) panels: [(String, Vec<Series>); 2],
}

type Plane<'a, 'b> = ChartContext<'a, SvgBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Size in the page \[px\].
const SIZE: (u32, u32) = (1040, 520);
const LEGEND_HEIGHT: u32 = 62;
const TITLE_HEIGHT: u32 = 40;
const CURVE: RGBColor = RGBColor(0xb8, 0xbe, 0xc6);
const LOST: RGBColor = RGBColor(0xc6, 0x28, 0x28);
/// Colours from low to high ν, distinct without red–green vision.
const COLOURS: [RGBColor; 6] = [
    RGBColor(0x3b, 0x0f, 0x70),
    RGBColor(0x33, 0x63, 0xb5),
    RGBColor(0x1f, 0x9e, 0xa8),
    RGBColor(0x6b, 0xb3, 0x3a),
    RGBColor(0xe3, 0x9a, 0x10),
    RGBColor(0xd4, 0x4e, 0x8c),
];

/// Draws the chart as SVG text.
pub(super) fn draw(chart: &Chart) -> Result<String, Box<dyn std::error::Error>> {
    page(SIZE, |whole| {
        let title = font(25).style(FontStyle::Bold).color(&TEXT);
        whole.draw_text(&chart.title, &title, at(24, 12))?;
        let (_, below) = whole.split_vertically(FINE * TITLE_HEIGHT);
        let (panels, legend) =
            below.split_vertically(FINE * (SIZE.1 - TITLE_HEIGHT - LEGEND_HEIGHT));
        for (area, (title, series)) in panels.split_evenly((1, 2)).iter().zip(&chart.panels) {
            draw_panel(area, chart, title, series)?;
        }
        draw_legend(&legend, chart)
    })
}

fn draw_panel(area: &Area, chart: &Chart, title: &str, series: &[Series]) -> Drawn {
    let highest = match chart.kind {
        Kind::Stress => 1.05 * chart.curve.last().map_or(1.0, |point| point.1),
        Kind::Transverse => 0.52,
    };
    let text = |size: u32| font(size).color(&TEXT);
    let mut plane: Plane = ChartBuilder::on(area)
        .caption(title, text(20))
        .margin_left(FINE * 14)
        .margin_right(FINE * 18)
        .x_label_area_size(FINE * 50)
        .y_label_area_size(FINE * 62)
        .build_cartesian_2d(0.0..1.02, 0.0..highest)?;
    let name = match chart.kind {
        Kind::Stress => "nominal stress (kPa)",
        Kind::Transverse => "transverse contraction, −ε (–)",
    };
    let decimals = if chart.kind == Kind::Stress && highest > 10.0 { 0 } else { 1 };
    plane
        .configure_mesh()
        .bold_line_style(pen(GRID, 1))
        .light_line_style(TRANSPARENT)
        .axis_style(pen(TEXT, 1))
        .set_all_tick_mark_size(FINE * 5)
        .x_desc("elongation ε (–)")
        .y_desc(name)
        .x_labels(6)
        .y_labels(6)
        .label_style(text(16))
        .axis_desc_style(text(17))
        .x_label_formatter(&|x| format!("{x:.1}"))
        .y_label_formatter(&|y| format!("{y:.decimals$}"))
        .draw()?;
    if chart.kind == Kind::Stress {
        plane.draw_series(LineSeries::new(chart.curve.iter().copied(), pen(CURVE, 9)))?;
    }
    for (series, colour) in series.iter().zip(COLOURS) {
        for branch in &series.branches {
            plane.draw_series(LineSeries::new(branch.iter().copied(), pen(colour, 2)))?;
        }
        plane.draw_series(
            series.points.iter().map(|point| Circle::new(*point, FINE * 4, colour.filled())),
        )?;
    }
    for (series, colour) in series.iter().zip(COLOURS) {
        plane.draw_series(
            series.lost.iter().map(|point| Circle::new(*point, FINE * 7, WHITE.filled())),
        )?;
        plane.draw_series(
            series.lost.iter().map(|point| Circle::new(*point, FINE * 7, pen(colour, 2))),
        )?;
        plane.draw_series(
            series.lost.iter().map(|point| Cross::new(*point, FINE * 4, pen(LOST, 2))),
        )?;
    }
    Ok(())
}

/// Draws two rows below the panels: the Poisson ratios, and the meaning of lines, points and marks.
fn draw_legend(area: &Area, chart: &Chart) -> Drawn {
    let text = font(17).color(&TEXT);
    let label = |words: &str, x: i32, y: i32| area.draw_text(words, &text, at(x, y - 7));
    let (first, second) = (14, 40);
    label("Poisson ratio specified:", 72, first)?;
    for (k, (series, colour)) in chart.panels[0].1.iter().zip(COLOURS).enumerate() {
        let x = 250 + 90 * k as i32;
        area.draw(&PathElement::new([at(x, first), at(x + 26, first)], pen(colour, 3)))?;
        area.draw(&Circle::new(at(x + 13, first), FINE * 4, colour.filled()))?;
        label(&series.poisson_ratio.to_string(), x + 34, first)?;
    }
    let mut x = 72;
    if chart.kind == Kind::Stress {
        area.draw(&PathElement::new([at(x, second), at(x + 26, second)], pen(CURVE, 9)))?;
        label(&format!("{} Ef", chart.tissue), x + 36, second)?;
        x += 150;
    }
    area.draw(&PathElement::new([at(x, second), at(x + 26, second)], pen(TEXT, 2)))?;
    label("stable equilibrium", x + 36, second)?;
    x += 190;
    area.draw(&Circle::new(at(x + 13, second), FINE * 4, TEXT.filled()))?;
    label("paper's 15 000 iterations", x + 30, second)?;
    x += 230;
    area.draw(&Circle::new(at(x + 13, second), FINE * 7, pen(TEXT, 2)))?;
    area.draw(&Cross::new(at(x + 13, second), FINE * 4, pen(LOST, 2)))?;
    label("stability lost", x + 30, second)?;
    Ok(())
}

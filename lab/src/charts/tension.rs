//! Charts 1 to 4 of the paper: two panels side by side, the paper's springs and the coupled springs.

use implant_preview_charts::page::{Area, Drawn, Page, TEXT, at, draw_label, pen};
use implant_preview_charts::panel::{Axis, Element, Grid, Panel, Shape, draw_all, draw_panel};
use plotters::prelude::*;

/// The quantity of a chart, as a function of the elongation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The load \[kPa\].
    Stress,
    /// The transverse strain with reversed sign \[-\].
    Transverse,
}

impl Kind {
    /// The quantity of a state under a load \[kPa\] with a transverse strain \[-\].
    #[must_use]
    pub fn value(self, load_kpa: f64, transverse_strain: f64) -> f64 {
        match self {
            Self::Stress => load_kpa,
            Self::Transverse => -transverse_strain,
        }
    }
}

/// One Poisson ratio in one panel. Points are (elongation, value).
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The prescribed Poisson ratio \[-\].
    pub poisson_ratio: f64,
    /// Branches over the strains with a stable equilibrium.
    pub branches: Vec<Vec<(f64, f64)>>,
    /// Results of the paper's protocol.
    pub points: Vec<(f64, f64)>,
    /// States at the loss of stability.
    pub lost: Vec<(f64, f64)>,
}

impl Series {
    /// A series without points.
    #[must_use]
    pub fn new(poisson_ratio: f64) -> Self {
        Self { poisson_ratio, branches: Vec::new(), points: Vec::new(), lost: Vec::new() }
    }
}

/// A chart of the paper for both laws.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The title.
    pub title: String,
    /// The name of the tissue.
    pub tissue: String,
    /// The quantity.
    pub kind: Kind,
    /// The curve Ef, drawn in the stress charts.
    pub curve: Vec<(f64, f64)>,
    /// Title and series of each panel.
    pub panels: [(String, Vec<Series>); 2],
}

/// Size of the page \[px\].
const SIZE: (u32, u32) = (1040, 520);
const LEGEND_HEIGHT: u32 = 62;
const CURVE: RGBColor = RGBColor(0xb8, 0xbe, 0xc6);
const LOST: RGBColor = RGBColor(0xc6, 0x28, 0x28);
/// From low to high ν; distinguishable also with red–green colour blindness.
pub(super) const COLOURS: [RGBColor; 6] = [
    RGBColor(0x3b, 0x0f, 0x70),
    RGBColor(0x33, 0x63, 0xb5),
    RGBColor(0x1f, 0x9e, 0xa8),
    RGBColor(0x6b, 0xb3, 0x3a),
    RGBColor(0xe3, 0x9a, 0x10),
    RGBColor(0xd4, 0x4e, 0x8c),
];
/// Sizes of a measured point, of the ring around a loss of stability and of the cross in the ring \[px\].
const POINT: u32 = 4;
const RING: u32 = 7;
const CROSS: u32 = 4;

/// Draws the chart as SVG text.
///
/// # Errors
/// An error of the drawing backend.
pub fn draw(chart: &Chart) -> Result<String, Box<dyn std::error::Error>> {
    let page = Page {
        size: SIZE,
        title: &chart.title,
        remark: None,
        panels: chart.panels.len(),
        legend_height: LEGEND_HEIGHT,
    };
    page.draw(|panels, legend| {
        for (area, (title, series)) in panels.iter().zip(&chart.panels) {
            draw_series(area, chart, title, series)?;
        }
        draw_legend(legend, chart)
    })
}

fn draw_series(area: &Area, chart: &Chart, title: &str, series: &[Series]) -> Drawn {
    let highest = match chart.kind {
        Kind::Stress => 1.05 * chart.curve.last().map_or(1.0, |point| point.1),
        Kind::Transverse => 0.52,
    };
    let name = match chart.kind {
        Kind::Stress => "nominal stress (kPa)",
        Kind::Transverse => "transverse contraction, −ε (–)",
    };
    let decimals = if chart.kind == Kind::Stress && highest > 10.0 { 0 } else { 1 };
    let panel = Panel {
        caption: title,
        x: Axis {
            range: 0.0..1.02,
            name: "elongation ε (–)",
            labels: 6,
            format: &|x| format!("{x:.1}"),
        },
        y: Axis { range: 0.0..highest, name, labels: 6, format: &|y| format!("{y:.decimals$}") },
        grid: Grid::Lines,
        right_margin: 18,
        y_label_width: 62,
        label_size: 16,
    };
    let mut elements = Vec::new();
    if chart.kind == Kind::Stress {
        elements.push(Element::Line(chart.curve.clone(), pen(CURVE, 9)));
    }
    for (series, colour) in series.iter().zip(COLOURS) {
        elements.extend(
            series.branches.iter().map(|branch| Element::Line(branch.clone(), pen(colour, 2))),
        );
        elements.extend(circles(&series.points, POINT, colour.filled()));
    }
    for (series, colour) in series.iter().zip(COLOURS) {
        elements.extend(circles(&series.lost, RING, WHITE.filled()));
        elements.extend(circles(&series.lost, RING, pen(colour, 2)));
        let cross = |point: &_| Element::Marker(*point, Shape::Cross, CROSS, pen(LOST, 2));
        elements.extend(series.lost.iter().map(cross));
    }
    draw_panel(area, panel, &elements)
}

fn circles(
    points: &[(f64, f64)],
    size: u32,
    style: ShapeStyle,
) -> impl Iterator<Item = Element<(f64, f64)>> {
    points.iter().map(move |point| Element::Marker(*point, Shape::Circle, size, style))
}

/// Draws two rows below the panels: the Poisson ratios, then the meaning of lines, points and marks.
fn draw_legend(area: &Area, chart: &Chart) -> Drawn {
    let label = |words: &str, x: i32, y: i32| draw_label(area, words, x, y);
    let line = |x: i32, y: i32| vec![at(x, y), at(x + 26, y)];
    let circle =
        |x: i32, y: i32, size, style| Element::Marker(at(x, y), Shape::Circle, size, style);
    let (first, second) = (14, 40);
    label("Poisson ratio specified:", 72, first)?;
    for (k, (series, colour)) in chart.panels[0].1.iter().zip(COLOURS).enumerate() {
        let x = 250 + 90 * k as i32;
        let sample = Element::Line(line(x, first), pen(colour, 3));
        draw_all(area, &[sample, circle(x + 13, first, POINT, colour.filled())])?;
        label(&series.poisson_ratio.to_string(), x + 34, first)?;
    }
    let mut x = 72;
    if chart.kind == Kind::Stress {
        draw_all(area, &[Element::Line(line(x, second), pen(CURVE, 9))])?;
        label(&format!("{} Ef", chart.tissue), x + 36, second)?;
        x += 150;
    }
    draw_all(area, &[Element::Line(line(x, second), pen(TEXT, 2))])?;
    label("stable equilibrium", x + 36, second)?;
    x += 190;
    draw_all(area, &[circle(x + 13, second, POINT, TEXT.filled())])?;
    label("paper's 15 000 iterations", x + 30, second)?;
    x += 230;
    let cross = Element::Marker(at(x + 13, second), Shape::Cross, CROSS, pen(LOST, 2));
    draw_all(area, &[circle(x + 13, second, RING, pen(TEXT, 2)), cross])?;
    label("stability lost", x + 30, second)
}

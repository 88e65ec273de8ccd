//! Maps of stability: strain against Poisson ratio, under uniaxial and under equibiaxial tension.
//!
//! The colour is the least stiffness of the infinite sheet against a wave in its plane; lines mark the loss
//! of stability of the infinite sheet, of the finite sheet, and of the sheet out of its plane.

use crate::sample::STABILITY_THRESHOLD;
use crate::stability::Point;
use implant_preview_charts::page::{Area, Drawn, Page, at, draw_label, pen, text};
use implant_preview_charts::panel::{Axis, Element, Grid, Panel, draw_all, draw_panel};
use implant_preview_core::springs::stability::Load;
use implant_preview_core::study::contour::{Field, Path};
use plotters::prelude::*;

/// Content of a map.
#[derive(Clone, Debug)]
pub struct Map<'a> {
    /// The title.
    pub title: String,
    /// Strains of a row \[-\], rising.
    pub strains: &'a [f64],
    /// Poisson ratios of the rows \[-\], rising.
    pub poisson_ratios: &'a [f64],
    /// States under either load, row by row.
    pub panels: [(Load, Vec<Point>); 2],
    /// A line below the legend.
    pub note: String,
}

/// Size of the page \[px\].
const SIZE: (u32, u32) = (1040, 600);
const LEGEND_HEIGHT: u32 = 118;

/// Levels between the colours \[fraction of the edge stiffness\].
const LEVELS: [f64; 7] = [-1.0, -0.3, -0.1, 0.0, 0.1, 0.3, 1.0];
/// Unstable states in oranges, stable states in blues, darker away from neutral (after C. Brewer's
/// Oranges and Blues, colorbrewer2.org: distinguishable also with red–green colour blindness).
const COLOURS: [RGBColor; 8] = [
    RGBColor(0x8c, 0x2d, 0x04),
    RGBColor(0xd9, 0x5f, 0x0e),
    RGBColor(0xfb, 0x9a, 0x45),
    RGBColor(0xfe, 0xd0, 0x9a),
    RGBColor(0xe2, 0xee, 0xf8),
    RGBColor(0xbf, 0xd9, 0xee),
    RGBColor(0x8d, 0xbd, 0xe0),
    RGBColor(0x55, 0x98, 0xcb),
];

const LINE: RGBColor = RGBColor(0x1a, 0x1c, 0x20);
const SHEET: RGBColor = RGBColor(0xb0, 0x1e, 0x5a);
const OUT_OF_PLANE: RGBColor = RGBColor(0x4d, 0x56, 0x61);
/// Dash and gap of a line that is not solid \[px\].
const SHEET_DASH: (u32, u32) = (8, 5);
const OUT_OF_PLANE_DASH: (u32, u32) = (2, 4);

/// Draws the map as SVG text.
///
/// # Errors
/// An error of the drawing backend.
pub fn draw(map: &Map) -> Result<String, Box<dyn std::error::Error>> {
    let remark = "Least stiffness of an evenly stretched, infinite sheet against waves in its \
                  plane, as a share of its small-strain stiffness";
    let page = Page {
        size: SIZE,
        title: &map.title,
        remark: Some((remark, 17)),
        panels: map.panels.len(),
        legend_height: LEGEND_HEIGHT,
    };
    page.draw(|panels, legend| {
        for (area, (load, points)) in panels.iter().zip(&map.panels) {
            draw_load(area, map, *load, points)?;
        }
        draw_legend(legend, &map.note)
    })
}

fn draw_load(area: &Area, map: &Map, load: Load, points: &[Point]) -> Drawn {
    let end = |values: &[f64]| values.last().copied().unwrap_or(1.0);
    let (width, height) = (end(map.strains), end(map.poisson_ratios));
    let panel = Panel {
        caption: match load {
            Load::Uniaxial => "Pulled one way, free to narrow",
            Load::Equibiaxial => "Pulled both ways",
        },
        x: Axis {
            range: 0.0..width,
            name: "strain ε (–)",
            labels: 6,
            format: &|x| format!("{x:.1}"),
        },
        y: Axis {
            range: 0.0..height,
            name: "Poisson ratio ν (–)",
            labels: 6,
            format: &|y| format!("{y:.1}"),
        },
        grid: Grid::None,
        right_margin: 18,
        y_label_width: 62,
        label_size: 16,
    };
    let values = |f: fn(&Point) -> f64| points.iter().map(f).collect::<Vec<f64>>();
    let (waves, sheet) = (values(|p| p.wave.stiffness), values(|p| p.sheet));
    // Under tension the checkerboard loses its stability first.
    let out_of_plane = values(|p| p.out_of_plane[2]);
    let field = |values| Field { x: map.strains, y: map.poisson_ratios, values };
    let corners = vec![(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    let mut elements = vec![Element::Region(corners, COLOURS[0])];
    for (level, colour) in LEVELS.iter().zip(&COLOURS[1..]) {
        let region = joined(field(&waves).region(*level));
        elements.extend(region.map(|region| Element::Region(region, *colour)));
    }
    let zero = field(&out_of_plane).lines(0.0).into_iter();
    elements
        .extend(zero.map(|path| Element::Dashes(path, OUT_OF_PLANE_DASH, pen(OUT_OF_PLANE, 2))));
    let zero = field(&waves).lines(0.0).into_iter();
    elements.extend(zero.map(|path| Element::Line(path, pen(LINE, 3))));
    let zero = field(&sheet).lines(-STABILITY_THRESHOLD).into_iter();
    elements.extend(zero.map(|path| Element::Dashes(path, SHEET_DASH, pen(SHEET, 2))));
    draw_panel(area, panel, &elements)
}

/// Joins the borders of a region to one polygon: each border starts and ends at the first point of the
/// first border, and the connecting paths cancel.
fn joined(borders: Vec<Path>) -> Option<Path> {
    let start = *borders.first()?.first()?;
    let mut all = vec![start];
    for border in borders {
        all.extend(border);
        all.push(start);
    }
    Some(all)
}

/// Draws the colours with their levels, then the lines, then the note.
fn draw_legend(area: &Area, note: &str) -> Drawn {
    let label = |words: &str, x: i32, y: i32| draw_label(area, words, x, y);
    let (left, width, y) = (308, 62, 14);
    label("no stable even shape", left - 172, y)?;
    for (k, colour) in COLOURS.iter().enumerate() {
        let x = left + width * k as i32;
        area.draw(&Rectangle::new([at(x, y - 9), at(x + width, y + 9)], colour.filled()))?;
    }
    for (k, level) in LEVELS.iter().enumerate() {
        let x = left + width * (k as i32 + 1);
        let words = if *level < 0.0 { format!("−{}", -level) } else { level.to_string() };
        let shift = 3 * words.chars().count() as i32;
        area.draw_text(&words, &text(15), at(x - shift, y + 13))?;
    }
    label("stable", left + width * COLOURS.len() as i32 + 12, y)?;
    let middle = left + width * 4;
    let neutral = vec![at(middle, y - 9), at(middle, y + 9)];
    draw_all(area, &[Element::Line(neutral, pen(LINE, 3))])?;

    let y = 62;
    let line = |x: i32| vec![at(x, y), at(x + 40, y)];
    draw_all(area, &[Element::Line(line(76), pen(LINE, 3))])?;
    label("neutral, infinite sheet", 126, y)?;
    draw_all(area, &[Element::Dashes(line(320), SHEET_DASH, pen(SHEET, 2))])?;
    label("sheet of 4 × 4 cells, free border", 370, y)?;
    draw_all(area, &[Element::Dashes(line(640), OUT_OF_PLANE_DASH, pen(OUT_OF_PLANE, 2))])?;
    label("out of its plane, if nothing holds it", 690, y)?;
    label(note, 76, 92)
}

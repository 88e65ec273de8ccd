//! A map of stability as a picture: strain against Poisson ratio, pulled one way and both ways.
//!
//! The colour is the least stiffness of the infinite sheet against a wave in its plane; lines are
//! where it, the finite sheet, and the sheet out of its plane lose their stability.

use super::contour::{Field, Path};
use super::svg::{Area, Drawn, FINE, TEXT, at, font, page, pen};
use super::svg_backend::SvgBackend;
use crate::experiment::sample::STABILITY_THRESHOLD;
use crate::experiment::stability::Point;
use crate::springs::stability::Load;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// What is shown.
#[derive(Clone, Debug)]
pub struct Map<'a> {
    /// What it is a map of.
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

type Plane<'a, 'b> = ChartContext<'a, SvgBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Size in the page \[px\].
const SIZE: (u32, u32) = (1040, 600);
const TITLE_HEIGHT: u32 = 66;
const LEGEND_HEIGHT: u32 = 118;

/// Where one colour gives way to the next \[share of the edge stiffness\].
const LEVELS: [f64; 7] = [-1.0, -0.3, -0.1, 0.0, 0.1, 0.3, 1.0];
/// Unstable in oranges, stable in blues, the deeper the farther from neutral (after C. Brewer's
/// Oranges and Blues, colorbrewer2.org: told apart without red–green sight too).
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

/// The map as SVG text.
///
/// # Errors
/// What the drawing backend says.
pub fn draw(map: &Map) -> Result<String, Box<dyn std::error::Error>> {
    page(SIZE, |whole| {
        let title = font(25).style(FontStyle::Bold).color(&TEXT);
        whole.draw_text(&map.title, &title, at(24, 10))?;
        let remark = "Least stiffness of an evenly stretched, infinite sheet against waves in its \
                      plane, as a share of its small-strain stiffness";
        whole.draw_text(remark, &font(17).color(&TEXT), at(24, 40))?;
        let (_, below) = whole.split_vertically(FINE * TITLE_HEIGHT);
        let (panels, legend) =
            below.split_vertically(FINE * (SIZE.1 - TITLE_HEIGHT - LEGEND_HEIGHT));
        for (area, (load, points)) in panels.split_evenly((1, 2)).iter().zip(&map.panels) {
            draw_panel(area, map, *load, points)?;
        }
        draw_legend(&legend, &map.note)
    })
}

fn draw_panel(area: &Area, map: &Map, load: Load, points: &[Point]) -> Drawn {
    let text = |size: u32| font(size).color(&TEXT);
    let end = |values: &[f64]| values.last().copied().unwrap_or(1.0);
    let (width, height) = (end(map.strains), end(map.poisson_ratios));
    let name = match load {
        Load::Uniaxial => "Pulled one way, free to narrow",
        Load::Equibiaxial => "Pulled both ways",
    };
    let mut plane: Plane = ChartBuilder::on(area)
        .caption(name, text(20))
        .margin_left(FINE * 14)
        .margin_right(FINE * 18)
        .x_label_area_size(FINE * 50)
        .y_label_area_size(FINE * 62)
        .build_cartesian_2d(0.0..width, 0.0..height)?;
    let values = |f: fn(&Point) -> f64| points.iter().map(f).collect::<Vec<f64>>();
    let (waves, sheet) = (values(|p| p.wave.stiffness), values(|p| p.sheet));
    // Under tension the checkerboard is the first to go.
    let out_of_plane = values(|p| p.out_of_plane[2]);
    let field = |values| Field { x: map.strains, y: map.poisson_ratios, values };
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    plane.draw_series([Polygon::new(corners.to_vec(), COLOURS[0].filled())])?;
    for (level, colour) in LEVELS.iter().zip(&COLOURS[1..]) {
        if let Some(region) = joined(field(&waves).region(*level)) {
            plane.draw_series([Polygon::new(region, colour.filled())])?;
        }
    }
    for path in field(&out_of_plane).lines(0.0) {
        let (dash, gap) = OUT_OF_PLANE_DASH;
        plane.draw_series([dashed(path, dash, gap, pen(OUT_OF_PLANE, 2))])?;
    }
    for path in field(&waves).lines(0.0) {
        plane.draw_series([PathElement::new(path, pen(LINE, 3))])?;
    }
    for path in field(&sheet).lines(-STABILITY_THRESHOLD) {
        let (dash, gap) = SHEET_DASH;
        plane.draw_series([dashed(path, dash, gap, pen(SHEET, 2))])?;
    }
    plane
        .configure_mesh()
        .disable_mesh()
        .axis_style(pen(TEXT, 1))
        .set_all_tick_mark_size(FINE * 5)
        .x_desc("strain ε (–)")
        .y_desc("Poisson ratio ν (–)")
        .x_labels(6)
        .y_labels(6)
        .label_style(text(16))
        .axis_desc_style(text(17))
        .x_label_formatter(&|x| format!("{x:.1}"))
        .y_label_formatter(&|y| format!("{y:.1}"))
        .draw()?;
    Ok(())
}

fn dashed(
    path: Path,
    dash: u32,
    gap: u32,
    style: ShapeStyle,
) -> DashedPathElement<std::vec::IntoIter<(f64, f64)>, u32> {
    DashedPathElement::new(path, FINE * dash, FINE * gap, style)
}

/// All borders of a region as one polygon: each is gone around from the first point of the first one,
/// and the ways there and back cancel.
fn joined(borders: Vec<Path>) -> Option<Path> {
    let start = *borders.first()?.first()?;
    let mut all = vec![start];
    for border in borders {
        all.extend(border);
        all.push(start);
    }
    Some(all)
}

/// The colours with their levels, then the lines, then the note.
fn draw_legend(area: &Area, note: &str) -> Drawn {
    let text = font(17).color(&TEXT);
    let say = |words: &str, x: i32, y: i32| area.draw_text(words, &text, at(x, y - 7));
    let (left, width, y) = (308, 62, 14);
    say("no stable even shape", left - 172, y)?;
    for (k, colour) in COLOURS.iter().enumerate() {
        let x = left + width * k as i32;
        area.draw(&Rectangle::new([at(x, y - 9), at(x + width, y + 9)], colour.filled()))?;
    }
    let small = font(15).color(&TEXT);
    for (k, level) in LEVELS.iter().enumerate() {
        let x = left + width * (k as i32 + 1);
        let words = if *level < 0.0 { format!("−{}", -level) } else { level.to_string() };
        let shift = 3 * words.chars().count() as i32;
        area.draw_text(&words, &small, at(x - shift, y + 13))?;
    }
    say("stable", left + width * COLOURS.len() as i32 + 12, y)?;
    let middle = left + width * 4;
    area.draw(&PathElement::new([at(middle, y - 9), at(middle, y + 9)], pen(LINE, 3)))?;

    let y = 62;
    let line = |x: i32| [at(x, y), at(x + 40, y)];
    area.draw(&PathElement::new(line(76), pen(LINE, 3)))?;
    say("neutral, infinite sheet", 126, y)?;
    let (dash, gap) = SHEET_DASH;
    area.draw(&DashedPathElement::new(line(320), FINE * dash, FINE * gap, pen(SHEET, 2)))?;
    say("sheet of 4 × 4 cells, free border", 370, y)?;
    let (dash, gap) = OUT_OF_PLANE_DASH;
    let style = pen(OUT_OF_PLANE, 2);
    area.draw(&DashedPathElement::new(line(640), FINE * dash, FINE * gap, style))?;
    say("out of its plane, if nothing holds it", 690, y)?;
    say(note, 76, 92)?;
    Ok(())
}

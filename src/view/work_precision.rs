//! The study of run time against error as a picture: a panel a grid, a line a method.

use super::svg::{Area, Drawn, FINE, GRID, TEXT, at, font, page, pen};
use super::svg_backend::SvgBackend;
use crate::experiment::work_precision::{Case, Method, Row, Status, time_to};
use plotters::coord::combinators::LogCoord;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// Size in the page \[px\].
const SIZE: (u32, u32) = (1240, 560);
const TITLE_HEIGHT: u32 = 66;
const LEGEND_HEIGHT: u32 = 64;
/// The grids that are shown, where all of them were studied; else the finest ones.
const GRIDS: [usize; 3] = [65, 129, 257];
/// The error that matters to a reader \[share of the base radius\].
const MARK: f64 = 1e-3;
/// Errors shown: above 100 % is room for the times; what lies below stands on the lower edge.
const ERRORS: (f64, f64) = (1e-7, 100.0);

const OWN: RGBColor = RGBColor(0x6b, 0x72, 0x80);
const MARKED: RGBColor = RGBColor(0x2b, 0x2f, 0x36);

/// A line of the picture: its methods, name, colour (B. Wong, Nature Methods 8, 2011: told apart
/// without red–green sight too) and shape of its points.
struct Line {
    methods: &'static [Method],
    name: &'static str,
    colour: RGBColor,
    shape: Shape,
}

#[derive(Clone, Copy)]
enum Shape {
    Disc,
    Ring,
    Cross,
    Triangle,
    Square,
}

const LINES: [Line; 5] = [
    Line {
        methods: &[Method::Multigrid1, Method::Multigrid2, Method::Multigrid4, Method::Multigrid8],
        name: "full multigrid, 1–8 cycles",
        colour: RGBColor(0x00, 0x72, 0xb2),
        shape: Shape::Disc,
    },
    Line {
        methods: &[Method::Newton],
        name: "Newton, nested",
        colour: RGBColor(0x00, 0x9e, 0x73),
        shape: Shape::Square,
    },
    Line {
        methods: &[Method::GaussSeidel],
        name: "block Gauss–Seidel, nested",
        colour: RGBColor(0xe6, 0x9f, 0x00),
        shape: Shape::Triangle,
    },
    Line {
        methods: &[Method::ExplicitCritical],
        name: "explicit, critically damped",
        colour: RGBColor(0xcc, 0x79, 0xa7),
        shape: Shape::Ring,
    },
    Line {
        methods: &[Method::ExplicitPaper],
        name: "explicit, 15 000 steps",
        colour: RGBColor(0xd5, 0x5e, 0x00),
        shape: Shape::Cross,
    },
];

type Plane<'a, 'b> = ChartContext<'a, SvgBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

/// The rows of one scene as SVG text; three panels side by side.
///
/// # Errors
/// What the drawing backend says.
pub fn draw(rows: &[Row], case: Case) -> Result<String, Box<dyn std::error::Error>> {
    let rows: Vec<Row> = rows.iter().filter(|row| row.scene == case).copied().collect();
    let times = rows.iter().map(|row| row.time_ms.max(1e-3));
    let (least, most) = times.fold((1.0_f64, 100.0_f64), |(a, b), t| (a.min(t), b.max(t)));
    let times = (0.7 * least, 4.0 * most);
    page(SIZE, |whole| {
        let title = font(25).style(FontStyle::Bold).color(&TEXT);
        whole.draw_text("Run time against error", &title, at(24, 10))?;
        let remark = format!(
            "Scene “{}”, whole sheet, one thread. Error: greatest distance of a node from the grid's \
             own equilibrium, as a share of the dome's radius.",
            case.name()
        );
        whole.draw_text(&remark, &font(16).color(&TEXT), at(24, 40))?;
        let (_, below) = whole.split_vertically(FINE * TITLE_HEIGHT);
        let (panels, legend) =
            below.split_vertically(FINE * (SIZE.1 - TITLE_HEIGHT - LEGEND_HEIGHT));
        let grids = grids(&rows);
        for (k, (area, grid)) in panels.split_evenly((1, 3)).iter().zip(grids).enumerate() {
            draw_panel(area, &rows, grid, times, k == 0)?;
        }
        draw_legend(&legend)
    })
}

fn grids(rows: &[Row]) -> Vec<usize> {
    let mut all: Vec<usize> = rows.iter().map(|row| row.nodes_per_side).collect();
    all.sort_unstable();
    all.dedup();
    if GRIDS.iter().all(|grid| all.contains(grid)) {
        return GRIDS.to_vec();
    }
    all.split_off(all.len().saturating_sub(GRIDS.len()))
}

fn draw_panel(area: &Area, rows: &[Row], grid: usize, times: (f64, f64), is_first: bool) -> Drawn {
    let text = |size: u32| font(size).color(&TEXT);
    let mut plane: Plane = ChartBuilder::on(area)
        .caption(format!("{grid} nodes a side"), text(20))
        .margin_left(FINE * 14)
        .margin_right(FINE * 14)
        .x_label_area_size(FINE * 50)
        .y_label_area_size(FINE * if is_first { 72 } else { 46 })
        .build_cartesian_2d((times.0..times.1).log_scale(), (ERRORS.0..ERRORS.1).log_scale())?;
    plane
        .configure_mesh()
        .bold_line_style(pen(GRID, 1))
        .light_line_style(TRANSPARENT)
        .axis_style(pen(TEXT, 1))
        .set_all_tick_mark_size(FINE * 5)
        .x_desc("time from a cold start")
        .y_desc(if is_first { "error (share of the dome's radius)" } else { "" })
        .x_labels(6)
        .y_labels(8)
        .label_style(text(15))
        .axis_desc_style(text(17))
        .x_label_formatter(&|ms| time_label(*ms))
        .y_label_formatter(&|error| error_label(*error))
        .draw()?;
    let here: Vec<Row> = rows.iter().filter(|row| row.nodes_per_side == grid).copied().collect();
    let across = |error: f64| [(times.0, error), (times.1, error)];
    plane.draw_series(LineSeries::new(across(MARK), pen(MARKED, 1)))?;
    plane.draw_series([Text::new("0.1 %", (1.2 * times.0, 1.9 * MARK), text(15))])?;
    if let Some(error) = discretisation_error(&here) {
        let (dash, gap) = (FINE * 7, FINE * 5);
        let line = DashedPathElement::new(across(error), dash, gap, pen(OWN, 2));
        plane.draw_series([line])?;
        let words = Text::new("grid's own error", (1.2 * times.0, 0.85 * error), text(14));
        plane.draw_series([words])?;
    }
    let mut reached = Vec::new();
    for line in LINES.iter().rev() {
        let mut points: Vec<(Row, (f64, f64))> = here
            .iter()
            .filter(|row| line.methods.contains(&row.method) && row.status != Status::Failed)
            .map(|row| (*row, (row.time_ms, row.error_vs_own_grid.max(ERRORS.0))))
            .filter(|(row, _)| row.time_ms > 0.0)
            .collect();
        points.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let path = points.iter().map(|(_, point)| *point);
        plane.draw_series(LineSeries::new(path, pen(line.colour, 2)))?;
        for (_, point) in &points {
            mark(&mut plane, line, *point)?;
        }
        let rows: Vec<Row> = points.iter().map(|(row, _)| *row).collect();
        reached.extend(time_to(&rows, MARK).map(|time| (time, line.colour)));
    }
    // The times to the mark, below each other where they would overlap.
    reached.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (k, (time, colour)) in reached.iter().enumerate() {
        let error = ERRORS.1 * 0.72 / 2.6_f64.powi(k as i32);
        let foot = [(*time, error), (*time, MARK)];
        plane.draw_series(LineSeries::new(foot, colour.mix(0.5).stroke_width(FINE)))?;
        let words = font(17).style(FontStyle::Bold).color(colour);
        plane.draw_series([Text::new(format!(" {}", time_text(*time)), (*time, error), words)])?;
    }
    Ok(())
}

/// The error of a grid that no solver can undo: that of its own equilibrium against the reference.
fn discretisation_error(rows: &[Row]) -> Option<f64> {
    let own = |row: &&Row| row.method == Method::Newton && row.error_vs_own_grid < 1e-7;
    rows.iter().filter(own).find_map(|row| row.error_vs_reference)
}

fn mark(plane: &mut Plane, line: &Line, point: (f64, f64)) -> Drawn {
    let (size, filled) = (FINE * 4, line.colour.filled());
    match line.shape {
        Shape::Disc => plane.draw_series([Circle::new(point, size, filled)])?,
        Shape::Ring => {
            plane.draw_series([Circle::new(point, size, WHITE.filled())])?;
            plane.draw_series([Circle::new(point, size, pen(line.colour, 2))])?
        }
        Shape::Cross => plane.draw_series([Cross::new(point, size, pen(line.colour, 2))])?,
        Shape::Triangle => plane.draw_series([TriangleMarker::new(point, size + FINE, filled)])?,
        Shape::Square => {
            let half = FINE as i32 * 4;
            let square = Rectangle::new([(-half, -half), (half, half)], filled);
            plane.draw_series([EmptyElement::at(point) + square])?;
            return Ok(());
        }
    };
    Ok(())
}

fn draw_legend(area: &Area) -> Drawn {
    let text = font(17).color(&TEXT);
    let say = |words: &str, x: i32, y: i32| area.draw_text(words, &text, at(x, y - 7));
    for (k, line) in LINES.iter().enumerate() {
        let (x, y) = (40 + 236 * k as i32, 12);
        area.draw(&PathElement::new([at(x, y), at(x + 28, y)], pen(line.colour, 3)))?;
        let (middle, size, filled) = (at(x + 14, y), FINE * 4, line.colour.filled());
        match line.shape {
            Shape::Disc => area.draw(&Circle::new(middle, size, filled))?,
            Shape::Ring => {
                area.draw(&Circle::new(middle, size, WHITE.filled()))?;
                area.draw(&Circle::new(middle, size, pen(line.colour, 2)))?;
            }
            Shape::Cross => area.draw(&Cross::new(middle, size, pen(line.colour, 2)))?,
            Shape::Triangle => area.draw(&TriangleMarker::new(middle, size + FINE, filled))?,
            Shape::Square => {
                area.draw(&Rectangle::new([at(x + 10, y - 4), at(x + 18, y + 4)], filled))?;
            }
        }
        say(line.name, x + 36, y)?;
    }
    area.draw(&DashedPathElement::new([at(40, 40), at(68, 40)], FINE * 7, FINE * 4, pen(OWN, 2)))?;
    say(
        "error of the grid's own equilibrium against the axisymmetric solution: below it more work \
         gains nothing",
        76,
        40,
    )?;
    Ok(())
}

/// A power of ten as an axis says it: `10 ms`, `1 s`.
fn time_label(ms: f64) -> String {
    if ms >= 999.0 { format!("{} s", short(ms / 1000.0)) } else { format!("{} ms", short(ms)) }
}

/// A time with two digits.
fn time_text(ms: f64) -> String {
    let digits =
        |value: f64| if value < 9.95 { format!("{value:.1}") } else { format!("{value:.0}") };
    if ms >= 999.5 { format!("{} s", digits(ms / 1000.0)) } else { format!("{} ms", digits(ms)) }
}

fn error_label(error: f64) -> String {
    if error > 1.5 {
        return String::new();
    }
    format!("{} %", short(100.0 * error))
}

fn short(value: f64) -> String {
    // Powers of ten come with rounding.
    let digits = (-value.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}

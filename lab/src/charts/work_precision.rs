//! Work–precision diagram: error against run time, a panel per grid, a line per method.

use crate::work_precision::{Case, Method, Row, Status, time_to};
use implant_preview_charts::page::{Area, Drawn, FINE, Page, at, draw_label, font, pen, text};
use implant_preview_charts::panel::{Axis, Element, Grid, Panel, Shape, draw_all, draw_panel};
use plotters::prelude::*;

/// Size of the page \[px\].
const SIZE: (u32, u32) = (1240, 560);
const LEGEND_HEIGHT: u32 = 64;
/// Nodes per side of the panels if the study has all of them; otherwise its finest grids.
const GRIDS: [usize; 3] = [65, 129, 257];
/// Marked error, the accuracy that a reader needs \[fraction of the base radius\].
const MARK: f64 = 1e-3;
/// Range of the errors \[fraction of the base radius\]: the space above 100 % contains the times; smaller
/// errors are drawn at the lower edge.
const ERRORS: (f64, f64) = (1e-7, 100.0);

const OWN: RGBColor = RGBColor(0x6b, 0x72, 0x80);
const MARKED: RGBColor = RGBColor(0x2b, 0x2f, 0x36);
/// Size of a marker \[px\].
const MARKER: u32 = 4;

/// A line of the chart: its methods, name, colour (B. Wong, Nature Methods 8, 2011: distinguishable
/// also with red–green colour blindness) and marker.
#[derive(Clone, Copy)]
struct Line {
    methods: &'static [Method],
    name: &'static str,
    colour: RGBColor,
    marker: Shape,
}

impl Line {
    fn marker_at<P>(&self, point: P) -> Element<P> {
        Element::Marker(point, self.marker, MARKER, self.colour.filled())
    }
}

const LINES: [Line; 2] = [
    Line {
        methods: &[Method::Multigrid1, Method::Multigrid2, Method::Multigrid4, Method::Multigrid8],
        name: "full multigrid, 1–8 cycles",
        colour: RGBColor(0x00, 0x72, 0xb2),
        marker: Shape::Circle,
    },
    Line {
        methods: &[Method::Newton],
        name: "Newton, nested",
        colour: RGBColor(0x00, 0x9e, 0x73),
        marker: Shape::Square,
    },
];

/// The lines of layered tissue.
const LAYERED_LINES: [Line; 3] = [
    LINES[0],
    LINES[1],
    Line {
        methods: &[Method::Automatic],
        name: "automatic, to 1, 0.1, 0.01 %",
        colour: RGBColor(0xd5, 0x5e, 0x00),
        marker: Shape::Triangle,
    },
];

fn lines(case: Case) -> &'static [Line] {
    if case.is_layered() { &LAYERED_LINES } else { &LINES }
}

/// Draws the rows of one scene as SVG text; three panels side by side.
///
/// # Errors
/// An error of the drawing backend.
pub fn draw(rows: &[Row], case: Case) -> Result<String, Box<dyn std::error::Error>> {
    let rows: Vec<Row> = rows.iter().filter(|row| row.scene == case).copied().collect();
    let times = rows.iter().map(|row| row.time_ms.max(1e-3));
    let (least, most) = times.fold((1.0_f64, 100.0_f64), |(a, b), t| (a.min(t), b.max(t)));
    let times = (0.7 * least, 4.0 * most);
    let remark = format!(
        "Scene “{}”, whole {}, one thread. Error: greatest distance of a node from the grid's \
         own equilibrium, as a share of the dome's radius.",
        case.name(),
        if case.is_layered() { "patch" } else { "sheet" }
    );
    let page = Page {
        size: SIZE,
        title: "Run time against error",
        remark: Some((&remark, 16)),
        panels: GRIDS.len(),
        legend_height: LEGEND_HEIGHT,
    };
    page.draw(|panels, legend| {
        for (k, (area, grid)) in panels.iter().zip(grids(&rows)).enumerate() {
            draw_grid(area, &rows, grid, times, (k == 0, lines(case)))?;
        }
        draw_legend(legend, lines(case))
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

fn draw_grid(
    area: &Area,
    rows: &[Row],
    grid: usize,
    times: (f64, f64),
    (is_first, lines): (bool, &[Line]),
) -> Drawn {
    let panel = Panel {
        caption: &format!("{grid} nodes a side"),
        x: Axis {
            range: (times.0..times.1).log_scale(),
            name: "time from a cold start",
            labels: 6,
            format: &|ms| time_label(*ms),
        },
        y: Axis {
            range: (ERRORS.0..ERRORS.1).log_scale(),
            name: if is_first { "error (share of the dome's radius)" } else { "" },
            labels: 8,
            format: &|error| error_label(*error),
        },
        grid: Grid::Lines,
        right_margin: 14,
        y_label_width: if is_first { 72 } else { 46 },
        label_size: 15,
    };
    let here: Vec<Row> = rows.iter().filter(|row| row.nodes_per_side == grid).copied().collect();
    let across = |error: f64| vec![(times.0, error), (times.1, error)];
    let left = 1.2 * times.0;
    let mut elements = vec![
        Element::Line(across(MARK), pen(MARKED, 1)),
        Element::Text((left, 1.9 * MARK), "0.1 %".to_owned(), text(15)),
    ];
    if let Some(error) = discretisation_error(&here) {
        elements.push(Element::Dashes(across(error), (7, 5), pen(OWN, 2)));
        let words = "grid's own error".to_owned();
        elements.push(Element::Text((left, 0.85 * error), words, text(14)));
    }
    let mut reached = Vec::new();
    for line in lines.iter().rev() {
        let mut rows: Vec<Row> = here
            .iter()
            .filter(|row| line.methods.contains(&row.method) && row.status != Status::Failed)
            .filter(|row| row.time_ms > 0.0)
            .copied()
            .collect();
        rows.sort_by(|a, b| a.time_ms.total_cmp(&b.time_ms));
        let points: Vec<(f64, f64)> =
            rows.iter().map(|row| (row.time_ms, row.error_vs_own_grid.max(ERRORS.0))).collect();
        elements.push(Element::Line(points.clone(), pen(line.colour, 2)));
        elements.extend(points.into_iter().map(|point| line.marker_at(point)));
        reached.extend(time_to(&rows, MARK).map(|time| (time, line.colour)));
    }
    // The times at the marked error, one below the other.
    reached.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (k, (time, colour)) in reached.into_iter().enumerate() {
        let error = ERRORS.1 * 0.72 / 2.6_f64.powi(k as i32);
        let stem = vec![(time, error), (time, MARK)];
        elements.push(Element::Line(stem, colour.mix(0.5).stroke_width(FINE)));
        let style = font(17).style(FontStyle::Bold).color(&colour);
        elements.push(Element::Text((time, error), format!(" {}", time_text(time)), style));
    }
    draw_panel(area, panel, &elements)
}

/// The discretisation error: the error of the grid's own equilibrium against the reference.
fn discretisation_error(rows: &[Row]) -> Option<f64> {
    let own = |row: &&Row| {
        let most = if row.scene.is_layered() { 1e-4 } else { 1e-7 };
        matches!(row.method, Method::Newton | Method::Automatic) && row.error_vs_own_grid < most
    };
    rows.iter().filter(own).find_map(|row| row.error_vs_reference)
}

fn draw_legend(area: &Area, lines: &[Line]) -> Drawn {
    for (k, line) in lines.iter().enumerate() {
        let (x, y) = (40 + 236 * k as i32, 12);
        let sample = Element::Line(vec![at(x, y), at(x + 28, y)], pen(line.colour, 3));
        draw_all(area, &[sample, line.marker_at(at(x + 14, y))])?;
        draw_label(area, line.name, x + 36, y)?;
    }
    draw_all(area, &[Element::Dashes(vec![at(40, 40), at(68, 40)], (7, 4), pen(OWN, 2))])?;
    draw_label(
        area,
        "error of the grid's own equilibrium against the axisymmetric solution: below it more work \
         gains nothing; explicit steps, Gauss–Seidel: assets/bench, measured earlier",
        76,
        40,
    )
}

/// A power of ten as an axis label: `10 ms`, `1 s`.
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
    // Powers of ten contain rounding errors.
    let digits = (-value.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}

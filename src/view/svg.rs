//! SVG pages drawn with plotters: sizes in px, text, lines, and the page as text.
//!
//! The backend rounds to whole units: everything is drawn [`FINE`] times larger and scaled down.

use super::svg_backend::SvgBackend;
use plotters::prelude::*;

/// How much larger the backend draws.
pub const FINE: u32 = 8;
/// Colour of text and axes.
pub const TEXT: RGBColor = RGBColor(0x2b, 0x2f, 0x36);
/// Colour of the lines of a grid.
pub const GRID: RGBColor = RGBColor(0xe3, 0xe6, 0xea);

/// What the backend draws on.
pub type Area<'a> = DrawingArea<SvgBackend<'a>, plotters::coord::Shift>;
/// How drawing ends.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A page of the given width and height \[px\] as SVG text; `draw` fills it.
///
/// # Errors
/// What `draw` or the backend says.
pub fn page(
    (width, height): (u32, u32),
    draw: impl FnOnce(&Area) -> Drawn,
) -> Result<String, Box<dyn std::error::Error>> {
    let mut svg = String::new();
    let drawn = (FINE * width, FINE * height);
    {
        let whole = SvgBackend::new(&mut svg, drawn).into_drawing_area();
        whole.fill(&WHITE)?;
        draw(&whole)?;
        whole.present()?;
    }
    Ok(svg.replacen(
        &format!("width=\"{}\" height=\"{}\"", drawn.0, drawn.1),
        &format!("width=\"{width}\" height=\"{height}\""),
        1,
    ))
}

/// A font of the given size; the backend shows it at four fifths of that \[px\].
#[must_use]
pub fn font(size: u32) -> FontDesc<'static> {
    ("sans-serif", FINE * size).into_font()
}

/// A place in px, in the backend's units.
#[must_use]
pub fn at(x: i32, y: i32) -> (i32, i32) {
    (FINE as i32 * x, FINE as i32 * y)
}

/// A line of the given width \[px\].
#[must_use]
pub fn pen(colour: RGBColor, width: u32) -> ShapeStyle {
    colour.stroke_width(FINE * width)
}

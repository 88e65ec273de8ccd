//! Layout of a chart: a page with a title, panels side by side and a legend; sizes in px.
//!
//! The backend rounds to whole units; every length is drawn [`FINE`] times larger and scaled down.

use crate::backend::SvgBackend;
use plotters::prelude::*;

/// Scale factor from px to the backend's units.
pub const FINE: u32 = 8;
/// Colour of text and axes.
pub const TEXT: RGBColor = RGBColor(0x2b, 0x2f, 0x36);
/// Colour of grid lines.
pub const GRID: RGBColor = RGBColor(0xe3, 0xe6, 0xea);

/// Height of the title \[px\], without and with a remark below it.
const TITLE_HEIGHT: (u32, u32) = (40, 66);
/// Top of the title \[px\], without and with a remark below it.
const TITLE_TOP: (i32, i32) = (12, 10);
const REMARK_TOP: i32 = 40;
const LEFT: i32 = 24;

/// A rectangle of the page, in the backend's units.
pub type Area<'a> = DrawingArea<SvgBackend<'a>, plotters::coord::Shift>;
/// Result of a drawing function.
pub type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A chart's page without its panels' content.
pub struct Page<'a> {
    /// Width and height \[px\].
    pub size: (u32, u32),
    /// Title in bold.
    pub title: &'a str,
    /// Line below the title and its font size \[px\].
    pub remark: Option<(&'a str, u32)>,
    /// Number of panels, side by side.
    pub panels: usize,
    /// Height of the legend below the panels \[px\].
    pub legend_height: u32,
}

impl Page<'_> {
    /// Draws the page as SVG text; `fill` draws the panels and the legend.
    ///
    /// # Errors
    /// An error of `fill` or of the backend.
    pub fn draw(
        &self,
        fill: impl FnOnce(&[Area], &Area) -> Drawn,
    ) -> Result<String, Box<dyn std::error::Error>> {
        let (width, height) = self.size;
        let mut svg = String::new();
        let drawn = (FINE * width, FINE * height);
        {
            let whole = SvgBackend::new(&mut svg, drawn).into_drawing_area();
            whole.fill(&WHITE)?;
            let style = font(25).style(FontStyle::Bold).color(&TEXT);
            let (top, title_height) = match self.remark {
                None => (TITLE_TOP.0, TITLE_HEIGHT.0),
                Some(_) => (TITLE_TOP.1, TITLE_HEIGHT.1),
            };
            whole.draw_text(self.title, &style, at(LEFT, top))?;
            if let Some((remark, size)) = self.remark {
                whole.draw_text(remark, &text(size), at(LEFT, REMARK_TOP))?;
            }
            let (_, below) = whole.split_vertically(FINE * title_height);
            let panel_height = height - title_height - self.legend_height;
            let (panels, legend) = below.split_vertically(FINE * panel_height);
            fill(&panels.split_evenly((1, self.panels)), &legend)?;
            whole.present()?;
        }
        Ok(svg.replacen(
            &format!("width=\"{}\" height=\"{}\"", drawn.0, drawn.1),
            &format!("width=\"{width}\" height=\"{height}\""),
            1,
        ))
    }
}

/// Draws a legend's text with its middle at the height `y` \[px\].
///
/// # Errors
/// An error of the backend.
pub fn draw_label(area: &Area, words: &str, x: i32, y: i32) -> Drawn {
    Ok(area.draw_text(words, &text(17), at(x, y - 7))?)
}

/// A font of the given size; the backend displays four fifths of the size \[px\].
pub fn font(size: u32) -> FontDesc<'static> {
    ("sans-serif", FINE * size).into_font()
}

/// The style of plain text of the given size \[px\].
pub fn text(size: u32) -> TextStyle<'static> {
    font(size).color(&TEXT)
}

/// Converts a position from px to the backend's units.
pub fn at(x: i32, y: i32) -> (i32, i32) {
    (FINE as i32 * x, FINE as i32 * y)
}

/// A line style of the given width \[px\].
pub fn pen(colour: RGBColor, width: u32) -> ShapeStyle {
    colour.stroke_width(FINE * width)
}

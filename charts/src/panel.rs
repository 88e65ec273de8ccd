//! A panel of a chart: caption, axes, ticks, labels and the elements of its series.

use crate::backend::SvgBackend;
use crate::page::{Area, Drawn, FINE, GRID, TEXT, pen, text};
use plotters::coord::CoordTranslate;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::element::DashedPathElement;
use plotters::prelude::*;

/// An axis over a linear or logarithmic range of values.
pub struct Axis<'a, R> {
    /// First and last value, in the unit of the name.
    pub range: R,
    /// Name with its unit.
    pub name: &'a str,
    /// Greatest number of labels.
    pub labels: usize,
    /// Text of a label.
    pub format: &'a dyn Fn(&f64) -> String,
}

/// Grid lines of a panel.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Grid {
    /// Lines at the labels, below the series.
    Lines,
    /// No lines; the axes are drawn above the series.
    None,
}

/// A panel without its series.
pub struct Panel<'a, X, Y> {
    /// Text above the panel; empty for none.
    pub caption: &'a str,
    /// Horizontal axis.
    pub x: Axis<'a, X>,
    /// Vertical axis.
    pub y: Axis<'a, Y>,
    /// Grid lines.
    pub grid: Grid,
    /// Distance of the plane from the panel's right end \[px\].
    pub right_margin: u32,
    /// Width of the labels of the y axis \[px\].
    pub y_label_width: u32,
    /// Font size of the labels \[px\].
    pub label_size: u32,
}

/// Shape of a marker.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A circle around the point.
    Circle,
    /// Two diagonal lines.
    Cross,
    /// A triangle that stands on its side.
    Triangle,
    /// A square around the point.
    Square,
}

/// A graphic element at points of type `P`: values in a panel, the backend's units in a legend.
#[derive(Clone)]
pub enum Element<P> {
    /// A polygon, filled.
    Region(Vec<P>, RGBColor),
    /// A polyline.
    Line(Vec<P>, ShapeStyle),
    /// A polyline with dash and gap \[px\].
    Dashes(Vec<P>, (u32, u32), ShapeStyle),
    /// A marker with its radius or half width \[px\].
    Marker(P, Shape, u32, ShapeStyle),
    /// A text that starts at the point.
    Text(P, String, TextStyle<'static>),
}

/// Draws the panel and its elements, one above the other.
///
/// # Errors
/// An error of the backend.
pub fn draw_panel<X, Y>(area: &Area, panel: Panel<X, Y>, elements: &[Element<(f64, f64)>]) -> Drawn
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut plane = ChartBuilder::on(area)
        .caption(panel.caption, text(20))
        .margin_left(FINE * 14)
        .margin_right(FINE * panel.right_margin)
        .x_label_area_size(FINE * 50)
        .y_label_area_size(FINE * panel.y_label_width)
        .build_cartesian_2d(panel.x.range, panel.y.range)?;
    if panel.grid == Grid::None {
        draw_all(plane.plotting_area(), elements)?;
    }
    let mut mesh = plane.configure_mesh();
    match panel.grid {
        Grid::Lines => mesh.bold_line_style(pen(GRID, 1)).light_line_style(TRANSPARENT),
        Grid::None => mesh.disable_mesh(),
    };
    mesh.axis_style(pen(TEXT, 1))
        .set_all_tick_mark_size(FINE * 5)
        .x_desc(panel.x.name)
        .y_desc(panel.y.name)
        .x_labels(panel.x.labels)
        .y_labels(panel.y.labels)
        .label_style(text(panel.label_size))
        .axis_desc_style(text(17))
        .x_label_formatter(panel.x.format)
        .y_label_formatter(panel.y.format)
        .draw()?;
    if panel.grid == Grid::Lines {
        draw_all(plane.plotting_area(), elements)?;
    }
    Ok(())
}

/// Draws elements in a panel's plane or in a legend.
///
/// # Errors
/// An error of the backend.
pub fn draw_all<C: CoordTranslate>(
    area: &DrawingArea<SvgBackend, C>,
    elements: &[Element<C::From>],
) -> Drawn
where
    C::From: Clone + 'static,
{
    for element in elements {
        match element.clone() {
            Element::Region(points, colour) => {
                area.draw(&Polygon::new(points, colour.filled()))?;
            }
            Element::Line(points, _) if points.is_empty() => {}
            Element::Line(points, style) => area.draw(&PathElement::new(points, style))?,
            Element::Dashes(points, (dash, gap), style) => {
                area.draw(&DashedPathElement::new(points, FINE * dash, FINE * gap, style))?;
            }
            Element::Marker(point, shape, size, style) => {
                let size = FINE * size;
                match shape {
                    Shape::Circle => area.draw(&Circle::new(point, size, style))?,
                    Shape::Cross => area.draw(&Cross::new(point, size, style))?,
                    // The triangle's area is closer to the circle's with a larger radius.
                    Shape::Triangle => {
                        area.draw(&TriangleMarker::new(point, size + FINE, style))?;
                    }
                    Shape::Square => {
                        let half = size as i32;
                        let square = Rectangle::new([(-half, -half), (half, half)], style);
                        area.draw(&(EmptyElement::at(point) + square))?;
                    }
                }
            }
            Element::Text(point, words, style) => area.draw(&Text::new(words, point, style))?,
        }
    }
    Ok(())
}

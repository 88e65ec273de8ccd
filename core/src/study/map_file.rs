//! A map as a table (CSV) and as JSON.

use super::{
    Axis, Case, Difference, Map, MapCheck, MapSettings, PointStatus, Quantity, Source, Values,
    same_words,
};
use crate::export::number;
use crate::measure::bands::Band;
use crate::scene::Scene;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The schema of [`MapFile`].
pub const MAP_SCHEMA: &str = "implant-preview/map/1";

/// A map in a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MapFile {
    /// `implant-preview/map/1`.
    pub schema: &'static str,
    /// Sentences on pocket, tolerance and accuracy.
    pub notes: Vec<String>,
    /// The scene around which the axes vary.
    pub scene: Scene,
    /// Grid and tolerance of the points.
    pub grid: MapSettings,
    /// The axes, x first.
    pub axes: Vec<AxisFile>,
    /// The quantity of the contours.
    pub show: Quantity,
    /// Unit of the quantity; empty for a fraction.
    pub unit: &'static str,
    /// Number of points by state.
    pub counts: BTreeMap<&'static str, usize>,
    /// Work of all points \[evaluations of all nodal forces\].
    pub evaluations: f64,
    /// Number of solved points; the others are interpolated.
    pub scenes_solved: usize,
    /// The points row by row: x varies fastest.
    pub points: Vec<PointFile>,
    /// Contour lines of the shown quantity.
    pub contours: Vec<ContourFile>,
    /// Greatest differences from the same scenes at 129 nodes per side.
    pub check: Option<CheckFile>,
    /// Warnings of the results, with the number of points.
    pub warnings: BTreeMap<String, usize>,
}

/// An axis in a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AxisFile {
    /// The axis.
    #[serde(flatten)]
    pub axis: Axis,
    /// The field in words.
    pub label: String,
    /// Unit of the values.
    pub unit: &'static str,
    /// The value of the scene, if it lies on the map.
    pub present: Option<f64>,
}

/// A point in a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PointFile {
    /// Values of the axes.
    pub at: Vec<f64>,
    /// How the solve ended.
    pub status: PointStatus,
    /// Radius of the pocket \[mm\]; `None` for an invalid scene.
    pub pocket_radius_mm: Option<f64>,
    /// The quantities; empty without a shape.
    pub values: Values,
    /// Where status and values come from; absent of a point about which nothing is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
    /// Errors of interpolated quantities.
    #[serde(skip_serializing_if = "Values::is_empty")]
    pub errors: Values,
    /// Why the scene is invalid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// The contour lines of one level.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ContourFile {
    /// The level \[unit of the quantity\].
    pub level: f64,
    /// Word for values above the level, if the level is a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub above: Option<&'static str>,
    /// Origin of the limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<&'static str>,
    /// Polylines of (x, y).
    #[schemars(with = "Vec<Vec<[f64; 2]>>")]
    pub lines: Vec<Vec<(f64, f64)>>,
}

/// The check of a map in a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CheckFile {
    /// Grid and tolerance of the check.
    pub grid: MapSettings,
    /// Number of checked points.
    pub points: usize,
    /// Number of checked points that converged.
    pub converged: usize,
    /// The greatest difference of each quantity.
    pub differences: Vec<Difference>,
}

impl Map {
    /// Sentences on this map: grid, tolerance, pocket, points without a value.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let MapSettings { nodes_per_side, tolerance } = self.settings();
        let mut notes = vec![format!(
            "Points: {nodes_per_side} nodes per side, positions within {tolerance} of the base radius; grid and tolerance of \
             the scene do not apply."
        )];
        if self.pocket_follows() {
            notes.push(
                "The pocket follows the implant: its margin around the implant is that of the scene, and its radius is at \
                 most 200 mm."
                    .to_owned(),
            );
        }
        let counts = self.counts();
        if self.is_sampled() {
            let is_whole = counts.iter().all(|(s, _)| *s != PointStatus::Waiting);
            notes.push(format!(
                "{} of {} points are solved, {}.",
                self.scenes_solved() - self.solved_in_full(),
                self.cases().len(),
                if is_whole {
                    "the others are interpolated, with an error of each quantity"
                } else {
                    "the run ended before all others were interpolated"
                }
            ));
        }
        let in_full = self.solved_in_full();
        if in_full > 0 {
            notes.push(format!(
                "{in_full} points at the border of no answer are solved as `simulate` does."
            ));
        }
        let counts = counts.into_iter().filter(|(s, _)| *s != PointStatus::Converged);
        let missing: Vec<String> =
            counts.map(|(status, count)| format!("{count} {}", status.word())).collect();
        if !missing.is_empty() {
            notes.push(format!("Points without a value: {}.", missing.join(", ")));
        }
        notes
    }

    /// The map for a JSON file.
    #[must_use]
    pub fn file(&self, show: Quantity, check: Option<&MapCheck>) -> MapFile {
        let present = self.present();
        let axis = |(k, axis): (usize, &Axis)| {
            let (label, unit) = axis.field.label();
            AxisFile { axis: *axis, label, unit, present: present.map(|at| at[k]) }
        };
        let warnings =
            same_words::counted(self.cases().iter().flatten().flat_map(|case| &case.warnings));
        let limits = self.limits(show).map(|(limits, _)| limits.bands);
        let bands: &[Band] = limits.as_deref().unwrap_or_default();
        let contour = |(k, level): (usize, f64)| ContourFile {
            level,
            above: bands.get(k + 1).map(|band| band.word),
            source: bands.get(k).map(|band| band.source),
            lines: self.contours(show, level),
        };
        let mut notes = self.notes();
        let counts = self.counts();
        let has_answers = counts.iter().any(|(status, _)| *status == PointStatus::Converged);
        if has_answers && self.range(show).is_none() {
            notes.push(format!("No point has a value of {}.", show.name()));
        }
        MapFile {
            schema: MAP_SCHEMA,
            notes,
            scene: self.base().clone(),
            grid: self.settings(),
            axes: self.axes().iter().enumerate().map(axis).collect(),
            show,
            unit: show.unit(),
            counts: counts.into_iter().map(|(s, count)| (s.word(), count)).collect(),
            evaluations: self.cases().iter().flatten().map(|case| case.evaluations).sum(),
            scenes_solved: self.scenes_solved(),
            points: self.points(),
            contours: self.levels(show).into_iter().enumerate().map(contour).collect(),
            check: check.map(|check| {
                let (points, converged) = check.counts();
                let differences = self.differences(check);
                CheckFile { grid: super::CHECK, points, converged, differences }
            }),
            warnings,
        }
    }

    /// A point for a JSON file.
    #[must_use]
    pub fn point(&self, i: usize, j: usize) -> PointFile {
        let (case, source) = (self.case(i, j), self.source(i, j));
        let is_interpolated = source == Some(Source::Interpolated);
        let interpolated = |quantity: Quantity| self.interpolated(quantity, i, j);
        let of_interpolated = |which: fn((f64, f64)) -> f64| {
            let known = |quantity: &Quantity| Some((*quantity, which(interpolated(*quantity)?)));
            let known = Quantity::ALL.iter().filter(|_| is_interpolated).filter_map(known);
            Values::from(known.collect::<BTreeMap<_, _>>())
        };
        PointFile {
            at: self.axes().iter().zip([i, j]).map(|(axis, k)| axis.value(k)).collect(),
            status: self.status(i, j),
            pocket_radius_mm: self.scene(i, j).ok().map(|scene| scene.pocket_radius_mm),
            values: case.map_or_else(|| of_interpolated(|of| of.0), |case| case.values),
            source,
            errors: of_interpolated(|of| of.1),
            error: case.and_then(|case: &Case| case.error.clone()),
        }
    }

    fn points(&self) -> Vec<PointFile> {
        let (columns, rows) = self.shape();
        (0..rows).flat_map(|j| (0..columns).map(move |i| self.point(i, j))).collect()
    }

    /// The map as a table: a row for each point, x varies fastest; a value that does not apply is empty. Values of points
    /// that have not converged carry this status. The last columns are where the values come from, and the errors of interpolated ones.
    #[must_use]
    pub fn csv(&self) -> String {
        let names = self.axes().iter().map(|axis| axis.field.name());
        let mut columns: Vec<String> = names.collect();
        columns.extend(["status".to_owned(), "pocket_radius_mm".to_owned()]);
        columns.extend(Quantity::ALL.map(|quantity| quantity.name().to_owned()));
        columns.push("source".to_owned());
        columns.extend(Quantity::ALL.map(|quantity| format!("{}_error", quantity.name())));
        let mut table = columns.join(",") + "\n";
        let cell = |value: Option<f64>| value.map(number).unwrap_or_default();
        for point in self.points() {
            let mut row: Vec<String> = point.at.iter().map(|value| number(*value)).collect();
            row.extend([point.status.word().to_owned(), cell(point.pocket_radius_mm)]);
            row.extend(Quantity::ALL.map(|quantity| cell(point.values.get(quantity))));
            row.push(point.source.map_or("", Source::word).to_owned());
            row.extend(Quantity::ALL.map(|quantity| cell(point.errors.get(quantity))));
            // Writing to a String cannot fail.
            let _ = writeln!(table, "{}", row.join(","));
        }
        table
    }
}

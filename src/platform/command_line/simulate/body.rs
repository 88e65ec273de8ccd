//! The surface of a body over the implant of a scene that was made of it.

use super::super::measures::{BodyMeasures, rounded};
use super::super::output::{self, File};
use super::super::{InputError, scan};
use super::Arguments;
use crate::body::deform::{deform, deform_marks, gained_ml};
use crate::body::fit::{Settings, fit};
use crate::body::frame::Frame;
use crate::body::marks::{Marks, Side};
use crate::body::mound::change;
use crate::body::pick::snap;
use crate::body::read::Unit;
use crate::body::surface::Surface;
use crate::body::write::write;
use crate::export::Format;
use crate::scene::Scene;
use crate::solve::Solution;
use glam::DVec3;
use std::path::Path;

/// Greatest distance of a nipple's mark from the surface of the body that it belongs to \[mm\].
const OFF_MM: f64 = 25.0;
/// Greatest median distance of the marks, or else of the skin over the pocket, from that surface \[mm\]: marks may be off, and a thickness edited.
const MEDIAN_MM: f64 = 3.0;
/// About so many nodes of the skin are held against the surface.
const NODES: usize = 40;

/// The surface before the implant.
pub(super) struct Body<'a> {
    surface: Surface,
    marks: Marks,
    side: Side,
    cover_mm: f64,
    frame: Frame,
    unit: Unit,
    format: Format,
    after: &'a Path,
}

/// Some places of a scene's skin over the pocket, in the coordinates of the body.
fn skin(scene: &Scene, frame: &Frame) -> Result<Vec<DVec3>, InputError> {
    let rest = scene.problem().map_err(|error| InputError(error.to_string()))?.rest;
    let nodes = rest.nodes(rest.layers() - 1);
    let over: Vec<DVec3> =
        nodes.filter(|at| at.truncate().length() < scene.pocket_radius_mm).collect();
    let places = over.iter().step_by((over.len() / NODES).max(1));
    Ok(places.map(|at| frame.point(*at)).collect())
}

/// The middle one of some distances; 0 without one.
fn median(distances: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = distances.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

impl<'a> Body<'a> {
    /// The body of the arguments, if there is one.
    pub(super) fn open(
        arguments: &'a Arguments,
        scene: &Scene,
    ) -> Result<Option<Self>, InputError> {
        let (Some(path), Some(after)) = (&arguments.body, &arguments.after) else {
            return Ok(None);
        };
        let format = super::format_of(after, "--after")?;
        let Some(placement) = &scene.placement else {
            let line = "--body: the scene has no member body; allowed: a scene that `scan` wrote";
            return Err(InputError(line.to_owned()));
        };
        let unit = Unit::from(placement.unit);
        let surface = scan::surface(path, Some(unit))?.surface;
        let side = if scene.is_right() { Side::Right } else { Side::Left };
        let (marks, cover_mm) = (placement.marks, placement.cover_mm);
        let frame = placement.frame();
        let off = |at: DVec3| snap(&surface, at).map_or(f64::INFINITY, |on| on.point.distance(at));
        let named = marks.named(side).map_err(|error| output::input_error(path, error))?;
        let of_nipple = off(marks.nipple(side));
        let of_marks = median(named.iter().map(|(_, at)| off(*at)));
        let is_off = of_nipple > OFF_MM
            || of_marks > MEDIAN_MM
                && median(skin(scene, &frame)?.into_iter().map(off)) > MEDIAN_MM;
        if is_off {
            let line = format!(
                "--body: of the scene's marks half are more than {of_marks:.0} mm off the surface, its nipple {of_nipple:.0} mm; allowed: the surface that the scene was made of"
            );
            return Err(output::input_error(path, line));
        }
        Ok(Some(Self { surface, marks, side, cover_mm, frame, unit, format, after }))
    }

    /// The path of the surface over the implant.
    pub(super) fn after_path(&self) -> &Path {
        self.after
    }

    /// The file of the surface over the implant, and the line of its measures before and after.
    pub(super) fn after(&self, solution: &Solution) -> (File, String) {
        let implant_ml = solution.problem().obstacle.dome.volume_over_wall() / 1000.0;
        let deformed = deform(&self.surface, &self.frame, solution);
        let marks = deform_marks(&self.marks, &[(self.frame, solution)]);
        let settings = Settings { cover_mm: self.cover_mm, ..Settings::default() };
        let bodies = [(&self.surface, &self.marks), (&deformed, &marks)];
        let fitted = fit(&self.surface, &self.marks, self.side, &settings);
        let change = fitted.ok().and_then(|fitted| change(&fitted, bodies, self.side));
        let mounds = change.map_or([None; 2], |c| [c.before, c.after].map(Some));
        // Both in the frame before.
        let frame = Frame::of_body(&self.marks).ok();
        let of = |k: usize| {
            let ((surface, marks), mound) = (bodies[k], (self.side, mounds[k]));
            frame.as_ref().map(|frame| BodyMeasures::of(surface, (marks, frame), mound))
        };
        let gained_ml = rounded(gained_ml(&self.surface, &deformed));
        let line = serde_json::json!({ "body_measures": {
            "before": of(0),
            "after": of(1),
            "nipple_shift_mm": change.map(|change| change.nipple_mm.to_array().map(rounded)),
            "gained_ml": gained_ml,
            "implant_ml": rounded(implant_ml),
            "void_ml": rounded(gained_ml - implant_ml),
        } });
        let file = File::new(self.after, write(&deformed, self.unit, self.format));
        (file, line.to_string())
    }
}

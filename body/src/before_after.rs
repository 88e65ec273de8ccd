//! A body before and after an operation as a table: its [`crate::measures`] and those over the bare chest ([`crate::mound`]), all in the frame of the marks
//! before and over the bare chest before.
//!
//! Sources of the anchors: means of notch to nipple, nipple to fold and nipple to nipple of 54 women who have not given birth (Al-Qattan et al.
//! 2019, PMC6756646); intraclass correlations of 4 raters and 28 women (Aesthet Surg J 2016;36:431, doi 10.1093/asj/sjv210); volume of 1210 breasts
//! (Huang et al. 2017, doi 10.1371/journal.pone.0172122); poles (Mallucci and Branford 2012, doi 10.1016/j.bjps.2011.08.006).
//!
//! Not computed: [`NOT_COMPUTED`].

use crate::deform::{deform_marks, deform_sides, gained_ml};
use crate::fit::{BodyFit, Settings, fit};
use crate::frame::Frame;
use crate::marks::{Marks, MarksError, Side};
use crate::measures::{BreastMeasures, Measures, measures};
use crate::mound::{Change, asymmetry_mm, change};
use crate::surface::Surface;
use glam::DVec3;
use implant_preview_solver::solve::Solution;
use serde::Serialize;
use std::sync::Arc;

/// What the measures do not contain.
pub const NOT_COMPUTED: &str = "Standing, right after the operation. Not computed: lengths under stretch, swelling, the shape after months.";

/// A measure before and after.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// What is measured.
    pub name: &'static str,
    /// Unit of the values: cm, mm, ml or %.
    pub unit: &'static str,
    /// Number of decimals that the error leaves.
    #[serde(skip)]
    pub decimals: usize,
    /// The value before; `None`: not measurable, or a gain alone.
    pub before: Option<f64>,
    /// The value after.
    pub after: Option<f64>,
    /// What the operation adds.
    pub gain: Option<f64>,
    /// How the measure is taken, its error, and an anchor for it.
    #[serde(skip)]
    pub about: &'static str,
}

/// Unit, decimals and factor from mm, ml or %.
type Unit = (&'static str, usize, f64);
const CM: Unit = ("cm", 1, 0.1);
const MM: Unit = ("mm", 1, 1.0);
const ML: Unit = ("ml", 0, 1.0);
const PERCENT: Unit = ("%", 0, 1.0);

impl Row {
    /// The row of two values in mm, ml or %.
    fn new(
        (name, about): (&'static str, &'static str),
        (unit, decimals, factor): Unit,
        [before, after]: [Option<f64>; 2],
    ) -> Self {
        let [before, after] = [before, after].map(|value| value.map(|value| factor * value));
        let gain = before.zip(after).map(|(before, after)| after - before);
        Self { name, unit, decimals, before, after, gain, about }
    }

    /// The row of a gain in mm or ml.
    fn gain(
        text: (&'static str, &'static str),
        (unit, decimals, factor): Unit,
        gain: Option<f64>,
    ) -> Self {
        let gain = gain.map(|gain| factor * gain);
        Self { gain, ..Self::new(text, (unit, decimals, factor), [None; 2]) }
    }
}

/// A body before an operation, measured once.
#[derive(Clone, Debug)]
pub struct Before {
    surface: Arc<Surface>,
    marks: Marks,
    side: Side,
    /// The frame of the marks.
    frame: Frame,
    /// The bare chest; `None` where no chest is found.
    fit: Option<BodyFit>,
    measures: Measures,
    asymmetry_mm: Option<f64>,
}

impl Before {
    /// Measures a body before the operation on a side; `cover_mm` as in [`Settings`]. It costs a fit and a height field.
    ///
    /// # Errors
    /// Marks at one place.
    pub fn new(
        surface: Arc<Surface>,
        marks: &Marks,
        side: Side,
        cover_mm: f64,
    ) -> Result<Self, MarksError> {
        let frame = Frame::of_body(marks)?;
        let settings = Settings { cover_mm, ..Settings::default() };
        Ok(Self {
            fit: fit(&surface, marks, side, &settings).ok(),
            measures: measures(&surface, marks, &frame),
            asymmetry_mm: asymmetry_mm(&surface, marks, &frame),
            marks: *marks,
            surface,
            side,
            frame,
        })
    }

    /// Surface and marks after: those of the solutions of one or both sides in their places on the body.
    #[must_use]
    pub fn after(&self, sides: &[(Frame, &Solution)]) -> (Surface, Marks) {
        (deform_sides(&self.surface, sides), deform_marks(&self.marks, sides))
    }

    /// The measures before and after, with the same rows for every body; an implant's volume \[ml\] is a part of the gained one.
    ///
    /// # Panics
    /// If the surface after has another number of vertices.
    #[must_use]
    pub fn rows(&self, after: (&Surface, &Marks), implant_ml: f64) -> Vec<Row> {
        self.rows_of_both(after, after, implant_ml)
    }

    /// As [`Self::rows`] where both sides have an implant: what lies over the bare chest is that of the own side's operation alone, as the patch reaches the
    /// other breast; all else is that of both.
    ///
    /// # Panics
    /// As [`Self::rows`].
    #[must_use]
    pub fn rows_of_both(
        &self,
        own: (&Surface, &Marks),
        (after, marks): (&Surface, &Marks),
        implant_ml: f64,
    ) -> Vec<Row> {
        assert_eq!(after.positions.len(), self.surface.positions.len(), "vertices after");
        let bodies = [(&*self.surface, &self.marks), own];
        let change = self.fit.as_ref().and_then(|fit| change(fit, bodies, self.side));
        let of_both = [self.measures, measures(after, marks, &self.frame)];
        let asymmetry_mm = [self.asymmetry_mm, asymmetry_mm(after, marks, &self.frame)];
        let mut rows = self.of_breast(&of_both).to_vec();
        rows.extend(of_mound(change.as_ref(), gained_ml(&self.surface, own.0), implant_ml));
        rows.extend(of_sides(&of_both, asymmetry_mm));
        rows
    }

    /// What a tape measures of the breast.
    fn of_breast(&self, of_both: &[Measures; 2]) -> [Row; 5] {
        let breasts = of_both.map(|of| of.breasts[self.side as usize]);
        let row = |text, of: fn(&BreastMeasures) -> Option<f64>| {
            Row::new(text, CM, breasts.map(|breast| breast.as_ref().and_then(of)))
        };
        [
            row(
                (
                    "Notch to nipple",
                    "Straight. Mean of 54 young women: 19.8 cm; four raters agree (ICC 0.94).",
                ),
                |breast| Some(breast.notch_nipple_mm),
            ),
            row(
                (
                    "Notch to nipple, along the skin",
                    "In the section through both marks; error 0.2 %.",
                ),
                |breast| breast.notch_nipple_skin_mm,
            ),
            row(
                (
                    "Nipple to fold, along the skin",
                    "At rest; a surgeon measures it under stretch, which is not computed. Mean of 54 young women: 7.7 cm.",
                ),
                |breast| breast.nipple_fold_mm,
            ),
            row(
                (
                    "Nipple to midline",
                    "Straight, to the plane through the notch. Four raters agree (ICC 0.90).",
                ),
                |breast| Some(breast.nipple_midline_mm),
            ),
            row(
                (
                    "Width of the breast",
                    "Straight, between the marks at its sides, which move with the skin. Four raters agree less (ICC 0.76).",
                ),
                |breast| Some(breast.base_width_mm),
            ),
        ]
    }
}

/// What lies over the bare chest, what the operation has added, and the way of the nipple.
fn of_mound(change: Option<&Change>, gained_ml: f64, implant_ml: f64) -> [Row; 8] {
    let mounds = [change.map(|of| of.before), change.map(|of| of.after)];
    let way = |axis: DVec3| change.map(|change| change.nipple_mm.dot(axis));
    [
        Row::new(
            (
                "Projection",
                "Over the bare chest, along its normal; the bare chest is uncertain by 2 to 4 mm, the gain is not.",
            ),
            CM,
            mounds.map(|mound| mound.map(|mound| mound.projection_mm)),
        ),
        Row::new(
            (
                "Volume of the breast",
                "Over the bare chest, with the implant and the space beside it; uncertain by 25 ml, the gain by 1 %. 1210 breasts: 340 ± 109 ml.",
            ),
            ML,
            mounds.map(|mound| mound.map(|mound| mound.volume_ml)),
        ),
        Row::gain(
            (
                "Volume gained",
                "Between the skin before and after: the implant and the space beside it.",
            ),
            ML,
            Some(gained_ml),
        ),
        Row::gain(
            (
                "Volume gained beside the implant",
                "No breast, do not count it: the void of the pocket, which tissue fills in time, and what the tissue rises by around the pocket.",
            ),
            ML,
            Some(gained_ml - implant_ml),
        ),
        Row::new(
            (
                "Upper pole",
                "Share of the volume above the nipple. The preferred 45 : 55 is one of heights in profile, not of volumes.",
            ),
            PERCENT,
            mounds.map(|mound| mound.map(|mound| mound.upper_percent)),
        ),
        Row::gain(("Nipple to the side", "Along the chest wall."), MM, way(DVec3::X)),
        Row::gain(("Nipple upwards", "Along the chest wall."), MM, way(DVec3::Y)),
        Row::gain(("Nipple forwards", "Along the normal of the chest wall."), MM, way(DVec3::Z)),
    ]
}

/// What both breasts have together.
fn of_sides(of_both: &[Measures; 2], asymmetry_mm: [Option<f64>; 2]) -> [Row; 4] {
    let both = |of: fn(&Measures) -> Option<f64>| of_both.each_ref().map(of);
    [
        Row::new(
            ("Nipple to nipple", "Straight. Mean of 54 young women: 20.3 cm."),
            CM,
            both(|of| Some(of.nipple_nipple_mm)),
        ),
        Row::new(
            ("Between the breasts", "Straight, between the marks towards the midline."),
            CM,
            both(|of| of.between_breasts_mm),
        ),
        Row::new(
            ("Left nipple higher by", "Along the body, from navel to notch."),
            MM,
            both(|of| Some(of.nipple_height_mm)),
        ),
        Row::new(
            (
                "Asymmetry of the skin",
                "Root mean square distance of one breast from the mirror image of the other one; every woman has some.",
            ),
            MM,
            asymmetry_mm,
        ),
    ]
}

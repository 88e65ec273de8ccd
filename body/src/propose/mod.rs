//! Marks proposed by geometry, for a surgeon to drag: nipples, borders of the breasts, notch and navel.
//!
//! `axes`: the plane of symmetry and the poses that a trunk may have in it; of them the one with the best pair of breasts (`view`). The
//! borders of a breast are where the skin leaves the bare chest (`border`). Errors on the built-in torso, shaped by tapes, turned and
//! with noise, are within 10 mm at the nipples, 30 mm at notch and navel and 40 mm at the borders (`body/tests/propose.rs`). Of breasts
//! under 200 ml two of three are found, the others have no proposal.

mod axes;
mod border;
mod view;

use crate::marks::{BreastMarks, Marks, Side};
use crate::pick;
use crate::surface::{Surface, main_part};
use axes::Pose;
use border::Breast;
use glam::{DMat3, DVec3};
use view::{Front, Pair};

/// Least score of a pair of breasts \[mm\]: of 48 shaped torsos those found have 21 or more, wrong places on trunks with breasts under 150 ml up to 17.
const LEAST_MM: f64 = 18.0;
/// Gain of the score for a head along the file's y \[mm\]: decides only where the shape does not.
const FILE_UP_MM: f64 = 2.0;
/// Turn of the head's axis after which the body is viewed again \[cosine\].
const TURNED: f64 = 0.9986;

/// No marks are proposed: one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoProposal {
    /// A surface without area.
    #[error("the surface has no triangles")]
    Empty,
    /// No pair of breasts in any pose.
    #[error(
        "no breasts are found on the surface; allowed: a trunk from the clavicle to 8 cm under the folds; set the marks by hand"
    )]
    NoBreasts,
}

/// Proposes marks of a body in any position, both sides.
///
/// # Errors
/// No surface, or none with two breasts.
pub fn propose(surface: &Surface) -> Result<Marks, NoProposal> {
    let welded = surface.weld();
    let triangles = main_part(surface, &welded);
    if triangles.is_empty() {
        return Err(NoProposal::Empty);
    }
    let orientation = if surface.signed_volume() < 0.0 { -1.0 } else { 1.0 };
    let subject = Subject { surface, welded: &welded, triangles: &triangles, orientation };
    let mut best: Option<Seen> = None;
    for pose in axes::poses(surface, &triangles, orientation) {
        let Some(seen) = Seen::new(&subject, &pose) else { continue };
        if best.as_ref().is_none_or(|best| seen.score > best.score) {
            best = Some(seen);
        }
    }
    let best = best.filter(|seen| seen.score >= LEAST_MM).ok_or(NoProposal::NoBreasts)?;
    let Seen { front, pair, midline, .. } = best;
    let sides = [Side::Left, Side::Right];
    let [left, right] =
        sides.map(|side| Breast::new(&subject, &front, &pair, side).ok_or(NoProposal::NoBreasts));
    Ok(on_skin(surface, midline, [left?, right?]))
}

/// What is viewed.
struct Subject<'a> {
    surface: &'a Surface,
    welded: &'a [u32],
    /// Triangles of the greatest part.
    triangles: &'a [u32],
    /// +1, or −1 for normals inwards.
    orientation: f64,
}

/// A body in a pose.
struct Seen {
    /// \[mm\].
    score: f64,
    front: Front,
    pair: Pair,
    /// Notch and navel.
    midline: [DVec3; 2],
}

impl Seen {
    /// Turns the pose's head along the body first: the fold under a breast shows only in a view from the front. `None` without breasts.
    fn new(subject: &Subject<'_>, pose: &Pose) -> Option<Self> {
        let seen = Self::as_posed(subject, pose)?;
        let Pose { origin, axes } = *pose;
        let [notch, navel] = seen.midline;
        let head = (notch - navel).reject_from_normalized(axes.x_axis).normalize_or(axes.y_axis);
        if head.dot(axes.y_axis) >= TURNED {
            return Some(seen);
        }
        let across = axes.x_axis;
        let turned = Pose { origin, axes: DMat3::from_cols(across, head, across.cross(head)) };
        Some(Self::as_posed(subject, &turned).unwrap_or(seen))
    }

    fn as_posed(subject: &Subject<'_>, pose: &Pose) -> Option<Self> {
        let front = Front::new(subject, pose);
        let (score, pair) = front.breasts()?;
        let midline = front.midline(&pair);
        Some(Self { score: score + FILE_UP_MM * pose.axes.y_axis.y, front, pair, midline })
    }
}

/// Marks at the points of the skin that are nearest to those found.
fn on_skin(surface: &Surface, [notch, navel]: [DVec3; 2], breasts: [Breast; 2]) -> Marks {
    let [left, right] = breasts.map(|b| [b.nipple, b.fold, b.upper, b.medial, b.lateral]);
    let [a, b, c, d, e] = left;
    let [f, g, h, i, j] = right;
    let points = [notch, navel, a, b, c, d, e, f, g, h, i, j];
    let snapped = pick::snap_all(surface, points);
    let at = |k: usize| snapped[k].map_or(points[k], |found| found.point);
    let breast = |first: usize| BreastMarks {
        fold: at(first + 1),
        upper: at(first + 2),
        medial: at(first + 3),
        lateral: at(first + 4),
        implant_centre: None,
    };
    Marks {
        sternal_notch: at(0),
        navel: at(1),
        nipples: [at(2), at(7)],
        breasts: [Some(breast(2)), Some(breast(7))],
    }
}

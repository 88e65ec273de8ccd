//! The mound of the built-in torso's breast, moved and stretched to a tape's numbers.

use super::{Tape, Torso, both, chest_width};
use crate::chest::solved;
use crate::fit::{Bare, FitError};
use crate::grid::smooth_step;
use crate::half::mirrored;
use crate::marks::{BreastMarks, Marks, Side};
use glam::{DVec2, DVec3};

/// The place on the skin of the built-in torso over the origin of the mound's frame, medial of the nipple and above it \[mm\].
pub(super) const CENTRE: DVec3 = DVec3::new(79.03, 374.39, 167.36);
/// Depth below the bare chest in which the skin ceases to follow the mound across \[mm\].
const BELOW_MM: f64 = 30.0;
/// The mound ends between these multiples of the breast's half widths \[-\].
const END: [f64; 2] = [1.15, 1.8];
/// Way from the midline over which the skin comes to move across \[mm\].
const MIDLINE_MM: f64 = 35.0;
/// Greatest move of the breast's medial end to the midline \[mm\]: the skin between keeps 15 % of its width, of 26 mm only 0.7 %.
const MEDIAL_MM: f64 = 12.0;
/// Iterations of Newton's method.
const ROUNDS: usize = 30;
/// Greatest change of a number in an iteration, change for its derivatives, difference that ends the iteration \[mm\].
const STEP_MM: f64 = 15.0;
const DIFFERENCE_MM: f64 = 3.0;
pub(super) const NEAR_MM: f64 = 0.1;
/// Length that stands for a stretch by e \[mm\].
const LOG_MM: f64 = 100.0;
/// Ranges of the numbers of [`Shape::of`]: no triangle turns over within.
const RANGES_MM: [[f64; 2]; 4] = [[-12.0, 15.0], [-15.0, 15.0], [-120.0, 50.0], [-18.0, 12.0]];
/// Points of the way from nipple to fold.
const POINTS: u32 = 48;

/// The places of a breast's marks in the plane of a frame.
#[derive(Clone, Copy)]
pub(super) struct Places {
    pub(super) nipple: DVec2,
    pub(super) fold: DVec2,
    pub(super) upper: DVec2,
    pub(super) medial: DVec2,
    pub(super) lateral: DVec2,
}

/// The mound of the left breast over the bare chest.
pub(super) struct Mound {
    fit: Bare,
    pub(super) at: Places,
    /// Middle and half widths of the breast \[mm\].
    center: DVec2,
    half: DVec2,
    measured: Measured,
}

/// What the measures of a shape need and no shape changes.
#[derive(Default)]
struct Measured {
    chest_width_mm: f64,
    notch: DVec3,
    nipple: Skin,
    medial: Skin,
    lateral: Skin,
    /// The way from the nipple to the fold.
    to_fold: Vec<Skin>,
    /// The nodes of the grid, and those with a cell in the breast's ellipse.
    nodes: Vec<Skin>,
    within: Vec<usize>,
}

/// A point of the given mound: its place, its height over the bare chest \[mm\], and how it follows a shape.
#[derive(Clone, Copy, Default)]
struct Skin {
    place: DVec2,
    height_mm: f64,
    /// Share of the breast's moves and stretches, from 0 far away to 1 within \[-\].
    share: f64,
    /// Share of the moves across, from 0 at the midline to 1 beside it \[-\].
    aside: f64,
    /// Share of the fold's move, from 0 at the nipple to 1 at the fold \[-\].
    to_fold: f64,
    /// Way across from the nipple, beside the breast that of its ends \[mm\].
    beside: f64,
}

/// A mound's shape: the given mound, moved across, stretched and scaled.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    /// Move of the breast away from the midline \[mm\].
    aside: f64,
    /// Stretches across and of the height \[-\].
    across: f64,
    height: f64,
    /// Move of the fold away from the nipple by the breast's half height \[-\].
    lowered: f64,
}

impl Mound {
    /// The mound of a torso, its frame at a place on the skin.
    pub(super) fn new(torso: &Torso, centre: DVec3) -> Result<Self, FitError> {
        let Torso { surface, marks } = torso;
        let breast = marks.breast(Side::Left)?;
        let marked = BreastMarks { implant_centre: Some(centre), ..*breast };
        let placed = Marks { breasts: [Some(marked), None], ..*marks };
        let fit = Bare::fitted(surface, &placed)?;
        let place = |point: DVec3| fit.frame.local(point).truncate();
        let at = Places {
            nipple: place(marks.nipple(Side::Left)),
            fold: place(breast.fold),
            upper: place(breast.upper),
            medial: place(breast.medial),
            lateral: place(breast.lateral),
        };
        let center = 0.5 * DVec2::new(at.medial.x + at.lateral.x, at.upper.y + at.fold.y);
        let half = 0.5 * DVec2::new(at.lateral.x - at.medial.x, at.upper.y - at.fold.y);
        let mut mound = Self { fit, at, center, half, measured: Measured::default() };
        mound.measured = mound.measured(torso);
        Ok(mound)
    }

    fn measured(&self, torso: &Torso) -> Measured {
        let (grid, side) = (self.fit.grid, self.fit.grid.side());
        let [nipple, medial, lateral] =
            [self.at.nipple, self.at.medial, self.at.lateral].map(|place| self.skin(place));
        let along = |k: u32| self.at.nipple.lerp(self.at.fold, f64::from(k) / f64::from(POINTS));
        let node = |node: usize| {
            let height_mm = (self.fit.skin_mm[node] - self.fit.bare_mm[node]).max(0.0);
            self.skin_of(grid.place(node), height_mm)
        };
        let is_within = |node: &usize| {
            let far = ((grid.place(*node) - self.center) / self.half).length();
            !(node + 1).is_multiple_of(side) && far <= END[0]
        };
        Measured {
            chest_width_mm: chest_width(torso),
            notch: torso.marks.sternal_notch,
            nipple,
            medial,
            lateral,
            to_fold: (0..=POINTS).map(|k| self.skin(along(k))).collect(),
            nodes: (0..grid.len()).map(node).collect(),
            within: (0..grid.len() - side).filter(is_within).collect(),
        }
    }

    /// How far a place belongs to the breast, from 1 within to 0 far away \[-\].
    fn share(&self, place: DVec2) -> f64 {
        let far = ((place - self.center) / self.half).length();
        smooth_step((END[1] - far) / (END[1] - END[0]))
    }

    /// A point of the given mound.
    fn skin_of(&self, place: DVec2, height_mm: f64) -> Skin {
        // Beside the breast the skin moves as its ends do, at the midline it stays.
        let Places { nipple, fold, medial, lateral, .. } = self.at;
        let across = self.fit.frame.point(place.extend(self.bare(place))).x;
        Skin {
            place,
            height_mm,
            share: self.share(place),
            aside: smooth_step(across / MIDLINE_MM),
            to_fold: smooth_step((nipple.y - place.y) / (nipple.y - fold.y)),
            beside: place.x.clamp(medial.x, lateral.x) - nipple.x,
        }
    }

    /// The point of the skin at a place.
    fn skin(&self, place: DVec2) -> Skin {
        let skin = self.fit.grid.value(&self.fit.skin_mm, place);
        self.skin_of(place, skin - self.bare(place))
    }

    /// The place of the frame, and the height over the bare chest, of a point of the given mound.
    fn moved(&self, shape: &Shape, of: &Skin) -> (DVec2, f64) {
        let &Skin { place, height_mm, share, aside, to_fold, beside } = of;
        // What the medial end does not move, the breast between it and the nipple is narrower by.
        let to_medial = self.at.medial.x - self.at.nipple.x;
        let inwards = (shape.aside + (shape.across - 1.0) * to_medial).max(-MEDIAL_MM);
        let stretch = match beside < 0.0 {
            true => (inwards - shape.aside) / to_medial,
            false => shape.across - 1.0,
        };
        let to_side = (shape.aside + stretch * beside) * share * aside;
        (
            place + DVec2::new(to_side, -shape.lowered * self.half.y * share * to_fold),
            height_mm * (1.0 + (shape.height - 1.0) * share),
        )
    }

    /// Height of the bare chest at a place \[mm\].
    fn bare(&self, place: DVec2) -> f64 {
        self.fit.grid.value(&self.fit.bare_mm, place)
    }

    /// A point of the shaped skin in the surface's coordinates.
    fn point(&self, shape: &Shape, of: &Skin) -> DVec3 {
        let (place, height) = self.moved(shape, of);
        self.fit.frame.point(place.extend(self.bare(place) + height))
    }

    /// Volume between shaped skin and bare chest, in the breast's ellipse \[ml\].
    fn volume(&self, shape: &Shape) -> f64 {
        let side = self.fit.grid.side();
        let corner = |node: usize| self.moved(shape, &self.measured.nodes[node]);
        let cell = |&node: &usize| {
            let [a, b, c, d] = [node, node + 1, node + side + 1, node + side].map(corner);
            let area = 0.5 * (c.0 - a.0).perp_dot(d.0 - b.0);
            0.25 * area * (a.1 + b.1 + c.1 + d.1)
        };
        self.measured.within.iter().map(cell).sum::<f64>() / 1000.0
    }

    /// What a tape measures on a shape, with the chest's width of the torso, and the volume over the given bare chest.
    pub(super) fn tape(&self, shape: &Shape) -> Tape {
        let Measured { chest_width_mm, notch, nipple, medial, lateral, to_fold, .. } =
            &self.measured;
        let [nipple, medial, lateral] = [nipple, medial, lateral].map(|of| self.point(shape, of));
        let along = to_fold
            .windows(2)
            .map(|pair| self.point(shape, &pair[0]).distance(self.point(shape, &pair[1])));
        Tape {
            chest_width_mm: *chest_width_mm,
            breast_width_mm: medial.distance(lateral),
            notch_nipple_mm: notch.distance(nipple),
            nipple_fold_mm: Some(along.sum()),
            nipple_nipple_mm: 2.0 * nipple.x,
            breast_volume_ml: self.volume(shape),
        }
    }

    /// The shape that has a tape's widths, volume and, where it has one, way to the fold.
    pub(super) fn shaped(&self, tape: &Tape) -> Shape {
        let of = |tape: &Tape| {
            let volume = LOG_MM * tape.breast_volume_ml.max(1.0).ln();
            [tape.nipple_nipple_mm, tape.breast_width_mm, volume]
        };
        let found = |numbers| self.tape(&Shape::of(numbers));
        let with = |lowered: f64| {
            let [aside, across, height] =
                found_numbers(of(tape), |[a, b, c]| of(&found([a, b, c, lowered])));
            Shape::of([aside, across, height, lowered])
        };
        let Some(fold) = tape.nipple_fold_mm else { return with(0.0) };
        let [aside, across, height] = of(tape);
        let [.., lowered] = found_numbers([aside, across, height, fold], |numbers| {
            let found = found(numbers);
            let [aside, across, height] = of(&found);
            [aside, across, height, found.nipple_fold_mm.unwrap_or(fold)]
        });
        // A fold at a limit has moved the other numbers.
        with(lowered)
    }

    /// The marks on a shape, both sides alike.
    pub(super) fn marks(&self, shape: &Shape, given: &Marks) -> Marks {
        let at = |place: DVec2| self.point(shape, &self.skin(place));
        let Places { nipple, fold, upper, medial, lateral } = self.at;
        let [fold, upper, medial, lateral] = [fold, upper, medial, lateral].map(at);
        let left = BreastMarks { fold, upper, medial, lateral, implant_centre: None };
        Marks { nipples: [at(nipple), mirrored(at(nipple))], breasts: both(left), ..*given }
    }

    /// Brings a shape to places of both sides.
    pub(super) fn reshape(&self, shape: &Shape, places: &mut [DVec3]) {
        for at in places {
            *at = match at.x {
                x if x < 0.0 => mirrored(self.vertex(shape, mirrored(*at))),
                0.0 => self.vertex(shape, *at).with_x(0.0),
                _ => self.vertex(shape, *at),
            };
        }
    }

    /// A vertex of the surface under another shape of the mound.
    fn vertex(&self, shape: &Shape, at: DVec3) -> DVec3 {
        let local = self.fit.frame.local(at);
        let place = local.truncate();
        let height = local.z - self.bare(place);
        if self.share(place) == 0.0 {
            return at;
        }
        // Skin of the flank and of the arm lies below and stays.
        let part = smooth_step((height + BELOW_MM) / BELOW_MM);
        let (to, raised) = self.moved(shape, &self.skin_of(place, height.max(0.0)));
        let way = (to - place) * part;
        let rise = (raised - height.max(0.0)) * part + self.bare(place + way) - self.bare(place);
        at + self.fit.frame.direction(way.extend(rise))
    }
}

impl Shape {
    /// Of a move, and of logarithms of stretches and the fold's move by the half height times [`LOG_MM`] \[mm\].
    pub(super) fn of([aside, across, height, lowered]: [f64; 4]) -> Self {
        let [across, height] = [across, height].map(|log| (log / LOG_MM).exp());
        Self { aside, across, height, lowered: lowered / LOG_MM }
    }
}

/// Numbers of [`Shape::of`] with the measures that are asked for, by Newton's method within [`RANGES_MM`].
fn found_numbers<const N: usize>(
    asked: [f64; N],
    measured: impl Fn([f64; N]) -> [f64; N],
) -> [f64; N] {
    let mut numbers = [0.0; N];
    for _ in 0..ROUNDS {
        let now = measured(numbers);
        let missing: [f64; N] = std::array::from_fn(|row| asked[row] - now[row]);
        if missing.iter().all(|missing| missing.abs() < NEAR_MM) {
            break;
        }
        let columns: [[f64; N]; N] = std::array::from_fn(|k| {
            let mut ahead = numbers;
            ahead[k] += DIFFERENCE_MM;
            let after = measured(ahead);
            std::array::from_fn(|row| (after[row] - now[row]) / DIFFERENCE_MM)
        });
        let matrix = std::array::from_fn(|row| columns.map(|column| column[row]));
        let Some(step) = solved(matrix, missing) else { break };
        let mut moved = 0.0_f64;
        for (k, (number, step)) in numbers.iter_mut().zip(step).enumerate() {
            let [least, most] = RANGES_MM[k];
            let after = (*number + step.clamp(-STEP_MM, STEP_MM)).clamp(least, most);
            moved = moved.max((after - *number).abs());
            *number = after;
        }
        if moved <= 0.0 {
            break;
        }
    }
    numbers
}

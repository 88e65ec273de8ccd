//! The marks of a scan while they are set: one by one, with their own history.

use crate::app::texts::tr;
use crate::body::marks::{BreastMarks, Marks, Side};
use glam::DVec3;

/// Number of marks that are set at a time.
pub(super) const COUNT: usize = 8;
/// Number of marks of both sides.
const ALL: usize = 12;
/// Marks of a breast.
const OF_BREAST: usize = 4;
/// Steps that are kept.
const HISTORY: usize = 200;

/// Names of the marks, and the words beside them, in the order in which they are asked for.
const NAMES: [(&str, &str); COUNT] = [
    ("Sternal notch", "notch"),
    ("Navel", "navel"),
    ("Left nipple", "left nipple"),
    ("Right nipple", "right nipple"),
    ("Fold, lowest point", "fold"),
    ("Upper end of the breast", "upper"),
    ("End towards the midline", "inner"),
    ("End towards the flank", "outer"),
];

/// Places of the marks \[mm\], in the axes of the surface: notch, navel, nipples, then those of the left and of the right breast.
type Places = [Option<DVec3>; ALL];

/// The marks of a scan.
#[derive(Default)]
pub(super) struct Points {
    at: Places,
    before: Vec<Places>,
}

/// The place of a mark among those of both sides.
fn index(mark: usize, side: Side) -> usize {
    if side == Side::Right && mark >= COUNT - OF_BREAST { mark + OF_BREAST } else { mark }
}

/// The name of a mark, and the word beside it.
pub(super) fn name(mark: usize) -> (&'static str, &'static str) {
    let (name, word) = NAMES[mark];
    (tr(name), tr(word))
}

impl Points {
    /// The marks of a proposal, without a history.
    pub(super) fn of(marks: &Marks) -> Self {
        let mut points = Self::default();
        points.set_all(marks);
        points.before.clear();
        points
    }

    pub(super) fn get(&self, mark: usize, side: Side) -> Option<DVec3> {
        self.at[index(mark, side)]
    }

    /// Sets a mark; `is_step`: as a step of the history of its own?
    pub(super) fn set(&mut self, mark: usize, side: Side, at: DVec3, is_step: bool) {
        if is_step {
            self.keep();
        }
        self.at[index(mark, side)] = Some(at);
    }

    /// Sets all marks of a file, as a step of the history.
    pub(super) fn set_all(&mut self, marks: &Marks) {
        self.keep();
        let Marks { sternal_notch, navel, nipples: [left, right], breasts } = *marks;
        let of = |breast: Option<BreastMarks>| {
            breast.map_or([None; OF_BREAST], |breast| {
                [breast.fold, breast.upper, breast.medial, breast.lateral].map(Some)
            })
        };
        let common = [sternal_notch, navel, left, right].map(Some);
        let all = common.into_iter().chain(breasts.into_iter().flat_map(of));
        for (own, at) in self.at.iter_mut().zip(all) {
            // Marks of a breast that a file does not have stay.
            *own = at.or(*own);
        }
    }

    /// All places in another unit of length; the history too.
    pub(super) fn scale(&mut self, factor: f64) {
        let places = std::iter::once(&mut self.at).chain(&mut self.before);
        places.flatten().flatten().for_each(|at| *at *= factor);
    }

    fn keep(&mut self) {
        if self.before.len() == HISTORY {
            self.before.remove(0);
        }
        self.before.push(self.at);
    }

    pub(super) fn can_undo(&self) -> bool {
        !self.before.is_empty()
    }

    /// Takes the last step back.
    pub(super) fn undo(&mut self) {
        if let Some(before) = self.before.pop() {
            self.at = before;
        }
    }

    /// The first mark that is missing.
    pub(super) fn missing(&self, side: Side) -> Option<usize> {
        (0..COUNT).find(|mark| self.get(*mark, side).is_none())
    }

    /// The marks; `None` while one of the side is missing.
    pub(super) fn marks(&self, side: Side) -> Option<Marks> {
        let breast = |of: Side| {
            let mut found = (COUNT - OF_BREAST..COUNT).map(|mark| self.get(mark, of));
            let mut next = || found.next().flatten();
            let (fold, upper, medial, lateral) = (next()?, next()?, next()?, next()?);
            Some(BreastMarks { fold, upper, medial, lateral, implant_centre: None })
        };
        breast(side)?;
        let [notch, navel, left, right] = [0, 1, 2, 3].map(|mark| self.at[mark]);
        Some(Marks {
            sternal_notch: notch?,
            navel: navel?,
            nipples: [left?, right?],
            breasts: [Side::Left, Side::Right].map(breast),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::torso;

    #[test]
    fn marks_are_set_one_by_one_taken_back_and_kept_for_both_sides() {
        let torso::Torso { marks, .. } = torso::builtin();
        let mut all = Points::default();
        all.set_all(&marks);
        assert_eq!(all.marks(Side::Left), Some(marks));
        let mut points = Points::default();
        for mark in 0..COUNT {
            assert_eq!(
                (points.missing(Side::Right), points.marks(Side::Right)),
                (Some(mark), None)
            );
            points.set(mark, Side::Right, all.get(mark, Side::Right).unwrap(), true);
        }
        let set = points.marks(Side::Right).unwrap();
        assert_eq!(set, Marks { breasts: [None, marks.breasts[1]], ..marks });
        assert_eq!(points.missing(Side::Left), Some(4));
        points.scale(0.1);
        assert_eq!(points.marks(Side::Right).unwrap(), set.scaled(0.1));
        points.undo();
        assert_eq!(points.missing(Side::Right), Some(7));
        while points.can_undo() {
            points.undo();
        }
        assert_eq!(points.missing(Side::Right), Some(0));
    }
}

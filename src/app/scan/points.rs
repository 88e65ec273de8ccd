//! The marks of a scan while they are set: one by one, with their own history.

use crate::app::texts::tr;
use crate::body::marks::{self, BreastMarks, Marks, Side};
use glam::DVec3;

/// Number of marks that a side needs; those of the other breast follow.
const COUNT: usize = 8;
/// Number of marks of both sides, and with the implants' centres, which only a file sets.
const SET_BY_HAND: usize = 12;
const ALL: usize = 14;
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
/// The same of the left and of the right breast while it is the other one.
const OF_OTHER: [(&str, &str); 2 * OF_BREAST] = [
    ("Left breast: fold, lowest point", "left fold"),
    ("Left breast: upper end", "left upper"),
    ("Left breast: end towards the midline", "left inner"),
    ("Left breast: end towards the flank", "left outer"),
    ("Right breast: fold, lowest point", "right fold"),
    ("Right breast: upper end", "right upper"),
    ("Right breast: end towards the midline", "right inner"),
    ("Right breast: end towards the flank", "right outer"),
];
/// The same of the centres of the implants.
const CENTRES: [(&str, &str); 2] = [
    ("Left breast: centre of the implant", "left centre"),
    ("Right breast: centre of the implant", "right centre"),
];

/// Places of the marks \[mm\], in the axes of the surface: notch, navel, nipples, then those of the left and of the right breast, and the implants' centres.
type Places = [Option<DVec3>; ALL];

/// The marks of a scan.
#[derive(Default)]
pub(super) struct Points {
    at: Places,
    /// Was a mark proposed, and has nobody looked at it?
    is_proposed: [bool; ALL],
    /// Both before each step, and after each step that was taken back.
    before: Vec<(Places, [bool; ALL])>,
    after: Vec<(Places, [bool; ALL])>,
}

/// The place of a mark among those of both sides.
fn index(mark: usize, side: Side) -> usize {
    if side == Side::Right { of_other_side(mark) } else { mark }
}

/// The number of a mark for the other side.
pub(super) fn of_other_side(mark: usize) -> usize {
    match mark {
        4..COUNT => mark + OF_BREAST,
        COUNT..SET_BY_HAND => mark - OF_BREAST,
        _ => mark,
    }
}

/// The name of a mark, and the word beside it.
pub(super) fn name(mark: usize, side: Side) -> (&'static str, &'static str) {
    let (name, word) = match mark {
        0..COUNT => NAMES[mark],
        COUNT..SET_BY_HAND => OF_OTHER[index(mark, side) - (COUNT - OF_BREAST)],
        _ => CENTRES[mark - SET_BY_HAND],
    };
    (tr(name), tr(word))
}

impl Points {
    /// The marks of a proposal, without a history.
    pub(super) fn of(marks: &Marks) -> Self {
        let mut points = Self::default();
        points.set_all(marks);
        points.before.clear();
        points.is_proposed = points.at.map(|at| at.is_some());
        points
    }

    /// The marks to show: those of a side, and those of the other breast that are set.
    pub(super) fn listed(&self, side: Side) -> impl Iterator<Item = usize> {
        (0..ALL).filter(move |mark| *mark < COUNT || self.get(*mark, side).is_some())
    }

    /// Was a mark proposed, and has nobody looked at it?
    pub(super) fn is_proposed(&self, mark: usize, side: Side) -> bool {
        self.is_proposed[index(mark, side)]
    }

    /// The surgeon has looked at a mark.
    pub(super) fn check(&mut self, mark: usize, side: Side) {
        self.is_proposed[index(mark, side)] = false;
    }

    /// Names of the marks that nobody has looked at.
    pub(super) fn proposed(&self) -> Vec<String> {
        let names = marks::NAMES.iter().zip(self.is_proposed);
        names.filter(|(_, is)| *is).map(|(name, _)| (*name).to_owned()).collect()
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
        self.check(mark, side);
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
        for ((own, is_proposed), at) in self.at.iter_mut().zip(&mut self.is_proposed).zip(all) {
            // Marks of a breast that a file does not have stay.
            *own = at.or(*own);
            *is_proposed &= at.is_none();
        }
        for (centre, breast) in self.at[SET_BY_HAND..].iter_mut().zip(breasts) {
            *centre = breast.map_or(*centre, |breast| breast.implant_centre);
        }
    }

    /// All places in another unit of length; the history too.
    pub(super) fn scale(&mut self, factor: f64) {
        let others = self.before.iter_mut().chain(&mut self.after).map(|(at, _)| at);
        let places = std::iter::once(&mut self.at).chain(others);
        places.flatten().flatten().for_each(|at| *at *= factor);
    }

    fn keep(&mut self) {
        self.after.clear();
        if self.before.len() == HISTORY {
            self.before.remove(0);
        }
        self.before.push((self.at, self.is_proposed));
    }

    pub(super) fn can_undo(&self) -> bool {
        !self.before.is_empty()
    }

    /// Takes the last step back.
    pub(super) fn undo(&mut self) {
        if let Some(before) = self.before.pop() {
            self.after.push((self.at, self.is_proposed));
            (self.at, self.is_proposed) = before;
        }
    }

    /// Takes the step again that was taken back last.
    pub(super) fn redo(&mut self) {
        if let Some(after) = self.after.pop() {
            self.before.push((self.at, self.is_proposed));
            (self.at, self.is_proposed) = after;
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
            let implant_centre = self.at[SET_BY_HAND + usize::from(of == Side::Right)];
            Some(BreastMarks { fold, upper, medial, lateral, implant_centre })
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
        points.redo();
        assert_eq!(points.marks(Side::Right).unwrap(), set.scaled(0.1));
        while points.can_undo() {
            points.undo();
        }
        assert_eq!(points.missing(Side::Right), Some(0));
        points.set(0, Side::Right, DVec3::ZERO, true);
        points.redo();
        assert_eq!(points.missing(Side::Right), Some(1));
    }

    /// The centre that a file has is one of the marks: listed, moved, taken back; a file without one takes it away.
    #[test]
    fn the_centre_of_an_implant_is_kept() {
        let torso::Torso { marks, .. } = torso::builtin();
        let mut given = marks;
        let centre = DVec3::new(80.0, 340.0, 170.0);
        given.breasts[0].as_mut().unwrap().implant_centre = Some(centre);
        let mut points = Points::of(&marks);
        assert!(points.listed(Side::Right).all(|mark| mark < SET_BY_HAND));
        points.set_all(&given);
        for side in [Side::Left, Side::Right] {
            assert_eq!(points.marks(side), Some(given));
            assert_eq!(points.listed(side).last(), Some(SET_BY_HAND));
            assert_eq!(points.get(of_other_side(SET_BY_HAND), side), Some(centre));
            assert_eq!(name(SET_BY_HAND, side).1, "left centre");
        }
        points.set_all(&marks);
        assert_eq!(points.marks(Side::Left), Some(marks));
        points.undo();
        assert_eq!(points.marks(Side::Left), Some(given));
    }

    /// A mark that was chosen, moved or read is the surgeon's; those of the other breast are listed while they are set.
    #[test]
    fn proposed_marks_are_those_that_nobody_has_looked_at() {
        let torso::Torso { marks, .. } = torso::builtin();
        let mut points = Points::of(&marks);
        assert_eq!(points.proposed(), marks::NAMES);
        assert_eq!(points.listed(Side::Left).count(), SET_BY_HAND);
        points.check(3, Side::Left);
        points.set(4, Side::Right, DVec3::ZERO, true);
        points.check(of_other_side(7), Side::Right);
        let checked = ["nipple_right", "fold_right", "lateral_left"];
        let is_left = |name: &&str| !checked.contains(name);
        assert!(points.proposed().iter().eq(marks::NAMES.iter().filter(|name| is_left(name))));
        points.set_all(&Marks { breasts: [marks.breasts[0], None], ..marks });
        assert_eq!(points.proposed(), ["upper_right", "medial_right", "lateral_right"]);
        // Marks that are taken back are as unseen as before.
        points.undo();
        points.undo();
        assert_eq!(points.proposed().len(), SET_BY_HAND - 1);
        assert!(Points::default().listed(Side::Right).eq(0..COUNT));
        let words = [Side::Left, Side::Right].map(|side| [7, 8].map(|mark| name(mark, side).1));
        assert_eq!(words, [["outer", "right fold"], ["outer", "left fold"]]);
    }
}

//! The words on the areas of the chart: each band of a quantity at the place farthest from its border.

use crate::app::texts::{tr, word_of};
use crate::study::{JudgedMap, PointStatus, Quantity};

/// The area of points without an answer.
const NO_ANSWER: &str = "no answer";
/// The area of points about which practice says nothing.
const NO_PRACTICE: &str = "not in practice's table";
/// Least distance of a word from the border of its area \[points of the map\].
const LEAST_DISTANCE: usize = 2;

/// The words of a map of two axes, each with its place in the units of the axes.
pub(super) fn areas(map: JudgedMap<'_>, quantity: Quantity) -> Vec<(&'static str, (f64, f64))> {
    let [x, y] = map.axes() else { return Vec::new() };
    let Some((limits, factor)) = map.limits(quantity) else { return Vec::new() };
    let word = |i: usize, j: usize| match map.scaled(quantity, i, j) {
        Some((value, _)) => Some(word_of(&limits, limits.word(factor * value))),
        None if map.displayed(quantity, i, j).is_some() => Some(tr(NO_PRACTICE)),
        None => (map.status(i, j) != PointStatus::Waiting).then_some(tr(NO_ANSWER)),
    };
    let words: Vec<Option<&str>> =
        (0..y.count).flat_map(|j| (0..x.count).map(move |i| word(i, j))).collect();
    let distances = distances(&words, x.count);
    let mut found: Vec<(&'static str, usize)> = Vec::new();
    for (k, word) in words.iter().enumerate() {
        let Some(word) = *word else { continue };
        match found.iter_mut().find(|(known, _)| *known == word) {
            Some((_, best)) if distances[k] > distances[*best] => *best = k,
            Some(_) => {}
            None => found.push((word, k)),
        }
    }
    found.retain(|(_, k)| distances[*k] >= LEAST_DISTANCE);
    let place = |k: usize| (x.value(k % x.count), y.value(k / x.count));
    found.into_iter().map(|(word, k)| (word, place(k))).collect()
}

/// Distance of each point from the nearest point of another word or beyond the map \[points\], over rows, columns and diagonals.
fn distances<T: PartialEq>(words: &[T], columns: usize) -> Vec<usize> {
    let rows = words.len() / columns;
    let mut distances = vec![usize::MAX; words.len()];
    let neighbours: [(isize, isize); 4] = [(-1, 0), (-1, -1), (0, -1), (1, -1)];
    for side in [1, -1] {
        for step in 0..words.len() {
            let k = if side == 1 { step } else { words.len() - 1 - step };
            let (i, j) = ((k % columns) as isize, (k / columns) as isize);
            let near = neighbours.map(|(a, b)| {
                let (a, b) = (i + side * a, j + side * b);
                if !(0..columns as isize).contains(&a) || !(0..rows as isize).contains(&b) {
                    return 1;
                }
                let other = b as usize * columns + a as usize;
                if words[other] == words[k] { distances[other].saturating_add(1) } else { 1 }
            });
            distances[k] = near.into_iter().fold(distances[k], usize::min);
        }
    }
    distances
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_an_area_is_farthest_from_its_border() {
        // Five rows of seven: a column of another word at the right.
        let words: Vec<bool> = (0..35).map(|k| k % 7 < 5).collect();
        let found = distances(&words, 7);
        assert_eq!(found[0..7], [1, 1, 1, 1, 1, 1, 1]);
        assert_eq!(found[14..21], [1, 2, 3, 2, 1, 1, 1]);
        assert_eq!(found.iter().copied().max(), Some(3));
    }
}

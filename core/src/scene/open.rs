//! Where a grid of heights has none: gaps that heights bridge, and the widest one, and gaps that heights enclose.

/// Distance of heights in a row or a column that bridge the gap between them \[mm\]; on coarser grids two spacings, up to a scan's largest holes.
const BRIDGED_MM: (f64, f64) = (12.0, 40.0);

/// The heights of a grid, of which some are absent.
pub(super) struct Open<'a> {
    pub(super) counts: [usize; 2],
    pub(super) spacing_mm: f64,
    pub(super) heights: &'a [Option<f64>],
}

impl Open<'_> {
    /// Greatest distance of heights that bridge a gap \[mm\].
    fn bridge_mm(&self) -> f64 {
        (2.0 * self.spacing_mm).clamp(BRIDGED_MM.0, BRIDGED_MM.1)
    }

    /// Is there a height at a node, or on either side of it in a row or a column, near enough to bridge the gap?
    pub(super) fn known_or_bridged(&self) -> Vec<bool> {
        let [columns, rows] = self.counts;
        let most = (self.bridge_mm() / self.spacing_mm * (1.0 + 1e-9)) as usize;
        let mut known: Vec<bool> = self.heights.iter().map(Option::is_some).collect();
        for (lines, count, step, stride) in
            [(rows, columns, columns, 1), (columns, rows, 1, columns)]
        {
            for first in (0..lines).map(|line| line * step) {
                let has = |k: &usize| self.heights[first + k * stride].is_some();
                let mut last = None;
                for k in (0..count).filter(has) {
                    let from = last.replace(k).filter(|from| k - from <= most).unwrap_or(k);
                    (from..k).for_each(|k| known[first + k * stride] = true);
                }
            }
        }
        known
    }

    /// The node within a region that is furthest from any height, and twice its distance \[mm\]: place and width of the gap there. `None` without a
    /// gap that is wider than heights bridge.
    pub(super) fn widest(&self, is_within: impl Fn(usize) -> bool) -> Option<(usize, f64)> {
        let in_row = self.steps_in_row();
        let open = (0..in_row.len()).filter(|&k| self.heights[k].is_none() && is_within(k));
        let widths = open.map(|k| (k, 2.0 * self.spacing_mm * self.steps(k, &in_row)));
        let widest = widths.max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        (widest.1 > self.bridge_mm() && widest.1.is_finite()).then_some(widest)
    }

    /// The nodes of gaps that heights enclose, no wider and higher than a scan's largest holes.
    pub(super) fn enclosed(&self) -> Vec<bool> {
        let [columns, rows] = self.counts;
        let most = (BRIDGED_MM.1 / self.spacing_mm * (1.0 + 1e-9)) as usize;
        let mut is_seen: Vec<bool> = self.heights.iter().map(Option::is_some).collect();
        let mut enclosed = vec![false; is_seen.len()];
        let mut gap = Vec::new();
        for first in 0..is_seen.len() {
            if std::mem::replace(&mut is_seen[first], true) {
                continue;
            }
            gap.clear();
            gap.push(first);
            // From the first column and row before the gap to those behind it.
            let (mut from, mut to) = ([usize::MAX; 2], [0; 2]);
            let mut next = 0;
            while let Some(&k) = gap.get(next) {
                next += 1;
                let at = [k % columns, k / columns];
                for axis in 0..2 {
                    from[axis] = from[axis].min(at[axis]);
                    to[axis] = to[axis].max(at[axis] + 2);
                }
                for row in at[1].saturating_sub(1)..(at[1] + 2).min(rows) {
                    for column in at[0].saturating_sub(1)..(at[0] + 2).min(columns) {
                        let k = row * columns + column;
                        if !std::mem::replace(&mut is_seen[k], true) {
                            gap.push(k);
                        }
                    }
                }
            }
            let is_within = |axis: usize| {
                let count = self.counts[axis];
                from[axis] > 0 && to[axis] <= count && to[axis] - from[axis] <= most
            };
            if is_within(0) && is_within(1) {
                gap.iter().for_each(|k| enclosed[*k] = true);
            }
        }
        enclosed
    }

    /// Distance of every node from the nearest height in its row \[spacings\].
    fn steps_in_row(&self) -> Vec<f64> {
        let mut steps = vec![f64::INFINITY; self.heights.len()];
        let rows = self.heights.chunks(self.counts[0]).zip(steps.chunks_mut(self.counts[0]));
        for (row, steps) in rows {
            let mut pass = |places: &mut dyn Iterator<Item = usize>| {
                let mut last = f64::INFINITY;
                for k in places {
                    last = if row[k].is_some() { 0.0 } else { last + 1.0 };
                    steps[k] = steps[k].min(last);
                }
            };
            pass(&mut (0..row.len()));
            pass(&mut (0..row.len()).rev());
        }
        steps
    }

    /// Distance of a node from the nearest height \[spacings\].
    fn steps(&self, k: usize, in_row: &[f64]) -> f64 {
        let [columns, rows] = self.counts;
        let (column, row) = (k % columns, k / columns);
        let mut least = f64::INFINITY;
        for away in 0..rows {
            if away as f64 >= least {
                break;
            }
            let both = [row.checked_sub(away), Some(row + away).filter(|row| *row < rows)];
            for row in both.into_iter().flatten() {
                least = least.min(in_row[row * columns + column].hypot(away as f64));
            }
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    const SIDE: usize = 61;

    fn place(k: usize, spacing_mm: f64) -> DVec2 {
        DVec2::new((k % SIDE) as f64 - 30.0, (k / SIDE) as f64 - 30.0) * spacing_mm
    }

    fn heights(is_open: impl Fn(usize) -> bool) -> Vec<Option<f64>> {
        (0..SIDE * SIDE).map(|k| (!is_open(k)).then_some(1.0)).collect()
    }

    fn open(spacing_mm: f64, heights: &[Option<f64>]) -> Open<'_> {
        Open { counts: [SIDE; 2], spacing_mm, heights }
    }

    #[test]
    fn enclosed_gaps_have_heights_on_every_side_and_are_as_large_as_holes_at_most() {
        for (spacing, at, radius, is_enclosed) in [
            (4.0, DVec2::ZERO, 18.0, true),
            (4.0, DVec2::ZERO, 22.0, false),
            (1.0, DVec2::new(5.0, -7.0), 19.0, true),
            (4.0, DVec2::new(-110.0, 20.0), 18.0, false),
            (4.0, DVec2::new(-96.0, 98.0), 18.0, true),
        ] {
            let is_open = |k: usize| place(k, spacing).distance(at) < radius;
            let heights = heights(is_open);
            let found = open(spacing, &heights).enclosed();
            let expected: Vec<bool> = (0..SIDE * SIDE).map(|k| is_enclosed && is_open(k)).collect();
            assert!(found == expected, "{spacing} {at} {radius}");
        }
    }

    /// Against a search through all heights.
    #[test]
    fn the_widest_gap_is_twice_the_greatest_distance_from_a_height() {
        for (at, radius) in [(DVec2::ZERO, 10.0), (DVec2::new(31.0, -17.0), 19.0)] {
            let spacing = 3.0;
            let random = |k: usize| k.wrapping_mul(2_654_435_761).is_multiple_of(11);
            let is_open = |k: usize| place(k, spacing).distance(at) < radius || random(k);
            let heights = heights(is_open);
            let (found, width) = open(spacing, &heights).widest(|_| true).unwrap();
            let distance = |k: usize| {
                let known = (0..SIDE * SIDE).filter(|k| heights[*k].is_some());
                let to = |other| place(other, spacing).distance(place(k, spacing));
                known.map(to).fold(f64::INFINITY, f64::min)
            };
            let greatest = (0..SIDE * SIDE).map(distance).fold(0.0, f64::max);
            assert!((width - 2.0 * greatest).abs() < 1e-9, "{width} {greatest}");
            assert!((distance(found) - greatest).abs() < 1e-9);
            assert!(place(found, spacing).distance(at) < 3.0 * spacing);
            let elsewhere = |k: usize| place(k, spacing).distance(at) > radius + 3.0 * spacing;
            assert_eq!(open(spacing, &heights).widest(elsewhere), None);
        }
        assert_eq!(open(3.0, &heights(|_| true)).widest(|_| true), None);
    }

    #[test]
    fn heights_bridge_gaps_of_12_mm_or_two_spacings() {
        for (spacing, missing, is_bridged) in [
            (2.0, 5, true),
            (2.0, 6, false),
            (4.0, 2, true),
            (4.0, 3, false),
            (10.0, 1, true),
            (10.0, 2, false),
            (25.0, 1, false),
        ] {
            let gap = |line: usize| (20..20 + missing).contains(&line);
            for heights in [heights(|k| gap(k % SIDE)), heights(|k| gap(k / SIDE))] {
                let known = open(spacing, &heights).known_or_bridged();
                let open = known.iter().filter(|known| !**known).count();
                assert_eq!(
                    open,
                    if is_bridged { 0 } else { missing * SIDE },
                    "{spacing} {missing}"
                );
            }
            // At the grid's edge nothing is beyond.
            let known = heights(|k| k % SIDE == 0);
            assert!(!open(spacing, &known).known_or_bridged()[SIDE * 30]);
        }
    }
}

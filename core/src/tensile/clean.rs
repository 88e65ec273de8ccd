//! From the rows of a test to the samples of its loading: engineering values, the loading branch, zero, repeated strains.

use super::fit::FEW;
use super::{Notes, percent};
use crate::curve::number;
use crate::tensile::Row;

/// Change of strain, relative to its range, from which on a turn begins a cycle and is no noise.
const TURN: f64 = 0.05;
/// Fall of the stress, relative to the greatest one, that is a rupture.
const RUPTURE: f64 = 0.2;
/// Start of a test, relative to its range of strain, from which its zero is found.
const START: f64 = 0.03;
/// Least number of rows at the start for that.
const START_ROWS: usize = 8;

/// Engineering values of true ones: ε = exp(h) − 1; σ = true stress / (1 + ε), of incompressible tissue.
pub(super) fn engineering(rows: &mut Vec<Row>, is_true: [bool; 2], notes: &mut Notes) {
    for row in rows.iter_mut() {
        if is_true[0] {
            row[0] = row[0].exp_m1();
        }
        if is_true[1] {
            row[1] /= 1.0 + row[0];
        }
    }
    rows.retain(|row| row.iter().all(|value| value.is_finite()));
    if is_true[0] {
        notes.say("True strain was converted to engineering strain.");
    }
    if is_true[1] {
        notes.say("True stress was converted to nominal stress, of incompressible tissue.");
    }
}

/// The rows of the loading: the last rise to the greatest strain, below its start the rises before.
pub(super) fn loading(rows: &[Row], notes: &mut Notes) -> Vec<Row> {
    let mut rows = rows.to_vec();
    let mut rises = rises(&rows);
    if rises.iter().all(|rise| rise.len() < 2) {
        rows.reverse();
        rises = self::rises(&rows);
    }
    let strain = |k: usize| rows[k][0];
    let (least, range) = extent(&rows);
    let top = |rise: &std::ops::Range<usize>| strain(rise.end - 1);
    let last = rises.iter().rposition(|rise| top(rise) >= least + (1.0 - TURN) * range);
    let (mut kept, mut bound) = (Vec::new(), f64::INFINITY);
    for rise in rises[..last.map_or(0, |last| last + 1)].iter().rev() {
        kept.extend(rise.clone().filter(|&k| strain(k) < bound));
        bound = bound.min(strain(rise.start));
        if bound <= least + TURN * range {
            break;
        }
    }
    if kept.len() < rows.len() {
        let (kept, all) = (kept.len(), rows.len());
        notes.say(format!(
            "The loading is {kept} of {all} rows; the other rows are unloading, cycles or rest."
        ));
    }
    kept.into_iter().map(|k| rows[k]).collect()
}

/// Least strain and range of strain.
fn extent(rows: &[Row]) -> (f64, f64) {
    let (least, most) = rows
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), row| (a.min(row[0]), b.max(row[0])));
    (least, most - least)
}

/// The rises of the strain from one turn to the next.
fn rises(rows: &[Row]) -> Vec<std::ops::Range<usize>> {
    let swing = TURN * extent(rows).1;
    let strain = |k: usize| rows[k][0];
    let (mut found, mut start, mut turn, mut is_rising) = (Vec::new(), 0, 0, true);
    for k in 0..rows.len() {
        let gone = if is_rising { strain(turn) - strain(k) } else { strain(k) - strain(turn) };
        if gone < 0.0 {
            turn = k;
        } else if gone > swing {
            if is_rising {
                found.push(start..turn + 1);
            }
            (start, turn, is_rising) = (turn, k, !is_rising);
        }
    }
    if is_rising && !rows.is_empty() {
        found.push(start..turn + 1);
    }
    found
}

/// Orders the rows by strain and merges rows of one strain to their mean.
pub(super) fn merged(mut rows: Vec<Row>, notes: &mut Notes) -> Vec<Row> {
    let same = 1e-7 * extent(&rows).1;
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mean = |group: &[Row]| {
        let count = group.len() as f64;
        [0, 1].map(|axis| group.iter().map(|row| row[axis]).sum::<f64>() / count)
    };
    let merged: Vec<Row> = rows.chunk_by(|a, b| b[0] - a[0] <= same).map(mean).collect();
    let repeated = rows.len() - merged.len();
    if repeated > 0 {
        notes.say(format!("Rows with a repeated strain, merged: {repeated}."));
    }
    merged
}

/// Ends the rows where the stress begins to fall for good: the sample tears or slips.
pub(super) fn until_rupture(mut rows: Vec<Row>, notes: &mut Notes) -> Vec<Row> {
    let smooth: Vec<f64> = (0..rows.len()).map(|k| median_around(&rows, k)).collect();
    let Some(peak) = (0..rows.len()).max_by(|a, b| smooth[*a].total_cmp(&smooth[*b])) else {
        return rows;
    };
    let least = smooth[peak..].iter().copied().fold(f64::INFINITY, f64::min);
    if peak > 0 && least < (1.0 - RUPTURE) * smooth[peak] {
        let (count, at) = (rows.len() - peak - 1, percent(rows[peak][0]));
        notes.say(format!("The stress falls from {at} % strain on; rows left out there: {count}."));
        rows.truncate(peak + 1);
    }
    rows
}

/// Median of the stress of up to five rows, without effect on three or fewer.
fn median_around(rows: &[Row], k: usize) -> f64 {
    let reach = 2.min(k).min(rows.len() - 1 - k);
    let mut near: Vec<f64> = rows[k - reach..=k + reach].iter().map(|row| row[1]).collect();
    near.sort_by(f64::total_cmp);
    near[reach]
}

/// Moves the start of the test to the origin, and leaves out what lies before.
pub(super) fn zeroed(mut rows: Vec<Row>, notes: &mut Notes) -> Vec<Row> {
    let (least, range) = extent(&rows);
    let most = rows.iter().map(|row| row[1].abs()).fold(0.0, f64::max);
    let begins_below = |start: &Start| start.stress < -(0.01 * most).max(3.0 * start.error);
    if least < -0.005 * range && Start::of(&rows).is_some_and(|start| begins_below(&start)) {
        let all = rows.len();
        rows.retain(|row| row[0] >= 0.0);
        notes.say(format!("Rows of compression, left out: {}.", all - rows.len()));
    }
    let Some(start) = Start::of(&rows) else {
        rows.retain(|row| row[0] > 0.0);
        return rows;
    };
    let is_stress = start.stress.abs() > (1e-4 * most).max(3.0 * start.error);
    let is_strain = start.strain.abs() > 0.005 * range;
    let continues = start.stress > 0.0 && start.stress <= 1.5 * start.slope * start.strain;
    let stress = if is_stress { start.stress } else { 0.0 };
    let strain = if is_strain { start.strain } else { start.strain.min(0.0) };
    let at = percent(strain);
    if is_strain && is_stress && continues {
        let stress = shown(stress);
        notes.say(format!(
            "The test begins at {at} % strain and {stress} kPa; the curve begins at the origin."
        ));
    } else {
        if is_strain {
            notes.say(format!("Strain at the start, subtracted: {at} %."));
        }
        if is_stress {
            notes.say(format!("Stress at the start, subtracted: {} kPa.", shown(stress)));
        }
        rows.iter_mut().for_each(|row| *row = [row[0] - strain, row[1] - stress]);
    }
    rows.retain(|row| row[0] > 1e-7 * range);
    rows
}

/// Three significant digits of a number.
pub(super) fn shown(value: f64) -> String {
    number(format!("{value:.2e}").parse().unwrap_or(value))
}

/// Where a test begins: its least strain, the stress there with its standard error, and the slope.
struct Start {
    strain: f64,
    stress: f64,
    error: f64,
    slope: f64,
}

impl Start {
    /// By a line through the rows at the start, of few rows by the first two; `None` for fewer than two.
    fn of(rows: &[Row]) -> Option<Self> {
        let [[strain, stress], second, ..] = *rows else { return None };
        let end = strain + START * extent(rows).1;
        let near =
            &rows[..rows.partition_point(|row| row[0] <= end).max(START_ROWS).min(rows.len())];
        if rows.len() < FEW {
            let slope = (second[1] - stress) / (second[0] - strain);
            return Some(Self { strain, stress, error: 0.0, slope });
        }
        let count = near.len() as f64;
        let mean = |axis: usize| near.iter().map(|row| row[axis]).sum::<f64>() / count;
        let middle = [mean(0), mean(1)];
        let moment = |axis: usize| {
            near.iter().map(|row| (row[0] - middle[0]) * (row[axis] - middle[axis])).sum::<f64>()
        };
        let slope = moment(1) / moment(0);
        let line = |at: f64| middle[1] + slope * (at - middle[0]);
        let rest: f64 = near.iter().map(|row| (row[1] - line(row[0])).powi(2)).sum();
        let spread = (middle[0] - strain).powi(2) / moment(0);
        let error = (rest / (count - 2.0) * (1.0 / count + spread)).sqrt();
        Some(Self { strain, stress: line(strain), error, slope })
    }
}

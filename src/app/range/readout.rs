//! The values of a point of the range in words: for the box at the pointer and for screen readers.

use super::axes::Words;
use super::within_text;
use crate::app::texts::{fixed, pressure, tr, word_of};
use crate::measure::bands::{self, PracticeStretch, SkinLimits};
use crate::study::{JudgedMap, Map, Parameter, PointStatus, Quantity, Source};

/// The usual quantities, first on offer.
const USUAL: [Quantity; 8] = [
    Quantity::GreatestStrain,
    Quantity::SkinReserveUsed,
    Quantity::GreatestPressureMmhg,
    Quantity::LeastCoverMm,
    Quantity::SkinAreaGainCm2,
    Quantity::SkinProjectionMm,
    Quantity::ImplantVolumeMl,
    Quantity::MeanPressureMmhg,
];

/// Quantities that another unit repeats.
const REPEATED: [Quantity; 2] = [Quantity::MeanPressureKpa, Quantity::GreatestPressureKpa];

/// The quantities on offer, the usual ones first: all but the repeated ones.
pub(super) fn quantities() -> impl Iterator<Item = Quantity> {
    let is_further = |q: &Quantity| !USUAL.contains(q) && !REPEATED.contains(q);
    USUAL.into_iter().chain(Quantity::ALL.into_iter().filter(is_further))
}

/// What a point of layered tissue without an answer is that was not solved in full: the chart leaves the last method of the
/// solver out there, which takes seconds.
const NOT_COMPUTED: &str = "Not computed here: the quick method of the chart has no answer. A click computes this plan in full.";

/// Does a quantity exist in this tissue model?
pub(super) fn applies(quantity: Quantity, is_layered: bool) -> bool {
    is_layered || !quantity.is_of_layers()
}

/// A value of a quantity with its unit, as "21 %".
pub(super) fn text(quantity: Quantity, value: f64) -> String {
    let (factor, unit) = quantity.display();
    if unit == "mmHg" {
        return pressure(factor * value);
    }
    let decimals = match unit {
        "mm" | "N" | "kPa" => 1,
        _ => 0,
    };
    // No minus sign before a zero.
    let shown = (value * factor * 10f64.powi(decimals)).round() / 10f64.powi(decimals) + 0.0;
    format!("{} {unit}", fixed(shown, decimals as usize))
}

/// The place of a point, as "Width 12 cm, projection 4 cm".
pub(super) fn place(map: &Map, i: usize, j: usize) -> String {
    let axes = map.axes().iter().zip([i, j]);
    let parts: Vec<String> = axes
        .enumerate()
        .map(|(k, (axis, index))| {
            let words = Words::of(axis.field);
            let name = if k == 0 { words.name.to_owned() } else { lower(words.name) };
            format!("{name} {}", words.text(axis.value(index)))
        })
        .collect();
    parts.join(", ")
}

fn lower(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// The values of a point, one per line: `first`, then the others in their order. A value between computed points is
/// marked; a point without an answer has the reason.
pub(super) fn lines(map: JudgedMap<'_>, i: usize, j: usize, first: Quantity) -> Vec<String> {
    let others = quantities().filter(|quantity| *quantity != first);
    let values = std::iter::once(first).chain(others).filter_map(|quantity| {
        let (value, is_solved) = map.displayed(quantity, i, j)?;
        let about = if is_solved { "" } else { tr("about ") };
        let error = map
            .interpolated(quantity, i, j)
            .filter(|(_, error)| *error > 0.0)
            .map_or_else(String::new, |(_, error)| format!(" ± {}", within_text(quantity, error)));
        let word =
            word(map, quantity, value, (i, j)).map_or_else(String::new, |w| format!(", {w}"));
        Some(format!("{}: {about}{}{error}{word}", tr(quantity.title()), text(quantity, value)))
    });
    let mut lines: Vec<String> = values.collect();
    let reason = match map.status(i, j) {
        PointStatus::Converged => None,
        PointStatus::Waiting if lines.is_empty() => Some(tr("Being computed.").to_owned()),
        PointStatus::Waiting => {
            Some(tr("Values between computed points; being computed.").to_owned())
        }
        PointStatus::NotConverged | PointStatus::NoShape if !is_final(&map, i, j) => {
            Some(tr(NOT_COMPUTED).to_owned())
        }
        PointStatus::NotConverged => {
            Some(tr("No numbers: the computation was not finished.").to_owned())
        }
        PointStatus::NoShape => Some(tr("No stable shape.").to_owned()),
        PointStatus::Invalid => {
            let error = map.case(i, j).and_then(|case| case.error.clone());
            Some(tr!(
                "No answer: {reason}.",
                reason = error.unwrap_or_else(|| tr("out of range").to_owned())
            ))
        }
    };
    lines.splice(0..0, reason);
    let is_between = map.source(i, j) == Some(Source::Interpolated) && lines.len() > 1;
    lines.extend(
        is_between.then(|| tr("Between computed plans. A click computes this one.").to_owned()),
    );
    lines
}

/// The word of a value at a point: that of the cards.
fn word(
    map: JudgedMap<'_>,
    quantity: Quantity,
    value: f64,
    (i, j): (usize, usize),
) -> Option<&'static str> {
    if quantity == Quantity::GreatestStrain {
        let reserve = map.displayed(Quantity::SkinReserveUsed, i, j);
        let reserve = reserve.map(|(share, _)| share);
        return Some(tr(bands::stretch_by(map.practice_of_point(i, j), value, reserve).1));
    }
    let (limits, factor) = quantity.limits(SkinLimits::Tearing)?;
    Some(word_of(&limits, limits.word(factor * value)))
}

/// Is the missing answer of a point that of a plan? The quick solve of a sheet is the full one.
pub(super) fn is_final(map: &Map, i: usize, j: usize) -> bool {
    !map.base().is_layered() || map.is_in_full(i, j)
}

/// The worst of the three cards.
pub(super) struct Worst {
    pub(super) quantity: Quantity,
    /// Level of its word; 0: calm.
    pub(super) level: usize,
    /// As "Skin stretch: 31 %, high".
    pub(super) words: String,
}

/// The worst of stretch, cover and pressure at a point; the first of equal ones.
///
/// `displayed`: the value of a quantity, and whether the value is solved; `practice`: that of the point.
pub(super) fn worst(
    practice: Option<PracticeStretch>,
    displayed: &dyn Fn(Quantity) -> Option<(f64, bool)>,
) -> Option<Worst> {
    let value = |quantity: Quantity| displayed(quantity).map(|(value, _)| value);
    let (strain, is_solved) = displayed(Quantity::GreatestStrain)?;
    let mut worst = (
        Quantity::GreatestStrain,
        strain,
        bands::stretch_by(practice, strain, value(Quantity::SkinReserveUsed)),
    );
    let cover = value(Quantity::LeastCoverMm)
        .and_then(|cover| Some((Quantity::LeastCoverMm, cover, bands::cover(cover)?)));
    let pressure = value(Quantity::GreatestPressureMmhg)
        .map(|most| (Quantity::GreatestPressureMmhg, most, bands::PRESSURE.verdict(most)));
    for other in [cover, pressure].into_iter().flatten() {
        if other.2.0 > worst.2.0 {
            worst = other;
        }
    }
    let (quantity, value, (level, word)) = worst;
    let word =
        quantity.limits(SkinLimits::Tearing).map_or(tr(word), |(limits, _)| word_of(&limits, word));
    let about = if is_solved { "" } else { tr("about ") };
    let words = format!("{}: {about}{}, {word}", tr(quantity.title()), text(quantity, value));
    Some(Worst { quantity, level, words })
}

/// A point in few lines: its size, what is missing, the worst of the three cards, the colour's quantity if that is another
/// one.
pub(super) fn short(map: JudgedMap<'_>, i: usize, j: usize, first: Quantity) -> Vec<String> {
    let mut size = place(&map, i, j);
    let is_size = map.axes().iter().any(|axis| axis.field.moves_implant());
    let has_volume = map.axes().iter().any(|axis| axis.field == Parameter::Volume);
    if is_size
        && !has_volume
        && let Ok(scene) = map.scene(i, j)
        && let Some(volume) = Parameter::Volume.value(&scene)
    {
        size += &format!(", {volume:.0} ml");
    }
    let all = lines(map, i, j, first);
    let Some(Worst { quantity, mut words, .. }) =
        worst(map.practice_of_point(i, j), &|quantity| map.displayed(quantity, i, j))
    else {
        return std::iter::once(size).chain(all.into_iter().take(1)).collect();
    };
    if let Some((_, error)) = map.interpolated(quantity, i, j) {
        words += &format!(" (± {})", within_text(quantity, error));
    }
    let mut short = vec![size, words];
    let start = format!("{}: ", tr(first.title()));
    let of_first = all.into_iter().find(|line| line.starts_with(&start));
    short.extend(of_first.filter(|_| quantity != first));
    short
}

/// A point in one sentence, for screen readers: its place and the first values.
pub(super) fn sentence(map: JudgedMap<'_>, i: usize, j: usize, first: Quantity) -> String {
    const VALUES: usize = 4;
    let mut lines = lines(map, i, j, first);
    lines.truncate(VALUES);
    let values = lines.join("; ").replace('%', tr("percent"));
    format!("{}: {}.", place(&map, i, j), values.trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::study::{Axis, Case, Cases, MapSettings, Study, evaluate};

    fn judged(map: &Map) -> JudgedMap<'_> {
        JudgedMap { map, practice: None }
    }

    fn map() -> Map {
        let axes = ["base_width_mm=100:140:3", "projection_mm=30:50:3"];
        let axes = axes.map(|axis| Axis::parse(axis).unwrap());
        let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
        Map::new(&Scene::opening(), &axes, settings).unwrap()
    }

    #[test]
    fn the_values_of_a_point_are_those_of_its_case() {
        let (mut map, mut store) = (map(), Cases::default());
        let first = Quantity::GreatestStrain;
        assert_eq!(lines(judged(&map), 1, 1, first), ["Being computed."]);
        // The corners are solved before the middle.
        let (index, mut job) = map.next_job(&mut store).unwrap();
        job.scenes.truncate(4);
        let mut cases = evaluate(&job);
        cases.resize(
            9,
            Case { status: None, error: Some("a defect".to_owned()), ..Case::default() },
        );
        map.receive(index, cases, &mut store);
        let shown = lines(judged(&map), 0, 0, first);
        let strain = map.value(first, 0, 0).unwrap();
        assert_eq!(shown[0], format!("Skin stretch: {:.0} %, reserve left", 100.0 * strain));
        let cover = map.value(Quantity::LeastCoverMm, 0, 0).unwrap();
        assert!(shown.contains(&format!("Least cover: {cover:.1} mm")), "{shown:?}");
        assert_eq!(shown.len(), quantities().count());
        // Another quantity comes first on request.
        let force = map.value(Quantity::ForceN, 0, 0).unwrap();
        assert_eq!(
            lines(judged(&map), 0, 0, Quantity::ForceN)[0],
            format!("Force, vertical: {force:.1} N")
        );
        // In short: the size, the worst of the three, the colour's quantity.
        let short_of = |quantity| short(judged(&map), 0, 0, quantity);
        let stretch = format!("Skin stretch: {:.0} %, reserve left", 100.0 * strain);
        let size = "Width 10 cm, projection 3 cm, 157 ml".to_owned();
        assert_eq!(short_of(first), [size.clone(), stretch.clone()]);
        let of_force = format!("Force, vertical: {force:.1} N");
        assert_eq!(short_of(Quantity::ForceN), [size, stretch, of_force]);
        assert_eq!(short(judged(&map), 1, 1, first)[1], "No answer: a defect.");
        let words = sentence(judged(&map), 0, 0, first);
        assert!(words.starts_with("Width 10 cm, projection 3 cm: Skin stretch: "), "{words}");
        assert!(words.contains(" percent, reserve left; ") && words.ends_with('.'), "{words}");
        assert_eq!(lines(judged(&map), 1, 1, first)[0], "No answer: a defect.");
    }

    #[test]
    fn a_value_between_computed_points_is_marked() {
        let axis = Axis::parse("projection_mm=30:50:41").unwrap();
        let mut map = Map::new(&Scene::opening(), &[axis], MapSettings::default()).unwrap();
        let mut store = Cases::default();
        let (index, job) = map.next_job(&mut store).unwrap();
        map.receive(index, evaluate(&job), &mut store);
        let is_between = |i: &usize| {
            map.status(*i, 0) == PointStatus::Waiting
                && map.displayed(Quantity::GreatestStrain, *i, 0).is_some()
        };
        let waiting = (0..41).find(is_between).unwrap();
        let shown = lines(judged(&map), waiting, 0, Quantity::GreatestStrain);
        assert!(shown[0].starts_with("Values between computed points"), "{shown:?}");
        assert!(shown[1].starts_with("Skin stretch: about "), "{shown:?}");
    }

    #[test]
    fn numbers_have_few_digits_and_zero_no_sign() {
        assert_eq!(text(Quantity::GreatestStrain, 0.2149), "21 %");
        assert_eq!(text(Quantity::SkinAreaGainCm2, -0.2), "0 cm²");
        assert_eq!(text(Quantity::LeastCoverMm, 7.25), "7.3 mm");
        let offered = |quantity| quantities().filter(|offered| *offered == quantity).count();
        let kpa = [Quantity::MeanPressureKpa, Quantity::GreatestPressureKpa];
        assert!(Quantity::ALL.into_iter().all(|q| offered(q) == usize::from(!kpa.contains(&q))));
    }
}

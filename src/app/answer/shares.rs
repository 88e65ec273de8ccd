//! How many of the sampled patients have which word, in tenths, as "Usual in 6 of 10 such patients, high 3, very high 1".

use crate::app::texts::tr;
use crate::measure::bands::PracticeStretch;
use std::collections::BTreeMap;

/// Parts of all patients.
const PARTS: usize = 10;

/// A word with its number of patients in tenths.
type Part = (&'static str, usize);

/// The parts of patients by band and word in the language of the user, from the lowest band; the last part is of those without an answer. `None` without patients.
pub(super) fn in_words(
    words: impl Iterator<Item = (usize, &'static str)>,
    without_answer: usize,
) -> Option<String> {
    sentence(&parts(words, without_answer)?)
}

/// [`in_words`] of the words against practice, as "More than practice's 300 ml in the same skin: 7 of 10 patients, as practice 3": the word of
/// most patients comes first. `ml`: practice's volume \[ml\].
pub(super) fn against_practice(
    words: impl Iterator<Item = (usize, &'static str)>,
    without_answer: usize,
    ml: f64,
) -> Option<String> {
    let parts = parts(words, without_answer)?;
    let &(word, part) = parts.iter().max_by_key(|(_, part)| *part)?;
    let [below, same, above] = PracticeStretch::WORDS.map(tr);
    let first = if word == above {
        tr!("More than practice's {ml:.0} ml in the same skin: {part} of 10 patients", ml, part)
    } else if word == same {
        tr!("As practice's {ml:.0} ml in the same skin: {part} of 10 patients", ml, part)
    } else if word == below {
        tr!("Less than practice's {ml:.0} ml in the same skin: {part} of 10 patients", ml, part)
    } else {
        return sentence(&parts);
    };
    let rest: Vec<Part> = parts.into_iter().filter(|(other, _)| *other != word).collect();
    Some(with_rest(first, &rest))
}

/// The words with their parts, from the lowest band, without empty parts.
fn parts(
    words: impl Iterator<Item = (usize, &'static str)>,
    without_answer: usize,
) -> Option<Vec<Part>> {
    let mut counts = BTreeMap::new();
    for word in words {
        *counts.entry(word).or_insert(0) += 1;
    }
    let mut counts: Vec<Part> =
        counts.into_iter().map(|((_, word), count)| (word, count)).collect();
    counts.push((tr("no answer"), without_answer));
    let parts = tenths(&counts.iter().map(|(_, count)| *count).collect::<Vec<_>>())?;
    let named = counts.iter().map(|(word, _)| *word).zip(parts).filter(|(_, part)| *part > 0);
    Some(named.collect())
}

fn sentence(parts: &[Part]) -> Option<String> {
    let (&(word, part), rest) = parts.split_first()?;
    let first = tr!("{word} in {part} of 10 such patients", word, part);
    let text = with_rest(first, rest);
    let mut letters = text.chars();
    Some(letters.next()?.to_uppercase().chain(letters).collect())
}

/// A text with further parts.
fn with_rest(first: String, rest: &[Part]) -> String {
    rest.iter().fold(first, |text, (word, part)| format!("{text}, {word} {part}"))
}

/// Counts in tenths of their sum, which add up to ten: the greatest remainders are rounded up. `None` if all are zero.
fn tenths(counts: &[usize]) -> Option<Vec<usize>> {
    let sum: usize = counts.iter().sum();
    if sum == 0 {
        return None;
    }
    let mut parts: Vec<usize> = counts.iter().map(|count| PARTS * count / sum).collect();
    let mut order: Vec<usize> = (0..counts.len()).collect();
    // Of equal remainders the graver word's.
    order.sort_by_key(|k| std::cmp::Reverse((PARTS * counts[*k] % sum, *k)));
    let left = PARTS - parts.iter().sum::<usize>();
    order.into_iter().take(left).for_each(|k| parts[k] += 1);
    Some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parts_add_up_to_ten_and_are_those_of_the_counts_to_rounding() {
        for counts in [vec![1], vec![160, 70, 26], vec![3, 3, 3], vec![0, 255, 1], vec![7; 9]] {
            let parts = tenths(&counts).unwrap();
            let sum: usize = counts.iter().sum();
            assert_eq!(parts.iter().sum::<usize>(), 10, "{counts:?}");
            for (part, count) in parts.into_iter().zip(&counts) {
                let exact = 10.0 * *count as f64 / sum as f64;
                assert!((part as f64 - exact).abs() < 1.0, "{counts:?}");
            }
        }
        assert_eq!(tenths(&[0, 0]), None);
    }

    #[test]
    fn words_stand_from_the_lowest_band_and_those_of_few_patients_not_at_all() {
        let of = |counts: [usize; 3], without_answer| {
            let words = [(0, "usual"), (1, "high"), (2, "very high")];
            let all = words.into_iter().zip(counts);
            // From the highest, as a study may find them.
            let all = all.rev().flat_map(|(word, count)| std::iter::repeat_n(word, count));
            in_words(all, without_answer)
        };
        let words = |text: &str| Some(text.to_owned());
        let all = words("Usual in 6 of 10 such patients, high 3, very high 1");
        assert_eq!(of([160, 70, 26], 0), all);
        assert_eq!(of([255, 1, 0], 0), words("Usual in 10 of 10 such patients"));
        assert_eq!(of([0, 8, 0], 2), words("High in 8 of 10 such patients, no answer 2"));
        let many = words("Usual in 4 of 10 such patients, high 3, very high 2, no answer 1");
        assert_eq!(of([4, 3, 2], 1), many);
        assert_eq!(of([0, 0, 0], 0), None);
    }

    #[test]
    fn words_against_practice_say_in_whose_skin_practices_volume_is() {
        let practice = PracticeStretch { less: 0.19, same: 0.21, more: 0.23 };
        let of = |strains: &[f64]| {
            against_practice(strains.iter().map(|strain| practice.verdict(*strain)), 0, 300.0)
        };
        for (strains, expected) in [
            (&[0.3; 5][..], "More than practice's 300 ml in the same skin: 10 of 10 patients"),
            (
                &[0.3, 0.3, 0.2, 0.3, 0.1],
                "More than practice's 300 ml in the same skin: 6 of 10 patients, as practice 2, below practice 2",
            ),
            (
                &[0.2, 0.2, 0.3],
                "As practice's 300 ml in the same skin: 7 of 10 patients, above practice 3",
            ),
            (&[0.1], "Less than practice's 300 ml in the same skin: 10 of 10 patients"),
            (&[0.51, 0.51, 0.3], "Above practice in 3 of 10 such patients, very high 7"),
        ] {
            assert_eq!(of(strains).as_deref(), Some(expected));
        }
    }
}

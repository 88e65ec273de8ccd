//! Warnings of many scenes: those that differ in their figures alone count as one.

use std::collections::BTreeMap;

/// Sentences that differ in their figures alone.
struct Same<'a> {
    words: Vec<&'a str>,
    /// Least and greatest figure after each part of the words but the last.
    ranges: Vec<[&'a str; 2]>,
    count: usize,
}

/// Warnings with their numbers of scenes. Figures that differ between scenes are written as "0.12 to 0.53".
pub(super) fn counted<'a>(warnings: impl Iterator<Item = &'a String>) -> BTreeMap<String, usize> {
    let mut all: Vec<Same> = Vec::new();
    for warning in warnings {
        let (words, figures) = split(warning);
        match all.iter_mut().find(|same| same.words == words) {
            Some(same) => same.add(figures),
            None => {
                let ranges = figures.into_iter().map(|figure| [figure; 2]).collect();
                all.push(Same { words, ranges, count: 1 });
            }
        }
    }
    all.iter().map(|same| (same.joined(), same.count)).collect()
}

impl<'a> Same<'a> {
    fn add(&mut self, figures: Vec<&'a str>) {
        self.count += 1;
        for ([least, most], figure) in self.ranges.iter_mut().zip(figures) {
            if value(figure) < value(least) {
                *least = figure;
            } else if value(figure) > value(most) {
                *most = figure;
            }
        }
    }

    fn joined(&self) -> String {
        let mut sentence = String::new();
        for (k, part) in self.words.iter().enumerate() {
            sentence += part;
            let Some([least, most]) = self.ranges.get(k) else { break };
            sentence += least;
            if least != most {
                sentence += " to ";
                sentence += most;
            }
        }
        sentence
    }
}

/// A sentence as words and the figures between them: one part of words more than figures. Digits of a name, as in "T2", are words.
fn split(sentence: &str) -> (Vec<&str>, Vec<&str>) {
    let (mut words, mut figures) = (Vec::new(), Vec::new());
    let (mut start, mut at) = (0, 0);
    while let Some(found) = sentence[at..].find(|c: char| c.is_ascii_digit()) {
        let from = at + found;
        let length = sentence[from..].find(|c: char| !c.is_ascii_digit() && c != '.');
        let run = &sentence[from..length.map_or(sentence.len(), |length| from + length)];
        at = from + run.len();
        let figure = run.trim_end_matches('.');
        let is_in_a_name = sentence[..from].ends_with(char::is_alphanumeric);
        if !is_in_a_name && figure.parse::<f64>().is_ok() {
            words.push(&sentence[start..from]);
            figures.push(figure);
            start = from + figure.len();
        }
    }
    words.push(&sentence[start..]);
    (words, figures)
}

fn value(figure: &str) -> f64 {
    figure.parse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_that_differ_in_figures_count_as_one_with_their_ranges() {
        let texts =
            ["T2 grew by 0.5 of 1.", "T2 grew by 0.12 of 1.", "No figure.", "T3 grew by 2 of 1."]
                .map(str::to_owned);
        let counted: Vec<_> = counted(texts.iter().chain(&texts[2..3])).into_iter().collect();
        let expected =
            [("No figure.", 2), ("T2 grew by 0.12 to 0.5 of 1.", 2), ("T3 grew by 2 of 1.", 1)];
        assert_eq!(counted, expected.map(|(text, count)| (text.to_owned(), count)));
        let counted = super::counted([String::from("10 mm"), String::from("9 mm, 3.2.1")].iter());
        assert_eq!(counted.into_keys().collect::<Vec<_>>(), ["10 mm", "9 mm, 3.2.1"]);
    }
}

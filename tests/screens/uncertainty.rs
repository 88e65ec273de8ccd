//! The section "Uncertainty": bands of the study in the answer, restarted by edits.

use super::*;
use implant_preview::measure::bands::PracticeStretch;
use implant_preview::study::{
    Band, Bands, BandsSettings, Cases, Practice, Quantity, Study, UsualRange, evaluate,
};

const FOLD: &str = "Uncertainty";
const SWITCH: &str = "Show what is not known";
const VARIED: &str = "What is varied";
const DONE: &str = "16 sampled patients.";
const FIGURES: [Quantity; 2] = [Quantity::GreatestStrain, Quantity::GreatestPressureMmhg];

/// A sheet with few samples, all of them solved.
pub(super) fn sampled(size: egui::Vec2) -> Harness<'static, App> {
    let mut harness = researching(size, |scene| {
        *scene = flat_plan();
        scene.set_tissue_model(TissueModel::Sheet);
    });
    if size == PHONE {
        super::press(&mut harness, "More");
    }
    show_unknown(&mut harness);
    harness
}

/// Opens the section, switches the study on and reduces its samples.
fn show_unknown(harness: &mut Harness<'static, App>) {
    press(harness, FOLD);
    press(harness, SWITCH);
    press(harness, VARIED);
    type_into(harness, "Sampled patients", "16");
    wait(harness);
}

/// Scrolls to a control and clicks it.
pub(super) fn press(harness: &mut Harness<'static, App>, label: &str) {
    harness.get_by_label(label).scroll_to_me();
    harness.run();
    harness.get_by_label(label).click();
    harness.run();
}

/// Runs frames until the study is done.
pub(super) fn wait(harness: &mut Harness<'static, App>) {
    let start = std::time::Instant::now();
    let is_done = |harness: &Harness<'static, App>| harness.query_by_label(DONE).is_some();
    while !is_done(harness) {
        assert!(start.elapsed().as_secs() < 300, "the study does not end");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

pub(super) fn settings() -> BandsSettings {
    BandsSettings { samples: 16, importance_rows: 16, ..BandsSettings::default() }
}

/// The study of a scene, solved without the app.
pub(super) fn study_of(scene: &Scene, settings: BandsSettings) -> Bands {
    let (mut bands, mut store) = (Bands::new(scene, settings).unwrap(), Cases::default());
    while let Some((index, job)) = bands.next_job(&mut store) {
        bands.receive(index, evaluate(&job), &mut store);
    }
    assert!(bands.is_done());
    bands
}

pub(super) fn band(bands: &[Band], quantity: Quantity) -> &Band {
    bands.iter().find(|band| band.quantity == quantity).unwrap()
}

/// A pressure of the screen \[mmHg\].
fn pressure(mmhg: f64) -> String {
    if mmhg > 100.0 { "over 100 mmHg".to_owned() } else { format!("{mmhg:.0} mmHg") }
}

/// The plan's own figure of a card.
fn figure(harness: &Harness<'static, App>, quantity: Quantity) -> String {
    let (factor, unit) = quantity.display();
    let value = factor * quantity.of(&harness.state().outcome().unwrap()).unwrap();
    if unit == "mmHg" { pressure(value) } else { format!("{value:.0} {unit}") }
}

/// The range of a band as a card has it.
fn range(band: &Band) -> String {
    let (factor, unit) = band.quantity.display();
    let [low, high] = [band.p10, band.p90].map(|value| factor * value);
    let is_over = unit == "mmHg" && high > 100.0;
    let high = if is_over { " to over 100".to_owned() } else { format!("–{high:.0}") };
    format!("{low:.0}{high}")
}

/// Are the figures those of the plan, and the brackets beside them those of the study?
pub(super) fn assert_cards(harness: &Harness<'static, App>, bands: &[Band]) {
    for quantity in FIGURES {
        let (figure, range) =
            (figure(harness, quantity), format!("({}) ", range(band(bands, quantity))));
        assert!(harness.query_all_by_label(&figure).count() > 0, "{figure}");
        assert!(harness.query_all_by_label_contains(&range).count() > 0, "{range}");
    }
}

/// The words of a plan whose patients have other words, too: the sentence and the summary with the bands are those without, and the
/// patients of each word are counted beside them.
#[test]
fn the_verdict_is_that_of_the_plan_with_and_without_bands() {
    let mut harness = researching(WIDE, |scene| {
        *scene = flat_plan();
        scene.set_tissue_model(TissueModel::Sheet);
        scene.implant.projection_mm = 45.0;
    });
    let sentence = |harness: &Harness<'static, App>| {
        let found = harness.query_all_by_label_contains(" ml, 12 cm: ");
        found.map(|node| node.accesskit_node().label().or(node.value())).collect::<Vec<_>>()
    };
    let words = |harness: &Harness<'static, App>| {
        let summary = harness.state().summary();
        summary.split_inclusive("Up to date.").next().unwrap().to_owned()
    };
    wait_until(&mut harness, "the end", |harness| harness.query_by_label("Up to date").map(|_| ()));
    let before = (sentence(&harness), words(&harness));
    assert_eq!(before.0.len(), 1, "{before:?}");
    show_unknown(&mut harness);
    assert_eq!((sentence(&harness), words(&harness)), before);

    let study = study_of(harness.state().session().scene(), settings());
    let strains: Vec<f64> = study.values().of(Quantity::GreatestStrain).collect();
    let [usual, high] = [(0.0, 0.25), (0.25, 0.5)].map(|(over, most)| {
        strains.iter().filter(|strain| (over..=most).contains(*strain)).count()
    });
    assert!(usual + high == 16 && usual > 0 && high > 0, "{strains:?}");
    let [usual, high] = [usual, high].map(|count| (10 * count) as f64 / 16.0);
    let near = |part: usize, exact: f64| (part as f64 - exact).abs() < 1.0;
    let parts = (0..=10).filter(|part| near(*part, usual) && near(10 - part, high));
    let lines: Vec<String> = parts
        .map(|part| format!("Usual in {part} of 10 such patients, high {}", 10 - part))
        .collect();
    assert!(lines.iter().any(|line| harness.query_by_label(line).is_some()), "{lines:?}");
}

/// A plan that nobody touches: its cards have the words and the bands of a few patients, and are as high as without.
#[test]
fn the_word_of_a_sampled_patient_is_that_against_practice_in_its_own_tissue() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let shares =
        wait_until(&mut harness, "the shares", |harness| text_with(harness, " of 10 patients"));
    let scene = harness.state().session().scene().clone();
    let practice = Practice::new(&scene, &PracticeTable::default()).unwrap();
    let [less, _, more] = practice.scenes().clone();
    let strains = |scene: &Scene| -> Vec<f64> {
        let settings = BandsSettings { samples: 16, importance_rows: 0, ..settings() };
        study_of(scene, settings).values().of(Quantity::GreatestStrain).collect()
    };
    let [own, less, more] = [&scene, &less, &more].map(strains);
    assert_eq!([own.len(), less.len(), more.len()], [16; 3]);
    let words = own
        .iter()
        .zip(less)
        .zip(more)
        .map(|((own, less), more)| PracticeStretch { less, same: less, more }.verdict(*own).1);
    let words: Vec<&str> = words.collect();
    for (word, start) in
        [("below practice", "Less than"), ("as practice", "As"), ("above practice", "More than")]
    {
        let count = words.iter().filter(|other| **other == word).count();
        let first = format!("{start} practice's 300 ml in the same skin: ");
        let stated = shares.split(", ").find_map(|part| {
            let rest = part.strip_prefix(&first).or(part.strip_prefix(word))?;
            rest.trim().split(' ').next()?.parse::<usize>().ok()
        });
        let tenths = 10.0 * count as f64 / 16.0;
        assert!((stated.unwrap_or(0) as f64 - tenths).abs() < 1.0, "{shares}: {count} {word}");
    }
    // The card says so, and only that of the stretch.
    let own_tissue = "Each of them is compared with practice's volume in their own tissue";
    for (card, is_of_practice) in [("Skin stretch", true), ("Cover over implant", false)] {
        let at = harness.get_by_label(card).rect().center() + egui::vec2(0.0, 60.0);
        harness.hover_at(at);
        // The tooltip of the previous card goes.
        harness.step();
        harness.step();
        let patients = "Such patients: 16 computed ones";
        let words = wait_until(&mut harness, "the tooltip", |harness| text_with(harness, patients));
        assert_eq!(words.contains(own_tissue), is_of_practice, "{words}");
    }
}

#[test]
fn a_plan_at_rest_has_the_shares_and_bands_of_a_few_patients() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let height = |harness: &Harness<'static, App>| {
        let top = |label| harness.get_by_label(label).rect().top();
        top(FOLD) - top("Cover over implant")
    };
    let before = height(&harness);
    let few = BandsSettings { importance_rows: 0, ..settings() };
    let assert_few = |harness: &mut Harness<'static, App>| {
        wait_until(harness, "the shares", |harness| text_with(harness, " of 10 "));
        assert!((height(harness) - before).abs() < 0.1);
        let scene = harness.state().session().scene().clone();
        let bands = study_of(&scene, few.clone()).bands();
        assert_cards(harness, &bands);
        let summary = harness.state().summary();
        for words in [" Cover over implant: not thin in ", " Pressure on the tissue: usual in "] {
            assert!(summary.contains(words), "{summary}");
        }
        assert!(summary.contains(" of 10 "), "{summary}");
        // The study of the section is off.
        assert_eq!(harness.state().stats().samples_all, 0);
    };
    assert_few(&mut harness);
    type_into(&mut harness, "Volume (ml)", "280");
    assert_few(&mut harness);
    settle(&mut harness);
}

#[test]
fn the_section_has_a_switch_and_its_use_then_the_answer_and_at_its_end_what_is_varied() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    let has = |harness: &Harness<'static, App>, label| text_with(harness, label).is_some();
    press(&mut harness, FOLD);
    let form = ["Sampled patients", "Poisson ratio", VARIED];
    assert!(has(&harness, "The range of every number over what is not known about a patient"));
    assert!(form.iter().all(|label| !has(&harness, label)));
    press(&mut harness, SWITCH);
    assert!(!has(&harness, "The range of every number over what is not known about a patient"));
    assert!(form[..2].iter().all(|label| !has(&harness, label)));
    press(&mut harness, VARIED);
    type_into(&mut harness, "Sampled patients", "16");
    wait(&mut harness);
    let top = |label| harness.get_by_label(label).rect().top();
    let answer = [SWITCH, DONE, "Envelopes in the picture", VARIED, "Back to the usual spread"];
    let answer = answer.map(top);
    assert!(answer.is_sorted(), "{answer:?}");
}

#[test]
fn bands_are_those_of_the_study_and_stand_beside_every_number() {
    // One study, seen in every place that shows it.
    let mut harness = sampled(WIDE);
    let solves = harness.state().session().counters().solves;
    let scene = harness.state().session().scene().clone();
    let study = study_of(&scene, settings());
    let bands = study.bands();
    assert_cards(&harness, &bands);
    harness.get_by_label("An illustration from a simplified model, not a prediction for a person.");
    harness
        .get_by_label_contains("the range of 8 in 10 sampled patients (10th to 90th percentile)");

    // The chart has a bar for each unknown, the greatest first.
    let explained = study.importance(Quantity::GreatestStrain);
    let mut shares: Vec<f64> = explained.iter().map(|index| index.unwrap().first_order).collect();
    shares.sort_by(|a, b| b.total_cmp(a));
    let bars = |harness: &Harness<'static, App>| {
        let bars = harness.query_all_by_label_contains("% of the spread alone");
        let mut bars: Vec<_> = bars.map(|bar| (bar.rect().top(), bar.value().unwrap())).collect();
        bars.sort_by(|a, b| a.0.total_cmp(&b.0));
        bars.into_iter().map(|(_, label)| label).collect::<Vec<_>>()
    };
    let percent = |share: &f64| format!(": {:.0} ± ", 100.0 * share.clamp(0.0, 1.0));
    let by_strain = bars(&harness);
    assert_eq!(by_strain.len(), study.unknowns().len());
    for (bar, share) in by_strain.iter().zip(&shares) {
        assert!(bar.contains(&percent(share)), "{bar} {share}");
    }
    harness.get_by_role_and_label(Role::ComboBox, "What matters most for").click();
    harness.run();
    // The list scrolls.
    press(&mut harness, "volume of the implant (ml)");
    let by_volume = bars(&harness);
    assert_ne!(by_volume, by_strain);
    // The volume depends on the projection alone.
    assert!(by_volume[0].starts_with("Projection in the body: "), "{by_volume:?}");
    let is_zero = |bar: &String| bar.contains(": 0 ± 0 % of the spread alone");
    assert!(!is_zero(&by_volume[0]) && by_volume[1..].iter().all(is_zero), "{by_volume:?}");

    // Scenarios of the method of measurement stand in a table of their own; without a factor the figure is that of the card.
    for factor in ["× 0.4", "× 1", "× 2.5"] {
        harness.get_by_label(factor);
    }
    let own = Quantity::GreatestPressureMmhg.of(&harness.state().outcome().unwrap()).unwrap();
    let scenarios = &band(&bands, Quantity::GreatestPressureMmhg).scenarios;
    let [low, unchanged, high] = [0, 1, 2].map(|k| scenarios[k].value.unwrap());
    for (change, count) in [(low / unchanged, 1), (1.0, 2), (high / unchanged, 1)] {
        let text = pressure(own * change);
        assert!(harness.query_all_by_label(&text).count() >= count, "{text}");
    }

    press(&mut harness, "Details");
    // The volume is given.
    let of_results = bands.iter().filter(|band| band.quantity != Quantity::ImplantVolumeMl);
    let count = harness.query_all_by_label("    8 in 10 patients").count();
    assert_eq!(count, of_results.clone().count());
    for band in of_results {
        let text = match band.quantity.display().1 {
            "mmHg" => range(band),
            _ => band.range().to_owned(),
        };
        assert!(harness.query_all_by_label(&text).count() > 0, "{}: {text}", band.text);
    }
    let sampled = "skin of 8 in 10 sampled patients";
    assert!(painted_texts(&harness).iter().any(|text| text == sampled));
    let summary = harness.state().summary();
    for quantity in FIGURES {
        let Band { text, p10, p90, .. } = band(&bands, quantity);
        match quantity.display().1 {
            "mmHg" if *p90 > 100.0 => {
                assert!(summary.contains(&format!(", {p10:.0} to over 100.")), "{summary}");
            }
            _ => assert!(summary.contains(text), "{summary}"),
        }
    }
    assert!(summary.contains("not a prediction for a person"), "{summary}");
    // The session solves nothing for the study; at the end the app is at rest.
    assert_eq!(harness.state().session().counters().solves, solves);
    settle(&mut harness);

    press(&mut harness, SWITCH);
    for quantity in FIGURES {
        assert!(harness.query_by_label(&band(&bands, quantity).text).is_none());
    }
    assert_eq!(harness.query_all_by_label("    8 in 10 patients").count(), 0);
    assert!(!harness.state().summary().contains("sampled"));
}

#[test]
fn an_edit_of_the_plan_restarts_the_study() {
    let mut harness = sampled(WIDE);
    let before = study_of(harness.state().session().scene(), settings()).bands();
    assert_cards(&harness, &before);
    type_into(&mut harness, "Width (cm)", "12,5");
    // The bands of the previous plan are gone at once.
    assert!(harness.query_by_label(DONE).is_none());
    assert!(harness.query_by_label(&band(&before, Quantity::GreatestStrain).text).is_none());
    wait(&mut harness);
    let scene = harness.state().session().scene().clone();
    assert_eq!(scene.implant.base_radius_mm, 62.5);
    let after = study_of(&scene, settings()).bands();
    let text = |bands: &[Band]| band(bands, Quantity::GreatestPressureMmhg).text.clone();
    assert_ne!(text(&after), text(&before));
    assert_cards(&harness, &after);
}

#[test]
fn envelopes_are_lines_in_the_picture_on_demand() {
    let mut harness = sampled(DESKTOP);
    let lines = |harness: &Harness<'static, App>| {
        let area = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
        let shapes = harness.output().shapes.iter();
        let lines = shapes.filter(|shape| match &shape.shape {
            egui::Shape::Path(path) => {
                path.points.len() > 40 && path.points.iter().any(|point| area.contains(*point))
            }
            _ => false,
        });
        lines.count()
    };
    let none = lines(&harness);
    let name = "Envelopes in the picture";
    press(&mut harness, name);
    // Two directions: an outer line on its ground, and the ground of a dashed inner line.
    assert_eq!(lines(&harness), none + 6);
    press(&mut harness, SWITCH);
    assert_eq!(lines(&harness), none);
}

#[test]
fn on_a_phone_the_figures_of_the_bands_fit_above_the_tabs() {
    let harness = sampled(PHONE);
    // The name has the range where both fit in a line: that of a pressure beyond the studies is too long.
    for (quantity, name) in FIGURES.into_iter().zip(["Stretch (19–24)", "Pressure"]) {
        let text = &figure(&harness, quantity);
        let rects = |label| harness.query_all_by_label(label).map(|label| label.rect());
        let names: Vec<egui::Rect> = rects(name).collect();
        let is_below = |figure: &egui::Rect| {
            let is_under = |name: &egui::Rect| {
                let gap = figure.top() - name.bottom();
                (figure.left() - name.left()).abs() < 1.0 && (-1.0..4.0).contains(&gap)
            };
            names.iter().any(is_under)
        };
        let figure = rects(text).find(is_below).unwrap();
        // One line in a third of the width.
        assert!(figure.height() < 24.0 && figure.width() < PHONE.x / 3.0, "{text}: {figure:?}");
    }
}

#[test]
fn the_comparison_has_the_bands_of_pins_and_of_their_differences() {
    let mut harness = sampled(WIDE);
    let pinned = harness.state().session().scene().clone();
    super::press(&mut harness, "Pin as A");
    unfold(&mut harness, "More numbers");
    type_into(&mut harness, "Pinch (cm)", "2.5");
    wait(&mut harness);
    let study_of = |scene: &Scene| study_of(scene, settings()).values();
    let (a, now) = (study_of(&pinned), study_of(harness.state().session().scene()));
    let shown = |[low, _, high]: [f64; 3], factor: f64, decimals: usize| {
        let text = |value: f64| format!("{:.decimals$}", (factor * value).abs());
        assert!(low > 0.0 || high < 0.0, "no sign to choose: {low} {high}");
        if high < 0.0 {
            format!("−{} to −{}", text(low), text(high))
        } else {
            format!("{}–{}", text(low), text(high))
        }
    };
    let quantity = Quantity::SkinProjectionMm;
    for samples in [&a, &now] {
        let label = shown(samples.band(quantity).unwrap(), 1.0, 1);
        wait_for_label(&mut harness, &label);
    }
    press(&mut harness, "Differences in the table");
    let label = shown(now.difference(&a, quantity).unwrap(), 1.0, 1);
    wait_for_label(&mut harness, &label);
}

/// Runs frames until a label is there: the pins are sampled after the present plan.
fn wait_for_label(harness: &mut Harness<'static, App>, label: &str) {
    wait_until(harness, label, |harness| harness.query_all_by_label(label).next().map(drop));
}

#[test]
fn the_largest_usual_volume_has_the_range_of_sampled_patients() {
    const RANGE: &str = " in 8 of 10 patients); ";
    let mut harness = sampled(WIDE);
    // An edit starts the search of the largest volume; the bands come before its range.
    type_into(&mut harness, "Margin (cm)", "1.2");
    let words = wait_until(&mut harness, "the range", |harness| text_with(harness, RANGE));
    let scene = harness.state().session().scene().clone();
    // From the least mark of the slider to the highest profile sold, projections of 0.15 and 1.07 of half the width, in whole steps.
    let ends = (70.0, 480.0);
    let mut search = UsualRange::new(&scene, &settings(), ends, None).unwrap();
    let mut store = Cases::default();
    while let Some((index, job)) = search.next_job(&mut store) {
        search.receive(index, evaluate(&job), &mut store);
    }
    let found = search.found().unwrap();
    let [low, high] = [found.low_ml, found.high_ml].map(Option::unwrap);
    assert!(words.contains(&format!(" ({low:.0}–{high:.0} ml in 8 of 10 patients); ")), "{words}");
    // One patient's figure stands before the range.
    let own = volume_of(&words);
    assert!(own > 0.5 * low && own < 2.0 * high, "{words}");
    // Another volume of the same patient keeps the range.
    type_into(&mut harness, "Volume (ml)", "310");
    harness.step();
    assert_eq!(text_with(&harness, RANGE), Some(words));
}

//! Where the words of the cards change along the slider of the volume, where the model has no answer, and the largest volume
//! that stays usual. Computed once the first plan rests or a plan is edited.
//!
//! `headline` (on the screen) | `marks` (along a curve of volumes) | `width` (the studies of one width).

mod headline;
mod marks;
mod width;

pub(crate) use headline::headline;

use super::volume_band::VolumeBand;
use super::volumes::volumes;
use crate::app::answer::practice::{Against, Practices};
use crate::app::frame::studies::Studies;
use crate::app::texts::tr;
use crate::app::widgets::quantity::format_at_most;
use crate::clinical::STEP_ML;
use crate::contact::HALF_ELLIPSOID;
use crate::scene::Scene;
use crate::study::{BandsSettings, Map, Parameter, Quantity, breast_width_mm, with_values};
use eframe::egui;
use marks::Mark;
use web_time::{Duration, Instant};
use width::{MOST_RATIO, Width};

/// Share of the greatest volume with an answer from which a plan is near the model's limit \[-\].
const NEAR_END: f64 = 0.9;
/// Difference from the usual fullness from which a dome is named after it \[-\].
const LEAST_FULLER: f64 = 0.005;
/// Rest of the first plan before its marks are computed.
const REST: Duration = Duration::from_millis(300);

/// The study behind the marks.
#[derive(Default)]
pub(crate) struct VolumeMarks {
    /// The volumes of the plan's width.
    own: Width,
    /// The scene of the present curve.
    started: Option<Scene>,
    is_wanted: bool,
    /// Start of the rest of the first plan.
    rests_since: Option<Instant>,
    /// The volumes of the next width.
    beside: Width,
    /// The largest usual volume over sampled patients.
    band: VolumeBand,
}

impl VolumeMarks {
    /// The plan is edited: the marks are computed from now on.
    pub(crate) fn want(&mut self) {
        self.is_wanted = true;
    }

    /// The marks are computed from a rest of the first plan on: a page that opens has its picture first. `is_busy`: see
    /// [`Self::advance`].
    pub(crate) fn want_after_rest(&mut self, ctx: &egui::Context, is_busy: bool) {
        if self.is_wanted {
            return;
        }
        let since = (!is_busy).then(|| self.rests_since.unwrap_or_else(Instant::now));
        self.rests_since = since;
        match since.map(|since| since.elapsed()) {
            Some(rest) if rest >= REST => self.is_wanted = true,
            Some(rest) => ctx.request_repaint_after(REST - rest),
            None => {}
        }
    }

    /// Starts and continues the studies, once a frame. `bands`: the choices of the bands while they are on, and whether the bands
    /// are complete; `is_busy`: the plan is being solved or edited, or the nearest plans with an answer are searched.
    pub(crate) fn advance(
        &mut self,
        scene: &Scene,
        bands: Option<(BandsSettings, bool)>,
        practices: &Practices,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        if self.is_wanted && !is_busy && self.started.as_ref() != Some(scene) {
            self.restart(scene, studies);
        }
        // The marks of another patient, pocket or width say nothing about this one.
        let is_shown = self.is_of(scene);
        let against = practices.against(scene);
        if self.own.advance(studies, is_shown, against) {
            self.band.cancel(studies);
        }
        self.advance_beside(practices, studies, is_busy);
        let curve = self.own.curve().map(|curve| (curve.base(), curve.axes()[0]));
        self.band.advance(curve, |plan| practices.greatest(plan), bands, studies, is_busy);
    }

    /// The volumes of the next width, after those of the plan's own.
    fn advance_beside(&mut self, practices: &Practices, studies: &mut Studies, is_busy: bool) {
        if !is_busy
            && self.own.largest_ml().is_some()
            && let Some(curve) = self.own.curve()
        {
            let next = next_width(2.0 * curve.base().implant.base_radius_mm);
            let has_width =
                |beside: &Map| (2.0 * beside.base().implant.base_radius_mm - next).abs() < 1e-6;
            if !self.beside.any_curve().is_some_and(has_width) {
                match with_values(curve.base(), &[(Parameter::BaseWidth, next)]) {
                    Ok(wider) => {
                        self.beside.start(&wider, volumes(&wider.implant, MOST_RATIO), studies);
                    }
                    Err(_) => self.beside.cancel(studies),
                }
            }
        }
        let is_shown = self.own.largest_ml().is_some();
        let against = self
            .beside
            .any_curve()
            .map_or(Against::Waiting, |beside| practices.against(beside.base()));
        self.beside.advance(studies, is_shown, against);
    }

    /// Is the curve that of a plan, or of the plan with another volume or less of it in place?
    fn is_of(&self, plan: &Scene) -> bool {
        let is_other_volume = |started: &Scene| {
            let mut other = full(plan);
            other.implant.projection_mm = started.implant.projection_mm;
            other.same_physics(&full(started))
        };
        // At rest no scene is built.
        let started = self.started.as_ref();
        started.is_some_and(|started| started == plan || is_other_volume(started))
    }

    /// Is the largest usual volume of a plan known, or can it not be computed?
    pub(crate) fn is_known(&self, plan: &Scene) -> bool {
        let is_at_end = self.own.any_curve().is_none() || self.own.largest_ml().is_some();
        // Side and visit are none of it.
        is_at_end && self.started.as_ref().is_some_and(|started| started.same_physics(plan))
    }

    /// Starts the curve of a scene. Another volume leaves the curve as it is.
    fn restart(&mut self, scene: &Scene, studies: &mut Studies) {
        self.started = Some(scene.clone());
        let base = full(scene);
        let axis = volumes(&scene.implant, MOST_RATIO);
        if self.own.move_to(&base, axis) {
            return;
        }
        self.beside.cancel(studies);
        self.band.cancel(studies);
        self.own.start(&base, axis, studies);
    }

    /// The volumes \[ml\] above which the worst card is high, is more than high, and above which no scene has an answer.
    pub(crate) fn ends(&self) -> [Option<f64>; 3] {
        let first = |is_meant: &dyn Fn(Option<usize>) -> bool| {
            // The marks are in the order of their volumes.
            let found = self.own.marks().iter().find(|mark| is_meant(mark.level));
            found.map(|mark| mark.volume_ml)
        };
        [
            first(&|level| level >= Some(1)),
            first(&|level| level >= Some(2)),
            first(&|level| level.is_none()),
        ]
    }

    /// The plan of the next width, whose practice is wanted.
    pub(crate) fn beside(&self) -> Option<&Scene> {
        self.beside.any_curve().map(Map::base)
    }

    /// The largest volume that stays usual at the width of the plan and at the next one, in words, with the volume that practice
    /// takes where that is known; empty while the first is not known.
    pub(crate) fn largest_usual(&self, practices: &Practices) -> String {
        let (Some(largest), Some(curve)) = (self.own.largest(), self.own.curve()) else {
            return String::new();
        };
        let width = width_in_words(curve.base());
        let practice = practices.volume(curve.base()).map(|practice| practice.volume_ml());
        let (base, step) = (centimetres(breast_width_mm(curve.base())), STEP_ML);
        let is_expander = self.own.is_of_expander();
        let words = match (practice, largest) {
            (Some(ml), largest) => {
                let takes = tr!(
                    "{width} cm: practice takes {ml:.0} ± {step:.0} ml for the breast's base, {base} cm; ",
                    width,
                    ml,
                    step,
                    base
                );
                takes + &against_practice(largest, self.own.end(), curve.base())
            }
            (None, None) if self.is_always_thin() => {
                tr!("No volume on {width} cm stays usual, because the cover is thin", width)
            }
            (None, None) => tr!("No volume on {width} cm stays usual", width),
            (None, Some(volume)) if is_expander => {
                tr!("Filled at once, up to {volume} stays usual on {width} cm", volume, width)
            }
            (None, Some(volume)) => tr!("Up to {volume} stays usual on {width} cm", volume, width),
        } + &self.band.words();
        let beside = self.beside.largest().zip(self.beside.curve()).map(|(largest, beside)| {
            let width = width_in_words(beside.base());
            let volume = largest.unwrap_or_else(|| tr("none").to_owned());
            tr!("; {volume} on {width} cm", volume, width)
        });
        let why = if is_expander { tr(" (no practice for expanders)") } else { "" };
        format!("{words}{}{why}.", beside.unwrap_or_default())
    }

    /// Is the cover what ends the usual volumes at the plan's width?
    fn is_always_thin(&self) -> bool {
        self.own.end().is_some_and(|mark| mark.quantity == Some(Quantity::LeastCoverMm))
    }

    /// The largest volume that stays usual, as a sentence after another one; empty while that is not known.
    pub(crate) fn largest_in_words(&self, practices: &Practices) -> String {
        let words = self.largest_usual(practices);
        if words.is_empty() { words } else { format!(" {words}") }
    }

    /// The largest volume of a plan that stays usual \[ml\]; `None` while that is not known, or without one.
    pub(crate) fn largest_ml(&self, plan: &Scene) -> Option<f64> {
        let is_of_plan = self.started.as_ref() == Some(plan);
        self.own.largest_ml()?.filter(|_| is_of_plan)
    }

    /// [`Self::largest_ml`] as a plan and in words.
    pub(crate) fn largest_plan(&self, plan: &Scene) -> Option<(Scene, String)> {
        let volume = self.largest_ml(plan)?;
        let base = self.own.curve()?.base();
        let scene = with_values(base, &[(Parameter::Volume, volume)]).ok()?;
        let words = match self.own.is_against_practice() {
            true => tr!("{volume:.0} ml, the most within practice's stretch", volume),
            false => tr!("{volume:.0} ml, the largest that stays usual", volume),
        };
        Some((scene, words))
    }

    /// What [`Self::largest_usual`] is.
    pub(crate) fn about_largest_usual(&self) -> String {
        let words = match self.own.is_against_practice() {
            true => tr(
                "Up to this volume the skin is stretched at most as by practice's volume and a step of 30 ml, the cover is not thin and \
                 the pressure is usual, for this patient and this pocket. A quick, coarse computation, checked by the plan's own; in \
                 steps of 5 ml.",
            ),
            false => tr(
                "No word of the cards is above usual up to this volume, for this patient and this pocket. A quick, coarse \
                 computation, checked by the plan's own; in steps of 5 ml.",
            ),
        };
        words.to_owned() + &self.band.about()
    }

    /// That the volume of a plan is above or within a tenth of the greatest one with an answer, in words; empty while that is not
    /// known.
    pub(crate) fn near_end(&self, plan: &Scene) -> String {
        let words = Parameter::Volume.value(plan).map_or_else(String::new, |v| self.near_end_of(v));
        // Also during the solve of another volume. The comparison builds scenes: a volume far below the limit needs none.
        let is_of_plan =
            || self.own.any_curve().is_some_and(|curve| curve.has_points_of(&full(plan)));
        if words.is_empty() || is_of_plan() { words } else { String::new() }
    }

    fn near_end_of(&self, volume_ml: f64) -> String {
        match self.ends()[2] {
            Some(end) if volume_ml > end => {
                tr!(
                    "Probably no answer: the model has none above about {end:.0} ml at this width.",
                    end
                )
            }
            Some(end) if volume_ml >= NEAR_END * end => {
                tr!("Near the model's limit: no answer above about {end:.0} ml at this width.", end)
            }
            _ => String::new(),
        }
    }

    /// The marks in words; empty without any.
    pub(crate) fn words(&self) -> String {
        let word = |mark: &Mark| format!("\n{:.0} ml: {}", mark.volume_ml, mark.words());
        let words: String = self.own.marks().iter().map(word).collect();
        if words.is_empty() { words } else { tr!("\nAt this width, from about{words}", words) }
    }
}

/// The largest volume whose stretch is at most that of practice, with what else ends the volumes of a plan.
fn against_practice(largest: Option<String>, end: Option<&Mark>, plan: &Scene) -> String {
    let is_of = |quantity| end.is_some_and(|mark| mark.quantity == Some(quantity));
    let (thin, pressure) = (is_of(Quantity::LeastCoverMm), is_of(Quantity::GreatestPressureMmhg));
    match largest {
        Some(volume) if thin => tr!("up to {volume}, then the cover is thin", volume),
        Some(volume) if pressure => tr!("up to {volume}, then the pressure is high", volume),
        Some(volume) if !plan.implant.is_round() => {
            tr!(
                "this skin carries up to {volume} of this shape within the stretch of round ones",
                volume
            )
        }
        Some(volume) => match plan.implant.fullness.unwrap_or(HALF_ELLIPSOID) - HALF_ELLIPSOID {
            more if more > LEAST_FULLER => {
                tr!(
                    "this skin carries up to {volume} of this fuller dome within that stretch",
                    volume
                )
            }
            more if more < -LEAST_FULLER => {
                tr!(
                    "this skin carries up to {volume} of this less full dome within that stretch",
                    volume
                )
            }
            _ => tr!("this skin carries up to {volume} within that stretch", volume),
        },
        None if thin => tr("the cover is thin with every volume").to_owned(),
        None if pressure => tr("the pressure is high with every volume").to_owned(),
        None => tr("no volume stretches this skin so little").to_owned(),
    }
}

/// The next width \[mm\]: the next whole centimetre at least half a centimetre wider.
fn next_width(width_mm: f64) -> f64 {
    10.0 * ((width_mm + 5.0) / 10.0).ceil()
}

/// A plan with the whole implant in place.
fn full(plan: &Scene) -> Scene {
    Scene { insertion: 1.0, ..plan.clone() }
}

/// Width of the implant of a scene \[cm\], as "12".
fn width_in_words(scene: &Scene) -> String {
    centimetres(2.0 * scene.implant.base_radius_mm)
}

fn centimetres(mm: f64) -> String {
    format_at_most(0.1 * mm, 0, 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::Measurements;
    use crate::measure::bands::PracticeStretch;
    use crate::study::NoPractice;

    #[test]
    fn the_next_width_is_a_whole_centimetre() {
        for (width, next) in [(120.0, 130.0), (121.0, 130.0), (127.0, 140.0), (125.0, 130.0)] {
            assert!((next_width(width) - next).abs() < 1e-9, "{width}");
        }
    }

    fn width(width_mm: f64, marks: Vec<Mark>, largest_ml: Option<f64>) -> Width {
        let scene = with_values(&Scene::opening(), &[(Parameter::BaseWidth, width_mm)]).unwrap();
        Width::done(&scene, volumes(&scene.implant, MOST_RATIO), marks, largest_ml)
    }

    #[test]
    fn the_largest_volume_stands_beside_that_of_the_next_width() {
        let none = Practices::of_known(Scene::opening(), Err(NoPractice::Volume));
        let words = |own, beside| {
            VolumeMarks { own, beside, ..VolumeMarks::default() }.largest_usual(&none)
        };
        assert_eq!(words(Width::default(), Width::default()), "");
        for (own, beside, expected) in [
            (Some(360.0), None, "Up to 360 ml stays usual on 12 cm; none on 13 cm."),
            (Some(360.0), Some(410.0), "Up to 360 ml stays usual on 12 cm; 410 ml on 13 cm."),
            (None, Some(410.0), "No volume on 12 cm stays usual; 410 ml on 13 cm."),
        ] {
            assert_eq!(words(width(120.0, vec![], own), width(130.0, vec![], beside)), expected);
        }
        let thin = Mark {
            volume_ml: 100.0,
            level: Some(1),
            quantity: Some(Quantity::LeastCoverMm),
            word: "thin",
        };
        let words_of_thin = words(width(120.0, vec![thin], None), width(130.0, vec![], None));
        assert_eq!(
            words_of_thin,
            "No volume on 12 cm stays usual, because the cover is thin; none on 13 cm."
        );
        let open = words(width(120.0, vec![], Some(480.0)), Width::default());
        assert_eq!(open, "Up to 480 ml (the highest profile sold) stays usual on 12 cm.");
    }

    #[test]
    fn against_practice_the_largest_volume_stands_beside_practices_and_what_ends_it() {
        let practice = PracticeStretch { less: 0.19, same: 0.21, more: 0.23 };
        let practices = Practices::of_known(Scene::opening(), Ok(practice));
        let mark = |level, quantity, word| Mark { volume_ml: 330.0, level, quantity, word };
        let as_practice = mark(Some(0), Some(Quantity::GreatestStrain), "as practice");
        for (quantity, expected) in [
            (Quantity::GreatestStrain, "this skin carries up to 330 ml within that stretch"),
            (Quantity::LeastCoverMm, "up to 330 ml, then the cover is thin"),
            (Quantity::GreatestPressureMmhg, "up to 330 ml, then the pressure is high"),
        ] {
            let end = mark(Some(1), Some(quantity), "above practice");
            let own = width(120.0, vec![as_practice, end], Some(330.0));
            let marks = VolumeMarks { own, ..VolumeMarks::default() };
            let words = marks.largest_usual(&practices);
            assert_eq!(
                words,
                format!(
                    "12 cm: practice takes 300 ± 30 ml for the breast's base, 12 cm; {expected}."
                )
            );
        }
        // An implant of another shape than practice's round one, on a breast whose base is measured.
        let mut plan = Scene::opening();
        plan.implant.apex_shift_mm = 5.0;
        let measured = plan.measured();
        plan.apply_patient(Measurements { base_width_mm: Some(130.0), ..measured }).unwrap();
        let practices = Practices::of_known(plan.clone(), Ok(practice));
        let own = Width::done(&plan, volumes(&plan.implant, MOST_RATIO), vec![], Some(310.0));
        assert_eq!(
            VolumeMarks { own, ..VolumeMarks::default() }.largest_usual(&practices),
            "12 cm: practice takes 325 ± 30 ml for the breast's base, 13 cm; this skin carries up to 310 ml of this shape within the stretch of round ones."
        );
    }

    #[test]
    fn a_round_implant_is_named_after_its_fullness_and_not_after_its_shape() {
        let practice = PracticeStretch { less: 0.19, same: 0.21, more: 0.23 };
        for (fullness, x, expected) in [
            (None, 0.0, "up to 340 ml within that stretch"),
            (None, 3.0, "up to 340 ml within that stretch"),
            (Some(0.667), 0.0, "up to 340 ml within that stretch"),
            (Some(0.70), 0.0, "up to 340 ml of this fuller dome within that stretch"),
            (Some(0.60), 0.0, "up to 340 ml of this less full dome within that stretch"),
        ] {
            let mut plan = Scene::opening();
            (plan.implant.fullness, plan.implant.center_mm[0]) = (fullness, x);
            let practices = Practices::of_known(plan.clone(), Ok(practice));
            let own = Width::done(&plan, volumes(&plan.implant, MOST_RATIO), vec![], Some(340.0));
            let words = VolumeMarks { own, ..VolumeMarks::default() }.largest_usual(&practices);
            assert!(words.ends_with(&format!("this skin carries {expected}.")), "{words}");
        }
    }

    #[test]
    fn the_marks_are_those_of_the_patient_with_any_volume() {
        let scene = Scene::opening();
        let marks = VolumeMarks { started: Some(scene.clone()), ..VolumeMarks::default() };
        let is_of = |edit: &dyn Fn(&mut Scene)| {
            let mut scene = scene.clone();
            edit(&mut scene);
            marks.is_of(&scene)
        };
        assert!(is_of(&|_| {}) && is_of(&|scene| scene.insertion = 0.5));
        assert!(is_of(&|scene| scene.implant.projection_mm += 4.0));
        assert!(!is_of(&|scene| scene.layers[0].curve.strain_scale *= 0.6));
        assert!(!is_of(&|scene| scene.layers[1].thickness_mm += 2.0));
        assert!(!is_of(&|scene| scene.pocket_radius_mm += 2.0));
        assert!(!VolumeMarks::default().is_of(&scene));
    }

    #[test]
    fn a_volume_within_a_tenth_of_the_last_answer_is_near_the_limit() {
        let end = Mark { volume_ml: 400.0, level: None, quantity: None, word: "no answer" };
        let own = width(120.0, vec![end], None);
        let marks = VolumeMarks { own, ..VolumeMarks::default() };
        assert_eq!(marks.near_end_of(359.0), "");
        assert!(
            marks
                .near_end_of(361.0)
                .starts_with("Near the model's limit: no answer above about 400 ml")
        );
        assert!(
            marks
                .near_end_of(401.0)
                .starts_with("Probably no answer: the model has none above about 400 ml")
        );
        assert_eq!(VolumeMarks::default().near_end_of(361.0), "");
        assert_eq!(marks.near_end(&Scene::opening()), "");
    }
}

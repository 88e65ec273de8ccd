//! The nearest plan with an answer to a plan without one: a bisection on the volume at a fixed base width, on the
//! insertion, or on the base width at a fixed volume.
//!
//! The bisection runs on a coarse grid. The found plan is then solved on its own grid; if that grid has no answer, the
//! bisection is repeated there. A case is computed as those of all studies, without Newton's method on layered tissue.

use super::one_by_one::OneByOne;
use super::{Case, Cases, Job, MapSettings, Parameter, Study, with_values};
use crate::clinical::{Dimension, Size};
use crate::scene::{Field, Implant, Scene};

/// Grid and tolerance of the bisection.
const COARSE: MapSettings = MapSettings { nodes_per_side: 33, tolerance: 1e-3 };
/// Step of the volumes \[ml\].
pub const VOLUME_STEP_ML: f64 = 5.0;
/// Step of the insertions \[-\].
pub const INSERTION_STEP: f64 = 0.05;
/// Step of the base widths \[mm\], and number of steps to the widest.
const WIDTH_STEP_MM: f64 = 5.0;
const WIDTHS: u32 = 8;
/// Projection / base radius of the least volume \[-\].
const LEAST_RATIO: f64 = 0.15;

/// The number that a bisection varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Varied {
    Volume,
    Insertion,
    /// Steps below the widest base, at the volume of the plan.
    Narrowing,
}

/// A bracket of one number in steps: the plan has an answer at `low`, none at `high`.
#[derive(Debug)]
struct Bracket {
    varied: Varied,
    /// Are the scenes solved on the plan's own grid?
    is_fine: bool,
    least: u32,
    /// The value to solve before all others.
    first: Option<u32>,
    low: Option<u32>,
    high: u32,
}

/// A plan with an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestPlan {
    /// The scene, on the grid of the plan without an answer.
    pub scene: Scene,
    /// The edit in words, as "Use 280 ml".
    pub words: String,
}

/// State and result of the search.
#[derive(Clone, Debug, PartialEq)]
pub enum Search {
    /// Scenes are left to solve.
    Running,
    /// The nearest plan with an answer.
    Found(Box<NearestPlan>),
    /// Neither a smaller volume nor less insertion has an answer.
    Nothing,
    /// A job has failed.
    Failed,
}

/// The search as a state machine, a [`Study`] of one scene at a time.
#[derive(Debug)]
pub struct Nearest {
    plan: Scene,
    bracket: Bracket,
    /// The number to vary if the present one has no value with an answer.
    next: Option<Varied>,
    search: Search,
    /// The running job, by its value.
    jobs: OneByOne<u32>,
    solved: usize,
}

impl Nearest {
    /// The search beside a plan without an answer: a smaller volume first, less insertion first for a plan that is not
    /// fully inserted.
    #[must_use]
    pub fn new(plan: &Scene) -> Self {
        if plan.insertion < 1.0 {
            Self::over(plan, Varied::Insertion, Some(Varied::Volume))
        } else {
            Self::over(plan, Varied::Volume, Some(Varied::Insertion))
        }
    }

    /// The search beside a plan without an answer for a wider base of the same volume, up to 4 cm wider, and no wider
    /// than the measured breast. The pocket keeps its margin.
    #[must_use]
    pub fn wider(plan: &Scene) -> Self {
        Self::over(plan, Varied::Narrowing, None)
    }

    fn over(plan: &Scene, first: Varied, next: Option<Varied>) -> Self {
        let mut search = Self {
            plan: plan.clone(),
            bracket: Bracket::new(plan, first),
            next,
            search: Search::Running,
            jobs: OneByOne::new(),
            solved: 0,
        };
        search.leave_empty_bracket();
        search
    }

    /// The plan without an answer.
    #[must_use]
    pub fn plan(&self) -> &Scene {
        &self.plan
    }

    /// State and result.
    #[must_use]
    pub fn search(&self) -> &Search {
        &self.search
    }

    /// The plan at a value of the present bracket.
    fn scene(&self, value: u32) -> Scene {
        let mut scene = self.plan.clone();
        match self.bracket.varied {
            Varied::Volume => {
                let volume = VOLUME_STEP_ML * f64::from(value);
                let size = scene.implant.size();
                let changed =
                    size.and_then(|it| it.changed(Dimension::Volume, volume, Dimension::BaseWidth));
                if let Ok(size) = changed {
                    scene.implant.projection_mm = size.projection_mm();
                }
            }
            Varied::Narrowing => {
                let width = width_mm(&self.plan, value);
                let volume = Parameter::Volume.value(&scene).unwrap_or_default();
                let values = [(Parameter::BaseWidth, width), (Parameter::Volume, volume)];
                // Beyond the limits of a scene the plan itself stays, which has no answer.
                scene = with_values(&scene, &values).unwrap_or(scene);
            }
            // Whole percents to the last bit.
            Varied::Insertion => {
                scene.insertion = (100.0 * INSERTION_STEP).round() * f64::from(value) / 100.0;
            }
        }
        scene
    }

    /// The scene to solve at a value: on the bracket's grid, without the patient.
    fn case_scene(&self, value: u32) -> Scene {
        let mut scene = self.scene(value);
        scene.patient = None;
        if !self.bracket.is_fine {
            COARSE.apply(&mut scene);
        }
        scene
    }

    /// Takes whether the plan has an answer at a value.
    fn take(&mut self, value: u32, has_answer: bool) {
        self.solved += 1;
        if has_answer {
            self.bracket.low = Some(value);
        } else {
            self.bracket.high = value;
        }
        if self.bracket.next().is_some() {
            return;
        }
        match self.bracket.low {
            Some(low) if self.bracket.is_fine || self.is_coarse_plan() => {
                let scene = self.scene(low);
                let words = match self.bracket.varied {
                    Varied::Volume => format!("Use {:.0} ml", VOLUME_STEP_ML * f64::from(low)),
                    Varied::Insertion => format!("Insert to {:.0} %", 100.0 * scene.insertion),
                    Varied::Narrowing => {
                        format!("Widen to {} cm", width_mm(&self.plan, low) / 10.0)
                    }
                };
                self.search = Search::Found(Box::new(NearestPlan { scene, words }));
            }
            Some(low) => {
                let bracket = &mut self.bracket;
                (bracket.is_fine, bracket.first, bracket.low) = (true, Some(low), None);
            }
            None => self.leave_empty_bracket(),
        }
    }

    /// Is the plan's own grid that of the bisection?
    fn is_coarse_plan(&self) -> bool {
        let mut coarse = self.plan.clone();
        COARSE.apply(&mut coarse);
        coarse.solver == self.plan.solver
    }

    /// Goes on to the next number while the present one has no value to solve; ends without a further number.
    fn leave_empty_bracket(&mut self) {
        while self.bracket.next().is_none() {
            let Some(varied) = self.next.take() else {
                self.search = Search::Nothing;
                return;
            };
            self.bracket = Bracket::new(&self.plan, varied);
        }
    }
}

impl Bracket {
    fn new(plan: &Scene, varied: Varied) -> Self {
        let steps = |value: f64, step: f64| (value / step - 1e-9).ceil().max(0.0) as u32;
        let (least, high) = match varied {
            Varied::Volume => {
                let projection = LEAST_RATIO * plan.implant.base_radius_mm;
                let volume = |projection: f64| {
                    let projection =
                        projection.clamp(Field::Projection.limits.0, Field::Projection.limits.1);
                    let implant = Implant { projection_mm: projection, ..plan.implant };
                    implant.size().map_or(0.0, Size::volume_ml)
                };
                let [least, present] = [projection, plan.implant.projection_mm].map(volume);
                (steps(least, VOLUME_STEP_ML), steps(present, VOLUME_STEP_ML))
            }
            Varied::Insertion => (1, steps(plan.insertion, INSERTION_STEP)),
            Varied::Narrowing => (least_narrowing(plan), WIDTHS + 1),
        };
        Self { varied, is_fine: false, least: least.max(1), first: None, low: None, high }
    }

    /// The value to solve next; `None` at the end of the bisection.
    fn next(&self) -> Option<u32> {
        match self.low {
            Some(low) => (self.high - low > 1).then_some(u32::midpoint(low, self.high)),
            None => {
                let first = self.first.filter(|first| *first < self.high);
                first.or_else(|| (self.least < self.high).then_some(self.least))
            }
        }
    }
}

/// The least narrowing of a base within the measured width of the breast: that of the widest without a measurement.
fn least_narrowing(plan: &Scene) -> u32 {
    let measured = plan.measured().base_width_mm;
    let fits = |narrowing: &u32| measured.is_none_or(|most| width_mm(plan, *narrowing) <= most);
    (1..=WIDTHS).find(fits).unwrap_or(WIDTHS + 1)
}

/// The base width \[mm\] some steps below the widest: whole steps above the width of the plan.
fn width_mm(plan: &Scene, narrowing: u32) -> f64 {
    let present = (2.0 * plan.implant.base_radius_mm / WIDTH_STEP_MM + 1e-9).floor();
    WIDTH_STEP_MM * (present + f64::from(WIDTHS + 1 - narrowing))
}

impl Study for Nearest {
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        while self.search == Search::Running && self.jobs.is_idle() {
            let value = self.bracket.next()?;
            match self.jobs.ask(value, self.case_scene(value), store) {
                Ok(case) => self.take(value, case.is_converged()),
                Err(job) => return Some(job),
            }
        }
        None
    }

    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        match self.jobs.receive(job, cases, store) {
            Some((value, Some(case))) => self.take(value, case.is_converged()),
            Some((_, None)) => self.search = Search::Failed,
            None => {}
        }
    }

    /// The number of all scenes is not known before the end: one more than those solved.
    fn progress(&self) -> (usize, usize) {
        (self.solved, self.solved + usize::from(self.search == Search::Running))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::measure::Status;
    use crate::study::{Parameter, evaluate, flat_plan};

    /// Runs a search with cases of a rule; returns the solved scenes.
    fn run(nearest: &mut Nearest, has_answer: impl Fn(&Scene) -> bool) -> Vec<Scene> {
        let (mut store, mut solved) = (Cases::default(), Vec::new());
        while let Some((index, job)) = nearest.next_job(&mut store) {
            assert!(nearest.next_job(&mut store).is_none(), "one scene at a time");
            assert_eq!(nearest.progress(), (solved.len(), solved.len() + 1));
            let scene = job.scenes[0].clone();
            let status = if has_answer(&scene) { Status::Converged } else { Status::Unstable };
            let case = Case { status: Some(status), ..Case::default() };
            nearest.receive(index, vec![case], &mut store);
            solved.push(scene);
            assert!(solved.len() < 40, "the search does not end");
        }
        assert!(nearest.is_done());
        solved
    }

    fn volume(scene: &Scene) -> f64 {
        Parameter::Volume.value(scene).unwrap()
    }

    fn found(nearest: &Nearest) -> &NearestPlan {
        let Search::Found(plan) = nearest.search() else { panic!("{:?}", nearest.search()) };
        plan
    }

    #[test]
    fn the_bisection_finds_the_greatest_volume_with_an_answer() {
        let plan = flat_plan();
        for most in [72.0, 139.0, 221.0, 280.1, 299.0] {
            let mut nearest = Nearest::new(&plan);
            let solved = run(&mut nearest, |scene| volume(scene) < most);
            let NearestPlan { scene, words } = found(&nearest);
            let expected = (most / 5.0).floor() * 5.0;
            assert_eq!(words, &format!("Use {expected} ml"));
            assert!((volume(scene) - expected).abs() < 1e-9);
            assert!(solved.len() <= 9, "{}", solved.len());
            // Nothing but the projection differs from the plan.
            let mut same = scene.clone();
            same.implant.projection_mm = plan.implant.projection_mm;
            assert_eq!(same, plan);
            // The last scene is the plan on its own grid.
            let last = solved.last().unwrap();
            assert_eq!((last.solver, &last.implant), (plan.solver, &scene.implant));
            let is_coarse = |scene: &Scene| scene.solver.nodes_per_side == COARSE.nodes_per_side;
            assert!(solved[..solved.len() - 1].iter().all(is_coarse));
        }
    }

    #[test]
    fn the_plans_own_grid_has_the_last_word() {
        let mut nearest = Nearest::new(&flat_plan());
        run(&mut nearest, |scene| {
            let most = if scene.solver.nodes_per_side == 33 { 281.0 } else { 204.0 };
            volume(scene) < most
        });
        assert_eq!(found(&nearest).words, "Use 200 ml");
    }

    #[test]
    fn a_plan_that_is_not_fully_inserted_is_inserted_less() {
        let plan = Scene { insertion: 0.9, ..flat_plan() };
        let mut nearest = Nearest::new(&plan);
        run(&mut nearest, |scene| scene.insertion < 0.63);
        assert_eq!(found(&nearest).words, "Insert to 60 %");
        assert_eq!(found(&nearest).scene, Scene { insertion: 0.6, ..plan.clone() });
        // Where no insertion has an answer, a smaller volume may.
        let mut nearest = Nearest::new(&plan);
        run(&mut nearest, |scene| volume(scene) < 123.0);
        assert_eq!(found(&nearest).words, "Use 120 ml");
        // Where no volume has an answer, less insertion may.
        let mut nearest = Nearest::new(&flat_plan());
        run(&mut nearest, |scene| scene.insertion < 0.31);
        assert_eq!(found(&nearest).words, "Insert to 30 %");
    }

    #[test]
    fn a_wider_base_keeps_volume_and_margin() {
        let plan = flat_plan();
        for (least, expected) in
            [(121.0, "Widen to 12.5 cm"), (131.0, "Widen to 13.5 cm"), (160.0, "Widen to 16 cm")]
        {
            let mut nearest = Nearest::wider(&plan);
            run(&mut nearest, |scene| 2.0 * scene.implant.base_radius_mm >= least);
            let NearestPlan { scene, words } = found(&nearest);
            assert_eq!(words, expected);
            assert!((volume(scene) - volume(&plan)).abs() < 1e-9);
            let margin = |scene: &Scene| scene.pocket_radius_mm - scene.implant.base_radius_mm;
            assert!((margin(scene) - margin(&plan)).abs() < 1e-9);
        }
        let mut nearest = Nearest::wider(&plan);
        run(&mut nearest, |_| false);
        assert_eq!(nearest.search(), &Search::Nothing);
    }

    #[test]
    fn no_base_is_wider_than_the_measured_breast() {
        for (breast, widest) in [(132.0, Some(130.0)), (125.0, Some(125.0)), (120.0, None)] {
            let mut plan = flat_plan();
            plan.patient.as_mut().unwrap().measured.base_width_mm = Some(breast);
            let mut nearest = Nearest::wider(&plan);
            let solved = run(&mut nearest, |_| true);
            let width = |scene: &Scene| 2.0 * scene.implant.base_radius_mm;
            let most = solved.iter().map(width).reduce(f64::max);
            assert_eq!(most, widest, "{breast}");
        }
    }

    #[test]
    fn a_plan_without_any_answer_has_none() {
        for insertion in [1.0, 0.5, 0.02, 0.0] {
            let mut nearest = Nearest::new(&Scene { insertion, ..flat_plan() });
            let solved = run(&mut nearest, |_| false);
            assert!(solved.len() <= 2);
            assert_eq!(nearest.search(), &Search::Nothing);
        }
    }

    #[test]
    fn stored_cases_are_taken_and_a_failed_job_ends_the_search() {
        let plan = flat_plan();
        let (mut nearest, mut store) = (Nearest::new(&plan), Cases::default());
        let (index, job) = nearest.next_job(&mut store).unwrap();
        let case = Case { status: Some(Status::Unstable), ..Case::default() };
        nearest.receive(index, vec![case], &mut store);
        assert_eq!(store.len(), 1);
        let mut again = Nearest::new(&plan);
        let (_, other) = again.next_job(&mut store).unwrap();
        assert_ne!(job, other);
        // The case of another job is ignored.
        again.receive(7, Vec::new(), &mut store);
        assert_eq!(again.search(), &Search::Running);
        again.receive(0, Vec::new(), &mut store);
        assert_eq!((again.search(), again.is_done()), (&Search::Failed, true));
        assert!(again.next_job(&mut store).is_none());
    }

    #[test]
    fn very_tight_skin_over_the_papers_fat_gets_the_nearest_volume_with_an_answer() {
        let mut plan = with_values(&flat_plan(), &[(Parameter::Volume, 350.0)]).unwrap();
        plan.layers[1].curve = CurveSpec::Adipose {}.into();
        plan.layers[1].poisson_ratio = 0.45;
        plan.layers[0].curve.strain_scale = 0.15;
        COARSE.apply(&mut plan);
        let case = |scene: &Scene| {
            let scene = Scene { patient: None, ..scene.clone() };
            evaluate(&Job { scenes: vec![scene], ..Job::default() }).swap_remove(0)
        };
        assert!(!case(&plan).is_converged());
        let (mut nearest, mut store) = (Nearest::new(&plan), Cases::default());
        while let Some((index, job)) = nearest.next_job(&mut store) {
            nearest.receive(index, evaluate(&job), &mut store);
        }
        let found = &found(&nearest).scene;
        assert!(case(found).is_converged());
        let mut larger = found.clone();
        let more = Size::of_width_and_volume(120.0, volume(found) + VOLUME_STEP_ML).unwrap();
        larger.implant.projection_mm = more.projection_mm();
        assert!(volume(found) < 350.0 && !case(&larger).is_converged());
    }
}

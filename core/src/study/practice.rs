//! The stretch that practice's volumes give in the tissue of a plan: three round implants of the plan's fill, of the breast's base width, of practice's
//! volume less a step of the rule, of practice's, and of a step more.

use super::one_by_one::OneByOne;
use super::{Case, Cases, Job, Quantity, Study};
use crate::clinical::{Corrected, PracticeTable, PracticeVolume, STEP_ML, Size};
use crate::measure::bands::PracticeStretch;
use crate::scene::{Implant, Scene};
use crate::springs::Springs;

/// Margin of the pocket around practice's implant \[mm\].
const MARGIN_MM: f64 = 10.0;

/// Why a plan is not compared with practice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoPractice {
    /// One sheet, or the springs of Nikolaev 2013.
    Model,
    /// The base width is outside of the table: least and greatest width \[mm\].
    Width(f64, f64),
    /// Practice's volumes are out of the limits of a scene, or have no answer.
    Volume,
}

/// The search as a state machine, a [`Study`] of three scenes on the plan's own grid.
#[derive(Debug)]
pub struct Practice {
    volume: PracticeVolume,
    scenes: [Scene; 3],
    strains: [State; 3],
    /// Number of scenes that were asked for.
    asked: usize,
    jobs: OneByOne<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Waiting,
    /// The strain \[-\]; `None` without an answer.
    Done(Option<f64>),
}

impl Practice {
    /// The comparison of a plan by a table.
    ///
    /// # Errors
    /// Why the plan is not compared.
    pub fn new(plan: &Scene, table: &PracticeTable) -> Result<Self, NoPractice> {
        if !plan.is_layered() || plan.springs != Springs::Coupled {
            return Err(NoPractice::Model);
        }
        let (least, most) = table.widths_mm();
        let volume = practice_volume(plan, table).ok_or(NoPractice::Width(least, most))?;
        let scenes = practice_scenes(plan, &volume).ok_or(NoPractice::Volume)?;
        let strains = [State::Waiting; 3];
        Ok(Self { volume, scenes, strains, asked: 0, jobs: OneByOne::new() })
    }

    /// Practice's volume with its parts.
    #[must_use]
    pub fn volume(&self) -> &PracticeVolume {
        &self.volume
    }

    /// The scenes: a step less, practice's volume, a step more.
    #[must_use]
    pub fn scenes(&self) -> &[Scene; 3] {
        &self.scenes
    }

    /// The strains.
    ///
    /// # Errors
    /// `None` before the end; [`NoPractice::Volume`] if a volume has no answer.
    pub fn stretch(&self) -> Result<PracticeStretch, Option<NoPractice>> {
        let strain = |k: usize| match self.strains[k] {
            State::Done(Some(strain)) => Ok(strain),
            State::Done(None) => Err(Some(NoPractice::Volume)),
            State::Waiting => Err(None),
        };
        if self.strains.contains(&State::Done(None)) {
            return Err(Some(NoPractice::Volume));
        }
        Ok(PracticeStretch { less: strain(0)?, same: strain(1)?, more: strain(2)? })
    }
}

/// The three scenes of practice in the tissue of a plan; `None` if one is out of the limits of a scene.
fn practice_scenes(plan: &Scene, volume: &PracticeVolume) -> Option<[Scene; 3]> {
    let width_mm = breast_width_mm(plan);
    let scene = |step: f64| {
        let size = Size::of_width_and_volume(width_mm, volume.volume_ml() + step * STEP_ML).ok()?;
        let mut scene = Scene {
            insertion: 1.0,
            patient: None,
            implant_reference: String::new(),
            other_side: None,
            ..plan.without_visit()
        };
        scene.implant = Implant {
            base_radius_mm: 0.5 * width_mm,
            projection_mm: size.projection_mm(),
            fill: plan.implant.fill,
            ..Implant::default()
        };
        scene.set_pocket_radius(scene.implant.least_pocket_mm() + MARGIN_MM);
        scene.widen_patch();
        scene.validate().is_ok().then_some(scene)
    };
    Some([scene(-1.0)?, scene(0.0)?, scene(1.0)?])
}

/// The volume that a table takes for a plan, with its parts; `None` for a width outside of the table.
#[must_use]
pub fn practice_volume(plan: &Scene, table: &PracticeTable) -> Option<PracticeVolume> {
    table.volume(breast_width_mm(plan), &plan.measured())
}

/// Base width of the breast of a plan \[mm\]: as measured, else that of the implant.
#[must_use]
pub fn breast_width_mm(plan: &Scene) -> f64 {
    plan.measured().base_width_mm.unwrap_or(2.0 * plan.implant.base_radius_mm)
}

/// Have two plans the same practice: the same tissue, chest, fill, measurements that correct its volume, base width and settings of the solver?
#[must_use]
pub fn has_same_practice(a: &Scene, b: &Scene) -> bool {
    let subject = |scene: &Scene| {
        let measured = Corrected::ALL.map(|of| of.value(&scene.measured()));
        let mut subject = Scene {
            implant: Implant { fill: scene.implant.fill, ..Implant::default() },
            implant_reference: String::new(),
            pocket_radius_mm: 0.0,
            insertion: 1.0,
            patient: None,
            side: None,
            other_side: None,
            ..scene.without_visit()
        };
        if scene.has_default_patch() {
            subject.body.patch_radius_mm = 0.0;
        }
        subject.layers.iter_mut().for_each(|layer| layer.tissue.clear());
        (breast_width_mm(scene).to_bits(), measured, subject)
    };
    subject(a) == subject(b)
}

impl Study for Practice {
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        while let Some(scene) = self.scenes.get(self.asked) {
            let k = self.asked;
            self.asked += 1;
            match self.jobs.ask(k, scene.clone(), store) {
                Ok(case) => self.strains[k] = State::Done(strain(&case)),
                Err(job) => return Some(job),
            }
        }
        None
    }

    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        if let Some((k, case)) = self.jobs.receive(job, cases, store) {
            self.strains[k] = State::Done(case.as_ref().and_then(strain));
        }
    }

    fn progress(&self) -> (usize, usize) {
        let done = self.strains.iter().filter(|state| matches!(state, State::Done(_)));
        (done.count(), self.strains.len())
    }
}

/// The greatest strain of a case with an answer \[-\].
fn strain(case: &Case) -> Option<f64> {
    case.values.get(Quantity::GreatestStrain).filter(|_| case.is_converged())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::{Measurements, SkinClass};
    use crate::scene::{Fill, Side, TissueModel, Visit};
    use crate::study::{MapSettings, Parameter, evaluate, with_values};

    fn coarse(plan: &Scene) -> Scene {
        let mut plan = plan.clone();
        MapSettings::default().apply(&mut plan);
        plan
    }

    fn solve(plan: &Scene, store: &mut Cases) -> (Practice, usize) {
        let mut practice = Practice::new(plan, &PracticeTable::default()).unwrap();
        let mut solved = 0;
        while let Some((index, job)) = practice.next_job(store) {
            assert_eq!(practice.stretch(), Err(None));
            practice.receive(index + 9, Vec::new(), store);
            practice.receive(index, evaluate(&job), store);
            solved += 1;
        }
        assert!(practice.is_done());
        (practice, solved)
    }

    fn with_volume(plan: &Scene, volume: f64) -> Scene {
        with_values(plan, &[(Parameter::Volume, volume)]).unwrap()
    }

    #[test]
    fn the_strains_are_those_of_plans_of_practices_volumes_solved_alone() {
        let mut store = Cases::default();
        let plan = coarse(&Scene::opening());
        let (practice, solved) = solve(&plan, &mut store);
        assert!(solved == 3 && (practice.volume().volume_ml() - 300.0).abs() < 1e-9);
        let found = practice.stretch().unwrap();
        for (strain, volume) in [(found.less, 270.0), (found.same, 300.0), (found.more, 330.0)] {
            let outcome = crate::simulate::simulate(&with_volume(&plan, volume)).unwrap();
            let alone = Quantity::GreatestStrain.of(&outcome).unwrap();
            assert!((strain - alone).abs() < 1e-9, "{volume}: {strain} {alone}");
        }
        // Another volume, shape or place of the plan's own implant has the same practice, and solves nothing.
        let mut other = with_volume(&plan, 350.0);
        other.implant.base_height_mm = Some(110.0);
        other.implant.apex_shift_mm = 8.0;
        other.implant.center_mm = [2.0, -3.0];
        other.insertion = 0.5;
        other.set_pocket_radius(72.0);
        let (again, solved) = solve(&other, &mut store);
        assert_eq!((again.stretch(), solved), (Ok(found), 0));
        // So have the entries for the file, the names of the tissues, and a base of the breast that is the implant's.
        other.side = Some(Side::Right);
        other.visit = Some(Visit { reference: "4711".to_owned(), ..Visit::default() });
        other.implant_reference = "A 1".to_owned();
        other.layers[0].tissue = "cutis".to_owned();
        other.patient.get_or_insert_default().measured.base_width_mm =
            Some(2.0 * plan.implant.base_radius_mm);
        assert!(has_same_practice(&plan, &other));
        let filled =
            Scene { implant: Implant { fill: Some(Fill::Saline), ..plan.implant }, ..plan.clone() };
        assert!(!has_same_practice(&plan, &filled));
        other.layers[1].thickness_mm += 1.0;
        assert!(!has_same_practice(&plan, &other));
    }

    #[test]
    fn practice_has_the_fill_of_the_plan() {
        let mut plan = coarse(&Scene::opening());
        plan.implant.fill = Some(Fill::Soft);
        let mut store = Cases::default();
        let found = solve(&plan, &mut store).0.stretch().unwrap();
        let outcome = crate::simulate::simulate(&with_volume(&plan, 300.0)).unwrap();
        assert!((found.same - Quantity::GreatestStrain.of(&outcome).unwrap()).abs() < 1e-9);
    }

    #[test]
    fn the_class_of_the_skin_corrects_the_volume_and_the_width_has_its_table() {
        let table = PracticeTable::default();
        let mut plan = Scene::opening();
        let measured = Measurements { skin_class: Some(SkinClass::Lax), ..plan.measured() };
        plan.apply_patient(measured).unwrap();
        let practice = Practice::new(&plan, &table).unwrap();
        assert!((practice.volume().volume_ml() - 330.0).abs() < 1e-9);
        plan.implant.base_radius_mm = 50.0;
        assert_eq!(Practice::new(&plan, &table).err(), Some(NoPractice::Width(105.0, 150.0)));
        let mut sheet = Scene::opening();
        sheet.set_tissue_model(TissueModel::Sheet);
        assert_eq!(Practice::new(&sheet, &table).err(), Some(NoPractice::Model));
    }

    #[test]
    fn the_measured_base_of_the_breast_has_one_practice_for_every_width_of_the_implant() {
        let mut plan = Scene::opening();
        let measured = Measurements { base_width_mm: Some(130.0), ..plan.measured() };
        plan.apply_patient(measured).unwrap();
        let wide = with_values(&plan, &[(Parameter::BaseWidth, 130.0)]).unwrap();
        let narrow = with_values(&plan, &[(Parameter::BaseWidth, 110.0)]).unwrap();
        assert!(has_same_practice(&wide, &narrow) && has_same_practice(&plan, &narrow));
        // Without the measurement, the plan of 13 cm has the same practice.
        let of = |plan: &Scene| Practice::new(plan, &PracticeTable::default()).unwrap();
        let alone = with_values(&Scene::opening(), &[(Parameter::BaseWidth, 130.0)]).unwrap();
        assert!((of(&narrow).volume().volume_ml() - 325.0).abs() < 1e-9);
        assert_eq!(of(&narrow).scenes(), of(&alone).scenes());
        assert!(!has_same_practice(&Scene::opening(), &alone));
    }

    #[test]
    fn a_volume_without_an_answer_is_no_practice() {
        let mut practice = Practice::new(&Scene::opening(), &PracticeTable::default()).unwrap();
        let mut store = Cases::default();
        let (first, _) = practice.next_job(&mut store).unwrap();
        practice.receive(first, Vec::new(), &mut store);
        assert_eq!(practice.stretch(), Err(Some(NoPractice::Volume)));
    }
}

//! Cases by the content of their scenes: equal scenes are solved once.

use super::Case;
use crate::curve::CurveSpec;
use crate::scene::{CellsThrough, ChestGrid, Field, Fill, Scene, ThicknessGrid};
use std::collections::{HashMap, VecDeque};

/// Everything of a scene that changes its case; the names of the tissues, the patient and the visit do not.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Key(Box<[u64]>);

/// Cases by the content of their scenes, and the numbers of solved and reused cases.
#[derive(Debug, Default)]
pub struct Cases {
    /// Each curve of the keys once: a curve may have 100 000 points.
    curves: Vec<CurveSpec>,
    /// Grids of chest and thickness, each pair once.
    grids: Vec<(Option<ChestGrid>, Option<ThicknessGrid>)>,
    cases: HashMap<Key, Case>,
    /// The keys in the order of insertion.
    order: VecDeque<Key>,
    solved: usize,
    reused: usize,
}

/// Greatest number of stored cases; the oldest are removed first. A case with a profile has about 1.5 kB.
pub const MAX_CASES: usize = 20_000;

impl Cases {
    /// The key of a scene.
    pub fn key(&mut self, scene: &Scene) -> Key {
        let Scene { springs, solver, layers, .. } = scene;
        let is_layered = scene.is_layered();
        let cells = match solver.cells_through {
            Some(CellsThrough::Count(count)) if is_layered => count as u64,
            _ => 0,
        };
        let choices = [u64::from(is_layered), *springs as u64];
        let counts = [layers.len() as u64, solver.nodes_per_side as u64, cells];
        let mut words = Vec::with_capacity(32);
        words.extend(choices.into_iter().chain(counts));
        for field in Field::ALL {
            // An absent number has its place, too.
            let values = (0..field.count(scene)).map(|layer| field.value(scene, layer));
            words.extend(values.map(|value| value.map_or(u64::MAX, bits)));
        }
        let gel = scene.implant.fill.map(Fill::gel);
        words
            .extend(gel.map_or([u64::MAX; 2], |gel| [gel.modulus_kpa, gel.shell_kpa_mm].map(bits)));
        words.push(scene.body.plane.map_or(0, |plane| 1 + plane as u64));
        words.push(scene.body.posture as u64);
        words.extend(layers.iter().map(|layer| self.curve(&layer.curve.spec)));
        words.push(self.grids(scene));
        Key(words.into())
    }

    /// The key of a scene that is solved in full: the quick solve may have no answer.
    pub fn key_in_full(&mut self, scene: &Scene) -> Key {
        let mut words = self.key(scene).0.into_vec();
        words.push(1);
        Key(words.into())
    }

    /// The index of the grids of a scene from 1; 0 without grids.
    fn grids(&mut self, scene: &Scene) -> u64 {
        let Scene { chest_grid, thickness_field, .. } = scene;
        if chest_grid.is_none() && thickness_field.is_none() {
            return 0;
        }
        let is_known = |(chest, field): &(_, _)| (chest, field) == (chest_grid, thickness_field);
        let found = self.grids.iter().position(is_known).unwrap_or_else(|| {
            self.grids.push((chest_grid.clone(), thickness_field.clone()));
            self.grids.len() - 1
        });
        found as u64 + 1
    }

    /// The index of a curve.
    fn curve(&mut self, spec: &CurveSpec) -> u64 {
        let found = self.curves.iter().position(|known| known == spec);
        found.unwrap_or_else(|| {
            self.curves.push(spec.clone());
            self.curves.len() - 1
        }) as u64
    }

    /// The stored case of a scene; counts the reuse. Without a profile a case is no answer to a request for one.
    pub fn reuse(&mut self, key: &Key, with_profile: bool) -> Option<&Case> {
        let has_wanted = |case: &&Case| {
            let has_shape = case.values != super::Values::default();
            !with_profile || case.profile.is_some() || !has_shape
        };
        let case = self.cases.get(key).filter(has_wanted)?;
        self.reused += 1;
        Some(case)
    }

    /// Stores the case of a solved scene.
    pub fn insert(&mut self, key: Key, case: Case) {
        self.solved += 1;
        self.store(key, case);
    }

    /// Stores a case that was solved elsewhere, unless the scene has one.
    pub fn share(&mut self, scene: &Scene, case: Case) {
        let key = self.key(scene);
        if !self.cases.contains_key(&key) {
            self.store(key, case);
        }
    }

    fn store(&mut self, key: Key, case: Case) {
        if self.cases.insert(key.clone(), case).is_none() {
            self.order.push_back(key);
        }
        while self.order.len() > MAX_CASES {
            if let Some(oldest) = self.order.pop_front() {
                self.cases.remove(&oldest);
            }
        }
    }

    /// Number of cases that the studies have solved.
    #[must_use]
    pub fn solved(&self) -> usize {
        self.solved
    }

    /// Number of cases that were taken from the store.
    #[must_use]
    pub fn reused(&self) -> usize {
        self.reused
    }

    /// Number of stored cases.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cases.len()
    }

    /// Is no case stored?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cases.is_empty()
    }
}

/// The bits of a number; both zeros are equal.
fn bits(value: f64) -> u64 {
    (value + 0.0).to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::Measurements;
    use crate::scene::{ChestShape, TissueModel};
    use crate::study::{Job, evaluate};

    #[test]
    fn scenes_of_equal_content_have_equal_keys_and_others_do_not() {
        let base = Scene::default();
        let edits: [fn(&mut Scene); 12] = [
            |_| {},
            |scene| scene.implant.center_mm = [-0.0, 0.0],
            |scene| scene.layers[0].tissue = "cutis".to_owned(),
            |scene| scene.layers[1].curve.spec = CurveSpec::Skin {},
            |scene| scene.layers.truncate(1),
            |scene| scene.solver.nodes_per_side = 65,
            |scene| scene.solver.cells_through = Some(CellsThrough::Auto),
            |scene| scene.solver.cells_through = Some(CellsThrough::Count(3)),
            |scene| scene.set_tissue_model(TissueModel::Sheet),
            |scene| scene.chest = Some(ChestShape::USUAL),
            |scene| scene.chest = Some(ChestShape::ROUND),
            |scene| scene.chest = Some(ChestShape { radius_across_mm: 150.0, ..ChestShape::USUAL }),
        ];
        let of_row = |field: &Field| {
            let mut scene = base.clone();
            *field.place(&mut scene, 0)? += 0.001;
            Some(scene)
        };
        let mut cases = Cases::default();
        let scenes: Vec<Scene> = edits
            .iter()
            .map(|edit| {
                let mut scene = base.clone();
                edit(&mut scene);
                scene
            })
            .chain(Field::ALL.iter().filter_map(of_row))
            .chain([Scene::sheet()])
            .collect();
        for a in &scenes {
            for b in &scenes {
                assert_eq!(cases.key(a) == cases.key(b), a.same_physics(b), "{a:?} {b:?}");
            }
        }
        let mut patient = base.clone();
        let measured = Measurements { base_width_mm: Some(120.0), ..Measurements::default() };
        patient.apply_patient(measured).unwrap();
        assert_eq!(cases.key(&patient), cases.key(&base));
    }

    #[test]
    fn reuse_is_counted_and_needs_the_wanted_profile() {
        let mut cases = Cases::default();
        let mut scene = Scene::sheet();
        scene.solver.nodes_per_side = 17;
        let key = cases.key(&scene);
        assert!(cases.reuse(&key, false).is_none());
        let solve = |profile| {
            evaluate(&Job { scenes: vec![scene.clone()], profile, full: false }).pop().unwrap()
        };
        cases.insert(key.clone(), solve(false));
        assert!(cases.reuse(&key, true).is_none());
        assert!(cases.reuse(&key, false).is_some());
        cases.insert(key.clone(), solve(true));
        assert!(cases.reuse(&key, true).is_some() && cases.reuse(&key, false).is_some());
        assert_eq!((cases.solved(), cases.reused(), cases.len()), (2, 3, 1));
    }

    #[test]
    fn the_oldest_cases_are_removed() {
        let mut cases = Cases::default();
        let key = |k: usize| Key(vec![k as u64].into());
        for k in 0..MAX_CASES + 5 {
            cases.insert(key(k), Case::default());
        }
        assert_eq!(cases.len(), MAX_CASES);
        assert!(cases.reuse(&key(4), false).is_none() && cases.reuse(&key(5), false).is_some());
    }
}

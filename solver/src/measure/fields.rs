//! Nodal fields of a solution, each computed at its first use.

use super::contact::Contact;
use super::layered::{self, NodalLoads};
use super::layers;
use super::wrinkles;
use crate::solve::Solution;
use crate::springs::tension_field::FieldState;
use glam::Vec2;
use std::cell::{Cell, OnceCell};
use std::sync::Arc;

/// A quantity with a value at every node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Greatest principal engineering strain λ₁ − 1 \[-\], of skin with a natural tension against skin without stress.
    PrincipalStrain,
    /// Area stretch λ₁λ₂ against the tissue at rest \[-\].
    AreaStretch,
    /// Greatest principal nominal stress of a layer \[kPa\], counted from the skin.
    Stress(usize),
    /// Contact pressure \[kPa\].
    ContactPressure,
    /// Layered tissue: greatest principal engineering strain of a layer \[-\], counted from the skin.
    LayerStrain(usize),
    /// Layered tissue: deformed thickness of a layer over its thickness at rest \[-\], counted from the skin.
    ThicknessStretch(usize),
    /// Layered tissue: distance of the skin's outer surface from the implant's dome \[mm\].
    Cover,
    /// Layered tissue: pull of the attachment around the pocket \[kPa\].
    Traction,
    /// Layered tissue: 0 taut, 1 wrinkled, 2 slack \[-\], by the law at the node's strains.
    WrinkleState,
    /// Layered tissue: strain that the wrinkles take up \[-\], 0 to 1; 0.05: of 100 mm of skin 5 mm lie in folds.
    WrinkleStrain,
}

/// The fields of one solution.
#[derive(Debug)]
pub struct Fields {
    solution: Arc<Solution>,
    contact: OnceCell<Contact>,
    principal_strain: OnceCell<Vec<f32>>,
    area_stretch: OnceCell<Vec<f32>>,
    /// One for each layer.
    stress_kpa: Vec<OnceCell<Vec<f32>>>,
    contact_pressure_kpa: OnceCell<Vec<f32>>,
    /// One for each layer.
    layer_strain: Vec<OnceCell<Vec<f32>>>,
    thickness_stretch: Vec<OnceCell<Vec<f32>>>,
    cover_mm: OnceCell<Vec<f32>>,
    traction_kpa: OnceCell<Vec<f32>>,
    wrinkle_state: OnceCell<Vec<f32>>,
    wrinkle_strain: OnceCell<Vec<f32>>,
    wrinkle_directions: OnceCell<Vec<Vec2>>,
    /// Greatest strain and stress of each solid layer at the nodes, from the inner face outwards.
    solids: OnceCell<Vec<NodalLoads>>,
    computed: Cell<u64>,
}

impl Fields {
    /// The fields of a solution, without computing any.
    #[must_use]
    pub fn new(solution: Arc<Solution>) -> Self {
        Self {
            contact: OnceCell::new(),
            principal_strain: OnceCell::new(),
            area_stretch: OnceCell::new(),
            stress_kpa: vec![OnceCell::new(); solution.problem().materials.len()],
            contact_pressure_kpa: OnceCell::new(),
            layer_strain: vec![OnceCell::new(); solution.problem().materials.len()],
            thickness_stretch: vec![OnceCell::new(); solution.problem().materials.len()],
            cover_mm: OnceCell::new(),
            traction_kpa: OnceCell::new(),
            wrinkle_state: OnceCell::new(),
            wrinkle_strain: OnceCell::new(),
            wrinkle_directions: OnceCell::new(),
            solids: OnceCell::new(),
            computed: Cell::new(0),
            solution,
        }
    }

    /// The solution of these fields.
    #[must_use]
    pub fn solution(&self) -> &Arc<Solution> {
        &self.solution
    }

    /// The values of a field at the nodes, zero outside of the sheet, shape (nodes_per_side², ); empty for the
    /// stress of a missing layer.
    #[must_use]
    pub fn values(&self, field: Field) -> &[f32] {
        let cell = match field {
            Field::PrincipalStrain => &self.principal_strain,
            Field::AreaStretch => &self.area_stretch,
            Field::Stress(layer) => match self.stress_kpa.get(layer) {
                Some(cell) => cell,
                None => return &[],
            },
            Field::ContactPressure => &self.contact_pressure_kpa,
            Field::LayerStrain(layer) => match self.layer_strain.get(layer) {
                Some(cell) => cell,
                None => return &[],
            },
            Field::ThicknessStretch(layer) => match self.thickness_stretch.get(layer) {
                Some(cell) => cell,
                None => return &[],
            },
            Field::Cover => &self.cover_mm,
            Field::Traction => &self.traction_kpa,
            Field::WrinkleState => &self.wrinkle_state,
            Field::WrinkleStrain => &self.wrinkle_strain,
        };
        cell.get_or_init(|| {
            self.computed.set(self.computed.get() + 1);
            let deformation = self.solution.deformation();
            let part = deformation.part();
            let mut values = vec![0.0; part.len()];
            for k in deformation.inside() {
                values[part.index(k)] = self.at(field, k).unwrap_or(0.0) as f32;
            }
            part.on_grid(values)
        })
    }

    /// The value of a field at one node; `None` for a missing layer, and of wrinkles where the skin does not wrinkle.
    #[must_use]
    pub fn at(&self, field: Field, node: usize) -> Option<f64> {
        let deformation = self.solution.deformation();
        let elastic = || self.solution.elastic_deformation();
        match field {
            Field::PrincipalStrain => Some(elastic().principal(node)[0]),
            Field::AreaStretch => Some(deformation.area_stretch(node)),
            Field::Stress(layer) => {
                let material = self.solution.problem().materials.get(layer)?;
                match self.solid(layer) {
                    Some(solid) => Some(f64::from(solid.stress[node])),
                    None => Some(layers::stress(
                        material,
                        elastic(),
                        node,
                        self.solution.problem().wrinkles(),
                    )),
                }
            }
            Field::ContactPressure => Some(self.contact().pressure_at(node)),
            Field::LayerStrain(layer) => match self.solid(layer) {
                Some(solid) => Some(f64::from(solid.strain[node])),
                None => Some(elastic().principal(node)[0]),
            },
            Field::ThicknessStretch(layer) => {
                let thickness = self.solution.stack().thickness_mm.get(layer)?[node];
                let rest = layered::thickness_at_rest(self.solution.problem(), layer, node);
                Some(f64::from(thickness) / rest)
            }
            Field::Cover => Some(layered::cover_at(&self.solution, node)),
            Field::Traction => Some(layered::traction_at(&self.solution, node)),
            Field::WrinkleState => self.skin_state(node).map(|state| match state {
                FieldState::Taut => 0.0,
                FieldState::Wrinkled => 1.0,
                FieldState::Slack => 2.0,
            }),
            Field::WrinkleStrain => wrinkles::strain(&self.solution, node),
        }
    }

    /// State of the skin at a node; `None` of the paper's springs, which are compressed instead.
    #[must_use]
    pub fn skin_state(&self, node: usize) -> Option<FieldState> {
        wrinkles::state(&self.solution, node)
    }

    /// Directions of the wrinkles' crests at the nodes, along the skin's tension: unit vectors in the plane of the tissue at
    /// rest \[-\], whose sign has no meaning; zero where the skin is not wrinkled. Shape (nodes_per_side², ).
    #[must_use]
    pub fn wrinkle_directions(&self) -> &[Vec2] {
        self.wrinkle_directions.get_or_init(|| {
            self.computed.set(self.computed.get() + 1);
            let deformation = self.solution.deformation();
            let part = deformation.part();
            let mut is_inside = vec![false; part.len()];
            deformation.inside().for_each(|k| is_inside[part.index(k)] = true);
            // Of mirror images each has its own direction.
            let at = |k: usize| {
                let direction =
                    is_inside[part.index(k)].then(|| wrinkles::direction(&self.solution, k));
                direction.flatten().unwrap_or_default().as_vec2()
            };
            (0..part.nodes_of_grid()).map(at).collect()
        })
    }

    /// The loads of a solid layer; `None` for the skin and in a sheet.
    fn solid(&self, layer: usize) -> Option<&NodalLoads> {
        let solids = self.solids.get_or_init(|| self.solution.nodal_loads());
        (layer > 0).then(|| solids.get(self.solution.problem().materials.len() - 1 - layer))?
    }

    pub(super) fn contact(&self) -> &Contact {
        self.contact.get_or_init(|| Contact::new(&self.solution))
    }

    /// Number of arrays of [`Self::values`] computed so far.
    #[must_use]
    pub fn computed(&self) -> u64 {
        self.computed.get()
    }
}

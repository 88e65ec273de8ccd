//! What is drawn on a shape: nodal fields, each computed when it is first asked for.

use super::contact::Contact;
use super::deformation::{Deformation, LEAST_AREA_STRETCH, thickness_exponent};
use super::layers::Layers;
use crate::solve::Solver;
use glam::Vec3;
use std::cell::{Cell, OnceCell};
use std::rc::Rc;

/// A quantity that has a value at every node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// Greatest principal engineering strain λ₁ − 1 \[-\].
    PrincipalStrain,
    /// Area stretch λ₁λ₂ \[-\].
    AreaStretch,
    /// Greatest principal nominal stress of a layer \[kPa\], counted from the skin.
    Stress(usize),
    /// Contact pressure \[kPa\].
    ContactPressure,
}

/// The layers' deformed geometry at every node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stack {
    /// Unit normals of the deformed sheet, pointing to the skin, shape (nodes_per_side², ); straight
    /// up outside the sheet.
    pub normal: Vec<Vec3>,
    /// Deformed thickness of each layer \[mm\], from the skin inwards, shape (layers, nodes_per_side²);
    /// zero outside the sheet.
    pub thickness_mm: Vec<Vec<f32>>,
}

/// All that is known of one shape: its deformation, and what was asked for so far.
#[derive(Debug)]
pub struct Fields {
    layers: Rc<Layers>,
    deformation: Deformation,
    contact: OnceCell<Contact>,
    stack: OnceCell<Stack>,
    principal_strain: OnceCell<Vec<f32>>,
    area_stretch: OnceCell<Vec<f32>>,
    /// One for each layer.
    stress_kpa: Vec<OnceCell<Vec<f32>>>,
    contact_pressure_kpa: OnceCell<Vec<f32>>,
    computed: Cell<u64>,
}

/// The fields of a solver's present shape.
#[must_use]
pub fn fields(solver: &Solver) -> Fields {
    Fields::new(solver, Rc::new(Layers::new(solver.problem())))
}

impl Fields {
    /// The fields of a solver's present shape, whose layers these are.
    #[must_use]
    pub fn new(solver: &Solver, layers: Rc<Layers>) -> Self {
        Self {
            deformation: Deformation::new(&solver.problem().sheet, solver.positions()),
            contact: OnceCell::new(),
            stack: OnceCell::new(),
            principal_strain: OnceCell::new(),
            area_stretch: OnceCell::new(),
            stress_kpa: vec![OnceCell::new(); layers.materials().len()],
            contact_pressure_kpa: OnceCell::new(),
            computed: Cell::new(0),
            layers,
        }
    }

    /// The values of a field at the nodes, zero outside the sheet, shape (nodes_per_side², ); empty
    /// for the stress of a layer that is not there. `solver` must still hold this shape.
    #[must_use]
    pub fn values(&self, field: Field, solver: &Solver) -> &[f32] {
        let cell = match field {
            Field::PrincipalStrain => &self.principal_strain,
            Field::AreaStretch => &self.area_stretch,
            Field::Stress(layer) => match self.stress_kpa.get(layer) {
                Some(cell) => cell,
                None => return &[],
            },
            Field::ContactPressure => &self.contact_pressure_kpa,
        };
        cell.get_or_init(|| {
            self.computed.set(self.computed.get() + 1);
            match field {
                Field::PrincipalStrain => self.per_node(|k| self.deformation.principal(k)[0]),
                Field::AreaStretch => self.per_node(|k| self.deformation.area_stretch(k)),
                Field::Stress(layer) => {
                    self.per_node(|k| self.layers.stress(layer, &self.deformation, k))
                }
                Field::ContactPressure => {
                    let contact = self.contact(solver);
                    self.per_node(|k| contact.pressure_at(k))
                }
            }
        })
    }

    fn per_node(&self, value: impl Fn(usize) -> f64) -> Vec<f32> {
        let mut values = vec![0.0; self.deformation.len()];
        self.deformation.inside().for_each(|k| values[k] = value(k) as f32);
        values
    }

    /// The value of a field at one node; `None` for a contact pressure that was not asked for while
    /// the solver held this shape, and for a layer that is not there.
    #[must_use]
    pub fn at(&self, field: Field, node: usize) -> Option<f64> {
        match field {
            Field::PrincipalStrain => Some(self.deformation.principal(node)[0]),
            Field::AreaStretch => Some(self.deformation.area_stretch(node)),
            Field::Stress(layer) => (layer < self.layers.materials().len())
                .then(|| self.layers.stress(layer, &self.deformation, node)),
            Field::ContactPressure => self.contact.get().map(|c| c.pressure_at(node)),
        }
    }

    /// Normals and deformed thicknesses of the layers.
    #[must_use]
    pub fn stack(&self) -> &Stack {
        self.stack.get_or_init(|| {
            let normal = |k| self.deformation.normal(k).as_vec3();
            Stack {
                normal: (0..self.deformation.len()).map(normal).collect(),
                thickness_mm: self.thickness_mm(),
            }
        })
    }

    /// [`Stack::thickness_mm`]: that at rest times (λ₁λ₂)^(−ν/(1−ν)). In `f32` and by one logarithm
    /// for all layers, because it is drawn and powers are slow.
    fn thickness_mm(&self) -> Vec<Vec<f32>> {
        let materials = self.layers.materials();
        let logarithm = self.per_node(|k| {
            let area_stretch = self.deformation.area_stretch(k).max(LEAST_AREA_STRETCH);
            f64::from((area_stretch as f32).ln())
        });
        let mut thickness_mm: Vec<Vec<f32>> = Vec::with_capacity(materials.len());
        for (k, first) in self.layers.first_alike().enumerate() {
            let rest = materials[k].thickness_mm;
            thickness_mm.push(if first < k {
                let ratio = (rest / materials[first].thickness_mm) as f32;
                thickness_mm[first].iter().map(|t| t * ratio).collect()
            } else {
                let exponent = thickness_exponent(materials[k].poisson_ratio) as f32;
                let mut values = vec![0.0; logarithm.len()];
                for node in self.deformation.inside() {
                    values[node] = rest as f32 * (exponent * logarithm[node]).exp();
                }
                values
            });
        }
        thickness_mm
    }

    /// The contact of this shape, which `solver` must still hold.
    pub(super) fn contact(&self, solver: &Solver) -> &Contact {
        self.contact.get_or_init(|| Contact::find(solver, &self.layers, &self.deformation))
    }

    pub(super) fn deformation(&self) -> &Deformation {
        &self.deformation
    }

    /// The layers of this shape.
    #[must_use]
    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// Arrays of [`Self::values`] computed so far.
    #[must_use]
    pub fn computed(&self) -> u64 {
        self.computed.get()
    }
}

//! Scenes of the study: centred domes with an axisymmetric reference solution.

use crate::axisymmetric_layers::Mound;
use implant_preview_core::curve::CurveSpec;
use implant_preview_core::mesh::Attachment;
use implant_preview_core::scene::{
    Body, CellsThrough, ChestShape, Implant, Layer, Scene, SolverSettings, ThicknessGrid,
    TissueModel,
};
use serde::{Deserialize, Serialize};

/// A scene of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Case {
    /// The default scene of the app: skin and adipose on a 55 mm hemisphere, pocket 70 mm.
    Default,
    /// One linear layer, ν = 1/3, pocket 1.5 times as wide as the dome.
    LinearThird,
    /// Skin alone, pocket as wide as the dome: the sheet is stretched to twice its area.
    SkinEquator,
    /// Skin and adipose, the dome raised to 60 % of its height.
    SkinAdiposeHalf,
    /// Adipose alone, pocket as wide as the dome.
    AdiposeEquator,
    /// Layered tissue: a 55 mm hemisphere under 1.5 mm of skin and 10 mm of adipose, pocket 70 mm.
    LayeredDefault,
    /// Layered tissue: a flat dome under 15 mm of adipose.
    LayeredFlat,
    /// Layered tissue: linear curves, ν = 1/3.
    LayeredLinear,
    /// Layered tissue: adipose over muscle.
    LayeredMuscle,
    /// Stiffening fat over a flat chest.
    BodyFlat,
    /// The same over a spherical chest of 150 mm.
    BodyCurved,
    /// The same over a flat chest, with a mound of 20 mm of fat.
    BodyMound,
    /// The same over a spherical chest of 140 mm, with a mound of 25 mm.
    BodyCurvedMound,
}

impl Case {
    /// All sheets.
    pub const ALL: [Self; 5] = [
        Self::Default,
        Self::LinearThird,
        Self::SkinEquator,
        Self::SkinAdiposeHalf,
        Self::AdiposeEquator,
    ];

    /// All scenes of layered tissue, those of `tests/reference/layered.json`.
    pub const LAYERED: [Self; 4] =
        [Self::LayeredDefault, Self::LayeredFlat, Self::LayeredLinear, Self::LayeredMuscle];

    /// All scenes with chests and mounds, and the flat one beside them: those of `tests/reference/body.json`.
    pub const BODY: [Self; 4] =
        [Self::BodyFlat, Self::BodyCurved, Self::BodyMound, Self::BodyCurvedMound];

    /// All scenes.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().chain(Self::LAYERED).chain(Self::BODY)
    }

    /// Is the tissue layered?
    #[must_use]
    pub fn is_layered(self) -> bool {
        !Self::ALL.contains(&self)
    }

    /// The mound of thickness in closed form.
    #[must_use]
    pub fn mound(self) -> Option<Mound> {
        let height_mm = match self {
            Self::BodyMound => 20.0,
            Self::BodyCurvedMound => 25.0,
            _ => return None,
        };
        Some(Mound { height_mm, width_mm: 45.0 })
    }

    /// Name of the scene in tables and titles.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::LinearThird => "linear-third",
            Self::SkinEquator => "skin-equator",
            Self::SkinAdiposeHalf => "skin-adipose-half",
            Self::AdiposeEquator => "adipose-equator",
            Self::LayeredDefault => "layered-default",
            Self::LayeredFlat => "layered-flat",
            Self::LayeredLinear => "layered-linear",
            Self::LayeredMuscle => "layered-muscle",
            Self::BodyFlat => "body-flat",
            Self::BodyCurved => "body-curved",
            Self::BodyMound => "body-mound",
            Self::BodyCurvedMound => "body-curved-mound",
        }
    }

    /// The scene on a grid with the given nodes per side and a tolerance \[fraction of the base radius\], a table of cases. The sheets
    /// except the default are in `tests/reference/membrane.json`.
    #[must_use]
    pub fn scene(self, nodes_per_side: usize, tolerance: f64) -> Scene {
        let sheet = |radius: f64, pocket_radius_mm: f64, layers: Vec<Layer>| Scene {
            implant: Implant {
                base_radius_mm: radius,
                projection_mm: radius,
                ..Implant::default()
            },
            pocket_radius_mm,
            body: Body::around(pocket_radius_mm, TissueModel::Sheet),
            layers,
            solver: SolverSettings { nodes_per_side, tolerance, cells_through: None },
            ..Scene::default()
        };
        let layered = |[radius, projection]: [f64; 2], pocket: f64, kpa_per_mm, cells, layers| {
            let mut scene = sheet(radius, pocket, layers);
            scene.implant.projection_mm = projection;
            let attachment =
                Attachment { stiffness_kpa_per_mm: kpa_per_mm, ..Attachment::default() };
            let tissue_model = TissueModel::Layered;
            let body = Body::around(pocket, tissue_model);
            scene.body = Body { patch_radius_mm: pocket_patch(pocket), attachment, ..body };
            scene.solver.cells_through = Some(cells);
            scene
        };
        let (two, four) = (CellsThrough::Count(2), CellsThrough::Count(4));
        match self {
            Self::Default => sheet(55.0, 70.0, vec![Layer::skin(), Layer::paper_adipose()]),
            Self::LinearThird => sheet(40.0, 60.0, vec![linear_third()]),
            Self::SkinEquator => sheet(40.0, 40.0, vec![Layer::skin()]),
            Self::SkinAdiposeHalf => Scene {
                insertion: 0.6,
                ..sheet(40.0, 60.0, vec![Layer::skin(), Layer::paper_adipose()])
            },
            Self::AdiposeEquator => {
                sheet(40.0, 40.0, vec![Layer { poisson_ratio: 0.3, ..Layer::paper_adipose() }])
            }
            Self::LayeredDefault => {
                layered([55.0, 55.0], 70.0, 2.0, two, vec![Layer::skin(), Layer::paper_adipose()])
            }
            Self::LayeredFlat => {
                let adipose = Layer { thickness_mm: 15.0, ..Layer::paper_adipose() };
                layered([62.0, 38.0], 70.0, 2.0, two, vec![Layer::skin(), adipose])
            }
            Self::LayeredLinear => {
                let linear = |thickness_mm, modulus_kpa| Layer {
                    thickness_mm,
                    poisson_ratio: 1.0 / 3.0,
                    curve: CurveSpec::Linear { modulus_kpa }.into(),
                    ..Layer::paper_adipose()
                };
                layered([40.0, 40.0], 55.0, 2.0, two, vec![linear(1.5, 50.0), linear(12.0, 5.0)])
            }
            Self::LayeredMuscle => {
                let skin = Layer { thickness_mm: 1.6, ..Layer::skin() };
                let adipose = Layer { poisson_ratio: 0.47, ..Layer::paper_adipose() };
                let muscle = Layer {
                    tissue: "muscle".to_owned(),
                    thickness_mm: 6.0,
                    poisson_ratio: 0.45,
                    curve: CurveSpec::Exponential { scale_kpa: 3.0, rate: 3.0 }.into(),
                };
                layered([58.0, 45.0], 66.0, 3.0, four, vec![skin, adipose, muscle])
            }
            Self::BodyFlat | Self::BodyCurved | Self::BodyMound | Self::BodyCurvedMound => {
                let (mut skin, mut fat) = (Layer::skin(), Layer::adipose());
                skin.curve.strain_scale = 0.5;
                (fat.thickness_mm, fat.poisson_ratio) = (8.5, 0.45);
                fat.curve = CurveSpec::Exponential { scale_kpa: 0.6, rate: 5.0 }.into();
                let mut scene =
                    layered([60.0, 40.0], 70.0, 2.0, CellsThrough::Auto, vec![skin, fat]);
                let chest_mm = match self {
                    Self::BodyCurved => Some(150.0),
                    Self::BodyCurvedMound => Some(140.0),
                    _ => None,
                };
                scene.chest = chest_mm.map(|radius| ChestShape {
                    radius_across_mm: radius,
                    radius_along_mm: Some(radius),
                });
                scene.thickness_field = self.mound().map(|mound| factors(mound, 8.5));
                scene
            }
        }
    }
}

/// The factors of the thickness of solids \[mm\] under a mound, 4 mm apart.
fn factors(mound: Mound, solids_mm: f64) -> ThicknessGrid {
    const COUNT: usize = 69;
    let at = |k: usize| 4.0 * (k as f64 - (COUNT / 2) as f64);
    let factor = |k: usize| mound.factor(at(k % COUNT).hypot(at(k / COUNT)), solids_mm);
    let factors = (0..COUNT * COUNT).map(factor).collect();
    ThicknessGrid { spacing_mm: 4.0, columns: COUNT, rows: COUNT, factors }
}

/// Radius of the patch around a pocket in `tests/reference/layered.json` \[mm\].
fn pocket_patch(pocket_radius_mm: f64) -> f64 {
    if pocket_radius_mm < 60.0 { pocket_radius_mm + 50.0 } else { pocket_radius_mm + 60.0 }
}

fn linear_third() -> Layer {
    Layer {
        poisson_ratio: 1.0 / 3.0,
        curve: CurveSpec::Linear { modulus_kpa: 10.0 }.into(),
        ..Layer::skin()
    }
}

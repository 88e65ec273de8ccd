//! Scenes of the study: centred hemispheres with an axisymmetric reference solution.

use crate::curve::CurveSpec;
use crate::scene::{Implant, Layer, Scene, SolverSettings};
use serde::{Deserialize, Serialize};

/// A scene of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Case {
    /// The default scene of the app as a sheet: skin and adipose on a 55 mm hemisphere, pocket 70 mm.
    Default,
    /// One linear layer, ν = 1/3, pocket 1.5 times as wide as the dome.
    LinearThird,
    /// Skin alone, pocket as wide as the dome: the sheet is stretched to twice its area.
    SkinEquator,
    /// Skin and adipose, the dome raised to 60 % of its height.
    SkinAdiposeHalf,
    /// Adipose alone, pocket as wide as the dome.
    AdiposeEquator,
}

impl Case {
    /// All scenes.
    pub const ALL: [Self; 5] = [
        Self::Default,
        Self::LinearThird,
        Self::SkinEquator,
        Self::SkinAdiposeHalf,
        Self::AdiposeEquator,
    ];

    /// Name of the scene in tables and titles.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::LinearThird => "linear-third",
            Self::SkinEquator => "skin-equator",
            Self::SkinAdiposeHalf => "skin-adipose-half",
            Self::AdiposeEquator => "adipose-equator",
        }
    }

    /// The scene on a grid with the given nodes per side and a tolerance \[fraction of the base radius\].
    /// All scenes except the default are in `tests/reference/membrane.json`.
    #[must_use]
    pub fn scene(self, nodes_per_side: usize, tolerance: f64) -> Scene {
        let solver = SolverSettings { nodes_per_side, tolerance, cells_through: None };
        let (pocket_radius_mm, insertion, layers) = match self {
            Self::Default => return Scene { solver, ..Scene::sheet() },
            Self::LinearThird => (60.0, 1.0, vec![linear_third()]),
            Self::SkinEquator => (40.0, 1.0, vec![Layer::skin()]),
            Self::SkinAdiposeHalf => (60.0, 0.6, vec![Layer::skin(), Layer::adipose()]),
            Self::AdiposeEquator => {
                (40.0, 1.0, vec![Layer { poisson_ratio: 0.3, ..Layer::adipose() }])
            }
        };
        Scene {
            implant: Implant { base_radius_mm: 40.0, projection_mm: 40.0, center_mm: [0.0, 0.0] },
            pocket_radius_mm,
            insertion,
            layers,
            solver,
            ..Scene::sheet()
        }
    }
}

fn linear_third() -> Layer {
    Layer {
        poisson_ratio: 1.0 / 3.0,
        curve: CurveSpec::Linear { modulus_kpa: 10.0 }.into(),
        ..Layer::skin()
    }
}

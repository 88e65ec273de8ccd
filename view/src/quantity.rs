//! The quantities that colour a picture: name, nodal field, scenes that have the quantity, scale of the colour bar.

use crate::color::{
    Scale, even, nice_above, pressure_scale, sequential, strain_scale, wrinkle_scale,
};
use implant_preview_core::measure::Field;
use implant_preview_core::measure::bands::SkinLimits;
use implant_preview_core::scene::{Layer, Scene, tissue_in_words};

/// What colours a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colouring {
    /// The displayed quantity.
    pub quantity: Quantity,
    /// What the strain of the skin is compared with.
    pub skin: SkinLimits,
}

/// The quantity that colours the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// The tissue's own colour.
    Tissue,
    /// Greatest principal strain, in the clinical bands.
    #[default]
    Strain,
    /// Area stretch.
    AreaStretch,
    /// Greatest principal stress of a layer, counted from the skin.
    Stress(usize),
    /// Contact pressure on the implant.
    Pressure,
    /// Layered tissue: greatest principal strain of a layer, counted from the skin; that of the skin in the clinical bands.
    LayerStrain(usize),
    /// Layered tissue: thickness of a layer relative to its thickness at rest.
    Thickness(usize),
    /// Layered tissue: distance between implant and skin.
    Cover,
    /// Layered tissue: pull of the attachment around the pocket.
    Traction,
    /// Layered tissue: taut, wrinkled or slack, with strokes along the wrinkles.
    Wrinkles,
}

/// What is common to a quantity of all pictures.
struct Row {
    /// The name in a menu; `{tissue}` is the tissue of the layer.
    name: &'static str,
    /// The nodal field; `None`: plain tissue.
    field: Option<Field>,
    /// Has layered tissue alone the quantity?
    is_of_layers: bool,
}

impl Quantity {
    fn row(self) -> Row {
        let (name, field, is_of_layers) = match self {
            Self::Tissue => ("Natural colours", None, false),
            Self::Strain => ("Skin stretch", Some(Field::PrincipalStrain), false),
            Self::AreaStretch => ("Skin area", Some(Field::AreaStretch), false),
            Self::Stress(layer) => ("Stress, {tissue}", Some(Field::Stress(layer)), false),
            Self::Pressure => ("Pressure", Some(Field::ContactPressure), false),
            Self::LayerStrain(layer) => {
                ("Stretch, {tissue}", Some(Field::LayerStrain(layer)), true)
            }
            Self::Thickness(layer) => {
                ("Thickness, {tissue}", Some(Field::ThicknessStretch(layer)), true)
            }
            Self::Cover => ("Cover over the implant", Some(Field::Cover), true),
            Self::Traction => ("Pull at the pocket's edge", Some(Field::Traction), true),
            Self::Wrinkles => ("Wrinkles of the skin", Some(Field::WrinkleState), true),
        };
        Row { name, field, is_of_layers }
    }

    /// The quantities of a scene, in the order of a menu.
    pub fn of_scene(scene: &Scene) -> impl Iterator<Item = Self> {
        let layers = scene.layers.len();
        // The stretch of the skin stands first.
        let quantities = [Self::Tissue, Self::Strain]
            .into_iter()
            .chain((1..layers).map(Self::LayerStrain))
            .chain([Self::Cover])
            .chain((0..layers).map(Self::Thickness))
            .chain([Self::Traction, Self::Wrinkles, Self::AreaStretch, Self::Pressure])
            .chain((0..layers).map(Self::Stress));
        quantities.filter(|quantity| quantity.is_of(scene))
    }

    /// The name in a menu; `{tissue}` is the tissue of [`Self::layer`].
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.row().name
    }

    /// The layer of the quantity, counted from the skin.
    #[must_use]
    pub fn layer(&self) -> Option<usize> {
        match *self {
            Self::Stress(layer) | Self::LayerStrain(layer) | Self::Thickness(layer) => Some(layer),
            _ => None,
        }
    }

    /// The nodal field of the quantity; `None` for plain tissue.
    #[must_use]
    pub fn field(&self) -> Option<Field> {
        self.row().field
    }

    /// Has a scene this quantity?
    #[must_use]
    pub fn is_of(&self, scene: &Scene) -> bool {
        let has_layer = self.layer().is_none_or(|layer| layer < scene.layers.len());
        has_layer && (scene.is_layered() || !self.row().is_of_layers)
    }

    /// The scale of the colour bar for field values up to the greatest; `None` for plain tissue. `skin`: what the strain of the
    /// skin is compared with.
    #[must_use]
    pub fn scale(&self, greatest: f32, layers: &[Layer], skin: SkinLimits) -> Option<Scale> {
        let name = |layer: usize| layers.get(layer).map_or("layer", |l| tissue_in_words(&l.tissue));
        Some(match *self {
            Self::Tissue => return None,
            Self::Strain => strain_scale(greatest, skin),
            Self::LayerStrain(0) => {
                let title = format!("Stretch of {}", name(0));
                Scale { title, ..strain_scale(greatest, skin) }
            }
            // The limits are those of skin.
            Self::LayerStrain(layer) => {
                let high = nice_above(f64::from(greatest).max(0.2)) as f32;
                let title = format!("Stretch of {}", name(layer));
                let ticks = (0..=4).map(|k| 0.25 * k as f32 * high);
                let ticks = ticks.map(|v| (v, format!("{:.0}", 100.0 * v))).collect();
                Scale { ticks, ..even(title, "%", 0.0, high, sequential) }
            }
            Self::Thickness(layer) => {
                let high = nice_above(f64::from(greatest).max(1.0)) as f32;
                even(format!("Thickness of {}", name(layer)), "×", 0.0, high, sequential)
            }
            // Cover far beside the implant is of no interest.
            Self::Cover => even("Cover".to_owned(), "mm", 0.0, 20.0, sequential),
            Self::Traction => {
                let high = nice_above(f64::from(greatest).max(1e-3)) as f32;
                even("Pull at the pocket's edge".to_owned(), "kPa", 0.0, high, sequential)
            }
            Self::AreaStretch => {
                let high = nice_above(f64::from(greatest - 1.0).max(0.1)) as f32 + 1.0;
                even("Area stretch".to_owned(), "×", 1.0, high, sequential)
            }
            Self::Stress(layer) => {
                let high = nice_above(f64::from(greatest).max(1e-3)) as f32;
                even(format!("Stress in {}", name(layer)), "kPa", 0.0, high, sequential)
            }
            Self::Pressure => pressure_scale(greatest),
            Self::Wrinkles => wrinkle_scale(),
        })
    }
}

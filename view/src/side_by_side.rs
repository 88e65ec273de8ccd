//! Colours of pictures side by side: one scale for all, or for stretches of skins with other limits the limits of each skin.

use crate::color::Scale;
use crate::quantity::Quantity;
use implant_preview_core::measure::bands::SkinLimits;
use implant_preview_core::scene::Layer;

/// Relative difference of two strains at which curves turn steep that is none \[-\].
const EQUAL: f64 = 1e-6;

/// What the scale of a picture depends on.
#[derive(Clone, Copy, Debug)]
pub struct Limited {
    /// Greatest value of the displayed quantity.
    pub greatest: f32,
    /// What the strain of the skin is compared with.
    pub skin: SkinLimits,
}

/// The colours of pictures side by side.
#[derive(Clone, Debug, PartialEq)]
pub enum Colours {
    /// All pictures have this scale; `None` for plain tissue.
    Common(Option<Scale>),
    /// Each picture has the scale of its own skin. The legend of all of them is in shares of the reserve; `None` where a
    /// skin has other limits: each picture then needs a legend.
    Own(Option<Scale>),
}

impl Colours {
    /// The colours of pictures of a quantity; `layers` name the tissues of the scale.
    #[must_use]
    pub fn new(quantity: Quantity, pictures: &[Limited], layers: &[Layer]) -> Self {
        let has_limits = matches!(quantity, Quantity::Strain | Quantity::LayerStrain(0));
        let first = pictures.first().map_or(SkinLimits::Tearing, |picture| picture.skin);
        if has_limits && !pictures.iter().all(|picture| is_equal(picture.skin, first)) {
            let share = |picture: &Limited| match picture.skin {
                SkinLimits::Reserve(knee) => Some(f64::from(picture.greatest) / knee),
                SkinLimits::Practice(_) | SkinLimits::Tearing => None,
            };
            let shares: Option<Vec<f64>> = pictures.iter().map(share).collect();
            let greatest = shares.map(|shares| shares.into_iter().fold(0.0, f64::max));
            return Self::Own(greatest.map(|share| Scale::of_reserve(share as f32)));
        }
        let greatest = pictures.iter().map(|picture| picture.greatest).fold(0.0, f32::max);
        Self::Common(quantity.scale(greatest, layers, first))
    }
}

fn is_equal(one: SkinLimits, other: SkinLimits) -> bool {
    match (one, other) {
        (SkinLimits::Reserve(one), SkinLimits::Reserve(other)) => {
            (one - other).abs() <= EQUAL * other.abs()
        }
        (one, other) => one == other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::TABLE_SIZE;
    use implant_preview_core::measure::bands;
    use implant_preview_core::scene::Scene;

    fn colours(quantity: Quantity, pictures: &[(f32, Option<f64>)]) -> Colours {
        let limited = |&(greatest, knee): &(f32, Option<f64>)| Limited {
            greatest,
            skin: SkinLimits::of_skin(knee),
        };
        let pictures: Vec<Limited> = pictures.iter().map(limited).collect();
        Colours::new(quantity, &pictures, &Scene::opening().layers)
    }

    /// The colour of a value in a scale.
    fn colour(scale: &Scale, value: f32) -> [u32; 3] {
        let t = (value - scale.low) / (scale.high - scale.low);
        scale.table[((t * TABLE_SIZE as f32) as usize).min(TABLE_SIZE - 1)].map(f32::to_bits)
    }

    #[test]
    fn pictures_with_equal_limits_have_one_scale_to_the_greatest_value() {
        let layers = Scene::opening().layers;
        let equal = colours(Quantity::Strain, &[(0.1, Some(0.2)), (0.15, Some(0.2))]);
        assert_eq!(
            equal,
            Colours::Common(Quantity::Strain.scale(0.15, &layers, SkinLimits::Reserve(0.2)))
        );
        let pressure = colours(Quantity::Pressure, &[(1.0, Some(0.2)), (4.0, Some(0.1))]);
        assert_eq!(
            pressure,
            Colours::Common(Quantity::Pressure.scale(4.0, &layers, SkinLimits::Tearing))
        );
        let tissue = colours(Quantity::Tissue, &[(0.0, Some(0.2)), (0.0, Some(0.1))]);
        assert_eq!(tissue, Colours::Common(None));
    }

    #[test]
    fn skins_with_other_limits_have_their_own_colours_and_one_legend_in_shares_of_the_reserve() {
        // Tight skin at 133 % of its reserve beside normal skin at 60 %.
        let (tight, normal) = ((0.1463, 0.11), (0.132, 0.22));
        let pictures = [tight, normal].map(|(greatest, knee)| (greatest, Some(f64::from(knee))));
        let Colours::Own(Some(legend)) = colours(Quantity::Strain, &pictures) else {
            panic!("the limits differ");
        };
        assert!((legend.greatest.unwrap() - 1.33).abs() < 1e-3);
        let ticks: Vec<&str> = legend.ticks.iter().map(|(_, label)| label.as_str()).collect();
        assert_eq!(ticks, ["0", "80", "100", "150"]);
        let words: Vec<&str> = legend.words.iter().map(|(_, word)| *word).collect();
        assert_eq!(words, ["reserve left", "little reserve", "no reserve"]);
        for ((strain, knee), word) in [(tight, "no reserve"), (normal, "reserve left")] {
            let (scale, share) = (
                Quantity::Strain.scale(strain, &[], SkinLimits::Reserve(knee.into())),
                strain / knee,
            );
            // The legend of all has the colour and the word of the own scale.
            assert_eq!(colour(&scale.unwrap(), strain), colour(&legend, share));
            assert_eq!(bands::RESERVE.word(share.into()), word);
        }
    }

    #[test]
    fn beside_a_skin_without_a_reserve_each_picture_needs_its_legend() {
        let mixed = colours(Quantity::Strain, &[(0.1, Some(0.2)), (0.3, None)]);
        assert_eq!(mixed, Colours::Own(None));
    }
}

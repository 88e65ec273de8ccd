//! Display options of the picture.

use super::renderer::Areola;
use crate::view::color::Quantity;

/// Display options; changes cause no solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Options {
    /// Quantity shown by the colours of the skin.
    pub(crate) quantity: Quantity,
    /// Is the tissue cut open?
    pub(crate) section: bool,
    /// Azimuth of the opening \[degrees\], from +x counter-clockwise.
    pub(crate) section_azimuth_deg: f32,
    /// Remove half of the tissue instead of a quarter?
    pub(crate) half: bool,
    /// Draw the springs?
    pub(crate) net: bool,
    /// Draw the areola in natural colours?
    pub(crate) areola: bool,
    /// Draw the edge of the areola in the colours of a quantity?
    pub(crate) areola_edge: bool,
    /// Draw the lines of a torso behind the tissue?
    pub(crate) torso: bool,
}

impl Options {
    /// Natural skin, uncut, with its areola.
    pub(crate) fn natural() -> Self {
        Self { quantity: Quantity::Tissue, section: false, ..Self::default() }
    }

    /// The switch of the areola for the present colours.
    pub(crate) fn areola_mut(&mut self) -> &mut bool {
        match self.quantity {
            Quantity::Tissue => &mut self.areola,
            _ => &mut self.areola_edge,
        }
    }

    /// Is the areola drawn in the present colours?
    pub(crate) fn has_areola(&self) -> bool {
        self.areola() != Areola::Hidden
    }

    /// How the areola is drawn in the present colours.
    pub(super) fn areola(&self) -> Areola {
        match self.quantity {
            Quantity::Tissue if self.areola => Areola::Disc,
            Quantity::Tissue => Areola::Hidden,
            _ if self.areola_edge => Areola::Edge,
            _ => Areola::Hidden,
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            quantity: Quantity::Strain,
            section: true,
            section_azimuth_deg: -50.0,
            half: false,
            net: false,
            areola: true,
            areola_edge: false,
            torso: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn natural_colours_show_the_areola_at_first_and_colours_of_a_quantity_its_edge_once_switched_on()
     {
        let mut options = Options::default();
        assert_eq!(options.areola(), Areola::Hidden);
        assert!(!options.net, "no grid at first");
        *options.areola_mut() = true;
        assert_eq!(options.areola(), Areola::Edge);
        options.quantity = Quantity::Tissue;
        assert_eq!(options.areola(), Areola::Disc);
        *options.areola_mut() = false;
        assert_eq!(options.areola(), Areola::Hidden);
        options.quantity = Quantity::Pressure;
        assert_eq!(options.areola(), Areola::Edge);
    }
}

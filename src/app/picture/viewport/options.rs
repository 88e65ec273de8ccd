//! Display options of the picture.

use super::before::Before;
use super::renderer::Areola;
use crate::view::quantity::Quantity;

/// What the picture is about: colouring and cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Subject {
    /// Natural skin, uncut.
    Look,
    /// Skin and layers on the cut, in natural colours.
    Inside,
    /// The uncut skin in the colours of its stretch.
    Stretch,
}

impl Subject {
    pub(crate) const ALL: [Self; 3] = [Self::Look, Self::Inside, Self::Stretch];

    /// Colouring; is the tissue cut?
    fn parts(self) -> (Quantity, bool) {
        match self {
            Self::Look => (Quantity::Tissue, false),
            Self::Inside => (Quantity::Tissue, true),
            Self::Stretch => (Quantity::Strain, false),
        }
    }
}

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
    /// Draw a torso with both breasts in place of the tissue, where it is not cut?
    pub(crate) torso: bool,
    /// How the body before is shown, where a body is drawn.
    pub(crate) before: Before,
}

impl Options {
    /// What the picture is about; `None` for another colouring or cut.
    pub(crate) fn subject(&self) -> Option<Subject> {
        let present = (self.quantity, self.section);
        Subject::ALL.into_iter().find(|subject| subject.parts() == present)
    }

    /// Sets colouring and cut.
    pub(crate) fn set_subject(&mut self, subject: Subject) {
        (self.quantity, self.section) = subject.parts();
    }

    /// Is the lower edge of the picture free, without a legend or a second picture?
    pub(crate) fn has_free_edge(&self) -> bool {
        self.subject() == Some(Subject::Look) && self.before == Before::Off
    }

    /// Is a torso drawn in place of the tissue?
    pub(crate) fn has_torso(&self) -> bool {
        self.torso && !self.section
    }

    /// Is the line of the pocket's edge drawn? On natural, uncut skin it looks like a scar.
    pub(super) fn has_pocket_line(&self) -> bool {
        self.subject() != Some(Subject::Look)
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
            quantity: Quantity::Tissue,
            section: false,
            section_azimuth_deg: -50.0,
            half: false,
            net: false,
            areola: true,
            areola_edge: false,
            torso: true,
            before: Before::Off,
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
        assert_eq!(options.subject(), Some(Subject::Look));
        options.set_subject(Subject::Stretch);
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

    #[test]
    fn the_look_of_the_skin_has_no_line_of_the_pocket_and_the_other_pictures_have_one() {
        let mut options = Options::default();
        for subject in Subject::ALL {
            options.set_subject(subject);
            assert_eq!(options.has_pocket_line(), subject != Subject::Look, "{subject:?}");
        }
    }
}

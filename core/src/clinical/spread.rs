//! How tissue differs between people, for bands around a result. No correlations are known.
//!
//! Methods of measurement differ more than people (skin 56 against 344 kPa, fat 3 against 9 kPa):
//! [`METHOD_SCALES`] are scenarios beside a band, not part of the band.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A distribution of a value or of a factor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Distribution {
    /// Lognormal, by its median and its geometric standard deviation.
    LogNormal {
        /// Median.
        median: f64,
        /// Geometric standard deviation, > 1.
        gsd: f64,
    },
    /// Normal, by its mean and its standard deviation.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        sd: f64,
    },
    /// Uniform between two bounds.
    Uniform {
        /// Lower bound.
        least: f64,
        /// Upper bound.
        most: f64,
    },
}

impl Distribution {
    /// The median.
    #[must_use]
    pub fn median(self) -> f64 {
        match self {
            Self::LogNormal { median, .. } => median,
            Self::Normal { mean, .. } => mean,
            Self::Uniform { least, most } => 0.5 * (least + most),
        }
    }

    /// The range of one standard deviation around the median (68 %); of a uniform distribution its bounds.
    #[must_use]
    pub fn range(self) -> (f64, f64) {
        match self {
            Self::LogNormal { median, gsd } => (median / gsd, median * gsd),
            Self::Normal { mean, sd } => (mean - sd, mean + sd),
            Self::Uniform { least, most } => (least, most),
        }
    }
}

/// What is unknown about a person.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The quantity.
    pub quantity: &'static str,
    /// Unit of the distribution, or how the distribution acts on the scene's value.
    pub unit: &'static str,
    /// Its distribution between people.
    pub distribution: Distribution,
}

/// Thickness of the skin \[mm\].
pub const SKIN_THICKNESS: Spread = Spread {
    quantity: "thickness of the skin",
    unit: "mm",
    distribution: Distribution::Normal { mean: 1.55, sd: 0.25 },
};

/// Stress scale of the skin \[-\].
pub const SKIN_STRESS_SCALE: Spread = Spread {
    quantity: "stress scale of the skin",
    unit: "",
    distribution: Distribution::LogNormal { median: 1.0, gsd: 1.3 },
};

/// Strain scale of the skin without a measured pull \[-\].
pub const SKIN_STRAIN_SCALE: Spread = Spread {
    quantity: "strain scale of the skin",
    unit: "",
    distribution: Distribution::LogNormal { median: 0.65, gsd: 1.9 },
};

/// Factor on the strain scale of the skin from a pull or a class \[-\].
pub const SKIN_STRAIN_SCALE_MEASURED: Spread = Spread {
    quantity: "strain scale of the skin after a pull",
    unit: "factor",
    distribution: Distribution::LogNormal { median: 1.0, gsd: 2.0 },
};

/// Stress scale of fat whose curve is `fat` \[-\].
pub const FAT_STRESS_SCALE: Spread = Spread {
    quantity: "stress scale of fat",
    unit: "",
    distribution: Distribution::LogNormal { median: 1.0, gsd: 1.6 },
};

/// Initial modulus of fat with another curve \[kPa\].
pub const FAT_MODULUS: Spread = Spread {
    quantity: "initial modulus of fat",
    unit: "kPa",
    distribution: Distribution::LogNormal { median: 4.0, gsd: 1.8 },
};

/// Factor on the thickness of the cover \[-\].
pub const COVER_THICKNESS: Spread = Spread {
    quantity: "thickness of the cover",
    unit: "factor",
    distribution: Distribution::LogNormal { median: 1.0, gsd: 1.3 },
};

/// Difference of the pocket's radius from the plan \[mm\].
pub const POCKET_RADIUS: Spread = Spread {
    quantity: "radius of the pocket",
    unit: "mm, added",
    distribution: Distribution::Normal { mean: 0.0, sd: 2.5 },
};

/// Difference of the chest's radius of curvature across from the plan \[mm\]: with the usual plan 140 ± 15 mm, as parametric bodies
/// measure it at the breast (121–156 mm).
pub const CHEST_RADIUS: Spread = Spread {
    quantity: "radius of the chest",
    unit: "mm, added",
    distribution: Distribution::Normal { mean: 0.0, sd: 15.0 },
};

/// Relative difference of the projection in the tissue from the nominal projection \[-\].
pub const PROJECTION: Spread = Spread {
    quantity: "projection of the implant",
    unit: "relative, added",
    distribution: Distribution::Normal { mean: -0.035, sd: 0.03 },
};

/// Factor on the natural tension of the skin \[-\]: measured in vivo are 6–11 and 42–138 N/m; with the usual 20 N/m the spread lies between
/// both.
pub const NATURAL_TENSION: Spread = Spread {
    quantity: "natural tension of the skin",
    unit: "factor",
    distribution: Distribution::LogNormal { median: 1.0, gsd: 2.2 },
};

/// Difference of the skin's growth from the plan \[-\]: assumed are 0.3 ± 0.2 at a week and 0.8 ± 0.2 from the third month, since 85 % of the
/// changes come in the first month (Eder et al. 2011, Ji et al. 2014).
pub const GROWN: Spread = Spread {
    quantity: "growth of the skin",
    unit: "added",
    distribution: Distribution::Normal { mean: 0.0, sd: 0.2 },
};

/// Factor on the moduli of the implant's gel and shell \[-\]: makers publish none, so that it is assumed: half of the way, by factors, from a
/// named gel to the next.
pub const FILL_MODULUS: Spread = Spread {
    quantity: "modulus of the fill",
    unit: "factor",
    distribution: Distribution::LogNormal { median: 1.0, gsd: 1.6 },
};

/// Initial modulus of the muscle \[kPa\]: 3 across its fibres to 30 along them is the range of 9 in 10.
pub const MUSCLE_MODULUS: Spread = Spread {
    quantity: "initial modulus of the muscle",
    unit: "kPa",
    distribution: Distribution::LogNormal { median: 9.5, gsd: 2.0 },
};

/// Poisson ratio of fat whose curve is `fat` \[-\]: fat holds its volume.
pub const FAT_POISSON_RATIO: Spread = Spread {
    quantity: "Poisson ratio of fat",
    unit: "",
    distribution: Distribution::Uniform { least: 0.48, most: 0.495 },
};

/// Poisson ratio of the other layers \[-\].
pub const POISSON_RATIO: Spread = Spread {
    quantity: "Poisson ratio",
    unit: "",
    distribution: Distribution::Uniform { least: 0.45, most: 0.49 },
};

/// Scenarios of the method of measurement: factors on all stresses \[-\].
pub const METHOD_SCALES: [f64; 3] = [0.4, 1.0, 2.5];

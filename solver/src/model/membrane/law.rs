//! The law of a whole stack of layers: one table per group of merged layers.

use crate::springs::Material;
use crate::springs::Springs;
use crate::springs::coupled::CoupledLaw;
use crate::springs::paper::{self, Spring, edge_strain_limit};
use crate::springs::table::{Table, Weight};

/// End of the tables of the paper's springs \[-\]: twice the strain range of the paper.
const PAPER_STRAIN: f64 = 2.0;

/// The law of a sheet.
#[derive(Clone, Debug)]
pub enum SheetLaw {
    /// Coupled springs.
    Coupled(CoupledLaw),
    /// The paper's springs.
    Paper(PaperLaw),
}

/// The sum of the paper's springs of all layers: the tension of a spring is a function of its own strain.
#[derive(Clone, Debug)]
pub struct PaperLaw {
    /// Σ h·f/Sq \[kPa·mm\] of an edge spring as a function of its strain.
    pub edge: Table,
    /// Σ h·f/Sq \[kPa·mm\] of a diagonal spring as a function of its strain.
    pub diagonal: Table,
}

impl SheetLaw {
    /// The law of the given springs and layers.
    #[must_use]
    pub(crate) fn new(springs: Springs, materials: &[Material]) -> Self {
        match springs {
            Springs::Coupled => Self::Coupled(CoupledLaw::new(materials)),
            Springs::Nikolaev => Self::Paper(PaperLaw::new(materials)),
        }
    }

    /// Small-strain stiffness \[kPa·mm\], the scale of forces: Σ h·Ef′(0)/(1−ν²) of coupled springs (no transverse
    /// strain), Σ h·Ef′(0) of the paper's edge springs.
    pub(crate) fn stiffness(&self) -> f64 {
        match self {
            Self::Coupled(law) => law.small_strain_stiffness(),
            Self::Paper(law) => law.edge.value_and_slope(-1e-6).1,
        }
    }

    /// The greatest error of a table, relative to its peak stress.
    #[must_use]
    pub(crate) fn table_error(&self) -> f64 {
        match self {
            Self::Coupled(law) => law.table_error(),
            Self::Paper(law) => law.edge.relative_error().max(law.diagonal.relative_error()),
        }
    }
}

impl PaperLaw {
    fn new(materials: &[Material]) -> Self {
        let end = materials
            .iter()
            .map(|m| edge_strain_limit(m.poisson_ratio))
            .fold(PAPER_STRAIN, f64::min);
        // Ef(ε) has kinks at the curve's breaks, Ef(−νε) at breaks/ν; both change form at zero.
        let mut breaks = vec![0.0];
        for m in materials {
            for b in m.curve.breaks() {
                breaks.push(-b);
                for bend in [b, b / m.poisson_ratio.max(1e-3)] {
                    breaks.extend([bend, paper::diagonal_strain(bend, -m.poisson_ratio * bend)]);
                }
            }
        }
        breaks.retain(|b| (-1.0..end).contains(b));
        breaks.sort_by(f64::total_cmp);
        let table = |spring: Spring| {
            let sum = |strain: f64| -> f64 {
                materials
                    .iter()
                    .map(|m| {
                        m.thickness_mm * paper::tension(spring, &m.curve, m.poisson_ratio, strain)
                    })
                    .sum()
            };
            Table::new(sum, (-1.0, end), &breaks, Weight::One)
        };
        Self { edge: table(Spring::Edge), diagonal: table(Spring::Diagonal) }
    }
}

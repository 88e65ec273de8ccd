//! Problem, method and options of a solve.

use crate::contact::Obstacle;
use crate::mesh::{Patch, Rest, Sheet};
use crate::model::layered::suction::Suction;
use crate::springs::{Material, Springs};
use serde::{Deserialize, Serialize};

/// The equilibrium problem.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The tissue at rest on the finest grid.
    pub rest: Rest,
    /// The simulated tissue, its pocket and the boundary condition at its edge.
    pub patch: Patch,
    /// Dome and wall.
    pub obstacle: Obstacle,
    /// Layers from the skin inwards.
    pub materials: Vec<Material>,
    /// The tissue model.
    pub tissue: Tissue,
    /// The spring law of a sheet.
    pub springs: Springs,
    /// Greatest node position error allowed \[base radius\].
    pub tolerance: f64,
    /// The void of the pocket; `None`: as large as it gets. Layered tissue only.
    pub void: Option<Void>,
}

/// A void that is limited: filled with fluid that neither flows in nor stretches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Void {
    /// Greatest volume \[mm³\].
    pub most_mm3: f64,
    /// Suction at which the volume is not larger \[kPa\]; zero before a solve, and where the void is smaller by itself.
    pub suction_kpa: f64,
}

impl Problem {
    /// The finest grid, on the disc of the patch.
    #[must_use]
    pub fn sheet(&self) -> &Sheet {
        self.rest.sheet()
    }

    /// Is the problem its own image mirrored along x, along y? Tissue at rest, implant, wall and pocket are.
    #[must_use]
    pub fn mirrored(&self) -> [bool; 2] {
        let (rest, obstacle) = (self.rest.mirrored(), self.obstacle.mirrored());
        let pocket = [true, !self.patch.pocket().is_lowered()];
        [0, 1].map(|axis| rest[axis] && obstacle[axis] && pocket[axis])
    }

    /// The suction of the void on the inner face \[kPa\].
    #[must_use]
    pub fn suction_kpa(&self) -> f64 {
        self.void.map_or(0.0, |void| void.suction_kpa)
    }

    /// The suction on the nodes of the finest grid; `None` without one.
    pub(super) fn suction(&self) -> Option<Suction> {
        self.suction_on(self.sheet())
    }

    /// [`Self::suction`] on the nodes of a grid.
    pub(super) fn suction_on(&self, sheet: &Sheet) -> Option<Suction> {
        let (kpa, pocket) = (self.suction_kpa(), self.patch.pocket());
        (kpa > 0.0).then(|| Suction::new(kpa, &self.obstacle.wall.0, sheet, pocket))
    }

    /// Does the membrane wrinkle instead of being compressed? Of coupled springs; the paper's push.
    #[must_use]
    pub fn wrinkles(&self) -> bool {
        self.springs == Springs::Coupled
    }

    /// The layers of the membrane: all layers of a sheet, the skin of layered tissue.
    #[must_use]
    pub fn membrane(&self) -> &[Material] {
        match self.tissue {
            Tissue::Sheet => &self.materials,
            Tissue::Layered => &self.materials[..1],
        }
    }

    /// The layers that are solids: none of a sheet, all layers under the skin of layered tissue.
    #[must_use]
    pub fn solids(&self) -> &[Material] {
        &self.materials[self.membrane().len()..]
    }

    /// Strain at which the curve of the skin turns steep \[-\], the skin's reserve
    /// ([`Curve::knee`](crate::curve::Curve::knee)); `None` for a sheet, or a skin whose curve does not stiffen so far.
    #[must_use]
    pub fn skin_knee(&self) -> Option<f64> {
        self.materials.first().filter(|_| self.tissue == Tissue::Layered)?.curve.knee()
    }
}

/// The tissue model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tissue {
    /// All layers are one membrane.
    #[default]
    Sheet,
    /// The first layer is a membrane, the skin, which wrinkles instead of being compressed (tension field); the others are
    /// solids under it.
    Layered,
}

/// State of a solve between two slices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The solve has not ended.
    Working,
    /// The solve has ended; [`super::Report::verdict`] is its status.
    Done,
}

/// The method of solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Method {
    /// Full multigrid; Newton's method as the fallback.
    #[default]
    Automatic,
    /// Full multigrid with this many V-cycles on the finest grid, whatever the tolerance: for studies of run
    /// time against error. Stability under the paper's springs is not checked.
    Multigrid {
        /// V-cycles on the finest grid.
        cycles: u32,
    },
    /// Newton's method on nested grids.
    Newton,
}

/// Cells of layered tissue up to which Newton's method is the fallback: ten seconds, and 750 bytes a cell.
const MAX_NEWTON_CELLS: usize = 60_000;

/// Options of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Solve a centred dome on one quarter of the sheet, a dome moved along an axis on half of the sheet, by
    /// multigrid.
    pub use_symmetry: bool,
    /// A position error \[base radius\] at which [`super::Solver::advance`] returns once with a draft, if the
    /// tolerance is smaller. Pauses before display the solution of a coarser grid.
    pub draft_tolerance: Option<f64>,
    /// Factor on Newton's iteration and work limits \[-\].
    pub work_limit_factor: f64,
    /// Greatest number of cells of layered tissue that Newton's method computes after multigrid.
    pub max_newton_cells: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: Method::Automatic,
            use_symmetry: true,
            draft_tolerance: None,
            work_limit_factor: 1.0,
            max_newton_cells: MAX_NEWTON_CELLS,
        }
    }
}

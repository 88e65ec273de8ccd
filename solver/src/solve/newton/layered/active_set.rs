//! The active set of a step of the inner face.

use super::{LayeredNewton, PARAMETERS, Phase};
use crate::contact::active_set::{Constraint, FREE, ON_DOME, ON_WALL};

impl LayeredNewton {
    /// Adds nodes that the step moves into the obstacle to the active set, and takes nodes out that the obstacle would
    /// pull.
    pub(super) fn update_active_set(&mut self) {
        self.rounds += 1;
        self.set_residual();
        let mut changed = 0;
        let [depth, touch] =
            [PARAMETERS.depth, PARAMETERS.touch].map(|part| part * self.grid.sheet().spacing_mm());
        for index in 0..self.grid.free.len() {
            let k = self.grid.free[index] as usize;
            let (d, was) = (self.d[0][k], self.contact.active[k]);
            let Constraint { normal, gap, wall_normal, height, .. } = self.contact.constraint[k];
            let (over_dome, over_wall) = (gap + normal.dot(d), height + wall_normal.dot(d));
            let mut now = was;
            if over_dome < -depth {
                now |= ON_DOME;
            }
            if over_wall < -depth {
                now |= ON_WALL;
            }
            if now == was && was != FREE {
                // A constraint of a step is as one of a node on the surface.
                let mut moved = self.contact.constraint[k];
                (moved.gap, moved.height) = (over_dome, over_wall);
                now &= moved.reaction(self.vectors.r[0][k], touch).active;
            }
            if now != was {
                changed += 1;
                self.contact.active[k] = now;
                self.constrain(k);
            }
        }
        if changed == 0 || self.rounds >= PARAMETERS.max_rounds {
            self.phase = Phase::LineSearch { length: 1.0, halvings: 0 };
        } else {
            self.begin_gradients();
        }
    }
}

//! Newton's method with line search inside of the iteration of augmented Lagrangians; raising of the dome on the
//! coarsest mesh, nested iteration from mesh to mesh.
//!
//! A Hessian that is not positive definite is shifted by a multiple of the diagonal at rest. The multipliers change
//! after every minimisation; the iteration ends when multipliers and positions move less than the tolerance.
//!
//! Uses `assembly`, `banded`, `contact`. Used by `mod`.

use super::assembly::Tissue;
use super::banded::{Banded, Factor};
use super::contact::{Contact, Section};

/// Penalty κ, relative to the node's stiffness at rest \[-\].
const PENALTY: f64 = 50.0;
/// Greatest rise of the dome per step, relative to its projection \[-\]; a step is at most one cell wide as well.
/// Larger steps end in folds of the inner face: `default` of `layered.json` on 144 × 8 cells without nested iteration.
const RISE: f64 = 0.1;
/// Smallest step of the dome, relative to its projection \[-\].
const MIN_RISE: f64 = 1e-3;
/// Greatest number of Newton steps of a minimisation.
const MAX_STEPS: usize = 60;
/// Greatest number of changes of the multipliers at one height.
const MAX_UPDATES: usize = 40;
/// Greatest movement and violation at the final height and on the way, relative to the base radius \[-\].
const FINE: f64 = 1e-9;
const COARSE: f64 = 1e-4;
/// Smallest factor of the line search \[-\].
const MIN_FACTOR: f64 = 1e-9;
/// Armijo's constant \[-\].
const ARMIJO: f64 = 1e-4;
/// Rounding error of the energy, relative \[-\].
const ROUNDING: f64 = 1e-12;
/// First shift of the Hessian, growth of the shift and greatest shift, relative to the diagonal at rest \[-\].
const FIRST_SHIFT: f64 = 1e-4;
const SHIFT_GROWTH: f64 = 4.0;
const MAX_SHIFT: f64 = 1e4;

/// Difference of the volume from the wanted one at the end \[mm³\], most steps, and the first suction \[kPa\].
const TOLERANCE_MM3: f64 = 2.0;
const MOST_STEPS: usize = 60;
const FIRST_KPA: f64 = 0.05;

/// The equilibrium.
pub(super) struct Equilibrium {
    /// Coordinates \[mm\].
    pub(super) x: Vec<f64>,
    /// Force of the dome along the axis \[N\].
    pub(super) contact_force_n: f64,
    contact: Contact,
}

/// Computes the equilibrium on the last mesh by nested iteration from the first, coarsest one, on which the dome is
/// raised. The error is the insertion reached.
pub(super) fn equilibrium(meshes: &[Tissue], section: Section) -> Result<Equilibrium, f64> {
    let mut before: Option<(&Tissue, Vec<f64>)> = None;
    let mut contact = None;
    for (number, tissue) in meshes.iter().enumerate() {
        let mut search = Search::new(tissue, section);
        let is_last = number + 1 == meshes.len();
        let tolerance = if is_last { FINE } else { COARSE } * section.base_radius;
        let is_found = before.take().is_some_and(|(coarse, x)| {
            search.x = coarse.interpolate(&x, tissue);
            search.solve(tolerance)
        });
        if !is_found {
            search = Search::new(tissue, section);
            match search.raise(tolerance) {
                Err(reached) if is_last => return Err(reached),
                // The next mesh starts at rest.
                Err(_) => continue,
                Ok(()) => {}
            }
        }
        contact = Some(search.contact);
        before = Some((tissue, search.x));
    }
    let (Some((tissue, x)), Some(contact)) = (before, contact) else { return Err(0.0) };
    Ok(Equilibrium::new(tissue, x, contact))
}

/// The equilibrium of a mesh whose skin has grown, or whose inner face is under another suction, from the one before.
pub(super) fn again(tissue: &Tissue, before: Equilibrium) -> Option<Equilibrium> {
    let Equilibrium { x, contact, .. } = before;
    let section = contact.section;
    let mut search = Search { x, contact, ..Search::new(tissue, section) };
    search
        .solve(FINE * section.base_radius)
        .then(|| Equilibrium::new(tissue, search.x, search.contact))
}

/// The equilibrium under the suction at which the volume is no larger than wanted \[mm³\]: regula falsi of V^(−1/2) of the void.
pub(super) fn limited(
    tissue: &mut Tissue,
    mut found: Equilibrium,
    (filled, most): (f64, f64),
) -> Option<Equilibrium> {
    let root = |volume: f64| (volume - filled).max(1.0).powf(-0.5);
    let wanted = root(filled + most);
    let mut before: Option<[f64; 2]> = None;
    for _ in 0..MOST_STEPS {
        let volume = tissue.enclosed(&found.x) - filled;
        let kpa = tissue.suction.kpa;
        if (volume - most).abs() < TOLERANCE_MM3 || kpa <= 0.0 && volume <= most {
            return Some(found);
        }
        let own = root(filled + volume);
        tissue.suction.kpa = match before {
            None => FIRST_KPA,
            Some([kpa_before, before]) => {
                let next = kpa + (wanted - own) * (kpa - kpa_before) / (own - before);
                next.clamp(0.5 * kpa, 1.5 * kpa)
            }
        };
        before = Some([kpa, own]);
        found = again(tissue, found)?;
    }
    None
}

impl Equilibrium {
    fn new(tissue: &Tissue, x: Vec<f64>, contact: Contact) -> Self {
        let contact_force_n = contact.axial_force(inner(tissue, &x)) / 1000.0;
        Self { x, contact_force_n, contact }
    }

    /// Normal force of the dome \[mN\] on each node of the inner face.
    pub(super) fn normal_forces(&self, tissue: &Tissue) -> Vec<f64> {
        self.contact.normal_forces(inner(tissue, &self.x))
    }
}

/// Positions of the inner face's nodes \[mm\].
fn inner<'a>(tissue: &'a Tissue, x: &'a [f64]) -> impl Iterator<Item = [f64; 2]> + 'a {
    (0..tissue.columns).map(|column| {
        let n = tissue.number(column, 0);
        [x[n], x[n + 1]]
    })
}

struct Search<'a> {
    tissue: &'a Tissue,
    contact: Contact,
    x: Vec<f64>,
    gradient: Vec<f64>,
    hessian: Banded,
    /// Diagonal of the Hessian at rest \[N/m\].
    scale: Vec<f64>,
    shift: f64,
}

impl<'a> Search<'a> {
    fn new(tissue: &'a Tissue, section: Section) -> Self {
        let x = tissue.rest.clone();
        let mut gradient = vec![0.0; x.len()];
        let mut hessian = tissue.matrix();
        tissue.linearise(&x, &mut gradient, &mut hessian);
        let scale: Vec<f64> = (0..x.len()).map(|i| hessian.diagonal(i)).collect();
        let penalty = |column| PENALTY * scale[tissue.number(column, 0) + 1];
        let contact = Contact::new(section, (0..tissue.columns).map(penalty).collect());
        Self { tissue, contact, x, gradient, hessian, scale, shift: 0.0 }
    }

    /// Raises the dome in steps from the insertion 0. The error is the insertion reached.
    fn raise(&mut self, tolerance: f64) -> Result<(), f64> {
        let Section { base_radius, projection, base_height, .. } = self.contact.section;
        let end = 1.0 + base_height / projection;
        let greatest = RISE.min(self.tissue.radius(1) / projection);
        let (mut reached, mut rise) = (0.0, greatest);
        while reached < end {
            let is_last = reached + 1.0001 * rise >= end;
            let next = if is_last { end } else { reached + rise };
            let before = (self.x.clone(), self.contact.clone());
            self.contact.section.base_height = (next - 1.0) * projection;
            if self.solve(if is_last { tolerance } else { COARSE * base_radius }) {
                reached = next;
                rise = greatest.min(2.0 * rise);
            } else {
                (self.x, self.contact) = before;
                rise *= 0.5;
                if rise < MIN_RISE {
                    return Err(reached);
                }
            }
        }
        Ok(())
    }

    /// Does the inner face turn back? Folded states are local minima of the discrete energy, between whose nodes the
    /// dome protrudes; found for a needle twice as high as its base radius on 40 × 2 cells.
    fn is_folded(&self) -> bool {
        let radii: Vec<f64> = inner(self.tissue, &self.x).map(|[r, _]| r).collect();
        radii.windows(2).any(|pair| pair[1] <= pair[0])
    }

    /// Minimises and changes the multipliers in turn until both move less than `tolerance` \[mm\]. Returns `false`
    /// without convergence and for a folded state.
    fn solve(&mut self, tolerance: f64) -> bool {
        for _ in 0..MAX_UPDATES {
            if !self.minimise(tolerance) {
                return false;
            }
            let violation = self.contact.update(inner(self.tissue, &self.x));
            if violation < tolerance {
                return !self.is_folded();
            }
        }
        false
    }

    fn energy(&self, x: &[f64]) -> f64 {
        let contact = |(node, at)| self.contact.term(node, at).energy;
        self.tissue.energy(x) + inner(self.tissue, x).enumerate().map(contact).sum::<f64>()
    }

    /// Energy with the contact's terms; gradient and Hessian with the fixed coordinates left out.
    fn linearise(&mut self) -> Option<f64> {
        let mut energy = self.tissue.linearise(&self.x, &mut self.gradient, &mut self.hessian)?;
        for (node, at) in inner(self.tissue, &self.x).enumerate() {
            let term = self.contact.term(node, at);
            energy += term.energy;
            let n = self.tissue.number(node, 0);
            self.gradient[n] += term.gradient[0];
            self.gradient[n + 1] += term.gradient[1];
            self.hessian.add(n, n, term.hessian[0]);
            self.hessian.add(n + 1, n, term.hessian[1]);
            self.hessian.add(n + 1, n + 1, term.hessian[2]);
        }
        for n in self.tissue.fixed() {
            self.gradient[n] = 0.0;
            self.hessian.fix(n);
        }
        Some(energy)
    }

    /// The factorisation with the smallest shift that makes the Hessian positive definite.
    fn factor(&mut self) -> Option<Factor> {
        if let Some(factor) = self.hessian.factor(0.0, &self.scale) {
            self.shift = 0.0;
            return Some(factor);
        }
        self.shift = FIRST_SHIFT.max(self.shift / SHIFT_GROWTH);
        while self.shift < MAX_SHIFT {
            if let Some(factor) = self.hessian.factor(self.shift, &self.scale) {
                return Some(factor);
            }
            self.shift *= SHIFT_GROWTH;
        }
        None
    }

    /// Newton's method at fixed multipliers until a full step is shorter than `tolerance` \[mm\].
    fn minimise(&mut self, tolerance: f64) -> bool {
        for _ in 0..MAX_STEPS {
            let Some(energy) = self.linearise() else { return false };
            let Some(factor) = self.factor() else { return false };
            let step = factor.solve(&self.gradient);
            let slope: f64 = step.iter().zip(&self.gradient).map(|(d, g)| -d * g).sum();
            let longest = step.iter().fold(0.0_f64, |max, d| max.max(d.abs()));
            let mut factor = 1.0;
            loop {
                let moved: Vec<f64> =
                    self.x.iter().zip(&step).map(|(x, d)| x - factor * d).collect();
                let allowed = energy + ARMIJO * factor * slope + ROUNDING * energy.abs();
                // A NaN is not allowed either.
                if self.energy(&moved) <= allowed {
                    self.x = moved;
                    break;
                }
                factor *= 0.5;
                if factor < MIN_FACTOR {
                    return false;
                }
            }
            if longest < tolerance && self.shift <= 0.0 {
                return true;
            }
        }
        false
    }
}

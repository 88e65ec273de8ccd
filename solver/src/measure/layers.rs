//! Stresses of the layers.

use crate::curve::Curve;
use crate::mesh::{NodeKind, Sheet};
use crate::model::membrane::deformation::Deformation;
use crate::model::membrane::stack::first_alike;
use crate::solve::Solution;
use crate::springs::Material;
use crate::springs::coupled::{biot_stress, equivalent_strain, relaxed};

/// Bins of the equivalent strain in the search for the most stressed node.
const BINS: usize = 256;

/// The load of a layer.
pub(super) struct Load {
    /// Greatest principal nominal (Biot) stress \[kPa\].
    pub(super) max_stress: f64,
    /// Does a strain lie beyond the data of the layer's curve?
    pub(super) is_beyond_data: bool,
}

/// The principal strains at which the law of the membrane is evaluated at a node \[-\]: in a tension field the relaxed ones.
fn law_strain(
    deformation: &Deformation,
    node: usize,
    poisson_ratio: f64,
    is_tension_field: bool,
) -> [f64; 2] {
    let strain = deformation.principal(node);
    if is_tension_field { relaxed(strain, poisson_ratio) } else { strain }
}

/// Greatest principal nominal (Biot) stress of a layer at a node \[kPa\]; of a tension field 0 or more.
pub(super) fn stress(
    material: &Material,
    deformation: &Deformation,
    node: usize,
    is_tension_field: bool,
) -> f64 {
    let nu = material.poisson_ratio;
    biot_stress(&material.curve, nu, law_strain(deformation, node, nu, is_tension_field))[0]
}

/// Compressive stress above which the result warns of wrinkles \[small-strain modulus\].
const WRINKLING_STRESS: f64 = 0.01;

/// The warning of compression, for a membrane that can be compressed.
pub(super) fn compression(solution: &Solution) -> Option<String> {
    let problem = solution.problem();
    let least = least_stress(problem.membrane(), solution.elastic_deformation(), problem.sheet());
    (least < -WRINKLING_STRESS).then(|| {
        "Part of the tissue is under compression and may wrinkle; a model without bending stiffness does not \
         resolve wrinkles."
            .to_owned()
    })
}

/// Least principal tension of the membrane's free nodes, negative in compression, relative to its small-strain stiffness
/// Σ h·Ef′(0) \[-\]; zero without compression.
fn least_stress(materials: &[Material], deformation: &Deformation, sheet: &Sheet) -> f64 {
    let stiffness: f64 =
        materials.iter().map(|m| m.thickness_mm * m.curve.small_strain_modulus()).sum();
    let tension = |node: usize| -> f64 {
        let strain = deformation.principal(node);
        let of = |m: &Material| m.thickness_mm * biot_stress(&m.curve, m.poisson_ratio, strain)[1];
        materials.iter().map(of).sum()
    };
    // A node without a negative strain has no negative stress.
    let is_wanted =
        |k: &usize| sheet.kinds()[*k] == NodeKind::Free && deformation.principal(*k)[1] < 0.0;
    deformation.inside().filter(is_wanted).map(tension).fold(0.0, f64::min) / stiffness
}

/// The load of every layer of the membrane.
pub(super) fn loads(
    materials: &[Material],
    deformation: &Deformation,
    is_tension_field: bool,
) -> Vec<Load> {
    let mut sorted: Vec<SortedStrains> = Vec::with_capacity(materials.len());
    let mut loads = Vec::with_capacity(materials.len());
    for (k, first) in first_alike(materials).enumerate() {
        let material = &materials[k];
        sorted.push(if first == k {
            SortedStrains::new(deformation, material.poisson_ratio, is_tension_field)
        } else {
            SortedStrains::default()
        });
        let stress = |node| stress(material, deformation, node, is_tension_field);
        loads.push(Load {
            max_stress: sorted[first].max_stress(&material.curve, stress),
            is_beyond_data: material.curve.is_beyond_data(sorted[first].greatest),
        });
    }
    loads
}

/// The sheet's nodes in bins of equal width of the equivalent strain ē, for the layers of one
/// Poisson ratio.
///
/// The greatest principal stress of a node is Ef(ē) times a factor of the strains' direction,
/// (ε₁ + νε₂)/((1−ν²)ē), and Ef increases. The greatest factor of a bin and the stresses at the ends of the bin
/// bound the greatest stress in the bin: few bins have to be searched.
#[derive(Default)]
struct SortedStrains {
    /// Greatest equivalent strain \[-\].
    greatest: f64,
    /// Greatest factor of each bin; −∞ in empty bins. Shape ([`BINS`], ).
    factors: Vec<f64>,
    /// Index of the first node of each bin, and the number of nodes. Shape (BINS + 1, ).
    starts: Vec<usize>,
    nodes: Vec<u32>,
}

impl SortedStrains {
    fn new(deformation: &Deformation, poisson_ratio: f64, is_tension_field: bool) -> Self {
        let mut strains = Vec::with_capacity(deformation.part().len());
        let plane = 1.0 - poisson_ratio * poisson_ratio;
        let mut greatest = 0.0_f64;
        for k in deformation.inside() {
            let strain = law_strain(deformation, k, poisson_ratio, is_tension_field);
            let equivalent = equivalent_strain(strain, poisson_ratio);
            greatest = greatest.max(equivalent);
            let pull = strain[0] + poisson_ratio * strain[1];
            let factor = if equivalent > 0.0 { pull / (plane * equivalent) } else { 0.0 };
            strains.push((k as u32, equivalent, factor));
        }
        let per_strain = if greatest > 0.0 { BINS as f64 / greatest } else { 0.0 };
        let bin = |equivalent: f64| ((equivalent * per_strain) as usize).min(BINS - 1);
        let (mut factors, mut starts) = (vec![f64::NEG_INFINITY; BINS], vec![0; BINS + 1]);
        for &(_, equivalent, factor) in &strains {
            let bin = bin(equivalent);
            factors[bin] = factors[bin].max(factor);
            starts[bin + 1] += 1;
        }
        for bin in 0..BINS {
            starts[bin + 1] += starts[bin];
        }
        let (mut next, mut nodes) = (starts.clone(), vec![0; strains.len()]);
        for (node, equivalent, _) in strains {
            let index = &mut next[bin(equivalent)];
            nodes[*index] = node;
            *index += 1;
        }
        Self { greatest, factors, starts, nodes }
    }

    /// The greatest of the nodes' stresses \[kPa\] in a layer with this curve.
    fn max_stress(&self, curve: &Curve, stress: impl Fn(usize) -> f64) -> f64 {
        let edges: Vec<f64> =
            (0..=BINS).map(|k| curve.stress(self.greatest * k as f64 / BINS as f64)).collect();
        let ends = |bin: usize| [edges[bin], edges[bin + 1]].map(|e| e * self.factors[bin]);
        let used = |bin: &usize| self.factors[*bin] > f64::NEG_INFINITY;
        let least = (0..BINS)
            .filter(used)
            .map(|bin| ends(bin)[0].min(ends(bin)[1]))
            .fold(f64::MIN, f64::max);
        // Rounding may put a node into an adjacent bin.
        let least = least - 1e-9 * least.abs();
        (0..BINS)
            .filter(used)
            .filter(|&bin| ends(bin)[0].max(ends(bin)[1]) >= least)
            .flat_map(|bin| &self.nodes[self.starts[bin]..self.starts[bin + 1]])
            .map(|&node| stress(node as usize))
            .fold(f64::MIN, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::solve::{Problem, Solver, samples};
    use std::cell::Cell;

    fn solved(problem: Problem) -> Solver {
        let mut solver = Solver::new(problem);
        solver.advance(&mut || false);
        solver
    }

    #[test]
    fn the_greatest_stress_is_that_of_a_search_over_all_nodes() {
        for (insertion, center) in [(1.0, 0.0), (0.4, 6.0), (0.0, 0.0)] {
            let mut problem = samples::sheet(33, [center, 0.0], insertion);
            problem.materials.push(samples::layer(&CurveSpec::Skin {}, 0.2));
            let solver = solved(problem);
            let materials = &solver.problem().materials;
            let deformation =
                Deformation::new(solver.problem().rest.membrane(), solver.positions());
            for is_tension_field in [false, true] {
                for (material, load) in
                    materials.iter().zip(loads(materials, &deformation, is_tension_field))
                {
                    let all = deformation
                        .inside()
                        .map(|node| stress(material, &deformation, node, is_tension_field));
                    let greatest = all.fold(f64::MIN, f64::max);
                    assert!((load.max_stress - greatest).abs() <= 1e-14 * greatest.abs());
                }
            }
        }
    }

    #[test]
    fn the_search_for_the_greatest_stress_visits_few_nodes() {
        let solver = solved(samples::sheet(33, [0.0; 2], 1.0));
        let material = &solver.problem().materials[0];
        let deformation = Deformation::new(solver.problem().rest.membrane(), solver.positions());
        let count = Cell::new(0);
        SortedStrains::new(&deformation, 0.45, false).max_stress(&material.curve, |node| {
            count.set(count.get() + 1);
            stress(material, &deformation, node, false)
        });
        assert!((1..deformation.inside().count() / 8).contains(&count.get()), "{count:?}");
    }
}

//! Supernodal Cholesky factorisation of `faer`; the symbolic factorisation and the memory are reused.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::{Perm, PermRef};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use implant_preview::solve::{Factorization, LowerTriangle};
use std::sync::Mutex;
use std::time::Instant;

/// What the factorisations of a run cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost {
    /// Orders and symbolic factorisations \[ms\].
    pub symbolic_ms: f64,
    /// Numeric factorisations \[ms\].
    pub numeric_ms: f64,
    /// Solutions of triangular systems \[ms\].
    pub solve_ms: f64,
    /// Numeric factorisations on the largest matrix.
    pub largest: u32,
    /// Unknowns of the largest matrix.
    pub unknowns: usize,
    /// Entries of its factor.
    pub entries: usize,
    /// Numeric factorisations on all grids, and those that failed.
    pub all: [u32; 2],
}

static COST: Mutex<Cost> = Mutex::new(Cost {
    symbolic_ms: 0.0,
    numeric_ms: 0.0,
    solve_ms: 0.0,
    largest: 0,
    unknowns: 0,
    entries: 0,
    all: [0; 2],
});

/// Returns the cost since the last call.
pub fn take_cost() -> Cost {
    std::mem::take(&mut COST.lock().expect("no other thread"))
}

fn count(change: impl FnOnce(&mut Cost)) {
    change(&mut COST.lock().expect("no other thread"));
}

fn since(start: Instant) -> f64 {
    1e3 * start.elapsed().as_secs_f64()
}

/// A factorisation on one grid.
#[derive(Default)]
pub struct Cholesky {
    symbolic: Option<SymbolicCholesky<usize>>,
    values: Vec<f64>,
    memory: Option<MemBuffer>,
    memory_of_solve: Mutex<Option<MemBuffer>>,
}

/// A factorisation of any matrix.
pub fn new() -> Box<dyn Factorization> {
    Box::new(Cholesky::default())
}

impl Cholesky {
    /// Of the orders by approximate minimum degree and by nested dissection the one whose factor has fewer entries.
    fn analyse(&mut self, matrix: &LowerTriangle) {
        let n = matrix.len();
        let pattern =
            SymbolicSparseColMatRef::new_checked(n, n, &matrix.starts, None, &matrix.rows);
        let by = |order: SymmetricOrdering<usize>| {
            let parameters = CholeskySymbolicParams::default();
            factorize_symbolic_cholesky(pattern, Side::Lower, order, parameters)
                .expect("memory for the symbolic factorisation")
        };
        let degree = by(SymmetricOrdering::Amd);
        let order = dissection(&matrix.places);
        let dissected = by(SymmetricOrdering::Custom(order.as_ref()));
        let better = if degree.len_val() <= dissected.len_val() { degree } else { dissected };
        self.values = vec![0.0; better.len_val()];
        let parameters = Default::default();
        self.memory =
            Some(MemBuffer::new(better.factorize_numeric_llt_scratch::<f64>(Par::Seq, parameters)));
        self.memory_of_solve =
            Mutex::new(Some(MemBuffer::new(better.solve_in_place_scratch::<f64>(1, Par::Seq))));
        self.symbolic = Some(better);
    }
}

impl Factorization for Cholesky {
    fn factorize(&mut self, matrix: &LowerTriangle) -> bool {
        if self.symbolic.is_none() {
            let start = Instant::now();
            self.analyse(matrix);
            count(|cost| cost.symbolic_ms += since(start));
        }
        let start = Instant::now();
        let (Some(symbolic), Some(memory)) = (&self.symbolic, &mut self.memory) else {
            return false;
        };
        let n = matrix.len();
        // The pattern was checked with the first matrix.
        let pattern =
            SymbolicSparseColMatRef::new_checked(n, n, &matrix.starts, None, &matrix.rows);
        let is_positive = symbolic
            .factorize_numeric_llt(
                &mut self.values,
                SparseColMatRef::new(pattern, &matrix.values),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(memory),
                Default::default(),
            )
            .is_ok();
        count(|cost| {
            cost.numeric_ms += since(start);
            if n > cost.unknowns {
                (cost.unknowns, cost.entries, cost.largest) = (n, symbolic.len_val(), 0);
            }
            cost.largest += u32::from(n == cost.unknowns);
            cost.all[0] += 1;
            cost.all[1] += u32::from(!is_positive);
        });
        is_positive
    }

    fn solve(&self, vector: &mut [f64]) {
        let start = Instant::now();
        let mut memory = self.memory_of_solve.lock().expect("no other thread");
        if let (Some(symbolic), Some(memory)) = (&self.symbolic, &mut *memory) {
            let n = vector.len();
            LltRef::new(symbolic, &self.values).solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(vector, n, 1),
                Par::Seq,
                MemStack::new(memory),
            );
        }
        count(|cost| cost.solve_ms += since(start));
    }
}

/// Nested dissection of the grid: whole columns of the tissue separate two halves.
fn dissection(places: &[[usize; 2]]) -> Perm<usize> {
    let mut order = Vec::with_capacity(places.len());
    dissect((0..places.len()).collect(), places, &mut order);
    let mut inverse = vec![0; order.len()];
    for (new, &old) in order.iter().enumerate() {
        inverse[old] = new;
    }
    let dim = order.len();
    PermRef::new_checked(&order, &inverse, dim);
    Perm::new_checked(order.into(), inverse.into(), dim)
}

/// Columns of the tissue up to which a part is not divided.
const LEAST_SIDE: usize = 3;

fn dissect(part: Vec<usize>, places: &[[usize; 2]], order: &mut Vec<usize>) {
    let range = |axis: usize| {
        let at = || part.iter().map(|&k| places[k][axis]);
        (at().min().unwrap_or(0), at().max().unwrap_or(0))
    };
    let [x, y] = [range(0), range(1)];
    let axis = usize::from(y.1 - y.0 > x.1 - x.0);
    let (least, most) = [x, y][axis];
    if most - least < LEAST_SIDE {
        order.extend(part);
        return;
    }
    // The line with half of the part on either side.
    let mut at: Vec<usize> = part.iter().map(|&k| places[k][axis]).collect();
    at.sort_unstable();
    let line = at[at.len() / 2].clamp(least + 1, most - 1);
    let mut parts = [Vec::new(), Vec::new(), Vec::new()];
    for k in part {
        let side = places[k][axis].cmp(&line) as i8;
        parts[match side {
            -1 => 0,
            1 => 1,
            _ => 2,
        }]
        .push(k);
    }
    let [before, after, separator] = parts;
    dissect(before, places, order);
    dissect(after, places, order);
    order.extend(separator);
}

//! The seam between Newton's method and a direct solver: a sparse symmetric matrix whose pattern stays, and its
//! factorisation.

/// The lower triangle of a sparse symmetric matrix, column by column; explicit zeros are stored.
#[derive(Clone, Debug, Default)]
pub struct LowerTriangle {
    /// The first entry of each column, and the number of entries; shape (unknowns + 1, ).
    pub starts: Vec<usize>,
    /// Row of each entry, rising in a column from its diagonal on; shape (entries, ).
    pub rows: Vec<usize>,
    /// Value of each entry \[kPa·mm\], shape (entries, ).
    pub values: Vec<f64>,
    /// Column and row of the grid of each unknown's node, for a fill-reducing order; shape (unknowns, ).
    pub places: Vec<[usize; 2]>,
}

impl LowerTriangle {
    /// Number of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Has the matrix no unknowns?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A factorisation of symmetric positive definite matrices of one pattern.
pub trait Factorization: Send {
    /// Factorises a matrix; false if the matrix is not positive definite. The pattern is that of the first call.
    fn factorize(&mut self, matrix: &LowerTriangle) -> bool;

    /// Replaces a right-hand side by the solution with the last matrix that [`Self::factorize`] accepted.
    fn solve(&self, vector: &mut [f64]);
}

/// Creates a factorisation, one for each grid.
pub type NewFactorization = fn() -> Box<dyn Factorization>;

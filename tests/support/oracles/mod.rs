//! Problems given as dense arrays, and a slow and simple solver that tries every contact set.

mod dual;
pub mod exact;
pub mod modes;
pub mod promises;

use nalgebra::{DMatrix, DVector};
use signorini::qp::{Error, LinearError};
use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix};

/// A small problem in dense arrays, row by row.
#[derive(Clone, Debug)]
pub struct Dense {
    pub stiffness: DMatrix<f64>,
    pub load: DVector<f64>,
    pub contact: DMatrix<f64>,
    pub gap: DVector<f64>,
}

/// Displacement, multiplier and closed rows of a solution.
#[derive(Clone, Debug)]
pub struct Enumerated {
    pub displacement: DVector<f64>,
    pub multiplier: DVector<f64>,
    pub closed: Vec<usize>,
}

impl Dense {
    pub fn new(stiffness: &[&[f64]], load: &[f64], contact: &[&[f64]], gap: &[f64]) -> Self {
        let matrix = |rows: &[&[f64]], columns: usize| {
            DMatrix::from_row_iterator(rows.len(), columns, rows.iter().flat_map(|row| row.iter().copied()))
        };
        Dense {
            stiffness: matrix(stiffness, load.len()),
            load: DVector::from_row_slice(load),
            contact: matrix(contact, load.len()),
            gap: DVector::from_row_slice(gap),
        }
    }

    /// The linear complementarity problem w = M x + q, w >= 0, x >= 0, w'x = 0 as the QP min 1/2 x'Mx + q'x, -x <= 0.
    pub fn lcp(matrix: &[&[f64]], q: &[f64]) -> Self {
        let n = q.len();
        let load: Vec<f64> = q.iter().map(|value| -value).collect();
        let mut dense = Dense::new(matrix, &load, &vec![&vec![0.0; n][..]; n], &vec![0.0; n]);
        dense.contact = -DMatrix::identity(n, n);
        dense
    }

    pub fn problem(&self) -> Result<ContactProblem, Error> {
        let stiffness = SymmetricMatrix::from_full(&sparse(&self.stiffness)?)?;
        ContactProblem::new(
            stiffness,
            self.load.as_slice().to_vec(),
            sparse(&self.contact)?,
            self.gap.as_slice().to_vec(),
        )
    }

    /// Solves the saddle-point system of every contact set and returns the one for which all signs are right. If
    /// rounding leaves no such set, it returns the one with the smallest violation.
    pub fn enumerate(&self) -> Enumerated {
        let (n, m) = (self.load.len(), self.gap.len());
        assert!(m <= 12, "enumeration of 2^{m} sets");
        let mut best: Option<(f64, Enumerated)> = None;
        for bits in 0_u32..1 << m {
            let closed: Vec<usize> = (0..m).filter(|row| bits >> row & 1 == 1).collect();
            let k = closed.len();
            let mut system = DMatrix::zeros(n + k, n + k);
            let mut right = DVector::zeros(n + k);
            system.view_mut((0, 0), (n, n)).copy_from(&self.stiffness);
            right.rows_mut(0, n).copy_from(&self.load);
            for (i, &row) in closed.iter().enumerate() {
                for j in 0..n {
                    system[(n + i, j)] = self.contact[(row, j)];
                    system[(j, n + i)] = -self.contact[(row, j)];
                }
                right[n + i] = self.gap[row];
            }
            let lu = system.clone().full_piv_lu();
            let Some(answer) = lu.solve(&right) else { continue };
            if (&system * &answer - &right).amax() > 1e-9 * (1.0 + right.amax()) {
                continue;
            }
            let displacement = answer.rows(0, n).into_owned();
            let mut multiplier = DVector::zeros(m);
            closed.iter().enumerate().for_each(|(i, &row)| multiplier[row] = answer[n + i]);
            let penetration = (&self.contact * &displacement - &self.gap).max().max(0.0);
            let wrong = penetration.max(multiplier.max()).max(0.0);
            if best.as_ref().is_none_or(|(least, _)| wrong < *least) {
                best = Some((wrong, Enumerated { displacement, multiplier, closed }));
            }
        }
        best.expect("the empty set gives an equilibrium").1
    }
}

pub fn sparse(dense: &DMatrix<f64>) -> Result<SparseMatrix, LinearError> {
    let mut triplets = Vec::new();
    for column in 0..dense.ncols() {
        for row in 0..dense.nrows() {
            if dense[(row, column)] != 0.0 {
                triplets.push((row, column, dense[(row, column)]));
            }
        }
    }
    SparseMatrix::from_triplets(dense.nrows(), dense.ncols(), &triplets)
}

/// A small generator of numbers in [0, 1) (splitmix64), which draws the same numbers in every run.
pub struct Draws(u64);

impl Draws {
    pub fn new(seed: u64) -> Self {
        Draws(seed)
    }

    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.uniform() - 1.0
    }

    /// An integer in [0, n).
    pub fn below(&mut self, n: usize) -> usize {
        (self.uniform() * n as f64) as usize
    }
}

/// A random problem of `n` dofs and `m` rows: K = A A' + a small diagonal, rows with one or two entries.
pub fn random(draws: &mut Draws, n: usize, m: usize) -> Dense {
    let a = DMatrix::from_fn(n, n, |_, _| draws.signed());
    let stiffness = &a * a.transpose() + DMatrix::identity(n, n) * 0.1;
    let mut contact = DMatrix::zeros(m, n);
    for row in 0..m {
        contact[(row, draws.below(n))] = if draws.uniform() < 0.5 { 1.0 } else { -1.0 };
        if draws.uniform() < 0.5 {
            contact[(row, draws.below(n))] = draws.signed();
        }
    }
    // The gaps are measured from a feasible point, so that the problem is feasible.
    let inside = DVector::from_fn(n, |_, _| draws.signed());
    let gap = &contact * inside + DVector::from_fn(m, |_, _| draws.uniform());
    let stiffness = (&stiffness + stiffness.transpose()) / 2.0;
    Dense { stiffness, load: DVector::from_fn(n, |_, _| 4.0 * draws.signed()), contact, gap }
}

//! Obstacle problems with one unknown per node and a floor below every node: a membrane and a plate.

use signorini::{ContactProblem, Error, SparseMatrix, SymmetricMatrix};

/// Returns the rows `-u <= -lower` for each `(unknown, lower)`, followed by `u <= upper` for each `(unknown, upper)`.
pub fn bounds(dofs: usize, lower: &[(usize, f64)], upper: &[(usize, f64)]) -> Result<(SparseMatrix, Vec<f64>), Error> {
    let below = lower.iter().enumerate().map(|(row, &(dof, _))| (row, dof, -1.0));
    let above = upper.iter().enumerate().map(|(row, &(dof, _))| (lower.len() + row, dof, 1.0));
    let entries: Vec<_> = below.chain(above).collect();
    let contact = SparseMatrix::from_triplets(lower.len() + upper.len(), dofs, &entries)?;
    Ok((contact, lower.iter().map(|&(_, value)| -value).chain(upper.iter().map(|&(_, value)| value)).collect()))
}

pub fn problem(
    dofs: usize,
    entries: &[(usize, usize, f64)],
    load: Vec<f64>,
    (contact, gap): (SparseMatrix, Vec<f64>),
) -> Result<ContactProblem, Error> {
    let lower: Vec<_> = entries.iter().copied().filter(|&(row, column, _)| row >= column).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &lower)?)?;
    Ok(ContactProblem::new(stiffness, load, contact, gap)?)
}

/// The obstacle problem of a membrane under a load of -10 above a staircase: `n` unknowns along a side.
///
/// CONDITIONS: bilinear cells on (-1, 1)^2, zero on the boundary.
/// REFERENCE: step-41 of deal.II.
pub fn membrane(n: usize) -> Result<ContactProblem, Error> {
    let h = 2.0 / (n + 1) as f64;
    let at = |i: usize, j: usize| j * n + i;
    let mut entries = Vec::new();
    let mut lower = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let x = -1.0 + (i + 1) as f64 * h;
            let stair = if x < -0.5 {
                -0.2
            } else if x < 0.0 {
                -0.4
            } else if x < 0.5 {
                -0.6
            } else {
                -0.8
            };
            lower.push((at(i, j), stair));
            for dj in -1_isize..=1 {
                for di in -1_isize..=1 {
                    let (other_i, other_j) = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
                    if other_i < n && other_j < n {
                        let value = if di == 0 && dj == 0 { 8.0 / 3.0 } else { -1.0 / 3.0 };
                        entries.push((at(i, j), at(other_i, other_j), value));
                    }
                }
            }
        }
    }
    problem(n * n, &entries, vec![-10.0 * h * h; n * n], bounds(n * n, &lower, &[])?)
}

/// A clamped plate above a ball: the biharmonic operator by thirteen points, with an obstacle below every node.
pub fn plate(n: usize) -> Result<ContactProblem, Error> {
    let h = 1.0 / (n + 1) as f64;
    let mut entries = Vec::new();
    let near = [(1_isize, 0_isize, -8.0), (0, 1, -8.0), (1, 1, 2.0), (-1, 1, 2.0), (2, 0, 1.0), (0, 2, 1.0)];
    let (mut load, mut lower) = (Vec::new(), Vec::new());
    for j in 0..n {
        for i in 0..n {
            let own = j * n + i;
            let edges = [i == 0, i + 1 == n, j == 0, j + 1 == n].into_iter().filter(|&edge| edge).count();
            entries.push((own, own, 20.0 + edges as f64));
            for (di, dj, value) in near {
                let (other_i, other_j) = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
                if other_i < n && other_j < n {
                    entries.push((other_j * n + other_i, own, value));
                }
            }
            load.push(-100.0 * h.powi(4));
            let away = |i: usize| ((i + 1) as f64 * h - 0.5).powi(2);
            lower.push((own, -0.05 - 0.5 * (away(i) + away(j))));
        }
    }
    problem(n * n, &entries, load, bounds(n * n, &lower, &[])?)
}

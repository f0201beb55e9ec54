//! The prolongator of a level: near-null vectors cut into aggregates, made orthonormal, smoothed.

use super::blocks::BlockMatrix;
use super::chebyshev::Chebyshev;
use crate::linear::grouped::grouped;
use crate::linear::real::Real;
use crate::linear::threads::SharedRows;

/// A near-null vector is no separate mode within an aggregate if less than this share of its length there is left after
/// those before it are removed: two nodes do not turn about the line through them.
const DEPENDENT_IN_AGGREGATE: f64 = 1e-8;

/// Factor on the inverse of the largest eigenvalue in the smoothing of the prolongator.
const STEP: f64 = 4.0 / 3.0;

/// The near-null space on a level: `count` values for each place, place by place.
#[derive(Clone, Debug)]
pub struct Candidates {
    /// Number of vectors.
    pub count: usize,
    /// Their values.
    pub values: Vec<f64>,
}

impl Candidates {
    /// The values at a node with `height` places.
    pub fn of_node(&self, node: usize, height: usize) -> &[f64] {
        &self.values[node * height * self.count..(node + 1) * height * self.count]
    }
}

/// The tentative prolongator and the near-null space in its columns. The columns are the vectors of `fine` within each
/// aggregate, made orthonormal. `size` is the number of places of a node.
///
/// Columns that follow from others stay empty.
pub fn tentative<T: Real>(
    fine: &Candidates,
    size: usize,
    of_node: &[u32],
    aggregates: usize,
) -> (BlockMatrix<T>, Candidates) {
    let count = fine.count;
    let (starts, members) = grouped(aggregates, of_node);
    let mut values = vec![T::default(); of_node.len() * size * count];
    let mut coarse = Candidates { count, values: vec![0.0; aggregates * count * count] };
    let mut local: Vec<f64> = Vec::new();
    for aggregate in 0..aggregates {
        let nodes = &members[starts[aggregate]..starts[aggregate + 1]];
        local.clear();
        for &node in nodes {
            local.extend_from_slice(&fine.values[node * size * count..(node + 1) * size * count]);
        }
        let triangle = &mut coarse.values[aggregate * count * count..(aggregate + 1) * count * count];
        orthonormalise(&mut local, count, triangle);
        for (&node, of_node) in nodes.iter().zip(local.chunks_exact(size * count)) {
            let target = &mut values[node * size * count..(node + 1) * size * count];
            target.iter_mut().zip(of_node).for_each(|(target, &value)| *target = T::of(value));
        }
    }
    let starts = (0..=of_node.len()).collect();
    let indices = of_node.to_vec();
    (BlockMatrix { starts, indices, values, ..BlockMatrix::empty(0, aggregates, (size, count)) }, coarse)
}

/// Q R of the rows of `local`, `count` values each, in place: modified Gram-Schmidt, done twice. `triangle` is R, row
/// by row.
fn orthonormalise(local: &mut [f64], count: usize, triangle: &mut [f64]) {
    for column in 0..count {
        let length = |local: &[f64]| local.iter().skip(column).step_by(count).map(|v| v * v).sum::<f64>().sqrt();
        let whole = length(local);
        for _ in 0..2 {
            for before in 0..column {
                let along: f64 = local.chunks_exact(count).map(|row| row[before] * row[column]).sum();
                local.chunks_exact_mut(count).for_each(|row| row[column] -= along * row[before]);
                triangle[before * count + column] += along;
            }
        }
        let rest = length(local);
        let scale = if rest > DEPENDENT_IN_AGGREGATE * whole { 1.0 / rest } else { 0.0 };
        local.chunks_exact_mut(count).for_each(|row| row[column] *= scale);
        triangle[column * count + column] = if scale == 0.0 { 0.0 } else { rest };
    }
}

/// The tentative prolongator T after the first `steps` of a smoother on patches, which take away the energy at the ends
/// of the aggregates. `moved` is A T of the `matrix` A.
pub fn smoothed_in_steps<T: Real>(
    tentative: BlockMatrix<T>,
    moved: BlockMatrix<T>,
    (matrix, smoother): (&BlockMatrix<T>, &Chebyshev<T>),
    steps: usize,
    threads: usize,
) -> BlockMatrix<T> {
    let (mut prolongator, mut force) = (tentative, moved);
    let mut step = BlockMatrix::empty(force.rows(), force.columns, (force.height, force.width));
    for k in 1..=steps {
        let (keep, gain) = smoother.weights(k);
        step.values.iter_mut().for_each(|value| *value = T::of(keep) * *value);
        step = step.plus(-gain, &smoother.inverse.product(&force, threads));
        prolongator = prolongator.plus(1.0, &step);
        if k < steps {
            force = force.plus(1.0, &matrix.product(&step, threads));
        }
    }
    prolongator
}

/// `T - step D^-1 (A T)` from T and `moved` = A T, with a pattern that contains that of T; `smoother` is that of A.
pub fn smoothed<T: Real>(
    tentative: &BlockMatrix<T>,
    mut moved: BlockMatrix<T>,
    smoother: &Chebyshev<T>,
    threads: usize,
) -> BlockMatrix<T> {
    let (height, width) = (moved.height, moved.width);
    let (inverse, step) = (&smoother.inverse, T::of(STEP / smoother.largest));
    let BlockMatrix { starts, indices, values, .. } = &mut moved;
    let size = height * width;
    SharedRows { starts, threads }.with_blocks(size, values, |rows, values| {
        let mut column = vec![T::default(); height];
        let first = starts[rows.start];
        for node in rows {
            let Some((_, of_node)) = inverse.row(node).next() else { continue };
            let own = tentative.indices[node];
            for place in starts[node]..starts[node + 1] {
                let is_own = indices[place] == own;
                let block = &mut values[(place - first) * size..(place - first + 1) * size];
                for j in 0..width {
                    column.iter_mut().enumerate().for_each(|(i, entry)| *entry = block[i * width + j]);
                    for i in 0..height {
                        let mut sum = T::default();
                        for (k, &entry) in column.iter().enumerate() {
                            sum += of_node[i * height + k] * entry;
                        }
                        let before = if is_own { tentative.block(node)[i * width + j] } else { T::default() };
                        block[i * width + j] = before - step * sum;
                    }
                }
            }
        }
    });
    moved
}

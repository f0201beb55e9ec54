//! The prolongator of a level: near-null vectors cut into aggregates, made orthonormal, smoothed.

use std::collections::HashMap;
use std::ops::Range;

use super::blocks::BlockMatrix;
use super::chebyshev::Chebyshev;
use crate::columns::grouped;
use crate::real::Real;
use crate::threads::SharedRows;

/// A near-null vector is no separate mode within an aggregate if less than this share of its length there is left after
/// those before it are removed: two nodes do not turn about the line through them.
const DEPENDENT_IN_AGGREGATE: f64 = 1e-8;

/// Columns span a near-null vector if they leave this share of its largest entry: rounding, and far less than single
/// precision resolves.
const SPANNED: f64 = 1e-12;

/// Factor on the inverse of the largest eigenvalue in the smoothing of the prolongator.
const STEP: f64 = 4.0 / 3.0;

/// The near-null space on a level: `count` values for each place, place by place.
#[derive(Clone, Debug)]
pub struct Candidates {
    pub count: usize,
    pub values: Vec<f64>,
}

impl Candidates {
    /// The values at a node with `height` places.
    pub fn of_node(&self, node: usize, height: usize) -> &[f64] {
        &self.values[node * height * self.count..(node + 1) * height * self.count]
    }
}

/// The tentative prolongator and the near-null space in its columns. The columns are the vectors of `fine` within each
/// aggregate, made orthonormal.
///
/// Columns that follow from others stay empty. If rows of `matrix` are shared, aggregates of one shape have the same
/// columns where these span their vectors: they are then stored once.
pub fn tentative<T: Real>(
    matrix: &BlockMatrix<T>,
    fine: &Candidates,
    of_node: &[u32],
    aggregates: usize,
) -> (BlockMatrix<T>, Candidates) {
    let (size, count) = (matrix.height, fine.count);
    let (starts, members) = grouped(aggregates, of_node);
    let mut flat = BlockMatrix::empty(0, aggregates, (size, count));
    flat.shared_rows = vec![0; of_node.len()];
    let mut coarse = Candidates { count, values: vec![0.0; aggregates * count * count] };
    // The last aggregate of each shape: its first row, and its columns.
    let mut known: HashMap<Vec<u32>, (usize, Vec<f64>)> = HashMap::new();
    let mut local: Vec<f64> = Vec::new();
    for aggregate in 0..aggregates {
        let nodes = &members[starts[aggregate]..starts[aggregate + 1]];
        local.clear();
        nodes.iter().for_each(|&node| local.extend_from_slice(fine.of_node(node, size)));
        let shape = nodes.iter().map(|node| (node - nodes[0]) as u32).collect();
        let triangle = &mut coarse.values[aggregate * count * count..(aggregate + 1) * count * count];
        let first = match known.get(&shape).filter(|known| is_spanned(&local, &known.1, count, triangle)) {
            Some(known) => known.0,
            None => {
                let first = flat.indices.len();
                triangle.fill(0.0);
                orthonormalise(&mut local, count, triangle);
                flat.indices.resize(first + nodes.len(), 0);
                flat.values.extend(local.iter().map(|&value| T::of(value)));
                if matrix.is_shared() {
                    known.insert(shape, (first, local.clone()));
                }
                first
            }
        };
        nodes.iter().zip(first..).for_each(|(&node, place)| flat.shared_rows[node] = place as u32);
    }
    flat.starts = (0..=of_node.len()).collect();
    flat.shifts = of_node.to_vec();
    let is_few = 2 * flat.indices.len() <= of_node.len();
    (if is_few { flat } else { flat.unshared() }, coarse)
}

/// Writes `R = Q'B` into the upper `triangle`, for the orthonormal columns Q and the vectors B of an aggregate, `count`
/// values in each row. Returns `false` if Q R is not B.
fn is_spanned(vectors: &[f64], columns: &[f64], count: usize, triangle: &mut [f64]) -> bool {
    let rows = || vectors.chunks_exact(count).zip(columns.chunks_exact(count));
    triangle.fill(0.0);
    let mut sizes = vec![0.0_f64; count];
    for (vector, column) in rows() {
        for (i, &q) in column.iter().enumerate() {
            triangle[i * count + i..(i + 1) * count].iter_mut().zip(&vector[i..]).for_each(|(sum, &b)| *sum += q * b);
        }
        sizes.iter_mut().zip(vector).for_each(|(size, b)| *size = size.max(b.abs()));
    }
    rows().all(|(vector, column)| {
        (0..count).all(|j| {
            let product: f64 = (0..=j).map(|i| column[i] * triangle[i * count + j]).sum();
            (vector[j] - product).abs() <= SPANNED * sizes[j]
        })
    })
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
    let mut values = std::mem::take(&mut moved.values);
    let (mut nodes, mut starts, mut end) = (Vec::new(), vec![0], 0);
    for node in 0..moved.rows() {
        let (places, _) = moved.places(node);
        // Rows are stored in the order in which they come first.
        if places.start == end {
            end = places.end;
            nodes.push(node);
            starts.push(end);
        }
    }
    let length = |rows: &Range<usize>| (starts[rows.end] - starts[rows.start]) * height * width;
    SharedRows { starts: &starts, threads }.with_parts([&mut values[..]], length, |rows, [mut values]| {
        let mut column = vec![T::default(); height];
        for row in rows {
            let of_row = values.split_off_mut(..length(&(row..row + 1))).unwrap_or_default();
            let node = nodes[row];
            let Some((_, of_node)) = inverse.row(node).next() else { continue };
            let Some((own, before)) = tentative.row(node).next() else { continue };
            for (of_block, block) in moved.columns_of(node).zip(of_row.chunks_exact_mut(height * width)) {
                for j in 0..width {
                    column.iter_mut().enumerate().for_each(|(i, entry)| *entry = block[i * width + j]);
                    for i in 0..height {
                        let mut sum = T::default();
                        for (k, &entry) in column.iter().enumerate() {
                            sum += of_node[i * height + k] * entry;
                        }
                        let before = if of_block as usize == own { before[i * width + j] } else { T::default() };
                        block[i * width + j] = before - step * sum;
                    }
                }
            }
        }
    });
    moved.values = values;
    moved
}

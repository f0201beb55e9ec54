//! Nodes gathered into aggregates along strong connections; aggregates and prolongators along the lines of stretched
//! cells.
//!
//! Bilinear elements connect nodes across such lines too, up to half as strongly as along them, although the smoother
//! does not damp errors that vary across the lines. Aggregates across lines do not help it; and a prolongator that is
//! smoothed across lines makes the next matrices dense. Here both stay on the line: the move of a weak neighbour is
//! taken as the mode of the node's own aggregate, continued to that neighbour, so that the near-null vectors stay
//! exact.

use super::blocks::BlockMatrix;
use super::prolongator::Candidates;
use crate::real::Real;

/// No aggregate yet.
const NONE: u32 = u32::MAX;

/// The strong connections of each node, without the node itself.
pub struct Graph {
    starts: Vec<usize>,
    neighbours: Vec<u32>,
    strengths: Vec<f32>,
}

impl Graph {
    pub fn neighbours(&self, node: usize) -> &[u32] {
        &self.neighbours[self.starts[node]..self.starts[node + 1]]
    }
}

/// The aggregate of each node, and their number.
///
/// Two nodes are strongly connected if `|A_ij|^2 > threshold^2 |A_ii| |A_jj|` in the Frobenius norm. A node and its
/// strong neighbours become an aggregate if none of these nodes is in one yet; each remaining node joins the aggregate
/// to which it is connected most strongly.
///
/// # Source
/// P. Vaněk, J. Mandel, M. Brezina, *Algebraic multigrid by smoothed aggregation for second and fourth order elliptic
/// problems*, Computing 56 (1996) 179-196, algorithm 5.1.
pub fn aggregate(graph: &Graph) -> (Vec<u32>, usize) {
    let nodes = graph.starts.len() - 1;
    let mut of_node = vec![NONE; nodes];
    let mut count = 0_u32;
    for node in 0..nodes {
        let around = graph.neighbours(node);
        if of_node[node] == NONE && around.iter().all(|&other| of_node[other as usize] == NONE) {
            of_node[node] = count;
            around.iter().for_each(|&other| of_node[other as usize] = count);
            count += 1;
        }
    }
    let roots = of_node.clone();
    for (node, aggregate) in of_node.iter_mut().enumerate().filter(|entry| *entry.1 == NONE) {
        let range = graph.starts[node]..graph.starts[node + 1];
        let joined = range.filter(|&place| roots[graph.neighbours[place] as usize] != NONE);
        let strongest = joined.max_by(|&a, &b| graph.strengths[a].total_cmp(&graph.strengths[b]));
        if let Some(place) = strongest {
            *aggregate = roots[graph.neighbours[place] as usize];
        }
    }
    for node in 0..nodes {
        if of_node[node] == NONE {
            let around = graph.neighbours(node).iter().map(|&other| other as usize).chain([node]);
            // A node in an aggregate has a lower number, and keeps it.
            around.for_each(|other| of_node[other] = of_node[other].min(count));
            count += 1;
        }
    }
    (of_node, count as usize)
}

pub fn strong_connections<T: Real>(matrix: &BlockMatrix<T>, threshold: f64) -> Graph {
    let square = |place: usize| matrix.block(place).iter().map(|value| value.double() * value.double()).sum::<f64>();
    // Shared rows have few blocks.
    let squares: Vec<f64> = (0..matrix.indices.len()).take_while(|_| matrix.is_shared()).map(square).collect();
    let square = |place: usize| squares.get(place).copied().unwrap_or_else(|| square(place));
    let diagonal: Vec<f64> =
        (0..matrix.rows()).map(|node| matrix.diagonal_place(node).map_or(0.0, |place| square(place).sqrt())).collect();
    let mut graph = Graph { starts: vec![0], neighbours: Vec::new(), strengths: Vec::new() };
    for node in 0..matrix.rows() {
        for (other, place) in matrix.columns_of(node).zip(matrix.places(node).0) {
            let (strength, own) = (square(place), diagonal[node] * diagonal[other as usize]);
            if other as usize != node && strength > threshold * threshold * own {
                graph.neighbours.push(other);
                graph.strengths.push((strength / own) as f32);
            }
        }
        graph.starts.push(graph.neighbours.len());
    }
    graph
}

/// Strength of the connections along a line, on every level.
const ALONG_LINES: f64 = 0.4;

/// Nodes lie on lines if the number of aggregates is at most this share of the nodes: three nodes of a line make one
/// third.
const LINES: f64 = 0.36;

/// The connections along the lines of a matrix.
pub struct Lines {
    graph: Graph,
    pub of_node: Vec<u32>,
    pub aggregates: usize,
}

impl Lines {
    /// `None` if nodes do not lie on lines, or are close to all others.
    pub fn of<T: Real>(matrix: &BlockMatrix<T>) -> Option<Self> {
        let graph = strong_connections(matrix, ALONG_LINES);
        let (of_node, aggregates) = aggregate(&graph);
        let has_lines = aggregates as f64 <= LINES * matrix.rows() as f64;
        has_lines.then_some(Lines { graph, of_node, aggregates })
    }

    /// `A T` of the tentative prolongator T of these aggregates, without the couplings across lines: its columns stay
    /// those of the aggregates of strong neighbours. `fine` and `coarse` are the near-null vectors of the level and of
    /// the next one.
    pub fn product<T: Real>(
        &self,
        matrix: &BlockMatrix<T>,
        tentative: &BlockMatrix<T>,
        fine: &Candidates,
        coarse: &Candidates,
    ) -> BlockMatrix<T> {
        let (height, width) = (tentative.height, tentative.width);
        let size = height * width;
        let mut product = BlockMatrix::empty(0, tentative.columns, (height, width));
        let (mut columns, mut sums, mut moved) = (Vec::new(), Vec::new(), Vec::new());
        for node in 0..matrix.rows() {
            columns.clear();
            sums.clear();
            let own = self.of_node[node];
            for (other, block) in matrix.row(node) {
                let is_strong = other == node || self.graph.neighbours(node).contains(&(other as u32));
                moved.clear();
                let is_continued = !is_strong && continued(fine.of_node(other, height), coarse, own, &mut moved);
                let column = if is_continued { own } else { self.of_node[other] };
                if !is_continued {
                    moved.clear();
                    moved.extend(tentative.block(tentative.places(other).0.start).iter().map(|&value| value.double()));
                }
                let place = columns.iter().position(|&known| known == column).unwrap_or_else(|| {
                    columns.push(column);
                    sums.resize(columns.len() * size, 0.0);
                    columns.len() - 1
                });
                let of_column = &mut sums[place * size..(place + 1) * size];
                for (line, sums) in block.chunks_exact(height).zip(of_column.chunks_exact_mut(width)) {
                    for (value, of_other) in line.iter().zip(moved.chunks_exact(width)) {
                        sums.iter_mut().zip(of_other).for_each(|(sum, moved)| *sum += value.double() * moved);
                    }
                }
            }
            let mut order: Vec<usize> = (0..columns.len()).collect();
            order.sort_by_key(|&place| columns[place]);
            for place in order {
                product.indices.push(columns[place]);
                product.values.extend(sums[place * size..(place + 1) * size].iter().map(|&value| T::of(value)));
            }
            product.starts.push(product.indices.len());
        }
        product
    }
}

/// The modes of an aggregate, continued to a node outside: X with `X R = B`; B are the near-null vectors at the node,
/// `of_node`, R those in the columns of the aggregate. Returns `false` if the aggregate lacks one of these vectors.
fn continued(of_node: &[f64], coarse: &Candidates, aggregate: u32, moved: &mut Vec<f64>) -> bool {
    let count = coarse.count;
    let triangle = &coarse.values[aggregate as usize * count * count..][..count * count];
    moved.extend_from_slice(of_node);
    if (0..count).any(|column| triangle[column * count + column] == 0.0) {
        return false;
    }
    for line in moved.chunks_exact_mut(count) {
        for column in 0..count {
            let before: f64 = (0..column).map(|b| line[b] * triangle[b * count + column]).sum();
            line[column] = (line[column] - before) / triangle[column * count + column];
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::prolongator::tentative;
    use super::*;

    /// The stiffness of bilinear elements for a membrane of `nx` x `ny` nodes, cells `stretch` times as high as wide,
    /// without supports.
    fn membrane(nx: usize, ny: usize, stretch: f64) -> BlockMatrix<f64> {
        let mut entries = vec![vec![0.0; nx * ny]; nx * ny];
        for (i, j) in (0..nx - 1).flat_map(|i| (0..ny - 1).map(move |j| (i, j))) {
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
            for (&a, &b) in corners.iter().flat_map(|a| corners.iter().map(move |b| (a, b))) {
                let mass = |same: bool| if same { 1.0 / 3.0 } else { 1.0 / 6.0 };
                let bend = |same: bool| if same { 1.0 } else { -1.0 };
                let value =
                    stretch * bend(a.0 == b.0) * mass(a.1 == b.1) + mass(a.0 == b.0) * bend(a.1 == b.1) / stretch;
                entries[(j + a.1) * nx + i + a.0][(j + b.1) * nx + i + b.0] += value;
            }
        }
        let row = |row: &Vec<f64>| -> Vec<(usize, [f64; 1])> {
            row.iter().enumerate().filter(|entry| *entry.1 != 0.0).map(|(column, &value)| (column, [value])).collect()
        };
        BlockMatrix::of_rows(nx * ny, (1, 1), entries.iter().map(row))
    }

    /// GOAL: aggregates of stretched cells stay on their lines, their prolongator too, and `A T` keeps A of the
    /// near-null vectors.
    #[test]
    fn aggregates_and_prolongators_stay_on_the_lines_of_stretched_cells() {
        let (nx, ny) = (31, 7);
        assert!(Lines::of(&membrane(nx, ny, 1.0)).is_none());
        let matrix = membrane(nx, ny, 20.0);
        let lines = Lines::of(&matrix).unwrap();
        let line_of = |node: usize| node / nx;
        // Constants, and vectors that grow along the lines.
        let fine = Candidates { count: 2, values: (0..nx * ny).flat_map(|node| [1.0, (node % nx) as f64]).collect() };
        let (flat, coarse) = tentative(&matrix, &fine, &lines.of_node, lines.aggregates);
        let product = lines.product(&matrix, &flat, &fine, &coarse);
        let line_of_aggregate: Vec<usize> = (0..lines.aggregates)
            .map(|aggregate| line_of(lines.of_node.iter().position(|&of| of as usize == aggregate).unwrap()))
            .collect();
        for node in 0..nx * ny {
            assert!(product.row(node).all(|(aggregate, _)| line_of_aggregate[aggregate] == line_of(node)));
            for vector in 0..2 {
                let of_column = |(aggregate, values): (usize, &[f64])| {
                    (0..2).map(|c| values[c] * coarse.values[(aggregate * 2 + c) * 2 + vector]).sum::<f64>()
                };
                let found: f64 = product.row(node).map(of_column).sum();
                let term = |(other, value): (usize, &[f64])| value[0] * fine.values[other * 2 + vector];
                let exact: f64 = matrix.row(node).map(term).sum();
                let terms: f64 = matrix.row(node).map(|entry| term(entry).abs()).sum();
                assert!((found - exact).abs() <= 1e-12 * terms, "{node}, {vector}: {found:e} for {exact:e}");
            }
        }
    }
}

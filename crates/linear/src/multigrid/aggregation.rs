//! Nodes gathered into aggregates along strong connections.

use super::blocks::BlockMatrix;
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
            of_node[node] = count;
            for &other in graph.neighbours(node) {
                if of_node[other as usize] == NONE {
                    of_node[other as usize] = count;
                }
            }
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

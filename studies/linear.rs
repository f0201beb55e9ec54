//! The reference of all ratios: one linear solve K u = f with the routines of faer, from the stiffness to the
//! displacement.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{self, SymmetricOrdering};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use feral_metis::{CscPattern, metis_order};
use signorini::SymmetricMatrix;

/// The ordering of the unknowns.
#[derive(Clone, Copy, PartialEq)]
pub enum Ordering {
    /// faer's default: approximate minimum degree on the dofs.
    Amd,
    /// Nested dissection of the graph of nodes; the value is the number of dofs per node.
    NestedDissection(usize),
}

/// Orders, analyses, factorises and solves. Returns the displacement and the number of values in the factor.
pub fn solve(stiffness: &SymmetricMatrix, load: &[f64], ordering: Ordering) -> Option<(Vec<f64>, usize)> {
    let lower = stiffness.lower();
    let dim = stiffness.dim();
    let rows: Vec<usize> = lower.row_indices().map(|row| row as usize).collect();
    let structure = SymbolicSparseColMatRef::new_checked(dim, dim, lower.column_starts(), None, &rows);
    let (forward, inverse);
    let faer_ordering = match ordering {
        Ordering::Amd => SymmetricOrdering::Amd,
        Ordering::NestedDissection(per_node) => {
            forward = dissected(stiffness, per_node)?;
            let mut place = vec![0; dim];
            forward.iter().enumerate().for_each(|(position, &dof)| place[dof] = position);
            inverse = place;
            SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, dim))
        }
    };
    let symbolic =
        cholesky::factorize_symbolic_cholesky(structure, Side::Lower, faer_ordering, Default::default()).ok()?;
    let mut values = vec![0.0; symbolic.len_val()];
    let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
    let mut buffer = MemBuffer::new(request);
    let factor = symbolic
        .factorize_numeric_llt(
            &mut values,
            SparseColMatRef::new(structure, lower.values()),
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut buffer),
            Default::default(),
        )
        .ok()?;
    let mut displacement = load.to_vec();
    let mut buffer = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
    let column = MatMut::from_column_major_slice_mut(&mut displacement, dim, 1);
    factor.solve_in_place_with_conj(Conj::No, column, Par::Seq, MemStack::new(&mut buffer));
    Some((displacement, symbolic.len_val()))
}

/// Returns the dofs in the order of the nested dissection of their nodes. All nodes have `per_node` consecutive dofs.
fn dissected(stiffness: &SymmetricMatrix, per_node: usize) -> Option<Vec<usize>> {
    let nodes = stiffness.dim() / per_node;
    let mut neighbours = vec![Vec::new(); nodes];
    for node in 0..nodes {
        for (row, _) in stiffness.lower().column(per_node * node) {
            let other = row / per_node;
            if row % per_node == 0 && other != node {
                neighbours[node].push(other as i32);
                neighbours[other].push(node as i32);
            }
        }
    }
    let mut starts = vec![0];
    let mut indices = Vec::new();
    for mut of_node in neighbours {
        of_node.sort_unstable();
        indices.append(&mut of_node);
        starts.push(indices.len() as i32);
    }
    let order = metis_order(&CscPattern::new(nodes, &starts, &indices)?).ok()?;
    Some(order.into_iter().flat_map(|node| (0..per_node).map(move |axis| per_node * node as usize + axis)).collect())
}

//! The memory of meshes, models, motions and kept answers; that of a solve is in [`Estimate`](signorini_qp::Estimate).
//!
//! Every number is measured at the peak of the program (`tests/program/limits.rs`, `memory.rs`).

/// Bytes of a node: coordinates, displacements, loads, stresses, and the index of nodes.
const OF_NODE: f64 = 120.0;

/// Bytes of a node of an element: the mesh, and its copies by node.
const OF_CONNECTION: f64 = 16.0;

/// Bytes of an unknown, and of an entry of the stiffness, both triangles, of a model that is assembled and not solved.
const OF_MODEL: [f64; 2] = [110.0, 11.0];

/// Bytes of a mesh of `nodes` nodes; its elements have `connections` nodes together.
pub fn of_mesh(nodes: f64, connections: f64) -> f64 {
    OF_NODE * nodes + OF_CONNECTION * connections
}

/// Bytes of the problem of a model that is not solved.
pub fn of_model(dofs: f64, entries: f64) -> f64 {
    OF_MODEL[0] * dofs + OF_MODEL[1] * entries
}

/// Bytes of an unknown in an answer that is kept: displacements, multipliers, forces, and what a report and a page add.
const OF_ANSWER: f64 = 100.0;

/// Bytes of `count` answers that are kept, with `dofs` unknowns each.
pub fn of_answers(count: f64, dofs: f64) -> f64 {
    OF_ANSWER * count * dofs
}

/// Bytes of an entry of the stiffness, both triangles, that the search for modes takes beside a solve: the mass, both
/// matrices scaled, their sum and its analysis.
const OF_PENCIL: f64 = 60.0;

/// Columns of the space of the search for each wanted mode, and at least: each is a vector of doubles.
const OF_SPACE: [f64; 2] = [4.0, 48.0];

/// Bytes that the search for `count` modes takes beside the solve of the equilibrium: a factor of its own, and the
/// space.
pub fn of_modes(count: f64, dofs: f64, entries: f64, factor: f64) -> f64 {
    OF_PENCIL * entries + 8.0 * factor + 8.0 * dofs * (OF_SPACE[0] * count + OF_SPACE[1])
}

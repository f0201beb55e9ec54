//! The memory of a solve: one model for a scene that is not built yet and for a problem that is built.
//!
//! Every number is measured at the peak of the program (`tests/program/limits.rs`, `memory.rs`), and should exceed it by less than a
//! factor of two.

/// Bytes of a program that does nothing yet.
pub const START: f64 = if cfg!(debug_assertions) { 20e6 } else { 11e6 };

/// Bytes of a node: coordinates, displacements, loads, stresses, and the index of nodes.
const OF_NODE: f64 = 120.0;

/// Bytes of a node of an element: the mesh, and its copies by node.
const OF_CONNECTION: f64 = 16.0;

/// Bytes of an unknown: loads, displacements, residuals, and the pictures and files of the answer.
const OF_DOF: f64 = 350.0;

/// Bytes of an entry of the stiffness, both triangles: in its file or mesh, in the stiffness itself, scaled, ordered, and in the graph
/// of the ordering.
const OF_ENTRY: f64 = 32.0;

/// Bytes of an unknown, and of an entry of the stiffness, both triangles, of a model that is assembled and not solved.
const OF_MODEL: [f64; 2] = [110.0, 11.0];

/// Bytes of an unknown, and of an entry of the stiffness, with a hierarchy instead of a factor.
const OF_HIERARCHY: [f64; 2] = [190.0, 33.0];

/// Workspace of a factorisation, beside its factor.
const WORKSPACE: f64 = 1.15;

/// Bytes of a value of a dense matrix on the contact dofs; a method keeps several such matrices.
const OF_DENSE: f64 = 64.0;

/// Bytes of an entry of the stiffness K in the matrices K + w B'B of the contact sets, without their factors: their pattern, if it
/// differs from that of the stiffness, their values, and the structure of their factors.
pub const OF_SETS: f64 = 20.0;

/// Bytes of an entry of the stiffness K in the matrix K + w B'B of one contact set at a time, without its factor: its values, and
/// memory that earlier attempts have not released.
pub const OF_SET: f64 = 10.0;

/// Bytes of a value of a dense triangle on the contact dofs that come last.
const OF_BOUNDARY: f64 = 24.0;

/// Bytes of a value of the factor of the interior point, with its index and workspace; its ordering has more fill-in than ours.
pub const OF_INTERIOR_POINT: f64 = 16.0;

/// Bytes of a mesh of `nodes` nodes; its elements have `connections` nodes together.
pub fn of_mesh(nodes: f64, connections: f64) -> f64 {
    OF_NODE * nodes + OF_CONNECTION * connections
}

/// Bytes of an unknown in an answer that is kept: displacements, multipliers, forces, and what a report and a page add.
const OF_ANSWER: f64 = 100.0;

/// Bytes of an unknown in the picture of an answer, beside the answer: its nodal stresses and its displaced cells.
#[cfg(feature = "cli")]
const OF_PICTURE: f64 = 150.0;

/// Bytes of `count` pictures with common colours, which are drawn together, of answers with `dofs` unknowns each.
#[cfg(feature = "cli")]
pub fn of_pictures(count: f64, dofs: f64) -> f64 {
    OF_PICTURE * count * dofs
}

/// Bytes of `count` answers that are kept, with `dofs` unknowns each.
pub fn of_answers(count: f64, dofs: f64) -> f64 {
    OF_ANSWER * count * dofs
}

/// Bytes of an unknown, and of an entry of the stiffness, both triangles, that a motion takes beside the solve of a step: its mass, the
/// matrix of a step, its states and their frames.
const OF_MOTION: [f64; 2] = [400.0, 40.0];

/// Bytes that a motion takes beside the solve of a step.
pub fn of_motion(dofs: f64, entries: f64) -> f64 {
    OF_MOTION[0] * dofs + OF_MOTION[1] * entries
}

/// Bytes of a problem with `dofs` unknowns and `entries` of its stiffness, both triangles, before the factorisation.
pub fn of_problem(dofs: f64, entries: f64) -> f64 {
    OF_DOF * dofs + OF_ENTRY * entries
}

/// Bytes of the problem of a model that is not solved.
pub fn of_model(dofs: f64, entries: f64) -> f64 {
    OF_MODEL[0] * dofs + OF_MODEL[1] * entries
}

/// Bytes of a problem with a multigrid hierarchy.
pub fn of_hierarchy(dofs: f64, entries: f64) -> f64 {
    OF_HIERARCHY[0] * dofs + OF_HIERARCHY[1] * entries
}

/// Bytes of a Cholesky factor with this number of `values` of `size` bytes each, and of its workspace.
pub fn of_factor(values: f64, size: usize) -> f64 {
    WORKSPACE * size as f64 * values
}

/// Bytes of the dense matrices on this number of contact dofs.
pub fn of_dense(contact_dofs: f64) -> f64 {
    OF_DENSE * contact_dofs * contact_dofs
}

/// Factors, beside those of the method, of a singular stiffness with springs: that of the bound, that which shows it semidefinite, and
/// what their fill-in has more.
const WITH_SPRINGS: f64 = 3.0;

/// Bytes of the factors of a singular stiffness with springs, and of its copies.
pub fn of_springs(values: f64, entries: f64) -> f64 {
    WITH_SPRINGS * of_factor(values, size_of::<f64>()) + 2.0 * OF_ENTRY * entries
}

/// Bytes of the dense triangle on this number of contact dofs that come last in a factor of all dofs.
pub fn of_boundary(contact_dofs: f64) -> f64 {
    OF_BOUNDARY * contact_dofs * contact_dofs
}

//! The memory of a solve: one model for a problem that is not assembled yet and for one that is.
//!
//! Every number is measured at the peak of the program (`tests/program/limits.rs`, `memory.rs`), and should exceed it
//! by less than a factor of two.

/// Bytes of the program before it reads a problem, measured.
pub(crate) const START: f64 = if cfg!(debug_assertions) { 21.7e6 } else { 11e6 };

/// Bytes of an unknown: loads, displacements, residuals, and the pictures and files of the answer.
const OF_DOF: f64 = 350.0;

/// Bytes of an entry of the stiffness, both triangles: in its file or mesh, in the stiffness itself, scaled, ordered,
/// and in the graph of the ordering.
const OF_ENTRY: f64 = 32.0;

/// Bytes of an unknown, and of an entry of the stiffness, with a hierarchy instead of a factor.
const OF_HIERARCHY: [f64; 2] = [270.0, 16.0];

/// Workspace of a factorisation, beside its factor.
const WORKSPACE: f64 = 1.15;

/// Most bytes of a released block that the allocator keeps for smaller requests (in glibc, the largest threshold of its
/// own mappings).
const MOST_KEPT: f64 = (32_u32 << 20) as f64;

/// Bytes of a value of a dense matrix on the contact dofs; a method keeps several such matrices.
const OF_DENSE: f64 = 64.0;

/// Bytes of an entry of the stiffness K in the matrices K + w B'B of the contact sets, without their factors: their
/// pattern, if it differs from that of the stiffness, their values, and the structure of their factors.
pub(crate) const OF_SETS: f64 = 20.0;

/// Bytes of an entry of the stiffness K in the matrix K + w B'B of one contact set at a time, without its factor: its
/// values, and memory that earlier attempts have not released.
pub(crate) const OF_SET: f64 = 10.0;

/// Bytes of a value of a dense triangle on the contact dofs that come last.
const OF_BOUNDARY: f64 = 24.0;

/// Bytes of a value of the factor of the interior point, with its index and workspace; its ordering has more fill-in
/// than ours.
pub(crate) const OF_INTERIOR_POINT: f64 = 16.0;

/// Bytes of a problem with `dofs` unknowns and `entries` of its stiffness, both triangles, before the factorisation.
pub(crate) fn of_problem(dofs: f64, entries: f64) -> f64 {
    OF_DOF * dofs + OF_ENTRY * entries
}

/// Bytes of a problem with a multigrid hierarchy.
pub(crate) fn of_hierarchy(dofs: f64, entries: f64) -> f64 {
    OF_HIERARCHY[0] * dofs + OF_HIERARCHY[1] * entries
}

/// Bytes of a Cholesky factor with this number of `values`, and of its workspace.
pub(crate) fn of_factor(values: f64) -> f64 {
    WORKSPACE * size_of::<f64>() as f64 * values
}

/// Bytes of the same if a factor before it was released, whose memory may not serve it.
pub(crate) fn of_next_factor(values: f64) -> f64 {
    let size = size_of::<f64>();
    of_factor(values) + (size as f64 * values).min(MOST_KEPT)
}

/// Bytes of the dense matrices on this number of contact dofs.
pub(crate) fn of_dense(contact_dofs: f64) -> f64 {
    OF_DENSE * contact_dofs * contact_dofs
}

/// Factors, beside those of the method, of a singular stiffness with springs: that of the bound, that which shows it
/// semidefinite, and what their fill-in has more.
const WITH_SPRINGS: f64 = 3.0;

/// Bytes of the factors of a singular stiffness with springs, and of its copies.
pub(crate) fn of_springs(values: f64, entries: f64) -> f64 {
    WITH_SPRINGS * of_factor(values) + 2.0 * OF_ENTRY * entries
}

/// Bytes of the dense triangle on this number of contact dofs that come last in a factor of all dofs.
pub(crate) fn of_boundary(contact_dofs: f64) -> f64 {
    OF_BOUNDARY * contact_dofs * contact_dofs
}

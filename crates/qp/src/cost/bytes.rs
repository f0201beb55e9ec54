//! The memory of a solve: one model for a problem that is not assembled yet and for one that is.
//!
//! Every number is measured at the peak of the program (`tests/program/limits.rs`, `memory.rs`), and should exceed it
//! by less than a factor of two.

/// Bytes of the program before it reads a problem, measured.
pub const START: f64 = if cfg!(debug_assertions) { 21.7e6 } else { 11e6 };

/// Bytes of an entry of the stiffness, both triangles: in its file or mesh, in the stiffness itself, scaled, ordered,
/// and in the graph of the ordering.
const OF_ENTRY: f64 = 32.0;

/// Most bytes of a released block that the allocator keeps for smaller requests: in glibc, the largest threshold.
const MOST_KEPT: f64 = (32_u32 << 20) as f64;

/// Bytes of an entry of the stiffness K in the matrices K + w B'B of the contact sets, without their factors: their
/// pattern, if it differs from that of the stiffness, their values, and the structure of their factors.
pub const OF_SETS: f64 = 20.0;

/// The same for one contact set at a time: its values, and memory that earlier attempts have not released.
pub const OF_SET: f64 = 10.0;

/// Bytes of a value of the factor of the interior point, with index and workspace; its ordering has more fill-in.
pub const OF_INTERIOR_POINT: f64 = 16.0;

/// Bytes of a problem with `dofs` unknowns and `entries` of its stiffness, both triangles, before the factorisation.
/// An unknown has loads, displacements, residuals, and the pictures and files of the answer.
pub fn of_problem(dofs: f64, entries: f64) -> f64 {
    350.0 * dofs + OF_ENTRY * entries
}

/// The same with a multigrid hierarchy.
pub fn of_hierarchy(dofs: f64, entries: f64) -> f64 {
    270.0 * dofs + 16.0 * entries
}

/// Bytes of a Cholesky factor with this number of `values`, and of the workspace of the factorisation.
pub fn of_factor(values: f64) -> f64 {
    1.15 * size_of::<f64>() as f64 * values
}

/// Bytes of the same if a factor before it was released, whose memory may not serve it.
pub fn of_next_factor(values: f64) -> f64 {
    of_factor(values) + (size_of::<f64>() as f64 * values).min(MOST_KEPT)
}

/// Bytes of the dense matrices on this number of contact dofs, of which a method keeps several.
pub fn of_dense(contact_dofs: f64) -> f64 {
    64.0 * contact_dofs * contact_dofs
}

/// Bytes of the factors of a singular stiffness with springs, and of its copies: that of the bound, that which shows it
/// semidefinite, and what their fill-in has more.
pub fn of_springs(values: f64, entries: f64) -> f64 {
    3.0 * of_factor(values) + 2.0 * OF_ENTRY * entries
}

/// Bytes of the dense triangle on this number of contact dofs that come last in a factor of all dofs.
pub fn of_boundary(contact_dofs: f64) -> f64 {
    24.0 * contact_dofs * contact_dofs
}

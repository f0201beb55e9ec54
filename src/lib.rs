//! Frictionless unilateral contact of linear elastic bodies (the Signorini problem) as a convex QP, cross-checked and
//! certified.
//!
//! ```text
//! minimise 1/2 u'K u - f'u   subject to   B u - g <= 0
//! K u - f - B' lambda = 0,  B u - g <= 0,  lambda <= 0,  lambda_i (B u - g)_i = 0
//! ```
//!
//! | symbol | meaning | Rust name | Clarabel / qpsolvers | unit | sign |
//! |---|---|---|---|---|---|
//! | u | displacement of the free dofs | `displacement` | x | m | along the axes |
//! | K | stiffness after supports, symmetric, positive semidefinite | `stiffness` | P | N/m | |
//! | f | external load | `load` | -q | N | along the axes |
//! | B | contact rows: the normal trace, one row per candidate node | `contact` | A / G | 1 | + towards the obstacle |
//! | g | initial gap of each row | `gap` | b / h | m | negative: the obstacle starts inside the body |
//! | lambda | contact multiplier, `<= 0` | `multiplier` | -z | N | the force on the body along the row; compression is negative |
//! | C | contact indicator (the set of closed rows) | `ContactSet` | | | |
//! | p | contact pressure = -lambda / tributary area seen along the row | `pressure` | | Pa | >= 0 |
//!
//! Any consistent system of units. A scene file becomes a [`Model`] with its [`ContactProblem`]; a matrix becomes a
//! [`ContactProblem`] directly. [`solve_qp`] answers with a [`Solution`]; `Ok` means that its [`Certificate`],
//! recomputed from the problem, meets the tolerance.
//!
//! ```
//! use signorini::{ContactProblem, SparseMatrix, SymmetricMatrix, solve_qp};
//! // Two springs of stiffness 2 and 1 in a row; the end, pushed with force 3, meets a wall at distance 1.
//! let stiffness = SparseMatrix::from_triplets(2, 2, &[(0, 0, 3.0), (1, 0, -1.0), (1, 1, 1.0)])?;
//! let contact = SparseMatrix::from_triplets(1, 2, &[(0, 1, 1.0)])?;
//! let problem = ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, vec![0.0, 3.0], contact, vec![1.0])?;
//! let solution = solve_qp(&problem)?;
//! assert!((solution.displacement[0] - 1.0 / 3.0).abs() < 1e-15 && solution.certificate.meets(1e-9));
//! assert!((solution.multiplier[0] - (1.0 - 1.0 / 3.0 - 3.0)).abs() < 1e-15);
//! # Ok::<(), signorini::Error>(())
//! ```
//!
//! # Start here
//!
//! | you have | take | it gives |
//! |---|---|---|
//! | K, f, B and g | [`ContactProblem`] and [`solve_qp`] or [`solve`] | a certified [`Solution`] |
//! | a scene in JSON | [`Scene`] and its [`Model`] | the problem, and stresses and pressures of an answer |
//! | many gaps or loads | [`Prepared`] | one factorisation for all, and the exact [`Path`] between two gaps |
//! | an accuracy, a time, threads, a method | [`Settings`] | what [`solve`] and [`Prepared`] keep to |
//! | a button that cancels | [`Watch`] | an end from another thread, with the best answer so far |
//!
//! # The rooms
//!
//! | module | what it holds |
//! |---|---|
//! | [`qp`] | the certified quadratic program: problem, settings, solve, factor once and contact many; it speaks no mechanics |
//! | [`lcp`] | linear complementarity problems with bounds: find z with w = M z + q, w'z = 0 |
//! | [`fem`] | elastic bodies: meshes, elements, assembly, recovery of stresses, closed forms |
//! | [`scene`] | scenes in JSON: bodies, supports, loads, obstacles; the model and the way back to it |
//! | [`motion`] | contact in time: mass, schemes, the loop over steps |
//! | [`study`] | comparison of methods, sweeps, trade-offs, refinement |
//! | [`mod@output`] | reports, pictures, files (feature `pictures`) |
//! | [`cli`] | the program (feature `cli`) |
//!
//! A module names only modules of lower floors; see `ARCHITECTURE.md`.

#![forbid(unsafe_code)]
#![deny(missing_docs, clippy::print_stdout, clippy::print_stderr)]

#[cfg(feature = "cli")]
pub mod cli;

pub use signorini_lcp as lcp;
pub use signorini_mechanics::{Error, fem, motion, scene};
#[cfg(feature = "pictures")]
pub use signorini_output as output;
pub use signorini_qp as qp;
pub use signorini_study as study;

pub use qp::{
    Certificate, Condense, ContactProblem, ContactSet, Failure, Goal, InteriorPoint, Iteration, Method, Path, Penalty,
    Prepared, ProvenSet, Seconds, Settings, Solution, SparseMatrix, Start, SymmetricMatrix, Watch, solve, solve_qp,
};
pub use scene::{Model, Scene};

//! The QP: methods, certificate, bound, proofs, condensation and precision, on raw problems and small scenes.

#[path = "../support/oracles/mod.rs"]
mod oracles;
#[path = "../support/program.rs"]
mod program;
#[path = "../support/random.rs"]
mod random;

mod certificate;
mod condensation;
mod degenerate;
mod energy_bound;
mod exact_path;
mod extremes;
mod hostile;
mod methods;
mod obstacle_problems;
mod penalty_ladder;
mod precision;
mod proven_set;
mod watch;

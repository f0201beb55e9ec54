//! The QP: methods, certificate, bound, proofs and condensation, on raw problems and small scenes.
#![expect(clippy::too_many_lines, reason = "tables of cases")]

mod certificate;
mod claims;
mod condensation;
mod degenerate;
mod dense;
mod derivatives;
mod dual_active_set;
mod energy_bound;
mod equalities;
mod exact_arithmetic;
mod exact_path;
mod extremes;
mod findings;
mod hostile;
mod lcp;
mod lcp_literature;
mod methods;
mod modes;
mod obstacle_problems;
mod penalty_ladder;
mod promises;
mod proven_set;
mod separate_parts;
mod watch;

//! The answers of the pieces of a problem as one answer.

use crate::cost::bytes;
use crate::error::Error;
use crate::problem::ContactProblem;
use crate::settings::Settings;
use crate::solution::{Certificate, ContactSet, Iteration, ProvenSet, Seconds, Solution, Why};
use crate::transform::Pieces;

/// The answer put together from the pieces, each found by `solve`, without a certificate, and the certificates of the
/// pieces; `None` if a piece has no answer of its own, or more than one: that is decided for the whole.
pub(super) fn solved(
    problem: &ContactProblem,
    pieces: &Pieces,
    settings: &Settings,
    solve: impl Fn(&ContactProblem, &Settings) -> Result<Solution, Error>,
) -> Result<Option<(Solution, Vec<Certificate>)>, Error> {
    // The whole problem stays in memory beside the piece.
    let of_whole = bytes::of_problem(problem.dofs() as f64, problem.stiffness().entries() as f64);
    let settings = &Settings { memory: settings.memory.map(|most| (most - of_whole).max(1.0)), ..settings.clone() };
    let mut answers = Vec::with_capacity(pieces.count());
    for piece in 0..pieces.count() {
        match solve(&pieces.problem(problem, piece)?, settings) {
            Ok(solution) => answers.push(solution),
            Err(Error::NotCertified { solution, .. }) => answers.push(*solution),
            Err(Error::Interrupted) => return Err(Error::Interrupted),
            Err(_) => return Ok(None),
        }
    }
    let displacement = pieces.join_dofs(answers.iter().map(|answer| &answer.displacement[..]));
    let multiplier = pieces.join_rows(answers.iter().map(|answer| &answer.multiplier[..]));
    let in_whole = |(piece, answer): (usize, &Solution)| {
        let mut certificate = answer.certificate;
        certificate.cancellation.dof = pieces.dof(piece, certificate.cancellation.dof);
        certificate
    };
    let certificates: Vec<_> = answers.iter().enumerate().map(in_whole).collect();
    let mut names: Vec<&str> = answers.iter().map(|answer| answer.method.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let sum = |of: fn(&Seconds) -> f64| answers.iter().map(|answer| of(&answer.seconds)).sum();
    let joined = Solution {
        contact_set: pieces.join_sets(answers.iter().map(|answer| Some(&answer.contact_set))),
        method: names.join(" + "),
        iterations: answers.iter().map(|answer| answer.iterations).max().unwrap_or(0),
        history: history(pieces, &answers),
        proven: proven(pieces, &answers),
        refinements: answers.iter().map(|answer| answer.refinements).max().unwrap_or(0),
        reason: answers
            .iter()
            .map(|answer| &answer.reason)
            .find(|reason| !reason.is_empty())
            .cloned()
            .unwrap_or_default(),
        why: why(&answers),
        cut_short: answers.iter().find_map(|answer| answer.cut_short.clone()),
        lost_pivot: answers.iter().filter_map(|answer| answer.lost_pivot).min_by(f64::total_cmp),
        condensed_dofs: answers.iter().map(|answer| answer.condensed_dofs).sum(),
        seconds: Seconds {
            factor: sum(|seconds| seconds.factor),
            certificate: sum(|seconds| seconds.certificate),
            proof: sum(|seconds| seconds.proof),
            solve: sum(|seconds| seconds.solve),
        },
        displacement,
        multiplier,
        equality_multiplier: Vec::new(),
        certificate: Certificate::unknown(),
        attempts: answers.into_iter().flat_map(|answer| answer.attempts).collect(),
    };
    Ok(Some((joined, certificates)))
}

/// The reason for the way in which the largest piece was solved.
fn why(answers: &[Solution]) -> Why {
    let largest = answers.iter().max_by_key(|answer| answer.displacement.len());
    let of_piece = largest.map(|largest| largest.why.clone()).unwrap_or_default();
    let count = answers.len();
    let reason = format!("in {count} pieces, because nothing couples them; the largest {}", of_piece.reason);
    Why { reason, ..of_piece }
}

/// The sets of all pieces joined, iteration by iteration; a piece with fewer iterations stays at its last set.
fn history(pieces: &Pieces, answers: &[Solution]) -> Vec<Iteration> {
    let most = answers.iter().map(|answer| answer.history.len()).max().unwrap_or(0);
    let at = |number: usize| {
        let steps = || answers.iter().map(move |answer| answer.history.get(number).or(answer.history.last()));
        let penalty = steps().flatten().map(|step| step.penalty).fold(0.0, f64::max);
        Iteration { contact_set: pieces.join_sets(steps().map(|step| step.map(|step| &step.contact_set))), penalty }
    };
    (0..most).map(at).collect()
}

/// The rows that the pieces prove; `None` if no piece has a proof.
fn proven(pieces: &Pieces, answers: &[Solution]) -> Option<ProvenSet> {
    answers.iter().any(|answer| answer.proven.is_some()).then(|| {
        let of = |set: fn(&ProvenSet) -> &ContactSet| {
            pieces.join_sets(answers.iter().map(|answer| answer.proven.as_ref().map(set)))
        };
        ProvenSet { open: of(|proven| &proven.open), closed: of(|proven| &proven.closed) }
    })
}

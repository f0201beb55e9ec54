//! What is taken out of a problem before its ladder: equalities, eliminated, or pieces that nothing couples.

use super::{Run, solved};
use crate::certificate::{Bounding, motion_along, with_rounding};
use crate::cost::bytes;
use crate::error::{Error, Result};
use crate::method::Start;
use crate::plan::{Answered, Best, Ended, Record};
use crate::settings::Settings;
use crate::solution::{Certificate, ContactSet, Iteration, ProvenSet, Seconds, Solution, Why};
use crate::transform::{Elimination, Pieces, joined};

impl Run<'_> {
    /// The answer without equalities, and these put back; nothing if none is eliminated, or the whole must decide.
    pub fn by_elimination(&mut self, record: &mut Record) -> Result<Ended> {
        let (problem, kept) = (self.problem, self.rest);
        let made = if kept.is_some() { None } else { Elimination::of(problem)? };
        let Some(elimination) = kept.map(|kept| kept.elimination).or(made.as_ref()) else { return Ok(Ended::Empty) };
        let staying = |set: &ContactSet| elimination.rows.iter().map(|&row| set.contains(row)).collect();
        let start = &Start {
            displacement: self.start.displacement.as_deref().map(|u| elimination.staying(u)),
            contact_set: self.start.contact_set.as_ref().map(staying),
        };
        // What is exact enough for the rest may be far from that for a whole that moves almost without energy.
        let exact = Settings { tolerance: Some(f64::MIN_POSITIVE), accuracy: None, ..self.settings.clone() };
        let mut all: Option<Answered> = None;
        for given in [self.settings, &exact] {
            // The certificate of the whole and its proof follow.
            let settings = &Settings { prove: false, ..given.clone() };
            let anew = || elimination.problem(problem).and_then(|rest| solved(&rest, start, settings));
            let answer = match kept.map_or_else(anew, |kept| (kept.solve)(start, settings)) {
                Ok(solution) => solution,
                Err(Error::NotCertified { solution, .. }) => *solution,
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                Err(Error::Infeasible { rows, weights, .. }) => {
                    let (rows, weights) = elimination.contradiction(problem, &rows, &weights);
                    match problem.overlap(&rows, &weights) {
                        Some(_) => return Err(problem.infeasible(&rows, &weights)),
                        None => break,
                    }
                }
                Err(error) => {
                    let moves = |direction| motion_along(problem, &elimination.motion(direction));
                    self.moves = error.direction().and_then(moves);
                    break;
                }
            };
            self.is_cut = elimination.is_cut();
            let (of_rest, Seconds { factor, certificate, .. }) = (answer.certificate, answer.seconds);
            record.stages.factor += factor;
            record.stages.certificate += certificate;
            let answer = elimination.expanded(problem, answer);
            // An error has the same energy in the rest, but for the rounding of the displacement.
            let of_rest = self.is_cut.then(|| [with_rounding(problem, of_rest, &answer.displacement)]);
            let norm = || kept.and_then(|kept| kept.norm.clone()).map_or(Bounding::OwnFactor, Bounding::Factor);
            let by = of_rest.as_ref().map_or_else(norm, |of_rest| Bounding::Pieces(of_rest));
            let answered = self.judged(Best::of(answer, record.attempt), &by, record)?;
            all = Some(all.map_or(answered, |all| all.or(answered)));
            if self.history.is_certified() || !given.method.wants_best() {
                break;
            }
        }
        Ok(all.map_or(Ended::Empty, Ended::Answered))
    }

    /// The answers of the pieces as one; nothing if a piece has none or several: that is decided for the whole.
    pub fn in_pieces(&mut self, pieces: &Pieces, record: &mut Record) -> Result<Ended> {
        let problem = self.problem;
        // The whole problem stays in memory beside the piece.
        let of_whole = bytes::of_problem(problem.dofs() as f64, problem.stiffness().entries() as f64);
        let memory = self.settings.memory.map(|most| (most - of_whole).max(1.0));
        let settings = &Settings { memory, ..self.settings.clone() };
        let mut answers = Vec::with_capacity(pieces.count());
        for piece in 0..pieces.count() {
            match solved(&pieces.problem(problem, piece)?, &Start::default(), settings) {
                Ok(solution) => answers.push(solution),
                Err(Error::NotCertified { solution, .. }) => answers.push(*solution),
                Err(Error::Interrupted) => return Err(Error::Interrupted),
                Err(_) => return Ok(Ended::Empty),
            }
        }
        let in_whole = |(piece, answer): (usize, &Solution)| {
            let mut certificate = answer.certificate;
            certificate.cancellation.dof = pieces.dofs[piece].get(certificate.cancellation.dof).copied().unwrap_or(0);
            certificate
        };
        let certificates: Vec<_> = answers.iter().enumerate().map(in_whole).collect();
        let sum = |of: fn(&Seconds) -> f64| answers.iter().map(|answer| of(&answer.seconds)).sum();
        let (factor, certificate) = (sum(|seconds| seconds.factor), sum(|seconds| seconds.certificate));
        record.stages = Seconds { factor, certificate, proof: sum(|seconds| seconds.proof), solve: 0.0 };
        let answer = Best::of(put_together(pieces, answers), record.attempt);
        self.judged(answer, &Bounding::Pieces(&certificates), record).map(Ended::Answered)
    }
}

/// The answer put together from those of the pieces, without a certificate.
fn put_together(pieces: &Pieces, answers: Vec<Solution>) -> Solution {
    let displacement = joined(&pieces.dofs, answers.iter().map(|answer| &answer.displacement[..]));
    let multiplier = joined(&pieces.rows, answers.iter().map(|answer| &answer.multiplier[..]));
    let mut names: Vec<&str> = answers.iter().map(|answer| answer.method.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    Solution {
        contact_set: pieces.join_sets(answers.iter().map(|answer| Some(&answer.contact_set))),
        method: names.join(" + "),
        iterations: answers.iter().map(|answer| answer.iterations).max().unwrap_or(0),
        history: history(pieces, &answers),
        proven: proven(pieces, &answers),
        refinements: answers.iter().map(|answer| answer.refinements).max().unwrap_or(0),
        reason: answers.iter().map(|answer| &answer.reason).find(|it| !it.is_empty()).cloned().unwrap_or_default(),
        why: why(&answers),
        cut_short: answers.iter().find_map(|answer| answer.cut_short.clone()),
        lost_pivot: answers.iter().filter_map(|answer| answer.lost_pivot).min_by(f64::total_cmp),
        condensed_dofs: answers.iter().map(|answer| answer.condensed_dofs).sum(),
        seconds: Seconds::default(),
        displacement,
        multiplier,
        equality_multiplier: Vec::new(),
        certificate: Certificate::unknown(),
        attempts: answers.into_iter().flat_map(|answer| answer.attempts).collect(),
    }
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

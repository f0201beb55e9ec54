//! The answers of a sweep, one after the other, and the memory that they take.

use crate::bytes;
use crate::error::Error;
use signorini_qp as qp;
use signorini_qp::{Settings, Solution, Start};

/// The points of a sweep at all `values` of the quantity `name`: `solved_at` a value gives the solution, started from
/// the last one, with what else `point` needs. An answer that is not certified counts as an answer. An interrupted
/// sweep holds the points before.
pub(super) fn points<T, P>(
    name: &'static str,
    values: &[f64],
    settings: &Settings,
    solved_at: impl Fn(f64, Start) -> Result<(T, Result<Solution, Error>), Error>,
    point: impl Fn(f64, T, Solution) -> Result<P, Error>,
) -> Result<Vec<P>, Error> {
    let (mut points, mut known) = (Vec::with_capacity(values.len()), Start::default());
    for (index, &value) in values.iter().enumerate() {
        settings.watch.part(name, index + 1, values.len());
        let (of_value, solved) = solved_at(value, known)?;
        let solution = match solved {
            Ok(solution) => solution,
            // An interrupted solve is no answer to this value.
            Err(_) if settings.watch.acknowledge() => break,
            Err(Error::Qp(qp::Error::NotCertified { solution, .. })) => *solution,
            Err(error) => return Err(error),
        };
        known = Start::from(&solution);
        points.push(point(value, of_value, solution)?);
        if settings.watch.acknowledge() {
            break;
        }
    }
    if points.is_empty() { Err(qp::Error::Interrupted.into()) } else { Ok(points) }
}

/// The answers that a sweep keeps until its report: they leave less of the allowed memory to each solve.
pub(super) struct KeptAnswers {
    count: usize,
    dofs: usize,
    /// The allowed memory, in bytes; `None` if there is no limit.
    allowed: Option<f64>,
}

impl KeptAnswers {
    /// `count` answers with `dofs` unknowns each.
    pub fn of(count: usize, dofs: usize, settings: &Settings) -> Self {
        KeptAnswers { count, dofs, allowed: settings.memory }
    }

    fn bytes(&self) -> f64 {
        bytes::of_answers(self.count as f64, self.dofs as f64)
    }

    pub fn settings(&self, settings: &Settings) -> Settings {
        match self.allowed {
            Some(allowed) => settings.clone().with_memory((allowed - self.bytes()).max(1.0)),
            None => settings.clone(),
        }
    }

    /// The error of a solve under these settings, with the limit that was set: the answers are the reason if the solve
    /// alone fits.
    pub fn explain(&self, error: Error) -> Error {
        let Some(allowed) = self.allowed else { return error };
        let of_answers = |solve: f64| {
            let (count, dofs, kept) = (self.count, self.dofs, self.bytes());
            Error::TooManyAnswers { count, dofs, kept, solve, allowed }
        };
        match error {
            Error::Qp(qp::Error::TooLarge { bytes, .. }) if bytes <= allowed => of_answers(bytes),
            Error::Qp(qp::Error::NoRoom { factor, multigrid, .. }) if factor.min(multigrid) <= allowed => {
                of_answers(factor.min(multigrid))
            }
            Error::Qp(qp::Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, .. }) => {
                qp::Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed }.into()
            }
            Error::Qp(qp::Error::NoRoom { factor, multigrid, ended, .. }) => {
                qp::Error::NoRoom { factor, multigrid, allowed, ended }.into()
            }
            error => error,
        }
    }
}

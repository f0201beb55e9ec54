//! The answers of a sweep, one after the other, the memory that they take, and the exact path between its gaps.

use crate::bytes;
use crate::error::Error;
use crate::scene::{Answer, Model};
use signorini_qp as qp;
use signorini_qp::{ContactSet, Path, Settings, Solution, Start};

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

/// Two corners closer than this are one, as shares of the path.
const SAME_PLACE: f64 = 1e-13;

/// The exact changes of a scene from one gap to another: between two corners everything is linear in the gap.
#[derive(Clone, Debug)]
pub struct ExactPath {
    /// The path between the first gap and the last.
    pub path: Path,
    /// The scene at the first gap.
    model: Model,
    first: f64,
    last: f64,
}

impl ExactPath {
    /// The `path` of the rows of `model`, which has the gap `first`, to the gap `last`.
    pub fn new(path: Path, model: Model, last: f64) -> Self {
        let first = model.gap();
        ExactPath { path, model, first, last }
    }

    /// The scene-wide gap at a share of the path.
    pub fn gap(&self, share: f64) -> f64 {
        (1.0 - share) * self.first + share * self.last
    }

    /// Number of stretches on which the contact set does not change.
    pub fn pieces(&self) -> usize {
        self.path.pieces().len()
    }

    /// The two ends of a stretch, its start before its end, as shares of the path: dimensionless, in `[0, 1]`.
    pub fn ends(&self, piece: usize) -> [f64; 2] {
        [self.path.pieces()[piece].from, self.path.pieces()[piece].to]
    }

    /// The closed rows on a stretch.
    pub fn contact_set(&self, piece: usize) -> ContactSet {
        self.path.contact_set_on(&self.path.pieces()[piece])
    }

    /// The multipliers at both ends of a stretch, one per row, in force, `<= 0`.
    pub fn multipliers(&self, piece: usize) -> [Vec<f64>; 2] {
        self.ends(piece).map(|share| self.path.multiplier_on(&self.path.pieces()[piece], share))
    }

    /// The pressures of all rows at both ends of a stretch, in force per area.
    pub fn pressures(&self, piece: usize) -> Result<[Vec<f64>; 2], Error> {
        let [from, to] = self.multipliers(piece);
        Ok([self.model.pressure(&from)?, self.model.pressure(&to)?])
    }

    /// The start, every event and the end in this order, as shares of the path, dimensionless.
    pub fn corners(&self) -> Vec<f64> {
        let mut corners = self.path.corners();
        corners.dedup_by(|next, last| (*next - *last).abs() <= SAME_PLACE);
        corners
    }

    /// The answer at a share of the path, without its own certificate.
    pub fn answer(&self, share: f64) -> Result<Answer, Error> {
        let model = std::sync::Arc::new(self.model.with_gap(self.gap(share))?);
        let (displacement, multiplier) = (self.path.displacement(share)?, self.path.multiplier(share));
        let multiplier = [multiplier, self.path.equality_multiplier(share)].concat();
        Answer::new(model, &displacement, &multiplier, &self.path.contact_set(share))
    }
}

//! Rigid motions that a load drives and nothing stops.

use signorini_qp::{self as qp, ContactProblem, Settings, SparseMatrix, SymmetricMatrix, dot, largest};

use super::RigidBodyModes;
use crate::error::Error;
use crate::scene::models::parts::Parts;

/// More motions that supports and ties leave free are left to the solver.
const MOST_MOTIONS: usize = 60;

/// Work and approach below this share of the sum of their terms are rounding.
const ROUNDING: f64 = 1e-9;

/// Rows stop a motion if they leave less than this share of the drive.
const STOPPED: f64 = 1e-6;

impl RigidBodyModes {
    /// Refuses a load that drives bodies along a motion that neither supports nor ties nor contact rows stop. The
    /// motion of bodies that ties join is none of one body alone, so that a solver hardly tells it from a soft one.
    ///
    /// Of all motions that supports and ties leave free, the one nearest to the drive of the load that closes no row is
    /// itself the answer to a contact problem, with K = I.
    pub fn check_bounded(&self, parts: &Parts, problem: &ContactProblem) -> Result<(), Error> {
        let mut free = self.free(parts, &[]);
        if free.len() > MOST_MOTIONS {
            free.clear();
        }
        let motions: Vec<Vec<f64>> = free.iter().map(|motion| self.in_unknowns(parts, motion)).collect();
        let work = |motion: &Vec<f64>| {
            let terms: f64 = problem.load().iter().zip(motion).map(|(force, part)| (force * part).abs()).sum();
            let work = dot(problem.load(), motion);
            if work.abs() > ROUNDING * terms { work } else { 0.0 }
        };
        let drive: Vec<f64> = motions.iter().map(work).collect();
        let strength = largest(&drive);
        if strength == 0.0 {
            return Ok(());
        }
        let drive = drive.into_iter().map(|work| work / strength).collect();
        let Some(amounts) = nearest_that_closes_nothing(problem, &motions, drive) else { return Ok(()) };
        let sum = |vectors: &[Vec<f64>]| -> Vec<f64> {
            let part = |place: usize| vectors.iter().zip(&amounts).map(|(vector, amount)| amount * vector[place]).sum();
            (0..vectors[0].len()).map(part).collect()
        };
        let (motion, direction) = (sum(&free), sum(&motions));
        let size = largest(&direction);
        let approach = problem.contact().mul(&direction).into_iter().zip(sizes(problem)).zip(problem.gap());
        let closes = |((speed, row), gap): ((f64, f64), &f64)| gap.is_finite() && speed > ROUNDING * row * size;
        if work(&direction) <= 0.0 || approach.take(problem.inequalities()).any(closes) {
            return Ok(());
        }
        let direction = direction.into_iter().map(|part| part / size).collect();
        Err(qp::Error::Unbounded { mode: self.name_of(&motion), direction }.into())
    }
}

/// The sum of the magnitudes of the entries of each row.
fn sizes(problem: &ContactProblem) -> Vec<f64> {
    problem.contact().mul_abs(&vec![1.0; problem.dofs()])
}

/// The amounts of some motions, together nearest to a drive, that close no row with a bound; `None` if the rows leave
/// none.
fn nearest_that_closes_nothing(problem: &ContactProblem, motions: &[Vec<f64>], drive: Vec<f64>) -> Option<Vec<f64>> {
    let (count, rows) = (motions.len(), problem.inequalities());
    let (mut entries, sizes) = (Vec::new(), sizes(problem));
    for (number, motion) in motions.iter().enumerate() {
        let (speeds, size) = (problem.contact().mul(motion), largest(motion));
        let counts = |&row: &usize| problem.gap()[row].is_finite() && speeds[row].abs() > ROUNDING * sizes[row] * size;
        entries.extend((0..rows).filter(counts).map(|row| (row, number, speeds[row])));
    }
    let ones: Vec<(usize, usize, f64)> = (0..count).map(|number| (number, number, 1.0)).collect();
    let identity = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(count, count, &ones).ok()?).ok()?;
    let contact = SparseMatrix::from_triplets(rows, count, &entries).ok()?;
    let nearest = ContactProblem::new(identity, drive, contact, vec![0.0; rows]).ok()?;
    let amounts = qp::solve(&nearest, &Settings::default()).ok()?.displacement;
    (largest(&amounts) > STOPPED).then_some(amounts)
}

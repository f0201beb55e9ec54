//! Random problems at, near and away from kinks, with exact one-sided derivatives.
//!
//! An exact answer u*, lambda* is drawn first; the load and the gaps follow from it without rounding. The one-sided
//! derivative is the exact answer of the contact problem of the derivatives: pressing rows as equalities, rows without
//! gap and force as rows.

use signorini::qp::{Change, Derivative, Tangent};
use signorini::{Prepared, Settings};

use super::Draws;
use super::case::Case;
use super::dyadic::{Dyadic, ratio};
use super::problem::Exact;
use super::solve::Outcome;

/// An error above this, relative to the largest entry, is a wrong derivative.
const WRONG: f64 = 1e-6;

/// Where a problem lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// Every row has a gap, or a force, of order one.
    Away,
    /// The gap and the force of some rows are exactly zero.
    AtKink,
    /// Some rows have a gap of 1e-14 to 1e-9 and no force.
    Near,
}

/// A problem with a change of its load and gaps.
#[derive(Clone, Debug)]
pub struct Kink {
    pub place: Place,
    pub case: Case,
    /// `true` if no double is the exact answer.
    pub is_fraction: bool,
    load: Vec<f64>,
    gap: Vec<f64>,
}

/// The verdict of the program on one problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    pub verdict: String,
    /// What is wrong with it.
    pub wrong: Option<String>,
}

/// An exact derivative: of u (n), and of lambda (m).
type OneSided = (Vec<f64>, Vec<f64>);

impl Kink {
    /// Problem `number` of a seed.
    pub fn of(seed: u64, number: u64) -> Self {
        let mut draws = Draws::of(seed, number);
        let place = [Place::Away, Place::AtKink, Place::Near][number as usize % 3];
        let (n, m) = (2 + draws.below(10), 1 + draws.below(8));
        // Answers that are thirds are no doubles.
        let is_fraction = draws.one_in(6);
        let unit = if is_fraction { 3.0 } else { 1.0 };
        let mut small = |most: i32| f64::from(draws.between(-most, most));
        let factor: Vec<Vec<f64>> = (0..n).map(|_| (0..n).map(|_| small(2)).collect()).collect();
        let square = |i: usize, j: usize| -> f64 { (0..n).map(|k| factor[i][k] * factor[j][k]).sum() };
        let own = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        let mut stiffness: Vec<Vec<f64>> =
            (0..n).map(|i| (0..n).map(|j| unit * (square(i, j) + own(i, j))).collect()).collect();
        let mut contact: Vec<Vec<f64>> = (0..m).map(|_| (0..n).map(|_| unit * small(1)).collect()).collect();
        let u: Vec<f64> = (0..n).map(|_| small(32) / 8.0).collect();
        let mut change_of_load: Vec<f64> = (0..n).map(|_| small(8) / 4.0).collect();
        let change_of_gap = (0..m).map(|_| small(8) / 4.0).collect();
        if draws.one_in(10) && m > 1 {
            // A row twice: its forces are not unique.
            contact[m - 1] = contact[0].clone();
        }
        let off = |value: f64| if is_fraction { value / unit } else { value };
        let (mut force, mut gap) = (vec![0.0; m], vec![0.0; m]);
        for row in 0..m {
            let along: f64 = contact[row].iter().zip(&u).map(|(b, u)| b * u).sum();
            let state = draws.below(3);
            // B u of an answer u/3 with rows in multiples of three is exact.
            gap[row] = off(along);
            match (state, place) {
                (0, _) => force[row] = -f64::from(draws.between(1, 16)) / 4.0,
                (1, Place::AtKink) => {}
                (1, Place::Near) => gap[row] += 2.0_f64.powi(-draws.between(30, 46)),
                _ => gap[row] += f64::from(draws.between(1, 16)) / 4.0,
            }
        }
        let mut load: Vec<f64> = (0..n)
            .map(|dof| {
                let elastic: f64 = stiffness[dof].iter().zip(&u).map(|(k, u)| k * u).sum();
                let pressed: f64 = contact.iter().zip(&force).map(|(row, force)| row[dof] * force).sum();
                off(elastic) - pressed
            })
            .collect();
        if draws.one_in(4) {
            // An obstacle that a force presses against some rows: one more dof, without stiffness.
            let shares: Vec<f64> = (0..m).map(|_| f64::from(draws.between(0, 2))).collect();
            let drive: f64 = -shares.iter().zip(&force).map(|(share, force)| share * force).sum::<f64>();
            if drive > 0.0 {
                let travel = f64::from(draws.between(-16, 16)) / 8.0;
                gap.iter_mut().zip(&shares).for_each(|(gap, share)| *gap += share * travel);
                contact.iter_mut().zip(&shares).for_each(|(row, &share)| row.push(share));
                stiffness.iter_mut().for_each(|row| row.push(0.0));
                stiffness.push(vec![0.0; n + 1]);
                load.push(drive);
                change_of_load.push(f64::from(draws.between(-8, 8)) / 4.0);
            }
        }
        let case = Case { stiffness, load, contact, gap };
        Kink { place, case, is_fraction, load: change_of_load, gap: change_of_gap }
    }

    /// The verdict of the program on the derivatives along the change, by tangent and adjoint, against the exact ones.
    ///
    /// # Panics
    /// If a problem has no answer.
    pub fn judged(&self, by_displacement: &[f64], by_multiplier: &[f64]) -> Judged {
        let problem = self.case.problem().unwrap();
        let prepared = Prepared::new(&problem, &Settings::default().with_proof()).unwrap();
        let solution = prepared.solve(problem.gap()).unwrap();
        let derivatives = prepared.derivatives(&solution).unwrap();
        let change = Change { load: self.load.clone(), distance: self.gap.clone() };
        let tangent = derivatives.tangent(&change).unwrap();
        let adjoint = derivatives.adjoint(by_displacement, by_multiplier).unwrap();
        let [(right, is_kink), (left, _)] = [1.0, -1.0].map(|sign| self.one_sided(sign));
        let off = |found: &Tangent, exact: &Option<OneSided>| match exact {
            Some(exact) => differs((&found.displacement, &found.multiplier), exact).map(|by| format!("off by {by:e}")),
            None => Some("claimed where there is no derivative".to_string()),
        };
        let wrong = match &tangent {
            Derivative::Proven(_) if is_kink => Some("proven at a kink".to_string()),
            Derivative::Proven(found) => off(found, &right).or_else(|| {
                let by_adjoint = adjoint.proven()?.along(&change);
                let terms = [(by_displacement, &found.displacement), (by_multiplier, &found.multiplier)];
                let by_tangent: f64 = terms.iter().map(|(by, value)| dot(by, value)).sum();
                let scale: f64 = terms.iter().map(|(by, value)| by.len() as f64 * size(by) * size(value)).sum();
                let is_off = (by_adjoint - by_tangent).abs() > WRONG * scale;
                is_off.then(|| format!("{by_adjoint} by the adjoint, {by_tangent} by the tangent"))
            }),
            Derivative::OneSided { .. } if !is_kink => Some("one-sided without a kink".to_string()),
            Derivative::OneSided { left: below, right: above } => off(below, &left).or_else(|| off(above, &right)),
            Derivative::Undecided { .. } | Derivative::Unknown { .. } => None,
        };
        Judged { verdict: tangent.verdict().to_string(), wrong }
    }

    /// The exact derivative for a parameter that grows (1) or falls (-1), and `true` at a kink; no derivative if rows
    /// that follow from each other contradict each other after any change.
    fn one_sided(&self, sign: f64) -> (Option<OneSided>, bool) {
        let exact = Exact::new(&self.case);
        let Outcome::Solved(answer) = exact.outcome() else { panic!("a definite problem has an answer") };
        let distances = exact.distances(&answer);
        let touching: Vec<usize> = (0..self.case.rows()).filter(|&row| distances[row].is_zero()).collect();
        let is_weak = |row: usize| answer.force[row].is_zero();
        let is_kink = touching.iter().any(|&row| is_weak(row));
        let times = |value: f64| Dyadic::from(sign * value);
        // A pressing row is an equality: the row and its opposite.
        let sides = touching.iter().flat_map(|&row| {
            let opposite = (!is_weak(row)).then_some((row, true));
            std::iter::once((row, false)).chain(opposite)
        });
        let sides: Vec<(usize, bool)> = sides.collect();
        let turned = |value: &Dyadic, is_opposite: bool| if is_opposite { -value } else { value.clone() };
        let contact =
            sides.iter().map(|&(row, side)| exact.contact[row].iter().map(|b| turned(b, side)).collect()).collect();
        let gap = sides.iter().map(|&(row, side)| turned(&times(self.gap[row]), side)).collect();
        let load = self.load.iter().map(|&value| times(value)).collect();
        let rows = (0..sides.len()).collect();
        let Outcome::Solved(found) = (Exact { stiffness: exact.stiffness, load, contact, gap, rows }).outcome() else {
            return (None, is_kink);
        };
        let back = |value: &Dyadic| sign * ratio(value, &found.denominator);
        let mut multiplier = vec![0.0; self.case.rows()];
        for (&(row, is_opposite), force) in sides.iter().zip(&found.force) {
            multiplier[row] += if is_opposite { back(force) } else { -back(force) };
        }
        (Some((found.displacement.iter().map(back).collect(), multiplier)), is_kink)
    }
}

fn size(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |size: f64, value| size.max(value.abs()))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The largest difference from the exact derivative, relative, if it is too large.
fn differs((du, dl): (&[f64], &[f64]), (exact_du, exact_dl): &OneSided) -> Option<f64> {
    let off = |found: &[f64], exact: &[f64]| {
        let rest: Vec<f64> = found.iter().zip(exact).map(|(a, b)| a - b).collect();
        size(&rest) / size(exact).max(1e-12)
    };
    let most = off(du, exact_du).max(off(dl, exact_dl));
    (most > WRONG).then_some(most)
}

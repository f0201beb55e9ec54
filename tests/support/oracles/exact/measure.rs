//! The distance of an answer from the exact one, in energy, evaluated without rounding.

use super::case::Case;
use super::dyadic::{Dyadic, dot, ratio, root_of_ratio};
use super::problem::Exact;
use super::solve::Answer;

/// Couplings below this share of `sqrt(K_ii K_jj)` do not join two dofs into one part.
const COUPLED: f64 = 1e-6;

/// Rounding may change every displacement by this share: half a unit in the last place, twice, and a little for the
/// difference between the two answers.
const ROUNDING: f64 = 1.001 * f64::EPSILON;

/// A problem and its exact answer.
pub struct Errors<'a> {
    pub case: &'a Case,
    pub exact: &'a Exact,
    pub answer: &'a Answer,
}

/// The error of one answer in a set of dofs: `error^2` and `size^2` over the same positive number.
pub struct Relative {
    error: Dyadic,
    size: Dyadic,
    /// `true` if no displacement of the answer differs from zero.
    pub is_at_rest: bool,
    /// The relative error caused by rounding the exact displacement.
    pub explained: f64,
}

impl Relative {
    pub fn value(&self) -> f64 {
        match (self.error.is_zero(), self.size.is_zero()) {
            (true, _) => 0.0,
            (false, true) => f64::INFINITY,
            (false, false) => root_of_ratio(&self.error, &self.size),
        }
    }

    /// Returns `true` if the relative error is at most `bound`, compared exactly.
    pub fn is_within(&self, bound: f64) -> bool {
        let bound = Dyadic::from(bound);
        self.error <= &(&bound * &bound) * &self.size
    }
}

impl Errors<'_> {
    /// The error of u relative to its own energy norm, as the certificate states it.
    pub fn whole(&self, displacement: &[f64]) -> Relative {
        let all: Vec<usize> = (0..self.case.dofs()).collect();
        self.within(&all, displacement, false)
    }

    /// Returns `true` if `|u - u*|_K` is at most `bound`, compared exactly.
    pub fn is_within(&self, displacement: &[f64], bound: f64) -> bool {
        let bound = &Dyadic::from(bound) * &self.answer.denominator;
        self.whole(displacement).error <= &bound * &bound
    }

    /// Returns `true` if `|u - u*|_K` is at most `T / (1 - T) |u*|_K + eps sqrt(|u|'|K||u|)`, compared exactly: right
    /// to T of the own norm of u, or as close as doubles can be.
    pub fn is_right(&self, displacement: &[f64], tolerance: f64) -> bool {
        let all: Vec<usize> = (0..self.case.dofs()).collect();
        let rest = &Dyadic::integer(1) - &Dyadic::from(tolerance);
        let times = |factor: &Dyadic, square: &Dyadic| &(factor * factor) * square;
        let error = times(&rest, &self.whole(displacement).error);
        let allowed = times(&tolerance.into(), &self.energy(&all, &self.answer.displacement));
        let sizes: Vec<Dyadic> = displacement.iter().map(|u| Dyadic::from(u.abs())).collect();
        let terms = self.exact.stiffness.iter().zip(&sizes).map(|(line, u)| {
            let line: Vec<Dyadic> = line.iter().map(Dyadic::abs).collect();
            u * &dot(&line, &sizes)
        });
        let terms = terms.fold(Dyadic::ZERO, |sum, part| &sum + &part);
        let rounding = times(&(&rest * &(&self.answer.denominator * &f64::EPSILON.into())), &terms);
        // sqrt(error) <= sqrt(allowed) + sqrt(rounding), squared twice.
        let mixed = &error - &(&allowed + &rounding);
        mixed.sign() <= 0 || &mixed * &mixed <= (&allowed * &rounding).ldexp(2)
    }

    /// The error in each part, relative to the larger norm of the two answers.
    pub fn parts(&self, displacement: &[f64]) -> Vec<Relative> {
        parts(self.case).iter().map(|part| self.within(part, displacement, true)).collect()
    }

    fn within(&self, dofs: &[usize], displacement: &[f64], or_exact: bool) -> Relative {
        let scale = &self.answer.denominator;
        let given: Vec<Dyadic> = dofs.iter().map(|&dof| &Dyadic::from(displacement[dof]) * scale).collect();
        let exact: Vec<Dyadic> = dofs.iter().map(|&dof| self.answer.displacement[dof].clone()).collect();
        let apart: Vec<Dyadic> = given.iter().zip(&exact).map(|(a, b)| a - b).collect();
        let mut size = self.energy(dofs, &given);
        if or_exact {
            size = larger(size, self.energy(dofs, &exact));
        }
        let rounding = &Dyadic::from(self.rounding(dofs)) * scale;
        let explained = if size.is_zero() { 0.0 } else { root_of_ratio(&(&rounding * &rounding), &size) };
        let is_at_rest = dofs.iter().all(|&dof| displacement[dof] == 0.0);
        Relative { error: self.energy(dofs, &apart), size, is_at_rest, explained }
    }

    /// `v'K v` of the displacements v of some dofs.
    fn energy(&self, dofs: &[usize], values: &[Dyadic]) -> Dyadic {
        let product = |(place, &dof): (usize, &usize)| {
            let line = dofs.iter().map(|&other| &self.exact.stiffness[dof][other]);
            &values[place] * &dot(line, values)
        };
        dofs.iter().enumerate().map(product).fold(Dyadic::ZERO, |sum, part| &sum + &part)
    }

    /// The largest effect of rounding the exact displacement, in energy.
    fn rounding(&self, dofs: &[usize]) -> f64 {
        let exact: Vec<f64> =
            dofs.iter().map(|&dof| ratio(&self.answer.displacement[dof], &self.answer.denominator).abs()).collect();
        let product = |(a, &i): (usize, &usize)| {
            dofs.iter().enumerate().map(|(b, &j)| self.case.stiffness[i][j].abs() * exact[a] * exact[b]).sum::<f64>()
        };
        ROUNDING * dofs.iter().enumerate().map(product).sum::<f64>().sqrt()
    }
}

fn larger(a: Dyadic, b: Dyadic) -> Dyadic {
    if a < b { b } else { a }
}

/// The connected components of K and B.
pub fn parts(case: &Case) -> Vec<Vec<usize>> {
    let n = case.dofs();
    let mut root: Vec<usize> = (0..n).collect();
    let mut join = |a: usize, b: usize| {
        let (from, to) = (root[a], root[b]);
        root.iter_mut().filter(|entry| **entry == from).for_each(|entry| *entry = to);
    };
    for i in 0..n {
        for j in 0..i {
            let strongest = (case.stiffness[i][i] * case.stiffness[j][j]).sqrt();
            if case.stiffness[i][j].abs() > COUPLED * strongest {
                join(i, j);
            }
        }
    }
    for row in (0..case.rows()).filter(|&row| case.is_bounded(row)) {
        let dofs: Vec<usize> = (0..n).filter(|&dof| case.contact[row][dof] != 0.0).collect();
        dofs.windows(2).for_each(|pair| join(pair[0], pair[1]));
    }
    let mut parts: Vec<Vec<usize>> = vec![Vec::new(); n];
    (0..n).for_each(|dof| parts[root[dof]].push(dof));
    parts.retain(|part| !part.is_empty());
    parts
}

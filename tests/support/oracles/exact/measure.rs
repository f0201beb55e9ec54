//! The distance of an answer from the exact one, in energy, evaluated without rounding.

use super::case::Case;
use super::dyadic::{Dyadic, dot, ratio, root_of_ratio};
use super::solve::{Answer, Exact};

/// Couplings below this share of `sqrt(K_ii K_jj)` do not join two dofs into one part.
const COUPLED: f64 = 1e-6;

/// A displacement below this share of force divided by root of stiffness, in energy, counts as rest.
const AT_REST: f64 = 1e-6;

/// The size of a body at rest is computed in doubles: its error is at most this factor.
const IN_DOUBLES: f64 = 1.0 + 1e-12;

/// Rounding may change every displacement by this share.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

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
    /// The error of (u, lambda) as the certificate states it: relative to the energy norm of u, or to the size that
    /// counts as rest if that is larger.
    pub fn whole(&self, displacement: &[f64], multiplier: &[f64]) -> Relative {
        let all: Vec<usize> = (0..self.case.dofs()).collect();
        self.within(&all, displacement, multiplier, false)
    }

    /// The error in each part, relative to the larger norm of the two answers, or to the size that counts as rest.
    pub fn parts(&self, displacement: &[f64], multiplier: &[f64]) -> Vec<Relative> {
        parts(self.case).iter().map(|part| self.within(part, displacement, multiplier, true)).collect()
    }

    fn within(&self, dofs: &[usize], displacement: &[f64], multiplier: &[f64], or_exact: bool) -> Relative {
        let scale = &self.answer.denominator;
        let square = |values: &[Dyadic]| {
            let product = |(place, &dof): (usize, &usize)| {
                let line = dofs.iter().map(|&other| &self.exact.stiffness[dof][other]);
                &values[place] * &dot(line, values)
            };
            dofs.iter().enumerate().map(product).fold(Dyadic::ZERO, |sum, part| &sum + &part)
        };
        let given: Vec<Dyadic> = dofs.iter().map(|&dof| &Dyadic::from(displacement[dof]) * scale).collect();
        let exact: Vec<Dyadic> = dofs.iter().map(|&dof| self.answer.displacement[dof].clone()).collect();
        let apart: Vec<Dyadic> = given.iter().zip(&exact).map(|(a, b)| a - b).collect();
        let still = IN_DOUBLES * AT_REST * self.static_size(dofs, multiplier);
        let still = &Dyadic::from(still) * scale;
        let mut size = larger(square(&given), &still * &still);
        if or_exact {
            size = larger(size, square(&exact));
        }
        let rounding = &Dyadic::from(self.rounding(dofs)) * scale;
        let explained = if size.is_zero() { 0.0 } else { root_of_ratio(&(&rounding * &rounding), &size) };
        Relative { error: square(&apart), size, explained }
    }

    /// The largest force divided by the root of the stiffness of its dof.
    fn static_size(&self, dofs: &[usize], multiplier: &[f64]) -> f64 {
        let pressed =
            |dof: usize| (0..self.case.rows()).map(|row| self.case.contact[row][dof] * multiplier[row]).sum::<f64>();
        let of_dof = |&dof: &usize| match self.case.stiffness[dof][dof] {
            stiffness if stiffness > 0.0 => self.case.load[dof].abs().max(pressed(dof).abs()) / stiffness.sqrt(),
            _ => 0.0,
        };
        dofs.iter().map(of_dof).fold(0.0, f64::max)
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

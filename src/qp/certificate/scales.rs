//! The scales of an answer: the size of its norm, forces and energy for each part, and of each dof and row by itself.

use crate::qp::problem::{ContactProblem, Parts};

/// A part is at rest except for rounding if its energy norm is below this share of what its forces could do to a single dof.
const AT_REST: f64 = 1e-6;

/// The scales that the errors of an answer are measured against.
pub(super) struct Scales {
    /// Part of each row; 0 for a row without dofs.
    part_of_row: Vec<usize>,
    /// `1 / sqrt(K_ii)` of each dof; infinite for a dof without stiffness.
    softness: Vec<f64>,
    /// `max |b_ij| / sqrt(K_jj)` of each row, over the dofs with stiffness: the force of the row in units of energy norm, and
    /// the distance by which a shift of unit energy norm of a single dof moves it.
    pub reach: Vec<f64>,
    /// `true` if the part has stiffness. The error of a part without stiffness has no energy, and rows alone judge it.
    pub is_stiff: Vec<bool>,
    /// Energy norm of each part, from `u_p' K_pp u_p`.
    pub norm: Vec<f64>,
    /// `max |F_i| / sqrt(K_ii)` of each part over loads and contact forces F: the energy norm that they could give a single
    /// dof.
    pub force: Vec<f64>,
    /// The larger of the strain energy, the work of the load, and the work of the gaps, of each part.
    pub energy: Vec<f64>,
}

/// The forces and energy of an answer, from which its scales follow.
pub(super) struct Forces<'a> {
    pub displacement: &'a [f64],
    pub multiplier: &'a [f64],
    /// B' lambda.
    pub contact: &'a [f64],
    /// u' K u.
    pub strain: f64,
}

/// The larger of two numbers; NaN is larger than all.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// `value / scale`, with 0 / 0 = 0.
pub(super) fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}

impl Scales {
    /// The scales of an answer to `problem`.
    pub fn of(problem: &ContactProblem, parts: &Parts, forces: &Forces) -> Self {
        let Forces { displacement: u, multiplier, contact, strain } = *forces;
        let softness: Vec<f64> = problem.diagonal().roots.iter().map(|root| 1.0 / root).collect();
        let (mut reach, mut part_of_row) = (vec![0.0; problem.rows()], vec![0; problem.rows()]);
        for (dof, &soft) in softness.iter().enumerate() {
            for (row, b) in problem.contact.column(dof).filter(|entry| entry.1 != 0.0) {
                part_of_row[row] = parts.of_dof(dof);
                if soft.is_finite() {
                    reach[row] = f64::max(reach[row], b.abs() * soft);
                }
            }
        }
        let (mut force, mut is_stiff) = (vec![0.0; parts.count()], vec![false; parts.count()]);
        for dof in (0..u.len()).filter(|&dof| softness[dof].is_finite()) {
            is_stiff[parts.of_dof(dof)] = true;
            let largest = larger(problem.load[dof].abs(), contact[dof].abs());
            let of_part = &mut force[parts.of_dof(dof)];
            *of_part = larger(largest * softness[dof], *of_part);
        }
        let strain = if parts.count() == 1 { vec![strain] } else { problem.energies(parts, u) };
        let norm: Vec<f64> = strain.iter().map(|energy| energy.max(0.0).sqrt()).collect();
        let load_work = parts.sums(|dof| u[dof] * problem.load[dof]);
        let mut gap_work = vec![0.0; parts.count()];
        for row in (0..problem.rows()).filter(|&row| multiplier[row] != 0.0 && problem.gap[row].is_finite()) {
            gap_work[part_of_row[row]] += problem.gap[row] * multiplier[row];
        }
        let energy = |part: usize| {
            let at_rest = AT_REST * force[part].powi(2);
            larger(norm[part].powi(2) / 2.0, larger(load_work[part].abs(), larger(gap_work[part].abs(), at_rest / 2.0)))
        };
        let energy = (0..parts.count()).map(energy).collect();
        Scales { part_of_row, softness, reach, is_stiff, norm, force, energy }
    }

    /// The part of a row.
    pub fn part_of_row(&self, row: usize) -> usize {
        self.part_of_row[row]
    }

    /// The energy norm of a part, or, if it is at rest, a millionth of what its forces could do.
    pub fn size(&self, part: usize) -> f64 {
        larger(self.norm[part], AT_REST * self.force[part])
    }

    /// The energy norm of all parts together, or its substitute if all are at rest.
    pub fn size_of_whole(&self, strain: f64) -> f64 {
        let force = self.force.iter().fold(0.0, |largest, &force| larger(force, largest));
        larger(strain.max(0.0).sqrt(), AT_REST * force)
    }

    /// The largest `force(dof)`, relative to those that act on its part; on a dof without stiffness, to `own(dof)`, those on
    /// the dof.
    pub fn largest_force(&self, parts: &Parts, force: impl Fn(usize) -> f64, own: impl Fn(usize) -> f64) -> f64 {
        let (mut of_parts, mut without_stiffness) = (vec![0.0; self.force.len()], 0.0);
        for (dof, soft) in self.softness.iter().enumerate() {
            let force = force(dof).abs();
            if soft.is_finite() {
                let of_part = &mut of_parts[parts.of_dof(dof)];
                *of_part = larger(force * soft, *of_part);
            } else {
                without_stiffness = larger(relative(force, own(dof)), without_stiffness);
            }
        }
        let of_parts = of_parts.iter().zip(&self.force).map(|(&force, &scale)| relative(force, scale));
        of_parts.fold(without_stiffness, |largest, share| larger(share, largest))
    }
}

impl ContactProblem {
    /// `w_p' K_pp w_p` of each part p: twice its energy under the displacement w, without couplings to other parts.
    pub(super) fn energies(&self, parts: &Parts, w: &[f64]) -> Vec<f64> {
        let within = |column: usize| {
            let of_part = move |entry: &(usize, f64)| parts.of_dof(entry.0) == parts.of_dof(column);
            self.stiffness.lower().column(column).filter(of_part)
        };
        self.unrounded_product(within, w).products_by(w, |dof| parts.of_dof(dof), parts.count())
    }
}

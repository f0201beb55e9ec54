//! The scales of an answer: the size of its norm for each part, the forces on each part, and the reach of each row.

use crate::linear::Accumulator;
use crate::problem::{Balance, ContactProblem};

/// The scales that the errors of an answer are measured against.
pub struct Scales {
    /// The least reach of each row: the distance by which a shift of unit energy norm of a single dof moves it.
    pub reach: Vec<f64>,
    pub of_parts: Vec<OfPart>,
    pub whole: OfPart,
}

#[derive(Clone, Copy, Default)]
pub struct OfPart {
    /// `true` if the part has stiffness. The error of a part without stiffness has no energy, and rows alone judge it.
    pub is_stiff: bool,
    /// `true` if a dof with stiffness moves.
    pub moves: bool,
    /// `u_p' K_pp u_p`.
    pub strain: f64,
    /// The sum of `|u_i| (|K| |u|)_i`, the terms of the strain.
    pub terms: f64,
    /// `max |F_i| / sqrt(K_ii)` over loads, contact forces and couplings to other parts F.
    pub force: f64,
    /// Sums of the squares `F_i^2 / K_ii`, of all dofs, and of those at which couplings act, or rounding leaves forces
    /// out of balance that no row on this dof alone takes: a load on a wall says nothing of the error beside it. Each
    /// is that of all F, and of loads and elastic forces alone: contact forces that cancel may be of any size.
    pub squares: [[f64; 2]; 2],
}

/// The larger of two numbers; NaN is larger than all.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// `value / scale`, with 0 / 0 = 0.
pub fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value / scale }
}

impl Scales {
    /// The scales of an answer (u, lambda) in this balance, under the forces `applied`, `|f| + |B' lambda|`.
    pub fn of(problem: &ContactProblem, [u, multiplier]: [&[f64]; 2], balance: &Balance, applied: &[f64]) -> Self {
        let (parts, diagonal) = (problem.parts(), problem.diagonal());
        let strains = if parts.count() == 1 { vec![balance.strain] } else { energies(problem, true, u).0 };
        let mut of_parts = vec![OfPart::default(); parts.count()];
        let (couplings, is_taken) = (couplings(problem, u, applied), taken_alone(problem, multiplier));
        for (dof, &root) in diagonal.roots.iter().enumerate() {
            let part = &mut of_parts[parts.of_dof[dof]];
            part.terms += u[dof].abs() * balance.terms[dof];
            if root > 0.0 {
                part.is_stiff = true;
                part.moves |= u[dof] != 0.0;
                let coupling = couplings.get(dof).copied().unwrap_or(0.0);
                let force = larger(applied[dof], coupling) / root;
                part.force = larger(force, part.force);
                let given = (larger(problem.load[dof].abs(), balance.elastic[dof]) / root).powi(2);
                let is_rounded = coupling > 0.0 || balance.residual[dof] != 0.0 && !is_taken[dof];
                for squares in &mut part.squares[..=usize::from(is_rounded)] {
                    *squares = [squares[0] + force * force, squares[1] + given];
                }
            }
        }
        of_parts.iter_mut().zip(&strains).for_each(|(part, &strain)| part.strain = strain);
        let square = |at: usize, of: usize| of_parts.iter().map(|part| part.squares[at][of]).sum();
        let whole = OfPart {
            is_stiff: true,
            moves: of_parts.iter().any(|part| part.moves),
            strain: balance.strain,
            terms: of_parts.iter().map(|part| part.terms).sum(),
            force: of_parts.iter().fold(0.0, |largest, part| larger(part.force, largest)),
            squares: [0, 1].map(|at| [0, 1].map(|of| square(at, of))),
        };
        Scales { reach: least_reach(problem), of_parts, whole }
    }

    /// The distance by which rounding of the forces on a `part` at rest could move a dof of a row; zero if it moves.
    pub fn rest_of_row(&self, row: usize, part: usize) -> f64 {
        let part = &self.of_parts[part];
        let rests = part.is_stiff && !part.moves;
        let [all, rounded] = part.squares.map(|[forces, given]| forces.min(given));
        if rests { self.reach[row] * part.rest(rounded, all) } else { 0.0 }
    }
}

/// A dof without stiffness and load, and a row with gap zero, have no scale of their own: rows give them one, which
/// they share with the dofs that they couple them to. The lengths of the rows; of those with gap zero at least those
/// that rows to dofs with stiffness give to their dofs without stiffness.
pub fn coupled_lengths(problem: &ContactProblem, own: Vec<f64>) -> Vec<f64> {
    let roots = &problem.diagonal().roots;
    if roots.iter().all(|&root| root > 0.0) {
        return own;
    }
    let counts = |&(row, dof, b): &(usize, usize, f64)| b != 0.0 && roots[dof] == 0.0 && problem.gap[row].is_finite();
    let entries = || problem.contact.triplets().filter(counts);
    let mut is_stiff = vec![false; problem.rows()];
    let stiff = problem.contact.triplets().filter(|&(_, dof, b)| b != 0.0 && roots[dof] > 0.0);
    stiff.for_each(|(row, ..)| is_stiff[row] = true);
    let mut of_dofs = vec![0.0; problem.dofs()];
    let known = entries().filter(|entry| is_stiff[entry.0]);
    known.for_each(|(row, dof, b)| of_dofs[dof] = larger(own[row] / b.abs(), of_dofs[dof]));
    let mut coupled = own;
    let without_scale = entries().filter(|entry| problem.gap[entry.0] == 0.0);
    without_scale.for_each(|(row, dof, b)| coupled[row] = larger(b.abs() * of_dofs[dof], coupled[row]));
    coupled
}

/// The forces that balance on each dof; without stiffness and load at least those that rows pass on from stiff dofs.
pub fn balanced_forces(problem: &ContactProblem, own: Vec<f64>) -> Vec<f64> {
    let roots = &problem.diagonal().roots;
    if roots.iter().all(|&root| root > 0.0) {
        return own;
    }
    let entries = |is_stiff: bool| {
        problem.contact.triplets().filter(move |&(_, dof, b)| b != 0.0 && (roots[dof] > 0.0) == is_stiff)
    };
    let mut of_rows = vec![0.0; problem.rows()];
    entries(true).for_each(|(row, dof, b)| of_rows[row] = larger(own[dof] / b.abs(), of_rows[row]));
    let mut balanced = own;
    let without_scale = entries(false).filter(|entry| problem.load[entry.1] == 0.0);
    without_scale.for_each(|(row, dof, b)| balanced[dof] = larger(b.abs() * of_rows[row], balanced[dof]));
    balanced
}

/// `true` for each dof on which a pressing row acts that acts on no other: its force takes what rounding leaves.
fn taken_alone(problem: &ContactProblem, multiplier: &[f64]) -> Vec<bool> {
    let (mut dofs, mut is_taken) = (vec![0_u32; problem.rows()], vec![false; problem.dofs()]);
    let count = |dofs: &mut u32, b: f64| *dofs += u32::from(b != 0.0);
    (0..problem.dofs()).for_each(|dof| problem.contact.with_rows(dof, &mut dofs, count));
    let is_alone = |row: usize| dofs[row] == 1 && multiplier[row] != 0.0;
    if (0..problem.rows()).any(is_alone) {
        let alone = problem.contact.triplets().filter(|&(row, _, b)| b != 0.0 && is_alone(row));
        alone.for_each(|(_, dof, _)| is_taken[dof] = true);
    }
    is_taken
}

/// `w_p' K_pp w_p` of each part p, or of the whole: twice its energy under the displacement w, without couplings to
/// other parts; and `|w|' |K| |w|` of each, the scale of its rounding in twice the working precision.
pub fn energies(problem: &ContactProblem, by_parts: bool, w: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let parts = problem.parts();
    let (group, count) =
        (|dof: usize| if by_parts { parts.of_dof[dof] } else { 0 }, if by_parts { parts.count() } else { 1 });
    let within =
        |column: usize| problem.stiffness.lower().column(column).filter(move |entry| group(entry.0) == group(column));
    let mut sums = Accumulator::new(&vec![0.0; w.len()]);
    let terms = sums.add_matrix_product(within, w);
    let mut magnitudes = vec![0.0; count];
    for (dof, (terms, w)) in terms.iter().zip(w).enumerate() {
        magnitudes[group(dof)] += terms * w.abs();
    }
    (sums.products_by(w, group, count), magnitudes)
}

/// The forces on each dof by other parts: by their displacements u, and those that `forces` could give each dof alone.
/// Empty for one part.
fn couplings(problem: &ContactProblem, u: &[f64], forces: &[f64]) -> Vec<f64> {
    let parts = problem.parts();
    if parts.count() == 1 {
        return Vec::new();
    }
    let diagonal = &problem.diagonal().values;
    let moved = |dof: usize| u[dof].abs() + if diagonal[dof] > 0.0 { forces[dof] / diagonal[dof] } else { 0.0 };
    let mut couplings = vec![0.0; problem.dofs()];
    for (row, column, value) in problem.stiffness.lower().triplets() {
        if parts.of_dof[row] != parts.of_dof[column] {
            couplings[row] += value.abs() * moved(column);
            couplings[column] += value.abs() * moved(row);
        }
    }
    couplings
}

/// Lower bounds on `sqrt(G_ii)` of every row: `max |b_ij| / sqrt(K_jj)`, the move by unit energy norm of a single dof.
pub fn least_reach(problem: &ContactProblem) -> Vec<f64> {
    let (roots, mut least) = (&problem.diagonal().roots, vec![0.0_f64; problem.rows()]);
    for (dof, &root) in roots.iter().enumerate().filter(|entry| *entry.1 > 0.0) {
        problem.contact().with_rows(dof, &mut least, |least, b| *least = least.max(b.abs() / root));
    }
    least
}

/// The sum over the entries b of each row of `of_entry(b^2, K_jj)`, the compliance of a row if its dofs stand alone.
pub fn compliance_of_rows(problem: &ContactProblem, of_entry: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let mut compliance = vec![0.0; problem.rows()];
    for (dof, &stiffness) in problem.diagonal().values.iter().enumerate() {
        problem.contact().with_rows(dof, &mut compliance, |sum, b| {
            if b != 0.0 {
                *sum += of_entry(b * b, stiffness);
            }
        });
    }
    compliance
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dof of stiffness 4 and one without, joined by a row with gap zero; the second has rows with gaps of 0 and 6.
    fn joined(load: f64) -> ContactProblem {
        let rows = [(0, 0, 2.0), (0, 1, -0.5), (1, 1, -3.0), (2, 1, -3.0)];
        ContactProblem::of_entries(&[(0, 0, 4.0)], &[10.0, load], &rows, &[0.0, 0.0, 6.0])
    }

    #[test]
    fn scales_are_the_squares_of_all_forces_and_of_given_ones_and_parts_act_on_each_other() {
        // At u = 2 the body of stiffness 4 takes 8 of the forces, 6 of which are given.
        let problem = ContactProblem::of_entries(&[(0, 0, 4.0)], &[6.0], &[], &[]);
        let balance = Balance { residual: vec![2.0], elastic: vec![8.0], strain: 16.0, terms: vec![8.0] };
        let scales = Scales::of(&problem, [&[2.0], &[]], &balance, &[10.0]);
        assert_eq!((scales.whole.squares, scales.whole.force), ([[25.0, 16.0]; 2], 5.0));
        let coupling = 2.0_f64.powi(-80);
        let entries = [(0, 0, 4.0), (1, 0, -coupling), (1, 1, 1.0)];
        let problem = ContactProblem::of_entries(&entries, &[0.0; 2], &[], &[]);
        assert_eq!(couplings(&problem, &[1.0, -2.0], &[8.0, 1.0]), [3.0 * coupling, 3.0 * coupling]);
        assert_eq!(couplings(&problem, &[0.0, -2.0], &[4.0, 0.0]), [2.0 * coupling, coupling]);
    }

    #[test]
    fn a_row_with_gap_zero_on_a_dof_without_stiffness_has_the_length_of_the_row_that_joins_the_dof_to_another() {
        // The first row moves the second dof by 8 over 1/2, which moves the second row by three times as much.
        assert_eq!(coupled_lengths(&joined(0.0), vec![8.0, 1e-31, 1e-31]), [8.0, 48.0, 1e-31]);
        // A row that is longer by itself stays as it is, and so does every row of a body with stiffness everywhere.
        assert_eq!(coupled_lengths(&joined(0.0), vec![8.0, 100.0, 0.0]), [8.0, 100.0, 0.0]);
        let stiff =
            ContactProblem::of_entries(&[(0, 0, 4.0), (1, 1, 1.0)], &[0.0; 2], &[(0, 0, 1.0), (1, 1, 1.0)], &[0.0; 2]);
        assert_eq!(coupled_lengths(&stiff, vec![8.0, 1e-31]), [8.0, 1e-31]);
    }

    #[test]
    fn forces_on_a_dof_without_stiffness_and_load_have_the_scale_of_the_dof_that_a_row_joins_it_to() {
        // A force of 10 on the first dof is 5 along the row, and 5/2 on the second.
        assert_eq!(balanced_forces(&joined(0.0), vec![10.0, 1e-33]), [10.0, 2.5]);
        assert_eq!(balanced_forces(&joined(1e-20), vec![10.0, 1e-20]), [10.0, 1e-20]);
    }
}

//! Random contact problems with few dofs, often degenerate or with extreme data, and a check of their answers.

use signorini::qp::Error;
use signorini::{ContactProblem, Solution, SparseMatrix, SymmetricMatrix, solve_qp};

use crate::draws::Draws;
use crate::oracles::exact::dyadic::Dyadic;

/// Tolerance of the recomputed conditions of an answer that is certified to 1e-9.
const HOLDS: f64 = 1e-7;

/// Relative rounding error of the forces that follow from a displacement.
const ROUNDING: f64 = 1e-14;

/// Share of the largest possible work of the forces that scales the energies of a body at rest, as in the certificate.
const AT_REST: f64 = 1e-6;

/// Makes a problem with a stiffness of any rank, rows that may be copies of each other, and numbers of any size.
pub fn problem(draws: &mut Draws) -> Result<ContactProblem, Error> {
    let (n, m) = (1 + draws.below(6), draws.below(7));
    let rank = 1 + draws.below(n + 1);
    let factor: Vec<f64> = (0..n * rank).map(|_| if draws.below(3) == 0 { 0.0 } else { draws.signed() }).collect();
    let scale = if draws.below(4) == 0 { 2.0_f64.powi(draws.below(1200) as i32 - 600) } else { 1.0 };
    let mut stiffness = Vec::new();
    for i in 0..n {
        for j in 0..=i {
            let product: f64 = (0..rank).map(|k| factor[i * rank + k] * factor[j * rank + k]).sum();
            stiffness.push((i, j, scale * (product + if i == j && draws.below(2) == 0 { 0.1 } else { 0.0 })));
        }
    }
    let number = |draws: &mut Draws| match draws.below(12) {
        0 => 0.0,
        1 => draws.signed() * 1e-12,
        2 => draws.signed() * 1e12,
        _ => draws.signed(),
    };
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    let mut gap: Vec<f64> = Vec::new();
    for row in 0..m {
        if row > 0 && draws.below(6) == 0 {
            // A copy of another row, possibly scaled, with the opposite sign, or slightly changed.
            let of = draws.below(row);
            let factor = [1.0, -1.0, 2.0, -1e-3][draws.below(4)];
            let off = [0.0, 0.0, 1e-15, 1e-9, 1e-3][draws.below(5)] * draws.signed();
            rows.push(rows[of].iter().map(|&(dof, value)| (dof, value * factor * (1.0 + off))).collect());
            let distance = gap[of] * factor;
            gap.push(if distance.is_finite() { distance } else { 1.0 } + off);
            continue;
        }
        rows.push((0..1 + draws.below(2)).map(|_| (draws.below(n), number(draws))).collect());
        gap.push(if draws.below(10) == 0 { f64::INFINITY } else { number(draws) });
    }
    let contact: Vec<(usize, usize, f64)> =
        rows.iter().enumerate().flat_map(|(row, entries)| entries.iter().map(move |&(dof, b)| (row, dof, b))).collect();
    let load = (0..n).map(|_| scale * number(draws)).collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(n, n, &stiffness)?)?;
    ContactProblem::new(stiffness, load, SparseMatrix::from_triplets(m, n, &contact)?, gap)
}

/// Solves a random problem. Returns the method of the answer or the code of the error. A certified answer that violates
/// a condition is an error.
pub fn ending(draws: &mut Draws) -> Result<String, String> {
    let problem = match problem(draws) {
        Ok(problem) => problem,
        Err(error) => return Ok(error.code().to_string()),
    };
    match solve_qp(&problem) {
        Err(error) => Ok(error.code().to_string()),
        Ok(solution) => match broken(&problem, &solution) {
            Some(condition) => {
                Err(format!("{condition} of a certified answer does not hold: {problem:?} {solution:?}"))
            }
            None => Ok(solution.method),
        },
    }
}

/// `u' K u`, rounded once: its terms may cancel.
fn energy(problem: &ContactProblem, u: &[f64]) -> f64 {
    let terms = problem.stiffness().lower().triplets().map(|(i, j, value)| {
        let term = &(&Dyadic::from(value) * &Dyadic::from(u[i])) * &Dyadic::from(u[j]);
        if i == j { term } else { term.ldexp(1) }
    });
    terms.fold(Dyadic::ZERO, |sum, term| &sum + &term).to_f64().max(0.0)
}

/// Recomputes the conditions of an answer, and returns the first one that does not hold.
fn broken(problem: &ContactProblem, solution: &Solution) -> Option<&'static str> {
    let (u, lambda) = (&solution.displacement, &solution.multiplier);
    let largest = |values: &[f64]| values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
    let moved = problem.contact().mul(u);
    let pressed = problem.contact().mul_transposed(lambda);
    let force = largest(problem.load()).max(largest(&pressed));
    let within = problem.stiffness().mul(u);
    // Multipliers are rounded as well; those of opposed rows may be far larger than their sum.
    let of_contact = problem.contact().mul_abs_transposed(lambda);
    let terms: Vec<f64> = problem.stiffness().mul_abs(u).iter().zip(of_contact).map(|(a, b)| a + b).collect();
    // A residual force is scaled by the energy that it causes in its own dof.
    let diagonal = problem.stiffness().diagonal();
    let counts = |dof: usize, force: f64| if diagonal[dof] > 0.0 { force.abs() / diagonal[dof].sqrt() } else { 0.0 };
    let strong = (0..problem.dofs())
        .map(|dof| counts(dof, problem.load()[dof]).max(counts(dof, pressed[dof])))
        .fold(0.0, f64::max);
    let balanced = |dof: usize| {
        let residual = within[dof] - problem.load()[dof] - pressed[dof];
        let rest = (residual.abs() - ROUNDING * terms[dof]).max(0.0);
        rest <= HOLDS * force || (diagonal[dof] > 0.0 && counts(dof, rest) <= HOLDS * strong)
    };
    if !(0..problem.dofs()).all(balanced) {
        return Some("equilibrium");
    }
    let stiffness = largest(&problem.stiffness().diagonal());
    let still = if stiffness > 0.0 { force / stiffness } else { 0.0 };
    let strongest = largest(lambda);
    let lengths = problem.contact().mul_abs(u);
    // The largest distance by which the energy of the displacement could move a row through a single dof.
    let energy = energy(problem, u);
    let of_load: f64 = u.iter().zip(problem.load()).map(|(u, f)| u * f).sum();
    let of_gap: f64 = (lambda.iter().zip(problem.gap())).filter(|entry| *entry.0 != 0.0).map(|(l, g)| l * g).sum();
    // The energies of a body at rest are scaled by the work that its forces could do.
    let work = energy.max(of_load.abs()).max(of_gap.abs()).max(AT_REST * strong * strong);
    let length = energy.sqrt().max(AT_REST * strong);
    let mut soft = vec![0.0_f64; problem.rows()];
    for (dof, &stiffness) in problem.stiffness().diagonal().iter().enumerate().filter(|entry| *entry.1 > 0.0) {
        problem
            .contact()
            .column(dof)
            .for_each(|(row, b)| soft[row] = soft[row].max(b.abs() * length / stiffness.sqrt()));
    }
    (0..problem.rows()).find_map(|row| {
        let gap = problem.gap()[row];
        let touched = if lambda[row] != 0.0 || moved[row] > gap { gap.abs() } else { 0.0 };
        let reach = largest(&moved).max(touched).max(still);
        let distance = moved[row] - gap;
        // A row that a tiny motion of a dof moves far has a distance in that scale, open or violated.
        let is_closed = distance.abs() <= (ROUNDING * lengths[row]).max(HOLDS * soft[row]);
        let product = if lambda[row] == 0.0 || is_closed { 0.0 } else { (lambda[row] * distance).abs() };
        let conditions = [
            ("no penetration", distance <= HOLDS * reach.max(lengths[row]).max(gap.abs()).max(soft[row])),
            ("compression", lambda[row] <= HOLDS * strongest),
            ("complementarity", product <= HOLDS * (strongest * reach).max(work)),
        ];
        conditions.into_iter().find(|condition| !condition.1).map(|condition| condition.0)
    })
}

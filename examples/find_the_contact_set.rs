//! How the contact set is found: the active-set loop from no closed row, step by step.
//!
//! A string of 40 springs hangs over a bench; each line shows the rows that the loop took to be closed in one of its steps. A row
//! closes where the string would pass the bench, and opens where the bench would have to pull.

use signorini::{ContactProblem, Error, Method, Settings, SparseMatrix, SymmetricMatrix, solve};

fn main() -> Result<(), Error> {
    let dofs = 39;
    let below = |i: usize| (i + 1 < dofs).then_some((i + 1, i, -1.0));
    let entries: Vec<_> = (0..dofs).flat_map(|i| [Some((i, i, 2.0)), below(i)]).flatten().collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &entries)?)?;
    let identity: Vec<_> = (0..dofs).map(|i| (i, i, 1.0)).collect();
    let contact = SparseMatrix::from_triplets(dofs, dofs, &identity)?;
    // Downwards is positive: every node weighs 1, and the bench stands 50 below the ends.
    let problem = ContactProblem::new(stiffness, vec![1.0; dofs], contact, vec![50.0; dofs])?;

    let solution = solve(&problem, &Settings::with_method(Method::ActiveSet))?;
    for (number, step) in solution.history.iter().enumerate() {
        let row = |i: usize| if step.contact_set.contains(i) { '#' } else { '.' };
        println!("{number:2}  {}", (0..dofs).map(row).collect::<String>());
    }

    // The free string falls in a parabola, and leaves the bench where it is level with it: d nodes from its end, d^2 / 2 = 50.
    let closed: Vec<usize> = solution.contact_set.iter().collect();
    assert_eq!(closed, (9..=29).collect::<Vec<_>>());
    assert!(closed.iter().all(|&row| solution.multiplier[row] <= 0.0));
    // All the weight is carried by the two ends and the bench.
    let ends = solution.displacement[0] + solution.displacement[dofs - 1];
    let bench: f64 = solution.multiplier.iter().map(|lambda| -lambda).sum();
    assert!((ends + bench - dofs as f64).abs() < 1e-12);
    Ok(())
}

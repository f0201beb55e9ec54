//! Shows how the active-set method finds the contact set, step by step, beginning without a closed row.
//!
//! A string of 40 springs hangs above a bench. Each line shows the closed rows of one step. A row closes if the string
//! would pass the bench there, and opens if the bench would have to pull.

use signorini::{ContactProblem, Error, Method, Settings, SparseMatrix, SymmetricMatrix, solve};

fn main() -> Result<(), Error> {
    let dofs = 39;
    let below = |i: usize| (i + 1 < dofs).then_some((i + 1, i, -1.0));
    let entries: Vec<_> = (0..dofs).flat_map(|i| [Some((i, i, 2.0)), below(i)]).flatten().collect();
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(dofs, dofs, &entries)?)?;
    let identity: Vec<_> = (0..dofs).map(|i| (i, i, 1.0)).collect();
    let contact = SparseMatrix::from_triplets(dofs, dofs, &identity)?;
    // Downwards is positive. Every node weighs 1, and the bench is 50 below the ends.
    let problem = ContactProblem::new(stiffness, vec![1.0; dofs], contact, vec![50.0; dofs])?;

    let solution = solve(&problem, &Settings::with_method(Method::ActiveSet))?;
    for (number, step) in solution.history.iter().enumerate() {
        let row = |i: usize| if step.contact_set.contains(i) { '#' } else { '.' };
        println!("{number:2}  {}", (0..dofs).map(row).collect::<String>());
    }

    // The free part of the string is a parabola that meets the bench tangentially, d nodes from its end, with d^2 / 2 =
    // 50.
    let closed: Vec<usize> = solution.contact_set.iter().collect();
    assert_eq!(closed, (9..=29).collect::<Vec<_>>());
    assert!(closed.iter().all(|&row| solution.multiplier[row] <= 0.0));
    // The two ends and the bench carry the whole weight.
    let ends = solution.displacement[0] + solution.displacement[dofs - 1];
    let bench: f64 = solution.multiplier.iter().map(|lambda| -lambda).sum();
    assert!((ends + bench - dofs as f64).abs() < 1e-12);
    Ok(())
}

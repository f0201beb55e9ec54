//! Verifies an answer from elsewhere: recomputes every condition, bounds the error, and proves rows open or closed.

use signorini::{ContactProblem, Error, SparseMatrix, SymmetricMatrix};

fn main() -> Result<(), Error> {
    // Two springs of stiffness 2 and 1 in a row. The end is pushed with force 3 against a wall at distance 1.
    let stiffness = SparseMatrix::from_triplets(2, 2, &[(0, 0, 3.0), (1, 0, -1.0), (1, 1, 1.0)])?;
    let contact = SparseMatrix::from_triplets(1, 2, &[(0, 1, 1.0)])?;
    let problem = ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, vec![0.0, 3.0], contact, vec![1.0])?;

    // The exact answer is u = (1/3, 1), lambda = -7/3. The displacement of this one has an error of 1/1500.
    let (displacement, multiplier) = ([0.334, 1.0], [-7.0 / 3.0]);
    let certificate = problem.certify(&displacement, &multiplier)?;
    for (condition, value) in certificate.conditions() {
        println!("{condition:16} {value:.1e}");
    }
    println!("{:16} {:.1e}", "error bound", certificate.energy_error_bound);
    assert!(!certificate.meets(1e-9) && certificate.meets(1e-2));

    // The true error is d = (1/1500, 0). In the energy norm |d| = sqrt(d'K d) it is sqrt(3)/1500, which is then made
    // relative.
    let error = 3.0_f64.sqrt() / 1500.0;
    let size = (3.0 * 0.334_f64.powi(2) - 2.0 * 0.334 + 1.0).sqrt();
    assert!(certificate.energy_error_bound >= error / size * (1.0 - 1e-12));
    assert!(certificate.energy_error_bound <= error / size * 1.01);

    // An error this small cannot open a row that carries a force of 7/3.
    let proven = problem.prove(&displacement, &multiplier)?;
    assert!(proven.is_some_and(|proven| proven.closed.contains(0)));
    Ok(())
}

//! Solves two springs in front of a wall without a scene: K, f, B and g are written by hand.
//!
//! ```text
//! |--/\/\/--o--/\/\/--o  F ->   | wall at distance g
//!     k1    u0   k2   u1
//! ```
//!
//! In closed form, if the wall is reached: u1 = g, u0 = k2 g / (k1 + k2), lambda = k2 (u1 - u0) - F.

use signorini::{ContactProblem, Error, SparseMatrix, SymmetricMatrix, solve_qp};

fn main() -> Result<(), Error> {
    let (k1, k2, force, gap) = (2.0, 1.0, 3.0, 1.0);
    let stiffness = SparseMatrix::from_triplets(2, 2, &[(0, 0, k1 + k2), (1, 0, -k2), (1, 1, k2)])?;
    let contact = SparseMatrix::from_triplets(1, 2, &[(0, 1, 1.0)])?;
    let problem = ContactProblem::new(SymmetricMatrix::from_lower(stiffness)?, vec![0.0, force], contact, vec![gap])?;

    let solution = solve_qp(&problem)?;
    println!("u      = {:?}", solution.displacement);
    println!("lambda = {:?}", solution.multiplier);
    println!("{:#?}", solution.certificate);

    assert!((solution.displacement[0] - k2 * gap / (k1 + k2)).abs() < 1e-15);
    assert!((solution.multiplier[0] - (k2 * (gap - k2 * gap / (k1 + k2)) - force)).abs() < 1e-15);
    Ok(())
}

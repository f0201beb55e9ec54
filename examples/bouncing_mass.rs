//! Contact in time: a mass of 1 on a spring of stiffness 1 bounces against a wall.
//!
//! The mass is released at u = -1; the wall is at u = 0.5. Before the impact u = -cos t, so that the mass reaches the
//! wall at t = 2 pi / 3 with the velocity sin t. It rebounds with the same speed, and is back at u = -1 after twice
//! that time.

use std::f64::consts::PI;

use signorini::motion::{DynamicProblem, Integrator, Scheme};
use signorini::{ContactProblem, Error, Settings, SparseMatrix, SymmetricMatrix};

fn main() -> Result<(), Error> {
    let one = || SymmetricMatrix::from_lower(SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)])?);
    let wall = SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)])?;
    let contact = ContactProblem::new(one()?, vec![0.0], wall, vec![0.5])?;
    let problem = DynamicProblem::new(contact, one()?)?.starting_from(vec![-1.0], vec![0.0])?;

    let period = 4.0 * PI / 3.0;
    let steps = 4000;
    let scheme = Scheme::CentralDifference { restitution: 1.0 };
    let mut integrator = Integrator::new(problem, scheme, period / steps as f64, &Settings::default())?;
    let mut largest = f64::NEG_INFINITY;
    for step in 1..=steps {
        let state = integrator.advance()?;
        largest = largest.max(state.displacement[0]);
        if step % 400 == 0 {
            println!(
                "t {:5.3}  u {:7.4}  v {:7.4}",
                integrator.time(),
                integrator.state().displacement[0],
                integrator.state().velocity[0]
            );
        }
    }
    // The mass never passed the wall, and it is back at its starting point.
    assert!(largest <= 0.5 + 1e-12, "{largest}");
    assert!((integrator.state().displacement[0] + 1.0).abs() < 1e-2);
    Ok(())
}

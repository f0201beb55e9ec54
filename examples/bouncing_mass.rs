//! Contact in time: a mass of 1 on a spring of 1 swings between a wall and its own amplitude.
//!
//! It is let go at u = -1; the wall stands at u = 0.5. Without the wall u = -cos t: it arrives at t = 2 pi / 3 with the velocity
//! sin t, is thrown back as fast, and is where it started at twice that time.

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
    // It never passed the wall, and it is back where it began.
    assert!(largest <= 0.5 + 1e-12, "{largest}");
    assert!((integrator.state().displacement[0] + 1.0).abs() < 1e-2);
    Ok(())
}

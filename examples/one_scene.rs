//! Reads a scene with body, supports and obstacle from a JSON file, and prints its contact pressures and contact force.
//!
//! A block of 1 m x 0.5 m is clamped at its bottom, and a parabola is pressed 0.01 m into its top.

use signorini::{Error, Scene, Settings, solve};

fn main() -> Result<(), Error> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/indentation.json");
    let model = Scene::read(path)?.build()?;
    let solution = solve(model.problem(), &Settings::default().with_proof())?;

    let pressure = model.pressure(&solution.multiplier)?;
    println!("   x [m]  pressure [Pa]");
    for row in &solution.contact_set {
        println!("{:8.3} {:14.0}", model.mesh().nodes()[model.rows()[row].node][0], pressure[row]);
    }
    let force = -solution.multiplier.iter().sum::<f64>();
    println!("force {force:.3} N per metre, error at most {:.1e} in energy", solution.certificate.energy_error_bound);

    // The block is symmetric about x = 0.5, and so is its contact; loads, supports and contact are in balance.
    let closed: Vec<usize> = solution.contact_set.iter().collect();
    assert_eq!(closed, (17..24).collect::<Vec<_>>());
    assert!((pressure[17] - pressure[23]).abs() < 1e-9 * pressure[20]);
    assert!(model.force_balance(&solution.displacement, &solution.multiplier)? < 1e-12);
    // Every row is proven closed or open in the exact solution on this mesh.
    assert!(solution.proven.is_some_and(|proven| proven.undecided().count() == 0));
    Ok(())
}

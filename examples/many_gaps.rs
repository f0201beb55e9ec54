//! Factorises a body once, solves it for many gaps, and finds every gap at which a node touches.

use signorini::{Error, Prepared, Scene, Settings};

fn main() -> Result<(), Error> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/indentation.json");
    let model = Scene::read(path)?.build()?;
    // The only factorisation of the body.
    let prepared = Prepared::new(model.problem(), &Settings::default())?;

    // The parabola is lowered by 0.01 m after the first touch. Each solve starts from the contact set of the previous
    // gap.
    let at = |depth: f64| model.problem().gap().iter().map(|gap| gap + 0.01 - depth).collect::<Vec<f64>>();
    let mut next = prepared.clone();
    for step in 1..=5 {
        let depth = 0.002 * f64::from(step);
        let boundary = next.boundary(&at(depth))?;
        println!("depth {depth:.3} m: {:2} nodes, {:8.1} N", boundary.contact_set.count(), boundary.contact_force());
        next = next.starting_from(boundary.contact_set);
    }

    // Between two gaps the answer is piecewise linear; its corners are the gaps at which a row closes or opens.
    let touching = prepared.path(&at(0.0), &at(0.01))?;
    for event in touching.events() {
        println!("node row {:2} changes at a depth of {:.6} m", event.row, 0.01 * event.at.max(0.0));
    }
    let last = touching.multiplier(1.0);
    let force: f64 = -last.iter().sum::<f64>();
    let exact = prepared.solve(&at(0.01))?;
    assert!((force + exact.multiplier.iter().sum::<f64>()).abs() < 1e-9 * force);
    assert_eq!(touching.contact_set(1.0), exact.contact_set);
    Ok(())
}

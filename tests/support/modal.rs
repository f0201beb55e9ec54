//! Natural vibrations of random scenes beside a dense solver.

use serde_json::Value;
use signorini::fem::MassForm;
use signorini::scene::ModalAnalysis;
use signorini::{Scene, Settings};

use super::brackets::Draws;
use super::oracles::modes::eigenvalues;

/// Larger scenes take a dense solver minutes.
const MOST_DOFS: usize = 900;

/// Eigenvalues, the squares of frequencies, may differ by this share of themselves.
pub const CLOSE: f64 = 1e-8;

/// A dense solver rounds to this share of its largest eigenvalue; zeros of it are as large.
pub const ROUNDING: f64 = 1e-12;

/// A scene beside its oracle.
pub enum Checked {
    /// It has no modes, or too many dofs, for this reason.
    Left(String),
    /// Its modes, the largest difference of an eigenvalue over what is allowed, and sentences on what is wrong.
    Compared { found: Box<ModalAnalysis>, off: f64, wrong: Vec<String> },
}

/// The scene with a density between 0.5 and 2 for each material without one.
fn with_densities(scene: &Scene, draws: &mut Draws) -> Scene {
    fn visit(value: &mut Value, draws: &mut Draws) {
        match value {
            Value::Object(fields) => {
                if (fields.contains_key("poisson") || fields.contains_key("orthotropic"))
                    && !fields.contains_key("shear")
                {
                    fields.entry("density").or_insert_with(|| draws.between(0.5, 2.0).into());
                }
                fields.values_mut().for_each(|value| visit(value, draws));
            }
            Value::Array(values) => values.iter_mut().for_each(|value| visit(value, draws)),
            _ => {}
        }
    }
    let mut value = serde_json::to_value(scene).expect("a scene is JSON");
    visit(&mut value, draws);
    let parsed: Scene = serde_json::from_value(value).expect("a scene");
    Scene { folder: scene.folder.clone(), ..parsed }
}

/// The first `count` modes of a scene, compared with all of a dense solver.
///
/// # Panics
/// If the scene with densities is none.
pub fn checked(scene: &Scene, count: usize, seed: u64) -> Checked {
    let scene = with_densities(scene, &mut Draws::new(seed));
    let found = match scene.modal_analysis(count, &Settings::default()) {
        Ok(found) => found,
        Err(error) => return Checked::Left(error.code().to_string()),
    };
    let (model, mut wrong) = (found.answer.model().clone(), Vec::new());
    let problem = model.problem();
    if problem.dofs() > MOST_DOFS {
        return Checked::Left("too many dofs for the oracle".into());
    }
    let mass = model.mass(MassForm::Consistent).expect("densities");
    let ties = problem.inequalities()..problem.inequalities() + problem.equality_rows();
    let values = |closed: &mut dyn Iterator<Item = usize>| {
        let held: Vec<usize> = closed.chain(ties.clone()).collect();
        eigenvalues(problem.stiffness(), &mass, (problem.contact(), &held), count)
    };
    let mut off = 0.0_f64;
    let mut compare = |frequencies: &mut dyn Iterator<Item = f64>, exact: &[f64], what: &str| {
        let largest = exact.last().copied().unwrap_or(0.0);
        let mut number = 0;
        for frequency in frequencies {
            let (value, exact) =
                ((std::f64::consts::TAU * frequency).powi(2), exact.get(number).copied().unwrap_or(f64::NAN));
            let difference = (value - exact).abs();
            let allowed = CLOSE * exact.abs() + ROUNDING * largest;
            if difference.is_nan() || difference > allowed {
                wrong.push(format!("{what}, mode {number}: {value:e} and {exact:e}, largest {largest:e}"));
            }
            off = off.max(difference / allowed);
            number += 1;
        }
        if number < count.min(exact.len()) {
            wrong.push(format!("{what}: {number} modes of {}", count.min(exact.len())));
        }
    };
    let exact = values(&mut found.closed.iter().copied());
    compare(&mut found.modes.iter().map(|mode| mode.frequency), &exact, "closed");
    if !found.undecided.is_empty() {
        let exact = values(&mut found.closed.iter().copied().filter(|row| !found.undecided.contains(row)));
        compare(&mut found.modes.iter().filter_map(|mode| mode.frequency_open), &exact, "open");
        if found.modes.iter().any(|mode| mode.frequency_open.is_some_and(|open| open > mode.frequency * (1.0 + 1e-9))) {
            wrong.push("a frequency with open rows is above that with closed rows".into());
        }
    }
    if !found.is_complete {
        wrong.push("not complete".into());
    }
    let masses: Vec<f64> = (0..model.body().dimension())
        .map(|axis| found.modes.iter().map(|mode| mode.effective_mass[axis]).sum::<f64>())
        .collect();
    if masses.iter().any(|&sum| sum > found.mass * (1.0 + 1e-9)) {
        wrong.push(format!("effective masses {masses:?} of {}", found.mass));
    }
    Checked::Compared { found: Box::new(found), off, wrong }
}

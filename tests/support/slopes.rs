//! Derivatives of scenes against differences of whole answers inside one proven contact set.

use signorini::Scene;
use signorini::Settings;
use signorini::qp::{ContactSet, Derivative};
use signorini::scene::Sensitivities;

/// Steps of the differences, relative to the size of the parameter.
const STEPS: [f64; 4] = [1e-3, 1e-4, 1e-5, 1e-6];

/// A derivative beside its difference.
#[derive(Clone, Debug)]
pub struct Slope {
    pub output: String,
    pub parameter: String,
    pub verdict: &'static str,
    pub found: f64,
    /// The difference, and a bound on its own error; `None` if no step stays in one proven set.
    pub difference: Option<(f64, f64)>,
    /// The reason of an unknown derivative.
    pub why: String,
}

impl Slope {
    /// The difference from the derivative beyond the own error of the difference, relative to `size`.
    pub fn error(&self, size: f64) -> Option<f64> {
        let (difference, own) = self.difference?;
        Some(((self.found - difference).abs() - own).max(0.0) / size)
    }
}

fn solved(scene: &Scene, outputs: &[&str]) -> Option<(Vec<f64>, ContactSet)> {
    let found = scene.sensitivity(outputs, &[], &Settings::default()).ok()?;
    let Sensitivities { outputs, solution, .. } = found;
    let proven = solution.proven.as_ref()?;
    let is_decided = proven.undecided().next().is_none() || !outputs.is_empty();
    is_decided.then(|| (outputs.iter().map(|output| output.value).collect(), solution.contact_set))
}

/// All derivatives of `outputs` of a scene with respect to `parameters`, each beside its difference. `size` is a length of the body.
///
/// # Panics
/// If the scene has no answer.
pub fn slopes(scene: &Scene, outputs: &[&str], parameters: &[&str], size: f64) -> Vec<Slope> {
    let found = scene.sensitivity(outputs, parameters, &Settings::default()).unwrap();
    let mut all = Vec::new();
    for (place, &parameter) in parameters.iter().enumerate() {
        let value = found.outputs[0].by[place].value;
        let is_number = parameter != "nodes";
        let scale = if value != 0.0 && !parameter.contains("gap") { value.abs() } else { size };
        let differences = if is_number { differences(scene, outputs, parameter, value, scale) } else { None };
        for (index, output) in found.outputs.iter().enumerate() {
            let by = &output.by[place];
            let (found, why) = match &by.derivative {
                Derivative::Proven(value) => (*value, String::new()),
                Derivative::Unknown { why } => (f64::NAN, why.clone()),
                _ => (f64::NAN, String::new()),
            };
            all.push(Slope {
                output: output.output.clone(),
                parameter: parameter.to_string(),
                verdict: by.derivative.verdict(),
                found,
                difference: differences.as_ref().map(|differences| differences[index]),
                why,
            });
        }
    }
    all
}

/// The difference of each output, with a bound on its error: by the step at which two orders agree best.
fn differences(scene: &Scene, outputs: &[&str], name: &str, value: f64, scale: f64) -> Option<Vec<(f64, f64)>> {
    let (_, set) = solved(scene, outputs)?;
    let mut best: Option<Vec<(f64, f64)>> = None;
    for step in STEPS {
        let by = step * scale;
        let at = |factor: f64| {
            let varied = scene.with_parameter(name, value + factor * by).ok()?;
            solved(&varied, outputs).filter(|(_, other)| *other == set).map(|(values, _)| values)
        };
        let (Some(a), Some(b), Some(c), Some(d)) = (at(-2.0), at(-1.0), at(1.0), at(2.0)) else { continue };
        let of = |index: usize| {
            let (near, far) = ((c[index] - b[index]) / (2.0 * by), (d[index] - a[index]) / (4.0 * by));
            let rounding = 1e-13 * c[index].abs().max(b[index].abs()) / by;
            ((4.0 * near - far) / 3.0, (near - far).abs().powi(2) / near.abs().max(far.abs()).max(1e-300) + rounding)
        };
        let found: Vec<(f64, f64)> = (0..outputs.len()).map(of).collect();
        best = Some(match best {
            None => found,
            Some(before) => before.into_iter().zip(found).map(|(a, b)| if a.1 <= b.1 { a } else { b }).collect(),
        });
    }
    best
}

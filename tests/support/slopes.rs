//! Derivatives of scenes against differences of whole answers inside one proven contact set.

use signorini::qp::{ContactSet, Derivative};
use signorini::scene::Sensitivities;
use signorini::{Prepared, Scene, Settings};

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

/// All derivatives of `outputs` of a scene with respect to `parameters`, each beside its difference. `size` is a length
/// of the body.
///
/// # Panics
/// If the scene has no answer.
pub fn slopes(scene: &Scene, outputs: &[&str], parameters: &[&str], size: f64) -> Vec<Slope> {
    let found = scene.sensitivity(outputs, parameters, &Settings::default()).unwrap();
    let mut all = Vec::new();
    let of_materials = |name: &str| {
        let alike = found.outputs[0].by.iter().filter(|by| by.parameter.ends_with(name));
        alike.fold(0.0, |most: f64, by| most.max(by.value))
    };
    // The stiffness against a change of volume.
    let stiffness = of_materials("young") / (1.0 - 2.0 * of_materials("poisson"));
    for (place, &parameter) in parameters.iter().enumerate() {
        let value = found.outputs[0].by[place].value;
        let is_number = parameter != "nodes";
        let scale = if value != 0.0 && !parameter.contains("gap") { value.abs() } else { size };
        let differences =
            if is_number { differences(scene, outputs, (parameter, value, scale), stiffness / size) } else { None };
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

/// The difference of each output with a parameter of this name, value and scale, with a bound on its error: that of the
/// two steps that agree best. `stress` is that of the body if it were strained by its largest displacement over its
/// size, per displacement: where nothing is strained, a stress is the rounding of terms of this size.
fn differences(
    scene: &Scene,
    outputs: &[&str],
    (name, value, scale): (&str, f64, f64),
    stress: f64,
) -> Option<Vec<(f64, f64)>> {
    let (_, set) = solved(scene, outputs)?;
    let displacement = outputs.iter().position(|name| *name == "largest-displacement");
    let largest = |values: &[f64]| displacement.map_or(0.0, |index| values[index]);
    let of_step = |step: f64| {
        let by = step * scale;
        let at = |factor: f64| {
            let varied = scene.with_parameter(name, value + factor * by).ok()?;
            solved(&varied, outputs).filter(|(_, other)| *other == set).map(|(values, _)| values)
        };
        let (a, b, c, d) = (at(-2.0)?, at(-1.0)?, at(1.0)?, at(2.0)?);
        let of = |index: usize| {
            let difference = (8.0 * (c[index] - b[index]) - (d[index] - a[index])) / (12.0 * by);
            // A component of a stress has the rounding of the whole stress.
            let (kind, _) = outputs[index].split_once(':').unwrap_or((outputs[index], ""));
            let alike = (0..outputs.len()).filter(|&other| outputs[other].starts_with(kind));
            let size = alike.fold(0.0, |size: f64, other| size.max(c[other].abs()).max(b[other].abs()));
            let of_rigid = match kind {
                "strain-energy" => stress * largest(&c).powi(2),
                kind if kind.starts_with("stress") => stress * largest(&c),
                _ => 0.0,
            };
            let size = size.max(of_rigid);
            (difference, 1e-12 * size / by)
        };
        Some((0..outputs.len()).map(of).collect::<Vec<(f64, f64)>>())
    };
    let steps: Vec<Vec<(f64, f64)>> = STEPS.into_iter().filter_map(of_step).collect();
    let of_output = |index: usize| {
        let pairs = steps.windows(2).map(|pair| {
            let [(wide, _), (narrow, rounding)] = [pair[0][index], pair[1][index]];
            (narrow, (narrow - wide).abs() + rounding)
        });
        pairs.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    (0..outputs.len()).map(of_output).collect()
}

/// The derivatives of a scene, and those that are wrong, or unknown without a reason of the output.
pub struct Found {
    pub all: Vec<Slope>,
    pub wrong: Vec<Slope>,
}

/// Largest error of a derivative beside its difference, relative to the difference.
const MOST: f64 = 1e-6;

/// Parameters of a scene that are compared, at most.
const MOST_PARAMETERS: usize = 14;

/// Reasons for which an output or a parameter has no derivative, by their beginnings.
const REASONS: [&str; 5] = [
    "nothing presses",
    "nothing moves",
    "scene, at `obstacles[0].shape",
    "no bound on the error",
    "contact alone holds the body",
];

/// The outputs of a scene, those at a place in its middle.
fn outputs(scene: &Scene) -> Vec<String> {
    let model = scene.build().unwrap();
    let (low, high) = model.mesh().extent();
    let dimension = model.mesh().dimension();
    let middle: Vec<String> = (0..dimension).map(|axis| (0.47 * low[axis] + 0.53 * high[axis]).to_string()).collect();
    let placed = |name: &String| name.replace(["X", "X,Y", "X,Y,Z"][dimension - 1], &middle.join(","));
    let named = scene.outputs().unwrap();
    let stresses = named.iter().filter(|name| name.starts_with("stress"));
    let equivalent = stresses.map(|name| placed(name).replace(":xx", ":von-mises"));
    named.iter().map(placed).chain(equivalent).collect()
}

/// The derivatives of all outputs of a scene with respect to its numbers, beside differences.
///
/// # Panics
/// If the scene has no answer.
pub fn wrong_slopes(scene: &Scene) -> Found {
    let (outputs, parameters) = (outputs(scene), scene.parameters());
    let outputs: Vec<&str> = outputs.iter().map(String::as_str).collect();
    let numbers = parameters.iter().map(String::as_str).filter(|name| *name != "nodes");
    let parameters: Vec<&str> = numbers.take(MOST_PARAMETERS).collect();
    let model = scene.build().unwrap();
    let all = slopes(scene, &outputs, &parameters, model.mesh().size());
    let is_wrong = |slope: &&Slope| {
        let size = slope.difference.map_or(0.0, |difference| difference.0.abs()).max(1e-300);
        let has_reason = REASONS.iter().any(|reason| slope.why.starts_with(reason));
        (slope.verdict == "unknown" && !has_reason) || slope.error(size).is_some_and(|error| error > MOST)
    };
    let wrong = all.iter().filter(is_wrong).cloned().collect();
    Found { all, wrong }
}

/// The largest difference of the derivatives of all multipliers and forces with respect to the gap of the scene from
/// the slope of the exact path around it, relative to the largest slope; `None` without a path along which rows keep
/// their directions, or at a kink.
///
/// # Panics
/// If the scene has no answer.
pub fn off_path(scene: &Scene) -> Option<f64> {
    let model = scene.build().unwrap();
    let problem = model.problem();
    let prepared = Prepared::new(problem, &Settings::default().with_proof()).ok()?;
    let gap = model.gap();
    let step = 1e-3 * model.mesh().size();
    let [before, after] =
        [-step, step].map(|by| model.with_gap(gap + by).ok().map(|model| model.problem().gap().to_vec()));
    let (before, after) = (before?, after?);
    let is_straight = problem.gap().iter().zip(before.iter().zip(&after)).all(|(&own, (a, b))| {
        let middle = 0.5 * (a + b);
        own == middle || (own - middle).abs() <= 1e-13 * own.abs().max(step)
    });
    let path = prepared.path(&before, &after).ok().filter(|_| is_straight)?;
    let solution = prepared.solve(problem.gap()).ok()?;
    let derivatives = prepared.derivatives(&solution).ok()?;
    let change = signorini::qp::Change::of_gap(
        before.iter().zip(&after).map(|(a, b)| if a == b { 0.0 } else { (b - a) / (2.0 * step) }).collect(),
        problem.dofs(),
    );
    let tangent = derivatives.tangent(&change).ok()?;
    let tangent = tangent.proven()?;
    let piece = path.pieces().iter().find(|piece| piece.from < 0.5 && 0.5 < piece.to)?;
    let [first, last] = [piece.from, piece.to].map(|t| path.multiplier_on(piece, t));
    let length = 2.0 * step * (piece.to - piece.from);
    let slopes: Vec<f64> = last.iter().zip(&first).map(|(b, a)| (b - a) / length).collect();
    let largest = slopes.iter().fold(0.0, |largest: f64, slope| largest.max(slope.abs()));
    // Multipliers at the ends of a short piece are close: their difference keeps fewer digits.
    let values = first.iter().chain(&last).fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let rounding = 1e-15 * values / length;
    let off = slopes.iter().zip(&tangent.multiplier).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
    (largest > 0.0 && rounding <= 1e-12 * largest).then(|| off / largest)
}

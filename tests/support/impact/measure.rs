//! One run of one scheme, compared with a closed form.

use serde_json::{Value, json};
use signorini::motion::{Integrator, Observation, Scheme, SchemeSpec};
use signorini::scene::{Dynamics, Model};
use signorini::study::MotionSummary;
use signorini::{Error, Scene, Settings, qp};
use std::fs;
use std::time::Instant;

/// A bar with a known motion.
pub struct Case {
    pub name: &'static str,
    /// Name of its scene file in `studies/impact`.
    pub scene: &'static str,
    /// Exact displacement at x and t.
    pub displacement: fn(f64, f64) -> f64,
    /// Times at which the first contact begins and ends.
    pub contact: [f64; 2],
    pub pressure: f64,
    /// Speed after the contact, if the bar flies away.
    pub rebound: Option<f64>,
    /// Reference length of the displacement error.
    pub reach: f64,
}

/// Share of the contact time that is left out at its beginning and at its end, because a wave front passes then.
const MARGIN: f64 = 0.1;

/// The results of one run of a scheme.
pub struct Run {
    pub scheme: Scheme,
    pub courant: f64,
    /// Root mean square of the displacement error over nodes and steps, divided by `reach` of the case.
    pub displacement_error: f64,
    /// Total time with a contact force, counted until half a contact time after the exact end of the contact.
    pub duration: f64,
    /// Mean and standard deviation of the pressure between the margins.
    pub pressure: [f64; 2],
    /// Impulse of the contact force until the same moment.
    pub impulse: f64,
    /// Mean velocity at that moment, positive against the direction of the initial flight.
    pub rebound: f64,
    /// Energy at the end and the largest energy, both divided by the energy at the start.
    pub energy: [f64; 2],
    pub penetration: f64,
    /// Largest force of a step, the largest mean force over a window of time, and over the time of a wave through a few
    /// cells.
    pub peaks: [f64; 3],
    /// Length of that window, in time.
    pub window: f64,
    pub history: Vec<Observation>,
}

/// A scene that was moved by a scheme.
pub struct Moved {
    pub scheme: &'static str,
    pub courant: f64,
    pub step: f64,
    pub summary: MotionSummary,
    /// Seconds of all steps.
    pub seconds: f64,
}

/// Moves a scene by a scheme, in steps of `courant` times the time of a wave through its smallest cell.
///
/// # Errors
/// Those of the scene and of the steps.
pub fn moved(scene: &Value, scheme: SchemeSpec, courant: f64) -> Result<Moved, Error> {
    let mut scene = scene.clone();
    scene["analysis"]["dynamic"]["scheme"] = json!(scheme);
    scene["analysis"]["dynamic"]["courant"] = json!(courant);
    let (_, dynamics, mut integrator) = set_up(&scene)?;
    let step = dynamics.step;
    let mut summary = MotionSummary::starting(&integrator.observe(), 0, dynamics.windows, step);
    let clock = Instant::now();
    for _ in 0..dynamics.steps {
        integrator.advance()?;
        summary.add(&integrator.observe(), &[]);
    }
    Ok(Moved { scheme: scheme.name(), courant, step, summary, seconds: clock.elapsed().as_secs_f64() })
}

/// The model of a scene, its motion, and an integrator at the start.
///
/// # Errors
/// Those of the scene and of the integrator.
pub fn set_up(scene: &Value) -> Result<(Model, Dynamics, Integrator), Error> {
    let scene: Scene = serde_json::from_value(scene.clone()).expect("a scene");
    let model = scene.build()?;
    let dynamics = scene.dynamics(&model)?.expect("a motion");
    let problem = dynamics.problem.clone();
    let integrator = Integrator::new(problem, dynamics.scheme, dynamics.step, &Settings::default())?;
    Ok((model, dynamics, integrator))
}

/// The scene of this name in `studies/impact`, with cells of its axes or of its zone of contact.
pub fn scene_of(name: &str, cells: usize) -> Value {
    let path = crate::root().join(format!("studies/impact/{name}.json"));
    let mut scene: Value = serde_json::from_str(&fs::read_to_string(path).expect("a scene")).expect("JSON");
    if let Some(rectangle) = scene["body"].get_mut("rectangle") {
        (rectangle["x"]["divisions"], rectangle["y"]["divisions"]) = (json!([cells]), json!([cells]));
    }
    if let Some(bar) = scene["body"].get_mut("bar") {
        bar["x"]["divisions"] = json!([cells]);
    }
    if let Some(disc) = scene["body"].get_mut("disc") {
        disc["zone"]["divisions"] = json!(cells);
    }
    scene
}

/// Runs `case` on `cells` cells. The time step is `courant` times the time that a wave takes through a cell.
pub fn run(case: &Case, scheme: SchemeSpec, courant: f64, cells: usize) -> Result<Run, Error> {
    with_value(case, scheme, None, courant, cells)
}

/// As [`run`], with a value of the parameter of the scheme, or its default.
pub fn with_value(
    case: &Case,
    scheme: SchemeSpec,
    value: Option<f64>,
    courant: f64,
    cells: usize,
) -> Result<Run, Error> {
    let mut scene = scene_of(case.scene, cells);
    scene["analysis"]["dynamic"]["scheme"] = json!(scheme);
    scene["analysis"]["dynamic"]["courant"] = json!(courant);
    let scene: Scene = serde_json::from_value(scene).expect("a scene");
    let model = scene.build()?;
    let Some(dynamics) = scene.dynamics(&model)? else {
        return Err(Error::Linear(qp::LinearError::Setting { name: "analysis", value: 0.0, allowed: "dynamic" }));
    };
    let mut integrator = Integrator::new(
        dynamics.problem,
        value.map_or(dynamics.scheme, |_| scheme.with(value)),
        dynamics.step,
        &Settings::default(),
    )?;
    let [begin, end] = case.contact;
    let after = end + (end - begin) / 2.0;
    let first = integrator.observe();
    let mut summary = MotionSummary::starting(&first, 0, dynamics.windows, dynamics.step);
    let mut until_then = summary.clone();
    let (mut history, mut squares, mut speed) = (vec![first], 0.0, 0.0);
    let ones = vec![1.0; integrator.problem().statics().dofs()];
    let inertia = integrator.problem().mass().mul(&ones);
    for _ in 0..dynamics.steps {
        integrator.advance()?;
        let (time, state) = (integrator.time(), integrator.state());
        let nodal = model.nodal_displacement(&state.displacement)?;
        let error = |(at, u): (&[f64; 3], &f64)| (u - (case.displacement)(at[0], time)).powi(2);
        squares += model.mesh().nodes().iter().zip(&nodal).map(error).sum::<f64>() / nodal.len() as f64;
        if time <= after {
            let momentum: f64 = inertia.iter().zip(&state.velocity).map(|(m, v)| m * v).sum();
            speed = -momentum / inertia.iter().sum::<f64>();
        }
        let seen = integrator.observe();
        summary.add(&seen, &[]);
        if time <= after {
            until_then.add(&seen, &[]);
        }
        history.push(seen);
    }
    let step = dynamics.step;
    // The force of a step belongs to the middle of the step.
    let middle = |seen: &Observation| seen.time - step / 2.0;
    let margin = MARGIN * (end - begin);
    let inside: Vec<f64> = history[1..]
        .iter()
        .filter(|seen| (begin + margin..=end - margin).contains(&middle(seen)))
        .map(|seen| seen.force)
        .collect();
    let mean = inside.iter().sum::<f64>() / inside.len() as f64;
    let spread = (inside.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / inside.len() as f64).sqrt();
    Ok(Run {
        scheme: dynamics.scheme,
        courant,
        displacement_error: (squares / dynamics.steps as f64).sqrt() / case.reach,
        duration: until_then.contact.duration,
        pressure: [mean, spread],
        impulse: until_then.contact.impulse,
        rebound: speed,
        energy: [
            integrator.observe().energy() / first.energy(),
            history.iter().map(Observation::energy).fold(0.0, f64::max) / first.energy(),
        ],
        penetration: history.iter().map(|seen| seen.penetration).fold(0.0, f64::max),
        peaks: [summary.contact.force_max, summary.contact.force_mean_max(), summary.contact.peak_force()],
        window: summary.window_steps() as f64 * step,
        history,
    })
}

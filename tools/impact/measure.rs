//! One run of one scheme, held against a closed form.

use signorini::internals::{AnalysisSpec, BodySpec};
use signorini::motion::SchemeSpec;
use signorini::motion::{Integrator, Observation, Scheme};
use signorini::study::MotionSummary;
use signorini::{Error, Scene, Settings};

/// A bar whose motion is known.
pub struct Case {
    pub name: &'static str,
    /// Its scene, a file in `tools/impact`.
    pub scene: &'static str,
    /// Displacement at x and t.
    pub displacement: fn(f64, f64) -> f64,
    /// Begin and end of the first contact.
    pub contact: [f64; 2],
    pub pressure: f64,
    /// Speed after the contact, where the bar flies.
    pub rebound: Option<f64>,
    /// What displacements are measured by.
    pub reach: f64,
}

/// Share of the contact that is left out at its beginning and at its end, where a wave front passes.
const MARGIN: f64 = 0.1;

/// What a run of a scheme came to.
pub struct Run {
    pub scheme: Scheme,
    pub courant: f64,
    /// Root of the mean square over nodes and steps, relative to the reach of the case.
    pub displacement_error: f64,
    /// Time with a contact force until half a contact after its end.
    pub duration: f64,
    /// Mean and standard deviation of the pressure between the margins.
    pub pressure: [f64; 2],
    /// Force times time until half a contact after its end.
    pub impulse: f64,
    /// Mean velocity then, against the direction of flight.
    pub rebound: f64,
    /// Energy at the end over energy at the start, and the largest on the way.
    pub energy: [f64; 2],
    pub penetration: f64,
    /// Largest force of a step, and the largest on the mean over the window of the motion.
    pub peaks: [f64; 2],
    /// That window, in time.
    pub window: f64,
    pub history: Vec<Observation>,
}

/// Runs `case` on `cells` cells with time steps of `courant` times the time of a wave through a cell.
pub fn run(case: &Case, scheme: SchemeSpec, courant: f64, cells: usize) -> Result<Run, Error> {
    with_value(case, scheme, None, courant, cells)
}

/// The same with a value of the parameter of the scheme, or its default.
pub fn with_value(
    case: &Case,
    scheme: SchemeSpec,
    value: Option<f64>,
    courant: f64,
    cells: usize,
) -> Result<Run, Error> {
    let path = format!("{}/tools/impact/{}.json", env!("CARGO_MANIFEST_DIR"), case.scene);
    let mut scene = Scene::read(path)?;
    if let BodySpec::Bar(bar) = &mut scene.body {
        bar.x.divisions = vec![cells];
    }
    if let Some(AnalysisSpec::Dynamic(spec)) = &mut scene.analysis {
        (spec.scheme, spec.courant) = (scheme, Some(courant));
    }
    let model = scene.build()?;
    let Some(dynamics) = scene.dynamics(&model)? else {
        return Err(Error::Setting { name: "analysis", value: 0.0, allowed: "dynamic" });
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
    let mut summary = MotionSummary::starting(&first, dynamics.window, dynamics.step);
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
        summary.add(&seen, dynamics.step);
        history.push(seen);
    }
    let step = dynamics.step;
    // The force of a step is that of its middle.
    let middle = |seen: &Observation| seen.time - step / 2.0;
    let margin = MARGIN * (end - begin);
    let inside: Vec<f64> = history[1..]
        .iter()
        .filter(|seen| (begin + margin..=end - margin).contains(&middle(seen)))
        .map(|seen| seen.force)
        .collect();
    let mean = inside.iter().sum::<f64>() / inside.len() as f64;
    let spread = (inside.iter().map(|p| (p - mean).powi(2)).sum::<f64>() / inside.len() as f64).sqrt();
    let until = || history[1..].iter().filter(|seen| seen.time <= after);
    Ok(Run {
        scheme: dynamics.scheme,
        courant,
        displacement_error: (squares / dynamics.steps as f64).sqrt() / case.reach,
        duration: until().filter(|seen| seen.force > 0.0).count() as f64 * step,
        pressure: [mean, spread],
        impulse: until().map(|seen| seen.force * step).sum(),
        rebound: speed,
        energy: [
            integrator.observe().energy() / first.energy(),
            history.iter().map(Observation::energy).fold(0.0, f64::max) / first.energy(),
        ],
        penetration: history.iter().map(|seen| seen.penetration).fold(0.0, f64::max),
        peaks: [summary.force_max, summary.force_mean_max()],
        window: summary.window_steps() as f64 * step,
        history,
    })
}

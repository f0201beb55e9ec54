//! The report of a motion, as text and as JSON.

use serde::{Serialize, Serializer};
use serde_json::json;

use super::report::{columns, entry, in_unit, plural, quantity, table, warnings_text};
use crate::text::printable;
use signorini_mechanics::scene::{Dynamics, Model};
use signorini_qp::Method;
use signorini_study::{MotionContact, MotionError, MotionSummary, RunSeconds, Status};

/// The interval over which the force is averaged.
const WINDOW: &str = "a fifth of the time that a pressure wave takes through the body";

/// What is printed for a peak that the mesh does not resolve.
const NOT_RESOLVED: &str = "the peak force is not resolved: its estimated error is more than a tenth of it";

/// The request and the result of a run: [`text`](Self::text) prints both.
#[derive(Debug)]
pub struct MotionReport<'a> {
    /// The scene at rest.
    pub model: &'a Model,
    /// The motion with its scheme, its step and its number of steps.
    pub dynamics: &'a Dynamics,
    /// Method of the contact problem of every step.
    pub method: Method,
    /// The steps so far.
    pub summary: &'a MotionSummary,
    /// The estimated errors of the numbers, if they were asked for.
    pub error: Option<MotionError>,
    /// Their cost in time.
    pub seconds: RunSeconds,
}

impl MotionReport<'_> {
    /// Unstable if the energy grew by more than the work of the loads. Certified if the contact problems of all steps
    /// are certified: not if springs replace closed rows, and not if the motion was cut short.
    pub fn status(&self) -> Status {
        if self.summary.is_unstable() {
            return Status::Unstable;
        }
        let is_whole = self.summary.steps >= self.dynamics.steps;
        match is_whole && !self.dynamics.scheme.penetrates() && !matches!(self.method, Method::Penalty(_)) {
            true => Status::Certified,
            false => Status::NotCertified,
        }
    }

    /// The report in lines of at most 100 characters.
    pub fn text(&self, title: &str) -> String {
        let MotionReport { model, dynamics, summary, .. } = self;
        let units = model.units();
        let mut text = format!("{}\n", printable(title));
        let mut line = |name: &str, content: String| text += &entry(name, &content);
        let (nodes, elements) = (model.mesh().nodes().len(), model.mesh().element_count());
        let (dofs, rows) = (model.problem().dofs(), plural(model.rows().len(), "contact row"));
        line("model", format!("{nodes} nodes, {elements} elements, {dofs} dofs, {rows}"));
        let parts = model.parts_of_whole();
        if parts > 1.0 {
            line("", format!("one of {parts} parts; forces and energies are those of the whole"));
        }
        line("status", self.status().words().into());
        let steps = plural(summary.steps, "step");
        line("motion", format!("{}, {steps} of {:.6e}", dynamics.scheme.name(), dynamics.step));
        let [all, most] = summary.penalties;
        if all > 0 {
            line("", format!("{all} penalties, at most {most} in a step"));
        }
        let several = summary.obstacles.len() > 1;
        match (summary.contact.first, summary.contact.last) {
            (Some(first), Some(last)) => {
                let contact = &summary.contact;
                line("contact", format!("from {first:.6e} to {last:.6e}, for {:.6e} in all", contact.duration));
                let (mean, window) = (contact.force_mean_max(), summary.window_steps() as f64 * dynamics.step);
                let over = format!("mean over {window:.6e} ({})", plural(summary.window_steps(), "step"));
                let peak = summary.peak_steps() as f64 * dynamics.step;
                let force = quantity(contact.peak_force(), &units.force);
                line("", format!("peak force {force}, over {peak:.6e} ({})", plural(summary.peak_steps(), "step")));
                if several {
                    obstacle_lines(model, summary).into_iter().for_each(|text| line("", text));
                    line("", format!("the {over},"));
                } else {
                    let force = quantity(contact.force_max, &units.force);
                    line("", format!("impulse {:.6e}, largest force {force} in one step,", contact.impulse));
                    line("", format!("{} on the {over}:", quantity(mean, &units.force)));
                }
                line("", WINDOW.into());
                if let Some(MotionError { peak_force, impulse, release, resolved }) = self.error {
                    let release = release.map_or(String::new(), |release| format!(", release {release:.1e}"));
                    let force = quantity(peak_force, &units.force);
                    line("", format!("estimated errors: peak force {force}, impulse {impulse:.1e}{release}"));
                    if !resolved {
                        line("", NOT_RESOLVED.into());
                    }
                }
            }
            _ => line("contact", "none".into()),
        }
        line("", format!("deepest penetration {}", quantity(summary.penetration_max, &units.length)));
        let energies = |[kinetic, strain, potential]: [f64; 3]| {
            format!("kinetic {kinetic:.6e}, strain {strain:.6e}, potential {potential:.6e}")
        };
        line("energy", format!("{} at the start", energies(summary.energy_first)));
        line("", format!("{} at the end", energies(summary.energy_last)));
        if let Some([last, largest]) = summary.over_initial() {
            line("", format!("kinetic and strain over those at the start: {last:.6} at the end, {largest:.6} at most"));
        }
        line("", format!("change {:.2e}, largest gain {:.2e}", summary.energy_change(), summary.energy_gain()));
        let taken = [summary.damped, summary.taken_by_scheme()]
            .map(|energy| energy / summary.energy_scale.max(f64::MIN_POSITIVE));
        line("", format!("taken by damping {:.2e}, by the scheme {:.2e}, of the largest energy", taken[0], taken[1]));
        let RunSeconds { assemble, factor, solve, .. } = self.seconds;
        line("seconds", format!("{assemble:.3} to assemble, {factor:.3} to factorise, {solve:.3} for the steps"));
        text + &warnings_text(&summary.warnings(model))
    }
}

/// The contact of each obstacle and pair of bodies, with its name.
fn named<'a>(model: &'a Model, summary: &'a MotionSummary) -> impl Iterator<Item = (String, &'a MotionContact)> {
    (0..model.obstacles().len()).map(|index| format!("obstacles[{index}]")).zip(&summary.obstacles)
}

/// The table of obstacles and pairs of bodies, a line for each that was touched.
fn obstacle_lines(model: &Model, summary: &MotionSummary) -> Vec<String> {
    let units = model.units();
    let time = |time: Option<f64>| time.map_or_else(|| "-".to_string(), |time| format!("{time:.5e}"));
    let force = |force: f64| format!("{force:.5e}");
    let rows = table(
        &named(model, summary).collect::<Vec<_>>(),
        &[
            ("obstacle", &|(name, _)| name.clone()),
            ("from", &|(_, of)| time(of.first)),
            ("to", &|(_, of)| time(of.last)),
            (&in_unit("peak", &units.force), &|(_, of)| force(of.peak_force())),
            ("impulse", &|(_, of)| force(of.impulse)),
            (&in_unit("largest", &units.force), &|(_, of)| force(of.force_max)),
            (&in_unit("mean", &units.force), &|(_, of)| force(of.force_mean_max())),
        ],
    );
    columns(&rows).lines().map(String::from).collect()
}

/// The same as one object.
impl Serialize for MotionReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let MotionReport { model, dynamics, summary, .. } = self;
        let energies = |[kinetic, strain, potential]: [f64; 3]| json!({"kinetic": kinetic, "strain": strain, "potential": potential, "total": kinetic + strain + potential});
        let contact = |of: &MotionContact, error: Option<f64>| {
            json!({
                "first": of.first,
                "last": of.last,
                "duration": of.duration,
                "peak_force": {
                    "value": of.peak_force(),
                    "window": summary.peak_steps() as f64 * dynamics.step,
                    "error": error,
                },
                "force_max": of.force_max,
                "force_mean_max": of.force_mean_max(),
                "impulse": of.impulse,
            })
        };
        let obstacles: Vec<_> = named(model, summary)
            .map(|(name, of)| {
                let mut one = contact(of, None);
                one["of"] = json!(name);
                one
            })
            .collect();
        let mut of_all = contact(&summary.contact, self.error.map(|error| error.peak_force));
        if let Some(error) = &self.error {
            of_all["estimated_error"] = json!(error);
        }
        of_all["force_window"] = json!({
            "of": WINDOW,
            "time": summary.window_steps() as f64 * dynamics.step,
            "steps": summary.window_steps(),
        });
        of_all["penetration_max"] = json!(summary.penetration_max);
        of_all["obstacles"] = json!(obstacles);
        let mut report = json!({
            "status": self.status(),
            "method": self.method.name(),
            "scheme": dynamics.scheme.name(),
            "gains_energy": dynamics.scheme.gains_energy(),
            "step": dynamics.step,
            "steps": summary.steps,
            "time": summary.time,
            "contact": of_all,
            "energy": {
                "first": energies(summary.energy_first),
                "last": energies(summary.energy_last),
                "change": summary.energy_change(),
                "gain": summary.energy_gain(),
                "initial": summary.initial_energy(),
                "last_over_initial": summary.over_initial().map(|[last, _]| last),
                "largest_over_initial": summary.over_initial().map(|[_, largest]| largest),
                "work": summary.work,
                "damped": summary.damped,
                "taken_by_scheme": summary.taken_by_scheme(),
                "growth": summary.growth(),
            },
            "model": {
                "nodes": model.mesh().nodes().len(),
                "elements": model.mesh().element_count(),
                "dofs": model.problem().dofs(),
                "contact_rows": model.rows().len(),
            },
            "seconds": self.seconds,
        });
        if model.parts_of_whole() > 1.0 {
            report["parts_of_whole"] = json!(model.parts_of_whole() as usize);
        }
        let [all, most] = summary.penalties;
        if let Some(fields) = report.as_object_mut().filter(|_| all > 0) {
            fields.insert("penalties".into(), json!({"all": all, "most_in_a_step": most}));
        }
        let warnings = summary.warnings(model);
        if let Some(fields) = report.as_object_mut().filter(|_| !warnings.is_empty()) {
            fields.insert("warnings".into(), json!(warnings));
        }
        report.serialize(serializer)
    }
}

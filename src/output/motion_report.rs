//! The report of a motion, as text and as JSON.

use serde::{Serialize, Serializer};
use serde_json::json;

use super::report::{entry, plural, printable, quantity};
use crate::qp::Method;
use crate::scene::{Dynamics, Model};
use crate::study::{MotionSummary, RunSeconds, status};

/// What a run was asked for and what it has come to.
#[derive(Debug)]
pub struct MotionReport<'a> {
    /// The scene at rest.
    pub model: &'a Model,
    /// Its motion.
    pub dynamics: &'a Dynamics,
    /// Method of the contact problem of every step.
    pub method: Method,
    /// The steps so far.
    pub summary: &'a MotionSummary,
    /// What they cost.
    pub seconds: RunSeconds,
}

impl MotionReport<'_> {
    /// Returns `true` if the contact problems of all steps are certified: not where springs stand for closed rows, nor
    /// where the motion was cut short.
    pub fn is_certified(&self) -> bool {
        let is_whole = self.summary.steps >= self.dynamics.steps;
        is_whole && !self.dynamics.scheme.penetrates() && !matches!(self.method, Method::Penalty(_))
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
        let steps = plural(summary.steps, "step");
        line("motion", format!("{}, {steps} of {:.6e}", dynamics.scheme.name(), dynamics.step));
        match (summary.first_contact, summary.last_contact) {
            (Some(first), Some(last)) => {
                line("contact", format!("from {first:.6e} to {last:.6e}, for {:.6e} in all", summary.contact_time));
                let force = quantity(summary.force_max, &units.force);
                line("", format!("largest force {force}, impulse {:.6e}", summary.impulse));
            }
            _ => line("contact", "none".into()),
        }
        line("", format!("deepest penetration {}", quantity(summary.penetration_max, &units.length)));
        let energies = |[kinetic, strain, potential]: [f64; 3]| {
            format!("kinetic {kinetic:.6e}, strain {strain:.6e}, potential {potential:.6e}")
        };
        line("energy", format!("{} at the start", energies(summary.energy_first)));
        line("", format!("{} at the end", energies(summary.energy_last)));
        line("", format!("change {:.2e}, largest gain {:.2e}", summary.energy_change(), summary.energy_gain()));
        let RunSeconds { assemble, factor, solve, .. } = self.seconds;
        line("seconds", format!("{assemble:.3} to assemble, {factor:.3} to factorise, {solve:.3} for the steps"));
        text
    }
}

/// The same as one object.
impl Serialize for MotionReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let MotionReport { model, dynamics, summary, .. } = self;
        let energies = |[kinetic, strain, potential]: [f64; 3]| json!({"kinetic": kinetic, "strain": strain, "potential": potential, "total": kinetic + strain + potential});
        let report = json!({
            "status": status(self.is_certified()),
            "method": self.method.name(),
            "scheme": dynamics.scheme.name(),
            "gains_energy": dynamics.scheme.gains_energy(),
            "step": dynamics.step,
            "steps": summary.steps,
            "time": summary.time,
            "contact": {
                "first": summary.first_contact,
                "last": summary.last_contact,
                "duration": summary.contact_time,
                "force_max": summary.force_max,
                "impulse": summary.impulse,
                "penetration_max": summary.penetration_max,
            },
            "energy": {
                "first": energies(summary.energy_first),
                "last": energies(summary.energy_last),
                "change": summary.energy_change(),
                "gain": summary.energy_gain(),
            },
            "model": {
                "nodes": model.mesh().nodes().len(),
                "elements": model.mesh().element_count(),
                "dofs": model.problem().dofs(),
                "contact_rows": model.rows().len(),
            },
            "seconds": self.seconds,
        });
        report.serialize(serializer)
    }
}

//! The report of a motion, as text and as JSON.

use serde_json::{Value, json};

use super::report::{UnitNames, entry, plural, printable, quantity};
use crate::qp::Method;
use crate::scene::{Dynamics, Model};
use crate::study::MotionSummary;

/// What a run cost, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionSeconds {
    /// Reading, meshing, assembly.
    pub assemble: f64,
    /// Factorisations before the first step.
    pub factor: f64,
    /// All steps, writing included.
    pub steps: f64,
}

/// Are the contact problems of all steps of this motion certified? Not where springs stand for closed rows, nor where the
/// motion was cut short.
pub fn motion_is_certified(dynamics: &Dynamics, method: Method, summary: &MotionSummary) -> bool {
    let is_whole = summary.steps >= dynamics.steps;
    is_whole && !dynamics.scheme.penetrates() && !matches!(method, Method::Penalty(_))
}

/// The report of a run, in lines of at most 100 characters.
pub fn motion_text(
    title: &str,
    model: &Model,
    dynamics: &Dynamics,
    summary: &MotionSummary,
    seconds: &MotionSeconds,
    units: &UnitNames,
) -> String {
    let mut text = format!("{}\n", printable(title));
    let mut line = |name: &str, content: String| text += &entry(name, &content);
    let (nodes, elements) = (model.mesh().nodes().len(), model.mesh().element_count());
    let (dofs, rows) = (model.problem().dofs(), plural(model.rows().len(), "contact row"));
    line("model", format!("{nodes} nodes, {elements} elements, {dofs} dofs, {rows}"));
    line("motion", format!("{}, {} of {:.6e}", dynamics.scheme.name(), plural(summary.steps, "step"), dynamics.step));
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
    let MotionSeconds { assemble, factor, steps } = seconds;
    line("seconds", format!("{assemble:.3} to assemble, {factor:.3} to factorise, {steps:.3} for the steps"));
    text
}

/// The same as one object.
pub fn motion_json(
    model: &Model,
    dynamics: &Dynamics,
    method: Method,
    summary: &MotionSummary,
    seconds: &MotionSeconds,
) -> Value {
    let energies = |[kinetic, strain, potential]: [f64; 3]| json!({"kinetic": kinetic, "strain": strain, "potential": potential, "total": kinetic + strain + potential});
    let MotionSeconds { assemble, factor, steps } = seconds;
    json!({
        "status": if motion_is_certified(dynamics, method, summary) { "certified" } else { "not_certified" },
        "method": method.name(),
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
        "seconds": {"assemble": assemble, "factor": factor, "solve": steps, "total": assemble + factor + steps},
    })
}

//! A certificate in words: the conditions that an answer was checked against, and the result.

use serde::Serialize;

use signorini_qp::{Certificate, Goal, Met};

/// A number in two digits.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 { "0".to_string() } else { format!("{value:.1e}") }
}

#[derive(Clone, Debug, Serialize)]
pub(crate) struct CertificateWords {
    /// The goal, and the statement that the answer meets it or not.
    pub verdict: String,
    /// Name, formula and value of each of the six conditions, as text.
    pub conditions: Vec<(&'static str, &'static str, String)>,
    /// Notes for the reader of these values.
    pub notes: Vec<String>,
}

impl CertificateWords {
    pub fn of(certificate: &Certificate, goal: Goal) -> Self {
        let tolerance = goal.required();
        let verdict = match certificate.judged(goal).met {
            Some(Met::Tolerance) if certificate.at_rest => "certified at rest, each relative:".to_string(),
            Some(Met::Tolerance) => format!("certified to {tolerance:.1e}, each relative:"),
            Some(Met::Rounding) => match certificate.met_tolerance {
                met if met.is_finite() => {
                    format!("certified as exact as doubles can hold u: {met:.1e}, each relative:")
                }
                _ => "certified as exact as doubles can hold u, each relative:".to_string(),
            },
            None => format!("NOT certified to {tolerance:.1e}, each relative:"),
        };
        CertificateWords { verdict, conditions: conditions(certificate).to_vec(), notes: notes(certificate, tolerance) }
    }
}

fn notes(certificate: &Certificate, tolerance: f64) -> Vec<String> {
    let mut notes = Vec::new();
    let explaining = [certificate.stationarity, certificate.complementarity, certificate.duality_gap];
    if explaining.iter().any(|measure| measure.is_finite() && *measure > tolerance) {
        notes.push("stationarity, complementarity and duality gap explain an error and do not decide".to_string());
    }
    let (parts, resting) = (certificate.parts, certificate.parts_at_rest);
    if resting > 0 {
        let of_parts = if parts > 1 { format!("{resting} of {parts} parts at rest: ") } else { String::new() };
        notes.push(format!(
            "{of_parts}|u - u*|_K is at most {} of what the forces could do to a single dof;",
            number(certificate.rest_error)
        ));
        notes.push("no relative error exists at rest".to_string());
    }
    if parts > resting && parts > 1 {
        let worst = certificate.part_error_bound;
        let moving = if resting > 0 { "that move " } else { "" };
        notes.push(format!("of {} parts {moving}the largest error is at most {worst:.1e}", parts - resting));
    }
    if certificate.loose_dofs > 0 {
        let loose = "without stiffness and force (number of dofs)";
        notes.push(format!("the energy error does not see the place of dofs {loose}: {}", certificate.loose_dofs));
    }
    if !certificate.has_bound() {
        let unknown = "no error bound: the conditions alone do not bound the error of the displacement";
        notes.push(unknown.to_string());
    }
    notes
}

/// The bound on the energy error, in two digits and words.
fn bound(certificate: &Certificate) -> String {
    match certificate.energy_error_bound {
        _ if !certificate.has_bound() => "unknown".to_string(),
        bound if !bound.is_finite() => "none: at rest".to_string(),
        bound if certificate.bound_is_measured => format!("{}, measured", number(bound)),
        bound => number(bound),
    }
}

/// Name, formula and value of the six conditions of a certificate.
pub(crate) fn conditions(certificate: &Certificate) -> [(&'static str, &'static str, String); 6] {
    [
        ("stationarity", "|K u - f - B' lambda|", number(certificate.stationarity)),
        ("penetration", "max (B u - g)", number(certificate.penetration)),
        ("adhesion", "max lambda", number(certificate.adhesion)),
        ("complementarity", "|lambda (B u - g)|", number(certificate.complementarity)),
        ("duality gap", "u'K u - f'u - lambda'g", number(certificate.duality_gap)),
        ("energy error", "|u - u*|_K / |u|_K is at most", bound(certificate)),
    ]
}

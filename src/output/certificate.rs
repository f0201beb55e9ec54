//! A certificate in words: the conditions that an answer was checked against, and the result.

use serde::Serialize;

use crate::solution::{Certificate, Goal};

/// A number in two digits.
pub(super) fn number(value: f64) -> String {
    if value == 0.0 { "0".to_string() } else { format!("{value:.1e}") }
}

/// A certificate in words.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CertificateWords {
    /// The goal, and the statement that the answer meets it or not.
    pub verdict: String,
    /// Name, formula and value of each condition; empty if an accuracy alone decides.
    pub conditions: Vec<(&'static str, &'static str, String)>,
    /// Notes for the reader of these values.
    pub notes: Vec<String>,
}

impl CertificateWords {
    pub fn of(certificate: &Certificate, goal: Goal) -> Self {
        let certified = goal.is_met_by(certificate);
        let verdict = if certified { "certified to" } else { "NOT certified to" };
        let bound = certificate.energy_error_bound;
        if let Some(accuracy) = goal.accuracy.filter(|_| bound.is_finite()) {
            let measured = if certificate.bound_is_measured { ", measured" } else { "" };
            let verdict =
                format!("{verdict} {accuracy:.1e} of the energy norm: the error is at most {bound:.1e}{measured}");
            return CertificateWords { verdict, conditions: Vec::new(), notes: Vec::new() };
        }
        CertificateWords {
            verdict: format!("{verdict} {:.1e}, each relative:", goal.tolerance),
            conditions: conditions(certificate).to_vec(),
            notes: notes(certificate, goal),
        }
    }
}

fn notes(certificate: &Certificate, goal: Goal) -> Vec<String> {
    let mut notes = Vec::new();
    if certificate.parts > 1 {
        let worst = certificate.part_error_bound;
        notes.push(format!("of {} parts the largest error is at most {worst:.1e}", certificate.parts));
    }
    if goal.is_met_by(certificate) && certificate.part_error_bound > goal.tolerance {
        let rounding = "values above the tolerance are due to the rounding of the displacement to double precision";
        notes.push(rounding.to_string());
    }
    if certificate.energy_error_bound.is_infinite() {
        let unknown = "no error bound: the conditions alone do not bound the error of the displacement";
        notes.push(unknown.to_string());
    }
    notes
}

/// Name, formula and value of each condition.
pub(super) fn conditions(certificate: &Certificate) -> [(&'static str, &'static str, String); 6] {
    let bound = match certificate.energy_error_bound {
        bound if bound.is_finite() && certificate.bound_is_measured => format!("{}, measured", number(bound)),
        bound if bound.is_finite() => number(bound),
        _ => "unknown".to_string(),
    };
    [
        ("stationarity", "|K u - f - B' lambda|", number(certificate.stationarity)),
        ("penetration", "max (B u - g)", number(certificate.penetration)),
        ("adhesion", "max lambda", number(certificate.adhesion)),
        ("complementarity", "|lambda (B u - g)|", number(certificate.complementarity)),
        ("duality gap", "u'K u - f'u - lambda'g", number(certificate.duality_gap)),
        ("energy error", "|u - u*|_K / |u|_K is at most", bound),
    ]
}

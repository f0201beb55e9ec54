//! What [`Method::Auto`] chooses: rules that were fitted to measured times, not written by hand.

use std::sync::LazyLock;

use serde::Deserialize;

use super::{Method, Precision, Settings};

/// The rules and costs that `cargo run --release --example fit_rules` writes.
static FITTED: LazyLock<Fitted> =
    LazyLock::new(|| serde_json::from_str(include_str!("fitted.json")).unwrap_or_default());

/// What was fitted.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fitted {
    rules: Vec<Rule>,
    double: Cost,
    single: Cost,
}

/// A way to an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Way {
    ActiveSet,
    ActiveSetMixed,
    Qp,
    QpUnpolished,
    Penalty,
    PenaltyRung,
}

/// For an accuracy, and all that are less: the ways by size.
///
/// The size of a condensed problem is the multiplications of its factor. That of an uncondensed one, where every
/// iteration is a factorisation, is the multiplications for each row: it tells how wide a factor is beside its contact.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Rule {
    condensed: bool,
    accuracy: f64,
    steps: Vec<Step>,
}

/// A way for all sizes up to one that the steps before do not cover; without a size, for all.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Step {
    up_to: Option<f64>,
    way: Way,
}

/// Seconds that a step takes: a constant, and one for each multiplication and each value of the factor.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Cost {
    constant: f64,
    per_multiplication: f64,
    per_value: f64,
}

impl Cost {
    fn seconds(&self, multiplications: f64, values: f64) -> f64 {
        self.constant + self.per_multiplication * multiplications + self.per_value * values
    }
}

/// The interior point is told this share of the accuracy that is asked for.
const INTERIOR_POINT_SHARE: f64 = 0.1;

/// The one rung of a ladder that is expected to reach an accuracy is this over it.
const PENALTY_OVER_ACCURACY: f64 = 100.0;

impl Way {
    /// The way for the method, accuracy and precision of `settings`; `None` where these leave no choice.
    pub fn chosen(settings: &Settings, condensed: bool, multiplications: f64, rows: usize) -> Option<Way> {
        if settings.method != Method::Auto {
            return None;
        }
        let accuracy = settings.accuracy.unwrap_or(0.0);
        let rule = FITTED.rules.iter().filter(|rule| rule.condensed == condensed && rule.accuracy <= accuracy);
        let size = if condensed { multiplications } else { multiplications / rows.max(1) as f64 };
        let rule = rule.max_by(|a, b| a.accuracy.total_cmp(&b.accuracy));
        let step = rule.and_then(|rule| rule.steps.iter().find(|step| step.up_to.is_none_or(|most| size <= most)));
        let way = step.map_or(Way::ActiveSet, |step| step.way);
        Some(match (way, settings.precision) {
            (Way::ActiveSetMixed, Precision::Double) => Way::ActiveSet,
            (Way::ActiveSet, Precision::Mixed) => Way::ActiveSetMixed,
            _ => way,
        })
    }

    /// `settings` with this way.
    pub fn settings(self, settings: &Settings) -> Settings {
        let (method, precision) = match self {
            Way::ActiveSet => (Method::ActiveSet, Precision::Double),
            Way::ActiveSetMixed => (Method::ActiveSet, Precision::Mixed),
            Way::Qp | Way::QpUnpolished => (Method::Qp, settings.precision),
            Way::Penalty | Way::PenaltyRung => (Method::Penalty, settings.precision),
        };
        let mut settings = Settings { method, precision, ..settings.clone() };
        if let (Way::QpUnpolished, Some(accuracy)) = (self, settings.accuracy) {
            settings.polish = false;
            settings.interior_point_tolerance = INTERIOR_POINT_SHARE * accuracy;
        }
        if let (Way::PenaltyRung, Some(accuracy)) = (self, settings.accuracy) {
            settings.first_penalty = PENALTY_OVER_ACCURACY / accuracy;
            settings.last_penalty = settings.first_penalty;
        }
        settings
    }
}

/// Seconds of a factorisation with so many multiplications and values, in double and in single precision, as they were
/// where the rules were fitted.
pub(super) fn factor_seconds(multiplications: f64, values: usize) -> [f64; 2] {
    [FITTED.double, FITTED.single].map(|cost| cost.seconds(multiplications, values as f64))
}

#[cfg(test)]
mod tests {
    use super::{FITTED, factor_seconds};

    #[test]
    fn the_fitted_rules_are_read() {
        assert!(FITTED.rules.iter().any(|rule| rule.condensed) && FITTED.rules.iter().any(|rule| !rule.condensed));
        let [double, single] = factor_seconds(1e9, 1_000_000);
        assert!(single > 0.0 && double > single && double < 10.0, "{double} {single}");
    }
}

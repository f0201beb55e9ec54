//! The method and the precision with a factor, by rules that were fitted to measured times.

use super::layout::Unknowns;
pub(in crate::qp) use crate::qp::cost::fitted::Way;
use crate::qp::cost::fitted::{STEPS, Step};
use crate::qp::method::interior_point::InteriorPoint;
use crate::qp::method::penalty::Penalty;
use crate::qp::settings::{Method, Precision, Settings};

/// The interior point aims at this share of the requested accuracy.
const INTERIOR_POINT_SHARE: f64 = 0.1;

/// A factor with fewer multiplications for each row belongs to a chain. Along a chain of more than [`LONG`] rows a front of closed
/// rows takes hundreds of sets; the interior point takes some twenty steps.
const CHAIN: f64 = 200.0;

/// Rows of a long chain.
const LONG: usize = 1000;

/// The penalty of the single rung that should reach an accuracy: this number divided by the accuracy.
const PENALTY_OVER_ACCURACY: f64 = 100.0;

impl Way {
    /// The way for the method, accuracy and precision of `settings`; `None` if these leave no choice.
    pub fn chosen(settings: &Settings, unknowns: Unknowns, multiplications: f64, rows: usize) -> Option<Way> {
        if settings.method != Method::Auto {
            return None;
        }
        let accuracy = settings.accuracy.unwrap_or(0.0);
        let condensed = unknowns == Unknowns::ContactDofs;
        let size = if condensed { multiplications } else { multiplications / rows.max(1) as f64 };
        let covers = |step: &&Step| step.condensed == condensed && step.accuracy <= accuracy && size <= step.up_to;
        let nearest = |a: &&Step, b: &&Step| b.accuracy.total_cmp(&a.accuracy).then(a.up_to.total_cmp(&b.up_to));
        let step = STEPS.iter().filter(covers).min_by(nearest);
        let is_long_chain = !condensed && rows > LONG && size < CHAIN;
        let way = match step.map_or(Way::ActiveSet, |step| step.way) {
            Way::ActiveSet if is_long_chain => Way::Qp,
            way => way,
        };
        Some(match (way, settings.precision) {
            (Way::ActiveSetMixed, Precision::Double) => Way::ActiveSet,
            (Way::ActiveSet, Precision::Mixed) => Way::ActiveSetMixed,
            _ => way,
        })
    }

    /// `settings` with this way.
    pub fn settings(self, settings: &Settings) -> Settings {
        let (method, precision) = match (self, settings.accuracy) {
            (Way::ActiveSet, _) => (Method::ActiveSet, Precision::Double),
            (Way::ActiveSetMixed, _) => (Method::ActiveSet, Precision::Mixed),
            (Way::QpUnpolished, Some(accuracy)) => {
                let loose = InteriorPoint { polish: false, tolerance: INTERIOR_POINT_SHARE * accuracy };
                (Method::Qp(loose), settings.precision)
            }
            (Way::Qp | Way::QpUnpolished, _) => (Method::qp(), settings.precision),
            (Way::PenaltyRung, Some(accuracy)) => {
                let rung = PENALTY_OVER_ACCURACY / accuracy;
                let one = Penalty { first: rung, last: rung, ..Penalty::default() };
                (Method::Penalty(one), settings.precision)
            }
            (Way::Penalty | Way::PenaltyRung, _) => (Method::penalty(), settings.precision),
        };
        Settings { method, precision, ..settings.clone() }
    }
}

//! GOAL: the classical penalty loop in every step of a motion ends below its threshold, however small that is.
//!
//! REFERENCE: `analytical::ImpactingBar`, a bar whose contact force is constant.

use crate::impact::{cases::cases, measure::Run, measure::with_value};
use signorini::motion::{Observation, SchemeSpec};

/// The bar moves by this at most: 5 to the wall, and 10 for the time that is left behind the contact.
const REACH: f64 = 8.4;

/// The mean force between the wave fronts is that of the closed form to within this.
const FORCE: f64 = 0.03;

/// The bar against the wall by the loop with a threshold.
fn by(threshold: f64) -> Run {
    with_value(&cases()[0], SchemeSpec::PenaltyLoop, Some(threshold), 1.5, 100).unwrap()
}

#[test]
fn the_loop_ends_below_its_threshold_with_one_penalty_more_for_each_power_of_ten() {
    let mut most_before = 0;
    for threshold in [1e-2, 1e-4, 1e-6, 1e-8] {
        let run = by(threshold);
        let penalties = |touching: bool| {
            let chosen = move |seen: &&Observation| (seen.force > 0.0) == touching;
            run.history[1..].iter().filter(chosen).map(|seen| seen.penalties)
        };
        // A step that touches nothing is done with the first penalty.
        assert!(penalties(false).all(|count| count <= 2), "{threshold}");
        let most = penalties(true).max().unwrap();
        eprintln!("{threshold}: {most} {} {:?} {:?}", run.penetration, run.pressure, run.energy);
        assert!(run.penetration > 0.0 && run.penetration <= threshold * REACH, "{threshold}: {}", run.penetration);
        assert!(most >= most_before && most <= 9, "{threshold}: {most} after {most_before}");
        most_before = most;
    }
    assert!(most_before >= 5, "{most_before}");
}

#[test]
fn the_loop_meets_the_force_of_the_closed_form_on_the_mean_and_one_spring_penetrates_more() {
    let case = &cases()[0];
    let (many, one) = (by(1e-6), with_value(case, SchemeSpec::Penalty, None, 1.5, 100).unwrap());
    for run in [&many, &one] {
        assert!((run.pressure[0] / case.pressure - 1.0).abs() <= FORCE, "{:?}", run.pressure);
    }
    assert!(one.penetration > 1e3 * many.penetration, "{} and {}", one.penetration, many.penetration);
    assert!(one.history.iter().all(|seen| seen.penalties == 0));
}

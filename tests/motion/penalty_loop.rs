//! GOAL: in every step of a motion, the classical penalty loop ends below its threshold, however small the threshold
//! is.
//!
//! CONDITIONS: a bar of 100 cells that flies against a wall; thresholds from 1e-2 to 1e-8.
//!
//! REFERENCE: `closed_forms::ImpactingBar`, a bar whose contact force is constant.

use signorini::motion::{Observation, SchemeSpec};
use support::impact::{cases::cases, measure::Run, measure::with_value};

/// Largest displacement of the bar: it flies 5 to the wall, and returns with speed 10 during the time after the
/// contact.
const REACH: f64 = 8.4;

/// Error of the mean force between the wave fronts, compared with the closed form.
const FORCE: f64 = 0.03;

/// The bar against the wall, by the loop with a threshold.
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
        // A step without contact needs only the first penalty.
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
fn the_mean_force_of_the_loop_is_exact_and_a_single_penalty_penetrates_more() {
    let case = &cases()[0];
    let (many, one) = (by(1e-6), with_value(case, SchemeSpec::Penalty, None, 1.5, 100).unwrap());
    for run in [&many, &one] {
        assert!((run.pressure[0] / case.pressure - 1.0).abs() <= FORCE, "{:?}", run.pressure);
    }
    assert!(one.penetration > 1e3 * many.penetration, "{} and {}", one.penetration, many.penetration);
    assert!(one.history.iter().all(|seen| seen.penalties == 0));
}

//! GOAL: a derivative that is called proven, or one-sided, is right; a kink is never called smooth.
//!
//! REFERENCE: exact arithmetic, the slopes of the exact path, differences. A short form of
//! `cargo run --release --example studies -- derivatives kinks 1000`.

use std::collections::BTreeMap;

use support::draws::Draws;
use support::oracles::exact::kinks::{Kink, Place};

/// Problems of the short form: a third at a kink, a third near one.
const PROBLEMS: u64 = 300;

#[test]
fn no_proven_or_one_sided_derivative_is_wrong_at_near_or_away_from_kinks() {
    let mut counts = BTreeMap::<(Place, String), usize>::new();
    let mut wrong = Vec::new();
    for number in 0..PROBLEMS {
        let kink = Kink::of(47, number);
        let mut draws = Draws(number);
        let [by_u, by_lambda] = [kink.case.dofs(), kink.case.rows()]
            .map(|count| (0..count).map(|_| f64::from(draws.between(-8, 8))).collect::<Vec<f64>>());
        let judged = kink.judged(&by_u, &by_lambda);
        if let Some(reason) = judged.wrong {
            wrong.push(format!("problem {number}, {:?}: {reason}", kink.place));
        }
        *counts.entry((kink.place, judged.verdict)).or_default() += 1;
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    println!("{counts:?}");
    let count = |place, verdict: &str| counts.get(&(place, verdict.to_string())).copied().unwrap_or(0);
    assert!(count(Place::Away, "proven") >= 85 && count(Place::AtKink, "one-sided") >= 40, "{counts:?}");
}

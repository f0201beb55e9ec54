//! GOAL: the peak of the contact force is reported in two forms: of a single step, which oscillates, and of a mean over
//! time, which converges.
//!
//! CONDITIONS: a bar against a wall and a bouncing bar, by the midpoint rule on 50 to 400 cells.
//!
//! REFERENCE: the constant force of a bar in impact (`closed_forms::ImpactingBar`, `closed_forms::BouncingBar`).

use signorini::motion::SchemeSpec;
use support::impact::{cases::cases, measure::run};

/// Number of cells; each mesh is twice as fine as the one before.
const CELLS: [usize; 4] = [50, 100, 200, 400];

/// The oscillation behind the returning front exceeds this share of the force on every mesh.
const RINGING: f64 = 0.3;

/// Error, on 400 cells, of the mean over a fifth of the time that a wave takes through the bar.
const CONVERGED: f64 = 0.03;

#[test]
fn the_averaged_peak_converges_to_the_exact_force_and_the_peak_of_a_step_does_not() {
    for case in &cases() {
        for courant in [0.5, 1.0] {
            let runs = CELLS.map(|cells| run(case, SchemeSpec::Midpoint, courant, cells).unwrap());
            let [raw, averaged] = [0, 1].map(|peak| runs.each_ref().map(|run| run.peaks[peak] / case.pressure - 1.0));
            eprintln!("{}, {courant}: {raw:?} {averaged:?}", case.name);
            assert!(raw.iter().all(|&over| over > RINGING), "{}: {raw:?}", case.name);
            assert!((0.0..CONVERGED).contains(&averaged[3]), "{}: {averaged:?}", case.name);
            // The front is smeared over a time that falls with the power 2/3 of the cell size; the error of the mean
            // falls at about the same rate.
            let rate = (averaged[0] / averaged[3]).log2() / 3.0;
            assert!((0.4..1.3).contains(&rate), "{}: rate {rate} of {averaged:?}", case.name);
        }
    }
}

#[test]
fn the_averaging_window_is_a_fifth_of_the_time_of_a_wave_through_the_bar() {
    // A length of 10 at the wave speed 30, and a length of 1 at the wave speed 1; both windows are whole numbers of
    // steps of half a cell.
    for (case, expected) in cases().iter().zip([0.2 * 10.0 / 30.0, 0.2]) {
        let found = run(case, SchemeSpec::Midpoint, 0.5, 50).unwrap().window;
        assert!((found / expected - 1.0).abs() < 1e-9, "{found}, expected {expected}");
    }
}

//! Principal pivoting on P-matrices: each step takes the point of a basis, and exchanges the unknowns with wrong signs.
//! All of them at once while their number falls; if it has not fallen for some steps, the last one alone until it does.
//! Single exchanges in a fixed order are finite for every P-matrix, and the bounds change nothing in that.
//!
//! # Source
//! J. J. Judice, F. M. Pires, *A block principal pivoting algorithm for large-scale strictly monotone linear
//! complementarity problems*, Comput. Oper. Res. 21 (1994) 587-596; K. G. Murty, *Note on a Bard-type scheme for
//! solving the complementarity problem*, Opsearch 11 (1974) 123-130.

use signorini_qp::Settings;

use crate::answer::{Found, Place};
use crate::basis::settled;
use crate::class::Known;
use crate::error::Error;
use crate::problem::Lcp;

/// Steps of all exchanges at once that may fail to lower the number of wrong signs.
const PATIENCE: usize = 10;

/// Most steps if M is no P-matrix: then nothing says that they end.
const TRIALS: usize = 20;

/// A sign counts as wrong beyond this share of the terms of its row: otherwise rounding exchanges unknowns for ever.
const ROUNDING: f64 = 1e-13;

/// The point of a P-matrix, or perhaps of another; [`Found::Nothing`] if a basis is singular or the steps are used up.
///
/// # Errors
/// Those of a factorisation, and [`Error::TooLarge`].
pub fn principal_pivoting(
    lcp: &Lcp,
    known: &Known,
    mut places: Vec<Place>,
    allowed: f64,
    settings: &Settings,
) -> Result<Found, Error> {
    let (lower, upper) = (lcp.lower(), lcp.upper());
    let (mut least, mut patience) = (usize::MAX, PATIENCE);
    let most =
        if known.is_unique == Some(true) { settings.max_iterations } else { TRIALS.min(settings.max_iterations) };
    for step in 1..=most {
        if settings.watch.is_over() {
            break;
        }
        let Some(z) = settled(lcp, known, &places, allowed)? else {
            return Ok(Found::Nothing("a basis is singular".into()));
        };
        let [w, terms, _] = lcp.image(&z);
        let exchanged = |i: usize| {
            let (far, wrong) = (ROUNDING * z[i].abs(), ROUNDING * terms[i]);
            match places[i] {
                Place::Between if z[i] < lower[i] - far => Some(Place::Lower),
                Place::Between if z[i] > upper[i] + far => Some(Place::Upper),
                Place::Lower if w[i] < -wrong && lower[i] < upper[i] => Some(Place::Between),
                Place::Upper if w[i] > wrong && lower[i] < upper[i] => Some(Place::Between),
                _ => None,
            }
        };
        let exchanges: Vec<(usize, Place)> = (0..z.len()).filter_map(|i| Some((i, exchanged(i)?))).collect();
        if exchanges.is_empty() {
            return Ok(Found::Point { z, iterations: step });
        }
        patience = if exchanges.len() < least { PATIENCE } else { patience.saturating_sub(1) };
        least = least.min(exchanges.len());
        let all = if patience > 0 { &exchanges[..] } else { &exchanges[exchanges.len() - 1..] };
        all.iter().for_each(|&(i, place)| places[i] = place);
    }
    Ok(Found::Nothing("principal pivoting used up its steps".into()))
}

//! The point of a basis: some unknowns are held at values, and w vanishes in all others. One factorisation, and
//! corrections with residuals in twice the working precision, so that the point does not depend on the way to it.

use std::borrow::Cow;

use signorini_qp::{Cholesky, SparseMatrix, SymmetricMatrix};

use crate::answer::Place;
use crate::class::{Known, if_definite};
use crate::error::Error;
use crate::lu::Lu;
use crate::problem::Lcp;

/// Blocks of a symmetric matrix above this size are taken to a sparse factor.
const DENSE: usize = 150;

/// What is added to the unit diagonal of a sparse block, which may be singular; corrections take it out again.
const SHIFT: f64 = 1e-10;

/// Most corrections of a point.
const CORRECTIONS: usize = 20;

enum Factor<'a> {
    Any(Lu),
    Definite(Cow<'a, Cholesky>),
}

/// The value at which an unknown is held; `None` between its bounds.
pub fn held(place: Place, lower: f64, upper: f64) -> Option<f64> {
    match place {
        Place::Lower => Some(lower),
        Place::Upper => Some(upper),
        Place::Between => None,
    }
}

/// The point with each unknown at its place, in units of z; it may lie outside the bounds. `None` if the basis is
/// singular to rounding.
///
/// # Errors
/// Those of a factorisation for lack of memory.
pub fn settled(lcp: &Lcp, known: &Known, places: &[Place], allowed: f64) -> Result<Option<Vec<f64>>, Error> {
    let n = places.len();
    let at = |i: usize| held(places[i], lcp.lower()[i], lcp.upper()[i]);
    let free: Vec<usize> = (0..n).filter(|&i| at(i).is_none()).collect();
    let mut z: Vec<f64> = (0..n).map(|i| at(i).unwrap_or(0.0)).collect();
    let scaled = &known.scaled;
    let Some(factor) = factor(known, &free, allowed)? else { return Ok(None) };
    let mut last = f64::INFINITY;
    for _ in 0..CORRECTIONS {
        let w = lcp.matrix().mul_added(&z, lcp.offset());
        let right: Vec<f64> = free.iter().map(|&i| -scaled.row[i] * w[i]).collect();
        let step = match &factor {
            Factor::Any(lu) => lu.solve(&right),
            Factor::Definite(cholesky) => cholesky.solve(&right),
        };
        let length = step.iter().fold(0.0, |length: f64, step| length.max(step.abs()));
        if length == 0.0 || length > 0.5 * last || step.iter().any(|step| step.is_nan()) {
            break;
        }
        free.iter().zip(step).for_each(|(&i, step)| z[i] += scaled.column[i] * step);
        let size = free.iter().fold(0.0, |size: f64, &i| size.max((z[i] / scaled.column[i]).abs()));
        // The next correction would be rounding.
        if last.is_finite() && length * (length / last) <= f64::EPSILON * size {
            break;
        }
        last = length;
    }
    Ok(Some(z).filter(|z| z.iter().all(|value| value.is_finite())))
}

fn factor<'a>(known: &'a Known, free: &[usize], allowed: f64) -> Result<Option<Factor<'a>>, Error> {
    let scaled = &known.scaled;
    let mut place = vec![None; scaled.offset.len()];
    free.iter().enumerate().for_each(|(k, &i)| place[i] = Some(k));
    let entries = scaled.matrix.triplets().filter_map(|(i, j, value)| Some((place[i]?, place[j]?, value)));
    if !scaled.is_alike || free.len() <= DENSE {
        let entries: Vec<_> = entries.map(|(i, j, value)| (j, i, value)).collect();
        let transposed = SparseMatrix::from_triplets(free.len(), free.len(), &entries)?;
        return Ok(Lu::of_transposed(&transposed, allowed / 16.0).map(Factor::Any));
    }
    if let Some(whole) = known.factor.as_ref().filter(|_| free.len() == place.len()) {
        return Ok(Some(Factor::Definite(Cow::Borrowed(whole))));
    }
    let shift = (0..free.len()).map(|k| (k, k, SHIFT));
    let entries: Vec<_> = entries.filter(|entry| entry.0 >= entry.1).chain(shift).collect();
    let lower = SparseMatrix::from_triplets(free.len(), free.len(), &entries)?;
    Ok(if_definite(&SymmetricMatrix::from_lower(lower)?)?.map(|factor| Factor::Definite(Cow::Owned(factor))))
}

/// Refuses dense matrices that do not fit.
///
/// # Errors
/// [`Error::TooLarge`].
pub fn check_size(rows: usize, columns: usize, allowed: f64) -> Result<(), Error> {
    let bytes = 16.0 * rows as f64 * columns as f64;
    if bytes <= allowed { Ok(()) } else { Err(Error::TooLarge { unknowns: rows, bytes, allowed }) }
}

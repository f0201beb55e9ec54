//! The certificate of a point, whatever it comes from: residual, bounds on the errors of z and w, proven places. All is
//! recomputed from M, q, l and u, with rounding counted.
//!
//! The point z is moved onto its places, which gives x. Then x solves the problem for another offset q + d exactly:
//! with w = M x + q, `d_i = -w_i` between the bounds, `(-w_i)+` at l, `-(w_i)+` at u. For e = x - z* that gives in each
//! row `e_i (M e + d)_i <= 0`, and therefore, in the scaled units of A,
//!
//! * `e'A e <= |e| |d|`: `|e| <= |d| / a` and `e'A e <= |d|^2 / a`, a the least eigenvalue of (A + A')/2;
//! * `A_ii |e_i| - sum |A_ij| |e_j| <= |d_i|`: `|e| <= v` for every v >= 0 with `<A> v >= |d|`, if A is an H-matrix;
//! * `|w_i - w_i*| <= sqrt(A_ii e'A e)` for a symmetric A, by the inequality of Cauchy and Schwarz.
//!
//! If A is symmetric and only semidefinite, x is moved on until it meets the inequalities; then e'A e is at most the
//! gap `sum (x - l)_i (w_i)+ + (u - x)_i (-w_i)+`.
//!
//! # Source
//! R. W. Cottle, J.-S. Pang, R. E. Stone, *The Linear Complementarity Problem* (1992), section 5.10; X. Chen, S. Xiang,
//! *Computation of error bounds for P-matrix linear complementarity problems*, Math. Program. 106 (2006) 513-525.

use crate::answer::{Class, LcpSolution, Place};
use crate::basis::held;
use crate::class::Known;
use crate::problem::Lcp;
use crate::scaled::diagonal;

/// Sums and products of bounds are enlarged by this, which exceeds their rounding for any number of terms in memory.
const OUTWARD: f64 = 1.0 + 1e-6;

/// A point, its w with terms and rounding, the places of its unknowns, and what is missing there.
pub struct Placed {
    pub z: Vec<f64>,
    image: [Vec<f64>; 3],
    pub places: Vec<Place>,
    pub residual: Vec<f64>,
}

/// Where each unknown lies, and what is missing there. `effect` is for each unknown the largest `|M_ki| / t_k`.
pub fn placed(lcp: &Lcp, z: Vec<f64>) -> Placed {
    let image = lcp.image(&z);
    let [w, terms, rounding] = &image;
    let share = |value: f64, of: f64| if value == 0.0 { 0.0 } else { value / of };
    let effect = |i: usize| lcp.matrix().column(i).map(|(k, m)| share(m.abs(), terms[k])).fold(0.0, f64::max);
    let one = |i: usize| {
        let (z, lower, upper) = (z[i], lcp.lower()[i], lcp.upper()[i]);
        let effect = effect(i);
        let off = |bound: f64| match (z - bound).abs() {
            0.0 => 0.0,
            distance if effect > 0.0 => (distance * effect).min(distance / z.abs().max(bound.abs())),
            distance => distance / z.abs().max(bound.abs()),
        };
        let outside = if z < lower {
            off(lower)
        } else if z > upper {
            off(upper)
        } else {
            0.0
        };
        // What overflows is known by no number; a maximum would leave NaN out.
        let missing = |value: f64| match terms[i].is_finite() && value.is_finite() {
            false => f64::INFINITY,
            true if value <= rounding[i] => 0.0,
            true => value / terms[i],
        };
        let all = [
            (Place::Lower, off(lower).max(missing(-w[i]))),
            (Place::Upper, off(upper).max(missing(w[i]))),
            (Place::Between, outside.max(missing(w[i].abs()))),
        ];
        let is_there = |&(place, _): &(Place, f64)| held(place, lower, upper).is_none_or(f64::is_finite);
        let best = all.into_iter().filter(is_there).min_by(|a, b| a.1.total_cmp(&b.1));
        best.unwrap_or((Place::Between, f64::NAN))
    };
    let (places, residual) = (0..z.len()).map(one).unzip();
    Placed { z, image, places, residual }
}

/// The point with each unknown at its place, and none beyond its bounds.
pub fn onto(lcp: &Lcp, places: &[Place], z: &[f64]) -> Vec<f64> {
    let (lower, upper) = (lcp.lower(), lcp.upper());
    let at = |i: usize| held(places[i], lower[i], upper[i]).unwrap_or(z[i]).clamp(lower[i], upper[i]);
    (0..z.len()).map(at).collect()
}

/// The certificate of a point of a matrix of which this is known; n >= 1.
pub fn examined(lcp: &Lcp, known: &Known, point: Placed) -> LcpSolution {
    let Placed { z, image, places, residual } = point;
    let (n, scaled) = (z.len(), &known.scaled);
    let x = onto(lcp, &places, &z);
    let [w, _, rounding] = if x == z { image.clone() } else { lcp.image(&x) };
    let defect: Vec<f64> = (0..n)
        .map(|i| {
            let missing = match places[i] {
                _ if lcp.lower()[i] == lcp.upper()[i] => return 0.0,
                Place::Lower => (-w[i]).max(0.0),
                Place::Upper => w[i].max(0.0),
                Place::Between => w[i].abs(),
            };
            // A sign beyond its rounding is right.
            let is_right = missing == 0.0 && w[i].abs() > rounding[i];
            if is_right { 0.0 } else { scaled.row[i] * (missing + rounding[i]) * OUTWARD }
        })
        .collect();
    let length = defect.iter().map(|d| d * d).sum::<f64>().sqrt() * OUTWARD + f64::MIN_POSITIVE;
    let mut error = vec![f64::INFINITY; n];
    let (mut energy, mut beside) = (f64::INFINITY, Vec::new());
    if let Some(least) = known.least {
        error = vec![length / least * OUTWARD; n];
        energy = length / least.sqrt() * OUTWARD;
    } else if known.is_unique.is_some() && scaled.is_symmetric {
        (energy, beside) = energy_of_gap(lcp, known, x.clone(), &defect);
    }
    if let Some(by_rows) = by_comparison(known, &defect) {
        error.iter_mut().zip(by_rows).for_each(|(error, by_row)| *error = error.min(by_row));
    }
    let in_units = |i: usize, error: f64| (scaled.column[i] * error + (z[i] - x[i]).abs()) * OUTWARD;
    let error: Vec<f64> = (0..n).map(|i| in_units(i, error[i])).collect();
    let beside = if beside.is_empty() { &x } else { &beside };
    let image_error = image_errors(lcp, known, (&z, &image), beside, &error, energy);
    let [w, ..] = image;
    let proven: Vec<Option<Place>> = (0..n)
        .map(|i| {
            let (e, of_w) = (error[i], image_error[i]);
            let is_between = z[i] - e > lcp.lower()[i] && z[i] + e < lcp.upper()[i];
            [(Place::Lower, w[i] > of_w), (Place::Upper, -w[i] > of_w), (Place::Between, is_between)]
                .into_iter()
                .find_map(|(place, is_proven)| is_proven.then_some(place))
        })
        .collect();
    let said = |errors: Vec<f64>, reason: &str| match errors.iter().all(|error| error.is_finite()) {
        true => Ok(errors),
        false => Err(reason.to_string()),
    };
    LcpSolution {
        error: said(error, NO_ERROR),
        image_error: said(image_error, NO_IMAGE_ERROR),
        z,
        w,
        class: known.class.name(),
        is_unique: known.is_unique,
        proven: [Place::Lower, Place::Between, Place::Upper]
            .map(|place| proven.iter().map(|proven| *proven == Some(place)).collect()),
        residual,
        method: "given",
        iterations: 0,
        seconds: 0.0,
    }
}

const NO_ERROR: &str =
    "M is not shown, by more than rounding, to be an H-matrix with positive diagonal, nor M + M' to be definite";
const NO_IMAGE_ERROR: &str =
    "no bound on z is known, and M is not symmetric and semidefinite with a point inside all inequalities";

/// Bounds on `|e|` by the comparison matrix, entry by entry.
fn by_comparison(known: &Known, defect: &[f64]) -> Option<Vec<f64>> {
    if known.is_unique != Some(true) || known.class == Class::P {
        return None;
    }
    let (n, scaled, units) = (defect.len(), &known.scaled, known.units());
    let defect: Vec<f64> = (0..n).map(|i| defect[i] * (units.row[i] / scaled.row[i]) * OUTWARD).collect();
    let largest = defect.iter().copied().fold(0.0, f64::max);
    if defect.iter().any(|d| !d.is_finite()) {
        return None;
    } else if largest == 0.0 {
        return Some(defect);
    }
    // Small defects are raised a little, so that every row has a positive right side.
    let right: Vec<f64> = defect.iter().map(|d| d.max(1e-3 * largest)).collect();
    let [d, bounds] = known.comparison(&right)?;
    let factor = defect.iter().zip(&bounds).map(|(defect, bound)| defect / bound).fold(0.0, f64::max);
    Some((0..n).map(|i| d[i] * (units.column[i] / scaled.column[i]) * factor * OUTWARD).collect())
}

/// An upper bound on sqrt(e'A e) of a symmetric semidefinite A, and the point to which it belongs: near x, it meets the
/// inequalities, and is reached along a direction d with `A d > 0` where w must not be negative.
fn energy_of_gap(lcp: &Lcp, known: &Known, mut x: Vec<f64>, defect: &[f64]) -> (f64, Vec<f64>) {
    let (n, scaled, lower, upper) = (x.len(), &known.scaled, lcp.lower(), lcp.upper());
    let wanted: Vec<f64> =
        (0..n).map(|i| f64::from(i8::from(upper[i].is_infinite()) - i8::from(lower[i].is_infinite()))).collect();
    let largest = defect.iter().copied().fold(0.0, f64::max);
    if let Some(factor) = known.factor.as_ref().filter(|_| largest > 0.0) {
        let d = factor.solve(&wanted);
        for (i, x) in x.iter_mut().enumerate() {
            *x = (*x + 2.0 * largest * scaled.column[i] * d[i]).clamp(lower[i], upper[i]);
        }
    }
    let [w, _, rounding] = lcp.image(&x);
    if w.iter().chain(&rounding).chain(&x).any(|value| !value.is_finite()) {
        return (f64::INFINITY, x);
    }
    let gap = |i: usize| {
        let part = |distance: f64, w: f64| if w > 0.0 && distance > 0.0 { distance * w } else { 0.0 };
        // The larger of the gaps at both ends of the interval in which w lies.
        let gap = part(x[i] - lower[i], w[i] + rounding[i]).max(part(upper[i] - x[i], rounding[i] - w[i]));
        gap * scaled.row[i] / scaled.column[i]
    };
    (((0..n).map(gap).sum::<f64>() * OUTWARD).sqrt() * OUTWARD, x)
}

/// Bounds on `|w_i - w_i*|` at z, from those on z and on the energy at the point x beside it.
fn image_errors(
    lcp: &Lcp,
    known: &Known,
    (z, [w, _, rounding]): (&[f64], &[Vec<f64>; 3]),
    x: &[f64],
    error: &[f64],
    energy: f64,
) -> Vec<f64> {
    let (n, scaled) = (z.len(), &known.scaled);
    let mut by_rows = vec![0.0; n];
    // An infinite error stays one, also where an entry is zero.
    match error.iter().all(|error| error.is_finite()) {
        true => by_rows = lcp.matrix().mul_abs(error),
        false => by_rows.fill(f64::INFINITY),
    }
    if scaled.is_symmetric && energy.is_finite() {
        let moved = lcp.matrix().mul_abs(&z.iter().zip(x).map(|(z, x)| z - x).collect::<Vec<_>>());
        // A row of a semidefinite matrix without a diagonal entry is zero.
        for (i, value) in diagonal(&scaled.matrix).into_iter().enumerate() {
            let by_energy = if value > 0.0 { value.sqrt() * energy / scaled.row[i] } else { 0.0 };
            by_rows[i] = by_rows[i].min(moved[i] * OUTWARD + by_energy);
        }
    }
    let all = by_rows.iter().zip(rounding).zip(w);
    all.map(|((by_row, rounding), w)| (by_row + rounding + f64::EPSILON * w.abs()) * OUTWARD).collect()
}

//! From a bound on the error to the numbers that decide: relative to the energy norm of each part, or to the forces on
//! a part that rests.

use super::bound::ErrorBound;
use super::scales::{OfPart, Scales, larger, relative};
use crate::solution::Certificate;

/// An error up to this multiple of `eps sqrt(|u|'|K||u|)` is what rounding u to doubles does: half a unit in the last
/// place of each entry, once for the rounding of u and once for the rounding of the bound.
const AS_ROUNDED: f64 = f64::EPSILON;

/// An error of a part that rests is rounding of its forces up to this multiple of these forces and of the loss of the
/// factor.
const FORCES_ROUNDED: f64 = f64::EPSILON;

/// The same for forces that cancel to the last bit: far above the rounding of twice the working precision.
const CANCELLED: f64 = 1e-26;

/// Relative error of sums with twice the working precision stays below this share of their terms: no bound is smaller.
const LEAST: f64 = 1e-28;

/// Rounding of an energy computed with twice the working precision, as a share of its terms.
const OF_ENERGY: f64 = 1e-31;

impl OfPart {
    /// The part of the energy norm that is certain: a body that moves far and does not bend has only energy from
    /// rounding of its terms.
    pub fn certain_norm(&self) -> f64 {
        (self.strain - OF_ENERGY * self.terms).max(0.0).sqrt()
    }

    /// What rounding the displacement to doubles does to its energy norm.
    pub fn rounding(&self) -> f64 {
        AS_ROUNDED * self.terms.sqrt()
    }

    /// The bound with the rounding of sums in twice the working precision.
    fn widened(&self, error: f64) -> f64 {
        error + LEAST * self.terms.sqrt()
    }

    /// The energy norm that rounding gives a part at rest, from the sums of squares of the forces that it leaves and of
    /// all forces.
    pub fn rest(&self, rounded: f64, all: f64) -> f64 {
        FORCES_ROUNDED * rounded.sqrt() + CANCELLED * all.sqrt()
    }

    /// Returns `true` if an error of a part without displacement is rounding of its forces, in a factor that amplifies
    /// rounding by `loss`.
    fn is_rest(&self, error: f64, loss: f64) -> bool {
        !self.moves && error <= loss * self.rest(self.rounded_squares, self.force_squares)
    }
}

/// The numbers that decide, gathered over the whole and the parts.
#[derive(Default)]
struct Worst {
    relative: f64,
    excess: f64,
    part: Option<usize>,
    resting: usize,
    of_rest: f64,
}

impl Worst {
    /// Takes in an error of a part, or of the whole, that moves.
    fn moving(&mut self, error: f64, of: &OfPart, part: Option<usize>) {
        let share = relative(error, of.certain_norm());
        self.relative = larger(share, self.relative);
        let excess = if error <= of.rounding() { 0.0 } else { share };
        if self.part.is_none() || excess.is_nan() || excess > self.excess {
            self.part = part;
        }
        self.excess = larger(excess, self.excess);
    }
}

impl Certificate {
    /// Sets the numbers that follow from a bound on the error, in a norm whose factor amplifies rounding by `loss`.
    /// Returns the part that is farthest from its goal, or `None` if that is the whole.
    pub(super) fn set_bounds(&mut self, bound: &ErrorBound, scales: &Scales, loss: f64) -> Option<usize> {
        let Scales { of_parts: parts, whole, .. } = scales;
        let mut worst = Worst::default();
        let of_parts = bound.of_parts.as_deref().unwrap_or(std::slice::from_ref(&bound.whole));
        let each = if of_parts.len() == parts.len() { &parts[..] } else { std::slice::from_ref(whole) };
        for (number, (of, &error)) in each.iter().zip(of_parts).enumerate().filter(|(_, (of, _))| of.is_stiff) {
            let error = of.widened(error);
            if of.is_rest(error, loss) {
                worst.resting += 1;
                worst.of_rest = larger(relative(error, of.force), worst.of_rest);
            } else {
                worst.moving(error, of, Some(number));
            }
        }
        let error = whole.widened(bound.whole);
        self.energy_error = error;
        self.energy_error_bound = relative(error, whole.certain_norm());
        if whole.moves {
            worst.moving(error, whole, None);
        }
        (self.part_error_bound, self.energy_error_excess) = (worst.relative, worst.excess);
        (self.parts_at_rest, self.rest_error) = (worst.resting, worst.of_rest);
        self.at_rest = worst.resting > 0 && worst.resting == each.iter().filter(|of| of.is_stiff).count();
        self.met_tolerance = self.reached_without_excuse();
        worst.part
    }

    /// The certificate with the bounds of pieces without coupling, which are these scales of the `whole`.
    pub(super) fn with_bounds_of(self, pieces: &[Certificate], whole: &OfPart) -> Self {
        let largest = |of: fn(&Certificate) -> f64| pieces.iter().fold(0.0, |worst, piece| larger(of(piece), worst));
        let energy_error = pieces.iter().map(|piece| piece.energy_error.powi(2)).sum::<f64>().sqrt();
        let mut worst = Worst::default();
        if whole.moves {
            worst.moving(energy_error, whole, None);
        }
        let farthest = |a: &&Certificate, b: &&Certificate| a.energy_error_excess.total_cmp(&b.energy_error_excess);
        let mut whole = Certificate {
            energy_error,
            energy_error_bound: relative(energy_error, whole.certain_norm()),
            part_error_bound: larger(worst.relative, largest(|piece| piece.part_error_bound)),
            energy_error_excess: larger(worst.excess, largest(|piece| piece.energy_error_excess)),
            at_rest: !pieces.is_empty() && pieces.iter().all(|piece| piece.at_rest),
            parts_at_rest: pieces.iter().map(|piece| piece.parts_at_rest).sum(),
            rest_error: largest(|piece| piece.rest_error),
            bound_is_measured: pieces.iter().any(|piece| piece.bound_is_measured),
            cancellation: pieces.iter().max_by(farthest).map_or(self.cancellation, |piece| piece.cancellation),
            ..self
        };
        whole.met_tolerance = whole.reached_without_excuse();
        whole
    }

    /// The tolerance that is met without the excuse of rounding or, if none is, with it.
    fn reached_without_excuse(&self) -> f64 {
        match self.imbalance.max(self.penetration).max(self.open_force).max(self.part_error_bound) {
            _ if self.adhesion != 0.0 => f64::INFINITY,
            met if met.is_finite() => met,
            _ => self.reached(),
        }
    }
}

impl Scales {
    /// Indices of the parts that move in the answer, but whose error is so large that they may rest in the exact one,
    /// increasing.
    pub fn may_rest(&self, bound: &ErrorBound) -> Vec<usize> {
        let errors = bound.of_parts.as_deref().unwrap_or(std::slice::from_ref(&bound.whole));
        let may_rest = |of: &OfPart, error: f64| {
            of.moves && error.is_finite() && error >= of.certain_norm() && error > of.rounding()
        };
        let each = self.of_parts.iter().zip(errors).enumerate();
        each.filter(|(_, (of, error))| may_rest(of, **error)).map(|(part, _)| part).collect()
    }
}

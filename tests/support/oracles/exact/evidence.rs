//! Compares the reason that the program gives for a claim with the data.

use signorini::qp::Error;

use super::dyadic::Dyadic;
use super::problem::Exact;

/// Sums that vanish exactly may keep this share of their terms, because the evidence is given in doubles.
const ROUNDING: f64 = 1e-9;

/// Entries of a direction below this share of the largest count as zero.
const NOTHING: f64 = 1e-15;

/// The entries of a direction; entries that count as zero are replaced by zero.
fn cleaned(direction: &[f64]) -> Vec<Dyadic> {
    let largest = direction.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let kept = |&value: &f64| if value.abs() > NOTHING * largest { value } else { 0.0 };
    direction.iter().map(kept).map(Dyadic::from).collect()
}

/// A sum of products, and the sum of their magnitudes.
fn sum<'a>(terms: impl Iterator<Item = (&'a Dyadic, &'a Dyadic)>) -> (Dyadic, Dyadic) {
    terms.fold((Dyadic::ZERO, Dyadic::ZERO), |(sum, size), (a, b)| {
        let product = a * b;
        (&sum + &product, &size + &product.abs())
    })
}

/// Returns `true` if a sum is zero up to rounding.
fn vanishes((sum, size): &(Dyadic, Dyadic)) -> bool {
    sum.abs() <= size * &Dyadic::from(ROUNDING)
}

/// The fault of the weights or of the direction that an error names, if there is one.
pub fn fault(exact: &Exact, error: &Error) -> Option<&'static str> {
    match error {
        Error::Infeasible { rows, weights, .. } if !weights.is_empty() => infeasible(exact, rows, weights),
        Error::Unbounded { direction, .. } => unbounded(exact, direction),
        Error::UnderHeld { direction, .. } if !has_no_energy(exact, direction) => Some("the direction has energy"),
        _ => None,
    }
}

/// Farkas: `y >= 0`, `B'y = 0`, `g'y < 0`.
fn infeasible(exact: &Exact, rows: &[usize], weights: &[f64]) -> Option<&'static str> {
    if weights.len() != rows.len() || weights.iter().any(|&weight| weight < 0.0 || !weight.is_finite()) {
        return Some("the weights are not one nonnegative number for each row");
    }
    let places: Option<Vec<usize>> =
        rows.iter().map(|row| exact.rows.iter().position(|bounded| bounded == row)).collect();
    let Some(places) = places else { return Some("a row has no bound") };
    let weights: Vec<Dyadic> = weights.iter().copied().map(Dyadic::from).collect();
    let cancels = |dof: usize| vanishes(&sum(places.iter().map(|&place| &exact.contact[place][dof]).zip(&weights)));
    let (overlap, _) = sum(places.iter().map(|&place| &exact.gap[place]).zip(&weights));
    match (0..exact.dofs()).all(cancels) {
        false => Some("the rows do not cancel"),
        true if overlap.sign() >= 0 => Some("the rows do not overlap"),
        true => None,
    }
}

/// `K d = 0`, `B d <= 0`, `f'd > 0`.
fn unbounded(exact: &Exact, direction: &[f64]) -> Option<&'static str> {
    if !has_no_energy(exact, direction) {
        return Some("the direction has energy");
    }
    let direction = cleaned(direction);
    let moved: Vec<(Dyadic, Dyadic)> = exact.contact.iter().map(|row| sum(row.iter().zip(&direction))).collect();
    if moved.iter().any(|moved| moved.0.sign() > 0 && !vanishes(moved)) {
        return Some("a row stops the direction");
    }
    (sum(exact.load.iter().zip(&direction)).0.sign() <= 0).then_some("the load does not drive the direction")
}

fn has_no_energy(exact: &Exact, direction: &[f64]) -> bool {
    let is_finite = direction.len() == exact.dofs() && direction.iter().all(|d| d.is_finite());
    let moves = direction.iter().any(|&d| d != 0.0);
    if !is_finite || !moves {
        return false;
    }
    let direction = cleaned(direction);
    exact.stiffness.iter().all(|line| vanishes(&sum(line.iter().zip(&direction))))
}

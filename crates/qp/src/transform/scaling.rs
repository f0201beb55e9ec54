//! Scaling to dimensionless data of order one, by powers of two.
//!
//! With a reference displacement u0 and the equilibration `c D K D` of the stiffness:
//!
//! ```text
//! u = u0 D v,   K~ = c D K D,   f~ = c D f / u0,   B~ = R B D,   g~ = R g / u0,   lambda = (u0 / c) R mu
//! ```
//!
//! D reduces a stiffness contrast inside the body, R gives every contact row a largest entry near one. All factors are
//! powers of two: the scaled problem is the same problem in other units, bit by bit. u0 belongs to a load and a gap;
//! the rest belongs to the body and is computed once.

use std::sync::OnceLock;

use crate::error::{Error, LinearError};
use crate::linear::{Equilibration, SparseMatrix, SymmetricMatrix, exponent, ldexp};

/// Powers of two with exponents up to this size are doubles that lose no digit.
const SURE: i32 = 1000;

/// The scaling of a body and its contact rows, with its inverse.
#[derive(Clone, Debug)]
pub struct Scaling {
    pub equilibration: Equilibration,
    /// Exponent of each entry of R.
    pub row_exponents: Vec<i32>,
    /// The original stiffness, and the scaled one, which is computed at its first use.
    unscaled: SymmetricMatrix,
    stiffness: OnceLock<SymmetricMatrix>,
    /// The scaled rows.
    pub contact: SparseMatrix,
}

/// The exponent of the largest entry of each row of B D, with the exponents `d` of D; zero for a row of zeros.
fn largest_exponents(contact: &SparseMatrix, d: &[i32]) -> Vec<i32> {
    let mut sizes = vec![0.0_f64; contact.rows()];
    for (dof, &of_dof) in d.iter().enumerate() {
        let power = ldexp(1.0, of_dof);
        contact.with_rows(dof, &mut sizes, |size, value| {
            *size = if value.abs() * power > *size { value.abs() * power } else { *size }
        });
    }
    if sizes.iter().all(|size| size.is_normal()) && d.iter().all(|d| d.abs() <= SURE) {
        return sizes.into_iter().map(exponent).collect();
    }
    // A product may have left the range of doubles.
    let mut largest = vec![None; contact.rows()];
    for (dof, &of_dof) in d.iter().enumerate() {
        let entries = contact.column(dof).filter(|entry| entry.1 != 0.0);
        entries.for_each(|(row, value)| largest[row] = largest[row].max(Some(exponent(value) + of_dof)));
    }
    largest.into_iter().map(|exponent| exponent.unwrap_or(0)).collect()
}

impl Scaling {
    /// Scales the stiffness K (n x n) and the contact rows B (m x n).
    pub fn of(stiffness: &SymmetricMatrix, contact: &SparseMatrix) -> Result<Self, Error> {
        let equilibration = Equilibration::of(stiffness);
        let d = &equilibration.diagonal;
        let row_exponents: Vec<i32> = largest_exponents(contact, d).into_iter().map(|e| -e).collect();
        let contact = contact.times_powers(&row_exponents, |dof| d[dof]);
        if let Some((place, &value)) = contact.values().iter().enumerate().find(|entry| !entry.1.is_finite()) {
            let at = contact.triplets().nth(place).map_or_else(String::new, |(row, dof, _)| format!("({row}, {dof})"));
            return Err(LinearError::NotFinite { name: "matrix", at, value, allowed: "finite" }.into());
        }
        Ok(Scaling { equilibration, row_exponents, unscaled: stiffness.clone(), stiffness: OnceLock::new(), contact })
    }

    pub fn stiffness(&self) -> &SymmetricMatrix {
        self.stiffness.get_or_init(|| self.equilibration.apply(&self.unscaled))
    }

    /// The diagonal matrix, length n, that the scaling makes `2^exponent` times the identity.
    pub fn identity(&self, exponent: i32) -> Vec<f64> {
        let Equilibration { factor, diagonal } = &self.equilibration;
        diagonal.iter().map(|d| ldexp(1.0, exponent - factor - 2 * d)).collect()
    }

    /// The scaled load for u0 = `2^unit`.
    pub fn load(&self, load: &[f64], unit: i32) -> Vec<f64> {
        let exponent = self.equilibration.factor - unit;
        load.iter().zip(&self.equilibration.diagonal).map(|(&f, &d)| ldexp(f, d + exponent)).collect()
    }

    /// The scaled gaps for u0 = `2^unit`.
    pub fn gap(&self, gap: &[f64], unit: i32) -> Vec<f64> {
        gap.iter().zip(&self.row_exponents).map(|(&g, &r)| ldexp(g, r - unit)).collect()
    }

    /// The displacement u of a scaled displacement v, for u0 = `2^unit`.
    pub fn expand_displacement(&self, scaled: &[f64], unit: i32) -> Vec<f64> {
        scaled.iter().zip(&self.equilibration.diagonal).map(|(&v, &d)| ldexp(v, d + unit)).collect()
    }

    /// The scaled multiplier mu of a multiplier lambda, for u0 = `2^unit`.
    pub fn multiplier(&self, multiplier: &[f64], unit: i32) -> Vec<f64> {
        let exponent = self.equilibration.factor - unit;
        multiplier.iter().zip(&self.row_exponents).map(|(&lambda, &r)| ldexp(lambda, exponent - r)).collect()
    }

    /// The multiplier lambda of a scaled multiplier mu, for u0 = `2^unit`.
    pub fn expand_multiplier(&self, scaled: &[f64], unit: i32) -> Vec<f64> {
        let exponent = unit - self.equilibration.factor;
        scaled.iter().zip(&self.row_exponents).map(|(&mu, &r)| ldexp(mu, r + exponent)).collect()
    }
}

//! A problem in integers. Powers of two scale its entries to order one, so that the integers stay short.

use num_bigint::BigInt;

use super::dyadic::Dyadic;
use super::problem::Exact;

/// The data in integers. With u = D v and z = R y, D and R powers of two:
///
/// ```text
/// D K D v + (R B D)' y = D f      divided by 2^a
/// R B D v <= R g                  divided by 2^b
/// ```
///
/// and with the unit 2^c of v, the unit of y is `2^(c + a - b)`.
pub struct Integers {
    pub stiffness: Vec<Vec<BigInt>>,
    pub contact: Vec<Vec<BigInt>>,
    pub load: Vec<BigInt>,
    pub gap: Vec<BigInt>,
    /// Exponents of D and R.
    dof: Vec<i64>,
    row: Vec<i64>,
    /// Exponents of the units of v and y.
    displacement: i64,
    force: i64,
}

impl Integers {
    pub fn of(exact: &Exact) -> Self {
        let (dof, row) = equilibrating(exact);
        let scaled = |lines: &[Vec<Dyadic>], left: &[i64]| -> Vec<Vec<Dyadic>> {
            let line = |(line, i): (&Vec<Dyadic>, &i64)| line.iter().zip(&dof).map(|(x, j)| x.ldexp(i + j)).collect();
            lines.iter().zip(left).map(line).collect()
        };
        let vector = |values: &[Dyadic], units: &[i64]| -> Vec<Dyadic> {
            values.iter().zip(units).map(|(value, unit)| value.ldexp(*unit)).collect()
        };
        let (stiffness, contact) = (scaled(&exact.stiffness, &dof), scaled(&exact.contact, &row));
        let (load, gap) = (vector(&exact.load, &dof), vector(&exact.gap, &row));
        let (a, b) = (lowest(stiffness.iter().flatten()).unwrap_or(0), lowest(contact.iter().flatten()).unwrap_or(0));
        let c = [lowest(&load).map(|low| low - a), lowest(&gap).map(|low| low - b)];
        let c = c.into_iter().flatten().min().unwrap_or(0);
        let whole = |values: &[Dyadic], unit: i64| values.iter().map(|value| value.over(unit)).collect::<Vec<_>>();
        Integers {
            stiffness: stiffness.iter().map(|line| whole(line, a)).collect(),
            contact: contact.iter().map(|line| whole(line, b)).collect(),
            load: whole(&load, a + c),
            gap: whole(&gap, b + c),
            dof,
            row,
            displacement: c,
            force: c + a - b,
        }
    }

    /// Displacements in the units of the problem.
    pub fn displacement(&self, values: &[BigInt]) -> Vec<Dyadic> {
        in_units(values, &self.dof, self.displacement)
    }

    /// Forces in the units of the problem.
    pub fn force(&self, values: &[BigInt]) -> Vec<Dyadic> {
        in_units(values, &self.row, self.force)
    }
}

fn in_units(values: &[BigInt], units: &[i64], all: i64) -> Vec<Dyadic> {
    values.iter().zip(units).map(|(value, unit)| Dyadic::new(value.clone(), unit + all)).collect()
}

fn lowest<'a>(values: impl IntoIterator<Item = &'a Dyadic>) -> Option<i64> {
    values.into_iter().filter(|value| !value.is_zero()).map(Dyadic::exponent).min()
}

/// Exponents for each dof and each row: first a unit diagonal of K, or rows of order one at dofs without stiffness;
/// then rows of order one.
fn equilibrating(exact: &Exact) -> (Vec<i64>, Vec<i64>) {
    let largest = |sizes: &mut dyn Iterator<Item = i64>| sizes.max().unwrap_or(0);
    let of_dof = |dof: usize| match &exact.stiffness[dof][dof] {
        own if own.is_zero() => {
            let rows = exact.contact.iter().map(|row| &row[dof]).filter(|b| !b.is_zero());
            -largest(&mut rows.map(Dyadic::size))
        }
        own => -own.size().div_euclid(2),
    };
    let dof: Vec<i64> = (0..exact.dofs()).map(of_dof).collect();
    let of_row = |row: &Vec<Dyadic>| {
        let entries = row.iter().zip(&dof).filter(|entry| !entry.0.is_zero());
        -largest(&mut entries.map(|(b, unit)| b.size() + unit))
    };
    let row = exact.contact.iter().map(of_row).collect();
    (dof, row)
}

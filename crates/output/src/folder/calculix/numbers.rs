//! Numbers in the widths of CalculiX.

use signorini_mechanics::Error;
use signorini_qp as qp;

/// Smaller sizes have an exponent of three digits, for which there is no room: they are written as zero.
const SMALLEST: f64 = 1e-99;

/// Sizes from here on have no room either.
const LARGEST: f64 = 9.999_999e99;

/// The values of a table or a field of this name, if all have room.
pub(super) fn checked(of: &str, values: Vec<f64>) -> Result<Vec<f64>, Error> {
    // A value that is no number is not below either.
    let has_room = |value: &f64| value.abs() < LARGEST;
    match values.iter().position(|value| !has_room(value)) {
        None => Ok(values),
        Some(entry) => Err(qp::LinearError::NotFinite {
            name: "a result in the form of CalculiX",
            at: format!("entry {entry} of {of}"),
            value: values[entry],
            allowed: "finite and below 1e100",
        }
        .into()),
    }
}

/// A value with `digits` digits behind the point, `digits + 7` wide: `-1.23457E-03`.
pub(super) fn wide(value: f64, digits: usize) -> String {
    let (mantissa, exponent) = parts(value, digits);
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{:>width$}E{sign}{:02}", mantissa, exponent.abs(), width = digits + 3)
}

/// A time as Fortran writes it, with a zero before the point: `0.1000000E+01` has seven digits.
pub(super) fn time(value: f64, digits: usize) -> String {
    let (mantissa, exponent) = parts(value, digits - 1);
    let exponent = if value == 0.0 { 0 } else { exponent + 1 };
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("0.{}E{sign}{:02}", mantissa.replace('.', ""), exponent.abs())
}

/// Mantissa and exponent of ten.
fn parts(value: f64, digits: usize) -> (String, i32) {
    let value = if value.abs() < SMALLEST { 0.0 } else { value };
    let text = format!("{value:.digits$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    (mantissa.to_string(), exponent.parse().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::{checked, time, wide};

    #[test]
    fn numbers_have_the_width_of_calculix() {
        assert_eq!(wide(-1.277_778e-3, 5), "-1.27778E-03");
        assert_eq!(wide(55.0, 5), " 5.50000E+01");
        assert_eq!(wide(-2.5e-100, 5), " 0.00000E+00");
        assert_eq!(wide(9.999_999e-1, 5), " 1.00000E+00");
        assert_eq!(wide(1e99, 6), " 1.000000E+99");
        assert_eq!(time(1.0, 7), "0.1000000E+01");
        assert_eq!(time(0.912_5, 6), "0.912500E+00");
        assert_eq!(time(0.0, 7), "0.0000000E+00");
        for wrong in [f64::NAN, f64::INFINITY, -1e100] {
            assert!(checked("a field", vec![0.0, wrong]).is_err_and(|error| error.to_string().contains("entry 1")));
        }
    }
}

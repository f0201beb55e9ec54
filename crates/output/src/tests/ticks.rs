//! Ticks at round numbers, and readable numbers.

use crate::plots::ticks::{Ticks, brief, decimal, power_of_ten};
use crate::{Quantity, Scale};

const RANGES: [[f64; 2]; 12] = [
    [0.0, 1.0],
    [-1.7e6, 1.0e5],
    [-0.1, -0.01],
    [0.3, 0.30001],
    [1e12, 1.5e12],
    [-3e-12, 2e-12],
    [-1e-200, 1e-200],
    [-1e200, 3e200],
    [999.0, 1001.0],
    [1e9, 1e9 + 1.0],
    [-7.0, 13.0],
    [0.0, 6.3],
];

#[test]
fn linear_ticks_are_round_multiples_within_a_step_of_both_ends() {
    for range in RANGES {
        for count in 1..=9 {
            let ticks = Ticks::new(Scale::Linear, range, count);
            let mantissa = ticks.step / 10f64.powf((ticks.step * 1.0001).log10().floor());
            assert!(
                [1.0, 2.0, 2.5, 5.0].iter().any(|m| (mantissa / m - 1.0).abs() < 1e-9),
                "{range:?}: {}",
                ticks.step
            );
            assert!(ticks.positions.len() <= 2 * count + 2, "{range:?} with {count}: {:?}", ticks.positions);
            assert_eq!(ticks.positions.len(), ticks.labels.len());
            let slack = 0.01 * ticks.step;
            for position in &ticks.positions {
                assert!((range[0] - slack..=range[1] + slack).contains(position), "{position} is outside {range:?}");
            }
            if let (Some(first), Some(last)) = (ticks.positions.first(), ticks.positions.last()) {
                assert!(
                    first - range[0] <= ticks.step && range[1] - last <= ticks.step,
                    "{range:?}: {:?}",
                    ticks.positions
                );
            } else {
                assert!(range[1] - range[0] < ticks.step, "{range:?} has no tick");
            }
        }
    }
}

#[test]
fn labels_of_ticks_differ_and_give_their_positions() {
    for range in RANGES {
        let ticks = Ticks::new(Scale::Linear, range, 6);
        let unit = 10f64.powi(ticks.exponent);
        for (label, position) in ticks.labels.iter().zip(&ticks.positions) {
            let value: f64 = label.replace('−', "-").parse().expect(label);
            assert!((value * unit - position).abs() <= 1e-6 * ticks.step, "`{label}` at {position}");
        }
        let mut labels = ticks.labels.clone();
        labels.dedup();
        assert_eq!(labels.len(), ticks.labels.len(), "{:?}", ticks.labels);
    }
}

#[test]
fn the_unit_interval_and_a_stress_range_have_the_expected_ticks() {
    let ticks = Ticks::new(Scale::Linear, [0.0, 1.0], 5);
    assert_eq!(ticks.labels, ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
    let ticks = Ticks::new(Scale::Linear, [-1.7e6, 0.1e6], 4);
    assert_eq!((ticks.labels, ticks.exponent), (["−1.5", "−1.0", "−0.5", "0.0"].map(String::from).to_vec(), 6));
}

#[test]
fn logarithmic_ticks_are_powers_of_ten_over_decades_and_multiples_within_one() {
    let ticks = Ticks::new(Scale::Logarithmic, [1e-9, 1e-2], 8);
    assert_eq!(ticks.labels.first().map(String::as_str), Some("10⁻⁹"));
    assert_eq!(ticks.labels.last().map(String::as_str), Some("10⁻²"));
    assert_eq!(ticks.labels.len(), 8);
    let ticks = Ticks::new(Scale::Logarithmic, [1.0, 9.0], 8);
    assert_eq!(ticks.labels, ["1", "2", "5"]);
    let sparse = Ticks::new(Scale::Logarithmic, [1e-30, 1e30], 6);
    assert!(sparse.labels.len() <= 7 && sparse.labels.len() >= 3, "{:?}", sparse.labels);
}

#[test]
fn the_range_of_data_is_never_empty() {
    let hostile: [&[f64]; 9] = [
        &[],
        &[f64::NAN, f64::INFINITY],
        &[0.0],
        &[-0.0, 0.0],
        &[5.0, 5.0],
        &[1e-320],
        &[1e12, 1e12 + 1e-4],
        &[-1e308, 1e308],
        &[-4.0, f64::NAN, 3.0],
    ];
    for scale in [Scale::Linear, Scale::Logarithmic] {
        for values in hostile {
            let [from, to] = scale.range(values.iter().copied(), 0.05);
            assert!(from.is_finite() && to.is_finite() && from < to, "{scale:?} {values:?}: {from} to {to}");
            assert!(values.iter().all(|&v| !scale.shows(v) || (from..=to).contains(&v)), "{scale:?} {values:?}");
            Ticks::new(scale, [from, to], 5);
        }
    }
}

#[test]
fn an_invalid_range_has_no_ticks() {
    for range in [[0.0, 0.0], [1.0, 0.0], [f64::NAN, 1.0], [0.0, f64::INFINITY], [-1e308, 1e308]] {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            assert!(Ticks::new(scale, range, 5).positions.is_empty(), "{scale:?} {range:?}");
        }
    }
}

#[test]
fn numbers_have_true_minus_signs_and_superscripts() {
    assert_eq!(power_of_ten(-12), "10⁻¹²");
    assert_eq!(decimal(-0.04, 1), "0.0");
    assert_eq!(decimal(-1.25, 2), "−1.25");
    let cases =
        [(0.0, "0"), (1.0, "1"), (-0.01, "−0.01"), (-2.5e7, "−2.5×10⁷"), (1e-6, "10⁻⁶"), (123456.0, "1.235×10⁵")];
    for (value, text) in cases {
        assert_eq!(brief(value), text);
    }
    for (unit, exponent, label) in [
        ("Pa", 6, "p (MPa)"),
        ("Pa", 3, "p (kPa)"),
        ("MPa", 3, "p (GPa)"),
        ("MPa", -3, "p (kPa)"),
        ("N/m", 3, "p (kN/m)"),
        ("mm", -3, "p (µm)"),
        ("m", 6, "p (10⁶ m)"),
        ("m²", -6, "p (10⁻⁶ m²)"),
        ("lbf", 3, "p (10³ lbf)"),
        ("Pa", -15, "p (10⁻¹⁵ Pa)"),
    ] {
        assert_eq!(Quantity::new("p", unit).label(exponent), label);
    }
    assert_eq!(Quantity::new("p", "").label(6), "p (×10⁶)");
    assert_eq!(Quantity::new("error", "").label(0), "error");
}

#[test]
fn a_logarithmic_axis_over_one_decade_has_several_ticks() {
    for range in [[1.1e-3, 3e-2], [4.5e-3, 0.21], [0.8, 13.0]] {
        let ticks = Ticks::new(Scale::Logarithmic, range, 8);
        assert!(ticks.positions.len() >= 2, "{range:?}: {:?}", ticks.labels);
        assert!(ticks.positions.iter().all(|at| (range[0]..=range[1]).contains(at)), "{range:?}: {:?}", ticks.labels);
    }
}

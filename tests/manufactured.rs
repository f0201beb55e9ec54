//! Blocks whose exact solution is known: the solution itself, errors in norms, rates.
//!
//! GOAL        relative errors in energy and L2 on the unit square, and their rates
//! MESH        n x n cells, T3 and T6 cut from (i,j) to (i+1,j+1)
//! CONDITIONS  exact displacement left, right and above; contact below
//! PARAMETERS  E = 1, nu = 0.3, plane strain; smooth k = 3, x0 = 0.5, A = B = 1; edge x0 = 0.53, p0 = 1; Hertz a = 0.53, p0 = 1
//! REFERENCE   errors of an independent implementation, in three digits

use signorini::analytical::manufactured::{ContactSolution, GenericEdge, HertzBlock, PlaneElasticity, Smooth};
use signorini::body::Integration;
use signorini::element::ElementKind::{self, Q4, Q8, T3, T6};
use signorini::study::{BlockErrors, solve_block};

/// Half a unit of the last of three digits, and a tenth of it for rounding: where the solution is smooth.
const THREE_DIGITS: f64 = 0.0055;

/// Where it is not, the two implementations differ by up to 1.42 % (quadratic elements, n = 16 and 64). The strain has a
/// square root at the edge of the contact, which no quadrature of the norms integrates exactly.
const AT_THE_EDGE: f64 = 0.015;

fn elasticity() -> PlaneElasticity {
    PlaneElasticity::plane_strain(1.0, 0.3)
}

fn smooth() -> Smooth {
    Smooth { elasticity: elasticity(), opening: 1.0, pressure: 1.0, edge: 0.5, power: 3 }
}

fn edge() -> GenericEdge {
    GenericEdge { elasticity: elasticity(), edge: 0.53, pressure: 1.0 }
}

fn hertz() -> HertzBlock {
    HertzBlock { elasticity: elasticity(), half_width: 0.53, peak_pressure: 1.0 }
}

fn solved(exact: &dyn ContactSolution, kind: ElementKind, cells: usize) -> BlockErrors {
    solve_block(exact, kind, Integration::Standard, cells).unwrap()
}

fn check(exact: &dyn ContactSolution, tolerance: f64, rows: &[(ElementKind, usize, f64, f64)]) {
    for &(kind, cells, energy, l2) in rows {
        let errors = solved(exact, kind, cells).errors;
        for (name, ours, expected) in [("energy", errors.energy, energy), ("L2", errors.l2, l2)] {
            // Of the leading digit's power of ten where three digits are asked for, relative where not.
            let unit = if tolerance == THREE_DIGITS { 10_f64.powf(expected.log10().floor()) } else { expected };
            let away = (ours - expected).abs() / unit;
            assert!(away < tolerance, "{kind:?} n = {cells}, {name}: {ours:.4e}, expected {expected:.3e}");
        }
    }
}

#[test]
fn smooth_contact_has_the_expected_errors() {
    check(
        &smooth(),
        THREE_DIGITS,
        &[
            (T3, 16, 9.798e-2, 9.82e-3),
            (Q4, 16, 6.485e-2, 6.99e-3),
            (T6, 16, 1.791e-3, 8.76e-5),
            (Q8, 16, 5.060e-4, 4.58e-5),
            (T3, 64, 2.453e-2, 6.38e-4),
            (Q4, 64, 1.621e-2, 4.38e-4),
            (T6, 64, 1.128e-4, 1.34e-6),
            (Q8, 64, 3.163e-5, 7.15e-7),
        ],
    );
}

#[test]
fn generic_edge_has_the_expected_errors() {
    check(
        &edge(),
        AT_THE_EDGE,
        &[
            (T3, 16, 5.721e-2, 2.03e-3),
            (Q4, 16, 2.893e-2, 1.06e-3),
            (T6, 16, 2.742e-3, 6.79e-5),
            (Q8, 16, 1.898e-3, 4.70e-5),
            (T3, 64, 1.446e-2, 1.17e-4),
            (Q4, 64, 7.272e-3, 6.33e-5),
            (T6, 64, 3.158e-4, 2.35e-6),
            (Q8, 64, 2.127e-4, 1.02e-6),
        ],
    );
}

#[test]
fn hertz_block_has_the_expected_errors() {
    check(
        &hertz(),
        AT_THE_EDGE,
        &[
            (T3, 16, 7.971e-2, 2.35e-3),
            (Q4, 16, 5.351e-2, 1.10e-3),
            (T6, 16, 8.675e-3, 1.34e-4),
            (Q8, 16, 6.001e-3, 9.62e-5),
            (T3, 64, 2.105e-2, 1.34e-4),
            (Q4, 64, 1.360e-2, 6.83e-5),
            (T6, 64, 9.946e-4, 4.86e-6),
            (Q8, 64, 6.668e-4, 2.06e-6),
        ],
    );
}

#[test]
fn energy_rates_average_to_those_of_the_theory() {
    let cases: [(&str, &dyn ContactSolution, [f64; 2]); 3] =
        [("smooth", &smooth(), [1.0, 2.0]), ("edge", &edge(), [1.0, 1.5]), ("hertz", &hertz(), [1.0, 1.5])];
    for (name, exact, expected) in cases {
        for kind in [T3, Q4, T6, Q8] {
            // Three refinements, n = 8 to 64.
            let [first, last] = [8, 64].map(|cells| solved(exact, kind, cells));
            let rate = |coarse: f64, fine: f64| (coarse / fine).log2() / 3.0;
            let energy = rate(first.errors.energy, last.errors.energy);
            let l2 = rate(first.errors.l2, last.errors.l2);
            // The averages differ from the limit by what the first, coarse step does: 0.06 at most.
            let limit = expected[usize::from(kind.is_quadratic())];
            assert!((energy - limit).abs() < 0.08, "{name} {kind:?}: energy rate {energy:.3}");
            let l2_limit = match (kind.is_quadratic(), name) {
                (false, _) => 2.0,
                (true, "smooth") => 3.0,
                // No theory fixes this one; it lies between.
                (true, _) => 2.37,
            };
            assert!((l2 - l2_limit).abs() < 0.15, "{name} {kind:?}: L2 rate {l2:.3}");
        }
    }
}

#[test]
fn peak_pressure_of_the_hertz_block_is_that_of_the_reference() {
    for (cells, expected) in [(16, 0.99257), (32, 0.99817), (64, 0.99955), (128, 0.99989)] {
        let peak = solved(&hertz(), Q4, cells).pressure.iter().fold(0.0, |peak: f64, at| peak.max(at.ours));
        // Five digits.
        assert!((peak - expected).abs() < 6e-6, "n = {cells}: {peak}");
    }
}

#[test]
fn peak_pressure_survives_near_incompressibility_with_mean_dilatation() {
    let elasticity = PlaneElasticity::plane_strain(1.0, 0.4999);
    let exact = HertzBlock { elasticity, ..hertz() };
    let peak = |integration, cells| {
        let pressure = solve_block(&exact, Q4, integration, cells).unwrap().pressure;
        pressure.iter().fold(0.0, |peak: f64, at| peak.max(at.ours))
    };
    for (cells, tolerance) in [(16, 0.05), (32, 0.05)] {
        let mean = peak(Integration::MeanDilatation, cells);
        assert!((mean - 1.0).abs() < tolerance, "n = {cells}: {mean}");
    }
    assert!(peak(Integration::Standard, 16) > 2.0, "the standard element locks");
}

/// At a grid of points: the gradient is that of the displacement, the stress is in equilibrium with the body force, and
/// on y = 0 there is no shear, and pressure only where the body rests on the obstacle.
#[test]
fn exact_solutions_satisfy_the_equations() {
    // Central differences of step 1e-5: errors of 1e-10 by the step, 1e-11 by rounding, times second derivatives of up to 1e3.
    let (step, tolerance) = (1e-5, 1e-6);
    let cases: [&dyn ContactSolution; 3] = [&smooth(), &edge(), &hertz()];
    for (case, exact) in cases.into_iter().enumerate() {
        for i in 1..10 {
            let x = f64::from(i) * 0.1 + 0.013;
            for j in 1..10 {
                let y = f64::from(j) * 0.1;
                let force = exact.body_force([x, y]);
                let gradient = exact.gradient([x, y]);
                let [right, left, above, below] = [[x + step, y], [x - step, y], [x, y + step], [x, y - step]]
                    .map(|at| (exact.displacement(at), exact.stress(at)));
                for row in 0..2 {
                    let slopes = [right.0[row] - left.0[row], above.0[row] - below.0[row]].map(|d| d / (2.0 * step));
                    for (slope, entry) in slopes.iter().zip(gradient[row]) {
                        assert!((slope - entry).abs() < tolerance, "case {case} at {x}, {y}: {slope} {entry}");
                    }
                    // Rows of the stress tensor: [xx, xy] and [xy, yy].
                    let (along_x, along_y) = ([0, 2][row], [2, 1][row]);
                    let divergence =
                        (right.1[along_x] - left.1[along_x] + above.1[along_y] - below.1[along_y]) / (2.0 * step);
                    assert!(
                        (divergence + force[row]).abs() < tolerance,
                        "case {case} at {x}, {y}: {divergence} {force:?}"
                    );
                }
            }
            let [_, sigma_yy, sigma_xy] = exact.stress([x, 0.0]);
            let (pressure, opening) = (exact.pressure(x), exact.displacement([x, 0.0])[1] + exact.gap(x));
            assert!(sigma_xy.abs() < 1e-14 && (sigma_yy + pressure).abs() < 1e-13, "case {case}, x = {x}");
            assert!(pressure >= 0.0 && opening > -1e-14 && (pressure * opening).abs() < 1e-14, "case {case}, x = {x}");
        }
    }
}

//! Blocks with a known exact solution: the solution itself, errors in norms, and rates.
//!
//! GOAL        relative errors in energy and L2 on the unit square, and their rates MESH        n x n cells, T3 and T6
//! cut from (i,j) to (i+1,j+1) CONDITIONS  exact displacement left, right and above; contact below PARAMETERS  E = 1,
//! nu = 0.3, plane strain; smooth k = 3, x0 = 0.5, A = B = 1; edge x0 = 0.53, p0 = 1; Hertz a = 0.53, p0 = 1 REFERENCE
//! errors of an independent implementation, with its quadrature; theoretical rates

use signorini::fem::ElementKind::{self, Hex20, Q4, Q8, T3, T6, Tet10};
use signorini::fem::Integration;
use support::closed_forms::manufactured::{ContactSolution, GenericEdge, HertzBlock, PlaneElasticity, Smooth};
use support::manufactured::{SolvedBlock, solve_block, solve_plate};
use support::verification::reference_errors::{REFERENCE, reference_rule};

/// Half a unit of the last digit of the energy errors, with a tenth more for rounding, relative to the first digit.
const FOUR_DIGITS: f64 = 0.55e-3;

/// Half a unit of the last digit of the L2 errors, which were rounded to four digits first: 2.0246 to 2.025 to 2.03.
const THREE_DIGITS: f64 = 5.5e-3;

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

fn solved(exact: &dyn ContactSolution, kind: ElementKind, cells: usize) -> SolvedBlock<'_> {
    solve_block(exact, kind, Integration::Standard, cells).unwrap()
}

#[test]
fn errors_agree_with_an_independent_implementation_with_its_quadrature() {
    let (smooth, edge, hertz) = (smooth(), edge(), hertz());
    for reference in &REFERENCE {
        let exact: &dyn ContactSolution = match reference.block {
            "smooth" => &smooth,
            "Hertz" => &hertz,
            _ => &edge,
        };
        let (kind, cells) = (reference.kind, reference.cells);
        let errors = solved(exact, kind, cells).errors_by(&reference_rule(kind));
        for (name, ours, expected, tolerance) in
            [("energy", errors.energy, reference.energy, FOUR_DIGITS), ("L2", errors.l2, reference.l2, THREE_DIGITS)]
        {
            let away = (ours - expected).abs() / 10_f64.powf(expected.log10().floor());
            let block = reference.block;
            assert!(away < tolerance, "{block} {kind:?} n = {cells}, {name}: {ours:.5e}, expected {expected:.3e}");
        }
    }
}

/// The expected norms are from a separate program, with 8 x 8 points in each of 32 x 32 parts of the cells around the
/// edge.
#[test]
fn errors_at_the_edge_of_the_contact_are_integrated_to_four_digits() {
    for (exact, kind, cells, energy, l2) in [
        (&edge() as &dyn ContactSolution, T3, 16, 5.7211e-2, 2.0246e-3),
        (&edge(), Q4, 16, 2.8947e-2, 1.0617e-3),
        (&edge(), T6, 16, 2.7472e-3, 6.7768e-5),
        (&edge(), Q8, 16, 1.9160e-3, 4.6574e-5),
        (&edge(), T6, 64, 3.1696e-4, 2.3531e-6),
        (&edge(), Q8, 64, 2.1412e-4, 1.0195e-6),
        (&hertz(), T6, 64, 9.9800e-4, 4.8581e-6),
        (&hertz(), Q8, 64, 6.7126e-4, 2.0706e-6),
    ] {
        let block = solved(exact, kind, cells);
        let errors = block.errors();
        for (name, ours, expected) in [("energy", errors.energy, energy), ("L2", errors.l2, l2)] {
            // One unit of the fifth digit.
            assert!((ours / expected - 1.0).abs() < 1e-4, "{kind:?} n = {cells}, {name}: {ours:.5e}, {expected:.4e}");
        }
        // Error of the quadrature rules with four points in each direction.
        let coarse = block.errors_by(&reference_rule(kind));
        assert!((coarse.energy / energy - 1.0).abs() < 0.0095, "{kind:?} n = {cells}: {coarse:?}");
    }
}

#[test]
fn average_rates_of_the_energy_error_are_those_of_the_theory() {
    let cases: [(&str, &dyn ContactSolution, [f64; 2]); 3] =
        [("smooth", &smooth(), [1.0, 2.0]), ("edge", &edge(), [1.0, 1.5]), ("hertz", &hertz(), [1.0, 1.5])];
    let pairs = cases.into_iter().flat_map(|case| [T3, Q4, T6, Q8].map(|kind| (case, kind)));
    // Every third pair has every solution and every kind.
    for ((name, exact, expected), kind) in pairs.step_by(support::cases(3, 1)) {
        // Three refinements, from n = 8 to 64.
        let [first, last] = [8, 64].map(|cells| solved(exact, kind, cells).errors());
        let rate = |coarse: f64, fine: f64| (coarse / fine).log2() / 3.0;
        let energy = rate(first.energy, last.energy);
        let l2 = rate(first.l2, last.l2);
        // The first, coarse refinement makes the average differ from the limit by at most 0.06.
        let limit = expected[usize::from(kind.is_quadratic())];
        assert!((energy - limit).abs() < 0.08, "{name} {kind:?}: energy rate {energy:.3}");
        let l2_limit = match (kind.is_quadratic(), name) {
            (false, _) => 2.0,
            (true, "smooth") => 3.0,
            // No theory gives this rate; it is between the two others.
            (true, _) => 2.37,
        };
        assert!((l2 - l2_limit).abs() < 0.15, "{name} {kind:?}: L2 rate {l2:.3}");
    }
}

#[test]
fn quadratic_elements_in_space_have_the_energy_rates_of_the_theory_in_contact() {
    // The contact edge of Hertz lies inside a cell: the rate varies from step to step, and its mean is 1.2 to 1.5.
    let cases: [(&str, &dyn ContactSolution, f64, f64); 2] =
        [("smooth", &smooth(), 2.0, 0.06), ("hertz", &hertz(), 1.35, 0.2)];
    let pairs = cases.into_iter().flat_map(|case| [Tet10, Hex20].map(|kind| (case, kind)));
    // The first and the last pair have both solutions and both kinds.
    for ((name, exact, limit, allowed), kind) in pairs.step_by(support::cases(3, 1)) {
        let [first, last] = [4, 16].map(|cells| solve_plate(exact, kind, cells).unwrap());
        let rate = (first.errors().energy / last.errors().energy).log2() / 2.0;
        assert!((rate - limit).abs() < allowed, "{name} {kind:?}: energy rate {rate:.3}");
        assert!(last.pressure.iter().all(|at| at.ours >= 0.0), "{name} {kind:?}: a pressure is negative");
    }
}

#[test]
fn peak_pressure_of_the_hertz_block_is_that_of_the_reference() {
    for (cells, expected) in [(16, 0.99257), (32, 0.99817), (64, 0.99955), (128, 0.99989)] {
        let [peak, _] = solved(&hertz(), Q4, cells).peak_pressure();
        // The reference has five digits.
        assert!((peak - expected).abs() < 6e-6, "n = {cells}: {peak}");
    }
}

#[test]
fn mean_dilatation_keeps_the_peak_pressure_near_incompressibility() {
    let elasticity = PlaneElasticity::plane_strain(1.0, 0.4999);
    let exact = HertzBlock { elasticity, ..hertz() };
    let peak = |integration, cells| solve_block(&exact, Q4, integration, cells).unwrap().peak_pressure()[0];
    for cells in [16, 32] {
        let mean = peak(Integration::MeanDilatation, cells);
        assert!((mean - 1.0).abs() < 0.05, "n = {cells}: {mean}");
    }
    assert!(peak(Integration::Standard, 16) > 2.0, "the standard element does not lock");
}

/// Checks at a grid of points: the gradient is the derivative of the displacement, the stress is in equilibrium with
/// the body force, and on y = 0 there is no shear stress, and a pressure only if the body touches the obstacle.
#[test]
fn exact_solutions_satisfy_the_equations() {
    // Central differences with step 1e-5: an error of 1e-10 by the step and 1e-11 by rounding, times second derivatives
    // of up to 1e3.
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

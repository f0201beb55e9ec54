//! GOAL: a pressure that changes around a curved interface passes between rings whose meshes do not match.
//!
//! CONDITIONS: plane strain; a ring with a bore pressed into another with an interference, under an outer pressure
//! `a + b cos 2t`; three pairs of materials.
//!
//! REFERENCE: Lamé for the mean of the pressure; the stress function of J. H. Michell, 1899, for its part with cos 2t.

use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};
use signorini::solve_qp;
use support::scenes::built;

/// Bore, interface and outside.
const RADII: [f64; 3] = [0.5, 1.0, 2.0];

/// The pressure outside is `LOAD[0] + LOAD[1] cos 2t`.
const LOAD: [f64; 2] = [0.5, 0.2];

/// The radial interference of both rings, in a linear model.
const INTERFERENCE: f64 = 1.0;

/// Places of the load, between which it is linear: an error below 1e-4 of it.
const PLACES: usize = 401;

/// Two rings in plane strain: Young's moduli and Poisson's ratios from inside.
#[derive(Clone, Copy, Debug)]
struct Rings {
    young: [f64; 2],
    poisson: [f64; 2],
}

impl Rings {
    fn shear(&self, ring: usize) -> f64 {
        self.young[ring] / (2.0 * (1.0 + self.poisson[ring]))
    }

    /// The mean pressure on the interface: `u_r = A r + B / r` and `stress_rr = 2 G (A / (1 - 2 nu) - B / r^2)` in each
    /// ring.
    fn mean(&self) -> f64 {
        let displacement = |ring: usize, inside: f64, outside: f64| {
            let (shear, nu) = (self.shear(ring), self.poisson[ring]);
            let [low, high] = [RADII[ring], RADII[ring + 1]].map(|radius| 2.0 * shear / (radius * radius));
            let b = (inside - outside) / (low - high);
            let a = (b * low - inside) * (1.0 - 2.0 * nu) / (2.0 * shear);
            a * RADII[1] + b / RADII[1]
        };
        let opening =
            |pressure: f64| displacement(1, pressure, LOAD[0]) - displacement(0, 0.0, pressure) - INTERFERENCE;
        -opening(0.0) / (opening(1.0) - opening(0.0))
    }

    /// The amplitude of the pressure on the interface that goes with cos 2t, by the stress function
    /// `(A r^2 + B r^4 + C / r^2 + D) cos 2t` of each ring (J. H. Michell, 1899), without shear stress at the three
    /// radii.
    fn amplitude(&self) -> f64 {
        let normal = |r: f64| [-2.0, 0.0, -6.0 / r.powi(4), -4.0 / (r * r)];
        let shear = |r: f64| [2.0, 6.0 * r * r, -6.0 / r.powi(4), -2.0 / (r * r)];
        let radial = |ring: usize, r: f64| {
            let kappa = 3.0 - 4.0 * self.poisson[ring];
            [-2.0 * r, (kappa - 3.0) * r.powi(3), 2.0 / r.powi(3), (kappa + 1.0) / r]
                .map(|part| part / (2.0 * self.shear(ring)))
        };
        // Four coefficients of each ring, and the pressure on the interface.
        let (mut matrix, mut right) = (DMatrix::zeros(9, 9), DVector::zeros(9));
        for ring in 0..2 {
            for (end, radius) in [RADII[ring], RADII[ring + 1]].into_iter().enumerate() {
                let equation = 4 * ring + 2 * end;
                for (place, (stress, slip)) in normal(radius).into_iter().zip(shear(radius)).enumerate() {
                    matrix[(equation, 4 * ring + place)] = stress;
                    matrix[(equation + 1, 4 * ring + place)] = slip;
                }
                matrix[(equation, 8)] = if radius == RADII[1] { 1.0 } else { 0.0 };
            }
            for (place, part) in radial(ring, RADII[1]).into_iter().enumerate() {
                matrix[(8, 4 * ring + place)] = if ring == 0 { part } else { -part };
            }
        }
        // The second ring outside.
        right[6] = -LOAD[1];
        matrix.lu().solve(&right).expect("the rings are held")[8]
    }

    fn scene(&self, element: &str, counts: [usize; 2], side: &str) -> Value {
        let ring = |body: usize| {
            let radius =
                json!({"points": [RADII[body], RADII[body + 1]], "divisions": [counts[body] / 12 * (body + 1)]});
            json!({"ring": {"radius": radius, "element": element, "angle": {"points": [0, 360], "divisions": [counts[body]]}}})
        };
        let places: Vec<f64> = (0..PLACES).map(|at| RADII[2] * (2.0 * at as f64 / (PLACES - 1) as f64 - 1.0)).collect();
        let of_place = |x: &f64| LOAD[0] + LOAD[1] * (2.0 * (x / RADII[2]).powi(2) - 1.0);
        let factors: Vec<f64> = places.iter().map(of_place).collect();
        let held = |x: f64, y: f64, axis: &str| json!({"on": {"point": [x, y]}, axis: 0});
        let supports: Vec<Value> = [RADII[0], RADII[2]]
            .into_iter()
            .flat_map(|radius| [held(radius, 0.0, "y"), held(-radius, 0.0, "y"), held(0.0, radius, "x")])
            .collect();
        json!({
            "body": ring(0), "material": {"young": self.young[0], "poisson": self.poisson[0]},
            "further-bodies": [{"name": "hub", "body": ring(1), "material": {"young": self.young[1], "poisson": self.poisson[1]}}],
            "supports": supports,
            "loads": [{"pressure": {"boundary": "hub.outer", "value": 1,
                                    "profile": {"along": [1, 0], "places": places, "factors": factors}}}],
            "obstacles": [{"boundary": "outer", "approach": "+x", "rule": "closest-point",
                           "shape": {"body": {"boundary": "hub.inner", "rows": "mortar", "side": side,
                                              "fit": {"interference": INTERFERENCE}}}}],
        })
    }

    /// The error of the pressure over the interface in the mean square, relative to the pressure.
    fn error(&self, element: &str, counts: [usize; 2], side: &str) -> f64 {
        let model = built(&self.scene(element, counts, side));
        let solution = solve_qp(model.problem()).unwrap();
        let [mean, amplitude] = [self.mean(), self.amplitude()];
        let (mut away, mut whole) = (0.0, 0.0);
        for (row, pressure) in model.rows().iter().zip(model.pressure(&solution.multiplier).unwrap()) {
            let [x, y, _] = model.mesh().nodes()[row.node];
            let exact = mean + amplitude * (2.0 * y.atan2(x)).cos();
            away += row.tributary_area * (pressure - exact).powi(2);
            whole += row.tributary_area * exact * exact;
        }
        (away / whole).sqrt()
    }
}

/// The finer mesh or the coarser one carries the rows, on rings as stiff as each other, a stiffer and a softer shaft.
#[test]
fn a_pressure_that_changes_around_an_interface_passes_between_rings() {
    let rings = [
        Rings { young: [1.0, 1.0], poisson: [0.3, 0.3] },
        Rings { young: [3.0, 1.0], poisson: [0.3, 0.25] },
        Rings { young: [1.0, 10.0], poisson: [0.3, 0.3] },
    ];
    for rings in rings {
        for side in ["this", "other"] {
            // Rows on the finer mesh follow what the coarser one cannot represent.
            let of_quadratic = if side == "this" { 3e-3 } else { 1e-2 };
            for (element, counts, most, order) in [("q4", [96, 144], 1e-2, 0.9), ("q8", [48, 72], of_quadratic, 1.3)] {
                let fine = rings.error(element, counts, side);
                let coarse = rings.error(element, counts.map(|count| count / 2), side);
                let name = format!("{rings:?} {element} {side}: {coarse:.2e} and {fine:.2e}");
                assert!(fine < most, "{name}");
                assert!((coarse / fine).log2() > order, "{name}");
            }
        }
    }
}

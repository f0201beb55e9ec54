//! The estimated error of the mesh, compared with exact solutions.

use serde_json::json;
use signorini::fem::ElementKind::{Q4, Q8, T3, T6};
use signorini::fem::Integration;
use signorini::scene::Answer;
use signorini::solve_qp;
use support::closed_forms::manufactured::{ContactSolution, GenericEdge, HertzBlock, PlaneElasticity, Smooth};
use support::manufactured::solve_block;
use support::scenes::built;

/// Required effectivity of an estimate: between half and twice the error.
const EFFECTIVITY: std::ops::Range<f64> = 0.5..2.0;

#[test]
fn the_estimate_is_near_the_error_of_blocks_with_an_exact_solution() {
    let elasticity = PlaneElasticity::plane_strain(1.0, 0.3);
    let smooth = Smooth { elasticity, opening: 1.0, pressure: 1.0, edge: 0.5, power: 3 };
    let edge = GenericEdge { elasticity, edge: 0.53, pressure: 1.0 };
    let hertz = HertzBlock { elasticity, half_width: 0.53, peak_pressure: 1.0 };
    for (name, exact) in [("smooth", &smooth as &dyn ContactSolution), ("edge", &edge), ("Hertz", &hertz)] {
        for kind in [T3, Q4, T6, Q8] {
            for cells in [8, 32] {
                let block = solve_block(exact, kind, Integration::Standard, cells).unwrap();
                let effectivity = block.estimated_energy_error().unwrap() / block.errors().energy;
                assert!(EFFECTIVITY.contains(&effectivity), "{name}, {kind:?}, n = {cells}: {effectivity}");
                // Averaged stresses of linear elements converge faster than the stresses of the elements: the estimate
                // is asymptotically exact.
                let exact_to = if cells == 32 && !kind.is_quadratic() { 0.02 } else { 1.0 };
                assert!((effectivity - 1.0).abs() < exact_to, "{name}, {kind:?}, n = {cells}: {effectivity}");
            }
        }
    }
}

#[test]
fn the_estimate_vanishes_if_the_mesh_is_exact_and_falls_on_finer_meshes() {
    let scene = |model: &str, body: &serde_json::Value, bottom: &str, gap: f64, shape: serde_json::Value| {
        let (up, side) = if model == "space" {
            ("z", json!({"on": {"boundary": "front"}, "y": 0}))
        } else {
            ("y", json!({"on": {"boundary": "left"}, "x": 0}))
        };
        let value = json!({
            "model": model, "body": body, "material": {"young": 10, "poisson": 0.3},
            "supports": [{"on": {"boundary": bottom}, up: 0}, {"on": {"boundary": "left"}, "x": 0}, side],
            "obstacles": [{"boundary": "top", "approach": format!("+{up}"), "shape": shape}], "gap": gap,
        });
        let model = built(&value);
        let solution = solve_qp(model.problem()).unwrap();
        Answer::of(model.into(), &solution).unwrap().discretisation_error().unwrap()
    };
    let axis = |cells: usize| json!({"points": [0, 1], "divisions": [cells]});
    for (model, element) in
        [("plane-strain", "t3"), ("plane-stress", "t6"), ("plane-strain", "q4"), ("axisymmetric", "q8")]
    {
        let block = |cells: usize| json!({"rectangle": {"x": axis(cells), "y": axis(cells), "element": element}});
        let flat = json!({"plane": {"point": [0, 1], "normal": [0, 1]}});
        // Under uniform pressure only rounding is left.
        assert!(scene(model, &block(4), "bottom", -0.01, flat) < 1e-9, "{model} {element}");
        let round = || json!({"parabola": {"apex": [0, 1], "radius": 2}});
        let [coarse, fine] = [8, 32].map(|cells| scene(model, &block(cells), "bottom", -0.05, round()));
        assert!(coarse / fine > 2.5 && coarse < 0.5, "{model} {element}: {coarse} {fine}");
    }
    for element in ["tet4", "hex8"] {
        let block =
            |cells: usize| json!({"box": {"x": axis(cells), "y": axis(cells), "z": axis(cells), "element": element}});
        let flat = json!({"plane": {"point": [0, 0, 1], "normal": [0, 0, 1]}});
        assert!(scene("space", &block(3), "bottom", -0.01, flat) < 1e-9, "{element}");
        let round = || json!({"sphere": {"apex": [0, 0, 1], "radius": 2}});
        let [coarse, fine] = [4, 8].map(|cells| scene("space", &block(cells), "bottom", -0.05, round()));
        assert!(coarse / fine > 1.2 && coarse < 0.8, "{element}: {coarse} {fine}");
    }
}

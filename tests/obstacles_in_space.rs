//! GOAL: contact rows of the obstacles in space, by both rules, against formulas and searches that share nothing with
//! the library; a brick under a sphere.
//!
//! BODY: clamped unit cube of 4 x 4 x 4 Hex8; candidates are the nodes of its top, z = 1.

mod bodies;

use bodies::built;
use serde_json::{Value, json};
use signorini::{Model, Scene, solve_qp};

/// Distances of order one, a handful of operations.
const ROUNDING: f64 = 1e-14;

/// A search finds a minimum to the square root of rounding; the distance itself is then exact to rounding.
const SEARCHED: f64 = 1e-12;

fn scene(rule: &str, shape: Value, gap: f64) -> Value {
    let axis = json!({"points": [0, 1], "divisions": [4]});
    json!({
        "model": "space",
        "body": {"box": {"x": axis, "y": axis, "z": axis, "element": "hex8"}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z", "rule": rule, "shape": shape}],
        "gap": gap
    })
}

fn top(rule: &str, shape: Value, gap: f64) -> Model {
    built(&scene(rule, shape, gap))
}

type Height = Box<dyn Fn(f64, f64) -> f64>;

/// Shapes above and partly inside the cube, each with its height z(x, y).
fn shapes() -> Vec<(Value, Height)> {
    let mut shapes: Vec<(Value, Height)> = Vec::new();
    for z in [1.2, 0.95] {
        let sphere = move |x: f64, y: f64| z + 1.5 - (2.25 - (x - 0.43).powi(2) - (y - 0.37).powi(2)).sqrt();
        shapes.push((json!({"sphere": {"apex": [0.43, 0.37, z], "radius": 1.5}}), Box::new(sphere)));
        shapes.push((json!({"sphere": {"centre": [0.43, 0.37, z + 1.5], "radius": 1.5}}), Box::new(sphere)));
        // Across the axis (3, 4): the coordinate is (4 x - 3 y)/5.
        let across = |x: f64, y: f64| 0.8 * (x - 0.43) - 0.6 * (y - 0.37);
        let cylinder = move |x: f64, y: f64| z + 1.5 - (2.25 - across(x, y).powi(2)).sqrt();
        let spec = json!({"cylinder": {"apex": [0.43, 0.37, z], "axis": [3, 4, 0], "radius": 1.5}});
        shapes.push((spec, Box::new(cylinder)));
        let cone = move |x: f64, y: f64| z + 0.6 * (x - 0.43).hypot(y - 0.37);
        shapes.push((json!({"cone": {"apex": [0.43, 0.37, z], "slope": 0.6}}), Box::new(cone)));
        // One bilinear cell: heights z + 0.1 x - 0.2 y + 0.15 x y.
        let bilinear = move |x: f64, y: f64| z + 0.1 * x - 0.2 * y + 0.15 * x * y;
        let heights: Vec<Vec<f64>> =
            [-2.0, 3.0].iter().map(|&x| [-2.0, 3.0].iter().map(|&y| bilinear(x, y)).collect()).collect();
        let map = json!({"height-map": {"x": [-2, 3], "y": [-2, 3], "heights": heights}});
        shapes.push((map, Box::new(bilinear)));
        // Creases along x = 0.4 and y = 0.6.
        let roof = move |x: f64, y: f64| z + 0.5 * (x - 0.4).abs() - 0.3 * (y - 0.6).abs();
        let lines = ([-2.0, 0.4, 3.0], [-2.0, 0.6, 3.0]);
        let heights: Vec<Vec<f64>> = lines.0.iter().map(|&x| lines.1.iter().map(|&y| roof(x, y)).collect()).collect();
        let map = json!({"height-map": {"x": lines.0, "y": lines.1, "heights": heights}});
        shapes.push((map, Box::new(roof)));
    }
    shapes
}

#[test]
fn along_the_approach_direction_the_gap_is_the_height_above_the_node() {
    for (shape, height) in shapes() {
        let model = top("approach", shape.clone(), -0.03);
        assert_eq!(model.rows().len(), 25, "{shape}");
        assert_eq!(model.problem().contact().entries(), 25, "one entry a row: {shape}");
        for row in model.rows() {
            let [x, y, z] = model.mesh().nodes()[row.node];
            assert_eq!(row.normal, [0.0, 0.0, 1.0]);
            assert!((row.gap - (height(x, y) - 0.03 - z)).abs() < ROUNDING, "{shape} {row:?}");
        }
    }
}

/// The smallest distance to the graph, on ever finer grids around the best point so far.
fn searched_distance(node: [f64; 3], height: &Height) -> f64 {
    let distance = |x: f64, y: f64| (x - node[0]).hypot(y - node[1]).hypot(height(x, y) - node[2]);
    let (mut centre, mut reach, mut best) = ([node[0], node[1]], 0.5, f64::INFINITY);
    while reach > 1e-14 {
        let middle = centre;
        for i in -20..=20 {
            for j in -20..=20 {
                let at = [middle[0] + reach * f64::from(i) / 20.0, middle[1] + reach * f64::from(j) / 20.0];
                if distance(at[0], at[1]) < best {
                    (best, centre) = (distance(at[0], at[1]), at);
                }
            }
        }
        reach *= 0.5;
    }
    best
}

#[test]
fn closest_points_are_the_nearest_of_all_and_lie_on_the_surface_along_the_unit_normal() {
    for (shape, height) in shapes() {
        let model = top("closest-point", shape.clone(), 0.0);
        assert_eq!(model.rows().len(), 25, "{shape}");
        for row in model.rows() {
            let [x, y, z] = model.mesh().nodes()[row.node];
            let sense = if z > height(x, y) { -1.0 } else { 1.0 };
            let expected = sense * searched_distance([x, y, z], &height);
            assert!((row.gap - expected).abs() < SEARCHED, "{shape} at {x}, {y}: {} and {expected}", row.gap);
            let [nx, ny, nz] = row.normal;
            assert!((nx.hypot(ny).hypot(nz) - 1.0).abs() < ROUNDING && nz > 0.0, "{shape} {row:?}");
            let foot = [x + row.gap * nx, y + row.gap * ny, z + row.gap * nz];
            assert!((height(foot[0], foot[1]) - foot[2]).abs() < SEARCHED, "{shape} {row:?}");
        }
    }
}

#[test]
fn a_brick_under_a_sphere_has_symmetric_pressures_and_balanced_forces() {
    for rule in ["approach", "closest-point"] {
        let model = top(rule, json!({"sphere": {"apex": [0.5, 0.5, 1], "radius": 2}}), -0.05);
        let solution = solve_qp(model.problem()).unwrap();
        assert!(solution.contact_force() > 1.0);
        let pressure = model.pressure(&solution.multiplier).unwrap();
        let largest = pressure.iter().fold(0.0_f64, |largest, p| largest.max(*p));
        let at = |x: f64, y: f64| {
            let found = model.rows().iter().position(|row| model.mesh().nodes()[row.node] == [x, y, 1.0]).unwrap();
            pressure[found]
        };
        for row in model.rows() {
            let [x, y, _] = model.mesh().nodes()[row.node];
            for (a, b) in [(y, x), (1.0 - x, y), (x, 1.0 - y)] {
                assert!((at(x, y) - at(a, b)).abs() < 1e-10 * largest, "{rule} {x} {y}");
            }
        }
        let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
        assert!(balance < 1e-12, "{rule}: {balance}");
    }
}

#[test]
fn shapes_that_do_not_fit_and_broken_height_maps_are_refused_at_their_place() {
    let map = |x: Value, y: Value, heights: Value| json!({"height-map": {"x": x, "y": y, "heights": heights}});
    let flat = json!([[1, 1], [1, 1]]);
    for (shape, path, words) in [
        (json!({"circle": {"apex": [0, 1], "radius": 1}}), "obstacles[0].shape", "`circle` is a shape of the plane"),
        (map(json!([1, 0]), json!([0, 1]), flat.clone()), "height-map.x[1]", "must increase"),
        (map(json!([0]), json!([0, 1]), flat.clone()), "height-map.x", "at least two"),
        (map(json!([0, 1]), json!([0, 1]), json!([[1, 1]])), "height-map.heights", "1 rows"),
        (map(json!([0, 1]), json!([0, 1]), json!([[1, 1], [1]])), "height-map.heights[1]", "1 entries"),
        (map(json!([0, 1]), json!([0, 0.5]), flat), "height-map.y", "candidate node"),
        (json!({"cone": {"apex": [0, 0, 1], "slope": 0}}), "cone.slope", "positive"),
        (json!({"cylinder": {"apex": [0, 0, 1], "axis": [0, 1, 1], "radius": 1}}), "cylinder.axis", "perpendicular"),
        (json!({"cylinder": {"apex": [0, 0, 1], "axis": [0, 0, 0], "radius": 1}}), "cylinder.axis", "no direction"),
    ] {
        let text = scene("approach", shape, 0.0).to_string();
        let error = Scene::from_json(&text, "scene").unwrap().build().unwrap_err().to_string();
        assert!(error.contains(path) && error.contains(words), "{error}");
    }
}

#[test]
fn a_body_of_revolution_meets_a_sphere_and_a_cone_as_curves_of_its_half_plane() {
    let lines = json!({"points": [0, 1], "divisions": [8]});
    for (shape, expected) in [
        (json!({"circle": {"apex": [0, 1.1], "radius": 2}}), (|r: f64| r.hypot(2.1) - 2.0) as fn(f64) -> f64),
        (json!({"wedge": {"apex": [0, 1.1], "slope": 0.75}}), |r: f64| {
            if r < 0.075 { 0.1f64.hypot(r) } else { 0.8 * 0.1 + 0.6 * r }
        }),
    ] {
        let model = built(&json!({
            "model": "axisymmetric",
            "body": {"rectangle": {"x": lines, "y": lines, "element": "q4"}},
            "material": {"young": 1000, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "y": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "rule": "closest-point", "shape": shape}],
        }));
        assert_eq!(model.rows().len(), 9);
        for row in model.rows() {
            let r = model.mesh().nodes()[row.node][0];
            assert!((row.gap - expected(r)).abs() < ROUNDING, "{shape} {row:?} {}", expected(r));
            assert!(r > 0.0 || row.normal == [0.0, 1.0, 0.0], "{row:?}");
        }
        let pressed = model.with_gap(-0.15).unwrap();
        let solution = solve_qp(pressed.problem()).unwrap();
        assert!(solution.contact_force() > 0.0);
        let on_axis = pressed.rows().iter().position(|row| pressed.mesh().nodes()[row.node][0] == 0.0).unwrap();
        assert!(solution.multiplier[on_axis] < 0.0);
    }
}

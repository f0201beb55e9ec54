//! GOAL: contact rows of concave circles, spheres and cylinders and of tori, by both rules, compared with distance
//! functions that share no code with the library; the guaranteed enclosure of a concave circle; a ball in a cup.
//!
//! BODY: a clamped unit square of 8 x 8 Q4, or a unit cube of 4 x 4 x 4 Hex8; candidates are the nodes of the top.

use serde_json::{Value, json};
use signorini::{Model, Scene, solve_qp};
use support::bodies::clamped_square;
use support::bodies::cube_under;
use support::closed_forms::PointContact;
use support::scenes::built;

/// Rounding of distances of order one to concave surfaces.
const ROUNDING: f64 = 1e-14;

fn square(rule: &str, shape: Value, gap: f64) -> Model {
    built(&clamped_square(8, json!([{"boundary": "top", "approach": "+y", "rule": rule, "shape": shape}]), gap))
}

fn cube(rule: &str, shape: Value, gap: f64) -> Model {
    built(&cube_under(rule, shape, gap))
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// A function of position that is zero on the surface of the obstacle and grows by 1 per unit of length into it.
type Depth = Box<dyn Fn([f64; 3]) -> f64>;

/// Checks the rows of the closest-point rule: the gap is the distance, and the normal points straight to the surface.
fn check_closest(model: &Model, depth: &Depth, shift: [f64; 3], what: &Value) {
    assert!(!model.rows().is_empty(), "{what}");
    for row in model.rows() {
        let at = model.mesh().nodes()[row.node];
        let at = [0, 1, 2].map(|axis| at[axis] - shift[axis]);
        assert!((row.gap + depth(at)).abs() < ROUNDING, "{what} {row:?} {}", depth(at));
        assert!((length(row.normal) - 1.0).abs() < ROUNDING, "{what} {row:?}");
        let foot = [0, 1, 2].map(|axis| at[axis] + row.gap * row.normal[axis]);
        assert!(depth(foot).abs() < ROUNDING, "{what} {row:?}");
        // Into the obstacle, the depth grows by the length of the path.
        let further = [0, 1, 2].map(|axis| foot[axis] + 0.01 * row.normal[axis]);
        assert!((depth(further) - 0.01).abs() < ROUNDING, "{what} {row:?}");
    }
}

/// Checks the rows along the approach direction: each ends at a point at which the depth is zero and grows.
fn check_approach(model: &Model, depth: &Depth, shift: [f64; 3], what: &Value) {
    assert!(!model.rows().is_empty(), "{what}");
    for row in model.rows() {
        let at = model.mesh().nodes()[row.node];
        let foot = |way: f64| [0, 1, 2].map(|axis| at[axis] - shift[axis] + way * row.normal[axis]);
        // A change of position changes the depth by at most its length, for every slope of the surface.
        assert!(depth(foot(row.gap)).abs() < ROUNDING, "{what} {row:?} {}", depth(foot(row.gap)));
        assert!(depth(foot(row.gap + 1e-3)) > 0.0 && depth(foot(row.gap - 1e-3)) < 0.0, "{what} {row:?}");
    }
}

#[test]
fn a_square_in_a_circle_has_rows_to_the_circle_around_it() {
    // The centre is below the top of the square, on it, and above it.
    for centre in [[0.4, 0.6], [0.5, 1.0], [0.47, 1.3]] {
        let depth: Depth = Box::new(move |[x, y, _]| (x - centre[0]).hypot(y - centre[1]) - 0.9);
        for shape in [
            json!({"circle": {"centre": centre, "radius": 0.9, "side": "inside"}}),
            json!({"circle": {"apex": [centre[0], centre[1] + 0.9], "radius": 0.9, "side": "inside"}}),
        ] {
            let shift = [0.0, -0.03, 0.0];
            let model = square("approach", shape.clone(), -0.03);
            assert!(model.rows().iter().all(|row| row.normal == [0.0, 1.0, 0.0]));
            check_approach(&model, &depth, shift, &shape);
            let model = square("closest-point", shape.clone(), -0.03);
            assert_eq!(model.rows().len(), 9, "{shape}");
            check_closest(&model, &depth, shift, &shape);
        }
    }
}

#[test]
fn the_row_of_a_node_at_the_centre_of_a_circle_has_the_approach_direction() {
    let shape = json!({"circle": {"centre": [0.5, 1.0], "radius": 0.9, "side": "inside"}});
    let model = square("closest-point", shape, 0.0);
    let row = model.rows().iter().find(|row| model.mesh().nodes()[row.node] == [0.5, 1.0, 0.0]).unwrap();
    assert_eq!(row.normal, [0.0, 1.0, 0.0]);
    assert!((row.gap - 0.9).abs() < ROUNDING);
}

#[test]
fn the_gap_to_a_circle_on_a_stretch_stays_within_its_enclosure() {
    for side in ["inside", "outside"] {
        let centre = if side == "inside" { [0.4, 0.6] } else { [0.4, 2.1] };
        let shape = json!({"circle": {"centre": centre, "radius": 0.9, "side": side}});
        let model = square("approach", shape, 0.0);
        let circle = model.obstacles()[0].rigid().unwrap();
        let sense = if side == "inside" { 1.0 } else { -1.0 };
        let exact = |x: f64| centre[1] + sense * (0.81 - (x - centre[0]).powi(2)).max(0.0).sqrt() - 1.0;
        for (from, to) in [(0.3, 0.5), (0.0, 0.2), (0.6, 1.2), (1.29, 1.299), (-0.4, 1.3)] {
            let at = |x: f64| [x, 1.0, 0.0];
            let (values, [below, above]) = circle.gap_along(at(from), at(to), 0.0).unwrap();
            assert!(below >= 0.0 && above >= 0.0);
            let narrow = to - from < 0.15;
            for step in 0..=1000 {
                let t = step as f64 / 1000.0;
                let quadratic = values[0] * (1.0 - t) * (1.0 - 2.0 * t)
                    + 4.0 * values[1] * t * (1.0 - t)
                    + values[2] * t * (2.0 * t - 1.0);
                let off = exact(from + t * (to - from)) - quadratic;
                assert!(off >= -below - ROUNDING && off <= above + ROUNDING, "{side} {from} {to} {off}");
            }
            assert!(!narrow || below.max(above) < 0.01 || to > 1.29, "{side} {from} {to}: {below} {above}");
        }
        // If the circle ends inside the stretch, the values are a lower bound of the gap, and there is no upper bound.
        let (values, [below, above]) = circle.gap_along([1.0, 1.0, 0.0], [1.6, 1.0, 0.0], 0.0).unwrap();
        assert!(below == 0.0 && above == f64::INFINITY);
        let lowest = (0..=300).map(|step| exact(1.0 + step as f64 / 1000.0)).fold(f64::INFINITY, f64::min);
        assert!(values.iter().all(|&value| value <= lowest), "{side} {values:?} {lowest}");
        assert!(circle.gap_along([1.4, 1.0, 0.0], [1.6, 1.0, 0.0], 0.0).is_none());
        let by_normals =
            square("closest-point", json!({"circle": {"centre": centre, "radius": 0.9, "side": side}}), 0.0);
        assert!(by_normals.obstacles()[0].rigid().unwrap().gap_along([0.3, 1.0, 0.0], [0.5, 1.0, 0.0], 0.0).is_none());
    }
}

#[test]
fn a_cube_in_a_sphere_or_a_cylinder_has_rows_to_the_surface_around_it() {
    let shift = [0.0, 0.0, -0.03];
    for centre in [[0.45, 0.4, 0.6], [0.5, 0.5, 1.0], [0.47, 0.52, 1.3]] {
        let [cx, cy, cz] = centre;
        let ball: Depth = Box::new(move |[x, y, z]| length([x - cx, y - cy, z - cz]) - 1.1);
        // The axis (3, 4, 0)/5, and the horizontal coordinate perpendicular to it.
        let tube: Depth = Box::new(move |[x, y, z]| (0.8 * (x - cx) - 0.6 * (y - cy)).hypot(z - cz) - 1.1);
        for (shape, depth) in [
            (json!({"sphere": {"centre": centre, "radius": 1.1, "side": "inside"}}), &ball),
            (json!({"sphere": {"apex": [cx, cy, cz + 1.1], "radius": 1.1, "side": "inside"}}), &ball),
            (json!({"cylinder": {"centre": centre, "axis": [3, 4, 0], "radius": 1.1, "side": "inside"}}), &tube),
        ] {
            let model = cube("approach", shape.clone(), -0.03);
            assert_eq!(model.rows().len(), 25, "{shape}");
            check_approach(&model, depth, shift, &shape);
            let model = cube("closest-point", shape.clone(), -0.03);
            assert_eq!(model.rows().len(), 25, "{shape}");
            check_closest(&model, depth, shift, &shape);
        }
    }
}

#[test]
fn a_torus_has_the_rows_of_its_distance_function() {
    let shift = [0.0, 0.0, -0.02];
    for (axis, centre, rows) in [
        // A torus lying flat in front of the body: some nodes face the tube, some the hole.
        ([0.0, 0.0, -2.0], [0.45, 0.55, 1.28], 1..26),
        ([0.0, 0.0, -2.0], [0.45, 0.55, 1.23], 1..26),
        // A torus standing upright across the body, with its ring far above the top or inside it.
        ([3.0, 4.0, 0.0], [0.45, 0.55, 1.75], 1..26),
        ([0.0, 1.0, 0.0], [0.47, 0.53, 1.66], 5..26),
    ] {
        let unit = axis.map(|part| part / length(axis));
        let depth: Depth = Box::new(move |at| {
            let way = [0, 1, 2].map(|axis| at[axis] - centre[axis]);
            let along: f64 = (0..3).map(|axis| way[axis] * unit[axis]).sum();
            let radius = length([0, 1, 2].map(|axis| way[axis] - along * unit[axis]));
            0.25 - (radius - 0.45).hypot(along)
        });
        let shape = json!({"torus": {"centre": centre, "axis": axis, "major": 0.45, "minor": 0.25}});
        for rule in ["approach", "closest-point"] {
            let model = cube(rule, shape.clone(), -0.02);
            assert!(rows.contains(&model.rows().len()), "{rule} {shape} {}", model.rows().len());
            match rule {
                "approach" => check_approach(&model, &depth, shift, &shape),
                _ => check_closest(&model, &depth, shift, &shape),
            }
        }
    }
}

#[test]
fn on_the_axis_of_a_flat_torus_the_row_ends_at_the_planes_through_the_closest_points() {
    let shape = json!({"torus": {"centre": [0.5, 0.5, 1.4], "axis": [0, 0, 1], "major": 0.3, "minor": 0.1}});
    let model = cube("closest-point", shape, 0.0);
    let row = model.rows().iter().find(|row| model.mesh().nodes()[row.node] == [0.5, 0.5, 1.0]).unwrap();
    // The ring is at the distance 0.5 and its surface at 0.4; the direction to it has the cosine 0.8.
    assert_eq!(row.normal, [0.0, 0.0, 1.0]);
    assert!((row.gap - 0.5).abs() < ROUNDING, "{row:?}");
}

/// GOAL       a ball in a cup with a radius larger by a half
/// CONDITIONS axisymmetric; the cut of the half ball moves rigidly by delta into the cup; no friction
/// PARAMETERS R1 = 1, R2 = 1.5, E = 1, nu = 0.3, delta = 0.0012: the contact has the radius sqrt(R delta) = 0.06
/// REFERENCE  Hertz with 1/R = 1/R1 - 1/R2, R = 3: F = 4/3 E* sqrt(R) delta^1.5, p0 = 2 E* a/(pi R)
#[test]
fn a_ball_in_a_cup_has_the_force_and_the_pressure_of_hertz_with_the_difference_of_curvatures() {
    let delta = 0.0012;
    let hertz = PointContact { modulus: 1.0 / 0.91, radius: 3.0 };
    for rule in ["approach", "closest-point"] {
        let scene = json!({
            "model": "axisymmetric",
            "body": {"half-disc": {"radius": 1, "symmetric": true,
                "zone": {"width": 0.075, "divisions": 8, "growth": 1.5}, "element": "q8"}},
            "material": {"young": 1, "poisson": 0.3},
            "supports": [{"on": {"boundary": "cut"}, "y": -delta}, {"on": {"boundary": "symmetry-x"}, "x": 0}],
            "obstacles": [{"boundary": "arc", "approach": "-y", "rule": rule,
                "shape": {"circle": {"apex": [0, -1], "radius": 1.5, "side": "inside"}}}],
        });
        let model = built(&scene);
        let solution = solve_qp(model.problem()).unwrap();
        let force = solution.contact_force();
        assert!((force / hertz.force(delta) - 1.0).abs() < 0.04, "{rule}: {force} {}", hertz.force(delta));
        let pressure = model.pressure(&solution.multiplier).unwrap();
        let peak = pressure.iter().copied().fold(0.0, f64::max);
        assert!(
            (peak / hertz.peak_pressure(force) - 1.0).abs() < 0.03,
            "{rule}: {peak} {}",
            hertz.peak_pressure(force)
        );
    }
}

#[test]
fn an_invalid_torus_and_an_invalid_side_are_refused_with_their_field() {
    let torus = |key: &str, value: Value| {
        let mut shape = json!({"torus": {"centre": [0, 0, 2], "axis": [0, 0, 1], "major": 0.5, "minor": 0.2}});
        shape["torus"][key] = value;
        shape
    };
    let circle = json!({"sphere": {"centre": [0, 0, 2], "radius": 1, "side": "within"}});
    for (shape, path, phrase) in [
        (torus("minor", json!(0.5)), "torus.minor", "it must be less than `major`, 0.5, or else the tube meets itself"),
        (torus("minor", json!(0)), "torus.minor", "must be positive"),
        (torus("major", json!(-1)), "torus.major", "must be positive"),
        (torus("axis", json!([0, 0, 0])), "torus.axis", "has no direction"),
        (
            torus("axis", json!([0, 1, 1])),
            "torus.axis",
            "parallel or perpendicular to the approach direction (0, 0, 1)",
        ),
        (circle, "sphere.side", "outside"),
    ] {
        let scene = Scene::from_json(&cube_under("approach", shape, 0.0).to_string(), "scene");
        let error = scene.and_then(|scene| scene.build()).map(drop).unwrap_err().to_string();
        assert!(error.contains(&format!("`obstacles[0].shape.{path}`")) && error.contains(phrase), "{error}");
    }
}

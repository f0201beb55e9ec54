//! GOAL: contact rows of the obstacles in space, by both rules, compared with formulas and searches that share no code
//! with the library; a brick under a sphere.
//!
//! BODY: a clamped unit cube of 4 x 4 x 4 Hex8; candidates are the nodes of its top, z = 1.

use serde_json::{Value, json};
use signorini::{Model, Scene, solve_qp};
use support::bodies::cube_under;
use support::scenes::built;

/// Rounding of distances of order one in space.
const ROUNDING: f64 = 1e-14;

/// A search finds the place of a minimum to the square root of rounding; the distance itself is then exact to rounding.
const SEARCHED: f64 = 1e-12;

fn top(rule: &str, shape: Value, gap: f64) -> Model {
    built(&cube_under(rule, shape, gap))
}

type Height = Box<dyn Fn(f64, f64) -> f64>;

/// Shapes above the cube and partly inside it, moved by `shift`, each with its height z(x, y).
fn shapes([dx, dy, dz]: [f64; 3]) -> Vec<(Value, Height)> {
    let mut shapes: Vec<(Value, Height)> = Vec::new();
    for z in [1.2 + dz, 0.95 + dz] {
        let (cx, cy) = (0.43 + dx, 0.37 + dy);
        let sphere = move |x: f64, y: f64| z + 1.5 - (2.25 - (x - cx).powi(2) - (y - cy).powi(2)).sqrt();
        shapes.push((json!({"sphere": {"apex": [cx, cy, z], "radius": 1.5}}), Box::new(sphere)));
        shapes.push((json!({"sphere": {"centre": [cx, cy, z + 1.5], "radius": 1.5}}), Box::new(sphere)));
        // The coordinate perpendicular to the axis (3, 4) is (4 x - 3 y)/5.
        let across = move |x: f64, y: f64| 0.8 * (x - cx) - 0.6 * (y - cy);
        let cylinder = move |x: f64, y: f64| z + 1.5 - (2.25 - across(x, y).powi(2)).sqrt();
        let spec = json!({"cylinder": {"apex": [cx, cy, z], "axis": [3, 4, 0], "radius": 1.5}});
        shapes.push((spec, Box::new(cylinder)));
        let cone = move |x: f64, y: f64| z + 0.6 * (x - cx).hypot(y - cy);
        shapes.push((json!({"cone": {"apex": [cx, cy, z], "slope": 0.6}}), Box::new(cone)));
        // One bilinear cell with the heights z + 0.1 x - 0.2 y + 0.15 x y.
        let bilinear = move |x: f64, y: f64| z + 0.1 * (x - dx) - 0.2 * (y - dy) + 0.15 * (x - dx) * (y - dy);
        shapes.push((height_map(&[-2.0 + dx, 3.0 + dx], &[-2.0 + dy, 3.0 + dy], &bilinear), Box::new(bilinear)));
        // The creases are at x = 0.4 and y = 0.6.
        let roof = move |x: f64, y: f64| z + 0.5 * (x - dx - 0.4).abs() - 0.3 * (y - dy - 0.6).abs();
        let lines = ([-2.0 + dx, 0.4 + dx, 3.0 + dx], [-2.0 + dy, 0.6 + dy, 3.0 + dy]);
        shapes.push((height_map(&lines.0, &lines.1, &roof), Box::new(roof)));
    }
    shapes
}

fn height_map(x: &[f64], y: &[f64], height: &dyn Fn(f64, f64) -> f64) -> Value {
    let heights: Vec<Vec<f64>> = x.iter().map(|&x| y.iter().map(|&y| height(x, y)).collect()).collect();
    json!({"height-map": {"x": x, "y": y, "heights": heights}})
}

#[test]
fn along_the_approach_direction_the_gap_is_the_height_above_the_node() {
    for (shape, height) in shapes([0.0; 3]) {
        let model = top("approach", shape.clone(), -0.03);
        assert_eq!(model.rows().len(), 25, "{shape}");
        assert_eq!(model.problem().contact().entries(), 25, "a row has more than one entry: {shape}");
        for row in model.rows() {
            let [x, y, z] = model.mesh().nodes()[row.node];
            assert_eq!(row.normal, [0.0, 0.0, 1.0]);
            assert!((row.gap - (height(x, y) - 0.03 - z)).abs() < ROUNDING, "{shape} {row:?}");
        }
    }
}

/// The smallest distance to the graph, found on finer and finer grids around the best point so far.
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
fn closest_points_are_the_nearest_points_and_are_on_the_surface_along_the_unit_normal() {
    for (shape, height) in shapes([0.0; 3]) {
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

/// A mid-side node at the rim of a cup with straight edges: 0.011 inside a radius of 16, 0.1 behind the centre.
#[test]
fn a_node_inside_at_the_rim_and_behind_the_centre_is_moved_out_to_its_side() {
    let (distance, behind): (f64, f64) = (1.0 - 0.011 / 16.0, 0.1 / 16.0);
    let aside = ((distance - behind) * (distance + behind)).sqrt();
    // Each with the middle of the section that the node lies in, and the direction to the side.
    let shapes = [
        (json!({"sphere": {"centre": [0.5, 0.5, 3], "radius": 1}}), [0.5, 0.5, 3.0], [0.6, 0.8]),
        (json!({"cylinder": {"centre": [0.5, 0, 3], "axis": [0, 1, 0], "radius": 1}}), [0.5, 0.7, 3.0], [-1.0, 0.0]),
        (
            json!({"torus": {"centre": [0, 0, 3], "axis": [0, 0, 1], "major": 5, "minor": 1}}),
            [3.0, 4.0, 3.0],
            [0.6, 0.8],
        ),
        (
            json!({"torus": {"centre": [0, 0, 8], "axis": [0, 1, 0], "major": 5, "minor": 1}}),
            [0.0, 0.0, 3.0],
            [0.0, 1.0],
        ),
    ];
    for (shape, middle, [x, y]) in shapes {
        let model = top("closest-point", shape.clone(), 0.0);
        let at = |aside: f64, behind: f64| [middle[0] + aside * x, middle[1] + aside * y, middle[2] + behind];
        let row = |at: [f64; 3]| model.obstacles()[0].rigid().unwrap().row(at);
        let found = row(at(aside, behind)).unwrap().unwrap();
        assert!((found.gap - (distance - 1.0)).abs() < 8.0 * ROUNDING, "{shape}: {found:?}");
        let normal = [-aside * x / distance, -aside * y / distance, -behind / distance];
        let off = (0..3).map(|axis| (found.normal[axis] - normal[axis]).abs()).fold(0.0, f64::max);
        assert!(off < 8.0 * ROUNDING, "{shape}: {found:?}");
        // Across the plane of the centre nothing jumps.
        let steps = [1e-9, -1e-9].map(|behind| row(at(0.9, behind)).unwrap().unwrap());
        assert!((steps[0].gap - steps[1].gap).abs() < 1e-8, "{shape}: {steps:?}");
        // Outside and behind there is no row, and deep inside no side is the right one.
        assert_eq!(row(at(1.1, 0.1)).unwrap(), None, "{shape}");
        for deep in [at(0.4, 0.1), at(0.1, 0.9)] {
            assert!(row(deep).unwrap_err().starts_with("lies deeper in the "), "{shape}");
        }
    }
}

#[test]
fn the_gap_grows_against_the_normal_as_the_obstacle_moves() {
    // Central differences: if the obstacle moves by h along an axis, the gap changes by h times the component of the
    // normal.
    let h = 1e-5;
    let gaps = |shift: [f64; 3]| -> Vec<Vec<f64>> {
        let models = shapes(shift).into_iter().map(|(shape, _)| top("closest-point", shape, 0.0));
        models.map(|model| model.rows().iter().map(|row| row.gap).collect()).collect()
    };
    let differences: Vec<[Vec<Vec<f64>>; 2]> = (0..3)
        .map(|axis| {
            [h, -h].map(|step| {
                let mut shift = [0.0; 3];
                shift[axis] = step;
                gaps(shift)
            })
        })
        .collect();
    for (index, (shape, _)) in shapes([0.0; 3]).into_iter().enumerate() {
        for (row, contact) in top("closest-point", shape.clone(), 0.0).rows().iter().enumerate() {
            for (axis, [ahead, behind]) in differences.iter().enumerate() {
                let slope = (ahead[index][row] - behind[index][row]) / (2.0 * h);
                // Third derivatives of the distance are below 100, and rounding divided by the step is below 1e-10.
                assert!((slope - contact.normal[axis]).abs() < 1e-8, "{shape} {contact:?} axis {axis}: {slope}");
            }
        }
    }
}

/// The image of a point or a direction under another side: the two coordinates along the side keep their order, the
/// height becomes the coordinate along the outward normal of the side.
fn placed([x, y, z]: [f64; 3], axis: usize, sense: f64, origin: f64) -> [f64; 3] {
    let mut placed = [[0.0, x, y], [x, 0.0, y], [x, y, 0.0]][axis];
    placed[axis] = if sense > 0.0 { z } else { origin - z };
    placed
}

#[test]
fn the_rows_of_every_approach_direction_are_the_same_after_a_rotation() {
    let shape = |name: &str, axis: usize, sense: f64| {
        let point = |at: [f64; 3]| json!(placed(at, axis, sense, 1.0));
        match name {
            "sphere" => json!({"sphere": {"apex": point([0.43, 0.37, 0.97]), "radius": 1.5}}),
            "centred" => json!({"sphere": {"centre": point([0.43, 0.37, 2.4]), "radius": 1.5}}),
            "cylinder" => json!({"cylinder": {
                "apex": point([0.43, 0.37, 0.97]), "axis": placed([3.0, 4.0, 0.0], axis, sense, 0.0), "radius": 1.5}}),
            "cone" => json!({"cone": {"apex": point([0.43, 0.37, 0.97]), "slope": 0.6}}),
            _ => height_map(&[-1.0, 0.4, 2.0], &[-1.0, 0.55, 2.0], &|x, y| {
                placed([x, y, 0.98 + 0.4 * (x - 0.4).abs() + 0.2 * (y - 0.55) + 0.1 * x * y], axis, sense, 1.0)[axis]
            }),
        }
    };
    for name in ["sphere", "centred", "cylinder", "cone", "height-map"] {
        for rule in ["approach", "closest-point"] {
            let reference = top(rule, shape(name, 2, 1.0), -0.02);
            for (boundary, approach, axis, sense) in [
                ("left", "-x", 0, -1.0),
                ("right", "+x", 0, 1.0),
                ("front", "-y", 1, -1.0),
                ("back", "+y", 1, 1.0),
                ("bottom", "-z", 2, -1.0),
            ] {
                let mut scene = cube_under(rule, shape(name, axis, sense), -0.02);
                scene["supports"] = json!([{"on": {"point": [0.5, 0.5, 0.5]}, "x": 0, "y": 0, "z": 0},
                    {"on": {"point": [0.75, 0.5, 0.5]}, "y": 0, "z": 0}, {"on": {"point": [0.5, 0.75, 0.5]}, "z": 0}]);
                (scene["obstacles"][0]["boundary"], scene["obstacles"][0]["approach"]) =
                    (json!(boundary), json!(approach));
                let model = built(&scene);
                assert_eq!(model.rows().len(), 25, "{name} {approach}");
                for row in reference.rows() {
                    let at = placed(reference.mesh().nodes()[row.node], axis, sense, 1.0);
                    let found = model.rows().iter().find(|found| model.mesh().nodes()[found.node] == at).unwrap();
                    assert!((found.gap - row.gap).abs() < ROUNDING, "{name} {rule} {approach}: {found:?} {row:?}");
                    let normal = placed(row.normal, axis, sense, 0.0);
                    let off = (0..3).map(|i| (found.normal[i] - normal[i]).abs()).fold(0.0, f64::max);
                    assert!(off < ROUNDING, "{name} {rule} {approach}: {found:?}, expected {normal:?}");
                }
            }
        }
    }
}

/// The row of the node at (x, y, 1) under a height map on these grid lines.
fn row_under(x: &[f64], y: &[f64], height: &dyn Fn(f64, f64) -> f64, at: [f64; 2]) -> ([f64; 3], f64) {
    let model = top("closest-point", height_map(x, y, height), 0.0);
    let row = model.rows().iter().find(|row| model.mesh().nodes()[row.node] == [at[0], at[1], 1.0]).unwrap();
    (row.normal, row.gap)
}

#[test]
fn a_node_equally_close_to_several_points_of_a_height_map_has_their_mean_normal() {
    let straight = |(normal, gap): ([f64; 3], f64), expected: f64, what: &str| {
        let level = normal[0].abs().max(normal[1].abs());
        assert!(level < SEARCHED && (normal[2] - 1.0).abs() < SEARCHED, "{what}: {normal:?}");
        assert!((gap - expected).abs() < SEARCHED, "{what}: {gap}");
    };
    let (wide, mid) = ([-2.0, 0.5, 3.0], [0.5, 0.5]);
    let folded = |x: f64| (x - 0.5).abs();
    // A node inside a wedge, and inside a pyramid: the mean normal of two flanks, and of four, is vertical.
    straight(row_under(&wide, &wide, &|x, _| 0.9 + folded(x), mid), -0.1, "wedge");
    straight(row_under(&wide, &wide, &|x, y| 0.9 + folded(x) + folded(y), mid), -0.1, "pyramid");
    // A node in a notch, and in a funnel: the row is vertical up to the flanks.
    straight(row_under(&wide, &wide, &|x, _| 1.2 - folded(x), mid), 0.2, "notch");
    straight(row_under(&wide, &wide, &|x, y| 1.2 - 0.5 * (folded(x) + folded(y)), mid), 0.2, "funnel");
    // Grid lines pass through only one of the closest points, at x = 0.4: a point shared by two cells counts once.
    let uneven = [-2.0, 0.4, 0.5, 3.0];
    straight(row_under(&uneven, &wide, &|x, _| 1.2 - folded(x), mid), 0.2, "shared foot");
    // A saddle in one cell has two closest points, one on each side.
    let saddle = |x: f64, y: f64| 1.3 - 8.0 * (x - 0.5) * (y - 0.5);
    let ends = [-0.5, 1.5];
    let (normal, _) = row_under(&ends, &ends, &saddle, mid);
    assert!(normal[0].abs().max(normal[1].abs()) < SEARCHED, "saddle: {normal:?}");
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
fn shapes_of_wrong_dimension_and_invalid_height_maps_are_refused_at_their_path() {
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
        let text = cube_under("approach", shape, 0.0).to_string();
        let error = Scene::from_json(&text, "scene").unwrap().build().unwrap_err().to_string();
        assert!(error.contains(path) && error.contains(words), "{error}");
    }
}

#[test]
fn rows_of_a_body_of_revolution_have_the_distances_to_a_sphere_and_a_cone() {
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

//! GOAL: the contact rows of every obstacle shape, by both rules, compared with formulas that share no code with the
//! library.
//!
//! BODY: a clamped unit square of 8 x 8 Q4; candidates are the nodes of one side.

use serde_json::{Value, json};
use signorini::Model;
use support::bodies::clamped_square;
use support::scenes::built;

/// Rounding of distances of order one in the plane.
const ROUNDING: f64 = 1e-14;

/// A golden-section search finds the place of a minimum to the square root of rounding; the distance itself is then
/// exact to rounding.
const SEARCHED: f64 = 1e-12;

fn top(rule: &str, shape: Value, gap: f64) -> Model {
    built(&clamped_square(8, json!([{"boundary": "top", "approach": "+y", "rule": rule, "shape": shape}]), gap))
}

/// A shape and its height y - 1.1 as a function of x - 0.4.
type Height = (Value, Box<dyn Fn(f64) -> f64>);

#[test]
fn along_the_approach_direction_the_gap_is_the_height_above_the_node() {
    let (apex, gap) = ([0.4, 1.1], -0.03);
    let heights: [Height; 6] = [
        (json!({"plane": {"point": apex, "normal": [0.5, 2.0]}}), Box::new(|t| -0.25 * t)),
        (json!({"parabola": {"apex": apex, "radius": 0.7}}), Box::new(|t| t * t / 1.4)),
        (json!({"circle": {"apex": apex, "radius": 0.7}}), Box::new(|t| 0.7 - (0.49 - t * t).sqrt())),
        (json!({"circle": {"centre": [0.4, 1.8], "radius": 0.7}}), Box::new(|t| 0.7 - (0.49 - t * t).sqrt())),
        (json!({"wedge": {"apex": apex, "slope": 0.3}}), Box::new(|t| 0.3 * t.abs())),
        (
            json!({"table": {"points": [[-0.1, 1.3], [0.4, 1.1], [1.4, 1.5]]}}),
            Box::new(|t| if t < 0.0 { -0.4 * t } else { 0.4 * t }),
        ),
    ];
    for (shape, height) in heights {
        let model = top("approach", shape.clone(), gap);
        assert_eq!(model.rows().len(), 9, "{shape}");
        for (contact, gap_of_problem) in model.rows().iter().zip(model.problem().gap()) {
            let [x, y, _] = model.mesh().nodes()[contact.node];
            let expected = 1.1 + height(x - 0.4) + gap - y;
            assert_eq!(contact.normal, [0.0, 1.0, 0.0]);
            assert!((contact.gap - expected).abs() < ROUNDING, "{shape} {contact:?} {expected}");
            assert_eq!(*gap_of_problem, contact.gap);
        }
        assert!(
            model.problem().contact().values().iter().all(|&entry| entry == 1.0),
            "the rows are not boolean: {shape}"
        );
        assert_eq!(model.problem().contact().entries(), 9, "a row has more than one entry: {shape}");
    }
}

/// The smallest distance from `node` to the curve, by a coarse search and then a golden-section search around the best
/// point.
fn searched_distance(node: [f64; 2], curve: &dyn Fn(f64) -> f64, (low, high): (f64, f64)) -> f64 {
    let distance = |t: f64| (t - node[0]).hypot(curve(t) - node[1]);
    let steps = 20_000;
    let at = |i: usize| low + (high - low) * i as f64 / steps as f64;
    let best = (0..=steps).min_by(|&a, &b| distance(at(a)).total_cmp(&distance(at(b)))).unwrap();
    let (mut a, mut b) = (at(best.saturating_sub(1)), at((best + 1).min(steps)));
    let golden = (5_f64.sqrt() - 1.0) / 2.0;
    for _ in 0..80 {
        let (c, d) = (b - golden * (b - a), a + golden * (b - a));
        if distance(c) < distance(d) { b = d } else { a = c }
    }
    distance((a + b) / 2.0)
}

/// A shape, its curve y(x), and the range of x in which to search.
type Curve = (Value, Box<dyn Fn(f64) -> f64>, (f64, f64));

/// Shapes with their curves y(x), above the square and partly inside it.
fn curves() -> Vec<Curve> {
    let rise = |points: &'static [[f64; 2]]| {
        move |x: f64| {
            let right = points.iter().position(|p| p[0] >= x).unwrap_or(points.len() - 1).max(1);
            let (a, b) = (points[right - 1], points[right]);
            a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1])
        }
    };
    let mut curves: Vec<Curve> = Vec::new();
    for y in [1.2, 0.97] {
        let parabola = json!({"parabola": {"apex": [0.43, y], "radius": 0.5}});
        curves.push((parabola, Box::new(move |x: f64| y + (x - 0.43).powi(2)), (-2.0, 3.0)));
        let circle = json!({"circle": {"apex": [0.43, y], "radius": 0.8}});
        let arc = move |x: f64| y + 0.8 - (0.64 - (x - 0.43).powi(2)).max(0.0).sqrt();
        curves.push((circle, Box::new(arc), (-0.37, 1.23)));
        let wedge = json!({"wedge": {"apex": [0.43, y], "slope": 0.6}});
        curves.push((wedge, Box::new(move |x: f64| y + 0.6 * (x - 0.43).abs()), (-2.0, 3.0)));
    }
    const ZIGZAG: [[f64; 2]; 6] = [[-1.0, 1.3], [0.1, 0.9], [0.3, 1.2], [0.6, 1.15], [0.7, 0.95], [2.0, 1.6]];
    curves.push((json!({"table": {"points": ZIGZAG}}), Box::new(rise(&ZIGZAG)), (-1.0, 2.0)));
    // A roof that the top of the square penetrates: nodes inside are closest to its ridge.
    const ROOF: [[f64; 2]; 3] = [[-1.0, -1.9], [0.47, 0.9], [2.0, -2.0]];
    curves.push((json!({"table": {"points": ROOF}}), Box::new(rise(&ROOF)), (-1.0, 2.0)));
    curves
}

#[test]
fn closest_point_distances_are_the_smallest_distances_signed_negative_inside() {
    for (shape, curve, range) in curves() {
        let model = top("closest-point", shape.clone(), 0.0);
        assert_eq!(model.rows().len(), 9, "{shape}");
        for row in model.rows() {
            let [x, y, _] = model.mesh().nodes()[row.node];
            let node = [x, y];
            let inside = node[1] > curve(node[0]);
            let expected = searched_distance(node, &curve, range) * if inside { -1.0 } else { 1.0 };
            assert!((row.gap - expected).abs() < SEARCHED, "{shape} at {node:?}: {} and {expected}", row.gap);
        }
    }
}

#[test]
fn closest_point_normals_have_unit_length_and_point_from_the_node_to_the_surface() {
    for (shape, curve, _) in curves() {
        let model = top("closest-point", shape.clone(), 0.0);
        for row in model.rows() {
            let [nx, ny, _] = row.normal;
            let [x, y, _] = model.mesh().nodes()[row.node];
            let node = [x, y];
            assert!((nx.hypot(ny) - 1.0).abs() < ROUNDING && ny > 0.0, "{shape}: {row:?}");
            let foot = [node[0] + row.gap * nx, node[1] + row.gap * ny];
            assert!((curve(foot[0]) - foot[1]).abs() < SEARCHED, "{shape} at {node:?}: {foot:?}");
        }
    }
}

#[test]
fn moving_the_node_along_the_normal_reduces_the_distance_one_to_one() {
    // d(gap)/dx = -n, by central differences; the square is shifted instead of the node.
    let step = 1e-6;
    for (shape, _, _) in curves() {
        let gaps = |dx: f64, dy: f64| -> Vec<f64> {
            let mut scene = clamped_square(
                8,
                json!([{"boundary": "top", "approach": "+y", "rule": "closest-point", "shape": shape}]),
                0.0,
            );
            scene["body"]["rectangle"]["x"]["points"] = json!([dx, 1.0 + dx]);
            scene["body"]["rectangle"]["y"]["points"] = json!([dy, 1.0 + dy]);
            built(&scene).rows().iter().map(|row| row.gap).collect()
        };
        let model = top("closest-point", shape.clone(), 0.0);
        let slope = |plus: Vec<f64>, minus: Vec<f64>| -> Vec<f64> {
            plus.iter().zip(minus).map(|(a, b)| (a - b) / (2.0 * step)).collect()
        };
        let along_x = slope(gaps(step, 0.0), gaps(-step, 0.0));
        let along_y = slope(gaps(0.0, step), gaps(0.0, -step));
        for (i, row) in model.rows().iter().enumerate() {
            // Second differences of the distance are below 10; the squared step, and rounding divided by the step, are
            // below 1e-9.
            assert!((along_x[i] + row.normal[0]).abs() < 1e-8, "{shape} {row:?} {}", along_x[i]);
            assert!((along_y[i] + row.normal[1]).abs() < 1e-8, "{shape} {row:?} {}", along_y[i]);
        }
    }
}

#[test]
fn the_row_of_a_node_behind_a_vertex_or_on_an_axis_has_the_approach_direction() {
    for (shape, depth) in [
        (json!({"wedge": {"apex": [0.5, 0.9], "slope": 2.0}}), 0.1),
        (json!({"table": {"points": [[0, 1.4], [0.5, 0.9], [1, 1.4]]}}), 0.1),
        (json!({"parabola": {"apex": [0.5, 0.9], "radius": 0.01}}), 0.1),
        (json!({"circle": {"apex": [0.5, 0.9], "radius": 0.2}}), 0.1),
        (json!({"circle": {"apex": [0.5, 0.9], "radius": 0.08}}), 0.1),
    ] {
        let model = top("closest-point", shape.clone(), 0.0);
        let row = model.rows().iter().find(|row| model.mesh().nodes()[row.node] == [0.5, 1.0, 0.0]).unwrap();
        assert_eq!(row.normal, [0.0, 1.0, 0.0], "{shape}");
        assert!((row.gap + depth).abs() < ROUNDING, "{shape}: {row:?}");
    }
    // In a notch, the row has the approach direction, and the gap ends at both flanks.
    let notch = top("closest-point", json!({"table": {"points": [[0, 1.1], [0.5, 1.2], [1, 1.1]]}}), 0.0);
    let row = notch.rows().iter().find(|row| notch.mesh().nodes()[row.node] == [0.5, 1.0, 0.0]).unwrap();
    assert_eq!(row.normal, [0.0, 1.0, 0.0]);
    assert!((row.gap - 0.2).abs() < ROUNDING, "{row:?}");
}

#[test]
fn the_normal_of_a_node_on_a_vertex_bisects_its_flanks() {
    let model = top("closest-point", json!({"table": {"points": [[0, 1], [0.5, 1], [1, 1.5]]}}), 0.0);
    let row = model.rows().iter().find(|row| model.mesh().nodes()[row.node] == [0.5, 1.0, 0.0]).unwrap();
    // The flanks have the angles 0 and 45 degrees: the normal is inclined by half of this.
    let half = std::f64::consts::PI / 8.0;
    assert!((row.normal[0] + half.sin()).abs() < ROUNDING && (row.normal[1] - half.cos()).abs() < ROUNDING);
    assert_eq!(row.gap, 0.0);
}

#[test]
fn both_rules_agree_on_a_plane_across_the_approach_direction() {
    let shape = json!({"plane": {"point": [7, 1.02], "normal": [0, 3]}});
    assert_eq!(top("approach", shape.clone(), -0.05).rows(), top("closest-point", shape, -0.05).rows());
}

#[test]
fn an_inclined_plane_gives_rows_of_two_entries() {
    let model = top("closest-point", json!({"plane": {"point": [0.5, 1], "normal": [3, 4]}}), -0.5);
    for (i, row) in model.rows().iter().enumerate() {
        let [x, ..] = model.mesh().nodes()[row.node];
        assert!((row.normal[0] - 0.6).abs() < ROUNDING && (row.normal[1] - 0.8).abs() < ROUNDING);
        // The shift of -0.5 is along +y; its component along the normal is 0.8 times that.
        assert!((row.gap - (0.6 * (0.5 - x) - 0.4)).abs() < ROUNDING, "{row:?}");
        assert_eq!(model.problem().contact().transposed().column(i).count(), 2);
    }
}

#[test]
fn the_rows_of_every_approach_direction_are_the_same_after_a_rotation() {
    // Gaps and normals of a parabola above the top, expressed in the frame of each side.
    let reference = top("closest-point", json!({"parabola": {"apex": [0.3, 1.05], "radius": 0.6}}), -0.02);
    // A direction [x, y] in the frame of each side: along the side, and outwards.
    type Turn = fn([f64; 2]) -> [f64; 2];
    let sides: [(&str, &str, [f64; 2], Turn); 3] = [
        ("bottom", "-y", [0.3, -0.05], |[x, y]| [x, -y]),
        ("right", "+x", [1.05, 0.3], |[x, y]| [y, x]),
        ("left", "-x", [-0.05, 0.3], |[x, y]| [y, -x]),
    ];
    for (boundary, approach, apex, turn) in sides {
        let obstacle = json!([{"boundary": boundary, "approach": approach, "rule": "closest-point",
            "shape": {"parabola": {"apex": apex, "radius": 0.6}}}]);
        let mut scene = clamped_square(8, obstacle, -0.02);
        scene["supports"] = json!([{"on": {"point": [0.5, 0.5]}, "x": 0, "y": 0}]);
        let model = built(&scene);
        assert_eq!(model.rows().len(), reference.rows().len());
        for (row, expected) in model.rows().iter().zip(reference.rows()) {
            let turned = turn([row.normal[0], row.normal[1]]);
            assert!((row.gap - expected.gap).abs() < ROUNDING, "{boundary}: {row:?} {expected:?}");
            assert!((turned[0] - expected.normal[0]).abs() < ROUNDING, "{boundary}: {row:?} {expected:?}");
            assert!((turned[1] - expected.normal[1]).abs() < ROUNDING, "{boundary}: {row:?} {expected:?}");
        }
    }
}

#[test]
fn nodes_beyond_the_reach_of_a_circle_have_no_row() {
    let shape = json!({"circle": {"apex": [0.5, 1.1], "radius": 0.2}});
    let near =
        |model: &Model| -> Vec<f64> { model.rows().iter().map(|row| model.mesh().nodes()[row.node][0]).collect() };
    // The columns of nodes are at multiples of 1/8: 0.375, 0.5 and 0.625 are within 0.2 of the apex.
    assert_eq!(near(&top("approach", shape.clone(), 0.0)), [0.375, 0.5, 0.625]);
    // By the closest-point rule every node below the centre has a row; nodes above the centre and outside the circle
    // have none.
    assert_eq!(near(&top("closest-point", shape.clone(), 0.0)).len(), 9);
    assert_eq!(near(&top("closest-point", json!({"circle": {"apex": [3, 0.9], "radius": 0.05}}), 0.0)).len(), 0);
}

#[test]
fn a_circle_of_huge_radius_has_the_gaps_of_a_plane_to_all_digits() {
    for rule in ["approach", "closest-point"] {
        for row in top(rule, json!({"circle": {"apex": [0.5, 1.0], "radius": 1e9}}), -1e-3).rows() {
            // The curvature changes the gap by at most 1.25e-10.
            assert!((row.gap + 1e-3).abs() < 2e-10, "{rule} {row:?}");
        }
    }
}

#[test]
fn outlines_follow_the_surface_over_the_body_and_contain_its_corners() {
    let wedge = top("approach", json!({"wedge": {"apex": [0.43, 1.1], "slope": 0.5}}), -0.02);
    let outline = wedge.obstacle_outline(0, 10);
    // Beyond the body by its size on each side: before a slender body a wall does not end in the picture.
    let (first, last, size) = (outline[0][0], outline[outline.len() - 1][0], wedge.mesh().size());
    assert!((first + size).abs() < ROUNDING && (last - 1.0 - size).abs() < ROUNDING, "{first} {last}");
    assert!(outline.iter().any(|p| (p[0] - 0.43).abs() < ROUNDING && (p[1] - 1.08).abs() < ROUNDING));
    assert!(outline.iter().all(|p| (p[1] - 1.08 - 0.5 * (p[0] - 0.43).abs()).abs() < ROUNDING));
    let circle = top("approach", json!({"circle": {"apex": [0.5, 1.1], "radius": 0.2}}), 0.0);
    let outline = circle.obstacle_outline(0, 8);
    assert_eq!(outline.len(), 9);
    assert!(outline.iter().all(|p| ((p[0] - 0.5).hypot(p[1] - 1.3) - 0.2).abs() < ROUNDING));
    assert!(circle.obstacle_outline(7, 8).is_empty());
}

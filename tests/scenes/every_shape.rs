//! GOAL: the rows of every obstacle shape of the schema, by both rules, compared with dense samples of its surface.
//!
//! BODY: a unit square of 16 x 16 Q4, or a unit cube of 8 x 8 x 8 Hex8; candidates are the nodes of its top. Each shape
//! comes from above and lies partly inside the body. Its surface is written here as a height over the plane, by its
//! definition, without the library.

use std::path::Path;

use serde_json::{Value, json};
use signorini::{Model, Scene};
use support::scenes::built;

/// Rounding of a few operations on lengths of order one.
const ROUNDING: f64 = 1e-12;

/// A point of a surface that is found to rounding has its height to the slope of the surface times this.
const ON_SURFACE: f64 = 1e-9;

/// Samples of the surface along each axis: of a curve, and of a surface in space.
const SAMPLES: [usize; 2] = [100_000, 300];

/// The height of a surface over the plane; `None` where it does not reach.
type Height = Box<dyn Fn([f64; 2]) -> Option<f64>>;

/// A shape with its height, and the number of coordinates of its model.
struct Shape {
    value: Value,
    dimension: usize,
    height: Height,
}

fn in_plane(value: Value, height: impl Fn(f64) -> Option<f64> + 'static) -> Shape {
    Shape { value, dimension: 2, height: Box::new(move |[x, _]| height(x)) }
}

fn in_space(value: Value, height: impl Fn([f64; 2]) -> Option<f64> + 'static) -> Shape {
    Shape { value, dimension: 3, height: Box::new(height) }
}

/// The lower half of a circle of radius r about the height `centre`, at the distance t from its middle; the upper half
/// from inside.
fn arc(t: f64, r: f64, centre: f64, side: f64) -> Option<f64> {
    let square = r * r - t * t;
    (square >= 0.0).then(|| centre - side * square.sqrt())
}

/// Shapes of one name of the schema. A name that is not known here fails.
fn shapes(name: &str, folder: &Path) -> Vec<Shape> {
    match name {
        "plane" => vec![
            in_plane(json!({"plane": {"point": [0.4, 0.98], "normal": [0.5, 2.0]}}), |x| Some(0.98 - 0.25 * (x - 0.4))),
            in_space(json!({"plane": {"point": [0.4, 0.5, 0.98], "normal": [0.5, -0.25, 2.0]}}), |[x, y]| {
                Some(0.98 - 0.25 * (x - 0.4) + 0.125 * (y - 0.5))
            }),
        ],
        "parabola" => vec![in_plane(json!({"parabola": {"apex": [0.4, 0.97], "radius": 0.7}}), |x| {
            Some(0.97 + (x - 0.4).powi(2) / 1.4)
        })],
        "circle" => vec![
            in_plane(json!({"circle": {"apex": [0.4, 0.97], "radius": 0.7}}), |x| arc(x - 0.4, 0.7, 1.67, 1.0)),
            in_plane(json!({"circle": {"centre": [0.5, 0.1], "radius": 1.0, "side": "inside"}}), |x| {
                arc(x - 0.5, 1.0, 0.1, -1.0)
            }),
        ],
        "wedge" => vec![in_plane(json!({"wedge": {"apex": [0.43, 0.97], "slope": 0.3}}), |x| {
            Some(0.97 + 0.3 * (x - 0.43).abs())
        })],
        "table" => {
            vec![in_plane(json!({"table": {"points": [[-2, 2.2], [0.43, 0.97], [0.71, 1.05], [3, 1.2]]}}), |x| {
                let knots = [[-2.0, 2.2], [0.43, 0.97], [0.71, 1.05], [3.0, 1.2]];
                let pair = knots.windows(2).find(|pair| pair[0][0] <= x && x <= pair[1][0])?;
                Some(pair[0][1] + (x - pair[0][0]) / (pair[1][0] - pair[0][0]) * (pair[1][1] - pair[0][1]))
            })]
        }
        "sphere" => vec![
            in_space(json!({"sphere": {"apex": [0.4, 0.5, 0.97], "radius": 0.8}}), |[x, y]| {
                arc((x - 0.4).hypot(y - 0.5), 0.8, 1.77, 1.0)
            }),
            in_space(json!({"sphere": {"centre": [0.5, 0.5, 0.1], "radius": 1.0, "side": "inside"}}), |[x, y]| {
                arc((x - 0.5).hypot(y - 0.5), 1.0, 0.1, -1.0)
            }),
        ],
        "cylinder" => vec![
            in_space(json!({"cylinder": {"apex": [0.4, 0.5, 0.97], "axis": [3, 4, 0], "radius": 0.9}}), |[x, y]| {
                arc(0.8 * (x - 0.4) - 0.6 * (y - 0.5), 0.9, 1.87, 1.0)
            }),
            in_space(
                json!({"cylinder": {"centre": [0.5, 0.5, 0.1], "axis": [0, 2, 0], "radius": 1.0, "side": "inside"}}),
                |[x, _]| arc(x - 0.5, 1.0, 0.1, -1.0),
            ),
        ],
        "cone" => vec![in_space(json!({"cone": {"apex": [0.43, 0.51, 0.97], "slope": 0.3}}), |[x, y]| {
            Some(0.97 + 0.3 * (x - 0.43).hypot(y - 0.51))
        })],
        "height-map" => vec![height_map()],
        "torus" => vec![
            // No node lies on its axis, where the closest point is not unique. The ring lies flat: at the distance t
            // from its axis the tube has the height of a circle about t = major.
            in_space(
                json!({"torus": {"centre": [0.47, 0.53, 1.17], "axis": [0, 0, 1], "major": 0.5, "minor": 0.2}}),
                |[x, y]| arc((x - 0.47).hypot(y - 0.53) - 0.5, 0.2, 1.17, 1.0),
            ),
            // The ring stands upright: below its centre the outer half of the tube.
            in_space(
                json!({"torus": {"centre": [0.5, 0.5, 1.87], "axis": [0, 3, 0], "major": 0.6, "minor": 0.3}}),
                |[x, y]| {
                    let square = 0.09 - (y - 0.5).powi(2);
                    if square < 0.0 {
                        return None;
                    }
                    arc(x - 0.5, 0.6 + square.sqrt(), 1.87, 1.0)
                },
            ),
        ],
        "surface" => vec![pyramid(folder)],
        "body" => vec![facing(2), facing(3)],
        other => panic!("the obstacle shape `{other}` has no test here: give its height over the plane"),
    }
}

/// Bilinear heights between three lines along each axis.
fn height_map() -> Shape {
    let (lines, heights) = ([-2.0, 0.45, 3.0], [[1.9, 1.5, 1.7], [1.4, 0.97, 1.5], [1.8, 1.3, 2.0]]);
    in_space(json!({"height-map": {"x": lines, "y": lines, "heights": heights}}), move |[x, y]| {
        let cell = |at: f64| if at < lines[1] { 0 } else { 1 };
        let (i, j) = (cell(x), cell(y));
        let [s, t] = [(x, i), (y, j)].map(|(at, cell)| (at - lines[cell]) / (lines[cell + 1] - lines[cell]));
        let along = |i: usize| (1.0 - t) * heights[i][j] + t * heights[i][j + 1];
        Some((1.0 - s) * along(i) + s * along(i + 1))
    })
}

/// A pyramid that points down, from a file in half its size: z = 0.97 + 0.4 max(|x - 0.43|, |y - 0.51|) below its base
/// at z = 2.17. Its apex is not the origin of the file, so that another scale moves it.
fn pyramid(folder: &Path) -> Shape {
    let text = "v 0.05 0.1 0.15\nv -1.45 -1.4 0.75\nv 1.55 -1.4 0.75\nv 1.55 1.6 0.75\nv -1.45 1.6 0.75\n\
                f 1 3 2\nf 1 4 3\nf 1 5 4\nf 1 2 5\nf 2 3 4 5\n";
    std::fs::write(folder.join("pyramid.obj"), text).unwrap();
    in_space(json!({"surface": {"file": "pyramid.obj", "scale": 2, "origin": [0.33, 0.31, 0.67]}}), |[x, y]| {
        let away = (x - 0.43).abs().max((y - 0.51).abs());
        (away <= 3.0).then_some(0.97 + 0.4 * away)
    })
}

/// The lower side of another body with the same nodes, at 1.05.
fn facing(dimension: usize) -> Shape {
    Shape { value: json!({"body": {"boundary": "lid.bottom"}}), dimension, height: Box::new(|_| Some(1.05)) }
}

/// The unit square or cube, its bottom held; another body above it, its top held.
fn model(shape: &Shape, rule: &str, folder: &Path) -> Model {
    let up = ["y", "z"][shape.dimension - 2];
    let body = |low: f64, high: f64| {
        let axis = |low: f64, high: f64| json!({"points": [low, high], "divisions": [if shape.dimension == 3 { 8 } else { 16 }]});
        match shape.dimension {
            2 => json!({"rectangle": {"x": axis(0.0, 1.0), "y": axis(low, high)}}),
            _ => json!({"box": {"x": axis(0.0, 1.0), "y": axis(0.0, 1.0), "z": axis(low, high)}}),
        }
    };
    let hold = |boundary: &str| match shape.dimension {
        2 => json!({"on": {"boundary": boundary}, "x": 0, "y": 0}),
        _ => json!({"on": {"boundary": boundary}, "x": 0, "y": 0, "z": 0}),
    };
    let mut scene = json!({
        "model": if shape.dimension == 2 { "plane-strain" } else { "space" },
        "body": body(0.0, 1.0),
        "material": {"young": 1, "poisson": 0.3},
        "supports": [hold("bottom")],
        "obstacles": [{"boundary": "top", "approach": format!("+{up}"), "rule": rule, "shape": shape.value}]
    });
    if shape.value.get("body").is_some() {
        scene["further-bodies"] =
            json!([{"name": "lid", "body": body(1.05, 1.5), "material": {"young": 1, "poisson": 0.3}}]);
        scene["supports"].as_array_mut().unwrap().push(hold("lid.top"));
    }
    if shape.value.get("surface").is_none() {
        return built(&scene);
    }
    let scene = Scene::from_json(&scene.to_string(), "scene").unwrap();
    Scene { folder: Some(folder.into()), ..scene }.build().unwrap()
}

/// Points of the surface over an area around the body.
fn samples(shape: &Shape) -> Vec<[f64; 3]> {
    let count = SAMPLES[shape.dimension - 2];
    let at = |index: usize| -1.0 + 3.0 * index as f64 / count as f64;
    let over = |x: f64, y: f64| {
        let height = (shape.height)([x, y])?;
        Some(if shape.dimension == 2 { [x, height, 0.0] } else { [x, y, height] })
    };
    match shape.dimension {
        2 => (0..=count).filter_map(|i| over(at(i), 0.0)).collect(),
        _ => {
            (0..=count).flat_map(|i| (0..=count).map(move |j| (i, j))).filter_map(|(i, j)| over(at(i), at(j))).collect()
        }
    }
}

/// Every shape of the schema, tested by `check` in the model that a rule makes of it.
fn every_shape(rule: &str, check: impl Fn(&Shape, &Model)) {
    let folder = tempfile::tempdir().unwrap();
    let schema: Value = serde_json::from_str(&Scene::json_schema()).unwrap();
    let choices = schema.pointer("/$defs/ShapeSpec/oneOf").and_then(Value::as_array).unwrap();
    let names: Vec<String> = choices.iter().map(|choice| choice["required"][0].as_str().unwrap().to_string()).collect();
    assert!(names.len() >= 12, "{names:?}");
    for shape in names.iter().flat_map(|name| shapes(name, folder.path())) {
        let model = model(&shape, rule, folder.path());
        let candidates = model.obstacles()[0].candidates().len();
        assert!(2 * model.rows().len() > candidates, "{} of {candidates} rows: {}", model.rows().len(), shape.value);
        check(&shape, &model);
    }
}

/// The coordinates across the approach direction, and the one along it.
fn parted(at: [f64; 3], dimension: usize) -> ([f64; 2], f64) {
    if dimension == 2 { ([at[0], 0.0], at[1]) } else { ([at[0], at[1]], at[2]) }
}

#[test]
fn along_the_approach_direction_every_shape_has_its_height_above_the_node() {
    every_shape("approach", |shape, model| {
        for row in model.rows() {
            let (across, along) = parted(model.mesh().nodes()[row.node], shape.dimension);
            let height = (shape.height)(across).unwrap();
            assert!((row.gap - (height - along)).abs() < ROUNDING, "{}: {row:?}, height {height}", shape.value);
            let mut up = [0.0; 3];
            up[shape.dimension - 1] = 1.0;
            assert_eq!(row.normal, up, "{}", shape.value);
        }
    });
}

/// The foot of a row lies on the surface, and no sample of the surface is nearer: the gap is the distance.
#[test]
fn the_closest_point_of_every_shape_is_on_its_surface_and_nearer_than_every_sample() {
    every_shape("closest-point", |shape, model| {
        let samples = samples(shape);
        for row in model.rows() {
            let node = model.mesh().nodes()[row.node];
            let length = row.normal.iter().map(|part| part * part).sum::<f64>().sqrt();
            assert!((length - 1.0).abs() < ROUNDING, "{}: {row:?}", shape.value);
            let foot = [0, 1, 2].map(|axis| node[axis] + row.gap * row.normal[axis]);
            let (across, along) = parted(foot, shape.dimension);
            if let Some(height) = (shape.height)(across) {
                assert!(
                    (height - along).abs() < ON_SURFACE,
                    "{}: the foot {foot:?} of {row:?} is not on it",
                    shape.value
                );
            }
            let away = |other: &[f64; 3]| (0..3).map(|axis| (other[axis] - node[axis]).powi(2)).sum::<f64>().sqrt();
            let nearest = samples.iter().map(away).fold(f64::INFINITY, f64::min);
            assert!(row.gap.abs() < nearest + ROUNDING, "{}: {row:?}, but a sample is at {nearest}", shape.value);
            let (across, along) = parted(node, shape.dimension);
            if let Some(height) = (shape.height)(across) {
                assert!(row.gap * (height - along) >= 0.0, "{}: {row:?} has the wrong sign", shape.value);
            }
        }
    });
}

//! GOAL: an obstacle that a user implements works beside those of a scene: same rows, same answer, and an error for
//! invalid rows.
//!
//! BODY: a clamped unit square of 8 x 8 Q4; candidates are the nodes of its top.

use std::sync::Arc;

use serde_json::{Value, json};
use signorini::scene::{Obstacle, ObstacleRow, Warning};
use signorini::{Error, Model, Scene, solve_qp};
use support::bodies::clamped_square;

/// Rounding: the built-in shapes subtract the shift from the height, while for this obstacle the node is moved.
const ROUNDING: f64 = 4e-16;

/// A user's obstacle above the square, defined by its row for a point.
struct Above(fn([f64; 3]) -> Result<Option<ObstacleRow>, String>);

impl std::fmt::Debug for Above {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        formatter.write_str("Above")
    }
}

impl Obstacle for Above {
    fn approach(&self) -> [f64; 3] {
        [0.0, 1.0, 0.0]
    }

    fn row(&self, point: [f64; 3]) -> Result<Option<ObstacleRow>, String> {
        (self.0)(point)
    }
}

fn scene(obstacles: Value) -> Scene {
    Scene::from_json(&clamped_square(8, obstacles, -0.03).to_string(), "scene").unwrap()
}

fn with(row: fn([f64; 3]) -> Result<Option<ObstacleRow>, String>) -> Result<Model, Error> {
    scene(json!([])).build_with(&[("top", Arc::new(Above(row)))])
}

fn assert_same_rows(own: &Model, built_in: &Model) {
    assert_eq!(own.rows().len(), built_in.rows().len());
    for (own, built_in) in own.rows().iter().zip(built_in.rows()) {
        assert_eq!((own.node, own.tributary_area), (built_in.node, built_in.tributary_area));
        for axis in 0..3 {
            assert!((own.normal[axis] - built_in.normal[axis]).abs() < ROUNDING, "{own:?} {built_in:?}");
        }
        assert!((own.gap - built_in.gap).abs() < ROUNDING, "{own:?} {built_in:?}");
    }
}

fn of_shape(rule: &str, shape: Value) -> Model {
    scene(json!([{"boundary": "top", "approach": "+y", "rule": rule, "shape": shape}])).build().unwrap()
}

#[test]
fn a_users_parabola_has_the_rows_and_the_answer_of_the_built_in_one() {
    let own = with(|[x, y, _]| {
        let height = 1.0 + (x - 0.4) * (x - 0.4) / 1.4;
        Ok(Some(ObstacleRow { normal: [0.0, 1.0, 0.0], gap: height - y }))
    })
    .unwrap();
    let built_in = of_shape("approach", json!({"parabola": {"apex": [0.4, 1.0], "radius": 0.7}}));
    assert_same_rows(&own, &built_in);
    let (own, built_in) = (solve_qp(own.problem()).unwrap(), solve_qp(built_in.problem()).unwrap());
    assert!(own.contact_set.count() > 0);
    assert_eq!(own.contact_set, built_in.contact_set);
    let largest = built_in.multiplier.iter().fold(0.0_f64, |largest, lambda| largest.max(lambda.abs()));
    for (own, built_in) in own.multiplier.iter().zip(&built_in.multiplier) {
        assert!((own - built_in).abs() < 1e-10 * largest, "{own} {built_in}");
    }
}

#[test]
fn a_users_plane_has_the_rows_of_the_built_in_one_along_its_normal() {
    // The plane with n = (0.6, 0.8) through (0, 1).
    let own =
        with(|[x, y, _]| Ok(Some(ObstacleRow { normal: [0.6, 0.8, 0.0], gap: 0.6 * (0.0 - x) + 0.8 * (1.0 - y) })));
    let built_in = of_shape("closest-point", json!({"plane": {"point": [0, 1], "normal": [0.6, 0.8]}}));
    assert_same_rows(&own.unwrap(), &built_in);
}

#[test]
fn a_users_obstacle_is_numbered_after_those_of_the_scene() {
    let scene = scene(json!([
        {"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [1.5, 0], "normal": [1, 0]}}}
    ]));
    let flat = Above(|[_, y, _]| Ok(Some(ObstacleRow { normal: [0.0, 1.0, 0.0], gap: 1.25 - y })));
    let model = scene.build_with(&[("top", Arc::new(flat))]).unwrap();
    assert_eq!(model.obstacles().len(), 2);
    let rows = model.rows().iter().filter(|row| row.obstacle == 1);
    // The gap of the scene, -0.03, moves the obstacle towards the body.
    assert!(rows.clone().count() == 9 && rows.clone().all(|row| (row.gap - 0.22).abs() < ROUNDING));
    let nearer = model.with_gap(-0.25).unwrap();
    assert!(nearer.rows().iter().filter(|row| row.obstacle == 1).all(|row| row.gap == 0.0));
}

#[test]
fn nodes_out_of_reach_of_a_users_obstacle_have_no_row() {
    let right = with(|[x, y, _]| Ok((x >= 0.5).then_some(ObstacleRow { normal: [0.0, 1.0, 0.0], gap: 1.25 - y })));
    assert_eq!(right.unwrap().rows().len(), 5);
    let nowhere = with(|_| Ok(None)).unwrap();
    assert!(matches!(nowhere.warnings(), [Warning { code: "no-contact-row", .. }]), "{:?}", nowhere.warnings());
}

#[test]
fn an_invalid_row_of_a_users_obstacle_is_refused_with_its_node() {
    fn row(normal: [f64; 3], gap: f64) -> Result<Option<ObstacleRow>, String> {
        Ok(Some(ObstacleRow { normal, gap }))
    }
    for (built, words) in [
        (with(|_| row([0.0, 2.0, 0.0], 1.0)), "has a row whose normal has the length 2; it must be 1"),
        (with(|_| row([0.0, f64::NAN, 0.0], 1.0)), "has a row whose normal has the length NaN"),
        (with(|_| row([0.0, 0.0, 1.0], 1.0)), "has a row whose normal leads out of the model"),
        (with(|_| row([0.0, 1.0, 0.0], f64::NAN)), "has a distance that is not a number"),
        (with(|_| Err("is not mine".into())), "is not mine; move the obstacle away from it"),
    ] {
        let error = built.unwrap_err().to_string();
        assert!(error.contains("`obstacles[0]`: node ") && error.contains(words), "{error}");
    }
    let missing = scene(json!([])).build_with(&[("roof", Arc::new(Above(|_| Ok(None))))]).unwrap_err().to_string();
    assert!(missing.contains("there is no boundary `roof`"), "{missing}");
}

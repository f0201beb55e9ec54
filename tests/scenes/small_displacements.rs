//! Answers that small displacements do not describe: strains, rotations, and obstacles behind a body.

use serde_json::{Value, json};
use signorini::qp::solve_qp;
use signorini::scene::Answer;
use signorini::{Error, Scene};
use std::sync::Arc;
use support::scenes::build;

/// The answer, or why small displacements do not describe it.
fn judged(scene: &Value) -> Result<Answer, String> {
    let model = Arc::new(build(scene).unwrap());
    let solution = solve_qp(model.problem()).unwrap();
    Answer::of(model.clone(), &solution).map_err(|error| {
        assert_eq!((error.code(), error.status()), ("beyond-small-displacements", "beyond-small-displacements"));
        let message = error.to_string();
        let carried = error.into_best().unwrap();
        assert_eq!(Answer::of_any_size(model, &carried).unwrap().beyond_small_displacements(), Some(message.clone()));
        message
    })
}

/// GOAL: the rotation of a slender cantilever.
/// CONDITIONS: height 0.1, length 10, a moment at the end that turns it by 0.4 and by 0.6 rad.
/// REFERENCE: M L/(E I); the strain is 0.2 and 0.3 %.
#[test]
fn a_slender_body_may_not_turn_by_more_than_half_a_radian() {
    let bent = |rotation: f64| {
        let moment = rotation * 1e6 * 0.1_f64.powi(3) / 12.0 / 10.0;
        judged(&json!({
            "model": "plane-stress",
            "body": {"rectangle": {"x": {"points": [0, 10], "divisions": [100]}, "y": {"points": [0, 0.1], "divisions": [1]}, "element": "q8"}},
            "material": {"young": 1e6, "poisson": 0},
            "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}],
            "loads": [{"moment": {"boundary": "right", "value": [moment]}}]
        }))
    };
    assert!(bent(0.49).is_ok());
    let message = bent(0.51).unwrap_err();
    assert!(message.contains("rotations reach 0.51 rad") && message.contains("slender body bends"), "{message}");
}

/// GOAL: an obstacle on the far side of a plate, which pushes the whole plate away.
/// CONDITIONS: plates of 1 x 0.2 and of 1 x 0.5 x 0.2 on soft springs, with a plane at several depths in one side.
/// REFERENCE: deeper than the plate is thick, the plane lies beyond the plate; nothing is strained.
#[test]
fn no_row_starts_deeper_than_its_body_is_thick() {
    let axis = |length: f64| json!({"points": [0, length], "divisions": [3]});
    let plate = json!({"rectangle": {"x": axis(1.0), "y": axis(0.2)}});
    let slab = json!({"box": {"x": axis(1.0), "y": axis(0.5), "z": axis(0.2)}});
    for (body, side, axis, lengths) in [
        (&plate, ("top", "+y"), 1, vec![1.0, 0.2]),
        (&plate, ("right", "+x"), 0, vec![1.0, 0.2]),
        (&slab, ("top", "+z"), 2, vec![1.0, 0.5, 0.2]),
        (&slab, ("back", "+y"), 1, vec![1.0, 0.5, 0.2]),
    ] {
        let (unit, thickness) = (|at: usize| f64::from(u8::from(at == axis)), lengths[axis]);
        let normal: Vec<f64> = (0..lengths.len()).map(unit).collect();
        let pressed = |depth: f64| {
            let point: Vec<f64> = normal.iter().map(|part| part * (thickness - depth)).collect();
            let springs = [("x", 1), ("y", 1), ("z", 1)].into_iter().take(lengths.len());
            let mut spring: Value = springs.map(|(key, value)| (key.to_string(), json!(value))).collect();
            spring["on"] = json!({"boundary": "bottom"});
            judged(&json!({
                "model": if lengths.len() == 3 { "space" } else { "plane-strain" },
                "body": body,
                "material": {"young": 1e6, "poisson": 0.3},
                "springs": [spring],
                "obstacles": [{"boundary": side.0, "approach": side.1, "shape": {"plane": {"point": point, "normal": normal}}}]
            }))
        };
        assert!(pressed(0.95 * thickness).is_ok());
        let message = pressed(1.05 * thickness).unwrap_err();
        let words = [
            format!("lies {:.3e} m inside obstacles[0]", 1.05 * thickness),
            format!("its body is {thickness:.3e} m thick there"),
            "Name the boundary that faces".into(),
        ];
        assert!(words.iter().all(|words| message.contains(words)), "{message}");
    }
}

/// Small displacements are given to those who want them.
#[test]
fn a_linear_scene_has_every_answer() {
    let text = json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 1], "divisions": [2]}}},
        "material": {"young": 1, "poisson": 0},
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"force": {"boundary": "right", "value": [7]}}]
    });
    let scene = Scene::from_json(&text.to_string(), "bar").unwrap();
    for is_linear in [false, true] {
        let model = Arc::new(Scene { is_linear, ..scene.clone() }.build().unwrap());
        let answer = Answer::of(model.clone(), &solve_qp(model.problem()).unwrap());
        match answer {
            Ok(answer) => assert!(is_linear && (answer.displacement()[2] - 7.0).abs() < 1e-12),
            Err(error) => assert!(!is_linear && matches!(error, Error::BeyondSmallDisplacements { .. })),
        }
    }
}

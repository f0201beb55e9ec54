//! Springs and foundations, compared with closed forms.

use serde_json::{Value, json};
use signorini::scene::Answer;
use support::scenes::{answer, build};

fn resultant(answer: &Answer, of: &str) -> Vec<f64> {
    let all = answer.resultants().unwrap();
    all.iter().find(|resultant| resultant.of == of).unwrap_or_else(|| panic!("there is no {of}: {all:?}")).force.clone()
}

/// GOAL: a bar on a spring.
/// CONDITIONS: a bar of stiffness EA/L = 50 between a spring of 200 and a pull of 3; the spring is at the end node, or
/// on the end boundary.
/// REFERENCE: springs in series: 3/200, and 3/200 + 3/50.
#[test]
fn a_bar_on_a_spring_has_the_displacement_of_both_in_series() {
    let bar = |on: Value| {
        json!({
            "model": "bar",
            "body": {"bar": {"x": {"points": [0, 2], "divisions": [4]}, "area": 0.1}},
            "material": {"young": 1000, "poisson": 0},
            "springs": [{"on": on, "x": 200}],
            "loads": [{"force": {"at": [2], "value": [3]}}],
        })
    };
    for on in [json!({"point": [0]}), json!({"boundary": "left"})] {
        let answer = answer(&bar(on));
        let [left, right] = [0, 4].map(|node| answer.displacement()[node]);
        assert!(
            (left - 3.0 / 200.0).abs() < 1e-14 && (right - 3.0 / 200.0 - 3.0 / 50.0).abs() < 1e-14,
            "{left} {right}"
        );
        assert!((resultant(&answer, "springs[0]")[0] + 3.0).abs() < 1e-12);
        assert!(answer.forces().unwrap().balance < 1e-12);
    }
}

/// GOAL: a long beam on an elastic foundation under a force in the middle.
/// CONDITIONS: E = 1000, height 1, foundation k = 0.05 per area: beta = (k/(4 E I))^(1/4), beta L = 7 on each side.
/// REFERENCE: M. Hetenyi, *Beams on Elastic Foundation*, infinite beam: w = P beta/(2 k) under the force.
#[test]
fn a_beam_on_an_elastic_foundation_has_the_deflection_of_hetenyi() {
    let (young, foundation, force): (f64, f64, f64) = (1000.0, 0.05, 1.0);
    let beta = (foundation / (4.0 * young / 12.0)).powf(0.25);
    let half = 7.0 / beta;
    let scene = json!({
        "model": "plane-stress",
        "body": {"rectangle": {"x": {"points": [0, half], "divisions": [80]},
                               "y": {"points": [-0.5, 0.5], "divisions": [2]}, "element": "q8"}},
        "material": {"young": young, "poisson": 0},
        "symmetry": ["x"],
        "springs": [{"on": {"boundary": "bottom"}, "normal": foundation, "stiffness": "per-area"}],
        "loads": [{"force": {"at": [0, 0.5], "value": [0, -force / 2.0]}}],
    });
    let answer = answer(&scene);
    let nodes = answer.model().mesh().nodes();
    let under = nodes.iter().position(|at| at[0] == 0.0 && at[1] == -0.5).unwrap();
    let sink = -answer.displacement()[2 * under + 1];
    let exact = force * beta / (2.0 * foundation);
    // Shear, which beam theory omits, adds about (beta h)^2 = 0.6 %; the end at beta L = 7 adds a thousandth.
    assert!((sink / exact - 1.0).abs() < 0.01, "{sink} {exact}");
    let [across, up] = resultant(&answer, "springs[0]")[..] else { panic!("the force has two components") };
    assert!(across.abs() < 1e-9 && (up - force).abs() < 1e-9, "{across} {up}");
}

/// GOAL: a block on a foundation of springs under a rigid plane.
/// CONDITIONS: the top moves down by 0.03; linear and quadratic faces in space, nu = 0.
/// REFERENCE: springs of 500 and 1000 in series.
#[test]
fn a_foundation_carries_the_contact_force_with_every_element() {
    for element in ["tet4", "hex8", "tet10", "hex20"] {
        let axis = |cells: usize| json!({"points": [0, 1], "divisions": [cells]});
        let scene = json!({
            "model": "space",
            "body": {"box": {"x": axis(2), "y": axis(2), "z": axis(2), "element": element}},
            "material": {"young": 1000, "poisson": 0},
            "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "front"}, "y": 0}],
            "springs": [{"on": {"boundary": "bottom"}, "z": 500}],
            "obstacles": [{"boundary": "top", "approach": "+z", "shape": {"plane": {"point": [0, 0, 1], "normal": [0, 0, 1]}}}],
            "gap": -0.03,
        });
        // Springs of 500 and of 1000 in series, compressed by 0.03.
        let answer = answer(&scene);
        let force = resultant(&answer, "springs[0]")[2];
        assert!((force - 0.03 / (1.0 / 500.0 + 1.0 / 1000.0)).abs() < 1e-10, "{element}: {force}");
        assert!(answer.forces().unwrap().balance < 1e-11, "{element}");
    }
}

/// A spring of 25 along twice the displacement of the end, beside a bar of stiffness 50: to the ground, or to the held
/// node.
#[test]
fn a_spring_of_terms_has_the_stiffness_along_its_elongation() {
    let bar = |spring: Value| {
        json!({
            "model": "bar",
            "body": {"bar": {"x": {"points": [0, 2], "divisions": [4]}, "area": 0.1}},
            "material": {"young": 1000, "poisson": 0},
            "supports": [{"on": {"point": [0]}, "x": 0}],
            "springs": [spring],
            "loads": [{"force": {"at": [2], "value": [3]}}],
        })
    };
    let end = json!({"on": {"point": [2]}, "x": 2});
    let ground = answer(&bar(json!({"terms": [end], "along": 25})));
    let both = answer(&bar(json!({"terms": [end, {"on": {"point": [0]}, "x": -2}], "along": 25})));
    for answer in [ground, both] {
        assert!((answer.displacement()[4] - 3.0 / 150.0).abs() < 1e-14, "{}", answer.displacement()[4]);
        assert!(answer.forces().unwrap().balance < 1e-12);
    }
}

#[test]
fn invalid_springs_are_refused_at_their_path() {
    let refused = |spring: Value, phrases: &[&str]| {
        let scene = json!({
            "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [1]}, "y": {"points": [0, 1], "divisions": [1]}}},
            "material": {"young": 1, "poisson": 0}, "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "springs": [spring],
        });
        let error = build(&scene).unwrap_err().to_string();
        phrases.iter().for_each(|phrase| assert!(error.contains(phrase), "{error}"));
    };
    refused(json!({"on": {"boundary": "top"}}), &["springs[0]", "holds nothing"]);
    refused(json!({"on": {"boundary": "top"}, "y": -1}), &["springs[0].y", "-1", "positive"]);
    refused(json!({"on": {"boundary": "top"}, "z": 1}), &["springs[0].z", "no z"]);
    refused(json!({"on": {"boundary": "roof"}, "y": 1}), &["springs[0].on.boundary", "roof"]);
    refused(json!({"on": {"point": [0, 1]}, "normal": 1}), &["springs[0].normal", "no normal"]);
    refused(json!({"on": {"point": [0, 1]}, "y": 1, "stiffness": "per-area"}), &["springs[0].stiffness", "no area"]);
    let terms = json!([{"on": {"point": [0, 1]}, "y": 1}, {"on": {"point": [1, 1]}, "y": -1}]);
    refused(json!({"x": 1}), &["springs[0]", "needs a place `on`, or `terms`"]);
    refused(json!({"terms": terms}), &["springs[0].along", "is missing"]);
    refused(json!({"terms": terms, "along": 0}), &["springs[0].along", "0 is not allowed", "positive"]);
    refused(json!({"terms": terms, "along": 1, "x": 1}), &["springs[0].x", "one stiffness"]);
    refused(json!({"terms": terms, "along": 1, "stiffness": "per-area"}), &["springs[0].stiffness", "no area"]);
    refused(json!({"on": {"point": [0, 1]}, "terms": terms, "along": 1, "y": 1}), &["springs[0]", "give one of them"]);
    refused(json!({"terms": [{"on": {"point": [0, 1]}}], "along": 1}), &["springs[0].terms[0]", "no coefficient"]);
}

//! Parts of boundaries: their facets, their use, refused input.

use serde_json::{Value, json};
use signorini::scene::Answer;
use signorini::{Error, Model, Scene, solve_qp};
use std::sync::Arc;
use support::scenes::built;

/// A square of 4 x 4 cells, clamped at the bottom, with parts.
fn square(parts: Value) -> Value {
    json!({
        "body": {"rectangle": {"x": {"points": [0, 4], "divisions": [4]}, "y": {"points": [0, 4], "divisions": [4]}}},
        "material": {"young": 100, "poisson": 0.3},
        "parts": parts,
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]
    })
}

/// The coordinates of the nodes of a boundary, in order.
fn nodes(model: &Model, boundary: &str) -> Vec<[f64; 2]> {
    let nodes = model.mesh().nodes();
    let of = model.mesh().boundary(boundary).unwrap();
    of.nodes().iter().map(|&node| [nodes[node][0], nodes[node][1]]).collect()
}

#[test]
fn a_part_has_the_facets_whose_centroids_are_in_its_region() {
    let model = built(&square(json!([
        {"name": "strip", "of": "top", "box": {"min": [0.9, 4], "max": [3, 4]}},
        {"name": "corner", "sphere": {"centre": [4, 4], "radius": 1.5}},
        {"name": "up", "normal": {"direction": [0, 2], "within": 0}},
        {"name": "sides", "normal": {"direction": [1, 0], "within": 90}},
        {"name": "right-of-strip", "of": "strip", "box": {"min": [2, 0], "max": [9, 9]}},
        {"name": "skin"}
    ])));
    assert_eq!(nodes(&model, "strip"), [[1.0, 4.0], [2.0, 4.0], [3.0, 4.0]]);
    // The nodes are ordered along the surface and around the corner, seen from outside.
    assert_eq!(nodes(&model, "corner"), [[4.0, 2.0], [4.0, 3.0], [4.0, 4.0], [3.0, 4.0], [2.0, 4.0]]);
    assert_eq!(nodes(&model, "up").len(), 5);
    assert_eq!(nodes(&model, "sides").len(), 13);
    assert_eq!(nodes(&model, "right-of-strip"), [[2.0, 4.0], [3.0, 4.0]]);
    assert_eq!(nodes(&model, "skin").len(), 16);
}

#[test]
fn a_part_of_a_closed_boundary_is_ordered_across_the_start_of_the_boundary() {
    let model = built(&json!({
        "body": {"disc": {
            "centre": [0, 0], "radius": 1, "element": "t6", "zone": {"width": 0.3, "divisions": 2, "growth": 1.5}
        }},
        "material": {"young": 100, "poisson": 0.3},
        "parts": (0..12).map(|k| {
            let angle = f64::from(k).to_radians() * 30.0;
            json!({"name": format!("{k}"), "normal": {"direction": [angle.cos(), angle.sin()], "within": 50}})
        }).collect::<Vec<_>>(),
        "supports": [{"on": {"boundary": "0"}, "x": 0, "y": 0}]
    }));
    for k in 0..12 {
        let part = nodes(&model, &k.to_string());
        assert!(part.len() > 4);
        let steps = part.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        // Consecutive nodes are neighbours: there is no jump.
        assert!(steps.fold(0.0, f64::max) < 0.3, "{part:?}");
    }
}

#[test]
fn parts_of_further_bodies_carry_loads_supports_and_contact() {
    let axis = |low: f64| json!({"points": [low, low + 1.0], "divisions": [2]});
    let cube = |z: f64| json!({"box": {"x": axis(0.0), "y": axis(0.0), "z": axis(z), "element": "hex8"}});
    let material = json!({"young": 1000, "poisson": 0.0});
    let model = Arc::new(built(&json!({
        "model": "space",
        "body": cube(1.0), "material": material,
        "further-bodies": [{"name": "base", "body": cube(0.0), "material": material}],
        "parts": [
            {"name": "head", "normal": {"direction": [0, 0, 1], "within": 1}},
            {"name": "sole", "of": "base", "normal": {"direction": [0, 0, -1], "within": 1}},
            {"name": "seat", "of": "base.top", "box": {"min": [0, 0, 0], "max": [1, 1, 1]}}
        ],
        "supports": [{"on": {"boundary": "sole"}, "x": 0, "y": 0, "z": 0}, {"on": {"boundary": "head"}, "x": 0, "y": 0}],
        "loads": [{"pressure": {"boundary": "head", "value": 5}}],
        "obstacles": [{"boundary": "bottom", "approach": "-z", "shape": {"body": {"boundary": "seat"}}}]
    })));
    let solution = solve_qp(model.problem()).unwrap();
    assert!((solution.contact_force() - 5.0).abs() < 1e-12, "{}", solution.contact_force());
    let answer = Answer::of(model.clone(), &solution).unwrap();
    let (node, _) = model.mesh().nearest_node([0.5, 0.5, 2.0]).unwrap();
    assert!((answer.displacement()[3 * node + 2] + 2.0 * 5.0 / 1000.0).abs() < 1e-12);
}

#[test]
fn invalid_parts_are_refused_at_their_path() {
    let cases = [
        (json!({"name": "top"}), "parts[0].name", "`top` is not allowed"),
        (json!({"name": ""}), "parts[0].name", "needs a name of its own"),
        (json!({"name": "a", "of": "roof"}), "parts[0].of", "no boundary `roof`; there are left, right"),
        (json!({"name": "a", "box": {"min": [0], "max": [1, 1]}}), "parts[0].box.min", "[x, y]"),
        (json!({"name": "a", "box": {"min": [0, 2], "max": [1, 1]}}), "parts[0].box.max[1]", "1 lies below 2"),
        (json!({"name": "a", "sphere": {"centre": [0, 2], "radius": 0}}), "parts[0].sphere.radius", "positive"),
        (json!({"name": "a", "normal": {"direction": [0, 0], "within": 3}}), "parts[0].normal.direction", "zero"),
        (json!({"name": "a", "normal": {"direction": [0, 1], "within": 181}}), "parts[0].normal.within", "180"),
        (
            json!({"name": "a", "of": "top", "box": {"min": [1.6, 3], "max": [1.9, 5]}}),
            "parts[0]",
            "no facet of `top` lies in it; the nearest has its centroid at (1.5, 4), 1.000e-1 outside",
        ),
        (
            json!({"name": "a", "of": "top", "normal": {"direction": [1, 0], "within": 30}}),
            "parts[0]",
            "60.0 degrees beyond",
        ),
    ];
    for (part, path, phrase) in cases {
        let error = Scene::from_json(&square(json!([part])).to_string(), "scene").unwrap().build().unwrap_err();
        let Error::Scene { path: found, message } = &error else { panic!("{path}: {error}") };
        assert_eq!(found, path, "{error}");
        assert!(message.contains(phrase) && !message.contains('\n'), "{error}\n  lacks: {phrase}");
    }
}

/// Half of a layer of height 1 on a smooth plane, pressed by a strip load of half width 0.5 on its top.
fn layer(load: f64, cells: usize) -> Answer {
    let model = Arc::new(built(&json!({
        "body": {"rectangle": {
            "x": {"points": [0, 1.6, 6], "divisions": [16 * cells / 10, 2 * cells / 5], "ratios": [1, 4]},
            "y": {"points": [0, 1], "divisions": [cells]}, "element": "q4"
        }},
        "material": {"young": 1000, "poisson": 0.3},
        "parts": [{"name": "strip", "of": "top", "box": {"min": [0, 1], "max": [0.5, 1]}}],
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"pressure": {"boundary": "strip", "value": load}}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}]
    })));
    let solution = solve_qp(model.problem()).unwrap();
    Answer::of(model, &solution).unwrap()
}

/// GOAL: the width of a receding contact.
///
/// CONDITIONS: plane strain; a weightless layer of height h on a smooth rigid plane, under a strip load of half width
/// h/2.
///
/// REFERENCE: the layer is a sum of waves along x with the compliances of symmetric and antisymmetric loads; the
/// pressure is a sum of Chebyshev polynomials times sqrt(b^2 - x^2). Only for b = 1.007782 h is the slope of the lower
/// face zero in |x| < b with a pressure that ends without a singularity; then the pressure in the middle is 0.789588 of
/// the load divided by h. Eight polynomials and five agree to nine digits.
#[test]
fn the_width_of_a_receding_contact_does_not_depend_on_the_load() {
    const HALF_WIDTH: f64 = 1.007_782;
    const MIDDLE: f64 = 0.789_588;
    let (one, thousandth) = (layer(1.0, 40), layer(0.001, 40));
    assert_eq!(one.contact_set(), thousandth.contact_set());
    for (small, large) in thousandth.multiplier().iter().zip(one.multiplier()) {
        assert!((large - 1000.0 * small).abs() < 1e-9, "{small} {large}");
    }
    let segments = one.segments();
    let [segment] = &segments[..] else { panic!("there is not exactly one contact") };
    let (width, off) = (segment.extent.width.unwrap(), segment.extent.width_uncertainty.unwrap());
    assert!((width - HALF_WIDTH).abs() < off && off < 0.02, "{width} ± {off}");
    // The load has unit pressure on the whole strip, and the height is 1.
    let middle = one.pressure()[0];
    assert!((middle / MIDDLE - 1.0).abs() < 2e-3, "{middle}");
}

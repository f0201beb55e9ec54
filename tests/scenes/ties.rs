//! Ties: surfaces and nodes that move together, compared with linear displacements, with bodies in one piece and with
//! rigid faces.

use serde_json::{Value, json};
use signorini::study::Sweep;
use signorini::{Error, Settings, qp};
use support::scenes::{answer, build, built};

/// Rounding of a solve with some hundred unknowns, relative to the displacement.
const ROUNDING: f64 = 1e-11;

/// As [`ROUNDING`], where curved or partly covered surfaces are integrated.
const INTEGRATED: f64 = 1e-9;

fn cells(from: f64, to: f64, count: usize) -> Value {
    json!({"points": [from, to], "divisions": [count]})
}

/// A block [0, 1] x [0, 1] (x [0, 1]) on a block below it, tied, and loaded by `traction` on top. The lower body has
/// the nodes of its bottom at `bottom`, a linear displacement field.
struct Stack {
    elements: [&'static str; 2],
    counts: [usize; 2],
}

impl Stack {
    fn is_solid(&self) -> bool {
        self.elements[0].len() > 2
    }

    fn body(&self, index: usize, heights: [f64; 2]) -> Value {
        let (across, up) = (cells(0.0, 1.0, self.counts[index]), cells(heights[0], heights[1], 2));
        let element = self.elements[index];
        match self.is_solid() {
            true => {
                json!({"box": {"x": across, "y": cells(0.0, 1.0, self.counts[1 - index]), "z": up, "element": element}})
            }
            false => json!({"rectangle": {"x": across, "y": up, "element": element}}),
        }
    }

    /// Tension 3 upwards, free to widen.
    fn scene(&self) -> Value {
        let (model, up, traction) = match self.is_solid() {
            true => ("space", "z", json!([0, 0, 3])),
            false => ("plane-stress", "y", json!([0, 3])),
        };
        let mut supports =
            vec![json!({"on": {"boundary": "base.bottom"}, up: 0}), json!({"on": {"boundary": "left"}, "x": 0})];
        supports.push(json!({"on": {"boundary": "base.left"}, "x": 0}));
        if self.is_solid() {
            supports.extend(["front", "base.front"].map(|name| json!({"on": {"boundary": name}, "y": 0})));
        }
        json!({
            "model": model, "body": self.body(0, [1.0, 2.0]), "material": {"young": 100, "poisson": 0.3},
            "further-bodies": [{"name": "base", "body": self.body(1, [0.0, 1.0]), "material": {"young": 100, "poisson": 0.3}}],
            "supports": supports,
            "ties": [{"surfaces": {"boundary": "bottom", "to": "base.top"}}],
            "loads": [{"traction": {"boundary": "top", "value": traction}}],
        })
    }
}

/// GOAL: the patch test of tied surfaces.
/// CONDITIONS: two tied blocks in tension; all pairs of elements in the plane and in space, meshes that match and do
/// not.
/// REFERENCE: uniaxial stress: the strain 0.03, and -nu times that across it.
#[test]
fn a_uniform_tension_passes_between_any_two_meshes() {
    let plane = ["t3", "q4", "t6", "q8"].map(|upper| ["t3", "q4", "t6", "q8"].map(|lower| [upper, lower]));
    let solid =
        ["tet4", "hex8", "tet10", "hex20"].map(|upper| ["tet4", "hex8", "tet10", "hex20"].map(|lower| [upper, lower]));
    for elements in plane.into_iter().chain(solid).flatten() {
        for counts in [[3, 2], [2, 4], [3, 3]] {
            let stack = Stack { elements, counts };
            let answer = answer(&stack.scene());
            let (nodes, dimension) = (answer.model().mesh().nodes(), answer.model().mesh().dimension());
            for (node, at) in nodes.iter().enumerate() {
                for axis in 0..dimension {
                    // Strain 3/100 along the tension, -0.3 times that across it.
                    let exact = at[axis] * if axis + 1 == dimension { 0.03 } else { -0.009 };
                    let away = (answer.displacement()[dimension * node + axis] - exact).abs();
                    assert!(away < INTEGRATED * 0.06, "{elements:?} {counts:?}: {away:e} at {at:?}");
                }
            }
            let tie = answer.resultants().unwrap().iter().find(|resultant| resultant.of == "ties[0]").unwrap();
            // The lower body pulls the upper one down, or the upper one is the side of the means and is pulled up.
            let (force, sense) = (tie.force[dimension - 1], if tie.on.as_deref() == Some("base") { 1.0 } else { -1.0 });
            assert!((force - sense * 3.0).abs() < 3.0 * INTEGRATED, "{elements:?} {counts:?}: {tie:?}");
            assert!(answer.forces().unwrap().balance < INTEGRATED);
        }
    }
}

/// Bending, shear and a support on the tied surface: nothing is uniform.
#[test]
fn two_tied_bodies_with_matching_meshes_are_one_body() {
    for element in ["t3", "q4", "t6", "q8"] {
        let half = |from: f64, to: f64| json!({"rectangle": {"x": cells(0.0, 3.0, 9), "y": cells(from, to, 2), "element": element}});
        let part = json!({"supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}],
                          "material": {"young": 10, "poisson": 0.25}, "loads": [{"traction": {"boundary": "top", "value": [0.1, -0.2]}}]});
        let (mut tied, mut whole) = (part.clone(), part);
        tied["body"] = half(1.0, 2.0);
        tied["further-bodies"] =
            json!([{"name": "low", "body": half(0.0, 1.0), "material": {"young": 10, "poisson": 0.25}}]);
        tied["supports"].as_array_mut().unwrap().push(json!({"on": {"boundary": "low.left"}, "x": 0, "y": 0}));
        tied["ties"] = json!([{"surfaces": {"boundary": "bottom", "to": "low.top"}}]);
        whole["body"] = half(0.0, 2.0);
        whole["body"]["rectangle"]["y"]["divisions"] = json!([4]);
        // Both stand on a support with contact in the middle.
        let shape = json!({"parabola": {"apex": [2, -0.01], "radius": 3}});
        tied["obstacles"] = json!([{"boundary": "low.bottom", "approach": "-y", "shape": shape}]);
        whole["obstacles"] = json!([{"boundary": "bottom", "approach": "-y", "shape": shape}]);
        let (tied, whole) = (answer(&tied), answer(&whole));
        let largest = whole.displacement().iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
        for (node, at) in whole.model().mesh().nodes().iter().enumerate() {
            let same = |other: &[f64; 3]| (0..2).all(|axis| (other[axis] - at[axis]).abs() < 1e-9);
            let others = tied.model().mesh().nodes().iter().enumerate().filter(|other| same(other.1));
            for (other, _) in others {
                for axis in 0..2 {
                    let away = (whole.displacement()[2 * node + axis] - tied.displacement()[2 * other + axis]).abs();
                    assert!(away < ROUNDING * largest, "{element}: {away:e} of {largest:e} at {at:?}");
                }
            }
        }
        let forces = [&whole, &tied].map(|answer| answer.model().obstacle_forces(answer.multiplier())[0]);
        assert!(forces[0] > 0.1 && (forces[1] / forces[0] - 1.0).abs() < ROUNDING, "{forces:?}");
        assert!(tied.forces().unwrap().balance < ROUNDING);
    }
}

/// Three bodies that meet at a line, each tied to both others: the equations along the line repeat each other, except
/// for rounding.
#[test]
fn bodies_that_are_tied_in_a_ring_have_an_answer() {
    for (elements, counts) in
        [(["hex8"; 3], [2, 2, 2]), (["tet4", "hex8", "tet4"], [2, 3, 3]), (["hex8", "tet10", "hex20"], [1, 2, 3])]
    {
        let body = |index: usize, x: [f64; 2], z: [f64; 2]| {
            let [across, depth, up] = [x, [0.0, 1.0], z].map(|[from, to]| cells(from, to, counts[index]));
            json!({"box": {"x": across, "y": depth, "z": up, "element": elements[index]}})
        };
        let material = |young: f64| json!({"young": young, "poisson": 0.3});
        let tie = |boundary: &str, to: &str| json!({"surfaces": {"boundary": boundary, "to": to}});
        let scene = json!({
            "model": "space", "body": body(0, [0.0, 1.0], [0.0, 1.0]), "material": material(100.0),
            "further-bodies": [{"name": "beside", "body": body(1, [1.0, 2.0], [0.0, 1.0]), "material": material(30.0)},
                               {"name": "above", "body": body(2, [0.0, 2.0], [1.0, 2.0]), "material": material(10.0)}],
            "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0, "z": 0}],
            "ties": [tie("right", "beside.left"), tie("top", "above.bottom"), tie("beside.top", "above.bottom")],
            "loads": [{"traction": {"boundary": "above.top", "value": [0.1, 0, -0.2]}}],
        });
        let answer = answer(&scene);
        let support = answer.resultants().unwrap().iter().find(|one| one.of == "supports[0]").unwrap();
        let away = [(0, -0.2), (2, 0.4)].map(|(axis, force)| (support.force[axis] - force).abs());
        assert!(away.iter().all(|away| *away < INTEGRATED), "{elements:?} {counts:?}: {support:?}");
        assert!(answer.forces().unwrap().balance < INTEGRATED);
    }
}

/// Equal displacements along x at the right end are a plate that neither turns nor holds across.
#[test]
fn equations_between_nodes_pull_as_a_plate_does() {
    let body = json!({"rectangle": {"x": cells(0.0, 2.0, 4), "y": cells(0.0, 1.0, 2), "element": "q4"}});
    let term = |y: f64, factor: f64| json!({"on": {"point": [2, y]}, "x": factor});
    let scene = json!({
        "model": "plane-stress", "body": body, "material": {"young": 50, "poisson": 0},
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}],
        // All at the middle node: the others follow it, the upper one 0.01 ahead.
        "ties": [{"equation": {"terms": [term(0.0, 1.0), term(0.5, -1.0)]}},
                 {"equation": {"terms": [term(1.0, -3.0), term(0.5, 3.0)], "value": -0.03}}],
        "loads": [{"force": {"at": [2, 0.5], "value": [4, 0]}}],
    });
    let answer = answer(&scene);
    let at = |y: f64| {
        let node = answer.model().mesh().nodes().iter().position(|at| *at == [2.0, y, 0.0]).unwrap();
        answer.displacement()[2 * node]
    };
    assert!((at(0.0) - at(0.5)).abs() < 1e-14 && (at(1.0) - at(0.5) - 0.01).abs() < 1e-14);
    // The forces of the equations on their first nodes add up to what the middle node hands over.
    let of = |name: &str| answer.resultants().unwrap().iter().find(|one| one.of == name).unwrap().force.clone();
    let forces = answer.forces().unwrap();
    let sum: f64 = forces.ties.iter().step_by(2).sum();
    assert!(sum.abs() < 1e-13 && of("ties[0]")[0] > 0.5 && of("ties[1]")[0] > 0.5, "{sum:e}");
    assert!((of("supports[0]")[0] + 4.0).abs() < 1e-12 && forces.balance < 1e-12);
}

/// A bar whose end stays 0.01 ahead of its support, which moves by 0.02, in place of any load; so does a tied
/// neighbour.
#[test]
fn prescribed_displacements_count_in_ties() {
    let bar =
        |from: f64, to: f64| json!({"rectangle": {"x": cells(from, to, 4), "y": cells(0.0, 1.0, 2), "element": "q8"}});
    let material = json!({"young": 50, "poisson": 0});
    let ahead = |y: f64| {
        let terms = json!([{"on": {"point": [2, y]}, "x": 1}, {"on": {"point": [0, 0]}, "x": -1, "y": 3}]);
        json!({"equation": {"terms": terms, "value": 0.01 + 3.0 * 0.005}})
    };
    let answer = answer(&json!({
        "model": "plane-stress", "body": bar(0.0, 1.0), "material": material,
        "further-bodies": [{"name": "end", "body": bar(1.0, 2.0), "material": material}],
        "supports": [{"on": {"boundary": "left"}, "x": 0.02, "y": 0.005}],
        "ties": [{"surfaces": {"boundary": "right", "to": "end.left"}}, ahead(0.0), ahead(0.25), ahead(0.5), ahead(0.75), ahead(1.0)],
    }));
    for (node, &[x, ..]) in answer.model().mesh().nodes().iter().enumerate() {
        let found = &answer.displacement()[2 * node..2 * node + 2];
        let exact = [0.02 + 0.005 * x, 0.005];
        assert!(
            (0..2).all(|axis| (found[axis] - exact[axis]).abs() < ROUNDING),
            "{found:?} instead of {exact:?} at {x}"
        );
    }
}

/// The energy principle: an equation that the free body would fulfil by itself carries no force.
#[test]
fn an_equation_that_holds_by_itself_carries_no_force() {
    let stack = Stack { elements: ["q8", "q4"], counts: [3, 2] };
    let mut scene = stack.scene();
    let along = |x: f64, y: f64, factor: f64| json!({"on": {"point": [x, y]}, "x": factor, "y": factor});
    // Both corners at the top rise alike, and move by -0.009 and 0 aside.
    scene["ties"]
        .as_array_mut()
        .unwrap()
        .push(json!({"equation": {"terms": [along(1.0, 2.0, 2.0), along(0.0, 2.0, -2.0)], "value": -0.018}}));
    let answer = answer(&scene);
    let tie = answer.resultants().unwrap().iter().find(|resultant| resultant.of == "ties[1]").unwrap();
    assert!(tie.force.iter().all(|part| part.abs() < 1e-10), "{tie:?}");
}

#[test]
fn a_body_that_only_a_tie_holds_is_held_and_what_it_leaves_free_is_named() {
    let stack = Stack { elements: ["hex8", "tet4"], counts: [2, 3] };
    let mut scene = stack.scene();
    let held = json!([{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0, "z": 0}]);
    scene["supports"] = held;
    assert!(answer(&scene).forces().unwrap().balance < INTEGRATED);
    let mut loose = scene.clone();
    loose["ties"] = json!([]);
    let named = |scene: &Value| match build(scene) {
        Err(Error::Qp(qp::Error::UnderHeld { mode, .. })) => mode,
        other => panic!("{other:?}"),
    };
    assert!(named(&loose).contains("translation along x of the first body"), "{}", named(&loose));
    // One equation holds one motion of six.
    loose["ties"] = json!([{"equation": {"terms": [{"on": {"point": [0, 0, 2]}, "x": 1}]}}]);
    let mode = named(&loose);
    assert!(
        !mode.contains("translation along x of") && mode.contains("translation along y of the first body"),
        "{mode}"
    );
    // Surfaces apart still move together: the whole may turn, and nothing else.
    let mut apart = scene;
    apart["body"]["box"]["z"] = cells(1.1, 2.1, 2);
    apart["supports"] = json!([]);
    let mode = named(&apart);
    assert_eq!(mode.matches("rotation").count(), 6, "{mode}");
}

/// Coefficients of 1e20 and 1e-20 are a support of the first node.
#[test]
fn the_size_of_the_coefficients_of_an_equation_holds_no_motion() {
    let mut scene = json!({
        "body": {"rectangle": {"x": cells(0.0, 1.0, 4), "y": cells(0.0, 0.5, 2)}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}], "gap": -0.01,
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0.5, 0.5], "radius": 1}}}]
    });
    let mut tied = scene.clone();
    let term = |x: f64, along: f64| json!({"on": {"point": [x, 0.5]}, "x": along});
    tied["ties"] = json!([{"equation": {"terms": [term(1.0, 1e20), term(0.0, -1e-20)], "value": 1}}]);
    scene["supports"].as_array_mut().unwrap().push(json!({"on": {"point": [1, 0.5]}, "x": 1e-20}));
    let [tied, held] = [tied, scene].map(|scene| answer(&scene).displacement().to_vec());
    assert!(tied.iter().zip(&held).all(|(a, b)| (a - b).abs() < 0.01 * ROUNDING), "{tied:?} {held:?}");
}

#[test]
fn surfaces_that_are_apart_or_cover_each_other_in_part_are_named() {
    let stack = Stack { elements: ["q4", "q4"], counts: [4, 4] };
    let codes = |scene: &Value| built(scene).warnings().iter().map(|warning| warning.code).collect::<Vec<_>>();
    assert!(codes(&stack.scene()).is_empty());
    let mut scene = stack.scene();
    scene["body"]["rectangle"]["y"] = cells(1.05, 2.05, 2);
    assert_eq!(codes(&scene), ["tied-apart"]);
    let mut scene = stack.scene();
    scene["body"]["rectangle"]["x"] = cells(0.5, 1.5, 4);
    scene["supports"] = json!([{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}]);
    assert_eq!(codes(&scene), ["partly-tied"]);
}

#[test]
fn ties_that_cannot_be_are_refused_at_their_path() {
    let stack = Stack { elements: ["q4", "q4"], counts: [2, 2] };
    let with = |tie: Value| {
        let mut scene = stack.scene();
        scene["ties"] = json!([tie]);
        match build(&scene) {
            Err(Error::Scene { path, message }) => format!("{path}: {message}"),
            other => panic!("{other:?}"),
        }
    };
    let term = |on: Value| json!({"on": on, "x": 1});
    let equation = |terms: Value| json!({"equation": {"terms": terms}});
    let surfaces = |boundary: &str, to: &str| json!({"surfaces": {"boundary": boundary, "to": to}});
    for (tie, phrases) in [
        (surfaces("bottm", "base.top"), ["ties[0].surfaces.boundary", "did you mean `bottom`"]),
        (
            surfaces("bottom", "base.bottom"),
            ["ties[0].surfaces", "no facet of `bottom` faces `base.bottom` within 0.5"],
        ),
        (
            json!({"surfaces": {"boundary": "bottom", "to": "base.top", "reach": 0}}),
            ["ties[0].surfaces.reach", "positive"],
        ),
        (equation(json!([])), ["ties[0].equation.terms", "has no term"]),
        (equation(json!([{"on": {"point": [1, 2]}}])), ["ties[0].equation.terms[0]", "no coefficient"]),
        (equation(json!([{"on": {"point": [1, 2]}, "z": 1}])), ["ties[0].equation.terms[0].z", "no displacement z"]),
        (equation(json!([term(json!({"boundary": "top"}))])), ["ties[0].equation.terms[0].on.boundary", "has 3 nodes"]),
        (
            equation(json!([term(json!({"point": [9, 9]}))])),
            ["ties[0].equation.terms[0].on.point", "no node at (9, 9)"],
        ),
        (
            equation(json!([term(json!({"nodes": "TOP"}))])),
            ["ties[0].equation.terms[0].on.nodes", "only nodes of a deck"],
        ),
        (
            json!({"equation": {"terms": [term(json!({"point": [0, 2]}))], "value": 1}}),
            ["ties[0]", "supports prescribe all its displacements, and miss it by 1"],
        ),
    ] {
        let said = with(tie);
        phrases.iter().for_each(|phrase| assert!(said.contains(phrase), "{phrase}: {said}"));
    }
    let mut moving = stack.scene();
    moving["analysis"] = json!({"dynamic": {"duration": 1, "step": 0.1}});
    moving["material"]["density"] = 1.into();
    moving["further-bodies"][0]["material"]["density"] = 1.into();
    let said = build(&moving).unwrap_err().to_string();
    assert!(said.contains("`ties`") && said.contains("equilibria only"), "{said}");
}

/// Equations that contradict each other have no answer, and say so.
#[test]
fn equations_that_contradict_each_other_are_infeasible() {
    let mut scene = Stack { elements: ["q4", "q4"], counts: [2, 2] }.scene();
    let equation = |value: f64| json!({"equation": {"terms": [{"on": {"point": [1, 2]}, "x": 1}], "value": value}});
    scene["ties"].as_array_mut().unwrap().extend([equation(0.1), equation(0.2)]);
    let model = built(&scene);
    assert!(matches!(signorini::solve_qp(model.problem()), Err(qp::Error::Infeasible { .. })));
}

/// A tied pair over a rigid plane, at every gap of a sweep.
#[test]
fn a_sweep_over_gaps_keeps_the_ties() {
    let mut scene = Stack { elements: ["q4", "q4"], counts: [3, 3] }.scene();
    scene["supports"][0] = json!({"on": {"boundary": "top"}, "y": -0.1});
    // Springs hold the lower body without the tie too.
    scene["springs"] = json!([{"on": {"boundary": "base.bottom"}, "y": 10}]);
    scene["loads"] = json!([]);
    scene["obstacles"] = json!([{"boundary": "base.bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}]);
    let model = built(&scene);
    let sweep = Sweep::over_gaps(&model, &[0.2, 0.05, 0.0], &Settings::default()).unwrap();
    for point in &sweep.points {
        assert!(point.answer.forces().unwrap().balance < ROUNDING);
        // A column of height 2, shortened by 0.1 - gap, less what the springs take.
        let force = (100.0 * (0.1 - point.gap) / 2.0 - 10.0 * point.gap).max(0.0);
        let found: f64 = -point.answer.multiplier().iter().sum::<f64>();
        assert!((found - force).abs() < 1e-10, "{}: {found}", point.gap);
    }
}

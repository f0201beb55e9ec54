//! GOAL: two bodies with their own meshes pass a uniform pressure without error, and answer like bodies whose meshes
//! match.

use serde_json::{Value, json};
use signorini::{Model, Solution, solve_qp};
use support::scenes::built;

/// Rounding of a solve with a few hundred unknowns, relative to the displacement.
const PATCH: f64 = 1e-12;

/// Loads, reactions and contact forces of bodies with some thousand unknowns cancel to this.
const BALANCE: f64 = 1e-11;

/// The same where surfaces end inside facets.
const PARTLY_COVERED: f64 = 1e-9;

fn solved(value: &Value) -> (Model, Solution) {
    let model = built(value);
    let solution = solve_qp(model.problem()).map_err(|error| model.explain(error)).unwrap();
    let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
    assert!(balance < BALANCE, "{balance:e}");
    (model, solution)
}

/// Lines of a mesh from 0 to `end`: `count` cells, of random size between `spread` of the mean and its opposite.
fn lines(count: usize, end: f64, spread: f64, state: &mut u64) -> Value {
    let mut random = || {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    let inner = |at: usize, random: f64| end * (at as f64 + spread * random) / count as f64;
    let points: Vec<f64> = (0..=count)
        .map(|at| {
            if at == 0 {
                0.0
            } else if at == count {
                end
            } else {
                inner(at, random())
            }
        })
        .collect();
    json!({"points": points, "divisions": vec![1; count]})
}

fn cells(from: f64, to: f64, count: usize) -> Value {
    json!({"points": [from, to], "divisions": [count]})
}

/// A block on a wider or narrower one in the plane, or as bodies of revolution, pressed by the pressure 1 on top.
struct Blocks {
    model: &'static str,
    /// Of the upper and of the lower body.
    elements: [&'static str; 2],
    counts: [usize; 2],
    widths: [f64; 2],
    spread: f64,
    side: &'static str,
}

const SOFT: [f64; 2] = [2.0, 0.3];
const HARD: [f64; 2] = [5.0, 0.2];

impl Blocks {
    fn scene(&self, state: &mut u64) -> Value {
        let block =
            |body: usize, x: Value, y: Value| json!({"rectangle": {"x": x, "y": y, "element": self.elements[body]}});
        let [upper, lower] = [0, 1].map(|body| lines(self.counts[body], self.widths[body], self.spread, state));
        json!({
            "model": self.model,
            "body": block(0, upper, cells(1.0, 2.0, 2)), "material": {"young": SOFT[0], "poisson": SOFT[1]},
            "further-bodies": [{"name": "base", "body": block(1, lower, cells(0.0, 1.0, 2)),
                                "material": {"young": HARD[0], "poisson": HARD[1]}}],
            "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "base.left"}, "x": 0},
                         {"on": {"boundary": "base.bottom"}, "y": 0}],
            "loads": [{"pressure": {"boundary": "top", "value": 1}}],
            "obstacles": [{"boundary": "bottom", "approach": "-y",
                           "shape": {"body": {"boundary": "base.top", "rows": "mortar", "side": self.side}}}],
        })
    }

    /// Strains of a body under the pressure 1: along x and along y.
    fn strains(&self, [young, nu]: [f64; 2]) -> [f64; 2] {
        match self.model {
            "plane-strain" => [nu * (1.0 + nu) / young, -(1.0 - nu * nu) / young],
            _ => [nu / young, -1.0 / young],
        }
    }

    /// The largest error of the displacement, relative to the largest displacement, and the largest error of the
    /// pressure.
    fn errors(&self, state: &mut u64) -> [f64; 2] {
        let (model, solution) = solved(&self.scene(state));
        let nodal = model.nodal_displacement(&solution.displacement).unwrap();
        let [upper, lower] = [SOFT, HARD].map(|material| self.strains(material));
        let (nodes, first_of_base) = (model.mesh().nodes(), model.body().regions()[1].nodes().start);
        let mut away: f64 = 0.0;
        for (node, &[x, y, _]) in nodes.iter().enumerate() {
            let exact = match node < first_of_base {
                true => [upper[0] * x, lower[1] + upper[1] * (y - 1.0)],
                false => [lower[0] * x, lower[1] * y],
            };
            (0..2).for_each(|axis| away = away.max((nodal[2 * node + axis] - exact[axis]).abs()));
        }
        let pressures = model.pressure(&solution.multiplier).unwrap();
        let of_pressure = pressures.iter().fold(0.0_f64, |most, pressure| most.max((pressure - 1.0).abs()));
        assert!(!pressures.is_empty() && solution.contact_set.count() == pressures.len());
        [away / (lower[1] + upper[1]).abs(), of_pressure]
    }
}

/// All pairs of elements, the same ones first.
fn all_pairs(elements: [&'static str; 4]) -> impl Iterator<Item = [&'static str; 2]> {
    (0..16).map(move |pair| [elements[pair % 4], elements[(pair % 4 + pair / 4) % 4]])
}

/// GOAL: the contact patch test of meshes that do not match, in the plane and about the axis.
/// CONDITIONS: two blocks of two materials, all pairs of elements, from 1 to 7 cells along the contact; the rows on
/// either body.
/// REFERENCE: a uniform pressure, and the strains of the blocks under it.
#[test]
fn a_uniform_pressure_passes_between_any_two_meshes_in_the_plane_and_about_the_axis() {
    let mut state = 11;
    for model in ["plane-strain", "plane-stress", "axisymmetric"] {
        for elements in all_pairs(["t3", "q4", "t6", "q8"]) {
            for counts in [[2, 3], [3, 2], [1, 4], [4, 1], [7, 5], [3, 3]] {
                for (side, spread) in [("this", 0.0), ("other", 0.6)] {
                    let blocks = Blocks { model, elements, counts, widths: [1.0, 1.0], spread, side };
                    let [of_displacement, of_pressure] = blocks.errors(&mut state);
                    let name = format!("{model} {elements:?} {counts:?} {side}");
                    assert!(of_displacement < PATCH, "{name}: displacement {of_displacement:e}");
                    assert!(of_pressure < PARTLY_COVERED, "{name}: pressure {of_pressure:e}");
                }
            }
        }
    }
}

/// Five Gauss points on [0, 1].
fn gauss() -> [(f64, f64); 5] {
    let (a, b) =
        ((5.0 - 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0, (5.0 + 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0);
    let (v, w) = ((322.0 + 13.0 * 70.0_f64.sqrt()) / 900.0, (322.0 - 13.0 * 70.0_f64.sqrt()) / 900.0);
    [(0.0, 128.0 / 225.0), (a, v), (-a, v), (b, w), (-b, w)].map(|(at, weight)| ((1.0 + at) / 2.0, weight / 2.0))
}

/// The forces of the pressure 1 against a horizontal edge from `from` to the right, node by node: of a boundary whose
/// nodes are known.
fn rest_of_pressure(model: &Model, boundary: &str, from: f64) -> Vec<(usize, f64)> {
    let (mesh, mut forces) = (model.mesh(), Vec::new());
    for facet in mesh.boundary(boundary).unwrap().facets() {
        let x = |local: usize| mesh.nodes()[facet[local]][0];
        let (left, right) = (x(0).min(x(1)), x(0).max(x(1)));
        let low = left.max(from);
        if low >= right {
            continue;
        }
        for (at, weight) in gauss() {
            let place = low + at * (right - low);
            let xi = 2.0 * (place - x(0)) / (x(1) - x(0)) - 1.0;
            let shape = match facet.len() {
                2 => vec![(1.0 - xi) / 2.0, (1.0 + xi) / 2.0],
                _ => vec![xi * (xi - 1.0) / 2.0, xi * (xi + 1.0) / 2.0, 1.0 - xi * xi],
            };
            forces.extend(facet.iter().zip(shape).map(|(&node, share)| (node, weight * (right - low) * share)));
        }
    }
    forces
}

/// GOAL: the contact patch test of surfaces that cover each other in part.
/// CONDITIONS: the wider surface ends inside an edge of the other, or a thousandth or a hundredth of an edge beyond a
/// node. On the rest of the wider surface the pressure is a load.
/// REFERENCE: a uniform pressure, and the strains of the blocks under it.
#[test]
fn a_uniform_pressure_passes_where_surfaces_cover_each_other_in_part() {
    let mut state = 13;
    for elements in [["t3"; 2], ["q4"; 2], ["t6"; 2], ["q8"; 2], ["t3", "q8"], ["t6", "q4"]] {
        for counts in [[4, 3], [4, 12]] {
            for end in [3.4, 3.001, 3.01, 2.9999] {
                for (widths, side) in [([4.0 / end, 1.0], "this"), ([4.0 / end, 1.0], "other")] {
                    let blocks = Blocks { model: "plane-strain", elements, counts, widths, spread: 0.0, side };
                    let scene = blocks.scene(&mut state);
                    let model = built(&scene);
                    let mut load = model.problem().load().to_vec();
                    for (node, force) in rest_of_pressure(&model, "bottom", 1.0) {
                        load[model.dofs().number(2 * node + 1).unwrap()] += force;
                    }
                    let solution = solve_qp(&model.problem().with_load(load).unwrap()).unwrap();
                    let nodal = model.nodal_displacement(&solution.displacement).unwrap();
                    let strain = [SOFT, HARD].map(|material| blocks.strains(material)[1]);
                    let first_of_base = model.body().regions()[1].nodes().start;
                    let mut away: f64 = 0.0;
                    for (node, &[_, y, _]) in model.mesh().nodes().iter().enumerate() {
                        let exact =
                            if node < first_of_base { strain[1] + strain[0] * (y - 1.0) } else { strain[1] * y };
                        away = away.max((nodal[2 * node + 1] - exact).abs());
                    }
                    let name = format!("{elements:?} {counts:?} {end} {side}: {away:e}");
                    assert!(away < PARTLY_COVERED, "{name}");
                    for pressure in model.pressure(&solution.multiplier).unwrap() {
                        assert!((pressure - 1.0).abs() < 1e-6, "{name}: pressure {pressure}");
                    }
                    let largest =
                        model.rows().iter().flat_map(|row| &row.ends).fold(0.0_f64, |most, end| most.max(end.1.abs()));
                    assert!(largest < 3.0, "{name}: share {largest}");
                }
            }
        }
    }
}

/// GOAL: the contact patch test of meshes that do not match, in space.
/// CONDITIONS: two blocks of two materials, all pairs of elements; means over areas and pairs of nodes.
/// REFERENCE: a uniform pressure, and the strains of the blocks under it.
#[test]
fn a_uniform_pressure_passes_between_any_two_meshes_in_space() {
    let mut state = 17;
    for elements in all_pairs(["tet4", "hex8", "tet10", "hex20"]) {
        // The last has nodes that pair up; its facets do not, if they are triangles on quadrilaterals.
        for (counts, side, rows) in [
            ([[2, 3], [3, 2]], "this", "mortar"),
            ([[1, 2], [4, 3]], "other", "mortar"),
            ([[3, 2], [2, 3]], "this", "mortar"),
            ([[2, 3], [2, 3]], "this", "auto"),
        ] {
            let spread = if rows == "auto" { 0.0 } else { 0.5 };
            let block = |body: usize, z: Value, state: &mut u64| {
                let (counts, element) = (counts[body], elements[body]);
                let [x, y] = counts.map(|count| lines(count, 1.0, spread, state));
                json!({"box": {"x": x, "y": y, "z": z, "element": element}})
            };
            let scene = json!({
                "model": "space", "body": block(0, cells(1.0, 2.0, 1), &mut state), "material": {"young": SOFT[0], "poisson": SOFT[1]},
                "further-bodies": [{"name": "base", "body": block(1, cells(0.0, 1.0, 1), &mut state),
                                    "material": {"young": HARD[0], "poisson": HARD[1]}}],
                "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "base.left"}, "x": 0},
                             {"on": {"boundary": "front"}, "y": 0}, {"on": {"boundary": "base.front"}, "y": 0},
                             {"on": {"boundary": "base.bottom"}, "z": 0}],
                "loads": [{"pressure": {"boundary": "top", "value": 1}}],
                "obstacles": [{"boundary": "bottom", "approach": "-z",
                               "shape": {"body": {"boundary": "base.top", "rows": rows, "side": side}}}],
            });
            let (model, solution) = solved(&scene);
            let is_alike = |other: &str| elements[0].starts_with(other) == elements[1].starts_with(other);
            let are_pairs = rows == "auto" && is_alike("tet") && is_alike("hex8") && is_alike("tet10");
            assert!(model.rows().iter().all(|row| row.is_mean != are_pairs), "{elements:?}");
            let nodal = model.nodal_displacement(&solution.displacement).unwrap();
            let first_of_base = model.body().regions()[1].nodes().start;
            let name = format!("{elements:?} {counts:?} {side}");
            for (node, &[x, y, z]) in model.mesh().nodes().iter().enumerate() {
                let ([young, nu], from) = if node < first_of_base { (SOFT, 1.0) } else { (HARD, 0.0) };
                let below = if node < first_of_base { -1.0 / HARD[0] } else { 0.0 };
                let exact = [nu / young * x, nu / young * y, below - (z - from) / young];
                for axis in 0..3 {
                    let away = (nodal[3 * node + axis] - exact[axis]).abs();
                    assert!(away < PATCH, "{name}: node {node} is {away:e} away");
                }
            }
            for pressure in model.pressure(&solution.multiplier).unwrap() {
                assert!((pressure - 1.0).abs() < PARTLY_COVERED, "{name}: pressure {pressure}");
            }
            let gaps = signorini::scene::Answer::new(
                std::sync::Arc::new(model),
                &solution.displacement,
                &solution.multiplier,
                &solution.contact_set,
            )
            .unwrap()
            .remaining_gaps();
            assert!(gaps.iter().all(|gap| gap.abs() < PATCH), "{name}: {gaps:?}");
        }
    }
}

/// GOAL: the contact patch test of a body on two others.
/// CONDITIONS: their joint lies inside facets of the upper body, or a thousandth of a facet beyond its nodes: its nodes
/// near the joint carry a row against each of them.
/// REFERENCE: a uniform pressure, and the strains of the blocks under it.
#[test]
fn a_uniform_pressure_passes_to_two_bodies_whose_joint_lies_inside_facets() {
    let mut state = 23;
    for (space, kinds) in [(false, ["t3", "q4", "t6", "q8"]), (true, ["tet4", "hex8", "tet10", "hex20"])] {
        for elements in all_pairs(kinds) {
            for joint in [0.37, 0.5005] {
                let block = |body: usize, from: f64, to: f64, up: [f64; 2], count: usize, state: &mut u64| {
                    let mut x = lines(count, to - from, 0.5, state);
                    x["points"]
                        .as_array_mut()
                        .unwrap()
                        .iter_mut()
                        .for_each(|at| *at = json!(from + at.as_f64().unwrap()));
                    let up = cells(up[0], up[1], 1);
                    match space {
                        true => {
                            json!({"box": {"x": x, "y": lines(2 + body, 1.0, 0.5, state), "z": up, "element": elements[body]}})
                        }
                        false => json!({"rectangle": {"x": x, "y": up, "element": elements[body]}}),
                    }
                };
                let upper = block(0, 0.0, 1.0, [1.0, 2.0], if joint == 0.37 { 3 } else { 2 }, &mut state);
                let left = block(1, 0.0, joint, [0.0, 1.0], 2, &mut state);
                let right = block(1, joint, 1.0, [0.0, 1.0], 3, &mut state);
                let [soft, hard] = [SOFT, HARD].map(|[young, poisson]| json!({"young": young, "poisson": poisson}));
                let (up, down) = if space { ("z", "-z") } else { ("y", "-y") };
                let mut supports = vec![
                    json!({"on": {"boundary": "left"}, "x": 0}),
                    json!({"on": {"boundary": "first.left"}, "x": 0}),
                    json!({"on": {"boundary": "second.left"}, "x": HARD[1] / HARD[0] * joint}),
                ];
                for name in ["first", "second"] {
                    supports.push(json!({"on": {"boundary": format!("{name}.bottom")}, up: 0}));
                }
                for name in ["front", "first.front", "second.front"].into_iter().filter(|_| space) {
                    supports.push(json!({"on": {"boundary": name}, "y": 0}));
                }
                let below = |name: &str| {
                    json!({"boundary": "bottom", "approach": down,
                    "shape": {"body": {"boundary": format!("{name}.top"), "rows": "mortar", "side": "this"}}})
                };
                let (model, solution) = solved(&json!({
                    "model": if space { "space" } else { "plane-stress" },
                    "body": upper, "material": soft,
                    "further-bodies": [{"name": "first", "body": left, "material": hard}, {"name": "second", "body": right, "material": hard}],
                    "supports": supports, "loads": [{"pressure": {"boundary": "top", "value": 1}}],
                    "obstacles": [below("first"), below("second")],
                }));
                let nodal = model.nodal_displacement(&solution.displacement).unwrap();
                let (dimension, first_below) = (model.mesh().dimension(), model.body().regions()[1].nodes().start);
                let name = format!("{elements:?} {joint}");
                for (node, at) in model.mesh().nodes().iter().enumerate() {
                    let ([young, nu], from) = if node < first_below { (SOFT, 1.0) } else { (HARD, 0.0) };
                    let below = if node < first_below { -1.0 / HARD[0] } else { 0.0 };
                    let height = at[dimension - 1];
                    for axis in 0..dimension {
                        let exact =
                            if axis == dimension - 1 { below - (height - from) / young } else { nu / young * at[axis] };
                        let away = (nodal[dimension * node + axis] - exact).abs();
                        assert!(away < PARTLY_COVERED, "{name}: node {node} is {away:e} away");
                    }
                }
                for pressure in model.pressure(&solution.multiplier).unwrap() {
                    assert!((pressure - 1.0).abs() < 1e-6, "{name}: pressure {pressure}");
                }
                let largest =
                    model.rows().iter().flat_map(|row| &row.ends).fold(0.0_f64, |most, end| most.max(end.1.abs()));
                assert!(largest < 3.0, "{name}: share {largest}");
            }
        }
    }
}

/// GOAL: a contact patch test of second order.
/// CONDITIONS: plane stress without Poisson's ratio under the pressure `1 + x/2`; quadratic elements on meshes that do
/// not match.
/// REFERENCE: `stress_yy = -(1 + x/2)` and nothing else, so that `u_y` is linear in x and y each, and `u_x` quadratic
/// in y.
#[test]
fn quadratic_edges_pass_a_linear_pressure() {
    let mut state = 19;
    for element in ["t6", "q8"] {
        for (counts, side) in [([2, 3], "this"), ([3, 2], "other"), ([4, 6], "this"), ([7, 5], "other")] {
            let block = |x: Value, y: Value| json!({"rectangle": {"x": x, "y": y, "element": element}});
            let [upper, lower] = counts.map(|count| lines(count, 1.0, 0.5, &mut state));
            let (model, solution) = solved(&json!({
                "model": "plane-stress",
                "body": block(upper, cells(1.0, 2.0, 2)), "material": {"young": 1, "poisson": 0},
                "further-bodies": [{"name": "base", "body": block(lower, cells(0.0, 1.0, 2)),
                                    "material": {"young": 2, "poisson": 0}}],
                "supports": [{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "bottom"}, "x": 0}],
                "loads": [{"pressure": {"boundary": "top", "value": 1,
                                        "profile": {"along": [1, 0], "places": [0, 1], "factors": [1, 1.5]}}}],
                "obstacles": [{"boundary": "bottom", "approach": "-y",
                               "shape": {"body": {"boundary": "base.top", "rows": "mortar", "side": side}}}],
            }));
            let nodal = model.nodal_displacement(&solution.displacement).unwrap();
            let first_of_base = model.body().regions()[1].nodes().start;
            let name = format!("{element} {counts:?} {side}");
            for (node, &[x, y, _]) in model.mesh().nodes().iter().enumerate() {
                let pressure = 1.0 + x / 2.0;
                let exact = match node < first_of_base {
                    true => [(y - 1.0) / 4.0 + (y - 1.0) * (y - 1.0) / 4.0, -pressure / 2.0 - pressure * (y - 1.0)],
                    false => [y * y / 8.0, -pressure * y / 2.0],
                };
                for axis in 0..2 {
                    let away = (nodal[2 * node + axis] - exact[axis]).abs();
                    assert!(away < PATCH, "{name}: node {node} is {away:e} away");
                }
            }
        }
    }
}

/// Where the meshes match, means are pairs.
#[test]
fn matching_meshes_have_the_same_answer_as_pairs() {
    for (element, rule) in [("q4", "approach"), ("t6", "approach"), ("q8", "approach")] {
        let half = |half: &str| {
            let centre = if half == "lower" { 1.0 } else { -1.0 };
            let zone = json!({"width": 0.2, "divisions": 8, "growth": 1.6});
            json!({"half-disc": {"half": half, "centre": [0, centre], "radius": 1, "zone": zone, "element": element}})
        };
        let scene = |rows: &str| {
            json!({
                "body": half("lower"), "material": {"young": 1, "poisson": 0.3},
                "further-bodies": [{"name": "base", "body": half("upper"), "material": {"young": 3, "poisson": 0.2}}],
                "supports": [{"on": {"boundary": "cut"}, "x": 0, "y": -0.02}, {"on": {"boundary": "base.cut"}, "x": 0, "y": 0}],
                "obstacles": [{"boundary": "arc", "approach": "-y", "rule": rule,
                               "shape": {"body": {"boundary": "base.arc", "rows": rows, "side": "this"}}}],
            })
        };
        let [(pairs, of_pairs), (means, of_means), (auto, of_auto)] =
            ["pairs", "mortar", "auto"].map(|rows| solved(&scene(rows)));
        assert!(pairs.rows().iter().all(|row| !row.is_mean) && means.rows().iter().all(|row| row.is_mean));
        // Bit by bit.
        assert_eq!((auto.rows(), &of_auto.multiplier), (pairs.rows(), &of_pairs.multiplier), "{element}");
        let largest = of_pairs.multiplier.iter().fold(0.0_f64, |most, lambda| most.max(lambda.abs()));
        let by_node = |model: &Model, solution: &Solution| -> std::collections::BTreeMap<usize, f64> {
            model.rows().iter().zip(&solution.multiplier).map(|(row, &lambda)| (row.node, lambda)).collect()
        };
        let (first, second) = (by_node(&pairs, &of_pairs), by_node(&means, &of_means));
        for (node, lambda) in first {
            let other = second.get(&node).copied().unwrap_or(0.0);
            assert!((lambda - other).abs() < PATCH * largest, "{element} node {node}: {lambda:e} and {other:e}");
        }
    }
}

/// GOAL: a shaft pressed into a hub.
/// CONDITIONS: plane strain, both full circles, meshes that do not match; `fit` gives the interference, or the meshes
/// overlap. The pressure of linear elements is that of a polygon.
/// REFERENCE: Lamé: a uniform pressure.
#[test]
fn a_press_fit_has_the_pressure_of_lame() {
    let interference = 1e-3;
    for [shaft, hub] in [[1.0, 1.0], [1.0, 10.0], [10.0, 1.0]] {
        for (counts, element, is_drawn, of_force, of_pressure) in [
            ([24, 36], "q8", false, 2e-3, 1e-2),
            ([36, 24], "q8", false, 2e-3, 1e-2),
            ([48, 72], "q4", false, 1e-2, 2e-2),
            // The sag of the edges is twice the interference; without their curves the force is off by 80 to 140 %.
            ([48, 72], "q4", true, 1e-2, 2e-2),
            ([72, 48], "q4", true, 1e-2, 3e-2),
        ] {
            let outer = if is_drawn { 1.0 + interference } else { 1.0 };
            let hub_side = |side: &str| {
                let mut body = json!({"boundary": "hub.inner", "rows": "mortar", "side": side});
                if !is_drawn {
                    body["fit"] = json!({"interference": interference});
                }
                body
            };
            for side in ["this", "other"] {
                let ring = |radii: [f64; 2], count: usize| {
                    json!({"ring": {"radius": {"points": radii, "divisions": [4]}, "element": element,
                                    "angle": {"points": [0, 360], "divisions": [count]}}})
                };
                let (model, solution) = solved(&json!({
                    "body": ring([0.5, outer], counts[0]), "material": {"young": shaft, "poisson": 0.3},
                    "further-bodies": [{"name": "hub", "body": ring([1.0, 2.0], counts[1]),
                                        "material": {"young": hub, "poisson": 0.25}}],
                    "supports": [{"on": {"point": [0.5, 0]}, "y": 0}, {"on": {"point": [-0.5, 0]}, "y": 0},
                                 {"on": {"point": [0, 0.5]}, "x": 0}, {"on": {"point": [2, 0]}, "y": 0},
                                 {"on": {"point": [-2, 0]}, "y": 0}, {"on": {"point": [0, 2]}, "x": 0}],
                    "obstacles": [{"boundary": "outer", "approach": "+x", "rule": "closest-point", "shape": {"body": hub_side(side)}}],
                }));
                // Radial compliance of both rings at the radius 1, in plane strain.
                let compliance = |young: f64, nu: f64, inner: f64, outer: f64, is_shaft: bool| {
                    let (modulus, ratio) = (young / (1.0 - nu * nu), nu / (1.0 - nu));
                    let shape = (outer * outer + inner * inner) / (outer * outer - inner * inner);
                    (shape + if is_shaft { -ratio } else { ratio }) / modulus
                };
                let exact =
                    interference / (compliance(shaft, 0.3, 0.5, 1.0, true) + compliance(hub, 0.25, 1.0, 2.0, false));
                let force: f64 = -solution.multiplier.iter().sum::<f64>() / std::f64::consts::TAU;
                let pressures = model.pressure(&solution.multiplier).unwrap();
                let (low, high) =
                    pressures.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &p| (low.min(p), high.max(p)));
                let name = format!("E {shaft}:{hub} {element} {counts:?} {side} {is_drawn}");
                assert!((force / exact - 1.0).abs() < of_force, "{name}: force {force:e} for {exact:e}");
                assert!(low > (1.0 - of_pressure) * exact, "{name}: pressure {low:e} for {exact:e}");
                assert!(high < (1.0 + of_pressure) * exact, "{name}: pressure {high:e} for {exact:e}");
            }
        }
    }
}

/// GOAL: the contact of two cylinders whose meshes do not match.
/// CONDITIONS: plane strain; radii 1 and 2, E = 1 and 3, nu = 0.3; the force, and the root of the mean square of the
/// error of the pressure inside 0.8 a, relative to its peak.
/// REFERENCE: Hertz: p = p0 sqrt(1 - x^2/a^2); the force on meshes that match.
#[test]
fn discs_of_other_meshes_have_the_force_of_matching_ones_and_the_pressure_of_hertz() {
    let moduli = [1.0, 3.0];
    let solved_with = |counts: [usize; 2], side: &str, element: &str| -> [f64; 2] {
        let half = |half: &str, radius: f64, count: usize| {
            let centre = if half == "lower" { radius } else { -radius };
            let zone = json!({"width": 0.15, "divisions": count, "growth": 1.25});
            json!({"half-disc": {"half": half, "centre": [0, centre], "radius": radius, "zone": zone, "symmetric": true,
                                 "element": element}})
        };
        let (model, solution) = solved(&json!({
            "body": half("lower", 1.0, counts[0]), "material": {"young": moduli[0], "poisson": 0.3},
            "further-bodies": [{"name": "base", "body": half("upper", 2.0, counts[1]),
                                "material": {"young": moduli[1], "poisson": 0.3}}],
            "supports": [{"on": {"boundary": "cut"}, "y": -0.005}, {"on": {"boundary": "symmetry-x"}, "x": 0},
                         {"on": {"boundary": "base.cut"}, "y": 0}, {"on": {"boundary": "base.symmetry-x"}, "x": 0}],
            "obstacles": [{"boundary": "arc", "approach": "-y",
                           "shape": {"body": {"boundary": "base.arc", "rows": "mortar", "side": side}}}],
        }));
        let force = -2.0 * solution.multiplier.iter().sum::<f64>();
        let compliance: f64 = moduli.iter().map(|young| (1.0 - 0.09) / young).sum();
        // Of the radii 1 and 2.
        let radius = 1.0 / 1.5;
        let half = (4.0 * force * radius * compliance / std::f64::consts::PI).sqrt();
        let peak = 2.0 * force / (std::f64::consts::PI * half);
        let (mut sum, mut count) = (0.0, 0);
        for (row, pressure) in model.rows().iter().zip(model.pressure(&solution.multiplier).unwrap()) {
            let x = model.mesh().nodes()[row.node][0] / half;
            if x.abs() < 0.8 {
                sum += (pressure / peak - (1.0 - x * x).sqrt()).powi(2);
                count += 1;
            }
        }
        assert!(count >= 8, "{count} nodes");
        [force, (sum / f64::from(count)).sqrt()]
    };
    for element in ["q4", "q8"] {
        let [matching, _] = solved_with([40, 40], "this", element);
        for counts in [[40, 60], [60, 40]] {
            for side in ["this", "other"] {
                let [force, rms] = solved_with(counts, side, element);
                let name = format!("{element} {counts:?} {side}");
                assert!((force / matching - 1.0).abs() < 1e-3, "{name}: force {force:e} for {matching:e}");
                assert!(rms < 1.5e-2, "{name}: pressure {rms:e} off");
            }
        }
    }
}

//! Derivatives against differences of fourth order of the problems of scenes whose nodes are moved one by one.

use std::sync::Arc;

use super::*;
use crate::scene::derivatives::output::Output;
use crate::scene::input::obstacle::{Obstacle, ObstacleRow};
use crate::scene::models::build::model_of;
use crate::scene::models::elastic::bodies;
use crate::scene::{Answer, Model};
use signorini_qp::{ContactSet, dot};

/// Derivatives of outputs by places agree with differences to within this, relative to the largest entry: rounding over
/// the step.
const CLOSE: f64 = 1e-7;

/// Step of the differences, in length; edges are about 0.5 long.
const STEP: f64 = 1e-4;

/// As many reproducible numbers from -1 to 1 as `count` says.
fn random(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        // The multiplier is that of D. E. Knuth's generator MMIX.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.0
    };
    (0..count).map(|_| next()).collect()
}

fn scene(text: &str) -> Scene {
    Scene::from_json(text, "scene").unwrap()
}

/// The models of a scene with one nodal coordinate moved by some steps, and all others slightly off the lattice.
struct Moving<'a> {
    scene: &'a Scene,
    further: Vec<(&'a str, Arc<dyn Obstacle>)>,
    off: Vec<f64>,
}

impl<'a> Moving<'a> {
    /// `may_move` chooses the nodes that leave the lattice, by their place.
    fn of(scene: &'a Scene, may_move: impl Fn([f64; 3]) -> bool) -> Self {
        let bodies = bodies(scene).unwrap();
        let nodes = bodies.iter().flat_map(|body| body.mesh().nodes().iter().map(|node| (*node, body.dimension())));
        let off = nodes.flat_map(|(node, dimension)| vec![if may_move(node) { 0.03 } else { 0.0 }; dimension]);
        let off: Vec<f64> = off.collect();
        let off = off.iter().zip(random(off.len(), 9)).map(|(size, share)| size * share).collect();
        Moving { scene, further: Vec::new(), off }
    }

    fn model(&self, moved: Option<(usize, f64)>) -> Result<Model, Error> {
        let mut first = 0;
        let bodies = bodies(self.scene)?.into_iter().map(|body| {
            let own = first..first + body.nodal_dofs();
            first = own.end;
            let off = own.clone().fold(body, |body, dof| body.moved(dof - own.start, self.off[dof]));
            match moved {
                Some((dof, by)) if own.contains(&dof) => off.moved(dof - own.start, by),
                _ => off,
            }
        });
        model_of(self.scene, bodies.collect(), &self.further)
    }

    /// The derivatives of `value` with respect to the coordinates for which the scene can be built.
    fn differences(&self, value: impl Fn(&Model) -> f64) -> Vec<Option<f64>> {
        let unknowns = self.model(None).unwrap().problem().dofs();
        let along = |dof: usize| {
            let at = |steps: f64| {
                let model = self.model(Some((dof, steps * STEP))).ok()?;
                // A node off a plane of symmetry is free.
                (model.problem().dofs() == unknowns).then(|| value(&model))
            };
            Some((8.0 * (at(1.0)? - at(-1.0)?) - (at(2.0)? - at(-2.0)?)) / (12.0 * STEP))
        };
        (0..self.off.len()).map(along).collect()
    }

    /// An answer and an adjoint solution that solve nothing, all of size one; every row takes part.
    fn answer(&self) -> (Answer, Vec<f64>, Vec<f64>) {
        let model = Arc::new(self.model(None).unwrap());
        let (unknowns, rows) = (model.problem().dofs(), model.rows().len());
        let ties = model.parts.ties.rows.len();
        let set: ContactSet = (0..rows).map(|_| true).collect();
        let answer = Answer::new(model, &random(unknowns, 1), &random(rows + ties, 2), &set).unwrap();
        (answer, random(unknowns, 3), random(rows, 4))
    }

    fn check_with_areas(&self) {
        self.check(0);
        self.check_areas();
    }

    fn check(&self, most_skipped: usize) {
        let (answer, adjoint, forces) = self.answer();
        let found = by_places(self.scene, &Pairing { answer: &answer, adjoint: &adjoint, forces: &forces }).unwrap();
        let (u, lambda) = (random(adjoint.len(), 1), answer.multiplier().to_vec());
        let residual = |model: &Model| {
            let problem = model.problem();
            let (contact, gap) = problem.inequalities_given();
            let [of_u, of_w] = [&u, &adjoint].map(|field| contact.mul(field));
            let balance = dot(&adjoint, problem.load()) - dot(&adjoint, &problem.stiffness().mul(&u));
            balance + dot(&lambda, &of_w) + dot(&forces, &of_u) - dot(&forces, gap)
        };
        assert_close(&found, &self.differences(residual), most_skipped);
    }

    fn check_areas(&self) {
        let weights = random(self.model(None).unwrap().rows().len(), 5);
        let found = areas_by_places(&self.model(None).unwrap(), &weights).unwrap();
        let areas = |model: &Model| {
            model.rows().iter().zip(&weights).map(|(row, weight)| weight * row.projected_area()).sum::<f64>()
        };
        assert_close(&found, &self.differences(areas), 0);
    }

    /// Checks the change of an output at fixed displacement and multipliers. The rows of `closed` press, those in the
    /// middle most.
    fn check_output(&self, name: &str, closed: std::ops::Range<usize>, most_skipped: usize) {
        let answer = |model: &Model| {
            let rows = 0..model.rows().len();
            let set: ContactSet = rows.clone().map(|row| closed.contains(&row)).collect();
            let force = |row: usize| match closed.contains(&row) {
                true => -1.0 - ((row - closed.start) * (closed.end - 1 - row)) as f64,
                false => 0.0,
            };
            let forces: Vec<f64> = rows.map(force).collect();
            Answer::new(Arc::new(model.clone()), &random(model.problem().dofs(), 1), &forces, &set).unwrap()
        };
        let branch = |answer: &Answer| Output::of(name, answer.model()).unwrap().branches(answer).unwrap().remove(0);
        let at_rest = answer(&self.model(None).unwrap());
        let found = branch(&at_rest).direct_by_places(&at_rest).unwrap();
        assert_close(&found, &self.differences(|model| branch(&answer(model)).value), most_skipped);
    }
}

fn assert_close(found: &[f64], expected: &[Option<f64>], most_skipped: usize) {
    let largest = expected.iter().flatten().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    assert!(largest > 1e-3, "nothing depends on the places");
    let skipped = expected.iter().filter(|entry| entry.is_none()).count();
    assert!(skipped <= most_skipped, "{skipped} coordinates cannot be moved");
    for (dof, (found, expected)) in found.iter().zip(expected).enumerate() {
        let Some(expected) = expected else { continue };
        assert!((found - expected).abs() <= CLOSE * largest, "dof {dof}: {found} is not {expected} of {largest}");
    }
}

const MATERIAL: &str = r#""material": {"young": 2, "poisson": 0.3, "density": 1.5, "expansion": 0.1}"#;

/// A rectangle of elements, between two places and in so many parts along x, and along y.
fn rectangle(element: &str, [x, y]: [([f64; 2], usize); 2]) -> String {
    let lines = |(points, parts): ([f64; 2], usize)| format!(r#"{{"points": {points:?}, "divisions": [{parts}]}}"#);
    format!(r#"{{"rectangle": {{"x": {}, "y": {}, "element": "{element}"}}}}"#, lines(x), lines(y))
}

/// A scene of this body.
fn of_body(model: &str, body: &str, rest: &str) -> Scene {
    scene(&format!(r#"{{"model": "{model}", {MATERIAL}, "body": {body}, {rest}}}"#))
}

/// A rectangle from 1 to 2 and from 0 to 1, with its bottom held.
fn plane(model: &str, element: &str, rest: &str) -> Scene {
    let held = r#""supports": [{"on": {"boundary": "bottom"}, "x": 0.02, "y": -0.01}]"#;
    of_body(model, &rectangle(element, [([1.0, 2.0], 2), ([0.0, 1.0], 2)]), &format!("{held}, {rest}"))
}

/// A box from -0.5 to 0.5 along x and y and from 0 to 1 along z, with its bottom held.
fn space(element: &str, rest: &str) -> Scene {
    space_in(2, element, rest)
}

/// The same in so many parts along x and y.
fn space_in(parts: usize, element: &str, rest: &str) -> Scene {
    let across = format!(r#"{{"points": [-0.5, 0.5], "divisions": [{parts}]}}"#);
    let z = r#"{"points": [0, 1], "divisions": [1]}"#;
    let body = format!(r#"{{"box": {{"x": {across}, "y": {across}, "z": {z}, "element": "{element}"}}}}"#);
    let held = r#""supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0.01, "z": 0}]"#;
    of_body("space", &body, &format!("{held}, {rest}"))
}

/// A square with its left side on a plane of symmetry, on rollers, in so many columns.
fn half(columns: usize, shape: &str) -> Scene {
    let rest = format!(
        r#""symmetry": ["x"], "supports": [{{"on": {{"boundary": "bottom"}}, "y": 0}}], {}"#,
        obstacle("+y", "approach", shape)
    );
    of_body("plane-strain", &rectangle("q4", [([0.0, 1.0], columns), ([0.0, 1.0], 1)]), &rest)
}

fn obstacle(approach: &str, rule: &str, shape: &str) -> String {
    format!(
        r#""obstacles": [{{"boundary": "top", "approach": "{approach}", "rule": "{rule}", "gap": 0.01, "shape": {shape}}}]"#
    )
}

#[test]
fn the_residual_changes_as_differences_say_for_every_load_and_spring_in_the_plane() {
    let profile = r#""profile": {"along": [1, 0.2], "places": [0.5, 1.3, 1.8], "factors": [0.5, 1, -1]}"#;
    let loads = [
        r#"{"traction": {"boundary": "right", "value": [0.3, 0.2]}}"#.to_string(),
        format!(r#"{{"traction": {{"boundary": "top", "value": [0.3, 0.2], {profile}}}}}"#),
        r#"{"pressure": {"boundary": "right", "value": 0.4}}"#.into(),
        format!(r#"{{"pressure": {{"boundary": "top", "value": 0.4, {profile}}}}}"#),
        r#"{"force": {"boundary": "right", "value": [0.3, 0.2]}}"#.into(),
        r#"{"body-force": [0.3, 0.2]}"#.into(),
        r#"{"gravity": [0.3, 0.2]}"#.into(),
        r#"{"centrifugal": {"omega": 0.7}}"#.into(),
        r#"{"moment": {"boundary": "right", "value": [0.6]}}"#.into(),
    ];
    for model in ["plane-strain", "plane-stress", "axisymmetric"] {
        for load in loads.iter().filter(|load| model != "axisymmetric" || !load.contains("moment")) {
            // Edges with a profile are straight, so that pieces between kinks are exact.
            let element = if load.contains("profile") { "t3" } else { "q8" };
            Moving::of(&plane(model, element, &format!(r#""loads": [{load}]"#)), |_| true).check(0);
        }
        let springs = r#""springs": [{"on": {"boundary": "right"}, "x": 0.4, "normal": 0.7},
            {"on": {"boundary": "top"}, "y": 0.5, "normal": 0.3, "stiffness": "per-area"}]"#;
        Moving::of(&plane(model, "q8", springs), |_| true).check(0);
    }
}

#[test]
fn the_residual_changes_as_differences_say_for_loads_springs_and_stresses_in_space() {
    let rest = r#""loads": [{"pressure": {"boundary": "right", "value": 0.4}}, {"moment": {"boundary": "back", "value": [0.6, -0.3, 0.4]}},
            {"force": {"boundary": "left", "value": [0.3, 0.2, 0.1]}},
            {"centrifugal": {"omega": 0.7, "axis": [1, 2, -1], "point": [0.3, 0.1, 0.2]}}],
        "springs": [{"on": {"boundary": "front"}, "x": 0.4, "normal": 0.7}],
        "temperature": [{"value": 0.5, "gradient": [0.3, 0.2, 0.1]}], "initial-stress": [{"xx": 0.2, "yz": 0.1}]"#;
    Moving::of(&space("hex8", rest), |_| true).check(0);
    Moving::of(&space("tet4", rest), |_| true).check(0);
}

/// With temperatures and initial stresses.
#[test]
fn the_strain_energy_changes_as_differences_say() {
    let warm = r#""temperature": [{"value": 0.5, "gradient": [0.3, 0.2]}], "initial-stress": [{"xx": 0.2, "xy": 0.1}]"#;
    for (model, element) in [("plane-strain", "q8"), ("plane-stress", "q4"), ("axisymmetric", "t6")] {
        let shape = obstacle("+y", "closest-point", r#"{"parabola": {"apex": [1.4, 1.1], "radius": 1.5}}"#);
        let scene = plane(model, element, &format!("{warm}, {shape}"));
        Moving::of(&scene, |_| true).check_output("strain-energy", 0..2, 0);
    }
    let shape = obstacle("+z", "closest-point", r#"{"sphere": {"apex": [0.1, 0, 1.1], "radius": 1.5}}"#);
    let warm = r#""temperature": [{"value": 0.5, "gradient": [0.3, 0.2, 0.1]}]"#;
    Moving::of(&space("hex8", &format!("{warm}, {shape}")), |_| true).check_output("strain-energy", 0..2, 0);
}

#[test]
fn rows_against_rigid_obstacles_in_the_plane_change_as_differences_say() {
    let shapes = [
        r#"{"plane": {"point": [1.5, 1.1], "normal": [0.3, 1]}}"#,
        r#"{"circle": {"apex": [1.4, 1.1], "radius": 1.5}}"#,
        r#"{"circle": {"centre": [1.4, 0.3], "radius": 1.6, "side": "inside"}}"#,
        r#"{"parabola": {"apex": [1.4, 1.1], "radius": 1.5}}"#,
        r#"{"wedge": {"apex": [1.3, 1.1], "slope": 0.4}}"#,
        r#"{"table": {"points": [[0, 1.2], [1.3, 1.1], [3, 1.4]]}}"#,
    ];
    for shape in shapes {
        for rule in ["approach", "closest-point"] {
            for model in ["plane-strain", "axisymmetric"] {
                let scene = plane(model, "q4", &obstacle("+y", rule, shape));
                Moving::of(&scene, |_| true).check_with_areas();
            }
            Moving::of(&plane("plane-strain", "t6", &obstacle("+y", rule, shape)), |_| true).check_areas();
        }
    }
}

#[test]
fn rows_against_rigid_obstacles_in_space_change_as_differences_say() {
    let shapes = [
        r#"{"plane": {"point": [0, 0, 1.1], "normal": [0.3, -0.2, 1]}}"#,
        r#"{"sphere": {"apex": [0.1, 0.05, 1.1], "radius": 1.5}}"#,
        r#"{"cone": {"apex": [0.1, 0.15, 1.1], "slope": 0.3}}"#,
        r#"{"cylinder": {"apex": [0.1, 0.05, 1.1], "axis": [1, 0.3, 0], "radius": 1.5}}"#,
        r#"{"torus": {"centre": [0.1, 0.05, 2.1], "axis": [0, 0, 1], "major": 1.2, "minor": 1}}"#,
    ];
    for shape in shapes {
        for rule in ["approach", "closest-point"] {
            let scene = space("hex8", &obstacle("+z", rule, shape));
            Moving::of(&scene, |_| true).check_with_areas();
        }
    }
}

#[test]
fn widths_change_as_differences_say() {
    let curved = r#"{"circle": {"apex": [1.4, 1.1], "radius": 1.5}}"#;
    // Straight edges; quadratic ones, of which a half is covered; the whole of a boundary.
    for (element, closed) in [("q4", 0..2), ("q4", 0..1), ("q8", 1..4), ("t6", 0..2), ("q8", 0..5)] {
        for (model, rule) in
            [("plane-strain", "approach"), ("plane-stress", "closest-point"), ("axisymmetric", "approach")]
        {
            let scene = plane(model, element, &obstacle("+y", rule, curved));
            Moving::of(&scene, |_| true).check_output("width", closed.clone(), 0);
        }
    }
    let symmetric = half(4, r#"{"circle": {"apex": [0, 1.1], "radius": 1.5}}"#);
    for closed in [0..1, 0..2, 0..3] {
        Moving::of(&symmetric, |at| at[0] > 0.0).check_output("width", closed, 2);
    }
}

#[test]
fn moments_change_as_differences_say() {
    for rule in ["approach", "closest-point"] {
        for element in ["q4", "t6"] {
            let circle = r#"{"circle": {"apex": [1.4, 1.1], "radius": 1.5}}"#;
            let scene = plane("plane-strain", element, &obstacle("+y", rule, circle));
            Moving::of(&scene, |_| true).check_output("obstacles[0].moment", 0..3, 0);
        }
        for element in ["hex8", "hex20"] {
            let sphere = r#"{"sphere": {"apex": [0.1, 0.05, 1.1], "radius": 2}}"#;
            let scene = space(element, &obstacle("+z", rule, sphere));
            Moving::of(&scene, |_| true).check_output("obstacles[0].moment[1]", 0..5, 0);
        }
    }
}

/// The sphere does not reach all nodes of the quadratic faces.
#[test]
fn rows_of_coefficients_change_as_differences_say() {
    for (rule, radius) in [("approach", 0.55), ("approach", 2.0), ("closest-point", 2.0)] {
        let shape = format!(r#"{{"sphere": {{"apex": [0.1, 0.05, 1.1], "radius": {radius}}}}}"#);
        Moving::of(&space_in(1, "hex20", &obstacle("+z", rule, &shape)), |_| true).check_with_areas();
    }
}

#[test]
fn obstacles_under_a_force_inclined_supports_and_planes_of_symmetry_take_part() {
    let rest = r#""symmetry": ["x"],
        "supports": [{"on": {"boundary": "bottom"}, "normal": [0.0, -1]},
            {"on": {"boundary": "right"}, "normal": [1, 0.4], "value": 0.03}],
        "obstacles": [{"boundary": "top", "approach": "+y", "rule": "closest-point", "force": 2,
            "shape": {"circle": {"apex": [0, 1.1], "radius": 1.5}}}]"#;
    let pressed = of_body("plane-strain", &rectangle("q4", [([0.0, 1.0], 2); 2]), rest);
    // The plane of symmetry stays flat; its three nodes move along it.
    Moving::of(&pressed, |at| at[0] > 0.0).check(3);
}

#[test]
fn nodes_on_an_axis_of_revolution_change_as_differences_say_where_they_can_move() {
    for rule in ["approach", "closest-point"] {
        let rest = format!(
            r#""supports": [{{"on": {{"boundary": "bottom"}}, "y": 0}}],
                "loads": [{{"pressure": {{"boundary": "top", "value": 0.3}}}}, {{"traction": {{"boundary": "left", "value": [0.2, 0.1]}}}}],
                {}"#,
            obstacle("+y", rule, r#"{"circle": {"apex": [0, 1.1], "radius": 1.5}}"#)
        );
        let scene = of_body("axisymmetric", &rectangle("t6", [([0.0, 1.0], 2); 2]), &rest);
        // Five nodes on the axis move along it.
        Moving::of(&scene, |at| at[0] > 0.0).check(5);
    }
}

#[test]
fn bars_and_equations_between_nodes_take_part() {
    let bar = scene(&format!(
        r#"{{"model": "bar", {MATERIAL}, "body": {{"bar": {{"x": {{"points": [0, 2], "divisions": [4]}}, "area": 0.3}}}},
            "supports": [{{"on": {{"boundary": "left"}}, "x": 0.01}}], "temperature": [{{"value": 0.5, "gradient": [0.3]}}],
            "loads": [{{"body-force": [0.3]}}, {{"traction": {{"boundary": "right", "value": [0.2]}}}}],
            "obstacles": [{{"boundary": "right", "approach": "+x", "shape": {{"plane": {{"point": [2.1], "normal": [1]}}}}}}]}}"#
    ));
    Moving::of(&bar, |_| true).check(0);
    let terms = r#"[{"on": {"point": [1, 1]}, "x": 1}, {"on": {"point": [2, 0.5]}, "y": -0.5}]"#;
    let tied = plane("plane-strain", "q4", &format!(r#""ties": [{{"equation": {{"terms": {terms}, "value": 0.1}}}}]"#));
    // The places of both nodes name them.
    Moving::of(&tied, |_| false).check(4);
}

/// A bar of matching blocks; all rows lie along the approach direction.
#[test]
fn pairs_of_nodes_along_a_direction_change_as_differences_say() {
    let block = |low: f64, high: f64| rectangle("q4", [([0.0, 1.0], 2), ([low, high], 1)]);
    let of = |rule: &str, fit: &str| {
        let rest = format!(
            r#""further-bodies": [{{"name": "upper", "body": {}, {MATERIAL}}}],
                "supports": [{{"on": {{"boundary": "bottom"}}, "x": 0, "y": 0}}, {{"on": {{"boundary": "upper.top"}}, "x": 0, "y": 0.1}}],
                "obstacles": [{{"boundary": "top", "approach": "+y", "rule": "{rule}",
                    "shape": {{"body": {{"boundary": "upper.bottom", "rows": "pairs" {fit}}}}}}}]"#,
            block(1.01, 2.0)
        );
        of_body("plane-strain", &block(0.0, 1.0), &rest)
    };
    for fit in ["", r#", "fit": {"interference": 0.02}"#] {
        let scene = of("approach", fit);
        // Nodes that face each other do not leave their pairs.
        Moving::of(&scene, |at| at[1] < 0.5 || at[1] > 1.5).check_with_areas();
    }
    let closest = of("closest-point", "");
    assert!(reason(&closest).contains("along the normals of both"), "{}", reason(&closest));
}

/// Why a scene has no derivative.
fn reason(scene: &Scene) -> String {
    let (answer, adjoint, forces) = Moving::of(scene, |_| false).answer();
    by_places(scene, &Pairing { answer: &answer, adjoint: &adjoint, forces: &forces }).unwrap_err()
}

#[test]
fn a_corner_of_an_obstacle_is_refused_unless_its_row_takes_no_part() {
    // The middle node of the top lies below the corner; one that points at the node is its closest point, and smooth.
    let pointing = r#"{"table": {"points": [[0, 1.2], [1.5, 1.1], [3, 1.4]]}}"#;
    let hollow = r#"{"table": {"points": [[0, 1.2], [1.5, 1.4], [3, 1.2]]}}"#;
    for (rule, shape) in [("approach", pointing), ("approach", hollow), ("closest-point", hollow)] {
        let scene = plane("plane-strain", "q4", &obstacle("+y", rule, shape));
        let moving = Moving::of(&scene, |_| false);
        let (answer, adjoint, mut forces) = moving.answer();
        let of = |answer: &Answer, forces: &[f64]| by_places(&scene, &Pairing { answer, adjoint: &adjoint, forces });
        let reason = of(&answer, &forces).unwrap_err();
        assert!(reason.starts_with("node 7 at (1.5, 1) meets a corner"), "{reason}");
        let mut multiplier = answer.multiplier().to_vec();
        (multiplier[1], forces[1]) = (0.0, 0.0);
        let unknowns = random(adjoint.len(), 1);
        let open = Answer::new(answer.model().clone(), &unknowns, &multiplier, answer.contact_set()).unwrap();
        assert!(of(&open, &forces).is_ok());
    }
}

#[test]
fn a_corner_on_a_plane_of_symmetry_counts_as_level() {
    let scene = half(2, r#"{"wedge": {"apex": [0, 1.1], "slope": 0.4}}"#);
    let (answer, adjoint, mut forces) = Moving::of(&scene, |_| false).answer();
    forces[1..].fill(0.0);
    let of = |forces: &[f64]| by_places(&scene, &Pairing { answer: &answer, adjoint: &adjoint, forces }).unwrap();
    let (whole, without) = (of(&forces), of(&[0.0; 3]));
    // Node 3 carries the first row: its gap changes by -1 along y and by nothing along x.
    assert!((whole[6] - without[6]).abs() < 1e-12, "{} {}", whole[6], without[6]);
    assert!((whole[7] - without[7] - forces[0]).abs() < 1e-12, "{} {}", whole[7], without[7]);
}

/// A surface of a user: h = 1.1 + 0.2 x^2, with rows along y.
#[derive(Debug)]
struct Bowl;

impl Obstacle for Bowl {
    fn approach(&self) -> [f64; 3] {
        [0.0, 1.0, 0.0]
    }

    fn row(&self, [x, y, _]: [f64; 3]) -> Result<Option<ObstacleRow>, String> {
        Ok(Some(ObstacleRow { normal: self.approach(), gap: 1.1 + 0.2 * x * x - y }))
    }
}

#[test]
fn an_obstacle_of_a_user_takes_part() {
    let scene = plane("plane-stress", "q4", r#""gap": -0.02"#);
    let mut moving = Moving::of(&scene, |_| true);
    moving.further.push(("top", Arc::new(Bowl)));
    moving.check_with_areas();
}

#[test]
fn what_has_no_derivative_yet_is_refused_with_one_sentence() {
    let profile = r#""supports": [{"on": {"boundary": "top"}, "x": 0.1,
        "profile": {"along": [1, 0], "places": [1, 2], "factors": [0, 1]}}]"#;
    let held = |rest: &str| of_body("plane-strain", &rectangle("q4", [([1.0, 2.0], 2), ([0.0, 1.0], 2)]), rest);
    let bottom = r#""supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]"#;
    let faces = format!(r#"{bottom}, "rigid-faces": [{{"boundary": "top", "force": [1, 0]}}]"#);
    let around = held(bottom);
    let with_profile = profile.replace("}}]", r#"}}, {"on": {"boundary": "bottom"}, "x": 0, "y": 0}]"#);
    assert!(reason(&held(&with_profile)).contains("with a profile"));
    assert!(reason(&held(&faces)).contains("rigid faces"));
    let [lower, upper] =
        [(0.0, 2), (1.0, 3)].map(|(low, parts)| rectangle("q4", [([0.0, 1.0], parts), ([low, low + 1.0], 1)]));
    let further = format!(r#""further-bodies": [{{"name": "upper", {MATERIAL}, "body": {upper}}}]"#);
    let ties = r#""ties": [{"surfaces": {"boundary": "top", "to": "upper.bottom"}}]"#;
    let tied = of_body("plane-strain", &lower, &format!("{further}, {bottom}, {ties}"));
    assert!(reason(&tied).contains("ties of surfaces"));
    let mut mortar = tied.clone();
    mortar.ties.clear();
    let obstacle = serde_json::from_str(
        r#"{"boundary": "top", "approach": "+y", "shape": {"body": {"boundary": "upper.bottom"}}}"#,
    );
    mortar.obstacles.push(obstacle.unwrap());
    mortar.supports.push(serde_json::from_str(r#"{"on": {"boundary": "upper.top"}, "x": 0}"#).unwrap());
    assert!(reason(&mortar).contains("do not match"), "{}", reason(&mortar));
    let model = mortar.build().unwrap();
    assert!(areas_by_places(&model, &vec![1.0; model.rows().len()]).unwrap_err().contains("do not match"));
    let turning = r#"{"orthotropic": {"young": [3, 1, 2],
        "poisson": [0.2, 0.3, 0.1], "shear": [0.6, 0.5, 0.4], "around": {"point": [0, 0]}}}"#;
    let around = Scene { material: Some(serde_json::from_str(turning).unwrap()), ..around };
    assert!(reason(&around).contains("turn around a line"));
}

//! GOAL: a body rotated together with its rollers, loads and obstacle has the rotated answer: on meshes from files,
//! compared with the original body and with closed forms; and the files that the program writes for it.

use std::fmt::Write;
use support::bodies::largest;

use serde_json::{Value, json};
use signorini::fem::{ElementKind, Mesh};
use signorini::qp::read_vector;
use signorini::scene::{cuboid, rectangle};
use signorini::{Model, Scene, Solution, solve_qp};
use support::closed_forms::{Bar, ContactPatch, Sides};
use support::program::Desk;

/// Rounding times the condition number of the stiffness, below 1e4 here.
const CLOSED_FORM: f64 = 1e-11;

/// Relative rounding of a displacement along rotated axes.
const ROUNDING: f64 = 1e-14;

/// A rotation: the images of the coordinate axes.
type Turn = [[f64; 3]; 3];

const STRAIGHT: Turn = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn in_plane(degrees: f64) -> Turn {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]]
}

/// A rotation about x by 0.5, then about z by 0.7: all three axes are inclined, z least.
fn leaning() -> Turn {
    let (about_x, about_z) = ((0.5_f64).sin_cos(), (0.7_f64).sin_cos());
    let turn = |[x, y, z]: [f64; 3]| {
        let (y, z) = (about_x.1 * y - about_x.0 * z, about_x.0 * y + about_x.1 * z);
        [about_z.1 * x - about_z.0 * y, about_z.0 * x + about_z.1 * y, z]
    };
    STRAIGHT.map(turn)
}

fn apply(turn: &Turn, vector: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|axis| vector.iter().zip(turn).map(|(part, image)| part * image[axis]).sum())
}

/// The rotated mesh as a Gmsh file of version 2.2, with its boundaries as physical groups.
fn gmsh(mesh: &Mesh, turn: &Turn) -> String {
    let (body, side) = match mesh.kind_of(0) {
        ElementKind::T3 => (2, 1),
        ElementKind::Q4 => (3, 1),
        ElementKind::Q8 => (16, 8),
        ElementKind::Hex8 => (5, 3),
        ElementKind::Tet4 => (4, 2),
        other => panic!("{other:?}"),
    };
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    writeln!(text, "{}", mesh.boundaries().len() + 1).unwrap();
    for (index, boundary) in mesh.boundaries().iter().enumerate() {
        writeln!(text, "{} {} \"{}\"", mesh.dimension() - 1, index + 1, boundary.name).unwrap();
    }
    writeln!(text, "{} 100 \"body\"\n$EndPhysicalNames\n$Nodes\n{}", mesh.dimension(), mesh.nodes().len()).unwrap();
    for (index, node) in mesh.nodes().iter().enumerate() {
        let [x, y, z] = apply(turn, node);
        writeln!(text, "{} {x} {y} {z}", index + 1).unwrap();
    }
    let mut elements: Vec<(usize, usize, Vec<usize>)> = Vec::new();
    for (index, boundary) in mesh.boundaries().iter().enumerate() {
        elements.extend(boundary.facets().map(|facet| (side, index + 1, facet.to_vec())));
    }
    elements.extend(mesh.elements().map(|nodes| (body, 100, nodes.to_vec())));
    writeln!(text, "$EndNodes\n$Elements\n{}", elements.len()).unwrap();
    for (index, (kind, group, nodes)) in elements.iter().enumerate() {
        let nodes: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
        writeln!(text, "{} {kind} 2 {group} 1 {}", index + 1, nodes.join(" ")).unwrap();
    }
    text + "$EndElements\n"
}

/// A unit square or cube of 4 cells along each side; in the plane 2 long.
fn mesh(kind: ElementKind) -> Mesh {
    let lines = |size: f64| (0..=4).map(|i| size * f64::from(i) / 4.0).collect::<Vec<f64>>();
    match kind {
        ElementKind::Hex8 | ElementKind::Tet4 => cuboid(&lines(1.0), &lines(1.0), &lines(1.0), kind).unwrap(),
        _ => rectangle(&lines(2.0), &lines(1.0), kind).unwrap(),
    }
}

/// A body on rollers at the sides `rollers` (side, outward normal, value), with everything rotated by `turn`.
struct Turned {
    model: &'static str,
    kind: ElementKind,
    turn: Turn,
    rollers: Vec<(&'static str, Vec<f64>, f64)>,
    poisson: f64,
}

impl Turned {
    /// A vector of the original scene in the rotated scene.
    fn vector(&self, straight: &[f64]) -> Value {
        json!(apply(&self.turn, straight)[..straight.len()])
    }

    fn scene(&self, loads: Value, obstacles: Value) -> Value {
        let roller = |(side, normal, value): &(&str, Vec<f64>, f64)| json!({"on": {"boundary": side}, "normal": self.vector(normal), "value": value});
        json!({
            "title": "Turned", "model": self.model, "body": {"gmsh": {"file": "body.msh"}},
            "material": {"young": 1000, "poisson": self.poisson},
            "supports": self.rollers.iter().map(roller).collect::<Vec<Value>>(),
            "loads": loads, "obstacles": obstacles,
        })
    }

    /// Writes mesh and scene into a temporary folder.
    fn write(&self, desk: &Desk, scene: &Value) {
        desk.write("body.msh", gmsh(&mesh(self.kind), &self.turn));
        desk.write("scene.json", scene.to_string());
    }

    fn solved(&self, loads: Value, obstacles: Value) -> (Model, Solution) {
        let desk = Desk::new();
        self.write(&desk, &self.scene(loads, obstacles));
        let model = Scene::read(desk.path("scene.json")).unwrap().build().unwrap();
        let solution = solve_qp(model.problem()).unwrap();
        let balance = model.force_balance(&solution.displacement, &solution.multiplier).unwrap();
        assert!(balance < 1e-12, "balance {balance:e}");
        (model, solution)
    }
}

/// Compares nodal vectors of the rotated body with those of the original body.
#[track_caller]
fn compare(turn: &Turn, dimension: usize, straight: &[f64], turned: &[f64], what: &str) {
    assert_eq!(straight.len(), turned.len());
    let scale = largest(straight);
    assert!(scale > 0.0, "{what}");
    for (before, after) in straight.chunks(dimension).zip(turned.chunks(dimension)) {
        for (expected, found) in apply(turn, before).iter().zip(after) {
            assert!((expected - found).abs() < CLOSED_FORM * scale, "{what}: {found:e}, expected {expected:e}");
        }
    }
}

/// Solves a scene in the original position and rotated, and compares all results.
fn turns_along(straight: &Turned, turn: Turn, scene: &dyn Fn(&Turned) -> (Value, Value)) {
    let (loads, obstacles) = scene(straight);
    let (model, solution) = straight.solved(loads, obstacles);
    let turned = Turned { turn, rollers: straight.rollers.clone(), ..*straight };
    let (loads, obstacles) = scene(&turned);
    let (other, answer) = turned.solved(loads, obstacles);
    assert!(solution.contact_force() > 0.1, "{}", solution.contact_force());
    assert_eq!(solution.contact_set, answer.contact_set, "the contact sets differ");
    let dimension = model.mesh().dimension();
    let nodal = |model: &Model, solution: &Solution| model.nodal_displacement(&solution.displacement).unwrap();
    compare(&turn, dimension, &nodal(&model, &solution), &nodal(&other, &answer), "displacement");
    let reactions = |model: &Model, u: &Solution| model.reactions(&u.displacement, &u.multiplier).unwrap();
    compare(&turn, dimension, &reactions(&model, &solution), &reactions(&other, &answer), "reactions");
    for (a, b) in solution.multiplier.iter().zip(&answer.multiplier) {
        assert!((a - b).abs() < CLOSED_FORM * largest(&solution.multiplier), "multiplier {a:e} {b:e}");
    }
    let stress = |model: &Model, u: &Solution| model.stress(&u.displacement).unwrap();
    let (before, after) = (stress(&model, &solution), stress(&other, &answer));
    let scale = before.elements.iter().fold(0.0_f64, |scale, stress| scale.max(stress.von_mises));
    for (a, b) in before.elements.iter().chain(&before.nodes).zip(after.elements.iter().chain(&after.nodes)) {
        let off =
            (a.sigma_1 - b.sigma_1).abs().max((a.sigma_2 - b.sigma_2).abs()).max((a.von_mises - b.von_mises).abs());
        assert!(off < CLOSED_FORM * scale, "the stress differs by {off:e} of {scale:e}");
    }
}

#[test]
fn a_rotated_block_on_rollers_under_a_circle_has_the_rotated_answer() {
    for kind in [ElementKind::T3, ElementKind::Q4, ElementKind::Q8] {
        let rollers = vec![("bottom", vec![0.0, -1.0], 0.002), ("left", vec![-1.0, 0.0], -0.001)];
        let block = Turned { model: "plane-strain", kind, turn: STRAIGHT, rollers, poisson: 0.3 };
        for degrees in [30.0, -17.0, 60.0] {
            turns_along(&block, in_plane(degrees), &|block| {
                let loads = json!([
                    {"traction": {"boundary": "right", "value": block.vector(&[3.0, 1.0])}},
                    {"body-force": block.vector(&[0.5, -2.0])},
                ]);
                let circle = json!({"centre": block.vector(&[0.9, 2.98]), "radius": 2});
                let obstacle = json!({"boundary": "top", "approach": "+y", "rule": "closest-point",
                                      "shape": {"circle": circle}});
                (loads, json!([obstacle]))
            });
        }
    }
}

#[test]
fn a_rotated_box_on_rollers_under_a_sphere_has_the_rotated_answer() {
    // Edges of the box have two normals, one corner has three, all at right angles up to rounding.
    for kind in [ElementKind::Hex8, ElementKind::Tet4] {
        let rollers = vec![
            ("bottom", vec![0.0, 0.0, -1.0], 0.0),
            ("left", vec![-1.0, 0.0, 0.0], -0.001),
            ("front", vec![0.0, -1.0, 0.0], 0.0),
        ];
        let block = Turned { model: "space", kind, turn: STRAIGHT, rollers, poisson: 0.3 };
        turns_along(&block, leaning(), &|block| {
            let loads = json!([{"traction": {"boundary": "right", "value": block.vector(&[3.0, 1.0, -1.0])}}]);
            let sphere = json!({"centre": block.vector(&[0.4, 0.55, 2.95]), "radius": 2});
            let obstacle = json!({"boundary": "top", "approach": "+z", "rule": "closest-point",
                                  "shape": {"sphere": sphere}});
            (loads, json!([obstacle]))
        });
    }
}

/// GOAL: the contact patch test in rotated axes.
/// CONDITIONS: a block turned by 25 degrees, on rollers and a plane that are turned with it; plane strain and plane
/// stress.
/// REFERENCE: `closed_forms::ContactPatch`, rotated.
#[test]
fn uniform_pressure_on_an_inclined_plane_is_exact_on_inclined_rollers() {
    let (p, turn) = (3.0, in_plane(25.0));
    for (model, sides) in [("plane-strain", Sides::PlaneStrain), ("plane-stress", Sides::PlaneStress)] {
        for kind in [ElementKind::T3, ElementKind::Q4] {
            let rollers = vec![("left", vec![-1.0, 0.0], 0.0)];
            let block = Turned { model, kind, turn, rollers, poisson: 0.3 };
            let plane = json!({"point": [0, 0], "normal": block.vector(&[0.0, -1.0])});
            let (model, solution) = block.solved(
                json!([{"pressure": {"boundary": "top", "value": p}}]),
                json!([{"boundary": "bottom", "approach": "-y", "rule": "closest-point", "shape": {"plane": plane}}]),
            );
            for pressure in model.pressure(&solution.multiplier).unwrap() {
                assert!((pressure - p).abs() < CLOSED_FORM * p, "{pressure}");
            }
            let (across, along) = ContactPatch { young: 1000.0, poisson: 0.3, sides }.strains(p);
            let straight: Vec<f64> = mesh(kind).nodes().iter().flat_map(|[x, y, _]| [across * x, along * y]).collect();
            compare(&turn, 2, &straight, &model.nodal_displacement(&solution.displacement).unwrap(), "displacement");
            for stress in model.stress(&solution.displacement).unwrap().nodes {
                assert!((stress.sigma_2 + p).abs() < CLOSED_FORM * p && stress.sigma_1.abs() < CLOSED_FORM * p);
            }
            // The rollers carry no force here.
            let reactions = model.reactions(&solution.displacement, &solution.multiplier).unwrap();
            assert!(largest(&reactions) < CLOSED_FORM * p, "{:e}", largest(&reactions));
        }
    }
}

/// GOAL: an inclined bar against a wall.
/// CONDITIONS: a strip with nu = 0 on rollers, turned by 40 degrees; gaps that close and stay open; rollers that push
/// its end.
/// REFERENCE: `closed_forms::Bar`, rotated.
#[test]
fn an_inclined_bar_on_rollers_agrees_with_the_closed_form() {
    // Without lateral contraction a strip on rollers is a bar: length 2, cross-section 1, EA = 1000.
    let turn = in_plane(40.0);
    for (gap, moved) in [(0.006, 0.0), (0.05, 0.0), (0.006, 0.001)] {
        // The rollers of its left end push the bar by `moved` along its axis.
        let rollers = vec![("left", vec![-1.0, 0.0], -moved), ("bottom", vec![0.0, -1.0], 0.0)];
        let bar = Turned { model: "plane-stress", kind: ElementKind::Q4, turn, rollers, poisson: 0.0 };
        let wall = json!({"point": bar.vector(&[2.0 + gap, 0.0]), "normal": bar.vector(&[1.0, 0.0])});
        let (model, solution) = bar.solved(
            json!([{"traction": {"boundary": "right", "value": bar.vector(&[4.0, 0.0])}}]),
            json!([{"boundary": "right", "approach": "+x", "rule": "closest-point", "shape": {"plane": wall}}]),
        );
        let closed = Bar { length: 2.0, axial_stiffness: 1000.0, gap: gap - moved };
        assert!((solution.contact_force() - closed.reaction_to_end_force(4.0)).abs() < CLOSED_FORM * 4.0);
        let of = |x: f64| moved + closed.displacement_under_end_force(4.0, x);
        let straight: Vec<f64> = mesh(bar.kind).nodes().iter().flat_map(|&[x, ..]| [of(x), 0.0]).collect();
        compare(&turn, 2, &straight, &model.nodal_displacement(&solution.displacement).unwrap(), "displacement");
        // The rollers of the held end carry the rest of the load, along their normal.
        let reactions = model.reactions(&solution.displacement, &solution.multiplier).unwrap();
        let held = model.mesh().boundary("left").unwrap().nodes();
        let sum = |axis: usize| held.iter().map(|&node| reactions[2 * node + axis]).sum::<f64>();
        let force = 4.0 - closed.reaction_to_end_force(4.0);
        let expected = apply(&turn, &[-force, 0.0]);
        assert!((sum(0) - expected[0]).abs() < CLOSED_FORM * 4.0 && (sum(1) - expected[1]).abs() < CLOSED_FORM * 4.0);
    }
}

/// A rotated block under a circle, in files.
fn desk() -> Desk {
    let desk = Desk::new();
    let rollers = vec![("bottom", vec![0.0, -1.0], 0.002), ("left", vec![-1.0, 0.0], 0.0)];
    let turn = in_plane(30.0);
    let block = Turned { model: "plane-strain", kind: ElementKind::Q4, turn, rollers, poisson: 0.3 };
    let circle = json!({"centre": block.vector(&[0.9, 2.9]), "radius": 2});
    let obstacle = json!({"boundary": "top", "approach": "+y", "rule": "closest-point", "shape": {"circle": circle}});
    block.write(&desk, &block.scene(json!([]), json!([obstacle])));
    desk
}

#[test]
fn fields_for_paraview_contain_the_displacement_along_the_coordinate_axes() {
    let desk = desk();
    desk.run(&["solve", "scene.json", "--out", "out"]).ends_with(0);
    let files: Vec<_> = std::fs::read_dir(desk.path("out")).unwrap().map(|entry| entry.unwrap().path()).collect();
    let vtu = files.iter().find(|path| path.extension().is_some_and(|extension| extension == "vtu")).unwrap();
    let text = std::fs::read_to_string(vtu).unwrap();
    let data = text.split("Name=\"u\"").nth(1).unwrap().split_once('>').unwrap().1.split_once('<').unwrap().0;
    let written: Vec<f64> = data.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let model = Scene::read(desk.path("scene.json")).unwrap().build().unwrap();
    let free = read_vector(&desk.path("out/u.mtx")).unwrap();
    let nodal = model.nodal_displacement(&free).unwrap();
    let in_space: Vec<f64> = nodal.chunks(2).flat_map(|u| [u[0], u[1], 0.0]).collect();
    assert_eq!(written, in_space);
    // The rollers of the bottom move it by 0.002 along its rotated normal.
    let normal = apply(&in_plane(30.0), &[0.0, -1.0]);
    for node in model.mesh().boundary("bottom").unwrap().nodes() {
        let along = normal[0] * written[3 * node] + normal[1] * written[3 * node + 1];
        assert!((along - 0.002).abs() < ROUNDING * 0.002, "{along}");
    }
    assert!(desk.path("out/contact.png").exists());
}

#[test]
fn an_exported_problem_with_inclined_supports_is_solved_and_verified() {
    let desk = desk();
    desk.run(&["export", "scene.json", "p"]).ends_with(0);
    let of_scene = desk.run(&["compare", "scene.json", "--format", "json"]).ends_with(0).json();
    let of_files = desk.run(&["solve", "p", "--out", "p", "--format", "json"]).ends_with(0).json();
    assert_eq!(of_scene["methods"][0]["contact"]["force"], of_files["contact"]["force"]);
    let arguments = ["verify", "p", "--displacement", "p/u.mtx", "--multiplier", "p/lambda.mtx"];
    assert!(desk.run(&arguments).ends_with(0).stdout.contains("certified to 1.0e-9"));
}

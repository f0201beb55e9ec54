//! GOAL: two surfaces are a contact only if nothing solid lies between them, whether a scene finds its contacts, names
//! whole skins, or ties them.
//! REFERENCE: the same surfaces named one by one; forces that statics decides.

use serde_json::{Value, json};
use signorini::Model;
use signorini::scene::Answer;
use support::decks::Block;
use support::draws::Draws;
use support::scenes::{answer, build};
use support::{cases, seed};

use super::decks;

/// Two solves of one contact problem from rows that differ by rounding, and forces that statics decides, relative.
const SAME: f64 = 1e-9;

/// How far neighbours overlap, or stand apart, at most a tenth of the thinnest body.
const OVERLAP: f64 = 1e-4;

/// A point is inside a box if it is farther from its sides than this.
const INSIDE: f64 = 1e-6;

fn steel() -> Value {
    json!({"young": 210_000, "poisson": 0.3})
}

/// A rectangle or a box of cells of one kind, by its limits along each axis.
fn block(limits: &[[f64; 2]], cells: &[usize], element: &str) -> Value {
    let mut own = json!({"element": element});
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate().take(limits.len()) {
        own[name] = json!({"points": limits[axis], "divisions": [cells[axis]]});
    }
    if limits.len() == 2 { json!({"rectangle": own}) } else { json!({"box": own}) }
}

fn further(name: &str, body: Value) -> Value {
    json!({"name": name, "body": body, "material": steel()})
}

/// The same scene with a contact between two named boundaries.
fn named(scene: &Value, own: &str, other: &str) -> Value {
    let mut scene = scene.clone();
    scene.as_object_mut().unwrap().remove("contact");
    scene["obstacles"] = json!([{"boundary": own, "rule": "closest-point", "shape": {"body": {"boundary": other}}}]);
    scene
}

/// The same scene with a contact between the whole skins of two bodies.
fn skins(scene: &Value, other: &str) -> Value {
    let mut scene = named(scene, "skin", "skin-of-other");
    scene["parts"] = json!([{"name": "skin"}, {"name": "skin-of-other", "of": other}]);
    scene
}

fn force(answer: &Answer) -> f64 {
    answer.model().obstacle_forces(answer.multiplier()).iter().sum()
}

fn largest(answer: &Answer) -> f64 {
    answer.displacement().iter().fold(0.0, |largest: f64, part| largest.max(part.abs()))
}

#[track_caller]
fn compare(found: f64, exact: f64) {
    assert!((found / exact - 1.0).abs() < SAME, "{found:e} instead of {exact:e}");
}

/// Two leaf springs, one on the other.
fn plates() -> Value {
    json!({
        "model": "space", "contact": "auto",
        "body": block(&[[0.0, 100.0], [0.0, 20.0], [0.0, 3.0]], &[20, 4, 2], "hex8"), "material": steel(),
        "further-bodies": [further("upper", block(&[[0.0, 100.0], [0.0, 20.0], [3.0, 6.0]], &[25, 5, 2], "hex8"))],
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0, "z": 0}, {"on": {"boundary": "upper.left"}, "x": 0, "y": 0, "z": 0}],
        "loads": [{"force": {"boundary": "upper.right", "value": [0, 0, -10]}}],
    })
}

/// A finding: 8.6e8 N instead of 5.5 N.
#[test]
fn leaf_springs_touch_between_them_only() {
    let exact = answer(&named(&plates(), "top", "upper.bottom"));
    assert!((force(&exact) / 5.502734 - 1.0).abs() < 1e-6 && (largest(&exact) / 0.0892 - 1.0).abs() < 1e-2);
    for scene in [plates(), skins(&plates(), "upper")] {
        let found = answer(&scene);
        compare(force(&found), force(&exact));
        compare(largest(&found), largest(&exact));
    }
}

/// A finding: 6.0e8 N instead of 2,400 N, and a sentence of 18 mm.
#[test]
fn a_small_plate_passes_its_load_to_a_large_one() {
    let scene = json!({
        "model": "space", "contact": "auto",
        "body": block(&[[0.0, 60.0], [-20.0, 20.0], [0.0, 8.0]], &[6, 4, 2], "hex8"), "material": steel(),
        "further-bodies": [further("plate", block(&[[-20.0, 90.0], [-40.0, 40.0], [-10.0, 0.0]], &[11, 8, 2], "hex8"))],
        "supports": [{"on": {"boundary": "plate.left"}, "x": 0, "y": 0, "z": 0}, {"on": {"boundary": "left"}, "x": 0, "y": 0}],
        "loads": [{"pressure": {"boundary": "top", "value": 1}}],
    });
    for scene in [&scene, &skins(&scene, "plate")] {
        let answer = answer(scene);
        compare(force(&answer), 2400.0);
        assert!(answer.model().rows().iter().all(|row| row.gap > -SAME));
    }
}

/// A finding: 9.5e6 N/mm.
#[test]
fn a_lap_joint_touches_where_the_plates_lap() {
    let scene = json!({
        "contact": "auto",
        "body": block(&[[0.0, 60.0], [0.0, 5.0]], &[24, 2], "q4"), "material": steel(),
        "further-bodies": [further("upper", block(&[[40.0, 100.0], [5.0, 10.0]], &[30, 2], "q4"))],
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}, {"on": {"boundary": "upper.right"}, "x": 0, "y": 0}],
        "loads": [{"force": {"boundary": "upper.left", "value": [0, -1]}}],
    });
    let exact = answer(&named(&scene, "top", "upper.bottom"));
    assert!(force(&exact) < 1.0);
    compare(force(&answer(&scene)), force(&exact));
    compare(force(&answer(&skins(&scene, "upper"))), force(&exact));
}

/// A finding: 5.5e7 N/mm instead of 54.66.
#[test]
fn thin_tubes_press_on_each_other_between_them_only() {
    let tube = |radii: [f64; 2], count: usize, element: &str| {
        json!({"ring": {"radius": {"points": radii, "divisions": [2]}, "angle": {"points": [0, 90], "divisions": [count]},
                        "element": element}})
    };
    for element in ["q4", "q8"] {
        let scene = json!({
            "contact": "auto",
            "body": tube([20.0, 21.01], 24, element), "material": steel(),
            "further-bodies": [further("hub", tube([21.0, 22.0], 36, element))],
            "supports": [{"on": {"boundary": "start"}, "y": 0}, {"on": {"boundary": "end"}, "x": 0},
                         {"on": {"boundary": "hub.start"}, "y": 0}, {"on": {"boundary": "hub.end"}, "x": 0}],
        });
        let exact = answer(&named(&scene, "outer", "hub.inner"));
        assert!(exact.contact_set().count() == exact.contact_set().rows() && force(&exact) > 1.0);
        compare(force(&answer(&scene)), force(&exact));
        compare(force(&answer(&skins(&scene, "hub"))), force(&exact));
    }
}

/// CONDITIONS: three tubes of 1 mm wall, each shrunk on the next by 0.01 mm.
#[test]
fn three_nested_tubes_touch_their_neighbours_only() {
    let tube = |inner: f64, count: usize| {
        json!({"ring": {"radius": {"points": [inner, inner + 1.01], "divisions": [1]},
                        "angle": {"points": [0, 90], "divisions": [count]}, "element": "q8"}})
    };
    let hold = |prefix: &str| {
        [
            json!({"on": {"boundary": format!("{prefix}start")}, "y": 0}),
            json!({"on": {"boundary": format!("{prefix}end")}, "x": 0}),
        ]
    };
    let supports: Vec<Value> = ["", "middle.", "outside."].into_iter().flat_map(hold).collect();
    let mut scene = json!({
        "contact": "auto",
        "body": tube(20.0, 24), "material": steel(),
        "further-bodies": [further("middle", tube(21.0, 30)), further("outside", tube(22.0, 20))],
        "supports": supports,
    });
    let found = answer(&scene);
    scene.as_object_mut().unwrap().remove("contact");
    let between = |own: &str, other: &str| json!({"boundary": own, "rule": "closest-point", "shape": {"body": {"boundary": other}}});
    scene["obstacles"] = json!([between("outer", "middle.inner"), between("middle.outer", "outside.inner")]);
    let exact = answer(&scene);
    let forces = |answer: &Answer| answer.model().obstacle_forces(answer.multiplier());
    assert_eq!(forces(&found).len(), 2);
    forces(&found).iter().zip(forces(&exact)).for_each(|(&found, exact)| compare(found, exact));
}

/// Three strips, as coarse as one cell each, and thin.
fn strips(thin: f64, cells: usize) -> Value {
    let strip = |from: f64, cells: usize| block(&[[0.0, 1.0], [from, from + thin]], &[cells, 1], "q8");
    json!({
        "contact": "auto",
        "body": strip(thin, cells), "material": steel(),
        "further-bodies": [further("lower", strip(0.0, cells + 1)), further("upper", strip(2.0 * thin, 2 * cells))],
        "supports": [{"on": {"boundary": "lower.bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "left"}, "x": 0},
                     {"on": {"boundary": "upper.left"}, "x": 0}],
        "loads": [{"pressure": {"boundary": "upper.top", "value": 100}}],
    })
}

#[test]
fn strips_pass_their_load_whatever_their_thickness_and_their_mesh() {
    for (thin, cells) in [(0.1, 1), (0.1, 12), (1e-3, 1), (1e-3, 7), (1e-6, 3)] {
        let found = answer(&strips(thin, cells));
        let forces = found.model().obstacle_forces(found.multiplier());
        assert_eq!(forces.len(), 2, "{thin} {cells}: the lower and the upper strip have one between them");
        forces.iter().for_each(|&force| compare(force, 100.0));
    }
}

#[test]
fn a_tie_of_whole_skins_joins_the_faces_that_face_each_other() {
    let mut scene = plates();
    scene.as_object_mut().unwrap().remove("contact");
    scene["parts"] = json!([{"name": "skin"}, {"name": "skin-of-other", "of": "upper"}]);
    let tied = |own: &str, other: &str| {
        let mut scene = scene.clone();
        scene["ties"] = json!([{"surfaces": {"boundary": own, "to": other}}]);
        largest(&answer(&scene))
    };
    compare(tied("skin", "skin-of-other"), tied("top", "upper.bottom"));
}

/// A finding: 37 mm instead of 0.186 mm.
#[test]
fn a_deck_may_name_whole_surfaces() {
    let block = |low: f64, cells: [usize; 3], after: usize| {
        Block { element: "C3D8", low: [0.0, 0.0, low], high: [100.0, 20.0, low + 3.0], cells, after }.mesh()
    };
    let (lower, upper) = (block(0.0, [10, 4, 2], 0), block(3.0, [12, 4, 2], 10_000));
    let deck = |is_whole: bool| {
        let is_named = |at: [f64; 3]| at[2] == 3.0;
        let surface = |mesh: &support::decks::Mesh, name: &str, sides: [f64; 2]| {
            let planes = [(0, 0.0), (0, 100.0), (1, 0.0), (1, 20.0), (2, sides[0]), (2, sides[1])];
            if !is_whole {
                return mesh.surface(name, is_named);
            }
            let faces = planes.iter().flat_map(|&(axis, side)| mesh.faces(move |at| at[axis] == side));
            let lines: String = faces.map(|(element, face)| format!("{element}, S{face}\n")).collect();
            format!("*SURFACE, NAME={name}\n{lines}")
        };
        [
            lower.cards("LOW"),
            upper.cards("UPP"),
            surface(&lower, "MA", [0.0, 3.0]),
            surface(&upper, "SL", [3.0, 6.0]),
            lower.set("FIXL", |at| at[0] == 0.0),
            upper.set("FIXU", |at| at[0] == 0.0),
            upper.set("TIP", |at| at[0] == 100.0 && at[2] == 6.0),
            "*MATERIAL, NAME=M\n*ELASTIC\n210000., .3\n*SOLID SECTION, ELSET=LOW, MATERIAL=M\n*SOLID SECTION, ELSET=UPP, MATERIAL=M\n\
             *SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n\
             *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSL, MA\n*BOUNDARY\nFIXL, 1, 3\nFIXU, 1, 3\n\
             *STEP\n*STATIC\n*CLOAD\nTIP, 3, -10.\n*END STEP\n"
                .to_string(),
        ]
        .concat()
    };
    let exact = decks::answer(&deck(false));
    // CalculiX 2.20 has 0.1862.
    assert!((largest(&exact) / 0.18646 - 1.0).abs() < 1e-3, "{}", largest(&exact));
    let found = decks::answer(&deck(true));
    compare(largest(&found), largest(&exact));
    compare(force(&found), force(&exact));
}

/// Bodies along the axes, each by its limits.
struct Assembly {
    scene: Value,
    boxes: Vec<Vec<[f64; 2]>>,
    /// The force of each contact.
    force: f64,
}

fn between(draws: &mut Draws, low: f64, high: f64) -> f64 {
    low + (high - low) * f64::midpoint(draws.signed(), 1.0)
}

fn choice(draws: &mut Draws, values: &[f64]) -> f64 {
    values[draws.below(values.len())]
}

/// A random assembly in the plane or in space: a stack of bodies that get smaller upwards, so that each passes the load
/// on top down, such as an upright plate on another; or two plates that lap, if `may_lap`.
fn assembly(draws: &mut Draws, may_lap: bool) -> Assembly {
    let laps = may_lap && draws.below(3) == 0;
    let dimension = if draws.below(3) == 0 { 3 } else { 2 };
    let up = dimension - 1;
    let elements: &[&str] =
        if dimension == 2 { &["q4", "q8", "t3", "t6"] } else { &["hex8", "hex20", "tet4", "tet10"] };
    let element = elements[draws.below(elements.len())];
    let most = if dimension == 2 { 9 } else { 3 };
    let (mut boxes, mut bodies): (Vec<Vec<[f64; 2]>>, Vec<Value>) = (Vec::new(), Vec::new());
    let (mut floor, mut side) = (0.0, [-2.0, 2.0]);
    for number in 0..if laps { 2 } else { 2 + draws.below(3) } {
        // Rounding leaves fewer digits to the forces of foils, and of plates that stand apart.
        let thick = choice(draws, if may_lap { &[1e-3, 0.02, 0.1, 0.5, 2.0] } else { &[0.02, 0.1, 0.5, 2.0] });
        if number > 0 {
            floor += choice(draws, &[0.0, 0.0, OVERLAP, -OVERLAP, if may_lap { 0.01 } else { 0.0 }]);
        }
        if number > 0 && laps {
            side = side.map(|at| at + choice(draws, &[0.5, 1.0, 3.0]));
        } else if number > 0 {
            let wide = side[1] - side[0];
            let margin = wide * choice(draws, &[0.0, 0.05, 0.25, 0.45]);
            side = [side[0] + margin * between(draws, 0.2, 0.8), side[1] - margin];
        }
        let mut limits = vec![side; dimension];
        limits[up] = [floor, floor + thick];
        let cells: Vec<usize> =
            (0..dimension).map(|axis| if axis == up { 1 + draws.below(2) } else { 1 + draws.below(most) }).collect();
        bodies.push(block(&limits, &cells, element));
        boxes.push(limits);
        floor += thick;
    }
    // The first body is the highest.
    let name = |number: usize| format!("b{number}");
    let last = bodies.len() - 1;
    let mut supports = vec![json!({"on": {"boundary": "b0.bottom"}, "x": 0, "y": 0})];
    let hold = |boundary: String, axis: &str| json!({"on": {"boundary": boundary}, axis: 0});
    for number in 1..bodies.len() {
        let prefix = if number == last { String::new() } else { name(number) + "." };
        supports.push(hold(format!("{prefix}left"), "x"));
        if dimension == 3 {
            supports.push(hold(format!("{prefix}front"), "y"));
        }
    }
    if dimension == 3 {
        supports[0]["z"] = json!(0);
    }
    let further: Vec<Value> = (0..last).map(|number| further(&name(number), bodies[number].clone())).collect();
    let mut scene = json!({
        "contact": "auto", "body": bodies[last], "material": steel(), "further-bodies": further, "supports": supports,
        "loads": [{"pressure": {"boundary": "top", "value": 1}}],
    });
    if dimension == 3 {
        scene["model"] = json!("space");
    }
    let area: f64 = boxes[last][..up].iter().map(|side| side[1] - side[0]).product();
    Assembly { scene, boxes, force: area }
}

/// Whether the way of a row leads through a body.
fn is_through(model: &Model, boxes: &[Vec<[f64; 2]>]) -> bool {
    let nodes = model.mesh().nodes();
    model.rows().iter().any(|row| {
        let inside = |share: f64| {
            let at = [0, 1, 2].map(|axis| nodes[row.node][axis] + share * row.gap * row.normal[axis]);
            boxes.iter().any(|limits| {
                limits.iter().zip(at).all(|([low, high], at)| {
                    let rim = INSIDE * (high - low);
                    low + rim < at && at < high - rim
                })
            })
        };
        row.gap < -OVERLAP - SAME || row.gap > SAME && (1..50).any(|step| inside(f64::from(step) / 50.0))
    })
}

/// CONDITIONS: stacks of two to four bodies, plane and in space, linear and quadratic, coarse and fine, thin and thick,
/// wide and upright, with whatever `auto` finds between them.
#[test]
fn no_row_of_random_assemblies_leads_through_a_body() {
    let (mut draws, mut rows) = (Draws(seed(20_261_129)), 0);
    for case in 0..cases(60, 400) {
        let Assembly { scene, boxes, .. } = assembly(&mut draws, true);
        let model = build(&scene).unwrap_or_else(|error| panic!("case {case}: {error}: {scene}"));
        assert!(!is_through(&model, &boxes), "case {case}: {scene}");
        // Each body touches the next, and no other.
        assert_eq!(model.obstacles().len(), boxes.len() - 1, "case {case}: {scene}");
        rows += model.rows().len();
    }
    assert!(rows > 100);
}

/// The load on top passes through every contact below.
#[test]
fn random_stacks_pass_their_load_down() {
    let mut draws = Draws(seed(1129));
    for case in 0..cases(15, 100) {
        let Assembly { scene, force: exact, .. } = assembly(&mut draws, false);
        let found = answer(&scene);
        for force in found.model().obstacle_forces(found.multiplier()) {
            assert!((force / exact - 1.0).abs() < SAME, "case {case}: {force:e} instead of {exact:e}: {scene}");
        }
    }
}

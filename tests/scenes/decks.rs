//! Decks of CalculiX: closed forms of every element, loads and supports as CalculiX reads them, contacts, names of
//! nodes.

use std::fs;
use std::sync::Arc;

use signorini::scene::Answer;
use signorini::{Error, Scene, qp, solve_qp};
use support::decks::Block;

/// Answers differ from a displacement that the elements represent exactly by rounding alone.
const ROUNDING: f64 = 1e-10;

const MATERIAL: &str = "*MATERIAL, NAME=STEEL\n*ELASTIC\n200., 0.25\n*DENSITY\n2.\n*EXPANSION, ZERO=20.\n1.E-3\n";

/// Reads a deck, and the files that it includes.
pub fn read(files: &[(&str, &str)], permits: &[&str]) -> Result<Scene, Error> {
    let desk = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(desk.path().join(name), text).unwrap();
    }
    let file = desk.path().join(files[0].0);
    let scene = Scene::read_deck(&file, permits, None)?;
    scene.build().map_err(|error| Scene::located(error, &file))?;
    // The folder of the deck is gone when the scene is built again.
    let kept = desk.keep();
    Ok(Scene { folder: Some(kept), ..scene })
}

/// The answer of a deck.
pub fn answer(deck: &str) -> Answer {
    let scene = read(&[("deck.inp", deck)], &[]).unwrap_or_else(|error| panic!("{error}\n{deck}"));
    let model = scene.build().unwrap();
    let solution = solve_qp(model.problem()).unwrap();
    let answer = Answer::of(Arc::new(model), &solution).unwrap();
    fs::remove_dir_all(scene.folder.unwrap()).unwrap();
    answer
}

/// The line and the message of the error of a deck.
pub fn refusal(deck: &str) -> (usize, String) {
    match read(&[("deck.inp", deck)], &[]) {
        Err(Error::Linear(qp::LinearError::FileSyntax { line, message, .. })) => (line, message),
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("accepted: {deck}"),
    }
}

/// Compares each displacement with that at the place of its node.
pub fn compare(answer: &Answer, exact: impl Fn([f64; 3]) -> [f64; 3]) {
    let (mesh, size) = (answer.model().mesh(), answer.model().mesh().dimension());
    let exact: Vec<[f64; 3]> = mesh.nodes().iter().map(|at| exact(*at)).collect();
    let largest = exact.iter().flatten().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for (node, exact) in exact.iter().enumerate() {
        for (axis, exact) in exact.iter().enumerate().take(size) {
            let found = answer.displacement()[size * node + axis];
            let differs = (found - exact).abs();
            assert!(differs < ROUNDING * largest, "node {node} axis {axis}: {found} instead of {exact}");
        }
    }
}

/// A block from the origin to (2, 1, 1) of elements of a type, with sets at the planes through the origin, a surface at
/// the end, and steel.
fn block(element: &'static str) -> String {
    let is_plane = !element.starts_with("C3D");
    let (high, cells) = if is_plane { ([2.0, 1.0, 0.0], [3, 2, 0]) } else { ([2.0, 1.0, 1.0], [3, 2, 2]) };
    let mesh = Block { element, low: [0.0; 3], high, cells, after: 0 }.mesh();
    let mut deck = mesh.cards("PART");
    for (axis, name) in ["X0", "Y0", "Z0"].into_iter().enumerate() {
        deck += &mesh.set(name, |at| at[axis] == 0.0);
    }
    deck += &mesh.set("END", |at| at[0] == 2.0);
    deck += &mesh.surface("FACE", |at| at[0] == 2.0);
    deck + MATERIAL + "*SOLID SECTION, ELSET=PART, MATERIAL=STEEL\n"
}

const SYMMETRIC: &str = "*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n";

pub fn step(cards: &str) -> String {
    format!("*STEP\n*STATIC\n{cards}*END STEP\n")
}

/// GOAL: uniaxial tension of every element of a deck.
/// CONDITIONS: a pressure of -3 pulls at the end; solids, plane stress and plane strain.
/// REFERENCE: sigma = 3 along x, in plane strain with sigma_z = nu sigma.
#[test]
fn every_element_stretches_as_in_closed_form() {
    const E: f64 = 200.0;
    const NU: f64 = 0.25;
    for element in [
        "C3D4", "C3D8", "C3D8I", "C3D8R", "C3D10", "C3D20", "C3D20R", "CPS3", "CPS4", "CPS6", "CPS8", "CPE3", "CPE4R",
        "CPE6", "CPE8R",
    ] {
        let answer = answer(&(block(element) + SYMMETRIC + &step("*DSLOAD\nFACE, P, -3.\n")));
        let is_strain = element.starts_with("CPE");
        let along = 3.0 / E * if is_strain { 1.0 - NU * NU } else { 1.0 };
        let across = -NU * 3.0 / E * if is_strain { 1.0 + NU } else { 1.0 };
        compare(&answer, |[x, y, z]| [along * x, across * y, across * z]);
    }
}

/// GOAL: a pressure on faces within a body.
/// CONDITIONS: nu = 0; the faces across x (axisymmetric: y) of the elements before the last row, of all elements.
/// REFERENCE: sigma = -3 up to there, 0 beyond.
#[test]
fn faces_within_a_body_are_pressed() {
    for element in ["CPS3", "CPS4", "CPS6", "CPE8", "CAX4", "CAX6", "CAX8", "C3D4", "C3D8", "C3D20"] {
        let is_plane = !element.starts_with("C3D");
        let (axis, at) = if element.starts_with("CAX") { (1, 0.5) } else { (0, 4.0 / 3.0) };
        let (high, cells) = if is_plane { ([2.0, 1.0, 0.0], [3, 2, 0]) } else { ([2.0, 1.0, 1.0], [3, 2, 2]) };
        let mesh = Block { element, low: [0.0; 3], high, cells, after: 0 }.mesh();
        let is_at = |place: f64| (place - at).abs() < 1e-9;
        let low: Vec<usize> =
            mesh.nodes.iter().filter(|(_, place)| place[axis] < at - 1e-9).map(|(number, _)| *number).collect();
        let is_before = |element: usize| {
            mesh.elements.iter().any(|one| one.0 == element && one.1.iter().any(|node| low.contains(node)))
        };
        let pressed = mesh.faces(|place| is_at(place[axis])).into_iter().filter(|(element, _)| is_before(*element));
        let pressed: String = pressed.map(|(element, face)| format!("{element}, P{face}, 3.\n")).collect();
        let thickness = if is_plane { "0.5\n" } else { "" };
        let deck =
            block(element).replace("200., 0.25", "200., 0.").replace("L=STEEL\n", &format!("L=STEEL\n{thickness}"));
        let answer = answer(&(deck + SYMMETRIC + &step(&format!("*DLOAD\n{pressed}"))));
        compare(&answer, |place| [0, 1, 2].map(|k| if k == axis { -3.0 * place[axis].min(at) / 200.0 } else { 0.0 }));
    }
}

/// GOAL: a disc under radial pressure.
/// CONDITIONS: a disc of radius 2 that a pressure of 3 presses all around, free across its plane; every axisymmetric
/// element.
/// REFERENCE: u_r = -(1 - nu) p r/E, u_y = 2 nu p y/E.
#[test]
fn an_axisymmetric_disc_shrinks_as_in_closed_form() {
    for element in ["CAX3", "CAX4", "CAX6", "CAX8", "CAX8R"] {
        let answer = answer(&(block(element) + "*BOUNDARY\nY0, 2\n" + &step("*DSLOAD\nFACE, P, 3.\n")));
        compare(&answer, |[r, y, _]| [-0.75 * 3.0 * r / 200.0, 0.5 * 3.0 * y / 200.0, 0.0]);
    }
}

/// As CalculiX adds up the loads of a step, within a card and between cards; an amplitude counts at the end of the
/// step.
#[test]
fn loads_of_one_step_add_up() {
    let faces = Block { element: "C3D8", low: [0.0; 3], high: [2.0, 1.0, 1.0], cells: [3, 2, 2], after: 0 }
        .mesh()
        .faces(|at| at[0] == 2.0);
    let pressed =
        |value: f64| faces.iter().map(|(element, face)| format!("{element}, P{face}, {value}\n")).collect::<String>();
    let ramp = "*AMPLITUDE, NAME=RAMP\n0., 0., 1., 0.5, 3., 1.5\n";
    let loads = format!(
        "*DLOAD\n{}{}*DLOAD\n{}*DSLOAD, AMPLITUDE=RAMP\nFACE, P, -1.\n",
        pressed(-0.5),
        pressed(-0.5),
        pressed(-1.0)
    );
    let step = step(&loads).replace("*STATIC\n", "*STATIC, SOLVER=PARDISO\n0.1, 2.\n");
    let answer = answer(&(block("C3D8") + ramp + SYMMETRIC + &step));
    // 0.5 + 0.5 + 1 + 1, because the amplitude is 1 at the time 2.
    compare(&answer, |[x, y, z]| [3.0 * x / 200.0, -0.75 * y / 200.0, -0.75 * z / 200.0]);
}

/// GOAL: a bar under its own weight, and forces on nodes by sets and by numbers.
/// CONDITIONS: nu = 0; gravity along the bar; a force at its end.
/// REFERENCE: u = rho g (L x - x^2/2)/E, exact at the nodes.
#[test]
fn a_hanging_bar_carries_its_weight_and_a_force() {
    let deck = block("C3D20").replace("200., 0.25", "200., 0.") + SYMMETRIC;
    let held = answer(&(deck.clone() + &step("*DLOAD\nPART, GRAV, 10., 3., 0., 0.\n")));
    // rho g (L x - x^2/2)/E, exact at the nodes.
    compare(&held, |[x, ..]| [2.0 * 10.0 * (2.0 * x - x * x / 2.0) / 200.0, 0.0, 0.0]);
    let by_set = answer(&(deck.clone() + &step("*CLOAD\nEND, 1, 0.25\n*CLOAD\nEND, 1, 0.125\n")));
    let numbers: Vec<usize> =
        Block { element: "C3D20", low: [0.0; 3], high: [2.0, 1.0, 1.0], cells: [3, 2, 2], after: 0 }
            .mesh()
            .nodes
            .iter()
            .filter(|(_, at)| at[0] == 2.0)
            .map(|(number, _)| *number)
            .collect();
    let lines: String = numbers.iter().map(|number| format!("{number}, 1, 0.375\n")).collect();
    let by_number = answer(&(deck + &step(&format!("*CLOAD\n{lines}"))));
    assert_eq!(by_set.model().problem().load(), by_number.model().problem().load());
    assert_eq!(by_number.model().problem().load().iter().sum::<f64>(), 0.375 * numbers.len() as f64);
}

/// The step says more than the model: its displacement replaces the support, and OP=NEW removes the supports before it.
#[test]
fn supports_of_the_step_replace_those_of_the_model() {
    let deck = block("C3D8").replace("200., 0.25", "200., 0.") + SYMMETRIC + "*BOUNDARY\nEND, 1, 1\n";
    let pulled = answer(&(deck.clone() + &step("*BOUNDARY\nEND, 1, , 0.01\n")));
    compare(&pulled, |[x, ..]| [0.005 * x, 0.0, 0.0]);
    let freed =
        answer(&(deck + &step("*BOUNDARY, OP=NEW\nX0, XSYMM\nY0, 2, 2\nZ0, 3, 6, 0.\n*DSLOAD\nFACE, P, -2.\n")));
    compare(&freed, |[x, ..]| [2.0 * x / 200.0, 0.0, 0.0]);
}

/// GOAL: free thermal expansion, by *EXPANSION and *TEMPERATURE.
/// CONDITIONS: a free block, isotropic, and orthotropic with turned axes.
/// REFERENCE: the strain alpha (T - T0) along each axis of the material.
#[test]
fn a_warmed_block_expands_freely() {
    let cards = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n";
    let answer = answer(&(block("C3D10") + cards + SYMMETRIC + &step("*TEMPERATURE\nALL, 70.\n")));
    compare(&answer, |at| at.map(|x| 0.05 * x));
    // Axes 1 and 2 of the material are y and -x.
    const TURNED: &str = "*MATERIAL, NAME=STEEL\n*EXPANSION, TYPE=ORTHO\n1.E-3, 2.E-3, -3.E-3\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n\
                          400., 100., 200., 0.2, 0.1, 0.3, 60., 70.,\n80.\n*ORIENTATION, NAME=O\n0., 1., 0., -1., 0., 0.\n";
    let turned =
        block("C3D10").replace(MATERIAL, TURNED).replace("MATERIAL=STEEL\n", "MATERIAL=STEEL, ORIENTATION=O\n");
    let answer = self::answer(&(turned + cards + SYMMETRIC + &step("*TEMPERATURE\nALL, 30.\n")));
    compare(&answer, |[x, y, z]| [0.02 * x, 0.01 * y, -0.03 * z]);
    let isotropic = block("C3D10").replace("*EXPANSION, ZERO=20.\n1.E-3", "*EXPANSION, TYPE=ORTHO\n1., 2., 3.");
    assert!(refusal(&(isotropic + SYMMETRIC + &step(""))).1.contains("an isotropic material has one expansion"));
}

/// Along x the block has half the modulus in its second section: springs in series.
#[test]
fn each_section_has_its_material() {
    let mesh = Block { element: "C3D8", low: [0.0; 3], high: [2.0, 1.0, 1.0], cells: [2, 1, 1], after: 10 }.mesh();
    let deck = mesh.cards("WHOLE")
        + "*ELSET, ELSET=LATER\n12\n*ELSET, ELSET=FIRST, GENERATE\n11, 11\n*ELSET, ELSET=also\nfirst, 11\n"
        + &mesh.set("X0", |at| at[0] == 0.0)
        + &mesh.set("END", |at| at[0] == 2.0)
        + "*MATERIAL, NAME=STIFF\n*ELASTIC\n200., 0.\n*MATERIAL, NAME=SOFT\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n"
        + "100., 100., 100., 0., 0., 0., 50., 50.,\n50.\n"
        + "*SOLID SECTION, ELSET=WHOLE, MATERIAL=STIFF\n*SOLID SECTION, ELSET=LATER, MATERIAL=SOFT\n"
        + "*BOUNDARY\nX0, ENCASTRE\nEND, 2, 3\n"
        + &step("*BOUNDARY\nEND, 1, 1, 0.03\n");
    compare(&answer(&deck), |[x, ..]| [0.01 * x.min(1.0) + 0.02 * (x - 1.0).max(0.0), 0.0, 0.0]);
}

/// Axis 1 of the material along y, axis 2 against x: tension along x by 3 stretches by 3/E2, and narrows by nu12 3/E1
/// along y. A surface within the body that only prints a force is left out.
#[test]
fn material_axes_are_turned_by_an_orientation() {
    const TURNED: &str = "*ORIENTATION, NAME=O, SYSTEM=RECTANGULAR\n0., 2., 0., -1., 1., 0.\n\
                          *MATERIAL, NAME=STEEL\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n\
                          400., 100., 200., 0.2, 0.1, 0.3, 60., 70.,\n80.\n";
    for element in ["C3D8", "C3D10", "CPS4"] {
        let deck = block(element)
            .replace(MATERIAL, TURNED)
            .replace("ELSET=PART, MATERIAL=STEEL", "ELSET=PART, MATERIAL=STEEL, ORIENTATION=o");
        let inner = "*SURFACE, NAME=INNER\n1, S2\n";
        let print = "*SECTION PRINT, SURFACE=INNER, NAME=CUT\nSOF\n";
        let answer = answer(&(deck + inner + SYMMETRIC + &step(&format!("*DSLOAD\nFACE, P, -3.\n{print}"))));
        // nu23/E2 along z.
        compare(&answer, |[x, y, z]| [3.0 * x / 100.0, -0.2 * 3.0 * y / 400.0, -0.3 * 3.0 * z / 100.0]);
    }
}

/// Axes around a line through (0, -5) along z: those of the scene that says so. In the plane the line is across it.
#[test]
fn material_axes_turn_around_the_line_of_an_orientation() {
    const AROUND: &str = "*MATERIAL, NAME=STEEL\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n\
                          400., 100., 200., 0.2, 0.1, 0.3, 60., 70.,\n80.\n*ORIENTATION, NAME=O, SYSTEM=CYLINDRICAL\n";
    for (element, points, around) in [
        ("C3D10", "0., -5., 1., 0., -5., 4.\n", Some("{\"along\": [0, 0, 3], \"point\": [0, -5, 1]}")),
        ("CPS4", "0., -5., 0., 0., -5., 1.\n", Some("{\"point\": [0, -5]}")),
        ("CPS4", "0., -5., 0., 1., -5., 0.\n", None),
        ("C3D8", "0., -5., 0., 0., -5., 0.\n", None),
    ] {
        let deck = block(element)
            .replace(MATERIAL, &format!("{AROUND}{points}"))
            .replace("ELSET=PART, MATERIAL=STEEL", "ELSET=PART, MATERIAL=STEEL, ORIENTATION=o");
        let deck = deck + SYMMETRIC + &step("*DSLOAD\nFACE, P, -3.\n");
        let Some(around) = around else {
            let (_, message) = refusal(&deck);
            assert!(
                message.contains("across the plane") || message.contains("two points of the axis are one"),
                "{message}"
            );
            continue;
        };
        let scene = read(&[("deck.inp", &deck)], &[]).unwrap();
        let text = Scene::text_of_deck(&scene.folder.clone().unwrap().join("deck.inp"), "deck.inp", &[], None).unwrap();
        fs::remove_dir_all(scene.folder.unwrap()).unwrap();
        assert!(text.contains(&format!("\"around\": {around}")), "{text}");
    }
}

/// Directions 1, 2, 3 of all nodes are y, -x, z: supports and forces along them stretch along x. Around a line through
/// (-1, 2) along z the end moves outwards by 0.01.
#[test]
fn supports_and_forces_are_along_the_axes_of_a_transform() {
    const TURNED: &str = "*TRANSFORM, NSET=ALL, TYPE=R\n0., 3., 0., -1., 1., 0.\n";
    let deck = block("C3D8") + TURNED + "*BOUNDARY\nX0, 2\nY0, 1\nZ0, 3\n";
    let answer = answer(&(deck + &step("*BOUNDARY\nEND, 2, 2, -0.03\n*CLOAD\nX0, 2, 5.\n")));
    compare(&answer, |[x, y, z]| [0.015 * x, -0.25 * 0.015 * y, -0.25 * 0.015 * z]);

    let around = "*TRANSFORM, NSET=END, TYPE=C\n-1., 2., 0., -1., 2., 5.\n";
    let held = "*BOUNDARY\nX0, 1, 3\n".to_string() + &step("*BOUNDARY\nEND, 1, 1, 0.01\nEND, 2, 3, 0.\n");
    let answer = self::answer(&(block("C3D8") + around + &held));
    for (node, &[x, y, _]) in answer.model().mesh().nodes().iter().enumerate().filter(|(_, at)| at[0] == 2.0) {
        let away = (x + 1.0).hypot(y - 2.0);
        let exact = [0.01 * (x + 1.0) / away, 0.01 * (y - 2.0) / away, 0.0];
        let found = &answer.displacement()[3 * node..3 * node + 3];
        assert!((0..3).all(|axis| (found[axis] - exact[axis]).abs() < 1e-15), "{found:?} instead of {exact:?}");
    }
}

/// A plane body of thickness 0.5: a force of 3 on its end is a stress of 6.
#[test]
fn the_thickness_of_a_plane_section_counts() {
    let deck = block("CPS4")
        .replace("ELSET=PART, MATERIAL=STEEL\n", "ELSET=PART, MATERIAL=STEEL\n0.5\n")
        .replace("0.25\n", "0.\n");
    // The two edges of the end share the force: a quarter, a half, a quarter.
    let loads = "*CLOAD\n4, 1, 0.75\n8, 1, 1.5\n12, 1, 0.75\n";
    compare(&answer(&(deck + SYMMETRIC + &step(loads))), |[x, ..]| [6.0 * x / 200.0, 0.0, 0.0]);
}

/// Two blocks of meshes that do not match, one on the other, pressed by 3: each shortens as one block does.
fn stack(pair: &str, gap: f64) -> String {
    let below = Block { element: "C3D8", low: [0.0; 3], high: [1.0; 3], cells: [2, 2, 1], after: 0 }.mesh();
    let above = Block {
        element: "C3D8",
        low: [0.0, 0.0, 1.0 + gap],
        high: [1.0, 1.0, 2.0 + gap],
        cells: [3, 3, 2],
        after: 100,
    };
    let above = above.mesh();
    below.cards("PART")
        + &above.cards("PART")
        + &below.set("BASE", |at| at[2] == 0.0)
        + &above.set("BELOW", |at| at[2] == 1.0 + gap)
        + &below.set("ALL-X0", |at| at[0] == 0.0)
        + &above.set("ALL-X0", |at| at[0] == 0.0)
        + &below.set("ALL-Y0", |at| at[1] == 0.0)
        + &above.set("ALL-Y0", |at| at[1] == 0.0)
        + &below.surface("Master", |at| at[2] == 1.0)
        + &above.surface("Slave", |at| at[2] == 1.0 + gap)
        + &above.surface("Top", |at| at[2] == 2.0 + gap)
        + "*SURFACE, NAME=SLAVE-NODES, TYPE=NODE\nBELOW\n"
        + MATERIAL
        + "*SOLID SECTION, ELSET=PART, MATERIAL=STEEL\n*BOUNDARY\nBASE, 3\nALL-X0, 1\nALL-Y0, 2\n"
        + pair
        + &step("*DSLOAD\nTOP, P, 3.\n")
}

const HARD: &str = "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n";

/// GOAL: the contact patch test of a deck.
/// CONDITIONS: two stacked blocks under a pressure, with and without a gap, which cards change.
/// REFERENCE: uniaxial stress: the strains of one block, and the gap in addition.
#[test]
fn stacked_blocks_in_contact_shorten_as_one() {
    let pair = |first: &str| format!("{HARD}*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\n{first}, MASTER\n");
    for slave in ["SLAVE", "slave-nodes"] {
        let answer = answer(&stack(&pair(slave), 0.0));
        compare(&answer, |[x, y, z]| [0.75 * x / 200.0, 0.75 * y / 200.0, -3.0 * z / 200.0]);
        assert_eq!(answer.contact_set().count(), answer.contact_set().rows());
    }
    // The mesh has a gap of 0.01; each of these cards says another one.
    for (card, gap) in [
        ("", 0.01),
        ("*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=0.002\n", 0.002),
        ("*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=-0.002\n", -0.002),
    ] {
        let answer = answer(&stack(&(pair("SLAVE") + card), 0.01));
        let shift = |z: f64| if z > 1.005 { gap } else { 0.0 };
        let height = |z: f64| if z > 1.005 { z - 0.01 } else { z };
        compare(&answer, |[x, y, z]| [0.75 * x / 200.0, 0.75 * y / 200.0, -3.0 * height(z) / 200.0 - shift(z)]);
    }
    let adjusted = pair("SLAVE").replace("TYPE=SURFACE", "ADJUST=0.02, TYPE=SURFACE");
    let answer = answer(&stack(&adjusted, 0.01));
    let height = |z: f64| if z > 1.005 { z - 0.01 } else { z };
    compare(&answer, |[x, y, z]| [0.75 * x / 200.0, 0.75 * y / 200.0, -3.0 * height(z) / 200.0]);
}

/// What is answered in another way has a warning with its line, once.
#[test]
fn what_is_answered_in_another_way_has_a_warning() {
    let soft = "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E7, 3.\n*FRICTION\n0.2, 1.E6\n\
                *CONTACT PAIR, INTERACTION=I\nSLAVE, MASTER\n";
    let deck = stack(soft, 0.0).replace("*STEP\n", "*STEP, NLGEOM, INC=100\n").replace("C3D8,", "C3D8R,");
    let refused = read(&[("deck.inp", &deck)], &[]).unwrap_err().to_string();
    assert!(
        refused.contains("*FRICTION of 0.2 changes the answer and is not modelled; --without-friction"),
        "{refused}"
    );
    let scene = read(&[("deck.inp", &deck)], &["friction"]).unwrap();
    fs::remove_dir_all(scene.folder.unwrap()).unwrap();
    let line = |text: &str| 1 + deck.lines().position(|line| line.contains(text)).unwrap();
    let said: Vec<String> = scene.noted.iter().map(ToString::to_string).collect();
    for (text, phrase) in [
        ("*ELEMENT", "C3D8R is answered by Hex8, with full instead of reduced integration"),
        ("NLGEOM", "NLGEOM is answered with small displacements"),
        ("LINEAR", "PRESSURE-OVERCLOSURE=LINEAR (10000000, 3) is answered by hard contact"),
        ("*FRICTION", "the friction of 0.2 is left out"),
    ] {
        let line = line(text) + usize::from(text == "*ELEMENT");
        let found = said.iter().filter(|said| said.contains(phrase)).collect::<Vec<_>>();
        assert!(found.len() == 1 && found[0].contains(&format!("deck.inp:{line}: ")), "{phrase}: {said:#?}");
    }
    assert_eq!(said.len(), 4, "{said:#?}");
    let codes: Vec<&str> = scene.noted.iter().map(|warning| warning.code).collect();
    assert_eq!(codes, ["nonlinear", "deck", "deck", "deck"]);
}

/// The text that `new` writes poses the same problem, to the last bit.
#[test]
fn the_scene_of_a_deck_poses_the_problem_of_the_deck() {
    let pair = format!("{HARD}*CONTACT PAIR, INTERACTION=I, TYPE=NODE TO SURFACE\nSLAVE, MASTER\n");
    let desk = tempfile::tempdir().unwrap();
    let (deck, file) = (desk.path().join("deck.inp"), desk.path().join("scene.json"));
    fs::write(&deck, stack(&pair, 0.01)).unwrap();
    fs::write(&file, Scene::text_of_deck(&deck, "deck.inp", &[], None).unwrap()).unwrap();
    let [one, other] = [&deck, &file].map(|file| Scene::read(file).unwrap().build().unwrap());
    assert_eq!(format!("{:?}", one.problem()), format!("{:?}", other.problem()));
}

/// Lines, blanks, case, comments and includes change nothing.
#[test]
fn a_deck_may_be_written_in_many_ways() {
    let plain = block("C3D8") + SYMMETRIC + &step("*CLOAD\nEND, 1, 0.2\n");
    let load = |files: &[(&str, &str)]| {
        let scene = read(files, &[]).unwrap();
        let load = scene.build().unwrap().problem().load().to_vec();
        fs::remove_dir_all(scene.folder.unwrap()).unwrap();
        load
    };
    let expected = load(&[("deck.inp", &plain)]);
    let spaced = plain
        .replace("*CLOAD\nEND, 1, 0.2", "** a force\r\n\r\n  *cload ,\n  OP = new\n  e n d ,1 , 2.0D-1 ,")
        .replace("*SOLID SECTION, ", "*SolidSection,\n");
    assert_eq!(load(&[("deck.inp", &spaced)]), expected);
    // The data of a card go on behind an included file.
    let (before, after) = plain.split_at(plain.find("*NSET").unwrap());
    let cut = before.find("11, ").unwrap();
    let (before, middle) = before.split_at(cut);
    let after = format!("{}{after}", &middle[middle.find("12, ").unwrap()..]);
    let middle = &middle[..middle.find("12, ").unwrap()];
    let deck = format!("{before}*INCLUDE, INPUT=rest.txt\n{after}");
    assert_eq!(load(&[("deck.inp", &deck), ("rest.txt", middle)]), expected);
}

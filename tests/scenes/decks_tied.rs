//! Decks whose displacements are tied: surfaces, equations, rigid bodies.

use signorini::scene::Answer;
use support::decks::Block;

use crate::decks::{answer, compare, refusal, step};

const MATERIAL: &str = "*MATERIAL, NAME=STEEL\n*ELASTIC\n200., 0.25\n";

/// Two blocks, (2, 1, 1) and beside it (1, 1, 1), with meshes of their own, held at x = 0, y = 0, z = 0.
fn two(elements: [&'static str; 2]) -> String {
    let is_plane = !elements[0].starts_with("C3D");
    let (z, cells) = if is_plane { (0.0, 0) } else { (1.0, 2) };
    let first =
        Block { element: elements[0], low: [0.0; 3], high: [2.0, 1.0, z], cells: [2, 2, cells], after: 0 }.mesh();
    let low = [2.0, 0.0, 0.0];
    let second = Block {
        element: elements[1],
        low,
        high: [3.0, 1.0, z],
        cells: [2, 3, cells + usize::from(!is_plane)],
        after: 1000,
    }
    .mesh();
    let mut deck = first.cards("LEFT") + &second.cards("RIGHT");
    for (axis, name) in ["X0", "Y0", "Z0"].into_iter().enumerate() {
        deck += &first.set(name, |at| at[axis] == 0.0);
        deck += if axis > 0 { second.set(name, |at| at[axis] == 0.0) } else { String::new() }.as_str();
    }
    deck += &second.set("END", |at| at[0] == 3.0);
    deck += &first.surface("MASTER", |at| at[0] == 2.0);
    deck += &second.surface("SLAVE", |at| at[0] == 2.0);
    deck += &second.surface("FACE", |at| at[0] == 3.0);
    let sections = ["LEFT", "RIGHT"].map(|set| format!("*SOLID SECTION, ELSET={set}, MATERIAL=STEEL\n"));
    deck + MATERIAL + &sections.concat() + "*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n"
}

fn stretched(answer: &Answer, strain: f64) {
    compare(answer, |[x, y, z]| [strain * x, -0.25 * strain * y, -0.25 * strain * z]);
}

/// GOAL: the patch test of tied surfaces of a deck.
/// CONDITIONS: two tied blocks in tension, by *TIE and by a tied contact pair; six pairs of elements.
/// REFERENCE: uniaxial stress: the strain 3/200.
#[test]
fn tied_surfaces_stretch_as_one_bar() {
    const TIE: &str = "*TIE, NAME=T, POSITION TOLERANCE=0.1, ADJUST=NO\nSLAVE, MASTER\n";
    const TIED: &str = "*SURFACE INTERACTION, NAME=GLUE\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TIED\n1.E7\n*FRICTION\n0.3, 5.E6\n\
                        *CONTACT PAIR, INTERACTION=GLUE, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n";
    for elements in [
        ["C3D4", "C3D8"],
        ["C3D10", "C3D10"],
        ["C3D20", "C3D10"],
        ["C3D8R", "C3D20"],
        ["CPS4", "CPS8"],
        ["CPS6", "CPS3"],
    ] {
        for cards in [TIE, TIED] {
            let answer = answer(&(two(elements) + cards + &step("*DSLOAD\nFACE, P, -3.\n")));
            stretched(&answer, 3.0 / 200.0);
            let tie = answer.resultants().unwrap().iter().find(|one| one.of == "ties[0]").unwrap();
            assert!((tie.force[0].abs() - 3.0).abs() < 1e-9, "{elements:?}: {tie:?}");
        }
    }
}

/// All nodes of the end follow one of them along x; the force on it is spread as a plate spreads it. The second time,
/// directions 1, 2, 3 of all nodes are y, -x, z.
#[test]
fn equations_make_a_plate() {
    let mesh = Block { element: "C3D8", low: [0.0; 3], high: [2.0, 1.0, 1.0], cells: [2, 2, 2], after: 0 }.mesh();
    let mut deck = mesh.cards("PART");
    for (axis, name) in ["X0", "Y0", "Z0"].into_iter().enumerate() {
        deck += &mesh.set(name, |at| at[axis] == 0.0);
    }
    let end: Vec<usize> = mesh.nodes.iter().filter(|(_, at)| at[0] == 2.0).map(|(number, _)| *number).collect();
    deck += MATERIAL;
    deck += "*SOLID SECTION, ELSET=PART, MATERIAL=STEEL\n";
    let turned = mesh.set("ALL", |_| true) + "*TRANSFORM, NSET=ALL\n0., 3., 0., -1., 1., 0.\n";
    for (cards, [x, y], force) in [("", [1, 2], 3.0), (&turned, [2, 1], -3.0)] {
        // One equation of five terms, on two lines; the others have two.
        let mut equations = format!(
            "*EQUATION\n5\n{}, {x}, 4., {}, {x}, -1., {}, {x}, -1., {}, {x}, -1.,\n{}, {x}, -1.\n",
            end[8], end[0], end[2], end[5], end[7]
        );
        for node in &end[1..8] {
            equations += &format!("2\n{node}, {x}, 2.5, {}, {x}, -2.5\n", end[0]);
        }
        let supports = format!("*BOUNDARY\nX0, {x}\nY0, {y}\nZ0, 3\n");
        let pulled = step(&format!("*CLOAD\n{}, {x}, {force}\n", end[0]));
        stretched(&answer(&(deck.clone() + cards + &equations + &supports + &pulled)), 3.0 / 200.0);
    }
}

/// The end is a plate with reference nodes: pulled, or moved and turned.
#[test]
fn a_rigid_body_is_pulled_and_turned_at_its_reference_nodes() {
    const PLATE: &str = "*NODE, NSET=REFERENCES\n2001, 3., 0.5, 0.5\n2002, 3., 0.5, 0.5\n*RIGID BODY, NSET=END, REF NODE=2001, ROT NODE=2002\n";
    const NO_WIDENING: &str = "*MATERIAL, NAME=STEEL\n*ELASTIC\n200., 0.\n";
    let deck = two(["C3D8", "C3D8"]).replace(MATERIAL, NO_WIDENING).replace("X0, 1\nY0, 2\nZ0, 3", "X0, 1, 3")
        + "*TIE, NAME=T\nSLAVE, MASTER\n"
        + PLATE;
    let pulled = answer(&(deck.clone() + &step("*CLOAD\n2001, 1, 3.\nREFERENCES, 2, 0.\n")));
    compare(&pulled, |[x, ..]| [3.0 / 200.0 * x, 0.0, 0.0]);
    let face =
        |answer: &Answer| answer.resultants().unwrap().iter().find(|one| one.of == "rigid-faces[0]").unwrap().clone();
    assert!((face(&pulled).motion.unwrap().displacement[0] - 0.045).abs() < 1e-12);
    // Rotations are directions 1 to 3 of the second node, or 4 to 6 of the first.
    let turns = "*BOUNDARY\n2001, 1, 1, 0.03\n2001, 2, 3\n2001, 5, 5\n2001, 6, 6, 0.01\n2002, 1, 1, 0.002\n";
    let motion = face(&answer(&(deck + &step(turns)))).motion.unwrap();
    assert_eq!((motion.displacement, motion.rotation), (vec![0.03, 0.0, 0.0], vec![0.002, 0.0, 0.01]));
}

/// A loaded set has a node of the part and the reference node of its rigid end, which belongs to the part as well: each
/// carries its force once.
#[test]
fn a_loaded_set_with_a_reference_node_is_loaded_once() {
    let deck = two(["C3D8", "C3D8"]).replace("X0, 1\nY0, 2\nZ0, 3", "X0, 1, 3")
        + "*TIE, NAME=T\nSLAVE, MASTER\n*RIGID BODY, NSET=END, REF NODE=1006\n*NSET, NSET=LOADED\n1006, 5\n";
    let [set, single] = ["LOADED, 1, 1.\n", "1006, 1, 1.\n5, 1, 1.\n"]
        .map(|lines| answer(&(deck.clone() + &step(&format!("*CLOAD\n{lines}")))));
    assert_eq!(set.displacement(), single.displacement());
}

#[test]
fn ties_that_cannot_be_read_are_refused_with_their_line() {
    let deck = two(["C3D8", "C3D8"]);
    let last = 1 + deck.matches('\n').count();
    for (cards, line, phrase) in [
        ("*TIE, NAME=T\nSLAVE, MASTR\n", 1, "there is no surface `MASTR`"),
        ("*TIE, NAME=T, POSITION TOLERANCE=-1\nSLAVE, MASTER\n", 0, "POSITION TOLERANCE=-1 is not read"),
        ("*TIE, NAME=T\nSLAVE, FACE\n", 1, "no facet of `body-2.SLAVE` faces `body-2.FACE`"),
        ("*EQUATION\n2\n1, 1, 1.\n", 1, "the equation has 1 terms, not 2"),
        ("*EQUATION\n1\n1, 4, 1.\n", 2, "4 is no displacement of a node here; there are 1 to 3"),
        ("*EQUATION\n1\n999, 1, 1.\n", 2, "the deck has no node 999"),
        ("*EQUATION\n0\n", 1, "the equation has no term"),
        ("*RIGID BODY, NSET=END\n", 0, "no reference node; write REF NODE=NUMBER"),
        ("*RIGID BODY, NSET=END, REF NODE=9999\n", 0, "the deck has no node 9999"),
        (
            "*RIGID BODY, NSET=END, REF NODE=1\n*TRANSFORM, NSET=Z0\n1., 0., 0., 0., 1., 0.\n",
            1,
            "node 1 is the reference of a rigid body",
        ),
        (
            "*NODE\n5000, 0., 0., 0.\n*SURFACE, NAME=INNER\n1, S4\n3, S4\n5, S4\n7, S4\n*PRE-TENSION SECTION, SURFACE=INNER, NODE=5000\n\
             *RIGID BODY, NSET=END, REF NODE=5000\n",
            8,
            "node 5000 is the reference of two rigid bodies, or of a bolt too",
        ),
        ("*RIGID BODY, ELSET=NOWHERE, REF NODE=1\n", 0, "there is no set of elements `NOWHERE`"),
        ("*RIGID BODY, REF NODE=1\n", 0, "is read with one set, of nodes or of elements"),
        ("*RIGID BODY, NSET=END, REF NODE=1, ROT NODE=1\n", 0, "ROT NODE must be a node of its own"),
    ] {
        let (at, message) = refusal(&(deck.clone() + cards + &step("*CLOAD\nEND, 1, 1.\n")));
        assert!(at == last + line && message.contains(phrase), "{cards}: {at} of {last}: {message}");
    }
}

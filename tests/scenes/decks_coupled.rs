//! Decks whose nodes follow reference nodes, which belong to no element, or are joined by springs and constraints.

use signorini::scene::Answer;
use support::decks::Block;

use crate::decks::{answer, compare, read, refusal, step};

const E: f64 = 200.0;

/// A bar from the origin to (2, 1, 1), or (2, 1) in the plane, of Young's modulus 200, held at x = 0, y = 0, z = 0
/// against displacements across these planes, with the nodes 9001 and 9002 in the middle of its end and 9003 at (3,
/// 1/2, 1/2).
fn bar(element: &'static str, cells: [usize; 3], poisson: f64, held: &str) -> String {
    let z = if element.starts_with("C3D") { 1.0 } else { 0.0 };
    let mesh = Block { element, low: [0.0; 3], high: [2.0, 1.0, z], cells, after: 0 }.mesh();
    let mut deck = mesh.cards("BAR");
    for (axis, name) in ["X0", "Y0", "Z0"].into_iter().enumerate() {
        deck += &mesh.set(name, |at| at[axis] == 0.0);
    }
    deck += &mesh.set("END", |at| at[0] == 2.0);
    deck += &mesh.surface("FACE", |at| at[0] == 2.0);
    deck += &format!("*NODE, NSET=REFERENCES\n9001, 2., 0.5, {0}\n9002, 2., 0.5, {0}\n9003, 3., 0.5, {0}\n", z / 2.0);
    deck += "*SURFACE, NAME=NODES, TYPE=NODE\nEND\n";
    deck += &format!("*MATERIAL, NAME=STEEL\n*ELASTIC\n{E}, {poisson}\n*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n");
    deck + "*BOUNDARY\n" + held
}

const SYMMETRIC: &str = "X0, 1\nY0, 2\nZ0, 3\n";

fn stretched(answer: &Answer, strain: f64) {
    compare(answer, |[x, y, z]| [strain * x, -0.25 * strain * y, -0.25 * strain * z]);
}

/// The equations that let all nodes of the end follow node 9001 along x.
fn following(cells: [usize; 3]) -> String {
    let mesh = Block { element: "C3D8", low: [0.0; 3], high: [2.0, 1.0, 1.0], cells, after: 0 }.mesh();
    let end = mesh.nodes.iter().filter(|(_, at)| at[0] == 2.0);
    let of_node = |(number, _): &(usize, [f64; 3])| format!("2\n{number}, 1, 2., 9001, 1, -2.\n");
    String::from("*EQUATION\n") + &end.map(of_node).collect::<String>()
}

/// A force on a reference node acts on all that follows it; a displacement moves it. Node 9002 moves twice as far as
/// node 9001, so that half of the force does the same work.
#[test]
fn nodes_follow_a_reference_node_of_equations() {
    let deck = bar("C3D8", [2, 2, 2], 0.25, SYMMETRIC) + &following([2, 2, 2]);
    let chain = "*EQUATION\n2\n9002, 1, 1., 9001, 1, -2.\n";
    for cards in ["*CLOAD\n9001, 1, 3.\nREFERENCES, 2, 0.\n", "*BOUNDARY\n9001, 1, 1, 0.03\n9003, 1, 6, 0.5\n"] {
        stretched(&answer(&(deck.clone() + &step(cards))), 3.0 / E);
    }
    for cards in ["*CLOAD\n9002, 1, 1.\n9002, 1, 0.5\n", "*BOUNDARY\n9002, 1, 1, 0.06\n*CLOAD\n9002, 1, 7.\n"] {
        stretched(&answer(&(deck.clone() + chain + &step(cards))), 3.0 / E);
    }
    // Local axes of a reference node: direction 2 is -x.
    let turned = "*TRANSFORM, NSET=REFERENCES\n0., 1., 0., -1., 0., 0.\n";
    let deck = deck.replace("9001, 1, -2.", "9001, 2, 2.") + turned;
    stretched(&answer(&(deck + &step("*CLOAD\n9001, 2, -3.\n"))), 3.0 / E);
}

/// In the plane direction 3 of a ROT NODE is the rotation, as direction 6 of its reference node is. Of other nodes it
/// is the displacement that a plane model does not have.
#[test]
fn direction_3_of_a_rotation_node_turns_a_plane_rigid_body() {
    let rigid = "*RIGID BODY, NSET=END, REF NODE=9001, ROT NODE=9002\n";
    let equation = "*EQUATION\n2\n9001, 1, 1., 9003, 1, -1.\n";
    for more in ["", equation] {
        let deck = bar("CPS4", [2, 2, 0], 0.25, "X0, 1, 2\n") + rigid + more;
        let turned = |cards: &str| {
            answer(&(deck.clone() + &step(&format!("*BOUNDARY\n9001, 1, 2\n{cards}")))).displacement().to_vec()
        };
        let [by_node, by_reference, held] = ["9002, 3, 3, 0.01\n", "9001, 6, 6, 0.01\n", "9002, 3\n"].map(turned);
        let off = by_node.iter().zip(&by_reference).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max);
        assert!(off < 1e-15 && by_node.iter().any(|u| u.abs() > 4e-3) && held.iter().all(|u| u.abs() < 1e-15), "{off}");
    }
    let deck = bar("CPS4", [1, 1, 0], 0.25, "X0, 1, 2\n");
    for cards in ["END, 3, 3, 0.01\n", "9003, 3, 3, 0.01\n"] {
        let (_, message) = refusal(&(deck.clone() + &step(&format!("*BOUNDARY\n{cards}"))));
        assert!(message.contains("a plane model has no displacement along z"), "{message}");
    }
}

/// The end follows along x only, and may narrow; a moment bends the bar as a beam, exactly for elements with quadratic
/// displacements.
#[test]
fn a_kinematic_coupling_leaves_directions_free() {
    for (element, cells) in [("C3D4", [2, 2, 2]), ("C3D20", [2, 1, 1]), ("CPS4", [2, 2, 0]), ("CPS8", [2, 2, 0])] {
        for surface in ["FACE", "NODES"] {
            let coupling =
                format!("*COUPLING, CONSTRAINT NAME=C, REF NODE=9001, SURFACE={surface}\n*KINEMATIC\n1, 1\n");
            let deck = bar(element, cells, 0.25, SYMMETRIC) + &coupling;
            stretched(&answer(&(deck.clone() + &step("*CLOAD\n9001, 1, 3.\n"))), 3.0 / E);
            stretched(&answer(&(deck + &step("*BOUNDARY\n9001, 1, 1, 0.03\n9001, 5, 6\n"))), 3.0 / E);
        }
    }
    let deck = bar("C3D20", [2, 1, 1], 0.0, "X0, 1, 3\n")
        + "*COUPLING, CONSTRAINT NAME=C, REF NODE=9001, SURFACE=FACE\n*KINEMATIC\n1\n";
    let curvature = 0.5 / (E / 12.0);
    for cards in [String::from("*CLOAD\n9001, 6, 0.5\n"), format!("*BOUNDARY\n9001, 6, 6, {:e}\n", 2.0 * curvature)] {
        let bent = answer(&(deck.clone() + &step(&cards)));
        compare(&bent, |[x, y, _]| [-curvature * x * (y - 0.5), curvature * x * x / 2.0, 0.0]);
    }
}

/// All directions make a rigid body; with an equation at the reference node too, or with another coupling.
#[test]
fn a_kinematic_coupling_of_all_directions_is_a_rigid_body() {
    const COUPLING: &str = "*COUPLING, CONSTRAINT NAME=C, REF NODE=9001, SURFACE=FACE\n*KINEMATIC\n";
    for element in ["C3D8", "C3D20", "CPE4"] {
        let cells = if element == "CPE4" { [2, 2, 0] } else { [2, 1, 1] };
        let deck = bar(element, cells, 0.0, "X0, 1, 3\n");
        let equation = "*EQUATION\n2\n9001, 1, 1., 9002, 1, -1.\n";
        for (directions, nodes, more, pulled) in [
            ("1, 3\n", "FACE", "", "9001"),
            ("", "FACE", "", "9001"),
            ("1\n2, 6\n", "NODES", "", "9001"),
            ("1, 6\n", "FACE", equation, "9002"),
            ("1, 3\n", "NODES", equation, "9002"),
        ] {
            let coupling = COUPLING.replace("=FACE", &format!("={nodes}")) + directions + more;
            let answer = answer(&(deck.clone() + &coupling + &step(&format!("*CLOAD\n{pulled}, 1, 3.\n"))));
            compare(&answer, |[x, ..]| [3.0 / E * x, 0.0, 0.0]);
            let is_face = answer.resultants().unwrap().iter().any(|one| one.of == "rigid-faces[0]");
            assert_eq!(is_face, more.is_empty(), "{element} {coupling}");
        }
    }
}

/// A force in the middle is spread as a traction; a displacement of the reference node is the mean of those of the
/// surface.
#[test]
fn a_distributing_coupling_spreads_a_force_over_areas() {
    for (element, cells) in [
        ("C3D4", [2, 2, 2]),
        ("C3D8", [2, 2, 2]),
        ("C3D10", [2, 2, 2]),
        ("C3D20", [2, 2, 2]),
        ("CPS3", [2, 2, 0]),
        ("CPS8", [2, 2, 0]),
    ] {
        let deck = bar(element, cells, 0.25, SYMMETRIC)
            + "*COUPLING, CONSTRAINT NAME=C, REF NODE=9003, SURFACE=FACE\n*DISTRIBUTING\n1, 6\n";
        stretched(&answer(&(deck.clone() + &step("*CLOAD\n9003, 1, 3.\n"))), 3.0 / E);
        stretched(&answer(&(deck + &step("*BOUNDARY\n9003, 1, 1, 0.03\n"))), 3.0 / E);
    }
}

/// One brick: a quarter of the force on each corner of the unit square, and the moment M about z of the middle as
/// forces -M (y - 1/2) along x; the moment of a force is that about the middle.
#[test]
fn a_distributing_coupling_spreads_a_moment_as_forces_that_grow_with_the_distance() {
    let deck = bar("C3D8", [1, 1, 1], 0.25, "X0, 1, 3\n");
    let coupled = deck.clone() + "*COUPLING, CONSTRAINT NAME=C, REF NODE=9003, SURFACE=FACE\n*DISTRIBUTING\n1, 6\n";
    let corners = Block { element: "C3D8", low: [0.0; 3], high: [2.0, 1.0, 1.0], cells: [1; 3], after: 0 }.mesh().nodes;
    for (load, moment, force) in [("9003, 6, 0.7", 0.7, 0.0), ("9003, 2, 0.4", 0.4, 0.1)] {
        let mut cards = String::from("*CLOAD\n");
        for (number, at) in corners.iter().filter(|(_, at)| at[0] == 2.0) {
            cards += &format!("{number}, 1, {:e}\n{number}, 2, {force}\n", -moment * (at[1] - 0.5));
        }
        let by_hand = answer(&(deck.clone() + &step(&cards)));
        let spread = answer(&(coupled.clone() + &step(&format!("*CLOAD\n{load}\n"))));
        let displacement = |at: usize| by_hand.displacement()[at];
        let nodes = by_hand.model().mesh().nodes().to_vec();
        let place = |at: [f64; 3]| nodes.iter().position(|node| *node == at).unwrap();
        compare(&spread, |at| [0, 1, 2].map(|axis| displacement(3 * place(at) + axis)));
        // The mean rotation is (u_x below - u_x above) of the means at y = 0 and y = 1; prescribed, it gives the same
        // answer.
        let mean = |y: f64| {
            let own = nodes.iter().enumerate().filter(|(_, at)| at[0] == 2.0 && at[1] == y);
            own.map(|(node, _)| displacement(3 * node) / 2.0).sum::<f64>()
        };
        if force == 0.0 {
            let turn = step(&format!("*BOUNDARY\n9003, 6, 6, {:e}\n", mean(0.0) - mean(1.0)));
            compare(&answer(&(coupled.clone() + &turn)), |at| [0, 1, 2].map(|axis| displacement(3 * place(at) + axis)));
        }
    }
}

#[test]
fn couplings_that_cannot_be_read_are_refused_with_their_line() {
    let deck = bar("C3D8", [1, 1, 1], 0.25, SYMMETRIC);
    let last = 1 + deck.matches('\n').count();
    const COUPLING: &str = "*COUPLING, CONSTRAINT NAME=C, REF NODE=9001, SURFACE=FACE\n";
    let coupled = |of: &str| format!("{COUPLING}{of}");
    let along_x = coupled("*KINEMATIC\n1\n");
    for (cards, load, line, phrase) in [
        (COUPLING.into(), "", 0, "*KINEMATIC or *DISTRIBUTING must follow *COUPLING"),
        ("*KINEMATIC\n1, 3\n".into(), "", 0, "*KINEMATIC must follow *COUPLING"),
        (along_x.replace("9001", "99"), "", 0, "the deck has no node 99"),
        (along_x.replace("9001", "END"), "", 0, "the set `END` is no reference node"),
        (along_x.replace("REF NODE=9001, ", ""), "", 0, "no reference node; write REF NODE=NUMBER"),
        (along_x.replace(", SURFACE=FACE", ""), "", 0, "no surface; write SURFACE=NAME"),
        (along_x.replace("=FACE", "=FACES"), "", 0, "there is no surface `FACES`"),
        (along_x.replace("CONSTRAINT NAME=C", "ORIENTATION=O"), "", 0, "the parameter ORIENTATION, which is not read"),
        (coupled("*KINEMATIC\n4, 6\n"), "", 1, "*KINEMATIC names no direction 1, 2 or 3"),
        (coupled("*KINEMATIC\n3, 1\n"), "", 2, "directions 3 to 1 are none"),
        (coupled("*DISTRIBUTING\n"), "", 1, "*DISTRIBUTING names no directions"),
        (coupled("*DISTRIBUTING, CYCLIC SYMMETRY\n1, 3\n"), "", 1, "CYCLICSYMMETRY, which is not read"),
        (
            along_x.clone(),
            "*CLOAD\n9001, 2, 1.\n",
            6,
            "node 9001 belongs to no element, and nothing follows its direction 2",
        ),
        (
            String::new(),
            "*CLOAD\n9003, 1, 1.\n",
            3,
            "node 9003 belongs to no element, and nothing follows its direction 1",
        ),
        (
            String::from("*EQUATION\n2\n9001, 1, 1., 9002, 1, 1.\n"),
            "*CLOAD\n9001, 1, 1.\n",
            1,
            "the reference point `9002` is free in `x`; it carries no force there",
        ),
        (
            String::from("*EQUATION\n2\n9001, 1, 1., 9002, 1, 1.\n"),
            "*BOUNDARY\n9001, 1, 1, 0.5\n9002, 1\n",
            1,
            "the displacements that are prescribed at reference points contradict this equation",
        ),
    ] {
        let load = if load.is_empty() { "*CLOAD\nEND, 1, 1.\n" } else { load };
        let (at, message) = refusal(&(deck.clone() + &cards + &step(load)));
        assert!(at == last + line && message.contains(phrase), "{cards}: {at} of {last}: {message}");
    }
}

/// GOAL: a bar on a spring, by the spring elements of a deck.
/// CONDITIONS: the plate at the end of a bar of stiffness EA/L = 100 on a spring of 50, which node 9003 holds at a
/// distance 1.
/// REFERENCE: springs in parallel under a force, and in series under a displacement of node 9003.
#[test]
fn springs_hold_a_bar_as_in_closed_form() {
    let deck = bar("C3D8", [2, 2, 2], 0.25, SYMMETRIC) + &following([2, 2, 2]) + "*BOUNDARY\n9003, 1, 3\n";
    for (element, directions) in [("SPRINGA", ""), ("SPRING1", "1\n"), ("SPRING2", "1, 1\n")] {
        let nodes = if element == "SPRING1" { "9001" } else { "9001, 9003" };
        let spring = format!(
            "*ELEMENT, TYPE={element}, ELSET=S\n501, {nodes}\n*ELSET, ELSET=ALSO\nS\n*SPRING, ELSET=ALSO\n{directions}50., 0.\n"
        );
        stretched(&answer(&(deck.clone() + &spring + &step("*CLOAD\n9001, 1, 6.\n"))), 0.02);
        if element != "SPRING1" {
            stretched(&answer(&(deck.clone() + &spring + &step("*BOUNDARY\n9003, 1, 1, 0.06\n"))), 0.01);
        }
    }
}

/// Four springs of 25 over a gap of 1/2 join two bars; without them nothing holds the second one along x.
#[test]
fn springs_join_two_bodies() {
    let [first, second] = [[0.0, 2.0], [2.5, 3.5]].map(|[low, high]| {
        let after = if low == 0.0 { 0 } else { 100 };
        Block { element: "C3D8", low: [low, 0.0, 0.0], high: [high, 1.0, 1.0], cells: [1; 3], after }.mesh()
    });
    let mut deck = first.cards("BAR") + &second.cards("BAR") + &first.set("X0", |at| at[0] == 0.0);
    for (axis, name) in [(1, "Y0"), (2, "Z0")] {
        deck += &(first.set(name, |at| at[axis] == 0.0) + &second.set(name, |at| at[axis] == 0.0));
    }
    deck += &second.surface("FACE", |at| at[0] == 3.5);
    deck += "*MATERIAL, NAME=STEEL\n*ELASTIC\n200., 0.25\n*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n";
    let mut springs = String::from("*ELEMENT, TYPE=SPRINGA, ELSET=S\n");
    for (number, (one, at)) in first.nodes.iter().filter(|(_, at)| at[0] == 2.0).enumerate() {
        let is_opposite = |other: &&(usize, [f64; 3])| other.1 == [2.5, at[1], at[2]];
        springs += &format!("{}, {one}, {}\n", 900 + number, second.nodes.iter().find(is_opposite).unwrap().0);
    }
    springs += "*SPRING, ELSET=S\n25.\n";
    let pulled = step("*DSLOAD\nFACE, P, -3.\n");
    let answer = answer(&(deck.clone() + &springs + &pulled));
    compare(&answer, |[x, y, z]| {
        let strain = 3.0 / E;
        let along = if x <= 2.0 { strain * x } else { strain * (x - 0.5) + 3.0 / 100.0 };
        [along, -0.25 * strain * y, -0.25 * strain * z]
    });
    assert!(answer.forces().unwrap().balance < 1e-12);
    // A spring within the second bar holds nothing.
    let within = format!("*ELEMENT, TYPE=SPRINGA, ELSET=S\n900, 101, 102\n*SPRING, ELSET=S\n25.\n{pulled}");
    for loose in [deck.clone() + &pulled, deck.clone() + &within] {
        let error = read(&[("deck.inp", &loose)], &[]).unwrap_err().to_string();
        assert!(error.contains("body-2"), "{error}");
    }
}

/// A bar that two opposite forces at the corners of its end bend: the end stays flat as with a coupling; in the plane
/// its edge stays straight. A link along x moves the plate of another bar.
#[test]
fn constraints_keep_nodes_in_a_plane_on_a_line_and_at_a_distance() {
    let curvature = |inertia: f64| 0.5 / (E * inertia);
    for (element, cells, constraint, forces) in [
        ("C3D20", [2, 1, 1], "PLANE, END", "BELOW, 1, 0.25\nABOVE, 1, -0.25\n"),
        ("CPS8", [2, 2, 0], "STRAIGHT, END", "BELOW, 1, 0.5\nABOVE, 1, -0.5\n"),
        ("CPS8", [2, 2, 0], "STRAIGHT, ABOVE, BELOW, 0,\nEND", "BELOW, 1, 0.5\nABOVE, 1, -0.5\n"),
    ] {
        let z = if element == "C3D20" { 1.0 } else { 0.0 };
        let mesh = Block { element, low: [0.0; 3], high: [2.0, 1.0, z], cells, after: 0 }.mesh();
        let corner = |y: f64| move |at: [f64; 3]| at[0] == 2.0 && at[1] == y && (at[2] == 0.0 || at[2] == 1.0);
        let sets = mesh.set("BELOW", corner(0.0)) + &mesh.set("ABOVE", corner(1.0));
        let deck = bar(element, cells, 0.0, "X0, 1, 3\n") + &sets + &format!("*MPC\n{constraint}\n");
        let bent = answer(&(deck + &step(&format!("*CLOAD\n{forces}"))));
        let curvature = curvature(1.0 / 12.0);
        compare(&bent, |[x, y, _]| [-curvature * x * (y - 0.5), curvature * x * x / 2.0, 0.0]);
    }
    let deck = bar("C3D8", [2, 2, 2], 0.25, SYMMETRIC) + &following([2, 2, 2]) + "*MPC\nBEAM, 9001, 9003\n";
    let moved = step("*BOUNDARY\n9003, 1, 1, 0.03\n9003, 2, 3\n");
    let scene = read(&[("deck.inp", &(deck.clone() + &moved))], &[]).unwrap();
    assert!(scene.noted[0].to_string().contains("BEAM of *MPC is answered by linear equations"), "{:?}", scene.noted);
    stretched(&answer(&(deck + &moved)), 3.0 / E);
}

#[test]
fn springs_and_constraints_that_cannot_be_read_are_refused_with_their_line() {
    let deck = bar("C3D8", [1, 1, 1], 0.25, SYMMETRIC);
    let last = 1 + deck.matches('\n').count();
    let spring = |of_type: &str, nodes: &str, values: &str| {
        format!("*ELEMENT, TYPE={of_type}, ELSET=S\n501, {nodes}\n*SPRING, ELSET=S\n{values}")
    };
    let grounded = spring("SPRING1", "9001", "1\n5.\n");
    for (cards, line, phrase) in [
        (grounded.clone(), 1, "the reference point `9001` is free in `x`; nothing but springs holds it"),
        (grounded.replace("*SPRING, ", "*SPRING, NONLINEAR, "), 2, "the parameter NONLINEAR, which is not read"),
        (grounded.replace("*SPRING, ELSET=S", "*SPRING, ELSET=T"), 2, "there is no set of elements `T`"),
        (grounded.replace("*SPRING, ELSET=S", "*SPRING"), 2, "*SPRING names no elements"),
        (grounded.replace("501, 9001", "501, 99"), 1, "element 501 names node 99, which does not exist"),
        (grounded.replace("501, 9001", "1, 9001"), 1, "element 1 is given twice"),
        (grounded.replace("1\n5.", "4\n5."), 3, "4 is no displacement of a node here; there are 1 to 3"),
        (grounded.replace("1\n5.", "1\n-5."), 4, "the stiffness of a spring must be positive"),
        (grounded.replace("1\n5.", "5."), 2, "*SPRING of SPRING1 and SPRING2 has two lines"),
        (spring("SPRINGA", "9001, 9003", "1.\n2.\n"), 2, "*SPRING of SPRINGA has one line"),
        (spring("SPRINGA", "9001, 9002", "1.\n"), 1, "the two nodes of this spring lie at one place"),
        ("*ELEMENT, TYPE=SPRING1, ELSET=S\n501, 1\n".into(), 1, "this spring has no stiffness"),
        ("*MPC\n".into(), 0, "*MPC has no line"),
        (
            "*MPC\nMEANROT, 1, 1, 1\n".into(),
            0,
            "MEANROT of *MPC is not read; there are PLANE, STRAIGHT and BEAM: the mean",
        ),
        ("*MPC\nDIST, 1, 2\n".into(), 0, "a bound of the distance of two nodes is no equation"),
        ("*MPC\nWOBBLE, 1, 2\n".into(), 0, "WOBBLE of *MPC is not read; there are PLANE, STRAIGHT and BEAM"),
        ("*MPC\nBEAM, 1, 2, 3\n".into(), 0, "BEAM of *MPC joins two nodes, not 3"),
        ("*MPC\nBEAM, 9001, 9002\n".into(), 0, "the nodes of BEAM of *MPC lie at one place"),
        ("*MPC\nPLANE\n".into(), 0, "PLANE of *MPC names no node"),
        ("*MPC\nPLANE, 9001, 9002, 9003\n".into(), 0, "lie on a line, which is in many planes"),
        ("*MPC\nPLANE, 1, 2, 3, 4, 5\n".into(), 0, "does not lie in the plane of the other nodes"),
        ("*MPC\nSTRAIGHT, 1, 2, 3\n".into(), 0, "does not lie on the line of the other nodes"),
    ] {
        let (at, message) = refusal(&(deck.clone() + &cards + &step("*CLOAD\nEND, 1, 1.\n")));
        assert!(at == last + line && message.contains(phrase), "{cards}: {at} of {last}: {message}");
    }
    let plane = bar("CPS4", [1, 1, 0], 0.25, SYMMETRIC);
    for (cards, phrase) in [
        ("*MPC\nPLANE, END\n", "PLANE of *MPC is read in space only"),
        (
            "*TRANSFORM, NSET=REFERENCES\n0., 1., 0., -1., 0., 0.\n*MPC\nBEAM, 9001, 9003\n",
            "read here without *TRANSFORM only",
        ),
    ] {
        let (_, message) = refusal(&(plane.clone() + cards + &step("*CLOAD\nEND, 1, 1.\n")));
        assert!(message.contains(phrase), "{cards}: {message}");
    }
}

//! Decks with bolts: *PRE-TENSION SECTION cuts a body and draws its parts together.

use support::decks::Block;

use crate::decks::{answer, refusal, step};

const MATERIAL: &str =
    "*MATERIAL, NAME=STEEL\n*ELASTIC\n200., 0.\n*EXPANSION\n1E-5\n*SOLID SECTION, ELSET=PART, MATERIAL=STEEL\n";

/// A bar (3, 1, 1), or (3, 1) in the plane, held at both ends along x, at y = 0 and at z = 0, with the surface CUT at x
/// = 1 on the elements before it, and a reference node 5000.
fn bar(element: &'static str) -> String {
    let is_plane = !element.starts_with("C3D");
    let (high, cells) = if is_plane { ([3.0, 1.0, 0.0], [3, 2, 0]) } else { ([3.0, 1.0, 1.0], [3, 2, 2]) };
    let mesh = Block { element, low: [0.0; 3], high, cells, after: 0 }.mesh();
    let places: std::collections::HashMap<usize, [f64; 3]> = mesh.nodes.iter().copied().collect();
    let is_before = |number: usize| {
        let (_, nodes) = mesh.elements.iter().find(|own| own.0 == number).unwrap();
        nodes.iter().all(|node| places[node][0] <= 1.0)
    };
    let cut = mesh.faces(|at| at[0] == 1.0).into_iter().filter(|&(element, _)| is_before(element));
    let cut: String = cut.map(|(element, face)| format!("{element}, S{face}\n")).collect();
    mesh.cards("PART")
        + &mesh.set("ENDS", |at| at[0] == 0.0 || at[0] == 3.0)
        + &mesh.set("SIDE", |at| at[1] == 0.0)
        + &mesh.set("LOW", |at| at[2] == 0.0)
        + &mesh.set("CORNER", |at| at == [1.0, 1.0, high[2]])
        + &mesh.surface("OUTSIDE", |at| at[0] == 3.0)
        + "*NODE, NSET=BOLT\n5000, 0., 0., 0.\n*SURFACE, NAME=CUT\n"
        + &cut
        + MATERIAL
        + "*BOUNDARY\nENDS, 1\nSIDE, 2\nLOW, 3\n"
}

const PRELOAD: &str = "*PRE-TENSION SECTION, SURFACE=CUT, NODE=5000\n";

/// GOAL: a bolt between fixed walls, by *PRE-TENSION SECTION.
/// CONDITIONS: a bar of length 3; the tension 3, its shortening 3 x 3 / 200, and a cooler bar, which is drawn by less.
/// REFERENCE: a uniform strain: the parts move towards the cut.
#[test]
fn a_bolt_between_walls_has_the_displacements_of_closed_form() {
    for element in ["C3D4", "C3D8", "C3D10", "C3D20", "CPE4", "CPS8"] {
        for (direction, load, strain) in [
            ("", "*CLOAD\nBOLT, 1, 3.\n", 0.015),
            ("2., 0., 0.\n", "*CLOAD\n5000, 1, 1.\n5000, 1, 2.\n", 0.015),
            ("-1., 0., 0.\n", "*CLOAD\n5000, 1, -3.\n", 0.015),
            ("", "*BOUNDARY\n5000, 1, 1, 0.045\n5000, 2, 3\n*CLOAD\n5000, 1, 7.\n", 0.015),
            ("", "*TEMPERATURE\nALL, -750.\n*CLOAD\n5000, 1, 3.\n", 0.0075),
        ] {
            let answer = answer(&(bar(element) + PRELOAD + direction + &step(load)));
            let mesh = answer.model().mesh();
            let (dimension, numbers) = (mesh.dimension(), mesh.node_numbers().unwrap());
            for (node, (&[x, y, z], number)) in mesh.nodes().iter().zip(numbers).enumerate() {
                // The elements before the cut have the nodes with numbers after all others.
                let is_before = x < 1.0 || (x == 1.0 && number > 5000);
                let along = strain * if is_before { x } else { x - 3.0 };
                let exact = [along, (strain - 0.015) * y, (strain - 0.015) * z];
                for axis in 0..dimension {
                    let found = answer.displacement()[dimension * node + axis];
                    let away = (found - exact[axis]).abs();
                    assert!(away < 1e-10 * strain, "{element}, {load}: {found} instead of {exact:?} at node {number}");
                }
            }
            let tie = answer.resultants().unwrap().iter().find(|one| one.of == "ties[0]").unwrap();
            assert!((tie.force[0].abs() - 3.0).abs() < 1e-9, "{element}, {load}: {tie:?}");
            assert!(
                (tie.shortening.unwrap().abs() - 3.0 * strain).abs() < 1e-10 * strain,
                "{element}, {load}: {tie:?}"
            );
        }
    }
}

/// Drawn together by nothing, a cut bar is the whole bar: under a pressure, its weight, a force on a node of the cut,
/// and a support of nodes of the cut.
#[test]
fn a_cut_without_a_shortening_changes_nothing() {
    const LOADS: &str = "*DSLOAD\nOUTSIDE, P, 5.\n*DLOAD\nPART, GRAV, 2., 0., 1., 3.\n*CLOAD\nCORNER, 2, 0.7\n";
    for element in ["C3D4", "C3D8", "C3D10", "C3D20"] {
        let whole = bar(element)
            .replace("200., 0.\n", "200., 0.3\n*DENSITY\n0.4\n")
            .replace("ENDS, 1, 3", "ENDS, 1, 3\nLOW, 3");
        let [cut, whole] = [PRELOAD, ""].map(|cut| {
            let closed = if cut.is_empty() { "" } else { "*BOUNDARY\nBOLT, 1\n" };
            answer(&(whole.clone() + cut + closed + &step(LOADS)))
        });
        let largest = whole.displacement().iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
        for (node, at) in cut.model().mesh().nodes().iter().enumerate() {
            let other = whole.model().mesh().nodes().iter().position(|other| other == at).unwrap();
            for axis in 0..3 {
                let [one, two] = [(&cut, node), (&whole, other)].map(|(of, node)| of.displacement()[3 * node + axis]);
                assert!((one - two).abs() < 1e-10 * largest, "{element}: {one} and {two} at {at:?}");
            }
        }
    }
}

/// A square ring of eight cubes, cut at one place, with its hole around the origin: it stays one body, whose faces of
/// the cut are drawn over each other by the shortening, without a warning of nodes at one place.
#[test]
fn a_ring_is_drawn_together_at_its_cut() {
    let lattice: Vec<[usize; 3]> =
        (0..2).flat_map(|k| (0..4).flat_map(move |j| (0..4).map(move |i| [i, j, k]))).collect();
    let number = |at: [usize; 3]| 1 + lattice.iter().position(|own| *own == at).unwrap();
    let mut deck = String::from("*NODE, NSET=ALL\n");
    for at in &lattice {
        let [x, y, z] = at.map(|part| part as f64 - 1.5);
        deck += &format!("{}, {x:e}, {y:e}, {z:e}\n", number(*at));
    }
    deck += "*NODE\n5000, 0., 0., 0.\n*ELEMENT, TYPE=C3D8, ELSET=PART\n";
    for (element, [i, j]) in [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]].into_iter().enumerate() {
        let around = |k: usize| [[i, j, k], [i + 1, j, k], [i + 1, j + 1, k], [i, j + 1, k]].map(number);
        let nodes: Vec<String> = around(0).into_iter().chain(around(1)).map(|node| node.to_string()).collect();
        deck += &format!("{}, {}\n", element + 1, nodes.join(", "));
    }
    // The cut lies between the cubes 1 and 2, at x = -0.5; the cube on the other side is held.
    deck += "*SURFACE, NAME=CUT\n1, S4\n*MATERIAL, NAME=STEEL\n*ELASTIC\n200., 0.3\n*SOLID SECTION, ELSET=PART, MATERIAL=STEEL\n";
    deck += &format!(
        "*NSET, NSET=HELD\n{}, {}, {}, {}\n*BOUNDARY\nHELD, 1, 3\n",
        number([3, 3, 0]),
        number([3, 3, 1]),
        number([3, 2, 0]),
        number([3, 2, 1])
    );
    let answer = answer(&(deck + PRELOAD + &step("*BOUNDARY\n5000, 1, 1, 0.01\n")));
    assert!(answer.model().warnings().is_empty(), "{:?}", answer.model().warnings());
    let (mesh, numbers) = (answer.model().mesh(), answer.model().mesh().node_numbers().unwrap());
    let at = |number: usize| &answer.displacement()[3 * numbers.iter().position(|own| *own == number).unwrap()..][..3];
    let mut doubles = 0;
    for (node, &number) in numbers.iter().enumerate().filter(|(_, number)| **number > 5000) {
        let other =
            (0..numbers.len()).find(|&other| other != node && mesh.nodes()[other] == mesh.nodes()[node]).unwrap();
        let (own, across) = (at(number), at(numbers[other]));
        for (axis, drawn) in [0.01, 0.0, 0.0].into_iter().enumerate() {
            assert!((own[axis] - across[axis] - drawn).abs() < 1e-13, "{number}: {own:?} and {across:?}");
        }
        doubles += 1;
    }
    assert_eq!(doubles, 4);
}

#[test]
fn bolts_that_cannot_be_read_are_refused_with_their_line() {
    let deck = bar("C3D8");
    let last = 1 + deck.matches('\n').count();
    let load = "*CLOAD\nBOLT, 1, 1.\n";
    for (cards, load, line, phrase) in [
        ("*PRE-TENSION SECTION, NODE=5000\n", load, 0, "is read with a surface of faces; write SURFACE=NAME"),
        ("*PRE-TENSION SECTION, SURFACE=CUTT, NODE=5000\n", load, 0, "there is no surface `CUTT`; did you mean `CUT`?"),
        (
            "*PRE-TENSION SECTION, SURFACE=OUTSIDE, NODE=5000\n",
            load,
            0,
            "lies on the outside: a cut leads through a body",
        ),
        ("*PRE-TENSION SECTION, SURFACE=CUT\n", load, 0, "has no reference node; write NODE=NUMBER"),
        ("*PRE-TENSION SECTION, SURFACE=CUT, NODE=1\n", load, 0, "node 1 belongs to an element"),
        ("*PRE-TENSION SECTION, SURFACE=CUT, NODE=6000\n", load, 0, "the deck has no node 6000"),
        (
            "*PRE-TENSION SECTION, SURFACE=CUT, NODE=5000\n0., 0., 0.\n",
            load,
            1,
            "the direction of the bolt has no length",
        ),
        ("*PRE-TENSION SECTION, SURFACE=CUT, NODE=5000\n0., 1., 0.\n", load, 0, "lies along the faces of the cut"),
        (
            "*PRE-TENSION SECTION, ELEMENT=1, NODE=5000\n",
            load,
            0,
            "is read with a surface of faces; write SURFACE=NAME",
        ),
        (
            "*SURFACE, NAME=PART\n1, S4\n*PRE-TENSION SECTION, SURFACE=PART, NODE=5000\n",
            load,
            2,
            "does not cut through its body",
        ),
        (
            "*PRE-TENSION SECTION, SURFACE=CUT, NODE=5000\n*SURFACE, NAME=LONG\n1, S1\n12, S2\n*TIE, NAME=T\nLONG, OUTSIDE\n",
            load,
            5,
            "because *PRE-TENSION SECTION cuts their body at `CUT`; name a surface of each body",
        ),
        (PRELOAD, "*CLOAD\nBOLT, 2, 1.\n", 4, "direction 2 of this node is none of a bolt"),
        (PRELOAD, "*BOUNDARY\nBOLT, 3, 3, 1.\n", 4, "direction 3 of this node is none of a bolt"),
    ] {
        let (at, message) = refusal(&(deck.clone() + cards + &step(load)));
        assert!(at == last + line && message.contains(phrase), "{cards}{load}: {at} of {last}: {message}");
    }
}

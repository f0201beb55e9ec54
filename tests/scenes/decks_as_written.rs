//! What decks of other programs have in them, read as CalculiX reads it: each changes nothing but a warning, or has a
//! closed form.

use std::fs;

use support::decks::Block;

use crate::decks::{answer, compare, read};
use crate::decks_refused::CUBE;

/// The problem of a deck as text, and its warnings.
fn posed(deck: &str) -> (String, Vec<String>) {
    let scene = read(&[("deck.inp", deck)], &[]).unwrap_or_else(|error| panic!("{error}\n{deck}"));
    let problem = format!("{:?}", scene.build().unwrap().problem());
    fs::remove_dir_all(scene.folder.unwrap()).unwrap();
    (problem, scene.noted.iter().map(ToString::to_string).collect())
}

#[test]
fn what_calculix_passes_over_changes_the_warnings_alone() {
    let (plain, none) = posed(CUBE);
    assert!(none.is_empty(), "{none:?}");
    for (from, to, phrase) in [
        ("*CLOAD\n", "*OUTPUT, FREQUENCY=1,\n*CLOAD\n", "*OUTPUT ends in a comma, but no parameter follows"),
        ("*CLOAD\n", "*NODE PRINT, NSET=BASE,\nU\n*CLOAD\n", "*NODE PRINT ends in a comma"),
        ("*NODE, NSET=ALL\n", "*NODE, NSET=ALL,\n", "deck.inp:3: *NODE ends in a comma"),
        ("*STATIC\n", "*STATIC,\n", "*STATIC ends in a comma"),
        ("*NSET, NSET=BASE\n1, 2, 3, 4", "*NSET, NSET=BASE,\nGENERATE\n1, 4", ""),
        ("*HEADING\n", "\u{feff}*HEADING\n", ""),
        ("200., 0.3", "2.+2, 3.0-1", ""),
        (
            "8, 0., 1., 1.",
            "8, 0., 1., 3.\n8, 0., 1., 1.",
            "node 8 is given twice, 2.000000e0 apart; the last place counts",
        ),
        ("*ELASTIC\n", "*ELASTIC\n100., 0.2\n*ELASTIC\n", "the material has *ELASTIC twice; the last one counts"),
        ("6, 7, 8\n", "6, 7, 8, 9, 10, 11\n", "`9` follows the last value of this line; such values are passed over"),
        ("2, 1., 0., 0.", "2, 1., 0., 0., 7.", "`7.` follows the last value of this line; such values are passed over"),
        ("7, 3, -1.", "7, 3, -1., 4.", "`4.` follows the last value of this line; such values are passed over"),
        ("*END STEP\n", "*END STEP\nThe end\n", "deck.inp:29: this text follows the last *END STEP"),
        (
            "*NSET, NSET=BASE\n1, 2, 3, 4\n",
            "*ELEMENT, TYPE=T3D2, ELSET=EDGE\n21, 1, 2\n*ELEMENT, TYPE=CPS4, ELSET=FLOOR\n22, 1, 2, 3, 4\n*NSET, NSET=BASE, ELSET=FLOOR\n",
            "2 elements of CPS4, T3D2 lie on the body, no section names them: they are left out",
        ),
    ] {
        let (problem, warnings) = posed(&CUBE.replacen(from, to, 1));
        assert_eq!(problem, plain, "{to}");
        match phrase {
            "" => assert!(warnings.is_empty(), "{to}: {warnings:?}"),
            _ => assert!(warnings.len() == 1 && warnings[0].contains(phrase), "{to}: {warnings:?}"),
        }
    }
}

/// CalculiX loads it each time.
#[test]
fn a_member_that_a_set_has_twice_is_loaded_once_with_a_warning() {
    let force = CUBE.replace("*BOUNDARY\n", "*NSET, NSET=TIP\n7\n*NSET, NSET=TIP\n7\n*BOUNDARY\n");
    let (problem, warnings) = posed(&force.replace("7, 3, -1.", "TIP, 3, -1."));
    assert_eq!(problem, posed(CUBE).0);
    assert!(warnings.len() == 1 && warnings[0].contains("node 7 is in the set `TIP` several times"), "{warnings:?}");
    let pressed = CUBE.replace("*CLOAD\n7, 3, -1.", "*DLOAD\nPART, P2, 1.");
    let (problem, warnings) = posed(&pressed.replace("*BOUNDARY\n", "*ELSET, ELSET=PART\n1\n*BOUNDARY\n"));
    assert_eq!(problem, posed(&pressed).0);
    assert!(
        warnings.len() == 1 && warnings[0].contains("element 1 is in the set `PART` several times"),
        "{warnings:?}"
    );
}

#[test]
fn a_displacement_of_the_model_holds_in_every_step() {
    let [model, step] =
        [("*BOUNDARY\n", "*BOUNDARY\n5, 3, 3, 0.1\n"), ("*CLOAD\n", "*BOUNDARY\n5, 3, 3, 0.1\n*CLOAD\n")]
            .map(|(from, to)| posed(&CUBE.replacen(from, to, 1)).0);
    assert_eq!(model, step);
}

/// GOAL: the upper faces of all elements of a column are pressed, also those within it.
/// REFERENCE: each layer carries the pressures above it: u_z = -2 p z / E below, and half the strain above.
#[test]
fn faces_within_a_body_are_pressed() {
    let mesh = Block { element: "C3D8", low: [0.0; 3], high: [1.0, 1.0, 2.0], cells: [2, 1, 2], after: 0 }.mesh();
    let deck = mesh.cards("PART")
        + &mesh.set("BASE", |at| at[2] == 0.0)
        + "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.\n*SOLID SECTION, ELSET=PART, MATERIAL=M\n*BOUNDARY\nBASE, 1, 3\n\
           *STEP\n*STATIC\n*DLOAD\nPART, P2, 3.\n*END STEP\n";
    compare(&answer(&deck), |[_, _, z]| [0.0, 0.0, -3.0 / 200.0 * (z.min(1.0) + z)]);
}

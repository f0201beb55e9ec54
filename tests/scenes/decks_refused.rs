//! Decks that are refused: each error has the line, the name and a reason.

use std::fs;

use signorini::{Error, Scene, qp};

use crate::decks::read;

/// A cube of one element under a force.
pub const CUBE: &str = "*HEADING
A cube
*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=PART
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=BASE
1, 2, 3, 4
*SURFACE, NAME=TOP
PART, S2
*MATERIAL, NAME=STEEL
*ELASTIC
200., 0.3
*SOLID SECTION, ELSET=PART, MATERIAL=STEEL
*BOUNDARY
BASE, 1, 3
*STEP
*STATIC
*CLOAD
7, 3, -1.
*END STEP
";

/// The error of a deck, without the folder.
fn error(files: &[(&str, &str)]) -> (Error, String) {
    match read(files, &[]) {
        Err(error) => {
            let sentence = error.to_string();
            let name = sentence.split('/').next_back().unwrap_or_default().to_string();
            (error, if sentence.starts_with('/') { name } else { sentence })
        }
        Ok(scene) => panic!("accepted: {:?}", scene.folder),
    }
}

/// Replaces a text of the cube; the error must have the line of the change and the phrase.
fn check(from: &str, to: &str, phrase: &str) {
    let at = CUBE.find(from).unwrap_or_else(|| panic!("no {from:?}"));
    let deck = CUBE.replacen(from, to, 1);
    let (error, sentence) = error(&[("deck.inp", &deck)]);
    // The change begins in this line; a reason may lie some lines behind.
    let first = 1 + CUBE[..at].matches('\n').count();
    let Error::Linear(qp::LinearError::FileSyntax { line, ref message, .. }) = error else {
        panic!("{from:?} to {to:?}: {sentence}")
    };
    let last = first + to.matches('\n').count();
    assert!((first..=last).contains(&line), "{from:?} to {to:?}: {sentence} is not in lines {first} to {last}");
    assert!(message.contains(phrase), "{from:?} to {to:?}: {message}");
}

#[test]
fn what_changes_the_answer_and_is_not_modelled_is_refused_by_name_and_line() {
    for (card, phrase) in [
        ("*ORIENTATION, NAME=O", "*ORIENTATION has no values"),
        ("*ORIENTATION, NAME=O, SYSTEM=ODD\n1., 0., 0., 0., 1., 0.", "SYSTEM=ODD is not read"),
        ("*TRANSFORM, NSET=ALL", "*TRANSFORM has one line, with six numbers"),
        ("*TRANSFORM, NSET=ALL\n1., 0., 0., 2., 0., 0.", "the two vectors give no axes"),
        ("*TRANSFORM, NSET=ALL, TYPE=S\n1., 0., 0., 0., 1., 0.", "TYPE=S is not read; there are R and C"),
        ("*DISTRIBUTING COUPLING", "*DISTRIBUTING COUPLING changes the answer"),
        ("*PLASTIC", "*PLASTIC changes the answer and is refused: plasticity"),
        ("*SHELL SECTION, ELSET=PART", "*SHELL SECTION changes the answer and is refused: shells"),
        ("*BEAM SECTION, ELSET=PART", "*BEAM SECTION changes the answer and is refused: beams"),
        ("*DYNAMIC", "*DYNAMIC changes the answer"),
        ("*FREQUENCY", "*FREQUENCY changes the answer"),
        ("*PART, NAME=P", "parts and instances of Abaqus are not read"),
        ("*WOBBLE", "*WOBBLE is no keyword that is read; it may change the answer"),
        ("*NODE PRINTS", "*NODE PRINTS is no keyword that is read"),
        ("*CLOAD\n1, 3, 1.", "*CLOAD stands outside of the steps"),
        ("*MATERIAL, NAME=steel", "there are two materials `steel`"),
        ("*INITIAL CONDITIONS, TYPE=STRESS", "only *INITIAL CONDITIONS with TYPE=TEMPERATURE is read"),
    ] {
        check("*BOUNDARY", &format!("{card}\n*BOUNDARY"), phrase);
    }
    check("*END STEP\n", "*END STEP\n*CLOAD\n", "*CLOAD stands outside of the steps");
    check("*STEP\n", "*STEP, PERTURBATION\n", "*STEP has the parameter PERTURBATION, which is not read");
}

#[test]
fn wrong_cards_are_refused_with_their_line() {
    for (from, to, phrase) in [
        ("TYPE=C3D8,", "TYPE=S4R,", "the element type S4R is not read: shells are not modelled; there are C3D4, C3D8"),
        ("TYPE=C3D8,", "TYPE=C3D6,", "the element type C3D6 is not read: wedges are not modelled"),
        ("TYPE=C3D8,", "TYPE=B31,", "the element type B31 is not read: beams"),
        ("TYPE=C3D8, ", "", "*ELEMENT has no type"),
        ("1, 1, 2, 3, 4, 5, 6, 7, 8", "1, 1, 2, 3, 4, 5, 6, 7", "element 1 has 7 nodes, but C3D8 has 8"),
        ("1, 1, 2, 3, 4, 5, 6, 7, 8", "1, 1, 2, 3, 4, 5, 6, 7, 9", "element 1 names node 9, which does not exist"),
        ("1, 1, 2, 3, 4, 5, 6, 7, 8", "1, 5, 6, 7, 8, 1, 2, 3, 4", "element 1: "),
        ("8, 0., 1., 1.", "8, 0., one, 1.", "the y of node 8 is `one`; it must be a finite number"),
        ("8, 0., 1., 1.", "8, 0., 1e999, 1.", "the y of node 8 is `1e999`; it must be a finite number"),
        ("8, 0., 1., 1.", "eight, 0., 1., 1.", "the number of a node is `eight`; it must be a whole number"),
        ("1, 2, 3, 4\n", "1, 2, 3, 44\n", "the deck has no node 44"),
        ("1, 2, 3, 4\n", "1, 2, BASES\n", "there is no set of nodes `BASES` above this line"),
        ("NSET=BASE\n", "NSET=12\n", "a set of nodes is called 12; a name must not be a number"),
        ("NSET=BASE\n", "NSET=BASE, GENERATE\n", "`4` follows the last value of this line"),
        (
            "1, 2, 3, 4\n",
            "1, 2, 3, 4\n*NSET, NSET=G, GENERATE\n4, 1\n",
            "the range from 4 to 1 in steps of 1 has no number",
        ),
    ] {
        check(from, to, phrase);
    }
}

#[test]
fn wrong_materials_loads_and_steps_are_refused_with_their_line() {
    for (from, to, phrase) in [
        ("PART, S2", "PART, S7", "`S7` is no face of element 1; C3D8 has S1 to S6"),
        ("NAME=TOP", "NAME=TOP, TYPE=CUTTING", "a surface consists of faces (TYPE=ELEMENT) or of nodes (TYPE=NODE)"),
        ("200., 0.3", "200., 0.3, 20.\n100., 0.3, 200.", "values that depend on the temperature are not read"),
        (
            "*ELASTIC\n",
            "*ELASTIC, TYPE=ORTHO\n",
            "this type of *ELASTIC is not read; there are ISO and ENGINEERING CONSTANTS",
        ),
        ("200., 0.3", "200.", "Poisson's ratio is missing"),
        (
            "ELSET=PART, MATERIAL=STEEL",
            "ELSET=PART, MATERIAL=STEAL",
            "there is no material `STEAL`; did you mean `STEEL`?",
        ),
        ("ELSET=PART, MATERIAL=STEEL", "ELSET=PARTS, MATERIAL=STEEL", "there is no set of elements `PARTS`"),
        (
            "ELSET=PART, MATERIAL=STEEL",
            "ELSET=PART, MATERIAL=STEEL, COMPOSITE",
            "has the parameter COMPOSITE, which is not read",
        ),
        ("BASE, 1, 3", "BASE, 1, 7", "directions 1 to 7 are not those of a solid"),
        (
            "*STATIC\n",
            "*STATIC\n*END STEP\n*STEP\n*STATIC\n*BOUNDARY, FIXED\n7, 1\n",
            "FIXED holds the displacement at the end of step 1, which only `signorini ccx` knows",
        ),
        (
            "*NSET, NSET=BASE\n",
            "*ELEMENT, TYPE=T3D2, ELSET=BAR\n5, 1, 2\n*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n*NSET, NSET=BASE\n",
            "the element type T3D2 is not read: trusses are not modelled",
        ),
        (
            "*CLOAD\n7, 3, -1.",
            "*ELEMENT, TYPE=S4, ELSET=SKIN\n5, 5, 6, 7, 8\n*DLOAD\nSKIN, P1, 1.",
            "the set `SKIN` has no elements of a body",
        ),
        ("*BOUNDARY\n", "*BOUNDARY, TYPE=VELOCITY\n", "only displacements are prescribed in an equilibrium"),
        ("*BOUNDARY\n", "*BOUNDARY, OP=OLD\n", "OP of *BOUNDARY must be NEW or MOD"),
        ("*CLOAD\n", "*CLOAD, AMPLITUDE=A\n", "there is no amplitude `A`"),
        ("7, 3, -1.", "7, 4, -1.", "4 is no direction of a force here; there are 1 to 3"),
        ("7, 3, -1.", "77, 3, -1.", "the deck has no node 77"),
        ("7, 3, -1.", "7, 3", "the force is missing"),
        (
            "*CLOAD\n7, 3, -1.",
            "*DLOAD\nPART, BX, 1.",
            "the load `BX` is not read; there are P1 to P6, GRAV and CENTRIF",
        ),
        ("*CLOAD\n7, 3, -1.", "*DLOAD\nPART, GRAV, 9.81, 0., 0., 0.", "the direction of gravity has no length"),
        (
            "*SOLID SECTION, ELSET=PART, MATERIAL=STEEL",
            "*SOLID SECTION, ELSET=PART, MATERIAL=STEEL, ORIENTATION=O",
            "there is no *ORIENTATION `O`",
        ),
        ("*CLOAD\n7, 3, -1.", "*DSLOAD\nTIP, P, 1.", "there is no surface `TIP`; did you mean `TOP`?"),
        ("*CLOAD\n7, 3, -1.", "*TEMPERATURE\n1, 20.", "nodes 1 and 2 of one body differ by 20 and 0"),
        ("*CLOAD\n7, 3, -1.", "*CONTACT PAIR, INTERACTION=I\nTOP, TOP", "there is no *SURFACE INTERACTION `I`"),
        (
            "*CLOAD\n7, 3, -1.",
            "*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nTOP, TOP",
            "`TOP` and `TOP` belong to one body",
        ),
        (
            "*CLOAD\n7, 3, -1.",
            "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=SOFT",
            "PRESSURE-OVERCLOSURE=SOFT is not modelled",
        ),
        ("*STATIC\n", "7, 3, -1.\n*STATIC\n", "this line does not belong to *STEP; a keyword may be missing"),
        ("*CLOAD\n", "1., 1.\n1., 1.\n*CLOAD\n", "this line does not belong to *STATIC; a keyword may be missing"),
        ("*STATIC\n", "*STATIC, RIKS\n", "*STATIC has the parameter RIKS, which is not read"),
        ("*STATIC\n", "", "the step has no *STATIC; only an equilibrium is solved"),
        ("*END STEP\n", "", "the step has no *END STEP"),
    ] {
        if to.is_empty() {
            let (_, sentence) = error(&[("deck.inp", &CUBE.replacen(from, to, 1))]);
            assert!(sentence.contains("deck.inp:") && sentence.contains(phrase), "{sentence}");
            continue;
        }
        check(from, to, phrase);
    }
}

/// A value that only the scene refuses has the line of its card too.
#[test]
fn errors_of_the_scene_have_the_line_of_their_card() {
    for (from, to, line, phrase) in [
        ("200., 0.3", "200., 0.7", 21, "at `material.poisson` of the scene of this deck: "),
        ("*CLOAD\n7, 3, -1.", "*DLOAD\nPART, GRAV, 9.81, 0., 0., -1.", 21, "`density`"),
    ] {
        let (error, sentence) = error(&[("deck.inp", &CUBE.replacen(from, to, 1))]);
        assert!(sentence.starts_with(&format!("deck.inp:{line}: ")) && sentence.contains(phrase), "{sentence}");
        assert_eq!(error.code(), "file-syntax");
    }
}

#[test]
fn files_that_include_themselves_or_lie_elsewhere_are_refused() {
    let include = |name: &str| format!("*INCLUDE, INPUT={name}\n{CUBE}");
    for (files, phrase) in [
        (vec![("deck.inp", include("deck.inp"))], "deck.inp:1: the included file"),
        (vec![("deck.inp", include("a.inc")), ("a.inc", "*INCLUDE, INPUT=deck.inp\n".into())], "includes itself"),
        (vec![("deck.inp", include("b.inc"))], "cannot read"),
        (
            vec![("deck.inp", include("../../etc/hostname"))],
            "lies outside the folder of the deck; copy it there, or allow it",
        ),
        (vec![("deck.inp", include(""))], "*INCLUDE names no file"),
        (
            vec![("deck.inp", "1, 2, 3\n".into())],
            "deck.inp:1: this is not an input deck: a keyword, as *NODE, must begin here",
        ),
        (vec![("deck.inp", "** nothing\n".into())], "this is not an input deck"),
        (vec![("deck.inp", "*HEADING\n".into())], "the deck has no elements"),
    ] {
        let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
        let sentence = read(&files, &[]).unwrap_err().to_string();
        assert!(sentence.contains(phrase), "{sentence}");
    }
    // Each of 30 files includes the next one twice.
    let names: Vec<String> =
        (0..=30).map(|file| if file == 0 { "deck.inp".into() } else { format!("{file}.inc") }).collect();
    let texts: Vec<String> = (1..=31).map(|next| format!("*INCLUDE, INPUT={next}.inc\n").repeat(2)).collect();
    let mut files: Vec<(&str, &str)> = names.iter().map(String::as_str).zip(texts.iter().map(String::as_str)).collect();
    files.last_mut().unwrap().1 = CUBE;
    let sentence = read(&files, &[]).unwrap_err().to_string();
    assert!(sentence.contains("1000 files"), "{sentence}");
}

/// Names of nodes in a scene: sets and numbers of its deck.
#[test]
fn a_scene_names_nodes_of_its_deck() {
    let desk = tempfile::tempdir().unwrap();
    fs::write(desk.path().join("cube.inp"), CUBE).unwrap();
    let scene = |support: &str, force: &str| {
        let text = format!(
            r#"{{"model": "space", "body": {{"deck": {{"file": "cube.inp"}}}}, "material": {{"young": 200, "poisson": 0}},
                "supports": [{{"on": {{"nodes": {support}}}, "x": 0, "y": 0, "z": 0}}], "loads": [{{"nodal-forces": {force}}}]}}"#
        );
        let scene = Scene::from_json(&text, "scene")?;
        Scene { folder: Some(desk.path().into()), ..scene }.build()
    };
    let model = scene(r#"["BASE", "5"]"#, r#"{"7": [0, 0, 1], "ALL": [0, 1, 0]}"#).unwrap();
    assert_eq!(model.problem().dofs(), 9);
    assert_eq!(model.problem().load().iter().sum::<f64>(), 4.0);
    for (support, force, phrase) in [
        (
            r#""BASES""#,
            r#"{"7": [0, 0, 1]}"#,
            "`supports[0].on.nodes`: there is no set of nodes, and no node of the number, `BASES`",
        ),
        (r#""9""#, r#"{"7": [0, 0, 1]}"#, "`9`; there are the sets ALL, BASE, and numbers of nodes"),
        (r#""BASE""#, r#"{"77": [0, 0, 1]}"#, "`loads[0].nodal-forces.77`: there is no set of nodes"),
        (r#""BASE""#, r#"{"7": [0, 1]}"#, "`loads[0].nodal-forces.7`: the array has 2 entries"),
        (r#""BASE""#, "{}", "`loads[0].nodal-forces`: acts nowhere"),
        (r#""BASE""#, r#"{"7": [0, 0, 1], "7": [0, 0, 1]}"#, "the key `7` stands twice"),
        ("[]", r#"{"7": [0, 0, 1]}"#, "the list has no name"),
    ] {
        let sentence = scene(support, force).unwrap_err().to_string();
        assert!(sentence.contains(phrase), "{sentence}");
    }
    let text = Scene::text_of_deck(&desk.path().join("cube.inp"), "cube.inp", &[], None).unwrap();
    let springs = text.replace("\"loads\"", "\"springs\": [{\"on\": {\"nodes\": \"ALL\"}, \"x\": 1}], \"loads\"");
    let scene = Scene { folder: Some(desk.path().into()), ..Scene::from_json(&springs, "scene").unwrap() };
    assert!(scene.build().unwrap_err().to_string().contains("a spring holds a boundary"));
}

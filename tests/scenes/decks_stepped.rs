//! Decks of several steps: loads and supports change from step to step as in CalculiX.

use std::fs;
use std::sync::Arc;

use signorini::scene::Answer;
use signorini::{Scene, solve_qp};
use support::decks::Block;

use crate::decks::refusal;

const MODEL: &str = "*SURFACE, NAME=TOP
E, S2
*SURFACE, NAME=SIDE
E, S4
*MATERIAL, NAME=M
*ELASTIC
200., 0.
*DENSITY
1.
*EXPANSION
1.E-3
*SOLID SECTION, ELSET=E, MATERIAL=M
*AMPLITUDE, NAME=STEPS
0., 0., 1., 1., 2., 4.
*AMPLITUDE, NAME=TOTAL, TIME=TOTAL TIME
0., 0., 1., 1., 2., 4.
*BOUNDARY
BASE, 1, 3
";

/// A unit cube of one element on a base, E = 200, nu = 0, density 1, expansion 1e-3, and two amplitudes.
fn cube() -> String {
    let mesh = Block { element: "C3D8", low: [0.0; 3], high: [1.0; 3], cells: [1; 3], after: 0 }.mesh();
    mesh.cards("E") + &mesh.set("BASE", |at| at[2] == 0.0) + &mesh.set("TOP", |at| at[2] == 1.0) + MODEL
}

fn deck(steps: &[&str]) -> String {
    let steps: Vec<String> = steps.iter().map(|cards| format!("*STEP\n*STATIC\n{cards}*END STEP\n")).collect();
    cube() + &steps.concat()
}

/// The answer at the end of a step, from 1, read as a deck and as the scene that it becomes.
fn answer(deck: &str, step: usize) -> Answer {
    let desk = tempfile::tempdir().unwrap();
    let file = desk.path().join("deck.inp");
    fs::write(&file, deck).unwrap();
    let scene = Scene::read_deck(&file, &[], Some(step)).unwrap_or_else(|error| panic!("{error}\n{deck}"));
    let model = scene.build().unwrap();
    let text = Scene::text_of_deck(&file, "deck.inp", &[], Some(step)).unwrap();
    fs::write(desk.path().join("scene.json"), text).unwrap();
    let same = Scene::read(desk.path().join("scene.json")).unwrap().build().unwrap();
    assert_eq!(model.problem(), same.problem());
    let solution = solve_qp(model.problem()).unwrap();
    Answer::of(Arc::new(model), &solution).unwrap()
}

/// The force of the base, as CalculiX 2.20 prints it for these decks.
#[test]
fn loads_of_a_later_step_replace_those_before_as_in_calculix() {
    let cases: [(&str, &str, [[f64; 3]; 2]); 18] = [
        ("*CLOAD\n5, 3, 1.\n5, 3, 1.\n", "*CLOAD\n5, 3, 5.\n6, 3, 1.\n", [[0.0, 0.0, -2.0], [0.0, 0.0, -6.0]]),
        ("*CLOAD\nTOP, 3, 1.\n", "*CLOAD\n5, 3, 5.\n5, 1, 2.\n", [[0.0, 0.0, -4.0], [-2.0, 0.0, -8.0]]),
        ("*CLOAD\n5, 3, 1.\n", "*CLOAD, OP=NEW\n6, 3, 7.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -7.0]]),
        ("*CLOAD\n5, 3, 1.\n", "*DLOAD, OP=NEW\nE, P2, -5.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -6.0]]),
        ("*DLOAD\nE, P2, -1.\n", "*DLOAD\nE, P2, -5.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -5.0]]),
        ("*DLOAD\nE, P2, -1.\n", "*DLOAD\nE, P2, -5.\nE, P2, -2.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -7.0]]),
        ("*DSLOAD\nTOP, P, -1.\n", "*DSLOAD\nTOP, P, -5.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -5.0]]),
        ("*DLOAD\nE, P2, -1.\n", "*DSLOAD\nTOP, P, -5.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -5.0]]),
        ("*DSLOAD\nTOP, P, -1.\n", "*DLOAD\nE, P2, -5.\nE, P4, -2.\n", [[0.0, 0.0, -1.0], [-2.0, 0.0, -5.0]]),
        ("*DSLOAD\nTOP, P, -1.\n", "*DLOAD, OP=NEW\nE, P1, -2.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, 2.0]]),
        ("*DLOAD\nE, GRAV, 1., 0., 0., 1.\n", "*DLOAD, OP=NEW\nE, P4, -2.\n", [[0.0, 0.0, -1.0], [-2.0, 0.0, 0.0]]),
        (
            "*DLOAD\nE, GRAV, 1., 0., 0., 1.\n",
            "*DLOAD\nE, GRAV, 5., 0., 0., 2.\n",
            [[0.0, 0.0, -1.0], [0.0, 0.0, -5.0]],
        ),
        (
            "*DLOAD\nE, GRAV, 1., 0., 0., 1.\n",
            "*DLOAD\nE, GRAV, 5., 1., 0., 0.\n",
            [[0.0, 0.0, -1.0], [-5.0, 0.0, -1.0]],
        ),
        (
            "*DLOAD\nE, GRAV, 1., 0., 0., 1.\n",
            "*DLOAD\n1, GRAV, 5., 0., 0., 1.\n",
            [[0.0, 0.0, -1.0], [0.0, 0.0, -6.0]],
        ),
        ("*DLOAD\nE, GRAV, 1., 0., 0., 1.\n", "*DSLOAD, OP=NEW\nTOP, P, -2.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -2.0]]),
        (
            "*DSLOAD\nTOP, P, -1.\n",
            "*DSLOAD, OP=NEW\nTOP, P, -2.\n*DLOAD\nE, GRAV, 1., 0., 0., 1.\n",
            [[0.0, 0.0, -1.0], [0.0, 0.0, -3.0]],
        ),
        ("*CLOAD, AMPLITUDE=STEPS\n5, 3, 1.\n", "*CLOAD\n6, 3, 0.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -1.0]]),
        ("*CLOAD, AMPLITUDE=TOTAL\n5, 3, 1.\n", "*CLOAD\n6, 3, 0.\n", [[0.0, 0.0, -1.0], [0.0, 0.0, -4.0]]),
    ];
    for (first, second, expected) in cases {
        let deck = deck(&[first, second]);
        for (step, expected) in expected.into_iter().enumerate() {
            let answer = answer(&deck, step + 1);
            let resultants = answer.resultants().unwrap();
            let base: Vec<&[f64]> =
                resultants.iter().filter(|one| one.of.starts_with("supports")).map(|one| &one.force[..]).collect();
            for axis in 0..3 {
                let sum: f64 = base.iter().map(|force| force[axis]).sum();
                assert!((sum - expected[axis]).abs() < 1e-12, "{first}{second} at {}: {base:?}", step + 1);
            }
        }
    }
}

/// Steps that change supports and temperatures have the answer of one step that names all of them.
#[test]
fn supports_and_temperatures_of_a_step_are_those_of_one_step() {
    for (first, second, both) in [
        (
            "*BOUNDARY\nTOP, 3, 3, 0.01\n",
            "*BOUNDARY\n5, 3, 3, 0.03\n",
            "*BOUNDARY\n5, 3, 3, 0.03\n6, 3, 3, 0.01\n7, 3, 3, 0.01\n8, 3, 3, 0.01\n",
        ),
        (
            "*BOUNDARY\nTOP, 2, 3, 0.01\n",
            "*BOUNDARY\n5, 2, 2, 0.03\n",
            "*BOUNDARY\nTOP, 3, 3, 0.01\n5, 2, 2, 0.03\n6, 2, 2, 0.01\n7, 2, 2, 0.01\n8, 2, 2, 0.01\n",
        ),
        (
            "*BOUNDARY\nTOP, 3, 3, 0.01\n",
            "*BOUNDARY, OP=NEW\nBASE, 1, 3\n5, 3, 3, 0.03\n",
            "*BOUNDARY\n5, 3, 3, 0.03\n",
        ),
        ("*TEMPERATURE\nALL, 10.\n", "*TEMPERATURE\nBASE, 20.\nTOP, 20.\n", "*TEMPERATURE\nALL, 20.\n"),
        ("*TEMPERATURE\nALL, 10.\n", "*TEMPERATURE, OP=NEW\n5, 0.\n", "*CLOAD\n5, 3, 0.\n"),
        ("*TEMPERATURE\nALL, 10.\n", "*CLOAD\n5, 3, 1.\n", "*TEMPERATURE\nALL, 10.\n*CLOAD\n5, 3, 1.\n"),
    ] {
        let (two, one) = (answer(&deck(&[first, second]), 2), answer(&deck(&[both]), 1));
        for (two, one) in two.displacement().iter().zip(one.displacement()) {
            assert!((two - one).abs() < 1e-15, "{first}{second}: {two} instead of {one}");
        }
        // The first step does not know the second.
        let (first_of_two, alone) = (answer(&deck(&[first, second]), 1), answer(&deck(&[first]), 1));
        assert_eq!(first_of_two.displacement(), alone.displacement());
    }
}

/// In a later step of another period a load keeps the factor of its own step; total times go on, and temperatures
/// follow the last step.
#[test]
fn amplitudes_count_at_the_end_of_the_step_that_names_them() {
    for (first, factor) in [
        ("*CLOAD, AMPLITUDE=STEPS\n5, 3, 1.\n", 1.0),
        ("*CLOAD, AMPLITUDE=TOTAL\n5, 3, 1.\n", 4.0),
        ("*DLOAD, AMPLITUDE=STEPS\nE, P2, -1.\n", 1.0),
        ("*DSLOAD, AMPLITUDE=STEPS\nTOP, P, -1.\n", 1.0),
        ("*DLOAD, AMPLITUDE=STEPS\nE, GRAV, 1., 0., 0., 1.\n", 1.0),
        ("*BOUNDARY, AMPLITUDE=STEPS\nTOP, 3, 3, 0.01\n", 1.0),
        ("*TEMPERATURE, AMPLITUDE=STEPS\nALL, 10.\n", 2.5),
    ] {
        let longer = deck(&[first, "*CLOAD\n6, 3, 0.\n"]);
        let at = longer.rfind("*STATIC\n").unwrap() + "*STATIC\n".len();
        // The second step ends at the time 1.5 of its own, and 2.5 of all.
        let longer = longer[..at].to_string() + "0.1, 1.5\n" + &longer[at..];
        let [two, one] = [answer(&longer, 2), answer(&longer, 1)];
        for (two, one) in two.displacement().iter().zip(one.displacement()) {
            assert!((two - factor * one).abs() < 1e-14, "{first}: {two} of {one}");
        }
    }
}

#[test]
fn steps_that_are_not_whole_are_refused_with_their_line() {
    let one = "*STEP\n*STATIC\n*CLOAD\n5, 3, 1.\n*END STEP\n";
    let last = 1 + cube().matches('\n').count();
    for (steps, line, phrase) in [
        (one.to_string() + "*STEP\n*STATIC\n*CLOAD\n5, 3, 1.\n", 5, "the step has no *END STEP"),
        (one.replace("*END STEP\n", "") + one, 0, "the step has no *END STEP"),
        (one.to_string() + "*STEP\n*CLOAD\n5, 3, 1.\n*END STEP\n", 5, "the step has no *STATIC"),
        (one.to_string() + "*BOUNDARY\n5, 3\n", 5, "*BOUNDARY follows an *END STEP; only a *STEP may follow one"),
        (one.to_string() + "*CLOAD\n5, 3, 1.\n", 5, "*CLOAD stands outside of the steps, but belongs into one"),
        (one.to_string() + "*STEP\n*STATIC\n*PLASTIC\n*END STEP\n", 7, "*PLASTIC changes the answer and is refused"),
        (
            one.replace("*CLOAD\n5, 3, 1.\n", "*DSLOAD\nBOTH, P, 1.\n")
                + &one.replace("*CLOAD\n5, 3, 1.\n", "*DSLOAD\nSIDE, P, 1.\n"),
            3,
            "a later step presses a part of `BOTH` anew",
        ),
    ] {
        let (steps, line) = if steps.contains("BOTH") {
            (format!("*SURFACE, NAME=BOTH\nE, S2\nE, S4\n{steps}"), line + 3)
        } else {
            (steps, line)
        };
        let (at, message) = refusal(&(cube() + &steps));
        assert!(at == last + line && message.contains(phrase), "{steps}: {at} of {last}: {message}");
    }
    let desk = tempfile::tempdir().unwrap();
    let file = desk.path().join("deck.inp");
    fs::write(&file, deck(&["", ""])).unwrap();
    for wrong in [0, 3] {
        let refused = Scene::read_deck(&file, &[], Some(wrong)).unwrap_err().to_string();
        assert!(refused.contains(&format!("the deck has no step {wrong}; its steps are 1 to 2")), "{refused}");
    }
}

//! Bodies that contact without friction hardly holds in some direction.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use serde_json::json;
use signorini::Scene;
use signorini::scene::Answer;
use signorini::solve_qp;
use signorini::study::Summary;
use support::cases;
use support::decks::{Block, Mesh};
use support::draws::Draws;
use support::scenes::built;

use crate::decks::{read, step};

/// A motion with this share of the largest displacement is named; the limit is a tenth, and the motion differs a little
/// from what its support takes away.
const SURELY: f64 = 0.15;

/// A motion with this share is not named.
const HARDLY: f64 = 0.07;

const CARDS: &str = "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1e5, 0.3\n\
                     *SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n\
                     *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER\n\
                     *SOLID SECTION, ELSET=LOW, MATERIAL=STEEL\n*SOLID SECTION, ELSET=HIGH, MATERIAL=STEEL\n";

/// The displacement of a deck, and its warning `softly-held`, if there is one.
fn solved(deck: &str) -> (Vec<f64>, Option<String>) {
    let scene: Scene = read(&[("deck.inp", deck)], &[]).unwrap_or_else(|error| panic!("{error}"));
    let model = Arc::new(scene.build().unwrap());
    let solution = solve_qp(model.problem()).unwrap_or_else(|error| panic!("{}", model.explain(error)));
    let answer = Answer::of(model, &solution).unwrap();
    let summary = Summary::of_answer(&answer, solution, 1e-9, 0.0).unwrap();
    let warning = summary.warnings.into_iter().find(|warning| warning.code == "softly-held");
    (answer.displacement().to_vec(), warning.map(|warning| warning.message))
}

/// Solves a deck with a soft motion and the same deck with that motion held: the motion is named if it moves nodes by a
/// visible share of the largest displacement, and not if it does not. Returns `true` if it was named.
fn is_named(deck: impl Fn(bool) -> String, motion: &str, name: &str) -> bool {
    let ((free, warning), (held, none)) = (solved(&deck(false)), solved(&deck(true)));
    let largest = free.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let moved = free.iter().zip(&held).fold(0.0, |moved: f64, (free, held)| moved.max((free - held).abs()));
    let share = moved / largest;
    assert_eq!(none, None, "{name}");
    assert!(share < SURELY || warning.is_some(), "{name}: moves by {share}, and is not named");
    assert!(share > HARDLY || warning.is_none(), "{name}: moves by {share}: {warning:?}");
    let names = |message: &String| message.contains(motion) && message.contains("add a guide by `*BOUNDARY`");
    assert!(warning.as_ref().is_none_or(names), "{name}: {warning:?}");
    warning.is_some()
}

fn mapped(mut mesh: Mesh, place: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
    mesh.nodes.iter_mut().for_each(|(_, at)| *at = place(*at));
    mesh
}

/// A place on a cylinder, with the nodes off the planes of symmetry displaced along it.
fn round([radius, angle, z]: [f64; 3]) -> [f64; 3] {
    let off = (2.0 * angle).sin();
    let (angle, z) = (angle + 0.03 * off * (0.9 * z).sin(), z + 0.8 * off * (0.4 * z + 5.0 * angle).sin());
    [radius * angle.cos(), radius * angle.sin(), z]
}

/// A quarter of a hub that is pressed onto a shaft, with random sizes and meshes; the shaft is held at its end, and the
/// hub only if its face is.
fn press_fit(draws: &mut Draws, is_held: bool) -> String {
    let element = ["C3D4", "C3D10"][draws.below(2)];
    let length = 20.0 + 4.0 * draws.signed();
    let mut count = |most: usize| 3 + draws.below(most);
    let block = |[from, to]: [f64; 2], [low, high]: [f64; 2], [across, around, along]: [usize; 3], after: usize| {
        let cells = [across, around, along];
        Block { element, low: [from, 0.0, low], high: [to, FRAC_PI_2, high], cells, after }.mesh()
    };
    let shaft = block([4.0, 10.02], [0.0, 40.0], [2, 2 + count(3), 2 * count(3)], 0);
    let hub = block([10.0, 16.0], [10.0, 10.0 + length], [2, 3 + count(3), count(3)], 10_000);
    let is_outer = |at: [f64; 3]| at[0] == 10.02;
    let mut deck = shaft.set("X0", |at| at[1] == FRAC_PI_2) + &hub.set("X0", |at| at[1] == FRAC_PI_2);
    deck += &(shaft.set("Y0", |at| at[1] == 0.0) + &hub.set("Y0", |at| at[1] == 0.0));
    deck += &shaft.set("Z0", |at| at[2] == 0.0);
    deck += &if is_held { hub.set("Z0", |at| at[2] == 10.0) } else { String::new() };
    deck += &(shaft.surface("SLAVE", is_outer) + &hub.surface("MASTER", |at| at[0] == 10.0));
    let meshes = mapped(shaft, round).cards("LOW") + &mapped(hub, round).cards("HIGH");
    meshes + &deck + CARDS + "*BOUNDARY\nX0, 1\nY0, 2\nZ0, 3\n" + &step("")
}

/// GOAL: a hub that nothing holds along its shaft.
/// CONDITIONS: quarters of press fits of 0.02 with random sizes and meshes.
/// REFERENCE: the answer with the face of the hub held.
#[test]
fn a_hub_that_nothing_holds_along_its_shaft_is_named() {
    let named = (0..cases(2, 25)).filter(|&seed| {
        is_named(
            |is_held| press_fit(&mut Draws(seed), is_held),
            "translation along z of `body-2`",
            &format!("hub {seed}"),
        )
    });
    assert!(named.count() > 0);
}

/// A dome with an uneven mesh on a block: a force presses its flat top, which is rigid and guided along the force; its
/// rotation is held only if `is_held`.
fn dome(draws: &mut Draws, is_held: bool) -> String {
    let element = ["CPS4", "CPS8", "C3D8", "C3D4"][draws.below(4)];
    let is_plane = element.starts_with("CPS");
    let (radius, lean) = (8.0 + 4.0 * draws.signed(), 0.3 * draws.signed());
    let mut count = |least: usize| least + draws.below(3);
    let (across, up) = ([count(12), count(12)], if is_plane { 1 } else { 2 });
    let block = |low: f64, high: f64, half: f64, [x, y]: [usize; 2], layers: usize, after: usize| {
        let (mut from, mut to, mut cells) = ([-half, -half, low], [half, half, high], [x, y, layers]);
        if is_plane {
            (from, to, cells) = ([-half, low, 0.0], [half, high, 0.0], [x, layers, 0]);
        }
        Block { element, low: from, high: to, cells, after }.mesh()
    };
    let (base, cap) = (block(-2.0, 0.0, 3.0, [count(5), count(5)], 2, 0), block(0.0, 2.0, 2.0, across, 3, 10_000));
    let at = |height: f64| move |at: [f64; 3]| at[up] == height;
    let mut cards = base.set("GROUND", at(-2.0)) + &cap.set("TOP", at(2.0));
    cards += &(base.surface("MASTER", at(0.0)) + &cap.surface("SLAVE", at(0.0)));
    // Lines of the mesh are denser on one side, and the lower face is a paraboloid.
    let curved = |mut at: [f64; 3]| {
        (0..up).for_each(|axis| at[axis] += lean * (1.0 - at[axis] * at[axis] / 4.0));
        let height: f64 = (0..up).map(|axis| at[axis] * at[axis]).sum::<f64>() / (2.0 * radius);
        at[up] += height * (1.0 - at[up] / 2.0);
        at
    };
    let reference = if is_plane { "0., 2., 0." } else { "0., 0., 2." };
    let (turns, free, down) = match is_plane {
        true => ("90001, 6\n", "", 2),
        false => ("90002, 1, 3\n", "90002, 3\n", 3),
    };
    let guides = if is_plane { "90001, 1\n" } else { "90001, 1, 2\n" };
    let meshes = base.cards("LOW") + &mapped(cap, curved).cards("HIGH");
    meshes
        + &cards
        + &format!(
            "*NODE\n90001, {reference}\n90002, {reference}\n*RIGID BODY, NSET=TOP, REF NODE=90001, ROT NODE=90002\n"
        )
        + CARDS
        + &format!("*BOUNDARY\nGROUND, 1, {down}\n{guides}{}", if is_held { turns } else { free })
        + &step(&format!("*CLOAD\n90001, {down}, -100.\n"))
}

/// GOAL: a dome that its contact hardly keeps from tilting.
/// CONDITIONS: domes of random curvature with uneven meshes in the plane and in space, pressed in their middle.
/// REFERENCE: the answer with the rotations held.
#[test]
fn a_dome_that_can_tilt_is_named() {
    let named = (0..cases(4, 25)).filter(|&seed| {
        is_named(|is_held| dome(&mut Draws(100 + seed), is_held), "rotation about", &format!("dome {seed}"))
    });
    assert!(named.count() > 0);
}

/// A ring that is pressed into another one, with a moment or without: nothing but the facets resists its rotation.
#[test]
fn a_moment_that_turns_a_soft_motion_is_named() {
    let ring = |[inner, outer]: [f64; 2], around: usize| {
        let radius = json!({"points": [inner, outer], "divisions": [3]});
        json!({"ring": {"radius": radius, "angle": {"points": [0, 360], "divisions": [around]}, "element": "q4"}})
    };
    let steel = json!({"young": 2e5, "poisson": 0.3});
    let scene = json!({
        "body": ring([5.0, 10.0], 48), "material": steel,
        "further-bodies": [{"name": "hub", "material": steel, "body": ring([10.0, 20.0], 36)}],
        "supports": [{"on": {"boundary": "hub.outer"}, "x": 0, "y": 0}],
        "loads": [{"moment": {"boundary": "inner", "value": [1e-3]}}],
        "obstacles": [{"boundary": "outer", "approach": "+x", "rule": "closest-point",
                       "shape": {"body": {"boundary": "hub.inner", "fit": {"interference": 0.01}}}}],
    });
    let model = Arc::new(built(&scene));
    let solution = solve_qp(model.problem()).unwrap();
    let summary = Summary::of_answer(&Answer::of(model, &solution).unwrap(), solution, 1e-9, 0.0).unwrap();
    let warning = summary.warnings.into_iter().find(|warning| warning.code == "softly-held").unwrap();
    assert!(warning.message.contains("largest displacement, under the loads; "), "{}", warning.message);
}

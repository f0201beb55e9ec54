//! GOAL: a contact that goes round corners, and whole skins that are named, have rows on each side alone: nothing
//! pushes along a frictionless flat face, and a uniform pressure passes.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde_json::json;
use signorini::Model;
use signorini::scene::Answer;

use crate::decks::{answer, compare, read};
use support::scenes;

/// Rounding of a solve with some hundred unknowns, relative to the pressure.
const ROUNDING: f64 = 1e-8;

const PRESSURE: f64 = 5.0;

/// A body of boxes in a deck: nodes at one place are one node.
#[derive(Default)]
struct Boxes {
    nodes: BTreeMap<[i64; 3], usize>,
    elements: Vec<Vec<usize>>,
}

/// Coordinates are counted in parts of this.
const UNIT: f64 = 1e-6;

impl Boxes {
    /// Adds a box with this number of cells along each side; flat if its height is 0. Nodes are numbered from `first`.
    fn add(&mut self, low: [f64; 3], high: [f64; 3], cells: usize, first: usize) {
        let is_flat = low[2] == high[2];
        let count = if is_flat { [cells, cells, 1] } else { [cells; 3] };
        let mut number = |at: [usize; 3]| {
            let key = [0, 1, 2].map(|k| {
                let share = if count[k] == 0 { 0.0 } else { at[k] as f64 / count[k] as f64 };
                ((low[k] + share * (high[k] - low[k])) / UNIT).round() as i64
            });
            let next = first + self.nodes.len();
            *self.nodes.entry(key).or_insert(next)
        };
        for (i, j, k) in
            (0..count[0]).flat_map(|i| (0..count[1]).flat_map(move |j| (0..count[2]).map(move |k| (i, j, k))))
        {
            let mut layer = |k: usize| [[i, j, k], [i + 1, j, k], [i + 1, j + 1, k], [i, j + 1, k]].map(&mut number);
            let own = layer(k);
            self.elements.push(if is_flat { own.to_vec() } else { [own, layer(k + 1)].concat() });
        }
    }

    /// The cards of the nodes, the elements and the surface of all faces of the body.
    fn cards(&self, name: &str, first: usize) -> String {
        let is_flat = self.elements[0].len() == 4;
        let mut text = String::from("*NODE\n");
        for (at, number) in &self.nodes {
            let [x, y, z] = at.map(|part| part as f64 * UNIT);
            let _ = writeln!(text, "{number}, {x:e}, {y:e}, {z:e}");
        }
        let _ = writeln!(text, "*ELEMENT, TYPE={}, ELSET={name}", if is_flat { "CPE4" } else { "C3D8" });
        for (index, nodes) in self.elements.iter().enumerate() {
            let words: Vec<String> =
                std::iter::once(first + index).chain(nodes.iter().copied()).map(|n| n.to_string()).collect();
            let _ = writeln!(text, "{}", words.join(", "));
        }
        // Faces that occur once are outside.
        let faces: &[&[usize]] = match is_flat {
            true => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
            false => &[&[0, 1, 2, 3], &[4, 7, 6, 5], &[0, 4, 5, 1], &[1, 5, 6, 2], &[2, 6, 7, 3], &[3, 7, 4, 0]],
        };
        let mut of_face: BTreeMap<Vec<usize>, Vec<(usize, usize)>> = BTreeMap::new();
        for (index, nodes) in self.elements.iter().enumerate() {
            for (face, local) in faces.iter().enumerate() {
                let mut key: Vec<usize> = local.iter().map(|&corner| nodes[corner]).collect();
                key.sort_unstable();
                of_face.entry(key).or_default().push((first + index, face + 1));
            }
        }
        let _ = writeln!(text, "*SURFACE, NAME=SKIN{name}");
        for own in of_face.values().filter(|own| own.len() == 1) {
            let _ = writeln!(text, "{}, S{}", own[0].0, own[0].1);
        }
        text
    }
}

const CONTACT: &str = "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n\
                       *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSKINB, SKINA\n";

/// A body with a notch and a block in it, which meet on all inner faces, `joined` by these cards.
fn notched(is_flat: bool, cells: [usize; 2], joined: &str) -> String {
    let high = if is_flat { 0.0 } else { 2.0 };
    let parts = if is_flat { 4 } else { 8 };
    let (mut notched, mut block) = (Boxes::default(), Boxes::default());
    for part in 0..parts {
        let low = [part & 1, (part >> 1) & 1, part >> 2].map(|bit| bit as f64);
        let up = [low[0] + 1.0, low[1] + 1.0, if is_flat { high } else { low[2] + 1.0 }];
        match part + 1 == parts {
            true => block.add(low, up, cells[1], 5001),
            false => notched.add(low, up, cells[0], 1),
        }
    }
    let mut deck = notched.cards("A", 1) + &block.cards("B", 5001);
    deck += "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.3\n*SOLID SECTION, ELSET=A, MATERIAL=M\n*SOLID SECTION, ELSET=B, MATERIAL=M\n";
    deck += joined;
    deck += "*BOUNDARY\n";
    // Three planes through a corner, so that the body shrinks without a force.
    for (at, number) in &notched.nodes {
        let axes = (0..if is_flat { 2 } else { 3 }).filter(|&axis| at[axis] == 0);
        axes.for_each(|axis| _ = writeln!(deck, "{number}, {}", axis + 1));
    }
    // The outer faces, away from the corner.
    deck += "*STEP\n*STATIC\n*DLOAD\n";
    for (body, first) in [(&notched, 1), (&block, 5001)] {
        for (index, nodes) in body.elements.iter().enumerate() {
            let place = |node: &usize| *body.nodes.iter().find(|entry| entry.1 == node).unwrap().0;
            let at: Vec<[i64; 3]> = nodes.iter().map(place).collect();
            let faces: &[(usize, &[usize])] = match is_flat {
                true => &[(2, &[1, 2]), (3, &[2, 3])],
                false => &[(2, &[4, 5, 6, 7]), (4, &[1, 2, 5, 6]), (5, &[2, 3, 6, 7])],
            };
            for (face, corners) in faces {
                let end = (2.0 / UNIT) as i64;
                if (0..3).any(|axis| corners.iter().all(|&corner| at[corner][axis] == end)) {
                    let _ = writeln!(deck, "{}, P{face}, {PRESSURE}", first + index);
                }
            }
        }
    }
    deck + "*END STEP\n"
}

/// Every row has the pressure, and its force is along one axis.
#[track_caller]
fn is_uniform(answer: &Answer, pressure: f64, area: f64) {
    let model = answer.model();
    for (row, found) in model.rows().iter().zip(answer.pressure()) {
        assert!((found - pressure).abs() < ROUNDING * pressure, "{found} at {row:?}");
        assert!(row.normal.iter().filter(|part| **part != 0.0).count() == 1, "{row:?}");
    }
    let sum: f64 = model.rows().iter().map(|row| row.tributary_area).sum();
    assert!((sum - area).abs() < ROUNDING * area, "{sum}");
}

/// GOAL: a block in a notch, whole skins named.
/// CONDITIONS: a uniform pressure on all outer faces, meshes that match and do not; contact, and a tie.
/// REFERENCE: the pressure of the outside everywhere, on a width of 2 or an area of 3.
#[test]
fn a_uniform_pressure_passes_round_a_corner() {
    for (is_flat, cells, area) in [(true, [2, 3], 2.0), (true, [2, 2], 2.0), (false, [1, 2], 3.0), (false, [2, 1], 3.0)]
    {
        let shrinks = PRESSURE * if is_flat { 1.3 * 0.4 } else { 0.4 } / 200.0;
        let exact = |[x, y, z]: [f64; 3]| [x, y, z].map(|at| -shrinks * at);
        let touching = answer(&notched(is_flat, cells, CONTACT));
        is_uniform(&touching, PRESSURE, area);
        compare(&touching, exact);
        compare(&answer(&notched(is_flat, cells, "*TIE, NAME=T\nSKINB, SKINA\n")), exact);
    }
}

/// A block on another one, whole skins named: at the edges the rows are along the load alone, and no surface is curved.
#[test]
fn whole_skins_of_blocks_have_a_uniform_pressure_up_to_their_edges() {
    let block = |name: &str, z: [f64; 2], cells: usize| {
        json!({"name": name, "material": {"young": 200, "poisson": 0}, "body": {"box": {
            "x": {"points": [0, 1], "divisions": [cells]}, "y": {"points": [0, 1], "divisions": [cells]}, "z": {"points": z, "divisions": [2]},
        }}})
    };
    let mut scene = block("", [0.0, 1.0], 2);
    scene.as_object_mut().unwrap().remove("name");
    let rest = json!({
        "model": "space", "further-bodies": [block("up", [1.0, 2.0], 3)], "parts": [{"name": "skin"}, {"name": "cover", "of": "up"}],
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}, {"on": {"boundary": "up.left"}, "x": 0},
                     {"on": {"boundary": "up.front"}, "y": 0}],
        "loads": [{"pressure": {"boundary": "up.top", "value": PRESSURE}}],
        "obstacles": [{"boundary": "skin", "rule": "closest-point", "shape": {"body": {"boundary": "cover"}}}],
    });
    rest.as_object().unwrap().iter().for_each(|(key, value)| scene[key] = value.clone());
    let answer = scenes::answer(&scene);
    is_uniform(&answer, PRESSURE, 1.0);
    let codes: Vec<String> = answer.model().warnings().iter().map(|warning| warning.code.to_string()).collect();
    assert!(!codes.iter().any(|code| code == "sag"), "{codes:?}");
}

/// Six times six squares that touch each other, under a pressure on all sides: each of the 60 contacts is whole,
/// although the places of both surfaces differ by rounding.
#[test]
fn auto_loses_no_facet_among_many_bodies() {
    let square = |i: usize, j: usize| {
        let (at, cells) = (|k: usize| json!([10.0 * k as f64, 10.0 * k as f64 + 10.0]), 2 + (i + j) % 3);
        json!({"rectangle": {"x": {"points": at(i), "divisions": [cells]}, "y": {"points": at(j), "divisions": [cells]}}})
    };
    let material = json!({"young": 2e5, "poisson": 0.3});
    let (mut further, mut loads, mut supports) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
        let of = |side: &str| if i + j == 0 { side.to_string() } else { format!("c{i}{j}.{side}") };
        if i + j > 0 {
            further.push(json!({"name": format!("c{i}{j}"), "body": square(i, j), "material": material}));
        }
        for (is_end, side) in [(i == 5, "right"), (j == 5, "top")] {
            if is_end {
                loads.push(json!({"pressure": {"boundary": of(side), "value": PRESSURE}}));
            }
        }
        for (is_start, side, key) in [(i == 0, "left", "x"), (j == 0, "bottom", "y")] {
            if is_start {
                supports.push(json!({"on": {"boundary": of(side)}, key: 0}));
            }
        }
    }
    let scene = json!({"model": "plane-strain", "contact": "auto", "body": square(0, 0), "material": material,
                       "further-bodies": further, "loads": loads, "supports": supports});
    let answer = scenes::answer(&scene);
    let model = answer.model();
    assert_eq!(model.obstacles().len(), 60);
    is_uniform(&answer, PRESSURE, 600.0);
}

/// The smallest gap of a model, in length.
fn least_gap(model: &Model) -> f64 {
    model.problem().gap().iter().copied().fold(f64::INFINITY, f64::min)
}

/// Cells around a hole.
const AROUND: usize = 12;

/// A pin of radius 5 sticks out of a hole of radius 6 on both sides of a plate: the rows of whole skins lead from the
/// pin to the hole, not through the plate to its far sides, whether the pin has nodes in the hole or at its ends alone.
#[test]
fn a_pin_that_sticks_out_of_its_hole_touches_the_hole_alone() {
    for along in [5, 1] {
        let model = pinned(along);
        assert!(model.rows().len() > AROUND, "{along}: {}", model.rows().len());
        // Chords of twelve sides lie up to 0.2 inside the circle of the hole.
        assert!(least_gap(&model) > 0.7, "{along}: {}", least_gap(&model));
    }
}

/// The pin, with these cells along it, and the plate.
fn pinned(along: usize) -> Model {
    let mut deck = String::new();
    for (name, [inner, outer], [low, high], cells, first, shift) in
        [("A", [6.0, 16.0], [0.0, 10.0], 2, 1, 0.0), ("B", [2.0, 5.0], [-3.0, 13.5], along, 5001, 0.1)]
    {
        let number = |ring: usize, turn: usize, level: usize| first + (level * 2 + ring) * AROUND + turn % AROUND;
        deck += "*NODE\n";
        for (level, ring, turn) in
            (0..=cells).flat_map(|l| (0..2).flat_map(move |r| (0..AROUND).map(move |t| (l, r, t))))
        {
            let angle = shift + std::f64::consts::TAU * turn as f64 / AROUND as f64;
            let (radius, z) = ([inner, outer][ring], low + (high - low) * level as f64 / cells as f64);
            let _ = writeln!(
                deck,
                "{}, {:e}, {:e}, {z:e}",
                number(ring, turn, level),
                radius * angle.cos(),
                radius * angle.sin()
            );
        }
        let _ = writeln!(deck, "*ELEMENT, TYPE=C3D8, ELSET={name}");
        let mut faces = String::new();
        for (level, turn) in (0..cells).flat_map(|level| (0..AROUND).map(move |turn| (level, turn))) {
            let element = first + level * AROUND + turn;
            let layer = |level: usize| {
                [(0, turn), (1, turn), (1, turn + 1), (0, turn + 1)].map(|(ring, turn)| number(ring, turn, level))
            };
            let nodes = [layer(level), layer(level + 1)].concat();
            let words: Vec<String> = nodes.iter().map(usize::to_string).collect();
            let _ = writeln!(deck, "{element}, {}", words.join(", "));
            // Inner and outer sides, and the ends.
            let ends = [(level == 0, 1), (level + 1 == cells, 2), (true, 4), (true, 6)];
            ends.into_iter().filter(|end| end.0).for_each(|(_, face)| _ = writeln!(faces, "{element}, S{face}"));
        }
        let _ = write!(deck, "*SURFACE, NAME=SKIN{name}\n{faces}");
    }
    deck += "*MATERIAL, NAME=M\n*ELASTIC\n200., 0.3\n*SOLID SECTION, ELSET=A, MATERIAL=M\n*SOLID SECTION, ELSET=B, MATERIAL=M\n\
             *SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n\
             *CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nSKINB, SKINA\n*BOUNDARY\n1, 1, 3\n2, 1, 3\n30, 1, 3\n5001, 1, 3\n5002, 1, 3\n\
             5014, 1, 3\n*STEP\n*STATIC\n*CLOAD\n5020, 1, 0.1\n*END STEP\n";
    let scene = read(&[("deck.inp", &deck)], &[]).unwrap_or_else(|error| panic!("{error}"));
    let model = scene.build().unwrap();
    std::fs::remove_dir_all(scene.folder.unwrap()).unwrap();
    model
}

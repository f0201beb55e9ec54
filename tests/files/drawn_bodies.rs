//! Bodies beside their obstacles, as pictures and pages show them: a rigid obstacle keeps its shape and touches where
//! there is contact, the eye sees the contact, marks do not hide the pressure, and singular nodes do not take the
//! colours.

use std::fs;

use resvg::usvg::roxmltree::{Document, Node};
use serde_json::{Value, json};
use support::program::{Desk, example};

fn drawn(desk: &Desk, scene: &Value) {
    desk.write("scene.json", scene.to_string());
    desk.run(&["solve", "scene.json", "--out", "o"]).ends_with(0);
}

fn number(node: &Node, attribute: &str) -> f64 {
    node.attribute(attribute).and_then(|text| text.parse().ok()).unwrap_or(f64::NAN)
}

/// The points of each line of a path: absolute moves, then relative lines.
fn lines(path: &str) -> Vec<Vec<[f64; 2]>> {
    let mut spaced = String::new();
    for character in path.chars() {
        match character {
            'M' | 'l' | 'h' | 'v' | 'z' => spaced += &format!(" {character} "),
            '-' => spaced += " -",
            other => spaced.push(other),
        }
    }
    let mut words = spaced.split_whitespace().peekable();
    let (mut lines, mut at, mut kind) = (Vec::<Vec<[f64; 2]>>::new(), [0.0; 2], 'M');
    while let Some(word) = words.peek().copied() {
        if let Some(next) = word.chars().next().filter(|next| next.is_alphabetic()) {
            kind = next;
            words.next();
            if kind != 'z' {
                continue;
            }
        }
        let mut next = || words.next().and_then(|word| word.parse::<f64>().ok()).unwrap();
        match kind {
            'M' => at = [next(), next()],
            'l' => at = [at[0] + next(), at[1] + next()],
            'h' => at[0] += next(),
            'v' => at[1] += next(),
            _ => continue,
        }
        match lines.last_mut() {
            Some(line) if kind != 'M' => line.push(at),
            _ => lines.push(vec![at]),
        }
    }
    lines
}

/// The edges of the obstacles in the picture of an answer, and the places of its closed nodes, in pixels.
fn edges_and_contact(svg: &str) -> (Vec<Vec<[f64; 2]>>, Vec<[f64; 2]>) {
    let document = Document::parse(svg).unwrap();
    let is_key =
        |node: &Node| node.attribute("d").is_some_and(|path| path.matches(['l', 'h']).count() < 2 && path.len() < 16);
    let edges = document.descendants().filter(|node| node.attribute("stroke-width") == Some("1.8") && !is_key(node));
    let edges = edges.filter_map(|node| node.attribute("d")).flat_map(lines).collect();
    let red = document.descendants().filter(|node| node.attribute("fill") == Some("#d52b1e"));
    let places = red.map(|node| [number(&node, "cx"), number(&node, "cy")]).filter(|place| place[0].is_finite());
    (edges, places.collect())
}

/// The ring of the gallery is squeezed by two flat plates. Its displacement is drawn ten times as large.
#[test]
fn a_flat_plate_stays_flat_beside_a_magnified_body_and_touches_it() {
    let desk = Desk::new();
    let scene = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/gallery/ring.json")).unwrap();
    drawn(&desk, &serde_json::from_str(&scene).unwrap());
    let svg = fs::read_to_string(desk.path("o/contact.svg")).unwrap();
    assert!(svg.contains("× 10<"), "the displacement is not magnified");
    let (edges, contact) = edges_and_contact(&svg);
    let wide = |line: &&Vec<[f64; 2]>| (line[line.len() - 1][0] - line[0][0]).abs() > 100.0;
    let plates: Vec<_> = edges.iter().filter(wide).collect();
    assert_eq!(plates.len(), 2, "{edges:?}");
    for plate in plates {
        let bend = plate.iter().map(|point| (point[1] - plate[0][1]).abs()).fold(0.0, f64::max);
        assert!(bend < 0.1, "a plate bends by {bend} pixels");
        let away = contact.iter().map(|place| (place[1] - plate[0][1]).abs()).fold(f64::INFINITY, f64::min);
        assert!(away < 1.0, "the nearest closed node is {away} pixels away");
    }
}

/// In the picture the circle has the radius that the scale of its axes gives it.
#[test]
fn a_circle_keeps_its_radius_beside_a_magnified_body() {
    let desk = Desk::new();
    desk.run(&["solve", &example("circle"), "--out", "o"]).ends_with(0);
    let svg = fs::read_to_string(desk.path("o/contact.svg")).unwrap();
    assert!(!svg.contains("to scale"), "the displacement is not magnified");
    let (edges, _) = edges_and_contact(&svg);
    let arc = edges.iter().max_by_key(|line| line.len()).unwrap();
    let (first, last, middle) = (arc[0], arc[arc.len() - 1], arc[arc.len() / 2]);
    let half = 0.5 * (last[0] - first[0]).hypot(last[1] - first[1]);
    let rise = (middle[1] - 0.5 * (first[1] + last[1])).abs();
    let radius = (half * half + rise * rise) / (2.0 * rise);
    // The first panel shows the undeformed body, 10 mm wide.
    let document = Document::parse(&svg).unwrap();
    let outline = document.descendants().find(|node| node.attribute("stroke-width") == Some("1.4")).unwrap();
    let body = lines(outline.attribute("d").unwrap()).concat();
    let ends =
        body.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at[0]), high.max(at[0])]);
    let millimetres = radius / (ends[1] - ends[0]) * 10.0;
    // The line is a polygon of 200 sides, in hundredths of a pixel.
    assert!((millimetres / RADIUS - 1.0).abs() < 0.02, "{millimetres} mm");
}

/// The radius in `examples/circle.json`, in mm.
const RADIUS: f64 = 10.0;

/// The data of the page beside an answer.
fn page(desk: &Desk) -> Value {
    let html = fs::read_to_string(desk.path("o/report.html")).unwrap();
    let data = html.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    serde_json::from_str(data).unwrap()
}

/// A small block on a wide plate, and one below: the eye is beside their contact, on the side of the block, which the
/// plate does not hide.
#[test]
fn two_bodies_in_space_are_seen_from_the_side_of_their_contact() {
    for (block, plate, [foot, face, back], approach, side) in [
        ([1, 2], [0, 1], ["bottom", "top", "bottom"], "-z", 1.0),
        ([0, 1], [1, 2], ["top", "bottom", "top"], "+z", -1.0),
    ] {
        let body = |across: Value, divisions: Value, along: [u8; 2]| {
            let axis = json!({"points": across, "divisions": divisions});
            json!({"box": {"x": axis, "y": axis, "z": {"points": along, "divisions": [1]}}})
        };
        let steel = json!({"young": 210000, "poisson": 0.3});
        let held = |boundary: &str, z: f64| json!({"on": {"boundary": boundary}, "x": 0, "y": 0, "z": z});
        let top_of_block = if foot == "bottom" { "top" } else { "bottom" };
        let scene = json!({
            "model": "space", "body": body(json!([2, 4]), json!([2]), block), "material": steel,
            "further-bodies": [{"name": "plate", "body": body(json!([0, 2, 4, 6]), json!([2, 2, 2]), plate), "material": steel}],
            "supports": [held(top_of_block, -0.01 * side), held(&format!("plate.{back}"), 0.0)],
            "obstacles": [{"boundary": foot, "approach": approach, "shape": {"body": {"boundary": format!("plate.{face}")}}}]
        });
        let desk = Desk::new();
        drawn(&desk, &scene);
        let eye: Vec<f64> = serde_json::from_value(page(&desk)["question"]["eye"].clone()).unwrap();
        let size = eye.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!((0.1..0.6).contains(&(side * eye[2] / size)), "the eye at {eye:?} does not see the contact");
    }
}

#[test]
fn the_page_of_a_motion_opens_at_the_frame_with_the_largest_force() {
    let desk = Desk::new();
    let ball = concat!(env!("CARGO_MANIFEST_DIR"), "/studies/impact/ball.json");
    desk.run(&["solve", ball, "--out", "o"]).ends_with(0);
    let motion = &page(&desk)["motion"];
    let times: Vec<f64> = serde_json::from_value(motion["times"].clone()).unwrap();
    // Time and force of each step.
    let history = fs::read_to_string(desk.path("o/history.csv")).unwrap();
    let steps: Vec<Vec<f64>> = history
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    let force = |time: f64| {
        steps.iter().min_by(|a, b| (a[0] - time).abs().total_cmp(&(b[0] - time).abs())).map_or(f64::NAN, |step| step[1])
    };
    let largest = (0..times.len()).max_by(|&a, &b| force(times[a]).total_cmp(&force(times[b]))).unwrap();
    assert!(largest > 0 && motion["opens"] == largest, "{} instead of {largest}", motion["opens"]);
}

/// A force on one node of the upper side: the stress there grows with every refinement.
#[test]
fn a_single_node_under_a_point_load_does_not_take_the_colours() {
    let load = |value: Value| {
        json!({
            "units": {"length": "mm", "force": "N"},
            "body": {"rectangle": {"x": {"points": [0, 10], "divisions": [40]}, "y": {"points": [0, 4], "divisions": [16]}}},
            "material": {"young": 210000, "poisson": 0.3},
            "supports": [{"on": {"boundary": "left"}, "x": 0}],
            "loads": [value],
            "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}]
        })
    };
    let notes = |value: Value| {
        let desk = Desk::new();
        drawn(&desk, &load(value));
        let svg = fs::read_to_string(desk.path("o/contact.svg")).unwrap();
        let document = Document::parse(&svg).unwrap();
        let texts = document.descendants().filter(|node| node.tag_name().name() == "text");
        let words: Vec<String> = texts.filter_map(|node| node.text().map(str::to_string)).collect();
        let largest = words.iter().filter_map(|word| word.parse::<f64>().ok()).fold(0.0, f64::max);
        let note = words.iter().find_map(|word| word.strip_prefix("above the scale: up to ")?.parse::<f64>().ok());
        (largest, note)
    };
    let (tick, note) = notes(json!({"force": {"at": [5, 4], "value": [0, -100]}}));
    let peak = note.expect("the legend names the stress above the scale");
    assert!(tick < 0.7 * peak, "the scale goes up to {tick}, the single node to {peak}");
    // A traction loads many nodes, and all stresses are within the scale.
    assert_eq!(notes(json!({"traction": {"boundary": "top", "value": [0, -10]}})).1, None);
}

/// Dots over the contact pressure in plan view cover little of it.
#[test]
fn marks_in_plan_view_do_not_hide_the_pressure() {
    let desk = Desk::new();
    desk.run(&["solve", &example("ball"), "--out", "o"]).ends_with(0);
    let svg = fs::read_to_string(desk.path("o/contact.svg")).unwrap();
    let document = Document::parse(&svg).unwrap();
    let circles: Vec<[f64; 3]> = document
        .descendants()
        .filter(|node| node.attribute("fill") == Some("#d52b1e") && node.attribute("r").is_some())
        .map(|node| [number(&node, "cx"), number(&node, "cy"), number(&node, "r")])
        .collect();
    // The 21 closed nodes; the last one is the key of the legend.
    let dots = &circles[..circles.len() - 1];
    assert_eq!(dots.len(), 21);
    let near =
        dots[1..].iter().map(|dot| (dot[0] - dots[0][0]).hypot(dot[1] - dots[0][1])).fold(f64::INFINITY, f64::min);
    for dot in dots {
        let share = std::f64::consts::PI * dot[2] * dot[2] / (near * near);
        assert!(share < 0.02, "a dot covers {share} of the area of its node");
    }
}

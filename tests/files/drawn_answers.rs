//! Pictures of answers, as the program writes them: they show the body, use the units of the scene, and agree in title
//! and legend.

use std::fs;

use resvg::usvg::roxmltree::Document;
use serde_json::{Value, json};
use support::program::{Desk, example};

/// The words of a picture in a folder.
fn words(desk: &Desk, picture: &str) -> Vec<String> {
    let svg = fs::read_to_string(desk.path(picture)).unwrap();
    let document = Document::parse(&svg).unwrap();
    let texts = document.descendants().filter(|node| node.tag_name().name() == "text");
    texts.filter_map(|node| node.text().map(str::to_string)).collect()
}

fn drawn(desk: &Desk, scene: &Value, command: &[&str]) {
    desk.write("scene.json", scene.to_string());
    desk.run(&[&[command[0], "scene.json"], &command[1..], &["--out", "o"]].concat()).ends_with(0);
}

/// A ring supported on its inner boundary and pressed at its lowest point against a plane; its outer boundary is
/// closed.
fn ring() -> Value {
    json!({
        "title": "Ring", "units": {"length": "mm", "force": "N"},
        "body": {"ring": {"centre": [0, 1], "element": "q8", "radius": {"points": [0.2, 1], "divisions": [6]},
                          "angle": {"points": [0, 255, 285, 360], "divisions": [16, 60, 6]}}},
        "material": {"young": 210000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "inner"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "outer", "approach": "-y",
                       "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}],
        "gap": -0.002
    })
}

/// The horizontal steps of the path with the given stroke width.
fn steps(svg: &str, width: &str) -> Vec<f64> {
    let line = svg
        .lines()
        .find(|line| line.contains(&format!("stroke-width=\"{width}\"")))
        .expect("the picture has a line of this width");
    let data = line.split(" d=\"").nth(1).unwrap().split('"').next().unwrap();
    let mut steps = Vec::new();
    let mut rest = &data[data.find(['l', 'h', 'v']).unwrap_or(data.len())..];
    while let Some(kind) = rest.chars().next() {
        let end = rest[1..].find(['l', 'h', 'v', 'M', 'z']).map_or(rest.len(), |at| at + 1);
        let numbers = rest[1..end].trim();
        // Two numbers have no separator if the second is negative.
        let cut = numbers[1..].find([' ', '-']).map_or(numbers.len(), |at| at + 1);
        match kind {
            'v' => steps.push(0.0),
            _ => steps.push(numbers[..cut].parse().unwrap()),
        }
        rest = &rest[end..];
    }
    steps
}

#[test]
fn the_pressure_curve_of_a_closed_boundary_advances_along_its_arc_length() {
    let desk = Desk::new();
    drawn(&desk, &ring(), &["compare", "--pictures", "answer"]);
    let svg = fs::read_to_string(desk.path("o/pressure.svg")).unwrap();
    let steps = steps(&svg, "9");
    assert!(steps.len() > 6 && steps.iter().all(|&step| step > 0.0), "{steps:?}");
    let words = words(&desk, "o/pressure.svg");
    assert!(words.iter().any(|text| text.starts_with("arc length s along `outer`")), "{words:?}");
    assert!(words.iter().any(|text| text == "Hertz, same force"), "{words:?}");
}

/// Eight elements around a ring have eight corners and eight mid-side nodes outside; a curved outline has more points.
#[test]
fn edges_of_quadratic_elements_are_drawn_as_curves() {
    let desk = Desk::new();
    let mut scene = ring();
    scene["body"]["ring"]["angle"] = json!({"points": [0, 360], "divisions": [8]});
    scene["body"]["ring"]["radius"] = json!({"points": [0.2, 1], "divisions": [1]});
    drawn(&desk, &scene, &["solve"]);
    let svg = fs::read_to_string(desk.path("o/contact.svg")).unwrap();
    let outline = svg.lines().find(|line| line.contains("stroke-width=\"1.4\"")).expect("the picture has an outline");
    let corners = outline.split(" d=\"").nth(1).unwrap().split('"').next().unwrap().matches(['l', 'h', 'v']).count();
    let elements = fs::read_to_string(desk.path("o/report.json")).unwrap();
    let elements = serde_json::from_str::<Value>(&elements).unwrap()["model"]["elements"].as_u64().unwrap();
    assert!(elements == 8 && corners >= 50, "{corners} corners of {elements} elements");
}

#[test]
fn stresses_of_the_size_of_rounding_are_drawn_as_zero() {
    let desk = Desk::new();
    desk.run(&["solve", &example("bar"), "--out", "o"]).ends_with(0);
    let words = words(&desk, "o/contact.svg");
    assert!(words.iter().all(|text| !text.contains("10⁻")), "{words:?}");
    assert!(words.iter().any(|text| text == "−500"), "the scale does not show the largest stress: {words:?}");
}

#[test]
fn the_picture_of_a_body_of_revolution_has_axes_r_and_z() {
    let desk = Desk::new();
    let scene = json!({
        "title": "Punch", "model": "axisymmetric",
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [12]}, "y": {"points": [0, 1], "divisions": [8]}}},
        "material": {"young": 1e9, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0, 1], "radius": 2}}}],
        "gap": -0.01
    });
    drawn(&desk, &scene, &["solve"]);
    let words = words(&desk, "o/contact.svg");
    assert!(words.contains(&"r (m)".to_string()) && words.contains(&"z (m)".to_string()), "{words:?}");
}

/// A node between two obstacles, both closed, counts as one node in the title and in the legend.
#[test]
fn title_and_legend_count_the_same_nodes() {
    let desk = Desk::new();
    let plane = |boundary: &str, approach: &str, point: [f64; 2], normal: [f64; 2]| json!({"boundary": boundary, "approach": approach, "shape": {"plane": {"point": point, "normal": normal}}});
    let scene = json!({
        "title": "Corner",
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [0, 1], "divisions": [4]}}},
        "material": {"young": 1e9, "poisson": 0.3},
        "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "bottom"}, "y": 0}],
        "obstacles": [plane("right", "+x", [1.0, 0.0], [1.0, 0.0]), plane("top", "+y", [0.0, 1.0], [0.0, 1.0])],
        "gap": -0.001
    });
    drawn(&desk, &scene, &["solve"]);
    let words = words(&desk, "o/contact.svg");
    let count = |text: &String| text.chars().filter(char::is_ascii_digit).collect::<String>();
    let legend = words.iter().find(|text| text.starts_with("closed nodes (")).map(count).unwrap();
    assert!(words.iter().any(|text| text.ends_with(&format!("{legend} closed nodes"))), "{legend}: {words:?}");
}

#[test]
fn a_body_in_space_is_drawn_with_its_contact_in_plan_view() {
    let desk = Desk::new();
    desk.run(&["solve", &example("ball"), "--out", "o"]).ends_with(0);
    let words = words(&desk, "o/contact.svg");
    for expected in ["contact on `top` seen along z", "obstacle, rigid, shifted with its contact", "x (m)", "y (m)"] {
        assert!(words.iter().any(|text| text == expected), "`{expected}` is not among {words:?}");
    }
    assert!(words.iter().any(|text| text.starts_with("displaced body, displacement × ")), "{words:?}");
    assert!(words.iter().any(|text| text.starts_with("contact pressure p (")), "{words:?}");
    // The obstacle is transparent, so that the body is visible.
    let svg = fs::read_to_string(desk.path("o/contact.svg")).unwrap();
    assert!(svg.contains("fill-opacity=\".28\""));
}

/// The active-set loop starts with no closed row; the second picture shows the answer. Both use the colours of the
/// answer.
#[test]
fn with_all_pictures_the_iterations_of_a_body_in_space_share_the_colours_of_its_answer() {
    let desk = Desk::new();
    desk.run(&["compare", &example("ball"), "--pictures", "all", "--out", "o"]).ends_with(0);
    let ticks = |picture: &str| {
        let words = words(&desk, picture);
        let number = |word: &String| word.replace('−', "-").parse::<f64>().ok();
        words.iter().filter_map(number).collect::<Vec<f64>>()
    };
    let (answer, first) = (ticks("o/contact.svg"), ticks("o/iteration-1.svg"));
    assert!(answer.len() > 10, "{answer:?}");
    assert_eq!(
        first, answer,
        "the picture of the first iteration, which has no contact, does not use the colours of the answer"
    );
    let title = words(&desk, "o/iteration-1.svg").into_iter().next().unwrap();
    assert!(title.ends_with("iteration 1 of 2, 0 closed nodes"), "{title}");
    // Each picture of an iteration needs an additional solve; it is drawn only on request.
    desk.run(&["compare", &example("ball"), "--out", "usual"]).ends_with(0);
    assert!(desk.path("usual/contact.svg").exists() && !desk.path("usual/iteration-1.svg").exists());
}

#[test]
fn the_title_names_the_forces_that_press_obstacles() {
    let desk = Desk::new();
    let mut scene = ring();
    let plane = |approach: &str, y: f64, normal: f64, force: f64| json!({"boundary": "outer", "approach": approach, "force": force, "shape": {"plane": {"point": [0, y], "normal": [0, normal]}}});
    for (forces, expected) in [([100.0, 100.0], "force 100 N each"), ([100.0, 50.0], "forces 100 N and 50 N")] {
        scene["obstacles"] = json!([plane("-y", 0.0, -1.0, forces[0]), plane("+y", 2.0, 1.0, forces[1])]);
        drawn(&desk, &scene, &["solve"]);
        let words = words(&desk, "o/contact.svg");
        assert!(words[0].contains(expected), "{words:?}");
    }
}

#[test]
fn a_sweep_in_space_reports_the_contact_area() {
    let desk = Desk::new();
    let run = desk.run(&["sweep", &example("ball"), "--gaps", "-0.01:-0.02:2", "--pictures", "none", "--out", "o"]);
    let text = run.ends_with(0).stdout;
    assert!(text.contains("area [m²]") && !text.contains("width"), "{text}");
}

#[test]
fn the_history_of_a_motion_shows_the_unit_of_time() {
    let desk = Desk::new();
    let scene = json!({
        "title": "Block falling",
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [3]}, "y": {"points": [0, 1], "divisions": [3]}}},
        "material": {"young": 1e6, "poisson": 0.3, "density": 1000},
        "loads": [{"body-force": [0, -9810]}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, -0.1], "normal": [0, -1]}}}],
        "analysis": {"dynamic": {"duration": 0.02, "frames": 2}}
    });
    drawn(&desk, &scene, &["solve"]);
    let in_seconds = words(&desk, "o/history.svg");
    assert_eq!(in_seconds.iter().filter(|text| text.starts_with("time t (")).count(), 2, "{in_seconds:?}");
    // For units without a known name, the unit of time is unknown.
    let mut unnamed = scene;
    unnamed["units"] = json!({"length": "inch", "force": "lbf"});
    drawn(&desk, &unnamed, &["solve"]);
    assert!(words(&desk, "o/history.svg").iter().any(|text| text == "time t"));
}

/// At most six curves with their names beside them; the error of the mesh is a line, and exact answers have a separate
/// place.
#[test]
fn a_tradeoff_is_drawn_with_at_most_six_curves() {
    let desk = Desk::new();
    desk.write("block.json", support::program::scene().to_string());
    let run = ["tradeoff", "block.json", "--runs", "1", "--refinements", "0", "--out", "o"];
    desk.run(&run).ends_with(0);
    let words = words(&desk, "o/tradeoff.svg");
    let ways = words.iter().filter(|text| text.contains(" dofs") && !text.contains("contact row")).count();
    assert!((3..=6).contains(&ways), "{words:?}");
    for expected in ["Pareto front", "error of the mesh", "exact"] {
        assert!(words.iter().any(|text| text == expected), "`{expected}` is not among {words:?}");
    }
    assert!(!words.iter().any(|text| text == "10⁻¹⁶"), "{words:?}");
}

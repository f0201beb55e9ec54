//! Every number of a report with planes of symmetry is that of the whole body, or its line names the meshed part.
//!
//! GOAL: a half, a quarter and an eighth print what the whole prints.
//! CONDITIONS: the part has the mesh of the whole, so that the answers differ by rounding only.
//! REFERENCE: the whole body, solved without planes of symmetry.

use serde_json::{Value, json};

use support::program::Desk;

/// Difference of printed numbers of one answer on one mesh, relative: six to ten digits are printed, the last one
/// rounded.
const PRINTED: f64 = 2e-6;

/// Numbers below this share of the largest of their line are rounding.
const ROUNDING: f64 = 1e-9;

/// Names of entries of which the report says in a line of its own that they are of the meshed part.
const OF_PART: [&str; 4] = ["symmetry", "method", "certificate", "seconds"];

/// The x of the middle of a cylinder: a plane of symmetry need not pass through the origin.
const MIDDLE: i32 = 4;

/// A cylinder under a plane, in plane strain, cut at its middle or not.
fn half_cylinder(is_part: bool) -> Value {
    let centre = if is_part { json!([]) } else { json!([{"on": {"point": [MIDDLE, 10]}, "x": 0}]) };
    let mut supports = vec![json!({"on": {"boundary": "upper"}, "y": 0})];
    supports.extend(centre.as_array().unwrap().clone());
    json!({
        "model": "plane-strain", "units": {"length": "mm", "force": "N"},
        "body": {"disc": {"centre": [MIDDLE, 10], "radius": 10, "symmetric": is_part, "element": "q4",
                          "zone": {"width": 1, "divisions": 8}}},
        "material": {"young": 2000, "poisson": 0.3},
        "symmetry": if is_part { json!(["x"]) } else { json!([]) },
        "supports": supports,
        "obstacles": [{"boundary": "lower", "approach": "-y", "force": 100,
                       "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}],
    })
}

/// A block [-1, 1]^2 x [0, 1] under a ball, or the part that planes of symmetry leave; with `z`, the block [-1, 1]^3
/// between two balls.
fn block(planes: &[&str], is_between: bool) -> Value {
    let along = |name: &str, whole: [i32; 2]| match planes.contains(&name) {
        true => json!({"points": [0, 1], "divisions": [4]}),
        false => json!({"points": whole, "divisions": [4 * (whole[1] - whole[0])]}),
    };
    let ball = |boundary: &str, approach: &str, z: i32| {
        json!({"boundary": boundary, "approach": approach, "force": 40,
               "shape": {"sphere": {"apex": [0, 0, z], "radius": 2}}})
    };
    let mut obstacles = vec![ball("top", "+z", 1)];
    if is_between && !planes.contains(&"z") {
        obstacles.push(ball("bottom", "-z", -1));
    }
    let mut supports = Vec::new();
    if !is_between {
        supports.push(json!({"on": {"boundary": "bottom"}, "z": 0}));
    }
    // The whole is held in its planes of symmetry at points of them.
    if planes.is_empty() {
        supports.push(json!({"on": {"point": [0, 1, 0]}, "x": 0}));
        supports.push(json!({"on": {"point": [0, -1, 0]}, "x": 0}));
        supports.push(json!({"on": {"point": [1, 0, 0]}, "y": 0}));
        if is_between {
            supports.push(json!({"on": {"point": [0, 1, 0]}, "z": 0}));
            supports.push(json!({"on": {"point": [1, 0, 0]}, "z": 0}));
            supports.push(json!({"on": {"point": [0, -1, 0]}, "z": 0}));
        }
    }
    json!({
        "model": "space", "units": {"length": "mm", "force": "N"},
        "body": {"box": {"x": along("x", [-1, 1]), "y": along("y", [-1, 1]),
                         "z": along("z", [if is_between { -1 } else { 0 }, 1]), "element": "hex8"}},
        "material": {"young": 1000, "poisson": 0.3},
        "symmetry": planes, "supports": supports, "obstacles": obstacles,
    })
}

/// The entries of a report: the name, with the numbers of each line, except lines that name the meshed part.
fn printed(report: &str) -> Vec<(String, String)> {
    let mut name = String::new();
    let mut found = Vec::new();
    for line in report.lines().skip(1) {
        let (head, content) = line.split_at(line.len().min(16));
        if !head.trim().is_empty() {
            name = head.trim().to_string();
        }
        found.push((name.clone(), content.trim().to_string()));
    }
    found
}

/// The numbers of a text, without those in the names of things.
fn numbers(text: &str) -> Vec<f64> {
    let cleared: String = text.chars().map(|c| if "(),;".contains(c) { ' ' } else { c }).collect();
    cleared.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

fn agree(ours: &[f64], exact: &[f64]) -> bool {
    let largest = exact.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= PRINTED * b.abs() + ROUNDING * largest;
    ours.len() == exact.len() && ours.iter().zip(exact).all(near)
}

/// The numbers of a report with their names; entries of a list have the name of the list and, apart, their place in it.
fn leaves(value: &Value, name: &str, place: &str, found: &mut Vec<(String, String, f64)>) {
    match value {
        Value::Object(entries) => entries.iter().for_each(|(key, value)| {
            let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
            leaves(value, &name, &format!("{place}/{key}"), found);
        }),
        Value::Array(entries) => entries.iter().enumerate().for_each(|(index, value)| {
            leaves(value, name, &format!("{place}/{index}"), found);
        }),
        Value::Number(number) => found.push((name.to_string(), place.to_string(), number.as_f64().unwrap())),
        _ => {}
    }
}

/// Every number of the report of a part is that of the whole, or `of_meshed_part` names it.
fn every_number_is_of_the_whole_or_named(part: &Value, whole: &Value) {
    let named: Vec<&str> =
        part["of_meshed_part"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert!(whole.get("of_meshed_part").is_none() && whole.get("parts_of_whole").is_none(), "{whole}");
    let (mut numbers, mut compared) = (Vec::new(), 0);
    leaves(part, "", "", &mut numbers);
    let is_named = |name: &str| named.iter().any(|of| name == *of || name.starts_with(&format!("{of}.")));
    // Components of a resultant that cancel are rounding beside its force, and its force times the size of the body.
    let resultants: Vec<f64> =
        numbers.iter().filter(|(name, ..)| name.starts_with("resultants.")).map(|n| n.2.abs()).collect();
    let largest = resultants.into_iter().fold(0.0, f64::max);
    let is_rounding = |name: &str, value: f64| name.starts_with("resultants.") && value.abs() <= ROUNDING * largest;
    // The whole has each mirror image of an obstacle as an obstacle of its own.
    let is_factor = |name: &str| ["parts_of_whole", "contact.obstacles.copies"].contains(&name);
    for (name, place, ours) in numbers.iter().filter(|(name, ..)| !is_factor(name) && !is_named(name)) {
        let exact = whole.pointer(place).and_then(Value::as_f64);
        let exact = exact.unwrap_or_else(|| panic!("{place}: {ours}, and the whole has no such number: {whole:#}"));
        // The mirror image of a node moves the other way, and either of the two is the largest.
        let is_mirrored = name == "largest_displacement.value" && (ours + exact).abs() <= PRINTED * exact.abs();
        let is_zero = is_rounding(name, *ours) && is_rounding(name, exact);
        let is_equal = is_mirrored || is_zero || (ours - exact).abs() <= PRINTED * exact.abs();
        assert!(is_equal, "{place}: {ours}, of the whole {exact}");
        compared += 1;
    }
    assert!(compared > 20, "{compared} numbers: {part:#}");
    let messages = |report: &Value| -> Vec<String> {
        let warnings = report["warnings"].as_array().cloned().unwrap_or_default();
        warnings.iter().map(|warning| warning["message"].to_string()).collect()
    };
    for message in messages(part) {
        assert!(message.contains("of the meshed part") || messages(whole).contains(&message), "{message}\n{whole:#}");
    }
}

/// The text and the JSON report of a scene, and both of its sweep over two values.
fn reports(scene: &Value, sweep: &[&str]) -> (String, Value, String, Value) {
    let desk = Desk::new();
    desk.write("scene.json", scene.to_string());
    let text = desk.run(&["solve", "scene.json"]).ends_with(0).stdout;
    let report = desk.run(&["solve", "scene.json", "--format", "json"]).ends_with(0).json();
    let mut swept = vec!["sweep", "scene.json"];
    swept.extend(sweep);
    if sweep.is_empty() {
        return (text, report, String::new(), Value::Null);
    }
    let table = desk.run(&swept).ends_with(0).stdout;
    (text, report, table, desk.run(&[&swept[..], &["--format", "json"]].concat()).ends_with(0).json())
}

/// Compares the entries `contact` and `energy`, and every other line that does not name the part.
fn check(part: &Value, whole: &Value, sweep: &[&str]) {
    let (text, report, table, points) = reports(part, sweep);
    let (of_whole, exact, exact_table, exact_points) = reports(whole, sweep);
    assert!(text.contains("method, certificate, seconds and memory are of the meshed part"), "{text}");
    let expected = printed(&of_whole);
    for (name, line) in printed(&text) {
        let names_part = line.contains("of the meshed part") && !line.contains("times the meshed part");
        if OF_PART.contains(&name.as_str()) || names_part || name == "resultants" || name == "warning" {
            continue;
        }
        let ours = numbers(&line);
        // The line of the basis has the factor to the whole.
        let found = expected.iter().any(|(other, exact)| *other == name && agree(&ours, &numbers(exact)));
        let is_basis = line.contains("times the meshed part");
        assert!(found || is_basis || ours.is_empty(), "{name}: {line}\n{text}\n{of_whole}");
    }
    every_number_is_of_the_whole_or_named(&report, &exact);
    let (solved, exact_solved) = (entries_of(&points, "points"), entries_of(&exact_points, "points"));
    assert_eq!(solved.len(), exact_solved.len());
    for (ours, exact) in solved.iter().zip(&exact_solved) {
        every_number_is_of_the_whole_or_named(ours, exact);
    }
    // Column by column: the closed rows and the iterations are of the part.
    let rows = |table: &str| {
        let of_values = table.lines().skip(3).take_while(|line| line.ends_with("certified"));
        of_values.map(numbers).collect::<Vec<_>>()
    };
    assert!(
        sweep.is_empty() || table.contains("(closed rows), iterations and energy error are of the meshed part"),
        "{table}"
    );
    for (ours, exact) in rows(&table).iter().zip(rows(&exact_table)) {
        // Between the count and the error are force, pressure and extent; of several obstacles they stand in lines of
        // their own.
        let of_whole = |row: &[f64]| [&row[..1], &row[3..row.len() - 1]].concat();
        assert!(agree(&of_whole(ours), &of_whole(&exact)), "{table}\n{exact_table}");
    }
    let of_obstacles = |table: &str| {
        let lines = table.lines().filter(|line| line.contains("obstacles["));
        lines.map(|line| numbers(&line.replace(", twice", ""))).collect::<Vec<_>>()
    };
    for ours in of_obstacles(&table) {
        assert!(of_obstacles(&exact_table).iter().any(|exact| agree(&ours, exact)), "{ours:?}\n{table}\n{exact_table}");
    }
    assert_eq!(rows(&table).len(), rows(&exact_table).len());
    for (ours, exact) in entries_of(&points, "corners").iter().zip(entries_of(&exact_points, "corners")) {
        for (name, exact) in exact.as_object().unwrap() {
            assert!(
                agree(&[ours[name].as_f64().unwrap()], &[exact.as_f64().unwrap()]),
                "{name}: {ours}, of the whole {exact}"
            );
        }
    }
    if !entries_of(&points, "events").is_empty() {
        assert_eq!(points["of_meshed_part"], json!(["events"]));
        assert!(table.contains("a row of the meshed part touches or releases"), "{table}");
    }
}

fn entries_of(sweep: &Value, name: &str) -> Vec<Value> {
    sweep[name].as_array().cloned().unwrap_or_default()
}

/// The scene with obstacles at a prescribed place.
fn at_gap(mut scene: Value) -> Value {
    for obstacle in scene["obstacles"].as_array_mut().unwrap() {
        obstacle.as_object_mut().unwrap().remove("force");
    }
    scene["gap"] = json!(-0.02);
    scene
}

#[test]
fn half_of_a_disc_prints_the_numbers_of_the_whole() {
    check(&half_cylinder(true), &half_cylinder(false), &["--forces", "50:100:2"]);
}

#[test]
fn quarter_of_a_block_under_a_ball_prints_the_numbers_of_the_whole() {
    check(&block(&["x", "y"], false), &block(&[], false), &["--forces", "20:40:2"]);
}

#[test]
fn eighth_of_a_block_between_two_balls_prints_the_numbers_of_the_whole() {
    check(&block(&["x", "y", "z"], true), &block(&[], true), &[]);
}

#[test]
fn half_of_a_disc_prints_the_numbers_of_the_whole_at_every_gap() {
    check(&at_gap(half_cylinder(true)), &at_gap(half_cylinder(false)), &["--gaps", "-0.02:-0.05:2"]);
}

/// At the first gap the contact has a node and its neighbours: the mirror images of nodes decide on its edge.
#[test]
fn quarter_and_eighth_of_a_block_print_the_numbers_of_the_whole_at_every_gap() {
    check(&at_gap(block(&["x", "y"], false)), &at_gap(block(&[], false)), &["--gaps", "-0.02:-0.05:2"]);
    check(&at_gap(block(&["x", "y", "z"], true)), &at_gap(block(&[], true)), &["--gaps", "-0.02:-0.05:2"]);
}

/// Half of a ball, or a quarter of that, on a plate.
fn half_ball(planes: &[&str]) -> Value {
    let centre = json!([{"on": {"point": [0, 0, 10]}, "x": 0, "y": 0}, {"on": {"point": [10, 0, 10]}, "y": 0}]);
    let mut supports = vec![json!({"on": {"boundary": "cut"}, "z": 0})];
    supports.extend(centre.as_array().unwrap().iter().filter(|_| planes.is_empty()).cloned());
    json!({
        "model": "space", "units": {"length": "mm", "force": "N"},
        "body": {"half-ball": {"half": "lower", "centre": [0, 0, 10], "radius": 10, "symmetric": planes,
                               "zone": {"width": 1, "divisions": 2, "growth": 2}}},
        "material": {"young": 2000, "poisson": 0.3},
        "symmetry": planes, "supports": supports,
        "obstacles": [{"boundary": "round", "approach": "-z", "force": 100,
                       "shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}}}],
    })
}

#[test]
fn quarter_of_a_half_ball_prints_the_numbers_of_the_whole() {
    check(&half_ball(&["x", "y"]), &half_ball(&[]), &["--forces", "50:100:2"]);
}

#[test]
fn comparison_and_total_error_name_the_meshed_part() {
    let (part, whole) = (block(&["x", "y"], false), block(&[], false));
    let table = |scene: &Value| {
        let desk = Desk::new();
        desk.write("scene.json", scene.to_string());
        desk.run(&["compare", "scene.json"]).stdout
    };
    let (ours, exact) = (table(&part), table(&whole));
    assert!(ours.contains("301 dofs, 25 contact rows of the meshed part"), "{ours}");
    assert!(
        ours.contains("-sum(lambda) and peak pressure are of the whole body, all other columns of the meshed part.")
    );
    let rows = |table: &str| {
        let of_methods = table.lines().skip_while(|line| !line.starts_with("qp")).take(3);
        of_methods.map(|line| numbers(line)[2..4].to_vec()).collect::<Vec<_>>()
    };
    assert!(rows(&ours).iter().zip(rows(&exact)).take(2).all(|(ours, exact)| agree(ours, &exact)), "{ours}\n{exact}");
    let estimated = |scene: Value| {
        let desk = Desk::new();
        // With rows along normals both are estimated; the supports at points have no guarantee either.
        let mut scene = at_gap(scene);
        scene["obstacles"][0]["rule"] = json!("closest-point");
        desk.write("scene.json", scene.to_string());
        let found = desk.run(&["solve", "scene.json", "--total-error", "0.9", "--format", "json"]).ends_with(0).json();
        found["total_error"]["bound"].as_f64().unwrap()
    };
    let (ours, exact) = (estimated(part), estimated(whole));
    assert!((ours / exact - 1.0).abs() < 1e-3, "{ours}, of the whole {exact}");
    for (command, named) in [
        (&["compare"][..], json!(["agreement"])),
        (&["tradeoff", "--refinements", "0", "--runs", "1"], json!(["advice", "meshes", "points"])),
        (&["solve", "--total-error", "0.9"], json!(["levels", "model"])),
    ] {
        for (scene, expected) in [(block(&["x", "y"], false), named.clone()), (block(&[], false), Value::Null)] {
            let desk = Desk::new();
            desk.write("scene.json", at_gap(scene).to_string());
            let found = desk.run(&[command, &["scene.json", "--format", "json"]].concat()).json();
            assert_eq!(found["of_meshed_part"], expected, "{command:?}");
        }
    }
}

/// A disc between two plates that press with 300 each: the headline names 300 on each plate and the width of one
/// contact, and no sum.
#[test]
fn headline_of_a_disc_between_two_plates_is_a_table_of_plates() {
    let plate = |approach: &str, y: i32, boundary: &str| {
        json!({"boundary": boundary, "approach": approach, "force": 300,
               "shape": {"plane": {"point": [0, y], "normal": [0, y.signum()]}}})
    };
    let mut scene = half_cylinder(true);
    scene["body"]["disc"]["centre"] = json!([MIDDLE, 0]);
    scene["supports"] = json!([{"on": {"point": [MIDDLE, 0]}, "y": 0}]);
    scene["symmetry"] = json!(["x"]);
    scene["obstacles"] = json!([plate("-y", -10, "lower"), plate("+y", 10, "upper")]);
    let (text, report, ..) = reports(&scene, &[]);
    let headline: Vec<_> = printed(&text).into_iter().filter(|(name, _)| name == "contact").collect();
    let of_plates: Vec<_> = headline.iter().filter(|(_, line)| line.starts_with("obstacles[")).collect();
    assert_eq!(of_plates.len(), 2, "{text}");
    for (index, (_, line)) in of_plates.iter().enumerate() {
        // An uncertainty stands behind its value.
        let shown = numbers(&line.split(" ± ").enumerate().fold(String::new(), |text, (at, rest)| {
            text + " " + if at == 0 { rest } else { rest.split_once(' ').map_or("", |(_, rest)| rest) }
        }));
        let one = &report["contact"]["obstacles"][index];
        let uncertainties = line.split(" ± ").skip(1).map(|rest| numbers(rest)[0]);
        let exact = ["pressure_uncertainty", "width_uncertainty"].map(|name| one["estimate"][name].as_f64().unwrap());
        // Two digits are printed.
        assert!(uncertainties.clone().count() == 2, "{line}");
        assert!(
            uncertainties.zip(exact).all(|(shown, exact)| (shown / exact - 1.0).abs() <= 0.05),
            "{line}: {exact:?}"
        );
        let width = one["estimate"]["width"].as_f64().unwrap();
        assert!((shown[0] / 300.0 - 1.0).abs() < PRINTED, "{line}");
        assert!((shown[3] / width - 1.0).abs() < 1e-5, "{line}: {width}");
        // The mean pressure acts on the width, per unit of length.
        assert!((shown[4] * shown[3] / 300.0 - 1.0).abs() < 1e-5, "{line}");
        assert_eq!((&one["copies"], &one["contacts"]), (&json!(1), &json!(1)), "{one}");
    }
    assert!(!headline.iter().any(|(_, line)| line.contains("6.0000") || line.contains("sum of")), "{text}");
    // The contract of JSON: the sum over all rows.
    assert!((report["contact"]["force"].as_f64().unwrap() / 600.0 - 1.0).abs() < PRINTED);
}

/// A disc between two plates that come nearer: a sweep gives each plate its own lines, which are those of the disc
/// between two plates that press with the force of that gap.
#[test]
fn a_sweep_between_two_plates_has_lines_of_each_plate_and_no_sum() {
    let plate = |approach: &str, y: f64, boundary: &str| {
        json!({"boundary": boundary, "approach": approach,
               "shape": {"plane": {"point": [0, y], "normal": [0, y.signum()]}}})
    };
    let mut scene = half_cylinder(true);
    scene["body"]["disc"]["centre"] = json!([MIDDLE, 0]);
    scene["supports"] = json!([{"on": {"point": [MIDDLE, 0]}, "y": 0}]);
    scene["obstacles"] = json!([plate("-y", -10.0, "lower"), plate("+y", 10.02, "upper")]);
    let (.., table, points) = reports(&scene, &["--gaps", "-0.05:-0.1:2"]);
    assert!(!table.contains("sum(lambda)") && !table.contains("all obstacles"), "{table}");
    let mut lines = table.lines().filter(|line| line.contains("obstacles["));
    for point in points["points"].as_array().unwrap() {
        let gap = point["gap"].as_f64().unwrap();
        scene["gap"] = json!(gap);
        let (_, alone, ..) = reports(&scene, &[]);
        for (index, one) in alone["contact"]["obstacles"].as_array().unwrap().iter().enumerate() {
            let line = lines.next().unwrap();
            let shown = numbers(line);
            assert!((shown[0] / gap - 1.0).abs() < PRINTED && line.contains(&format!("obstacles[{index}]")), "{line}");
            assert!((shown[1] / one["force"].as_f64().unwrap() - 1.0).abs() < 1e-5, "{line}: {one}");
            assert!((shown[2] / one["pressure_max"].as_f64().unwrap() - 1.0).abs() < 1e-5, "{line}: {one}");
        }
    }
    assert!(lines.next().is_none(), "{table}");
}

//! Bad scenes and bad problem directories: each ends with its exit code and one sentence that names the place, the
//! value, and what is allowed.

use serde_json::{Value, json};
use support::program::{Desk, Problem, matrix, scene, vector};

/// The small scene with the value at `pointer` replaced, or added to its object if there was none.
fn with(pointer: &str, value: Value) -> Value {
    let mut scene = scene();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match scene.pointer_mut(parent).unwrap() {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        object => object[key] = value,
    }
    scene
}

fn shape(shape: Value) -> Value {
    with("/obstacles/0/shape", shape)
}

fn plane_stress(mut scene: Value) -> Value {
    scene["model"] = json!("plane-stress");
    scene
}

#[test]
fn scenes_that_do_not_describe_a_problem_are_refused() {
    let x = "/body/rectangle/x";
    let table = |points: Value| shape(json!({"table": {"points": points}}));
    let guided = |load: f64, obstacles: Value| {
        let mut scene = with("/supports", json!([{"on": {"boundary": "left"}, "x": 0}]));
        scene["loads"][0]["traction"]["value"][1] = json!(load);
        scene["obstacles"] = obstacles;
        scene
    };
    let above = scene()["obstacles"].clone();
    let mut floating = with("/supports", json!([]));
    floating["obstacles"][0]["shape"] = json!({"plane": {"point": [0, 0.5], "normal": [0, 1]}});
    let mut deep = shape(json!({"circle": {"apex": [0.4, 0.5], "radius": 0.2}}));
    deep["obstacles"][0]["rule"] = json!("closest-point");
    deep["gap"] = json!(-0.3);
    let mut rolling = with("/supports", json!([{"on": {"boundary": "bottom"}, "normal": [1, 2]}]));
    rolling["obstacles"] = json!([]);
    let cases: Vec<(Value, i32, &[&str])> = vec![
        (with("/thicknes", json!(1)), 1, &["at `thicknes`", "unknown key `thicknes`", "`thickness`"]),
        (
            with("/material/nu", json!(0.3)),
            1,
            &["at `material.nu`", "expected one of `young`, `poisson`, `orthotropic`, `expansion`, `density`"],
        ),
        (with("/material/young", json!("steel")), 1, &["at `material.young`", "string \"steel\"", "must be a number"]),
        (with("/gap", json!(null)), 1, &["at `gap`", "null", "must be a number"]),
        (with("/gap", json!(true)), 1, &["at `gap`", "but is `true`", "must be a number"]),
        (with("/units", json!(["m", "N"])), 1, &["at `units`", "array", "must be an object"]),
        (with("/material", json!([1e7, 0.3])), 1, &["at `material`", "array", "must be an object"]),
        (with("/supports", json!({})), 1, &["at `supports`", "object", "must be an array of objects"]),
        (with("/loads", json!(null)), 1, &["at `loads`", "null", "must be an array"]),
        (with("/body", json!([])), 1, &["at `body`", "must be an object with a single key", "an array"]),
        (with("/body", json!({})), 1, &["at `body`", "empty", "a single key"]),
        (with("/body", json!({"blob": {}})), 1, &["at `body.blob`", "unknown choice `blob`", "`rectangle`"]),
        (with("/supports/0/on", json!("bottom")), 1, &["at `supports[0].on`", "\"bottom\"", "single key"]),
        (
            with("/supports/0/on", json!({"boundary": "bottom", "point": [0, 0]})),
            1,
            &["at `supports[0].on`", "a single key", "a second one"],
        ),
        (with("/model", json!(2)), 1, &["at `model`", "must be a string", "the number 2"]),
        (with("/model", json!("plane")), 1, &["at `model`", "`plane`", "`plane-strain`, `plane-stress`"]),
        (with("/obstacles/0/approach", json!("y")), 1, &["at `obstacles[0].approach`", "`y`", "`+y`"]),
        (with("/supports/0/on/boundary", json!("floor")), 1, &["`floor`", "there are left, right, bottom, top"]),
        (with("/loads/0/traction/boundary", json!("")), 1, &["at `loads[0].traction.boundary`", "left, right, bottom"]),
        (with("/obstacles/0/boundary", json!("lid")), 1, &["at `obstacles[0].boundary`", "no boundary `lid`", "left"]),
        (with(&format!("{x}/divisions"), json!([0])), 1, &["x.divisions[0]", "0 cells", "at least 1"]),
        (with(&format!("{x}/divisions"), json!([-4])), 1, &["x.divisions[0]", "the number -4", "not negative"]),
        (with(&format!("{x}/divisions"), json!([2.5])), 1, &["x.divisions[0]", "the number 2.5", "whole number"]),
        (with(&format!("{x}/divisions"), json!([1_000_000_000_000_u64])), 1, &["1000000000000 cells", "5000000 lines"]),
        (with(&format!("{x}/divisions"), json!([400_000_000])), 1, &["body.rectangle", "5000000 lines"]),
        (with(&format!("{x}/divisions"), json!([4, 4])), 1, &["x.divisions", "length 2, but must have 1"]),
        (with(&format!("{x}/points"), json!([0])), 1, &["x.points", "at least two"]),
        (with(&format!("{x}/points"), json!([1, 0])), 1, &["x.points[1]", "must increase"]),
        (with(&format!("{x}/points"), json!([0, 1e-320])), 1, &["body.rectangle"]),
        (with("/thickness", json!(-1)), 1, &["at `thickness`", "-1 is not allowed", "positive"]),
        (with("/thickness", json!(0)), 1, &["at `thickness`", "0 is not allowed", "positive"]),
        (with("/thickness", json!(1e308)), 1, &["at `material`", "overflows", "other units"]),
        (with("/material/young", json!(0)), 1, &["at `material.young`", "0 is not allowed", "positive"]),
        (with("/material/young", json!(-1e7)), 1, &["at `material.young`", "-1e7", "positive"]),
        (with("/material/poisson", json!(0.5)), 1, &["at `material.poisson`", "0.5", "below 0.5"]),
        (with("/material/poisson", json!(-1)), 1, &["at `material.poisson`", "-1", "above -1"]),
        (plane_stress(with("/material/poisson", json!(0.51))), 1, &["at `material.poisson`", "0.51", "at most 0.5"]),
        (with("/supports/0/x", json!(null)), 1, &["at `supports[0].x`", "null is not a number", "remove the key"]),
        (with("/supports/0", json!({"on": {"boundary": "bottom"}})), 1, &["at `supports[0]`", "holds nothing"]),
        (with("/supports/0/normal", json!([0, 0])), 1, &["at `supports[0].normal`", "(0, 0) has no direction"]),
        (with("/supports/0/normal", json!([1])), 1, &["at `supports[0].normal`", "has 1 entry", "[x, y]"]),
        (with("/supports/0/normal", json!([1, 2, 3])), 1, &["at `supports[0].normal`", "has 3 entries"]),
        (with("/supports/0/normal", json!(null)), 1, &["at `supports[0].normal`", "null", "must be an array"]),
        (with("/supports/0/normal", json!(["1", 0])), 1, &["at `supports[0].normal[0]`", "must be a number"]),
        (with("/supports/0/value", json!(1)), 1, &["at `supports[0].value`", "give `normal` too"]),
        (
            with("/supports/0", json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0, "normal": [1, 1], "value": 0.1})),
            1,
            &["at `supports[0].normal`", "0.1 contradicts the 0 that supports[0] prescribes for node 0 at (0, 0)"],
        ),
        (rolling, 3, &["held by neither supports nor obstacle", "translation along", "0.894", "0.447"]),
        (with("/supports/0/on", json!({"point": [0.1, 0.1]})), 1, &["no node at (0.1, 0.1)", "nearest is node"]),
        (table(json!([[0, 1], [0.7, 1], [0.6, 1]])), 1, &["table.points[2]", "0.6", "must increase"]),
        (table(json!([[0, 1], [0.7, 1]])), 1, &["table.points", "from x = 0 to 0.7", "needs it at x = 0.75"]),
        (table(json!([])), 1, &["table.points", "at least two points, but there are 0"]),
        (
            shape(json!({"parabola": {"apex": [0], "radius": 1}})),
            1,
            &["parabola.apex", "1 entry; `parabola` is a shape of the plane"],
        ),
        (
            shape(json!({"parabola": {"apex": [0, 1, 2], "radius": 1}})),
            1,
            &["parabola.apex", "3 entries; `parabola` is a shape of the plane, so that it must have 2: [x, y]"],
        ),
        (shape(json!({"wedge": {"apex": [0, 1], "slope": -1}})), 1, &["wedge.slope", "-1", "positive"]),
        (shape(json!({"plane": {"point": [0, 1], "normal": [0, -1]}})), 1, &["plane.normal", "into the obstacle"]),
        (deep, 1, &["obstacles[0]", "node", "move the obstacle away"]),
        (guided(1.0, json!([])), 3, &["translation along y", "add a support"]),
        (guided(-1.0, above), 3, &["unbounded", "translation along -y"]),
        (floating, 3, &["translation along x", "add a guide"]),
    ];
    assert!(cases.len() >= 40);
    let desk = Desk::new();
    for (scene, code, phrases) in cases {
        desk.write("scene.json", scene.to_string());
        let run = desk.run(&["solve", "scene.json", "--format", "json"]);
        let run = run.fails_with(code, phrases);
        assert!(run.json()["message"].is_string());
    }
}

#[test]
fn plane_stress_accepts_poissons_ratio_of_one_half() {
    let desk = Desk::new();
    desk.write("scene.json", plane_stress(with("/material/poisson", json!(0.5))).to_string());
    desk.run(&["solve", "scene.json"]).ends_with(0);
}

#[test]
fn every_command_that_builds_a_scene_prints_its_warning_on_a_separate_line() {
    let desk = Desk::new();
    desk.write("scene.json", with("/material/poisson", json!(0.4999)).to_string());
    for arguments in [
        &["solve", "scene.json"][..],
        &["compare", "scene.json"],
        &["sweep", "scene.json", "--gaps", "0:-0.01:2"],
        &["export", "scene.json", "p"],
    ] {
        let run = desk.run(arguments).ends_with(0);
        assert!(run.stderr.starts_with("warning: Poisson's ratio 0.4999 "), "{}", run.stderr);
        // An export also prints the number of bytes that it writes.
        assert_eq!(run.stderr.lines().filter(|line| !line.starts_with("writing ")).count(), 1);
    }
}

#[test]
fn files_that_are_not_scenes_are_refused() {
    let right = scene().to_string();
    let change = |from: &str, to: &str| {
        assert!(right.contains(from), "{from}");
        right.replacen(from, to, 1).into_bytes()
    };
    let garbage: Vec<u8> = (0..5000_u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let utf_16: Vec<u8> = right.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let cases: Vec<(Vec<u8>, &[&str])> = vec![
        (b"".to_vec(), &["scene.json:1:1", "the text ends before a value"]),
        (b" \n\n".to_vec(), &["the text ends before a value"]),
        (right.as_bytes()[..right.len() / 2].to_vec(), &["scene.json:1:", "the text ends inside"]),
        (garbage, &["cannot read scene.json", "UTF-8"]),
        (b"\0\x01\x02\x03".to_vec(), &["scene.json:1:1", "expected a value of JSON"]),
        (b"{\"title\": \"\xff\xfe\"}".to_vec(), &["cannot read scene.json", "UTF-8"]),
        (utf_16, &["scene.json"]),
        ("[".repeat(10_000).into_bytes(), &["at `[0]`", "lie inside each other"]),
        ("{\"body\":".repeat(10_000).into_bytes(), &["at `body`", "lie inside each other"]),
        (format!("{{\"title\":{}", "[".repeat(10_000)).into_bytes(), &["at `title`", "lie inside each other"]),
        (format!("{{\"$schema\":{}", "[".repeat(10_000)).into_bytes(), &["at `$schema`", "lie inside each other"]),
        (format!("{{\"gap\":\"{}\"}}", "x".repeat(1_000_000)).into_bytes(), &["at `gap`", "must be a number"]),
        (format!("{{\"{}\":1}}", "x".repeat(100_000)).into_bytes(), &["xxx ... ", "`obstacles`, `contact`, `gap`"]),
        (change("\"title\"", "\"a\\nb\""), &["unknown key `a\\nb`"]),
        (change("\"gap\":-0.01", "\"gap\":NaN"), &["at `gap`", "expected a value of JSON"]),
        (change("\"gap\":-0.01", "\"gap\":-Infinity"), &["at `gap`", "a number must have the form of JSON"]),
        (change("\"gap\":-0.01", "\"gap\":1e999"), &["at `gap`", "number out of range"]),
        (change("\"gap\":-0.01", "\"gap\":0x10"), &["scene.json:1:"]),
        (change("\"gap\":-0.01", "\"gap\":-0.01,\"gap\":0"), &["at `gap`", "the key `gap` stands twice"]),
        (
            change("\"gap\":-0.01,", "\"gap\":-0.01,,"),
            &["scene.json:1:", "at the top level", "expected a key in double quotes, but found `,`"],
        ),
        (format!("{},}}", &right[..right.len() - 1]).into_bytes(), &["no comma may stand before `}`"]),
        (
            change("\"gap\":-0.01", "/* deep */ \"gap\":-0.01"),
            &["scene.json:1:", "expected a key in double quotes, but found `/`"],
        ),
        (format!("{right}{right}").into_bytes(), &["more text after the end of the scene"]),
        (b"null".to_vec(), &["must be an object, but is null"]),
        (b"\"body\"".to_vec(), &["must be an object, but is the string \"body\""]),
    ];
    let desk = Desk::new();
    for (bytes, phrases) in cases {
        desk.write("scene.json", bytes);
        desk.run(&["solve", "scene.json"]).fails_with(1, phrases);
    }
}

#[test]
fn paths_that_are_not_files_are_refused() {
    let desk = Desk::new();
    desk.write("folder/file", "");
    desk.write("block.json", scene().to_string());
    let long = "x".repeat(5000);
    desk.run(&["solve", "nowhere.json"]).fails_with(1, &["cannot read nowhere.json: "]);
    desk.run(&["solve", &long]).fails_with(1, &["cannot read xxx", " ... ", "name too long"]);
    desk.run(&["solve", "new\nline"]).fails_with(1, &["cannot read new\\nline: "]);
    desk.run(&["solve", "folder/file/below"]).fails_with(1, &["cannot read folder/file/below: "]);
    desk.run(&["solve", "folder"])
        .fails_with(1, &["cannot read folder: ", "K.mtx (stiffness), f.mtx (load)", "a scene is a .json file"]);
    desk.run(&["export", "block.json", &long]).fails_with(1, &["cannot make the folder xxx", "name too long"]);
    for arguments in [&["sweep", "folder", "--gaps", "0:1:2"][..], &["export", "folder", "p"]] {
        desk.run(arguments).fails_with(1, &["cannot read folder: it is a folder, but a scene is a JSON file"]);
    }
}

#[test]
fn problem_directories_with_invalid_files_are_refused() {
    let right = Problem::right;
    let symmetric = |entries: &[&str]| matrix("symmetric", "2 2", entries);
    let k = |k: String| Problem { k, ..right() };
    let f = |f: String| Problem { f, ..right() };
    let b = |b: String| Problem { b, ..right() };
    let g = |g: String| Problem { g, ..right() };
    let header = "%%MatrixMarket matrix coordinate real general\n";
    let unsymmetric = matrix("general", "2 2", &["1 1 2", "2 1 -1", "1 2 1", "2 2 2"]);
    let one_sided = matrix("general", "2 2", &["1 1 2", "1 2 -1", "2 2 2"]);
    let cases: Vec<(Problem, i32, &[&str])> = vec![
        (k(String::new()), 1, &["p/K.mtx:1", "the file is empty"]),
        (k("\0\x01garbage".into()), 1, &["p/K.mtx:1", "the first line is", "%%MatrixMarket matrix"]),
        (k("x".repeat(1_000_000)), 1, &["p/K.mtx:1", "xxx...`"]),
        (k("2 -1\n-1 2\n".into()), 1, &["p/K.mtx:1", "the first line is `2 -1`"]),
        (k(unsymmetric), 1, &["not symmetric", "entry (1, 0) is -1e0, entry (0, 1) is 1e0"]),
        (k(one_sided), 1, &["not symmetric", "give both triangles with equal entries"]),
        (k(matrix("general", "2 3", &["1 1 2"])), 1, &["stiffness is 2 x 3", "must be 2 x 2"]),
        (k(symmetric(&["1 1 2", "1 2 -1", "2 2 2"])), 1, &["p/K.mtx:4", "(1, 2) lies above the diagonal"]),
        (k(symmetric(&["1 1 nan", "2 2 2"])), 1, &["p/K.mtx:3", "NaN", "must be finite"]),
        (k(symmetric(&["1 1 2", "2 2 1e999"])), 1, &["p/K.mtx:4", "inf", "must be finite"]),
        (k(symmetric(&["1 1 1", "2 1 -3", "2 2 1"])), 1, &["not positive semidefinite", "not convex"]),
        (k(symmetric(&["1 1 -1", "2 2 2"])), 1, &["diagonal entry 0 is -1e0", "not convex"]),
        (k(symmetric(&["1 1 2", "3 3 2"])), 1, &["p/K.mtx:4", "entry (3, 3) lies outside 2 x 2", "from 1"]),
        (k(symmetric(&["1 1 2", "2 2"])), 1, &["p/K.mtx:4", "`2 2` is not an entry", "row column value"]),
        (k(format!("{header}2 2 5\n1 1 2\n2 2 2\n")), 1, &["p/K.mtx:4", "ends after 2 of 5 entries"]),
        (k(format!("{header}2 2 1\n1 1 2\n2 2 2\n")), 1, &["p/K.mtx:4", "more entries than the 1 announced"]),
        (k(format!("{header}1e9 1e9 0\n")), 1, &["p/K.mtx:2", "the sizes are `1e9 1e9 0`", "3 whole numbers"]),
        (k(format!("{header}999999999999 999999999999 0\n")), 1, &["p/K.mtx:2", "too large", "at most 100000000"]),
        (f(vector(&["1", "1", "1"])), 1, &["load vector has length 3", "2 dofs"]),
        (f(vector(&["1", "NaN"])), 1, &["p/f.mtx:4", "NaN", "must be finite"]),
        (f(vector(&["1", "-inf"])), 1, &["p/f.mtx:4", "-inf", "must be finite"]),
        (f(vector(&["1", "one"])), 1, &["p/f.mtx:4", "`one` is not a number"]),
        (f(matrix("general", "2 2", &["1 1 1"])), 1, &["p/f.mtx:2", "one column", "2 x 2"]),
        (b(matrix("general", "1 3", &["1 2 1"])), 1, &["contact matrix is 1 x 3", "must be 1 x 2"]),
        (b(matrix("general", "1 2", &["1 2 inf"])), 1, &["p/B.mtx:3", "inf", "must be finite"]),
        (b(matrix("general", "2 2", &["1 2 1"])), 1, &["gap vector has length 1", "2 contact rows"]),
        (g(vector(&["0.1", "0.2"])), 1, &["gap vector has length 2", "1 contact rows"]),
        (g(vector(&["nan"])), 1, &["p/g.mtx:3", "NaN", "inf for a row without obstacle"]),
        (g(vector(&["-inf"])), 1, &["p/g.mtx:3", "-inf", "inf for a row without obstacle"]),
        (
            Problem { b: matrix("general", "1 2", &[]), g: vector(&["-1"]), ..right() },
            3,
            &["infeasible", "no free dof"],
        ),
        (Problem::infeasible(), 3, &["infeasible", "rows 0 and 1", "overlap by 2e0"]),
        (Problem::unbounded(), 3, &["unbounded", "dof 1"]),
        (Problem::under_held(), 3, &["held by neither supports nor obstacle", "dof 1"]),
    ];
    assert!(cases.len() >= 30);
    let desk = Desk::new();
    for (problem, code, phrases) in cases {
        desk.problem("p", &problem);
        let run = desk.run(&["solve", "p", "--format", "json"]).fails_with(code, phrases);
        assert!(run.json()["message"].is_string());
    }
}

#[test]
fn missing_problem_files_and_folders_in_their_place_are_named() {
    for name in ["K", "f", "B", "g"] {
        let desk = Desk::new();
        desk.problem("p", &Problem::right());
        std::fs::remove_file(desk.path(&format!("p/{name}.mtx"))).unwrap();
        let phrase = format!("cannot read p/{name}.mtx: ");
        // Without a stiffness the folder is no problem directory.
        let missing = if name == "K" { "cannot read p: the folder has neither K.mtx nor K.petsc" } else { &phrase };
        desk.run(&["compare", "p"]).fails_with(1, &[missing]);
        desk.write(&format!("p/{name}.mtx/inside"), "");
        desk.run(&["compare", "p"]).fails_with(1, &[&phrase]);
    }
}

#[test]
fn verify_refuses_answers_of_wrong_size_or_with_invalid_values() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    let (u, lambda) = (vector(&["0.55", "0.1"]), vector(&["-1.35"]));
    let cases: [(String, String, &[&str]); 6] = [
        (vector(&["1"]), lambda.clone(), &["displacement has length 1", "2 dofs"]),
        (u.clone(), vector(&["1", "2"]), &["multiplier has length 2", "1 contact rows"]),
        (vector(&["nan", "0.1"]), lambda.clone(), &["u.mtx:3", "NaN", "must be finite"]),
        (vector(&["0.55", "inf"]), lambda.clone(), &["u.mtx:4", "inf", "must be finite"]),
        (u.clone(), vector(&["-inf"]), &["lambda.mtx:3", "-inf", "must be finite"]),
        (u.clone(), "-1.35\n".into(), &["lambda.mtx:1", "the first line is `-1.35`"]),
    ];
    for (u, lambda, phrases) in cases {
        desk.write("u.mtx", u);
        desk.write("lambda.mtx", lambda);
        desk.run(&["verify", "p", "--displacement", "u.mtx", "--multiplier", "lambda.mtx"]).fails_with(1, phrases);
    }
    desk.write("u.mtx", u);
    let run = desk.run(&["verify", "p", "--displacement", "u.mtx", "--multiplier", "nowhere.mtx"]);
    run.fails_with(1, &["cannot read nowhere.mtx"]);
}

#[test]
fn problem_files_with_a_byte_order_mark_other_encodings_in_comments_or_split_entries_are_read() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    let (header, rest) = (
        b"\xef\xbb\xbf%%MatrixMarket matrix coordinate real symmetric\r\n",
        b"2 2 4\r\n1 1 2\r\n2 1 -1\r\n2 2 1.5\r\n2 2 0.5\r\n",
    );
    desk.write("p/K.mtx", [&header[..], b"% author: J. M\xfcller\r\n", rest].concat());
    let split = matrix("general", "2 1", &["1 1 1", "2 1 0.25", "2 1 0.75"]);
    desk.write("p/f.mtx", split);
    let answer = desk.run(&["solve", "p", "--format", "json"]).ends_with(0).json();
    assert!((answer["contact"]["force"].as_f64().unwrap() - 1.35).abs() < 1e-15);
}

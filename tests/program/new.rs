//! The command `new` writes a first scene for a mesh, which runs without changes.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};
use support::program::Desk;

/// Mesh files from Gmsh: of every element, and of parts without an obvious side to hold or to press.
fn meshes() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let of = |part: &str| -> Vec<String> {
        let names = fs::read_dir(folder.join(part)).unwrap();
        let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.filter(|name| name.ends_with(".msh")).map(|name| format!("{part}{name}")).collect()
    };
    let mut names = [of(""), of("parts/")].concat();
    names.sort();
    names
}

fn copied(desk: &Desk, name: &str) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name);
    desk.write(name, fs::read(from).unwrap());
}

/// The first scene of a mesh of this name, beside it.
fn first_scene(desk: &Desk, name: &str) -> String {
    copied(desk, name);
    let file = name.replace(".msh", ".json");
    let run = desk.run(&["new", name, "--out", &file]).ends_with(0);
    assert!(run.stdout.contains(&file), "{}", run.stdout);
    fs::read_to_string(desk.path(&file)).unwrap()
}

#[test]
fn the_first_scene_of_every_mesh_is_certified_without_changes() {
    let names = meshes();
    assert!(names.len() >= 25, "{names:?}");
    for name in names {
        let desk = Desk::new();
        let text = first_scene(&desk, &name);
        let file = name.rsplit('/').next().unwrap();
        assert!(text.starts_with(&format!("// A first scene for {file}")), "{text}");
        let scene = name.replace(".msh", ".json");
        let run = desk.run(&["solve", &scene, "--format", "json"]);
        assert_eq!(run.code, 0, "{name}: {}{text}", run.stderr);
        let report = run.json();
        assert_eq!(report["status"], "certified", "{name}");
        // The plate presses the body: it has a travel, and the sum of its forces is the force in the scene.
        assert!(report["resultants"][0]["travel"].as_f64().unwrap() > 0.0, "{name}: {}", report["resultants"]);
    }
}

/// The normals of a bore along the way of the plate are all perpendicular to it; those of a whole bore face all
/// directions.
#[test]
fn a_bore_is_pressed_only_where_it_faces_the_plate() {
    let desk = Desk::new();
    let upright = first_scene(&desk, "parts/bored-block.msh");
    assert!(!upright.contains("\"boundary\": \"bore\"") && !upright.contains("\"of\": \"bore\""), "{upright}");
    assert!(first_scene(&desk, "parts/plate-with-hole.msh").contains("\"boundary\": \"right\", \"approach\": \"+x\""));
    let across = first_scene(&desk, "parts/bored-across.msh");
    assert!(across.contains("\"of\": \"contact\", \"normal\": {\"direction\": [0, 0, 1], \"within\": 45}"), "{across}");
}

/// Two boxes in one group: a boundary of one of them would leave the other without a support.
#[test]
fn every_piece_of_a_mesh_is_held() {
    let desk = Desk::new();
    let text = first_scene(&desk, "parts/two-boxes.msh");
    assert!(text.contains("\"name\": \"held\", \"normal\": {\"direction\": [0, 0, -1]"), "{text}");
}

#[test]
fn two_commands_lead_from_a_mesh_to_an_answer() {
    let desk = Desk::new();
    copied(&desk, "box-tet10.msh");
    let program = env!("CARGO_BIN_EXE_signorini");
    let script = format!("'{program}' new box-tet10.msh | '{program}' solve - --format json");
    let output = Command::new("sh").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["status"], "certified");
}

#[test]
fn a_first_scene_lists_the_groups_of_the_file_and_guesses_its_unit() {
    let desk = Desk::new();
    copied(&desk, "two-parts-q8.msh");
    let metres = desk.run(&["new", "two-parts-q8.msh"]).ends_with(0).stdout;
    for phrase in
        ["\"first\", \"second\"", "boundary \"interface\"", "in metres", "\"length\": \"m\"", "\"young\": 2.1e11"]
    {
        assert!(metres.contains(phrase), "{phrase}: {metres}");
    }
    desk.write("empty.msh", "");
    desk.run(&["new", "empty.msh"]).fails_with(1, &["empty.msh"]);
    desk.run(&["new", "none.msh"]).fails_with(1, &["none.msh"]);
    desk.run(&["new"]).ends_with(2);
}

#[test]
fn comment_lines_do_not_change_the_line_numbers_of_errors() {
    let desk = Desk::new();
    desk.write("scene.json", "// a comment\n{\n  // another\n  \"Gap\": 1\n}\n");
    desk.run(&["solve", "scene.json"]).fails_with(1, &["scene.json:4:", "unknown key `Gap`"]);
}

/// A block of bricks, or of tetrahedra; blocks of one `glue` share the nodes of the places that they share.
#[derive(Clone, Copy)]
struct Block {
    group: &'static str,
    glue: usize,
    corners: [[f64; 3]; 2],
    cells: usize,
    tetrahedra: bool,
}

fn block(group: &'static str, glue: usize, low: [f64; 3], high: [f64; 3]) -> Block {
    Block { group, glue, corners: [low, high], cells: 2, tetrahedra: false }
}

/// The cells of a block: each with its eight places, in the order of a brick of Gmsh.
fn cells(block: &Block) -> Vec<[[f64; 3]; 8]> {
    const CORNERS: [[usize; 3]; 8] =
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let [low, high] = block.corners;
    let at = |axis: usize, line: usize| low[axis] + (high[axis] - low[axis]) * line as f64 / block.cells as f64;
    let cell = |number: usize| {
        let first = [number % block.cells, number / block.cells % block.cells, number / block.cells.pow(2)];
        CORNERS.map(|corner| [0, 1, 2].map(|axis| at(axis, first[axis] + corner[axis])))
    };
    (0..block.cells.pow(3)).map(cell).collect()
}

/// A mesh file of version 2.2 with a group for each block and, as the group `base`, the faces of all blocks at z = 0.
fn mesh_of(blocks: &[Block], has_base: bool) -> String {
    // The six tetrahedra of a brick around its diagonal from 0 to 6.
    const PATHS: [[usize; 4]; 6] = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];
    let mut numbers: BTreeMap<(usize, [u64; 3]), usize> = BTreeMap::new();
    let (mut nodes, mut elements) = (String::new(), Vec::new());
    for (group, block) in blocks.iter().enumerate() {
        for cell in cells(block) {
            let brick = cell.map(|at| {
                let next = numbers.len() + 1;
                let number = *numbers.entry((block.glue, at.map(f64::to_bits))).or_insert(next);
                if number == next {
                    writeln!(nodes, "{number} {} {} {}", at[0], at[1], at[2]).unwrap();
                }
                number
            });
            let mut push = |kind: usize, tag: usize, places: &[usize]| {
                let places: Vec<String> = places.iter().map(|&place| brick[place].to_string()).collect();
                elements.push(format!("{kind} 2 {tag} 1 {}", places.join(" ")));
            };
            match block.tetrahedra {
                true => PATHS.iter().for_each(|path| push(4, group + 1, path)),
                false => push(5, group + 1, &[0, 1, 2, 3, 4, 5, 6, 7]),
            }
            if has_base && cell[0][2] == 0.0 {
                match block.tetrahedra {
                    true => [[0, 2, 1], [0, 3, 2]].iter().for_each(|face| push(2, 90, face)),
                    false => push(3, 90, &[0, 3, 2, 1]),
                }
            }
        }
    }
    let mut names: Vec<String> =
        blocks.iter().enumerate().map(|(group, block)| format!("3 {} \"{}\"", group + 1, block.group)).collect();
    names.extend(has_base.then(|| "2 90 \"base\"".to_string()));
    let elements: Vec<String> =
        elements.iter().enumerate().map(|(number, element)| format!("{} {element}\n", number + 1)).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n{}\n$EndPhysicalNames\n$Nodes\n{}\n{nodes}$EndNodes\n\
         $Elements\n{}\n{}$EndElements\n",
        names.len(),
        names.join("\n"),
        numbers.len(),
        elements.len(),
        elements.concat()
    )
}

/// The first scene of these blocks as text and as JSON, and the report of its solution.
fn started(blocks: &[Block], has_base: bool) -> (String, Value, Value) {
    let desk = Desk::new();
    desk.write("blocks.msh", mesh_of(blocks, has_base));
    desk.run(&["new", "blocks.msh", "--out", "blocks.json"]).ends_with(0);
    let text = fs::read_to_string(desk.path("blocks.json")).unwrap();
    let plain: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let run = desk.run(&["solve", "blocks.json", "--format", "json"]);
    assert_eq!(run.code, 0, "{}{text}", run.stderr);
    (text.clone(), serde_json::from_str(&plain.join("\n")).unwrap(), run.json())
}

/// The forces between bodies, in the order of the pairs.
fn between(report: &Value) -> Vec<f64> {
    let of_pairs = report["contact"]["obstacles"].as_array().unwrap().iter().filter(|one| !one["between"].is_null());
    of_pairs.map(|one| one["force"].as_f64().unwrap()).collect()
}

/// Rounding, and the springs: they take less of the force than this share.
const SPRINGS: f64 = 1e-3;

/// The lower block consists of bricks, the upper one of tetrahedra.
#[test]
fn volumes_that_share_no_node_are_bodies_that_touch() {
    let upper = Block { tetrahedra: true, cells: 3, ..block("cap", 1, [0.0, 0.0, 1.0], [1.0, 1.0, 2.0]) };
    let (text, scene, report) = started(&[block("foot", 0, [0.0; 3], [1.0; 3]), upper], true);
    assert_eq!(scene["body"]["gmsh"]["group"], "foot");
    assert_eq!(scene["further-bodies"][0]["name"], "cap");
    assert_eq!(scene["further-bodies"][0]["body"]["gmsh"]["group"], "cap");
    assert_eq!(scene["contact"], "auto");
    for line in [
        "in 2 bodies",
        "// `body`: the group \"foot\", 8 elements Hex8.",
        "// further body \"cap\": the group \"cap\", 162 elements Tet4.",
        "// The bodies share no node: only contact joins them.",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    // The whole force goes from one body to the other.
    let force = scene["obstacles"][0]["force"].as_f64().unwrap();
    let [between] = between(&report)[..] else { panic!("{report}") };
    assert!((between / force - 1.0).abs() < SPRINGS, "{between} of {force}");
}

#[test]
fn volumes_that_share_nodes_are_one_body() {
    let core = block("core", 0, [0.0; 3], [1.0; 3]);
    let shell = block("shell", 0, [0.0, 0.0, 1.0], [1.0, 1.0, 2.0]);
    let (text, scene, report) = started(&[core, shell], false);
    assert_eq!(scene["body"]["gmsh"]["group"], json!(["core", "shell"]));
    assert!(text.contains("16 elements Hex8; glued: \"core\" and \"shell\" share 9 nodes."), "{text}");
    assert!(!text.contains("only contact joins"), "{text}");
    assert_eq!((&scene["further-bodies"], &scene["springs"]), (&Value::Null, &Value::Null));
    // All nodes of both, those of the interface once.
    assert_eq!(report["model"]["nodes"], 45);
    assert!(between(&report).is_empty(), "{report}");
}

/// Bodies side by side along x, of which the middle one is glued from two groups.
#[test]
fn three_bodies_in_a_row_are_pressed_along_the_row() {
    let at = |group, glue, from: f64, to: f64| block(group, glue, [from, 0.0, 0.0], [to, 1.0, 1.0]);
    let blocks = [at("one", 0, 0.0, 1.0), at("two", 1, 1.0, 2.0), at("more", 1, 2.0, 3.0), at("three", 2, 3.0, 4.0)];
    let (text, scene, report) = started(&blocks, false);
    let names: Vec<&Value> = scene["further-bodies"].as_array().unwrap().iter().map(|body| &body["name"]).collect();
    assert_eq!(names, ["two", "three"]);
    assert_eq!(scene["further-bodies"][0]["body"]["gmsh"]["group"], json!(["two", "more"]));
    assert!(text.contains("further body \"two\": the groups \"two\", \"more\", 16 elements Hex8; glued:"), "{text}");
    assert_eq!(scene["obstacles"][0]["approach"], "+x");
    let force = scene["obstacles"][0]["force"].as_f64().unwrap();
    let between = between(&report);
    assert!(
        between.len() == 2 && between.iter().all(|one| (one / force - 1.0).abs() < SPRINGS),
        "{between:?} of {force}"
    );
}

/// A boundary `base` of the first body, and a body `base`.
#[test]
fn a_body_with_the_name_of_a_boundary_gets_another_name() {
    let blocks = [block("foot", 0, [0.0; 3], [1.0; 3]), block("base", 1, [0.0, 0.0, 1.0], [1.0, 1.0, 2.0])];
    let (_, scene, report) = started(&blocks, true);
    assert_eq!(scene["further-bodies"][0]["name"], "base-body");
    assert_eq!(scene["further-bodies"][0]["body"]["gmsh"]["group"], "base");
    assert_eq!(between(&report).len(), 1);
}

/// A core in a ring stands on the same plane: both are held there, and no spring is needed.
#[test]
fn bodies_that_stand_on_one_plane_are_both_held() {
    let around = (0..9).filter(|&place| place != 4).map(|place| [(place % 3) as f64, (place / 3) as f64]);
    let mut blocks: Vec<Block> = around.map(|[x, y]| block("ring", 0, [x, y, 0.0], [x + 1.0, y + 1.0, 1.0])).collect();
    blocks.push(block("core", 1, [1.0, 1.0, 0.0], [2.0, 2.0, 1.5]));
    let (_, scene, report) = started(&blocks, false);
    let held: Vec<&Value> = scene["supports"].as_array().unwrap().iter().map(|support| &support["on"]).collect();
    assert_eq!(held, [&json!({"boundary": "held"}), &json!({"boundary": "held of core"})]);
    assert_eq!(scene["springs"], Value::Null);
    assert!(between(&report).len() == 1, "{report}");
}

/// Without its springs the cap is loose; the supports that the refusal gives hold it.
#[test]
fn a_refusal_of_a_loose_body_names_it_with_supports_that_hold_it() {
    let blocks = [block("foot", 0, [0.0; 3], [1.0; 3]), block("cap", 1, [0.0, 0.0, 1.0], [1.0, 1.0, 2.0])];
    let (_, mut scene, _) = started(&blocks, true);
    scene.as_object_mut().unwrap().remove("springs");
    let desk = Desk::new();
    desk.write("blocks.msh", mesh_of(&blocks, true));
    desk.write("loose.json", scene.to_string());
    let run = desk.run(&["solve", "loose.json"]).ends_with(3);
    let (motions, advice) = run.stderr.split_once(": contact without friction does not hold it").unwrap();
    for motion in ["along x of `cap`", "along y of `cap`", "about z through (0.5, 0.5, 1.5) of `cap`"] {
        assert!(motions.contains(motion), "{motion}: {motions}");
    }
    assert!(!motions.contains("first body"), "{motions}");
    let given = advice.split_once("such as ").unwrap().1.split_once(" in `supports`").unwrap().0;
    let given: Vec<Value> = serde_json::from_str(&format!("[{given}]")).unwrap();
    scene["supports"].as_array_mut().unwrap().extend(given);
    desk.write("held.json", scene.to_string());
    let force = scene["obstacles"][0]["force"].as_f64().unwrap();
    let report = desk.run(&["solve", "held.json", "--format", "json"]).ends_with(0).json();
    assert!((between(&report)[0] / force - 1.0).abs() < SPRINGS, "{report}");
}

#[test]
fn a_group_of_a_mesh_is_a_name_or_a_list_of_names() {
    let desk = Desk::new();
    let blocks = [block("core", 0, [0.0; 3], [1.0; 3]), block("shell", 0, [0.0, 0.0, 1.0], [1.0, 1.0, 2.0])];
    desk.write("blocks.msh", mesh_of(&blocks, true));
    let scene = |group: Value| {
        let body = json!({"gmsh": {"file": "blocks.msh", "group": group}});
        json!({"model": "space", "body": body, "material": {"young": 1, "poisson": 0.3},
               "supports": [{"on": {"boundary": "base"}, "x": 0, "y": 0, "z": 0}],
               "loads": [{"body-force": [0, 0, -0.1]}]})
    };
    for (group, nodes) in [(json!("core"), 27), (json!(["core"]), 27), (json!(["shell", "core"]), 45)] {
        desk.write("part.json", scene(group).to_string());
        let report = desk.run(&["solve", "part.json", "--format", "json"]).ends_with(0).json();
        assert_eq!(report["model"]["nodes"], nodes);
    }
    for (group, words) in [
        (json!([]), "at `body.gmsh.group`: the list has no name"),
        (json!(3), "must be a name, or a list of names, but is the number 3"),
        (json!(["core", 3]), "at `body.gmsh.group[1]`: must be a string, but is the number 3"),
        (json!(["core", "shel"]), "did you mean `shell`?"),
        (json!(["core", "base"]), "the elements of `core` and `base` have different dimensions"),
    ] {
        desk.write("part.json", scene(group).to_string());
        desk.run(&["solve", "part.json"]).fails_with(1, &[words]);
    }
    let schema: Value = serde_json::from_str(&desk.run(&["schema"]).ends_with(0).stdout).unwrap();
    let group = &schema["$defs"]["GmshSpec"]["properties"]["group"];
    assert_eq!(group["anyOf"][0]["type"], "string", "{group}");
    assert_eq!(group["anyOf"][1]["items"]["type"], "string", "{group}");
    let is_required = schema["$defs"]["GmshSpec"]["required"].as_array().unwrap().contains(&json!("group"));
    assert!(!is_required, "{schema}");
}

#[test]
fn the_scene_of_a_deck_is_solved_as_the_deck_itself() {
    let desk = Desk::new();
    desk.write("stack.inp", fs::read(support::root().join("tests/faults/stack.inp")).unwrap());
    let run = desk.run(&["new", "stack.inp", "--out", "stack.json"]).ends_with(0);
    assert_eq!(run.stdout, "stack.json: written as the scene of the deck; solve it, then change it\n");
    let [deck, scene] =
        ["stack.inp", "stack.json"].map(|file| desk.run(&["solve", file, "--format", "json"]).ends_with(0).json());
    assert_eq!(deck["resultants"], scene["resultants"]);
    assert!(deck["resultants"].as_array().unwrap().len() >= 4, "{deck}");
    // The text has a comment for each warning that the deck itself has.
    let text = fs::read_to_string(desk.path("stack.json")).unwrap();
    let of_deck: Vec<&Value> = deck["warnings"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|warning| ["deck", "nonlinear"].contains(&warning["code"].as_str().unwrap()))
        .collect();
    assert_eq!(of_deck.len(), text.lines().filter(|line| line.starts_with("// Warning, line ")).count());
    assert_eq!(of_deck.len(), 3);
}

#[test]
fn friction_and_files_elsewhere_need_a_permission() {
    let desk = Desk::new();
    let deck = fs::read_to_string(support::root().join("tests/faults/stack.inp")).unwrap();
    desk.write("rubs.inp", deck.replace("*CONTACT PAIR", "*FRICTION\n0.1, 1.E5\n*CONTACT PAIR"));
    for command in ["solve", "new"] {
        desk.run(&[command, "rubs.inp"]).fails_with(1, &["rubs.inp:50: *FRICTION of 0.1", "--without-friction"]);
        let run = desk.run(&[command, "rubs.inp", "--without-friction"]).ends_with(0);
        assert!((run.stderr + &run.stdout).contains("the friction of 0.1 is left out"), "{command}");
    }
    let (nodes, rest) = deck.split_at(deck.find("*ELEMENT").unwrap());
    desk.write("nodes.inc", nodes);
    fs::create_dir(desk.path("below")).unwrap();
    desk.write("below/stack.inp", format!("*INCLUDE, INPUT=../nodes.inc\n{rest}"));
    for command in ["solve", "new"] {
        desk.run(&[command, "below/stack.inp"]).fails_with(1, &["stack.inp:1: the included file", "--allow-outside"]);
        desk.run(&[command, "below/stack.inp", "--allow-outside"]).ends_with(0);
    }
}

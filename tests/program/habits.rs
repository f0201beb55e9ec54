//! Conventions of command-line programs: completions, a manual page, reasons for decisions, and suggestions for
//! misspelt names.

use std::process::Command;

use serde_json::{Value, json};
use signorini::Scene;
use support::program::{Desk, Problem, example, says, scene, vector};

/// The names listed under `Commands:` in the help.
fn commands(desk: &Desk) -> Vec<String> {
    let help = desk.run(&["--help"]).ends_with(0).stdout;
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap().to_string();
    list.lines().map(|line| line.split_whitespace().next().unwrap().to_string()).filter(|name| name != "help").collect()
}

/// The long options in the help of a command.
fn options(desk: &Desk, command: &str) -> Vec<String> {
    let help = desk.run(&[command, "--help"]).ends_with(0).stdout;
    let lines = help.lines().map(str::trim_start).filter(|line| line.starts_with('-'));
    let words = lines.filter_map(|line| line.split(' ').find(|word| word.starts_with("--")));
    words.map(|word| word.trim_end_matches(',').to_string()).collect()
}

#[test]
fn completions_of_every_shell_contain_commands_and_options() {
    let desk = Desk::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = desk.run(&["completions", shell]).ends_with(0).stdout;
        for word in commands(&desk).iter().map(String::as_str).chain(["total-error", "max-memory"]) {
            assert!(script.contains(word), "{shell} does not contain {word}");
        }
    }
    desk.run(&["completions", "tcsh"]).ends_with(2);
}

#[test]
fn bash_completes_commands_options_and_methods() {
    let desk = Desk::new();
    desk.write("signorini.bash", desk.run(&["completions", "bash"]).ends_with(0).stdout);
    for (words, expected) in [
        ("signorini so", "solve"),
        ("signorini solve --total", "--total-error"),
        ("signorini solve --method act", "active-set"),
        ("signorini completions z", "zsh"),
    ] {
        let words: Vec<String> = words.split(' ').map(|word| format!("'{word}'")).collect();
        let script = format!(
            "source signorini.bash; COMP_WORDS=({}); COMP_CWORD={}; _signorini signorini {} {}; echo \"${{COMPREPLY[@]}}\"",
            words.join(" "),
            words.len() - 1,
            words[words.len() - 1],
            words[words.len() - 2],
        );
        let output = Command::new("bash").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
        let reply = String::from_utf8(output.stdout).unwrap();
        assert!(reply.split_whitespace().any(|word| word == expected), "{words:?}: {reply:?}, {:?}", output.stderr);
    }
}

#[test]
fn the_page_of_the_manual_has_every_command_with_its_options() {
    let desk = Desk::new();
    let page = desk.run(&["man"]).ends_with(0).stdout;
    let plain = page.replace("\\-", "-");
    assert_eq!(page.lines().filter(|line| line.starts_with(".TH ")).count(), 1, "there is one title");
    assert_eq!(page.lines().filter(|line| line.starts_with(".ie ")).count(), 1, "the macros are set up once");
    for command in commands(&desk) {
        let title = format!(".SH \"SIGNORINI {}\"\n", command.to_uppercase());
        let section = plain.split(&title).nth(1).unwrap_or_else(|| panic!("no section for {command}"));
        let section = section.split("\n.SH ").next().unwrap();
        for option in options(&desk, &command) {
            assert!(section.contains(&option), "the section of {command} does not contain {option}: {section}");
        }
        assert!(section.contains("Example: signorini "), "{command}");
    }
    assert!(plain.contains(".SH \"EXIT STATUS\"\n.nf\n\\&Exit codes: 0 certified"));
    // In roff, a line that begins with a dot is a request.
    let known = [".TH", ".SH", ".SS", ".TP", ".PP", ".IP", ".RS", ".RE", ".br", ".nf", ".fi", ".ie", ".el"];
    for line in page.lines().filter(|line| line.starts_with('.')) {
        assert!(known.iter().any(|request| line.starts_with(request)), "{line:?}");
    }
}

#[test]
fn the_help_of_every_command_has_an_example_with_valid_arguments() {
    let desk = Desk::new();
    for command in commands(&desk) {
        let help = desk.run(&[&command, "--help"]).ends_with(0).stdout;
        let lines: Vec<&str> = help.lines().map(str::trim).collect();
        let calls = lines.iter().map(|line| line.strip_prefix("Example: ").unwrap_or(line));
        let calls: Vec<&str> = calls.filter(|call| call.starts_with(&format!("signorini {command}"))).collect();
        assert!(!calls.is_empty(), "{command}: {help}");
        for call in calls {
            let call = call.split(" > ").next().unwrap();
            // Missing files end with exit code 1, unknown words with 2.
            let arguments: Vec<&str> = call.split(' ').skip(1).collect();
            let run = desk.run(&arguments);
            assert!(run.code <= 1, "{call}: {}", run.stderr);
        }
    }
}

#[test]
fn the_help_of_solve_distinguishes_tolerance_accuracy_and_time() {
    let help = Desk::new().run(&["solve", "--help"]).ends_with(0).stdout;
    let words = ["--tolerance bounds the violation", "--accuracy the error", "--time the seconds"];
    for word in words {
        assert!(help.contains(word), "{help}");
    }
}

#[test]
fn json_and_text_of_an_answer_show_the_same_estimates_of_both_methods() {
    let desk = Desk::new();
    let scene = example("indentation");
    let why = desk.run(&["solve", &scene, "--format", "json"]).ends_with(0).json()["why"].clone();
    let [factor, mprgp] = &why["considered"].as_array().unwrap()[..] else { panic!("{why:#}") };
    assert_eq!(
        (&factor["method"], &mprgp["method"], &why["chosen"]),
        (&json!("factor"), &json!("mprgp"), &json!("factor"))
    );
    let (direct, cycles) = (factor["seconds"].as_f64().unwrap(), mprgp["seconds"].as_f64().unwrap());
    assert!(direct > 0.0 && cycles > direct && factor["bytes"].as_f64().unwrap() > 1e6, "{why:#}");
    let reason = why["reason"].as_str().unwrap();
    assert!(reason.contains("with a factor") && reason.contains("of such methods"), "{reason}");

    let plain = desk.run(&["solve", &scene]).ends_with(0).stdout;
    assert!(!plain.contains("  why "), "{plain}");
    let text = desk.run(&["solve", &scene, "--explain"]).ends_with(0).stdout;
    let shown: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("  why ")).collect();
    let words = |text: &str| text.split_whitespace().map(str::to_string).collect::<Vec<_>>().join(" ");
    assert!(words(&shown.join(" ")).contains(reason), "{shown:?}");
    assert!(shown.iter().any(|line| line.contains(&format!("factor  {direct:.1e} s")) && line.ends_with("chosen")));
    assert!(shown.iter().any(|line| line.contains(&format!("mprgp   {cycles:.1e} s")) && !line.ends_with("chosen")));
    assert!(shown.iter().all(|line| line.chars().count() <= 100), "{shown:?}");
}

/// The reason is that of the answer on the last mesh.
#[test]
fn an_estimated_and_a_guaranteed_total_error_are_explained() {
    let desk = Desk::new();
    let mut estimated = crate::total_error::classical(0.3);
    estimated["obstacles"][0]["rule"] = json!("closest-point");
    desk.write("estimated.json", estimated.to_string());
    let guaranteed = concat!(env!("CARGO_MANIFEST_DIR"), "/studies/guarantee/coarse.json");
    for (scene, error) in [("estimated.json", "0.2"), (guaranteed, "0.3")] {
        let run = desk.run(&["solve", scene, "--total-error", error, "--explain"]).ends_with(0);
        assert!(run.stdout.contains("\n  why "), "{}", run.stdout);
    }
}

#[test]
fn a_requested_method_is_its_only_reason() {
    let run = Desk::new().run(&["solve", &example("ball"), "--format", "json", "--method", "active-set"]);
    let expected = json!({"chosen": "active-set", "reason": "by active-set: it was requested", "considered": []});
    assert_eq!(run.ends_with(0).json()["why"], expected);
}

#[test]
fn a_sweep_gives_the_reason_for_its_method_at_every_point() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let swept = desk.run(&["sweep", "block.json", "--gaps", "0:-0.01:3", "--format", "json"]).ends_with(0).json();
    for point in swept["points"].as_array().unwrap() {
        assert_eq!(point["why"]["considered"].as_array().unwrap().len(), 2, "{point:#}");
    }
}

#[test]
fn a_misspelt_name_is_answered_with_the_nearest_valid_name() {
    let desk = Desk::new();
    let wrong = |pointer: &str, value: Value| {
        let mut scene = scene();
        let (place, key) = pointer.rsplit_once('/').unwrap();
        match key.parse::<usize>() {
            Ok(index) => scene.pointer_mut(place).unwrap()[index] = value,
            Err(_) => scene.pointer_mut(place).unwrap()[key] = value,
        }
        desk.write("wrong.json", scene.to_string());
        desk.run(&["solve", "wrong.json"])
    };
    let meant = |name: &str| format!("; did you mean `{name}`?");
    for (pointer, value, name) in [
        ("/supports/0/on", json!({"boundary": "botom"}), "bottom"),
        ("/supports/0/on", json!({"boundary": "Bottom"}), "bottom"),
        ("/obstacles/0/boundary", json!("tpo"), "top"),
        ("/loads/0", json!({"tracton": {"boundary": "top", "value": [0, 1]}}), "traction"),
        ("/suports", json!([]), "supports"),
        ("/model", json!("plane-stran"), "plane-strain"),
        ("/obstacles/0/shape", json!({"parabel": {"apex": [0.5, 0.5], "radius": 1}}), "parabola"),
        ("/material/youngs", json!(1), "young"),
        ("/body", json!({"rectangel": {}}), "rectangle"),
    ] {
        let run = wrong(pointer, value).ends_with(1);
        assert!(run.stderr.trim_end().ends_with(&meant(name)), "{pointer}: {}", run.stderr);
    }
    for (pointer, value) in [("/supports/0/on", json!({"boundary": "floor"})), ("/colour", json!("red"))] {
        let run = wrong(pointer, value).ends_with(1);
        assert!(!run.stderr.contains("did you mean"), "{}", run.stderr);
    }
    let long = "x".repeat(1_000_000);
    assert!(!wrong("/supports/0/on", json!({"boundary": long})).ends_with(1).stderr.contains("did you mean"));
    // Groups of elements: an unknown group of a body without groups.
    let run = wrong("/materials", json!([{"group": "stel", "material": {"young": 1, "poisson": 0}}]));
    assert!(run.ends_with(1).stderr.contains("the body has none"));
    // Misspelt options and methods on the command line.
    let run = desk.run(&["solve", "wrong.json", "--method", "activ-set"]).ends_with(2);
    assert!(run.stderr.contains("a similar value exists: 'active-set'"), "{}", run.stderr);
}

#[test]
fn an_unknown_option_is_answered_with_the_nearest_one_and_never_with_two_dashes() {
    let desk = Desk::new();
    for (unknown, near) in [
        ("--toleranse", Some("'--tolerance'")),
        ("--timlimt", Some("'--time-limit'")),
        ("--max-memry", Some("'--max-memory'")),
        ("--meshsize", None),
    ] {
        let run = desk.run(&["solve", "scene.json", unknown, "1"]).ends_with(2);
        assert!(run.stderr.contains(&format!("unexpected argument '{unknown}'")), "{}", run.stderr);
        assert!(!run.stderr.contains("-- --"), "{}", run.stderr);
        assert_eq!(near.is_some(), run.stderr.contains("a similar argument exists"), "{}", run.stderr);
        assert!(near.is_none_or(|near| run.stderr.contains(near)), "{}", run.stderr);
    }
}

#[test]
fn a_misspelt_group_is_answered_with_the_nearest_valid_group() {
    let desk = Desk::new();
    let mesh = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/two-parts-q8.msh");
    std::fs::copy(mesh, desk.path("part.msh")).unwrap();
    let text = std::fs::read_to_string(desk.path("part.msh")).unwrap();
    let names = text.split("$PhysicalNames").nth(1).unwrap().lines().skip(2);
    let of_elements =
        names.map(|line| line.split('"').nth(1).unwrap_or("").to_string()).filter(|name| !name.is_empty());
    let name = of_elements.last().unwrap();
    let nearly = format!("{name}x");
    let mut scene = scene();
    scene["body"] = json!({"gmsh": {"file": "part.msh", "group": nearly}});
    desk.write("part.json", scene.to_string());
    let run = desk.run(&["solve", "part.json"]).ends_with(1);
    assert!(run.stderr.contains(&format!("did you mean `{name}`?")), "{}", run.stderr);
    scene["body"] = json!({"gmsh": {"file": "part.msh"}});
    scene["materials"] = json!([{"group": nearly, "material": {"young": 1e7, "poisson": 0.3}}]);
    desk.write("part.json", scene.to_string());
    let run = desk.run(&["solve", "part.json"]).ends_with(1);
    assert!(run.stderr.contains(&format!("did you mean `{name}`?")), "{}", run.stderr);
}

/// Four springs of stiffness 4 in a row; a force of 3 pushes the end towards a wall at 4. Without contact the end moves
/// to 3; a wall at g carries the force 3 - g.
fn springs(desk: &Desk) {
    let k = ["1 1 8", "2 1 -4", "2 2 8", "3 2 -4", "3 3 8", "4 3 -4", "4 4 4"];
    let k = support::program::matrix("symmetric", "4 4", &k);
    let b = support::program::matrix("general", "1 4", &["1 4 1"]);
    desk.problem("p", &Problem { k, f: vector(&["0", "0", "0", "3"]), b, g: vector(&["4"]) });
}

/// K = [[2, -1], [-1, 2]], f = (1, 1), u_2 <= 2; this wall is out of reach.
fn problem(desk: &Desk) {
    desk.problem("p", &Problem { g: vector(&["2"]), ..Problem::right() });
}

#[test]
fn a_problem_directory_is_swept_from_its_gaps_to_others() {
    let desk = Desk::new();
    springs(&desk);
    desk.write("p/g1.mtx", vector(&["2"]));
    let swept = desk.run(&["sweep", "p", "--points", "5", "--format", "json", "--out", "o"]).ends_with(0).json();
    let points = swept["points"].as_array().unwrap();
    assert_eq!(points.len(), 5);
    for (point, (t, force)) in points.iter().zip([(0.0, 0.0), (0.25, 0.0), (0.5, 0.0), (0.75, 0.5), (1.0, 1.0)]) {
        assert_eq!((&point["t"], &point["status"]), (&json!(t), &json!("certified")));
        assert!((point["contact"]["force"].as_f64().unwrap() - force).abs() < 1e-12, "{point:#}");
    }
    // The wall is at 3 after half of the sweep.
    let [event] = &swept["events"].as_array().unwrap()[..] else { panic!("{:#}", swept["events"]) };
    assert!((event["t"].as_f64().unwrap() - 0.5).abs() < 1e-12, "{event:#}");
    assert_eq!((&event["row"], &event["touches"]), (&json!(0), &json!(true)));
    for file in ["report.json", "force.svg", "force.png", "point-01/u.mtx", "point-05/lambda.mtx"] {
        assert!(desk.path("o").join(file).exists(), "{file}");
    }
    let text = desk.run(&["sweep", "p", "--points", "5"]).ends_with(0).stdout;
    assert!(text.contains("1.000000000e0") && text.contains("row 0") && text.contains("touches"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn a_problem_directory_is_swept_to_another_load_and_to_both() {
    let desk = Desk::new();
    problem(&desk);
    desk.write("p/f1.mtx", vector(&["5", "5"]));
    // Without contact u = f; the row u_2 <= 2 closes at f = 2; then lambda = (3 g - 3 f) / 2.
    let force_at = |points: &str| -> Vec<f64> {
        let swept = desk.run(&["sweep", "p", "--points", points, "--format", "json"]).ends_with(0).json();
        assert!(swept.get("events").is_none(), "a sweep of loads reports no events");
        swept["points"].as_array().unwrap().iter().map(|point| point["contact"]["force"].as_f64().unwrap()).collect()
    };
    let near = |found: &[f64], expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-11), "{found:?}");
    };
    near(&force_at("5"), &[0.0, 0.0, 1.5, 3.0, 4.5]);
    desk.write("p/g1.mtx", vector(&["0"]));
    near(&force_at("3"), &[0.0, 3.0, 7.5]);
}

#[test]
fn missing_or_wrong_input_of_a_sweep_of_a_problem_directory_is_named() {
    let desk = Desk::new();
    problem(&desk);
    desk.run(&["sweep", "p", "--points", "3"]).fails_with(1, &["p/g1.mtx", "it is missing, and so is f1.mtx"]);
    desk.run(&["sweep", "p", "--gaps", "0:1:2"]).fails_with(1, &["--gaps", "problem directory", "give --points"]);
    desk.write("block.json", scene().to_string());
    desk.run(&["sweep", "block.json", "--points", "3"]).fails_with(1, &["--points", "not a problem directory"]);
    desk.run(&["sweep", "p"]).ends_with(2);
    desk.run(&["sweep", "p", "--points", "1"]).ends_with(2);
    desk.run(&["sweep", "p", "--points", "3", "--gaps", "0:1:2"]).ends_with(2);
    desk.write("p/g1.mtx", vector(&["0", "1"]));
    desk.run(&["sweep", "p", "--points", "3"]).fails_with(1, &["p/g1.mtx", "length 2, but there are 1 contact rows"]);
    desk.write("p/g1.mtx", vector(&["inf"]));
    desk.run(&["sweep", "p", "--points", "3"]).fails_with(1, &["p/g1.mtx", "row 0 goes from 2 to inf"]);
}

#[test]
fn a_solve_starts_from_the_answer_of_an_earlier_one() {
    let desk = Desk::new();
    desk.run(&["export", &example("indentation"), "p"]).ends_with(0);
    let solve = |more: &[&str]| {
        let arguments = [&["solve", "p", "--method", "active-set", "--format", "json"], more].concat();
        desk.run(&arguments).ends_with(0).json()
    };
    let first = solve(&["--out", "o"]);
    let again = solve(&["--start", "o"]);
    assert!(first["iterations"].as_u64().unwrap() > 2, "{first:#}");
    assert_eq!(again["iterations"], 1, "{again:#}");
    assert_eq!(again["contact"]["count"], first["contact"]["count"]);
    // The other methods also use the start: multigrid needs fewer cycles, and the QP ends with its first set.
    let cycles = |more: &[&str]| {
        let arguments = [&["solve", "p", "--method", "mprgp", "--format", "json"], more].concat();
        desk.run(&arguments).ends_with(0).json()["iterations"].as_u64().unwrap()
    };
    assert!(cycles(&["--start", "o"]) < cycles(&[]));
    let qp = desk.run(&["solve", "p", "--method", "qp", "--start", "o", "--format", "json"]).ends_with(0).json();
    assert_eq!(qp["method"], "qp-warm");
}

#[test]
fn a_start_that_does_not_fit_is_refused() {
    let desk = Desk::new();
    problem(&desk);
    desk.run(&["solve", "p", "--start", "nowhere"]).fails_with(1, &["nowhere/u.mtx"]);
    desk.write("o/u.mtx", vector(&["1", "1", "1"]));
    desk.write("o/lambda.mtx", vector(&["0"]));
    desk.run(&["solve", "p", "--start", "o"]).fails_with(1, &["displacement to start from has length 3", "2 dofs"]);
    desk.write("o/u.mtx", vector(&["1", "1"]));
    desk.write("o/lambda.mtx", vector(&["0", "0"]));
    desk.run(&["solve", "p", "--start", "o"])
        .fails_with(1, &["multiplier to start from has length 2", "1 contact rows"]);
    let mut moving = scene();
    moving["material"]["density"] = json!(1000);
    moving["gap"] = json!(0.1);
    moving["analysis"] = json!({"dynamic": {"duration": 1e-4}});
    desk.write("moving.json", moving.to_string());
    desk.run(&["solve", "moving.json", "--start", "o"])
        .fails_with(1, &["--start", "a motion starts from its `initial` state"]);
}

#[test]
fn a_scene_is_drawn_before_it_is_solved() {
    let desk = Desk::new();
    let mut scene = scene();
    scene["springs"] = json!([{"on": {"boundary": "left"}, "x": 1000}]);
    scene["supports"] = json!([{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"point": [1, 0]}, "x": 0}]);
    desk.write("block.json", scene.to_string());
    desk.run(&["draw", "block.json", "--out", "set-up.svg"]).ends_with(0);
    let svg = std::fs::read_to_string(desk.path("set-up.svg")).unwrap();
    for words in [
        "Small block, smallest gap −0.01 m at (0.5, 0.5), set-up",
        "held along one direction",
        "held in both directions",
        "spring",
        "load",
        "candidates for contact (5)",
        "obstacle at gap −0.01 m",
    ] {
        assert!(svg.contains(words), "the picture does not contain {words}");
    }
    desk.run(&["draw", "block.json", "--out", "set-up.PNG"]).ends_with(0);
    assert!(std::fs::read(desk.path("set-up.PNG")).unwrap().starts_with(b"\x89PNG"));
    // A clearance in the shape counts as one in the gap.
    scene["obstacles"][0]["shape"]["parabola"]["apex"] = json!([0.75, 0.6]);
    scene["gap"] = json!(0);
    desk.write("block.json", scene.to_string());
    desk.run(&["draw", "block.json", "--out", "set-up.svg"]).ends_with(0);
    let svg = std::fs::read_to_string(desk.path("set-up.svg")).unwrap();
    assert!(svg.contains("Small block, smallest gap 0.1 m at (0.75, 0.5), set-up"));
    // The legend omits what the scene does not contain.
    scene["loads"] = json!([]);
    scene.as_object_mut().unwrap().remove("springs");
    desk.write("block.json", scene.to_string());
    desk.run(&["draw", "block.json", "--out", "set-up.svg"]).ends_with(0);
    let svg = std::fs::read_to_string(desk.path("set-up.svg")).unwrap();
    assert!(!svg.contains("spring") && !svg.contains(">load<"));
}

#[test]
fn the_picture_of_a_set_up_names_the_surfaces_that_candidates_face() {
    let desk = Desk::new();
    let block = |x: Value, y: Value| json!({"rectangle": {"x": {"points": x, "divisions": [3]}, "y": {"points": y, "divisions": [2]}}});
    let scene = json!({
        "contact": "auto",
        "body": block(json!([0, 1]), json!([1, 2])), "material": {"young": 1, "poisson": 0.3},
        "further-bodies": [{"name": "base", "body": block(json!([-0.5, 2]), json!([0, 1])), "material": {"young": 1, "poisson": 0.3}}],
        "supports": [{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "top"}, "x": 0, "y": -0.01}],
    });
    desk.write("pair.json", scene.to_string());
    desk.run(&["draw", "pair.json", "--out", "pair.svg"]).ends_with(0);
    let svg = std::fs::read_to_string(desk.path("pair.svg")).unwrap();
    assert!(svg.contains("candidates for contact (4)") && svg.contains("opposite surface: base-at-body"));
    let mut in_space = scene;
    in_space["model"] = json!("space");
    for pointer in ["/body", "/further-bodies/0/body"] {
        let body = in_space.pointer_mut(pointer).unwrap();
        let [x, y] = ["x", "y"].map(|axis| body["rectangle"][axis].clone());
        *body = json!({"box": {"x": x, "y": {"points": [0, 1], "divisions": [2]}, "z": y}});
    }
    in_space["supports"] = json!([{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0, "z": 0}, {"on": {"boundary": "top"}, "x": 0, "y": 0, "z": -0.01}]);
    desk.write("space.json", in_space.to_string());
    desk.run(&["draw", "space.json", "--out", "space.svg"]).ends_with(0);
    let svg = std::fs::read_to_string(desk.path("space.svg")).unwrap();
    assert!(svg.contains("opposite to them"));
}

#[test]
fn a_picture_of_another_kind_or_of_a_bar_is_refused() {
    let desk = Desk::new();
    desk.run(&["draw", &example("indentation"), "--out", "set-up.jpg"]).ends_with(2);
    desk.run(&["draw", &example("indentation")]).ends_with(2);
    desk.write("bar.json", include_str!("../../studies/impact/bar.json"));
    desk.run(&["draw", "bar.json", "--out", "bar.png"]).fails_with(1, &["`model`", "a bar has no picture"]);
    assert!(!desk.path("bar.png").exists());
}

#[test]
fn the_picture_of_a_set_up_in_space_shows_supports_and_contact_candidates() {
    let desk = Desk::new();
    desk.run(&["draw", &example("ball"), "--out", "ball.svg"]).ends_with(0);
    let svg = std::fs::read_to_string(desk.path("ball.svg")).unwrap();
    for words in ["set-up", "candidates for contact", "obstacle", ">body<", ">held<"] {
        assert!(svg.contains(words), "the picture does not contain {words}");
    }
    // The scene has no load.
    assert!(!svg.contains(">loaded<"));
}

/// Runs the program on a new terminal, returns what the terminal shows, and ends the program once that contains
/// `phrase`.
#[cfg(target_os = "linux")]
fn on_terminal(desk: &Desk, arguments: &[&str], phrase: &str) -> String {
    let script = "import os, pty, sys
child, terminal = pty.fork()
if child == 0:
    os.execv(sys.argv[1], [sys.argv[1]] + sys.argv[3:])
# Joining immutable bytes would copy everything with every piece.
shown = bytearray()
while not sys.argv[2] or sys.argv[2].encode() not in shown:
    try:
        piece = os.read(terminal, 65536)
    except OSError:
        break
    if not piece:
        break
    shown += piece
os.kill(child, 9)
os.waitpid(child, 0)
sys.stdout.buffer.write(shown)";
    let program = env!("CARGO_BIN_EXE_signorini");
    let mut python = Command::new("python3");
    let output =
        python.args(["-c", script, program, phrase]).args(arguments).current_dir(desk.path(".")).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_shows_progress_and_the_time_left_unless_quiet_is_given() {
    let desk = Desk::new();
    desk.write("block.json", scene().to_string());
    let shown = on_terminal(&desk, &["sweep", "block.json", "--gaps", "0:-0.1:10000", "--out", "o"], " left: ");
    let line = shown
        .rsplit("\r\x1b[K")
        .find(|line| line.contains(" left: "))
        .expect("the terminal shows a line of progress")
        .to_string();
    assert!(line.starts_with('[') && line.contains(" % gap ") && line.contains(" of 10000, "), "{line:?}");
    // Without progress, twice as many gaps are solved, so that the run takes about twice as long.
    let gap: usize = line.split("gap ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let gaps = format!("0:-0.1:{}", (2 * gap).min(10_000));
    let quiet = on_terminal(&desk, &["sweep", "block.json", "--gaps", &gaps, "--format", "json", "--quiet"], "");
    assert!(quiet.contains("\"points\"") && !quiet.contains('\x1b') && !quiet.contains(" % gap"), "{}", &quiet[..500]);
    desk.run(&["sweep", "block.json", "--gaps", "0:0:1", "--quiet", "--progress"]).ends_with(2);
}

/// Names of other programs for what is not modelled, in any object of a scene, with the words of the answer.
const ABSENT: [(&str, &str); 8] = [
    ("friction", "friction is not modelled"),
    ("mu", "friction is not modelled"),
    ("Coulomb", "friction is not modelled"),
    ("contact_stiffness", "a contact stiffness is not needed"),
    ("penalty stiffness", "a contact stiffness is not needed"),
    ("large-sliding", "large sliding is not modelled"),
    ("nlgeom", "large displacements are not modelled"),
    ("yield-stress", "plasticity and hyperelasticity are not modelled"),
];

#[test]
fn what_is_not_modelled_is_answered_by_name_in_every_object_of_a_scene() {
    for place in [
        "",
        "/body",
        "/body/rectangle",
        "/material",
        "/supports/0",
        "/loads/0",
        "/obstacles/0",
        "/obstacles/0/shape",
        "/obstacles/0/shape/parabola",
    ] {
        for (name, words) in ABSENT {
            let mut scene = scene();
            scene["loads"] = json!([{"body-force": [0, 0]}]);
            let object = scene.pointer_mut(place).unwrap().as_object_mut().unwrap();
            // An object with a single key takes no second one.
            if ["/body", "/loads/0", "/obstacles/0/shape"].contains(&place) {
                object.clear();
            }
            object.insert(name.to_string(), json!(0.3));
            let found = Scene::from_json(&scene.to_string(), "scene.json").unwrap_err().to_string();
            let expected = [&format!("`{name}` does not exist: {words}"), "take CalculiX"];
            says(&found, &expected.map(|phrase| if name.contains("stiffness") { words } else { phrase }));
            assert!(!found.contains("expected one of"), "{place}: {found}");
        }
    }
}

#[test]
fn an_option_for_what_is_not_modelled_is_answered_by_name() {
    let desk = Desk::new();
    for (option, words) in [
        ("--friction", ABSENT[0].1),
        ("--mu=0.3", ABSENT[1].1),
        ("--contact-stiffness", ABSENT[3].1),
        ("--nlgeom", ABSENT[6].1),
    ] {
        let run = desk.run(&["solve", "scene.json", option]).ends_with(2);
        assert!(run.stderr.contains(words) && !run.stderr.contains("similar"), "{}", run.stderr);
    }
}

#[test]
fn a_deck_or_a_mesh_in_place_of_a_scene_is_recognised() {
    let desk = Desk::new();
    for deck in
        ["*HEADING\nTwo cubes\n*NODE\n1, 0, 0, 0\n", "** a comment\n**\n*Node, NSET=all\n", "\n*NODE\n1, 0, 0, 0\n"]
    {
        desk.write("deck.txt", deck);
        desk.run(&["solve", "deck.txt"])
            .fails_with(1, &["deck.txt", "an input deck of Abaqus or CalculiX", "ends with `.inp`"]);
    }
    desk.write("part.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
    desk.run(&["solve", "part.msh"]).fails_with(1, &["part.msh", "a mesh of Gmsh", "signorini new"]);
    // Text that is neither keeps the message of the parser.
    desk.write("other.json", "*");
    let run = desk.run(&["solve", "other.json"]).fails_with(1, &["expected a value of JSON"]);
    assert!(!run.stderr.contains("deck of"), "{}", run.stderr);
}

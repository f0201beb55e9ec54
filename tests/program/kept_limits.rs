//! Limits are kept: of time, of memory, of what is read, and how a run ends that is asked to.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use crate::program::{Desk, Problem, scene};
use serde_json::{Value, json};
use signorini::internals::bytes::{START, of_problem};
use signorini::qp::{Condense, Prepared};
use signorini::{Error, Method, Scene, Settings, Watch, solve};

/// A bar of 20 cells that flies against a wall, 120 steps a unit of time.
fn bar(duration: f64, frames: usize) -> Value {
    json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 10], "divisions": [20]}}},
        "material": {"young": 900, "poisson": 0, "density": 1},
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [15], "normal": [1]}}}],
        "analysis": {"dynamic": {
            "duration": duration, "frames": frames, "initial": [{"velocity": {"value": [10]}}]
        }}
    })
}

/// What a folder of a motion says of its end: the whole history and the last state.
fn end(desk: &Desk, folder: &str) -> (String, Value) {
    let text = |name: &str| fs::read_to_string(desk.path(folder).join(name)).unwrap();
    let mut checkpoint: Value = serde_json::from_str(&text("checkpoint.json")).unwrap();
    for field in ["scene", "frame_times"] {
        checkpoint.as_object_mut().unwrap().remove(field);
    }
    (text("history.csv"), checkpoint)
}

#[test]
fn a_resumed_motion_goes_on_to_a_longer_duration_bit_for_bit() {
    let desk = Desk::new();
    // Neither duration is a whole number of steps, and only in the second the bar touches the wall.
    for (name, duration, frames) in [("short", 0.4012, 5), ("long", 1.7034, 12)] {
        desk.write(&format!("{name}.json"), bar(duration, frames).to_string());
    }
    desk.run(&["solve", "long.json", "--out", "whole"]).ends_with(0);
    desk.run(&["solve", "short.json", "--out", "parts"]).ends_with(0);
    assert!(end(&desk, "parts") != end(&desk, "whole"));
    let run = desk.run(&["solve", "long.json", "--out", "parts", "--resume", "--format", "json"]).ends_with(0);
    assert!(run.json()["contact"]["impulse"].as_f64().unwrap() > 0.0);
    assert_eq!(end(&desk, "parts"), end(&desk, "whole"));
    // Neither back in time, nor to another scene.
    let back = desk.run(&["solve", "short.json", "--out", "parts", "--resume"]);
    back.fails_with(1, &["at `analysis.dynamic.duration`", "step 205 already"]);
    let mut other = bar(1.7034, 12);
    other["material"]["young"] = json!(901);
    desk.write("other.json", other.to_string());
    desk.run(&["solve", "other.json", "--out", "parts", "--resume"]).fails_with(1, &["belongs to another scene"]);
    assert_eq!(end(&desk, "parts"), end(&desk, "whole"));
}

#[test]
fn a_request_to_terminate_ends_a_run_as_an_interrupt_does() {
    let desk = Desk::new();
    desk.write("bar.json", bar(2000.0, 10_000).to_string());
    let arguments = ["solve", "bar.json", "--out", "o", "--format", "json"];
    let mut child = desk.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !desk.path("o/series-00003.vtu").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it could be terminated");
        std::thread::yield_now();
    }
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.starts_with("interrupted in step "), "{said}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(report["steps"].as_u64().unwrap() > 0, "{report}");
}

#[test]
fn a_named_pipe_is_refused_instead_of_waited_for() {
    let desk = Desk::new();
    desk.problem("p", &Problem::right());
    fs::remove_file(desk.path("p/g.mtx")).unwrap();
    for pipe in ["pipe", "p/g.mtx", "mesh.msh"] {
        assert!(Command::new("mkfifo").arg(desk.path(pipe)).status().unwrap().success());
    }
    let mut meshed = scene();
    meshed["body"] = json!({"gmsh": {"file": "mesh.msh"}});
    desk.write("scene.json", meshed.to_string());
    for (input, named) in [("pipe", "pipe"), ("p", "p/g.mtx"), ("scene.json", "mesh.msh")] {
        desk.run(&["solve", input]).fails_with(1, &[&format!("cannot read {named}"), "it is a named pipe"]);
    }
}

fn mesh(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name)).unwrap()
}

/// A scene whose body is a mesh file.
fn with_mesh(file: &str) -> String {
    json!({
        "model": "plane-strain",
        "body": {"gmsh": {"file": file}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]
    })
    .to_string()
}

#[test]
fn a_mesh_file_outside_the_folder_of_the_scene_is_read_only_where_that_is_allowed() {
    let desk = Desk::new();
    desk.write("outside.msh", mesh("block-t3.msh"));
    desk.write("s/below/inside.msh", mesh("block-t3.msh"));
    std::os::unix::fs::symlink("../outside.msh", desk.path("s/link.msh")).unwrap();
    std::os::unix::fs::symlink("below/inside.msh", desk.path("s/inner.msh")).unwrap();
    let absolute = desk.path("outside.msh");
    let (absolute, within) = (absolute.to_str().unwrap(), desk.path("s/inner.msh"));
    for file in ["below/inside.msh", "./below/../below/inside.msh", "inner.msh", within.to_str().unwrap()] {
        desk.write("s/scene.json", with_mesh(file));
        desk.run(&["solve", "s/scene.json"]).ends_with(0);
    }
    for file in ["../outside.msh", "below/../../outside.msh", "link.msh", absolute] {
        desk.write("s/scene.json", with_mesh(file));
        for command in [&["solve", "s/scene.json"][..], &["compare", "s/scene.json"], &["export", "s/scene.json", "e"]]
        {
            let phrases = ["at `body.gmsh.file`", "outside the folder of the scene", "--allow-outside"];
            desk.run(command).fails_with(1, &phrases);
            desk.run(&[command, &["--allow-outside"]].concat()).ends_with(0);
        }
    }
}

#[test]
fn no_error_quotes_a_file_that_is_no_mesh() {
    let desk = Desk::new();
    let secrets = ["hunter2:x:0\n", "$hunter2\n", "$Comments\nold\n$EndComments\nhunter2\n", "\n\n hunter2"];
    for secret in secrets {
        desk.write("secret", secret);
        desk.write("scene.json", with_mesh("secret"));
        let run = desk.run(&["solve", "scene.json"]).fails_with(1, &["secret:", "it is no mesh of Gmsh"]);
        assert!(!run.stderr.contains("hunter2"), "{}", run.stderr);
    }
}

#[test]
fn no_error_quotes_a_file_that_a_link_leads_to_outside_the_folder() {
    let secrets = [
        "hunter2:x:0\n",
        "%%MatrixMarket matrix hunter2 real general\n",
        "%%MatrixMarket matrix coordinate hunter2 general\n",
        "%%MatrixMarket matrix coordinate real hunter2\n",
        "%%MatrixMarket matrix coordinate real general\nhunter2\n",
        "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 hunter2\n",
        "%%MatrixMarket matrix array real general\n1 1\nhunter2\n",
    ];
    let desk = Desk::new();
    for secret in secrets {
        desk.write("secret", secret);
        for name in ["K", "f", "B", "g"] {
            desk.problem("p", &Problem::right());
            let file = desk.path(&format!("p/{name}.mtx"));
            fs::remove_file(&file).unwrap();
            std::os::unix::fs::symlink("../secret", &file).unwrap();
            for format in ["text", "json"] {
                let run = desk.run(&["solve", "p", "--format", format]).fails_with(1, &[&format!("p/{name}.mtx:")]);
                assert!(!run.stderr.contains("hunter2") && !run.stdout.contains("hunter2"), "{}", run.stderr);
            }
            // In the folder itself what is wrong is shown.
            fs::remove_file(&file).unwrap();
            fs::write(&file, secret).unwrap();
            desk.run(&["solve", "p"]).fails_with(1, &["hunter2"]);
        }
    }
}

/// What a run is resumed from is its own: nothing else is told of, waited for, or cut off.
#[test]
fn a_motion_is_resumed_from_its_own_files_only() {
    let desk = Desk::new();
    desk.write("bar.json", bar(0.1, 4).to_string());
    let begun = |desk: &Desk| desk.run(&["solve", "bar.json", "--out", "run"]).ends_with(0);
    let resumed = |desk: &Desk| desk.run(&["solve", "bar.json", "--out", "run", "--resume"]);
    begun(&desk);
    for secret in ["\"hunter2\"", "{\"scene\": \"hunter2\", \"steps\": \"hunter2\"}", "hunter2"] {
        desk.write("secret", secret);
        fs::remove_file(desk.path("run/checkpoint.json")).unwrap();
        std::os::unix::fs::symlink("../secret", desk.path("run/checkpoint.json")).unwrap();
        let run = resumed(&desk).fails_with(1, &["checkpoint.json:1", "it is no checkpoint of a motion"]);
        assert!(!run.stderr.contains("hunter2"), "{}", run.stderr);
    }
    let history = desk.path("run/history.csv");
    fs::remove_file(desk.path("run/checkpoint.json")).unwrap();
    begun(&desk);
    let foreign = "hunter2\n".repeat(10_000);
    let refused = |phrase: &str| drop(resumed(&desk).fails_with(1, &["cannot resume", "history.csv", phrase]));
    fs::write(desk.path("foreign.csv"), &foreign).unwrap();
    fs::remove_file(&history).unwrap();
    std::os::unix::fs::symlink("../foreign.csv", &history).unwrap();
    refused("it is no regular file");
    assert_eq!(fs::read_to_string(desk.path("foreign.csv")).unwrap(), foreign);
    fs::remove_file(&history).unwrap();
    fs::write(&history, &foreign).unwrap();
    refused("it is no history of a motion");
    assert_eq!(fs::read_to_string(&history).unwrap(), foreign);
    fs::remove_file(&history).unwrap();
    assert!(Command::new("mkfifo").arg(&history).status().unwrap().success());
    refused("it is no regular file");
}

/// A block of so many by so many cells, one unit high, under a parabola.
fn block(cells: [usize; 2], element: &str) -> Value {
    let width = cells[0] as f64 / cells[1] as f64;
    let axis = |length: f64, cells: usize| json!({"points": [0, length], "divisions": [cells]});
    json!({
        "body": {"rectangle": {"x": axis(width, cells[0]), "y": axis(1.0, cells[1]), "element": element}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y",
            "shape": {"parabola": {"apex": [width / 2.0, 1], "radius": 1}}}],
        "gap": -0.01
    })
}

fn cube(cells: usize, element: &str) -> Value {
    let axis = json!({"points": [0, 1], "divisions": [cells]});
    json!({
        "model": "space",
        "body": {"box": {"x": axis, "y": axis, "z": axis, "element": element}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
        "obstacles": [{"boundary": "top", "approach": "+z",
            "shape": {"sphere": {"apex": [0.5, 0.5, 1], "radius": 1}}}],
        "gap": -0.01
    })
}

/// A thin strip of stretched cells.
fn strip(cells: usize) -> Value {
    let mut strip = block([cells, 20], "q4");
    let width = cells as f64 / 2000.0;
    strip["body"]["rectangle"]["x"]["points"] = json!([0, width]);
    strip["body"]["rectangle"]["y"]["points"] = json!([0, 0.5]);
    strip["obstacles"][0]["shape"]["parabola"]["apex"] = json!([width / 2.0, 0.5]);
    strip
}

/// The same, of a material that hardly changes its volume: a hierarchy is of no use, iterations on it stagnate.
fn stiff_in_volume(cells: usize) -> Value {
    let mut strip = strip(cells);
    strip["material"]["poisson"] = json!(0.49999);
    strip
}

/// Exit code, standard error, and the largest resident size in bytes of a run of the program.
fn measured(desk: &Desk, arguments: &[&str]) -> (i32, String, f64) {
    let mut child = desk.command(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
        peak = peak.max(1024.0 * kilobytes.unwrap_or(0.0));
        std::thread::sleep(Duration::from_micros(200));
    }
    let output = child.wait_with_output().unwrap();
    (output.status.code().expect("an exit code, no signal"), String::from_utf8(output.stderr).unwrap(), peak)
}

#[test]
fn the_peak_of_memory_stays_below_the_limit_and_a_limit_refuses_or_certifies() {
    let desk = Desk::new();
    let scenes = [
        block([80, 80], "q4"),
        block([300, 6], "q4"),
        block([40, 40], "q8"),
        cube(9, "hex8"),
        strip(400),
        stiff_in_volume(400),
    ];
    let (mut solved, mut refused) = (0, 0);
    for (number, scene) in scenes.iter().enumerate() {
        let name = format!("scene{number}.json");
        desk.write(&name, scene.to_string());
        for options in ["--method auto", "--method auto --no-condense", "--method qp --no-condense", "--method mprgp"] {
            // What fails without a limit may fail with one.
            let free: Vec<&str> = ["solve", &name].into_iter().chain(options.split(' ')).collect();
            let (without, ..) = measured(&desk, &free);
            for megabytes in [30, 45, 65, 90] {
                let limit = format!("{megabytes}MB");
                let (code, said, peak) = measured(&desk, &[&free[..], &["--max-memory", &limit]].concat());
                let run = format!("{name} {options} {limit}: code {code}, {:.1} MB, {said}", peak / 1e6);
                assert!(peak <= 1e6 * f64::from(megabytes), "{run}");
                match code {
                    1 => refused += 1,
                    code => {
                        assert_eq!(code, without, "{run}");
                        solved += 1;
                    }
                }
            }
        }
    }
    assert!(solved > 30 && refused > 10, "{solved} solved, {refused} refused");
}

/// Where memory is short the factor of the stiffness makes room for those of the contact sets, and is made again.
#[test]
fn the_least_memory_that_a_refusal_tells_suffices() {
    let desk = Desk::new();
    desk.write("strip.json", stiff_in_volume(800).to_string());
    let solve = ["solve", "strip.json", "--format", "json"];
    let free = desk.run(&solve).ends_with(0).json();
    let refused = desk.run(&[&solve[..], &["--max-memory", "50MB"]].concat()).ends_with(1).stderr;
    let told = refused.split_once("a factor of the stiffness it takes about ").unwrap_or_else(|| panic!("{refused}")).1;
    let megabytes = told.split(' ').next().unwrap().parse::<f64>().unwrap() + 1.0;
    let limit = format!("{megabytes}MB");
    let (code, said, peak) = measured(&desk, &[&solve[..], &["--max-memory", &limit]].concat());
    assert!(code == 0 && peak <= 1e6 * megabytes && peak > 0.5e6 * megabytes, "{limit}: {code}, {peak:e}, {said}");
    let within = desk.run(&[&solve[..], &["--max-memory", &limit]].concat()).ends_with(0).json();
    assert_eq!(within["model"]["condensed_dofs"], within["model"]["dofs"]);
    assert_eq!(within["contact"]["count"], free["contact"]["count"]);
    let bound = |report: &Value| report["certificate"]["energy_error_bound"].as_f64().unwrap();
    assert!(bound(&within) <= 1e-9 && bound(&free) <= 1e-9);
}

#[test]
fn a_limit_of_memory_tries_what_fits_and_tells_what_failed() {
    let problem =
        Scene::from_json(&stiff_in_volume(800).to_string(), "strip").unwrap().build().unwrap().problem().clone();
    let within = |memory: f64| {
        let mut settings = Settings::default();
        settings.memory = Some(memory);
        solve(&problem, &settings)
    };
    let free = solve(&problem, &Settings::default()).unwrap();
    assert!(free.attempts.is_empty() && free.condensed_dofs < problem.dofs());
    assert!(matches!(solve(&problem, &Settings::with_method(Method::Mprgp)), Err(Error::NotCertified { .. })));
    let (mut on_all_dofs, mut refused_after_multigrid) = (0, 0);
    for megabytes in (25..60).step_by(5).chain((60..300).step_by(20)) {
        match within(1e6 * f64::from(megabytes)) {
            Ok(found) => {
                assert_eq!(found.contact_set, free.contact_set);
                on_all_dofs += usize::from(found.condensed_dofs == problem.dofs());
            }
            Err(Error::NoRoom { factor, multigrid, allowed, ended }) => {
                assert!(factor > allowed);
                assert_eq!(multigrid > allowed, ended.is_none());
                if let Some(ended) = ended {
                    assert!(ended.starts_with("stationarity is "), "{ended}");
                    refused_after_multigrid += 1;
                }
            }
            Err(error) => panic!("{megabytes} MB: {error}"),
        }
    }
    assert!(on_all_dofs > 0 && refused_after_multigrid > 0, "{on_all_dofs}, {refused_after_multigrid}");
}

#[test]
fn a_refusal_names_the_least_memory_that_suffices() {
    for scene in [strip(300), block([60, 60], "q4"), block([40, 40], "q8")] {
        let problem = Scene::from_json(&scene.to_string(), "scene").unwrap().build().unwrap().problem().clone();
        for condense in [Condense::Auto, Condense::Never] {
            let prepared = |memory: f64| {
                let mut settings = Settings::default();
                (settings.condense, settings.memory) = (condense, Some(memory));
                Prepared::new(&problem, &settings)
            };
            let entries = 2 * problem.stiffness().lower().entries() - problem.dofs();
            let mut memory = START + 1.01 * of_problem(problem.dofs() as f64, entries as f64);
            let mut refusals = 0;
            while let Err(error) = prepared(memory) {
                let Error::TooLarge { bytes, .. } = error else { panic!("{error}") };
                assert!(bytes > memory && refusals < 4, "{bytes} of {memory}");
                (memory, refusals) = (1.0001 * bytes, refusals + 1);
            }
            assert!(refusals > 0);
            assert!(matches!(prepared(0.99 * memory), Err(Error::TooLarge { .. })), "less than {memory} is enough");
        }
    }
}

#[test]
fn time_of_failed_attempts_counts_and_they_are_named() {
    // A factor in single precision is too poor for so slender cells.
    let problem = Scene::from_json(&strip(300).to_string(), "strip").unwrap().build().unwrap().problem().clone();
    let mut settings = Settings::for_accuracy(1e-30);
    settings.precision = signorini::qp::Precision::Mixed;
    let Err(Error::NotCertified { solution, .. }) = solve(&problem, &settings) else { panic!("1e-30 is out of reach") };
    let tried: f64 = solution.attempts.iter().map(|attempt| attempt.seconds).sum();
    assert_eq!(solution.attempts.len(), 1, "{:?}", solution.attempts);
    let attempt = &solution.attempts[0];
    assert!(attempt.method == "active-set" && attempt.reason.contains("single precision"), "{attempt:?}");
    assert!(tried > 0.0 && solution.seconds.solve > tried, "{tried} of {:?}", solution.seconds);
}

#[test]
fn a_step_that_is_estimated_to_take_longer_than_there_is_time_does_not_begin() {
    let watch = Watch::default();
    // Without a deadline everything may begin.
    assert!(watch.allows(1e9) && watch.keeping(1e9).time_left().is_none());
    let hour = watch.within(3600.0);
    assert!(hour.allows(3000.0) && !hour.allows(4000.0));
    // An hour less ten minutes for one more step.
    let left = hour.keeping(600.0).time_left().unwrap();
    assert!((2900.0..=3000.0).contains(&left), "{left}");
    assert!(hour.keeping(4000.0).is_over() && !hour.is_over());
    // What took at least a hundred times its estimate makes all that follows take as much longer.
    hour.timed(0.001, || std::thread::sleep(Duration::from_millis(100)));
    assert!(hour.needed(1.0) >= 100.0 && !hour.allows(36.0) && !watch.within(3600.0).allows(36.0));
    assert!(hour.unhurried().allows(1e9));
}

#[test]
fn no_way_begins_a_step_that_its_time_does_not_suffice_for() {
    let model = Scene::from_json(&block([60, 60], "q4").to_string(), "block").unwrap().build().unwrap();
    for method in [Method::Auto, Method::qp(), Method::ActiveSet, Method::penalty(), Method::Mprgp] {
        for condense in [signorini::qp::Condense::Auto, signorini::qp::Condense::Never] {
            // On a machine where everything takes a million times as long, a minute is nothing.
            let mut settings = Settings::within(Duration::from_secs(60));
            (settings.method, settings.condense, settings.tolerance) = (method, condense, 1e-6);
            let fast = solve(model.problem(), &settings).unwrap();
            assert!(fast.iterations > 0);
            settings.watch = Watch::default();
            settings.watch.learn(1e6);
            settings.time = Some(Duration::from_secs(60));
            match solve(model.problem(), &settings) {
                Err(Error::NotCertified { solution, value, tolerance, .. }) => {
                    assert_eq!((solution.method.as_str(), solution.iterations), ("none", 0));
                    assert!(value > tolerance && tolerance > 30.0, "{value} of {tolerance}");
                }
                other => panic!("{method:?}: {:?}", other.map(|found| found.method)),
            }
        }
    }
}

/// A flat strip of Q8 cells that touches with all its rows: the bound on its boundary takes longer than all else.
fn touching(cells: usize) -> Value {
    let mut scene = block([cells, 2], "q8");
    scene["obstacles"][0]["shape"] = json!({"plane": {"point": [0, 1], "normal": [0, 1]}});
    scene
}

#[test]
fn a_certificate_that_is_asked_to_end_leaves_a_weaker_bound() {
    let model = Scene::from_json(&touching(300).to_string(), "touching").unwrap().build().unwrap();
    let solved = |stops: bool| {
        let began = Arc::new(Mutex::new(None));
        let seen = began.clone();
        let mut settings = Settings::with_method(Method::ActiveSet);
        settings.watch = Watch::observed(move |watch| {
            if watch.activity().step == "certificate" {
                seen.lock().unwrap().get_or_insert_with(Instant::now);
                if stops {
                    watch.stop();
                }
            }
        });
        let solution = match solve(model.problem(), &settings) {
            Err(Error::NotCertified { solution, .. }) => *solution,
            found => found.unwrap(),
        };
        let seconds = began.lock().unwrap().unwrap().elapsed().as_secs_f64();
        (solution, seconds)
    };
    let ((whole, patient), (cut, hurried)) = (solved(false), solved(true));
    assert_eq!((&cut.displacement, &cut.multiplier), (&whole.displacement, &whole.multiplier));
    assert!(cut.certificate.conditions_hold(1e-9), "{:?}", cut.certificate);
    assert!(cut.certificate.energy_error_bound >= whole.certificate.energy_error_bound);
    assert!(hurried < 0.5 * patient, "{hurried} s of {patient} s");
}

#[test]
fn an_answer_comes_by_a_fifth_more_than_its_time() {
    // Of the machine: other tests run beside this one.
    const DELAY: f64 = 1.5;
    let desk = Desk::new();
    desk.write("touching.json", touching(1000).to_string());
    desk.write("fine.json", block([120, 120], "q8").to_string());
    desk.write("strip.json", strip(1000).to_string());
    for scene in ["touching.json", "fine.json", "strip.json"] {
        for time in [0.1, 1.0, 5.0] {
            let clock = Instant::now();
            let run = desk.run(&["solve", scene, "--time", &time.to_string(), "--format", "json"]);
            let seconds = clock.elapsed().as_secs_f64();
            assert!([0, 4].contains(&run.code), "{scene}: {}", run.stderr);
            assert!(seconds <= 1.2 * time + DELAY, "{scene}: {seconds} s of {time} s");
        }
    }
}

#[test]
fn a_failed_attempt_stands_in_the_report_with_its_time_and_its_reason() {
    let desk = Desk::new();
    desk.write("strip.json", strip(300).to_string());
    let arguments = ["solve", "strip.json", "--precision", "mixed"];
    let text = desk.run(&arguments).ends_with(0).stdout;
    assert!(text.contains("also tried: active-set, "), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let report = desk.run(&[&arguments[..], &["--format", "json"]].concat()).ends_with(0).json();
    let attempt = &report["attempts"][0];
    assert!(attempt["method"] == "active-set" && attempt["reason"].as_str().unwrap().contains("single precision"));
    let seconds = |value: &Value| value.as_f64().unwrap();
    assert!(seconds(&report["seconds"]["total"]) > seconds(&attempt["seconds"]), "{report}");
    // What needs but one attempt tells of none.
    let report = desk.run(&["solve", "strip.json", "--format", "json"]).ends_with(0).json();
    assert!(report.get("attempts").is_none(), "{report}");
}

/// In an address space of any size a run ends with an answer or with one sentence.
#[test]
fn where_memory_cannot_be_had_the_program_says_so_and_ends() {
    let desk = Desk::new();
    let scenes = [block([120, 120], "q4"), cube(12, "hex8"), strip(600)];
    let mut codes = [0, 0];
    for (number, scene) in scenes.iter().enumerate() {
        desk.write(&format!("scene{number}.json"), scene.to_string());
        for options in ["", "--no-condense", "--method qp --no-condense", "--method mprgp"] {
            for megabytes in [40, 90, 110, 130, 150, 180, 220, 270] {
                let program = env!("CARGO_BIN_EXE_signorini");
                let script = format!("ulimit -v {megabytes}000; exec '{program}' solve scene{number}.json {options}");
                let output = Command::new("sh").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
                let said = String::from_utf8(output.stderr).unwrap();
                let run = format!("scene {number} {options} {megabytes} MB: {:?}, {said}", output.status);
                match output.status.code() {
                    Some(1) => {
                        assert!(said.starts_with("error: ") && said.lines().count() == 1, "{run}");
                        codes[1] += 1;
                    }
                    Some(0) => codes[0] += 1,
                    Some(4) if options.contains("mprgp") => {}
                    _ => panic!("{run}"),
                }
            }
        }
    }
    assert!(codes.iter().all(|&count| count > 10), "{codes:?}");
}

//! A memory limit is kept: the peak stays below it, and a refusal names the smallest sufficient limit.
#![cfg(target_os = "linux")]

use signorini::{Method, Settings, qp, solve};
use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;
use support::cases;
use support::scenes::built;

use crate::blocks::{block, cube, pressed, pressed_on_a_plane, stiff_in_volume, strip};
use serde_json::{Value, json};
use signorini::qp::{Condense, Estimate, Prepared};
use support::program::Desk;

/// Exit code, standard error, and the largest resident size in bytes of a run of the program.
fn measured(desk: &Desk, arguments: &[&str]) -> (i32, String, f64) {
    let mut child = desk.command(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        // Before its name is that of the program, the new process may still show the memory of this one.
        let text = fs::read_to_string(&status).unwrap_or_default();
        let is_program = text.starts_with("Name:\tsignorini\n");
        let line = text.lines().filter(|_| is_program).find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
        peak = peak.max(1024.0 * kilobytes.unwrap_or(0.0));
        std::thread::sleep(Duration::from_micros(200));
    }
    let output = child.wait_with_output().unwrap();
    (
        output.status.code().expect("the program ends with an exit code, not by a signal"),
        String::from_utf8(output.stderr).unwrap(),
        peak,
    )
}

#[test]
fn the_peak_of_memory_stays_below_the_limit_and_runs_are_refused_or_certified() {
    let desk = Desk::new();
    let scenes = [
        block([80, 80], "q4"),
        block([300, 6], "q4"),
        block([40, 40], "q8"),
        cube(9, "hex8"),
        strip(400),
        stiff_in_volume(400),
        pressed(block([80, 80], "q4"), 20.0),
        pressed(cube(9, "hex8"), 2.0),
        pressed_on_a_plane([60, 60]),
    ];
    let options = ["--method auto", "--method auto --no-condense", "--method qp --no-condense", "--method mprgp"];
    let pairs = scenes.iter().enumerate().flat_map(|scene| options.map(|options| (scene, options)));
    let (mut runs, mut solved, mut refused, mut measurements) = (0, 0, 0, 0);
    // Every fifth pair has every option twice, with another scene each time.
    for ((number, scene), options) in pairs.step_by(cases(5, 1)) {
        let name = format!("scene{number}.json");
        desk.write(&name, scene.to_string());
        // A run that fails without a limit may fail with one.
        let free: Vec<&str> = ["solve", &name].into_iter().chain(options.split(' ')).collect();
        let (without, ..) = measured(&desk, &free);
        for megabytes in [30, 45, 65, 90].into_iter().step_by(cases(2, 1)) {
            let limit = format!("{megabytes}MB");
            let (code, said, peak) = measured(&desk, &[&free[..], &["--max-memory", &limit]].concat());
            let run = format!("{name} {options} {limit}: code {code}, {:.1} MB, {said}", peak / 1e6);
            assert!(peak <= 1e6 * f64::from(megabytes), "{run}");
            runs += 1;
            measurements += usize::from(peak > 0.0);
            match code {
                1 => refused += 1,
                code => {
                    assert_eq!(code, without, "{run}");
                    solved += 1;
                }
            }
        }
    }
    assert!(24 * solved > 5 * runs && 72 * refused > 5 * runs, "{solved} solved, {refused} refused of {runs}");
    assert!(24 * measurements > 5 * runs, "the memory of {measurements} of {runs} runs was seen");
}

/// A sweep keeps its answers, which count as well.
#[test]
fn the_peak_of_a_sweep_stays_below_the_limit() {
    let desk = Desk::new();
    let sweeps = [
        ("gaps", block([60, 60], "q4"), "--gaps", "-0.002:-0.01"),
        ("forces", pressed(block([60, 60], "q4"), 20.0), "--forces", "5:20"),
    ];
    for (name, scene, option, range) in sweeps {
        let file = format!("{name}.json");
        desk.write(&file, scene.to_string());
        let (mut solved, mut too_many) = (0, 0);
        for count in [3, 150] {
            let values = format!("{range}:{count}");
            for megabytes in [30, 60, 120, 240] {
                let limit = format!("{megabytes}MB");
                let (code, said, peak) = measured(&desk, &["sweep", &file, option, &values, "--max-memory", &limit]);
                let run = format!("{name} {count} {limit}: code {code}, {:.1} MB, {said}", peak / 1e6);
                assert!(peak <= 1e6 * f64::from(megabytes), "{run}");
                match code {
                    0 => solved += 1,
                    _ if said.contains("150 answers with") => {
                        assert!(said.contains(&format!("but {megabytes} MB are allowed")), "{run}");
                        too_many += 1;
                    }
                    _ => assert!(code == 1 && said.contains(&format!("{megabytes} MB")), "{run}"),
                }
            }
        }
        assert!(solved >= 3 && too_many >= 1, "{name}: {solved} solved, {too_many} with too many answers");
    }
    // Pictures that do not fit are left out.
    desk.write("drawn.json", block([80, 40], "q4").to_string());
    let arguments = ["sweep", "drawn.json", "--gaps", "-0.002:-0.01:30", "--out", "drawn", "--max-memory"];
    let mut left_out = [false; 2];
    for (megabytes, is_left_out) in [60, 200].into_iter().zip(&mut left_out) {
        let (code, said, peak) = measured(&desk, &[&arguments[..], &[&format!("{megabytes}MB")]].concat());
        assert!(code == 0 && peak <= 1e6 * f64::from(megabytes), "{megabytes} MB: code {code}, {peak:.3e}, {said}");
        assert!(desk.path("drawn/force-width.png").exists());
        *is_left_out = said.contains("only the curves are drawn");
        assert_eq!(desk.path("drawn/gap-30.png").exists(), !*is_left_out, "{said}");
    }
    assert_eq!(left_out, [true, false]);
}

/// If memory is short, the factor of the stiffness is dropped for those of the contact sets, and computed again.
#[test]
fn the_memory_limit_named_in_a_refusal_suffices() {
    let desk = Desk::new();
    desk.write("strip.json", stiff_in_volume(800).to_string());
    let solve = ["solve", "strip.json", "--format", "json"];
    let free = desk.run(&solve).ends_with(0).json();
    let refused = desk.run(&[&solve[..], &["--max-memory", "50MB"]].concat()).ends_with(1).stderr;
    let named = refused.split_once("a factor of the stiffness takes about ").unwrap_or_else(|| panic!("{refused}")).1;
    let megabytes = named.split(' ').next().unwrap().parse::<f64>().unwrap() + 1.0;
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
fn a_limit_of_memory_tries_methods_that_fit_and_names_those_that_failed() {
    let problem = built(&stiff_in_volume(800)).problem().clone();
    let within = |memory: f64| {
        let mut settings = Settings::default();
        settings.memory = Some(memory);
        solve(&problem, &settings)
    };
    let free = solve(&problem, &Settings::default()).unwrap();
    assert!(free.attempts.is_empty() && free.condensed_dofs < problem.dofs());
    assert!(matches!(solve(&problem, &Settings::with_method(Method::Mprgp)), Err(qp::Error::NotCertified { .. })));
    let (mut on_all_dofs, mut refused_after_multigrid) = (0, 0);
    let limits = (25..60).step_by(5).chain((60..300).step_by(20));
    for megabytes in limits.step_by(cases(3, 1)) {
        match within(1e6 * f64::from(megabytes)) {
            Ok(found) => {
                assert_eq!(found.contact_set, free.contact_set);
                on_all_dofs += usize::from(found.condensed_dofs == problem.dofs());
            }
            Err(qp::Error::NoRoom { factor, multigrid, allowed, ended }) => {
                assert!(factor > allowed);
                assert_eq!(multigrid > allowed, ended.is_none());
                if let Some(ended) = ended {
                    assert!(ended.starts_with("imbalance is "), "{ended}");
                    refused_after_multigrid += 1;
                }
            }
            Err(error) => panic!("{megabytes} MB: {error}"),
        }
    }
    assert!(on_all_dofs > 0 && refused_after_multigrid > 0, "{on_all_dofs}, {refused_after_multigrid}");
}

#[test]
fn a_smaller_memory_than_the_named_one_is_refused() {
    for scene in [strip(300), block([60, 60], "q4"), block([40, 40], "q8")] {
        let problem = built(&scene).problem().clone();
        for condense in [Condense::Auto, Condense::Never] {
            let prepared = |memory: f64| {
                // A named method is refused; with `auto` a hierarchy would be prepared instead.
                let mut settings = Settings::with_method(Method::ActiveSet);
                (settings.condense, settings.memory) = (condense, Some(memory));
                Prepared::new(&problem, &settings)
            };
            let entries = 2 * problem.stiffness().lower().entries() - problem.dofs();
            let mut memory =
                Estimate::START + 1.01 * Estimate::bytes_of_factor(problem.dofs() as f64, entries as f64, 0.0, 0.0);
            let mut refusals = 0;
            while let Err(error) = prepared(memory) {
                let qp::Error::TooLarge { bytes, .. } = error else { panic!("{error}") };
                assert!(bytes > memory && refusals < 4, "{bytes} of {memory}");
                (memory, refusals) = (1.0001 * bytes, refusals + 1);
            }
            assert!(refusals > 0);
            assert!(matches!(prepared(0.99 * memory), Err(qp::Error::TooLarge { .. })), "less than {memory} suffices");
        }
    }
}

/// In an address space of any size, a run ends with an answer or with an error of one sentence.
#[test]
fn a_run_whose_memory_allocation_fails_ends_with_one_sentence() {
    let desk = Desk::new();
    let scenes = [block([120, 120], "q4"), cube(12, "hex8"), strip(600)];
    // Matrix products reserve twice the third-level cache; on machines with a large cache, all limits are larger.
    let cache = std::fs::read_to_string("/sys/devices/system/cpu/cpu0/cache/index3/size").unwrap_or_default();
    let cache_kilobytes: u64 = cache.trim().trim_end_matches('K').parse().unwrap_or(0);
    let more = (2 * 1024 * cache_kilobytes).saturating_sub(64 << 20) / 1_000_000;
    let options = ["", "--no-condense", "--method qp --no-condense", "--method mprgp"];
    let limits = [40, 90, 110, 130, 150, 180, 220, 270, 400, 800];
    let runs = options.iter().flat_map(|options| limits.map(|megabytes| (options, megabytes)));
    let (mut codes, mut count) = ([0, 0], 0);
    for (number, scene) in scenes.iter().enumerate() {
        desk.write(&format!("scene{number}.json"), scene.to_string());
        // Every seventh run has every option, with another limit each time.
        for (options, megabytes) in runs.clone().skip(cases(number, 0)).step_by(cases(7, 1)) {
            let program = env!("CARGO_BIN_EXE_signorini");
            let script =
                format!("ulimit -v {}000; exec '{program}' solve scene{number}.json {options}", megabytes + more);
            let output = Command::new("sh").args(["-c", &script]).current_dir(desk.path(".")).output().unwrap();
            let said = String::from_utf8(output.stderr).unwrap();
            let run = format!("scene {number} {options} {megabytes} MB: {:?}, {said}", output.status);
            count += 1;
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
    assert!(codes.iter().all(|&code| 48 * code > 5 * count), "{codes:?} of {count}");
}

/// A motion has its mass, the matrix of a step and its states beside the solve, and writes frames and an animation.
#[test]
fn the_peak_of_a_motion_stays_below_the_limit() {
    let desk = Desk::new();
    let (mut runs, mut solved) = (0, 0);
    for (scheme, mut scene) in [("midpoint", block([90, 45], "q4")), ("contact-stabilised", cube(10, "hex8"))] {
        scene["material"]["density"] = json!(1e-3);
        scene["gap"] = json!(0);
        scene["analysis"] = json!({"dynamic": {"scheme": scheme, "duration": 1e-4, "step": 1e-5}});
        desk.write("motion.json", scene.to_string());
        for megabytes in [30, 45, 60, 75, 90, 120].into_iter().step_by(cases(2, 1)) {
            let limit = format!("{megabytes}MB");
            let folder = format!("{scheme}-{megabytes}");
            let (code, said, peak) =
                measured(&desk, &["solve", "motion.json", "--max-memory", &limit, "--out", &folder]);
            let run = format!("{scheme} {limit}: code {code}, {:.1} MB, {said}", peak / 1e6);
            assert!(peak <= 1e6 * f64::from(megabytes), "{run}");
            runs += 1;
            match code {
                0 => solved += 1,
                _ => assert!(code == 1 && said.contains(&format!("{megabytes} MB are allowed")), "{run}"),
            }
        }
    }
    assert!(4 * solved >= runs && 6 * solved < 5 * runs, "{solved} of {runs} solved");
}

/// The length of a mesh file does not tell how many entries its stiffness has: the mesh itself is judged before its
/// assembly.
#[test]
fn a_mesh_from_a_file_is_refused_before_its_assembly() {
    const CELLS: usize = 24;
    let desk = Desk::new();
    let side = CELLS + 1;
    let node = |[x, y, z]: [usize; 3]| 1 + x + side * (y + side * z);
    let mut text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"bottom\"\n2 2 \"top\"\n$EndPhysicalNames\n"
            .to_string();
    text += &format!("$Nodes\n{}\n", side.pow(3));
    for number in 0..side.pow(3) {
        text += &format!("{} {} {} {}\n", number + 1, number % side, number / side % side, number / side / side);
    }
    text += &format!("$EndNodes\n$Elements\n{}\n", CELLS.pow(3) + 2 * CELLS.pow(2));
    for number in 0..CELLS.pow(2) {
        let (x, y) = (number % CELLS, number / CELLS);
        for (group, z) in [(1, 0), (2, CELLS)] {
            let [a, b, c, d] = [[x, y, z], [x + 1, y, z], [x + 1, y + 1, z], [x, y + 1, z]].map(node);
            text += &format!("{} 3 2 {group} 1 {a} {b} {c} {d}\n", 2 * number + group);
        }
    }
    for number in 0..CELLS.pow(3) {
        let (x, y, z) = (number % CELLS, number / CELLS % CELLS, number / CELLS / CELLS);
        text += &format!("{} 5 2 0 1", 2 * CELLS.pow(2) + number + 1);
        for z in [z, z + 1] {
            for at in [[x, y, z], [x + 1, y, z], [x + 1, y + 1, z], [x, y + 1, z]] {
                text += &format!(" {}", node(at));
            }
        }
        text += "\n";
    }
    desk.write("cube.msh", text + "$EndElements\n");
    let scene = json!({
        "model": "space", "body": {"gmsh": {"file": "cube.msh"}}, "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}], "gap": -0.1,
        "obstacles": [{"boundary": "top", "approach": "+z", "shape": {"sphere": {"apex": [12, 12, CELLS], "radius": 40}}}],
    });
    desk.write("cube.json", scene.to_string());
    for (megabytes, code) in [(35, 1), (50, 1), (65, 1), (250, 0)] {
        let limit = format!("{megabytes}MB");
        let (found, said, peak) = measured(&desk, &["solve", "cube.json", "--max-memory", &limit]);
        let run = format!("{limit}: code {found}, {:.1} MB, {said}", peak / 1e6);
        assert!(found == code && peak <= 1e6 * f64::from(megabytes), "{run}");
    }
}

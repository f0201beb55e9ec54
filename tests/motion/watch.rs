//! Watched points of a motion: the content of their table at every step, the refused points, and the table after a
//! resumption.

use std::fs;

use crate::impact_command::{bar, with};
use serde_json::{Value, json};
use support::program::Desk;

/// Relative rounding of the forces, means and sums of a table.
const ROUNDING: f64 = 1e-12;

/// The heading and the rows of a table.
fn table(desk: &Desk, name: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(desk.path(name)).unwrap();
    let mut lines = text.lines();
    let heading = lines.next().unwrap().split(',').map(String::from).collect();
    (heading, lines.map(|line| line.split(',').map(|value| value.parse().unwrap()).collect()).collect())
}

#[test]
fn the_table_of_a_watched_node_has_displacement_velocity_and_contact_force_at_every_step() {
    let desk = Desk::new();
    // The cells have the length 0.5; the point is in the middle of the last one.
    let watch = json!([{"node": 20}, {"point": [9.75]}, {"node": 19}]);
    desk.write("bar.json", with("watch", watch).to_string());
    desk.run(&["solve", "bar.json", "--out", "out", "--pictures", "none"]).ends_with(0);
    let (heading, rows) = table(&desk, "out/watch.csv");
    let columns = ["node 20", "point (9.75)", "node 19"].map(|name| ["u", "v", "f"].map(|of| format!("{name} {of}_x")));
    assert_eq!((heading[0].as_str(), &heading[1..]), ("time", &columns.concat()[..]));
    let (_, history) = table(&desk, "out/history.csv");
    assert_eq!(rows.len(), history.len());
    // The resultant of the wall equals the force on its only node.
    let resultants = fs::read_to_string(desk.path("out/resultants.csv")).unwrap();
    let mut lines = resultants.lines();
    assert_eq!(lines.next(), Some("time,obstacles[0] f_x,obstacles[0] c_x"));
    let forces: Vec<f64> = lines.map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert!(resultants.lines().nth(1).unwrap().ends_with(",0e0,"), "there is a centre without a force: {resultants}");
    assert_eq!(forces.len(), rows.len());
    for ((row, seen), force) in rows.iter().zip(&history).zip(&forces) {
        assert_eq!((row[0], *force), (seen[0], row[3]));
        // Before it meets the wall at the time 0.5, the bar flies with speed 10.
        if row[0] < 0.49 {
            assert!((row[1] - 10.0 * row[0]).abs() < 1e-9, "{row:?}");
        }
        // The force on the body points away from the wall; only the last node has a force.
        assert!((row[3] + seen[1]).abs() <= ROUNDING * seen[1] && row[9] == 0.0, "{row:?} {seen:?}");
        for quantity in 1..=3 {
            let [end, point, before] = [row[quantity], row[quantity + 3], row[quantity + 6]];
            assert!((point - (end + before) / 2.0).abs() <= ROUNDING * end.abs().max(before.abs()), "{row:?}");
        }
    }
    assert!(rows.iter().any(|row| row[3] < -250.0));
    // The centre of mass leaves with the speed of its arrival; the vibration of its end is less than half of this
    // speed.
    assert!((rows[5][2] - 10.0).abs() < 1e-9 && rows[rows.len() - 1][5] < -5.0, "{:?}", rows[rows.len() - 1]);
}

/// A linear field is represented exactly at any point of any cell, straight or curved.
#[test]
fn a_watched_point_has_the_values_of_the_element_around_it() {
    let gradient = [[1e-3, -2e-3], [3e-3, 4e-3]];
    let divisions = json!({"points": [0, 1], "divisions": [3]});
    for body in [
        json!({"disc": {"centre": [0.5, 0.5], "radius": 0.7, "zone": {"width": 0.3, "divisions": 3, "growth": 1.3}}}),
        json!({"rectangle": {"x": divisions, "y": divisions, "element": "t6"}}),
        json!({"rectangle": {"x": divisions, "y": divisions, "element": "q8"}}),
    ] {
        let points = [[0.31, 0.47], [0.9, 0.12], [0.5, 0.5]];
        let scene = json!({
            "model": "plane-strain", "body": body, "material": {"young": 1, "poisson": 0.3, "density": 1},
            "analysis": {"dynamic": {
                "duration": 1e-3, "frames": 1, "watch": points.map(|point| json!({"point": point})),
                "initial": [{"displacement": {"value": [0.1, 0.2], "gradient": gradient}, "velocity": {"value": [3, 4]}}]
            }}
        });
        let desk = Desk::new();
        desk.write("scene.json", scene.to_string());
        desk.run(&["solve", "scene.json", "--out", "out", "--pictures", "none"]).ends_with(0);
        let (heading, rows) = table(&desk, "out/watch.csv");
        assert_eq!(
            heading[1..7],
            ["u_x", "u_y", "v_x", "v_y", "f_x", "f_y"].map(|of| format!("point (0.31 0.47) {of}"))
        );
        for (index, [x, y]) in points.into_iter().enumerate() {
            let u = [0, 1].map(|axis| [0.1, 0.2][axis] + gradient[axis][0] * x + gradient[axis][1] * y);
            let expected = [u[0], u[1], 3.0, 4.0, 0.0, 0.0];
            let found = &rows[0][1 + 6 * index..7 + 6 * index];
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}, expected {expected:?}");
        }
    }
}

#[test]
fn unknown_nodes_and_points_are_refused_with_the_existing_ones() {
    let watch = |value: Value| with("watch", json!([{"node": 0}, value]));
    for (scene, phrases) in [
        (watch(json!({"node": 21})), &["at `analysis.dynamic.watch[1].node`", "no node 21", "numbers 0 to 20"][..]),
        (watch(json!({"node": -1})), &["analysis.dynamic.watch[1]", "-1"]),
        (
            watch(json!({"point": [12.5]})),
            &["at `analysis.dynamic.watch[1].point`", "(12.5) lies in no element", "nearest node, 20 at (10), is 2.5"],
        ),
        (watch(json!({"point": [1, 2]})), &["at `analysis.dynamic.watch[1].point`", "2 entries", "[x]"]),
        (watch(json!({"point": [1], "node": 1})), &["analysis.dynamic.watch[1]", "a second one"]),
        (watch(json!({"edge": 1})), &["analysis.dynamic.watch[1]", "edge", "node"]),
    ] {
        let desk = Desk::new();
        desk.write("scene.json", scene.to_string());
        desk.run(&["solve", "scene.json", "--out", "out"]).fails_with(1, phrases);
        assert!(!desk.path("out").exists(), "{scene}");
    }
}

#[test]
fn a_run_that_is_resumed_during_contact_continues_watched_points_and_peaks_bit_for_bit() {
    let desk = Desk::new();
    let mut scene = with("watch", json!([{"node": 20}, {"point": [3.3]}]));
    desk.write("long.json", scene.to_string());
    // The bar touches the wall from 0.5 to 1.17.
    scene["analysis"]["dynamic"]["duration"] = json!(0.8);
    scene["analysis"]["dynamic"]["frames"] = json!(5);
    desk.write("short.json", scene.to_string());
    let report = |arguments: &[&str]| {
        let arguments = [&["solve"], arguments, &["--format", "json", "--pictures", "none"]].concat();
        let mut report = desk.run(&arguments).ends_with(0).json();
        report.as_object_mut().unwrap().remove("seconds");
        report
    };
    let whole = report(&["long.json", "--out", "whole"]);
    report(&["short.json", "--out", "parts"]);
    // Lines of steps after the checkpoint are removed.
    let table = desk.path("parts/watch.csv");
    fs::write(&table, fs::read_to_string(&table).unwrap() + "9e9,1,2\n").unwrap();
    assert_eq!(report(&["long.json", "--out", "parts", "--resume"]), whole);
    assert!(whole["contact"]["force_mean_max"].as_f64() > Some(300.0));
    for name in ["watch.csv", "history.csv", "resultants.csv"] {
        let [whole, parts] = ["whole", "parts"].map(|run| fs::read(desk.path(&format!("{run}/{name}"))).unwrap());
        assert!(whole == parts, "{name} differs");
    }
    // A table of other origin is not changed.
    fs::write(&table, "mine\n").unwrap();
    desk.run(&["solve", "long.json", "--out", "parts", "--resume"]).fails_with(1, &["cannot resume", "watch.csv"]);
    assert_eq!(fs::read_to_string(&table).unwrap(), "mine\n");
    // A new run without watched points removes an old table.
    desk.write("bar.json", bar().to_string());
    desk.run(&["solve", "bar.json", "--out", "whole", "--pictures", "none"]).ends_with(0);
    assert!(!desk.path("whole/watch.csv").exists());
}

#[test]
fn every_frame_has_the_velocities_of_its_nodes() {
    let desk = Desk::new();
    desk.write("bar.json", bar().to_string());
    desk.run(&["solve", "bar.json", "--out", "out", "--pictures", "none"]).ends_with(0);
    for number in [0, 2] {
        let text = fs::read_to_string(desk.path(&format!("out/series-{number:05}.vtu"))).unwrap();
        let heading = "<DataArray type=\"Float64\" Name=\"velocity\" NumberOfComponents=\"3\" format=\"ascii\">\n";
        let (_, array) = text.split_once(heading).expect("the file has an array of velocities");
        let (array, _) = array.split_once("</DataArray>").unwrap();
        let values: Vec<f64> = array.split_whitespace().map(|value| value.parse().unwrap()).collect();
        assert_eq!(values.len(), 3 * 21);
        // The bar is in flight. A node without mass has the mean velocity of its last step; before the first step it
        // has no velocity.
        for node in 0..if number == 0 { 20 } else { 21 } {
            let velocity = &values[3 * node..3 * node + 3];
            assert!((velocity[0] - 10.0).abs() < 1e-9 && velocity[1..] == [0.0, 0.0], "{number}, {node}: {velocity:?}");
        }
    }
}

/// A bar flies to and fro between two walls. Each wall has a line of its own: the integral and the largest value of its
/// own force.
#[test]
fn a_motion_between_two_walls_has_the_impulse_of_each_wall() {
    let desk = Desk::new();
    let mut scene = bar();
    let wall = json!({"boundary": "left", "approach": "-x", "shape": {"plane": {"point": [-1], "normal": [-1]}}});
    scene["obstacles"].as_array_mut().unwrap().push(wall);
    // It touches one wall from 0.5 to 1.17, and the other one 0.6 later.
    scene["analysis"]["dynamic"]["duration"] = json!(2.6);
    desk.write("bar.json", scene.to_string());
    let text = desk.run(&["solve", "bar.json", "--out", "out", "--pictures", "none"]).ends_with(0).stdout;
    let report: Value = serde_json::from_str(&fs::read_to_string(desk.path("out/report.json")).unwrap()).unwrap();
    let contact = &report["contact"];
    let (heading, rows) = table(&desk, "out/history.csv");
    assert_eq!(heading[1], "force");
    let step = report["step"].as_f64().unwrap();
    let resultants = fs::read_to_string(desk.path("out/resultants.csv")).unwrap();
    let names: Vec<&str> = resultants.lines().next().unwrap().split(',').collect();
    for (index, sign) in [(0, -1.0), (1, 1.0)] {
        let column = names.iter().position(|name| *name == format!("obstacles[{index}] f_x")).unwrap();
        let forces: Vec<f64> = resultants
            .lines()
            .skip(2)
            .map(|line| sign * line.split(',').nth(column).unwrap().parse::<f64>().unwrap())
            .collect();
        assert_eq!(forces.len(), rows.len() - 1);
        let one = &contact["obstacles"][index];
        let (impulse, largest) = (forces.iter().sum::<f64>() * step, forces.iter().copied().fold(0.0, f64::max));
        assert!((one["impulse"].as_f64().unwrap() / impulse - 1.0).abs() < ROUNDING * forces.len() as f64, "{one}");
        assert!((one["force_max"].as_f64().unwrap() / largest - 1.0).abs() < ROUNDING, "{one}: {largest}");
        // The exact impulse turns the bar round: mass 10, speed 10 before and after.
        assert!((impulse / 200.0 - 1.0).abs() < 0.05, "{impulse}");
        assert!(text.contains(&format!("obstacles[{index}]")) && !text.contains("impulse 4"), "{text}");
    }
    assert!(contact["obstacles"][0]["last"].as_f64() < contact["obstacles"][1]["first"].as_f64(), "{contact}");
}

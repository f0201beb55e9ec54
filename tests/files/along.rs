//! `--along`: the answer along lines, in `along.csv` and on the page.

use std::collections::BTreeMap;
use std::fs;

use crate::out_folder::layers;
use serde_json::{Value, json};
use support::program::Desk;

/// Rounding of a small solve, relative.
const ROUNDING: f64 = 1e-9;

/// The table along the lines of a scene: a map from the name of a column without its unit to its cells, NaN for an
/// empty one.
fn along(scene: &Value, lines: &[&str]) -> BTreeMap<String, Vec<f64>> {
    let desk = Desk::new();
    desk.write("scene.json", scene.to_string());
    let options = lines.iter().flat_map(|line| ["--along", line]);
    let arguments: Vec<&str> =
        ["solve", "scene.json", "--out", "o", "--pictures", "none"].into_iter().chain(options).collect();
    desk.run(&arguments).ends_with(0);
    let csv = fs::read_to_string(desk.path("o/along.csv")).unwrap();
    let mut rows = csv.lines();
    let names: Vec<&str> = rows.next().unwrap().split(',').map(|name| name.split(" [").next().unwrap()).collect();
    let rows: Vec<Vec<f64>> =
        rows.map(|row| row.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == names.len()));
    names.iter().enumerate().map(|(at, name)| (name.to_string(), rows.iter().map(|row| row[at]).collect())).collect()
}

/// The parts of a line in a body: its first and its last position in each piece without a break.
fn parts(table: &BTreeMap<String, Vec<f64>>, body: f64) -> Vec<[f64; 2]> {
    let mut parts: Vec<[f64; 2]> = Vec::new();
    let mut is_open = false;
    for (&s, &of) in table["s"].iter().zip(&table["body"]) {
        match parts.last_mut() {
            Some(last) if is_open && of == body => last[1] = s,
            _ if of == body => parts.push([s, s]),
            _ => {}
        }
        is_open = of == body;
    }
    parts
}

fn axis(ends: [f64; 2], cells: usize) -> Value {
    json!({"points": ends, "divisions": [cells]})
}

/// GOAL: all elements, in the plane, about an axis and in space. CONDITIONS: a block that stretches by a constant
/// strain along its first axis, or along the axis of revolution; skew lines that begin inside and outside, and the
/// axis. REFERENCE: the linear displacement, the stress along the load alone, and the length of the line in the block.
#[test]
fn a_block_under_tension_has_its_linear_displacement_along_every_line() {
    let (young, poisson, load) = (1000.0, 0.25, 8.0);
    let held = |boundary: &str, axis: &str| json!({"on": {"boundary": boundary}, axis: 0});
    let plane = ["t3", "t6", "q4", "q8"];
    let kinds = plane.iter().map(|element| ("plane-stress", *element));
    let kinds = kinds.chain(plane.iter().map(|element| ("axisymmetric", *element)));
    for (model, element) in kinds.chain(["tet4", "tet10", "hex8", "hex20"].map(|element| ("space", element))) {
        let mut body = json!({"rectangle": {"x": axis([0.0, 2.0], 3), "y": axis([0.0, 1.0], 2), "element": element}});
        // The axis along which the block is pulled, the boundary on which it is, the supports, and a plane far away.
        let (pulled, boundary, supports) = match model {
            "plane-stress" => (0, "right", vec![held("left", "x"), held("bottom", "y")]),
            "axisymmetric" => (1, "top", vec![held("bottom", "y")]),
            _ => {
                body = json!({ "box": body["rectangle"] });
                body["box"]["z"] = axis([0.0, 1.5], 2);
                (0, "right", vec![held("left", "x"), held("front", "y"), held("bottom", "z")])
            }
        };
        let dimension = if model == "space" { 3 } else { 2 };
        let along_pull =
            |value: f64| (0..dimension).map(|axis| if axis == pulled { value } else { 0.0 }).collect::<Vec<f64>>();
        let mut scene = json!({
            "model": model, "body": body, "material": {"young": young, "poisson": poisson}, "supports": supports,
            "obstacles": [{"boundary": boundary, "approach": if pulled == 0 { "+x" } else { "+y" },
                           "shape": {"plane": {"point": along_pull(9.0), "normal": along_pull(1.0)}}}],
            "loads": [{"traction": {"boundary": boundary, "value": along_pull(load)}}]
        });
        if model == "plane-stress" {
            scene["thickness"] = json!(1);
        }
        // A line, both its ends, and its length in the block: it enters at x = 0, or begins inside and leaves at the
        // top.
        let mut lines = vec![
            ("-0.5,0.1,0.2:2.5,0.7,1.1", [[-0.5, 0.1, 0.2], [2.5, 0.7, 1.1]], 2.0 / 3.0),
            ("0.3,0.2,0.1:0.9,1.8,1.3", [[0.3, 0.2, 0.1], [0.9, 1.8, 1.3]], 0.5),
            ("0,0,0:0,1,0", [[0.0; 3], [0.0, 1.0, 0.0]], 1.0),
        ];
        if dimension == 2 {
            lines = [("-0.5,0.1:2.5,0.7", 0), ("0.3,0.2:0.9,1.8", 1), ("0,0:0,1", 2)]
                .map(|(text, line)| (text, lines[line].1.map(|[x, y, _]| [x, y, 0.0]), lines[line].2))
                .to_vec();
        }
        for (line, [from, to], share) in lines {
            let run = format!("{model} {element} {line}");
            let way = [0, 1, 2].map(|axis| to[axis] - from[axis]);
            let whole = way.iter().map(|part| part * part).sum::<f64>().sqrt();
            let table = along(&scene, &[line]);
            let [[start, end]] = parts(&table, 0.0)[..] else { panic!("{run}: {:?}", parts(&table, 0.0)) };
            assert!((end - start - share * whole).abs() < ROUNDING, "{run}: {start} to {end}");
            let strain = load / young;
            let close = |row: usize, name: &str, expected: f64, scale: f64| {
                let found = table[name][row];
                assert!(
                    (found - expected).abs() < ROUNDING * scale,
                    "{run}, row {row}: {name} {found}, not {expected}"
                );
            };
            for (row, &s) in table["s"].iter().enumerate() {
                for (at, name) in ["x", "y", "z"].into_iter().enumerate().take(dimension) {
                    let place = from[at] + s / whole * way[at];
                    close(row, name, place, 1.0);
                    close(
                        row,
                        &format!("u_{name}"),
                        if at == pulled { strain } else { -poisson * strain } * place,
                        strain,
                    );
                }
                for (at, name) in ["sigma_xx", "sigma_yy", "sigma_zz", "sigma_xy"].into_iter().enumerate() {
                    close(row, name, if at == pulled { load } else { 0.0 }, load);
                }
                close(row, "von_mises", load, load);
                close(row, "sigma_1", load, load);
            }
        }
    }
}

/// GOAL: fine meshes far from the origin, and long lines. CONDITIONS: skew lines through thousands of cells of a block
/// at x = 100, and through the hole of a ring from far away. REFERENCE: the length of the line in the block; the two
/// parts beside the hole.
#[test]
fn no_cell_of_a_fine_mesh_is_lost() {
    let scene = json!({
        "body": {"rectangle": {"x": axis([100.0, 101.0], 200), "y": axis([0.0, 0.1], 20), "element": "t3"}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 0.1], "normal": [0, 1]}}}],
        "gap": -0.001
    });
    // The second line leaves at y = 0; the third has the rounding of the distance from its first end.
    let leaves = (0.0923 / 0.1423_f64).min(0.5);
    for (line, length, rounding) in [
        ("100,0.013:101,0.0777", 1.0_f64.hypot(0.0647), ROUNDING),
        ("99,0.0923:103,-0.05", (leaves - 0.25) * 4.0_f64.hypot(0.1423), ROUNDING),
        ("-1e6,0.05:1e6,0.05", 1.0, 1e-9 * 1e3),
        ("100.5,0.01:100.5,1e200", 0.09, ROUNDING),
    ] {
        let table = along(&scene, &[line]);
        let [[start, end]] = parts(&table, 0.0)[..] else { panic!("{line}: {:?}", parts(&table, 0.0)) };
        assert!((end - start - length).abs() < rounding, "{line}: {start} to {end}, not {length} long");
    }
}

/// GOAL: curved sides, and a line that leaves the body. CONDITIONS: a ring of quadratic elements, a line through its
/// hole and a chord that cuts off a piece. REFERENCE: the chords of circles; a quadratic side is off the circle by at
/// most r theta^4/128 here.
#[test]
fn a_line_through_a_hole_has_a_gap_and_chords_of_their_length() {
    for element in ["t6", "q8"] {
        let scene = json!({
            "body": {"ring": {"radius": axis([1.0, 2.0], 3), "angle": axis([0.0, 180.0], 16), "centre": [0, 0],
                              "element": element}},
            "material": {"young": 1000, "poisson": 0.3},
            "supports": [{"on": {"boundary": "start"}, "x": 0, "y": 0}, {"on": {"boundary": "end"}, "x": 0, "y": 0}],
            "obstacles": [{"boundary": "outer", "approach": "+y",
                           "shape": {"plane": {"point": [0, 2], "normal": [0, 1]}}}],
            "gap": -0.01
        });
        let off = 2.0 * (std::f64::consts::PI / 16.0_f64).powi(4) / 128.0;
        let table = along(&scene, &["-3,0.5:3,0.5", "-3,1.6:3,1.6"]);
        let of_line = |line: f64| -> BTreeMap<String, Vec<f64>> {
            let rows: Vec<usize> = (0..table["line"].len()).filter(|&row| table["line"][row] == line).collect();
            let kept = |values: &Vec<f64>| rows.iter().map(|&row| values[row]).collect();
            table.iter().map(|(name, values)| (name.clone(), kept(values))).collect()
        };
        let [outer, inner, chord] = [(4.0, 0.5), (1.0, 0.5), (4.0, 1.6)].map(|(r2, y): (f64, f64)| (r2 - y * y).sqrt());
        // The slope of the circle at the line turns an offset along the radius into one along the line.
        let check = |found: Vec<[f64; 2]>, expected: &[[f64; 2]]| {
            assert_eq!(found.len(), expected.len(), "{element}: {found:?}");
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 2.0 * off, "{element}: {found} instead of {expected}");
            }
        };
        check(parts(&of_line(0.0), 0.0), &[[3.0 - outer, 3.0 - inner], [3.0 + inner, 3.0 + outer]]);
        check(parts(&of_line(1.0), 0.0), &[[3.0 - chord, 3.0 + chord]]);
    }
}

/// GOAL: both values where materials meet. CONDITIONS: two layers in uniaxial strain under a pressure p. REFERENCE: the
/// lateral stress is -p nu/(1 - nu) in each.
#[test]
fn the_lateral_stress_jumps_where_materials_meet() {
    let table = along(&layers(), &["0.3,0:0.3,2"]);
    let at_interface: Vec<f64> =
        (0..table["s"].len()).filter(|&row| table["y"][row] == 1.0).map(|row| table["sigma_xx"][row]).collect();
    let expected = [-3.0 * 0.3 / 0.7, -3.0 * 0.2 / 0.8];
    assert_eq!(at_interface.len(), 2, "{at_interface:?}");
    at_interface.iter().zip(expected).for_each(|(found, expected)| assert!((found - expected).abs() < ROUNDING));
}

/// GOAL: lines across and along the contact of two bodies. CONDITIONS: a block on a block, pressed flat. REFERENCE: the
/// pressure p on both bodies along their contact, none across it; a gap of the line between the bodies before they
/// touch.
#[test]
fn both_bodies_have_their_pressure_along_their_contact() {
    let block =
        |from: f64| json!({"rectangle": {"x": axis([0.0, 1.0], 4), "y": axis([from, from + 1.0], 2), "element": "q8"}});
    let rollers = |name: &str| json!({"on": {"boundary": name}, "x": 0});
    let scene = |apart: f64, pressure: f64| {
        json!({
            "body": block(1.0 + apart),
            "further-bodies": [{"name": "base", "body": block(0.0), "material": {"young": 1000, "poisson": 0}}],
            "material": {"young": 1000, "poisson": 0},
            "supports": [{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}, rollers("left"), rollers("right"),
                         {"on": {"boundary": "top"}, "y": if pressure == 0.0 { 0.0 } else { -2.0 * pressure / 1000.0 }}],
            "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"body": {"boundary": "base.top"}}}]
        })
    };
    let table = along(&scene(0.0, 5.0), &["0,1:1,1", "0.4,0:0.4,2"]);
    for (row, &pressure) in table["pressure"].iter().enumerate() {
        let line = table["line"][row];
        let is_right = if line == 0.0 { (pressure - 5.0).abs() < 1e-7 } else { pressure.is_nan() };
        assert!(is_right || table["body"][row].is_nan(), "row {row}: {pressure}");
    }
    for body in [0.0, 1.0] {
        let covered: Vec<[f64; 2]> = parts(&table, body);
        assert!(covered.len() == 2 && (covered[0][1] - 1.0).abs() < ROUNDING, "{covered:?}");
    }
    let apart = along(&scene(0.25, 0.0), &["0.4,0:0.4,2.25"]);
    assert_eq!((parts(&apart, 1.0), parts(&apart, 0.0)), (vec![[0.0, 1.0]], vec![[1.25, 2.25]]));
}

/// GOAL: the pressure on the contact of one obstacle, on edges of cells, and nowhere else. CONDITIONS: a block pressed
/// into a corner of two planes, and a layer of one cell between two planes. REFERENCE: the pressure of each plane is
/// uniform.
#[test]
fn the_pressure_is_that_of_the_obstacle_on_which_the_line_lies() {
    let cube = |x: f64, planes: Value| {
        json!({
            "model": "space",
            "body": {"box": {"x": axis([0.0, x], 2), "y": axis([0.0, 1.0], 2), "z": axis([0.0, 1.0], 2), "element": "hex8"}},
            "material": {"young": 1000, "poisson": 0}, "obstacles": planes, "gap": 0
        })
    };
    let plane = |boundary: &str, approach: &str, point: [f64; 3], normal: [f64; 3]| json!({"boundary": boundary, "approach": approach, "shape": {"plane": {"point": point, "normal": normal}}});
    // Planes at the right and the top overlap the cube by 0.01 at Young's modulus 1000: 10 on each.
    let mut scene = cube(
        1.0,
        json!([
            plane("right", "+x", [0.99, 0.0, 0.0], [1.0, 0.0, 0.0]),
            plane("top", "+z", [0.0, 0.0, 0.99], [0.0, 0.0, 1.0])
        ]),
    );
    scene["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "bottom"}, "z": 0},
                               {"on": {"boundary": "front"}, "y": 0}]);
    let lines = ["1,0,0.5:1,1,0.5", "1,0.5,0:1,0.5,1", "0,0.3,1:1,0.3,1", "0.5,0.5,0:0.5,0.5,1"];
    let table = along(&scene, &lines);
    for (row, &pressure) in table["pressure"].iter().enumerate() {
        match table["line"][row] {
            3.0 => assert!(pressure.is_nan(), "row {row}: {pressure}"),
            line => assert!((pressure - 10.0).abs() < 1e-6, "line {line}, row {row}: {pressure}"),
        }
    }
}

/// GOAL: a line that cannot be drawn is refused in one sentence, one that meets no body is written with a warning.
#[test]
fn lines_that_do_not_fit_are_refused() {
    let desk = Desk::new();
    desk.write("block.json", support::program::scene().to_string());
    let run =
        |line: &str| desk.run(&["solve", "block.json", "--out", "o", "--pictures", "none", &format!("--along={line}")]);
    for (line, phrase) in [
        ("0,0", "it must be X1,Y1:X2,Y2"),
        ("0,0:1", "one end has 2 coordinates and the other 1"),
        ("0,0:x,1", "`x` is not a finite number"),
        ("0,inf:1,1", "`inf` is not a finite number"),
        ("1,1:1,1", "both ends are the same point"),
    ] {
        let refused = run(line).ends_with(2);
        assert!(refused.stderr.contains(phrase), "{}", refused.stderr);
    }
    run("0,0,0:1,1,1")
        .fails_with(1, &["each end of `0,0,0:1,1,1` needs the 2 coordinates of a point of the scene, not 3"]);
    let homeless = desk.run(&["solve", "block.json", "--along", "0,0:1,1"]).ends_with(2);
    assert!(homeless.stderr.contains("--out"), "{}", homeless.stderr);
    let outside = run("7,7:8,8").ends_with(0);
    assert!(outside.stderr.contains("--along 7,7:8,8 meets no body; the mesh reaches from"), "{}", outside.stderr);
    assert_eq!(fs::read_to_string(desk.path("o/along.csv")).unwrap().lines().count(), 1);
    // The table of an earlier run would not belong to the next answer.
    desk.run(&["solve", "block.json", "--out", "o", "--pictures", "none"]).ends_with(0);
    assert!(!desk.path("o/along.csv").exists());
}

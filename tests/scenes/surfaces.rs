//! GOAL: obstacles from files of triangles: their rows, compared with brute force, with the shapes that they
//! approximate and with closed forms; the same surface from all formats; files that are refused, with the place of the
//! fault.
//!
//! BODY: a clamped unit cube of 4 x 4 x 4 Hex8; candidates are the nodes of its top, z = 1. For other positions, the
//! tests ask the obstacle directly.

use std::fs;
use std::path::Path;
use support::bodies::cube_under;

use serde_json::{Value, json};
use signorini::scene::{ObstacleRow, PlacedObstacle};
use signorini::{Error, Model, Scene, solve_qp};
use support::triangles::Triangles;
use tempfile::TempDir;

/// Rounding of distances of order one to triangles.
const ROUNDING: f64 = 1e-14;

/// The model of a scene in a folder.
fn model_in(folder: &Path, scene: &Value) -> Result<Model, Error> {
    Scene { folder: Some(folder.into()), ..Scene::from_json(&scene.to_string(), "scene")? }.build()
}

/// The model of a scene whose obstacle is the binary STL file of this surface.
fn with_surface(rule: &str, surface: &Triangles, side: &str, gap: f64) -> Model {
    let desk = TempDir::new().unwrap();
    fs::write(desk.path().join("die.stl"), surface.binary_stl()).unwrap();
    model_in(desk.path(), &cube_under(rule, json!({"surface": {"file": "die.stl", "side": side}}), gap)).unwrap()
}

fn row(model: &Model, at: [f64; 3]) -> Option<ObstacleRow> {
    model.obstacles().first().and_then(PlacedObstacle::rigid).unwrap().row(at).unwrap()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| a[axis] * b[axis]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Random numbers from 0 to 1 from a seed.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The distance of a point from a triangle, by the regions of its corners, its sides and its inside.
///
/// # Source
/// C. Ericson, *Real-Time Collision Detection*, 2005, section 5.1.5.
fn distance_to([a, b, c]: [[f64; 3]; 3], p: [f64; 3]) -> f64 {
    let (ab, ac, ap, bp, cp) = (minus(b, a), minus(c, a), minus(p, a), minus(p, b), minus(p, c));
    let to = |q: [f64; 3]| length(minus(p, q));
    let along = |from: [f64; 3], way: [f64; 3], t: f64| [0, 1, 2].map(|axis| from[axis] + t * way[axis]);
    let (d1, d2, d3, d4) = (dot(ab, ap), dot(ac, ap), dot(ab, bp), dot(ac, bp));
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d1 <= 0.0 && d2 <= 0.0 {
        return to(a);
    }
    if d3 >= 0.0 && d4 <= d3 {
        return to(b);
    }
    if d6 >= 0.0 && d5 <= d6 {
        return to(c);
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return to(along(a, ab, d1 / (d1 - d3)));
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return to(along(a, ac, d2 / (d2 - d6)));
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return to(along(b, minus(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6))));
    }
    let normal = cross(ab, ac);
    dot(ap, normal).abs() / length(normal)
}

/// The winding number of the surface about a point: the sum of the solid angles of its triangles.
///
/// # Source
/// A. van Oosterom, J. Strackee, *The solid angle of a plane triangle*, IEEE Trans. Biomed. Eng. 30 (1983) 125-126.
fn winding(surface: &Triangles, p: [f64; 3]) -> f64 {
    let angle = |index: usize| {
        let [a, b, c] = surface.triangle(index).map(|corner| minus(corner, p));
        let (la, lb, lc) = (length(a), length(b), length(c));
        2.0 * dot(a, cross(b, c)).atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
    };
    (0..surface.corners.len()).map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// Irregular bodies: a ball, a ring, and both intersecting, with every vertex moved.
fn rough(seed: u64) -> Triangles {
    let mut next = random(seed);
    let ball = Triangles::sphere(0.6, 2);
    let ring = Triangles::torus(0.5, 0.2, 24, 10);
    let base = match seed % 3 {
        0 => ball,
        1 => ring,
        _ => ball.moved(|[x, y, z]| [x + 0.3, y, z]).and(ring),
    };
    let mut moved = |at: [f64; 3], by: f64| at.map(|part| part + by * (next() - 0.5));
    base.moved(|at| moved(at, 0.03)).moved(|[x, y, z]| [x + 0.5, y + 0.5, z + 1.4]).single()
}

/// GOAL: the search tree gives the distance and the side that a search through all triangles gives.
#[test]
fn distances_and_sides_are_those_of_a_search_through_all_triangles() {
    let mut inside = 0;
    for seed in 0..12 {
        let surface = rough(seed);
        let model = with_surface("closest-point", &surface, "outside", 0.0);
        let mut next = random(100 + seed);
        for _ in 0..150 {
            let at = [0, 1, 2].map(|axis| if axis == 2 { 0.4 + 2.0 * next() } else { -0.5 + 2.0 * next() });
            let found = row(&model, at).unwrap();
            let distance = (0..surface.corners.len())
                .map(|index| distance_to(surface.triangle(index), at))
                .fold(f64::INFINITY, f64::min);
            assert!((found.gap.abs() / distance - 1.0).abs() < 1e-12, "{seed} {at:?} {found:?} {distance}");
            let turns = winding(&surface, at);
            assert!((turns - turns.round()).abs() < 1e-9);
            assert_eq!(found.gap < 0.0, turns > 0.5, "{seed} {at:?} {found:?} {turns}");
            // The normal points to a point of the surface.
            let foot = [0, 1, 2].map(|axis| at[axis] + found.gap * found.normal[axis]);
            let off = (0..surface.corners.len()).map(|index| distance_to(surface.triangle(index), foot));
            assert!(off.fold(f64::INFINITY, f64::min) < 1e-14, "{seed} {at:?} {found:?}");
            inside += usize::from(found.gap < 0.0);
        }
    }
    assert!(inside > 100, "only {inside} places are inside");
}

/// GOAL: along the approach direction the row ends at the point at which the line enters the solid: the next one ahead,
/// or behind a point inside.
#[test]
fn along_the_approach_direction_the_row_ends_at_the_point_of_entry_into_the_solid() {
    let mut met = 0;
    for seed in 0..6 {
        let surface = rough(seed);
        let model = with_surface("approach", &surface, "outside", 0.0);
        let within = |x: f64, y: f64, z: f64| winding(&surface, [x, y, z]) > 0.5;
        let mut next = random(200 + seed);
        for _ in 0..20 {
            let [x, y, z] = [next() * 0.9, next() * 0.9, 0.6 + 1.4 * next()];
            let found = row(&model, [x, y, z]);
            // Steps shorter than the thickness of the tubes.
            let sense = if within(x, y, z) { -1.0 } else { 1.0 };
            let steps = (0..700).map(|step| z + sense * 0.003 * step as f64);
            let change = steps.map(|z| (z, within(x, y, z))).find(|&(_, is_within)| is_within == (sense > 0.0));
            let Some((beyond, _)) = change else {
                assert!(found.is_none(), "{seed} {found:?}");
                continue;
            };
            let (mut a, mut b) = (beyond - sense * 0.003, beyond);
            for _ in 0..60 {
                let middle = (a + b) / 2.0;
                if within(x, y, middle) == (sense > 0.0) { b = middle } else { a = middle }
            }
            let found = found.unwrap();
            assert_eq!(found.normal, [0.0, 0.0, 1.0]);
            assert!((found.gap - (a - z)).abs() < 1e-9, "{seed} {found:?} {}", a - z);
            met += 1;
        }
    }
    assert!(met > 30, "only {met} lines enter the solid");
}

/// The signed distance to the unit cube about the origin, positive outside.
fn to_cube(at: [f64; 3]) -> f64 {
    let beyond = at.map(|part| part.abs() - 0.5);
    let outside = length(beyond.map(|part| part.max(0.0)));
    if outside > 0.0 { outside } else { beyond.into_iter().fold(f64::NEG_INFINITY, f64::max) }
}

#[test]
fn rows_of_a_cube_agree_with_its_distance_function_outside_and_inside() {
    let cube = Triangles::cuboid([-0.5; 3], [0.5; 3]);
    for (side, sign) in [("outside", 1.0), ("inside", -1.0)] {
        let model = with_surface("closest-point", &cube, side, 0.0);
        let mut next = random(7);
        for _ in 0..500 {
            let at = [0, 1, 2].map(|_| 2.0 * next() - 1.0);
            let found = row(&model, at).unwrap();
            assert!((found.gap - sign * to_cube(at)).abs() < ROUNDING, "{side} {at:?} {found:?}");
            assert!((length(found.normal) - 1.0).abs() < ROUNDING);
            let foot = [0, 1, 2].map(|axis| at[axis] + found.gap * found.normal[axis]);
            assert!(to_cube(foot).abs() < ROUNDING, "{side} {at:?} {found:?}");
        }
        // On a face, an edge and a corner, normals are weighted by angles, on which the diagonals of the faces have no
        // effect.
        for on in [[0.1, 0.2, -0.5], [0.5, 0.2, -0.5], [0.5, 0.5, -0.5]] {
            let out = on.map(|part: f64| if part.abs() == 0.5 { part.signum() } else { 0.0 });
            let found = row(&model, on).unwrap();
            assert!(found.gap.abs() < ROUNDING, "{side} {on:?} {found:?}");
            let expected = out.map(|part| -sign * part / length(out));
            assert!(length(minus(found.normal, expected)) < ROUNDING, "{side} {on:?} {found:?}");
        }
    }
}

#[test]
fn a_point_equally_close_to_several_faces_has_their_mean_normal_or_the_approach_direction() {
    let hole = with_surface("closest-point", &Triangles::cuboid([-0.5; 3], [0.5; 3]), "inside", 0.0);
    // A point equally close to the faces x = 0.5 and z = 0.5: the row has the mean direction and ends at the edge of
    // both planes.
    let found = row(&hole, [0.3, 0.0, 0.3]).unwrap();
    let half = 0.5_f64.sqrt();
    assert!(length(minus(found.normal, [half, 0.0, half])) < ROUNDING, "{found:?}");
    assert!((found.gap - 0.2 * 2.0_f64.sqrt()).abs() < ROUNDING, "{found:?}");
    // In the centre the normals of all six faces cancel.
    let found = row(&hole, [0.0; 3]).unwrap();
    assert!(length(minus(found.normal, [0.0, 0.0, 1.0])) < ROUNDING && (found.gap - 0.5).abs() < ROUNDING, "{found:?}");
    let ball = with_surface("closest-point", &Triangles::sphere(0.5, 3), "inside", 0.0);
    // The flat triangles of the ball are not all equally close; one of the closest is nearly vertical above.
    let found = row(&ball, [0.0; 3]).unwrap();
    assert!(found.normal[2] > 0.9 && (found.gap - 0.5).abs() < 0.01, "{found:?}");
}

#[test]
fn rows_in_a_hole_end_at_its_far_side_along_the_approach_direction() {
    let hole = with_surface("approach", &Triangles::cuboid([0.0; 3], [1.0, 1.0, 2.0]), "inside", 0.0);
    // Inside the hole, beyond its far side, and in front of its near side.
    for (z, gap) in [(1.5, 0.5), (2.25, -0.25), (-0.5, 2.5)] {
        assert_eq!(row(&hole, [0.3, 0.4, z]).map(|row| row.gap), Some(gap), "{z}");
    }
    assert_eq!(row(&hole, [1.3, 0.4, 1.5]), None);
}

/// GOAL       a surface of triangles converges to the sphere that it approximates
/// CONDITIONS a clamped cube under a sphere of radius 1.5 that starts 0.05 inside the cube; both rules
/// PARAMETERS icosahedra subdivided 3, 4 and 5 times: 1,280 to 20,480 triangles, with half the side length each time
/// REFERENCE  the shape `sphere`; the distance between chord and arc falls by a factor of four
#[test]
fn rows_and_force_of_a_sphere_of_triangles_converge_with_the_square_of_their_size() {
    let centre = [0.43, 0.37, 2.5];
    for rule in ["approach", "closest-point"] {
        let exact =
            support::scenes::built(&cube_under(rule, json!({"sphere": {"centre": centre, "radius": 1.5}}), -0.05));
        let force = |model: &Model| solve_qp(model.problem()).unwrap().contact_force();
        let expected = force(&exact);
        let errors: Vec<[f64; 2]> = [3, 4, 5]
            .map(|times| {
                let ball = Triangles::sphere(1.5, times).moved(|at| [0, 1, 2].map(|axis| at[axis] + centre[axis]));
                let model = with_surface(rule, &ball, "outside", -0.05);
                assert_eq!(model.rows().len(), exact.rows().len());
                let off =
                    |(a, b): (&signorini::scene::ContactRow, &signorini::scene::ContactRow)| (a.gap - b.gap).powi(2);
                let rows = model.rows().iter().zip(exact.rows()).map(off).sum::<f64>() / model.rows().len() as f64;
                [rows.sqrt(), (force(&model) / expected - 1.0).abs()]
            })
            .into();
        println!("{rule}: root mean square of gaps and relative error of the force {expected:.6e}: {errors:?}");
        for errors in errors.windows(2) {
            let ratio = [0, 1].map(|which| errors[0][which] / errors[1][which]);
            assert!((3.4..4.6).contains(&ratio[0]), "{rule}: {ratio:?}");
            assert!((2.5..6.5).contains(&ratio[1]), "{rule}: {ratio:?}");
        }
        assert!(errors[2][0] < 5e-4 && errors[2][1] < 0.02, "{rule}: {errors:?}");
    }
}

#[test]
fn all_formats_scales_and_orientations_give_the_same_rows() {
    let desk = TempDir::new().unwrap();
    let die = Triangles::sphere(0.75, 2).moved(|[x, y, z]| [x + 0.5, y + 0.5, z + 1.75]).single();
    let clockwise = Triangles { corners: die.corners.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..die.clone() };
    let thousandfold = die.clone().moved(|at| minus(at, [0.5, 0.0, -4.0]).map(|part| 1024.0 * part));
    let write = |name: &str, content: &[u8]| fs::write(desk.path().join(name), content).unwrap();
    write("die.stl", &die.binary_stl());
    write("solid.stl", &[b"solid".as_slice(), &die.binary_stl()[5..]].concat());
    write("text.stl", die.ascii_stl().as_bytes());
    write("die.OBJ", die.obj().as_bytes());
    write("clockwise.obj", clockwise.obj().as_bytes());
    write("large.obj", thousandfold.obj().as_bytes());
    for rule in ["approach", "closest-point"] {
        let rows = |surface: Value| {
            let model = model_in(desk.path(), &cube_under(rule, json!({"surface": surface}), -0.02)).unwrap();
            model.rows().iter().map(|row| (row.node, row.normal, row.gap)).collect::<Vec<_>>()
        };
        let expected = rows(json!({"file": "die.stl"}));
        assert!(expected.len() > 15);
        for file in ["solid.stl", "text.stl", "die.OBJ"] {
            assert_eq!(rows(json!({"file": file})), expected, "{file}");
        }
        for other in [
            json!({"file": "clockwise.obj"}),
            json!({"file": "large.obj", "scale": 1.0 / 1024.0, "origin": [0.5, 0, -4]}),
        ] {
            for (found, expected) in rows(other.clone()).into_iter().zip(&expected) {
                assert_eq!(found.0, expected.0);
                assert!((found.2 - expected.2).abs() < ROUNDING, "{other} {found:?} {expected:?}");
                assert!(length(minus(found.1, expected.1)) < 1e-12, "{other} {found:?} {expected:?}");
            }
        }
    }
}

#[test]
fn triangles_without_area_do_not_change_the_rows() {
    let desk = TempDir::new().unwrap();
    let cube = Triangles::cuboid([0.0, 0.0, 1.1], [1.0, 1.0, 2.1]);
    // An edge of the cube gets an additional vertex on it; triangles without area close the T-shaped junction.
    let mut split = cube.clone();
    split.vertices.push([0.5, 0.0, 1.1]);
    let on_edge = |corners: &[usize; 3]| corners.contains(&0) && corners.contains(&1);
    let place = split.corners.iter().position(on_edge).unwrap();
    let [a, b, c] = split.corners[place];
    let turned = if (a, b) == (0, 1) || (b, c) == (0, 1) || (c, a) == (0, 1) { [1, 0, 8] } else { [0, 1, 8] };
    let third = [a, b, c].into_iter().find(|&corner| corner > 1).unwrap();
    // One triangle is divided at the new vertex, and a triangle without area fills the gap between the edges.
    let [from, to] = if turned == [1, 0, 8] { [0, 1] } else { [1, 0] };
    split.corners[place] = [from, 8, third];
    split.corners.extend([[8, to, third], [from, to, 8], [2, 2, 3]]);
    for (name, surface) in [("cube.obj", &cube), ("split.obj", &split)] {
        fs::write(desk.path().join(name), surface.obj()).unwrap();
    }
    for rule in ["approach", "closest-point"] {
        let [whole, cut] = ["cube.obj", "split.obj"]
            .map(|file| model_in(desk.path(), &cube_under(rule, json!({"surface": {"file": file}}), 0.0)).unwrap());
        let mut next = random(11);
        for _ in 0..200 {
            let at = [next() * 0.98 + 0.01, next() * 0.98 + 0.01, 0.5 + next()];
            let (a, b) = (row(&whole, at).unwrap(), row(&cut, at).unwrap());
            assert!((a.gap - b.gap).abs() < ROUNDING && length(minus(a.normal, b.normal)) < ROUNDING, "{a:?} {b:?}");
        }
    }
}

#[test]
fn a_model_with_another_gap_has_the_rows_of_a_moved_surface() {
    let die = Triangles::sphere(0.75, 2).moved(|[x, y, z]| [x + 0.5, y + 0.5, z + 1.75]);
    for rule in ["approach", "closest-point"] {
        let model = with_surface(rule, &die, "outside", 0.0);
        // The file was removed with its folder: it is not read again.
        let moved = model.with_gap(-0.04).unwrap();
        let expected = with_surface(rule, &die.clone().moved(|[x, y, z]| [x, y, z - 0.04]), "outside", 0.0);
        assert_eq!(moved.rows().len(), expected.rows().len());
        for (found, expected) in moved.rows().iter().zip(expected.rows()) {
            // The vertices of the file are moved before they are rounded to single precision, so that the surfaces
            // differ by rounding.
            assert!((found.gap - expected.gap).abs() < 1e-6, "{found:?} {expected:?}");
        }
    }
}

/// The error of a scene with this file.
fn refusal(name: &str, content: &[u8], surface: Value) -> String {
    let desk = TempDir::new().unwrap();
    fs::write(desk.path().join(name), content).unwrap();
    let error = model_in(desk.path(), &cube_under("approach", json!({"surface": surface}), 0.0)).map(drop).unwrap_err();
    error.to_string().replace(desk.path().to_str().unwrap(), "")
}

#[test]
fn a_file_without_a_closed_surface_is_refused_with_the_place_of_the_fault() {
    let cube = Triangles::cuboid([0.0; 3], [1.0; 3]);
    let without = |count: usize| {
        let corners = cube.corners[..cube.corners.len() - count].to_vec();
        Triangles { corners, ..cube.clone() }
    };
    let mut flipped = cube.clone();
    flipped.corners[4].swap(0, 1);
    // Two cubes with a common edge.
    let crowded = cube.clone().and(cube.clone().moved(|[x, y, z]| [x + 1.0, y + 1.0, z]));
    let mut apart = cube.clone();
    apart.vertices.push([0.0, 0.0, 1e-9]);
    apart.corners[0] = apart.corners[0].map(|corner| if corner == 0 { 8 } else { corner });
    let sheet = Triangles { corners: vec![[0, 1, 2], [0, 2, 1]], ..cube.clone() };
    let far = cube.clone().moved(|at| at.map(|part| 1e100 * part));
    let mut nan = cube.binary_stl();
    nan[84 + 50 + 12 + 12 + 4..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut long = cube.binary_stl();
    long[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let text = cube.ascii_stl();
    let stl = json!({"file": "die.stl"});
    let obj = json!({"file": "die.obj"});
    for (surface, content, phrases) in [
        (&stl, without(1).binary_stl(), vec!["/die.stl, byte 184", "not closed", "3 edges", "from [", "merged"]),
        (&stl, without(3).ascii_stl().into_bytes(), vec!["/die.stl:", "not closed", "7 edges"]),
        (&obj, without(1).obj().into_bytes(), vec!["/die.obj:", "3 edges"]),
        (&obj, apart.obj().into_bytes(), vec!["/die.obj:", "not closed", "4 edges", "merged"]),
        (&obj, flipped.obj().into_bytes(), vec!["/die.obj:", "3 edges", "in the same direction", "orient"]),
        (&obj, crowded.obj().into_bytes(), vec!["/die.obj:", "more than two triangles"]),
        (&obj, sheet.obj().into_bytes(), vec!["/die.obj:1:", "encloses no volume"]),
        (&obj, far.obj().into_bytes(), vec!["/die.obj:12:", "beyond 1e90"]),
        (&stl, b"solid nothing\nendsolid\n".to_vec(), vec!["/die.stl:1:", "no triangle"]),
        (&obj, b"v 0 0 0\n".to_vec(), vec!["/die.obj:1:", "no triangle"]),
        (&obj, Vec::new(), vec!["/die.obj:1:", "no triangle"]),
        (&stl, Vec::new(), vec!["/die.stl, byte 0", "not an STL file", "0 bytes"]),
        (&stl, nan, vec!["/die.stl, byte 158", "NaN", "finite"]),
        (&stl, long, vec!["/die.stl, byte 80", "4294967295 triangles", "214748364834 bytes", "684"]),
        (&stl, cube.binary_stl()[..300].to_vec(), vec!["/die.stl, byte 80", "12 triangles", "300"]),
        (&stl, text.replace("endloop", "ending").into_bytes(), vec!["/die.stl:7:", "ASCII STL"]),
        (&stl, text.replacen("vertex 0e0", "vertex zero", 1).into_bytes(), vec!["/die.stl:4:", "three numbers"]),
        (&stl, text.replacen("vertex 0e0", "vertex inf", 1).into_bytes(), vec!["/die.stl:4:", "inf", "finite"]),
        (&stl, text.replacen("vertex 0e0", "endfacet", 1).into_bytes(), vec!["/die.stl:4:", "after 0 vertices"]),
        (&stl, text.replacen("endfacet", "", 1).into_bytes(), vec!["/die.stl:9:", "before the one of line 2"]),
        (&stl, text.as_bytes()[..text.len() - 40].to_vec(), vec!["the file ends in the facet"]),
        (&obj, b"v 0 0\n".to_vec(), vec!["/die.obj:1:", "three numbers"]),
        (&obj, b"v 0 0 0\nf 1 1\n".to_vec(), vec!["/die.obj:2:", "this has 2"]),
        (&obj, b"v 0 0 0\nf 1 2 0\n".to_vec(), vec!["/die.obj:2:", "among the 1 so far"]),
        (&obj, b"v 0 0 0\nf 1 -2 1\n".to_vec(), vec!["/die.obj:2:", "from -1 backwards"]),
        (&obj, b"v 0 0 nan\n".to_vec(), vec!["/die.obj:1:", "NaN", "finite"]),
        (&json!({"file": "die.ply"}), b"ply".to_vec(), vec!["/die.ply:1:", "`.stl` or `.obj`"]),
        (&json!({"file": "die.stl", "scale": 0}), cube.binary_stl(), vec!["surface.scale`", "positive and finite"]),
        (&json!({"file": "die.stl", "scale": -1}), cube.binary_stl(), vec!["surface.scale`", "-1"]),
        (&json!({"file": "die.stl", "side": "below"}), cube.binary_stl(), vec!["surface.side`", "inside"]),
        (&json!({"file": "no.stl"}), cube.binary_stl(), vec!["cannot read /no.stl"]),
        (&json!({"file": "../secret.stl"}), cube.binary_stl(), vec!["cannot read"]),
    ] {
        let name = surface["file"].as_str().filter(|name| name.starts_with("die.")).unwrap_or("die.stl");
        let error = refusal(name, &content, surface.clone());
        assert!(!error.contains('\n'), "{error}");
        for phrase in phrases {
            assert!(error.contains(phrase), "{error:?} does not contain {phrase:?}");
        }
    }
}

/// Work that grows with the square of the number of copies would take about an hour here.
#[test]
fn very_many_copies_of_a_triangle_are_refused_at_the_first_edge_that_they_crowd() {
    let copies = 500_000;
    let cube = Triangles::cuboid([0.0; 3], [1.0; 3]);
    let last = cube.corners[cube.corners.len() - 1];
    let runs = |[a, b, c]: [usize; 3]| [[a, b], [b, c], [c, a]];
    // The first triangle along an edge of the one that is copied.
    let crowded =
        |edge: &[usize; 2]| runs(last).iter().any(|[from, to]| edge == &[*from, *to] || edge == &[*to, *from]);
    let of_cube = cube.corners.iter().enumerate();
    let (triangle, edge) = of_cube
        .flat_map(|(index, &corners)| runs(corners).map(|edge| (index, edge)))
        .find(|(_, edge)| crowded(edge))
        .unwrap();
    let mut alone = cube.clone();
    alone.corners = vec![last; copies];
    let mut on_cube = cube.clone();
    on_cube.corners.extend(&alone.corners);
    for (surface, triangle, edge) in [(alone, 0, runs(last)[0]), (on_cube, triangle, edge)] {
        let error = refusal("die.stl", &surface.binary_stl(), json!({"file": "die.stl"}));
        let [from, to] = edge.map(|vertex| cube.vertices[vertex]);
        let place = format!("/die.stl, byte {}:", 84 + 50 * triangle);
        let first = format!(
            "more than two triangles meet at an edge, so that inside and outside cannot be distinguished; the first runs from {from:?} to {to:?}"
        );
        assert!(error.contains(&place) && error.contains(&first), "{error:?} does not contain {place:?} and {first:?}");
    }
}

#[test]
fn a_surface_outside_the_folder_of_the_scene_is_read_only_if_that_is_allowed() {
    let desk = TempDir::new().unwrap();
    fs::create_dir(desk.path().join("s")).unwrap();
    let die = Triangles::sphere(0.75, 2).moved(|[x, y, z]| [x + 0.5, y + 0.5, z + 1.75]);
    fs::write(desk.path().join("die.stl"), die.binary_stl()).unwrap();
    let text = cube_under("approach", json!({"surface": {"file": "../die.stl"}}), 0.0);
    let error = model_in(&desk.path().join("s"), &text).map(drop).unwrap_err().to_string();
    assert!(error.contains("`obstacles[0].shape.surface.file`") && error.contains("outside the folder"), "{error}");
    let allowed = Scene {
        folder: Some(desk.path().join("s")),
        reads_outside: true,
        ..Scene::from_json(&text.to_string(), "scene").unwrap()
    };
    assert_eq!(allowed.build().unwrap().rows().len(), 25);
}

/// Files that are truncated or changed at random are read or refused; no other ending is allowed.
#[test]
fn a_damaged_file_is_read_or_refused() {
    let desk = TempDir::new().unwrap();
    let die = Triangles::sphere(0.75, 1).moved(|[x, y, z]| [x + 0.5, y + 0.5, z + 1.75]);
    let mut next = random(3);
    let (mut read, mut refused) = (0, 0);
    for (name, whole) in
        [("die.stl", die.binary_stl()), ("text.stl", die.ascii_stl().into_bytes()), ("die.obj", die.obj().into_bytes())]
    {
        for round in 0..150 {
            let mut bytes = whole.clone();
            for _ in 0..1 + round % 4 {
                let place = (next() * bytes.len() as f64) as usize;
                bytes[place] = (next() * 256.0) as u8;
            }
            if round % 5 == 0 {
                bytes.truncate((next() * bytes.len() as f64) as usize);
            }
            fs::write(desk.path().join(name), bytes).unwrap();
            for rule in ["approach", "closest-point"] {
                match model_in(desk.path(), &cube_under(rule, json!({"surface": {"file": name}}), -0.1)) {
                    Ok(_) => read += 1,
                    Err(error) => {
                        assert!(["file-syntax", "scene"].contains(&error.code()), "{name}: {error}");
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(read > 10 && refused > 300, "{read} read, {refused} refused");
}

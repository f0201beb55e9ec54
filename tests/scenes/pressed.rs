//! Obstacles that are pressed by a force: travel and force, compared with closed forms and with obstacles of prescribed
//! travel.

use serde_json::{Value, json};
use signorini::scene::{Answer, Resultant};
use signorini::study::Sweep;
use signorini::{Error, Settings, qp};
use support::scenes::{answer, build};

use support::closed_forms::LineContact;
use support::program::Desk;

/// Difference of travel and force of two problems with the same answer: rounding times condition numbers of up to 1e5.
const SAME: f64 = 1e-10;

/// The force on each obstacle along its approach direction.
fn forces(answer: &Answer) -> Vec<f64> {
    let obstacles = answer.model().obstacles();
    let along = |(resultant, approach): (&Resultant, [f64; 3])| {
        -resultant.force.iter().zip(approach).map(|(force, part)| force * part).sum::<f64>()
    };
    answer.resultants().unwrap().iter().zip(obstacles.iter().map(|obstacle| obstacle.approach())).map(along).collect()
}

/// A block on its bottom, under an obstacle shape.
fn block(body: Value, space: bool, rule: &str, shape: Value) -> Value {
    let held = if space {
        json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0})
    } else {
        json!({"on": {"boundary": "bottom"}, "x": 0, "y": 0})
    };
    json!({
        "model": if space { "space" } else { "plane-strain" }, "body": body, "material": {"young": 1e7, "poisson": 0.3},
        "supports": [held],
        "obstacles": [{"boundary": "top", "approach": if space { "+z" } else { "+y" }, "rule": rule, "shape": shape}],
    })
}

fn axis(divisions: usize) -> Value {
    json!({"points": [0, 1], "divisions": [divisions]})
}

#[test]
fn a_prescribed_force_gives_the_travel_of_an_obstacle_moved_to_that_force() {
    let plane = json!({"rectangle": {"x": axis(12), "y": axis(8), "element": "q8"}});
    let solid = |element: &str| json!({"box": {"x": axis(4), "y": axis(4), "z": axis(3), "element": element}});
    let circle = json!({"circle": {"centre": [0.45, 2.01], "radius": 1}});
    let ball = json!({"sphere": {"apex": [0.5, 0.45, 1.002], "radius": 2}});
    let leaning = json!({"plane": {"point": [1, 1.001], "normal": [-0.1, 1]}});
    let cases = [
        block(plane.clone(), false, "approach", circle),
        block(plane, false, "closest-point", leaning),
        block(solid("hex8"), true, "approach", ball.clone()),
        block(solid("tet10"), true, "approach", ball),
    ];
    for mut scene in cases {
        let travel = 0.012;
        scene["obstacles"][0]["gap"] = (-travel).into();
        let moved = answer(&scene);
        let [force] = forces(&moved)[..] else { panic!("there is not exactly one obstacle") };
        assert!(force > 0.0);
        scene["obstacles"][0].as_object_mut().unwrap().remove("gap");
        scene["obstacles"][0]["force"] = force.into();
        let pressed = answer(&scene);
        let found = pressed.travel(0).unwrap();
        assert!((found / travel - 1.0).abs() < SAME, "{scene}: {found}");
        assert!((forces(&pressed)[0] / force - 1.0).abs() < SAME, "{scene}");
        assert_eq!(pressed.contact_set(), moved.contact_set());
        let largest = moved.displacement().iter().fold(0.0, |largest: f64, u| largest.max(u.abs()));
        let off = pressed.displacement().iter().zip(moved.displacement()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < SAME * largest, "{scene}");
        assert!(pressed.forces().unwrap().balance < 1e-11, "{scene}");
    }
}

/// GOAL: a half cylinder under a rigid plane that a force presses.
/// CONDITIONS: plane strain, radius 1, supported on its cut; the force for which Hertz gives the approach 0.01.
/// REFERENCE: Hertz: delta = F/(pi E*) (2 ln(4R/a) - 1), p0 = a E*/(2R).
#[test]
fn a_plane_pressed_on_half_a_cylinder_has_the_travel_of_hertz() {
    let (force, line) = (4.983922e-3, LineContact { modulus: 1.0 / 0.91, radius: 1.0 });
    let answer = answer(&json!({
        "model": "plane-strain",
        "body": {"half-disc": {"radius": 1, "zone": {"width": 0.1, "divisions": 8}, "element": "q8"}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": [{"on": {"boundary": "cut"}, "y": 0}, {"on": {"point": [0, 0]}, "x": 0}],
        "obstacles": [{"boundary": "arc", "approach": "-y", "force": force,
                       "shape": {"plane": {"point": [0, -1], "normal": [0, -1]}}}],
    }));
    let travel = answer.travel(0).unwrap();
    // The theory assumes a small contact; here a/R = 0.076.
    assert!((travel / 0.01 - 1.0).abs() < 1e-3, "{travel}");
    let peak = answer.pressure().iter().copied().fold(0.0, f64::max);
    assert!((peak / line.peak_pressure(force) - 1.0).abs() < 0.01, "{peak}");
}

/// GOAL: a thin ring between two plates.
/// CONDITIONS: plane stress, thickness 0.05 of the radius 1; each plate is pressed with the force F.
/// REFERENCE: S. Timoshenko, *Strength of Materials* II, thin ring under two opposite forces: the diameter shortens by
/// (pi/4 - 2/pi) F R^3/(E I); the axial and shear stiffness contribute less than a hundredth here.
#[test]
fn two_plates_on_a_ring_have_equal_travel_as_for_a_thin_ring() {
    let (force, height) = (1e-3, 0.05);
    let plate = |approach: &str, y: f64| {
        json!({"boundary": "outer", "approach": approach, "force": force,
               "shape": {"plane": {"point": [0, y], "normal": [0, y.signum()]}}})
    };
    let outer = 1.0 + height / 2.0;
    let mut scene = json!({
        "model": "plane-stress",
        "body": {"ring": {"radius": {"points": [1.0 - height / 2.0, outer], "divisions": [2]},
                          "angle": {"points": [0, 360], "divisions": [240]}, "element": "q8"}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"point": [outer, 0]}, "y": 0}, {"on": {"point": [-outer, 0]}, "y": 0},
                     {"on": {"point": [0, outer]}, "x": 0}],
        "obstacles": [plate("+y", outer), plate("-y", -outer)],
    });
    let pressed = answer(&scene);
    let [above, below] = [0, 1].map(|plate| pressed.travel(plate).unwrap());
    assert!((above / below - 1.0).abs() < 1e-8, "{above} {below}");
    let inertia = height.powi(3) / 12.0;
    let thin = (std::f64::consts::PI / 4.0 - 2.0 / std::f64::consts::PI) * force / (1000.0 * inertia);
    assert!(((above + below) / thin - 1.0).abs() < 0.02, "{} {thin}", above + below);
    for index in 0..2 {
        scene["obstacles"][index].as_object_mut().unwrap().remove("force");
        scene["obstacles"][index]["gap"] = (-[above, below][index]).into();
    }
    for moved in forces(&answer(&scene)) {
        // The ring is soft: an error of 1e-12 of its size in the travel is 1e-9 of the force.
        assert!((moved / force - 1.0).abs() < 1e-8, "{moved}");
    }
}

#[test]
fn a_sweep_over_forces_without_a_pressed_obstacle_names_the_key_that_is_missing() {
    let desk = Desk::new();
    let body = json!({"rectangle": {"x": axis(2), "y": axis(2)}});
    let scene = block(body, false, "approach", json!({"circle": {"apex": [0.5, 1], "radius": 1}}));
    desk.write("scene.json", scene.to_string());
    let phrases = ["scene.json:1:", "at `obstacles`: no obstacle is pressed by a force", "\"force\": 100"];
    desk.run(&["sweep", "scene.json", "--forces", "0:2e4:5"]).fails_with(1, &phrases);
}

#[test]
fn a_sweep_over_forces_begins_at_the_travel_of_first_contact() {
    let desk = Desk::new();
    let mut scene = block(
        json!({"rectangle": {"x": axis(12), "y": axis(8)}}),
        false,
        "approach",
        json!({"circle": {"apex": [0.5, 1.003], "radius": 1}}),
    );
    scene["obstacles"][0]["force"] = 1.into();
    desk.write("scene.json", scene.to_string());
    let report = desk.run(&["sweep", "scene.json", "--forces", "0:2e4:5", "--format", "json"]).ends_with(0).json();
    let points = report["points"].as_array().unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let travels: Vec<f64> = points.iter().map(|point| number(&point["resultants"][0]["travel"])).collect();
    assert!((travels[0] - 0.003).abs() < 1e-15, "{travels:?}");
    assert!(travels.is_sorted() && travels[4] > travels[0] + 1e-3, "{travels:?}");
    for (index, point) in points.iter().enumerate() {
        let force = 5e3 * index as f64;
        assert_eq!(number(&point["force"]), force);
        assert!((number(&point["contact"]["force"]) - force).abs() <= 1e-9 * 2e4, "{point}");
        assert_eq!(point["status"], "certified");
    }
}

#[test]
fn invalid_forces_of_a_sweep_are_refused() {
    let circle = json!({"circle": {"apex": [0.5, 1], "radius": 1}});
    let mut scene = block(json!({"rectangle": {"x": axis(2), "y": axis(2)}}), false, "approach", circle);
    let refused = |scene: &Value, force: f64, phrase: &str| {
        let error = Sweep::over_forces(&build(scene).unwrap(), &[1.0, force], &Settings::default()).unwrap_err();
        assert!(error.to_string().contains(phrase), "{error}");
    };
    refused(&scene, 1.0, "no obstacle is pressed by a force");
    scene["obstacles"][0]["force"] = 1.into();
    refused(&scene, -2.0, "-2 would pull the obstacle away");
    refused(&scene, f64::NAN, "NaN is not finite");
    let none = Sweep::over_forces(&build(&scene).unwrap(), &[], &Settings::default()).unwrap();
    assert!(none.points.is_empty());
}

#[test]
fn obstacles_that_cannot_be_pressed_are_refused_at_their_path() {
    let plain = || {
        block(
            json!({"rectangle": {"x": axis(2), "y": axis(2)}}),
            false,
            "approach",
            json!({"circle": {"apex": [0.5, 1], "radius": 1}}),
        )
    };
    let refused = |change: &dyn Fn(&mut Value), phrases: &[&str]| {
        let mut scene = plain();
        change(&mut scene);
        let error = build(&scene).unwrap_err();
        assert!(matches!(error, Error::Scene { .. } | Error::Qp(qp::Error::UnderHeld { .. })), "{error:?}");
        phrases.iter().for_each(|phrase| assert!(error.to_string().contains(phrase), "{error}"));
    };
    refused(&|scene| scene["obstacles"][0]["force"] = json!(-3), &["obstacles[0].force", "-3", "positive"]);
    refused(&|scene| scene["obstacles"][0]["force"] = json!(0), &["obstacles[0].force", "positive"]);
    refused(
        &|scene| {
            scene["obstacles"][0]["force"] = json!(3);
            scene["obstacles"][0]["gap"] = json!(0.1);
        },
        &["obstacles[0]", "both gap and force"],
    );
    refused(
        &|scene| {
            scene["obstacles"][0]["force"] = json!(3);
            scene["obstacles"][0]["shape"] = json!({"circle": {"apex": [7, 1], "radius": 1}});
        },
        &["obstacles[0].force", "no travel produces the force"],
    );
    // Two opposite plates do not support the body along the direction in which they move.
    refused(
        &|scene| {
            scene["obstacles"][0]["force"] = json!(3);
            scene["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}]);
        },
        &["translation along y"],
    );
}

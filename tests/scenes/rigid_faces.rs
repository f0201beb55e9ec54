//! Boundaries that move as rigid plates, compared with beams and with each other.

use serde_json::{Value, json};
use signorini::scene::{Answer, Resultant};
use support::scenes::{answer, build};

fn face(answer: &Answer) -> &Resultant {
    answer.resultants().unwrap().iter().find(|resultant| resultant.of == "rigid-faces[0]").unwrap()
}

/// A bar [0, length] x [-1/2, 1/2] (x [-1/2, 1/2]) with E = 1000, nu = 0; its left end is guided or clamped, its right
/// end has a plate.
fn bar(length: f64, element: &str, plate: Value) -> Value {
    let space = ["tet4", "hex8", "tet10", "hex20"].contains(&element);
    let across = json!({"points": [-0.5, 0.5], "divisions": [2]});
    let along = json!({"points": [0, length], "divisions": [20]});
    let (model, shape, held) = match space {
        true => {
            let body = json!({"box": {"x": along, "y": across, "z": across, "element": element}});
            ("space", body, json!({"on": {"boundary": "left"}, "x": 0, "y": 0, "z": 0}))
        }
        false => {
            let body = json!({"rectangle": {"x": along, "y": across, "element": element}});
            ("plane-stress", body, json!({"on": {"boundary": "left"}, "x": 0, "y": 0}))
        }
    };
    let mut plate = plate;
    plate["boundary"] = "right".into();
    json!({"model": model, "body": shape, "material": {"young": 1000, "poisson": 0}, "supports": [held], "rigid-faces": [plate]})
}

/// GOAL: a rigid plate that pulls a bar.
/// CONDITIONS: a bar of length 5 and E = 1000 under a force of 3 on its end plate; all elements.
/// REFERENCE: the stretch F L/EA, no rotation.
#[test]
fn a_plate_stretches_a_bar_uniformly_with_every_element() {
    for element in ["t3", "q4", "t6", "q8", "tet4", "hex8", "tet10", "hex20"] {
        let force = if element.len() == 2 { vec![3.0, 0.0] } else { vec![3.0, 0.0, 0.0] };
        let answer = answer(&bar(5.0, element, json!({"force": force})));
        let face = face(&answer);
        let motion = face.motion.as_ref().unwrap();
        assert!((motion.displacement[0] - 3.0 * 5.0 / 1000.0).abs() < 1e-12, "{element}: {motion:?}");
        assert!(motion.displacement[1..].iter().chain(&motion.rotation).all(|part| part.abs() < 1e-12), "{motion:?}");
        assert!(face.force.iter().zip(&force).all(|(ours, given)| (ours - given).abs() < 1e-11), "{face:?}");
        assert!(answer.forces().unwrap().balance < 1e-11);
    }
}

/// GOAL: a moment on the rigid end plate of a cantilever.
/// CONDITIONS: quadratic elements, which represent the quadratic displacement of pure bending exactly; the plane and
/// space.
/// REFERENCE: beam theory: the rotation M L/(E I) and the deflection M L^2/(2 E I).
#[test]
fn a_moment_rotates_the_end_plate_of_a_cantilever_as_in_beam_theory() {
    let (length, moment, stiffness) = (5.0, 2.0, 1000.0 / 12.0);
    for (element, moments) in [("t6", vec![moment]), ("q8", vec![moment]), ("hex20", vec![0.0, 0.0, moment])] {
        let answer = answer(&bar(length, element, json!({"moment": moments})));
        let motion = face(&answer).motion.clone().unwrap();
        let turned = motion.rotation.last().unwrap();
        assert!((turned / (moment * length / stiffness) - 1.0).abs() < 1e-9, "{element}: {turned}");
        let sunk = motion.displacement[1] / (moment * length * length / 2.0 / stiffness);
        assert!((sunk - 1.0).abs() < 1e-9, "{element}: {sunk}");
    }
}

/// GOAL        a cantilever with a rigid end plate under a transverse force
/// REFERENCE   beam with shear: w = P L^3/(3 E I) + P L/(k G A), k = 5/6; the plate keeps the end section plane, as the
/// clamp does
#[test]
fn a_force_on_the_end_plate_equals_the_reaction_of_its_prescribed_motion() {
    let (length, force) = (10.0, 0.5);
    for (element, vector) in
        [("q8", json!([0, -force])), ("tet10", json!([0, -force, 0])), ("hex20", json!([0, -force, 0]))]
    {
        let scene = bar(length, element, json!({"force": vector}));
        let bent = answer(&scene);
        let (face_bent, motion) = (face(&bent).clone(), face(&bent).motion.clone().unwrap());
        let sunk = force * length.powi(3) / 3.0 / (1000.0 / 12.0) + force * length / (5.0 / 6.0 * 500.0);
        assert!((motion.displacement[1] / -sunk - 1.0).abs() < 4e-3, "{element}: {motion:?} {sunk}");
        // Prescribing the same motion needs the same force.
        let space = motion.rotation.len() == 3;
        let rotation = match space {
            true => json!({"x": motion.rotation[0], "y": motion.rotation[1], "z": motion.rotation[2]}),
            false => json!({"z": motion.rotation[0]}),
        };
        let mut plate = json!({"x": motion.displacement[0], "y": motion.displacement[1], "rotation": rotation});
        if space {
            plate["z"] = motion.displacement[2].into();
        }
        let moved = answer(&bar(length, element, plate));
        let back = face(&moved);
        for (ours, given) in back.force.iter().chain(&back.moment).zip(face_bent.force.iter().chain(&face_bent.moment))
        {
            assert!((ours - given).abs() < 1e-8 * force * length, "{element}: {back:?} {face_bent:?}");
        }
    }
}

/// A block with nu = 0.3 between a plane and a plate that may tilt: the contact force equals the force on the plate.
#[test]
fn the_contact_carries_the_force_and_moment_of_a_pressed_plate() {
    for element in ["hex8", "tet10"] {
        let axis = || json!({"points": [-1, 1], "divisions": [3]});
        let scene = json!({
            "model": "space",
            "body": {"box": {"x": axis(), "y": axis(), "z": {"points": [0, 1], "divisions": [2]}, "element": element}},
            "material": {"young": 1000, "poisson": 0.3},
            "rigid-faces": [{"boundary": "top", "x": 0, "y": 0, "rotation": {"z": 0}, "force": [0, 0, -40], "moment": [3, 0, 0]}],
            "obstacles": [{"boundary": "bottom", "approach": "-z", "shape": {"plane": {"point": [0, 0, 0], "normal": [0, 0, -1]}}}],
        });
        let answer = answer(&scene);
        let all = answer.resultants().unwrap();
        let (obstacle, plate) = (&all[0], face(&answer));
        assert!((obstacle.force[2] - 40.0).abs() < 1e-8 && (plate.force[2] + 40.0).abs() < 1e-8, "{all:?}");
        // The moment moves the centre of the contact by M/F.
        assert!((obstacle.centre.as_ref().unwrap()[1] + 3.0 / 40.0).abs() < 1e-8, "{obstacle:?}");
        assert!(plate.motion.as_ref().unwrap().rotation[0] > 1e-6);
    }
}

#[test]
fn invalid_motions_of_rigid_faces_are_refused_at_their_path() {
    let refused = |change: &dyn Fn(&mut Value), phrases: &[&str]| {
        let mut scene = bar(2.0, "q4", json!({"force": [1, 0]}));
        change(&mut scene);
        let error = build(&scene).unwrap_err().to_string();
        phrases.iter().for_each(|phrase| assert!(error.contains(phrase), "{error}"));
    };
    let face = |value: Value| {
        move |scene: &mut Value| {
            let mut face = value.clone();
            face["boundary"] = "right".into();
            scene["rigid-faces"][0] = face;
        }
    };
    refused(&face(json!({"x": 0, "force": [1, 0]})), &["rigid-faces[0].x", "give only one"]);
    refused(&face(json!({"z": 0})), &["rigid-faces[0].z", "no such motion"]);
    refused(&face(json!({"rotation": {"x": 0}})), &["rigid-faces[0].rotation.x", "no such motion"]);
    refused(&face(json!({"moment": [1, 2]})), &["rigid-faces[0].moment", "2 entries"]);
    refused(&face(json!({"force": [1]})), &["rigid-faces[0].force", "1 entry"]);
    let overlapping = |scene: &mut Value| scene["supports"] = json!([{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]);
    refused(&overlapping, &["rigid-faces[0]", "held by supports[0]", "prescribe `x` too"]);
    let twice = |scene: &mut Value| {
        let other = json!({"boundary": "right", "force": [1, 0]});
        scene["rigid-faces"].as_array_mut().unwrap().push(other);
    };
    refused(&twice, &["rigid-faces[1].boundary", "rigid-faces[0] too"]);
    let loose = |scene: &mut Value| {
        scene["supports"] = json!([]);
        scene["rigid-faces"][0] = json!({"boundary": "right", "x": 0, "y": 0});
    };
    refused(&loose, &["rotation about z"]);
}

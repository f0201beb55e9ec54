//! Bodies of several materials in scenes: layers and strips compared with closed forms, groups of mesh files, refused
//! input.

use serde_json::{Value, json};
use signorini::scene::Answer;
use signorini::{Error, Scene, solve_qp};
use std::sync::Arc;
use support::scenes::built;

const ROUNDING: f64 = 1e-10;

/// The answer to a scene that uses the mesh files of the tests.
pub fn answer(scene: &Value) -> Answer {
    let model = Scene::from_json(&scene.to_string(), "scene").unwrap();
    let model = Scene { folder: Some("tests/meshes".into()), ..model }.build().unwrap();
    let solution = solve_qp(model.problem()).unwrap();
    Answer::of(Arc::new(model), &solution).unwrap()
}

/// A change of a scene at a JSON pointer.
pub fn changed(scene: &Value, pointer: &str, value: Value) -> Value {
    let mut scene = scene.clone();
    match scene.pointer_mut(pointer) {
        Some(place) => *place = value,
        None => {
            let (parent, key) = pointer.rsplit_once('/').unwrap();
            scene.pointer_mut(parent).unwrap()[key] = value;
        }
    }
    scene
}

pub fn refused(scene: &Value, path: &str, phrases: &[&str]) {
    let scene = Scene::from_json(&scene.to_string(), "scene").unwrap();
    let error = Scene { folder: Some("tests/meshes".into()), ..scene }.build().unwrap_err();
    assert!(matches!(&error, Error::Scene { path: found, .. } if found == path), "{path}: {error}");
    phrases.iter().for_each(|phrase| assert!(error.to_string().contains(phrase), "{error}"));
}

/// GOAL: a bar of two materials.
/// CONDITIONS: a bar of 3 m whose last metre is four times as stiff as the rest, stretched by 0.01 m.
/// REFERENCE: springs of 50 and 400 in series.
#[test]
fn a_layered_bar_has_the_stiffness_of_springs_in_series() {
    let answer = answer(&json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 2, 3], "divisions": [2, 3]}, "area": 1}},
        "material": {"young": 100, "poisson": 0.3},
        "materials": [{"box": {"min": [2], "max": [3]}, "material": {"young": 400, "poisson": 0.2}}],
        "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "right"}, "x": 0.01}]
    }));
    let force = 0.01 / (1.0 / 50.0 + 1.0 / 400.0);
    let reactions = &answer.forces().unwrap().reactions;
    assert!((reactions[0] + force).abs() < ROUNDING && (reactions[5] - force).abs() < ROUNDING, "{reactions:?}");
    assert!((answer.displacement()[2] - force / 50.0).abs() < ROUNDING);
    assert!(answer.stress().unwrap().elements.iter().all(|stress| (stress.sigma_xx - force).abs() < ROUNDING));
}

/// GOAL: a strip of two layers in pure bending.
/// CONDITIONS: plane stress, nu = 0; the ends turn to the curvature 0.01 about the neutral axis.
/// REFERENCE: the parallel-axis theorem: M = sum of E I times the curvature, and no force.
#[test]
fn a_bent_strip_of_two_layers_has_the_stiffness_of_the_parallel_axis_theorem() {
    let (layers, curvature, length) = ([(100.0, 0.0, 0.6), (700.0, 0.6, 1.0)], 0.01, 4.0);
    let area: f64 = layers.iter().map(|(e, low, high)| e * (high - low)).sum();
    let neutral = layers.iter().map(|(e, low, high)| e * (high * high - low * low) / 2.0).sum::<f64>() / area;
    let bending: f64 = layers
        .iter()
        .map(|(e, low, high): &(f64, f64, f64)| {
            e * ((high - low).powi(3) / 12.0 + (high - low) * ((low + high) / 2.0 - neutral).powi(2))
        })
        .sum();
    let turned = json!({"along": [0, 1], "places": [0, 1], "factors": [-neutral, 1.0 - neutral]});
    let answer = answer(&json!({
        "model": "plane-stress",
        "body": {"rectangle": {
            "x": {"points": [0, length], "divisions": [5]}, "y": {"points": [0, 0.6, 1], "divisions": [2, 1]}, "element": "q8"
        }},
        "materials": [
            {"box": {"min": [0, 0], "max": [4, 1]}, "material": {"young": 100, "poisson": 0}},
            {"box": {"min": [0, 0.6], "max": [4, 1]}, "material": {"young": 700, "poisson": 0}}
        ],
        "supports": [
            {"on": {"boundary": "left"}, "x": 0},
            {"on": {"point": [0, 0]}, "y": 0},
            {"on": {"boundary": "right"}, "x": curvature * length, "profile": turned}
        ]
    }));
    let resultants = answer.resultants().unwrap();
    let end = resultants.iter().find(|resultant| resultant.of == "supports[2]").unwrap();
    assert!(
        end.force[0].abs() < ROUNDING && (end.moment[0] / (-bending * curvature) - 1.0).abs() < ROUNDING,
        "{end:?}"
    );
    assert!(answer.discretisation_error().unwrap() < ROUNDING);
}

/// Two blocks of 1 x 1 side by side in one file, pulled apart: their compliances add up.
#[test]
fn each_group_of_a_mesh_file_can_have_a_different_material() {
    let scene = json!({
        "model": "plane-stress",
        "body": {"gmsh": {"file": "two-parts-q8.msh"}},
        "materials": [
            {"group": "first", "material": {"young": 100, "poisson": 0}},
            {"group": "second", "material": {"young": 300, "poisson": 0}}
        ],
        "supports": [
            {"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "bottom"}, "y": 0},
            {"on": {"boundary": "right"}, "x": 0.04}
        ]
    });
    for (scene, stress) in [
        (scene.clone(), 3.0),
        (changed(&changed(&scene, "/material", json!({"young": 300, "poisson": 0})), "/materials", json!([scene["materials"][0]])), 3.0),
        // The last of two entries for an element applies.
        (changed(&scene, "/materials/0", json!({"group": "second", "box": {"min": [0, 0], "max": [9, 9]}, "material": {"young": 5, "poisson": 0}}))
            .pointer("/materials")
            .map(|materials| changed(&changed(&scene, "/material", json!({"young": 100, "poisson": 0})), "/materials", materials.clone()))
            .unwrap(), 3.0),
    ] {
        for found in answer(&scene).stress().unwrap().nodes.iter() {
            assert!((found.sigma_xx - stress).abs() < ROUNDING, "{scene} {found:?}");
        }
    }
    refused(
        &changed(&scene, "/materials", json!([scene["materials"][1]])),
        "materials",
        &["16 elements have no material", "of the group `first` with its centroid at (0.617134080579431"],
    );
    refused(
        &changed(&scene, "/materials/0/group", json!("rubber")),
        "materials[0].group",
        &["`rubber`", "`first`, `second`"],
    );
    let mut without = scene.clone();
    without.as_object_mut().unwrap().remove("materials");
    without["material"] = json!({"young": 1, "poisson": 0});
    let scene = Scene::from_json(&without.to_string(), "scene").unwrap();
    let error = Scene { folder: Some("tests/meshes".into()), ..scene }.build().unwrap_err();
    assert!(matches!(error, Error::Refused { code: "several-groups", .. }), "{error}");
}

/// A square with another material in its right half.
fn halves() -> Value {
    json!({
        "body": {"rectangle": {"x": {"points": [0, 2], "divisions": [4]}, "y": {"points": [0, 1], "divisions": [2]}}},
        "material": {"young": 100, "poisson": 0.3, "density": 2},
        "materials": [{"box": {"min": [1, 0], "max": [2, 1]}, "material": {"young": 50, "poisson": 0.2, "density": 7}}],
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]
    })
}

#[test]
fn gravity_acts_on_each_material_by_its_density() {
    let mut scene = halves();
    scene["loads"] = json!([{"gravity": [0, -1]}]);
    let answer = answer(&scene);
    let loads = answer.resultants().unwrap().iter().find(|resultant| resultant.of == "loads").unwrap().clone();
    assert!((loads.force[1] + 9.0).abs() < ROUNDING, "{loads:?}");
    assert!((loads.centre.unwrap()[0] - (2.0 * 0.5 + 7.0 * 1.5) / 9.0).abs() < ROUNDING);
    scene["materials"][0]["material"].as_object_mut().unwrap().remove("density");
    refused(&scene, "material", &["loads[0].gravity needs a `density`"]);
}

#[test]
fn invalid_materials_are_refused_at_their_path() {
    let right = halves();
    let material = |value: Value| changed(&right, "/materials/0/material", value);
    let orthotropic = |change: &[(&str, Value)]| {
        let mut value = json!({"young": [10, 5, 4], "poisson": [0.3, 0.2, 0.1], "shear": [2, 2, 2]});
        change.iter().for_each(|(key, entry)| value[*key] = entry.clone());
        material(json!({"orthotropic": value}))
    };
    let at = |field: &str| format!("materials[0].material{field}");
    let cases = [
        (
            changed(&right, "/materials/0", json!({"material": {"young": 1, "poisson": 0}})),
            "materials[0]".into(),
            "has no place",
        ),
        (changed(&right, "/materials/0/box/max", json!([0.5, 1])), "materials[0].box.max[0]".into(), "lies below"),
        (
            changed(&right, "/materials/0/box", json!({"min": [3, 0], "max": [4, 1]})),
            "materials[0]".into(),
            "no element",
        ),
        (changed(&right, "/materials/0/box/min", json!([1])), "materials[0].box.min".into(), "2"),
        (changed(&right, "/materials/0/group", json!("steel")), "materials[0].group".into(), "the body has none"),
        (material(json!({})), at(""), "needs `young` and `poisson`, or `orthotropic`"),
        (material(json!({"young": 3})), at(""), "`poisson` is missing"),
        (material(json!({"poisson": 0.3})), at(""), "`young` is missing"),
        (material(json!({"young": 3, "poisson": 0.5})), at(".poisson"), "below 0.5 in plane strain"),
        (orthotropic(&[("young", json!([10, -5, 4]))]), at(".orthotropic.young[1]"), "-5 is not allowed"),
        (orthotropic(&[("poisson", json!([0.3, 2, 0.1]))]), at(".orthotropic.poisson[1]"), "nu_ij^2 < E_i/E_j"),
        (
            orthotropic(&[("young", json!([1, 1, 1])), ("poisson", json!([0.6, 0.6, 0.6]))]),
            at(".orthotropic.poisson"),
            "2 nu21 nu32 nu13 is -0.51",
        ),
        (orthotropic(&[("axes", json!([[1, 0, 0], [0, 1, 0]]))]), at(".orthotropic.axes"), "give an `angle`"),
        (
            orthotropic(&[("angle", json!(3)), ("around", json!({"point": [0, 0]}))]),
            at(".orthotropic.around"),
            "stands beside `angle` or `axes`",
        ),
        (
            orthotropic(&[("around", json!({"point": [0, 0], "along": [0, 0, 1]}))]),
            at(".orthotropic.around.along"),
            "is across the plane; leave it out",
        ),
        (orthotropic(&[("around", json!({"point": [0]}))]), at(".orthotropic.around.point"), "must have 2"),
        (
            changed(&orthotropic(&[]), "/materials/0/material/young", json!(3)),
            at(""),
            "`orthotropic` beside `young` or `poisson`",
        ),
        (
            changed(&orthotropic(&[]), "/body/rectangle/integration", json!("mean-dilatation")),
            "body.rectangle.integration".into(),
            "isotropic materials only",
        ),
    ];
    for (scene, path, phrase) in cases {
        refused(&scene, &path, &[phrase]);
    }
    let mut without = right.clone();
    for key in ["material", "materials"] {
        without.as_object_mut().unwrap().remove(key);
    }
    refused(&without, "material", &["is missing; a body needs a material"]);
    let bar = json!({
        "model": "bar",
        "body": {"bar": {"x": {"points": [0, 1], "divisions": [1]}, "area": 1}},
        "material": {"orthotropic": {"young": [10, 5, 4], "poisson": [0, 0, 0], "shear": [1, 1, 1], "angle": 5}},
        "supports": [{"on": {"boundary": "left"}, "x": 0}]
    });
    refused(&bar, "material.orthotropic.angle", &["no plane to turn in; leave it out"]);
}

#[test]
fn a_large_jump_of_stiffness_is_warned_of_with_its_values() {
    let codes = |young: f64| {
        let model = built(&changed(&halves(), "/materials/0/material/young", json!(young)));
        let warnings: Vec<String> =
            model.warnings().iter().map(|warning| format!("{}: {warning}", warning.code)).collect();
        warnings
    };
    assert_eq!(codes(1e6), Vec::<String>::new());
    let found = codes(3e-3);
    assert!(found.len() == 1 && found[0].starts_with("stiffness-jump: "), "{found:?}");
    assert!(found[0].contains("3e-3") && found[0].contains("1e2") && found[0].contains("3.3e4"), "{found:?}");
}

/// The same square twice, the second as a further body, each with different materials.
#[test]
fn further_bodies_have_separate_materials() {
    let mut scene = halves();
    scene["further-bodies"] = json!([{
        "name": "base",
        "body": {"rectangle": {"x": {"points": [0, 2], "divisions": [4]}, "y": {"points": [-1, 0], "divisions": [2]}}},
        "materials": [{"box": {"min": [0, -1], "max": [2, 0]}, "material": {"young": 9, "poisson": 0, "density": 1}}]
    }]);
    scene["supports"].as_array_mut().unwrap().push(json!({"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}));
    scene["loads"] = json!([{"gravity": [0, -1]}]);
    let answer = answer(&scene);
    let body = answer.model().body();
    let young: Vec<Vec<f64>> = body
        .regions()
        .iter()
        .map(|region| body.materials(region).map(|material| material.young()[0]).collect())
        .collect();
    assert_eq!(young, [vec![100.0, 50.0], vec![9.0]]);
    let loads = answer.resultants().unwrap().iter().find(|resultant| resultant.of == "loads").unwrap();
    assert!((loads.force[1] + 11.0).abs() < ROUNDING, "{loads:?}");
}

/// A quarter of a ring with the radii 1 and 2 of a material whose axes turn around its middle, E1 = 100 along the
/// radius and E2 = 400 around it, under an inner pressure of 3.
fn turned_ring(cells: usize) -> Value {
    json!({
        "model": "plane-stress",
        "body": {"ring": {"radius": {"points": [1, 2], "divisions": [cells]}, "angle": {"points": [0, 90], "divisions": [2 * cells]},
                          "element": "q8"}},
        "material": {"orthotropic": {"young": [100, 400, 150], "poisson": [0.1, 0.2, 0.15], "shear": [60, 50, 40],
                                     "around": {"point": [0, 0]}}},
        "supports": [{"on": {"boundary": "start"}, "y": 0}, {"on": {"boundary": "end"}, "x": 0}],
        "obstacles": [{"boundary": "outer", "approach": "+y", "shape": {"plane": {"point": [0, 9], "normal": [0, 1]}}}],
        "loads": [{"pressure": {"boundary": "inner", "value": 3}}],
    })
}

/// The radial displacement in closed form: sigma_r = A r^(k-1) + B r^(-k-1), sigma_t = k A r^(k-1) - k B r^(-k-1), k^2
/// = E2/E1.
///
/// # Source
/// S. G. Lekhnitskii, *Anisotropic Plates*, section on rings with cylindrical anisotropy.
fn of_ring(r: f64) -> f64 {
    let k = 2.0_f64;
    let outer = 2.0_f64;
    let a = -3.0 / (1.0 - outer.powf(2.0 * k));
    let b = -a * outer.powf(2.0 * k);
    let radial = a * r.powf(k - 1.0) + b * r.powf(-k - 1.0);
    let hoop = k * a * r.powf(k - 1.0) - k * b * r.powf(-k - 1.0);
    r * (hoop / 400.0 - 0.1 / 100.0 * radial)
}

/// GOAL: a ring of cylindrical orthotropy under internal pressure.
/// CONDITIONS: plane stress; a quarter of a ring of the radii 1 and 2, E2/E1 = 4, axes around its middle; two meshes.
/// REFERENCE: S. G. Lekhnitskii, *Anisotropic Plates*, rings with cylindrical anisotropy, in `of_ring`.
#[test]
fn axes_around_a_line_give_the_ring_of_closed_form() {
    let error = |cells: usize| {
        let answer = answer(&turned_ring(cells));
        let nodes = answer.model().mesh().nodes();
        let exact = of_ring(1.0);
        let away = nodes.iter().zip(answer.displacement().chunks(2)).map(|(at, found)| {
            let r = at[0].hypot(at[1]);
            let own = of_ring(r);
            (found[0] - own * at[0] / r).hypot(found[1] - own * at[1] / r) / exact
        });
        assert!(answer.forces().unwrap().balance < 1e-12);
        away.fold(0.0, f64::max)
    };
    let [coarse, fine] = [4, 8].map(error);
    // Displacements of quadratic elements converge with the third power of their size.
    assert!(coarse < 2e-3 && fine < coarse / 7.0, "{coarse:e} {fine:e}");
}

/// In space the line may have any direction: a ring turned in space has the displacements of the ring. The forces of an
/// answer come from its strains, and balance; warmer by one temperature, a free body whose expansion is the same along
/// all axes keeps its form.
#[test]
fn axes_turn_around_any_line() {
    let block = |around: Value| {
        json!({
            "model": "space",
            "body": {"box": {"x": {"points": [1, 2], "divisions": [2]}, "y": {"points": [-1, 1], "divisions": [2]},
                             "z": {"points": [0, 1], "divisions": [2]}, "element": "hex20"}},
            "material": {"orthotropic": {"young": [100, 400, 150], "poisson": [0.1, 0.2, 0.15], "shear": [60, 50, 40],
                                         "expansion": [1e-3, 1e-3, 1e-3], "around": around}},
            "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"point": [1, -1, 0]}, "y": 0, "z": 0}, {"on": {"point": [1, 1, 0]}, "z": 0}],
            "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [9, 0, 0], "normal": [1, 0, 0]}}}],
            "temperature": [{"value": 10}],
            "loads": [],
        })
    };
    let lines = [
        json!({"point": [0, 0, 0]}),
        json!({"point": [0.3, 0.2, -5], "along": [1, -2, 3]}),
        json!({"point": [1.5, 0, 0], "along": [0, 1, 0]}),
    ];
    for line in lines {
        let answer = answer(&block(line.clone()));
        for (at, found) in answer.model().mesh().nodes().iter().zip(answer.displacement().chunks(3)) {
            let exact = [1e-2 * (at[0] - 1.0), 1e-2 * (at[1] + 1.0), 1e-2 * at[2]];
            assert!(
                (0..3).all(|axis| (found[axis] - exact[axis]).abs() < 1e-13),
                "{line}: {found:?} instead of {exact:?}"
            );
        }
        assert!(
            answer
                .stress()
                .unwrap()
                .nodes
                .iter()
                .all(|stress| stress.components().iter().all(|part| part.abs() < 1e-10))
        );
    }
}

//! Distributed loads, tabulated loads, and inertia forces: resultants, closed forms, refused input.

use support::scenes::answer;

use serde_json::{Value, json};
use signorini::scene::Resultant;
use signorini::{Error, Scene};
use support::bodies::largest;
use support::scenes::built;

/// Rounding of sums of nodal forces.
const ROUNDING: f64 = 1e-12;

fn loads(scene: &Value) -> Resultant {
    answer(scene).resultants().unwrap().iter().find(|one| one.of == "loads").unwrap().clone()
}

#[track_caller]
fn close(found: &[f64], expected: &[f64], scale: f64, tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let is_close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= tolerance * scale);
    assert!(is_close, "{found:?} instead of {expected:?}");
}

/// A wall of height 3 and thickness 0.5, clamped at the bottom, with water up to `water` on its left.
fn wall(element: &str, water: f64, rows: usize) -> Value {
    json!({
        "model": "plane-stress", "thickness": 0.25,
        "body": {"rectangle": {
            "x": {"points": [0, 0.5], "divisions": [2]}, "y": {"points": [0, 3], "divisions": [rows]}, "element": element
        }},
        "material": {"young": 1e9, "poisson": 0.2},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "loads": [{"pressure": {"boundary": "left", "value": 9810,
            "profile": {"along": [0, 2], "places": [0, water], "factors": [water, 0]}}}]
    })
}

/// GOAL: a wall under the pressure of water.
/// CONDITIONS: the water line is inside an edge; a height of water of 2.2, a thickness of 0.25.
/// REFERENCE: the hydrostatic resultant: g rho h^2/2 per thickness, at a third of the height.
#[test]
fn the_pressure_of_water_has_its_resultant_at_a_third_of_its_height() {
    for element in ["t3", "t6", "q4", "q8"] {
        for rows in [3, 7] {
            let water = 2.2;
            let found = loads(&wall(element, water, rows));
            let force = 0.25 * 9810.0 * water * water / 2.0;
            close(&found.force, &[force, 0.0], force, ROUNDING);
            close(&found.centre.unwrap(), &[0.0, water / 3.0], water, ROUNDING);
        }
    }
}

/// GOAL: a pressure that grows linearly with the depth, in space.
/// CONDITIONS: the line of pressure zero crosses facets, but no corner of a facet; depth 2 along y, height of the
/// pressure 2.
/// REFERENCE: the resultant of a triangle of pressures, 40 at a third of its height.
#[test]
fn a_water_line_that_crosses_facets_in_space_has_the_exact_resultant() {
    for element in ["tet4", "hex8"] {
        let axis = |length: f64, cells: usize| json!({"points": [0, length], "divisions": [cells]});
        let found = loads(&json!({
            "model": "space",
            "body": {"box": {"x": axis(1.0, 1), "y": axis(2.0, 3), "z": axis(3.0, 4), "element": element}},
            "material": {"young": 1e9, "poisson": 0.2},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
            "loads": [{"pressure": {"boundary": "left", "value": 10,
                "profile": {"along": [0, 0, 1], "places": [0, 2], "factors": [2, 0]}}}]
        }));
        close(&found.force, &[40.0, 0.0, 0.0], 40.0, ROUNDING);
        close(&found.centre.unwrap(), &[0.0, 1.0, 2.0 / 3.0], 1.0, ROUNDING);
    }
}

/// GOAL: a cantilever under a triangular pressure.
/// CONDITIONS: plane stress with nu = 0, so that the clamp does not prevent the strain across the wall; L/h = 12.
/// REFERENCE: beam theory: the tip moves by q L^4/30EI by bending and q L^2/6kGA by shear, k = 10(1+nu)/(12+11nu).
#[test]
fn a_wall_under_water_bends_like_a_cantilever() {
    let mut scene = wall("q8", 3.0, 24);
    // A wall half as thick, whose clamp does not prevent the strain across it.
    scene["body"]["rectangle"]["x"]["points"] = json!([0, 0.25]);
    scene["material"]["poisson"] = json!(0.0);
    let answer = answer(&scene);
    let (load, length, depth, height, young) = (9810.0 * 3.0 * 0.25, 3.0_f64, 0.25, 0.25_f64, 1e9);
    let bending = load * length.powi(4) / (30.0 * young * depth * height.powi(3) / 12.0);
    let shear = load * length.powi(2) / 6.0 / (10.0 / 12.0 * young / 2.0 * depth * height);
    let (node, _) = answer.model().mesh().nearest_node([0.125, 3.0, 0.0]).unwrap();
    let tip = answer.displacement()[2 * node];
    assert!((tip / (bending + shear) - 1.0).abs() < 1e-3, "{tip} instead of {bending} and {shear}");
    assert!(shear > 3e-3 * bending);
}

/// On a boundary of curved edges, and on one of bent facets in space, the resultant equals the prescribed value.
#[test]
fn forces_and_moments_on_a_boundary_have_the_prescribed_resultant() {
    let disc = json!({
        "model": "plane-strain", "thickness": 0.3,
        "body": {"half-disc": {"centre": [3, 1], "radius": 1, "element": "t6",
            "zone": {"width": 0.3, "divisions": 2, "growth": 1.5}}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "cut"}, "x": 0, "y": 0}],
        "parts": [{"name": "side", "of": "arc", "box": {"min": [3.2, 0], "max": [4, 1]}}]
    });
    let ball = json!({
        "model": "space",
        "body": {"half-ball": {"centre": [3, 1, 1], "radius": 1, "symmetric": ["x", "y"],
            "zone": {"width": 0.3, "divisions": 2, "growth": 1.5}}},
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "cut"}, "x": 0, "y": 0, "z": 0}],
        "parts": [{"name": "side", "of": "round", "normal": {"direction": [1, 0, -1], "within": 60}}]
    });
    for (mut scene, force, moment) in
        [(disc, vec![2.0, -5.0], vec![7.0]), (ball, vec![1.0, 2.0, -3.0], vec![5.0, -7.0, 4.0])]
    {
        scene["loads"] = json!([{"force": {"boundary": "side", "value": force}}]);
        close(&loads(&scene).force, &force, 5.0, ROUNDING);
        scene["loads"] = json!([{"moment": {"boundary": "side", "value": moment}}]);
        let found = loads(&scene);
        close(&found.force, &vec![0.0; force.len()], largest(&moment), ROUNDING);
        close(&found.moment, &moment, largest(&moment), ROUNDING);
        assert_eq!(found.centre, None);
    }
}

/// In an axisymmetric model both forces are for the full circle: the axial one as prescribed, the radial one as a sum
/// of magnitudes.
#[test]
fn a_force_in_an_axisymmetric_model_is_that_of_the_full_circle() {
    let mut scene = json!({
        "model": "axisymmetric",
        "body": {"rectangle": {"x": {"points": [1, 2], "divisions": [3]}, "y": {"points": [0, 1], "divisions": [2]}}},
        "material": {"young": 100, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "y": 0}],
        "loads": [{"force": {"boundary": "top", "value": [3, -8]}}]
    });
    close(&loads(&scene).force, &[3.0, -8.0], 8.0, ROUNDING);
    let pressed = answer(&scene);
    scene["loads"] = json!([{"traction": {"boundary": "top", "value": [1.0 / std::f64::consts::PI, -8.0 / 3.0 / std::f64::consts::PI]}}]);
    close(pressed.displacement(), answer(&scene).displacement(), largest(pressed.displacement()), ROUNDING);
}

/// GOAL: pure bending of a cantilever.
/// CONDITIONS: plane stress; the rollers of the clamp prevent no lateral strain; quadratic elements, which are exact.
/// REFERENCE: u_x = -k x y, u_y = k (x^2 + nu y^2)/2 with k = M/EI.
#[test]
fn a_moment_at_the_end_of_a_cantilever_bends_it_to_a_parabola() {
    let (young, poisson, depth, moment) = (1000.0, 0.3, 0.5, 0.2);
    for element in ["t6", "q8"] {
        let answer = answer(&json!({
            "model": "plane-stress", "thickness": depth,
            "body": {"rectangle": {
                "x": {"points": [0, 4], "divisions": [3]}, "y": {"points": [-0.5, 0.5], "divisions": [2]}, "element": element
            }},
            "material": {"young": young, "poisson": poisson},
            "supports": [{"on": {"boundary": "left"}, "x": 0}, {"on": {"point": [0, 0]}, "y": 0}],
            "loads": [{"moment": {"boundary": "right", "value": [moment]}}]
        }));
        let curvature = moment / (young * depth / 12.0);
        let exact: Vec<f64> = answer
            .model()
            .mesh()
            .nodes()
            .iter()
            .flat_map(|&[x, y, _]| [-curvature * x * y, curvature * (x * x + poisson * y * y) / 2.0])
            .collect();
        close(answer.displacement(), &exact, largest(&exact), 1e-9);
    }
}

/// GOAL: bending and torsion of a bar in space by moments at its end.
/// CONDITIONS: a clamped bar of 8 x 1 x 2, nu = 0; one moment about each axis.
/// REFERENCE: beam theory: M L^2/2EI, and the angle M L/GJ with J = 0.229 a b^3 of a rectangle of sides 2 to 1
/// (Saint-Venant).
#[test]
fn moments_on_the_end_of_a_bar_in_space_bend_and_twist_it() {
    let axis = |low: f64, high: f64, cells: usize| json!({"points": [low, high], "divisions": [cells]});
    let tip = |moment: [f64; 3], at: [f64; 3]| {
        let answer = answer(&json!({
            "model": "space",
            "body": {"box": {"x": axis(0.0, 8.0, 48), "y": axis(-0.5, 0.5, 6), "z": axis(-1.0, 1.0, 6), "element": "hex8"}},
            "material": {"young": 1000, "poisson": 0.0},
            "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0, "z": 0}],
            "loads": [{"moment": {"boundary": "right", "value": moment}}]
        }));
        let (node, _) = answer.model().mesh().nearest_node(at).unwrap();
        [0, 1, 2].map(|axis| answer.displacement()[3 * node + axis])
    };
    let (about_z, about_y) = (2.0 / 12.0, 8.0 / 12.0);
    let bent = tip([0.0, 0.0, 0.1], [8.0, 0.0, 0.0]);
    assert!((bent[1] / (0.1 * 64.0 / 2.0 / (1000.0 * about_z)) - 1.0).abs() < 0.02, "{bent:?}");
    let bent = tip([0.0, 0.1, 0.0], [8.0, 0.0, 0.0]);
    assert!((bent[2] / (-0.1 * 64.0 / 2.0 / (1000.0 * about_y)) - 1.0).abs() < 0.02, "{bent:?}");
    // The torsion constant of a rectangle of 2 x 1 is 0.229 2 1^3.
    let twisted = tip([0.1, 0.0, 0.0], [8.0, 0.0, 1.0]);
    let angle = 0.1 * 8.0 / (500.0 * 0.229 * 2.0);
    assert!((twisted[1] / -angle - 1.0).abs() < 0.05, "{twisted:?} instead of {angle}");
}

/// The largest relative errors of radial displacement and of stress at the nodes of a rotating quarter annulus of radii
/// 1 and 2.
fn annulus(element: &str, cells: usize) -> [f64; 2] {
    let (young, nu, density, omega) = (1000.0, 0.3, 2.0, 3.0);
    let answer = answer(&json!({
        "model": "plane-stress",
        "body": {"ring": {"centre": [5, 7], "radius": {"points": [1, 2], "divisions": [cells]},
            "angle": {"points": [0, 90], "divisions": [2 * cells]}, "element": element}},
        "material": {"young": young, "poisson": nu, "density": density},
        "supports": [{"on": {"boundary": "start"}, "y": 0}, {"on": {"boundary": "end"}, "x": 0}],
        "loads": [{"centrifugal": {"omega": omega, "point": [5, 7]}}]
    }));
    let scale = (3.0 + nu) / 8.0 * density * omega * omega;
    let stress = answer.stress().unwrap();
    let mut worst = [0.0_f64; 2];
    for (node, &[x, y, _]) in answer.model().mesh().nodes().iter().enumerate() {
        let (x, y) = (x - 5.0, y - 7.0);
        let square = x * x + y * y;
        let radial = scale * (5.0 - 4.0 / square - square);
        let hoop = scale * (5.0 + 4.0 / square - (1.0 + 3.0 * nu) / (3.0 + nu) * square);
        let moved = (answer.displacement()[2 * node] * x + answer.displacement()[2 * node + 1] * y) / square;
        worst[0] = worst[0].max((moved / ((hoop - nu * radial) / young) - 1.0).abs());
        let found = &stress.nodes[node];
        let (c, s) = (x / square.sqrt(), y / square.sqrt());
        let along = c * c * found.sigma_xx + s * s * found.sigma_yy + 2.0 * s * c * found.sigma_xy;
        let around = s * s * found.sigma_xx + c * c * found.sigma_yy - 2.0 * s * c * found.sigma_xy;
        worst[1] = worst[1].max((along - radial).abs().max((around - hoop).abs()) / (9.0 * scale));
    }
    worst
}

/// GOAL: a rotating disc with a hole.
/// CONDITIONS: plane stress; no load except the centrifugal force; two meshes, the finer with half the cells.
/// REFERENCE: S. Timoshenko, J. N. Goodier, Theory of Elasticity, 1970, section 32: sigma_r = c (a^2 + b^2 - a^2
/// b^2/r^2 - r^2), sigma_t = c (a^2 + b^2 + a^2 b^2/r^2 - (1+3nu)/(3+nu) r^2), c = (3+nu)/8 rho omega^2.
#[test]
fn a_rotating_disc_has_the_stresses_of_timoshenko() {
    for (element, displacement, stress) in [("q4", 2.0, 0.9), ("q8", 2.0, 2.0)] {
        let [coarse, fine] = [8, 16].map(|cells| annulus(element, cells));
        let rates = [0, 1].map(|k| (coarse[k] / fine[k]).log2());
        println!("{element}: {coarse:?} {fine:?}, rates {rates:?}");
        assert!(rates[0] > displacement - 0.15 && rates[1] > stress - 0.15, "{element}: {rates:?}");
        assert!(fine[0] < 5e-3 && fine[1] < 0.07, "{element}: {fine:?}");
    }
}

/// GOAL: a rotating solid shaft.
/// CONDITIONS: a body of revolution between two planes that prevent the axial strain; radius 2.
/// REFERENCE: Timoshenko's stresses of a disc with nu/(1-nu) in place of nu: u(b) = (1+nu)(1-2nu)/E rho omega^2 b^3/4.
#[test]
fn a_rotating_shaft_has_the_radial_displacement_of_timoshenko() {
    let (young, nu, density, omega) = (100.0, 0.3, 2.0, 3.0);
    for element in ["t6", "q8"] {
        let answer = answer(&json!({
            "model": "axisymmetric",
            "body": {"rectangle": {"x": {"points": [0, 2], "divisions": [8]}, "y": {"points": [0, 1], "divisions": [2]}, "element": element}},
            "material": {"young": young, "poisson": nu, "density": density},
            "supports": [{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "top"}, "y": 0}],
            "loads": [{"centrifugal": {"omega": omega}}]
        }));
        let (young, nu) = (young / (1.0 - nu * nu), nu / (1.0 - nu));
        let (node, _) = answer.model().mesh().nearest_node([2.0, 0.5, 0.0]).unwrap();
        let exact = (1.0 - nu) * density * omega * omega * 8.0 / (4.0 * young);
        assert!((answer.displacement()[2 * node] / exact - 1.0).abs() < 1e-4, "{element}");
    }
}

/// Two bodies of different densities: gravity acts on both, and both rotate about an inclined axis.
#[test]
fn gravity_and_rotation_act_on_all_bodies_by_their_densities() {
    let cube = |low: f64| {
        let axis = |low: f64| json!({"points": [low, low + 1.0], "divisions": [2]});
        json!({"box": {"x": axis(0.0), "y": axis(0.0), "z": axis(low), "element": "hex8"}})
    };
    let mut scene = json!({
        "model": "space",
        "body": cube(0.0), "material": {"young": 1000, "poisson": 0.3, "density": 2},
        "further-bodies": [{"name": "head", "body": cube(3.0), "material": {"young": 1000, "poisson": 0.3, "density": 5}}],
        "supports": [
            {"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}, {"on": {"boundary": "head.bottom"}, "x": 0, "y": 0, "z": 0}
        ],
        "loads": [{"gravity": [1, 0, -9.81]}]
    });
    let found = loads(&scene);
    close(&found.force, &[7.0, 0.0, -7.0 * 9.81], 70.0, ROUNDING);
    close(&found.moment, &[-7.0 * 9.81 / 2.0, 7.0 * 9.81 / 2.0 + 2.0 * 0.5 + 5.0 * 3.5, -3.5], 70.0, ROUNDING);
    scene["loads"] = json!([{"centrifugal": {"omega": 2, "axis": [0, 3, 3], "point": [0, 1, 1]}}]);
    // The vector from the axis to each centre of mass; the axis passes through the origin along (0, 1, 1).
    let way = |z: f64| [0.5, (0.5 - z) / 2.0, (z - 0.5) / 2.0];
    let force = [0, 1, 2].map(|k| 4.0 * (2.0 * way(0.5)[k] + 5.0 * way(3.5)[k]));
    close(&loads(&scene).force, &force, 30.0, ROUNDING);
}

/// GOAL: the patch test with prescribed displacements.
/// CONDITIONS: all sides have a displacement that is linear along them, by a profile; T6.
/// REFERENCE: derived in the test: the displacement is linear inside.
#[test]
fn displacements_that_are_linear_along_the_sides_pass_the_patch_test() {
    let profile = json!({"along": [3, 4], "places": [-5, 5], "factors": [-5, 5]});
    let sides = ["left", "right", "bottom", "top"];
    let answer = answer(&json!({
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [3]}, "y": {"points": [0, 2], "divisions": [4]}, "element": "t6"}},
        "material": {"young": 100, "poisson": 0.3},
        "supports": sides.map(|side| json!({"on": {"boundary": side}, "x": 0.01, "y": -0.02, "profile": profile}))
    }));
    let along = |x: f64, y: f64| 0.6 * x + 0.8 * y;
    let nodes = answer.model().mesh().nodes();
    let exact: Vec<f64> = nodes.iter().flat_map(|&[x, y, _]| [0.01 * along(x, y), -0.02 * along(x, y)]).collect();
    close(answer.displacement(), &exact, largest(&exact), 1e-11);
}

#[test]
fn loads_on_supported_boundaries_are_warned_of() {
    let scene = json!({
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [3]}, "y": {"points": [0, 2], "divisions": [4]}}},
        "material": {"young": 100, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "loads": [
            {"moment": {"boundary": "bottom", "value": [1]}}, {"force": {"boundary": "bottom", "value": [1, 2]}},
            {"force": {"boundary": "top", "value": [1, 2]}}, {"force": {"at": [1, 2], "value": [1, 2]}},
            {"pressure": {"boundary": "left", "value": 1, "profile": {"along": [0, 1], "places": [3, 4], "factors": [0, 1]}}}
        ]
    });
    let codes: Vec<&str> = built(&scene).warnings().iter().map(|warning| warning.code).collect();
    assert_eq!(codes, ["load-on-support", "load-on-support", "point-load"]);
}

#[test]
fn invalid_loads_are_refused_at_their_path() {
    let plane = |load: Value| {
        json!({
            "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [2]}, "y": {"points": [0, 1], "divisions": [2]}}},
            "material": {"young": 100, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "loads": [load]
        })
    };
    let model = |name: &str, load: Value| {
        let mut scene = plane(load);
        scene["model"] = json!(name);
        match name {
            "axisymmetric" => scene["supports"] = json!([{"on": {"boundary": "bottom"}, "y": 0}]),
            "bar" => {
                scene["body"] = json!({"bar": {"x": {"points": [0, 1], "divisions": [2]}, "area": 1}});
                scene["supports"] = json!([{"on": {"boundary": "left"}, "x": 0}]);
            }
            _ => {
                let axis = json!({"points": [0, 1], "divisions": [1]});
                scene["body"] = json!({"box": {"x": axis, "y": axis, "z": axis}});
            }
        }
        scene
    };
    let pressure = |profile: Value| plane(json!({"pressure": {"boundary": "top", "value": 1, "profile": profile}}));
    let cases = [
        (
            plane(json!({"force": {"boundary": "roof", "value": [1, 0]}})),
            "loads[0].force.boundary",
            "no boundary `roof`",
        ),
        (plane(json!({"force": {"boundary": "top", "value": [1]}})), "loads[0].force.value", "[x, y]"),
        (plane(json!({"force": {"value": [1, 0]}})), "loads[0].force", "acts nowhere"),
        (
            plane(json!({"force": {"at": [1, 1], "boundary": "top", "value": [1, 0]}})),
            "loads[0].force",
            "give only one",
        ),
        (
            plane(json!({"moment": {"boundary": "roof", "value": [1]}})),
            "loads[0].moment.boundary",
            "no boundary `roof`",
        ),
        (plane(json!({"moment": {"boundary": "top", "value": [0, 0, 1]}})), "loads[0].moment.value", "it has 1: [m]"),
        (
            plane(json!({"moment": {"at": [1, 1], "value": [1]}})),
            "loads[0].moment.at",
            "has no rotation and carries no moment",
        ),
        (plane(json!({"moment": {"value": [1]}})), "loads[0].moment", "acts nowhere; give a `boundary`"),
        (
            model("space", json!({"moment": {"boundary": "top", "value": [1]}})),
            "loads[0].moment.value",
            "[m_x, m_y, m_z]",
        ),
        (model("bar", json!({"moment": {"boundary": "right", "value": [1]}})), "loads[0].moment", "carries no moment"),
        (model("axisymmetric", json!({"moment": {"boundary": "top", "value": [1]}})), "loads[0].moment", "no rotation"),
        (
            model("axisymmetric", json!({"force": {"boundary": "left", "value": [0, 1]}})),
            "loads[0].force.boundary",
            "no area",
        ),
        (plane(json!({"gravity": [0, -9.81]})), "material", "loads[0].gravity needs a `density`"),
        (plane(json!({"gravity": [-9.81]})), "loads[0].gravity", "1 entry"),
        (plane(json!({"centrifugal": {"omega": 1}})), "material", "loads[0].centrifugal needs a `density`"),
        (plane(json!({"centrifugal": {"omega": 1, "axis": [0, 0, 1]}})), "loads[0].centrifugal.axis", "leave it out"),
        (plane(json!({"centrifugal": {"omega": 1, "point": [0]}})), "loads[0].centrifugal.point", "[x, y]"),
        (model("space", json!({"centrifugal": {"omega": 1}})), "loads[0].centrifugal", "needs an `axis`"),
        (model("space", json!({"centrifugal": {"omega": 1, "axis": [0, 0, 0]}})), "loads[0].centrifugal.axis", "zero"),
        (
            model("axisymmetric", json!({"centrifugal": {"omega": 1, "point": [0, 0]}})),
            "loads[0].centrifugal.point",
            "leave the point out",
        ),
        (
            pressure(json!({"along": [0, 1], "places": [0, 2, 2], "factors": [1, 2, 3]})),
            "loads[0].pressure.profile.places[2]",
            "places must increase",
        ),
        (
            pressure(json!({"along": [0, 1], "places": [0, 2], "factors": [1]})),
            "loads[0].pressure.profile",
            "2 places and 1 factors",
        ),
        (pressure(json!({"along": [0, 1], "places": [], "factors": []})), "loads[0].pressure.profile", "at least one"),
        (pressure(json!({"along": [0, 0], "places": [0], "factors": [1]})), "loads[0].pressure.profile.along", "zero"),
    ];
    for (scene, path, phrase) in cases {
        let error = Scene::from_json(&scene.to_string(), "scene").unwrap().build().unwrap_err();
        let Error::Scene { path: found, message } = &error else { panic!("{path}: {error}") };
        assert_eq!(found, path, "{error}");
        assert!(message.contains(phrase) && !message.contains('\n'), "{error}\n  lacks: {phrase}");
    }
}

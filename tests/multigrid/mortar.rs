//! GOAL: multigrid solves bodies with meshes that do not match in few cycles, whichever is the stiffer, with the closed
//! rows of the direct method.
//!
//! CONDITIONS: two blocks with faces that do not match, pressed together so that they part at one side; the upper one
//! with the finer or the coarser mesh, as wide as the lower one or wider; rows on the softer or on the stiffer body;
//! beside rigid and pressed obstacles; one block on two; towers of blocks that contact alone holds.

use serde_json::{Value, json};
use signorini::qp::Estimate;
use signorini::{Method, Settings, Solution, solve};

use support::scenes::built;

/// Largest number of cycles of an answer with rows on the softer body, for every ratio of the stiffnesses. Measured 15.
const MOST_CYCLES: usize = 20;

/// Cycles of an answer with rows on a body that is ten times stiffer than the other. Measured 24.
const MOST_CYCLES_OF_STIFF: usize = 32;

/// Lines from `from` to `to` with a number of cells between them.
fn lines(from: f64, to: f64, cells: usize) -> Value {
    json!({"points": [from, to], "divisions": [cells]})
}

fn block(x: Value, y: Value, z: Value) -> Value {
    json!({"box": {"x": x, "y": y, "z": z, "element": "hex8"}})
}

/// A slab on a block, `cells` along each side of both; the slab is as wide as `width`, the block 1. The left end of the
/// slab is pushed down by 0.01 while its right end is lifted by as much.
fn stacked(cells: [usize; 2], width: f64, young: [f64; 2], side: &str) -> Value {
    let [n, m] = cells;
    let slab = block(lines(0.5 - width / 2.0, 0.5 + width / 2.0, n), lines(0.0, 1.0, n), lines(1.0, 1.5, n / 2));
    let base = block(lines(0.0, 1.0, m), lines(0.0, 1.0, m), lines(0.0, 1.0, m));
    json!({
        "model": "space",
        "body": slab,
        "material": {"young": young[0], "poisson": 0.3},
        "further-bodies": [{"name": "base", "body": base, "material": {"young": young[1], "poisson": 0.3}}],
        "supports": [
            {"on": {"boundary": "left"}, "x": 0, "y": 0, "z": -0.01},
            {"on": {"boundary": "right"}, "x": 0, "y": 0, "z": 0.01},
            {"on": {"boundary": "base.bottom"}, "x": 0, "y": 0, "z": 0}
        ],
        "obstacles": [{"boundary": "bottom", "approach": "-z",
                       "shape": {"body": {"boundary": "base.top", "rows": "mortar", "side": side}}}]
    })
}

/// The answer by multigrid, which is that of the direct method.
#[track_caller]
fn answer(scene: &Value, what: &str) -> Solution {
    let model = built(scene);
    let direct = solve(model.problem(), &Settings::with_method(Method::ActiveSet)).unwrap();
    let found = solve(model.problem(), &Settings::with_method(Method::Mprgp)).unwrap_or_else(|e| panic!("{what}: {e}"));
    let (closed, rows) = (direct.contact_set.count(), direct.contact_set.rows());
    println!("{what}: {} dofs, {} cycles, {closed} of {rows} closed", model.problem().dofs(), found.iterations);
    assert!(found.certificate.meets(1e-9) && found.method == "mprgp", "{what}: {}", found.method);
    assert_eq!(found.contact_set, direct.contact_set, "{what}");
    assert!((1..rows).contains(&closed), "{what}: {closed} of {rows} closed");
    found
}

#[test]
fn meshes_that_do_not_match_need_few_cycles_at_any_ratio_of_stiffness() {
    let moduli = [[1.0, 1.0], [10.0, 1.0], [1.0, 10.0], [1000.0, 1.0], [1.0, 1000.0]];
    let meshes = [([8, 12], 1.0), ([12, 8], 1.0), ([8, 12], 1.7), ([12, 8], 1.7)];
    let pairs = moduli.into_iter().flat_map(|young| meshes.map(|mesh| (young, mesh)));
    // Every third pair has every ratio and every mesh.
    for (young, (cells, width)) in pairs.step_by(support::cases(3, 1)) {
        let what = format!("{cells:?}, {width} wide, {young:?}");
        let found = answer(&stacked(cells, width, young, "auto"), &what);
        assert!(found.iterations <= MOST_CYCLES, "{what}: {} cycles", found.iterations);
    }
}

#[test]
fn rows_on_the_stiffer_body_take_more_cycles_and_give_the_same_rows() {
    for (cells, young, side) in [([8, 12], [10.0, 1.0], "this"), ([12, 8], [1.0, 10.0], "other")] {
        let found = answer(&stacked(cells, 1.0, young, side), side);
        assert!(found.iterations <= MOST_CYCLES_OF_STIFF, "{side}: {} cycles", found.iterations);
    }
}

/// The nodes at the right edge of the slab have rows of all three obstacles; a sphere under a force has a travel.
#[test]
fn rigid_and_pressed_obstacles_may_stand_beside_another_body() {
    let mut scene = stacked([6, 8], 1.0, [1.0, 3.0], "auto");
    scene["supports"] = json!([
        {"on": {"boundary": "left"}, "x": 0.005, "y": 0}, {"on": {"boundary": "base.bottom"}, "x": 0, "y": 0, "z": 0},
        {"on": {"boundary": "front"}, "z": 0.002}
    ]);
    let obstacles = scene["obstacles"].as_array_mut().unwrap();
    for normal in [[1.0, 0.0, 0.0], [0.8, 0.0, -0.6]] {
        let plane = json!({"plane": {"point": [1.001, 0.5, 1], "normal": normal}});
        obstacles.push(json!({"boundary": "right", "approach": "+x", "shape": plane}));
    }
    answer(&scene, "rigid planes");
    scene["obstacles"].as_array_mut().unwrap().push(json!({"boundary": "top", "approach": "+z", "force": 0.01,
        "shape": {"sphere": {"apex": [0.5, 0.5, 1.5], "radius": 1}}}));
    answer(&scene, "a pressed sphere");
}

/// Nodes over the joint of two bases have a row of each, with one normal.
#[test]
fn a_block_may_stand_on_the_joint_of_two() {
    let mut scene = stacked([7, 4], 1.0, [1.0, 10.0], "auto");
    let base = |name: &str, from: f64, to: f64, cells: usize| {
        let body = block(lines(from, to, cells), lines(0.0, 1.0, 5), lines(0.0, 1.0, 4));
        json!({"name": name, "body": body, "material": {"young": 10, "poisson": 0.3}})
    };
    scene["further-bodies"] = json!([base("base", 0.0, 0.5, 2), base("other", 0.5, 1.0, 3)]);
    scene["supports"] = json!([
        {"on": {"boundary": "top"}, "x": 0, "y": 0, "z": -0.01},
        {"on": {"boundary": "base.bottom"}, "x": 0, "y": 0, "z": 0},
        {"on": {"boundary": "other.bottom"}, "x": 0, "y": 0, "z": -0.012}
    ]);
    scene["obstacles"].as_array_mut().unwrap().push(json!({"boundary": "bottom", "approach": "-z",
        "shape": {"body": {"boundary": "other.top", "rows": "mortar", "side": "auto"}}}));
    answer(&scene, "two bases");
}

#[test]
fn multigrid_is_chosen_where_it_is_the_faster_way() {
    let prefers = |cells| {
        Estimate::of(built(&stacked(cells, 1.0, [1.0, 10.0], "auto")).problem()).prefers_multigrid(f64::INFINITY)
    };
    assert!(prefers([14, 20]) && prefers([20, 14]));
    assert!(!prefers([2, 3]));
}

/// A tower of blocks in the plane: the lowest is held, contact and a roller hold each of the others.
fn tower(blocks: usize, cells: usize) -> Value {
    let of = |i: usize, boundary: &str| if i == 0 { boundary.to_string() } else { format!("b{i}.{boundary}") };
    let body =
        |i: usize| json!({"rectangle": {"x": lines(0.0, 1.0, cells), "y": lines(i as f64, i as f64 + 1.0, cells)}});
    let material = json!({"young": 1e6, "poisson": 0.3});
    let further = |i: usize| json!({"name": format!("b{i}"), "material": material, "body": body(i)});
    let roller = |i: usize| json!({"on": {"boundary": of(i, "left")}, "x": 0});
    let joint = |i: usize| {
        let below = json!({"body": {"boundary": of(i, "bottom")}});
        json!({"boundary": of(i - 1, "top"), "approach": "+y", "shape": below})
    };
    let mut supports = vec![json!({"on": {"boundary": "bottom"}, "y": 0})];
    supports.extend((0..blocks).map(roller));
    json!({
        "model": "plane-strain",
        "body": body(0),
        "material": material,
        "further-bodies": (1..blocks).map(further).collect::<Vec<_>>(),
        "supports": supports,
        "obstacles": (1..blocks).map(joint).collect::<Vec<_>>(),
        "loads": [{"pressure": {"boundary": of(blocks - 1, "top"), "value": 1000}}],
        "gap": 0
    })
}

/// Springs hold the blocks in the bound of the error, and no level of the hierarchy has them: the cycles that the bound
/// takes grow with the number of blocks.
#[test]
fn cycles_are_not_chosen_for_a_tower_of_so_many_blocks_that_they_do_not_bound_its_error() {
    let [few, many] = [12, 40].map(|blocks| built(&tower(blocks, 14)));
    let [of_few, of_many] = [&few, &many].map(|model| Estimate::of(model.problem()).prefers_multigrid(f64::INFINITY));
    assert!(of_few && !of_many);
    let found = solve(few.problem(), &Settings::with_method(Method::Mprgp)).unwrap();
    assert!(found.certificate.meets(1e-9), "{:?}", found.certificate);
}

//! GOAL: the number of cycles does not depend on how much stiffer one body is than the other that it touches.
//!
//! CONDITIONS: two blocks with faces that match, pressed together so that they part at one side; the upper one as
//! stiff, stiffer, softer.

use serde_json::{Value, json};
use signorini::{Method, Settings, solve};

use support::scenes::built;

/// Largest number of cycles of an answer with faces that match, for every ratio of the stiffnesses. Measured 11.
const MOST_CYCLES: usize = 16;

/// A slab on a block, `n` cells along each side; its left end is pushed down by 0.01 while its right end is lifted by
/// as much.
fn stacked(n: usize, young: [f64; 2]) -> Value {
    let side = || json!({"points": [0, 1], "divisions": [n]});
    let body = |z: Value| json!({"box": {"x": side(), "y": side(), "z": z, "element": "hex8"}});
    json!({
        "model": "space",
        "body": body(json!({"points": [1, 1.5], "divisions": [n / 2]})),
        "material": {"young": young[0], "poisson": 0.3},
        "further-bodies": [{"name": "base", "body": body(side()), "material": {"young": young[1], "poisson": 0.3}}],
        "supports": [
            {"on": {"boundary": "left"}, "x": 0, "y": 0, "z": -0.01},
            {"on": {"boundary": "right"}, "x": 0, "y": 0, "z": 0.01},
            {"on": {"boundary": "base.bottom"}, "x": 0, "y": 0, "z": 0}
        ],
        "obstacles": [{"boundary": "bottom", "approach": "-z", "shape": {"body": {"boundary": "base.top"}}}]
    })
}

#[test]
fn bodies_of_any_ratio_of_stiffness_need_the_same_few_cycles() {
    for young in [[1.0, 1.0], [10.0, 1.0], [1.0, 10.0], [1000.0, 1.0], [1.0, 1000.0], [1.0, 1e6]] {
        let model = built(&stacked(8, young));
        let direct = solve(model.problem(), &Settings::with_method(Method::ActiveSet)).unwrap();
        let found = solve(model.problem(), &Settings::with_method(Method::Mprgp)).unwrap();
        println!(
            "{young:?}: {} cycles, {} of {} closed",
            found.iterations,
            direct.contact_set.count(),
            direct.contact_set.rows()
        );
        assert!(found.certificate.meets(1e-9) && found.method == "mprgp", "{young:?}: {}", found.method);
        assert_eq!(found.contact_set, direct.contact_set, "{young:?}");
        assert!((9..81).contains(&found.contact_set.count()), "{young:?}: {}", found.contact_set.count());
        assert!(found.iterations <= MOST_CYCLES, "{young:?}: {} cycles", found.iterations);
    }
}

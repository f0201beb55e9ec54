//! The area of a contact whose carrying surface goes on beyond the other body.

use serde_json::json;
use support::cases;
use support::draws::Draws;
use support::scenes::answer;

/// The estimated area of a fully closed contact differs from that of the covered facets by rounding and by facets
/// that are covered by less than a tenth.
const COVERED: f64 = 1e-2;

/// GOAL: the area of a contact where the surface that carries the rows goes on beyond the other body.
/// CONDITIONS: a block of random size and place is moved into a plate, in the plane and in space; the plate carries the
/// rows, and the meshes do not match.
/// REFERENCE: the base of the block.
#[test]
fn a_contact_is_as_large_as_what_covers_it() {
    for seed in 0..cases(8, 50) {
        let mut draws = Draws(seed);
        let mut between = |low: f64, high: f64| low + (high - low) * 0.5 * (1.0 + draws.signed());
        let is_plane = seed % 2 == 0;
        let element = [["hex8", "tet4"], ["q4", "t6"]][usize::from(is_plane)][seed as usize / 2 % 2];
        let names = if is_plane { ["x", "y", "y"] } else { ["x", "y", "z"] };
        let up = names[2];
        let [width, depth] = [between(0.8, 2.0), between(0.7, 1.5)];
        let [left, front] = [between(0.4, 1.6), between(0.4, 1.2)];
        let cells = |from: f64, to: f64, count: f64| json!({"points": [from, to], "divisions": [count as usize]});
        let mut body = |of: [[f64; 2]; 3], counts: [f64; 2]| {
            let [x, y, z] = of;
            let x = cells(x[0], x[1], between(counts[0], counts[1]));
            match is_plane {
                true => json!({"rectangle": {"x": x, "y": cells(z[0], z[1], 2.0), "element": element}}),
                false => json!({"box": {"x": x, "y": cells(y[0], y[1], between(counts[0], counts[1])),
                                        "z": cells(z[0], z[1], 2.0), "element": element}}),
            }
        };
        let plate = body([[0.0, 4.0], [0.0, 3.0], [0.0, 1.0]], [9.0, 13.0]);
        let block = body([[left, left + width], [front, front + depth], [1.0, 1.5]], [4.0, 7.0]);
        let held = |of: &str, by: f64| {
            let mut support = json!({"on": {"boundary": of}});
            names.iter().for_each(|&axis| support[axis] = json!(if axis == up { by } else { 0.0 }));
            support
        };
        let found = answer(&json!({
            "model": if is_plane { "plane-stress" } else { "space" },
            "body": plate, "material": {"young": 1.0, "poisson": 0.3},
            "further-bodies": [{"name": "block", "body": block, "material": {"young": 1.0, "poisson": 0.3}}],
            "supports": [held("bottom", 0.0), held("block.top", -0.01)],
            "obstacles": [{"boundary": "top", "approach": format!("+{up}"),
                           "shape": {"body": {"boundary": "block.bottom", "rows": "mortar", "side": "this"}}}]
        }));
        let exact = width * if is_plane { 1.0 } else { depth };
        let (area, off) = found.segments().iter().fold((0.0, 0.0), |sum: (f64, f64), segment| {
            (sum.0 + segment.extent.area, sum.1 + segment.extent.area_uncertainty)
        });
        let error = (area - exact).abs();
        assert!(error <= COVERED * exact && error <= off + 1e-9 * exact, "{seed}: {area} +- {off}, exact {exact}");
    }
}

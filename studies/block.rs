//! The body of most measurements: a block under a round obstacle.

use serde_json::{Value, json};

/// An axis from 0 to `length` with cells of equal size.
pub fn axis(length: f64, cells: usize) -> Value {
    json!({"points": [0, length], "divisions": [cells]})
}

/// A block, in space if it has three lengths, that is clamped at its bottom. A parabola or a sphere of this radius is
/// pressed into the centre of its top; a negative gap is the depth.
pub fn block<const N: usize>(lengths: [f64; N], cells: [usize; N], element: &str, radius: f64, gap: f64) -> Value {
    let (model, body, shape, up) = match N {
        3 => ("space", "box", "sphere", "+z"),
        _ => ("plane-strain", "rectangle", "parabola", "+y"),
    };
    let mut sides = json!({"element": element});
    let mut support = json!({"on": {"boundary": "bottom"}});
    let mut apex = lengths.map(|length| length / 2.0).to_vec();
    apex[N - 1] = lengths[N - 1];
    for (i, name) in ["x", "y", "z"].into_iter().enumerate().take(N) {
        (sides[name], support[name]) = (axis(lengths[i], cells[i]), json!(0));
    }
    json!({
        "model": model,
        "body": {body: sides},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [support],
        "obstacles": [{"boundary": "top", "approach": up, "shape": {shape: {"apex": apex, "radius": radius}}}],
        "gap": gap,
    })
}

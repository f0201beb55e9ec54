//! Quadratic functions on a triangle by their six Bernstein coefficients, in the order of
//! `l0^2, l1^2, l2^2, 2 l0 l1, 2 l0 l2, 2 l1 l2` with the barycentric coordinates l. The coefficient of a pair of
//! corners is the polar form of the function there.

/// The pairs of corners of the six coefficients.
pub(super) const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];

/// A function on a triangle of which nothing is known: its largest distances `[below, above]` from zero are infinite.
pub(super) const NOT_ENCLOSED: ([f64; 6], [f64; 2]) = ([0.0; 6], [f64::INFINITY; 2]);

/// The coefficients of the linear function with these values at the corners.
pub(super) fn linear(values: [f64; 3]) -> [f64; 6] {
    PAIRS.map(|[i, j]| (values[i] + values[j]) / 2.0)
}

/// The least and the largest of the values at the corners.
pub(super) fn extent([a, b, c]: [f64; 3]) -> [f64; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// The distance of the origin from a triangle in the plane, corners `[x, y]` in any order; zero inside.
pub(super) fn distance_of_origin(corners: [[f64; 2]; 3]) -> f64 {
    let edges = [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|corner| corners[corner]));
    let turns = edges.map(|[[ax, ay], [bx, by]]| ax * by - ay * bx);
    if turns.iter().all(|&turn| turn > 0.0) || turns.iter().all(|&turn| turn < 0.0) {
        return 0.0;
    }
    let distance = |[[ax, ay], [bx, by]]: [[f64; 2]; 2]| {
        let [x, y] = [bx - ax, by - ay];
        let square = x * x + y * y;
        let share = if square > 0.0 { (-(ax * x + ay * y) / square).clamp(0.0, 1.0) } else { 0.0 };
        (ax + share * x).hypot(ay + share * y)
    };
    edges.into_iter().map(distance).fold(f64::INFINITY, f64::min)
}

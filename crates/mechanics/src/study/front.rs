//! The Pareto front of points with two costs.

/// Returns for each point whether it is on the front: no other point is as small in both of its costs, and smaller in
/// one.
pub(super) fn on_front(points: &[[f64; 2]]) -> Vec<bool> {
    let beats = |a: &[f64; 2], b: &[f64; 2]| a[0] <= b[0] && a[1] <= b[1] && a != b;
    points.iter().map(|point| !points.iter().any(|other| beats(other, point))).collect()
}

#[cfg(test)]
mod tests {
    use super::on_front;

    #[test]
    fn a_point_is_on_the_front_unless_another_is_as_small_in_both_costs_and_smaller_in_one() {
        let points = [[1.0, 4.0], [2.0, 4.0], [2.0, 3.0], [2.0, 3.0], [3.0, 3.5], [4.0, 1.0]];
        assert_eq!(on_front(&points), [true, false, true, true, false, true]);
    }
}

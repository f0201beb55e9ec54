//! The oracle of enclosed gaps: the rows by rule `approach` at points of a triangle.

use super::patch::PAIRS;
use super::surface::Surface;
use crate::fem::geometry::midpoint;

/// Rounding of gaps and places of order one, with slopes of some hundreds near a rim.
pub(super) const ROUNDING: f64 = 1e-11;

/// Points of a triangle at which a gap is compared, in addition to its corners.
const POINTS: usize = 60;

/// Reproducible numbers.
pub(super) struct Random(pub u64);

impl Random {
    /// The next number, equally likely from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        // The multiplier is that of D. E. Knuth's generator MMIX.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn point(&mut self, centre: [f64; 3], size: f64) -> [f64; 3] {
        centre.map(|coordinate| coordinate + self.between(-size, size))
    }
}

/// 400 triangles of the sizes 0.003 to 3, `[t1, t2, towards]` from -3 to 3: anywhere, around the axis, along one of the
/// axes, along the approach direction, and of one place.
pub(super) fn triangles(random: &mut Random) -> Vec<[[f64; 3]; 3]> {
    let triangle = |index: usize| {
        let size = 3.0 * 10.0_f64.powf(random.between(-3.0, 0.0));
        let centre = random.point([0.0; 3], 3.0 - size);
        let mut corners = [0, 1, 2].map(|_| random.point(centre, size));
        match index % 8 {
            0 => {
                let inside = [0, 1, 2].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0);
                corners = corners.map(|[t1, t2, towards]| [t1 - inside[0], t2 - inside[1], towards]);
            }
            1 => corners.iter_mut().for_each(|corner| corner[0] = centre[0]),
            2 => corners.iter_mut().for_each(|corner| corner[1] = centre[1]),
            3 => corners[2] = [corners[0][0], corners[0][1], centre[2]],
            4 => corners = corners.map(|corner| [centre[0], centre[1], corner[2]]),
            5 => corners[0] = [0.0, 0.0, centre[2]],
            _ => {}
        }
        corners
    };
    (0..400).map(triangle).collect()
}

/// Checks the enclosure of the gap over a triangle, moved by `shift`, against the rows at its points, and returns the
/// distances `[below, above]` from the quadratic function; `None` if the surface is out of reach.
pub(super) fn checked(
    surface: &dyn Surface,
    corners: [[f64; 3]; 3],
    shift: f64,
    random: &mut Random,
) -> Option<[f64; 2]> {
    let enclosure = surface.gap_over(corners, shift);
    for point in 0..POINTS + 3 {
        let [a, b] = [random.between(0.0, 1.0), random.between(0.0, 1.0)];
        let [a, b] = if a + b > 1.0 { [1.0 - a, 1.0 - b] } else { [a, b] };
        let shares =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].get(point).copied().unwrap_or([a, b, 1.0 - a - b]);
        let at = [0, 1, 2].map(|axis| (0..3).map(|i| shares[i] * corners[i][axis]).sum());
        let gap = surface.gap(at, shift);
        let Some((coefficients, [below, above])) = enclosure else {
            assert_eq!(gap, None, "{corners:?}: at {at:?} the surface is within reach");
            continue;
        };
        assert!(below.is_finite() && below >= 0.0 && above >= 0.0, "{corners:?}: {below} {above}");
        assert!(gap.is_some() || above == f64::INFINITY, "{corners:?}: at {at:?} the surface is out of reach");
        let term = |(coefficient, [i, j]): (f64, [usize; 2])| {
            coefficient * shares[i] * shares[j] * if i == j { 1.0 } else { 2.0 }
        };
        let quadratic: f64 = coefficients.into_iter().zip(PAIRS).map(term).sum();
        let off = gap.map_or(0.0, |gap| gap - quadratic);
        let (least, most) = (-below - ROUNDING, above + ROUNDING);
        assert!((least..=most).contains(&off), "{corners:?}: at {at:?} {off} is not from {least} to {most}");
    }
    enclosure.map(|(_, off)| off)
}

/// The four triangles between the corners and the middles of the edges.
pub(super) fn quarters(corners: [[f64; 3]; 3]) -> [[[f64; 3]; 3]; 4] {
    let middle = |i: usize, j: usize| midpoint(corners[i], corners[j]);
    let ([a, b, c], [ab, bc, ca]) = (corners, [middle(0, 1), middle(1, 2), middle(2, 0)]);
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

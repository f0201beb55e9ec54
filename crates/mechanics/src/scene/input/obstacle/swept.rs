//! Curves rotated about the approach direction or extruded perpendicular to it. An obstacle in the plane is a curve
//! extruded along z.

use std::fmt::Debug;
use std::sync::Arc;

use super::patch::{PAIRS, distance_of_origin, extent, gap_to};
use super::row::ObstacleRow;
use super::shape::{Geometry, ObstacleSite};
use super::surface::{Axes, Surface, across};
use crate::fem::geometry::{cross, minus};

/// Largest number of pieces of a pictured surface; more cannot be seen.
const MAX_SEGMENTS: usize = 10_000;

/// Coordinates `[along, towards]`: along a curve, and towards the obstacle.
pub(super) type Local = [f64; 2];

/// The connection from a node to a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CurveFoot {
    /// Unit normal at the foot, into the obstacle.
    pub normal: Local,
    /// Signed distance along the normal; negative inside.
    pub distance: f64,
}

/// A curve as a graph over the coordinate along it: the obstacle lies at and above its height.
pub(super) trait Curve: Debug + Send + Sync {
    /// The height towards the obstacle, or `None` beyond the curve's reach.
    fn height(&self, along: f64) -> Option<f64>;

    /// The values of a quadratic function at both ends of a stretch within reach and in its middle, and the largest
    /// distances `[below, above]` of the curve from it, which are zero for a curve that is quadratic itself.
    fn enclosed(&self, from: f64, to: f64) -> Option<([f64; 3], [f64; 2])> {
        Some((self.heights(from, to)?, [0.0; 2]))
    }

    /// For a curve that is symmetric to its axis, between two distances from it within reach, `0 <= near <= far`: the
    /// heights at both of a linear function of the squared distance, and the largest distances `[below, above]` of the
    /// curve from it, which are zero for a curve that is quadratic itself.
    fn enclosed_turned(&self, near: f64, far: f64) -> Option<([f64; 2], [f64; 2])> {
        Some(([self.height(near)?, self.height(far)?], [0.0; 2]))
    }

    /// The foot closest to `node`, or `None` if no part of the curve faces it; lengths below `tolerance` are
    /// rounding.
    ///
    /// For a node behind a vertex or on an axis, equally close to both sides, the direction is along the axis.
    ///
    /// # Errors
    /// A predicate of the node if it lies so deep that no meaningful closest point exists.
    fn closest(&self, node: Local, tolerance: f64) -> Result<Option<CurveFoot>, &'static str>;

    /// The reach, along the curve.
    fn range(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// The heights at both ends and in the middle.
    fn heights(&self, from: f64, to: f64) -> Option<[f64; 3]> {
        Some([self.height(from)?, self.height((from + to) / 2.0)?, self.height(to)?])
    }

    /// The places of the corners of the curve, along it.
    fn corners(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// The surface that a curve forms.
#[derive(Clone, Debug)]
pub(super) struct Swept {
    curve: Arc<dyn Curve>,
    sweep: Sweep,
    axes: Axes,
    /// Extent of the pictured surface along the first axis, from the origin: beyond the body by its size on each side,
    /// so that a wall before a slender body does not end in the picture.
    extent: [f64; 2],
    rounding: f64,
}

/// The movement of a curve.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sweep {
    /// A curve symmetric to its axis, rotated about it: towards = h(hypot(t1, t2)).
    Turned,
    /// Extruded along the second axis: towards = h(t1).
    DrawnOut,
}

impl Sweep {
    /// The obstacle with its apex at a point.
    pub fn place(self, curve: impl Curve + 'static, site: &ObstacleSite, apex: [f64; 3]) -> Geometry {
        Geometry::rigid(site, Swept::new(curve, self, site, apex))
    }
}

impl Swept {
    /// The surface with its origin at a point.
    pub fn new(curve: impl Curve + 'static, sweep: Sweep, site: &ObstacleSite, origin: [f64; 3]) -> Self {
        let (axes, first) = (Axes::new(site.approach, origin), across(site.approach)[0]);
        let ((low, high), margin) = (site.body.mesh().extent(), site.body.mesh().size());
        let extent = [low[first] - margin - origin[first], high[first] + margin - origin[first]];
        Swept { curve: Arc::new(curve), sweep, axes, extent, rounding: site.rounding() }
    }

    /// The same surface extruded along another unit vector perpendicular to the approach direction.
    pub fn along(mut self, axis: [f64; 3]) -> Self {
        let axes = &mut self.axes.axes;
        (axes[1], axes[0]) = (axis, cross(axis, axes[2]));
        self
    }
}

impl Surface for Swept {
    fn gap(&self, node: [f64; 3], shift: f64) -> Option<f64> {
        let [t1, t2, towards] = self.axes.local(node, shift);
        let along = match self.sweep {
            Sweep::Turned => t1.hypot(t2),
            Sweep::DrawnOut => t1,
        };
        Some(self.curve.height(along)? - towards)
    }

    fn closest(&self, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let [t1, t2, towards] = self.axes.local(node, shift);
        let (along, outwards) = match self.sweep {
            Sweep::DrawnOut => (t1, [1.0, 0.0]),
            // The closest point lies in the half plane of the node; on the axis the normal has no component
            // perpendicular to it.
            Sweep::Turned => match t1.hypot(t2) {
                radius if radius > 0.0 => (radius, [t1 / radius, t2 / radius]),
                radius => (radius, [0.0; 2]),
            },
        };
        let Some(CurveFoot { normal: [across, ahead], distance }) =
            self.curve.closest([along, towards], self.rounding)?
        else {
            return Ok(None);
        };
        let normal = self.axes.global([across * outwards[0], across * outwards[1], ahead]);
        Ok(Some(ObstacleRow { normal, gap: distance }))
    }

    fn gap_along(&self, from: [f64; 3], to: [f64; 3], shift: f64) -> Option<([f64; 3], [f64; 2])> {
        let Sweep::DrawnOut = self.sweep else { return None };
        let ([from, _, low], [to, _, high]) = (self.axes.local(from, shift), self.axes.local(to, shift));
        let (heights, off) = reached(self.curve.as_ref(), [from, to], |from, to| self.curve.enclosed(from, to))?;
        Some((minus(heights, [low, (low + high) / 2.0, high]), off))
    }

    fn gap_over(&self, corners: [[f64; 3]; 3], shift: f64) -> Option<([f64; 6], [f64; 2])> {
        let local = corners.map(|corner| self.axes.local(corner, shift));
        let (heights, off) = match self.sweep {
            Sweep::Turned => turned(self.curve.as_ref(), local.map(|[t1, t2, _]| [t1, t2])),
            Sweep::DrawnOut => drawn_out(self.curve.as_ref(), local.map(|[t1, ..]| t1)),
        }?;
        Some((gap_to(heights, local), off))
    }

    fn outline(&self, shift: f64, segments: usize) -> Vec<[f64; 2]> {
        let Sweep::DrawnOut = self.sweep else { return Vec::new() };
        let (reach, [low, high]) = (self.curve.range(), self.extent);
        let (first, last) = (low.max(reach.0), high.min(reach.1));
        if first >= last {
            return Vec::new();
        }
        let segments = segments.clamp(1, MAX_SEGMENTS);
        let sample = |i: usize| if i == segments { last } else { first + (last - first) * i as f64 / segments as f64 };
        let mut along: Vec<f64> = (0..=segments).map(sample).collect();
        along.extend(self.curve.corners().into_iter().filter(|&corner| corner > first && corner < last));
        along.sort_by(f64::total_cmp);
        along.dedup();
        let place = |along: f64| {
            let way = self.axes.global([along, 0.0, self.curve.height(along)? + shift]);
            Some([0, 1].map(|i| self.axes.origin[i] + way[i]))
        };
        along.into_iter().filter_map(place).collect()
    }
}

/// The heights of a curve over a stretch, enclosed by a function of which `enclosed` gives the values at both ends and
/// in the middle, and the distances `[below, above]`. Over a stretch that reaches beyond the curve the function is the
/// lowest height of the curve there, with an infinite distance above; `None` if the stretch lies beyond the curve.
fn reached(
    curve: &dyn Curve,
    [from, to]: [f64; 2],
    enclosed: impl Fn(f64, f64) -> Option<([f64; 3], [f64; 2])>,
) -> Option<([f64; 3], [f64; 2])> {
    let (first, last) = curve.range();
    let [start, end] = [from, to].map(|along| along.clamp(first, last));
    if start == from && end == to {
        return enclosed(from, to);
    }
    if start == end {
        return None;
    }
    let (values, [below, _]) = enclosed(start, end)?;
    let lowest = bernstein(values).into_iter().fold(f64::INFINITY, f64::min) - below;
    Some(([lowest; 3], [0.0, f64::INFINITY]))
}

/// The coefficients, in the basis of Bernstein, of a quadratic function with these values at the start, in the middle
/// and at the end.
fn bernstein([first, middle, last]: [f64; 3]) -> [f64; 3] {
    [first, 2.0 * middle - (first + last) / 2.0, last]
}

/// The heights of an extruded curve over a triangle with its corners at these places along the curve.
fn drawn_out(curve: &dyn Curve, places: [f64; 3]) -> Option<([f64; 6], [f64; 2])> {
    let [from, to] = extent(places);
    let (heights, off) = reached(curve, [from, to], |from, to| curve.enclosed(from, to))?;
    let [first, middle, last] = bernstein(heights);
    let shares = places.map(|place| if to > from { (place - from) / (to - from) } else { 0.0 });
    let polar = |[i, j]: [usize; 2]| {
        let (s, t) = (shares[i], shares[j]);
        (1.0 - s) * (1.0 - t) * first + (s * (1.0 - t) + (1.0 - s) * t) * middle + s * t * last
    };
    Some((PAIRS.map(polar), off))
}

/// The heights of a rotated curve over a triangle with its corners at these places around the axis. The squared
/// distance from the axis is quadratic on the triangle, with the scalar product as its polar form.
fn turned(curve: &dyn Curve, places: [[f64; 2]; 3]) -> Option<([f64; 6], [f64; 2])> {
    let [_, far] = extent(places.map(|[t1, t2]| t1.hypot(t2)));
    let near = distance_of_origin(places).min(far);
    let ([first, _, last], off) = reached(curve, [near, far], |near, far| {
        let ([first, last], off) = curve.enclosed_turned(near, far)?;
        Some(([first, (first + last) / 2.0, last], off))
    })?;
    let polar = |[i, j]: [usize; 2]| {
        let square = places[i][0] * places[j][0] + places[i][1] * places[j][1];
        let share = if far > near { (square - near * near) / ((far - near) * (far + near)) } else { 0.0 };
        first + share * (last - first)
    };
    Some((PAIRS.map(polar), off))
}

#[cfg(test)]
mod tests {
    use super::super::circle::RoundCurve;
    use super::super::oracle::{ROUNDING, Random, checked, quarters, triangles};
    use super::super::polyline::Polyline;
    use super::super::shape::Side;
    use super::*;
    use crate::scene::input::obstacle::polyline::Parabola;
    use crate::scene::input::schema::model::Approach;

    const RADIUS: f64 = 2.0;

    impl Swept {
        /// A surface with the axes and the origin of space.
        pub fn upright(sweep: Sweep, curve: Arc<dyn Curve>) -> Self {
            Swept { curve, sweep, axes: Axes::new(Approach::PlusZ, [0.0; 3]), extent: [0.0; 2], rounding: 0.0 }
        }
    }

    fn round(radius: f64, side: Side) -> Arc<dyn Curve> {
        Arc::new(RoundCurve { radius, side })
    }

    fn parabola() -> Arc<dyn Curve> {
        Arc::new(Parabola { radius: RADIUS })
    }

    fn wedge() -> Arc<dyn Curve> {
        Arc::new(Polyline::wedge(0.7))
    }

    /// A symmetric curve with corners, from -2 to 2.
    fn table() -> Arc<dyn Curve> {
        let half = [[0.0, 0.1], [0.3, -0.2], [0.31, 0.4], [1.2, 0.4], [2.0, 1.5]];
        let mirrored = half.iter().skip(1).rev().map(|&[along, height]| [-along, height]);
        Arc::new(Polyline::table(mirrored.chain(half).collect(), 0.0).unwrap())
    }

    fn surfaces() -> Vec<(&'static str, Swept)> {
        let circle = |side| round(RADIUS, side);
        vec![
            ("sphere", Swept::upright(Sweep::Turned, circle(Side::Outside))),
            ("cup", Swept::upright(Sweep::Turned, circle(Side::Inside))),
            ("paraboloid", Swept::upright(Sweep::Turned, parabola())),
            ("cone", Swept::upright(Sweep::Turned, wedge())),
            ("turned table", Swept::upright(Sweep::Turned, table())),
            ("cylinder", Swept::upright(Sweep::DrawnOut, circle(Side::Outside))),
            ("hole", Swept::upright(Sweep::DrawnOut, circle(Side::Inside))),
            ("parabola", Swept::upright(Sweep::DrawnOut, parabola())),
            ("wedge", Swept::upright(Sweep::DrawnOut, wedge())),
            ("table", Swept::upright(Sweep::DrawnOut, table())),
        ]
    }

    #[test]
    fn the_gap_over_any_triangle_stays_within_its_enclosure() {
        for (name, aligned) in surfaces() {
            let axes = [[0.6, 0.0, 0.8], [0.48, 0.8, -0.36], [-0.64, 0.6, 0.48]];
            let origin = [0.3, -0.2, 0.5];
            let skew = Swept { axes: Axes { origin, axes }, ..aligned.clone() };
            let mut random = Random(1);
            let (mut whole, mut part, mut none) = (0, 0, 0);
            for corners in triangles(&mut random) {
                let shift = random.between(-0.5, 0.5);
                let placed = corners.map(|local| {
                    let along = |i: usize| (0..3).map(|axis| local[axis] * axes[axis][i]).sum::<f64>();
                    [0, 1, 2].map(|i| origin[i] + along(i))
                });
                for (surface, corners) in [(&aligned, corners), (&skew, placed)] {
                    match checked(surface, corners, shift, &mut random) {
                        Some([_, above]) if above.is_finite() => whole += 1,
                        Some(_) => part += 1,
                        None => none += 1,
                    }
                }
            }
            let has_ends = !["paraboloid", "cone", "parabola", "wedge"].contains(&name);
            assert!(whole > 200 && has_ends == (part > 20) && has_ends == (none > 20), "{name}: {whole} {part} {none}");
        }
    }

    #[test]
    fn the_enclosure_over_a_paraboloid_or_an_extruded_parabola_is_exact() {
        for surface in [Swept::upright(Sweep::Turned, parabola()), Swept::upright(Sweep::DrawnOut, parabola())] {
            let mut random = Random(2);
            for corners in triangles(&mut random) {
                assert_eq!(checked(&surface, corners, 0.1, &mut random), Some([0.0; 2]));
            }
        }
    }

    #[test]
    fn the_enclosure_over_a_sphere_follows_its_curvature() {
        for side in [Side::Outside, Side::Inside] {
            let (surface, mut random) = (Swept::upright(Sweep::Turned, round(RADIUS, side)), Random(3));
            let mut compared = 0;
            for corners in (0..5).flat_map(|_| triangles(&mut random)).collect::<Vec<_>>() {
                let places = corners.map(|[t1, t2, _]| [t1, t2]);
                let [_, far] = extent(places.map(|[t1, t2]| t1.hypot(t2)));
                if far < RADIUS / 2.0 {
                    let range = far.powi(2) - distance_of_origin(places).powi(2);
                    let [below, above] = checked(&surface, corners, 0.0, &mut random).unwrap();
                    assert!(below + above <= 2.0 * range.powi(2) / (8.0 * RADIUS.powi(3)), "{side:?} {corners:?}");
                    compared += 1;
                }
            }
            assert!(compared > 300, "{compared}");
        }
    }

    /// The quadratic function is linear in the squared distance of a rotated curve, and quadratic along an extruded
    /// one: the distances have the order 2, and 3.
    #[test]
    fn a_quarter_of_a_small_triangle_has_a_quarter_of_the_distances() {
        for (name, surface) in surfaces() {
            let mut random = Random(4);
            let factor = match name {
                "sphere" | "cup" | "cone" => 4.0,
                "cylinder" | "hole" => 8.0,
                _ => continue,
            };
            for _ in 0..100 {
                let centre = [random.between(0.5, 1.2), random.between(-0.5, 0.5), 0.0];
                let corners = [0, 1, 2].map(|_| centre.map(|coordinate| coordinate + random.between(-0.01, 0.01)));
                let mut size = |corners| {
                    let [below, above] = checked(&surface, corners, 0.0, &mut random).unwrap();
                    below.max(above)
                };
                let (whole, parts) = (size(corners), quarters(corners).map(size));
                let largest = parts.into_iter().fold(0.0, f64::max);
                assert!(largest <= 1.1 * whole / factor && whole < 1e-3, "{name} {corners:?}: {whole} {parts:?}");
            }
        }
    }

    /// Between the distances 0.5 and 1.5 from the axis.
    #[test]
    fn the_distances_of_a_cone_and_a_sphere_are_those_of_the_formulas() {
        let corners = [[0.5, 0.0, 0.2], [1.5, 0.0, 0.1], [1.0, 0.0, 0.4]];
        let mut random = Random(5);
        let mut off = |curve| checked(&Swept::upright(Sweep::Turned, curve), corners, 0.0, &mut random).unwrap();
        let [below, above] = off(wedge());
        // 0.7 (1.5 - 0.5)^2/(4 (1.5 + 0.5))
        assert!(below == 0.0 && (above - 0.0875).abs() < ROUNDING, "{below} {above}");
        let [below, above] = off(round(2.5, Side::Outside));
        // w = 2.449490, 2: (w0 - w1)^2/(4 (w0 + w1))
        assert!(above == 0.0 && (below - 0.011_351_921).abs() < 1e-9, "{below} {above}");
    }
}

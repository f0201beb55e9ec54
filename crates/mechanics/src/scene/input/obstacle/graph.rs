//! Obstacles as graphs over the coordinates perpendicular to the approach direction: in most cases a curve rotated or
//! extruded. An obstacle in the plane is a curve extruded along z.

use std::fmt::Debug;
use std::sync::Arc;

use super::patch::{PAIRS, distance_of_origin, extent, linear};
use super::row::{ObstacleRow, RigidSurface, Surface};
use super::shape::ObstacleSite;
use crate::fem::geometry::{cross, dot, minus};
use crate::scene::input::schema::model::{Approach, Rule};

/// Largest number of pieces of a pictured surface; more cannot be seen.
const MAX_SEGMENTS: usize = 10_000;

/// A surface in its frame.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    /// Orthonormal: two axes perpendicular to the approach direction, and the approach direction.
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
    form: Form,
    /// Extent of the pictured surface along the first axis, from the origin: beyond the body by its size on each side,
    /// so that a wall before a slender body does not end in the picture.
    extent: [f64; 2],
    rounding: f64,
}

/// The construction of the surface.
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// A curve symmetric to its axis, rotated about it: towards = h(hypot(t1, t2)).
    Turned(Arc<dyn Surface>),
    /// A curve extruded along the second axis: towards = h(t1).
    DrawnOut(Arc<dyn Surface>),
    /// A grid: towards = h(t1, t2).
    Grid(Arc<dyn Grid>),
}

/// A surface over a grid of the two coordinates perpendicular to the approach direction.
pub(super) trait Grid: Debug + Send + Sync {
    /// The height at a place, or `None` beyond the rim.
    fn height(&self, at: [f64; 2]) -> Option<f64>;

    /// The heights over a triangle with its corners at these places, as
    /// [`Obstacle::gap_over`](super::row::Obstacle::gap_over) gives the gap.
    fn enclosed(&self, places: [[f64; 2]; 3]) -> Option<([f64; 6], [f64; 2])>;

    /// Unit normal into the obstacle at the closest point, and the distance along it; `None` beyond the rim. Lengths
    /// below `tolerance` are rounding.
    fn closest(&self, node: [f64; 3], tolerance: f64) -> Option<([f64; 3], f64)>;
}

impl Graph {
    /// The surface with its origin at a point.
    pub fn new(site: &ObstacleSite, origin: [f64; 3], form: Form) -> Self {
        let [first, second] = across(site.approach);
        let mut axes = [[0.0; 3]; 3];
        (axes[0][first], axes[1][second], axes[2]) = (1.0, 1.0, site.direction());
        let ((low, high), margin) = (site.body.mesh().extent(), site.body.mesh().size());
        let extent = [low[first] - margin - origin[first], high[first] + margin - origin[first]];
        Graph { axes, origin, form, extent, rounding: site.rounding() }
    }

    /// A point in the frame, with the surface moved by `shift`.
    fn local(&self, point: [f64; 3], shift: f64) -> [f64; 3] {
        let from_origin = minus(point, self.origin);
        let [t1, t2, towards] = self.axes.map(|axis| dot(axis, from_origin));
        [t1, t2, towards - shift]
    }

    /// The same surface extruded along another unit vector perpendicular to the approach direction.
    pub fn along(mut self, axis: [f64; 3]) -> Self {
        self.axes[1] = axis;
        self.axes[0] = cross(axis, self.axes[2]);
        self
    }
}

impl RigidSurface for Graph {
    fn row_by(&self, rule: Rule, node: [f64; 3], shift: f64) -> Result<Option<ObstacleRow>, String> {
        let [t1, t2, towards] = self.local(node, shift);
        let along_approach = |height: Option<f64>| height.map(|height| ([0.0, 0.0, 1.0], height - towards));
        let way = match (&self.form, rule) {
            (Form::Turned(curve), Rule::Approach) => along_approach(curve.height(t1.hypot(t2))),
            (Form::DrawnOut(curve), Rule::Approach) => along_approach(curve.height(t1)),
            (Form::Grid(map), Rule::Approach) => along_approach(map.height([t1, t2])),
            (Form::Turned(curve), Rule::ClosestPoint) => {
                let radius = t1.hypot(t2);
                // The closest point lies in the half plane of the node; on the axis the normal has no component
                // perpendicular to it.
                let outwards = if radius > 0.0 { [t1 / radius, t2 / radius] } else { [0.0; 2] };
                let foot = curve.closest([radius, towards], self.rounding)?;
                foot.map(|foot| {
                    let [across, along] = foot.normal;
                    ([across * outwards[0], across * outwards[1], along], foot.distance)
                })
            }
            (Form::DrawnOut(curve), Rule::ClosestPoint) => {
                let foot = curve.closest([t1, towards], self.rounding)?;
                foot.map(|foot| ([foot.normal[0], 0.0, foot.normal[1]], foot.distance))
            }
            (Form::Grid(map), Rule::ClosestPoint) => map.closest([t1, t2, towards], self.rounding),
        };
        Ok(way.map(|(local, gap)| {
            let normal = [0, 1, 2].map(|i| (0..3).map(|axis| local[axis] * self.axes[axis][i]).sum());
            ObstacleRow { normal, gap }
        }))
    }

    fn gap_along(&self, from: [f64; 3], to: [f64; 3], shift: f64) -> Option<([f64; 3], [f64; 2])> {
        let Form::DrawnOut(curve) = &self.form else { return None };
        let ([from, _, low], [to, _, high]) = (self.local(from, shift), self.local(to, shift));
        let (heights, off) = reached(curve.as_ref(), [from, to], |from, to| curve.enclosed(from, to))?;
        Some((minus(heights, [low, (low + high) / 2.0, high]), off))
    }

    fn gap_over(&self, corners: [[f64; 3]; 3], shift: f64) -> Option<([f64; 6], [f64; 2])> {
        let local = corners.map(|corner| self.local(corner, shift));
        let places = local.map(|[t1, t2, _]| [t1, t2]);
        let (mut gap, off) = match &self.form {
            Form::Turned(curve) => turned(curve.as_ref(), places),
            Form::DrawnOut(curve) => drawn_out(curve.as_ref(), places.map(|[t1, _]| t1)),
            Form::Grid(map) => map.enclosed(places),
        }?;
        let towards = linear(local.map(|[_, _, towards]| towards));
        gap.iter_mut().zip(towards).for_each(|(gap, towards)| *gap -= towards);
        Some((gap, off))
    }

    fn outline(&self, shift: f64, segments: usize) -> Vec<[f64; 2]> {
        let Form::DrawnOut(curve) = &self.form else { return Vec::new() };
        let (reach, [low, high]) = (curve.range(), self.extent);
        let (first, last) = (low.max(reach.0), high.min(reach.1));
        if first >= last {
            return Vec::new();
        }
        let segments = segments.clamp(1, MAX_SEGMENTS);
        let sample = |i: usize| if i == segments { last } else { first + (last - first) * i as f64 / segments as f64 };
        let mut along: Vec<f64> = (0..=segments).map(sample).collect();
        along.extend(curve.corners().into_iter().filter(|&corner| corner > first && corner < last));
        along.sort_by(f64::total_cmp);
        along.dedup();
        let place = |along: f64| {
            let local = [along, 0.0, curve.height(along)? + shift];
            Some([0, 1].map(|i| self.origin[i] + (0..3).map(|axis| local[axis] * self.axes[axis][i]).sum::<f64>()))
        };
        along.into_iter().filter_map(place).collect()
    }
}

/// The heights of a curve over a stretch, enclosed by a function of which `enclosed` gives the values at both ends and
/// in the middle, and the distances `[below, above]`. Over a stretch that reaches beyond the curve the function is the
/// lowest height of the curve there, with an infinite distance above; `None` if the stretch lies beyond the curve.
fn reached(
    curve: &dyn Surface,
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
fn drawn_out(curve: &dyn Surface, places: [f64; 3]) -> Option<([f64; 6], [f64; 2])> {
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
fn turned(curve: &dyn Surface, places: [[f64; 2]; 3]) -> Option<([f64; 6], [f64; 2])> {
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

/// The two axes perpendicular to an approach direction, increasing.
pub(super) fn across(approach: Approach) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][approach.axis().0]
}

#[cfg(test)]
mod tests {
    use super::super::circle::round;
    use super::super::oracle::{ROUNDING, Random, checked, quarters, triangles};
    use super::super::polyline::Polyline;
    use super::super::shape::Side;
    use super::*;
    use crate::fem::geometry::COORDINATES;
    use crate::scene::input::obstacle::polyline::Parabola;

    const RADIUS: f64 = 2.0;

    impl Graph {
        /// A surface with the axes and the origin of space.
        pub fn upright(form: Form) -> Self {
            Graph { axes: COORDINATES, origin: [0.0; 3], form, extent: [0.0; 2], rounding: 0.0 }
        }
    }

    fn parabola() -> Arc<dyn Surface> {
        Arc::new(Parabola { radius: RADIUS })
    }

    fn wedge() -> Arc<dyn Surface> {
        Arc::new(Polyline::wedge(0.7))
    }

    /// A symmetric curve with corners, from -2 to 2.
    fn table() -> Arc<dyn Surface> {
        let half = [[0.0, 0.1], [0.3, -0.2], [0.31, 0.4], [1.2, 0.4], [2.0, 1.5]];
        let mirrored = half.iter().skip(1).rev().map(|&[along, height]| [-along, height]);
        Arc::new(Polyline::table(mirrored.chain(half).collect(), 0.0).unwrap())
    }

    fn forms() -> Vec<(&'static str, Form)> {
        let circle = |side| round(RADIUS, side);
        vec![
            ("sphere", Form::Turned(circle(Side::Outside))),
            ("cup", Form::Turned(circle(Side::Inside))),
            ("paraboloid", Form::Turned(parabola())),
            ("cone", Form::Turned(wedge())),
            ("turned table", Form::Turned(table())),
            ("cylinder", Form::DrawnOut(circle(Side::Outside))),
            ("hole", Form::DrawnOut(circle(Side::Inside))),
            ("parabola", Form::DrawnOut(parabola())),
            ("wedge", Form::DrawnOut(wedge())),
            ("table", Form::DrawnOut(table())),
        ]
    }

    #[test]
    fn the_gap_over_any_triangle_stays_within_its_enclosure() {
        for (name, form) in forms() {
            let aligned = Graph::upright(form);
            let axes = [[0.6, 0.0, 0.8], [0.48, 0.8, -0.36], [-0.64, 0.6, 0.48]];
            let skew = Graph { axes, origin: [0.3, -0.2, 0.5], ..aligned.clone() };
            let mut random = Random(1);
            let (mut whole, mut part, mut none) = (0, 0, 0);
            for corners in triangles(&mut random) {
                let shift = random.between(-0.5, 0.5);
                let placed = corners.map(|local| {
                    let along = |i: usize| (0..3).map(|axis| local[axis] * axes[axis][i]).sum::<f64>();
                    [0, 1, 2].map(|i| skew.origin[i] + along(i))
                });
                for (graph, corners) in [(&aligned, corners), (&skew, placed)] {
                    match checked(graph, corners, shift, &mut random) {
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
        for form in [Form::Turned(parabola()), Form::DrawnOut(parabola())] {
            let (graph, mut random) = (Graph::upright(form), Random(2));
            for corners in triangles(&mut random) {
                assert_eq!(checked(&graph, corners, 0.1, &mut random), Some([0.0; 2]));
            }
        }
    }

    #[test]
    fn the_enclosure_over_a_sphere_follows_its_curvature() {
        for side in [Side::Outside, Side::Inside] {
            let (graph, mut random) = (Graph::upright(Form::Turned(round(RADIUS, side))), Random(3));
            let mut compared = 0;
            for corners in (0..5).flat_map(|_| triangles(&mut random)).collect::<Vec<_>>() {
                let places = corners.map(|[t1, t2, _]| [t1, t2]);
                let [_, far] = extent(places.map(|[t1, t2]| t1.hypot(t2)));
                if far < RADIUS / 2.0 {
                    let range = far.powi(2) - distance_of_origin(places).powi(2);
                    let [below, above] = checked(&graph, corners, 0.0, &mut random).unwrap();
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
        for (name, form) in forms() {
            let (graph, mut random) = (Graph::upright(form), Random(4));
            let factor = match name {
                "sphere" | "cup" | "cone" => 4.0,
                "cylinder" | "hole" => 8.0,
                _ => continue,
            };
            for _ in 0..100 {
                let centre = [random.between(0.5, 1.2), random.between(-0.5, 0.5), 0.0];
                let corners = [0, 1, 2].map(|_| centre.map(|coordinate| coordinate + random.between(-0.01, 0.01)));
                let mut size = |corners| {
                    let [below, above] = checked(&graph, corners, 0.0, &mut random).unwrap();
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
        let mut off = |curve| checked(&Graph::upright(Form::Turned(curve)), corners, 0.0, &mut random).unwrap();
        let [below, above] = off(wedge());
        // 0.7 (1.5 - 0.5)^2/(4 (1.5 + 0.5))
        assert!(below == 0.0 && (above - 0.0875).abs() < ROUNDING, "{below} {above}");
        let [below, above] = off(round(2.5, Side::Outside));
        // w = 2.449490, 2: (w0 - w1)^2/(4 (w0 + w1))
        assert!(above == 0.0 && (below - 0.011_351_921).abs() < 1e-9, "{below} {above}");
    }
}

//! Half discs, rings and half balls: their area or volume, the position of their boundaries, and the quality of their
//! cells.

use signorini_qp as qp;
use std::f64::consts::PI;

use super::{Sides, disc, half_ball, half_disc, ring};
use crate::Error;
use crate::fem::element::{Cell, QuadratureRule, Tabulated};
use crate::fem::{ElementKind, Mesh, Zone};

const PLANE: [ElementKind; 4] = [ElementKind::T3, ElementKind::T6, ElementKind::Q4, ElementKind::Q8];

/// Area or volume, and the smallest ratio of the least to the largest Jacobian determinant within an element, at nodes
/// and quadrature points.
fn measure(mesh: &Mesh) -> (f64, f64) {
    let reference = mesh.kind_of(0).reference();
    let table = Tabulated::new(reference, QuadratureRule::Straight);
    let (mut total, mut worst) = (0.0, f64::INFINITY);
    for element in mesh.elements() {
        let cell = Cell::at(reference, |local| mesh.nodes()[element[local]]);
        let determinant = |derivative| cell.map(derivative).determinant;
        let scale = cell.unit().powi(reference.dimension as i32);
        total += table.points.iter().map(|point| point.weight * determinant(&point.derivative) * scale).sum::<f64>();
        let all: Vec<f64> =
            table.nodes.iter().chain(&table.points).map(|point| determinant(&point.derivative)).collect();
        let largest = all.iter().copied().fold(0.0, f64::max);
        worst = all.iter().fold(worst, |worst: f64, value| worst.min(value / largest));
    }
    (total, worst)
}

/// The largest absolute value of `off` over the nodes of a boundary.
fn farthest(mesh: &Mesh, name: &str, off: impl Fn([f64; 3]) -> f64) -> f64 {
    let boundary = mesh.boundary(name).unwrap_or_else(|| panic!("the mesh has no boundary {name}"));
    boundary.nodes().iter().map(|&node| off(mesh.nodes()[node]).abs()).fold(0.0, f64::max)
}

/// Checks meshes of refinements that double from 1 on: the ratio of Jacobian determinants in their elements, the order
/// at which their area or volume converges, and the last error of it.
fn converges(mesh: impl Fn(usize) -> Mesh, count: u32, exact: f64, [quality, order, last]: [f64; 3], name: &str) {
    let error = |refinement: u32| {
        let (total, worst) = measure(&mesh(1 << refinement));
        assert!(worst > quality, "{name}: Jacobian ratio {worst}");
        (total - exact).abs()
    };
    let errors: Vec<f64> = (0..count).map(error).collect();
    let [.., before, found] = errors[..] else { panic!("{name}: two refinements have an order") };
    assert!((before / found).log2() > order && found < last, "{name}: {errors:?}");
}

/// A zone that is as wide on every mesh.
fn refined(width: f64, divisions: usize, refinement: usize) -> Zone {
    Zone { width, divisions: divisions * refinement, growth: 1.6_f64.powf(1.0 / refinement as f64) }
}

#[test]
fn a_disc_consists_of_two_half_discs_joined_along_the_cut() {
    let (centre, radius, zone) = ([3.0, -1.0], 2.0, Zone { width: 0.3, divisions: 3, growth: 1.5 });
    for kind in PLANE {
        for sides in [Sides::Both, Sides::Beyond] {
            let half = half_disc(centre, radius, &zone, sides, kind).unwrap();
            let whole = disc(centre, radius, &zone, sides, kind).unwrap();
            let ((area, worst), (of_half, of_worst)) = (measure(&whole), measure(&half));
            assert!((area / of_half - 2.0).abs() < 1e-14 && (worst / of_worst - 1.0).abs() < 1e-12, "{kind:?}");
            let shared = half.boundary("cut").unwrap().nodes().len();
            assert_eq!(whole.nodes().len(), 2 * half.nodes().len() - shared);
            let on_circle = |at: [f64; 3]| (at[0] - centre[0]).hypot(at[1] - centre[1]) - radius;
            for (name, side) in [("lower", -1.0), ("upper", 1.0)] {
                assert!(farthest(&whole, name, on_circle) < 1e-14);
                assert!(farthest(&whole, name, |at| (side * (at[1] - centre[1])).min(0.0)) < 1e-14, "{kind:?}: {name}");
            }
            match sides {
                Sides::Beyond => assert!(farthest(&whole, "symmetry-x", |at| at[0] - centre[0]) < 1e-14),
                Sides::Both => assert!(whole.boundary("symmetry-x").is_none() && whole.boundary("cut").is_none()),
            }
        }
    }
}

#[test]
fn half_discs_have_good_cells_and_their_area_converges() {
    for kind in PLANE {
        let expected = if kind.is_quadratic() { [0.2, 3.5, 1e-6] } else { [0.2, 1.8, 1e-2] };
        for (sides, exact) in [(Sides::Beyond, PI), (Sides::Both, 2.0 * PI)] {
            let mesh = |times| half_disc([3.0, -1.0], 2.0, &refined(0.3, 3, times), sides, kind).unwrap();
            converges(mesh, 3, exact, expected, kind.name());
        }
    }
}

#[test]
fn nodes_on_the_boundaries_of_half_discs_are_on_arc_and_cut() {
    let zone = Zone { width: 0.05, divisions: 5, growth: 1.3 };
    for kind in PLANE {
        let mesh = half_disc([3.0, -1.0], 2.0, &zone, Sides::Both, kind).unwrap();
        assert!(farthest(&mesh, "arc", |[x, y, _]| (x - 3.0).hypot(y + 1.0) - 2.0) < 1e-15 * 8.0);
        assert_eq!(farthest(&mesh, "cut", |[_, y, _]| y + 1.0), 0.0);
        assert_eq!(mesh.boundaries().len(), 2);
        let half = half_disc([3.0, -1.0], 2.0, &zone, Sides::Beyond, kind).unwrap();
        assert_eq!(farthest(&half, "symmetry-x", |[x, ..]| x - 3.0), 0.0);
        assert!(half.nodes().iter().all(|at| at[0] >= 3.0));
        assert_eq!(
            mesh.nearest_node([3.0, -3.0, 0.0]).map(|found| found.1),
            Some(0.0),
            "there is a node at the lowest point"
        );
        // The arc runs from one end of the cut through the lowest point to the other end; each node is a neighbour of
        // the one before.
        let arc = mesh.boundary("arc").unwrap().nodes();
        let places: Vec<[f64; 3]> = arc.iter().map(|&node| mesh.nodes()[node]).collect();
        assert!(places.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{kind:?}");
        assert_eq!((places[0], places[places.len() - 1]), ([1.0, -1.0, 0.0], [5.0, -1.0, 0.0]));
    }
}

#[test]
fn cells_have_one_size_in_the_zone_and_grow_beyond() {
    let zone = Zone { width: 0.1, divisions: 10, growth: 1.2 };
    let mesh = half_disc([0.0, 1.0], 1.0, &zone, Sides::Beyond, ElementKind::Q4).unwrap();
    let angle = |&node: &usize| {
        let [x, y, _] = mesh.nodes()[node];
        x.atan2(1.0 - y)
    };
    let angles: Vec<f64> = mesh.boundary("arc").unwrap().nodes().iter().map(angle).collect();
    let sizes: Vec<f64> = angles.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(sizes[..10].iter().all(|size| (size - 0.01).abs() < 1e-12), "{sizes:?}");
    assert!(sizes[10..].windows(2).all(|pair| pair[1] < 1.2 * pair[0] + 1e-12), "{sizes:?}");
    assert!(sizes.len() < 50 && mesh.nodes().len() < 3000, "{}", mesh.nodes().len());
}

#[test]
fn half_balls_have_good_cells_and_their_volume_converges() {
    let (both, beyond) = (Sides::Both, Sides::Beyond);
    for (sides, part) in [([both; 2], 0.5), ([beyond, both], 0.25), ([both, beyond], 0.25), ([beyond; 2], 0.125)] {
        let exact = part * 4.0 / 3.0 * PI * 8.0;
        let mesh = |times| half_ball([1.0, 2.0, 3.0], 2.0, &refined(0.6, 2, times), sides).unwrap();
        converges(mesh, 2, exact, [0.1, 1.7, 0.01 * exact], &format!("{sides:?}"));
    }
}

#[test]
fn nodes_on_the_boundaries_of_half_balls_are_on_sphere_and_planes() {
    let zone = Zone { width: 0.2, divisions: 2, growth: 2.0 };
    let mesh = half_ball([1.0, 2.0, 3.0], 2.0, &zone, [Sides::Beyond; 2]).unwrap();
    let radius = |[x, y, z]: [f64; 3]| (x - 1.0).hypot(y - 2.0).hypot(z - 3.0) - 2.0;
    assert!(farthest(&mesh, "round", radius) < 1e-14);
    assert_eq!(farthest(&mesh, "cut", |[.., z]| z - 3.0), 0.0);
    assert_eq!(farthest(&mesh, "symmetry-x", |[x, ..]| x - 1.0), 0.0);
    assert_eq!(farthest(&mesh, "symmetry-y", |[_, y, _]| y - 2.0), 0.0);
    assert_eq!(
        mesh.nearest_node([1.0, 2.0, 1.0]).map(|found| found.1),
        Some(0.0),
        "there is a node at the lowest point"
    );
    // The surface of an eighth of a ball is closed: its four boundaries contain all faces that belong to only one
    // element.
    let mut faces = std::collections::HashMap::new();
    for element in mesh.elements() {
        for face in mesh.kind_of(0).reference().faces {
            let mut key: Vec<usize> = face.iter().map(|&local| element[local]).collect();
            key.sort_unstable();
            *faces.entry(key).or_insert(0) += 1;
        }
    }
    let outside = faces.values().filter(|&&count| count == 1).count();
    assert_eq!(mesh.boundaries().iter().map(|boundary| boundary.facet_count()).sum::<usize>(), outside);
    assert!(faces.values().all(|&count| count <= 2));
}

#[test]
fn rings_close_and_their_area_converges() {
    for kind in PLANE {
        for (angles, part) in [([0.0, 360.0], 1.0), ([-90.0, 90.0], 0.5), ([30.0, 75.0], 0.125)] {
            let mesh = |times: usize| {
                let cells = 8 * times;
                let line = |line: usize| angles[0] + (angles[1] - angles[0]) * line as f64 / cells as f64;
                let lines: Vec<f64> = (0..=cells).map(line).collect();
                let mesh = ring([1.0, 0.0], &[1.0, 1.4, 2.0], &lines, kind).unwrap();
                for (name, radius) in [("outer", 2.0), ("inner", 1.0)] {
                    assert!(farthest(&mesh, name, |[x, y, _]| (x - 1.0).hypot(y) - radius) < 1e-15 * 4.0);
                }
                assert_eq!(mesh.boundaries().len(), if part == 1.0 { 2 } else { 4 });
                mesh
            };
            let order = if kind.is_quadratic() { 3.5 } else { 1.8 };
            converges(mesh, 2, part * PI * 3.0, [0.3, order, f64::INFINITY], kind.name());
        }
    }
    // The end nodes are exactly on the axis, so that such a half ring can be revolved.
    let half = ring([0.0, 0.0], &[1.0, 2.0], &[-90.0, 0.0, 90.0], ElementKind::Q4).unwrap();
    assert_eq!(farthest(&half, "start", |[x, ..]| x).max(farthest(&half, "end", |[x, ..]| x)), 0.0);
}

#[test]
fn values_out_of_their_range_are_refused_by_name() {
    let zone = Zone { width: 0.1, divisions: 4, growth: 1.2 };
    let disc = |radius, zone: Zone| half_disc([0.0; 2], radius, &zone, Sides::Both, ElementKind::Q4).unwrap_err();
    let cases = [
        (disc(0.0, zone), "radius is 0"),
        (disc(f64::NAN, zone), "radius is NaN"),
        (disc(1.0, Zone { width: 0.0, ..zone }), "zone.width is 0"),
        (disc(1.0, Zone { width: 1.5, ..zone }), "at most the radius"),
        (disc(1.0, Zone { divisions: 0, ..zone }), "zone.divisions is 0"),
        (disc(1.0, Zone { divisions: usize::MAX, ..zone }), "zone.divisions is"),
        (disc(1.0, Zone { width: 1e-12, ..zone }), "zone.divisions is 4"),
        (disc(1.0, Zone { growth: 0.9, ..zone }), "zone.growth is 0.9"),
        (disc(1.0, Zone { growth: f64::INFINITY, ..zone }), "zone.growth is inf"),
        (disc(1.0, Zone { width: 1e-7, growth: 1.0, ..zone }), "zone.growth is 1"),
        (disc(1.0, Zone { width: 1e-3, divisions: 100, growth: 1.0 }), "nodes that are allowed"),
        (
            half_disc([0.0; 2], 1.0, &zone, Sides::Both, ElementKind::Hex8).unwrap_err(),
            "a half disc cannot have a mesh of Hex8",
        ),
        (half_disc([f64::NAN, 0.0], 1.0, &zone, Sides::Both, ElementKind::T3).unwrap_err(), "must be finite"),
        (half_ball([0.0; 3], -1.0, &zone, [Sides::Both; 2]).unwrap_err(), "radius is -1"),
        (
            half_ball([0.0; 3], 1.0, &Zone { width: 0.5, divisions: 2000, growth: 1.0 }, [Sides::Both; 2]).unwrap_err(),
            "nodes that are allowed",
        ),
        (ring([0.0; 2], &[0.0, 1.0], &[0.0, 90.0], ElementKind::Q4).unwrap_err(), "inner radius is 0"),
        (ring([0.0; 2], &[1.0, 2.0], &[0.0, 200.0], ElementKind::Q4).unwrap_err(), "too wide"),
        (ring([0.0; 2], &[1.0, 2.0], &[0.0, 170.0, 340.0, 361.0], ElementKind::Q4).unwrap_err(), "span 361"),
        (ring([0.0; 2], &[2.0, 1.0], &[0.0, 90.0], ElementKind::Q4).unwrap_err(), "radius lines"),
        (ring([0.0; 2], &[1.0, 2.0], &[0.0], ElementKind::Q4).unwrap_err(), "angle lines"),
    ];
    for (error, phrase) in cases {
        assert!(matches!(error, Error::Linear(qp::LinearError::Setting { .. }) | Error::Fem(_)), "{error:?}");
        assert!(error.to_string().contains(phrase), "{error}\n  lacks: {phrase}");
    }
}

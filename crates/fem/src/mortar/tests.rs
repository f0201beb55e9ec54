//! Exact rows as fractions, and what every row must hold: shares, rigid motions, areas.

use super::face::Projected;
use super::*;
use crate::element::FacetKind::{self, Line2, Line3, Q4, Q8, T3, T6};
use crate::geometry::{COORDINATES, cross};
use crate::mesh::Mesh;

const SPACE: Formulation = Formulation::Space;
const PLANE: Formulation = Formulation::PlaneStrain { thickness: 1.0 };

/// Rounding of some ten operations on numbers of order one.
const ROUNDING_OF_SHARES: f64 = 4e-15;

/// A surface with these nodes and facets.
fn surface<'a>(nodes: &'a [[f64; 3]], kind: FacetKind, facets: &'a [usize]) -> SurfaceMesh<'a> {
    SurfaceMesh { nodes, kind, facets }
}

/// The shares of the row of a node: of all slave nodes, and of all master nodes.
fn shares(found: &FoundRows, node: usize, slave: usize, master: usize) -> [Vec<f64>; 2] {
    let row = found.rows.iter().find(|row| row.node == node).expect("the node carries a row");
    let spread = |list: &[(usize, f64)], count: usize| {
        let mut all = vec![0.0; count];
        list.iter().for_each(|&(node, share)| all[node] += share);
        all
    };
    [spread(&row.slave, slave), spread(&row.master, master)]
}

fn assert_equal(found: &[f64], exact: &[f64]) {
    assert_eq!(found.len(), exact.len());
    for (found, exact) in found.iter().zip(exact) {
        assert!((found - exact).abs() <= ROUNDING_OF_SHARES, "{found:?} is not {exact:?}");
    }
}

/// Of a node that is hardly covered 1/20 of the area is covered, below a tenth: one row holds the motion of both nodes.
/// Over a step the right half of an edge lies over a floor: a mean over both would have the gaps -0.05 and 0.25.
#[test]
fn rows_have_the_fractions_of_the_formulas() {
    let end = 1.0 / 40.0_f64.sqrt();
    let line = |x: &[f64]| x.iter().map(|&x| [x, 0.0, 0.0]).collect::<Vec<_>>();
    let [edge, halves, part, hardly] = [&[0.0, 1.0][..], &[0.0, 0.5, 1.0], &[0.0, 0.6], &[0.0, end]].map(line);
    let step = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5, -0.2, 0.0], [1.0, -0.2, 0.0]];
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let grid: Vec<[f64; 3]> = (0..9).map(|at| [f64::from(at % 3) / 2.0, f64::from(at / 3) / 2.0, 0.0]).collect();
    let cells: Vec<usize> = [0, 1, 3, 4].into_iter().flat_map(|at| [at, at + 3, at + 4, at + 1]).collect();
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let quadratic = [&triangle[..], &[[0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]]].concat();
    let upper = surface(&edge, Line2, &[0, 1]);
    let triangles = surface(&square, T3, &[0, 2, 1, 0, 3, 2]);
    let on_grid = [9.0, 6.0, -3.0, 6.0, 4.0, -2.0, -3.0, -2.0, 1.0].map(|share: f64| share / 16.0);
    // Slave, master, the area of each row, the covered share of the slave, and of some nodes the shares of all nodes.
    type Rows<'a> = &'a [(usize, &'a [f64], &'a [f64])];
    let cases: [(SurfaceMesh, SurfaceMesh, &[f64], f64, Rows); 7] = [
        (upper, surface(&halves, Line2, &[2, 1, 1, 0]), &[0.5; 2], 1.0, &[(0, &[1.0, 0.0], &[0.75, 0.5, -0.25])]),
        (
            upper,
            surface(&part, Line2, &[1, 0]),
            &[21.0 / 50.0, 9.0 / 50.0],
            0.6,
            &[(0, &[1.0, 0.0], &[1.0, 0.0]), (1, &[0.0, 1.0], &[-2.0 / 3.0, 5.0 / 3.0])],
        ),
        (upper, surface(&hardly, Line2, &[1, 0]), &[end], end, &[(0, &[1.0 - end / 2.0, end / 2.0], &[0.5, 0.5])]),
        (upper, surface(&step, Line2, &[1, 0, 2, 1, 3, 2]), &[0.375, 0.125], 0.5, &[]),
        (surface(&square, Q4, &[0, 1, 2, 3]), surface(&grid, Q4, &cells), &[0.25; 4], 1.0, &[(0, &[], &on_grid)]),
        (
            surface(&triangle, T3, &[0, 1, 2]),
            triangles,
            &[1.0 / 6.0; 3],
            1.0,
            &[(0, &[], &[1.0, 0.0, 0.0, 0.0]), (1, &[], &[0.25, 0.75, 0.25, -0.25])],
        ),
        (
            surface(&quadratic, T6, &[0, 1, 2, 3, 4, 5]),
            triangles,
            &[1.0 / 12.0; 6],
            1.0,
            &[(1, &[], &[-0.125, 1.125, -0.125, 0.125]), (4, &[], &[1.0, -0.5, 1.0, -0.5])],
        ),
    ];
    for (slave, master, areas, covered, rows) in cases {
        let formulation = if slave.kind == Line2 { PLANE } else { SPACE };
        let found = Mortar::of(slave, master, formulation).found().unwrap();
        assert_equal(&found.rows.iter().map(|row| row.area).collect::<Vec<_>>(), areas);
        assert_equal(&found.rows.iter().map(|row| row.gap).collect::<Vec<_>>(), &vec![0.0; areas.len()]);
        assert_equal(&found.covered[..1], &[covered]);
        for &(node, of_slave, of_master) in rows {
            let [own, other] = shares(&found, node, slave.nodes.len(), master.nodes.len());
            assert_equal(&other, of_master);
            assert!(of_slave.is_empty() || own.iter().zip(of_slave).all(|(own, exact)| (own - exact).abs() < 1e-15));
        }
    }
}

/// A random number in [0, 1) from a state, for meshes.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f64 / f64::from(1 << 24)
}

/// A grid of quadrilaterals or triangles of `kind` on [0, wide] x [0, 1], with inner nodes moved by up to `jitter` of a
/// cell; facing up, or down.
fn sheet(
    kind: FacetKind,
    counts: [usize; 2],
    wide: f64,
    jitter: f64,
    is_up: bool,
    state: &mut u64,
) -> (Vec<[f64; 3]>, Vec<usize>) {
    let [m, n] = counts;
    let mut nodes = Vec::new();
    for j in 0..=n {
        for i in 0..=m {
            let moved = |at: usize, count: usize, state: &mut u64| {
                if at == 0 || at == count { 0.0 } else { jitter * (random(state) - 0.5) }
            };
            let (x, y) = (i as f64 + moved(i, m, state), j as f64 + moved(j, n, state));
            nodes.push([wide * x / m as f64, y / n as f64, 0.0]);
        }
    }
    let cells = (0..n).flat_map(|j| (0..m).map(move |i| [j * (m + 1) + i, (j + 1) * (m + 1) + i]));
    let corners = cells.flat_map(|[a, b]| match kind.corners() {
        4 => vec![vec![a, a + 1, b + 1, b]],
        _ => vec![vec![a, a + 1, b + 1], vec![a, b + 1, b]],
    });
    let seen = corners.flat_map(|corners| if is_up { corners } else { corners.into_iter().rev().collect() });
    let mesh = Mesh::new(nodes, kind.linear(), seen.collect(), Vec::new()).unwrap();
    let mesh = if kind.is_quadratic() { mesh.elevated(kind).unwrap() } else { mesh };
    (mesh.nodes().to_vec(), mesh.elements().flatten().copied().collect())
}

fn turned(nodes: &[[f64; 3]], scale: f64, by: f64, shift: [f64; 3]) -> Vec<[f64; 3]> {
    let (s, c) = by.sin_cos();
    let turn = |[x, y, z]: [f64; 3]| [c * x - s * z, c * y - s * (s * x + c * z), s * y + c * (s * x + c * z)];
    nodes.iter().map(|&at| shifted(shift, scale, turn(at))).collect()
}

/// For all pairs of faces, on random meshes, fully and partly covered, tilted, small and large: shares add up to 1,
/// rigid motions leave all rows at rest, the areas add up to the covered area, and a uniform pressure reaches every
/// covered master node in full.
#[test]
fn rows_of_any_two_sheets_carry_a_uniform_pressure_and_no_rigid_motion() {
    let mut state = 3;
    for own in [T3, Q4, T6, Q8] {
        for other in [T3, Q4, T6, Q8] {
            for (wide, jitter, scale) in [(1.0, 0.0, 1.0), (1.0, 0.4, 1e-3), (1.3, 0.3, 1e6)] {
                let (slave, of_slave) = sheet(own, [3, 2], wide, jitter, true, &mut state);
                let (master, of_master) = sheet(other, [2, 5], 1.0, jitter, false, &mut state);
                let shift = [0.3, 2.0, -1.0].map(|x| 10.0 * x * scale);
                let [slave, master] = [slave, master].map(|nodes| turned(&nodes, scale, 0.35, shift));
                let (first, second) = (surface(&slave, own, &of_slave), surface(&master, other, &of_master));
                let rows = Mortar::of(first, second, SPACE).rows().unwrap();
                let found = Mortar::of(first, second, SPACE).found().unwrap();
                // Quadrilaterals that are no parallelograms take 8 points in each direction.
                let rounding = if jitter > 0.0 { 1e-11 } else { 1e-13 };
                let name = format!("{own:?} on {other:?}, {wide} wide, jitter {jitter}");
                for row in &found.rows {
                    let sum: f64 = row.master.iter().map(|entry| entry.1).sum();
                    assert!((sum - 1.0).abs() < 1e-12, "{name}: shares add up to {sum}");
                    assert!(row.gap.abs() < 1e-12 * scale, "{name}: gap {:e}", row.gap);
                }
                let area: f64 = rows.area.iter().sum();
                assert!((area / (scale * scale) - 1.0).abs() < rounding, "{name}: area {area}");
                // Rigid motions about the first node.
                for mode in 0..6 {
                    let motion = |&at: &[f64; 3]| match mode {
                        0..3 => COORDINATES[mode],
                        _ => cross(COORDINATES[mode - 3], minus(at, slave[0]).map(|part| part / scale)),
                    };
                    let moved: Vec<f64> = slave.iter().chain(&master).flat_map(motion).collect();
                    for value in rows.contact.mul(&moved) {
                        assert!(value.abs() < 1e-12, "{name}: mode {mode} moves a row by {value:e}");
                    }
                }
                if wide == 1.0 {
                    let forces = rows.contact.mul_transposed(&rows.area);
                    let (areas, normal) = (whole_areas(&second, SPACE), rows.normal[0]);
                    for (node, area) in areas.into_iter().enumerate() {
                        let of_node = &forces[3 * (slave.len() + node)..][..3];
                        let along: f64 = of_node.iter().zip(normal).map(|(force, part)| -force * part).sum();
                        assert!((along - area).abs() < rounding * scale * scale, "{name}: {along:e} for {area:e}");
                    }
                }
            }
        }
    }
}

/// The integral of each shape function, by the quadrature of the facets.
fn whole_areas(surface: &SurfaceMesh, formulation: Formulation) -> Vec<f64> {
    let mut areas = vec![0.0; surface.nodes.len()];
    for nodes in surface.facets.chunks_exact(surface.kind.nodes()) {
        let facet = PlacedFacet::new(surface, nodes);
        let mut add = |at: [f64; 3], size: f64| {
            let shape = (facet.reference().shape)(at);
            let area = size * formulation.measure(facet.at(&shape)[0]);
            facet.nodes.iter().zip(shape).for_each(|(&node, share)| areas[node] += share * area);
        };
        match surface.kind.dimension() {
            1 => line::for_each_of_whole(&facet, &mut add),
            _ => Projected::new(&facet, facet.normal).for_each_of_whole(&mut add),
        }
    }
    areas
}

/// Where both meshes are the same, all rows stay at rest if both surfaces move alike, in any way.
#[test]
fn equal_meshes_give_pairs() {
    let mut state = 5;
    for kind in [T3, Q4, T6, Q8] {
        let (slave, of_slave) = sheet(kind, [3, 4], 1.0, 0.3, true, &mut state);
        let reversed = kind.reference().mirrored();
        let of_master: Vec<usize> =
            of_slave.chunks(kind.nodes()).flat_map(|facet| reversed.iter().map(|&local| facet[local])).collect();
        let rows =
            Mortar::of(surface(&slave, kind, &of_slave), surface(&slave, kind, &of_master), SPACE).rows().unwrap();
        let motion: Vec<f64> = (0..3 * slave.len()).map(|_| random(&mut state)).collect();
        for value in rows.contact.mul(&[motion.clone(), motion].concat()) {
            assert!(value.abs() < 1e-10, "{kind:?}: {value:e}");
        }
    }
}

#[test]
fn edges_of_all_kinds_carry_a_uniform_pressure_in_the_plane_and_about_the_axis() {
    let mut state = 7;
    for (own, other) in [(Line2, Line2), (Line2, Line3), (Line3, Line2), (Line3, Line3)] {
        for formulation in [PLANE, Formulation::Axisymmetric] {
            for (counts, end) in [([2, 3], 1.0), ([4, 1], 1.0), ([5, 7], 1.0), ([3, 4], 0.85), ([4, 4], 0.7501)] {
                let line = |kind: FacetKind, count: usize, end: f64, is_up: bool, state: &mut u64| {
                    let step = |at: usize, state: &mut u64| {
                        if at == 0 || at == count { at as f64 } else { at as f64 + 0.4 * (random(state) - 0.5) }
                    };
                    let corners: Vec<f64> = (0..=count).map(|at| end * step(at, state) / count as f64).collect();
                    let mut nodes: Vec<[f64; 3]> = corners.iter().map(|&x| [x, 0.0, 0.0]).collect();
                    let mut facets = Vec::new();
                    for at in 0..count {
                        facets.extend(if is_up { [at + 1, at] } else { [at, at + 1] });
                        if kind == Line3 {
                            nodes.push([(corners[at] + corners[at + 1]) / 2.0, 0.0, 0.0]);
                            facets.push(nodes.len() - 1);
                        }
                    }
                    (nodes, facets)
                };
                let (slave, of_slave) = line(own, counts[0], 1.0, false, &mut state);
                let (master, of_master) = line(other, counts[1], end, true, &mut state);
                let (first, second) = (surface(&slave, own, &of_slave), surface(&master, other, &of_master));
                let rows = Mortar::of(first, second, formulation).rows().unwrap();
                let name = format!("{own:?} on {other:?}, {counts:?} to {end}, {formulation:?}");
                let exact = if formulation == PLANE { end } else { std::f64::consts::PI * end * end };
                let sum: f64 = rows.area.iter().sum();
                assert!((sum / exact - 1.0).abs() < 1e-13, "{name}: area {sum} for {exact}");
                assert!(rows.area.iter().all(|&area| area > 0.0), "{name}");
                // The force of a uniform pressure on both sides, node by node of the fully covered master.
                let forces = rows.contact.mul_transposed(&rows.area);
                for (node, area) in whole_areas(&second, formulation).into_iter().enumerate() {
                    // The rows lie along -y: the pressure pushes the master down.
                    let force = forces[2 * (slave.len() + node) + 1];
                    assert!((force - area).abs() < 1e-12, "{name}: node {node} takes {force:e} for {area:e}");
                }
            }
        }
    }
}

/// Nodes of a circle at uneven angles, and of a sphere: straight facets have the normals of the curve there.
#[test]
fn normals_at_nodes_are_those_of_circles_and_spheres() {
    let angles = [0.0, 0.3, 0.35, 0.6, 0.62, 1.0];
    let on_circle = angles.map(|angle: f64| [angle.cos(), angle.sin(), 0.0]);
    let edges: Vec<usize> = (0..5).flat_map(|at| [at, at + 1]).collect();
    // A fan around the pole.
    let mut on_sphere = vec![[0.0, 0.0, 1.0]];
    let around = [(0.2, 0.0), (0.1, 1.0), (0.3, 1.9), (0.15, 3.2), (0.25, 4.5)];
    on_sphere
        .extend(around.map(|(tilt, turn): (f64, f64)| [tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()]));
    let fan: Vec<usize> = (0..5).flat_map(|at| [0, 1 + at, 1 + (at + 1) % 5]).collect();
    for (sheet, formulation, inner) in
        [(surface(&on_circle, Line2, &edges), PLANE, 1..5), (surface(&on_sphere, T3, &fan), SPACE, 0..1)]
    {
        let sides = BothSurfaces::of(&Mortar::of(sheet, sheet, formulation));
        for node in inner {
            assert_equal(&sides.normals[0][node], &sheet.nodes[node]);
        }
    }
}

#[test]
fn a_surface_in_several_layers_and_facets_that_do_not_fit_are_refused() {
    let slave = [[0.0; 3], [1.0, 0.0, 0.0]];
    let master = [[0.0, -0.1, 0.0], [1.0, -0.1, 0.0], [0.0, -0.5, 0.0], [1.0, -0.5, 0.0]];
    let (slave, master) = (surface(&slave, Line2, &[0, 1]), surface(&master, Line2, &[1, 0, 3, 2]));
    let refused = Mortar::of(slave, master, PLANE).rows().unwrap_err().to_string();
    assert!(refused.contains("several layers") && refused.contains("2.000 times"), "{refused}");
    assert_eq!(Mortar::of(slave, master, PLANE).within(0.3).rows().unwrap().gap, [0.1, 0.1]);
    let refused = Mortar::of(slave, master, SPACE).rows().unwrap_err().to_string();
    assert!(refused.contains("are no surface of space"), "{refused}");
    let missing = surface(slave.nodes, Line2, &[0, 5]);
    let refused = Mortar::of(missing, master, PLANE).rows().unwrap_err().to_string();
    assert!(refused.contains("node 5"), "{refused}");
}

/// The errors of the gaps of rows between two surfaces at a distance, of those rows for which `counts` holds.
fn errors_of_gaps(pair: &Mortar, distance: f64, counts: impl Fn([f64; 3]) -> bool) -> Vec<f64> {
    let found = pair.found().unwrap();
    let rows = found.rows.iter().filter(|row| counts(pair.slave.nodes[row.node]));
    rows.map(|row| (row.gap - distance).abs()).collect()
}

fn largest(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |largest: f64, error| largest.max(*error))
}

/// A shaft in a hub with a play as large as the sag of its facets: the facets alone would have gaps from -2e-3 to 4e-3.
#[test]
fn gaps_are_those_of_the_circles_for_which_edges_stand() {
    let play = 2e-3;
    for (counts, spread, allowed) in [([48, 72], 0.0, 0.002), ([72, 48], 0.0, 0.002), ([48, 72], 0.4, 0.005)] {
        let circle = |radius: f64, count: usize| -> Vec<[f64; 3]> {
            let angle =
                |at: usize| (at as f64 + spread * (7.3 * at as f64).sin()) * std::f64::consts::TAU / count as f64;
            (0..count).map(|at| [radius * angle(at).cos(), radius * angle(at).sin(), 0.0]).collect()
        };
        let [shaft, hub] = [circle(1.0, counts[0]), circle(1.0 + play, counts[1])];
        let outer: Vec<usize> = (0..counts[0]).flat_map(|at| [at, (at + 1) % counts[0]]).collect();
        let inner: Vec<usize> = (0..counts[1]).flat_map(|at| [(at + 1) % counts[1], at]).collect();
        let sheets = [surface(&shaft, Line2, &outer), surface(&hub, Line2, &inner)];
        for [own, other] in [sheets, [sheets[1], sheets[0]]] {
            let pair = Mortar::of(own, other, PLANE).within(0.1);
            let errors = errors_of_gaps(&pair, play, |_| true);
            let sag = pair.found().unwrap().sag;
            assert!(
                errors.len() == own.nodes.len() && largest(&errors) < allowed * sag,
                "{counts:?}: {:e}",
                largest(&errors)
            );
        }
    }
}

/// Two patches of spheres, away from their rims.
#[test]
fn gaps_are_those_of_the_spheres_for_which_faces_stand() {
    let play = 2e-3;
    for kind in [T3, Q4] {
        let patch = |radius: f64, half: f64, count: usize, is_up: bool| {
            let (nodes, facets) = sheet(kind, [count; 2], 1.0, 0.0, is_up, &mut 0);
            let place = |at: &[f64; 3]| {
                let [a, b, _] = at.map(|part| half * (2.0 * part - 1.0));
                [radius * b.cos() * a.sin(), radius * b.sin(), radius * b.cos() * a.cos()]
            };
            (nodes.iter().map(place).collect::<Vec<_>>(), facets)
        };
        let (ball, cup) = (patch(1.0, 0.4, 7, true), patch(1.0 + play, 0.5, 10, false));
        let sheets = [surface(&ball.0, kind, &ball.1), surface(&cup.0, kind, &cup.1)];
        for [own, other] in [sheets, [sheets[1], sheets[0]]] {
            let pair = Mortar::of(own, other, SPACE).within(0.1);
            let errors = errors_of_gaps(&pair, play, |[x, y, _]| x.abs().max(y.abs()) < 0.2);
            let sag = pair.found().unwrap().sag;
            assert!(errors.len() > 8 && largest(&errors) < 0.002 * sag, "{kind:?}: {:e}", largest(&errors));
        }
    }
}

/// A square in a square hole: its corners are no curve.
#[test]
fn corners_are_not_rounded() {
    let square = |half: f64| [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]];
    let [pin, hole] = [square(1.0), square(1.1)];
    let pair = Mortar::of(
        surface(&pin, Line2, &[0, 1, 1, 2, 2, 3, 3, 0]),
        surface(&hole, Line2, &[1, 0, 2, 1, 3, 2, 0, 3]),
        PLANE,
    );
    assert_eq!(pair.found().unwrap().sag, 0.0);
    let sides = BothSurfaces::of(&pair);
    let curve = super::skin::Curve::of(&pair.slave, &sides.slave, &sides.normals[0]);
    let middle = (Line2.reference().shape)([0.0; 3]);
    assert!(sides.slave.iter().all(|facet| curve.beyond(facet, &middle) == 0.0));
}

//! Exact rows as fractions, and what every row must hold: shares, rigid motions, areas.

use super::face::Projected;
use super::*;
use crate::element::FacetKind::{self, Line2, Line3, Q4, Q8, T3, T6};
use crate::geometry::midpoint;

const SPACE: Formulation = Formulation::Space;
const PLANE: Formulation = Formulation::PlaneStrain { thickness: 1.0 };

/// Rounding of some ten operations on numbers of order one.
const ROUNDING_OF_SHARES: f64 = 4e-15;

/// A surface of a test: nodes and facets.
#[derive(Clone, Copy)]
struct Sheet<'a>(&'a [[f64; 3]], FacetKind, &'a [usize]);

impl<'a> Sheet<'a> {
    fn mesh(self) -> SurfaceMesh<'a> {
        SurfaceMesh { nodes: self.0, kind: self.1, facets: self.2 }
    }
}

fn between<'a>(slave: Sheet<'a>, master: Sheet<'a>, formulation: Formulation) -> Mortar<'a> {
    let (slave, master, reach) = (slave.mesh(), master.mesh(), f64::INFINITY);
    let (direction, between) = (None, None);
    let (may_carry, has_coefficient, has_sides) = (None, None, false);
    Mortar { slave, master, formulation, direction, reach, may_carry, has_coefficient, between, has_sides }
}

/// The shares of the row of a node: of all slave nodes, and of all master nodes.
fn shares(found: &Found, node: usize, slave: usize, master: usize) -> [Vec<f64>; 2] {
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

#[test]
fn an_edge_against_two_has_the_fractions_of_the_formula() {
    let (upper, lower) = ([[0.0; 3], [1.0, 0.0, 0.0]], [[0.0; 3], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let found = between(Sheet(&upper, Line2, &[0, 1]), Sheet(&lower, Line2, &[2, 1, 1, 0]), PLANE).found().unwrap();
    let [own, other] = shares(&found, 0, 2, 3);
    assert_equal(&own, &[1.0, 0.0]);
    assert_equal(&other, &[0.75, 0.5, -0.25]);
    assert_equal(&found.covered, &[1.0, 1.0]);
}

#[test]
fn the_end_of_a_surface_inside_an_edge_has_the_fractions_of_the_formula() {
    let (upper, lower) = ([[0.0; 3], [1.0, 0.0, 0.0]], [[0.0; 3], [0.6, 0.0, 0.0]]);
    let found = between(Sheet(&upper, Line2, &[0, 1]), Sheet(&lower, Line2, &[1, 0]), PLANE).found().unwrap();
    assert_equal(&found.rows.iter().map(|row| row.area).collect::<Vec<_>>(), &[21.0 / 50.0, 9.0 / 50.0]);
    assert_equal(&shares(&found, 0, 2, 2)[1], &[1.0, 0.0]);
    assert_equal(&shares(&found, 1, 2, 2)[1], &[-2.0 / 3.0, 5.0 / 3.0]);
    assert_equal(&found.covered, &[0.6, 1.0]);
}

/// Of the right node 1/20 of the area is covered, below a tenth: one row, which holds the motion of both nodes.
#[test]
fn a_node_that_is_hardly_covered_hands_its_function_over() {
    let end = 1.0 / 40.0_f64.sqrt();
    let (upper, lower) = ([[0.0; 3], [1.0, 0.0, 0.0]], [[0.0; 3], [end, 0.0, 0.0]]);
    let found = between(Sheet(&upper, Line2, &[0, 1]), Sheet(&lower, Line2, &[1, 0]), PLANE).found().unwrap();
    let [own, other] = shares(&found, 0, 2, 2);
    assert_equal(&own, &[1.0 - end / 2.0, end / 2.0]);
    assert_equal(&other, &[0.5, 0.5]);
    assert_equal(&[found.rows[0].area], &[end]);
    assert_eq!(found.rows.len(), 1);
}

#[test]
fn faces_in_space_have_the_fractions_of_the_formulas() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let grid: Vec<[f64; 3]> = (0..9).map(|at| [f64::from(at % 3) / 2.0, f64::from(at / 3) / 2.0, 0.0]).collect();
    let cells: Vec<usize> =
        [0, 1, 3, 4].into_iter().flat_map(|first| [first, first + 3, first + 4, first + 1]).collect();
    let found = between(Sheet(&square, Q4, &[0, 1, 2, 3]), Sheet(&grid, Q4, &cells), SPACE).found().unwrap();
    let exact = [9.0, 6.0, -3.0, 6.0, 4.0, -2.0, -3.0, -2.0, 1.0].map(|share: f64| share / 16.0);
    assert_equal(&shares(&found, 0, 4, 9)[1], &exact);

    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let halves = [0, 2, 1, 0, 3, 2];
    let found = between(Sheet(&triangle, T3, &[0, 1, 2]), Sheet(&square, T3, &halves), SPACE).found().unwrap();
    assert_equal(&shares(&found, 0, 3, 4)[1], &[1.0, 0.0, 0.0, 0.0]);
    assert_equal(&shares(&found, 1, 3, 4)[1], &[0.25, 0.75, 0.25, -0.25]);

    let mut quadratic = triangle.to_vec();
    quadratic.extend([[0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]]);
    let slave = Sheet(&quadratic, T6, &[0, 1, 2, 3, 4, 5]);
    let found = between(slave, Sheet(&square, T3, &halves), SPACE).found().unwrap();
    assert_equal(&found.rows.iter().map(|row| row.area).collect::<Vec<_>>(), &[1.0 / 12.0; 6]);
    assert_equal(&shares(&found, 1, 6, 4)[1], &[-0.125, 1.125, -0.125, 0.125]);
    assert_equal(&shares(&found, 4, 6, 4)[1], &[1.0, -0.5, 1.0, -0.5]);
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
    let mut facets = Vec::new();
    let mut add = |mut corners: Vec<usize>, nodes: &mut Vec<[f64; 3]>| {
        if !is_up {
            corners.reverse();
        }
        let reference = kind.reference();
        let middles: Vec<usize> = reference
            .mid_sides
            .iter()
            .map(|&[a, b]| {
                let (a, b) = (nodes[corners[a]], nodes[corners[b]]);
                let middle = midpoint(a, b);
                nodes.iter().position(|&node| node == middle).unwrap_or_else(|| {
                    nodes.push(middle);
                    nodes.len() - 1
                })
            })
            .collect();
        facets.extend(corners.into_iter().chain(middles));
    };
    for j in 0..n {
        for i in 0..m {
            let [a, b] = [j * (m + 1) + i, (j + 1) * (m + 1) + i];
            match kind.reference().corners {
                4 => add(vec![a, a + 1, b + 1, b], &mut nodes),
                _ => {
                    add(vec![a, a + 1, b + 1], &mut nodes);
                    add(vec![a, b + 1, b], &mut nodes);
                }
            }
        }
    }
    (nodes, facets)
}

fn turned(nodes: &[[f64; 3]], scale: f64, by: f64, shift: [f64; 3]) -> Vec<[f64; 3]> {
    let (s, c) = by.sin_cos();
    let turn = |[x, y, z]: [f64; 3]| [c * x - s * z, c * y - s * (s * x + c * z), s * y + c * (s * x + c * z)];
    nodes
        .iter()
        .map(|&at| {
            let at = turn(at);
            [0, 1, 2].map(|axis| scale * at[axis] + shift[axis])
        })
        .collect()
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
                let [slave, master] = [slave, master]
                    .map(|nodes| turned(&nodes, scale, 0.35, [0.3, 2.0, -1.0].map(|x| 10.0 * x * scale)));
                let (first, second) = (Sheet(&slave, own, &of_slave), Sheet(&master, other, &of_master));
                let rows = between(first, second, SPACE).rows().unwrap();
                let found = between(first, second, SPACE).found().unwrap();
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
                // Rigid motions about the middle.
                let all: Vec<[f64; 3]> = slave.iter().chain(&master).copied().collect();
                for mode in 0..6 {
                    let motion = |at: &[f64; 3]| {
                        let mut way = [0.0; 3];
                        let away = minus(*at, slave[0]);
                        match mode {
                            0..3 => way[mode] = 1.0,
                            _ => {
                                let (a, b) = ((mode + 1) % 3, (mode + 2) % 3);
                                (way[a], way[b]) = (-away[b] / scale, away[a] / scale);
                            }
                        }
                        way
                    };
                    let moved: Vec<f64> = all.iter().flat_map(motion).collect();
                    for value in rows.contact.mul(&moved) {
                        assert!(value.abs() < 1e-12, "{name}: mode {mode} moves a row by {value:e}");
                    }
                }
                if wide == 1.0 {
                    let pressure: Vec<f64> = rows.area.clone();
                    let forces = rows.contact.mul_transposed(&pressure);
                    let (areas, normal) = (whole_areas(&second.mesh()), rows.normal[0]);
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
fn whole_areas(surface: &SurfaceMesh) -> Vec<f64> {
    let mut areas = vec![0.0; surface.nodes.len()];
    for nodes in surface.facets.chunks_exact(surface.kind.nodes()) {
        let facet = Facet::new(surface, nodes);
        Projected::new(&facet, facet.normal).for_each_of_whole(&mut |at, area| {
            let shape = (facet.reference().shape)(at);
            facet.nodes.iter().zip(shape).for_each(|(&node, share)| areas[node] += share * area);
        });
    }
    areas
}

/// Where both meshes are the same, all rows stay at rest if both surfaces move alike, in any way.
#[test]
fn equal_meshes_give_pairs() {
    let mut state = 5;
    for kind in [T3, Q4, T6, Q8] {
        let (slave, of_slave) = sheet(kind, [3, 4], 1.0, 0.3, true, &mut state);
        let reversed = FacetKind::reference(kind).mirrored();
        let of_master: Vec<usize> =
            of_slave.chunks(kind.nodes()).flat_map(|facet| reversed.iter().map(|&local| facet[local])).collect();
        let rows = between(Sheet(&slave, kind, &of_slave), Sheet(&slave, kind, &of_master), SPACE).rows().unwrap();
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
                let (first, second) = (Sheet(&slave, own, &of_slave), Sheet(&master, other, &of_master));
                let rows = between(first, second, formulation).rows().unwrap();
                let name = format!("{own:?} on {other:?}, {counts:?} to {end}, {formulation:?}");
                let exact = if formulation == PLANE { end } else { std::f64::consts::PI * end * end };
                let sum: f64 = rows.area.iter().sum();
                assert!((sum / exact - 1.0).abs() < 1e-13, "{name}: area {sum} for {exact}");
                assert!(rows.area.iter().all(|&area| area > 0.0), "{name}");
                // The force of a uniform pressure on both sides, node by node of the fully covered master.
                let forces = rows.contact.mul_transposed(&rows.area);
                let mesh = second.mesh();
                for (node, facet_nodes) in (0..master.len()).map(|node| (node, &of_master)) {
                    let mut area = 0.0;
                    for facet in facet_nodes.chunks(other.nodes()).filter(|facet| facet.contains(&node)) {
                        let facet = Facet::new(&mesh, facet);
                        line::for_each_of_whole(&facet, &mut |at, size| {
                            let shape = (facet.reference().shape)(at);
                            let local = facet.nodes.iter().position(|&other| other == node).unwrap();
                            let x: f64 = facet.places().iter().zip(shape).map(|(place, share)| share * place[0]).sum();
                            area += size * formulation.measure(x) * shape[local];
                        });
                    }
                    // The rows lie along -y: the pressure pushes the master down.
                    let force = forces[2 * (slave.len() + node) + 1];
                    assert!((force - area).abs() < 1e-12, "{name}: node {node} takes {force:e} for {area:e}");
                }
            }
        }
    }
}

/// The right half of the edge lies over a floor: a mean over both would have the gaps -0.05 and 0.25 for a step of 0.2.
#[test]
fn a_facet_over_a_step_touches_the_near_part_alone() {
    let slave = [[0.0; 3], [1.0, 0.0, 0.0]];
    let master = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5, -0.2, 0.0], [1.0, -0.2, 0.0]];
    let (slave, with_wall) = (Sheet(&slave, Line2, &[0, 1]), Sheet(&master, Line2, &[1, 0, 2, 1, 3, 2]));
    let found = between(slave, with_wall, PLANE).found().unwrap();
    assert_equal(&found.rows.iter().map(|row| row.gap).collect::<Vec<_>>(), &[0.0, 0.0]);
    assert_equal(&found.covered[..1], &[0.5]);
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
        [(Sheet(&on_circle, Line2, &edges), PLANE, 1..5), (Sheet(&on_sphere, T3, &fan), SPACE, 0..1)]
    {
        let sides = Sides::of(&between(sheet, sheet, formulation));
        for node in inner {
            assert_equal(&sides.normals[0][node], &sheet.0[node]);
        }
    }
}

#[test]
fn a_surface_in_several_layers_and_facets_that_do_not_fit_are_refused() {
    let slave = [[0.0; 3], [1.0, 0.0, 0.0]];
    let master = [[0.0, -0.1, 0.0], [1.0, -0.1, 0.0], [0.0, -0.5, 0.0], [1.0, -0.5, 0.0]];
    let (slave, master) = (Sheet(&slave, Line2, &[0, 1]), Sheet(&master, Line2, &[1, 0, 3, 2]));
    let refused = between(slave, master, PLANE).rows().unwrap_err().to_string();
    assert!(refused.contains("several layers") && refused.contains("2.000 times"), "{refused}");
    assert_eq!(between(slave, master, PLANE).within(0.3).rows().unwrap().gap, [0.1, 0.1]);
    let refused = between(slave, master, SPACE).rows().unwrap_err().to_string();
    assert!(refused.contains("are no surface of space"), "{refused}");
    let missing = Sheet(slave.0, Line2, &[0, 5]);
    let refused = between(missing, master, PLANE).rows().unwrap_err().to_string();
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
        let sheets = [Sheet(&shaft, Line2, &outer), Sheet(&hub, Line2, &inner)];
        for [own, other] in [sheets, [sheets[1], sheets[0]]] {
            let pair = between(own, other, PLANE).within(0.1);
            let errors = errors_of_gaps(&pair, play, |_| true);
            let sag = pair.found().unwrap().sag;
            assert!(
                errors.len() == own.0.len() && largest(&errors) < allowed * sag,
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
        let patch = |radius: f64, half: f64, count: usize, is_inside_out: bool| -> (Vec<[f64; 3]>, Vec<usize>) {
            let angle = |at: usize| half * (2.0 * at as f64 / count as f64 - 1.0);
            let nodes = (0..=count).flat_map(|j| (0..=count).map(move |i| [angle(i), angle(j)]));
            let place = |[a, b]: [f64; 2]| [radius * b.cos() * a.sin(), radius * b.sin(), radius * b.cos() * a.cos()];
            let node = |i: usize, j: usize| j * (count + 1) + i;
            let cells = (0..count).flat_map(|j| (0..count).map(move |i| (i, j)));
            let corners = cells.map(|(i, j)| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
            let facets = corners.flat_map(|[a, b, c, d]| match (kind, is_inside_out) {
                (T3, false) => vec![a, b, c, a, c, d],
                (T3, true) => vec![a, c, b, a, d, c],
                (_, false) => vec![a, b, c, d],
                (_, true) => vec![a, d, c, b],
            });
            (nodes.map(place).collect(), facets.collect())
        };
        let (ball, cup) = (patch(1.0, 0.4, 7, false), patch(1.0 + play, 0.5, 10, true));
        let sheets = [Sheet(&ball.0, kind, &ball.1), Sheet(&cup.0, kind, &cup.1)];
        for [own, other] in [sheets, [sheets[1], sheets[0]]] {
            let pair = between(own, other, SPACE).within(0.1);
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
    let pair =
        between(Sheet(&pin, Line2, &[0, 1, 1, 2, 2, 3, 3, 0]), Sheet(&hole, Line2, &[1, 0, 2, 1, 3, 2, 0, 3]), PLANE);
    assert_eq!(pair.found().unwrap().sag, 0.0);
    let sides = Sides::of(&pair);
    let curve = super::skin::Curve::of(&pair.slave, &sides.slave, &sides.normals[0]);
    let middle = (Line2.reference().shape)([0.0; 3]);
    assert!(sides.slave.iter().all(|facet| curve.beyond(facet, &middle) == 0.0));
}

//! Tests of what a problem of the continuum may contain, against closed forms: columns of height one and of a strain
//! that is constant on each layer, so that the bracket is exact; and bodies that are turned.

use std::collections::HashMap;
use std::sync::Arc;

use super::bodies::{body, filled, solved};
use super::bound::Bracket;
use super::mesh::{Cells, SimplexMesh};
use super::problem::{
    Condition, ContinuumProblem, Distance, Enclosure, Facing, Foundation, Held, Linear, Medium, Pressed, RigidFace,
    Surface,
};
use super::simplex::Point;
use super::two_bodies::medium;
use signorini_fem::Formulation;
use signorini_fem::geometry::{COORDINATES, cross, dot};
use signorini_fem::material::{Lame, Material};

/// Relative rounding of the energies and forces of a column with these keys.
const ROUNDING: f64 = 1e-11;

/// Young's modulus of a column that does not bulge.
const YOUNG: f64 = 2.0;

/// The same distance everywhere.
#[derive(Debug)]
struct Flat(f64);

impl Distance for Flat {
    fn gap(&self, corners: &[Point]) -> Option<Enclosure> {
        let count = corners.len() * (corners.len() + 1) / 2;
        Some(Enclosure { coefficients: vec![self.0; count], below: 0.0, above: 0.0 })
    }
}

fn plane(axis: usize, distance: f64) -> Vec<Facing> {
    vec![Facing { normal: COORDINATES[axis], surface: Surface::Rigid(Arc::new(Flat(distance))), pressed: None }]
}

fn held(axis: usize) -> Held {
    Held { direction: COORDINATES[axis], value: Linear::default() }
}

/// The energies D and J of the bracket, the energy of the closed form and the scale of its rounding.
fn assert_exact(bracket: &Bracket, energy: f64) {
    let size = ROUNDING * bracket.energy.max(energy.abs());
    for found in [bracket.energy_of_stress(), bracket.energy_of_displacement()] {
        assert!((found - energy).abs() < size, "{found} {energy}");
    }
    assert!(bracket.distance().abs() < size && bracket.defect < ROUNDING, "{} {}", bracket.distance(), bracket.defect);
}

/// A column on springs with a stress without strain, its head against a plane at the distance `GAP`: by the
/// displacement `eps` of the head against the base under the pressure q, and that of the base, `-q/k`.
#[test]
fn a_column_on_springs_with_own_stress_is_exact_under_a_plane_that_stands_still_or_is_pressed() {
    const GAP: f64 = -0.04;
    const SPRINGS: f64 = 3.0;
    const OWN: f64 = 0.02;
    for dimension in [2, 3] {
        let (mut problem, mesh) = body(dimension);
        let (up, area) = (dimension - 1, problem.thickness);
        let mut own = [Linear::default(); 6];
        own[up] = Linear::constant(OWN);
        problem.media = vec![Medium { own_stress: Some(own), ..medium(YOUNG, 0.0) }];
        problem.conditions.iter_mut().for_each(|condition| condition.traction = Default::default());
        let along = [0, 1, 2].map(|axis| if axis == up { 0.0 } else { 1.0 });
        problem.conditions[0] = Condition { springs: Foundation { along, normal: SPRINGS }, ..Condition::default() };
        let stored = |pressure: f64| {
            let (strain, base) = ((-pressure - OWN) / YOUNG, -pressure / SPRINGS);
            let energy = YOUNG * strain * strain / 2.0 + OWN * strain + SPRINGS * base * base / 2.0;
            (area * energy, strain + base)
        };
        let pressure = -(GAP + OWN / YOUNG) / (1.0 / YOUNG + 1.0 / SPRINGS);
        problem.obstacles = plane(up, GAP);
        let bracket = solved(&problem, &mesh);
        assert_exact(&bracket, stored(pressure).0);
        let [low, high] = bracket.force_interval(0.0).unwrap().unwrap();
        assert!(
            (low - area * pressure).abs() < 1e-5 * low && (high - area * pressure).abs() < 1e-5 * low,
            "{low} {high}"
        );
        // Half of the force as a load on the plane, which travels until the head balances it.
        let force = area * pressure / 2.0;
        problem.obstacles[0].pressed = Some(Pressed { force, cosine: 1.0 });
        let bracket = solved(&problem, &mesh);
        let (energy, head) = stored(pressure / 2.0);
        assert_exact(&bracket, energy - force * (GAP - head));
        assert_eq!(bracket.force_interval(0.0).unwrap(), Some([force; 2]));
        // A rigid head that the same force pushes; the plane is far away.
        let turns: &[usize] = if dimension == 2 { &[2] } else { &[0, 1, 2] };
        let shift = |axis: usize| [0, 1, 2].map(|along| Linear::constant(f64::from(u8::from(along == axis))));
        let turn = |about: &usize| [0, 1, 2].map(|axis| Linear::of(|place| cross(COORDINATES[*about], place)[axis]));
        let push = |axis: usize| if axis == up { -force } else { 0.0 };
        // About the origin, through which the force does not pass.
        let moment = |about: &usize| cross([0.5, 0.5, 0.5], COORDINATES[up].map(|part| -force * part))[*about];
        let free = (0..dimension).map(|axis| (shift(axis), push(axis)));
        let free = free.chain(turns.iter().map(|about| (turn(about), moment(about)))).collect();
        problem.rigid_faces = vec![RigidFace { prescribed: [Linear::default(); 3], free }];
        problem.conditions[2] = Condition { rigid_face: Some(0), ..Condition::default() };
        problem.obstacles = Vec::new();
        let bracket = solved(&problem, &mesh);
        assert_exact(&bracket, energy + force * head);
    }
}

/// The force of a body on springs under a bowl lies in the intervals of a mesh and of finer ones.
#[test]
fn the_intervals_of_the_force_of_a_body_on_springs_overlap() {
    for dimension in [2, 3] {
        let (mut problem, mut mesh) = body(dimension);
        let springs = Foundation { along: [0.5, 0.7, 0.6], normal: 0.4 };
        problem.conditions[0] = Condition { springs, ..Condition::default() };
        let intervals: Vec<[f64; 2]> = (0..4)
            .map(|_| {
                let interval = solved(&problem, &mesh).force_interval(0.0).unwrap();
                mesh = problem.refined(&mesh, &vec![true; mesh.count()]);
                interval.unwrap()
            })
            .collect();
        let least = intervals.iter().fold(f64::INFINITY, |least: f64, [_, high]| least.min(*high));
        let most = intervals.iter().fold(0.0, |most: f64, [low, _]| most.max(*low));
        assert!(most <= least && least < 1.2 * most, "{intervals:?}");
    }
}

/// Two layers of height 1/2 on a clamped base, with a condition on the edge between them.
fn layers(media: [Medium; 2], between: Condition) -> (ContinuumProblem, SimplexMesh) {
    let nodes: Vec<Point> = (0..6).map(|node| [f64::from(node % 2), f64::from(node / 2) / 2.0, 0.0]).collect();
    let cells = vec![vec![0, 1, 3], vec![0, 3, 2], vec![2, 3, 5], vec![2, 5, 4]];
    let sides = [([0, 1], 0), ([4, 5], 1), ([2, 3], 2), ([0, 2], 4), ([1, 3], 3), ([2, 4], 4), ([3, 5], 3)];
    let surface: HashMap<Vec<usize>, usize> = sides.into_iter().map(|(side, number)| (side.to_vec(), number)).collect();
    let problem = ContinuumProblem {
        media: media.to_vec(),
        medium_of: vec![0, 0, 1, 1],
        conditions: vec![
            Condition { held: vec![held(0), held(1)], ..Condition::default() },
            Condition::default(),
            between,
            Condition::default(),
            Condition::default(),
        ],
        ..filled(2, Lame { lambda: 0.0, mu: 1.0 }, [0.0; 3])
    };
    let mesh = SimplexMesh::new(2, Cells { nodes, cells, origins: vec![0, 1, 2, 3], surface }).unwrap();
    let finer = problem.refined(&mesh, &[true, false, true, false]);
    (problem, finer)
}

#[test]
fn layers_of_two_media_share_their_shortening() {
    let [lower, upper] = [2.0, 8.0];
    let (mut problem, mesh) = layers([lower, upper].map(|young| medium(young, 0.0)), Condition::default());
    problem.conditions[1].obstacles = vec![0];
    problem.obstacles = plane(1, -0.1);
    let pressure = 0.1 / (0.5 / lower + 0.5 / upper);
    assert_exact(&solved(&problem, &mesh), 0.1 * pressure / 2.0);
}

/// A traction t on the edge between the layers stretches the lower one by `t/E` and moves the upper one; a support
/// there does the same.
#[test]
fn loads_and_supports_on_edges_inside_are_exact() {
    let pull = 0.3;
    let mut between = Condition::default();
    between.pull_along([Linear::default(), Linear::constant(pull), Linear::default()]);
    let (problem, mesh) = layers([medium(YOUNG, 0.0), medium(YOUNG, 0.0)], between);
    assert!(mesh.surface().any(|outer| mesh.cells_at()[outer.facet][1].is_some()));
    assert_exact(&solved(&problem, &mesh), -pull * pull / (4.0 * YOUNG));
    let moved = pull / YOUNG / 2.0;
    let held = vec![Held { value: Linear::constant(moved), ..held(1) }];
    let (problem, mesh) = layers([medium(YOUNG, 0.0), medium(YOUNG, 0.0)], Condition { held, ..Condition::default() });
    assert_exact(&solved(&problem, &mesh), YOUNG * moved * moved);
}

/// Along an axis of an orthotropic sheet that may bulge freely its own modulus counts.
#[test]
fn an_orthotropic_column_has_the_modulus_along_its_axis() {
    let young = [7.0, 2.0, 3.0];
    let material = Material::orthotropic(young, [0.3, 0.2, 0.1], [1.0, 1.5, 2.0]).unwrap();
    let law = material.law(&Formulation::PlaneStress { thickness: 1.0 }).unwrap();
    let medium = Medium { stiffness: law.stiffness, own_stress: None, body_force: [0.0; 3] };
    let (mut problem, mesh) = layers([medium.clone(), medium], Condition::default());
    problem.conditions[0].held = vec![held(1)];
    problem.conditions[4].held = vec![held(0)];
    problem.conditions[1].obstacles = vec![0];
    problem.obstacles = plane(1, -0.1);
    assert_exact(&solved(&problem, &mesh), young[1] * 0.1 * 0.1 / 2.0);
}

/// A column with linear supports and tractions whose displacement is linear: `u = G x`.
#[test]
fn linear_profiles_are_exact() {
    for dimension in [2, 3] {
        let (mut problem, mesh) = body(dimension);
        problem.obstacles = Vec::new();
        problem.media[0].body_force = [0.0; 3];
        let gradient = [[0.02, -0.01, 0.015], [0.03, 0.01, -0.02], [-0.01, 0.02, 0.025]];
        let moved =
            |axis: usize, place: Point| (0..dimension).map(|along| gradient[axis][along] * place[along]).sum::<f64>();
        let all = (0..dimension).map(|axis| Held { value: Linear::of(|place| moved(axis, place)), ..held(axis) });
        problem.conditions = vec![Condition { held: all.collect(), ..Condition::default() }; 4];
        let strain = |i: usize, j: usize| (gradient[i][j] + gradient[j][i]) / 2.0;
        let mut tensor = [0.0; 6];
        for (entry, [i, j]) in [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]].into_iter().enumerate() {
            tensor[entry] = if i < dimension && j < dimension { strain(i, j) } else { 0.0 };
        }
        let energy = problem.thickness * problem.law(0).square(tensor) / 2.0;
        assert_exact(&solved(&problem, &mesh), energy);
    }
}

/// A rotation of the coordinates.
#[derive(Clone, Copy, Debug)]
struct Turn([Point; 3]);

impl Turn {
    fn by(&self, vector: Point) -> Point {
        self.0.map(|row| dot(row, vector))
    }

    fn back(&self, vector: Point) -> Point {
        [0, 1, 2].map(|axis| (0..3).map(|row| self.0[row][axis] * vector[row]).sum())
    }
}

/// A distance in turned coordinates.
#[derive(Debug)]
struct Turned(Arc<dyn Distance>, Turn);

impl Distance for Turned {
    fn gap(&self, corners: &[Point]) -> Option<Enclosure> {
        self.0.gap(&corners.iter().map(|&corner| self.1.back(corner)).collect::<Vec<_>>())
    }
}

/// On guides and under loads; a turned body has inclined supports, an inclined obstacle and the same bounds.
#[test]
fn a_turned_body_has_the_same_bounds() {
    for dimension in [2, 3] {
        let (mut problem, mesh) = body(dimension);
        let last = dimension - 1;
        problem.conditions[0].held = vec![Held { value: Linear::constant(0.01), ..held(last) }];
        problem.conditions[1].held = vec![held(0)];
        if dimension == 3 {
            problem.conditions[3].held = vec![held(1)];
        }
        problem.conditions[3].pressure = Linear::constant(if dimension == 2 { 0.02 } else { 0.0 });
        let (cosine, sine) = (0.7_f64.cos(), 0.7_f64.sin());
        let about_z = [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]];
        let turn = if dimension == 2 {
            Turn(about_z)
        } else {
            // Then about x.
            let [x, y, z] = about_z;
            let mix = |a: f64, b: f64| [0, 1, 2].map(|axis| a * y[axis] + b * z[axis]);
            Turn([x, mix(0.6, -0.8), mix(0.8, 0.6)])
        };
        let mut turned = problem.clone();
        turned.media[0].body_force = turn.by(problem.media[0].body_force);
        for condition in &mut turned.conditions {
            let traction = turn.by(condition.traction.map(|part| part.at_origin));
            condition.traction = traction.map(Linear::constant);
            condition.held.iter_mut().for_each(|held| held.direction = turn.by(held.direction));
        }
        for facing in &mut turned.obstacles {
            facing.normal = turn.by(facing.normal);
            if let Surface::Rigid(distance) = &facing.surface {
                facing.surface = Surface::Rigid(Arc::new(Turned(distance.clone(), turn)));
            }
        }
        let mut turned_mesh = mesh.clone();
        turned_mesh.nodes.iter_mut().for_each(|node| *node = turn.by(*node));
        let of = |problem: &ContinuumProblem, mesh: &SimplexMesh| {
            let bracket = solved(problem, mesh);
            assert!(bracket.balance.is_some() && bracket.defect < 1e-10, "{}", bracket.defect);
            let [low, high] = bracket.force_interval(0.0).unwrap().unwrap();
            [bracket.energy_of_stress(), bracket.energy_of_displacement(), bracket.distance(), low, high]
        };
        let (plain, turned) = (of(&problem, &mesh), of(&turned, &turned_mesh));
        for (plain, turned) in plain.into_iter().zip(turned) {
            assert!((turned / plain - 1.0).abs() < 1e-7, "{plain} {turned}");
        }
    }
}

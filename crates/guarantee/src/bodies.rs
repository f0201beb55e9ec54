//! Bodies for tests.

use std::sync::Arc;

use super::bound::Bracket;
use super::mesh::{Cells, SimplexMesh};
use super::problem::{Condition, ContinuumProblem, Distance, Enclosure, Facing, Held, Linear, Medium, Surface};
use super::simplex::{Point, Simplex, pairs};
use signorini_fem::geometry::{COORDINATES, midpoint};
use signorini_fem::material::{Lame, Stiffness};
use signorini_qp::{Method, Settings};

/// The surface at the height `1 - 0.02 + (x - 0.4)^2` in the plane, `1 - 0.1 + (x - 0.4)^2 + (y - 0.4)^2` in space.
#[derive(Debug)]
pub struct Bowl(usize);

impl Distance for Bowl {
    fn gap(&self, corners: &[Point]) -> Option<Enclosure> {
        let height = self.0 - 1;
        let lowest = if height == 1 { 0.98 } else { 0.9 };
        let gap = |at: Point| lowest + at[..height].iter().map(|x| (x - 0.4) * (x - 0.4)).sum::<f64>() - at[height];
        let of_pair = |[i, j]: [usize; 2]| {
            let half = midpoint(corners[i], corners[j]);
            2.0 * gap(half) - (gap(corners[i]) + gap(corners[j])) / 2.0
        };
        let coefficients = pairs(corners.len()).map(of_pair).collect();
        Some(Enclosure { coefficients, below: 0.0, above: 0.0 })
    }
}

/// A body of one isotropic medium without any condition.
pub fn filled(dimension: usize, lame: Lame, body_force: Point) -> ContinuumProblem {
    ContinuumProblem {
        dimension,
        is_axisymmetric: false,
        media: vec![Medium { stiffness: Stiffness::Isotropic(lame), own_stress: None, body_force }],
        medium_of: vec![0],
        bodies: std::iter::once(0..1).collect(),
        thickness: 1.0,
        conditions: Vec::new(),
        rigid_faces: Vec::new(),
        obstacles: Vec::new(),
        boundaries: Vec::new(),
    }
}

/// Supports along all axes of a dimension.
pub fn clamped(dimension: usize) -> Vec<Held> {
    COORDINATES[..dimension].iter().map(|&direction| Held { direction, value: Linear::default() }).collect()
}

/// A square or a cube of side 1 on a clamped side, with a traction on the right, a body force, and a bowl above.
pub fn body(dimension: usize) -> (ContinuumProblem, SimplexMesh) {
    let side = |held: bool, traction: Point, obstacles: Vec<usize>| Condition {
        held: if held { clamped(dimension) } else { Vec::new() },
        traction: traction.map(Linear::constant),
        obstacles,
        ..Condition::default()
    };
    let body_force = if dimension == 2 { [0.01, -0.02, 0.0] } else { [0.01, -0.02, 0.015] };
    let problem = ContinuumProblem {
        thickness: if dimension == 2 { 0.5 } else { 1.0 },
        conditions: vec![
            side(true, [0.0; 3], vec![]),
            side(false, [0.03, 0.01, 0.0], vec![]),
            side(false, [0.0; 3], vec![0]),
            side(false, [0.0; 3], vec![]),
        ],
        obstacles: vec![Facing {
            normal: COORDINATES[dimension - 1],
            surface: Surface::Rigid(Arc::new(Bowl(dimension))),
            pressed: None,
        }],
        ..filled(dimension, Lame { lambda: 1.5, mu: 1.0 }, body_force)
    };
    let (bottom, top, right) = (2 * (dimension - 1), 2 * dimension - 1, 1);
    let mut cells = unit(dimension);
    for condition in cells.surface.values_mut() {
        *condition = [bottom, right, top].iter().position(|side| side == condition).unwrap_or(3);
    }
    cells.origins.fill(0);
    let mut mesh = SimplexMesh::new(dimension, cells).unwrap();
    for _ in 0..if dimension == 2 { 2 } else { 4 } {
        mesh = problem.refined(&mesh, &vec![true; mesh.count()]);
    }
    (problem, mesh)
}

/// The simplices of a square or a cube of side 1; the number of a condition is twice that of the axis across its side,
/// and one more if the side lies at 1.
pub fn unit(dimension: usize) -> Cells {
    let nodes = (0..1 << dimension).map(|node| [0, 1, 2].map(|axis| f64::from(node >> axis & 1))).collect();
    // Each order of the axes is the way of a simplex from the origin to the opposite corner.
    let orders: &[&[usize]] = match dimension {
        2 => &[&[0, 1, 3], &[0, 2, 3]],
        _ => &[&[0, 1, 3, 7], &[0, 1, 5, 7], &[0, 2, 3, 7], &[0, 2, 6, 7], &[0, 4, 5, 7], &[0, 4, 6, 7]],
    };
    let cells: Vec<Vec<usize>> = orders.iter().map(|order| order.to_vec()).collect();
    let facets =
        cells.iter().flat_map(|cell| (0..cell.len()).map(|local| [&cell[..local], &cell[local + 1..]].concat()));
    let side_of =
        |facet: &[usize]| (0..2 * dimension).find(|side| facet.iter().all(|&node| node >> (side / 2) & 1 == side % 2));
    let surface =
        facets.filter_map(|facet| Some((side_of(&facet)?, facet))).map(|(side, facet)| (facet, side)).collect();
    Cells { nodes, origins: (0..cells.len()).collect(), cells, surface }
}

/// A triangle or a tetrahedron of no special shape.
pub fn any_simplex(dimension: usize) -> Simplex {
    let plane = [[0.25, -0.5, 0.0], [2.0, 0.125, 0.0], [0.75, 1.5, 0.0]];
    let space = [[0.25, -0.5, 0.1], [2.0, 0.125, -0.2], [0.75, 1.5, 0.3], [0.5, 0.4, 1.7]];
    if dimension == 2 { Simplex::new(2, plane) } else { Simplex::new(3, space) }
}

/// The bracket of a problem on a mesh, with settings for an exact answer.
pub fn solved<'a>(problem: &'a ContinuumProblem, mesh: &'a SimplexMesh) -> Bracket<'a> {
    Bracket::new(problem, mesh, None, &settings()).unwrap()
}

/// Both energies of a bracket are this one, up to this share.
pub fn assert_energy(bracket: &Bracket, energy: f64, share: f64) {
    for found in [bracket.energy_of_stress(), bracket.energy_of_displacement()] {
        assert!((found / energy - 1.0).abs() < share, "{found} {energy}");
    }
}

/// Settings for an exact answer.
pub fn settings() -> Settings {
    Settings::with_method(Method::ActiveSet)
}

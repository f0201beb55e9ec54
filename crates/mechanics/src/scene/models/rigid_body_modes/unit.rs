//! The unit rigid-body modes of one body, and the names of their combinations.

use std::ops::Range;

use crate::fem::body::{ElasticBody, Region};
use crate::fem::dense::DenseMatrix;
use crate::fem::geometry::{COORDINATES, cross, minus, plus};
use crate::fem::mesh::extent;
use crate::scene::input::entry::{point, six_digits};
use signorini_qp::dot;

/// A part of a motion below this, relative to the whole, is left out of its name.
pub(super) const NAMED: f64 = 1e-6;

pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// Translations along x, y, z, and rotations about axes through the centre along x, y, z, as multiples of unit motions:
/// a rotation is measured by the displacement at the distance `size` from the axis.
pub(super) type Amplitudes = [f64; 6];

/// A sum of displacements along vectors: a node, the place that moves with it, and the vector.
pub(super) type Sum = Vec<(usize, [f64; 3], [f64; 3])>;

/// The form of the name of a motion: with or without its sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sense {
    Signed,
    Either,
}

/// The unit motions of a body; its centre and size make them comparable.
#[derive(Clone, Debug)]
pub(super) struct UnitMotions {
    /// The body's name; empty for the first.
    pub name: String,
    pub nodes: Range<usize>,
    centre: [f64; 3],
    size: f64,
    dimension: usize,
    /// The unit motions without strain energy: one in a bar and in a body of revolution, three in the plane, all six in
    /// space.
    pub modes: &'static [usize],
}

impl UnitMotions {
    pub fn of(body: &ElasticBody, region: &Region) -> Self {
        let (low, high) = extent(&body.mesh().nodes()[region.nodes()]);
        let modes: &[usize] = match body.dimension() {
            1 => &[0],
            2 if body.formulation().is_axisymmetric() => &[1],
            2 => &[0, 1, 5],
            _ => &[0, 1, 2, 3, 4, 5],
        };
        let span = minus(high, low);
        UnitMotions {
            name: region.name().into(),
            nodes: region.nodes(),
            centre: [0, 1, 2].map(|axis| low[axis] + span[axis] / 2.0),
            size: span[0].hypot(span[1]).hypot(span[2]) / 2.0,
            dimension: body.dimension(),
            modes,
        }
    }

    /// The unit motions of a rigid obstacle, given by its number; it moves along its approach direction.
    pub fn of_obstacle(index: usize, approach: [f64; 3], size: f64) -> Self {
        let modes: &[usize] = match approach.map(|component| component != 0.0) {
            [true, ..] => &[0],
            [_, true, _] => &[1],
            _ => &[2],
        };
        UnitMotions { name: format!("obstacles[{index}]"), nodes: 0..0, centre: [0.0; 3], size, dimension: 3, modes }
    }

    /// The displacement of unit motion `mode` at a point.
    fn at(&self, mode: usize, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = [0, 1, 2].map(|axis| (point[axis] - self.centre[axis]) / self.size);
        match mode {
            0..=2 => COORDINATES[mode],
            3 => [0.0, -z, y],
            4 => [z, 0.0, -x],
            _ => [-y, x, 0.0],
        }
    }

    /// The component along `direction` of each unit motion at a point; zero for motions that the body does not have.
    pub fn along(&self, point: [f64; 3], direction: [f64; 3]) -> Amplitudes {
        let mut components = [0.0; 6];
        for &mode in self.modes {
            components[mode] = dot(&self.at(mode, point), &direction);
        }
        components
    }

    /// The component of each unit motion in a sum of displacements.
    pub fn in_sum(&self, sum: &Sum) -> Amplitudes {
        let mut components = [0.0; 6];
        for &(_, at, vector) in sum.iter().filter(|(node, ..)| self.nodes.contains(node)) {
            components.iter_mut().zip(self.along(at, vector)).for_each(|(component, part)| *component += part);
        }
        components
    }

    /// The displacements of nodes at these places in a motion.
    pub fn nodal(&self, places: &[[f64; 3]], amplitudes: &Amplitudes) -> impl Iterator<Item = [f64; 3]> {
        places.iter().map(|&place| {
            let parts = self.modes.iter().map(|&mode| self.at(mode, place).map(|part| amplitudes[mode] * part));
            parts.fold([0.0; 3], plus)
        })
    }

    /// The amplitudes closest to a motion of `nodes` (`dim` entries each) by least squares, and the length of the rest.
    pub fn fit(&self, nodes: &[[f64; 3]], motion: &[f64]) -> (Amplitudes, f64) {
        let of_dof = |dof: usize| self.along(nodes[dof / self.dimension], COORDINATES[dof % self.dimension]);
        let components: Vec<Amplitudes> = (0..motion.len()).map(of_dof).collect();
        let design =
            DenseMatrix::from_fn(motion.len(), self.modes.len(), |dof, mode| components[dof][self.modes[mode]]);
        let fitted = design.clone().singular_values().solve(motion, f64::EPSILON);
        let mut amplitudes = [0.0; 6];
        self.modes.iter().zip(&fitted).for_each(|(&mode, &amount)| amplitudes[mode] = amount);
        let off: Vec<f64> = design.mul(&fitted).iter().zip(motion).map(|(fitted, own)| fitted - own).collect();
        (amplitudes, dot(&off, &off).sqrt())
    }

    pub fn describe(&self, &[x, y, z, a, b, c]: &Amplitudes, sense: Sense) -> String {
        let (shift, turn) = ([x, y, z], [a, b, c]);
        let (distance, angle) = (dot(&shift, &shift).sqrt(), dot(&turn, &turn).sqrt());
        let sign = |part: f64| if sense == Sense::Signed && part < 0.0 { "-" } else { "" };
        if angle <= NAMED * distance.hypot(angle) {
            return match along_one_axis(shift) {
                Some(axis) => format!("translation along {}{}", sign(shift[axis]), AXES[axis]),
                None => format!("translation along {}", direction(&shift[..self.dimension])),
            };
        }
        let axis = along_one_axis(turn).map_or_else(|| direction(&turn), |axis| AXES[axis].into());
        // The pole: there translation and rotation cancel, except the part along the axis.
        let pole = cross(turn, shift).map(|part| part / (angle * angle) * self.size);
        let tidy = [0, 1, 2].map(|axis| {
            let at = self.centre[axis] + pole[axis];
            if at.abs() <= NAMED * self.size { 0.0 } else { six_digits(at) }
        });
        let pitch = dot(&shift, &turn).abs() > NAMED * angle * distance.hypot(angle);
        let along = if pitch { ", with a translation along it" } else { "" };
        format!("rotation about {axis} through {}{along}", point(&tidy[..self.dimension]))
    }
}

/// The axis of a vector along one axis, up to rounding.
fn along_one_axis(vector: [f64; 3]) -> Option<usize> {
    let length = dot(&vector, &vector).sqrt();
    (0..3).find(|&axis| (0..3).all(|other| other == axis || vector[other].abs() <= NAMED * length))
}

/// A direction of length 1 in words.
fn direction(vector: &[f64]) -> String {
    let length = dot(vector, vector).sqrt();
    // Adding zero removes the sign of a component that is rounded to zero.
    let three_digits = |part: &f64| (part / length * 1e3).round() / 1e3 + 0.0;
    let components: Vec<String> = vector.iter().map(|part| format!("{:.3}", three_digits(part))).collect();
    format!("({})", components.join(", "))
}

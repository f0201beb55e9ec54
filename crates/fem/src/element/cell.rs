//! One cell in place: x = sum N_a x_a, the Jacobian J = dx/dxi, gradients dN/dx, area vectors.

use super::{MAX_NODES, PerNode, ReferenceElement, Tabulated};
use crate::geometry::{COORDINATES, cross, dot, plus, shifted};

/// The Jacobian of an element that is inverted or has no volume.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the Jacobian determinant is {value:e} at its local node or quadrature point {point}; {}", fault(*.value))]
pub struct NonPositiveJacobian {
    /// The smallest determinant, relative to the element's size to the power of its dimension.
    pub value: f64,
    /// The worst point: local nodes first, then quadrature points, from 0.
    pub point: usize,
}

/// Determinants below this, relative to the element's size to the power of its dimension, are rounding: the element has
/// no volume.
const NO_VOLUME: f64 = 1e-14;

fn fault(determinant: f64) -> String {
    match determinant > 0.0 {
        true => format!(
            "relative to the size of the element it must exceed {NO_VOLUME:e}, the rounding of double precision: the element is too \
             thin for its length"
        ),
        false => "it must be positive: the element is flat, folded or turned over".into(),
    }
}

/// Steps of Newton's method to the reference coordinates of a point: a straight cell takes one, a curved cell a few.
const LOCATING_STEPS: usize = 20;

/// The iteration ends when the reference coordinates move by less than this.
const LOCATED: f64 = 1e-14;

/// A reference cell with the coordinates of its nodes.
///
/// The coordinates are stored relative to the first node and in a unit: the power of two next to the cell's size. A
/// change of the unit of length by a power of two then changes no bit of the results, and no size overflows in between.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    reference: &'static ReferenceElement,
    coordinates: PerNode<[f64; 3]>,
    origin: [f64; 3],
    unit: f64,
}

/// The map from the reference cell at one point, in the unit of the cell.
#[derive(Clone, Copy, Debug)]
pub struct Mapping {
    /// Gradients of the shape functions, per unit.
    pub gradients: PerNode<[f64; 3]>,
    pub determinant: f64,
}

/// The inverse of the map at one point, in the unit of the cell.
#[derive(Clone, Copy, Debug)]
pub struct InverseMap {
    /// The columns of J^-1 times `determinant`.
    pub cofactors: [[f64; 3]; 3],
    /// det J.
    pub determinant: f64,
}

impl Cell {
    /// The cell `reference` at the `coordinates` (x, y, z) of its nodes, by their local numbers.
    #[inline]
    pub fn at(reference: &'static ReferenceElement, coordinates: impl Fn(usize) -> [f64; 3]) -> Self {
        let origin = coordinates(0);
        let mut cell = Cell { reference, coordinates: [[0.0; 3]; MAX_NODES], origin, unit: 1.0 };
        let relative = &mut cell.coordinates[..reference.nodes.len()];
        let mut size: f64 = 0.0;
        for (local, at) in relative.iter_mut().enumerate() {
            let node = coordinates(local);
            *at = [node[0] - origin[0], node[1] - origin[1], node[2] - origin[2]];
            size = size.max(at[0].abs()).max(at[1].abs()).max(at[2].abs());
        }
        // The exponent bits alone are the power of two at or below the size.
        let power = f64::from_bits(size.to_bits() & (0x7ff << 52));
        if power.is_normal() {
            cell.unit = power;
            for at in relative {
                *at = [at[0] / power, at[1] / power, at[2] / power];
            }
        }
        cell
    }

    pub fn nodes(&self) -> usize {
        self.reference.nodes.len()
    }

    /// The unit of the cell: a power of two, in the unit of length of the coordinates.
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// The point with the given shape function values, in the unit of length of the coordinates.
    #[inline]
    pub fn place(&self, shape: &PerNode<f64>) -> [f64; 3] {
        let mut at = [0.0; 3];
        for (value, node) in shape.iter().zip(&self.coordinates).take(self.reference.nodes.len()) {
            at = shifted(at, *value, *node);
        }
        shifted(self.origin, self.unit, at)
    }

    /// The values of the shape functions at a point, one for each node; `None` if the point is outside the cell by more
    /// than `tolerance`, in reference coordinates.
    pub fn weights_at(&self, point: [f64; 3], tolerance: f64) -> Option<PerNode<f64>> {
        let (reference, at) = (self.reference, self.reference_coordinates(point));
        let weights = (reference.shape)(at);
        let place = self.place(&weights);
        // The point is not on the line or in the plane of the cell: no reference coordinates lead to it.
        let is_met = (0..3).all(|axis| (point[axis] - place[axis]).abs() <= tolerance * self.unit);
        (is_met && reference.contains(at, tolerance)).then_some(weights)
    }

    /// The reference coordinates of a point in or near the cell, by Newton's method.
    pub fn reference_coordinates(&self, point: [f64; 3]) -> [f64; 3] {
        let reference = self.reference;
        let mut at = reference.centroid();
        for _ in 0..LOCATING_STEPS {
            let place = self.place(&(reference.shape)(at));
            let away = [0, 1, 2].map(|axis| (point[axis] - place[axis]) / self.unit);
            // The shape functions reproduce every linear function, also the reference coordinates: their gradients
            // invert the Jacobian.
            let gradients = self.map(&(reference.derivative)(at)).gradients;
            let mut change = [0.0; 3];
            for (node, gradient) in reference.nodes.iter().zip(gradients) {
                change = shifted(change, dot(gradient, away), *node);
            }
            at = plus(at, change);
            if change.iter().all(|step| step.abs() <= LOCATED) {
                break;
            }
        }
        at
    }

    /// Checks that the determinant of the Jacobian is positive at the quadrature points of `table`, and not zero at the
    /// nodes; returns the worst node at which it is negative, if there is one.
    pub fn check(&self, table: &Tabulated) -> Result<Option<NonPositiveJacobian>, NonPositiveJacobian> {
        let determinants = table.nodes.iter().chain(&table.points).enumerate().map(|(point, tabulated)| {
            let value = determinant(&self.jacobian(&tabulated.derivative), self.reference.dimension);
            NonPositiveJacobian { value, point }
        });
        let worst = |one: NonPositiveJacobian, other: NonPositiveJacobian| {
            // A determinant that is not a number is not positive either.
            if one.value.is_nan() || one.value <= other.value { one } else { other }
        };
        let Some(found) =
            determinants.clone().reduce(worst).filter(|found| found.value.is_nan() || found.value <= NO_VOLUME)
        else {
            return Ok(None);
        };
        let is_solved = |one: NonPositiveJacobian| {
            if one.point < table.nodes.len() { one.value.abs() > NO_VOLUME } else { one.value > NO_VOLUME }
        };
        if determinants.into_iter().all(is_solved) { Ok(Some(found)) } else { Err(found) }
    }

    /// J_ij = dx_j/dxi_i, in the unit of the cell: the tangents along the reference coordinates.
    #[inline]
    pub fn jacobian(&self, derivative: &PerNode<[f64; 3]>) -> [[f64; 3]; 3] {
        let mut jacobian = [[0.0; 3]; 3];
        for (slope, x) in derivative.iter().zip(&self.coordinates).take(self.reference.nodes.len()) {
            for i in 0..3 {
                for j in 0..3 {
                    jacobian[i][j] += slope[i] * x[j];
                }
            }
        }
        jacobian
    }

    /// Gradients and determinant at the point with the given shape function derivatives; the cell has the dimension of
    /// its space.
    #[inline]
    pub fn map(&self, derivative: &PerNode<[f64; 3]>) -> Mapping {
        let dimension = self.reference.dimension;
        let InverseMap { cofactors, determinant } = self.inverse(derivative);
        let mut gradients = [[0.0; 3]; MAX_NODES];
        for (gradient, slope) in gradients.iter_mut().zip(derivative).take(self.reference.nodes.len()) {
            for axis in 0..dimension {
                let sum = cofactors[0][axis] * slope[0] + cofactors[1][axis] * slope[1] + cofactors[2][axis] * slope[2];
                gradient[axis] = sum / determinant;
            }
        }
        Mapping { gradients, determinant }
    }

    #[inline]
    fn inverse(&self, derivative: &PerNode<[f64; 3]>) -> InverseMap {
        match self.reference.dimension {
            1 => self.inverse_in::<1>(derivative),
            2 => self.inverse_in::<2>(derivative),
            _ => self.inverse_in::<3>(derivative),
        }
    }

    #[inline]
    fn inverse_in<const D: usize>(&self, derivative: &PerNode<[f64; 3]>) -> InverseMap {
        let mut j = [[0.0; 3]; 3];
        for (slope, x) in derivative.iter().zip(&self.coordinates).take(self.reference.nodes.len()) {
            for (row, slope) in j.iter_mut().zip(slope).take(D) {
                row.iter_mut().zip(x).take(D).for_each(|(entry, x)| *entry += slope * x);
            }
        }
        let cofactors = match D {
            1 => [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]],
            2 => [[j[1][1], -j[1][0], 0.0], [-j[0][1], j[0][0], 0.0], [0.0; 3]],
            _ => [cross(j[1], j[2]), cross(j[2], j[0]), cross(j[0], j[1])],
        };
        InverseMap { cofactors, determinant: determinant(&j, D) }
    }

    /// The derivative of each component of nodal `values` along each axis, per unit, `[i][k]`: component i along axis
    /// k; and the inverse of the map there. The same for all nodes gives exactly zero.
    #[inline]
    pub fn slope(&self, derivative: &PerNode<[f64; 3]>, values: &PerNode<[f64; 3]>) -> ([[f64; 3]; 3], InverseMap) {
        match self.reference.dimension {
            1 => self.slope_in::<1>(derivative, values),
            2 => self.slope_in::<2>(derivative, values),
            _ => self.slope_in::<3>(derivative, values),
        }
    }

    #[inline]
    fn slope_in<const D: usize>(
        &self,
        derivative: &PerNode<[f64; 3]>,
        values: &PerNode<[f64; 3]>,
    ) -> ([[f64; 3]; 3], InverseMap) {
        let inverse = self.inverse_in::<D>(derivative);
        let mut along = [[0.0; 3]; 3];
        for (slope, value) in derivative.iter().zip(values).take(self.reference.nodes.len()).skip(1) {
            for (axis, along) in along.iter_mut().enumerate().take(D) {
                let relative = value[axis] - values[0][axis];
                along.iter_mut().zip(slope).take(D).for_each(|(sum, slope)| *sum += relative * slope);
            }
        }
        let mut slope = [[0.0; 3]; 3];
        for (row, along) in slope.iter_mut().zip(along).take(D) {
            for (k, entry) in row.iter_mut().enumerate().take(D) {
                *entry = (0..D).map(|i| along[i] * inverse.cofactors[i][k]).sum::<f64>() / inverse.determinant;
            }
        }
        (slope, inverse)
    }

    /// The area vector of a facet at the point with the given shape function derivatives: normal to the facet; its
    /// length is the ratio of area in place (in powers of the unit of the cell) to area on the reference cell.
    ///
    /// It points to the right of an edge that runs along its nodes; to the side from which a face's nodes are
    /// counterclockwise; along x for a point.
    pub fn area_vector(&self, derivative: &PerNode<[f64; 3]>) -> [f64; 3] {
        let tangents = self.jacobian(derivative);
        match self.reference.dimension {
            0 => [1.0, 0.0, 0.0],
            1 => [tangents[0][1], -tangents[0][0], 0.0],
            _ => cross(tangents[0], tangents[1]),
        }
    }

    /// The change of `along . area vector` with the place of each node of a facet, both in the unit of the cell.
    pub fn area_vector_by_places(&self, derivative: &PerNode<[f64; 3]>, along: [f64; 3]) -> PerNode<[f64; 3]> {
        let tangents = self.jacobian(derivative);
        // An edge is a face with the second tangent along z.
        let turned = match self.reference.dimension {
            0 => [[0.0; 3]; 2],
            1 => [cross(COORDINATES[2], along), [0.0; 3]],
            _ => [cross(tangents[1], along), cross(along, tangents[0])],
        };
        derivative.map(|slope| [0, 1, 2].map(|axis| slope[0] * turned[0][axis] + slope[1] * turned[1][axis]))
    }
}

/// Determinant of the leading `dimension` rows and columns.
#[inline]
fn determinant(j: &[[f64; 3]; 3], dimension: usize) -> f64 {
    match dimension {
        1 => j[0][0],
        2 => j[0][0] * j[1][1] - j[0][1] * j[1][0],
        _ => {
            let minor = cross(j[1], j[2]);
            j[0][0] * minor[0] + j[0][1] * minor[1] + j[0][2] * minor[2]
        }
    }
}

//! Shape functions tabulated once, for all elements of a mesh; extrapolation from quadrature points to nodes.

use super::{Part, PerNode, QuadraturePoint, ReferenceElement, Shape, quadrature};
use crate::fem::dense::DenseMatrix;

/// The shape functions at one reference point.
#[derive(Clone, Copy, Debug)]
pub struct TabulatedPoint {
    /// Quadrature weight; zero if the point belongs to no rule.
    pub weight: f64,
    pub shape: PerNode<f64>,
    /// Derivatives with respect to the reference coordinates.
    pub derivative: PerNode<[f64; 3]>,
}

impl TabulatedPoint {
    /// The shape functions of `reference` at the reference point `at`.
    pub fn new(reference: &ReferenceElement, at: [f64; 3], weight: f64) -> Self {
        TabulatedPoint { weight, shape: (reference.shape)(at), derivative: (reference.derivative)(at) }
    }
}

/// The quadrature of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The rule for bars, plane models and space.
    Straight,
    /// The rule for bodies of revolution: the radius adds one degree.
    Revolved,
}

/// The shape functions of an element at the points of a quadrature rule, at its nodes and its centroid.
#[derive(Clone, Debug)]
pub struct Tabulated {
    /// The element whose shape functions are tabulated.
    pub reference: &'static ReferenceElement,
    /// At the quadrature points.
    pub points: Vec<TabulatedPoint>,
    /// At the nodes.
    pub nodes: Vec<TabulatedPoint>,
    /// At the centroid, with the weight of the whole element.
    pub centroid: TabulatedPoint,
    rule: Vec<QuadraturePoint>,
}

impl Tabulated {
    /// Tabulates `reference` at the points of its quadrature.
    pub fn new(reference: &'static ReferenceElement, rule: Rule) -> Self {
        let rule = match rule {
            Rule::Straight => reference.quadrature,
            Rule::Revolved => reference.quadrature_revolved,
        };
        Self::with_rule(reference, rule.to_vec())
    }

    /// Tabulates `reference` at five points in each direction, for functions that are not polynomials of the element.
    pub fn fine(reference: &'static ReferenceElement) -> Self {
        Self::fine_in(reference, Part::WHOLE)
    }

    /// Tabulates a part of `reference` at five points in each direction.
    pub fn fine_in(reference: &'static ReferenceElement, part: Part) -> Self {
        Self::with_rule(reference, quadrature::fine(reference.form, reference.dimension, part))
    }

    /// Tabulates `reference` at the points of a quadrature rule for it.
    pub fn with_rule(reference: &'static ReferenceElement, rule: Vec<QuadraturePoint>) -> Self {
        let at = |at: [f64; 3], weight| TabulatedPoint::new(reference, at, weight);
        Tabulated {
            reference,
            points: rule.iter().map(|point| at(point.at, point.weight)).collect(),
            nodes: reference.nodes.iter().map(|&node| at(node, 0.0)).collect(),
            centroid: at(reference.centroid(), rule.iter().map(|point| point.weight).sum()),
            rule,
        }
    }

    /// The weights that carry values at the quadrature points to the nodes, n_nodes x n_points: the least-squares fit
    /// of a linear function (multilinear on a product of intervals; a constant if there is only one point).
    pub fn extrapolation(&self) -> DenseMatrix {
        let basis = |at: [f64; 3]| -> Vec<f64> {
            let dimension = self.reference.dimension;
            match self.reference.form {
                _ if self.rule.len() <= dimension => vec![1.0],
                Shape::Simplex => [1.0].into_iter().chain(at.into_iter().take(dimension)).collect(),
                Shape::Product => (0..1_usize << dimension)
                    .map(|choice| (0..dimension).filter(|axis| choice >> axis & 1 == 1).map(|axis| at[axis]).product())
                    .collect(),
            }
        };
        let rows = |points: Vec<[f64; 3]>| {
            let rows: Vec<Vec<f64>> = points.into_iter().map(basis).collect();
            DenseMatrix::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
        };
        let at_points = rows(self.rule.iter().map(|point| point.at).collect());
        let at_nodes = rows(self.reference.nodes.to_vec());
        let (points, fit) = (self.rule.len(), at_points.singular_values());
        let of_point = |point: usize| {
            let mut one = vec![0.0; points];
            one[point] = 1.0;
            at_nodes.mul(&fit.solve(&one, f64::EPSILON))
        };
        let weights: Vec<Vec<f64>> = (0..points).map(of_point).collect();
        DenseMatrix::from_fn(self.reference.nodes.len(), points, |node, point| weights[point][node])
    }
}

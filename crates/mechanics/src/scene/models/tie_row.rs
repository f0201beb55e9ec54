//! One equation of a tie.

use std::collections::BTreeMap;
use std::ops::Range;

use super::unknowns::Unknowns;
use crate::fem::assembly::DofMap;
use crate::scene::input::sum::Component;

/// A sum of `vector . u` over nodes in the unknowns, and its prescribed part, in length.
pub(crate) fn in_unknowns(
    terms: &[(usize, [f64; 3])],
    (dofs, unknowns): (&DofMap, &Unknowns),
    dimension: usize,
) -> (Vec<(usize, f64)>, f64) {
    let (mut entries, mut prescribed) = (Vec::new(), 0.0);
    for (node, vector) in terms {
        let (free, part) = unknowns.along(dofs, *node, &vector[..dimension]);
        entries.extend(free);
        prescribed += part;
    }
    (entries, prescribed)
}

/// One equation: the sum of `vector . u` over its terms is `value`.
#[derive(Clone, Debug)]
pub(crate) struct TieRow {
    /// Nodes with their vectors [x, y, z], dimensionless; at a node with a coefficient for the coefficient.
    pub terms: Vec<(usize, [f64; 3])>,
    /// The terms of the nodes of the first side.
    pub own: Range<usize>,
    /// The place at which two surfaces are tied; `None` for an equation between nodes.
    pub at: Option<[f64; 3]>,
    pub value: f64,
    /// The coefficients of the prescribed components of reference points, which are in the value, and the shares of
    /// equations at points that the row has taken up.
    pub on_points: BTreeMap<Component, f64>,
}

impl TieRow {
    /// The difference of two rows of the same sides with the value 0.
    pub fn minus(&self, other: &TieRow) -> TieRow {
        let negative = |terms: &[(usize, [f64; 3])]| -> Vec<(usize, [f64; 3])> {
            terms.iter().map(|&(node, vector)| (node, vector.map(|part| 0.0 - part))).collect()
        };
        let [(own, across), (of_own, of_across)] = [self, other].map(|row| row.terms.split_at(row.own.end));
        let terms = [own, &negative(of_own), across, &negative(of_across)].concat();
        TieRow { terms, own: 0..own.len() + of_own.len(), at: self.at, value: 0.0, on_points: BTreeMap::new() }
    }

    /// Its nodes, each with a node of the other side.
    pub fn sides(&self) -> impl Iterator<Item = (usize, usize)> {
        let (first, second) = self.terms.split_at(self.own.end);
        [(first, second), (second, first)]
            .into_iter()
            .flat_map(|(side, other)| side.iter().zip(std::iter::repeat(other.first())))
            .filter_map(|(term, other)| Some((term.0, other?.0)))
    }
}

//! Linear forms in the displacements of nodes: rows of contact and of ties, shortenings, elongations.

use super::{Along, DofMap};

/// A node with a vector [x, y, z], for the product with its displacement.
pub type Term = (usize, [f64; 3]);

/// A linear form in the displacements of nodes: the sum of `vector . u` over its terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearForm {
    /// At a node with a coefficient for the coefficient.
    pub terms: Vec<Term>,
    /// How many of the terms, the first ones, belong to its own side.
    pub own: usize,
}

impl LinearForm {
    /// The sum of `share * (vector . u)` over nodes with their shares, of which the first `own` are its own side.
    pub fn along(vector: [f64; 3], shares: &[(usize, f64)], own: usize) -> Self {
        let terms = shares.iter().map(|&(node, share)| (node, vector.map(|part| share * part))).collect();
        LinearForm { terms, own }
    }

    /// The terms of its own side, and those of the other.
    pub fn sides(&self) -> [&[Term]; 2] {
        self.terms.split_at(self.own).into()
    }

    /// The difference of two forms of the same sides.
    pub fn minus(&self, other: &LinearForm) -> Self {
        let negative = |&(node, vector): &Term| (node, vector.map(|part| 0.0 - part));
        let ([own, across], [of_own, of_across]) = (self.sides(), other.sides().map(|side| side.iter().map(negative)));
        let own_first = own.iter().copied().chain(of_own.clone());
        let terms = own_first.chain(across.iter().copied()).chain(of_across).collect();
        LinearForm { terms, own: own.len() + of_own.len() }
    }

    /// The form in the unknowns.
    pub fn through(&self, dofs: &DofMap, dimension: usize) -> Along {
        let mut sum = Along::default();
        for (node, vector) in &self.terms {
            let along = dofs.along(*node, &vector[..dimension]);
            sum.free.extend(along.free);
            sum.prescribed += along.prescribed;
        }
        sum
    }

    /// Calls `add` with the force of each term that does the work of `size` along the form.
    pub fn forces(&self, size: f64, mut add: impl FnMut(usize, [f64; 3])) {
        self.terms.iter().for_each(|&(node, vector)| add(node, vector.map(|part| size * part)));
    }
}

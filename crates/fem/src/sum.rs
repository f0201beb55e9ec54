//! Linear forms in displacements, which rows bound, equations set to zero and springs resist: sums over nodes, and sums
//! of components of nodes and reference points.

use std::collections::BTreeMap;

use crate::geometry::{COORDINATES, cross, dot, inertia, minus, principal, trace};

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

    /// Calls `add` with the force of each term that does the work of `size` along the form.
    pub fn forces(&self, size: f64, mut add: impl FnMut(usize, [f64; 3])) {
        self.terms.iter().for_each(|&(node, vector)| add(node, vector.map(|part| size * part)));
    }
}

/// A component of a node or of a reference point: its number, then 0 to 2 for its displacements along x, y, z and 3 to
/// 5 for its rotations about them, which points alone have.
pub type Component = (usize, usize);

/// A determinant of the moments of inertia below this share of the cube of their sum is rounding: the nodes lie on a
/// line.
const ON_LINE: f64 = 1e-12;

/// A coefficient that a difference leaves below this share of its parts is rounding.
const CANCELLED: f64 = 1e-13;

/// A sum of components with coefficients and of a constant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sum {
    pub terms: BTreeMap<Component, f64>,
    /// The components that are replaced by their values, with their coefficients.
    pub replaced: BTreeMap<Component, f64>,
    pub constant: f64,
    /// The largest part of the constant.
    pub scale: f64,
}

impl Sum {
    /// Adds a component with a coefficient; coefficients of one component add up.
    pub fn add(&mut self, component: Component, coefficient: f64) {
        let old = self.terms.get(&component).copied().unwrap_or(0.0);
        let sum = old + coefficient;
        match sum.abs() <= CANCELLED * old.abs().max(coefficient.abs()) {
            true => _ = self.terms.remove(&component),
            false => _ = self.terms.insert(component, sum),
        }
    }

    /// Adds a displacement of a node along a vector.
    pub fn add_along(&mut self, node: usize, vector: [f64; 3]) {
        vector.into_iter().enumerate().for_each(|(axis, part)| self.add((node, axis), part));
    }

    /// Calls a component by another name.
    pub fn rename(&mut self, component: Component, name: Component) {
        if let Some(coefficient) = self.terms.remove(&component) {
            self.add(name, coefficient);
        }
    }

    /// Replaces a component by its value.
    pub fn insert(&mut self, component: Component, value: f64) {
        if let Some(coefficient) = self.terms.remove(&component) {
            self.replaced.insert(component, coefficient);
            self.constant += coefficient * value;
            self.scale = self.scale.max((coefficient * value).abs());
        }
    }

    /// Replaces a component by the one with which another sum, which has it, is zero.
    pub fn eliminate(&mut self, component: Component, zero: &Sum) {
        if let Some(coefficient) = self.terms.get(&component) {
            self.add_multiple(-coefficient / zero.terms[&component], zero);
            self.terms.remove(&component);
        }
    }

    /// Adds a multiple of another sum.
    pub fn add_multiple(&mut self, factor: f64, other: &Sum) {
        other.terms.iter().for_each(|(component, coefficient)| self.add(*component, factor * coefficient));
        for (component, coefficient) in &other.replaced {
            *self.replaced.entry(*component).or_default() += factor * coefficient;
        }
        self.constant += factor * other.constant;
        self.scale = self.scale.max((factor * other.scale).abs());
    }

    /// The coefficient of a component over the largest of all; 0 if it does not occur.
    pub fn share(&self, component: Component) -> f64 {
        let Some(own) = self.terms.get(&component) else { return 0.0 };
        own.abs() / self.terms.values().fold(0.0, |largest: f64, coefficient| largest.max(coefficient.abs()))
    }

    /// Its nodes, each with the vector of its displacement.
    pub fn vectors(&self) -> BTreeMap<usize, [f64; 3]> {
        let mut vectors: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
        for (&(node, axis), coefficient) in self.terms.iter().filter(|(component, _)| component.1 < 3) {
            vectors.entry(node).or_default()[axis] = *coefficient;
        }
        vectors
    }
}

/// The sums that are zero if a node follows a rigid motion along some axes: u_k - U_k - (R x r)_k, with r from the
/// reference point at `centre` and rotations R about the axes `turns`.
pub fn following(
    (node, at): (usize, [f64; 3]),
    (point, centre): (usize, [f64; 3]),
    axes: &[usize],
    turns: &[usize],
) -> Vec<Sum> {
    let away = minus(at, centre);
    let along = |&axis: &usize| {
        let mut sum = Sum::default();
        sum.add((node, axis), 1.0);
        sum.add((point, axis), -1.0);
        turns.iter().for_each(|&about| sum.add((point, 3 + about), -cross(COORDINATES[about], away)[axis]));
        sum
    };
    axes.iter().map(along).collect()
}

/// The sums that are zero if a reference point follows the mean motion of nodes with their areas and places, in the
/// components `kinds`; `None` for nodes on a line if it turns with them.
///
/// A force F and a moment M at the point become the forces w (F + (T^-1 M') x r) on the nodes, with the share w of a
/// node in the area, its distance r from the centre of area, T = sum of w (r.r I - r r'), and the moment M' about the
/// centre. The work of these forces is that of F and M, so that U and R are means of the displacements of the nodes.
pub fn mean(
    areas: &[(usize, f64, [f64; 3])],
    (point, at): (usize, [f64; 3]),
    kinds: &[usize],
    is_plane: bool,
) -> Option<Vec<Sum>> {
    let whole: f64 = areas.iter().map(|(_, area, _)| area).sum();
    let nodes: Vec<(usize, f64, [f64; 3])> = areas.iter().map(|&(node, area, at)| (node, area / whole, at)).collect();
    let mean = |axis: usize| nodes.iter().map(|(_, share, at)| share * at[axis]).sum::<f64>();
    let centre = [0, 1, 2].map(mean);
    let mut of_area = [0.0; 6];
    for (_, share, at) in &nodes {
        of_area.iter_mut().zip(inertia(minus(*at, centre))).for_each(|(sum, part)| *sum += share * part);
    }
    if is_plane {
        // Only the rotation about z exists.
        of_area = [of_area[2], of_area[2], of_area[2], 0.0, 0.0, 0.0];
    }
    let lever = minus(at, centre);
    let moment = |kind: usize| match COORDINATES[kind % 3] {
        about if kind >= 3 => about,
        along if is_plane => [0.0, 0.0, cross(lever, along)[2]],
        along => cross(lever, along),
    };
    let determinant = |of: &[(f64, [f64; 3]); 3]| of.iter().map(|(about, _)| about).product::<f64>();
    let has_extent = |of: &_| determinant(of) > ON_LINE * trace(&of_area).powi(3);
    let principal = principal(&of_area).filter(has_extent);
    let of_kind = |&kind: &usize| {
        let moment = moment(kind);
        let turn = match &principal {
            None if moment == [0.0; 3] => [0.0; 3],
            of_area => {
                let part = |(about, along): (f64, [f64; 3]), axis: usize| dot(along, moment) / about * along[axis];
                of_area.as_ref().map(|all| [0, 1, 2].map(|axis| all.iter().map(|&one| part(one, axis)).sum::<f64>()))?
            }
        };
        let force = if kind < 3 { COORDINATES[kind] } else { [0.0; 3] };
        let mut sum = Sum::default();
        sum.add((point, kind), -1.0);
        for &(node, share, at) in &nodes {
            let by_turn = cross(turn, minus(at, centre));
            sum.add_along(node, [0, 1, 2].map(|axis| share * (force[axis] + by_turn[axis])));
        }
        Some(sum)
    };
    kinds.iter().map(of_kind).collect()
}

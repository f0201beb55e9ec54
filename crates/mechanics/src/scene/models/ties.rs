//! Ties of a scene: linear equations E u = e between displacements.

use std::ops::Range;

use super::facing::Facing;
use super::preload::Shortening;
use super::tie_row::{TieRow, in_unknowns};
use super::unknowns::Unknowns;
use crate::error::Error;
use crate::fem::assembly::DofMap;
use crate::fem::body::ElasticBody;
use crate::scene::Warning;
use crate::scene::input::entry::{COORDINATE_ROUNDING, boundary, finite, node_at, nodes_named_once, number, wrong};
use crate::scene::input::obstacle::SideOrder;
use crate::scene::input::schema::{EquationSpec, Place, PreloadSpec, Scene, TermSpec, TieSpec, TiedSurfacesSpec};
use signorini_qp::SparseMatrix;

/// An equation of which less than this share is left by others follows from them: far above the rounding of integrals
/// over facets.
const REPEATED: f64 = 1e-9;

/// All ties of a scene in the unknowns.
#[derive(Debug)]
pub(crate) struct Ties {
    pub rows: Vec<TieRow>,
    /// The rows of each tie of the scene.
    pub of_tie: Vec<Range<usize>>,
    /// Of each tie of surfaces the one that takes the means, 0 or 1, and how much of it is tied, from 0 to 1.
    pub covered: Vec<Option<(usize, f64)>>,
    /// E, a row for each of `rows`, dimensionless.
    pub matrix: SparseMatrix,
    /// e, in length.
    pub values: Vec<f64>,
    /// One for each preload.
    pub shortenings: Vec<Shortening>,
    pub warnings: Vec<Warning>,
}

impl Ties {
    /// The same without equations that follow from others, as where three bodies meet that are tied to each other.
    fn without_repeated(self) -> Self {
        let stays = self.matrix.independent_rows(&self.values, REPEATED);
        let before = |row: usize| stays.partition_point(|&own| own < row);
        Ties {
            rows: stays.iter().map(|&row| self.rows[row].clone()).collect(),
            of_tie: self.of_tie.iter().map(|rows| before(rows.start)..before(rows.end)).collect(),
            covered: self.covered,
            matrix: self.matrix.select_rows(&stays),
            values: stays.iter().map(|&row| self.values[row]).collect(),
            shortenings: self.shortenings,
            warnings: self.warnings,
        }
    }
}

impl Scene {
    /// The ties, without equations that supports alone fulfil.
    ///
    /// # Errors
    /// [`Error::Scene`] for a boundary or a node that does not exist, surfaces that do not face each other, an equation
    /// without terms, and for one that supports contradict.
    pub(crate) fn tied(&self, body: &ElasticBody, dofs: &DofMap, unknowns: &Unknowns) -> Result<Ties, Error> {
        if !self.ties.is_empty() && self.dynamic().is_some() {
            return Err(wrong("ties", "ties are for equilibria only; a motion has only supports"));
        }
        let surfaces = self.tied_surfaces().flatten().filter_map(|name| body.mesh().boundary(name));
        let order = SideOrder::of(body, surfaces);
        let (mut rows, mut of_tie, mut warnings) = (Vec::new(), Vec::with_capacity(self.ties.len()), Vec::new());
        let mut covered = vec![None; self.ties.len()];
        let (mut entries, mut values, mut shortenings) = (Vec::new(), Vec::new(), Vec::new());
        let (dimension, rounding) = (body.dimension(), COORDINATE_ROUNDING * body.mesh().size());
        for (index, tie) in self.ties.iter().enumerate() {
            let path = format!("ties[{index}]");
            let found = match tie {
                TieSpec::Surfaces(TiedSurfacesSpec { boundary, to, reach }) => {
                    let path = format!("{path}.surfaces");
                    let facing = Facing::of([boundary, to], *reach, &path, (body, dofs, &order), &mut warnings)?;
                    covered[index] = Some((usize::from(facing.is_swapped), facing.found.covered[0]));
                    means(&facing)?
                }
                TieSpec::Preload(spec) => {
                    let path = format!("{path}.preload");
                    let (rows, shortening) = spec.rows((&path, index), (body, dofs, &order), &mut warnings)?;
                    shortenings.push(shortening);
                    rows
                }
                TieSpec::Equation(spec) => vec![of_equation(spec, &path, body, dofs)?],
            };
            let first = rows.len();
            for row in found {
                let (free, prescribed) = in_unknowns(&row.terms, (dofs, unknowns), dimension);
                let left = row.value - prescribed;
                if !free.is_empty() {
                    entries.extend(free.into_iter().map(|(column, part)| (rows.len(), column, part)));
                    values.push(left);
                    rows.push(row);
                } else if left.abs() > rounding {
                    let message = format!(
                        "supports prescribe all its displacements, and miss it by {}; change the tie or the supports",
                        number(left)
                    );
                    return Err(wrong(path, message));
                }
            }
            of_tie.push(first..rows.len());
        }
        let matrix = SparseMatrix::from_triplets(rows.len(), unknowns.count(), &entries)?;
        for shortening in shortenings.iter().filter(|one| one.force.is_some()) {
            let own = in_unknowns(&shortening.terms, (dofs, unknowns), dimension).0;
            let own = own.into_iter().map(|(column, part)| (rows.len(), column, part));
            let all: Vec<_> = entries.iter().copied().chain(own).collect();
            let with_own = SparseMatrix::from_triplets(rows.len() + 1, unknowns.count(), &all)?;
            // With zeros as values nothing contradicts: what follows from the others is left out.
            let [before, after] = [&matrix, &with_own].map(|rows| rows.independent_rows(&[], REPEATED).len());
            if before == after {
                let message = "supports and ties fix the distance of the faces along the bolt, so that the tension would do nothing; change \
                               them, or the `direction`";
                return Err(wrong(format!("ties[{}].preload.force", shortening.tie), message));
            }
        }
        let ties = Ties { rows, of_tie, covered, matrix, values, shortenings, warnings };
        Ok(if ties.of_tie.len() > 1 { ties.without_repeated() } else { ties })
    }

    /// The pairs of boundaries that are tied.
    pub(crate) fn tied_surfaces(&self) -> impl Iterator<Item = [&str; 2]> {
        self.ties.iter().filter_map(|tie| match tie {
            TieSpec::Surfaces(TiedSurfacesSpec { boundary, to, .. }) => Some([boundary.as_str(), to.as_str()]),
            TieSpec::Preload(PreloadSpec { boundary, to, .. }) => Some([boundary.as_str(), to.as_str()]),
            TieSpec::Equation(_) => None,
        })
    }
}

/// The rows of two surfaces: the means of one of them in every direction.
fn means(facing: &Facing) -> Result<Vec<TieRow>, Error> {
    let dofs = facing.dofs;
    let rows = |axis: usize| facing.rows(|node| dofs.axes(node)[axis]);
    Ok((0..facing.body.dimension()).map(rows).collect::<Result<Vec<_>, Error>>()?.concat())
}

/// The row of an equation.
fn of_equation(spec: &EquationSpec, path: &str, body: &ElasticBody, dofs: &DofMap) -> Result<TieRow, Error> {
    let path = format!("{path}.equation");
    finite(format!("{path}.value"), spec.value)?;
    let (mut terms, mut own) = (Vec::new(), 0);
    for (index, (node, vector)) in terms_of(&spec.terms, &path, body)?.into_iter().enumerate() {
        // The displacement of a node with a coefficient is a sum of coefficients.
        terms.extend(dofs.basis.values(node).map(|(of, part)| (of, vector.map(|along| part * along))));
        if index == 0 {
            own = terms.len();
        }
    }
    Ok(TieRow { terms, own: 0..own, at: None, value: spec.value })
}

/// The nodes of terms, each with its vector [x, y, z].
///
/// # Errors
/// [`Error::Scene`] for a list without terms, a term without a node or a coefficient, and for a displacement that the
/// model does not have.
pub(super) fn terms_of(terms: &[TermSpec], path: &str, body: &ElasticBody) -> Result<Vec<(usize, [f64; 3])>, Error> {
    let mut found = Vec::with_capacity(terms.len());
    for (index, term) in terms.iter().enumerate() {
        let path = format!("{path}.terms[{index}]");
        let node = node_of(&term.on, &path, body)?;
        let vector = [term.x, term.y, term.z];
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            finite(format!("{path}.{name}"), vector[axis])?;
            if axis >= body.dimension() && vector[axis] != 0.0 {
                return Err(wrong(
                    format!("{path}.{name}"),
                    format!("a node of this model has no displacement {name}"),
                ));
            }
        }
        if vector == [0.0; 3] {
            return Err(wrong(path, "has no coefficient; give x, y or z"));
        }
        found.push((node, vector));
    }
    match found.is_empty() {
        true => Err(wrong(format!("{path}.terms"), "has no term; give at least one")),
        false => Ok(found),
    }
}

/// The one node of a term.
fn node_of(place: &Place, path: &str, body: &ElasticBody) -> Result<usize, Error> {
    let mesh = body.mesh();
    let (nodes, path) = match place {
        Place::Point(at) => (vec![node_at(mesh, at, &format!("{path}.on.point"))?], String::new()),
        Place::Boundary(name) => {
            let path = format!("{path}.on.boundary");
            (boundary(mesh, name, &path)?.nodes(), path)
        }
        Place::Nodes(names) => {
            let path = format!("{path}.on.nodes");
            (nodes_named_once(mesh, names, &path)?, path)
        }
    };
    match nodes[..] {
        [node] => Ok(node),
        _ => Err(wrong(path, format!("has {} nodes; a term of an equation has one", nodes.len()))),
    }
}

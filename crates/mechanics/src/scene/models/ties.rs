//! Ties of a scene: linear equations E u = e between displacements.

use std::ops::Range;

use super::facing::{Facing, TieRow};
use super::points::ReferencePoints;
use super::preload::{Shortening, drawn, no_point, terms_of};
use crate::error::Error;
use crate::fem::assembly::{Along, DofMap};
use crate::fem::body::ElasticBody;
use crate::fem::sum::{LinearForm, Sum};
use crate::scene::Warning;
use crate::scene::input::entry::{COORDINATE_ROUNDING, finite, number, wrong};
use crate::scene::input::obstacle::SideOrder;
use crate::scene::input::schema::{EquationSpec, PreloadSpec, Scene, TieSpec, TiedSurfacesSpec};
use signorini_qp::SparseMatrix;

/// An equation of which less than this share is left by others follows from them: far above the rounding of integrals
/// over facets.
const REPEATED: f64 = 1e-9;

/// All ties of a scene in the unknowns.
#[derive(Debug)]
pub struct Ties {
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

/// The ties, without equations that supports alone fulfil.
pub(crate) fn tied(scene: &Scene, body: &ElasticBody, dofs: &DofMap, points: &ReferencePoints) -> Result<Ties, Error> {
    if !scene.ties.is_empty() && scene.dynamic().is_some() {
        return Err(wrong("ties", "ties are for equilibria only; a motion has only supports"));
    }
    let surfaces = tied_surfaces(scene).flatten().filter_map(|name| body.mesh().boundary(name));
    let order = SideOrder::of(body, surfaces);
    let (mut rows, mut of_tie, mut warnings) = (Vec::new(), Vec::with_capacity(scene.ties.len()), Vec::new());
    let mut covered = vec![None; scene.ties.len()];
    let (mut entries, mut values, mut shortenings) = (Vec::new(), Vec::new(), Vec::new());
    let (dimension, rounding) = (body.dimension(), COORDINATE_ROUNDING * body.mesh().size());
    for (index, tie) in scene.ties.iter().enumerate() {
        let path = format!("ties[{index}]");
        let at_points = points.ties.get(&index);
        let found = match tie {
            TieSpec::Surfaces(TiedSurfacesSpec { boundary, to, reach }) => {
                let path = format!("{path}.surfaces");
                let facing = Facing::of([boundary, to], *reach, &path, (body, dofs, &order), &mut warnings)?;
                covered[index] = Some((usize::from(facing.is_swapped), facing.found.covered[0]));
                // The means of one of both in every direction.
                let rows = |axis: usize| facing.rows(|node| dofs.axes(node)[axis]);
                (0..dimension).map(rows).collect::<Result<Vec<_>, _>>()?.concat()
            }
            TieSpec::Preload(spec) => {
                let path = format!("{path}.preload");
                let drawn = drawn(scene, spec, (&path, index))?;
                let (rows, shortening) = drawn.rows((&path, index), (body, dofs, &order), &mut warnings)?;
                shortenings.push(shortening);
                rows
            }
            TieSpec::Equation(_) | TieSpec::Coupling(_) if at_points.is_some() => {
                let of_one = matches!(tie, TieSpec::Equation(_));
                at_points.into_iter().flatten().map(|sum| of_sum(sum, dofs, of_one)).collect()
            }
            TieSpec::Equation(spec) => vec![of_equation(spec, &path, body, dofs)?],
            TieSpec::Coupling(_) => Vec::new(),
        };
        let first = rows.len();
        for row in found {
            let Along { free, prescribed } = dofs.through(&row.form, dimension);
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
    let matrix = SparseMatrix::from_triplets(rows.len(), dofs.count(), &entries)?;
    let tensioned: Vec<&Shortening> = shortenings.iter().filter(|one| one.force.is_some()).collect();
    let first = rows.len();
    // Number of rows that follow from no others, with zeros as values: nothing contradicts.
    let independent = |bolts: &[&Shortening]| -> Result<usize, Error> {
        let own = bolts.iter().enumerate().flat_map(|(number, bolt)| {
            let own = dofs.through(&bolt.form, dimension).free;
            own.into_iter().map(move |(column, part)| (first + number, column, part))
        });
        let all: Vec<_> = entries.iter().copied().chain(own).collect();
        let all = SparseMatrix::from_triplets(first + bolts.len(), dofs.count(), &all)?;
        Ok(all.independent_rows(&[], REPEATED).len())
    };
    let alone = if tensioned.is_empty() { 0 } else { independent(&[])? };
    // All bolts at once first: one of them is seldom stuck.
    let stuck = match tensioned.is_empty() || independent(&tensioned)? == alone + tensioned.len() {
        true => None,
        false => tensioned.iter().find(|bolt| independent(&[**bolt]).is_ok_and(|with| with == alone)),
    };
    if let Some(bolt) = stuck {
        let message = "supports and ties fix the distance of the faces along the bolt, so that the tension would do nothing; change \
                       them, or the `direction`";
        return Err(wrong(format!("ties[{}].preload", bolt.tie), message));
    }
    let ties = Ties { rows, of_tie, covered, matrix, values, shortenings, warnings };
    Ok(if ties.of_tie.len() > 1 { ties.without_repeated() } else { ties })
}

/// The pairs of boundaries that are tied.
pub(crate) fn tied_surfaces(scene: &Scene) -> impl Iterator<Item = [&str; 2]> {
    scene.ties.iter().filter_map(|tie| match tie {
        TieSpec::Surfaces(TiedSurfacesSpec { boundary, to, .. }) => Some([boundary.as_str(), to.as_str()]),
        TieSpec::Preload(PreloadSpec { boundary, to, .. }) => Some([boundary.as_str(), to.as_str()]),
        TieSpec::Equation(_) | TieSpec::Coupling(_) => None,
    })
}

fn of_equation(spec: &EquationSpec, path: &str, body: &ElasticBody, dofs: &DofMap) -> Result<TieRow, Error> {
    let path = format!("{path}.equation");
    finite(format!("{path}.value"), spec.value)?;
    let mut placed = terms_of(&spec.terms, &path, body, &no_point)?;
    let first = placed[0].0;
    // All terms of the first node are its side.
    placed.sort_by_key(|(node, _)| *node != first);
    let of_first = placed.iter().filter(|(node, _)| *node == first).count();
    Ok(TieRow::of(in_coefficients(placed, of_first, dofs), spec.value))
}

/// The row of a sum that is zero; its own side is its first node if it `is_of_one` equation, otherwise all nodes.
fn of_sum(sum: &Sum, dofs: &DofMap, is_of_one: bool) -> TieRow {
    let placed: Vec<_> = sum.vectors().into_iter().collect();
    let own = if is_of_one { 1 } else { placed.len() };
    TieRow { on_points: sum.replaced.clone(), ..TieRow::of(in_coefficients(placed, own, dofs), -sum.constant) }
}

/// The form of terms at nodes, of which the first `own` are its own side: the displacement of a node with a coefficient
/// is a sum of coefficients.
fn in_coefficients(placed: Vec<(usize, [f64; 3])>, own: usize, dofs: &DofMap) -> LinearForm {
    let mut form = LinearForm::default();
    for (index, (node, vector)) in placed.into_iter().enumerate() {
        form.terms.extend(dofs.basis.values(node).map(|(of, part)| (of, vector.map(|along| part * along))));
        form.own = if index < own { form.terms.len() } else { form.own };
    }
    form
}

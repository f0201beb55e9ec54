//! Rows between two bodies whose meshes do not match: means over the areas of the nodes of one boundary.

use std::collections::HashMap;

use super::order::{Between, BodyRow, facet_size};
use super::shape::ObstacleSite;
use crate::error::Error;
use crate::fem::assembly::{PositiveBasis, outward};
use crate::fem::mortar::{FoundRows, MortarRow, Opposite};
use crate::fem::{self, Boundary, DofMap, ElasticBody, Mortar};
use crate::scene::Warning;
use crate::scene::input::entry::wrong;
use crate::scene::input::schema::model::Rule;

/// Facets of the other boundary larger than this many facets of the carrying one leave waves in the pressure.
const COARSE: f64 = 4.0;

/// A boundary covered by less than this share is only partly covered, or tied.
pub(crate) const COVERED: f64 = 1.0 - 1e-6;

/// The sag of straight facets that counts, in gaps: gaps are those of curves through the nodes, which miss circles by a
/// two-hundredth of the sag, uneven meshes included.
const SAG: f64 = 5.0;

/// The rows between the boundary of an obstacle and that of another body; `side` is `true` if the other boundary is to
/// carry them, and `None` to choose.
pub(super) fn between(
    site: &ObstacleSite,
    boundaries: [&Boundary; 2],
    side: Option<bool>,
    reach: Option<f64>,
    fit: Option<f64>,
) -> Result<Between, Error> {
    let is_swapped = side.unwrap_or_else(|| site.order.carries_other(site.body, boundaries));
    let [slave, master] = if is_swapped { [boundaries[1], boundaries[0]] } else { boundaries };
    let along = (site.rule == Rule::Approach).then(|| {
        let towards = site.direction();
        if is_swapped { towards.map(|part| 0.0 - part) } else { towards }
    });
    let reach = reach.unwrap_or(f64::INFINITY);
    let dimension = site.body.dimension();
    // A node that supports hold in all directions cannot make a row a bound: its function goes to its neighbours.
    let may_carry = |node: usize| (0..dimension).any(|axis| !site.dofs.is_supported(dimension * node + axis));
    let found = means((site.body, site.dofs), [slave, master], (reach, along, true), &may_carry, &site.path)?;
    let warnings = warnings(site, [slave, master], &found, fit);
    // In the order of the candidates of the boundary that carries the rows.
    let candidates: HashMap<usize, usize> = slave.nodes().into_iter().zip(0..).collect();
    let (mut rows, mut further) = (vec![None; candidates.len()], Vec::new());
    for row in found.rows {
        let (ends, distance) = (ends(&row, &site.dofs.basis), fit.unwrap_or(row.gap));
        let (area, outward) = (Some(row.area), Some(row.outward));
        let own = BodyRow { ends, normal: row.normal, mean: row.mean, outward, distance, area };
        let Some(&candidate) = candidates.get(&row.node) else { continue };
        match &rows[candidate] {
            None => rows[candidate] = Some(own),
            Some(_) => further.push((candidate, own)),
        }
    }
    let across = found.opposite.into_iter().map(|seen| (seen.node, facing(seen))).collect();
    Ok(Between {
        rows,
        further,
        across,
        other: master.name.clone(),
        covered: Some(found.covered),
        facets: Some(found.facets.into_iter().collect()),
        reach,
        fit,
        is_swapped,
        warnings,
    })
}

/// The means of the first boundary over the second within reach, along a direction or half way between the normals of
/// both, at the nodes that may carry one; with `has_sides` for each side of a corner.
pub(crate) fn means(
    (body, dofs): (&ElasticBody, &DofMap),
    [slave, master]: [&Boundary; 2],
    (reach, along, has_sides): (f64, Option<[f64; 3]>, bool),
    may_carry: &dyn Fn(usize) -> bool,
    path: &str,
) -> Result<FoundRows, Error> {
    let [own, other] = [slave, master].map(|boundary| outward(body, boundary));
    let nodes = body.mesh().nodes();
    let has_coefficient = |node: usize| dofs.basis.ends(node).is_some();
    let mut mortar = Mortar::new((nodes, &own), (nodes, &other), *body.formulation()).within(reach);
    mortar.may_carry = Some(may_carry);
    mortar.has_coefficient = Some(&has_coefficient);
    mortar.has_sides = has_sides;
    let mortar = along.map_or(mortar, |direction| mortar.along(direction));
    let mortar = match [slave, master].map(|boundary| body.region_of(boundary)) {
        [Some(own), Some(other)] if own != other => mortar.between(body.skins(), [own, other]),
        _ => mortar,
    };
    mortar.found().map_err(|error| match error {
        fem::Error::Mesh { message } => wrong(path, message),
        other => other.into(),
    })
}

/// The nodes that a row couples, its own first, with their shares: displacements of nodes with coefficients are sums of
/// these.
pub(crate) fn ends(row: &MortarRow, basis: &PositiveBasis) -> Vec<(usize, f64)> {
    let mut ends = row.slave.clone();
    ends.sort_by_key(|end| end.0 != row.node);
    for &(node, share) in &row.master {
        for (of, part) in basis.values(node) {
            match ends.iter_mut().find(|end| end.0 == of) {
                Some(end) => end.1 -= share * part,
                None => ends.push((of, 0.0 - share * part)),
            }
        }
    }
    ends.retain(|end| end.1 != 0.0);
    ends
}

/// The contact seen from a node of the other body.
fn facing(seen: Opposite) -> BodyRow {
    let normal = seen.normal.map(|part| 0.0 - part);
    let slave = seen.slave.into_iter().filter(|end| end.1 != 0.0).map(|(node, share)| (node, 0.0 - share));
    let ends = std::iter::once((seen.node, 1.0)).chain(slave).collect();
    BodyRow { ends, normal, mean: normal, outward: None, distance: seen.gap, area: None }
}

/// The share of a fit that its drawing may miss it by.
const OF_FIT: f64 = 0.1;

fn warnings(site: &ObstacleSite, [slave, master]: [&Boundary; 2], found: &FoundRows, fit: Option<f64>) -> Vec<Warning> {
    let (obstacle, boundary, other) = (site.obstacle, &slave.name, &master.name);
    let [share, of_other] = found.covered;
    if found.rows.is_empty() {
        let message = format!(
            "{obstacle}: no facet of `{boundary}` faces `{other}` within reach: both bodies are solved without this contact; check the \
             boundaries, the approach direction and `reach`"
        );
        return vec![Warning::new("no-facing-facet", message)];
    }
    let mut warnings = Vec::new();
    // Surfaces that are as far apart as a facet is long where one ends need not meet there.
    let near = facet_size(site.body, &[slave]).powf(1.0 / (site.body.dimension() as f64 - 1.0));
    let ends = found.rows.iter().any(|row| row.covered < COVERED && row.gap.abs() <= near);
    if ends && share < COVERED && of_other < COVERED {
        let message = format!(
            "{obstacle}: {:.1} % of the area of `{boundary}` face `{other}`, and {:.1} % of the nodes of `{other}` face `{boundary}`: where \
             nothing faces them, the bodies can go through each other; name boundaries that contain the whole contact",
            100.0 * share,
            100.0 * of_other
        );
        warnings.push(Warning::new("partly-covered", message));
    }
    let dimension = site.body.dimension() as i32 - 1;
    let ratio = (facet_size(site.body, &[master]) / facet_size(site.body, &[slave])).powf(1.0 / f64::from(dimension));
    if ratio > COARSE {
        let message = format!(
            "{obstacle}: the facets of `{other}` are {ratio:.1} times as long as those of `{boundary}`: between them the pressure has \
             waves; refine `{other}`"
        );
        warnings.push(Warning::new("coarse-master", message));
    }
    let gaps = || found.rows.iter().map(|row| row.gap);
    let largest = gaps().fold(0.0, |largest: f64, gap| largest.max(gap.abs()));
    match fit {
        None if found.sag > SAG * largest && largest > 0.0 => {
            let message = format!(
                "{obstacle}: facets stand for curves and miss them by up to {:.2e}, while the largest gap is {largest:.2e}: gaps are those of \
                 curves through the nodes, which are not known so well; give the distance as `fit`, take quadratic elements, or a finer mesh",
                found.sag
            );
            warnings.push(Warning::new("sag", message));
        }
        Some(fit) => {
            // Meshes are drawn with the fit, or without a gap.
            let off = |gap: f64| (gap - fit).abs().min(gap.abs());
            let misses = gaps().filter(|&gap| off(gap) > 2.0 * found.sag + OF_FIT * fit.abs());
            let differs = misses.fold(0.0, |most: f64, gap| most.max((gap - fit).abs()));
            if differs > 0.0 {
                let message = format!(
                    "{obstacle}: the meshes lie {differs:.2e} away from the fit {fit:.2e} (interference is negative): the fit counts; check \
                     its value, and that both boundaries are meant"
                );
                warnings.push(Warning::new("fit-differs", message));
            }
        }
        None => {}
    }
    warnings
}

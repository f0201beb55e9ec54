//! The contact pressure over the arc length of a boundary for each method, with Hertz's pressure if his theory applies.

use std::collections::HashMap;

use crate::plots::plot::{Plot, Series};
use crate::plots::ticks::Quantity;
use signorini_mechanics::fem::geometry::cross;
use signorini_mechanics::fem::{Boundary, Formulation};
use signorini_mechanics::scene::{Answer, ContactRow, Model};
use signorini_qp::dot;
use signorini_study::Summary;

/// The part of the boundary that is shown reaches beyond the contact by this share of its length.
const BEYOND: f64 = 0.4;

/// Hertz's solution is that of half planes and half spaces: the contact is at most this share of the smallest extent of
/// the body.
const SMALL_CONTACT: f64 = 0.08;

/// The gap must be a parabola over the contact to this share of its depth.
const PARABOLA: f64 = 0.02;

/// Least number of closed rows for fitting a parabola.
const FEWEST_ROWS: usize = 5;

/// A plot for each obstacle that has rows: a line for each method.
pub(crate) fn pressure_plots(answers: &[Answer; 3], summaries: &[Summary; 3]) -> Vec<Plot> {
    let model = answers[0].model();
    let mut plots = Vec::new();
    for (obstacle, placed) in model.obstacles().iter().enumerate() {
        let Some(boundary) = model.mesh().boundary(placed.boundary()) else { continue };
        let rows = || model.rows().iter().enumerate().filter(|(_, row)| row.obstacle == obstacle);
        let peak = rows().max_by(|a, b| answers[0].pressure()[a.0].total_cmp(&answers[0].pressure()[b.0]));
        let Some((_, peak)) = peak else { continue };
        let arc = Arc::new(model, boundary, peak.node);
        let mut along: Vec<(f64, usize)> = rows().filter_map(|(index, row)| Some((arc.at(row)?, index))).collect();
        along.sort_by(|a, b| a.0.total_cmp(&b.0));
        let shown = near_contact(&along, answers);
        let line = |(answer, summary): (&Answer, &Summary)| {
            let points = shown.iter().map(|&(at, index)| [at, answer.pressure()[index]]).collect();
            Series::new(summary.solution.method.clone(), points)
        };
        let mut series: Vec<Series> = answers.iter().zip(summaries).map(line).collect();
        series.extend(hertz(&answers[0], obstacle, &along));
        let units = model.units();
        let from = if arc.is_closed { "from the peak" } else { "from its first node" };
        let name = format!("arc length s along `{}`, {from}", placed.boundary());
        let pressure = Quantity::new("contact pressure p", units.pressure());
        let mut plot = Plot::new(Quantity::new(name, &units.length), pressure, series);
        plot.nested = true;
        plot.y_from_zero = true;
        if model.obstacles().len() > 1 {
            plot.title = format!("obstacle {} on {}", obstacle + 1, placed.boundary());
        }
        plots.push(plot);
    }
    plots
}

/// The rows under pressure and some beside them; all if there is no pressure.
fn near_contact(along: &[(f64, usize)], answers: &[Answer; 3]) -> Vec<(f64, usize)> {
    let presses = |index: usize| answers.iter().any(|answer| answer.pressure()[index] > 0.0);
    let pressed = || along.iter().enumerate().filter(|(_, row)| presses(row.1)).map(|(place, _)| place);
    let (Some(first), Some(last)) = (pressed().min(), pressed().max()) else { return along.to_vec() };
    let reach = BEYOND * (along[last].0 - along[first].0);
    let is_near = |place: usize| {
        let at = along[place].0;
        let (before, behind) = (along[first].0 - reach, along[last].0 + reach);
        (before..=behind).contains(&at) || (first.saturating_sub(2)..=last + 2).contains(&place)
    };
    (0..along.len()).filter(|&place| is_near(place)).map(|place| along[place]).collect()
}

/// The arc length of each row along the boundary of its obstacle, in length: from the row that is nearest to the
/// obstacle if the boundary is closed, else from its first node. Not a number for rows of the other side, which faces
/// away, and for those that lie on no line.
pub(crate) fn arc_lengths(model: &Model) -> Vec<f64> {
    let mut lengths = vec![f64::NAN; model.rows().len()];
    for (obstacle, placed) in model.obstacles().iter().enumerate() {
        let Some(boundary) = model.mesh().boundary(placed.boundary()) else { continue };
        let rows = || model.rows().iter().enumerate().filter(|(_, row)| row.obstacle == obstacle);
        let nearest = rows().min_by(|a, b| a.1.gap.total_cmp(&b.1.gap)).map(|(_, row)| row.node);
        let Some(arc) = nearest.map(|nearest| Arc::new(model, boundary, nearest)) else { continue };
        for (index, row) in rows().filter(|(_, row)| dot(&row.normal, &row.outward) > 0.0) {
            lengths[index] = arc.at(row).unwrap_or(f64::NAN);
        }
    }
    lengths
}

/// Arc length of the nodes of a boundary on the undeformed body.
struct Arc {
    at: HashMap<usize, f64>,
    is_closed: bool,
}

impl Arc {
    /// Measured from the first node of an open line; for a closed line from the node `peak`, in both directions.
    fn new(model: &Model, boundary: &Boundary, peak: usize) -> Self {
        let nodes = model.mesh().nodes();
        let mut neighbours: HashMap<usize, Vec<usize>> = HashMap::new();
        for cell in boundary.facets().flat_map(|facet| boundary.kind.straight_cells(facet)) {
            let &[from, to] = &cell[..] else { continue };
            neighbours.entry(from).or_default().push(to);
            neighbours.entry(to).or_default().push(from);
        }
        let order = boundary.nodes();
        let is_end = |node: &&usize| neighbours.get(node).is_none_or(|near| near.len() < 2);
        let first = order.iter().find(is_end).copied();
        let (mut at, mut length, is_closed) = (HashMap::new(), 0.0, first.is_none());
        // Pieces follow each other; the walk along a closed line begins at the peak.
        for &begin in first.iter().chain([&peak]).chain(&order) {
            let mut here = begin;
            while !at.contains_key(&here) {
                at.insert(here, length);
                let Some(&next) =
                    neighbours.get(&here).and_then(|near| near.iter().find(|next| !at.contains_key(next)))
                else {
                    break;
                };
                length += (0..2).map(|axis| (nodes[next][axis] - nodes[here][axis]).powi(2)).sum::<f64>().sqrt();
                here = next;
            }
            if is_closed && begin == peak {
                let closing = (0..2).map(|axis| (nodes[peak][axis] - nodes[here][axis]).powi(2)).sum::<f64>().sqrt();
                let whole = length + closing;
                at.values_mut().filter(|at| **at > 0.5 * whole).for_each(|at| *at -= whole);
            }
        }
        Arc { at, is_closed }
    }

    fn at(&self, row: &ContactRow) -> Option<f64> {
        self.at.get(&row.node).copied()
    }
}

/// Hertz's pressure of the same force, if his theory applies: bodies of one isotropic material each that are large
/// beside the contact, and a parabolic gap.
///
/// # Source
/// K. L. Johnson, *Contact Mechanics*, Cambridge (1985), equations 4.45 and 3.39.
fn hertz(answer: &Answer, obstacle: usize, along: &[(f64, usize)]) -> Option<Series> {
    let model = answer.model();
    let closed: Vec<[f64; 2]> = along
        .iter()
        .filter(|(_, index)| answer.contact_set().contains(*index))
        .map(|&(at, index)| [at, model.rows()[index].gap])
        .collect();
    let modulus = contact_modulus(model, obstacle)?;
    let (centre, radius) = parabola(&closed)?;
    let force: f64 = along.iter().map(|&(_, index)| -answer.multiplier()[index]).sum();
    let (half, peak) = match *model.body().formulation() {
        Formulation::PlaneStrain { thickness } | Formulation::PlaneStress { thickness } => {
            let half = (4.0 * force / thickness * radius / (std::f64::consts::PI * modulus)).sqrt();
            (half, 2.0 * force / thickness / (std::f64::consts::PI * half))
        }
        Formulation::Axisymmetric => {
            let half = (0.75 * force * radius / modulus).cbrt();
            (half, 1.5 * force / (std::f64::consts::PI * half * half))
        }
        _ => return None,
    };
    let (low, high) = model.mesh().extent();
    let smallest = (high[0] - low[0]).min(high[1] - low[1]);
    if !(half > 0.0 && half <= SMALL_CONTACT * smallest) {
        return None;
    }
    // Points are denser at the edge, where the pressure falls like a square root; a body of revolution has one side of
    // the contact.
    let place = |k: i32| (0.5 * std::f64::consts::PI * f64::from(k) / 60.0).sin();
    let points = (-60..=60).map(place).map(|x| [centre + half * x, peak * (1.0 - x * x).max(0.0).sqrt()]);
    let (slack, first, last) = (1e-9 * smallest, along.first()?.0, along.last()?.0);
    let points = points.filter(|point| (first - slack..=last + slack).contains(&point[0])).collect();
    Some(Series::new("Hertz, same force", points))
}

/// The combined modulus of both sides; `None` if a material is not isotropic, or a body has several.
fn contact_modulus(model: &Model, obstacle: usize) -> Option<f64> {
    let rows = || model.rows().iter().filter(|row| row.obstacle == obstacle);
    let first = rows().next()?;
    // One node of each body.
    let other = first.ends.iter().find(|end| end.1 < 0.0).map(|end| end.0);
    let mut compliance = 0.0;
    for node in std::iter::once(first.node).chain(other) {
        let region = &model.body().regions()[model.body().region_at(node)?];
        let mut elements = model.body().elements().skip(region.elements().start).take(region.elements().len());
        let first = elements.next()?;
        if elements.any(|element| element.phase_number != first.phase_number) {
            return None;
        }
        let material = first.phase.material();
        let (young, poisson) = (material.young()[0], material.poisson()?);
        compliance += match model.body().formulation() {
            Formulation::PlaneStress { .. } => 1.0 / young,
            _ => (1.0 - poisson * poisson) / young,
        };
    }
    Some(1.0 / compliance)
}

/// Vertex and radius of the parabola through points [place, gap], if they lie on one that opens away from the body.
fn parabola(points: &[[f64; 2]]) -> Option<(f64, f64)> {
    if points.len() < FEWEST_ROWS {
        return None;
    }
    let (from, to) = (points[0][0], points[points.len() - 1][0]);
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    // Least squares in the Legendre polynomials of the interval: three equations.
    let basis = |at: f64| {
        let x = (at - middle) / half;
        [1.0, x, 1.5 * x * x - 0.5]
    };
    let (mut rows, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for &[at, gap] in points {
        let values = basis(at);
        for (i, value) in values.into_iter().enumerate() {
            (0..3).for_each(|j| rows[i][j] += value * values[j]);
            right[i] += value * gap;
        }
    }
    // Cramer's rule, with determinants as products of rows, which are the columns too.
    let [a, b, c] = rows;
    let determinant = dot(&a, &cross(b, c));
    if determinant.is_nan() || determinant <= 0.0 {
        return None;
    }
    let found = [cross(b, c), cross(c, a), cross(a, b)].map(|across| dot(&across, &right) / determinant);
    let off = points.iter().map(|&[at, gap]| (dot(&basis(at), &found) - gap).abs()).fold(0.0, f64::max);
    let depth = points
        .iter()
        .map(|point| point[1])
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], gap| [low.min(gap), high.max(gap)]);
    let curvature = 3.0 * found[2] / (half * half);
    let is_parabola = off <= PARABOLA * (depth[1] - depth[0]) && curvature > 0.0;
    is_parabola.then(|| (middle - found[1] / half / curvature, 1.0 / curvature))
}

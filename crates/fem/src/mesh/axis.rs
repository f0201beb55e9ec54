//! One axis of a structured mesh: breakpoints, divisions, gradings; fine cells in a zone, growing cells beyond.

use std::collections::HashMap;
use std::hash::Hash;

use super::{Boundary, ElementKind, MAX_NODES, Mesh, fail};
use crate::error::Error;
use crate::formulation::positive;
use crate::geometry::{key, length, minus, shifted};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use signorini_linear as linear;

/// More lines than this are refused before memory is allocated.
pub(super) const MAX_LINES: usize = 5_000_000;

/// One axis of a structured mesh: intervals between breakpoints, each cut into cells of equal or graded size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "AxisSpec")]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Breakpoints, at least two, strictly increasing, in length.
    #[schemars(extend("minItems" = 2))]
    pub points: Vec<f64>,
    /// Number of cells of each interval between breakpoints, one entry fewer than `points`, at least 1 each.
    #[schemars(extend("minItems" = 1, "items" = {"type": "integer", "format": "uint", "minimum": 1}))]
    pub divisions: Vec<usize>,
    /// Last cell size over first cell size of each interval, one entry fewer than `points`, dimensionless and positive;
    /// all 1 if left out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("items" = {"type": "number", "format": "double", "exclusiveMinimum": 0}))]
    pub ratios: Vec<f64>,
}

/// An axis that describes no mesh: the field at fault, as `divisions[0]`, and what is wrong with it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field}: {message}")]
pub struct AxisError {
    /// The field, with its index if it has one.
    pub field: String,
    /// The fault, and the allowed values.
    pub message: String,
}

impl Axis {
    /// The coordinates of the mesh lines, one for each line, strictly increasing, in length; breakpoints are met
    /// exactly.
    ///
    /// # Errors
    /// `AxisError` for fewer than two points, points that do not increase, lengths that do not fit, zero
    /// divisions, a ratio that is not positive, more than 5,000,000 lines, cells so small that two lines fall
    /// together.
    pub fn coordinates(&self) -> Result<Vec<f64>, AxisError> {
        let lines = self.check()?;
        let mut coordinates = Vec::with_capacity(lines);
        for (interval, ends) in self.points.windows(2).enumerate() {
            let (cells, length) = (self.divisions[interval], ends[1] - ends[0]);
            let ratio = self.ratios.get(interval).copied().unwrap_or(1.0);
            for cell in 0..cells {
                let at = ends[0] + length * graded_fraction(cell, cells, ratio);
                if coordinates.last().is_some_and(|&last| at <= last) {
                    return Err(collapsed(interval));
                }
                coordinates.push(at);
            }
            if coordinates.last().is_some_and(|&last| ends[1] <= last) {
                return Err(collapsed(interval));
            }
        }
        coordinates.extend(self.points.last());
        Ok(coordinates)
    }

    /// Cells from end to end.
    #[doc(hidden)]
    pub fn cells(&self) -> usize {
        self.divisions.iter().fold(0, |sum: usize, &cells| sum.saturating_add(cells))
    }

    /// From the first point to the last; 0 without points.
    #[doc(hidden)]
    pub fn length(&self) -> f64 {
        match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// Cuts every cell into `times` cells; the meshes of graded axes are nested.
    #[doc(hidden)]
    pub fn refine(&mut self, times: usize) {
        // Cell sizes grow by q = ratio^(1/(n - 1)) from cell to cell; in the finer mesh by the times-th root of q.
        for (ratio, &cells) in self.ratios.iter_mut().zip(&self.divisions) {
            if cells > 1 {
                let finer = cells.saturating_mul(times) - 1;
                *ratio = ratio.powf(finer as f64 / (times as f64 * (cells - 1) as f64));
            }
        }
        self.divisions.iter_mut().for_each(|cells| *cells = cells.saturating_mul(times));
    }

    /// Checks the fields and counts the mesh lines.
    fn check(&self) -> Result<usize, AxisError> {
        let fail = |field: String, message: String| Err(AxisError { field, message });
        let points = &self.points;
        if points.len() < 2 {
            let message = format!("an axis needs at least two points, but there are {}", points.len());
            return fail("points".into(), message);
        }
        for (index, &point) in points.iter().enumerate() {
            if !point.is_finite() {
                return fail(format!("points[{index}]"), format!("{point} is not finite"));
            }
            if index > 0 && point <= points[index - 1] {
                let message = format!("{point:?} does not lie beyond {:?}; points must increase", points[index - 1]);
                return fail(format!("points[{index}]"), message);
            }
        }
        if !(points[points.len() - 1] - points[0]).is_finite() {
            return fail("points".into(), "the length of the axis is not finite".into());
        }
        let intervals = points.len() - 1;
        let ratios = if self.ratios.is_empty() { intervals } else { self.ratios.len() };
        for (field, found) in [("divisions", self.divisions.len()), ("ratios", ratios)] {
            if found != intervals {
                let message = format!(
                    "the array has length {found}, but must have {intervals}: one entry for each interval between points"
                );
                return fail(field.into(), message);
            }
        }
        if let Some(index) = self.ratios.iter().position(|ratio| !(ratio.is_finite() && *ratio > 0.0)) {
            let message =
                format!("{:?} is not allowed: it must be positive (last cell size over first)", self.ratios[index]);
            return fail(format!("ratios[{index}]"), message);
        }
        let mut lines: usize = 1;
        for (index, &cells) in self.divisions.iter().enumerate() {
            if cells == 0 {
                return fail(format!("divisions[{index}]"), "0 cells; an interval needs at least 1".into());
            }
            lines = lines.saturating_add(cells);
            if lines > MAX_LINES {
                let message = format!("{cells} cells make more than the {MAX_LINES} lines that an axis may have");
                return fail(format!("divisions[{index}]"), message);
            }
        }
        Ok(lines)
    }
}

fn collapsed(interval: usize) -> AxisError {
    let message = "its cells are so small that two mesh lines fall together in double precision; \
                   take fewer divisions or a ratio nearer to 1";
    AxisError { field: format!("divisions[{interval}]"), message: message.into() }
}

/// The position of line `cell` of `cells`, as a fraction of the interval: cell sizes grow by the constant factor q =
/// ratio^(1/(cells-1)), so that the fraction is (q^cell - 1)/(q^cells - 1).
fn graded_fraction(cell: usize, cells: usize, ratio: f64) -> f64 {
    if ratio == 1.0 || cells == 1 {
        return cell as f64 / cells as f64;
    }
    let growth = ratio.ln() / (cells - 1) as f64;
    (growth * cell as f64).exp_m1() / (growth * cells as f64).exp_m1()
}

/// The finely meshed zone around the lowest (highest) point of a round body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "ZoneSpec")]
#[serde(deny_unknown_fields)]
pub struct Zone {
    /// Distance over which the cells have one size, from the lowest point to each side and into the body: positive, at
    /// most the radius. Twice the expected contact half-width is a good choice.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub width: f64,
    /// Cells on this width, at least 1.
    #[schemars(extend("minimum" = 1))]
    pub divisions: usize,
    /// Size of each further cell over that of its neighbour towards the zone, from 1 to 10.
    #[serde(default = "growth")]
    #[schemars(extend("minimum" = 1, "maximum" = 10))]
    pub growth: f64,
}

fn growth() -> f64 {
    1.2
}

/// A cell smaller than this times the radius is below the rounding of coordinates.
const SMALLEST: f64 = 1e-8;

impl Zone {
    pub(crate) fn check(&self, radius: f64) -> Result<(), Error> {
        let fail = |name, value, allowed| Err(linear::Error::Setting { name, value, allowed }.into());
        positive("radius", radius)?;
        if !(self.width > 0.0 && self.width <= radius) {
            return fail("zone.width", self.width, "positive, and at most the radius");
        }
        if !(self.growth >= 1.0 && self.growth <= 10.0) {
            return fail("zone.growth", self.growth, "from 1 to 10 (each cell over its neighbour)");
        }
        let cells = self.divisions as f64;
        if self.divisions == 0 || self.divisions > MAX_LINES || self.width / cells < SMALLEST * radius {
            return fail("zone.divisions", cells, "at least 1, with cells of at least 1e-8 of the radius");
        }
        Ok(())
    }

    /// The approximate number of cells on `length`, and the size of the last cell.
    pub fn count(&self, length: f64) -> (f64, f64) {
        let size = self.width / self.divisions as f64;
        let rest = length - self.width;
        if rest <= 0.0 {
            return (length / size, size);
        }
        let growing = match self.growth.ln() {
            rate if rate > 0.0 => (rest * (self.growth - 1.0) / (size * self.growth)).ln_1p() / rate,
            _ => rest / size,
        };
        (self.divisions as f64 + growing, size * self.growth.powf(growing))
    }

    /// Cuts every cell into `times` cells.
    #[doc(hidden)]
    pub fn refine(&mut self, times: usize) {
        self.divisions = self.divisions.saturating_mul(times);
        self.growth = self.growth.powf(1.0 / times as f64);
    }

    /// Lines from 0 to `length`, fine at 0; the last one is met exactly.
    pub(super) fn lines(&self, length: f64) -> Result<Vec<f64>, Error> {
        let size = self.width / self.divisions as f64;
        let fine = if self.width < length { self.divisions } else { (length / size).ceil().max(1.0) as usize };
        let reach = self.width.min(length);
        let mut lines: Vec<f64> = (0..fine).map(|cell| reach * cell as f64 / fine as f64).collect();
        let mut growing = Vec::new();
        let mut total = 0.0;
        let mut next = size;
        while reach + total < length {
            next *= self.growth;
            total += next;
            growing.push(next);
            if growing.len() > MAX_LINES {
                let (name, allowed) = ("zone.growth", "larger: the cells are more than the nodes that are allowed");
                return Err(linear::Error::Setting { name, value: self.growth, allowed }.into());
            }
        }
        // All growing cells are scaled by one factor, so that the last line is at `length`.
        let factor = (length - reach) / total;
        let mut at = reach;
        for cell in growing {
            lines.push(at);
            at += cell * factor;
        }
        lines.push(length);
        Ok(lines)
    }
}

/// The nodes of a structured mesh made so far, by their keys.
#[derive(Default)]
pub struct Lattice<K> {
    numbers: HashMap<K, usize>,
    /// The keys in the order of the nodes.
    pub keys: Vec<K>,
}

impl<K: Copy + Eq + Hash> Lattice<K> {
    pub fn node(&mut self, key: K) -> usize {
        *self.numbers.entry(key).or_insert_with(|| {
            self.keys.push(key);
            self.keys.len() - 1
        })
    }
}

/// The lines of an axis at half steps: the mean of each two lines is inserted between them.
pub fn half_steps(lines: &[f64]) -> Vec<f64> {
    let mut fine = Vec::with_capacity(2 * lines.len());
    for (index, &line) in lines.iter().enumerate() {
        if index > 0 {
            let before = lines[index - 1];
            fine.push(before + (line - before) / 2.0);
        }
        fine.push(line);
    }
    fine
}

impl Mesh {
    /// The same mesh of a quadratic `kind`, whose corners are the nodes of its elements; edges stay straight. The new
    /// nodes follow the old ones.
    #[doc(hidden)]
    pub fn elevated(&self, kind: ElementKind) -> Result<Mesh, Error> {
        let own = self.kind_of(0);
        if (own.nodes(), own.dimension()) != (kind.corners(), kind.dimension()) {
            return fail(format!("a mesh of {} cannot become one of {}", own.name(), kind.name()));
        }
        let mut middles = Middles { nodes: self.nodes().to_vec(), of: HashMap::new() };
        let mut connectivity = Vec::with_capacity(self.element_count() * kind.nodes());
        for element in self.elements() {
            middles.extend(element, kind.reference().mid_sides, &mut connectivity);
        }
        if middles.nodes.len() > MAX_NODES {
            let count = middles.nodes.len();
            return fail(format!("{count} nodes are more than the {MAX_NODES} that are allowed"));
        }
        let facet = kind.facet();
        let mut boundaries = Vec::with_capacity(self.boundaries().len());
        for boundary in self.boundaries() {
            let mut facets = Vec::with_capacity(boundary.facet_count() * facet.nodes());
            for corners in boundary.facets() {
                middles.extend(corners, facet.reference().mid_sides, &mut facets);
            }
            boundaries.push(Boundary::new(boundary.name.as_str(), facet, facets));
        }
        Ok(Mesh::new(middles.nodes, kind, connectivity, boundaries)?.with_groups(self.groups().to_vec()))
    }

    /// The same with the nodes of a boundary moved along their radius onto a sphere.
    #[doc(hidden)]
    pub fn onto_sphere(mut self, boundary: &str, centre: [f64; 3], radius: f64) -> Self {
        for node in self.boundary(boundary).map_or_else(Vec::new, |boundary| boundary.nodes()) {
            let away = minus(self.nodes[node], centre);
            let stretch = radius / length(away);
            self.nodes[node] = shifted(centre, stretch, away);
        }
        self
    }
}

/// The nodes so far, and the mid-edge nodes by the ends of their edges.
struct Middles {
    nodes: Vec<[f64; 3]>,
    of: HashMap<[usize; 2], usize>,
}

impl Middles {
    /// Adds the corners of a cell and the middles of its edges, in this order, to `connectivity`.
    fn extend(&mut self, corners: &[usize], edges: &[[usize; 2]], connectivity: &mut Vec<usize>) {
        connectivity.extend(corners);
        for edge in edges {
            let [a, b] = edge.map(|local| corners[local]);
            let middle = *self.of.entry(key(a, b)).or_insert_with(|| {
                let (one, other) = (self.nodes[a], self.nodes[b]);
                self.nodes.push([0, 1, 2].map(|axis| one[axis] + (other[axis] - one[axis]) / 2.0));
                self.nodes.len() - 1
            });
            connectivity.push(middle);
        }
    }
}

/// Half the width of the core divided by the radius: cells are neither flat at its corners nor small in its middle.
const CORE: f64 = 0.4;

/// The lines of a round body around its core.
pub struct Grading {
    radius: f64,
    /// Arc lengths from the lowest point to the corner of the core, fine at 0.
    pub aside: Vec<f64>,
    /// Arc lengths from the cut to the corner of the core.
    pub down: Vec<f64>,
    /// The positions of the shells, from 0 at the core to 1 at the surface, fine at 1.
    pub shells: Vec<f64>,
}

impl Grading {
    pub fn new(radius: f64, zone: &Zone) -> Result<Self, Error> {
        zone.check(radius)?;
        let quarter = radius * std::f64::consts::FRAC_PI_4;
        let aside = zone.lines(quarter)?;
        // About as wide as the last cell next to them.
        let last = quarter - aside[aside.len() - 2];
        let rows = (quarter / last).round().max(2.0);
        let down = (0..=rows as usize).map(|row| quarter * row as f64 / rows).collect();
        let depth = radius * (1.0 - CORE);
        let mut shells: Vec<f64> = zone.lines(depth)?.iter().map(|line| 1.0 - line / depth).collect();
        shells.reverse();
        Ok(Grading { radius, aside, down, shells })
    }

    /// The tangent of the angle of an arc length from an axis; exact at the corner of the core, where it is 1.
    pub fn tangent(&self, arc: f64) -> f64 {
        let angle = arc / self.radius;
        if angle.abs() >= std::f64::consts::FRAC_PI_4 { angle.signum() } else { angle.tan() }
    }

    /// The position, relative to the centre, of a point of the core (given in halves of the core's width) that is moved
    /// along its ray by `outward`: from the core (0) to the surface (1).
    pub fn place(&self, core: [f64; 3], outward: f64) -> [f64; 3] {
        if outward == 0.0 {
            return core.map(|value| value * CORE * self.radius);
        }
        let stretch = (1.0 - outward) * CORE + outward / length(core);
        core.map(|value| value * stretch * self.radius)
    }
}

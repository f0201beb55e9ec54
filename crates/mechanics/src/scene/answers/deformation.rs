//! The size of the deformation of an answer, and whether the equations of small displacements still describe it.

use crate::fem::body::{BodyElement, Region};
use crate::fem::geometry::{length, unit};
use crate::fem::mesh::extent;
use crate::scene::Model;
use crate::scene::models::rows::ContactRow;

/// Strains above this, and rotations above this in radians, are beyond small displacements: the answer is wrong by
/// about as much.
const BEYOND: f64 = 0.5;

/// Depths below this share of the size of the mesh are rounding of coordinates.
const ROUNDING: f64 = 1e-9;

/// The deformation at the centres of elements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deformation {
    /// The largest component of a strain, by magnitude, and its element.
    pub strain: (f64, usize),
    /// The largest rotation, in radians if it is small, and its element.
    pub rotation: (f64, usize),
}

impl Deformation {
    /// The largest of all elements; `None` without elements.
    pub fn of(model: &Model, displacement: &[f64]) -> Option<Self> {
        let body = model.body();
        let tables = body.tabulated();
        let of_element = |(element, of): (usize, BodyElement)| {
            let own = body.gather(displacement, of.nodes);
            let point = body.displaced(&of.cell, &tables.at(of.kind).centroid, &own);
            let strain = point.strain().iter().fold(0.0, |largest: f64, component| largest.max(component.abs()));
            let rotation = length(point.rotation());
            Deformation { strain: (strain, element), rotation: (rotation, element) }
        };
        let larger = |one: (f64, usize), other: (f64, usize)| if other.0 > one.0 { other } else { one };
        body.elements().enumerate().map(of_element).reduce(|one, other| Deformation {
            strain: larger(one.strain, other.strain),
            rotation: larger(one.rotation, other.rotation),
        })
    }

    /// The larger one of strain and rotation.
    pub fn largest(&self) -> f64 {
        self.strain.0.max(self.rotation.0)
    }

    /// A sentence with numbers and the likely cause if small displacements do not describe the answer of `model` that
    /// moves by at most `moved`.
    pub fn beyond_small_displacements(&self, model: &Model, moved: f64) -> Option<String> {
        let ((strain, element), (rotation, turned)) = (self.strain, self.rotation);
        let fact_and_cause = if let Some(deep) = TooDeep::of(model) {
            deep.in_words(model)
        } else if self.largest() <= BEYOND {
            return None;
        } else {
            let (large, element) = match strain >= rotation {
                true => (format!("strains reach {:.1} %", 100.0 * strain), element),
                false => (format!("rotations reach {rotation:.2} rad"), turned),
            };
            let corner = model.body().elements().nth(element)?.nodes.first().copied()?;
            let (place, cause) = (model.place_in_words(corner), self.likely_cause(model, moved));
            format!("{large}, in element {element} with a corner at {place}. {cause}")
        };
        Some(format!(
            "small displacements do not describe this answer: {fact_and_cause}. `--linear` gives it all the same"
        ))
    }

    /// The likely cause of a large strain, or of a large rotation without one.
    fn likely_cause(&self, model: &Model, moved: f64) -> String {
        if self.strain.0 <= BEYOND {
            return "A slender body bends, or a body turns that little holds: reduce the load, or hold the body".into();
        }
        let depth = model.rows().iter().map(|row| depth_at_start(model, row)).fold(0.0, f64::max);
        if depth > BEYOND * moved {
            let depth = format!("{depth:.3e} {}", model.units().length);
            return format!(
                "An obstacle that starts {} inside a body imposes it: check `gap`, `approach`, and the boundary that faces the obstacle",
                depth.trim_end()
            );
        }
        "Loads or prescribed displacements do not fit the stiffness: check the units of loads, lengths and `young`"
            .into()
    }
}

impl std::fmt::Display for Deformation {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let [strain, rotation] = [self.strain.0, self.rotation.0].map(|part| 100.0 * part);
        let degrees = self.rotation.0.to_degrees();
        write!(
            f,
            "at the centres of elements the largest strain is {strain:.2} %, the largest rotation {rotation:.2} % ({degrees:.2} degrees)"
        )
    }
}

/// A contact row that starts deeper inside an obstacle than its body is thick behind it.
struct TooDeep {
    node: usize,
    obstacle: usize,
    depth: f64,
    thickness: f64,
}

impl TooDeep {
    /// The row that starts deepest, in thicknesses of its body, if that is more than one.
    fn of(model: &Model) -> Option<Self> {
        let (body, rounding) = (model.body(), ROUNDING * model.mesh().size());
        let of_body = |region: &Region| {
            let own = |row: &&ContactRow| region.nodes().contains(&row.node) && depth_at_start(model, row) > rounding;
            let deep: Vec<&ContactRow> = model.rows().iter().filter(own).collect();
            let start = |row: &ContactRow| model.mesh().nodes()[row.node];
            let inward = |row: &ContactRow| unit(row.outward.map(|part| -part));
            let end = |row: &ContactRow| {
                let (start, way) = (start(row), inward(row));
                [0, 1, 2].map(|axis| start[axis] + depth_at_start(model, row) * way[axis])
            };
            let ends: Vec<[f64; 3]> = deep.iter().flat_map(|row| [start(row), end(row)]).collect();
            let skin = (!deep.is_empty()).then(|| body.skin_within(region, extent(&ends).into()));
            let of_row = move |row: &ContactRow| {
                let depth = depth_at_start(model, row);
                let thickness = skin.as_ref()?.thickness(start(row), inward(row))?;
                (depth > thickness).then_some(TooDeep { node: row.node, obstacle: row.obstacle, depth, thickness })
            };
            deep.into_iter().filter_map(of_row)
        };
        let regions = body.regions().iter().filter(|_| body.dimension() > 1);
        let deep = regions.flat_map(of_body);
        deep.max_by(|one, other| (one.depth / one.thickness).total_cmp(&(other.depth / other.thickness)))
    }

    fn in_words(&self, model: &Model) -> String {
        let [depth, thickness] =
            [self.depth, self.thickness].map(|value| format!("{value:.3e} {}", model.units().length));
        format!(
            "before contact {} lies {} inside obstacles[{}], and its body is {} thick there. Name the boundary that faces the \
             obstacle, or correct `gap` and `approach`",
            model.node_in_words(self.node),
            depth.trim_end(),
            self.obstacle,
            thickness.trim_end()
        )
    }
}

/// How deep a contact row starts inside an obstacle that stands still, in length.
fn depth_at_start(model: &Model, row: &ContactRow) -> f64 {
    if model.is_pressed(row.obstacle) { 0.0 } else { -row.gap }
}

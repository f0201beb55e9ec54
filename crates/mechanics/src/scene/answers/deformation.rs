//! The size of the deformation of an answer, and whether the equations of small displacements still describe it.

use crate::fem::body::Region;
use crate::fem::geometry::{shifted, unit};
use crate::fem::mesh::extent;
use crate::fem::recovery::state::Deformation;
use crate::scene::Model;
use crate::scene::models::build::{node_in_words, place_in_words};
use crate::scene::models::rows::ContactRow;

/// Strains above this, and rotations above this in radians, are beyond small displacements: the answer is wrong by
/// about as much, except near singular points.
pub const BEYOND: f64 = 0.5;

/// Depths below this share of the size of the mesh are rounding of coordinates.
const ROUNDING: f64 = 1e-9;

/// A sentence with numbers and the likely cause if small displacements do not describe the answer of `model` that
/// moves by at most `moved`.
pub(super) fn beyond_small_displacements(deformation: Deformation, model: &Model, moved: f64) -> Option<String> {
    let ((strain, element), (rotation, turned)) = (deformation.strain, deformation.rotation);
    let fact_and_cause = if let Some(deep) = too_deep(model) {
        deep
    } else if deformation.widespread <= BEYOND {
        return None;
    } else {
        let (large, element) = match strain >= rotation {
            true => (format!("strains reach {:.1} %", 100.0 * strain), element),
            false => (format!("rotations reach {rotation:.2} rad"), turned),
        };
        let corner = model.body().elements().nth(element)?.nodes.first().copied()?;
        let (place, cause) = (place_in_words(model, corner), likely_cause(deformation, model, moved));
        format!("{large}, in element {element} with a corner at {place}. {cause}")
    };
    Some(format!("small displacements do not describe this answer: {fact_and_cause}. `--linear` gives it all the same"))
}

/// The likely cause of a large strain, or of a large rotation without one.
fn likely_cause(deformation: Deformation, model: &Model, moved: f64) -> String {
    if deformation.strain.0 <= BEYOND {
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
    "Loads or prescribed displacements do not fit the stiffness: check the units of loads, lengths and `young`".into()
}

/// In words, the contact row that starts deepest inside an obstacle, in thicknesses of its body behind it, if that is
/// more than one.
fn too_deep(model: &Model) -> Option<String> {
    let (body, rounding) = (model.body(), ROUNDING * model.mesh().size());
    let of_body = |region: &Region| {
        let own = |row: &&ContactRow| region.nodes().contains(&row.node) && depth_at_start(model, row) > rounding;
        let deep: Vec<&ContactRow> = model.rows().iter().filter(own).collect();
        let start = |row: &ContactRow| model.mesh().nodes()[row.node];
        let inward = |row: &ContactRow| unit(row.outward.map(|part| -part));
        let end = |row: &ContactRow| shifted(start(row), depth_at_start(model, row), inward(row));
        let ends: Vec<[f64; 3]> = deep.iter().flat_map(|row| [start(row), end(row)]).collect();
        let skin = (!deep.is_empty()).then(|| body.skin_within(region, extent(&ends).into()));
        let of_row = move |row: &ContactRow| {
            let depth = depth_at_start(model, row);
            let thickness = skin.as_ref()?.thickness(start(row), inward(row))?;
            (depth > thickness).then_some((row.node, row.obstacle, depth, thickness))
        };
        deep.into_iter().filter_map(of_row)
    };
    let regions = body.regions().iter().filter(|_| body.dimension() > 1);
    let deep = regions.flat_map(of_body);
    let (node, obstacle, depth, thickness) =
        deep.max_by(|one, other| (one.2 / one.3).total_cmp(&(other.2 / other.3)))?;
    let [depth, thickness] = [depth, thickness].map(|value| format!("{value:.3e} {}", model.units().length));
    Some(format!(
        "before contact {} lies {} inside obstacles[{obstacle}], and its body is {} thick there. Name the boundary that faces the \
         obstacle, or correct `gap` and `approach`",
        node_in_words(model, node),
        depth.trim_end(),
        thickness.trim_end()
    ))
}

/// How deep a contact row starts inside an obstacle that stands still, in length.
fn depth_at_start(model: &Model, row: &ContactRow) -> f64 {
    if model.parts.pressed.contains(&row.obstacle) { 0.0 } else { -row.gap }
}

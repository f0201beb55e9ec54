//! What the picture of a body in space shows, from its answer.

use std::path::Path;

use super::body::{FieldPanel, ROUNDING};
#[cfg(feature = "cli")]
use super::colour::Colour;
#[cfg(feature = "cli")]
use super::drawing::Drawing;
use super::medium::Medium;
use super::plan::Plan;
use super::plane_scene::{has_pairs, rounded_down, ways_to_obstacle};
use super::space::{Colouring, Face, Sheet, SpacePicture};
use super::ticks::{Quantity, brief};
use super::write_picture;
use crate::error::Error;
use crate::fem::body::Region;
use crate::fem::element::FacetKind;
use crate::scene::{Answer, Model, straight_cells};

/// The largest displacement is drawn about this share of the size of the body.
const SEEN: f64 = 0.04;
/// An obstacle is drawn where it is at most this share of the size of the body away.
const NEAR: f64 = 0.25;
/// The plan view reaches beyond the contact by this share of it.
const BEYOND: f64 = 0.35;
/// The eye looks down on the body from the front and a little from the right; contact faces turn it to their side.
const EYE: [f64; 3] = [0.5, -0.8, 0.55];

/// Draws the picture of an answer in space.
///
/// # Errors
/// [`Error::File`], and those of the recovery of stresses.
pub(super) fn draw_space(folder: &Path, stem: &str, title: &str, answer: &Answer, medium: Medium) -> Result<(), Error> {
    let model = answer.model();
    let nodes = model.mesh().nodes();
    let moved = answer.displacement().chunks_exact(3).map(|u| u.iter().map(|part| part * part).sum::<f64>().sqrt());
    let size = model.mesh().size();
    let magnification = if has_pairs(model) { 1.0 } else { rounded_down(SEEN * size / moved.fold(0.0, f64::max)) };
    let displaced: Vec<[f64; 3]> = nodes
        .iter()
        .zip(answer.displacement().chunks_exact(3))
        .map(|(at, u)| [0, 1, 2].map(|axis| at[axis] + magnification * u[axis]))
        .collect();
    let stress = &answer.stress()?.nodes;
    let largest = stress.iter().map(|of| of.von_mises).fold(0.0, f64::max);
    let values: Vec<f64> =
        stress.iter().map(|of| if of.von_mises <= ROUNDING * largest { 0.0 } else { of.von_mises }).collect();
    let faces = faces(model);
    let obstacle = (0..model.obstacles().len()).max_by(|&a, &b| force(answer, a).total_cmp(&force(answer, b)));
    let eye = eye(model, obstacle);
    let sheets: Vec<Sheet> = (0..model.obstacles().len())
        .filter(|&index| model.obstacles()[index].rigid().is_some())
        .map(|index| sheet(model, index, &ways_to_obstacle(answer, index), (magnification, NEAR * size)))
        .collect();
    let plan = obstacle.map(|obstacle| plan(answer, obstacle));
    let times = brief(magnification);
    let heading = match magnification == 1.0 {
        true => "displaced body, to scale".to_string(),
        false if sheets.is_empty() => format!("displaced body, displacement × {times}"),
        false => format!("displaced body, displacement and gap × {times}"),
    };
    let quantity = Quantity::new("von Mises stress", model.units().pressure());
    let picture = SpacePicture {
        title,
        heading: &heading,
        length_unit: &model.units().length,
        nodes: &displaced,
        faces: &faces,
        colouring: Colouring::Field(FieldPanel { values: &values, quantity, limits: [f64::NAN; 2] }),
        sheets: &sheets,
        eye,
        plan: plan.as_ref(),
        medium,
    };
    write_picture(folder, stem, &picture.draw())?;
    Ok(())
}

/// The surfaces of all bodies.
fn faces(model: &Model) -> Vec<Face> {
    let of_region = |region: &Region| {
        let surface = model.mesh().surface(region.elements());
        surface.facets().map(|facet| face(surface.kind, facet)).collect::<Vec<_>>()
    };
    model.body().regions().iter().flat_map(of_region).collect()
}

/// From the body to the eye: from the side of the obstacle that is looked at.
fn eye(model: &Model, obstacle: Option<usize>) -> [f64; 3] {
    let mut eye = EYE;
    if let Some(obstacle) = obstacle {
        let approach = model.obstacles()[obstacle].approach();
        (0..3)
            .filter(|&axis| approach[axis].abs() > 0.3)
            .for_each(|axis| eye[axis] = eye[axis].abs().copysign(approach[axis]));
    }
    eye
}

/// The picture of a body in space before it is solved: faces that are held, loaded or may touch, and the obstacles at their gap.
#[cfg(feature = "cli")]
pub(super) fn space_set_up(model: &Model, title: &str) -> Drawing {
    let nodes = model.mesh().nodes();
    let faces = faces(model);
    let mut held = vec![false; nodes.len()];
    model.held_nodes().iter().for_each(|node| held[node.node] = true);
    let mut candidate = vec![false; nodes.len()];
    model.rows().iter().for_each(|row| candidate[row.node] = true);
    let loaded: Vec<bool> = model.nodal_load().chunks_exact(3).map(|load| load.iter().any(|&f| f != 0.0)).collect();
    // A volume force loads every node; faces of their own have what only some nodes have.
    let is_on_faces = loaded.iter().any(|&is_loaded| !is_loaded);
    let all = |flags: &[bool], face: &Face| face.outline.iter().all(|&node| flags[node]);
    let kind = |face: &Face| match () {
        () if all(&candidate, face) => 1,
        () if all(&held, face) => 2,
        () if is_on_faces && all(&loaded, face) => 3,
        () => 0,
    };
    let kinds: Vec<usize> = faces.iter().map(kind).collect();
    let colours: Vec<Colour> = kinds.iter().map(|&kind| KINDS[kind].1).collect();
    let names: Vec<(&str, Colour)> =
        (0..KINDS.len()).filter(|kind| kinds.contains(kind)).map(|kind| KINDS[kind]).collect();
    let sheets: Vec<Sheet> = (0..model.obstacles().len())
        .filter(|&index| model.obstacles()[index].rigid().is_some())
        .map(|index| {
            let rows = model.rows().iter().filter(|row| row.obstacle == index);
            let ways: Vec<_> = rows.map(|row| (row.node, row.normal.map(|part| row.gap * part))).collect();
            sheet(model, index, &ways, (1.0, NEAR * model.mesh().size()))
        })
        .collect();
    let picture = SpacePicture {
        title,
        heading: "body before it is solved",
        length_unit: &model.units().length,
        nodes,
        faces: &faces,
        colouring: Colouring::Faces { colours: &colours, names: &names },
        sheets: &sheets,
        eye: eye(model, (!model.obstacles().is_empty()).then_some(0)),
        plan: None,
        medium: Medium::Screen,
    };
    picture.draw()
}

/// What faces are in the picture of a set-up, with their colours.
#[cfg(feature = "cli")]
const KINDS: [(&str, Colour); 4] = [
    ("body", Colour(214, 220, 230)),
    ("candidates for contact", Colour(240, 190, 110)),
    ("held", Colour(110, 175, 145)),
    ("loaded", Colour(225, 130, 120)),
];

/// The size of the force of an obstacle.
fn force(answer: &Answer, obstacle: usize) -> f64 {
    let rows = answer.model().rows().iter().zip(answer.multiplier()).filter(|(row, _)| row.obstacle == obstacle);
    rows.map(|(_, lambda)| -lambda).sum()
}

fn face(kind: FacetKind, facet: &[usize]) -> Face {
    Face { outline: outline(kind, facet), cells: straight_cells(kind, facet) }
}

/// The nodes around a facet.
fn outline(kind: FacetKind, facet: &[usize]) -> Vec<usize> {
    let reference = kind.reference();
    if reference.mid_sides.is_empty() {
        return facet.to_vec();
    }
    let sides = reference.mid_sides.iter().enumerate();
    sides.flat_map(|(place, ends)| [facet[ends[0]], facet[reference.corners + place]]).collect()
}

/// The obstacle over the facets whose nodes all have rows: each node goes the way to it, as many times as the body has moved.
fn sheet(model: &Model, obstacle: usize, ways_of: &[(usize, [f64; 3])], (magnification, near): (f64, f64)) -> Sheet {
    let placed = &model.obstacles()[obstacle];
    let mut ways: Vec<Option<[f64; 3]>> = vec![None; model.mesh().nodes().len()];
    for &(node, way) in ways_of {
        let way = way.map(|part| magnification * part);
        let far = way.iter().map(|part| part * part).sum::<f64>().sqrt() > near;
        ways[node] = (!far).then_some(way);
    }
    let at = |node: usize| {
        let (place, way) = (model.mesh().nodes()[node], ways[node]?);
        Some([0, 1, 2].map(|axis| place[axis] + way[axis]))
    };
    let boundary = model.mesh().boundary(placed.boundary());
    let facets = boundary.into_iter().flat_map(|boundary| boundary.facets().map(|facet| outline(boundary.kind, facet)));
    let polygons = facets.filter_map(|facet| facet.into_iter().map(at).collect::<Option<Vec<_>>>()).collect();
    Sheet { polygons, approach: placed.approach() }
}

/// The contact with an obstacle, seen along its approach direction.
fn plan(answer: &Answer, obstacle: usize) -> Plan {
    let model = answer.model();
    let placed = &model.obstacles()[obstacle];
    let approach = placed.approach();
    let along = (0..3).max_by(|&a, &b| approach[a].abs().total_cmp(&approach[b].abs())).unwrap_or(2);
    let [first, second] = [[1, 2], [0, 2], [0, 1]][along];
    let count = model.mesh().nodes().len();
    let (mut pressure, mut is_closed, mut is_candidate) = (vec![0.0; count], vec![false; count], vec![false; count]);
    for (index, row) in model.rows().iter().enumerate().filter(|(_, row)| row.obstacle == obstacle) {
        pressure[row.node] = answer.pressure()[index];
        is_closed[row.node] = answer.contact_set().contains(index);
        is_candidate[row.node] = true;
    }
    let boundary = model.mesh().boundary(placed.boundary());
    let cells: Vec<Vec<usize>> = boundary
        .into_iter()
        .flat_map(|boundary| boundary.facets().map(|facet| outline(boundary.kind, facet)))
        .collect();
    let nodes: Vec<[f64; 2]> = model.mesh().nodes().iter().map(|node| [node[first], node[second]]).collect();
    let candidates: Vec<usize> = (0..count).filter(|&node| is_candidate[node]).collect();
    let window = plan_window(&nodes, &cells, &is_closed);
    let several = if model.obstacles().len() > 1 { format!(", obstacle {}", obstacle + 1) } else { String::new() };
    Plan {
        title: format!("contact on `{}` seen along {}{several}", placed.boundary(), ["x", "y", "z"][along]),
        axes: [["x", "y", "z"][first], ["x", "y", "z"][second]],
        closed: candidates.iter().map(|&node| is_closed[node]).collect(),
        candidates,
        nodes,
        cells,
        pressure,
        unit: model.units().pressure(),
        window,
    }
}

/// The cells at closed nodes and a little more, within the boundary; all of it where no node is closed.
fn plan_window(nodes: &[[f64; 2]], cells: &[Vec<usize>], is_closed: &[bool]) -> [[f64; 2]; 2] {
    let bounds = |chosen: &dyn Fn(&Vec<usize>) -> bool| {
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for &node in cells.iter().filter(|cell| chosen(cell)).flatten() {
            for (ends, &at) in bounds.iter_mut().zip(&nodes[node]) {
                *ends = [ends[0].min(at), ends[1].max(at)];
            }
        }
        bounds
    };
    let whole = bounds(&|_| true);
    let mut near = bounds(&|cell| cell.iter().any(|&node| is_closed[node]));
    if near[0][0] > near[0][1] {
        near = whole;
    }
    let span = (near[0][1] - near[0][0]).max(near[1][1] - near[1][0]);
    let margin = 0.04 * span;
    [0, 1].map(|axis| {
        [
            (near[axis][0] - BEYOND * span).max(whole[axis][0] - margin),
            (near[axis][1] + BEYOND * span).min(whole[axis][1] + margin),
        ]
    })
}

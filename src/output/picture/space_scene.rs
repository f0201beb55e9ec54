//! The content of the picture of a body in space, from its answer.

use std::path::Path;

use super::body::{FieldPanel, common_window};
use super::plan::Plan;
use super::space::{Colouring, Face, Sheet, SpacePicture};
use crate::error::Error;
use crate::fem::body::Region;
use crate::fem::element::FacetKind;
use crate::fem::geometry::{dot, length, minus};
use crate::fem::mesh::extent;
#[cfg(feature = "cli")]
use crate::output::draw::colour::Colour;
use crate::output::draw::drawing::Drawing;
use crate::output::file::write_picture;
use crate::output::plots::medium::Medium;
use crate::output::plots::ticks::brief;
use crate::output::view::field::{Painted, VON_MISES};
use crate::output::view::limits::common_limits;
use crate::output::view::magnified::{drawn_shift, magnification, obstacle_name};
use crate::scene::{Answer, Model, straight_cells};

/// An obstacle is drawn if it is at most this share of the size of the body away.
const NEAR: f64 = 0.25;
/// The plan view extends beyond the contact by this share of its size.
const BEYOND: f64 = 0.35;
/// The direction to the eye: from the front, above and a little from the right; contact faces turn it to their side.
const EYE: [f64; 3] = [0.5, -0.8, 0.55];
/// Slope of the line of sight against the contact of two bodies.
const TILT: f64 = 0.35;

/// The content of the picture of an answer in space.
pub(crate) struct SpaceScene<'a> {
    title: String,
    answer: &'a Answer,
    /// The field that is drawn.
    field: Painted,
}

impl<'a> SpaceScene<'a> {
    pub(crate) fn new(answer: &'a Answer, title: String) -> Result<Self, Error> {
        Ok(SpaceScene { title, answer, field: Painted::of(answer, &VON_MISES)? })
    }

    /// The obstacle that the body presses most.
    fn obstacle(&self) -> Option<usize> {
        let count = self.answer.model().obstacles().len();
        (0..count).max_by(|&a, &b| force(self.answer, a).total_cmp(&force(self.answer, b)))
    }

    fn draw(&self, shared: &Shared, plan: Option<&Plan>, medium: Medium) -> Drawing {
        let (model, Shared { magnification, .. }) = (self.answer.model(), *shared);
        let moved = model.mesh().nodes().iter().zip(self.answer.displacement().chunks_exact(3));
        let nodes: Vec<[f64; 3]> =
            moved.map(|(at, u)| [0, 1, 2].map(|axis| at[axis] + magnification * u[axis])).collect();
        let near = NEAR * model.mesh().size();
        let sheets: Vec<Sheet> = (0..model.obstacles().len())
            .filter(|&index| model.obstacles()[index].rigid().is_some())
            .map(|index| {
                let shift = drawn_shift(self.answer, index, magnification);
                sheet(model, index, &ways_to_obstacle(self.answer, index), (shift, near))
            })
            .collect();
        let times = brief(magnification);
        let heading = match magnification == 1.0 {
            true => "displaced body, to scale".to_string(),
            false => format!("displaced body, displacement × {times}"),
        };
        let picture = SpacePicture {
            title: &self.title,
            heading: &heading,
            length_unit: &model.units().length,
            nodes: &nodes,
            faces: &faces(model),
            colouring: Colouring::Field(FieldPanel {
                values: &self.field.values,
                quantity: self.field.quantity.clone(),
                limits: shared.limits,
            }),
            sheets: &sheets,
            obstacle_name: obstacle_name(magnification),
            eye: eye(model, shared.obstacle),
            plan,
            medium,
        };
        picture.draw()
    }
}

/// The common settings of all pictures of a series.
#[derive(Clone, Copy)]
struct Shared {
    magnification: f64,
    /// Ends of the colours.
    limits: [f64; 2],
    /// The obstacle in plan view.
    obstacle: Option<usize>,
}

/// Draws a series of one model in space with common colours, a common magnification and a common part of the contact: those of its
/// first `leading` pictures.
///
/// # Errors
/// As [`write_picture`].
pub(crate) fn draw_space_series(
    folder: &Path,
    series: &[(String, SpaceScene)],
    leading: usize,
    medium: Medium,
) -> Result<(), Error> {
    let leading_scenes = || series.iter().take(leading).map(|(_, scene)| scene);
    let [lowest, largest] = common_limits(leading_scenes().map(|scene| &scene.field.limits[..]));
    let shared = Shared {
        magnification: leading_scenes().map(|scene| magnification(scene.answer)).fold(f64::INFINITY, f64::min),
        limits: [lowest.min(0.0), largest],
        obstacle: leading_scenes().next_back().and_then(SpaceScene::obstacle),
    };
    let mut plans: Vec<Option<Plan>> =
        series.iter().map(|(_, scene)| shared.obstacle.map(|obstacle| plan(scene.answer, obstacle))).collect();
    let leading_plans = || plans.iter().take(leading).flatten();
    let window = common_window(leading_plans().map(|plan| plan.window));
    let limits = common_limits(leading_plans().map(|plan| &plan.pressure[..]));
    plans.iter_mut().flatten().for_each(|plan| (plan.window, plan.limits) = (window, limits));
    for ((stem, scene), plan) in series.iter().zip(&plans) {
        write_picture(folder, stem, &scene.draw(&shared, plan.as_ref(), medium))?;
    }
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

/// Direction from the body to the eye: on the side of the obstacle in view. Another body would hide the contact from there: the eye is
/// then beside the contact, a little on the side of the smaller of the two bodies.
pub(crate) fn eye(model: &Model, obstacle: Option<usize>) -> [f64; 3] {
    let Some(placed) = obstacle.and_then(|obstacle| model.obstacles().get(obstacle)) else { return EYE };
    let approach = placed.approach();
    if placed.rigid().is_some() {
        let side = |axis: usize| if approach[axis].abs() > 0.3 { approach[axis] } else { EYE[axis] };
        return [0, 1, 2].map(|axis| EYE[axis].abs().copysign(side(axis)));
    }
    let along = dot(EYE, approach);
    let aside = [0, 1, 2].map(|axis| EYE[axis] - along * approach[axis]);
    let tilt = if stands_on(model, obstacle) { -TILT } else { TILT };
    [0, 1, 2].map(|axis| aside[axis] / length(aside) + tilt * approach[axis])
}

/// Returns `true` if the body of the candidates of a pair is the smaller one.
fn stands_on(model: &Model, obstacle: Option<usize>) -> bool {
    let size = |node: usize| {
        let region = model.body().regions().iter().find(|region| region.nodes().contains(&node));
        let (low, high) = extent(region.map_or(&[][..], |region| &model.mesh().nodes()[region.nodes()]));
        length(minus(high, low))
    };
    let row = model.rows().iter().find(|row| Some(row.obstacle) == obstacle);
    let sizes = row.map(|row| row.ends().map(|(node, _)| size(node)).collect::<Vec<f64>>());
    sizes.is_some_and(|sizes| sizes.len() > 1 && sizes[0] < sizes[1])
}

/// The picture of a body in space before it is solved: the supported, loaded and candidate faces, and the obstacles at their gap.
#[cfg(feature = "cli")]
pub(crate) fn space_set_up(model: &Model, title: &str) -> Drawing {
    let nodes = model.mesh().nodes();
    let faces = faces(model);
    let mut held = vec![false; nodes.len()];
    model.held_nodes().iter().for_each(|node| held[node.node] = true);
    let mut candidate = vec![false; nodes.len()];
    model.rows().iter().for_each(|row| candidate[row.node] = true);
    let loaded: Vec<bool> = model.nodal_load().chunks_exact(3).map(|load| load.iter().any(|&f| f != 0.0)).collect();
    // A volume force loads every node; loaded faces are marked only if some nodes have no load.
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
            sheet(model, index, &ways, ([0.0; 3], NEAR * model.mesh().size()))
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
        obstacle_name: obstacle_name(1.0),
        eye: eye(model, (!model.obstacles().is_empty()).then_some(0)),
        plan: None,
        medium: Medium::Screen,
    };
    picture.draw()
}

/// The kinds of faces in the picture of a set-up, with their colours.
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

/// The nodes of the rows of an obstacle, each with the vector from its undeformed position to the present position of the obstacle.
fn ways_to_obstacle(answer: &Answer, obstacle: usize) -> Vec<(usize, [f64; 3])> {
    let model = answer.model();
    let approach = model.obstacles()[obstacle].approach();
    let travel = answer.travel(obstacle).unwrap_or(0.0);
    let rows = model.rows().iter().filter(|row| row.obstacle == obstacle);
    rows.map(|row| {
        let leans: f64 = row.normal.iter().zip(approach).map(|(n, a)| n * a).sum();
        let gap = row.gap - travel * leans;
        (row.node, row.normal.map(|part| gap * part))
    })
    .collect()
}

/// The obstacle over the facets with a row at every node, as far as it is near: each node is moved by its vector to the obstacle, then
/// all are shifted alike.
fn sheet(model: &Model, obstacle: usize, ways_of: &[(usize, [f64; 3])], (shift, near): ([f64; 3], f64)) -> Sheet {
    let placed = &model.obstacles()[obstacle];
    let mut ways: Vec<Option<[f64; 3]>> = vec![None; model.mesh().nodes().len()];
    for &(node, way) in ways_of {
        let far = way.iter().map(|part| part * part).sum::<f64>().sqrt() > near;
        ways[node] = (!far).then_some(way);
    }
    let at = |node: usize| {
        let (place, way) = (model.mesh().nodes()[node], ways[node]?);
        Some([0, 1, 2].map(|axis| place[axis] + way[axis] + shift[axis]))
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
        limits: [f64::NAN; 2],
        window,
    }
}

/// The window around the cells at closed nodes, with a margin, within the boundary; the whole boundary if no node is closed.
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

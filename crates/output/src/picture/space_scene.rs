//! The content of the picture of a body in space, from its answer.

use std::path::Path;

use super::body::{FieldPanel, common_window};
use super::plan::Plan;
use super::space::{Colouring, Face, Sheet, SpacePicture};
use crate::draw::colour::Colour;
use crate::draw::drawing::Drawing;
use crate::plots::medium::Medium;
use crate::plots::ticks::brief;
use crate::view::field::{Painted, VON_MISES};
use crate::view::limits::common_limits;
use crate::view::magnified::{drawn_shift, magnification, obstacle_name};
use crate::view::obstacle::{eye, ways_to_obstacle};
use signorini_mechanics::Error;
use signorini_mechanics::fem::geometry::length;
use signorini_mechanics::fem::{FacetKind, Region};
use signorini_mechanics::scene::{Answer, Model, PlacedObstacle};

/// An obstacle is drawn if it is at most this share of the size of the body away.
const NEAR: f64 = 0.25;
/// The plan view extends beyond the contact by this share of its size.
const BEYOND: f64 = 0.35;

/// The content of the picture of an answer in space.
pub(crate) struct SpaceScene<'a> {
    title: String,
    answer: &'a Answer,
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
        let answer = self.answer;
        let sheets =
            sheets(model, |index| (answer.travel(index).unwrap_or(0.0), drawn_shift(answer, index, magnification)));
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

/// Draws a series of one model in space with common colours, a common magnification and a common part of the contact:
/// those of its first `leading` pictures.
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
        scene.draw(&shared, plan.as_ref(), medium).write(folder, stem)?;
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

/// The picture of a body in space before it is solved: the supported, loaded and candidate faces, and the obstacles at
/// their gap.
pub(crate) fn space_set_up(model: &Model, title: &str) -> Drawing {
    let nodes = model.mesh().nodes();
    let faces = faces(model);
    let [mut held, mut candidate, mut opposite, mut loaded] = [(); 4].map(|()| vec![false; nodes.len()]);
    model.held_nodes().iter().for_each(|at| held[at.node] = true);
    model.rows().iter().for_each(|row| candidate[row.node] = true);
    let surfaces = model.obstacles().iter().filter_map(|placed| model.mesh().boundary(placed.other_body()?.0));
    surfaces.flat_map(|boundary| &boundary.connectivity).for_each(|&node| opposite[node] = true);
    model.loaded_nodes().for_each(|(node, _)| loaded[node] = true);
    // A volume force loads every node; loaded faces are marked only if some nodes have no load.
    let is_on_faces = loaded.iter().any(|&is_loaded| !is_loaded);
    let all = |flags: &[bool], face: &Face| face.outline.iter().all(|&node| flags[node]);
    let kind = |face: &Face| match () {
        () if all(&candidate, face) => 1,
        () if all(&opposite, face) => 2,
        () if all(&held, face) => 3,
        () if is_on_faces && all(&loaded, face) => 4,
        () => 0,
    };
    let kinds: Vec<usize> = faces.iter().map(kind).collect();
    let colours: Vec<Colour> = kinds.iter().map(|&kind| KINDS[kind].1).collect();
    let names: Vec<(&str, Colour)> =
        (0..KINDS.len()).filter(|kind| kinds.contains(kind)).map(|kind| KINDS[kind]).collect();
    let sheets = sheets(model, |_| (0.0, [0.0; 3]));
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
const KINDS: [(&str, Colour); 5] = [
    ("body", Colour(214, 220, 230)),
    ("candidates for contact", Colour(240, 190, 110)),
    ("opposite to them", Colour(201, 154, 217)),
    ("held", Colour(110, 175, 145)),
    ("loaded", Colour(225, 130, 120)),
];

/// The size of the force of an obstacle.
fn force(answer: &Answer, obstacle: usize) -> f64 {
    let rows = answer.model().rows().iter().zip(answer.multiplier()).filter(|(row, _)| row.obstacle == obstacle);
    rows.map(|(_, lambda)| -lambda).sum()
}

fn face(kind: FacetKind, facet: &[usize]) -> Face {
    Face { outline: outline(kind, facet), cells: kind.straight_cells(facet) }
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

/// The rigid obstacles over their facets with a row at every node, as far as they are near. `moved` gives the travel of
/// an obstacle against its approach direction, and the shift with which it is drawn.
fn sheets(model: &Model, moved: impl Fn(usize) -> (f64, [f64; 3])) -> Vec<Sheet> {
    let (nodes, near) = (model.mesh().nodes(), NEAR * model.mesh().size());
    let sheet = |(index, placed): (usize, &PlacedObstacle)| {
        let (travel, shift) = moved(index);
        let mut places = vec![None; nodes.len()];
        for (node, way) in ways_to_obstacle(model, index, travel) {
            let place = [0, 1, 2].map(|axis| nodes[node][axis] + way[axis] + shift[axis]);
            places[node] = (length(way) <= near).then_some(place);
        }
        let boundary = model.mesh().boundary(placed.boundary());
        let facets =
            boundary.into_iter().flat_map(|boundary| boundary.facets().map(|facet| outline(boundary.kind, facet)));
        let polygon = |facet: Vec<usize>| facet.into_iter().map(|node| places[node]).collect::<Option<Vec<_>>>();
        Sheet { polygons: facets.filter_map(polygon).collect(), approach: placed.approach() }
    };
    model.obstacles().iter().enumerate().filter(|(_, placed)| placed.rigid().is_some()).map(sheet).collect()
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

/// The window around the cells at closed nodes, with a margin, within the boundary; the whole boundary if no node is
/// closed.
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

//! The content of the picture of a body in the plane, as owned plain data.

use std::collections::HashMap;
use std::path::Path;

use super::arrows::{Arrow, ArrowKind};
use super::body::{ContactPicture, FieldPanel, common_window};
use super::obstacle::ObstacleLine;
use crate::draw::drawing::Drawing;
use crate::plots::medium::Medium;
use crate::view::field::{Painted, SIGMA_2, VON_MISES};
use crate::view::limits::common_limits;
use crate::view::magnified::{drawn_shift, magnification};
use crate::view::obstacle::outline;
use signorini_mechanics::Error;
use signorini_mechanics::fem::Mesh;
use signorini_mechanics::scene::{Answer, Model};

/// The content of one picture.
pub(crate) struct PlaneScene {
    title: String,
    pub axes: [&'static str; 2],
    pub length_unit: String,
    pub nodes: Vec<[f64; 2]>,
    elements: Vec<Vec<usize>>,
    displacement: Vec<f64>,
    /// None before the model is solved.
    fields: Vec<Painted>,
    /// Magnification of the displacement that suits this answer.
    magnification: f64,
    obstacles: Vec<Outline>,
    candidates: Vec<usize>,
    closed: Vec<bool>,
    arrows: Vec<Arrow>,
}

/// The surface of a rigid obstacle.
struct Outline {
    /// Its number in the model.
    obstacle: usize,
    line: Vec<[f64; 2]>,
    inside: [f64; 2],
    /// Its shift in the picture for each unit of magnification beyond 1.
    carried: [f64; 2],
}

impl PlaneScene {
    /// The model before it is solved.
    pub(crate) fn of_model(model: &Model) -> Self {
        let mut scene = PlaneScene::unsolved(model, |index| model.obstacles()[index].shift(model.gap()));
        scene.elements = scene.polygons(model.mesh());
        scene
    }

    /// Nodes, candidates and obstacles, each moved by its `shift`; nothing is displaced, and no candidate is closed.
    fn unsolved(model: &Model, shift: impl Fn(usize) -> f64) -> Self {
        let mut candidates: Vec<usize> = model.rows().iter().map(|row| row.node).collect();
        candidates.sort_unstable();
        candidates.dedup();
        let nodes: Vec<[f64; 2]> = model.mesh().nodes().iter().map(|&[x, y, _]| [x, y]).collect();
        let rigid = (0..model.obstacles().len()).filter(|&index| model.obstacles()[index].rigid().is_some());
        let placed = |index: usize| {
            let [x, y, _] = model.obstacles()[index].approach();
            let line = outline(model, index, shift(index));
            Outline { obstacle: index, line, inside: [x, y], carried: [0.0; 2] }
        };
        PlaneScene {
            title: String::new(),
            axes: axes(model),
            length_unit: model.units().length.clone(),
            elements: Vec::new(),
            displacement: vec![0.0; 2 * nodes.len()],
            nodes,
            fields: Vec::new(),
            magnification: 1.0,
            obstacles: rigid.map(placed).collect(),
            closed: vec![false; candidates.len()],
            candidates,
            arrows: Vec::new(),
        }
    }

    pub(crate) fn new(answer: &Answer, title: String) -> Result<Self, Error> {
        let model = answer.model();
        let fields = vec![Painted::of(answer, &SIGMA_2)?, Painted::of(answer, &VON_MISES)?];
        let (displacement, magnification, arrows) =
            (answer.displacement().to_vec(), magnification(answer), arrows(answer)?);
        let unsolved = PlaneScene::unsolved(model, |index| answer.shift(index));
        let mut scene = PlaneScene { title, displacement, fields, magnification, arrows, ..unsolved };
        let mut is_closed = vec![false; model.mesh().nodes().len()];
        answer.contact_set().iter().for_each(|row| is_closed[model.rows()[row].node] = true);
        scene.closed = scene.candidates.iter().map(|&node| is_closed[node]).collect();
        for outline in &mut scene.obstacles {
            outline.carried = [0, 1].map(|axis| drawn_shift(answer, outline.obstacle, 2.0)[axis]);
        }
        scene.elements = scene.polygons(model.mesh());
        Ok(scene)
    }

    /// The outlines of the elements as polygons. The edges of quadratic elements are curves: each is divided at its
    /// mid-side node and halfway to that node. The added nodes have the values of the shape functions there.
    fn polygons(&mut self, mesh: &Mesh) -> Vec<Vec<usize>> {
        let mut quarters: HashMap<[usize; 2], usize> = HashMap::new();
        let mut polygons = Vec::with_capacity(mesh.element_count());
        for (element, nodes) in mesh.elements().enumerate() {
            let kind = mesh.kind_of(element);
            if !kind.is_quadratic() {
                polygons.push(nodes.to_vec());
                continue;
            }
            let mid_sides = kind.reference().mid_sides;
            let mut polygon = Vec::with_capacity(4 * mid_sides.len());
            for (place, &[from, to]) in mid_sides.iter().enumerate() {
                let [from, middle, to] = [nodes[from], nodes[kind.corners() + place], nodes[to]];
                let mut quarter = |near: usize, far: usize| {
                    *quarters.entry([near, middle]).or_insert_with(|| self.add_between(near, middle, far))
                };
                polygon.extend([from, quarter(from, to), middle, quarter(to, from)]);
            }
            polygons.push(polygon);
        }
        polygons
    }

    /// Adds the node halfway from a corner to a mid-side node.
    fn add_between(&mut self, near: usize, middle: usize, far: usize) -> usize {
        const WEIGHTS: [f64; 3] = [0.375, 0.75, -0.125];
        let ends = [near, middle, far];
        let mean =
            |value: &dyn Fn(usize) -> f64| ends.iter().zip(WEIGHTS).map(|(&end, weight)| weight * value(end)).sum();
        let place = [0, 1].map(|axis| mean(&|node| self.nodes[node][axis]));
        let moved: [f64; 2] = [0, 1].map(|axis| mean(&|node| self.displacement[2 * node + axis]));
        let values: Vec<f64> = self.fields.iter().map(|field| mean(&|node| field.values[node])).collect();
        self.nodes.push(place);
        self.displacement.extend(moved);
        self.fields.iter_mut().zip(values).for_each(|(field, value)| field.values.push(value));
        self.nodes.len() - 1
    }

    /// The same with the displaced body in all panels, for a body in flight.
    pub(crate) fn in_place(mut self) -> Self {
        for (node, moved) in self.nodes.iter_mut().zip(self.displacement.chunks_exact(2)) {
            *node = [node[0] + moved[0], node[1] + moved[1]];
        }
        self.displacement.fill(0.0);
        self
    }

    /// The fields, each with its own range as the ends of its colours.
    pub(crate) fn fields(&self) -> Vec<FieldPanel<'_>> {
        let panels = self.fields.iter().map(|Painted { quantity, values, limits, .. }| FieldPanel {
            values,
            quantity: quantity.clone(),
            limits: *limits,
        });
        panels.collect()
    }

    /// The scene by itself, with its own magnification.
    pub(crate) fn draw(&self) -> Result<Drawing, Error> {
        let (fields, outlines) = (self.fields(), self.obstacles(self.magnification));
        self.picture(&fields, &lines(&outlines), self.magnification).draw()
    }

    /// The obstacles beside a body with magnified displacement: each keeps its shape and is shifted to its contact.
    pub(crate) fn obstacles(&self, magnification: f64) -> Vec<(Vec<[f64; 2]>, [f64; 2])> {
        let by = magnification - 1.0;
        let shifted = |outline: &Outline| {
            let [x, y] = outline.carried;
            outline.line.iter().map(|point| [point[0] + by * x, point[1] + by * y]).collect()
        };
        self.obstacles.iter().map(|outline| (shifted(outline), outline.inside)).collect()
    }

    pub(crate) fn picture<'a>(
        &'a self,
        fields: &'a [FieldPanel<'a>],
        obstacles: &'a [ObstacleLine<'a>],
        magnification: f64,
    ) -> ContactPicture<'a> {
        ContactPicture {
            title: &self.title,
            axes: self.axes,
            length_unit: &self.length_unit,
            nodes: &self.nodes,
            elements: &self.elements,
            displacement: &self.displacement,
            magnification,
            fields,
            obstacles,
            candidates: &self.candidates,
            closed: &self.closed,
            arrows: &self.arrows,
            medium: Medium::Screen,
            window: None,
        }
    }
}

/// The names of the coordinates; for a body of revolution the radius and the axis.
pub(crate) fn axes(model: &Model) -> [&'static str; 2] {
    if model.body().formulation().is_axisymmetric() { ["r", "z"] } else { ["x", "y"] }
}

/// Contact forces, reactions of supports and loads, each with its point of application and the displacement of that
/// point.
fn arrows(answer: &Answer) -> Result<Vec<Arrow>, Error> {
    let model = answer.model();
    let unit = &model.units().force;
    let mut arrows = Vec::new();
    for resultant in answer.resultants()? {
        let kind = match resultant.of.as_str() {
            of if of.starts_with("obstacles") || of.starts_with("pair") => ArrowKind::Contact,
            of if of.starts_with("loads") => ArrowKind::Load,
            _ => ArrowKind::Support,
        };
        let (&[x, y], Some(centre)) = (&resultant.force[..], &resultant.centre) else { continue };
        let at = [centre[0], centre.get(1).copied().unwrap_or(0.0)];
        let node = model.mesh().nearest_node([at[0], at[1], 0.0]).map_or(0, |(node, _)| node);
        let moved = answer.displacement().get(2 * node..2 * node + 2).map_or([0.0; 2], |u| [u[0], u[1]]);
        // In a body of revolution the radial component cancels around the circle.
        let force = if model.body().formulation().is_axisymmetric() { [0.0, y] } else { [x, y] };
        arrows.push(Arrow { kind, at, moved, force, unit: unit.clone() });
    }
    Ok(arrows)
}

/// Draws a series with common colours, a common window and a common magnification: those of its first `leading`
/// pictures. The ends of the colour bar mark values outside the colours.
pub(crate) fn draw_series(
    folder: &Path,
    series: &[(String, PlaneScene)],
    leading: usize,
    medium: Medium,
) -> Result<(), Error> {
    let leading_scenes = || series.iter().take(leading).map(|(_, scene)| scene);
    let magnification = leading_scenes().map(|scene| scene.magnification).fold(f64::INFINITY, f64::min);
    let limits =
        [0, 1].map(|field| match common_limits(leading_scenes().map(|scene| &scene.fields[field].limits[..])) {
            // If this field is zero, the other fields give the scale of a small stress.
            [low, high] if low == 0.0 && high == 0.0 => {
                let largest = leading_scenes().map(|scene| scene.fields[field].largest).fold(0.0, f64::max);
                [-largest, largest]
            }
            limits => limits,
        });
    let outlines: Vec<_> = series.iter().map(|(_, scene)| scene.obstacles(magnification)).collect();
    let lines: Vec<Vec<ObstacleLine>> = outlines.iter().map(|outlines| lines(outlines)).collect();
    let fields: Vec<Vec<FieldPanel>> = series
        .iter()
        .map(|(_, scene)| {
            scene.fields().into_iter().zip(limits).map(|(field, limits)| FieldPanel { limits, ..field }).collect()
        })
        .collect();
    let pictures: Vec<ContactPicture> = series
        .iter()
        .zip(fields.iter().zip(&lines))
        .map(|((_, scene), (fields, lines))| scene.picture(fields, lines, magnification))
        .collect();
    let window = common_window(pictures.iter().take(leading).map(ContactPicture::window));
    for ((stem, _), mut picture) in series.iter().zip(pictures) {
        (picture.window, picture.medium) = (Some(window), medium);
        picture.draw()?.write(folder, stem)?;
    }
    Ok(())
}

/// Lines that borrow their points.
pub(crate) fn lines(outlines: &[(Vec<[f64; 2]>, [f64; 2])]) -> Vec<ObstacleLine<'_>> {
    outlines.iter().map(|(points, inside)| ObstacleLine { points, inside: *inside }).collect()
}

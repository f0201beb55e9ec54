//! The content of the picture of a body in the plane, as owned plain data.

use std::collections::HashMap;
use std::path::Path;

use super::arrows::{Arrow, ArrowKind};
use super::body::{ContactPicture, FieldPanel, ROUNDING, common_limits, common_window};
use super::medium::Medium;
use super::obstacle::ObstacleLine;
use super::ticks::{Quantity, amount, brief};
use super::write_picture;
use crate::error::Error;
use crate::fem::mesh::Mesh;
use crate::scene::{Answer, Model};

/// Pieces of the line of an obstacle.
pub(super) const OUTLINE_SEGMENTS: usize = 200;

/// Largest number of pieces of the line of a magnified obstacle between two nodes.
const BETWEEN_NODES: usize = 10;

/// The largest displacement is drawn at about this share of the size of the body.
const SEEN: f64 = 0.05;

/// The content of one picture.
pub(super) struct PlaneScene {
    title: String,
    axes: [&'static str; 2],
    length_unit: String,
    quantities: [Quantity; 2],
    nodes: Vec<[f64; 2]>,
    elements: Vec<Vec<usize>>,
    displacement: Vec<f64>,
    /// Second principal stress and von Mises stress.
    fields: [Vec<f64>; 2],
    /// The largest stress.
    largest: f64,
    /// `true` if an obstacle is another body. It cannot be moved in the picture, so displacements are then not magnified.
    has_pairs: bool,
    obstacles: Vec<Outline>,
    candidates: Vec<usize>,
    closed: Vec<bool>,
    arrows: Vec<Arrow>,
}

/// The surface of a rigid obstacle, and its distances from the candidates, from which a magnified surface is drawn.
struct Outline {
    line: Vec<[f64; 2]>,
    inside: [f64; 2],
    /// Positions of the candidates, and places between them, in the order of the boundary, each with the vector to the obstacle.
    over: Vec<[[f64; 2]; 2]>,
}

impl PlaneScene {
    pub(super) fn new(answer: &Answer, title: String) -> Result<Self, Error> {
        let (model, set) = (answer.model(), answer.contact_set());
        let mut candidates: Vec<usize> = model.rows().iter().map(|row| row.node).collect();
        candidates.sort_unstable();
        candidates.dedup();
        let mut is_closed = vec![false; model.mesh().nodes().len()];
        set.iter().for_each(|row| is_closed[model.rows()[row].node] = true);
        let stress = &answer.stress()?.nodes;
        let largest = stress.iter().fold(0.0, |largest: f64, of| largest.max(of.sigma_1.abs()).max(of.sigma_2.abs()));
        // Values this small beside the largest stress are rounding.
        let without_rounding = |value: f64| if value.abs() <= ROUNDING * largest { 0.0 } else { value };
        let stress_unit = model.units().pressure();
        let mut scene = PlaneScene {
            title,
            axes: axes(model),
            length_unit: model.units().length.clone(),
            quantities: ["second principal stress σ₂", "von Mises stress"]
                .map(|name| Quantity::new(name, &stress_unit)),
            nodes: model.mesh().nodes().iter().map(|&[x, y, _]| [x, y]).collect(),
            elements: Vec::new(),
            displacement: answer.displacement().to_vec(),
            fields: [
                stress.iter().map(|of| without_rounding(of.sigma_2)).collect(),
                stress.iter().map(|of| without_rounding(of.von_mises)).collect(),
            ],
            largest,
            has_pairs: has_pairs(model),
            obstacles: outlines(answer),
            closed: candidates.iter().map(|&node| is_closed[node]).collect(),
            candidates,
            arrows: arrows(answer)?,
        };
        scene.elements = scene.polygons(model.mesh());
        Ok(scene)
    }

    /// The outlines of the elements as polygons. The edges of quadratic elements are curves: each is divided at its mid-side node and
    /// halfway to that node. The added nodes have the values of the shape functions there.
    fn polygons(&mut self, mesh: &Mesh) -> Vec<Vec<usize>> {
        let kind = mesh.kind();
        if !kind.is_quadratic() {
            return mesh.elements().map(<[usize]>::to_vec).collect();
        }
        let mid_sides = kind.reference().mid_sides;
        let mut quarters: HashMap<[usize; 2], usize> = HashMap::new();
        let mut polygons = Vec::with_capacity(mesh.element_count());
        for nodes in mesh.elements() {
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
        let values: [f64; 2] = [0, 1].map(|field| mean(&|node| self.fields[field][node]));
        self.nodes.push(place);
        self.displacement.extend(moved);
        self.fields.iter_mut().zip(values).for_each(|(field, value)| field.push(value));
        self.nodes.len() - 1
    }

    /// The same with the displaced body in all panels, for a body in flight.
    pub(super) fn in_place(mut self) -> Self {
        for (node, moved) in self.nodes.iter_mut().zip(self.displacement.chunks_exact(2)) {
            *node = [node[0] + moved[0], node[1] + moved[1]];
        }
        self.displacement.fill(0.0);
        self
    }

    /// Magnification that makes the displacement visible: 1, 2 or 5 times a power of ten, at least 1.
    fn magnification(&self) -> f64 {
        if self.has_pairs {
            return 1.0;
        }
        let extent = |axis: usize| {
            let ends = common_limits([&self.nodes.iter().map(|node| node[axis]).collect::<Vec<f64>>()[..]]);
            ends[1] - ends[0]
        };
        let moved = self.displacement.chunks_exact(2).map(|u| u[0].hypot(u[1])).filter(|moved| moved.is_finite());
        rounded_down(SEEN * extent(0).max(extent(1)) / moved.fold(0.0, f64::max))
    }

    /// The fields, each with the range of its own values as the ends of its colours.
    pub(super) fn fields(&self) -> Vec<FieldPanel<'_>> {
        let panels = self.fields.iter().zip(&self.quantities);
        panels
            .map(|(values, quantity)| FieldPanel { values, quantity: quantity.clone(), limits: [f64::NAN; 2] })
            .collect()
    }

    /// The scene by itself, with its own magnification.
    ///
    /// # Errors
    /// As [`ContactPicture::draw`].
    #[cfg(feature = "cli")]
    pub(super) fn draw(&self) -> Result<super::Drawing, Error> {
        let magnification = self.magnification();
        let (fields, outlines) = (self.fields(), self.obstacles(magnification));
        self.picture(&fields, &lines(&outlines), magnification).draw()
    }

    /// The obstacles beside a body with magnified displacement. Each gap is magnified too, so that body and obstacle touch in the
    /// picture at their points of contact.
    pub(super) fn obstacles(&self, magnification: f64) -> Vec<(Vec<[f64; 2]>, [f64; 2])> {
        self.obstacles.iter().map(|outline| (outline.magnified(magnification), outline.inside)).collect()
    }

    pub(super) fn picture<'a>(
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

impl Outline {
    /// The candidates around the nearest one, as long as the boundary continues across the approach direction. Candidates of a closed
    /// boundary that face away from the obstacle have no part of the obstacle in front.
    fn facing(&self) -> &[[[f64; 2]; 2]] {
        let across = |[[x, y], _]: &[[f64; 2]; 2]| self.inside[0] * y - self.inside[1] * x;
        let distance = |[_, way]: &[[f64; 2]; 2]| way[0] * self.inside[0] + way[1] * self.inside[1];
        let nearest = (0..self.over.len()).min_by(|&a, &b| distance(&self.over[a]).total_cmp(&distance(&self.over[b])));
        let Some(nearest) = nearest else { return &self.over };
        let goes_on =
            |from: usize, to: usize, sign: f64| sign * (across(&self.over[to]) - across(&self.over[from])) > 0.0;
        let (mut first, mut last) = (nearest, nearest);
        let beside = (nearest + 1).min(self.over.len() - 1).max(1);
        let sign = if across(&self.over[beside]) > across(&self.over[beside - 1]) { 1.0 } else { -1.0 };
        while last + 1 < self.over.len() && goes_on(last, last + 1, sign) {
            last += 1;
        }
        while first > 0 && goes_on(first - 1, first, sign) {
            first -= 1;
        }
        &self.over[first..=last]
    }

    fn magnified(&self, magnification: f64) -> Vec<[f64; 2]> {
        if magnification == 1.0 || self.over.len() < 2 {
            return self.line.clone();
        }
        let mut points: Vec<[f64; 2]> =
            self.facing().iter().map(|[at, way]| [0, 1].map(|axis| at[axis] + magnification * way[axis])).collect();
        if points.len() < 2 {
            return self.line.clone();
        }
        // The line continues straight beyond the candidates.
        let beyond =
            |last: [f64; 2], before: [f64; 2]| [0, 1].map(|axis| last[axis] + 50.0 * (last[axis] - before[axis]));
        let (first, last) = (beyond(points[0], points[1]), beyond(points[points.len() - 1], points[points.len() - 2]));
        points.insert(0, first);
        points.push(last);
        points
    }
}

/// 1, 2 or 5 times a power of ten, at most `value`; 1 if the result is less than 1 or not a number.
pub(super) fn rounded_down(value: f64) -> f64 {
    if value.is_finite() && value >= 2.0 { rounded_length(value) } else { 1.0 }
}

/// 1, 2 or 5 times a power of ten, at most `value`, which is positive.
pub(super) fn rounded_length(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let factor = [5.0, 2.0, 1.0].into_iter().find(|factor| factor * power <= value * 1.000001).unwrap_or(1.0);
    factor * power
}

/// The names of the coordinates; for a body of revolution the radius and the axis.
pub(super) fn axes(model: &Model) -> [&'static str; 2] {
    if model.body().formulation().is_axisymmetric() { ["r", "z"] } else { ["x", "y"] }
}

/// Returns `true` if an obstacle of the model is another of its bodies.
pub(super) fn has_pairs(model: &Model) -> bool {
    model.obstacles().iter().any(|obstacle| obstacle.rigid().is_none())
}

fn outlines(answer: &Answer) -> Vec<Outline> {
    let model = answer.model();
    let rigid = (0..model.obstacles().len()).filter(|&index| model.obstacles()[index].rigid().is_some());
    let outline = |index: usize| {
        let [x, y, _] = model.obstacles()[index].approach();
        Outline {
            line: model.obstacles()[index].outline(answer.shift(index), OUTLINE_SEGMENTS),
            inside: [x, y],
            over: over(answer, index),
        }
    };
    rigid.map(outline).collect()
}

/// Places along the candidates of an obstacle, each with the vector to the obstacle: the candidates, and places between two neighbours, so
/// that a round obstacle is not drawn as a polygon of the mesh.
fn over(answer: &Answer, index: usize) -> Vec<[[f64; 2]; 2]> {
    let (model, ways) = (answer.model(), ways_to_obstacle(answer, index));
    let at = |node: usize| model.mesh().nodes()[node];
    let pieces = (OUTLINE_SEGMENTS / ways.len().max(1)).clamp(1, BETWEEN_NODES);
    let between = |from: usize, to: usize, piece: usize| {
        let share = piece as f64 / pieces as f64;
        let place = [0, 1, 2].map(|axis| (1.0 - share) * at(from)[axis] + share * at(to)[axis]);
        let row = model.obstacles()[index].rigid()?.shifted_row(place, answer.shift(index)).ok()??;
        Some([[place[0], place[1]], [row.gap * row.normal[0], row.gap * row.normal[1]]])
    };
    let mut over = Vec::new();
    for (number, (node, way)) in ways.iter().enumerate() {
        over.push([[at(*node)[0], at(*node)[1]], [way[0], way[1]]]);
        if let Some((next, _)) = ways.get(number + 1) {
            over.extend((1..pieces).filter_map(|piece| between(*node, *next, piece)));
        }
    }
    over
}

/// The nodes of the rows of an obstacle, each with the vector from its undeformed position to the present position of the obstacle.
pub(super) fn ways_to_obstacle(answer: &Answer, obstacle: usize) -> Vec<(usize, [f64; 3])> {
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

/// Contact forces, reactions of supports and loads, each with its point of application and the displacement of that point.
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

/// Draws a series with common colours, a common window and a common magnification: those of its first `leading` pictures. The ends of
/// the colour bar mark values outside the colours.
///
/// # Errors
/// As [`ContactPicture::draw`] and [`write_picture`].
pub(super) fn draw_series(
    folder: &Path,
    series: &[(String, PlaneScene)],
    leading: usize,
    medium: Medium,
) -> Result<(), Error> {
    let leading_scenes = || series.iter().take(leading).map(|(_, scene)| scene);
    let magnification = leading_scenes().map(PlaneScene::magnification).fold(f64::INFINITY, f64::min);
    let limits = [0, 1].map(|field| match common_limits(leading_scenes().map(|scene| &scene.fields[field][..])) {
        // If this field is zero, the other fields give the scale of a small stress.
        [low, high] if low == 0.0 && high == 0.0 => {
            let largest = leading_scenes().map(|scene| scene.largest).fold(0.0, f64::max);
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
        write_picture(folder, stem, &picture.draw()?)?;
    }
    Ok(())
}

/// Lines that borrow their points.
pub(super) fn lines(outlines: &[(Vec<[f64; 2]>, [f64; 2])]) -> Vec<ObstacleLine<'_>> {
    outlines.iter().map(|(points, inside)| ObstacleLine { points, inside: *inside }).collect()
}

/// The state of the scene: its gap, or the forces that press its obstacles.
pub(super) fn state(model: &Model) -> String {
    let amounts = pressing_amounts(model);
    match &amounts[..] {
        [] => format!("gap {} {}", brief(model.gap()), model.units().length).trim_end().to_owned(),
        [one] => format!("force {one}"),
        [first, others @ ..] if others.iter().all(|other| other == first) => format!("force {first} each"),
        _ => format!("forces {}", amounts.join(" and ")),
    }
}

/// The forces that press obstacles, in words.
pub(super) fn pressing_amounts(model: &Model) -> Vec<String> {
    model.pressing_forces().into_iter().map(|force| amount(force, &model.units().force)).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::{Outline, outlines};
    use crate::qp::{Settings, solve};
    use crate::scene::{Answer, Scene};

    /// Four cells before a circle: its magnified line turns a little at many points, not much at five.
    #[test]
    fn a_magnified_circle_is_round_between_the_nodes() {
        let text = r#"{
            "body": {"rectangle": {"x": {"points": [0, 4], "divisions": [4]}, "y": {"points": [0, 2], "divisions": [2]}}},
            "material": {"young": 100, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [2, 1.9], "radius": 4}}}]
        }"#;
        let scene: Scene = serde_json::from_str(text).unwrap();
        let model = Arc::new(scene.build().unwrap());
        let solution = solve(model.problem(), &Settings::default()).unwrap();
        let answer = Answer::of(model, &solution).unwrap();
        let line = outlines(&answer)[0].magnified(5.0);
        let slopes: Vec<f64> =
            line.windows(2).map(|ends| ((ends[1][1] - ends[0][1]) / (ends[1][0] - ends[0][0])).atan()).collect();
        let sharpest = slopes.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(sharpest < 0.2, "{sharpest}");
    }

    #[test]
    fn of_a_closed_boundary_the_half_that_looks_away_has_no_obstacle_before_it() {
        // A circle of radius 1 in the order of its boundary, from its lowest point; a plane at y = 2 comes from above.
        let at = |number: usize| {
            let angle = std::f64::consts::TAU * number as f64 / 16.0;
            [angle.sin(), -angle.cos()]
        };
        let over: Vec<[[f64; 2]; 2]> = (0..16).map(|number| [at(number), [0.0, 2.0 - at(number)[1]]]).collect();
        let line = vec![[-3.0, 2.0], [3.0, 2.0]];
        let outline = Outline { line: line.clone(), inside: [0.0, 1.0], over };
        let facing = outline.facing();
        assert!(facing.iter().all(|[[_, y], _]| *y > -1e-12), "{facing:?}");
        assert_eq!(facing.len(), 9, "from one side to the other");
        // Without magnification the obstacle keeps its own line.
        assert_eq!(outline.magnified(1.0), line);
        let lowest = outline.magnified(3.0).into_iter().map(|[_, y]| y).fold(f64::INFINITY, f64::min);
        assert!((lowest - 4.0).abs() < 1e-12, "three times the smallest gap above the top: {lowest}");
    }
}

//! An answer along a straight line: place, displacement, stress and pressure, with units.

use std::collections::BTreeMap;

use crate::plots::plot::{Plot, Series};
use crate::plots::ticks::Quantity;
use signorini_mechanics::Error;
use signorini_mechanics::fem::{Boundary, PathPoint, Region};
use signorini_mechanics::scene::{Answer, Model};

const AXES: [&str; 3] = ["x", "y", "z"];
/// The components of the stress: the first of a bar, the first four in the plane.
const STRESSES: [&str; 6] = ["sigma_xx", "sigma_yy", "sigma_zz", "sigma_xy", "sigma_yz", "sigma_zx"];
/// The share of the size of the mesh by which two pieces of a line may be apart by rounding.
const TOUCHING: f64 = 1e-9;

/// An answer along a line.
#[derive(Clone, Debug)]
pub struct Along {
    /// The ends of the line, in length.
    pub ends: [[f64; 3]; 2],
    /// The quantity of each number of a point.
    pub columns: Vec<Quantity>,
    /// The parts of the line in the elements, in its order within each body; empty if it meets no body.
    pub pieces: Vec<Piece>,
}

/// A line within an element. Neighbours have the same place and their own stresses where they meet.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The number of the body, from 0.
    pub body: usize,
    /// The number of the element, from 0.
    pub element: usize,
    /// `true` if the line was not in this body just before.
    pub is_apart: bool,
    /// A number for each column at each point; NaN for the pressure where the line does not lie on a contact.
    pub points: Vec<Vec<f64>>,
}

/// A point of the line with the answer there.
struct At<'a> {
    point: &'a PathPoint,
    displacement: [f64; 3],
    pressure: f64,
}

type Column = (Quantity, Box<dyn Fn(&At) -> f64>);

impl Along {
    /// The values of an answer along the line between `ends` (three coordinates each, in length), piece by piece.
    ///
    /// # Errors
    /// Those of [`Answer::stress`].
    pub fn of(answer: &Answer, ends: [[f64; 3]; 2]) -> Result<Self, Error> {
        let (model, columns, contacts) = (answer.model(), columns(answer.model()), Contacts::of(answer));
        let (dimension, touching) = (model.mesh().dimension(), TOUCHING * model.mesh().size());
        let mut pieces: Vec<Piece> = Vec::new();
        let mut reached = f64::NEG_INFINITY;
        for piece in model.body().along(answer.displacement(), ends)? {
            let nodes = model.mesh().element(piece.element);
            let pressures = contacts.on(&piece.side().map(|local| nodes[local]).collect::<Vec<usize>>());
            let row = |point: &PathPoint| -> Vec<f64> {
                let mean = |value: &dyn Fn(usize) -> f64| {
                    nodes.iter().zip(&point.weights).map(|(&node, weight)| weight * value(node)).sum::<f64>()
                };
                let moved = |axis: usize| mean(&|node| answer.displacement()[dimension * node + axis]);
                let at = At {
                    point,
                    displacement: [0, 1, 2].map(|axis| if axis < dimension { moved(axis) } else { 0.0 }),
                    pressure: pressures.map_or(f64::NAN, |of| mean(&|node| of.get(&node).copied().unwrap_or(0.0))),
                };
                columns.iter().map(|(_, value)| value(&at)).collect()
            };
            let is_behind = |region: &&Region| region.elements().end <= piece.element;
            let body = model.body().regions().iter().take_while(is_behind).count();
            let is_apart = pieces.last().is_none_or(|last| last.body != body) || piece.start() > reached + touching;
            pieces.push(Piece {
                body,
                element: piece.element,
                is_apart,
                points: piece.points.iter().map(row).collect(),
            });
            reached = piece.end();
        }
        Ok(Along { ends, columns: columns.into_iter().map(|(quantity, _)| quantity).collect(), pieces })
    }
}

/// The facets that may touch an obstacle, with the pressures at their nodes.
struct Contacts<'a> {
    /// By obstacle and node.
    pressures: Vec<BTreeMap<usize, f64>>,
    /// The facets around each node, each with its obstacle, in the order of the obstacles.
    facets: BTreeMap<usize, Vec<(usize, &'a [usize])>>,
}

impl<'a> Contacts<'a> {
    fn of(answer: &'a Answer) -> Self {
        let model = answer.model();
        let mut pressures = vec![BTreeMap::new(); model.obstacles().len()];
        for (row, pressure) in model.rows().iter().zip(answer.pressure()) {
            let nodes = row.ends.iter().take(if row.is_mean { 1 } else { 2 });
            nodes.for_each(|(node, _)| *pressures[row.obstacle].entry(*node).or_insert(0.0) += pressure);
        }
        for (row, [pressure, _]) in model.rows_across().iter().zip(answer.across()) {
            *pressures[row.obstacle].entry(row.node).or_insert(0.0) += pressure;
        }
        let mut facets: BTreeMap<usize, Vec<(usize, &[usize])>> = BTreeMap::new();
        for (obstacle, own) in pressures.iter().enumerate() {
            for facet in model.mesh().boundaries().iter().flat_map(Boundary::facets) {
                if facet.iter().all(|node| own.contains_key(node)) {
                    facet.iter().for_each(|&node| facets.entry(node).or_default().push((obstacle, facet)));
                }
            }
        }
        Contacts { pressures, facets }
    }

    /// The pressures by node of the first obstacle that a facet with these nodes may touch.
    fn on(&self, nodes: &[usize]) -> Option<&BTreeMap<usize, f64>> {
        let around = self.facets.get(nodes.first()?)?;
        let (obstacle, _) = around.iter().find(|(_, facet)| nodes.iter().all(|node| facet.contains(node)))?;
        Some(&self.pressures[*obstacle])
    }
}

impl Along {
    /// A plot of each quantity but the place over the length of the line, with a line for each body; without those that
    /// are known nowhere.
    pub fn plots(&self, model: &Model) -> Vec<Plot> {
        let regions = model.body().regions();
        let mut plots = Vec::new();
        for (column, quantity) in self.columns.iter().enumerate().skip(1 + model.mesh().dimension()) {
            let of_body = |(body, region): (usize, &Region)| {
                let mut points: Vec<[f64; 2]> = Vec::new();
                for piece in self.pieces.iter().filter(|piece| piece.body == body) {
                    points.extend(piece.is_apart.then_some([f64::NAN; 2]));
                    points.extend(piece.points.iter().map(|point| [point[0], point[column]]));
                }
                let name = if region.name().is_empty() { "first body" } else { region.name() };
                points.iter().any(|point| point[1].is_finite()).then(|| Series::new(name, points))
            };
            let series: Vec<Series> = regions.iter().enumerate().filter_map(of_body).collect();
            if !series.is_empty() {
                plots.push(Plot::new(self.columns[0].clone(), quantity.clone(), series));
            }
        }
        plots
    }
}

/// What is known at each point of a line, in the order of the table.
fn columns(model: &Model) -> Vec<Column> {
    let (units, dimension) = (model.units(), model.mesh().dimension());
    let mut columns: Vec<Column> = Vec::new();
    let mut add = |name: &str, unit: &str, value: Box<dyn Fn(&At) -> f64>| {
        columns.push((Quantity::new(name, unit), value));
    };
    add("s", &units.length, Box::new(|at| at.point.distance));
    for (axis, name) in AXES.iter().enumerate().take(dimension) {
        add(name, &units.length, Box::new(move |at| at.point.place[axis]));
    }
    for (axis, name) in AXES.iter().enumerate().take(dimension) {
        add(&format!("u_{name}"), &units.length, Box::new(move |at| at.displacement[axis]));
    }
    let stress = units.pressure();
    for (component, name) in STRESSES.iter().enumerate().take([1, 4, 6][dimension - 1]) {
        add(name, &stress, Box::new(move |at| at.point.stress.components()[component]));
    }
    add("sigma_1", &stress, Box::new(|at| at.point.stress.sigma_1));
    add("sigma_2", &stress, Box::new(|at| at.point.stress.sigma_2));
    add("sigma_3", &stress, Box::new(|at| at.point.stress.sigma_3));
    add("von_mises", &stress, Box::new(|at| at.point.stress.von_mises));
    add("pressure", &stress, Box::new(|at| at.pressure));
    columns
}

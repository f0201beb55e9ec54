//! What a motion needs at nodes: loads that change in time, the forces of supports that the balance of a step requires,
//! and points with output.

use crate::error::Error;
use crate::fem::assembly::{Along, mass_columns, stiffness_columns};
use crate::fem::body::ElasticBody;
use crate::fem::geometry::along_axis;
use crate::motion::{Balance, TimeFunction};
use crate::scene::Model;
use crate::scene::input::entry::{PLACE_TOLERANCE, located, number, point, table as check_table, vector, wrong};
use crate::scene::input::schema::analysis::PATH;
use crate::scene::input::schema::{DynamicSpec, FactorSpec, LoadInTimeSpec, Scene, WatchSpec};
use crate::scene::models::load::add_load;
use signorini_qp::SparseMatrix;

/// Stiffness, mass and loads of the nodes with supported dofs, and the unknowns coupled to them: all data that a step
/// needs.
///
/// Prescribed displacements are constant: supported dofs have neither velocity nor acceleration.
#[derive(Clone, Debug)]
pub struct MovingSupports {
    /// The nodes, increasing; empty if the scene has no support.
    nodes: Vec<usize>,
    /// The unknowns that share an element or a spring with them, increasing: those whose motion
    /// [`reactions`](Self::reactions) needs.
    pub around: Vec<usize>,
    /// Force on the nodes per displacement of these dofs, transposed: `around.len() x (dim * nodes.len())`.
    stiffness: SparseMatrix,
    /// Force on the nodes per acceleration of these dofs, transposed.
    mass: SparseMatrix,
    /// c_m and c_k, as in the motion of the free dofs.
    damping: [f64; 2],
    /// Forces on the nodes from the prescribed displacements only, length `dim * nodes.len()`.
    holding: Vec<f64>,
    /// The loads on the nodes, length `dim * nodes.len()` each.
    loads: NodalLoads,
}

/// The effect of each unknown on a force: entries (unknown, force, coefficient).
type Effects = Vec<(usize, usize, f64)>;

impl MovingSupports {
    /// The data of `model` with a nodal mass (the lower triangle, `n_nodes x n_nodes`), the damping c_m and c_k, and
    /// the loads on all nodes.
    pub fn new(model: &Model, mass: &SparseMatrix, damping: [f64; 2], loads: &NodalLoads) -> Result<Self, Error> {
        let (body, dofs) = (model.body(), model.dofs());
        let dimension = body.dimension();
        // The displacement of a node along an axis, times a value, in the unknowns.
        let along = |node: usize, axis: usize, value: f64| dofs.along(node, &along_axis(axis, value)[..dimension]);
        let is_held = |node: usize| (dimension * node..dimension * (node + 1)).any(|dof| dofs.is_supported(dof));
        let count = if !model.parts.scene.supports.is_empty() { model.mesh().nodes().len() } else { 0 };
        let nodes: Vec<usize> = (0..count).filter(|&node| is_held(node)).collect();
        let mut holding = vec![0.0; dimension * nodes.len()];
        let (mut elastic, mut inertia): (Effects, Effects) = (Vec::new(), Vec::new());
        let of_body = stiffness_columns(body, &nodes)?;
        let of_springs = model
            .parts
            .conditions
            .springs
            .iter()
            .flat_map(|one| one.columns(|node| nodes.binary_search(&node).ok(), dimension));
        for (row, force, value) in of_body.triplets().chain(of_springs) {
            let Along { free, prescribed } = along(row / dimension, row % dimension, value);
            holding[force] += prescribed;
            elastic.extend(free.into_iter().map(|(unknown, coefficient)| (unknown, force, coefficient)));
        }
        for (node, place, value) in mass_columns(body, &nodes, mass)?.triplets() {
            for axis in 0..dimension {
                let force = dimension * place + axis;
                let free = along(node, axis, value).free;
                inertia.extend(free.into_iter().map(|(unknown, coefficient)| (unknown, force, coefficient)));
            }
        }
        let mut around: Vec<usize> = elastic.iter().chain(&inertia).map(|entry| entry.0).collect();
        around.sort_unstable();
        around.dedup();
        let matrix = |mut effects: Effects| {
            effects.iter_mut().for_each(|entry| entry.0 = around.partition_point(|&dof| dof < entry.0));
            SparseMatrix::from_triplets(around.len(), holding.len(), &effects)
        };
        let (stiffness, mass) = (matrix(elastic)?, matrix(inertia)?);
        let loads = loads.at_nodes(&nodes, dimension);
        Ok(MovingSupports { nodes, around, stiffness, mass, damping, holding, loads })
    }

    /// The forces of supports on their nodes, by number of the node, in force; zero at other nodes:
    ///
    /// ```text
    /// R = M a + C v + K u - f - B' lambda,   C = c_m M + c_k K
    /// ```
    ///
    /// with u, v, a (one entry for each dof of `around`) and f of the balance that the scheme solved, and its contact
    /// forces, one multiplier per contact row. Along free dofs R is the residual of the solve.
    pub fn reactions(&self, model: &Model, balance: Balance, multiplier: &[f64]) -> impl Fn(usize) -> [f64; 3] {
        let dimension = model.body().dimension();
        let Balance { mut displacement, velocity, mut acceleration, loads } = balance;
        for (coefficient, vector) in self.damping.into_iter().zip([&mut acceleration, &mut displacement]) {
            vector.iter_mut().zip(&velocity).for_each(|(entry, v)| *entry += coefficient * v);
        }
        let mut forces = self.stiffness.mul_transposed(&displacement);
        let parts = self.mass.mul_transposed(&acceleration).into_iter().zip(&self.holding).zip(self.loads.mean(&loads));
        forces.iter_mut().zip(parts).for_each(|(force, ((inertia, held), load))| *force += inertia + held - load);
        for (row, lambda) in model.rows().iter().zip(multiplier) {
            row.form().forces(*lambda, |node, on_node| {
                let Ok(place) = self.nodes.binary_search(&node) else { return };
                let of_node = &mut forces[dimension * place..dimension * (place + 1)];
                of_node.iter_mut().zip(on_node).for_each(|(force, part)| *force -= part);
            });
        }
        move |node| {
            let place = self.nodes.binary_search(&node);
            let part =
                |axis: usize| place.ok().filter(|_| axis < dimension).map(|place| forces[dimension * place + axis]);
            [0, 1, 2].map(|axis| part(axis).unwrap_or(0.0))
        }
    }
}

/// The loads on all nodes, in force, length `dim * n_nodes` each; or on some nodes, in their order.
#[derive(Clone, Debug)]
pub struct NodalLoads {
    pub constant: Vec<f64>,
    pub changing: Vec<(TimeFunction, Vec<f64>)>,
}

impl NodalLoads {
    /// The same on some nodes only.
    pub fn at_nodes(&self, nodes: &[usize], dimension: usize) -> Self {
        let gather = |load: &[f64]| -> Vec<f64> {
            nodes.iter().flat_map(|&node| &load[dimension * node..dimension * (node + 1)]).copied().collect()
        };
        NodalLoads {
            constant: gather(&self.constant),
            changing: self.changing.iter().map(|(factor, load)| (factor.clone(), gather(load))).collect(),
        }
    }

    /// The weighted sum of the loads at some times, given as `(time, weight)`; weights add up to one.
    pub fn mean(&self, times: &[(f64, f64)]) -> Vec<f64> {
        let mut sum = self.constant.clone();
        for (factor, load) in &self.changing {
            let factor: f64 = times.iter().map(|&(time, weight)| weight * factor.at(time)).sum();
            sum.iter_mut().zip(load).for_each(|(sum, load)| *sum += factor * load);
        }
        sum
    }
}

/// The loads on all nodes of `body`, those of `loads-in-time` with their factors; `path` is the JSON path of the
/// motion.
pub(crate) fn loads_in_time(scene: &Scene, body: &ElasticBody, spec: &DynamicSpec) -> Result<NodalLoads, Error> {
    let changes = |load: usize| spec.loads_in_time.iter().any(|changing| changing.load == load);
    let mut constant = vec![0.0; body.nodal_dofs()];
    for index in (0..scene.loads.len()).filter(|&index| !changes(index)) {
        add_load(scene, body, index, &mut constant)?;
    }
    let mut changing = Vec::with_capacity(spec.loads_in_time.len());
    for (entry, of_load) in spec.loads_in_time.iter().enumerate() {
        let path = format!("{PATH}.loads-in-time[{entry}]");
        let factor = of_load.function(&path, scene.loads.len())?;
        if spec.loads_in_time[..entry].iter().any(|other| other.load == of_load.load) {
            return Err(wrong(path, format!("loads[{}] has two factors; give it one", of_load.load)));
        }
        let mut load = vec![0.0; body.nodal_dofs()];
        add_load(scene, body, of_load.load, &mut load)?;
        changing.push((factor, load));
    }
    Ok(NodalLoads { constant, changing })
}

impl LoadInTimeSpec {
    /// The factor, checked; `path` is its JSON path, `loads` the number of loads.
    pub(crate) fn function(&self, path: &str, loads: usize) -> Result<TimeFunction, Error> {
        if self.load >= loads {
            let message = format!("there is no loads[{}]; the scene has {loads} loads, counted from 0", self.load);
            return Err(wrong(format!("{path}.load"), message));
        }
        self.factor.function(path)
    }
}

impl FactorSpec {
    /// The function, checked; `path` is the JSON path of the entry that has the factor.
    pub(crate) fn function(&self, path: &str) -> Result<TimeFunction, Error> {
        let (name, function) = match self {
            FactorSpec::Table(table) => {
                let path = format!("{path}.factor.table");
                let (times, factors) = (&table.times, &table.factors);
                check_table(&path, ("times", times), factors)?;
                ("table", TimeFunction::Table(times.iter().copied().zip(factors.iter().copied()).collect()))
            }
            FactorSpec::Sine(sine) => ("sine", TimeFunction::Sine { frequency: sine.frequency, phase: sine.phase }),
            FactorSpec::Ramp(ramp) => ("ramp", TimeFunction::Ramp { start: ramp.start, end: ramp.end }),
            FactorSpec::Pulse(pulse) => ("pulse", TimeFunction::Pulse { start: pulse.start, end: pulse.end }),
        };
        function.check().map_err(|error| located(error, &format!("{path}.factor.{name}.")))?;
        Ok(function)
    }
}

/// A point with output at every step: a node, or any place inside an element.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchedPoint {
    /// Its name in a table, as `node 12` or `point (0.5 1)`.
    pub name: String,
    /// The nodes around it as `(node, weight)`, in any order: index from 0, and a dimensionless weight. The weights are
    /// the shape functions of its element and add up to one; a node has only itself.
    pub nodes: Vec<(usize, f64)>,
}

impl WatchedPoint {
    /// The value at the point of a nodal vector (length `dimension * n_nodes`, order `[x_0, y_0, x_1, ...]`), one entry
    /// for each coordinate, in the same unit.
    pub fn value(&self, nodal: &[f64], dimension: usize) -> Vec<f64> {
        let along =
            |axis: usize| self.nodes.iter().map(|&(node, weight)| weight * nodal[dimension * node + axis]).sum();
        (0..dimension).map(along).collect()
    }

    /// The point of `spec`, which is at the JSON path `path`.
    pub(crate) fn new(model: &Model, spec: &WatchSpec, path: &str) -> Result<Self, Error> {
        let (mesh, dimension) = (model.mesh(), model.mesh().dimension());
        let at = match spec {
            &WatchSpec::Node(node) => {
                let count = mesh.nodes().len();
                if node >= count {
                    let message = format!("there is no node {node}: nodes have the numbers 0 to {}", count - 1);
                    return Err(wrong(format!("{path}.node"), message));
                }
                return Ok(WatchedPoint { name: format!("node {node}"), nodes: vec![(node, 1.0)] });
            }
            WatchSpec::Point(entries) => vector(&format!("{path}.point"), entries, dimension)?,
        };
        let shown = point(&at[..dimension]);
        for element in model.body().elements() {
            let Some(weights) = element.cell.weights_at(at, PLACE_TOLERANCE) else { continue };
            let nodes = element.nodes.iter().copied().zip(weights).filter(|&(_, weight)| weight != 0.0).collect();
            // A comma would end a column of the table.
            return Ok(WatchedPoint { name: format!("point {}", shown.replace(',', "")), nodes });
        }
        let nearest = mesh.nearest_node(at).map_or(String::new(), |(node, distance)| {
            let place = point(&mesh.nodes()[node][..dimension]);
            format!(": its distance to the nearest node, {node} at {place}, is {}", number(distance))
        });
        Err(wrong(format!("{path}.point"), format!("{shown} lies in no element of the body{nearest}")))
    }
}

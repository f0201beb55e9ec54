//! Loads of a scene that change with time.

use crate::error::Error;
use crate::fem::body::ElasticBody;
use crate::motion::TimeFunction;
use crate::scene::input::entry::{located, table as check_table, wrong};
use crate::scene::input::schema::analysis::PATH;
use crate::scene::input::schema::{DynamicSpec, FactorSpec, LoadInTimeSpec, Scene};

/// The loads on all nodes, in force, length `dim * n_nodes` each; or on some nodes, in their order.
#[derive(Clone, Debug)]
pub(crate) struct NodalLoads {
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

impl Scene {
    /// The loads on all nodes of `body`, those of `loads-in-time` with their factors; `path` is the JSON path of the
    /// motion.
    pub(crate) fn loads_in_time(&self, body: &ElasticBody, spec: &DynamicSpec) -> Result<NodalLoads, Error> {
        let changes = |load: usize| spec.loads_in_time.iter().any(|changing| changing.load == load);
        let mut constant = vec![0.0; body.nodal_dofs()];
        for index in (0..self.loads.len()).filter(|&index| !changes(index)) {
            self.add_load(body, index, &mut constant)?;
        }
        let mut changing = Vec::with_capacity(spec.loads_in_time.len());
        for (entry, of_load) in spec.loads_in_time.iter().enumerate() {
            let path = format!("{PATH}.loads-in-time[{entry}]");
            let factor = of_load.function(&path, self.loads.len())?;
            if spec.loads_in_time[..entry].iter().any(|other| other.load == of_load.load) {
                return Err(wrong(path, format!("loads[{}] has two factors; give it one", of_load.load)));
            }
            let mut load = vec![0.0; body.nodal_dofs()];
            self.add_load(body, of_load.load, &mut load)?;
            changing.push((factor, load));
        }
        Ok(NodalLoads { constant, changing })
    }
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

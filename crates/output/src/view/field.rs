//! The fields of an answer: a name, a unit, and values at the nodes and in the elements. All media take them from this
//! list.

use super::limits::{ROUNDING, limits_without, singular};
use crate::plots::ticks::Quantity;
use signorini_mechanics::Error;
use signorini_mechanics::fem::Stress;
use signorini_mechanics::scene::{Answer, Units};

/// Flag of a node that is not a candidate; candidates have 0 (open) or 1 (closed).
const NO_CANDIDATE: f64 = -1.0;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    /// Its name in files.
    pub name: &'static str,
    /// Components of a value: 1, 3 of a vector, 6 of a symmetric tensor in the order xx, yy, zz, xy, yz, zx.
    pub components: usize,
    pub unit: fn(&Units) -> String,
    /// How a body is coloured by it; `None` if it is not.
    pub colours: Option<Colours>,
    pub values: fn(&Source) -> Result<Values, Error>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Colours {
    /// The field in words.
    pub words: &'static str,
    /// Its symbol; may be empty.
    pub symbol: &'static str,
    pub between: Between,
}

/// The value of a field between two answers, of which a page shows every mixture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Between {
    /// The page computes it from the stress, which is linear in the answer.
    FromStress,
    /// The square of the mixture of the roots. An energy is a square of the stress: the value is exact where all
    /// components grow by one factor, and too large elsewhere.
    OfRoots,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    pub answer: &'a Answer,
    /// The nodal velocities of a motion, `dim` a node. Its reactions are not those of an equilibrium: they are left
    /// out.
    pub velocity: Option<&'a [f64]>,
}

/// The values of a field, empty where it has none: in the order of the mesh, all components of a node or an element
/// together.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Values {
    pub at_nodes: Vec<f64>,
    pub in_elements: Vec<f64>,
}

/// A field at the nodes, as it colours a body.
#[derive(Clone, Debug)]
pub(crate) struct Painted {
    pub quantity: Quantity,
    /// Values that are rounding beside `largest` are zero.
    pub values: Vec<f64>,
    /// Their range without singular nodes.
    pub limits: [f64; 2],
    /// The size of the largest principal stress at a node.
    pub largest: f64,
}

impl Painted {
    /// `field` is a stress.
    pub fn of(answer: &Answer, field: &Field) -> Result<Self, Error> {
        let principal = answer.stress()?.nodes.iter().flat_map(|of| [of.sigma_1, of.sigma_2, of.sigma_3]);
        let largest = principal.fold(0.0, |largest: f64, stress| largest.max(stress.abs()));
        let mut values = (field.values)(&Source { answer, velocity: None })?.at_nodes;
        values.iter_mut().filter(|value| value.abs() <= ROUNDING * largest).for_each(|value| *value = 0.0);
        let words = field.colours.map_or(field.name.into(), |of| format!("{} {}", of.words, of.symbol));
        let quantity = Quantity::new(words.trim_end(), (field.unit)(answer.model().units()));
        Ok(Painted { quantity, limits: limits_without(&singular(answer.model()), &values), values, largest })
    }
}

pub(crate) const SIGMA_2: Field = Field::new("sigma_2", 1, Units::pressure, |of| of.stress(|stress| [stress.sigma_2]))
    .coloured("second principal stress", "σ₂", Between::FromStress);

pub(crate) const VON_MISES: Field =
    Field::new("von_mises", 1, Units::pressure, |of| of.stress(|stress| [stress.von_mises])).coloured(
        "von Mises stress",
        "",
        Between::FromStress,
    );

/// All fields, in the order of a `.vtu` file.
pub(crate) const FIELDS: [Field; 17] = [
    Field::new("u", 3, length, |of| nodal(of.in_space(of.answer.displacement()))),
    Field::new("velocity", 3, Units::velocity, |of| nodal(of.velocity.map(|v| of.in_space(v)).unwrap_or_default())),
    Field::new("reaction", 3, force, |of| match of.velocity {
        None => nodal(of.in_space(&of.answer.forces()?.reactions)),
        Some(_) => Ok(Values::default()),
    }),
    Field::new("sigma_1", 1, Units::pressure, |of| of.stress(|stress| [stress.sigma_1])),
    SIGMA_2,
    Field::new("sigma_3", 1, Units::pressure, |of| of.stress(|stress| [stress.sigma_3])),
    VON_MISES,
    Field::new("energy_density", 1, Units::pressure, |of| of.energy_density()).coloured(
        "strain energy density",
        "w",
        Between::OfRoots,
    ),
    Field::new("stress", 6, Units::pressure, |of| of.stress(Stress::components)),
    Field::new("gap", 1, length, |of| nodal(of.at_candidates().gap)),
    Field::new("remaining_gap", 1, length, |of| nodal(of.at_candidates().remaining)),
    Field::new("normal", 3, number, |of| nodal(of.at_candidates().normal)),
    Field::new("pressure", 1, Units::pressure, |of| nodal(of.at_candidates().pressure)),
    Field::new("contact", 1, number, |of| nodal(of.at_candidates().flag)),
    Field::new("contact_force", 3, force, |of| nodal(of.in_space(&of.answer.forces()?.contact))),
    Field::new("body", 1, number, |of| of.bodies()),
    Field::new("material", 1, number, |of| of.materials()),
];

impl Field {
    const fn new(
        name: &'static str,
        components: usize,
        unit: fn(&Units) -> String,
        values: fn(&Source) -> Result<Values, Error>,
    ) -> Self {
        Field { name, components, unit, colours: None, values }
    }

    const fn coloured(self, words: &'static str, symbol: &'static str, between: Between) -> Self {
        Field { colours: Some(Colours { words, symbol, between }), ..self }
    }
}

impl Source<'_> {
    /// Nodal vectors, padded to three components.
    fn in_space(&self, nodal: &[f64]) -> Vec<f64> {
        let of_node = |v: &[f64]| [0, 1, 2].map(|axis| v.get(axis).copied().unwrap_or(0.0));
        nodal.chunks(self.answer.model().mesh().dimension()).flat_map(of_node).collect()
    }

    /// A function of the stress: its components, at the nodes and in the elements.
    fn stress<const N: usize>(&self, of: fn(&Stress) -> [f64; N]) -> Result<Values, Error> {
        let stress = self.answer.stress()?;
        let [at_nodes, in_elements] = [&stress.nodes, &stress.elements].map(|all| all.iter().flat_map(of).collect());
        Ok(Values { at_nodes, in_elements })
    }

    /// The strain energy over the volume, of the components with a strain in the model, from the stress at the centroid
    /// of each element and at each node; where materials meet, the mean over the elements around the node, each with
    /// its own law and stress.
    fn energy_density(&self) -> Result<Values, Error> {
        let (stress, body) = (self.answer.stress()?, self.answer.model().body());
        let (nodes, mut sums) = (body.mesh().nodes(), vec![(0.0, 0.0); stress.nodes.len()]);
        let mut in_elements = Vec::with_capacity(stress.elements.len());
        for (element, own) in body.elements().zip(&stress.elements) {
            let density = |stress: &Stress, place: [f64; 3]| {
                0.5 * element.phase.law.complementary_energy(&stress.components(), || place)
            };
            let mean = |axis: usize| element.nodes.iter().map(|&node| nodes[node][axis]).sum::<f64>();
            let centroid = [0, 1, 2].map(|axis| mean(axis) / element.nodes.len() as f64);
            in_elements.push(density(own, centroid));
            for &node in element.nodes {
                sums[node].0 += density(stress.within(node, element.phase_number), nodes[node]);
                sums[node].1 += 1.0;
            }
        }
        Ok(Values { at_nodes: sums.into_iter().map(|(sum, count)| sum / count).collect(), in_elements })
    }

    fn bodies(&self) -> Result<Values, Error> {
        let regions = self.answer.model().body().regions().iter().enumerate();
        let each = regions.flat_map(|(index, region)| std::iter::repeat_n(index as f64, region.elements().len()));
        Ok(Values { in_elements: each.collect(), ..Values::default() })
    }

    fn materials(&self) -> Result<Values, Error> {
        let elements = self.answer.model().body().elements();
        let in_elements = elements.map(|element| f64::from(element.phase_number)).collect();
        Ok(Values { in_elements, ..Values::default() })
    }

    /// A node between two obstacles has the sum of its pressures, and its smaller gap with the normal of that gap.
    fn at_candidates(&self) -> AtCandidates {
        let (model, remaining) = (self.answer.model(), self.answer.remaining_gaps());
        let count = model.mesh().nodes().len();
        let zeros = || vec![0.0; count];
        let mut at = AtCandidates {
            gap: zeros(),
            remaining: zeros(),
            pressure: zeros(),
            flag: vec![NO_CANDIDATE; count],
            normal: vec![0.0; 3 * count],
        };
        for (index, row) in model.rows().iter().enumerate() {
            for &(node, sign) in row.ends.iter().take(if row.is_mean { 1 } else { 2 }) {
                if at.flag[node] == NO_CANDIDATE || row.gap < at.gap[node] {
                    (at.gap[node], at.remaining[node]) = (row.gap, remaining[index]);
                    (0..3).for_each(|axis| at.normal[3 * node + axis] = sign * row.normal[axis]);
                }
                at.pressure[node] += self.answer.pressure()[index];
                at.flag[node] = f64::from(self.answer.contact_set().contains(index)).max(at.flag[node]);
            }
        }
        for (row, [pressure, left]) in model.rows_across().iter().zip(self.answer.across()) {
            let node = row.node;
            if at.flag[node] == NO_CANDIDATE || row.gap < at.gap[node] {
                (at.gap[node], at.remaining[node]) = (row.gap, left);
                (0..3).for_each(|axis| at.normal[3 * node + axis] = row.normal[axis]);
            }
            at.pressure[node] += pressure;
            at.flag[node] = f64::from(pressure > 0.0).max(at.flag[node]);
        }
        at
    }
}

/// The values of the contact rows at their nodes; zero at other nodes.
struct AtCandidates {
    gap: Vec<f64>,
    remaining: Vec<f64>,
    pressure: Vec<f64>,
    flag: Vec<f64>,
    /// Three components a node.
    normal: Vec<f64>,
}

fn nodal(at_nodes: Vec<f64>) -> Result<Values, Error> {
    Ok(Values { at_nodes, ..Values::default() })
}

fn length(units: &Units) -> String {
    units.length.clone()
}

fn force(units: &Units) -> String {
    units.force.clone()
}

fn number(_: &Units) -> String {
    String::new()
}

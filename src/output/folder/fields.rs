//! The fields of an answer as a `.vtu` file.

use super::vtu::{Array, Unstructured};
use crate::error::Error;
use crate::fem::recovery::Stress;
use crate::scene::Answer;

/// Flag of a node that is not a candidate; candidates have 0 (open) or 1 (closed).
const NO_CANDIDATE: f64 = -1.0;

/// The values of the contact rows at their nodes; zero at other nodes.
struct AtCandidates {
    gap: Vec<f64>,
    remaining: Vec<f64>,
    pressure: Vec<f64>,
    flag: Vec<f64>,
    /// Three components a node.
    normal: Vec<f64>,
}

impl AtCandidates {
    /// A node between two obstacles has the sum of its pressures, and its smaller gap with the normal of that gap.
    fn of(answer: &Answer) -> Self {
        let (model, remaining) = (answer.model(), answer.remaining_gaps());
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
            for (node, sign) in row.ends() {
                if at.flag[node] == NO_CANDIDATE || row.gap < at.gap[node] {
                    (at.gap[node], at.remaining[node]) = (row.gap, remaining[index]);
                    (0..3).for_each(|axis| at.normal[3 * node + axis] = sign * row.normal[axis]);
                }
                at.pressure[node] += answer.pressure()[index];
                at.flag[node] = f64::from(answer.contact_set().contains(index)).max(at.flag[node]);
            }
        }
        at
    }
}

/// The text of the `.vtu` file: displacement, stresses, forces, and at the candidates normal, gaps, pressure and contact flag.
///
/// With a `velocity` (nodal, `dim` a node) the fields are those of a motion. Its reactions are not those of an equilibrium and are left
/// out.
///
/// # Errors
/// Those of the recovery of stresses.
pub(crate) fn fields(answer: &Answer, velocity: Option<&[f64]>) -> Result<String, Error> {
    let model = answer.model();
    let dimension = model.mesh().dimension();
    let elements: Vec<Vec<usize>> = model.mesh().elements().map(<[usize]>::to_vec).collect();
    let cell_types = vec![model.mesh().kind(); elements.len()];
    let displacement = in_space(answer.displacement(), dimension);
    let forces = answer.forces()?;
    let (force, reaction) = (in_space(&forces.contact, dimension), in_space(&forces.reactions, dimension));
    let (stress, at) = (answer.stress()?, AtCandidates::of(answer));
    let components: [fn(&Stress) -> f64; 4] = [|s| s.sigma_1, |s| s.sigma_2, |s| s.von_mises, |s| s.sigma_3];
    let of = |stresses: &[Stress]| components.map(|component| stresses.iter().map(component).collect::<Vec<f64>>());
    let (at_nodes, in_elements) = (of(&stress.nodes), of(&stress.elements));
    let tensors =
        [&stress.nodes, &stress.elements].map(|stresses| stresses.iter().flat_map(tensor).collect::<Vec<f64>>());
    let velocity = velocity.map(|nodal| in_space(nodal, dimension));
    let bodies: Vec<f64> = model
        .body()
        .regions()
        .iter()
        .enumerate()
        .flat_map(|(index, region)| std::iter::repeat_n(index as f64, region.elements().len()))
        .collect();
    let materials: Vec<f64> = model.body().elements().map(|element| f64::from(element.phase_number)).collect();
    let mut point_data = vec![Array::Vectors("u", &displacement)];
    match velocity.as_deref() {
        Some(velocity) => point_data.push(Array::Vectors("velocity", velocity)),
        None => point_data.push(Array::Vectors("reaction", &reaction)),
    }
    point_data.extend([
        Array::Scalars("sigma_1", &at_nodes[0]),
        Array::Scalars("sigma_2", &at_nodes[1]),
        Array::Scalars("sigma_3", &at_nodes[3]),
        Array::Scalars("von_mises", &at_nodes[2]),
        Array::Tensors("stress", &tensors[0]),
        Array::Scalars("gap", &at.gap),
        Array::Scalars("remaining_gap", &at.remaining),
        Array::Vectors("normal", &at.normal),
        Array::Scalars("pressure", &at.pressure),
        Array::Scalars("contact", &at.flag),
        Array::Vectors("contact_force", &force),
    ]);
    let cell_data = [
        Array::Scalars("sigma_1", &in_elements[0]),
        Array::Scalars("sigma_2", &in_elements[1]),
        Array::Scalars("sigma_3", &in_elements[3]),
        Array::Scalars("von_mises", &in_elements[2]),
        Array::Tensors("stress", &tensors[1]),
        Array::Scalars("body", &bodies),
        Array::Scalars("material", &materials),
    ];
    let nodes = model.mesh().nodes();
    Unstructured { nodes, elements: &elements, cell_types: &cell_types, point_data: &point_data, cell_data: &cell_data }
        .to_vtu()
}

/// The components of a stress in the order of VTK: xx, yy, zz, xy, yz, xz.
fn tensor(stress: &Stress) -> [f64; 6] {
    let Stress { sigma_xx, sigma_yy, sigma_zz, sigma_xy, sigma_yz, sigma_zx, .. } = *stress;
    [sigma_xx, sigma_yy, sigma_zz, sigma_xy, sigma_yz, sigma_zx]
}

/// Nodal vectors of `dimension` components, padded to three.
fn in_space(nodal: &[f64], dimension: usize) -> Vec<f64> {
    nodal.chunks(dimension).flat_map(|v| [0, 1, 2].map(|axis| v.get(axis).copied().unwrap_or(0.0))).collect()
}

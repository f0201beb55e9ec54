//! The guarantee on a sequence of meshes, for a study of it.

use std::sync::Arc;

use signorini_qp::{Method, Settings, solve};

use super::goal::{MARKED, marked};
use super::guaranteed::{compared, judged};
use crate::continuum::Bracket;
use crate::error::Error;
use crate::scene::{Answer, Scene};

/// The numbers of one mesh for a study of the guarantee: bounds from both sides, with the answer that they bound.
#[derive(Clone, Debug)]
pub struct Examined {
    /// `[D(tau), J(v)]`, in force times length: the exact potential energy lies between them.
    pub energies: [f64; 2],
    /// The bound on |u - v|.
    pub bound: f64,
    /// |v|: the length of the displacement in the energy norm.
    pub norm: f64,
    /// The sum of the contact forces of the answer v on this mesh, in force.
    pub force: f64,
    /// The ends `[low, high]`, in force, between which the exact contact force lies.
    pub force_interval: Option<[f64; 2]>,
    /// The answer w on the scene's own mesh, in the energy norm, whose unit is the root of force times length: `[an
    /// upper bound of |u - w|,
    /// |v - w|, |w|]`.
    pub own: [f64; 3],
    /// |v - w| with the answer w of the scene by finite elements on the last mesh; `None` on the others.
    pub from_elements: Option<f64>,
    /// Unknowns of v.
    pub dofs: usize,
}

impl Examined {
    /// Brackets on the mesh of a scene and on `levels` finer ones, from the first to the last.
    ///
    /// # Errors
    /// Those of the total error; [`Error::Scene`] for a scene without a guaranteed bound.
    pub fn of(scene: &Scene, levels: usize) -> Result<Vec<Examined>, Error> {
        let model = Arc::new(scene.build()?);
        let (problem, mut mesh) = scene.continuum_problem(&model)?;
        let settings = Settings::with_method(Method::ActiveSet);
        let own = Answer::of_any_size(model.clone(), &solve(model.problem(), &settings)?)?;
        let mut found = Vec::with_capacity(levels + 1);
        for level in 0..=levels {
            let bracket = Bracket::new(&problem, &mesh, None, &settings)?;
            let judged = judged(&own, &bracket);
            let from_elements = || -> Result<f64, Error> {
                let of_bound = bracket.answer();
                let last = Arc::new(scene.on_last_mesh(&model, &of_bound)?);
                let solution = solve(last.problem(), &settings)?;
                Ok(compared(&Answer::of_any_size(last, &solution)?, &of_bound)?[0])
            };
            found.push(Examined {
                energies: [bracket.energy_of_stress(), bracket.energy_of_displacement()],
                bound: (2.0 * bracket.distance().max(0.0)).sqrt(),
                norm: bracket.energy.sqrt(),
                force: bracket.force(),
                force_interval: bracket.force_interval(0.0)?,
                own: [judged.bound, judged.from_displacement, judged.norm],
                from_elements: if level == levels { Some(from_elements()?) } else { None },
                dofs: bracket.primal.unknowns.free,
            });
            if level < levels {
                mesh = mesh.refined(&marked(&bracket.shares, MARKED), |_, middle| middle);
            }
        }
        Ok(found)
    }
}

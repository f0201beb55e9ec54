//! The total error: a mesh refined where the guaranteed bound is made, until it is small enough.

use crate::continuum::{Bracket, Triangulation};
use crate::error::Error;
use crate::qp::{Method, Settings};
use crate::scene::Scene;

/// The share of J - D that the triangles together make which are refined: that of Doerfler.
const MARKED: f64 = 0.5;

/// The fewest triangles that make a share of the whole.
pub fn marked(shares: &[f64], share: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..shares.len()).collect();
    order.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]));
    let wanted = share * shares.iter().sum::<f64>();
    let (mut sum, mut marked) = (0.0, vec![false; shares.len()]);
    for index in order {
        if sum >= wanted {
            break;
        }
        marked[index] = true;
        sum += shares[index];
    }
    marked
}

pub fn experiment(scene: &Scene, goal: f64) -> Result<(), Error> {
    let model = scene.build()?;
    let (problem, mut mesh): (_, Triangulation) = scene.plane_problem(&model)?;
    let settings = Settings::with_method(Method::ActiveSet);
    let clock = std::time::Instant::now();
    loop {
        let bracket = Bracket::new(&problem, &mesh, &settings)?;
        println!(
            "{:8} + {:8}  bound {:.4e}  mean {:.4e}  contact {:.2} defect {:.1e}  |v|^2 {:.9e} J {:.9e} D {:.9e}  primal {:.3} dual {:.3} all {:.3}",
            bracket.primal.unknowns.free(),
            bracket.dual.unknowns.free(),
            bracket.bound(),
            bracket.bound_of_mean(),
            bracket.contact_share / bracket.distance(),
            bracket.defect,
            bracket.energy,
            bracket.energy_of_displacement(),
            bracket.energy_of_stress(),
            bracket.primal.seconds,
            bracket.dual.seconds,
            clock.elapsed().as_secs_f64(),
        );
        let now = std::time::Instant::now();
        let interval = bracket.force_interval(&settings)?;
        println!(
            "    force {:.9e} in {interval:?} half width {:?} in {:.3} s",
            bracket.force(),
            interval.map(|[l, h]| (h - l) / 2.0 / bracket.force()),
            now.elapsed().as_secs_f64()
        );
        if bracket.bound() <= goal {
            return Ok(());
        }
        mesh = mesh.refined(&marked(&bracket.shares, MARKED));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classical() {
        for nu in ["0.3", "0.4999"] {
            let text = r#"{"body": {"rectangle": {"x": {"points": [0, 1], "divisions": [8]}, "y": {"points": [0, 0.5], "divisions": [4]}}},
            "material": {"young": 1e7, "poisson": NU}, "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0.5, 0.49], "radius": 1}}}]}"#.replace("NU", nu);
            let scene = Scene::from_json(&text, "scene").unwrap();
            experiment(&scene, 1e-3).unwrap();
        }
    }
}

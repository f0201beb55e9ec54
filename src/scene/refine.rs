//! The same scene on a finer mesh.

use super::entry::wrong;
use super::schema::{AxisSpec, BodySpec, Scene, ZoneSpec};
use crate::error::Error;

impl Scene {
    /// The scene with every cell of its bodies cut into `times` along each edge; graded meshes are nested.
    ///
    /// # Errors
    /// [`Error::Scene`] for `times` 0, and for a body from a mesh file, which says nothing of a finer one.
    pub fn refined(&self, times: usize) -> Result<Scene, Error> {
        if times == 0 {
            return Err(wrong("body", "cells cannot be cut into 0"));
        }
        let mut scene = self.clone();
        if times == 1 {
            return Ok(scene);
        }
        let further = scene.further_bodies.iter_mut().map(|further| &mut further.body);
        for body in std::iter::once(&mut scene.body).chain(further) {
            match body {
                BodySpec::Rectangle(spec) => [&mut spec.x, &mut spec.y].into_iter().for_each(|axis| axis.refine(times)),
                BodySpec::Bar(spec) => spec.x.refine(times),
                BodySpec::Box(spec) => {
                    [&mut spec.x, &mut spec.y, &mut spec.z].into_iter().for_each(|axis| axis.refine(times));
                }
                BodySpec::Ring(spec) => {
                    [&mut spec.radius, &mut spec.angle].into_iter().for_each(|axis| axis.refine(times));
                }
                BodySpec::Disc(spec) => spec.zone.refine(times),
                BodySpec::HalfDisc(spec) => spec.zone.refine(times),
                BodySpec::HalfBall(spec) => spec.zone.refine(times),
                BodySpec::Gmsh(_) => {
                    let message = "a mesh from a file has no finer one; mesh the body again with smaller cells";
                    return Err(wrong("body.gmsh", message));
                }
            }
        }
        Ok(scene)
    }
}

impl AxisSpec {
    fn refine(&mut self, times: usize) {
        // The size of cell after cell grows by q = ratio^(1/(n - 1)); in the finer mesh by the times-th root of it.
        for (ratio, &cells) in self.ratios.iter_mut().zip(&self.divisions) {
            if cells > 1 {
                let finer = cells.saturating_mul(times) - 1;
                *ratio = ratio.powf(finer as f64 / (times as f64 * (cells - 1) as f64));
            }
        }
        self.divisions.iter_mut().for_each(|cells| *cells = cells.saturating_mul(times));
    }
}

impl ZoneSpec {
    fn refine(&mut self, times: usize) {
        self.divisions = self.divisions.saturating_mul(times);
        self.growth = self.growth.powf(1.0 / times as f64);
    }
}

//! The answers of a sweep between its gaps: the exact path with the scene that it belongs to.

#[cfg(feature = "cli")]
use std::sync::Arc;

use crate::error::Error;
use crate::qp::Path;
#[cfg(feature = "cli")]
use crate::scene::Answer;
use crate::scene::Model;
use crate::solution::ContactSet;

/// Corners that are nearer to each other than this are one, as shares of the way.
#[cfg(feature = "cli")]
const SAME_PLACE: f64 = 1e-13;

/// What happens to a scene on the way from one gap to another, exactly: between two corners everything is linear in the gap.
#[derive(Clone, Debug)]
pub(crate) struct ExactPath {
    path: Path,
    /// The scene at the first gap.
    model: Model,
    first: f64,
    last: f64,
}

impl ExactPath {
    /// The `path` of the rows of `model`, which stands at the gap `first`, to the gap `last`.
    pub fn new(path: Path, model: Model, last: f64) -> Self {
        let first = model.gap();
        ExactPath { path, model, first, last }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The scene-wide gap at a share of the way.
    pub fn gap(&self, share: f64) -> f64 {
        (1.0 - share) * self.first + share * self.last
    }

    /// Number of stretches on which the contact set does not change.
    pub fn pieces(&self) -> usize {
        self.path.pieces().len()
    }

    /// Where a stretch begins and ends, as shares of the way.
    pub fn ends(&self, piece: usize) -> [f64; 2] {
        [self.path.pieces()[piece].from, self.path.pieces()[piece].to]
    }

    /// The closed rows on a stretch.
    pub fn contact_set(&self, piece: usize) -> ContactSet {
        self.path.contact_set_on(&self.path.pieces()[piece])
    }

    /// The multipliers of all rows at both ends of a stretch, in force.
    pub fn multipliers(&self, piece: usize) -> [Vec<f64>; 2] {
        self.ends(piece).map(|share| self.path.multiplier_on(&self.path.pieces()[piece], share))
    }

    /// The pressures of all rows at both ends of a stretch, in force per area.
    ///
    /// # Errors
    /// None for the rows of this scene.
    pub fn pressures(&self, piece: usize) -> Result<[Vec<f64>; 2], Error> {
        let [from, to] = self.multipliers(piece);
        Ok([self.model.pressure(&from)?, self.model.pressure(&to)?])
    }

    /// The beginning, every event and the end, as shares of the way.
    #[cfg(feature = "cli")]
    pub fn corners(&self) -> Vec<f64> {
        let mut corners = self.path.corners();
        corners.dedup_by(|next, last| (*next - *last).abs() <= SAME_PLACE);
        corners
    }

    /// The answer at a share of the way, without a certificate of its own.
    ///
    /// # Errors
    /// As [`Prepared::boundary`](crate::Prepared::boundary) and [`Model::with_gap`].
    #[cfg(feature = "cli")]
    pub fn answer(&self, share: f64) -> Result<Answer, Error> {
        let model = Arc::new(self.model.with_gap(self.gap(share))?);
        let (displacement, multiplier) = (self.path.displacement(share)?, self.path.multiplier(share));
        Answer::new(model, &displacement, &multiplier, &self.path.contact_set(share))
    }
}

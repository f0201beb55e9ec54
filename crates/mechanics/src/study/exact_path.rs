//! The answers of a sweep between its gaps: the exact path and its scene.

use crate::error::Error;
use crate::scene::{Answer, Model};
use signorini_qp::{ContactSet, Path};

/// Two corners closer than this are one, as shares of the path.
const SAME_PLACE: f64 = 1e-13;

/// The exact changes of a scene from one gap to another: between two corners everything is linear in the gap.
#[derive(Clone, Debug)]
pub struct ExactPath {
    /// The path between the first gap and the last.
    pub path: Path,
    /// The scene at the first gap.
    model: Model,
    first: f64,
    last: f64,
}

impl ExactPath {
    /// The `path` of the rows of `model`, which has the gap `first`, to the gap `last`.
    pub fn new(path: Path, model: Model, last: f64) -> Self {
        let first = model.gap();
        ExactPath { path, model, first, last }
    }

    /// The scene-wide gap at a share of the path.
    pub fn gap(&self, share: f64) -> f64 {
        (1.0 - share) * self.first + share * self.last
    }

    /// Number of stretches on which the contact set does not change.
    pub fn pieces(&self) -> usize {
        self.path.pieces().len()
    }

    /// The two ends of a stretch, its start before its end, as shares of the path: dimensionless, in `[0, 1]`.
    pub fn ends(&self, piece: usize) -> [f64; 2] {
        [self.path.pieces()[piece].from, self.path.pieces()[piece].to]
    }

    /// The closed rows on a stretch.
    pub fn contact_set(&self, piece: usize) -> ContactSet {
        self.path.contact_set_on(&self.path.pieces()[piece])
    }

    /// The multipliers at both ends of a stretch, one per row, in force, `<= 0`.
    pub fn multipliers(&self, piece: usize) -> [Vec<f64>; 2] {
        self.ends(piece).map(|share| self.path.multiplier_on(&self.path.pieces()[piece], share))
    }

    /// The pressures of all rows at both ends of a stretch, in force per area.
    ///
    /// # Errors
    /// As [`Model::pressure`], which the rows of this scene do not raise.
    pub fn pressures(&self, piece: usize) -> Result<[Vec<f64>; 2], Error> {
        let [from, to] = self.multipliers(piece);
        Ok([self.model.pressure(&from)?, self.model.pressure(&to)?])
    }

    /// The start, every event and the end in this order, as shares of the path, dimensionless.
    pub fn corners(&self) -> Vec<f64> {
        let mut corners = self.path.corners();
        corners.dedup_by(|next, last| (*next - *last).abs() <= SAME_PLACE);
        corners
    }

    /// The answer at a share of the path, without its own certificate.
    ///
    /// # Errors
    /// As [`Prepared::boundary`](signorini_qp::Prepared::boundary) and [`Model::with_gap`].
    pub fn answer(&self, share: f64) -> Result<Answer, Error> {
        let model = std::sync::Arc::new(self.model.with_gap(self.gap(share))?);
        let (displacement, multiplier) = (self.path.displacement(share)?, self.path.multiplier(share));
        let multiplier = [multiplier, self.path.equality_multiplier(share)].concat();
        Answer::new(model, &displacement, &multiplier, &self.path.contact_set(share))
    }
}

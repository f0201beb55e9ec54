//! An answer along lines.

use serde::Serialize;

use super::packed::Packer;
use super::plots::PlotShown;
use crate::view::along::Along;
use signorini_mechanics::scene::Model;

#[derive(Debug, Serialize)]
pub(super) struct AlongShown {
    /// Both ends of the line in the page, a number for each coordinate.
    ends: [Vec<f64>; 2],
    /// A plot for each quantity; none if the line meets no body.
    plots: Vec<PlotShown>,
}

impl AlongShown {
    pub fn of(along: &Along, model: &Model, packer: &mut Packer) -> Self {
        AlongShown {
            ends: along.ends.map(|end| end[..model.mesh().dimension()].to_vec()),
            plots: along.plots(model).iter().map(|plot| PlotShown::of(plot, packer)).collect(),
        }
    }
}

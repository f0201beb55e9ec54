//! Plots, drawn by the page.

use serde::Serialize;

use super::packed::{Packed, Packer};
use crate::plots::plot::Plot;
use crate::plots::ticks::{Quantity, Scale};

#[derive(Debug, Serialize)]
pub(super) struct PlotShown {
    x: Quantity,
    y: Quantity,
    /// Which of both axes are logarithmic.
    log: [bool; 2],
    series: Vec<SeriesShown>,
}

#[derive(Debug, Serialize)]
struct SeriesShown {
    name: String,
    /// Points [x, y]; the line is interrupted where a number is not finite.
    points: Packed,
}

impl PlotShown {
    pub fn of(plot: &Plot, packer: &mut Packer) -> Self {
        let series = plot.series.iter().map(|series| SeriesShown {
            name: series.name.clone(),
            points: packer.exact(series.points.as_flattened(), 2),
        });
        PlotShown {
            x: plot.x.clone(),
            y: plot.y.clone(),
            log: plot.scales.map(|scale| scale == Scale::Logarithmic),
            series: series.collect(),
        }
    }
}

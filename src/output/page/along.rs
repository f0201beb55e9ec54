//! An answer along lines, a series of points for each body.

use serde::Serialize;

use super::packed::{Packed, Packer};
use crate::output::view::along::Along;
use crate::scene::Model;

#[derive(Debug, Serialize)]
pub(super) struct AlongShown {
    /// Both ends, a number for each coordinate.
    ends: [Vec<f64>; 2],
    columns: Vec<Column>,
    bodies: Vec<OfBody>,
}

#[derive(Debug, Serialize)]
struct Column {
    name: String,
    unit: String,
}

#[derive(Debug, Serialize)]
struct OfBody {
    name: String,
    /// The columns of each point; a point without numbers stands where the line is outside the body.
    points: Packed,
}

impl AlongShown {
    pub fn of(along: &Along, model: &Model, packer: &mut Packer) -> Self {
        let regions = model.body().regions();
        let mut bodies = Vec::new();
        for (body, region) in regions.iter().enumerate() {
            let mut points: Vec<f64> = Vec::new();
            for piece in along.pieces.iter().filter(|piece| piece.body == body) {
                if piece.is_apart && !points.is_empty() {
                    points.extend(along.columns.iter().map(|_| f64::NAN));
                }
                points.extend(piece.points.iter().flatten());
            }
            if !points.is_empty() {
                bodies.push(OfBody {
                    name: region.name().to_string(),
                    points: packer.exact(&points, along.columns.len()),
                });
            }
        }
        AlongShown {
            ends: along.ends.map(|end| end[..model.mesh().dimension()].to_vec()),
            columns: along
                .columns
                .iter()
                .map(|column| Column { name: column.name.clone(), unit: column.unit.clone() })
                .collect(),
            bodies,
        }
    }
}

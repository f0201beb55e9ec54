//! The frame of a node at an inclined support: orthonormal axes, the supported ones first.

use crate::error::Error;
use crate::fem::geometry::{COORDINATES, dot, unit};
use signorini_linear as linear;

/// Given axes of unit length at right angles are accepted to within this.
const ORTHONORMAL: f64 = 1e-12;

/// The orthonormal axes along which the local dofs of a node are counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    axes: [[f64; 3]; 3],
}

impl Frame {
    /// The frame of a node in `dimension` coordinates with first axes `given`: dimensionless unit vectors [x, y, z] at
    /// right angles, zero beyond the dimension.
    ///
    /// # Errors
    /// [`linear::Error::Setting`] if they are not, or if there are more axes than coordinates.
    pub fn completing(given: &[[f64; 3]], dimension: usize) -> Result<Self, Error> {
        let wrong =
            |value: f64| linear::Error::Setting { name: "frame", value, allowed: "orthonormal: off by 1e-12 at most" };
        let dimension = dimension.min(3);
        if given.len() > dimension {
            let allowed = "of as many axes as there are coordinates at most";
            return Err(linear::Error::Setting { name: "frame", value: given.len() as f64, allowed }.into());
        }
        for (i, a) in given.iter().enumerate() {
            for (j, b) in given[..=i].iter().enumerate() {
                let off = dot(*a, *b) - f64::from(u8::from(i == j));
                if off.is_nan() || off.abs() > ORTHONORMAL {
                    return Err(wrong(off).into());
                }
            }
            if let Some(&beyond) = a[dimension..].iter().find(|part| **part != 0.0) {
                return Err(wrong(beyond).into());
            }
        }
        let mut axes = given.to_vec();
        for space in [dimension, 3] {
            while axes.len() < space {
                // Take the coordinate axis with the largest component perpendicular to the axes so far.
                let rests = COORDINATES[..space].iter().map(|&axis| perpendicular(axis, &axes));
                let Some(rest) = rests.max_by(|a, b| dot(*a, *a).total_cmp(&dot(*b, *b))) else { break };
                axes.push(unit(perpendicular(unit(rest), &axes)));
            }
        }
        let mut frame = Frame { axes: [[0.0; 3]; 3] };
        frame.axes.iter_mut().zip(axes).for_each(|(place, axis)| *place = axis);
        Ok(frame)
    }

    /// The axes, unit vectors [x, y, z]; in a plane model the third is normal to the plane.
    pub fn axes(&self) -> &[[f64; 3]; 3] {
        &self.axes
    }

    /// Turns the entries of a node, one per axis, from the coordinate axes to the axes of the frame.
    pub(super) fn turn_in(&self, entries: &mut [f64]) {
        let local = self.axes.map(|axis| entries.iter().zip(axis).map(|(entry, part)| entry * part).sum());
        entries.iter_mut().zip(local).for_each(|(entry, value): (_, f64)| *entry = value);
    }

    /// Turns the entries of a node from the axes of the frame back to the coordinate axes.
    pub(super) fn turn_back(&self, entries: &mut [f64]) {
        let mut global = [0.0; 3];
        for (&entry, axis) in entries.iter().zip(self.axes) {
            global.iter_mut().zip(axis).for_each(|(sum, part)| *sum += entry * part);
        }
        entries.iter_mut().zip(global).for_each(|(entry, value)| *entry = value);
    }
}

/// The component of a vector perpendicular to orthonormal `axes`.
pub(crate) fn perpendicular(vector: [f64; 3], axes: &[[f64; 3]]) -> [f64; 3] {
    axes.iter().fold(vector, |rest, axis| {
        let along = dot(rest, *axis);
        [0, 1, 2].map(|i| rest[i] - along * axis[i])
    })
}

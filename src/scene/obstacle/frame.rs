//! The frame of an obstacle: one axis perpendicular to the approach direction, one along it.

use crate::scene::schema::approach::Approach;

/// Coordinates `[along, towards]`: along the surface, and towards the obstacle.
pub(in crate::scene) type Local = [f64; 2];

/// The axes of an obstacle. Points and directions are transformed in the same way: the frame has the scene's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene) struct Frame {
    /// 0 or 1: the axis of the approach direction.
    axis: usize,
    /// 1 or -1: its sense.
    sense: f64,
}

impl Frame {
    /// The frame of an approach direction in the plane; a plane model has no other frame.
    pub fn of(approach: Approach) -> Self {
        let (axis, sense) = approach.axis();
        Frame { axis: axis.min(1), sense }
    }

    /// From [x, y] to [along, towards].
    pub fn local(&self, global: [f64; 2]) -> Local {
        [global[1 - self.axis], self.sense * global[self.axis]]
    }

    /// From [along, towards] to [x, y].
    pub fn global(&self, [along, towards]: Local) -> [f64; 2] {
        let mut global = [along; 2];
        global[self.axis] = self.sense * towards;
        global
    }

    /// The axis perpendicular to the approach direction: 0 for x, 1 for y.
    pub fn along_axis(&self) -> usize {
        1 - self.axis
    }
}

//! The unknowns of a contact problem: the free dofs, and behind them the travels of obstacles that a force presses.
//!
//! A pressed obstacle moves along its approach direction `a` alone, by the travel `d` against it: one more unknown without stiffness,
//! whose load is the force F. Each of its rows holds `n . u + (n . a) d <= gap`, so that the forces of its rows along `a` add up
//! to F.

use super::obstacle::PlacedObstacle;
use crate::error::Error;
use crate::qp::linear::{SparseMatrix, SymmetricMatrix};

/// Which unknown is what.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Unknowns {
    /// Number of free dofs, which come first.
    free: usize,
    /// The pressed obstacles, in the order of their unknowns.
    pressed: Vec<usize>,
}

impl Unknowns {
    pub fn of(free: usize, obstacles: &[PlacedObstacle]) -> Self {
        let is_pressed = |index: &usize| obstacles[*index].force().is_some();
        Unknowns { free, pressed: (0..obstacles.len()).filter(is_pressed).collect() }
    }

    /// Number of unknowns.
    pub fn count(&self) -> usize {
        self.free + self.pressed.len()
    }

    /// The obstacles that a force presses.
    pub fn pressed(&self) -> &[usize] {
        &self.pressed
    }

    /// The unknown that is the travel of an obstacle; `None` for one that stands still.
    pub fn travel(&self, obstacle: usize) -> Option<usize> {
        self.pressed.iter().position(|&pressed| pressed == obstacle).map(|place| self.free + place)
    }

    /// The displacement of the free dofs among values of the unknowns.
    ///
    /// # Errors
    /// [`Error::Length`] where there is not one value for each unknown.
    pub fn of_free<'a>(&self, values: &'a [f64]) -> Result<&'a [f64], Error> {
        if values.len() != self.count() {
            let (found, expected) = (values.len(), self.count());
            return Err(Error::Length { name: "displacement", found, expected, of: "unknowns" });
        }
        Ok(&values[..self.free])
    }

    /// A vector of the free dofs, with a value for each pressed obstacle behind it.
    pub fn with_travels(&self, mut of_free: Vec<f64>, of_travel: impl Fn(usize) -> f64) -> Vec<f64> {
        of_free.extend(self.pressed.iter().map(|&obstacle| of_travel(obstacle)));
        of_free
    }

    /// The stiffness of the unknowns: that of the free dofs, and none.
    ///
    /// # Errors
    /// None for a stiffness of the free dofs.
    pub fn stiffness(&self, of_free: SymmetricMatrix) -> Result<SymmetricMatrix, Error> {
        if self.pressed.is_empty() {
            return Ok(of_free);
        }
        let entries: Vec<_> = of_free.lower().triplets().collect();
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(self.count(), self.count(), &entries)?)
    }

    /// The stiffness of the unknowns with a spring on each pressed obstacle, as stiff as the stiffest dof.
    ///
    /// # Errors
    /// None for a stiffness of the unknowns.
    #[cfg(feature = "cli")]
    pub fn on_springs(&self, stiffness: &SymmetricMatrix) -> Result<SymmetricMatrix, Error> {
        let spring = stiffness.diagonal().into_iter().fold(0.0, f64::max);
        let springs = (self.free..self.count()).map(|unknown| (unknown, unknown, spring));
        let entries: Vec<_> = stiffness.lower().triplets().chain(springs).collect();
        SymmetricMatrix::from_lower(SparseMatrix::from_triplets(self.count(), self.count(), &entries)?)
    }
}

//! Free and supported dofs: eliminate, and expand again.

use crate::error::Error;

/// Stands where a free dof has its number.
const SUPPORTED: usize = usize::MAX;

/// Which dofs are free, their numbers in the problem, and the displacement of the supported ones.
#[derive(Clone, Debug, PartialEq)]
pub struct DofMap {
    /// Zero at free dofs.
    prescribed: Vec<f64>,
    /// [`SUPPORTED`] at supported dofs.
    number: Vec<usize>,
    free: Vec<usize>,
}

impl DofMap {
    /// From one entry per nodal dof: the prescribed displacement, or `None` where the dof is free.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a prescribed displacement that is not finite.
    pub fn new(prescribed: Vec<Option<f64>>) -> Result<Self, Error> {
        let (mut number, mut free) = (Vec::with_capacity(prescribed.len()), Vec::new());
        for (dof, value) in prescribed.iter().enumerate() {
            match *value {
                Some(value) if !value.is_finite() => {
                    let (name, at) = ("prescribed displacement", format!("dof {dof}"));
                    return Err(Error::NotFinite { name, at, value, allowed: "finite" });
                }
                Some(_) => number.push(SUPPORTED),
                None => {
                    number.push(free.len());
                    free.push(dof);
                }
            }
        }
        free.shrink_to_fit();
        let prescribed = prescribed.into_iter().map(Option::unwrap_or_default).collect();
        Ok(DofMap { prescribed, number, free })
    }

    /// Number of nodal dofs, free and supported.
    pub fn nodal_count(&self) -> usize {
        self.prescribed.len()
    }

    /// The nodal dof of each free dof, increasing.
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// The number of nodal dof `dof` among the free ones; `None` where it is supported.
    #[inline]
    pub fn number(&self, dof: usize) -> Option<usize> {
        self.number.get(dof).copied().filter(|&number| number != SUPPORTED)
    }

    /// The displacement of nodal dof `dof` where it is supported.
    pub fn prescribed(&self, dof: usize) -> Option<f64> {
        let supported = self.number.get(dof) == Some(&SUPPORTED);
        self.prescribed.get(dof).copied().filter(|_| supported)
    }

    /// Nodal displacements from those of the free dofs; supported dofs take their prescribed values.
    ///
    /// # Errors
    /// [`Error::Length`] where `free` does not have one entry per free dof.
    pub fn expand(&self, free: &[f64]) -> Result<Vec<f64>, Error> {
        self.expand_with(free, |dof| self.prescribed(dof).unwrap_or(0.0))
    }

    /// A nodal motion from that of the free dofs; supported dofs stay at zero.
    ///
    /// # Errors
    /// As [`DofMap::expand`].
    pub fn expand_motion(&self, free: &[f64]) -> Result<Vec<f64>, Error> {
        self.expand_with(free, |_| 0.0)
    }

    fn expand_with(&self, free: &[f64], supported: impl Fn(usize) -> f64) -> Result<Vec<f64>, Error> {
        if free.len() != self.free.len() {
            let (found, expected) = (free.len(), self.free.len());
            return Err(Error::Length { name: "displacement", found, expected, of: "free dofs" });
        }
        let value = |(dof, &number): (usize, &usize)| if number == SUPPORTED { supported(dof) } else { free[number] };
        Ok(self.number.iter().enumerate().map(value).collect())
    }

    /// The entries of a nodal vector at the free dofs.
    ///
    /// # Errors
    /// [`Error::Length`] where `nodal` does not have one entry per nodal dof.
    pub fn restrict(&self, nodal: &[f64]) -> Result<Vec<f64>, Error> {
        if nodal.len() != self.nodal_count() {
            let (found, expected) = (nodal.len(), self.nodal_count());
            return Err(Error::Length { name: "nodal vector", found, expected, of: "nodal dofs" });
        }
        Ok(self.free.iter().map(|&dof| nodal[dof]).collect())
    }
}

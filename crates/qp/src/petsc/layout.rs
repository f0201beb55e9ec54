//! The places of the dofs of a problem in PETSc's files: in blocks, one for each node.

/// The nodes that have a free dof, in their order, with a place for each of their components.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Components of a node.
    pub size: usize,
    /// The place `size * node + component` of each free dof, increasing.
    pub place: Vec<u32>,
    /// Coordinates of the nodes in length, `size` each.
    pub coordinates: Vec<f64>,
}

impl Layout {
    /// The layout of free dofs, `size * node + component` each and increasing, of these nodes, in length.
    pub fn of(size: usize, free: &[usize], nodes: &[[f64; 3]]) -> Self {
        let (mut place, mut coordinates) = (Vec::with_capacity(free.len()), Vec::new());
        let mut last = None;
        for &dof in free {
            let node = dof / size;
            if last != Some(node) {
                coordinates.extend_from_slice(&nodes[node][..size]);
                last = Some(node);
            }
            place.push((coordinates.len() - size + dof % size) as u32);
        }
        Layout { size, place, coordinates }
    }

    /// Number of places.
    pub fn places(&self) -> usize {
        self.coordinates.len()
    }

    /// Calls `visit` for each place, with the number of its free dof or `None`.
    ///
    /// # Errors
    /// The first of `visit`.
    pub fn each_place<E>(&self, mut visit: impl FnMut(usize, Option<usize>) -> Result<(), E>) -> Result<(), E> {
        let mut dof = 0;
        for place in 0..self.places() {
            let is_free = self.place.get(dof).is_some_and(|&free| free as usize == place);
            visit(place, is_free.then_some(dof))?;
            dof += usize::from(is_free);
        }
        Ok(())
    }
}

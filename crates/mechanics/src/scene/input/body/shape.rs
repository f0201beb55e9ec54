//! The trait of every body shape: its mesh, its size before the mesh is built, its refinement.

use crate::error::Error;
use crate::fem::element::LatticeCounts;
use crate::fem::mesh::axis::AxisError;
use crate::fem::mesh::{Axis, ElementKind, MAX_NODES, Mesh};
use crate::scene::input::entry::{Files, MeshFiles, wrong};
use crate::scene::input::schema::model::ModelSpec;

/// The name of a shape, of a body or of an obstacle, and the models that allow it.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// The key by which a scene chooses it.
    pub name: &'static str,
    /// The allowed numbers of coordinates of a model; of a body several if its file determines them.
    pub dimensions: &'static [usize],
}

/// A body shape with its numbers.
pub(crate) trait BodyShape {
    /// The cross-section of a bar, in area.
    fn area(&self) -> f64 {
        1.0
    }

    /// The boundaries that approximate circles in the plane, with centre and radius.
    fn circles(&self) -> Vec<(&'static str, [f64; 2], f64)> {
        Vec::new()
    }

    /// Returns `true` if sides of the mesh approximate known circles or spheres, to which finer meshes come nearer.
    fn is_round(&self) -> bool {
        !self.circles().is_empty()
    }

    /// The mesh; errors without a place in the scene count as errors of the whole body.
    fn mesh(&self, site: &BodySite) -> Result<Mesh, Error>;

    /// A block of cells that represents the mesh, which may be one of `files`.
    fn block(&self, files: Option<Files>) -> CellBlock;

    /// Cuts every cell into `times` cells along each edge.
    fn refine(&mut self, times: usize) -> Result<(), Error>;
}

/// The place of a body in a scene.
pub(crate) struct BodySite<'a> {
    /// Its JSON path, as `body.ring`.
    pub path: String,
    pub model: ModelSpec,
    /// The files of the scene.
    pub files: Files<'a>,
    /// The files of meshes that were read for other bodies.
    pub read: &'a MeshFiles,
    /// `true` if the scene names groups of elements with their own materials.
    pub names_groups: bool,
}

impl BodySite<'_> {
    /// Refuses a mesh from a file that has another number of coordinates than the model.
    pub fn fitting(&self, mesh: Mesh) -> Result<Mesh, Error> {
        if mesh.dimension() == self.model.dimension() {
            return Ok(mesh);
        }
        let body = ["a bar", "plane", "in space"][mesh.dimension() - 1];
        let message = format!("the mesh is {body}, which does not fit the model `{}`", self.model.name());
        Err(wrong(format!("{}.file", self.path), message))
    }

    /// The mesh lines of axes, by the names of their fields. A product of divisions with more nodes than allowed is
    /// refused before its lines are made.
    pub fn lines<const N: usize>(&self, axes: [(&str, &Axis); N]) -> Result<[Vec<f64>; N], Error> {
        let cells = axes.map(|(_, axis)| axis.cells());
        // A single axis with too many cells is refused at its own path.
        let possible = cells.iter().all(|&cells| cells <= MAX_NODES);
        let product = cells.iter().fold(1_usize, |product, &cells| product.saturating_mul(cells));
        if possible && product > MAX_NODES {
            let cells = cells.map(|cells| cells.to_string()).join(" x ");
            let message = format!("{cells} cells make more than the {MAX_NODES} nodes that are allowed");
            return Err(wrong(self.path.clone(), message));
        }
        let mut lines = axes.map(|_| Vec::new());
        for (lines, (name, axis)) in lines.iter_mut().zip(axes) {
            let at_field = |error: AxisError| wrong(format!("{}.{name}.{}", self.path, error.field), error.message);
            *lines = axis.coordinates().map_err(at_field)?;
        }
        Ok(lines)
    }

    /// Refuses a number of cells far beyond the limit, by an estimate.
    pub fn check_estimate(&self, block: &CellBlock) -> Result<(), Error> {
        let cells: f64 = block.cells.iter().product();
        if cells > 4.0 * MAX_NODES as f64 {
            let message = format!("about {cells:.0e} cells make more than the {MAX_NODES} nodes that are allowed");
            return Err(wrong(self.path.clone(), message));
        }
        Ok(())
    }
}

/// The meshed part of a round body along an axis through its centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The whole body, on both sides of the centre.
    Both,
    /// The part beyond the centre, which ends at a plane of symmetry.
    Beyond,
}

impl Sides {
    /// The part of a body that `is_symmetric`.
    pub(crate) fn of(is_symmetric: bool) -> Self {
        if is_symmetric { Sides::Beyond } else { Sides::Both }
    }

    /// The lines across the body: those of one side, from 0 on, and their mirror images if there are two sides.
    pub(crate) fn lines(self, aside: &[f64]) -> Vec<f64> {
        match self {
            Sides::Both => aside.iter().skip(1).rev().map(|line| -line).chain(aside.iter().copied()).collect(),
            Sides::Beyond => aside.to_vec(),
        }
    }
}

/// A block of cells that represents the mesh of a body.
pub(crate) struct CellBlock {
    /// Cells along each axis.
    pub cells: Vec<f64>,
    /// Lengths along each axis, if they are known.
    pub lengths: Vec<f64>,
    /// The counts of one cell.
    pub counts: LatticeCounts,
}

impl CellBlock {
    /// The product of divided axes.
    pub fn product(axes: &[&Axis], kind: ElementKind) -> Self {
        let of = |axis: &Axis| axis.divisions.iter().map(|&cells| cells as f64).sum::<f64>();
        CellBlock {
            cells: axes.iter().map(|axis| of(axis)).collect(),
            lengths: axes.iter().map(|axis| axis.length()).collect(),
            counts: kind.reference().counts,
        }
    }
}

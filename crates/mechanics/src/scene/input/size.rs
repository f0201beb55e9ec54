//! The size of a scene before it is built: dofs, entries, factor, bytes; the same scene on a finer mesh.

use super::entry::wrong;
use super::parse::files;
use super::schema::{AnalysisSpec, ModesSpec, Scene};
use crate::bytes;
use crate::error::Error;
use crate::fem::ElasticBody;
use crate::fem::mesh::MAX_NODES;
use signorini_qp as qp;
use signorini_qp::Estimate;

/// The size of a scene, estimated from its divisions: within a factor of 2 of the memory that `solve` takes with a
/// factor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Size {
    /// Number of nodes of the mesh, estimated as the others are.
    pub nodes: f64,
    /// Number of unknowns, as if nothing were supported.
    pub dofs: f64,
    /// Estimated number of entries of the stiffness, both triangles.
    pub stiffness_entries: f64,
    /// Estimated number of values of the Cholesky factor of the stiffness.
    pub factor_entries: f64,
    /// Upper bound of the memory, in bytes.
    pub bytes: f64,
    /// Upper bound of the memory without a factor, by multigrid, in bytes.
    pub multigrid_bytes: f64,
    /// Memory of the model alone, before it is solved, in bytes.
    pub model_bytes: f64,
}

impl Size {
    /// Seconds of meshing and assembly, estimated.
    pub fn assembly_seconds(&self) -> f64 {
        Estimate::assembly_seconds(self.stiffness_entries)
    }

    pub(crate) fn check(&self, [bytes, factor_entries]: [f64; 2], allowed: f64) -> Result<(), Error> {
        let Size { nodes, dofs, stiffness_entries, .. } = *self;
        if nodes <= MAX_NODES as f64 && bytes > allowed {
            return Err(qp::Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed }.into());
        }
        Ok(())
    }
}

pub(crate) fn estimated(scene: &Scene) -> Size {
    let bodies = std::iter::once(&scene.body).chain(scene.further_bodies.iter().map(|further| &further.body));
    let radius = scene.obstacles.iter().map(|obstacle| obstacle.shape.shape().radius());
    let reach = 2.0 * radius.fold(0.0, f64::max);
    let surfaces: f64 = scene.obstacles.iter().map(|obstacle| obstacle.shape.shape().bytes(files(scene))).sum();
    let bytes = Estimate::START + surfaces;
    let mut size = Size { bytes, multigrid_bytes: bytes, model_bytes: bytes, ..Size::default() };
    for body in bodies {
        let block = body.shape().block(Some(files(scene)));
        let (dimension, counts) = (block.cells.len() as f64, block.counts);
        let cells: f64 = block.cells.iter().product();
        let lines: f64 = block.cells.iter().map(|cells| cells + 1.0).product();
        let nodes = lines * counts.nodes;
        let entries = nodes * counts.neighbours * dimension * dimension;
        let across: Vec<f64> = block.cells.iter().map(|cells| cells * counts.line + 1.0).collect();
        let full: f64 = across.iter().product();
        // The lattice of lines has points without a node, for example in the middle of a Q8 cell.
        let factor = dimension * dimension * filled(&across, 0.0) * (nodes / full).min(1.0);
        let narrowest = across.iter().copied().fold(f64::INFINITY, f64::min);
        let share: f64 = block.lengths.iter().map(|length| (reach / length).min(1.0)).fold(1.0, f64::min);
        let shares = share.powi(block.cells.len() as i32 - 1);
        let candidates = if reach > 0.0 { full / narrowest * shares } else { 0.0 };
        size.nodes += nodes;
        size.dofs += nodes * dimension;
        size.stiffness_entries += entries;
        size.factor_entries += factor;
        let (mesh, dofs) = (bytes::of_mesh(nodes, cells * counts.connections), nodes * dimension);
        size.bytes += mesh + Estimate::bytes_of_factor(dofs, entries, factor, candidates);
        size.multigrid_bytes += mesh + Estimate::bytes_of_hierarchy(dofs, entries);
        size.model_bytes += mesh + bytes::of_model(dofs, entries);
    }
    match &scene.analysis {
        Some(AnalysisSpec::Dynamic(_)) => {
            size.bytes += signorini_motion::bytes_of_motion(size.dofs, size.stiffness_entries)
        }
        Some(AnalysisSpec::Modes(ModesSpec { count })) => {
            size.bytes += bytes::of_modes(*count as f64, size.dofs, size.stiffness_entries, size.factor_entries);
        }
        None => {}
    }
    size
}

/// Refuses bodies whose assembly alone would take more than `most` bytes: the size of a mesh from a file is known
/// only now.
pub fn check_bodies(bodies: &[ElasticBody], most: f64) -> Result<(), Error> {
    let (mut dofs, mut stiffness_entries, mut bytes) = (0.0, 0.0, Estimate::START);
    for mesh in bodies.iter().map(ElasticBody::mesh) {
        let (nodes, dimension) = (mesh.nodes().len() as f64, mesh.dimension() as f64);
        let neighbours = mesh.kinds().map(|kind| kind.reference().counts.neighbours).fold(0.0, f64::max);
        let entries = nodes * neighbours * dimension * dimension;
        let connections = mesh.elements().map(<[usize]>::len).sum::<usize>() as f64;
        dofs += nodes * dimension;
        stiffness_entries += entries;
        bytes += bytes::of_mesh(nodes, connections) + bytes::of_model(nodes * dimension, entries);
    }
    match bytes > most {
        true => Err(qp::Error::TooLarge { dofs, stiffness_entries, factor_entries: 0.0, bytes, allowed: most }.into()),
        false => Ok(()),
    }
}

/// Pairs of nodes in the factor of a lattice with these numbers of nodes along its axes, by nested dissection across
/// the longest axis: the separator is coupled with itself and with the `around` nodes around the part that it divides.
///
/// # Source
/// A. George, *Nested dissection of a regular finite element mesh*, SIAM J. Numer. Anal. 10 (1973) 345-363.
fn filled(lattice: &[f64], around: f64) -> f64 {
    /// A part with at most this number of nodes is dense.
    const DENSE: f64 = 8.0;
    /// The share of the neighbours around a part with which a node of the part is coupled.
    const NEIGHBOURS_MET: f64 = 0.7;
    /// Half a part has about this share of the neighbours of the whole part.
    const HALF: f64 = 0.55;
    let count: f64 = lattice.iter().product();
    let longest = lattice.iter().copied().fold(0.0, f64::max);
    if !count.is_finite() {
        return f64::INFINITY;
    }
    if count <= DENSE || longest < 2.0 {
        return count * count / 2.0 + count * around * NEIGHBOURS_MET;
    }
    let separator = count / longest;
    let mut half = lattice.to_vec();
    if let Some(axis) = half.iter_mut().find(|axis| **axis == longest) {
        *axis = longest / 2.0 - 0.5;
    }
    let surface: f64 = half.iter().map(|axis| count / axis).sum();
    let around_half = (HALF * around + separator).min(surface);
    separator * separator / 2.0 + separator * around + 2.0 * filled(&half, around_half)
}

pub(crate) fn refined(scene: &Scene, times: usize) -> Result<Scene, Error> {
    if times == 0 {
        return Err(wrong("body", "each edge of the cells must be divided into at least 1 part, not 0"));
    }
    let mut scene = scene.clone();
    if times == 1 {
        return Ok(scene);
    }
    let further = scene.further_bodies.iter_mut().map(|further| &mut further.body);
    for body in std::iter::once(&mut scene.body).chain(further) {
        body.shape_mut().refine(times)?;
    }
    Ok(scene)
}

/// Returns `true` if a body has sides that approximate known circles or spheres, to which finer meshes come nearer.
pub fn is_round(scene: &Scene) -> bool {
    let further = scene.further_bodies.iter().map(|further| &further.body);
    std::iter::once(&scene.body).chain(further).any(|body| body.shape().is_round())
}

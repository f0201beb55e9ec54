//! How large a scene will be, before anything of it is built: dofs, entries, factor, bytes.

use std::path::Path;

use super::entry::wrong;
use super::schema::{AxisSpec, BodySpec, ElementSpec, Scene, ShapeSpec, SolidElementSpec, ZoneSpec};
use crate::error::Error;
use crate::fem::mesh::MAX_NODES;
use crate::qp::cost::bytes;

/// Where a dense matrix would have more than this share of the values of the factor, nothing is condensed.
const DENSE_SHARE: f64 = 0.4;

/// Dense values that are not worth counting.
const FEW_VALUES: f64 = 1e6;

/// The corner to corner part of a round body's radius that is not core, about.
const SHELLS: f64 = 0.6;

/// Bytes of a mesh file for one node and the elements that belong to it, about.
const OF_MESH_FILE: f64 = 150.0;

/// The size of a scene, estimated from its divisions: within a factor of 2 of the memory that `solve` takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// Nodes.
    pub nodes: f64,
    /// Unknowns, as if nothing were supported.
    pub dofs: f64,
    /// Entries of the stiffness, both triangles.
    pub stiffness_entries: f64,
    /// Values of its Cholesky factor.
    pub factor_entries: f64,
    /// Memory at the most, in bytes.
    pub bytes: f64,
    /// Memory at the most without a factor, by multigrid, in bytes.
    pub multigrid_bytes: f64,
}

/// A block of cells that stands for the mesh of a body.
struct Block {
    /// Cells along each axis.
    cells: Vec<f64>,
    /// Lengths along each axis, where they are known.
    lengths: Vec<f64>,
    element: Counts,
}

/// What an element brings with it.
#[derive(Clone, Copy)]
struct Counts {
    /// Nodes that a cell adds to a large mesh, and to a line across it.
    nodes: f64,
    line: f64,
    /// Nodes of the elements of a cell together.
    connections: f64,
    /// Nodes whose stiffness a node meets, itself among them, on average.
    neighbours: f64,
}

const BAR: Counts = Counts { nodes: 1.0, line: 1.0, connections: 2.0, neighbours: 3.0 };
const T3: Counts = Counts { nodes: 1.0, line: 1.0, connections: 6.0, neighbours: 7.0 };
const T6: Counts = Counts { nodes: 4.0, line: 2.0, connections: 12.0, neighbours: 11.5 };
const Q4: Counts = Counts { nodes: 1.0, line: 1.0, connections: 4.0, neighbours: 9.0 };
const Q8: Counts = Counts { nodes: 3.0, line: 2.0, connections: 8.0, neighbours: 15.5 };
const TET4: Counts = Counts { nodes: 1.0, line: 1.0, connections: 24.0, neighbours: 15.0 };
const HEX8: Counts = Counts { nodes: 1.0, line: 1.0, connections: 8.0, neighbours: 27.0 };

/// Seconds of meshing and assembly for an entry of the stiffness, on one processor of 2024.
const ASSEMBLY: f64 = 3e-8;

impl Size {
    /// Seconds of meshing and assembly, estimated.
    pub fn assembly_seconds(&self) -> f64 {
        ASSEMBLY * self.stiffness_entries
    }
}

impl Scene {
    /// Estimates the size of the scene without building it; of a mesh file its length alone is read.
    pub fn size(&self) -> Size {
        let mut size = Size {
            nodes: 0.0,
            dofs: 0.0,
            stiffness_entries: 0.0,
            factor_entries: 0.0,
            bytes: bytes::START,
            multigrid_bytes: bytes::START,
        };
        let bodies = std::iter::once(&self.body).chain(self.further_bodies.iter().map(|further| &further.body));
        let radius = self.obstacles.iter().map(|obstacle| match &obstacle.shape {
            ShapeSpec::Circle(circle) => circle.radius,
            ShapeSpec::Sphere(sphere) => sphere.radius,
            _ => f64::INFINITY,
        });
        let reach = 2.0 * radius.fold(0.0, f64::max);
        for body in bodies {
            let block = body.block(self.folder.as_deref());
            let (dimension, counts) = (block.cells.len() as f64, block.element);
            let cells: f64 = block.cells.iter().product();
            let lines: f64 = block.cells.iter().map(|cells| cells + 1.0).product();
            let nodes = lines * counts.nodes;
            let entries = nodes * counts.neighbours * dimension * dimension;
            let across: Vec<f64> = block.cells.iter().map(|cells| cells * counts.line + 1.0).collect();
            let full: f64 = across.iter().product();
            // The lattice of lines has places without a node, as in the middle of a Q8 cell.
            let factor = dimension * dimension * filled(&across, 0.0) * (nodes / full).min(1.0);
            let narrowest = across.iter().copied().fold(f64::INFINITY, f64::min);
            let share: f64 = block.lengths.iter().map(|length| (reach / length).min(1.0)).fold(1.0, f64::min);
            let shares = share.powi(block.cells.len() as i32 - 1);
            let candidates = if reach > 0.0 { full / narrowest * shares } else { 0.0 };
            let dense = candidates.powi(2).min(DENSE_SHARE * factor.max(FEW_VALUES));
            size.nodes += nodes;
            size.dofs += nodes * dimension;
            size.stiffness_entries += entries;
            size.factor_entries += factor;
            let (mesh, dofs) = (bytes::of_mesh(nodes, cells * counts.connections), nodes * dimension);
            let direct = bytes::of_factor(factor, size_of::<f64>()) + bytes::of_dense(dense.sqrt());
            size.bytes += mesh + bytes::of_problem(dofs, entries) + direct;
            size.multigrid_bytes += mesh + bytes::of_hierarchy(dofs, entries);
        }
        size
    }

    /// Refuses a scene that would take more than `most` bytes. One of too many nodes is left to [`Scene::build`], which
    /// refuses it at its divisions.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub fn check_size(&self, most: f64) -> Result<(), Error> {
        let Size { bytes, factor_entries, .. } = self.size();
        self.check_bytes(bytes, factor_entries, most)
    }

    /// As [`Scene::check_size`], for methods that may do without a factor.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub fn check_size_without_factor(&self, most: f64) -> Result<(), Error> {
        let Size { bytes, multigrid_bytes, .. } = self.size();
        self.check_bytes(bytes.min(multigrid_bytes), 0.0, most)
    }

    fn check_bytes(&self, bytes: f64, factor_entries: f64, most: f64) -> Result<(), Error> {
        let Size { nodes, dofs, stiffness_entries, .. } = self.size();
        if nodes <= MAX_NODES as f64 && bytes > most {
            return Err(Error::TooLarge { dofs, stiffness_entries, factor_entries, bytes, allowed: most });
        }
        Ok(())
    }
}

impl BodySpec {
    /// Refuses a product of divisions that makes more nodes than are allowed, before its lines are made.
    pub(super) fn check_count(&self, path: String) -> Result<(), Error> {
        let axes: Vec<&AxisSpec> = match self {
            BodySpec::Rectangle(spec) => vec![&spec.x, &spec.y],
            BodySpec::Box(spec) => vec![&spec.x, &spec.y, &spec.z],
            BodySpec::Ring(spec) => vec![&spec.radius, &spec.angle],
            BodySpec::Disc(_) | BodySpec::HalfDisc(_) | BodySpec::HalfBall(_) => {
                let cells: f64 = self.block(None).cells.iter().product();
                // An estimate refuses only what is far beyond.
                let beyond = cells > 4.0 * MAX_NODES as f64;
                let message = format!("some {cells:.0e} cells make more than the {MAX_NODES} nodes that are allowed");
                return if beyond { Err(wrong(path, message)) } else { Ok(()) };
            }
            BodySpec::Bar(_) | BodySpec::Gmsh(_) => return Ok(()),
        };
        let cells: Vec<usize> =
            axes.iter().map(|axis| axis.divisions.iter().fold(0, |sum: usize, &n| sum.saturating_add(n))).collect();
        // A single axis of too many is refused at its own path.
        let possible = cells.iter().all(|&cells| cells <= MAX_NODES);
        let product = cells.iter().fold(1_usize, |product, &cells| product.saturating_mul(cells));
        if possible && product > MAX_NODES {
            let cells: Vec<String> = cells.iter().map(usize::to_string).collect();
            let message = format!("{} cells make more than the {MAX_NODES} nodes that are allowed", cells.join(" x "));
            return Err(wrong(path, message));
        }
        Ok(())
    }

    fn block(&self, folder: Option<&Path>) -> Block {
        let cells = |axis: &AxisSpec| axis.divisions.iter().map(|&cells| cells as f64).sum::<f64>();
        let length = |axis: &AxisSpec| match (axis.points.first(), axis.points.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        };
        let of = |axes: &[&AxisSpec], element| Block {
            cells: axes.iter().map(|axis| cells(axis)).collect(),
            lengths: axes.iter().map(|axis| length(axis)).collect(),
            element,
        };
        match self {
            BodySpec::Bar(spec) => of(&[&spec.x], BAR),
            BodySpec::Rectangle(spec) => of(&[&spec.x, &spec.y], spec.element.counts()),
            BodySpec::Box(spec) => {
                let element = if spec.element == SolidElementSpec::Tet4 { TET4 } else { HEX8 };
                of(&[&spec.x, &spec.y, &spec.z], element)
            }
            BodySpec::Ring(spec) => {
                let (lengths, element) = (Vec::new(), spec.element.counts());
                Block { cells: vec![cells(&spec.radius), cells(&spec.angle)], lengths, element }
            }
            BodySpec::HalfDisc(spec) => half_disc(&spec.zone, spec.radius, spec.symmetric, spec.element),
            BodySpec::Disc(spec) => {
                let mut halves = half_disc(&spec.zone, spec.radius, spec.symmetric, spec.element);
                halves.cells[0] *= 2.0;
                halves
            }
            BodySpec::HalfBall(spec) => {
                let zone = spec.zone.zone();
                let (aside, last) = zone.count(spec.radius * std::f64::consts::FRAC_PI_4);
                let (shells, _) = zone.count(spec.radius * SHELLS);
                let down = spec.radius * std::f64::consts::FRAC_PI_4 / last;
                let halves = spec.symmetric.len().min(2) as i32;
                // Top and four sides of the core, less what symmetry leaves out.
                let around = (4.0 * aside * aside + 8.0 * aside * down) / 2.0_f64.powi(halves);
                let core = 4.0 * aside * aside * down / 2.0_f64.powi(halves);
                let side = around.sqrt();
                Block { cells: vec![side, side, shells + core / around], lengths: Vec::new(), element: HEX8 }
            }
            BodySpec::Gmsh(spec) => {
                let file = folder.map_or_else(|| spec.file.clone().into(), |folder| folder.join(&spec.file));
                let bytes = std::fs::metadata(file).map_or(0.0, |about| about.len() as f64);
                // What is plane has fewer elements for a node, which its own estimate hardly notices.
                let side = (bytes / OF_MESH_FILE).sqrt();
                Block { cells: vec![side; 2], lengths: Vec::new(), element: T3 }
            }
        }
    }
}

fn half_disc(zone: &ZoneSpec, radius: f64, symmetric: bool, element: ElementSpec) -> Block {
    let zone = zone.zone();
    let (aside, last) = zone.count(radius * std::f64::consts::FRAC_PI_4);
    let (shells, _) = zone.count(radius * SHELLS);
    let (down, sides) = (radius * std::f64::consts::FRAC_PI_4 / last, 2.0 - f64::from(symmetric));
    let around = sides * (aside + down);
    let core = sides * aside * down;
    Block { cells: vec![around, shells + core / around], lengths: Vec::new(), element: element.counts() }
}

impl ElementSpec {
    fn counts(self) -> Counts {
        match self {
            ElementSpec::T3 => T3,
            ElementSpec::T6 => T6,
            ElementSpec::Q4 => Q4,
            ElementSpec::Q8 => Q8,
        }
    }
}

/// Pairs of nodes in the factor of a lattice with so many nodes along its axes, by nested dissection across the longest
/// axis: the separator meets itself and the nodes around the part that it divides, `around` of them.
///
/// # Source
/// A. George, *Nested dissection of a regular finite element mesh*, SIAM J. Numer. Anal. 10 (1973) 345-363.
fn filled(lattice: &[f64], around: f64) -> f64 {
    /// A part of so few nodes is dense.
    const DENSE: f64 = 8.0;
    /// The share of the neighbours around a part that a node of it meets.
    const MET: f64 = 0.7;
    /// Half a part has about this share of the neighbours of the whole.
    const HALF: f64 = 0.55;
    let count: f64 = lattice.iter().product();
    let longest = lattice.iter().copied().fold(0.0, f64::max);
    if !count.is_finite() {
        return f64::INFINITY;
    }
    if count <= DENSE || longest < 2.0 {
        return count * count / 2.0 + count * around * MET;
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

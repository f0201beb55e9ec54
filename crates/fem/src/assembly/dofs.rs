//! Free and supported dofs: eliminate, and expand again; the frames of nodes at inclined supports; rigid-body modes.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::PositiveBasis;
use crate::body::ElasticBody;
use crate::error::Error;
use crate::geometry::{COORDINATES, dot, shifted, unit};
use crate::mesh::Mesh;
use signorini_linear as linear;

/// Takes the place of the number at a supported dof.
const SUPPORTED: usize = usize::MAX;

/// A component of a vector along an axis of a frame below this, relative to the vector, is rounding of the frame.
const NO_COMPONENT: f64 = 1e-14;

/// The free dofs, their numbers in the problem, and the displacement of the supported dofs.
///
/// The dofs of a node run along the coordinate axes; those of a node with a [`Frame`] run along the axes of the frame
/// and are called local dofs. Nodal vectors always run along the coordinate axes.
///
/// On quadratic faces in space that may touch an obstacle, the dofs of a mid-side node are coefficients of shape
/// functions with positive integrals; those of all other nodes are their displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct DofMap {
    /// Zero at free dofs.
    prescribed: Vec<f64>,
    /// [`SUPPORTED`] at supported dofs.
    number: Vec<usize>,
    free: Vec<usize>,
    /// Dofs of a node; used only for frames.
    dimension: usize,
    frames: BTreeMap<usize, Frame>,
    /// The coefficients at mid-side nodes.
    pub basis: PositiveBasis,
}

/// The displacement of a node, or its coefficient, along a vector: the sum of `coefficient * free dof` and of the part
/// of the supported dofs.
#[derive(Clone, Debug, PartialEq)]
pub struct Along {
    /// Numbers of free dofs with their coefficients.
    pub free: Vec<(usize, f64)>,
    /// The part of the supported dofs, in units of length.
    pub prescribed: f64,
}

impl DofMap {
    /// From one entry per nodal dof, length `dim * n_nodes`, order `[u_x0, u_y0, u_x1, ...]`: the prescribed
    /// displacement, in length along the positive axis, or `None` for a free dof.
    pub fn new(prescribed: Vec<Option<f64>>) -> Result<Self, Error> {
        let (mut number, mut free) = (Vec::with_capacity(prescribed.len()), Vec::new());
        for (dof, value) in prescribed.iter().enumerate() {
            match *value {
                Some(value) if !value.is_finite() => {
                    let (name, at) = ("prescribed displacement", format!("dof {dof}"));
                    return Err(linear::Error::NotFinite { name, at, value, allowed: "finite" }.into());
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
        let (frames, basis) = (BTreeMap::new(), PositiveBasis::default());
        Ok(DofMap { prescribed, number, free, dimension: 1, frames, basis })
    }

    /// From one entry per dof, `dimension` per node, in length; those of the nodes in `frames` are local: along the
    /// axes of their frame.
    ///
    /// # Errors
    /// As [`DofMap::new`]; [`Error::Mesh`] for a frame of a node that the mesh does not have.
    pub fn with_frames(
        prescribed: Vec<Option<f64>>,
        dimension: usize,
        frames: BTreeMap<usize, Frame>,
    ) -> Result<Self, Error> {
        let nodes = prescribed.len().checked_div(dimension).unwrap_or(0);
        match frames.keys().find(|&&node| node >= nodes) {
            Some(node) => Err(Error::Mesh { message: format!("a frame for node {node}, but there are {nodes} nodes") }),
            None => Ok(DofMap { dimension, frames, ..Self::new(prescribed)? }),
        }
    }

    /// The same with coefficients at the mid-side nodes of `boundaries`, which obstacles may touch, if `body` has
    /// quadratic faces in space. The coefficients belong to shape functions with positive integrals, so that a uniform
    /// pressure pushes at every node.
    ///
    /// A mid-side node keeps its displacement if a support holds it but does not hold both ends of its edge in the same
    /// way. Boundaries that the mesh does not have are ignored.
    ///
    /// # Source
    /// A. Popp, B. I. Wohlmuth, M. W. Gee, W. A. Wall, *Dual quadratic mortar finite element methods for 3D finite
    /// deformation contact*, SIAM J. Sci. Comput. 34 (2012) B421-B446.
    pub fn with_contact_faces<'a>(mut self, body: &ElasticBody, boundaries: impl IntoIterator<Item = &'a str>) -> Self {
        let dimension = body.dimension();
        let boundaries = boundaries.into_iter().filter_map(|name| body.mesh().boundary(name));
        let mut basis = PositiveBasis::on(boundaries);
        if basis.is_nodal() {
            return self;
        }
        let held = |node: usize, axis: usize| self.number[dimension * node + axis] == SUPPORTED;
        let is_turned = |node: usize| self.frames.contains_key(&node);
        basis.retain(|middle, ends| {
            let held_alike =
                |axis: usize| !held(middle, axis) || ends.iter().all(|&end| held(end, axis) && !is_turned(end));
            !is_turned(middle) && (0..dimension).all(held_alike)
        });
        for dof in (0..self.number.len()).filter(|&dof| self.number[dof] == SUPPORTED) {
            let (node, axis) = (dof / dimension, dof % dimension);
            self.prescribed[dof] = basis.coefficient(node, |node| self.prescribed[dimension * node + axis]);
        }
        DofMap { dimension, basis, ..self }
    }

    /// The coefficient at a node of a function with these values at the nodes, in their unit: the gap of its contact
    /// row. It is the value itself, except at mid-side nodes of [contact faces](Self::with_contact_faces).
    pub fn coefficient(&self, node: usize, value: impl Fn(usize) -> f64) -> f64 {
        self.basis.coefficient(node, value)
    }

    /// The tributary areas of contact rows from those of the nodes of a boundary: `(node, area)` in the order of the
    /// boundary, in area. They are the integrals of the shape functions of their dofs: the areas themselves, except on
    /// [contact faces](Self::with_contact_faces).
    pub fn row_areas(&self, of_nodes: &[(usize, f64)]) -> Vec<(usize, f64)> {
        let mut areas: BTreeMap<usize, f64> = BTreeMap::new();
        if !self.basis.is_nodal() {
            areas.extend(of_nodes.iter().copied());
            self.basis.gather_areas(&mut areas);
        }
        of_nodes.iter().map(|&(node, area)| (node, areas.get(&node).copied().unwrap_or(area))).collect()
    }

    /// All dofs of `mesh` free, except those of the nodes of `boundaries`: they move by `displacement(point)`. Point
    /// and displacement have the order [x, y, z], in length; entries beyond the dimension are ignored.
    ///
    /// # Errors
    /// As [`DofMap::new`]; [`Error::Mesh`] for a boundary that the mesh does not have.
    pub fn holding(
        mesh: &Mesh,
        boundaries: &[&str],
        displacement: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Result<Self, Error> {
        let dimension = mesh.dimension();
        let mut prescribed = vec![None; dimension * mesh.nodes().len()];
        for name in boundaries {
            let missing = || Error::Mesh { message: format!("there is no boundary `{name}`") };
            for node in mesh.boundary(name).ok_or_else(missing)?.nodes() {
                let value = displacement(mesh.nodes()[node]);
                for (axis, &component) in value.iter().enumerate().take(dimension) {
                    prescribed[dimension * node + axis] = Some(component);
                }
            }
        }
        Self::new(prescribed)
    }

    /// Number of nodal dofs, free and supported.
    pub fn nodal_count(&self) -> usize {
        self.prescribed.len()
    }

    /// The frame of a node with local dofs.
    #[inline]
    pub fn frame(&self, node: usize) -> Option<&Frame> {
        self.frames.get(&node)
    }

    /// The directions of the dofs of `node`: the axes of its frame, or else of the coordinates.
    #[doc(hidden)]
    pub fn axes(&self, node: usize) -> &[[f64; 3]; 3] {
        self.frame(node).map_or(&COORDINATES, Frame::axes)
    }

    /// The displacement of `node` along `vector`, which has one entry per coordinate and no unit, in terms of the free
    /// dofs: the form of a contact row or of a measured displacement. At a mid-side node with a coefficient it is the
    /// coefficient.
    pub fn along(&self, node: usize, vector: &[f64]) -> Along {
        let mut local = vector.to_vec();
        if let Some(frame) = self.frame(node) {
            frame.turn_in(&mut local);
            let rounding = NO_COMPONENT * local.iter().fold(0.0, |length: f64, part| length.hypot(*part));
            local.iter_mut().filter(|part| part.abs() < rounding).for_each(|part| *part = 0.0);
        }
        let mut along = Along { free: Vec::with_capacity(local.len()), prescribed: 0.0 };
        for (axis, &component) in local.iter().enumerate().filter(|entry| *entry.1 != 0.0) {
            let dof = vector.len() * node + axis;
            match self.number(dof) {
                Some(number) => along.free.push((number, component)),
                None => along.prescribed += component * self.prescribed(dof).unwrap_or(0.0),
            }
        }
        along
    }

    /// The displacement of `node` itself, never its coefficient, along `vector`, which has one entry per coordinate.
    pub(crate) fn displacement_along(&self, node: usize, vector: &[f64]) -> Along {
        let mut sum = Along { free: Vec::new(), prescribed: 0.0 };
        for (of, share) in self.basis.values(node) {
            let along = self.along(of, vector);
            sum.prescribed += share * along.prescribed;
            sum.free.extend(along.free.into_iter().map(|(number, part)| (number, share * part)));
        }
        sum
    }

    /// The nodal dof of each free dof, increasing: entry i is the index, from 0, among the `dim * n_nodes` nodal dofs.
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// The number of nodal dof `dof` among the free dofs, from 0; `None` if it is supported.
    #[inline]
    pub fn number(&self, dof: usize) -> Option<usize> {
        self.number.get(dof).copied().filter(|&number| number != SUPPORTED)
    }

    /// The displacement of nodal dof `dof`, in length, if it is supported.
    pub fn prescribed(&self, dof: usize) -> Option<f64> {
        let supported = self.number.get(dof) == Some(&SUPPORTED);
        self.prescribed.get(dof).copied().filter(|_| supported)
    }

    /// Nodal displacements, length `dim * n_nodes`, in length, from those of the free dofs (`free`, one entry per free
    /// dof, in length); supported dofs take their prescribed values.
    pub fn expand(&self, free: &[f64]) -> Result<Vec<f64>, Error> {
        self.expand_with(free, |dof| self.prescribed(dof).unwrap_or(0.0))
    }

    /// A nodal motion, length `dim * n_nodes`, from that of the free dofs (`free`, one entry per free dof), both in
    /// length, or in length over time; supported dofs stay at zero.
    pub fn expand_motion(&self, free: &[f64]) -> Result<Vec<f64>, Error> {
        self.expand_with(free, |_| 0.0)
    }

    fn expand_with(&self, free: &[f64], supported: impl Fn(usize) -> f64) -> Result<Vec<f64>, Error> {
        linear::Error::check_length("displacement", free.len(), self.free.len(), "free dofs")?;
        let value = |(dof, &number): (usize, &usize)| if number == SUPPORTED { supported(dof) } else { free[number] };
        let mut nodal: Vec<f64> = self.number.iter().enumerate().map(value).collect();
        self.turn_back(&mut nodal);
        self.basis.evaluate(&mut nodal, self.dimension);
        Ok(nodal)
    }

    /// The entries of nodal forces (`nodal`, length `dim * n_nodes`, in force) at the free dofs: one entry per free
    /// dof, in force.
    pub fn restrict(&self, nodal: &[f64]) -> Result<Vec<f64>, Error> {
        let local = self.turned_in(nodal)?;
        Ok(self.free.iter().map(|&dof| local[dof]).collect())
    }

    /// The part of nodal forces (`nodal`, length `dim * n_nodes`, in force) along the supported dofs, of the same
    /// length: the reactions among the forces on all nodes.
    pub fn supported_part(&self, nodal: &[f64]) -> Result<Vec<f64>, Error> {
        self.part(nodal, |dof| self.number(dof).is_none())
    }

    /// The part of nodal forces along some of the dofs.
    #[doc(hidden)]
    pub fn part(&self, nodal: &[f64], keeps: impl Fn(usize) -> bool) -> Result<Vec<f64>, Error> {
        let mut part = self.turned_in(nodal)?.into_owned();
        part.iter_mut().enumerate().filter(|(dof, _)| !keeps(*dof)).for_each(|(_, value)| *value = 0.0);
        self.turn_back(&mut part);
        self.basis.scatter(&mut part, self.dimension);
        Ok(part)
    }

    /// Nodal forces as forces on coefficients; the entries of nodes with frames run along the axes of the frame.
    fn turned_in<'a>(&self, nodal: &'a [f64]) -> Result<Cow<'a, [f64]>, Error> {
        linear::Error::check_length("nodal vector", nodal.len(), self.nodal_count(), "nodal dofs")?;
        let mut local = Cow::Borrowed(nodal);
        if !self.basis.is_nodal() {
            self.basis.gather(local.to_mut(), self.dimension);
        }
        for (node, frame) in &self.frames {
            frame.turn_in(&mut local.to_mut()[self.dimension * node..self.dimension * (node + 1)]);
        }
        Ok(local)
    }

    fn turn_back(&self, local: &mut [f64]) {
        for (node, frame) in &self.frames {
            frame.turn_back(&mut local[self.dimension * node..self.dimension * (node + 1)]);
        }
    }
}

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
pub fn perpendicular(vector: [f64; 3], axes: &[[f64; 3]]) -> [f64; 3] {
    axes.iter().fold(vector, |rest, &axis| shifted(rest, -dot(rest, axis), axis))
}

/// The rigid-body modes at the free dofs, one vector each, one entry per free dof: the translations, then the rotations
/// about the centre of the mesh, divided by half its size so that all are dimensionless and of order one.
///
/// A body of revolution is treated as its half plane: the distance from the axis is ignored.
pub fn rigid_body_modes(body: &ElasticBody, dofs: &DofMap) -> Vec<Vec<f64>> {
    let (mesh, dimension) = (body.mesh(), body.dimension());
    let (least, most) = mesh.extent();
    let size = mesh.size();
    let rotations: &[[usize; 2]] = match dimension {
        1 => &[],
        2 => &[[0, 1]],
        _ => &[[1, 2], [2, 0], [0, 1]],
    };
    let mut motions = vec![Vec::with_capacity(dofs.free().len()); dimension + rotations.len()];
    for &dof in dofs.free() {
        let (node, axis) = (dof / dimension, dof % dimension);
        let direction = dofs.axes(node)[axis];
        let place = dofs.basis.place(mesh.nodes(), node);
        let from_middle = [0, 1, 2].map(|i| (2.0 * place[i] - least[i] - most[i]) / size);
        for (translation, motion) in motions[..dimension].iter_mut().enumerate() {
            motion.push(direction[translation]);
        }
        for (&[first, second], motion) in rotations.iter().zip(&mut motions[dimension..]) {
            motion.push(from_middle[first] * direction[second] - from_middle[second] * direction[first]);
        }
    }
    motions
}

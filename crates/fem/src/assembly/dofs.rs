//! The unknowns of a body: u = C y + u0. Supports eliminate dofs, frames turn them, and nodes may follow motions.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use super::PositiveBasis;
use crate::body::ElasticBody;
use crate::dense::DenseMatrix;
use crate::error::Error;
use crate::geometry::{COORDINATES, cross, dot, shifted, unit};
use crate::mesh::Mesh;
use crate::sum::LinearForm;
use signorini_linear as linear;

/// Takes the place of the number at a supported dof.
const SUPPORTED: usize = usize::MAX;

/// A component of a vector along an axis of a frame below this, relative to the vector, is rounding of the frame.
pub(super) const NO_COMPONENT: f64 = 1e-14;

/// Takes the place of the number at a dof of a node that follows motions.
const FOLLOWING: usize = usize::MAX - 1;

/// Singular values below this, relative to the largest, are rounding of the places of nodes.
const DEPENDENT: f64 = 1e-12;

/// The unknowns of a body, and the displacements of its nodes as affine functions of them: u = C y + u0.
///
/// The unknowns are the free dofs, then the motions that some nodes follow, and then those without nodes. The dofs of a
/// node run along the coordinate axes; those of a node with a [`Frame`] run along the axes of the frame and are called
/// local dofs. Nodal vectors always run along the coordinate axes.
///
/// On quadratic faces in space that may touch an obstacle, the dofs of a mid-side node are coefficients of shape
/// functions with positive integrals; those of all other nodes are their displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct DofMap {
    /// Zero at free dofs.
    prescribed: Vec<f64>,
    /// [`SUPPORTED`] at supported dofs, [`FOLLOWING`] at those of nodes that follow motions.
    number: Vec<usize>,
    free: Vec<usize>,
    /// Dofs of a node; used only for frames and coefficients.
    dimension: usize,
    frames: BTreeMap<usize, Frame>,
    /// The nodes whose dofs are not their displacements along the coordinate axes: those with frames, and followers.
    moved: BTreeMap<usize, NodeMotion>,
    /// The group of each follower.
    group_of: BTreeMap<usize, usize>,
    /// The first motion of each group, the first one without nodes, and the number of all unknowns.
    motions: Vec<usize>,
    /// The coefficients at mid-side nodes.
    pub basis: PositiveBasis,
}

/// The displacement of a node, or its coefficient, as a function of unknowns: `offset + sum of y_k v_k`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeMotion {
    /// The part that no unknown changes, [x, y, z], in length.
    pub offset: [f64; 3],
    /// Unknowns y_k, each with the displacement v_k by one of it.
    pub by_unknown: Vec<ByOne>,
}

/// An unknown, and the displacement [x, y, z] of a node by one of it.
pub type ByOne = (usize, [f64; 3]);

/// Nodes that follow the same motions.
#[derive(Clone, Debug, Default)]
pub struct Followers {
    /// How many motions are unknown.
    pub motions: usize,
    /// The nodes, with the motions by their numbers from 0.
    pub nodes: Vec<(usize, NodeMotion)>,
}

/// A linear form in the unknowns: the sum of `coefficient * unknown` and of what is prescribed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Along {
    /// Numbers of unknowns with their coefficients.
    pub free: Vec<(usize, f64)>,
    /// The part of the supported dofs, in units of length.
    pub prescribed: f64,
}

impl Along {
    /// Its value at values of the unknowns.
    pub fn value(&self, values: &[f64]) -> f64 {
        self.free.iter().fold(self.prescribed, |sum, &(unknown, part)| sum + part * values[unknown])
    }
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
        let (frames, moved, group_of) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        let (motions, basis) = (vec![free.len(); 2], PositiveBasis::default());
        Ok(DofMap { prescribed, number, free, dimension: 1, frames, moved, group_of, motions, basis })
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
            None => {
                let mut dofs = DofMap { dimension, frames, ..Self::new(prescribed)? };
                dofs.moved = dofs.frames.iter().map(|(&node, frame)| (node, dofs.in_frame(node, frame))).collect();
                Ok(dofs)
            }
        }
    }

    /// The displacement of a node with a frame.
    fn in_frame(&self, node: usize, frame: &Frame) -> NodeMotion {
        let mut moved = NodeMotion::default();
        for (dof, &axis) in (self.dimension * node..self.dimension * (node + 1)).zip(&frame.axes) {
            match self.number(dof) {
                Some(number) => moved.by_unknown.push((number, axis)),
                None => moved.offset = shifted(moved.offset, self.prescribed[dof], axis),
            }
        }
        moved
    }

    /// The same with nodes that follow motions, group by group, instead of unknowns of their own; a node follows one
    /// group. At a node with a coefficient it is the coefficient that follows.
    #[doc(hidden)]
    pub fn with_followers(mut self, dimension: usize, groups: Vec<Followers>) -> Self {
        for (group, followers) in groups.iter().enumerate() {
            for &(node, _) in &followers.nodes {
                self.number[dimension * node..dimension * (node + 1)].fill(FOLLOWING);
                self.prescribed[dimension * node..dimension * (node + 1)].fill(0.0);
                self.frames.remove(&node);
                self.group_of.insert(node, group);
            }
        }
        self.free.retain(|&dof| self.number[dof] != FOLLOWING);
        self.free.iter().enumerate().for_each(|(number, &dof)| self.number[dof] = number);
        self.dimension = dimension;
        self.moved = self.frames.iter().map(|(&node, frame)| (node, self.in_frame(node, frame))).collect();
        self.motions = vec![self.free.len()];
        for Followers { motions, nodes } in groups {
            let first = self.count();
            for (node, mut moved) in nodes {
                moved.by_unknown.iter_mut().for_each(|of| of.0 += first);
                self.moved.insert(node, moved);
            }
            self.motions.push(first + motions);
        }
        self.motions.push(self.count());
        self
    }

    /// The same with more unknowns at the end, which move no node.
    #[doc(hidden)]
    pub fn with_further(mut self, count: usize) -> Self {
        self.motions.last_mut().into_iter().for_each(|all| *all += count);
        self
    }

    /// Number of unknowns: free dofs, then motions.
    pub fn count(&self) -> usize {
        self.motions.last().copied().unwrap_or(0)
    }

    /// Number of groups of nodes that follow the same motions.
    #[doc(hidden)]
    pub fn groups(&self) -> usize {
        self.motions.len() - 2
    }

    /// The unknown motions of a group of followers.
    #[doc(hidden)]
    pub fn motions(&self, group: usize) -> Range<usize> {
        self.motions[group]..self.motions[group + 1]
    }

    /// The unknowns next to a displacement [x, y, z] of each node, or of its coefficient, without what is prescribed,
    /// in length: motions that nodes follow by least squares; zero for those without nodes.
    #[doc(hidden)]
    pub fn nearest(&self, at: impl Fn(usize) -> [f64; 3]) -> Vec<f64> {
        let of_dof =
            |&dof: &usize| dot(self.axes(dof / self.dimension)[dof % self.dimension], at(dof / self.dimension));
        let mut values: Vec<f64> = self.free.iter().map(of_dof).collect();
        values.resize(self.count(), 0.0);
        for group in 0..self.groups() {
            // The normal equations of its motions, which are independent.
            let motions = self.motions(group);
            let (mut matrix, mut right) = (vec![vec![0.0; motions.len()]; motions.len()], vec![0.0; motions.len()]);
            for (node, _) in self.group_of.iter().filter(|of| *of.1 == group) {
                let by_unknown = &self.moved[node].by_unknown;
                for &(row, along) in by_unknown {
                    right[row - motions.start] += dot(along, at(*node));
                    for &(column, other) in by_unknown {
                        matrix[row - motions.start][column - motions.start] += dot(along, other);
                    }
                }
            }
            let matrix = DenseMatrix::from_fn(right.len(), right.len(), |row, column| matrix[row][column]);
            values[motions].copy_from_slice(&matrix.singular_values().solve(&right, DEPENDENT));
        }
        values
    }

    /// The group that a node follows.
    #[inline]
    pub(super) fn group_of(&self, node: usize) -> Option<usize> {
        self.group_of.get(&node).copied()
    }

    /// Returns `true` if the dofs of a node are its displacements along the coordinate axes.
    #[inline]
    pub(super) fn is_plain(&self, node: usize) -> bool {
        !self.moved.contains_key(&node) && self.basis.ends(node).is_none()
    }

    /// Returns `true` if every node is plain.
    pub(super) fn all_plain(&self) -> bool {
        self.moved.is_empty() && self.basis.is_nodal()
    }

    /// The displacement of a node, or its coefficient, in the unknowns.
    fn moved(&self, node: usize, dimension: usize) -> Cow<'_, NodeMotion> {
        if let Some(moved) = self.moved.get(&node) {
            return Cow::Borrowed(moved);
        }
        let mut moved = NodeMotion::default();
        for (axis, &along) in COORDINATES.iter().enumerate().take(dimension) {
            let dof = dimension * node + axis;
            match self.number(dof) {
                Some(number) => moved.by_unknown.push((number, along)),
                None => moved.offset[axis] = self.prescribed[dof],
            }
        }
        Cow::Owned(moved)
    }

    /// The displacement of a node itself, never its coefficient, by one of each unknown.
    pub(crate) fn displaced_by(&self, node: usize, dimension: usize) -> Vec<ByOne> {
        let mut all = Vec::new();
        for (of, share) in self.basis.values(node) {
            let moved = self.moved(of, dimension);
            all.extend(moved.by_unknown.iter().map(|&(unknown, by_one)| (unknown, by_one.map(|part| share * part))));
        }
        all
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

    /// The displacement of `node` along `vector`, which has one entry per coordinate and no unit, in terms of the
    /// unknowns: the form of a contact row or of a measured displacement. At a mid-side node with a coefficient it is
    /// the coefficient.
    pub fn along(&self, node: usize, vector: &[f64]) -> Along {
        let moved = self.moved(node, vector.len());
        let part = |by_one: &[f64; 3]| vector.iter().zip(by_one).map(|(entry, part)| entry * part).sum::<f64>();
        let rounding = NO_COMPONENT * vector.iter().fold(0.0, |length: f64, part| length.hypot(*part));
        let along = moved.by_unknown.iter().map(|(unknown, by_one)| (*unknown, part(by_one)));
        let free = along.filter(|along| along.1 != 0.0 && along.1.abs() >= rounding).collect();
        Along { free, prescribed: part(&moved.offset) }
    }

    /// A linear form in the unknowns; at a node with a coefficient it counts the coefficient.
    #[doc(hidden)]
    pub fn through(&self, form: &LinearForm, dimension: usize) -> Along {
        let mut sum = Along::default();
        for (node, vector) in &form.terms {
            let along = self.along(*node, &vector[..dimension]);
            sum.free.extend(along.free);
            sum.prescribed += along.prescribed;
        }
        sum
    }

    /// The nodal dof of each free dof, increasing: entry i is the index, from 0, among the `dim * n_nodes` nodal dofs.
    pub fn free(&self) -> &[usize] {
        &self.free
    }

    /// The number of nodal dof `dof` among the free dofs, from 0; `None` if it is supported, or follows motions.
    #[inline]
    pub fn number(&self, dof: usize) -> Option<usize> {
        self.number.get(dof).copied().filter(|&number| number < FOLLOWING)
    }

    /// The displacement of nodal dof `dof`, in length, if it is supported.
    pub fn prescribed(&self, dof: usize) -> Option<f64> {
        self.prescribed.get(dof).copied().filter(|_| self.is_supported(dof))
    }

    /// Returns `true` if a support prescribes nodal dof `dof`.
    pub fn is_supported(&self, dof: usize) -> bool {
        self.number.get(dof) == Some(&SUPPORTED)
    }

    /// Returns `true` if something is prescribed that is not zero: a displacement of a support or of followers.
    pub fn is_moved(&self) -> bool {
        self.prescribed.iter().any(|&value| value != 0.0) || self.moved.values().any(|moved| moved.offset != [0.0; 3])
    }

    /// Nodal displacements, length `dim * n_nodes`, in length, from the unknowns (`free`, one entry each, in length);
    /// supported dofs take their prescribed values.
    pub fn expand(&self, free: &[f64]) -> Result<Vec<f64>, Error> {
        self.expand_with(free, 1.0)
    }

    /// A nodal motion, length `dim * n_nodes`, from that of the unknowns (`free`, one entry each), both in length, or
    /// in length over time; supported dofs stay at zero.
    pub fn expand_motion(&self, free: &[f64]) -> Result<Vec<f64>, Error> {
        self.expand_with(free, 0.0)
    }

    /// As [`expand`](Self::expand), with this share of what is prescribed.
    fn expand_with(&self, free: &[f64], share: f64) -> Result<Vec<f64>, Error> {
        linear::Error::check_length("displacement", free.len(), self.count(), "unknowns")?;
        let value = |(&number, prescribed): (&usize, &f64)| free.get(number).copied().unwrap_or(share * prescribed);
        let mut nodal: Vec<f64> = self.number.iter().zip(&self.prescribed).map(value).collect();
        for (node, moved) in &self.moved {
            let offset = moved.offset.map(|part| share * part);
            let sum = moved.by_unknown.iter().fold(offset, |sum, &(unknown, by)| shifted(sum, free[unknown], by));
            nodal[self.dimension * node..].iter_mut().zip(sum).take(self.dimension).for_each(|(at, part)| *at = part);
        }
        self.basis.evaluate(&mut nodal, self.dimension);
        Ok(nodal)
    }

    /// The forces along the unknowns of nodal forces (`nodal`, length `dim * n_nodes`, in force): one entry for each,
    /// in force.
    pub fn restrict(&self, nodal: &[f64]) -> Result<Vec<f64>, Error> {
        let forces = self.on_coefficients(nodal)?;
        let mut along: Vec<f64> = self.free.iter().map(|&dof| forces[dof]).collect();
        along.resize(self.count(), 0.0);
        for (node, moved) in &self.moved {
            let force = &forces[self.dimension * node..self.dimension * (node + 1)];
            let is_own = |unknown: usize| unknown < self.free.len();
            for (unknown, by_one) in &moved.by_unknown {
                let work: f64 = force.iter().zip(by_one).map(|(force, part)| force * part).sum();
                along[*unknown] = if is_own(*unknown) { work } else { along[*unknown] + work };
            }
        }
        Ok(along)
    }

    /// The part of nodal forces (`nodal`, length `dim * n_nodes`, in force) along the supported dofs, of the same
    /// length: the reactions among the forces on all nodes.
    pub fn supported_part(&self, nodal: &[f64]) -> Result<Vec<f64>, Error> {
        self.part(nodal, |dof| self.is_supported(dof))
    }

    /// The part of nodal forces along some of the dofs.
    #[doc(hidden)]
    pub fn part(&self, nodal: &[f64], keeps: impl Fn(usize) -> bool) -> Result<Vec<f64>, Error> {
        let mut part = self.on_coefficients(nodal)?.into_owned();
        let of_node = |node: usize| self.dimension * node..self.dimension * (node + 1);
        self.frames.iter().for_each(|(&node, frame)| frame.turn_in(&mut part[of_node(node)]));
        part.iter_mut().enumerate().filter(|(dof, _)| !keeps(*dof)).for_each(|(_, value)| *value = 0.0);
        self.frames.iter().for_each(|(&node, frame)| frame.turn_back(&mut part[of_node(node)]));
        self.basis.scatter(&mut part, self.dimension);
        Ok(part)
    }

    /// Nodal forces as forces on coefficients.
    fn on_coefficients<'a>(&self, nodal: &'a [f64]) -> Result<Cow<'a, [f64]>, Error> {
        linear::Error::check_length("nodal vector", nodal.len(), self.nodal_count(), "nodal dofs")?;
        let mut forces = Cow::Borrowed(nodal);
        if !self.basis.is_nodal() {
            self.basis.gather(forces.to_mut(), self.dimension);
        }
        Ok(forces)
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
    fn turn_in(&self, entries: &mut [f64]) {
        let local = self.axes.map(|axis| entries.iter().zip(axis).map(|(entry, part)| entry * part).sum());
        entries.iter_mut().zip(local).for_each(|(entry, value): (_, f64)| *entry = value);
    }

    /// Turns the entries of a node from the axes of the frame back to the coordinate axes.
    fn turn_back(&self, entries: &mut [f64]) {
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

/// How many rigid-body modes a body has, and the displacement [x, y, z] of a place by one of them: the translations,
/// then the rotations about the centre of the mesh, divided by half its size so that all are dimensionless and of order
/// one.
///
/// A body of revolution is treated as its half plane: the distance from the axis is ignored.
pub fn rigid_motions(body: &ElasticBody) -> (usize, impl Fn(usize, [f64; 3]) -> [f64; 3]) {
    let ((least, most), size, dimension) = (body.mesh().extent(), body.mesh().size(), body.dimension());
    let axes: &[usize] = match dimension {
        1 => &[],
        2 => &[2],
        _ => &[0, 1, 2],
    };
    let motion = move |mode: usize, place: [f64; 3]| match mode.checked_sub(dimension) {
        None => COORDINATES[mode],
        Some(turn) => cross(COORDINATES[axes[turn]], [0, 1, 2].map(|i| (2.0 * place[i] - least[i] - most[i]) / size)),
    };
    (dimension + axes.len(), motion)
}

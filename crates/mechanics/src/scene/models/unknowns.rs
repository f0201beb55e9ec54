//! The unknowns of a contact problem: the free dofs except those of rigid faces, the motions of rigid faces, and the
//! travels of obstacles that a force presses.
//!
//! The nodes of a rigid face follow its motions: u = R y + u_0 with the displacement u of the free dofs and the
//! unknowns y, so that the stiffness is R' K R and the load R' (f - K u_0).
//!
//! A pressed obstacle, and one with a mass in a motion, moves along its approach direction `a` alone, by the travel `d`
//! against it: one more unknown without stiffness, with the force F as its load. Each of its rows holds
//! `n . u + (n . a) d <= gap`, so that the forces of its rows along `a` add up to F.

use std::borrow::Cow;

use signorini_qp as qp;

use super::rigid_face::RigidFace;
use crate::error::Error;
use crate::fem::assembly::{Along, DofMap};
use crate::fem::body::ElasticBody;
use crate::fem::dense::DenseMatrix;
use crate::scene::input::obstacle::PlacedObstacle;
use signorini_qp::{SparseMatrix, SymmetricMatrix, dot};

/// The meaning of the unknowns by their order.
#[derive(Clone, Debug)]
pub struct Unknowns {
    /// Number of free dofs.
    free: usize,
    on_faces: Option<FaceMotions>,
    /// The obstacles with a travel, in the order of their unknowns, which come last.
    pub pressed: Vec<usize>,
}

/// The quantity that an unknown of the problem stands for, and the place of the body that has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meaning {
    /// The displacement of a node along a unit vector, or the coefficient of a mid-side node.
    Node {
        /// Index of the moved node in the mesh, from 0.
        node: usize,
        /// The unit vector [x, y, z].
        direction: [f64; 3],
        /// The word for it in a table, as `displacement`.
        quantity: &'static str,
    },
    /// A motion of a rigid face.
    Face {
        /// Its number among the rigid faces of the scene, from 0.
        face: usize,
        /// As `rotation.z`; a rotation is measured in `unit` radians.
        motion: &'static str,
        /// In length, or in radians.
        unit: f64,
    },
    /// The travel of an obstacle that a force presses.
    Travel {
        /// Its number in the list of the scene, from 0.
        obstacle: usize,
    },
}

/// The map from the unknowns to the free dofs: u = R y + u_0.
#[derive(Clone, Debug)]
struct FaceMotions {
    /// Columns of the transpose of R: the row of R of each free dof.
    rows: SparseMatrix,
    /// u_0, for each free dof.
    offset: Vec<f64>,
    /// The force or the moment along each unknown; zero except on faces.
    load: Vec<f64>,
    /// The unknowns of each face, by its motions; `None` if one is prescribed.
    unknowns: Vec<Vec<Option<usize>>>,
}

impl Unknowns {
    /// The unknowns of a body with `dofs`, rigid faces and obstacles.
    pub fn of(
        body: &ElasticBody,
        dofs: &DofMap,
        faces: &[RigidFace],
        obstacles: &[PlacedObstacle],
    ) -> Result<Self, Error> {
        let (nodes, dimension) = (body.mesh().nodes(), body.dimension());
        let has_travel = |index: &usize| obstacles[*index].has_travel();
        let on_faces = if faces.is_empty() { None } else { Some(FaceMotions::of(nodes, dofs, dimension, faces)?) };
        let pressed = (0..obstacles.len()).filter(has_travel).collect();
        Ok(Unknowns { free: dofs.free().len(), on_faces, pressed })
    }

    fn of_body(&self) -> usize {
        self.on_faces.as_ref().map_or(self.free, |on_faces| on_faces.rows.rows())
    }

    /// Number of unknowns of the model: those of the body, and the travels of pressed obstacles.
    pub fn count(&self) -> usize {
        self.of_body() + self.pressed.len()
    }

    /// The unknown that is the travel of an obstacle; `None` for an obstacle at rest.
    pub fn travel(&self, obstacle: usize) -> Option<usize> {
        self.pressed.iter().position(|&pressed| pressed == obstacle).map(|place| self.of_body() + place)
    }

    /// The values of the motions of a rigid face that are unknowns, among values of the unknowns; `None` if one is
    /// prescribed.
    pub fn motions(&self, values: &[f64], face: usize) -> Vec<Option<f64>> {
        let unknowns = self.on_faces.as_ref().and_then(|on_faces| on_faces.unknowns.get(face));
        unknowns.into_iter().flatten().map(|unknown| unknown.and_then(|unknown| values.get(unknown).copied())).collect()
    }

    /// The displacement of the free dofs at values of the unknowns.
    pub fn displacement<'a>(&self, values: &'a [f64]) -> Result<Cow<'a, [f64]>, Error> {
        let mut moved = self.motion(values)?;
        if let Some(on_faces) = &self.on_faces {
            moved.to_mut().iter_mut().zip(&on_faces.offset).for_each(|(moved, offset)| *moved += offset);
        }
        Ok(moved)
    }

    /// The motion of the free dofs in one of the unknowns.
    pub fn motion<'a>(&self, values: &'a [f64]) -> Result<Cow<'a, [f64]>, Error> {
        qp::LinearError::check_length("displacement", values.len(), self.count(), "unknowns")?;
        let of_body = &values[..self.of_body()];
        Ok(self
            .on_faces
            .as_ref()
            .map_or(Cow::Borrowed(of_body), |on_faces| Cow::Owned(on_faces.rows.mul_transposed(of_body))))
    }

    /// The unknowns of a displacement of the free dofs, next to it on rigid faces, with a value for each obstacle with
    /// a travel.
    pub fn of_displacement(&self, mut of_free: Vec<f64>, of_travel: impl Fn(usize) -> f64) -> Vec<f64> {
        if let Some(on_faces) = &self.on_faces {
            of_free.iter_mut().zip(&on_faces.offset).for_each(|(of_free, offset)| *of_free -= offset);
        }
        self.of_motion(of_free, of_travel)
    }

    /// The unknowns of a motion of the free dofs in which the faces move rigidly, with a value for each obstacle with a
    /// travel.
    pub fn of_motion(&self, of_free: Vec<f64>, of_travel: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut values = match &self.on_faces {
            Some(on_faces) => on_faces.nearest(&of_free),
            None => of_free,
        };
        values.extend(self.pressed.iter().map(|&obstacle| of_travel(obstacle)));
        values
    }

    /// The load of the unknowns: from that of the free dofs, their stiffness, and the force on each pressed obstacle.
    pub fn load(&self, of_free: Vec<f64>, stiffness: &SymmetricMatrix, force: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut load = match &self.on_faces {
            Some(on_faces) => {
                let lifted = stiffness.mul(&on_faces.offset);
                let left: Vec<f64> = of_free.iter().zip(lifted).map(|(load, lifted)| load - lifted).collect();
                on_faces.rows.mul(&left).into_iter().zip(&on_faces.load).map(|(sum, own)| sum + own).collect()
            }
            None => of_free,
        };
        load.extend(self.pressed.iter().map(|&obstacle| force(obstacle)));
        load
    }

    /// The forces along the unknowns of forces along the free dofs, alone; none along travels.
    pub fn force(&self, of_free: Vec<f64>) -> Vec<f64> {
        let mut force = match &self.on_faces {
            Some(on_faces) => on_faces.rows.mul(&of_free),
            None => of_free,
        };
        force.resize(self.count(), 0.0);
        force
    }

    /// The same load with other forces on the pressed obstacles.
    pub fn pressed_by(&self, mut load: Vec<f64>, force: impl Fn(usize) -> f64) -> Vec<f64> {
        load.truncate(self.of_body());
        load.extend(self.pressed.iter().map(|&obstacle| force(obstacle)));
        load
    }

    /// The stiffness or the mass `R'A R` of the unknowns from that of the free dofs: travels have none.
    pub fn congruent(&self, of_free: SymmetricMatrix) -> Result<SymmetricMatrix, Error> {
        Ok(match &self.on_faces {
            Some(on_faces) => of_free.congruent(&on_faces.rows)?.with_empty(self.pressed.len()),
            None => of_free.with_empty(self.pressed.len()),
        })
    }

    pub fn has_faces(&self) -> bool {
        self.on_faces.is_some()
    }

    /// The displacement of a node along a vector, or its coefficient, in the unknowns, and its prescribed part.
    pub fn along(&self, dofs: &DofMap, node: usize, vector: &[f64]) -> (Vec<(usize, f64)>, f64) {
        let Along { free, prescribed } = dofs.along(node, vector);
        let Some(on_faces) = &self.on_faces else { return (free, prescribed) };
        let entries = free.iter().flat_map(|&(dof, part)| on_faces.rows.column(dof).map(move |(q, r)| (q, part * r)));
        (entries.collect(), free.iter().fold(prescribed, |sum, &(dof, part)| sum + part * on_faces.offset[dof]))
    }

    /// The meaning of each unknown.
    pub fn meanings<'a>(
        &'a self,
        dofs: &'a DofMap,
        dimension: usize,
        faces: &'a [RigidFace],
    ) -> impl Iterator<Item = Meaning> + 'a {
        let of_node = move |dof: usize| {
            let (node, axis) = (dof / dimension, dof % dimension);
            let quantity = if dofs.basis.ends(node).is_some() { "coefficient" } else { "displacement" };
            Meaning::Node { node, direction: dofs.axes(node)[axis], quantity }
        };
        let tied: std::collections::HashSet<usize> = faces.iter().flat_map(|face| face.nodes.iter().copied()).collect();
        let own = dofs.free().iter().filter(move |&dof| !tied.contains(&(dof / dimension)));
        let of_faces = faces.iter().enumerate().flat_map(|(index, face)| {
            let free = face.motions.iter().filter(|motion| motion.prescribed.is_none());
            free.map(move |motion| Meaning::Face { face: index, motion: motion.name(), unit: face.unit(motion) })
        });
        let travels = self.pressed.iter().map(|&obstacle| Meaning::Travel { obstacle });
        own.map(move |&dof| of_node(dof)).chain(of_faces).chain(travels)
    }

    /// The stiffness of the unknowns with a spring on each pressed obstacle, as stiff as the stiffest dof.
    pub fn on_springs(&self, stiffness: &SymmetricMatrix) -> Result<SymmetricMatrix, Error> {
        let spring = stiffness.diagonal().into_iter().fold(0.0, f64::max);
        self.with_travels(stiffness, |_| spring)
    }

    /// A matrix of the unknowns with a diagonal entry for the travel of each obstacle.
    pub fn with_travels(
        &self,
        matrix: &SymmetricMatrix,
        of_obstacle: impl Fn(usize) -> f64,
    ) -> Result<SymmetricMatrix, Error> {
        if self.pressed.is_empty() {
            return Ok(matrix.clone());
        }
        let own =
            (self.of_body()..).zip(&self.pressed).map(|(unknown, &obstacle)| (unknown, unknown, of_obstacle(obstacle)));
        let entries: Vec<_> = matrix.lower().triplets().chain(own).collect();
        Ok(SymmetricMatrix::from_lower(SparseMatrix::from_triplets(self.count(), self.count(), &entries)?)?)
    }
}

impl FaceMotions {
    fn of(nodes: &[[f64; 3]], dofs: &DofMap, dimension: usize, faces: &[RigidFace]) -> Result<Self, Error> {
        let mut face_of = vec![None; nodes.len()];
        for (index, face) in faces.iter().enumerate() {
            face.nodes.iter().for_each(|&node| face_of[node] = Some(index));
        }
        let own = dofs.free().iter().filter(|&&dof| face_of[dof / dimension].is_none()).count();
        let (mut unknowns, mut load) = (Vec::with_capacity(faces.len()), vec![0.0; own]);
        for face in faces {
            let of_motion = |motion: &super::rigid_face::Motion| {
                motion.prescribed.is_none().then(|| {
                    load.push(motion.force * face.unit(motion));
                    load.len() - 1
                })
            };
            unknowns.push(face.motions.iter().map(of_motion).collect::<Vec<_>>());
        }
        let (mut entries, mut offset, mut next) = (Vec::new(), vec![0.0; dofs.free().len()], 0);
        for (number, &dof) in dofs.free().iter().enumerate() {
            let (node, axis) = (dof / dimension, dof % dimension);
            let Some(index) = face_of[node] else {
                entries.push((next, number, 1.0));
                next += 1;
                continue;
            };
            let (face, at) = (&faces[index], dofs.basis.place(nodes, node));
            offset[number] = face.prescribed(at)[axis];
            for (motion, unknown) in face.motions.iter().zip(&unknowns[index]) {
                let Some(unknown) = unknown else { continue };
                let by_one = face.displacement(motion, at)[axis] * face.unit(motion);
                if by_one != 0.0 {
                    entries.push((*unknown, number, by_one));
                }
            }
        }
        let rows = SparseMatrix::from_triplets(load.len(), dofs.free().len(), &entries)?;
        Ok(FaceMotions { rows, offset, load, unknowns })
    }

    /// The unknowns next to a motion of the free dofs: those of the faces by least squares.
    fn nearest(&self, of_free: &[f64]) -> Vec<f64> {
        let by_unknown = self.rows.transposed();
        let mut values = vec![0.0; self.rows.rows()];
        let of_faces: Vec<usize> = self.unknowns.iter().flatten().flatten().copied().collect();
        let first = of_faces.first().copied().unwrap_or(values.len());
        for (unknown, value) in values.iter_mut().enumerate().take(first) {
            *value = by_unknown.column(unknown).map(|(dof, share)| share * of_free[dof]).sum();
        }
        for face in &self.unknowns {
            let unknowns: Vec<usize> = face.iter().flatten().copied().collect();
            if unknowns.is_empty() {
                continue;
            }
            // The normal equations of a face: its motions are independent.
            let column = |unknown: usize| {
                let mut column = vec![0.0; of_free.len()];
                by_unknown.column(unknown).for_each(|(dof, share)| column[dof] = share);
                column
            };
            let columns: Vec<Vec<f64>> = unknowns.iter().map(|&unknown| column(unknown)).collect();
            let matrix = DenseMatrix::from_fn(columns.len(), columns.len(), |i, j| dot(&columns[i], &columns[j]));
            let right: Vec<f64> = columns.iter().map(|column| dot(column, of_free)).collect();
            let found = matrix.singular_values().solve(&right, 1e-12);
            unknowns.iter().zip(found).for_each(|(&unknown, value)| values[unknown] = value);
        }
        values
    }
}

//! PETSc's binary files: the form in which a body too large for one machine goes to a cluster and comes back.
//!
//! A problem directory holds `K.petsc` (D n x D n, both triangles, D dofs for each of n nodes), `K.petsc.info`,
//! `f.petsc`, `coordinates.petsc`, `B.petsc`, `g.petsc`, `free.petsc`; `E.petsc` and `e.petsc` with equality rows, and
//! `near_null.petsc` if displacements of almost no energy are known. `free.petsc` is the place in 0..D n of each free
//! dof: `u.mtx` has their order. All other components are supported.
//!
//! Numbers are big-endian: integers of 32 bits, reals of 64. A file begins with the class of its object.
//!
//! | class | what follows |
//! |---|---|
//! | 1211216, Mat | rows, columns, entries; the length of each row; the column of each entry; its value |
//! | 1211216, Mat, with -1 for the entries | all values, row by row |
//! | 1211214, Vec | length; values |
//! | 1211218, IS | length; indices |
//!
//! # Source
//! PETSc Users Manual, `MatLoad()` and `VecLoad()`: the binary formats (petsc.org).

mod directory;
mod source;

pub use directory::read_problem;

use std::io::{self, Write};

use crate::linear::file::Streamed;
use crate::linear::{SparseMatrix, SymmetricMatrix};
use crate::problem::ContactProblem;

/// The file that makes a directory one of PETSc's files.
pub const STIFFNESS: &str = "K.petsc";

/// Options that PETSc reads with the matrix.
const INFO: &str = "K.petsc.info";

/// The option with the number of dofs of a node.
const BLOCK_SIZE: &str = "-matload_block_size";

const LOAD: &str = "f.petsc";
const CONTACT: &str = "B.petsc";
const GAP: &str = "g.petsc";
const EQUALITIES: &str = "E.petsc";
const VALUES: &str = "e.petsc";
const FREE: &str = "free.petsc";
const COORDINATES: &str = "coordinates.petsc";
const NEAR_NULL: &str = "near_null.petsc";

/// The class of the object in a file: the number that the file begins with, and its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Class {
    number: i32,
    words: &'static str,
}

const MATRIX: Class = Class { number: 1_211_216, words: "a matrix (Mat)" };
const VECTOR: Class = Class { number: 1_211_214, words: "a vector (Vec)" };
const INDICES: Class = Class { number: 1_211_218, words: "an index set (IS)" };

/// Takes the place of the number of entries of a matrix that is stored with all entries.
const DENSE: i32 = -1;

/// Takes the place of a number of entries that 32 bits do not hold: it is the sum of the lengths of the rows.
const TOO_MANY: i32 = i32::MAX;

/// The nodes that have a free dof, in their order, with a place for each of their components.
#[derive(Clone, Debug, PartialEq)]
pub struct PetscLayout {
    /// Components of a node.
    pub size: usize,
    /// The place `size * node + component` of each free dof, increasing.
    pub place: Vec<u32>,
    /// Coordinates of the nodes in length, `size` each.
    pub coordinates: Vec<f64>,
}

impl PetscLayout {
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
        PetscLayout { size, place, coordinates }
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

pub fn streamed_files<'a>(problem: &'a ContactProblem, layout: &'a PetscLayout) -> Vec<Streamed<'a>> {
    let (stiffness, place) = (problem.stiffness(), &layout.place);
    let (contact, gap) = problem.inequalities_given();
    let contact = contact.transposed();
    let mut files = vec![
        Streamed::new(STIFFNESS, |out| write_stiffness(out, stiffness, layout)),
        Streamed::new(INFO, |out| writeln!(out, "{BLOCK_SIZE} {}", layout.size)),
        Streamed::new(LOAD, |out| {
            write_header(out, VECTOR, &[layout.places()])?;
            write_at_places(out, &[problem.load()], layout)
        }),
        Streamed::new(CONTACT, move |out| write_rows_of(out, &contact, layout)),
        Streamed::new(GAP, move |out| write_vector(out, gap)),
        Streamed::new(COORDINATES, |out| write_vector(out, &layout.coordinates)),
        Streamed::new(FREE, |out| {
            write_header(out, INDICES, &[place.len()])?;
            place.iter().try_for_each(|place| out.write_all(&place.to_be_bytes()))
        }),
    ];
    if problem.equality_rows() > 0 {
        let (rows, values) = problem.equalities_given();
        let rows = rows.transposed();
        files.push(Streamed::new(EQUALITIES, move |out| write_rows_of(out, &rows, layout)));
        files.push(Streamed::new(VALUES, move |out| write_vector(out, &values)));
    }
    files.extend(problem.near_null().map(|modes| {
        Streamed::new(NEAR_NULL, |out| {
            write_header(out, MATRIX, &[layout.places(), modes.count()])?;
            out.write_all(&DENSE.to_be_bytes())?;
            write_at_places(out, modes.vectors(), layout)
        })
    }));
    files
}

fn write_header(out: &mut dyn Write, class: Class, sizes: &[usize]) -> io::Result<()> {
    out.write_all(&class.number.to_be_bytes())?;
    sizes.iter().try_for_each(|&size| out.write_all(&integer(size)?.to_be_bytes()))
}

/// A size as an integer of 32 bits.
fn integer(size: usize) -> io::Result<i32> {
    let too_large = |_| io::Error::new(io::ErrorKind::FileTooLarge, format!("{size} is no integer of 32 bits"));
    i32::try_from(size).map_err(too_large)
}

fn write_reals(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|value| out.write_all(&value.to_be_bytes()))
}

fn write_vector(out: &mut dyn Write, values: &[f64]) -> io::Result<()> {
    write_header(out, VECTOR, &[values.len()])?;
    write_reals(out, values)
}

/// The vectors as columns, with 0 at supported components.
fn write_at_places(out: &mut dyn Write, vectors: &[impl AsRef<[f64]>], layout: &PetscLayout) -> io::Result<()> {
    layout.each_place(|_, dof| {
        let value = |vector: &[f64]| dof.map_or(0.0, |dof| vector[dof]).to_be_bytes();
        vectors.iter().try_for_each(|vector| out.write_all(&value(vector.as_ref())))
    })
}

/// Contact or equality rows, each a column of `rows`.
fn write_rows_of(out: &mut dyn Write, rows: &SparseMatrix, layout: &PetscLayout) -> io::Result<()> {
    write_header(out, MATRIX, &[rows.columns(), layout.places(), rows.entries()])?;
    for column in rows.column_starts().windows(2) {
        out.write_all(&integer(column[1] - column[0])?.to_be_bytes())?;
    }
    rows.row_indices().try_for_each(|dof| out.write_all(&layout.place[dof as usize].to_be_bytes()))?;
    write_reals(out, rows.values())
}

/// The stiffness; a supported component has the mean size of the diagonal as its diagonal entry, and no other entry.
fn write_stiffness(out: &mut dyn Write, stiffness: &SymmetricMatrix, layout: &PetscLayout) -> io::Result<()> {
    let lengths = stiffness.row_lengths();
    let supported = layout.places() - stiffness.dim();
    let entries = lengths.iter().map(|&length| u64::from(length)).sum::<u64>() + supported as u64;
    write_header(out, MATRIX, &[layout.places(), layout.places()])?;
    out.write_all(&i32::try_from(entries).unwrap_or(TOO_MANY).to_be_bytes())?;
    layout.each_place(|_, dof| out.write_all(&dof.map_or(1, |dof| lengths[dof]).to_be_bytes()))?;
    drop(lengths);
    let place = &layout.place;
    let own = |place: usize| (place as u32).to_be_bytes();
    write_rows(out, stiffness, layout, own, |column, _| place[column as usize].to_be_bytes())?;
    let diagonal = stiffness.diagonal();
    let mean = diagonal.iter().map(|value| value.abs()).sum::<f64>() / diagonal.len().max(1) as f64;
    drop(diagonal);
    write_rows(out, stiffness, layout, |_| mean.to_be_bytes(), |_, value| value.to_be_bytes())
}

/// The `bytes` of each entry of the stiffness, row by row, and those of `own` if a component is supported.
fn write_rows<const COUNT: usize>(
    out: &mut dyn Write,
    stiffness: &SymmetricMatrix,
    layout: &PetscLayout,
    own: impl Fn(usize) -> [u8; COUNT],
    bytes: impl Fn(u32, f64) -> [u8; COUNT],
) -> io::Result<()> {
    let (mut row, mut place) = (Vec::new(), 0);
    let mut free = layout.place.iter().map(|&free| free as usize);
    let mut supported = |out: &mut dyn Write, end: usize| {
        let written = (place..end).try_for_each(|place| out.write_all(&own(place)));
        place = end + 1;
        written
    };
    stiffness.each_row(|columns, values| {
        supported(out, free.next().unwrap_or(layout.places()))?;
        row.clear();
        columns.iter().zip(values).for_each(|(&column, &value)| row.extend_from_slice(&bytes(column, value)));
        out.write_all(&row)
    })?;
    supported(out, layout.places())
}

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
mod write;

pub use directory::read_problem;
pub use write::{PetscLayout, streamed_files};

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

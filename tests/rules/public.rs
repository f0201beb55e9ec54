//! The public interface: types can be sent between threads and have a debug output, sets are collections, matrices are
//! made from compressed columns, an error carries the best answer.

use signorini::{
    Certificate, ContactProblem, ContactSet, Error, Goal, Method, Model, Path, Penalty, Prepared, ProvenSet, Scene,
    Settings, Solution, SparseMatrix, SymmetricMatrix, Watch, qp, solve,
};
use std::fmt::Debug;

use signorini::fem::{ElasticBody, Mesh};
use signorini::motion::{DynamicProblem, Integrator, Scheme, State};
use signorini::scene::Dynamics;
use signorini::study::ModelSize;

fn crosses_threads<T: Send + Sync + Debug>() {}

#[test]
fn public_types_can_be_sent_between_threads_and_debug_printed() {
    crosses_threads::<(ContactProblem, Solution, Certificate, ContactSet, ProvenSet, Goal)>();
    crosses_threads::<(Settings, Method, Watch, Error)>();
    crosses_threads::<(Prepared, Path)>();
    crosses_threads::<(SparseMatrix, SymmetricMatrix)>();
    crosses_threads::<(Scene, Model, Dynamics, Mesh, ElasticBody)>();
    crosses_threads::<(DynamicProblem, Integrator, Scheme, State)>();
}

#[test]
fn a_contact_set_is_collected_from_flags_and_iterates_over_closed_rows() {
    let flags: Vec<bool> = (0..130).map(|row| row % 3 == 0).collect();
    let set: ContactSet = flags.iter().copied().collect();
    assert_eq!((set.rows(), set.count()), (130, 44));
    assert_eq!(set, ContactSet::from_fn(130, |row| flags[row]));
    let mut closed = Vec::new();
    for row in &set {
        closed.push(row);
    }
    assert_eq!(closed, (0..130).step_by(3).collect::<Vec<_>>());
    assert_eq!(std::iter::empty::<bool>().collect::<ContactSet>(), ContactSet::open(0));
}

#[test]
fn compressed_columns_make_the_matrix_of_their_triplets_or_are_refused_with_the_fault() {
    let from_csc = |starts: &[usize], rows: &[usize], values: &[f64]| {
        SparseMatrix::from_csc(3, starts.to_vec(), rows.to_vec(), values.to_vec())
    };
    let expected = SparseMatrix::from_triplets(3, 2, &[(0, 0, 1.0), (2, 0, 2.0), (1, 1, 3.0)]).unwrap();
    assert_eq!(from_csc(&[0, 2, 3], &[0, 2, 1], &[1.0, 2.0, 3.0]).unwrap(), expected);
    assert_eq!(from_csc(&[0], &[], &[]).unwrap().columns(), 0);
    for (starts, rows, values, words) in [
        (&[0, 2, 3][..], &[0, 2][..], &[1.0, 2.0, 3.0][..], "row indices has length 2"),
        (&[], &[], &[], "begin with 0"),
        (&[1, 2, 3], &[0, 2, 1], &[1.0, 2.0, 3.0], "begin with 0"),
        (&[0, 2, 2], &[0, 2, 1], &[1.0, 2.0, 3.0], "end with the number of values, 3"),
        (&[0, 4, 3], &[0, 2, 1], &[1.0, 2.0, 3.0], "decrease after column 0"),
        (&[0, 2, 1, 3], &[0, 2, 1], &[1.0, 2.0, 3.0], "decrease after column 1"),
        (&[0, 2, 3], &[2, 0, 1], &[1.0, 2.0, 3.0], "row 0 of column 0 does not lie beyond row 2"),
        (&[0, 2, 3], &[1, 1, 1], &[1.0, 2.0, 3.0], "row 1 of column 0 does not lie beyond row 1"),
        (&[0, 2, 3], &[0, 3, 1], &[1.0, 2.0, 3.0], "entry (3, 0) lies outside"),
        (&[0, 2, 3], &[0, 2, 1], &[1.0, f64::NAN, 3.0], "NaN at (2, 0)"),
    ] {
        let error = from_csc(starts, rows, values).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

/// Columns and rows with 32-bit indices give the same matrix as `from_full` with the same entries. If the triangles
/// differ by rounding, the lower one counts, including entries without a counterpart.
#[test]
fn both_triangles_give_the_same_matrix_from_columns_and_from_rows() {
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1_u64 << 31) as f64
    };
    for dim in [1, 2, 5, 17] {
        for rounding in [0.0, 1e-13] {
            let mut entries = Vec::new();
            for row in 0..dim {
                entries.push((row, row, 4.0 + random()));
                for column in (0..row).filter(|_| random() < 0.4).collect::<Vec<_>>() {
                    let value = random() - 0.5;
                    entries.extend([(row, column, value), (column, row, value * (1.0 + rounding))]);
                }
                if rounding > 0.0 && row > 0 {
                    // An entry in one triangle only, of the size of rounding.
                    let place = if random() < 0.5 { (row, row - 1) } else { (row - 1, row) };
                    entries.push((place.0, place.1, rounding));
                }
            }
            let full = SparseMatrix::from_triplets(dim, dim, &entries).unwrap();
            let short = |indices: &[usize]| indices.iter().map(|&index| index as i32).collect::<Vec<_>>();
            let lower: Vec<_> = entries.iter().copied().filter(|entry| entry.0 >= entry.1).collect();
            let expected = SparseMatrix::from_triplets(dim, dim, &lower).unwrap();
            let by_columns =
                (short(full.column_starts()), full.row_indices().map(|row| row as i32).collect::<Vec<_>>());
            let of_columns = SymmetricMatrix::from_csc(&by_columns.0, &by_columns.1, full.values()).unwrap();
            let rows = full.transposed();
            let by_rows = (short(rows.column_starts()), rows.row_indices().map(|row| row as i32).collect::<Vec<_>>());
            let of_rows = SymmetricMatrix::from_csr(&by_rows.0, &by_rows.1, rows.values()).unwrap();
            let mut table = vec![0.0; dim * dim];
            full.triplets().for_each(|(row, column, value)| table[row * dim + column] = value);
            let of_table = SymmetricMatrix::from_table(dim, &table).unwrap();
            for of in [of_columns, of_rows, of_table, SymmetricMatrix::from_full(&full).unwrap()] {
                assert_eq!(of.lower(), &expected, "{dim} {rounding}");
            }
        }
    }
}

#[test]
fn triangles_that_do_not_form_a_symmetric_matrix_are_refused_with_the_fault() {
    let (starts, rows) = ([0_i32, 2, 4], [0_i32, 1, 0, 1]);
    for (starts, rows, values, by_columns, by_rows) in [
        (
            &starts,
            &rows,
            [2.0, -1.0, 1.0, 3.0],
            "(1, 0) is -1e0, entry (0, 1) is 1e0",
            "(1, 0) is 1e0, entry (0, 1) is -1e0",
        ),
        (&starts, &rows, [2.0, f64::NAN, -1.0, 3.0], "NaN at (1, 0)", "NaN at (0, 1)"),
        (&starts, &[0, 9, 0, 1], [2.0, -1.0, -1.0, 3.0], "entry (9, 0) lies outside", "entry (0, 9) lies outside"),
        (
            &starts,
            &[0, -1, 0, 1],
            [2.0, -1.0, -1.0, 3.0],
            "a row of column 0 is negative",
            "a column of row 0 is negative",
        ),
        (
            &starts,
            &[1, 0, 0, 1],
            [2.0, -1.0, -1.0, 3.0],
            "row 0 of column 0 does not lie",
            "column 0 of row 0 does not lie",
        ),
        (&[0, 5, 4], &rows, [2.0, -1.0, -1.0, 3.0], "decrease after column 0", "decrease after column 0"),
        (&[0, -2, 4], &rows, [2.0, -1.0, -1.0, 3.0], "start of column 1 is no index", "start of column 1 is no index"),
        (
            &[0, 2, 3],
            &rows,
            [2.0, -1.0, -1.0, 3.0],
            "end with the number of values, 4",
            "end with the number of values, 4",
        ),
    ] {
        let of_columns = SymmetricMatrix::from_csc(starts, rows, &values).unwrap_err().to_string();
        let of_rows = SymmetricMatrix::from_csr(starts, rows, &values).unwrap_err().to_string();
        assert!(of_columns.contains(by_columns), "{of_columns}");
        assert!(of_rows.contains(by_rows), "{of_rows}");
    }
    let none: [i32; 0] = [];
    assert!(
        SymmetricMatrix::from_csc(&starts, &none, &[1.0]).unwrap_err().to_string().contains("row indices has length 0")
    );
}

/// An objective without curvature, such as that of a linear program, has fewer entries than dofs.
#[test]
fn entries_of_both_triangles_are_counted_if_diagonal_entries_are_missing() {
    for (entries, count) in [(vec![], 0), (vec![(1, 1, 2.0)], 1), (vec![(0, 0, 1.0), (2, 0, 0.5), (2, 2, 1.0)], 4)] {
        let lower = SparseMatrix::from_triplets(3, 3, &entries).unwrap();
        let stiffness = SymmetricMatrix::from_lower(lower).unwrap();
        assert_eq!(stiffness.entries(), count);
        let no_rows = SparseMatrix::from_triplets(0, 3, &[]).unwrap();
        let problem = ContactProblem::new(stiffness, vec![0.0; 3], no_rows, vec![]).unwrap();
        assert_eq!(ModelSize::of(&problem).stiffness_entries, count);
    }
}

#[test]
fn an_error_returns_the_answer_that_it_carries() {
    let stiffness = SymmetricMatrix::from_lower(SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)]).unwrap()).unwrap();
    let contact = SparseMatrix::from_triplets(1, 1, &[(0, 0, 1.0)]).unwrap();
    let problem = ContactProblem::new(stiffness, vec![2.0], contact, vec![0.5]).unwrap();
    let settings = Settings::with_method(Method::Penalty(Penalty { last: 1.0, ..Penalty::default() }));
    // A penalty spring of stiffness 1 in parallel with the body of stiffness 1: u = (2 + 0.5)/2.
    let best = solve(&problem, &settings).unwrap_err().into_best().unwrap();
    assert!((best.displacement[0] - 1.25).abs() < 1e-15, "{:?}", best.displacement);
    assert!(qp::Error::Interrupted.into_best().is_none());
}

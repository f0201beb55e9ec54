"""Arrays of every type and format give the same problem."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import signorini as sg
from bodies import bar, membrane, two_springs
from scipy import sparse

FORMATS = ["csc", "csr", "coo", "bsr", "dia", "lil", "dok"]


@pytest.mark.parametrize("kind", [sparse.csc_matrix, sparse.csc_array])
@pytest.mark.parametrize("form", FORMATS)
def test_every_format_of_scipy_gives_the_same_bits(form: str, kind: type) -> None:
    K, f, B, g = membrane(9)
    expected = sg.solve(sg.Problem(K, f, B, g), proof=False)
    given = [kind(matrix).asformat(form) for matrix in (K, B)]
    answer = sg.solve(sg.Problem(given[0], f, given[1], g), proof=False)
    assert np.array_equal(answer.u, expected.u) and np.array_equal(answer.multiplier, expected.multiplier)


@pytest.mark.parametrize("dtype", [np.int64, np.int32, np.uint16, ">i4", ">i8"])
def test_indices_of_both_widths_give_the_same_matrix(dtype: object) -> None:
    K, f, B, g = membrane(5)
    for matrix in (K, B):
        matrix.indices, matrix.indptr = matrix.indices.astype(dtype), matrix.indptr.astype(dtype)
    problem = sg.Problem(K, f, B, g)
    assert abs(problem.K - K).max() == 0.0 and abs(problem.B - B).max() == 0.0


def test_unsorted_duplicate_and_dense_entries_add_up() -> None:
    K, f, B, g = membrane(4)
    unsorted = sparse.csr_matrix(K)
    for row in range(K.shape[0]):
        part = slice(unsorted.indptr[row], unsorted.indptr[row + 1])
        unsorted.indices[part], unsorted.data[part] = unsorted.indices[part][::-1].copy(), unsorted.data[part][::-1].copy()
    entries = sparse.coo_matrix(K)
    halves = [np.concatenate([array, array]) for array in (entries.row, entries.col)]
    doubled = sparse.coo_matrix((np.concatenate([entries.data / 2, entries.data / 2]), halves), shape=K.shape)
    for given in (unsorted, doubled, K.toarray(), np.asfortranarray(K.toarray()), K.astype(np.float32), K.toarray().astype(int)):
        assert abs(sg.Problem(given, f, B, g).K - K).max() == 0.0


def test_every_format_takes_the_lower_triangle_if_the_triangles_differ_by_rounding() -> None:
    K = np.array([[2.0, -1.0], [-1.0 * (1 + 1e-13), 2.0]])
    for given in (K, sparse.csc_matrix(K), sparse.csr_matrix(K), sparse.coo_matrix(K)):
        assert sg.Problem(given, [0.0, 0.0]).K.toarray()[0, 1] == -1.0 * (1 + 1e-13)
    one_sided = np.array([[2.0, 0.0], [1e-14, 2.0]])
    for matrix, kept in ((one_sided, 1e-14), (one_sided.T, 0.0)):
        for given in (matrix, sparse.csc_matrix(matrix), sparse.csr_matrix(matrix), sparse.coo_matrix(matrix)):
            assert sg.Problem(given, [0.0, 0.0]).K.toarray()[1, 0] == kept


def test_vectors_of_every_type_give_the_same_load() -> None:
    K, f, B, g = bar(4)
    strided = np.zeros(8)
    strided[::2] = f
    frozen = f.copy()
    frozen.flags.writeable = False
    swapped = f.astype(">f8")
    unaligned = np.frombuffer(b"-" + f.tobytes(), dtype=np.uint8)[1:].view(np.float64)
    for load in (f, f.tolist(), tuple(f), f.astype(np.float32), f.astype(int), strided[::2], frozen, swapped, unaligned):
        assert np.array_equal(sg.Problem(K, load, B, g).f, f)


def test_tables_of_every_type_give_the_same_matrices() -> None:
    class Derived(np.ndarray):
        """An array that is no plain one."""

    def forms(table: np.ndarray) -> list[object]:
        strided = np.zeros((2 * table.shape[0], 2 * table.shape[1]))
        strided[::2, ::2] = table
        frozen = table.copy()
        frozen.flags.writeable = False
        unaligned = np.frombuffer(b"-" + table.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(table.shape)
        kinds = [table, table.tolist(), table.astype(np.float32), table.astype(">f8"), np.asfortranarray(table)]
        return [*kinds, strided[::2, ::2], frozen, unaligned, table.view(Derived)]

    K, f, B, g = bar(4)
    for table, rows in zip(forms(K.toarray()), forms(B.toarray()), strict=True):
        problem = sg.Problem(table, f, rows, g)
        assert abs(problem.K - K).max() == 0.0 and abs(problem.B - B).max() == 0.0
    assert sg.Problem(np.zeros((0, 0)), [], np.zeros((0, 0)), []).dofs == 0


def test_an_object_with_to_scipy_is_accepted_as_a_matrix() -> None:
    class Assembled:
        def __init__(self, matrix: sparse.csr_matrix) -> None:
            self.matrix = matrix

        def to_scipy(self) -> sparse.csr_matrix:
            return self.matrix

    K, f, B, g = membrane(4)
    assert abs(sg.Problem(Assembled(K.tocsr()), f, Assembled(B.tocsr()), g).K - K).max() == 0.0


def test_a_problem_returns_its_data_and_can_be_pickled() -> None:
    K, f, B, g = membrane(5)
    modes = np.ones((len(f), 1))
    problem = sg.Problem(K, f, B, g, near_null=modes)
    again = pickle.loads(pickle.dumps(problem))
    for of in (problem, again):
        assert (of.dofs, of.row_count) == (16, 16)
        assert abs(of.K - K).max() == 0.0 and abs(of.B - B).max() == 0.0
        assert np.array_equal(of.f, f) and np.array_equal(of.g, g) and np.array_equal(of.near_null, modes)
    assert sg.Problem(K, f).near_null is None


def test_coordinates_make_the_rigid_body_modes() -> None:
    nodes = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    modes = sg.Problem(np.eye(6), np.zeros(6), coordinates=nodes).near_null
    assert modes is not None and modes.shape == (6, 3)
    rotation = modes[:, 2].reshape(3, 2)
    away = nodes - nodes.mean(axis=0)
    assert np.allclose(rotation, np.stack([-away[:, 1], away[:, 0]], axis=1))


def test_replace_changes_only_load_and_gap() -> None:
    problem = two_springs().replace(f=[0.0, 5.0], g=[2.0])
    answer = sg.solve(problem)
    assert np.allclose(answer.u, [2 / 3, 2.0], rtol=1e-15) and np.allclose(answer.multiplier, [2 - 2 / 3 - 5], rtol=1e-14)


def test_a_body_without_rows_is_solved() -> None:
    answer = sg.solve(sg.Problem(np.array([[2.0]]), [3.0]))
    assert answer.u.tolist() == [1.5] and answer.multiplier.shape == (0,) and answer.energy_error_bound < 1e-9


def test_equality_rows_hold_two_nodes_together_and_the_multiplier_balances_them() -> None:
    K, f, B, g = membrane(6)
    E = np.zeros((2, K.shape[0]))
    E[0, 3], E[0, 20] = 1.0, -1.0
    E[1] = 2.0 * E[0]
    problem = sg.Problem(K, f, B, g, E=sparse.csr_array(E), e=[0.0, 0.0])
    assert (problem.equality_count, problem.row_count) == (2, B.shape[0])
    answer = sg.solve(problem)
    assert abs(answer.u[3] - answer.u[20]) < 1e-12
    left = K @ answer.u - f - B.T @ answer.multiplier - E.T @ answer.equality_multiplier
    assert np.abs(left).max() < 1e-12 * np.abs(f).max() and np.abs(E.T @ answer.equality_multiplier).max() > 1e-3 * np.abs(f).max()
    again = sg.verify(problem, answer.u, answer.multiplier, answer.equality_multiplier)
    assert again.energy_error_bound == answer.energy_error_bound
    copy = pickle.loads(pickle.dumps(problem))
    assert abs(copy.E - problem.E).max() == 0.0 and np.array_equal(copy.e, problem.e)
    with pytest.raises(sg.BadInput, match="E is given without e"):
        sg.Problem(K, f, B, g, E=E)
    with pytest.raises(sg.Infeasible, match="equality rows") as refusal:
        sg.solve(sg.Problem(K, f, B, g, E=E, e=[0.0, 1.0]))
    assert sorted(refusal.value.rows) == [B.shape[0], B.shape[0] + 1]


def test_an_empty_row_with_a_gap_of_rounding_is_named_in_a_warning() -> None:
    with pytest.warns(UserWarning, match="contact row 1 .* counts as 0"):
        problem = sg.Problem(np.eye(2), [3.0, 0.0], [[1.0, 0.0], [0.0, 0.0]], [1.0, -7e-18])
    assert problem.g[1] == 0.0 and sg.solve(problem).u[0] == 1.0


def test_every_object_has_a_short_text_for_the_console() -> None:
    problem = two_springs()
    assert repr(problem) == "<signorini.Problem: 2 dofs, 1 contact rows>"
    answer = sg.solve(problem)
    assert repr(answer).startswith("<signorini.Solution: 2 dofs, 1 of 1 rows closed, energy error <= ")
    assert "<table>" in answer._repr_html_() and "closed rows" in answer._repr_html_()
    assert repr(answer.proven) == "<signorini.Proven: 1 closed, 0 open, 0 undecided>"
    assert repr(answer.certificate).startswith("<signorini.Certificate: energy error <= ")

"""Linear complementarity problems: classes, bounds, rays, comparison with cvxpy, and invalid arguments."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import signorini as sg
from scipy import sparse

M = np.array([[2.0, -1.0], [-1.0, 2.0]])
Q = np.array([-1.0, 3.0])


@pytest.mark.parametrize("form", ["dense", "list", "csc", "csr", "coo", "bsr", "dia", "lil"])
def test_every_form_of_a_matrix_gives_the_same_solution(form: str) -> None:
    given: Any = {"dense": M, "list": M.tolist()}.get(form)
    found = sg.lcp(sparse.csc_array(M).asformat(form) if given is None else given, Q)
    assert found.z.tolist() == [0.5, 0.0] and found.w.tolist() == [0.0, 2.5]
    assert (found.kind, found.unique, found.method) == ("symmetric", "one", "quadratic-program")
    assert found.error_bound is not None and found.error_bound.max() < 1e-14 and found.no_error_bound is None
    assert found.w_error_bound is not None and found.residual.max() <= 1e-13
    assert found.proven == ["between", "lower"] and found.seconds > 0 and found.iterations >= 0
    assert "2 unknowns" in repr(found) and not found.z.flags.writeable


def test_bounds_take_their_part() -> None:
    found = sg.lcp([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [-3.0, 4.0, 1.0], [0, -np.inf, -1e30], [2, 1, np.inf])
    assert found.z.tolist() == [2.0, -4.0, -1.0] and found.w.tolist() == [-1.0, 0.0, 0.0]
    assert found.proven == ["upper", "between", "between"]


@pytest.mark.parametrize(
    ("matrix", "q", "kind", "unique"),
    [
        ([[1, -1], [-1, 1]], [1, 1], "symmetric", "several"),
        ([[2, -1], [0, 1]], [-1, -1], "h-matrix", "one"),
        ([[0, 1], [-1, 0]], [-1, 2], "monotone", "unknown"),
        ([[1, 3, 0], [0, 1, 3], [3, 0, 1]], [-1, -1, -1], "p-matrix", "one"),
        ([[1, 2], [2, 1]], [-1, -1], "general", "unknown"),
    ],
)
def test_the_class_of_a_matrix_is_named(matrix: Any, q: Any, kind: str, unique: str) -> None:
    found = sg.lcp(matrix, q)
    assert (found.kind, found.unique) == (kind, unique)
    assert (found.error_bound is None) == isinstance(found.no_error_bound, str)
    w = np.array(matrix) @ found.z + q
    assert np.abs(np.minimum(found.z, w)).max() < 1e-12


def test_random_symmetric_problems_have_the_solution_of_cvxpy() -> None:
    cvxpy = pytest.importorskip("cvxpy")
    rng = np.random.default_rng(76)
    for n in (3, 10, 40):
        part = rng.standard_normal((n, n))
        matrix, q, upper = part @ part.T + np.eye(n), rng.standard_normal(n) * 5, rng.uniform(0.1, 2.0, n)
        found = sg.lcp(matrix, q, upper=upper)
        z = cvxpy.Variable(n)
        objective = 0.5 * cvxpy.quad_form(z, cvxpy.psd_wrap(matrix)) + q @ z
        cvxpy.Problem(cvxpy.Minimize(objective), [z >= 0, z <= upper]).solve(solver="CLARABEL")
        assert np.allclose(found.z, z.value, atol=1e-6)
        assert found.error_bound is not None and np.abs(found.z - z.value).max() < 1e-6 + found.error_bound.max()


@pytest.mark.parametrize("matrix", [[[1.0, -1.0], [-1.0, 1.0]], [[-1.0, -1.0], [0.0, -1.0]]])
def test_an_infeasible_problem_carries_its_ray(matrix: Any) -> None:
    with pytest.raises(sg.Infeasible) as raised:
        sg.lcp(matrix, [-2.0, 1.0])
    y = raised.value.ray
    assert y is not None and (y >= 0).all() and (np.array(matrix).T @ y <= 1e-15).all()
    assert y @ [-2.0, 1.0] < 0 and np.allclose(-(y @ [-2.0, 1.0]), raised.value.overlap)
    assert np.array_equal(y[raised.value.rows], raised.value.weights) and raised.value.code == "infeasible"


def test_a_problem_without_a_solution_and_without_a_proof_is_not_found() -> None:
    with pytest.raises(sg.NotFound, match="proves nothing"):
        sg.lcp([[-2, 1], [0, 1]], [-1, 1])


HOSTILE: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "M none": (lambda: sg.lcp(None, Q), TypeError, "M is None"),
    "M text": (lambda: sg.lcp("M", Q), TypeError, "M is .* dtype"),
    "M number": (lambda: sg.lcp(3.0, Q), ValueError, "M has the shape"),
    "M one dimension": (lambda: sg.lcp(Q, Q), ValueError, "two dimensions"),
    "M three dimensions": (lambda: sg.lcp(np.ones((2, 2, 1)), Q), ValueError, "two dimensions"),
    "M wide": (lambda: sg.lcp(np.ones((2, 3)), Q), ValueError, "2 x 3"),
    "M sparse and wide": (lambda: sg.lcp(sparse.csr_array((2, 3)), Q), ValueError, "M is 2 x 3; it must be square"),
    "M larger than q": (lambda: sg.lcp(np.eye(3), Q), ValueError, "3 x 3"),
    "M complex": (lambda: sg.lcp(M + 0j, Q), TypeError, "complex128"),
    "M sparse and complex": (lambda: sg.lcp(sparse.csc_array(M + 0j), Q), TypeError, "complex128"),
    "M of objects": (lambda: sg.lcp(M.astype(object), Q), TypeError, "dtype object"),
    "M ragged": (lambda: sg.lcp([[1.0], [1.0, 2.0]], Q), TypeError, "M is no array"),
    "M nan": (lambda: sg.lcp(np.where(M < 0, np.nan, M), Q), ValueError, "NaN"),
    "M inf": (lambda: sg.lcp(sparse.csc_array(np.where(M < 0, np.inf, M)), Q), ValueError, "inf"),
    "M overflows": (
        lambda: sg.lcp(sparse.coo_array(([1e308, 1e308], ([0, 0], [0, 0])), shape=(2, 2)), Q), ValueError, "M|matrix"
    ),
    "M huge and empty": (lambda: sg.lcp(sparse.coo_array((10**9, 10**9)), Q), ValueError, "almost empty"),
    "M masked": (lambda: sg.lcp(np.ma.masked_less(M, 0.0), Q), TypeError, "masked array"),
    "q none": (lambda: sg.lcp(M, None), TypeError, "q is None"),  # type: ignore[arg-type]
    "q short": (lambda: sg.lcp(M, [1.0]), ValueError, "2 x 2"),
    "q column": (lambda: sg.lcp(M, Q.reshape(-1, 1)), ValueError, "q has the shape"),
    "q number": (lambda: sg.lcp(M, 1.0), ValueError, "q has the shape"),
    "q nan": (lambda: sg.lcp(M, [0.0, np.nan]), ValueError, "offset q has the value NaN"),
    "q inf": (lambda: sg.lcp(M, [np.inf, 0.0]), ValueError, "offset q has the value inf"),
    "q complex": (lambda: sg.lcp(M, Q + 1j), TypeError, "complex128"),
    "q text": (lambda: sg.lcp(M, ["a", "b"]), TypeError, "q is"),
    "lower number": (lambda: sg.lcp(M, Q, 0.0), ValueError, "lower has the shape"),
    "lower short": (lambda: sg.lcp(M, Q, [0.0]), ValueError, "lower bound has length 1"),
    "lower nan": (lambda: sg.lcp(M, Q, [0.0, np.nan]), ValueError, "lower bound has the value NaN"),
    "lower inf": (lambda: sg.lcp(M, Q, [0.0, np.inf]), ValueError, "bounds of unknown 1"),
    "upper minus inf": (lambda: sg.lcp(M, Q, None, [-np.inf, 1.0]), ValueError, "bounds of unknown 0"),
    "upper below lower": (lambda: sg.lcp(M, Q, [1.0, 0.0], [0.0, 1.0]), ValueError, "bounds of unknown 0 .* 1e0 and 0e0"),
    "upper text": (lambda: sg.lcp(M, Q, None, ["a", "b"]), TypeError, "upper is"),
    "tolerance negative": (lambda: sg.lcp(M, Q, tolerance=-1.0), ValueError, "tolerance is -1"),
    "tolerance text": (lambda: sg.lcp(M, Q, tolerance="low"), TypeError, "tolerance is of the type str"),  # type: ignore[arg-type]
    "time zero": (lambda: sg.lcp(M, Q, time=0.0), ValueError, "time is 0"),
    "no threads": (lambda: sg.lcp(M, Q, threads=0), ValueError, "threads is 0"),
    "memory nan": (lambda: sg.lcp(M, Q, memory=np.nan), ValueError, "memory"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_every_invalid_argument_is_refused_with_a_message(name: str) -> None:
    attempt, kind, words = HOSTILE[name]
    with pytest.raises(kind, match=words) as raised:
        attempt()
    sentence = str(raised.value)
    assert len(sentence) > 10 and "\n" not in sentence and "panick" not in sentence
    assert isinstance(raised.value, sg.SignoriniError) and raised.value.code


def test_a_problem_without_unknowns_has_an_empty_solution() -> None:
    assert sg.lcp(np.zeros((0, 0)), []).z.shape == (0,)

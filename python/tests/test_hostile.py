"""Invalid arguments: each is refused with a message that names the argument, and nothing else happens."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import signorini as sg
from bodies import bar, membrane, two_springs
from scipy import sparse

K, F, B, G = bar(4)
N = 4


def with_k(given: Any) -> Callable[[], Any]:
    return lambda: sg.Problem(given, F, B, G)


def with_f(given: Any) -> Callable[[], Any]:
    return lambda: sg.Problem(K, given, B, G)


def with_b(given: Any) -> Callable[[], Any]:
    return lambda: sg.Problem(K, F, given, G)


def with_g(given: Any) -> Callable[[], Any]:
    return lambda: sg.Problem(K, F, B, given)


def with_coordinates(given: Any) -> Callable[[], Any]:
    return lambda: sg.Problem(K, F, B, G, coordinates=given)


def solved(**options: Any) -> Callable[[], Any]:
    return lambda: sg.solve(two_springs(), **options)


def vjp(*given: Any, **named: Any) -> Callable[[], Any]:
    return lambda: sg.solve(two_springs()).vjp(*given, **named)


def jvp(**changes: Any) -> Callable[[], Any]:
    return lambda: sg.solve(two_springs()).jvp(**changes)


def damaged(form: str, **arrays: Any) -> sparse.spmatrix:
    """The stiffness with some of its arrays replaced, which scipy has not checked."""
    matrix = K.asformat(form).copy()
    for name, array in arrays.items():
        setattr(matrix, name, array)
    return matrix


def entry(value: float) -> sparse.csc_matrix:
    matrix = K.copy()
    matrix.data[1] = value
    return matrix


def negative(form: str, name: str) -> sparse.spmatrix:
    matrix = K.asformat(form).copy()
    getattr(matrix, name)[0] = -1
    return matrix


def far(form: str, name: str, index: int) -> sparse.spmatrix:
    matrix = K.asformat(form).copy()
    getattr(matrix, name)[0] = index
    return matrix


class Converting:
    """Converts itself into `result`, or into itself."""

    def __init__(self, result: Any) -> None:
        self.result = result

    def to_scipy(self) -> Any:
        return self if self.result is None else self.result


HOSTILE: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "K none": (with_k(None), TypeError, "K is None"),
    "K text": (with_k("stiffness"), TypeError, "K is .* dtype"),
    "K number": (with_k(3.0), ValueError, "K has the shape"),
    "K one dimension": (with_k(np.ones(4)), ValueError, "must have two dimensions"),
    "K three dimensions": (with_k(np.ones((4, 4, 1))), ValueError, "must have two dimensions"),
    "K wide": (with_k(np.ones((4, 5))), ValueError, "4 x 5"),
    "K sparse and wide": (with_k(sparse.csc_matrix((4, 5))), ValueError, "K is 4 x 5; it must be square"),
    "K complex": (with_k(K.astype(complex)), TypeError, "complex128"),
    "K dense and complex": (with_k(K.toarray() + 0j), TypeError, "complex128"),
    "K of objects": (with_k(K.toarray().astype(object)), TypeError, "dtype object"),
    "K of text": (with_k(np.array([["a", "b"], ["c", "d"]])), TypeError, "dtype <U1"),
    "K of dates": (with_k(np.zeros((4, 4), "datetime64[s]")), TypeError, "datetime64"),
    "K longer than doubles": (with_k(K.toarray().astype(np.longdouble)), TypeError, "must be a matrix of real numbers"),
    "K ragged": (with_k([[1.0, 2.0], [3.0]]), TypeError, "K is no array"),
    "K with nan": (with_k(entry(np.nan)), ValueError, r"NaN at \(1, 0\)"),
    "K with inf": (with_k(entry(np.inf)), ValueError, r"inf at \(1, 0\)"),
    "K dense with nan": (with_k(np.where(K.toarray() < 0, np.nan, K.toarray())), ValueError, "NaN"),
    "K not symmetric": (with_k(entry(-3.0)), ValueError, r"entry \(1, 0\) is -3e0, entry \(0, 1\) is -4e0"),
    "K not symmetric by rows": (with_k(entry(-3.0).tocsr()), ValueError, r"entry \(1, 0\) is -3e0, entry \(0, 1\) is -4e0"),
    "K one triangle": (with_k(sparse.tril(K, format="csc")), ValueError, "not symmetric"),
    "K negative diagonal": (with_k(-K), sg.NotConvex, "diagonal entry 0"),
    "K masked": (with_k(np.ma.masked_less(K.toarray(), 0.0)), TypeError, "masked array"),
    "K csc, row negative": (with_k(negative("csc", "indices")), ValueError, "a negative index"),
    "K csr, column negative": (with_k(negative("csr", "indices")), ValueError, "a negative index"),
    "K coo, row negative": (with_k(negative("coo", "row")), ValueError, "a negative index"),
    "K bsr, column negative": (with_k(negative("bsr", "indices")), ValueError, "K is no matrix"),
    "K csc, row beyond": (with_k(far("csc", "indices", 9)), ValueError, "row 9 and column 0"),
    "K csr, column beyond": (with_k(far("csr", "indices", 9)), ValueError, "row 0 and column 9"),
    "K coo, column beyond": (with_k(far("coo", "col", 9)), ValueError, "column 9"),
    "K starts decrease": (with_k(damaged("csc", indptr=np.array([0, 2, 1, 8, 10]))), ValueError, "must not decrease"),
    "K starts too few": (with_k(damaged("csc", indptr=np.array([0, 2, 10]))), ValueError, "indptr of K has length 3"),
    "K starts beyond": (with_k(damaged("csr", indptr=np.array([0, 2, 5, 8, 99]))), ValueError, "beyond 10 entries"),
    "K starts negative": (with_k(damaged("csc", indptr=np.array([0, -2, 5, 8, 10]))), ValueError, "indptr of K"),
    "K starts late": (with_k(damaged("csc", indptr=np.array([1, 2, 5, 8, 10]))), ValueError, "indptr of K begins with 1"),
    "K indices of floats": (with_k(damaged("csc", indices=K.indices.astype(float))), TypeError, "indices of K"),
    "K indices in two dimensions": (with_k(damaged("csc", indices=K.indices.reshape(2, 5))), ValueError, "one dimension"),
    "K data too short": (with_k(damaged("csc", data=K.data[:-1])), ValueError, "9 entries in data and 10 in indices"),
    "K data of text": (with_k(damaged("csc", data=np.array(["1"] * 10))), TypeError, "data of K"),
    "K coo, lengths differ": (with_k(damaged("coo", data=np.ones(3))), ValueError, "K is no matrix: .* same length"),
    "K huge and empty": (with_k(sparse.coo_matrix((10**9, 10**9))), ValueError, "almost empty"),
    "K converts into itself": (with_k(Converting(None)), TypeError, r"`to_scipy\(\)` returns a Converting"),
    "K converts twice": (with_k(Converting(Converting(K))), TypeError, "must return a sparse matrix of scipy"),
    "K dictionary": (with_k({"a": 1}), TypeError, "K is"),
    "f none": (with_f(None), TypeError, "f is None"),
    "f short": (with_f(F[:-1]), ValueError, "load vector has length 3, but there are 4 dofs"),
    "f long": (with_f(np.ones(5)), ValueError, "length 5"),
    "f column": (with_f(F.reshape(-1, 1)), ValueError, r"f has the shape \(4, 1\); it must have one dimension, as ravel"),
    "f number": (with_f(3.0), ValueError, "f has the shape"),
    "f nan": (with_f([0.0, np.nan, 0.0, 0.0]), ValueError, "NaN at entry 1"),
    "f inf": (with_f([0.0, 0.0, np.inf, 0.0]), ValueError, "inf at entry 2"),
    "f complex": (with_f(F + 1j), TypeError, "complex128"),
    "f text": (with_f("3"), TypeError, "f is .* dtype <U1"),
    "f of none": (with_f([None] * 4), TypeError, "dtype object"),
    "f masked": (with_f(np.ma.masked_equal(F, 3.0)), TypeError, "masked array"),
    "f sparse": (with_f(sparse.csc_matrix(F.reshape(-1, 1))), TypeError, "f is"),
    "B narrow": (with_b(np.ones((1, 3))), ValueError, "1 x 3"),
    "B sparse and wide": (with_b(sparse.csr_matrix((1, 9))), ValueError, "B is 1 x 9; it must have 4 columns"),
    "B nan": (with_b(np.array([[0.0, 0.0, 0.0, np.nan]])), ValueError, "NaN"),
    "B huge and empty": (with_b(sparse.coo_matrix((10**9, 4))), ValueError, "almost empty"),
    "B without g": (lambda: sg.Problem(K, F, B), ValueError, "B is given without g"),
    "g without B": (lambda: sg.Problem(K, F, g=G), ValueError, "g is given without B"),
    "g short": (with_g([]), ValueError, "gap vector has length 0"),
    "g nan": (with_g([np.nan]), ValueError, "NaN at entry 0"),
    "g minus inf": (with_g([-np.inf]), ValueError, "-inf at entry 0"),
    "near_null short": (lambda: sg.Problem(K, F, B, G, near_null=np.ones((3, 1))), ValueError, "near-null"),
    "near_null dependent": (lambda: sg.Problem(K, F, B, G, near_null=np.ones((4, 2))), ValueError, "independent"),
    "near_null and coordinates": (
        lambda: sg.Problem(K, F, B, G, near_null=np.ones((4, 1)), coordinates=np.ones((4, 1))),
        ValueError,
        "one of them is enough",
    ),
    "coordinates of another mesh": (lambda: sg.Problem(K, F, B, G, coordinates=np.ones((3, 2))), ValueError, "makes 6 dofs"),
    "coordinates in four dimensions": (lambda: sg.Problem(K, F, B, G, coordinates=np.ones((1, 4))), ValueError, "1, 2 or 3"),
    "coordinates nan": (with_coordinates([[0.0], [np.nan], [2.0], [3.0]]), ValueError, r"coordinates has the value NaN at \(1, 0\)"),
    "coordinates inf": (with_coordinates([[0.0, 0.0], [1.0, np.inf]]), ValueError, r"coordinates has the value inf at \(1, 1\)"),
    "method unknown": (solved(method="newton"), ValueError, "method is \"newton\"; it must be one of auto, qp"),
    "method number": (solved(method=3), TypeError, "method is of the type int"),
    "accuracy negative": (solved(accuracy=-1.0), ValueError, "accuracy is -1"),
    "accuracy text": (solved(accuracy="good"), TypeError, "accuracy is of the type str"),
    "tolerance nan": (solved(tolerance=np.nan), ValueError, "tolerance is NaN"),
    "tolerance zero": (solved(tolerance=0.0), ValueError, "tolerance is 0"),
    "time zero": (solved(time=0.0), ValueError, "time is 0"),
    "time negative": (solved(time=-1.0), ValueError, "time is -1"),
    "time nan": (solved(time=np.nan), ValueError, "time is NaN"),
    "time beyond all": (solved(time=1e300), ValueError, "time is 1"),
    "threads none at all": (solved(threads=0), ValueError, "threads is 0"),
    "threads negative": (solved(threads=-1), ValueError, "threads is -1"),
    "threads half": (solved(threads=1.5), ValueError, "threads is 1.5"),
    "threads beyond all": (solved(threads=10**9), ValueError, "threads is 1000000000"),
    "memory nothing": (solved(memory=0.0), ValueError, "memory is 0"),
    "precision unknown": (solved(precision="half"), ValueError, "precision is \"half\""),
    "start of another problem": (solved(start=sg.solve(sg.Problem(K, F, B, G))), ValueError, "start has 4 dofs and 1 rows"),
    "start names a row beyond": (solved(start=np.array([5])), ValueError, "start names the row 5"),
    "start names a negative row": (solved(start=np.array([-1])), ValueError, "a negative number"),
    "start nan": (solved(start=[0.0, np.nan]), ValueError, "start has the value NaN at entry 1"),
    "start minus inf": (solved(start=[-np.inf, 0.0]), ValueError, "start has the value -inf at entry 0"),
    "start of prepared nan": (lambda: sg.prepare(two_springs()).solve(start=[np.nan, 0.0]), ValueError, "NaN at entry 0"),
    "start too short": (solved(start=[0.5]), ValueError, "start has length 1"),
    "an unknown option": (solved(speed=3), TypeError, "speed"),
    "no problem": (lambda: sg.solve(K), TypeError, "Problem"),
    "verify short": (lambda: sg.verify(two_springs(), [1.0], [0.0]), ValueError, "length 1"),
    "verify nan": (lambda: sg.verify(two_springs(), [np.nan, 0.0], [0.0]), ValueError, "u has the value NaN at entry 0"),
    "gap of another length": (lambda: sg.prepare(two_springs()).solve([1.0, 2.0]), ValueError, "length 2"),
    "load of another length": (lambda: sg.prepare(two_springs()).solve(f=[1.0]), ValueError, "length 1"),
    "gap of text": (lambda: sg.prepare(two_springs()).solve(["a"]), TypeError, "g is"),
    "derivative by a short displacement": (vjp([1.0]), ValueError, "displacement has length 1, but the number of dofs is 2"),
    "derivative by nan": (vjp([1.0, np.nan]), ValueError, "displacement has the value NaN at entry 1"),
    "derivative by a long multiplier": (vjp(multiplier=[1.0, 1.0]), ValueError, "multiplier has length 2, but the number of contact rows"),
    "derivative by inf": (vjp(multiplier=[np.inf]), ValueError, "multiplier has the value inf at entry 0"),
    "derivative by an equality that is not there": (vjp(equality_multiplier=[1.0]), ValueError, "the number of equality rows is 0"),
    "derivative by text": (vjp("up"), TypeError, "displacement is .* dtype"),
    "derivative by a matrix": (vjp(np.ones((2, 1))), ValueError, r"displacement has the shape \(2, 1\)"),
    "change of a short load": (jvp(load=[1.0]), ValueError, "load has length 1"),
    "change of the load by nan": (jvp(load=[0.0, np.nan]), ValueError, "load has the value NaN at entry 1"),
    "change of two gaps of one": (jvp(gap=[1.0, 2.0]), ValueError, "gap has length 2"),
    "change of the gap by inf": (jvp(gap=[np.inf]), ValueError, "gap has the value inf at entry 0"),
    "change of a value that is not there": (jvp(equality_values=[1.0]), ValueError, "equality_values has length 1"),
    "change of another stiffness": (jvp(stiffness=np.eye(3)), ValueError, "change of the stiffness is 3 x 3"),
    "change of the stiffness, not symmetric": (jvp(stiffness=[[0.0, 1.0], [0.0, 0.0]]), ValueError, "not symmetric"),
    "change of the stiffness by nan": (jvp(stiffness=[[np.nan, 0.0], [0.0, 0.0]]), ValueError, "NaN"),
    "change of the stiffness by text": (jvp(stiffness="more"), TypeError, "stiffness is"),
    "change of wide rows": (jvp(rows=np.ones((1, 3))), ValueError, "rows is 1 x 3; it must be 1 x 2"),
    "change of wide sparse rows": (jvp(rows=sparse.csr_array((1, 3))), ValueError, "rows is 1 x 3; it must have 2 columns"),
    "change of two rows of one": (jvp(rows=np.ones((2, 2))), ValueError, "rows is 2 x 2; it must be 1 x 2"),
    "change of the rows by inf": (jvp(rows=[[np.inf, 0.0]]), ValueError, "inf"),
    "scene of a number": (lambda: sg.Scene(3), TypeError, "not of a int"),  # type: ignore[arg-type]
    "scene of nothing": (lambda: sg.Scene({}), sg.SceneError, "is missing"),
    "scene that is no JSON": (lambda: sg.Scene({"body": {1, 2}}), TypeError, "no place for a set"),
    "scene in itself": (lambda: sg.Scene(circle()), ValueError, "JSON"),
    "scene without a file": (lambda: sg.Scene("nowhere.json"), OSError, "cannot read nowhere.json"),
    "sweep of nothing": (lambda: sg.sweep(K, [1.0]), TypeError, "a Problem or a Scene"),
    "sweep over nothing": (lambda: sg.sweep(two_springs()), ValueError, "a sweep over nothing; a problem is swept over gaps or g1, f1"),
    "sweep over two things": (lambda: sg.sweep(two_springs(), [[1.0]], g1=[2.0]), ValueError, "over gaps and g1, f1"),
    "sweep of a problem over forces": (lambda: sg.sweep(two_springs(), forces=[1.0]), ValueError, "a sweep over forces"),
    "sweep to gaps of another length": (lambda: sg.sweep(two_springs(), g1=[1.0, 2.0]), ValueError, "length 2"),
    "sweep of one point": (lambda: sg.sweep(two_springs(), g1=[2.0], points=1), ValueError, "points is 1"),
    "sweep of half a point": (lambda: sg.sweep(two_springs(), g1=[2.0], points=2.5), ValueError, "points is 2.5"),
    "sweep over no gaps": (lambda: sg.sweep(plane_scene(), []), ValueError, "gaps is empty"),
    "sweep over a force that pulls": (lambda: sg.sweep(plane_scene(force=1.0), forces=[-2.0]), sg.SceneError, "-2 would pull"),
    "sweep over a force that presses nothing": (lambda: sg.sweep(plane_scene(), forces=[1.0]), sg.SceneError, "no obstacle is pressed"),
    "sweep of a scene to other gaps": (lambda: sg.sweep(plane_scene(), g1=[1.0]), ValueError, "a scene is swept over gaps or forces"),
    "tradeoff of nothing": (lambda: sg.tradeoff(K), TypeError, "a Problem or a Scene"),
    "tradeoff refined backwards": (lambda: sg.tradeoff(two_springs(), refinements=-1), ValueError, "refinements is -1"),
    "compare nothing": (lambda: sg.compare(None), TypeError, "a Problem or a Scene"),
}


def plane_scene(**of_obstacle: float) -> sg.Scene:
    axis = {"points": [0, 1], "divisions": [2]}
    obstacle = {"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 1], "normal": [0, 1]}}, **of_obstacle}
    return sg.Scene(
        {
            "body": {"rectangle": {"x": axis, "y": axis}},
            "material": {"young": 1e7, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "obstacles": [obstacle],
        }
    )


def circle() -> dict[str, Any]:
    scene: dict[str, Any] = {}
    scene["body"] = scene
    return scene


@pytest.mark.parametrize("name", HOSTILE)
def test_every_invalid_argument_is_refused_with_a_message(name: str) -> None:
    attempt, kind, words = HOSTILE[name]
    with pytest.raises(kind, match=words) as raised:
        attempt()
    sentence = str(raised.value)
    assert len(sentence) > 10 and "\n" not in sentence and "panick" not in sentence
    if name != "an unknown option" and name != "no problem":
        assert isinstance(raised.value, sg.SignoriniError) and raised.value.code


def test_at_least_sixty_invalid_arguments_are_tested() -> None:
    assert len(HOSTILE) >= 60


def test_a_matrix_of_a_million_rows_with_one_entry_is_accepted() -> None:
    stiffness, load, _, _ = membrane(5)
    one = sparse.coo_matrix(([1.0], ([999_999], [0])), shape=(1_000_000, len(load)))
    assert sg.Problem(stiffness, load, one, np.ones(1_000_000)).row_count == 1_000_000

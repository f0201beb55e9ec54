"""Many small problems at once, compared with each of them solved alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import signorini as sg

COUNT, DOFS, ROWS = 37, 8, 4


def family(seed: int = 0) -> tuple[Any, Any, Any, Any]:
    rng = np.random.default_rng(seed)
    a = rng.standard_normal((COUNT, DOFS, DOFS))
    K = a @ a.transpose(0, 2, 1) / DOFS + 0.1 * np.eye(DOFS)
    K = (K + K.transpose(0, 2, 1)) / 2
    return K, rng.standard_normal((COUNT, DOFS)), rng.standard_normal((COUNT, ROWS, DOFS)), rng.uniform(0.1, 0.6, (COUNT, ROWS))


def test_many_problems_have_the_bits_of_each_alone_on_any_number_of_threads() -> None:
    K, f, B, g = family()
    for threads in (None, 1, 2, 7):
        many = sg.solve_many(K, f, B, g, threads=threads)
        assert many.certified.all() and not many.errors
        for number in range(COUNT):
            alone = sg.solve(sg.Problem(K[number], f[number], B[number], g[number]))
            assert np.array_equal(many.u[number], alone.u) and np.array_equal(many.multiplier[number], alone.multiplier)
            assert many.energy_error_bound[number] == alone.energy_error_bound < 1e-9
            assert alone.proven is not None
            assert np.array_equal(np.flatnonzero(many.proven_closed[number]), alone.proven.closed)
            assert np.array_equal(np.flatnonzero(many.proven_open[number]), alone.proven.open)


def test_arrays_without_a_first_axis_are_shared() -> None:
    K, f, B, g = family()
    many = sg.solve_many(K[0], f, B[0], g[0])
    each = sg.solve_many(np.repeat(K[:1], COUNT, 0), f, np.repeat(B[:1], COUNT, 0), np.repeat(g[:1], COUNT, 0))
    assert np.array_equal(many.u, each.u) and many.u.shape == (COUNT, DOFS)
    assert sg.solve_many(K[0], f[0], B[0], g[0]).u.shape == (1, DOFS)
    without = sg.solve_many(K, f, np.zeros((0, DOFS)), np.zeros(0))
    assert without.multiplier.shape == (COUNT, 0) and np.allclose(np.einsum("nij,nj->ni", K, without.u), f)


def test_a_problem_without_an_answer_has_its_exception_and_no_other_problem_suffers() -> None:
    K, f, B, g = family()
    B[5, 1], g[5, :2] = -B[5, 0], -1.0
    K[6] = -K[6]
    many = sg.solve_many(K, f, B, g, threads=2)
    assert set(many.errors) == {5, 6} == set(np.flatnonzero(~many.certified))
    assert isinstance(many.errors[5], sg.Infeasible) and isinstance(many.errors[6], sg.NotConvex)
    assert np.isnan(many.u[[5, 6]]).all() and np.isfinite(np.delete(many.u, [5, 6], 0)).all()


def test_arrays_that_do_not_fit_each_other_are_refused() -> None:
    K, f, B, g = family()
    for arrays, words in (
        ((K[:3], f, B, g), "K is given for 3 problems"),
        ((K[:, :3], f, B, g), "K has the shape"),
        ((K, f, B[..., :3], g), "B has the shape"),
        ((K, f[None], B, g), "f has the shape"),
        ((K, f, B, g[:, :2]), "B has the shape"),
    ):
        with pytest.raises(sg.BadInput, match=words):
            sg.solve_many(*arrays)
    with pytest.raises(sg.BadInput):
        sg.solve_many(K, f, B, g, threads=0)
    with pytest.raises(sg.BadType):
        sg.solve_many(None, f, B, g)  # type: ignore[arg-type]

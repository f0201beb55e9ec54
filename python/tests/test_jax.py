"""Contact problems as functions of jax: gradients against differences, kinks, transformations."""

from __future__ import annotations

import doctest
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import signorini as sg
from bodies import membrane
from scipy import sparse
from test_derivatives import touching
from test_many import family

jax = pytest.importorskip("jax")
contact = pytest.importorskip("signorini.jax")


@pytest.fixture(autouse=True)
def doubles() -> Iterator[None]:
    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", before)


def problems() -> Iterator[tuple[Any, tuple[Any, ...]]]:
    """Patterns with the values of stiffness, load, rows and gap: dense ones, and a sparse one."""
    Ks, fs, Bs, gs = family(5)
    for K, f, B, g in list(zip(Ks, fs, Bs, gs, strict=True))[:3]:
        yield contact.Pattern.of(K, B), (K.ravel(), f, B.ravel(), g)
    K, f, B, g = membrane(5)
    rows = sparse.csr_array(B[:6])
    yield contact.Pattern.of(K, rows), (K.data, f * 1.3, rows.data, g[:6])


def test_gradients_by_all_data_are_those_of_differences() -> None:
    from jax.test_util import check_grads

    for pattern, values in problems():
        check_grads(lambda *values, pattern=pattern: contact.solve(pattern, *values), values, order=1, modes=["rev"], rtol=1e-4, eps=1e-6)


def test_the_answer_is_that_of_solve_within_jit_and_without() -> None:
    for pattern, values in problems():
        u, multiplier = contact.solve(pattern, *values)
        K = sparse.csc_array((values[0], pattern.stiffness), shape=(pattern.dofs, pattern.dofs))
        B = sparse.csc_array((values[2], pattern.rows), shape=(pattern.row_count, pattern.dofs))
        alone = sg.solve(sg.Problem(K, values[1], B, values[3]))
        assert np.allclose(u, alone.u, rtol=1e-10, atol=1e-12) and np.allclose(multiplier, alone.multiplier, rtol=1e-9, atol=1e-10)

        def loss(*values: Any, pattern: Any = pattern) -> Any:
            u, multiplier = contact.solve(pattern, *values)
            return (u**2).sum() + multiplier.sum()

        eager = jax.grad(loss, argnums=(0, 1, 2, 3))(*values)
        compiled = jax.jit(jax.grad(loss, argnums=(0, 1, 2, 3)))(*values)
        assert all(np.array_equal(one, other) for one, other in zip(eager, compiled, strict=True))


def test_many_loads_are_solved_by_vmap() -> None:
    pattern, (stiffness, load, rows, gap) = next(problems())
    loads = np.stack([load, 0.5 * load, -load])
    found = jax.vmap(lambda load: contact.solve(pattern, stiffness, load, rows, gap)[0])(loads)
    each = [contact.solve(pattern, stiffness, load, rows, gap)[0] for load in loads]
    assert np.allclose(found, np.stack(each), rtol=1e-12)
    jacobian = jax.jacrev(lambda load: contact.solve(pattern, stiffness, load, rows, gap)[0])(load)
    assert np.allclose(jacobian, jacobian.T, rtol=1e-9, atol=1e-12)


def test_a_kink_raises_unless_a_piece_is_chosen() -> None:
    problem = touching()
    K, B = problem.K.toarray(), problem.B.toarray()
    pattern = contact.Pattern.of(K, B)

    def end(load: Any, **options: Any) -> Any:
        return contact.solve(pattern, K.ravel(), load, B.ravel(), problem.g, **options)[0][1]

    with pytest.raises(sg.NoDerivative, match="row 0 ") as raised:
        jax.grad(end)(problem.f)
    assert raised.value.rows.tolist() == [0]
    with pytest.raises(Exception, match="row 0 "):
        jax.jit(jax.grad(end))(problem.f).block_until_ready()
    assert np.allclose(jax.grad(lambda load: end(load, at_kink="open"))(problem.f), [0.5, 1.5])
    assert np.allclose(jax.grad(lambda load: end(load, at_kink="closed"))(problem.f), [0.0, 0.0])
    # Without a derivative there is no reason to refuse.
    assert np.isclose(end(problem.f), 1.5)


def test_arguments_that_do_not_fit_are_refused() -> None:
    pattern, (stiffness, load, rows, gap) = next(problems())
    for values, words in (
        ((stiffness[:-1], load, rows, gap), "stiffness has the shape"),
        ((stiffness, load[:-1], rows, gap), "load has the shape"),
        ((stiffness, load.astype(np.float32), rows, gap), "load has the dtype float32"),
        ((stiffness, load, rows, gap.astype(int)), "gap has the dtype int64"),
    ):
        with pytest.raises(sg.BadInput, match=words):
            contact.solve(pattern, *values)
    with pytest.raises(sg.BadInput, match="at_kink is 'left'"):
        contact.solve(pattern, stiffness, load, rows, gap, at_kink="left")
    with pytest.raises(sg.BadInput, match="load vector|load"):
        contact.solve(pattern, stiffness, np.nan * load, rows, gap)
    for matrices, kind, words in (
        ((np.eye(2), np.ones((1, 3))), sg.BadInput, "B is 1 x 3"),
        ((np.ones((2, 3)), np.ones((1, 3))), sg.BadInput, "must be square"),
        ((sparse.tril(np.ones((2, 2))), np.ones((1, 2))), sg.BadInput, r"a place at \(1, 0\) and none"),
        ((np.ones(3), np.ones((1, 3))), sg.BadType, "two dimensions"),
    ):
        with pytest.raises(kind, match=words):
            contact.Pattern.of(*matrices)
    jax.config.update("jax_enable_x64", False)
    with pytest.raises(sg.BadType, match="jax_enable_x64"):
        contact.solve(pattern, stiffness, load, rows, gap)


def test_other_loads_and_gaps_take_the_same_factor() -> None:
    pattern, (stiffness, load, rows, gap) = next(problems())
    layer = pattern.layer("raise", {})
    layer.solution(stiffness, load, rows, gap)
    before = layer._prepared
    contact.solve(pattern, stiffness, 2.0 * load, rows, 0.5 * gap)
    assert layer._prepared is before
    contact.solve(pattern, 2.0 * stiffness, load, rows, gap)
    assert layer._prepared is not before


def test_the_example_of_the_module_is_right() -> None:
    assert doctest.testmod(contact) == (0, 6)

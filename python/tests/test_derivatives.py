"""Derivatives of solutions: against differences of solutions, against each other, and at exact kinks against closed forms."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import signorini as sg
from bodies import ROOT, bar, membrane, two_springs
from scipy import sparse
from test_many import family

STEP = 1e-5


def output(solution: sg.Solution, by: list[Any]) -> float:
    parts = (solution.u, solution.multiplier, solution.equality_multiplier)
    return float(sum(np.dot(one, value) for one, value in zip(by, parts, strict=True)))


def difference(make: Any, by: list[Any]) -> float:
    """The central difference of an output of the problem `make(t)` at t = 0."""
    above, below = (output(sg.solve(make(t)), by) for t in (STEP, -STEP))
    return (above - below) / (2 * STEP)


def random_changes(rng: np.random.Generator, n: int, m: int) -> tuple[Any, Any, Any, Any]:
    change = rng.standard_normal((n, n))
    return change + change.T, rng.standard_normal(n), rng.standard_normal((m, n)), rng.standard_normal(m)


def test_derivatives_by_all_data_are_those_of_differences() -> None:
    Ks, fs, Bs, gs = family(3)
    rng = np.random.default_rng(0)
    for K, f, B, g in list(zip(Ks, fs, Bs, gs, strict=True))[:8]:
        solution = sg.solve(sg.Problem(K, f, B, g))
        dK, df, dB, dg = random_changes(rng, len(f), len(g))
        by = [rng.standard_normal(len(f)), rng.standard_normal(len(g)), np.zeros(0)]
        backward = solution.vjp(by[0], by[1])
        assert backward.verdict == "proven" and backward.why == "" and not len(backward.rows_at_kink) and backward.error < 1e-12
        forward = solution.jvp(df, dg, dK, dB)
        assert forward.verdict == "proven" and np.array_equal(forward.left.displacement, forward.right.displacement)
        along = (backward.stiffness * dK).sum() + backward.load @ df + (backward.rows * dB).sum() + backward.gap @ dg
        assert np.isclose(along, by[0] @ forward.displacement + by[1] @ forward.multiplier, rtol=1e-10)
        exact = difference(lambda t: sg.Problem(K + t * dK, f + t * df, B + t * dB, g + t * dg), by)
        assert np.isclose(along, exact, rtol=1e-5)
        # Each alone.
        for change, value in (
            (lambda t: sg.Problem(K + t * dK, f, B, g), (backward.stiffness * dK).sum()),
            (lambda t: sg.Problem(K, f, B + t * dB, g), (backward.rows * dB).sum()),
        ):
            assert np.isclose(value, difference(change, by), rtol=1e-5, atol=1e-7)


def test_the_derivatives_by_the_stiffness_have_the_pattern_of_both_triangles() -> None:
    K, f, B, g = membrane(8)
    solution = sg.solve(sg.Problem(K, f, B, g))
    rng = np.random.default_rng(1)
    found = solution.vjp(rng.standard_normal(len(f)))
    of_stiffness, of_rows = found.stiffness, found.rows
    assert of_stiffness.shape == K.shape and of_stiffness.nnz == K.nnz and of_rows.nnz == B.nnz
    assert abs(of_stiffness - of_stiffness.T).max() == 0.0
    # An entry off the diagonal and its mirror image, moved together.
    dK = sparse.csc_array(([1.0, 1.0], ([9, 10], [10, 9])), shape=K.shape)
    along = found.load @ solution.jvp(stiffness=dK).displacement
    assert np.isfinite(along)
    tangent = solution.jvp(stiffness=dK)
    by = rng.standard_normal(len(f))
    assert np.isclose(2 * solution.vjp(by).stiffness[9, 10], by @ tangent.displacement, rtol=1e-9, atol=1e-15)


def test_equality_rows_have_derivatives() -> None:
    K, f, _, _ = bar(6)
    B, g = np.zeros((2, 6)), np.array([1.0, np.inf])
    B[0, 5] = B[1, 2] = 1.0
    E, e = np.zeros((1, 6)), np.array([0.25])
    E[0, 1], E[0, 3] = 1.0, -0.5
    solution = sg.solve(sg.Problem(K, f, B, g, E=E, e=e))
    rng = np.random.default_rng(2)
    by = [rng.standard_normal(6), rng.standard_normal(2), rng.standard_normal(1)]
    found = solution.vjp(*by)
    assert found.verdict == "proven" and found.gap[1] == 0.0 and found.equality_values.shape == (1,)
    df, dg, de = rng.standard_normal(6), np.array([0.7, 0.0]), np.array([-0.3])
    exact = difference(lambda t: sg.Problem(K, f + t * df, B, g + t * dg, E=E, e=e + t * de), by)
    along = found.load @ df + found.gap @ dg + found.equality_values @ de
    assert np.isclose(along, exact, rtol=1e-7)
    forward = solution.jvp(load=df, gap=dg, equality_values=de)
    by_tangent = by[0] @ forward.displacement + by[1] @ forward.multiplier + by[2] @ forward.equality_multiplier
    assert np.isclose(by_tangent, exact, rtol=1e-7)


def test_a_prepared_problem_gives_derivatives_at_the_gap_and_load_of_each_solution() -> None:
    K, f, B, g = membrane(12)
    problem = sg.Problem(K, f, B, g)
    prepared = sg.prepare(problem)
    by = np.cos(np.arange(len(f)))
    for gap, load in ((0.5 * g, f), (g, 1.7 * f), (0.8 * g, 0.9 * f)):
        own = prepared.solve(gap, load)
        alone = sg.solve(problem.replace(g=gap, f=load))
        found, expected = own.vjp(by), alone.vjp(by)
        assert found.verdict == expected.verdict == "proven"
        assert np.allclose(found.load, expected.load, rtol=1e-9, atol=1e-12)
        assert np.allclose(found.gap, expected.gap, rtol=1e-9, atol=1e-12)


def test_a_solution_on_a_path_has_the_derivatives_at_its_gap() -> None:
    K, f, B, g = bar(6)
    on_path = sg.prepare(sg.Problem(K, f, B, g)).path(g, 0.5 * g).solution(0.3)
    found = on_path.vjp(multiplier=[-1.0])
    # The force is 3 - g, and the stiffness of the bar is 1; a softer spring takes less.
    assert np.allclose(found.gap, [-1.0]) and found.verdict == "proven"
    first = sparse.csc_array(([1.0], ([0], [0])), shape=K.shape)
    assert np.isclose((found.stiffness * first).sum(), -0.85 / 6 / 6)


def test_solutions_without_a_proof_and_by_every_method_have_the_same_derivatives() -> None:
    K, f, B, g = membrane(12)
    problem, by = sg.Problem(K, f, B, g), np.ones(len(f))
    expected = sg.solve(problem).vjp(by)
    for options in ({"proof": False}, {"method": "qp"}, {"method": "mprgp"}, {"time": 5.0}):
        found = sg.solve(problem, **options).vjp(by)  # type: ignore[arg-type]
        assert found.verdict == "proven" and np.allclose(found.load, expected.load, rtol=1e-7, atol=1e-10)
    found = sg.compare(problem).active_set.vjp(by)
    assert np.allclose(found.load, expected.load, rtol=1e-9, atol=1e-12)


def test_a_scene_has_derivatives_by_its_gaps() -> None:
    scene = sg.Scene(ROOT / "examples" / "indentation.json")
    solution = scene.solve()
    # The contact force.
    found = solution.vjp(multiplier=-np.ones(len(solution.multiplier)))
    assert found.verdict == "proven"
    problem, step = scene.problem, 1e-7
    above, below = (sg.solve(problem.replace(g=problem.g + sign * step)).contact_force for sign in (1, -1))
    assert np.isclose(found.gap.sum(), (above - below) / (2 * step), rtol=1e-5)


def touching() -> sg.Problem:
    """The two springs with a wall that the end just touches, at 1.5."""
    return sg.Problem(np.array([[3.0, -1.0], [-1.0, 1.0]]), [0.0, 1.0], np.array([[0.0, 1.0]]), [1.5])


def test_a_kink_has_a_derivative_on_each_side_and_no_gradient() -> None:
    solution = sg.solve(touching())
    forward = solution.jvp(load=[0.0, 1.0])
    assert forward.verdict == "one-sided" and forward.rows_at_kink.tolist() == [0] and "row 0 " in forward.why
    assert np.allclose(forward.left.displacement, [0.5, 1.5]) and forward.left.multiplier.tolist() == [0.0]
    assert forward.right.displacement.tolist() == [0.0, 0.0] and np.allclose(forward.right.multiplier, [-1.0])
    backward = solution.vjp(displacement=[0.0, 1.0])
    assert backward.verdict == "undecided" and backward.rows_at_kink.tolist() == [0] and not forward.between
    opened, closed = backward.between
    assert np.allclose(opened.load, [0.5, 1.5]) and opened.gap.tolist() == [0.0]
    assert closed.load.tolist() == [0.0, 0.0] and np.allclose(closed.gap, [1.0])
    for read in (lambda: backward.load, lambda: backward.stiffness, lambda: forward.displacement, lambda: backward.error):
        with pytest.raises(sg.NoDerivative, match="row 0 ") as raised:
            read()
        assert raised.value.rows.tolist() == [0] and raised.value.verdict in ("undecided", "one-sided")
        assert raised.value.code == "no-derivative"


def test_a_row_too_near_to_a_kink_is_undecided_or_right() -> None:
    for exponent in range(30, 53):
        for sign in (-1, 1):
            gap = 1.5 + sign * 2.0**-exponent
            solution = sg.solve(touching().replace(g=[gap]))
            found = solution.jvp(load=[0.0, 1.0])
            assert found.verdict in ("proven", "undecided")
            if found.verdict == "proven":
                expected = [0.5, 1.5] if sign > 0 else [0.0, 0.0]
                assert np.allclose(found.displacement, expected, atol=1e-9)
            else:
                assert found.rows_at_kink.tolist() == [0] and len(found.between) == 2
                with pytest.raises(sg.NoDerivative):
                    found.left  # noqa: B018


def test_derivatives_of_nothing_are_zero() -> None:
    solution = sg.solve(two_springs())
    assert not solution.vjp().load.any() and not solution.jvp().displacement.any()
    free = sg.solve(sg.Problem(np.eye(2), [1.0, 2.0]))
    found = free.vjp([1.0, 0.0])
    assert found.load.tolist() == [1.0, 0.0] and found.gap.shape == (0,) and found.rows.shape == (0, 2)
    assert np.allclose(found.stiffness.toarray(), [[-1.0, 0.0], [0.0, 0.0]])


def test_the_answer_of_a_failed_solve_has_derivatives_of_its_problem_or_says_why_not() -> None:
    K, f, B, g = membrane(10)
    with pytest.raises(sg.NotCertified) as raised:
        sg.solve(sg.Problem(K, f, B, g), method="penalty", tolerance=1e-14)
    assert raised.value.solution.vjp(np.ones(len(f))).verdict in ("proven", "undecided", "unknown")
    many = sg.solve_many(K.toarray(), f, B.toarray(), g, method="penalty", tolerance=1e-14)
    error = many.errors[0]
    assert isinstance(error, sg.NotCertified)
    with pytest.raises(sg.BadInput, match="does not keep its problem"):
        error.solution.vjp()


def test_two_threads_may_ask_one_solution_at_once() -> None:
    from concurrent.futures import ThreadPoolExecutor

    K, f, B, g = membrane(20)
    solution = sg.solve(sg.Problem(K, f, B, g))
    with ThreadPoolExecutor(2) as pool:
        found = list(pool.map(lambda _: solution.vjp(np.ones(len(f))).load, range(4)))
    assert all(np.array_equal(found[0], other) for other in found)


def test_the_lines_of_the_page_on_derivatives_are_right() -> None:
    page = (ROOT / "docs" / "python.md").read_text()
    section = page.split("\n## Derivatives\n")[1].split("\n## ")[0]
    blocks = re.findall(r"```python\n(.*?)```", section, re.DOTALL)
    assert len(blocks) >= 3
    names: dict[str, Any] = {}
    compared = 0
    for block in blocks:
        if "import torch" in block or "import jax" in block:
            pytest.importorskip("torch" if "import torch" in block else "jax")
        for line in block.splitlines(keepends=True):
            code, _, shown = line.partition("  # ")
            if shown.startswith("= "):
                found = eval(code, names)
                values = [np.ravel(value) for value in (found if isinstance(found, tuple) else (found,))]
                assert np.allclose(np.concatenate(values), eval(shown[2:], names), atol=1e-12), line
                compared += 1
            elif shown.startswith("is "):
                assert eval(code, names) == eval(shown[3:], names), line
                compared += 1
            else:
                exec(line, names)
    assert compared >= 6

"""Quadratic programs in the form of qpsolvers, compared with its own problems, with closed forms and with other solvers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import signorini as sg
from scipy import sparse

qpsolvers = pytest.importorskip("qpsolvers")
from qpsolvers import problems  # noqa: E402

NAMES = [name for name in dir(problems) if name.startswith("get_") and name != "get_sparse_least_squares"]


def of_problem(problem: Any) -> tuple[Any, ...]:
    return problem.P, problem.q, problem.G, problem.h, problem.A, problem.b, problem.lb, problem.ub


def residuals(found: sg.qp.QPSolution, P: Any, q: Any, G: Any, h: Any, A: Any, b: Any, lb: Any, ub: Any) -> float:
    """Returns the largest residual of the optimality conditions of a quadratic program, in the signs of qpsolvers."""
    flat = lambda a: np.asarray(a, dtype=float).reshape(-1)  # noqa: E731
    rows = lambda a: a.toarray() if sparse.issparse(a) else np.atleast_2d(a)  # noqa: E731
    x = found.x
    assert x is not None
    force = rows(P).reshape(len(x), len(x)) @ x + flat(q)
    worst = []
    if G is not None:
        slack = flat(h) - rows(G) @ x
        force = force + rows(G).T @ found.z
        worst += [-slack.min(initial=0), -found.z.min(initial=0), np.abs(np.where(found.z > 0, found.z * slack, 0)).max(initial=0)]
    if A is not None:
        force = force + rows(A).T @ found.y
        worst.append(np.abs(rows(A) @ x - flat(b)).max(initial=0))
    if lb is not None or ub is not None:
        force = force + found.z_box
        low = np.full(len(x), -np.inf) if lb is None else flat(lb)
        high = np.full(len(x), np.inf) if ub is None else flat(ub)
        worst += [(low - x).max(), (x - high).max()]
        worst += [np.abs((x - low)[found.z_box < 0]).max(initial=0), np.abs((high - x)[found.z_box > 0]).max(initial=0)]
    scale = max(1.0, np.abs(flat(q)).max(initial=0), np.abs(rows(P)).max(initial=0))
    return max(float(np.abs(force).max(initial=0)) / scale, *[float(value) for value in worst], 0.0)


@pytest.mark.parametrize("name", NAMES)
def test_a_problem_of_qpsolvers_is_solved_to_its_known_answer(name: str) -> None:
    found = getattr(problems, name)()
    problem, known = found if isinstance(found, tuple) else (found, None)
    data = of_problem(problem)
    if known is not None and known.found is False:
        assert sg.qp.solve_qp(*data) is None
        return
    answer = sg.qp.solve_problem(*data)
    assert answer.found and answer.x is not None
    assert residuals(answer, *data) < 1e-8
    if known is not None and known.x is not None:
        # The known solutions are given to eight or nine digits.
        assert np.allclose(answer.x, known.x, rtol=1e-6, atol=2e-6)
    assert answer.unique and answer.certificate is not None and answer.certificate.meets(1e-9)


def test_sparse_least_squares_with_an_equality_and_bounds_are_solved() -> None:
    R, s, G, h, A, b, lb, ub = problems.get_sparse_least_squares(150)
    data = (sparse.csc_matrix(R.T @ R), -R.T @ s, G, h, A, b, lb, ub)
    answer = sg.qp.solve_problem(*data)
    assert residuals(answer, *data) < 1e-8
    assert abs(answer.x.sum() - 42.0) < 1e-9


def test_an_answer_with_every_kind_of_constraint_is_as_good_as_the_best_of_other_solvers() -> None:
    random = np.random.default_rng(7)
    others = [solver for solver in ("clarabel", "quadprog", "highs") if solver in qpsolvers.available_solvers]
    if not others:
        pytest.skip("no other solver is installed")
    for case in range(20):
        n, m, k = int(random.integers(3, 12)), int(random.integers(1, 8)), int(random.integers(1, 3))
        M = random.normal(size=(n, n))
        P, q = M @ M.T + 0.1 * np.eye(n), random.normal(size=n)
        inside = random.normal(size=n)
        G, A = random.normal(size=(m, n)), random.normal(size=(k, n))
        h, b = G @ inside + random.uniform(0, 1, m), A @ inside
        lb, ub = inside - random.uniform(0.1, 1, n), inside + random.uniform(0.1, 1, n)
        ub[0] = lb[0] = inside[0]
        lb[1] = -np.inf
        data = (P, q, G, h, A, b, lb, ub)
        answer = sg.qp.solve_problem(*data)
        assert residuals(answer, *data) < 1e-8, case
        least = min(
            0.5 * x @ P @ x + q @ x for x in (qpsolvers.solve_qp(*data, solver=solver) for solver in others) if x is not None
        )
        assert answer.obj <= least + 1e-6 * (1 + abs(least)), case


def test_the_multiplier_of_an_equality_has_the_sign_of_qpsolvers() -> None:
    for side in (1.0, -1.0):
        answer = sg.qp.solve_problem(np.eye(2), [0.0, 0.0], A=[[1.0, 0.0]], b=[side])
        assert np.allclose(answer.x, [side, 0.0], atol=1e-14) and np.allclose(answer.y, [-side], atol=1e-14)
        assert answer.z is None and answer.z_box is None and abs(answer.obj - 0.5) < 1e-14


def test_one_minimum_of_a_semidefinite_objective_is_found() -> None:
    # The minima of 1/2 (x_0 + x_1 - 2)^2 in the box form a line; the minimum of the linear program is a corner.
    P, q = np.ones((2, 2)), np.array([-2.0, -2.0])
    answer = sg.qp.solve_problem(P, q, lb=[0.0, 0.0], ub=[3.0, 3.0])
    assert abs(answer.x.sum() - 2.0) < 1e-9 and not answer.unique
    assert residuals(answer, P, q, None, None, None, None, np.zeros(2), np.full(2, 3.0)) < 1e-8
    corner = sg.qp.solve_problem(np.zeros((2, 2)), [1.0, -1.0], lb=[0.0, 0.0], ub=[3.0, 3.0])
    assert np.allclose(corner.x, [0.0, 3.0], atol=1e-9) and np.allclose(corner.z_box, [-1.0, 1.0], atol=1e-9)


@pytest.mark.parametrize("rank", [1, 3, 7])
def test_least_squares_without_full_rank_reach_the_least_residual(rank: int) -> None:
    random = np.random.default_rng(rank)
    R, s = random.normal(size=(rank, 8)), random.normal(size=rank)
    A, b = random.normal(size=(1, 8)), np.array([0.3])
    data = (R.T @ R, -R.T @ s, None, None, A, b, np.full(8, -1.0), np.full(8, 1.0))
    answer = sg.qp.solve_problem(*data)
    assert residuals(answer, *data) < 1e-8


@pytest.mark.parametrize("seed", range(100, 140))
def test_one_minimum_of_a_singular_matrix_with_contrast_is_found(seed: int) -> None:
    random = np.random.default_rng(seed)
    n = int(random.integers(5, 40))
    rank, m = int(random.integers(1, n)), int(random.integers(1, 30))
    R = random.normal(size=(rank, n)) * 10 ** random.uniform(-2, 2, size=(rank, 1))
    G, inside = random.normal(size=(m, n)), random.uniform(-1, 1, n)
    h = G @ inside + random.uniform(0, 1, m) * (random.random(m) < 0.5)
    data = (R.T @ R, R.T @ random.normal(size=rank), G, h, G[:1], G[:1] @ inside, None, None)
    answer = sg.qp.solve_problem(*data)
    assert residuals(answer, *data) < 1e-8
    assert answer.certificate.conditions_hold(1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_a_linear_program_has_the_minimum_of_the_simplex_method(seed: int) -> None:
    from scipy.optimize import linprog

    random = np.random.default_rng(seed)
    n, m = int(random.integers(2, 25)), int(random.integers(1, 25))
    G, inside, q = random.normal(size=(m, n)), random.uniform(-1, 1, n), random.normal(size=n)
    h = G @ inside + random.uniform(0, 1, m)
    answer = sg.qp.solve_problem(np.zeros((n, n)), q, G, h, lb=np.full(n, -2.0), ub=np.full(n, 2.0))
    least = linprog(q, G, h, bounds=[(-2, 2)] * n).fun
    assert abs(answer.obj - least) < 1e-8 * (1 + abs(least))


@pytest.mark.parametrize("seed", range(30))
def test_a_point_that_meets_the_constraints_is_found_if_the_objective_is_zero_there(seed: int) -> None:
    random = np.random.default_rng(seed)
    n, unit = int(random.integers(2, 9)), 10 ** random.uniform(-3, 3)
    p, m = int(random.integers(1, n)), int(random.integers(1, 2 * n))
    A, G, inside = random.normal(size=(p, n)), random.normal(size=(m, n)), unit * random.normal(size=n)
    h = G @ inside + unit * random.uniform(0, 1, m) * (random.random(m) < 0.5)
    one = np.zeros((n, n))
    one[0, 0] = 1.0
    for data in (
        (0 * one, np.zeros(n), None, None, A, A @ inside, None, None),
        (0 * one, np.zeros(n), G, h, A, A @ inside, None, None),
        (0 * one, np.zeros(n), None, None, A, A @ inside, inside - unit, inside + unit * (random.random(n) < 0.5)),
        (one, np.zeros(n), None, None, A[:1], A[:1] @ inside, None, None),
    ):
        answer = sg.qp.solve_problem(*data)
        assert residuals(answer, *data) < 1e-11 * max(1.0, unit) and abs(answer.obj) < 1e-20


def test_a_program_without_a_minimum_gives_none() -> None:
    assert sg.qp.solve_qp(np.eye(1), [0.0], G=[[1.0], [-1.0]], h=[-1.0, -1.0]) is None
    assert sg.qp.solve_qp(np.eye(2), [0.0, 0.0], A=[[1.0, 0.0], [1.0, 0.0]], b=[0.0, 1.0]) is None
    assert sg.qp.solve_qp(np.zeros((1, 1)), [1.0]) is None
    assert "infeasible" in sg.qp.solve_problem(np.eye(1), [0.0], lb=[1.0], ub=[0.0]).reason


def test_redundant_equalities_do_not_change_the_answer() -> None:
    A = [[1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 1.0]]
    answer = sg.qp.solve_problem(np.eye(3), [0.0, 0.0, 0.0], A=A, b=[1.0, 2.0, 5.0])
    assert np.allclose(answer.x, [0.5, 0.5, 5.0], atol=1e-12)


def test_invalid_programs_are_refused_with_a_message() -> None:
    for words, data in {
        "G is given without h": (np.eye(2), [0.0, 0.0], np.eye(2)),
        "b is given without A": (np.eye(2), [0.0, 0.0], None, None, None, [1.0]),
        "ask for 1 x 2": (np.eye(2), [0.0, 0.0], np.ones((1, 3)), [1.0]),
        "lb has length 3": (np.eye(2), [0.0, 0.0], None, None, None, None, [0.0] * 3),
        "not symmetric": (np.array([[1.0, 0.5], [0.0, 1.0]]), [0.0, 0.0]),
        "must be an array of real numbers": (np.eye(2), ["a", "b"]),
        "b has the value inf": (np.eye(2), [0.0, 0.0], None, None, np.eye(2), [0.0, np.inf]),
        "h has the value nan": (np.eye(2), [0.0, 0.0], np.eye(2), [0.0, np.nan]),
        "nothing meets": (np.eye(2), [0.0, 0.0], np.eye(2), [0.0, -np.inf]),
    }.items():
        with pytest.raises(sg.BadInput, match=words):
            sg.qp.solve_problem(*data)
    with pytest.raises(sg.NotConvex):
        sg.qp.solve_problem(-np.eye(2), [0.0, 0.0])

"""Independent solvers, one function each: from a dimensionless problem to an answer and the status they claim.

Only here a solver's sign is known: its multiplier z >= 0 of B u <= g is z = -lambda.
"""

import warnings
from dataclasses import dataclass
from functools import partial

import cvxpy
import numpy as np
import osqp
from scipy import sparse

from problem import Answer, Problem
from scaling import scaled, scales_of, unscaled

INTERIOR_POINT_TOLERANCES = (1e-13, 1e-12, 1e-10, 1e-8)
"""Tried in this order until Clarabel says it is solved. Asked for more than rounding allows, it goes back to an early
iterate: measured on the indented block, 1e-12 leaves 3e-10 in u, 1e-13 leaves 3e-3."""

FIRST_ORDER_TOLERANCE = 1e-12
"""Absolute and relative, on dimensionless data. Multipliers of a fine mesh are small there: 1e-9 leaves 3e-5 off."""

FIRST_ORDER_ITERATIONS = 20_000
"""The problems here need up to 2,200; at the limit the last iterate is judged as any other."""

OSQP_SETTINGS = dict(
    eps_abs=FIRST_ORDER_TOLERANCE,
    eps_rel=FIRST_ORDER_TOLERANCE,
    max_iter=FIRST_ORDER_ITERATIONS,
    # Polishing can report success with a wrong x (osqp#790); the answers are settled here instead.
    polishing=False,
    verbose=False,
)


@dataclass(frozen=True)
class Raw:
    """What a solver returned, in the units of the problem, with its own word for how it ended."""

    answer: Answer
    status: str


class NoAnswer(Exception):
    """A solver that returned no vector of finite numbers."""


def cvxpy_clarabel(problem: Problem) -> Raw:
    """cvxpy with Clarabel: interior point."""
    for tolerance in INTERIOR_POINT_TOLERANCES:
        tolerances = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), tolerance)
        raw = dimensionless(problem, partial(by_cvxpy, solver="CLARABEL", accept_unknown=True, **tolerances))
        if raw.status == cvxpy.OPTIMAL:
            break
    return raw


def cvxpy_osqp(problem: Problem) -> Raw:
    """cvxpy with OSQP: alternating directions."""
    return dimensionless(problem, partial(by_cvxpy, solver="OSQP", **OSQP_SETTINGS))


def osqp_direct(problem: Problem) -> Raw:
    """OSQP without a layer between; it reads the upper triangle of K."""
    return dimensionless(problem, by_osqp)


SOLVERS = {"cvxpy+Clarabel": cvxpy_clarabel, "cvxpy+OSQP": cvxpy_osqp, "osqp": osqp_direct}


def by_cvxpy(data: Problem, solver: str, **settings) -> Raw:
    """The quadratic program in cvxpy's words; the whole K, which is taken to be positive semidefinite."""
    u = cvxpy.Variable(data.dofs)
    energy = 0.5 * cvxpy.quad_form(u, cvxpy.psd_wrap(data.stiffness)) - data.load @ u
    apart = data.contact @ u <= data.gap
    program = cvxpy.Problem(cvxpy.Minimize(energy), [apart])
    with warnings.catch_warnings():
        # "Solution may be inaccurate": every answer is judged by its own numbers.
        warnings.simplefilter("ignore")
        try:
            program.solve(solver=solver, **settings)
        except cvxpy.error.SolverError as error:
            raise NoAnswer(str(error)) from error
    if u.value is None or apart.dual_value is None:
        raise NoAnswer(f"status {program.status}")
    return Raw(Answer(u.value, -apart.dual_value), program.status)


def by_osqp(data: Problem) -> Raw:
    """The quadratic program -inf <= B u <= g."""
    solver = osqp.OSQP()
    solver.setup(
        P=sparse.triu(data.stiffness, format="csc"),
        q=-data.load,
        A=data.contact.tocsc(),
        l=np.full(data.rows, -np.inf),
        u=data.gap,
        **OSQP_SETTINGS,
    )
    result = solver.solve(raise_error=False)
    return Raw(Answer(result.x, -result.y), result.info.status)


def dimensionless(problem: Problem, solve) -> Raw:
    """Scales, leaves out the rows without obstacle, solves and scales back."""
    bound, scales = problem.bound, scales_of(problem)
    data = scaled(problem, scales)
    raw = solve(Problem(data.stiffness, data.load, data.contact[bound], data.gap[bound]))
    multiplier = np.zeros(problem.rows)
    multiplier[bound] = raw.answer.multiplier
    answer = unscaled(Answer(raw.answer.displacement, multiplier), scales)
    if not (np.all(np.isfinite(answer.displacement)) and np.all(np.isfinite(multiplier))):
        raise NoAnswer(f"status {raw.status}, with numbers that are not finite")
    return Raw(answer, raw.status)

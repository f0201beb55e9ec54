"""Independent solvers, one function each. Each solves a dimensionless problem and returns its answer and its status.

The sign convention of the solvers is used only here: their multiplier z >= 0 of B u <= g is z = -lambda.
"""

import warnings
from dataclasses import dataclass
from functools import partial

import cvxpy
import numpy as np
import osqp
import signorini as sg
from scipy import sparse

from problem import Answer, Problem
from scaling import scaled, scales_of, unscaled

INTERIOR_POINT_TOLERANCES = (1e-13, 1e-12, 1e-10, 1e-8)
"""Tolerances that are tried in this order until Clarabel reports `Solved`. For a tolerance below rounding it returns an early iterate:
on the indented block the error in u is 3e-10 with 1e-12, and 3e-3 with 1e-13."""

FIRST_ORDER_TOLERANCE = 1e-12
"""Absolute and relative tolerance for dimensionless data. Multipliers of a fine mesh are small: 1e-9 would leave an error of 3e-5."""

FIRST_ORDER_ITERATIONS = 20_000
"""Limit of iterations. The problems here need up to 2,200; at the limit, the last iterate is judged like any other answer."""

OSQP_SETTINGS = dict(
    eps_abs=FIRST_ORDER_TOLERANCE,
    eps_rel=FIRST_ORDER_TOLERANCE,
    max_iter=FIRST_ORDER_ITERATIONS,
    # Polishing can report success for a wrong x (osqp#790), so that the answers are settled here instead.
    polishing=False,
    verbose=False,
)


@dataclass(frozen=True)
class Raw:
    """The answer of a solver in the units of the problem, and the status that the solver reports."""

    answer: Answer
    status: str


class NoAnswer(Exception):
    """A solver returned no vector of finite numbers."""


def cvxpy_clarabel(problem: Problem) -> Raw:
    """Solves by cvxpy with Clarabel, an interior-point method."""
    for tolerance in INTERIOR_POINT_TOLERANCES:
        tolerances = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), tolerance)
        raw = dimensionless(problem, partial(by_cvxpy, solver="CLARABEL", accept_unknown=True, **tolerances))
        if raw.status == cvxpy.OPTIMAL:
            break
    return raw


def cvxpy_osqp(problem: Problem) -> Raw:
    """Solves by cvxpy with OSQP, an alternating direction method."""
    return dimensionless(problem, partial(by_cvxpy, solver="OSQP", **OSQP_SETTINGS))


def osqp_direct(problem: Problem) -> Raw:
    """Solves by OSQP directly, which reads the upper triangle of K."""
    return dimensionless(problem, by_osqp)


SOLVERS = {"cvxpy+Clarabel": cvxpy_clarabel, "cvxpy+OSQP": cvxpy_osqp, "osqp": osqp_direct}


def by_cvxpy(data: Problem, solver: str, **settings) -> Raw:
    """Solves the quadratic program in the form of cvxpy, with the whole K, which is declared to be positive semidefinite."""
    u = cvxpy.Variable(data.dofs)
    energy = 0.5 * cvxpy.quad_form(u, cvxpy.psd_wrap(data.stiffness)) - data.load @ u
    apart = data.contact @ u <= data.gap
    program = cvxpy.Problem(cvxpy.Minimize(energy), [apart])
    with warnings.catch_warnings():
        # Warnings such as "Solution may be inaccurate" are not needed: every answer is judged by its own numbers.
        warnings.simplefilter("ignore")
        try:
            program.solve(solver=solver, **settings)
        except cvxpy.error.SolverError as error:
            raise NoAnswer(str(error)) from error
    if u.value is None or apart.dual_value is None:
        raise NoAnswer(f"status {program.status}")
    return Raw(Answer(u.value, -apart.dual_value), program.status)


def by_complementarity(problem: Problem) -> Raw:
    """Solves the complementarity problem of the contact forces, as the package makes it, by cvxpy with Clarabel.

    Without motions it is that of a quadratic program in z >= 0; the rows of the motions are its equalities, and their coordinates the
    multipliers.
    """
    lcp = sg.prepare(sg.Problem(problem.stiffness, problem.load, problem.contact, problem.gap)).delassus()
    m = len(lcp.rows)
    compliance, balance, gap, work = lcp.M[:m, :m], lcp.M[m:, :m], lcp.q[:m], -lcp.q[m:]
    unit = abs(compliance).max()
    force = max(abs(gap).max() / unit, abs(work).max(initial=0.0)) or 1.0
    z = cvxpy.Variable(m)
    constraints = [z >= 0] + ([balance @ z == work / force] if len(work) else [])
    energy = 0.5 * cvxpy.quad_form(z, cvxpy.psd_wrap(compliance / unit)) + (gap / (unit * force)) @ z
    program = cvxpy.Problem(cvxpy.Minimize(energy), constraints)
    for tolerance in INTERIOR_POINT_TOLERANCES:
        tolerances = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas"), tolerance)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            program.solve(solver="CLARABEL", accept_unknown=True, **tolerances)
        if program.status == cvxpy.OPTIMAL:
            break
    if z.value is None:
        raise NoAnswer(f"status {program.status}")
    forces, multiplier = force * z.value, np.zeros(problem.rows)
    multiplier[lcp.rows] = -forces
    motions = -unit * force * constraints[1].dual_value if len(work) else []
    return Raw(Answer(lcp.displacement(np.concatenate([forces, motions])), multiplier), program.status)


def by_osqp(data: Problem) -> Raw:
    """Solves the quadratic program with the constraints -inf <= B u <= g."""
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
    """Scales a problem, leaves out the rows without obstacle, solves it, and scales the answer back."""
    bound, scales = problem.bound, scales_of(problem)
    data = scaled(problem, scales)
    raw = solve(Problem(data.stiffness, data.load, data.contact[bound], data.gap[bound]))
    multiplier = np.zeros(problem.rows)
    multiplier[bound] = raw.answer.multiplier
    answer = unscaled(Answer(raw.answer.displacement, multiplier), scales)
    if not (np.all(np.isfinite(answer.displacement)) and np.all(np.isfinite(multiplier))):
        raise NoAnswer(f"status {raw.status}, with numbers that are not finite")
    return Raw(answer, raw.status)

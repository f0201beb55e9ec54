"""Slow and simple methods for small problems in dense numpy. They share no code with the solvers or with `settle`."""

from itertools import combinations

import numpy as np

from problem import Answer, Problem

SIGN_TOLERANCE = 1e-12
"""A slack or a multiplier below this share of the largest entry counts as zero."""

ENUMERATED_ROWS = 10
"""Largest number of rows for the enumeration, which solves 2^10 contact sets."""

LOOP_DOFS = 500
"""Largest number of dofs for dense solves, which then take milliseconds."""


class Cycled(Exception):
    """The active-set loop reached a contact set for the second time."""


def enumerate_contact_sets(problem: Problem) -> Answer:
    """Returns the solution among the points of all 2^rows contact sets: the one with the smallest violation of signs."""
    if problem.rows > ENUMERATED_ROWS:
        raise ValueError(
            f"{problem.rows} rows have too many contact sets; at most {ENUMERATED_ROWS} rows are enumerated"
        )
    least, best = np.inf, None
    for size in range(problem.rows + 1):
        for rows in combinations(range(problem.rows), size):
            answer = dense_point(problem, list(rows))
            if answer is not None and (violation := sign_violation(problem, answer)) < least:
                least, best = violation, answer
    if best is None or least > 1e-9:
        raise ValueError(f"no contact set gives a solution; the best violates a sign by {least:.1e}")
    return best


def active_set_loop(problem: Problem) -> Answer:
    """The classical loop C <- heaviside((I-C)(B u - g) - lambda), beginning with C = 0, or with all rows closed for a floating body.

    The loop has no safeguard against cycles. Raises `Cycled` if it does not end.
    """
    closed = np.zeros(problem.rows, bool)
    if dense_point(problem, []) is None:
        closed[problem.bound] = True
    met = set()
    while closed.tobytes() not in met:
        met.add(closed.tobytes())
        answer = dense_point(problem, np.flatnonzero(closed))
        if answer is None:
            raise Cycled(f"singular matrix with {closed.sum()} closed rows")
        penetration = -problem.slack(answer.displacement)
        length = np.max(np.abs(answer.displacement), initial=0.0)
        # The load is part of the scale: if the only multiplier is zero, its rounding error must not count as a force.
        force = max(np.max(np.abs(answer.multiplier), initial=0.0), np.max(np.abs(problem.load), initial=0.0))
        pressing = answer.multiplier < -SIGN_TOLERANCE * force
        following = np.where(closed, pressing, penetration > SIGN_TOLERANCE * length)
        if np.array_equal(following, closed):
            return answer
        closed = following
    raise Cycled(f"after {len(met)} contact sets")


def dense_point(problem: Problem, rows) -> Answer | None:
    """Returns the point of a contact set, which is given by its row indices, or `None` if its matrix is singular."""
    traces = problem.contact.toarray()[rows]
    count, n = len(traces), problem.dofs
    matrix = np.block([[problem.stiffness.toarray(), -traces.T], [traces, np.zeros((count, count))]])
    right = np.concatenate([problem.load, problem.gap[rows]])
    # Rows and columns are scaled to unit size, so that the condition number does not depend on units.
    scale = 1.0 / np.sqrt(np.maximum(np.abs(matrix).max(axis=0, initial=0.0), np.finfo(float).tiny))
    balanced = matrix * np.outer(scale, scale)
    if not np.all(np.isfinite(right)) or np.linalg.cond(balanced, 1) > 1e14:
        return None
    solution = scale * np.linalg.solve(balanced, scale * right)
    multiplier = np.zeros(problem.rows)
    multiplier[rows] = solution[n:]
    return Answer(solution[:n], multiplier)


def sign_violation(problem: Problem, answer: Answer) -> float:
    """Returns the largest penetration or pull, each relative to the largest entry of its kind."""
    traces = problem.contact @ answer.displacement
    length = np.max(np.abs(traces), initial=0.0) or 1.0
    force = max(np.max(np.abs(answer.multiplier), initial=0.0), np.max(np.abs(problem.load), initial=0.0)) or 1.0
    return max(np.max(traces - problem.gap, initial=0.0) / length, np.max(answer.multiplier, initial=0.0) / force)

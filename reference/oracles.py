"""Slow and obvious answers for small problems, in dense numpy; they share no code with the solvers or with `settle`."""

from itertools import combinations

import numpy as np

from problem import Answer, Problem

SIGN_TOLERANCE = 1e-12
"""Relative to the largest entry: below it a slack or a multiplier counts as zero."""

ENUMERATED_ROWS = 10
"""2^10 contact sets are solved in a moment."""

LOOP_DOFS = 500
"""Dense solves up to this size take milliseconds."""


class Cycled(Exception):
    """The active-set loop met a contact set for the second time."""


def enumerate_contact_sets(problem: Problem) -> Answer:
    """The solution among the points of all 2^rows contact sets: the one that violates its signs least."""
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
    """The classical loop C <- heaviside((I-C)(B u - g) - lambda) from C = 0; on a floating body from all rows closed.

    Raises `Cycled` where the plain loop does not end: it has no safeguard.
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
        # Beside the load: where the only multiplier is zero, rounding of it must not count as a force.
        force = max(np.max(np.abs(answer.multiplier), initial=0.0), np.max(np.abs(problem.load), initial=0.0))
        pressing = answer.multiplier < -SIGN_TOLERANCE * force
        following = np.where(closed, pressing, penetration > SIGN_TOLERANCE * length)
        if np.array_equal(following, closed):
            return answer
        closed = following
    raise Cycled(f"after {len(met)} contact sets")


def dense_point(problem: Problem, rows) -> Answer | None:
    """The point of a contact set given by its row indices; `None` where its matrix is singular."""
    traces = problem.contact.toarray()[rows]
    count, n = len(traces), problem.dofs
    matrix = np.block([[problem.stiffness.toarray(), -traces.T], [traces, np.zeros((count, count))]])
    right = np.concatenate([problem.load, problem.gap[rows]])
    # Rows and columns to a unit size, so that the condition number sees dependence and not units.
    scale = 1.0 / np.sqrt(np.maximum(np.abs(matrix).max(axis=0, initial=0.0), np.finfo(float).tiny))
    balanced = matrix * np.outer(scale, scale)
    if not np.all(np.isfinite(right)) or np.linalg.cond(balanced, 1) > 1e14:
        return None
    solution = scale * np.linalg.solve(balanced, scale * right)
    multiplier = np.zeros(problem.rows)
    multiplier[rows] = solution[n:]
    return Answer(solution[:n], multiplier)


def sign_violation(problem: Problem, answer: Answer) -> float:
    """The largest penetration or pull, each relative to the largest entry of its kind."""
    traces = problem.contact @ answer.displacement
    length = np.max(np.abs(traces), initial=0.0) or 1.0
    force = max(np.max(np.abs(answer.multiplier), initial=0.0), np.max(np.abs(problem.load), initial=0.0)) or 1.0
    return max(np.max(traces - problem.gap, initial=0.0) / length, np.max(answer.multiplier, initial=0.0) / force)

"""Computes the exact answer from an approximate one, by the linear system of a contact set.

    [ K   -B_C' ] [ u        ]   [ f   ]
    [ B_C   0   ] [ lambda_C ] = [ g_C ]      lambda = 0 elsewhere

The set C is that of a solver's answer. A point of this system is the solution only if no open row is penetrated and no closed row
pulls. Rows that fail are exchanged; their number is part of the result.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from kkt import length_scale, multiplier_scale, reject
from problem import Answer, Problem
from scaling import scaled, scales_of, unscaled

SIGN_TOLERANCE = 1e-11
"""Relative size below which a slack or a multiplier counts as zero. Otherwise rounding would make weakly active rows cycle."""

PATIENCE = 10
"""Number of exchanges of all failing rows at once that may pass without a new minimum of their number. After that, rows are exchanged
one by one."""

EXCHANGES = 2000
"""Largest number of linear solves; ten are usual."""


@dataclass(frozen=True)
class Settled:
    """An exact solution: its answer, its closed rows, and the number of exchanged rows."""

    answer: Answer
    closed: np.ndarray
    """The closed rows, as a boolean array of length rows."""
    exchanged: int


class Unsettled(Exception):
    """No solution was reached from a contact set."""


def contact_set(problem: Problem, answer: Answer) -> np.ndarray:
    """Returns the closed rows of an approximate answer, -lambda / max|lambda| > slack / max|B u|, as a boolean array of length rows.

    An absolute threshold on lambda would close far too many rows of an interior-point answer.
    """
    slack = problem.slack(answer.displacement)
    return -answer.multiplier * length_scale(problem, answer) > slack * multiplier_scale(problem, answer)


def solve_on(problem: Problem, closed: np.ndarray) -> Answer:
    """Solves the linear saddle-point system of a contact set by sparse LU with one step of refinement."""
    rows = np.flatnonzero(closed)
    traces = problem.contact[rows]
    system = sparse.block_array([[problem.stiffness, -traces.T], [traces, None]], format="csc")
    right = np.concatenate([problem.load, problem.gap[rows]])
    try:
        factors = splu(system)
    except RuntimeError as error:
        raise Unsettled(f"singular with {rows.size} closed rows") from error
    solution = factors.solve(right)
    solution += factors.solve(right - system @ solution)
    multiplier = np.zeros(problem.rows)
    multiplier[rows] = solution[problem.dofs :]
    return Answer(solution[: problem.dofs], multiplier)


def failing_rows(problem: Problem, answer: Answer, closed: np.ndarray) -> np.ndarray:
    """Returns the indices of the open rows that are penetrated and of the closed rows that pull, beyond rounding."""
    slack = problem.slack(answer.displacement)
    penetrated = ~closed & (slack < -SIGN_TOLERANCE * length_scale(problem, answer))
    pulling = closed & (answer.multiplier > SIGN_TOLERANCE * multiplier_scale(problem, answer))
    return np.flatnonzero(penetrated | pulling)


def settle(problem: Problem, start: np.ndarray) -> Settled:
    """Returns the solution reached from a contact set (boolean, length rows), verified with the original problem."""
    scales = scales_of(problem)
    data = scaled(problem, scales)
    closed = start & np.isfinite(problem.gap)
    fewest, patience = problem.rows + 1, PATIENCE
    for _ in range(EXCHANGES):
        answer = solve_on(data, closed)
        failing = failing_rows(data, answer, closed)
        if failing.size == 0:
            break
        if failing.size < fewest:
            fewest, patience = failing.size, PATIENCE
        else:
            patience -= 1
        # Exchange all rows at once while that helps, otherwise one by one, the last row first. This is finite for positive definite
        # problems.
        change = failing if patience > 0 else failing[-1:]
        closed = closed.copy()
        closed[change] ^= True
    else:
        raise Unsettled(f"no solution within {EXCHANGES} exchanges")
    answer = unscaled(answer, scales)
    reject(problem, answer)
    return Settled(answer, closed, int(np.count_nonzero(closed != start)))

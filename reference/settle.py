"""From an approximate answer to the exact one: the linear system of a contact set.

    [ K   -B_C' ] [ u        ]   [ f   ]
    [ B_C   0   ] [ lambda_C ] = [ g_C ]      lambda = 0 elsewhere

The set C is read off a solver's answer. A point of this system is the solution only if no open row is penetrated and
no closed row pulls; rows that fail are exchanged, and how many were is part of the result.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from kkt import length_scale, multiplier_scale, reject
from problem import Answer, Problem
from scaling import scaled, scales_of, unscaled

SIGN_TOLERANCE = 1e-11
"""Relative size below which a slack or a multiplier has no sign: weakly active rows cycle by rounding otherwise."""

PATIENCE = 10
"""Exchanges of all failing rows at once without a new lowest number of them, before single exchanges take over."""

EXCHANGES = 2000
"""Linear solves before giving up; ten are usual."""


@dataclass(frozen=True)
class Settled:
    """A true solution: its answer, its closed rows, and the rows that had to change to get there."""

    answer: Answer
    closed: np.ndarray
    """Boolean, length rows."""
    exchanged: int


class Unsettled(Exception):
    """A contact set from which no solution was reached."""


def contact_set(problem: Problem, answer: Answer) -> np.ndarray:
    """Closed rows of an approximate answer: -lambda / max|lambda| > slack / max|B u|; boolean, length rows.

    An absolute threshold on lambda closes far too many rows of an interior-point answer.
    """
    slack = problem.slack(answer.displacement)
    return -answer.multiplier * length_scale(problem, answer) > slack * multiplier_scale(problem, answer)


def solve_on(problem: Problem, closed: np.ndarray) -> Answer:
    """The linear saddle-point system of a contact set, by sparse LU with one step of refinement."""
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
    """Indices of open rows that are penetrated and closed rows that pull, beyond rounding."""
    slack = problem.slack(answer.displacement)
    penetrated = ~closed & (slack < -SIGN_TOLERANCE * length_scale(problem, answer))
    pulling = closed & (answer.multiplier > SIGN_TOLERANCE * multiplier_scale(problem, answer))
    return np.flatnonzero(penetrated | pulling)


def settle(problem: Problem, start: np.ndarray) -> Settled:
    """The solution reached from a contact set (boolean, rows), checked against the original problem."""
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
        # All at once while that helps, otherwise one by one, the last first: finite for positive definite problems.
        change = failing if patience > 0 else failing[-1:]
        closed = closed.copy()
        closed[change] ^= True
    else:
        raise Unsettled(f"no solution within {EXCHANGES} exchanges")
    answer = unscaled(answer, scales)
    reject(problem, answer)
    return Settled(answer, closed, int(np.count_nonzero(closed != start)))

"""Generated programs of model predictive control with empty rows of rounding size: the set `control` of foreign_qps.py.

A linear system x_(k+1) = F x_k + E u_k is brought towards a goal over N steps. The states are eliminated ("condensed"), so that the
inputs are the unknowns, P is dense and positive definite, and each limit C x_k + D u_k <= e_k is a row of G. At k = 0 the state is
given: if D = 0, the row is empty, and its h is e_0 - C x_0. The system of each program stands on such a limit, as a controller leaves
it there, so that rounding decides the sign of this h, such as -7e-18 beside entries of 1. Three in four are negative here: read to
the letter, the row 0 <= -7e-18 contradicts itself.

The form is that of the sets for model predictive control of qpbenchmark (walking, balancing); the systems and numbers are chosen here.

# Source
- S. Kajita et al., Biped walking pattern generation by using preview control of zero-moment point, ICRA 2003: the system `walk`.
- J. M. Maciejowski, Predictive Control with Constraints, Prentice Hall 2002, section 3.1: condensed programs.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from quadratic import Program, program


@dataclass(frozen=True)
class System:
    """x_(k+1) = F x_k + E u_k with the limits |C x_k + D u_k| <= e_k around a path; weights of state, final state and input."""

    F: np.ndarray
    E: np.ndarray
    C: np.ndarray
    D: np.ndarray
    steps: int
    state_weight: float
    final_weight: float
    input_weight: float
    reach: float
    """Size of the inputs of the path that the limits surround."""
    most_input: float
    """Bound on each input as lb and ub; infinite if there is none."""


def sampled(continuous: np.ndarray, inputs: np.ndarray, period: float) -> tuple[np.ndarray, np.ndarray]:
    """Returns F and E of dx/dt = M x + N u for inputs that are constant over each period."""
    n, m = inputs.shape
    both = expm(period * np.block([[continuous, inputs], [np.zeros((m, n + m))]]))
    return both[:n, :n], both[:n, n:]


def walk(random: np.random.Generator) -> System:
    """The cart on a table: position, velocity and acceleration of a walker, driven by jerk; its zero-moment point stays on the foot."""
    height, period = random.uniform(0.6, 1.0), 0.1
    F = np.array([[1.0, period, period**2 / 2], [0.0, 1.0, period], [0.0, 0.0, 1.0]])
    E = np.array([[period**3 / 6], [period**2 / 2], [period]])
    C = np.array([[1.0, 0.0, -height / 9.81]])
    return System(F, E, C, np.zeros((1, 1)), 16, 0.0, 1.0, 1e-3, 1.0, np.inf)


def balance(random: np.random.Generator) -> System:
    """An inverted pendulum on a wheel: position, lean and their rates, driven by the acceleration of the wheel; position and lean
    have limits."""
    length, period = random.uniform(0.4, 0.7), 0.02
    M = np.zeros((4, 4))
    M[0, 2] = M[1, 3] = 1.0
    M[3, 1] = 9.81 / length
    F, E = sampled(M, np.array([[0.0], [0.0], [1.0], [-1.0 / length]]), period)
    C = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
    return System(F, E, C, np.array([[0.0], [0.0], [1.0]]), 50, 1e-3, 1.0, 1e-3, 1.0, np.inf)


def masses(random: np.random.Generator) -> System:
    """Four masses between springs, with a force on the first and on the last one; every position has limits, forces have bounds."""
    count, period = 4, 0.25
    spring = random.uniform(0.5, 2.0)
    K = spring * (2 * np.eye(count) - np.eye(count, k=1) - np.eye(count, k=-1))
    M = np.block([[np.zeros((count, count)), np.eye(count)], [-K, -0.05 * np.eye(count)]])
    N = np.zeros((2 * count, 2))
    N[count, 0] = N[2 * count - 1, 1] = 1.0
    F, E = sampled(M, N, period)
    C = np.hstack([np.eye(count), np.zeros((count, count))])
    return System(F, E, C, np.zeros((count, 2)), 20, 1.0, 1.0, 0.1, 0.5, 0.8)


SYSTEMS = {"walk": walk, "balance": balance, "masses": masses}

ROUNDING = 1e-15
"""The h of an empty row is below this size at the limit on which the system stands."""


def condensed(name: str, system: System, start: np.ndarray, goal: np.ndarray, upper: np.ndarray, lower: np.ndarray) -> Program:
    """Returns the program for the inputs; upper and lower are limits on C x_k + D u_k, one row per step."""
    F, E, N = system.F, system.E, system.steps
    n, m = E.shape
    powers = [np.eye(n)]
    for _ in range(N):
        powers.append(F @ powers[-1])
    # x_k = powers[k] start + driven[k] u.
    driven = np.zeros((N + 1, n, N * m))
    for k in range(N):
        driven[k + 1] = F @ driven[k]
        driven[k + 1][:, k * m:(k + 1) * m] += E
    P, q = system.input_weight * np.eye(N * m), np.zeros(N * m)
    for k in range(1, N + 1):
        weight = system.final_weight if k == N else system.state_weight
        P += weight * driven[k].T @ driven[k]
        q += weight * driven[k].T @ (powers[k] @ start - goal)
    P = 0.5 * (P + P.T)
    rows, sides = [], []
    for k in range(N):
        limited = system.C @ driven[k]
        limited[:, k * m:(k + 1) * m] += system.D
        free = system.C @ (powers[k] @ start)
        rows += [limited, -limited]
        sides += [upper[k] - free, free - lower[k]]
    bounds = {}
    if np.isfinite(system.most_input):
        bounds = {"lb": np.full(N * m, -system.most_input), "ub": np.full(N * m, system.most_input)}
    return program(name, P, q, np.vstack(rows), np.concatenate(sides), **bounds)


def empty_rows(problem: Program) -> np.ndarray:
    """Returns the h of the rows of G without an entry."""
    return problem.h[~problem.G.any(axis=1)]


def path_of(system: System, start: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Returns C x_k + D u_k, one row per step, for inputs that run between random values, one every five steps."""
    steps, m = system.steps, system.E.shape[1]
    knots = np.arange(0, steps + 5, 5)
    values = np.clip(system.reach * random.standard_normal((len(knots), m)), -0.9 * system.most_input, 0.9 * system.most_input)
    inputs = np.column_stack([np.interp(np.arange(steps), knots, values[:, i]) for i in range(m)])
    state, met = start, []
    for given in inputs:
        met.append(system.C @ state + system.D @ given)
        state = system.F @ state + system.E @ given
    return np.array(met)


def limits_around(met: np.ndarray, random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Returns upper and lower limits that change every few steps, each a little farther from the path than it needs."""
    upper, lower, length = met.copy(), met.copy(), int(random.integers(3, 8))
    for first in range(0, len(met), length):
        part = slice(first, first + length)
        upper[part] = met[part].max(axis=0) + random.uniform(0.005, 0.05, met.shape[1])
        lower[part] = met[part].min(axis=0) - random.uniform(0.005, 0.05, met.shape[1])
    return upper, lower


def one(kind: str, number: int) -> Program:
    """Returns a program that a path meets by construction, up to the rounding of its empty rows: three in four are negative."""
    random = np.random.default_rng([5, list(SYSTEMS).index(kind), number])
    system = SYSTEMS[kind](random)
    n = len(system.F)
    while True:
        start, goal = 0.1 * random.standard_normal(n), np.zeros(n)
        goal[0] = start[0] + random.choice([-0.3, 0.3])
        upper, lower = limits_around(path_of(system, start, random), random)
        # The system stands on its first limit. The state that is measured has the rounding of other operations.
        upper[0, 0] = system.C[0] @ start
        start = start + random.integers(-1, 2, n) * np.spacing(np.abs(start))
        problem = condensed(f"{kind} {number}", system, start, goal, upper, lower)
        h = empty_rows(problem)
        wanted = (h < 0) if number % 4 else (h > 0)
        if np.any(wanted & (np.abs(h) < ROUNDING)) and not np.any(h < -ROUNDING):
            return problem


def control(count: int = 60) -> list[Program]:
    """Returns the programs of all systems by turns."""
    kinds = list(SYSTEMS)
    return [one(kinds[i % len(kinds)], i) for i in range(count)]

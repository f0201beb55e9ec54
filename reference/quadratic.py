"""A quadratic program in the form of qpsolvers, its residuals as qpbenchmark measures them, and the exact check of an answer.

    minimise 1/2 x'P x + q'x + constant   subject to   G x <= h,  A x = b,  lb <= x <= ub
    P x + q + G'z + A'y + z_box = 0,  z >= 0,  z_box <= 0 at lb and >= 0 at ub
"""

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

NO_BOUND = 1e20
"""Entries of h, lb and ub of at least this size bound nothing."""

KEYS = ("P", "q", "G", "h", "A", "b", "lb", "ub")


@dataclass(frozen=True)
class Program:
    """P is n x n, symmetric; G is m x n and A is k x n; all dense. G with h, A with b, lb and ub may be None."""

    name: str
    P: np.ndarray
    q: np.ndarray
    G: np.ndarray | None = None
    h: np.ndarray | None = None
    A: np.ndarray | None = None
    b: np.ndarray | None = None
    lb: np.ndarray | None = None
    ub: np.ndarray | None = None
    constant: float = 0.0
    minimum: Fraction | None = None
    """The least value of the objective with its constant, if it is known."""
    known: "Answer | None" = None
    """The only solution, if it is known."""
    is_solvable: bool = True
    """`False` if the constraints contradict each other or the objective has no lower bound."""

    @property
    def data(self) -> tuple:
        """P, q, G, h, A, b, lb, ub."""
        return tuple(getattr(self, key) for key in KEYS)

    def objective(self, x: np.ndarray) -> float:
        """Returns the objective at x with its constant."""
        return float(0.5 * x @ (self.P @ x) + self.q @ x + self.constant)


@dataclass(frozen=True)
class Answer:
    """x (length n), z (one entry per row of G), y (one per row of A), z_box (length n); empty where there are no such constraints."""

    x: np.ndarray
    z: np.ndarray
    y: np.ndarray
    z_box: np.ndarray


@dataclass(frozen=True)
class Residuals:
    """The residuals of an answer, absolute. An answer that has an entry without a value has infinite ones."""

    primal: float
    """Largest violation of a constraint."""
    dual: float
    """Largest entry of P x + q + G'z + A'y + z_box."""
    gap: float
    """|x'P x + q'x + h'z + b'y + lb'z_box^- + ub'z_box^+|."""
    sign: float
    """Largest multiplier with a wrong sign: an entry of z below 0, or of z_box towards a side without a bound. qpbenchmark has none."""

    def worst(self) -> float:
        """Returns the largest of all."""
        return max(self.primal, self.dual, self.gap, self.sign)


NONE = Residuals(np.inf, np.inf, np.inf, np.inf)


def program(name, P, q, G=None, h=None, A=None, b=None, lb=None, ub=None, **known) -> Program:
    """Returns a program from lists or arrays of any kind."""
    dense = lambda matrix: None if matrix is None else np.ascontiguousarray(matrix, dtype=np.float64)
    P, q, G, h, A, b, lb, ub = map(dense, (P, q, G, h, A, b, lb, ub))
    n = len(q)
    for rows, side, label in ((P, q, "P"), (G, h, "G"), (A, b, "A")):
        if (rows is None) != (side is None) or (rows is not None and rows.shape != (len(side), n)):
            raise ValueError(f"{name}: {label} has the shape {None if rows is None else rows.shape}, which does not fit its vector")
    return Program(name, P, q, G, h, A, b, lb, ub, **known)


def residuals(problem: Program, answer: Answer | None) -> Residuals:
    """Returns the residuals of an answer; infinite ones if there is none.

    # Source
    S. Caron et al., qpbenchmark, whose residuals are those of `qpsolvers.Solution`.
    """
    if answer is None:
        return NONE
    x, (P, q, G, h, A, b, lb, ub) = answer.x, problem.data
    primal, sign, force, gap = [0.0], [0.0], P @ x + q, x @ (P @ x) + q @ x
    if G is not None:
        bounds = np.abs(h) < NO_BOUND
        primal.append((G @ x - h)[bounds].max(initial=0.0))
        sign.append((-answer.z).max(initial=0.0))
        force, gap = force + G.T @ answer.z, gap + h[bounds] @ answer.z[bounds]
    if A is not None:
        primal.append(np.abs(A @ x - b).max(initial=0.0))
        force, gap = force + A.T @ answer.y, gap + b @ answer.y
    if lb is not None or ub is not None:
        force = force + answer.z_box
        for side, bound in ((-1.0, lb), (1.0, ub)):
            towards = np.maximum(side * answer.z_box, 0.0)
            bounds = np.zeros(len(x), bool) if bound is None else np.abs(bound) < NO_BOUND
            sign.append(towards[~bounds].max(initial=0.0))
            if bound is not None:
                primal.append((side * (x - bound))[bounds].max(initial=0.0))
                gap = gap + side * (bound[bounds] @ towards[bounds])
    found = [float(np.max(primal)), float(np.abs(force).max(initial=0.0)), float(abs(gap)), float(np.max(sign))]
    return Residuals(*found) if np.isfinite(found).all() else NONE


def exact(values: np.ndarray) -> np.ndarray:
    """Returns the same numbers as fractions."""
    numbers = [Fraction(value) if np.isfinite(float(value)) else value for value in np.asarray(values).ravel().tolist()]
    return np.array(numbers, dtype=object).reshape(np.shape(values))


def is_exact(problem: Program, answer: Answer) -> bool:
    """Returns `True` if the answer, as numbers without rounding, meets every optimality condition exactly."""
    P, q, G, h, A, b, lb, ub = (None if part is None else exact(part) for part in problem.data)
    x, z, y, z_box = map(exact, (answer.x, answer.z, answer.y, answer.z_box))
    force, fine = P.dot(x) + q, bool(np.all(P == P.T))
    if G is not None:
        slack, force = h - G.dot(x), force + G.T.dot(z)
        fine &= bool(np.all(slack >= 0) and np.all(z >= 0) and np.all(z * slack == 0))
    if A is not None:
        fine, force = fine and bool(np.all(A.dot(x) == b)), force + A.T.dot(y)
    if lb is not None or ub is not None:
        force = force + z_box
        for side, bound in ((-1, lb), (1, ub)):
            room = side * (bound - x) if bound is not None else np.full(len(x), Fraction(1), dtype=object)
            fine &= bool(np.all(room >= 0) and np.all((side * z_box <= 0) | (room == 0)))
    return fine and bool(np.all(force == 0))


def with_known(problem: Program, answer: Answer) -> Program:
    """Returns the program with its solution and minimum.

    # Errors
    `ValueError` if the answer does not meet every condition exactly.
    """
    if not is_exact(problem, answer):
        raise ValueError(f"{problem.name}: the answer is not exact")
    x, P, q = exact(answer.x), exact(problem.P), exact(problem.q)
    minimum = x.dot(P.dot(x)) / 2 + x.dot(q) + Fraction(problem.constant)
    return replace(problem, known=answer, minimum=minimum)


def solved_exactly(matrix: list[list[Fraction]], side: list[Fraction]) -> list[Fraction] | None:
    """Returns a solution of M v = s by elimination in fractions, free unknowns at 0; None if there is no solution."""
    rows = [row + [value] for row, value in zip(matrix, side)]
    width, pivots = len(matrix[0]), []
    for column in range(width):
        top = len(pivots)
        found = next((i for i in range(top, len(rows)) if rows[i][column]), None)
        if found is None:
            continue
        rows[top], rows[found] = rows[found], rows[top]
        pivot = [value / rows[top][column] for value in rows[top]]
        rows[top] = pivot
        for i, row in enumerate(rows):
            if i != top and row[column]:
                factor = row[column]
                rows[i] = [value - factor * other if other else value for value, other in zip(row, pivot)]
        pivots.append(column)
    if any(row[width] for row in rows[len(pivots):]):
        return None
    solution = [Fraction(0)] * width
    for row, column in zip(rows, pivots):
        solution[column] = row[width]
    return solution


def on_active_set(problem: Program, near: Answer, least: float = 1e-6) -> Answer | None:
    """Returns the solution in fractions for the constraints that bear a multiplier above `least` in an answer.

    It is a solution of the program only if `is_exact` says so. None if these constraints and P allow no solution.
    """
    n, (P, q, G, h, A, b, lb, ub) = len(problem.q), problem.data
    rows, side, kinds = [], [], []
    if G is not None:
        for i in np.flatnonzero(near.z > least):
            rows, side, kinds = rows + [G[i]], side + [h[i]], kinds + [("z", i, 1)]
    for i in range(0 if A is None else len(b)):
        rows, side, kinds = rows + [A[i]], side + [b[i]], kinds + [("y", i, 1)]
    for bound, sign in ((lb, -1), (ub, 1)):
        for i in [] if bound is None else np.flatnonzero(sign * near.z_box > least):
            rows, side, kinds = rows + [sign * np.eye(n)[i]], side + [sign * bound[i]], kinds + [("z_box", i, sign)]
    C = exact(np.array(rows).reshape(len(rows), n))
    top = [list(p) + list(c) for p, c in zip(exact(P), C.T if len(rows) else [[]] * n)]
    bottom = [list(c) + [Fraction(0)] * len(rows) for c in C]
    solution = solved_exactly(top + bottom, list(-exact(q)) + list(exact(np.array(side))))
    if solution is None:
        return None
    lengths = {"z": 0 if G is None else len(h), "y": 0 if A is None else len(b), "z_box": n}
    parts = {part: [Fraction(0)] * length for part, length in lengths.items()}
    for (part, i, sign), value in zip(kinds, solution[n:]):
        parts[part][i] += sign * value
    fractions = lambda values: np.array(values, dtype=object)
    return Answer(fractions(solution[:n]), *(fractions(parts[part]) for part in ("z", "y", "z_box")))

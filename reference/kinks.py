"""Small quadratic programs with exact answers, at and away from kinks, and their exact derivatives by rational arithmetic.

An answer u, lambda is drawn first, in eighths; K, B, f and g are then doubles without rounding. For the rows C that are held, a change of
load and gap along a parameter, df and dg, moves the answer by

    K du - B_C' dl = df,   B_C du = dg_C,

and an output phi with the derivatives a by u and c by lambda has the derivatives w by f and -nu by g:

    K w - B_C' nu = a,   B_C w = -c_C.

At a kink some rows are weak: gap and force are zero. The derivative to one side is that of the set of closed weak rows whose dl is not
positive, while B du <= dg on the open ones: all sets are tried.
"""

import itertools
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

MOST_ROWS = 6


@dataclass(frozen=True)
class Kink:
    """A problem whose exact answer is known, a change of load and gap, and the derivatives of an output by u and lambda: all doubles."""

    stiffness: np.ndarray
    load: np.ndarray
    contact: np.ndarray
    gap: np.ndarray
    closed: tuple[int, ...]
    """Rows that press."""
    weak: tuple[int, ...]
    """Rows whose gap and force are zero; none away from a kink."""
    change: tuple[np.ndarray, np.ndarray]
    """df and dg."""
    output: tuple[np.ndarray, np.ndarray]
    """a and c."""

    def gradient(self, with_weak: bool) -> tuple[np.ndarray, np.ndarray]:
        """Returns the derivatives of the output by load and gap with all weak rows open, or with all of them closed."""
        held = tuple(sorted(self.closed + self.weak)) if with_weak else self.closed
        by_u, by_lambda = self.output
        w, nu = self._held(held, by_u, -by_lambda)
        return _doubles(w), 0.0 - _doubles(nu)

    def along(self, sign: int) -> float:
        """Returns the derivative of the output for a parameter that grows (1) or falls (-1), by that parameter."""
        du, dl = self.one_sided(sign)
        by_u, by_lambda = (_exact(values) for values in self.output)
        return float(sum((a * d for a, d in zip((*by_u, *by_lambda), (*du, *dl), strict=True)), Fraction(0)))

    def one_sided(self, sign: int) -> tuple[list[Fraction], list[Fraction]]:
        """Returns the derivatives of u and lambda for a parameter that grows (1) or falls (-1), by that parameter."""
        load, gap = (sign * values for values in self.change)
        contact, distance = [_exact(row) for row in self.contact], _exact(gap)
        for count in range(len(self.weak) + 1):
            for some in itertools.combinations(self.weak, count):
                du, dl = self._held(tuple(sorted(self.closed + some)), load, gap)
                opens = (row for row in self.weak if row not in some)
                if all(dl[row] <= 0 for row in some) and all(_dot(contact[row], du) <= distance[row] for row in opens):
                    return [sign * value for value in du], [sign * value for value in dl]
        raise ArithmeticError("independent rows have a one-sided derivative")

    def _held(self, held: tuple[int, ...], load: np.ndarray, gap: np.ndarray) -> tuple[list[Fraction], list[Fraction]]:
        """Returns x (n) and y (m, zero on other rows) with K x - B_C' y = load, B_C x = gap_C for the rows `held`."""
        n, k = len(self.load), len(held)
        system = np.zeros((n + k, n + k))
        system[:n, :n] = self.stiffness
        system[:n, n:], system[n:, :n] = -self.contact[list(held)].T, self.contact[list(held)]
        found = solve([_exact(row) for row in system], _exact(np.concatenate([load, gap[list(held)]])))
        multiplier = [Fraction(0)] * len(self.gap)
        for row, value in zip(held, found[n:], strict=True):
            multiplier[row] = value
        return found[:n], multiplier


def _exact(values) -> list[Fraction]:
    return [Fraction(float(value)) for value in values]


def _doubles(values) -> np.ndarray:
    return np.array([float(value) for value in values])


def _dot(one: list[Fraction], other: list[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(one, other, strict=True)), Fraction(0))


def solve(matrix: list[list[Fraction]], right: list[Fraction]) -> list[Fraction]:
    """Returns the solution of a linear system, by elimination.

    # Errors
    `ArithmeticError` if the matrix is singular.
    """
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for column in range(len(rows)):
        pivot = next((row for row in range(column, len(rows)) if rows[row][column] != 0), None)
        if pivot is None:
            raise ArithmeticError("the matrix is singular")
        rows[column], rows[pivot] = rows[pivot], rows[column]
        for row in range(len(rows)):
            factor = rows[row][column] / rows[column][column]
            if row != column and factor != 0:
                rows[row] = [a - factor * b for a, b in zip(rows[row], rows[column], strict=True)]
    return [row[-1] / row[column] for column, row in enumerate(rows)]


def kink(random: np.random.Generator, at_kink: bool) -> Kink:
    """Returns a random problem: away from kinks every row has a gap or a force of an eighth or more; otherwise one or two rows are weak."""
    while True:
        n, m = int(random.integers(3, 9)), int(random.integers(2, MOST_ROWS + 1))
        factor = random.integers(-2, 3, (n, n)).astype(float)
        stiffness, contact = factor.T @ factor + np.eye(n), random.integers(-1, 2, (m, n)).astype(float)
        kinds = random.integers(0, 2, m)
        if at_kink:
            kinds[random.choice(m, size=int(random.integers(1, 3)), replace=False)] = 2
        closed, weak = (tuple(int(row) for row in np.flatnonzero(kinds == kind)) for kind in (0, 2))
        active = contact[list(closed + weak)]
        if len(active) and np.linalg.matrix_rank(active) < len(active):
            continue
        u = random.integers(-16, 17, n) / 8
        force = np.where(kinds == 0, -random.integers(1, 17, m) / 8, 0.0)
        gap = contact @ u + np.where(kinds == 1, random.integers(1, 17, m) / 8, 0.0)
        change = random.integers(-8, 9, n) / 8, random.integers(-8, 9, m) / 8
        output = random.integers(-8, 9, n) / 8, random.integers(-8, 9, m) / 8
        return Kink(stiffness, stiffness @ u - contact.T @ force, contact, gap, closed, weak, change, output)


def kinks(count: int, seed: int = 5) -> list[Kink]:
    """Returns `count` problems, every second one at a kink."""
    random = np.random.default_rng(seed)
    return [kink(random, at_kink=number % 2 == 1) for number in range(count)]

"""Generated quadratic programs with answers that are known exactly: the sets `singular` and `unsolvable` of foreign_qps.py, and those with
the shape of DUALC and QAFIRO in the set `typed`.

Everything is built from integers, so that doubles hold the data and the answer without rounding. First come the solution, the active
constraints and their multipliers, then P, then q = -(P x + G'z + A'y + z_box). `quadratic.with_known` checks every optimality
condition in fractions.
"""

from dataclasses import dataclass

import numpy as np

from quadratic import Answer, Program, program, with_known

PRIME = 2_147_483_629
"""Ranks are computed modulo this prime. They are at most the true ones, so that a full rank is proven."""


def rank(matrix: np.ndarray) -> int:
    """Returns the rank of a matrix of integers modulo PRIME, which is no larger than its rank."""
    rows = [[int(value) % PRIME for value in row] for row in matrix]
    found = 0
    for column in range(matrix.shape[1]):
        place = next((i for i in range(found, len(rows)) if rows[i][column]), None)
        if place is None:
            continue
        rows[found], rows[place] = rows[place], rows[found]
        inverse = pow(rows[found][column], -1, PRIME)
        rows[found] = [value * inverse % PRIME for value in rows[found]]
        for i in range(found + 1, len(rows)):
            factor = rows[i][column]
            if factor:
                rows[i] = [(value - factor * other) % PRIME for value, other in zip(rows[i], rows[found])]
        found += 1
    return found


@dataclass(frozen=True)
class Sizes:
    """What a program is built from."""

    unknowns: int
    equalities: int
    rows: int
    """Rows of G."""
    active: int
    """Rows of G that hold with equality at the solution; each has a multiplier above 0."""
    at_bound: int
    """Unknowns at one of their bounds; each has a multiplier other than 0. Without any, there are no bounds."""
    rank: int
    """Rank of P, below the number of unknowns."""
    density: float = 1.0
    """Share of entries other than 0 in R, G and A."""


def integers(random: np.random.Generator, shape: tuple[int, int], density: float = 1.0, most: int = 4) -> np.ndarray:
    """Returns a matrix of integers from -most to most; no row is empty if there are columns."""
    found = random.integers(-most, most + 1, shape) * (random.random(shape) < density)
    for row in np.flatnonzero(~found.any(axis=1)):
        found[row, random.integers(shape[1])] = 1
    return found


def made(name: str, sizes: Sizes, random: np.random.Generator) -> Program:
    """Returns a program with P = R'R singular, one solution, and one set of multipliers, all strict.

    R, A, the active rows of G and those of the bounds together have full column rank: P is positive definite on the null space of the
    active constraints, so that the solution is unique. These constraints have full row rank, so that the multipliers are.
    """
    n = sizes.unknowns
    while True:
        R = integers(random, (sizes.rank, n), sizes.density, most=3)
        G, A = integers(random, (sizes.rows, n), sizes.density), integers(random, (sizes.equalities, n), sizes.density)
        active = random.permutation(sizes.rows)[:sizes.active]
        bounded = random.permutation(n)[:sizes.at_bound]
        held = np.vstack([A, G[active], np.eye(n, dtype=int)[bounded]])
        if rank(held) == len(held) and rank(np.vstack([R, held])) == n:
            break
    x, P = random.integers(-5, 6, n), R.T @ R
    slack = random.integers(1, 10, sizes.rows)
    slack[active] = 0
    z = np.zeros(sizes.rows, dtype=int)
    z[active] = random.integers(1, 10, sizes.active)
    y, z_box = random.integers(-9, 10, sizes.equalities), np.zeros(n, dtype=int)
    lb, ub = x - random.integers(1, 10, n).astype(float), x + random.integers(1, 10, n).astype(float)
    lb[random.random(n) < 0.3], ub[random.random(n) < 0.3] = -np.inf, np.inf
    for i in bounded:
        side = random.choice([-1, 1])
        (lb if side < 0 else ub)[i] = x[i]
        z_box[i] = side * random.integers(1, 10)
    q = -(P @ x + G.T @ z + A.T @ y + z_box)
    constraints = {"G": G, "h": G @ x + slack} if sizes.rows else {}
    constraints |= {"A": A, "b": A @ x} if sizes.equalities else {}
    constraints |= {"lb": lb, "ub": ub} if sizes.at_bound else {}
    return with_known(program(name, P, q, **constraints), Answer(x, z, y, z_box))


def some_sizes(random: np.random.Generator, most: int = 40) -> Sizes:
    """Returns sizes at which P is singular and a solution can be unique."""
    n = int(random.integers(3, most + 1))
    rank_of_p = int(random.integers(1, n))
    held = int(random.integers(n - rank_of_p, n + 1))
    equalities = int(random.integers(1, max(held, 1) + 1))
    active = int(random.integers(0, held - equalities + 1))
    at_bound = held - equalities - active
    rows = active + int(random.integers(0, 2 * n))
    return Sizes(n, equalities, rows, active, at_bound, rank_of_p, float(random.choice([0.3, 0.6, 1.0])))


def singular(count: int = 100) -> list[Program]:
    """Returns convex programs of 3 to 40 unknowns with a singular P and equalities."""
    programs = []
    for number in range(count):
        random = np.random.default_rng([1, number])
        programs.append(made(f"singular {number}", some_sizes(random), random))
    return programs


def contradictory(name: str, random: np.random.Generator) -> Program:
    """Returns a program whose constraints contradict each other: y'A + z'G = 0 with z >= 0 and y'b + z'h = -gap < 0."""
    sizes = some_sizes(random, 20)
    base = made(name, sizes, random)
    n, m = len(base.q), int(random.integers(1, 4))
    G = np.zeros((0, n)) if base.G is None else base.G
    h = np.zeros(0) if base.h is None else base.h
    z, y = random.integers(1, 4, m), random.integers(-3, 4, len(base.b))
    more = integers(random, (m, n)).astype(float)
    last = -(z @ more + y @ base.A)
    side = random.integers(-5, 6, m).astype(float)
    G, h = np.vstack([G, more, last]), np.concatenate([h, side, [-(z @ side) - y @ base.b - random.integers(1, 6)]])
    return program(name, base.P, base.q, G, h, base.A, base.b, base.lb, base.ub, is_solvable=False)


def unbounded(name: str, random: np.random.Generator) -> Program:
    """Returns a feasible program whose objective falls without end along d: P d = 0, A d = 0, G d <= 0, q'd < 0, no bounds."""
    n = int(random.integers(4, 20))
    d = random.integers(-3, 4, n)
    d[random.integers(n)] = 1
    one = int(np.flatnonzero(d == 1)[0])

    def across(matrix: np.ndarray) -> np.ndarray:
        """Makes every row orthogonal to d by its entry at a place where d is 1."""
        matrix[:, one] -= matrix @ d
        return matrix

    R, A = across(integers(random, (int(random.integers(1, n - 1)), n))), across(integers(random, (int(random.integers(1, 4)), n)))
    G = across(integers(random, (int(random.integers(1, n)), n)))
    G[:, one] -= random.integers(0, 3, len(G))
    x, q = random.integers(-5, 6, n), integers(random, (1, n))[0]
    q[one] -= q @ d + random.integers(1, 6)
    return program(name, R.T @ R, q, G, G @ x + random.integers(0, 4, len(G)), A, A @ x, is_solvable=False)


def unsolvable(count: int = 40) -> list[Program]:
    """Returns programs that have no solution, with a singular P and equalities: contradictory and unbounded ones by turns."""
    kinds = (("contradictory", contradictory), ("unbounded", unbounded))
    return [kinds[i % 2][1](f"{kinds[i % 2][0]} {i}", np.random.default_rng([2, i])) for i in range(count)]


def dualc_like() -> list[Program]:
    """Returns programs with the shape of DUALC1, 2, 5 and 8: 7 to 9 unknowns in [0, 1], a sum of 1, hundreds of rows, P of 1e4.

    Here the unknowns lie in [0, 16] and have the sum 16, so that the solution consists of integers.
    """
    programs = []
    for number, (n, rows, active) in enumerate([(9, 214, 3), (7, 228, 2), (8, 277, 2), (8, 502, 3)]):
        random = np.random.default_rng([3, number])
        while True:
            R, G = random.integers(-30, 31, (n, n)), random.integers(-30, 31, (rows, n))
            held = np.vstack([np.ones((1, n), dtype=int), G[:active], np.eye(n, dtype=int)[:2]])
            if rank(R) == n and rank(held) == len(held):
                break
        x = np.zeros(n, dtype=int)
        x[2:] = 1 + random.multinomial(16 - (n - 2), np.ones(n - 2) / (n - 2))
        slack = random.integers(1, 100, rows)
        z, z_box = np.zeros(rows, dtype=int), np.zeros(n, dtype=int)
        slack[:active], z[:active], z_box[:2] = 0, random.integers(1, 200, active), -random.integers(1, 200, 2)
        y, order = random.integers(-1000, 1000, 1), random.permutation(rows)
        P = R.T @ R
        q = -(P @ x + G.T @ z + y + z_box)
        base = program(
            f"DUALC-like {number + 1}", P, q, G[order], (G @ x + slack)[order], np.ones((1, n)), [16], np.zeros(n), np.full(n, 16.0)
        )
        programs.append(with_known(base, Answer(x, z[order], y, z_box)))
    return programs


def qafiro_like() -> list[Program]:
    """Returns programs with the shape of QAFIRO: 32 unknowns >= 0, 8 equalities, 19 rows with few entries, P of rank 3."""
    programs = []
    for number in range(3):
        random = np.random.default_rng([4, number])
        while True:
            R = np.zeros((3, 32), dtype=int)
            R[:, :3] = integers(random, (3, 3))
            G, A = integers(random, (19, 32), 0.09), integers(random, (8, 32), 0.15)
            # Unknowns from 19 on are at their bound; 10 rows are active: 8 + 10 + 13 = 31 constraints for 32 unknowns.
            held = np.vstack([A, G[:10], np.eye(32, dtype=int)[19:]])
            if rank(held) == 31 and rank(np.vstack([R, held])) == 32:
                break
        x, z, z_box, slack = np.zeros(32, dtype=int), np.zeros(19, dtype=int), np.zeros(32, dtype=int), random.integers(1, 80, 19)
        x[:19], z[:10], z_box[19:], slack[:10] = random.integers(1, 90, 19), random.integers(1, 9, 10), -random.integers(1, 9, 13), 0
        y, P = random.integers(-9, 10, 8), R.T @ R
        q = -(P @ x + G.T @ z + A.T @ y + z_box)
        base = program(f"QAFIRO-like {number + 1}", P, q, G, G @ x + slack, A, A @ x, np.zeros(32), np.full(32, np.inf))
        programs.append(with_known(base, Answer(x, z, y, z_box)))
    return programs

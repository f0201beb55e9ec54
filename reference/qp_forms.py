"""Generated programs in the forms in which other fields write them: the set `forms` of foreign_qps.py.

Each has a singular P and equalities, except some of `portfolio` and `redundant`. There is no known answer; residuals are judged.

# Source
B. Stellato et al., OSQP: an operator splitting solver for quadratic programs, Math. Program. Comput. 12 (2020) 637-672, appendix A,
for lasso, Huber fitting, support vector machine, portfolio and control with states as unknowns. The sizes are smaller here.
"""

import numpy as np

from quadratic import Program, program

INF = np.inf


def sparse_normal(random: np.random.Generator, shape: tuple[int, int], density: float) -> np.ndarray:
    return random.standard_normal(shape) * (random.random(shape) < density)


def block_diagonal(*parts: np.ndarray) -> np.ndarray:
    found = np.zeros((sum(len(part) for part in parts),) * 2)
    at = 0
    for part in parts:
        found[at:at + len(part), at:at + len(part)] = part
        at += len(part)
    return found


def least_squares(name: str, random: np.random.Generator, n: int) -> Program:
    """|r|^2 / 2 with r = C x - d as unknowns beside x in bounds, as `qpsolvers.solve_ls` writes it for sparse C."""
    m = 2 * n
    C, d = sparse_normal(random, (m, n), 0.3), 5.0 * random.standard_normal(m)
    C[:n] += np.eye(n)
    A = np.hstack([C, -np.eye(m)])
    lb, ub = np.concatenate([np.full(n, -1.0), np.full(m, -INF)]), np.concatenate([np.full(n, 1.0), np.full(m, INF)])
    return program(name, block_diagonal(np.zeros((n, n)), np.eye(m)), np.zeros(n + m), None, None, A, d, lb, ub)


def lasso(name: str, random: np.random.Generator, n: int) -> Program:
    """|C x - d|^2 + l sum t with -t <= x <= t; unknowns x, the residual y, t."""
    m = 3 * n
    C = sparse_normal(random, (m, n), 0.5)
    d = C @ (random.standard_normal(n) * (random.random(n) < 0.5) / np.sqrt(n)) + random.standard_normal(m)
    weight = np.abs(C.T @ d).max() / 5
    I, zero = np.eye(n), np.zeros((n, m))
    P = block_diagonal(np.zeros((n, n)), 2 * np.eye(m), np.zeros((n, n)))
    q = np.concatenate([np.zeros(n + m), np.full(n, weight)])
    G = np.vstack([np.hstack([I, zero, -I]), np.hstack([-I, zero, -I])])
    return program(name, P, q, G, np.zeros(2 * n), np.hstack([C, -np.eye(m), np.zeros((m, n))]), d)


def huber(name: str, random: np.random.Generator, n: int) -> Program:
    """u'u + 2 sum (r + s) with C x - d - u = r - s, r >= 0, s >= 0; outliers count by their size, not by its square."""
    m = 3 * n
    C = sparse_normal(random, (m, n), 0.5)
    far = random.random(m) < 0.05
    d = C @ random.standard_normal(n) / np.sqrt(n) + np.where(far, random.uniform(0, 10, m), random.standard_normal(m) / 4)
    I = np.eye(m)
    P = block_diagonal(np.zeros((n, n)), 2 * I, np.zeros((2 * m, 2 * m)))
    q = np.concatenate([np.zeros(n + m), np.full(2 * m, 2.0)])
    lb = np.concatenate([np.full(n + m, -INF), np.zeros(2 * m)])
    return program(name, P, q, None, None, np.hstack([C, -I, -I, I]), d, lb, np.full(n + 3 * m, INF))


def support_vectors(name: str, random: np.random.Generator, n: int) -> Program:
    """x'x + l sum t with t >= diag(b) C x + 1, t >= 0; there are no equalities."""
    m = 4 * n
    b = np.where(np.arange(m) < m // 2, 1.0, -1.0)
    C = (random.standard_normal((m, n)) + b[:, None]) / np.sqrt(n) * (random.random((m, n)) < 0.5)
    P = block_diagonal(2 * np.eye(n), np.zeros((m, m)))
    q = np.concatenate([np.zeros(n), np.full(m, 0.5)])
    G = np.hstack([b[:, None] * C, -np.eye(m)])
    lb = np.concatenate([np.full(n, -INF), np.zeros(m)])
    return program(name, P, q, G, np.full(m, -1.0), lb=lb, ub=np.full(n + m, INF))


def portfolio(name: str, random: np.random.Generator, n: int) -> Program:
    """Risk x'D x + y'y less the return, with y = F'x, sum x = 1, x >= 0."""
    k = max(n // 5, 2)
    F, D = sparse_normal(random, (n, k), 0.5), np.diag(random.uniform(0, np.sqrt(k), n) * (random.random(n) < 0.5))
    A = np.vstack([np.concatenate([np.ones(n), np.zeros(k)]), np.hstack([F.T, -np.eye(k)])])
    lb = np.concatenate([np.zeros(n), np.full(k, -INF)])
    q = np.concatenate([-random.standard_normal(n), np.zeros(k)])
    return program(name, block_diagonal(2 * D, 2 * np.eye(k)), q, None, None, A, [1] + [0] * k, lb, np.full(n + k, INF))


def states(name: str, random: np.random.Generator, n: int) -> Program:
    """Control over ten steps with the states as unknowns; half of the states have no weight; bounds on states and inputs."""
    m, steps = max(n // 2, 1), 10
    F, E = np.eye(n) + 0.1 * random.standard_normal((n, n)), random.standard_normal((n, m))
    F /= max(1.0, np.abs(np.linalg.eigvals(F)).max())
    weight = np.where(np.arange(n) < (n + 1) // 2, random.uniform(0, 10, n), 0.0)
    P = block_diagonal(np.kron(np.eye(steps), np.diag(weight)), 0.1 * np.eye(steps * m))
    A = np.hstack([np.eye(steps * n) - np.kron(np.eye(steps, k=-1), F), -np.kron(np.eye(steps), E)])
    start = random.uniform(-0.5, 0.5, n)
    b = np.concatenate([F @ start, np.zeros((steps - 1) * n)])
    most = np.concatenate([np.full(steps * n, 1.0 + random.uniform()), np.full(steps * m, random.uniform(0.05, 0.1))])
    return program(name, P, np.zeros(steps * (n + m)), None, None, A, b, -most, most)


def redundant(name: str, random: np.random.Generator, n: int) -> Program:
    """A random program whose equalities and some rows occur again, or as sums, and which has fixed unknowns."""
    k, m, rank = max(n // 4, 1), n, max(n // 2, 1)
    R, A, G = random.standard_normal((rank, n)), random.integers(-3, 4, (k, n)), random.integers(-3, 4, (m, n))
    x = random.integers(-3, 4, n)
    A = np.vstack([A, A[:1], A.sum(axis=0)])
    G = np.vstack([G, 2 * G[: m // 2], A[:1]])
    lb, ub = x - random.integers(0, 3, n), x + random.integers(0, 3, n)
    h = G @ x + np.concatenate([np.repeat(0, m + m // 2), [0]])
    return program(name, R.T @ R, random.standard_normal(n), G, h, A, A @ x, lb, ub)


FORMS = {
    "least squares": (least_squares, (4, 20)), "lasso": (lasso, (4, 15)), "Huber": (huber, (3, 10)),
    "support vectors": (support_vectors, (4, 15)), "portfolio": (portfolio, (10, 60)), "states": (states, (2, 6)),
    "redundant": (redundant, (4, 20)),
}
"""The generator of each form, with its least and largest size."""


def forms(count: int = 70) -> list[Program]:
    """Returns the programs of all forms by turns."""
    programs, names = [], list(FORMS)
    for number in range(count):
        name = names[number % len(names)]
        generator, (least, most) = FORMS[name]
        random = np.random.default_rng([6, number])
        programs.append(generator(f"{name} {number}", random, int(random.integers(least, most + 1))))
    return programs

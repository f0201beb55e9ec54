"""Small quadratic programs typed from the literature, with their known minima: the `typed` set of foreign_qps.py.

# Source
- HS: W. Hock, K. Schittkowski, Test Examples for Nonlinear Programming Codes, Springer 1981, by number.
- HS268: K. Schittkowski, More Test Examples for Nonlinear Programming Codes, Springer 1987, number 268.
- The other names: I. Maros, C. Meszaros, A repository of convex quadratic programming problems, Optim. Methods Softw. 11 (1999)
  671-681, and the collection CUTEst, from which it took them.

A minimum with few digits in these sources stands here as the fraction that it abbreviates. `test_foreign_qps.py` proves each one:
the solution of the linear system on the active constraints is computed in fractions, and meets every optimality condition exactly.
"""

from fractions import Fraction

import numpy as np

from quadratic import Program, program

INF = np.inf


def squares(terms: list[tuple[list[float], float]], weights: list[float] | None = None) -> tuple[np.ndarray, np.ndarray, float]:
    """Returns P, q and the constant of sum_i w_i (a_i'x - c_i)^2 for a list of (a_i, c_i)."""
    a, c = np.array([row for row, _ in terms], dtype=float), np.array([side for _, side in terms], dtype=float)
    w = np.ones(len(c)) if weights is None else np.array(weights)
    return 2.0 * (a.T * w) @ a, -2.0 * a.T @ (w * c), float(w @ c**2)


def from_squares(name: str, terms, minimum, weights=None, **constraints) -> Program:
    P, q, constant = squares(terms, weights)
    return program(name, P, q, constant=constant, minimum=Fraction(minimum), **constraints)


def hs3() -> Program:
    """x2 + 1e-5 (x2 - x1)^2. P is singular and the minimum is at x2 = 0."""
    P = 2e-5 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return program("HS3", P, [0, 1], lb=[-INF, 0], ub=[INF, INF], minimum=Fraction(0))


def hs21() -> Program:
    return program(
        "HS21", np.diag([0.02, 2]), [0, 0], [[-10, 1]], [-10], lb=[2, -50], ub=[50, 50],
        constant=-100.0, minimum=Fraction("-99.96"),
    )


def hs28() -> Program:
    return from_squares("HS28", [([1, 1, 0], 0), ([0, 1, 1], 0)], 0, A=[[1, 2, 3]], b=[1])


def hs35(name: str = "HS35", lb=(0, 0, 0), ub=(INF, INF, INF), minimum=Fraction(1, 9)) -> Program:
    P = [[4, 2, 2], [2, 4, 0], [2, 0, 2]]
    return program(name, P, [-8, -6, -4], [[1, 1, 2]], [3], lb=lb, ub=ub, constant=9.0, minimum=minimum)


def hs35mod() -> Program:
    """HS35 with x2 fixed at 1/2."""
    return hs35("HS35MOD", lb=(0, 0.5, 0), ub=(INF, 0.5, INF), minimum=Fraction(1, 4))


def hs48() -> Program:
    terms = [([1, 0, 0, 0, 0], 1), ([0, 1, -1, 0, 0], 0), ([0, 0, 0, 1, -1], 0)]
    return from_squares("HS48", terms, 0, A=[[1, 1, 1, 1, 1], [0, 0, 1, -2, -2]], b=[5, -3])


def hs51_to_53(number: int, first: float, side: float, minimum, **bounds) -> Program:
    """(first x1 - x2)^2 + (x2 + x3 - 2)^2 + (x4 - 1)^2 + (x5 - 1)^2 with x1 + 3 x2 = side, x3 + x4 = 2 x5, x2 = x5."""
    terms = [([first, -1, 0, 0, 0], 0), ([0, 1, 1, 0, 0], 2), ([0, 0, 0, 1, 0], 1), ([0, 0, 0, 0, 1], 1)]
    A = [[1, 3, 0, 0, 0], [0, 0, 1, 1, -2], [0, 1, 0, 0, -1]]
    return from_squares(f"HS{number}", terms, minimum, A=A, b=[side, 0, 0], **bounds)


def hs76() -> Program:
    P = [[2, 0, -1, 0], [0, 1, 0, 0], [-1, 0, 2, 1], [0, 0, 1, 1]]
    G = [[1, 2, 1, 1], [3, 1, 2, -1], [0, -1, -4, 0]]
    return program("HS76", P, [-1, -3, 1, -1], G, [5, 4, -1.5], lb=np.zeros(4), minimum=Fraction(-103, 22))


def hs118() -> Program:
    """Five periods of three unknowns; each moves by at most so much per period, and each period needs a total."""
    P, q = np.diag(np.tile([2e-4, 2e-4, 3e-4], 5)), np.tile([2.3, 1.7, 2.2], 5)
    step = np.eye(12, 15, k=3) - np.eye(12, 15)
    total = -np.kron(np.eye(5), np.ones(3))
    G = np.vstack([step, -step, total])
    h = np.concatenate([np.tile([6, 7, 6], 4), np.full(12, 7), [-60, -50, -70, -85, -100]])
    lb, ub = np.zeros(15), np.tile([90.0, 120.0, 60.0], 5)
    lb[:3], ub[:3] = [8, 43, 3], [21, 57, 16]
    return program("HS118", P, q, G, h, lb=lb, ub=ub, minimum=Fraction("664.82045"))


def hs268() -> Program:
    """|D x - d|^2, entries of P up to 30,000. The last row is active at the minimum, with multiplier 0."""
    D = [[-74, 80, 18, -11, -4], [14, -69, 21, 28, 0], [66, -72, -5, 7, 1], [-12, 66, -30, -23, 3], [3, 8, -7, -4, 1], [4, -12, 4, 4, 0]]
    G = [[1, 1, 1, 1, 1], [-10, -10, 3, -5, -4], [8, -1, 2, 5, -3], [-8, 1, -2, -5, 3], [4, 2, -3, 5, -1]]
    return from_squares("HS268", list(zip(D, [51, -61, -56, 69, 10, -12])), 0, G=G, h=[5, -20, 40, -11, 30])


def genhs28() -> Program:
    """Ten unknowns; each sum of neighbours is squared, and each three in a row have a weighted sum of 1."""
    pairs = np.eye(9, 10) + np.eye(9, 10, k=1)
    A = np.eye(8, 10) + 2 * np.eye(8, 10, k=1) + 3 * np.eye(8, 10, k=2)
    return from_squares("GENHS28", [(row, 0) for row in pairs], Fraction(4596, 4957), A=A, b=np.ones(8))


def tame() -> Program:
    return from_squares("TAME", [([1, -1], 0)], 0, A=[[1, 1]], b=[1], lb=[0, 0])


def qptest() -> Program:
    """The objective of the source has the constant 4 as well, its printed minimum has not."""
    return program(
        "QPTEST", [[8, 2], [2, 10]], [1.5, -2], [[-2, -1], [-1, 2]], [-2, 6], lb=[0, 0], ub=[20, INF],
        minimum=Fraction("4.371875"),
    )


def zecevic2() -> Program:
    """2 x2^2 - 2 x1 - 3 x2. P is singular."""
    return program("ZECEVIC2", np.diag([0, 4]), [-2, -3], [[1, 1], [1, 4]], [2, 4], lb=[0, 0], ub=[10, 10], minimum=Fraction(-33, 8))


def lotschd() -> Program:
    """Times T1 to T6 and idle times U1 to U6 of a cyclic schedule, in the order T1, U1, T2, ...; the cost is sum (X_i T_i)^2."""
    cost = [1.502, 1.126, 0.815, 1.268, 1.502, 0.740]
    rate = [1.8, 3.2, 6.1, 3.2, 1.8, 7.4]
    # The slots whose time counts against the production in slot i, each with its number of occurrences in the source.
    against = [[], [2, 3], [3, 1, 2, 4, 5, 6], [4, 1, 5, 6], [1], [1, 2, 3, 4, 5]]
    A = np.zeros((7, 12))
    for slot in range(6):
        A[slot, 2 * slot] += rate[slot]
        A[slot, 2 * slot + 1] -= 1.0
        for other in against[slot]:
            A[slot, 2 * (other - 1):2 * other] -= 1.0
    A[6] = 1.0
    terms = [(np.eye(12)[2 * slot] * cost[slot], 0) for slot in range(6)]
    return from_squares("LOTSCHD", terms, LOTSCHD_MINIMUM, A=A, b=[11, 3, 20, 17, 9, 20, 126.1], lb=np.zeros(12))


LOTSCHD_MINIMUM = Fraction("2398.41583853174")
"""Computed in fractions. The source prints 2398.4159, whose relative difference is 3e-8."""


def problems() -> list[Program]:
    """Returns all typed problems."""
    return [
        hs3(), hs21(), hs28(), hs35(), hs35mod(), hs48(), hs51_to_53(51, 1, 4, 0), hs51_to_53(52, 4, 0, Fraction(1859, 349)),
        hs51_to_53(53, 1, 0, Fraction(176, 43), lb=np.full(5, -10.0), ub=np.full(5, 10.0)),
        hs76(), hs118(), hs268(), genhs28(), tame(), qptest(), zecevic2(), lotschd(),
    ]

"""Problems whose answers are known, for the tests of the package."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import signorini as sg
from scipy import sparse

ROOT = Path(__file__).resolve().parents[2]


def two_springs() -> sg.Problem:
    """Springs of stiffness 2 and 1 in a row. The end is pushed with force 3 against a wall at distance 1: u = (1/3, 1)."""
    return sg.Problem(np.array([[3.0, -1.0], [-1.0, 1.0]]), [0.0, 3.0], np.array([[0.0, 1.0]]), [1.0])


def membrane(cells: int) -> tuple[sparse.csc_matrix, np.ndarray, sparse.csc_matrix, np.ndarray]:
    """K, f, B and g of a square membrane that is fixed at its rim and pressed onto a plane: five-point stencil, one row per dof."""
    n = cells - 1
    line = sparse.diags_array([-np.ones(n - 1), 2 * np.ones(n), -np.ones(n - 1)], offsets=[-1, 0, 1])
    one = sparse.eye_array(n)
    stiffness = sparse.csc_matrix(sparse.kron(line, one) + sparse.kron(one, line))
    load = np.full(n * n, 8.0 / cells**2)
    return stiffness, load, sparse.csc_matrix(sparse.eye_array(n * n)), np.full(n * n, 0.2)


def bar(springs: int) -> tuple[sparse.csc_matrix, np.ndarray, sparse.csc_matrix, np.ndarray]:
    """K, f, B and g of `springs` springs of stiffness `springs` in a row, fixed at one end and pushed with force 3 at the other.

    The displacement of the pushed end is min(3, g).
    """
    n = springs
    diagonal = np.full(n, 2.0 * n)
    diagonal[-1] = n
    stiffness = sparse.diags_array([np.full(n - 1, -float(n)), diagonal, np.full(n - 1, -float(n))], offsets=[-1, 0, 1])
    load = np.zeros(n)
    load[-1] = 3.0
    return sparse.csc_matrix(stiffness), load, sparse.csc_matrix(([1.0], ([0], [n - 1])), shape=(1, n)), np.array([1.0])

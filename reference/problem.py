"""The contact problem and its files.

    minimise 1/2 u'K u - f'u   subject to   B u - g <= 0
    K u - f - B' lambda = 0,  B u - g <= 0,  lambda <= 0,  lambda_i (B u - g)_i = 0

A problem directory holds the Matrix Market files K.mtx, f.mtx, B.mtx and g.mtx.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import io, sparse


@dataclass(frozen=True)
class Problem:
    """A contact problem of `dofs` displacements and `rows` contact rows."""

    stiffness: sparse.csc_matrix
    """K, dofs x dofs, symmetric with both triangles stored, in N/m."""
    load: np.ndarray
    """f, length dofs, in N, along the axes."""
    contact: sparse.csr_matrix
    """B, rows x dofs, dimensionless, + towards the obstacle."""
    gap: np.ndarray
    """g, length rows, in m; negative if the obstacle starts inside the body, +inf if there is no obstacle."""

    def __post_init__(self):
        n, m = self.load.size, self.gap.size
        if self.stiffness.shape != (n, n) or self.contact.shape != (m, n):
            raise ValueError(
                f"K is {self.stiffness.shape}, B is {self.contact.shape}, but f has length {n} and g has length {m}"
            )
        if abs(self.stiffness - self.stiffness.T).max() > 0.0:
            raise ValueError("K is not symmetric")

    @property
    def dofs(self) -> int:
        return self.load.size

    @property
    def rows(self) -> int:
        return self.gap.size

    @property
    def bound(self) -> np.ndarray:
        """Returns the indices of the rows with an obstacle (a finite gap)."""
        return np.flatnonzero(np.isfinite(self.gap))

    def slack(self, displacement: np.ndarray) -> np.ndarray:
        """Returns the deformed gaps g - B u, length rows, in m; a negative value is a penetration."""
        return self.gap - self.contact @ displacement


@dataclass(frozen=True)
class Answer:
    """A displacement u (length dofs, m) and a multiplier lambda (length rows, N, <= 0 in compression)."""

    displacement: np.ndarray
    multiplier: np.ndarray

    @property
    def force(self) -> float:
        """Returns the total contact force -sum(lambda), in N, >= 0."""
        return 0.0 - float(self.multiplier.sum())


def problem_of(stiffness, load, contact, gap) -> Problem:
    """Makes a problem from matrices and vectors in any form that scipy and numpy accept."""
    stiffness = sparse.csc_matrix(stiffness, dtype=float)
    contact = sparse.csr_matrix(contact, dtype=float)
    stiffness.sort_indices()
    contact.sort_indices()
    return Problem(stiffness, np.asarray(load, float).ravel(), contact, np.asarray(gap, float).ravel())


def write_problem(problem: Problem, directory) -> None:
    """Writes a problem directory: K as its lower triangle, vectors as n x 1 arrays, all doubles with all digits."""
    folder = Path(directory)
    folder.mkdir(parents=True, exist_ok=True)
    io.mmwrite(folder / "K.mtx", problem.stiffness.tocoo(), symmetry="symmetric", precision=17)
    io.mmwrite(folder / "B.mtx", problem.contact.tocoo(), symmetry="general", precision=17)
    write_vector(folder / "f.mtx", problem.load)
    write_vector(folder / "g.mtx", problem.gap)


def write_vector(path, vector: np.ndarray) -> None:
    """Writes a vector as a Matrix Market array n x 1."""
    io.mmwrite(path, np.asarray(vector, float).reshape(-1, 1), symmetry="general", precision=17)

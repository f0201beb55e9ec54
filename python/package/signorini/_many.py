"""Many small problems of one size, solved at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini import _signorini
from signorini._errors import SignoriniError


@dataclass(frozen=True, repr=False)
class Solutions:
    """The answers of N problems with n dofs and m rows each. Arrays are read-only; a problem without an answer has NaN in its row."""

    u: NDArray[np.float64]
    """Displacements, N x n, in the unit of length."""
    multiplier: NDArray[np.float64]
    """Multipliers, N x m, <= 0 in compression, in the unit of force."""
    energy_error: NDArray[np.float64]
    """Bound on the error of each displacement in the energy norm, length N; inf without a bound."""
    energy_error_bound: NDArray[np.float64]
    """The same relative to the energy norm of the displacement, length N."""
    certified: NDArray[np.bool_]
    """`True` for each answer that is certified to the tolerance, length N."""
    proven_open: NDArray[np.bool_]
    """`True` for each row that is proven open in the exact answer, N x m."""
    proven_closed: NDArray[np.bool_]
    """The same for rows that are proven closed."""
    errors: dict[int, SignoriniError]
    """The exception that `signorini.solve` raises, by the number of each problem that has no certified answer, from 0."""

    def __repr__(self) -> str:
        return f"<signorini.Solutions: {len(self.u)} problems, {int(self.certified.sum())} certified>"


def solve_many(
    K: ArrayLike,
    f: ArrayLike,
    B: ArrayLike,
    g: ArrayLike,
    *,
    method: str | None = None,
    accuracy: float | str | None = None,
    time: float | None = None,
    threads: int | None = None,
    tolerance: float | None = None,
    proof: bool = True,
) -> Solutions:
    """Solves N problems of one size, each as `signorini.solve` does: minimise 1/2 u'K u - f'u  subject to  B u - g <= 0.

    K: N x n x n, symmetric, f: N x n, B: N x m x n, g: N x m; dense arrays. An array without its first axis is shared by all problems.
    threads: number of threads, shared out among the problems: those of the machine by default, 8 at most. They change no bit of the answers.
    time: limit in seconds for each problem. The other options are those of `signorini.solve`.

    A problem without a certified answer raises no exception: it has one in `errors`. Raises `BadInput` for arrays that do not fit each
    other, values of K or B that all problems share and that are no matrix, and options out of their range; `BadType` for an argument of a
    wrong type.
    """
    return Solutions(**_signorini._solve_many(K, f, B, g, method, accuracy, time, threads, tolerance, proof))

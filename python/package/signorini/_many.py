"""Many small problems of one size, solved at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini import _signorini
from signorini._errors import SignoriniError


@dataclass(frozen=True, repr=False)
class Solutions:
    """The solutions of N problems with n dofs and m rows each. Arrays are read-only. `signorini.solve_many` makes it.

    Attributes
    ----------
    u : array, shape (N, n)
        Displacements, in length. NaN for a problem without a solution.
    multiplier : array, shape (N, m)
        Contact multipliers, in force, <= 0 in compression. NaN for a problem without a solution.
    energy_error : array, shape (N,)
        Upper bound on the error of each displacement in the energy norm, in the root of force times length; `inf` if
        none is known.
    energy_error_bound : array, shape (N,)
        The same relative to the energy norm of the displacement.
    certified : array of bool, shape (N,)
        True for each solution that is certified to the tolerance.
    proven_open : array of bool, shape (N, m)
        True for each row that is proven open in the exact solution. All False with `proof=False`.
    proven_closed : array of bool, shape (N, m)
        True for each row that is proven closed in the exact solution. All False with `proof=False`.
    errors : dict of int to SignoriniError
        For each problem without a certified solution, by its number from 0: the exception of `signorini.solve`.
    """

    u: NDArray[np.float64]
    multiplier: NDArray[np.float64]
    energy_error: NDArray[np.float64]
    energy_error_bound: NDArray[np.float64]
    certified: NDArray[np.bool_]
    proven_open: NDArray[np.bool_]
    proven_closed: NDArray[np.bool_]
    errors: dict[int, SignoriniError]

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
    """Solves N problems of one size, each as `signorini.solve` does.

        minimise 1/2 u'K u - f'u  subject to  B u - g <= 0

    The arrays are dense. An array without its first axis is shared by all problems. Units are those of `Problem`.

    Parameters
    ----------
    K : array, shape (N, n, n) or (n, n)
        Stiffness, symmetric, with both triangles.
    f : array, shape (N, n) or (n,)
        Load.
    B : array, shape (N, m, n) or (m, n)
        Contact rows, positive towards the obstacle.
    g : array, shape (N, m) or (m,)
        Gaps; negative if the obstacle starts inside the body, `inf` for a row without an obstacle.
    threads : int, optional
        Number of threads, shared out among the problems. Those of the machine by default, at most 8. They change no bit
        of the solutions.
    time : float, optional
        Limit in seconds for each problem, positive. No limit by default.
    method, accuracy, tolerance, proof : optional
        As in `signorini.solve`.

    Returns
    -------
    Solutions
        One solution per problem. A problem without a certified solution raises no exception: `errors` has it.

    Raises
    ------
    BadInput
        The shapes do not fit each other, a shared K or B is no such matrix, or an option has a value that is not
        allowed.
    BadType or TypeError
        An argument has a wrong type.
    TooLarge
        There is no memory for the arrays.
    Interrupted
        Ctrl-C was pressed.
    """
    return Solutions(**_signorini._solve_many(K, f, B, g, method, accuracy, time, threads, tolerance, proof))

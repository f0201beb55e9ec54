"""Convex quadratic programs in the form of qpsolvers, certified.

    minimise 1/2 x'P x + q'x   subject to   G x <= h,  A x = b,  lb <= x <= ub

P is symmetric and positive semidefinite. Equalities are eliminated, and the certificate covers their residuals and
multipliers like those of any other row. If there are several minima, proximal steps find one of them. Its optimality
conditions are certified, but its distance to the other minima is not bounded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from signorini import _signorini
from signorini._errors import (
    BadInput,
    BadType,
    Infeasible,
    NotCertified,
    SignoriniError,
    Unbounded,
    Undecided,
    UnderHeld,
)

__all__ = ["QPSolution", "solve_problem", "solve_qp"]

# Largest number of proximal steps. For a quadratic program a few are enough.
_MOST_STEPS = 200

# Weights of the proximal term relative to the largest diagonal entry of P, in the order in which they are tried. A
# smaller weight needs fewer steps; a larger one makes each step more accurate.
_PROXIMITIES = (1e-8, 1e-6, 1e-4)

# Changes below this share of the largest unknown are rounding.
_MOVED = 1e-14

# Tolerance to which the conditions of a solution that is not unique are certified.
_TOLERANCE = 1e-9


@dataclass(frozen=True, repr=False)
class QPSolution:
    """The solution of a quadratic program, with the multipliers and signs of qpsolvers.

    They are those of P x + q + G'z + A'y + z_box = 0.

    Attributes
    ----------
    found : bool
        True if there is a solution. False if the constraints contradict each other or the objective has no lower bound;
        then all others are None, except `unique` and `reason`.
    x : array, shape (n,), or None
        The minimum.
    z : array, shape (m,), or None
        Multipliers of G x <= h, >= 0. None without G.
    y : array, shape (p,), or None
        Multipliers of A x = b, of either sign. None without A.
    z_box : array, shape (n,), or None
        Multipliers of the bounds: <= 0 at a lower bound, >= 0 at an upper bound. None without bounds.
    obj : float or None
        Value of the objective at x.
    certificate : Certificate or None
        The residuals of the optimality conditions, recomputed from the problem, and the bound on the error of x.
    unique : bool
        True if x is the only minimum and its error is bounded.
    reason : str
        One sentence that explains why there is no solution; empty if there is one.
    """

    found: bool
    x: NDArray[np.float64] | None
    z: NDArray[np.float64] | None
    y: NDArray[np.float64] | None
    z_box: NDArray[np.float64] | None
    obj: float | None
    certificate: _signorini.Certificate | None
    unique: bool
    reason: str

    def __repr__(self) -> str:
        if self.x is None:
            return f"<signorini.qp.QPSolution: {self.reason}>"
        return f"<signorini.qp.QPSolution: {len(self.x)} unknowns, objective {self.obj:.9g}, {self.certificate!r}>"


def solve_qp(
    P: Any,
    q: Any,
    G: Any = None,
    h: Any = None,
    A: Any = None,
    b: Any = None,
    lb: Any = None,
    ub: Any = None,
    **options: Any,
) -> NDArray[np.float64] | None:
    """Solves a quadratic program, as `qpsolvers.solve_qp` does.

        minimise 1/2 x'P x + q'x  subject to  G x <= h,  A x = b,  lb <= x <= ub

    Parameters
    ----------
    P : matrix, shape (n, n)
        Symmetric and positive semidefinite: an array of numpy or a sparse matrix of scipy.
    q : array, shape (n,)
        Linear part of the objective.
    G : matrix, shape (m, n), optional
        Rows of the inequalities.
    h : array, shape (m,), optional
        Right-hand sides of the inequalities. From 1e20 on there is no constraint.
    A : matrix, shape (p, n), optional
        Rows of the equalities.
    b : array, shape (p,), optional
        Right-hand sides of the equalities, finite.
    lb : array, shape (n,), optional
        Lower bounds. At -1e20 and below there is no bound.
    ub : array, shape (n,), optional
        Upper bounds. From 1e20 on there is no bound.
    **options
        `initvals`, and options of `signorini.solve`, as in `solve_problem`.

    Returns
    -------
    array, shape (n,), or None
        The minimum x; None if there is no solution.

    Raises
    ------
    SignoriniError, TypeError or Interrupted
        As `solve_problem`.
    """
    return solve_problem(P, q, G, h, A, b, lb, ub, **options).x


def solve_problem(
    P: Any,
    q: Any,
    G: Any = None,
    h: Any = None,
    A: Any = None,
    b: Any = None,
    lb: Any = None,
    ub: Any = None,
    *,
    initvals: Any = None,
    **options: Any,
) -> QPSolution:
    """Solves a quadratic program, and returns its multipliers and its certificate too.

        minimise 1/2 x'P x + q'x  subject to  G x <= h,  A x = b,  lb <= x <= ub

    Parameters
    ----------
    P : matrix, shape (n, n)
        Symmetric and positive semidefinite: an array of numpy or a sparse matrix of scipy.
    q : array, shape (n,)
        Linear part of the objective.
    G : matrix, shape (m, n), optional
        Rows of the inequalities.
    h : array, shape (m,), optional
        Right-hand sides of the inequalities. From 1e20 on there is no constraint.
    A : matrix, shape (p, n), optional
        Rows of the equalities.
    b : array, shape (p,), optional
        Right-hand sides of the equalities, finite.
    lb : array, shape (n,), optional
        Lower bounds. At -1e20 and below there is no bound.
    ub : array, shape (n,), optional
        Upper bounds. From 1e20 on there is no bound.
    initvals : array, shape (n,), optional
        A point near the minimum, where the method starts.
    **options
        Options of `signorini.solve`, such as `tolerance` or `time`; but neither `start` nor `proof`.

    Returns
    -------
    QPSolution
        A program without a solution is no exception: `found` is then False, and `reason` says why.

    Raises
    ------
    BadInput
        The arrays form no quadratic program, or an option has a value that is not allowed.
    BadType or TypeError
        An argument has a wrong type.
    NotConvex
        P has a negative eigenvalue.
    NotCertified
        The tolerance is not reached. The exception carries the best solution.
    Undecided
        It could not be decided whether there is a minimum.
    SignoriniError or Interrupted
        As `signorini.solve`.
    """
    load = -_vector("q", q)
    rows = _Rows(load.size)
    if np.ndim(P) == 1 and np.size(P) == load.size == 1:
        P = np.reshape(P, (1, 1))
    rows.add("G", "h", G, h)
    rows.add_equalities(A, b)
    rows.add_bounds(lb, ub)
    problem = rows.problem(P, load)
    start = None if initvals is None else _vector("initvals", initvals)
    try:
        solution = _signorini.solve(problem, start=start, proof=False, **options)
        return rows.answer(problem, solution.u, _forces(solution), solution.certificate, unique=True)
    except (Infeasible, Unbounded) as error:
        return QPSolution(False, None, None, None, None, None, None, False, str(error))
    except UnderHeld:
        return _one_of_many(problem, rows, start, options)
    except (NotCertified, Undecided) as fell_short:
        # Without an error bound only the conditions can be certified. If they fail as well, the minimum is almost not
        # unique, and proximal steps are tried.
        best = fell_short.solution if isinstance(fell_short, NotCertified) else None
        if best is not None and best.certificate.conditions_hold(_TOLERANCE):
            return rows.answer(problem, best.u, _forces(best), best.certificate, unique=False)
        try:
            return _one_of_many(problem, rows, start, options)
        except SignoriniError:
            raise fell_short from None


def _vector(name: str, values: Any) -> NDArray[np.float64]:
    """Returns a vector of doubles; a matrix with one column is accepted as well."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise BadType(f"{name} is an array of dtype {array.dtype}; it must be an array of real numbers")
    return np.ascontiguousarray(array, dtype=np.float64).reshape(-1)


# Up to this number of entries rows of bounds are dense: a sparse matrix of scipy takes longer to make.
_FEW_ENTRIES = 10_000


def _unit_rows(columns: NDArray[np.int64], value: float, unknowns: int) -> Any:
    """Returns a matrix with one entry in each row, in these columns."""
    places = np.arange(len(columns))
    if len(columns) * unknowns > _FEW_ENTRIES:
        from scipy import sparse

        return sparse.csr_array((np.full(len(columns), value), (places, columns)), shape=(len(columns), unknowns))
    rows = np.zeros((len(columns), unknowns))
    rows[places, columns] = value
    return rows


def _is_sparse(matrix: Any) -> bool:
    return hasattr(matrix, "tocsc")


class _Rows:
    """The rows B x <= g and E x = e of a contact problem that represent the constraints of a quadratic program."""

    def __init__(self, unknowns: int) -> None:
        self.unknowns = unknowns
        self.matrices: list[Any] = []
        self.gaps: list[NDArray[np.float64]] = []
        self.groups: dict[str, tuple[int, int]] = {}
        self.count = 0
        self.equalities: tuple[Any, Any] = (None, None)
        self.has_box = False
        self.P: Any = None
        self.lower = self.upper = np.empty(0, dtype=np.int64)

    def _append(self, name: str, matrix: Any, gap: NDArray[np.float64]) -> None:
        self.groups[name] = (self.count, self.count + len(gap))
        self.count += len(gap)
        self.matrices.append(matrix)
        self.gaps.append(gap)

    def add(self, name: str, side_name: str, matrix: Any, side: Any) -> None:
        """Adds `matrix x <= side`."""
        checked = self._checked(name, side_name, matrix, side)
        if checked is not None:
            self._append(name, checked[0], _gaps(side_name, checked[1]))

    def add_equalities(self, A: Any, b: Any) -> None:
        """Adds `A x = b`."""
        checked = self._checked("A", "b", A, b)
        if checked is None:
            return
        if not np.isfinite(checked[1]).all():
            entry = int(np.flatnonzero(~np.isfinite(checked[1]))[0])
            raise BadInput(f"b has the value {checked[1][entry]} at entry {entry} (from 0); it must be finite")
        self.equalities = checked

    def _checked(self, name: str, side_name: str, matrix: Any, side: Any) -> tuple[Any, NDArray[np.float64]] | None:
        """Returns a matrix and its sides if their shapes fit; None if neither is given."""
        if matrix is None and side is None:
            return None
        if matrix is None or side is None:
            given, missing = (side_name, name) if matrix is None else (name, side_name)
            raise BadInput(f"{given} is given without {missing}; every row of {name} needs an entry of {side_name}")
        if not _is_sparse(matrix):
            matrix = np.asarray(matrix)
            if matrix.dtype.kind not in "fiub":
                raise BadType(f"{name} is an array of dtype {matrix.dtype}; it must be a matrix of real numbers")
            matrix = np.atleast_2d(matrix).astype(np.float64)
        values = _vector(side_name, side)
        if matrix.shape != (len(values), self.unknowns):
            raise BadInput(
                f"{name} is {matrix.shape[0]} x {matrix.shape[1]}; {side_name} and q ask for {len(values)} x {self.unknowns}"
            )
        return matrix, values

    def add_bounds(self, lb: Any, ub: Any) -> None:
        """Adds one row for each finite bound."""
        self.has_box = lb is not None or ub is not None
        for name, bound, sign in (("ub", ub, 1.0), ("lb", lb, -1.0)):
            if bound is None:
                continue
            values = _vector(name, bound)
            if len(values) != self.unknowns:
                raise BadInput(f"{name} has length {len(values)}; there are {self.unknowns} unknowns")
            values = _gaps(name, sign * values)
            bounded = np.flatnonzero(np.isfinite(values))
            self._append(name, _unit_rows(bounded, sign, self.unknowns), values[bounded])
            if name == "ub":
                self.upper = bounded
            else:
                self.lower = bounded

    def problem(self, P: Any, load: NDArray[np.float64]) -> _signorini.Problem:
        """Returns the contact problem with these rows."""
        E, e = self.equalities
        self.P = P
        if self.count == 0:
            return _signorini.Problem(P, load, E=E, e=e)
        B: Any
        if any(_is_sparse(matrix) for matrix in self.matrices):
            from scipy import sparse

            B = sparse.csc_array(sparse.vstack([sparse.csr_array(matrix) for matrix in self.matrices], format="csc"))
        else:
            B = np.concatenate(self.matrices)
        return _signorini.Problem(P, load, B, np.concatenate(self.gaps), E=E, e=e)

    def _of(self, name: str, multiplier: NDArray[np.float64]) -> NDArray[np.float64]:
        first, end = self.groups[name]
        # A minus sign alone would turn 0.0 into -0.0.
        return 0.0 - multiplier[first:end]

    def answer(
        self,
        problem: _signorini.Problem,
        u: NDArray[np.float64],
        forces: tuple[NDArray[np.float64], NDArray[np.float64]],
        certificate: _signorini.Certificate,
        *,
        unique: bool,
    ) -> QPSolution:
        """Converts a solution, with the multipliers of all rows, into the signs of qpsolvers."""
        x, (multiplier, of_equalities) = u.copy(), forces
        z = self._of("G", multiplier) if "G" in self.groups else None
        y = None if self.equalities[0] is None else 0.0 - of_equalities
        z_box = None
        if self.has_box:
            z_box = np.zeros(self.unknowns)
            if "ub" in self.groups:
                z_box[self.upper] += self._of("ub", multiplier)
            if "lb" in self.groups:
                z_box[self.lower] -= self._of("lb", multiplier)
        if isinstance(self.P, np.ndarray):
            force = np.asarray(self.P) @ x
        else:
            force = (self.P if _is_sparse(self.P) else problem.K) @ x
        objective = float(0.5 * x @ force - problem.f @ x)
        return QPSolution(True, x, z, y, z_box, objective, certificate, unique, "")


def _gaps(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns right-hand sides in which values of 1e20 and more, which other solvers use for "no constraint", are inf."""
    if np.isnan(values).any():
        entry = int(np.flatnonzero(np.isnan(values))[0])
        raise BadInput(f"{name} has the value nan at entry {entry} (from 0)")
    if np.isneginf(values).any():
        entry = int(np.flatnonzero(np.isneginf(values))[0])
        raise BadInput(f"{name} has an infinite value at entry {entry} (from 0) that nothing meets")
    return np.where(values >= 1e20, np.inf, values)


def _one_of_many(problem: _signorini.Problem, rows: _Rows, start: Any, options: dict[str, Any]) -> QPSolution:
    """Finds one of several minima as the limit of proximal steps x <- argmin 1/2 x'P x + q'x + 1/2 d |x - x_before|^2.

    # Source
    R. T. Rockafellar, Monotone operators and the proximal point algorithm, SIAM J. Control Optim. 14 (1976).
    """
    x = np.zeros(problem.dofs) if start is None else start.copy()
    shortest: NotCertified | None = None
    for proximity in _PROXIMITIES:
        known = _steps(problem, proximity, x, options)
        x, found = known.u, _forces(known)
        # If the objective has no slope at x, the multipliers are zero, and those of the steps are rounding.
        settled = np.where(np.abs(x) > _MOVED * np.abs(x).max(initial=0.0), x, 0.0)
        without_force = (np.zeros_like(found[0]), np.zeros_like(found[1]))
        for at, forces in ((x, found), (settled, without_force)):
            certificate = _signorini.verify(problem, at, *forces)
            if certificate.conditions_hold(_TOLERANCE):
                return rows.answer(problem, at, forces, certificate, unique=False)
        condition, value = max(((name, getattr(certificate, name)) for name in _CONDITIONS), key=lambda worst: worst[1])
        error = NotCertified(f"not certified: {condition} is {value:.3e}, above the tolerance {_TOLERANCE:.1e}")
        error.solution, error.condition, error.value, error.tolerance = known, condition, value, _TOLERANCE
        if shortest is None or value < shortest.value:
            shortest = error
    assert shortest is not None
    raise shortest


# The conditions that decide.
_CONDITIONS = ("imbalance", "penetration", "adhesion", "open_force")


def _forces(solution: _signorini.Solution) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return solution.multiplier, solution.equality_multiplier


def _steps(
    problem: _signorini.Problem, proximity: float, x: NDArray[np.float64], options: dict[str, Any]
) -> _signorini.Solution:
    """Makes proximal steps from x. A single step need not be certified: the last one is verified on the problem itself."""
    from scipy import sparse

    size = proximity * (float(np.asarray(problem.K.diagonal()).max(initial=0.0)) or 1.0)
    near = sparse.csc_array(problem.K + size * sparse.eye_array(problem.dofs, format="csc"))
    stepping = _signorini.Problem(near, problem.f + size * x, problem.B, problem.g, E=problem.E, e=problem.e)
    chosen = {name: value for name, value in options.items() if name not in ("method", "time")}
    prepared = _signorini.prepare(stepping, proof=False, method="active-set", **chosen)
    known: Any = None
    for _ in range(_MOST_STEPS):
        try:
            known = prepared.solve(f=problem.f + size * x, start=known)
        except NotCertified as fell_short:
            known = fell_short.solution
        moved = float(np.abs(known.u - x).max(initial=0.0))
        x = known.u
        if moved <= _MOVED * max(float(np.abs(x).max(initial=0.0)), 1e-300):
            break
    return known  # type: ignore[no-any-return]

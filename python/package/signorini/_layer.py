"""A contact problem as a differentiable function of its numbers, for jax and torch."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from signorini import _signorini
from signorini._errors import BadInput, BadType

_AT_KINK = ("raise", "open", "closed")

_Places = tuple[NDArray[np.int64], NDArray[np.int64]]
_Values = NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class Pattern:
    """The places of the entries of K, shape (n, n), and B, shape (m, n), in the order of their values.

    `Pattern.of` makes it from two matrices.

    Attributes
    ----------
    dofs : int
        Number of unknowns n.
    row_count : int
        Number of contact rows m.
    stiffness : pair of arrays of int, shape (entries of K,)
        Row and column of each value of K, from 0.
    rows : pair of arrays of int, shape (entries of B,)
        Row and column of each value of B, from 0.
    """

    dofs: int
    row_count: int
    stiffness: tuple[NDArray[np.int64], NDArray[np.int64]]
    rows: tuple[NDArray[np.int64], NDArray[np.int64]]
    _layers: dict[Any, Layer] = field(default_factory=dict)

    @classmethod
    def of(cls, K: Any, B: Any) -> Pattern:
        """Returns the pattern of a stiffness and contact rows. Needs scipy.

        A matrix is a sparse matrix of scipy or an array of numpy. The values of a sparse matrix are its `data`. Those
        of an array are all its entries, row by row, as `ravel()` has them.

        Parameters
        ----------
        K : matrix, shape (n, n)
            The stiffness, with both triangles.
        B : matrix, shape (m, n)
            The contact rows.

        Returns
        -------
        Pattern
            The places of their entries; the values are not kept.

        Raises
        ------
        BadInput
            The shapes do not fit each other, or K has a place without its mirror image.
        BadType
            An argument is no matrix.
        ImportError
            scipy is not installed.
        """
        (dofs, columns), stiffness = _places("K", K)
        (row_count, of_rows), rows = _places("B", B)
        if dofs != columns:
            raise BadInput(f"K is {dofs} x {columns}; it must be square")
        if of_rows != dofs:
            raise BadInput(f"B is {row_count} x {of_rows}; it must have {dofs} columns, one for each row of K")
        i, j = stiffness
        alone = np.setdiff1d(i * dofs + j, j * dofs + i)
        if alone.size:
            row, column = divmod(int(alone[0]), dofs)
            raise BadInput(f"K has a place at ({row}, {column}) and none at ({column}, {row}); it must have both triangles")
        return cls(dofs, row_count, stiffness, rows)

    def __repr__(self) -> str:
        return f"<signorini.Pattern: {self.dofs} dofs, {self.row_count} rows>"

    def lengths(self) -> dict[str, int]:
        """Returns the lengths of the four arrays of a problem.

        Returns
        -------
        dict of str to int
            The lengths of "stiffness", "load", "rows" and "gap", in this order.
        """
        entries = {"stiffness": len(self.stiffness[0]), "load": self.dofs}
        return entries | {"rows": len(self.rows[0]), "gap": self.row_count}

    def layer(self, at_kink: str, options: dict[str, Any]) -> Layer:
        """Returns the function of problems with this pattern. It keeps its last factor and its last solution.

        `solve` of `signorini.jax` and `signorini.torch` calls it.

        Parameters
        ----------
        at_kink : str
            "raise", "open" or "closed", as in `signorini.jax.solve`.
        options : dict
            Options of `signorini.prepare`, by name.

        Returns
        -------
        Layer
            The same one for the same arguments.

        Raises
        ------
        BadInput
            `at_kink` is another word.
        """
        if at_kink not in _AT_KINK:
            raise BadInput(f"at_kink is {at_kink!r}; it must be one of {', '.join(_AT_KINK)}")
        key = (at_kink, *sorted((name, repr(value)) for name, value in options.items()))
        return self._layers.setdefault(key, Layer(self, at_kink, dict(options)))


def _places(name: str, matrix: Any) -> tuple[tuple[int, int], _Places]:
    from scipy import sparse

    if sparse.issparse(matrix):
        entries = matrix.tocoo()
        return matrix.shape, (entries.row.astype(np.int64), entries.col.astype(np.int64))
    shape = np.shape(matrix)
    if len(shape) != 2:
        raise BadType(f"{name} has the shape {shape}; it must be a sparse matrix of scipy or an array in two dimensions")
    rows, columns = np.indices(shape)
    return (shape[0], shape[1]), (rows.ravel(), columns.ravel())


class Layer:
    """The solution of contact problems with one pattern, and its derivatives by all numbers, for arrays of numpy."""

    def __init__(self, pattern: Pattern, at_kink: str, options: dict[str, Any]) -> None:
        self.pattern, self.at_kink, self.options = pattern, at_kink, options
        # Each is replaced as a whole, so that threads see one or the other.
        self._prepared: tuple[list[_Values], _signorini.Prepared] | None = None
        self._solution: tuple[list[_Values], _signorini.Solution] | None = None

    def solution(self, *values: Any) -> _signorini.Solution:
        """Returns the solution for these values of stiffness, load, rows and gap.

        K is the symmetric part of its values. Only other values of stiffness or rows need another factor.
        """
        # A copy: the caller may change an array afterwards.
        stiffness, load, rows, gap = arrays = [np.array(value, dtype=np.float64) for value in values]
        known = self._solution
        if known is not None and _same(known[0], arrays):
            return known[1]
        matrices, prepared = [stiffness, rows, np.isfinite(gap)], self._prepared
        if prepared is None or not _same(prepared[0], matrices):
            problem = _signorini.Problem(*self._matrices(stiffness, load, rows, gap))
            prepared = (matrices, _signorini.prepare(problem, **self.options))
            self._prepared = prepared
        solution = prepared[1].solve(gap, load)
        self._solution = (arrays, solution)
        return solution

    def _matrices(self, stiffness: _Values, load: _Values, rows: _Values, gap: _Values) -> tuple[Any, _Values, Any, _Values]:
        from scipy import sparse

        n, m = self.pattern.dofs, self.pattern.row_count
        K = sparse.csc_array((stiffness, self.pattern.stiffness), shape=(n, n))
        B = sparse.csc_array((rows, self.pattern.rows), shape=(m, n))
        return sparse.csc_array(0.5 * (K + K.T)), load, B, gap

    def answer(self, *values: Any) -> tuple[_Values, _Values]:
        """Returns displacement and multiplier."""
        solution = self.solution(*values)
        return solution.u, solution.multiplier

    def gradients(self, *values: Any) -> tuple[_Values, _Values, _Values, _Values]:
        """Returns the derivatives of an output by the values of stiffness, load, rows and gap.

        The last two arguments are the derivatives of the output by displacement and multiplier. Raises `NoDerivative`
        where the derivative is not proven, if no piece is chosen, or the chosen one does not exist.
        """
        *given, by_displacement, by_multiplier = values
        solution = self.solution(*given)
        vjp = solution.vjp(np.asarray(by_displacement), np.asarray(by_multiplier))
        piece: _signorini.Vjp | _signorini.Gradient = vjp
        if self.at_kink != "raise" and len(vjp.between) == 2:
            piece = vjp.between[_AT_KINK.index(self.at_kink) - 1]
        w, of_gap, u, multiplier = piece.load, piece.gap, solution.u, solution.multiplier
        (i, j), (row, column) = self.pattern.stiffness, self.pattern.rows
        of_stiffness = -0.5 * (w[i] * u[j] + w[j] * u[i])
        of_rows = multiplier[row] * w[column] - of_gap[row] * u[column]
        return of_stiffness, w, of_rows, of_gap


def _same(arrays: list[Any], others: list[Any]) -> bool:
    return all(np.array_equal(one, other) for one, other in zip(arrays, others, strict=True))

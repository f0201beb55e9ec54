"""Rows between two surfaces whose meshes do not match, for matrices from elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini import _signorini
from signorini._errors import BadType


@dataclass(frozen=True, repr=False)
class MortarRows:
    """Contact rows between two surfaces: B [u_slave, u_master] <= g, with the displacements of all nodes of both.

    m is the number of rows; dim is 2 in the plane and 3 in space. Arrays are read-only. `signorini.mortar_rows` makes
    it.

    Attributes
    ----------
    B : csc_array of scipy, shape (m, dim * (slave nodes + master nodes))
        The rows, dimensionless, positive towards the master: dim columns for each node of the slave surface, in the
        order of its nodes, then for each node of the master surface.
    g : array, shape (m,)
        The mean distance of the undeformed surfaces over the area of each row, in length; negative where they overlap.
    area : array, shape (m,)
        The area of each row, positive, with thickness or circumference: `-multiplier / area` is a pressure.
    normals : array, shape (m, dim)
        The unit normal of each row, from the slave body into the other.
    nodes : array of int, shape (m,)
        The node of the slave surface that carries each row, from 0.
    """

    B: Any
    g: NDArray[np.float64]
    area: NDArray[np.float64]
    normals: NDArray[np.float64]
    nodes: NDArray[np.int64]

    def __repr__(self) -> str:
        return f"<signorini.MortarRows: {self.B.shape[0]} rows, {self.B.shape[1]} unknowns>"


def mortar_rows(
    slave: tuple[ArrayLike, ArrayLike] | tuple[ArrayLike, ArrayLike, str],
    master: tuple[ArrayLike, ArrayLike] | tuple[ArrayLike, ArrayLike, str],
    *,
    model: str = "plane-strain",
    thickness: float = 1.0,
    direction: ArrayLike | None = None,
    reach: float | None = None,
) -> MortarRows:
    """Returns the contact rows between the surfaces of two bodies, each with its own mesh.

    The slave surface carries the rows, at its nodes. Take the softer body, or the finer mesh if both are equally soft.
    In the solution a uniform pressure passes between any two meshes without error. `docs/mortar.md` explains the rows.

    Needs scipy: `pip install "signorini[sparse]"`.

    Parameters
    ----------
    slave : tuple (nodes, facets) or (nodes, facets, kind)
        The surface that carries the rows. nodes: coordinates, shape (nodes, dim), in length; dim is 2 in the plane and
        3 in space. facets: the nodes of each facet, shape (facets, k), from 0. In the plane the body lies to the left
        of an edge; in space the corners run counterclockwise, seen from outside. Mid-side nodes follow the ends or
        corners. kind: "Line2" or "Line3" in the plane, "T3", "Q4", "T6" or "Q8" in space; without it the number of
        columns k decides.
    master : tuple (nodes, facets) or (nodes, facets, kind)
        The other surface, in the same form.
    model : str, optional
        "plane-strain" (the default), "plane-stress", "axisymmetric" (x is the radius) or "space", as in scenes.
    thickness : float, optional
        Thickness of a body in the plane, in length, positive; 1 by default. Other models do not use it.
    direction : array, shape (dim,), optional
        All rows lie along this vector, of any length, from the slave body into the other. Along the normals by default.
    reach : float, optional
        There are no rows where the surfaces are farther apart than this, in length, positive. No limit by default.

    Returns
    -------
    MortarRows
        The rows with their gaps, areas and normals.

    Raises
    ------
    BadInput
        Arrays are no surface, a value is not finite or not allowed, or a surface faces several layers of the other.
    BadType
        An argument has a wrong type.
    ImportError
        scipy is not installed.
    Interrupted
        Ctrl-C was pressed.
    """
    from scipy import sparse

    found = _signorini._mortar_rows(
        _surface("slave", slave), _surface("master", master), model, thickness, direction, reach
    )
    data, indices, starts = found.pop("B")
    B = sparse.csc_array((data, indices, starts), shape=found.pop("shape"))
    return MortarRows(B=B, **found)


def _surface(name: str, surface: Any) -> tuple[Any, Any, Any]:
    """Returns nodes, facets and kind; None for a kind that is not given."""
    if not isinstance(surface, (tuple, list)) or len(surface) not in (2, 3):
        has = f"{len(surface)} entries" if isinstance(surface, (tuple, list)) else f"the type {type(surface).__name__}"
        raise BadType(f"{name} has {has}; it must be (nodes, facets) or (nodes, facets, kind)")
    nodes, facets, *kind = surface
    return nodes, facets, kind[0] if kind else None

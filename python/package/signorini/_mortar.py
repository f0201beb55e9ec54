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
    """Contact rows between two surfaces: B [u_slave, u_master] <= g, with the displacements of all nodes of both. Arrays are read-only."""

    B: Any
    """Rows x dim (n_slave + n_master), dimensionless, a `csc_array` of scipy: dim columns for each node of the slave surface, in the order
    of its nodes, then for each of the master surface. Positive towards the master."""
    g: NDArray[np.float64]
    """The mean distance of the undeformed surfaces over the area of each row, in length; negative where they overlap."""
    area: NDArray[np.float64]
    """The area of each row, positive, thickness or circumference included: -multiplier / area is a pressure."""
    normals: NDArray[np.float64]
    """Rows x dim, dimensionless: the unit normal of each row, from the slave body into the other."""
    nodes: NDArray[np.int64]
    """The node of the slave surface that carries each row, from 0."""

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

    The slave surface carries the rows, one at each node: better the softer body, and the finer mesh if both are as soft. In the answer
    a uniform pressure passes between any two meshes without error. `docs/mortar.md` explains the rows.

    slave, master: `(nodes, facets)` or `(nodes, facets, kind)`. nodes: coordinates, n x dim, in length; dim is 2 in the plane and 3 in
    space. facets: m x k, the nodes of each facet, from 0. In the plane the body lies to the left of an edge; in space the corners run
    counterclockwise, seen from outside. Mid-side nodes follow the ends or corners. kind: `Line2` or `Line3` in the plane, `T3`, `Q4`,
    `T6` or `Q8` in space; without it the number of columns k decides.
    model: `plane-strain`, `plane-stress`, `axisymmetric` (x is the radius) or `space`, as in scenes.
    thickness: that of a body in the plane, in length; other models do not use it.
    direction: all rows along this vector, length dim, from the slave body into the other; without it along the normals.
    reach: no rows where the surfaces are farther apart, in length.

    Raises `BadInput` for arrays that are no surface, a kind or a model that does not exist, values that are not finite, and a surface
    that faces several layers of the other; `BadType` for an argument of a wrong type. Needs scipy.
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

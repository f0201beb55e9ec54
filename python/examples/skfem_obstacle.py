"""Contact of a membrane, assembled by scikit-fem, with a plane obstacle.

A circular membrane of unit tension, fixed at its rim, is pressed by p = 4 onto a plane at the depth c = 0.5. Without
the plane its sag would be u = (1 - r^2) p / 4, with u = 1 at the centre. With the plane it is flat up to a radius a and
sags freely from there to the rim:

    u = c for r <= a,    u = p/4 (1 - r^2) + p a^2/2 log r beyond,    with  p/4 (1 - a^2) + p a^2/2 log a = c

Needs scipy and scikit-fem: `pip install "signorini[sparse]" scikit-fem`.
"""

from __future__ import annotations

import numpy as np
import signorini as sg
from scipy import sparse
from scipy.optimize import brentq
from skfem import Basis, ElementTriP1, MeshTri, condense
from skfem.models.poisson import laplace, unit_load

PRESSURE, DEPTH = 4.0, 0.5


def exact(radius: np.ndarray) -> tuple[np.ndarray, float]:
    """Returns the exact sag at each radius, and the radius of the contact zone."""
    free = lambda a: PRESSURE / 4 * (1 - a * a) + PRESSURE * a * a / 2 * np.log(a) - DEPTH  # noqa: E731
    edge = brentq(free, 1e-6, 1 - 1e-6)
    beyond = np.maximum(radius, edge)
    sag = PRESSURE / 4 * (1 - beyond**2) + PRESSURE * edge**2 / 2 * np.log(beyond)
    return sag, edge


def main(refinements: int = 5) -> float:
    basis = Basis(MeshTri.init_circle(refinements), ElementTriP1())
    stiffness, load = laplace.assemble(basis), PRESSURE * unit_load.assemble(basis)
    # Without the obstacle, scikit-fem would solve the membrane by `solve(*condense(...))`.
    stiffness, load, sag, inside = condense(stiffness, load, D=basis.get_dofs())
    # Every unknown has a bound, so that B is the identity.
    rows = sparse.eye_array(len(inside), format="csr")
    answer = sg.solve(sg.Problem(stiffness, load, rows, np.full(len(inside), DEPTH)))
    sag[inside] = answer.u

    radius = np.linalg.norm(basis.doflocs, axis=0)
    expected, edge = exact(radius)
    error = float(np.abs(sag - expected).max())
    touching = radius[inside][answer.contact_set].max()
    print(f"{len(inside)} unknowns, {answer}")
    print(f"largest error of the mesh {error:.1e} of a sag of {DEPTH}; contact up to r = {touching:.3f}, exactly {edge:.3f}")
    return error


if __name__ == "__main__":
    main()

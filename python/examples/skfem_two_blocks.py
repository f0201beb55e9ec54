"""Two blocks meshed and assembled by scikit-fem touch along meshes that do not match, beside the closed form.

The upper block [0, 1] x [1, 2] has triangles, the lower block [0, 1] x [0, 1] has quadrilaterals of other sizes. The
pressure p on top passes through the contact. In plane strain both blocks have uniform stresses, sigma_y = -p, so that
their strains are

    eps_x = nu (1 + nu) p / E,  eps_y = -(1 - nu^2) p / E.

`sg.mortar_rows` makes the contact rows from the nodes and edges of both surfaces. scikit-fem knows nothing of contact,
and signorini nothing of the elements.

Needs scipy and scikit-fem: `pip install "signorini[sparse]" scikit-fem`.
"""

from __future__ import annotations

import numpy as np
import signorini as sg
from scipy import sparse
from skfem import Basis, ElementQuad1, ElementTriP1, ElementVector, FacetBasis, LinearForm, Mesh, MeshQuad, MeshTri
from skfem.models.elasticity import lame_parameters, linear_elasticity

PRESSURE = 1e6
UPPER, LOWER = (2e9, 0.35), (70e9, 0.3)  # Young's modulus in Pa, Poisson's ratio


def surface(basis: Basis, height: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns the nodes on a horizontal side, its edges with the body to their left, and the dofs x and y of each node."""
    mesh = basis.mesh
    facets = mesh.facets_satisfying(lambda x: np.isclose(x[1], height), boundaries_only=True)
    edges = mesh.facets[:, facets]
    start, end = mesh.p[:, edges[0]], mesh.p[:, edges[1]]
    inside = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1)
    (ax, ay), (bx, by) = end - start, inside - start
    edges = np.where(ax * by - ay * bx > 0, edges, edges[::-1])
    numbers, connectivity = np.unique(edges, return_inverse=True)
    return mesh.p[:, numbers].T, connectivity.reshape(edges.shape).T, basis.nodal_dofs[:, numbers].T.ravel()


def assembled(mesh: Mesh, element: object, material: tuple[float, float]) -> tuple[Basis, sparse.csr_array]:
    basis = Basis(mesh, ElementVector(element), intorder=2)
    return basis, linear_elasticity(*lame_parameters(*material)).assemble(basis)


def main(cells: tuple[int, int] = (5, 3)) -> tuple[float, float]:
    """Returns the largest errors of displacement and pressure, relative to the exact values."""
    # Lines of uneven distances, so that no inner node of one side lies opposite to a node of the other.
    lines = [np.linspace(0.0, 1.0, count + 1) ** power for count, power in zip(cells, (1.3, 0.8), strict=True)]
    upper, K_upper = assembled(MeshTri.init_tensor(lines[0], np.linspace(1.0, 2.0, 4)), ElementTriP1(), UPPER)
    lower, K_lower = assembled(MeshQuad.init_tensor(lines[1], np.linspace(0.0, 1.0, 4)), ElementQuad1(), LOWER)

    top = upper.mesh.facets_satisfying(lambda x: np.isclose(x[1], 2.0))
    down = LinearForm(lambda v, _: -PRESSURE * v[1]).assemble(FacetBasis(upper.mesh, upper.elem, facets=top))

    # Rows at the nodes of the softer block.
    nodes, edges, dofs = surface(upper, 1.0)
    other_nodes, other_edges, other_dofs = surface(lower, 1.0)
    rows = sg.mortar_rows((nodes, edges), (other_nodes, other_edges), model="plane-strain")

    # The unknowns are all dofs of the upper block, then those of the lower one, without the supports.
    place = np.concatenate([dofs, upper.N + other_dofs])
    size = upper.N + lower.N
    to_nodes = sparse.csr_array((np.ones(len(place)), (np.arange(len(place)), place)), shape=(len(place), size))
    stiffness, contact = sparse.block_diag([K_upper, K_lower], format="csr"), rows.B @ to_nodes
    load = np.concatenate([down, np.zeros(lower.N)])
    held = np.concatenate(
        [
            upper.get_dofs(lambda x: np.isclose(x[0], 0.0)).all("u^1"),
            upper.N + lower.get_dofs(lambda x: np.isclose(x[0], 0.0)).all("u^1"),
            upper.N + lower.get_dofs(lambda x: np.isclose(x[1], 0.0)).all("u^2"),
        ]
    )
    free = np.setdiff1d(np.arange(size), held)
    answer = sg.solve(sg.Problem(stiffness[free][:, free], load[free], contact.tocsc()[:, free], rows.g))

    displacement, exact = np.zeros(size), np.zeros(size)
    displacement[free] = answer.u
    x, y = np.hstack([upper.doflocs, lower.doflocs])
    is_upper = np.arange(size) < upper.N
    is_y = np.isin(np.arange(size), np.concatenate([upper.nodal_dofs[1], upper.N + lower.nodal_dofs[1]]))
    (of_x, of_y), (low_x, low_y) = ((nu * (1 + nu) * PRESSURE / E, -(1 - nu**2) * PRESSURE / E) for E, nu in (UPPER, LOWER))
    exact = np.where(is_upper, np.where(is_y, low_y + of_y * (y - 1.0), of_x * x), np.where(is_y, low_y * y, low_x * x))
    pressure = -answer.multiplier / rows.area
    of_displacement = float(np.abs(displacement - exact).max() / np.abs(exact).max())
    of_pressure = float(np.abs(pressure / PRESSURE - 1.0).max())
    print(f"{len(rows.g)} rows, {len(answer.contact_set)} of them closed; energy error at most {answer.energy_error_bound:.1e}")
    print(f"displacement: {of_displacement:.1e} from the closed form; pressure: {of_pressure:.1e}")
    return of_displacement, of_pressure


if __name__ == "__main__":
    main()

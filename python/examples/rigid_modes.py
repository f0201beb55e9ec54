"""Multigrid with rigid-body modes for a stiffness in compressed rows with the coordinates of its nodes, as in dolfinx.

In dolfinx these arrays are available without a copy, after `A = fem.assemble_matrix(form, bcs)`:

    K = A.to_scipy()                                # signorini.Problem also takes A itself
    x = V.tabulate_dof_coordinates()                # one row per node

Fixed dofs stay in K with a diagonal entry of their own. All dofs of a node therefore follow each other, and the modes
can be computed from `coordinates`. This example assembles such arrays of an elastic cube by scikit-fem, so that it does
not need dolfinx.

Needs scipy and scikit-fem: `pip install "signorini[sparse]" scikit-fem`.
"""

from __future__ import annotations

import numpy as np
import signorini as sg
from scipy import sparse
from skfem import Basis, ElementHex1, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity


def cube(cells: int) -> tuple[sparse.csr_matrix, np.ndarray, np.ndarray, np.ndarray]:
    """Returns the stiffness (fixed dofs have only a diagonal entry), the coordinates, the fixed dofs, and the nodes of the top."""
    line = np.linspace(0.0, 1.0, cells + 1)
    basis = Basis(MeshHex.init_tensor(line, line, line), ElementVector(ElementHex1()))
    stiffness = linear_elasticity(*lame_parameters(1e7, 0.3)).assemble(basis)
    nodes = basis.mesh.p.T
    # Order the dofs node by node: [x_0, y_0, z_0, x_1, ...].
    order = basis.nodal_dofs.T.reshape(-1)
    stiffness = sparse.csr_matrix(stiffness[order][:, order])
    held = np.flatnonzero(np.repeat(np.isclose(nodes[:, 2], 0.0), 3))
    free = np.ones(stiffness.shape[0])
    free[held] = 0.0
    keep = sparse.diags_array(free)
    stiffness = sparse.csr_matrix(keep @ stiffness @ keep + 1e7 * sparse.diags_array(1.0 - free))
    return stiffness, nodes, held, np.flatnonzero(np.isclose(nodes[:, 2], 1.0))


def main(cells: int = 10) -> float:
    """Returns the largest relative difference between the displacements by multigrid and by a factorisation."""
    stiffness, nodes, _, top = cube(cells)
    # A rigid dome is lowered by 0.02 into the top of the cube; these are the gaps of its nodes.
    gap = 0.1 * ((nodes[top, 0] - 0.5) ** 2 + (nodes[top, 1] - 0.5) ** 2) - 0.02
    rows = sparse.csr_array((np.ones(len(top)), (np.arange(len(top)), 3 * top + 2)), shape=(len(top), stiffness.shape[0]))
    problem = sg.Problem(stiffness, np.zeros(stiffness.shape[0]), rows, gap, coordinates=nodes)
    by_cycles, by_factor = sg.solve(problem, method="mprgp"), sg.solve(problem, method="active-set")
    print(f"{problem}")
    for answer in (by_cycles, by_factor):
        print(f"{answer.method:12} {answer.contact_force:.9g} N, energy error <= {answer.energy_error_bound:.1e}, {answer.seconds:.2f} s")
    return float(np.abs(by_cycles.u - by_factor.u).max() / np.abs(by_factor.u).max())


if __name__ == "__main__":
    main()

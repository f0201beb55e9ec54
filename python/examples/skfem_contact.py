"""Contact of an elastic block, assembled by scikit-fem, with a rigid parabola; the result is compared with a scene.

The unit block in plane strain is fixed at its bottom, as in `examples/indentation.json`. The obstacle above it is the
parabola y = 1 - d + (x - 1/2)^2 / (2 R); the contact rows are u_y <= gap at the nodes of the top. The scene assembles
the same block by itself, so that the two forces must agree.

Needs scipy and scikit-fem: `pip install "signorini[sparse]" scikit-fem`.
"""

from __future__ import annotations

import numpy as np
import signorini as sg
from scipy import sparse
from skfem import Basis, ElementQuad1, ElementVector, MeshQuad, condense
from skfem.models.elasticity import lame_parameters, linear_elasticity

YOUNG, POISSON, RADIUS, DEPTH, CELLS = 1e7, 0.3, 0.5, 0.03, 24


def assembled() -> tuple[sg.Problem, np.ndarray, Basis]:
    """Returns the problem, the positions of its unknowns among all dofs, and the basis."""
    line = np.linspace(0.0, 1.0, CELLS + 1)
    mesh = MeshQuad.init_tensor(line, line)
    basis = Basis(mesh, ElementVector(ElementQuad1()), intorder=2)
    stiffness = linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(basis)
    held = basis.get_dofs(lambda x: np.isclose(x[1], 0.0)).all()
    stiffness, load, _, free = condense(stiffness, np.zeros(basis.N), D=held)

    # One row per node of the top, positive towards the obstacle, which is above.
    top = mesh.nodes_satisfying(lambda x: np.isclose(x[1], 1.0))
    upward = basis.nodal_dofs[1, top]
    place = np.searchsorted(free, upward)
    rows = sparse.csr_array((np.ones(len(top)), (np.arange(len(top)), place)), shape=(len(top), len(free)))
    gap = (mesh.p[0, top] - 0.5) ** 2 / (2 * RADIUS) - DEPTH
    nodes = basis.doflocs[:, free]
    # Rigid-body modes of the free dofs, for multigrid. The fixed dofs are missing, so that `coordinates` could not be
    # used.
    is_y = np.isin(free, basis.nodal_dofs[1])
    modes = np.stack([~is_y, is_y, np.where(is_y, nodes[0], -nodes[1])], axis=1).astype(float)
    return sg.Problem(stiffness, load, rows, gap, near_null=modes), free, basis


def scene() -> sg.Scene:
    """Returns the same block and obstacle as a scene."""
    side = {"points": [0, 1], "divisions": [CELLS]}
    return sg.Scene(
        {
            "body": {"rectangle": {"x": side, "y": side}},
            "material": {"young": YOUNG, "poisson": POISSON},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "obstacles": [
                {
                    "boundary": "top",
                    "approach": "+y",
                    "rule": "approach",
                    "shape": {"parabola": {"apex": [0.5, 1.0], "radius": RADIUS}},
                }
            ],
            "gap": -DEPTH,
        }
    )


def main() -> tuple[float, float]:
    problem, free, basis = assembled()
    answer = sg.solve(problem)
    displacement = np.zeros(basis.N)
    displacement[free] = answer.u
    print(f"scikit-fem and signorini: {answer.contact_force:.9g} N, {len(answer.contact_set)} nodes in contact")
    by_scene = scene().solve()
    print(f"the scene:                {by_scene.contact_force:.9g} N, {len(by_scene.contact_set)} nodes in contact")

    # One factor serves many depths, which give the press force as a function of the depth.
    prepared = sg.prepare(problem, gaps=8)
    known = None
    for deeper in np.linspace(-0.02, 0.01, 4):
        known = prepared.solve(problem.g - deeper, start=known)
        print(f"  depth {DEPTH + deeper:.3f} m: {known.contact_force:10.1f} N")
    return answer.contact_force, by_scene.contact_force


if __name__ == "__main__":
    main()

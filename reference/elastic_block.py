"""The indentation of a clamped elastic block, assembled independently of the program.

The body [0, width] x [0, height] consists of four-node quadrilaterals in plane strain and is clamped at its bottom. Every top
node is a contact candidate in +y. The obstacle is a parabola of radius R with its apex above the middle:
u_y <= gap + (x - width/2)^2 / (2 R). The code is not shared with the program, so that a wrong factor in its stiffness is
detected.
"""

import numpy as np
from scipy import sparse

from problem import Problem, problem_of

GAUSS = (-1.0 / np.sqrt(3.0), 1.0 / np.sqrt(3.0))
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def plane_strain(young: float, poisson: float) -> np.ndarray:
    """Returns the elasticity matrix, 3 x 3, for (eps_xx, eps_yy, gamma_xy), in Pa."""
    factor = young / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    return factor * np.array([[1.0 - poisson, poisson, 0.0], [poisson, 1.0 - poisson, 0.0], [0.0, 0.0, 0.5 - poisson]])


def rectangle_stiffness(a: float, b: float, elasticity: np.ndarray) -> np.ndarray:
    """Returns the stiffness of a rectangle a x b (m), 8 x 8, per metre of thickness; order [x0, y0, x1, ...], counter-clockwise."""
    stiffness = np.zeros((8, 8))
    for xi in GAUSS:
        for eta in GAUSS:
            along_x = CORNERS[:, 0] * (1.0 + CORNERS[:, 1] * eta) / (2.0 * a)
            along_y = CORNERS[:, 1] * (1.0 + CORNERS[:, 0] * xi) / (2.0 * b)
            strain = np.zeros((3, 8))
            strain[0, 0::2], strain[1, 1::2] = along_x, along_y
            strain[2, 0::2], strain[2, 1::2] = along_y, along_x
            stiffness += strain.T @ elasticity @ strain * (a * b / 4.0)
    return stiffness


def indentation(gap=-0.01, columns=40, layers=20, width=1.0, height=0.5, young=1e7, poisson=0.3, radius=1.0) -> Problem:
    """Returns the problem in the free dofs. The order is node by node, row by row from the bottom, x before y."""
    local = rectangle_stiffness(width / columns, height / layers, plane_strain(young, poisson))
    node = np.arange((columns + 1) * (layers + 1)).reshape(layers + 1, columns + 1)
    corners = np.stack([node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]], axis=-1).reshape(-1, 4)
    dofs = np.stack([2 * corners, 2 * corners + 1], axis=-1).reshape(-1, 8)
    rows, cols = np.repeat(dofs, 8, axis=1).ravel(), np.tile(dofs, (1, 8)).ravel()
    size = 2 * node.size
    full = sparse.csr_matrix((np.tile(local.ravel(), len(dofs)), (rows, cols)), shape=(size, size))
    full = 0.5 * (full + full.T)

    free = np.arange(2 * (columns + 1), size)
    normals = 2 * node[-1] + 1 - free[0]
    contact = sparse.csr_matrix(
        (np.ones(columns + 1), (np.arange(columns + 1), normals)), shape=(columns + 1, free.size)
    )
    x = np.linspace(0.0, width, columns + 1)
    return problem_of(full[free][:, free], np.zeros(free.size), contact, gap + (x - width / 2.0) ** 2 / (2.0 * radius))

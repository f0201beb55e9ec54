"""Solves the block of studies/multigrid without contact by pyamg, for comparison: hierarchy, cycles, seconds.

    pip install pyamg && OMP_NUM_THREADS=1 python reference/multigrid.py 16 32 64

Each argument is a number of Hex8 cells along a side of the unit block, which is clamped at its bottom. A unit load along -z acts on
every node of the top. The script uses nothing of the crate; it assembles the stiffness itself.
"""

import sys
import time

import numpy as np
import pyamg
import scipy.sparse as sp

YOUNG, POISSON = 1e7, 0.3
TOLERANCE = 1e-8
CHUNK = 40_000  # elements assembled at once: a bound on memory


def element_stiffness(size):
    """Returns the stiffness (24 x 24, N/m) of a cube of side `size`, by 2 x 2 x 2 Gauss points."""
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    shear = YOUNG / (2 * (1 + POISSON))
    elastic = np.diag([2 * shear] * 3 + [shear] * 3)
    elastic[:3, :3] += lame
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], dtype=float)
    stiffness = np.zeros((24, 24))
    for point in corners / np.sqrt(3):
        gradient = np.empty((8, 3))
        for axis in range(3):
            others = [other for other in range(3) if other != axis]
            gradient[:, axis] = corners[:, axis] * np.prod(1 + corners[:, others] * point[others], axis=1) / 8
        gradient *= 2 / size
        strain = np.zeros((6, 24))
        for axis in range(3):
            strain[axis, axis::3] = gradient[:, axis]
        for row, (a, b) in enumerate([(1, 2), (0, 2), (0, 1)], start=3):
            strain[row, a::3] = gradient[:, b]
            strain[row, b::3] = gradient[:, a]
        stiffness += strain.T @ elastic @ strain * (size / 2) ** 3
    return stiffness


def block(cells):
    """Returns the stiffness (CSR) of the free dofs, the load, and the rigid-body modes of the block."""
    nodes = cells + 1
    index = np.arange(nodes**3).reshape(nodes, nodes, nodes)
    corner = index[:-1, :-1, :-1].ravel()
    offsets = [x + nodes * y + nodes**2 * z for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    dofs = (3 * (corner[:, None] + np.array(offsets))[:, :, None] + np.arange(3)).reshape(len(corner), 24)
    held = 3 * nodes**2  # z is the slowest index: the bottom comes first
    total = 3 * nodes**3
    values = element_stiffness(1 / cells).ravel()
    stiffness = sp.csr_matrix((total - held, total - held))
    for start in range(0, len(dofs), CHUNK):
        part = dofs[start : start + CHUNK] - held
        rows = np.repeat(part, 24, axis=1).ravel()
        columns = np.tile(part, (1, 24)).ravel()
        free = (rows >= 0) & (columns >= 0)
        entries = np.tile(values, len(part))[free]
        stiffness = stiffness + sp.csr_matrix((entries, (rows[free], columns[free])), shape=stiffness.shape)
    load = np.zeros(total)
    load[3 * index[-1].ravel() + 2] = -1
    z, y, x = (axis.ravel() / cells - 0.5 for axis in np.mgrid[0:nodes, 0:nodes, 0:nodes])
    motions = np.zeros((nodes**3, 3, 6))
    motions[:, range(3), range(3)] = 1
    motions[:, 1, 3], motions[:, 2, 3] = -z, y
    motions[:, 2, 4], motions[:, 0, 4] = -x, z
    motions[:, 0, 5], motions[:, 1, 5] = -y, x
    return stiffness, load[held:], motions.reshape(total, 6)[held:]


def main():
    print("| dofs | set-up, s | cycles | solve, s | total, s |\n|---|---|---|---|---|")
    for cells in map(int, sys.argv[1:] or ["16", "32"]):
        stiffness, load, motions = block(cells)
        matrix = stiffness.tobsr(blocksize=(3, 3))
        start = time.process_time()
        solver = pyamg.smoothed_aggregation_solver(matrix, B=motions)
        built = time.process_time()
        residuals = []
        solver.solve(load, tol=TOLERANCE, accel="cg", residuals=residuals)
        end = time.process_time()
        print(f"| {len(load)} | {built - start:.2f} | {len(residuals) - 1} | {end - built:.2f} | {end - start:.2f} |", flush=True)


if __name__ == "__main__":
    main()

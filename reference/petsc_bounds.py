"""Measures the seconds of PETSc on a problem with bounds: `python3 reference/petsc_bounds.py DIRECTORY`.

The directory holds K.mtx, f.mtx, B.mtx and g.mtx; each row of B has one entry. The script prints a line for each solver that solves the
problem: its name, the seconds including all set-up, the iterations, and the number of dofs at a bound. `linear` solves K u = f without
bounds. The exit code is 2 if petsc4py is not installed (Debian: python3-petsc4py), and 1 if the rows are not bounds.

TAO's TRON runs as in PETSc's own obstacle problem (`jbearing2`): conjugate gradients with an incomplete Cholesky factor. All solvers
end at 1e-9 of the first residual.
"""

import signal
import sys
import time
from pathlib import Path

import numpy as np

try:
    from petsc4py import PETSc
except ImportError:
    print("no petsc4py: apt-get install python3-petsc4py", file=sys.stderr)
    sys.exit(2)

TOLERANCE = 1e-9

MOST_SECONDS = 60
"""Time limit of one solver. TAO's GPCG is left out, because its line search did not end on a membrane of 65,025 dofs."""


def numbers(file: Path) -> tuple[list[int], np.ndarray]:
    """Reads the sizes and the rows of numbers of a Matrix Market file."""
    with file.open() as stream:
        line = stream.readline()
        while line.startswith("%"):
            line = stream.readline()
        return [int(word) for word in line.split()], np.loadtxt(stream, ndmin=2)


def vector(file: Path) -> np.ndarray:
    """Reads the values of a Matrix Market array."""
    return numbers(file)[1][:, 0]


def problem(directory: Path):
    """Reads K as a PETSc matrix, f, and the bounds on each dof."""
    (n, _, _), entries = numbers(directory / "K.mtx")
    rows, columns, values = entries[:, 0].astype(np.int32) - 1, entries[:, 1].astype(np.int32) - 1, entries[:, 2]
    off = rows != columns
    i, j, v = np.r_[rows, columns[off]], np.r_[columns, rows[off]], np.r_[values, values[off]]
    order = np.lexsort((j, i))
    starts = np.r_[0, np.cumsum(np.bincount(i, minlength=n))].astype(np.int32)
    stiffness = PETSc.Mat().createAIJ(size=(n, n), csr=(starts, j[order], v[order]))
    (_, _, count), contact = numbers(directory / "B.mtx")
    gap = vector(directory / "g.mtx")
    row, dof, b = contact[:, 0].astype(int) - 1, contact[:, 1].astype(int) - 1, contact[:, 2]
    if count != len(gap) or len(set(row.tolist())) != count:
        print("rows of B with more than one entry are no bounds", file=sys.stderr)
        sys.exit(1)
    lower, upper = np.full(n, -1e30), np.full(n, 1e30)
    np.minimum.at(upper, dof[b > 0], gap[row[b > 0]] / b[b > 0])
    np.maximum.at(lower, dof[b < 0], gap[row[b < 0]] / b[b < 0])
    return stiffness, vector(directory / "f.mtx"), lower, upper


def petsc_vector(values: np.ndarray) -> PETSc.Vec:
    return PETSc.Vec().createWithArray(values.copy())


def at_bounds(u: PETSc.Vec, lower: np.ndarray, upper: np.ndarray) -> int:
    """Counts the dofs that are at a bound, up to rounding of the displacement."""
    near = 1e-9 * np.abs(u.array).max()
    return int(np.sum((u.array - lower <= near) | (upper - u.array <= near)))


def tron(stiffness, load, lower, upper) -> tuple[PETSc.Vec, int, bool]:
    """Minimises 1/2 u'Ku - f'u within the bounds by TAO's TRON."""
    force, forces = petsc_vector(load), petsc_vector(load)

    def objective_gradient(_, u, gradient):
        stiffness.mult(u, forces)
        gradient.waxpy(-1.0, force, forces)
        return 0.5 * u.dot(forces) - u.dot(force)

    u = petsc_vector(np.clip(np.zeros_like(load), lower, upper))
    solver = PETSc.TAO().create()
    solver.setType("tron")
    solver.setObjectiveGradient(objective_gradient, petsc_vector(load))
    solver.setHessian(lambda *_: None, stiffness)
    solver.setVariableBounds((petsc_vector(lower), petsc_vector(upper)))
    solver.setTolerances(gatol=TOLERANCE * np.linalg.norm(load), grtol=0.0, gttol=0.0)
    solver.setMaximumIterations(2000)
    solver.setFromOptions()
    solver.solve(u)
    return u, solver.getIterationNumber(), solver.getConvergedReason() > 0


def linear(stiffness, load, *_) -> tuple[PETSc.Vec, int, bool]:
    """Solves K u = f by a Cholesky factor."""
    solver = PETSc.KSP().create()
    solver.setOperators(stiffness)
    solver.setType("preonly")
    solver.getPC().setType("cholesky")
    u = petsc_vector(load)
    solver.solve(petsc_vector(load), u)
    return u, 1, solver.getConvergedReason() > 0


def main() -> None:
    stiffness, load, lower, upper = problem(Path(sys.argv[1]))
    options = PETSc.Options()
    options["tao_ksp_type"] = "cg"
    options["tao_pc_type"] = "icc"
    for name, solve in (("tron", tron), ("linear", linear)):
        # A solver that takes longer ends the script; the lines printed before remain.
        signal.alarm(MOST_SECONDS)
        begin = time.perf_counter()
        try:
            u, iterations, converged = solve(stiffness, load, lower, upper)
        except PETSc.Error:
            continue
        seconds = time.perf_counter() - begin
        if converged:
            closed = at_bounds(u, lower, upper) if name != "linear" else 0
            print(f"{name} {seconds:.4f} {iterations} {closed}", flush=True)


if __name__ == "__main__":
    main()

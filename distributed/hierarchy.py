"""A multigrid cycle in a face (the unknowns that no closed bound holds). GAMG or BoomerAMG builds its levels once, for K.

Let Q project onto the held dofs. Then the first prolongator P becomes (I - Q) P and the next matrix becomes

    P' (I - Q) K (I - Q) P = A_1 - C_1,    C_1 = Y + Y',    Y = P' Q (K P - 1/2 K Q P),    C_k+1 = P_k' C_k P_k

C_1 has entries only near the held dofs, and no level is built again. Without C_1 the number of cycles would grow with the
contact zone: a coarse displacement that is set to zero at the held dofs has far more energy than before. The smoothers are
Chebyshev polynomials of the fourth kind in D^-1 A. D is the diagonal of A; D^-1 is zero at held dofs.

Sources: R. Kornhuber, Numer. Math. 69 (1994) 167-184 (truncated basis functions); J. Lottes, Numer. Linear Algebra Appl. 30
(2023) e2518 (the smoother).
"""

import numpy as np

from problem import in_rows, orthonormal
from ranks import PETSC_INT, PETSc

DEGREE = 3
"""Degree of the smoothing polynomial, before and after the coarse correction."""

LANCZOS_STEPS = 10
"""Number of products in the estimate of the largest eigenvalue of D^-1 A."""

SAFETY = 1.1
"""Factor on that estimate, which is a lower bound."""

CHANGED = 1.15
"""Factor on the largest eigenvalue of a coarse level: a face may increase it."""

LOST = 1e-10
"""If a face leaves less than this share of a diagonal entry, the entry has lost its digits, and its unknown is held."""

SHIFT = 1e-3
"""Added to the diagonal of a singular coarsest matrix, scaled to a diagonal of one. Contact adds a similar stiffness."""

SINGULAR = 1e-9
"""A coarsest matrix, scaled to a diagonal of one, counts as singular if an eigenvalue is below this value."""


PREFIX = "signorini_"

OF_LEVELS = {"mg_levels_ksp_type": "richardson", "mg_levels_ksp_max_it": 1, "mg_levels_pc_type": "none",
             "mg_coarse_ksp_type": "preonly", "mg_coarse_pc_type": "none"}
"""Keep PETSc from preparing smoothers and coarse solvers, which are not used."""

OF_KIND = {
    "gamg": {"pc_type": "gamg", "pc_gamg_coarse_eq_limit": 400},
    "boomeramg": {"pc_type": "hmg", "pc_hmg_reuse_interpolation": "false", "hmg_inner_pc_type": "hypre",
                  "hmg_inner_pc_hypre_type": "boomeramg", "hmg_inner_pc_hypre_boomeramg_numfunctions": "D",
                  "hmg_inner_pc_hypre_boomeramg_strong_threshold": 0.5,
                  "hmg_inner_pc_hypre_boomeramg_coarsen_type": "HMIS",
                  "hmg_inner_pc_hypre_boomeramg_interp_type": "ext+i"},
}


SAVING = {"matptap_via": "allatonce_merged"}
"""PETSc option for products P'KP without the intermediate product K P. It has no prefix and exists on several ranks only."""


class Chebyshev:
    """A smoother of a fixed degree for A - C."""

    def __init__(self, matrix, inverse, largest):
        self.matrix, self.change = matrix, None
        self.inverse, self.largest = inverse, largest
        self._step, self._moved = inverse.duplicate(), inverse.duplicate()
        self._change_moved = inverse.duplicate()

    def subtract_product(self, x, rest):
        """rest -= (A - C) x."""
        self.matrix.mult(x, self._moved)
        rest.axpy(-1.0, self._moved)
        if self.change is not None:
            self.change.mult(x, self._moved)
            rest.axpy(1.0, self._moved)

    def smooth(self, x, rest, updated):
        """Improves x. `rest` is its residual on entry; on return it is the residual of the improved x only if `updated`."""
        step = self._step
        for k in range(1, DEGREE + 1):
            keep, gain = (2 * k - 3) / (2 * k + 1), (8 * k - 4) / (2 * k + 1) / self.largest
            self._moved.pointwiseMult(self.inverse, rest)
            if k == 1:
                self._moved.copy(step)
                step.scale(gain)
            else:
                step.axpby(gain, keep, self._moved)
            x.axpy(1.0, step)
            if k < DEGREE or updated:
                self.subtract_product(step, rest)


class Level:
    """A level that is not the coarsest: its matrix, smoother, and prolongator from the next level."""

    def __init__(self, matrix, prolongator):
        self.matrix, self.prolongator = matrix, prolongator
        self.diagonal = matrix.getDiagonal()
        inverse = self.diagonal.duplicate()
        inverse.array[:] = reciprocal(self.diagonal.array_r)
        self.whole = inverse
        self.largest = SAFETY * largest_eigenvalue(matrix, inverse)
        self.smoother = Chebyshev(matrix, inverse.copy(), self.largest)
        self.x, self.rest, self.force = (inverse.duplicate() for _ in range(3))
        self.coarse = prolongator.createVecRight()


def released(product):
    """Returns a copy of a product of matrices and destroys the product, which would keep its factors alive (K in rows)."""
    copy = product.copy()
    product.destroy()
    return copy


def own_columns(matrix):
    """Returns all columns, each rank its own part. Without this argument PETSc would list all columns on every rank."""
    first, last = matrix.getOwnershipRangeColumn()
    return PETSc.IS().createStride(last - first, first, 1, comm=matrix.comm)


def reciprocal(values):
    return np.divide(1.0, values, out=np.zeros_like(values), where=values > 0.0)


def largest_eigenvalue(matrix, inverse):
    """Returns a lower bound on the largest eigenvalue of D^-1 A, by Lanczos' method from a generic vector."""
    root = inverse.copy()
    root.sqrtabs()
    vector, moved, before = inverse.duplicate(), inverse.duplicate(), None
    first = inverse.getOwnershipRange()[0]
    vector.array[:] = ((first + np.arange(inverse.getLocalSize())) * 0.618033988749895) % 1.0 - 0.5
    scaled = inverse.duplicate()
    vector.normalize()
    diagonal, off, beta = [], [], 0.0
    for _ in range(min(LANCZOS_STEPS, inverse.getSize())):
        scaled.pointwiseMult(root, vector)
        matrix.mult(scaled, moved)
        moved.pointwiseMult(root, moved)
        if before is not None:
            moved.axpy(-beta, before)
        alpha = moved.dot(vector)
        moved.axpy(-alpha, vector)
        diagonal.append(alpha)
        beta = moved.norm()
        if beta <= 1e-12 * abs(alpha):
            break
        off.append(beta)
        before, vector = vector, moved.copy()
        vector.scale(1.0 / beta)
    off = off[: len(diagonal) - 1]
    return float(np.linalg.eigvalsh(np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1)).max())


class Coarsest:
    """The inverse of the coarsest matrix; every rank holds all of it."""

    def __init__(self, matrix):
        self.matrix = matrix
        every = PETSc.IS().createStride(matrix.getSize()[0], 0, 1, comm=PETSc.COMM_SELF)
        self.whole = matrix.createSubMatrices(every, every)[0][:, :] if matrix.getSize()[0] else np.zeros((0, 0))
        self.every = every
        self.x = matrix.createVecRight()
        self.scatter, self.all = PETSc.Scatter.toAll(self.x)
        self.hold(None)

    def hold(self, change, held=None):
        """Inverts A - C, or A with this rank's unknowns `held` fixed. A singular matrix gets a shift."""
        rest = self.whole
        if change is not None:
            rest = rest - change.createSubMatrices(self.every, self.every)[0][:, :]
        if held is not None:
            self.x.set(1.0)
            self.x.array[held] = 0.0
            self.scatter.scatter(self.x, self.all)
            rest = rest * self.all.array_r * self.all.array_r[:, None]
        before, after = np.diag(self.whole), np.diag(rest)
        gone = after <= LOST * before
        scale = np.sqrt(reciprocal(np.where(gone, 0.0, after)))
        rest = scale[:, None] * (0.5 * (rest + rest.T)) * scale
        rest[gone, gone] = 1.0
        values, vectors = np.linalg.eigh(rest)
        self.is_singular = bool(len(values) and values[0] < SINGULAR)
        self.least = float(values[0]) if len(values) else 1.0
        values = values + SHIFT if self.is_singular else values
        self.inverse = scale[:, None] * ((vectors / values) @ vectors.T) * scale

    def solve(self, force, x):
        self.scatter.scatter(force, self.all)
        first, last = x.getOwnershipRange()
        x.array[:] = self.inverse[first:last] @ self.all.array_r


class Hierarchy:
    """The levels of K, and one cycle in the current face. The first face holds the supported dofs only."""

    def __init__(self, bounds, kind="gamg", petsc="", saves_memory=False):
        """`kind` builds the levels, gamg or boomeramg, with the further options `petsc`."""
        self.stiffness = bounds.stiffness
        self.first = self.stiffness.getOwnershipRange()[0]
        self.never, self.candidates = np.flatnonzero(~bounds.problem.is_free), bounds.places
        rows = in_rows(self.stiffness)
        rows.setOption(PETSc.Mat.Option.SPD, True)
        modes = orthonormal(bounds.modes)
        rows.setNearNullSpace(PETSc.NullSpace().create(vectors=modes, comm=rows.comm))
        multigrid = built(rows, kind, petsc, SAVING if saves_memory and rows.comm.size > 1 else {})
        count = multigrid.getMGLevels()
        matrices = [multigrid.getMGSmoother(level).getOperators()[0] for level in range(count - 2, -1, -1)]
        prolongators = [multigrid.getMGInterpolation(level) for level in range(count - 1, 0, -1)]
        multigrid.destroy()
        matrices = [self.stiffness] + [released(matrix) for matrix in matrices]
        prolongators = [released(prolongator) for prolongator in prolongators]
        self.levels = [Level(matrix, prolongator) for matrix, prolongator in zip(matrices, prolongators)]
        self.coarsest = Coarsest(matrices[-1])
        self.is_singular = self.coarsest.is_singular
        """`True` if K is singular, as for a body without supports."""
        inverse = self.stiffness.getDiagonal()
        inverse.reciprocal()
        self.largest = self.levels[0].largest if self.levels else SAFETY * largest_eigenvalue(self.stiffness, inverse)
        if self.levels:
            self._prepare_faces(rows)
        self.hold(np.zeros(len(self.candidates), dtype=bool))

    def unknowns(self):
        return [level.matrix.getSize()[0] for level in self.levels] + [self.coarsest.matrix.getSize()[0]]

    def _prepare_faces(self, stiffness):
        rows = PETSc.IS().createGeneral(self.candidates.astype(PETSC_INT), comm=stiffness.comm)
        prolongator = self.levels[0].prolongator
        of_rows = stiffness.createSubMatrix(rows, own_columns(stiffness))
        self._pb = prolongator.createSubMatrix(rows, own_columns(prolongator))
        self._wb = of_rows.matMult(prolongator)
        self._kbb = stiffness.createSubMatrix(rows, rows)
        self._share = self._kbb.createVecLeft()

    def hold(self, closed):
        """Sets the face. `closed` is a mask over the bounded unknowns that are held."""
        held = np.r_[self.never, self.candidates[closed] - self.first].astype(int)
        self.held = held
        if not self.levels:
            self.coarsest.hold(None, held)
            return
        smoother = self.levels[0].smoother
        self.levels[0].whole.copy(smoother.inverse)
        smoother.inverse.array[held] = 0.0
        changes = self._changes(closed)
        for level, change in zip(self.levels[1:], changes):
            smoother = level.smoother
            smoother.change = change
            smoother.largest = level.largest * (1.0 if change is None else CHANGED)
            level.whole.copy(smoother.inverse)
            if change is not None:
                before, after = level.diagonal.array_r, level.diagonal.array_r - change.getDiagonal().array_r
                smoother.inverse.array[:] = reciprocal(np.where(after > LOST * before, after, 0.0))
        self.coarsest.hold(changes[-1])

    def _changes(self, closed):
        """Returns the matrices C of all levels below the finest."""
        share = self._share
        share.array[:] = closed
        if share.sum() == 0.0:
            return [None] * len(self.levels)
        half = self._kbb.copy()
        half.diagonalScale(L=share, R=share)
        half.scale(-0.5)
        inner = half.matMult(self._pb)
        of_rows = self._wb.copy()
        of_rows.diagonalScale(L=share)
        inner.axpy(1.0, of_rows)
        one_side = self._pb.transposeMatMult(inner)
        change = one_side.transpose(PETSc.Mat())
        change.axpy(1.0, one_side)
        changes = [change]
        for level in self.levels[1:]:
            changes.append(changes[-1].ptap(level.prolongator))
        return changes

    def cycle(self, force, x):
        """Sets x to an approximate displacement in the face under a force. Entries of the force at held dofs have no effect."""
        self._descend(0, force, x)

    def _descend(self, depth, force, x):
        if depth == len(self.levels):
            self.coarsest.solve(force, x)
            return
        level = self.levels[depth]
        rest = level.rest
        force.copy(rest)
        x.zeroEntries()
        level.smoother.smooth(x, rest, updated=True)
        if depth == 0:
            rest.array[self.held] = 0.0
        coarser = self.levels[depth + 1].force if depth + 1 < len(self.levels) else level.coarse
        level.prolongator.multTranspose(rest, coarser)
        correction = self.levels[depth + 1].x if depth + 1 < len(self.levels) else self.coarsest.x
        self._descend(depth + 1, coarser, correction)
        moved = level.smoother._step
        level.prolongator.mult(correction, moved)
        if depth == 0:
            moved.array[self.held] = 0.0
        x.axpy(1.0, moved)
        level.smoother.subtract_product(moved, rest)
        level.smoother.smooth(x, rest, updated=False)


def built(stiffness, kind, petsc, of_products):
    """Returns PETSc's multigrid for K after its set-up. Only its prolongators and coarse matrices are used.

    `of_products`: PETSc options for products of matrices, set during the set-up only.
    """
    own = {PREFIX + name: stiffness.getBlockSize() if value == "D" else value
           for name, value in (OF_LEVELS | OF_KIND[kind]).items()} | of_products
    every = PETSc.Options()
    for name, value in own.items():
        every[name] = value
    words = petsc.split()
    for at, word in enumerate(words):
        if word.startswith("-"):
            value = words[at + 1] if at + 1 < len(words) and not words[at + 1].startswith("-") else ""
            every[PREFIX + word[1:]] = value
    pc = PETSc.PC().create(comm=stiffness.comm)
    pc.setOptionsPrefix(PREFIX)
    pc.setOperators(stiffness)
    try:
        pc.setFromOptions()
        pc.setUp()
    finally:
        # At its end PETSc warns about unused options. Only the options of the user may be misspelled.
        for name in set(own) - {PREFIX + word[1:] for word in words}:
            every.delValue(name)
    return pc

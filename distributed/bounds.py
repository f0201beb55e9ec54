"""Writes contact rows as bounds on single unknowns: x = Q u, where Q reflects the components of each node.

A row with one entry is a bound already. A row along an inclined normal becomes a bound by a reflection of its node. Every
further row of that node must be parallel or perpendicular to the first one.
"""

import numpy as np

from problem import NO_LIMIT, in_rows
from ranks import BAD_INPUT, NO_ANSWER, PETSC_INT, PETSc, Refused, fetch

ROUNDING = 1e-12
"""Components of a unit vector below this value are rounding errors of the reflections."""

FREE, LOWER, UPPER, FIXED = 0, 1, 2, 3
"""The state of a bounded unknown: between its bounds, at one of them, at both (fixed)."""


class Bounds:
    """The bounds of this rank's unknowns, and the map from forces on them to the multipliers of the contact rows."""

    def __init__(self, problem):
        self.problem = problem
        _refuse_coupling_rows(problem)
        self._collect()
        self._turn()
        self._bound()
        self._rotation()

    def _collect(self):
        """Collects the rows of this rank's nodes, each with a normal of D components, sorted by node and row."""
        problem, size = self.problem, self.problem.dimension
        starts, rows, values = problem.contact.transpose(PETSc.Mat()).getValuesCSR()
        places = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        kept = values != 0.0
        places, rows, values = places[kept], rows[kept].astype(np.int64), values[kept]
        key = np.stack((places // size, rows), axis=1)
        pairs, of_pair = np.unique(key, axis=0, return_inverse=True)
        of_pair = of_pair.ravel()
        normals = np.zeros((len(pairs), size))
        normals[of_pair, places % size] = values
        node, row = pairs[:, 0], pairs[:, 1]
        gap = fetch(problem.gap, row)
        near = gap < NO_LIMIT
        self.node, self.row, self.normals, self.gap = node[near], row[near], normals[near], gap[near]

    def _turn(self):
        """Finds the reflections of each node, one of its rows after the other."""
        size, problem = self.problem.dimension, self.problem
        nodes, self.of_row = np.unique(self.node, return_inverse=True)
        turning = np.tile(np.eye(size), (len(nodes), 1, 1))
        owner = np.full((len(nodes), size), -1, dtype=np.int64)
        occurrence = np.arange(len(self.node)) - np.r_[0, np.flatnonzero(np.diff(self.node)) + 1][self.of_row] \
            if len(self.node) else np.zeros(0, dtype=int)
        self.component = np.zeros(len(self.node), dtype=int)
        self.coefficient = np.zeros(len(self.node))
        clash = (np.inf, 0.0)
        for turn in range(int(problem.ranks.max(occurrence.max(initial=-1))) + 1):
            now = np.flatnonzero(occurrence == turn)
            at = self.of_row[now]
            length = np.linalg.norm(self.normals[now], axis=1)
            unit = np.einsum("nij,nj->ni", turning[at], self.normals[now]) / length[:, None]
            unit[np.abs(unit) <= ROUNDING] = 0.0
            first = np.abs(unit).argmax(axis=1)
            along = unit[np.arange(len(now)), first]
            is_single = np.count_nonzero(unit, axis=1) == 1
            taken = (unit != 0.0) & (owner[at] >= 0)
            bad = np.flatnonzero(~is_single & taken.any(axis=1))
            if len(bad):
                worst = bad[np.argmin(self.row[now[bad]])]
                clash = min(clash, (float(self.row[now[worst]]), float(owner[at[worst]][taken[worst]][0])))
            mirror = unit.copy()
            mirror[np.arange(len(now)), first] += np.sign(along)
            mirror /= np.linalg.norm(mirror, axis=1)[:, None]
            mirror[is_single] = 0.0
            turning[at] -= 2.0 * mirror[:, :, None] * np.einsum("ni,nij->nj", mirror, turning[at])[:, None, :]
            self.component[now] = first
            self.coefficient[now] = np.where(is_single, 1.0, -1.0) * np.sign(along) * length
            owner[at, first] = np.where(owner[at, first] < 0, self.row[now], owner[at, first])
        found = problem.ranks.first(*clash)
        if found is not None:
            raise Refused(
                f"contact rows {int(found[1])} and {int(found[0])} (from 0) belong to one node and are neither parallel nor "
                "perpendicular: no rotation turns both into bounds; use signorini solve, which has other methods", BAD_INPUT)
        self.nodes, self.turning = nodes, turning

    def _bound(self):
        """Finds the bounds of each bounded place, and the row and coefficient of its lower and upper side."""
        size = self.problem.dimension
        places = size * self.node + self.component
        self.local, which = np.unique(places, return_inverse=True)
        count = len(self.local)
        value = self.gap / self.coefficient
        self.lower, self.upper = np.full(count, -np.inf), np.full(count, np.inf)
        self.side_row, self.side_coefficient = np.full((2, count), -1, dtype=np.int64), np.ones((2, count))
        for side, limit in ((0, self.lower), (1, self.upper)):
            sign = 1.0 if side else -1.0
            of_side = np.flatnonzero(self.coefficient * sign > 0.0)
            # Later entries overwrite earlier ones: the tightest bound comes last; of equal bounds, the first row.
            order = of_side[np.lexsort((-self.row[of_side], -sign * value[of_side]))]
            limit[which[order]] = value[order]
            self.side_row[side, which[order]] = self.row[order]
            self.side_coefficient[side, which[order]] = self.coefficient[order]
        apart = self.lower - self.upper > ROUNDING * (np.abs(self.lower) + np.abs(self.upper))
        bad = np.flatnonzero(apart & np.isfinite(self.lower) & np.isfinite(self.upper))
        found = self.problem.ranks.first(*((*self.side_row[:, bad[0]],) if len(bad) else (np.inf, 0)))
        if found is not None:
            raise Refused(f"contact rows {int(found[0])} and {int(found[1])} (from 0) contradict each other: no displacement "
                          "meets both", NO_ANSWER)
        np.minimum(self.lower, self.upper, out=self.lower)
        self.places = self.local + self.problem.first

    def _rotation(self):
        """Transforms K, f and the modes to the rotated unknowns."""
        problem, size = self.problem, self.problem.dimension
        is_turned = np.any(self.turning != np.eye(size), axis=(1, 2))
        self.is_plain = problem.ranks.sum(is_turned.sum()) == 0
        self.stiffness, self.load, self.modes = problem.stiffness, problem.load, problem.modes
        if self.is_plain:
            return
        own = problem.last - problem.first
        blocks = np.tile(np.eye(size), (own // size, 1, 1))
        # u = Q' x.
        blocks[self.nodes[is_turned]] = self.turning[is_turned].transpose(0, 2, 1)
        back = PETSc.Mat().create(comm=problem.ranks.comm)
        back.setSizes(((own, problem.stiffness.getSize()[0]),) * 2)
        back.setBlockSize(size)
        back.setType("aij")
        starts = np.arange(0, size * own + 1, size, dtype=PETSC_INT)
        columns = problem.first + size * (np.arange(own) // size)[:, None] + np.arange(size)
        back.setPreallocationCSR((starts, columns.ravel().astype(PETSC_INT), blocks.ravel()))
        back.assemble()
        self._back = back
        self.stiffness = in_rows(problem.stiffness).ptap(back)
        self.stiffness.setBlockSize(size)
        self.load = self.turned(problem.load)
        self.modes = [self.turned(mode) for mode in problem.modes]

    def turned(self, displacement):
        """x = Q u."""
        x = displacement.duplicate()
        if self.is_plain:
            displacement.copy(x)
        else:
            self._back.multTranspose(displacement, x)
        return x

    def turned_back(self, x):
        """u = Q' x."""
        u = x.duplicate()
        if self.is_plain:
            x.copy(u)
        else:
            self._back.mult(x, u)
        return u

    def on_rows(self, rows, values):
        """Returns a vector over the contact rows: `values` at `rows`, zero elsewhere."""
        vector = self.problem.gap.duplicate()
        vector.zeroEntries()
        vector.setValues(rows.astype(PETSC_INT), values)
        vector.assemble()
        return vector

    def multipliers(self, force):
        """Returns the multipliers for given forces on the bounded unknowns. A negative force comes from the upper bound."""
        side = (force < 0.0).astype(int)
        index = np.arange(len(force))
        rows, coefficients = self.side_row[side, index], self.side_coefficient[side, index]
        acting = (force != 0.0) & (rows >= 0)
        return self.on_rows(rows[acting], force[acting] / coefficients[acting])

    def closed_sides(self, multiplier):
        """Returns two masks over the bounded unknowns: the multiplier of the lower side is nonzero, that of the upper side is."""
        return [(fetch(multiplier, np.maximum(rows, 0)) < 0.0) & (rows >= 0) for rows in self.side_row]


def _refuse_coupling_rows(problem):
    """Refuses rows that couple several nodes, and empty rows with a negative gap."""
    size = problem.dimension
    starts, columns, values = problem.contact.getValuesCSR()
    first = problem.gap.getOwnershipRange()[0]
    rows = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    gap = problem.gap.array_r
    kept = (values != 0.0) & (gap[rows] < NO_LIMIT)
    rows, nodes = rows[kept], columns[kept] // size
    count = len(starts) - 1
    least, most = np.full(count, np.iinfo(np.int64).max), np.full(count, -1)
    np.minimum.at(least, rows, nodes)
    np.maximum.at(most, rows, nodes)
    bad = np.flatnonzero(least < most)
    found = problem.ranks.first(*((first + bad[0], least[bad[0]], most[bad[0]]) if len(bad) else (np.inf, 0, 0)))
    if found is not None:
        row, one, other = (int(number) for number in found)
        raise Refused(f"contact row {row} (from 0) couples nodes {one} and {other}, as rows between two bodies do: no rotation "
                      "of a node turns it into a bound; use signorini solve, which has other methods", BAD_INPUT)
    unmet = np.flatnonzero((most < 0) & (gap < 0.0))
    found = problem.ranks.first(*((first + unmet[0], gap[unmet[0]]) if len(unmet) else (np.inf, 0)))
    if found is not None:
        raise Refused(f"contact row {int(found[0])} (from 0) has no entry and a gap of {found[1]:g}: no displacement meets it",
                      NO_ANSWER)

"""Recomputes every optimality condition from the problem as it was read, and bounds the error in the energy norm.

`signorini verify` prints the same numbers; src/qp/certificate defines them. For a feasible v and multipliers mu <= 0 that
vanish on rows which v does not touch,

    |u - u*|_K <= |u - v|_K + |f + B' mu - K v|_{K^-1}

v is the answer, moved so that each touching or penetrating row lies exactly at its gap. Conjugate gradients, preconditioned
by the multigrid cycle M, give the dual norm: for any z with the residual s = r - K z,

    r' K^-1 r = z' (r + s) + s' K^-1 s,     s' K^-1 s <= s' M s / theta

theta is half the smallest Ritz value of M K. It is an estimate, therefore the bound is called measured, not proven. If K is
singular, springs on the pressing rows replace the missing supports.
"""

import numpy as np

from problem import NO_LIMIT
from ranks import PETSc, fetch, generic, larger

ENTRY_ROUNDING = np.finfo(float).eps
"""Rounding of u and lambda changes a sum by up to this share of its terms."""

AT_REST = 1e-6
"""A body is at rest if its energy norm is below this share of the largest energy norm that its forces give to one dof."""

ROUNDED_BOUND = 1.0 + 1e-6
"""Factor that covers the rounding of the bound itself."""

SAFETY, REST_SHARE, SETTLED_RITZ, MOST_CYCLES = 0.5, 0.1, 0.15, 60
"""In order: the factor on the smallest Ritz value; the largest share of the squared dual norm that is only bounded, not
computed; the largest relative decrease of the Ritz value in its last step; the cycles after which no bound is found."""

PRESSING = 1e-8
"""A row presses if its force alone would give the body more than this share of its energy norm."""

LOOKED = 25
"""Number of conjugate gradient steps that look for a direction of negative energy."""

NEGATIVE = 1e-12
"""Negative energy below this share of the sum of K_ii x_i^2 is a rounding error."""

CHUNK = 20_000
"""Number of rows that are summed at once in extended precision."""


def certify(problem, bounds, hierarchy, u, multiplier, tolerance):
    """Returns the conditions and the bound as a dictionary, whether all hold to `tolerance`, and the number of cycles."""
    answer = Answer(problem, u, multiplier)
    numbers = answer.conditions()
    bound, cycles = answer.bound(bounds, hierarchy)
    numbers |= answer.judged(bound)
    held = ("stationarity_excess", "penetration", "adhesion", "complementarity", "duality_gap", "energy_error_excess")
    is_certified = all(numbers[name] <= tolerance for name in held) and np.isfinite(bound)
    return numbers, is_certified, cycles


def accurate_product(ranks, matrix, vector):
    """Returns M v and |M| |v| for this rank's rows; the first in extended precision if the machine has it."""
    starts, columns, values = matrix.getValuesCSR()
    rows = len(starts) - 1
    sums, terms = np.zeros(rows, dtype=np.longdouble), np.zeros(rows)
    for start in range(0, int(ranks.max(float(rows))), CHUNK):
        ends = starts[min(start, rows) : min(start + CHUNK, rows) + 1]
        part = slice(ends[0], ends[-1])
        factors, of_part = at_columns(vector, columns[part]), values[part]
        filled = np.flatnonzero(np.diff(ends))
        if len(filled):
            at, filled = ends[:-1][filled] - ends[0], filled + start
            sums[filled] = np.add.reduceat(np.multiply(of_part, factors, dtype=np.longdouble), at)
            terms[filled] = np.add.reduceat(np.abs(of_part * factors), at)
    return sums, terms


def at_columns(vector, columns):
    """Returns the values of a vector at the given columns, most of which belong to this rank."""
    first, last = vector.getOwnershipRange()
    own = (columns >= first) & (columns < last)
    values = np.empty(len(columns))
    values[own] = vector.array_r[columns[own] - first]
    needed, of_entry = np.unique(columns[~own], return_inverse=True)
    values[~own] = fetch(vector, needed)[of_entry]
    return values


def relative(value, scale):
    return 0.0 if value == 0.0 else (value / scale if scale > 0.0 else np.inf)


class Answer:
    """An answer with its forces, distances and the scales of both."""

    def __init__(self, problem, u, multiplier):
        self.problem, self.ranks = problem, problem.ranks
        self.u, self.multiplier = u, multiplier
        stiffness, rows = problem.stiffness, problem.contact
        self.diagonal = stiffness.getDiagonal().array_r.copy()
        self.load, self.gap, force = problem.load.array_r, problem.gap.array_r, multiplier.array_r
        own_u = u.array_r.astype(np.longdouble)

        # Magnitudes of the contact rows of this rank.
        starts, columns, values = rows.getValuesCSR()
        row_of = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        root = problem.load.duplicate()
        root.array[:] = np.sqrt(self.diagonal)
        roots = at_columns(root, columns)
        count = len(starts) - 1
        self.reach, self.compliance = np.zeros(count), np.zeros(count)
        np.maximum.at(self.reach, row_of, np.abs(values) / roots)
        np.add.at(self.compliance, row_of, (values / roots) ** 2)
        sums, squares = np.zeros(count), np.zeros(count)
        np.add.at(sums, row_of, np.abs(values) * roots)
        np.add.at(squares, row_of, values**2)
        self.along = np.divide(sums, squares, out=np.zeros(count), where=squares > 0.0)

        moved, self.lengths = accurate_product(self.ranks, rows, u)
        limited = self.gap < NO_LIMIT
        self.violation = np.where(limited, (moved - np.where(limited, self.gap, 0.0)).astype(float), -np.inf)
        self.counts = limited | (force != 0.0)

        transposed = rows.transpose(PETSc.Mat())
        contact, self.contact_terms = accurate_product(self.ranks, transposed, multiplier)
        self.contact = contact.astype(float)
        forces, self.terms = accurate_product(self.ranks, stiffness, u)
        self.residual = (self.load - forces + contact).astype(float)
        self.strain, self.rounding, load_work, gap_work = self.ranks.sum(
            np.dot(own_u, forces), np.dot(np.abs(u.array_r), self.terms), np.dot(u.array_r, self.load),
            np.dot(np.where(limited, self.gap, 0.0), force))
        self.softness = 1.0 / np.sqrt(self.diagonal)
        largest = np.maximum(np.abs(self.load), np.abs(self.contact)) * self.softness
        self.force = self.ranks.max(larger(largest))
        self.norm = np.sqrt(max(self.strain, 0.0))
        self.size = max(self.norm, AT_REST * self.force)
        self.energy = max(self.norm**2 / 2.0, abs(load_work), abs(gap_work), AT_REST * self.force**2 / 2.0)

    def conditions(self):
        force = self.multiplier.array_r
        is_rounding = np.abs(self.residual) <= ENTRY_ROUNDING * (self.terms + self.contact_terms)
        excess = np.where(is_rounding, 0.0, self.residual)
        explained = (force == 0.0) | (np.abs(self.violation) <= ENTRY_ROUNDING * self.lengths)
        work = np.where(explained, 0.0, force * np.where(np.isfinite(self.violation), self.violation, -np.inf))
        work = np.where(force == 0.0, 0.0, work)
        scale = np.maximum(self.lengths, np.maximum(np.where(self.gap < NO_LIMIT, np.abs(self.gap), 0.0), self.size * self.reach))
        depth = np.maximum(self.violation, 0.0)
        penetration = np.divide(depth, scale, out=np.where(depth > 0.0, np.inf, 0.0), where=scale > 0.0)
        table = self.ranks.gather((
            larger(self.residual * self.softness), larger(excess * self.softness),
            larger(penetration[self.counts]), larger((np.maximum(force, 0.0) * self.reach)[self.counts]),
            larger(work[self.counts]), np.dot(-self.u.array_r, excess) + work.sum()))
        stationarity, without_rounding, penetration, adhesion, work = table[:, :5].max(axis=0)
        return {
            "stationarity": relative(stationarity, self.force),
            "stationarity_excess": relative(without_rounding, self.force),
            "penetration": float(penetration),
            "adhesion": relative(adhesion, self.force),
            "complementarity": relative(work, self.energy),
            "duality_gap": relative(abs(table[:, 5].sum()), self.energy),
        }

    def bound(self, bounds, hierarchy):
        """Returns an upper bound on |u - u*|_K, infinite if none is found, and the number of cycles."""
        force = self.multiplier.array_r
        residual = self.problem.load.duplicate()
        residual.array[:] = self.residual
        pulled = self.multiplier.duplicate()
        pulled.array[:] = np.maximum(force, 0.0)
        if pulled.max()[1] > 0.0:
            pull = residual.duplicate()
            self.problem.contact.multTranspose(pulled, pull)
            residual.axpy(-1.0, pull)
        residual = bounds.turned(residual)
        hierarchy.hold(np.zeros(len(bounds.places), dtype=bool))
        product = bounds.stiffness.mult
        springs, looked = None, 0
        if hierarchy.coarsest.is_singular:
            looked = LOOKED
            if not is_semidefinite(bounds, hierarchy):
                return np.inf, looked
            springs = self._springs()
            product = self._product_with(springs, bounds)
        dual, cycles = dual_norm(self.ranks, product, hierarchy, residual)
        left = ROUNDED_BOUND * dual
        if springs is not None:
            fails = (springs > 0.0) & ~(-force >= 2.0 * np.sqrt(springs) * left)
            if not np.isfinite(left) or self.ranks.max(float(fails.any())) > 0.0 or self.ranks.max(larger(springs)) == 0.0:
                return np.inf, looked + cycles
        touching = (self.violation > 0.0) | ((force < 0.0) & (self.violation != 0.0))
        moved = self.ranks.sum(np.dot(self.along[touching], np.abs(self.violation[touching])))
        return 2.0 * ROUNDED_BOUND * moved + left, looked + cycles

    def _springs(self):
        """Returns a spring for each pressing row: its stiffness when all dofs outside the row are fixed."""
        force = -self.multiplier.array_r
        stiffness = np.divide(1.0, self.compliance, out=np.zeros_like(self.compliance), where=self.compliance > 0.0)
        presses = (force > PRESSING * np.sqrt(stiffness) * self.norm) & (force * self.compliance >= -self.violation)
        return np.where(presses & (force > 0.0), stiffness, 0.0)

    def _product_with(self, springs, bounds):
        of_rows = self.multiplier.duplicate()
        of_rows.array[:] = springs
        share = np.zeros(len(bounds.local))
        for rows, coefficient in zip(bounds.side_row, bounds.side_coefficient):
            share += np.where(rows >= 0, coefficient**2 * fetch(of_rows, np.maximum(rows, 0)), 0.0)

        def product(x, y):
            bounds.stiffness.mult(x, y)
            pull = share * x.array_r[bounds.local]
            y.array[bounds.local] += pull

        return product

    def judged(self, bound):
        """Returns the bound relative to the energy norm. A bound that rounding of u explains has no excess."""
        least = 1e-28 * np.sqrt(self.rounding)
        size = max(np.sqrt(max(self.strain - 1e-31 * self.rounding, 0.0)), AT_REST * self.force)
        error = bound + least
        explained = error <= ENTRY_ROUNDING * np.sqrt(self.rounding)
        share = relative(error, size)
        return {"energy_error_bound": share, "energy_error_excess": 0.0 if explained else share, "bound_is_measured": True}


def is_semidefinite(bounds, hierarchy):
    """Returns whether conjugate gradients from a generic force meet no direction of negative energy."""
    stiffness, rest = bounds.stiffness, generic(bounds.load)
    rest.array[hierarchy.never] = 0.0
    diagonal = stiffness.getDiagonal()
    step, p, moved, scaled, energy = rest.duplicate(), None, rest.duplicate(), rest.duplicate(), 1.0
    for _ in range(LOOKED):
        hierarchy.cycle(rest, step)
        if p is None:
            p = step.copy()
        else:
            p.aypx(-step.dot(moved) / energy, step)
        stiffness.mult(p, moved)
        energy = p.dot(moved)
        scaled.pointwiseMult(diagonal, p)
        if energy <= NEGATIVE * scaled.dot(p):
            return energy >= -NEGATIVE * scaled.dot(p)
        rest.axpy(-p.dot(rest) / energy, moved)
    return True


def dual_norm(ranks, product, hierarchy, force):
    """Returns an upper bound on sqrt(r' K^-1 r), infinite if the Ritz value does not converge, and the number of cycles."""
    rest, solution = force.copy(), force.duplicate()
    solution.zeroEntries()
    p, moved, step = None, force.duplicate(), force.duplicate()
    lengths, shares, ritz, energy = [], [], np.inf, 1.0
    for cycles in range(1, MOST_CYCLES + 1):
        hierarchy.cycle(rest, step)
        known, in_cycle, along, left = ranks.sum(
            np.dot(solution.array_r, force.array_r) + np.dot(solution.array_r, rest.array_r),
            np.dot(rest.array_r, step.array_r), np.dot(step.array_r, moved.array_r), np.abs(rest.array_r).sum())
        if left == 0.0:
            return np.sqrt(max(known, 0.0)), cycles - 1
        if p is None:
            p = step.copy()
        else:
            earlier, ritz = ritz, least_eigenvalue(lengths, shares)
            unknown = in_cycle / (SAFETY * ritz)
            if unknown <= REST_SHARE * known and ritz >= (1.0 - SETTLED_RITZ) * earlier:
                return np.sqrt(max(known + unknown, 0.0)), cycles
            shares.append(-along / energy)
            p.aypx(shares[-1], step)
        product(p, moved)
        energy, work = ranks.sum(np.dot(p.array_r, moved.array_r), np.dot(p.array_r, rest.array_r))
        if not (energy > 0.0 and work > 0.0):
            break
        lengths.append(work / energy)
        solution.axpy(lengths[-1], p)
        rest.axpy(-lengths[-1], moved)
    return np.inf, cycles


def least_eigenvalue(lengths, shares):
    """Returns that of the Lanczos matrix which belongs to these step lengths and direction updates of conjugate gradients."""
    lengths = np.array(lengths)
    shares = np.maximum(np.array(shares[: len(lengths) - 1]), 0.0)
    diagonal = 1.0 / lengths
    diagonal[1:] += shares / lengths[:-1]
    off = np.sqrt(shares) / lengths[:-1]
    return float(np.linalg.eigvalsh(np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1))[0])

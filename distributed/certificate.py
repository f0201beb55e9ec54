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

from parts import Parts
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

OF_ENERGY, LEAST = 1e-31, 1e-28
"""Of the rounding of a strain energy: the share that may be missing from it, and the least error for its square root."""

CHUNK = 20_000
"""Number of rows that are summed at once in extended precision."""


def certify(problem, bounds, hierarchy, u, multiplier, tolerance):
    """Returns the conditions and the bound as a dictionary, whether all hold to `tolerance`, and the number of cycles."""
    answer = Answer(problem, u, multiplier)
    numbers = answer.conditions()
    bound, cycles = answer.bound(bounds, hierarchy)
    numbers |= answer.judged(*bound)
    held = ("stationarity_excess", "penetration", "adhesion", "complementarity", "duality_gap", "energy_error_excess")
    is_certified = all(numbers[name] <= tolerance for name in held) and np.isfinite(bound[0])
    return numbers, is_certified, cycles


def accurate_product(ranks, matrix, vector):
    """Returns M v and |M| |v| for this rank's rows; the first in extended precision if the machine has it.

    `matrix` are this rank's rows in compressed form: starts, columns and values.
    """
    starts, columns, values = matrix
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


def relative(values, scales):
    """Returns values / scales: 0 for a value of 0, infinity for another value with a scale of 0."""
    values, scales = np.asarray(values, dtype=float), np.asarray(scales, dtype=float)
    shares = np.where(values == 0.0, 0.0, np.inf)
    return np.divide(values, scales, out=shares, where=(values != 0.0) & (scales > 0.0))


def worst(values, scales):
    """Returns the largest relative value over all parts."""
    return float(relative(values, scales).max())


class Answer:
    """An answer with its forces, distances and the scales of both."""

    def __init__(self, problem, u, multiplier):
        self.problem, self.ranks = problem, problem.ranks
        self.u, self.multiplier = u, multiplier
        stiffness, rows = problem.stiffness, problem.contact.getValuesCSR()
        self.diagonal = stiffness.getDiagonal().array_r.copy()
        self.load, self.gap, force = problem.load.array_r, problem.gap.array_r, multiplier.array_r
        own_u = u.array_r.astype(np.longdouble)

        # Magnitudes of the contact rows of this rank.
        starts, columns, values = rows
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

        transposed = problem.contact.transpose(PETSc.Mat()).getValuesCSR()
        contact, self.contact_terms = accurate_product(self.ranks, transposed, multiplier)
        self.contact = contact.astype(float)
        stiffness = stiffness.getValuesCSR()
        forces, self.terms = accurate_product(self.ranks, stiffness, u)
        if problem.parts is None:
            problem.parts = Parts(problem, *stiffness[:2])
        del stiffness
        self.residual = (self.load - forces + contact).astype(float)
        self._scale(np.asarray(own_u * forces, dtype=float), np.where(limited, self.gap, 0.0) * force)

    def _scale(self, strain, gap_work):
        """The size, force and energy of each part, from the strain energy of the places and the work of the gaps."""
        parts = self.parts = self.problem.parts
        self.part, self.part_of_row = parts.of_place, parts.of_rows(self.problem)
        self.strain, self.rounding, load_work, gap_work = parts.sums(
            (strain, self.part), (np.abs(self.u.array_r) * self.terms, self.part),
            (self.u.array_r * self.load, self.part), (gap_work, self.part_of_row))
        self.softness = 1.0 / np.sqrt(self.diagonal)
        largest = np.maximum(np.abs(self.load), np.abs(self.contact)) * self.softness
        self.force = parts.largest(largest, self.part)
        self.norm = np.sqrt(np.maximum(self.strain, 0.0))
        self.size = np.maximum(self.norm, AT_REST * self.force)
        self.energy = np.maximum.reduce((self.norm**2 / 2.0, np.abs(load_work), np.abs(gap_work),
                                         AT_REST * self.force**2 / 2.0))

    def conditions(self):
        force = self.multiplier.array_r
        is_rounding = np.abs(self.residual) <= ENTRY_ROUNDING * (self.terms + self.contact_terms)
        excess = np.where(is_rounding, 0.0, self.residual)
        explained = (force == 0.0) | (np.abs(self.violation) <= ENTRY_ROUNDING * self.lengths)
        work = np.where(explained, 0.0, force * np.where(np.isfinite(self.violation), self.violation, -np.inf))
        work = np.where(force == 0.0, 0.0, work)
        gap = np.where(self.gap < NO_LIMIT, np.abs(self.gap), 0.0)
        scale = np.maximum.reduce((self.lengths, gap, self.size[self.part_of_row] * self.reach))
        depth = np.maximum(self.violation, 0.0)
        penetration = np.divide(depth, scale, out=np.where(depth > 0.0, np.inf, 0.0), where=scale > 0.0)
        parts, counts = self.parts, self.counts
        pull = np.maximum(force, 0.0) * self.reach
        gaps = parts.sums((-self.u.array_r * excess, self.part), (work, self.part_of_row)).sum(axis=0)
        return {
            "stationarity": worst(parts.largest(self.residual * self.softness, self.part), self.force),
            "stationarity_excess": worst(parts.largest(excess * self.softness, self.part), self.force),
            "penetration": float(self.ranks.max(larger(penetration[counts]))),
            "adhesion": worst(parts.largest(pull[counts], self.part_of_row[counts]), self.force),
            "complementarity": worst(parts.largest(work[counts], self.part_of_row[counts]), self.energy),
            "duality_gap": worst(np.abs(gaps), self.energy),
        }

    def bound(self, bounds, hierarchy):
        """Returns upper bounds on |u - u*|_K, of the whole and of each part, and the number of cycles.

        The bounds are infinite if none is found.
        """
        nothing = np.inf, np.full(self.parts.count, np.inf)
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
                return nothing, looked
            springs = self._springs()
            product = self._product_with(springs, bounds)
        dual, cycles = dual_norm(self.parts, product, hierarchy, residual, self.diagonal)
        left = ROUNDED_BOUND * dual
        if springs is not None:
            fails = (springs > 0.0) & ~(-force >= 2.0 * np.sqrt(springs) * np.sqrt((left**2).sum()))
            if not np.all(np.isfinite(left)) or self.ranks.max(float(fails.any())) > 0.0 \
                    or self.ranks.max(larger(springs)) == 0.0:
                return nothing, looked + cycles
        touching = (self.violation > 0.0) | ((force < 0.0) & (self.violation != 0.0))
        lengths = self.along[touching] * np.abs(self.violation[touching])
        moved = 2.0 * ROUNDED_BOUND * self.parts.sums((lengths, self.part_of_row[touching]))[0]
        return (moved.sum() + np.sqrt((left**2).sum()), moved + left), looked + cycles

    def _springs(self):
        """Returns a spring for each pressing row: its stiffness when all dofs outside the row are fixed."""
        force = -self.multiplier.array_r
        stiffness = np.divide(1.0, self.compliance, out=np.zeros_like(self.compliance), where=self.compliance > 0.0)
        least = PRESSING * np.sqrt(stiffness) * self.norm[self.part_of_row]
        presses = (force > least) & (force * self.compliance >= -self.violation)
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

    def judged(self, whole, of_parts):
        """Returns the bounds relative to the energy norms. A bound that rounding of u explains has no excess."""
        strain, rounding = np.r_[self.strain.sum(), self.strain], np.r_[self.rounding.sum(), self.rounding]
        force = np.r_[self.force.max(), self.force]
        sure = np.maximum(strain - OF_ENERGY * rounding, 0.0)
        size = np.maximum(np.sqrt(sure), AT_REST * force)
        error = np.r_[whole, of_parts] + LEAST * np.sqrt(rounding)
        share = relative(error, size)
        excess = np.where(error <= ENTRY_ROUNDING * np.sqrt(rounding), 0.0, share)
        return {"energy_error_bound": float(share[0]), "part_error_bound": float(share.max()),
                "energy_error_excess": float(excess.max()), "bound_is_measured": True, "parts": self.parts.count}


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


def dual_norm(parts, product, hierarchy, force, diagonal):
    """Returns upper bounds on sqrt(r_p' K^-1 r_p) of each part p, and the number of cycles.

    The bounds are infinite if the Ritz value does not converge. The conjugate gradients work on the forces of all parts at
    once, scaled to the same size: otherwise the Ritz value would not see the parts with small forces.
    """
    part = parts.of_place
    sizes = np.sqrt(parts.sums((force.array_r**2 / diagonal, part))[0])
    sizes[sizes == 0.0] = 1.0
    force = force.copy()
    force.array[:] /= sizes[part]
    rest, solution = force.copy(), force.duplicate()
    solution.zeroEntries()
    p, moved, step = None, force.duplicate(), force.duplicate()
    lengths, shares, ritz, energy = [], [], np.inf, 1.0
    for cycles in range(1, MOST_CYCLES + 1):
        hierarchy.cycle(rest, step)
        known, in_cycle, along, left = parts.sums(
            (solution.array_r * (force.array_r + rest.array_r), part), (rest.array_r * step.array_r, part),
            (step.array_r * moved.array_r, part), (np.abs(rest.array_r), part))
        if left.sum() == 0.0:
            return sizes * np.sqrt(np.maximum(known, 0.0)), cycles - 1
        if p is None:
            p = step.copy()
        else:
            earlier, ritz = ritz, least_eigenvalue(lengths, shares)
            unknown = in_cycle / (SAFETY * ritz)
            if unknown.sum() <= REST_SHARE * known.sum() and ritz >= (1.0 - SETTLED_RITZ) * earlier:
                return sizes * np.sqrt(np.maximum(known + unknown, 0.0)), cycles
            shares.append(-along.sum() / energy)
            p.aypx(shares[-1], step)
        product(p, moved)
        energy, work = parts.ranks.sum(np.dot(p.array_r, moved.array_r), np.dot(p.array_r, rest.array_r))
        if not (energy > 0.0 and work > 0.0):
            break
        lengths.append(work / energy)
        solution.axpy(lengths[-1], p)
        rest.axpy(-lengths[-1], moved)
    return np.full(parts.count, np.inf), cycles


def least_eigenvalue(lengths, shares):
    """Returns that of the Lanczos matrix which belongs to these step lengths and direction updates of conjugate gradients."""
    lengths = np.array(lengths)
    shares = np.maximum(np.array(shares[: len(lengths) - 1]), 0.0)
    diagonal = 1.0 / lengths
    diagonal[1:] += shares / lengths[:-1]
    off = np.sqrt(shares) / lengths[:-1]
    return float(np.linalg.eigvalsh(np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1))[0])

"""Recomputes every optimality condition from the problem as it was read, and bounds the error in the energy norm.

`signorini verify` prints the same numbers; crates/qp/src/certificate defines them. For a feasible v and multipliers mu <= 0 that
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

DIGITS_OF_DOUBLES = 16.0
"""Significant digits that a double holds."""

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


def certify(problem, bounds, hierarchy, u, multiplier, tolerance, rests=False):
    """Returns the conditions and the bound as a dictionary, whether all hold to `tolerance`, and the number of cycles.

    With `rests`, a part is put at rest in `u` if its error may be as large as its displacement.
    """
    answer = Answer(problem, u, multiplier)
    numbers = answer.conditions()
    bound, cycles, ritz = answer.bound(bounds, hierarchy)
    judged, may_rest = answer.judged(*bound, 1.0 / min(ritz, 1.0))
    numbers |= judged
    held = ("imbalance", "penetration", "open_force", "energy_error_excess")
    is_certified = all(numbers[name] <= tolerance for name in held) and numbers["adhesion"] == 0.0 and np.isfinite(bound[0])
    if rests and not is_certified and may_rest.any():
        u.array[may_rest[answer.part]] = 0.0
        return certify(problem, bounds, hierarchy, u, multiplier, tolerance)
    deciding = max(numbers["part_error_bound"], numbers["imbalance"], numbers["penetration"], numbers["open_force"])
    numbers["met_tolerance"] = deciding if numbers["adhesion"] == 0.0 else np.inf
    if is_certified:
        numbers["met"] = "tolerance" if numbers["part_error_bound"] <= tolerance else "rounding"
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
        self.elastic = np.abs(forces).astype(float)
        self.forces = self.contact_terms + np.abs(self.load)
        self.total = self.terms + self.forces
        total = problem.load.duplicate()
        total.array[:] = self.total
        self.share_of_row = np.zeros(count)
        np.maximum.at(self.share_of_row, row_of, relative(np.abs(values * force[row_of]), at_columns(total, columns)))
        self._scale(np.asarray(own_u * forces, dtype=float))

    def _scale(self, strain):
        """The size and force of each part, from the strain energy of the places."""
        parts = self.parts = self.problem.parts
        self.part, self.part_of_row = parts.of_place, parts.of_rows(self.problem)
        self.softness = 1.0 / np.sqrt(self.diagonal)
        self.strain, self.rounding, squares = parts.sums(
            (strain, self.part), (np.abs(self.u.array_r) * self.terms, self.part),
            ((self.forces * self.softness) ** 2, self.part))
        self.force, self.force_root = parts.largest(self.forces * self.softness, self.part), np.sqrt(squares)
        self.moves = parts.largest(self.u.array_r, self.part) > 0.0
        self.norm = np.sqrt(np.maximum(self.strain, 0.0))

    def conditions(self):
        force, counts, of_row = self.multiplier.array_r, self.counts, self.part_of_row
        excess = np.where(np.abs(self.residual) <= ENTRY_ROUNDING * self.total, 0.0, self.residual)
        gap = np.where(self.gap < NO_LIMIT, np.abs(self.gap), 0.0)
        length = np.maximum.reduce((self.lengths, gap, self.norm[of_row] * self.reach))
        # A part that rests is known only to the rounding of its forces.
        rest = np.where(self.moves, 0.0, ENTRY_ROUNDING * self.force_root)[of_row] * self.reach
        distance = np.where(np.abs(self.violation) <= ENTRY_ROUNDING * self.lengths + rest, 0.0, self.violation)
        depth, opening = relative(np.maximum(distance, 0.0), length), relative(np.maximum(-distance, 0.0), length)
        work = np.where(force == 0.0, 0.0, force * np.where(force == 0.0, 0.0, self.violation))
        gaps = self.parts.sums((-self.u.array_r * self.residual, self.part), (work, of_row)).sum()
        strain = max(self.strain.sum(), 0.0)
        parts = self.parts
        of_parts = parts.largest(excess * self.softness, self.part), parts.largest(self.total * self.softness, self.part)

        def most(values):
            return float(self.ranks.max(larger(values)))

        return {
            "stationarity": most(relative(np.abs(self.residual), self.total)),
            "penetration": most(depth[counts]),
            "adhesion": most(np.where(force > 0.0, self.share_of_row, 0.0)[counts]),
            "complementarity": worst(most(np.abs(work[counts])), strain),
            "duality_gap": worst(abs(gaps), strain),
            "imbalance": worst(*of_parts),
            "open_force": most(np.minimum(opening, self.share_of_row)[counts]),
        }

    def bound(self, bounds, hierarchy):
        """Returns upper bounds on |u - u*|_K, of the whole and of each part, the number of cycles, and the least Ritz value.

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
                return nothing, looked, 1.0
            springs = self._springs()
            product = self._product_with(springs, bounds)
        dual, cycles, ritz = dual_norm(self.parts, product, hierarchy, residual, self.diagonal)
        left = ROUNDED_BOUND * dual
        if springs is not None:
            fails = (springs > 0.0) & ~(-force > 2.0 * np.sqrt(springs) * np.sqrt((left**2).sum()))
            if not np.all(np.isfinite(left)) or self.ranks.max(float(fails.any())) > 0.0 \
                    or self.ranks.max(larger(springs)) == 0.0:
                return nothing, looked + cycles, ritz
        touching = (self.violation > 0.0) | ((force < 0.0) & (self.violation != 0.0))
        lengths = self.along[touching] * np.abs(self.violation[touching])
        moved = 2.0 * ROUNDED_BOUND * self.parts.sums((lengths, self.part_of_row[touching]))[0]
        return (moved.sum() + np.sqrt((left**2).sum()), moved + left), looked + cycles, ritz

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

    def judged(self, whole, of_parts, loss):
        """Returns the bounds relative to the energy norms, and for each part whether it may rest.

        A bound that rounding of u explains has no excess. A part without displacement rests if its bound is the rounding of its
        forces, amplified by `loss`: it has no relative error. The whole has none if nothing moves.
        """
        strain, rounding = np.r_[self.strain.sum(), self.strain], np.r_[self.rounding.sum(), self.rounding]
        certain = np.sqrt(np.maximum(strain - OF_ENERGY * rounding, 0.0))
        error = np.r_[whole, of_parts] + LEAST * np.sqrt(rounding)
        share, explained = relative(error, certain), error <= ENTRY_ROUNDING * np.sqrt(rounding)
        rests = ~self.moves & (error[1:] <= ENTRY_ROUNDING * loss * self.force_root)
        counts = np.r_[self.moves.any(), ~rests]
        excess = np.where(counts & ~explained, share, 0.0)
        may_rest = self.moves & np.isfinite(error[1:]) & (error[1:] >= certain[1:]) & ~explained[1:]
        farthest = int(np.argmax(excess))
        return {"energy_error": float(error[0]), "energy_error_bound": float(share[0]),
                "part_error_bound": float(np.where(counts, share, 0.0).max()),
                "energy_error_excess": float(excess.max()), "at_rest": bool(rests.all()),
                "rest_error": float(np.where(rests, relative(error[1:], self.force), 0.0).max()),
                "bound_is_measured": True, "parts": self.parts.count, "parts_at_rest": int(rests.sum()),
                **self._cancellation(None if farthest == 0 else farthest - 1)}, may_rest

    def _cancellation(self, part):
        """The free dof of a part, or of all, at which loads and contact forces cancel most digits, and the digits left."""
        order = self.problem.on_free(self.problem.load)
        order.array[:] = np.arange(*order.getOwnershipRange())
        number = self.problem.on_places(order).array_r
        lost = relative(self.forces, self.elastic)
        lost[~self.problem.is_free | (self.forces == 0.0) | ((self.part != part) if part is not None else False)] = -1.0
        own = int(np.argmax(lost)) if len(lost) else 0
        table = self.ranks.gather(np.array([lost[own], number[own]] if len(lost) else [-1.0, 0.0]))
        share, dof = table[int(np.argmax(table[:, 0]))]
        digits = DIGITS_OF_DOUBLES - (np.log10(share) if share > 1.0 else 0.0)
        return {"worst_dof": int(dof), "digits_left": float(max(digits, 0.0))}


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
    """Returns upper bounds on sqrt(r_p' K^-1 r_p) of each part p, the number of cycles, and the least Ritz value.

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
            return sizes * np.sqrt(np.maximum(known, 0.0)), cycles - 1, ritz
        if p is None:
            p = step.copy()
        else:
            earlier, ritz = ritz, least_eigenvalue(lengths, shares)
            unknown = in_cycle / (SAFETY * ritz)
            if unknown.sum() <= REST_SHARE * known.sum() and ritz >= (1.0 - SETTLED_RITZ) * earlier:
                return sizes * np.sqrt(np.maximum(known + unknown, 0.0)), cycles, ritz
            shares.append(-along.sum() / energy)
            p.aypx(shares[-1], step)
        product(p, moved)
        energy, work = parts.ranks.sum(np.dot(p.array_r, moved.array_r), np.dot(p.array_r, rest.array_r))
        if not (energy > 0.0 and work > 0.0):
            break
        lengths.append(work / energy)
        solution.axpy(lengths[-1], p)
        rest.axpy(-lengths[-1], moved)
    return np.full(parts.count, np.inf), cycles, ritz


def least_eigenvalue(lengths, shares):
    """Returns that of the Lanczos matrix which belongs to these step lengths and direction updates of conjugate gradients."""
    lengths = np.array(lengths)
    shares = np.maximum(np.array(shares[: len(lengths) - 1]), 0.0)
    diagonal = 1.0 / lengths
    diagonal[1:] += shares / lengths[:-1]
    off = np.sqrt(shares) / lengths[:-1]
    return float(np.linalg.eigvalsh(np.diag(diagonal) + np.diag(off, 1) + np.diag(off, -1))[0])

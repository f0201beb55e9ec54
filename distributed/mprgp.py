"""MPRGP: modified proportioning with reduced gradient projections, preconditioned in the free face.

The gradient g = K x - f has two parts: the free gradient, on unknowns between their bounds, and the chopped gradient, on
unknowns at a bound that would leave it. An iteration is one of

    proportioning   if the chopped gradient is larger than the free one: a step along it, which opens rows
    CG step         along a conjugate direction of the face, with one multigrid cycle
    expansion       if the CG step would cross bounds: its projection, which closes all rows on the way at once. If that
                    raises the energy, the point of least energy on the way or the step to the first bound, whichever has
                    less energy. Then a projected gradient step of fixed length.

Each of them lowers the energy. crates/qp/src/method/mprgp is the same method; this one works on PETSc vectors.

Source: Z. Dostal, Optimal Quadratic Programming Algorithms, Springer (2009), algorithm 5.8 and section 5.10.
"""

import numpy as np

from bounds import FIXED, FREE, LOWER, UPPER
from ranks import NO_ANSWER, Refused, generic, larger

INSIDE = 1e-3
"""At the start, an unknown outside a bound without multiplier is set inside it by this share of the bound's value."""

NO_ENERGY = 1e-13
"""The energy of a direction counts as zero below this share of the sum of K_ii p_i^2."""

FIRST = 1e-12
"""Bounds within this relative distance of the first bound on the way are reached together with it."""

PATIENCE = 60
"""The loop has stagnated after this number of iterations in which the best residual has not halved. Iterations that change
the face do not count until there are more of them than contact rows."""

NO_GAIN = 0.5
"""If a recomputed residual is above this share of the one before, it has reached its rounding error."""


SIGN_TOLERANCE = 1e-12
"""Forces of closed rows below this share of the largest are rounding errors."""

WORK_TOLERANCE, PLAY = 1e-9, 1e-9
"""Work and speeds of a motion below this value are rounding errors. A row this close, relative to the displacement, has no
play."""

MODE_CYCLES, GONE, LAST_FALL = 60, 1e-8, 0.25
"""In order: the cycles that damp every component with energy; the share of a vector without a null space component that they
leave; the factor by which a cycle lowers the energy until rounding."""


class Iterate:
    """The unknowns, their gradient, and the state of each bounded unknown."""

    def __init__(self, ranks, bounds, largest_eigenvalue):
        self.ranks, self.bounds = ranks, bounds
        self.stiffness, self.load = bounds.stiffness, bounds.load
        self.place, self.lower, self.upper = bounds.local, bounds.lower, bounds.upper
        self.diagonal = self.stiffness.getDiagonal()
        self.inverse = self.diagonal.copy()
        self.inverse.reciprocal()
        self.own_inverse = self.inverse.array_r[self.place]
        self.step_length = 1.0 / largest_eigenvalue
        self.x, self.gradient, self.free, self.moved = (self.load.duplicate() for _ in range(4))
        self.at = np.zeros(len(self.place), dtype=np.int8)
        self.largest_load = ranks.max(larger(self.load.array_r))
        self.products = 0

    def start(self, displacement=None, closed_lower=None, closed_upper=None):
        """Starts from a rotated displacement, or from zero. Closed sides start at their bounds, other sides inside."""
        if displacement is None:
            self.x.zeroEntries()
        else:
            displacement.copy(self.x)
            value = self.x.array_r[self.place]
            for is_out, is_closed, bound, inwards in ((value >= self.upper, closed_upper, self.upper, -INSIDE),
                                                      (value <= self.lower, closed_lower, self.lower, INSIDE)):
                value[is_out] = bound[is_out] + inwards * np.abs(bound[is_out])
                value[is_closed] = bound[is_closed]
            self.x.array[self.place] = value
        self.project()
        self.refresh_gradient()

    def product(self, vector, result):
        self.products += 1
        self.stiffness.mult(vector, result)

    def refresh_gradient(self):
        self.product(self.x, self.gradient)
        self.gradient.axpy(-1.0, self.load)

    def project(self):
        """Projects the unknowns onto their bounds and updates their states."""
        value = np.maximum(np.minimum(self.x.array_r[self.place], self.upper), self.lower)
        self.x.array[self.place] = value
        self.at = (LOWER * (value == self.lower) + UPPER * (value == self.upper)).astype(np.int8)

    def split(self):
        """Returns the gradient of the bounded unknowns in two parts: the force that the bounds take, and the chopped gradient."""
        gradient = self.gradient.array_r[self.place]
        held = np.select((self.at == LOWER, self.at == UPPER, self.at == FIXED),
                         (np.maximum(gradient, 0.0), np.minimum(gradient, 0.0), gradient), 0.0)
        return held, np.where(self.at == FREE, 0.0, gradient - held)

    def look(self):
        """Stores the free gradient. Returns the relative imbalance of forces, and whether the chopped gradient is the larger part."""
        held, chopped = self.split()
        self.gradient.copy(self.free)
        self.keep_free(self.free)
        free = self.free.array_r
        weighed = np.einsum("i,i,i->", free, free, self.inverse.array_r)
        table = self.ranks.gather((larger(free), larger(chopped), larger(held), weighed,
                                   np.dot(chopped * chopped, self.own_inverse)))
        wrong, strongest = table[:, :2].max(), max(table[:, 2].max(), self.largest_load)
        weighed, chopped_weighed = table[:, 3:].sum(axis=0)
        return wrong / strongest if wrong > 0.0 else 0.0, chopped_weighed > weighed

    def keep_free(self, vector):
        vector.array[self.place[self.at != FREE]] = 0.0

    def longest_step(self, direction, way=1.0):
        """Returns the largest t for which x - t way d stays within the bounds of this rank's unknowns."""
        speed = way * direction.array_r[self.place]
        value = self.x.array_r[self.place]
        room = np.full(len(value), np.inf)
        down, up = speed > 0.0, speed < 0.0
        room[down] = (value[down] - self.lower[down]) / speed[down]
        room[up] = (value[up] - self.upper[up]) / speed[up]
        return room.min(initial=np.inf)

    def step_along(self, direction, moved, length):
        self.x.axpy(-length, direction)
        self.gradient.axpy(-length, moved)

    def proportion(self):
        """Steps along the chopped gradient to the least energy, or to the first other bound."""
        _, chopped = self.split()
        direction = self.free
        direction.zeroEntries()
        direction.array[self.place] = chopped * self.own_inverse
        self.product(direction, self.moved)
        table = self.ranks.gather((np.dot(self.gradient.array_r, direction.array_r),
                                   np.dot(direction.array_r, self.moved.array_r), self.longest_step(direction)))
        slope, energy = table[:, :2].sum(axis=0)
        self.step_along(direction, self.moved, min(slope / energy, table[:, 2].min()))
        self.project()

    def advance(self, direction):
        """Takes the CG step, or the expansion if it would cross bounds. Returns `True` if the next direction may be conjugate."""
        length, room = direction.length, direction.room
        if length <= room:
            self.step_along(direction.p, direction.moved, length)
            self.project()
            return True
        x, gradient, at = self.x.copy(), self.gradient.copy(), self.at
        on_the_way = None
        if np.isfinite(length):
            self.x.axpy(-length, direction.p)
            self.project()
            self.refresh_gradient()
            on_the_way = self._least_energy_from(x, gradient)
        to_bounds = room * direction.slope - 0.5 * room * room * direction.energy
        if on_the_way is not None and on_the_way[0] >= 1.0:
            return False
        if on_the_way is not None and on_the_way[1] >= to_bounds:
            share = on_the_way[0]
            self.x.axpby(1.0 - share, share, x)
            self.gradient.axpby(1.0 - share, share, gradient)
            self.project()
        else:
            x.copy(self.x)
            gradient.copy(self.gradient)
            self.at = at
            self._step_to_bounds(direction, room)
        self.gradient.copy(self.free)
        self.keep_free(self.free)
        self.free.pointwiseMult(self.free, self.inverse)
        self.x.axpy(-self.step_length, self.free)
        self.project()
        self.refresh_gradient()
        return False

    def _least_energy_from(self, x, gradient):
        """Returns the share of the way from x with the least energy, and the decrease of energy; `None` if it rises at once."""
        way = self.x.array_r - x.array_r
        before = np.dot(way, gradient.array_r)
        slope, after = self.ranks.sum(before, np.dot(way, self.gradient.array_r))
        curvature = after - slope
        if slope >= 0.0:
            return None
        at_end = slope + 0.5 * curvature
        return (1.0, -at_end) if at_end < 0.0 else (-slope / curvature, 0.5 * slope * slope / curvature)

    def _step_to_bounds(self, direction, room):
        """Steps to the first bound. Sets the unknowns that reach it exactly to it: rounding could leave them short every time."""
        speed = direction.p.array_r[self.place]
        met = np.where(speed > 0.0, self.lower, self.upper)
        value = self.x.array_r[self.place]
        with np.errstate(divide="ignore", invalid="ignore"):
            meets = (speed != 0.0) & ((value - met) / speed <= room * (1.0 + FIRST))
        self.step_along(direction.p, direction.moved, room)
        self.x.array[self.place[meets]] = met[meets]
        self.project()

    def set_changed(self, before):
        return self.ranks.max(float(np.any(self.at != before))) > 0.0


class Direction:
    """A conjugate direction p with K p, its energy, the length of its CG step, and the distance to the first bound."""

    def __init__(self, iterate, step, last):
        ranks = iterate.ranks
        self.p, self.moved = step, iterate.load.duplicate()
        if last is not None:
            share = ranks.sum(np.dot(step.array_r, last.moved.array_r)) / last.energy
            self.p.axpy(-share, last.p)
        iterate.product(self.p, self.moved)
        p = self.p.array_r
        table = ranks.gather((np.dot(iterate.free.array_r, p), np.dot(p, self.moved.array_r),
                              np.einsum("i,i,i->", p, p, iterate.diagonal.array_r),
                              iterate.longest_step(self.p), iterate.longest_step(self.p, -1.0)))
        self.slope, self.energy, scale = table[:, :3].sum(axis=0)
        rooms = table[:, 3:].min(axis=0)
        self.room = rooms[0]
        if self.slope < 0.0:
            # Rounding in the cycle may reverse the direction.
            self.p.scale(-1.0)
            self.moved.scale(-1.0)
            self.slope, self.room = -self.slope, rooms[1]
        self.costs_nothing = abs(self.energy) <= NO_ENERGY * scale or not np.isfinite(self.energy)
        self.is_free = self.costs_nothing and np.isinf(self.room)
        if self.costs_nothing:
            self.energy = 0.0
        self.length = self.slope / self.energy if self.energy > 0.0 else np.inf


class Progress:
    """The state of the loop."""

    def __init__(self):
        self.cycles, self.faces = 0, 0
        self.residual, self.settled = np.inf, False
        self.history = []


def solve(iterate, hierarchy, tolerance, most_cycles, report=None):
    """Iterates until the imbalance of forces and multipliers of wrong sign, both relative, are below `tolerance`.

    Raises `Refused` for a motion that nothing holds and a direction of negative energy.
    """
    ranks, progress = iterate.ranks, Progress()
    rows = ranks.sum(float(len(iterate.place)))
    best, since_best, changes, checked, is_fresh = np.inf, 0, 0, np.inf, True
    last, is_old = None, True
    while progress.cycles < most_cycles and since_best < PATIENCE + min(changes, rows):
        residual, is_disproportionate = iterate.look()
        progress.residual = residual
        if residual <= tolerance:
            if is_fresh:
                progress.settled = True
                break
            iterate.refresh_gradient()
            residual = iterate.look()[0]
            progress.settled = residual > NO_GAIN * checked
            is_fresh, checked, last = True, residual, None
            if progress.settled:
                progress.residual = residual
                break
            continue
        if not residual < np.inf:
            raise Refused("the forces are not finite: the data of K, f or g are beyond double precision", NO_ANSWER)
        is_fresh, since_best = False, since_best + 1
        if residual < 0.5 * best:
            best, since_best, changes = residual, 0, 0
        before = iterate.at
        if is_disproportionate:
            iterate.proportion()
        else:
            if is_old:
                hierarchy.hold(iterate.at != FREE)
                progress.faces, is_old = progress.faces + 1, False
            step = iterate.load.duplicate()
            hierarchy.cycle(iterate.free, step)
            iterate.keep_free(step)
            progress.cycles += 1
            direction = Direction(iterate, step, last)
            if direction.is_free:
                raise under_held(iterate, direction.p)
            if direction.energy < 0.0:
                raise Refused(f"K is not convex: a direction that nothing holds has the energy {direction.energy:e}", NO_ANSWER)
            last = direction if iterate.advance(direction) else None
        ranks.clean()
        if iterate.set_changed(before):
            is_old, last, changes = True, None, changes + 1
        progress.history.append((progress.cycles, residual))
        if report is not None:
            report(progress.cycles, residual)
    return progress


def check_held(iterate, hierarchy, settled):
    """Refuses an answer that is not unique, and a load along a motion that nothing stops. Does nothing if K is regular.

    If the loop has not converged, two sets of held rows are tried: none, and the closed ones. A displacement that grows
    without bound may close any row.
    """
    if not hierarchy.is_singular:
        return
    if settled:
        held = np.abs(iterate.split()[0])
        strongest = iterate.ranks.max(larger(held))
        mode = without_energy(iterate, hierarchy, generic(iterate.load),
                              (iterate.at == FIXED) | (held > SIGN_TOLERANCE * strongest))
        if mode is not None and not _is_stopped_both_ways(iterate, mode):
            raise under_held(iterate, mode)
        return
    for is_held in (np.zeros(len(iterate.at), dtype=bool), iterate.at != FREE):
        mode = without_energy(iterate, hierarchy, iterate.load, is_held)
        if mode is None:
            continue
        work = iterate.load.dot(mode)
        speed = np.sign(work) * mode.array_r[iterate.place]
        stops = ((speed > WORK_TOLERANCE) & np.isfinite(iterate.upper)) | ((speed < -WORK_TOLERANCE) & np.isfinite(iterate.lower))
        if abs(work) > WORK_TOLERANCE * iterate.largest_load and not iterate.ranks.max(float(stops.any())):
            raise under_held(iterate, mode)


def without_energy(iterate, hierarchy, start, is_held):
    """Returns a motion without energy that keeps held unknowns at rest, with largest entry one, or `None`.

    Multigrid cycles damp every component of a vector except the null space of K.
    """
    hierarchy.hold(is_held)
    if not hierarchy.coarsest.is_singular:
        return None
    held = np.r_[iterate.place[is_held], hierarchy.never]
    mode, force, step = start.duplicate(), start.copy(), start.duplicate()
    scaled = start.duplicate()
    force.array[held] = 0.0
    # One cycle first: its result holds more of the smooth motions than the vector.
    hierarchy.cycle(force, mode)
    mode.array[held] = 0.0
    whole, before = iterate.ranks.max(larger(mode.array_r)), np.inf
    for _ in range(MODE_CYCLES):
        iterate.product(mode, force)
        energy = abs(mode.dot(force))
        scaled.pointwiseMult(iterate.diagonal, mode)
        if energy <= NO_ENERGY * scaled.dot(mode) and energy >= LAST_FALL * before:
            size = iterate.ranks.max(larger(mode.array_r))
            mode.scale(1.0 / size)
            return mode if size > GONE * whole else None
        before = energy
        force.array[held] = 0.0
        hierarchy.cycle(force, step)
        step.array[held] = 0.0
        mode.axpy(-1.0, step)
    return None


def _is_stopped_both_ways(iterate, mode):
    """Returns whether open rows without play stop the motion in both directions."""
    play = PLAY * iterate.ranks.max(larger(iterate.x.array_r))
    value, speed = iterate.x.array_r[iterate.place], mode.array_r[iterate.place]
    stopped = []
    for way in (1.0, -1.0):
        room = np.where(way * speed > 0.0, iterate.upper - value, value - iterate.lower)
        stopped.append(float(np.any((np.abs(speed) > WORK_TOLERANCE) & (room <= play))))
    return all(iterate.ranks.max(*stopped))


def under_held(iterate, mode):
    """Returns the refusal for a motion without energy that no row stops."""
    u = iterate.bounds.turned_back(mode).array_r
    work = iterate.ranks.sum(np.dot(iterate.bounds.problem.load.array_r, u))
    largest = int(np.abs(u).argmax()) if len(u) else 0
    first = iterate.bounds.problem.first
    found = iterate.ranks.first(*((-abs(u[largest]), first + largest) if len(u) else (np.inf, 0)))
    node, component = divmod(int(found[1]), iterate.bounds.problem.dimension)
    size = -found[0] * max(iterate.largest_load, np.finfo(float).tiny)
    drives = "and the load drives it" if abs(work) > 1e-9 * size else "and neither does the load"
    return Refused(f"not enough supports: the body can move without energy; neither supports nor closed rows stop it, {drives}; "
                   f"node {node} (from 0) moves most, along {'xyz'[component]}", NO_ANSWER)

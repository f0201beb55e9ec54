#!/usr/bin/env python3
"""Times PETSc's own solvers on the same problem: python3 distributed/peers.py PROBLEM contact linear tron --ranks 2.

Prints a line for each solver that is named: seconds of the clock and of this rank's processor, with all set-up; iterations;
unknowns at a bound. `contact` is this program without its certificate; `linear` solves K u = b without bounds by conjugate
gradients with GAMG as PETSc has it, b a unit force on each contact row; `snesvi` is SNES's vinewtonrsls with a Cholesky factor
of MUMPS in each step; `tron` is TAO's TRON with conjugate gradients and an incomplete Cholesky factor, or block Jacobi on
several ranks. All end at 1e-9 of the first residual, `contact` as solve.py does.
"""

import sys
import time

import launch

if __name__ == "__main__":
    launch.start()

from ranks import PETSc, Refused, USAGE

import numpy as np

import mprgp
import problem as problems
from bounds import FREE, Bounds
from hierarchy import Hierarchy
from problem import in_rows, orthonormal
from solve import MARGIN, main

TOLERANCE = 1e-9

NO_BOUND = 1e20
"""SNESVI and TAO take this value for infinity (PETSC_INFINITY)."""


def contact(ranks, bounds):
    hierarchy = Hierarchy(bounds)
    built = time.process_time()
    iterate = mprgp.Iterate(ranks, bounds, hierarchy.largest)
    iterate.start()
    progress = mprgp.solve(iterate, hierarchy, MARGIN * TOLERANCE, 1000)
    at = ranks.sum(float(np.count_nonzero(iterate.at != FREE)))
    return progress.cycles, int(at), progress.settled, built


def linear(ranks, bounds):
    stiffness = bounds.stiffness
    stiffness.setNearNullSpace(PETSc.NullSpace().create(vectors=orthonormal(bounds.modes), comm=ranks.comm))
    solver = PETSc.KSP().create(comm=ranks.comm)
    solver.setOptionsPrefix("linear_")
    solver.setOperators(stiffness)
    solver.setType("cg")
    solver.getPC().setType("gamg")
    solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    solver.setTolerances(rtol=TOLERANCE, max_it=1000)
    solver.setFromOptions()
    solver.setUp()
    built = time.process_time()
    force, u = bounds.load.duplicate(), bounds.load.duplicate()
    force.zeroEntries()
    force.array[bounds.local] = -1.0
    solver.solve(force, u)
    return solver.getIterationNumber(), 0, solver.getConvergedReason() > 0, built


def limits(bounds):
    lower, upper = bounds.load.duplicate(), bounds.load.duplicate()
    lower.set(-NO_BOUND)
    upper.set(NO_BOUND)
    lower.array[bounds.local] = np.maximum(bounds.lower, -NO_BOUND)
    upper.array[bounds.local] = np.minimum(bounds.upper, NO_BOUND)
    return lower, upper


def at_bounds(ranks, u, lower, upper):
    near = 1e-9 * u.norm(PETSc.NormType.NORM_INFINITY)
    at = (u.array_r - lower.array_r <= near) | (upper.array_r - u.array_r <= near)
    return int(ranks.sum(float(np.count_nonzero(at))))


def first_point(bounds, lower, upper):
    u = bounds.load.duplicate()
    u.array[:] = np.clip(0.0, lower.array_r, upper.array_r)
    return u


def snesvi(ranks, bounds):
    stiffness, load = bounds.stiffness, bounds.load
    lower, upper = limits(bounds)
    u = first_point(bounds, lower, upper)

    def residual(_, u, result):
        stiffness.mult(u, result)
        result.axpy(-1.0, load)

    solver = PETSc.SNES().create(comm=ranks.comm)
    solver.setOptionsPrefix("snesvi_")
    solver.setType("vinewtonrsls")
    solver.setFunction(residual, load.duplicate())
    solver.setJacobian(lambda *_: None, stiffness)
    solver.setVariableBounds(lower, upper)
    solver.setTolerances(rtol=TOLERANCE, atol=0.0, stol=0.0, max_it=200)
    solver.getKSP().setType("preonly")
    solver.getKSP().getPC().setType("cholesky")
    solver.getKSP().getPC().setFactorSolverType("mumps")
    solver.setFromOptions()
    built = time.process_time()
    solver.solve(None, u)
    return solver.getIterationNumber(), at_bounds(ranks, u, lower, upper), solver.getConvergedReason() > 0, built


def tron(ranks, bounds):
    stiffness, load = bounds.stiffness, bounds.load
    lower, upper = limits(bounds)
    u, moved = first_point(bounds, lower, upper), load.duplicate()

    def objective_gradient(_, u, gradient):
        stiffness.mult(u, moved)
        gradient.waxpy(-1.0, load, moved)
        return 0.5 * u.dot(moved) - u.dot(load)

    gradient = load.duplicate()
    objective_gradient(None, u, gradient)
    options = PETSc.Options()
    options["tron_tao_ksp_type"], options["tron_tao_pc_type"] = "cg", "icc" if ranks.size == 1 else "bjacobi"
    solver = PETSc.TAO().create(comm=ranks.comm)
    solver.setOptionsPrefix("tron_")
    solver.setType("tron")
    solver.setObjectiveGradient(objective_gradient, load.duplicate())
    solver.setHessian(lambda *_: None, stiffness)
    solver.setVariableBounds((lower, upper))
    solver.setTolerances(gatol=TOLERANCE * gradient.norm(), grtol=0.0, gttol=0.0)
    solver.setMaximumIterations(2000)
    solver.setFromOptions()
    built = time.process_time()
    solver.solve(u)
    return solver.getIterationNumber(), at_bounds(ranks, u, lower, upper), solver.getConvergedReason() > 0, built


SOLVERS = {"contact": contact, "linear": linear, "snesvi": snesvi, "tron": tron}


def run(ranks, words):
    if len(words) < 2 or not set(words[1:]) <= set(SOLVERS):
        raise Refused(f"usage: peers.py PROBLEM {' '.join(SOLVERS)}, one or more of these, also several times", USAGE)
    bounds = Bounds(problems.read(ranks, words[0]))
    # GAMG and the factorizations take K in PETSc's format AIJ only. The conversion is not timed.
    blocks, rows = bounds.stiffness, None
    if set(words[1:]) != {"contact"}:
        rows = in_rows(blocks)
        rows.setOption(PETSc.Mat.Option.SPD, True)
    for name in words[1:]:
        bounds.stiffness = blocks if name == "contact" else rows
        clock, processor = time.perf_counter(), time.process_time()
        iterations, at, converged, built = SOLVERS[name](ranks, bounds)
        seconds, of_processor = time.perf_counter() - clock, time.process_time() - processor
        ranks.clean()
        ranks.say(f"{name}: {seconds:.2f} s, processor {of_processor:.2f} s of which set-up {built - processor:.2f}; "
                  f"{iterations} iterations, {at} at a bound{'' if converged else ', NOT converged'}")
    return 0


if __name__ == "__main__":
    main(run, sys.argv[1:])

#!/usr/bin/env python3
"""Solves a contact problem on many ranks: python3 distributed/solve.py PROBLEM --out DIR --ranks 4."""

import argparse
import os
import sys
import time
import traceback

import launch

if __name__ == "__main__":
    launch.start()

from ranks import BAD_INPUT, NOT_CERTIFIED, PETSc, Ranks, Refused

import numpy as np

import certificate
import mprgp
import problem as problems
from answer import Folder, read_vector
from bounds import Bounds
from hierarchy import Hierarchy

MARGIN = 0.5
"""The method stops at this share of the certificate's tolerance: the certificate has larger scales."""

NEXT = 0.1
"""If the certificate fails, the method continues to this share of its last tolerance."""

SAVE_MEMORY = "build the levels in about a quarter less memory, and several times as slowly"
"""The help for --save-memory."""

OUT_OF_MEMORY = 55
"""PETSc's error code."""

LEAST = 1e-15
"""A relative imbalance of forces below this value is a rounding error."""


def arguments():
    parser = argparse.ArgumentParser(description="Solves a contact problem on many ranks.", epilog="Exit codes: 0 certified, "
                                     "1 bad input or file, 2 usage, 3 infeasible or not enough supports, 4 not certified.")
    parser.add_argument("problem", help="folder that signorini export wrote, with --format petsc or as Matrix Market")
    parser.add_argument("--out", required=True, help="folder for u.mtx, lambda.mtx and log.json; made if missing")
    launch.add_option(parser)
    parser.add_argument("--tolerance", type=float, default=1e-9, help="of the certificate (default 1e-9)")
    parser.add_argument("--start", help="folder of an earlier answer to start from")
    parser.add_argument("--multigrid", choices=("gamg", "boomeramg"), default="gamg", help="who builds the levels")
    parser.add_argument("--most-cycles", type=int, default=1000, help="cycles of multigrid, at most (default 1000)")
    parser.add_argument("--petsc", default="", help="options for PETSc's multigrid, as \"-pc_gamg_threshold 0.02\"")
    parser.add_argument("--save-memory", action="store_true", help=SAVE_MEMORY)
    parser.add_argument("--progress", action="store_true", help="print each cycle")
    options = parser.parse_args()
    if not 0.0 < options.tolerance < 1.0 or options.most_cycles < 1:
        parser.error("--tolerance must be between 0 and 1, --most-cycles at least 1")
    return options


def prepared(ranks, folder, kind="gamg", petsc="", saves_memory=False):
    """Returns problem, bounds and hierarchy, and the seconds of reading and set-up."""
    clock = time.perf_counter()
    problem = problems.read(ranks, folder)
    bounds = Bounds(problem)
    read = time.perf_counter()
    hierarchy = Hierarchy(bounds, kind, petsc, saves_memory)
    ranks.clean()
    return problem, bounds, hierarchy, {"read": read - clock, "set_up": time.perf_counter() - read}


def started(ranks, iterate, problem, bounds, folder):
    """Starts the iteration from the answer in a folder, or from zero."""
    if folder is None:
        return iterate.start()
    u = read_vector(ranks, os.path.join(folder, "u.mtx"), problem.dofs, "dofs")
    multiplier = read_vector(ranks, os.path.join(folder, "lambda.mtx"), problem.rows, "contact rows")
    return iterate.start(bounds.turned(problem.on_places(u)), *bounds.closed_sides(multiplier))


def run(ranks, options):
    problem, bounds, hierarchy, seconds = \
        prepared(ranks, options.problem, options.multigrid, options.petsc, options.save_memory)
    folder = Folder(ranks, options.out)
    clock = time.perf_counter()
    iterate = mprgp.Iterate(ranks, bounds, hierarchy.largest)
    started(ranks, iterate, problem, bounds, options.start)
    report = (lambda cycles, rest: ranks.say(f"cycle {cycles}: imbalance {rest:.1e}")) if options.progress else None
    tolerance, cycles, faces, judging = MARGIN * options.tolerance, 0, 0, 0.0
    while True:
        progress = mprgp.solve(iterate, hierarchy, tolerance, options.most_cycles - cycles, report)
        cycles, faces = cycles + progress.cycles, faces + progress.faces
        mprgp.check_held(iterate, hierarchy, progress.settled)
        before = time.perf_counter()
        u, multiplier = bounds.turned_back(iterate.x), bounds.multipliers(iterate.split()[0])
        numbers, is_certified, looked = certificate.certify(problem, bounds, hierarchy, u, multiplier, options.tolerance, rests=True)
        judging += time.perf_counter() - before
        tolerance *= NEXT
        if is_certified or not progress.settled or tolerance < LEAST or cycles >= options.most_cycles:
            break
    seconds |= {"solve": time.perf_counter() - clock - judging, "certificate": judging}
    closed = ranks.sum(float(np.count_nonzero(multiplier.array_r < 0.0)))
    largest, memory = ranks.peak_memory()
    log = {
        "status": "certified" if is_certified else "not_certified", "method": "mprgp", "tolerance": options.tolerance,
        "iterations": cycles, "ranks": ranks.size,
        "contact": {"count": int(closed), "force": -multiplier.sum()},
        "certificate": numbers,
        "model": {"dofs": problem.dofs, "contact_rows": problem.rows, "nodes": problem.load.getSize() // problem.dimension},
        "seconds": seconds | {"total": sum(seconds.values())},
        "cycles": {"contact": cycles, "certificate": looked, "faces": faces, "products": iterate.products},
        "memory_bytes": {"largest_rank": largest, "all_ranks": memory},
        "levels": hierarchy.unknowns(), "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
    }
    folder.vector("u.mtx", problem.on_free(u))
    folder.vector("lambda.mtx", multiplier)
    folder.json("log.json", log)
    folder.finish()
    certified = f"certified to {options.tolerance:.1e}" if is_certified else f"NOT certified to {options.tolerance:.1e}"
    ranks.say(f"{problem.dofs} dofs, {problem.rows} contact rows on {ranks.size} ranks: {cycles} cycles, {int(closed)} closed "
              f"rows, force {-multiplier.sum():.6e}")
    ranks.say(f"{certified}: stationarity {numbers['stationarity']:.1e}, penetration {numbers['penetration']:.1e}, duality gap "
              f"{numbers['duality_gap']:.1e}, energy error at most {numbers['part_error_bound']:.1e}, measured")
    ranks.say("seconds: " + ", ".join(f"{name} {value:.2f}" for name, value in seconds.items())
              + f"; memory of all ranks: {memory / 1e9:.2f} GB")
    return 0 if is_certified else NOT_CERTIFIED


def main(run, options):
    """Runs a program on all ranks and ends each rank with its exit code."""
    ranks = Ranks()
    try:
        sys.exit(run(ranks, options))
    except Refused as refusal:
        if ranks.rank == 0:
            print(refusal, file=sys.stderr, flush=True)
        sys.exit(refusal.code)
    except PETSc.Error as error:
        lines = str(error).splitlines()
        reason = "there is not enough memory" if error.ierr == OUT_OF_MEMORY else f"PETSc ends: {lines[-1] if lines else error}"
        print(f"rank {ranks.rank}: {reason}", file=sys.stderr, flush=True)
        os._exit(BAD_INPUT)
    except MemoryError:
        print(f"rank {ranks.rank}: there is not enough memory", file=sys.stderr, flush=True)
        os._exit(BAD_INPUT)
    except Exception:  # The other ranks would wait for this one: mpirun ends them.
        traceback.print_exc()
        os._exit(BAD_INPUT)


if __name__ == "__main__":
    main(run, arguments())

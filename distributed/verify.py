#!/usr/bin/env python3
"""Certifies an answer on many ranks: python3 distributed/verify.py PROBLEM u.mtx lambda.mtx --ranks 4."""

import argparse
import json

import launch

if __name__ == "__main__":
    launch.start()

from ranks import NOT_CERTIFIED

import numpy as np

import certificate
from answer import read_vector
from solve import SAVE_MEMORY, main, prepared


def arguments():
    parser = argparse.ArgumentParser(description="Certifies an answer on many ranks.", epilog="Exit codes: 0 certified, 1 bad "
                                     "input or file, 2 usage, 4 not certified.")
    parser.add_argument("problem", help="folder that signorini export wrote")
    parser.add_argument("displacement", help="u.mtx: a number for each free dof")
    parser.add_argument("multiplier", help="lambda.mtx: a number for each contact row, <= 0")
    launch.add_option(parser)
    parser.add_argument("--tolerance", type=float, default=1e-9, help="of every number (default 1e-9)")
    parser.add_argument("--save-memory", action="store_true", help=SAVE_MEMORY)
    options = parser.parse_args()
    if not 0.0 < options.tolerance < 1.0:
        parser.error("--tolerance must be between 0 and 1")
    return options


def run(ranks, options):
    problem, bounds, hierarchy, _ = prepared(ranks, options.problem, saves_memory=options.save_memory)
    u = problem.on_places(read_vector(ranks, options.displacement, problem.dofs, "dofs"))
    multiplier = problem.gap.duplicate()
    read_vector(ranks, options.multiplier, problem.rows, "contact rows").copy(multiplier)
    numbers, is_certified, _ = certificate.certify(problem, bounds, hierarchy, u, multiplier, options.tolerance)
    closed = ranks.sum(float(np.count_nonzero(multiplier.array_r < 0.0)))
    ranks.say(json.dumps({
        "status": "certified" if is_certified else "not_certified", "tolerance": options.tolerance,
        "certificate": numbers, "contact": {"count": int(closed), "force": -multiplier.sum()},
        "model": {"dofs": problem.dofs, "contact_rows": problem.rows}, "ranks": ranks.size}, indent=2))
    return 0 if is_certified else NOT_CERTIFIED


if __name__ == "__main__":
    main(run, arguments())

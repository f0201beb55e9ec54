"""Reference results in results.json, for tests that run without Python.

They come only from the independent solvers, never from the tested program.
"""

import datetime
import json
import platform
from importlib import metadata
from pathlib import Path

import numpy as np

from compare import weak_rows
from kkt import kkt, multiplier_scale
from problem import Problem
from settle import Settled

RESULTS = Path(__file__).with_name("results.json")

WHOLE = 100
"""Vectors up to this length are stored whole."""

SAMPLES = 11
"""Number of evenly spaced entries that are stored of longer vectors, in addition to the largest one."""

SMALL = 4
"""Problems with at most this number of dofs are stored with their data."""

STORED_TOLERANCE = 1e-8
"""Tolerance between a stored result and a new one, relative to the largest value, because other machines round differently."""


def record(problem: Problem, settled: Settled, solver: str) -> dict:
    """Returns the stored data of one case."""
    answer = settled.answer
    weak = weak_rows(problem, answer)
    entry = {
        "solver": f"{solver}, settled on its contact set",
        "dofs": problem.dofs,
        "rows": problem.rows,
        "closed_rows": runs(np.flatnonzero(settled.closed & ~weak)),
        "weakly_active_rows": runs(np.flatnonzero(weak)),
        "force": answer.force,
        "energy": float(0.5 * answer.displacement @ (problem.stiffness @ answer.displacement)),
        "displacement": selected(answer.displacement),
        "multiplier": selected(answer.multiplier),
        "worst_condition": float(f"{kkt(problem, answer).worst():.1e}"),
    }
    if problem.dofs <= SMALL:
        entry["problem"] = {
            "stiffness": problem.stiffness.toarray().tolist(),
            "load": problem.load.tolist(),
            "contact": problem.contact.toarray().tolist(),
            "gap": problem.gap.tolist(),
        }
    return entry


def runs(indices: np.ndarray) -> list[list[int]]:
    """Returns sorted indices as [first, last] of each run of consecutive indices."""
    breaks = np.flatnonzero(np.diff(indices) != 1) + 1
    return [[int(run[0]), int(run[-1])] for run in np.split(indices, breaks) if run.size]


def selected(vector: np.ndarray) -> dict:
    """Returns the length of a vector, and the indices and values of its stored entries as exact doubles."""
    if vector.size <= WHOLE:
        index = np.arange(vector.size)
    else:
        index = np.union1d(np.linspace(0, vector.size - 1, SAMPLES).astype(int), np.argmax(np.abs(vector)))
    # Adding 0.0 turns a negative zero into a positive one.
    return {"length": vector.size, "index": index.tolist(), "value": (vector[index] + 0.0).tolist()}


def stored_faults(entry: dict, problem: Problem, settled: Settled) -> list[str]:
    """Returns one sentence for each difference between a new result and the stored one."""
    today, answer, faults = record(problem, settled, ""), settled.answer, []
    for key in ("dofs", "rows", "closed_rows"):
        if entry[key] != today[key]:
            faults.append(f"{key} {today[key]}, stored {entry[key]}")
    if faults:
        return faults
    for name, vector, scale in (
        ("displacement", answer.displacement, np.max(np.abs(answer.displacement))),
        ("multiplier", answer.multiplier, multiplier_scale(problem, answer)),
    ):
        apart = np.max(np.abs(vector[entry[name]["index"]] - entry[name]["value"]))
        if apart > STORED_TOLERANCE * scale:
            faults.append(f"{name} differs by {apart / scale:.1e} from the stored one")
    return faults


def read() -> dict:
    """Returns the stored results by the name of the case; empty if there is no file."""
    return json.loads(RESULTS.read_text())["cases"] if RESULTS.exists() else {}


def write(cases: dict) -> None:
    """Writes results.json with the versions and the date."""
    packages = ("cvxpy", "osqp", "clarabel", "numpy", "scipy")
    document = {
        "date": datetime.date.today().isoformat(),
        "versions": {"python": platform.python_version()} | {name: metadata.version(name) for name in packages},
        "signs": "lambda <= 0 in compression; indices from 0; closed_rows are [first, last] runs",
        "cases": cases,
    }
    # All numbers of a list are on one line, so that people can read the file as well.
    RESULTS.write_text(compact(document) + "\n")


def compact(value, indent: str = "") -> str:
    """Returns JSON text with each entry of an object on a line of its own and every list on one line."""
    if not isinstance(value, dict):
        return json.dumps(value)
    inner = indent + "  "
    lines = (f"{inner}{json.dumps(key)}: {compact(item, inner)}" for key, item in value.items())
    return "{\n" + ",\n".join(lines) + f"\n{indent}}}"

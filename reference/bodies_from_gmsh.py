"""Solves random pairs of bodies that Gmsh meshed through the program, with contacts that it finds, and judges each answer.

    pip install gmsh meshio numpy
    python reference/bodies_from_gmsh.py target/release/signorini FOLDER [COUNT] [FIRST]

The pairs are those of touching_bodies.py: in the plane and in space, linear and quadratic, with gaps, overlaps, thin plates, folds, shared
nodes and bodies of several pieces. The meshes of a pair stay in FOLDER/NUMBER. Every pair is judged from solution.vtu alone:

- an exit code that is not documented, or a panic, is a crash; a refusal is one line that begins with `error: `;
- points of the displaced surface of one body that lie in the other one by more than DEEP of the facets there are an overlap, and no
  warning that names it makes it silent;
- reactions and contact forces of each body must cancel to BALANCE, force and moment.

The last line has the counts; the exit code is 1 if there are silent overlaps, answers out of balance, crashes or unclear refusals.
"""

import json
import pathlib
import subprocess
import sys
from collections import Counter

import gmsh
import meshio
import numpy as np

import overlaps
import touching_bodies

DEEP = 0.1
"""Depth in sizes of the larger facet, beyond which a point of one body is inside the other."""

BALANCE = 1e-10
"""Forces and moments of a body that do not cancel, relative to the sum of their absolute values."""

NAMES_OVERLAPS = ("bodies-overlap", "partly-covered")
"""Warnings that say that bodies go through each other, or where they can."""

SECONDS = 120
"""No pair takes this long."""


def refusal(done) -> str:
    """Returns the verdict on a run without an answer."""
    lines = done.stderr.strip().splitlines()
    if "panicked" in done.stderr or done.returncode not in (1, 3, 4):
        return "crash"
    errors = [line for line in lines if line.startswith("error: ")]
    clear = len(errors) == 1 and len(errors[0]) < 600
    return ("not certified" if done.returncode == 4 else "refused") if clear else "unclear"


def imbalance(mesh, scene, inside) -> float:
    """Returns the largest force or moment left on a body, relative to the sum of the absolute forces, or to what a strain of 1 needs."""
    forces = mesh.point_data["reaction"] + mesh.point_data["contact_force"]
    worst = 0.0
    softest = min(scene["material"]["young"], scene["further-bodies"][0]["material"]["young"])
    scale = max(np.abs(forces).sum(), softest * np.abs(mesh.point_data["u"]).max(), 1e-300)
    for body in (0, 1):
        if body == 0 and "loads" in scene:
            continue
        own = inside == body
        moment = np.cross(mesh.points[own], forces[own]).sum(axis=0)
        worst = max(worst, np.abs(forces[own].sum(axis=0)).max(), np.abs(moment).max())
    between = np.abs(mesh.point_data["contact_force"].sum(axis=0)).max()
    return max(worst, between) / scale


def judged(program, folder, scene) -> tuple[str, str]:
    """Solves the scene in a folder; returns a verdict and its reason."""
    words = [program, "solve", str(folder / "scene.json"), "--out", str(folder / "answer"), "--pictures", "none", "--quiet"]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "crash", f"no answer within {SECONDS} s"
    if done.returncode:
        return refusal(done), done.stderr.strip()[:400]
    mesh = meshio.read(folder / "answer/solution.vtu")
    report = json.loads((folder / "answer/report.json").read_text())
    warnings = {warning["code"] for warning in report.get("warnings", [])}
    cells, owners = mesh.cells[0], mesh.cell_data["body"][0]
    inside = np.full(len(mesh.points), -1)
    inside[cells.data.ravel()] = np.repeat(owners, cells.data.shape[1])
    left = imbalance(mesh, scene, inside)
    if left > BALANCE:
        return "out of balance", f"{left:.1e}"
    depth, place = overlaps.deepest(cells.type, cells.data, owners, mesh.points + mesh.point_data["u"])
    if depth <= DEEP:
        return "answered", f"{depth:.3f}"
    reason = f"{depth:.3f} of a facet at {np.round(place, 4).tolist()}, warnings {sorted(warnings)}"
    return ("silent overlap" if not warnings & set(NAMES_OVERLAPS) else "named overlap"), reason


def main(program, folder, count=300, first=0):
    folder, counts = pathlib.Path(folder), Counter()
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    for seed in range(int(first), int(first) + int(count)):
        place = folder / str(seed)
        place.mkdir(parents=True, exist_ok=True)
        try:
            if not (place / "scene.json").exists():
                touching_bodies.pair(seed, place)
        except Exception as error:
            counts["not meshed"] += 1
            print(f"{seed}: Gmsh: {error}", flush=True)
            continue
        scene = json.loads((place / "scene.json").read_text())
        verdict, reason = judged(program, place, scene)
        counts[verdict] += 1
        print(f"{seed} {scene['title']}: {verdict}: {reason}", flush=True)
    gmsh.finalize()
    names = ("answered", "named overlap", "refused", "not certified", "not meshed", "silent overlap", "out of balance", "unclear", "crash")
    print(", ".join(f"{counts[name]} {name}" for name in names))
    sys.exit(any(counts[name] for name in names[-4:]))


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Compares the time of `--total-error` with that of the best point of a measured grid of meshes and methods.

    python3 reference/choice.py target/release/signorini [--runs 3] [--short]

There are eight scenes with two goals each. A point of the grid is a method and a first mesh, whose cells are divided into 1, 2, 4, ...
parts along each edge:

* For scenes with a guaranteed error, the same command runs on that first mesh. It ends there if the mesh suffices, and refines the
  mesh otherwise.
* For scenes with an estimated error, one solve runs on that mesh, to a tenth of the goal. It counts if its estimate meets the goal.
  For tetrahedra, the refinement from that mesh is measured as well.

The time of a point is the smallest over all runs of the whole command, including its start and the reading of the scene. The runs of
all points of a scene alternate.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

METHODS = ("auto", "active-set", "qp", "mprgp")
MOST_SECONDS = 60


def axis(length, cells):
    return {"points": [0, length], "divisions": [cells]}


def rectangle(width, height, cells, k, element="q4"):
    return {"rectangle": {"x": axis(width, cells[0] * k), "y": axis(height, cells[1] * k), "element": element}}


def box(cells, k, element):
    x, y, z = cells
    return {"box": {"x": axis(1, x * k), "y": axis(1, y * k), "z": axis(0.5, z * k), "element": element}}


def wedge(k):
    """The corner of a wedge pressed into a block in plane stress."""
    return {
        "model": "plane-stress",
        "body": rectangle(1, 1, (6, 6), k, "t3"),
        "material": {"young": 200, "poisson": 0.25},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"wedge": {"apex": [0.4, 0.97], "slope": 0.3}}}],
    }


def pulled(k):
    """A block that a traction presses against a circle at its side."""
    return {
        "body": rectangle(2, 1, (8, 4), k, "q8"),
        "material": {"young": 1000, "poisson": 0.3},
        "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}],
        "loads": [{"traction": {"boundary": "top", "value": [0, -2]}}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"circle": {"apex": [1.7, -0.002], "radius": 2}}}],
    }


def rubber(k):
    """A nearly incompressible block with its weight, clamped at its bottom, under a parabola."""
    return {
        "body": rectangle(1, 0.5, (8, 4), k),
        "material": {"young": 10, "poisson": 0.4999},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "loads": [{"body-force": [0, 0.5]}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0.3, 0.49], "radius": 0.5}}}],
    }


def disc(k):
    """Half a disc that is pressed onto a plane."""
    return {
        "body": {"half-disc": {"centre": [0, 1], "radius": 1, "element": "t3",
                               "zone": {"width": 0.2, "divisions": 2 * k, "growth": 2 ** (1 / k)}}},
        "material": {"young": 1, "poisson": 0.3},
        "supports": [{"on": {"boundary": "cut"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "arc", "approach": "-y", "shape": {"plane": {"point": [0, 0.02], "normal": [0, -1]}}}],
    }


def solid(element, obstacle, cells=(4, 4, 2)):
    """A block under an obstacle, with rows along its normals: their error is estimated, not guaranteed."""

    def scene(k):
        return {
            "model": "space",
            "body": box(cells, k, element),
            "material": {"young": 1e7, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}],
            "obstacles": [{"boundary": "top", "approach": "+z", "rule": "closest-point", "shape": obstacle}],
        }

    return scene


def punch(k):
    """A cylinder under a ball, as an axisymmetric body."""
    return {
        "model": "axisymmetric",
        "body": rectangle(1, 0.5, (8, 4), k),
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "left"}, "x": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [0, 0.49], "radius": 1}}}],
    }


SPHERE = {"sphere": {"apex": [0.4, 0.5, 0.49], "radius": 0.7}}
CYLINDER = {"cylinder": {"apex": [0.5, 0.5, 0.49], "radius": 1, "axis": [0, 1, 0]}}

# Scene, goals, numbers of divisions of each edge, True if the error is guaranteed, True if the mesh is refined by bisection.
SCENES = {
    "wedge, plane stress, T3": (wedge, (0.05, 0.02), (1, 2, 4, 8), True, True),
    "pressed on a circle, Q8": (pulled, (0.05, 0.01), (1, 2, 4, 8), True, True),
    "nu = 0.4999 and weight, Q4": (rubber, (0.05, 0.01), (1, 2, 4, 8), True, True),
    "half a disc on a plane, T3": (disc, (0.05, 0.01), (1, 2, 4, 8), True, True),
    "ball on a block, Tet4": (solid("tet4", SPHERE), (0.3, 0.15), (1, 2, 4, 8), False, True),
    "cylinder on a block, Tet4": (solid("tet4", CYLINDER, (3, 2, 2)), (0.3, 0.15), (1, 2, 4, 8), False, True),
    "ball on a block, Hex8": (solid("hex8", SPHERE), (0.3, 0.2), (1, 2, 3, 4, 6, 8), False, False),
    "ball on a cylinder, axisymmetric Q4": (punch, (0.1, 0.03), (1, 2, 4, 6, 8, 12, 16, 24), False, False),
}


class Point:
    """A command of the grid, its smallest time, and the test of its goal."""

    def __init__(self, name, command, is_enough):
        self.name, self.command, self.is_enough = name, command, is_enough
        self.seconds = float("inf")

    def run(self):
        """Runs the command once. Returns False if the point does not meet its goal."""
        began = time.perf_counter()
        try:
            run = subprocess.run(self.command, capture_output=True, text=True, timeout=MOST_SECONDS)
        except subprocess.TimeoutExpired:
            return False
        taken = time.perf_counter() - began
        if run.returncode != 0 or not self.is_enough(json.loads(run.stdout)):
            return False
        self.seconds = min(self.seconds, taken)
        return True


def grid(program, folder, scene, goal, cuts, guaranteed, bisected):
    """Returns the chosen point, followed by all others."""
    points = []
    for k in cuts:
        file = folder / f"{k}.json"
        file.write_text(json.dumps(scene(k)))
        for method in METHODS:
            command = [program, "solve", str(file), "--format", "json", "--method", method]
            if guaranteed or bisected or k == 1 and method == "auto":
                # A stress in balance needs the exact contact set, which multigrid does not give.
                if not (guaranteed and method in ("mprgp", "auto") and (k, method) != (1, "auto")):
                    points.append(Point(f"from cells / {k}, {method}", [*command, "--total-error", str(goal)], lambda _: True))
            # Uniform tetrahedra on fine meshes take minutes and are far from the best.
            if not guaranteed and (not bisected or k < 8):
                once = [*command, "--accuracy", str(goal / 10)]
                points.append(Point(f"cells / {k}, {method}", once, lambda report: 0 < report["discretisation_error"] <= goal))
    return points


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", default="", help="scenes whose name has this")
    parser.add_argument("--short", action="store_true", help="two scenes, coarse goals, one run")
    options = parser.parse_args()
    scenes = SCENES
    if options.short:
        options.runs = 1
        names = ("half a disc on a plane, T3", "ball on a block, Tet4")
        scenes = {name: (*SCENES[name][:1], SCENES[name][1][:1], (1, 2), *SCENES[name][3:]) for name in names}
    scenes = {name: scene for name, scene in scenes.items() if options.only in name}
    print("| scene | goal | chosen [s] | best of the grid [s] | which | ratio |\n|---|---|---|---|---|---|")
    worst = 0.0
    for name, (scene, goals, cuts, guaranteed, bisected) in scenes.items():
        for goal in goals:
            with tempfile.TemporaryDirectory() as folder:
                points = grid(options.program, Path(folder), scene, goal, cuts, guaranteed, bisected)
                chosen = points[0]
                for _ in range(options.runs):
                    points = [point for point in points if point.run()]
                    if chosen not in points:
                        sys.exit(f"{name}: {' '.join(chosen.command)} does not meet its goal")
            best = min(points, key=lambda point: point.seconds)
            ratio = chosen.seconds / best.seconds
            worst = max(worst, ratio)
            print(f"| {name} | {100 * goal:g} % | {chosen.seconds:.3f} | {best.seconds:.3f} | {best.name} | {ratio:.2f} |", flush=True)
    print(f"\nworst ratio {worst:.2f}")


if __name__ == "__main__":
    main()

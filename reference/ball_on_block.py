"""Presses an elastic ball on an elastic block, both meshed with ten-node tetrahedra by Gmsh, each on its own.

    pip install gmsh
    python reference/ball_on_block.py target/release/signorini [EDGE]

A quarter of the lower half of a ball of radius 1 stands on a quarter of a cylinder of radius 1 and height 1; its cut is moved down by
APPROACH. EDGE is the edge length at the contact. Force and peak pressure are compared with those of the same bodies of revolution, whose
sections are meshed with six-node triangles of a fifth of EDGE, and with the formulas of Hertz for that force. The exit code is 1 if the
force differs by more than 1 %, or the peak by more than 3 %.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

import gmsh

occ = gmsh.model.occ

APPROACH = 0.02
MODULI, POISSON = (1.0, 2.0), 0.3
ZONE = 0.18
"""The elements have one size up to this distance from the first contact, and grow beyond it."""
GROWTH = 0.35
FORCE, PEAK = 0.01, 0.03


def parts(space: bool):
    """Yields the name of each body and a function that draws it."""
    if space:
        quarter = lambda z, high: [(3, occ.addBox(0, 0, z, 2, 2, high))]
        yield "ball", lambda: occ.intersect([(3, occ.addSphere(0, 0, 1, 1))], quarter(-0.5, 1.5))
        yield "block", lambda: occ.intersect([(3, occ.addCylinder(0, 0, -1, 0, 0, 1, 1))], quarter(-1, 1))
    else:
        half = lambda: [(2, occ.addRectangle(0, -0.5, 0, 2, 1.5))]
        yield "ball", lambda: occ.intersect([(2, occ.addDisk(0, 1, 0, 1, 1))], half())
        yield "block", lambda: occ.addRectangle(0, -1, 0, 1, 1)


def side(tag: int, dimension: int) -> str:
    """Returns the name of a side by its box."""
    box = gmsh.model.getBoundingBox(dimension - 1, tag)
    flat = [abs(box[axis] - box[axis + 3]) < 1e-5 and box[axis] for axis in range(dimension)]
    names = {(0, 0.0): "cut-x", (dimension - 1, 1.0): "cut", (dimension - 1, -1.0): "base", (dimension - 1, 0.0): "face"}
    names |= {(1, 0.0): "cut-y"} if dimension == 3 else {}
    for (axis, place), name in names.items():
        if flat[axis] is not False and abs(flat[axis] - place) < 1e-5:
            return name
    return "round"


def mesh(name, draw, dimension, edge, file):
    gmsh.clear()
    draw()
    occ.synchronize()
    sides = {}
    for _, tag in gmsh.model.getEntities(dimension - 1):
        sides.setdefault(side(tag, dimension), []).append(tag)
    for word, tags in sides.items():
        gmsh.model.addPhysicalGroup(dimension - 1, tags, name=word)
    gmsh.model.addPhysicalGroup(dimension, [tag for _, tag in gmsh.model.getEntities(dimension)], name=name)
    size = lambda _, __, x, y, z, ___: edge + GROWTH * max(0, math.hypot(x, y, z) - ZONE)
    gmsh.model.mesh.setSizeCallback(size)
    gmsh.model.mesh.generate(dimension)
    gmsh.write(str(file))


def solved(program, folder, space: bool, edge) -> dict:
    """Returns the report of the bodies in space, or of the bodies of revolution."""
    dimension, up = (3, "z") if space else (2, "y")
    for name, draw in parts(space):
        mesh(name, draw, dimension, edge, folder / f"{name}.msh")
    scene = {
        "model": "space" if space else "axisymmetric",
        "body": {"gmsh": {"file": "ball.msh"}}, "material": {"young": MODULI[0], "poisson": POISSON},
        "further-bodies": [{"name": "block", "body": {"gmsh": {"file": "block.msh"}},
                            "material": {"young": MODULI[1], "poisson": POISSON}}],
        "supports": [{"on": {"boundary": "cut"}, up: -APPROACH}, {"on": {"boundary": "block.base"}, up: 0}],
        "obstacles": [{"boundary": "round", "approach": "-" + up,
                       "shape": {"body": {"boundary": "block.face", "rows": "mortar", "reach": 0.05}}}],
    }
    axes = "xy" if space else "x"
    scene["supports"] += [{"on": {"boundary": f"{body}cut-{axis}"}, axis: 0} for axis in axes for body in ("", "block.")]
    (folder / "scene.json").write_text(json.dumps(scene))
    words = [program, "solve", "scene.json", "--out", "answer", "--pictures", "none", "--no-proof", "--quiet"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    return json.loads((folder / "answer/report.json").read_text())


def main(program, edge=0.0125):
    gmsh.initialize()
    for option, value in {"Terminal": 0, "ElementOrder": 2, "MeshSizeExtendFromBoundary": 0, "MeshSizeFromPoints": 0}.items():
        gmsh.option.setNumber(("General." if option == "Terminal" else "Mesh.") + option, value)
    program, edge = str(pathlib.Path(program).resolve()), float(edge)
    with tempfile.TemporaryDirectory() as name:
        of_section = solved(program, pathlib.Path(name), False, edge / 5)
        in_space = solved(program, pathlib.Path(name), True, edge)
    gmsh.finalize()
    force, exact = 4 * in_space["contact"]["force"], of_section["contact"]["force"]
    peak, of_revolution = (report["contact"]["pressure_max"] for report in (in_space, of_section))
    modulus = 1 / sum((1 - POISSON**2) / young for young in MODULI)
    radius = (3 * exact / (4 * modulus)) ** (1 / 3)
    hertz = 3 * exact / (2 * math.pi * radius**2)
    model = in_space["model"]
    closed = in_space["contact"]["count"]
    print(f"{model['nodes']} nodes, {model['contact_rows']} rows, {closed} closed, radius over edge {radius / edge:.1f}")
    print(f"force {force:.6e}, of revolution {exact:.6e}: {100 * (force / exact - 1):+.3f} %")
    print(f"peak {peak:.5e}, of revolution {of_revolution:.5e}: {100 * (peak / of_revolution - 1):+.2f} %, Hertz {hertz:.5e}")
    print(f"{in_space['seconds']['assemble']:.1f} s for rows and stiffness, {in_space['seconds']['total']:.1f} s in all")
    sys.exit(not (abs(force / exact - 1) < FORCE and abs(peak / of_revolution - 1) < PEAK and radius / edge >= 10))


if __name__ == "__main__":
    main(*sys.argv[1:])

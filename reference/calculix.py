"""Holds displacements against those of CalculiX, on the same meshes and without contact.

    python reference/parts.py FOLDER
    python reference/calculix.py target/release/signorini FOLDER NAME [NAME ...]

For each part the obstacles are left out, supports hold at zero and a body force pulls; the program's own fields give CalculiX
nodes, elements and loads. CalculiX is the Debian package calculix-ccx; its command is ccx. Its ten-node tetrahedra have four quadrature
points, ours eight: on straight edges both are exact, on curved ones they differ (by 3e-4 on `bracket`). Its plane elements are wedges.
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import meshio
import numpy as np
import scipy.io

FORCES = {1: [3.0], 2: [3.0, -5.0], 3: [3.0, -5.0, 2.0]}
"""Force per volume, in no direction of its own; about an axis there is none along the radius."""

ELEMENTS = {
    ("tetra", "space"): "C3D4",
    ("tetra10", "space"): "C3D10",
    ("hexahedron", "space"): "C3D8",
    ("hexahedron20", "space"): "C3D20",
    ("triangle6", "plane-strain"): "CPE6",
    ("triangle6", "plane-stress"): "CPS6",
    ("triangle6", "axisymmetric"): "CAX6",
}


def held_scene(path: pathlib.Path) -> dict:
    """The scene of a part without obstacles, held at zero and pulled by a body force."""
    scene = json.loads(path.read_text())
    dimension = 3 if scene.get("model") == "space" else 2
    for support in scene["supports"]:
        support |= {axis: 0 for axis in ("x", "y", "z", "value") if axis in support}
    force = FORCES[dimension]
    if scene.get("model") == "axisymmetric":
        force = [0.0, force[1]]
    return scene | {"obstacles": [], "gap": 0, "loads": [{"body-force": force}]}


def number(value: float) -> str:
    """A number in at most 20 characters: what follows would be cut off."""
    return f"{float(value):.12e}"


def numbers(values) -> str:
    return ", ".join(number(value) for value in values)


def input_of(scene: dict, mesh: meshio.Mesh, load: np.ndarray, free: list[tuple[int, int]]) -> str:
    """The input file of CalculiX: everything that is no free dof is held."""
    dimension = 3 if scene.get("model") == "space" else 2
    block = mesh.cells[0]
    kind = ELEMENTS[block.type, scene.get("model", "plane-strain")]
    lines = ["*NODE, NSET=ALL"] + [f"{node + 1}, {numbers(at)}" for node, at in enumerate(mesh.points)]
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=BODY")
    for index, nodes in enumerate(block.data + 1, start=1):
        words = [str(index)] + [str(node) for node in nodes]
        # A line has at most 16 entries.
        lines += [", ".join(words[:15]) + ("," if len(words) > 15 else "")] + ([", ".join(words[15:])] if len(words) > 15 else [])
    material = scene["material"]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", numbers([material["young"], material["poisson"]])]
    lines.append("*SOLID SECTION, ELSET=BODY, MATERIAL=M")
    if kind.startswith("CP"):
        lines.append(number(scene.get("thickness", 1.0)))
    lines.append("*BOUNDARY")
    held = {(node, axis) for node in range(len(mesh.points)) for axis in range(dimension)} - set(free)
    lines += [f"{node + 1}, {axis + 1}, {axis + 1}" for node, axis in sorted(held)]
    lines += ["*STEP", "*STATIC, SOLVER=SPOOLES", "*CLOAD"]
    lines += [f"{node + 1}, {axis + 1}, {number(value)}" for (node, axis), value in zip(free, load.tolist()) if value]
    return "\n".join(lines + ["*NODE PRINT, NSET=ALL", "U", "*END STEP", ""])


def free_dofs(path: pathlib.Path) -> list[tuple[int, int]]:
    """Node and axis of each unknown, from dofs.csv."""
    with path.open() as text:
        rows = list(csv.DictReader(text))
    axis = lambda row: int(np.argmax([abs(float(row[f"direction_{name}"])) for name in "xyz"]))
    return [(int(row["of"].removeprefix("node ")), axis(row)) for row in rows]


def compared(program: str, path: pathlib.Path) -> tuple[int, float]:
    """Unknowns of a part, and the largest difference of displacements over the largest displacement."""
    scene = held_scene(path)
    held = path.with_name(f"{path.stem}-held.json")
    held.write_text(json.dumps(scene))
    try:
        return difference(program, held, scene)
    finally:
        held.unlink()


def difference(program: str, held: pathlib.Path, scene: dict) -> tuple[int, float]:
    """The same for a scene that is written."""
    dimension = 3 if scene.get("model") == "space" else 2
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run = lambda *words: subprocess.run(words, cwd=folder, check=True, capture_output=True)
        run(program, "export", str(held), "problem")
        run(program, "solve", str(held), "--no-proof", "--out", "answer")
        mesh = meshio.read(folder / "answer/solution.vtu")
        load = np.asarray(scipy.io.mmread(folder / "problem/f.mtx")).ravel()
        free = free_dofs(folder / "problem/dofs.csv")
        (folder / "part.inp").write_text(input_of(scene, mesh, load, free))
        solved = subprocess.run(["ccx", "part"], cwd=folder, capture_output=True, text=True)
        if solved.returncode:
            sys.exit(f"{held.stem}: ccx ends with {solved.returncode}: {solved.stdout[-800:]}")
        theirs = np.zeros((len(mesh.points), 3))
        for line in (folder / "part.dat").read_text().splitlines():
            words = line.split()
            if len(words) == 4 and words[0].isdigit() and int(words[0]) <= len(mesh.points):
                theirs[int(words[0]) - 1] = [float(word) for word in words[1:]]
        ours = np.asarray(mesh.point_data["u"])[:, :dimension]
        return len(free), float(np.abs(ours - theirs[:, :dimension]).max() / np.abs(ours).max())


def main(arguments: list[str]) -> int:
    if len(arguments) < 3:
        sys.exit("usage: calculix.py PROGRAM FOLDER NAME [NAME ...]")
    program, folder = str(pathlib.Path(arguments[0]).resolve()), pathlib.Path(arguments[1]).resolve()
    print(f"{'part':18} {'unknowns':>9} {'difference':>11}")
    worst = 0.0
    for name in arguments[2:]:
        unknowns, difference = compared(program, folder / f"{name}.json")
        worst = max(worst, difference)
        print(f"{name:18} {unknowns:9} {difference:11.1e}", flush=True)
    return int(worst > 1e-6)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

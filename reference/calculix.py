"""Compares displacements without contact, and contact forces, with those of CalculiX on the same meshes.

    python reference/parts.py FOLDER
    python reference/calculix.py target/release/signorini FOLDER NAME [NAME ...]
    python reference/calculix.py --contact [--poisson NU] target/release/signorini FOLDER NAME [NAME ...]
    python reference/calculix.py --decks FOLDER [target/release/signorini]

With `--decks`, both programs run on each deck of a folder, as `decks.py` does it.

With `--contact`, parts whose only obstacle is one plane are solved with contact, and the total contact forces are compared. In
CalculiX the plane is a face of one element whose nodes are fixed, and the contact pressure is a linear function of the overclosure.
The contact stiffness takes increasing values: CONTACT_STIFFNESS times the modulus of the body over the length of a facet. Seconds are
those of whole commands, ours with certificate and proof. `--poisson` gives the bodies another Poisson's ratio. A run of CalculiX that does
not end within MOST_SECONDS, or ends without contact forces, counts as none.

Without `--contact`, the obstacles are left out, all supports are zero, and a body force acts on the part. CalculiX gets its nodes,
elements and loads from the files that the program writes. CalculiX is the Debian package calculix-ccx; its command is ccx. Its
ten-node tetrahedra have four quadrature points, ours have eight: both are exact for straight edges, but they differ for curved edges
(by 3e-4 on `bracket`). Its plane elements are wedges.
"""

import csv
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
from typing import NamedTuple

import meshio
import numpy as np
import scipy.io

import decks

CONTACT_STIFFNESS = (10.0, 30.0, 100.0)
"""Contact stiffnesses of CalculiX, as multiples of the modulus of the body over the length of a facet."""

MOST_SECONDS = 300
"""Time limit of a run of CalculiX with contact."""

WEDGES = 180
"""For an axisymmetric body CalculiX computes a wedge of two degrees, and prints the forces of this wedge."""

FACES = {
    "tetra": [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
    "tetra10": [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
    "triangle6": [(0, 1), (1, 2), (2, 0)],
}
"""Corners of the faces of an element, in the order in which CalculiX numbers them."""

FORCES = {1: [3.0], 2: [3.0, -5.0], 3: [3.0, -5.0, 2.0]}
"""Force per volume, in a direction along no axis. For an axisymmetric body its radial component is left out."""

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
    """Returns the scene of a part without obstacles, with all supports at zero and a body force."""
    scene = json.loads(path.read_text())
    dimension = 3 if scene.get("model") == "space" else 2
    for support in scene["supports"]:
        support |= {axis: 0 for axis in ("x", "y", "z", "value") if axis in support}
    force = FORCES[dimension]
    if scene.get("model") == "axisymmetric":
        force = [0.0, force[1]]
    return scene | {"obstacles": [], "gap": 0, "loads": [{"body-force": force}]}


def number(value: float) -> str:
    """Formats a number in at most 20 characters, because CalculiX ignores all further characters."""
    return f"{float(value):.12e}"


def numbers(values) -> str:
    return ", ".join(number(value) for value in values)


def body_of(scene: dict, mesh: meshio.Mesh) -> list[str]:
    """Returns the lines of the nodes, elements and material of the body."""
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
    return lines


def input_of(scene: dict, mesh: meshio.Mesh, load: np.ndarray, free: list[tuple[int, int]]) -> str:
    """Returns the input file of CalculiX, in which all dofs except the free ones are fixed."""
    dimension = 3 if scene.get("model") == "space" else 2
    lines = body_of(scene, mesh)
    lines.append("*BOUNDARY")
    held = {(node, axis) for node in range(len(mesh.points)) for axis in range(dimension)} - set(free)
    lines += [f"{node + 1}, {axis + 1}, {axis + 1}" for node, axis in sorted(held)]
    lines += ["*STEP", "*STATIC, SOLVER=SPOOLES", "*CLOAD"]
    lines += [f"{node + 1}, {axis + 1}, {number(value)}" for (node, axis), value in zip(free, load.tolist()) if value]
    return "\n".join(lines + ["*NODE PRINT, NSET=ALL", "U", "*END STEP", ""])


def free_dofs(path: pathlib.Path) -> list[tuple[int, int]]:
    """Reads the node and the axis of each unknown from dofs.csv."""
    with path.open() as text:
        rows = list(csv.DictReader(text))
    axis = lambda row: int(np.argmax([abs(float(row[f"direction_{name}"])) for name in "xyz"]))
    return [(int(row["of"].removeprefix("node ")), axis(row)) for row in rows]


def compared(program: str, path: pathlib.Path) -> tuple[int, float]:
    """Returns the number of unknowns of a part, and the largest difference of displacements relative to the largest displacement."""
    scene = held_scene(path)
    held = path.with_name(f"{path.stem}-held.json")
    held.write_text(json.dumps(scene))
    try:
        return difference(program, held, scene)
    finally:
        held.unlink()


def difference(program: str, held: pathlib.Path, scene: dict) -> tuple[int, float]:
    """Returns the same numbers for a scene in a file."""
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


def contact_input(scene: dict, mesh: meshio.Mesh, load: dict, held: dict, candidates: set[int], stiffness: float) -> str:
    """Returns the input file of CalculiX with the obstacle; `load` and `held` are values by node and axis."""
    dimension = 3 if scene.get("model") == "space" else 2
    block = mesh.cells[0]
    faces = [
        (element + 1, face + 1, corners)
        for element, nodes in enumerate(block.data)
        for face, corners in enumerate(FACES[block.type])
        if all(int(nodes[corner]) in candidates for corner in corners)
    ]
    points = mesh.points[sorted(candidates)]
    ends = np.array([[mesh.points[block.data[element - 1][corner]] for corner in corners[:2]] for element, _, corners in faces])
    facet = float(np.median(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)))
    obstacle = scene["obstacles"][0]
    plane = obstacle["shape"]["plane"]
    inward = np.array(plane["normal"] + [0.0] * (3 - dimension), dtype=float)
    inward /= np.linalg.norm(inward)
    approach = np.zeros(3)
    approach["xyz".index(obstacle["approach"][1])] = 1.0 if obstacle["approach"][0] == "+" else -1.0
    at = np.array(plane["point"] + [0.0] * (3 - dimension), dtype=float) + scene.get("gap", 0.0) * approach
    # The face of the obstacle extends beyond the candidates.
    middle = points.mean(axis=0)
    middle -= ((middle - at) @ inward) * inward
    reach = 1.5 * float(np.ptp(points, axis=0).max())
    first = len(mesh.points) + 1
    if dimension == 3:
        across = np.linalg.svd(inward[None])[2][1:]
        if np.linalg.det(np.vstack([across, inward])) < 0:
            across = across[::-1]
        corners = [middle + reach * (a * across[0] + b * across[1]) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        corners += [corner + reach * inward for corner in corners]
        kind = "C3D8"
    else:
        along = np.array([inward[1], -inward[0], 0.0])
        corners = [middle - reach * along, middle + reach * along]
        corners += [corner + reach * inward for corner in reversed(corners)]
        kind = {"plane-strain": "CPE4", "plane-stress": "CPS4", "axisymmetric": "CAX4"}[scene["model"]]
    lines = body_of(scene, mesh)
    lines += ["*NODE, NSET=OBSTACLE"] + [f"{first + index}, {numbers(corner)}" for index, corner in enumerate(corners)]
    element = len(block.data) + 1
    lines += [f"*ELEMENT, TYPE={kind}, ELSET=OBSTACLE"]
    lines += [", ".join(str(word) for word in [element] + [first + index for index in range(len(corners))])]
    lines += ["*SOLID SECTION, ELSET=OBSTACLE, MATERIAL=M"] + ([number(scene.get("thickness", 1.0))] if kind.startswith("CP") else [])
    lines += ["*SURFACE, NAME=SLAVE"] + [f"{body}, S{face}" for body, face, _ in faces]
    lines += ["*SURFACE, NAME=MASTER", f"{element}, S1"]
    lines += ["*SURFACE INTERACTION, NAME=CONTACT", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
    lines += [number(stiffness * scene["material"]["young"] / facet)]
    lines += ["*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER"]
    lines += ["*BOUNDARY", f"OBSTACLE, 1, {dimension}"]
    lines += ["*STEP, INC=1000", "*STATIC, SOLVER=SPOOLES", "1.0, 1.0, 1e-5, 1.0", "*BOUNDARY"]
    lines += [f"{node + 1}, {axis + 1}, {axis + 1}, {number(value)}" for (node, axis), value in sorted(held.items())]
    lines += ["*CLOAD"] + [f"{node + 1}, {axis + 1}, {number(value)}" for (node, axis), value in load.items() if value]
    return "\n".join(lines + ["*NODE PRINT, NSET=OBSTACLE, TOTALS=ONLY", "RF", "*END STEP", ""])


class Contact(NamedTuple):
    """A total contact force, and the seconds of the whole command; both are nan if there is no answer."""

    force: float
    seconds: float


def of_calculix(folder: pathlib.Path, deck: str, whole: int) -> Contact:
    """Runs CalculiX on a deck in contact; `whole` is the number of wedges that make the body."""
    (folder / "part.inp").write_text(deck)
    (folder / "part.dat").unlink(missing_ok=True)
    begun = time.perf_counter()
    try:
        solved = subprocess.run(["ccx", "part"], cwd=folder, capture_output=True, text=True, timeout=MOST_SECONDS)
    except subprocess.TimeoutExpired:
        return Contact(math.nan, math.nan)
    seconds = time.perf_counter() - begun
    printed = (folder / "part.dat").read_text().split() if solved.returncode == 0 else []
    if len(printed) < 3:
        return Contact(math.nan, math.nan)
    return Contact(whole * float(np.linalg.norm([float(word) for word in printed[-3:]])), seconds)


def contact_forces(program: str, path: pathlib.Path, poisson: float | None) -> tuple[int, Contact, list[Contact]]:
    """Returns the number of unknowns of a part, our contact force, and that of CalculiX for each contact stiffness."""
    scene = json.loads(path.read_text())
    if poisson is not None:
        scene["material"]["poisson"] = poisson
    dimension = 3 if scene.get("model") == "space" else 2
    at_zero = [support | {axis: 0 for axis in ("x", "y", "z", "value") if axis in support} for support in scene["supports"]]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run = lambda *words: subprocess.run(words, cwd=folder, check=True, capture_output=True)
        shutil.copy(path.parent / scene["body"]["gmsh"]["file"], folder)
        (folder / "loads.json").write_text(json.dumps(scene | {"supports": at_zero}))
        run(program, "export", "loads.json", "problem")
        (folder / "scene.json").write_text(json.dumps(scene))
        begun = time.perf_counter()
        run(program, "solve", "scene.json", "--out", "answer")
        seconds = time.perf_counter() - begun
        mesh = meshio.read(folder / "answer/solution.vtu")
        displacement = np.asarray(mesh.point_data["u"])
        free = free_dofs(folder / "problem/dofs.csv")
        load = dict(zip(free, np.asarray(scipy.io.mmread(folder / "problem/f.mtx")).ravel().tolist()))
        every = {(node, axis) for node in np.unique(mesh.cells[0].data).tolist() for axis in range(dimension)}
        held = {(node, axis): float(displacement[node, axis]) for node, axis in every - set(free)}
        with (folder / "answer/contact.csv").open() as text:
            rows = list(csv.DictReader(text))
        ours = Contact(sum(abs(float(row["force"])) for row in rows), seconds)
        candidates = {int(row["node"]) for row in rows}
        whole = WEDGES if scene.get("model") == "axisymmetric" else 1
        decks_of = (contact_input(scene, mesh, load, held, candidates, stiffness) for stiffness in CONTACT_STIFFNESS)
        return len(free), ours, [of_calculix(folder, deck, whole) for deck in decks_of]


def contact_table(program: str, folder: pathlib.Path, names: list[str], poisson: float | None) -> int:
    """Prints contact forces and seconds. The closest force of CalculiX counts, because CalculiX fails above some contact stiffness."""
    columns = "".join(f"  ccx at {stiffness:5g} {'seconds':>8}" for stiffness in CONTACT_STIFFNESS)
    print(f"{'part':18} {'unknowns':>9} {'force':>12} {'seconds':>8}{columns}")
    worst = 0.0
    for name in names:
        unknowns, ours, theirs = contact_forces(program, folder / f"{name}.json", poisson)
        off = [contact.force / ours.force - 1 for contact in theirs]
        worst = max(worst, np.nanmin(np.abs(off)))
        of_theirs = "".join(f" {share:+12.2e} {contact.seconds:8.2f}" for share, contact in zip(off, theirs))
        print(f"{name:18} {unknowns:9} {ours.force:12.6g} {ours.seconds:8.2f}{of_theirs}", flush=True)
    return int(not worst <= 0.01)


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--decks"] and len(arguments) in (2, 3):
        built = pathlib.Path(__file__).resolve().parent.parent / "target" / "release" / "signorini"
        decks.side_by_side(str(pathlib.Path(*arguments[2:] or (built,)).resolve()), pathlib.Path(arguments[1]))
        return 0
    in_contact = arguments[:1] == ["--contact"]
    arguments = arguments[int(in_contact) :]
    poisson = None
    if in_contact and arguments[:1] == ["--poisson"] and len(arguments) > 1:
        poisson, arguments = float(arguments[1]), arguments[2:]
    if len(arguments) < 3:
        sys.exit("usage: calculix.py [--contact [--poisson NU]] PROGRAM FOLDER NAME [NAME ...], or calculix.py --decks FOLDER [PROGRAM]")
    if in_contact:
        program, folder = str(pathlib.Path(arguments[0]).resolve()), pathlib.Path(arguments[1]).resolve()
        return contact_table(program, folder, arguments[2:], poisson)
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

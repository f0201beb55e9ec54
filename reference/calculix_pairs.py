"""Compares contact forces and seconds for pairs of bodies whose meshes do not match with those of CalculiX.

    pip install gmsh meshio numpy scipy
    python reference/calculix_pairs.py target/release/signorini FOLDER [NUMBER ...]

The pairs are those of touching_bodies.py in space, with tetrahedra and prescribed displacements. CalculiX is the Debian package
calculix-ccx. It gets nodes, elements and displacements of supports from the files of the program; displacements are small. Its contact
surfaces are the faces of each body that look at the other one within NEAR; the surface that carries the rows of the program is the
dependent one. Each pair is solved with hard contact face to face (`TYPE=SURFACE TO SURFACE`) and by its mortar method (`TYPE=MORTAR`).
In both CalculiX 2.20 reduces hard contact to a pressure of K times the overclosure, with K = 50 E of one body, as it warns. So a third
run, face to face, takes TIMES that K.

A line has the force on the upper body from its reactions, the differences of the three runs of CalculiX from it, each as a share of it,
and the seconds of each whole run: read, assembled, solved, written. Where its two kinds of contact agree to AGREE, the stiffer run must
be ours to AGREE, and our seconds at most a quarter of the faster run with hard contact. The exit code is 1 if a pair misses that.
"""

import json
import pathlib
import re
import subprocess
import sys
import time

import gmsh
import meshio
import numpy as np

import calculix
import touching_bodies

PAIRS = (14, 16, 110, 154, 192)
NEAR = 0.15
AGREE = 0.005
TIMES = 50
RUNS = {"surface": "SURFACE TO SURFACE", "mortar": "MORTAR", "stiffer": "SURFACE TO SURFACE"}
"""The kind of contact of each run."""
DEFAULT = re.compile(r"default will be used:\s+(\S+)")
"""The stiffness of contact that CalculiX takes for a hard one."""
SECONDS = 300


def faces_of(mesh, owners, body):
    """Returns the outer faces of a body: element, number of the face, and its corners."""
    block = mesh.cells[0]
    seen = {}
    for element in np.flatnonzero(owners == body):
        for side, corners in enumerate(calculix.FACES[block.type], start=1):
            nodes = block.data[element][list(corners)]
            seen.setdefault(tuple(sorted(nodes)), []).append((int(element), side, nodes))
    return [found[0] for found in seen.values() if len(found) == 1]


def looking(mesh, faces):
    """Returns for both bodies the faces that look at the other one, and their mean edge."""
    centre, normal = [], []
    for own in faces:
        corners = np.array([mesh.points[nodes] for _, _, nodes in own])
        centre.append(corners.mean(axis=1))
        # Corners run inwards in the order of CalculiX.
        vector = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal.append(-vector / np.linalg.norm(vector, axis=1)[:, None])
    apart = np.linalg.norm(centre[0][:, None] - centre[1][None], axis=2) < NEAR + 0.2
    facing = normal[0] @ normal[1].T < -0.5
    across = np.abs(np.einsum("pqx,px->pq", centre[1][None] - centre[0][:, None], normal[0])) < NEAR
    met = apart & facing & across
    chosen = [np.flatnonzero(met.any(axis=1 - body)) for body in (0, 1)]
    return [[faces[body][face] for face in chosen[body]] for body in (0, 1)]


def input_of(scene, mesh, owners, carrier, free, name, stiffness) -> str:
    """Returns the input file of CalculiX for a run."""
    materials = [scene["material"], scene["further-bodies"][0]["material"]]
    block = mesh.cells[0]
    lines = ["*NODE, NSET=ALL"] + [f"{node + 1}, {calculix.numbers(at)}" for node, at in enumerate(mesh.points)]
    for body, material in enumerate(materials):
        lines.append(f"*ELEMENT, TYPE={calculix.ELEMENTS[block.type, 'space']}, ELSET=B{body}")
        lines += [", ".join(map(str, [element + 1, *(block.data[element] + 1)])) for element in np.flatnonzero(owners == body)]
        lines += [f"*MATERIAL, NAME=M{body}", "*ELASTIC", calculix.numbers([material["young"], material["poisson"]])]
        lines.append(f"*SOLID SECTION, ELSET=B{body}, MATERIAL=M{body}")
    sides = looking(mesh, [faces_of(mesh, owners, body) for body in (0, 1)])
    for body, faces in enumerate(sides):
        lines += [f"*SURFACE, NAME=S{body}, TYPE=ELEMENT"] + [f"{element + 1}, S{side}" for element, side, _ in faces]
    order = ("S0", "S1") if carrier == "body" else ("S1", "S0")
    lines += [f"*CONTACT PAIR, INTERACTION=I, TYPE={RUNS[name]}" + ", SMALL SLIDING" * (name == "mortar"), ", ".join(order)]
    lines.append("*SURFACE INTERACTION, NAME=I")
    if name == "stiffer":
        lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{calculix.number(TIMES * stiffness)}, 0."]
    else:
        lines.append("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD")
    held = {(node, axis) for node in range(len(mesh.points)) for axis in range(3)} - set(free)
    of_part = np.unique(block.data[owners == 0])
    supported = sorted({node for node, _ in held} & set(of_part.tolist()))
    lines += ["*NSET, NSET=HELD"] + [f"{node + 1}," for node in supported]
    lines += ["*STEP", "*STATIC, SOLVER=SPOOLES", "1., 1.", "*BOUNDARY"]
    moved = mesh.point_data["u"]
    lines += [f"{node + 1}, {axis + 1}, {axis + 1}, {calculix.number(moved[node][axis])}" for node, axis in sorted(held)]
    return "\n".join(lines + ["*NODE PRINT, NSET=HELD, TOTALS=ONLY", "RF", "*END STEP", ""])


def theirs(folder, scene, mesh, owners, carrier, free, name, stiffness):
    """Returns the force, the seconds and the stiffness of contact of CalculiX."""
    (folder / f"{name}.inp").write_text(input_of(scene, mesh, owners, carrier, free, name, stiffness))
    start = time.perf_counter()
    try:
        done = subprocess.run(["ccx", name], cwd=folder, capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return None, float(SECONDS), None
    seconds = time.perf_counter() - start
    # Each force: the last line of three numbers.
    numbers = [line.split() for line in (folder / f"{name}.dat").read_text().splitlines()] if (folder / f"{name}.dat").exists() else []
    forces = [list(map(float, words)) for words in numbers if len(words) == 3 and words[0][0] in "-0123456789"]
    if done.returncode or "*ERROR" in done.stdout or not forces:
        return None, seconds, None
    default = DEFAULT.search(done.stdout)
    return np.array(forces[-1]), seconds, float(default[1]) if default else None


def compared(program, folder):
    """Prints the line of a pair; returns `True` if it holds what is asked."""
    scene = json.loads((folder / "scene.json").read_text())
    run = lambda *words: subprocess.run([program, *words], cwd=folder, check=True, capture_output=True)
    start = time.perf_counter()
    run("solve", "scene.json", "--out", "answer", "--pictures", "none", "--no-proof", "--quiet")
    seconds = time.perf_counter() - start
    run("export", "scene.json", "problem")
    mesh = meshio.read(folder / "answer/solution.vtu")
    owners = mesh.cell_data["body"][0]
    ours = mesh.point_data["reaction"][np.unique(mesh.cells[0].data[owners == 0])].sum(axis=0)
    free = calculix.free_dofs(folder / "problem/dofs.csv")
    carrier = json.loads((folder / "answer/report.json").read_text())["contact"]["obstacles"][0]["on"]
    runs, stiffness = {}, None
    for name in RUNS:
        *runs[name], found = theirs(folder, scene, mesh, owners, carrier, free, name, stiffness)
        stiffness = stiffness or found
    size = np.linalg.norm(ours)
    words = [f"{scene['title']:22} {size:.4e} {seconds:5.2f} s"]
    for name, (force, spent) in runs.items():
        away = "no answer" if force is None else f"{100 * np.linalg.norm(force - ours) / size:5.2f} %"
        words.append(f"{name} {away} {spent:5.2f} s")
    hard, mortar, stiff = (runs[name][0] for name in RUNS)
    fine = all(force is not None for force in (hard, mortar, stiff))
    if fine:
        is_sure = np.linalg.norm(hard - mortar) < AGREE * size
        fine = np.linalg.norm(stiff - ours) < AGREE * size and seconds <= min(runs[name][1] for name in ("surface", "mortar")) / 4
        fine = fine or not is_sure
    print(" | ".join(words), flush=True)
    return fine


def main(program, folder, *numbers):
    program, folder = str(pathlib.Path(program).resolve()), pathlib.Path(folder)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    fine = []
    for number in map(int, numbers or PAIRS):
        place = folder / str(number)
        place.mkdir(parents=True, exist_ok=True)
        if not (place / "scene.json").exists():
            touching_bodies.pair(number, place)
        fine.append(compared(program, place))
    gmsh.finalize()
    sys.exit(not all(fine))


if __name__ == "__main__":
    main(*sys.argv[1:])

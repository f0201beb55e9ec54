"""Compares decks without contact with CalculiX: twelve with straight edges, others with curved edges.

    target/venv/bin/python reference/decks_without_contact.py target/release/signorini

All elements are quadratic. The first decks show twelve kinds of loads, supports and joints. In the further ones nodes lie on curved
surfaces, on coarse and on finer meshes; the ball is a mesh of Gmsh, which meshio reads. CalculiX, whose command is ccx, prints seven
digits. A line has the largest displacement and the largest difference over it.
"""

import math
import pathlib
import sys
import tempfile

import meshio

import decks
import decks_joined
from decks_joined import PLATE, PRESSED, Block, sets

STEEL = ["*MATERIAL, NAME=M", "*ELASTIC", "200000., .3", "*DENSITY", "7.8D-6", "*EXPANSION, ZERO=20.", "1.2E-5"]
WOOD = [
    "*ORIENTATION, NAME=GRAIN, SYSTEM=RECTANGULAR",
    "0.8, 0.6, 0., -0.6, 0.8, 0.",
    "*MATERIAL, NAME=M",
    "*ELASTIC, TYPE=ENGINEERING CONSTANTS",
    "11000., 900., 500., 0.4, 0.45, 0.5, 700., 650.,",
    "60., 20.",
]
RINGS = ["*ORIENTATION, NAME=GRAIN, SYSTEM=CYLINDRICAL", "-0.5, 0.2, 0., -0.4, 0.5, 1.", *WOOD[2:]]
HELD = ["*BOUNDARY", "Z0, 1, 3"]
WARM = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 20."]
BALL = pathlib.Path(__file__).resolve().parent.parent / "tests" / "meshes" / "half-ball-tet10.msh"
EDGE = 1e-9


def skew(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Maps the cube to a body without right angles."""
    return 2 * x + 0.3 * y, y - 0.2 * z, 1.5 * z + 0.1 * x


def quarter_tube(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Maps the cube to a quarter of a tube with the radii 1 and 2."""
    return (1 + x) * math.cos(math.pi / 2 * y), (1 + x) * math.sin(math.pi / 2 * y), z


def plate(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Maps the cube to a quarter of a square plate with a round hole."""
    side = (3, 6 * y) if y < 0.5 else (6 * (1 - y), 3)
    hole = math.cos(math.pi / 2 * y), math.sin(math.pi / 2 * y)
    return (1 - x) * hole[0] + x * side[0], (1 - x) * hole[1] + x * side[1], 0.4 * z


def single(block: Block, supports: list[str], loads: list[str], material: list[str] = STEEL) -> str:
    """Returns the deck of a block, whose sides are sets of nodes and surfaces."""
    lines = ["*HEADING", "One body", *block.cards("ALL")]
    for axis, letter in enumerate("XYZ"):
        for end in (0, 1):
            side = block.where(lambda *at, axis=axis, end=end: abs(at[axis] - end) < EDGE)
            lines += [*sets({f"{letter}{end}": side}), *block.surface(f"SIDE_{letter}{end}", side)]
    lines += sets({"CORNER": block.where(lambda *at: min(at) > 1 - EDGE)})
    return "\n".join([*lines, *step(supports, loads, material)]) + "\n"


def step(supports: list[str], loads: list[str], material: list[str]) -> list[str]:
    """Returns material, supports and loads of the elements and nodes ALL."""
    section = "*SOLID SECTION, ELSET=ALL, MATERIAL=M" + (", ORIENTATION=GRAIN" if material is WOOD else "")
    return [*material, section, *supports, "*STEP", "*STATIC", *loads, "*NODE PRINT, NSET=ALL", "U", "*END STEP"]


def body(element: str, cells: tuple[int, int, int] = (3, 2, 2), mapped: decks_joined.Map = skew) -> Block:
    """Returns the only body of a deck."""
    return Block(element, cells, 0.0, 1, mapped)


def straight() -> dict[str, str]:
    """Returns the decks with straight edges."""
    tetra, brick = body("C3D10"), body("C3D20")
    cube = body("C3D10", (2, 2, 2), decks_joined.same)
    tied, joined = ("C3D10", "C3D10"), decks_joined.deck
    turning = "ALL, CENTRIF, 4.E6, 0.3, 0., 0., 0., 0.6, 0.8"
    return {
        "pressure, three planes of symmetry": single(
            cube, ["*BOUNDARY", "X0, 1", "Y0, 2", "Z0, 3"], ["*DSLOAD", "SIDE_X1, P, 5.", "SIDE_Z1, P, -3."]
        ),
        "gravity": single(tetra, HELD, ["*DLOAD", "ALL, GRAV, 9810., 0.6, 0., -0.8"]),
        "temperature": single(tetra, [*WARM, *HELD], ["*TEMPERATURE", "ALL, 70."]),
        "centrifugal": single(tetra, HELD, ["*DLOAD", turning]),
        "centrifugal, half the edges": single(body("C3D10", (6, 4, 4)), HELD, ["*DLOAD", turning]),
        "centrifugal, C3D20": single(brick, HELD, ["*DLOAD", turning]),
        "orthotropic, turned axes": single(tetra, HELD, ["*DSLOAD", "SIDE_X1, P, 0.5", "*CLOAD", "CORNER, 2, 0.4"], WOOD),
        "orthotropic, axes around a line, C3D20": single(brick, HELD, ["*DSLOAD", "SIDE_X1, P, 0.5", "*CLOAD", "CORNER, 2, 0.4"], RINGS),
        "pressure, gravity, force, temperature": decks.Bar("C3D10").deck("C3D10"),
        "the same with C3D20": decks.Bar("C3D20").deck("C3D20"),
        "prescribed displacement and pressure, C3D20": single(
            brick, HELD, ["*DSLOAD", "SIDE_Y1, P, 4.", "*BOUNDARY", "Z1, 2, 2, 0.001"]
        ),
        "two bodies, tied": joined(tied, (3, 3), [], False, PRESSED),
        "equations: a flat end": joined(tied, (2, 2), [], True, PRESSED),
        "rigid body under a force": joined(tied, (2, 2), PLATE, False, ["*CLOAD", "200001, 3, -2.", "200001, 1, 0.7"]),
        "rigid body under a moment, C3D20": joined(("C3D20", "C3D20"), (2, 2), PLATE, False, ["*CLOAD", "200002, 2, 0.3"]),
    }


def ball() -> str:
    """Returns the deck of half a ball from Gmsh, held on its cut, under gravity and a force at its lowest node."""
    mesh = meshio.read(BALL)
    elements = mesh.cells_dict["tetra10"]
    used = sorted({int(node) for nodes in elements for node in nodes})
    place = {node: mesh.points[node] for node in used}
    lines = ["*HEADING", "Half a ball", "*NODE, NSET=ALL"]
    lines += [f"{node + 1}, " + ", ".join(f"{value:.12f}" for value in at) for node, at in place.items()]
    lines += ["*ELEMENT, TYPE=C3D10, ELSET=ALL"]
    lines += [", ".join(str(word) for word in (number, *(nodes + 1))) for number, nodes in enumerate(elements, start=1)]
    top = max(at[2] for at in place.values())
    lowest = min(used, key=lambda node: place[node][2])
    lines += sets({"Z0": [node + 1 for node, at in place.items() if at[2] > top - EDGE], "LOWEST": [lowest + 1]})
    loads = ["*DLOAD", "ALL, GRAV, 9810., 0.6, 0., -0.8", "*CLOAD", "LOWEST, 1, 3."]
    return "\n".join([*lines, *step(HELD, loads, STEEL)]) + "\n"


def curved() -> dict[str, str]:
    """Returns the decks with curved edges."""
    found = {}
    symmetric = ["*BOUNDARY", "Y0, 2, 2", "Y1, 1, 1", "Z0, 3, 3"]
    for element in ("C3D10", "C3D20"):
        for times in (1, 2, 4):
            words = f"{element}, {2 * times} cells around"
            tube = body(element, (times, 2 * times, times), quarter_tube)
            found[f"tube, pressure, {words}"] = single(tube, symmetric, ["*DSLOAD", "SIDE_X0, P, 10."])
            found[f"tube, bent, {words}"] = single(tube, ["*BOUNDARY", "Y0, 1, 3"], ["*DLOAD", "ALL, GRAV, 9810., 0.6, 0., -0.8"])
            holed = body(element, (2 * times, 2 * times, 1), plate)
            found[f"plate with a hole, {words}"] = single(holed, symmetric, ["*DSLOAD", "SIDE_X1, P, -10."])
    found["ball of Gmsh, C3D10"] = ball()
    return found


def main() -> None:
    """Prints a line for each deck."""
    program = str(pathlib.Path(sys.argv[1]).resolve())
    for title, found in (("deck", straight()), ("curved edges", curved())):
        print(f"| {title} | largest displacement | difference, of it |")
        for name, text in found.items():
            with tempfile.TemporaryDirectory() as folder:
                largest, difference = decks.compared(program, text, pathlib.Path(folder))
            print(f"| {name} | {largest:.6e} | {difference:.1e} |", flush=True)


if __name__ == "__main__":
    main()

"""Compares decks of two joined blocks with CalculiX: ties, equations, rigid bodies, couplings, springs, constraints, preloads.

    python3 reference/decks_joined.py target/release/signorini

One block stands on the other; the lower one is held, the upper one is pressed and pushed aside at a corner. The blocks of the first lines
have the same mesh on both sides; in the next ones the slave side is the finer one. CalculiX, whose command is ccx, prints seven digits. A
line has the largest displacement and the largest difference over it.
"""

import itertools
import pathlib
import re
import subprocess
import sys
import tempfile
import typing

import decks

Map = typing.Callable[[float, float, float], tuple[float, float, float]]
"""From the place of a node in a block to its place in a body."""

TIE = ["*TIE, NAME=GLUE", "LOWER_SIDE, UPPER_SIDE"]
PRESSED = ["*DSLOAD", "TOP, P, 3.", "*CLOAD", "CORNER, 1, 0.5"]
ALL = ["*CLOAD", "200003, 1, 0.7", "200003, 3, -2.", "200003, 5, 0.3", "200003, 6, 0.2"]
REFERENCES = ["*NODE, NSET=REFERENCES", "200001, 0.5, 0.5, 2.", "200002, 0.5, 0.5, 2.", "200003, 0.7, 0.4, 2.6"]
PLATE = [*REFERENCES, "*RIGID BODY, NSET=END, REF NODE=200001, ROT NODE=200002"]


def coupled(kind: str, directions: str) -> list[str]:
    """Returns a coupling of the top with node 200003."""
    return [*REFERENCES, "*COUPLING, CONSTRAINT NAME=ALL, REF NODE=200003, SURFACE=TOP", f"*{kind}", directions]


def springs(element: str, nodes: str, *values: str) -> list[str]:
    """Returns a spring."""
    return [*REFERENCES, f"*ELEMENT, TYPE={element}, ELSET=SPRING", f"300001, {nodes}", "*SPRING, ELSET=SPRING", *values]


def same(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Returns the place itself."""
    return x, y, z


class Block:
    """A block [0, 1] x [0, 1] above a height, of one type, whose nodes are then mapped to other places."""

    def __init__(self, element: str, cells: tuple[int, int, int], height: float, first: int, mapped: Map = same) -> None:
        self.element, self.first, self.height = element, first, height
        count = int(re.sub("[IR]$", "", element[3:]))
        form = "tetrahedron" if count in (4, 10) else "brick"
        self.faces, mid_sides = decks.CELLS[form]
        self.numbers: dict = {}
        self.nodes: list = []
        self.elements = []
        for k, j, i in itertools.product(*(range(cells[axis]) for axis in (2, 1, 0))):
            around = [
                self.node((a, b, c), (a / cells[0], b / cells[1], height + c / cells[2]))
                for c in (k, k + 1)
                for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
            ]
            for part in decks.TETRAHEDRA if form == "tetrahedron" else (range(8),):
                own = [around[local] for local in part]
                if count > len(own):
                    own += [self.middle(own[a], own[b]) for a, b in mid_sides]
                self.elements.append(own)
        self.lattice = self.nodes
        self.nodes = [mapped(*at) for at in self.lattice]

    node, middle = decks.Bar.node, decks.Bar.middle

    def where(self, condition: typing.Callable[..., bool]) -> list[int]:
        """Returns the numbers of the nodes whose places before the map fulfil a condition."""
        return [self.first + node for node, at in enumerate(self.lattice) if condition(*at)]

    def at_height(self, height: float) -> list[int]:
        """Returns the numbers of the nodes at a height before the map."""
        return self.where(lambda x, y, z: abs(z - height) < 1e-9)

    def cards(self, name: str) -> list[str]:
        """Returns nodes and elements."""
        lines = [f"*NODE, NSET={name}"]
        lines += [f"{self.first + node}, {x:.12f}, {y:.12f}, {z:.12f}" for node, (x, y, z) in enumerate(self.nodes)]
        lines.append(f"*ELEMENT, TYPE={self.element}, ELSET={name}")
        for number, nodes in enumerate(self.elements):
            words = [str(self.first + number), *(str(self.first + node) for node in nodes)]
            lines += [", ".join(words[at : at + 11]) + ("," if at + 11 < len(words) else "") for at in range(0, len(words), 11)]
        return lines

    def surface(self, name: str, nodes: list[int]) -> list[str]:
        """Returns the surface of the faces whose corners are among the nodes."""
        is_there = set(nodes)
        found = itertools.product(enumerate(self.elements), enumerate(self.faces))
        own = [(number, face) for (number, nodes), (face, corners) in found if all(self.first + nodes[at] in is_there for at in corners)]
        return [f"*SURFACE, NAME={name}", *(f"{self.first + number}, S{face + 1}" for number, face in own)]


def cut(block: Block, height: float) -> list[str]:
    """Returns a preload across a block: a surface of the elements below a height, and its reference node 200004."""
    name, *faces = block.surface("CUT", block.at_height(height))
    tops = [max(block.lattice[node][2] for node in nodes) for nodes in block.elements]
    below = [face for face in faces if tops[int(face.split(",")[0]) - block.first] < height + 1e-9]
    return [name, *below, "*NODE", "200004, 0., 0., 0.", "*PRE-TENSION SECTION, SURFACE=CUT, NODE=200004"]


def sets(nodes: dict[str, list[int]]) -> list[str]:
    """Returns the cards of sets of nodes."""
    return [line for name, numbers in nodes.items() for line in (f"*NSET, NSET={name}", *(f"{number}," for number in numbers))]


def deck(elements: tuple[str, str], cells: tuple[int, int], joined: list[str], equations: bool, loads: list[str]) -> str:
    """Returns the deck of two blocks with `cells` along their sides."""
    below = Block(elements[0], (cells[0], cells[0], max(cells[0] // 2, 2)), 0.0, 1)
    above = Block(elements[1], (cells[1], cells[1], max(cells[1] // 3, 2)), 1.0, 100001)
    lines = ["*HEADING", "Two blocks", *below.cards("BELOW"), *above.cards("ABOVE")]
    lines += [*below.surface("UPPER_SIDE", below.at_height(1.0)), *above.surface("LOWER_SIDE", above.at_height(1.0))]
    end = above.at_height(2.0)
    lines += [*above.surface("TOP", end), *sets({"BASE": below.at_height(0.0), "END": end, "CORNER": [end[-1]]})]
    lines += ["*MATERIAL, NAME=SOFT", "*ELASTIC", "1000., .3"]
    lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL=SOFT" for name in ("BELOW", "ABOVE")]
    lines += [*TIE, *joined]
    if any(line.startswith("200004") for line in loads):
        lines += cut(below, 0.5)
    if equations:
        lines += ["*EQUATION", *(line for node in end[1:] for line in ("2", f"{node}, 3, 1., {end[0]}, 3, -1."))]
    lines += ["*BOUNDARY", "BASE, 1, 3", "*STEP", "*STATIC", *loads]
    return "\n".join([*lines, "*NODE PRINT, NSET=BELOW", "U", "*NODE PRINT, NSET=ABOVE", "U", "*END STEP"]) + "\n"


def main() -> None:
    """Prints a line for each deck."""
    program = str(pathlib.Path(sys.argv[1]).resolve())
    cases = [(f"tied, {one}", deck((one, one), (2, 2), [], False, PRESSED)) for one in ("C3D4", "C3D8", "C3D10", "C3D20")]
    for pair, times in itertools.product((("C3D8", "C3D8"), ("C3D10", "C3D8"), ("C3D20", "C3D20")), (2, 4)):
        name = f"tied, {pair[0]} on {pair[1]}, {3 * times} on {2 * times} cells"
        cases.append((name, deck(pair[::-1], (2 * times, 3 * times), [], False, PRESSED)))
    hexa = ("C3D8", "C3D8")
    cases.append(("equations: a flat end", deck(hexa, (2, 2), [], True, PRESSED)))
    cases.append(("rigid body, force", deck(hexa, (2, 2), PLATE, False, ["*CLOAD", "200001, 3, -2.", "200001, 1, 0.7"])))
    cases.append(("rigid body, moment", deck(hexa, (2, 2), PLATE, False, ["*CLOAD", "200002, 2, 0.3", "200002, 3, 0.2"])))
    turned = ["*BOUNDARY", "200002, 3, 3, 0.001", "200001, 1, 2"]
    cases.append(("rigid body, turned", deck(hexa, (2, 2), PLATE, False, turned)))
    for element in ("C3D4", "C3D8", "C3D10", "C3D20"):
        cases.append((f"distributing, {element}", deck((element, element), (2, 2), coupled("DISTRIBUTING", "1, 6"), False, ALL)))
    cases.append(("kinematic, 1 to 3", deck(hexa, (2, 2), coupled("KINEMATIC", "1, 3"), False, ALL)))
    cases.append(("kinematic, 1 and 2", deck(hexa, (2, 2), coupled("KINEMATIC", "1, 2"), False, ["*BOUNDARY", "200003, 4, 5", "*CLOAD", "200003, 1, 0.7", "200003, 6, 0.2"])))
    held = ["*BOUNDARY", "200003, 3, 3, -0.01", "200003, 4, 4", "200003, 5, 5, 0.001", "200003, 6, 6"]
    cases.append(("kinematic, 3, moved", deck(hexa, (2, 2), coupled("KINEMATIC", "3"), False, held)))
    loose = [*REFERENCES, "*EQUATION", "3", "100027, 1, 1., 100019, 1, 0.5, 200001, 1, -1.", "2", "100027, 2, 1., 200001, 1, -0.3"]
    cases.append(("equations, loose node", deck(hexa, (2, 2), loose, False, ["*CLOAD", "200001, 1, 0.5", "100022, 3, 0.2"])))
    cases.append(("equations, loose node moved", deck(hexa, (2, 2), loose, False, ["*BOUNDARY", "200001, 1, 1, 0.002"])))
    small = ["*CLOAD", "100027, 1, 5.e-7", "100022, 3, 2.e-7"]
    moved = ["*BOUNDARY", "200003, 1, 1, 1.e-6", "200003, 2, 3", *small]
    cases.append(("SPRINGA, to a node moved a little", deck(hexa, (2, 2), springs("SPRINGA", "100027, 200003", "30."), False, moved)))
    cases.append(("SPRINGA, two bodies", deck(hexa, (2, 2), springs("SPRINGA", "100027, 5", "30."), False, PRESSED)))
    cases.append(("SPRING1", deck(hexa, (2, 2), springs("SPRING1", "100027", "1", "30."), False, PRESSED)))
    cases.append(("SPRING2", deck(hexa, (2, 2), springs("SPRING2", "100027, 100025", "1, 3", "30."), False, PRESSED)))
    for constraint in ("PLANE, END", "STRAIGHT, 100019, 100026, 100022", "BEAM, 100019, 100027"):
        cases.append((f"{constraint.split(',')[0]}, small forces", deck(hexa, (2, 2), ["*MPC", constraint], False, small)))
    for element, load in itertools.product(("C3D8", "C3D20"), (["*CLOAD", "200004, 1, 20."], ["*BOUNDARY", "200004, 1, 1, 0.01"])):
        kind = "force" if load[0] == "*CLOAD" else "shortening"
        drawn = [*load, "*BOUNDARY", "END, 1, 3", "*CLOAD", "CORNER, 1, 0.5"]
        cases.append((f"bolt, {kind}, {element}", deck((element, element), (2, 2), [], False, drawn)))
    for name, text in cases:
        with tempfile.TemporaryDirectory() as folder:
            largest, difference = decks.compared(program, text, pathlib.Path(folder))
        print(f"{name:40} largest displacement {largest:.6e}, differs by {difference:.1e}")


if __name__ == "__main__":
    main()

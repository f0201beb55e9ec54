"""Compares displacements of decks with those of CalculiX, element by element.

    python3 reference/decks.py target/release/signorini
    python3 reference/decks.py target/release/signorini --decks FOLDER

Each deck is a bar without right angles, held at one end, under pressure, gravity, a force on a node and warming. CalculiX is the Debian
package calculix-ccx; its command is ccx. It prints seven digits. A line has the largest displacement and the largest difference over it.

With `--decks` both programs solve each deck of a folder. A line has the seconds of both, the largest value of each field of the last
increment and the largest difference over it, as the files `.frd` and the sums of forces in the files `.dat` say, and the last error or
warning of CalculiX.
"""

import itertools
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

SOLIDS = ("C3D4", "C3D8", "C3D10", "C3D20", "C3D8I", "C3D8R", "C3D20R")
PLANES = ("CPE3", "CPE4", "CPE6", "CPE8", "CPE4R", "CPE8R", "CPS3", "CPS4", "CPS6", "CPS8", "CAX3", "CAX4", "CAX6", "CAX8")

TETRAHEDRA = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
"""Six tetrahedra around the diagonal of a brick."""

CELLS = {
    "tetrahedron": (
        ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
        ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    ),
    "brick": (
        ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
        ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    ),
    "triangle": (((0, 1), (1, 2), (2, 0)), ((0, 1), (1, 2), (2, 0))),
    "quadrilateral": (((0, 1), (1, 2), (2, 3), (3, 0)), ((0, 1), (1, 2), (2, 3), (3, 0))),
}
"""Corners of the faces and of the mid-sides, in the order of CalculiX."""


def place(i: float, j: float, k: float, start: float) -> tuple[float, float, float]:
    """Returns the place of a corner of the lattice; no cell has right angles."""
    x, y, z = 2 * i, j, k
    return (start + x * (1 + 0.1 * y) + 0.05 * z * y, y + 0.08 * x * (z + 0.5), z * (1 - 0.05 * x))


class Bar:
    """Nodes and elements of a bar of one type."""

    def __init__(self, element: str) -> None:
        self.is_solid = element.startswith("C3D")
        count = int(re.sub("[IR]$", "", element[3:]))
        forms = {4: "tetrahedron", 10: "tetrahedron"} if self.is_solid else {3: "triangle", 6: "triangle"}
        form = forms.get(count, "brick" if self.is_solid else "quadrilateral")
        self.faces, mid_sides = CELLS[form]
        self.numbers: dict = {}
        self.nodes: list = []
        self.elements = []
        start = 1.0 if element.startswith("CAX") else 0.0
        cells = (3, 2, 2) if self.is_solid else (4, 3, 0)
        steps = [[step / max(of, 1) for step in range(of + 1)] for of in cells]

        def corner(i: int, j: int, k: int) -> int:
            return self.node((i, j, k), place(steps[0][i], steps[1][j], steps[2][k], start))

        for k, j, i in itertools.product(range(max(cells[2], 1)), range(cells[1]), range(cells[0])):
            layers = (k, k + 1) if self.is_solid else (k,)
            around = [corner(a, b, c) for c in layers for a, b in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
            parts = {"tetrahedron": TETRAHEDRA, "triangle": ((0, 1, 2), (0, 2, 3))}.get(form, (range(len(around)),))
            for part in parts:
                own = [around[local] for local in part]
                if count > len(own):
                    own += [self.middle(own[a], own[b]) for a, b in mid_sides]
                self.elements.append(own)

    def node(self, key: tuple, at: tuple) -> int:
        """Returns the number of a node, from 0."""
        if key not in self.numbers:
            self.numbers[key] = len(self.nodes)
            self.nodes.append(at)
        return self.numbers[key]

    def middle(self, a: int, b: int) -> int:
        """Returns the number of the node in the middle of two."""
        ends = (self.nodes[a], self.nodes[b])
        return self.node(("middle", min(a, b), max(a, b)), tuple(sum(pair) / 2 for pair in zip(*ends, strict=True)))

    def deck(self, element: str) -> str:
        """Returns the deck of the bar; nodes have ten times their numbers from 1."""
        lines = ["*HEADING", f"A bar of {element}", "*NODE, NSET=ALL"]
        lines += [f"{10 * (node + 1)}, {x:.12f}, {y:.12f}, {z:.12f}" for node, (x, y, z) in enumerate(self.nodes)]
        lines.append(f"*ELEMENT, TYPE={element}, ELSET=BAR")
        for number, nodes in enumerate(self.elements):
            words = [str(number + 1), *(str(10 * (node + 1)) for node in nodes)]
            lines += [", ".join(words[at : at + 11]) + ("," if at + 11 < len(words) else "") for at in range(0, len(words), 11)]
        is_round = element.startswith("CAX")
        axis, base = (1, min(at[1] for at in self.nodes)) if is_round else (0, self.nodes[0][0])
        held = [node for node, at in enumerate(self.nodes) if at[axis] < base + (0.2 if is_round else 1e-9)]
        lines += ["*NSET, NSET=HELD", *(f"{10 * (node + 1)}," for node in held)]
        lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "200000., .3", "*DENSITY", "7.8D-6", "*EXPANSION, ZERO=20.", "1.2E-5"]
        lines.append("*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL")
        lines += [] if self.is_solid or is_round else ["0.7"]
        lines += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 20.", "*BOUNDARY"]
        lines.append("HELD, 2, 2" if is_round else f"HELD, 1, {3 if self.is_solid else 2}")
        lines += ["*STEP", "*STATIC", "*DLOAD"]
        for (number, nodes), (face, corners) in itertools.product(enumerate(self.elements), enumerate(self.faces)):
            if all(self.nodes[nodes[corner]][2 if self.is_solid else 1] > 0.85 for corner in corners):
                lines.append(f"{number + 1}, P{face + 1}, 12.5")
        lines.append("BAR, GRAV, 9810., 0., -2., " + ("-1." if self.is_solid else "0."))
        last = 10 * len(self.nodes)
        lines += ["*CLOAD", f"{last}, 2, -3.", f"{last}, 1, 7.", "*TEMPERATURE", "ALL, 55."]
        return "\n".join([*lines, "*NODE PRINT, NSET=ALL", "U", "*END STEP"]) + "\n"


def compared(program: str, deck: str, folder: pathlib.Path, axes: int = 3) -> tuple[float, float]:
    """Returns the largest displacement that CalculiX prints, and the largest difference over it."""
    tables = []
    for command in (["ccx"], [program, "ccx"]):
        (folder / "deck.inp").write_text(deck)
        subprocess.run([*command, "deck"], cwd=folder, check=True, capture_output=True)
        lines = [line.split() for line in (folder / "deck.dat").read_text().splitlines()]
        tables.append({int(words[0]): [float(word) for word in words[1:4]] for words in lines if words and words[0].isdigit()})
    largest = max(abs(value) for values in tables[0].values() for value in values)
    pairs = (zip(tables[0][number][:axes], tables[1][number][:axes], strict=True) for number in tables[0])
    return largest, max(abs(one - other) for pair in pairs for one, other in pair) / largest


def fields(frd: pathlib.Path) -> dict[str, dict[int, list[float]]]:
    """Returns the values of each node in the last increment, field by field."""
    found: dict = {}
    for line in frd.read_text(errors="replace").splitlines() if frd.exists() else ():
        if line.startswith(" -4"):
            values = found[line[5:13].strip()] = {}
        elif line.startswith(" -1") and found:
            values[int(line[3:13])] = [float(line[at : at + 12]) for at in range(13, len(line.rstrip()), 12)]
    return found


def sums(dat: pathlib.Path) -> dict[str, dict[int, list[float]]]:
    """Returns the last sum of forces of each set, as a field of one node."""
    text = dat.read_text() if dat.exists() else ""
    found = re.findall(r"total force \(fx,fy,fz\) for set (\S+) and time.*\n\n(.*)", text)
    found += [("contact", line) for line in re.findall(r"total surface force \(fx,fy,fz\) and moment.*\n\n(.*)", text)]
    return {f"sum {name}": {0: [float(word) for word in line.split()]} for name, line in found}


def run(command: list[str], deck: pathlib.Path, limit: float | None = None) -> tuple[float, str, dict]:
    """Returns the seconds of a program in a copy of the folder of a deck, its last error, or else its last warning, and its fields.

    A program that takes longer than the limit in seconds raises `subprocess.TimeoutExpired`.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "deck"
        shutil.copytree(deck.parent, folder, ignore=shutil.ignore_patterns("*.frd", "*.dat", "*.signorini"))
        start = time.perf_counter()
        ended = subprocess.run([*command, "-i", deck.stem], cwd=folder, capture_output=True, text=True, errors="replace", timeout=limit)
        seconds = time.perf_counter() - start
        lines = [line.strip() for line in ended.stdout.splitlines()]
        said = [line for word in ("*WARNING", "*ERROR") for line in lines if line.startswith(word)]
        code = f"exit code {ended.returncode}: " if ended.returncode else ""
        return seconds, code + (said or [""])[-1], fields(folder / f"{deck.stem}.frd") | sums(folder / f"{deck.stem}.dat")


def side_by_side(program: str, folder: pathlib.Path) -> None:
    """Prints the differences of both programs on each deck of a folder."""
    for deck in sorted(folder.resolve().glob("*.inp")):
        (seconds, ending, ours), (of_other, said, theirs) = run([program, "ccx"], deck), run(["ccx"], deck)
        print(f"{deck.stem}: {seconds:.2f} s, CalculiX {of_other:.2f} s")
        for name in [name for name in ours if name in theirs]:
            nodes = [node for node in ours[name] if node in theirs[name]]
            pairs = [pair for node in nodes for pair in zip(ours[name][node], theirs[name][node], strict=False)]
            largest = max((abs(value) for _, value in pairs), default=0.0)
            difference = max((abs(one - other) for one, other in pairs), default=0.0) / (largest or 1.0)
            missing = len(theirs[name]) - len(nodes)
            print(f"  {name:20} largest {largest:.5e}, differs by {difference:.1e}" + (f", {missing} nodes are missing" if missing else ""))
        for name, words in (("signorini", ending), ("CalculiX", said)):
            print(f"  {name} says: {words[:200]}" if words else f"  {name} says nothing")


def main() -> None:
    """Prints a line for each element, or for each deck of a folder."""
    program = str(pathlib.Path(sys.argv[1]).resolve())
    if "--decks" in sys.argv:
        return side_by_side(program, pathlib.Path(sys.argv[sys.argv.index("--decks") + 1]))
    for element in (*SOLIDS, *PLANES):
        with tempfile.TemporaryDirectory() as folder:
            largest, difference = compared(program, Bar(element).deck(element), pathlib.Path(folder), 3 if element.startswith("C3D") else 2)
        print(f"{element:7} largest displacement {largest:.6e}, differs by {difference:.1e}")


if __name__ == "__main__":
    main()

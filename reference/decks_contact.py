"""Compares decks with contact with CalculiX at the hardest stiffness of contact at which it converges.

    python3 reference/decks_contact.py target/release/signorini
    python3 reference/decks_contact.py target/release/signorini NAME [NAME ...]

A body stands on another one or hangs above it. The stiffness of contact (`PRESSURE-OVERCLOSURE=LINEAR`) takes values of 100 E/h to 1e8 E/h,
ten or a hundred times as large each, where h is an edge of the slave surface; CalculiX, whose command is ccx, solves each deck. Both
programs get the same deck; signorini answers it by hard contact. Strains are at most 1e-3, because CalculiX moves the contact surfaces
in each increment.

A line says whether nodes of both surfaces coincide. It has the number of unknowns, the hardest stiffness at which CalculiX converges over
E/h, the largest displacement, the largest difference over it, the same between CalculiX at this stiffness and at the next lower one, the
difference of the contact force over its largest component, and the seconds of both programs as whole commands, the median of three runs.
"""

import pathlib
import statistics
import subprocess
import sys
import tempfile
import typing

import decks
from decks_joined import Block, Map, sets

YOUNG = 1000.0
SECONDS = 300.0
"""The limit of a run of CalculiX."""
SURFACES, NODES = "SURFACE TO SURFACE", "NODE TO SURFACE"
FORCE = "sum contact"
FACE = 1e-9
FEW = (2, 4, 6)
"""The powers of ten for decks that take long."""


class Answer(typing.NamedTuple):
    """The answer of a program to a deck."""

    seconds: float
    said: str
    values: dict


class Case(typing.NamedTuple):
    """Two bodies of which the upper one carries the slave surface, with the sets that are held and the faces under pressure."""

    below: Block
    above: Block
    edge: float
    supports: list[str]
    pressed: typing.Callable[..., bool]
    pressure: float
    kind: str = SURFACES
    exponents: typing.Iterable[int] = range(2, 9)

    def deck(self, stiffness: float) -> str:
        """Returns the deck with a stiffness of contact."""
        lines = ["*HEADING", "Two bodies in contact", *self.below.cards("BELOW"), *self.above.cards("ABOVE")]
        for name, body in (("BELOW", self.below), ("ABOVE", self.above)):
            for axis, letter in enumerate("XY"):
                lines += sets({f"{name}_{letter}": body.where(lambda *at, axis=axis: at[axis] < FACE)})
        lines += [*sets({"BASE": self.below.at_height(0.0)})]
        lines += [*self.below.surface("MASTER", self.below.at_height(1.0)), *self.above.surface("SLAVE", self.above.at_height(1.0))]
        lines += self.above.surface("PRESSED", self.above.where(lambda x, y, z: z > 2 - FACE and self.pressed(x, y)))
        lines += ["*MATERIAL, NAME=SOFT", "*ELASTIC", f"{YOUNG}, .3"]
        lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL=SOFT" for name in ("BELOW", "ABOVE")]
        lines += ["*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"]
        # Contact from node to surface also needs the tension at large distances.
        lines += [f"{stiffness:.6e}" + (f", {YOUNG * 1e-9:.6e}" if self.kind == NODES else "")]
        lines += [f"*CONTACT PAIR, INTERACTION=TOUCH, TYPE={self.kind}", "SLAVE, MASTER", "*BOUNDARY", *self.supports]
        lines += ["*STEP, INC=1000", "*STATIC", "*DSLOAD", f"PRESSED, P, {self.pressure}", "*NODE FILE", "U", "*EL FILE", "S"]
        lines += ["*CONTACT PRINT, SLAVE=SLAVE, MASTER=MASTER", "CF"] if self.kind == SURFACES else []
        return "\n".join([*lines, "*END STEP"]) + "\n"

    def unknowns(self) -> int:
        """Returns the number of displacements of all nodes."""
        return 3 * (len(self.below.nodes) + len(self.above.nodes))

    def is_matching(self) -> bool:
        """Returns `True` if each node of the slave surface has one of the master surface below it."""
        return {self.above.nodes[node - self.above.first][:2] for node in self.above.at_height(1.0)} <= {
            self.below.nodes[node - self.below.first][:2] for node in self.below.at_height(1.0)
        }


QUARTER = ["BASE, 1, 3", "BELOW_X, 1", "BELOW_Y, 2", "ABOVE_X, 1", "ABOVE_Y, 2"]
"""A quarter of two bodies with two planes of symmetry."""


def layer(elements: tuple[str, str], cells: tuple[int, int], kind: str = SURFACES) -> Case:
    """Returns a quarter of a layer that is pressed in its middle and lifts off the block below it at its rim."""
    below = Block(elements[0], (cells[0], cells[0], max(cells[0] * 2 // 3, 2)), 0.0, 1)
    above = Block(elements[1], (cells[1], cells[1], max(cells[1] // 3, 1)), 1.0, 100001, lambda x, y, z: (x, y, 1 + 0.3 * (z - 1)))
    return Case(below, above, 1 / cells[1], QUARTER, lambda x, y: x < 0.5 + FACE and y < 0.5 + FACE, 0.1, kind)


def blocks(elements: tuple[str, str], cells: tuple[int, int]) -> Case:
    """Returns a quarter of two cubes, the upper one pressed in its middle, which touch everywhere."""
    below = Block(elements[0], (cells[0], cells[0], cells[0]), 0.0, 1)
    above = Block(elements[1], (cells[1], cells[1], cells[1]), 1.0, 100001)
    return Case(below, above, 1 / cells[1], QUARTER, lambda x, y: x < 0.5 + FACE and y < 0.5 + FACE, 0.1)


def punch(elements: tuple[str, str], cells: tuple[int, int]) -> Case:
    """Returns a quarter of a punch whose lower side is a paraboloid with the radius 100, on a block twice as wide."""
    below = Block(elements[0], (cells[0], cells[0], cells[0]), 0.0, 1, lambda x, y, z: (2 * x, 2 * y, 2 * z - 1))
    rise: Map = lambda x, y, z: (x, y, z + (2 - z) * (x * x + y * y) / 200)
    above = Block(elements[1], (cells[1], cells[1], max(cells[1] * 2 // 3, 1)), 1.0, 100001, rise)
    return Case(below, above, 1 / cells[1], QUARTER, lambda x, y: True, 0.4)


def cantilever(elements: tuple[str, str], cells: tuple[int, int]) -> Case:
    """Returns a cantilever of the length 10 that bends by its load until it meets a stop 0.0005 below its end."""
    below = Block(elements[0], (cells[0], cells[0], cells[0]), 0.0, 1, lambda x, y, z: (8.5 + x, 1.5 * y - 0.25, z - 0.0005))
    above = Block(elements[1], (10 * cells[1], cells[1], cells[1]), 1.0, 100001, lambda x, y, z: (10 * x, y, z))
    return Case(below, above, 1 / cells[1], ["BASE, 1, 3", "ABOVE_X, 1, 3"], lambda x, y: True, 0.001)


def cases() -> dict[str, Case]:
    """Returns all cases by their names."""
    hexa, tetra, twenty = (("C3D8",) * 2, ("C3D10",) * 2, ("C3D20",) * 2)
    return {
        "blocks, C3D8": blocks(hexa, (6, 6)),
        "blocks, C3D10": blocks(tetra, (4, 4)),
        "blocks, C3D20": blocks(twenty, (4, 4)),
        "layer, C3D8": layer(hexa, (8, 8)),
        "layer, C3D8, from nodes": layer(hexa, (8, 8), NODES),
        "layer, C3D10": layer(tetra, (4, 4)),
        "layer, C3D20": layer(twenty, (4, 4))._replace(exponents=FEW),
        "blocks, C3D8, large": blocks(hexa, (12, 12))._replace(exponents=FEW),
        "blocks, C3D10, large": blocks(tetra, (7, 7))._replace(exponents=FEW),
        "layer, C3D8, large": layer(hexa, (14, 14))._replace(exponents=FEW),
        "blocks, C3D8 on C3D8": blocks(hexa, (6, 8)),
        "blocks, C3D10 on C3D8": blocks(("C3D8", "C3D10"), (4, 5))._replace(exponents=FEW),
        "blocks, C3D20 on C3D20": blocks(twenty, (3, 4))._replace(exponents=FEW),
        "layer, C3D8 on C3D8, large": layer(hexa, (14, 16))._replace(exponents=FEW),
        "punch, C3D10 on C3D10": punch(tetra, (5, 4))._replace(exponents=FEW),
        "punch, C3D20 on C3D20": punch(twenty, (4, 4))._replace(exponents=FEW),
        "cantilever, C3D8 on C3D8": cantilever(hexa, (3, 4))._replace(exponents=FEW),
        "cantilever, C3D20 on C3D20": cantilever(twenty, (2, 2))._replace(exponents=FEW),
    }


def answered(command: list[str], text: str, limit: float) -> Answer | None:
    """Returns the answer of a program to a deck, or `None` if it has none within the limit."""
    with tempfile.TemporaryDirectory() as folder:
        deck = pathlib.Path(folder) / "deck.inp"
        deck.write_text(text)
        try:
            answer = Answer(*decks.run(command, deck, limit))
        except subprocess.TimeoutExpired:
            return None
    return None if answer.said.startswith("exit code") or "DISP" not in answer.values else answer


def difference(one: Answer, other: Answer, field: str = "DISP") -> float:
    """Returns the largest difference of the values of a field over the largest value of the first answer."""
    pairs = [pair for node, own in one.values[field].items() for pair in zip(own[:3], other.values[field][node][:3], strict=True)]
    return max(abs(a - b) for a, b in pairs) / max(abs(a) for a, _ in pairs)


def median(command: list[str], text: str, first: Answer) -> float:
    """Returns the median of the seconds of three runs, of which the first one is given."""
    further = (answered(command, text, SECONDS) for _ in range(2))
    return statistics.median([first.seconds, *(answer.seconds for answer in further if answer)])


def line(program: str, name: str, case: Case) -> str:
    """Returns the line of a case."""
    texts = {10.0**exponent: case.deck(10.0**exponent * YOUNG / case.edge) for exponent in case.exponents}
    found = {times: answered(["ccx"], text, SECONDS) for times, text in texts.items()}
    theirs = {times: answer for times, answer in found.items() if answer}
    *lower, hardest = sorted(theirs) or [min(texts)]
    words, own = [name, "yes" if case.is_matching() else "no", f"{case.unknowns():,}"], [program, "ccx"]
    ours = answered(own, texts[hardest], SECONDS)
    if ours is None or not theirs:
        return " | ".join([*words, f"no answer of {'CalculiX' if ours else 'signorini'}"])
    answer = theirs[hardest]
    words += [f"{hardest:.0e}", f"{max(abs(value) for at in ours.values['DISP'].values() for value in at[:3]):.4e}"]
    words += [f"{difference(answer, ours):.1e}", f"{difference(answer, theirs[lower[-1]]):.1e}" if lower else "-"]
    words += [f"{difference(answer, ours, FORCE):.1e}" if case.kind == SURFACES else "-"]
    words += [f"{median(own, texts[hardest], ours):.2f}", f"{median(['ccx'], texts[hardest], answer):.2f}"]
    return " | ".join(words)


def main() -> None:
    """Prints a line for each case, or for those that are named."""
    program = str(pathlib.Path(sys.argv[1]).resolve())
    for name, case in cases().items():
        if name in sys.argv[2:] or not sys.argv[2:]:
            print(f"| {line(program, name, case)} |", flush=True)


if __name__ == "__main__":
    main()

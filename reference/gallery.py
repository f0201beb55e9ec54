"""Runs the scenes of the gallery, and writes docs/gallery.md with its pictures and the pictures of docs/slides.md.

    python3 reference/gallery.py target/release/signorini

The script needs only Python and the program. Every run writes the same pages.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile
from typing import NamedTuple

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
PICTURES = DOCS / "gallery"


class Entry(NamedTuple):
    """An entry of the gallery: its texts, its command without `--out`, and the file that is shown."""

    name: str
    title: str
    sentence: str
    command: str
    picture: str


ENTRIES = [
    Entry("plane", "A block and a parabola", "In plane strain: both stresses, the displaced mesh, and the seven closed nodes.",
          "solve examples/indentation.json", "contact.png"),
    Entry("circle", "A block and a circle", "Triangles that are graded towards the contact.",
          "solve examples/circle.json", "contact.png"),
    Entry("between", "Between a plane and a circle", "Two obstacles, one below and one above the same body.",
          "solve examples/between.json", "contact.png"),
    Entry("inclined", "Under an inclined plane", "Contact rows along the normal of the obstacle.",
          "solve examples/inclined.json", "contact.png"),
    Entry("pressure", "Pressure of three methods", "Contact pressure over the contact boundary, by the QP, the active set and the penalty.",
          "compare examples/indentation.json", "pressure.png"),
    Entry("cylinders", "Two bodies", "Half cylinders of steel and bronze, whose nodes pair up.",
          "solve examples/two_cylinders.json", "contact.png"),
    Entry("axis", "About an axis", "A ball pressed with 1000 N into a steel disc; Hertz gives a peak pressure of 2953 MPa.",
          "solve examples/gallery/indenter.json", "contact.png"),
    Entry("ring", "Pressed with a force", "A ring between two plates; each plate moves as far as its force of 100 N takes it.",
          "solve examples/gallery/ring.json", "contact.png"),
    Entry("space", "In space", "A ball pressed into a block: von Mises stress, the transparent obstacle, and the contact in plan view.",
          "solve examples/ball.json", "contact.png"),
    Entry("part", "A part from Gmsh", "A machine foot of ten-node tetrahedra under 10 kN, the scene of the tutorial.",
          "solve examples/first-part/foot.json", "contact.png"),
    Entry("sweep", "A sweep", "Contact force and width over the gap.",
          "sweep examples/indentation.json --gaps -0.01:-0.10:10", "force-width.png"),
    Entry("motion", "A motion", "A bar thrown against a wall: contact force and energies over time.",
          "solve studies/impact/bar.json", "history.png"),
    Entry("tradeoff", "A trade-off", "Error over seconds of every method, the error of the mesh included.",
          "tradeoff examples/indentation.json --refinements 1 --runs 1", "total-error.png"),
]

GAPS = 10


def run(program, command, folder):
    """Runs the program in the root of the repository; its files are written into a folder."""
    words = [program, *command.split(), "--out", str(folder)]
    ended = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    if ended.returncode:
        sys.exit(f"signorini {command}: exit code {ended.returncode}: {ended.stderr.strip()}")


def gallery(program):
    """Writes docs/gallery.md and its pictures."""
    lines = ["# Gallery", "", "This page shows scenes of each kind, with the command that draws each picture. All pictures are written by", "",
             "```sh", "python3 reference/gallery.py target/release/signorini", "```", ""]
    for entry in ENTRIES:
        with tempfile.TemporaryDirectory() as folder:
            run(program, entry.command, folder)
            shutil.copy(pathlib.Path(folder) / entry.picture, PICTURES / f"{entry.name}.png")
        lines += [f"## {entry.title}", "", entry.sentence, "", "```sh", f"signorini {entry.command} --out answer", "```", "",
                  f"![{entry.sentence}](gallery/{entry.name}.png)", ""]
    (DOCS / "gallery.md").write_text("\n".join(lines))


def slides(program):
    """Writes the pictures of docs/slides.md: the scene, three iterations of the contact set, and ten gaps."""
    run(program, "draw examples/indentation.json", PICTURES / "set-up.png")
    with tempfile.TemporaryDirectory() as folder:
        run(program, "compare examples/indentation.json", folder)
        for number in (1, 2, 3):
            shutil.copy(pathlib.Path(folder) / f"iteration-{number}.png", PICTURES / f"search-{number}.png")
    with tempfile.TemporaryDirectory() as folder:
        run(program, f"sweep examples/indentation.json --gaps -0.01:-0.10:{GAPS}", folder)
        for number in range(1, GAPS + 1):
            shutil.copy(pathlib.Path(folder) / f"gap-{number:02}.png", PICTURES / f"gap-{number:02}.png")


def main(arguments):
    if len(arguments) != 1:
        sys.exit("usage: gallery.py PROGRAM")
    program = str(pathlib.Path(arguments[0]).resolve())
    PICTURES.mkdir(exist_ok=True)
    gallery(program)
    slides(program)


if __name__ == "__main__":
    main(sys.argv[1:])

"""Reads the files of `signorini export --format petsc` with PETSc, and compares them with the Matrix Market files of the same scene.

    SIGNORINI=target/release/signorini /usr/bin/python3 -m unittest discover -s distributed/tests -p test_export.py

The program is $SIGNORINI, or target/release/signorini of this repository. petsc4py is Debian's `python3-petsc4py`.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("SIGNORINI", ROOT / "target/release/signorini")).resolve()

try:
    import petsc4py
except ImportError:
    # Debian installs petsc4py in the folder of PETSc.
    beside = sorted(Path("/usr/lib/petscdir").glob("petsc*/*real*/lib/python3/dist-packages"))
    sys.path.extend(map(str, beside[-1:]))
    import petsc4py

petsc4py.init([])
from petsc4py import PETSc  # noqa: E402


def axis(cells):
    return {"points": [0, 1], "divisions": [cells]}


def block():
    """A block on rollers along three axes and on springs, with an inclined support at one corner."""
    return {
        "model": "space",
        "body": {"box": {"x": axis(4), "y": axis(3), "z": axis(4), "element": "hex8"}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [
            {"on": {"boundary": "left"}, "x": 0},
            {"on": {"boundary": "bottom"}, "z": 0},
            {"on": {"boundary": "front"}, "y": 0.001},
            {"on": {"point": [1, 1, 1]}, "normal": [1, 2, 0]},
        ],
        "springs": [{"on": {"boundary": "right"}, "y": 1e5}],
        "obstacles": [{"boundary": "top", "approach": "+z", "shape": {"sphere": {"apex": [0.5, 0.5, 1], "radius": 1}}}],
        "gap": -0.01,
    }


def line():
    """A bar between a support and a wall."""
    return {
        "model": "bar",
        "body": {"bar": {"x": axis(5)}},
        "material": {"young": 1e7, "poisson": 0},
        "supports": [{"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"force": {"at": [1], "value": [3]}}],
        "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [1], "normal": [1]}}}],
    }


def scenes():
    yield 3, block()
    yield 1, line()
    for dimension, name in [(2, "indentation"), (2, "inclined"), (2, "two_cylinders"), (3, "ball"), (2, "bar")]:
        yield dimension, json.loads((ROOT / f"examples/{name}.json").read_text())


def matrix_market(file):
    """Reads a Matrix Market file as a dense array; a symmetric matrix gets both triangles."""
    header, sizes, *lines = [line for line in file.read_text().splitlines() if line and not line.startswith("% ")]
    sizes = [int(word) for word in sizes.split()]
    if "array" in header:
        return numpy.array([float(line) for line in lines]).reshape(sizes[::-1]).T
    entries = numpy.zeros(sizes[:2])
    for line in lines:
        row, column, value = line.split()
        entries[int(row) - 1, int(column) - 1] = float(value)
        if "symmetric" in header:
            entries[int(column) - 1, int(row) - 1] = float(value)
    return entries


def load(made, file):
    viewer = PETSc.Viewer().createBinary(str(file), "r", comm=PETSc.COMM_SELF)
    made.load(viewer)
    viewer.destroy()
    # K.petsc.info sets this option for all matrices that are read afterwards.
    PETSc.Options().delValue("matload_block_size")
    return made


def mat(file, kind="aij"):
    made = PETSc.Mat().create(comm=PETSc.COMM_SELF)
    made.setType(kind)
    return load(made, file)


def vec(file):
    return load(PETSc.Vec().create(comm=PETSc.COMM_SELF), file).getArray().copy()


def dense(matrix):
    """Returns the values of a sparse matrix, and a mask of the stored entries."""
    starts, columns, values = matrix.getValuesCSR()
    found, stored = numpy.zeros(matrix.getSize()), numpy.zeros(matrix.getSize(), dtype=bool)
    for row, (start, end) in enumerate(zip(starts, starts[1:])):
        assert (numpy.diff(columns[start:end]) > 0).all(), f"row {row} is not sorted"
        found[row, columns[start:end]] = values[start:end]
        stored[row, columns[start:end]] = True
    return found, stored


class Export(unittest.TestCase):
    def exported(self, scene):
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "scene.json").write_text(json.dumps(scene))
        for form in ["matrix-market", "petsc"]:
            arguments = [PROGRAM, "export", "scene.json", form, "--format", form]
            subprocess.run(arguments, cwd=folder, check=True, capture_output=True)
        return folder / "matrix-market", folder / "petsc"

    def test_petsc_reads_the_numbers_of_the_matrix_market_files(self):
        for dimension, scene in scenes():
            with self.subTest(scene=scene.get("title", "block")):
                text, petsc = self.exported(scene)
                self.same_numbers(text, petsc, dimension)

    def same_numbers(self, text, petsc, dimension):
        free = load(PETSc.IS().create(comm=PETSc.COMM_SELF), petsc / "free.petsc").getIndices().copy()
        stiffness = mat(petsc / "K.petsc")
        self.assertEqual(stiffness.getBlockSize(), dimension)
        values, stored = dense(stiffness)
        expected = matrix_market(text / "K.mtx")
        self.assertTrue((values[numpy.ix_(free, free)] == expected).all())
        supported = numpy.setdiff1d(numpy.arange(len(values)), free)
        # The row of a supported component has only a diagonal entry, the mean of the diagonal of K.
        mean = numpy.abs(numpy.diag(expected)).mean()
        self.assertTrue(numpy.allclose(values[supported, supported], mean, rtol=1e-13, atol=0))
        own = numpy.zeros_like(stored)
        own[supported, supported] = True
        self.assertTrue((stored[supported] == own[supported]).all() and (stored[:, supported] == own[:, supported]).all())
        force = vec(petsc / "f.petsc")
        self.assertTrue((force[free] == matrix_market(text / "f.mtx")[:, 0]).all() and not force[supported].any())
        rows, touched = dense(mat(petsc / "B.petsc"))
        self.assertTrue((rows[:, free] == matrix_market(text / "B.mtx")).all() and not touched[:, supported].any())
        self.assertTrue((vec(petsc / "g.petsc") == matrix_market(text / "g.mtx")[:, 0]).all())
        modes = mat(petsc / "near_null.petsc", "dense").getDenseArray()
        self.assertTrue((modes[free] == matrix_market(text / "near_null.mtx")).all() and not modes[supported].any())
        self.at_their_nodes(petsc, free, dimension)

    def at_their_nodes(self, petsc, free, dimension):
        """Checks that the coordinates of the nodes are those of the free dofs in dofs.csv."""
        coordinates = vec(petsc / "coordinates.petsc").reshape(-1, dimension)
        lines = [line.split(",") for line in (petsc / "dofs.csv").read_text().splitlines()[1:]]
        at = numpy.array([[float(word) for word in line[3 : 3 + dimension]] for line in lines])
        self.assertTrue((coordinates[free // dimension] == at).all())
        self.assertEqual(len(numpy.unique(free // dimension)), len(coordinates))

    def test_petsc_makes_blocks_of_the_stiffness(self):
        _, petsc = self.exported(block())
        blocks, plain = mat(petsc / "K.petsc", "baij"), mat(petsc / "K.petsc")
        self.assertEqual((blocks.getType(), blocks.getBlockSize()), ("seqbaij", 3))
        vector = plain.createVecRight()
        vector.setRandom()
        difference = blocks.createVecLeft()
        (blocks * vector).copy(difference)
        difference.axpy(-1.0, plain * vector)
        self.assertLess(difference.norm(), 1e-14 * (plain * vector).norm())


if __name__ == "__main__":
    unittest.main()

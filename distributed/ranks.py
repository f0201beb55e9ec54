"""PETSc, and what the ranks of a run tell each other: a few numbers at a time."""

import ctypes
import glob
import os
import resource
import sys

# A rank is one thread: more would take the processors of its neighbours.
os.environ.setdefault("OMP_NUM_THREADS", "1")

try:
    import petsc4py
except ImportError:
    # Debian keeps petsc4py where only its development package, or PETSC_DIR, points to.
    sys.path += sorted(glob.glob("/usr/lib/petscdir/petsc*/*real/lib/python3/dist-packages"))
    try:
        import petsc4py
    except ImportError:
        print("there is no petsc4py: apt-get install python3-petsc4py, or pip install petsc4py", file=sys.stderr)
        sys.exit(2)

petsc4py.init([sys.argv[0]])

import numpy as np  # noqa: E402
from petsc4py import PETSc  # noqa: E402


class Refused(Exception):
    """What cannot be solved or read: one sentence, the same on every rank, and the exit code of the program."""

    def __init__(self, sentence, code):
        super().__init__(sentence)
        self.code = code


PETSC_INT = PETSc.IntType

LARGE_BLOCK = 1024 * 1024
"""Bytes. Blocks of memory from this size on go back to the system when they are freed."""

M_MMAP_THRESHOLD, M_MMAP_MAX = -3, -4
"""Of mallopt(3), the GNU C library."""

BAD_INPUT, USAGE, NO_ANSWER, NOT_CERTIFIED = 1, 2, 3, 4


def return_freed_memory():
    """Makes freed large blocks go back to the system.

    MPI libraries turn this off to keep pages registered with their networks. A rank would then hold the largest sum of
    everything that it ever needed: 1.8 GB in place of 1.3 GB for 405,600 of its rows.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_MMAP_MAX, 1 << 16)
        mallopt(M_MMAP_THRESHOLD, LARGE_BLOCK)


class Ranks:
    """The ranks of a run. Every call is made by all of them, and gives all of them the same numbers, bit by bit."""

    def __init__(self):
        return_freed_memory()
        self.comm = PETSc.COMM_WORLD
        self.rank, self.size = self.comm.rank, self.comm.size
        self._gathers = {}

    def gather(self, values):
        """The values of each rank, a row for each."""
        values = np.asarray(values, dtype=float).ravel()
        if self.size == 1:
            return values[None, :].copy()
        if len(values) not in self._gathers:
            own = PETSc.Vec().createMPI((len(values), None), comm=self.comm)
            scatter, every = PETSc.Scatter.toAll(own)
            self._gathers[len(values)] = own, scatter, every
        own, scatter, every = self._gathers[len(values)]
        own.array[:] = values
        scatter.scatter(own, every)
        return every.array_r.reshape(self.size, -1).copy()

    def sum(self, *values):
        """The sum over the ranks of each of the values."""
        return _unpacked(self.gather(values).sum(axis=0))

    def max(self, *values):
        """The largest of each of the values; one that is no number counts as largest."""
        return _unpacked(self.gather(values).max(axis=0))

    def min(self, *values):
        """The least of each of the values."""
        return _unpacked(self.gather(values).min(axis=0))

    def first(self, key, *values):
        """The key and values of the rank whose key is least; `None` where no rank has a finite key."""
        table = self.gather((key, *values))
        row = table[int(np.argmin(table[:, 0]))]
        return row if np.isfinite(row[0]) else None

    def peak_memory(self):
        """Bytes of main memory that the largest rank has held at most, and the sum over all ranks."""
        own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
        table = self.gather((own,))
        return int(table.max()), int(table.sum())

    def clean(self):
        """Frees the objects of PETSc that Python has let go of. PETSc keeps them until all ranks ask."""
        PETSc.garbage_cleanup(self.comm)

    def say(self, text):
        """Prints a line once."""
        if self.rank == 0:
            print(text, flush=True)


def _unpacked(numbers):
    return numbers[0] if len(numbers) == 1 else numbers


def larger(values):
    """The largest magnitude of an array, 0 of an empty one, without a copy."""
    return max(values.max(), -values.min(), 0.0) if len(values) else 0.0


def fetch(vector, places):
    """The values of a vector at places of any rank, which this rank names."""
    wanted = PETSc.IS().createGeneral(np.asarray(places, dtype=PETSC_INT), comm=PETSc.COMM_SELF)
    values = PETSc.Vec().createSeq(len(places))
    PETSc.Scatter().create(vector, wanted, values, None).scatter(vector, values)
    return values.array_r.copy()


def generic(like):
    """A vector without any order, the same for every number of ranks."""
    vector = like.duplicate()
    first = like.getOwnershipRange()[0]
    vector.array[:] = ((first + np.arange(like.getLocalSize())) * 0.618033988749895) % 1.0 - 0.5
    return vector

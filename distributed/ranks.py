"""PETSc, and the exchange of a few numbers between the ranks of a run."""

import ctypes
import glob
import os
import resource
import sys

import launch

# One thread for each rank: more threads would share the processors of other ranks.
os.environ.setdefault("OMP_NUM_THREADS", "1")

try:
    # numpy comes first: if it is missing, MPI has not been started.
    import numpy as np

    try:
        import petsc4py
    except ImportError:
        # Debian installs petsc4py in a folder that is not on the path of Python.
        sys.path += sorted(glob.glob("/usr/lib/petscdir/petsc*/*real/lib/python3/dist-packages"))
        import petsc4py
except ImportError as error:
    launch.end(f"{sys.executable} has no {error.name}: start with --ranks instead of mpirun, or {launch.INSTALL}")

petsc4py.init([sys.argv[0]])

from petsc4py import PETSc  # noqa: E402


class Refused(Exception):
    """A problem that cannot be read or solved: one sentence, the same on every rank, and the exit code of the program."""

    def __init__(self, sentence, code):
        super().__init__(sentence)
        self.code = code


PETSC_INT = PETSc.IntType

LARGE_BLOCK = 1024 * 1024
"""Bytes. A block of at least this size goes back to the system when it is freed."""

M_MMAP_THRESHOLD, M_MMAP_MAX = -3, -4
"""Parameters of mallopt(3) in the GNU C library."""

BAD_INPUT, USAGE, NO_ANSWER, NOT_CERTIFIED = 1, launch.USAGE, 3, 4


def return_freed_memory():
    """Makes freed large blocks go back to the system.

    MPI libraries turn this off, so that a rank would keep all memory that it has ever used.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_MMAP_MAX, 1 << 16)
        mallopt(M_MMAP_THRESHOLD, LARGE_BLOCK)


class Ranks:
    """The ranks of a run. All ranks make every call, and all get the same numbers, bit by bit."""

    def __init__(self):
        return_freed_memory()
        self.comm = PETSc.COMM_WORLD
        self.rank, self.size = self.comm.rank, self.comm.size
        self._gathers = {}

    def gather(self, values):
        """Returns a table with a row of values for each rank."""
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
        """Returns the sum over all ranks, for each value."""
        return _unpacked(self.gather(values).sum(axis=0))

    def max(self, *values):
        """Returns the maximum over all ranks, for each value. NaN counts as the largest."""
        return _unpacked(self.gather(values).max(axis=0))

    def min(self, *values):
        """Returns the minimum over all ranks, for each value."""
        return _unpacked(self.gather(values).min(axis=0))

    def first(self, key, *values):
        """Returns the key and values of the rank with the smallest key; `None` if no rank has a finite key."""
        table = self.gather((key, *values))
        row = table[int(np.argmin(table[:, 0]))]
        return row if np.isfinite(row[0]) else None

    def peak_memory(self):
        """Returns the peak of main memory in bytes: of the largest rank, and the sum of the peaks of all ranks."""
        own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
        table = self.gather((own,))
        return int(table.max()), int(table.sum())

    def clean(self):
        """Frees PETSc objects that Python has released. PETSc keeps them until all ranks call this."""
        PETSc.garbage_cleanup(self.comm)

    def say(self, text):
        """Prints a line once."""
        if self.rank == 0:
            print(text, flush=True)


def _unpacked(numbers):
    return numbers[0] if len(numbers) == 1 else numbers


def larger(values):
    """Returns the largest magnitude in an array, 0 if it is empty, without a copy."""
    return max(values.max(), -values.min(), 0.0) if len(values) else 0.0


def fetch(vector, places):
    """Returns the values of a vector at given places, which may belong to any rank."""
    wanted = PETSc.IS().createGeneral(np.asarray(places, dtype=PETSC_INT), comm=PETSc.COMM_SELF)
    values = PETSc.Vec().createSeq(len(places))
    PETSc.Scatter().create(vector, wanted, values, None).scatter(vector, values)
    return values.array_r.copy()


def generic(like):
    """Returns a vector of irregular numbers, the same for every number of ranks."""
    vector = like.duplicate()
    first = like.getOwnershipRange()[0]
    vector.array[:] = ((first + np.arange(like.getLocalSize())) * 0.618033988749895) % 1.0 - 0.5
    return vector

"""Answers as files: u.mtx and lambda.mtx in the order of the export, written whole or not at all."""

import json
import os
import sys

import numpy as np

from ranks import BAD_INPUT, PETSC_INT, PETSc, Refused

LONGEST_LINE = 64
"""Bytes of a line of numbers, at most."""


class Folder:
    """Files of an answer, each beside its place until all are there."""

    def __init__(self, ranks, path):
        self.ranks, self.path, self.written = ranks, path, []
        self._agree(self._made() if ranks.rank == 0 else "")

    def _made(self):
        try:
            os.makedirs(self.path, exist_ok=True)
            return ""
        except OSError as error:
            return f"{self.path}: {error.strerror}"

    def _agree(self, fault):
        """Refuses on every rank if one has a fault to tell; nothing stays of what was written."""
        has_fault = self.ranks.max(float(bool(fault)))
        if not has_fault:
            return
        self.discard()
        if fault and self.ranks.rank > 0:
            print(fault, file=sys.stderr, flush=True)
        raise Refused(fault or f"{self.path} was not written", BAD_INPUT)

    def discard(self):
        if self.ranks.rank == 0:
            for name in self.written:
                try:
                    os.remove(self._partial(name))
                except OSError:
                    pass

    def _partial(self, name):
        return os.path.join(self.path, f".{name}.partial")

    def _write(self, name, mode, text):
        try:
            with open(self._partial(name), mode) as stream:
                stream.write(text)
                stream.flush()
                os.fsync(stream.fileno())
            return ""
        except OSError as error:
            return f"{os.path.join(self.path, name)}: {error.strerror}"

    def vector(self, name, values):
        """A Matrix Market array; the ranks write their parts one after another."""
        self.written.append(name)
        head = f"%%MatrixMarket matrix array real general\n{values.getSize()} 1\n"
        for rank in range(self.ranks.size):
            fault = ""
            if rank == self.ranks.rank:
                text = "".join(f"{value!r}\n" for value in values.array_r.tolist())
                fault = self._write(name, "a" if rank else "w", ("" if rank else head) + text)
            self._agree(fault)

    def json(self, name, content):
        self.written.append(name)
        self._agree(self._write(name, "w", json.dumps(content, indent=2) + "\n") if self.ranks.rank == 0 else "")

    def finish(self):
        """Puts all files in their places."""
        fault = ""
        if self.ranks.rank == 0:
            try:
                for name in self.written:
                    os.replace(self._partial(name), os.path.join(self.path, name))
            except OSError as error:
                fault = f"{self.path}: {error.strerror}"
        self._agree(fault)


def read_vector(ranks, file, length, what):
    """A Matrix Market array of `length` numbers, shared among the ranks, each of which reads a part of the file."""
    fault, begin, end, parts = "", 0, 0, []
    try:
        with open(file, "rb") as stream:
            head = stream.readline().split()
            line = stream.readline()
            while line.startswith(b"%"):
                line = stream.readline()
            begin, end = stream.tell(), os.path.getsize(file)
            sizes = [int(word) for word in line.split()]
            if b"array" not in [word.lower() for word in head] or len(sizes) != 2 or sizes[1] != 1 or sizes[0] != length:
                fault = f"{file} is no array of {length} {what}: its sizes are {' x '.join(map(str, sizes))}"
            else:
                first, last = (begin + (end - begin) * part // ranks.size for part in (ranks.rank, ranks.rank + 1))
                parts = _lines(stream, begin, first, last)
    except (OSError, ValueError) as error:
        fault = f"{file}: {getattr(error, 'strerror', None) or error}"
    if ranks.max(float(bool(fault))):
        raise Refused(fault or f"{file} is no array of {length} {what}", BAD_INPUT)
    counts = ranks.gather((len(parts),))[:, 0]
    if counts.sum() != length:
        raise Refused(f"{file} has {int(counts.sum())} values, but its first line says {length}", BAD_INPUT)
    values = np.array(parts)
    if ranks.max(float(not np.all(np.isfinite(values)))):
        raise Refused(f"{file} holds a value that is no finite number", BAD_INPUT)
    vector = PETSc.Vec().createMPI((None, length), comm=ranks.comm)
    start = int(counts[: ranks.rank].sum())
    vector.setValues(np.arange(start, start + len(values), dtype=PETSC_INT), values)
    vector.assemble()
    return vector


def _lines(stream, begin, first, last):
    """The numbers of the lines that begin in the bytes from `first` to `last`."""
    if first >= last:
        return []
    stream.seek(first - 1)
    # A line that begins before is that of another rank.
    if first > begin and stream.read(1) != b"\n":
        stream.readline()
    elif first == begin:
        stream.seek(first)
    at = stream.tell()
    if at >= last:
        return []
    text = stream.read(last - at)
    if not text.endswith(b"\n"):
        text += stream.readline(LONGEST_LINE)
    return [float(word) for word in text.split()]

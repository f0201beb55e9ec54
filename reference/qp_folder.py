"""Reads and writes folders of quadratic programs in the forms of qpbenchmark and qpsolvers.

- `*.parquet`: `qpbenchmark.ProblemList.to_parquet`. A row is a program; its columns are P, q, G, h, A, b, lb, ub and name. A matrix is
  stored by rows as one array, and has as many columns as q has entries; what a program does not have is null.
- `*.npz`: `qpsolvers.Problem.save`. A file is a program, with the same names; its name is that of the file.

pyarrow is needed for the first form only (`pip install pyarrow`).
"""

import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from quadratic import KEYS, Program, program

MATRICES = ("P", "G", "A")

SIZE_OF_NONE = 300
"""`qpsolvers.Problem.save` stores None as an object in fewer bytes than this; a sparse matrix takes more."""


def from_arrays(name: str, arrays: dict) -> Program:
    """Returns a program from flat or shaped arrays; a name that is missing or None is no constraint."""
    n = np.size(arrays["q"])
    shaped = {}
    for key in KEYS:
        values = arrays.get(key)
        if values is not None:
            values = np.array(values, dtype=np.float64)
            shaped[key] = values.reshape(-1, n) if key in MATRICES else values.reshape(-1)
    return program(name, **shaped)


def in_parquet(file: Path) -> Iterator[Program]:
    """Yields the programs of a file of `qpbenchmark.ProblemList`."""
    import pyarrow.parquet

    for batch in pyarrow.parquet.ParquetFile(file).iter_batches(batch_size=1):
        row = {}
        for key in set(KEYS) & set(batch.schema.names):
            cell = batch.column(key)[0]
            row[key] = cell.values.to_numpy(zero_copy_only=False) if cell.is_valid else None
        yield from_arrays(str(batch.column("name")[0]), row)


def in_npz(file: Path) -> Program:
    """Returns the program of a file of `qpsolvers.Problem.save`.

    # Errors
    `ValueError` if a matrix is stored as an object, which sparse ones are: an object of a file can run any code when it is read.
    """
    sizes = {Path(member.filename).stem: member.file_size for member in zipfile.ZipFile(file).infolist()}
    row = {}
    with np.load(file, allow_pickle=False) as stored:
        for key in set(KEYS) & set(stored.files):
            try:
                row[key] = stored[key]
            except ValueError:
                if sizes[key] > SIZE_OF_NONE:
                    raise ValueError(f"{file}: {key} is stored as an object, not as an array; save it dense") from None
    return from_arrays(file.stem, row)


def in_folder(folder: Path) -> list[Program]:
    """Returns the programs of all files of a folder, in the order of their names.

    # Errors
    `ValueError` if there is no such file.
    """
    found = []
    for file in sorted(folder.iterdir()):
        if file.suffix == ".parquet":
            found += in_parquet(file)
        elif file.suffix == ".npz":
            found.append(in_npz(file))
    if not found:
        raise ValueError(f"{folder} has no file *.parquet or *.npz")
    return found


def save(problem: Program, folder: Path) -> Path:
    """Writes a program as `qpsolvers.Problem.save` does, and returns the file. What it does not have is left out."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{problem.name.replace(' ', '-')}.npz"
    np.savez_compressed(file, **{key: values for key, values in zip(KEYS, problem.data) if values is not None})
    return file

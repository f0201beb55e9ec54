"""Reads the .vtu file of a scene with meshio, and compares it with the answer of the package."""

from pathlib import Path

import meshio
import numpy as np

from program import Run
from scaling import largest

ARRAYS = {
    "u": (2, 3),
    "sigma_1": (1,),
    "sigma_2": (1,),
    "von_mises": (1,),
    "stress": (6,),
    "reaction": (2, 3),
    "contact_force": (2, 3),
    "normal": (2, 3),
    "gap": (1,),
    "remaining_gap": (1,),
    "pressure": (1,),
    "contact": (1,),
}
"""Names of the arrays, and the numbers of components that they may have."""

TEXT_TOLERANCE = 1e-6
"""Relative tolerance of the displacements in the file. Single precision or seven digits would still pass."""


def vtu_faults(folder: Path, run: Run) -> list[str]:
    """Returns one sentence for each fault of the .vtu file in `folder`."""
    files = sorted(folder.glob("*.vtu"))
    if len(files) != 1:
        return [f"{len(files)} .vtu files instead of one"]
    try:
        mesh = meshio.read(files[0])
    except Exception as error:  # meshio lets errors of XML, numpy and its own through
        return [f"{files[0].name} cannot be read: {error!r}"]
    faults = [f"{name}: {fault}" for name in ARRAYS if (fault := array_fault(mesh, name))]
    if faults:
        return faults

    points = {name: np.asarray(values, float) for name, values in mesh.point_data.items()}
    count = len(run.reported.contact_set)
    # 1 marks a closed candidate, 0 an open one, -1 a node that is not a candidate.
    closed = int(np.count_nonzero(points["contact"] == 1)) if "contact" in points else count
    if closed != count:
        faults.append(f"contact is set at {closed} points, the answer has {count}")
    if "pressure" in points and np.min(points["pressure"], initial=0.0) < 0.0:
        faults.append(f"pressure goes down to {points['pressure'].min():.3g}")
    if "u" in points:
        apart = farthest_from(points["u"].ravel(), run.answer.displacement)
        if apart > TEXT_TOLERANCE * largest(run.answer.displacement):
            faults.append(f"the answer has displacements that are not in the file, the farthest by {apart:.1e}")
    return faults


def farthest_from(written: np.ndarray, solved: np.ndarray) -> float:
    """Returns the largest distance of an entry of `solved` from the nearest entry of `written`, in any order."""
    # The file contains the supported dofs as well, and orders its nodes differently.
    ordered = np.sort(written)
    right = np.clip(np.searchsorted(ordered, solved), 1, ordered.size - 1)
    return largest(np.minimum(np.abs(solved - ordered[right - 1]), np.abs(solved - ordered[right])))


def array_fault(mesh: meshio.Mesh, name: str) -> str:
    """Returns the fault of an array over the points or the cells; an empty text if there is none."""
    if name in mesh.point_data:
        values, length = np.asarray(mesh.point_data[name], float), len(mesh.points)
    elif name in mesh.cell_data:
        values = np.concatenate([np.asarray(block, float) for block in mesh.cell_data[name]])
        length = sum(len(block.data) for block in mesh.cells)
    else:
        return f"missing; there are {sorted(mesh.point_data)} and {sorted(mesh.cell_data)}"
    if len(values) != length:
        return f"length {len(values)} instead of {length}"
    if values.size // max(length, 1) not in ARRAYS[name]:
        return f"{values.size // max(length, 1)} components"
    if not np.all(np.isfinite(values)):
        return f"{np.count_nonzero(~np.isfinite(values))} values are not finite"
    return ""

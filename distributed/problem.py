"""The problem: minimise 1/2 u'Ku - f'u with B u - g <= 0, each rank its rows, read from a folder of `signorini export`.

Every node has D places, one for each component. A supported component keeps its place: its row of K has a diagonal entry
only. `free` lists the places of the free dofs, in the order of the export.
"""

import csv
import os

import numpy as np

from ranks import BAD_INPUT, PETSC_INT, PETSc, Refused, generic

NO_LIMIT = 1e20
"""A gap of this value or more is no limit."""

MAT, VEC, INDEX_SET = 1211216, 1211214, 1211218
"""First number of PETSc's binary files, by kind."""

DEPENDENT = 1e-8
"""A near-null vector depends on those before it if orthogonalisation leaves less than this share of it."""

SYMMETRY = 1e-9
"""Largest rounding error of v'Kw - w'Kv, relative to the lengths of the vectors."""

LONGEST = 1e12
"""Coordinates beyond this value leave no digits for a rotation."""


class Problem:
    """K, f and B on the places of the nodes, and g on the contact rows. Each rank owns a run of nodes and a run of rows."""

    def __init__(self, ranks, dimension, stiffness, load, contact, gap, free, modes):
        self.ranks, self.dimension = ranks, dimension
        self.stiffness, self.load, self.contact, self.gap = stiffness, load, contact, gap
        self.free = free
        """Index set: the places of the free dofs, in the order of u.mtx."""
        self.modes = modes
        """Vectors: displacements with next to no energy (rigid body modes)."""
        self.parts = None
        """The sets of nodes that K couples; found when they are first needed."""
        self.first, self.last = stiffness.getOwnershipRange()
        self.is_free = np.zeros(self.last - self.first, dtype=bool)
        mark = load.duplicate()
        mark.zeroEntries()
        places = free.getIndices()
        mark.setValues(places, np.ones(len(places)))
        mark.assemble()
        self.is_free[:] = mark.array_r > 0.0
        self._check_values()
        self._check_symmetry()

    @property
    def dofs(self):
        return self.free.getSize()

    @property
    def rows(self):
        return self.gap.getSize()

    def _check_values(self):
        diagonal = self.stiffness.getDiagonal().array_r
        for name, values, is_bad in (
            ("f", self.load.array_r, ~np.isfinite(self.load.array_r)),
            ("g", self.gap.array_r, np.isnan(self.gap.array_r) | (self.gap.array_r == -np.inf)),
            ("the diagonal of K", diagonal, ~(np.isfinite(diagonal) & (diagonal > 0.0))),
        ):
            offset = {"g": self.gap.getOwnershipRange()[0]}.get(name, self.first)
            bad = np.flatnonzero(is_bad)
            key = (offset + bad[0], values[bad[0]]) if len(bad) else (np.inf, 0.0)
            found = self.ranks.first(*key)
            if found is not None:
                allowed = "positive" if name.startswith("the") else "a number"
                raise Refused(f"{name} has {found[1]:g} in place {int(found[0])} (from 0); it must be {allowed}", BAD_INPUT)

    def _check_symmetry(self):
        """Compares v'Kw with w'Kv for two generic vectors."""
        one, other, moved = generic(self.load), generic(self.load), self.load.duplicate()
        other.array[:] = np.cos(1e3 * one.array_r)
        self.stiffness.mult(one, moved)
        there, scale = other.dot(moved), other.norm() * moved.norm()
        self.stiffness.mult(other, moved)
        back, scale = one.dot(moved), scale + one.norm() * moved.norm()
        if not abs(there - back) <= SYMMETRY * scale:
            raise Refused("K is not symmetric, or has an entry that is no number", BAD_INPUT)

    def on_free(self, vector):
        """Returns the values of the free dofs, in the order of the export."""
        values = PETSc.Vec().createMPI((self.free.getLocalSize(), self.dofs), comm=self.ranks.comm)
        PETSc.Scatter().create(vector, self.free, values, None).scatter(vector, values)
        return values

    def on_places(self, values):
        """The inverse of `on_free`: zero at supported components."""
        vector = self.load.duplicate()
        vector.zeroEntries()
        mode = PETSc.ScatterMode.REVERSE
        PETSc.Scatter().create(vector, self.free, values, None).scatter(values, vector, mode=mode)
        return vector


def in_rows(matrix):
    """Returns the matrix in PETSc's format AIJ, which multigrid and products of matrices need."""
    return matrix.convert("aij", PETSc.Mat()) if "baij" in matrix.getType() else matrix


def read(ranks, folder):
    """Returns the problem of a folder, in either format.

    Raises `Refused` for files that are missing, cut off or do not fit each other.
    """
    if os.path.exists(os.path.join(folder, "K.petsc")):
        return _read_binary(ranks, folder)
    if os.path.exists(os.path.join(folder, "K.mtx")):
        return _read_text(ranks, folder)
    raise Refused(f"{folder} holds neither K.petsc nor K.mtx: signorini export writes them", BAD_INPUT)


def _header(folder, name, classid, numbers):
    """Returns the integers after the class number of a binary file. Refuses a file of another kind or one that is cut off."""
    file = os.path.join(folder, name)
    try:
        with open(file, "rb") as stream:
            head = np.frombuffer(stream.read(4 * (1 + numbers)), dtype=">i4")
        size = os.path.getsize(file)
    except OSError as error:
        raise Refused(f"{file}: {error.strerror}", BAD_INPUT) from None
    if len(head) < 1 + numbers or head[0] != classid:
        found = head[0] if len(head) else "nothing"
        raise Refused(f"{file} begins with {found}, but a PETSc file of its kind begins with {classid}", BAD_INPUT)
    counts = [int(count) for count in head[1:]]
    if classid == MAT:
        rows, columns, entries = counts
        needed = 16 + 4 * rows + 12 * entries if entries < 2**31 - 1 else 0
        # A dense matrix has a negative number in place of its count of entries.
        needed = 16 + 8 * rows * columns if entries < 0 else needed
    else:
        needed = 8 + (8 if classid == VEC else 4) * counts[0]
    if size < needed:
        raise Refused(f"{file} is cut off: it has {size} bytes and needs {needed}", BAD_INPUT)
    return counts


def _block_size(folder):
    file = os.path.join(folder, "K.petsc.info")
    try:
        with open(file) as stream:
            words = stream.read().split()
        return int(words[words.index("-matload_block_size") + 1])
    except (OSError, ValueError, IndexError):
        raise Refused(f"{file} must hold the line -matload_block_size 2, or 3", BAD_INPUT) from None


def _read_binary(ranks, folder):
    if os.path.exists(os.path.join(folder, "E.petsc")):
        raise Refused(f"{folder} has equality rows (E.petsc), which need a factor; signorini solve takes them", BAD_INPUT)
    dimension = _block_size(folder)
    places, columns, _ = _header(folder, "K.petsc", MAT, 3)
    rows, of_contact, _ = _header(folder, "B.petsc", MAT, 3)
    for name, expected in (("f.petsc", places), ("coordinates.petsc", places), ("g.petsc", rows)):
        (length,) = _header(folder, name, VEC, 1)
        if length != expected:
            raise Refused(f"{name} has length {length}, but K and B ask for {expected}", BAD_INPUT)
    (dofs,) = _header(folder, "free.petsc", INDEX_SET, 1)
    if places != columns or places % max(dimension, 1) or dimension not in (2, 3) or of_contact != places or dofs > places:
        found = f"K is {places} x {columns} in blocks of {dimension}, B has {of_contact} columns, free.petsc {dofs} dofs"
        raise Refused(f"{folder}: {found}, which do not fit", BAD_INPUT)
    # The block size of K must not be taken for that of B.
    PETSc.Options()["viewer_binary_skip_info"] = ""

    def loaded(kind, name):
        return kind.load(PETSc.Viewer().createBinary(os.path.join(folder, name), "r", comm=ranks.comm))

    # Products with K in blocks take half the time of those in rows. By MPI-IO each rank reads its own rows.
    stiffness = PETSc.Mat().create(comm=ranks.comm)
    stiffness.setType("baij")
    stiffness.setBlockSize(dimension)
    stiffness.load(PETSc.Viewer().createMPIIO(os.path.join(folder, "K.petsc"), "r", comm=ranks.comm))
    own = stiffness.getLocalSize()[0]
    contact = PETSc.Mat().create(comm=ranks.comm)
    contact.setType("aij")
    contact.setSizes(((None, rows), (own, places)))
    loaded(contact, "B.petsc")

    def vector(name, local, length):
        values = PETSc.Vec().create(comm=ranks.comm)
        values.setSizes((local, length))
        values.setType("mpi" if ranks.size > 1 else "seq")
        return loaded(values, name)

    load = vector("f.petsc", own, places)
    gap = vector("g.petsc", contact.getLocalSize()[0], rows)
    free = loaded(PETSc.IS().create(comm=ranks.comm), "free.petsc")
    _check_places(ranks, free.getIndices(), places)
    problem = Problem(ranks, dimension, stiffness, load, contact, gap, free, None)
    if os.path.exists(os.path.join(folder, "near_null.petsc")):
        problem.modes = _near_null(problem, folder, loaded)
    else:
        problem.modes = rigid_body_modes(problem, vector("coordinates.petsc", own, places))
    return problem


def _near_null(problem, folder, loaded):
    """Returns the columns of near_null.petsc, a dense matrix."""
    places, count, _ = _header(folder, "near_null.petsc", MAT, 3)
    if places != problem.stiffness.getSize()[0] or count < 1:
        raise Refused(f"near_null.petsc is {places} x {count}, but K has {problem.stiffness.getSize()[0]} rows", BAD_INPUT)
    table = PETSc.Mat().create(comm=problem.ranks.comm)
    table.setType("dense")
    table.setSizes(((problem.last - problem.first, places), (None, count)))
    loaded(table, "near_null.petsc")
    columns = table.getDenseArray()
    if problem.ranks.max(float(not np.all(np.isfinite(columns)))):
        raise Refused("near_null.petsc holds a value that is no finite number", BAD_INPUT)
    return [_vector_like(problem.load, column * problem.is_free) for column in columns.T]


def _check_places(ranks, free, places):
    bad = free[(free < 0) | (free >= places)]
    found = ranks.first(*((0.0, bad[0]) if len(bad) else (np.inf, 0)))
    if found is not None:
        raise Refused(f"free.petsc names place {int(found[1])}, but there are {places} (from 0)", BAD_INPUT)


def rigid_body_modes(problem, coordinates):
    """Returns translations and rotations, zero at supported components."""
    ranks, size = problem.ranks, problem.dimension
    at = coordinates.array_r.reshape(-1, size)
    nodes = max(coordinates.getSize() // size, 1)
    bad = np.flatnonzero(~(np.abs(at) < LONGEST))
    found = ranks.first(*((problem.first + bad[0], at.ravel()[bad[0]]) if len(bad) else (np.inf, 0.0)))
    if found is not None:
        raise Refused(f"coordinates.petsc has {found[1]:g} in place {int(found[0])} (from 0); it must be a length", BAD_INPUT)
    centre = np.atleast_1d(ranks.sum(*at.sum(axis=0))) / nodes
    at = at - centre
    modes = []
    for axis in range(size):
        mode = np.zeros_like(at)
        mode[:, axis] = 1.0
        modes.append(mode)
    for one in range(size):
        for other in range(one + 1, size):
            mode = np.zeros_like(at)
            mode[:, one], mode[:, other] = -at[:, other], at[:, one]
            modes.append(mode)
    return [_vector_like(problem.load, mode.ravel() * problem.is_free) for mode in modes]


def _vector_like(like, values):
    vector = like.duplicate()
    vector.array[:] = values
    return vector


def orthonormal(modes):
    """Returns an orthonormal basis of the modes."""
    kept = []
    for mode in modes:
        rest, whole = mode.copy(), mode.norm()
        for _ in range(2):
            for before in kept:
                rest.axpy(-rest.dot(before), before)
        if rest.norm() > DEPENDENT * whole and whole > 0.0:
            rest.normalize()
            kept.append(rest)
    if not kept:
        raise Refused("the near-null space is zero: it must hold a displacement of the free dofs with little energy", BAD_INPUT)
    return kept


def _text(folder, name, is_needed=True):
    """Returns sizes and entries of a Matrix Market file: triplets (from 0, both triangles) of a matrix, a table of an array."""
    file = os.path.join(folder, name)
    try:
        with open(file) as stream:
            head = stream.readline().lower().split()
            line = stream.readline()
            while line.startswith("%"):
                line = stream.readline()
            sizes = [int(word) for word in line.split()]
            numbers = np.array(stream.read().split(), dtype=float)
    except FileNotFoundError:
        if not is_needed:
            return None, None
        raise Refused(f"{file}: there is no such file", BAD_INPUT) from None
    except (OSError, ValueError) as error:
        raise Refused(f"{file} is no Matrix Market file: {error}", BAD_INPUT) from None
    if "array" in head:
        if len(sizes) != 2 or len(numbers) != sizes[0] * sizes[1]:
            raise Refused(f"{file} has {len(numbers)} values, which do not fill what its first line says", BAD_INPUT)
        return sizes, numbers.reshape(sizes[1], sizes[0]).T
    if len(sizes) != 3 or len(numbers) != 3 * sizes[2]:
        raise Refused(f"{file} has {len(numbers)} numbers, but its first line says {sizes} entries", BAD_INPUT)
    numbers = numbers.reshape(-1, 3)
    i, j, v = numbers[:, 0].astype(int) - 1, numbers[:, 1].astype(int) - 1, numbers[:, 2]
    if "symmetric" in head:
        off = i != j
        i, j, v = np.r_[i, j[off]], np.r_[j, i[off]], np.r_[v, v[off]]
    return sizes[:2], (i, j, v)


def _places(folder, dofs):
    """Returns the place of each dof, the number of components and the coordinates of the nodes, from dofs.csv."""
    file = os.path.join(folder, "dofs.csv")
    try:
        with open(file, newline="") as stream:
            lines = list(csv.DictReader(stream))
    except OSError as error:
        raise Refused(f"{file}: {error.strerror}; it lists the node of each dof", BAD_INPUT) from None
    if len(lines) != dofs:
        raise Refused(f"{file} has {len(lines)} dofs, but K.mtx has {dofs}", BAD_INPUT)
    directions = np.array([[float(line["direction_" + axis] or 0.0) for axis in "xyz"] for line in lines]).reshape(-1, 3)
    dimension = 3 if np.any(directions[:, 2]) else 2
    node_of, taken, places, coordinates = {}, {}, np.empty(dofs, dtype=int), []
    for dof, line in enumerate(lines):
        if line["quantity"] != "displacement" or not line["of"].startswith("node"):
            raise Refused(f"dof {dof} (from 0) is a {line['quantity']} of {line['of']}: distributed solves take dofs of "
                          "nodes alone", BAD_INPUT)
        node = node_of.setdefault(line["of"], len(node_of))
        if node == len(coordinates):
            coordinates.append([float(line[axis]) for axis in "xyz"[:dimension]])
        free = [c for c in range(dimension) if (node, c) not in taken]
        component = max(free, key=lambda c: abs(directions[dof, c]), default=None)
        if component is None:
            raise Refused(f"{file}: {line['of']} has more than {dimension} dofs", BAD_INPUT)
        taken[node, component] = dof
        places[dof] = dimension * node + component
    return places, dimension, np.array(coordinates).reshape(-1, dimension)


def _read_text(ranks, folder):
    """Reads Matrix Market files, for small problems: every rank reads all and keeps its rows."""
    (dofs, columns), (i, j, v) = _text(folder, "K.mtx")
    _, load = _text(folder, "f.mtx")
    (rows, of_contact), (row, dof, b) = _text(folder, "B.mtx")
    _, gap = _text(folder, "g.mtx")
    if dofs != columns or load.size != dofs or of_contact != dofs or gap.size != rows:
        raise Refused(f"{folder}: K is {dofs} x {columns}, f has {load.size} values, B is {rows} x {of_contact}, g has "
                      f"{gap.size}, which do not fit", BAD_INPUT)
    places, dimension, coordinates = _places(folder, dofs)
    _, near_null = _text(folder, "near_null.mtx", is_needed=False)
    total = coordinates.size
    held = np.setdiff1d(np.arange(total), places)
    mean = v[i == j].mean() if len(v) else 1.0
    i, j, v = np.r_[places[i], held], np.r_[places[j], held], np.r_[v, np.full(len(held), mean)]

    # Each rank gets whole nodes, as PETSc distributes them.
    layout = PETSc.Vec().create(comm=ranks.comm)
    layout.setSizes((None, total), bsize=dimension)
    layout.setUp()
    first, last = layout.getOwnershipRange()

    def matrix(sizes, range_of_rows, i, j, v):
        own = (i >= range_of_rows[0]) & (i < range_of_rows[1])
        i, j, v = i[own] - range_of_rows[0], j[own], v[own]
        order = np.lexsort((j, i))
        starts = np.r_[0, np.cumsum(np.bincount(i, minlength=range_of_rows[1] - range_of_rows[0]))]
        made = PETSc.Mat().create(comm=ranks.comm)
        made.setSizes(sizes)
        made.setType("aij")
        made.setPreallocationCSR((starts.astype(PETSC_INT), j[order].astype(PETSC_INT), v[order]))
        made.assemble()
        return made

    own = last - first
    stiffness = matrix(((own, total), (own, total)), (first, last), i, j, v)
    stiffness.setBlockSize(dimension)
    gaps = PETSc.Vec().createMPI((None, rows), comm=ranks.comm)
    gaps.array[:] = gap.ravel()[slice(*gaps.getOwnershipRange())]
    sizes = ((gaps.getLocalSize(), rows), (own, total))
    contact = matrix(sizes, gaps.getOwnershipRange(), row, places[dof], b)
    loads = stiffness.createVecLeft()
    whole = np.zeros(total)
    whole[places] = load.ravel()
    loads.array[:] = whole[first:last]
    number = PETSc.Vec().createMPI((None, dofs), comm=ranks.comm)
    part = places[slice(*number.getOwnershipRange())].astype(PETSC_INT)
    free = PETSc.IS().createGeneral(part, comm=ranks.comm)
    problem = Problem(ranks, dimension, stiffness, loads, contact, gaps, free, None)
    if near_null is None:
        at = loads.duplicate()
        at.array[:] = coordinates.ravel()[first:last]
        problem.modes = rigid_body_modes(problem, at)
    else:
        if near_null.shape[0] != dofs or not np.all(np.isfinite(near_null)):
            raise Refused(f"near_null.mtx must have {dofs} rows of numbers, one for each dof", BAD_INPUT)
        spread = np.zeros((total, near_null.shape[1]))
        spread[places] = near_null
        problem.modes = [_vector_like(loads, column) for column in spread[first:last].T]
    return problem

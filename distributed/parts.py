"""The parts of a problem: sets of nodes that K couples, directly or through other nodes. Uncoupled bodies are different parts.

Each part is judged in its own scale. Otherwise the energy of a stiff body would hide any error in a soft one.
"""

import numpy as np

from ranks import fetch


class Parts:
    """The part of each place of this rank, and sums and maxima over each part."""

    def __init__(self, problem, starts, columns):
        """`starts` and `columns` are those of this rank's rows of K, in compressed rows."""
        self.ranks, size = problem.ranks, problem.dimension
        first = problem.first // size
        count = (problem.last - problem.first) // size
        nodes, others = neighbours(starts, columns, size, "baij" in problem.stiffness.getType())
        own = (others >= first) & (others < first + count)
        label = first + components(count, nodes[own], others[own] - first)
        label = self._joined(problem, label, label[nodes[~own]], others[~own])
        # Nodes without free dofs carry no energy and no force: they need no part of their own.
        has_dofs = problem.is_free.reshape(-1, size).any(axis=1)
        roots = np.unique(self._gathered(np.unique(label[has_dofs])))
        self.count = max(len(roots), 1)
        part = np.where(has_dofs, np.searchsorted(roots, label), 0)
        self.of_place = np.repeat(part, size)

    def _joined(self, problem, label, own, others):
        """The labels after nodes of other ranks have joined components of this rank: pairs of `own` labels and nodes."""
        labels = problem.load.duplicate()
        labels.array[:] = np.repeat(label, problem.dimension)
        pairs = np.unique(np.stack((own, others)), axis=1)
        theirs = fetch(labels, pairs[1] * problem.dimension).astype(np.int64)
        pairs = np.unique(np.stack((pairs[0], theirs)), axis=1)
        pairs = np.stack([self._gathered(side) for side in pairs])
        names, ends = np.unique(pairs, return_inverse=True)
        if len(names) == 0:
            return label
        one, other = ends.reshape(2, -1)
        one, other = np.r_[one, other], np.r_[other, one]
        order = np.argsort(one, kind="stable")
        joined = names[components(len(names), one[order], other[order])]
        at = np.minimum(np.searchsorted(names, label), len(names) - 1)
        return np.where(names[at] == label, joined[at], label)

    def _gathered(self, values):
        """The integers of all ranks, on every rank."""
        longest = int(self.ranks.max(float(len(values))))
        table = np.full(longest, -1.0)
        table[: len(values)] = values
        every = self.ranks.gather(table).ravel()
        return every[every >= 0.0].astype(np.int64)

    def of_rows(self, problem):
        """The part of each contact row of this rank; 0 for a row without entries."""
        part = problem.load.duplicate()
        part.array[:] = self.of_place
        starts, columns, values = problem.contact.getValuesCSR()
        entries = np.flatnonzero(values != 0.0)
        found = np.zeros(len(starts) - 1, dtype=np.int64)
        row_of = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        found[row_of[entries]] = fetch(part, columns[entries])
        return found

    def sums(self, *pairs):
        """For each pair of values and their parts: the sums of the values over each part, on all ranks."""
        own = [np.bincount(part, weights=values, minlength=self.count) for values, part in pairs]
        return self.ranks.gather(np.concatenate(own)).sum(axis=0).reshape(len(pairs), self.count)

    def largest(self, values, part):
        """The largest magnitude in each part, over all ranks; 0 for a part without values."""
        own = np.zeros(self.count)
        np.maximum.at(own, part, np.abs(values))
        return self.ranks.gather(own).max(axis=0)


def neighbours(starts, columns, size, is_blocked):
    """The edges of the graph of nodes, of `size` rows each. If K is stored in blocks, one row of a node has them all."""
    if not is_blocked:
        return np.repeat(np.arange((len(starts) - 1) // size), np.diff(starts[::size])), columns // size
    lengths = np.diff(starts)[::size] // size
    ends = np.cumsum(lengths)
    entry = size * np.arange(lengths.sum()) + np.repeat(starts[:-1:size] - size * (ends - lengths), lengths)
    return np.repeat(np.arange(len(lengths)), lengths), columns[entry] // size


def components(count, nodes, others):
    """For each of `count` nodes, the smallest node of its connected component.

    Each edge is listed in both directions, in ascending order of `nodes`.
    """
    label = np.arange(count)
    starts = np.flatnonzero(np.diff(nodes, prepend=-1))
    linked = nodes[starts]
    while True:
        smallest = label.copy()
        if len(linked):
            smallest[linked] = np.minimum(label[linked], np.minimum.reduceat(label[others], starts))
        # Whole trees move to the smaller root, then all nodes point to their root.
        root = label.copy()
        np.minimum.at(root, label, smallest)
        root = np.minimum(root, smallest)
        while True:
            above = root[root]
            if np.array_equal(above, root):
                break
            root = above
        if np.array_equal(root, label):
            return label
        label = root

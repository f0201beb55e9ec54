"""Finds where the displaced surface of one body lies in another body, from nodes and elements alone, by winding numbers."""

import numpy as np

FACES = {
    "triangle": [(0, 1), (1, 2), (2, 0)],
    "quad": [(0, 1), (1, 2), (2, 3), (3, 0)],
    "triangle6": [(0, 1, 3), (1, 2, 4), (2, 0, 5)],
    "quad8": [(0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7)],
    "tetra": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
    "tetra10": [(0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (2, 0, 3, 6, 7, 9)],
    "hexahedron": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
    "hexahedron20": [(0, 3, 2, 1, 11, 10, 9, 8), (4, 5, 6, 7, 12, 13, 14, 15), (0, 1, 5, 4, 8, 17, 12, 16),
                     (1, 2, 6, 5, 9, 18, 13, 17), (2, 3, 7, 6, 10, 19, 14, 18), (3, 0, 4, 7, 11, 16, 15, 19)],
}
"""Outward faces of an element, in the order of VTK: corners first."""

DIVISIONS = {True: 4, False: 2}
"""Straight pieces along an edge in the plane, and along one of a curved face in space."""

SAMPLES = {True: 6, False: 3}
"""Sampled points along such an edge."""


def functions(count, s, t=None):
    """Returns the shape functions of a face with `count` nodes, one row for each point."""
    if count == 2:
        return np.stack([1 - s, s], axis=1)
    if count == 3 and t is None:
        return np.stack([(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)], axis=1)
    if count in (3, 6):
        a, b, c = 1 - s - t, s, t
        if count == 3:
            return np.stack([a, b, c], axis=1)
        return np.stack([a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a], axis=1)
    corners = [(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t]
    if count == 4:
        return np.stack(corners, axis=1)
    x, y = 2 * s - 1, 2 * t - 1
    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ends = [(1 + i * x) * (1 + j * y) * (i * x + j * y - 1) / 4 for i, j in signs]
    sides = [(1 - x * x) * (1 - y) / 2, (1 + x) * (1 - y * y) / 2, (1 - x * x) * (1 + y) / 2, (1 - x) * (1 - y * y) / 2]
    return np.stack(ends + sides, axis=1)


def lattice(count, is_edge):
    """Returns points of a face, its straight pieces between them, and the points that are sampled."""
    n = 1 if count == 2 or (count == 3 and not is_edge) else DIVISIONS[is_edge]
    m = SAMPLES[is_edge]
    steps = np.linspace(0, 1, n + 1)
    if is_edge:
        inner = (np.arange(m) + 0.5) / m
        return functions(count, steps), np.array([(i, i + 1) for i in range(n)]), functions(count, inner)
    if count in (3, 6):
        grid = [(i, j) for j in range(n + 1) for i in range(n + 1 - j)]
        number = {at: index for index, at in enumerate(grid)}
        pieces = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in grid if i + j < n]
        pieces += [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in grid if i + j < n - 1]
        inner = np.array([((i + 1 / 3) / m, (j + 1 / 3) / m) for i in range(m) for j in range(m - i)])
    else:
        grid = [(i, j) for j in range(n + 1) for i in range(n + 1)]
        number = {at: index for index, at in enumerate(grid)}
        pieces = []
        for i in range(n):
            for j in range(n):
                a, b, c, d = number[i, j], number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]
                pieces += [(a, b, c), (a, c, d)]
        inner = np.array([((i + 0.5) / m, (j + 0.5) / m) for i in range(m) for j in range(m)])
    at = np.array(grid) / n
    return functions(count, at[:, 0], at[:, 1]), np.array(pieces), functions(count, inner[:, 0], inner[:, 1])


def surface(kind, elements):
    """Returns the faces that belong to one element only."""
    faces = np.concatenate([elements[:, list(face)] for face in FACES[kind]])
    corners = {2: 2, 3: 2 if kind.startswith(("tri", "quad")) else 3, 4: 4, 6: 3, 8: 4}[faces.shape[1]]
    _, first, count = np.unique(np.sort(faces[:, :corners], axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def winding(points, corners):
    """Returns how often a closed surface of straight pieces runs around each point."""
    away = [corners[None, :, place] - points[:, None] for place in range(corners.shape[1])]
    if corners.shape[1] == 2:
        (a, b), (c, d) = np.moveaxis(away[0][..., :2], -1, 0), np.moveaxis(away[1][..., :2], -1, 0)
        return np.arctan2(a * d - b * c, a * c + b * d).sum(axis=1) / (2 * np.pi)
    lengths = [np.linalg.norm(way, axis=2) for way in away]
    volume = np.einsum("pqx,pqx->pq", away[0], np.cross(away[1], away[2]))
    dots = [np.einsum("pqx,pqx->pq", away[i], away[j]) for i, j in ((0, 1), (0, 2), (1, 2))]
    below = lengths[0] * lengths[1] * lengths[2] + dots[0] * lengths[2] + dots[1] * lengths[1] + dots[2] * lengths[0]
    return 2 * np.arctan2(volume, below).sum(axis=1) / (4 * np.pi)


def distances(points, corners):
    """Returns the distance of each point from the nearest straight piece, and the number of that piece."""
    best = np.full((len(points), len(corners)), np.inf)
    edges = [(0, 1)] if corners.shape[1] == 2 else [(0, 1), (1, 2), (2, 0)]
    for i, j in edges:
        start, way = corners[None, :, i], (corners[:, j] - corners[:, i])[None]
        share = np.clip(((points[:, None] - start) * way).sum(2) / (way * way).sum(2), 0, 1)
        best = np.minimum(best, np.linalg.norm(points[:, None] - start - share[..., None] * way, axis=2))
    if corners.shape[1] == 3:
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        normal = np.cross(a, b)
        square = (normal * normal).sum(1)
        away = points[:, None] - corners[None, :, 0]
        s = np.einsum("pqx,qx->pq", away, np.cross(b, normal)) / square
        t = np.einsum("pqx,qx->pq", away, np.cross(normal, a)) / square
        height = np.abs(np.einsum("pqx,qx->pq", away, normal)) / np.sqrt(square)
        best = np.where((s >= 0) & (t >= 0) & (s + t <= 1), height, best)
    return best.min(axis=1), best.argmin(axis=1)


def in_boxes(points, boxes):
    """Returns which points lie in the box of an element: others are outside of the body."""
    low, high = boxes
    inside = np.zeros(len(points), dtype=bool)
    for start in range(0, len(points), 1000):
        part = points[start:start + 1000, None]
        inside[start:start + 1000] = ((part >= low) & (part <= high)).all(axis=2).any(axis=1)
    return inside


def deepest(kind, elements, owners, places):
    """Returns the largest depth of a point of one body in another one, over the larger facet there, and the place."""
    is_edge, worst, where = kind.startswith(("tri", "quad")), 0.0, np.zeros(3)
    bodies = []
    for body in np.unique(owners):
        faces = surface(kind, elements[owners == body])
        values, pieces, samples = lattice(faces.shape[1], is_edge)
        on_grid, sampled = (np.einsum("gn,fnx->fgx", shape, places[faces]) for shape in (values, samples))
        corners = on_grid[:, pieces].reshape(-1, pieces.shape[1], 3)
        size = np.ptp(places[faces], axis=1).max(axis=1)
        own = places[elements[owners == body]]
        # A curved side leaves the box of its nodes by less than an eighth of it.
        low, high, margin = own.min(axis=1), own.max(axis=1), np.ptp(own, axis=1) / 8
        boxes = (low - margin, high + margin)
        bodies.append((boxes, corners, np.repeat(size, len(pieces)), sampled.reshape(-1, 3), np.repeat(size, len(samples))))
    for own in bodies:
        for other in bodies:
            if own is other:
                continue
            boxes, corners, piece_size, (points, size) = other[0], other[1], other[2], own[3:]
            boxed = in_boxes(points, boxes)
            points, size = points[boxed], size[boxed]
            for start in range(0, len(points), 200):
                part, sizes = points[start:start + 200], size[start:start + 200]
                inside = winding(part, corners) > 0.5
                if not inside.any():
                    continue
                depth, piece = distances(part[inside], corners)
                share = depth / np.maximum(sizes[inside], piece_size[piece])
                if share.max() > worst:
                    worst, where = share.max(), part[inside][share.argmax()]
    return worst, where

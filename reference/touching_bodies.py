"""Draws random pairs of bodies that touch, meshes each with Gmsh, and writes the scene of both.

A kind of pair is a function of a `Draw`: it returns the shapes of both bodies, the lower one first. The vertical axis is y in the plane
and z in space. What holds a body has a name: `held`.
"""

import json
import math
import pathlib
import random
from dataclasses import dataclass, field

import gmsh

occ = gmsh.model.occ

ELEMENTS = {2: ("t3", "q4", "t6", "q8"), 3: ("tet4", "tet10", "hex8", "hex20")}
QUADRATIC = ("t6", "q8", "tet10", "hex20")
BRICKS = ("hex8", "hex20")


@dataclass
class Draw:
    """The random numbers of a pair, and what its kind decides."""

    random: random.Random
    dimension: int
    element: str
    gap: float = 0.0
    """The distance of both bodies: negative if they overlap."""
    held: list = field(default_factory=lambda: ["low", "high"])
    """Which sides hold the lower and the upper body: `low`, `high`, or a condition on the box of a side."""
    shared: bool = False
    """Both bodies share the nodes of their common side."""

    def between(self, low, high):
        return self.random.uniform(low, high)

    def slab(self, low, high):
        """A rectangle or a box from (x, z) to (x, z); in space it is as deep as it is wide at most."""
        (a, c), (b, d) = low, high
        if self.dimension == 2:
            return (2, occ.addRectangle(a, c, 0, b - a, d - c))
        depth = min(b - a, 1.0)
        return (3, occ.addBox(a, -depth / 2, c, b - a, depth, d - c))

    def round(self, x, z, radius):
        return (2, occ.addDisk(x, z, 0, radius, radius)) if self.dimension == 2 else (3, occ.addSphere(x, 0, z, radius))

    def bar(self, x, z, radius):
        """A disc, or a cylinder across the plane of x and z."""
        if self.dimension == 2:
            return self.round(x, z, radius)
        return (3, occ.addCylinder(x, -0.4, z, 0, 0.8, 0, radius))

    def turn(self, shape, angle, x=0.0, z=0.0):
        centre, axis = ((x, z, 0), (0, 0, 1)) if self.dimension == 2 else ((x, 0, z), (0, 1, 0))
        occ.rotate([shape], *centre, *axis, angle)
        return shape


def cut(shape, *tools):
    return occ.cut([shape], list(tools))[0][0]


def joined(shape, *others):
    return occ.fuse([shape], list(others))[0][0]


def blocks(draw):
    """A block beside or on another one, narrower, wider or shifted."""
    shift, width, height = draw.between(-0.7, 0.7), draw.between(0.3, 1.5), draw.between(0.3, 1)
    return draw.slab((-0.5, -1), (0.5, 0)), draw.slab((shift - width / 2, draw.gap), (shift + width / 2, draw.gap + height))


def rounds(draw):
    """A round body on a block, or on another round one."""
    radius, shift = draw.between(0.3, 2), draw.between(-0.3, 0.3)
    place = radius + draw.gap
    upper = occ.intersect([draw.round(shift, place, radius)], [draw.slab((shift - 2, -1), (shift + 2, place))])[0][0]
    if draw.random.random() < 0.5 or draw.dimension == 3:
        return draw.slab((-0.5, -1), (0.5, 0)), upper
    lower = occ.intersect([draw.round(0, -1, 1)], [draw.slab((-2, -1), (2, 1))])[0][0]
    return lower, upper


def plate(draw):
    """A thin plate on a block, or on two feet."""
    thickness = draw.between(0.02, 0.06)
    upper = draw.slab((-0.6, draw.gap), (draw.between(0.4, 1), draw.gap + thickness))
    lower = draw.slab((-0.5, -0.5), (0.5, 0))
    return (cut(lower, draw.slab((-0.2, -0.2), (0.2, 0.5))) if draw.random.random() < 0.5 else lower), upper


def between_plates(draw):
    """Two thin plates, one on the other."""
    first, second = draw.between(0.02, 0.06), draw.between(0.02, 0.06)
    draw.held = ["end", "end"]
    return draw.slab((-0.5, -first), (0.5, 0)), draw.slab((-0.5, draw.gap), (0.5, draw.gap + second))


def tongue(draw):
    """A tongue in a groove: the surface of each folds around the other."""
    half, play = draw.between(0.1, 0.3), abs(draw.gap) + draw.between(0, 0.02)
    lower = cut(draw.slab((-0.5, -1), (0.5, 0.3)), draw.slab((-half, 0), (half, 1)))
    return lower, draw.slab((-half + play, draw.gap), (half - play, 0.9))


def comb(draw):
    """Two tongues in two grooves."""
    play = 0.01 + abs(draw.gap)
    lower = cut(draw.slab((-0.8, -0.5), (0.8, 0.3)), *(draw.slab((x - 0.2, 0), (x + 0.2, 1)) for x in (-0.4, 0.4)))
    fingers = [draw.slab((x - 0.2 + play, draw.gap), (x + 0.2 - play, 0.5)) for x in (-0.4, 0.4)]
    return lower, joined(draw.slab((-0.7, 0.5), (0.7, 0.8)), *fingers)


def shaft(draw):
    """A shaft with a bore, in a hub."""
    draw.held = ["low", "bore"]
    inner = cut(draw.bar(0, 0, 0.3), draw.bar(0, 0, 0.12))
    return cut(draw.slab((-0.6, -0.6), (0.6, 0.6)), draw.bar(draw.gap / 3, 0, 0.3 + draw.gap)), inner


def nested(draw):
    """A hollow body in a closed hollow one."""
    draw.held = ["low", "bore"]
    inner = cut(draw.round(0, 0, 0.3), draw.round(0, 0, 0.15))
    return cut(draw.slab((-0.5, -0.5), (0.5, 0.5)), draw.slab((-0.33, -0.3 - draw.gap), (0.33, 0.32))), inner


def hooks(draw):
    """Two hooks, one behind the other: they touch from above and from the side."""
    draw.held = ["low", "high"]
    lower = joined(draw.slab((-0.5, -0.5), (-0.2, 0.5)), draw.slab((-0.5, 0.3), (0.1, 0.5)))
    upper = joined(draw.slab((-0.1 + abs(draw.gap), 0), (0.4, 0.3 - draw.gap)), draw.slab((0.2, 0), (0.4, 1)))
    return lower, upper


def wedge(draw):
    """A roof on a groove of another angle, or of the same."""
    angle = draw.between(0.4, 1.2)
    tip = lambda: draw.turn(draw.slab((-0.3, -0.3), (0.3, 0.3)), math.pi / 4, 0, 0)
    lower = cut(draw.slab((-0.6, -1), (0.6, 0)), tip())
    roof = draw.turn(draw.slab((-0.3, draw.gap - 0.3), (0.3, draw.gap + 0.3)), angle, 0, draw.gap)
    return lower, occ.intersect([roof], [draw.slab((-1, -1), (1, 0.2))])[0][0]


def tilted(draw):
    """A block that stands on its edge, or nearly flat."""
    angle = draw.random.choice([draw.between(0, 0.05), draw.between(0, math.pi / 4)])
    upper = draw.turn(draw.slab((0, draw.gap), (0.5, draw.gap + 0.5)), angle, 0, draw.gap)
    return draw.slab((-0.6, -0.6), (0.6, 0)), cut(upper, draw.slab((-1, draw.gap + 0.35), (1, 2)))


def crossed(draw):
    """A block that goes through another one, or lies in it: no surface faces the other as in a contact."""
    width, depth = draw.between(0.1, 0.4), draw.between(0.1, 0.6)
    draw.held = ["low", "high"]
    return draw.slab((-0.5, -0.5), (0.5, 0)), draw.slab((-width, -depth), (width, draw.between(0.1, 0.6)))


def pieces(draw):
    """A body of two pieces that are not joined, on a block."""
    gap = draw.gap
    return draw.slab((-0.7, -0.5), (0.7, 0)), [draw.slab((-0.6, gap), (-0.1, 0.5)), draw.slab((0.1, gap + 0.004), (0.6, 0.5))]


def stack(draw):
    """Two blocks that share the nodes of their common side."""
    draw.shared = True
    width = draw.between(0.4, 1.2)
    return draw.slab((-0.5, -0.5), (0.5, 0)), draw.slab((-width / 2, 0), (width / 2, 0.5))


KINDS = (blocks, rounds, plate, between_plates, tongue, comb, shaft, nested, hooks, wedge, tilted, crossed, pieces, stack)
STRUCTURED = (blocks, between_plates, crossed)
"""Kinds whose bodies are mostly single blocks, which Gmsh fills with bricks."""


def chosen(side, box, whole, dimension):
    """Returns `True` if a side with this box holds the body."""
    up, far = dimension - 1, 1e-6
    (low, high), (first, last) = (box[:3], box[3:]), (whole[:3], whole[3:])
    if side == "low":
        return high[up] < first[up] + far
    if side == "high":
        return low[up] > last[up] - far
    if side == "end":
        return high[0] < first[0] + far
    return all(low[axis] > first[axis] + 0.05 and high[axis] < last[axis] - 0.05 for axis in (0, up))


def holding(dimension, shapes, side):
    """Returns the sides that hold the body."""
    boxes = {tag: gmsh.model.getBoundingBox(dimension - 1, tag) for _, tag in gmsh.model.getBoundary(shapes, oriented=False)}
    whole = [pick(box[axis] for box in boxes.values()) for pick, axes in ((min, (0, 1, 2)), (max, (3, 4, 5))) for axis in axes]
    held = [tag for tag, box in boxes.items() if chosen(side, box, whole, dimension)]
    return held


def mesh(draw, shapes, size, file):
    """Meshes the shapes in the model and writes them."""
    bricks = draw.element in BRICKS
    size = 2 * size if draw.element[0] == "q" else size
    for option, value in {"MeshSizeMax": size, "MeshSizeMin": size / 4, "MeshSizeFromCurvature": 12,
                          "ElementOrder": 2 if draw.element in QUADRATIC else 1, "SecondOrderIncomplete": 1,
                          "Algorithm": 8 if draw.element[0] == "q" else 6, "RecombineAll": int(draw.element[0] == "q" or bricks),
                          "SubdivisionAlgorithm": int(draw.element[0] == "q"),
                          "RandomSeed": draw.random.randrange(1, 1000)}.items():
        gmsh.option.setNumber("Mesh." + option, value)
    if bricks:
        for dimension in (1, 2, 3):
            for _, tag in gmsh.model.getEntities(dimension):
                if dimension == 1:
                    low, high = (gmsh.model.getBoundingBox(1, tag)[axis:axis + 3] for axis in (0, 3))
                    gmsh.model.mesh.setTransfiniteCurve(tag, max(2, 1 + round(math.dist(low, high) / size)))
                else:
                    (gmsh.model.mesh.setTransfiniteSurface, gmsh.model.mesh.setTransfiniteVolume)[dimension - 2](tag)
    gmsh.model.mesh.generate(draw.dimension)
    gmsh.write(str(file))


def meshed(draw, kind, folder):
    """Writes the meshes of both bodies and returns their entries in a scene."""
    names, bodies = ("base", "part"), []
    gmsh.clear()
    sizes = [draw.between(0.05, 0.2) if draw.dimension == 2 else draw.between(0.16, 0.35) for _ in names]
    groups = lambda shapes: shapes if isinstance(shapes, list) else [shapes]
    drawn = [groups(shapes) for shapes in kind(draw)]
    if draw.shared:
        _, maps = occ.fragment(drawn[0], drawn[1])
        drawn = [maps[0], maps[1]]
    occ.synchronize()
    for name, shapes, side in zip(names, drawn, draw.held):
        held = holding(draw.dimension, shapes, side)
        gmsh.model.addPhysicalGroup(draw.dimension, [tag for _, tag in shapes], name=name)
        gmsh.model.addPhysicalGroup(draw.dimension - 1, held, name="held-" + name if draw.shared else "held")
    if draw.shared:
        mesh(draw, drawn[0] + drawn[1], sizes[0], folder / "both.msh")
        return [{"gmsh": {"file": "both.msh", "group": name}} for name in names]
    return apart(draw, kind, folder, names, sizes)


def apart(draw, kind, folder, names, sizes):
    """Draws both bodies anew with the same numbers, each in a model of its own."""
    state, gap = draw.random.getstate(), draw.gap
    for number, name in enumerate(names):
        gmsh.clear()
        draw.random.setstate(draw.first)
        shapes = kind(draw)
        both = [shape if isinstance(shape, list) else [shape] for shape in shapes]
        occ.remove(both[1 - number], recursive=True)
        occ.synchronize()
        held = holding(draw.dimension, both[number], draw.held[number])
        gmsh.model.addPhysicalGroup(draw.dimension, [tag for _, tag in both[number]], name=name)
        gmsh.model.addPhysicalGroup(draw.dimension - 1, held, name="held")
        draw.random.setstate(state)
        mesh(draw, both[number], sizes[number], folder / f"{name}.msh")
    return [{"gmsh": {"file": f"{name}.msh"}} for name in names]


def pair(seed, folder: pathlib.Path) -> dict:
    """Writes the pair of a number to a folder: both meshes and scene.json. Returns the scene."""
    numbers = random.Random(seed)
    kind, dimension = KINDS[seed % len(KINDS)], 2 + seed // len(KINDS) % 2
    elements = ELEMENTS[dimension] if kind in STRUCTURED else [name for name in ELEMENTS[dimension] if name not in BRICKS]
    draw = Draw(numbers, dimension, numbers.choice(elements))
    draw.gap = numbers.choice([0.0, numbers.uniform(0, 0.03), numbers.uniform(-0.02, 0)])
    young = [10 ** numbers.uniform(0, 3) for _ in range(2)]
    if numbers.random() < 0.3:
        young[1] = young[0]
    draw.first = numbers.getstate()
    bodies = meshed(draw, kind, folder)
    axes, up = ("xy", "xyz")[dimension - 2], dimension - 1
    names = ["base.held-base", "held-part"] if draw.shared else ["base.held", "held"]
    scene = {
        "title": f"{kind.__name__} of {draw.element}, {seed}",
        "model": "space" if dimension == 3 else "plane-strain",
        "body": bodies[1], "material": {"young": young[1], "poisson": numbers.uniform(0, 0.4)},
        "further-bodies": [{"name": "base", "body": bodies[0], "material": {"young": young[0], "poisson": numbers.uniform(0, 0.4)}}],
        "contact": "auto",
        "supports": [{"on": {"boundary": names[0]}} | {axis: 0 for axis in axes}],
    }
    travel = max(draw.gap, 0) + numbers.choice([0.0, numbers.uniform(0, 0.01), numbers.uniform(0, 0.04)])
    held = {"on": {"boundary": names[1]}} | {axis: 0 for axis in axes}
    if numbers.random() < 0.75 or draw.held[1] != "high":
        scene["supports"].append(held | {axes[up]: -travel, axes[0]: numbers.choice([0, numbers.uniform(-0.01, 0.01)])})
    else:
        del held[axes[up]]
        scene["supports"].append(held)
        scene["loads"] = [{"pressure": {"boundary": names[1], "value": numbers.uniform(0, 0.02) * min(young)}}]
    (folder / "scene.json").write_text(json.dumps(scene, indent=1))
    return scene

"""Writes the meshes of tests/meshes with the real Gmsh.

The files are kept in the repository, so that no test needs Gmsh. This command writes them again:

    target/venv/bin/python reference/meshes.py

It needs `pip install gmsh==4.15.2`, and Gmsh needs libraries of a graphical system (on Debian libglu1-mesa, libxcursor1, libxft2, libxinerama1).
Every file has a node that belongs to no element of the body. The files of version 4.1 have unsorted node tags with gaps; in
version 2.2 Gmsh numbers the nodes itself. The cube is one mesh in four forms, with coordinates that ASCII represents exactly.
"""

import math
import pathlib
import random

import gmsh

occ = gmsh.model.occ
FOLDER = pathlib.Path(__file__).resolve().parent.parent / "tests" / "meshes"
OPTIONS = {
    "General.Terminal": 0,
    "Mesh.Binary": 0,
    "Mesh.RecombineAll": 0,
    "Mesh.ElementOrder": 1,
    "Mesh.SecondOrderIncomplete": 1,
    "Mesh.Algorithm": 6,
    "Mesh.MeshSizeMin": 0,
}


def name_all(dimension, names):
    for name, entities in names.items():
        gmsh.model.addPhysicalGroup(dimension, entities, name=name)


def lines_through(points, size):
    tags = [gmsh.model.geo.addPoint(*point, 0, size) for point in points]
    return [gmsh.model.geo.addLine(tag, tags[(i + 1) % len(tags)]) for i, tag in enumerate(tags)]


def surface(lines):
    return gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(lines)])


def stray_point():
    point = gmsh.model.geo.addPoint(5, 5, 0)
    gmsh.model.geo.synchronize()
    name_all(0, {"stray": [point]})


def block():
    """The block 2 x 1."""
    bottom, right, top, left = lines_through([(0, 0), (2, 0), (2, 1), (0, 1)], 0.3)
    body = surface([bottom, right, top, left])
    stray_point()
    name_all(1, {"bottom": [bottom], "right": [right], "top": [top], "left": [left]})
    name_all(2, {"body": [body]})


def two_parts():
    """Two blocks 1 x 1 side by side, with a line between them."""
    geo = gmsh.model.geo
    points = [geo.addPoint(x, y, 0, 0.3) for x in (0, 1, 2) for y in (0, 1)]
    line = lambda a, b: geo.addLine(points[a], points[b])
    left, middle, right = line(0, 1), line(2, 3), line(4, 5)
    bottom, top = [line(0, 2), line(2, 4)], [line(1, 3), line(3, 5)]
    first = surface([bottom[0], middle, -top[0], -left])
    second = surface([bottom[1], right, -top[1], -middle])
    stray_point()
    name_all(1, {"left": [left], "interface": [middle], "right": [right], "bottom": bottom, "top": top})
    name_all(2, {"first": [first], "second": [second]})


def half_disc():
    """The lower half of the unit disc about (0, 1)."""
    geo = gmsh.model.geo
    centre, west, south, east = [
        geo.addPoint(x, y, 0, size) for x, y, size in ((0, 1, 0.4), (-1, 1, 0.4), (0, 0, 0.15), (1, 1, 0.4))
    ]
    cut = geo.addLine(east, west)
    arcs = [geo.addCircleArc(west, centre, south), geo.addCircleArc(south, centre, east)]
    body = surface(arcs + [cut])
    geo.synchronize()
    name_all(0, {"centre": [centre]})
    name_all(1, {"arc": arcs, "cut": [cut]})
    name_all(2, {"disc": [body]})


def box(divisions, recombined, size=0.6):
    """The unit cube."""
    gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    stray = gmsh.model.occ.addPoint(5, 5, 5)
    gmsh.model.occ.synchronize()
    if divisions:
        gmsh.model.mesh.setTransfiniteAutomatic(recombine=recombined)
        for _, curve in gmsh.model.getEntities(1):
            gmsh.model.mesh.setTransfiniteCurve(curve, divisions + 1)
    sides = ["left", "right", "front", "back", "bottom", "top"]
    name_all(0, {"stray": [stray]})
    name_all(2, {name: [tag] for tag, name in enumerate(sides, start=1)})
    name_all(3, {"body": [1]})
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)


def half_ball():
    """The lower half of the unit ball about (0, 0, 1), with smaller elements towards its lowest point."""
    occ = gmsh.model.occ
    ball = occ.addSphere(0, 0, 1, 1)
    half = occ.intersect([(3, ball)], [(3, occ.addBox(-1, -1, -0.5, 2, 2, 1.5))])[0][0][1]
    occ.synchronize()
    sides = {tag: gmsh.model.occ.getCenterOfMass(2, tag)[2] for _, tag in gmsh.model.getEntities(2)}
    cut = max(sides, key=sides.get)
    name_all(2, {"cut": [cut], "round": [tag for tag in sides if tag != cut]})
    name_all(3, {"ball": [half]})
    gmsh.model.mesh.field.add("Ball", 1)
    for name, value in (("ZCenter", 0), ("Radius", 0.3), ("VIn", 0.25), ("VOut", 0.7), ("Thickness", 0.8)):
        gmsh.model.mesh.field.setNumber(1, name, value)
    gmsh.model.mesh.field.setAsBackgroundMesh(1)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.7)


def quarter_ball():
    """A quarter of the lower half of the unit ball about (0, 0, 1), with much smaller elements around its lowest point."""
    occ = gmsh.model.occ
    occ.intersect([(3, occ.addSphere(0, 0, 1, 1))], [(3, occ.addBox(0, 0, -0.5, 2, 2, 1.5))])
    occ.synchronize()
    for _, tag in gmsh.model.getEntities(2):
        low, high = gmsh.model.getParametrizationBounds(2, tag)
        x, y, z = gmsh.model.getValue(2, tag, [(start + end) / 2 for start, end in zip(low, high)])
        name = "symmetry-x" if abs(x) < 1e-9 else "symmetry-y" if abs(y) < 1e-9 else "cut" if abs(z - 1) < 1e-9 else "round"
        name_all(2, {name: [tag]})
    name_all(3, {"ball": [tag for _, tag in gmsh.model.getEntities(3)]})
    distance = lambda *point: math.sqrt(sum(value * value for value in point))
    share = lambda *point: min(1, max(0, (distance(*point) - 0.065) / 0.635))
    gmsh.model.mesh.setSizeCallback(lambda _, tag, x, y, z, size: 0.012 + 0.288 * share(x, y, z))


def named(dimension, **boundaries):
    """Names the body and its boundaries: each consists of the sides whose box fulfils its condition. `None` names neither."""
    gmsh.model.occ.synchronize()
    for name, condition in boundaries.items():
        boxes = {tag: gmsh.model.getBoundingBox(dimension - 1, tag) for _, tag in gmsh.model.getEntities(dimension - 1)}
        name_all(dimension - 1, {name: [tag for tag, box in boxes.items() if condition(box[:3], box[3:])]})
    name_all(dimension, {"body": [tag for _, tag in gmsh.model.getEntities(dimension)]})


def plate_with_hole():
    occ.cut([(2, occ.addRectangle(0, 0, 0, 4, 2))], [(2, occ.addDisk(2, 1, 0, 0.5, 0.5))])
    named(2, left=lambda low, high: high[0] < 0.1, right=lambda low, high: low[0] > 3.9,
          bore=lambda low, high: low[0] > 1 and high[0] < 3)


def bored_block():
    """The axis of the bore is vertical: no facet of it faces up or down."""
    occ.cut([(3, occ.addBox(0, 0, 0, 2, 2, 1))], [(3, occ.addCylinder(1, 1, -1, 0, 0, 3, 0.4))])
    named(3, base=lambda low, high: high[2] < 0.1, bore=lambda low, high: low[0] > 0.5 and high[0] < 1.5)


def bored_across():
    """The axis of the bore is horizontal."""
    occ.cut([(3, occ.addBox(0, 0, 0, 2, 2, 1))], [(3, occ.addCylinder(-1, 1, 0.5, 4, 0, 0, 0.3))])
    bore = lambda low, high: low[2] > 0.1 and high[2] < 0.9
    named(3, skin=lambda low, high: not bore(low, high), contact=bore)


def quarter_with_hole():
    occ.cut([(2, occ.addRectangle(0, 0, 0, 2, 2))], [(2, occ.addDisk(0, 0, 0, 0.5, 0.5))])
    named(2, cut=lambda low, high: high[0] < 0.1, bore=lambda low, high: high[0] < 0.6 and high[1] < 0.6)


def ring():
    occ.cut([(2, occ.addDisk(0, 0, 0, 2, 2))], [(2, occ.addDisk(0, 0, 0, 1, 1))])
    named(2, outer=lambda low, high: high[0] > 1.5, inner=lambda low, high: high[0] < 1.5)


def two_boxes():
    """Two boxes that are not joined, in one group."""
    occ.addBox(0, 0, 0, 1, 1, 1), occ.addBox(3, 0, 0, 1, 1, 1)
    named(3, left=lambda low, high: high[0] < 0.1, right=lambda low, high: low[0] > 3.9)


def box_in_two():
    """A boundary runs through the body."""
    occ.fragment([(3, occ.addBox(0, 0, 0, 1, 1, 1))], [(3, occ.addBox(0, 0, 1, 1, 1, 1))])
    named(3, base=lambda low, high: high[2] < 0.1, interface=lambda low, high: low[2] > 0.9 and high[2] < 1.1)


def one_name():
    occ.addRectangle(0, 0, 0, 2, 1)
    named(2, held=lambda low, high: low[1] > 0.9)


def skin_and_top():
    """One boundary contains the other."""
    occ.addBox(0, 0, 0, 1, 1, 1)
    named(3, top=lambda low, high: low[2] > 0.9, skin=lambda low, high: True)


def lying_cylinder():
    occ.addCylinder(0, 0, 0, 3, 0, 0, 1)
    ends = lambda low, high: high[0] - low[0] < 0.1
    named(3, ends=ends, round=lambda low, high: not ends(low, high))


def tilted_box():
    occ.rotate([(3, occ.addBox(0, 0, 0, 1, 1, 1))], 0, 0, 0, 1, 1, 0.3, 0.8)
    named(3)


def line():
    occ.addLine(occ.addPoint(0, 0, 0), occ.addPoint(1, 0, 0))
    named(1, left=lambda low, high: high[0] < 0.1, right=lambda low, high: low[0] > 0.9)


def generate(name, dimension, build, **options):
    gmsh.clear()
    for option, value in (OPTIONS | options).items():
        gmsh.option.setNumber(option, value)
    gmsh.model.add(name)
    build()
    gmsh.model.mesh.generate(dimension)


def write(name, version, dimension, build, **options):
    generate(name, dimension, build, **{"Mesh.MshFileVersion": version} | options)
    tags = [int(tag) for tag in gmsh.model.mesh.getNodes()[0]]
    shuffled = [3 * tag + 7 for tag in tags]
    random.Random(1).shuffle(shuffled)
    gmsh.model.mesh.renumberNodes(tags, shuffled)
    gmsh.write(str(FOLDER / f"{name}.msh"))


def write_forms(name, dimension, build, **options):
    """Writes one mesh in both versions, each as ASCII and as binary."""
    generate(name, dimension, build, **options)
    for version in (4.1, 2.2):
        for binary, form in enumerate(("ascii", "binary")):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            gmsh.write(str(FOLDER / f"{name}-{version}-{form}.msh"))


if __name__ == "__main__":
    gmsh.initialize()
    write("block-t3", 4.1, 2, block)
    write("two-parts-q8", 2.2, 2, two_parts, **{"Mesh.ElementOrder": 2, "Mesh.RecombineAll": 1, "Mesh.Algorithm": 8})
    write("half-disc-t6", 2.2, 2, half_disc, **{"Mesh.ElementOrder": 2})
    write("box-tet4", 4.1, 3, lambda: box(0, False))
    write("box-hex8", 4.1, 3, lambda: box(2, True))
    write("box-tet10", 4.1, 3, lambda: box(0, False), **{"Mesh.ElementOrder": 2})
    write("box-hex20", 4.1, 3, lambda: box(2, True), **{"Mesh.ElementOrder": 2})
    write("half-ball-tet10", 2.2, 3, half_ball, **{"Mesh.ElementOrder": 2})
    options = {"Mesh.ElementOrder": 2, "Mesh.Binary": 1, "Mesh.MeshSizeExtendFromBoundary": 0}
    write("quarter-ball-tet10", 4.1, 3, quarter_ball, **options)
    gmsh.model.mesh.removeSizeCallback()
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 1)
    write_forms("cube-tet4", 3, lambda: box(0, False, 2), **{"Mesh.MeshSizeMin": 2})
    for build, dimension, size in (
        (plate_with_hole, 2, 0.5), (bored_block, 3, 0.7), (bored_across, 3, 0.8), (quarter_with_hole, 2, 0.4), (ring, 2, 0.6),
        (two_boxes, 3, 0.9), (box_in_two, 3, 0.9), (one_name, 2, 0.5), (skin_and_top, 3, 0.9), (lying_cylinder, 3, 1.0),
        (tilted_box, 3, 0.9), (line, 1, 0.3),
    ):
        write("parts/" + build.__name__.replace("_", "-"), 4.1, dimension, build, **{"Mesh.MeshSizeMax": size})
    gmsh.finalize()

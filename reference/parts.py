"""Writes twenty parts with the real Gmsh: for each part a mesh NAME.msh and a scene NAME.json.

    target/venv/bin/python reference/parts.py [--coarser FACTOR] FOLDER [NAME ...]
    cargo run --release --example studies -- kinds --scenes FOLDER

The second command measures the times of the methods on them. Fourteen parts are meshed with tetrahedra in space, seven of them with
ten nodes; six are meshed with quadratic triangles, plane or axisymmetric. Ten meshes are graded towards the contact. The parts have
3,000 to 150,000 dofs. Lengths are in mm, forces in N. `--coarser 2` makes all edges twice as long. Every run writes the same files.
It needs `pip install gmsh`; meshes.py names the libraries that Gmsh needs.
"""

import json
import math
import pathlib
import sys

import gmsh

OPTIONS = {"General.Terminal": 0, "General.NumThreads": 1, "Mesh.MshFileVersion": 4.1, "Mesh.Algorithm": 6}
OPTIONS |= {"Mesh.RandomSeed": 1, "Mesh.RandomFactor": 1e-9, "Mesh.MeshSizeExtendFromBoundary": 0}
STEEL, BRONZE = {"young": 210e3, "poisson": 0.3}, {"young": 110e3, "poisson": 0.34}
ALUMINIUM, CONCRETE = {"young": 70e3, "poisson": 0.33}, {"young": 30e3, "poisson": 0.0}
POLYMER, RUBBER = {"young": 3e3, "poisson": 0.4}, {"young": 10.0, "poisson": 0.45}
CLAMPED, AXIS, NORMAL = ("x", "y", "z"), "approach", "closest-point"
occ = gmsh.model.occ
COARSER = 1.0
"""Factor of the lengths of all edges, set by `--coarser`."""


def about(radius, angle):
    """Returns the point on a circle about the origin, at an angle in degrees, counterclockwise from x."""
    return radius * math.cos(math.radians(angle)), radius * math.sin(math.radians(angle))


def polygon(*points):
    tags = [occ.addPoint(*point, 0) for point in points]
    return 2, occ.addPlaneSurface([occ.addCurveLoop([occ.addLine(*ends) for ends in zip(tags, tags[1:] + tags[:1])])])


def sector(inner, outer, start, end, thickness=0.0):
    """Makes a sector of a ring between two angles; with a thickness along z it is a body in space."""
    line = occ.addLine(*[occ.addPoint(*about(radius, start), 0) for radius in (inner, outer)])
    flat = occ.revolve([(1, line)], 0, 0, 0, 0, 0, 1, math.radians(end - start))[1]
    if thickness:
        occ.extrude([flat], 0, 0, thickness)


def value(formula, x, y, z):
    return eval(formula, vars(math) | {"x": x, "y": y, "z": z})


def named(**boundaries):
    """Names the body and its boundaries. A boundary consists of the points at which its formula is zero."""
    occ.synchronize()
    dimension = gmsh.model.getDimension()
    for name, formula in boundaries.items():
        on = lambda tag: all(abs(value(formula, *point)) < 1e-6 for point in samples(dimension - 1, tag))
        found = [tag for _, tag in gmsh.model.getEntities(dimension - 1) if on(tag)]
        gmsh.model.addPhysicalGroup(dimension - 1, found, name=name)
    gmsh.model.addPhysicalGroup(dimension, [tag for _, tag in gmsh.model.getEntities(dimension)], name="body")


def samples(dimension, tag):
    """Returns three points of a curve, or of the surface of a face."""
    low, high = gmsh.model.getParametrizationBounds(dimension, tag)
    for share in (0.2, 0.55, 0.8):
        yield gmsh.model.getValue(dimension, tag, [a + share * (b - a) for a, b in zip(low, high)])


def graded(fine, coarse, near, far, distance):
    """Sets the edge length to `fine` up to the distance `near`, and to `coarse` beyond `far`; `distance` is a formula."""
    fine, coarse = COARSER * fine, COARSER * coarse
    share = lambda *point: min(1, max(0, (value(distance, *point) - near) / (far - near)))
    gmsh.model.mesh.setSizeCallback(lambda _, tag, x, y, z, size: fine + (coarse - fine) * share(x, y, z))


def even(size):
    graded(size, size, 0, 1, "0")


def held(*directions, on, **others):
    """Returns a support that is zero in these directions, with further entries."""
    return {"on": {"boundary": on}, **dict.fromkeys(directions, 0), **others}


def load(kind, on, value):
    return {kind: {"boundary": on, "value": value}}


def obstacle(rule, boundary, approach, **shape):
    return {"boundary": boundary, "approach": approach, "rule": rule, "shape": shape}


def bore(radius, length):
    """Returns the upper wall (y > 0) of a bore along z from 0 to a length, as heights over x and z."""
    wall = [about(radius, 180 - 1.5 * step) for step in range(121)]
    return {"x": [x for x, _ in wall], "y": [0, length], "heights": [[abs(y)] * 2 for _, y in wall]}


def scene(material, supports, obstacles, loads=(), model="space", **others):
    return {"model": model, "material": material, "supports": supports, "loads": loads, "obstacles": obstacles} | others


def seal():
    """A lip seal that is widened by a shaft."""
    occ.fuse([(2, occ.addRectangle(21, 0, 0, 5, 5))], [(2, occ.addDisk(21, 2.5, 0, 1.5, 1.5))])
    named(outside="x - 26", lip="hypot(x - 21, y - 2.5) - 1.5")
    graded(0.04, 0.6, 0.25, 3, "hypot(x - 19.5, y - 2.5)")
    shaft = obstacle(AXIS, "lip", "-x", plane={"point": [19.5, 0], "normal": [-1, 0]})
    return scene(RUBBER, [held("x", "y", on="outside")], [shaft], gap=-0.15, model="axisymmetric")


def bracket():
    """A bracket whose hole is pressed down on a pin."""
    plate, shelf = occ.addBox(0, 0, 0, 8, 40, 50), occ.addBox(8, 0, 20, 52, 40, 12)
    occ.cut(occ.fuse([(3, plate)], [(3, shelf)])[0], [(3, occ.addCylinder(45, 0, 26, 0, 40, 0, 4))])
    named(wall="x", shelf="z - 32", hole="hypot(x - 45, z - 26) - 4")
    even(3.7)
    pin = obstacle(NORMAL, "hole", "-z", cylinder={"axis": [0, 1, 0], "centre": [45, 0, 26], "radius": 3.98})
    return scene(STEEL, [held(*CLAMPED, on="wall")], [pin], [load("traction", "shelf", [0, 0, -5])])


def loose_liner():
    """Half a ring that its internal pressure widens, but not enough to reach the bore."""
    sector(17, 20, 0, 180, 12)
    named(cuts="y", front="z", inside="hypot(x, y) - 17", outside="hypot(x, y) - 20")
    even(1.3)
    wall = obstacle(NORMAL, "outside", "+y", **{"height-map": bore(20.2, 12)})
    return scene(BRONZE, [held("x", "y", on="cuts"), held("z", on="front")], [wall], [load("pressure", "inside", 20)])


def clip():
    """Half a clip that is widened by a thick pin."""
    sector(10, 12, -50, 90)
    named(middle="x", inside="hypot(x, y) - 10")
    even(0.345)
    pin = obstacle(NORMAL, "inside", "-x", circle={"centre": [-0.05, 0], "radius": 10.2})
    supports = [held("x", on="middle"), {"on": {"point": [0, 12]}, "y": 0}]
    return scene(STEEL, supports, [pin], thickness=2, model="plane-stress")


def foundation():
    """A heavy block that is supported only by rollers and by an inclined plane."""
    occ.addBox(0, 0, 0, 4000, 3000, 1500)
    named(left="x", front="y", bottom="z", top="z - 1500")
    even(220)
    ground = obstacle(AXIS, "bottom", "-z", plane={"point": [0, 0, 0], "normal": [2e-4, 0, -1]})
    weight = [{"body-force": [0, 0, -2.5e-5]}, load("traction", "top", [0, 0, -0.5])]
    return scene(CONCRETE, [held("x", on="left"), held("y", on="front")], [ground], weight)


def dovetail():
    """Half the root of a blade under a pulling force, supported only by a plane of symmetry and the flank of the groove."""
    polygon((0, 0), (8, 0), (8, 2), (4.5, 8), (4.5, 14), (0, 14))
    named(middle="x", top="y - 14", flank="6 * (x - 8) + 3.5 * (y - 2)")
    even(0.34)
    groove = obstacle(NORMAL, "flank", "+x", plane={"point": [4.5, 8], "normal": [6, 3.48]})
    return scene(STEEL, [held("x", on="middle")], [groove], [load("traction", "top", [0, 200])], model="plane-strain")


def lug():
    """A quarter of a lug under a pulling force, supported only by planes of symmetry and the pin."""
    round_end = [(3, occ.addCylinder(0, 0, 0, 0, 0, 6, 20)), (3, occ.addCylinder(0, 0, 0, 0, 0, 6, 10))]
    whole = occ.fuse([(3, occ.addBox(0, -20, 0, 70, 40, 6))], round_end[:1])[0]
    occ.intersect(occ.cut(whole, round_end[1:])[0], [(3, occ.addBox(-30, 0, 0, 100, 20, 6))])
    named(middle="y", front="z", end="x - 70", hole="hypot(x, y) - 10")
    graded(0.4, 5, 4, 28, "hypot(x + 10, y)")
    pin = obstacle(NORMAL, "hole", "+x", cylinder={"axis": [0, 0, 1], "centre": [-0.05, 0, 0], "radius": 9.95})
    supports = [held("y", on="middle"), held("z", on="front")]
    return scene(ALUMINIUM, supports, [pin], [load("traction", "end", [40, 0, 0])])


def liner():
    """Half a ring, clamped at one end, that its internal pressure presses against the bore."""
    sector(17, 20, 0, 180, 15)
    named(cuts="y", end="z", inside="hypot(x, y) - 17", outside="hypot(x, y) - 20")
    even(1.07)
    wall = obstacle(NORMAL, "outside", "+y", **{"height-map": bore(20.02, 15)})
    return scene(BRONZE, [held("y", on="cuts"), held(*CLAMPED, on="end")], [wall], [load("pressure", "inside", 40)])


def bearing():
    """A sector of the outer ring of a bearing, pressed onto three rollers. Its ends are planes of symmetry."""
    sector(40, 50, 60, 120, 8)
    ends = {"start": "x - tan(pi / 6) * y", "end": "x + tan(pi / 6) * y"}
    named(**ends, front="z", inside="hypot(x, y) - 40", outside="hypot(x, y) - 50")
    distances = ["hypot(x - {}, y - {})".format(*about(40, angle)) for angle in (72, 90, 108)]
    graded(0.25, 3, 0.6, 8, f"min({', '.join(distances)})")
    rollers = [{"axis": [0, 0, 1], "centre": [*about(35, angle), 0], "radius": 5} for angle in (72, 90, 108)]
    obstacles = [obstacle(NORMAL, "inside", "-y", cylinder=roller) for roller in rollers]
    supports = [held(on=end, normal=[*about(1, angle), 0], value=0) for end, angle in (("start", -30), ("end", 30))]
    return scene(STEEL, supports + [held("z", on="front")], obstacles, [load("pressure", "outside", 60)])


def gear_tooth():
    """A gear tooth against which the flank of another tooth is pressed."""
    discs = [[(2, occ.addDisk(x, 0, 0, 22, 22))] for x in (-17, 17)]
    tooth = occ.intersect(occ.intersect(*discs)[0], [(2, occ.addRectangle(-9, -1, 0, 18, 11))])[0]
    occ.fuse(tooth, [(2, occ.addRectangle(-10, -6, 0, 20, 6))])
    named(rim="(y + 6) * (abs(x) - 10)", flank="hypot(x + 17, y) - 22")
    (x, y), centre = about(22, 15), about(37, 15)
    graded(0.035, 0.9, 0.5, 6, f"hypot(x - {x - 17}, y - {y})")
    other = obstacle(NORMAL, "flank", "+x", circle={"centre": [centre[0] - 17, centre[1]], "radius": 15})
    return scene(STEEL, [held("x", "y", on="rim")], [other], gap=-0.05, model="plane-strain")


def cantilever_stop():
    """A beam whose end is bent down onto a stop."""
    occ.addBox(0, 0, 0, 100, 10, 8)
    named(wall="x", top="z - 8", bottom="z")
    graded(0.27, 3.2, 1, 40, "100 - x + z")
    stop = obstacle(AXIS, "bottom", "-z", plane={"point": [0, 0, -0.37], "normal": [0, 0, -1]})
    return scene(STEEL, [held(*CLAMPED, on="wall")], [stop], [load("traction", "top", [0, 0, -0.4])])


def stiffened_plate():
    """A plate with two ribs that a pressure bends down onto a round floor."""
    ribs = [(3, occ.addBox(0, y, -20, 200, 4, 20)) for y in (38, 78)]
    occ.fuse([(3, occ.addBox(0, 0, 0, 200, 120, 4))], ribs)
    named(edges="x * (x - 200) * y * (y - 120)", top="z - 4", ribs="z + 20")
    even(4)
    floor = obstacle(AXIS, "ribs", "-z", sphere={"apex": [100, 60, -20.03], "radius": 5e4})
    return scene(ALUMINIUM, [held(*CLAMPED, on="edges")], [floor], [load("pressure", "top", 0.4)])


def layered_strip():
    """Half a strip on a soft layer, pressed at its centre, so that its end lifts off."""
    layers = [polygon((0, 0), (60, 0), (60, 2), (5, 2), (0, 2)), polygon((0, -4), (60, -4), (60, 0), (0, 0))]
    occ.fragment(layers[:1], layers[1:])
    named(middle="x if y > 0 else 1", pressed="y - 2 if x < 5 else 1", joint="y", bottom="y + 4")
    for (_, tag), name in zip(layers, ("strip", "base")):
        gmsh.model.addPhysicalGroup(2, [tag], name=name)
    even(0.455)
    base = {"name": "base", "material": POLYMER, "body": {"gmsh": {"group": "base"}}}
    joint = obstacle(AXIS, "joint", "-y", body={"boundary": "base.joint"})
    others = {"model": "plane-strain", "group": "strip", "further-bodies": [base]}
    supports = [held("x", on="middle"), held("x", "y", on="base.bottom")]
    return scene(ALUMINIUM, supports, [joint], [load("traction", "pressed", [0, -20])], **others)


def beam():
    """Half a heavy rubber beam that sags over a round support at its centre."""
    occ.addBox(0, 0, 0, 80, 14, 10)
    named(middle="x", end="x - 80", front="y", bottom="z")
    graded(0.3, 3, 2, 30, "hypot(x, z)")
    support = obstacle(AXIS, "bottom", "-z", cylinder={"axis": [0, 1, 0], "apex": [0, 0, -0.2], "radius": 60})
    supports = [held("x", on="middle"), held("y", "z", on="end"), held("y", on="front")]
    return scene(RUBBER, supports, [support], [{"body-force": [0, 0, -3e-4]}])


def rail():
    """A quarter of a piece of rail with a round head under a wheel."""
    occ.intersect([(3, occ.addBox(0, 0, -30, 40, 30, 31))], [(3, occ.addCylinder(0, 0, -80, 40, 0, 0, 80))])
    named(left="x", front="y", bottom="z + 30", head="hypot(y, z + 80) - 80")
    graded(0.15, 3.6, 3, 30, "hypot(x, y, z)")
    wheel = obstacle(AXIS, "head", "+z", cylinder={"axis": [0, 1, 0], "apex": [0, 0, 0], "radius": 120})
    return scene(STEEL, [held("x", on="left"), held("y", on="front"), held(*CLAMPED, on="bottom")], [wheel], gap=-0.08)


def cup():
    """A quarter of a cup into which a ball is pressed."""
    whole = occ.cut([(3, occ.addCylinder(0, 0, 0, 0, 0, 15, 20))], [(3, occ.addSphere(0, 0, 18, 12))])[0]
    occ.intersect(whole, [(3, occ.addBox(0, 0, 0, 20, 20, 15))])
    named(left="x", front="y", bottom="z", bowl="hypot(x, y, z - 18) - 12")
    graded(0.145, 1.6, 3, 15, "hypot(x, y, z - 6)")
    ball = obstacle(NORMAL, "bowl", "+z", sphere={"centre": [0, 0, 17.9], "radius": 11.9})
    return scene(BRONZE, [held("x", on="left"), held("y", on="front"), held(*CLAMPED, on="bottom")], [ball], gap=-0.02)


def fine_liner():
    """A quarter of a thin ring that its internal pressure presses against the bore, supported only by planes of symmetry."""
    sector(18.5, 20, 45, 135, 20)
    named(start="x - y", end="x + y", front="z", inside="hypot(x, y) - 18.5", outside="hypot(x, y) - 20")
    even(0.445)
    wall = obstacle(NORMAL, "outside", "+y", **{"height-map": bore(20.015, 20)})
    supports = [held(on="start", normal=[1, -1, 0], value=0), held(on="end", normal=[1, 1, 0], value=0)]
    return scene(BRONZE, supports + [held("z", on="front")], [wall], [load("pressure", "inside", 15)])


def thin_plate():
    """A thin plate under a ball, clamped at all edges."""
    occ.addBox(0, 0, 0, 160, 160, 2)
    named(edges="x * (x - 160) * y * (y - 160)", top="z - 2")
    even(2)
    ball = obstacle(AXIS, "top", "+z", sphere={"apex": [70, 80, 2], "radius": 2000})
    return scene(STEEL, [held(*CLAMPED, on="edges")], [ball], gap=-0.8)


def half_space():
    """A piece of the half space, with a hundred times shorter edges below the indenter."""
    occ.addRectangle(0, -50, 0, 50, 50)
    named(bottom="y + 50", side="x - 50", top="y")
    graded(0.03, 3, 2, 30, "hypot(x, y)")
    indenter = obstacle(AXIS, "top", "+y", circle={"apex": [0, 0], "radius": 20})
    return scene(STEEL, [held("x", "y", on="bottom"), held("x", on="side")], [indenter], gap=-0.1, model="axisymmetric")


def roller():
    """A quarter of a roller that is pressed onto a plane."""
    occ.intersect([(3, occ.addCylinder(0, 0, 10, 0, 12, 0, 10))], [(3, occ.addBox(0, 0, 0, 10, 12, 10))])
    named(middle="x", front="y", cut="z - 10", round="hypot(x, z - 10) - 10")
    graded(0.076, 0.95, 0.6, 8, "hypot(x, z)")
    plane = obstacle(AXIS, "round", "-z", plane={"point": [0, 0, 0], "normal": [0, 0, -1]})
    return scene(STEEL, [held("x", on="middle"), held("y", on="front"), held("x", on="cut", z=-0.08)], [plane])


def by_name(*functions):
    return {function.__name__.replace("_", "-"): function for function in functions}


PARTS = by_name(
    seal, bracket, loose_liner, clip, foundation, dovetail, lug, liner, bearing, gear_tooth,
    cantilever_stop, stiffened_plate, layered_strip, beam, rail, cup, fine_liner, thin_plate, half_space, roller,
)


LINEAR = {"foundation", "liner", "rail", "cup", "fine-liner", "thin-plate", "roller"}
"""The parts with four-node tetrahedra. All others have quadratic elements."""


def write(part, mesh, order):
    """Writes the file `mesh` of a part and its scene. Gmsh is started for each part, so that a part does not depend on those before it."""
    gmsh.initialize([], readConfigFiles=False, interruptible=False)
    for option, setting in OPTIONS.items():
        gmsh.option.setNumber(option, setting)
    made = part()
    gmsh.option.setNumber("Mesh.ElementOrder", order)
    gmsh.model.mesh.generate(gmsh.model.getDimension())
    gmsh.write(str(mesh))
    gmsh.finalize()
    body = {"gmsh": {"file": mesh.name, "group": made.pop("group", "body")}}
    for further in made.get("further-bodies", []):
        further["body"]["gmsh"]["file"] = mesh.name
    start = {"title": part.__doc__.rstrip("."), "units": {"length": "mm", "force": "N"}, "body": body}
    mesh.with_suffix(".json").write_text(json.dumps(start | made) + "\n")


if __name__ == "__main__":
    arguments = sys.argv[1:]
    if arguments[:1] == ["--coarser"]:
        COARSER, arguments = float(arguments[1]), arguments[2:]
    folder = pathlib.Path(arguments[0]) if arguments else sys.exit("usage: parts.py [--coarser FACTOR] FOLDER [NAME ...]")
    folder.mkdir(parents=True, exist_ok=True)
    for name in arguments[1:] or PARTS:
        write(PARTS[name], folder / f"{name}.msh", 1 if name in LINEAR else 2)

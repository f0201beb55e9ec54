"""Meshes two assemblies with Gmsh, whose bodies have their nodes opposite to each other: bush.msh and pads.msh."""

import gmsh

occ = gmsh.model.occ


def named(dimension, **groups):
    for name, tags in groups.items():
        gmsh.model.addPhysicalGroup(dimension, tags, name=name)


def box(tag):
    return gmsh.model.getBoundingBox(1, tag)


def bush():
    """A shaft of radius 10 in a hub of radius 20, cut in half: they touch along a half circle."""
    shaft = occ.intersect([(2, occ.addDisk(0, 0, 0, 10, 10))], [(2, occ.addRectangle(0, -30, 0, 30, 60))])[0]
    hub = occ.intersect([(2, occ.addDisk(0, 0, 0, 20, 20))], [(2, occ.addRectangle(0, -30, 0, 30, 60))])[0]
    _, pieces = occ.fragment(shaft, hub)
    occ.synchronize()
    shaft = [tag for _, tag in pieces[0]]
    hub = [tag for _, tag in pieces[1] if tag not in shaft]
    sides = lambda tags: {tag for _, tag in gmsh.model.getBoundary([(2, tag) for tag in tags], oriented=False)}
    fit = sides(shaft) & sides(hub)
    cut = {tag for tag in sides(shaft) | sides(hub) if box(tag)[3] < 1e-6}
    named(1, fit=list(fit), cut=list(cut), outside=list(sides(hub) - fit - cut))
    named(2, shaft=shaft, hub=hub)


def pads():
    """Two pads of 40 x 10, one above the other at a distance of 0.1."""
    lower, upper = occ.addRectangle(0, 0, 0, 40, 10), occ.addRectangle(0, 10.1, 0, 40, 10)
    occ.synchronize()
    side = {round(box(tag)[1], 1): tag for _, tag in gmsh.model.getEntities(1) if box(tag)[4] - box(tag)[1] < 0.01}
    # Each row: the transformation from the lower side to the upper one.
    up = [1, 0, 0, 0, 0, 1, 0, 0.1, 0, 0, 1, 0, 0, 0, 0, 1]
    gmsh.model.mesh.setPeriodic(1, [side[10.1]], [side[10.0]], up)
    named(1, base=[side[0.0]], seat=[side[10.0]], face=[side[10.1]], top=[side[20.1]])
    named(2, lower=[lower], upper=[upper])


if __name__ == "__main__":
    gmsh.initialize()
    for build, size in ((bush, 2.5), (pads, 3)):
        gmsh.clear()
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        build()
        gmsh.model.mesh.generate(2)
        gmsh.write(build.__name__ + ".msh")
    gmsh.finalize()

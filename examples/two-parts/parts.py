"""Meshes the sections of a round-nosed bar and of a pad with six-node triangles, each on its own, and writes bar.msh and pad.msh.

    pip install gmsh
    python parts.py [SIZE]

SIZE is the edge length around the expected contact, in mm; the default is 0.3.
"""

import sys

import gmsh

size = float(sys.argv[1]) if len(sys.argv) > 1 else 0.3
occ = gmsh.model.occ


def bar():
    """20 wide and 15 high, cut off below by a circle of radius 20 that touches y = 0."""
    block = occ.addRectangle(-10, 0, 0, 20, 15)
    circle = occ.addDisk(0, 20, 0, 20, 20)
    occ.intersect([(2, block)], [(2, circle)])


def pad():
    """40 wide and 10 high, below y = 0."""
    occ.addRectangle(-20, -10, 0, 40, 10)


def mesh(part, near, **sides):
    """Meshes one part. `near` is the edge length around the contact; the edges in each box [x, y, x, y] of `sides` get its name."""
    gmsh.clear()
    part()
    occ.synchronize()
    for name, (left, low, right, high) in sides.items():
        edges = gmsh.model.getEntitiesInBoundingBox(left, low, -1, right, high, 1, dim=1)
        gmsh.model.addPhysicalGroup(1, [tag for _, tag in edges], name=name)
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in gmsh.model.getEntities(2)], name=part.__name__)
    ball = gmsh.model.mesh.field.add("Ball")
    for key, value in {"Radius": 2, "Thickness": 12, "VIn": near, "VOut": 3}.items():
        gmsh.model.mesh.field.setNumber(ball, key, value)
    gmsh.model.mesh.field.setAsBackgroundMesh(ball)
    gmsh.model.mesh.generate(2)
    gmsh.write(part.__name__ + ".msh")


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
gmsh.option.setNumber("Mesh.ElementOrder", 2)
mesh(bar, 1.5 * size, top=(-11, 14, 11, 16), nose=(-11, -1, 11, 3))
mesh(pad, size, face=(-21, -1, 21, 1), base=(-21, -11, 21, -9))
gmsh.finalize()

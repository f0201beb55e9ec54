"""Meshes a machine foot, a disc of 40 mm with a domed top, with ten-node tetrahedra, and writes foot.msh.

    pip install gmsh
    python foot.py [SIZE]

SIZE is the edge length around the expected contact at the top of the dome, in mm; the default is 3.
"""

import sys

import gmsh

size = float(sys.argv[1]) if len(sys.argv) > 1 else 3.0
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ

# A cylinder of radius 20 and height 16, cut off by a sphere of radius 80 that touches its top.
cylinder = occ.addCylinder(0, 0, 0, 0, 0, 16, 20)
sphere = occ.addSphere(0, 0, 16 - 80, 80)
occ.intersect([(3, cylinder)], [(3, sphere)])
occ.synchronize()

# Name the supported face and the contact face, which are found by the heights of their centres.
height = {tag: occ.getCenterOfMass(2, tag)[2] for _, tag in gmsh.model.getEntities(2)}
lowest, highest = min(height, key=height.get), max(height, key=height.get)
gmsh.model.addPhysicalGroup(2, [lowest], name="base")
gmsh.model.addPhysicalGroup(2, [highest], name="dome")
gmsh.model.addPhysicalGroup(3, [1], name="foot")

# Small edges near the top of the dome, larger ones elsewhere.
ball = gmsh.model.mesh.field.add("Ball")
for name, value in {"ZCenter": 16, "Radius": 8, "Thickness": 14, "VIn": size, "VOut": 9}.items():
    gmsh.model.mesh.field.setNumber(ball, name, value)
gmsh.model.mesh.field.setAsBackgroundMesh(ball)
gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
gmsh.option.setNumber("Mesh.ElementOrder", 2)
gmsh.model.mesh.generate(3)
gmsh.write("foot.msh")
gmsh.finalize()

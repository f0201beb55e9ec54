"""Turns a mesh in the format of Gmsh, made by pygmsh or meshio, into a scene, and computes its press force.

`by_pygmsh` needs Gmsh. Without it, `by_meshio` makes a similar mesh with meshio alone and writes it in the same format:
the names of the physical groups are the names of the body and its boundaries.

Needs meshio: `pip install signorini meshio`. `by_pygmsh` also needs pygmsh, which brings Gmsh: `pip install pygmsh`.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import meshio
import numpy as np
import signorini as sg

WIDTH, HEIGHT = 2.0, 1.0


def by_pygmsh(file: Path) -> None:
    """Writes the mesh of the block by pygmsh, with the groups `steel`, `base` and `crown`."""
    import pygmsh

    with pygmsh.geo.Geometry() as geometry:
        block = geometry.add_rectangle(0.0, WIDTH, 0.0, HEIGHT, 0.0, mesh_size=0.1)
        geometry.add_physical(block.surface, "steel")
        geometry.add_physical(block.lines[0], "base")
        geometry.add_physical(block.lines[2], "crown")
        geometry.generate_mesh(dim=2)
        pygmsh.write(str(file))


def by_meshio(file: Path, cells: int = 16) -> None:
    """Writes a triangular mesh of the same block by meshio."""
    x, y = np.meshgrid(np.linspace(0, WIDTH, 2 * cells + 1), np.linspace(0, HEIGHT, cells + 1))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    across = 2 * cells + 1
    corner = np.array([row * across + column for row in range(cells) for column in range(2 * cells)])
    triangles = np.concatenate(
        [np.stack([corner, corner + 1, corner + across + 1], 1), np.stack([corner, corner + across + 1, corner + across], 1)]
    )
    base = np.stack([np.arange(across - 1), np.arange(1, across)], axis=1)
    crown = base + cells * across
    tags = [np.full(len(triangles), 1), np.full(len(base), 2), np.full(len(crown), 3)]
    mesh = meshio.Mesh(
        points,
        [("triangle", triangles), ("line", base), ("line", crown)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"steel": np.array([1, 2]), "base": np.array([2, 1]), "crown": np.array([3, 1])},
    )
    meshio.write(file, mesh, file_format="gmsh22", binary=False)


def scene(file: Path) -> sg.Scene:
    """Returns the scene: a punch with a round face of radius 1 mm is pressed 0.01 mm into the crown of the block."""
    return sg.Scene(
        {
            "title": "A punch on a block from Gmsh",
            "body": {"gmsh": {"file": file.name}},
            "material": {"young": 2.1e5, "poisson": 0.3},
            "units": {"length": "mm", "force": "N"},
            "supports": [{"on": {"boundary": "base"}, "x": 0, "y": 0}],
            "obstacles": [
                {
                    "boundary": "crown",
                    "approach": "+y",
                    "shape": {"circle": {"centre": [WIDTH / 2, HEIGHT + 1.0], "radius": 1.0}},
                }
            ],
            "gap": -0.01,
        },
        folder=file.parent,
    )


def main() -> sg.SceneSolution:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "block.msh"
        try:
            by_pygmsh(file)
        except (ImportError, OSError, AssertionError, RuntimeError):
            by_meshio(file)
        answer = scene(file).solve()
    print(answer)
    print(f"press force {answer.contact_force:.6g} N per mm, peak pressure {answer.pressure.max():.6g} MPa")
    for resultant in answer.resultants:
        print(f"  {resultant['of']:14} {np.round(resultant['force'], 3)}")
    return answer


if __name__ == "__main__":
    main()

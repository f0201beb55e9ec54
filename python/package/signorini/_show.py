"""Display in notebooks: tables in HTML, and pictures by matplotlib and pyvista, both of which are optional."""

from __future__ import annotations

import html
import json
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from signorini._signorini import SceneSolution, Solution

# The nodes around each plane element in order, and the numbers of the cell types in VTK.
_RIMS = {"T3": [0, 1, 2], "T6": [0, 3, 1, 4, 2, 5], "Q4": [0, 1, 2, 3], "Q8": [0, 4, 1, 5, 2, 6, 3, 7]}
_VTK = {
    "Line2": 3, "Line3": 21, "T3": 5, "T6": 22, "Q4": 9, "Q8": 23, "Tet4": 10, "Tet10": 24, "Hex8": 12, "Hex20": 25,
}  # fmt: skip



def scene_text(scene: dict[str, Any]) -> str:
    """Returns the JSON text of a scene, whose numbers may be numbers or arrays of numpy."""

    def plain(value: Any) -> Any:
        if hasattr(value, "tolist"):
            return value.tolist()
        raise TypeError(f"a scene has no place for a {type(value).__name__}")

    try:
        return json.dumps(scene, default=plain)
    except (TypeError, ValueError, RecursionError) as error:
        from signorini._errors import BadType

        raise BadType(f"the dictionary cannot be written as JSON: {error}") from None


def _table(title: str, lines: list[tuple[str, str]]) -> str:
    rows = "".join(f"<tr><th style='text-align:left'>{html.escape(a)}</th><td>{html.escape(b)}</td></tr>" for a, b in lines)
    return f"<table><caption>{html.escape(title)}</caption>{rows}</table>"


def _lines(solution: Solution) -> list[tuple[str, str]]:
    certificate = solution.certificate
    bound = solution.energy_error_bound
    lines = [
        ("dofs, contact rows", f"{len(solution.u)}, {len(solution.multiplier)}"),
        ("closed rows", f"{len(solution.contact_set)}"),
        ("contact force", f"{solution.contact_force:.9g}"),
        ("energy error", f"<= {bound:.1e}" if np.isfinite(bound) else "no bound"),
        ("worst condition", "{} {:.1e}".format(*certificate.worst)),
    ]
    if solution.proven is not None:
        proven = solution.proven
        lines.append(("proven", f"{len(proven.closed)} closed, {len(proven.open)} open, {len(proven.undecided)} undecided"))
    lines.append(("method", f"{solution.method}, {solution.iterations} iterations, {solution.seconds:.3g} s"))
    return lines


def solution_html(solution: Solution) -> str:
    """Returns the solution as a table in HTML."""
    return _table("Answer to a contact problem", _lines(solution))


def scene_html(solution: SceneSolution) -> str:
    """Returns the solution of a scene as a table in HTML."""
    lines = _lines(solution)
    if len(solution.pressure):
        lines.insert(3, ("peak pressure", f"{solution.pressure.max():.6e}"))
    return _table(solution.scene.title or "Answer to a contact scene", lines)


def axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as missing:
        raise ImportError("pictures need matplotlib: pip install 'signorini[plot]'") from missing
    return plt.subplots(layout="constrained")[1]


def solution_plot(solution: Solution, ax: Any = None) -> Any:
    """Draws the contact force of each row and returns the axes."""
    ax = axes(ax)
    forces = 0.0 - solution.multiplier
    closed = np.zeros(len(forces), dtype=bool)
    closed[solution.contact_set] = True
    rows = np.arange(len(forces))
    ax.plot(rows, forces, color="0.7", linewidth=1, zorder=1)
    ax.scatter(rows[~closed], forces[~closed], s=12, facecolors="white", edgecolors="0.4", label="open", zorder=2)
    ax.scatter(rows[closed], forces[closed], s=14, color="tab:blue", label="closed", zorder=2)
    ax.set_xlabel("contact row")
    ax.set_ylabel("contact force -multiplier")
    ax.legend(frameon=False)
    return ax


def scene_plot(solution: SceneSolution, ax: Any = None) -> Any:
    """Draws a deformed plane mesh with its von Mises stress, or the contact forces of a body in space or a bar."""
    scene = solution.scene
    kinds = scene.element_kinds
    if not set(kinds) <= set(_RIMS):
        return solution_plot(solution, ax)
    ax = axes(ax)
    from matplotlib.collections import PolyCollection

    moved = scene.nodes + solution.displacement
    elements = [nodes[nodes >= 0] for nodes in scene.elements]
    of_elements = np.array([solution.von_mises[nodes].mean() for nodes in elements])
    outlines = [moved[nodes[_RIMS[kind]]] for nodes, kind in zip(elements, kinds)]
    cells = PolyCollection(outlines, array=of_elements, cmap="viridis", edgecolors="face", linewidths=0.2)
    ax.add_collection(cells)
    nodes = np.asarray(scene.rows["node"])[solution.contact_set]
    ax.scatter(*moved[nodes].T, s=12, color="tab:red", zorder=3, label="closed")
    ax.autoscale()
    ax.set_aspect("equal")
    length, pressure = scene.units["length"], scene.units["pressure"]
    ax.set_xlabel(f"x [{length}]" if length else "x")
    ax.set_ylabel(f"y [{length}]" if length else "y")
    ax.set_title(scene.title or "moved mesh")
    if len(nodes):
        ax.legend(frameon=False, loc="upper left", bbox_to_anchor=(0, -0.12))
    label = f"von Mises stress [{pressure}]" if pressure else "von Mises stress"
    width, height = np.ptp(moved, axis=0)
    ax.figure.colorbar(cells, ax=ax, label=label, shrink=float(np.clip(height / width, 0.3, 1.0)))
    return ax


def scene_to_pyvista(solution: SceneSolution) -> Any:
    """Returns an unstructured grid of pyvista with displacement, stress and von Mises stress at the nodes."""
    try:
        import pyvista
    except ImportError as missing:
        raise ImportError("this needs pyvista: pip install 'signorini[pyvista]'") from missing
    scene = solution.scene

    def in_space(vectors: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))

    # The nodes of an element are already in the order of VTK.
    kinds = np.array(scene.element_kinds)
    alike = {kind: scene.elements[kinds == kind] for kind in dict.fromkeys(kinds.tolist())}
    cells = {_VTK[kind]: nodes[:, nodes[0] >= 0] for kind, nodes in alike.items()}
    grid = pyvista.UnstructuredGrid(cells, in_space(scene.nodes))
    grid.point_data["displacement"] = in_space(solution.displacement)
    grid.point_data["stress"] = np.asarray(solution.stress)
    grid.point_data["von_mises"] = np.asarray(solution.von_mises)
    return grid

"""Draws the picture of the README: a roller on a rubber pad, its contact pressure, and the bounds of its force.

`python front_picture.py examples/pictures/front.png`; it needs `pip install "signorini[plot]"`.
"""

from __future__ import annotations

import sys
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import signorini as sg
from matplotlib.collections import PolyCollection

RADIUS, APEX, DEPTH = 60.0, (20.0, 20.0), 0.5
GOALS = (0.05, 0.02, 0.01, 0.005, 0.002)
"""Wanted errors against the continuum, relative in the energy norm."""
LARGER = 4.0
"""Factor of the displacement in the picture of the body."""


def scene(cells: int = 40) -> sg.Scene:
    """Returns the first scene of the README, with `cells` along its top."""
    return sg.Scene(
        {
            "title": "A roller on a rubber pad",
            "units": {"length": "mm", "force": "N"},
            "body": {
                "rectangle": {
                    "x": {"points": [0, 40], "divisions": [cells]},
                    "y": {"points": [0, 20], "divisions": [cells // 2]},
                }
            },
            "material": {"young": 6, "poisson": 0.45},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "gap": -DEPTH,
            "obstacles": [
                {"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": list(APEX), "radius": RADIUS}}}
            ],
        }
    )


def draw_body(ax: Any, answer: Any) -> None:
    """Draws the displaced mesh with its von Mises stress, the roller as far above it as it is, and the closed nodes."""
    body = answer.scene
    moved = body.nodes + LARGER * answer.displacement
    cells = [moved[nodes] for nodes in body.elements]
    stress = np.array([answer.von_mises[nodes].mean() for nodes in body.elements])
    mesh = PolyCollection(cells, array=stress, cmap="viridis", edgecolors="white", linewidths=0.3)
    ax.add_collection(mesh)
    x = np.linspace(0, 40, 400)
    lowest = APEX[1] - LARGER * DEPTH
    roller = lowest + LARGER * (RADIUS - np.sqrt(RADIUS**2 - (x - APEX[0]) ** 2))
    ax.fill_between(x, roller, 30, color="0.82", zorder=0)
    ax.plot(x, roller, color="0.3", linewidth=1)
    closed = np.asarray(body.rows["node"])[answer.contact_set]
    ax.scatter(*moved[closed].T, s=12, color="tab:red", zorder=3, label="closed rows, all proven")
    ax.set(xlim=(-1, 41), ylim=(-1, 25), aspect="equal", xlabel="x (mm)", ylabel="y (mm)", title=f"body and obstacle, displacement x {LARGER:g}")
    ax.annotate("roller", (20, 22.8), ha="center")
    ax.legend(loc="lower left", fontsize=8)
    ax.figure.colorbar(mesh, ax=ax, label="von Mises stress (MPa)", orientation="horizontal", shrink=0.8)


def draw_pressure(ax: Any, coarse: Any, fine: Any) -> None:
    """Draws the contact pressure of the scene and of a mesh four times finer."""
    for answer, style in ((fine, {"color": "0.6", "label": "four times finer mesh"}), (coarse, {"marker": "o", "markersize": 4})):
        x = answer.scene.nodes[np.asarray(answer.scene.rows["node"]), 0]
        order = np.argsort(x)
        ax.plot(x[order], answer.pressure[order], **{"label": "this mesh", "color": "tab:red", **style})
    ax.set(xlim=(10, 30), ylim=(0, None), xlabel="x (mm)", ylabel="contact pressure (MPa)", title="contact pressure")
    ax.legend(fontsize=8)


def draw_force(ax: Any, found: list[Any]) -> None:
    """Draws the intervals that certainly contain the exact force, one for each goal, with the unknowns of its mesh."""
    for place, answer in enumerate(found):
        low, high = answer.force_interval
        ax.plot([place, place], [low, high], color="tab:blue", linewidth=4, solid_capstyle="butt")
        unknowns = answer.levels[-1]["dofs"]
        ax.annotate(f"{unknowns:,}\nunknowns", (place, high), (0, 4), textcoords="offset points", ha="center", fontsize=8)
    ax.set_xticks(range(len(GOALS)), [f"{100 * goal:g} %" for goal in GOALS])
    ax.set_xlim(-0.6, len(GOALS) - 0.4)
    ax.margins(y=0.2)
    ax.set(xlabel="goal of the total error", ylabel="force (N per mm)", title="guaranteed bounds of the force")


def main(file: str | None = None) -> list[tuple[float, float]]:
    """Draws into a file, if one is given; returns the intervals of the force, in N per mm of length."""
    coarse, fine = scene().solve(), scene(160).solve()
    found = [sg.total_error(scene(), goal) for goal in GOALS]
    if file is not None:
        figure, axes = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained", width_ratios=(1.3, 1, 1))
        draw_body(axes[0], coarse)
        draw_pressure(axes[1], coarse, fine)
        draw_force(axes[2], found)
        figure.savefig(file, dpi=110)
    return [tuple(answer.force_interval) for answer in found]


if __name__ == "__main__":
    print(main(*sys.argv[1:]))

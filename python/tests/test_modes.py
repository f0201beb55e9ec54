"""Natural vibrations of scenes, beside scipy on exported matrices."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse.linalg
import signorini as sg
from test_scene import program

BLOCK = {
    "body": {
        "rectangle": {"x": {"points": [0, 1], "divisions": [12]}, "y": {"points": [0, 0.5], "divisions": [6]}, "element": "q8"}
    },
    "material": {"young": 1e7, "poisson": 0.3, "density": 1000},
    "supports": [{"on": {"boundary": "left"}, "x": 0, "y": 0}],
    "loads": [{"traction": {"boundary": "top", "value": [0, -1000]}}],
    "obstacles": [
        {"boundary": "bottom", "approach": "-y", "shape": {"plane": {"point": [0, 0], "normal": [0, -1]}}}
    ],
}


def test_frequencies_are_those_of_scipy_on_exported_matrices(tmp_path: Path) -> None:
    found = sg.modes(sg.Scene(BLOCK), 6)
    assert not found["undecided"] and found["unproven"] is None
    assert found["is_complete"]
    scene = tmp_path / "block.json"
    scene.write_text(json.dumps(BLOCK | {"analysis": {"modes": {"count": 6}}}))
    subprocess.run([program(), "export", scene, tmp_path / "files"], check=True, capture_output=True)
    stiffness, mass, rows = (
        scipy.io.mmread(tmp_path / "files" / f"{name}.mtx").tocsc() for name in ["K", "M", "B"]
    )
    # Each closed row holds one dof of the plane.
    held = rows.tocsr()[found["closed"]].indices
    free = np.setdiff1d(np.arange(stiffness.shape[0]), held)
    values = scipy.sparse.linalg.eigsh(
        stiffness[free][:, free], k=6, M=mass[free][:, free], sigma=0, return_eigenvectors=False
    )
    exact = np.sqrt(np.sort(values)) / (2 * np.pi)
    np.testing.assert_allclose([mode["frequency"] for mode in found["modes"]], exact, rtol=1e-8)


def test_a_mode_has_mass_one() -> None:
    found = sg.modes(sg.Scene(BLOCK), 1)
    mode = found["modes"][0]
    # Corners and mid-sides of 12 x 6 cells.
    assert mode["displacement"].shape == (13 * 7 + 12 * 7 + 13 * 6, 2)
    assert mode["effective_mass"][0] == pytest.approx(mode["participation"][0] ** 2)
    assert mode["opens"]["amplitude"] > 0


def test_a_scene_without_density_is_refused() -> None:
    scene = json.loads(json.dumps(BLOCK))
    del scene["material"]["density"]
    with pytest.raises(sg.SceneError, match="an analysis needs a `density`"):
        sg.modes(sg.Scene(scene), 1)

"""Finds Young's modulus and the gap of a test from four measured forces, with their uncertainty.

A rigid cylinder is pressed into a rubber pad to four depths. The machine knows each step of its travel to a micrometre,
but neither where the cylinder first touches nor the modulus. Each force is measured to 2 %. The derivatives of the
forces, each with the proof that it exists, give the step of Gauss and Newton and the covariance.

Needs nothing but signorini: `pip install signorini`. Then run `python identify.py`.
"""

from __future__ import annotations

import numpy as np
import signorini as sg

# Travel from the first measurement, in m, and forces on a depth of 1 m, in N: made with 2.1 MPa and a first gap of -0.4 mm, plus noise.
STEPS = np.array([0.0, -0.0005, -0.0010, -0.0015])
FORCES = np.array([696.0, 1892.0, 3493.0, 5219.0])
SHARE = 0.02

PAD = {
    "title": "A cylinder on a pad",
    "model": "plane-strain",
    "body": {"rectangle": {"x": {"points": [0, 0.1], "divisions": [80]}, "y": {"points": [0, 0.03], "divisions": [24]}}},
    "material": {"young": 1e6, "poisson": 0.45},
    "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
    "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [0.05, 0.03], "radius": 0.05}}}],
}


def model(young: float, gap: float) -> tuple[np.ndarray, np.ndarray]:
    """The four forces, and their derivatives by modulus and gap."""
    forces, slopes = [], []
    for step in STEPS:
        scene = sg.Scene(PAD).with_parameter("young", young).with_parameter("gap", gap + step)
        (force,) = sg.sensitivity(scene, "force", ["young", "gap"])
        forces.append(force["value"])
        verdicts = [by["derivative"]["verdict"] for by in force["by"]]
        assert verdicts == ["proven", "proven"], verdicts
        slopes.append([by["derivative"]["value"] for by in force["by"]])
    return np.array(forces), np.array(slopes)


def identify() -> tuple[np.ndarray, np.ndarray, int]:
    """Modulus and gap, their covariance, and the number of steps of Gauss and Newton."""
    found, weights = np.array([1e6, -0.001]), 1.0 / (SHARE * FORCES)
    for step in range(1, 20):
        forces, slopes = model(*found)
        # Columns of one size: a modulus is about 1e9 times a gap.
        matrix = weights[:, None] * slopes * np.abs(found)
        change, *_ = np.linalg.lstsq(matrix, weights * (FORCES - forces), rcond=None)
        if np.max(np.abs(change)) < 1e-8:
            break
        found = found + np.abs(found) * np.clip(change, -0.5, 0.5)
    covariance = np.linalg.inv(matrix.T @ matrix) * np.outer(np.abs(found), np.abs(found))
    return found, covariance, step


if __name__ == "__main__":
    (young, gap), covariance, steps = identify()
    of_young, of_gap = np.sqrt(np.diag(covariance))
    correlation = covariance[0, 1] / (of_young * of_gap)
    print(f"after {steps} steps: E = {young / 1e6:.2f} MPa +- {of_young / 1e6:.2f}, gap = {gap * 1e3:.2f} mm +- {of_gap * 1e3:.2f}")
    print(f"correlation {correlation:.2f}: a stiffer pad that is touched later presses alike")

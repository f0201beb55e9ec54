"""Errors against the continuum, guaranteed or estimated, with the numbers of the program."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
import signorini as sg
from bodies import ROOT
from test_scene import program

COARSE = ROOT / "studies" / "guarantee" / "coarse.json"


def coarse(**changes: Any) -> sg.Scene:
    """The indentation of a block by a parabola in plane strain, on a coarse mesh, with other values at the top level."""
    return sg.Scene(json.loads(COARSE.read_text()) | changes)


def without_seconds(report: Any) -> Any:
    """The report without its times, which differ from run to run."""
    if isinstance(report, dict):
        return {name: without_seconds(value) for name, value in report.items() if not name.endswith("seconds")}
    return [without_seconds(entry) for entry in report] if isinstance(report, list) else report


def test_a_plane_scene_has_a_guaranteed_error_with_the_numbers_of_the_program() -> None:
    found = sg.total_error(coarse(), 0.05)
    assert isinstance(found, sg.TotalError)
    assert found.guaranteed and found.reason is None
    assert 0.0 < found.bound <= 0.05 and found.bound == found.levels[-1]["total_error"]
    assert (found.ended, found.status) == ("goal", "certified")
    errors = [level["total_error"] for level in found.levels]
    assert len(errors) > 2 and errors[0] > 0.05 >= errors[-1]
    assert found.force_interval is not None
    low, high = found.force_interval
    assert low <= high and found.levels[-1]["force_interval"] == [low, high]
    assert repr(found) == f"<signorini.TotalError: guaranteed at most {found.bound:.1e}, {len(errors)} meshes>".replace("e-0", "e-")

    command = [program(), "solve", COARSE, "--total-error", "0.05", "--format", "json"]
    of_program = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    own = found.to_dict()
    assert own["levels"] == found.levels and own["model"] == found.model
    assert without_seconds(own) == without_seconds({name: of_program[name] for name in own})


def test_the_answer_with_a_guarantee_is_a_displacement_of_triangles_with_six_nodes() -> None:
    found = sg.total_error(coarse(), 0.05)
    nodes, elements, moved = found.nodes, found.elements, found.displacement
    assert nodes.shape == moved.shape == (len(nodes), 2)
    assert elements.shape == (found.levels[-1]["elements"], 6)
    assert sorted(set(elements.flat)) == list(range(len(nodes)))
    corners, middles = nodes[elements[:, :3]], nodes[elements[:, 3:]]
    assert np.allclose(middles, (corners + np.roll(corners, -1, axis=1)) / 2, rtol=0, atol=1e-15)
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    assert np.isclose(np.sum(ax * by - ay * bx) / 2, 0.5) and np.all(ax * by > ay * bx)
    # The bottom is held; the obstacle presses the middle of the top down to its apex.
    assert np.all(moved[nodes[:, 1] == 0.0] == 0.0)
    assert np.isclose(moved[:, 1].min(), -0.01, rtol=0.05)


def test_the_solution_on_the_last_mesh_has_that_mesh() -> None:
    found = sg.total_error(coarse(), 0.1)
    solution = found.solution
    assert solution is not None and solution.certificate.meets(1e-9)
    scene = solution.scene
    assert np.array_equal(scene.nodes, found.nodes) and np.array_equal(scene.elements, found.elements)
    assert scene.problem.dofs == found.model["dofs"] == len(solution.u)
    assert repr(scene).endswith(f"about {2 * len(scene.nodes)} dofs>")
    # Its rows are at nodes, those of the bound between them too: both are within the error of each other.
    assert np.abs(solution.displacement - found.displacement).max() < 0.1 * np.abs(found.displacement).max()


def test_rows_along_normals_that_change_are_estimated_and_say_why() -> None:
    scene = sg.Scene(
        {
            "model": "axisymmetric",
            "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [0, 1], "divisions": [4]}}},
            "material": {"young": 1, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "y": 0}, {"on": {"boundary": "left"}, "x": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "rule": "closest-point",
                           "shape": {"parabola": {"apex": [0, 0.95], "radius": 1}}}],
        }
    )
    found = sg.total_error(scene, 0.2)
    assert not found.guaranteed and found.force_interval is None
    assert found.reason is not None and found.reason.startswith("obstacles[0].rule: ")
    assert found.bound <= 0.2 and found.status == "certified" and found.levels[-1]["energy_error_bound"] < 0.02
    solution = found.solution
    assert solution is not None
    assert np.array_equal(found.nodes, solution.scene.nodes) and np.array_equal(found.elements, solution.scene.elements)
    assert np.array_equal(found.displacement, solution.displacement)
    assert len(found.elements) == found.levels[-1]["elements"] and found.model["dofs"] == len(solution.u)
    assert repr(found).startswith("<signorini.TotalError: estimated ")
    with pytest.raises(sg.SceneError, match="without it the force has no bound"):
        sg.total_error(scene, 0.2, force_error=0.1)


def test_the_force_is_guaranteed_to_the_error_that_is_asked_for() -> None:
    found = sg.total_error(coarse(), 0.1, force_error=0.002)
    assert found.status == "certified" and found.force_interval is not None
    low, high = found.force_interval
    assert (high - low) / 2 <= 0.002 * found.levels[-1]["contact_force"]
    assert len(found.levels) > len(sg.total_error(coarse(), 0.1).levels)


@pytest.mark.parametrize("wrong", [-1, 0, 1, 2.5, float("nan"), float("inf")])
def test_an_error_that_is_no_relative_error_is_refused(wrong: float) -> None:
    with pytest.raises(sg.BadInput, match="goal is .*; it must be a number above 0 and below 1, such as 1e-2"):
        sg.total_error(coarse(), wrong)
    with pytest.raises(sg.BadInput, match="force_error is .*; it must be a number above 0 and below 1, such as 1e-2"):
        sg.total_error(coarse(), 0.1, force_error=wrong)


def test_arguments_of_a_wrong_kind_are_refused() -> None:
    with pytest.raises(sg.BadType, match="goal is of the type str; it must be a real number"):
        sg.total_error(coarse(), "small")  # type: ignore[arg-type]
    with pytest.raises(sg.BadInput, match="time is 0"):
        sg.total_error(coarse(), 0.1, time=0)
    with pytest.raises(sg.BadInput, match="threads is 0"):
        sg.total_error(coarse(), 0.1, threads=0)
    with pytest.raises(TypeError):
        sg.total_error({"gap": 1}, 0.1)  # type: ignore[arg-type]


def test_without_time_the_finest_mesh_until_then_is_returned() -> None:
    found = sg.total_error(coarse(), 1e-6, time=0.5)
    assert (found.ended, found.status) == ("time", "not_certified")
    assert found.guaranteed and 1e-6 < found.bound < 1.0 and found.levels


# Searches for an error that takes minutes, and sends an interrupt in the meantime.
INTERRUPTED = """
import os, signal, sys, threading
import signorini as sg

threading.Timer(float(sys.argv[2]), os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    sg.total_error(sg.Scene(sys.argv[1]), 1e-7)
except sg.Interrupted as stopped:
    found = stopped.solution
    print(found.guaranteed and found.status == "not_certified" and found.bound < 1.0 and len(found.nodes) > 0)
"""


def test_an_interrupt_carries_the_finest_mesh_until_then() -> None:
    # The first mesh takes a few hundredths of a second, with more on a busy machine.
    command = [sys.executable, "-c", INTERRUPTED, str(COARSE), "1.5"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert (ended.returncode, ended.stdout.strip()) == (0, "True"), ended.stderr

"""Derivatives of outputs of a scene."""

from __future__ import annotations

import numpy as np
import pytest
import signorini as sg

BAR = {
    "model": "bar",
    "gap": 0.001,
    "body": {"bar": {"area": 0.01, "x": {"points": [0, 2], "divisions": [4]}}},
    "material": {"young": 1e6, "poisson": 0},
    "supports": [{"on": {"boundary": "left"}, "x": 0}],
    "loads": [{"traction": {"boundary": "right", "value": [2000]}}],
    "obstacles": [{"boundary": "right", "approach": "+x", "shape": {"plane": {"point": [2], "normal": [1]}}}],
}


def test_a_bar_has_the_derivatives_of_its_closed_form() -> None:
    # It takes 20 N - E A/L g of the load: E A/L = 5000 N/m.
    scene = sg.Scene(BAR)
    (force,) = sg.sensitivity(scene, "force", ["gap", "young", "loads[0]", "nodes"])
    gap, young, load, nodes = force["by"]
    assert force["value"] == pytest.approx(15.0) and force["unit"] == "N"
    assert gap["derivative"] == {"verdict": "proven", "value": pytest.approx(-5000.0)}
    assert young["derivative"]["value"] == pytest.approx(-5e-6) and young["relative"]["value"] == pytest.approx(-1 / 3)
    assert load["derivative"]["value"] == pytest.approx(20.0)
    # A longer bar, with the wall where it is: the end moves into the wall.
    assert nodes["places"].shape == (5, 1) and nodes["places"][-1, 0] == pytest.approx(5000.0 + 5.0 / 2.0)


def test_a_bar_that_just_touches_has_two_derivatives() -> None:
    scene = sg.Scene(BAR).with_parameter("loads[0].value[0]", 500.0)
    (force,) = sg.sensitivity(scene, ["force"], ["loads[0]"])
    derivative = force["by"][0]["derivative"]
    # 5 N move the end to the wall, except for the rounding of 0.001.
    assert derivative["verdict"] in ("one-sided", "undecided", "proven")
    values = [value for key, value in derivative.items() if key in ("left", "right", "value")]
    values += derivative.get("between", [])
    assert all(np.isclose(value, 0.0) or np.isclose(value, 5.0) for value in values)


def test_names_that_do_not_exist_are_answered_with_those_that_do() -> None:
    scene = sg.Scene(BAR)
    with pytest.raises(sg.SceneError, match="`force`.*did you mean `force`"):
        sg.sensitivity(scene, "forse", "gap")
    with pytest.raises(sg.SceneError, match="`young`"):
        sg.sensitivity(scene, "force", "yuong")
    with pytest.raises(sg.BadType, match="of is of the type int"):
        sg.sensitivity(scene, 3)  # type: ignore[call-overload, arg-type, unused-ignore]
    with pytest.raises(sg.SceneError):
        scene.with_parameter("young", -1.0).problem  # noqa: B018
    assert "loads[0].value[0]" in scene.parameters and "strain-energy" in scene.outputs

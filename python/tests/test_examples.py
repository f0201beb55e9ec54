"""All examples run, and their results are those that their docstrings promise."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def example(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_membrane_of_scikit_fem_converges_to_its_closed_form() -> None:
    pytest.importorskip("skfem")
    module = example("skfem_obstacle")
    errors = [module.main(refinements) for refinements in (3, 4, 5)]
    # The sag converges nearly with the square of the cell size; the edge of the contact reduces the order slightly.
    assert errors[2] < 1e-3 and errors[0] / errors[2] > 8


def test_a_block_of_scikit_fem_has_the_force_of_the_scene() -> None:
    pytest.importorskip("skfem")
    by_skfem, by_scene = example("skfem_contact").main()
    assert abs(by_skfem - by_scene) < 1e-9 * by_scene


def test_two_blocks_of_scikit_fem_pass_a_pressure_without_error() -> None:
    for cells in [(5, 3), (3, 5), (1, 4), (8, 8)]:
        of_displacement, of_pressure = example("skfem_two_blocks").main(cells)
        # Rounding of a solve.
        assert of_displacement < 1e-11 and of_pressure < 1e-9


def test_signorini_is_a_solver_of_qpsolvers_and_agrees_with_cvxpy() -> None:
    pytest.importorskip("qpsolvers")
    pytest.importorskip("cvxpy")
    objectives = example("qpsolvers_and_cvxpy").main()
    own = objectives.pop("signorini by qpsolvers")
    assert objectives and all(own <= other + 1e-6 * abs(other) for other in objectives.values())


def test_coordinates_give_multigrid_the_rigid_body_modes() -> None:
    pytest.importorskip("skfem")
    assert example("rigid_modes").main(6) < 1e-7


def test_a_mesh_of_gmsh_becomes_a_scene() -> None:
    pytest.importorskip("meshio")
    answer = example("mesh_to_scene").main()
    forces = {resultant["of"]: np.array(resultant["force"]) for resultant in answer.resultants}
    assert forces["obstacles[0]"][1] < 0 and answer.certificate.meets(1e-9)
    assert np.allclose(forces["obstacles[0]"] + forces["supports[0]"], 0.0, atol=1e-6 * answer.contact_force)


def test_the_notebook_runs() -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    notebook = nbformat.read(EXAMPLES / "indentation.ipynb", as_version=4)
    nbclient.NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(EXAMPLES)}}).execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in shown) == 3
    assert any("closed rows" in output.get("data", {}).get("text/html", "") for output in shown)


def test_modulus_and_gap_follow_from_four_forces_within_their_uncertainty() -> None:
    (young, gap), covariance, steps = example("identify").identify()
    off = np.abs(np.array([young - 2.1e6, gap + 0.0004])) / np.sqrt(np.diag(covariance))
    # The forces have errors of up to twice their standard deviation.
    assert np.all(off < 3.0) and steps < 12


def test_the_picture_of_the_readme_has_narrower_and_narrower_bounds_of_one_force() -> None:
    pytest.importorskip("matplotlib")
    intervals = example("front_picture").main()
    widths = [high - low for low, high in intervals]
    assert all(later <= former for former, later in zip(widths, widths[1:])) and widths[-1] < 0.1 * widths[0]
    # One number lies in all of them: the exact force.
    assert max(low for low, _ in intervals) < min(high for _, high in intervals)

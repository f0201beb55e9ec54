"""Scenes: their solutions have the same bits as those of the program, and their forces and stresses are consistent."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import signorini as sg
from bodies import ROOT

sys.path.append(str(ROOT / "reference"))
import cases  # noqa: E402
from problem import write_problem  # noqa: E402

# All scenes without a motion.
SCENES = [
    scene
    for scene in sorted([*ROOT.glob("examples/**/*.json"), *ROOT.glob("studies/*/*.json"), *ROOT.glob("tests/corpus/*.json")])
    if '"analysis"' not in scene.read_text()
]
REFERENCE = [case for case in cases.RAW_CASES if case.generate is not None]
FINDINGS = sorted(folder for folder in (ROOT / "tests" / "corpus" / "findings").iterdir() if (folder / "K.mtx").exists())


def program() -> Path:
    """Returns the path of the program that the tests of the root have built."""
    built = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    found = [built / profile / "signorini" for profile in ("debug", "release")]
    there = [path for path in found if path.exists()]
    if not there:
        pytest.skip("the program is not built: cargo build")
    return there[0]


def column(file: Path) -> np.ndarray:
    """Reads a vector in Matrix Market form with all its digits."""
    lines = [line for line in file.read_text().splitlines() if not line.startswith("%")]
    return np.array([float(line) for line in lines[1:]])


# The exceptions that correspond to each exit code of the program.
ENDINGS = {1: (sg.BadInput, sg.NumericalError, sg.TooLarge), 3: (sg.Infeasible, sg.Unbounded, sg.UnderHeld)}


def run(target: Path, out: Path, method: str = "auto") -> tuple[int, dict[str, Any]]:
    """Returns the exit code and the report of `signorini solve`."""
    solve = [program(), "solve", target, "--method", method, "--out", out, "--format", "json"]
    command = [*solve, "--pictures", "none", "--max-memory", "8GB"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    return ended.returncode, json.loads(ended.stdout) if ended.stdout else {}


def agree(code: int, solve: Callable[[], sg.Solution], out: Path) -> sg.Solution | None:
    """Compares a solution with the files of the program, bit by bit, or an exception with its exit code."""
    if code in ENDINGS:
        with pytest.raises(ENDINGS[code]):
            solve()
        return None
    try:
        answer = solve()
        assert code == 0
    except sg.NotCertified as fell_short:
        assert code == 4
        answer = fell_short.solution
    except sg.Undecided:
        assert code == 4 and not (out / "u.mtx").exists()
        return None
    assert np.array_equal(answer.u, column(out / "u.mtx"))
    assert np.array_equal(answer.multiplier, column(out / "lambda.mtx"))
    return answer


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_an_answer_has_the_bits_of_the_program(scene: Path, tmp_path: Path) -> None:
    code, reported = run(scene, tmp_path)
    answer = agree(code, lambda: sg.Scene(scene).solve(memory=8e9), tmp_path)
    if answer is None:
        return
    report = answer.report()
    same = ("status", "method", "iterations", "certificate", "contact", "model", "resultants", "segments", "proven", "warnings")
    for name in same:
        assert report.get(name) == reported.get(name), name


def of_folder(folder: Path) -> sg.Problem:
    """Returns the problem of a directory, read by scipy."""
    from scipy.io import mmread

    near_null = None
    if (folder / "near_null.mtx").exists():
        near_null = mmread(folder / "near_null.mtx")
    f, g = (np.asarray(mmread(folder / name)).ravel() for name in ("f.mtx", "g.mtx"))
    return sg.Problem(mmread(folder / "K.mtx"), f, mmread(folder / "B.mtx"), g, near_null)


def same_as_program(folder: Path, out: Path, method: str = "auto") -> None:
    code, _ = run(folder, out, method)
    agree(code, lambda: sg.solve(of_folder(folder), method=method, memory=8e9), out)


@pytest.mark.parametrize("scene", SCENES, ids=lambda path: path.stem)
def test_an_exported_problem_has_the_bits_of_the_program(scene: Path, tmp_path: Path) -> None:
    exported = subprocess.run([program(), "export", scene, tmp_path / "problem"], capture_output=True, check=False)
    if exported.returncode == 0:
        same_as_program(tmp_path / "problem", tmp_path / "out")


@pytest.mark.parametrize("case", REFERENCE, ids=lambda case: case.name)
def test_a_reference_problem_has_the_bits_of_the_program(case: cases.Case, tmp_path: Path) -> None:
    write_problem(case.generate(), tmp_path / "problem")
    for method in ("auto", "qp", "active-set", "penalty"):
        same_as_program(tmp_path / "problem", tmp_path / method, method)


@pytest.mark.parametrize("folder", FINDINGS, ids=lambda folder: folder.name)
def test_a_problem_that_once_revealed_a_fault_has_the_bits_of_the_program(folder: Path, tmp_path: Path) -> None:
    same_as_program(folder, tmp_path / "out")


def block(gap: float = -0.01) -> dict:
    return {
        "title": "Block under a plane",
        "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [0, 1], "divisions": [4]}}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
        "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"plane": {"point": [0, 1], "normal": [0, 1]}}}],
        "gap": gap,
    }


def test_a_dictionary_is_a_scene_and_may_hold_numbers_of_numpy() -> None:
    scene = block()
    scene["gap"] = np.float64(-0.01)
    scene["body"]["rectangle"]["x"]["points"] = np.array([0.0, 1.0])
    answer = sg.Scene(scene).solve()
    assert np.array_equal(answer.u, sg.Scene(block()).solve().u)
    assert repr(sg.Scene(scene)) == "<signorini.Scene: Block under a plane, about 50 dofs>"


def test_forces_pressures_and_stresses_of_an_answer_are_consistent() -> None:
    scene = sg.Scene(block())
    answer = scene.solve()
    nodes, rows = scene.nodes, scene.rows
    assert nodes.shape == (25, 2) and scene.elements.shape == (16, 4) and scene.element_kinds == ["Q4"] * 16
    assert answer.displacement.shape == nodes.shape and answer.stress.shape == (25, 6) and answer.element_stress.shape == (16, 6)
    assert rows["node"].shape == answer.pressure.shape == (5,) and rows["normal"].shape == (5, 2)
    # All five nodes of the top are in contact and are displaced by the gap.
    assert np.allclose(answer.displacement[rows["node"], 1], -0.01, atol=1e-14)
    assert np.allclose(answer.remaining_gap, 0.0, atol=1e-14)
    assert np.allclose(answer.pressure * rows["area"], -answer.multiplier)
    # Contact forces and reactions are in balance; the resultant of the obstacle is the sum of the contact forces.
    assert np.allclose(answer.contact_forces.sum(axis=0) + answer.reactions.sum(axis=0), 0.0, atol=1e-6)
    obstacle = next(of for of in answer.resultants if of["of"] == "obstacles[0]")
    assert np.allclose(obstacle["force"], answer.contact_forces.sum(axis=0), atol=1e-6)
    assert np.isclose(answer.contact_force, -obstacle["force"][1])
    xx, yy, zz, xy = answer.stress[:, :4].T
    assert np.allclose(answer.von_mises, np.sqrt(xx**2 + yy**2 + zz**2 - xx * yy - yy * zz - zz * xx + 3 * xy**2))
    assert answer.scene.title == "Block under a plane" and "peak pressure" in answer._repr_html_()


def test_the_problem_of_a_scene_has_the_same_solution_as_the_scene() -> None:
    scene = sg.Scene(block())
    problem = scene.problem
    assert problem.dofs == 40 and problem.row_count == 5 and problem.near_null.shape == (40, 3)
    assert np.array_equal(sg.solve(problem).u, scene.solve().u)
    assert np.array_equal(problem.g, np.full(5, -0.01))
    assert scene.units == {"length": "m", "force": "N", "pressure": "Pa"}


def test_methods_are_compared_on_a_scene() -> None:
    comparison = sg.Scene(block()).compare()
    assert comparison.agrees and isinstance(comparison.qp, sg.SceneSolution)
    assert np.allclose(comparison.qp.pressure, comparison.active_set.pressure, rtol=1e-7)


def test_a_sweep_finds_the_events_between_its_gaps() -> None:
    sweep = sg.sweep(sg.Scene(ROOT / "examples" / "indentation.json"), [-0.01, -0.05, -0.1])
    assert sweep.gaps == [-0.01, -0.05, -0.1] and len(sweep.solutions) == 3 and sweep.events
    assert (np.diff(sweep.contact_force) > 0).all()
    assert {event["touches"] for event in sweep.events} <= {True, False}


def pressed() -> dict:
    scene = block(gap=0.0)
    scene["obstacles"][0] = {"boundary": "top", "approach": "+y", "shape": {"circle": {"apex": [0.5, 1.003], "radius": 1}}, "force": 1}
    del scene["gap"]
    return scene


def test_a_sweep_over_forces_has_the_bits_of_the_program(tmp_path: Path) -> None:
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(pressed()))
    command = [program(), "sweep", file, "--forces", "0:2e4:5", "--format", "json"]
    reported = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["points"]
    sweep = sg.sweep(sg.Scene(file), forces=np.linspace(0.0, 2e4, 5))
    assert sweep.forces == [point["force"] for point in reported] == [0.0, 5e3, 1e4, 1.5e4, 2e4]
    assert [answer.resultants for answer in sweep.solutions] == [point["resultants"] for point in reported]
    assert np.allclose(sweep.contact_force, sweep.forces, rtol=0, atol=1e-5) and not sweep.events
    # Without a force the obstacle stays at its first contact.
    assert abs(sweep.solutions[0].resultants[0]["travel"] - 0.003) < 1e-15


def test_a_sweep_to_another_end_has_the_bits_of_the_program(tmp_path: Path) -> None:
    from scipy.io import mmwrite

    problem = cases.elastic_block.indentation(-0.02, columns=8, layers=4)
    write_problem(problem, tmp_path)
    g1, f1 = problem.gap - 0.03, problem.load - 10.0
    mmwrite(tmp_path / "g1.mtx", g1.reshape(-1, 1), precision=17)
    for other_load in (False, True):
        if other_load:
            mmwrite(tmp_path / "f1.mtx", f1.reshape(-1, 1), precision=17)
        command = [program(), "sweep", tmp_path, "--points", "4", "--format", "json", "--out", tmp_path / "out"]
        reported = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        sweep = sg.sweep(of_folder(tmp_path), g1=g1, f1=f1 if other_load else None, points=4)
        assert sweep.t == [point["t"] for point in reported["points"]]
        assert sweep.events == reported.get("events", []) and bool(sweep.events) != other_load
        for number, answer in enumerate(sweep.solutions, start=1):
            assert np.array_equal(answer.u, column(tmp_path / "out" / f"point-{number:02}" / "u.mtx"))
            assert np.array_equal(answer.multiplier, column(tmp_path / "out" / f"point-{number:02}" / "lambda.mtx"))


def test_pictures_of_sweeps_name_the_swept_quantity_on_their_axis() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    scene = sg.Scene(pressed())
    for sweep, names in (
        (sg.sweep(scene, forces=[0.0, 1e4]), ("force [N]", "travel [m]")),
        (sg.sweep(sg.Scene(block()), [-0.01, -0.02]), ("gap [m]", "contact force [N]")),
        (sg.sweep(scene.problem, g1=scene.problem.g, points=2), ("way t", "contact force")),
        (sg.sweep(scene.problem, [scene.problem.g]), ("number of the gap", "contact force")),
    ):
        axes = sweep.plot()
        assert (axes.get_xlabel(), axes.get_ylabel()) == names and len(axes.lines[-1].get_xdata()) == len(sweep.solutions)


def test_errors_in_a_scene_name_path_line_and_column(tmp_path: Path) -> None:
    scene = block()
    scene["material"]["young"] = -1
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(scene, indent=1))
    with pytest.raises(sg.SceneError) as raised:
        sg.Scene(file).problem
    assert raised.value.path == "material.young" and raised.value.line and raised.value.column
    with pytest.raises(sg.SceneError) as raised:
        sg.Scene(scene).solve()
    assert raised.value.path == "material.young" and raised.value.line is None
    with pytest.raises(sg.SceneError, match="unknown key"):
        sg.Scene({**block(), "colour": "red"})
    with pytest.raises(sg.SceneError, match="friction is not modelled"):
        sg.Scene({**block(), "friction": 0.3})


def test_a_scene_without_supports_names_its_motion() -> None:
    scene = block()
    scene["supports"] = []
    with pytest.raises((sg.UnderHeld, sg.Unbounded), match="translation|rotation"):
        sg.Scene(scene).solve()


def test_a_scene_with_a_motion_is_refused() -> None:
    moving = next((ROOT / "studies" / "impact").glob("*.json"))
    with pytest.raises(sg.SceneError, match="the scene moves"):
        sg.Scene(moving).solve()


def test_a_picture_of_a_scene_shows_its_mesh() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = sg.Scene(block()).solve().plot()
    assert len(axes.collections[0].get_paths()) == 16 and axes.get_title() == "Block under a plane"


class Grid:
    """A replacement for `pyvista.UnstructuredGrid`, which needs VTK (600 MB). It takes node tables by cell type, and points in space."""

    def __init__(self, cells: dict[int, np.ndarray], points: np.ndarray) -> None:
        assert points.shape[1] == 3 and all(0 <= nodes.min() and nodes.max() < len(points) for nodes in cells.values())
        self.cells_dict, self.points, self.point_data = cells, points, {}


# The names that meshio gives to the cell types; it maps them to the numbers of VTK.
CELLS = {
    "Line2": "line", "Line3": "line3", "T3": "triangle", "T6": "triangle6", "Q4": "quad", "Q8": "quad8",
    "Tet4": "tetra", "Tet10": "tetra10", "Hex8": "hexahedron", "Hex20": "hexahedron20",
}  # fmt: skip


def test_the_numbers_of_the_cell_types_are_those_of_vtk() -> None:
    from meshio._vtk_common import meshio_to_vtk_type
    from signorini import _show

    assert _show._VTK == {kind: meshio_to_vtk_type[name] for kind, name in CELLS.items()}


@pytest.mark.parametrize("stands_in", [True, False], ids=["stand-in", "pyvista"])
def test_a_grid_of_pyvista_has_the_mesh_and_the_fields(stands_in: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if stands_in:
        monkeypatch.setitem(sys.modules, "pyvista", SimpleNamespace(UnstructuredGrid=Grid))
    else:
        pytest.importorskip("pyvista")
    answer = sg.Scene(block()).solve()
    grid = answer.to_pyvista()
    (kind, cells), fields = *grid.cells_dict.items(), grid.point_data
    assert kind == 9 and np.array_equal(cells, answer.scene.elements)
    assert np.array_equal(grid.points, np.pad(answer.scene.nodes, ((0, 0), (0, 1))))
    assert np.array_equal(fields["displacement"], np.pad(answer.displacement, ((0, 0), (0, 1))))
    assert np.array_equal(fields["stress"], answer.stress) and np.array_equal(fields["von_mises"], answer.von_mises)


DECK = """*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=BASE
1, 2, 3, 4
*NSET, NSET=TOP
5, 6, 7
*MATERIAL, NAME=M
*ELASTIC
200., 0.
*SOLID SECTION, ELSET=E, MATERIAL=M
*BOUNDARY
BASE, 1, 3
*STEP
*STATIC
*BOUNDARY
TOP, 3, 3, 0.01
*END STEP
*STEP, NLGEOM
*STATIC
*BOUNDARY
TOP, 3, 3, 0.2
*END STEP
"""


def test_a_solution_beyond_small_displacements_is_carried_by_its_exception(tmp_path: Path) -> None:
    deck = tmp_path / "cube.inp"
    deck.write_text(DECK.replace("0.01", "2."))
    with pytest.raises(sg.BeyondSmallDisplacements, match="small displacements do not describe") as raised:
        sg.Scene(deck, step=1).solve()
    assert raised.value.code == "beyond-small-displacements"
    carried = raised.value.solution
    assert isinstance(carried, sg.SceneSolution) and carried.report()["status"] == "beyond-small-displacements"
    solution = sg.Scene(deck, step=1, linear=True).solve()
    np.testing.assert_array_equal(solution.displacement, carried.displacement)
    assert solution.report()["status"] == "certified"


def test_a_deck_is_read_up_to_a_step(tmp_path: Path) -> None:
    deck = tmp_path / "cube.inp"
    deck.write_text(DECK)
    first = sg.Scene(deck, step=1).solve()
    assert np.abs(first.displacement).max() == pytest.approx(0.01, rel=1e-9)
    with pytest.raises(sg.BadInput, match="above 5 % of either"):
        sg.Scene(deck).solve()
    last = sg.Scene(deck, linear=True).solve()
    np.testing.assert_allclose(last.displacement, 20 * first.displacement, rtol=1e-9, atol=1e-12)
    with pytest.raises(sg.BadInput, match="the deck has no step 3; its steps are 1 to 2"):
        sg.Scene(deck, step=3)

"""Solutions, prepared problems and studies, compared with closed forms and with each other."""

from __future__ import annotations

import numpy as np
import pytest
import signorini as sg
from bodies import bar, membrane, two_springs


@pytest.mark.parametrize("method", ["auto", "qp", "active-set", "active_set", "penalty", "mprgp"])
def test_every_method_presses_the_springs_against_the_wall(method: str) -> None:
    try:
        answer = sg.solve(two_springs(), method=method)
    except sg.NotCertified as fell_short:
        # Only the penalty method is inexact by design.
        assert method == "penalty"
        answer = fell_short.solution
    assert np.allclose(answer.u, [1 / 3, 1.0], rtol=1e-7) and np.allclose(answer.multiplier, [-7 / 3], rtol=1e-7)
    assert answer.contact_set.tolist() == [0] and abs(answer.contact_force - 7 / 3) < 1e-7
    assert answer.method.startswith(method.replace("_", "-")) or method == "auto"
    assert answer.seconds > 0.0 and answer.why


def test_an_answer_has_proven_rows_and_an_error_bound() -> None:
    K, f, B, g = membrane(12)
    answer = sg.solve(sg.Problem(K, f, B, g))
    proven = answer.proven
    assert proven is not None
    assert len(proven.open) + len(proven.closed) + len(proven.undecided) == len(g)
    assert set(proven.closed) <= set(answer.contact_set) and not set(proven.open) & set(answer.contact_set)
    assert answer.certificate.meets(1e-9) and answer.certificate.worst[1] <= 1e-9
    assert answer.energy_error_bound == answer.certificate.energy_error_bound < 1e-9
    assert sg.solve(sg.Problem(K, f, B, g), proof=False).proven is None
    assert answer.to_dict()["certificate"] == answer.certificate.to_dict()
    assert answer.history[-1][0].tolist() == answer.contact_set.tolist()


def test_arrays_of_an_answer_are_kept_and_cannot_be_changed() -> None:
    answer = sg.solve(two_springs())
    assert answer.u is answer.u
    with pytest.raises(ValueError, match="read-only"):
        answer.u[0] = 1.0


def test_verify_accepts_the_right_answer_and_rejects_wrong_ones() -> None:
    problem = two_springs()
    right = sg.verify(problem, [1 / 3, 1.0], [-7 / 3])
    assert right.meets(1e-9)
    assert not sg.verify(problem, [1 / 3, 1.01], [-7 / 3]).meets(1e-3)
    assert sg.verify(problem, [1.5, 4.5], [0.0]).penetration > 0.5
    assert sg.verify(problem, [1 / 3, 1.0], [-7 / 3]) == right


def test_a_start_changes_iterations_and_not_the_answer() -> None:
    K, f, B, g = membrane(20)
    problem = sg.Problem(K, f, B, g)
    known = sg.solve(problem, method="active-set")
    for start in (known, known.contact_set, known.u):
        again = sg.solve(problem, method="active-set", start=start)
        assert np.allclose(again.u, known.u, rtol=0, atol=1e-13)
    assert sg.solve(problem, method="active-set", start=known).iterations < known.iterations


def test_one_factor_serves_gaps_loads_and_starts() -> None:
    K, f, B, _ = bar(6)
    prepared = sg.prepare(sg.Problem(K, f, B, [1.0]))
    for gap in (0.5, 1.0, 2.0, 4.0):
        answer = prepared.solve([gap])
        assert abs(answer.u[-1] - min(gap, 3.0)) < 1e-12
        assert abs(answer.contact_force - max(3.0 - gap, 0.0)) < 1e-12
    last = prepared.solve(g=[2.0], f=2 * f, start=answer)
    assert abs(last.contact_force - 4.0) < 1e-12
    assert prepared.dofs == 6 and prepared.condensed_dofs <= 6 and prepared.seconds >= 0.0
    assert repr(prepared).startswith("<signorini.Prepared: 6 dofs")


def test_a_contact_problem_is_a_complementarity_problem_in_its_forces() -> None:
    K, f, B, g = membrane(8)
    problem = sg.Problem(K, f, B, g)
    lcp, answer = sg.prepare(problem).delassus(), sg.solve(problem)
    W = lcp.M.toarray()
    assert np.array_equal(W, W.T) and lcp.rows.tolist() == list(range(len(g))) and len(lcp.motions) == 0
    assert np.allclose(W, problem.B @ np.linalg.solve(problem.K.toarray(), problem.B.T.toarray()), rtol=1e-11, atol=0)
    z = -answer.multiplier
    w = W @ z + lcp.q
    assert w.min() > -1e-12 and abs(w * z).max() < 1e-12 and answer.contact_set.size > 0
    assert np.allclose(lcp.displacement(z), answer.u, rtol=0, atol=1e-12)
    assert (lcp.lower == 0).all() and np.isinf(lcp.upper).all()
    with pytest.raises(sg.BadInput, match="unknowns x"):
        lcp.displacement([0.0])
    with pytest.raises(sg.TooLarge):
        sg.prepare(problem, memory=1e3).delassus()


def test_a_path_finds_the_gap_at_which_the_end_touches() -> None:
    K, f, B, _ = bar(4)
    path = sg.prepare(sg.Problem(K, f, B, [4.0])).path([4.0], [2.0])
    assert len(path.events) == 1
    event = path.events[0]
    assert abs(event.at - 0.5) < 1e-12 and event.row == 0 and event.touches
    assert np.allclose(path.corners, [0.0, 0.5, 1.0], atol=1e-12)
    assert abs(path.multiplier(0.75)[0] + 0.5) < 1e-12 and path.multiplier(0.25)[0] == 0.0
    assert path.gap(0.75).tolist() == [2.5] and path.contact_set(1.0).tolist() == [0]
    assert abs(path.solution(0.75).u[-1] - 2.5) < 1e-12
    with pytest.raises(sg.BadInput, match="t is 2; it must be from 0"):
        path.gap(2.0)


def test_methods_are_compared_and_agree() -> None:
    K, f, B, g = membrane(12)
    comparison = sg.compare(sg.Problem(K, f, B, g))
    assert comparison.agrees
    assert np.allclose(comparison.qp.u, comparison.active_set.u, atol=1e-10)
    assert comparison.agreement["active_set"]["rows"] == 0
    assert comparison.penalty.method.startswith("penalty")


def test_a_tradeoff_has_points_advice_and_a_picture() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    K, f, B, g = membrane(8)
    tradeoff = sg.tradeoff(sg.Problem(K, f, B, g), runs=1)
    assert {point["method"] for point in tradeoff.points} >= {"qp", "active-set", "penalty"}
    assert len(tradeoff.meshes) == 1 and tradeoff.advice
    axes = tradeoff.plot()
    assert axes.get_xlabel() == "seconds" and len(axes.lines) > 3


def test_a_sweep_over_gaps_of_a_problem_gives_one_answer_per_gap() -> None:
    K, f, B, _ = bar(4)
    sweep = sg.sweep(sg.Problem(K, f, B, [1.0]), [[0.5], [1.5], [3.5]])
    assert np.allclose(sweep.contact_force, [2.5, 1.5, 0.0], atol=1e-12)


def test_a_sweep_to_other_gaps_finds_the_gap_at_which_the_end_touches() -> None:
    K, f, B, _ = bar(4)
    problem = sg.Problem(K, f, B, [4.0])
    sweep = sg.sweep(problem, g1=[2.0], points=5)
    assert sweep.t == [0.0, 0.25, 0.5, 0.75, 1.0] and [gap.tolist() for gap in sweep.gaps] == [[4.0], [3.5], [3.0], [2.5], [2.0]]
    assert np.allclose(sweep.contact_force, [0.0, 0.0, 0.0, 0.5, 1.0], atol=1e-12)
    assert len(sweep.events) == 1 and abs(sweep.events[0]["t"] - 0.5) < 1e-12 and sweep.events[0]["touches"]
    assert repr(sweep) == "<signorini.Sweep: 5 points, 1 events>"
    # The load doubles while the gap opens: force 3 (1 + t) - (1 + t) = 2 (1 + t).
    stronger = sg.sweep(problem.replace(g=[1.0]), g1=[2.0], f1=2 * f, points=3)
    assert np.allclose(stronger.contact_force, [2.0, 3.0, 4.0], atol=1e-12) and not stronger.events


def test_a_sweep_keeps_rows_without_an_obstacle_and_refuses_to_change_them() -> None:
    K, f, B, _ = bar(4)
    both = sg.Problem(K, f, np.vstack([B.toarray(), -B.toarray()]), [4.0, np.inf])
    assert np.allclose(sg.sweep(both, g1=[2.0, np.inf], points=3).contact_force, [0.0, 0.0, 1.0], atol=1e-12)
    with pytest.raises(sg.BadInput, match="the gap of row 1 goes from inf to 3"):
        sg.sweep(both, g1=[2.0, 3.0])


def test_limits_of_time_and_accuracy_are_kept() -> None:
    K, f, B, g = membrane(30)
    problem = sg.Problem(K, f, B, g)
    assert sg.solve(problem, accuracy=1e-3).energy_error_bound <= 1e-3
    exact = sg.solve(problem, accuracy="exact", threads=2, tolerance=1e-10, precision="double", condense=False)
    assert exact.method.startswith("active-set") and exact.certificate.meets(1e-10)
    try:
        assert sg.solve(problem, time=1e-9).certificate.meets(1e-9)
    except (sg.NotCertified, sg.OutOfTime) as error:
        assert str(error)


def test_pictures_of_an_answer_show_every_row() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    K, f, B, g = membrane(6)
    answer = sg.solve(sg.Problem(K, f, B, g))
    still, pressed = (len(points.get_offsets()) for points in answer.plot().collections)
    assert (still, pressed) == (len(g) - len(answer.contact_set), len(answer.contact_set)) and pressed > 1

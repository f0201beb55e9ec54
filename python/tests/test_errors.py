"""Problems without a solution raise an exception that carries a proof, and every exception has the expected base classes."""

from __future__ import annotations

import numpy as np
import pytest
import signorini as sg
from bodies import bar, membrane


def test_contradictory_rows_raise_infeasible_with_farkas_weights() -> None:
    K, f, _, _ = bar(3)
    B = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    with pytest.raises(sg.Infeasible) as raised:
        sg.solve(sg.Problem(K, f, B, [-1.0, 0.5]))
    error = raised.value
    assert sorted(error.rows) == [0, 1] and error.code == "infeasible"
    assert np.allclose(error.weights @ B[error.rows], 0.0) and (error.weights >= 0).all()
    assert error.weights @ np.array([-1.0, 0.5])[error.rows] < 0 and abs(error.overlap - 0.5) < 1e-12


def test_an_unbounded_problem_names_its_direction() -> None:
    K = np.array([[1.0, -1.0], [-1.0, 1.0]])
    with pytest.raises(sg.Unbounded) as raised:
        sg.solve(sg.Problem(K, [1.0, 1.0], [[-1.0, 0.0]], [0.0]))
    d = raised.value.direction
    assert np.allclose(K @ d, 0.0, atol=1e-12) and d @ [1.0, 1.0] > 0 and raised.value.motion


def test_an_insufficiently_supported_body_names_its_free_motion() -> None:
    K = np.array([[1.0, -1.0], [-1.0, 1.0]])
    with pytest.raises(sg.UnderHeld) as raised:
        sg.solve(sg.Problem(K, [0.0, 0.0]))
    d = raised.value.direction
    assert np.allclose(K @ d, 0.0, atol=1e-12) and abs(d).max() > 0 and raised.value.motion


def test_the_exception_of_an_uncertified_answer_carries_the_answer() -> None:
    K, f, B, g = membrane(10)
    with pytest.raises(sg.NotCertified) as raised:
        sg.solve(sg.Problem(K, f, B, g), method="penalty", tolerance=1e-14)
    error = raised.value
    assert error.value > error.tolerance == 1e-14 and error.condition
    assert np.isfinite(error.solution.u).all() and len(error.solution.u) == len(f)


def test_an_indefinite_stiffness_is_not_convex() -> None:
    with pytest.raises(sg.NotConvex):
        sg.solve(sg.Problem(np.array([[1.0, 2.0], [2.0, 1.0]]), [1.0, 0.0], np.eye(2), [1.0, 1.0]))


def test_a_problem_that_does_not_fit_into_memory_raises_a_memory_error() -> None:
    K, f, B, g = membrane(60)
    with pytest.raises(MemoryError) as raised:
        sg.solve(sg.Problem(K, f, B, g), memory=1000.0)
    assert isinstance(raised.value, sg.TooLarge) and raised.value.allowed == 1000.0


def test_exceptions_have_the_base_classes_that_callers_catch() -> None:
    assert issubclass(sg.BadInput, ValueError) and issubclass(sg.BadType, (TypeError, ValueError))
    assert issubclass(sg.TooLarge, MemoryError) and issubclass(sg.FileError, OSError)
    assert issubclass(sg.OutOfTime, TimeoutError) and issubclass(sg.Interrupted, KeyboardInterrupt)
    assert not issubclass(sg.Interrupted, Exception)
    for name in ("Infeasible", "Unbounded", "UnderHeld", "Undecided", "NotCertified", "NotConvex"):
        assert issubclass(getattr(sg, name), sg.SignoriniError)
    for name in ("NumericalError", "InternalError"):
        assert issubclass(getattr(sg, name), sg.SignoriniError)

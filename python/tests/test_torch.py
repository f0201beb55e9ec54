"""Contact problems as functions of torch: gradients against differences, and kinks. Skipped where torch is not installed."""

from __future__ import annotations

import doctest

import numpy as np
import pytest
import signorini as sg
from bodies import membrane
from scipy import sparse
from test_derivatives import touching
from test_many import family

torch = pytest.importorskip("torch")
contact = pytest.importorskip("signorini.torch")


def test_gradients_by_all_data_are_those_of_differences() -> None:
    Ks, fs, Bs, gs = family(5)
    given = [(K, f, B, g) for K, f, B, g in zip(Ks, fs, Bs, gs, strict=True)][:3]
    problems = [(contact.Pattern.of(K, B), (K.ravel(), f, B.ravel(), g)) for K, f, B, g in given]
    K, f, B, g = membrane(5)
    rows = sparse.csr_array(B[:6])
    problems.append((contact.Pattern.of(K, rows), (K.data, f * 1.3, rows.data, g[:6])))
    for pattern, values in problems:
        tensors = tuple(torch.tensor(value, requires_grad=True) for value in values)
        assert torch.autograd.gradcheck(lambda *tensors, pattern=pattern: contact.solve(pattern, *tensors), tensors, rtol=1e-4, atol=1e-7)


def test_a_kink_raises_unless_a_piece_is_chosen() -> None:
    problem = touching()
    K, B = problem.K.toarray(), problem.B.toarray()
    pattern = contact.Pattern.of(K, B)
    stiffness, rows, gap = (torch.tensor(value) for value in (K.ravel(), B.ravel(), np.array(problem.g)))

    def gradient(**options: str) -> np.ndarray:
        load = torch.tensor(np.array(problem.f), requires_grad=True)
        contact.solve(pattern, stiffness, load, rows, gap, **options)[0][1].backward()
        return load.grad.numpy()

    with pytest.raises(sg.NoDerivative, match="row 0 "):
        gradient()
    assert np.allclose(gradient(at_kink="open"), [0.5, 1.5]) and np.allclose(gradient(at_kink="closed"), [0.0, 0.0])


def test_arguments_that_do_not_fit_are_refused() -> None:
    pattern = contact.Pattern.of(np.eye(2), np.ones((1, 2)))
    good = [torch.ones(4, dtype=torch.float64), *(torch.ones(length, dtype=torch.float64) for length in (2, 2, 1))]
    for place, value, words in (
        (0, torch.ones(3, dtype=torch.float64), "stiffness has the shape"),
        (1, torch.ones(2), "load has the dtype torch.float32"),
        (3, np.ones(1), "gap is of the type ndarray"),
    ):
        with pytest.raises(sg.BadInput, match=words):
            contact.solve(pattern, *good[:place], value, *good[place + 1 :])


def test_the_example_of_the_module_is_right() -> None:
    assert doctest.testmod(contact) == (0, 8)

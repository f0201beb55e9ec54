"""Contact problems as differentiable functions of torch: `pip install "signorini[torch]"`.

>>> import torch, numpy as np, signorini.torch
>>> K, B = np.array([[3.0, -1.0], [-1.0, 1.0]]), np.array([[0.0, 1.0]])
>>> pattern = signorini.torch.Pattern.of(K, B)
>>> stiffness, load, rows = (torch.from_numpy(values) for values in (K.ravel(), np.array([0.0, 3.0]), B.ravel()))
>>> gap = torch.tensor([1.0], dtype=torch.float64, requires_grad=True)
>>> u, multiplier = signorini.torch.solve(pattern, stiffness, load, rows, gap)
>>> (-multiplier[0]).backward()
>>> gap.grad.numpy().round(12).tolist()
[-0.666666666667]
"""

from __future__ import annotations

from typing import Any

import torch
from torch.autograd.function import once_differentiable

from signorini._errors import BadInput, BadType
from signorini._layer import Layer, Pattern

__all__ = ["Pattern", "solve"]


def solve(
    pattern: Pattern, stiffness: Any, load: Any, rows: Any, gap: Any, *, at_kink: str = "raise", **options: Any
) -> tuple[Any, Any]:
    """Solves a contact problem, as a differentiable function of its numbers.

    The results can be differentiated once, by `backward` or `torch.autograd.grad`, with respect to all four tensors.
    Units and signs are those of `signorini.Problem`. There are no equality rows here.

    Parameters
    ----------
    pattern : Pattern
        The places of the entries of K and B.
    stiffness : tensor of torch, shape (entries of K,)
        The values of K on the pattern. Their symmetric part is taken, so that the derivatives of an entry and of its
        mirror image are equal, and each is half of that of both together.
    load : tensor of torch, shape (n,)
        Load f, in force.
    rows : tensor of torch, shape (entries of B,)
        The values of B on the pattern.
    gap : tensor of torch, shape (m,)
        Gaps g, in length; `inf` for a row without an obstacle.
    at_kink : str, optional
        The derivative where none is proven, as at a row that touches without force. "raise" (the default) raises
        `NoDerivative`, which names the rows. "open" and "closed" take the piece with all of these rows open or closed,
        if both exist.
    **options
        Options of `signorini.prepare`, such as `tolerance`.

    Returns
    -------
    u : tensor of torch, shape (n,)
        Displacement, in length, float64.
    multiplier : tensor of torch, shape (m,)
        Contact multipliers, in force, <= 0 in compression, float64.

    Raises
    ------
    BadType
        An argument is no tensor of float64 in the memory of the processor.
    BadInput
        A length does not fit the pattern, or an option has a value that is not allowed.
    NoDerivative
        A derivative is not proven, and `at_kink` chooses no piece that exists.
    SignoriniError or Interrupted
        As `signorini.solve`.
    """
    layer, tensors = pattern.layer(at_kink, options), (stiffness, load, rows, gap)
    for (name, length), tensor in zip(pattern.lengths().items(), tensors, strict=True):
        if not isinstance(tensor, torch.Tensor):
            raise BadType(f"{name} is of the type {type(tensor).__name__}; it must be a tensor of torch")
        if tensor.dtype != torch.float64 or tensor.device.type != "cpu":
            raise BadType(f"{name} has the dtype {tensor.dtype} on {tensor.device}; it must be torch.float64 on cpu")
        if tuple(tensor.shape) != (length,):
            raise BadInput(f"{name} has the shape {tuple(tensor.shape)}; it must be ({length},)")
    u, multiplier = _Solve.apply(layer, *tensors)
    return u, multiplier


class _Solve(torch.autograd.Function):  # type: ignore[misc]
    """The solution by a layer, with its derivatives."""

    @staticmethod
    def forward(ctx: Any, layer: Layer, *tensors: Any) -> tuple[Any, ...]:
        ctx.layer = layer
        ctx.save_for_backward(*tensors)
        return tuple(torch.tensor(found) for found in layer.answer(*(tensor.detach().numpy() for tensor in tensors)))

    @staticmethod
    @once_differentiable  # type: ignore[untyped-decorator]
    def backward(ctx: Any, *by_answer: Any) -> tuple[Any, ...]:
        values = (tensor.detach().numpy() for tensor in (*ctx.saved_tensors, *by_answer))
        return None, *(torch.tensor(found) for found in ctx.layer.gradients(*values))

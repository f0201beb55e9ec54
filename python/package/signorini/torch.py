"""Contact problems as differentiable functions of torch: `pip install signorini[torch]`.

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
    """Solves a contact problem. Returns displacement u (length n) and multiplier (length m, <= 0 in compression), tensors of torch in float64.

    Both can be differentiated once, by `backward` or `torch.autograd.grad`, with respect to all four tensors.

    pattern: the places of the entries of K and B. stiffness: the values of K on them, of which the symmetric part is taken, so that the
    derivatives of an entry and of its mirror image are equal, and each is half of that of both together. load: f, length n. rows: the
    values of B. gap: g, length m, inf without an obstacle. Units and signs are those of `signorini.Problem`, which has no equality rows here.
    at_kink: what a derivative is where it is not proven, as at a row that touches without force. `raise` raises `NoDerivative`, which names
    the rows; `open` and `closed` take the piece with all of these rows open or closed, if both exist.
    options: those of `signorini.prepare`, such as `tolerance`.

    Raises `BadType` for what is no tensor of float64 in the memory of the processor, `BadInput` for lengths that do not fit, and the
    exceptions of `signorini.solve`.
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

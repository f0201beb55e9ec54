"""Contact problems as differentiable functions of jax: `pip install signorini[jax]`.

>>> import jax, numpy as np, signorini.jax
>>> jax.config.update("jax_enable_x64", True)
>>> K, B = np.array([[3.0, -1.0], [-1.0, 1.0]]), np.array([[0.0, 1.0]])
>>> pattern = signorini.jax.Pattern.of(K, B)
>>> def force(gap):
...     u, multiplier = signorini.jax.solve(pattern, K.ravel(), np.array([0.0, 3.0]), B.ravel(), gap)
...     return -multiplier[0]
>>> jax.grad(force)(np.array([1.0])).round(12).tolist()
[-0.666666666667]
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from signorini._errors import BadInput, BadType
from signorini._layer import Pattern

__all__ = ["Pattern", "solve"]


def solve(
    pattern: Pattern, stiffness: Any, load: Any, rows: Any, gap: Any, *, at_kink: str = "raise", **options: Any
) -> tuple[Any, Any]:
    """Solves a contact problem. Returns displacement u (length n) and multiplier (length m, <= 0 in compression), arrays of jax in float64.

    Both are differentiable in reverse mode, by `jax.grad`, `jax.vjp` and `jax.jacrev`, with respect to all four arrays; `jax.jit` and
    `jax.vmap` work, and solve on the host, one problem after the other.

    pattern: the places of the entries of K and B. stiffness: the values of K on them, of which the symmetric part is taken, so that the
    derivatives of an entry and of its mirror image are equal, and each is half of that of both together. load: f, length n. rows: the
    values of B. gap: g, length m, inf without an obstacle. Units and signs are those of `signorini.Problem`, which has no equality rows here.
    at_kink: what a derivative is where it is not proven, as at a row that touches without force. `raise` raises `NoDerivative`, which names
    the rows; `open` and `closed` take the piece with all of these rows open or closed, if both exist.
    options: those of `signorini.prepare`, such as `tolerance`.

    Raises `BadType` for arrays that are not float64, as all of jax are without `jax_enable_x64`, `BadInput` for lengths that do not fit, and
    the exceptions of `signorini.solve`. Within `jax.jit` an exception arrives as one of jax that has its sentence.
    """
    layer = pattern.layer(at_kink, options)
    arrays = tuple(jnp.asarray(values) for values in (stiffness, load, rows, gap))
    for (name, length), array in zip(pattern.lengths().items(), arrays, strict=True):
        if array.dtype != np.float64:
            advice = "call jax.config.update('jax_enable_x64', True) first"
            raise BadType(f"{name} has the dtype {array.dtype}; it must be float64: {advice}")
        if array.shape != (length,):
            raise BadInput(f"{name} has the shape {array.shape}; it must be ({length},)")
    of_answer = tuple(jax.ShapeDtypeStruct((length,), np.float64) for length in (pattern.dofs, pattern.row_count))
    of_arrays = tuple(jax.ShapeDtypeStruct(array.shape, np.float64) for array in arrays)

    def answer(*values: Any) -> tuple[Any, ...]:
        return _on_host(layer.answer, of_answer, values)

    def forward(*values: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        return answer(*values), values

    def backward(values: tuple[Any, ...], by_answer: tuple[Any, ...]) -> tuple[Any, ...]:
        return _on_host(layer.gradients, of_arrays, (*values, *by_answer))

    differentiable = jax.custom_vjp(answer)
    differentiable.defvjp(forward, backward)
    u, multiplier = differentiable(*arrays)
    return u, multiplier


def _on_host(function: Callable[..., tuple[Any, ...]], shapes: tuple[Any, ...], values: tuple[Any, ...]) -> tuple[Any, ...]:
    """Calls a function of arrays of numpy: at once if the values are known, so that its exceptions arrive as they are."""
    if any(isinstance(value, jax.core.Tracer) for value in values):
        return tuple(jax.pure_callback(function, shapes, *values, vmap_method="sequential"))
    return tuple(jnp.asarray(found) for found in function(*values))

"""Contact problems as differentiable functions of jax: `pip install "signorini[jax]"`.

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
    """Solves a contact problem, as a differentiable function of its numbers.

    The results are differentiable in reverse mode, by `jax.grad`, `jax.vjp` and `jax.jacrev`, with respect to all four
    arrays. `jax.jit` and `jax.vmap` work, and solve on the host, one problem after the other.
    Units and signs are those of `signorini.Problem`. There are no equality rows here.

    Parameters
    ----------
    pattern : Pattern
        The places of the entries of K and B.
    stiffness : array of jax, shape (entries of K,)
        The values of K on the pattern. Their symmetric part is taken, so that the derivatives of an entry and of its
        mirror image are equal, and each is half of that of both together.
    load : array of jax, shape (n,)
        Load f, in force.
    rows : array of jax, shape (entries of B,)
        The values of B on the pattern.
    gap : array of jax, shape (m,)
        Gaps g, in length; `inf` for a row without an obstacle.
    at_kink : str, optional
        The derivative where none is proven, as at a row that touches without force. "raise" (the default) raises
        `NoDerivative`, which names the rows. "open" and "closed" take the piece with all of these rows open or closed,
        if both exist.
    **options
        Options of `signorini.prepare`, such as `tolerance`.

    Returns
    -------
    u : array of jax, shape (n,)
        Displacement, in length, float64.
    multiplier : array of jax, shape (m,)
        Contact multipliers, in force, <= 0 in compression, float64.

    Raises
    ------
    BadType
        An array is not float64. All arrays of jax are float32 without `jax_enable_x64`.
    BadInput
        A length does not fit the pattern, or an option has a value that is not allowed.
    NoDerivative
        A derivative is not proven, and `at_kink` chooses no piece that exists.
    SignoriniError or Interrupted
        As `signorini.solve`. Within `jax.jit` an exception is one of jax that has its sentence.
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

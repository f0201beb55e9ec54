"""Every public name has a docstring with its parameters, what it returns and which exceptions it raises."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import re
from collections.abc import Iterator
from typing import Any

# These take no argument and compute nothing, so that they cannot fail. Every other function or method can.
CANNOT_RAISE = {"Certificate.to_dict", "Pattern.lengths", "Prepared.plan", "Solution.to_dict", "TotalError.to_dict"}


def public() -> Iterator[tuple[str, Any]]:
    """The public modules, their functions and classes, and the methods and properties of these, by name."""
    optional = [f"signorini.{name}" for name in ("jax", "torch") if importlib.util.find_spec(name)]
    for module in map(importlib.import_module, ["signorini", "signorini.qp", *optional]):
        yield module.__name__, module
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isclass(thing) or inspect.isroutine(thing):
                yield name, thing
            for member in vars(thing) if inspect.isclass(thing) else ():
                value = None if member.startswith("_") else getattr(thing, member, None)
                if inspect.isroutine(value) or inspect.isdatadescriptor(value):
                    yield f"{name}.{member}", value


def faults(name: str, thing: Any) -> Iterator[str]:
    """What the docstring of a function, a class, a property or a module lacks, one sentence each."""
    doc = inspect.cleandoc(thing.__doc__ or "")
    if not doc:
        yield f"{name} has no docstring"
    is_called = inspect.isroutine(thing) or getattr(thing, "__text_signature__", None) is not None
    # A class that only the package makes, or an exception, has fields instead of parameters.
    fields = inspect.get_annotations(thing) if inspect.isclass(thing) else {}
    names = inspect.signature(thing).parameters if is_called else fields
    for parameter in (parameter for parameter in names if parameter != "self" and not parameter.startswith("_")):
        if not re.search(rf"^((\w+, )*{parameter}(, \w+)* : |\*\*{parameter}$)", doc, re.MULTILINE):
            yield f"{name} has no line for {parameter}"
    sections = {"Returns": inspect.isroutine(thing), "Raises": is_called and name not in CANNOT_RAISE}
    for section in (section for section, is_needed in sections.items() if is_needed):
        if f"\n{section}\n{'-' * len(section)}\n" not in doc:
            yield f"{name} has no section {section}"


def test_every_public_name_says_its_parameters_returns_and_exceptions() -> None:
    things = list(public())
    assert {"Problem", "Problem.K", "Solution.vjp", "Event.at", "solve_problem"} <= {name for name, _ in things}
    wrong = [fault for name, thing in things for fault in faults(name, thing)]
    assert not wrong, "\n".join(wrong)


def test_a_docstring_that_lacks_something_is_found() -> None:
    def halved(x: float) -> float:
        return x / 2

    assert len(list(faults("halved", halved))) == 4
    halved.__doc__ = "Returns half of x.\n\nx : float\n\nReturns\n-------\nfloat\n\nRaises\n------\nTypeError\n"
    assert not list(faults("halved", halved))
    halved.__doc__ = halved.__doc__.replace("x : float", "y : float")
    assert list(faults("halved", halved)) == ["halved has no line for x"]

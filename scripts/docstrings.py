"""Hold every public docstring to numpydoc: Parameters, Returns and Raises.

A name is public if its subpackage exports it. A function that checks or raises says so in Raises.
"""

import importlib
import inspect
import sys
from collections.abc import Iterator
from typing import Any

from numpydoc.docscrape import get_doc_object
from numpydoc.validate import validate

import harmface

BY_NAME = (
    "enrollment.alignment",
    "errors",
    "light.interchange",
    "recognition.clustering",
    "recognition.evaluation",
    "recognition.framed",
    "recognition.framing",
    "recognition.meshes",
    "recognition.methods",
    "recognition.paired",
    "recognition.registration",
)
"""Modules that people import by their own names."""

MODULES = sorted({*harmface.__all__, *BY_NAME} - {"HarmfaceError", "__version__"})

CODES = {"GL08", "SS01", "SS03", "PR01", "PR02", "PR03", "PR07", "PR09", "RT01", "RT03", "YD01"}
"""Of numpydoc: a text, a summary that ends with a period, all parameters, each with a description
that ends with a period, what is returned or yielded, and in which shape and unit."""


def public(module: str) -> Iterator[tuple[str, Any]]:
    """Yield the full name of every public function, class and method of a subpackage."""
    found = importlib.import_module(f"harmface.{module}")
    for name in getattr(found, "__all__", None) or _own(found):
        value = getattr(found, name)
        if not (inspect.isfunction(value) or inspect.isclass(value)):
            continue
        yield f"{found.__name__}.{name}", value
        if inspect.isclass(value):
            for method, defined in vars(value).items():
                if not method.startswith("_") and _documented(defined):
                    yield f"{found.__name__}.{name}.{method}", getattr(value, method)


def problems(name: str, value: Any) -> list[str]:
    """Return what is wrong with one docstring, an entry for each fault."""
    found = [
        f"{code} {text}"
        for code, text in validate(get_doc_object(value))["errors"]
        if code in CODES and not (inspect.isclass(value) and code.startswith("RT"))
    ]
    function = getattr(value, "__func__", value)
    if inspect.isfunction(function):
        body = inspect.getsource(function).split('"""', 2)[-1]
        if ("raise " in body or "checks." in body) and "Raises\n" not in (function.__doc__ or ""):
            found.append("HF01 Raises section missing: it checks its arguments or raises")
    return found


def _own(module: Any) -> list[str]:
    """Return the names that a module without `__all__` defines itself."""
    return [
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", "") == module.__name__
    ]


def _documented(defined: Any) -> bool:
    function = getattr(defined, "__func__", defined)
    return inspect.isfunction(function) or isinstance(defined, property)


def main() -> None:
    """Print every fault; exits with 1 if there is any."""
    faults = 0
    for module in MODULES:
        for name, value in public(module):
            for problem in problems(name, value):
                print(f"{name}: {problem}")
                faults += 1
    if faults:
        sys.exit(f"{faults} faults in docstrings")


if __name__ == "__main__":
    main()

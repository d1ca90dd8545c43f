"""What is a library's and what is the user's own, and versions of libraries.

A library is Python's own, this package, or what is in a folder
site-packages or dist-packages and has a version. Everything else is the user's."""

import functools
import importlib.metadata
import os
import re
import sys
import sysconfig
import types

import numpy as np

PYTHON, PHYSINV = "python", "physinv"
_FOLDERS = ("site-packages", "dist-packages")
_NUMERICAL = ("numpy", "scipy", "torch", "jax", "jaxlib")


_known = {}  # libraries of modules
_HOLDERS = {types.MethodType: ("__func__", "__self__"),
            functools.partial: ("func",), staticmethod: ("__func__",),
            classmethod: ("__func__",), property: ("fget",)}


def _with_links(path):
    return {os.path.join(path, ""), os.path.join(os.path.realpath(path), "")}


_OWN = _with_links(os.path.dirname(os.path.abspath(__file__)))
_STANDARD = set().union(*(_with_links(sysconfig.get_path(name))
                          for name in ("stdlib", "platstdlib")))


def of_file(path):
    """The library that a file belongs to, None for the user's own."""
    if path.startswith(("<frozen ", "<__array_function__ ")):
        return PYTHON if path.startswith("<frozen ") else "numpy"
    if not os.path.isabs(path):
        return None
    if path.startswith(tuple(_OWN)):
        return PHYSINV
    parts = path.split(os.sep)
    at = max((k for k, part in enumerate(parts) if part in _FOLDERS), default=0)
    if at:
        top = parts[at + 1].split(".")[0] if at + 1 < len(parts) else ""
        return top if version(top) else None
    return PYTHON if path.startswith(tuple(_STANDARD)) else None


def of_module(name):
    """The library that a module belongs to, None for the user's own."""
    if not isinstance(name, str):
        return None
    if name not in _known:
        top = _library_of(name)
        if top is None:
            return None
        _known[name] = top
    return _known[name]


def _library_of(name):
    """By its file; what has none, as parts of compiled modules, by the package
    that it is in."""
    for one in dict.fromkeys((name, name.split(".")[0])):
        module = sys.modules.get(one)
        if module is None or one == "__main__":
            continue
        spec = getattr(module, "__spec__", None)
        if getattr(spec, "origin", None) in ("built-in", "frozen"):
            return PYTHON
        path = file_of(module)
        if path:
            return of_file(path)
    return None


def named(module, qualified):
    """What a module has under a qualified name, None if nothing does."""
    value = sys.modules.get(module)
    for part in qualified.split("."):
        value = getattr(value, part, None)
    return value


def is_users(value):
    """Whether what is in a library was put there by the user's code."""
    kind = type(value)
    if kind is types.FunctionType:
        path = value.__code__.co_filename
        generated = path.startswith("<") and not path.startswith(
            ("<ipython", "<stdin"))
        return not generated and of_file(path) is None
    if issubclass(kind, type):
        return of_module(value.__module__) is None
    if kind in _HOLDERS:
        return any(is_users(getattr(value, name)) for name in _HOLDERS[kind])
    return issubclass(kind, np.vectorize) and is_users(value.pyfunc) or \
        kind.__module__ in sys.modules and of_module(kind.__module__) is None


def file_of(module):
    """Of a package without a file, its folder."""
    paths = [module.__dict__.get("__file__"),
             *(module.__dict__.get("__path__") or [])]
    found = next((path for path in paths if isinstance(path, str)), None)
    return found and os.path.abspath(found)


@functools.lru_cache(maxsize=None)
def _of_metadata(top):
    names = [top]
    if hasattr(importlib.metadata, "packages_distributions"):
        try:
            return importlib.metadata.version(top)
        except (importlib.metadata.PackageNotFoundError, ValueError):
            names = importlib.metadata.packages_distributions().get(top, [])
    for name in sorted(names):
        try:
            return importlib.metadata.version(name)
        except (importlib.metadata.PackageNotFoundError, ValueError):
            pass
    return None


def version(top):
    """The version of a library by the name that is imported, None without."""
    found = _of_metadata(top) if top else None
    stated = getattr(sys.modules.get(top), "__version__", None)
    return found or (" ".join(str(stated).split()) if stated else None)


def _required(top):
    try:
        lines = importlib.metadata.requires(top) or []
    except (importlib.metadata.PackageNotFoundError, ValueError):
        return set()
    names = {re.match(r"[\w.-]*", line)[0].lower() for line in lines
             if "extra" not in line.partition(";")[2]}
    return {name.replace("-", "_") for name in names}


def versions(tops):
    """"numpy 1.24.2, scipy 1.10.1": of these libraries, and of NumPy, SciPy,
    PyTorch and JAX where one of them requires it."""
    found, left = set(), set(tops)
    while left:
        top = left.pop()
        found.add(top)
        left |= _required(top) - found
    named = {top for top in found if top in tops or top in _NUMERICAL}
    return ", ".join(f"{top} {version(top)}" for top in sorted(named)
                     if version(top))

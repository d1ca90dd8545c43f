"""The extension module, or one line that names the Python that it is for."""

import importlib
import importlib.machinery
import pathlib
import re
import sys


def core():
    try:
        return importlib.import_module("physinv._core")
    except ModuleNotFoundError as error:
        if error.name != "physinv._core":
            raise
    here = pathlib.Path(__file__).parent  # links lead elsewhere
    built = sorted(path.name for path in here.glob("_core.*.so"))
    own = _version(importlib.machinery.EXTENSION_SUFFIXES[0])
    this = f"this is Python {own}"
    if not built:
        raise ImportError(
            f"{here} has no extension module _core for {this}; build it with "
            "python3-dev, python3-numpy and pybind11-dev installed")
    versions = [_version(name) for name in built]
    raise ImportError(
        f"physinv is built for Python {' and '.join(versions)}, but {this} "
        f"({sys.executable}); use {' or '.join('python' + v for v in versions)}, "
        "or build for this one")


def _version(name):
    """3.11 of _core.cpython-311-x86_64-linux-gnu.so."""
    found = re.search(r"\.cpython-(\d)(\d+)(\w*)-", name)
    return "{}.{}{}".format(*found.groups()) if found else name

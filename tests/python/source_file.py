"""Python code of a test, as a user would write it to a file."""

import importlib.util
import pathlib


def define(path, text):
    """Writes the file and runs it as a module of its name."""
    pathlib.Path(path).write_text(text)
    spec = importlib.util.spec_from_file_location(pathlib.Path(path).stem, path)
    spec.loader.exec_module(importlib.util.module_from_spec(spec))

"""Methods written in Python, as cases of campaigns."""

import fnmatch
import hashlib
import inspect
import sys

from physinv import _core

_registered = {}


def registered():
    """Names of the methods, each with the experiments that have it."""
    return dict(_registered)


def _source(function):
    """The text of its file, so that an edit of a helper counts, too."""
    try:
        with open(inspect.getsourcefile(function), encoding="utf-8") as file:
            return file.read()
    except (OSError, TypeError):
        pass
    try:
        return inspect.getsource(function)  # of a notebook
    except OSError:
        raise ValueError(
            f"{function.__name__} has no source whose hash could enter the key; "
            "a method stands in a file or a notebook") from None


def method(name, experiments="*", needs="vjp", iterations=1000, **options):
    """Makes a function a method of every experiment that matches and provides
    what it needs ("vjp", ("vjp", "labels"), ...; "network" for run.network):

        @physinv.method("momentum", experiments="jpo/*")
        def solve(run):
            x, v = run.start, 0
            while run.proceed(x):
                _, gradient = run.loss_and_gradient(x)
                v = 0.9 * v - 0.01 * gradient
                x = x + v
            return x

    It sees what a method of the suite sees: problems without their solutions,
    calls counted, its budget. It returns x, or x and a dict of status,
    iterations and evaluations per example; these two stand beside what was
    counted, as arrays claimed_iterations and so on. An exception fails its stage, and
    the campaign goes on. `physinv.run` has it in every profile, on the n and
    seeds of its rows. The key of its results has its name, the hash of its
    file, the options, and Python's version; `version=scipy.__version__` adds
    another."""
    needs = [needs] if isinstance(needs, str) else list(needs)

    def add(function):
        matching = fnmatch.filter(_core.problems(), experiments)
        text = hashlib.sha256(_source(function).encode()).hexdigest()[:32]
        words = [("method", name), ("source", text),
                 ("python", "%d.%d" % sys.version_info[:2])]
        words += [(key, str(value)) for key, value in options.items()]
        added = _core.add_method(name, function, matching, needs, words,
                                 iterations)
        if not added:
            raise ValueError(
                f"no experiment that matches '{experiments}' provides "
                f"{'|'.join(needs)}, which {name} needs")
        _registered[name] = added
        return function

    return add

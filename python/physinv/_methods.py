"""Methods written in Python, as cases of campaigns."""

import fnmatch
import functools
import inspect
import operator
import pathlib
import re
import sys

import numpy as np

from physinv import _core, _libraries
from physinv._key import Refused, digest_of, source_key

_OWN_WORDS = ("algorithm", "method", "source", "python", "libraries", "physinv")
_LARGEST_BUDGET = 10 ** 9
_LONGEST_TEXT = 200
_registered = {}


def registered():
    """Names of the methods, each with the experiments that have it."""
    return dict(_registered)


def _option_text(value, name):
    """The same text in every process, and another one for another value."""
    kind = type(value)
    if kind in (bool, int, float, complex, str, bytes, type(None)):
        text = repr(value)
    elif kind in (list, tuple):
        each = [_option_text(one, name) for one in value]
        text = f"{kind.__name__}({', '.join(each)})"
    elif kind in (set, frozenset):
        each = sorted(_option_text(one, name) for one in value)
        text = f"{kind.__name__}({', '.join(each)})"
    elif kind is dict:
        each = sorted(f"{_option_text(key, name)}: {_option_text(one, name)}"
                      for key, one in value.items())
        text = f"dict({', '.join(each)})"
    elif isinstance(value, (np.bool_, np.integer, np.floating)):
        text = f"{value.dtype}({value.item()!r})"
    else:
        return f"{kind.__name__} {_value_key(value, name)}"
    if len(text) <= _LONGEST_TEXT:
        return text
    return f"{kind.__name__} {digest_of(text.encode('utf-8'))}"


def _value_key(value, name):
    try:
        return source_key(value, name)[0]
    except Refused as error:
        raise TypeError(f"the option {name} has no stable text that could "
                        f"enter the key: {error}") from None


@functools.lru_cache(maxsize=None)
def _package_key(problems):
    """Of this package's sources and those of all problems."""
    here = pathlib.Path(__file__).parent
    text = [path.read_bytes() for path in sorted(here.glob("*.py"))
            if path.is_file()]
    return digest_of(b"\0".join([problems.encode(), *text]))


def words_of(name, function, options):
    """What the key has of a method, as pairs of texts."""
    words = [("method", name),
             *_words_of_source(f"method {name}", function)]
    return words + [(key, _option_text(value, key))
                    for key, value in sorted(options.items())]


def words_of_problem(name, problem):
    """What the key has of a problem: of its class and its attributes."""
    return [("problem", name), *_words_of_source(f"problem {name}", problem)]


def _words_of_source(what, value):
    try:
        source, libraries = source_key(value, _name_of(value))
    except Refused as error:
        raise ValueError(f"the key of the {what} cannot cover all that "
                         f"its numbers depend on: {error}") from None
    own = {_libraries.PYTHON, _libraries.PHYSINV}
    words = [("source", source), ("python", "%d.%d" % sys.version_info[:2]),
             ("libraries", _libraries.versions((libraries | {"numpy"}) - own))]
    if _libraries.PHYSINV in libraries:
        words.append(("physinv", _package_key(_core.problem_sources())))
    return words


def _name_of(function):
    return getattr(function, "__name__", type(function).__name__)


def _check(name, experiments, needs, iterations, options):
    if not isinstance(name, str) or not re.fullmatch("[a-z0-9_-]{1,100}", name):
        raise ValueError("a method's name must have at most 100 characters of "
                         f"[a-z0-9_-]; {name!r} does not")
    if not isinstance(experiments, str):
        raise ValueError(f"experiments={experiments!r} of the method {name}; "
                         "expected a pattern such as 'jpo/*'")
    if not isinstance(needs, (str, list, tuple, set)) or not all(
            isinstance(one, str) for one in needs):
        raise ValueError(f"needs={needs!r} of the method {name}; expected names "
                         "such as 'vjp'")
    try:
        budget = operator.index(iterations)
    except TypeError:
        budget = None
    if budget is None or isinstance(iterations, (bool, np.bool_)) or \
            not 1 <= budget <= _LARGEST_BUDGET:
        raise ValueError(f"iterations={iterations!r} of the method {name}; "
                         f"expected a whole number from 1 to {_LARGEST_BUDGET}")
    for option in options:
        if not option.isidentifier():
            raise ValueError("an option's name must be an identifier; "
                             f"{option!r} of the method {name} is not")
        if option in _OWN_WORDS:
            raise ValueError(f"the method {name} has an option {option}, a "
                             "key that the record already has; choose "
                             "another name")
    return budget


def _check_callable(name, function):
    if not callable(function):
        raise ValueError(f"the method {name} is a {type(function).__name__}, "
                         "which cannot be called")
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return  # of a function in C that does not tell it
    try:
        signature.bind(None)
    except TypeError as error:
        raise ValueError(f"the method {name} must accept one argument, the "
                         f"run: {error}") from None


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
    calls counted, its budget. It returns x, or x and a dict: status, iterations
    and evaluations per example, of which the latter two are stored next to what was
    counted, as arrays claimed_iterations and so on; message, a text; arrays, a dict of
    numbers per example, which are stored. An exception fails its stage, and the
    campaign continues. `physinv.run` has it in every profile, on the n and seeds of its
    rows.

    The key of its results has the method's name, the hash of its code and of
    all that it refers to, transitively (globals, variables of enclosing
    functions, decorators, defaults, classes, modules of the user's own), the
    versions of Python and of the libraries among it, and the options, which the
    function does not see: data="grid-2" names what the code does not refer to,
    such as a file. It is made again whenever physinv.run or physinv.verb is
    called. docs/python.md says what is followed and what is refused.

    ValueError for a name that is not in [a-z0-9_-], a budget that is not a whole number
    of at least 1, what cannot be called, and what cannot be followed; TypeError for an
    option that has no lasting text."""
    budget = _check(name, experiments, needs, iterations, options)
    needs = [needs] if isinstance(needs, str) else sorted(needs)

    def add(function):
        _check_callable(name, function)
        matching = fnmatch.filter(_core.problems(), experiments)
        added = _core.add_method(name, function, matching, needs,
                                 lambda: words_of(name, function, options),
                                 budget)
        if not added:
            raise ValueError(
                f"no experiment that matches '{experiments}' provides "
                f"{'|'.join(needs)}, which {name} needs")
        _registered[name] = added
        return function

    return add

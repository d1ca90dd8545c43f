"""The rows of source_key_test.py: (name, files, (old, new), ...). Files are a
dict, or the text of methods.py alone, whose `solve` is the method."""

DECORATORS = '''
import functools
def wrapping(f):
    @functools.wraps(f)
    def call(run): return f(run) * 2
    return call
def plain(f):
    def call(run): return f(run) * 2
    return call
def scaled(by):
    def add(f):
        def call(run): return f(run) * by
        return call
    return add
class Counted:
    def __init__(self, f): self.f = f
    def __call__(self, run): return self.f(run)
'''
HELPERS = '''
import deeper
from deeper import RATE
STEP, SIZES = 0.1, [1, 2]
NAMES = {"step": 0.5}
def move(x): return deeper.turn(x) * STEP
def other(x): return x - RATE
class Rule:
    rate = 0.3
    def apply(self, x): return x * self.rate
'''
DEEPER = '''
RATE = 0.7
def turn(x): return x * RATE
'''


def files_of(text):
    """With the modules that it imports."""
    if isinstance(text, dict):
        return text
    files = {"methods.py": text}
    if "decorators" in text:
        files["decorators.py"] = DECORATORS
    if "helpers" in text:
        files.update({"helpers.py": HELPERS, "deeper.py": DEEPER})
    if "package" in text:
        files.update({
            "package/__init__.py": "from .part import LEVEL\n",
            "package/part.py": "LEVEL = 4\ndef climb(x): return x + LEVEL\n"})
    return files


def solve(body, before=""):
    return f"{before}\ndef solve(run):\n    return {body}\n"


def decorated(name):
    return (f"from decorators import {name.split('(')[0]}\n@{name}\n"
            "def solve(run): return run.start + 1\n")


CLASS = '''
import functools
class Base:
    shift = 1
    def inner(self, x): return x + self.shift
class Solver(Base):
    rate = 0.1
    __slots__ = ("step",)
    def __init__(self, step, more): self.step, self.more = step, more
    @property
    def double(self): return 2 * self.rate
    @functools.cached_property
    def half(self): return self.rate / 2
    @staticmethod
    def fixed(x): return x * 3
    @classmethod
    def of(cls, x): return x * 4
    def __call__(self, run): return self.inner(run.start) * self.double
    def method(self, run): return self(run)
solver = Solver(5, [6])
'''
CALLABLE, BOUND = CLASS + "solve = solver\n", CLASS + "solve = solver.method\n"
NUMPY = "import numpy as np\n"
PARTIAL = ("import functools\ndef f(a, run, b=1): return run.start * a * b\n"
           "solve = functools.partial(f, 2, b=3)\n")

TORCH = """
import torch
class Net(torch.nn.Module):
    def __init__(self):
        super().__init__()
        self.layer = torch.nn.Linear(2, 2)
    def forward(self, x): return torch.tanh(self.layer(x))
torch.manual_seed(0)
net, weights = Net(), torch.ones(3)
@torch.no_grad()
def last(x): return x + 1
def solve(run): return last(net(run) * weights)
"""

CHANGES = [
    # The function itself.
    ("body", solve("run.start + 1"), ("+ 1", "- 1")),
    ("constant", solve("run.start * 0.10"), ("0.10", "0.11")),
    ("attribute's name", solve("run.start"), ("run.start", "run.given")),
    ("default", "def solve(run, a=1): return a", ("a=1", "a=2")),
    ("keyword default", "def solve(run, *, a=1): return a", ("a=1", "a=2")),
    ("default that is a function",
     "def g(x): return x\ndef solve(run, f=g): return f(run)",
     ("return x", "return -x")),
    ("function's attribute", solve("solve.step") + "solve.step = 1",
     ("step = 1", "step = 2")),
    ("lambda of the same line", "a, b = lambda r: 1, lambda r: 2\nsolve = a",
     ("solve = a", "solve = b")),
    ("lambda's text", "solve = lambda run: run.start", ("start", "given")),
    ("nested function",
     "def solve(run):\n    def g(x): return x + 1\n    return g(run)",
     ("x + 1", "x + 2")),
    ("class in the function",
     "def solve(run):\n    class A:\n        b = C\n    return A.b\nC = 1",
     ("C = 1", "C = 2")),
    ("made by exec", "s = {}\nexec('def solve(run): return 1', s)\n"
     "solve = s['solve']", ("return 1", "return 2")),
    ("except clause", "def solve(run):\n    try: return f()\n"
     "    except ValueError: return 1\ndef f(): return 2",
     ("ValueError", "KeyError")),
    # What it refers to.
    ("global number", solve("run.start * STEP", "STEP = 0.1"), ("0.1", "0.2")),
    ("sign of zero", solve("1 / Z", "Z = 0.0"), ("0.0", "-0.0")),
    ("type of a number", solve("run.start // K", "K = 2"), ("= 2", "= 2.0")),
    ("last digit", solve("K", "K = 0.1"), ("= 0.1", "= 0.1 + 2 ** -56")),
    ("list", solve("K[1]", "K = [1, [2, 3]]"), ("[2, 3]", "[2, 4]")),
    ("dict", solve("K['a']", "K = {'a': 1}"), (": 1", ": 2")),
    ("order of a dict", solve("sum(K)", "K = {.1: 0, .2: 0}"),
     ("{.1: 0, .2: 0}", "{.2: 0, .1: 0}")),
    ("set", solve("K", "K = {1, 'a'}"), ("'a'", "'b'")),
    ("one object or two", solve("A, B", "A = [1]; B = A"), ("B = A", "B = [1]")),
    ("helper", solve("f(run)", "def f(x): return x + 1"), ("+ 1", "+ 2")),
    ("helper of a helper", solve("f(run)", "def f(x): return g(x)\n"
                                 "def g(x): return K\nK = 1"), ("K = 1", "K = 2")),
    ("helpers that call each other",
     solve("f(run)", "def f(x): return g(x)\ndef g(x): return f(x) + 1"),
     ("+ 1", "+ 2")),
    ("defined below", solve("f(run)") + "def f(x): return 1",
     ("return 1", "return 2")),
    ("name that was not there", solve("K if run else 0"), ("def", "K = 1\ndef")),
    ("comprehension's global", solve("[K * i for i in run]", "K = 1"),
     ("= 1", "= 2")),
    ("generator's global", solve("sum(K * i for i in run)", "K = 1"),
     ("= 1", "= 2")),
    ("built-in shadowed", solve("sum(run)"), ("def", "sum = max\ndef")),
    ("closure", "def make(k):\n    def solve(run): return k\n    return solve\n"
     "solve = make(1)", ("make(1)", "make(2)")),
    ("closure of a closure", "def make(k):\n    def f(x): return x * k\n"
     "    def solve(run): return f(run)\n    return solve\nsolve = make(1)",
     ("make(1)", "make(2)")),
    ("changed by global", solve("K", "K = 1\ndef up():\n    global K\n"
                                "    K += 1\nup()"), ("K += 1", "K += 2")),
    # Decorators, partials, callable objects, bound methods.
    ("below a decorator with wraps", decorated("wrapping"), ("+ 1", "+ 2")),
    ("below a decorator without wraps", decorated("plain"), ("+ 1", "+ 2")),
    ("below a decorator with arguments", decorated("scaled(2)"), ("+ 1", "+ 2")),
    ("below a class as decorator", decorated("Counted"), ("+ 1", "+ 2")),
    ("a decorator's text", decorated("wrapping"), ("f(run) * 2", "f(run) * 3")),
    ("a decorator's argument", decorated("scaled(2)"), ("(2)", "(3)")),
    ("another decorator", decorated("wrapping"), ("@wrapping", "@plain"),
     ("import wrapping", "import plain")),
    ("below functools.lru_cache", "import functools\n@functools.lru_cache(8)\n"
     "def f(x): return x + 1\ndef solve(run): return f(run)", ("+ 1", "+ 2")),
    ("below contextlib.contextmanager", "import contextlib\n"
     "@contextlib.contextmanager\ndef f():\n    yield 1\n"
     "def solve(run):\n    with f() as x: return x", ("yield 1", "yield 2")),
    ("singledispatch", "import functools\n@functools.singledispatch\n"
     "def f(x): return 1\n@f.register(float)\ndef _(x): return 2\n"
     "def solve(run): return f(run)", ("return 2", "return 3")),
    ("partial's function", PARTIAL, ("* a", "/ a")),
    ("partial's argument", PARTIAL, ("(f, 2", "(f, 4")),
    ("partial's keyword", PARTIAL, ("b=3)", "b=4)")),
    ("callable object", CALLABLE, ("* self.double", "/ self.double")),
    ("bound method", BOUND, ("self(run)", "self(run) * 2")),
    ("state of a bound instance", BOUND, ("[6]", "[7]")),
    ("slot", CALLABLE, ("Solver(5", "Solver(7")),
    ("class attribute", CALLABLE, ("rate = 0.1", "rate = 0.2")),
    ("property", CALLABLE, ("2 * self.rate", "3 * self.rate")),
    ("cached property", CALLABLE, ("rate / 2", "rate / 3")),
    ("static method", CALLABLE, ("x * 3", "x * 5")),
    ("class method", CALLABLE, ("x * 4", "x * 5")),
    ("base class", CALLABLE, ("shift = 1", "shift = 2")),
    ("method of a class set later", CALLABLE,
     ("solve =", "Solver.__call__ = lambda self, run: 0\nsolve =")),
    ("annotations of a class", solve("[x for x in C.__annotations__]",
                                     "class C:\n    a: int\n"),
     ("a: int", "b: int")),
    ("order of a class", solve("list(vars(C))", "class C:\n    a = 1\n    b = 2\n"),
     ("    a = 1\n    b = 2\n", "    b = 2\n    a = 1\n")),
    ("name of a function", solve("f.__name__", "def f(): pass"), ("f()", "g()"),
     ("f.__", "g.__")),
    ("metaclass", solve("A()", "class M(type):\n    def __call__(c): return 1\n"
                        "class A(metaclass=M): pass"), ("return 1", "return 2")),
    ("default of a dataclass",
     solve("C().a", "import dataclasses\n@dataclasses.dataclass\nclass C:\n"
           "    a: float = 0.1\n"), ("0.1", "0.2")),
    ("field of a dataclass",
     solve("C.a", "import dataclasses\n@dataclasses.dataclass\nclass D:\n"
           "    a: float\nC = D(0.1)"), ("0.1", "0.2")),
    ("namedtuple", solve("P.a", "import collections\n"
                         "P = collections.namedtuple('P', 'a')(1)"),
     ("(1)", "(2)")),
    ("enum", solve("E.a.value", "import enum\nclass E(enum.Enum):\n    a = 1\n"),
     ("a = 1", "a = 2")),
    ("subclass of list", solve("L", "class K(list): pass\nL = K([1])"),
     ("[1]", "[2]")),
    ("subclass of ndarray", solve("L", NUMPY + "class K(np.ndarray): pass\n"
                                  "L = np.ones(2).view(K)"), ("ones", "zeros")),
    ("items of an object of a library",
     solve("D", "import collections\nD = collections.deque([1], 5)"),
     ("[1]", "[2]")),
    ("regular expression", solve("R", "import re\nR = re.compile('a')"),
     ("'a'", "'b'")),
    ("fraction", solve("R", "from fractions import Fraction as F\nR = F(1, 3)"),
     ("3)", "4)")),
    ("path", solve("R", "import pathlib\nR = pathlib.Path('a')"), ("'a'", "'b'")),
    ("stands for another object", """
class Proxy:
    def __init__(self, f, by): self.f, self.by = f, by
    @property
    def __class__(self): return type(self.f)
    def __getattr__(self, name): return getattr(self.f, name)
    def __call__(self, x): return self.f(x) * self.by
f = Proxy(lambda x: x, 2)
def solve(run): return f(run)
""", (", 2)", ", 3)")),
    ("type that is generic", solve("G[int].k", "import typing\n"
                                   "T = typing.TypeVar('T')\n"
                                   "class G(typing.Generic[T]): k = 1\n"),
     ("k = 1", "k = 2")),
    ("iterator", solve("next(R)", "R = iter([1, 2])"), ("[1,", "[3,")),
    # Modules of the user's own.
    ("attribute of a module", solve("helpers.STEP", "import helpers"),
     ("STEP, SIZES = 0.1", "STEP, SIZES = 0.2")),
    ("function of a module", solve("helpers.other(1)", "import helpers"),
     ("x - RATE", "x + RATE")),
    ("class of a module", solve("helpers.Rule()", "import helpers"),
     ("rate = 0.3", "rate = 0.4")),
    ("module of a module", solve("helpers.move(1)", "import helpers"),
     ("RATE = 0.7", "RATE = 0.8")),
    ("attribute through two modules", solve("helpers.deeper.RATE",
                                            "import helpers"),
     ("RATE = 0.7", "RATE = 0.8")),
    ("from import", solve("STEP", "from helpers import STEP"),
     ("STEP, SIZES = 0.1", "STEP, SIZES = 0.2")),
    ("star import", solve("move(1)", "from helpers import *"),
     ("RATE = 0.7", "RATE = 0.8")),
    ("import in the function", "def solve(run):\n    import helpers\n"
     "    return helpers.STEP", ("STEP, SIZES = 0.1", "STEP, SIZES = 0.2")),
    ("from import in the function", "def solve(run):\n"
     "    from helpers import move\n    return move(1)",
     ("RATE = 0.7", "RATE = 0.8")),
    ("module of a package", "def solve(run):\n    import package.part as p\n"
     "    return p.climb(1)", ("LEVEL = 4", "LEVEL = 5")),
    ("submodule by from import", "def solve(run):\n    from package import part\n"
     "    return part.climb(1)", ("x + LEVEL", "x - LEVEL")),
    ("name by getattr", solve("getattr(helpers, 'ST' + 'EP')", "import helpers"),
     ("STEP, SIZES = 0.1", "STEP, SIZES = 0.2")),
    ("module in a list", solve("M[0].STEP", "import helpers\nM = [helpers]"),
     ("STEP, SIZES = 0.1", "STEP, SIZES = 0.2")),
    ("patched function of a module",
     solve("helpers.move(1)", "import helpers, deeper"),
     ("import helpers, deeper",
      "import helpers, deeper\ndeeper.turn = lambda x: 0")),
    # Arrays.
    ("array", solve("A", NUMPY + "A = np.arange(3000.)"),
     ("3000.)", "3000.)\nA[1500] += 1e-9")),
    ("dtype", solve("A", NUMPY + "A = np.ones(3, 'f8')"), ("f8", "f4")),
    ("shape", solve("A", NUMPY + "A = np.ones((3, 2))"), ("3, 2", "2, 3")),
    ("order of an array", solve("A", NUMPY + "A = np.ones((3, 2), order='C')"),
     ("'C'", "'F'")),
    ("array of objects", solve("A", NUMPY + "A = np.array([1, None])"),
     ("[1", "[2")),
    ("masked array", solve("A", NUMPY + "A = np.ma.array([1., 2.], mask=[0, 1])"),
     ("[0, 1]", "[1, 1]")),
    ("number of NumPy's", solve("A", NUMPY + "A = np.float64(1)"), ("64", "32")),
    ("vectorize", solve("f(run)", NUMPY + "f = np.vectorize(lambda x: x + 1)"),
     ("x + 1", "x + 2")),
    ("array in a closure", NUMPY + "def make(w):\n    return lambda run: w\n"
     "solve = make(np.full(3, 1.))", ("1.", "2.")),
    ("function of a library", solve("np.sin(1)", NUMPY), ("np.sin", "np.cos")),
    ("function of a library by name", solve("f(1)", "from numpy import sin as f"),
     ("import sin", "import cos")),
]

CHANGES_OF_TORCH = [
    ("tensor", TORCH, ("ones(3)", "zeros(3)")),
    ("seed of a network", TORCH, ("seed(0)", "seed(1)")),
    ("layers of a network", TORCH, ("2, 2)", "2, 3)")),
    ("function of a network", TORCH, ("torch.tanh", "torch.relu")),
    ("below no_grad", TORCH, ("x + 1", "x + 2")),
]

REFUSED = [
    ("random generator", solve("f()", NUMPY + "R = np.random.default_rng(0)\n"
                               "def f(): return R.normal()"),
     r"solve -> f -> R \(numpy.random._generator.Generator\) cannot be follow"
     ".*run.seed"),
    ("its method", solve("draw()", NUMPY + "draw = np.random.default_rng(0)."
                         "normal"), "draw -> __self__ .*run.seed"),
    ("lock", solve("K['a']", "import threading\nK = {'a': threading.Lock()}"),
     r"solve -> K -> \['a'\] \(_thread.lock\) cannot be followed"),
    ("generator", solve("K", "K = (i for i in 'ab')"), "K .generator. cannot"),
    ("file", solve("K", "import sys\nK = sys.stdout"), "TextIOWrapper"),
    ("eval", solve("eval('STEP')"), "solve -> eval .* only when it runs"),
    ("exec", solve("exec('a = 1')"), "solve -> exec"),
    ("globals()", solve("globals()['STEP']"), "solve -> globals"),
    ("module by name", solve("importlib.import_module('helpers')",
                             "import importlib"), "importlib.import_module"),
    ("sys.modules", solve("sys.modules['helpers']", "import sys"), "sys.modules"),
    ("open", solve("f()", "def f(): return open('data')"),
     "solve -> f -> open .* file's content"),
    ("numpy.load", solve("np.load('a.npy')", NUMPY), "np.load .* file's content"),
    ("pathlib", solve("P.read_text()", "import pathlib\nP = pathlib.Path('a')"),
     "solve .function. cannot be followed: .read_text: a file's content"),
    ("gzip", solve("f()", "import gzip\ndef f(): return gzip.open('a')"),
     "solve -> f .function. cannot be followed: .open: a file's content"),
    ("input", solve("input()"), "solve -> input .* only when it runs"),
    ("environment", solve("os.environ['STEP']", "import os"), "os.environ"),
    ("library in C", solve("L.f()", "import ctypes\nL = ctypes.CDLL(None)"),
     r"solve -> L \(ctypes.CDLL\)"),
    ("object in a closure", "import threading\ndef make(k):\n"
     "    return lambda run: k\nsolve = make(threading.local())", " -> k "),
    ("attribute of an object", CALLABLE + "solver.lock = open\n",
     r"solve -> \.lock"),
    ("module used as a value", solve("vars(helpers)", "import helpers, threading\n"
                                     "helpers.bad = threading.Lock()"),
     "solve -> helpers -> bad "),
    ("universal function of Python", solve("f(1)", NUMPY + "f = np.frompyfunc("
                                           "lambda x: x, 1, 1)"), "solve -> f "),
    ("deep nesting", solve("K", "K = []\nfor i in range(3000): K = [K]"),
     "nested too deeply"),
]

SAME = [
    ("comment", solve("run.start"), ("def", "# a comment\ndef"),
     (".start", ".start  # another")),
    ("blank lines", solve("run.start"), ("def", "\n\n\ndef"), (":\n", ":\n\n\n")),
    ("folder", solve("helpers.move(run)", "import helpers")),
    ("unrelated function", solve("run.start"), ("def", "def g(): pass\ndef")),
    ("unrelated global", solve("A", "A = 1"), ("A = 1", "A = 1\nLOCK = open")),
    ("unrelated class", solve("run"), ("def", "class C:\n    x = 1\ndef")),
    ("unrelated function of a module", solve("helpers.STEP", "import helpers"),
     ("x - RATE", "x + RATE")),
    ("order of definitions", "def f(x): return 1\ndef g(x): return 2\n"
     "def solve(run): return f(1) + g(2)",
     ("def f(x): return 1\ndef g(x): return 2\n",
      "def g(x): return 2\ndef f(x): return 1\n")),
    ("order of imports", solve("np.sin(math.pi)", "import math\nimport numpy as np"),
     ("import math\nimport numpy as np", "import numpy as np\nimport math")),
    ("import that is not used", solve("run"), ("def", "import json, csv\ndef")),
    ("order of a set", solve("K", "K = {'a', 'b', 'c'}"),
     ("{'a', 'b', 'c'}", "{'c', 'a', 'b'}")),
    ("spelling of a number", solve("K", "K = 0.1"), ("0.1", "1e-1")),
    ("spaces", solve("run.start + 1"), ("start + 1", "start  +  (1)")),
    ("annotations", solve("run"), ("(run)", "(run: object) -> object")),
    ("array that was computed", solve("A", NUMPY + "A = np.ones(3)"),
     ("np.ones(3)", "np.zeros(3) + 1")),
    ("name of a file with a class in a function",
     {"methods.py": "from one import f\ndef solve(run): return f(run)\n",
      "one.py": "def f(x):\n    class A: b = x\n    return A\n",
      "two.py": "def f(x):\n    class A: b = x\n    return A\n"},
     ("from one", "from two")),
    ("function that has run", solve("[f(i) for i in range(9)]", "def f(x): return"
                                    " x + 1.5\n"),
     ("def solve", "for i in range(99): f(1.5)\ndef solve")),
    ("name of a helper's file", {"methods.py": "from one import f\n"
                                 "def solve(run): return f(run)\n",
                                 "one.py": "def f(x): return x\n",
                                 "two.py": "def f(x): return x\n"},
     ("from one", "from two")),
]

EVERYTHING = (
    "from source_key_rows import CLASS as _C\nexec(_C)\n" + NUMPY +
    "import enum, functools, dataclasses\n"
    "class E(enum.Flag):\n    A = 1\n    B = 2\n"
    "@dataclasses.dataclass(frozen=True)\nclass D:\n    a: set\n"
    "WORDS = {'a', 'b', 'c', 'd', ('e', 1), None, 1.5, frozenset('xyz')}\n"
    "KEPT = [E.A, E.B, D({'p', 'q', 'r'}), {E.A: {'s', 't'}}, np.dtype('f4')]\n"
    "@functools.lru_cache(None)\ndef cached(x): return x in {'a', 'b', 'c'}\n"
    "def f(x):\n    import numpy.linalg\n"
    "    return [cached(y) for y in x], WORDS, KEPT, np.linalg.norm\n"
    "solve = functools.partial(solver.method, f=f)\n"
    "OPTIONS = {'w': WORDS, 'f': f, 'd': {'b': 1, 'a': {'x', 'y'}},\n"
    "           'a': np.arange(2000.), 'o': D({'a', 'b'})}\n")
